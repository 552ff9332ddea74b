/* SPDX-License-Identifier: MIT-0 */
/* Whether steps keep a tolerance: random starts of smooth models beside the equations by hand in long double, and what
 * each start's conditioning makes of a step's error. 20 starts a model; LONG=1: 400. TABLE=1: the figures as lines of
 * the table in doc/accuracy.md. */
#include "gragg.h"
#include "quadrant.h"
#include "starts_variants.h"
#include "systems.h"
#include "tap.h"

#include <math.h>

enum { MOST_STATES = 4, SECONDS = 10, MOST_STARTS = 400 };

static void rayleigh(real t, const real *y, const real *u, real *dydt)
{
	(void)t, (void)u;
	dydt[0] = y[1];
	dydt[1] = (1 - y[1] * y[1] / 3) * y[1] - y[0];
}

static void pair(real t, const real *y, const real *u, real *dydt)
{
	(void)t, (void)u;
	dydt[0] = y[2];
	dydt[1] = y[3];
	dydt[2] = (1 - y[0] * y[0]) * y[2] - y[0] + (y[1] - y[0]) / 2;
	dydt[3] = (1 - y[1] * y[1]) * y[3] - 1.2L * y[1] + (y[0] - y[1]) / 2;
}

/* 2 a'' + b'' cos(a - b) = right, a'' cos(a - b) + b'' = below: Lagrange's, solved by elimination */
static void double_pendulum(real t, const real *y, const real *u, real *dydt)
{
	const real c = cos_of(y[0] - y[1]), s = sin_of(y[0] - y[1]);
	const real right = -s * y[3] * y[3] - 2 * sin_of(y[0]), below = s * y[2] * y[2] - sin_of(y[1]);
	(void)t, (void)u;
	dydt[0] = y[2];
	dydt[1] = y[3];
	dydt[2] = (right - c * below) / (2 - c * c);
	dydt[3] = below - c * dydt[2];
}

static void spherical(real t, const real *y, const real *u, real *dydt)
{
	(void)t, (void)u;
	dydt[0] = y[2];
	dydt[1] = y[3];
	dydt[2] = sin_of(y[0]) * cos_of(y[0]) * y[3] * y[3] - sin_of(y[0]);
	dydt[3] = -2 * y[2] * y[3] / tanl(y[0]);
}

/* Starts: what lies evenly between `low` and `high` of each state */
static const struct subject {
	const char *name;
	equations *f;                       /* NULL: that of `systems` */
	int states;
	double low[MOST_STATES], high[MOST_STATES], bound;      /* of error over tolerance, geometric mean */
} subjects[] = {
	{"pendulum", NULL, 2, {-3, -2}, {3, 2}, 1},
	{"vanderpol", NULL, 2, {-3, -3}, {3, 3}, 1},
	{"quad2dof", NULL, 4, {-0.25, -0.25, -0.25, -0.25}, {0.25, 0.25, 0.25, 0.25}, 1},   /* energy below 1/6 */
	{"duffing", NULL, 2, {-2, -2}, {2, 2}, 1},
	{"mathieu", NULL, 2, {-2, -2}, {2, 2}, 1},
	{"rayleigh", rayleigh, 2, {-3, -3}, {3, 3}, 1},
	{"pair", pair, 4, {-2, -2, -2, -2}, {2, 2, 2, 2}, 1},
	{"double_pendulum", double_pendulum, 4, {-3, -3, -1, -1}, {3, 3, 1, 1}, 3},  /* chaotic */
	{"spherical", spherical, 4, {0.5, -3, -1, 0.5}, {2.5, 3, 1, 2}, 1},                 /* away from its poles */
};
enum { SUBJECTS = sizeof subjects / sizeof *subjects };

static double random_number(void)       /* between 0 and 1 */
{
	static unsigned seed = 1;
	seed = seed * 1103515245u + 12345u;
	return (double)(seed >> 8) / 16777216;
}

struct start {
	double y[MOST_STATES];
	real truth[SECONDS + 1][MOST_STATES];
	double most, conditioning;
};

static equations *field(const struct subject *s)
{
	return s->f ? s->f : system_of(s->name)->equations;
}

/* The largest gain of a deviation from the start, all states of one size, up to any of the seconds */
static double conditioning(const struct subject *s, const double *start)
{
	const real apart = 1e-8L;
	real gain[SECONDS + 1][MOST_STATES] = {{0}};
	double worst = 1;
	for (int j = 0; j < s->states; j++) {
		real up[HAND_MOST] = {0}, down[HAND_MOST] = {0};
		for (int i = 0; i < s->states; i++) {
			up[i] = start[i] + (i == j ? apart : 0);
			down[i] = start[i] - (i == j ? apart : 0);
		}
		for (int k = 1; k <= SECONDS; k++) {
			gragg(field(s), s->states, k - 1, k, 0.1L, 0, NULL, up);
			gragg(field(s), s->states, k - 1, k, 0.1L, 0, NULL, down);
			for (int i = 0; i < s->states; i++)
				gain[k][i] += fabsl(up[i] - down[i]) / (2 * apart);
		}
	}
	for (int k = 1; k <= SECONDS; k++)
		for (int i = 0; i < s->states; i++)
			worst = worse(worst, (double)gain[k][i]);
	return worst;
}

static void draw(const struct subject *s, struct start *drawn)
{
	real y[HAND_MOST] = {0};
	drawn->most = 0;
	for (int i = 0; i < s->states; i++)
		y[i] = drawn->truth[0][i] = drawn->y[i] = s->low[i] + (s->high[i] - s->low[i]) * random_number();
	for (int k = 1; k <= SECONDS; k++) {
		gragg(field(s), s->states, k - 1, k, 0.05L, 0, NULL, y);
		memcpy(drawn->truth[k], y, sizeof drawn->truth[k]);
	}
	for (int k = 0; k <= SECONDS; k++)
		for (int i = 0; i < s->states; i++)
			drawn->most = fmax(drawn->most, (double)fabsl(drawn->truth[k][i]));
	drawn->conditioning = conditioning(s, drawn->y);
}

/* The largest error at whole seconds over the largest size of a state there */
static double error_from(const struct subject *s, const pl_model *m, const struct start *start)
{
	double y[MOST_STATES], worst = 0;
	void *state = calloc(1, m->size);
	m->init(state);
	m->set(state, 0, start->y);
	for (int k = 1; k <= SECONDS; k++) {
		m->run(state, (size_t)lround(1 / m->h), NULL, NULL);
		m->get(state, y);
		for (int i = 0; i < s->states; i++)
			worst = worse(worst, (double)fabsl(y[i] - start->truth[k][i]));
	}
	if (m->status(state) != 0)
		worst = INFINITY;
	free(state);
	return worst / start->most;
}

static const char *starts_from(const struct subject *s, const struct start *start)
{
	static char text[100];
	int length = 0;
	for (int i = 0; i < s->states; i++)
		length += snprintf(text + length, sizeof text - (size_t)length, "%s%.3g", i ? ", " : "", start->y[i]);
	return text;
}

static int ascending(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static void keeps(const struct subject *s, int digits, const struct start *start, int count)
{
	const pl_model *m = variant_of(starts, "%s_e%d_taylor_0", s->name, digits)->model;
	static double ratio[MOST_STARTS];
	double sum = 0, most = 0, beside = 0, gains = 0;
	int worst = 0;
	for (int i = 0; i < count; i++) {
		ratio[i] = fmax(error_from(s, m, &start[i]), 1e-18) * pow(10, digits);
		sum += log(ratio[i]);
		gains += log(start[i].conditioning);
		if (ratio[i] > most)
			most = ratio[worst = i];
		beside = worse(beside, ratio[i] / start[i].conditioning);
	}
	qsort(ratio, (size_t)count, sizeof *ratio, ascending);
	const double mean = exp(sum / count), few = ratio[count * 9 / 10];
	bool good = close_to(mean, 0, s->bound, "%s, tolerance 1e-%d: error over it, geometric mean", s->name, digits);
	good = close_to(beside, 0, 5, "%s, tolerance 1e-%d: error over it and the conditioning", s->name, digits) &&
			good;
	ok(good, "%s, tolerance 1e-%d, %d starts: error over it %.2g in the mean, at most %.2g", s->name, digits, count,
		mean, most);
	if (getenv("TABLE"))
		note("| %s | 1e-%d | %.2g | %.2g | %.2g | %s | %.2g | %.2g | %.2g |", s->name, digits, mean, few, most,
			starts_from(s, &start[worst]), start[worst].conditioning, exp(gains / count), beside);
}

/* What they are held against: the same in pieces half as long */
static void truth_holds(const struct subject *s, const struct start *start)
{
	real y[HAND_MOST] = {0};
	double difference = 0;
	memcpy(y, start->truth[0], sizeof start->truth[0]);
	gragg(field(s), s->states, 0, SECONDS, 0.025L, 0, NULL, y);
	for (int i = 0; i < s->states; i++)
		difference = worse(difference, (double)fabsl(y[i] - start->truth[SECONDS][i]));
	difference /= start->conditioning * start->most;
	ok(close_to(difference, 0, 1e-15, "%s: extrapolation", s->name), "%s: extrapolation holds (%.2g)", s->name,
		difference);
}

int main(void)
{
	static struct start start[MOST_STARTS];
	const int count = getenv("LONG") ? MOST_STARTS : 12;
	for (int k = 0; k < SUBJECTS; k++) {
		for (int i = 0; i < count; i++)
			draw(&subjects[k], &start[i]);
		truth_holds(&subjects[k], &start[0]);
		keeps(&subjects[k], 5, start, count);
		keeps(&subjects[k], 9, start, count);
		keeps(&subjects[k], 12, start, count);
	}
	return tap_end();
}
