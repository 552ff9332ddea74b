/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stacks SEED SCHEME FORM REAL SPEC HEADER: a random scene of contacts alone, as a spec, and what has to hold whatever
 * the motion is: masses, forces, springs and guards as arrays. SCHEME: exact, taylor or curved (a cubic spring more);
 * FORM: plain or tunable. Exit status 0. */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 6, MOST_GUARDS = 8 };

struct guard {
	long row[MOST];                 /* row . x / 5 comes to the gap */
	long gap, restitution;          /* in 1/1000 */
};

struct scene {
	int n, guards;
	bool curved, tunable;
	long mass[MOST], start[MOST], speed[MOST], force[MOST]; /* in 1/1000; 1/100 N */
	long spring[MOST];              /* of each to where it started, in N/m */
	struct guard guard[MOST_GUARDS];
	long h;                         /* in 1/100000 s */
};

static uint64_t dice;

static long among(long from, long to)   /* splitmix64: Steele, Lea, Flood 2014 */
{
	uint64_t z = dice += UINT64_C(0x9e3779b97f4a7c15);
	z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
	z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
	return from + (long)((z ^ (z >> 31)) % (uint64_t)(to - from + 1));
}

/* ---- scenes ---- */

static long random_restitution(void)
{
	switch (among(0, 5)) {
	case 0:
		return 0;
	case 1:
		return among(1, 99);
	case 2:
		return among(700, 900);
	default:
		return among(1, 7) * 100;
	}
}

/* Node a comes up to node b, each a coordinate, or -1: the ground */
static void stop(struct scene *s, int a, int b, long gap)
{
	struct guard *g = &s->guard[s->guards++];
	memset(g->row, 0, sizeof g->row);
	if (a >= 0)
		g->row[a] = 5;
	if (b >= 0)
		g->row[b] = -5;
	g->gap = gap;
	g->restitution = random_restitution();
}

static void random_masses(struct scene *s, int n)
{
	static const long simple[] = { 1000, 2000, 3000, 500 };
	bool plain = among(0, 2) == 0;
	s->n = n;
	for (int i = 0; i < n; i++)
		s->mass[i] = plain ? simple[among(0, 3)] : among(100, 5000);
}

/* Balls above each other, at rest on each other or dropped, from one height or from several */
static void pile(struct scene *s, bool floor)
{
	const bool lie = among(0, 1), same = among(0, 3) == 0;
	long up = 0, drop = among(0, 1500);
	random_masses(s, (int)among(floor ? 1 : 2, floor ? 5 : 6));
	for (int i = 0; i < s->n; i++) {
		long gap = among(0, 2) ? 0 : among(0, 50);
		if (i > 0 || floor)
			stop(s, i - 1, i, gap);
		up += lie && i < s->n - 1 ? 0 : same ? (i == 0 ? drop : 0) : among(0, 2) ? among(0, 700) : 0;
		s->start[i] = up - (i > 0 || floor ? gap : 0);
		up = s->start[i];
	}
}

static void weigh(struct scene *s)
{
	for (int i = 0; i < s->n; i++)
		s->force[i] = -s->mass[i] * 981 / 1000;
}

static void hurl(struct scene *s)
{
	for (int i = 0; i < s->n; i++)
		s->speed[i] = among(0, 2) ? among(-3000, 3000) : 0;
}

/* Between a floor and a ceiling, pushed about */
static void walled(struct scene *s)
{
	pile(s, true);
	if (s->n == 5)
		s->n = 4, s->guards = 4;
	stop(s, s->n - 1, -1, s->start[s->n - 1] + among(0, 400));
	hurl(s);
	for (int i = 0; i < s->n; i++) {
		s->force[i] = among(0, 1) ? among(-2000, 2000) : 0;
		s->spring[i] = among(0, 2) ? 0 : among(1, 80);
	}
}

/* A mass in a plane between two slanting stops, and sometimes one that falls on it */
static void wedge(struct scene *s)
{
	random_masses(s, (int)among(2, 3));
	s->mass[1] = among(0, 2) ? s->mass[0] : among(100, 5000);
	for (int k = 0; k < 2; k++) {
		struct guard *g = &s->guard[s->guards++];
		const bool steep = among(0, 1);
		memset(g->row, 0, sizeof g->row);
		g->row[0] = (k ? 1 : -1) * (steep ? 4 : 3);
		g->row[1] = steep ? -3 : -4;
		g->gap = 0;
		g->restitution = random_restitution();
	}
	s->start[1] = among(0, 800);
	s->start[0] = s->start[1] ? among(-s->start[1] / 2, s->start[1] / 2) : 0;
	if (s->n == 3) {
		stop(s, 1, 2, 0);
		s->start[2] = s->start[1] + (among(0, 1) ? among(0, 500) : 0);
	}
	hurl(s);
	weigh(s);
	s->force[0] = among(0, 1) ? among(-500, 500) : 0;
}

static void draw(struct scene *s, uint64_t seed)
{
	static const long steps[] = { 100, 200, 500, 1000, 2000, 5000, 10000, 20000, 50000 };
	memset(s, 0, sizeof *s);
	dice = seed * UINT64_C(0x2545f4914f6cdd1d);
	s->h = steps[among(0, 8)];
	switch (among(0, 4)) {
	case 0:
		pile(s, false);
		hurl(s);
		break;
	case 1:
		walled(s);
		break;
	case 2:
		wedge(s);
		break;
	default:
		pile(s, true);
		if (among(0, 1))
			hurl(s);
		weigh(s);
	}
}

/* ---- as a spec ---- */

static void number(FILE *to, long thousandths)
{
	fprintf(to, "%s%ld.%03ld", thousandths < 0 ? "-" : "", labs(thousandths) / 1000, labs(thousandths) % 1000);
}

static void rate(FILE *to, const struct guard *g)
{
	fprintf(to, "(");
	for (int i = 0; i < MOST; i++)
		if (g->row[i] != 0)
			fprintf(to, " + (%ld/5)*x%d'", g->row[i], i);
	fprintf(to, ")");
}

/* v - (1 + e) d s: d by the inverse masses */
static void jumps(FILE *to, const struct scene *s, int k)
{
	const struct guard *g = &s->guard[k];
	const char *between = ": ";
	for (int i = 0; i < s->n; i++) {
		if (g->row[i] == 0)
			continue;
		fprintf(to, "%sx%d' = x%d' - (1 + e%d)*(%ld/5)/m%d/(", between, i, i, k, g->row[i], i);
		for (int j = 0; j < s->n; j++)
			if (g->row[j] != 0)
				fprintf(to, " + %ld/25/m%d", g->row[j] * g->row[j], j);
		fprintf(to, ")*");
		rate(to, g);
		between = ", ";
	}
	fprintf(to, "\n");
}

static bool is_stop(const struct guard *g)
{
	long sum = 0, largest = 0;
	for (int i = 0; i < MOST; i++) {
		sum += labs(g->row[i]);
		largest = labs(g->row[i]) > largest ? labs(g->row[i]) : largest;
	}
	return (sum == 5 || sum == 10) && largest == 5;
}

static void node(FILE *to, const struct guard *g, int sign)
{
	for (int i = 0; i < MOST; i++)
		if (g->row[i] == 5 * sign) {
			fprintf(to, "x%d", i);
			return;
		}
	fprintf(to, "ground");
}

static void write_guard(FILE *to, const struct scene *s, int k)
{
	const struct guard *g = &s->guard[k];
	if (is_stop(g) && g->gap >= 0) {
		fprintf(to, "stop between ");
		node(to, g, 1);
		fprintf(to, ", ");
		node(to, g, -1);
		fprintf(to, " at ");
		number(to, g->gap);
		fprintf(to, " restitution e%d\n", k);
		return;
	}
	fprintf(to, "when ");
	for (int i = 0; i < s->n; i++)
		if (g->row[i] != 0)
			fprintf(to, " + (%ld/5)*x%d", g->row[i], i);
	fprintf(to, " >= ");
	number(to, g->gap);
	jumps(to, s, k);
}

static void write_spec(FILE *to, const struct scene *s, const char *scheme)
{
	fprintf(to, "model scene\ncoord ");
	for (int i = 0; i < s->n; i++)
		fprintf(to, "%sx%d", i ? ", " : "", i);
	for (int i = 0; i < s->n; i++) {
		fprintf(to, "\nparam m%d = ", i);
		number(to, s->mass[i]);
	}
	for (int k = 0; k < s->guards; k++) {
		fprintf(to, "\nparam e%d = ", k);
		number(to, s->guard[k].restitution);
	}
	if (s->tunable)
		fprintf(to, "\nparam kt = 0\ntunable kt%s", s->guards ? ", e0" : "");
	fprintf(to, "\n");
	for (int i = 0; i < s->n; i++) {
		fprintf(to, "m%d*x%d'' + %ld*(x%d - (", i, i, s->spring[i], i);
		number(to, s->start[i]);
		fprintf(to, "))%s = ", s->tunable && i == 0 ? " + kt*x0" : "");
		if (s->curved && i == 0)
			fprintf(to, "-20*x0^3 + ");
		number(to, s->force[i] * 10);
		fprintf(to, "\ninit x%d = ", i);
		number(to, s->start[i]);
		fprintf(to, ", x%d' = ", i);
		number(to, s->speed[i]);
		fprintf(to, "\n");
	}
	for (int k = 0; k < s->guards; k++)
		write_guard(to, s, k);
	fprintf(to, "%sstep %ld/100000\n", scheme, s->h);
}

/* ---- as arrays ---- */

static void list(FILE *to, const char *name, const long *value, int n, double unit)
{
	fprintf(to, "static const double %s[] = { ", name);
	for (int i = 0; i < n; i++)
		fprintf(to, "%.17g, ", (double)value[i] * unit);
	fprintf(to, "};\n");
}

static void write_arrays(FILE *to, const struct scene *s)
{
	fprintf(to, "enum { BODIES = %d, GUARDS = %d };\n", s->n, s->guards);
	list(to, "mass", s->mass, s->n, 1e-3);
	list(to, "start", s->start, s->n, 1e-3);
	list(to, "force", s->force, s->n, 1e-2);
	list(to, "spring", s->spring, s->n, 1);
	fprintf(to, "static const double cubic = %d;\n", s->curved ? 20 : 0);
	fprintf(to, "static const double row[][%d] = { ", s->n);
	for (int k = 0; k < s->guards; k++) {
		fprintf(to, "{ ");
		for (int i = 0; i < s->n; i++)
			fprintf(to, "%g, ", (double)s->guard[k].row[i] / 5);
		fprintf(to, "}, ");
	}
	fprintf(to, "};\nstatic const double gap[] = { ");
	for (int k = 0; k < s->guards; k++)
		fprintf(to, "%.17g, ", (double)s->guard[k].gap * 1e-3);
	fprintf(to, "};\n");
}

int main(int argc, char **argv)
{
	struct scene s;
	FILE *spec, *header;
	if (argc != 7 || !(spec = fopen(argv[5], "w")) || !(header = fopen(argv[6], "w")))
		return 2;
	draw(&s, strtoull(argv[1], NULL, 10));
	s.curved = strcmp(argv[2], "curved") == 0;
	s.tunable = strcmp(argv[3], "tunable") == 0;
	write_spec(spec, &s, strcmp(argv[2], "exact") == 0 ? "" : strcmp(argv[4], "float") == 0 ?
	    "scheme taylor\ntolerance 1e-6\n" : "scheme taylor\ntolerance 1e-13\n");
	write_arrays(header, &s);
	return fclose(spec) || fclose(header);
}
