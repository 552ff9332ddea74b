/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of linear models whose loads are known nothing is left to chance: the exact outputs, each an enclosed sum of residues
 * at every sample, for the run of a step bit by bit beside them. What it is off is the error itself, as long as a
 * compiler rounds each product and each sum as it is written. */
#include "run/run.h"
#include "step/linear/images.h"

/* Samples times what an exact one is a sum of; states of which residues are found in a second */
enum { MOST_EXACT = 1000000, MOST_STATES = 48 };

struct making {
	const struct model *full;       /* of all modes, as written */
	const struct requirement *needs;
	struct resolvent *written;      /* its poles */
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

static void make_column(const struct making *m, int i)
{
	struct course *c = m->course;
	struct started *list;
	RATIONAL t = ZERO;
	const int first = first_need(m->needs, i);
	const struct output *output = &m->full->output[m->needs[i].output];
	const int count = responses_of_output(m->written, &m->full->system, m->full->initial, output, &list);
	for (long k = 0; k <= c->samples; k++) {
		struct coefficient value = { .value = c->value[k * c->needs + first],
					     .low = c->low[k * c->needs + first] };
		if (first == i)
			value = started_value(count, list, t, true, m->full->request.at.step, output->name);
		c->value[k * c->needs + i] = value.value;
		c->low[k * c->needs + i] = value.low;
		mpq_add(t, t, m->full->h);
	}
}

static void make_columns(void *context)
{
	const struct making *m = context;
	for (int i = 0; i < m->course->needs; i++)
		make_column(m, i);
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
	struct making m = { full, needs, resolvent_of(system), course };
	return silent_guard(make_columns, &m) ? course : NULL;
}
