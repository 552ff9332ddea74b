/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_run against NAME_step, from a state on its way, for n = 0, 1, ... three blocks and one step: every row and the
 * state within 2 units in the last place per step of the largest value; time and what follows too; without rows the
 * same bits; nothing beyond the n-th row. Models of one file, CODE; lines for rows.sh: what is wrong, then "not ok". */
#include CODE

#include "worse.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef REAL_FLOAT
typedef float real;
typedef pl_modelf real_model;
#define EPSILON ((double)FLT_EPSILON)
#else
typedef double real;
typedef pl_model real_model;
#define EPSILON DBL_EPSILON
#endif

enum { BEFORE = 5, MOST = 3 * 64 + 1, WIDE = 12, LEAST = 17 };

static const struct subject {
	const real_model *m;
	int rows;
} subject[] = {
#define X(name, rows) {&name##_model, rows},
#include MODELS
#undef X
};
enum { SUBJECTS = sizeof subject / sizeof *subject };

static const real_model *m;
static real u[(BEFORE + MOST + 2) * WIDE];      /* samples */
static real y[MOST + 2][WIDE], out[MOST + 2][WIDE];     /* by step, after BEFORE + k of them */
static double most_y[WIDE], most_out[WIDE];
static double worst;
static void *start, *now, *blind;
static int said;

static void *need(size_t bytes)
{
	void *memory = calloc(1, bytes);
	if (!memory)
		exit(99);
	return memory;
}

static real *samples(int k)
{
	return m->inputs ? u + k * m->inputs : NULL;
}

static bool near(double found, double expected, double steps, double most, const char *what, int n, int k, int i)
{
	const double allowed = 2 * EPSILON * steps * most;
	if (steps > 0 && most > 0)
		worst = worse(worst, fabs(found - expected) / (EPSILON * steps * most));
	if (fabs(found - expected) <= allowed)
		return true;
	if (said++ < 5)
		printf("%s, run of %d, row %d, number %d: found %.17g, expected %.17g, tolerance %.3g\n", what, n, k, i,
				found,
			expected, allowed);
	return false;
}

static void by_step(int last)
{
	memcpy(now, start, m->size);
	memset(most_y, 0, sizeof most_y);
	memset(most_out, 0, sizeof most_out);
	for (int k = 0; k <= last; k++) {
		m->get(now, y[k]);
		m->out(now, out[k]);
		for (int i = 0; i < m->states; i++)
			most_y[i] = fmax(most_y[i], fabs((double)y[k][i]));
		for (int i = 0; i < m->outputs; i++)
			most_out[i] = worse(most_out[i], fabs((double)out[k][i]));
		m->step(now, samples(BEFORE + k));
	}
}

static bool by_run(int n)
{
	static real rows[(MOST + 1) * WIDE];
	real state[WIDE];
	const real mark = (real)-7.5;
	bool good = true;
	memcpy(now, start, m->size);
	memcpy(blind, start, m->size);
	for (int i = 0; i <= n * m->outputs; i++)
		rows[i] = mark;
	m->run(now, (size_t)n, samples(BEFORE), rows);
	m->run(blind, (size_t)n, samples(BEFORE), NULL);
	if (memcmp(now, blind, m->size) != 0 || rows[n * m->outputs] != mark) {
		printf("run of %d: without rows another state, or beyond the last row\n", n);
		good = false;
	}
	for (int k = 0; k < n; k++)
		for (int i = 0; i < m->outputs; i++)
			good = near((double)rows[k * m->outputs + i], (double)out[k + 1][i], k + 1, most_out[i], "out",
					n, k, i) &&
				good;
	for (int more = 0; more < 2; more++) {      /* the state; and one step on, for which all of it is there */
		m->get(now, state);
		for (int i = 0; i < m->states; i++)
			good = near((double)state[i], (double)y[n + more][i], n + more, most_y[i], more ? "then"
					: "state", n, n,
				i) && good;
		m->step(now, samples(BEFORE + n));
	}
	return good;
}

/* One output in the place of the only input: samples are read before rows are written over them. */
static bool in_place(int n)
{
	static real apart[MOST], both[MOST];
	memcpy(now, start, m->size);
	memcpy(blind, start, m->size);
	memcpy(both, samples(BEFORE), (size_t)n * sizeof *both);
	m->run(now, (size_t)n, samples(BEFORE), apart);
	m->run(blind, (size_t)n, both, both);
	return memcmp(apart, both, (size_t)n * sizeof *both) == 0 && memcmp(now, blind, m->size) == 0;
}

static bool times_agree(int n)
{
	memcpy(now, start, m->size);
	memcpy(blind, start, m->size);
	m->run(now, (size_t)n, samples(BEFORE), NULL);
	for (int k = 0; k < n; k++)
		m->step(blind, samples(BEFORE + k));
	return m->time(now) == m->time(blind);
}

static void judge(const struct subject *s)
{
	const int last = s->rows ? 3 * s->rows + 1 : LEAST;
	bool good = true, on_time = true, over = true;
	m = s->m;
	start = need(m->size), now = need(m->size), blind = need(m->size);
	m->init(start);
	for (int k = 0; k < BEFORE; k++)
		m->step(start, samples(k));
	by_step(last + 1);
	said = 0;
	worst = 0;
	for (int n = 0; n <= last; n++) {
		good = by_run(n) && good;
		on_time = times_agree(n) && on_time;
		over = (m->inputs != 1 || m->outputs != 1 || in_place(n)) && over;
	}
	printf("%s %s: run of 0 to %d steps, worst %.2g of 2 units a step\n", good ? "ok" : "not ok", m->name, last,
			worst);
	if (!on_time || !over)
		printf("not ok %s: %s\n", m->name, on_time ? "rows over their samples" : "time");
	free(start), free(now), free(blind);
}

int main(void)
{
	unsigned z = 1;
	for (size_t i = 0; i < sizeof u / sizeof *u; i++) {
		z = z * 1664525u + 1013904223u;
		u[i] = (real)((double)(z >> 8) / 8388608.0 - 1);
	}
	for (int i = 0; i < SUBJECTS; i++)
		judge(&subject[i]);
	printf("ok all of %d\n", SUBJECTS);
	return 0;
}
