/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Enclosures and residues: values that MPFR has from closed forms lie within, and nothing is wider than needed. */
#include "math_cases.h"

/* ---- enclosures ---- */

void assert_interval(const char *what, int n, mpfi_srcptr found, mpfr_srcptr truth)
{
	mpfr_t slack, low, high;                /* the truth is off by some 2^-TRUE_BITS of its terms */
	mpfr_inits2(TRUE_BITS, slack, low, high, NULL);
	mpfr_set_ui_2exp(slack, 1, -TRUE_BITS / 2, MPFR_RNDN);
	mpfr_sub(low, &found->left, slack, MPFR_RNDD);
	mpfr_add(high, &found->right, slack, MPFR_RNDU);
	if (!(mpfr_cmp(low, truth) <= 0 && mpfr_cmp(high, truth) >= 0) || mpfr_nan_p(low) || mpfr_nan_p(high))
		fail_msg("%s, case %d: the truth %.17g is not in [%.17g, %.17g]", what, n, mpfr_get_d(truth, MPFR_RNDN),
			mpfr_get_d(&found->left, MPFR_RNDD), mpfr_get_d(&found->right, MPFR_RNDU));
	mpfr_clears(slack, low, high, NULL);
}

/* Its width, below 2^bits */
void assert_narrow(const char *what, int n, mpfi_srcptr found, long bits)
{
	mpfr_t width, most;
	mpfr_inits2(64, width, most, NULL);
	mpfi_diam_abs(width, found);
	mpfr_set_ui_2exp(most, 1, bits, MPFR_RNDN);
	if (!mpfr_lessequal_p(width, most))
		fail_msg("%s, case %d: [%.17g, %.17g] is %.3g wide; expected at most 2^%ld", what, n,
				 mpfr_get_d(&found->left, MPFR_RNDD), mpfr_get_d(&found->right, MPFR_RNDU),
				 mpfr_get_d(width, MPFR_RNDU), bits);
	mpfr_clears(width, most, NULL);
}

/* What all rows annihilate, and as many of them as there are: rank and nullity add up. */
void echelon_against_its_rows(void **state)
{
	mpq_t sum, product;
	mpq_inits(sum, product, NULL);
	(void)state;
	for (int n = 0; n < CASES; n++) {
		const int width = 1 + (int)draw(6), rows = (int)draw(8);
		struct echelon e = echelon_new(width);
		mpq_t *A = draw_matrix(8, width), **basis;
		for (int i = 1; i < rows; i++)          /* some are sums of those before them */
			for (int j = 0; j < width && draw(3) == 0; j++)
				mpq_set(A[i * width + j], A[(i - 1) * width + j]);
		for (int i = 0; i < rows; i++) {
			mpq_t *row = rationals((size_t)width);
			for (int j = 0; j < width; j++)
				mpq_set(row[j], A[i * width + j]);
			echelon_add(&e, row);
		}
		const int count = echelon_null_space(&e, &basis);
		if (count + e.rank != width)
			fail_msg("case %d: nullity %d and rank %d of width %d", n, count, e.rank, width);
		for (int i = 0; i < rows; i++)
			for (int k = 0; k < count; k++) {
				mpq_set_ui(sum, 0, 1);
				for (int j = 0; j < width; j++) {
					mpq_mul(product, A[i * width + j], basis[k][j]);
					mpq_add(sum, sum, product);
				}
				if (mpq_sgn(sum) != 0)
					fail_msg("case %d: row %d times vector %d is %g, not 0", n, i, k,
							mpq_get_d(sum));
			}
		for (int k = 0; k < count; k++) {       /* independent: each has a 1 where the others have 0 */
			int own = 0;
			for (int j = 0; j < width; j++) {
				bool only = mpq_cmp_ui(basis[k][j], 1, 1) == 0;
				for (int other = 0; other < count; other++)
					only = only && (other == k || mpq_sgn(basis[other][j]) == 0);
				own += only;
			}
			if (own == 0)
				fail_msg("case %d: vector %d may depend on the others", n, k);
		}
	}
	mpq_clears(sum, product, NULL);
}

/* P = A with its last row a sum of the others, complex: P v encloses 0, narrowly, and v is not 0. */
void null_rectangles_of_sums(void **state)
{
	mpq_t re;
	mpq_init(re);
	(void)state;
	for (int n = 0; n < CASES / 4; n++) {
		const int order = 2 + (int)draw(4), cells = order * order, bits = 200;
		struct rectangle *P = rectangles(cells, bits), *kept = rectangles(cells, bits), sum;
		struct rectangle *v = rectangles(order, bits);
		for (int i = 0; i < cells - order; i++) {
			draw_fraction(re, 9, 5);
			mpfi_set_q(P[i].re, re);
			draw_fraction(re, 9, 5);
			mpfi_set_q(P[i].im, re);
		}
		for (int i = 0; i < cells - order; i++) {
			struct rectangle *last = &P[cells - order + i % order];
			mpfi_add(last->re, last->re, P[i].re);
			mpfi_add(last->im, last->im, P[i].im);
		}
		for (int i = 0; i < cells; i++)
			rectangle_set(&kept[i], &P[i]);
		if (!null_rectangles(order, P, v))
			fail_msg("case %d: no null vector of a matrix of rank %d with %d bits", n, order - 1, bits);
		scale_rectangles(order, v);
		rectangle_init(&sum, bits);
		for (int i = 0; i < order; i++) {
			mpfi_set_ui(sum.re, 0);
			mpfi_set_ui(sum.im, 0);
			for (int j = 0; j < order; j++)
				rectangle_add_product(&sum, &kept[i * order + j], &v[j]);
			if (!mpfi_has_zero(sum.re) || !mpfi_has_zero(sum.im) || rectangle_size(&sum) > -100)
				fail_msg("case %d: row %d of P v has size 2^%ld, and may not be 0", n, i,
						rectangle_size(&sum));
		}
		rectangle_clear(&sum);
		clear_rectangles(&P);
		clear_rectangles(&kept);
		clear_rectangles(&v);
	}
	mpq_clear(re);
}

/* e^{(a + i b) tau} against MPFR, and times e^{-(a + i b) tau} against 1 */
void rectangle_exponential(void **state)
{
	mpq_t a, b, tau;
	mpfr_t size, re, im, one, zero;
	mpq_inits(a, b, tau, NULL);
	mpfr_inits2(TRUE_BITS, size, re, im, one, zero, NULL);
	mpfr_set_ui(one, 1, MPFR_RNDN);
	mpfr_set_zero(zero, 1);
	(void)state;
	for (int n = 0; n < CASES; n++) {
		struct rectangle p, minus, z, back;
		int bits = 24 + (int)draw(200);
		rectangle_init(&p, bits);
		rectangle_init(&minus, bits);
		rectangle_init(&z, bits);
		rectangle_init(&back, bits);
		draw_fraction(a, 20, 7);
		draw_fraction(b, 60, 7);
		draw_fraction(tau, 8, 9);
		mpfi_set_q(p.re, a);
		mpfi_set_q(p.im, b);
		rectangle_exp(&z, &p, tau);
		mpq_mul(a, a, tau);
		mpq_mul(b, b, tau);
		mpfr_set_q(size, a, MPFR_RNDN);
		mpfr_exp(size, size, MPFR_RNDN);
		mpfr_set_q(re, b, MPFR_RNDN);
		mpfr_sin_cos(im, re, re, MPFR_RNDN);
		mpfr_mul(re, re, size, MPFR_RNDN);
		mpfr_mul(im, im, size, MPFR_RNDN);
		assert_interval("real part", n, z.re, re);
		assert_interval("imaginary part", n, z.im, im);
		long wide = mpfr_get_exp(size) + 12 - bits;     /* |p tau| is below 2^9 */
		assert_narrow("real part", n, z.re, wide);
		assert_narrow("imaginary part", n, z.im, wide);
		rectangle_sub(&minus, &minus, &p);
		rectangle_exp(&back, &minus, tau);
		rectangle_mul(&z, &z, &back);
		assert_interval("e^p e^-p", n, z.re, one);
		assert_interval("e^p e^-p", n, z.im, zero);
		rectangle_clear(&p);
		rectangle_clear(&minus);
		rectangle_clear(&z);
		rectangle_clear(&back);
	}
	mpq_clears(a, b, tau, NULL);
	mpfr_clears(size, re, im, one, zero, NULL);
}

/* c <- c (s - p), of `degree` before */
static void times_root(struct rectangle *c, int degree, const struct rectangle *p)
{
	struct rectangle term;
	rectangle_init(&term, (int)mpfi_get_prec(p->re));
	rectangle_set(&c[degree + 1], &c[degree]);
	for (int k = degree; k >= 0; k--) {
		rectangle_mul(&term, &c[k], p);
		if (k > 0)
			rectangle_sub(&c[k], &c[k - 1], &term);
		else
			rectangle_sub(&c[0], &c[degree + 2], &term);    /* 0 */
	}
	rectangle_clear(&term);
}

/* Roots that nobody knows, multiplied back with their multiplicities: the polynomial is in the enclosure. */
void roots_multiplied_back(void **state)
{
	enum { MOST = 40, PRECISION = 256 };
	mpfr_t truth, zero;
	mpfr_inits2(TRUE_BITS, truth, zero, NULL);
	mpfr_set_zero(zero, 1);
	(void)state;
	for (int n = 0; n < 100; n++) {
		struct rectangle c[MOST], conjugate;
		struct poly D = draw_poly(1 + (int)draw(6), 100);
		if (draw(3) == 0)
			D = poly_mul(D, poly_mul(D, draw_poly((int)draw(4), 20)));
		D = poly_shift(primitive_of(D), (int)draw(3));
		struct spectrum *s = spectrum_of(D);
		int degree = s->zero;
		assert_true(spectrum_refine(s, PRECISION));
		for (int k = 0; k < MOST; k++)
			rectangle_init(&c[k], 2 * PRECISION);
		rectangle_init(&conjugate, 2 * PRECISION);
		mpfi_set_z(c[degree].re, D.c[D.length - 1]);
		for (int f = 0; f < s->factors; f++)
			for (int i = 0; i < s->poles[f] * s->factor[f].multiplicity; i++) {
				const struct pole *p = &s->pole[f][i % s->poles[f]];
				times_root(c, degree++, &p->at);
				if (p->real)
					continue;
				rectangle_set(&conjugate, &p->at);
				mpfi_neg(conjugate.im, conjugate.im);
				times_root(c, degree++, &conjugate);
			}
		if (degree != D.length - 1)
			fail_msg("case %d: %d roots of %s; expected %d", n, degree, text_of(D), D.length - 1);
		for (int k = 0; k <= degree; k++) {
			mpfr_set_z(truth, D.c[k], MPFR_RNDN);
			assert_interval("roots multiplied back", n, c[k].re, truth);
			assert_interval("roots multiplied back, imaginary part", n, c[k].im, zero);
			assert_narrow("roots multiplied back", n, c[k].re, -PRECISION / 2);
		}
		for (int k = 0; k < MOST; k++)
			rectangle_clear(&c[k]);
		rectangle_clear(&conjugate);
	}
	mpfr_clears(truth, zero, NULL);
}

/* ---- residues ---- */

/* e^{a t} ((cosine + linear t) cos(w t) + sine sin(w t)), the terms of 1/((s - a)^2 + w^2)^2 and s/(...)^2 */
void add_wave(mpfr_ptr sum, mpq_srcptr a, mpq_srcptr w, mpq_srcptr t, mpq_srcptr factor, int power, bool sine)
{
	mpfr_t x, angle;
	mpfr_inits2(TRUE_BITS, x, angle, NULL);
	mpfr_set_q(x, a, MPFR_RNDN);
	mpfr_mul_q(x, x, t, MPFR_RNDN);
	mpfr_exp(x, x, MPFR_RNDN);
	mpfr_set_q(angle, w, MPFR_RNDN);
	mpfr_mul_q(angle, angle, t, MPFR_RNDN);
	(sine ? mpfr_sin : mpfr_cos)(angle, angle, MPFR_RNDN);
	mpfr_mul(x, x, angle, MPFR_RNDN);
	mpfr_mul_q(x, x, factor, MPFR_RNDN);
	for (int k = 0; k < power; k++)
		mpfr_mul_q(x, x, t, MPFR_RNDN);
	mpfr_add(sum, sum, x, MPFR_RNDN);
	mpfr_clears(x, angle, NULL);
}

/* Poles of multiplicity 2 off the real axis, by the tables: with S = s - a,
 * 1/(S^2 + w^2)^2 is e^{a t} (sin(w t) - w t cos(w t))/(2 w^3), S/(S^2 + w^2)^2 is e^{a t} t sin(w t)/(2 w). */
void residues_of_double_pairs(void **state)
{
	mpq_t a, w, t, scale, factor, exact;
	mpfr_t truth;
	mpfi_t value;
	mpq_inits(a, w, t, scale, factor, exact, NULL);
	mpfr_init2(truth, TRUE_BITS);
	(void)state;
	for (int n = 0; n < 100; n++) {
		bool linear = draw(2);
		long whole = draw_integer(9), turns = 1 + (long)draw(20);
		struct poly g = poly_new(3), N = linear ? linear_poly(1, -whole) : one_poly();
		mpz_set_si(g.c[0], whole * whole + turns * turns);
		mpz_set_si(g.c[1], -2 * whole);
		mpz_set_ui(g.c[2], 1);
		mpq_set_si(a, whole, 1);
		mpq_set_si(w, turns, 1);
		draw_fraction(scale, 50, 9);
		mpq_set_ui(t, 1 + draw(20), 1 + draw(20));
		mpq_canonicalize(t);
		mpfr_set_zero(truth, 1);
		mpq_set_si(factor, 1, linear ? (unsigned long)(2 * turns) : (unsigned long)(2 * turns * turns * turns));
		mpq_mul(factor, factor, scale);
		add_wave(truth, a, w, t, factor, linear, true);
		mpq_mul(factor, factor, w);
		mpq_neg(factor, factor);
		if (!linear)
			add_wave(truth, a, w, t, factor, 1, false);
		struct response *response = response_of(scale, N, poly_mul(g, g));
		if (response_exact(response, t, exact)) {
			assert_int_equal(mpq_sgn(scale), 0);
			continue;
		}
		int precision = 20 + (int)draw(150);
		mpfi_init2(value, 64 + precision);
		assert_true(response_enclose(response, t, precision, value));
		assert_interval("double pair", n, value, truth);
		mpfi_clear(value);
	}
	mpq_clears(a, w, t, scale, factor, exact, NULL);
	mpfr_clear(truth);
}

/* c/((s - a)(s - b)) is c (e^{a t} - e^{b t})/(a - b) */
void residues_of_real_poles(void **state)
{
	mpq_t a, b, t, scale, factor, none;
	mpfr_t truth;
	mpfi_t value;
	(void)state;
	mpq_inits(a, b, t, scale, factor, none, NULL);
	mpfr_init2(truth, TRUE_BITS);
	for (int n = 0; n < 60; n++) {
		long first = draw_integer(9), second = first + 1 + (long)draw(9);
		mpq_set_si(a, first, 1);
		mpq_set_si(b, second, 1);
		draw_fraction(scale, 50, 9);
		mpq_set_ui(t, 1 + draw(20), 1 + draw(20));
		mpq_canonicalize(t);
		mpfr_set_zero(truth, 1);
		mpq_sub(factor, a, b);
		mpq_div(factor, scale, factor);
		add_wave(truth, a, none, t, factor, 0, false);
		mpq_neg(factor, factor);
		add_wave(truth, b, none, t, factor, 0, false);
		struct poly D = poly_mul(linear_poly(1, -first), linear_poly(1, -second));
		int precision = 20 + (int)draw(150);
		mpfi_init2(value, 64 + precision);
		assert_true(response_enclose(response_of(scale, one_poly(), D), t, precision, value));
		assert_interval("real poles", n, value, truth);
		mpfi_clear(value);
	}
	mpq_clears(a, b, t, scale, factor, none, NULL);
	mpfr_clear(truth);
}

/* sin(r t)/r with r^2 = 2, of one response that is asked again and again: at other times, with more bits or fewer. What
 * was found for one question is not good enough, or wrong, for the next. */
void a_response_asked_anew(void **state)
{
	mpq_t t, one;
	mpfr_t root, truth;
	mpfi_t value;
	(void)state;
	mpq_inits(t, one, NULL);
	mpfr_inits2(TRUE_BITS, root, truth, NULL);
	mpq_set_ui(one, 1, 1);
	mpfr_sqrt_ui(root, 2, MPFR_RNDN);
	struct poly D = poly_new(3);
	mpz_set_ui(D.c[0], 2);
	mpz_set_ui(D.c[2], 1);
	struct response *response = response_of(one, one_poly(), D);
	for (int n = 0; n < 60; n++) {
		int precision = 20 + (int)draw(200);
		mpq_set_ui(t, 1 + draw(20), 1 + draw(20));
		mpq_canonicalize(t);
		mpfr_mul_q(truth, root, t, MPFR_RNDN);
		mpfr_sin(truth, truth, MPFR_RNDN);
		mpfr_div(truth, truth, root, MPFR_RNDN);
		mpfi_init2(value, 64 + precision);
		assert_true(response_enclose(response, t, precision, value));
		assert_interval("asked anew", n, value, truth);
		assert_narrow("asked anew", n, value, 16 - precision);  /* the phase r t is below 2^5 */
		mpfi_clear(value);
	}
	mpq_clears(t, one, NULL);
	mpfr_clears(root, truth, NULL);
}

/* c/s^m is c t^{m-1}/(m-1)!, which is a rational number */
void residues_of_powers_of_time(void **state)
{
	mpq_t scale, t, truth, found;
	(void)state;
	mpq_inits(scale, t, truth, found, NULL);
	for (int n = 0; n < 60; n++) {
		int m = 1 + (int)draw(6);
		draw_fraction(scale, 50, 9);
		mpq_set_ui(t, 1 + draw(20), 1 + draw(20));
		mpq_canonicalize(t);
		mpq_set(truth, scale);
		for (int k = 1; k < m; k++) {
			mpq_set_ui(found, 1, (unsigned long)k);
			mpq_mul(truth, truth, found);
			mpq_mul(truth, truth, t);
		}
		struct response *response = response_of(scale, one_poly(), poly_shift(one_poly(), m));
		assert_true(response_exact(response, t, found));
		if (!mpq_equal(found, truth))
			fail_msg("case %d: s^-%d at %g: %.17g, expected %.17g", n, m, mpq_get_d(t), mpq_get_d(found),
					 mpq_get_d(truth));
	}
	mpq_clears(scale, t, truth, found, NULL);
}

/* At equal distances, two of one denominator in turn, each from its own start: e^{a t} sin(w t) */
void responses_along_a_course(void **state)
{
	enum { ROWS = 90 };
	mpq_t a, w, t, scale, shift, one;
	mpfr_t truth;
	mpfi_t value;
	(void)state;
	mpq_inits(a, w, t, scale, shift, one, NULL);
	mpfr_init2(truth, TRUE_BITS);
	mpq_set_ui(shift, 1, 3);
	mpq_set_ui(one, 1, 1);
	for (int n = 0; n < 8; n++) {
		long i = (long)draw(20), j = 1 + (long)draw(40), rows = 1 + (long)draw(20);
		struct poly D = poly_new(3);            /* 64 ((s + i/8)^2 + (j/4)^2) */
		mpz_set_si(D.c[0], i * i + 4 * j * j);
		mpz_set_si(D.c[1], 16 * i);
		mpz_set_si(D.c[2], 64);
		mpq_set_si(a, -i, 8);
		mpq_set_si(w, j, 4);
		mpq_set_si(scale, 16 * j, 1);
		mpq_canonicalize(a);
		mpq_canonicalize(w);
		struct response *response[] = { response_of(scale, one_poly(), D), response_of(scale, one_poly(), D) };
		for (int k = 0; k < ROWS; k++)
			for (int r = 0; r < 2; r++) {
				mpq_set_si(t, k + (k > ROWS / 2 ? 1 : 0),
						(unsigned long)rows);         /* one stride is longer */
				mpq_canonicalize(t);
				if (r)
					mpq_add(t, t, shift);
				mpfr_set_zero(truth, 1);
				add_wave(truth, a, w, t, one, 0, true);
				mpfi_init2(value, 200);
				assert_true(response_enclose(response[r], t, 128, value));
				assert_interval("along a course", n, value, truth);
				assert_narrow("along a course", n, value, -90);
				mpfi_clear(value);
			}
	}
	mpq_clears(a, w, t, scale, shift, one, NULL);
	mpfr_clear(truth);
}
