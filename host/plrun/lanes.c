/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs that differ in tunable params alone, side by side by NAME_batch: each has the bits of its run alone. */
#include "plrun.h"

#include <stdlib.h>

struct lanes {
	const struct machine *machine;
	size_t count;
	void *b, *y, *factors, *peak;           /* as NAME_many takes them; in float of a model in float, as these: */
	void *u, *params, *out;
	double *wide;                           /* outputs of some steps, a row of all instances for each */
};

bool machine_has_lanes(const struct machine *m)
{
	bool own = m->many && !m->derivatives;
	for (int i = 0; own && m->shown && i < m->outputs; i++)
		own = m->shown[i] < m->own_outputs;
	return own;
}

static struct lanes lanes_new(const struct machine *m, size_t count)
{
	const size_t real = m->single ? sizeof(float) : sizeof(double), outputs = (size_t)m->own_outputs;
	const size_t rows = (size_t)(m->single ? m->manyf->rows : m->many->rows);
	const size_t factors = (size_t)(m->single ? m->manyf->factors : m->many->factors);
	struct lanes l = { .machine = m, .count = count };
	l.b = need(calloc(1, m->single ? m->manyf->size : m->many->size));
	l.y = need(calloc(rows * count, real));
	l.factors = need(calloc(factors * count, real));
	l.peak = need(calloc(outputs * count, real));
	l.u = need(calloc(STEPS_AT_ONCE * (size_t)m->inputs + 1, real));
	l.params = need(calloc((size_t)m->params, real));
	l.out = need(calloc(STEPS_AT_ONCE * outputs * count, real));
	l.wide = m->single ? need(calloc(STEPS_AT_ONCE * outputs * count, sizeof *l.wide)) : l.out;
	if (m->single)
		m->manyf->init(l.b, count, l.y, l.factors, l.peak);
	else
		m->many->init(l.b, count, l.y, l.factors, l.peak);
	return l;
}

static void lanes_free(struct lanes *l)
{
	free(l->b);
	free(l->y);
	free(l->factors);
	free(l->peak);
	free(l->u);
	free(l->params);
	free(l->out);
	if (l->machine->single)
		free(l->wide);
}

/* As the model's type has them */
static const void *as_real(const struct lanes *l, const double *from, size_t count, void *to)
{
	if (!l->machine->single)
		return from;
	for (size_t i = 0; i < count; i++)
		((float *)to)[i] = (float)from[i];
	return to;
}

static const double *as_doubles(const struct lanes *l, size_t count)
{
	for (size_t i = 0; l->machine->single && i < count; i++)
		l->wide[i] = (double)((float *)l->out)[i];
	return l->wide;
}

static void hold(void *who, const double *u)
{
	const struct lanes *l = who;
	const struct machine *m = l->machine;
	const void *sample = as_real(l, u, (size_t)m->inputs, l->u);
	if (m->single)
		m->manyf->hold(l->b, sample);
	else
		m->many->hold(l->b, sample);
}

/* Instance j with its params, and its row at t = 0; 0, or what is wrong with them */
static int tune(const struct lanes *l, size_t j, const double *params, struct stats *stats)
{
	const struct machine *m = l->machine;
	const void *values = as_real(l, params, (size_t)m->params, l->params);
	int status = m->single ? m->manyf->retune(l->b, j, values, l->out) : m->many->retune(l->b, j, values, l->out);
	const double *out = as_doubles(l, (size_t)m->own_outputs);
	for (int i = 0; i < m->outputs; i++)
		stats_column(stats, i, 0, 1, out + (m->shown ? m->shown[i] : i), 1);
	stats->rows = 1;
	return status;
}

/* Of a model in float, whose sums are in double */
static void take_rows(const struct lanes *l, const double *u, uint64_t k, size_t n, struct stats *stats)
{
	const struct machine *m = l->machine;
	m->manyf->run(l->b, n, m->inputs ? as_real(l, u, n * (size_t)m->inputs, l->u) : NULL, l->out, NULL);
	const size_t row = (size_t)m->own_outputs * l->count;
	const double *out = as_doubles(l, n * row);
	for (int i = 0; i < m->outputs; i++) {
		const double *column = out + (size_t)(m->shown ? m->shown[i] : i) * l->count;
		for (size_t j = 0; j < l->count; j++)
			stats_column(&stats[j], i, k, n, column + j, row);
	}
}

/* ---- on a device ---- */

struct shared {                         /* what instances share there in the next steps */
	const struct lanes *lanes;
	struct samples *samples;
};

static void share_steps(void *who, size_t n, double *now)
{
	const struct shared *s = who;
	const pl_many *many = s->lanes->machine->many;
	for (size_t k = 0; k < n; k += STEPS_AT_ONCE) {
		const size_t some = n - k < STEPS_AT_ONCE ? n - k : STEPS_AT_ONCE;
		many->share(s->lanes->b, some, samples_rows(s->samples, some), now + k * (size_t)many->shared);
	}
}

/* Sums as NAME_kernel has them, sum, squares in two parts, last value, from stats or to them */
static void move_sums(const struct lanes *l, double *sum, struct stats *stats, bool back)
{
	const size_t count = l->count, each = (size_t)l->machine->own_outputs * count;
	for (int i = 0; i < l->machine->outputs; i++) {
		const size_t output = (size_t)(l->machine->shown ? l->machine->shown[i] : i);
		for (size_t j = 0; j < count; j++) {
			struct output_stats *of = &stats[j].of[i];
			const size_t place = output * count + j;
			double *const at = sum + place, *const peak = (double *)l->peak + place;
			double *const kept[] = { &of->squares, &of->low, &of->last, &of->peak };
			double *const there[] = { at + each, at + 2 * each, at + 3 * each, peak };
			for (int k = 0; k < 4; k++)
				*(back ? kept : there)[k] = *(back ? there : kept)[k];
		}
	}
}

/* NULL, or why it could not */
static char *run_on_device(const struct lanes *l, const struct job *job, struct samples *samples, double *sum)
{
	const struct machine *m = l->machine;
	const size_t outputs = (size_t)m->own_outputs;
	const struct batch_arrays arrays = { l->count, (size_t)m->many->rows, (size_t)m->many->factors,
					     (size_t)m->many->shared, outputs, l->y, l->factors, l->peak, sum };
	return kernel_run(m->kernel, &arrays, job->steps, share_steps, &(struct shared){ l, samples });
}

/* NULL, or why a device could not */
static char *take_steps(const struct lanes *l, const struct job *job, struct samples *samples, struct stats *stats)
{
	const struct machine *m = l->machine;
	const size_t each = (size_t)m->own_outputs * l->count;
	double *sum = need(calloc(4 * each, sizeof *sum));
	char *error = NULL;
	if (!m->single)
		move_sums(l, sum, stats, false);
	if (m->kernel)
		error = run_on_device(l, job, samples, sum);
	else for (uint64_t k = 1; k <= job->steps; k += STEPS_AT_ONCE) {
		const size_t n = job->steps - k < STEPS_AT_ONCE ? (size_t)(job->steps - k) + 1 : STEPS_AT_ONCE;
		const double *u = samples_rows(samples, n);
		if (m->single)
			take_rows(l, u, k, n, stats);
		else
			m->many->run(l->b, n, u, NULL, sum + each);
	}
	for (size_t j = 0; j < l->count; j++)
		stats[j].rows = job->steps + 1;
	if (!m->single && !error)
		move_sums(l, sum, stats, true);
	free(sum);
	return error;
}

char *lanes_run(const struct job *job, size_t count, const double *const *params, struct stats *stats, bool *done)
{
	const struct machine *m = job->machine;
	struct lanes l = lanes_new(m, count);
	struct samples *samples = samples_begin(job, hold, &l);
	for (size_t j = 0; j < count; j++)
		done[j] = tune(&l, j, params[j], &stats[j]) == 0;
	char *error = take_steps(&l, job, samples, stats);
	for (size_t j = 0; j < count; j++)
		done[j] = !error && done[j] && stats_in_range(&stats[j]) &&
			  (m->single ? m->manyf->status(l.b, j) : m->many->status(l.b, j)) == 0;
	samples_end(samples);
	lanes_free(&l);
	return error;
}
