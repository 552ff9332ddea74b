/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outputs as rows over states, load states and inputs. */
#include "building.h"
#include "model/contacts/friction.h"
#include "reads.h"
#include "model/linear/relative.h"

#include <string.h>

/* output += factor * (the highest derivative of a coordinate: its row over the states, and W^-1 force) */
static void add_highest(const struct model *model, const struct linear *system, const mpq_t *inverse,
			const mpq_t *highest, int coord, mpq_srcptr factor, struct output *output)
{
	RATIONAL weight = ZERO;
	for (int j = 0; j < system->states; j++)
		rational_addmul(output->state[j], factor, highest[coord * system->states + j]);
	for (int i = 0; i < model->n; i++) {
		mpq_mul(weight, inverse[coord * model->n + i], factor);
		for (int c = 0; c < model->remainder.force_columns; c++)
			if (model->remainder.row[c] == i)
				mpq_add(output->force_column[c], output->force_column[c], weight);
		for (int l = 0; l < system->loads; l++)
			for (int k = 0; k < system->load[l].columns; k++)
				for (int s = 0; s < model->system.segments; s++) {
					mpq_ptr sum = output->load[l][k * model->system.segments + s];
					int known = s < system->segments ? s : 0;
					rational_addmul(sum, weight, system->load[l].force[k][known * model->n + i]);
				}
		for (int j = 0; j < system->inputs; j++)
			for (int k = 0; k < 2; k++)
				rational_addmul(output->input[k][j], weight, system->input[j].force[k][i]);
	}
}

/* The state that is the `order`-th derivative of a coordinate; -1: it is the highest derivative, and no state. */
static int state_of(const struct model *model, const struct basis *basis)
{
	return basis->order == 0 ? basis->index : basis->order == 1 ? model->system.velocity[basis->index] : -1;
}

/* Its form in one segment of time */
static const struct form *output_form(const struct building *b, const struct output *output, int segment)
{
	return b->segment_equations[segment].output[output->statement]->cell[output->cell];
}

struct direct_row {
	struct output *output;
	int segments, segment;
};

static void add_direct(void *context, int load, int column, mpq_srcptr factor)
{
	const struct direct_row *row = context;
	mpq_ptr sum = row->output->load[load][column * row->segments + row->segment];
	mpq_add(sum, sum, factor);
}

static void spread_output(struct building *b, const mpq_t *inverse, const mpq_t *highest, struct output *output)
{
	struct model *model = b->model;
	for (int s = 0; s < model->system.segments; s++)
		spread_loads(b, output_form(b, output, s), add_direct,
			     &(struct direct_row){ output, model->system.segments, s });
	for (int i = 0; i < output->form->terms; i++) {
		const struct form_term *term = &output->form->term[i];
		const struct basis *basis = &term->basis;
		if (basis->kind == BASIS_INPUT)
			mpq_add(output->input[basis->order][basis->index], output->input[basis->order][basis->index],
				term->factor);
		else if (basis->kind == BASIS_COORD && state_of(model, basis) < 0)
			add_highest(model, &model->system, inverse, highest, basis->index, term->factor, output);
		else if (basis->kind == BASIS_COORD)
			mpq_add(output->state[state_of(model, basis)], output->state[state_of(model, basis)],
				term->factor);
	}
}

static bool is_too_high(const struct model *model, const struct basis *basis)
{
	return basis->kind == BASIS_COORD && basis->order > model->frame.coord[basis->index]->highest;
}

/* A coordinate whose highest derivative, or `above` it, stands there. */
static const struct node *find_acceleration(const struct node *node, int above)
{
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_COORD &&
	    node->primes >= node->symbol->highest + above)
		return node;
	for (int i = 0; i < node->children; i++) {
		const struct node *found = find_acceleration(node->child[i], above);
		if (found)
			return found;
	}
	return NULL;
}

/* ---- without output statements states are outputs in the units of their coordinates ---- */

static void declare_state(struct spec *spec, const struct model *model, int state)
{
	const int index = model->system.coord[state], primes = state >= model->n;
	struct symbol *coord = model->frame.coord[index], *output = NEW(struct symbol);
	const int component = coord->length ? index - coord->index + 1 : 0;
	const struct unit *unit = coord->unit_written ? unit_of_derivative(coord->unit, primes) : NULL;
	struct node *value = convert_unit(state_node(coord, component, primes), unit, true);
	*output = (struct symbol){ .kind = SYMBOL_OUTPUT, .name = model->names.state[state], .at = coord->at,
				   .statement = coord->statement, .index = spec->count.outputs++, .unit = unit,
				   .unit_written = unit, .value = value };
	add_symbol(spec, output);
}

/* Where those of all are SI units the states are as they are. */
void give_states_in_units(struct building *b)
{
	bool other = false;
	for (const struct symbol *s = b->spec->first; s; s = s->next)
		other = other || (s->kind == SYMBOL_COORD && s->unit_written && !is_coherent(s->unit));
	if (!other || b->spec->count.outputs > 0 || b->model->relative)
		return;
	for (int i = 0; i < b->model->system.states; i++)
		declare_state(b->spec, b->model, i);
}

/* ---- one output statement may name a vector: one output per component ---- */

struct output_work {
	struct building *b;
	struct node *node;
	struct value *value;
};

static void collect_output(void *context)
{
	struct output_work *work = context;
	work->value = collect(&work->b->collector, work->node);
}

static void add_output(struct model *model, const char *name, const struct symbol *s, struct form *form)
{
	*MORE(model->output, model->outputs) =
		(struct output){ .name = name, .unit = s ? s->unit : NULL, .value = s ? s->value : NULL, .form = form };
}

/* The SI unit of a state as it is kept; NULL: not known */
const struct unit *unit_of_state(const struct model *model, int state)
{
	const struct symbol *coord = model->frame.coord[model->system.coord[state]];
	if (model->relative || !coord->unit)
		return NULL;
	return unit_in_si(unit_of_derivative(coord->unit, state >= model->n));
}

/* q, q' as q[1], q[1]'; another vector v as v[1] */
static const char *component_name(const char *name, int component)
{
	const char *prime = strchr(name, '\'');
	int length = prime ? (int)(prime - name) : (int)strlen(name);
	return format("%.*s[%d]%s", length, name, component, name + length);
}

/* What is not linear becomes forms with atoms, printed as C. */
void collect_outputs(struct building *b, struct segment_equations *segment_equations)
{
	int index = 0;
	struct form **const *form = b->model->frame.form;
	segment_equations->output = ARRAY(struct value *, b->spec->count.outputs);
	b->model->frame.form = segment_equations->form[0] ? segment_equations->form : form;
	b->collector.tolerant = b->collector.reading = true;
	b->collector.multiplier = segment_equations->multiplier;
	b->collector.output = segment_equations->multiplier != NULL;
	for (const struct symbol *s = b->spec->first; s; s = s->next) {
		struct output_work work = { b, s->value, NULL };
		if (s->kind != SYMBOL_OUTPUT)
			continue;
		statement_guard(collect_output, &work);
		segment_equations->output[index++] = work.value;
	}
	b->collector.tolerant = b->collector.reading = b->collector.output = false;
	b->model->frame.form = form;
}

/* An output is a row over states and loads if it is so in all segments of time, with the same states. */
static bool is_row(const struct building *b, int index)
{
	const struct value *first = b->segment_equations->output[index];
	for (int s = 0; s < b->model->system.segments; s++) {
		const struct value *value = b->segment_equations[s].output[index];
		if (!value || value->rows != first->rows || value->columns != first->columns)
			return false;
		for (int i = 0; i < value->rows * value->columns; i++)
			if (!same_in_states(value->cell[i], first->cell[i]))
				return false;
	}
	return true;
}

static void collect_left(void *context)
{
	struct output_work *work = context;
	struct collector *c = &work->b->collector;
	const struct segment_equations *of = work->b->full ? work->b->full : work->b->segment_equations;
	struct form **const *form = work->b->model->frame.form;
	int keep = (int)c->keep;
	c->keep = KEEP_ALL;
	c->whole_time = c->output = c->reading = true;
	c->multiplier = gives_motion(work->b->model) ? NULL : of->multiplier;
	if (of->form[0] && work->b->model->system.segments == 1)
		work->b->model->frame.form = of->form;
	forget_lets(work->b->spec);
	collect_output(work);
	work->b->model->frame.form = form;
	c->keep = (unsigned)keep;
	c->whole_time = c->output = c->reading = false;
	for (struct symbol *s = work->b->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_LET && !s->made.full && s->made.progress == COLLECTED &&
		    s->made.value->rows * s->made.value->columns == 1)
			s->made.full = s->made.value->cell[0];
}

/* The friction of what has no mass is what it bears: then it may be a row after all. */
static bool becomes_row(struct building *b, int index, struct value *value, bool *reads_slider_force)
{
	bool row = b->model->contacts.massless_sliders > 0 && value;
	for (int i = 0; b->model->contacts.massless_sliders > 0 && value && i < value->rows * value->columns; i++) {
		const struct form *written = value->cell[i];
		const struct form *slider_force = value->cell[i] = borne_form(b, written);
		*reads_slider_force = *reads_slider_force || !same_form(written, slider_force);
		row = row && (slider_force->terms == 0 || !slider_force->term[slider_force->terms - 1].basis.atom);
	}
	for (int s = 0; row && s < b->model->system.segments; s++)
		b->segment_equations[s].output[index] = value;
	return row;
}

/* Does it read a highest derivative, which the force of a contact that rests changes, or tunable params of regions, or
 * beside a series friction? */
static bool may_be_held(const struct building *b, const struct value *value)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	const bool may = has_bounces(b->model) || b->factor || gives_motion(b->model);
	bool held = false;
	for (int i = 0; i < value->rows * value->columns && may; i++)
		for (const struct form_term **term = terms_within(value->cell[i], seen); *term; term++)
			held = held || is_highest(&b->model->frame, &(*term)->basis);
	return held;
}

static void name_outputs(struct building *b)
{
	struct model *model = b->model;
	int index = 0;
	for (const struct symbol *s = b->spec->first; s; s = s->next) {
		if (s->kind != SYMBOL_OUTPUT)
			continue;
		bool row = is_row(b, index), reads_slider_force = false;
		struct output_work work = { b, s->value, row ? b->segment_equations->output[index] : NULL };
		row = row && !((b->model->switching || gives_motion(b->model)) && may_be_held(b, work.value));
		if (!row)
			statement_guard(collect_left, &work);
		row = row || becomes_row(b, index, work.value, &reads_slider_force);
		int count = work.value ? work.value->rows * work.value->columns : 0;
		for (int i = 0; i < count; i++) {
			add_output(model, count == 1 ? s->name : component_name(s->name, i + 1), s,
				   row ? work.value->cell[i] : NULL);
			model->output[model->outputs - 1].left = row ? NULL : work.value->cell[i];
			model->output[model->outputs - 1].reads_slider_force = reads_slider_force;
			model->output[model->outputs - 1].peak = s->peak;
			model->output[model->outputs - 1].statement = index;
			model->output[model->outputs - 1].cell = i;
		}
		index++;
	}
	model->declared_outputs = b->spec->count.outputs > 0;
	const struct model *written = model->relative ? model->relative->written : model;
	for (int i = 0; i < model->system.states && !model->declared_outputs; i++) {
		add_output(model, written->names.state[i], NULL, NULL);
		model->output[i].unit = unit_of_state(written, i);
	}
}

static bool reads_too_high(const struct model *model, bool *seen, const struct form *form)
{
	for (const struct form_term **term = terms_within(form, seen); *term; term++)
		if (is_too_high(model, &(*term)->basis))
			return true;
	return false;
}

/* Whether it is good; else its error was reported. */
static bool check_output(const struct model *model, const struct output *output)
{
	bool *seen = ARRAY(bool, (size_t)atoms_count(model->equations.atoms));
	if (!reads_too_high(model, seen, output->form ? output->form : output->left))
		return true;
	const struct node *name = find_acceleration(output->value, 1);
	say_error(name->at, NULL, "%s is of first order and has no second derivative", name->symbol->name);
	return false;
}

void output_rows(const struct linear *system, int force_columns, struct output *output)
{
	output->state = rationals(system->states);
	output->load = ARRAY(mpq_t *, system->loads);
	for (int l = 0; l < system->loads; l++)
		output->load[l] = rationals((size_t)system->load[l].columns * (size_t)system->segments);
	for (int k = 0; k < 2; k++)
		output->input[k] = rationals(system->inputs);
	output->force_column = rationals(force_columns);
}

/* ---- an expression as a row ---- */

static void add_states_and_inputs(const struct building *b, const struct form *form, struct output *row)
{
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind == BASIS_INPUT)
			mpq_set(row->input[basis->order][basis->index], form->term[i].factor);
		else if (basis->kind == BASIS_COORD)
			mpq_set(row->state[state_of(b->model, basis)], form->term[i].factor);
	}
}

struct output *row_of_function(struct building *b, const struct switching *of, const struct switching_function *e)
{
	struct output *row = NEW(struct output);
	int segments = b->model->system.segments;
	output_rows(&b->model->system, b->model->remainder.force_columns, row);
	for (int s = 0; s < segments; s++) {
		int known = s < of->segments ? s : 0;
		spread_loads(b, form_in(e, known), add_direct, &(struct direct_row){ row, segments, s });
	}
	add_states_and_inputs(b, e->form, row);
	return row;
}

/* What stands in the first segment of time, in all of them */
static void repeat_loads(const struct linear *system, struct output *row)
{
	for (int l = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++)
			for (int s = 1; s < system->segments; s++)
				mpq_set(row->load[l][k * system->segments + s], row->load[l][k * system->segments]);
}

struct output *row_of_form(struct building *b, struct form *form)
{
	const struct linear *system = &b->model->system;
	struct output *row = NEW(struct output);
	output_rows(system, b->model->remainder.force_columns, row);
	spread_loads(b, form, add_direct, &(struct direct_row){ row, system->segments, 0 });
	add_states_and_inputs(b, form, row);
	repeat_loads(system, row);
	return row;
}

struct output *row_in_system(struct building *b, const struct linear *system, struct form *form)
{
	const struct model *model = b->model;
	struct form *lower = NEW(struct form);
	mpq_t *inverse = inverse_of_leading(system), *highest = rationals((size_t)(model->n * system->states));
	highest_derivatives(system, inverse, false, highest);
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind != BASIS_COORD || state_of(model, &form->term[i].basis) >= 0)
			form_add_basis(lower, form->term[i].basis, form->term[i].factor);
	struct output *row = row_of_form(b, lower);
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == BASIS_COORD && state_of(model, &form->term[i].basis) < 0)
			add_highest(model, system, inverse, highest,
				    form->term[i].basis.index, form->term[i].factor, row);
	return row;
}

struct output *row_of_highest(struct building *b, const struct linear *system, int coordinate)
{
	struct basis basis = { .kind = BASIS_COORD, .index = coordinate, .order = 1 };
	if (state_of(b->model, &basis) >= 0)
		basis.order = 2;
	return row_in_system(b, system, form_unit(basis));
}

/* ---- slopes of outputs that are no rows in all regions, for their derivatives ---- */

static bool reads_highest(const struct building *b, const struct form *form)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	bool any = false;
	for (const struct form_term **term = terms_within(form, seen); *term; term++)
		any = any || is_highest(&b->model->frame, &(*term)->basis);
	return any;
}

static bool has_slopes(const struct building *b, const struct output *output)
{
	const struct model *model = b->model;
	if (b->spec->sensitivities == 0 || b->request->again.derivatives > 0 || !output->value ||
	    (output->left && reads_friction(model, output->left)))
		return false;
	if (!model->switching)
		return output->left && model->system.segments > 1 && model->remainder.force_columns == 0 &&
		       b->spec->tuned.count == 0;
	return output->left || reads_highest(b, output->form);
}

static void add_slope(struct building *b, struct output *output, struct basis along, const struct form *form)
{
	if (form->terms == 0)
		return;
	place_loads_within(b, form);
	*MORE(output->slope, output->slopes) = (struct output_slope){ along, form };
}

static void add_slope_along(struct building *b, struct output *output, struct basis along)
{
	const struct form *form = output->left ? output->left : output->form;
	struct collector *c = &b->collector;
	const int keep = (int)c->keep;
	c->keep = KEEP_ALL;
	c->whole_time = c->output = c->reading = true;
	add_slope(b, output, along,
		  *form_derivatives(c, 1, &form, along.kind == BASIS_INPUT, along.index, along.order));
	c->keep = (unsigned)keep;
	c->whole_time = c->output = c->reading = false;
}

struct slope_work {
	struct building *b;
	struct output *output;
};

static void find_slopes(void *context)
{
	const struct slope_work *work = context;
	struct building *b = work->b;
	struct output *output = work->output;
	for (int k = 0; k < b->model->n; k++)
		for (int order = 0; order <= b->model->frame.coord[k]->highest; order++)
			add_slope_along(b, output, (struct basis){ .kind = BASIS_COORD, .index = k, .order = order });
	for (int i = 0; i < b->spec->count.inputs; i++)
		for (int order = 0; order <= (b->model->system.input[i].hold > 0); order++)
			add_slope_along(b, output, (struct basis){ .kind = BASIS_INPUT, .index = i, .order = order });
	for (int p = 0; p < b->spec->sensitivities; p++) {
		struct output_work by = { b, slope_by_param(b->spec, &b->spec->sensitivity[p], output->value), NULL };
		if (is_zero_node(by.node))
			continue;
		collect_left(&by);
		const int cell = by.value->rows * by.value->columns > 1 ? output->cell : 0;
		add_slope(b, output, (struct basis){ .kind = BASIS_ONE, .index = p }, by.value->cell[cell]);
	}
}

/* ---- outputs that are not linear ---- */

static struct reads reads_of_output(const struct model *model, const struct output *output)
{
	const struct form **form = ARRAY(const struct form *, (size_t)output->slopes + 1);
	int forms = 0;
	if (output->left)
		form[forms++] = output->left;
	for (int k = 0; k < output->slopes; k++)
		form[forms++] = output->slope[k].form;
	return reads_of(model, forms, form);
}

/* The highest derivatives that they read, each as a row of its own */
static void build_highest(struct building *b, const mpq_t *inverse, const mpq_t *highest)
{
	struct model *model = b->model;
	RATIONAL one = RATIO(1, 1);
	model->equations.highest = ARRAY(struct output *, model->n);
	for (int i = 0; i < model->outputs; i++) {
		const struct reads reads = reads_of_output(model, &model->output[i]);
		for (int k = 0; k < model->n && !gives_motion(model); k++) {    /* beside a series that has them */
			if (!reads.highest[k] || model->equations.highest[k])
				continue;
			if (model->request.reduce)
				say_error(find_acceleration(model->output[i].value, 0)->at, "without --reduce it can",
					  "an output that is not linear cannot read an acceleration under --reduce");
			model->equations.highest[k] = NEW(struct output);
			model->equations.highest[k]->value = model->output[i].value;
			model->equations.highest[k]->name = model->output[i].name;
			output_rows(&model->system, model->remainder.force_columns, model->equations.highest[k]);
			add_highest(model, &model->system, inverse, highest, k, one, model->equations.highest[k]);
		}
	}
}

/* A written state, as the output that it is by itself */
static void see_state(const struct model *model, int state, mpq_t *row)
{
	const struct model *written = model->relative ? model->relative->written : model;
	const struct form *form = coordinate_form(&model->frame, written->system.coord[state], state >= written->n);
	for (int i = 0; i < form->terms; i++)
		mpq_set(row[state_of(model, &form->term[i].basis)], form->term[i].factor);
}

static void check_drawn(void *context)
{
	struct output_work *work = context;
	collect_left(work);
	scalar_of(work->value, work->node, "a place is two numbers: (x, y)");
}

/* What drawings read is what outputs may read. */
static void check_drawings(struct building *b)
{
	const struct spec *spec = b->spec;
	struct node *node[MOST_DRAWN];
	for (int i = 0; i < spec->page.drawings; i++) {
		const int count = nodes_of_drawing(&spec->page.drawing[i], node);
		for (int k = 0; k < count && !diagnostics_errors(); k++)
			statement_guard(check_drawn, &(struct output_work){ b, node[k], NULL });
	}
}

/* Loads that only outputs use get their load states too, so all are placed before any is spread. */
void build_outputs(struct building *b)
{
	struct model *model = b->model;
	struct linear *system = &model->system;
	mpq_t *inverse = inverse_of_leading(system), *highest = rationals((size_t)(model->n * system->states));
	/* the remainder is left by this one */
	struct linear first = model->schedule.operators ? operator_system(model, 0) : *system;
	highest_derivatives(&first, inverse, false, highest);
	name_outputs(b);
	check_drawings(b);
	int reported = -1;                      /* the statement last reported: once is enough */
	for (int i = 0; i < model->outputs; i++)
		for (int s = 0; s < system->segments && model->output[i].form; s++)
			place_loads(b, output_form(b, &model->output[i], s));
	for (int i = 0; i < model->outputs; i++)
		place_loads_within(b, model->output[i].left);
	for (int i = 0; i < model->outputs && !diagnostics_errors(); i++)
		if (has_slopes(b, &model->output[i]))
			statement_guard(find_slopes, &(struct slope_work){ b, &model->output[i] });
	for (int i = 0; i < model->outputs; i++) {
		struct output *output = &model->output[i];
		if (output->statement != reported && !check_output(model, output))
			reported = output->statement;
		output_rows(system, model->remainder.force_columns, output);
		if (!output->value)
			see_state(model, i, output->state);
		else if (output->form && !diagnostics_errors())
			spread_output(b, inverse, highest, output);
		if (!output->left && rationals_zero((size_t)model->remainder.force_columns, output->force_column))
			output->slopes = 0;             /* a row that no region changes */
	}
	if (!diagnostics_errors())
		build_highest(b, inverse, highest);
}
