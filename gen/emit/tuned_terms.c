/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Factors that the instance has, in steps and in outputs. */
#include "emit/emit.h"

static const char *tuned_entry(const struct emitter *e, const char *table, int row, int column)
{
	int states = e->system->states, loads = e->model->tuning->x.loads, segments = e->system->segments;
	if (column >= states + loads)
		column += (segments - 1) * loads;
	else if (column >= states && segments > 1)
		return format("s->coeffs.%s[%d][%d + s->segment * %d]", table, row, column, loads);
	return format("s->coeffs.%s[%d][%d]", table, row, column);
}

const char *tuned_factor(const struct emitter *e, int row, const struct operand *operand)
{
	if (e->step->blocks)
		return block_factor(e, row, operand);
	int states = e->system->states, loads = e->model->tuning->x.loads;
	const int first[] = { [OPERAND_STATE] = 0, [OPERAND_LOAD] = states, [OPERAND_INPUT] = states + loads };
	return tuned_entry(e, "step", row, first[operand->kind] + operand->index);
}

bool is_tuned_output(const struct emitter *e, const struct output *output)
{
	return e->kind->own_factors && e->model->tuning->output[output - e->model->output] >= 0;
}

const char *tuned_output(const struct emitter *e, const struct output *output)
{
	const struct tuning *t = e->model->tuning;
	const struct linear *system = e->system;
	if (!is_tuned_output(e, output))
		return NULL;
	int states = system->states, terms = 0;
	const char **term = ARRAY(const char *, (size_t)t->x.size + 1);
	const char **operand = ARRAY(const char *, (size_t)t->x.size);
	for (int i = 0; i < states; i++)
		operand[i] = e->local[i];
	for (int k = 0; k < t->x.loads; k++)
		operand[states + k] = column_operand(e, k);
	for (int i = 0, column = states + t->x.loads; i < system->inputs; i++)
		for (int k = 0; k <= system->input[i].hold; k++)
			operand[column++] = format(k ? "s->slope[%d]" : "s->u[%d]", i); /* none reads further */
	for (int j = 0; j < states + t->x.loads + input_columns(system); j++)
		if (tuned_output_reads(e, output, j)) {
			const char *factor = tuned_output_factor(e, output, j);
			term[terms++] = operand[j] ? format("%s * %s", factor, operand[j]) : factor;
		}
	return terms ? tree(terms, term, 13) : "0.0";
}

const char *tuned_output_factor(const struct emitter *e, const struct output *output, int column)
{
	return tuned_entry(e, "out", e->model->tuning->output[output - e->model->output] - e->model->n, column);
}

const char *tuned_output_row(const struct emitter *e, const struct output *output)
{
	return format("out[%d]", e->model->tuning->output[output - e->model->output] - e->model->n);
}

bool tuned_output_reads(const struct emitter *e, const struct output *output, int column)
{
	const struct tuning *t = e->model->tuning;
	int states = e->system->states, segments = e->system->segments;
	const bool *acts = t->acts + t->output[output - e->model->output] * t->x.size;
	if (column < states)
		return acts[column];
	if (column >= states + t->x.loads)
		return acts[column + (segments - 1) * t->x.loads];
	bool any = false;
	for (int s = 0; s < segments; s++)
		any = any || acts[column + s * t->x.loads];
	return any;
}
