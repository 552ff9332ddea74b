/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Transfer functions H(s) = scale N(s)/D(s) of the linear part, exact and without common factors: each output over each
 * input u, and over what each load forces with its function of time taken as u. The image of an output under the ramp
 * u = t from rest is H(s)/s^2, under a step H(s)/s (Laplace transform of an integral). */
#include "model/reads.h"
#include "report/report.h"
#include "step/linear/images.h"

#include <math.h>

/* ---- outputs and what drives them ---- */

bool is_reported(const struct output *output)
{
	return (output->form || !output->value) && !output->peak; /* without declared outputs: a state */
}

/* The first segment of time in which it acts, on an equation or on an output; -1: none */
static int segment_of_column(const struct model *model, int load, int column)
{
	const struct linear *system = &model->system;
	for (int s = 0; s < system->segments; s++) {
		for (int i = 0; i < system->n; i++)
			if (mpq_sgn(system->load[load].force[column][s * system->n + i]) != 0)
				return s;
		for (int i = 0; i < model->outputs; i++)
			if (is_reported(&model->output[i]) &&
			    mpq_sgn(model->output[i].load[load][column * system->segments + s]) != 0)
				return s;
	}
	return -1;
}

int drives_of(const struct model *model, struct drive **drives)
{
	const struct linear *system = &model->system;
	int count = 0;
	*drives = ARRAY(struct drive, (size_t)(system->inputs + load_columns(system) + 1));
	for (int i = 0; i < system->inputs; i++)
		(*drives)[count++] = (struct drive){ system->input[i].name, i, 0, 0, 0 };
	for (int l = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++) {
			int segment = segment_of_column(model, l, k);
			if (segment >= 0)
				(*drives)[count++] =
					(struct drive){ column_text(&system->load[l], k), -1, l, k, segment };
		}
	return count;
}

/* ---- one transfer function ---- */

static struct response *image_of_load(struct resolvent *r, const struct model *model, const struct output *output,
				      const struct drive *drive)
{
	const struct linear *system = &model->system;
	struct excitation e = excitation_new(system->n, NULL, NULL, 1);
	for (int k = 0; k < system->n; k++)
		mpq_set(e.force[k], system->load[drive->load].force[drive->column][drive->segment * system->n + k]);
	mpq_set(e.direct[0], output->load[drive->load][drive->column * system->segments + drive->segment]);
	return image_of(r, &(struct question){ NULL, 1, &e, output->state });
}

/* s^powers times an image, without common factors */
static void multiply_by_s(struct transfer *t, const struct response *image, int powers)
{
	struct poly D = image->spectrum->D;
	int poles = D.length ? poly_valuation(D) : 0, shared = poles < powers ? poles : powers;
	mpq_init(t->scale);
	mpq_set(t->scale, image->scale);
	t->N = image->N.length ? poly_shift(image->N, powers - shared) : image->N;
	t->D = poly_shift(D, -shared);
}

static struct transfer transfer_of(struct resolvent *r, const struct model *model, int output,
				   const struct drive *drive)
{
	const struct output *read = &model->output[output];
	struct transfer t = { .output = read->name, .drive = drive->name, .input = drive->input };
	RATIONAL zero = ZERO, one = RATIO(1, 1);
	if (drive->input >= 0)
		multiply_by_s(&t, output_of_input(r, &model->system, read, drive->input, zero, one), 2);
	else
		multiply_by_s(&t, image_of_load(r, model, read, drive), 1);
	return t;
}

int transfers_of(struct resolvent *r, const struct model *model, struct transfer **list)
{
	struct drive *drive;
	int drives = drives_of(model, &drive), count = 0;
	*list = ARRAY(struct transfer, (size_t)(drives * model->outputs) + 1);
	progress("transfer function", 0, drives * model->outputs);
	for (int d = 0; d < drives; d++)
		for (int i = 0; i < model->outputs; i++) {
			progress("transfer function", d * model->outputs + i, drives * model->outputs);
			if (is_reported(&model->output[i]))
				(*list)[count++] = transfer_of(r, model, i, &drive[d]);
		}
	progress_end();
	return count;
}

/* ---- what is reported of it ---- */

bool static_gain(const struct transfer *t, mpq_ptr gain)
{
	mpq_set_ui(gain, 0, 1);
	if (t->N.length == 0)
		return true;
	if (mpz_sgn(t->D.c[0]) == 0)
		return false;
	RATIONAL over = ZERO;
	mpq_set_z(gain, t->N.c[0]);
	mpq_set_z(over, t->D.c[0]);
	mpq_div(gain, gain, over);
	mpq_mul(gain, gain, t->scale);
	return true;
}

static void add_zero(struct zero *zero, const struct rectangle *at, int multiplicity, bool pair)
{
	REAL middle = WITH_BITS(128);
	*zero = (struct zero){ 0, 0, multiplicity, pair };
	if (at) {
		mpfi_mid(middle, at->re);
		zero->re = mpfr_get_d(middle, MPFR_RNDN);
		mpfi_mid(middle, at->im);
		zero->im = mpfr_get_d(middle, MPFR_RNDN);
	}
}

static int roots_of(const struct model *model, const struct transfer *t, struct poly p, struct zero **list)
{
	int count = 0;
	*list = ARRAY(struct zero, p.length + 1);
	if (p.length < 2)
		return 0;
	INTEGER content = INTEGER_ZERO;
	struct spectrum *spectrum = spectrum_of(poly_primitive(p, content));
	if (!spectrum_refine(spectrum, 128))
		error(model->request.at.step, NULL,
		      "two zeros or poles of %s over %s are too close to each other to be "
						  "told apart", t->output, t->drive);
	if (spectrum->zero)
		add_zero(&(*list)[count++], NULL, spectrum->zero, false);
	for (int f = 0; f < spectrum->factors; f++)
		for (int i = 0; i < spectrum->poles[f]; i++)
			add_zero(&(*list)[count++], &spectrum->pole[f][i].at, spectrum->factor[f].multiplicity,
				 !spectrum->pole[f][i].real);
	return count;
}

int zeros_of_transfer(const struct model *model, const struct transfer *t, struct zero **list)
{
	return roots_of(model, t, t->N, list);
}

/* ---- its values on the imaginary axis ---- */

/* N(s)/D(s) there */
static void enclose_quotient(const struct transfer *t, double hertz, struct rectangle *z, int precision)
{
	RECTANGLE s = new_rectangle(precision), D = new_rectangle(precision);
	mpfi_const_pi(s.im);
	mpfi_mul_2ui(s.im, s.im, 1);
	mpfi_mul_d(s.im, s.im, hertz);
	rectangle_evaluate(z, t->N, &s);
	rectangle_evaluate(&D, t->D, &s);
	rectangle_div(z, z, &D);
}

/* The nearest double, whatever the target; false: its ends have not the same */
static bool round_double(mpfi_srcptr x, double *d)
{
	*d = mpfr_get_d(&x->left, MPFR_RNDN);
	return *d == mpfr_get_d(&x->right, MPFR_RNDN);
}

/* e^{-2 pi i f d}, exact at quarters of a turn */
static void enclose_delay(struct rectangle *z, double hertz, mpq_srcptr delay)
{
	static const int cosine[] = { 1, 0, -1, 0 };
	RATIONAL quarters = ZERO, whole = ZERO;
	mpq_set_d(quarters, hertz);
	mpq_mul(quarters, quarters, delay);
	mpq_mul_2exp(quarters, quarters, 2);
	if (mpz_cmp_ui(mpq_denref(quarters), 1) == 0) {
		const unsigned long quarter = mpz_fdiv_ui(mpq_numref(quarters), 4);
		mpfi_set_si(z->re, cosine[quarter]);
		mpfi_set_si(z->im, cosine[(quarter + 1) % 4]);
		return;
	}
	RECTANGLE a = new_rectangle((int)mpfi_get_prec(z->re));
	mpfi_const_pi(a.im);
	mpfi_div_si(a.im, a.im, -2);
	mpfi_set_ui(a.re, 0);
	rectangle_exp(z, &a, quarters);
}

/* The sum over one input and what it was earlier, scale and all; `size`: about log2 of the largest term */
static void enclose_sum(const struct transfer *t, double hertz, struct rectangle *sum, long *size)
{
	const int precision = (int)mpfi_get_prec(sum->re);
	RECTANGLE z = new_rectangle(precision), turned = new_rectangle(precision);
	*size = NO_SIZE;
	mpfi_set_ui(sum->re, 0);
	mpfi_set_ui(sum->im, 0);
	for (; t; t = t->earlier) {
		if (t->N.length == 0)
			continue;
		enclose_quotient(t, hertz, &z, precision);
		enclose_delay(&turned, hertz, t->delay);
		rectangle_mul(&z, &z, &turned);
		mpfi_mul_q(z.re, z.re, t->scale);
		mpfi_mul_q(z.im, z.im, t->scale);
		mpfi_add(sum->re, sum->re, z.re);
		mpfi_add(sum->im, sum->im, z.im);
		*size = rectangle_size(&z) > *size ? rectangle_size(&z) : *size;
	}
}

/* |H| and, in degrees from -180 up to 180, its angle; a number below 0 is at -180. Both rounded to nearest, once */
static bool round_polar(mpq_srcptr scale, const struct rectangle *z, double *size, double *angle)
{
	int precision = (int)mpfi_get_prec(z->re);
	INTERVAL x = OVER_BITS(precision), pi = OVER_BITS(precision);
	mpfi_hypot(x, z->re, z->im);
	mpfi_mul_q(x, x, scale);
	mpfi_abs(x, x);
	bool found = round_double(x, size) && isfinite(*size), negative = mpq_sgn(scale) < 0;
	if (found && mpfi_is_zero(z->im)) {
		*angle = mpfi_is_neg(z->re) != negative ? -180 : 0;
	} else if (found) {
		INTERVAL re = OVER_BITS(precision), im = OVER_BITS(precision);
		mpfi_set(re, z->re);
		mpfi_set(im, z->im);
		if (negative) {
			mpfi_neg(re, re);
			mpfi_neg(im, im);
		}
		mpfi_const_pi(pi);
		mpfi_atan2(x, im, re);
		mpfi_mul_ui(x, x, 180);
		mpfi_div(x, x, pi);
		found = round_double(x, angle);
	}
	return found;
}

/* Terms that cancel leave 0: an enclosure of that has no digits, however small it becomes */
static void sum_at(const struct transfer *t, double hertz, double *size, double *angle)
{
	RATIONAL one = RATIO(1, 1);
	for (int precision = 128; precision <= 1024; precision *= 2) {
		RECTANGLE z = new_rectangle(precision);
		long most;
		enclose_sum(t, hertz, &z, &most);
		if (rectangle_size(&z) < most - 512 || round_polar(one, &z, size, angle))
			return;
	}
	*size = HUGE_VAL;
	*angle = 0;
}

void transfer_at(const struct transfer *t, double hertz, double *size, double *angle)
{
	*size = *angle = 0;
	if (t->earlier) {
		sum_at(t, hertz, size, angle);
		return;
	}
	if (t->N.length == 0)
		return;
	bool found = false;
	for (int precision = 128; !found && precision <= LIMIT_PRECISION; precision *= 2) {
		RECTANGLE z = new_rectangle(precision);
		enclose_quotient(t, hertz, &z, precision);
		found = round_polar(t->scale, &z, size, angle);
	}
	if (!found)                     /* no frequency but 0 is a pole: others are rational multiples of pi */
		*size = HUGE_VAL;
}

/* ---- its angle, which goes on from one frequency to the next ---- */

static int lowest(struct poly p)
{
	return mpz_sgn(p.c[poly_valuation(p)]);
}

struct angle_course angle_course_of(const struct model *model, const struct transfer *t)
{
	struct angle_course c = { 0 };
	if (t->N.length == 0)
		return c;
	c.zeros = roots_of(model, t, t->N, &c.zero);
	c.poles = roots_of(model, t, t->D, &c.pole);
	c.start = mpq_sgn(t->scale) * lowest(t->N) * lowest(t->D) < 0 ? -180 : 0;
	return c;
}

/* What they turn H by from frequency 0 to w, those at 0 a quarter each; one on the axis as if it were left of it */
static double turn_of(int count, const struct zero *root, double w)
{
	double turn = 0;
	for (int i = 0; i < count; i++) {
		const struct zero *r = &root[i];
		double by = atan2(w - r->im, fabs(r->re)) + (r->pair ? atan2(w + r->im, fabs(r->re)) : 0);
		turn += (r->re > 0 ? -1 : 1) * r->multiplicity * by;
	}
	return turn * (180 / 3.141592653589793);
}

double angle_on_course(const struct angle_course *c, double hertz, double angle)
{
	double w = 6.283185307179586 * hertz;
	double about = c->start + turn_of(c->zeros, c->zero, w) - turn_of(c->poles, c->pole, w);
	return angle + 360 * rint((about - angle) / 360);
}
