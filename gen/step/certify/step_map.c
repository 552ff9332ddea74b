/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step as a map in double: what it keeps, and how large states and an output become by loads and inputs; and the
 * exact course of the model beside it. */
#include "inner.h"
#include "model/linear/relative.h"
#include "step/linear/forms.h"
#include "step/linear/images.h"

#include <math.h>

/* ---- the step as a map ---- */

double kept_mass(const struct step *step, int state)
{
	const struct linear *system = &step->branch->system;
	return step->linear.kicks.momenta && state >= system->n
		       ? mpq_get_d(step->linear.kicks.mass[system->coord[state]])
		       : 1;
}

bool is_load_forced(const struct step *step, int column)
{
	return step->forced && is_forced(step, column);
}

static void keep_states(const struct step *step, const struct step *exact, const struct output *output,
			struct step_map *k)
{
	const struct table *table = exact->branch->full;
	const int n = k->n;
	for (int i = 0; i < n; i++) {
		for (int j = 0; j < n; j++)
			k->Phi[i * n + j] = table->Phi[i * n + j].value * kept_mass(step, i) / kept_mass(step, j);
		for (int c = 0; c < k->columns; c++)
			k->load[i * k->columns + c] =
				is_load_forced(step, c) ? 0 :
				table->load[i * k->columns + c].value * kept_mass(step, i);
		for (int c = 0; c < k->inputs; c++)
			k->input[i * k->inputs + c] = table->input[i * k->inputs + c].value * kept_mass(step, i);
		k->start[i] = mpq_get_d(step->model->initial[i]) * kept_mass(step, i);
		k->row[i] = mpq_get_d(output->state[i]) / kept_mass(step, i);
	}
}

static void keep_modes(const struct step *exact, int o, struct step_map *k)
{
	const struct modal *modal = exact->modal;
	const int n = k->n, pairs = modal->pairs;
	for (int i = 0; i < n; i++) {
		const bool pair = i < 2 * pairs, re = i < pairs;
		k->Phi[i * n + i] = pair && !re ? modal->turn[i - pairs] : modal->turn[i];
		if (pair)
			k->Phi[i * n + (re ? i + pairs : i - pairs)] = re ? -modal->turn[i + pairs] : modal->turn[i];
		for (int c = 0; c < k->columns; c++)
			k->load[i * k->columns + c] = modal->load[i * k->columns + c];
		for (int c = 0; c < k->inputs; c++)
			k->input[i * k->inputs + c] = modal->input[i * k->inputs + c];
		for (int j = 0; j < n; j++)
			k->start[i] += modal->to[i * n + j] * mpq_get_d(exact->model->initial[j]);
		k->row[i] = modal->output ? modal->output[o * n + i] : modal->from[o * n + i];
	}
}

/* ---- loads ---- */

static struct forcing_of_column forcing_of_column(const struct linear *system, int column)
{
	int first;
	const struct load *load = &system->load[load_of_column(system, column, &first)];
	const bool turns = oscillates(load->forcing);
	return (struct forcing_of_column){ .power = (column - first) / (turns ? 2 : 1),
					.turns = turns,
					.sine = turns && (column - first) % 2,
					.a = mpq_get_d(load->forcing->a),
					.w = mpq_get_d(load->forcing->w),
					.p = mpq_get_d(load->forcing->p) };
}

static struct forcing_of_column *forcings_of_columns(const struct linear *system, int columns)
{
	struct forcing_of_column *forcing = ARRAY(struct forcing_of_column, columns);
	for (int c = 0; c < columns; c++)
		forcing[c] = forcing_of_column(system, c);
	return forcing;
}

double load_value(const struct forcing_of_column *p, double t)
{
	double value = p->a != 0 ? exp(p->a * t) : 1;
	if (p->turns)
		value *= (p->sine ? sin : cos)(p->w * t + p->p);
	for (int k = 0; k < p->power; k++)
		value *= t;
	return value;
}

/* The largest of |t^k e^{a t}| up to `end` */
static double largest_load(const struct forcing_of_column *p, double end)
{
	const double peak = p->a < 0 ? -p->power / p->a : end, t = peak < end ? peak : end;
	return fmax(pow(t, p->power) * exp(p->a * t), p->power ? 0 : 1);
}

/* A particular solution that is subtracted: the state starts less it, and outputs add it. */
static void keep_forced(const struct step *step, struct step_map *k)
{
	for (int i = 0; i < k->n; i++)
		for (int c = 0; c < k->columns && step->forced; c++) {
			const double part = is_load_forced(step, c)
						    ? mpq_get_d(step->forced->exact[i * k->columns + c])
						    : 0;
			k->start[i] -= part * load_value(&k->forcing[c], 0);
			k->direct[c] += k->row[i] * part;
		}
}

/* ---- what goes into the kept map ---- */

static void keep_output(const struct step *step, const struct output *output, struct step_map *k)
{
	const struct linear *system = &step->branch->system;
	for (int l = 0, c = 0; l < system->loads; l++)
		for (int j = 0; j < system->load[l].columns; j++, c++)
			k->direct[c] = mpq_get_d(output->load[l][j * system->segments]);
	for (int i = 0; i < system->inputs; i++) {
		k->feed[0][i] = mpq_get_d(output->input[0][i]);
		k->feed[1][i] = mpq_get_d(output->input[1][i]);
	}
}

static void bound_operands(const struct errors *e, struct step_map *k)
{
	const struct linear *system = &e->step->branch->system;
	const double end = mpq_get_d(e->r->until) + mpq_get_d(e->step->model->h);
	for (int c = 0; c < k->columns; c++)
		k->amplitude[c] = largest_load(&k->forcing[c], end) * (1 + 1e-9);
	for (int i = 0, c = 0; i < system->inputs; i++)
		for (int j = 0; j <= system->input[i].hold; j++, c++)
			k->most[c] = mpq_get_d(e->r->most[i]) * (1 + 1e-15);
}

/* In units in which the map is balanced */
static void balance_kept(struct step_map *k)
{
	balance_map(k->n, k->Phi, k->scale);
	for (int i = 0; i < k->n; i++) {
		for (int c = 0; c < k->columns; c++)
			k->load[i * k->columns + c] /= k->scale[i];
		for (int c = 0; c < k->inputs; c++)
			k->input[i * k->inputs + c] /= k->scale[i];
		k->start[i] /= k->scale[i];
		k->row[i] *= k->scale[i];
	}
}

struct step_map *step_map_of(const struct errors *e, const struct step *exact)
{
	const struct step *step = e->step;
	const struct output *output = &step->model->output[e->r->output];
	struct step_map *k = NEW(struct step_map);
	const size_t n = (size_t)step->branch->system.states;
	k->n = (int)n;
	k->columns = load_columns(&step->branch->system);
	k->inputs = input_columns(&step->branch->system);
	const size_t columns = (size_t)k->columns, inputs = (size_t)k->inputs;
	k->Phi = ARRAY(double, n * n);
	k->load = ARRAY(double, n * columns);
	k->input = ARRAY(double, n * inputs);
	k->start = ARRAY(double, n);
	k->row = ARRAY(double, n);
	k->direct = ARRAY(double, columns);
	k->feed[0] = ARRAY(double, inputs);
	k->feed[1] = ARRAY(double, inputs);
	k->scale = ARRAY(double, n);
	k->amplitude = ARRAY(double, columns);
	k->most = ARRAY(double, inputs);
	k->size = ARRAY(double, n);
	k->forcing = forcings_of_columns(&step->branch->system, k->columns);
	if (step->modal)
		keep_modes(exact, e->r->output, k);
	else
		keep_states(step, exact, output, k);
	keep_output(step, output, k);
	keep_forced(step, k);
	bound_operands(e, k);
	balance_kept(k);
	return k;
}

/* ---- how large states become ---- */

/* The output less its inputs at sample m, loads z; row_size: sum of |row| */
static double output_now(const struct step_map *k, const double *x, const double *z)
{
	double out = 0;
	for (int i = 0; i < k->n; i++)
		out += k->row[i] * x[i];
	for (int c = 0; c < k->columns; c++)
		out += k->direct[c] * z[c];
	return out;
}

/* How far that may be off: what the walk has rounded, and what reading it and the loads rounds */
static double slack_of_output(const struct step_map *k, const struct spread *spread, double largest)
{
	double sum = 0, direct = 0;
	for (int i = 0; i < k->n; i++)
		sum += fabs(k->row[i]);
	for (int c = 0; c < k->columns; c++)
		direct += fabs(k->direct[c]) * k->amplitude[c];
	return sum * largest * spread->slack + direct * (k->columns + 64) * 0x1p-50;
}

/* From the start, inputs 0: sizes of the states; the largest and the last of the output; added to `trace`, where there
 * is one, at each sample */
struct extent walk_loads(long steps, double h, const struct spread *spread, struct step_map *k, double *trace)
{
	const struct sparse Phi = sparse_of(k->n, k->n, k->Phi), load = sparse_of(k->n, k->columns, k->load);
	SCRATCH double *x = ARRAY(double, k->n), *next = ARRAY(double, k->n), *z = ARRAY(double, k->columns);
	double largest = 0;
	struct extent found = { 0 };
	for (int i = 0; i < k->n; i++)
		x[i] = k->start[i];
	for (long m = 0; m <= steps; m++) {
		for (int c = 0; c < k->columns; c++)
			z[c] = load_value(&k->forcing[c], (double)m * h);
		for (int i = 0; i < k->n; i++) {
			k->size[i] = fmax(k->size[i], fabs(x[i]));
			largest = fmax(largest, fabs(x[i]));
			next[i] = 0;
		}
		const double out = output_now(k, x, z);
		if (trace)
			trace[m] += out;
		found.last = fabs(out);
		found.most = fmax(found.most, found.last);
		sparse_add(&Phi, x, next);
		sparse_add(&load, z, next);
		double *swap = x;
		x = next;
		next = swap;
	}
	for (int i = 0; i < k->n; i++)
		k->size[i] = k->size[i] * (1 + 1e-9) + spread->slack * largest;
	found.slack = slack_of_output(k, spread, largest);
	sparse_free(&Phi);
	sparse_free(&load);
	return found;
}

/* What inputs within their bounds can do to the states at most */
static void add_inputs(const struct spread *spread, struct step_map *k)
{
	SCRATCH double *sum = ARRAY(double, k->n), *most = ARRAY(double, k->n), *column = ARRAY(double, k->n);
	for (int c = 0; c < k->inputs; c++) {
		for (int i = 0; i < k->n; i++)
			column[i] = k->input[i * k->inputs + c];
		reach_of_row(spread, k->Phi, column, true, sum, most);
		for (int i = 0; i < k->n; i++)
			k->size[i] += sum[i] * k->most[c];
	}
}

/* What a sample of an input does to the output m steps after it is given: to states by column `first` and on, one for
 * each sample, the last of which is the one given; sum of sizes over m < steps, of a sample in its bound. It is
 * attained: the signs of the samples may be any. Each is added to `trace`, where there is one. */
double sum_of_input(const struct linear *system, long steps, const struct step_map *k, int input, int first,
			   double *trace)
{
	const int samples = system->input[input].hold + 1, n = k->n;
	const struct sparse Phi = sparse_of(n, n, k->Phi);
	SCRATCH double *x = ARRAY(double, n), *next = ARRAY(double, n);
	double sum = 0;
	for (long m = 0; m < steps; m++) {
		const int sample = m < samples ? samples - 1 - (int)m : -1;
		double out = m == (samples - 1) / 2 ? k->feed[0][input] : 0; /* that at the step's end */
		for (int i = 0; i < n; i++)
			next[i] = sample >= 0 ? k->input[i * k->inputs + first + sample] : 0;
		sparse_add(&Phi, x, next);
		for (int i = 0; i < n; i++)
			out += k->row[i] * next[i];
		sum += fabs(out);
		if (trace)
			trace[m] += out;
		double *swap = x;
		x = next;
		next = swap;
	}
	sparse_free(&Phi);
	return sum * k->most[first];
}

/* What reads the slopes of inputs is bounded, not attained. */
double slopes_of_inputs(const struct linear *system, const struct step_map *k, double h)
{
	double sum = 0;
	for (int i = 0, c = 0; i < system->inputs; c += system->input[i++].hold + 1)
		sum += fabs(k->feed[1][i]) * 2 * k->most[c] / h * (system->input[i].hold > 1 ? 4 : 1);
	return sum;
}

/* Of a lasting run, what is surely reached is so by its first samples. */
struct extent extent_of_step_map(const struct step *step, long steps, const struct spread *spread, struct step_map *k)
{
	enum { HEAD = 20000 };
	const struct linear *system = &step->branch->system;
	const double h = mpq_get_d(step->model->h);
	const bool lasts = is_lasting(k, steps);
	const long walked = lasts ? HEAD : steps;
	struct extent e = walk_loads(walked, h, spread, k, NULL);
	double by_inputs = 0;
	for (int i = 0, c = 0; i < system->inputs; c += system->input[i++].hold + 1)
		by_inputs += sum_of_input(system, walked, k, i, c, NULL);
	if (lasts)
		lasting_sizes(spread, k, h);
	add_inputs(spread, k);
	const double slack = e.slack + by_inputs * (lasts ? 1e-6 : 1e-9 + spread->slack * (double)steps);
	e.lower = fmax(0, fmax(e.most, e.last + by_inputs) - slack);
	return e;
}

/* ---- the exact course of the model over its first steps ---- */

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
