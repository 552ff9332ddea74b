/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state in emitted code: its locals, what is kept of it, how it is stored and read. */
#include "emit/emit.h"

const struct model *speaker(const struct model *model)
{
	return model->relative ? model : model->written;
}

const char *input_name(const struct emitter *e, int input, int order)
{
	for (const struct symbol *s = e->model->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_INPUT && s->index == input)
			return order ? s->c_dot : s->c_name;
	return NULL;
}

/* The table Phi, or Gamma, of the states as they are kept */
const char *stepped_table(const struct emitter *e, const char *table)
{
	return format(e->model->relative ? "%s_%s_kept" : "%s_%s", e->name, table);
}

/* The mass that a kept velocity is multiplied with; NULL: 1 */
const char *factor_of_momentum(const struct emitter *e, int state)
{
	if (!e->step->momenta || state < e->model->n || mpq_cmp_ui(e->step->mass[e->system->coord[state]], 1, 1) == 0)
		return NULL;
	return shortest(finite_number(e, e->step->mass[e->system->coord[state]]));
}

/* The states wanted. `velocities`: without masses; else as the struct has them. */
static void write_locals(const struct emitter *e, const bool *reads, const char *type, const char *vector, bool velocities)
{
	const char *list = "";
	bool forced = velocities && e->step->forced;    /* then the vector is whole */
	for (int i = 0; i < e->system->states; i++) {
		const char *mass = velocities && !forced ? factor_of_momentum(e, i) : NULL;
		if (reads[i])
			list = format("%s%s%s = %s[%d]%s", list, *list ? ", " : format("    %s ", type), e->local[i], vector, i, mass ? format(" / %s", mass) : "");
	}
	for (int width = 0; *list; list++) {            /* a line break instead of the blank that would pass column 110 */
		putc(*list == ' ' && width > 100 && list[-1] == ',' ? '\n' : *list, e->to);
		if (*list == ' ' && width > 100 && list[-1] == ',') {
			fputs("                 ", e->to);
			width = 17;
		}
		width++;
		if (!list[1])
			fputs(";\n", e->to);
	}
}

void emit_locals(const struct emitter *e, const bool *reads)
{
	bool any = false;
	for (int i = 0; i < e->system->states; i++)
		any = any || reads[i];
	if (e->step->forced && any)
		fprintf(e->to, "    double now[%s_STATES];\n    %s_%s(s, now);\n", e->upper, e->name, e->model->relative ? "kept" : "get");
	write_locals(e, reads, "const double", e->step->forced ? "now" : "s->y", true);
}

void emit_raw_locals(const struct emitter *e, const bool *reads, bool changing)
{
	write_locals(e, reads, changing ? "double" : "const double", "s->y", false);
}

void emit_locals_of(const struct emitter *e, const bool *reads, const char *vector)
{
	write_locals(e, reads, "const double", vector, false);
}

const char *step_length(const struct emitter *e)
{
	return e->model->tuning ? "s->coeffs.h" : format("%s_H", e->upper);
}

/* s->y from a vector of states, nothing left of earlier rounding */
void emit_store(const struct emitter *e, const char *vector, const char *indent)
{
	FILE *to = e->to;
	bool rest = e->step->program->compensated;
	fprintf(to, "%sfor (i = 0; i < %s_STATES; i++)%s\n%s    s->y[i] = %s[i];\n", indent, e->upper, rest ? " {" : "", indent, vector);
	if (rest)
		fprintf(to, "%s    s->rest[i] = 0.0;\n%s}\n", indent, indent);
	for (int i = 0; i < e->system->states; i++)
		if (factor_of_momentum(e, i))
			fprintf(to, "%ss->y[%d] = %s * %s[%d];\n", indent, i, factor_of_momentum(e, i), vector, i);
	for (int i = 0; i < e->step->carries; i++)
		fprintf(to, "%ss->carry[%d] = 0.0;\n", indent, i);
}

/* y = z + f, f the forced part: what rounds off in z = y - f is kept in rest */
void emit_state_forced(const struct emitter *e, const char *vector, const char *indent)
{
	fprintf(e->to, "%s%s_forced(s, now);\n", indent, e->name);
	fprintf(e->to, "%sfor (i = 0; i < %s_STATES; i++) {\n", indent, e->upper);
	fprintf(e->to, "%s    const double f = now[i], z = %s[i] - f, lost = z - %s[i];\n", indent, vector, vector);
	fprintf(e->to, "%s    s->y[i] = z;\n%s    s->rest[i] = (%s[i] - (z - lost)) - (f + lost);\n%s}\n", indent, indent, vector, indent);
	for (int i = 0; i < e->step->carries; i++)
		fprintf(e->to, "%ss->carry[%d] = 0.0;\n", indent, i);
}

/* A vector of states from s->y; what rounds off in z + f counts, so that it is what was set */
void emit_load_state(const struct emitter *e, const char *vector)
{
	if (e->step->forced)
		fprintf(e->to, "    double now[%s_STATES];\n", e->upper);
	emit_kept_state(e, vector);
	if (!e->step->forced)
		return;
	fprintf(e->to, "    %s_forced(s, now);\n    for (i = 0; i < %s_STATES; i++) {\n", e->name, e->upper);
	fprintf(e->to, "        const double z = %s[i], sum = z + now[i], back = sum - z;\n", vector);
	fprintf(e->to, "        %s[i] = sum + (((z - (sum - back)) + (now[i] - back)) + %s);\n    }\n", vector,
		e->step->program->compensated ? "s->rest[i]" : "(s->k == 0 ? s->rest[i] : 0.0)");
}

void emit_kept_state(const struct emitter *e, const char *vector)
{
	fprintf(e->to, "    for (i = 0; i < %s_STATES; i++)\n        %s[i] = s->y[i];\n", e->upper, vector);
	for (int i = 0; i < e->system->states; i++)
		if (factor_of_momentum(e, i))
			fprintf(e->to, "    %s[%d] = s->y[%d] / %s;\n", vector, i, i, factor_of_momentum(e, i));
}

static const char *tuned_entry(const struct emitter *e, const char *table, int row, int column)
{
	int states = e->system->states, loads = e->model->tuning->loads, segments = e->system->segments;
	if (column >= states + loads)
		column += (segments - 1) * loads;
	else if (column >= states && segments > 1)
		return format("s->coeffs.%s[%d][%d + s->segment * %d]", table, row, column, loads);
	return format("s->coeffs.%s[%d][%d]", table, row, column);
}

const char *tuned_factor(const struct emitter *e, int row, const struct operand *operand)
{
	int states = e->system->states;
	int column = operand->kind == OPERAND_LOAD ? states + operand->index : operand->kind == OPERAND_INPUT ? states + e->model->tuning->loads + operand->index : operand->index;
	return tuned_entry(e, "step", row, column);
}

const char *tuned_output(const struct emitter *e, const struct output *output)
{
	const struct tuning *t = e->model->tuning;
	const struct linear *system = e->system;
	int row = t ? t->output[output - e->model->output] : -1, states = system->states, terms = 0;
	if (row < 0)
		return NULL;
	const char **term = ARRAY(const char *, (size_t)t->columns + 1), **operand = ARRAY(const char *, (size_t)t->columns);
	for (int i = 0; i < states; i++)
		operand[i] = e->local[i];
	for (int k = 0; k < t->loads; k++)
		operand[states + k] = column_operand(e, k);
	for (int i = 0, column = states + t->loads; i < system->inputs; i++)
		for (int k = 0; k < (system->input[i].first_order ? 2 : 1); k++)
			operand[column++] = format(k ? "s->slope[%d]" : "s->u[%d]", i);
	for (int j = 0; j < states + t->loads + input_columns(system); j++)
		if (tuned_output_reads(e, output, j)) {
			const char *factor = tuned_entry(e, "out", row - e->model->n, j);
			term[terms++] = operand[j] ? format("%s * %s", factor, operand[j]) : factor;
		}
	return terms ? tree(terms, term, 13) : "0.0";
}

bool tuned_output_reads(const struct emitter *e, const struct output *output, int column)
{
	const struct tuning *t = e->model->tuning;
	int states = e->system->states, segments = e->system->segments;
	const bool *acts = t->acts + t->output[output - e->model->output] * t->columns;
	if (column < states)
		return acts[column];
	if (column >= states + t->loads)
		return acts[column + (segments - 1) * t->loads];
	bool any = false;
	for (int s = 0; s < segments; s++)
		any = any || acts[column + s * t->loads];
	return any;
}
