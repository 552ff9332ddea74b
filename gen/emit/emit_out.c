/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outputs as C: rows over states, load states and inputs, or what is not linear as its own expression. */
#include "emit/emit.h"

static bool changes(const mpq_t *factor, int segments)
{
	for (int s = 1; s < segments; s++)
		if (!mpq_equal(factor[0], factor[s]))
			return true;
	return false;
}

static bool any_factor(const struct emitter *e, const struct output *output, int load, int column)
{
	for (int s = 0; s < e->system->segments; s++)
		if (mpq_sgn(output->load[load][column * e->system->segments + s]) != 0)
			return true;
	return false;
}

/* A number for each output, then for each highest derivative that outputs which are not linear read */
static int place_of_output(const struct model *model, const struct output *output)
{
	int row = model->outputs;
	for (int k = 0; model->highest && k < model->n; k++) {
		if (model->highest[k] == output)
			return row;
		row += model->highest[k] != NULL;
	}
	return (int)(output - model->output);
}

/* A load in an output: its factor, or where that changes its place in the table direct[segment][output] */
static const char *direct_term(const struct emitter *e, const struct output *output, int load, int k, int column)
{
	const mpq_t *factor = (const mpq_t *)output->load[load] + k * e->system->segments;
	const char *operand = load_operand(e, load, k);
	if (!changes(factor, e->system->segments))
		return scaled(round_rational(factor[0]), operand);
	const char *text = spell(e, "$n_direct[s->segment][%d][%d]", place_of_output(e->model, output), column);
	return operand ? format("%s * %s", text, operand) : text;
}

/* The output of a row of that table: NULL behind the last */
static const struct output *output_of_row(const struct model *model, int row)
{
	if (row < model->outputs)
		return &model->output[row];
	for (int k = 0; model->highest && k < model->n; k++)
		if (model->highest[k] && place_of_output(model, model->highest[k]) == row)
			return model->highest[k];
	return NULL;
}

/* How many rows the table of factors needs: up to the last in which one changes */
static int changing_rows(const struct emitter *e)
{
	const struct linear *system = e->system;
	const struct output *output;
	int rows = 0;
	for (int o = 0; (output = output_of_row(e->model, o)) != NULL; o++)
		for (int l = 0; l < system->loads && !is_tuned_output(e, output); l++)
			for (int k = 0; k < system->load[l].columns; k++)
				if (changes((const mpq_t *)output->load[l] + k * system->segments, system->segments))
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
	say(e, "\nstatic const double $n_direct[%d][%s][%d] = {  "
	       "/* factors of the load states in each segment of time */\n",
	       system->segments, rows == e->model->outputs ? spell(e, "$N_OUTPUTS") : format("%d", rows), columns);
	for (int s = 0; s < system->segments; s++) {
		say(e, "  {\n");
		for (int o = 0; o < rows; o++) {
			const struct output *output = output_of_row(e->model, o);
			const char *row = "";
			for (int l = 0; l < system->loads; l++)
				for (int k = 0; k < system->load[l].columns; k++) {
					mpq_srcptr factor = output->load[l][k * system->segments + s];
					row = format("%s%s%s", row, *row ? ", " : "", shortest(round_rational(factor)));
				}
			say(e, "    {%s},  /* %s%s */\n", row,
			       o < e->model->outputs ? "" : "a highest derivative in ", output->name);
		}
		say(e, "  },\n");
	}
	say(e, "};\n");
}

static double output_factor(const struct output *output, mpq_srcptr factor)
{
	if (beyond_range(factor))
		error(output->value->start, NULL, "a factor of output '%s' is beyond the range of %s", output->name,
		      target_name());
	return round_rational(factor);
}

/* Its part of the states is a row over the modes. */
bool seen_of_modes(const struct emitter *e, const struct output *output)
{
	const struct model *model = e->model;
	bool any = false;
	for (int i = 0; i < e->system->states; i++)
		any = any || mpq_sgn(output->state[i]) != 0;
	return any && e->step->modal && output >= model->output && output < model->output + model->outputs;
}

static const char *linear_output(const struct emitter *e, const struct output *output)
{
	const struct linear *system = e->system;
	const char *tuned = tuned_output(e, output);
	if (tuned)
		return tuned;
	int most = system->states + load_columns(system) + 2 * system->inputs + e->model->channels, terms = 0;
	const char **term = ARRAY(const char *, (size_t)most + 1);
	const bool modes = seen_of_modes(e, output);
	if (modes)
		term[terms++] = spell(e, "$n_dot($n_seen[%d], s->y)", (int)(output - e->model->output));
	for (int i = 0; i < system->states && !modes; i++)
		if (mpq_sgn(output->state[i]) != 0)
			term[terms++] = scaled(output_factor(output, output->state[i]), e->local[i]);
	for (int l = 0, column = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++, column++)
			if (any_factor(e, output, l, k))
				term[terms++] = direct_term(e, output, l, k, column);
	for (int k = 0; k < 2; k++)
		for (int i = 0; i < system->inputs; i++)
			if (mpq_sgn(output->input[k][i]) != 0)
				term[terms++] = scaled(output_factor(output, output->input[k][i]),
						       k ? format("s->slope[%d]", i) : sample_kept(e, i));
	for (int c = 0; c < e->model->channels; c++)
		if (mpq_sgn(output->channel[c]) != 0)
			term[terms++] = scaled(output_factor(output, output->channel[c]), format("left[%d]", c));
	return terms ? tree(terms, term, 13) : "0.0";
}

struct output_needs {
	bool *reads, *loads, *inputs, *highest, time, left;
};

static void mark_tuned_row(const struct emitter *e, const struct output *output, struct output_needs *needs)
{
	int column = e->system->states;
	for (int i = 0; i < e->system->states; i++)
		needs->reads[i] = needs->reads[i] || tuned_output_reads(e, output, i);
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns; k++, column++)
			if (load_operand(e, l, k) && tuned_output_reads(e, output, column))
				needs->loads[l] = true;
}

static void mark_row(const struct emitter *e, const struct output *output, struct output_needs *needs)
{
	if (is_tuned_output(e, output)) {
		mark_tuned_row(e, output, needs);
		return;
	}
	for (int i = 0; i < e->system->states && !seen_of_modes(e, output); i++)
		needs->reads[i] = needs->reads[i] || mpq_sgn(output->state[i]) != 0;
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns; k++)
			needs->loads[l] = needs->loads[l] || (load_operand(e, l, k) && any_factor(e, output, l, k));
	for (int c = 0; c < e->model->channels; c++)
		needs->left = needs->left || mpq_sgn(output->channel[c]) != 0;
}

/* What an output that is not linear reads: written states, inputs, loads, highest derivatives */
static void mark_form(const struct emitter *e, const struct output *output, struct output_needs *needs)
{
	const struct model *written = speaker(e->model);
	const struct form *form = output->left;
	struct reads reads = reads_of(written, 1, &form);
	for (int i = 0; i < written->system.states; i++)
		if (reads.state[i])
			needs->reads[e->model->reduction.place ? e->model->reduction.place[i] : i] = true;
	for (int i = 0; i < 2 * e->system->inputs; i++)
		needs->inputs[i] = needs->inputs[i] || reads.input[i];
	for (int l = 0; l < e->system->loads; l++)
		needs->loads[l] = needs->loads[l] || reads.load[l];
	for (int k = 0; k < written->n; k++) {
		needs->highest[k] = needs->highest[k] || reads.highest[k];
		if (reads.highest[k])
			mark_row(e, e->model->highest[k], needs);
	}
	needs->time = needs->time || reads.time;
}

static void mark_output(const struct emitter *e, const struct output *output, struct output_needs *needs)
{
	(output->left ? mark_form : mark_row)(e, output, needs);
}

static void emit_input_locals(const struct emitter *e, const bool *wanted)
{
	for (int i = 0; i < e->system->inputs; i++) {
		if (wanted[i])
			say(e, "    const double %s = %s;\n", input_name(e, i, 0), sample_kept(e, i));
		if (wanted[i + e->system->inputs])
			say(e, "    const double %s = s->slope[%d];\n", input_name(e, i, 1), i);
	}
}

void emit_out(const struct emitter *e)
{
	const struct model *model = e->model;
	if (model->declared_outputs)
		emit_direct_factors(e);
	say(e, "\n%s(const $n *s, double out[$N_OUTPUTS])\n"
	       "{\n", has_peaks(e) ? spell(e, "static void $n_now") : spell(e, "void $n_out"));
	if (!model->declared_outputs) {
		say(e, "    $n_get(s, out);\n"
		       "}\n");
		return;
	}
	const int coords = speaker(model)->n;
	struct output_needs needs = {
		.reads = ARRAY(bool, (size_t)e->system->states), .loads = ARRAY(bool, (size_t)e->system->loads),
		.inputs = ARRAY(bool, 2 * (size_t)e->system->inputs), .highest = ARRAY(bool, (size_t)coords)
	};
	const struct form **form = ARRAY(const struct form *, (size_t)model->outputs + 1);
	int forms = 0;
	for (int i = 0; i < model->outputs; i++) {
		mark_output(e, &model->output[i], &needs);
		if (model->output[i].left)
			form[forms++] = model->output[i].left;
	}
	emit_locals(e, needs.reads);
	emit_param_locals(e, reads_of(speaker(model), forms, form).param);
	if (needs.left && e->step->normal && !any_of(needs.reads, e->system->states))
		say(e, "    double now[$N_STATES];\n"
		       "    $n_get(s, now);\n");
	emit_input_locals(e, needs.inputs);
	if (needs.time)
		say(e, "    const double t = $n_time(s);\n");
	emit_turned_loads(e, needs.loads, needs.time);
	if (needs.left)
		say(e, "    double left[%d];\n"
		       "    %s\n", model->channels, leftover_of_outputs(e));
	for (int k = 0; k < coords; k++)
		if (needs.highest[k])
			say(e, "    const double accel%d = %s;  /* %s%.*s */\n", k + 1,
			       linear_output(e, model->highest[k]), model->coord_name[k],
			       model->frame.coord[k]->highest, "''");
	struct formulas *f = formulas_new(e, (struct reading){ 0 }, forms, form);
	for (int i = 0; i < model->outputs; i++) {
		const struct output *output = &model->output[i];
		tape_ref value = output->left ? formula(f, output->left) : formula_text(f, linear_output(e, output));
		tape_set(formulas_tape(f), format("out[%d]", i), value, 13, output->name);
	}
	emit_formulas(f, 4);
	say(e, "    (void)s;\n"
	       "}\n");
}
