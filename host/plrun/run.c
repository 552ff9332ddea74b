/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run: NAME_step from t = 0 on, each row looked at by whoever watches. */
#include "plrun.h"

#include <stdlib.h>
#include <string.h>

/* The last k with k h <= end. What is a whole number but for the rounding of h and the quotient counts as whole. */
static bool steps_until(double end, double h, bool single, uint64_t *steps)
{
	double quotient = end / h;
	if (!(quotient < (double)MOST_STEPS))
		return false;
	*steps = (uint64_t)(quotient + 1e-9 + quotient * (single ? 0x1p-23 : 0x1p-52));
	return true;
}

char *plan_run(struct job *job)
{
	const struct record *r = job->record;
	uint64_t ahead = (uint64_t)job->machine->most_ahead;
	if (!(job->h > 0))
		return format("the step is not above 0");
	bool on_grid = !r || record_on_grid(r, job->h);
	uint64_t samples = r ? record_samples(r, job->h, on_grid) : 0;
	job->resampled = !on_grid;
	if (job->until >= 0 && !steps_until(job->until, job->h, job->machine->single, &job->steps))
		return format("T is more than 2^53 steps");
	if (job->until < 0 && samples == MOST_STEPS)
		return format("the record is more than 2^53 steps long");
	if (job->until < 0)
		job->steps = samples > ahead ? samples - ahead : 0;
	if (r && samples < job->steps + ahead)
		return format("too few samples: %llu steps take %llu, to t = %.6g, and there are %llu, to %.6g",
			      (unsigned long long)job->steps, (unsigned long long)(job->steps + ahead),
			      (double)(job->steps + ahead - 1) * job->h, (unsigned long long)samples,
			      (double)(samples - 1) * job->h);
	return NULL;
}

/* Of the record the rows that a step reads, `most_ahead` + 1 of them, the newest last; samples as steps take them */
struct samples {
	const struct job *job;
	double *row, *u;
	uint64_t next;
	size_t near;
};

static void take_sample(struct samples *s, double *u)
{
	const struct machine *m = s->job->machine;
	size_t n = (size_t)m->inputs, most = (size_t)m->most_ahead;
	memmove(s->row, s->row + n, sizeof *s->row * most * n);
	record_sample(s->job->record, s->job->h, !s->job->resampled, s->next++, &s->near, s->row + most * n);
	for (size_t i = 0; i < n; i++)
		u[i] = s->row[(size_t)m->ahead[i] * n + i];
}

/* The samples before the first step: row 0 of a ramp is its value at t = 0. What is held has its own there. */
struct samples *samples_begin(const struct job *job, void (*hold)(void *who, const double *u), void *who)
{
	const struct machine *m = job->machine;
	size_t n = (size_t)m->inputs;
	struct samples *s = need(calloc(1, sizeof *s));
	s->job = job;
	s->row = need(calloc(((size_t)m->most_ahead + 1) * n + 1, sizeof *s->row));
	s->u = need(calloc(STEPS_AT_ONCE * n + 1, sizeof *s->u));
	if (!job->record || job->steps + (uint64_t)m->most_ahead == 0)
		return s;
	for (int k = 0; k < m->most_ahead; k++) {
		take_sample(s, s->u);
		for (size_t i = 0; i < n; i++)
			if (m->ahead[i] == 0)
				s->u[i] = s->row[(size_t)m->most_ahead * n + i];
		hold(who, s->u);
	}
	return s;
}

const double *samples_rows(struct samples *s, size_t steps)
{
	for (size_t k = 0; s->job->record && k < steps; k++)
		take_sample(s, s->u + k * (size_t)s->job->machine->inputs);
	return s->u;
}

void samples_end(struct samples *s)
{
	free(s->row);
	free(s->u);
	free(s);
}

static char *status_text(int status, double t, bool single)
{
	char *text = format("t = %s:", shortest(t, single));
	if (status & PL_TOO_MANY_EVENTS)
		text = format("%s the step has met more crossings, or needed a longer search for them, "
			      "than its bound%s", text, status & PL_NOT_FINITE ? ";" : "");
	if (status & PL_NOT_FINITE)
		text = format("%s the step has left the finite numbers", text);
	if (status & PL_TOO_MANY_STEPS)
		text = format("%s the step needed more substeps than its bound", text);
	if (status & PL_INACCURATE)
		text = format("%s the last terms of the step are above the tolerance", text);
	if (status & PL_UNDECIDED)
		text = format("%s no combination of stick and slip was valid at an event", text);
	if (status & PL_PENETRATED)
		text = format("%s the step has ended beyond a stop", text);
	if (status & PL_SINGULAR_MASS)
		text = format("%s the mass matrix is singular, or gradients of constraints depend on each other", text);
	if (status & PL_LEFT_RANGE)
		text = format("%s a state has left the range that the spec gives it", text);
	if (status & ~(PL_UNDECIDED | PL_TOO_MANY_EVENTS | PL_NOT_FINITE | PL_TOO_MANY_STEPS | PL_INACCURATE |
		       PL_LEFT_RANGE | PL_PENETRATED | PL_SINGULAR_MASS))
		text = format("%s status %d", text, status);
	return text;
}

/* What is doubted of the derivatives from here on, once */
static void report_doubt(const struct instance *s, unsigned *known, bool single)
{
	const unsigned doubt = instance_doubt(s) & ~*known;
	const char *const all[] = {             /* PL_D_GRAZING and so on */
		"a stop was met, or all but met, so flatly that behind it they are not known",
		"events, or peaks, fell together, or an output jumps at its peak: they are of one side",
		"no combination of stick and slip was valid", "their own steps have failed"
	};
	*known |= doubt;
	for (int i = 0; i < (int)(sizeof all / sizeof *all); i++) {
		double time;
		if (!(doubt >> i & 1))
			continue;
		const int function = instance_first_doubt(s, i, &time);
		say_note(format("derivatives from t = %s on%s: %s", shortest(time, single),
				function < 0 ? "" : format(" (switching function %d)", function), all[i]));
	}
}

/* ---- states far below the size that their error is measured by ---- */

/* Per state its size in the rows since a power of two, and in as many before, and by how much a step may miss it */
struct sizes {
	double *y, *allowed, *recent, *before;
	int small;                              /* the first that was seen to be less; -1: none */
	double from, size, missed;
};

static struct sizes sizes_new(const struct job *job)
{
	size_t n = (size_t)job->machine->states;
	struct sizes z = { .small = -1 };
	if (!job->reported || !job->machine->allowed)
		return z;
	z.y = need(calloc(4 * n + 1, sizeof *z.y));
	z.allowed = z.y + n;
	z.recent = z.allowed + n;
	z.before = z.recent + n;
	return z;
}

static void judge(struct sizes *z, const struct job *job, struct instance *s, uint64_t k)
{
	enum { ENOUGH = 8 };            /* rows; fewer may all be close to a zero */
	instance_allowed(s, z->allowed);
	for (int i = 0; i < job->machine->states; i++) {
		const double size = z->recent[i] > z->before[i] ? z->recent[i] : z->before[i];
		if (k >= ENOUGH && z->small < 0 && size > 0 && size < z->allowed[i]) {
			z->small = i;
			z->from = (double)k * job->h;
			z->size = size;
			z->missed = z->allowed[i];
		}
		z->before[i] = z->recent[i];
		z->recent[i] = 0;
	}
}

static void take_sizes(struct sizes *z, const struct job *job, struct instance *s, uint64_t k)
{
	if (!z->y)
		return;
	instance_get(s, z->y);
	for (int i = 0; i < job->machine->states; i++) {
		const double size = z->y[i] < 0 ? -z->y[i] : z->y[i];
		z->recent[i] = size > z->recent[i] ? size : z->recent[i];
	}
	if ((k & (k - 1)) == 0 || k == job->steps)
		judge(z, job, s, k);
}

static void report_sizes(const struct sizes *z, const struct machine *m)
{
	if (z->small < 0)
		return;
	const char *name = m->state_names[z->small];
	say_note(format("before t = %.3g s %s was at most %.2g, less than the %.2g that a step may be wrong by, since "
			"its largest value counts: 'tolerance of %s = ...', or 'absolute' behind the tolerance, "
			"measures it otherwise", z->from, name, z->size, z->missed, name));
}

static bool is_at_zero(const struct job *job, struct instance *s)
{
	const size_t n = (size_t)job->machine->states;
	double *y = need(calloc(n + 1, sizeof *y));
	bool zero = true;
	instance_get(s, y);
	for (size_t i = 0; i < n; i++)
		zero = zero && y[i] == 0;
	free(y);
	return zero;
}

static void report(const struct job *job, uint64_t k)
{
	char line[120];
	if (!job->reported || (k & 63) || !progress_wanted())
		return;
	snprintf(line, sizeof line, "t = %.6g of %.6g s (%.0f %%)", (double)k * job->h, (double)job->steps * job->h,
		 100.0 * (double)k / (double)job->steps);
	progress(line);
}

/* A run under way: `out` has room for the rows of some steps, `kept` for the state before them */
struct course {
	const struct job *job;
	struct instance *s;
	double *out;
	void *kept;
	watch *each;
	void *who;
	struct sizes sizes;
	unsigned doubt;
};

static char *take_step(struct course *c, uint64_t k, const double *u)
{
	const struct job *job = c->job;
	instance_step(c->s, u);
	if (job->reported)
		report_doubt(c->s, &c->doubt, job->machine->single);
	int status = instance_status(c->s);
	take_sizes(&c->sizes, job, c->s, k);
	if (status)
		return status_text(status, instance_time(c->s), job->machine->single);
	instance_out(c->s, c->out);
	c->each(c->who, k, c->out);
	report(job, k);
	return NULL;
}

/* What is wrong after some steps was so after one of them, which those before show where they are taken singly. */
static char *take_block(struct course *c, uint64_t k, size_t n, const double *u)
{
	const struct machine *m = c->job->machine;
	char *error = NULL;
	memcpy(c->kept, c->s->state, m->size);
	instance_run(c->s, n, u, c->out);
	if (instance_status(c->s)) {
		memcpy(c->s->state, c->kept, m->size);
		for (size_t i = 0; i < n && !error; i++)
			error = take_step(c, k + i, u + i * (size_t)m->inputs);
		return error;
	}
	for (size_t i = 0; i < n; i++) {
		c->each(c->who, k + i, c->out + i * (size_t)m->outputs);
		report(c->job, k + i);
	}
	return NULL;
}

/* Beyond so many steps a jump costs less than they do */
static bool jumps(const struct course *c)
{
	enum { A_STATE = 1024 };
	const struct machine *m = c->job->machine;
	const bool has = m->single ? m->modelf->jump != NULL : m->model->jump != NULL;
	return has && !c->s->derivatives && !c->job->record && !c->sizes.y &&
	       c->job->apart / A_STATE >= (uint64_t)m->states + 1;
}

/* From row to row; a step at a time where something is wrong on the way */
static char *take_jumps(struct course *c)
{
	const struct job *job = c->job;
	char *error = NULL;
	uint64_t n;
	for (uint64_t k = 0; k < job->steps && !error; k += n) {
		n = job->steps - k < job->apart ? job->steps - k : job->apart;
		memcpy(c->kept, c->s->state, job->machine->size);
		instance_jump(c->s, n);
		if (instance_status(c->s)) {
			memcpy(c->s->state, c->kept, job->machine->size);
			for (uint64_t i = 1; i <= n && !error; i++)
				error = take_step(c, k + i, NULL);
			continue;
		}
		instance_out(c->s, c->out);
		c->each(c->who, k + n, c->out);
	}
	return error;
}

/* Where nobody looks at more than the outputs */
static size_t steps_at_once(const struct course *c)
{
	return c->s->derivatives || c->sizes.y || c->job->machine->shown ? 1 : STEPS_AT_ONCE;
}

static char *take_steps(struct course *c, struct samples *samples)
{
	const struct job *job = c->job;
	const size_t most = steps_at_once(c);
	const bool starts_at_zero = job->reported && is_at_zero(job, c->s);
	char *error = NULL;
	size_t n;
	instance_out(c->s, c->out);
	c->each(c->who, 0, c->out);
	if (jumps(c))
		error = take_jumps(c);
	else for (uint64_t k = 1; k <= job->steps && !error; k += n) {
		n = job->steps - k < most ? (size_t)(job->steps - k) + 1 : most;
		const double *u = samples_rows(samples, n);
		error = n > 1 ? take_block(c, k, n, u) : take_step(c, k, u);
	}
	report_sizes(&c->sizes, job->machine);
	if (!error && starts_at_zero && job->steps > 0 && !job->record && is_at_zero(job, c->s))
		say_note("nothing starts and nothing drives the model, so every state has stayed 0: give it an initial "
			 "value (init x = 1) or a load");
	return error;
}

/* NULL: the instance has the job's params. Else why not, by the name of the first whose value alone does not do */
static char *tuning_error(const struct job *job, struct instance *s)
{
	const struct machine *m = job->machine;
	const char *wrong = instance_retune(s, job->params, job->h);
	if (!wrong)
		return NULL;
	double *one = need(malloc(sizeof *one * (size_t)m->params));
	char *error = NULL;
	for (int k = 0; k < m->params && !error && !instance_retune(s, m->param_values, job->h); k++) {
		memcpy(one, m->param_values, sizeof *one * (size_t)m->params);
		one[k] = job->params[k];
		if (instance_retune(s, one, job->h))
			error = format("%s = %s: %s", m->param_names[k],
				       shortest(one[k] / param_value(m, k, 1), false), wrong);
	}
	free(one);
	return error ? error : format("%s", wrong);
}

static void hold_sample(void *who, const double *u)
{
	instance_hold(who, u);
}

char *run_steps(struct job *job, watch *each, void *who)
{
	const struct machine *m = job->machine;
	struct instance *s = instance_new(m);
	struct course c = { .job = job, .s = s, .each = each, .who = who };
	char *error = job->params ? tuning_error(job, s) : NULL;
	job->tuned = !error;
	if (!error) {
		c.sizes = sizes_new(job);
		c.out = need(malloc(sizeof *c.out * STEPS_AT_ONCE * (size_t)(m->outputs + 1)));
		c.kept = need(malloc(m->size));
		if (job->offset)
			instance_move(s, job->offset);
		struct samples *samples = samples_begin(job, hold_sample, s);
		error = take_steps(&c, samples);
		samples_end(samples);
		if (job->crossed && m->crossed)
			*job->crossed = m->crossed(s->state);
	}
	free(c.sizes.y);
	free(c.out);
	free(c.kept);
	instance_free(s);
	return error;
}
