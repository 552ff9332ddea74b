/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Starts and loads beside those of the spec: what is chosen is tried from there too. */
#include "measuring.h"
#include "model/checks.h"
#include "step/certify/certify.h"

#include <string.h>

static const char *value_of_param(const struct symbol *s)
{
	return s->value ? text_between(s->value->start, s->value->end) : NULL;
}

static struct request with_param(struct request as, const struct symbol *s, const char *by)
{
	struct definitions more = { 0 };
	for (int i = 0; i < as.definitions.count; i++)
		*MORE(more.definition, more.count) = as.definitions.definition[i];
	definitions_add(format("%s=%s*(%s)", s->name, by, value_of_param(s)), &more);
	as.definitions = more;
	return as;
}

static void find_amplitudes(struct measuring *m, const struct alternative *a)
{
	const struct request as = request_of(m, a);
	const struct step *here = built(m, &as, NULL);
	if (m->amplitudes_known)
		return;
	m->amplitudes_known = true;
	if (!here)
		return;
	for (const struct symbol *s = m->model->spec->first; s; s = s->next) {
		if (s->kind != SYMBOL_PARAM || !value_of_param(s) || m->amplitudes == 16)
			continue;
		const struct request other = with_param(as, s, "1.1");
		const struct step *there = built(m, &other, NULL);
		if (!there || !differ_in_loads(here->model, there->model))
			continue;
		*MORE(m->amplitude, m->amplitudes) = s;
	}
}

static void name_neighbour(struct alternative *a, const char *name)
{
	a->neighbour_names = a->neighbour_names ? format("%s, %s", a->neighbour_names, name) : name;
}

/* From a neighbour: the excess of the worst is kept, and what it was. Where contacts or constraints leave no motion
 * from there, it is none. */
static void try_near(struct measuring *m, struct alternative *a, struct ready *ready, const double *start,
		     const char *what)
{
	struct alternative copy = *a;
	const double error_ratio = tried_from(m, &copy, ready, start, a->worst_input, false);
	if (error_ratio < 0)
		return;
	a->neighbours++;
	if (error_ratio <= a->worst_neighbour)
		return;
	a->worst_neighbour = error_ratio;
	a->worst_name = what;
}

/* As initial values are, onto constraints; false: they are not met from there */
static bool meet_constraints_from(struct measuring *m, const struct alternative *a, double *start)
{
	if (m->model->spec->count.multipliers == 0)
		return true;
	struct request as = request_of(m, a);
	as.again.start = start;
	const struct step *there = built(m, &as, NULL);
	for (int i = 0; there && i < m->model->written->system.states; i++)
		start[i] = mpq_get_d(there->model->written->initial[i]);
	return there != NULL;
}

static void try_starts(struct measuring *m, struct alternative *a, struct ready *ready)
{
	const struct model *written = m->model->written;
	const int states = written->system.states;
	double *as_written = ARRAY(double, states), *start = ARRAY(double, states);
	running_start(m->solvers.r, 0, NULL);
	running_state(m->solvers.r, as_written);
	for (int i = 0; i < states; i++) {
		if (as_written[i] == 0)
			continue;
		name_neighbour(a, written->names.state[i]);
		for (int up = 0; up < 2; up++) {
			memcpy(start, as_written, (size_t)states * sizeof *start);
			start[i] = as_written[i] * (up ? 1.1 : 0.9);
			const char *what = format("%s = %.3g at the start", written->names.state[i], start[i]);
			if (meet_constraints_from(m, a, start))
				try_near(m, a, ready, start, what);
		}
	}
}

static void try_amplitudes(struct measuring *m, struct alternative *a)
{
	for (int k = 0; k < 2 * m->amplitudes; k++) {
		const struct symbol *s = m->amplitude[k / 2];
		const char *why = NULL, *by = k % 2 ? "1.1" : "0.9";
		if (k % 2)
			name_neighbour(a, s->name);
		struct request as = with_param(request_of(m, a), s, by), wide = as;
		wide.single = false;
		struct ready ready = ready_of(m, &as, &why);
		ready.solvers.r = ready_of(m, &wide, &why).r;
		if (ready.r && ready.solvers.r)
			try_near(m, a, &ready, NULL, format("%s times %s", s->name, by));
	}
}

/* With the inputs of the largest error, a tenth smaller; larger ones are beyond their bounds */
static void try_smaller_inputs(struct measuring *m, struct alternative *a, struct ready *ready)
{
	if (!m->drive)
		return;
	struct sampled *drive = &m->drive[a->worst_input], as_found = *drive;
	const long numbers = (drive->samples + 2) * drive->inputs;
	drive->sample = ARRAY(double, numbers);
	for (long i = 0; i < numbers; i++)
		drive->sample[i] = 0.9 * as_found.sample[i];
	name_neighbour(a, drive->inputs > 1 ? "the inputs (less only)" : "the input (less only)");
	try_near(m, a, ready, NULL, "inputs are a tenth smaller");
	discard(drive->sample);
	*drive = as_found;
}

void try_neighbours(struct measuring *m, struct alternative *a)
{
	const struct request as = request_of(m, a);
	struct ready ready = ready_of(m, &as, &a->why);
	if (!ready.r)
		return;
	try_starts(m, a, &ready);
	try_smaller_inputs(m, a, &ready);
	find_amplitudes(m, a);
	try_amplitudes(m, a);
}
