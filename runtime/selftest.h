/* SPDX-License-Identifier: MIT-0 */
/* selftest.h: a step on this target beside states in closed form, or where there is none beside those that the same
 * steps came to where the file was made: a wrong constant anywhere in NAME_step, NAME_jump, NAME_at or in the state
 * that NAME_init leaves shows as a deviation.  Included by the file of the model, which defines before it
 *
 *     PL(name), PL_SINGLE, PL_TYPE           the prefix of the model before a name; 1: in float; the model
 *     PL_KNOWN_H                 the step of the states that are known [s]
 *     PL_STATES, PL_INPUTS       the states; the inputs that a step is given
 *     PL_ROWS, PL_CROSSED        states that are known; crossings of breakpoints until the last of them
 *     PL_JUMPS, PL_AT            whether there is NAME_jump; NAME_at
 *
 *     PL(known_steps)[PL_ROWS]   after so many steps each
 *     PL(known_states)[PL_ROWS][PL_STATES], PL(known_between)[PL_STATES]   those states; at h/2
 *     PL(known_initial)[], PL(known_start)[]   what NAME_init sets; the start of the states that are known
 *     PL(known_unit)[]           one in the last place of the largest value that each state takes
 *     PL(known_crossing_step)[], PL(known_crossing)[][2]   per crossing the steps before it; how long after them, and
 *                                what rounding makes of that [s]
 *     PL(begin_again)(s)         what NAME_init does beside the state, and that start
 *     PL(known_sample)(ramp, u)  inputs, those that ramp at `ramp` */
#include "numbers.h"

#include "given.h"

/* The largest of worst and |y - known|, in units in the last place */
static real PL(deviation)(const real *y, const real *known, real worst)
{
	int i;
	for (i = 0; i < PL_STATES && worst == worst; i++) {
		const real off = (y[i] < known[i] ? known[i] - y[i] : y[i] - known[i]) / PL(known_unit)[i];
		if (!(off <= worst)) {
			worst = off; /* not a number, too: and it stays */
		}
	}
	return worst;
}

#if PL_CROSSED > 0
/* The larger of worst and how far crossings of the last step, that after k others, are from those in closed form, in
 * what rounding makes of their times; one that is missing or more is far off, and so are crossings that are listed
 * otherwise than by their order. */
static real PL(crossed_as)(const PL_TYPE *s, uint64_t k, int *found, real worst)
{
	pl_crossing crossing[PL_MAX_EVENTS];
	const int count = PL(crossings)(s, crossing);
	int i;
	for (i = 0; i < count; i++) {
		real off;
		if (k == 0 && !(crossing[i].time > (real)0.0009765625 * PL_KNOWN_H)) {
			continue; /* where the start stands is found there */
		}
		if (*found == PL_CROSSED) {
			return (real)1e30;
		}
		off = ((real)k - (real)PL(known_crossing_step)[*found]) * PL_KNOWN_H + crossing[i].time -
			  PL(known_crossing)[*found][0];
		off = (off < 0 ? -off : off) / PL(known_crossing)[*found][1];
		if (!(off <= worst) && worst == worst) {
			worst = off;
		}
		++*found;
	}
	return worst;
}
#endif

static real PL(replayed)(PL_TYPE *s, real worst)
{
	real y[PL_STATES];
	uint64_t k = 0;
	int i;
#if PL_CROSSED > 0
	int found = 0;
#endif
#if PL_INPUTS > 0
	real u[PL_INPUTS];
#endif
	PL(begin_again)(s);
	for (i = 0; i < PL_ROWS; i++) {
		for (; k < PL(known_steps)[i]; k++) {
#if PL_INPUTS > 0
			PL(known_sample)(-(real)k, u);
#endif
			PL(step)(s PL_GIVEN);
#if PL_CROSSED > 0
			worst = PL(crossed_as)(s, k, &found, worst);
#endif
		}
		PL(get)(s, y);
		worst = PL(deviation)(y, PL(known_states)[i], worst);
	}
#if PL_CROSSED > 0
	if (found != PL_CROSSED) {
		worst = (real)1e30;
	}
#endif
#if PL_JUMPS
	PL(set)(s, 0, PL(known_start));
	PL(jump)(s, PL(known_steps)[PL_ROWS - 1]);
	PL(get)(s, y);
	worst = PL(deviation)(y, PL(known_states)[PL_ROWS - 1], worst);
#endif
#if PL_AT
	PL(begin_again)(s);
#if PL_INPUTS > 0
	PL(known_sample)(0, u);
#endif
	PL(at)(s PL_GIVEN, (real)0.5 * PL_KNOWN_H, y);
	worst = PL(deviation)(y, PL(known_between), worst);
#endif
	return worst;
}

real PL(selftest)(void)
{
	/* What a compiler makes of a copy of constants is not what it makes of loops over states: gcc 12 errs with
	 * AVX-512.
	 * Neither the instance nor the values that NAME_init is held against are known to it. */
	const real *volatile from = PL(known_initial);
	PL_TYPE s, *volatile at = &s;
	real y[PL_STATES], begun[PL_STATES], worst = PL(replayed)(&s, 0);
	PL(init)(at);
	PL(get)(at, y);
	PL(set)(at, 0, from);
	PL(get)(at, begun);
	return PL(deviation)(y, begun, worst);
}

#include "undef.h"
