/* SPDX-License-Identifier: MIT-0 */
/* Matrices times vectors: what the steps of the schemes with a remainder are made of. */
#include "real.h"

void pl_multiply(int rows, int columns, const real *table, const real *x, real *y)
{
    int i;
    for (i = 0; i < rows; i++, table += columns) {
        y[i] = dot_product(columns, table, x);
    }
}

void pl_multiply_add(int rows, int columns, const real *table, const real *x, real *y)
{
    int i;
    for (i = 0; i < rows; i++, table += columns) {
        y[i] += dot_product(columns, table, x);
    }
}

int pl_not_finite(const real *y, int n)
{
    const real_bits exponent = ~(real_bits)0 >> 1 & ~REAL_FRACTION, one = REAL_FRACTION + 1;
    real_bits found = 0;        /* an exponent of ones and one more goes over into the sign */
    int i;
    for (i = 0; i < n; i++) {
        real_parts u;
        u.value = y[i];
        found |= (u.bits & exponent) + one;
    }
    return found & ~(~(real_bits)0 >> 1) ? PL_NOT_FINITE : 0;
}
