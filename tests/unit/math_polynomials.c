/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Polynomials and matrices of them: what is multiplied out is divided, factored and inverted back, exactly. */
#include "math_cases.h"

/* ---- polynomials ---- */

struct poly draw_poly(int degree, long most)
{
	struct poly p = poly_new(degree + 1);
	for (int k = 0; k <= degree; k++)
		mpz_set_si(p.c[k], draw(5) ? draw_integer(most) : 0);
	if (degree >= 0 && mpz_sgn(p.c[degree]) == 0)
		mpz_set_ui(p.c[degree], 1 + draw(9));
	return p;
}

struct poly linear_poly(long a, long b)          /* a s + b */
{
	struct poly p = poly_new(2);
	mpz_set_si(p.c[0], b);
	mpz_set_si(p.c[1], a);
	return p;
}

struct poly one_poly(void)
{
	struct poly p = poly_new(1);
	mpz_set_ui(p.c[0], 1);
	return p;
}

const char *text_of(struct poly p)
{
	const char *text = "0";
	for (int k = 0; k < p.length; k++)
		text = format("%s%s%s s^%d", k ? text : "", k ? " + " : "", mpz_get_str(NULL, 10, p.c[k]), k);
	return text;
}

static void assert_poly(const char *what, int n, struct poly found, struct poly expected)
{
	if (!poly_equal(found, expected))
		fail_msg("%s, case %d: found %s, expected %s, exactly", what, n, text_of(found), text_of(expected));
}

static void value_at(struct poly p, mpz_srcptr x, mpz_ptr value)
{
	mpz_t term;
	mpz_init(term);
	mpz_set_ui(value, 0);
	for (int k = 0; k < p.length; k++) {
		mpz_pow_ui(term, x, (unsigned long)k);
		mpz_addmul(value, term, p.c[k]);
	}
	mpz_clear(term);
}

static void assert_value(const char *what, int n, struct poly p, mpz_srcptr x, mpz_srcptr expected)
{
	mpz_t found;
	mpz_init(found);
	value_at(p, x, found);
	if (mpz_cmp(found, expected) != 0)
		fail_msg("%s, case %d, at %s: found %s, expected %s, exactly", what, n, mpz_get_str(NULL, 10, x),
			mpz_get_str(NULL, 10, found), mpz_get_str(NULL, 10, expected));
	mpz_clear(found);
}

void poly_values(void **state)
{
	mpz_t x, u, v, w, shifted;
	mpz_inits(x, u, v, w, shifted, NULL);
	(void)state;
	for (int n = 0; n < CASES; n++) {
		struct poly a = draw_poly((int)draw(9) - 1, 1000), b = draw_poly((int)draw(9) - 1, 1000);
		int shift = (int)draw(4);
		mpz_set_si(x, draw_integer(30));
		value_at(a, x, u);
		value_at(b, x, v);
		mpz_add(w, u, v);
		assert_value("sum", n, poly_add(a, b), x, w);
		mpz_sub(w, u, v);
		assert_value("difference", n, poly_sub(a, b), x, w);
		mpz_mul(w, u, v);
		assert_value("product", n, poly_mul(a, b), x, w);
		mpz_mul(w, u, x);
		assert_value("multiple", n, poly_scale(a, x), x, w);
		mpz_pow_ui(w, x, (unsigned long)shift);
		mpz_mul(w, w, u);
		assert_value("shift", n, poly_shift(a, shift), x, w);
		assert_poly("shift and back", n, poly_shift(poly_shift(a, shift), -shift), a);
		mpz_neg(w, x);
		assert_value("mirror", n, poly_mirror(a), w, u);
		if (a.length > 0)
			assert_int_equal(poly_valuation(poly_shift(a, shift)), poly_valuation(a) + shift);
		assert_int_equal(poly_sub(a, a).length, 0);
		/* a(x + y) = sum of a^(k)(x)/k! y^k */
		mpz_set_si(v, draw_integer(30));
		mpz_set_ui(w, 0);
		for (int k = a.length; k >= 0; k--) {
			value_at(poly_hasse(a, k), x, u);
			mpz_mul(w, w, v);
			mpz_add(w, w, u);
		}
		mpz_add(shifted, x, v);
		assert_value("Taylor's sum", n, a, shifted, w);
		struct poly left = poly_mul(poly_derivative(a), b), right = poly_mul(a, poly_derivative(b));
		assert_poly("derivative of a product", n, poly_derivative(poly_mul(a, b)), poly_add(left, right));
	}
	mpz_clears(x, u, v, w, shifted, NULL);
}

struct poly primitive_of(struct poly p)
{
	mpz_t content;
	mpz_init(content);
	p = poly_primitive(p, content);
	mpz_clear(content);
	return p;
}

void poly_content_times_primitive(void **state)
{
	mpz_t content, common;
	mpz_inits(content, common, NULL);
	(void)state;
	for (int n = 0; n < CASES; n++) {
		struct poly a = draw_poly((int)draw(7), 50);
		mpz_set_si(content, draw_integer(60) * 2 + 1);
		a = poly_scale(a, content);
		struct poly p = poly_primitive(a, content);
		assert_poly("content times primitive part", n, poly_scale(p, content), a);
		mpz_set_ui(common, 0);
		for (int k = 0; k < p.length; k++)
			mpz_gcd(common, common, p.c[k]);
		if (mpz_cmp_ui(common, 1) != 0 || mpz_sgn(p.c[p.length - 1]) < 0)
			fail_msg("case %d: %s has content %s; expected 1, its leading coefficient positive", n,
					text_of(p),
				mpz_get_str(NULL, 10, common));
	}
	mpz_clears(content, common, NULL);
}

void poly_product_divided(void **state)
{
	(void)state;
	for (int n = 0; n < CASES; n++) {
		struct poly a = draw_poly((int)draw(7), 1000), b = primitive_of(draw_poly(1 + (int)draw(6), 1000));
		struct poly ab = poly_mul(a, b), one = one_poly();
		assert_poly("a b / b", n, poly_divide(ab, b), a);
		if (!poly_divides(b, ab))
			fail_msg("case %d: %s does not divide %s, a multiple of it", n, text_of(b), text_of(ab));
		if (poly_divides(b, poly_add(ab, one)))
			fail_msg("case %d: %s divides a multiple of it plus 1", n, text_of(b));
	}
}

enum { FACTORS = 6 };

/* Primitive factors of degree 1 and 2 of which no two have a root in common, none 0: a s + b with different b/a; (c
 * s)^2 + w^2; some are the mirror image of the one before */
static int draw_factors(struct poly *factor, int most)
{
	int count = 0;
	for (int tries = 0; count < most && tries < 40; tries++) {
		struct poly g = linear_poly(1 + (long)draw(9), draw_integer(20));
		if (draw(4) == 0) {
			g = poly_new(3);
			mpz_set_ui(g.c[0], 1 + draw(30));
			mpz_set_si(g.c[1], draw(2) ? 0 : draw_integer(2));      /* b^2 < 4 a c: no real root */
			mpz_set_ui(g.c[2], 4);
			mpz_setbit(g.c[0], 0);
		} else if (count > 0 && draw(3) == 0) {
			g = poly_mirror(factor[count - 1]);
		}
		g = primitive_of(g);
		bool fresh = mpz_sgn(g.c[0]) != 0;
		for (int i = 0; i < count; i++)
			fresh = fresh && !poly_equal(g, factor[i]);
		if (fresh)
			factor[count++] = g;
	}
	return count;
}

static struct poly product_of(int count, const struct poly *factor, const int *power)
{
	struct poly product = one_poly();
	for (int i = 0; i < count; i++)
		for (int k = 0; k < power[i]; k++)
			product = poly_mul(product, factor[i]);
	return product;
}

/* The common part of two products is known: the lesser power of each factor. */
void poly_common_divisor(void **state)
{
	mpz_t content;
	mpz_init(content);
	(void)state;
	for (int n = 0; n < CASES; n++) {
		struct poly factor[FACTORS];
		int count = draw_factors(factor, 1 + (int)draw(FACTORS)), a[FACTORS], b[FACTORS], least[FACTORS];
		for (int i = 0; i < count; i++) {
			a[i] = (int)draw(3);
			b[i] = (int)draw(3);
			least[i] = a[i] < b[i] ? a[i] : b[i];
		}
		mpz_set_si(content, draw_integer(99) * 2 + 1);
		struct poly u = poly_scale(product_of(count, factor, a), content), v = product_of(count, factor, b);
		struct poly g = poly_gcd(u, v);
		assert_poly("greatest common divisor", n, g, product_of(count, factor, least));
		assert_poly("with 0", n, poly_gcd(poly_new(0), u), primitive_of(u));
		assert_poly("with 0", n, poly_gcd(u, poly_new(0)), primitive_of(u));
	}
	mpz_clear(content);
}

/* Where the quick proof of coprimality, which is modulo 2^61 - 1, has nothing to say */
void poly_common_divisor_beyond_the_screen(void **state)
{
	mpz_t prime;
	mpz_init_set_ui(prime, 2305843009213693951u);
	(void)state;
	for (int n = 0; n < 50; n++) {
		struct poly c = linear_poly(3, 1 + (long)draw(50) * 3), d = linear_poly(2, 1), shifted = poly_new(2);
		struct poly f = linear_poly(5, 2);
		mpz_set(shifted.c[0], prime);
		shifted = poly_add(shifted, d);         /* the same as d modulo the prime */
		assert_poly("coprime but for the prime", n, poly_gcd(poly_mul(d, c), shifted), one_poly());
		mpz_set(f.c[1], prime);                 /* modulo the prime a constant */
		assert_poly("leading coefficient 0 modulo the prime", n, poly_gcd(poly_mul(f, c), poly_mul(f, d)), f);
	}
	mpz_clear(prime);
}

static struct poly mirror_image(struct poly g)
{
	return primitive_of(poly_mirror(g));
}

static void check_factor(int n, const struct factor *f)
{
	struct poly g = f->g, one = one_poly();
	if (g.length < 2 || mpz_sgn(g.c[0]) == 0)
		fail_msg("case %d: factor %s; expected no constant and no root 0", n, text_of(g));
	assert_poly("a factor and its derivative", n, poly_gcd(g, poly_derivative(g)), one);
	if (f->symmetric)
		assert_poly("symmetric factor, mirrored", n, mirror_image(g), g);
	else
		assert_poly("a factor that is not symmetric and its mirror image", n, poly_gcd(g, mirror_image(g)),
				one);
}

void poly_square_free_factors(void **state)
{
	(void)state;
	for (int n = 0; n < CASES; n++) {
		struct poly factor[FACTORS];
		int count = draw_factors(factor, 1 + (int)draw(FACTORS)), power[FACTORS];
		for (int i = 0; i < count; i++)
			power[i] = 1 + (int)draw(4);
		struct poly whole = product_of(count, factor, power), back = one_poly();
		struct factor *found;
		int founds = poly_square_free(poly_shift(whole, (int)draw(3)), &found);
		for (int k = 0; k < founds; k++) {
			check_factor(n, &found[k]);
			for (int m = 0; m < found[k].multiplicity; m++)
				back = poly_mul(back, found[k].g);
			for (int i = 0; i < count; i++)
				if (poly_divides(factor[i], found[k].g) && power[i] != found[k].multiplicity)
					fail_msg("case %d: %s of multiplicity %d is found with multiplicity %d", n,
						text_of(factor[i]), power[i], found[k].multiplicity);
		}
		assert_poly("product of square-free factors", n, primitive_of(back), whole);
	}
}

/* ---- matrices of polynomials ---- */

enum { ORDER = 6 };

static struct polymat draw_polymat(int n, uint32_t filled)
{
	struct polymat P = { n, ARRAY(struct poly, (size_t)(n * n)) };
	for (int i = 0; i < n * n; i++)
		P.cell[i] = draw(8) < filled ? draw_poly((int)draw(3), 20) : poly_new(0);
	return P;
}

/* By the first row and what is left without it and one column */
static struct poly expanded_determinant(struct polymat P)
{
	struct poly sum = poly_new(0);
	if (P.n == 0)
		return one_poly();
	struct polymat minor = { P.n - 1, ARRAY(struct poly, (size_t)(P.n * P.n)) };
	for (int j = 0; j < P.n; j++) {
		int at = 0;
		if (P.cell[j].length == 0)
			continue;
		for (int cell = P.n; cell < P.n * P.n; cell++)
			if (cell % P.n != j)
				minor.cell[at++] = P.cell[cell];
		struct poly term = poly_mul(P.cell[j], expanded_determinant(minor));
		sum = j % 2 ? poly_sub(sum, term) : poly_add(sum, term);
	}
	return sum;
}

void polymat_times_adjugate(void **state)
{
	int regular = 0;
	(void)state;
	for (int n = 0; n < CASES; n++) {
		struct polymat P = draw_polymat(1 + (int)draw(5), 3 + draw(6)), adj = { P.n, ARRAY(struct poly, 25) };
		struct poly expected = expanded_determinant(P), det, alone;
		if (expected.length == 0)
			continue;
		regular++;
		polymat_adjugate(P, &det, &adj);
		assert_poly("determinant", n, det, expected);
		polymat_adjugate(P, &alone, NULL);
		assert_poly("determinant alone", n, alone, expected);
		for (int i = 0; i < P.n; i++)
			for (int j = 0; j < P.n; j++) {
				struct poly sum = poly_new(0);
				for (int k = 0; k < P.n; k++)
					sum = poly_add(sum, poly_mul(P.cell[i * P.n + k], adj.cell[k * P.n + j]));
				assert_poly("P adj P", n, sum, i == j ? det : poly_new(0));
			}
	}
	assert_true(regular > CASES / 2);
}

/* Two to three blocks, some alike, with rows and columns exchanged */
void polymat_blocks(void **state)
{
	int regular = 0;
	(void)state;
	for (int n = 0; n < CASES; n++) {
		int order = 0, row[ORDER], column[ORDER];
		struct polymat P = { ORDER, ARRAY(struct poly, ORDER * ORDER) }, block = draw_polymat(2, 7);
		for (int i = 0; i < ORDER; i++)
			row[i] = column[i] = i;
		for (int i = ORDER - 1; i > 0; i--) {
			int other[2] = { (int)draw((uint32_t)i + 1), (int)draw((uint32_t)i + 1) },
					kept[2] = { row[i], column[i] };
			row[i] = row[other[0]];
			row[other[0]] = kept[0];
			column[i] = column[other[1]];
			column[other[1]] = kept[1];
		}
		while (order < ORDER) {
			if (draw(2))
				block = draw_polymat(1 + (int)draw(ORDER - (uint32_t)order > 3 ? 3
						: ORDER - (uint32_t)order), 7);
			if (order + block.n > ORDER)
				continue;
			for (int cell = 0; cell < block.n * block.n; cell++) {
				int i = row[order + cell / block.n], j = column[order + cell % block.n];
				P.cell[i * ORDER + j] = block.cell[cell];
			}
			order += block.n;
		}
		struct poly expected = expanded_determinant(P), det;
		if (expected.length == 0)
			continue;
		regular++;
		polymat_adjugate(P, &det, NULL);
		assert_poly("determinant of blocks", n, det, expected);
	}
	assert_true(regular > CASES / 2);
}
