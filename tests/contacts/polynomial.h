/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a polynomial in multiprecision first rises through zero. */
#ifndef POLYNOMIAL_H
#define POLYNOMIAL_H

#include <mpfr.h>
#include <stdbool.h>

enum { BITS = 192, DEGREE = 30 };

/* coefficient: DEGREE + 1 of p(s). `at` receives the first s in 0 <= s <= width where p rises through 0; false: there
 * is none. At s = 0 a p that falls, or is 0 to `tiny` and then falls, does not rise. Intervals are halved until the
 * polynomial, or its slope, has one sign in them by the sizes of its coefficients; then the root is halved in. */
bool first_rise(mpfr_t *coefficient, mpfr_srcptr width, mpfr_srcptr tiny, mpfr_ptr at);

void value_at(mpfr_t *coefficient, mpfr_srcptr s, mpfr_ptr value);

#endif
