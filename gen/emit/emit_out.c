/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outputs as C: rows over states, load states and inputs, or what is not linear as its own expression. */
#include "steps.h"
#include "model/reads.h"
#include "model/regions/regions.h"
#include "emit/series/series.h"

/* The output of a row of that table: NULL behind the last */
static const struct output *output_of_row(const struct model *model, int row)
{
	if (row < model->outputs)
		return &model->output[row];
	for (int k = 0; model->equations.highest && k < model->n; k++)
		if (model->equations.highest[k] && place_of_output(model, model->equations.highest[k]) == row)
			return model->equations.highest[k];
	return NULL;
}

static bool is_read_as_row(const struct emitter *e, const struct output *output)
{
	const struct model *model = e->model;
	bool of_regions = is_tuned_output(e, output);
	for (int k = 0; model->equations.highest && k < model->n; k++)
		of_regions = of_regions || (output == model->equations.highest[k] && is_row_of_regions(model, k));
	return !output->left && !of_regions;
}

/* How many rows the table of factors needs: up to the last in which one changes */
static int changing_rows(const struct emitter *e)
{
	const struct linear *system = e->system;
	const struct output *output;
	int rows = 0;
	for (int o = 0; (output = output_of_row(e->model, o)) != NULL; o++)
		for (int l = 0; l < system->loads && is_read_as_row(e, output); l++)
			for (int k = 0; k < system->load[l].columns; k++)
				if (differs_in_time(direct_factors(e->step, output, l, k), system->segments))
					rows = o < e->model->outputs ? e->model->outputs : o + 1;
	return rows;
}

/* Factors of the load states, where one changes its formula, in the outputs, and in the derivatives that those read
 * which are not linear */
static void emit_direct_factors(const struct emitter *e)
{
	const struct linear *system = e->system;
	const int columns = load_columns(system), rows = changing_rows(e);
	if (rows == 0)
		return;
	const int size[] = { system->segments, rows, columns };
	double *value = ARRAY(double, (size_t)(size[0] * rows * columns)), *to = value;
	const char **note = ARRAY(const char *, (size_t)rows);
	for (int s = 0; s < system->segments; s++)
		for (int o = 0; o < rows; o++) {
			const struct output *output = output_of_row(e->model, o);
			note[o] = format("%s%s", o < e->model->outputs ? "" : "a highest derivative in ", output->name);
			for (int l = 0; l < system->loads; l++)
				for (int k = 0; k < system->load[l].columns; k++)
					*to++ = round_rational(direct_factors(e->step, output, l, k)[s]);
		}
	emit_array(e, "Input columns of the outputs: factors of the load states in each segment of time", "direct",
		   3, size, value, note);
}

/* Rows read states as they are kept, forms the written ones. */
static bool *kept_states(const struct emitter *e, const struct formulas *f)
{
	const struct model *written = written_model(e->model);
	struct reads r = reads_of_formulas(f);
	bool *kept = ARRAY(bool, (size_t)e->system->states);
	for (int i = 0; i < written->system.states; i++)
		if (r.state[i])
			kept[e->model->reduction.place ? e->model->reduction.place[i] : i] = true;
	tape_mark(formulas_tape(f), TAPE_STATE, 0, kept);
	return kept;
}

static bool is_drawn(const struct emitter *e, int output)
{
	return output >= e->model->outputs - e->model->spec->page.outputs;
}

static bool is_wanted(const struct emitter *e, int output)
{
	return (!e->at || e->at->output[output]) && is_drawn(e, output) == e->drawn;
}

/* Of coordinate k: in each region another row where a contact may rest; beside a series multipliers too */
static tape_ref highest_derivative(const struct emitter *e, struct tape *t, int k)
{
	if (motion_numbers(e))
		return tape_operand(t, TAPE_FRICTION, k, 0);
	return is_row_of_regions(e->model, k) ? tape_operand(t, TAPE_FRICTION, e->model->switching->highest[k], 0)
					      : tape_of_row(t, e->step, e->model->equations.highest[k]);
}

/* As locals */
static void set_highest(const struct emitter *e, struct tape *t, int forms, const struct form *const *form)
{
	const struct reads r = reads_of(written_model(e->model), forms, form);
	for (int k = 0; k < written_model(e->model)->n + e->model->spec->count.multipliers; k++)
		if (r.highest[k])
			tape_set_local(t, format("accel%d", k + 1),
				       highest_derivative(e, t, k));
}

/* Their values; first the highest derivatives that they read */
static struct formulas *formulas_of_outputs(const struct emitter *e)
{
	const struct model *model = e->model;
	const struct form **form = ARRAY(const struct form *, (size_t)model->outputs + 1);
	tape_ref *value = ARRAY(tape_ref, (size_t)model->outputs + 1);
	int forms = 0;
	for (int i = 0; i < model->outputs; i++)
		if (model->output[i].left && is_wanted(e, i))
			form[forms++] = model->output[i].left;
	struct formulas *f = formulas_new(e, (struct reading){ 0 }, forms, form);
	struct tape *t = formulas_tape(f);
	for (int i = 0; i < model->outputs; i++) {
		const struct output *output = &model->output[i];
		if (is_wanted(e, i))
			value[i] = output->left ? formula(f, output->left) : tape_of_row(t, e->step, output);
	}
	set_highest(e, t, forms, form);
	for (int i = 0; i < model->outputs; i++)
		if (is_wanted(e, i))
			tape_set(t, e->at ? e->at->output[i] : format("out[%d]", i), value[i], 13,
				 model->output[i].name);
	formulas_finish(f);
	return f;
}

static void emit_input_locals(const struct emitter *e, const bool *wanted)
{
	for (int i = 0; i < e->system->inputs; i++) {
		if (wanted[i])
			say(e, "    const double %s = %s;\n", input_name(e, i, 0),
			    e->at ? e->at->input[i] : sample_kept(e, i));
		if (wanted[i + e->system->inputs])
			say(e, "    const double %s = %s;\n", input_name(e, i, 1),
			    e->at ? e->at->slope[i] : format("s->slope[%d]", i));
	}
}

static void emit_read_formulas(const struct emitter *e, struct formulas *f)
{
	const struct model *model = e->model;
	const struct reads r = reads_of_formulas(f);
	const bool *reads = kept_states(e, f), remainder = tape_reads(formulas_tape(f), TAPE_TABLE, -1, TABLE_LEFT);
	emit_locals(e, reads);
	emit_param_locals(e, r.param);
	if (remainder && keeps_modes(e) && !any_of(reads, e->system->states))
		say(e, "    double now[$N_STATES];\n"
		       "    $n_get(s, now);\n");
	emit_input_locals(e, r.input);
	if (r.time)
		say(e, "    const double t = $n_time(s);\n");
	emit_rotated_loads(e, r.load, r.time);
	if (remainder)
		say(e, "    double remainder[%d];\n"
		       "    %s\n", model->remainder.force_columns, remainder_of_outputs(e));
	if (motion_numbers(e) && tape_reads(formulas_tape(f), TAPE_FRICTION, -1, -1))
		say(e, "    double motion[%d];\n"
		       "    $n_motion_now(s, motion);\n", motion_numbers(e));
	emit_formulas(f, 4);
}

static void emit_some_outputs(const struct emitter *e)
{
	emit_read_formulas(e, formulas_of_outputs(e));
}

/* Of a state that was set the intervals are not known yet. */
static void emit_motion_now(const struct emitter *e)
{
	const bool collocates = e->step->collocation != NULL;
	const char *slope = e->ramps ? "s->slope" : "slope";    /* behind a step that of the ramps in it */
	open_function(e, "What outputs read of the motion now, with what holds there",
		      "static void $n_motion_now(const $n *s, double motion[%d])", motion_numbers(e));
	say(e, "    $n_contact here = s->contact;\n"
	       "    double start[%d], slope[%d];\n"
	       "    $n_inputs_now(s, %s, start, slope);\n",
	    e->system->inputs + 1, e->system->inputs + 1, e->system->inputs ? "s->u" : "NULL");
	say(e, !collocates ? "    if (!here.placed) { $n_locate(s, %s, &here); }\n"
			   : "    if (!here.placed) {\n"
			     "        $n then = *s;\n"
			     "        $n_commit(&then);\n"
			     "        (void)$n_look_again(&then, start, %s);\n"
			     "        here = then.contact;\n"
			     "    }\n", collocates ? slope : e->system->inputs ? "s->u" : "NULL");
	say(e, "    $n_motion_at(s, start, %s, 0.0, %s, %s, here.interval, s->y, motion);\n"
	       "}\n", slope, spell(e, collocates ? "$n_time(s) + 0x1p-20 * $N_H" : "$n_middle(s)"),
	    loads_change(e->system) ? "s->segment" : "0");
}

/* What drawings read stands in a block of its own: what the others share, and so their bits, stays the same. */
void emit_outputs_now(const struct emitter *e)
{
	struct emitter drawn = *e;
	drawn.drawn = true;
	emit_some_outputs(e);
	if (e->model->spec->page.outputs == 0)
		return;
	say(e, "    {\n");
	emit_some_outputs(&drawn);
	say(e, "    }\n");
}

int slopes_of_outputs(const struct model *model)
{
	int slopes = 0;
	for (int o = 0; o < model->outputs; o++)
		slopes += model->output[o].slopes;
	return slopes;
}

void emit_output_slopes(const struct emitter *e)
{
	const struct model *model = e->model;
	const struct form **form = ARRAY(const struct form *, (size_t)slopes_of_outputs(model));
	tape_ref *value = ARRAY(tape_ref, (size_t)slopes_of_outputs(model));
	int forms = 0;
	for (int o = 0; o < model->outputs; o++)
		for (int k = 0; k < model->output[o].slopes; k++)
			form[forms++] = model->output[o].slope[k].form;
	struct formulas *f = formulas_new(e, (struct reading){ 0 }, forms, form);
	for (int k = 0; k < forms; k++)
		value[k] = formula(f, form[k]);
	set_highest(e, formulas_tape(f), forms, form);
	for (int k = 0; k < forms; k++)
		tape_set(formulas_tape(f), format("slope[%d]", k), value[k], 13, NULL);
	formulas_finish(f);
	emit_read_formulas(e, f);
}

void emit_out(const struct emitter *e)
{
	const struct model *model = e->model;
	if (model->declared_outputs)
		emit_direct_factors(e);
	if (motion_numbers(e))
		emit_motion_now(e);
	say(e, "\n%s(const $n *s, double out[$N_OUTPUTS])\n"
	       "{\n", has_peaks(e) ? spell(e, "static void $n_now") : spell(e, "void $n_out"));
	if (!model->declared_outputs) {
		say(e, "    $n_get(s, out);\n"
		       "}\n");
		return;
	}
	emit_outputs_now(e);
	say(e, "    (void)s;\n"
	       "}\n");
}
