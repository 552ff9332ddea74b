/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The words that recipes are written in: tables of the exact part, phi-function weights in them, nodes, stages,
 * remainders. A recipe that asks for more than there is room for is refused. */
#include "inner.h"

_Noreturn void internal_error(const struct step *step, const char *what)
{
	const struct model *model = step->model;
	error(model->request.at.scheme.source ? model->request.at.scheme : model->spec->name_at,
	      "this is a fault of plgen, not of the spec", "internal error: the program of scheme %s: %s",
	      scheme_name(model->scheme), what);
}

/* The next of so many */
static int next(const struct recipe *r, int *count, int limit, const char *what)
{
	if (*count == limit)
		internal_error(r->step, format("more %s than the limit of %d", what, limit));
	return (*count)++;
}

static void set(mpq_ptr value, long p, unsigned long q)
{
	mpq_set_si(value, p, q);
	mpq_canonicalize(value);
}

int add_table(struct recipe *r, const char *name, long p, unsigned long q, bool Phi)
{
	int table = next(r, &r->tables, RECIPE_TABLES, "tables");
	struct wanted *w = &r->table[table];
	*w = (struct wanted){ .Phi = Phi, .name = name };
	mpq_init(w->fraction);
	set(w->fraction, p, q);
	return table;
}

static struct phi_weight_part *add_part(const struct recipe *r, struct phi_weight *phi_weight, long p, unsigned long q)
{
	struct phi_weight_part *part =
		&phi_weight->part[next(r, &phi_weight->parts, PHI_WEIGHT_PARTS, "parts of a phi-function weight")];
	mpq_inits(part->fraction, part->impulse, part->power[0], part->power[1], part->power[2], NULL);
	set(part->fraction, p, q);
	return part;
}

static int add_phi_weight(const struct recipe *r, struct wanted *table, const char *name)
{
	int phi_weight = next(r, &table->phi_weights, TABLE_PHI_WEIGHTS, "phi-function weights of a table");
	table->phi_weight[phi_weight] = (struct phi_weight){ .name = name };
	return phi_weight;
}

void add_phi_part(struct recipe *r, int table, int phi_weight, long p, unsigned long q, int powers, const long *c)
{
	struct phi_weight_part *part = add_part(r, &r->table[table].phi_weight[phi_weight], p, q);
	for (int m = 0; m < powers; m++)
		set(part->power[next(r, &part->powers, PART_POWERS, "powers in a part of a phi-function weight")], c[m],
		    1);
}

int add_phi(struct recipe *r, int table, const char *name, long p, unsigned long q, int powers, const long *c)
{
	int phi_weight = add_phi_weight(r, &r->table[table], name);
	add_phi_part(r, table, phi_weight, p, q, powers, c);
	return phi_weight;
}

int add_weighted(struct recipe *r, int table, const char *name, long p, unsigned long q, long weight,
		 unsigned long over)
{
	int phi_weight = add_phi_weight(r, &r->table[table], name);
	struct phi_weight_part *part = add_part(r, &r->table[table].phi_weight[phi_weight], p, q);
	set(part->impulse, weight, over);
	mpq_mul(part->impulse, part->impulse, r->step->model->h);
	return phi_weight;
}

/* ---- times, stages, the remainder ---- */

int add_node(struct recipe *r, long p, unsigned long q)
{
	struct program *program = r->program;
	RATIONAL fraction = ZERO;
	set(fraction, p, q);
	for (int i = 0; i < program->nodes; i++)
		if (mpq_equal(program->node[i], fraction))
			return i;
	ENLARGE(program->node, (size_t)program->nodes + 1);
	ENLARGE(program->node_table, (size_t)program->nodes + 1);
	mpq_init(program->node[program->nodes]);
	mpq_set(program->node[program->nodes], fraction);
	program->node_table[program->nodes] = NONE;
	return program->nodes++;
}

void need_loads_at(struct recipe *r, int node)
{
	struct program *program = r->program;
	if (program->node_table[node] != NONE)
		return;
	if (mpq_cmp_ui(program->node[node], 1, 1) == 0) {
		program->node_table[node] = 0;          /* the whole step's */
		return;
	}
	program->node_table[node] = add_table(r, format("part%d", node), 0, 1, false);
	mpq_set(r->table[program->node_table[node]].fraction, program->node[node]);
}

int new_stage(struct recipe *r)
{
	return ++r->program->stages;
}

struct action *add_action(struct recipe *r, struct action action)
{
	struct action *added = MORE(r->program->action, r->program->actions);
	*added = action;
	return added;
}

int add_remainder(struct recipe *r, int node, int stage)
{
	int left = r->program->lefts++;
	add_action(r, (struct action){ .kind = ACTION_REMAINDER, .target = left, .node = node, .from = stage });
	return left;
}

int add_combination(struct recipe *r, int plus, int minus, bool added)
{
	struct action action = { .kind = ACTION_COMBINE, .plus = plus, .minus = minus, .added = added };
	action.target = r->program->lefts++;
	add_action(r, action);
	return action.target;
}

struct action *add_sum(struct recipe *r, int stage, int flow, int plain, const char *note)
{
	struct action action = { .kind = ACTION_SUM, .target = stage, .flow = flow, .plain = plain, .note = note };
	return add_action(r, action);
}

void times_left(struct recipe *r, struct action *sum, int table, int phi_weight, int left)
{
	int k = next(r, &sum->phi_weights, SUM_PHI_WEIGHTS, "phi-function weights in a sum");
	sum->phi_weight[k].table = table;
	sum->phi_weight[k].phi_weight = phi_weight;
	sum->phi_weight[k].left = left;
}
