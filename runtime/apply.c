/* SPDX-License-Identifier: MIT-0 */
/* Matrices times vectors: what the steps of the schemes with a leftover are made of. */
#include "real.h"

/* Four sums, so that an addition need not wait for the one before it: as fast as several rows at a time, in one order
 * for all. Inline: a call for each row costs a fifth of the time. */
static inline real row_times(int columns, const real *row, const real *x)
{
    const int whole = columns - columns % 4;
    real s0 = 0, s1 = 0, s2 = 0, s3 = 0;
    int j;
    for (j = 0; j < whole; j += 4) {
        s0 += row[j] * x[j];
        s1 += row[j + 1] * x[j + 1];
        s2 += row[j + 2] * x[j + 2];
        s3 += row[j + 3] * x[j + 3];
    }
    if (j < columns) {
        s0 += row[j] * x[j];
    }
    if (j + 1 < columns) {
        s1 += row[j + 1] * x[j + 1];
    }
    if (j + 2 < columns) {
        s2 += row[j + 2] * x[j + 2];
    }
    return (s0 + s2) + (s1 + s3);
}

void pl_multiply(int rows, int columns, const real *table, const real *x, real *y)
{
    int i;
    for (i = 0; i < rows; i++, table += columns) {
        y[i] = row_times(columns, table, x);
    }
}

void pl_multiply_add(int rows, int columns, const real *table, const real *x, real *y)
{
    int i;
    for (i = 0; i < rows; i++, table += columns) {
        y[i] += row_times(columns, table, x);
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
