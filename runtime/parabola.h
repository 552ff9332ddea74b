/* SPDX-License-Identifier: MIT-0 */
/* parabola.h: NAME_at of a scheme with a nonlinear remainder: the linear part is exact under a parabola in time through
 * the remainder at both ends and in the middle of the step.  Off by the fourth power of h, as a step of the fourth
 * order is over all, times the third derivative of the remainder; what it misses at the end of the step is taken back
 * by the cube of the time, so that values meet those of the steps. Included by the file of the model behind its step,
 * which defines before it
 *
 *     PL_TYPE                    the model, with member y
 *     PL_STATES, PL_SIZE         the states; of x: these, what acts on them, and from PL_FORCE_COLUMN on of each of
 *     PL_FORCES                  remainders its value and two derivatives
 *     PL_MIDDLE, PL_END          points of the step: as PL(remainder_at) counts them, whose first is 0
 *     PL_BARE                    the step that looks for no peaks
 *     PL_CHOICE(s, u)            operator that serves
 *
 *     PL(vector_now)(s, u, x)              x at the start of the step, without the remainder
 *     PL(go_on)(s, which, tau, x)          e^{A tau} x
 *     PL(remainder_at)(s, which, point, u, y, remainder)   the remainder at state y */
#include "numbers.h"

#include "given.h"

/* x, part of h after now, of remainders at 0, 1/2 and 1 h */
static void PL(under)(const PL_TYPE *s, const real *u, int which, real remainder[3][PL_FORCES], real part,
					  real x[PL_SIZE])
{
	int i;
	PL(vector_now)(s, u, x);
	for (i = 0; i < PL_FORCES; i++) {
		real *const of = x + PL_FORCE_COLUMN + 3 * i;
		of[0] = remainder[0][i];
		of[1] = (4 * remainder[1][i] - 3 * remainder[0][i] - remainder[2][i]) / PL_H;
		of[2] = 4 * ((remainder[0][i] - remainder[1][i]) + (remainder[2][i] - remainder[1][i])) / PL_H / PL_H;
	}
	PL(go_on)(s, which, part * PL_H, x);
}

/* y tau [s] after now */
static PL_APART void PL(state_at)(const PL_TYPE *s, const real *u, real tau, real y[PL_STATES])
{
	const int which = PL_CHOICE(s, u);
	const real part = tau / PL_H;
	PL_TYPE end = *s;
	real remainder[3][PL_FORCES], x[PL_SIZE], missed[PL_STATES];
	int i;
	PL_BARE(&end PL_GIVEN);
	PL(remainder_at)(s, which, 0, u, s->y, remainder[0]);
	PL(remainder_at)(s, which, PL_END, u, end.y, remainder[2]);
	for (i = 0; i < PL_FORCES; i++) {
		remainder[1][i] = (remainder[0][i] + remainder[2][i]) / 2;
	}
	PL(under)(s, u, which, remainder, (real)1 / 2, x);
	PL(remainder_at)(s, which, PL_MIDDLE, u, x, remainder[1]);
	PL(under)(s, u, which, remainder, 1, x);
	for (i = 0; i < PL_STATES; i++) {
		missed[i] = end.y[i] - x[i];
	}
	PL(under)(s, u, which, remainder, part, x);
	for (i = 0; i < PL_STATES; i++) {
		y[i] = part > 0 ? x[i] + part * part * part * missed[i] : s->y[i];
	}
}

#include "undef.h"
