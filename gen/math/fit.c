/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A rational function of params that is known by its values alone, as a sum of products of their powers, -3 .. 3:
 * exactly, or not at all. Lines through a base point tell which powers of each param there are, steps along two params
 * whether they meet in a product; then as many scattered points as there are products left give their factors, and two
 * more have to agree. */
#include "math/math.h"

enum { EXPONENTS = 2 * FIT_DEGREE + 1 };

/* A value like no other */
static void set_value(mpq_ptr value, int index)
{
	uint32_t bits = (uint32_t)index * 2654435761u + 12345u;
	bits ^= bits >> 15;
	bits *= 2246822519u;
	bits ^= bits >> 13;
	mpq_set_ui(value, 1 + bits % 65521, 1 + (bits >> 16) % 251);
	mpq_canonicalize(value);
}

/* Point 0 is the base of the lines and pairs; the others are for fitting and checking. */
mpq_t *scattered_values(int params, int number)
{
	mpq_t *values = rationals(params);
	for (int k = 0; k < params; k++)
		set_value(values[k], number * FIT_PARAMS + k);
	return values;
}

/* near + 2^-40 |near| v in the place of v: what has a sign there, or an order, keeps it */
static void draw_near(int params, const mpq_t *near, mpq_t *values)
{
	RATIONAL unit = ZERO;
	for (int k = 0; k < params && near; k++) {
		mpq_abs(unit, near[k]);
		if (mpq_sgn(unit) == 0)
			mpq_set_ui(unit, 1, 1);
		mpq_div_2exp(unit, unit, 40);
		mpq_mul(values[k], values[k], unit);
		mpq_add(values[k], values[k], near[k]);
	}
}

mpq_t *scattered_near(int params, int number, const mpq_t *near)
{
	mpq_t *values = scattered_values(params, number);
	draw_near(params, near, values);
	return values;
}

static mpq_t *scattered(const struct fit *f, int number)
{
	return scattered_near(f->params, number, f->near);
}

/* The base with `up` added to param k and `other` to param j */
static mpq_t *near_base(const struct fit *f, int k, int up, int j, int other)
{
	mpq_t *values = scattered_values(f->params, 0);
	RATIONAL shift = RATIO(up, 1);
	mpq_add(values[k], values[k], shift);
	mpq_set_si(shift, other, 1);
	mpq_add(values[j], values[j], shift);
	draw_near(f->params, f->near, values);
	return values;
}

static mpq_srcptr value_at(const struct fit *f, const mpq_t *values)
{
	return f->value(f->context, values);
}

static void power_of(mpq_srcptr x, int exponent, mpq_ptr result)
{
	mpq_set_ui(result, 1, 1);
	for (int i = exponent < 0 ? -exponent : exponent; i > 0; i--)
		mpq_mul(result, result, x);
	if (exponent < 0)
		mpq_inv(result, result);
}

/* Along the line of param k, up from the base by 0, 1, ...: f(x) x^most through 2 most + 1 points as a polynomial, and
 * which of its coefficients are not 0. One more point checks. */
static bool try_exponents(struct fit *f, int k, int most)
{
	const int count = 2 * most + 1;
	mpq_t *V = rationals((size_t)(count * count)), *y = rationals(count), *c = rationals(count),
	      *sum = rationals(2);
	for (int i = 0; i < count; i++) {
		mpq_t *at = near_base(f, k, i, k, 0);
		mpq_set(y[i], value_at(f, at));
		for (int j = 0; j < count; j++)
			power_of(at[k], j - most, V[i * count + j]);
		f->depends[k] = f->depends[k] || !mpq_equal(y[i], y[0]);
	}
	mpq_t *at = near_base(f, k, count, k, 0);
	mpq_srcptr last = value_at(f, at);
	f->depends[k] = f->depends[k] || !mpq_equal(last, y[0]);
	if (!f->depends[k])
		return true;
	rational_solve(count, V, y, c);
	for (int j = 0; j < count; j++) {
		f->exponent[k][j + FIT_DEGREE - most] = mpq_sgn(c[j]) != 0;
		power_of(at[k], j - most, sum[0]);
		mpq_mul(sum[0], sum[0], c[j]);
		mpq_add(sum[1], sum[1], sum[0]);
	}
	return mpq_equal(sum[1], last) != 0;
}

/* Most are of the powers -1, 0 and 1, which fewer points tell. */
static bool find_exponents(struct fit *f, int k)
{
	return try_exponents(f, k, 1) || try_exponents(f, k, FIT_DEGREE);
}

/* f(a, b) - f(a', b) - f(a, b') + f(a', b') is 0 where no product holds both */
static void find_pairs(struct fit *f)
{
	mpq_t *sum = rationals(1);
	for (int i = 0; i < f->params; i++)
		for (int j = 0; j < i; j++) {
			if (!f->depends[i] || !f->depends[j])
				continue;
			mpq_sub(sum[0], value_at(f, near_base(f, i, 0, j, 0)), value_at(f, near_base(f, i, 1, j, 0)));
			mpq_sub(sum[0], sum[0], value_at(f, near_base(f, i, 0, j, 1)));
			mpq_add(sum[0], sum[0], value_at(f, near_base(f, i, 1, j, 1)));
			f->together[i][j] = f->together[j][i] = mpq_sgn(sum[0]) != 0;
		}
}

/* Every product of powers that may occur, from param k on; false: too many */
static bool list_products(struct fit *f, signed char *power, int k)
{
	if (k == f->params) {
		if (f->products == LIMIT_MONOMIALS)
			return false;
		for (int i = 0; i < k; i++)
			f->power[f->products][i] = power[i];
		f->products++;
		return true;
	}
	for (int j = 0; j < EXPONENTS; j++) {
		bool possible = f->depends[k] ? f->exponent[k][j] : j == FIT_DEGREE;
		for (int i = 0; i < k && possible && j != FIT_DEGREE; i++)
			possible = power[i] == 0 || f->together[k][i];
		power[k] = (signed char)(j - FIT_DEGREE);
		if (possible && !list_products(f, power, k + 1))
			return false;
	}
	return true;
}

static void product_at(const struct fit *f, int product, const mpq_t *values, mpq_ptr result)
{
	RATIONAL power = ZERO;
	mpq_set_ui(result, 1, 1);
	for (int k = 0; k < f->params; k++) {
		power_of(values[k], f->power[product][k], power);
		mpq_mul(result, result, power);
	}
}

/* Factors from as many points as there are products; two more points check them. */
static bool fit_products(struct fit *f)
{
	const int count = f->products;
	mpq_t *V = rationals((size_t)(count * count)), *y = rationals(count), *sum = rationals(2);
	f->factor = rationals(count);
	for (int i = 0; i < count; i++) {
		const mpq_t *at = scattered(f, i + 1);
		mpq_set(y[i], value_at(f, at));
		for (int j = 0; j < count; j++)
			product_at(f, j, at, V[i * count + j]);
	}
	if (!rational_solve(count, V, y, f->factor))
		return false;
	for (int i = count + 1; i <= count + 2; i++) {
		const mpq_t *at = scattered(f, i);
		mpq_set_ui(sum[0], 0, 1);
		for (int j = 0; j < count; j++) {
			product_at(f, j, at, sum[1]);
			mpq_mul(sum[1], sum[1], f->factor[j]);
			mpq_add(sum[0], sum[0], sum[1]);
		}
		if (!mpq_equal(sum[0], value_at(f, at)))
			return false;
	}
	return true;
}

bool fit_value(struct fit *f)
{
	signed char power[FIT_PARAMS] = { 0 };
	bool constant = true;
	mpq_srcptr first = value_at(f, scattered(f, 0));
	f->culprit = -1;
	for (int i = 1; i < FIT_POINTS; i++)
		constant = constant && mpq_equal(value_at(f, scattered(f, i)), first);
	for (int k = 0; k < f->params && !constant; k++)
		if (!find_exponents(f, k)) {
			f->culprit = k;
			return false;
		}
	find_pairs(f);
	return list_products(f, power, 0) && fit_products(f);
}
