/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The roots of square-free polynomials, each in a disc that provably holds it alone.
 * Approximations come from GSL (or the Newton polygon where a double cannot hold the coefficients) and are improved by
 * the Ehrlich-Aberth iteration; the discs d |g(z_i)| / (|a_d| prod |z_i - z_j|) (Smith 1970) are computed in interval
 * arithmetic, so they are true whatever the iteration did. What a disc does not decide, more precision does. */
#include "math/math.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_poly.h>
#include <math.h>
#include <mpc.h>

enum {
	START_BITS = 64,
	RADIUS_BITS = 64,
	REPULSION_BITS = 64,
	GUARD_BITS = 32,
	SWEEPS = 40,
	LIMIT_ITERATION_BITS = 1 << 16
};

struct iteration {                  /* of one factor */
	int degree, bits;
	bool expected, started;     /* z was given from outside; the iteration has begun */
	mpc_t *z;
	struct rectangle *center;   /* z as degenerate rectangles */
	mpfr_t *radius;             /* upper bounds */
};

/* ---- starting values ---- */

/* s = 2^scale x brings the geometric mean of the roots near 1 */
static long root_scale(struct poly g)
{
	long low, high;
	mpz_get_d_2exp(&low, g.c[0]);
	mpz_get_d_2exp(&high, g.c[g.length - 1]);
	return (low - high) / (g.length - 1);
}

static bool start_by_gsl(struct poly g, struct iteration *it)
{
	int d = it->degree;
	long scale = root_scale(g), top = 0;
	double *a = ARRAY(double, d + 1), *z = ARRAY(double, 2 * (size_t)d);
	for (int k = 0; k <= d; k++) {
		long exponent;
		if (mpz_sgn(g.c[k]) == 0)
			continue;
		mpz_get_d_2exp(&exponent, g.c[k]);
		top = k == 0 || exponent + k * scale > top ? exponent + k * scale : top;
	}
	for (int k = 0; k <= d; k++) {
		long exponent;
		double mantissa = mpz_get_d_2exp(&exponent, g.c[k]);
		exponent += k * scale - top;
		if (mpz_sgn(g.c[k]) != 0 && exponent < -900)
			return false;
		a[k] = mpz_sgn(g.c[k]) == 0 ? 0 : ldexp(mantissa, (int)exponent);
	}
	gsl_error_handler_t *handler = gsl_set_error_handler_off();
	gsl_poly_complex_workspace *workspace = need_memory(gsl_poly_complex_workspace_alloc((size_t)d + 1));
	bool good = gsl_poly_complex_solve(a, (size_t)d + 1, workspace, z) == GSL_SUCCESS;
	gsl_set_error_handler(handler);
	gsl_poly_complex_workspace_free(workspace);
	for (int i = 0; i < d && good; i++) {
		good = isfinite(z[2 * i]) && isfinite(z[2 * i + 1]) && (z[2 * i] != 0 || z[2 * i + 1] != 0);
		mpc_set_d_d(it->z[i], z[2 * i], z[2 * i + 1], MPC_RNDNN);
		mpc_mul_2si(it->z[i], it->z[i], scale, MPC_RNDNN);
	}
	return good;
}

static double log2_abs(mpz_srcptr z)
{
	long exponent;
	double mantissa = mpz_get_d_2exp(&exponent, z);
	return log2(fabs(mantissa)) + (double)exponent;
}

/* On each edge of the upper hull of (k, log |a_k|) as many points as the edge is long, on a circle (Bini 1996). */
static void start_by_newton_polygon(struct poly g, struct iteration *it)
{
	for (int from = 0, found = 0, to; from < it->degree; from = to) {
		double steepest = -INFINITY;
		to = from + 1;
		for (int k = from + 1; k <= it->degree; k++) {
			if (mpz_sgn(g.c[k]) == 0)
				continue;
			double slope = (log2_abs(g.c[k]) - log2_abs(g.c[from])) / (k - from);
			if (slope >= steepest) {
				steepest = slope;
				to = k;
			}
		}
		for (int i = from; i < to; i++, found++) {
			double angle = 6.283185307179586 * (i - from + 0.27) / (to - from) + from;
			mpc_set_d_d(it->z[found], cos(angle), sin(angle), MPC_RNDNN);
			REAL radius = WITH_BITS(53);
			mpfr_set_d(radius, -steepest, MPFR_RNDN);
			mpfr_exp2(radius, radius, MPFR_RNDN);
			mpc_mul_fr(it->z[found], it->z[found], radius, MPC_RNDNN);
		}
	}
}

/* Equal starting values would stay equal. */
static void pull_apart(struct iteration *it)
{
	mpc_t factor;
	mpc_init2(factor, START_BITS);
	for (int i = 0; i < it->degree; i++) {
		mpc_set_d_d(factor, 1 + ldexp(i + 1, -40), ldexp(2 * i + 1, -41), MPC_RNDNN);
		mpc_mul(it->z[i], it->z[i], factor, MPC_RNDNN);
	}
	mpc_clear(factor);
}

static void iteration_new(struct poly g, struct iteration *it)
{
	it->degree = g.length - 1;
	it->bits = START_BITS;
	it->z = ARRAY(mpc_t, it->degree);
	it->center = ARRAY(struct rectangle, it->degree);
	it->radius = ARRAY(mpfr_t, it->degree);
	for (int i = 0; i < it->degree; i++) {
		mpc_init2(it->z[i], START_BITS);
		rectangle_init(&it->center[i], START_BITS);
		mpfr_init2(it->radius[i], START_BITS);
	}
}

static void iteration_start(struct poly g, struct iteration *it)
{
	if (!it->expected && !start_by_gsl(g, it))
		start_by_newton_polygon(g, it);
	pull_apart(it);
	it->started = true;
}

/* ---- Ehrlich and Aberth ---- */

static void newton_correction(struct poly g, mpc_srcptr z, mpc_ptr correction)
{
	mpc_t derivative;
	mpc_init2(derivative, mpfr_get_prec(mpc_realref(correction)));
	mpc_set_ui(correction, 0, MPC_RNDNN);
	mpc_set_ui(derivative, 0, MPC_RNDNN);
	for (int k = g.length - 1; k >= 0; k--) {
		mpc_mul(derivative, derivative, z, MPC_RNDNN);
		mpc_add(derivative, derivative, correction, MPC_RNDNN);
		mpc_mul(correction, correction, z, MPC_RNDNN);
		mpfr_add_z(mpc_realref(correction), mpc_realref(correction), g.c[k], MPFR_RNDN);
	}
	mpc_div(correction, correction, derivative, MPC_RNDNN);
	mpc_clear(derivative);
}

static bool is_finite(mpc_srcptr z)
{
	return mpfr_number_p(mpc_realref(z)) && mpfr_number_p(mpc_imagref(z));
}

/* sum over j of 1/(z_i - z_j), the differences to all bits and the sum to few: it is multiplied by what is small */
static void find_repulsion(const struct iteration *it, int i, mpc_ptr sum)
{
	mpc_t difference;
	mpc_init2(difference, REPULSION_BITS);
	REAL norm = WITH_BITS(REPULSION_BITS), square = WITH_BITS(REPULSION_BITS);
	mpc_set_ui(sum, 0, MPC_RNDNN);
	for (int j = 0; j < it->degree; j++) {
		if (j == i)
			continue;
		mpc_sub(difference, it->z[i], it->z[j], MPC_RNDNN);
		mpfr_sqr(norm, mpc_realref(difference), MPFR_RNDN);
		mpfr_sqr(square, mpc_imagref(difference), MPFR_RNDN);
		mpfr_add(norm, norm, square, MPFR_RNDN);
		mpc_conj(difference, difference, MPC_RNDNN);
		mpc_div_fr(difference, difference, norm, MPC_RNDNN);
		mpc_add(sum, sum, difference, MPC_RNDNN);
	}
	mpc_clear(difference);
}

/* One sweep; the largest correction relative to its root, as an exponent of 2. */
static long sweep(struct poly g, struct iteration *it)
{
	enum { MANY = 32 };
	mpc_t w, repulsion, product;
	long largest = -it->bits;
	mpc_init2(w, it->bits);
	mpc_init2(repulsion, REPULSION_BITS);
	mpc_init2(product, it->bits);
	REAL size = WITH_BITS(53);
	for (int i = 0; i < it->degree; i++) {
		if (it->degree > MANY)
			progress("poles", i, it->degree);
		newton_correction(g, it->z[i], w);
		find_repulsion(it, i, repulsion);
		mpc_mul(product, repulsion, w, MPC_RNDNN);
		mpc_ui_sub(product, 1, product, MPC_RNDNN);
		mpc_div(w, w, product, MPC_RNDNN);
		if (!is_finite(w) || mpc_cmp_si(w, 0) == 0)
			continue;
		mpc_sub(it->z[i], it->z[i], w, MPC_RNDNN);
		mpc_div(w, w, it->z[i], MPC_RNDNN);
		mpc_abs(size, w, MPFR_RNDN);
		if (mpfr_regular_p(size) && mpfr_get_exp(size) > largest)
			largest = mpfr_get_exp(size);
	}
	mpc_clear(w);
	mpc_clear(repulsion);
	mpc_clear(product);
	return largest;
}

static void iterate(struct poly g, struct iteration *it, int bits)
{
	it->bits = bits;
	for (int i = 0; i < it->degree; i++) {
		mpfr_prec_round(mpc_realref(it->z[i]), bits, MPFR_RNDN);
		mpfr_prec_round(mpc_imagref(it->z[i]), bits, MPFR_RNDN);
	}
	for (int k = 0; k < SWEEPS; k++)
		if (sweep(g, it) < -bits / 2)
			break;
}

/* ---- clusters ---- */

/* g^(j)(z)/j! for j = 0 .. last, by Horner's rule */
static void taylor_at(struct poly g, mpc_srcptr z, int last, mpc_t *c)
{
	for (int j = 0; j <= last; j++)
		mpc_set_ui(c[j], 0, MPC_RNDNN);
	for (int k = g.length - 1; k >= 0; k--) {
		for (int j = last; j > 0; j--) {
			mpc_mul(c[j], c[j], z, MPC_RNDNN);
			mpc_add(c[j], c[j], c[j - 1], MPC_RNDNN);
		}
		mpc_mul(c[0], c[0], z, MPC_RNDNN);
		mpfr_add_z(mpc_realref(c[0]), mpc_realref(c[0]), g.c[k], MPFR_RNDN);
	}
}

/* Is b within the noise that a's last bits left of an m-fold root? */
static bool stick_together(mpc_srcptr a, mpc_srcptr b, int bits)
{
	mpc_t difference;
	mpc_init2(difference, mpfr_get_prec(mpc_realref(a)));
	REAL size = WITH_BITS(53), scale = WITH_BITS(53);
	mpc_sub(difference, a, b, MPC_RNDNN);
	mpc_abs(size, difference, MPFR_RNDN);
	mpc_abs(scale, a, MPFR_RNDN);
	mpfr_mul_2si(scale, scale, -bits / 5, MPFR_RNDN);
	bool close = mpfr_lessequal_p(size, scale);
	mpc_clear(difference);
	return close;
}

/* z[member[0 .. m-1]] anew: the mean of m close roots is nearly a simple root of g^(m-1), which Newton's rule finds to
 * all bits; around it the roots have the size that the ends of sum c_j u^j, j <= m, give. The sweeps alone gain less
 * than two bits each. */
static void part_cluster(struct poly g, struct iteration *it, const int *member, int m, int bits)
{
	SCRATCH mpc_t *c = ARRAY(mpc_t, m + 1);
	mpc_t mean, step;
	mpc_init2(mean, bits);
	mpc_init2(step, bits);
	REAL radius = WITH_BITS(53);
	for (int j = 0; j <= m; j++)
		mpc_init2(c[j], bits);
	mpc_set(mean, it->z[member[0]], MPC_RNDNN);
	for (int k = 0; k < SWEEPS / 2; k++) {
		taylor_at(g, mean, m, c);
		mpc_div(step, c[m - 1], c[m], MPC_RNDNN);
		mpc_div_ui(step, step, (unsigned long)m, MPC_RNDNN);
		if (!is_finite(step) || mpc_cmp_si(step, 0) == 0)
			break;
		mpc_sub(mean, mean, step, MPC_RNDNN);
	}
	mpc_div(step, c[0], c[m], MPC_RNDNN);
	mpc_abs(radius, step, MPFR_RNDN);
	mpfr_rootn_ui(radius, radius, (unsigned long)m, MPFR_RNDN);
	for (int i = 0; i < m && mpfr_regular_p(radius) && is_finite(mean); i++) {
		double angle = 6.283185307179586 * (i + 0.27) / m;
		mpc_set_d_d(step, cos(angle), sin(angle), MPC_RNDNN);
		mpc_mul_fr(step, step, radius, MPC_RNDNN);
		mpfr_prec_round(mpc_realref(it->z[member[i]]), bits, MPFR_RNDN);
		mpfr_prec_round(mpc_imagref(it->z[member[i]]), bits, MPFR_RNDN);
		mpc_add(it->z[member[i]], mean, step, MPC_RNDNN);
	}
	for (int j = 0; j <= m; j++)
		mpc_clear(c[j]);
	mpc_clear(mean);
	mpc_clear(step);
}

/* Before a round with more bits: roots that those so far did not part */
static void part_clusters(struct poly g, struct iteration *it, int bits)
{
	SCRATCH int *member = ARRAY(int, it->degree);
	SCRATCH bool *done = ARRAY(bool, it->degree);
	for (int i = 0; i < it->degree; i++) {
		int m = 0;
		for (int j = i; j < it->degree && !done[i]; j++)
			if (!done[j] && stick_together(it->z[i], it->z[j], it->bits))
				member[m++] = j;
		for (int k = 0; k < m; k++)
			done[member[k]] = true;
		if (m > 1)
			part_cluster(g, it, member, m, bits);
	}
}

/* ---- discs ---- */

static void distance(mpfi_ptr value, const struct rectangle *a, const struct rectangle *b)
{
	RECTANGLE difference = new_rectangle((int)mpfi_get_prec(value));
	rectangle_sub(&difference, a, b);
	mpfi_hypot(value, difference.re, difference.im);
}

/* |a - b|^2 for points: the differences to all their bits, their squares to few */
static void squared_distance(mpfi_ptr value, const struct rectangle *a, const struct rectangle *b, mpfi_ptr difference,
			     mpfi_ptr square)
{
	mpfi_sub(difference, a->re, b->re);
	mpfi_sqr(value, difference);
	mpfi_sub(difference, a->im, b->im);
	mpfi_sqr(square, difference);
	mpfi_add(value, value, square);
}

/* prod |z_i - z_j| */
static void product_of_distances(const struct iteration *it, int i, mpfi_ptr product)
{
	INTERVAL difference = OVER_BITS(it->bits), square = OVER_BITS(RADIUS_BITS), gap = OVER_BITS(RADIUS_BITS);
	mpfi_set_ui(product, 1);
	for (int j = 0; j < it->degree; j++) {
		if (j == i)
			continue;
		squared_distance(gap, &it->center[i], &it->center[j], difference, square);
		mpfi_mul(product, product, gap);
	}
	mpfi_sqrt(product, product);
}

static void find_discs(struct poly g, struct iteration *it)
{
	RECTANGLE value = new_rectangle(it->bits);
	INTERVAL radius = OVER_BITS(RADIUS_BITS), gaps = OVER_BITS(RADIUS_BITS);
	for (int i = 0; i < it->degree; i++) {
		mpfi_set_prec(it->center[i].re, it->bits);
		mpfi_set_prec(it->center[i].im, it->bits);
		mpfi_set_fr(it->center[i].re, mpc_realref(it->z[i]));
		mpfi_set_fr(it->center[i].im, mpc_imagref(it->z[i]));
	}
	for (int i = 0; i < it->degree; i++) {
		rectangle_evaluate(&value, g, &it->center[i]);
		mpfi_hypot(radius, value.re, value.im);
		mpfi_mul_ui(radius, radius, (unsigned long)it->degree);
		mpfi_div_z(radius, radius, g.c[it->degree]);
		product_of_distances(it, i, gaps);
		mpfi_div(radius, radius, gaps);
		mpfi_get_right(it->radius[i], radius);
		mpfr_abs(it->radius[i], it->radius[i], MPFR_RNDU);
	}
}

static bool small_enough(const struct iteration *it, int i, int precision)
{
	REAL limit = WITH_BITS(53);
	mpc_abs(limit, it->z[i], MPFR_RNDD);
	mpfr_mul_2si(limit, limit, -precision, MPFR_RNDD);
	return mpfr_number_p(it->radius[i]) && mpfr_lessequal_p(it->radius[i], limit);
}

/* Are a and b or -b (`mirrored`) further apart than that? Rounded down, so that true is certain. */
static bool apart(mpfr_srcptr a, mpfr_srcptr b, bool mirrored, mpfr_srcptr than)
{
	REAL gap = WITH_BITS(RADIUS_BITS);
	(mirrored ? mpfr_add : mpfr_sub)(gap, a, b, MPFR_RNDZ);
	return mpfr_cmpabs(gap, than) > 0;
}

/* Does disc i, mirrored in the real axis (flip_im) or the imaginary one (flip_re), meet disc j? */
static bool discs_meet(const struct iteration *it, int i, int j, bool flip_re, bool flip_im)
{
	REAL sum = WITH_BITS(RADIUS_BITS);
	mpfr_add(sum, it->radius[i], it->radius[j], MPFR_RNDU);
	if (apart(mpc_realref(it->z[i]), mpc_realref(it->z[j]), flip_re, sum) ||
	    apart(mpc_imagref(it->z[i]), mpc_imagref(it->z[j]), flip_im, sum))
		return false;
	RECTANGLE mirrored = new_rectangle(it->bits);
	INTERVAL gap = OVER_BITS(it->bits);
	rectangle_set(&mirrored, &it->center[i]);
	if (flip_re)
		mpfi_neg(mirrored.re, mirrored.re);
	if (flip_im)
		mpfi_neg(mirrored.im, mirrored.im);
	distance(gap, &mirrored, &it->center[j]);
	return !mpfr_greater_p(&gap->left, sum);
}

/* The set of roots is its own mirror image: a disc whose image meets it and no other holds a root on the axis. */
static bool image_is_alone(const struct iteration *it, int i, bool flip_re, bool flip_im)
{
	for (int j = 0; j < it->degree; j++)
		if (j != i && discs_meet(it, i, j, flip_re, flip_im))
			return false;
	return true;
}

static bool touches_axis(mpfr_srcptr part, mpfr_srcptr radius)
{
	return mpfr_cmpabs(part, radius) <= 0;
}

static bool isolated(const struct iteration *it, bool symmetric, int precision)
{
	for (int i = 0; i < it->degree; i++) {
		bool on_real = touches_axis(mpc_imagref(it->z[i]), it->radius[i]);
		bool on_imaginary = touches_axis(mpc_realref(it->z[i]), it->radius[i]);
		if (!small_enough(it, i, precision) || !image_is_alone(it, i, false, false))
			return false;
		if (on_real && !image_is_alone(it, i, false, true))
			return false;
		if (on_imaginary && !(symmetric && image_is_alone(it, i, true, false)))
			return false;
	}
	return true;
}

/* ---- poles ---- */

static void enclose_part(mpfi_ptr part, mpfr_srcptr center, mpfr_srcptr radius, bool exactly_zero)
{
	mpfi_set_prec(part, mpfr_get_prec(center) + GUARD_BITS);
	mpfi_set_ui(part, 0);
	if (!exactly_zero)
		mpfi_interv_fr(part, center, center);
	if (exactly_zero)
		return;
	mpfr_sub(&part->left, center, radius, MPFR_RNDD);
	mpfr_add(&part->right, center, radius, MPFR_RNDU);
}

static int poles_from_discs(const struct iteration *it, struct pole *pole)
{
	int count = 0;
	for (int i = 0; i < it->degree; i++) {
		bool real = touches_axis(mpc_imagref(it->z[i]), it->radius[i]);
		bool imaginary = touches_axis(mpc_realref(it->z[i]), it->radius[i]);
		if (!real && mpfr_sgn(mpc_imagref(it->z[i])) < 0)
			continue;
		pole[count].real = real;
		pole[count].imaginary = imaginary;
		enclose_part(pole[count].at.re, mpc_realref(it->z[i]), it->radius[i], imaginary);
		enclose_part(pole[count].at.im, mpc_imagref(it->z[i]), it->radius[i], real);
		count++;
	}
	return count;
}

static bool refine_factor(struct spectrum *spectrum, int f, int precision)
{
	struct iteration *it = &spectrum->iteration[f];
	struct factor *factor = &spectrum->factor[f];
	/* never fewer than before: what they have parted would meet again */
	int wanted = precision + GUARD_BITS + 2 * it->degree;
	bool again = false;
	if (!it->started)
		iteration_start(factor->g, it);
	for (int bits = wanted > it->bits ? wanted : it->bits; bits < LIMIT_ITERATION_BITS;
	     bits += bits / 2, again = true) {
		if (again)
			part_clusters(factor->g, it, bits);
		iterate(factor->g, it, bits);
		find_discs(factor->g, it);
		if (isolated(it, factor->symmetric, precision)) {
			spectrum->poles[f] = poles_from_discs(it, spectrum->pole[f]);
			return true;
		}
	}
	return false;
}

bool spectrum_refine(struct spectrum *spectrum, int precision)
{
	if (precision <= spectrum->precision)
		return true;
	for (int f = 0; f < spectrum->factors; f++)
		if (!refine_factor(spectrum, f, precision))
			return false;
	spectrum->precision = precision;
	return true;
}

static void make_room_for_poles(struct spectrum *spectrum)
{
	size_t factors = (size_t)spectrum->factors;
	spectrum->poles = ARRAY(int, factors);
	spectrum->pole = ARRAY(struct pole *, factors);
	spectrum->iteration = ARRAY(struct iteration, factors);
	for (int f = 0; f < spectrum->factors; f++) {
		int degree = spectrum->factor[f].g.length - 1;
		iteration_new(spectrum->factor[f].g, &spectrum->iteration[f]);
		spectrum->pole[f] = ARRAY(struct pole, degree);
		for (int i = 0; i < degree; i++)
			rectangle_init(&spectrum->pole[f][i].at, START_BITS);
	}
}

/* Adds those of a part of D; false: it has a root in common with one before that it does not share whole */
static bool add_factors(struct spectrum *spectrum, struct poly part)
{
	struct factor *factor;
	int factors = poly_square_free(part, &factor), known = spectrum->factors;
	ENLARGE(spectrum->factor, (size_t)known + (size_t)factors);
	for (int i = 0; i < factors; i++) {
		int same = -1;
		for (int f = 0; f < known && same < 0; f++)
			if (poly_equal(spectrum->factor[f].g, factor[i].g))
				same = f;
			else if (poly_gcd(spectrum->factor[f].g, factor[i].g).length > 1)
				return false;
		if (same >= 0)
			spectrum->factor[same].multiplicity += factor[i].multiplicity;
		else
			spectrum->factor[spectrum->factors++] = factor[i];
	}
	return true;
}

static struct spectrum *spectrum_new(struct poly D, int parts, const struct poly *part)
{
	struct spectrum *spectrum = NEW(struct spectrum);
	spectrum->D = D;
	spectrum->zero = poly_valuation(D);
	bool apart = true;
	for (int k = 0; k < parts && apart; k++)
		apart = add_factors(spectrum, part[k]);
	if (!apart)
		spectrum->factors = poly_square_free(D, &spectrum->factor);
	make_room_for_poles(spectrum);
	return spectrum;
}

static struct spectrum *find_spectrum(struct poly D, int parts, const struct poly *part)
{
	enum { BUCKETS = 4096 };
	static struct spectrum *known[BUCKETS];
	unsigned long hash = 0;
	for (int k = 0; k < D.length; k++)
		hash = (hash ^ mpz_get_ui(D.c[k])) * 0x9e3779b1;
	struct spectrum **first = &known[(hash >> 16) % BUCKETS];
	for (struct spectrum *s = *first; s; s = s->next)
		if (poly_equal(s->D, D))
			return s;
	struct spectrum *spectrum = spectrum_new(D, parts, part);
	spectrum->next = *first;
	return *first = spectrum;
}

struct spectrum *spectrum_of(struct poly D)
{
	return find_spectrum(D, 1, &D);
}

struct spectrum *spectrum_of_product(int count, const struct poly *part)
{
	INTEGER content = INTEGER_ZERO;
	struct poly D = poly_primitive(poly_product(count, part), content);
	return find_spectrum(D, count, part);
}

/* Only where all roots but 0 are of one factor is it clear which are whose. */
void spectrum_expect(struct spectrum *spectrum, int count, const double *re, const double *im)
{
	if (spectrum->factors != 1 || spectrum->iteration->started ||
	    spectrum->iteration->degree + spectrum->zero != count)
		return;
	struct iteration *it = spectrum->iteration;
	SCRATCH bool *zero = ARRAY(bool, count);
	for (int k = 0; k < spectrum->zero; k++) {
		int least = -1;
		for (int i = 0; i < count; i++)
			if (!zero[i] && (least < 0 || hypot(re[i], im[i]) < hypot(re[least], im[least])))
				least = i;
		zero[least] = true;
	}
	it->expected = true;
	for (int i = 0, found = 0; i < count; i++)
		if (!zero[i]) {
			it->expected = it->expected && (re[i] != 0 || im[i] != 0);
			mpc_set_d_d(it->z[found++], re[i], im[i], MPC_RNDNN);
		}
}
