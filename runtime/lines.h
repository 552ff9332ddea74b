/* SPDX-License-Identifier: MIT-0 */
/* lines.h: what a long Taylor series asks of its coefficients so far, by loops: sums of products, and linear equations.
 * Included by the file of each model before its series, which defines which of them it has:
 *
 *     PL_INNERS, PL_SQUARES      of two sequences, of one with itself
 *     PL_DIVIDED, PL_POWERS      of what is made by division, of powers
 *     PL_SOLVES                  linear equations
 *     PL_ACROSS                  above 0: so many rows side by side, the table is [k][row]; behind lanes.h
 *     PL_RUNS, PL(alike)[]       then sums of products of like elements: rows a, b, offset beside k, how many
 *
 * Each sum has the order of the same series in straight code, from what stands in the middle to both ends, in two
 * chains where it is long. */
#include "numbers.h"

#if PL_ACROSS > 0
#define PL_NEXT PL_ACROSS
#else
#define PL_NEXT 1
#endif
#define PL_PAIR(a, i, b, j) ((a)[(i) * PL_NEXT] * (b)[(j) * PL_NEXT])

#if PL_INNERS || PL_RUNS > 0
/* a[1] b[k-1] + ... + a[k-1] b[1] */
static real PL(inner)(const real *a, const real *b, int k)
{
	real sum[2] = {0, 0};
	int i = k / 2, j = k - i;
	if (i == j && i > 0) { /* in the middle, the first of the first chain */
		sum[0] = PL_PAIR(a, i, b, i);
		i--;
		j++;
		if (k <= 4) { /* at most four terms: one chain */
			return i > 0 ? sum[0] + PL_PAIR(a, i, b, j) + PL_PAIR(a, j, b, i) : sum[0];
		}
		for (; i > 0; i--, j++) {
			sum[1] += PL_PAIR(a, i, b, j);
			sum[0] += PL_PAIR(a, j, b, i);
		}
		return sum[0] + sum[1];
	}
	if (k <= 5) {
		for (; i > 0; i--, j++) {
			sum[0] = sum[0] + PL_PAIR(a, i, b, j) + PL_PAIR(a, j, b, i);
		}
		return sum[0];
	}
	for (; i > 0; i--, j++) {
		sum[0] += PL_PAIR(a, i, b, j);
		sum[1] += PL_PAIR(a, j, b, i);
	}
	return sum[0] + sum[1];
}
#endif

#if PL_SQUARES || PL_RUNS > 0
/* The same of a and a: each pair once, twice over */
static real PL(inner_square)(const real *a, int k)
{
	real sum[2] = {0, 0};
	int i = (k - 1) / 2, j = k - i;
	if (i <= 4) {
		for (; i > 0; i--, j++) {
			sum[0] += PL_PAIR(a, i, a, j);
		}
	}
	for (; i > 0; i -= 2, j += 2) {
		sum[0] += PL_PAIR(a, i, a, j);
		sum[1] += i > 1 ? PL_PAIR(a, i - 1, a, j + 1) : 0;
	}
	sum[0] = 2 * (sum[0] + sum[1]);
	return k % 2 ? sum[0] : PL_PAIR(a, k / 2, a, k / 2) + sum[0];
}
#endif

#if PL_DIVIDED
/* c[1] b[k-1] + ... + c[k-1] b[1] */
static real PL(inner_of_quotient)(const real *c, const real *b, int k)
{
	real sum[2] = {0, 0};
	int j;
	for (j = 1; j + 1 < k; j += 2) {
		sum[0] += PL_PAIR(c, j, b, k - j);
		sum[1] += PL_PAIR(c, j + 1, b, k - j - 1);
	}
	return sum[0] + sum[1] + (j < k ? PL_PAIR(c, j, b, k - j) : 0);
}
#endif

#if PL_POWERS
/* The sum over 0 < j < k of (e (k - j) - j)/k a[k-j] c[j]: c is a^e */
static real PL(inner_of_power)(const real *a, const real *c, int k, real e)
{
	real sum = 0;
	int j;
	for (j = 1; j < k; j++) {
		sum += (e * (real)(k - j) - (real)j) / (real)k * PL_PAIR(a, k - j, c, j);
	}
	return sum;
}
#endif

#if PL_RUNS > 0
/* ---- the same of like elements in lanes, `groups` of them: each sum in its order ---- */

#define PL_AT_ONCE (sizeof(pl_lanes) / sizeof(real))
/* sum += a b, of lanes from there on */
PL_LANES_INLINE void PL(add_lanes)(pl_lanes *sum, const real *a, const real *b, const size_t groups)
{
	size_t g;
	PL_LANES_UNROLL
	for (g = 0; g < groups; g++) {
		sum[g] = sum[g] + pl_lanes_at(a + g * PL_AT_ONCE) * pl_lanes_at(b + g * PL_AT_ONCE);
	}
}

PL_LANES_INLINE void PL(inner_lanes)(const real *a, const real *b, size_t k, real *to, const size_t groups)
{
	const size_t middle = k / 2 * PL_NEXT, end = k * PL_NEXT;
	pl_lanes sum[4], more[4];
	size_t i = middle, g;
	PL_LANES_UNROLL
	for (g = 0; g < groups; g++) {
		sum[g] = more[g] = pl_lanes_all(0);
	}
	if (k % 2 == 0) { /* in the middle, the first of the first chain; the next is the other one's */
		const real *const other = a;
		PL(add_lanes)(sum, a + middle, b + middle, groups);
		i -= PL_NEXT;
		a = k > 5 ? b : a;
		b = k > 5 ? other : b;
	}
	if (k <= 5) {
		for (; i > 0; i -= PL_NEXT) {
			PL(add_lanes)(sum, a + i, b + end - i, groups);
			PL(add_lanes)(sum, a + end - i, b + i, groups);
		}
	}
	for (; i > 0; i -= PL_NEXT) {
		PL(add_lanes)(sum, a + i, b + end - i, groups);
		PL(add_lanes)(more, a + end - i, b + i, groups);
	}
	PL_LANES_UNROLL
	for (g = 0; g < groups; g++) {
		pl_lanes_put(to + g * PL_AT_ONCE, k > 5 ? sum[g] + more[g] : sum[g]);
	}
}

PL_LANES_INLINE void PL(inner_square_lanes)(const real *a, size_t k, real *to, const size_t groups)
{
	const size_t end = k * PL_NEXT;
	pl_lanes sum[4], more[4];
	size_t i = (k - 1) / 2 * PL_NEXT, g;
	PL_LANES_UNROLL
	for (g = 0; g < groups; g++) {
		sum[g] = more[g] = pl_lanes_all(0);
	}
	if (k > 10) {
		for (; i > PL_NEXT; i -= 2 * PL_NEXT) {
			PL(add_lanes)(sum, a + i, a + end - i, groups);
			PL(add_lanes)(more, a + i - PL_NEXT, a + end - i + PL_NEXT, groups);
		}
	}
	for (; i > 0; i -= PL_NEXT) {
		PL(add_lanes)(sum, a + i, a + end - i, groups);
	}
	PL_LANES_UNROLL
	for (g = 0; g < groups; g++) {
		const pl_lanes middle = pl_lanes_at(a + k / 2 * PL_NEXT + g * PL_AT_ONCE);
		sum[g] = 2 * (sum[g] + more[g]);
		pl_lanes_put(to + g * PL_AT_ONCE, k % 2 == 0 ? middle * middle + sum[g] : sum[g]);
	}
}

/* Of one run; what does not fill lanes is made again with some before, or by itself */
static void PL(inners_of_run)(const real *a, const real *b, size_t k, size_t count, real *to)
{
	size_t done = 0, at;
	for (; done + PL_AT_ONCE < count && count >= 4 * PL_AT_ONCE; done += 4 * PL_AT_ONCE) {
		at = count - done < 4 * PL_AT_ONCE ? count - 4 * PL_AT_ONCE : done;
		if (a == b) {
			PL(inner_square_lanes)(a + at, k, to + at, 4);
		} else {
			PL(inner_lanes)(a + at, b + at, k, to + at, 4);
		}
	}
	for (; done < count && count >= PL_AT_ONCE; done += PL_AT_ONCE) {
		at = count - done < PL_AT_ONCE ? count - PL_AT_ONCE : done;
		if (a == b) {
			PL(inner_square_lanes)(a + at, k, to + at, 1);
		} else {
			PL(inner_lanes)(a + at, b + at, k, to + at, 1);
		}
	}
	for (; done < count; done++) {
		to[done] = a == b ? PL(inner_square)(a + done, (int)k) : PL(inner)(a + done, b + done, (int)k);
	}
}

static void PL(inners_of_turn)(const real *table, int k, real *to)
{
	int i;
	for (i = 0; i < 4 * PL_RUNS; i += 4) {
		const size_t count = (size_t)PL(alike)[i + 3];
		const size_t order = (size_t)(k + PL(alike)[i + 2]);
		PL(inners_of_run)(table + PL(alike)[i], table + PL(alike)[i + 1], order, count, to);
		to += count;
	}
}
#undef PL_AT_ONCE
#elif PL_ACROSS > 0 /* no products of this loop are of rows that it has */
static inline void PL(inners_of_turn)(const real *table, int k, real *to)
{
	(void)table;
	(void)k;
	(void)to;
}
#endif

#if PL_SOLVES
/* m, n x n, becomes factors of itself, row after row, as L D U with D U above the diagonal turned: below it stands L D,
 * above it U, on it 1/D. before[first[i]] to before[first[i+1]]: the columns below i where row i of L is not 0, rising;
 * those of U are the same.  A symmetric matrix is read below its diagonal. */
static void PL(factor_by_lists)(int n, int symmetric, const short *first, const short *before, real *m)
{
	int i, k, p, q;
	for (i = 0; i < n; i++) {
		real *const row = m + i * n;
		const int end = first[i + 1], whole = end > first[i] && before[first[i]] == i - (end - first[i]);
		real pivot = row[i];
		for (p = first[i]; p < end; p++) {
			const int j = before[p];
			const real left = row[j];
			real right = symmetric ? left : m[j * n + i];
			for (q = first[j]; q < first[j + 1] && !symmetric; q++) {
				right -= m[j * n + before[q]] * m[before[q] * n + i];
			}
			m[j * n + i] = right * m[j * n + j];
			pivot -= left * m[j * n + i];
			if (whole) { /* all between the first and the diagonal */
				PL_UNROLL
				for (k = j + 1; k < i; k++) {
					row[k] -= left * m[j * n + k];
				}
				continue;
			}
			for (q = p + 1; q < end; q++) {
				row[before[q]] -= left * m[j * n + before[q]];
			}
		}
		row[i] = 1 / pivot;
	}
}

/* Columns of x[n][count], `width` of them from x on, right sides, become the solutions. */
static inline void PL(solve_columns)(int n, int count, int width, const short *first, const short *before,
									 const real *m, real *x)
{
	real sum[4];
	int i, p, c;
	for (i = 0; i < n; i++) {
		PL_UNROLL
		for (c = 0; c < width; c++) {
			sum[c] = x[i * count + c];
		}
		for (p = first[i]; p < first[i + 1]; p++) {
			const real factor = m[i * n + before[p]], *const other = x + before[p] * count;
			PL_UNROLL
			for (c = 0; c < width; c++) {
				sum[c] -= factor * other[c];
			}
		}
		PL_UNROLL
		for (c = 0; c < width; c++) {
			x[i * count + c] = sum[c] * m[i * n + i];
		}
	}
	for (i = n - 1; i > 0; i--) {
		PL_UNROLL
		for (c = 0; c < width; c++) {
			sum[c] = x[i * count + c];
		}
		for (p = first[i]; p < first[i + 1]; p++) {
			const real factor = m[before[p] * n + i];
			real *const other = x + before[p] * count;
			PL_UNROLL
			for (c = 0; c < width; c++) {
				other[c] -= factor * sum[c];
			}
		}
	}
}

/* Four at a time, as many as registers hold */
static void PL(solve_by_lists)(int n, int count, const short *first, const short *before, const real *m, real *x)
{
	int c = 0;
	for (; c + 4 <= count; c += 4) {
		PL(solve_columns)(n, count, 4, first, before, m, x + c);
	}
	for (; c < count; c++) {
		PL(solve_columns)(n, count, 1, first, before, m, x + c);
	}
}
#endif

#undef PL_NEXT
#undef PL_PAIR
#include "undef.h"
