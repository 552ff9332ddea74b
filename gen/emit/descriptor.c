/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables that everyone may read, and the descriptor: the same functions for programs that drive any model. */
#include "emit/emit.h"

#include <string.h>

static void emit_matrix(const struct emitter *e, const struct step *step, const char *declaration)
{
	int n = e->system->states;
	double *value = ARRAY(double, (size_t)(n * n));
	for (int i = 0; i < n * n; i++)
		value[i] = step->branch->whole->Phi[i].value;
	say(e, "\n%s[$N_STATES][$N_STATES] = {  /* columns: %s */\n", declaration, state_list(step->model));
	emit_number_rows(e, n, n, value, step->model->state_name);
	say(e, "};\n");
}

/* Of the states as written; of those that are kept where a function reads it */
void emit_phi(const struct emitter *e)
{
	if (e->step->shown->no_phi)
		return;
	emit_matrix(e, e->step->shown, spell(e, "const double $n_Phi"));
	if (e->model->relative && (has_jump(e) || e->kind->reads_phi(e->step)))
		emit_matrix(e, e->step, format("static const double %s", stepped_table(e, "Phi")));
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
void emit_mode_matrices(const struct emitter *e)
{
	const struct shortening *s = e->model->shortened;
	const struct model *whole = e->model->written;
	const int states = e->system->states, all = whole->system.states;
	if (!s)
		return;
	say(e, "\n/* The state of a full state x, what the modes that are kept have of it: y = from_whole x. */\n"
	       "const double $n_from_whole[$N_STATES][%d] = {  /* columns: %s */\n", all, state_list(whole));
	emit_rounded(e, states, all, (const mpq_t *)s->to, e->model->state_name);
	say(e, "\n/* The full state of a state, the part of the dropped modes left out: x = to_whole y. */\n"
	       "const double $n_to_whole[%d][$N_STATES] = {  /* columns: %s */\n", all, state_list(e->model));
	emit_rounded(e, all, states, (const mpq_t *)s->from, whole->state_name);
}

static void emit_input_matrix(const struct emitter *e, const struct step *step, const char *declaration)
{
	const struct table *table = step->branch->whole;
	double *value = ARRAY(double, (size_t)(table->states * table->inputs));
	for (int i = 0; i < table->states * table->inputs; i++)
		value[i] = table->input[i].value;
	say(e, "\n%s[$N_STATES][%d] = {\n", declaration, table->inputs);
	emit_number_rows(e, table->states, table->inputs, value, step->model->state_name);
	say(e, "};\n");
}

void emit_gamma(const struct emitter *e)
{
	if (!e->step->shown->no_phi)
		emit_input_matrix(e, e->step->shown, spell(e, "const double $n_Gamma"));
}

static void emit_wrapper(const struct emitter *e, const char *result, const char *function, const char *parameters,
			 const char *arguments, bool is_const)
{
	/* the tag: a parameter may bear the name */
	const char *state = format(is_const ? "const struct %s" : "struct %s", e->name);
	say(e, "static %s $n_any_%s(%svoid *s%s) { %s$n_%s((%s *)s%s); }\n", result, function,
	       is_const ? "const " : "", parameters,
	       *result != 'v' ? "return " : !given_inputs(e) && strstr(parameters, "*u") ? "(void)u; " : "",
	       function, state, arguments);
}

static void emit_start_samples(const struct emitter *e, int inputs)
{
	say(e, "static const int $n_start_samples[] = {");
	for (int i = 0; i < inputs; i++)
		say(e, "%s%d", i ? ", " : "", samples_ahead(e->system->input[i].hold));
	say(e, "};\n");
}

static void emit_names(const struct emitter *e, int inputs)
{
	emit_name_list(e, "state_names", e->system->states, e->step->shown->model->state_name);
	if (inputs) {
		emit_name_list(e, "input_names", inputs, names_of_inputs(e));
		emit_start_samples(e, inputs);
	}
	emit_name_list(e, "output_names", e->model->outputs, names_of_outputs(e));
}

static void emit_wrappers(const struct emitter *e)
{
	bool inputs = given_inputs(e) > 0;
	emit_wrapper(e, "void", "init", "", "", false);
	emit_wrapper(e, "void", "set", ", double t, const double *y", ", t, y", false);
	emit_wrapper(e, "void", "get", ", double *y", ", y", true);
	emit_wrapper(e, "double", "time", "", "", true);
	emit_wrapper(e, "void", "step", ", const double *u", inputs ? ", u" : "", false);
	emit_wrapper(e, "void", "out", ", double *out", ", out", true);
	emit_wrapper(e, "void", "run", ", size_t n, const double *u, double *out", inputs ? ", n, u, out" : ", n, out",
		     false);
	if (e->step->series.emitted)
		emit_wrapper(e, "void", "at", ", const double *u, double tau, double *y",
			     inputs ? ", u, tau, y" : ", tau, y", true);
	emit_wrapper(e, "int", "status", "", "", true);
	if (e->ramps)
		emit_wrapper(e, "void", "hold", ", const double *u", ", u", false);
}

/* The name of what there is in some models only */
static const char *name_if(const struct emitter *e, bool there, const char *name)
{
	return there ? spell(e, "$n_%s", name) : "NULL";
}

/* Of the size that errors are measured by */
static void emit_allowed(const struct emitter *e)
{
	say(e, "\nvoid $n_allowed(const $n *s, double y[$N_STATES])\n"
	       "{\n"
	       "    int i;\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        y[i] = %ss->unit[i] > 0.0 ? %s / s->unit[i] : 0.0;\n"
	       "}\n", has_floors(e) ? spell(e, "$n_floor[i] > 0.0 ? 0.0 : ") : "",
	    shortest(round_rational(e->model->truncation.tolerance)));
}

void emit_model(const struct emitter *e, int inputs, bool core)
{
	const bool jump = core && has_jump(e);
	emit_names(e, inputs);
	say(e, "\n");
	emit_wrappers(e);
	if (jump)
		emit_wrapper(e, "void", "jump", ", uint64_t n", ", n", false);
	if (core)
		e->kind->wrappers(e);
	say(e, "\nconst pl_model $n_model = {\n"
	       "    PL_MODEL_VERSION, sizeof(double), \"$n\", sizeof(struct $n),\n"
	       "    $N_STATES, $N_INPUTS, $N_OUTPUTS, $N_H,\n"
	       "    $n_state_names, %s, $n_output_names,\n"
	       "    $n_any_init, $n_any_set, $n_any_get, $n_any_time, $n_any_step,\n"
	       "    $n_any_out, $n_any_run, %s, %s, $n_any_status,\n", name_if(e, inputs, "input_names"),
	       name_if(e, e->step->series.emitted, "any_at"), name_if(e, jump, "any_jump"));
	if (core)
		e->kind->params(e);
	else
		say(e, "    0, NULL, NULL, NULL,\n");
	say(e, "    %s, %s\n"
	       "};\n", name_if(e, e->ramps, "any_hold"), name_if(e, inputs, "start_samples"));
}

void emit_descriptor(const struct emitter *e)
{
	say(e, "\n/* The same functions for programs that drive any model. */\n\n");
	emit_model(e, given_inputs(e), true);
	if (tells_tolerance(e))
		emit_allowed(e);
}
