/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far an output of the emitted program may be off the exact solution, at any sample up to some time.
 *
 * An error made at one step reaches the output m steps later through row Phi^m, row being what the output reads. With
 * the rounding of a step at most d, from the order of its operations and from how large its operands become, the
 * output is off by at most sum over m < N of |row Phi^m| d, the rounding of constants included: FiXiF's and Volkova's
 * worst-case gain (ARITH 2015). States are bounded as they are computed, errors counted: a bound of the state that the
 * errors that follow from it do not pass. */
#include "step/step.h"

#include <math.h>

enum { MOST_TRACED = 4000000 };      /* samples at which what is lost is kept */
#define WORK 4e9                    /* operations of a walk through all samples */

struct kept {                       /* the step over the state as it is kept: y+ = Phi y + load z + input u */
	int n, columns, inputs;
	double *Phi, *load, *input, *start;
	double *row, *direct, *feed[2]; /* of the output: y; z; u and u' */
	double *scale;              /* the state is in these units, powers of 2: those in which it is balanced */
	struct wave_of_column *wave; /* per load column */
	double *amplitude;          /* per load column: its largest size, of cosine and sine together */
	double *most;               /* per input column */
	double *size;               /* per state: the largest that it may become */
};
struct extent {                     /* of an output, over all samples */
	double most, last, slack;   /* by the loads and from the start, as walked through; how far that may be off */
	double lower, upper;        /* of the largest, inputs counted */
};
struct errors {
	const struct step *step;
	const struct kept *kept;
	const struct requirement *r;
	long steps;
	/* of rounding, relative; where numbers leave the range below, or what has decayed is set to rest */
	double unit, tiny;
	double *size, *err;         /* per state, while a step is reckoned */
};

/* ---- the step as a map ---- */

static double mass_of(const struct step *step, int state)
{
	const struct linear *system = &step->branch->system;
	return step->momenta && state >= system->n ? mpq_get_d(step->mass[system->coord[state]]) : 1;
}

static bool is_load_forced(const struct step *step, int column)
{
	return step->forced && is_forced(step, column);
}

static void keep_states(const struct step *step, const struct step *exact, const struct output *output, struct kept *k)
{
	const struct table *table = exact->branch->whole;
	const int n = k->n;
	for (int i = 0; i < n; i++) {
		for (int j = 0; j < n; j++)
			k->Phi[i * n + j] = table->Phi[i * n + j].value * mass_of(step, i) / mass_of(step, j);
		for (int c = 0; c < k->columns; c++)
			k->load[i * k->columns + c] =
				is_load_forced(step, c) ? 0 : table->load[i * k->columns + c].value * mass_of(step, i);
		for (int c = 0; c < k->inputs; c++)
			k->input[i * k->inputs + c] = table->input[i * k->inputs + c].value * mass_of(step, i);
		k->start[i] = mpq_get_d(step->model->initial[i]) * mass_of(step, i);
		k->row[i] = mpq_get_d(output->state[i]) / mass_of(step, i);
	}
}

static void keep_modes(const struct step *exact, int o, struct kept *k)
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

struct wave_of_column {             /* t^power e^{a t} cos or sin(w t + p); without waves cos(p) = 1 */
	int power;
	bool turns, sine;
	double a, w, p;
};

static struct wave_of_column wave_of_column(const struct linear *system, int column)
{
	int first;
	const struct load *load = &system->load[load_of_column(system, column, &first)];
	const bool turns = oscillates(load->wave);
	return (struct wave_of_column){ .power = (column - first) / (turns ? 2 : 1),
					.turns = turns,
					.sine = turns && (column - first) % 2,
					.a = mpq_get_d(load->wave->a),
					.w = mpq_get_d(load->wave->w),
					.p = mpq_get_d(load->wave->p) };
}

static struct wave_of_column *waves_of_columns(const struct linear *system, int columns)
{
	struct wave_of_column *wave = ARRAY(struct wave_of_column, (size_t)columns);
	for (int c = 0; c < columns; c++)
		wave[c] = wave_of_column(system, c);
	return wave;
}

static double load_value(const struct wave_of_column *p, double t)
{
	double value = p->a != 0 ? exp(p->a * t) : 1;
	if (p->turns)
		value *= (p->sine ? sin : cos)(p->w * t + p->p);
	for (int k = 0; k < p->power; k++)
		value *= t;
	return value;
}

/* The largest of |t^k e^{a t}| up to `end` */
static double largest_load(const struct wave_of_column *p, double end)
{
	const double peak = p->a < 0 ? -p->power / p->a : end, t = peak < end ? peak : end;
	return fmax(pow(t, p->power) * exp(p->a * t), p->power ? 0 : 1);
}

/* What the step leaves out is added where the state is read: it starts less that, and the output reads it. */
static void keep_forced(const struct step *step, struct kept *k)
{
	for (int i = 0; i < k->n; i++)
		for (int c = 0; c < k->columns && step->forced; c++) {
			const double part = is_load_forced(step, c)
						    ? mpq_get_d(step->forced->exact[i * k->columns + c])
						    : 0;
			k->start[i] -= part * load_value(&k->wave[c], 0);
			k->direct[c] += k->row[i] * part;
		}
}

/* ---- what goes into the kept map ---- */

static void keep_output(const struct step *step, const struct output *output, struct kept *k)
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

static void bound_operands(const struct errors *e, struct kept *k)
{
	const struct linear *system = &e->step->branch->system;
	const double end = mpq_get_d(e->r->until) + mpq_get_d(e->step->model->h);
	for (int c = 0; c < k->columns; c++) {
		k->amplitude[c] = largest_load(&k->wave[c], end) * (1 + 1e-9);
	}
	for (int i = 0, c = 0; i < system->inputs; i++)
		for (int j = 0; j <= system->input[i].hold; j++, c++)
			k->most[c] = mpq_get_d(e->r->most[i]) * (1 + 1e-15);
}

/* In units in which the map is balanced */
static void balance_kept(struct kept *k)
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

static struct kept *kept_of(const struct errors *e, const struct step *exact)
{
	const struct step *step = e->step;
	const struct output *output = &step->model->output[e->r->output];
	struct kept *k = NEW(struct kept);
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
	k->wave = waves_of_columns(&step->branch->system, k->columns);
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
static double output_now(const struct kept *k, const double *x, const double *z)
{
	double out = 0;
	for (int i = 0; i < k->n; i++)
		out += k->row[i] * x[i];
	for (int c = 0; c < k->columns; c++)
		out += k->direct[c] * z[c];
	return out;
}

/* How far that may be off: what the walk has rounded, and what reading it and the loads rounds */
static double slack_of_output(const struct kept *k, const struct spread *spread, double largest)
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
static struct extent walk_loads(long steps, double h, const struct spread *spread, struct kept *k, double *trace)
{
	const struct sparse Phi = sparse_of(k->n, k->n, k->Phi), load = sparse_of(k->n, k->columns, k->load);
	double *x = ARRAY(double, (size_t)k->n), *next = ARRAY(double, (size_t)k->n),
	       *z = ARRAY(double, (size_t)k->columns), largest = 0;
	struct extent found = { 0 };
	for (int i = 0; i < k->n; i++)
		x[i] = k->start[i];
	for (long m = 0; m <= steps; m++) {
		for (int c = 0; c < k->columns; c++)
			z[c] = load_value(&k->wave[c], (double)m * h);
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
	discard(x);
	discard(next);
	discard(z);
	sparse_free(&Phi);
	sparse_free(&load);
	return found;
}

/* What inputs within their bounds can do to the states at most */
static void add_inputs(const struct spread *spread, struct kept *k)
{
	double *sum = ARRAY(double, (size_t)k->n), *most = ARRAY(double, (size_t)k->n),
	       *column = ARRAY(double, (size_t)k->n);
	for (int c = 0; c < k->inputs; c++) {
		for (int i = 0; i < k->n; i++)
			column[i] = k->input[i * k->inputs + c];
		reach_of_row(spread, k->Phi, column, true, sum, most);
		for (int i = 0; i < k->n; i++)
			k->size[i] += sum[i] * k->most[c];
	}
	discard(sum);
	discard(most);
	discard(column);
}

/* What a sample of an input does to the output m steps after it is given: to states by column `first` and on, one for
 * each tap, the last of which is the sample itself; sum of sizes over m < steps, of a sample in its bound. It is
 * attained: the signs of the samples may be any. Each is added to `trace`, where there is one. */
static double sum_of_input(const struct linear *system, long steps, const struct kept *k, int input, int first,
			   double *trace)
{
	const int taps = system->input[input].hold + 1, n = k->n;
	const struct sparse Phi = sparse_of(n, n, k->Phi);
	double *x = ARRAY(double, (size_t)n), *next = ARRAY(double, (size_t)n), sum = 0;
	for (long m = 0; m < steps; m++) {
		const int tap = m < taps ? taps - 1 - (int)m : -1;
		double out = m == (taps - 1) / 2 ? k->feed[0][input] : 0;  /* that at the step's end */
		for (int i = 0; i < n; i++)
			next[i] = tap >= 0 ? k->input[i * k->inputs + first + tap] : 0;
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
	discard(x);
	discard(next);
	sparse_free(&Phi);
	return sum * k->most[first];
}

/* What reads the slopes of inputs is bounded, not attained. */
static double slopes_of_inputs(const struct linear *system, const struct kept *k, double h)
{
	double sum = 0;
	for (int i = 0, c = 0; i < system->inputs; c += system->input[i++].hold + 1)
		sum += fabs(k->feed[1][i]) * 2 * k->most[c] / h * (system->input[i].hold > 1 ? 4 : 1);
	return sum;
}

static struct extent extent_of_kept(const struct step *step, long steps, const struct spread *spread, struct kept *k)
{
	const struct linear *system = &step->branch->system;
	const double h = mpq_get_d(step->model->h);
	struct extent e = walk_loads(steps, h, spread, k, NULL);
	double by_inputs = 0;
	for (int i = 0, c = 0; i < system->inputs; c += system->input[i++].hold + 1)
		by_inputs += sum_of_input(system, steps, k, i, c, NULL);
	add_inputs(spread, k);
	const double slack = e.slack + by_inputs * (1e-9 + spread->slack * (double)steps);
	e.lower = fmax(0, fmax(e.most, e.last + by_inputs) - slack);
	e.upper = (e.most + by_inputs + slopes_of_inputs(system, k, h)) * (1 + 1e-9) + slack;
	return e;
}

/* ---- what one step rounds ---- */

static int levels(int terms)
{
	int levels = 0;
	while (1 << levels < terms)
		levels++;
	return levels;
}

/* Of a load state relative to its amplitude: cos and sin, a growth, t and its products; the phase, which is kept in
 * 64 bits for float, in 128 for double, is off by one of its last for each step */
static double load_error(const struct errors *e, int column)
{
	const struct wave_of_column *p = &e->kept->wave[column];
	const double phase = ldexp((double)(e->steps + 1) * 7, 1 - phase_bits(e->step));
	return (2 + 3 * (p->a != 0) + 4 * p->power) * e->unit + phase;
}

struct operand_bound { double size, error; };

static struct operand_bound bound_of_operand(const struct errors *e, const struct operand *operand)
{
	switch (operand->kind) {
	case OPERAND_STATE: return (struct operand_bound){ e->size[operand->index], e->err[operand->index] };
	case OPERAND_LOAD: {
		const double size = e->kept->amplitude[operand->index];
		return (struct operand_bound){ size, size * load_error(e, operand->index) };
	}
	default: return (struct operand_bound){ e->kept->most[operand->index], 0 };
	}
}

/* Of a load with anchors the factor is turned: of cosine and sine together */
static double size_of_factor(const struct errors *e, const struct assignment *a, const struct product *p)
{
	const struct table *table = e->step->branch->whole;
	int first;
	if (p->operand.kind != OPERAND_LOAD)
		return fabs(p->factor->value);
	const struct load *load =
		&e->step->branch->system.load[load_of_column(&e->step->branch->system, p->operand.index, &first)];
	const int partner = oscillates(load->wave) ? first + ((p->operand.index - first) ^ 1) : p->operand.index;
	return hypot(table->load[a->target * table->columns + p->operand.index].value,
		     table->load[a->target * table->columns + partner].value);
}

static void reckon(const struct errors *e, const struct assignment *a, const double *whole)
{
	const struct program *program = e->step->program;
	const int roundings = 2 + (program->loops ? a->terms + 4 : levels(a->terms)) + 3 * program->compensated;
	double size = 0, error = 0;
	for (int i = 0; i < a->terms; i++) {
		const double factor = size_of_factor(e, a, &a->term[i]) * (1 + 1e-6);
		const struct operand_bound b = bound_of_operand(e, &a->term[i].operand);
		size += factor * b.size;
		error += factor * b.error;
	}
	error += roundings * e->unit * size + (a->terms + 4) * e->tiny;
	double value = whole[a->target];
	if (program->in_order)
		value = e->size[a->target] + size;
	if (a->added)
		error += e->err[a->target] + (program->compensated || a->carried
						      ? 4 * e->unit * (size + 2 * e->unit * value)
						      : e->unit * value);
	e->size[a->target] = value;
	e->err[a->target] = error;
}

static void reckon_list(struct errors *e, const double *size, double *error)
{
	const struct program *program = e->step->program;
	const int n = e->kept->n;
	double *old[2] = { ARRAY(double, (size_t)n), ARRAY(double, (size_t)n) };
	e->size = old[0];
	e->err = old[1];
	for (int i = 0; i < program->assignments; i++) {
		const struct assignment *a = &program->assignment[i];
		for (int j = 0; j < n && (i == 0 || !program->in_order); j++) {
			e->size[j] = size[j];
			e->err[j] = 0;
		}
		reckon(e, a, size);
		error[a->target] = e->err[a->target];
	}
}

static double modal_drive(const struct errors *e, int i, int *terms)
{
	const struct modal *modal = e->step->modal;
	double sum = 0;
	*terms = 0;
	for (int c = 0; c < modal->loads; c++)
		if (modal->load[i * modal->loads + c] != 0) {
			sum += fabs(modal->load[i * modal->loads + c]) * e->kept->amplitude[c] *
			       (1 + load_error(e, c) / e->unit);
			(*terms)++;
		}
	for (int c = 0; c < modal->inputs; c++)
		if (modal->input[i * modal->inputs + c] != 0) {
			sum += fabs(modal->input[i * modal->inputs + c]) * e->kept->most[c];
			(*terms)++;
		}
	return sum;
}

static void reckon_modes(const struct errors *e, const double *size, double *error)
{
	const struct modal *modal = e->step->modal;
	const int pairs = modal->pairs;
	for (int i = 0; i < modal->states; i++) {
		int terms;
		const double drive = modal_drive(e, i, &terms);
		double own = fabs(modal->turn[i]) * size[i];
		if (i < 2 * pairs) {
			const int re = i < pairs ? i : i - pairs, im = re + pairs, other = i < pairs ? im : re;
			own = fabs(modal->turn[re]) * size[i] + fabs(modal->turn[im]) * size[other];
		}
		error[i] = e->unit * (1 + 1e-6) * ((terms ? 4 : 3) * own + (3 + levels(terms)) * drive) +
			   (terms + 4) * e->tiny;
	}
}

/* The state at the start is rounded, or made of modes. */
static void reckon_start(const struct errors *e, double *error)
{
	const struct kept *k = e->kept;
	const struct modal *modal = e->step->modal;
	for (int i = 0; i < k->n; i++) {
		double size = fabs(k->start[i]) * k->scale[i] * (mass_of(e->step, i) != 1 ? 3 : 1);
		for (int c = 0; c < k->columns && e->step->forced; c++)
			if (is_load_forced(e->step, c))
				size += fabs(mpq_get_d(e->step->forced->exact[i * k->columns + c]) *
					     load_value(&k->wave[c], 0)) *
					(8 + levels(k->columns));
		for (int j = 0; j < k->n && modal; j++)
			size += fabs(modal->to[i * k->n + j] * mpq_get_d(e->step->model->initial[j])) * (k->n / 8 + 6);
		error[i] = e->unit * size + e->tiny;
	}
}

/* What reading the output rounds */
static double reckon_output(const struct errors *e, const double *size)
{
	const struct kept *k = e->kept;
	const struct linear *system = &e->step->branch->system;
	double sum = 0, error = 0;
	int terms = 0;
	for (int i = 0; i < k->n; i++) {
		terms += k->row[i] != 0;
		sum += fabs(k->row[i]) / k->scale[i] * size[i];
	}
	for (int c = 0; c < k->columns; c++) {
		terms += k->direct[c] != 0;
		sum += fabs(k->direct[c]) * k->amplitude[c];
		error += fabs(k->direct[c]) * k->amplitude[c] * load_error(e, c);
		for (int i = 0; i < k->n && is_load_forced(e->step, c); i++)
			error += fabs(k->row[i]) / k->scale[i] * k->amplitude[c] * e->unit *
				 fabs(mpq_get_d(e->step->forced->exact[i * k->columns + c])) *
				 (12 + levels(k->columns));
	}
	for (int i = 0, c = 0; i < system->inputs; c += system->input[i++].hold + 1) {
		const double slope = 2 * k->most[c] / mpq_get_d(e->step->model->h);
		terms += (k->feed[0][i] != 0) + (k->feed[1][i] != 0);
		sum += fabs(k->feed[0][i]) * k->most[c] + 4 * fabs(k->feed[1][i]) * slope;
	}
	return error + sum * e->unit * (4 + levels(terms) + (e->step->modal ? k->n / 8 + 5 : 0)) +
	       (terms + 4) * e->tiny;
}

/* ---- the whole ---- */

/* How far states are off: what steps add, and what becomes of the start */
static void spread_errors(const struct kept *k, const struct spread *s, const double *each, const double *first,
			  double *error)
{
	for (int i = 0; i < k->n; i++) {
		error[i] = 0;
		for (int j = 0; j < k->n; j++)
			error[i] += k->scale[i] / k->scale[j] *
				    (s->sum[i * k->n + j] * each[j] + s->most[i * k->n + j] * first[j]);
	}
}

/* Sizes of the states as computed, and what a step of such sizes rounds; false: errors outgrow the state */
static bool settle(struct errors *e, const struct spread *s, double *size, double *each, const double *first)
{
	enum { TRIES = 12 };
	const struct kept *k = e->kept;
	double *error = ARRAY(double, (size_t)k->n);
	for (int i = 0; i < k->n; i++)
		size[i] = k->size[i] * k->scale[i];
	for (int tries = 0; tries < TRIES; tries++) {
		bool holds = true;
		for (int i = 0; i < k->n; i++)
			each[i] = 0;
		if (e->step->modal)
			reckon_modes(e, size, each);
		else
			reckon_list(e, size, each);
		spread_errors(k, s, each, first, error);
		for (int i = 0; i < k->n; i++) {
			const double needed = k->size[i] * k->scale[i] + error[i];
			holds = holds && needed <= size[i];
			if (!(needed <= size[i]))
				size[i] = k->size[i] * k->scale[i] + 2 * error[i];
			if (!isfinite(size[i]))
				return false;
		}
		if (holds)
			return true;
	}
	return false;
}

static void add_up(struct errors *e, const struct spread *spread, struct certificate *found)
{
	const struct kept *k = e->kept;
	const size_t n = (size_t)k->n;
	double *each = ARRAY(double, n), *first = ARRAY(double, n), *size = ARRAY(double, n), *sum = ARRAY(double, n),
	       *most = ARRAY(double, n);
	reckon_start(e, first);
	if (!settle(e, spread, size, each, first)) {
		found->why = "rounding outgrows the state";
		return;
	}
	reach_of_row(spread, k->Phi, k->row, false, sum, most);
	found->rounding = reckon_output(e, size);
	for (int i = 0; i < k->n; i++)
		found->rounding += (sum[i] * each[i] + most[i] * first[i]) / k->scale[i];
	found->known = isfinite(found->rounding);
}

static const char *objection(const struct errors *e)
{
	const struct linear *system = &e->step->branch->system;
	if (system->states > LIMIT_NEED_STATES)
		return format("it is built for up to %d states", LIMIT_NEED_STATES);
	const int each = system->states * system->states + 32 * load_columns(system) + 32;
	if (e->steps < 0 || (double)e->steps * each > WORK)
		return "there are too many samples until then";
	return NULL;
}

static long samples(const struct requirement *r, mpq_srcptr h)
{
	mpq_t steps;
	mpz_t last;
	mpq_init(steps);
	mpz_init(last);
	mpq_div(steps, r->until, h);
	mpz_fdiv_q(last, mpq_numref(steps), mpq_denref(steps));
	const long count = mpz_fits_slong_p(last) ? mpz_get_si(last) : -1;
	mpq_clear(steps);
	mpz_clear(last);
	return count;
}

double needed_error(const struct requirement *r, double largest)
{
	return mpq_get_d(r->bound) * (r->need->percent ? largest : 1);
}

static struct errors errors_of(const struct step *step, const struct requirement *r)
{
	const bool single = step->model->asked.single;
	return (struct errors){ .step = step,
				.r = r,
				.steps = samples(r, step->model->h),
				.unit = single ? 0x1p-24 : 0x1p-53,
				.tiny = step->rest ? (single ? 1e-35 : 1e-290) : single ? 0x1p-149 : 0x1p-1074 };
}

double largest_of_output(const struct step *exact, const struct requirement *r)
{
	const struct errors e = errors_of(exact, r);
	if (objection(&e))
		return 0;
	struct kept *k = kept_of(&e, exact);
	const struct spread spread = spread_of(k->n, k->Phi, e.steps + 1);
	return spread.known ? extent_of_kept(exact, e.steps, &spread, k).lower : 0;
}

/* ---- what is lost with modes ---- */

struct loss {                       /* of one output, summed over modes */
	long steps;
	double *trace, **input;     /* at each sample; m steps after a sample of an input */
	double slack;               /* how far what is found may be off */
};

/* One more mode is dropped: `step` is that of what is lost with it. */
static bool add_loss(const struct step *step, const struct requirement *r, struct loss *loss)
{
	const struct linear *system = &step->branch->system;
	const struct errors e = errors_of(step, r);
	if (objection(&e))
		return false;
	struct kept *k = kept_of(&e, step);
	const struct spread spread = spread_of(k->n, k->Phi, e.steps + 1);
	if (!spread.known)
		return false;
	loss->slack += walk_loads(e.steps, mpq_get_d(step->model->h), &spread, k, loss->trace).slack;
	for (int i = 0, c = 0; i < system->inputs; c += system->input[i++].hold + 1)
		loss->slack += sum_of_input(system, e.steps, k, i, c, loss->input[i]) *
			       (1e-9 + spread.slack * (double)e.steps);
	loss->slack += slopes_of_inputs(system, k, mpq_get_d(step->model->h));
	return true;
}

static double size_of_loss(const struct loss *loss, const struct linear *system, const struct requirement *r)
{
	double most = 0, inputs = 0;
	for (long m = 0; m <= loss->steps; m++)
		most = fmax(most, fabs(loss->trace[m]));
	for (int i = 0; i < system->inputs; i++) {
		double sum = 0;
		for (long m = 0; m < loss->steps; m++)
			sum += fabs(loss->input[i][m]);
		inputs += sum * mpq_get_d(r->most[i]);
	}
	return (most + inputs) * (1 + 1e-9) + loss->slack;
}

static struct loss no_loss(const struct linear *system, long steps)
{
	struct loss loss = { .steps = steps,
			     .trace = ARRAY(double, (size_t)steps + 1),
			     .input = ARRAY(double *, (size_t)system->inputs) };
	for (int i = 0; i < system->inputs; i++)
		loss.input[i] = ARRAY(double, (size_t)steps + 1);
	return loss;
}

static void loss_free(const struct loss *loss, const struct linear *system)
{
	discard(loss->trace);
	for (int i = 0; i < system->inputs; i++)
		discard(loss->input[i]);
}

struct building_loss { struct model *error; struct step *step; };

static void build_loss(void *context)
{
	struct building_loss *b = context;
	b->error->written = b->error;
	b->error->asked.form = FORM_DIRECT;
	b->error->asked.anchors = b->error->asked.rows = 1;
	b->error->asked.batch = b->error->asked.selftest = false;
	b->step = step_build(b->error);
	if (!b->step)
		abandon();
}

/* What is lost with one mode, as a step in double; NULL: it is not found */
static struct step *step_of_loss(struct modes *modes, int mode, bool statics)
{
	bool *kept = ARRAY(bool, (size_t)modes->count);
	for (int i = 0; i < modes->count; i++)
		kept[i] = i != mode;
	struct building_loss b = { .error = modes_dropped(modes, kept, statics) };
	discard(kept);
	return b.error && silent_guard(build_loss, &b) ? b.step : NULL;
}

double *losses_of(struct modes *modes, const int *order, bool statics, const struct requirement *r)
{
	const struct linear *system = &modes->model->system;
	const long steps = samples(r, modes->model->h);
	double *lost = ARRAY(double, (size_t)modes->count + 1);
	bool good = steps >= 0 && steps <= MOST_TRACED;
	struct loss loss = no_loss(system, good ? steps : 0);
	for (int c = modes->count - 1; c >= 0; c--) {
		const struct step *step = good ? step_of_loss(modes, order[c], statics) : NULL;
		good = step && add_loss(step, r, &loss);
		lost[c] = good ? size_of_loss(&loss, system, r) : HUGE_VAL;
	}
	loss_free(&loss, system);
	return lost;
}

struct certificate certificate_of(const struct step *step, const struct step *exact, const struct requirement *r)
{
	struct errors e = errors_of(step, r);
	struct certificate found = { .why = objection(&e) };
	if (found.why)
		return found;
	struct kept *k = kept_of(&e, exact);
	const struct spread spread = spread_of(k->n, k->Phi, e.steps + 1);
	if (!spread.known) {
		found.why = "powers of its step grow beyond what double tells";
		return found;
	}
	e.kept = k;
	extent_of_kept(step, e.steps, &spread, k);
	add_up(&e, &spread, &found);
	return found;
}
