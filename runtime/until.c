/* SPDX-License-Identifier: MIT-0 */
/* The time from now to a change of the loads. Both are far larger than what is between them, so it is found in two words. */
#include "two.h"

double pl_until(double t0, uint64_t k, pl_two h, pl_two change)
{
    const pl_two minus_steps = two(-(double)k, 0.0);
    const pl_two left = add(add(change, two(-t0, 0.0)), multiply(minus_steps, h));
    return left.hi + left.lo;
}
