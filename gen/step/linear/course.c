/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The exact course of a model over its first steps, and how far an error made in it reaches. */
#include "model/linear/relative.h"
#include "course.h"
#include "inner.h"

#include <math.h>

enum {
	STEPS = 1000,
	BITS = 320,
	SPARE = 64,                     /* of these; what is left tells what is 0 */
	LIMIT_SIZE = 64,
	LIMIT_COURSE_STATES = 32,
	LIMIT_SEGMENTS = 16
};

struct segment_flow { mpfr_t *E; };         /* of one segment of time: e^{A h} of the series' matrix */

static bool make_flow(const struct step *step, const struct layout *place, int segment, struct segment_flow *flow)
{
	int size = place->size;
	struct taylor *taylor =
		taylor_of(size, augmented_matrix(place, &step->branch->system, segment), step->model->h);
	if (!taylor_enclose(taylor, BITS))
		return false;
	flow->E = reals((size_t)(size * size), BITS);
	INTERVAL value = OVER_BITS(BITS);
	for (int i = 0; i < size * size; i++) {
		taylor_entry(taylor, i / size, i % size, value);
		mpfi_mid(flow->E[i], value);
	}
	return true;
}

/* A sum of which all but the last digits cancel is 0, as that of a state that stays at 0 by symmetry: its last digits
 * are those that factors are rounded by. */
static void sum_row(int size, const mpfr_t *factor, const mpfr_t *x, mpfr_t sum)
{
	mpfr_exp_t largest = mpfr_get_emin();
	mpfr_set_zero(sum, 1);
	for (int j = 0; j < size; j++) {
		if (mpfr_zero_p(factor[j]) || mpfr_zero_p(x[j]))
			continue;
		mpfr_fma(sum, factor[j], x[j], sum, MPFR_RNDN);
		mpfr_exp_t exponent = mpfr_get_exp(factor[j]) + mpfr_get_exp(x[j]);
		largest = exponent > largest ? exponent : largest;
	}
	if (!mpfr_zero_p(sum) && mpfr_get_exp(sum) < largest - (mpfr_exp_t)(BITS - SPARE))
		mpfr_set_zero(sum, 1);
}

static void advance(int size, const mpfr_t *E, mpfr_t *x, mpfr_t *next)
{
	for (int i = 0; i < size; i++)
		sum_row(size, E + i * size, (const mpfr_t *)x, next[i]);
	for (int i = 0; i < size; i++)
		mpfr_swap(x[i], next[i]);
}

static int segment_at(const struct linear *system, mpq_srcptr t)
{
	int segment = 0;
	while (segment < system->segments - 1 && mpq_cmp(system->change[segment], t) <= 0)
		segment++;
	return segment;
}

static bool note_course(const struct step *step, const struct layout *place, const mpfr_t *x, struct course *c, int k)
{
	int states = step->branch->system.states, columns = step->branch->full->columns;
	bool finite = true;
	REAL sum = WITH_BITS(BITS);
	for (int i = 0; i < c->rows; i++) {
		const mpfr_t *row = i < states ? NULL : c->written + (i - states) * (states + 1);
		if (row) {
			sum_row(states, row, x, sum);
			mpfr_add(sum, sum, row[states], MPFR_RNDN);
		}
		double y = mpfr_get_d(row ? sum : x[i], MPFR_RNDN);
		c->y[k * c->rows + i] = y;
		c->largest[i] = fmax(c->largest[i], fabs(y));
		finite = finite && isfinite(y);
	}
	for (int l = 0, column = 0; l < step->branch->system.loads; l++)
		for (int j = 0; j < step->branch->system.load[l].columns; j++, column++) {
			double z = place->load[l] < 0 ? 0 : mpfr_get_d(x[place->load[l] + j], MPFR_RNDN);
			c->z[k * columns + column] = z;
			finite = finite && isfinite(z);
		}
	return finite;
}

/* Step by step, from the spec's initial values, inputs 0; a change of formula is taken at the step after it: sizes
 * matter here. */
static bool follow(const struct step *step, const struct layout *place, struct course *c)
{
	int size = place->size;
	REALS *x = reals(size, BITS), *next = reals(size, BITS);
	struct segment_flow *flow = ARRAY(struct segment_flow, step->branch->system.segments);
	RATIONAL t = ZERO, value = ZERO;
	for (int i = 0; i < step->branch->system.states; i++)
		mpfr_set_q(x[i], step->model->initial[i], MPFR_RNDN);
	for (int l = 0; l < step->branch->system.loads; l++)
		for (int j = 0; j < step->branch->system.load[l].columns && place->load[l] >= 0; j++) {
			load_state(&step->branch->system.load[l], j, t, value);
			mpfr_set_q(x[place->load[l] + j], value, MPFR_RNDN);
		}
	bool good = true;
	for (int k = 0; k <= c->steps && good; k++) {
		mpq_set_si(t, k, 1);
		mpq_mul(t, t, step->model->h);
		c->segment[k] = segment_at(&step->branch->system, t);
		good = note_course(step, place, (const mpfr_t *)x, c, k);
		struct segment_flow *now = &flow[c->segment[k]];
		good = good && (now->E || make_flow(step, place, c->segment[k], now));
		if (good)
			advance(size, (const mpfr_t *)now->E, x, next);
	}
	for (int s = 0; s < step->branch->system.segments; s++)
		clear_reals(&flow[s].E);
	return good;
}

double written_factor(const struct course *c, int n, int i, int k)
{
	return mpfr_get_d(c->written[i * (n + 1) + k], MPFR_RNDN);
}

static double *written_factors(const struct course *c, int n)
{
	double *factor = ARRAY(double, (size_t)((c->rows - n) * n) + 1);
	for (int at = 0; at < (c->rows - n) * n; at++)
		factor[at] = written_factor(c, n, at / n, at % n);
	return factor;
}

/* What the rows read of a power of Phi, whose own are the first */
static void read_power(const struct course *c, int n, const double *factor, double *power)
{
	for (int i = 0; i < c->rows - n; i++) {
		double *sum = power + (n + i) * n;
		for (int j = 0; j < n; j++)
			sum[j] = 0;
		for (int k = 0; k < n; k++)
			for (int j = 0; j < n && factor[i * n + k] != 0; j++)
				sum[j] += factor[i * n + k] * power[k * n + j];
	}
}

/* How far errors reach: what one at each step adds up to at most, and the most that becomes of one */
static bool add_powers_of_phi(const struct step *step, struct course *c)
{
	int n = step->branch->system.states;
	const size_t cells = (size_t)(c->rows * n);
	const double *factor = written_factors(c, n);
	double *power = ARRAY(double, cells), *next = ARRAY(double, cells), largest = 0;
	c->sum = ARRAY(double, cells);
	c->peak = ARRAY(double, cells);
	for (int i = 0; i < n; i++)
		power[i * n + i] = 1;
	for (int m = 0; m < c->steps; m++) {
		read_power(c, n, factor, power);
		for (size_t i = 0; i < cells; i++) {
			c->sum[i] += fabs(power[i]);
			c->peak[i] = fmax(c->peak[i], fabs(power[i]));
			largest = fmax(largest, c->sum[i]);
			next[i] = 0;
		}
		for (int i = 0; i < n; i++)
			for (int k = 0; k < n; k++)
				for (int j = 0; j < n && !step->branch->full->Phi[i * n + k].zero; j++)
					next[i * n + j] += step->branch->full->Phi[i * n + k].value * power[k * n + j];
		double *swap = power;
		power = next;
		next = swap;
	}
	return isfinite(largest);
}

static const mpfr_t *rounded_rows(const struct model *model)
{
	const int cells = model->system.states * (model->system.states + 1);
	const mpq_t *exact = relative_rows(model);
	mpfr_t *row = reals((size_t)cells, BITS);
	for (int i = 0; i < cells; i++)
		mpfr_set_q(row[i], exact[i], MPFR_RNDN);
	return (const mpfr_t *)row;
}

/* Where a model is stepped in several ways it is followed once. */
bool make_course(const struct step *step, struct course *c)
{
	static const struct model *last;
	static struct course followed;
	static bool good;
	const bool relative = step->model->relative != NULL;
	size_t states = (size_t)step->branch->system.states, step_map = relative ? 2 * states : states,
		rows = STEPS + 1;
	struct layout place = layout_of(&step->branch->system, 0);
	if (place.size > LIMIT_SIZE || step->branch->system.states > LIMIT_COURSE_STATES ||
	    step->branch->system.segments > LIMIT_SEGMENTS)
		return false;
	if (last != step->model) {
		followed = (struct course){ .steps = STEPS,
					    .rows = (int)step_map,
					    .written = relative ? rounded_rows(step->model) : NULL,
					    .y = ARRAY(double, rows *step_map),
					    .z = ARRAY(double, rows *(size_t)step->branch->full->columns),
					    .segment = ARRAY(int, rows),
					    .largest = ARRAY(double, step_map) };
		good = follow(step, &place, &followed);
		last = step->model;
	}
	*c = followed;
	return good && add_powers_of_phi(step, c);
}
