/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of linear models whose loads are known nothing is left to chance: the exact outputs, enclosed at every sample, for
 * the run of a step bit by bit beside them. What it is off is the error itself, as long as a compiler rounds each
 * product and each sum as it is written. */
#include "run/run.h"
#include "step/linear/images.h"

#include <math.h>

/* Samples times what an exact one is a sum of; states */
enum { MOST_EXACT = 1000000, MOST_STATES = 48 };

struct making {
	const struct model *full;       /* of all modes, as written */
	const struct requirement *needs;
	struct closed_form *form;
	struct course *course;
};

/* Two needs may be of one output. */
static int first_need(const struct requirement *needs, int i)
{
	int first = 0;
	while (needs[first].output != needs[i].output)
		first++;
	return first;
}

static void make_sample(const struct making *m, long k, mpq_srcptr t)
{
	struct course *c = m->course;
	double *const value = c->value + k * c->needs, *const low = c->low + k * c->needs;
	for (int i = 0; i < c->needs; i++) {
		const struct output *output = &m->full->output[m->needs[i].output];
		const int first = first_need(m->needs, i);
		struct coefficient now = { .value = value[first], .low = low[first] };
		if (first == i)
			now = closed_form_value(m->form, output, t, true, output->name);
		value[i] = now.value;
		low[i] = now.low;
	}
}

static void make_samples(void *context)
{
	const struct making *m = context;
	RATIONAL t = ZERO;
	for (long k = 0; k <= m->course->samples; k++) {
		make_sample(m, k, t);
		mpq_add(t, t, m->full->h);
	}
}

struct course *exact_course_of(const struct model *full, const struct model *stepped)
{
	const struct linear *system = &full->system;
	const struct requirement *needs = stepped->needs.requirement;
	const double h = mpq_get_d(full->h);
	int outputs = 0;
	for (int i = 0; i < stepped->needs.requirements; i++)
		outputs += first_need(needs, i) == i;
	const double each = (double)(system->states + 2 * load_columns(system)) * outputs;
	if (system->inputs > 0 || system->states > MOST_STATES || each * longest_need(stepped) / h > MOST_EXACT)
		return NULL;
	struct course *course = course_of(stepped, h);
	course->low = ARRAY(double, (size_t)(course->samples + 1) * (size_t)course->needs);
	target_double();
	struct making m = { full, needs, NULL, course };
	m.form = closed_form_new(full->request.step_at, system, full->initial, full->h, false);
	return silent_guard(make_samples, &m) ? course : NULL;
}
