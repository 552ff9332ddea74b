/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "algebra.h"

void add_product(mpq_ptr sum, mpq_srcptr a, mpq_srcptr b, bool subtract)
{
	mpq_t product;
	mpq_init(product);
	mpq_mul(product, a, b);
	(subtract ? mpq_sub : mpq_add)(sum, sum, product);
	mpq_clear(product);
}

bool eliminate(size_t rows, size_t width, mpq_t *W)
{
	mpq_t factor;
	mpq_init(factor);
	for (size_t k = 0; k < rows; k++) {
		size_t pivot = k;
		while (pivot < rows && mpq_sgn(W[pivot * width + k]) == 0)
			pivot++;
		if (pivot == rows)
			return false;
		for (size_t j = 0; j < width; j++)
			mpq_swap(W[pivot * width + j], W[k * width + j]);
		for (size_t j = width; j-- > k;)
			mpq_div(W[k * width + j], W[k * width + j], W[k * width + k]);
		for (size_t i = 0; i < rows; i++) {
			mpq_set(factor, W[i * width + k]);
			for (size_t j = k; i != k && j < width && mpq_sgn(factor); j++)
				add_product(W[i * width + j], factor, W[k * width + j], true);
		}
	}
	mpq_clear(factor);
	return true;
}

/* What stands on the right of the highest derivative of row i */
static void fill_right(const struct linear *system, const mpq_t *K, const mpq_t *C, size_t i, int segment,
					   mpq_t *right)
{
	const size_t n = (size_t)system->n;
	for (size_t j = 0; j < n; j++) {
		mpq_set(right[j], K[i * n + j]);
		if (system->velocity[j] >= 0)
			mpq_set(right[system->velocity[j]], C[i * n + j]);
	}
	right += system->states;
	for (int l = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++)
			mpq_set(*right++, system->load[l].force[k][(size_t)segment * n + i]);
	for (int u = 0; u < system->inputs; u++)
		for (int k = 0; k < 2; k++)
			mpq_set(*right++, system->input[u].force[k][i]);
}

mpq_t *highest_rows(const struct linear *system, const mpq_t *K, const mpq_t *C, int segment, int forces,
					const int *row, size_t *width)
{
	const size_t n = (size_t)system->n;
	const size_t own = (size_t)system->states + (size_t)load_columns(system) + 2 * (size_t)system->inputs;
	const size_t all = own + (size_t)forces;
	mpq_t *W = rationals(n * (n + all)), *R = rationals(n * all);
	for (size_t i = 0; i < n; i++) {
		mpq_t *left = W + i * (n + all);
		for (size_t j = 0; j < n; j++)
			mpq_set(left[j], system->velocity[j] < 0 ? system->C[i * n + j] : system->M[i * n + j]);
		fill_right(system, K, C, i, segment, left + n);
		for (int e = 0; e < forces; e++)
			mpq_set_ui(left[n + own + (size_t)e], (size_t)row[e] == i, 1);
	}
	if (!eliminate(n, n + all, W))
		return NULL;
	for (size_t i = 0; i < n; i++)
		for (size_t j = 0; j < all; j++)
			mpq_set(R[i * all + j], W[i * (n + all) + n + j]);
	*width = all;
	return R;
}

void fill_load_states(const struct load *load, size_t size, mpq_t *A)
{
	const bool turns = mpq_sgn(load->forcing->w) != 0;
	const size_t trig = turns ? 2 : 1;
	for (size_t c = 0; c < (size_t)load->columns; c++) {
		mpq_set(A[c * size + c], load->forcing->a);
		if (c >= trig)
			mpq_set_ui(A[c * size + c - trig], c / trig, 1);
		if (turns && c % 2 == 0)
			mpq_neg(A[c * size + c + 1], load->forcing->w);
		if (turns && c % 2 == 1)
			mpq_set(A[c * size + c - 1], load->forcing->w);
	}
}

uint64_t times(uint64_t a, uint64_t b)
{
	return (uint64_t)((unsigned __int128)a * b % PRIME);
}

uint64_t residue(mpq_srcptr q)
{
	uint64_t inverse = 1, power = mpz_fdiv_ui(mpq_denref(q), PRIME);
	for (uint64_t e = PRIME - 2; e && power != 1; e >>= 1, power = times(power, power))
		if (e & 1)
			inverse = times(inverse, power);
	return times(mpz_fdiv_ui(mpq_numref(q), PRIME), inverse);
}

void add_entry(mpfi_ptr x, const evaluator_enclosure *E, size_t entry, mpq_srcptr factor)
{
	mpfi_t term;
	mpz_t end;
	mpz_init(end);
	mpfi_init2(term, mpfi_get_prec(x));
	mpz_sub(end, E->mid[entry], E->radius);
	mpfr_set_z_2exp(&term->left, end, E->exponent, MPFR_RNDD);
	mpz_add(end, E->mid[entry], E->radius);
	mpfr_set_z_2exp(&term->right, end, E->exponent, MPFR_RNDU);
	if (mpq_cmp_ui(factor, 1, 1) != 0)
		mpfi_mul_q(term, term, factor);
	mpfi_add(x, x, term);
	mpfi_clear(term);
	mpz_clear(end);
}
