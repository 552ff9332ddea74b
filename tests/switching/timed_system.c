/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "timed_system.h"
#include "random_system.h"

#include <math.h>
#include <stdbool.h>

/* Times between 0 and 24: some that all steps end at, some close to the one before */
static void choose_changes(struct timed_system *s)
{
	real last = 0;
	s->segments = 2 + below(TIMED_SEGMENTS - 1);
	for (int i = 0; i + 1 < s->segments; i++) {
		const real low = last + 0.001L;
		const int kind = below(4);
		last = kind == 0   ? low + number(0.005, 0.3)
		       : kind == 1 ? 4 * (floorl(last / 4) + 1)
				   : low + number(0.1, 5);
		s->change[i] = last;
	}
}

/* What one scalar load does in the next segment: goes on, turns at the change without a jump, or is another */
static void choose_next(real t, const real before[3], real most, bool waves, real after[3])
{
	const int kind = below(4);
	for (int k = 0; k < 3; k++)
		after[k] = before[k];
	if (kind == 0)
		return;
	after[1] = below(3) ? number(-0.09, 0.09) * most : 0;
	after[0] = kind == 1 ? before[0] + (before[1] - after[1]) * t : number(-0.9, 0.9) * most - after[1] * t;
	if (kind == 2 && waves)
		after[2] = number(0.05, 0.9) * most;
}

static void change_stop(struct hand_stop *p, const struct hand_stop *before, real t)
{
	const real load[3] = { before->gap, before->rate, before->a };
	real next[3];
	choose_next(t, load, 0.5L, p->w != 0, next);
	p->gap = next[0];
	p->rate = next[1];
	p->a = next[2];
}

static void change_forces(struct hand_system *s, const struct hand_system *before, real t)
{
	for (int i = 0; i < s->n; i++) {
		const real load[3] = { before->f0[i], before->f1[i], before->fa[i] };
		real next[3];
		choose_next(t, load, 1, true, next);
		s->f0[i] = next[0];
		s->f1[i] = next[1];
		s->fa[i] = next[2];
	}
}

static void uncouple(struct hand_system *s)
{
	for (int i = 0; i < s->n; i++)
		for (int j = 0; j < s->n; j++)
			if (i != j)
				s->K[i][j] = s->C[i][j] = 0;
}

struct timed_system timed_system(unsigned seed)
{
	struct timed_system s = { .in = { random_system(seed + 5000) } };
	seed_with(seed + 76);
	if (seed % 4 == 3)                      /* of independent parts, where no stop is between masses */
		uncouple(&s.in[0]);
	choose_changes(&s);
	for (int k = 1; k < s.segments; k++) {
		s.in[k] = s.in[k - 1];
		change_forces(&s.in[k], &s.in[k - 1], s.change[k - 1]);
		for (int j = 0; j < s.in[k].stops; j++)
			change_stop(&s.in[k].stop[j], &s.in[k - 1].stop[j], s.change[k - 1]);
	}
	return s;
}

void timed_reference(const struct timed_system *s, struct hand_state *now, real t)
{
	hand_start(&s->in[0], now);
	for (int k = 0; k < s->segments; k++) {
		const real end = k + 1 < s->segments && s->change[k] < t ? s->change[k] : t;
		if (k > 0)
			hand_change(&s->in[k], now);
		hand_reference(&s->in[k], now, end);
		now->t = end;
		if (end == t)
			break;
	}
}

/* ---- as a spec ---- */

struct scalar_load {
	real value[TIMED_SEGMENTS][3];      /* constant, rate, size of the wave */
	const char *wave;
	real w;
};

static bool same(const real a[3], const real b[3])
{
	return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* No waves, and no jumps at changes: then as a table */
static bool is_broken_line(const struct timed_system *s, const struct scalar_load *l)
{
	bool line = true;
	for (int k = 0; k < s->segments; k++) {
		line = line && l->value[k][2] == 0;
		if (k > 0) {
			const real t = s->change[k - 1], *a = l->value[k - 1], *b = l->value[k];
			line = line && fabsl(a[0] + a[1] * t - b[0] - b[1] * t) < 1e-15L;
		}
	}
	return line;
}

static void print_table(FILE *to, const struct timed_system *s, const struct scalar_load *l)
{
	const int last = s->segments - 1;
	fprintf(to, "table(t; 0, %.21Lg", l->value[0][0]);
	for (int k = 0; k < last; k++)
		fprintf(to, "; %.21Lg, %.21Lg", s->change[k], l->value[k][0] + l->value[k][1] * s->change[k]);
	const real end = s->change[last - 1] + 40;
	fprintf(to, "; %.21Lg, %.21Lg)", end, l->value[last][0] + l->value[last][1] * end);
}

static void print_formula(FILE *to, const struct scalar_load *l, int k)
{
	fprintf(to, "%.21Lg + %.21Lg*t", l->value[k][0], l->value[k][1]);
	if (l->value[k][2] != 0)
		fprintf(to, " + %.21Lg*%s(%.21Lg*t)", l->value[k][2], l->wave, l->w);
}

/* Conditions where it changes; of some seeds also where it does not */
static void print_load(FILE *to, const struct timed_system *s, const struct scalar_load *l, bool all)
{
	if (is_broken_line(s, l)) {
		print_table(to, s, l);
		return;
	}
	fputc('(', to);
	for (int k = 0; k < s->segments; k++) {
		const bool last = k + 1 == s->segments;
		if (!last && !all && same(l->value[k], l->value[k + 1]))
			continue;
		if (!last)
			fprintf(to, "t < %.21Lg ? ", s->change[k]);
		print_formula(to, l, k);
		fputs(last ? ")" : " : ", to);
	}
}

/* max(d, 0) in one of its forms; damped stops have but the last */
static void print_stop(FILE *to, const struct timed_system *all, int j, int form)
{
	static const char *const forms[] = { "max(d%d, 0)", "0.5*(d%d + abs(d%d))", "-min(-d%d, 0)",
					     "table(d%d; -1, 0; 0, 0; 1, 1)", "deadzone(d%d, -1e9, 0)" };
	const struct hand_system *s = all->in;
	const struct hand_stop *p = &s->stop[j];
	struct scalar_load moves = { .wave = "sin", .w = p->w };
	for (int k = 0; k < all->segments; k++) {
		const struct hand_stop *now = &all->in[k].stop[j];
		const real value[3] = { now->gap, now->rate, now->a };
		for (int m = 0; m < 3; m++)
			moves.value[k][m] = value[m];
	}
	fprintf(to, "let d%d = 0", j + 1);
	print_linear(to, s, p->row, "");
	fputs(" - ", to);
	print_load(to, all, &moves, form % 2);
	fprintf(to, "\nlet p%d = ", j + 1);
	print_push(to, s, j, forms[form % 5], form % 2 ? ">" : ">=");
}

static void print_force(FILE *to, const struct timed_system *s, int i, bool all)
{
	struct scalar_load force = { .wave = "cos", .w = s->in->w };
	for (int k = 0; k < s->segments; k++) {
		const real value[3] = { s->in[k].f0[i], s->in[k].f1[i], s->in[k].fa[i] };
		for (int m = 0; m < 3; m++)
			force.value[k][m] = value[m];
	}
	print_load(to, s, &force, all);
}

void print_timed(FILE *to, const char *name, const struct timed_system *s, unsigned seed)
{
	const struct hand_system *first = s->in;
	print_head(to, name, first);
	for (int j = 0; j < first->stops; j++)
		print_stop(to, s, j, (int)((seed + 3 * (unsigned)j) % 10));
	for (int i = 0; i < first->n; i++) {
		print_left(to, first, i);
		print_force(to, s, i, seed % 2);
		fputc('\n', to);
	}
	fputs("step 1\n", to);
}
