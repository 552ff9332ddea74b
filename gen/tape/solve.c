/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear equations as nodes: factors of a matrix once, then as many solutions as are wanted. A symmetric matrix, one
 * whose entries across the diagonal are the same nodes, becomes L D L^T, any other L D U; rows are not exchanged, since
 * a program without branches cannot choose them, so the order of the rows is the order of elimination. What is 0 for
 * all states takes no operation. */
#include "tape/tape.h"

int *factor_columns(int n, bool *filled, int *first)
{
	int count = 0, *before = ARRAY(int, n * n + 1);
	for (int k = 0; k < n; k++)
		for (int i = k + 1; i < n; i++)
			for (int j = k + 1; j < n && filled[i * n + k]; j++)
				filled[i * n + j] = filled[i * n + j] || filled[k * n + j];
	for (int i = 0; i < n; i++) {
		first[i] = count;
		for (int j = 0; j < i; j++)
			if (filled[i * n + j])
				before[count++] = j;
	}
	first[n] = count;
	return before;
}

struct tape_factors {
	struct tape *t;
	int n;
	tape_ref *lower, *upper;    /* n x n, 1 on the diagonal, which does not stand there */
	tape_ref *inverse;          /* 1/D */
};

static tape_ref product(struct tape *t, tape_ref a, tape_ref b)
{
	return a == TAPE_NONE || b == TAPE_NONE ? TAPE_NONE : tape_binary(t, TAPE_MUL, a, b);
}

static tape_ref minus_product(struct tape *t, tape_ref sum, tape_ref a, tape_ref b)
{
	tape_ref term = product(t, a, b);
	if (term == TAPE_NONE)
		return sum;
	term = tape_unary(t, TAPE_NEG, term);
	return sum == TAPE_NONE ? term : tape_binary(t, TAPE_ADD, sum, term);
}

static bool is_symmetric(int n, const tape_ref *M)
{
	for (int i = 0; i < n; i++)
		for (int j = 0; j < i; j++)
			if (M[i * n + j] != M[j * n + i])
				return false;
	return true;
}

/* Column k below the diagonal over the pivot, and what it takes from the rest */
static void eliminate(struct tape_factors *f, int k, tape_ref *rest, bool symmetric)
{
	struct tape *t = f->t;
	int n = f->n;
	f->inverse[k] = tape_binary(t, TAPE_DIV, tape_number(t, 1), rest[k * n + k]);
	for (int i = k + 1; i < n; i++) {
		f->lower[i * n + k] = product(t, rest[i * n + k], f->inverse[k]);
		f->upper[k * n + i] = symmetric ? f->lower[i * n + k] : product(t, rest[k * n + i], f->inverse[k]);
	}
	for (int i = k + 1; i < n; i++)
		for (int j = symmetric ? i : k + 1; j < n; j++) {
			tape_ref *entry = &rest[i * n + j];
			*entry = minus_product(t, *entry, f->lower[i * n + k], rest[k * n + j]);
			if (symmetric)
				rest[j * n + i] = *entry;
		}
}

struct tape_factors *tape_factors_new(struct tape *t, int n, const tape_ref *M)
{
	struct tape_factors *f = NEW(struct tape_factors);
	SCRATCH tape_ref *rest = ARRAY(tape_ref, n * n);
	const bool symmetric = is_symmetric(n, M);
	*f = (struct tape_factors){ t, n, ARRAY(tape_ref, n * n), ARRAY(tape_ref, n * n), ARRAY(tape_ref, n) };
	for (int i = 0; i < n * n; i++)
		rest[i] = M[i];
	for (int k = 0; k < n; k++)
		eliminate(f, k, rest, symmetric);
	return f;
}

/* x of M x = right; where TAPE_NONE stands it is 0 */
void tape_solve(const struct tape_factors *f, const tape_ref *right, tape_ref *x)
{
	struct tape *t = f->t;
	int n = f->n;
	for (int i = 0; i < n; i++) {
		x[i] = right[i];
		for (int k = 0; k < i; k++)
			x[i] = minus_product(t, x[i], f->lower[i * n + k], x[k]);
	}
	for (int i = 0; i < n; i++)
		x[i] = product(t, x[i], f->inverse[i]);
	for (int i = n - 1; i >= 0; i--)
		for (int k = i + 1; k < n; k++)
			x[i] = minus_product(t, x[i], f->upper[i * n + k], x[k]);
}
