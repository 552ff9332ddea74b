/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values of the inverse Laplace transform of scale * N(s)/D(s), as sums of residues.
 * At a pole p of multiplicity m, with D(p+e) = e^m (v_0 + v_1 e + ...) and N(p+e)/(v_0 + v_1 e + ...) = a_0 + a_1 e +
 * ..., the residue of N/D e^{s tau} is e^{p tau} sum_k a_{m-1-k} tau^k/k!. The pole 0 is exact; the others are
 * enclosed. */
#include "math/math.h"

enum {
	GUARD_BITS = 32,
	FIRST_SCREEN = 128,             /* bits with which enclosing begins, so that nothing is found twice */
	LAST_SCREEN = 1024,
	LONGEST_COURSE = 32,            /* products of exponentials in a row: turned rectangles widen by up to sqrt 2 */
	LIMIT_COURSES = 128
};

struct course {                     /* e^{p tau} at every pole, moved on in equal steps */
	mpq_t tau;
	struct rectangle **exponential;
	int products;               /* since it was found directly */
	unsigned long used;         /* when it was asked for last */
};
struct growth {                     /* what all responses with one denominator share, for one precision */
	int precision;
	struct rectangle ***series; /* [factor][pole][k]: v_k */
	int courses;
	struct course *course;
	unsigned long requests;     /* how often */
	mpq_t stride;               /* by which the last one moved */
	struct rectangle **over_stride;     /* e^{p stride}; NULL: not asked for yet */
};

/* ---- exact parts ---- */

/* a = n/v as power series of `count` terms */
static void series_quotient(int count, const mpq_t *n, const mpq_t *v, mpq_t *a)
{
	for (int k = 0; k < count; k++) {
		mpq_set(a[k], n[k]);
		for (int j = 1; j <= k; j++)
			rational_submul(a[k], v[j], a[k - j]);
		mpq_div(a[k], a[k], v[0]);
	}
}

static void set_coefficient(mpq_ptr q, struct poly p, int k)
{
	if (k < p.length)
		mpq_set_z(q, p.c[k]);
}

static void residue_at_zero(struct response *response)
{
	int m = response->spectrum->zero;
	mpq_t *n = rationals(m), *v = rationals(m), *a = rationals(m);
	for (int k = 0; k < m; k++) {
		set_coefficient(n[k], response->N, k);
		set_coefficient(v[k], response->spectrum->D, m + k);
	}
	series_quotient(m, n, v, a);
	response->at_zero = rationals(m);
	for (int k = 0; k < m; k++)
		mpq_set(response->at_zero[k], a[m - 1 - k]);
}

/* sum_k at_zero_k tau^k/k! */
static void value_at_zero(const struct response *response, mpq_srcptr tau, mpq_ptr sum)
{
	RATIONAL power = RATIO(1, 1), term = ZERO;
	mpq_set_ui(sum, 0, 1);
	for (int k = 0; k < response->spectrum->zero; k++) {
		mpq_mul(term, response->at_zero[k], power);
		mpq_add(sum, sum, term);
		mpq_set_ui(term, (unsigned long)k + 1, 1);
		mpq_mul(power, power, tau);
		mpq_div(power, power, term);
	}
}

struct response *response_of(mpq_srcptr scale, struct poly N, struct poly D)
{
	struct response *response = NEW(struct response);
	RATIONAL content = ZERO;
	mpq_inits(response->scale, response->last, NULL);
	if (N.length > 0) {
		struct poly common = poly_gcd(N, D), n = poly_divide(N, common), d = poly_divide(D, common);
		N = poly_primitive(n, mpq_numref(content));
		D = poly_primitive(d, mpq_denref(content));
		clear_integers(&n.c);
		clear_integers(&d.c);
		mpq_canonicalize(content);
		mpq_mul(response->scale, scale, content);
	} else {
		D = poly_new(1);
		mpz_set_ui(D.c[0], 1);
	}
	response->N = N;
	response->spectrum = spectrum_of(D);
	if (response->spectrum->D.c != D.c)
		clear_integers(&D.c);
	residue_at_zero(response);
	return response;
}

struct response *response_scaled(const struct response *response, mpq_srcptr factor)
{
	struct response *scaled = NEW(struct response);
	*scaled = *response;
	mpq_inits(scaled->scale, scaled->last, NULL);
	mpq_mul(scaled->scale, response->scale, factor);
	return scaled;
}

struct response *response_without(const struct response *whole, struct poly pole, mpq_srcptr a, mpq_srcptr w)
{
	struct response *response = NEW(struct response);
	struct poly rest = whole->spectrum->D;
	*response = *whole;
	mpq_init(response->last);
	response->precision = 0;
	response->a = a;
	response->w = w;
	if (mpq_sgn(a) == 0 && mpq_sgn(w) == 0)
		response->at_zero = rationals(whole->spectrum->zero);
	while (poly_divides(pole, rest))
		rest = poly_divide(rest, pole);
	response->alone = rest.length - 1 == poly_valuation(rest);
	return response;
}

/* Poles are isolated: the rectangle that a + i w lies in is that pole's. */
static bool is_left_out(const struct response *response, const struct pole *pole)
{
	return response->a && mpfi_is_inside_q(response->a, pole->at.re) > 0 &&
	       mpfi_is_inside_q(response->w, pole->at.im) > 0;
}

/* Is e^{-p tau} times the residue 0 at every root of the factor? With w_k = a_k v_0^{k+1}, an integer polynomial in p:
 * sum_k w_{m-1-k} v_0^k tau^k/k! must be divisible by the factor. */
static bool residue_vanishes(const struct response *response, const struct factor *factor, mpq_srcptr tau)
{
	int m = factor->multiplicity;
	struct poly *v = ARRAY(struct poly, m), *v0 = ARRAY(struct poly, m + 1),
		    *w = ARRAY(struct poly, m);
	v0[0] = poly_new(1);
	mpz_set_ui(v0[0].c[0], 1);
	for (int k = 0; k < m; k++) {
		v[k] = poly_hasse(response->spectrum->D, m + k);
		v0[k + 1] = poly_mul(v0[k], v[0]);
		w[k] = poly_mul(v0[k], poly_hasse(response->N, k));
		for (int j = 1; j <= k; j++)
			w[k] = poly_sub(w[k], poly_mul(poly_mul(v[j], v0[j - 1]), w[k - j]));
	}
	INTEGER weight = INTEGER_ZERO, scale = INTEGER_ZERO;
	struct poly sum = poly_new(0);
	for (int k = 0; k < m; k++) {           /* common denominator den(tau)^{m-1} (m-1)! */
		mpz_pow_ui(weight, mpq_numref(tau), (unsigned long)k);
		mpz_pow_ui(scale, mpq_denref(tau), (unsigned long)(m - 1 - k));
		mpz_mul(weight, weight, scale);
		for (int i = k + 1; i < m; i++)
			mpz_mul_ui(weight, weight, (unsigned long)i);
		sum = poly_add(sum, poly_scale(poly_mul(w[m - 1 - k], v0[k]), weight));
	}
	return poly_divides(factor->g, sum);
}

/* ---- enclosures ---- */

/* v_0 .. v_{m-1} at every pole, for this precision */
static struct growth *denominator_series(struct spectrum *spectrum, int precision)
{
	struct growth *growth = spectrum->growth;
	if (growth && growth->precision >= precision)
		return growth;
	growth = spectrum->growth = NEW(struct growth);
	growth->precision = precision;
	growth->course = ARRAY(struct course, LIMIT_COURSES);
	mpq_init(growth->stride);
	growth->series = ARRAY(struct rectangle **, spectrum->factors);
	for (int f = 0; f < spectrum->factors; f++) {
		int m = spectrum->factor[f].multiplicity;
		growth->series[f] = ARRAY(struct rectangle *, spectrum->poles[f]);
		for (int i = 0; i < spectrum->poles[f]; i++)
			growth->series[f][i] = rectangles(m, precision + GUARD_BITS);
		for (int k = 0; k < m; k++) {
			struct poly taylor = poly_hasse(spectrum->D, m + k);
			for (int i = 0; i < spectrum->poles[f]; i++)
				rectangle_evaluate(&growth->series[f][i][k], taylor, &spectrum->pole[f][i].at);
		}
	}
	return growth;
}

static void exponentials_at(const struct spectrum *spectrum, mpq_srcptr tau, struct rectangle **exponential)
{
	for (int f = 0; f < spectrum->factors; f++)
		for (int i = 0; i < spectrum->poles[f]; i++)
			rectangle_exp(&exponential[f][i], &spectrum->pole[f][i].at, tau);
}

static struct rectangle **room_for_exponentials(const struct spectrum *spectrum, int precision)
{
	struct rectangle **room = ARRAY(struct rectangle *, spectrum->factors);
	for (int f = 0; f < spectrum->factors; f++)
		room[f] = rectangles(spectrum->poles[f], precision);
	return room;
}

static void clear_exponentials(const struct spectrum *spectrum, struct rectangle **exponential)
{
	for (int f = 0; f < spectrum->factors && exponential; f++) {
		for (int i = 0; i < spectrum->poles[f]; i++)
			rectangle_clear(&exponential[f][i]);
		discard(exponential[f]);
	}
	discard(exponential);
}

static struct course *course_at(const struct growth *growth, mpq_srcptr tau)
{
	for (int i = 0; i < growth->courses; i++)
		if (mpq_equal(growth->course[i].tau, tau))
			return &growth->course[i];
	return NULL;
}

static struct course *longest_unused(const struct growth *growth)
{
	struct course *oldest = growth->course;
	for (int i = 1; i < growth->courses; i++)
		if (growth->course[i].used < oldest->used)
			oldest = &growth->course[i];
	return oldest;
}

static struct course *new_course(const struct spectrum *spectrum, struct growth *growth)
{
	if (growth->courses == LIMIT_COURSES)
		return longest_unused(growth);
	struct course *course = &growth->course[growth->courses++];
	mpq_init(course->tau);
	course->exponential = room_for_exponentials(spectrum, growth->precision + GUARD_BITS);
	return course;
}

/* False: this is another stride than the last */
static bool same_stride(const struct spectrum *spectrum, struct growth *growth, mpq_srcptr from, mpq_srcptr to)
{
	RATIONAL stride = ZERO;
	mpq_sub(stride, to, from);
	bool same = mpq_equal(stride, growth->stride);
	if (!same) {
		clear_exponentials(spectrum, growth->over_stride);
		growth->over_stride = NULL;
		mpq_set(growth->stride, stride);
	}
	return same;
}

static void move_course(const struct spectrum *spectrum, struct growth *growth, struct course *course)
{
	if (!growth->over_stride) {
		growth->over_stride = room_for_exponentials(spectrum, growth->precision + GUARD_BITS);
		exponentials_at(spectrum, growth->stride, growth->over_stride);
	}
	for (int f = 0; f < spectrum->factors; f++)
		for (int i = 0; i < spectrum->poles[f]; i++)
			rectangle_mul(&course->exponential[f][i], &course->exponential[f][i],
				      &growth->over_stride[f][i]);
	course->products++;
}

/* At tau, by who asked at `last` before: at equal distances, as the rows of a solution are, by products */
static struct rectangle **exponentials_of(const struct spectrum *spectrum, struct growth *growth, mpq_srcptr last,
					  mpq_srcptr tau)
{
	struct course *course = course_at(growth, tau);
	if (!course) {
		course = course_at(growth, last);
		if (course && same_stride(spectrum, growth, last, tau) && course->products < LONGEST_COURSE) {
			move_course(spectrum, growth, course);
		} else {
			course = course ? course : new_course(spectrum, growth);
			exponentials_at(spectrum, tau, course->exponential);
			course->products = 0;
		}
		mpq_set(course->tau, tau);
	}
	course->used = ++growth->requests;
	return course->exponential;
}

/* a_k of one pole, written so that a[k] multiplies tau^k/k! */
static struct rectangle *residue_series(const struct response *response, int f, int i, int precision)
{
	const struct spectrum *spectrum = response->spectrum;
	int m = spectrum->factor[f].multiplicity;
	const struct rectangle *v = spectrum->growth->series[f][i], *p = &spectrum->pole[f][i].at;
	struct rectangle *a = rectangles(m, precision + GUARD_BITS);
	RECTANGLE product = new_rectangle(precision + GUARD_BITS);
	for (int k = 0; k < m; k++) {
		struct rectangle *at = &a[m - 1 - k];
		rectangle_evaluate(at, poly_hasse(response->N, k), p);
		for (int j = 1; j <= k; j++) {
			rectangle_mul(&product, &v[j], &a[m - 1 - k + j]);
			rectangle_sub(at, at, &product);
		}
		rectangle_div(at, at, &v[0]);
	}
	return a;
}

static void find_residues(struct response *response, int precision)
{
	const struct spectrum *spectrum = response->spectrum;
	if (response->precision >= precision)
		return;
	response->residue = ARRAY(struct rectangle **, spectrum->factors);
	for (int f = 0; f < spectrum->factors; f++) {
		response->residue[f] = ARRAY(struct rectangle *, spectrum->poles[f]);
		for (int i = 0; i < spectrum->poles[f]; i++)
			if (!is_left_out(response, &spectrum->pole[f][i]))
				response->residue[f][i] = residue_series(response, f, i, precision);
	}
	response->precision = precision;
}

/* sum_k a_k tau^k/k! by Horner: (a_{m-1} tau/(m-1) + a_{m-2}) tau/(m-2) ... */
static void residue_at(struct rectangle *total, int m, const struct rectangle *a, mpq_srcptr tau)
{
	RATIONAL power = ZERO;
	rectangle_set(total, &a[m - 1]);
	for (int k = m - 2; k >= 0; k--) {
		mpq_set_ui(power, 1, (unsigned long)k + 1);
		mpq_mul(power, power, tau);
		mpfi_mul_q(total->re, total->re, power);
		mpfi_mul_q(total->im, total->im, power);
		mpfi_add(total->re, total->re, a[k].re);
		mpfi_add(total->im, total->im, a[k].im);
	}
}

/* sum += (2) Re e^{p tau} sum_k a_k tau^k/k! */
static void add_residue(const struct pole *pole, int m, const struct rectangle *a, const struct rectangle *exponential,
			mpq_srcptr tau, mpfi_ptr sum)
{
	RECTANGLE total = new_rectangle((int)mpfi_get_prec(sum));
	residue_at(&total, m, a, tau);
	rectangle_real_product(total.re, &total, exponential);
	if (!pole->real)
		mpfi_mul_2ui(total.re, total.re, 1);
	mpfi_add(sum, sum, total.re);
}

/* An enclosure without 0 decides at once what polynomials of degree m^2 would. */
static bool surely_transcendental(struct response *response, mpq_srcptr tau)
{
	struct spectrum *spectrum = response->spectrum;
	bool sure = spectrum->factors == 0;
	for (int bits = FIRST_SCREEN; !sure && bits <= LAST_SCREEN && spectrum_refine(spectrum, bits); bits *= 2) {
		denominator_series(spectrum, bits);
		find_residues(response, bits);
		RECTANGLE total = new_rectangle(bits + GUARD_BITS);
		residue_at(&total, spectrum->factor[0].multiplicity, response->residue[0][0], tau);
		sure = mpfi_has_zero(total.re) <= 0 || mpfi_has_zero(total.im) <= 0;
	}
	return sure && spectrum->factors > 0;
}

/* Lindemann and Weierstrass: with tau != 0 rational the exponentials of distinct poles are independent over the
 * algebraic numbers, so the value is rational only if every residue away from 0 vanishes; a simple one never does. */
bool response_exact(struct response *response, mpq_srcptr tau, mpq_ptr exact)
{
	const struct spectrum *spectrum = response->spectrum;
	if (response->a) {
		value_at_zero(response, tau, exact);
		mpq_mul(exact, exact, response->scale);
		return response->alone;
	}
	if (mpq_sgn(tau) == 0) {                /* the limit s N/D at infinity */
		mpq_set_ui(exact, 0, 1);
		if (response->N.length > 0 && response->N.length + 1 == spectrum->D.length) {
			mpz_set(mpq_numref(exact), response->N.c[response->N.length - 1]);
			mpz_set(mpq_denref(exact), spectrum->D.c[spectrum->D.length - 1]);
			mpq_canonicalize(exact);
			mpq_mul(exact, exact, response->scale);
		}
		return true;
	}
	for (int f = 0; f < spectrum->factors; f++)
		if (spectrum->factor[f].multiplicity == 1)
			return false;
	if (surely_transcendental(response, tau))
		return false;
	for (int f = 0; f < spectrum->factors; f++)
		if (!residue_vanishes(response, &spectrum->factor[f], tau))
			return false;
	value_at_zero(response, tau, exact);
	mpq_mul(exact, exact, response->scale);
	return true;
}

bool response_enclose(struct response *response, mpq_srcptr tau, int precision, mpfi_ptr value)
{
	struct spectrum *spectrum = response->spectrum;
	if (!spectrum_refine(spectrum, precision))
		return false;
	struct growth *growth = denominator_series(spectrum, precision);
	struct rectangle **exponential = exponentials_of(spectrum, growth, response->last, tau);
	mpq_set(response->last, tau);
	find_residues(response, precision);
	RATIONAL exact = ZERO;
	value_at_zero(response, tau, exact);
	mpfi_set_prec(value, precision + GUARD_BITS);
	mpfi_set_q(value, exact);
	for (int f = 0; f < spectrum->factors; f++)
		for (int i = 0; i < spectrum->poles[f]; i++)
			if (response->residue[f][i])
				add_residue(&spectrum->pole[f][i], spectrum->factor[f].multiplicity,
					    response->residue[f][i], &exponential[f][i], tau, value);
	mpfi_mul_q(value, value, response->scale);
	return true;
}
