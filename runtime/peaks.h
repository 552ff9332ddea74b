/* SPDX-License-Identifier: MIT-0 */
/* peaks.h: output NAME = peak(EXPR), the largest |EXPR| so far: larger values are searched inside each step, before the
 * state is advanced, or after it by values of NAME_at.  Included by the file of the model, which defines before it
 *
 *     PL_PEAKS, PL(peak_output)[]       how many such outputs, and which
 *     PL_BY_VALUES                      1: by values.  PL_RAMPS: of inputs, some ramp
 *     PL_DERIVATIVES                    above 0: derivatives.h asks when they are
 *
 * and else
 *
 *     PL_SIZE                           numbers of x: the states and what acts on them
 *     PL_SLOPE, PL_BEND                 [PL_SIZE][PL_SIZE], [PL_PEAKS][PL_SIZE] of s: x' = slope x; bend |x| is at
 *                                       least what an output is off its chord in a step
 *     PL_PEAK_ROW(c, p)                 peak p over x, with coefficients c
 *     PL_OWN, PL_REACHES                whether params change them; is c->reach[] there: as many times the
 *                                       PL(nominal).bend of what acts on the states is at least theirs
 *
 * and behind it PL(begin_step)(s, u, x), x at the start of a step; PL(one_step), the step itself; PL(now), outputs as
 * they are.  Instances of a batch look for peaks by PL(look), too. */
#include "numbers.h"

#include "given.h"

static void PL(one_step)(PL_TYPE *s PL_TAKEN);
static void PL(now)(const PL_TYPE *s, real out[PL_OUTPUTS]);

#if PL_BY_VALUES || PL_DERIVATIVES > 0

/* Outputs `part` of a step after its start, s, at whose end it is `after`; then: for it to work in */
static void PL(values)(const PL_TYPE *s, const PL_TYPE *after, const real *u, real part, PL_TYPE *then,
					   real out[PL_OUTPUTS])
{
	real y[PL_STATES];
#if PL_INPUTS > 0
	int i;
#endif
	PL(at)(s PL_GIVEN, part * PL_H, y);
	PL(set)(then, PL(time)(s) + part * PL_H, y);
#if PL_INPUTS > 0
	for (i = 0; i < PL_INPUTS; i++) {
		then->u[i] = after->u[i];
#if PL_RAMPS
		then->u[i] -= (1 - part) * PL_H * after->slope[i];
		then->slope[i] = after->slope[i];
#endif
	}
#endif
	PL(now)(then, out);
	(void)after;
	(void)u;
}

#endif

#if PL_BY_VALUES

/* Larger values inside the step, and when.  Whether it is as smooth as its ends would show in the next */
static PL_APART int PL(look_inside)(const PL_TYPE *s, const PL_TYPE *after, const real *u, int o, real begin,
									real end, real *peak, real *when)
{
	PL_TYPE then = *s;
	pl_peak_values looked;
	real part = pl_peak_begin(&looked, begin, end, *peak);
	while (part >= 0) {
		real out[PL_OUTPUTS];
		PL(values)(s, after, u, part, &then, out);
		part = pl_peak_next(&looked, out[o]);
	}
	*when = looked.peak > *peak ? looked.when : -1;
	*peak = looked.peak;
	return looked.apart >= PL_PEAK_TIMES / 8;
}

/* Where the second difference of the last three ends says that nothing passes the peak, it is not looked inside. */
void PL(step)(PL_TYPE *s PL_TAKEN)
{
	const PL_TYPE before = *s;
	real begin[PL_OUTPUTS], end[PL_OUTPUTS], when;
	int p;
	PL(now)(s, begin);
	PL(one_step)(s PL_GIVEN);
	PL(now)(s, end);
	for (p = 0; p < PL_PEAKS; p++) {
		const int o = PL(peak_output)[p];
		const real rise = end[o] - begin[o], bend = pl_magnitude(rise - s->rise[p]);
		const real from = pl_magnitude(begin[o]), to = pl_magnitude(end[o]);
		if (!((from > to ? from : to) + bend <= s->peak[p])) {
			const int smooth = PL(look_inside)(&before, s, PL_THE_INPUTS, o, begin[o], end[o], &s->peak[p],
					&when);
			s->rise[p] = smooth ? rise : (real)1e30;
		} else {
			s->rise[p] = rise;
		}
	}
}

#else

static void PL(begin_step)(const PL_TYPE *s, const real *u, real x[PL_SIZE]);

/* Larger values inside the step from x to outputs `end`, into peak[] */
static void PL(look)(const PL_TYPE *s, const real x[PL_SIZE], const real end[PL_OUTPUTS], real peak[PL_PEAKS])
{
	real work[PL_PEAK_WORK(PL_SIZE)], when;
	int p;
	for (p = 0; p < PL_PEAKS; p++) {
		peak[p] = pl_peak(PL_SIZE, PL_SLOPE[0], PL_PEAK_ROW(&s->coeffs, p), PL_BEND[p], PL_H, x,
						  end[PL(peak_output)[p]], peak[p], &when, work);
	}
	(void)s;
}

#if PL_OWN
/* Of the slopes A, bends over a step h [s] */
static void PL(retune_peaks)(PL(coeffs) *c, const pl_two *A, real h)
{
	real work[PL_PEAK_WORK(PL_SIZE)];
	int i, j, p;
	for (i = 0; i < PL_SIZE; i++) {
		for (j = 0; j < PL_SIZE; j++) {
			c->slope[i][j] = A[i * PL_SIZE + j].hi;
		}
	}
	for (p = 0; p < PL_PEAKS; p++) {
		pl_peak_bend(PL_SIZE, c->slope[0], PL_PEAK_ROW(c, p), h, c->bend[p], work);
#if PL_REACHES
		c->reach[p] = 0;
		for (i = PL_STATES; i < PL_SIZE; i++) {
			if (c->bend[p][i] > c->reach[p] * PL(nominal).bend[p][i]) {
				c->reach[p] = c->bend[p][i] / PL(nominal).bend[p][i];
			}
		}
#endif
	}
}
#endif

void PL(step)(PL_TYPE *s PL_TAKEN)
{
	real x[PL_SIZE], end[PL_OUTPUTS];
	PL(begin_step)(s, PL_THE_INPUTS, x);
	PL(one_step)(s PL_GIVEN);
	PL(now)(s, end);
	PL(look)(s, x, end, s->peak);
}

#endif

#if PL_DERIVATIVES > 0
/* The largest |output| above `low` of the step from s to `after`, and when, as a part of it; else `low`, and -1 */
static real PL(top)(const PL_TYPE *s, const PL_TYPE *after, const real *u, int p, real low, real *when)
{
	const int o = PL(peak_output)[p];
	real end[PL_OUTPUTS];
#if PL_BY_VALUES
	real begin[PL_OUTPUTS], most;
	PL(now)(s, begin);
#else
	real x[PL_SIZE], work[PL_PEAK_WORK(PL_SIZE)];
	PL(begin_step)(s, u, x);
#endif
	*when = -1;
	PL(now)(after, end);
#if PL_BY_VALUES
	most = pl_magnitude(begin[o]) > pl_magnitude(end[o]) ? pl_magnitude(begin[o]) : pl_magnitude(end[o]);
	if (most + pl_magnitude(end[o] - begin[o] - s->rise[p]) > low) {
		(void)PL(look_inside)(s, after, u, o, begin[o], end[o], &low, when);
	}
	return low;
#else
	return pl_peak(PL_SIZE, PL_SLOPE[0], PL_PEAK_ROW(&s->coeffs, p), PL_BEND[p], PL_H, x, end[o], low, when, work);
#endif
}
#endif

void PL(out)(const PL_TYPE *s, real out[PL_OUTPUTS])
{
	int p;
	PL(now)(s, out);
	for (p = 0; p < PL_PEAKS; p++) {
		const int o = PL(peak_output)[p];
		const real size = pl_magnitude(out[o]);
		out[o] = s->peak[p] > size ? s->peak[p] : size;
	}
}

#include "undef.h"
