/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Constraints: what brings a state back onto them, and the energy that is conserved beside them. */
#include "building.h"
#include "capability.h"
#include "model/contacts/friction.h"
#include "state_mass.h"

#include <string.h>

enum { LEVELS = 2 };                /* positions, velocities */

/* ---- corrections ---- */

/* The system of a block with the constraints' own values on the right: x of [M G^T; G 0] [x; .] = [0; g] */
static void correct_block(struct building *b, const struct moving_mass *mass, int level)
{
	const struct linear *system = &b->model->system;
	const struct written_system *written = mass->plain.written;
	struct linear_system e = mass->plain;
	const struct form **g = ARRAY(const struct form *, e.n);
	for (int i = 0; i < e.n; i++) {
		const int constraint = written->highest[i].index - b->model->n;
		const struct form *held = constraint < 0 ? NULL : equations_of(b)->constraint[constraint].by[level];
		g[i] = held ? held : NEW(struct form);
	}
	e.f = g;
	e.written = NULL;
	for (int i = 0; i < e.n; i++) {
		const int coord = written->highest[i].index;
		if (coord < b->model->n)
			b->model->equations.correction[level ? system->velocity[coord] : coord] =
				kept_solution(&b->collector, mass->node, &e, i);
	}
}

static void build_corrections(struct building *b)
{
	const struct segment_equations *rows = equations_of(b);
	const int states = b->model->system.states;
	const int keep = (int)b->collector.keep;
	b->collector.keep = KEEP_ALL;
	b->model->equations.correction = ARRAY(const struct form *, states);
	for (int i = 0; i < states; i++)
		b->model->equations.correction[i] = NEW(struct form);
	for (int i = 0; i < rows->masses; i++)
		for (int level = 0; level < LEVELS; level++)
			correct_block(b, &rows->mass[i], level);
	b->collector.keep = (unsigned)keep;
}

/* ---- the energy, where it is conserved: T and V alone act, T is quadratic in velocities, and constraints hold however
 * fast the motion along them is ---- */

static bool reads(const struct building *b, const struct form *form, bool velocities)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	bool any = false;
	for (const struct form_term **term = terms_within(form, seen); *term; term++)
		any = any || (*term)->basis.kind == BASIS_FORCING ||
		      (velocities && (*term)->basis.kind == BASIS_COORD && (*term)->basis.order > 0);
	return any;
}

static bool energies_alone(const struct building *b)
{
	const struct spec *spec = b->spec;
	bool alone = !b->model->relative && spec->equations == 0 && spec->count.inputs == 0 && spec->tuned.count == 0 &&
		     b->model->contacts.impacts == 0 && b->model->system.states == 2 * b->model->n;
	for (int i = 0; i < spec->elements; i++)
		alone = alone && spec->element[i].kind == ELEMENT_ENERGY;
	for (int i = 0; i < spec->lagrange.energies; i++)
		alone = alone && strchr("TVG", spec->lagrange.energy[i].kind) && spec->lagrange.energy[i].own == 0;
	return alone;
}

/* 0 where all velocities are */
static bool vanishes_at_rest(struct point *rest, const struct form *form)
{
	return form_at(rest, form)->terms == 0;
}

static bool is_quadratic(struct building *b, struct point *rest, const struct form *T)
{
	const struct segment_equations *rows = equations_of(b);
	bool quadratic = vanishes_at_rest(rest, T);
	for (int j = 0; j < b->model->n && quadratic; j++)
		quadratic = vanishes_at_rest(rest, form_derivatives(&b->collector, 1, &T, false, j, 1)[0]);
	for (int i = 0; i < rows->masses; i++)
		for (int k = 0; k < rows->mass[i].system.n * rows->mass[i].system.n && quadratic; k++)
			quadratic = !reads(b, rows->mass[i].system.M[k], true);
	return quadratic;
}

void find_conserved(void *building)
{
	struct building *b = building;
	const struct segment_equations *rows = equations_of(b);
	const int n = b->model->n, keep = (int)b->collector.keep;
	const struct form *T = rows->energy[0], *V = rows->energy[1] ? rows->energy[1] : form_number(0);
	struct fixing *fixing = ARRAY(struct fixing, n);
	if (!energies_alone(b) || !T || reads(b, T, false) || reads(b, V, true))
		return;
	for (int j = 0; j < n; j++) {
		fixing[j] = (struct fixing){ .symbol = b->model->frame.coord[j], .coord = j, .order = 1 };
		mpq_init(fixing[j].value);
	}
	b->collector.keep = KEEP_ALL;
	struct point *rest = point_new(&b->collector, n, fixing);
	bool stays = is_quadratic(b, rest, T);
	for (int i = 0; i < b->spec->count.multipliers && stays; i++)
		stays = vanishes_at_rest(rest, rows->constraint[i].by[1]);
	b->collector.keep = (unsigned)keep;
	b->model->equations.conserved[0] = stays ? T : NULL;
	b->model->equations.conserved[1] = stays ? V : NULL;
}

/* The projection knows no samples. */
static void check_inputs(const struct building *b)
{
	const struct segment_equations *rows = equations_of(b);
	for (int i = 0; i < rows->masses; i++) {
		const struct linear_system *e = &rows->mass[i].plain;
		SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
		for (int k = 0; k < e->n * e->n; k++)
			for (const struct form_term **term = terms_within(e->M[k], seen); *term; term++)
				if ((*term)->basis.kind == BASIS_INPUT)
					error(rows->mass[i].node->start, "a load of time may",
					      "an input may not change the mass matrix beside constraints");
	}
}

static void check_friction(const struct building *b)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	for (int i = 0; i < b->spec->count.multipliers; i++) {
		const struct atom *friction = friction_in(equations_of(b)->constraint[i].by[1], seen);
		if (friction)
			error(friction->node->at, NULL, "friction holds by its force: no constraint reads it");
	}
}

static void keep(void *context)
{
	struct building *b = context;
	refuse(CAN_CONSTRAINTS, b->model, equations_of(b)->constraint[0].statement->at);
	check_inputs(b);
	check_friction(b);
	if (!b->request->again.tunable)
		meet_constraints(b);            /* dependent ones are named before they are solved for */
	if (!b->eliminates)
		build_corrections(b);
}

void keep_constraints(struct building *b)
{
	statement_guard(keep, b);
}
