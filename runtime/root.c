/* SPDX-License-Identifier: MIT-0 */
/* Rough roots, for lengths of steps. The bits of a number are its logarithm, nearly: piecewise linear between powers of
 * two. */
#include "real.h"

real pl_root(real a, int n)
{
    real_parts parts, one;
    one.value = 1;
    parts.value = a;
    if (parts.bits >= one.bits) {
        parts.bits = one.bits + (parts.bits - one.bits) / (real_bits)n;
    } else {
        parts.bits = one.bits - (one.bits - parts.bits) / (real_bits)n;
    }
    return parts.value;
}
