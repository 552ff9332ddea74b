/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values of params and initial states for a fit, and by how much the outputs miss the records there: residuals
 * and their derivatives, which the model computes beside its steps. A run gives both, so each set of values that is
 * tried costs one run, or one for each record.
 *
 * Where every param that is looked for is tunable, and runs from other values have the derivatives of these, nothing is
 * compiled anew; else the model is, once for each set of values. An initial value is set in the run. A sample between
 * two steps is compared with the cubic through the four steps around it, in values as in derivatives, so that these are
 * those of what is compared. Ranges hold by projection: beyond one the end of the range is taken, where a param has no
 * derivative. */
#define _GNU_SOURCE
#include "plrun.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { AROUND = 4 };                            /* steps around a sample */

struct fit {
	const struct toolchain *tools;
	const struct options *options;
	const struct code *code;
	const struct machine *machine;          /* at the values of the command line */
	const double *params;                   /* of the tunables; NULL: as the model has them */
	bool compiled;                          /* anew, for each set of values */
	struct record **record, **driving;      /* driving: samples of the inputs; NULL: there are none */
	double *sigma;                          /* per output; 0: it is not measured */
	struct unknown *unknown;
	int unknowns, columns;
	size_t samples, evaluations;
};

int fit_unknowns(const struct fit *f, const struct unknown **unknown)
{
	*unknown = f->unknown;
	return f->unknowns;
}

size_t fit_samples(const struct fit *f)
{
	return f->samples;
}

double unknown_clamped(const struct unknown *u, double value)
{
	return value < u->low ? u->low : value > u->high ? u->high : value;
}

/* ---- what is looked for ---- */

static int find_name(const char *const *names, int count, const char *name, size_t length)
{
	for (int i = 0; i < count; i++)
		if (strlen(names[i]) == length && strncmp(names[i], name, length) == 0)
			return i;
	return -1;
}

/* The range that --fit gives, by the name without (0) */
static void take_range(const struct fit *f, struct unknown *u, size_t length)
{
	const int i = find_name(f->options->fit, (int)f->options->fits, u->name, length);
	const double *range = i < 0 ? NULL : f->options->fit_range[i];
	if (range && range[0] < range[1]) {
		u->low = range[0];
		u->high = range[1];
	}
}

static void add_unknown(struct fit *f, struct unknown u, size_t length)
{
	take_range(f, &u, length);
	if (u.start < u.low || u.start > u.high)
		fail(WRONG_DATA, format("%s starts at %s, outside of its range, %s to %s", u.name,
					shortest(u.start, false), shortest(u.low, false), shortest(u.high, false)));
	if (u.record >= 0)
		u.name = format("%s of record %d", u.name, u.record + 1);
	f->unknown = need(reallocarray(f->unknown, (size_t)f->unknowns + 1, sizeof *f->unknown));
	f->unknown[f->unknowns++] = u;
}

static void add_param(struct fit *f, const char *name, int column, const double *by)
{
	const struct machine *m = f->machine;
	struct unknown u = { name, column, -1, find_name(m->param_names, m->params, name, strlen(name)), -1,
			     by[0] / by[1], -HUGE_VAL, HUGE_VAL, by[1] };
	if (find_name(m->input_names, m->inputs, name, strlen(name)) >= 0)
		fail(WRONG_USAGE, format("--fit looks for params and initial values; '%s' is an input", name));
	if (by[2] < by[3]) {
		u.low = by[2] / by[1];
		u.high = by[3] / by[1];
	}
	if (u.param >= 0)
		u.start = (f->params ? f->params : m->param_values)[u.param] / by[1];
	f->compiled = f->compiled || u.param < 0;
	add_unknown(f, u, strlen(name));
}

/* Of each record one: they need not begin alike. */
static void add_initial(struct fit *f, const char *name, int column, int state, size_t length)
{
	struct instance *i = instance_new(f->machine);
	double *y = need(calloc((size_t)f->machine->states + 1, sizeof *y));
	const int records = (int)f->options->fit_records;
	instance_get(i, y);
	for (int r = 0; r < records; r++)
		add_unknown(f, (struct unknown){ name, column, records > 1 ? r : -1, -1, state, y[state], -HUGE_VAL,
						 HUGE_VAL, 1 }, length);
	free(y);
	instance_free(i);
}

static void find_unknowns(struct fit *f)
{
	const struct machine *m = f->machine;
	const char *const *name = m->single ? m->derivativesf->names : m->derivatives->names;
	f->columns = m->single ? m->derivativesf->columns : m->derivatives->columns;
	for (int c = 0; c < f->columns; c++) {
		const size_t all = strlen(name[c]), length = all > 3 && strcmp(name[c] + all - 3, "(0)") == 0 ? all - 3
											: all;
		const int state = length < all ? find_name(m->state_names, m->states, name[c], length) : -1;
		double by[4];
		for (int k = 0; k < 4; k++)
			by[k] = m->single ? (double)m->derivativesf->by[c][k] : m->derivatives->by[c][k];
		if (state >= 0)
			add_initial(f, name[c], c, state, length);
		else
			add_param(f, name[c], c, by);
	}
}

/* ---- records ---- */

static int outputs_of(const struct fit *f)
{
	return f->machine->plain_outputs;
}

static double measured(const struct record *r, size_t row, int output)
{
	return r->value[row * (size_t)r->width + (size_t)(r->inputs + output)];
}

static double time_of_row(const struct fit *f, const struct record *r, size_t row)
{
	return r->time ? r->time[row] : (double)row * f->machine->h;
}

/* Those up to T */
static size_t rows_of(const struct fit *f, const struct record *r)
{
	size_t rows = r->rows;
	while (rows && f->options->until >= 0 && time_of_row(f, r, rows - 1) > f->options->until * (1 + 1e-9))
		rows--;
	return rows;
}

static void read_records(struct fit *f)
{
	const struct options *o = f->options;
	const struct machine *m = f->machine;
	struct record *input = o->input ? record_read(o, o->input, m, m->inputs, 0) : NULL;
	f->record = need(calloc(o->fit_records, sizeof *f->record));
	f->driving = need(calloc(o->fit_records, sizeof *f->driving));
	for (size_t r = 0; r < o->fit_records; r++) {
		f->record[r] = record_read(o, o->fit_record[r], m, input ? 0 : m->inputs, outputs_of(f));
		f->driving[r] = input ? input : m->inputs ? f->record[r] : NULL;
		if (f->driving[r] && !record_on_grid(f->driving[r], m->h))
			record_say(f->driving[r], m->h);
	}
}

/* Of an output the mean square of its samples less their mean, or, where that is 0, their mean square; counts them */
static double scatter_of(struct fit *f, int output)
{
	double sum = 0, squares = 0, count = 0;
	for (size_t r = 0; r < f->options->fit_records; r++)
		for (size_t row = 0; row < rows_of(f, f->record[r]); row++) {
			const double y = measured(f->record[r], row, output);
			sum += isnan(y) ? 0 : y;
			squares += isnan(y) ? 0 : y * y;
			count += !isnan(y);
		}
	f->samples += (size_t)count;
	const double variance = count > 0 ? squares / count - sum / count * (sum / count) : 0;
	return count == 0 ? 0 : variance > 1e-12 * squares / count ? variance : squares > 0 ? squares / count : 1;
}

static void find_sigmas(struct fit *f)
{
	const struct options *o = f->options;
	const struct machine *m = f->machine;
	int guessed = 0, taken = 0;
	f->sigma = need(calloc((size_t)outputs_of(f) + 1, sizeof *f->sigma));
	for (size_t k = 0; k < o->sigmas; k++)
		if (find_name(m->output_names, outputs_of(f), o->sigma[k].name, strlen(o->sigma[k].name)) < 0)
			wrong_usage(format("--sigma: the model has no output '%s'", o->sigma[k].name));
	for (int i = 0; i < outputs_of(f); i++) {
		f->sigma[i] = sqrt(scatter_of(f, i));
		taken += f->sigma[i] > 0;
		guessed += f->sigma[i] > 0;
		for (size_t k = 0; k < o->sigmas && f->sigma[i] > 0; k++)
			if (strcmp(o->sigma[k].name, m->output_names[i]) == 0)
				guessed -= read_number(o->sigma[k].value, &f->sigma[i]);
	}
	for (int i = 0; i < outputs_of(f) && guessed && taken > 1; i++)
		if (f->sigma[i] > 0)
			say_note(format("%s is weighted by how much it varies, 1 over %.3g; --sigma %s=X gives another",
					m->output_names[i], f->sigma[i], m->output_names[i]));
}

/* ---- a run ---- */

struct follower {                       /* of a run along a record */
	const struct fit *f;
	const struct record *record;
	size_t number, row, rows;               /* number: of the record; row: the next that is to be compared */
	uint64_t steps;
	double h;
	int outputs;                            /* of a step, derivatives included */
	double *last;                           /* AROUND steps, that of k at k % AROUND */
	const bool *within;                     /* per unknown: is it inside its range? */
	struct fit_rows *to;
	fit_watch *each;                        /* NULL, or what sees values; `model` are those of one row */
	double *model;
};

/* The steps that the next row is between, from *from on, and how much each counts; returns how many */
static int steps_around(const struct follower *w, uint64_t *from, double *weight)
{
	const double at = time_of_row(w->f, w->record, w->row) / w->h;
	const uint64_t near = (uint64_t)(at + 0.5), below = (uint64_t)at;
	const int count = w->steps + 1 < AROUND ? (int)w->steps + 1 : AROUND;
	if (fabs(at - (double)near) < 1e-6) {
		*from = near;
		weight[0] = 1;
		return 1;
	}
	*from = below > 0 ? below - 1 : 0;
	*from = *from + (uint64_t)count > w->steps + 1 ? w->steps + 1 - (uint64_t)count : *from;
	for (int i = 0; i < count; i++) {
		weight[i] = 1;
		for (int j = 0; j < count; j++)
			weight[i] *= j == i ? 1 : (at - (double)*from - j) / (i - j);
	}
	return count;
}

static double around(const struct follower *w, uint64_t from, const double *weight, int count, int column)
{
	double sum = 0;
	for (int i = 0; i < count; i++)
		sum += weight[i] * w->last[(from + (uint64_t)i) % AROUND * (size_t)w->outputs + (size_t)column];
	return sum;
}

static void compare(struct follower *w, uint64_t from, const double *weight, int count, int output)
{
	const struct fit *f = w->f;
	const double y = measured(w->record, w->row, output), value = around(w, from, weight, count, output);
	struct fit_rows *to = w->to;
	w->model[w->row * (size_t)outputs_of(f) + (size_t)output] = value;
	if (isnan(y))
		return;
	to->residual[to->rows] = (value - y) / f->sigma[output];
	for (int i = 0; i < f->unknowns; i++) {
		const struct unknown *u = &f->unknown[i];
		const bool acts = w->within[i] && (u->record < 0 || (size_t)u->record == w->number);
		to->jacobian[to->rows * (size_t)f->unknowns + (size_t)i] = !acts ? 0 : u->factor / f->sigma[output] *
			around(w, from, weight, count, outputs_of(f) + output * f->columns + u->column);
	}
	to->rows++;
}

static void follow(void *who, uint64_t k, const double *out)
{
	struct follower *w = who;
	uint64_t from;
	double weight[AROUND];
	memcpy(w->last + k % AROUND * (size_t)w->outputs, out, sizeof *out * (size_t)w->outputs);
	for (; w->row < w->rows; w->row++) {
		const int count = steps_around(w, &from, weight);
		if (from + (uint64_t)count > k + 1)
			return;
		for (int i = 0; i < outputs_of(w->f); i++)
			if (w->f->sigma[i] > 0)
				compare(w, from, weight, count, i);
	}
}

/* The model at these values; NULL: *error */
static struct machine *machine_at(const struct fit *f, const double *value, char **error)
{
	const struct options *o = f->options;
	const char **definition = need(calloc(o->definitions + (size_t)f->unknowns + 1, sizeof *definition));
	size_t count = 0;
	int status;
	double number;
	for (size_t i = 0; i < o->definitions; i++)
		if (find_name(o->fit, (int)o->fits, o->definition[i].name, strlen(o->definition[i].name)) < 0 &&
		    !(is_tunable(f->code, o->definition[i].name) && read_number(o->definition[i].value, &number)))
			definition[count++] = format("%s=%s", o->definition[i].name, o->definition[i].value);
	for (int i = 0; i < f->unknowns; i++)
		if (f->unknown[i].state < 0)
			definition[count++] = format("%s=%s", f->unknown[i].name,
						     shortest(unknown_clamped(&f->unknown[i], value[i]), false));
	struct code *c = generate(f->tools, o, definition, count, true, error, &status);
	struct machine *m = c ? machine_of(f->tools, c, error) : NULL;
	free(definition);
	return m;
}

static void set_values(const struct fit *f, const double *value, size_t record, double *params, double *offset)
{
	for (int i = 0; i < f->unknowns; i++) {
		const struct unknown *u = &f->unknown[i];
		const double now = unknown_clamped(u, value[i]);
		if (u->param >= 0)
			params[u->param] = now * u->factor;
		if (u->state >= 0 && (u->record < 0 || (size_t)u->record == record))
			offset[u->state] = now - u->start;
	}
}

static char *run_record(const struct fit *f, const struct machine *m, const double *value, struct follower *w)
{
	double *params = need(calloc((size_t)m->params + 1, sizeof *params));
	double *offset = need(calloc((size_t)m->states + 1, sizeof *offset));
	const double last = time_of_row(f, w->record, w->rows - 1) / m->h;
	struct job job = { .machine = m, .record = f->driving[w->number], .h = m->h, .offset = offset };
	if (m->params)
		memcpy(params, f->params ? f->params : m->param_values, sizeof *params * (size_t)m->params);
	set_values(f, value, w->number, params, offset);
	job.params = m->params ? params : NULL;
	w->steps = (uint64_t)ceil(last - 1e-6);
	w->h = m->h;
	job.until = (double)w->steps * m->h;
	w->last = need(calloc(AROUND * (size_t)m->outputs, sizeof *w->last));
	w->outputs = m->outputs;
	char *error = plan_run(&job);
	if (error)
		fail_at((struct place){ w->record->path, w->record->last_line, "", 0, 0 }, NULL, error);
	error = run_steps(&job, follow, w);
	free(params);
	free(offset);
	free(w->last);
	return error;
}

const char *fit_evaluate(struct fit *f, const double *value, struct fit_rows *to, fit_watch *each, void *who)
{
	char *error = NULL;
	struct machine *made = f->compiled ? machine_at(f, value, &error) : NULL;
	const struct machine *m = f->compiled ? made : f->machine;
	bool *within = need(calloc((size_t)f->unknowns, sizeof *within));
	for (int i = 0; i < f->unknowns; i++)
		within[i] = value[i] >= f->unknown[i].low && value[i] <= f->unknown[i].high;
	to->rows = 0;
	for (size_t r = 0; r < f->options->fit_records && !error; r++) {
		struct follower w = { .f = f, .record = f->record[r], .number = r, .rows = rows_of(f, f->record[r]),
				      .within = within, .to = to };
		w.model = need(calloc(w.rows * (size_t)outputs_of(f) + 1, sizeof *w.model));
		error = w.rows ? run_record(f, m, value, &w) : NULL;
		for (int i = 0; i < outputs_of(f) && each && !error; i++) {
			double *row = need(calloc(3 * w.rows + 1, sizeof *row));
			for (size_t k = 0; k < w.rows; k++) {
				row[3 * k] = time_of_row(f, w.record, k);
				row[3 * k + 1] = measured(w.record, k, i);
				row[3 * k + 2] = w.model[k * (size_t)outputs_of(f) + (size_t)i];
			}
			if (f->sigma[i] > 0)
				each(who, f->machine->output_names[i], r, w.rows, row);
			free(row);
		}
		free(w.model);
	}
	if (made)
		machine_close(made);
	free(within);
	f->evaluations++;
	return error;
}

void fit_each(const struct estimate *e, fit_watch *each, void *who)
{
	struct fit again = *e->fit;
	struct fit_rows at = e->at;
	fit_evaluate(&again, e->value, &at, each, who);
}

/* ---- all of it ---- */

struct fit *fit_new(const struct toolchain *t, const struct options *o, const struct code *c, const struct machine *m,
		    const double *params)
{
	struct fit *f = need(malloc(sizeof *f));
	*f = (struct fit){ .tools = t, .options = o, .code = c, .machine = m, .params = params };
	gsl_set_error_handler_off();
	read_records(f);
	find_sigmas(f);
	find_unknowns(f);
	if (f->samples <= (size_t)f->unknowns)
		fail(WRONG_DATA, format("%zu samples up to T, and %d values are looked for", f->samples, f->unknowns));
	return f;
}

void fit_say_cost(const struct fit *f)
{
	const char *wanted = "";
	for (int i = 0; i < f->unknowns; i++)
		if (f->unknown[i].state < 0 && f->unknown[i].param < 0)
			wanted = format("%s%s%s", wanted, *wanted ? ", " : "", f->unknown[i].name);
	/* regions that tunable params change have no derivatives */
	const char *way_out = f->machine->crossed ? "" : format("; `tunable %s` spares that", wanted);
	say_note(format("%zu evaluations%s%s", f->evaluations, f->compiled ? ", the model compiled for each" : "",
			f->compiled ? way_out : ""));
}
