/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step program as C: sums over the old state, or for a large model loops over its tables. */
#include "emit/emit.h"

/* Held: the sample that the step is given. A ramp: the previous sample, then the one given. */
const char *input_operand(const struct emitter *e, int column)
{
	for (int i = 0; i < e->system->inputs; i++) {
		int columns = e->system->input[i].first_order ? 2 : 1;
		if (column < columns)
			return format(columns == 2 && column == 0 ? "s->u[%d]" : "u[%d]", i);
		column -= columns;
	}
	return NULL;
}

static const char *operand_text(const struct emitter *e, const struct operand *operand)
{
	switch (operand->kind) {
	case OPERAND_STATE: return e->local[operand->index];
	case OPERAND_LOAD:  return column_operand(e, operand->index);
	default:            return input_operand(e, operand->index);
	}
}

/* A load that changes has its factors in a table, one row for each segment of time. */
static const char *term_text(const struct emitter *e, const struct assignment *a, const struct product *p)
{
	const char *operand = operand_text(e, &p->operand);
	if (e->step->program->tuned)
		return operand ? format("%s * %s", tuned_factor(e, a->target, &p->operand), operand) : tuned_factor(e, a->target, &p->operand);
	if (p->operand.kind != OPERAND_LOAD || e->system->segments == 1)
		return scaled(p->factor->value, operand);
	const char *factor = format("factor[%d][%d]", a->target, p->operand.index);
	return operand ? format("%s * %s", factor, operand) : factor;
}

static const char *sum_text(const struct emitter *e, const struct assignment *a, int indent)
{
	const char **term = ARRAY(const char *, (size_t)a->terms + 1);
	for (int k = 0; k < a->terms; k++)
		term[k] = term_text(e, a, &a->term[k]);
	return a->terms ? tree(a->terms, term, indent) : "0.0";
}

/* The factors' second words; NULL: there are none */
static const char *second_sum_text(const struct emitter *e, const struct assignment *a)
{
	const char **term = ARRAY(const char *, (size_t)a->terms + 1);
	int terms = 0;
	for (int k = 0; k < a->terms; k++)
		if (has_second_word(&a->term[k], e->system))
			term[terms++] = scaled(a->term[k].factor->low, operand_text(e, &a->term[k].operand));
	return terms ? tree(terms, term, 14) : NULL;
}

/* target = target + (sum), what its rounding takes kept in s->rest; of plain steps in s->carry */
static void emit_compensated(const struct emitter *e, const struct assignment *a, const char *target)
{
	const char *second = a->carried ? NULL : second_sum_text(e, a), *sum = sum_text(e, a, 14);
	fprintf(e->to, "    %s = pl_accumulate(%s,  /* %s */\n              %s,\n              %s, &s->%s[%d]);\n", target, e->local[a->target],
		e->model->state_name[a->target], sum, second ? second : "0.0", a->carried ? "carry" : "rest", a->carried ? e->step->carry[a->target] : a->target);
}

static void emit_assignment(const struct emitter *e, const struct assignment *a)
{
	const struct program *program = e->step->program;
	const char *target = program->in_order ? e->local[a->target] : format("s->y[%d]", a->target), *name = e->model->state_name[a->target];
	if (program->compensated || a->carried)
		emit_compensated(e, a, target);
	else if (program->in_order)
		fprintf(e->to, "    %s += %s;\n", target, sum_text(e, a, 10));
	else if (a->added)
		fprintf(e->to, a->terms > 1 ? "    %s = %s + (%s);  /* %s */\n" : "    %s = %s + %s;  /* %s */\n", target, e->local[a->target], sum_text(e, a, 14), name);
	else
		fprintf(e->to, "    %s = %s;  /* %s */\n", target, sum_text(e, a, 14), name);
}

static bool *loads_of_step(const struct emitter *e)
{
	bool *wanted = ARRAY(bool, (size_t)e->system->loads);
	for (int l = 0, column = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns; k++, column++)
			wanted[l] = wanted[l] || (load_operand(e, l, k) && e->step->program->uses[column]);
	return wanted;
}

static void emit_keep_inputs(const struct emitter *e)
{
	for (int i = 0; i < e->system->inputs; i++) {
		if (e->system->input[i].first_order)
			fprintf(e->to, "    s->slope[%d] = (u[%d] - s->u[%d]) / %s;\n", i, i, i, step_length(e));
		fprintf(e->to, "    s->u[%d] = u[%d];\n", i, i);
	}
}

static bool any_load_term(const struct program *program)
{
	for (int i = 0; i < program->assignments; i++)
		for (int k = 0; k < program->assignment[i].terms; k++)
			if (program->assignment[i].term[k].operand.kind == OPERAND_LOAD)
				return true;
	return false;
}

static void emit_load_factors(const struct emitter *e)
{
	const struct table *table = e->step->branch->whole;
	double *value = ARRAY(double, (size_t)(table->states * table->columns));
	int columns = 0;
	for (int k = 0; k < table->columns; k++)
		columns += !e->step->program->loops || !is_forced(e->step, k);
	if (columns == 0)
		return;
	fprintf(e->to, "\n/* Factors of the load states in each segment of time */\nstatic const double %s_load_factor[%d][%s_STATES][%d] = {\n",
		e->name, e->system->segments, e->upper, columns);
	for (int s = 0; s < e->system->segments; s++) {
		int count = 0;
		for (int i = 0; i < table->states * table->columns; i++)
			if (!e->step->program->loops || !is_forced(e->step, i % table->columns))
				value[count++] = table->load[s * table->states * table->columns + i].value;
		fputs("  {\n", e->to);
		emit_number_rows(e, table->states, columns, value, e->model->state_name);
		fputs("  },\n", e->to);
	}
	fputs("};\n", e->to);
}

/* What --reduce has left nothing of for it to act on: it has no phase and no growth, and its factors are 0. */
static bool is_gone(const struct emitter *e, int load)
{
	const struct wave *wave = e->system->load[load].wave;
	return (oscillates(wave) && e->phase[load] < 0) || (mpq_sgn(wave->a) != 0 && e->growth[load] < 0);
}

static bool is_of_gone_load(const struct emitter *e, int column)
{
	int l = 0;
	for (; column >= e->system->load[l].columns; l++)
		column -= e->system->load[l].columns;
	return is_gone(e, l);
}

/* vector[...] = the operands of the columns of a table; then y[i] += table[i][...] vector[...] */
static void emit_columns(const struct emitter *e, const char *table, const char *vector, enum operand_kind kind, int columns)
{
	int count = 0;
	for (int k = 0; k < columns; k++)
		count += kind != OPERAND_LOAD || !is_forced(e->step, k);
	columns = count;
	if (columns == 0)
		return;
	fprintf(e->to, "    const double %s[%d] = {", vector, columns);
	for (int k = 0, shown = 0; shown < columns; k++) {
		bool gone = kind == OPERAND_LOAD && is_of_gone_load(e, k);
		const char *operand = operand_text(e, &(struct operand){ kind, k });
		if (kind != OPERAND_LOAD || !is_forced(e->step, k))
			fprintf(e->to, "%s%s", shown++ ? ", " : "", gone ? "0.0" : operand ? operand : "1.0");
	}
	fprintf(e->to, "};\n    for (i = 0; i < %s_STATES; i++)\n        for (j = 0; j < %d; j++)\n            y[i] += %s[i][j] * %s[j];\n", e->upper, columns,
		table, vector);
}

void emit_set_aside(const struct emitter *e)
{
	for (int i = 0; i < e->system->states; i++)
		if (e->step->carry[i] >= 0)
			fprintf(e->to, "    const double far%d = s->y[%d];  /* nothing reads %s: over the step it is 0 */\n", e->step->carry[i], i, e->model->state_name[i]);
	for (int i = 0; i < e->system->states; i++)
		if (e->step->carry[i] >= 0)
			fprintf(e->to, "    s->y[%d] = 0.0;\n", i);
}

void emit_take_back(const struct emitter *e)
{
	for (int i = 0; i < e->system->states; i++)
		if (e->step->carry[i] >= 0)
			fprintf(e->to, "    s->y[%d] = pl_accumulate(far%d, s->y[%d], 0.0, &s->carry[%d]);\n", i, e->step->carry[i], i, e->step->carry[i]);
}

/* A large model steps by loops over its tables: text that nobody would read is of no use. */
static void emit_looped_step(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name, *N = e->upper;
	const struct table *table = e->step->branch->whole;
	bool *loads = ARRAY(bool, (size_t)e->system->loads);
	fprintf(to, "    double y[%s_STATES];\n    int i, j;\n", N);
	emit_set_aside(e);
	for (int l = 0, column = 0; l < e->system->loads; column += e->system->load[l++].columns)
		loads[l] = !is_forced(e->step, column) && !is_gone(e, l);
	emit_load_states(e, loads, false);
	fprintf(to, "    for (i = 0; i < %s_STATES; i++) {\n        y[i] = 0.0;\n        for (j = 0; j < %s_STATES; j++)\n", N, N);
	fprintf(to, "            y[i] += %s[i][j] * s->y[j];\n    }\n", e->step->form == FORM_DELTA ? format("%s_increment", n) : stepped_table(e, "Phi"));
	emit_columns(e, format("%s_load_factor[%s]", n, e->system->segments > 1 ? "s->segment" : "0"), "load", OPERAND_LOAD, table->columns);
	emit_columns(e, stepped_table(e, "Gamma"), "input", OPERAND_INPUT, table->inputs);
	fprintf(to, "    for (i = 0; i < %s_STATES; i++)\n        s->y[i] %s y[i];\n", N, e->step->form == FORM_DELTA ? "+=" : "=");
	emit_take_back(e);
}

/* A step that no change of the loads interrupts */
static void emit_plain_step(const struct emitter *e)
{
	const struct program *program = e->step->program;
	if (program->loops) {
		emit_looped_step(e);
		return;
	}
	emit_raw_locals(e, program->reads, program->in_order);
	emit_load_states(e, loads_of_step(e), false);
	if (e->system->segments > 1 && any_load_term(program) && !program->tuned)
		fprintf(e->to, "    const double (*const factor)[%d] = %s_load_factor[s->segment];\n", e->step->branch->whole->columns, e->name);
	for (int i = 0; i < program->assignments; i++)
		emit_assignment(e, &program->assignment[i]);
	for (int i = 0; i < e->system->states && program->in_order; i++)
		if (program->reads[i])
			fprintf(e->to, "    s->y[%d] = %s;\n", i, e->local[i]);
}

void emit_step_end(const struct emitter *e)
{
	emit_keep_inputs(e);
	emit_load_advance(e, NULL);
	fputs("    s->k++;\n", e->to);
}

const char *step_parameters(const struct emitter *e)
{
	return format("%s *s%s", e->name, e->system->inputs ? format(", const double u[%s_INPUTS]", e->upper) : "");
}

/* The forced part changes with the loads; pass() does that for the changes inside the step. */
static void emit_forced_changes(const struct emitter *e, const char *u)
{
	const char *n = e->name, *changing = e->step->forced->changes ? format("        %s_rebase(s);\n", e->name) : "";
	int changes = e->system->segments - 1;
	fprintf(e->to, "    int segment = s->segment;\n    if (segment < %d && %s_until(s, segment) < %s) {\n", changes, n, step_length(e));
	fprintf(e->to, "        double y[%s_STATES];\n        int i;\n        segment = %s_pass(s, %s%s, 0, y);\n", e->upper, n, u, step_length(e));
	emit_store(e, "y", "        ");
	fprintf(e->to, "    } else {\n        %s_plain_step(s%s);\n    }\n", n, *u ? ", u" : "");
	emit_step_end(e);
	fprintf(e->to, "    s->segment = segment;\n    while (s->segment < %d && %s_until(s, s->segment) <= 1e-18 * %s) {\n%s        s->segment++;\n    }\n}\n", changes, n,
		step_length(e), changing);
}

static void emit_changing_step(const struct emitter *e)
{
	const char *n = e->name, *u = e->system->inputs ? "u, " : "";
	int changes = e->system->segments - 1;
	if (any_load_term(e->step->program) && !e->step->program->loops && !e->step->program->tuned)
		emit_load_factors(e);
	fprintf(e->to, "\nstatic void %s_plain_step(%s)\n{\n", e->name, step_parameters(e));
	emit_plain_step(e);
	if (e->system->inputs)
		fputs("    (void)u;\n", e->to);
	fprintf(e->to, "}\n\nvoid %s_step(%s)\n{\n", n, step_parameters(e));
	if (e->step->forced) {
		emit_forced_changes(e, u);
		return;
	}
	fprintf(e->to, "    if (s->segment < %d && %s_until(s, s->segment) < %s) {\n", changes, n, step_length(e));
	fprintf(e->to, "        double y[%s_STATES];\n        int i;\n        %s_pass(s, %s%s, y);\n", e->upper, n, u, step_length(e));
	emit_store(e, "y", "        ");
	fprintf(e->to, "    } else {\n        %s_plain_step(s%s);\n    }\n", n, *u ? ", u" : "");
	emit_step_end(e);
	fprintf(e->to, "    while (s->segment < %d && %s_until(s, s->segment) <= 1e-18 * %s)\n        s->segment++;\n}\n", changes, n, step_length(e));
}

/* Phi - I, for a step that loops */
static void emit_increments(const struct emitter *e)
{
	int n = e->system->states;
	double *value = ARRAY(double, (size_t)(n * n));
	for (int i = 0; i < n * n; i++)
		value[i] = e->step->branch->whole->increment[i].value;
	fprintf(e->to, "\nstatic const double %s_increment[%s_STATES][%s_STATES] = {  /* Phi - I, rounded as it is */\n", e->name, e->upper, e->upper);
	emit_number_rows(e, n, n, value, e->model->state_name);
	fputs("};\n", e->to);
}

void emit_step(const struct emitter *e)
{
	if (e->step->program->loops && e->step->form == FORM_DELTA)
		emit_increments(e);
	if (e->step->program->loops && e->step->branch->whole->columns)
		emit_load_factors(e);
	if (e->system->segments > 1) {
		emit_changing_step(e);
		return;
	}
	fprintf(e->to, "\nvoid %s_step(%s)\n{\n", e->name, step_parameters(e));
	emit_plain_step(e);
	emit_step_end(e);
	fputs("}\n", e->to);
}
