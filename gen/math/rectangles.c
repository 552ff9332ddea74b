/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vectors and matrices of complex numbers enclosed in rectangles: products added up, null vectors. */
#include "math/math.h"

struct rectangle *rectangles(int count, int precision)
{
	struct rectangle *z = ARRAY(struct rectangle, count);
	for (int i = 0; i < count; i++)
		rectangle_init(&z[i], precision);
	return z;
}

void clear_rectangles(struct rectangle **z)
{
	for (size_t i = 0; i < block_size(*z) / sizeof **z; i++)
		rectangle_clear(&(*z)[i]);
	discard(*z);
}

static bool rectangle_is_zero(const struct rectangle *z)
{
	return mpfi_is_zero(z->re) && mpfi_is_zero(z->im);
}

long interval_size(mpfi_srcptr x)
{
	mpfr_srcptr end = mpfr_cmpabs(&x->left, &x->right) > 0 ? &x->left : &x->right;
	return mpfr_regular_p(end) ? (long)mpfr_get_exp(end) : mpfr_zero_p(end) ? NO_SIZE : -NO_SIZE;
}

long rectangle_size(const struct rectangle *z)
{
	const long re = interval_size(z->re), im = interval_size(z->im);
	return re > im ? re : im;
}

void rectangle_add_product(struct rectangle *z, const struct rectangle *a, const struct rectangle *b)
{
	if (rectangle_is_zero(a) || rectangle_is_zero(b))
		return;
	RECTANGLE product = new_rectangle((int)mpfi_get_prec(z->re));
	rectangle_mul(&product, a, b);
	mpfi_add(z->re, z->re, product.re);
	mpfi_add(z->im, z->im, product.im);
}

void rectangle_add_scaled(struct rectangle *z, const struct rectangle *a, mpq_srcptr factor)
{
	if (mpq_sgn(factor) == 0)
		return;
	INTERVAL part = OVER_BITS(mpfi_get_prec(z->re));
	mpfi_mul_q(part, a->re, factor);
	mpfi_add(z->re, z->re, part);
	mpfi_mul_q(part, a->im, factor);
	mpfi_add(z->im, z->im, part);
}

/* ---- null vectors ---- */

/* The largest that is left, to row and column k; false: there may be none */
static bool bring_pivot(int n, struct rectangle *P, int k, int *column)
{
	int row = k, col = k;
	for (int i = k; i < n; i++)
		for (int j = k; j < n; j++)
			if (rectangle_size(&P[i * n + j]) > rectangle_size(&P[row * n + col])) {
				row = i;
				col = j;
			}
	for (int j = 0; j < n; j++) {
		struct rectangle swap = P[k * n + j];
		P[k * n + j] = P[row * n + j];
		P[row * n + j] = swap;
	}
	for (int i = 0; i < n; i++) {
		struct rectangle swap = P[i * n + k];
		P[i * n + k] = P[i * n + col];
		P[i * n + col] = swap;
	}
	const int swap = column[k];
	column[k] = column[col];
	column[col] = swap;
	return !mpfi_has_zero(P[k * n + k].re) || !mpfi_has_zero(P[k * n + k].im);
}

static void eliminate(int n, struct rectangle *P, int k)
{
	RECTANGLE factor = new_rectangle((int)mpfi_get_prec(P->re));
	for (int i = k + 1; i < n; i++) {
		if (rectangle_is_zero(&P[i * n + k]))
			continue;
		rectangle_div(&factor, &P[i * n + k], &P[k * n + k]);
		mpfi_neg(factor.re, factor.re);
		mpfi_neg(factor.im, factor.im);
		for (int j = k + 1; j < n; j++)
			rectangle_add_product(&P[i * n + j], &factor, &P[k * n + j]);
	}
}

bool null_rectangles(int n, struct rectangle *P, struct rectangle *v)
{
	SCRATCH int *column = ARRAY(int, n);
	bool good = true;
	for (int i = 0; i < n; i++)
		column[i] = i;
	for (int k = 0; k < n - 1 && good; k++) {
		good = bring_pivot(n, P, k, column);
		if (good)
			eliminate(n, P, k);
	}
	mpfi_set_ui(v[column[n - 1]].re, 1);
	mpfi_set_ui(v[column[n - 1]].im, 0);
	for (int k = n - 2; k >= 0 && good; k--) {
		struct rectangle *sum = &v[column[k]];
		mpfi_set_ui(sum->re, 0);
		mpfi_set_ui(sum->im, 0);
		for (int j = k + 1; j < n; j++)
			rectangle_add_product(sum, &P[k * n + j], &v[column[j]]);
		rectangle_div(sum, sum, &P[k * n + k]);
		mpfi_neg(sum->re, sum->re);
		mpfi_neg(sum->im, sum->im);
	}
	return good;
}

void scale_rectangles(int n, struct rectangle *v)
{
	int at = 0;
	for (int i = 1; i < n; i++)
		at = rectangle_size(&v[i]) > rectangle_size(&v[at]) ? i : at;
	RECTANGLE largest = new_rectangle((int)mpfi_get_prec(v->re));
	rectangle_set(&largest, &v[at]);
	for (int i = 0; i < n; i++)
		rectangle_div(&v[i], &v[i], &largest);
	mpfi_set_ui(v[at].re, 1);
	mpfi_set_ui(v[at].im, 0);
}
