/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "random_system.h"
#include "quadrant.h"

#include <math.h>
#include <string.h>

enum { MOST_MASSES = 3, MOST_TERMS = 3 * MOST_MASSES };
enum kind { STOP, CONTACT, SQUARE, JUMP, GAP, DRAG, KINDS };

struct term {
	enum kind kind;
	int mass;
	int size, at, other;                    /* thousandths */
};

static struct {
	unsigned state;
	int n, terms;
	int stiffness[MOST_MASSES], damping[MOST_MASSES], cubic[MOST_MASSES], coupling[MOST_MASSES];
	int force[MOST_MASSES], frequency[MOST_MASSES], start[MOST_MASSES];
	struct term term[MOST_TERMS];
} made;

static int draw(int low, int high)
{
	made.state = made.state * 1664525u + 1013904223u;
	return low + (int)((made.state >> 9) % (unsigned)(high - low + 1));
}

static void add_term(int mass, enum kind kind)
{
	static const int low[KINDS] = { 5000, 5000, 1000, 200, 5000, 50 };
	static const int high[KINDS] = { 90000, 60000, 9000, 900, 40000, 500 };
	struct term t = { kind, mass, draw(low[kind], high[kind]), 0, 0 };
	t.at = draw(100, 700) * (kind != CONTACT && draw(0, 1) ? -1 : 1);
	if (kind == GAP)
		t.at = -draw(100, 400);
	t.other = draw(50, 400);
	made.term[made.terms++] = t;
}

static void make(unsigned seed)
{
	memset(&made, 0, sizeof made);
	made.state = seed * 2654435761u + 12345u;
	for (int i = 0; i < 20; i++)
		(void)draw(0, 1);
	made.n = draw(1, MOST_MASSES);
	for (int i = 0; i < made.n; i++) {
		made.stiffness[i] = draw(500, 6000);
		made.damping[i] = draw(20, 300);
		made.cubic[i] = draw(50, 3000);
		made.coupling[i] = draw(100, 3000);
		made.force[i] = draw(500, 3000);
		made.frequency[i] = draw(300, 2500);
		made.start[i] = draw(-900, 900);
		add_term(i, (enum kind)draw(STOP, GAP) == CONTACT && i + 1 == made.n ? STOP
				: (enum kind)draw(STOP, GAP));
		if (made.term[made.terms - 1].kind == CONTACT && i + 1 == made.n)
			made.term[made.terms - 1].kind = SQUARE;
		if (draw(0, 1))
			add_term(i, DRAG);
	}
}

/* ---- by hand ---- */

static real force_of(const struct term *t, int interval, const real *y)
{
	const real size = t->size / 1000.0L, at = t->at / 1000.0L, other = t->other / 1000.0L, x = y[t->mass];
	const real v = y[made.n + t->mass];
	switch (t->kind) {
	case STOP:    return interval ? size * (x - at) : 0;
	case CONTACT: return interval ? size * (x - y[t->mass + 1] - at) : 0;
	case SQUARE:  return interval ? size * (x - at) * (x - at) : 0;
	case JUMP:    return interval ? size : 0;
	case GAP:     return interval == 0 ? size * (x - at) : interval == 2 ? size * (x - other) : 0;
	default:      return (interval ? size : -size) * v * v;
	}
}

static void equations_made(real t, const real *y, const real *u, real *d)
{
	const int n = made.n;
	(void)u;
	for (int i = 0; i < n; i++) {
		const real x = y[i];
		real a = made.force[i] / 1000.0L * cos_of(made.frequency[i] / 1000.0L * t);
		a -= made.damping[i] / 1000.0L * y[n + i];
		a -= made.stiffness[i] / 1000.0L * x + made.cubic[i] / 1000.0L * x * x * x;
		if (i + 1 < n)
			a -= made.coupling[i] / 1000.0L * (x - y[i + 1]);
		if (i > 0)
			a += made.coupling[i - 1] / 1000.0L * (y[i - 1] - x);
		d[i] = y[n + i];
		d[n + i] = a;
	}
	for (int k = 0; k < made.terms; k++) {
		const struct term *term = &made.term[k];
		const real force = force_of(term, interval_of[k], y);
		d[n + term->mass] -= force;
		if (term->kind == CONTACT)
			d[n + term->mass + 1] += force;
	}
}

static void expressions_made(real t, const real *y, real *e)
{
	(void)t;
	for (int k = 0; k < made.terms; k++) {
		const struct term *term = &made.term[k];
		e[k] = term->kind == DRAG      ? y[made.n + term->mass]
			   : term->kind == CONTACT ? y[term->mass] - y[term->mass + 1]
									   : y[term->mass];
	}
}

struct switched_system random_switched(unsigned seed)
{
	make(seed);
	struct switched_system s = { .name = "random", .states = 2 * made.n, .expressions = made.terms,
								.f = equations_made, .e = expressions_made,
										.piece = 1 / 256.0L };
	for (int i = 0; i < made.n; i++)
		s.start[i] = made.start[i] / 1000.0L;
	for (int k = 0; k < made.terms; k++) {
		const struct term *term = &made.term[k];
		s.breaks[k] = term->kind == GAP ? 2 : 1;
		s.at[k][0] = term->kind == DRAG ? 0 : term->at / 1000.0L;
		s.at[k][1] = term->other / 1000.0L;
	}
	return s;
}

/* ---- as a spec ---- */

/* (a/1000) */
static void print_thousandths(FILE *to, int value)
{
	fprintf(to, "(%d/1000)", value);
}

static void print_term(FILE *to, const struct term *t, int sign)
{
	fprintf(to, " %c ", sign > 0 ? '+' : '-');
	print_thousandths(to, t->size);
	switch (t->kind) {
	case STOP:    fprintf(to, "*max(x%d - (%d/1000), 0)", t->mass, t->at); break;
	case CONTACT: fprintf(to, "*max(x%d - x%d - (%d/1000), 0)", t->mass, t->mass + 1, t->at); break;
	case SQUARE:  fprintf(to, "*(x%d > (%d/1000) ? (x%d - (%d/1000))^2 : 0)", t->mass, t->at, t->mass,
			t->at); break;
	case JUMP:    fprintf(to, "*(x%d > (%d/1000) ? 1 : 0)", t->mass, t->at); break;
	case GAP:     fprintf(to, "*deadzone(x%d, (%d/1000), (%d/1000))", t->mass, t->at, t->other); break;
	default:      fprintf(to, "*x%d'*abs(x%d')", t->mass, t->mass); break;
	}
}

void print_switched(FILE *to, unsigned seed)
{
	make(seed);
	fprintf(to, "model random%u\ncoord", seed);
	for (int i = 0; i < made.n; i++)
		fprintf(to, "%s x%d", i ? "," : "", i);
	fprintf(to, "\nscheme taylor\ninit");
	for (int i = 0; i < made.n; i++)
		fprintf(to, "%s x%d = %d/1000", i ? "," : "", i, made.start[i]);
	fprintf(to, "\nstep 1/4\n");
	for (int i = 0; i < made.n; i++) {
		fprintf(to, "x%d'' + (%d/1000)*x%d' + (%d/1000)*x%d + (%d/1000)*x%d^3", i, made.damping[i], i,
				made.stiffness[i], i, made.cubic[i], i);
		if (i + 1 < made.n)
			fprintf(to, " + (%d/1000)*(x%d - x%d)", made.coupling[i], i, i + 1);
		if (i > 0)
			fprintf(to, " - (%d/1000)*(x%d - x%d)", made.coupling[i - 1], i - 1, i);
		for (int k = 0; k < made.terms; k++) {
			const struct term *t = &made.term[k];
			if (t->mass == i)
				print_term(to, t, 1);
			if (t->kind == CONTACT && t->mass + 1 == i)
				print_term(to, t, -1);
		}
		fprintf(to, " = (%d/1000)*cos((%d/1000)*t)\n", made.force[i], made.frequency[i]);
	}
}
