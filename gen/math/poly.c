/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Polynomials over Z, constant term first. Values: an operation returns a new polynomial. */
#include "math/math.h"

struct poly poly_new(int length)
{
	struct poly p = { length, ARRAY(mpz_t, length) };
	for (int i = 0; i < length; i++)
		mpz_init(p.c[i]);
	return p;
}

void poly_trim(struct poly *p)
{
	while (p->length > 0 && mpz_sgn(p->c[p->length - 1]) == 0)
		p->length--;
}

static struct poly combine(struct poly a, struct poly b, bool subtract)
{
	struct poly sum = poly_new(a.length > b.length ? a.length : b.length);
	for (int i = 0; i < a.length; i++)
		mpz_set(sum.c[i], a.c[i]);
	for (int i = 0; i < b.length; i++)
		(subtract ? mpz_sub : mpz_add)(sum.c[i], sum.c[i], b.c[i]);
	poly_trim(&sum);
	return sum;
}

struct poly poly_add(struct poly a, struct poly b)
{
	return combine(a, b, false);
}

struct poly poly_sub(struct poly a, struct poly b)
{
	return combine(a, b, true);
}

struct poly poly_mul(struct poly a, struct poly b)
{
	if (a.length == 0 || b.length == 0)
		return poly_new(0);
	struct poly product = poly_new(a.length + b.length - 1);
	for (int i = 0; i < a.length; i++)
		for (int j = 0; j < b.length; j++)
			mpz_addmul(product.c[i + j], a.c[i], b.c[j]);
	return product;
}

struct poly poly_product(int count, const struct poly *factor)
{
	struct poly product = poly_new(1);
	mpz_set_ui(product.c[0], 1);
	for (int k = 0; k < count; k++)
		product = poly_mul(product, factor[k]);
	return product;
}

struct poly poly_scale(struct poly a, mpz_srcptr factor)
{
	struct poly scaled = poly_new(a.length);
	for (int i = 0; i < a.length; i++)
		mpz_mul(scaled.c[i], a.c[i], factor);
	poly_trim(&scaled);
	return scaled;
}

/* a * s^powers; a negative power divides exactly */
struct poly poly_shift(struct poly a, int powers)
{
	if (a.length == 0)
		return a;
	struct poly shifted = poly_new(a.length + powers);
	for (int i = 0; i < shifted.length; i++)
		if (i - powers >= 0)
			mpz_set(shifted.c[i], a.c[i - powers]);
	return shifted;
}

struct poly poly_derivative(struct poly a)
{
	return poly_hasse(a, 1);
}

/* a^(k)/k!, the k-th Taylor coefficient as a polynomial in the point */
struct poly poly_hasse(struct poly a, int k)
{
	if (a.length <= k)
		return poly_new(0);
	struct poly taylor = poly_new(a.length - k);
	INTEGER binomial = INTEGER_ZERO;
	for (int i = k; i < a.length; i++) {
		mpz_bin_uiui(binomial, (unsigned long)i, (unsigned long)k);
		mpz_mul(taylor.c[i - k], a.c[i], binomial);
	}
	return taylor;
}

/* a(-s) */
struct poly poly_mirror(struct poly a)
{
	struct poly mirror = poly_new(a.length);
	for (int i = 0; i < a.length; i++)
		(i % 2 ? mpz_neg : mpz_set)(mirror.c[i], a.c[i]);
	return mirror;
}

/* a = content * result; the leading coefficient of the result is positive */
struct poly poly_primitive(struct poly a, mpz_ptr content)
{
	mpz_set_ui(content, 0);
	for (int i = 0; i < a.length; i++)
		mpz_gcd(content, content, a.c[i]);
	if (a.length > 0 && mpz_sgn(a.c[a.length - 1]) < 0)
		mpz_neg(content, content);
	struct poly primitive = poly_new(a.length);
	for (int i = 0; i < a.length; i++)
		mpz_divexact(primitive.c[i], a.c[i], content);
	return primitive;
}

static struct poly primitive_part(struct poly a)
{
	INTEGER content = INTEGER_ZERO;
	return poly_primitive(a, content);
}

int poly_valuation(struct poly a)
{
	int k = 0;
	while (k < a.length && mpz_sgn(a.c[k]) == 0)
		k++;
	return k;
}

bool poly_equal(struct poly a, struct poly b)
{
	if (a.length != b.length)
		return false;
	for (int i = 0; i < a.length; i++)
		if (mpz_cmp(a.c[i], b.c[i]) != 0)
			return false;
	return true;
}

/* Pseudo-remainder of a by b (Knuth, algorithm R): lead(b)^(deg a - deg b + 1) a = q b + r */
static struct poly pseudo_remainder(struct poly a, struct poly b)
{
	struct poly r = poly_add(a, poly_new(0));
	mpz_srcptr lead = b.c[b.length - 1];
	INTEGER top = INTEGER_ZERO;
	while (r.length >= b.length) {
		int shift = r.length - b.length;
		mpz_set(top, r.c[r.length - 1]);
		for (int i = 0; i < r.length; i++)
			mpz_mul(r.c[i], r.c[i], lead);
		for (int i = 0; i < b.length; i++)
			mpz_submul(r.c[i + shift], top, b.c[i]);
		poly_trim(&r);
	}
	return r;
}

/* b primitive and a divisor of a: the quotient is integral (Gauss) */
struct poly poly_divide(struct poly a, struct poly b)
{
	if (a.length < b.length)
		return poly_new(0);
	struct poly r = poly_add(a, poly_new(0)), q = poly_new(a.length - b.length + 1);
	for (int k = q.length - 1; k >= 0; k--) {
		mpz_divexact(q.c[k], r.c[k + b.length - 1], b.c[b.length - 1]);
		for (int i = 0; i < b.length; i++)
			mpz_submul(r.c[k + i], q.c[k], b.c[i]);
	}
	clear_integers(&r.c);
	poly_trim(&q);
	return q;
}

bool poly_divides(struct poly d, struct poly a)
{
	if (a.length == 0 || d.length > a.length)
		return a.length == 0;
	struct poly r = pseudo_remainder(a, d);
	clear_integers(&r.c);
	return r.length == 0;
}

/* ---- a quick proof that two polynomials are coprime: so they are modulo a prime that keeps their degrees ---- */

#define SCREEN_PRIME 2305843009213693951u       /* 2^61 - 1 */

static uint64_t mul_mod(uint64_t a, uint64_t b)
{
	return (uint64_t)((unsigned __int128)a * b % SCREEN_PRIME);
}

static uint64_t inverse_mod(uint64_t a)
{
	uint64_t result = 1, power = a;
	for (uint64_t e = SCREEN_PRIME - 2; e; e >>= 1, power = mul_mod(power, power))
		if (e & 1)
			result = mul_mod(result, power);
	return result;
}

static uint64_t *reduce(struct poly a)
{
	uint64_t *r = ARRAY(uint64_t, a.length);
	for (int i = 0; i < a.length; i++) {
		if (mpz_sgn(a.c[i]) != 0)
			r[i] = mpn_mod_1(mpz_limbs_read(a.c[i]), (mp_size_t)mpz_size(a.c[i]), SCREEN_PRIME);
		if (mpz_sgn(a.c[i]) < 0 && r[i] > 0)
			r[i] = SCREEN_PRIME - r[i];
	}
	return r;
}

static bool screened_coprime(struct poly a, struct poly b)
{
	uint64_t *u = reduce(a), *v = reduce(b);
	int m = a.length, n = b.length;
	if (u[m - 1] == 0 || v[n - 1] == 0)
		return false;
	while (n > 1) {
		uint64_t inverse = inverse_mod(v[n - 1]);
		while (m >= n) {
			uint64_t factor = mul_mod(u[m - 1], inverse);
			for (int i = 0; i < n; i++)
				u[m - n + i] = (u[m - n + i] + SCREEN_PRIME - mul_mod(factor, v[i])) % SCREEN_PRIME;
			while (m > 0 && u[m - 1] == 0)
				m--;
		}
		uint64_t *swap = u;
		u = v;
		v = swap;
		int length = m;
		m = n;
		n = length;
	}
	return n == 1;
}

struct poly poly_gcd(struct poly a, struct poly b)
{
	if (a.length == 0)
		return primitive_part(b);
	if (b.length == 0)
		return primitive_part(a);
	if (screened_coprime(a, b)) {
		struct poly one = poly_new(1);
		mpz_set_ui(one.c[0], 1);
		return one;
	}
	a = primitive_part(a);
	b = primitive_part(b);
	while (b.length > 0) {
		if (a.length < b.length) {
			struct poly swap = a;
			a = b;
			b = swap;
		}
		struct poly r = pseudo_remainder(a, b), part = primitive_part(r);
		clear_integers(&r.c);
		clear_integers(&a.c);
		a = b;
		b = part;
	}
	return a;
}

/* ---- square-free factors ---- */

static void add_factor(struct factor **factors, int *count, struct poly g, int multiplicity, bool symmetric)
{
	if (g.length < 2)
		return;
	*MORE(*factors, *count) = (struct factor){ g, multiplicity, symmetric };
}

/* Roots that come with their negatives are set apart: among them, and only there, can roots be purely imaginary. */
static void split_symmetric(struct factor **factors, int *count, struct poly g, int multiplicity)
{
	struct poly both = poly_gcd(g, poly_mirror(g));
	add_factor(factors, count, both, multiplicity, true);
	add_factor(factors, count, poly_divide(g, both), multiplicity, false);
}

/* Yun's algorithm; roots at 0 are left out. */
int poly_square_free(struct poly a, struct factor **factors)
{
	int count = 0;
	*factors = NULL;
	a = primitive_part(poly_shift(a, -poly_valuation(a)));
	struct poly derivative = poly_derivative(a), common = poly_gcd(a, derivative);
	struct poly b = poly_divide(a, common), c = poly_divide(derivative, common),
		    d = poly_sub(c, poly_derivative(b));
	for (int multiplicity = 1; b.length > 1; multiplicity++) {
		struct poly g = poly_gcd(b, d);
		split_symmetric(factors, &count, g, multiplicity);
		b = poly_divide(b, g);
		c = poly_divide(d, g);
		d = poly_sub(c, poly_derivative(b));
	}
	return count;
}
