/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_run in blocks: the outputs after 1, 2, ... K steps, all from what stands at the start of the block, so that no
 * row waits for the one before it and a compiler takes several at a time. A number of row l is C Phi^l y + its share of
 * the load states + that of the samples so far, every factor rounded once from its closed form at l h. What goes on to
 * the next block is a step of K h, in the form of the model's own step. */
#include "inner.h"
#include "rows.h"

#include <math.h>

enum {
	TABLE_NUMBERS = 3072,       /* of a block: they stay in the nearest cache */
	LANES = 4,                  /* numbers that a compiler may take at a time */
	FEWEST = 4                  /* rows that are worth a block */
};

int held_columns(const struct linear *system)
{
	int columns = 0;
	for (int i = 0; i < system->inputs; i++)
		columns += system->input[i].hold == 1;
	return columns;
}

/* ---- numbers ---- */

/* What a column or a sample gives an output: at most three responses from rest, each from its own start. */
enum { RESPONSES = 3 };
struct share {
	int count;
	struct started list[RESPONSES];
};

static void add_started(struct share *share, struct response *response, long k, mpq_srcptr h)
{
	struct started *started = &share->list[share->count++];
	started->response = response;
	mpq_init(started->start);
	mpq_set_si(started->start, k, 1);
	mpq_mul(started->start, started->start, h);
}

/* u = (value + slope tau/h), slope in units of the sample */
static void add_input(struct share *share, const struct step *step, const struct output *output, int input, long start,
		      long value, long slope)
{
	mpq_srcptr h = step->model->h;
	RATIONAL u = RATIO(value, 1), rate = RATIO(slope, 1);
	mpq_div(rate, rate, h);
	add_started(share, output_of_input(step->branch->resolvent, &step->branch->system, output, input, u, rate),
		    start, h);
}

/* A held sample lasts for its step; of ramps it is the top of a triangle over the step before it and the one after. */
static struct share share_of_sample(const struct step *step, const struct output *output, int input)
{
	struct share share = { 0 };
	bool ramp = step->branch->system.input[input].hold;
	add_input(&share, step, output, input, 0, !ramp, ramp);
	add_input(&share, step, output, input, 1, ramp ? 0 : -1, ramp ? -2 : 0);
	if (ramp)
		add_input(&share, step, output, input, 2, 0, 1);
	return share;
}

/* The ramp down from the sample before the block */
static struct share share_of_sample_before(const struct step *step, const struct output *output, int input)
{
	struct share share = { 0 };
	add_input(&share, step, output, input, 0, 1, -1);
	add_input(&share, step, output, input, 1, 0, 1);
	return share;
}

/* Kicks and drifts have momenta for velocities. */
static struct share share_of_state(const struct step *step, const struct output *output, int state)
{
	const struct linear *system = &step->branch->system;
	struct share share = { 0 };
	mpq_t *initial = rationals(system->states);
	mpq_set_ui(initial[state], 1, 1);
	if (step->linear.kicks.momenta && state >= system->n)
		mpq_inv(initial[state], step->linear.kicks.mass[system->coord[state]]);
	add_started(&share, output_of_states(step->branch->resolvent, output, initial), 0, step->model->h);
	return share;
}

/* Of a load that the step leaves out, the forced part starts with it. */
static struct share share_of_load(const struct step *step, const struct output *output, int column)
{
	const struct linear *system = &step->branch->system;
	struct share share = { 0 };
	int first, columns = load_columns(system), l = load_of_column(system, column, &first);
	mpq_t *initial = is_forced(step, column) ? rationals(system->states) : NULL;
	for (int i = 0; i < system->states && initial; i++)
		mpq_set(initial[i], step->forced->exact[i * columns + column]);
	add_started(&share, output_of_load(step->branch->resolvent, system, output, l, column - first, initial),
		    0, step->model->h);
	return share;
}

/* After `steps` steps, of what has started before that: what starts at that very time shows later. A number that is not
 * finite leaves the statement. */
static struct coefficient value_of(const struct step *step, const struct share *share, int steps, bool two_words)
{
	struct place at = step->model->request.at.step;
	struct coefficient c;
	int count = share->count < steps ? share->count : steps;
	RATIONAL t = RATIO(steps, 1);
	mpq_mul(t, t, step->model->h);
	c = started_value(count, share->list, t, two_words, at, "a number of a row");
	if (!isfinite(c.value))
		report_range(step);
	return c;
}

/* Near the least number of the type a product takes many times as long, and no sum would show it. */
static double number_of(const struct step *step, const struct share *share, int steps)
{
	const double least = step->model->request.single ? 0x1p-110 : 0x1p-960;
	double value = value_of(step, share, steps, false).value;
	return fabs(value) < least ? 0 : value;
}

/* ---- the tables of a block ---- */

typedef struct share share_maker(const struct step *step, const struct output *output, int index);
struct requested {                  /* a column to be, or a sample */
	struct operand operand;
	struct share *share;        /* per output */
	double *value;              /* [row][output] */
};
struct asking {
	const struct step *step;
	const struct rows *rows;
	int count;
	struct requested *requested;
};

static void ask(struct asking *a, enum operand_kind kind, int index, share_maker *share_of, int source)
{
	int outputs = a->rows->outputs;
	struct requested *requested = &a->requested[a->count++];
	*requested = (struct requested){ { kind, index }, ARRAY(struct share, outputs),
				 ARRAY(double, (size_t)(a->rows->count * outputs)) };
	for (int o = 0; o < outputs; o++)
		requested->share[o] = share_of(a->step, &a->step->model->output[o], source);
}

/* Row by row: what poles give at one time serves every column. */
static void evaluate_all(const struct asking *a)
{
	int outputs = a->rows->outputs;
	for (int l = 0; l < a->rows->count; l++)
		for (int k = 0; k < a->count; k++)
			for (int o = 0; o < outputs; o++)
				a->requested[k].value[l * outputs + o] =
					number_of(a->step, &a->requested[k].share[o], l + 1);
}

static void keep_column(struct rows *rows, const struct requested *requested)
{
	bool any = false;
	for (int i = 0; i < rows->count * rows->outputs; i++)
		any = any || requested->value[i] != 0;
	if (any)
		rows->column[rows->columns++] = (struct row_column){ requested->operand, requested->value };
}

static void fill_columns(const struct step *step, struct rows *rows)
{
	const struct linear *system = &step->branch->system;
	int loads = load_columns(system), held = held_columns(system), columns = system->states + loads + held;
	struct asking a = { step, rows, 0, ARRAY(struct requested, (size_t)(columns + system->inputs)) };
	for (int j = 0; j < system->states; j++)
		ask(&a, OPERAND_STATE, j, share_of_state, j);
	for (int k = 0; k < loads; k++)
		ask(&a, OPERAND_LOAD, k, share_of_load, k);
	for (int i = 0, column = 0; i < system->inputs; i++)
		if (system->input[i].hold)
			ask(&a, OPERAND_INPUT, column++, share_of_sample_before, i);
	for (int i = 0; i < system->inputs; i++)
		ask(&a, OPERAND_INPUT, held + i, share_of_sample, i);
	evaluate_all(&a);
	rows->column = ARRAY(struct row_column, columns + 1);
	for (int k = 0; k < columns; k++)
		keep_column(rows, &a.requested[k]);
	rows->sample = ARRAY(double *, system->inputs);
	for (int i = 0; i < system->inputs; i++)
		rows->sample[i] = a.requested[columns + i].value;
}

/* ---- the step of K h ---- */

/* What the samples give the states at the block's end */
static void fill_inputs(const struct step *step, int count, struct table *table)
{
	const struct linear *system = &step->branch->system;
	int held = held_columns(system), columns = table->inputs = held + count * system->inputs;
	table->input = ARRAY(struct coefficient, (size_t)(table->states * columns));
	for (int i = 0; i < table->states; i++) {
		struct output state = state_as_output(system, i);
		struct coefficient *row = table->input + i * columns;
		for (int j = 0, column = 0; j < system->inputs; j++) {
			struct share sample = share_of_sample(step, &state, j);
			for (int k = 0; k < count; k++)
				row[held + k * system->inputs + j] = value_of(step, &sample, count - k, true);
			if (!system->input[j].hold)
				continue;
			struct share before = share_of_sample_before(step, &state, j);
			row[column++] = value_of(step, &before, count, true);
		}
	}
	for (int k = 0; k < table->states * columns; k++)
		table->input[k].zero = table->input[k].value == 0;
}

static struct step *block_of(const struct step *step, int count)
{
	struct step *block = NEW(struct step);
	struct wanted *wanted = NEW(struct wanted);
	struct linear *system = NEW(struct linear);
	*wanted = (struct wanted){ .Phi = true, .two_words = step->program->compensated, .name = "block",
				   .increments = step->form == FORM_DELTA, .mass = step->linear.kicks.mass };
	mpq_init(wanted->fraction);
	mpq_set_si(wanted->fraction, count, 1);
	*system = step->branch->system;
	system->inputs = 0;
	*block = *step;
	block->refresh = NULL;          /* a refresh stands where a block starts */
	block->branch = NEW(struct branch);
	*block->branch = *step->branch;
	block->branch->full = tables_of(step->model, step->branch->resolvent, system, 1, wanted)[0];
	fill_inputs(step, count, block->branch->full);
	block->program = linear_program(block);
	return block;
}

/* ---- how many rows ---- */

/* Of a step and its outputs, row by row; and a number at a time of a block, with this many rows */
static bool is_worth_it(const struct step *step, const struct rows *rows)
{
	const struct linear *system = &step->branch->system;
	int row = system->states + load_columns(system) + held_columns(system) +
		  system->inputs * (rows->count + rows->group) / 2;
	return row * rows->outputs <= 2 * (step->program->multiplications + 4);
}

/* Rows side by side: as few as fill the lanes */
static int group_of(const struct step *step, int count, int outputs)
{
	int group = 1;
	if (step->branch->system.inputs == 0)
		return count;
	while (group * outputs % LANES)
		group *= 2;
	return count % group ? count : group;
}

/* A sample of an input costs the more the more rows come after it; what loads cost once in a block, the less. */
static int best_rows(const struct step *step)
{
	return step->branch->system.inputs ? 4 : step->program->forcing_multiplications ? 64 : 32;
}

/* Kicks are as S^-1: a step of K h has to be far from where S vanishes. */
static int most_rows(const struct step *step, int most)
{
	const double farthest = 2.5;
	if (step->form != FORM_KICK_DRIFT_KICK || largest_pole_angle(step) * most <= farthest)
		return most;
	return (int)(farthest / largest_pole_angle(step)) / FEWEST * FEWEST;
}

static bool fits(const struct step *step, const struct rows *rows)
{
	const struct linear *system = &step->branch->system;
	int columns = system->states + load_columns(system) + held_columns(system) + system->inputs;
	return columns * rows->count * rows->outputs <= TABLE_NUMBERS;
}

struct attempt {
	struct step *step;
	struct rows *rows;
};

static void make_rows(void *context)
{
	struct attempt *a = context;
	a->rows->block = block_of(a->step, a->rows->count);
	fill_columns(a->step, a->rows);
}

/* false: not with so many */
static bool try_rows(struct step *step, int count)
{
	struct rows *rows = NEW(struct rows);
	*rows = (struct rows){ .count = count, .outputs = step->model->outputs };
	rows->group = group_of(step, count, rows->outputs);
	struct attempt attempt = { step, rows };
	if (!fits(step, rows) || (!step->model->request.rows && !is_worth_it(step, rows)) ||
	    !silent_guard(make_rows, &attempt))
		return false;
	step->rows = rows->block->rows = rows;
	return true;
}

/* They are made with --fast, and in float only where their number is asked for: tables are larger than all the code of
 * a small board's model. */
void plan_rows(struct step *step)
{
	const struct request *requested = &step->model->request;
	if (!wants_rows(requested) ||
	    (!requested->rows && (requested->single || !is_linear_alone(step) || step->is.tuned)))
		return;
	step->no.rows = step_objection(step, CAN_ROWS);
	if (step->no.rows)
		return;
	int wish = requested->rows ? requested->rows : best_rows(step);
	for (int count = most_rows(step, wish); count >= (requested->rows ? wish : FEWEST) && !step->rows; count /= 2)
		try_rows(step, count);
	if (!step->rows)
		step->no.rows = requested->rows ? format("%d are too many for it", wish)
					    : "they would not be faster, or leave the range";
}

int row_numbers(const struct step *step)
{
	const struct rows *rows = step->rows;
	return rows ? (rows->columns + step->branch->system.inputs) * rows->count * rows->outputs : 0;
}
