/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * The judge: e^{A tau} for rational A and tau, correctly rounded, by a road that knows nothing of poles and residues:
 * a Taylor series in integers, scaling and squaring, and one error radius for the whole matrix.
 * The radius being one for all entries, an entry can be decided down to 2^-16384 of the largest one, or to where it is
 * 0. Matrices are row-major.  A zero result is always +0; underflow is to nearest even; what overflows is +-infinity.
 */
#ifndef EVALUATOR_H
#define EVALUATOR_H

#include <gmp.h>
#include <mpfr.h>
#include <stddef.h>

enum { EVALUATOR_LARGEST_PRECISION = 16384 };       /* bits; an entry not decided with these is given up */

/* E (n x n) <- e^{A tau}.  0, or -1 - (index of the first entry that stayed undecided). */
int evaluator_exponential(size_t n, const mpq_t *A, const mpq_t tau, double *E);

/* y (n) <- e^{A tau} x.  Result as above. */
int evaluator_apply(size_t n, const mpq_t *A, const mpq_t tau, const mpq_t *x, double *y);

/* The general form, Y (n x m) <- e^{A tau} X.  Result as above, the index counting in Y. */
enum {
    EVALUATOR_LESS_X = 1, /* e^{A tau} X - X instead, rounded relative to itself: with X = I the increment Phi - I */
    EVALUATOR_FLOAT = 2 /* rounded once to float, never via double; Y then holds floats */
};
int evaluator_round(size_t n, const mpq_t *A, const mpq_t tau, size_t m, const mpq_t *X, unsigned flags, double *Y);

/* How many results so far were 0 because the enclosure lay within half the least subnormal of 0 on both sides,
 * not because the entry was shown to be zero at every tau.  0 is their correct rounding, be they exactly zero at this
 * tau alone (a critically damped Phi_22 at w h = 1) or only very small (e^{-1e14}); which of the two is not asked. */
extern size_t evaluator_presumed_zeros;

/* More than double precision: every entry of e^{A tau} lies in (mid[i n + j] +- radius) 2^exponent.
 * The exponent saturates at +-2^60. */
typedef struct {
    size_t n;
    mpz_t *mid;                 /* n x n */
    mpz_t radius;
    long exponent;
} evaluator_enclosure;

/* E <- an enclosure with radius <= 2^-bits times the largest |mid|; init before, clear after, reuse at will.  0, or -1
 * if it would take more than EVALUATOR_LARGEST_PRECISION bits of working precision. */
void evaluator_enclosure_init(evaluator_enclosure *E, size_t n);
void evaluator_enclosure_clear(evaluator_enclosure *E);
int evaluator_enclose(const mpq_t *A, const mpq_t tau, unsigned long bits, evaluator_enclosure *E);

/* The midpoints of that enclosure, each held exactly: E (n x n, initialised) has its precision set to what that takes.
 * Their common error is below 2^-bits times the largest |entry|. */
int evaluator_midpoints(size_t n, const mpq_t *A, const mpq_t tau, unsigned long bits, mpfr_t *E);

#endif
