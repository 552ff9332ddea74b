/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Residuals to M, C, K, loads and inputs. */
#include "building.h"
#include "model/tunable/tuning.h"

static void fill_row(struct linear *system, int row, const struct form *form)
{
	int n = system->n;
	mpq_t *matrix[] = { system->K, system->C, system->M };
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == BASIS_COORD)
			mpq_set(matrix[form->term[i].basis.order][row * n + form->term[i].basis.index],
				form->term[i].factor);
}

static struct load *load_of_forcing(struct model *model, const struct forcing *forcing)
{
	struct linear *system = &model->system;
	for (int i = 0; i < system->loads; i++)
		if (system->load[i].forcing == forcing)
			return &system->load[i];
	struct load *load = MORE(system->load, system->loads);
	*load = (struct load){ .forcing = forcing };
	return load;
}

/* Room for t^power: columns of lower powers come first, so that those already there stay. */
static void make_room(struct model *model, struct load *load, int power)
{
	int columns = (power + 1) * (oscillates(load->forcing) ? 2 : 1);
	if (columns <= load->columns)
		return;
	ENLARGE(load->force, (size_t)columns);
	for (; load->columns < columns; load->columns++)
		load->force[load->columns] = rationals((size_t)model->system.segments * (size_t)model->n);
	load->powers = power + 1;
}

static int load_column(const struct basis *basis)
{
	return oscillates(basis->forcing) ? 2 * basis->power + basis->sine : basis->power;
}

/* The loads of a form get their place; a constant is the power 0 of the polynomial load. */
void place_loads(struct building *b, const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind <= BASIS_PI)
			make_room(b->model, load_of_forcing(b->model, b->polynomial), 0);
		else if (basis->kind == BASIS_FORCING)
			make_room(b->model, load_of_forcing(b->model, basis->forcing), basis->power);
	}
}

void place_loads_within(struct building *b, const struct form *form)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	for (const struct form_term **term = terms_within(form, seen); *term; term++)
		if ((*term)->basis.kind == BASIS_FORCING && !is_polynomial((*term)->basis.forcing))
			place_loads(b, form_single((*term)->basis, (*term)->factor));
}

/* value[load][column] of the terms of a form; `spread` is called for each */
void spread_loads(struct building *b, const struct form *form,
		  void (*spread)(void *context, int load, int column, mpq_srcptr factor), void *context)
{
	struct linear *system = &b->model->system;
	RATIONAL constant = ZERO;
	const struct form plain = constant_terms(form);
	constant_value(&b->collector, &plain, constant);
	if (mpq_sgn(constant) != 0)
		spread(context, (int)(load_of_forcing(b->model, b->polynomial) - system->load), 0, constant);
	for (int i = plain.terms; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind == BASIS_FORCING)
			spread(context, (int)(load_of_forcing(b->model, basis->forcing) - system->load),
			       load_column(basis),
			       form->term[i].factor);
	}
}

struct force_row {
	struct linear *system;
	int segment, row;
};

static void add_force(void *context, int load, int column, mpq_srcptr factor)
{
	const struct force_row *f = context;
	mpq_ptr force = f->system->load[load].force[column][f->segment * f->system->n + f->row];
	mpq_sub(force, force, factor);          /* the residual has the load on the left side */
}

static void fill_inputs(struct linear *system, int row, const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind == BASIS_INPUT)
			mpq_neg(system->input[basis->index].force[basis->order][row], form->term[i].factor);
	}
}

static void make_input_forces(struct linear *system)
{
	for (int i = 0; i < system->inputs; i++)
		for (int k = 0; k < 2; k++)
			system->input[i].force[k] = rationals(system->n);
}

static void name_inputs(struct building *b)
{
	struct linear *system = &b->model->system;
	const bool acting = b->collector.params == PARAMS_INPUTS;
	system->inputs = b->spec->count.inputs;
	for (int k = 0; k < b->spec->tuned.count && acting; k++)
		system->inputs += !b->spec->tuned.tunable[k].symbol->tuning.factor;
	system->input = ARRAY(struct input, system->inputs);
	for (const struct symbol *s = b->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_INPUT)
			system->input[s->index] = (struct input){ .name = s->name, .hold = s->hold, .unit = s->unit };
	for (int i = b->spec->count.inputs; i < system->inputs; i++)
		system->input[i].name = b->spec->tuned.tunable[param_of_input(b->spec, i)].symbol->name;
	make_input_forces(system);
}

/* The same coordinates, loads and inputs, nothing acting yet */
struct linear empty_system(const struct model *model)
{
	struct linear system = linear_like(&model->system);
	system.loads = model->system.loads;
	system.load = ARRAY(struct load, system.loads);
	for (int l = 0; l < system.loads; l++) {
		system.load[l] = model->system.load[l];
		system.load[l].force = ARRAY(mpq_t *, system.load[l].columns);
		for (int k = 0; k < system.load[l].columns; k++)
			system.load[l].force[k] = rationals((size_t)system.segments * (size_t)system.n);
	}
	system.inputs = model->system.inputs;
	system.input = ARRAY(struct input, system.inputs);
	for (int i = 0; i < system.inputs; i++)
		system.input[i] = model->system.input[i];
	make_input_forces(&system);
	return system;
}

void fill_system(struct building *b, struct linear *system, int row, const struct form *residual)
{
	fill_row(system, row, residual);
	fill_inputs(system, row, residual);
	spread_loads(b, residual, add_force, &(struct force_row){ system, 0, row });
}

const struct form *nominal_form(struct building *b, const struct form *form)
{
	if (!reads_params(form))
		return form;
	if (!b->values) {
		b->values = point_new(&b->collector, 0, NULL);
		point_at_values(b->values);
	}
	return form_at(b->values, form);
}

bool parts_params(const struct building *b)
{
	return b->collector.params == PARAMS_ATOMS && !loads_change(&b->model->system) &&
	       !scheme_row(b->model->scheme)->expands;
}

void fill_states(struct building *b, const struct segment_equations *rows)
{
	struct model *model = b->model;
	struct linear *system = &model->system;
	size_t cells = (size_t)model->n * (size_t)model->n;
	system->M = rationals(cells);
	system->C = rationals(cells);
	system->K = rationals(cells);
	for (int i = 0; i < model->n; i++)
		fill_row(system, i, nominal_form(b, rows->residual[i].form));
	check_mass(b);
	name_inputs(b);
	for (int i = 0; i < model->n; i++) {
		const struct form *form = rows->residual[i].form;
		fill_inputs(system, i, parts_params(b) ? nominal_form(b, form) : form);
	}
}

void fill_loads(struct building *b, int segment, int row, const struct form *residual)
{
	spread_loads(b, residual, add_force, &(struct force_row){ &b->model->system, segment, row });
}
