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
