/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * e^{A tau} as (e^B)^(2^s), B = A tau / 2^s with |B| <= 2^-8, in integers.  |.| is the largest absolute row sum
 * throughout.
 *
 *     exact     entries that are zero or polynomial in tau at every tau, by the rational numbers (A^k X)_ij
 *     enclosed  the others: Taylor series and s squarings with p bits, one radius for all entries
 *     rounded   where both ends of the enclosure round to the same number; else p is doubled
 */
#include "evaluator.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { FIRST_PRECISION = 128, TAYLOR_BITS = 8 };

static const long LARGEST_EXPONENT = 1L << 60;
static const uint64_t PRIME = 2147483647;               /* 2^31 - 1: products of residues fit 64 bits */

size_t evaluator_presumed_zeros;

static void *allocate(size_t count, size_t size)
{
	void *p = calloc(count ? count : 1, size);
	if (!p) {
		fputs("evaluator: out of memory\n", stderr);
		abort();
	}
	return p;
}

static mpz_t *new_integers(size_t count)
{
	mpz_t *z = allocate(count, sizeof *z);
	for (size_t i = 0; i < count; i++)
		mpz_init(z[i]);
	return z;
}

static void free_integers(mpz_t *z, size_t count)
{
	for (size_t i = 0; i < count; i++)
		mpz_clear(z[i]);
	free(z);
}

/* z <- denominator * q with the least common denominator; stride: distance of the elements of q */
static void to_integers(mpz_t *z, mpz_t denominator, const mpq_t *q, size_t count, size_t stride)
{
	mpz_set_ui(denominator, 1);
	for (size_t i = 0; i < count; i++)
		mpz_lcm(denominator, denominator, mpq_denref(q[i * stride]));
	for (size_t i = 0; i < count; i++) {
		mpz_divexact(z[i], denominator, mpq_denref(q[i * stride]));
		mpz_mul(z[i], z[i], mpq_numref(q[i * stride]));
	}
}

/* C <- A B, all n x n integers, C apart from both */
static void multiply(size_t n, mpz_t *C, mpz_t *A, mpz_t *B)
{
	for (size_t i = 0; i < n; i++) {
		for (size_t j = 0; j < n; j++)
			mpz_set_ui(C[i * n + j], 0);
		for (size_t l = 0; l < n; l++)
			if (mpz_sgn(A[i * n + l]))
				for (size_t j = 0; j < n; j++)
					if (mpz_sgn(B[l * n + j]))
						mpz_addmul(C[i * n + j], A[i * n + l], B[l * n + j]);
	}
}

/* norm <- |M| */
static void row_norm(mpz_t norm, size_t n, mpz_t *M)
{
	mpz_t sum;
	mpz_init(sum);
	mpz_set_ui(norm, 0);
	for (size_t i = 0; i < n; i++) {
		mpz_set_ui(sum, 0);
		for (size_t j = 0; j < n; j++)
			if (mpz_sgn(M[i * n + j]) < 0)
				mpz_sub(sum, sum, M[i * n + j]);
			else
				mpz_add(sum, sum, M[i * n + j]);
		if (mpz_cmp(sum, norm) > 0)
			mpz_set(norm, sum);
	}
	mpz_clear(sum);
}

/* bits of the largest |z| */
static size_t largest_size(mpz_t *z, size_t count)
{
	size_t bits = 0;
	for (size_t i = 0; i < count; i++)
		if (mpz_sgn(z[i]) && mpz_sizeinbase(z[i], 2) > bits)
			bits = mpz_sizeinbase(z[i], 2);
	return bits;
}

/* ---- enclosed ---- */

void evaluator_enclosure_init(evaluator_enclosure *E, size_t n)
{
	E->n = n;
	E->mid = new_integers(n * n);
	mpz_init(E->radius);
	E->exponent = 0;
}

void evaluator_enclosure_clear(evaluator_enclosure *E)
{
	free_integers(E->mid, E->n * E->n);
	mpz_clear(E->radius);
}

/* the least s >= 0 here known to give |A tau| / 2^s <= 2^-TAYLOR_BITS */
static unsigned long halvings(size_t n, const mpq_t *A, const mpq_t tau)
{
	mpq_t sum, norm, term;
	mpq_inits(sum, norm, term, NULL);
	for (size_t i = 0; i < n; i++) {
		mpq_set_ui(sum, 0, 1);
		for (size_t j = 0; j < n; j++) {
			mpq_abs(term, A[i * n + j]);
			mpq_add(sum, sum, term);
		}
		if (mpq_cmp(sum, norm) > 0)
			mpq_set(norm, sum);
	}
	mpq_mul(norm, norm, tau);
	/* |a / b| < 2^(size of a - size of b + 1) */
	long s = 0;
	if (mpq_sgn(norm))
		s = (long)mpz_sizeinbase(mpq_numref(norm), 2) - (long)mpz_sizeinbase(mpq_denref(norm), 2) + 1 +
			TAYLOR_BITS;
	mpq_clears(sum, norm, term, NULL);
	return s > 0 ? (unsigned long)s : 0;
}

/* B <- 2^p A tau / 2^s, truncated */
static void scaled_matrix(size_t n, const mpq_t *A, const mpq_t tau, unsigned long s, unsigned long p, mpz_t *B)
{
	mpq_t b;
	mpq_init(b);
	for (size_t i = 0; i < n * n; i++) {
		mpq_mul(b, A[i], tau);
		mpq_div_2exp(b, b, s);
		mpz_mul_2exp(B[i], mpq_numref(b), p);
		mpz_tdiv_q(B[i], B[i], mpq_denref(b));
	}
	mpq_clear(b);
}

/* E <- e^B, exponent -p.  With T_k = B^k / k!, each computed T_k is off by at most 3 n units:
 *     t_k <= (t_{k-1} |B^| + |T_{k-1}| n) / k + n,   t_0 = 0,  |B^| <= 1 the truncated B, off by n,  |T_{k-1}| <= 1;
 * t_1 <= 2 n, and from k = 2 on (3 n + n) / k + n <= 3 n.  The series ends at T_K; as |B| <= 1/2, what follows is below
 * |T_K| / 3. */
static void taylor(size_t n, mpz_t *B, unsigned long p, evaluator_enclosure *E)
{
	mpz_t *T = new_integers(n * n), *U = new_integers(n * n), norm;
	unsigned long k = 0;

	mpz_init(norm);
	for (size_t i = 0; i < n * n; i++)
		mpz_set_ui(E->mid[i], 0);
	for (size_t i = 0; i < n; i++) {
		mpz_setbit(T[i * n + i], p);
		mpz_setbit(E->mid[i * n + i], p);
	}
	do {
		k++;
		multiply(n, U, T, B);
		for (size_t i = 0; i < n * n; i++) {
			mpz_tdiv_q_2exp(T[i], U[i], p);
			mpz_tdiv_q_ui(T[i], T[i], k);
			mpz_add(E->mid[i], E->mid[i], T[i]);
		}
		row_norm(norm, n, T);
	} while (mpz_cmp_ui(norm, n) > 0);

	mpz_set_ui(E->radius, 3 * n);                       /* sum of t_k, k = 1..K */
	mpz_mul_ui(E->radius, E->radius, k);
	mpz_add(E->radius, E->radius, norm);                /* the tail, |T_K| <= norm + 3 n */
	mpz_add_ui(E->radius, E->radius, 3 * n);
	E->exponent = -(long)p;

	mpz_clear(norm);
	free_integers(T, n * n);
	free_integers(U, n * n);
}

/* E <- E^2, brought back to p bits.  |(M + D)^2 - M^2| <= (2 |M| + |D|) |D|, and n units for the truncation;
 * |M| is that of the matrix at hand, which for a stiff A stays small however large |A tau| is. */
static void square(evaluator_enclosure *E, unsigned long p, mpz_t *U)
{
	const size_t n = E->n;
	mpz_t norm;

	mpz_init(norm);
	row_norm(norm, n, E->mid);
	mpz_mul_2exp(norm, norm, 1);
	mpz_add(norm, norm, E->radius);
	mpz_mul(E->radius, E->radius, norm);

	multiply(n, U, E->mid, E->mid);
	const size_t size = largest_size(U, n * n), shift = size > p ? size - p : 0;
	for (size_t i = 0; i < n * n; i++)
		mpz_tdiv_q_2exp(E->mid[i], U[i], shift);
	mpz_cdiv_q_2exp(E->radius, E->radius, shift);
	if (shift)
		mpz_add_ui(E->radius, E->radius, n);

	/* Once beyond +-2^60 the true exponent only moves further out: zero and infinity stay what they are. */
	E->exponent = 2 * E->exponent + (long)shift;
	if (E->exponent > LARGEST_EXPONENT)
		E->exponent = LARGEST_EXPONENT;
	if (E->exponent < -LARGEST_EXPONENT)
		E->exponent = -LARGEST_EXPONENT;
	mpz_clear(norm);
}

/* E <- e^{A tau} with p bits.  -1 if the radius outgrew the matrix on the way: from there on it would double its length
 * at every square. */
static int enclose_with(const mpq_t *A, const mpq_t tau, unsigned long p, evaluator_enclosure *E)
{
	const size_t n = E->n;
	const unsigned long s = halvings(n, A, tau);
	mpz_t *B = new_integers(n * n);

	scaled_matrix(n, A, tau, s, p, B);
	taylor(n, B, p, E);
	int lost = 0;
	for (unsigned long i = 0; i < s && !lost; i++) {
		square(E, p, B);
		lost = mpz_sizeinbase(E->radius, 2) > p;
	}
	free_integers(B, n * n);
	return lost ? -1 : 0;
}

int evaluator_enclose(const mpq_t *A, const mpq_t tau, unsigned long bits, evaluator_enclosure *E)
{
	for (unsigned long p = FIRST_PRECISION; p <= EVALUATOR_LARGEST_PRECISION; p *= 2) {
		if (p < bits || enclose_with(A, tau, p, E))
			continue;
		/* the largest |mid| is at least 2^(size - 1), and radius < 2^(its size) */
		if (mpz_sizeinbase(E->radius, 2) + bits + 1 <= largest_size(E->mid, E->n * E->n))
			return 0;
	}
	return -1;
}

int evaluator_midpoints(size_t n, const mpq_t *A, const mpq_t tau, unsigned long bits, mpfr_t *E)
{
	evaluator_enclosure e;
	evaluator_enclosure_init(&e, n);
	/* one bit more: the radius is measured by the largest midpoint, the promise by the largest entry */
	const int status = evaluator_enclose(A, tau, bits + 1, &e);
	for (size_t i = 0; !status && i < n * n; i++) {
		mpfr_set_prec(E[i], (mpfr_prec_t)mpz_sizeinbase(e.mid[i], 2) + 1);
		mpfr_set_z_2exp(E[i], e.mid[i], e.exponent, MPFR_RNDN);
	}
	evaluator_enclosure_clear(&e);
	return status;
}

/* ---- rounded ---- */

/* the double or float nearest to z 2^exponent, ties to even; zero is +0 */
static double nearest(const mpz_t z, long exponent, unsigned flags)
{
	mpfr_t x;
	mpfr_init2(x, (mpfr_prec_t)mpz_sizeinbase(z, 2) + 1);
	mpfr_set_z_2exp(x, z, exponent, MPFR_RNDN);         /* exact */
	const double d = flags & EVALUATOR_FLOAT ? (double)mpfr_get_flt(x, MPFR_RNDN) : mpfr_get_d(x, MPFR_RNDN);
	mpfr_clear(x);
	return d == 0 ? 0.0 : d;
}

/* the same for a rational: 64 bits or more of the quotient, and a last bit that says whether anything follows */
static double nearest_rational(const mpq_t q, unsigned flags)
{
	const long excess = (long)mpz_sizeinbase(mpq_denref(q), 2) - (long)mpz_sizeinbase(mpq_numref(q), 2) + 66;
	const unsigned long shift = excess > 0 ? (unsigned long)excess : 0;
	mpz_t quotient, rest;

	mpz_inits(quotient, rest, NULL);
	mpz_mul_2exp(quotient, mpq_numref(q), shift);
	mpz_tdiv_qr(quotient, rest, quotient, mpq_denref(q));
	mpz_mul_2exp(quotient, quotient, 1);
	if (mpz_sgn(rest) > 0)
		mpz_add_ui(quotient, quotient, 1);
	else if (mpz_sgn(rest) < 0)
		mpz_sub_ui(quotient, quotient, 1);
	const double d = nearest(quotient, -(long)shift - 1, flags);
	mpz_clears(quotient, rest, NULL);
	return d;
}

/* one entry (mid +- radius) 2^exponent to *y, if both ends round alike */
static int decide(const mpz_t mid, const mpz_t radius, long exponent, unsigned flags, double *y)
{
	mpz_t low, high;
	mpz_inits(low, high, NULL);
	mpz_sub(low, mid, radius);
	mpz_add(high, mid, radius);
	*y = nearest(low, exponent, flags);
	const int decided = *y == nearest(high, exponent, flags);
	if (decided && mpz_sgn(low) <= 0 && mpz_sgn(high) >= 0)
		evaluator_presumed_zeros++;
	mpz_clears(low, high, NULL);
	return decided;
}

/* ---- exact ---- */

/* A and one column x of X as integers: A = integers / scale, x = column / column_scale */
typedef struct {
	size_t n;
	mpz_t *integers, scale;
	uint64_t *residues;                                 /* the integers modulo PRIME */
	mpz_t *column, column_scale;
} exact_problem;

/* reached[i] <- whether (A^k x)_i is other than a sum of no terms for some k: if not, it is zero at every tau */
static void reachable(const exact_problem *P, char *reached)
{
	const size_t n = P->n;
	for (size_t i = 0; i < n; i++)
		reached[i] = mpz_sgn(P->column[i]) != 0;
	for (int grown = 1; grown;) {
		grown = 0;
		for (size_t i = 0; i < n; i++)
			for (size_t l = 0; !reached[i] && l < n; l++)
				if (reached[l] && mpz_sgn(P->integers[i * n + l]))
					reached[i] = 1, grown = 1;
	}
}

/* low[i], high[i] <- whether (A^k x)_i = 0 modulo PRIME for all k < n, for all n <= k < 2n */
static void screen(const exact_problem *P, char *low, char *high)
{
	const size_t n = P->n;
	uint64_t *v = allocate(n, sizeof *v), *w = allocate(n, sizeof *w);

	for (size_t i = 0; i < n; i++) {
		v[i] = mpz_fdiv_ui(P->column[i], PRIME);
		low[i] = high[i] = 1;
	}
	for (size_t k = 0; k < 2 * n; k++) {
		for (size_t i = 0; i < n; i++) {
			if (v[i])
				(k < n ? low : high)[i] = 0;
			w[i] = 0;
			for (size_t l = 0; l < n; l++)
				w[i] = (w[i] + P->residues[i * n + l] * v[l]) % PRIME;
		}
		uint64_t *swap = v;
		v = w;
		w = swap;
	}
	free(v);
	free(w);
}

/* needed[i] <- whether row i of A^k x takes part in a wanted one */
static void needed_rows(const exact_problem *P, const char *wanted, char *needed)
{
	const size_t n = P->n;
	for (size_t i = 0; i < n; i++)
		needed[i] = wanted[i];
	for (int grown = 1; grown;) {
		grown = 0;
		for (size_t i = 0; i < n; i++)
			for (size_t l = 0; needed[i] && l < n; l++)
				if (!needed[l] && mpz_sgn(P->integers[i * n + l]))
					needed[l] = 1, grown = 1;
	}
}

/* For the wanted rows: low and high as in screen, in integers, and sum[i] <- sum over k < n of (A^k x)_i tau^k / k! */
static void prove(const exact_problem *P, const mpq_t tau, const char *wanted, char *low, char *high, mpq_t *sum)
{
	const size_t n = P->n;
	mpz_t *v = new_integers(n), *w = new_integers(n);
	char *needed = allocate(n, 1);
	mpq_t weight, term;                                 /* weight = tau^k / (k! scale^k column_scale) */

	mpq_inits(weight, term, NULL);
	mpq_set_z(weight, P->column_scale);
	mpq_inv(weight, weight);
	needed_rows(P, wanted, needed);
	for (size_t i = 0; i < n; i++) {
		mpz_set(v[i], P->column[i]);
		mpq_set_ui(sum[i], 0, 1);
		low[i] = high[i] = 1;
	}
	for (size_t k = 0; k < 2 * n; k++) {
		for (size_t i = 0; i < n; i++) {
			if (!wanted[i] || !mpz_sgn(v[i]))
				continue;
			(k < n ? low : high)[i] = 0;
			if (k < n) {
				mpq_set_z(term, v[i]);
				mpq_mul(term, term, weight);
				mpq_add(sum[i], sum[i], term);
			}
		}
		for (size_t i = 0; i < n; i++) {
			mpz_set_ui(w[i], 0);
			for (size_t l = 0; needed[i] && l < n; l++)
				if (mpz_sgn(P->integers[i * n + l]))
					mpz_addmul(w[i], P->integers[i * n + l], v[l]);
		}
		mpz_t *swap = v;
		v = w;
		w = swap;
		mpq_mul(weight, weight, tau);
		mpq_set_z(term, P->scale);
		mpz_mul_ui(mpq_numref(term), mpq_numref(term), k + 1);
		mpq_div(weight, weight, term);
	}
	mpq_clears(weight, term, NULL);
	free(needed);
	free_integers(v, n);
	free_integers(w, n);
}

/* Decides what is zero or polynomial at every tau in column x: y[i * stride], done[i * stride].
 * By Cayley-Hamilton n vanishing (A^k x)_i in a row, k = 0..n-1, mean all vanish; vanishing from k = n to 2n - 1 means
 * that only the pole 0 is left in this entry, and there the series has ended. */
static void exact_entries(const exact_problem *P, const mpq_t tau, unsigned flags, size_t stride, double *y, char *done)
{
	const size_t n = P->n;
	char *reached = allocate(n, 1), *low = allocate(n, 1), *high = allocate(n, 1), *wanted = allocate(n, 1);
	int any = 0;

	reachable(P, reached);
	screen(P, low, high);
	for (size_t i = 0; i < n; i++) {
		if (!reached[i]) {
			y[i * stride] = 0;
			done[i * stride] = 1;
		}
		wanted[i] = reached[i] && (low[i] || high[i]);
		any |= wanted[i];
	}
	if (any) {
		mpq_t *sum = allocate(n, sizeof *sum), x;
		mpq_init(x);
		for (size_t i = 0; i < n; i++)
			mpq_init(sum[i]);
		prove(P, tau, wanted, low, high, sum);
		for (size_t i = 0; i < n; i++) {
			if (wanted[i] && (low[i] || high[i])) {
				if (flags & EVALUATOR_LESS_X) {
					mpz_set(mpq_numref(x), P->column[i]);
					mpz_set(mpq_denref(x), P->column_scale);
					mpq_canonicalize(x);
					mpq_sub(sum[i], sum[i], x);
				}
				y[i * stride] = nearest_rational(sum[i], flags);
				done[i * stride] = 1;
			}
			mpq_clear(sum[i]);
		}
		mpq_clear(x);
		free(sum);
	}
	free(reached);
	free(low);
	free(high);
	free(wanted);
}

/* ---- the whole ---- */

/* Row i of (E - I or E) x for the column of P; result (mid +- radius) 2^exponent */
static void enclosed_entry(const exact_problem *P, const evaluator_enclosure *E, unsigned long p, size_t i,
						   unsigned flags, mpz_t mid, mpz_t radius, long *exponent)
{
	const size_t n = P->n;

	mpz_set_ui(mid, 0);
	mpz_set_ui(radius, 0);
	for (size_t l = 0; l < n; l++) {
		mpz_addmul(mid, E->mid[i * n + l], P->column[l]);
		if (mpz_cmpabs(P->column[l], radius) > 0)
			mpz_abs(radius, P->column[l]);
	}
	mpz_mul(radius, radius, E->radius);
	*exponent = E->exponent;

	if (flags & EVALUATOR_LESS_X && mpz_sgn(P->column[i])) {
		mpz_t x;
		mpz_init_set(x, P->column[i]);
		if (*exponent > 0) {         /* x is below |x| units of 2^exponent: count it as error */
			mpz_abs(x, x);
			mpz_add(radius, radius, x);
		} else {
			if (*exponent < -(long)p) {                 /* E far below I: coarser units will do */
				const unsigned long shift = (unsigned long)(-(long)p - *exponent);
				mpz_tdiv_q_2exp(mid, mid, shift);
				mpz_cdiv_q_2exp(radius, radius, shift);
				mpz_add_ui(radius, radius, 1);
				*exponent = -(long)p;
			}
			mpz_mul_2exp(x, x, (unsigned long)-*exponent);
			mpz_sub(mid, mid, x);
		}
		mpz_clear(x);
	}
	if (mpz_cmp_ui(P->column_scale, 1)) {
		const unsigned long shift = mpz_sizeinbase(P->column_scale, 2) + 1;
		mpz_mul_2exp(mid, mid, shift);
		mpz_tdiv_q(mid, mid, P->column_scale);
		mpz_mul_2exp(radius, radius, shift);
		mpz_cdiv_q(radius, radius, P->column_scale);
		mpz_add_ui(radius, radius, 1);
		*exponent -= (long)shift;
	}
}

/* Ziv's loop: Y where done is not yet set */
static int enclosed_entries(exact_problem *P, const mpq_t *A, const mpq_t tau, size_t m, const mpq_t *X, unsigned flags,
							double *Y, char *done)
{
	const size_t n = P->n;
	size_t undecided = 0;
	mpz_t mid, radius;
	evaluator_enclosure E;
	long exponent;

	mpz_inits(mid, radius, NULL);
	evaluator_enclosure_init(&E, n);
	for (unsigned long p = FIRST_PRECISION; p <= EVALUATOR_LARGEST_PRECISION; p *= 2) {
		for (undecided = 0; undecided < n * m && done[undecided]; undecided++)
			;
		if (undecided == n * m)
			break;
		if (enclose_with(A, tau, p, &E))
			continue;
		for (size_t j = 0; j < m; j++) {
			to_integers(P->column, P->column_scale, X + j, n, m);
			for (size_t i = 0; i < n; i++) {
				if (done[i * m + j])
					continue;
				enclosed_entry(P, &E, p, i, flags, mid, radius, &exponent);
				done[i * m + j] = (char)decide(mid, radius, exponent, flags, &Y[i * m + j]);
			}
		}
	}
	for (undecided = 0; undecided < n * m && done[undecided]; undecided++)
		;
	evaluator_enclosure_clear(&E);
	mpz_clears(mid, radius, NULL);
	return undecided < n * m ? -1 - (int)undecided : 0;
}

int evaluator_round(size_t n, const mpq_t *A, const mpq_t tau, size_t m, const mpq_t *X, unsigned flags, double *Y)
{
	exact_problem P = { .n = n, .integers = new_integers(n * n), .column = new_integers(n) };
	char *done = allocate(n * m, 1);

	mpz_inits(P.scale, P.column_scale, NULL);
	to_integers(P.integers, P.scale, A, n * n, 1);
	P.residues = allocate(n * n, sizeof *P.residues);
	for (size_t i = 0; i < n * n; i++)
		P.residues[i] = mpz_fdiv_ui(P.integers[i], PRIME);

	for (size_t j = 0; j < m; j++) {
		to_integers(P.column, P.column_scale, X + j, n, m);
		exact_entries(&P, tau, flags, m, Y + j, done + j);
	}
	const int status = enclosed_entries(&P, A, tau, m, X, flags, Y, done);

	free(P.residues);
	free(done);
	free_integers(P.integers, n * n);
	free_integers(P.column, n);
	mpz_clears(P.scale, P.column_scale, NULL);
	return status;
}

int evaluator_exponential(size_t n, const mpq_t *A, const mpq_t tau, double *E)
{
	mpq_t *identity = allocate(n * n, sizeof *identity);
	for (size_t i = 0; i < n * n; i++) {
		mpq_init(identity[i]);
		mpq_set_ui(identity[i], i % (n + 1) == 0, 1);
	}
	const int status = evaluator_round(n, A, tau, n, (const mpq_t *)identity, 0, E);
	for (size_t i = 0; i < n * n; i++)
		mpq_clear(identity[i]);
	free(identity);
	return status;
}

int evaluator_apply(size_t n, const mpq_t *A, const mpq_t tau, const mpq_t *x, double *y)
{
	return evaluator_round(n, A, tau, 1, x, 0, y);
}
