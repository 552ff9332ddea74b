/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What every program of a step keeps to, whichever scheme wrote it: emitters and the report take it as given. Each
 * stage and each remainder is written once, and before it is read; what is named is there. */
#include "model/regions/regions.h"
#include "step/collocation/collocation.h"
#include "step/series/expansion.h"
#include "step/exponential/normal.h"
#include "step/exponential/recipe.h"

struct check {
	const struct step *step;
	const struct program *program;
	bool *stage, *left;         /* is it written? Stage 0 is the state that the step starts from */
	bool ended;                 /* the state after the step is written */
	const char *where;          /* action 3, assignment 2; for messages */
};

static void need(const struct check *c, bool good, const char *what)
{
	if (!good)
		internal_error(c->step, format("%s: %s", c->where, what));
}

static bool among(int index, int count)
{
	return index >= 0 && index < count;
}

/* ---- tables ---- */

static void check_table(const struct check *c, const struct table *table)
{
	need(c, table && table->wanted, "a table is not there");
	need(c, !table->wanted->Phi || table->Phi, "a table without its Phi");
	need(c, !table->columns || table->load, "a table without the columns of its loads");
	need(c, !table->inputs || table->input, "a table without the columns of its inputs");
	need(c, among(table->wanted->phi_weights, TABLE_PHI_WEIGHTS + 1),
	     "a table with more phi-function weights than the limit");
	for (int k = 0; k < table->wanted->phi_weights; k++)
		need(c, table->phi_weight[k], "a table without one of its phi-function weights");
}

static void check_tables(struct check *c)
{
	const struct step *step = c->step;
	c->where = "tables";
	need(c, step->branches > 0 && step->tables > 0, "there are none");
	for (int k = 0; k < step->branches; k++) {
		need(c, step->branch[k].table, "a branch without tables");
		for (int t = 0; t < step->tables; t++)
			check_table(c, step->branch[k].table[t]);
	}
	check_table(c, step->branch->full);
}

/* ---- a list of assignments ---- */

static int operands_of(const struct table *table, enum operand_kind kind)
{
	return kind == OPERAND_STATE ? table->states : kind == OPERAND_LOAD ? table->columns : table->inputs;
}

static void check_operand(const struct check *c, const struct product *p)
{
	const struct table *table = c->step->branch->full;
	int columns = operands_of(table, p->operand.kind);
	need(c, p->factor, "a term without its factor");
	need(c, among(p->operand.index, columns), "a term whose operand is out of range");
	if (p->operand.kind == OPERAND_STATE)
		need(c, c->program->reads[p->operand.index], "a state is read that is not marked as read");
	if (p->operand.kind == OPERAND_LOAD)
		need(c, c->program->uses[p->operand.index], "a load is read that is not marked as used");
}

static void check_assignment(const struct check *c, const struct assignment *a)
{
	const struct table *table = c->step->branch->full;
	need(c, among(a->target, table->states), "its target is out of range");
	need(c, among(a->terms, table->states + table->columns + table->inputs + 1),
	     "its number of terms is out of range");
	need(c, !a->added || c->program->reads[a->target], "it adds to a state that is not marked as read");
	need(c, !a->carried || c->step->carried.place[a->target] >= 0,
	     "it carries what rounding takes, and there is no place for that");
	for (int k = 0; k < a->terms; k++)
		check_operand(c, &a->term[k]);
}

static void check_group(const struct check *c, const struct group *g, bool *stepped)
{
	const struct table *table = c->step->branch->full;
	need(c, g->kind == GROUP_ALIKE || g->blocks == 1, "several blocks where there is one");
	for (int i = 0; i < g->states * g->blocks; i++) {
		need(c, among(g->state[i], table->states), "a state that is out of range");
		need(c, !stepped[g->state[i]], "a state is stepped twice");
		stepped[g->state[i]] = true;
	}
	for (int k = 0; k < g->loads; k++)
		need(c, among(g->load[k], table->columns), "a load that is out of range");
	for (int k = 0; k < g->inputs; k++)
		need(c, among(g->input[k], table->inputs), "an input that is out of range");
}

/* Every state stands in one group, and nothing acts from the one on the other. */
static void check_groups(struct check *c)
{
	const struct table *table = c->step->branch->full;
	bool *stepped = ARRAY(bool, table->states);
	for (int k = 0; k < c->program->groups; k++) {
		c->where = format("group %d", k);
		check_group(c, &c->program->group[k], stepped);
	}
	for (int i = 0; i < table->states; i++)
		need(c, stepped[i], "a state is not stepped");
}

static void check_list(struct check *c)
{
	const struct program *program = c->program;
	bool *written = ARRAY(bool, c->step->branch->full->states);
	for (int i = 0; i < program->assignments; i++) {
		const struct assignment *a = &program->assignment[i];
		c->where = format("assignment %d", i);
		check_assignment(c, a);
		need(c, program->in_order || !written[a->target], "its target is written before");
		written[a->target] = true;
	}
	c->where = "loops";
	need(c, program->loops == (program->groups > 0 || c->step->modal), "a step loops over groups, or it has none");
	if (program->groups)
		check_groups(c);
	need(c, !program->loops || !(program->in_order || program->compensated),
	     "a step of a form that is not built with loops");
	need(c, !program->tuned || c->step->model->params.tuning, "factors of tunable params, and there are none");
}

/* ---- a list of actions ---- */

static void check_stage_read(const struct check *c, int stage)
{
	need(c, among(stage, c->program->stages + 1), "it reads a stage that is out of range");
	need(c, c->stage[stage], "it reads a stage that is not written");
}

static void check_left_read(const struct check *c, int left)
{
	need(c, among(left, c->program->lefts), "it reads a remainder that is out of range");
	need(c, c->left[left], "it reads a remainder that is not written");
}

static void check_left_target(struct check *c, int left)
{
	need(c, among(left, c->program->lefts), "its target is no remainder");
	need(c, !c->left[left], "its target is written before");
	c->left[left] = true;
}

/* The state is written last: what reads it means its old value. */
static void check_stage_target(struct check *c, int stage)
{
	need(c, among(stage, c->program->stages + 1), "its target is no stage");
	need(c, stage == STAGE_STATE || !c->stage[stage], "its target is written before");
	c->stage[stage] = true;
	c->ended = stage == STAGE_STATE;
}

static void check_node(const struct check *c, int node)
{
	need(c, among(node, c->program->nodes), "its node is out of range");
}

static void check_sum(struct check *c, const struct action *a)
{
	struct table *const *table = c->step->branch->table;
	need(c, a->flow == NONE || among(a->flow, c->step->tables), "its table is out of range");
	need(c, a->flow == NONE || table[a->flow]->Phi, "its table has no Phi");
	need(c, among(a->phi_weights, SUM_PHI_WEIGHTS + 1), "it has more phi-function weights than the limit");
	need(c, a->flow != NONE || a->plain != NONE || a->phi_weights > 0, "a sum of nothing");
	if (a->plain != NONE)
		check_stage_read(c, a->plain);
	for (int k = 0; k < a->phi_weights; k++) {
		need(c, among(a->phi_weight[k].table, c->step->tables),
		     "the table of a phi-function weight is out of range");
		need(c, among(a->phi_weight[k].phi_weight, table[a->phi_weight[k].table]->wanted->phi_weights),
		     "a phi-function weight is out of range");
		check_left_read(c, a->phi_weight[k].left);
	}
	check_stage_target(c, a->target);
}

/* It starts with the remainder that was evaluated first. */
static void check_prediction(struct check *c, const struct action *a)
{
	need(c, c->program->predicts, "a prediction in a step that is not marked for them");
	check_left_read(c, 0);
	check_node(c, a->node);
	check_node(c, a->half);
	check_stage_target(c, a->target);
}

static void check_action(struct check *c, const struct action *a)
{
	need(c, !c->ended, "it comes after the state is written");
	switch (a->kind) {
	case ACTION_REMAINDER:
		check_node(c, a->node);
		check_stage_read(c, a->from);
		check_left_target(c, a->target);
		break;
	case ACTION_COMBINE:
		check_left_read(c, a->plus);
		if (a->minus != NONE)
			check_left_read(c, a->minus);
		check_left_target(c, a->target);
		break;
	case ACTION_SUM:
		check_sum(c, a);
		break;
	case ACTION_PREDICT:
		check_prediction(c, a);
		break;
	default:
		need(c, false, "an action of no known kind");
	}
}

static void check_nodes(struct check *c)
{
	const struct program *program = c->program;
	c->where = "nodes";
	need(c, program->nodes > 0 && mpq_sgn(program->node[0]) == 0, "the first is not 0");
	for (int i = 0; i < program->nodes; i++) {
		int table = program->node_table[i];
		need(c, mpq_sgn(program->node[i]) >= 0 && mpq_cmp_ui(program->node[i], 1, 1) <= 0,
		     "one is outside the step");
		need(c, table == NONE || among(table, c->step->tables), "the table of one is out of range");
	}
}

static void check_actions(struct check *c)
{
	const struct program *program = c->program;
	check_nodes(c);
	c->stage = ARRAY(bool, program->stages + 1);
	c->left = ARRAY(bool, program->lefts);
	c->stage[STAGE_STATE] = true;
	for (int i = 0; i < program->actions; i++) {
		c->where = format("action %d", i);
		check_action(c, &program->action[i]);
	}
	c->where = "actions";
	need(c, c->ended, "the state is never written");
}

/* ---- regions ---- */

static void check_regions(struct check *c, const struct step *step)
{
	c->where = "regions";
	need(c, step->branches == (step->model->switching->cached ? 1 : step->model->switching->systems),
	     "one without its tables");
	need(c, step->regions.parts == step->model->switching->parts, "an independent part without its step");
	need(c, step->series.emitted && step->series.degree > 0, "they have no series to find crossings by");
	for (int k = 0; k < step->branches; k++) {
		const struct wanted *wanted = step->branch[k].table[0]->wanted;
		need(c, among(step->branch[k].halvings, LIMIT_PIECES + 1), "pieces of a step that are out of range");
		need(c, wanted->phi_weights == 2, "a table without what inputs add, held and as ramps");
	}
	for (int p = 0; p < step->regions.parts; p++)
		check_regions(c, step->regions.part[p]);
}

static void check_collocation(struct check *c)
{
	const struct motion *m = c->step->collocation->motion;
	int coords = c->step->branch->system.n;
	c->where = "the collocation";
	need(c, c->step->collocation && c->step->collocation->modes == (c->step->collocation->stages + 1) / 2,
	     "there is none, or its modes are not those of its stages");
	c->where = "the highest derivatives";
	need(c, m && m->coords == coords, "there is none of each coordinate");
	for (int i = 0; i < m->entries; i++)
		need(c, among(m->entry[i].coord, coords) && among(m->entry[i].of, coords),
		     "an entry of their Jacobian is out of range");
}

void program_check(const struct step *step)
{
	struct check c = { .step = step, .program = step->program, .where = "program" };
	need(&c, step->program, "there is none");
	check_tables(&c);
	need(&c, step->program->reads && step->program->uses, "it does not say what it reads");
	if (step->model->switching)
		check_regions(&c, step);
	else if (step->is.flow == FLOW_SERIES)
		need(&c, step->taylor.expansion, "there is no series");
	else if (step->is.flow == FLOW_COLLOCATION)
		check_collocation(&c);
	else if (step->is.flow == FLOW_NORMAL)
		need(&c, step->normal && step->normal->operators > 0, "there are no normal modes");
	else if (has_remainder(step))
		check_actions(&c);
	else
		check_list(&c);
}
