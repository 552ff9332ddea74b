/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the proofs of gen/math: poles.c, enclosure.c and residues.c promise, where the truth is known by construction:
 * polynomials are products of factors with rational roots, real or complex, so that whether a disc holds a root is
 * decided in rationals. poles.c is part of this file: its discs are looked at when approximations are still poor, as an
 * iteration that has converged hides much. */
#include "../../gen/math/poles.c"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

enum { MOST = 12, CASES = 400 };

static uint64_t seed;

static uint32_t draw(uint32_t below)
{
	seed = seed * 6364136223846793005u + 1442695040888963407u;
	return (uint32_t)((seed >> 33) % below);
}

struct root { mpq_t re, im; };      /* im >= 0; its conjugate is implied where im is not 0 */

static void draw_rational(mpq_ptr q, bool above)
{
	int scale = (int)draw(4) ? (int)draw(9) - 4 : (int)draw(161) - 80;
	mpq_set_si(q, (long)draw(2001) - (above ? -1 : 1000), 1 + draw(300));
	mpq_canonicalize(q);
	if (scale > 0)
		mpq_mul_2exp(q, q, (mp_bitcnt_t)scale);
	else
		mpq_div_2exp(q, q, (mp_bitcnt_t)-scale);
}

static bool same_root(const struct root *a, const struct root *b)
{
	return mpq_equal(a->re, b->re) && mpq_equal(a->im, b->im);
}

/* Different roots, none 0; some next to another one, at 2^-4 to 2^-60 of it, some on the imaginary axis, some pairs p,
 * -p */
static int draw_roots(struct root *root, int most)
{
	int count = 0, degree = 0;
	while (degree < most) {
		struct root *r = &root[count];
		bool pair = degree + 2 <= most && draw(2), fresh = true;
		mpq_inits(r->re, r->im, NULL);
		draw_rational(r->re, false);
		if (pair)
			draw_rational(r->im, true);
		if (pair && draw(4) == 0)
			mpq_set_ui(r->re, 0, 1);
		if (count > 0 && draw(4) == 0) {                /* a cluster */
			mpq_t small;
			mpq_init(small);
			mpq_div_2exp(small, root[count - 1].re, 4 + draw(57));
			mpq_add(r->re, root[count - 1].re, small);
			mpq_set(r->im, root[count - 1].im);
			mpq_clear(small);
		} else if (count > 0 && draw(6) == 0) {
			mpq_neg(r->re, root[count - 1].re);
			mpq_set(r->im, root[count - 1].im);
		}
		int roots = 1 + (mpq_sgn(r->im) != 0);
		for (int i = 0; i < count; i++)
			fresh = fresh && !same_root(r, &root[i]);
		if (!fresh || degree + roots > most || (mpq_sgn(r->re) == 0 && mpq_sgn(r->im) == 0)) {
			if (degree + 1 == most || !fresh)
				degree++;                       /* no endless search: one root less */
			continue;
		}
		count++;
		degree += roots;
	}
	return count;
}

/* s - p, or (s - re)^2 + im^2, with whole coefficients */
static struct poly factor_of_root(const struct root *r)
{
	bool pair = mpq_sgn(r->im) != 0;
	struct poly g = poly_new(pair ? 3 : 2);
	mpq_t c[3];
	mpz_t common;
	mpz_init_set_ui(common, 1);
	for (int k = 0; k < 3; k++)
		mpq_init(c[k]);
	if (pair) {
		mpq_mul(c[0], r->re, r->re);
		mpq_mul(c[1], r->im, r->im);
		mpq_add(c[0], c[0], c[1]);
		mpq_add(c[1], r->re, r->re);
		mpq_neg(c[1], c[1]);
	} else
		mpq_neg(c[0], r->re);
	mpq_set_ui(c[pair ? 2 : 1], 1, 1);
	for (int k = 0; k < g.length; k++)
		mpz_lcm(common, common, mpq_denref(c[k]));
	for (int k = 0; k < g.length; k++) {
		mpz_divexact(g.c[k], common, mpq_denref(c[k]));
		mpz_mul(g.c[k], g.c[k], mpq_numref(c[k]));
	}
	for (int k = 0; k < 3; k++)
		mpq_clear(c[k]);
	mpz_clear(common);
	return g;
}

static struct poly product_of(int count, const struct root *root, const int *multiplicity)
{
	struct poly g = poly_new(1);
	mpz_t content;
	mpz_init(content);
	mpz_set_ui(g.c[0], 1);
	for (int i = 0; i < count; i++)
		for (int k = 0; k < (multiplicity ? multiplicity[i] : 1); k++)
			g = poly_mul(g, factor_of_root(&root[i]));
	g = poly_primitive(g, content);
	mpz_clear(content);
	return g;
}

/* ---- discs around poor approximations ---- */

static bool in_disc(mpc_srcptr z, mpfr_srcptr radius, const struct root *r, bool conjugate)
{
	mpq_t a, b;
	mpq_inits(a, b, NULL);
	mpfr_get_q(a, mpc_realref(z));
	mpq_sub(a, a, r->re);
	mpfr_get_q(b, mpc_imagref(z));
	(conjugate ? mpq_add : mpq_sub)(b, b, r->im);
	mpq_mul(a, a, a);
	mpq_mul(b, b, b);
	mpq_add(a, a, b);
	mpfr_get_q(b, radius);
	mpq_mul(b, b, b);
	bool inside = mpq_cmp(a, b) <= 0;
	mpq_clears(a, b, NULL);
	return inside;
}

/* The roots with an error of about 2^-close of themselves, in any order of halves */
static void approximate(struct iteration *it, int count, const struct root *root, int close)
{
	int at = 0;
	for (int i = 0; i < count; i++)
		for (int half = 0; half < 1 + (mpq_sgn(root[i].im) != 0); half++, at++) {
			mpc_t error;
			mpc_init2(error, it->bits);
			mpc_set_q_q(it->z[at], root[i].re, root[i].im, MPC_RNDNN);
			if (half)
				mpc_conj(it->z[at], it->z[at], MPC_RNDNN);
			mpc_set_si_si(error, (long)draw(2001) - 1000, (long)draw(2001) - 1000, MPC_RNDNN);
			mpc_div_2ui(error, error, 10 + (unsigned)close, MPC_RNDNN);
			mpc_mul(error, error, it->z[at], MPC_RNDNN);
			mpc_add(it->z[at], it->z[at], error, MPC_RNDNN);
			mpc_clear(error);
		}
}

static int roots_in_disc(const struct iteration *it, int disc, int count, const struct root *root)
{
	int inside = 0;
	for (int i = 0; i < count; i++)
		for (int half = 0; half < 1 + (mpq_sgn(root[i].im) != 0); half++)
			inside += in_disc(it->z[disc], it->radius[disc], &root[i], half);
	return inside;
}

static void a_disc_alone_holds_one_root(void **state)
{
	int alone = 0, met = 0;
	(void)state;
	for (int n = 0; n < CASES; n++) {
		struct root root[MOST + 1];
		int count = draw_roots(root, 1 + (int)draw(MOST));
		if (count == 0)
			continue;
		struct poly g = product_of(count, root, NULL);
		struct iteration it = { 0 };
		iteration_new(g, &it);
		iteration_start(g, &it);
		it.bits = 64 + (int)draw(400);
		for (int i = 0; i < it.degree; i++) {
			mpc_set_prec(it.z[i], it.bits);
			mpfr_set_prec(it.radius[i], it.bits);
		}
		approximate(&it, count, root, 2 + (int)draw(70));
		find_discs(g, &it);
		for (int i = 0; i < it.degree; i++) {
			if (!mpfr_number_p(it.radius[i]) || !image_is_alone(&it, i, false, false)) {
				met++;
				continue;
			}
			int inside = roots_in_disc(&it, i, count, root);
			if (inside != 1)
		       fail_msg("case %d, degree %d, %d bits: a disc that meets no other holds %d roots; expected 1", n,
						 it.degree, it.bits, inside);
			alone++;
		}
	}
	print_message("# %d discs alone, %d that meet others\n", alone, met);
	assert_true(alone > CASES);
}

/* ---- poles ---- */

static bool in_interval(mpfi_srcptr x, mpq_srcptr q)
{
	return mpfr_cmp_q(&x->left, q) <= 0 && mpfr_cmp_q(&x->right, q) >= 0;
}

static bool is_narrow(mpfi_srcptr x, const struct root *r, int precision)
{
	mpfr_t width, size, im;
	mpfr_inits2(64, width, size, im, NULL);
	mpfi_diam_abs(width, x);
	mpfr_set_q(size, r->re, MPFR_RNDU);
	mpfr_set_q(im, r->im, MPFR_RNDU);
	mpfr_hypot(size, size, im, MPFR_RNDU);
	mpfr_mul_2si(size, size, 2 - precision, MPFR_RNDU);
	bool narrow = mpfr_lessequal_p(width, size);
	mpfr_clears(width, size, im, NULL);
	return narrow;
}

/* The roots of one factor */
static int roots_of(const struct factor *factor, int count, const struct root *root, const int *multiplicity,
					struct root *own)
{
	int found = 0;
	for (int r = 0; r < count; r++)
		if (poly_divides(factor_of_root(&root[r]), factor->g)) {
			assert_int_equal(multiplicity[r], factor->multiplicity);
			own[found++] = root[r];
		}
	return found;
}

/* Each disc of a factor holds one root of it and no other, each pole the root of its disc; none is missing. (The
 * rectangle around a disc may reach another root.) */
static void check_poles(int n, const struct spectrum *s, int count, const struct root *root, const int *multiplicity,
						int precision)
{
	int poles = 0;
	for (int f = 0; f < s->factors; f++) {
		struct root own[MOST + 1];
		const struct iteration *it = &s->iteration[f];
		int owned = roots_of(&s->factor[f], count, root, multiplicity, own), next = 0;
		for (int i = 0; i < it->degree; i++) {
			int which = -1, held = roots_in_disc(it, i, owned, own);
			if (held != 1)
				fail_msg("case %d, %d bits: a disc holds %d roots of its factor; expected 1", n,
					precision, held);
			for (int r = 0; r < owned; r++)
				if (in_disc(it->z[i], it->radius[i], &own[r], false))
					which = r;
			if (which < 0)
				continue;               /* the conjugate of another */
			const struct pole *p = &s->pole[f][next++];
			if (next > s->poles[f] || !in_interval(p->at.re, own[which].re) ||
				!in_interval(p->at.im, own[which].im))
				fail_msg("case %d, %d bits: root %.17g, %.17g is not in its pole", n, precision,
						 mpq_get_d(own[which].re), mpq_get_d(own[which].im));
			assert_int_equal(p->real, mpq_sgn(own[which].im) == 0);
			assert_int_equal(p->imaginary, mpq_sgn(own[which].re) == 0);
			assert_true(is_narrow(p->at.re, &own[which], precision) &&
				is_narrow(p->at.im, &own[which], precision));
		}
		if (next != s->poles[f] || next != owned)
			fail_msg("case %d, %d bits: %d poles found in a factor of %d", n, precision, s->poles[f],
				owned);
		poles += next;
	}
	if (poles != count)
		fail_msg("case %d, %d bits: %d poles found, expected %d", n, precision, poles, count);
}

/* From their product, or told apart as the blocks of a model are; then two may share a factor */
static struct spectrum *drawn_spectrum(int count, const struct root *root, const int *multiplicity, int zero)
{
	struct poly part[2 * MOST + 2];
	int parts = 0;
	if (draw(2))
		return spectrum_of(poly_shift(product_of(count, root, multiplicity), zero));
	for (int i = 0; i < count; i++) {
		int first = multiplicity[i] > 1 ? (int)draw((uint32_t)multiplicity[i]) : 0,
			rest = multiplicity[i] - first;
		part[parts++] = product_of(1, &root[i], &rest);
		if (first)
			part[parts++] = product_of(1, &root[i], &first);
	}
	part[0] = poly_shift(part[0], zero);
	if (parts > 2 && draw(2)) {
		part[parts - 2] = poly_mul(part[parts - 2], part[parts - 1]);
		parts--;
	}
	return spectrum_of_product(parts, part);
}

static void every_pole_holds_its_root(void **state)
{
	(void)state;
	for (int n = 0; n < CASES / 2; n++) {
		struct root root[MOST + 1];
		int multiplicity[MOST + 1], zero = (int)draw(3), precision = 0;
		int count = draw_roots(root, 1 + (int)draw(MOST));
		for (int i = 0; i < count; i++)
			multiplicity[i] = draw(3) ? 1 : 1 + (int)draw(3);
		struct spectrum *s = drawn_spectrum(count, root, multiplicity, zero);
		assert_int_equal(s->zero, zero);
		for (int k = 0; k < 3; k++) {
			precision += 1 + (int)draw(150);
			assert_true(spectrum_refine(s, precision));
			check_poles(n, s, count, root, multiplicity, precision);
		}
	}
}

/* ---- enclosures ---- */

/* A rectangle of this precision around a point, of random widths: 0 to a quarter of its size */
static void around(struct rectangle *z, const struct root *at)
{
	mpq_t side;
	mpq_init(side);
	for (int part = 0; part < 2; part++) {
		mpfi_ptr x = part ? z->im : z->re;
		mpq_srcptr q = part ? at->im : at->re;
		mpfi_set_q(x, q);
		mpq_abs(side, q);
		mpq_div_2exp(side, side, 2 + draw(60));
		if (draw(3) == 0)
			continue;
		mpq_sub(side, q, side);
		mpfr_set_q(&x->left, side, MPFR_RNDD);
		mpq_sub(side, q, side);
		mpq_add(side, side, q);
		if (draw(2))
			mpfr_set_q(&x->right, side, MPFR_RNDU);
	}
	mpq_clear(side);
}

static void assert_holds(const char *what, const struct rectangle *z, mpq_srcptr re, mpq_srcptr im)
{
	if (!in_interval(z->re, re) || !in_interval(z->im, im))
		fail_msg("%s: the truth %.17g, %.17g is not in [%.17g, %.17g], [%.17g, %.17g]", what, mpq_get_d(re),
				 mpq_get_d(im), mpfr_get_d(&z->re->left, MPFR_RNDD),
					mpfr_get_d(&z->re->right, MPFR_RNDU),
				 mpfr_get_d(&z->im->left, MPFR_RNDD), mpfr_get_d(&z->im->right, MPFR_RNDU));
}

static void complex_product(mpq_ptr re, mpq_ptr im, const struct root *a, const struct root *b)
{
	mpq_t x, y;
	mpq_inits(x, y, NULL);
	mpq_mul(x, a->re, b->re);
	mpq_mul(y, a->im, b->im);
	mpq_sub(x, x, y);
	mpq_mul(y, a->re, b->im);
	mpq_mul(im, a->im, b->re);
	mpq_add(im, im, y);
	mpq_set(re, x);
	mpq_clears(x, y, NULL);
}

static void every_rectangle_holds_its_truth(void **state)
{
	struct root a, b, c;
	mpq_inits(a.re, a.im, b.re, b.im, c.re, c.im, NULL);
	(void)state;
	for (int n = 0; n < 5 * CASES; n++) {
		struct rectangle x, y, z;
		int bits = 2 + (int)draw(200);
		rectangle_init(&x, bits);
		rectangle_init(&y, bits);
		rectangle_init(&z, bits);
		draw_rational(a.re, false);
		draw_rational(a.im, false);
		draw_rational(b.re, true);
		draw_rational(b.im, false);
		around(&x, &a);
		around(&y, &b);
		rectangle_sub(&z, &x, &y);
		mpq_sub(c.re, a.re, b.re);
		mpq_sub(c.im, a.im, b.im);
		assert_holds("difference", &z, c.re, c.im);
		rectangle_mul(&z, &x, &y);
		complex_product(c.re, c.im, &a, &b);
		assert_holds("product", &z, c.re, c.im);
		rectangle_div(&z, &z, &y);              /* a b / b */
		assert_holds("quotient", &z, a.re, a.im);
		struct poly p = poly_new(1 + (int)draw(8));
		mpq_set_ui(c.re, 0, 1);
		mpq_set_ui(c.im, 0, 1);
		for (int k = p.length - 1; k >= 0; k--) {
			mpz_set_si(p.c[k], (long)draw(2001) - 1000);
			complex_product(c.re, c.im, &c, &a);
			mpq_set_z(b.im, p.c[k]);
			mpq_add(c.re, c.re, b.im);
		}
		rectangle_evaluate(&z, p, &x);
		assert_holds("polynomial", &z, c.re, c.im);
		rectangle_clear(&x);
		rectangle_clear(&y);
		rectangle_clear(&z);
	}
}

/* ---- values of partial fractions ---- */

enum { TRUE_BITS = 1200 };

static void assert_encloses(int n, mpfi_srcptr value, mpfr_srcptr truth)
{
	mpfr_t slack, low, high;            /* the truth is off by some 2^-TRUE_BITS of its terms */
	mpfr_inits2(TRUE_BITS, slack, low, high, NULL);
	mpfr_set_ui_2exp(slack, 1, -TRUE_BITS / 2, MPFR_RNDN);
	mpfr_sub(low, &value->left, slack, MPFR_RNDD);
	mpfr_add(high, &value->right, slack, MPFR_RNDU);
	if (mpfr_cmp(low, truth) > 0 || mpfr_cmp(high, truth) < 0)
		fail_msg("case %d: the truth %.17g is not in [%.17g, %.17g]", n, mpfr_get_d(truth, MPFR_RNDN),
				 mpfr_get_d(&value->left, MPFR_RNDD), mpfr_get_d(&value->right, MPFR_RNDU));
	mpfr_clears(slack, low, high, NULL);
}

/* weight tau^power / power! e^{re tau} cos or sin (im tau) */
static void add_truth(mpfr_ptr sum, long weight, int power, const struct root *r, bool sine, mpq_srcptr tau)
{
	mpfr_t x, angle;
	mpfr_inits2(TRUE_BITS, x, angle, NULL);
	mpfr_set_q(x, r->re, MPFR_RNDN);
	mpfr_mul_q(x, x, tau, MPFR_RNDN);
	mpfr_exp(x, x, MPFR_RNDN);
	mpfr_set_q(angle, r->im, MPFR_RNDN);
	mpfr_mul_q(angle, angle, tau, MPFR_RNDN);
	(sine ? mpfr_sin : mpfr_cos)(angle, angle, MPFR_RNDN);
	mpfr_mul(x, x, angle, MPFR_RNDN);
	mpfr_mul_si(x, x, weight, MPFR_RNDN);
	for (int k = 1; k <= power; k++) {
		mpfr_mul_q(x, x, tau, MPFR_RNDN);
		mpfr_div_ui(x, x, (unsigned long)k, MPFR_RNDN);
	}
	mpfr_add(sum, sum, x, MPFR_RNDN);
	mpfr_clears(x, angle, NULL);
}

static void draw_small(mpq_ptr q, bool above)
{
	mpq_set_si(q, (long)draw(41) - (above ? -1 : 20), 1 + draw(9));
	mpq_canonicalize(q);
}

/* Sum of weight / (s - p)^k, p real and 0 among them, and of (cosine (s - re) + sine im) / ((s - re)^2 + im^2), over
 * one denominator */
static void every_response_holds_its_truth(void **state)
{
	enum { PARTS = 4 };
	mpq_t tau, scale;
	mpq_inits(tau, scale, NULL);
	(void)state;
	for (int n = 0; n < CASES; n++) {
		struct root root[PARTS];
		int parts = 1 + (int)draw(PARTS), power[PARTS];
		long cosine[PARTS], sine[PARTS];
		struct poly linear[PARTS], D = poly_new(1), N = poly_new(0);
		mpfr_t truth;
		mpfi_t value;
		mpfr_init2(truth, TRUE_BITS);
		mpfr_set_ui(truth, 0, MPFR_RNDN);
		mpz_set_ui(D.c[0], 1);
		for (int i = 0; i < parts; i++) {
			bool fresh = true;
			mpq_inits(root[i].re, root[i].im, NULL);
			draw_small(root[i].re, false);
			if (draw(2))
				draw_small(root[i].im, true);
			for (int j = 0; j < i; j++)
				fresh = fresh && !same_root(&root[i], &root[j]);
			if (!fresh) {
				i--;
				continue;
			}
			power[i] = mpq_sgn(root[i].im) ? 0 : (int)draw(3);
			cosine[i] = 1 + (long)draw(9);
			sine[i] = (long)draw(19) - 9;
			linear[i] = factor_of_root(&root[i]);
			for (int k = 0; k <= power[i]; k++)
				D = poly_mul(D, linear[i]);
		}
		draw_small(tau, true);
		mpq_div_2exp(tau, tau, draw(8));
		/* all over the product of the monic factors: each whole factor is `lead` times a monic one */
		mpq_t sum[2 * PARTS * 3 + 4], product[2 * PARTS * 3 + 4], c;
		int length = D.length;
		mpq_init(c);
		for (int k = 0; k < length; k++)
			mpq_inits(sum[k], product[k], NULL);
		for (int i = 0; i < parts; i++) {
			int degree = 0;
			for (int k = 0; k < length; k++)
				mpq_set_ui(product[k], 0, 1);
			if (mpq_sgn(root[i].im)) {      /* cosine s + sine im - cosine re */
				mpq_set_si(product[1], cosine[i], 1);
				mpq_set_si(c, sine[i], 1);
				mpq_mul(product[0], c, root[i].im);
				mpq_mul(c, product[1], root[i].re);
				mpq_sub(product[0], product[0], c);
				degree = 1;
				add_truth(truth, cosine[i], 0, &root[i], false, tau);
				add_truth(truth, sine[i], 0, &root[i], true, tau);
			} else {
				mpq_set_si(product[0], cosine[i], 1);
				add_truth(truth, cosine[i], power[i], &root[i], false, tau);
			}
			for (int j = 0; j < parts; j++)
				for (int m = 0; m <= power[j] && j != i; m++) {
					struct poly g = linear[j];
					int top = g.length - 1;
					/* times the monic factor, in place from above */
					for (int k = degree; k >= 0; k--) {
						for (int l = 0; l < top; l++) {
							mpq_set_z(c, g.c[l]);
							mpz_mul(mpq_denref(c), mpq_denref(c), g.c[top]);
							mpq_canonicalize(c);
							mpq_mul(c, c, product[k]);
							if (l == 0 && top > 0)
								mpq_set(scale, c);
							else
								mpq_add(product[k + l], product[k + l], c);
						}
						mpq_add(product[k + top], product[k + top], product[k]);
						mpq_set(product[k], scale);
					}
					degree += top;
				}
			for (int k = 0; k < length; k++)
				mpq_add(sum[k], sum[k], product[k]);
		}
		/* N = whole multiple of the sum; D = content of the leading coefficient times the monic product */
		mpz_t common, content;
		mpz_init_set_ui(common, 1);
		mpz_init(content);
		for (int k = 0; k < length; k++)
			mpz_lcm(common, common, mpq_denref(sum[k]));
		N = poly_new(length);
		for (int k = 0; k < length; k++) {
			mpz_divexact(N.c[k], common, mpq_denref(sum[k]));
			mpz_mul(N.c[k], N.c[k], mpq_numref(sum[k]));
		}
		poly_trim(&N);
		mpq_set_z(scale, D.c[D.length - 1]);
		mpz_mul(mpq_denref(scale), mpq_denref(scale), common);
		mpq_canonicalize(scale);
		N = poly_primitive(N, content);
		mpq_set_z(c, content);
		mpq_mul(scale, scale, c);
		D = poly_primitive(D, content);
		mpq_set_z(c, content);
		mpq_div(scale, scale, c);
		struct response *response = response_of(scale, N, D);
		for (int k = 0, precision = 0; k < 3; k++) {
			precision += 1 + (int)draw(120);
			mpfi_init2(value, 32 + precision);
			if (response_exact(response, tau, c))
				mpfi_set_q(value, c);
			else
				assert_true(response_enclose(response, tau, precision, value));
			assert_encloses(n, value, truth);
			mpfi_clear(value);
		}
		mpfr_clear(truth);
		mpz_clears(common, content, NULL);
	}
	mpq_clears(tau, scale, NULL);
}

/* -1 and -1 - 2^-3322: first at few bits, then at more, both stay apart. */
static void a_close_pair_is_parted(void **state)
{
	enum { APART = 3322 };
	struct poly D = poly_new(3);
	mpq_t root[2];
	(void)state;
	mpz_setbit(D.c[2], APART);
	mpz_mul_2exp(D.c[1], D.c[2], 1);
	mpz_add_ui(D.c[1], D.c[1], 1);
	mpz_add_ui(D.c[0], D.c[2], 1);
	mpq_inits(root[0], root[1], NULL);
	mpq_set_si(root[0], -1, 1);
	mpz_neg(mpq_numref(root[1]), D.c[0]);
	mpz_set(mpq_denref(root[1]), D.c[2]);
	struct spectrum *s = spectrum_of(D);
	for (int precision = 64; precision <= 256; precision *= 2) {
		assert_true(spectrum_refine(s, precision));
		assert_int_equal(s->factors, 1);
		assert_int_equal(s->poles[0], 2);
		for (int r = 0; r < 2; r++) {
			int holds = 0;
			for (int i = 0; i < 2; i++)
				holds += mpfi_is_inside_q(root[r], s->pole[0][i].at.re) > 0;
			if (holds != 1)
				print_message("at %d bits %d discs hold root %d\n", precision, holds, r);
			assert_int_equal(holds, 1);
		}
	}
	mpq_clears(root[0], root[1], NULL);
}

/* Of two discs that do not meet, one touches the real axis, and its mirror image meets the other: these may be a pair
 * of conjugate roots, of which neither is real. */
static void a_mirrored_disc_is_not_alone(void **state)
{
	static const double center[2] = { 1.0 / 1024, -1.5 / 1024 }, radius[2] = { 1.1 / 1024, 0.3 / 1024 };
	struct iteration it = { .degree = 2, .bits = 64 };
	(void)state;
	it.z = ARRAY(mpc_t, 2);
	it.center = ARRAY(struct rectangle, 2);
	it.radius = ARRAY(mpfr_t, 2);
	for (int i = 0; i < 2; i++) {
		mpc_init2(it.z[i], 64);
		mpfr_init2(it.radius[i], 64);
		rectangle_init(&it.center[i], 64);
		mpc_set_d_d(it.z[i], 1, center[i], MPC_RNDNN);
		mpfi_set_d(it.center[i].re, 1);
		mpfi_set_d(it.center[i].im, center[i]);
		mpfr_set_d(it.radius[i], radius[i], MPFR_RNDN);
	}
	assert_false(discs_meet(&it, 0, 1, false, false));
	assert_true(discs_meet(&it, 0, 1, false, true));
	assert_false(isolated(&it, false, 5));
	mpfr_set_d(it.radius[0], 0.9 / 1024, MPFR_RNDN);        /* off the axis both are alone */
	assert_true(isolated(&it, false, 5));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_disc_alone_holds_one_root),
		cmocka_unit_test(a_close_pair_is_parted),
		cmocka_unit_test(a_mirrored_disc_is_not_alone),
		cmocka_unit_test(every_pole_holds_its_root),
		cmocka_unit_test(every_rectangle_holds_its_truth),
		cmocka_unit_test(every_response_holds_its_truth),
	};
	memory_open();
	int failed = cmocka_run_group_tests(tests, NULL, NULL);
	memory_close();
	return failed;
}
