/* SPDX-License-Identifier: MIT-0 */
/* predict.h: predictors of a quadrature: a Runge-Kutta step of fourth order for y' = A y + B r, r being the nonlinear
 * remainder; loads and inputs act exactly.  Included by the file of the model, which defines before it
 *
 *     PL_TYPE                    the model, with member y
 *     PL_STATES, PL_FORCES       states; forces of the remainder
 *     PL_DRIVEN                  1: loads and inputs have a part in them
 *     PL_EVENT_SPLIT                     1: a step of event_split.h, of the forces of given intervals, which that says
 *
 *     PL(remainder)(s, which, node, u, slope, y, remainder)  forces at a node of the step, with operator `which`
 *     PL(slope_of)(which, z, remainder, dz)                 A z + B remainder */
#include "numbers.h"

#if PL_EVENT_SPLIT
#define PL_FORMULAS real when, const int interval[],
#else
#define PL_FORMULAS
#endif

/* y at node `end` of the step, tau [s] after its start, over node `half` in the middle; first: the slope at the start;
 * middle, last: what loads and inputs add from rest up to these nodes. */
static void PL(predict)(const PL_TYPE *s, int which, const real u[], const real slope[], int half, int end, real tau,
					PL_FORMULAS const real first[PL_STATES], const real middle[], const real last[],
						real y[PL_STATES])
{
	static const real ahead[3] = {(real)0.5, (real)0.5, 1}, weight[3] = {2, 2, 1};
	real z[PL_STATES], dz[PL_STATES], sum[PL_STATES], remainder[PL_FORCES];
	int i, k;
	for (i = 0; i < PL_STATES; i++) {
		dz[i] = first[i];
		sum[i] = first[i];
	}
	for (k = 0; k < 3; k++) {
		for (i = 0; i < PL_STATES; i++) {
			z[i] = s->y[i] + ahead[k] * tau * dz[i];
#if PL_DRIVEN
			y[i] = z[i] + (k < 2 ? middle[i] : last[i]);
#else
			y[i] = z[i];
#endif
		}
#if PL_EVENT_SPLIT
		PL(forces_at)(s, u, slope, k < 2 ? tau / 2 : tau, when, which, interval, y, remainder);
		PL(slope_of)(0, z, remainder, dz);
#else
		PL(remainder)(s, which, k < 2 ? half : end, u, slope, y, remainder);
		PL(slope_of)(which, z, remainder, dz);
#endif
		for (i = 0; i < PL_STATES; i++) {
			sum[i] += weight[k] * dz[i];
		}
	}
	for (i = 0; i < PL_STATES; i++) {
#if PL_DRIVEN
		y[i] = s->y[i] + tau / 6 * sum[i] + last[i];
#else
		y[i] = s->y[i] + tau / 6 * sum[i];
#endif
	}
	(void)half;
	(void)end;
	(void)middle;
	(void)last;
}

#include "undef.h"
