/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Complex numbers enclosed in rectangles: a pair of MPFI intervals. Targets may be operands. */
#include "math/math.h"

void rectangle_init(struct rectangle *z, int precision)
{
	mpfi_init2(z->re, precision);
	mpfi_init2(z->im, precision);
	mpfi_set_ui(z->re, 0);
	mpfi_set_ui(z->im, 0);
}

struct rectangle new_rectangle(int precision)
{
	struct rectangle z;
	rectangle_init(&z, precision);
	return z;
}

void rectangle_clear(struct rectangle *z)
{
	mpfi_clear(z->re);
	mpfi_clear(z->im);
}

void rectangle_set(struct rectangle *z, const struct rectangle *a)
{
	mpfi_set(z->re, a->re);
	mpfi_set(z->im, a->im);
}

/* A product by a part that is exactly 0 is exactly 0, also where the other factor is unbounded. */
static void product(mpfi_ptr z, mpfi_srcptr a, mpfi_srcptr b)
{
	bool zero = (mpfr_zero_p(&a->left) && mpfr_zero_p(&a->right)) ||
		    (mpfr_zero_p(&b->left) && mpfr_zero_p(&b->right));
	if (zero)
		mpfi_set_ui(z, 0);
	else
		mpfi_mul(z, a, b);
}

static void multiply(struct rectangle *z, const struct rectangle *a, const struct rectangle *b, mpfi_ptr re,
		     mpfi_ptr im, mpfi_ptr other)
{
	product(re, a->re, b->re);
	product(other, a->im, b->im);
	mpfi_sub(re, re, other);
	product(im, a->re, b->im);
	product(other, a->im, b->re);
	mpfi_add(im, im, other);
	mpfi_swap(z->re, re);
	mpfi_swap(z->im, im);
}

void rectangle_mul(struct rectangle *z, const struct rectangle *a, const struct rectangle *b)
{
	const mpfr_prec_t bits = mpfi_get_prec(z->re);
	INTERVAL re = OVER_BITS(bits), im = OVER_BITS(bits), other = OVER_BITS(bits);
	multiply(z, a, b, re, im, other);
}

/* Re a b; may be a part of a */
void rectangle_real_product(mpfi_ptr re, const struct rectangle *a, const struct rectangle *b)
{
	INTERVAL other = OVER_BITS(mpfi_get_prec(re));
	product(other, a->im, b->im);
	product(re, a->re, b->re);
	mpfi_sub(re, re, other);
}

void rectangle_div(struct rectangle *z, const struct rectangle *a, const struct rectangle *b)
{
	int precision = (int)mpfi_get_prec(z->re);
	RECTANGLE conjugate = new_rectangle(precision);
	INTERVAL square = OVER_BITS(precision), norm = OVER_BITS(precision);
	mpfi_sqr(norm, b->re);
	mpfi_sqr(square, b->im);
	mpfi_add(norm, norm, square);
	mpfi_set(conjugate.re, b->re);
	mpfi_neg(conjugate.im, b->im);
	rectangle_mul(z, a, &conjugate);
	mpfi_div(z->re, z->re, norm);
	mpfi_div(z->im, z->im, norm);
}

void rectangle_sub(struct rectangle *z, const struct rectangle *a, const struct rectangle *b)
{
	mpfi_sub(z->re, a->re, b->re);
	mpfi_sub(z->im, a->im, b->im);
}

/* e^{a tau} */
void rectangle_exp(struct rectangle *z, const struct rectangle *a, mpq_srcptr tau)
{
	int precision = (int)mpfi_get_prec(z->re);
	INTERVAL size = OVER_BITS(precision), angle = OVER_BITS(precision);
	mpfi_mul_q(size, a->re, tau);
	mpfi_exp(size, size);
	mpfi_mul_q(angle, a->im, tau);
	mpfi_cos(z->re, angle);
	mpfi_sin(z->im, angle);
	product(z->re, z->re, size);
	product(z->im, z->im, size);
}

/* p(a) by Horner's rule */
void rectangle_evaluate(struct rectangle *z, struct poly p, const struct rectangle *a)
{
	const mpfr_prec_t bits = mpfi_get_prec(z->re);
	INTERVAL re = OVER_BITS(bits), im = OVER_BITS(bits), other = OVER_BITS(bits);
	mpfi_set_ui(z->re, 0);
	mpfi_set_ui(z->im, 0);
	for (int k = p.length - 1; k >= 0; k--) {
		multiply(z, z, a, re, im, other);
		mpfi_add_z(z->re, z->re, p.c[k]);
	}
}
