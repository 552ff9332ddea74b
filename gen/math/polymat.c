/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Determinant and adjugate of a matrix of polynomials, by evaluation at integers and interpolation: exact, and free of
 * the growth that elimination over polynomials has. */
#include "math/math.h"

static int degree_bound(struct polymat P)
{
	int bound = 0;
	for (int i = 0; i < P.n; i++) {
		int row = 0;
		for (int j = 0; j < P.n; j++)
			row = P.cell[i * P.n + j].length - 1 > row ? P.cell[i * P.n + j].length - 1 : row;
		bound += row;
	}
	return bound;
}

static void evaluate(struct poly p, long point, mpz_ptr value)
{
	mpz_set_ui(value, 0);
	for (int k = p.length - 1; k >= 0; k--) {
		mpz_mul_si(value, value, point);
		mpz_add(value, value, p.c[k]);
	}
}

/* det and adj of P at one point; false if P is singular there */
static bool sample(struct polymat P, long point, mpz_ptr det, mpz_t *adj)
{
	int n = P.n, width = adj ? 2 * n : n;
	INTEGERS *W = integers((size_t)(n * width));
	for (int i = 0; i < n; i++)
		for (int j = 0; j < width; j++)
			if (j < n)
				evaluate(P.cell[i * n + j], point, W[i * width + j]);
			else
				mpz_set_ui(W[i * width + j], j - n == i);
	int column;
	bool regular = bareiss(n, width, W, det, &column);
	for (int i = 0; i < n && regular && adj; i++)
		for (int j = 0; j < n; j++)
			mpz_init_set(adj[i * n + j], W[i * width + n + j]);
	return regular;
}

/* Newton's divided differences, over Q, then the powers of s; the result is integral. */
static struct poly interpolate(int count, const long *point, const mpz_t *value)
{
	RATIONALS *difference = rationals(count), *c = rationals(count);
	RATIONAL factor = ZERO;
	for (int i = 0; i < count; i++)
		mpq_set_z(difference[i], value[i]);
	for (int k = 1; k < count; k++)
		for (int i = count - 1; i >= k; i--) {
			mpq_sub(difference[i], difference[i], difference[i - 1]);
			mpq_set_si(factor, point[i] - point[i - k], 1);
			mpq_div(difference[i], difference[i], factor);
		}
	for (int k = count - 1; k >= 0; k--) {          /* c <- c (s - point_k) + difference_k */
		mpq_set_si(factor, -point[k], 1);
		for (int i = count - 1; i >= 0; i--) {
			mpq_mul(c[i], c[i], factor);
			if (i > 0)
				mpq_add(c[i], c[i], c[i - 1]);
		}
		mpq_add(c[0], c[0], difference[k]);
	}
	struct poly p = poly_new(count);
	for (int i = 0; i < count; i++)
		mpz_set(p.c[i], mpq_numref(c[i]));
	poly_trim(&p);
	return p;
}

/* ---- blocks ---- */

static int find_blocks(struct polymat P, int *block)
{
	SCRATCH bool *filled = ARRAY(bool, (size_t)P.n * (size_t)P.n);
	for (int cell = 0; cell < P.n * P.n; cell++)
		filled[cell] = P.cell[cell].length > 0;
	return matrix_blocks(P.n, filled, block);
}

/* The rows and columns of one block; false: it is not square, so that P is singular */
static bool part_of(struct polymat P, const int *block, int which, struct polymat *part)
{
	int rows = 0, columns = 0, filled = 0;
	for (int i = 0; i < P.n; i++) {
		rows += block[i] == which;
		columns += block[P.n + i] == which;
	}
	*part = (struct polymat){ rows, ARRAY(struct poly, (size_t)rows * (size_t)columns) };
	for (int i = 0; i < P.n; i++)
		for (int j = 0; j < P.n && block[i] == which; j++)
			if (block[P.n + j] == which)
				part->cell[filled++] = P.cell[i * P.n + j];
	return rows == columns;
}

/* Whether an order of blocks, kept within each, is an odd permutation */
static bool odd_order(int n, const int *block)
{
	bool odd = false;
	for (int i = 0; i < n; i++)
		for (int j = i + 1; j < n; j++)
			odd ^= block[i] > block[j];
	return odd;
}

static bool same_matrix(struct polymat a, struct polymat b)
{
	bool same = a.n == b.n;
	for (int i = 0; i < a.n * a.n && same; i++)
		same = poly_equal(a.cell[i], b.cell[i]);
	return same;
}

static struct poly determinant(struct polymat P, struct polymat *adj);

int polymat_determinants(struct polymat P, struct poly **det)
{
	int *block = ARRAY(int, 2 * (size_t)P.n), blocks = find_blocks(P, block);
	struct polymat *part = ARRAY(struct polymat, blocks);
	*det = ARRAY(struct poly, blocks + 1);
	for (int k = 0; k < blocks; k++) {
		int same = 0;
		if (!part_of(P, block, k, &part[k])) {
			(*det)[0] = poly_new(0);
			return 1;
		}
		while (!same_matrix(part[same], part[k]))
			same++;
		(*det)[k] = same < k ? (*det)[same] : determinant(part[k], NULL);
	}
	bool odd = odd_order(P.n, block) != odd_order(P.n, block + P.n);
	if (odd)
		(*det)[0] = poly_sub(poly_new(0), (*det)[0]);
	return blocks;
}

void polymat_adjugate(struct polymat P, struct poly *det, struct polymat *adj)
{
	if (adj) {
		*det = determinant(P, adj);
		return;
	}
	struct poly *part;
	int parts = polymat_determinants(P, &part);
	*det = poly_product(parts, part);
}

/* Of a matrix that is one block */
static struct poly determinant(struct polymat P, struct polymat *adj)
{
	int n = P.n, count = degree_bound(P) + 1, cells = adj ? n * n : 0;
	long *point = ARRAY(long, count);
	mpz_t *dets = ARRAY(mpz_t, count), *column = ARRAY(mpz_t, count), **adjs = ARRAY(mpz_t *, count);
	for (int found = 0, tried = 0; found < count; tried++) {        /* 0, 1, -1, 2, -2, ... where P is regular */
		point[found] = tried % 2 ? (tried + 1) / 2 : -(tried / 2);
		progress("B(s), point", found, count);
		adjs[found] = ARRAY(mpz_t, cells);
		mpz_init(dets[found]);
		found += sample(P, point[found], dets[found], adj ? adjs[found] : NULL);
	}
	progress_end();
	struct poly det = interpolate(count, point, dets);
	for (int cell = 0; cell < cells; cell++) {
		for (int k = 0; k < count; k++)
			column[k][0] = adjs[k][cell][0];        /* borrowed, not copied */
		adj->cell[cell] = interpolate(count, point, column);
	}
	return det;
}
