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

static void begin(struct running *r, const struct sampled *drive, const double *start)
{
	running_start(r, 0, NULL);
	if (drive)
		running_drive(r, drive, 0);
	if (start)
		running_start(r, 0, start);
}

/* What is needed at sample k; sizes of the states are kept. */
static void take_sample(const struct solvers *solvers, struct course *course, long k, double *y)
{
	running_needed(solvers->r, course->value + k * course->needs);
	running_state(solvers->r, y);
	for (int i = 0; i < running_step_of(solvers->r)->model->written->system.states && solvers->size; i++)
		solvers->size[i] = fmax(solvers->size[i], fabs(y[i]));
}

struct course *stepped_course(const struct solvers *solvers, const double *start, const char **why)
{
	const struct model *model = running_step_of(solvers->r)->model;
	struct course *course = course_of(model, solvers->h);
	SCRATCH double *u = ARRAY(double, 2 * (size_t)model->system.inputs + 1);
	SCRATCH double *y = ARRAY(double, (size_t)model->written->system.states + 1);
	const uint64_t before = running_counted(solvers->r).multiplications;
	const char *ended = NULL;
	begin(solvers->r, solvers->drive, start);
	take_sample(solvers, course, 0, y);
	for (long k = 0; k < course->samples && !ended; k++) {
		if (solvers->drive)
			drive_step(solvers->drive, k, u);
		running_step(solvers->r, u);
		take_sample(solvers, course, k + 1, y);
		if (running_status(solvers->r) != 0)
			ended = format("a reference ends with status %d at t = %.3g s", running_status(solvers->r),
				       running_time(solvers->r));
		else if (running_counted(solvers->r).multiplications - before > solvers->most)
			ended = "a reference would take too long";
	}
	if (!ended)
		return course;
	*why = ended;
	course_free(course);
	return NULL;
}

struct trial trial_of(struct running *r, const struct course *reference, const double *start,
		      const struct sampled *drive)
{
	const struct model *model = running_step_of(r)->model;
	struct trial trial = { .error = ARRAY(double, 2 * (size_t)reference->needs + 1) };
	double *u = ARRAY(double, 2 * (size_t)model->system.inputs + 1);
	begin(r, drive, start);
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
		if (running_status(r) != 0)
			trial.why = format("it ends with status %d at t = %.3g s", running_status(r), trial.until);
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
