/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Impacts and dry friction beside what is not piecewise linear, which a Taylor series is made of: no regions, but what
 * holds something and what lets it go as forms. */
#include "model/building.h"
#include "model/capability.h"
#include "model/checks.h"
#include "model/reads.h"
#include "contacts.h"
#include "inner.h"

/* The derivative that a form over states and their derivatives is, by the last coordinate in it */
static int column_of_form(const struct building *b, const struct form *form)
{
	int last = 0;
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == BASIS_COORD && form->term[i].basis.index > last)
			last = form->term[i].basis.index;
	return last < b->spec->joined.own ? 0 : (last - b->spec->joined.own) / b->spec->joined.stride;
}

/* Its index; -1: it is none */
static int drag_of(const struct model *model, const struct atom *atom)
{
	int index = model->contacts.drags - 1;
	while (index >= 0 && model->contacts.drag[index].atom != atom)
		index--;
	return index;
}

int motion_of_friction(const struct model *model, const struct atom *atom)
{
	return model->n + model->spec->count.multipliers + drag_of(model, atom);
}

/* Whether it reads multipliers, with which its force is solved for */
static bool reads_multipliers(const struct building *b, const struct node *node, const struct form *force)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	bool reads = false;
	for (const struct form_term **term = terms_within(force, seen); *term; term++) {
		if (!is_highest(&b->model->frame, &(*term)->basis))
			continue;
		reads = true;
		if ((*term)->basis.index < b->model->n)
			error(node->start, "a formula of the state, of time and of multipliers of constraints is built",
			      "friction by an acceleration, '%s', is not built", text_between(node->start, node->end));
	}
	return reads;
}

/* Not by what a sign or a comparison is of */
static bool depends_on_highest(const struct building *b, const struct form *form)
{
	bool depends = false;
	for (int i = 0; i < form->terms && !depends; i++) {
		const struct atom *a = form->term[i].basis.atom;
		if (!a)
			depends = is_highest(&b->model->frame, &form->term[i].basis);
		const bool chooses = a && a->kind == ATOM_CHOOSE;
		if (!a || !a->highest || a->kind == ATOM_COMPARE || (a->kind == ATOM_CALL && a->function == FN_SGN))
			continue;
		for (int k = chooses; k < a->operands && !depends; k++)
			depends = depends_on_highest(b, a->operand[k]);
	}
	return depends;
}

static void derive_force(struct building *b, struct drag *drag)
{
	const int unknowns = b->model->n + b->spec->count.multipliers;
	drag->by = ARRAY(struct form *, unknowns);
	b->collector.equation = true;
	for (int j = 0; j < unknowns; j++) {
		const int order = b->model->frame.coord[j]->highest;
		drag->by[j] = form_derivatives(&b->collector, 1, &drag->force, false, j, order)[0];
		drag->curved = drag->curved || depends_on_highest(b, drag->by[j]);
	}
	b->collector.equation = false;
}

static void add_drag(struct building *b, const struct atom *a)
{
	struct model *model = b->model;
	const struct form *v = a->operand[0];
	if (drag_of(model, a) >= 0)
		return;
	for (int i = 0; i < v->terms; i++) {
		const struct basis *basis = &v->term[i].basis;
		if (basis->kind == BASIS_ATOM && loads_change(&model->system))
			error(a->node->child[0]->start, "scheme exact takes others beside what is piecewise linear",
			      "beside a series the velocity of friction has one formula for all time");
		if ((basis->kind == BASIS_ATOM && !a->node->follows) || is_highest(&b->model->frame, basis))
			refuse_velocity_of_friction(a->node);
	}
	RATIONAL start = ZERO;
	bool reads = false;
	for (int i = 1; i < a->operands; i++)
		reads = reads_multipliers(b, a->node->child[i], a->operand[i]) || reads;
	for (int i = 1; i < a->operands && !a->node->follows; i++)
		check_force(a->node->child[i], a->operand[i], start, NULL);
	if (reads && b->spec->joined.columns > 0)
		error(a->node->at, NULL, "a sensitivity beside friction by multipliers is not built yet");
	struct drag *drag = MORE(model->contacts.drag, model->contacts.drags);
	*drag = (struct drag){ .atom = a, .velocity = v, .force = a->operand[1], .rest = a->operand[a->operands - 1],
			       .of = -1 };
	drag->rate = a->node->follows ? rate_with_atoms(b, v) : rate_of_form(b, v);
	if (reads)
		derive_force(b, drag);
	find_moving_drag(b, drag);
}

/* Friction that a function, a product or other friction has for an argument */
static void refuse_inside(const struct atom *a, bool *seen)
{
	for (int k = 0; k < a->operands; k++)
		for (const struct form_term **term = terms_within(a->operand[k], seen); *term; term++)
			if ((*term)->basis.atom && is_friction((*term)->basis.atom))
				error((*term)->basis.atom->node->at, "it stands alone in a sum: k*x + friction(x', F)",
				      "what is not piecewise linear has friction for an argument");
}

static void find_drags(struct building *b)
{
	bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	for (int i = 0; i < b->model->n; i++) {
		const struct form *form = residual_as_written(b->full, b->owner, i);
		for (int k = 0; k < form->terms; k++) {
			const struct atom *a = form->term[k].basis.atom;
			if (!a)
				continue;
			refuse_inside(a, seen);
			if (is_friction(a))
				add_drag(b, a);
		}
	}
}

/* Derivatives of friction: of a vector's components in their order */
static void find_followed(struct building *b)
{
	struct model_contacts *c = &b->model->contacts;
	bool *taken = ARRAY(bool, (size_t)(c->drags * (b->spec->joined.columns + 1)));
	for (int i = 0; i < c->drags; i++) {
		const struct node *of = c->drag[i].atom->node->follows;
		const int column = of ? column_of_form(b, c->drag[i].velocity) : 0;
		for (int k = 0; of && k < c->drags && c->drag[i].of < 0; k++)
			if (c->drag[k].atom->node == of && !taken[column * c->drags + k]) {
				c->drag[i].of = k;
				taken[column * c->drags + k] = true;
			}
		if (of && c->drag[i].of < 0)
			error(of->at, "as a param of a load or a stiffness it has one",
			      "friction of no force has no derivative");
	}
}

/* What an output reads of it, an acceleration by its equation too, would differ where it is held. */
static void refuse_in_output(const struct model *model, const struct output *output, const struct form *form,
			     bool *seen)
{
	for (const struct form_term **term = terms_within(form, seen); *term; term++)
		if ((*term)->basis.atom && is_friction((*term)->basis.atom))
			refuse(CAN_CARRIED, model, output->value->start);
}

/* An acceleration, by its equation */
static void refuse_in_row(const struct model *model, const struct output *output, const struct output *row, bool *seen)
{
	for (int c = 0; c < model->remainder.force_columns; c++)
		if (mpq_sgn(row->force_column[c]) != 0)
			refuse_in_output(model, output, model->schedule.operator[0].left[c], seen);
}

/* What rests has another acceleration than its equations say. */
static void refuse_acceleration(const struct building *b, const struct output *output, const struct form *form,
				bool *seen)
{
	for (const struct form_term **term = terms_within(form, seen); *term; term++)
		if (is_highest(&b->model->frame, &(*term)->basis))
			refuse(CAN_ACCELERATION, b->model, output->value->start);
}

const struct node *multiplier_in(const struct node *node)
{
	const struct symbol *symbol = node->kind == NODE_NAME ? node->symbol : NULL;
	const struct node *found = symbol && symbol->kind == SYMBOL_MULTIPLIER ? node : NULL;
	if (symbol && symbol->kind == SYMBOL_LET && symbol->value && multiplier_in(symbol->value))
		found = node;
	for (int i = 0; i < node->children && !found; i++)
		found = multiplier_in(node->child[i]);
	return found;
}

bool *motion_read(const struct model *model)
{
	const int first = model->n + model->spec->count.multipliers;
	bool *read = ARRAY(bool, first + model->contacts.drags + 1);
	bool *seen = ARRAY(bool, (size_t)atoms_count(model->equations.atoms));
	for (int i = 0; i < model->outputs; i++) {
		const struct form *form = model->output[i].left ? model->output[i].left : form_number(0);
		const struct reads reads = reads_of(model, 1, &form);
		for (int k = 0; k < first; k++)
			read[k] = read[k] || reads.highest[k];
		for (const struct form_term **term = terms_within(form, seen); *term; term++)
			if ((*term)->basis.atom && is_friction((*term)->basis.atom))
				read[motion_of_friction(model, (*term)->basis.atom)] = true;
	}
	return read;
}

struct asking {
	const struct building *b;
	const struct output *output;
};

static void check_output(void *context)
{
	const struct asking *work = context;
	const struct building *b = work->b;
	const struct model *model = b->model;
	bool moves = false;
	size_t atoms = (size_t)atoms_count(b->collector.atoms);
	bool *seen = ARRAY(bool, atoms), *read = ARRAY(bool, atoms);
	const struct form *form = work->output->form ? work->output->form : work->output->left;
	const struct atom *friction = form && !holds_friction(b) ? friction_in(form, seen) : NULL;
	if (friction)
		report_no_equation(friction);
	if (!has_contacts(model) || gives_motion(model))
		return;
	for (int i = 0; i < model->contacts.drags; i++)
		moves = moves || model->contacts.drag[i].moving;
	if (form && (has_bounces(model) || moves))
		refuse_acceleration(b, work->output, form, read);
	if (work->output->left)
		refuse_in_output(model, work->output, work->output->left, seen);
	else
		refuse_in_row(model, work->output, work->output, seen);
	const struct reads reads = reads_of(model, work->output->left != NULL, &form);
	for (int k = 0; k < model->n; k++)
		if (reads.highest[k])
			refuse_in_row(model, work->output, model->equations.highest[k], seen);
}

void check_contact_outputs(struct building *b)
{
	for (int i = 0; i < b->model->outputs; i++)
		statement_guard(check_output, &(struct asking){ b, &b->model->output[i] });
}

void find_contacts(struct building *b)
{
	const struct node *implicit = b->model->equations.implicit;
	if (implicit && (b->model->contacts.impacts > 0 || holds_friction(b)))
		refuse(CAN_CONTACTS, b->model, implicit->start);
	for (int i = 0; i < b->model->contacts.impacts; i++) {
		struct impact *impact = &b->model->contacts.impact[i];
		if (impact->moves && impact->when->restitution)
			find_moving_impact(b, impact);
		else if (impact->moves)
			find_bounce_with_slopes(b, impact);
		else if (impact->bounces)
			impact->in->press = rate_of_form(b, impact->in->speed);
	}
	find_drags(b);
	find_followed(b);
	find_masses(b);
}

/* What derivatives of an impact have */
static void place_loads_of_slope(struct building *b, const struct impact_law *law, const struct impact_slope *slope)
{
	place_loads_within(b, slope->guard);
	place_loads_within(b, slope->speed);
	for (int k = 0; k < slope->jumps; k++)
		place_loads_within(b, slope->jump[k].form);
	for (int j = 0; j < b->model->n && law->moving; j++) {
		place_loads_within(b, slope->moving->gradient[j]);
		place_loads_within(b, slope->moving->force_direction[j]);
	}
	if (law->moving)
		place_loads_within(b, slope->moving->rest);
}

/* Of what moves; their derivatives have no other */
static void place_loads_that_move(struct building *b, const struct moving_contact *c)
{
	for (int j = 0; j < b->model->n && c; j++) {
		place_loads_within(b, c->gradient[j]);
		place_loads_within(b, c->force_direction[j]);
	}
	if (c)
		place_loads_within(b, c->rest);
}

void place_contact_loads(struct building *b)
{
	const struct model *model = b->model;
	for (int i = 0; i < model->contacts.impacts; i++) {
		const struct impact_law *impact_law = model->contacts.impact[i].in;
		const bool bounces = model->contacts.impact[i].bounces;
		place_loads(b, impact_law->guard);
		place_loads(b, impact_law->speed);
		if (impact_law->moving) {
			place_loads_within(b, impact_law->guard);
			place_loads_within(b, impact_law->speed);
			place_loads_that_move(b, impact_law->moving);
		}
		if (bounces)
			place_loads(b, impact_law->press);
		for (int k = 0; k < b->spec->joined.columns; k++)
			place_loads_of_slope(b, impact_law, &impact_law->slope[k]);
		for (int k = 0; k < impact_law->jumps; k++)
			place_loads(b, impact_law->jump[k].form);
		for (int k = 0; k < impact_law->jumps && bounces; k++)
			place_loads(b, impact_law->still[k].form);
	}
	for (int i = 0; i < model->contacts.drags; i++) {
		place_loads_that_move(b, model->contacts.drag[i].moving);
		place_loads(b, model->contacts.drag[i].velocity);
		place_loads(b, model->contacts.drag[i].rate);
		if (model->contacts.drag[i].of >= 0) {
			place_loads_within(b, model->contacts.drag[i].velocity);
			place_loads_within(b, model->contacts.drag[i].rate);
			place_loads_within(b, model->contacts.drag[i].force);
			place_loads_within(b, model->contacts.drag[i].rest);
		}
		place_loads(b, model->contacts.drag[i].force);
		place_loads(b, model->contacts.drag[i].rest);
	}
}
