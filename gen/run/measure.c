/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far a step is off, and what it takes: its C runs from start to end beside a reference. */
#include "run/run.h"

#include <math.h>

/* How far one is off at most: an exact one is known to 2^-104 of itself */
static double error_of_sample(const struct course *c, double got, long at)
{
	const double apart = fabs((got - c->value[at]) - (c->low ? c->low[at] : 0));
	return c->low ? apart * (1 + 0x1p-50) + fabs(c->value[at]) * 0x1p-104 : apart;
}

/* What is not a number stays one. */
static bool compare_sample(struct trial *trial, struct running *r, const struct course *reference, long k)
{
	const int needs = reference->needs;
	bool finite = true;
	trial->until = running_time(r);
	running_needed(r, trial->error + needs);
	for (int i = 0; i < needs; i++) {
		const double error = error_of_sample(reference, trial->error[needs + i], k * needs + i);
		if (k > reference->end[i])
			continue;
		trial->error[i] = error <= trial->error[i] ? trial->error[i] : error;
		finite = finite && isfinite(trial->error[i]);
	}
	return finite;
}

struct trial trial_of(struct running *r, const struct course *reference, const double *start,
		      const struct sampled *drive)
{
	const struct model *model = running_step_of(r)->model;
	struct trial trial = { .error = ARRAY(double, 2 * (size_t)reference->needs + 1) };
	double *u = ARRAY(double, 2 * (size_t)model->system.inputs + 1);
	running_start(r, 0, NULL);
	if (drive)
		running_drive(r, drive, 0);
	if (start)
		running_start(r, 0, start);
	bool finite = compare_sample(&trial, r, reference, 0);
	const struct counted before = running_counted(r);
	struct counted now = before;
	long k = 0;
	for (; k < reference->samples && finite && !trial.why; k++) {
		if (drive)
			drive_step(drive, k, u);
		running_step(r, u);
		finite = compare_sample(&trial, r, reference, k + 1);
		now = running_counted(r);
		const int status = running_status(r) & ~PL_LEFT_RANGE;
		if (status != 0)
			trial.why = format("it ends with status %d at t = %.3g s", status, trial.until);
		else if (now.multiplications - before.multiplications > LIMIT_MEASURED)
			trial.why = "it takes too long to be measured";
	}
	if (!finite && !trial.why)
		trial.why = format("it leaves the finite numbers at t = %.3g s", trial.until);
	const double steps = k > 0 ? (double)k : 1;
	trial.multiplications = (double)(now.multiplications - before.multiplications) / steps;
	trial.additions = (double)(now.additions - before.additions) / steps;
	trial.calls = (double)(now.calls - before.calls) / steps;
	return trial;
}

/* ---- courses ---- */

double sample_time(const struct model *model)
{
	return mpq_get_d(model->delays ? model->delays->h : model->h);
}

double longest_need(const struct model *model)
{
	double until = 0;
	for (int i = 0; i < model->needs.requirements; i++)
		until = fmax(until, mpq_get_d(model->needs.requirement[i].until));
	return until;
}

struct course *course_of(const struct model *model, double h)
{
	struct course *course = NEW(struct course);
	*course = (struct course){ .needs = model->needs.requirements, .end = ARRAY(long, model->needs.requirements) };
	for (int i = 0; i < course->needs; i++) {
		course->end[i] = (long)floor(mpq_get_d(model->needs.requirement[i].until) / h * (1 + 1e-14));
		course->samples = course->end[i] > course->samples ? course->end[i] : course->samples;
	}
	course->value = ARRAY(double, (size_t)(course->samples + 1) * (size_t)course->needs);
	return course;
}

double apart(const struct course *a, const struct course *b, int need)
{
	double most = 0;
	for (long k = 0; k <= a->end[need]; k++) {
		const double d = fabs(a->value[k * a->needs + need] - b->value[k * b->needs + need]);
		most = d <= most ? most : d;
	}
	return most;
}

double largest_of(const struct course *a, int need)
{
	double most = 0;
	for (long k = 0; k <= a->end[need]; k++)
		most = fmax(most, fabs(a->value[k * a->needs + need]));
	return most;
}

void course_free(struct course *course)
{
	discard(course->value);
	discard(course->end);
	discard(course);
}

static void note_sizes(struct running *r, double *y, double *size)
{
	running_state(r, y);
	for (int i = 0; i < running_step_of(r)->model->written->system.states; i++)
		size[i] = fmax(size[i], fabs(y[i]));
}

struct course *run_of(struct running *r, const struct sampled *drive, const double *start, double *size)
{
	const struct model *model = running_step_of(r)->model;
	struct course *c = course_of(model, sample_time(model));
	SCRATCH double *u = ARRAY(double, model->system.inputs + 1);
	SCRATCH double *y = ARRAY(double, model->written->system.states + 1);
	running_start(r, 0, NULL);
	if (drive)
		running_drive(r, drive, 0);
	if (start)
		running_start(r, 0, start);
	running_needed(r, c->value);
	for (long k = 0; k < c->samples; k++) {
		if (drive)
			drive_step(drive, k, u);
		running_step(r, u);
		if (size)
			note_sizes(r, y, size);
		running_needed(r, c->value + (k + 1) * c->needs);
	}
	return c;
}
