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
	fprintf(e->to, "\n%s[%s_STATES][%s_STATES] = {  /* columns: %s */\n", declaration, e->upper, e->upper, state_list(step->model));
	emit_number_rows(e, n, n, value, step->model->state_name);
	fputs("};\n", e->to);
}

/* Does a loop of the step read Phi? */
static bool step_reads_phi(const struct emitter *e)
{
	const struct program *program = e->step->program;
	bool reads = !has_leftover(e->step) && e->step->form == FORM_DIRECT;
	for (int i = 0; i < program->actions && has_leftover(e->step); i++)
		reads = reads || program->action[i].flow == 0;
	return reads && program->loops && !e->model->switching;
}

/* Of the states as written; of those that are kept where a function reads it */
void emit_phi(const struct emitter *e)
{
	emit_matrix(e, e->step->shown, format("const double %s_Phi", e->name));
	if (e->model->relative && (has_jump(e) || step_reads_phi(e)))
		emit_matrix(e, e->step, format("static const double %s", stepped_table(e, "Phi")));
}

static void emit_input_matrix(const struct emitter *e, const struct step *step, const char *declaration)
{
	const struct table *table = step->branch->whole;
	double *value = ARRAY(double, (size_t)(table->states * table->inputs));
	for (int i = 0; i < table->states * table->inputs; i++)
		value[i] = table->input[i].value;
	fprintf(e->to, "\n%s[%s_STATES][%d] = {\n", declaration, e->upper, table->inputs);
	emit_number_rows(e, table->states, table->inputs, value, step->model->state_name);
	fputs("};\n", e->to);
}

void emit_gamma(const struct emitter *e)
{
	emit_input_matrix(e, e->step->shown, format("const double %s_Gamma", e->name));
	if (e->model->relative && e->step->program->loops && !e->model->switching && !has_leftover(e->step))
		emit_input_matrix(e, e->step, format("static const double %s", stepped_table(e, "Gamma")));
}

static void emit_wrapper(const struct emitter *e, const char *result, const char *function, const char *parameters, const char *arguments, bool is_const)
{
	const char *state = format(is_const ? "const struct %s" : "struct %s", e->name); /* the tag: a parameter may bear the name */
	fprintf(e->to, "static %s %s_any_%s(%svoid *s%s) { %s%s_%s((%s *)s%s); }\n", result, e->name, function, is_const ? "const " : "", parameters,
		*result != 'v' ? "return " : !e->system->inputs && strstr(parameters, "*u") ? "(void)u; " : "", e->name, function, state, arguments);
}

static void emit_start_samples(const struct emitter *e)
{
	fprintf(e->to, "static const int %s_start_samples[] = {", e->name);
	for (int i = 0; i < e->system->inputs; i++)
		fprintf(e->to, "%s%d", i ? ", " : "", e->system->input[i].first_order);
	fputs("};\n", e->to);
}

void emit_descriptor(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name, *N = e->upper;
	bool at = e->step->series.emitted, inputs = e->system->inputs > 0;
	const char **output = ARRAY(const char *, (size_t)e->model->outputs), **input = ARRAY(const char *, (size_t)e->system->inputs);
	for (int i = 0; i < e->model->outputs; i++)
		output[i] = e->model->output[i].name;
	for (int i = 0; i < e->system->inputs; i++)
		input[i] = e->system->input[i].name;
	fputs("\n/* The same functions for programs that drive any model. */\n\n", to);
	emit_name_list(e, "state_names", e->system->states, e->step->shown->model->state_name);
	if (inputs) {
		emit_name_list(e, "input_names", e->system->inputs, input);
		emit_start_samples(e);
	}
	emit_name_list(e, "output_names", e->model->outputs, output);
	fputc('\n', to);
	emit_wrapper(e, "void", "init", "", "", false);
	emit_wrapper(e, "void", "set", ", double t, const double *y", ", t, y", false);
	emit_wrapper(e, "void", "get", ", double *y", ", y", true);
	emit_wrapper(e, "double", "time", "", "", true);
	emit_wrapper(e, "void", "step", ", const double *u", inputs ? ", u" : "", false);
	emit_wrapper(e, "void", "out", ", double *out", ", out", true);
	emit_wrapper(e, "void", "run", ", size_t n, const double *u, double *out", inputs ? ", n, u, out" : ", n, out", false);
	if (at)
		emit_wrapper(e, "void", "at", ", const double *u, double tau, double *y", inputs ? ", u, tau, y" : ", tau, y", true);
	if (has_jump(e))
		emit_wrapper(e, "void", "jump", ", uint64_t n", ", n", false);
	emit_wrapper(e, "int", "status", "", "", true);
	if (e->model->tuning)
		emit_tuning_wrapper(e);
	if (e->ramps)
		emit_wrapper(e, "void", "hold", ", const double *u", ", u", false);
	fprintf(to, "\nconst pl_model %s_model = {\n    \"%s\", sizeof(struct %s), %s_STATES, %s_INPUTS, %s_OUTPUTS, sizeof(double), %s_H,\n", n, n, n, N, N, N,
		N);
	fprintf(to, "    %s_state_names, %s, %s_output_names,\n", n, inputs ? format("%s_input_names", n) : "NULL", n);
	fprintf(to, "    %s_any_init, %s_any_set, %s_any_get, %s_any_time, %s_any_step,\n    %s_any_out, %s_any_run, %s, %s, %s,\n", n, n, n, n, n, n, n,
		at ? format("%s_any_at", n) : "NULL", has_jump(e) ? format("%s_any_jump", n) : "NULL", format("%s_any_status", n));
	fprintf(to, "    %s,\n", e->model->tuning ? format("%s_PARAMS, %s_param_names, %s_nominal.params, %s_any_retune", N, n, n, n) : "0, NULL, NULL, NULL");
	fprintf(to, "    %s, %s\n};\n", e->ramps ? format("%s_any_hold", n) : "NULL", inputs ? format("%s_start_samples", n) : "NULL");
}
