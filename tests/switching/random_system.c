/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "random_system.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

static uint64_t state;

int below(int n)
{
	state = state * 6364136223846793005u + 1442695040888963407u;
	return (int)((state >> 33) % (unsigned)n);
}

real number(double low, double high)
{
	const long thousandths = lround(1000 * low) + below((int)lround(1000 * (high - low)) + 1);
	return (real)thousandths / 1000;
}

void seed_with(unsigned seed)
{
	state = 0x9e3779b97f4a7c15u * (seed + 1);
	for (int i = 0; i < 10; i++)
		below(2);
}

static void add_spring(struct hand_system *s, int i, int j, real k, real c)
{
	s->K[i][i] += k;
	s->C[i][i] += c;
	if (j < 0)
		return;
	s->K[j][j] += k;
	s->C[j][j] += c;
	s->K[i][j] -= k;
	s->K[j][i] -= k;
	s->C[i][j] -= c;
	s->C[j][i] -= c;
}

static void add_stop(struct hand_system *s)
{
	struct hand_stop *p = &s->stop[s->stops++];
	const int i = below(s->n), j = s->n > 1 && below(3) == 0 ? (i + 1) % s->n : -1;
	const int side = below(2) ? 1 : -1;
	p->row[i] = side;
	if (j >= 0)
		p->row[j] = -side;
	for (int m = 0; m < s->n; m++)
		p->push[m] = p->row[m];
	p->k = number(2, 60);
	p->c = below(4) == 0 ? number(0.1, 1) : 0;
	p->gap = number(0.1, 1);
	if (below(3) == 0) {
		p->a = number(0.02, 0.09);
		p->w = number(0.5, 4);
	}
}

struct hand_system random_system(unsigned seed)
{
	struct hand_system s = { 0 };
	seed_with(seed);
	s.n = 1 + below(3);
	for (int i = 0; i < s.n; i++)
		add_spring(&s, i, -1, number(0.3, 6), number(0.02, 0.3));
	for (int i = 0; i + 1 < s.n; i++)
		add_spring(&s, i, i + 1, number(0.5, 6), number(0, 0.2));
	s.w = number(0.4, 3);
	for (int i = 0; i < s.n; i++) {
		s.f0[i] = below(2) ? number(-0.5, 0.5) : 0;
		s.fa[i] = i == 0 ? number(0.3, 2) : 0;
		s.start[i] = number(-0.09, 0.09);
		s.start[s.n + i] = number(-1, 1);
	}
	for (int count = 1 + below(3); count > 0; count--)
		add_stop(&s);
	return s;
}

/* One mass that swings up to a stop once in every period, and just into it: the penetration is 10^-1 .. 10^-7. */
struct hand_system adversarial_system(unsigned seed)
{
	struct hand_system s = { 0 };
	seed_with(seed + 100000);
	s.n = s.stops = 1;
	s.K[0][0] = number(0.5, 3);
	s.start[0] = 0;
	s.start[1] = number(0.5, 2);
	struct hand_stop *p = &s.stop[0];
	p->row[0] = p->push[0] = 1;
	p->k = number(1, 100);
	real depth = 1;
	for (int tenths = 1 + (int)(seed % 7); tenths > 0; tenths--)
		depth /= 10;
	p->gap = s.start[1] / sqrtl(s.K[0][0]) * (1 - depth * number(0.2, 0.9));
	p->gap = (real)(double)p->gap;          /* the spec has a double */
	return s;
}

/* ---- as a spec ---- */

void print_linear(FILE *to, const struct hand_system *s, const real *row, const char *prime)
{
	for (int i = 0; i < s->n; i++)
		if (row[i] != 0)
			fprintf(to, " + %.17Lg*x%d%s", row[i], i + 1, prime);
}

void print_push(FILE *to, const struct hand_system *s, int j, const char *form, const char *beyond)
{
	const struct hand_stop *p = &s->stop[j];
	if (p->c == 0 && form) {
		fprintf(to, "%.17Lg*", p->k);
		fprintf(to, form, j + 1, j + 1);
	} else {
		fprintf(to, "(d%d %s 0 ? %.17Lg*d%d + %.17Lg*(0", j + 1, beyond, p->k, j + 1, p->c);
		print_linear(to, s, p->row, "'");
		fputs(") : 0)", to);
	}
	fputc('\n', to);
}

/* max(d, 0) in one of its forms; damped stops have but the last two */
static void print_stop(FILE *to, const struct hand_system *s, int j, int form)
{
	const struct hand_stop *p = &s->stop[j];
	const int first = p->c != 0 && form < 6 ? 6 + form % 2 : form;
	static const char *const forms[] = { "max(d%d, 0)", "0.5*(d%d + abs(d%d))", "-min(-d%d, 0)",
		"table(d%d; -1, 0; 0, 0; 1, 1)",
		"(d%d - clip(d%d, -1e9, 0))", "deadzone(d%d, -1e9, 0)", NULL, NULL };
	fprintf(to, "let d%d = 0", j + 1);
	print_linear(to, s, p->row, "");
	fprintf(to, " - %.17Lg", p->gap);
	if (p->a != 0)
		fprintf(to, " - %.17Lg*sin(%.17Lg*t)", p->a, p->w);
	fprintf(to, "\nlet p%d = ", j + 1);
	print_push(to, s, j, forms[first], first == 6 ? ">" : ">=");
}

void print_head(FILE *to, const char *name, const struct hand_system *s)
{
	fprintf(to, "model %s\ncoord x1", name);
	for (int i = 1; i < s->n; i++)
		fprintf(to, ", x%d", i + 1);
	fputs("\ninit ", to);
	for (int i = 0; i < s->n; i++)
		fprintf(to, "%s x%d = %.17Lg, x%d' = %.17Lg", i ? "," : "", i + 1, s->start[i], i + 1,
			s->start[s->n + i]);
	fputc('\n', to);
}

void print_left(FILE *to, const struct hand_system *s, int i)
{
	fprintf(to, "x%d''", i + 1);
	print_linear(to, s, s->K[i], "");
	print_linear(to, s, s->C[i], "'");
	for (int j = 0; j < s->stops; j++)
		if (s->stop[j].push[i] != 0)
			fprintf(to, " + %.17Lg*p%d", s->stop[j].push[i], j + 1);
	fputs(" = ", to);
}

void print_spec(FILE *to, const char *name, const struct hand_system *s, unsigned seed)
{
	print_head(to, name, s);
	for (int j = 0; j < s->stops; j++)
		print_stop(to, s, j, (int)((seed + 3 * (unsigned)j) % 8));
	for (int i = 0; i < s->n; i++) {
		print_left(to, s, i);
		fprintf(to, "%.17Lg + %.17Lg*cos(%.17Lg*t)\n", s->f0[i], s->fa[i], s->w);
	}
	fputs("step 1\n", to);
}
