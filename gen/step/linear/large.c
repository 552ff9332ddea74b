/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A large step by its independent blocks: a few small ones as rows that can be read, many alike in one loop over their
 * numbers, a large one by the columns of its matrix, which compilers vectorise. What is zero between blocks leaves no
 * trace. */
#include "inner.h"
#include "plrt.h"
#include "step/tunable/tuned.h"

enum {
	ROW_STATES = LIMIT_UNROLLED_STATES, /* of a block, for rows, or for the body of a loop */
	ROW_TERMS = 320,            /* a page of them */
	ALIKE = 4                   /* blocks of one shape, from which on they are a loop */
};

const struct coefficient *group_factor(const struct step *step, const struct group *g, int row, int block,
				       const struct operand *operand, int segment)
{
	const struct table *table = step->branch->full;
	const int state = g->state[row * g->blocks + block];
	const struct coefficient *square = step->form == FORM_DELTA ? table->increment : table->Phi;
	switch (operand->kind) {
	case OPERAND_STATE:
		return &square[state * table->states + g->state[operand->index * g->blocks + block]];
	case OPERAND_LOAD:
		return &table->load[(segment * table->states + state) * table->columns + operand->index];
	default:
		return &table->input[state * table->inputs + operand->index];
	}
}

/* In some segment of time, of some block */
bool group_acts(const struct step *step, const struct group *g, int row, const struct operand *operand)
{
	const int segments = operand->kind == OPERAND_LOAD ? step->branch->system.segments : 1;
	if (operand->kind == OPERAND_LOAD && is_forced(step, operand->index))
		return false;
	for (int s = 0; s < segments; s++)
		for (int b = 0; b < g->blocks; b++)
			if (!group_factor(step, g, row, b, operand, s)->zero)
				return true;
	return false;
}

/* ---- independent blocks ---- */

/* Per state: the first state of its block */
static int *blocks_of_step(const struct step *step)
{
	const struct table *table = step->branch->full;
	const int n = table->states, *tuned = tuned_components(step);
	int *parent = numbers_up_to(n);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			const int a = root_of_node(parent, i), b = root_of_node(parent, j);
			if ((!table->Phi[i * n + j].zero || (tuned && tuned[i] == tuned[j])) && a != b)
				parent[a > b ? a : b] = a < b ? a : b;
		}
	for (int i = 0; i < n; i++)
		parent[i] = root_of_node(parent, i);
	return parent;
}

static struct group block_from(const int *first, int states, int state, const bool *touched)
{
	struct group g = { .blocks = 1, .state = ARRAY(int, states), .tuned = touched && touched[state] };
	for (int i = 0; i < states; i++)
		if (first[i] == state)
			g.state[g.states++] = i;
	return g;
}

/* ---- what is stepped in one way ---- */

static struct operand operand_of_column(const struct step *step, const struct group *g, int k)
{
	const int columns = step->branch->full->columns;
	return k < g->states	       ? (struct operand){ OPERAND_STATE, k }
	       : k < g->states + columns ? (struct operand){ OPERAND_LOAD, k - g->states }
					 : (struct operand){ OPERAND_INPUT, k - g->states - columns };
}

/* Operands that it may have */
static int operands_of(const struct step *step, const struct group *g)
{
	return g->states + step->branch->full->columns + step->branch->full->inputs;
}

/* The same factors are 0. */
static bool is_alike(const struct step *step, const struct group *a, const struct group *b)
{
	bool alike = a->states == b->states && a->tuned == b->tuned;
	for (int i = 0; alike && i < a->states; i++) {
		for (int k = 0; alike && k < operands_of(step, a); k++) {
			const struct operand operand = operand_of_column(step, a, k);
			alike = group_acts(step, a, i, &operand) == group_acts(step, b, i, &operand);
		}
	}
	return alike;
}

static int terms_of(const struct step *step, const struct group *g)
{
	int terms = 0;
	for (int i = 0; i < g->states; i++)
		for (int k = 0; k < operands_of(step, g); k++) {
			const struct operand operand = operand_of_column(step, g, k);
			terms += group_acts(step, g, i, &operand);
		}
	return terms;
}

/* One group of blocks that are alike, from their list */
static struct group gathered(const struct group *block, int count, const int *which)
{
	struct group g = { .states = block[which[0]].states, .blocks = count, .tuned = block[which[0]].tuned };
	g.state = ARRAY(int, (size_t)(g.states * count));
	for (int i = 0; i < g.states; i++)
		for (int b = 0; b < count; b++)
			g.state[i * count + b] = block[which[b]].state[i];
	return g;
}

/* Rows read the state as it was when they began: what is carried is saved before, which they would miss. */
static bool is_carried(const struct step *step, const struct group *g)
{
	bool any = false;
	for (int i = 0; i < g->states * g->blocks; i++)
		any = any || step->carried.place[g->state[i]] >= 0;
	return any;
}

static void choose_kind(const struct step *step, struct group *g, int *page)
{
	const int terms = terms_of(step, g);
	if (g->blocks > 1) {
		g->kind = GROUP_ALIKE;
	} else if (g->states <= ROW_STATES && terms <= *page && !is_carried(step, g)) {
		g->kind = GROUP_ROWS;
		*page -= terms;
	} else {
		g->kind = GROUP_COLUMNS;
	}
}

static void list_columns(const struct step *step, struct group *g)
{
	const struct table *table = step->branch->full;
	g->load = ARRAY(int, table->columns);
	g->input = ARRAY(int, table->inputs);
	for (int k = g->states; k < operands_of(step, g); k++) {
		const struct operand operand = operand_of_column(step, g, k);
		bool acts = false;
		for (int i = 0; i < g->states && !acts; i++)
			acts = group_acts(step, g, i, &operand);
		if (acts && operand.kind == OPERAND_LOAD)
			g->load[g->loads++] = operand.index;
		if (acts && operand.kind == OPERAND_INPUT)
			g->input[g->inputs++] = operand.index;
	}
}

static void add_group(struct program *program, const struct step *step, struct group g, int *page)
{
	choose_kind(step, &g, page);
	list_columns(step, &g);
	*MORE(program->group, program->groups) = g;
}

/* ---- what it costs ---- */

static bool is_one(const struct step *step, const struct group *g, int row, const struct operand *operand)
{
	const struct coefficient *factor = group_factor(step, g, row, 0, operand, 0);
	const bool changes = operand->kind == OPERAND_LOAD && loads_change(&step->branch->system);
	return g->kind == GROUP_ROWS && !changes && !g->tuned &&
	       (factor->value == 1 || factor->value == -1 ||
		(operand->kind == OPERAND_LOAD && is_constant_column(&step->branch->system, operand->index)));
}

static void count_rows(struct program *program, const struct step *step, const struct group *g)
{
	for (int i = 0; i < g->states; i++) {
		int terms = 0;
		for (int k = 0; k < operands_of(step, g); k++) {
			const struct operand operand = operand_of_column(step, g, k);
			const bool acts = group_acts(step, g, i, &operand);
			terms += acts;
			program->multiplications += acts && !is_one(step, g, i, &operand) ? g->blocks : 0;
		}
		program->additions += terms ? g->blocks * (terms - !program->products_added) : 0;
	}
}

static void count_columns(struct program *program, const struct group *g)
{
	const int operands = g->states + g->loads + g->inputs;
	program->multiplications += g->states * operands;
	program->additions += g->states * (operands - !program->products_added);
}

static void count_groups(struct program *program, const struct step *step)
{
	program->multiplications = program->forcing_multiplications;
	program->additions = program->forcing_additions;
	for (int i = 0; i < program->groups; i++)
		if (program->group[i].kind == GROUP_COLUMNS)
			count_columns(program, &program->group[i]);
		else
			count_rows(program, step, &program->group[i]);
	program->additions += (PL_ACCUMULATE_ADD - 1) * step->carried.count;
}

/* ---- the whole ---- */

/* Those like block `b` that stand in no group yet */
static int like(const struct step *step, const struct group *block, int blocks, int b, bool *grouped, int *which)
{
	int count = 0;
	for (int other = b; other < blocks; other++)
		if (!grouped[other] && is_alike(step, &block[b], &block[other]))
			which[count++] = other;
	for (int i = 0; i < count && (i == 0 || count >= ALIKE); i++)
		grouped[which[i]] = true;
	return count >= ALIKE ? count : 1;
}

void find_groups(struct program *program, const struct step *step)
{
	const int states = step->branch->full->states, *first = blocks_of_step(step);
	struct group *block = ARRAY(struct group, states);
	const bool *touched = touched_states(step);
	bool *grouped = ARRAY(bool, states);
	int *which = ARRAY(int, states), blocks = 0, page = ROW_TERMS;
	for (int i = 0; i < states; i++)
		if (first[i] == i)
			block[blocks++] = block_from(first, states, i, touched);
	for (int b = 0; b < blocks; b++) {
		if (grouped[b])
			continue;
		const bool small = block[b].states <= ROW_STATES;
		const int count = small ? like(step, block, blocks, b, grouped, which) : 1;
		which[0] = b;
		add_group(program, step, gathered(block, count, which), &page);
	}
	count_groups(program, step);
}
