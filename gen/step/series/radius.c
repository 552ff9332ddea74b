/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far a Taylor series reaches from the start, for a reader: its coefficients at t = 0, inputs 0;
 * from how they fall an estimate of the radius of convergence; how many steps they serve. Nothing emitted reads it. */
#include "inner.h"
#include "model/reads.h"

#include <float.h>
#include <math.h>

enum { LOOKED_AT = 40, WINDOW = 7, WINDOWS = 3, ENVELOPES = 4 };

struct values {
	const struct step *step;
	const struct linear *system;
	const struct expansion *x;
	int segment;
	long double **c;            /* per state */
};

/* ---- the coefficients ---- */

static double column_at_start(const struct load *load, int column)
{
	bool turns = oscillates(load->forcing);
	double phase = mpq_get_d(load->forcing->p);
	if (column / (turns ? 2 : 1) > 0)               /* t^k */
		return 0;
	return turns ? column ? sin(phase) : cos(phase) : 1;
}

static void set_param(const struct model *model, int held, mpfr_ptr value)
{
	RATIONAL exact = ZERO;
	param_value(held_symbol(model, held), exact);
	mpfr_set_q(value, exact, MPFR_RNDN);
}

/* At t = 0; conditions on time as they are just after it */
static void operand_at_start(const void *context, const struct tape_node *n, mpfr_ptr value)
{
	const struct values *v = context;
	const struct model *model = v->step->model;
	int place = (n->index * v->system->segments + v->segment) * (v->x->order + 1) + n->part;
	switch (n->op) {
	case TAPE_STATE: mpfr_set_q(value, model->initial[n->index], MPFR_RNDN); break;
	case TAPE_LOAD:  mpfr_set_d(value, column_at_start(&v->system->load[n->index], n->part), MPFR_RNDN); break;
	case TAPE_PARAM: set_param(model, n->index, value); break;
	case TAPE_TIME:  mpfr_set_d(value, n->part ? 1e-9 * mpq_get_d(model->h) : 0, MPFR_RNDN); break;
	case TAPE_TABLE: mpfr_set_d(value, v->x->changing[place], MPFR_RNDN); break;
	default:         mpfr_set_zero(value, 1);
	}
}

static struct values evaluate(const struct step *step)
{
	const struct linear *system = &step->branch->system;
	struct values v = { .step = step, .system = system, .x = expansion_of(step, LOOKED_AT) };
	while (v.segment < system->segments - 1 && mpq_sgn(system->change[v.segment]) <= 0)
		v.segment++;
	struct recurrences *r = recurrences_new(step, v.x, (struct series_names){ .by_numbers = true });
	int order = v.x->order, states = system->states;
	tape_ref *ref = ARRAY(tape_ref, (size_t)(states * (order + 1)));
	for (int k = 0; k <= order; k++)
		for (int i = 0; i < states; i++)
			ref[i * (order + 1) + k] = recurrence(r, i, k);
	struct tape_values from = { operand_at_start, &v };
	int length = tape_length(tape_of_recurrences(r));
	REALS *value = reals(length, LDBL_MANT_DIG);
	tape_run_mpfr(tape_of_recurrences(r), &from, value);
	v.c = ARRAY(long double *, states);
	for (int i = 0; i < states; i++) {
		v.c[i] = ARRAY(long double, order + 1);
		for (int k = 0; k <= order; k++)
			if (ref[i * (order + 1) + k] != TAPE_NONE)
				v.c[i][k] = mpfr_get_ld(value[ref[i * (order + 1) + k]], MPFR_RNDN);
	}
	return v;
}

/* ---- how they fall ---- */

/* |c_k| fall as k^-p R^-k. Of each of three windows the largest of |c_k| r^k, r what the last pass found for R, so that
 * neither zeros nor the beat of a pair of singularities counts. False: one of them has nothing but zeros. */
static bool fit(const long double *c, long double *log_radius, long double *power)
{
	long double r = 0;
	for (int pass = 0; pass < ENVELOPES; pass++) {
		long double k[WINDOWS], y[WINDOWS];
		for (int w = 0; w < WINDOWS; w++) {
			int last = LOOKED_AT - (WINDOWS - 1 - w) * (LOOKED_AT - WINDOW) / WINDOWS;
			long double most = -LDBL_MAX;
			for (int j = last - WINDOW + 1; j <= last; j++) {
				long double size = fabsl(c[j]) > 0 ? logl(fabsl(c[j])) : -LDBL_MAX;
				if (!isfinite(c[j]))
					return false;
				if (size > -LDBL_MAX && size + j * r > most) {
					most = size + j * r;
					y[w] = size;
					k[w] = j;
				}
			}
			if (most == -LDBL_MAX)
				return false;
		}
		long double early = (y[0] - y[1]) / (k[1] - k[0]), late = (y[1] - y[2]) / (k[2] - k[1]);
		long double of_early = logl(k[1] / k[0]) / (k[1] - k[0]), of_late = logl(k[2] / k[1]) / (k[2] - k[1]);
		*power = (early - late) / (of_early - of_late);
		*log_radius = early - *power * of_early;
		r = late;
	}
	return true;
}

static double find_radius(const struct values *v)
{
	enum { ENTIRE = 5 };            /* k^5 R^-k is no singularity's, but of what falls nearly as 1/k! */
	double least = INFINITY, unit = v->step->model->truncation.over * mpq_get_d(v->step->model->h);
	for (int i = 0; i < v->system->states; i++) {
		long double radius, power;
		if (fit(v->c[i], &radius, &power) && power > -ENTIRE)
			least = fmin(least, (double)expl(radius) * unit);
	}
	return least;
}

/* The last two of the scheme's order, over the size of each state */
static double remainder_at(const struct values *v, int k, double steps)
{
	double worst = 0;
	for (int i = 0; i < v->system->states; i++) {
		const long double *c = v->c[i];
		long double size = fabsl(c[0]) > 0 ? fabsl(c[0]) : fmaxl(fabsl(c[1]), fabsl(c[2]));
		double part = (double)(fabsl(c[k]) / (size > 0 ? size : 1) * powl(steps, k));
		worst = part <= worst ? worst : part;
	}
	return worst;
}

static double find_served(const struct values *v)
{
	enum { MOST_HALVINGS = 60 };
	const struct truncation *truncation = &v->step->model->truncation;
	double tolerance = mpq_get_d(truncation->tolerance), served = ldexp(1, -MOST_HALVINGS);
	int order = v->step->taylor.expansion->order;
	for (double steps = served; steps <= EXPANSION_SERVES; steps = steps < 1 ? 2 * steps : steps + 1) {
		if (!(remainder_at(v, order, steps) <= tolerance && remainder_at(v, order - 1, steps) <= tolerance))
			break;
		served = steps;
	}
	return served;
}

struct reach reach_of_series(const struct step *step)
{
	if (step->model->equations.implicit && step->taylor.expansion->functions > 0)
		return (struct reach){ .left_out = true };
	struct values v = evaluate(step);
	struct reach reach = { .known = true, .radius = find_radius(&v) };
	for (int i = 0; i < v.system->states; i++)
		for (int k = 0; k <= v.x->order; k++)
			reach.known = reach.known && isfinite(v.c[i][k]);
	if (step->model->truncation.adaptive && reach.known)
		reach.served = v.system->inputs ? fmin(find_served(&v), 1) : find_served(&v);
	return reach;
}
