/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rational matrices. */
#include "math/math.h"

/* ---- blocks: rows and columns that have nothing in common with the others ---- */

int root_of_node(int *parent, int i)
{
	while (parent[i] != i)
		i = parent[i] = parent[parent[i]];
	return i;
}

void join_nodes(int *parent, int a, int b)
{
	parent[root_of_node(parent, a)] = root_of_node(parent, b);
}

int matrix_blocks(int n, const bool *filled, int *block)
{
	SCRATCH int *parent = numbers_up_to(2 * n);
	int count = 0;
	for (int cell = 0; cell < n * n; cell++)
		if (filled[cell])
			join_nodes(parent, cell / n, n + cell % n);
	for (int i = 0; i < 2 * n; i++)
		block[i] = -1;
	for (int j = 0; j < n; j++)
		if (block[root_of_node(parent, n + j)] < 0)
			block[root_of_node(parent, n + j)] = count++;
	for (int i = 0; i < 2 * n; i++)
		block[i] = block[root_of_node(parent, i)];
	return count;
}

/* ---- integers over a common denominator: sums of products need no gcds ---- */

/* z <- scale q, `stride` apart in q */
static void to_integers(int count, const mpq_t *q, int stride, mpz_ptr scale, mpz_t *z)
{
	mpz_set_ui(scale, 1);
	for (int i = 0; i < count; i++)
		if (mpz_cmp_ui(mpq_denref(q[i * stride]), 1) != 0)
			mpz_lcm(scale, scale, mpq_denref(q[i * stride]));
	for (int i = 0; i < count; i++) {
		mpz_divexact(z[i], scale, mpq_denref(q[i * stride]));
		mpz_mul(z[i], z[i], mpq_numref(q[i * stride]));
	}
}

/* ---- elimination ---- */

/* row <- (pivot row - factor pivot_row) / previous; most of the way most cells of a chain are 0 */
static void bareiss_row(int from, int width, mpz_t *row, const mpz_t *pivot_row, mpz_srcptr pivot, mpz_srcptr factor,
			mpz_srcptr previous)
{
	for (int j = from; j < width; j++) {
		bool taken = mpz_sgn(factor) != 0 && mpz_sgn(pivot_row[j]) != 0;
		if (!taken && mpz_sgn(row[j]) == 0)
			continue;
		mpz_mul(row[j], row[j], pivot);
		if (taken)
			mpz_submul(row[j], factor, pivot_row[j]);
		mpz_divexact(row[j], row[j], previous);
	}
}

bool bareiss(int n, int width, mpz_t *W, mpz_ptr det, int *column)
{
	int sign = 1, k = 0;
	INTEGER previous = INTEGER_ZERO;
	mpz_set_ui(previous, 1);
	INTEGER factor = INTEGER_ZERO;
	for (; k < n; k++) {
		int row = k;
		while (row < n && mpz_sgn(W[row * width + k]) == 0)
			row++;
		if (row == n)
			break;
		sign = row == k ? sign : -sign;
		for (int j = 0; j < width && row != k; j++)
			mpz_swap(W[row * width + j], W[k * width + j]);
		for (int i = width > n ? 0 : k + 1; i < n; i++) {     /* for the determinant alone, Gauss will do */
			mpz_set(factor, W[i * width + k]);
			if (i != k)
				bareiss_row(width > n ? 0 : k, width, W + i * width, W + k * width,
					    W[k * width + k], factor, previous);
		}
		mpz_set(previous, W[k * width + k]);
	}
	(sign < 0 ? mpz_neg : mpz_set)(det, previous);
	for (int i = 0; i < n * width && sign < 0; i++)
		mpz_neg(W[i], W[i]);
	*column = k;
	return k == n;
}

struct members {                    /* the rows and columns of one block */
	int rows, columns, *row, *column;
};

static struct members members_of(int n, const int *block, int which)
{
	struct members m = { 0, 0, ARRAY(int, n), ARRAY(int, n) };
	for (int i = 0; i < n; i++) {
		if (block[i] == which)
			m.row[m.rows++] = i;
		if (block[n + i] == which)
			m.column[m.columns++] = i;
	}
	return m;
}

/* The block at these rows and columns: with R A = W for integers W, A^-1 = W^-1 R. As many rows as columns, zeros where
 * there are fewer: *free is the first column that depends on those before it; -1: none does. */
static void block_inverse(int n, const mpq_t *A, const struct members *m, mpq_t *inverse, int *free)
{
	int size = m->columns, width = 2 * size, dependent;
	INTEGERS *W = integers((size_t)size * (size_t)width), *scale = integers((size_t)size);
	RATIONALS *row = rationals(size);
	INTEGER det = INTEGER_ZERO;
	for (int i = 0; i < size; i++) {
		for (int j = 0; j < size && i < m->rows; j++)
			mpq_set(row[j], A[m->row[i] * n + m->column[j]]);
		if (i < m->rows)
			to_integers(size, row, 1, scale[i], W + i * width);
		mpz_set_ui(W[i * width + size + i], 1);
	}
	bool regular = bareiss(size, width, W, det, &dependent);
	*free = regular ? -1 : m->column[dependent];
	for (int i = 0; i < size && regular; i++)
		for (int j = 0; j < size; j++) {
			mpq_ptr cell = inverse[m->column[i] * n + m->row[j]];
			mpz_mul(mpq_numref(cell), W[i * width + size + j], scale[j]);
			mpz_set(mpq_denref(cell), det);
			mpq_canonicalize(cell);
		}
}

/* Gauss and Jordan on [W | I], in numbers whose record is kept */
struct recorded {
	int size;
	mpq_t *W;                       /* size x 2 size */
	mpq_t *solved;                  /* at the spec's values the inverse of the block, transposed; size x size */
	int *row;                       /* per column: its pivot's; -1: none yet */
	bool *taken;                    /* per row */
};

/* The share of the determinant that contains an entry; those of a row have the sum 1, as those of a column (relative
 * gains: Bristol, IEEE Transactions on Automatic Control 11, 1966). In a symmetric positive definite matrix, and in
 * what elimination leaves of it, the largest is on the diagonal, wherever its rows stand: no pivot is 0 at other
 * values of params. Where the spec's values have no inverse, all are 0 and the first entry is taken. */
static int largest_share(const struct recorded *r)
{
	const int size = r->size;
	int best = -1;
	RATIONAL share = ZERO, largest = ZERO;
	for (int i = 0; i < size * size; i++) {
		mpq_srcptr entry = r->W[i / size * 2 * size + i % size];
		if (r->taken[i / size] || r->row[i % size] >= 0 || mpq_sgn(entry) == 0)
			continue;
		product_at_spec(share, entry, r->solved[i]);
		if (best < 0 || mpq_cmp(share, largest) > 0) {
			mpq_swap(largest, share);
			best = i;
		}
	}
	return best;
}

static void take_pivot(struct recorded *r, int row, int column)
{
	const int width = 2 * r->size;
	mpq_t *pivot = r->W + row * width;
	RATIONAL factor = ZERO;
	mpq_inv(factor, pivot[column]);
	for (int j = 0; j < width; j++)
		mpq_mul(pivot[j], pivot[j], factor);
	for (int i = 0; i < r->size; i++) {
		mpq_set(factor, r->W[i * width + column]);
		if (i != row && mpq_sgn(factor) != 0)
			rational_subtract_row(width, r->W + i * width, pivot, factor);
	}
	r->row[column] = row;
	r->taken[row] = true;
}

/* inverse <- the block's, as block_inverse has found it, with a record of how */
static void record_inverse(int n, const mpq_t *A, const struct members *m, mpq_t *inverse)
{
	const int size = m->columns, cells = size * size, width = 2 * size;
	int unused;
	RATIONALS *W = rationals(2 * (size_t)cells), *solved = rationals((size_t)cells), *one = rationals(1);
	RATIONALS *spec = rationals((size_t)n * (size_t)n), *all = rationals((size_t)n * (size_t)n);
	struct recorded r = { size, W, solved, ARRAY(int, size), ARRAY(bool, size) };
	mpq_set_ui(*one, 1, 1);
	for (int i = 0; i < cells; i++) {
		const int cell = m->row[i / size] * n + m->column[i % size];
		product_at_spec(spec[cell], A[cell], *one);
		mpq_set(W[i / size * width + i % size], A[cell]);
	}
	block_inverse(n, spec, m, all, &unused);
	for (int i = 0; i < cells; i++)
		mpq_set(solved[i], all[m->column[i % size] * n + m->row[i / size]]);
	for (int i = 0; i < size; i++) {
		mpq_set(W[i * width + size + i], *one);
		r.row[i] = -1;
	}
	for (int k = 0, at; k < size; k++) {
		at = largest_share(&r);
		take_pivot(&r, at / size, at % size);
	}
	for (int i = 0; i < cells; i++)
		mpq_set(inverse[m->column[i / size] * n + m->row[i % size]],
			W[r.row[i / size] * width + size + i % size]);
}

bool rational_inverse(int n, const mpq_t *A, mpq_t *inverse, int *column)
{
	SCRATCH bool *filled = ARRAY(bool, (size_t)n * (size_t)n);
	SCRATCH int *block = ARRAY(int, 2 * (size_t)n);
	int first = n;
	for (int i = 0; i < n * n; i++) {
		filled[i] = mpq_sgn(A[i]) != 0;
		mpq_set_ui(inverse[i], 0, 1);
	}
	int blocks = matrix_blocks(n, filled, block);
	const bool traced = is_traced((size_t)n * (size_t)n, A[0]);
	for (int b = 0; b < blocks; b++) {
		struct members m = members_of(n, block, b);
		int free = -1;
		if (m.rows <= m.columns)        /* else another has fewer rows than columns */
			block_inverse(n, A, &m, inverse, &free);
		if (m.rows <= m.columns && traced && free < 0)
			record_inverse(n, A, &m, inverse);
		first = free >= 0 && free < first ? free : first;
		discard(m.row);
		discard(m.column);
	}
	if (first < n)
		*column = first;
	return first == n;
}

bool inverse_kept(struct last_inverse *last, int n, const mpq_t *A, int *column)
{
	const size_t cells = (size_t)(n * n);
	if (last->n == n && rationals_equal(cells, last->A, A))
		return true;
	RATIONALS *inverse = rationals(cells);
	if (!rational_inverse(n, A, inverse, column))
		return false;
	if (last->n > 0) {
		rationals_free(last->A, (size_t)(last->n * last->n));
		rationals_free(last->inverse, (size_t)(last->n * last->n));
	}
	*last = (struct last_inverse){ n, rationals_copied(cells, A), rationals_copied(cells, inverse) };
	return true;
}

bool rational_symmetric(int n, const mpq_t *A)
{
	for (int i = 0; i < n; i++)
		for (int j = 0; j < i; j++)
			if (!mpq_equal(A[i * n + j], A[j * n + i]))
				return false;
	return true;
}

static void traced_product(int rows, int inner, int columns, const mpq_t *A, const mpq_t *B, mpq_t *AB)
{
	for (int i = 0; i < rows * columns; i++) {
		mpq_set_ui(AB[i], 0, 1);
		for (int k = 0; k < inner; k++)
			rational_addmul(AB[i], A[i / columns * inner + k], B[k * columns + i % columns]);
	}
}

/* Rows of A and columns of B as integers */
void unreduced_product(int rows, int inner, int columns, const mpq_t *A, const mpq_t *B, mpq_t *AB)
{
	if (is_traced((size_t)(rows * inner), A[0]) || is_traced((size_t)(inner * columns), B[0])) {
		traced_product(rows, inner, columns, A, B, AB);
		return;
	}
	INTEGERS *row = integers((size_t)inner), *column = integers((size_t)(inner * columns));
	INTEGERS *scale = integers((size_t)columns);
	INTEGER common = INTEGER_ZERO;
	for (int j = 0; j < columns; j++)
		to_integers(inner, B + j, columns, scale[j], column + j * inner);
	for (int i = 0; i < rows; i++) {
		to_integers(inner, A + i * inner, 1, common, row);
		for (int j = 0; j < columns; j++) {
			mpq_ptr sum = AB[i * columns + j];
			mpz_set_ui(mpq_numref(sum), 0);
			for (int k = 0; k < inner; k++)
				if (mpz_sgn(row[k]) != 0 && mpz_sgn(column[j * inner + k]) != 0)
					mpz_addmul(mpq_numref(sum), row[k], column[j * inner + k]);
			mpz_mul(mpq_denref(sum), common, scale[j]);
		}
	}
}

void rational_product(int rows, int inner, int columns, const mpq_t *A, const mpq_t *B, mpq_t *AB)
{
	unreduced_product(rows, inner, columns, A, B, AB);
	for (int i = 0; i < rows * columns; i++)
		mpq_canonicalize(AB[i]);
}
