/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_run: what run.h is given; tables and functions of the blocks of rows that it takes at once. */
#include "declarations.h"
#include "emit/series/series.h"
#include "steps.h"
#include "step/linear/forms.h"
#include "step/linear/rows.h"

#include <string.h>

/* ---- the tables of a block ---- */

static const char *operand_name(const struct emitter *e, const struct operand *operand)
{
	const struct linear *system = e->system;
	int column = operand->index, l = 0;
	if (operand->kind == OPERAND_STATE)
		return e->model->names.state[column];
	if (operand->kind == OPERAND_LOAD)
		return text_of_column(system, column);
	for (; !system->input[l].hold || column-- > 0;)
		l++;
	return format("%s before the block", system->input[l].name);
}

/* Zeros before the first number of a sample: the rows before it in its group */
static int zeros_of(const struct rows *rows)
{
	return (rows->group - 1) * rows->outputs;
}

static void emit_row_tables(const struct emitter *e)
{
	const struct rows *rows = e->step->rows;
	const int numbers = rows->count * rows->outputs, inputs = e->system->inputs, zeros = zeros_of(rows);
	double *row = ARRAY(double, (size_t)(rows->columns * numbers));
	double *sample = ARRAY(double, (size_t)(inputs * (numbers + zeros)));
	const char **note = ARRAY(const char *, (size_t)rows->columns + 1);
	for (int k = 0; k < rows->columns; k++) {
		memcpy(row + k * numbers, rows->column[k].value, (size_t)numbers * sizeof *row);
		note[k] = operand_name(e, &rows->column[k].operand);
	}
	for (int i = 0; i < inputs; i++)
		memcpy(sample + i * (numbers + zeros) + zeros, rows->sample[i], (size_t)numbers * sizeof *sample);
	say(e, "\nenum { $N_ROWS = %d };  /* in a block of $n_run */\n", rows->count);
	if (rows->columns)
		emit_array(e, format("The outputs after 1, 2, ... %d steps, from what there is at the start of a block",
				     rows->count), "row", 2, (const int[]){ rows->columns, numbers }, row, note);
	if (inputs)
		emit_array(e, "And from each sample, at the end of its step, after one more, ...; before that nothing",
			   "sample_row", 2, (const int[]){ inputs, numbers + zeros }, sample, names_of_inputs(e));
}

/* ---- its numbers ---- */

/* The rows of a group, from `first` on: what stands at the block's start, and the samples up to its last row */
static const char *group_text(const struct emitter *e, int first)
{
	const struct rows *rows = e->step->rows;
	int inputs = e->system->inputs, last = first + rows->group;
	struct summands s = { 0 };
	const char *at = first ? format("cell + %d", first * rows->outputs) : "cell";
	for (int k = 0; k < rows->columns; k++)
		add_summand(&s, format("%s_row[%d][%s] * start[%d]", e->name, k, at, k));
	for (int j = 0; j < last && inputs; j++)
		for (int i = 0; i < inputs; i++) {
			int shift = (first - j) * rows->outputs + zeros_of(rows);
			const char *place = shift ? format("cell + %d", shift) : "cell";
			add_summand(&s, format("%s_sample_row[%d][%s] * u[%d]", e->name, i, place, j * inputs + i));
		}
	return sum_of(&s, 21);
}

/* A function of its own: out is nothing else's there, so that several numbers are computed at a time. */
static void emit_rows(const struct emitter *e)
{
	const struct rows *rows = e->step->rows;
	int samples = rows->count * e->system->inputs;
	say(e, "\n/* The outputs of a block from what there is at its start%s */\n"
	       "static void $n_rows(const double start[%d]%s, double *PL_RESTRICT out)\n"
	       "{\n"
	       "    int cell;\n", samples ? " and its samples" : "", rows->columns ? rows->columns : 1,
	    samples ? format(", const double u[%d]", samples) : "");
	for (int first = 0; first < rows->count; first += rows->group)
		say(e, "    PL_ROLLED\n"
		       "    for (cell = 0; cell < %d; cell++) { out[cell%s] = %s; }\n",
		    rows->group * rows->outputs, first ? format(" + %d", first * rows->outputs) : "",
		    group_text(e, first));
	close_function(e, rows->columns ? "" : "start");
}

/* ---- a block ---- */

/* Per column of the step of a block */
static const char **sample_names(const struct emitter *e)
{
	const struct linear *system = e->system;
	int held = held_columns(system), count = e->step->rows->count * system->inputs;
	const char **name = ARRAY(const char *, (size_t)(held + count) + 1);
	for (int i = 0, column = 0; i < system->inputs; i++)
		if (system->input[i].hold)
			name[column++] = format("before%d", i + 1);
	for (int k = 0; k < count; k++)
		name[held + k] = format("u[%d]", k);
	return name;
}

/* Does the sample before the block act on a row, or on the state at its end? */
static bool is_read_before(const struct emitter *e, int column)
{
	const struct rows *rows = e->step->rows;
	const struct table *table = e->step->branch->full;
	bool any = false;
	for (int k = 0; k < rows->columns; k++) {
		const struct operand *operand = &rows->column[k].operand;
		any = any || (operand->kind == OPERAND_INPUT && operand->index == column);
	}
	for (int i = 0; i < table->states; i++)
		any = any || !table->input[i * table->inputs + column].zero;
	return any;
}

/* Samples are read before out is written, which may be in their place. */
static void emit_sample_locals(const struct emitter *e)
{
	int count = e->step->rows->count * e->system->inputs;
	const char **text = ARRAY(const char *, (size_t)count + 1);
	for (int k = 0; k < count; k++)
		text[k] = format("samples[%d]", k);
	if (count)
		say_vector(e, "u", count, text);
	for (int i = 0, column = 0; i < e->system->inputs; i++)
		if (e->system->input[i].hold && is_read_before(e, column++))
			say(e, "    const double before%d = s->u[%d];\n", i + 1, i);
}

static const char *row_operand(const struct emitter *e, const struct operand *operand)
{
	const char *text = operand->kind == OPERAND_STATE ? e->local[operand->index] :
			   operand->kind == OPERAND_LOAD ? column_operand(e, operand->index) :
			   e->sample[operand->index];
	return text ? text : "1.0";
}

static void emit_start(const struct emitter *e)
{
	const struct rows *rows = e->step->rows;
	const char **text = ARRAY(const char *, (size_t)rows->columns + 1);
	for (int k = 0; k < rows->columns; k++)
		text[k] = row_operand(e, &rows->column[k].operand);
	text[0] = rows->columns ? text[0] : "0.0";
	say_vector(e, "start", rows->columns ? rows->columns : 1, text);
}

static void mark_operand(const struct emitter *e, const struct operand *operand, bool *reads, bool *loads)
{
	int first;
	if (operand->kind == OPERAND_STATE)
		reads[operand->index] = true;
	else if (operand->kind == OPERAND_LOAD && !is_constant_column(e->system, operand->index))
		loads[load_of_column(e->system, operand->index, &first)] = true;
}

/* e: of the block's step; where loads have refreshes, one stands at the start of a block. */
static void emit_block_locals(const struct emitter *e, const struct emitter *of_step)
{
	const struct rows *rows = e->step->rows;
	const struct program *program = e->step->program;
	bool *reads = ARRAY(bool, (size_t)e->system->states), *loads = ARRAY(bool, (size_t)e->system->loads);
	for (int k = 0; k < rows->columns; k++)
		mark_operand(e, &rows->column[k].operand, reads, loads);
	for (int k = 0; k < e->system->states; k++)
		reads[k] = reads[k] || program->reads[k];
	for (int k = 0; k < load_columns(e->system); k++)
		if (program->uses[k])
			mark_operand(e, &(struct operand){ OPERAND_LOAD, k }, reads, loads);
	emit_raw_locals(e, reads);
	emit_sample_locals(e);
	if (of_step->step->refresh)
		emit_loads_at_refresh(of_step, loads);
	else
		emit_load_states(e, loads, false);
	emit_start(e);
}

/* ---- the step of K h ---- */

/* With samples it is long: a table by columns, so that several states are computed at a time. */
static bool steps_by_table(const struct emitter *e)
{
	const struct program *program = e->step->program;
	return e->system->inputs > 0 && e->system->states % 2 == 0 && !program->in_order && !program->compensated &&
	       e->step->carried.count == 0;
}

struct leap_column {
	const char *operand;        /* NULL: 1 */
	double *value;              /* per state */
};

/* false: it is 0 */
static bool leap_column_of(const struct emitter *e, const struct coefficient *factor, int stride, const char *operand,
			   struct leap_column *column)
{
	bool any = false;
	*column = (struct leap_column){ operand, ARRAY(double, (size_t)e->system->states) };
	for (int i = 0; i < e->system->states; i++) {
		column->value[i] = factor[i * stride].zero ? 0 : factor[i * stride].value;
		any = any || column->value[i] != 0;
	}
	return any;
}

/* Of the state, then of what acts; returns how many */
static int leap_columns_of(const struct emitter *e, struct leap_column *column)
{
	const struct table *table = e->step->branch->full;
	const struct coefficient *square = e->step->form == FORM_DELTA ? table->increment : table->Phi;
	int count = 0, n = table->states;
	for (int j = 0; j < n; j++)
		count += leap_column_of(e, square + j, n, e->local[j], &column[count]);
	for (int k = 0; k < table->columns; k++)
		if (!is_forced(e->step, k))
			count += leap_column_of(e, table->load + k, table->columns, column_operand(e, k),
						&column[count]);
	for (int k = 0; k < table->inputs; k++)
		count += leap_column_of(e, table->input + k, table->inputs, e->sample[k], &column[count]);
	return count;
}

static struct leap_column *room_for_leap(const struct emitter *e)
{
	const struct table *table = e->step->branch->full;
	return ARRAY(struct leap_column, (size_t)(table->states + table->columns + table->inputs) + 1);
}

static void emit_leap_table(const struct emitter *e)
{
	struct leap_column *column = room_for_leap(e);
	int count = leap_columns_of(e, column);
	const int size[] = { count, e->system->states };
	double *value = ARRAY(double, (size_t)(size[0] * size[1]));
	const char **note = ARRAY(const char *, (size_t)count + 1);
	for (int k = 0; k < count; k++) {
		memcpy(value + k * size[1], column[k].value, (size_t)size[1] * sizeof *value);
		note[k] = column[k].operand ? column[k].operand : "1";
	}
	emit_array(e, format("What a block adds to the states%s", e->step->form == FORM_DELTA ? "" : ", from 0 on"),
		   "leap", 2, size, value, note);
}

static void emit_leap(const struct emitter *e)
{
	struct leap_column *column = room_for_leap(e);
	int count = leap_columns_of(e, column);
	struct summands s = { 0 };
	for (int k = 0; k < count; k++) {
		const char *operand = column[k].operand;
		add_summand(&s, format("%s_leap[%d][cell]%s", e->name, k, operand ? format(" * %s", operand) : ""));
	}
	say(e, "    PL_ROLLED\n"
	       "    for (cell = 0; cell < $N_STATES; cell++) { s->y[cell] %s %s; }\n",
	    e->step->form == FORM_DELTA ? "+=" : "=", sum_of(&s, 22));
}

static void emit_block_step(const struct emitter *e)
{
	if (steps_by_table(e))
		emit_leap(e);
	else
		emit_formulas(formulas_of_step(e, NULL), 4);
}

/* The step of K h comes before the rows, which do not wait for it: the next block begins as soon as it can. */
static void emit_block(const struct emitter *e)
{
	struct emitter block = *e;
	bool inputs = given_inputs(e) > 0;
	block.step = e->step->rows->block;
	block.sample = sample_names(e);
	emit_rows(e);
	if (steps_by_table(&block))
		emit_leap_table(&block);
	open_function(e, spell(e, "$N_ROWS steps as one, and the outputs after each unless out is NULL"),
		      "static void $n_block($n *s%s, double *out)", inputs ? ", const double *samples" : "");
	if (steps_by_table(&block))
		say(e, "    int cell;\n");
	emit_block_locals(&block, e);
	emit_block_step(&block);
	if (inputs)
		emit_keep_inputs(e, e->step->rows->count);
	if (!e->step->refresh)
		emit_load_advance(e, spell(e, "$N_ROWS"));
	say(e, "    s->k += $N_ROWS;\n");
	if (e->step->refresh)
		say(e, "    s->since = $N_ROWS;\n"
		       "    $n_refresh_phasors(s);\n");
	say(e, "    if (out != NULL) { $n_rows(start, %sout); }\n", inputs ? "u, " : "");
	close_function(e, "");
}

void emit_run(const struct emitter *e)
{
	const struct rows *rows = e->step->rows;
	const bool over = runs_in_blocks(e);
	if (rows) {
		emit_row_tables(e);
		emit_block(e);
	}
	emit_over_block(e);
	emit_sizes(e, "run.h", { "STATES", e->system->states }, { "INPUTS", given_inputs(e) },
		   { "OUTPUTS", e->model->outputs },
		   { "INSIDE", serves_rows(e) && !has_peaks(e) },
		   { "ROWS", rows ? rows->count : over ? e->model->truncation.over : 0 },
		   { "OVER", over }, { "REFRESHED", e->step->refresh != NULL },
		   { "FLUSHES", rows && e->step->linear.flush });
	say(e, "#include \"run.h\"\n");
}
