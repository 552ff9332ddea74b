/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The form modal: a step of modes instead of states. Each pole p of the upper half plane has one complex number z =
 * w . y, of which a step is z <- e^{p h} z + loads; y = 2 Re sum of v z. v and w are the parts of the residue v w^T of
 * (s I - A)^-1 at p: P(p) v = 0, u^T P(p) = 0, and over the coordinates and their velocities
 *
 *     v = (v, p v),   w = (u^T (M p + C), u^T M) / d,   d = u^T P'(p) v = u^T (2 M p + C) v
 *
 * all enclosed, and each number rounded once. v is scaled to 1 in its largest coordinate, so z is in units of one. */
#include "inner.h"

#include <math.h>

enum {
	MODE_BITS = 320,            /* of the first enclosure; doubled while a number is not decided */
	MODE_LIMIT = 2560,
	NOTHING = 160               /* below 2^-160 of the largest in its vector, a part counts as 0 */
};

/* ---- null vectors of P(p) ---- */

/* M p^2 + C p + K, its transpose where wanted */
static struct rectangle *stiffness_at(const struct linear *system, const struct rectangle *p, bool transposed)
{
	const int n = system->n, precision = (int)mpfi_get_prec(p->re);
	struct rectangle *P = rectangles(n * n, precision);
	RECTANGLE square = new_rectangle(precision);
	rectangle_mul(&square, p, p);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			struct rectangle *cell = &P[transposed ? j * n + i : i * n + j];
			mpfi_set_q(cell->re, system->K[i * n + j]);
			rectangle_add_scaled(cell, p, system->C[i * n + j]);
			rectangle_add_scaled(cell, &square, system->M[i * n + j]);
		}
	return P;
}

/* ---- one mode ---- */

struct mode_vectors {
	int states, precision;
	struct rectangle p, power;  /* e^{p h} */
	struct rectangle *u;        /* per equation, over d: what a force gives */
	struct rectangle *v, *w;    /* per state of the block */
};

static bool null_vectors(const struct linear *system, const struct mode_vectors *m)
{
	const int n = system->n;
	RECTANGLES *P = stiffness_at(system, &m->p, false), *transposed = NULL;
	if (!null_rectangles(n, P, m->v))
		return false;
	scale_rectangles(n, m->v);
	if (rational_symmetric(n, system->M) && rational_symmetric(n, system->C) && rational_symmetric(n, system->K)) {
		for (int i = 0; i < n; i++)
			rectangle_set(&m->u[i], &m->v[i]);
		return true;
	}
	transposed = stiffness_at(system, &m->p, true);
	return null_rectangles(n, transposed, m->u);
}

/* row j of factor M p + C, times u: u^T (factor M p + C) */
static void weigh(const struct linear *system, const struct mode_vectors *m, const mpq_t *A, struct rectangle *row)
{
	const int n = system->n;
	for (int j = 0; j < n; j++)
		for (int i = 0; i < n; i++)
			rectangle_add_scaled(&row[j], &m->u[i], A[i * n + j]);
}

/* u over d; w; velocities of v */
static bool complete_vectors(const struct linear *system, const struct mode_vectors *m)
{
	const int n = system->n, precision = m->precision;
	RECTANGLES *mass = rectangles(n, precision), *damping = rectangles(n, precision);
	RECTANGLE d = new_rectangle(precision);
	weigh(system, m, system->M, mass);
	weigh(system, m, system->C, damping);
	for (int j = 0; j < n; j++) {
		struct rectangle *row = &m->w[j];
		rectangle_add_product(row, &mass[j], &m->p);
		mpfi_add(row->re, row->re, damping[j].re);
		mpfi_add(row->im, row->im, damping[j].im);
		rectangle_add_product(&d, row, &m->v[j]);
	}
	/* d = (M p + C) v + M p v */
	for (int j = 0; j < n; j++) {
		RECTANGLE again = new_rectangle(precision);
		rectangle_mul(&again, &mass[j], &m->p);
		rectangle_add_product(&d, &again, &m->v[j]);
	}
	const bool good = !mpfi_has_zero(d.re) || !mpfi_has_zero(d.im);
	for (int j = 0; j < n && good; j++) {
		rectangle_div(&m->w[j], &m->w[j], &d);
		rectangle_div(&m->u[j], &m->u[j], &d);
		if (system->velocity[j] < 0)
			continue;
		rectangle_div(&m->w[system->velocity[j]], &mass[j], &d);
		rectangle_mul(&m->v[system->velocity[j]], &m->v[j], &m->p);
	}
	return good;
}

/* z + sum of factor times part; the size of the largest term, beside which a sum may be nothing */
static long add_terms(int count, const struct rectangle *part, const mpq_t *factor, const int *place,
		      struct rectangle *z)
{
	long largest = NO_SIZE;
	for (int i = 0; i < count; i++) {
		mpq_srcptr q = factor[place ? place[i] : i];
		const long size = mpq_sgn(q) ? rectangle_size(&part[i]) + rational_bits(q) : NO_SIZE;
		rectangle_add_scaled(z, &part[i], q);
		largest = size > largest ? size : largest;
	}
	return largest;
}

/* u^T force / d */
static long driven(const struct linear *system, const struct mode_vectors *m, const mpq_t *force, struct rectangle *z)
{
	return add_terms(system->n, m->u, force, NULL, z);
}

/* integral over 0..h of e^{p (h-s)} e^{q s} ds = (e^{q h} - e^{p h}) / (q - p); false: q may be p */
static bool convolve(const struct mode_vectors *m, mpq_srcptr h, const struct rectangle *q, struct rectangle *z)
{
	RECTANGLE difference = new_rectangle(m->precision);
	rectangle_sub(&difference, q, &m->p);
	const bool good = !mpfi_has_zero(difference.re) || !mpfi_has_zero(difference.im);
	if (good) {
		rectangle_exp(z, q, h);
		rectangle_sub(z, z, &m->power);
		rectangle_div(z, z, &difference);
	}
	return good;
}

/* The integrals of e^{p (h-s)} and of s e^{p (h-s)} over the step */
static void convolve_ramp(const struct mode_vectors *m, mpq_srcptr h, struct rectangle *held, struct rectangle *ramp)
{
	if (mpfi_is_zero(m->p.re) && mpfi_is_zero(m->p.im)) {
		mpfi_set_q(held->re, h);
		mpfi_set_ui(held->im, 0);
		mpfi_mul_q(ramp->re, held->re, h);
		mpfi_div_ui(ramp->re, ramp->re, 2);
		mpfi_set_ui(ramp->im, 0);
		return;
	}
	rectangle_set(held, &m->power);
	mpfi_sub_ui(held->re, held->re, 1);
	rectangle_div(held, held, &m->p);
	rectangle_set(ramp, held);
	mpfi_sub_q(ramp->re, ramp->re, h);
	rectangle_div(ramp, ramp, &m->p);
}

/* ---- rounded ---- */

static bool round_part(mpfi_srcptr x, long largest, double *value)
{
	if (round_enclosure(x, value))
		return isfinite(*value);
	*value = 0;
	return interval_size(x) < largest - NOTHING;
}

struct filling {                      /* being filled */
	const struct step *step;
	struct modal *modal;
	const struct block *block;
	int re, im;                 /* modal states of the mode; im -1: its pole is real */
};

/* To the rows of the mode; `twice`: it stands for its conjugate as well */
static bool put_rows(const struct filling *f, const struct rectangle *z, long largest, double *table, int columns,
		     int column)
{
	return round_part(z->re, largest, &table[f->re * columns + column]) &&
	       (f->im < 0 || round_part(z->im, largest, &table[f->im * columns + column]));
}

/* 2 Re (v z) = 2 Re v re - 2 Im v im */
static bool put_columns(const struct filling *f, const struct rectangle *v, long largest, double *row)
{
	bool good = round_part(v->re, largest, &row[f->re]);
	if (f->im < 0 || !good)
		return good;
	good = round_part(v->im, largest, &row[f->im]);
	row[f->re] *= 2;
	row[f->im] *= -2;
	if (row[f->im] == 0)
		row[f->im] = 0;
	return good && isfinite(row[f->re]) && isfinite(row[f->im]);
}

static long largest_of(const struct rectangle *z, int from, int to)
{
	long largest = NO_SIZE;
	for (int i = from; i < to; i++)
		largest = rectangle_size(&z[i]) > largest ? rectangle_size(&z[i]) : largest;
	return largest;
}

static bool put_vectors(const struct filling *f, const struct mode_vectors *m)
{
	const struct linear *system = &f->block->system;
	const int n = f->modal->states, split = system->n;
	bool good = true;
	for (int i = 0; i < m->states && good; i++) {
		const int state = f->block->state[i], from = i < split ? 0 : split, to = i < split ? split : m->states;
		good = put_rows(f, &m->w[i], largest_of(m->w, from, to), f->modal->to, n, state) &&
		       put_columns(f, &m->v[i], largest_of(m->v, from, to), &f->modal->from[state * n]);
	}
	return good;
}

static bool put_outputs(const struct filling *f, const struct mode_vectors *m)
{
	const struct model *model = f->step->model;
	bool good = true;
	for (int o = 0; o < model->outputs && f->modal->output && good; o++) {
		RECTANGLE sum = new_rectangle(m->precision);
		const long largest = add_terms(m->states, m->v, model->output[o].state, f->block->state, &sum);
		good = put_columns(f, &sum, largest, &f->modal->output[o * f->modal->states]);
	}
	return good;
}

static bool put_inputs(const struct filling *f, const struct mode_vectors *m)
{
	const struct linear *system = &f->block->system;
	mpq_srcptr h = f->step->model->h;
	RECTANGLE held = new_rectangle(m->precision), ramp = new_rectangle(m->precision);
	bool good = true;
	RATIONAL rate = ZERO;
	mpq_inv(rate, h);
	convolve_ramp(m, h, &held, &ramp);
	for (int k = 0, column = 0; k < system->inputs && good; column += system->input[k++].hold ? 2 : 1) {
		RECTANGLE force = new_rectangle(m->precision), slope = new_rectangle(m->precision),
			  z = new_rectangle(m->precision);
		long largest = driven(system, m, system->input[k].force[0], &force);
		const long other = driven(system, m, system->input[k].force[1], &slope);
		largest = (other > largest ? other : largest) + rectangle_size(&held);
		if (!system->input[k].hold) {
			rectangle_mul(&z, &force, &held);
			good = put_rows(f, &z, largest, f->modal->input, f->modal->inputs, column);
			continue;
		}
		/* u0 (1 - s/h) + u1 s/h, and its slope (u1 - u0)/h */
		rectangle_mul(&z, &force, &ramp);
		rectangle_add_product(&z, &slope, &held);
		mpfi_mul_q(z.re, z.re, rate);
		mpfi_mul_q(z.im, z.im, rate);
		good = put_rows(f, &z, largest, f->modal->input, f->modal->inputs, column + 1);
		mpfi_neg(z.re, z.re);
		mpfi_neg(z.im, z.im);
		rectangle_add_product(&z, &force, &held);
		good = good && put_rows(f, &z, largest, f->modal->input, f->modal->inputs, column);
	}
	return good;
}

static void halve(struct rectangle *z)
{
	mpfi_div_ui(z->re, z->re, 2);
	mpfi_div_ui(z->im, z->im, 2);
}

/* e^{(a + iw) s} and its conjugate, turned: the load's cosine and sine, in the mode */
static bool put_oscillation(const struct filling *f, const struct mode_vectors *m, const struct load *load, int column)
{
	const struct linear *system = &f->block->system;
	const int bits = m->precision;
	RECTANGLE q = new_rectangle(bits), plus = new_rectangle(bits), minus = new_rectangle(bits),
		  cosine = new_rectangle(bits), sine = new_rectangle(bits), z = new_rectangle(bits);
	RECTANGLES *force = rectangles(2, bits);
	mpfi_set_q(q.re, load->forcing->a);
	mpfi_set_q(q.im, load->forcing->w);
	bool good = convolve(m, f->step->model->h, &q, &plus);
	mpfi_neg(q.im, q.im);
	good = good && convolve(m, f->step->model->h, &q, &minus);
	long largest = NO_SIZE;
	for (int k = 0; k < 2; k++) {
		const long size = driven(system, m, load->force[k], &force[k]) + rectangle_size(&plus);
		largest = size > largest ? size : largest;
	}
	if (good) {                     /* cos = (plus + minus)/2, sin = (plus - minus)/(2 i) */
		mpfi_add(cosine.re, plus.re, minus.re);
		mpfi_add(cosine.im, plus.im, minus.im);
		mpfi_sub(sine.re, plus.im, minus.im);
		mpfi_sub(sine.im, minus.re, plus.re);
		halve(&cosine);
		halve(&sine);
		rectangle_mul(&z, &force[0], &cosine);
		rectangle_add_product(&z, &force[1], &sine);
		good = put_rows(f, &z, largest, f->modal->load, f->modal->loads, column);
		rectangle_mul(&z, &force[1], &cosine);
		mpfi_neg(sine.re, sine.re);
		mpfi_neg(sine.im, sine.im);
		rectangle_add_product(&z, &force[0], &sine);
		good = good && put_rows(f, &z, largest, f->modal->load, f->modal->loads, column + 1);
	}
	return good;
}

/* e^{a s}, a constant where a is 0 */
static bool put_growth(const struct filling *f, const struct mode_vectors *m, const struct load *load, int column)
{
	const int bits = m->precision;
	RECTANGLE q = new_rectangle(bits), z = new_rectangle(bits), ramp = new_rectangle(bits),
		  force = new_rectangle(bits);
	bool good = true;
	mpfi_set_q(q.re, load->forcing->a);
	if (mpq_sgn(load->forcing->a) == 0)
		convolve_ramp(m, f->step->model->h, &z, &ramp);
	else
		good = convolve(m, f->step->model->h, &q, &z);
	const long largest = driven(&f->block->system, m, load->force[0], &force) + rectangle_size(&z);
	rectangle_mul(&z, &z, &force);
	return good && put_rows(f, &z, largest, f->modal->load, f->modal->loads, column);
}

static bool put_loads(const struct filling *f, const struct mode_vectors *m)
{
	const struct linear *system = &f->block->system;
	bool good = true;
	for (int l = 0, column = 0; l < system->loads && good; column += system->load[l++].columns) {
		const struct load *load = &system->load[l];
		if (!load_acts(system, load))
			continue;
		good = (oscillates(load->forcing) ? put_oscillation : put_growth)(f, m, load, column);
	}
	return good;
}

/* What the rounding of e^{p h} does to the mode in a step: rounded / e^{p h} - 1 */
static void measure_drift(const struct filling *f, const struct mode_vectors *m)
{
	struct drift *drift = &f->modal->drift;
	RECTANGLE z = new_rectangle(m->precision);
	mpfi_set_d(z.re, f->modal->turn[f->re]);
	mpfi_set_d(z.im, f->im < 0 ? 0 : f->modal->turn[f->im]);
	if (!mpfi_has_zero(m->power.re) || !mpfi_has_zero(m->power.im)) {
		rectangle_div(&z, &z, &m->power);
		mpfi_sub_ui(z.re, z.re, 1);
		const double size = mpfi_get_d(z.re), angle = fabs(mpfi_get_d(z.im));
		drift->amplitude = fabs(size) > fabs(drift->amplitude) ? size : drift->amplitude;
		drift->phase = angle > drift->phase ? angle : drift->phase;
	}
	drift->known = true;
}

/* e^{p h} */
static bool put_power(const struct filling *f, const struct mode_vectors *m)
{
	double *turn = f->modal->turn;
	return round_part(m->power.re, rectangle_size(&m->power), &turn[f->re]) &&
	       (f->im < 0 || round_part(m->power.im, rectangle_size(&m->power), &turn[f->im]));
}

static bool put_mode(const struct filling *f, const struct pole *pole, int precision)
{
	const struct linear *system = &f->block->system;
	RECTANGLES *u = rectangles(system->n, precision), *v = rectangles(system->states, precision),
		   *w = rectangles(system->states, precision);
	struct mode_vectors m = { .states = system->states, .precision = precision, .u = u, .v = v, .w = w };
	rectangle_init(&m.p, precision);
	rectangle_init(&m.power, precision);
	if (pole)
		rectangle_set(&m.p, &pole->at);
	rectangle_exp(&m.power, &m.p, f->step->model->h);
	const bool good = null_vectors(system, &m) && complete_vectors(system, &m) && put_power(f, &m) &&
			  put_vectors(f, &m) && put_outputs(f, &m) && put_inputs(f, &m) && put_loads(f, &m);
	if (good)
		measure_drift(f, &m);
	rectangle_clear(&m.p);
	rectangle_clear(&m.power);
	return good;
}

/* ---- all of them ---- */

/* Pairs first, then what is real: so one loop turns all pairs. */
static void count_modes(struct modal *modal, struct spectrum *const *spectrum, int blocks)
{
	for (int b = 0; b < blocks; b++) {
		modal->reals += spectrum[b]->zero;
		for (int f = 0; f < spectrum[b]->factors; f++)
			for (int i = 0; i < spectrum[b]->poles[f]; i++)
				*(spectrum[b]->pole[f][i].real ? &modal->reals : &modal->pairs) += 1;
	}
}

static bool fill_mode(struct filling *f, struct spectrum *spectrum, int factor, int i, int *pair, int *real)
{
	const bool is_real = factor < 0 || spectrum->pole[factor][i].real;
	f->re = is_real ? 2 * f->modal->pairs + (*real)++ : (*pair)++;
	f->im = is_real ? -1 : f->modal->pairs + f->re;
	progress("modes of the step", *pair + *real - 1, f->modal->pairs + f->modal->reals);
	for (int precision = MODE_BITS; precision <= MODE_LIMIT; precision *= 2)
		if (spectrum_refine(spectrum, precision) &&
		    put_mode(f, factor < 0 ? NULL : &spectrum->pole[factor][i], precision))
			return true;
	return false;
}

/* What states lose that become modes and states again: the largest sum over the modes of |v_i w_i|, 1 at best */
static double condition_of(const struct modal *modal)
{
	const int n = modal->states;
	double largest = 0;
	for (int i = 0; i < n; i++) {
		double sum = 0;
		for (int k = 0; k < n; k++) {
			const bool pair = k < modal->pairs;
			const int other = pair ? modal->pairs + k : k;
			if (k >= modal->pairs && k < 2 * modal->pairs)
				continue;
			const double v = pair ? hypot(modal->from[i * n + k], modal->from[i * n + other])
					      : fabs(modal->from[i * n + k]);
			const double w = pair ? hypot(modal->to[k * n + i], modal->to[other * n + i])
					      : fabs(modal->to[k * n + i]);
			sum += v * w;
		}
		largest = sum > largest ? sum : largest;
	}
	return largest;
}

static struct modal *modal_new(const struct step *step)
{
	const struct linear *system = &step->branch->system;
	struct modal *modal = NEW(struct modal);
	const size_t n = (size_t)system->states;
	modal->states = system->states;
	modal->loads = load_columns(system);
	modal->inputs = input_columns(system);
	modal->turn = ARRAY(double, n);
	modal->to = ARRAY(double, n * n);
	modal->from = ARRAY(double, n * n);
	modal->load = ARRAY(double, n * (size_t)modal->loads);
	modal->input = ARRAY(double, n * (size_t)modal->inputs);
	if (step->model->declared_outputs)
		modal->output = ARRAY(double, n * (size_t)step->model->outputs);
	return modal;
}

struct modal *modal_of(const struct step *step)
{
	struct block *block;
	const int blocks = blocks_of(&step->branch->system, &block);
	struct spectrum **spectrum = ARRAY(struct spectrum *, blocks);
	struct modal *modal = modal_new(step);
	struct filling f = { .step = step, .modal = modal };
	int pair = 0, real = 0;
	bool good = true;
	INTEGER content = INTEGER_ZERO;
	for (int b = 0; b < blocks && good; b++) {
		struct resolvent *resolvent = resolvent_of(&block[b].system);
		spectrum[b] = spectrum_of(poly_primitive(*resolvent_determinant(resolvent), content));
		good = spectrum_refine(spectrum[b], MODE_BITS);
	}
	if (good)
		count_modes(modal, spectrum, blocks);
	for (int b = 0; b < blocks && good; b++) {
		f.block = &block[b];
		for (int i = 0; i < spectrum[b]->zero && good; i++)
			good = fill_mode(&f, spectrum[b], -1, 0, &pair, &real);
		for (int k = 0; k < spectrum[b]->factors && good; k++)
			for (int i = 0; i < spectrum[b]->poles[k] && good; i++)
				good = fill_mode(&f, spectrum[b], k, i, &pair, &real);
	}
	progress_end();
	if (good)
		modal->condition = condition_of(modal);
	return good ? modal : NULL;
}
