/* SPDX-License-Identifier: MIT-0 */
/* series_lanes.h: steps of a series of fixed order over lanes, as taylor.h has them of one instance.  Included by the
 * file of the model behind lanes.h, with
 *
 *     PL_STATES, PL_ORDER        states; the last power of time
 *     PL_OVER                    steps that a series is over: what of an instance a step changes is then, behind states
 *                                and low parts, the steps since it began, the state at its end, in two parts, and it
 *
 *     PL(lanes_expand)(y, factor, now, c)     the series from y on: as PL(expand_from) has it
 *     PL(lanes_total)(c, y, end, low)         where it ends
 *     PL(part_of)[]                           of PL_OVER above 1, as taylor.h has it */
#include "numbers.h"

/* The lanes in which all of y is finite: its difference from itself is 0 */
PL_LANES_INLINE pl_lanes_truth PL(lanes_finite)(const pl_lanes *y)
{
	pl_lanes sum = pl_lanes_all(0);
	int i;
	PL_LANES_UNROLL
	for (i = 0; i < PL_STATES; i++) {
		sum = sum + (y[i] - y[i]);
	}
	return pl_lanes_equal(sum, pl_lanes_all(0));
}

PL_LANES_INLINE void PL(lanes_copy)(pl_lanes *to, const pl_lanes *from, const int count)
{
	int i;
	PL_LANES_UNROLL
	for (i = 0; i < count; i++) {
		to[i] = from[i];
	}
}

PL_LANES_INLINE void PL(lanes_take_over)(pl_lanes *to, pl_lanes_truth where, const pl_lanes *from, const int count)
{
	int i;
	PL_LANES_UNROLL
	for (i = 0; i < count; i++) {
		to[i] = pl_lanes_choose(where, from[i], to[i]);
	}
}

#if PL_OVER > 1
#define PL_SERVED_ROW (2 * PL_STATES)
#define PL_END_ROW (PL_SERVED_ROW + 1)
#define PL_SERIES_ROW (PL_END_ROW + 2 * PL_STATES)

/* Lanes whose series has ended get another one; said are those in which it is finite, or goes on.  As a rule that is
 * so of all lanes at a time, and what they had is overwritten. */
PL_LANES_INLINE pl_lanes_truth PL(lanes_renew)(pl_lanes *y, const pl_lanes *factor, const real *now)
{
	pl_lanes some[(PL_ORDER + 3) * PL_STATES];
	const pl_lanes zero = pl_lanes_all(0);
	const pl_lanes_truth fresh = pl_lanes_equal(y[PL_SERVED_ROW], zero);
	const pl_lanes_truth goes_on = pl_lanes_below(zero, y[PL_SERVED_ROW]);
	pl_lanes *const end = pl_lanes_flags(goes_on) == 0 ? y + PL_END_ROW : some;
	pl_lanes_truth finite;
	if (pl_lanes_flags(fresh) == 0) {
		return goes_on;
	}
	PL(lanes_copy)(end + PL_STATES, y + PL_STATES, PL_STATES);
	PL(lanes_expand)(y, factor, now, (pl_lanes (*)[PL_STATES])(end + 2 * PL_STATES));
	PL(lanes_total)((pl_lanes (*)[PL_STATES])(end + 2 * PL_STATES), y, end, end + PL_STATES);
	finite = PL(lanes_finite)(end);
	if (end == some) {
		PL(lanes_take_over)(y + PL_END_ROW, fresh, some, (PL_ORDER + 3) * PL_STATES);
	}
	return pl_lanes_either(goes_on, finite);
}

/* How far each lane is in its series, as a part of it */
PL_LANES_INLINE pl_lanes PL(lanes_part)(pl_lanes served)
{
	pl_lanes part = pl_lanes_all(PL(part_of)[0]);
	int m;
	for (m = 2; m < PL_OVER; m++) {
		part = pl_lanes_choose(pl_lanes_below(served, pl_lanes_all((real)m)), part,
				pl_lanes_all(PL(part_of)[m - 1]));
	}
	return part;
}

/* The state there, of state i */
PL_LANES_INLINE pl_lanes PL(lanes_within)(const pl_lanes *y, pl_lanes part, int i)
{
	pl_lanes gain = y[PL_SERIES_ROW + PL_ORDER * PL_STATES + i];
	int k;
	PL_LANES_UNROLL
	for (k = PL_ORDER - 1; k > 0; k--) {
		gain = gain * part + y[PL_SERIES_ROW + k * PL_STATES + i];
	}
	return y[PL_SERIES_ROW + i] + (gain * part + y[PL_STATES + i]);
}

/* One step of the lanes that stay finite; seen: does anybody read states inside the series? */
PL_LANES_INLINE pl_lanes_truth PL(lanes_pass)(pl_lanes *y, const pl_lanes *factor, const real *now, int seen)
{
	const pl_lanes_truth kept = PL(lanes_renew)(y, factor, now);
	const pl_lanes served = pl_lanes_choose(kept, y[PL_SERVED_ROW] + 1, y[PL_SERVED_ROW]),
			over = pl_lanes_all(PL_OVER);
	const pl_lanes_truth inside = pl_lanes_both(kept, pl_lanes_below(served, over));
	const pl_lanes_truth ends = pl_lanes_equal(served, over);
	const pl_lanes part = PL(lanes_part)(served);
	int i;
	if (seen && pl_lanes_flags(inside) != 0) {
		PL_LANES_UNROLL
		for (i = 0; i < PL_STATES; i++) {
			y[i] = pl_lanes_choose(inside, PL(lanes_within)(y, part, i), y[i]);
		}
	}
	if (pl_lanes_flags(ends) != 0) {
		PL(lanes_take_over)(y, ends, y + PL_END_ROW, 2 * PL_STATES);
	}
	y[PL_SERVED_ROW] = pl_lanes_choose(ends, pl_lanes_all(0), served);
	return kept;
}

#else

/* One step of the lanes that stay finite */
PL_LANES_INLINE pl_lanes_truth PL(lanes_step)(pl_lanes *y, const pl_lanes *factor, const real *now)
{
	pl_lanes c[PL_ORDER + 1][PL_STATES], end[2 * PL_STATES];
	pl_lanes_truth finite;
	PL(lanes_copy)(end + PL_STATES, y + PL_STATES, PL_STATES);
	PL(lanes_expand)(y, factor, now, c);
	PL(lanes_total)(c, y, end, end + PL_STATES);
	finite = PL(lanes_finite)(end);
	PL(lanes_take_over)(y, finite, end, 2 * PL_STATES);
	return finite;
}
#endif

#include "undef.h"
