/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether a step turns modes in the place of states: where nothing stands against it, and it costs less than half. */
#include "inner.h"

/* ---- what stands against it ---- */

static bool simple_poles(const struct block *block)
{
	INTEGER content = INTEGER_ZERO;
	struct resolvent *resolvent = resolvent_of(&block->system);
	const struct spectrum *spectrum = spectrum_of(poly_primitive(*resolvent_determinant(resolvent), content));
	bool simple = spectrum->zero <= 1;
	for (int f = 0; f < spectrum->factors; f++)
		simple = simple && spectrum->factor[f].multiplicity == 1;
	return simple;
}

static const char *objection_of_loads(const struct linear *system)
{
	for (int l = 0; l < system->loads; l++)
		if (load_acts(system, &system->load[l]) && system->load[l].powers > 1)
			return "a load has a power of t";
	return NULL;
}

/* What stands against it; NULL: nothing */
static const char *modal_objection(const struct step *step)
{
	const struct linear *system = &step->branch->system;
	struct block *block;
	const char *why = step_objection(step, CAN_MODAL);
	if (why)
		return why;
	if (objection_of_loads(system))
		return objection_of_loads(system);
	int blocks = blocks_of(system, &block);
	for (int b = 0; b < blocks; b++)
		if (!simple_poles(&block[b]))
			return "a pole is repeated";
	return NULL;
}

/* ---- the choice ---- */

static int driven_terms(const struct modal *modal)
{
	int terms = 0;
	for (int i = 0; i < modal->states * modal->loads; i++)
		terms += modal->load[i] != 0;
	for (int i = 0; i < modal->states * modal->inputs; i++)
		terms += modal->input[i] != 0;
	return terms;
}

static struct program *modal_program(const struct step *step)
{
	const struct modal *modal = step->modal;
	struct program *program = NEW(struct program);
	const int terms = driven_terms(modal);
	*program = *step->program;
	program->assignment = ARRAY(struct assignment, program->assignments);
	for (int i = 0; i < program->assignments; i++) {
		program->assignment[i] = step->program->assignment[i];
		program->assignment[i].carried = false; /* of states: modes only add up what drives them */
	}
	program->loops = true;
	program->products_added = false;
	program->groups = 0;
	program->multiplications = 4 * modal->pairs + modal->reals + terms + program->forcing_multiplications;
	program->additions = 2 * modal->pairs + terms + program->forcing_additions;
	return program;
}

static bool only_linear_outputs(const struct model *model)
{
	bool linear = model->declared_outputs;
	for (int i = 0; i < model->outputs; i++)
		linear = linear && !model->output[i].left;
	return linear;
}

/* The cost of a step and its outputs is less than half of what it is now. */
static bool is_cheaper(const struct step *step)
{
	const int states = step->branch->system.states;
	const int modal = (2 + step->model->outputs + input_columns(&step->branch->system) +
			   load_columns(&step->branch->system)) * states;
	return 2 * modal < step->program->multiplications;
}

static void take_modal(struct step *step, struct modal *modal)
{
	if (step->refresh) {
		leave_out_refresh(step, "modes take their loads as they are");
		step->program = linear_program(step);
	}
	step->modal = modal;
	step->form = FORM_MODAL;
	step->program = modal_program(step);
	step->carried.count = 0;
	for (int i = 0; i < modal->states; i++)
		step->carried.place[i] = -1;
}

void plan_modal(struct step *step)
{
	enum { AS_EXACT = 8 };          /* what states may lose that become modes, where nobody asked for them */
	const struct model *model = step->model;
	const bool requested = model->request.form == FORM_MODAL;
	const bool wanted = model->request.form == FORM_AUTO && step->branch->system.states > LIMIT_UNROLLED_STATES &&
			    only_linear_outputs(model) && step->program->loops && is_cheaper(step);
	if (!requested && !wanted)
		return;
	const char *objection = modal_objection(step);
	struct modal *modal = objection ? NULL : modal_of(step);
	if (requested && !modal)
		leave_form(step, objection ? objection : "two poles, or a pole and a load, are too close");
	if (modal && (requested || modal->condition <= AS_EXACT))
		take_modal(step, modal);
	else
		step->no.modal = objection ? objection
				 : modal   ? format("states that become modes would lose a factor of %.3g",
						    modal->condition)
					   : "two poles, or a pole and a load, are too close";
}
