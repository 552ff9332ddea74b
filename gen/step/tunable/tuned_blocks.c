/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A linear step with tunable params. Of a large one what params touch is the instance's, and the target computes
 * e^{A h} of these independent blocks alone; the others keep their tables. Any other is one block. */
#include "model/tunable/elsewhere.h"
#include "plrt.h"
#include "step/exponential/recipe.h"
#include "tuned.h"

/* ---- what stands in the code ---- */

double *nominal_outputs(const struct step *step)
{
	const struct model *model = step->model;
	const struct tuning *t = model->params.tuning;
	const struct linear *system = &step->branch->system;
	const int size = t->x.size;
	double *value = ARRAY(double, (size_t)(t->outputs * size));
	mpq_t *row = rationals((size_t)size);
	for (int o = 0; o < model->outputs; o++) {
		if (t->output[o] < 0)
			continue;
		double *to = value + t->output[o] * size;
		row_of_output(&t->x, system, &model->output[o], system->segments, 0, row);
		for (int j = 0; j < size; j++)
			to[j] = equation_number(model, row[j]).value;
	}
	return value;
}

/* ---- what hangs together ---- */

int *tuned_components(const struct step *step)
{
	const struct tuning *t = step->model->params.tuning;
	const int states = step->branch->system.states;
	if (!t)
		return NULL;
	int *parent = numbers_up_to(states), *number = ARRAY(int, (size_t)states);
	for (const struct tuned_entry *entry = t->system->entry; entry < t->system->entry + t->system->entries; entry++)
		if (entry->row < states && entry->column < states)
			join_nodes(parent, entry->row, entry->column);
	for (int i = 0; i < states; i++)
		number[i] = root_of_node(parent, i);
	return number;
}

/* Per column of x: of a load whose frequency changes, in each segment of time */
static bool *rotating_columns(const struct step *step)
{
	const struct tuning *t = step->model->params.tuning;
	bool *rotating = ARRAY(bool, (size_t)t->x.size);
	for (int l = 0; l < step->branch->system.loads; l++)
		for (int k = 0; k < step->branch->system.load[l].columns && t->frequency[l]; k++)
			for (int s = 0; s < t->x.segments; s++)
				rotating[t->x.load[l] + s * t->x.loads + k] = true;
	return rotating;
}

bool *touched_states(const struct step *step)
{
	const struct tuning *t = step->model->params.tuning;
	const int states = step->branch->system.states, *number = tuned_components(step);
	if (!t)
		return NULL;
	bool *root = ARRAY(bool, (size_t)states), *touched = ARRAY(bool, (size_t)states);
	const bool *rotating = rotating_columns(step);
	for (const struct tuned_entry *entry = t->system->entry; entry < t->system->entry + t->system->entries; entry++)
		if (entry->row < states && (entry->params != 0 || rotating[entry->column]))
			root[number[entry->row]] = true;
	for (int i = 0; i < states; i++)
		touched[i] = root[number[i]];
	return touched;
}

/* ---- a block ---- */

static int *nowhere(int count)
{
	int *place = ARRAY(int, (size_t)count);
	for (int i = 0; i < count; i++)
		place[i] = -1;
	return place;
}

/* Its x, and where that of the whole stands in it */
static int *take_x(struct tuned_block *b, const struct step *step)
{
	const struct group *g = b->group;
	const struct table *table = step->branch->full;
	int *place = nowhere(step->layout.size);
	b->from = ARRAY(int, (size_t)(g->states + g->loads + g->inputs));
	for (int i = 0; i < g->states; i++)
		b->from[b->size++] = g->state[i * g->blocks + b->block];
	for (int k = 0; k < g->loads; k++)
		b->from[b->size++] = table->states + g->load[k];
	for (int k = 0; k < g->inputs; k++)
		b->from[b->size++] = table->states + table->columns + g->input[k];
	for (int i = 0; i < b->size; i++)
		place[b->from[i]] = i;
	return place;
}

/* Of an entry of x of struct tuning the segment of time, and its place where there are loads of one alone */
static int place_in_segment(const struct step *step, int column, int *segment)
{
	const struct layout *x = &step->model->params.tuning->x;
	const int load = column - step->branch->system.states;
	*segment = load < 0 || x->loads == 0 ? 0 : load < x->segments * x->loads ? load / x->loads : x->segments - 1;
	return column - *segment * x->loads;
}

static void take_entry(struct tuned_equations *all, const struct tuned_entry *entry, int row, int column)
{
	struct tuned_entry *own = MORE(all->entry, all->entries);
	*own = *entry;
	own->row = row;
	own->column = column;
}

/* Loads of further segments of time go on as those of the first, of which there are rows. place: per x of the whole,
 * that in the block's */
static void take_entries(struct tuned_block *b, const struct step *step, const int *place)
{
	const struct tuning *t = step->model->params.tuning;
	const int states = step->branch->system.states, loads = states + t->x.segments * t->x.loads;
	int segment, of_row;
	for (int i = 0; i < t->system->entries; i++) {
		const struct tuned_entry *entry = &t->system->entry[i];
		const int row = place[place_in_segment(step, entry->row, &of_row)];
		const int column = place[place_in_segment(step, entry->column, &segment)];
		if (row < 0 || (entry->row >= states && entry->row < loads && of_row > 0))
			continue;
		if (column < 0 && entry->row < states)
			internal_error(step, "an entry of tunable params leaves its independent block");
		if (column < 0)
			continue;
		take_entry(&b->A, entry, row, column + segment * b->group->loads);
		b->params |= entry->params;
	}
}

static struct tuned_block block_of(const struct step *step, const struct group *group, int index, int block)
{
	struct tuned_block b = { .group = group, .index = index, .block = block };
	const int *place = take_x(&b, step);
	b.A.rows = b.size;
	b.A.columns = b.size + (step->branch->system.segments - 1) * group->loads;
	take_entries(&b, step, place);
	return b;
}

/* ---- what belongs to no block ---- */

static void plan_others(struct tuned_blocks *p, const struct step *step)
{
	const struct tuning *t = step->model->params.tuning;
	p->frequency = nowhere(step->branch->system.loads);
	p->others = (struct tuned_equations){ .rows = t->outputs, .columns = t->x.size };
	for (const struct tuned_entry *entry = t->all.entry; entry < t->all.entry + t->all.entries; entry++)
		take_entry(&p->others, entry, entry->row, entry->column);
	for (int l = 0; l < step->branch->system.loads; l++) {
		if (!t->frequency[l])
			continue;
		const struct tuned_entry entry = tuned_frequency(t, l);
		p->frequency[l] = p->others.rows * p->others.columns;
		take_entry(&p->others, &entry, p->others.rows++, 0);
	}
	const struct tuned_equations *list[] = { &p->others, &p->block[0].A };
	p->operations = operations_behind(t, p->solved ? 2 : 1, list);
}

/* ---- the whole ---- */

static void larger_of(int *most, int count)
{
	*most = count > *most ? count : *most;
}

static void measure_block(struct tuned_blocks *p, const struct step *step, const struct tuned_block *b)
{
	const struct tuning *t = step->model->params.tuning;
	const struct tuned_equations *list[] = { &b->A, &t->all };
	const int made = operations_behind(t, p->solved ? 2 : 1, list), square = b->size * b->size;
	const int increments = step->branch->system.segments * b->group->states * b->size;
	larger_of(&p->more, made + 2 * square + PL_INCREMENT_WORK(b->size));
	if (b->group->tuned)
		larger_of(&p->work, increments + (p->solved ? 0 : made) + square + PL_INCREMENT_WORK(b->size));
}

static void check_size(const struct step *step, const struct tuned_block *b)
{
	const struct tuning *t = step->model->params.tuning;
	const bool changes = loads_change(&step->branch->system);
	int k = 0;
	while (b->group->tuned && k < t->given - 1 && !(b->params >> k & 1))
		k++;
	if (b->size > LIMIT_TUNED_BLOCK && (b->group->tuned || changes))
		error(t->param[k].at,
		      format("e^{A h} of a block is computed on the stack, up to a size of %d: some 600 KB",
			     LIMIT_TUNED_BLOCK),
		      b->group->tuned ? "'%s' is tunable and touches an independent block of %d states, load states "
					"and inputs"
				      : "'%s' is tunable, loads change their formula, and there is an independent "
					"block of %d states, load states and inputs",
		      t->param[k].symbol->name, b->size);
}

/* Numbers that an instance has of a group: those that hold no place for nothing */
static int numbers_of(const struct step *step, const struct group *g)
{
	int columns = g->states + step->branch->system.segments * g->loads + g->inputs;
	return g->tuned ? g->blocks * g->states * columns : 0;
}

static struct group *group_of_full(const struct step *step)
{
	const struct table *table = step->branch->full;
	struct group *g = NEW(struct group);
	*g = (struct group){ GROUP_ROWS, table->states, 1, numbers_up_to(table->states), table->columns,
			     numbers_up_to(table->columns), table->inputs, numbers_up_to(table->inputs), true };
	return g;
}

void plan_tuned_blocks(struct step *step)
{
	const struct program *program = step->program;
	struct tuned_blocks *p = NEW(struct tuned_blocks);
	const int real = step->model->request.single ? 4 : 8;
	const struct group *group = program->loops ? program->group : group_of_full(step);
	int numbers = 0, most = 0, stack;
	p->full = true;
	p->solved = !program->loops;
	for (int k = 0; k < (p->solved ? 1 : program->groups); k++) {
		p->full = p->full && group[k].tuned;
		numbers += numbers_of(step, &group[k]);
		p->touched += group[k].tuned ? group[k].blocks : 0;
		for (int b = 0; b < group[k].blocks; b++) {
			struct tuned_block *block = MORE(p->block, p->all);
			*block = block_of(step, &group[k], k, b);
			check_size(step, block);
			larger_of(&most, block->size);
			measure_block(p, step, block);
		}
	}
	plan_others(p, step);
	larger_of(&p->work, 1);
	stack = p->others.rows * p->others.columns + p->operations + p->work;
	larger_of(&stack, p->more);
	p->kilobytes = 1 + real * (numbers + 2 * stack) / 1024;
	step->series.emitted = most <= LIMIT_TUNED_BLOCK;
	for (int b = 0; b < p->all; b++)
		if (step->series.emitted || p->block[b].group->tuned)
			p->block[p->blocks++] = p->block[b];
	step->blocks = p;
}
