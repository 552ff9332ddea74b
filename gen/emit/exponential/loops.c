/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step with a remainder that loops over its tables: the tables, and products with them. */
#include "inner.h"
#include "emit/steps.h"

/* ---- tables ---- */

/* Columns of the loads that act, in the order of a table */
static int acting_columns(const struct emitter *e, int **column)
{
	int count = 0, all = e->step->branch->full->columns;
	*column = ARRAY(int, (size_t)all + 1);
	for (int k = 0; k < all; k++)
		if (e->step->program->uses[k])
			(*column)[count++] = k;
	return count;
}

struct picked {                     /* a matrix of a table, or of the slopes */
	enum { PICK_PHI, PICK_LOAD, PICK_INPUT, PICK_PHI_WEIGHT, PICK_SLOPE, PICK_FORCE } kind;
	int table, index;           /* of a phi-function weight: which */
	int columns;
	const int *column;          /* of the loads: those that act */
	const struct slopes *slopes; /* per operator */
};

static double picked_entry(const struct picked *p, const struct emitter *e, int operator, int segment, int i, int j)
{
	const struct table *table = e->step->branch[operator].table[p->table];
	switch (p->kind) {
	case PICK_PHI:    return table->Phi[i * table->states + j].value;
	case PICK_LOAD:   return table->load[(segment * table->states + i) * table->columns + p->column[j]].value;
	case PICK_INPUT:  return table->input[i * table->inputs + j].value;
	case PICK_PHI_WEIGHT: return table->phi_weight[p->index][i * table->force_columns + j].value;
	case PICK_SLOPE:  return p->slopes[operator].A[i * p->columns + j].value;
	default:          return p->slopes[operator].B[i * p->columns + j].value;
	}
}

/* NAME_name[of segments of time, then of operators][row][column] */
static void emit_table(const struct emitter *e, const char *name, const char *note, int first, struct picked picked)
{
	const int segments = picked.kind == PICK_LOAD ? e->system->segments : 1, rows = e->system->states;
	const int size[] = { segments * (e->model->schedule.operators - first), rows, picked.columns };
	double *value = ARRAY(double, (size_t)(size[0] * rows * picked.columns)), *to = value;
	for (int s = 0; s < segments; s++)
		for (int k = first; k < e->model->schedule.operators; k++)
			for (int i = 0; i < rows * picked.columns; i++)
				*to++ = picked_entry(&picked, e, k, s, i / picked.columns, i % picked.columns);
	emit_array(e, note, name, 3, size, value, e->model->names.state);
}

static void emit_phi_table(const struct emitter *e, int t)
{
	const struct wanted *wanted = &e->step->branch->full->wanted[t];
	struct picked Phi = { .kind = PICK_PHI, .table = t, .columns = e->system->states };
	if (t > 0)
		emit_table(e, wanted->name, format("e^{A tau}, tau = %s h", exact_text(wanted->fraction)), 0, Phi);
	else if (many_operators(e))
		emit_table(e, wanted->name, "e^{A h} of the operators after the first", 1, Phi);
}

static void emit_tables_of(const struct emitter *e, int t)
{
	const struct wanted *wanted = &e->step->branch->full->wanted[t];
	int *column, columns = acting_columns(e, &column), inputs = e->step->branch->full->inputs;
	struct picked load = { .kind = PICK_LOAD, .table = t, .columns = columns, .column = column };
	struct picked input = { .kind = PICK_INPUT, .table = t, .columns = inputs };
	if (wanted->Phi)
		emit_phi_table(e, t);
	if (columns)
		emit_table(e, format("%s_load", wanted->name), "what the load states add", 0, load);
	if (inputs)
		emit_table(e, format("%s_input", wanted->name), "what the inputs add", 0, input);
	for (int k = 0; k < wanted->phi_weights; k++) {
		struct picked phi_weight = {
			.kind = PICK_PHI_WEIGHT, .table = t, .index = k, .columns = e->model->remainder.force_columns
		};
		emit_table(e, wanted->phi_weight[k].name, "what remainders add", 0, phi_weight);
	}
}

void emit_loop_tables(const struct emitter *e)
{
	for (int t = 0; t < e->step->tables; t++)
		emit_tables_of(e, t);
	if (!e->step->program->predicts)
		return;
	struct slopes *slopes = ARRAY(struct slopes, (size_t)e->model->schedule.operators);
	for (int k = 0; k < e->model->schedule.operators; k++)
		slopes[k] = state_slopes(e->step, k);
	struct picked A = { .kind = PICK_SLOPE, .columns = e->system->states, .slopes = slopes };
	struct picked B = { .kind = PICK_FORCE, .columns = e->model->remainder.force_columns, .slopes = slopes };
	emit_table(e, "A", "y' = A y + B r", 0, A);
	emit_table(e, "B", "the force of each remainder", 0, B);
}

/* ---- the matrix of the operator that serves now ---- */

static const char *operator_index(const struct emitter *e)
{
	return many_operators(e) ? "which" : "0";
}

const char *matrix_text(const struct emitter *e, const char *name)
{
	return format("%s_%s[%s][0]", e->name, name, operator_index(e));
}

static const char *phi_text(const struct emitter *e, int t)
{
	if (t > 0)
		return matrix_text(e, e->step->branch->full->wanted[t].name);
	const char *first = format("%s[0]", stepped_table(e));
	return many_operators(e) ? format("which ? %s_full[which - 1][0] : %s", e->name, first) : first;
}

static const char *load_text(const struct emitter *e, int t)
{
	const char *name = format("%s_%s_load", e->name, e->step->branch->full->wanted[t].name);
	if (!loads_change(e->system))
		return format("%s[%s][0]", name, operator_index(e));
	if (many_operators(e))
		return format("%s[%d * s->segment + which][0]", name, e->model->schedule.operators);
	return format("%s[s->segment][0]", name);
}

/* ---- products ---- */

/* load, input: what the tables' columns multiply */
void emit_operands(const struct emitter *e)
{
	int *column, columns = acting_columns(e, &column), inputs = e->step->branch->full->inputs;
	const char **text = ARRAY(const char *, (size_t)(columns + inputs) + 1);
	for (int k = 0; k < columns; k++)
		text[k] = column_operand(e, column[k]);
	for (int k = 0; k < inputs; k++)
		text[columns + k] = input_operand(e, k);
	if (columns)
		say_vector(e, "load", columns, text);
	if (inputs)
		say_vector(e, "input", inputs, text + columns);
}

void emit_flow_loop(const struct emitter *e, int t, bool from_rest, const char *target, const char *margin)
{
	const struct table *table = e->step->branch[0].table[t];
	int *column, columns = acting_columns(e, &column);
	const char *function = "pl_multiply";
	if (table->Phi && !from_rest) {
		say(e, "%spl_multiply($N_STATES, $N_STATES, %s, s->y, %s);\n", margin, phi_text(e, t), target);
		function = "pl_multiply_add";
	}
	if (columns) {
		say(e, "%s%s($N_STATES, %d, %s, load, %s);\n", margin, function, columns, load_text(e, t), target);
		function = "pl_multiply_add";
	}
	if (table->inputs) {
		const char *input = matrix_text(e, format("%s_input", table->wanted->name));
		say(e, "%s%s($N_STATES, %d, %s, input, %s);\n", margin, function, table->inputs, input, target);
	}
}

void emit_sum_loop(const struct emitter *e, const struct action *a)
{
	struct table *const *table = e->step->branch[0].table;
	const char *target = vector_name(a->target);
	if (a->flow != NONE && !flows_apart(e))
		emit_flow_loop(e, a->flow, false, target, "    ");
	else
		say(e, "    for (i = 0; i < $N_STATES; i++) { %s[i] = %s; }\n", target,
		    a->flow != NONE ? format("flow%d[i]", a->flow) : format("stage%d[i]", a->plain));
	for (int k = 0; k < a->phi_weights; k++) {
		const struct phi_weight *phi_weight =
			&table[a->phi_weight[k].table]->wanted->phi_weight[a->phi_weight[k].phi_weight];
		say(e, "    pl_multiply_add($N_STATES, %d, %s, remainder%d, %s);\n", e->model->remainder.force_columns,
		    matrix_text(e, phi_weight->name), a->phi_weight[k].left, target);
	}
	if (a->target == STAGE_STATE)
		say(e, "    for (i = 0; i < $N_STATES; i++) { s->y[i] = next[i]; }\n");
}

const char *vector_name(int stage)
{
	return stage == STAGE_STATE ? "next" : format("stage%d", stage);
}

bool flows_apart(const struct emitter *e)
{
	return loads_change(e->system) && !e->step->event_split;
}
