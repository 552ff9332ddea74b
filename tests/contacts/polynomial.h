/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a polynomial in multiprecision first rises through zero. */
#ifndef POLYNOMIAL_H
#define POLYNOMIAL_H

#include <mpfr.h>
#include <stdbool.h>

/* Numbers that do not quite fill three words MPFR multiplies and adds by code of its own */
enum { BITS = 191, DEGREE = 58 };

/* coefficient: DEGREE + 1 of p(s). `at` receives the first s in 0 <= s <= width where p rises through 0; false: there
 * is none. At s = 0 a p that falls, or is 0 to `tiny` and then falls, does not rise. Intervals are halved until the
 * polynomial, or its slope, has one sign in them by how much they change at most; then the root is closed in on. */
bool first_rise(mpfr_t *coefficient, mpfr_srcptr width, mpfr_srcptr tiny, mpfr_ptr at);

#endif
