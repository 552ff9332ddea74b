/* SPDX-License-Identifier: MIT-0 */
/* unmet_lanes.h: event-free steps over lanes of a model with friction or impacts: each lane in its region, as unmet.h
 * has it.  Included by the file of the model behind lanes.h and search.h, with
 *
 *     PL_STATES, PL_SIZE         states; entries of x, of which they are the first: `now` has the others
 *     PL_LANES                   the last of x that are params of each instance
 *     PL_REGIONS, PL_CAPPED      as search.h has them; regions are few, and each has code of its own */
#include "numbers.h"

#define PL_FEW_REGIONS 1
#define PL_VALUE pl_lanes
#define PL_TRUTH pl_lanes_truth
#define PL_UNMET(name) PL(lanes_##name)
#define PL_ALL_OF(value) pl_lanes_all(value)
#define PL_MAGNITUDE(value) pl_lanes_size(value)
#define PL_LARGER(a, b) pl_lanes_larger(a, b)
#define PL_BELOW(a, b) pl_lanes_below(a, b)
#define PL_IS_ZERO(size) pl_lanes_equal(size, pl_lanes_all(0.0))
#define PL_AND(a, b) pl_lanes_both(a, b)
#define PL_FAILS(truth) (pl_lanes_flags(truth) == 0)
#define PL_STRANGE(x) 0
#include "unmet.h"

/* Of the lanes in region k those that meet nothing: y is then at their end */
PL_LANES_INLINE pl_lanes_truth PL(lanes_in_region)(int k, const pl_lanes *x, pl_lanes *y)
{
	pl_lanes end[PL_SIZE], size[PL_SIZE], place[PL_SIZE];
	pl_lanes_truth here = pl_lanes_equal(y[PL_STATES], pl_lanes_all(k));
	int i;
	if (pl_lanes_flags(here) == 0) {
		return here;
	}
	PL_UNROLL
	for (i = 0; i < PL_STATES; i++) {
		end[i] = x[i]; /* of a region that cannot occur nothing else comes */
	}
	here = pl_lanes_both(here, PL(lanes_keeps_all)(&PL(switching), k, x, end, size, place));
	PL_UNROLL
	for (i = 0; i < PL_STATES; i++) {
		y[i] = pl_lanes_choose(here, end[i], y[i]);
	}
	return here;
}

#define PL_CASE(k) kept = k < PL_REGIONS ? pl_lanes_either(kept, PL(lanes_in_region)(k, x, y)) : kept;
#define PL_CASES(k) PL_CASE(k) PL_CASE(k + 1) PL_CASE(k + 2)

/* One step of the lanes in which it is sure that no guard is met.  Behind the states y has the region. */
PL_LANES_INLINE pl_lanes_truth PL(lanes_step)(pl_lanes *y, const pl_lanes *factor, const real *now)
{
	pl_lanes x[PL_SIZE];
	pl_lanes_truth kept = pl_lanes_below(pl_lanes_all(0), pl_lanes_all(-1));
	int i;
	PL_UNROLL
	for (i = 0; i < PL_SIZE; i++) {
		x[i] = i < PL_STATES ? y[i] : pl_lanes_all(now[i < PL_STATES ? 0 : i - PL_STATES]);
	}
	PL_UNROLL
	for (i = 0; i < PL_LANES; i++) {
		x[PL_SIZE - PL_LANES + i] = factor[i];
	}
	PL_CASES(0)
#if PL_REGIONS > 3
	PL_CASES(3)
	PL_CASES(6)
#endif
#if PL_REGIONS > 9
	PL_CASES(9)
	PL_CASES(12)
	PL_CASE(15)
#endif
	(void)factor;
	(void)now;
	return kept;
}

#include "undef.h"
