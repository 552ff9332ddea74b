/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A linear step with tunable params. Of a large one what params touch is the instance's, and the target computes
 * e^{A h} of these independent blocks alone; the others keep their tables. Any other is one block. */
#include "model/tunable/elsewhere.h"
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
		double *to = value + (t->output[o] - model->n) * size;
		row_of_output(&t->x, system, &model->output[o], system->segments, 0, row);
		for (int j = 0; j < size; j++)
			to[j] = equation_number(model, row[j]).value;
	}
	return value;
}

int fixed_slopes(const struct step *step, struct fixed_slope **list)
{
	const struct linear *system = &step->branch->system;
	const struct model *other = step->model->params.tuning ? step->model->params.tuning->other : NULL;
	int size = step->layout.size, count = 0;
	RATIONALS *A = augmented_matrix(&step->layout, system, 0);
	RATIONALS *there = augmented_matrix(&step->layout, other ? &other->system : system, 0);
	*list = ARRAY(struct fixed_slope, (size_t)(size * size));
	for (int i = 0; i < size; i++)
		for (int j = 0; j < size; j++) {
			const bool derivative = i < system->states && (i >= system->n || system->velocity[i] < 0);
			mpq_srcptr entry = A[i * size + j];
			if (derivative || mpq_sgn(entry) == 0 || !mpq_equal(entry, there[i * size + j]))
				continue;
			(*list)[count++] = (struct fixed_slope){ i, j, equation_number(step->model, entry) };
		}
	return count;
}

/* ---- what hangs together ---- */

/* Equations 0 .. n-1 and coordinates n .. 2n-1, as parent pointers. Solved, an equation is that of a coordinate. */
static int *components(const struct step *step)
{
	const struct tuning *t = step->model->params.tuning;
	const struct linear *system = &step->branch->system;
	const int n = system->n;
	int *parent = numbers_up_to(2 * n);
	for (int i = 0; i < n && !t->all.solves; i++)
		join_nodes(parent, i, n + i);
	for (const struct tuned_entry *entry = t->all.entry; entry < t->all.entry + t->all.entries; entry++)
		if (entry->row < n && entry->column < system->states)
			join_nodes(parent, entry->row, n + system->coord[entry->column]);
		else if (entry->row < n && entry->column >= t->x.size)
			join_nodes(parent, entry->row, n + entry->column - t->x.size);
	return parent;
}

int *tuned_components(const struct step *step)
{
	const struct linear *system = &step->branch->system;
	if (!step->model->params.tuning)
		return NULL;
	int *parent = components(step), *number = ARRAY(int, (size_t)system->states);
	for (int i = 0; i < system->states; i++)
		number[i] = root_of_node(parent, system->n + system->coord[i]);
	return number;
}

/* In some segment of time, for some values of the params */
static bool load_reaches(const struct step *step, int load, int coord)
{
	const struct tuning *t = step->model->params.tuning;
	const bool *acts = t->acts + coord * t->x.size + t->x.load[load];
	bool any = false;
	for (int s = 0; s < t->x.segments; s++)
		for (int k = 0; k < step->branch->system.load[load].columns; k++)
			any = any || acts[s * t->x.loads + k];
	return any;
}

bool *touched_states(const struct step *step)
{
	const struct tuning *t = step->model->params.tuning;
	const struct linear *system = &step->branch->system;
	const int n = system->n;
	if (!t)
		return NULL;
	int *parent = components(step);
	bool *root = ARRAY(bool, 2 * (size_t)n), *touched = ARRAY(bool, (size_t)system->states);
	for (const struct tuned_entry *entry = t->all.entry; entry < t->all.entry + t->all.entries; entry++)
		if (entry->row < n && entry->params != 0)
			root[root_of_node(parent, entry->row)] = true;
	for (int l = 0; l < system->loads; l++)
		for (int c = 0; c < n; c++)
			if (t->frequency[l] >= 0 && load_reaches(step, l, c))
				root[root_of_node(parent, n + c)] = true;
	for (int i = 0; i < system->states; i++)
		touched[i] = root[root_of_node(parent, n + system->coord[i])];
	return touched;
}

/* ---- some of the equations ---- */

static int *nowhere(int count)
{
	int *place = ARRAY(int, (size_t)count);
	for (int i = 0; i < count; i++)
		place[i] = -1;
	return place;
}

static void add_row(struct tuned_part *part, int row, int unknown)
{
	const int rows = part->all.rows++;
	ENLARGE(part->row, (size_t)rows + 1);
	ENLARGE(part->unknown, (size_t)rows + 1);
	part->row[rows] = row;
	part->unknown[rows] = unknown;
}

/* Equations and coordinates of a component: as many of each, one beside the other */
static void add_component(struct tuned_part *part, const struct step *step, int *parent, int root)
{
	const int n = step->branch->system.n;
	int equation = 0;
	for (int c = 0; c < n; c++) {
		if (root_of_node(parent, n + c) != root)
			continue;
		while (equation < n - 1 && root_of_node(parent, equation) != root)
			equation++;
		add_row(part, equation++, c);
	}
}

/* Where its x has a column of that of struct tuning: loads in each segment of time. NULL: it has all */
static int column_in(const struct step *step, const struct tuned_block *b, const int *place, int column)
{
	const struct layout *x = &step->model->params.tuning->x;
	const int states = step->branch->system.states, load = column - states, loads = x->segments * x->loads;
	if (!b)
		return column;
	if (load < 0)
		return place[column];
	const int segment = load < loads ? load / x->loads : x->segments - 1, at = place[column - segment * x->loads];
	return at < 0 ? at : at + segment * b->group->loads;
}

/* Its entries: those of its rows. place: per x of the whole, that in the block's */
static void take_entries(struct tuned_part *part, const struct step *step, const struct tuned_block *b,
			 const int *place)
{
	const struct tuning *t = step->model->params.tuning;
	struct tuned_equations *all = &part->all;
	int *row = nowhere(t->all.rows), *unknown = nowhere(t->all.rows), left = t->all.rows - t->frequencies;
	for (int i = 0; i < all->rows; i++) {
		row[part->row[i]] = i;
		unknown[part->unknown[i]] = i;
	}
	all->solves = t->all.solves;
	all->columns = b ? b->size + (t->x.segments - 1) * b->group->loads : t->x.size;
	for (const struct tuned_entry *entry = t->all.entry; entry < t->all.entry + t->all.entries; entry++) {
		if (row[entry->row] < 0)
			continue;
		const bool of_w = entry->column >= t->x.size, rate = entry->row >= left;
		const int at = of_w   ? unknown[entry->column - t->x.size]
			       : rate ? 0
				      : column_in(step, b, place, entry->column);
		if (at < 0)
			internal_error(step, "an entry of tunable params leaves its independent block");
		struct tuned_entry *own = MORE(all->entry, all->entries);
		*own = *entry;
		own->row = row[entry->row];
		own->column = of_w ? all->columns + at : at;
		part->params |= entry->params;
	}
	count_operations(t, all);
}

int width_of_equations(const struct tuned_equations *all)
{
	return all->columns + (all->solves ? all->rows : 0);
}

/* ---- a block ---- */

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

static void take_slopes(struct tuned_block *b, const int *place, int count, const struct fixed_slope *all)
{
	b->slope = ARRAY(struct fixed_slope, (size_t)count);
	for (int i = 0; i < count; i++)
		if (place[all[i].row] >= 0 && place[all[i].column] >= 0)
			b->slope[b->slopes++] =
				(struct fixed_slope){ place[all[i].row], place[all[i].column], all[i].value };
}

/* Loads whose frequency changes: a row each, and the pairs of load states that turn with it */
static void take_turns(struct tuned_block *b, const struct step *step, const int *place)
{
	const struct tuning *t = step->model->params.tuning;
	for (int l = 0; l < step->branch->system.loads; l++) {
		const int from = step->layout.load[l], columns = step->branch->system.load[l].columns;
		if (t->frequency[l] < 0 || place[from] < 0)
			continue;
		for (int k = from; k < from + columns; k += 2) {
			if (place[k] < 0)
				continue;
			ENLARGE(b->turn, 2 * (size_t)b->turns + 2);
			b->turn[2 * b->turns] = b->part.all.rows;
			b->turn[2 * b->turns++ + 1] = place[k];
		}
		add_row(&b->part, t->frequency[l], t->frequency[l]);
	}
}

/* Of the whole also its outputs, between the equations and the frequencies of its loads */
static struct tuned_block block_of(const struct step *step, const struct group *group, int index, int block, int count,
				   const struct fixed_slope *fixed)
{
	const struct linear *system = &step->branch->system;
	struct tuned_block b = { .group = group, .index = index, .block = block };
	int *parent = components(step), *place = take_x(&b, step);
	const bool full = !step->program->loops;
	if (!full)
		add_component(&b.part, step, parent,
			      root_of_node(parent, system->n + system->coord[group->state[block]]));
	b.derivatives = full ? system->n : b.part.all.rows;
	for (int row = 0; full && row < system->n + step->model->params.tuning->outputs; row++)
		add_row(&b.part, row, row);
	b.place = ARRAY(int, (size_t)b.derivatives);
	for (int i = 0; i < b.derivatives; i++) {
		const int coord = b.part.unknown[i];
		b.place[i] = place[highest_state(system, coord)];
	}
	take_slopes(&b, place, count, fixed);
	take_turns(&b, step, place);
	take_entries(&b.part, step, &b, place);
	return b;
}

/* ---- what belongs to no block ---- */

/* Components whose accelerations a changed output reads, where the target solves for them */
static void add_read_components(struct tuned_part *part, const struct step *step)
{
	const struct tuning *t = step->model->params.tuning;
	const int n = step->branch->system.n;
	int *parent = components(step);
	bool *read = ARRAY(bool, 2 * (size_t)n);
	for (const struct tuned_entry *entry = t->all.entry; entry < t->all.entry + t->all.entries; entry++)
		if (entry->row >= n && entry->row < t->all.rows - t->frequencies && entry->column >= t->x.size &&
		    entry->column < t->x.size + n)
			read[root_of_node(parent, n + entry->column - t->x.size)] = true;
	for (int root = 0; root < 2 * n; root++)
		if (read[root])
			add_component(part, step, parent, root);
}

static void plan_others(struct tuned_blocks *p, const struct step *step)
{
	const struct tuning *t = step->model->params.tuning;
	const int loads = step->branch->system.loads;
	p->others = (struct tuned_part){ 0 };
	add_read_components(&p->others, step);
	p->first_output = p->others.all.rows;
	for (int row = 0; row < t->outputs; row++)
		add_row(&p->others, step->branch->system.n + row, step->branch->system.n + row);
	p->frequency = nowhere(loads);
	for (int l = 0; l < loads; l++)
		if (t->frequency[l] >= 0) {
			p->frequency[l] = p->others.all.rows;
			add_row(&p->others, t->frequency[l], t->frequency[l]);
		}
	take_entries(&p->others, step, NULL, NULL);
}

/* ---- the whole ---- */

static void larger_of(int *most, int count)
{
	*most = count > *most ? count : *most;
}

static void measure_block(struct tuned_blocks *p, const struct step *step, const struct tuned_block *b)
{
	const int rows = b->part.all.rows * width_of_equations(&b->part.all), square = b->size * b->size;
	const int increments = step->branch->system.segments * b->group->states * b->size;
	int further = square + PL_INCREMENT_WORK(b->size), advance = square + further;
	larger_of(&further, b->part.all.operations);
	larger_of(&advance, further);
	larger_of(&p->more, rows + advance);
	if (b->group->tuned)
		larger_of(&p->work, increments + (p->solved ? 0 : rows) + further);
}

static void check_size(const struct step *step, const struct tuned_block *b)
{
	const struct tuning *t = step->model->params.tuning;
	const bool changes = loads_change(&step->branch->system);
	int k = 0;
	while (b->group->tuned && k < t->given - 1 && !(b->part.params >> k & 1))
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
	const struct tuning *t = step->model->params.tuning;
	const struct program *program = step->program;
	struct tuned_blocks *p = NEW(struct tuned_blocks);
	struct fixed_slope *fixed;
	const int count = fixed_slopes(step, &fixed), real = step->model->request.single ? 4 : 8;
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
			*block = block_of(step, &group[k], k, b, count, fixed);
			check_size(step, block);
			larger_of(&most, block->size);
			measure_block(p, step, block);
		}
	}
	p->others = p->block[0].part;
	p->first_output = step->branch->system.n;
	p->frequency = t->frequency;
	if (!p->solved)
		plan_others(p, step);
	larger_of(&p->work, p->others.all.operations + 1);
	stack = p->others.all.rows * width_of_equations(&p->others.all) + p->work;
	larger_of(&stack, p->more);
	p->kilobytes = 1 + real * (numbers + 2 * stack) / 1024;
	step->series.emitted = most <= LIMIT_TUNED_BLOCK;
	for (int b = 0; b < p->all; b++)
		if (step->series.emitted || p->block[b].group->tuned)
			p->block[p->blocks++] = p->block[b];
	step->blocks = p;
}
