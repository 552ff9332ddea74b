/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_batch against NAME_step of each instance alone: states, outputs and peaks, with counts of instances that fill no
 * group of lanes, and steps in several calls. -DTUNED: with coefficients of its own in each instance. The sums are
 * the same, so are the bits; where products are contracted, a unit a step in the last place of the largest value, or of
 * what states of their largest values add to an output: the force of a stop is a small difference of large terms.
 * With every other count no outputs are wanted: then NAME_batch looks for extremes inside steps another way. And
 * instances that are not finite, which their status says, beside others. */
#include "m.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef REAL_FLOAT
typedef float real;
#define UNIT 0x1p-23
#else
typedef double real;
#define UNIT 0x1p-52
#endif

enum { MOST = 70, STEPS = 330, INPUTS = M_INPUTS ? M_INPUTS : 1 };

static m alone[MOST];
static real y[M_BATCH_ROWS * MOST], peak[M_OUTPUTS * MOST], out[STEPS * M_OUTPUTS * MOST], u[STEPS * INPUTS];
static real greatest[MOST][M_OUTPUTS];
static double widest[MOST][M_STATES];    /* the largest of each state */
static double steepest[MOST][M_OUTPUTS][M_STATES];      /* the largest slope of each output along each state */
#ifdef TUNED
static real factors[M_BATCH_FACTORS * MOST];
#endif

static double draw(void)                /* -1 .. 1 */
{
	static uint32_t state = 7;
	state = state * 1664525u + 1013904223u;
	return (double)state / 2147483648.0 - 1.0;
}

static void start(m_instances *b)
{
	size_t j;
	m_batch_init(b);
	for (j = 0; j < b->count; j++) {
		real now[M_STATES], first[M_OUTPUTS];
		int i;
		m_init(&alone[j]);
		for (i = 0; i < M_STATES; i++)
			now[i] = (real)draw();
		if (j > 0) {                    /* instance 0 stays with the spec's initial values */
			m_set(&alone[j], 0, now);
			m_batch_set(b, j, now);
		}
#ifdef TUNED
		m_coeffs c = m_nominal;
		real params[M_PARAMS];
		for (i = 0; i < M_PARAMS; i++)
			params[i] = m_nominal.params[i] * (real)(1.0 + 0.2 * draw());
		if (m_retune(&c, params, M_H) == 0) {
			m_use(&alone[j], &c);
			if (m_batch_use(b, j, &c) != 0)
				printf("# instance %zu does not take its coefficients\n", j);
		}
		m_get(&alone[j], now);
		m_batch_set(b, j, now);         /* peaks of outputs with these params */
#endif
		m_out(&alone[j], first);
		for (i = 0; i < M_OUTPUTS; i++)
			greatest[j][i] = (real)fabs((double)first[i]);
		memset(widest[j], 0, sizeof widest[j]);
		memset(steepest[j], 0, sizeof steepest[j]);
	}
}

/* The largest deviation, in units in the last place of the largest value of that state or output */
static double worst;
static void compare(const char *what, size_t j, double batch, double single, double largest)
{
	double off = fabs(batch - single) / (UNIT * (largest > 0 ? largest : 1));
	if (!(off <= worst)) {
		worst = off;
		if (!(off <= 2.0 * STEPS))
			printf("# %s of instance %zu: %.17g in the batch, %.17g alone\n", what, j, batch, single);
	}
}

/* Outputs of a copy that is set, so that it is not known what its inputs were */
static void look(size_t j, const real now[], real found[])
{
	m copy = alone[j];
	m_set(&copy, m_time(&copy), now);
	m_out(&copy, found);
}

/* Slopes by differences to that side where they are less: on the other one there may be a jump. */
static void widen(size_t j)
{
	const real rise = (real)0x1p-10;
	real now[M_STATES], at[M_OUTPUTS], above[M_OUTPUTS], below[M_OUTPUTS];
	int i, k;
	m_get(&alone[j], now);
	look(j, now, at);
	for (k = 0; k < M_STATES; k++) {
		const real here = now[k];
		widest[j][k] = fmax(widest[j][k], fabs((double)here));
		now[k] = here + rise;
		look(j, now, above);
		now[k] = here - rise;
		look(j, now, below);
		now[k] = here;
		for (i = 0; i < M_OUTPUTS; i++) {
			const double up = fabs((double)(above[i] - at[i])), down = fabs((double)(at[i] - below[i]));
			steepest[j][i][k] = fmax(steepest[j][i][k], fmin(up, down) / (double)rise);
		}
	}
}

/* What a unit in the last place of an output is of */
static double size_of(size_t j, int output)
{
	double sum = 0;
	int k;
	for (k = 0; k < M_STATES; k++)
		sum += steepest[j][output][k] * widest[j][k];
	return fmax((double)greatest[j][output], sum);
}

static void step_alone(size_t count, int outputs)
{
	size_t j;
	int k, i;
	for (j = 0; j < count; j++)
		for (k = 0; k < STEPS; k++) {
			real now[M_OUTPUTS];
#if HAS_INPUTS
			m_step(&alone[j], u + k * M_INPUTS);
#else
			m_step(&alone[j]);
#endif
			m_out(&alone[j], now);
			widen(j);
			for (i = 0; i < M_OUTPUTS; i++) {
				size_t row = (size_t)(k * M_OUTPUTS + i) * count;
				greatest[j][i] = (real)fmax((double)greatest[j][i], fabs((double)now[i]));
				if (outputs)
					compare("an output", j, (double)out[row + j], (double)now[i], size_of(j, i));
			}
		}
}

static void step_together(m_instances *b, int outputs)
{
	static const size_t part[] = {1, 0, 63, STEPS - 64};
	size_t i, at = 0;
	for (i = 0; i < sizeof part / sizeof *part; i++) {
		real *rows = outputs ? out + at * M_OUTPUTS * b->count : NULL;
#if HAS_INPUTS
		m_batch(b, part[i], u + at * M_INPUTS, rows);
#else
		m_batch(b, part[i], rows);
#endif
		at += part[i];
	}
}

static void judge(const m_instances *b)
{
	size_t j;
	int i;
	for (j = 0; j < b->count; j++) {
		real together[M_STATES], single[M_STATES];
		m_batch_get(b, j, together);
		m_get(&alone[j], single);
		for (i = 0; i < M_STATES; i++)
			compare("a state", j, (double)together[i], (double)single[i], widest[j][i]);
		for (i = 0; i < M_OUTPUTS; i++)
			compare("a peak", j, (double)peak[(size_t)i * b->count + j], (double)greatest[j][i],
					size_of(j, i));
	}
	if (m_time(&b->shared) != m_time(&alone[0]))
		compare("the time", 0, (double)m_time(&b->shared), (double)m_time(&alone[0]), 1e-300);
}

/* What is not a number in one instance, or infinite in another, is told of these two, and no other has it. */
static int told(size_t count, int outputs)
{
	m_instances b = {0};
	size_t j;
	int wrong = 0;
	b.count = count;
	b.y = y;
	b.peak = peak;
#ifdef TUNED
	b.factors = factors;
#endif
	start(&b);
	for (j = 1; j < count; j += 4) {
		real now[M_STATES];
		m_batch_get(&b, j, now);
		now[j % M_STATES] = j % 8 == 1 ? (real)NAN : (real)HUGE_VAL;
		m_batch_set(&b, j, now);
		m_set(&alone[j], 0, now);
		wrong += m_batch_status(&b, j) != m_status(&alone[j]);
	}
	step_together(&b, outputs);
	step_alone(count, 0);
	for (j = 0; j < count; j++) {
		const int status = m_batch_status(&b, j), expected = m_status(&alone[j]);
		real together[M_STATES], single[M_STATES];
		int i;
		wrong += status != expected || (status & PL_NOT_FINITE) != (j % 4 == 1 ? PL_NOT_FINITE : 0);
		if (status != expected)
			printf("# status of instance %zu of %zu: %d, expected %d\n", j, count, status, expected);
		m_batch_get(&b, j, together);
		m_get(&alone[j], single);
		for (i = 0; i < M_STATES && expected == 0; i++)
			compare("a state beside what is not finite", j, (double)together[i], (double)single[i],
					widest[j][i]);
	}
	return wrong;
}

int main(int argc, char **argv)
{
	static const size_t counts[] = {1, 2, 3, 7, 16, 33, MOST};
	const size_t some = sizeof counts / sizeof *counts - (getenv("LONG") == NULL) -
		(getenv("LONG") == NULL && getenv("MERGE") == NULL);      /* of the last two a half each */
	double bound = argc > 1 ? atof(argv[1]) : 0;
	size_t i;
	int wrong;
	for (i = 0; i < sizeof u / sizeof *u; i++)
		u[i] = (real)draw();
	for (i = 0; i < some; i++) {
		m_instances b = {0};
		b.count = counts[i];
		b.y = y;
		b.peak = peak;
#ifdef TUNED
		b.factors = factors;
#endif
		start(&b);
		step_together(&b, i % 2 == 0);
		step_alone(b.count, i % 2 == 0);
		judge(&b);
	}
	wrong = told(7, 1) + told(33, 0);
	printf("# %.3g units in the last place, at most %g; %d statuses wrong\n", worst, bound, wrong);
	return !(worst <= bound && wrong == 0);
}
