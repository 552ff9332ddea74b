/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables that everyone may read, and the descriptor: the same functions for programs that drive any model. */
#include "declarations.h"
#include "model/linear/modal_truncation.h"
#include "model/tunable/tuning.h"
#include "report/report.h"

/* Phi, or Gamma */
static void emit_matrix(const struct emitter *e, const struct step *step, bool of_inputs, const char *declaration)
{
	const struct table *table = step->branch->full;
	const struct coefficient *entry = of_inputs ? table->input : table->Phi;
	const int columns = of_inputs ? table->inputs : table->states;
	double *value = ARRAY(double, (size_t)(table->states * columns));
	for (int i = 0; i < table->states * columns; i++)
		value[i] = entry[i].value;
	say(e, "\n%s[$N_STATES][%s] = {%s\n", declaration, of_inputs ? integer_text(columns) : spell(e, "$N_STATES"),
	    of_inputs ? "" : format("  /* columns: %s */", state_list(step->model)));
	emit_number_rows(e, table->states, columns, value, step->model->names.state);
	say(e, "};\n");
}

/* Of what is kept, in a loop */
static bool flows_in_full(const struct step *step)
{
	const struct program *program = step->program;
	bool full = false;
	for (int i = 0; i < program->actions; i++)
		full = full || program->action[i].flow == 0;
	return full && program->loops;
}

/* Of the states that are kept, where a function reads it */
void emit_kept_phi(const struct emitter *e)
{
	if (e->step->shown->no.phi)
		return;
	const bool leaps = has_jump(e) && !e->step->is.tuned;
	if (e->model->relative && (leaps || flows_in_full(e->step)))
		emit_matrix(e, e->step, false, format("static const double %s", stepped_table(e)));
}

static void emit_rounded(const struct emitter *e, int rows, int columns, const mpq_t *q, const char *const *row_note)
{
	double *value = ARRAY(double, (size_t)(rows * columns));
	for (int i = 0; i < rows * columns; i++)
		value[i] = round_rational(q[i]);
	emit_number_rows(e, rows, columns, value, row_note);
	say(e, "};\n");
}

/* Between the states of all modes and those of the kept ones */
static void emit_mode_matrices(const struct emitter *e)
{
	const struct modal_truncation *s = e->model->reduction.truncated;
	const struct model *full = e->model->written;
	const int states = e->system->states, all = full->system.states;
	if (!s)
		return;
	say(e, "\n/* The state of a full state x, what the modes that are kept have of it: y = project x. */\n"
	       "const double $n_project[$N_STATES][%d] = {  /* columns: %s */\n", all, state_list(full));
	emit_rounded(e, states, all, (const mpq_t *)s->to, e->model->names.state);
	say(e, "\n/* The full state of a state, the part of the dropped modes left out: x = expand y. */\n"
	       "const double $n_expand[%d][$N_STATES] = {  /* columns: %s */\n", all, state_list(e->model));
	emit_rounded(e, all, states, (const mpq_t *)s->from, full->names.state);
}

/* Of the states as written */
static void emit_phi(const struct emitter *e)
{
	if (!e->step->shown->no.phi)
		emit_matrix(e, e->step->shown, false, spell(e, "const double $n_Phi"));
}

static void emit_gamma(const struct emitter *e)
{
	if (given_inputs(e) && !e->step->shown->no.phi)
		emit_matrix(e, e->step->shown, true, spell(e, "const double $n_Gamma"));
}

void emit_declared_tables(const struct emitter *e)
{
	emit_phi(e);
	emit_gamma(e);
	emit_mode_matrices(e);
}

static void emit_start_samples(const struct emitter *e, int inputs)
{
	int *ahead = ARRAY(int, (size_t)inputs);
	for (int i = 0; i < inputs; i++)
		ahead[i] = samples_ahead(e->system->input[i].hold);
	emit_int_list(e, "start_samples", inputs, ahead);
}

static void emit_names(const struct emitter *e, int inputs, const struct tuning *tunable)
{
	emit_name_list(e, "state_names", e->system->states, e->step->shown->model->names.state);
	if (inputs) {
		emit_name_list(e, "input_names", inputs, names_of_inputs(e));
		emit_start_samples(e, inputs);
	}
	emit_name_list(e, "output_names", e->model->outputs, names_of_outputs(e));
	if (tunable)
		emit_name_list(e, "param_names", tunable->given, names_of_params(tunable));
}

/* Of the size that errors are measured by */
static void emit_allowed(const struct emitter *e)
{
	say(e, "\nvoid $n_allowed(const $n *s, double y[$N_STATES])\n"
	       "{\n"
	       "    int i;\n"
	       "    for (i = 0; i < $N_STATES; i++) { y[i] = %ss->unit[i] > 0.0 ? %s / s->unit[i] : 0.0; }\n"
	       "}\n", has_floors(e) ? spell(e, "$n_floor[i] > 0.0 ? 0.0 : ") : "",
	    shortest(round_rational(e->model->truncation.tolerance)));
}

static void emit_units_of(const struct emitter *e, enum listed kind, const char *array, int count)
{
	const char **text = ARRAY(const char *, (size_t)count + 1);
	for (int i = 0; i < count; i++)
		text[i] = unit_of_listed(e->step, kind, i);
	if (count > 0)
		emit_name_list(e, array, count, text);
}

/* One of the param's own unit in SI units */
static void emit_param_factors(const struct emitter *e, const struct tuning *tunable)
{
	const char **text = ARRAY(const char *, (size_t)tunable->given);
	for (int k = 0; k < tunable->given; k++)
		text[k] = format("%.17g", unit_factor(tunable->param[k].symbol->unit));
	emit_name_list(e, "param_factors", tunable->given, text);
}

static void emit_units(const struct emitter *e, int inputs)
{
	const struct tuning *tunable = tunables_of(e->model);
	const int states = e->system->states, outputs = e->model->outputs;
	if (!e->model->spec->units.written)
		return;
	say(e, "\n/* Units as text; \"\" where none is known. */\n");
	emit_units_of(e, LISTED_STATE, "state_units", states);
	emit_units_of(e, LISTED_INPUT, "input_units", inputs);
	emit_units_of(e, LISTED_OUTPUT, "output_units", outputs);
	if (tunable) {
		emit_units_of(e, LISTED_PARAM, "param_units", tunable->given);
		emit_param_factors(e, tunable);
	}
	say(e, "const pl_units $n_units = { $n_state_units, %s, %s, %s };\n",
	    inputs ? spell(e, "$n_input_units") : "NULL", outputs ? spell(e, "$n_output_units") : "NULL",
	    tunable ? spell(e, "$n_param_units, $n_param_factors") : "NULL, NULL");
}

void emit_model(const struct emitter *e, int inputs, bool core)
{
	const struct tuning *tunable = tunables_of(e->model);
	emit_names(e, inputs, tunable);
	emit_sizes(e, "descriptor.h", { "STATES", e->system->states }, { "INPUTS", inputs },
		   { "OUTPUTS", e->model->outputs },
		   { "PARAMS", tunable ? tunable->given : 0 }, { "AT", e->step->series.emitted },
		   { "JUMPS", core && has_jump(e) }, { "RAMPS", e->ramps });
	say(e, "#define PL_NAME \"$n\"\n"
	       "#define PL_SPEC_H $N_H\n"
	       "#include \"descriptor.h\"\n");
	emit_units(e, inputs);
}

void emit_descriptor(const struct emitter *e)
{
	say(e, "\n/* ---- descriptor, by which programs run any model ---- */\n\n");
	emit_model(e, given_inputs(e), true);
	if (tells_tolerance(e))
		emit_allowed(e);
}
