/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which states, inputs, loads and functions forms read. */
#include "reads.h"

/* The piecewise-linear functions are comparisons in C. */
static bool calls_libm(const struct atom *a)
{
	return a->kind == ATOM_POWER || (a->kind == ATOM_CALL && a->function < FN_ABS);
}

int held_values(const struct model *model)
{
	return model->spec->tuned.count + model->params.leads.count;
}

const struct symbol *held_symbol(const struct model *model, int held)
{
	const int lead = held - model->spec->tuned.count;
	return lead < 0 ? model->spec->tuned.tunable[held].symbol : model->params.leads.lead[lead].symbol;
}

static void look_at_form(struct reads *reading, const struct model *model, bool *seen, const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		const struct atom *atom = basis->atom;
		if (is_highest(&model->frame, basis))
			reading->highest[basis->index] = true;
		else if (basis->kind == BASIS_COORD)
			reading->state[basis->order ? model->system.velocity[basis->index] : basis->index] = true;
		else if (basis->kind == BASIS_INPUT)
			reading->input[basis->index + basis->order * model->system.inputs] = true;
		else if (basis->kind == BASIS_FORCING && is_polynomial(basis->forcing))
			reading->time = true;
		for (int l = 0; basis->kind == BASIS_FORCING && l < model->system.loads; l++)
			if (model->system.load[l].forcing == basis->forcing && !is_polynomial(basis->forcing)) {
				reading->load[l] = true;
				/* its load states up to the highest power */
				reading->time = reading->time || model->system.load[l].powers > 1;
			}
		if (!atom || seen[atom->index])
			continue;
		seen[atom->index] = true;
		reading->math = reading->math || calls_libm(atom);
		if (atom->kind == ATOM_PARAM)
			reading->param[atom->param->tuning.number - 1] = true;
		/* that is a row of its region */
		bool friction = atom->kind == ATOM_CALL && atom->function >= FN_FRICTION;
		for (int k = 0; k < atom->operands && !friction; k++)
			look_at_form(reading, model, seen, atom->operand[k]);
	}
}

struct reads reads_of(const struct model *model, int count, const struct form *const *form)
{
	struct reads reading = { ARRAY(bool, model->system.states),
				 ARRAY(bool, 2 * (size_t)model->system.inputs), ARRAY(bool, model->system.loads),
				 ARRAY(bool, model->n + model->spec->count.multipliers),
				 ARRAY(bool, held_values(model) + 1), false, false };
	bool *seen = ARRAY(bool, model->equations.atoms ? (size_t)atoms_count(model->equations.atoms) : 0);
	for (int i = 0; i < count; i++)
		look_at_form(&reading, model, seen, form[i]);
	return reading;
}

bool reads_friction(const struct model *model, const struct form *form)
{
	SCRATCH bool *seen = ARRAY(bool, model->equations.atoms ? (size_t)atoms_count(model->equations.atoms) : 0);
	bool any = false;
	for (const struct form_term **term = terms_within(form, seen); *term; term++) {
		const struct atom *atom = (*term)->basis.atom;
		any = any || (atom && atom->kind == ATOM_CALL && atom->function >= FN_FRICTION);
	}
	return any;
}

bool reads_input_slope(const struct model *model, int input)
{
	bool any = false;
	for (int i = 0; i < model->outputs; i++)
		any = any || model->output[i].left || mpq_sgn(model->output[i].input[1][input]) != 0;
	return any;
}

int coordinate_of_row(const struct model *model, int row)
{
	int coord = 0;
	while (model->equations.owner[coord] != row)
		coord++;
	return coord;
}

bool has_steady_outputs(const struct model *model)
{
	bool steady = model->declared_outputs && model->system.segments == 1;
	for (int i = 0; i < model->outputs; i++)
		steady = steady && !model->output[i].left;
	return steady;
}
