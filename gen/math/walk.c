/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Powers of a matrix in double: how far an error at one step reaches, summed over all steps after it.
 *
 * What a walk x+ = A x rounds is what any such step rounds, at most (n + 2) 2^-53 of |A| |x|, and it reaches the end as
 * other errors do. So sums of |A^m| bound the rounding of the very walk that finds them, and of all later walks. The
 * sums are bounded by those of two levels, m = L q + r: |A^m| <= |A^(L q)| |A^r|. */
#include "math/math.h"

#include <math.h>

#define WIDER (1 + 1e-6)            /* what the sums themselves round, many times over */

/* ---- balancing ---- */

static int power_between(double row, double column)
{
	return row > 0 && column > 0 && isfinite(row) && isfinite(column) ? (int)lround(log2(row / column) / 2) : 0;
}

/* Osborne's iteration, on A - I */
void balance_map(int n, double *A, double *scale)
{
	enum { SWEEPS = 20 };
	for (int i = 0; i < n; i++)
		scale[i] = 1;
	for (int sweep = 0; sweep < SWEEPS; sweep++)
		for (int i = 0; i < n; i++) {
			double row = 0, column = 0;
			for (int j = 0; j < n; j++) {
				row += j == i ? 0 : fabs(A[i * n + j]);
				column += j == i ? 0 : fabs(A[j * n + i]);
			}
			const int power = power_between(row, column);
			scale[i] = ldexp(scale[i], power);
			for (int j = 0; j < n && power != 0; j++) {
				if (j == i)
					continue;
				A[i * n + j] = ldexp(A[i * n + j], -power);
				A[j * n + i] = ldexp(A[j * n + i], power);
			}
		}
}

/* ---- sums of powers ---- */

/* C = A B */
static void multiply(int n, const double *A, const double *B, double *C)
{
	for (int i = 0; i < n * n; i++)
		C[i] = 0;
	for (int i = 0; i < n; i++)
		for (int k = 0; k < n; k++)
			for (int j = 0; j < n && A[i * n + k] != 0; j++)
				C[i * n + j] += A[i * n + k] * B[k * n + j];
}

static double *identity(int n)
{
	double *I = ARRAY(double, (size_t)(n * n));
	for (int i = 0; i < n; i++)
		I[i * n + i] = 1;
	return I;
}

double norm_of_rows(int n, const double *A)
{
	double largest = 0;
	for (int i = 0; i < n; i++) {
		double sum = 0;
		for (int j = 0; j < n; j++)
			sum += fabs(A[i * n + j]);
		largest = fmax(largest, sum);
		if (isnan(sum))
			return INFINITY;
	}
	return largest;
}

/* Of `count` powers of A, from A^0 on; *last is the one after them. Ends early where the rest is nothing beside I. */
static void add_powers(int n, const double *A, long count, double *sum, double *most, double **last)
{
	SCRATCH double *next = ARRAY(double, (size_t)(n * n));
	double *power = identity(n);
	for (long m = 0; m < count; m++) {
		for (int i = 0; i < n * n; i++) {
			sum[i] += fabs(power[i]);
			most[i] = fmax(most[i], fabs(power[i]));
		}
		if (!last && norm_of_rows(n, power) * (double)(count - m) < 1e-12) {
			const double after = norm_of_rows(n, power) * norm_of_rows(n, most);
			for (int i = 0; i < n * n; i++) {
				sum[i] += after * (double)(count - m);
				most[i] += after;
			}
			break;
		}
		multiply(n, A, power, next);
		double *swap = power;
		power = next;
		next = swap;
	}
	if (last)
		*last = power;
	else
		discard(power);
}

struct spread spread_of(int n, const double *A, long steps)
{
	const size_t cells = (size_t)(n * n);
	const long inner = (long)ceil(sqrt((double)steps)) + 1, outer = steps / inner + 1;
	struct spread s = { .n = n, .steps = steps, .sum = ARRAY(double, cells), .most = ARRAY(double, cells) };
	double *sum[2] = { ARRAY(double, cells), ARRAY(double, cells) };
	double *most[2] = { ARRAY(double, cells), ARRAY(double, cells) }, *stride;
	add_powers(n, A, inner, sum[0], most[0], &stride);
	add_powers(n, stride, outer, sum[1], most[1], NULL);
	multiply(n, sum[1], sum[0], s.sum);
	multiply(n, most[1], most[0], s.most);
	for (int i = 0; i < n * n; i++) {
		s.sum[i] *= WIDER;
		s.most[i] *= WIDER;
	}
	s.slack = norm_of_rows(n, s.sum) * (n + 8) * 0x1p-52;
	s.known = s.slack < 1e-4;
	for (int k = 0; k < 2; k++) {
		discard(sum[k]);
		discard(most[k]);
	}
	discard(stride);
	return s;
}

/* ---- one row ---- */

struct sparse sparse_of(int rows, int columns, const double *A)
{
	struct sparse s = { .rows = rows,
			    .start = ARRAY(int, rows + 1),
			    .column = ARRAY(int, (size_t)(rows * columns)),
			    .value = ARRAY(double, (size_t)(rows * columns)) };
	for (int i = 0; i < rows; i++) {
		s.start[i + 1] = s.start[i];
		for (int j = 0; j < columns; j++)
			if (A[i * columns + j] != 0) {
				s.column[s.start[i + 1]] = j;
				s.value[s.start[i + 1]++] = A[i * columns + j];
			}
	}
	return s;
}

void sparse_free(const struct sparse *s)
{
	discard(s->start);
	discard(s->column);
	discard(s->value);
}

void sparse_add(const struct sparse *s, const double *x, double *sum)
{
	for (int i = 0; i < s->rows; i++)
		for (int e = s->start[i]; e < s->start[i + 1]; e++)
			sum[i] += s->value[e] * x[s->column[e]];
}

static void next_vector(const struct sparse *s, bool columns, const double *x, double *next)
{
	for (int i = 0; i < s->rows; i++)
		next[i] = 0;
	if (columns) {
		sparse_add(s, x, next);
		return;
	}
	for (int k = 0; k < s->rows; k++)
		for (int e = s->start[k]; e < s->start[k + 1]; e++)
			next[s->column[e]] += x[k] * s->value[e];
}

static double largest_of(int n, const double *x)
{
	double largest = 0;
	for (int i = 0; i < n; i++)
		largest = fmax(largest, fabs(x[i]));
	return largest;
}

/* What all later powers add at most, or how large they are: |x| times the sums of all powers, or the largest */
static void find_tail(int n, const double *powers, const double *x, bool columns, double *tail)
{
	for (int i = 0; i < n; i++) {
		tail[i] = 0;
		for (int k = 0; k < n; k++)
			tail[i] += fabs(x[k]) * (columns ? powers[i * n + k] : powers[k * n + i]);
	}
}

void reach_of_row(const struct spread *s, const double *A, const double *row, bool columns, double *sum, double *most)
{
	enum { LOOKS = 64, WALKED = 30000000, HEAD = 2000000 }; /* products: of all steps, else of the first */
	const int n = s->n;
	const long last = s->steps <= WALKED / (n * n) ? s->steps : HEAD / (n * n) + 1;
	SCRATCH double *x = ARRAY(double, n), *next = ARRAY(double, n), *tail = ARRAY(double, n);
	const struct sparse matrix = sparse_of(n, n, A);
	double largest = 0;
	long m = 0;
	for (int i = 0; i < n; i++) {
		x[i] = row[i];
		sum[i] = most[i] = 0;
	}
	for (; m < last; m++) {
		largest = fmax(largest, largest_of(n, x));
		for (int i = 0; i < n; i++) {
			sum[i] += fabs(x[i]);
			most[i] = fmax(most[i], fabs(x[i]));
		}
		next_vector(&matrix, columns, x, next);
		double *swap = x;
		x = next;
		next = swap;
		if (m % LOOKS != LOOKS - 1)
			continue;
		find_tail(n, s->sum, x, columns, tail);
		if (largest_of(n, tail) < 1e-9 * largest)
			break;
	}
	const bool ends = m == s->steps;
	find_tail(n, s->sum, x, columns, tail);
	for (int i = 0; i < n; i++)
		sum[i] = WIDER * (sum[i] + s->slack * largest * (double)(m + 1) + (ends ? 0 : tail[i]));
	find_tail(n, s->most, x, columns, tail);
	for (int i = 0; i < n; i++)
		most[i] = WIDER * (fmax(most[i], ends ? 0 : tail[i]) + s->slack * largest);
	sparse_free(&matrix);
}
