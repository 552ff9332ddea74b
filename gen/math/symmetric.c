/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The symmetric eigenproblem K v = lambda M v in multiprecision. With M = L L^T (Cholesky) it is that of
 * A = L^-1 K L^-T, which rotations make diagonal (Jacobi's method, cyclic by rows: Golub and Van Loan 2013, 8.5);
 * v = L^-T w. Coordinates that nothing couples are parted before, so that zeros stay zeros.
 */
#include "math/math.h"

#include <stdlib.h>

enum {
	GUARD_BITS = 96,            /* of the work, beyond what is asked for */
	MOST_SWEEPS = 60,
	MOST_DOUBLINGS = 5
};

struct rotating {                   /* one block of coordinates */
	int n, precision;
	int *coord;                 /* of the whole */
	mpfr_t *L, *A, *V;          /* n x n: M = L L^T; the matrix that rotations make diagonal; their product */
	mpfr_t x, y, c, s, t;
};

/* ---- one block ---- */

static bool cholesky(struct rotating *r, int all, const mpq_t *M)
{
	int n = r->n;
	for (int j = 0; j < n; j++)
		for (int i = j; i < n; i++) {
			mpfr_set_q(r->x, M[r->coord[i] * all + r->coord[j]], MPFR_RNDN);
			for (int k = 0; k < j; k++) {
				mpfr_mul(r->y, r->L[i * n + k], r->L[j * n + k], MPFR_RNDN);
				mpfr_sub(r->x, r->x, r->y, MPFR_RNDN);
			}
			if (i > j) {
				mpfr_div(r->L[i * n + j], r->x, r->L[j * n + j], MPFR_RNDN);
				continue;
			}
			mpfr_set_q(r->y, M[r->coord[j] * all + r->coord[j]], MPFR_RNDN);
			mpfr_div_2ui(r->y, r->y, (unsigned long)r->precision / 2, MPFR_RNDN);
			if (mpfr_sgn(r->x) <= 0 || mpfr_cmpabs(r->x, r->y) <= 0)
				return false;   /* not positive definite, as far as these bits tell */
			mpfr_sqrt(r->L[j * n + j], r->x, MPFR_RNDN);
		}
	return true;
}

/* column <- L^-1 column, or L^-T column, its entries `stride` apart */
static void divide_by(struct rotating *r, bool transposed, mpfr_t *column, int stride)
{
	for (int count = 0; count < r->n; count++) {
		const int i = transposed ? r->n - 1 - count : count;
		for (int k = transposed ? i + 1 : 0; k < (transposed ? r->n : i); k++) {
			mpfr_mul(r->y, r->L[transposed ? k * r->n + i : i * r->n + k], column[k * stride], MPFR_RNDN);
			mpfr_sub(column[i * stride], column[i * stride], r->y, MPFR_RNDN);
		}
		mpfr_div(column[i * stride], column[i * stride], r->L[i * r->n + i], MPFR_RNDN);
	}
}

/* a, b <- c a - s b, s a + c b */
static void turn(struct rotating *r, mpfr_ptr a, mpfr_ptr b)
{
	mpfr_mul(r->x, r->s, b, MPFR_RNDN);
	mpfr_mul(r->y, r->s, a, MPFR_RNDN);
	mpfr_fms(a, r->c, a, r->x, MPFR_RNDN);
	mpfr_fma(b, r->c, b, r->y, MPFR_RNDN);
}

/* c and s of the rotation that makes A_pq zero; false: it is small beside what it couples */
static bool rotation(struct rotating *r, int p, int q)
{
	int n = r->n;
	mpfr_ptr app = r->A[p * n + p], aqq = r->A[q * n + q], apq = r->A[p * n + q];
	mpfr_mul(r->x, app, aqq, MPFR_RNDN);
	mpfr_abs(r->x, r->x, MPFR_RNDN);
	mpfr_sqrt(r->x, r->x, MPFR_RNDN);
	mpfr_sub(r->y, app, aqq, MPFR_RNDN);
	if (mpfr_cmpabs(r->y, r->x) > 0)
		mpfr_abs(r->x, r->y, MPFR_RNDN);
	mpfr_div_2ui(r->x, r->x, (unsigned long)r->precision, MPFR_RNDN);
	if (mpfr_zero_p(apq) || mpfr_cmpabs(apq, r->x) <= 0)
		return false;
	mpfr_sub(r->t, aqq, app, MPFR_RNDN);                    /* theta = (a_qq - a_pp)/(2 a_pq) */
	mpfr_div(r->t, r->t, apq, MPFR_RNDN);
	mpfr_div_2ui(r->t, r->t, 1, MPFR_RNDN);
	bool minus = mpfr_signbit(r->t);
	mpfr_abs(r->t, r->t, MPFR_RNDN);
	mpfr_sqr(r->x, r->t, MPFR_RNDN);
	mpfr_add_ui(r->x, r->x, 1, MPFR_RNDN);
	mpfr_sqrt(r->x, r->x, MPFR_RNDN);
	mpfr_add(r->t, r->t, r->x, MPFR_RNDN);
	mpfr_ui_div(r->t, 1, r->t, MPFR_RNDN);                  /* tan = 1/(|theta| + sqrt(theta^2 + 1)) */
	mpfr_sqr(r->x, r->t, MPFR_RNDN);
	mpfr_add_ui(r->x, r->x, 1, MPFR_RNDN);
	mpfr_rec_sqrt(r->c, r->x, MPFR_RNDN);
	mpfr_mul(r->s, r->t, r->c, MPFR_RNDN);
	if (minus)
		mpfr_neg(r->s, r->s, MPFR_RNDN);
	return true;
}

static bool rotate_to_diagonal(struct rotating *r)
{
	int n = r->n;
	for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
		bool rotated = false;
		for (int p = 0; p < n; p++)
			for (int q = p + 1; q < n; q++) {
				if (!rotation(r, p, q))
					continue;
				rotated = true;
				for (int k = 0; k < n; k++)
					turn(r, r->A[k * n + p], r->A[k * n + q]);
				for (int k = 0; k < n; k++)
					turn(r, r->A[p * n + k], r->A[q * n + k]);
				for (int k = 0; k < n; k++)
					turn(r, r->V[k * n + p], r->V[k * n + q]);
				mpfr_set_zero(r->A[p * n + q], 1);
				mpfr_set_zero(r->A[q * n + p], 1);
			}
		if (!rotated)
			return true;
	}
	return false;
}

static bool solve_block(struct rotating *r, int all, const mpq_t *M, const mpq_t *K)
{
	int n = r->n;
	if (!cholesky(r, all, M))
		return false;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			mpfr_set_q(r->A[i * n + j], K[r->coord[i] * all + r->coord[j]], MPFR_RNDN);
			mpfr_set_ui(r->V[i * n + j], i == j, MPFR_RNDN);
		}
	for (int j = 0; j < n; j++)
		divide_by(r, false, r->A + j, n);
	for (int i = 0; i < n; i++)
		divide_by(r, false, r->A + i * n, 1);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < i; j++) {
			mpfr_add(r->x, r->A[i * n + j], r->A[j * n + i], MPFR_RNDN);
			mpfr_div_2ui(r->x, r->x, 1, MPFR_RNDN);
			mpfr_set(r->A[i * n + j], r->x, MPFR_RNDN);
			mpfr_set(r->A[j * n + i], r->x, MPFR_RNDN);
		}
	if (!rotate_to_diagonal(r))
		return false;
	for (int j = 0; j < n; j++)
		divide_by(r, true, r->V + j, n);
	return true;
}

/* ---- where each eigenpair stands: by block, then rising; a vector's largest entry above 0 ---- */

static int largest_entry(const struct rotating *r, int j)
{
	int largest = 0;
	for (int i = 1; i < r->n; i++)
		if (mpfr_cmpabs(r->V[i * r->n + j], r->V[largest * r->n + j]) > 0)
			largest = i;
	return largest;
}

static void place_block(const struct rotating *r, int first, struct eigenpairs *pairs)
{
	int n = r->n, *rank = ARRAY(int, n);
	for (int j = 0; j < n; j++)
		for (int k = 0; k < n; k++) {
			int order = mpfr_cmp(r->A[k * n + k], r->A[j * n + j]);
			rank[j] += order < 0 || (order == 0 && k < j);
		}
	for (int j = 0; j < n; j++) {
		int to = first + rank[j];
		bool minus = mpfr_signbit(r->V[largest_entry(r, j) * n + j]);
		mpfr_set(pairs->value[to], r->A[j * n + j], MPFR_RNDN);
		for (int i = 0; i < n; i++) {
			mpfr_ptr entry = pairs->vector[r->coord[i] * pairs->n + to];
			mpfr_set(entry, r->V[i * n + j], MPFR_RNDN);
			if (minus)
				mpfr_neg(entry, entry, MPFR_RNDN);
		}
		pairs->block[to] = pairs->blocks;
	}
	pairs->blocks++;
}

/* ---- are they what they should be? ---- */

/* |K v - lambda M v| and |V^T M V - I| entry by entry, beside what they are sums of */
static bool is_residual_small(const struct eigenpairs *pairs, const mpq_t *M, const mpq_t *K, int bits)
{
	int n = pairs->n, precision = (int)mpfr_get_prec(pairs->value[0]);
	bool small = true;
	REALS *w = reals(5, precision), *Mv = reals((size_t)n, precision);
	mpfr_ptr sum = w[0], size = w[1], part = w[2], entry = w[3], product = w[4];
	for (int j = 0; j < n && small; j++) {
		for (int i = 0; i < n; i++) {
			mpfr_set_zero(sum, 1);
			mpfr_set_zero(size, 1);
			mpfr_set_zero(Mv[i], 1);
			for (int k = 0; k < n; k++) {
				mpfr_srcptr v = pairs->vector[k * n + j];
				mpfr_mul_q(entry, v, M[i * n + k], MPFR_RNDN);
				mpfr_add(Mv[i], Mv[i], entry, MPFR_RNDN);
				mpfr_mul(entry, entry, pairs->value[j], MPFR_RNDN);
				mpfr_mul_q(part, v, K[i * n + k], MPFR_RNDN);
				mpfr_sub(product, part, entry, MPFR_RNDN);
				mpfr_add(sum, sum, product, MPFR_RNDN);
				mpfr_abs(part, part, MPFR_RNDN);
				mpfr_abs(entry, entry, MPFR_RNDN);
				mpfr_add(size, size, part, MPFR_RNDN);
				mpfr_add(size, size, entry, MPFR_RNDN);
			}
			mpfr_div_2ui(size, size, (unsigned long)bits, MPFR_RNDN);
			small = small && mpfr_cmpabs(sum, size) <= 0;
		}
		for (int k = 0; k < n; k++) {
			mpfr_set_si(sum, -(k == j), MPFR_RNDN);
			for (int i = 0; i < n; i++) {
				mpfr_mul(part, pairs->vector[i * n + k], Mv[i], MPFR_RNDN);
				mpfr_add(sum, sum, part, MPFR_RNDN);
			}
			small = small && (mpfr_zero_p(sum) || mpfr_get_exp(sum) < -bits);
		}
	}
	return small;
}

/* ---- the whole ---- */

static bool solve(int n, const mpq_t *M, const mpq_t *K, const int *block, int blocks, int precision,
		  struct eigenpairs *pairs)
{
	struct rotating r = { .precision = precision, .coord = ARRAY(int, n) };
	size_t cells = (size_t)n * (size_t)n;
	bool good = true;
	int first = 0;
	mpfr_inits2(precision, r.x, r.y, r.c, r.s, r.t, NULL);
	r.L = reals(cells, precision);
	r.A = reals(cells, precision);
	r.V = reals(cells, precision);
	*pairs = (struct eigenpairs){ .n = n, .value = reals((size_t)n, precision),
				      .vector = reals(cells, precision), .block = ARRAY(int, n) };
	for (int b = 0; b < blocks && good; b++, first += r.n) {
		r.n = 0;
		for (int i = 0; i < n; i++)
			if (block[i] == b)
				r.coord[r.n++] = i;
		good = solve_block(&r, n, M, K);
		if (good)
			place_block(&r, first, pairs);
	}
	clear_reals(&r.L);
	clear_reals(&r.A);
	clear_reals(&r.V);
	mpfr_clears(r.x, r.y, r.c, r.s, r.t, NULL);
	return good;
}

bool symmetric_eigenpairs(int n, const mpq_t *M, const mpq_t *K, int precision, struct eigenpairs *pairs)
{
	bool *filled = ARRAY(bool, (size_t)n * (size_t)n);
	int *block = ARRAY(int, 2 * (size_t)n);
	for (int i = 0; i < n * n; i++)
		filled[i] = mpq_sgn(M[i]) != 0 || mpq_sgn(K[i]) != 0 || i % (n + 1) == 0;
	int blocks = matrix_blocks(n, filled, block);
	for (int k = 0, work = precision + GUARD_BITS; k < MOST_DOUBLINGS; k++, work *= 2)
		if (solve(n, M, K, block + n, blocks, work, pairs) && is_residual_small(pairs, M, K, precision))
			return true;
	return false;
}
