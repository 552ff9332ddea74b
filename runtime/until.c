/* SPDX-License-Identifier: MIT-0 */
/* The time from now to a change of the loads. Both are far larger than what is between them, so it is found in two
 * words. */
#include "two.h"

/* The steps go in parts that a number holds exactly, the largest first. */
real pl_until(real t0, uint64_t k, pl_two h, pl_two change)
{
    const uint64_t part = ((uint64_t)1 << REAL_DIGITS) - 1;
    pl_two left = add(change, two(-t0, 0));
    int from;
    for (from = 63 / REAL_DIGITS * REAL_DIGITS; from >= 0; from -= REAL_DIGITS) {
        const uint64_t steps = k & part << from;
        if (steps != 0) {
            left = add(left, multiply(two(-(real)steps, 0), h));
        }
    }
    return left.hi + left.lo;
}
