/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Entries of e^{A tau} that are polynomials of tau, exactly.
 * Walks from i to j stay among the states S that i leads to and that lead to j; with N = |S|, Cayley and Hamilton make
 * (A^k)_ij a recurrence of order N in k. If it is 0 for N <= k < 2N, it is 0 for all k >= N, and (e^{A tau})_ij is the
 * polynomial sum_{k<N} (A^k)_ij tau^k/k!; without a cycle in S that needs no test. Otherwise the entry has a pole other
 * than 0. */
#include "math/taylor.h"

#include <string.h>

static bool leads(const struct taylor *t, int i, int j)
{
	return t->distance[i * t->n + j] >= 0;
}

/* What does not depend on the time is found once. */
static struct taylor *shortest_time(struct taylor *t)
{
	while (t->half)
		t = t->half;
	return t;
}

static bool *find_cyclic(const struct taylor *t)
{
	bool *cyclic = ARRAY(bool, t->n);
	for (int i = 0; i < t->n; i++)
		for (int j = 0; j < t->n; j++)
			cyclic[i] = cyclic[i] || (t->B_size[i * t->n + j].m && leads(t, j, i));
	return cyclic;
}

/* S in increasing order; returns N, and whether a cycle lies in it */
static int walked_states(const struct taylor *t, int i, int j, int *state, bool *cycle)
{
	int count = 0;
	*cycle = false;
	for (int k = 0; k < t->n; k++)
		if (leads(t, i, k) && leads(t, k, j)) {
			state[count++] = k;
			*cycle = *cycle || t->cyclic[k];
		}
	return count;
}

/* A modulo a prime of 62 bits that divides no denominator */
static uint64_t reduce(const struct taylor *t, uint64_t *residue)
{
	INTEGER prime = INTEGER_ZERO;
	mpz_set_ui(prime, 1);
	INTEGER inverse = INTEGER_ZERO;
	mpz_mul_2exp(prime, prime, 61);
	int cells = t->n * t->n, done = 0;
	while (done < cells) {
		mpz_nextprime(prime, prime);
		for (done = 0; done < cells && mpz_invert(inverse, mpq_denref(t->A[done]), prime); done++) {
			mpz_mul(inverse, inverse, mpq_numref(t->A[done]));
			mpz_mod(inverse, inverse, prime);
			residue[done] = mpz_getlimbn(inverse, 0);
		}
	}
	return mpz_getlimbn(prime, 0);
}

/* row <- x A modulo the prime; eight products of 62-bit factors fit into 127 bits */
static void modular_row(int n, uint64_t prime, const uint64_t *x, const uint64_t *A, unsigned __int128 *sum,
			uint64_t *row)
{
	memset(sum, 0, (size_t)n * sizeof *sum);
	int products = 0;
	for (int k = 0; k < n; k++) {
		if (!x[k])
			continue;
		for (int j = 0; j < n; j++)
			sum[j] += (unsigned __int128)x[k] * A[k * n + j];
		if (++products % 8 == 0)
			for (int j = 0; j < n; j++)
				sum[j] %= prime;
	}
	for (int j = 0; j < n; j++)
		row[j] = (uint64_t)(sum[j] % prime);
}

/* power <- A^exponent modulo the prime */
static void modular_power(int n, uint64_t prime, const uint64_t *A, int exponent, unsigned __int128 *sum,
			  uint64_t *power)
{
	size_t cells = (size_t)n * (size_t)n;
	SCRATCH uint64_t *next = ARRAY(uint64_t, cells);
	memset(power, 0, cells * sizeof *power);
	for (int i = 0; i < n; i++)
		power[i * n + i] = 1;
	int bit = 1;
	while (bit <= exponent / 2)
		bit *= 2;
	for (; bit; bit /= 2) {
		for (int i = 0; i < n; i++)
			modular_row(n, prime, power + i * n, power, sum, next + i * n);
		if (exponent & bit)
			for (int i = 0; i < n; i++)
				modular_row(n, prime, next + i * n, A, sum, power + i * n);
		else
			memcpy(power, next, cells * sizeof *power);
	}
}

static bool *find_survivors(const struct taylor *t)
{
	int n = t->n;
	size_t cells = (size_t)n * (size_t)n;
	bool *survivor = ARRAY(bool, cells);
	SCRATCH uint64_t *A = ARRAY(uint64_t, cells), *power = ARRAY(uint64_t, cells), *row = ARRAY(uint64_t, n);
	SCRATCH unsigned __int128 *sum = ARRAY(unsigned __int128, n);
	SCRATCH int *state = ARRAY(int, n);
	uint64_t prime = reduce(t, A);
	modular_power(n, prime, A, n, sum, power);
	for (int i = 0; i < n; i++) {
		int left = 0;
		for (int j = 0; j < n; j++) {
			bool cycle = false;
			if (power[i * n + j] == 0 && leads(t, i, j))
				walked_states(t, i, j, state, &cycle);
			survivor[i * n + j] = cycle;
			left += cycle;
		}
		for (int k = n + 1; k < 2 * n && left; k++) {
			modular_row(n, prime, power + i * n, A, sum, row);
			memcpy(power + i * n, row, (size_t)n * sizeof *row);
			for (int j = 0; j < n; j++)
				if (survivor[i * n + j] && row[j]) {
					survivor[i * n + j] = false;
					left--;
				}
		}
	}
	return survivor;
}

/* The block of A over S as integers over their common denominator */
static mpz_t *integer_block(const struct taylor *t, int N, const int *state, mpz_ptr denominator)
{
	mpz_t *block = integers((size_t)N * (size_t)N);
	mpz_set_ui(denominator, 1);
	for (int a = 0; a < N; a++)
		for (int b = 0; b < N; b++)
			mpz_lcm(denominator, denominator, mpq_denref(t->A[state[a] * t->n + state[b]]));
	for (int a = 0; a < N; a++)
		for (int b = 0; b < N; b++) {
			mpq_srcptr entry = t->A[state[a] * t->n + state[b]];
			mpz_divexact(block[a * N + b], denominator, mpq_denref(entry));
			mpz_mul(block[a * N + b], block[a * N + b], mpq_numref(entry));
		}
	return block;
}

/* next <- row block; swapped, so that row is the new one. False: it is 0. */
static bool integer_row(int N, mpz_t *row, mpz_t *next, mpz_t *block)
{
	bool any = false;
	for (int b = 0; b < N; b++)
		mpz_set_ui(next[b], 0);
	for (int a = 0; a < N; a++)
		if (mpz_sgn(row[a]))
			for (int b = 0; b < N; b++)
				if (mpz_sgn(block[a * N + b]))
					mpz_addmul(next[b], row[a], block[a * N + b]);
	for (int b = 0; b < N; b++) {
		mpz_swap(row[b], next[b]);
		any = any || mpz_sgn(row[b]);
	}
	return any;
}

/* For every state of S that may have a polynomial entry in row i: value <- sum_{k<N} (A^k) tau^k/k!, polynomial <-
 * whether all later powers are 0. Kept for the next column, whose S is mostly the same. */
struct exact_row {
	int i, N;
	int *state;                 /* S */
	bool *polynomial;
	mpq_t *value;
};

static void add_power(struct exact_row *found, mpz_t *row, mpq_srcptr weight)
{
	RATIONAL term = ZERO;
	for (int a = 0; a < found->N; a++)
		if (found->polynomial[a] && mpz_sgn(row[a])) {
			mpq_set_z(term, row[a]);
			mpq_mul(term, term, weight);
			mpq_add(found->value[a], found->value[a], term);
		}
}

/* weight <- weight tau/(k denominator) */
static void next_weight(mpq_ptr weight, mpq_srcptr tau, int k, mpz_srcptr denominator)
{
	RATIONAL factor = ZERO;
	mpq_set_z(factor, denominator);
	mpq_inv(factor, factor);
	mpq_mul(weight, weight, factor);
	mpq_set_ui(factor, 1, (unsigned long)k);
	mpq_mul(weight, weight, factor);
	mpq_mul(weight, weight, tau);
}

/* Drops the entries whose power is not 0; returns how many are left. */
static int keep_zeros(struct exact_row *found, mpz_t *row)
{
	int left = 0;
	for (int a = 0; a < found->N; a++) {
		found->polynomial[a] = found->polynomial[a] && mpz_sgn(row[a]) == 0;
		left += found->polynomial[a];
	}
	return left;
}

static void find_row(const struct taylor *t, struct exact_row *found)
{
	int N = found->N, left = 1;
	INTEGER denominator = INTEGER_ZERO;
	INTEGERS *block = integer_block(t, N, found->state, denominator), *row = integers((size_t)N),
		 *next = integers((size_t)N);
	RATIONAL weight = RATIO(1, 1);
	for (int a = 0; a < N; a++)
		mpz_set_ui(row[a], found->state[a] == found->i);
	for (int k = 0; k < 2 * N && left; k++) {
		if (k > 0 && !integer_row(N, row, next, block))
			break;
		if (k >= N) {
			left = keep_zeros(found, row);
			continue;
		}
		if (k > 0)
			next_weight(weight, t->tau, k, denominator);
		add_power(found, row, weight);
	}
}

static struct exact_row *exact_row_of(const struct taylor *t, int i, int N, const int *state, bool cycle)
{
	struct exact_row *found = NEW(struct exact_row);
	*found = (struct exact_row){ i, N, ARRAY(int, N), ARRAY(bool, N), rationals(N) };
	for (int a = 0; a < N; a++) {
		found->state[a] = state[a];
		found->polynomial[a] = !cycle || t->survivor[i * t->n + state[a]];
	}
	find_row(t, found);
	return found;
}

static void exact_row_clear(struct exact_row *found)
{
	clear_rationals(&found->value);
	discard(found->polynomial);
	discard(found->state);
	discard(found);
}

/* From the row as found for the same S; sets `exact` if the entry is a polynomial */
static bool polynomial_entry(struct taylor *t, int i, int j, int N, const int *state, bool cycle, mpq_ptr exact)
{
	struct exact_row *found = t->row;
	if (!found || found->i != i || found->N != N || memcmp(found->state, state, (size_t)N * sizeof *state)) {
		if (found)
			exact_row_clear(found);
		found = t->row = exact_row_of(t, i, N, state, cycle);
	}
	for (int a = 0; a < N; a++)
		if (state[a] == j && found->polynomial[a]) {
			mpq_set(exact, found->value[a]);
			return true;
		}
	return false;
}

bool taylor_exact(struct taylor *t, int i, int j, mpq_ptr exact)
{
	mpq_set_ui(exact, mpq_sgn(t->tau) == 0 && i == j, 1);
	if (!leads(t, i, j) || mpq_sgn(t->tau) == 0)
		return true;
	struct taylor *first = shortest_time(t);
	if (!t->cyclic)
		t->cyclic = first->cyclic = first->cyclic ? first->cyclic : find_cyclic(first);
	SCRATCH int *state = ARRAY(int, t->n);
	bool cycle;
	int N = walked_states(t, i, j, state, &cycle);
	if (cycle && !t->survivor)
		t->survivor = first->survivor = first->survivor ? first->survivor : find_survivors(first);
	return (!cycle || t->survivor[i * t->n + j]) && polynomial_entry(t, i, j, N, state, cycle, exact);
}
