/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear models with tunable params: an instance holds its own factors, of a large model those of independent blocks
 * that params touch, and NAME_retune, of retune.h, computes them anew on the target. Here is what both hold. */
#include "emit/emit.h"

#include <string.h>

static const struct tuned_blocks *blocks_of_step(const struct emitter *e)
{
	return e->step->blocks;
}

/* Columns of a step's factors: states, load states in each segment of time, inputs */
static int step_columns(const struct emitter *e)
{
	return e->model->tuning->x.size;
}

static int tuned_outputs(const struct emitter *e)
{
	return e->model->tuning->outputs;
}

/* Names of the columns as a comment says them: the load states once, lines broken */
static const char *column_list(const struct emitter *e)
{
	enum { WIDTH = 110 };
	const char **name = layout_names(&e->model->tuning->x, e->system, e->model), *list = "", *line = "";
	int states = e->system->states, loads = e->model->tuning->x.loads, segments = e->system->segments;
	for (int i = 0; i < step_columns(e); i++) {
		if (i >= states + loads && i < states + segments * loads)
			continue;
		bool several = segments > 1 && loads, last = several && i == states + loads - 1;
		const char *end = last ? format(") in each of %d segments of time", segments) : "";
		const char *text = format("%s%s%s", several && i == states ? "(" : "", name[i], end);
		bool wide = strlen(line) + strlen(text) > WIDTH;
		list = format("%s%s%s%s", list, i ? "," : "", wide ? "\n *     " : i ? " " : "", text);
		line = wide ? text : format("%s, %s", line, text);
	}
	return list;
}

/* ---- the header ---- */

static int count_touched(const struct emitter *e)
{
	int touched = 0;
	for (int b = 0; b < blocks_of_step(e)->blocks; b++)
		touched += blocks_of_step(e)->block[b].group->tuned;
	return touched;
}

void banner_tuning(const struct emitter *e)
{
	const struct tuned_blocks *p = blocks_of_step(e);
	const int touched = count_touched(e);
	say(e, " * Tunable: %s.", param_list(e));
	if (p->solved)
		say(e, " $n_retune computes the factors of a step from other values and another h on the target;"
		       " of the spec's\n"
		       " * values they are these, correctly rounded. It needs some %d KB of stack.\n", p->kilobytes);
	else
		say(e, "\n"
		       " * They touch %s independent blocks; $n_retune computes the factors of these from other values"
		       "%s,\n"
		       " * of a block whose params are the spec's these, correctly rounded. It needs some %d KB of "
		       "stack.\n",
		    touched == p->blocks ? format("all %d", touched) : format("%d of %d", touched, p->blocks),
		    p->whole ? " and another h" : "", p->kilobytes);
}

/* A member of struct NAME_coeffs, its comment at a common column */
static void coefficient_member(const struct emitter *e, const char *text, const char *comment)
{
	if (*comment)
		say(e, "    %-38s /* %s */\n", text, comment);
	else
		say(e, "    %s\n", text);
}

static const char *ramp_note(const struct emitter *e, const char *what)
{
	return e->ramps ? format("; of a ramp %s", what) : "";
}

/* Of the loads, in one step */
static void load_members(const struct emitter *e)
{
	if (e->phases)
		coefficient_member(e, format("pl_turn phase_step[%d];", e->phases), "of the loads, in one step");
	if (e->model->tuning->frequencies)
		coefficient_member(e, format("pl_rate phase_rate[%d];", e->phases), "in turns per second");
	if (e->growths)
		coefficient_member(e, format("pl_growth growth_step[%d];", e->growths),
		       e->phases ? "" : "of the loads, in one step");
}

static const char *first_state(const struct emitter *e, const struct group *g)
{
	return format("%s%s", e->model->state_name[g->state[0]], g->states * g->blocks > 1 ? ", ..." : "");
}

const char *tuned_table(const struct emitter *e, const struct tuned_block *first)
{
	const char *name = shape_of_group(e, first->group).name;
	return blocks_of_step(e)->solved ? "step" : format("%s%d", name, first->index);
}

void each_tuned_group(const struct emitter *e, void (*print)(const struct emitter *e, const struct tuned_block *first))
{
	const struct tuned_blocks *p = blocks_of_step(e);
	for (int b = 0; b < p->blocks; b += p->block[b].group->blocks)
		if (p->block[b].group->tuned)
			print(e, &p->block[b]);
}

static void emit_group_member(const struct emitter *e, const struct tuned_block *first)
{
	const struct group_shape shape = shape_of_group(e, first->group);
	const bool whole = blocks_of_step(e)->solved;
	const char *note = whole ? e->step->form == FORM_DELTA ? "y += step z" : "y = step z"
				 : first_state(e, first->group);
	if (shape.rows)
		coefficient_member(e, format("double %s[%d][%d];", tuned_table(e, first), shape.rows, shape.columns),
				   note);
	if (shape.changing)
		coefficient_member(e, format("double loads%d[%d][%d][%d];", first->index, e->system->segments,
					     shape.changing, shape.columns),
				   "in each segment of time");
}

void emit_coefficient_struct(const struct emitter *e)
{
	say(e, "enum { $N_PARAMS = %d };  /* tunable: %s */\n"
	       "typedef struct $n_coeffs $n_coeffs;"
	       "  /* what a step multiplies with, at one set of params and one h */\n"
	       "/* z = %s%s */\n"
	       "struct $n_coeffs {\n", e->model->tuning->params, param_list(e), column_list(e),
	    ramp_note(e, "its value before the step, then after it"));
	coefficient_member(e, "double h;", "[s]");
	if (e->system->segments > 1)
		coefficient_member(e, "double h_low;", "of the spec's step: what h leaves out; else 0");
	coefficient_member(e, format("double params[%s_PARAMS];", e->upper), param_list(e));
	each_tuned_group(e, emit_group_member);
	if (tuned_outputs(e))
		coefficient_member(e, format("double out[%d][%d];", tuned_outputs(e), step_columns(e)),
		       format("out z, where outputs depend on params%s", ramp_note(e, "its value and its slope")));
	emit_peak_coefficients(e);
	load_members(e);
	say(e, "};\n\n");
}

void emit_tuning_declarations(const struct emitter *e)
{
	const bool one = !blocks_of_step(e)->whole;
	say(e, "\n/* Computes c anew from params (%s) and h [s]%s. 0, or c is as it was and\n"
	       " *     PL_NO_STEP     h is not %s\n"
	       " *     PL_SINGULAR    the mass matrix has no inverse, or a divisor is 0\n", param_list(e),
	    one ? ", the spec's" : "", one ? spell(e, "$N_H") : "above 0");
	if (e->model->tuning->frequencies)
		say(e, " *     PL_NO_RATE     a frequency of a load is below 0\n");
	say(e, " *     PL_NOT_FINITE  a number of it is infinite, or not a number\n"
	       " * c may be that of an instance as long as h stays. */\n"
	       "int    $n_retune($n_coeffs *c, const double params[$N_PARAMS], double h);\n"
	       "\n"
	       "/* From now on with c. State and time stay%s. */\n"
	       "void   $n_use($n *s, const $n_coeffs *c);\n"
	       "\n"
	       "/* Of the spec's values, correctly rounded: what $n_init starts with */\n"
	       "extern const $n_coeffs $n_nominal;\n"
	       "\n", e->phases ? "; phases of loads go on from where they are" : "");
}

/* ---- the generator's own coefficients ---- */

static void emit_nominal_outputs(const struct emitter *e)
{
	const char **name = ARRAY(const char *, (size_t)tuned_outputs(e));
	for (int o = 0; o < e->model->outputs; o++)
		if (e->model->tuning->output[o] >= 0)
			name[e->model->tuning->output[o] - e->model->n] = e->model->output[o].name;
	say(e, "    {\n");
	emit_number_rows(e, tuned_outputs(e), step_columns(e), nominal_outputs(e->step), name);
	say(e, "    },\n");
}

/* What of each load moves on in a step: its phase, or its growth */
static void emit_nominal_loads(const struct emitter *e, const int *index,
			       const char *(*step_text)(const struct emitter *, int))
{
	say(e, "    {\n");
	for (int l = 0; l < e->system->loads; l++)
		if (index[l] >= 0)
			say(e, "    %s,  /* %s */\n", step_text(e, l), column_text(&e->system->load[l], 0));
	say(e, "    },\n");
}

static void emit_nominal_group(const struct emitter *e, const struct tuned_block *first)
{
	const struct group_shape shape = shape_of_group(e, first->group);
	const int parts = 1 + (shape.changing > 0);
	for (int part = shape.rows ? 0 : 1; part < parts; part++) {
		const bool noted = part == 0 && !blocks_of_step(e)->solved;
		say(e, "    {%s\n", noted ? format("  /* %s */", group_note(e, first->group)) : "");
		emit_group_numbers(e, first->group, part == 1);
		say(e, "    },\n");
	}
}

void emit_nominal(const struct emitter *e)
{
	say(e, "\nconst $n_coeffs $n_nominal = {\n"
	       "    $N_H,\n"
	       "    ");
	if (e->system->segments > 1)
		say(e, "%s,\n"
		       "    ", low_text(e->model->h));
	emit_nominal_params(e);
	each_tuned_group(e, emit_nominal_group);
	if (tuned_outputs(e))
		emit_nominal_outputs(e);
	emit_nominal_peaks(e);
	if (e->phases)
		emit_nominal_loads(e, e->phase, phase_step_text);
	if (e->phases && e->model->tuning->frequencies) {
		say(e, "    {\n");
		emit_phase_rates(e);
		say(e, "    },\n");
	}
	if (e->growths)
		emit_nominal_loads(e, e->growth, growth_step_text);
	say(e, "};\n");
}
