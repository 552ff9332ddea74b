/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outputs as C: rows over states, load states and inputs, or what is not linear as its own expression. */
#include "plgen.h"

void emit_used_constants(const struct emitter *e, bool lets)
{
	for (const struct symbol *s = e->model->spec->first; s; s = s->next) {
		if (!s->used || (s->kind != SYMBOL_PARAM && s->kind != SYMBOL_LET))
			continue;
		if (s->kind == SYMBOL_PARAM) {
			struct collector collector = { .scheme = "exact" };
			mpq_t value;
			mpq_init(value);
			constant_value(&collector, s->collected->cell[0], value);
			fprintf(e->to, "    const double %s = %s;\n", s->c_name, finite_text(s->at, value));
			mpq_clear(value);
		} else if (lets) {
			fprintf(e->to, "    const double %s = %s;\n", s->c_name, c_expression(s->value));
		}
	}
}

void clear_used(const struct spec *spec)
{
	for (struct symbol *s = spec->first; s; s = s->next)
		s->used = s->slope_used = false;
}

bool uses_time(const struct node *node)
{
	bool found = node->kind == NODE_TIME || (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET && uses_time(node->symbol->value));
	for (int i = 0; i < node->children && !found; i++)
		found = uses_time(node->child[i]);
	return found;
}

static int state_of_node(const struct model *written, const struct node *node)
{
	int coord = node->symbol->index + (node->component ? node->component - 1 : 0);
	return node->primes ? written->system.velocity[coord] : coord;
}

/* Flags the written states that an expression reads. */
void mark_states(const struct model *written, const struct node *node, bool *reads)
{
	if (vanishes(node))
		return;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_COORD && node->primes < node->symbol->highest)
		reads[state_of_node(written, node)] = true;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET)
		mark_states(written, node->symbol->value, reads);
	for (int i = 0; i < node->children; i++)
		mark_states(written, node->child[i], reads);
}

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

/* A load in an output: its factor, or where that changes its place in the table direct[segment][output] */
static const char *direct_term(const struct emitter *e, const struct output *output, int load, int k, int column)
{
	const mpq_t *factor = (const mpq_t *)output->load[load] + k * e->system->segments;
	const char *operand = load_operand(e, load, k);
	if (!changes(factor, e->system->segments))
		return scaled(round_rational(factor[0]), operand);
	const char *text = format("%s_direct[s->segment][%d][%d]", e->name, (int)(output - e->model->output), column);
	return operand ? format("%s * %s", text, operand) : text;
}

/* Factors of the load states in the outputs, where one changes its formula */
static void emit_direct_factors(const struct emitter *e)
{
	const struct linear *system = e->system;
	int columns = load_columns(system);
	bool any = false;
	for (int o = 0; o < e->model->outputs; o++)
		for (int l = 0; l < system->loads; l++)
			for (int k = 0; k < system->load[l].columns; k++)
				any = any || changes((const mpq_t *)e->model->output[o].load[l] + k * system->segments, system->segments);
	if (!any)
		return;
	fprintf(e->to, "\nstatic const double %s_direct[%d][%s_OUTPUTS][%d] = {  /* factors of the load states in each segment of time */\n",
		e->name, system->segments, e->upper, columns);
	for (int s = 0; s < system->segments; s++) {
		fputs("  {\n", e->to);
		for (int o = 0; o < e->model->outputs; o++) {
			const char *row = "";
			for (int l = 0; l < system->loads; l++)
				for (int k = 0; k < system->load[l].columns; k++)
					row = format("%s%s%s", row, *row ? ", " : "", shortest(round_rational(e->model->output[o].load[l][k * system->segments + s])));
			fprintf(e->to, "    {%s},  /* %s */\n", row, e->model->output[o].name);
		}
		fputs("  },\n", e->to);
	}
	fputs("};\n", e->to);
}

static double output_factor(const struct output *output, mpq_srcptr factor)
{
	if (beyond_double(factor))
		error(output->value->start, NULL, "a factor of output '%s' is beyond the range of double", output->name);
	return round_rational(factor);
}

static const char *linear_output(const struct emitter *e, const struct output *output)
{
	const struct linear *system = e->system;
	const char **term = ARRAY(const char *, (size_t)(system->states + load_columns(system) + 2 * system->inputs + 1));
	int terms = 0;
	for (int i = 0; i < system->states; i++)
		if (mpq_sgn(output->state[i]) != 0)
			term[terms++] = scaled(output_factor(output, output->state[i]), e->local[i]);
	for (int l = 0, column = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++, column++)
			if (any_factor(e, output, l, k))
				term[terms++] = direct_term(e, output, l, k, column);
	for (int k = 0; k < 2; k++)
		for (int i = 0; i < system->inputs; i++)
			if (mpq_sgn(output->input[k][i]) != 0)
				term[terms++] = scaled(output_factor(output, output->input[k][i]), format(k ? "s->slope[%d]" : "s->u[%d]", i));
	return terms ? tree(terms, term, 13) : "0.0";
}

struct output_needs {
	bool *reads, *loads, *inputs, time, state;
};

static void mark_inputs(const struct node *node, bool *inputs, int count)
{
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_INPUT)
		inputs[node->symbol->index + node->primes * count] = true;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET)
		mark_inputs(node->symbol->value, inputs, count);
	for (int i = 0; i < node->children; i++)
		mark_inputs(node->child[i], inputs, count);
}

static void mark_output_states(const struct emitter *e, const struct node *value, bool *reads)
{
	const struct model *written = e->model->written;
	bool *seen = ARRAY(bool, (size_t)written->system.states);
	mark_states(written, value, seen);
	for (int i = 0; i < written->system.states; i++)
		if (seen[i])
			reads[e->model->place ? e->model->place[i] : i] = true;
}

static void mark_output(const struct emitter *e, const struct output *output, struct output_needs *needs)
{
	bool math = false;
	if (!output->form && output->value) {
		mark_used(output->value, &math);
		mark_output_states(e, output->value, needs->reads);
		mark_inputs(output->value, needs->inputs, e->system->inputs);
		needs->time = needs->time || uses_time(output->value);
		return;
	}
	for (int i = 0; i < e->system->states; i++)
		needs->reads[i] = needs->reads[i] || mpq_sgn(output->state[i]) != 0;
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns; k++)
			needs->loads[l] = needs->loads[l] || any_factor(e, output, l, k);
	for (int i = 0; i < 2 * e->system->inputs; i++)
		needs->state = needs->state || mpq_sgn(output->input[i / e->system->inputs][i % e->system->inputs]) != 0;
}

static void emit_input_locals(const struct emitter *e, const bool *wanted)
{
	for (const struct symbol *s = e->model->spec->first; s; s = s->next)
		for (int k = 0; k < 2 && s->kind == SYMBOL_INPUT; k++)
			if (wanted[s->index + k * e->system->inputs])
				fprintf(e->to, "    const double %s = s->%s[%d];\n", k ? s->c_dot : s->c_name, k ? "slope" : "u", s->index);
}

void emit_out(const struct emitter *e)
{
	FILE *to = e->to;
	const struct model *model = e->model;
	if (model->declared_outputs)
		emit_direct_factors(e);
	fprintf(to, "\nvoid %s_out(const %s *s, double out[%s_OUTPUTS])\n{\n", e->name, e->name, e->upper);
	if (!model->declared_outputs) {
		fprintf(to, "    %s_get(s, out);\n}\n", e->name);
		return;
	}
	struct output_needs needs = { ARRAY(bool, (size_t)e->system->states), ARRAY(bool, (size_t)e->system->loads),
				      ARRAY(bool, 2 * (size_t)e->system->inputs), false, false };
	clear_used(model->spec);
	for (int i = 0; i < model->outputs; i++)
		mark_output(e, &model->output[i], &needs);
	emit_locals(e, needs.reads);
	emit_input_locals(e, needs.inputs);
	if (needs.time)
		fprintf(to, "    const double t = %s_time(s);\n", e->name);
	emit_used_constants(e, true);
	emit_load_states(e, needs.loads, needs.time);
	for (int i = 0; i < model->outputs; i++) {
		const struct output *output = &model->output[i];
		bool linear = output->form || !output->value;
		fprintf(to, "    out[%d] = %s;  /* %s */\n", i, linear ? linear_output(e, output) : c_expression(output->value), output->name);
	}
	fputs("    (void)s;\n}\n", to);
}
