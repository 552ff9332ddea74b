/* SPDX-License-Identifier: MIT-0 */
/* reach.h: how far a Taylor series of the solution holds: by its last terms, relative to the largest size of each state
 * so far (Jorba and Zou 2005); by what coefficients may not show; by the slopes that the equations have further on.
 * Part of taylor.h, and beside a collocation on its own, after
 *
 *     PL(name), PL_TYPE          the model's prefix before a name; its type, with members scale and unit
 *     PL_STATES, PL_COLUMNS      of a series c; behind the states stands what else is watched
 *     PL_MEASURED                columns behind the states whose last terms count too
 *     PL_ORDER, PL_TOLERANCE, PL_H     of the series; relative; [s]
 *     PL_REMAINDERS              of each of the last two terms: 1, itself; 3, and two that stand in for it
 *     PL_KINDS, PL_FLOORS        as measure.h
 *     PL_UNRESOLVED, PL_HIDDEN       whether there is what coefficients may not show; how many functions, of each in
 *                                PL(hidden)[] the column of the argument, the kind, a power
 *     PL_BEATS                   [h] loads that may cancel each other are followed so far; 0: there are none
 *     PL_RISES, PL_RISES_FACTOR  what an exponent may gain over a series; e to it
 *     PL_SLOPES                  whether slopes further on are looked at, with
 *     PL(slopes_at)(s, start, slope, tau, when, segment, interval, y, left)   h times those at y, tau after now
 *     PL(ahead)(c, theta, gain)  what the series gains from its start, theta of its unit of time later */
#include "measure.h"

#if PL_SINGLE
#define PL_SLOPE_ROUNDED ((real)1e-5) /* of a slope, what rounding may have done to it */
#else
#define PL_SLOPE_ROUNDED 1e-13
#endif

/* ---- its last terms ---- */

#if PL_KINDS
/* What counts of state i in a step that began with 0 in all of its kind, where no size is known yet */
static PL_APART real PL(least_size)(const real y[], int i)
{
	real most = 0;
	int k;
	(void)i; /* there may be one kind alone */
	for (k = 0; k < PL_STATES; k++) {
		const real size = PL_KIND(k) == PL_KIND(i) && PL_COUNTS(k) == 1 ? pl_magnitude(y[k]) : 0;
		most = size > most ? size : most;
	}
	return most / 1048576;
}
#endif

#if PL_KINDS && PL_CONSTRAINTS
/* 1 over what counts of state i that was always 0: of what its kind gains first. By itself it may gain no more than
 * what rounding leaves of forces that constraints bear; 0: its own gain is larger, or there is none. */
static inline real PL(unit_of_gain)(const real c[PL_ORDER + 1][PL_COLUMNS], int i)
{
	const real one = pl_magnitude(c[1][i]), two = pl_magnitude(c[2][i]), own = one > two ? one : two;
	const real first = PL(least_size)(c[1], i), second = PL(least_size)(c[2], i);
	const real least = first > second ? first : second;
	return least > own ? PL(one_over)(least, 0) : 0;
}
#endif

/* 1 over the size that counts for column i at the start of the series, or where that is 0 of what it gains first */
static inline real PL(unit_at)(const PL_TYPE *s, const real c[PL_ORDER + 1][PL_COLUMNS], int i)
{
	const real now = pl_magnitude(c[0][i]), one = pl_magnitude(c[1][i]), two = pl_magnitude(c[2][i]);
	real unit;
#if PL_KINDS
	unit = now * s->unit[i] > 1 && now > s->scale[i] ? 1 / now : s->unit[i];
#else
	unit = now > s->scale[i] ? 1 / now : s->unit[i];
#endif
#if PL_FLOORS
	unit = PL(floor)[i] > 0 ? 1 / (now + PL(floor)[i]) : unit;
#endif
#if PL_KINDS
	if (unit == 0 && i < PL_STATES) {
		const real least = PL(least_size)(c[0], i);
		unit = least > now ? PL(one_over)(least, 0) : unit;
#if PL_CONSTRAINTS
		unit = unit == 0 && now == 0 ? PL(unit_of_gain)(c, i) : unit;
#endif
	}
#endif
	return unit == 0 ? PL(one_over)(now > one ? now : one > two ? one : two, 1) : unit;
}

static inline real PL(larger)(real a, real size)
{
	return size <= a ? a : size;
}

/* The last two coefficients over the size of each column.  Of a series in t^n alone they may be 0, or nearly: then
 * those before stand in for them, each two orders over 256, which is more than full series fall. */
static void PL(remainders)(const PL_TYPE *s, const real c[PL_ORDER + 1][PL_COLUMNS], real last[PL_REMAINDERS],
						   real before[PL_REMAINDERS])
{
	int i;
	for (i = 0; i < PL_REMAINDERS; i++) {
		last[i] = before[i] = 0;
	}
	for (i = 0; i < PL_STATES + PL_MEASURED; i++) {
		const real unit = PL_COUNTS(i) ? PL(unit_at)(s, c, i) : 0;
		last[0] = PL(larger)(last[0], pl_magnitude(c[PL_ORDER][i]) * unit);
#if PL_ORDER > 2
		before[0] = PL(larger)(before[0], pl_magnitude(c[PL_ORDER - 1][i]) * unit);
#endif
#if PL_REMAINDERS > 1 && PL_ORDER > 3
		last[1] = PL(larger)(last[1], pl_magnitude(c[PL_ORDER - 2][i]) * unit / 256);
#endif
#if PL_REMAINDERS > 1 && PL_ORDER > 4
		before[1] = PL(larger)(before[1], pl_magnitude(c[PL_ORDER - 3][i]) * unit / 256);
#endif
#if PL_REMAINDERS > 1 && PL_ORDER > 5
		last[2] = PL(larger)(last[2], pl_magnitude(c[PL_ORDER - 4][i]) * unit / 65536);
#endif
#if PL_REMAINDERS > 1 && PL_ORDER > 6
		before[2] = PL(larger)(before[2], pl_magnitude(c[PL_ORDER - 5][i]) * unit / 65536);
#endif
	}
}

/* ---- what coefficients may not show ---- */

#if PL_UNRESOLVED
#if PL_HIDDEN > 0
#include "unresolved.h"
#endif

/* Whether the coefficients show what the equations do over `size` from their start */
static int PL(shows)(const real c[PL_ORDER + 1][PL_COLUMNS], real size)
{
#if PL_HIDDEN > 0
	int i;
	if (PL_BEATS > 0 && size > PL_BEATS) {
		return 0;
	}
	for (i = 0; i < PL_HIDDEN; i++) {
		if (!PL(follows)(&c[0][PL(hidden)[i][0]], PL_COLUMNS, PL_ORDER, size, PL(hidden)[i][1],
						 PL_RISES / (real)PL(hidden)[i][2], PL_RISES_FACTOR)) {
			return 0;
		}
	}
	return 1;
#else
	(void)c;
	return !(PL_BEATS > 0 && size > PL_BEATS);
#endif
}
#endif

/* ---- slopes further on ---- */

#if PL_SLOPES || PL_ADAPTIVE
/* The slope of state i, theta after the start of the series */
static inline real PL(slope_along)(const real c[PL_ORDER + 1][PL_COLUMNS], int i, real theta)
{
	real slope = 0;
	int k;
	for (k = PL_ORDER; k > 0; k--) {
		slope = slope * theta + (real)k * c[k][i];
	}
	return slope;
}
#endif

#if PL_SLOPES
/* Whether the series has, `size` and half of it from its start, the slopes that the equations have there */
static int PL(meets)(const PL_TYPE *s, const real start[], const real slope[], real tau, real when, int segment,
					 const int interval[], const real c[PL_ORDER + 1][PL_COLUMNS], real size)
{
	real gain[PL_STATES], y[PL_STATES], left[PL_STATES], theta = size;
	int i, place;
	for (place = 0; place < 2; place++) {
		PL(ahead)(c, theta, gain);
		for (i = 0; i < PL_STATES; i++) {
			y[i] = c[0][i] + gain[i];
		}
		PL(slopes_at)(s, start, slope, tau + theta * PL_H, when, segment, interval, y, left);
		for (i = 0; i < PL_STATES; i++) {
			const real along = PL(slope_along)(c, i, theta);
			real large = pl_magnitude(y[i]);
			if (s->unit[i] > 0 && large * s->unit[i] < 1) {
				large = 1 / s->unit[i];
			}
#if PL_KINDS
			if (s->unit[i] == 0) {
				const real least = PL(least_size)(y, i);
				large = least > large ? least : large;
			}
#endif
			real rounded = PL_SLOPE_ROUNDED * pl_magnitude(left[i]);
#if PL_KINDS && PL_CONSTRAINTS
			/* What constraints bear is 0 by differences of what others of its kind get. */
			rounded += PL_SLOPE_ROUNDED * 16384 * PL(least_size)(left, i);
#endif
			if (PL_COUNTS(i) && !(pl_magnitude(left[i] - along) * theta
					<= 2 * PL_ORDER * PL_TOLERANCE * large + rounded * theta)) {
				return 0;
			}
		}
		theta /= 2;
	}
	return 1;
}
#endif
