/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Needs of linear models whose loads are known: nothing is left to chance, so the C of a step runs here from the start
 * to the end of the need, bit by bit, beside the exact outputs, each an enclosed sum of residues. What it is off at
 * every sample is the error itself, as long as a compiler rounds each product and each sum as it is written. */
#include "walked.h"

#include <math.h>

/* Samples times what an exact one is a sum of; states of which residues are found in a second */
enum { MOST_EXACT = 1000000, MOST_STATES = 48 };

struct exact_run {
	const struct model *model;      /* whose requirements are meant */
	long samples;                   /* after the first, of the longest need */
	long *end;                      /* per requirement: its last sample */
	int outputs;
	int *place;                     /* per output: which of the kept it is; -1: no need is of it */
	double *value, *low;            /* [output kept][sample]: in two words */
};

/* ---- the exact outputs ---- */

struct making {
	const struct model *full;       /* of all modes, as written */
	struct resolvent *written;      /* its poles */
	struct exact_run *run;
	int output;
};

static void make_output(void *context)
{
	const struct making *m = context;
	const struct exact_run *run = m->run;
	struct started *list;
	RATIONAL t = ZERO;
	const int count = responses_of_output(m->written, &m->full->system, m->full->initial,
					      &m->full->output[m->output], &list);
	const size_t first = (size_t)run->place[m->output] * (size_t)(run->samples + 1);
	for (long k = 0; k <= run->samples; k++) {
		const struct coefficient value = started_value(count, list, t, true, m->full->asked.step_at,
							       m->full->output[m->output].name);
		run->value[first + (size_t)k] = value.value;
		run->low[first + (size_t)k] = value.low;
		mpq_add(t, t, m->full->h);
	}
}

/* Below 0: they are too many to be counted */
static void find_ends(struct exact_run *run)
{
	const struct model *model = run->model;
	run->end = ARRAY(long, model->requirements);
	for (int i = 0; i < model->requirements && run->samples >= 0; i++) {
		run->end[i] = samples_until(&model->requirement[i], model->h);
		run->samples = run->end[i] < 0 || run->end[i] > run->samples ? run->end[i] : run->samples;
	}
}

struct exact_run *exact_run_of(const struct model *full, const struct model *stepped)
{
	struct exact_run *run = NEW(struct exact_run);
	const struct linear *system = &full->system;
	*run = (struct exact_run){ .model = stepped, .place = ARRAY(int, full->outputs) };
	find_ends(run);
	for (int i = 0; i < full->outputs; i++)
		run->place[i] = -1;
	for (int i = 0; i < stepped->requirements; i++) {
		int *place = &run->place[stepped->requirement[i].output];
		*place = *place >= 0 ? *place : run->outputs++;
	}
	const double each = (double)(system->states + 2 * load_columns(system)) * run->outputs;
	if (system->inputs > 0 || system->states > MOST_STATES || run->samples < 0 ||
	    each * (double)run->samples > MOST_EXACT)
		return NULL;
	const size_t numbers = (size_t)run->outputs * (size_t)(run->samples + 1);
	run->value = ARRAY(double, numbers);
	run->low = ARRAY(double, numbers);
	struct making m = { .full = full, .written = resolvent_of(system), .run = run };
	target_double();
	for (m.output = 0; m.output < full->outputs; m.output++)
		if (run->place[m.output] >= 0 && !silent_guard(make_output, &m))
			return NULL;
	return run;
}

static const double *of_output(const struct exact_run *run, const double *numbers, int output)
{
	return numbers + (size_t)run->place[output] * (size_t)(run->samples + 1);
}

double exact_samples(const struct exact_run *run)
{
	return (double)run->samples;
}

double exact_largest(const struct exact_run *run, int requirement)
{
	const double *value = of_output(run, run->value, run->model->requirement[requirement].output);
	double largest = 0;
	for (long k = 0; k <= run->end[requirement]; k++)
		largest = fmax(largest, fabs(value[k]));
	return largest * (1 - 0x1p-52);
}

/* ---- one step beside them ---- */

/* How far one sample is off at most: the exact one is known to 2^-104 of itself */
static double error_of_sample(double got, double value, double low)
{
	return fabs((got - value) - low) * (1 + 0x1p-50) + fabs(value) * 0x1p-104;
}

static bool keep_errors(const struct exact_run *run, struct running *r, long k, double *out, double *error)
{
	bool finite = true;
	running_outputs(r, out);
	for (int i = 0; i < run->model->requirements; i++) {
		const int output = run->model->requirement[i].output;
		if (k > run->end[i])
			continue;
		const double now = error_of_sample(out[output], of_output(run, run->value, output)[k],
						   of_output(run, run->low, output)[k]);
		finite = finite && isfinite(now);
		error[i] = fmax(error[i], now);
	}
	return finite;
}

bool walk_beside(const struct exact_run *run, const struct step *step, struct certificate *found)
{
	const char *why;
	const int requirements = run->model->requirements;
	double *out = ARRAY(double, step->model->outputs + 1), *error = ARRAY(double, requirements);
	struct running *r = running_new(run->model->requirement[0].need->at, step, 0, &why);
	if (!r)
		return false;
	running_start(r, 0, NULL);
	bool finite = keep_errors(run, r, 0, out, error);
	for (long k = 1; k <= run->samples && finite; k++) {
		running_step(r, NULL);
		finite = keep_errors(run, r, k, out, error) && running_status(r) == 0;
	}
	for (int i = 0; i < requirements && finite; i++) {
		found[i].walked = true;
		found[i].error = error[i];
	}
	return finite;
}
