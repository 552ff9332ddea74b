/* SPDX-License-Identifier: GPL-3.0-or-later */
/* States that a model's own steps come to here, where no closed form gives them: for its self-test on a target. */
#include "run/run.h"
#include "step/certify/certify.h"

#include <math.h>

/* u = 1 - t/h of what ramps; else 1: as NAME_selftest has it */
static struct sampled samples_of_test(const struct step *step, long count)
{
	const struct linear *system = &step->model->system;
	const int inputs = system->inputs;
	struct sampled d = { .inputs = inputs, .h = mpq_get_d(outer_step(step->model)), .samples = count };
	d.ramps = ARRAY(bool, (size_t)inputs + 1);
	d.sample = ARRAY(double, (size_t)(inputs * (count + 2)) + 1);
	for (int i = 0; i < inputs; i++) {
		d.ramps[i] = system->input[i].hold > 0;
		for (long k = 0; k < count + 2; k++)
			d.sample[k * inputs + i] = d.ramps[i] ? 1 - (double)k : 1;
	}
	return d;
}

static bool is_regular(struct running *r, const double *y, int states)
{
	bool finite = running_status(r) == 0;
	for (int i = 0; i < states; i++)
		finite = finite && isfinite(y[i]);
	return finite;
}

/* As after NAME_init, which forgets samples, and then the states and samples */
static void begin(struct running *r, const struct sampled *d, const double *start)
{
	running_start(r, 0, NULL);
	running_start(r, 0, start);
	running_drive(r, d, 0);
}

/* Rows as long as the states stay within their range, and the status is 0 */
static void fill_rows(struct running *r, const struct sampled *d, struct reference *known)
{
	SCRATCH double *u = ARRAY(double, (size_t)d->inputs + 1);
	unsigned long k = 0;
	begin(r, d, known->start);
	for (known->rows = 0; known->rows < FEW_ROWS; known->rows++) {
		double *y = known->value + known->rows * known->states;
		for (; k < known->steps[known->rows]; k++) {
			drive_step(d, (long)k, u);
			running_step(r, u);
		}
		running_state(r, y);
		if (!is_regular(r, y, known->states))
			break;
	}
}

static void fill_between(struct running *r, const struct sampled *d, struct reference *known)
{
	SCRATCH double *u = ARRAY(double, (size_t)d->inputs + 1);
	begin(r, d, known->start);
	drive_step(d, 0, u);
	(void)running_at(r, u, d->h / 2, known->between);
}

static const char *replay(const struct step *step, struct place at, struct reference *known)
{
	const char *why;
	struct running *r = running_new(at, step, 0, &why);
	if (!r)
		return why;
	*known = new_reference(step->model->written->system.states);
	const struct sampled d = samples_of_test(step, (long)known->steps[FEW_ROWS - 1]);
	running_start(r, 0, NULL);
	running_state(r, known->start);
	fill_rows(r, &d, known);
	if (known->rows == 0)
		return format("the first step from the initial values ends with status %d", running_status(r));
	fill_between(r, &d, known);
	reference_units(known, step->model->request.single);
	return NULL;
}

bool find_replayed(struct step *step)
{
	if (!step->model->request.selftest || has_closed_form(step))
		return true;
	const struct place at = { source_argument("--selftest"), 0 };
	struct reference *known = NEW(struct reference);
	const char *why = replay(step, at, known);
	if (why)
		say_error(at, NULL, "--selftest has nothing to compare with: %s", why);
	step->replayed = known;
	return why == NULL;
}
