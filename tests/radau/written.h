/* SPDX-License-Identifier: MIT-0 */
/* What every model by hand has before radau.h: one coordinate, three stages.  The model's file defines MODEL, MODEL_H,
 * MODEL_TOLERANCE, MODEL_TRIES, MODEL_STATES (2: of second order), MODEL_ENTRIES, MODEL_entry and
 * MODEL_motion(t, y, left, jacobian). */
#define PASTE(a, b) a##_##b
#define JOIN(a, b) PASTE(a, b)
#define PL(name) JOIN(MODEL, name)
#define PL_TYPE MODEL
#define PL_H ((real)(MODEL_H))
#define PL_TOLERANCE ((real)(MODEL_TOLERANCE))
#define PL_SOLVED (PL_TOLERANCE / 20)
#ifdef REAL_IS_FLOAT
#define PL_SINGLE 1
#endif
#define PL_STATES MODEL_STATES
#define PL_COLUMNS MODEL_STATES
#define PL_COORDS 1
#define PL_STAGES 3
#define PL_ENTRIES MODEL_ENTRIES
#define PL_KNOWN 1
#define PL_ARGUMENTS 0
#define PL_ORDER 0
#define PL_TRIES MODEL_TRIES
#define PL_CROWDED 0
#define PL_SHARE_OF_FIRST 1
#define PL_KIND(i) (i)

#include "numbers.h"

typedef struct MODEL {
	real y[MODEL_STATES], low[MODEL_STATES], start[MODEL_STATES], gain[MODEL_STATES], poly[4][MODEL_STATES];
	real at, at_low, size, per, want, scale[MODEL_STATES], unit[MODEL_STATES];
	double t;
	int back, stop, ready, status;
} MODEL;

static void PL(inputs_now)(const MODEL *s, const real u[], real start[], real slope[])
{
	(void)s, (void)u;
	start[0] = slope[0] = 0;
}

static void PL(known)(const MODEL *s, real tau, real inside, int segment, const real start[], const real slope[],
					  real known[])
{
	(void)inside, (void)segment, (void)start, (void)slope;
	known[0] = (real)s->t + tau;
}

static void PL(linearize)(const real known[], const int interval[], const real y[], real left[], real jacobian[])
{
	(void)interval;
	PL(motion)(known[0], y, left, jacobian);
}

/* Of all three the tables are the same: filled once, from the nodes. */
static real PL(node)[3], PL(once)[3][3], PL(twice)[3][3], PL(monomial)[3][3];

static void PL(tables)(void)
{
	int i, j, m;
	for (j = 0; j < 3; j++) {
		const double a = nodes[(j + 1) % 3], b = nodes[(j + 2) % 3],
				scale = 1 / ((nodes[j] - a) * (nodes[j] - b));
		const double c[3] = {a * b * scale, -(a + b) * scale, scale}; /* is 1 at node j and 0 at the others */
		PL(node)[j] = (real)nodes[j];
		for (i = 0; i < 3; i++) {
			double once = 0, twice = 0;
			for (m = 0; m < 3; m++) {
				once += c[m] * pow(nodes[i], m + 1) / (m + 1);
				twice += c[m] * pow(nodes[i], m + 2) / ((m + 1) * (m + 2));
			}
			PL(once)[i][j] = (real)once;
			PL(twice)[i][j] = (real)twice;
			PL(monomial)[i][j] = (real)c[i];
		}
	}
}

#include "radau.h"

/* A step of h */
static void JOIN(MODEL, step)(MODEL *s)
{
	const int wrong = JOIN(MODEL, collocated)(s, NULL);
	s->t += MODEL_H;
	JOIN(MODEL, settle)(s, wrong);
}

#undef PASTE
#undef JOIN
#undef MODEL
#undef MODEL_H
#undef MODEL_TOLERANCE
#undef MODEL_TRIES
#undef MODEL_STATES
#undef MODEL_ENTRIES
