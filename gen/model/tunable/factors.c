/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which tunable params of regions are factors, numbers in their matrices: those that cannot go as held inputs. The
 * model is built at the spec's values with one after the other as an input, in silence. */
#include "model/building.h"
#include "elsewhere.h"

struct attempt {
	struct building *b;
	mpq_t *nominal;
	bool *factor;
};

static void build_attempt(void *context)
{
	const struct attempt *a = context;
	struct request request = *a->b->request;
	request.again.tunable = a->nominal;
	request.again.factor = a->factor;
	if (!model_build(parse_spec(a->b->spec->source), &request))
		abandon();
}

static void mark_read(const struct node *node, bool *mark)
{
	if (node->kind == NODE_NAME && node->symbol->tuning.number)
		mark[node->symbol->tuning.number - 1] = true;
	else if (node->kind == NODE_NAME && node->symbol->kind != SYMBOL_COORD && node->symbol->value)
		mark_read(node->symbol->value, mark);
	for (int i = 0; i < node->children; i++)
		mark_read(node->child[i], mark);
}

/* As an input a force of friction takes two regions, above and below 0. */
static void mark_forces(const struct node *node, bool *mark)
{
	bool friction = node->kind == NODE_CALL && node->function == FN_FRICTION;
	for (int i = 0; i < node->children; i++)
		if (friction && i > 0)
			mark_read(node->child[i], mark);
		else
			mark_forces(node->child[i], mark);
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET && node->symbol->value)
		mark_forces(node->symbol->value, mark);
}

static void mark_all_forces(const struct spec *spec, bool *mark)
{
	for (int i = 0; i < spec->equations; i++) {
		mark_forces(spec->equation[i].left, mark);
		mark_forces(spec->equation[i].right, mark);
	}
	for (int i = 0; i < spec->elements; i++)
		if (spec->element[i].kind == ELEMENT_FRICTION)
			mark_read(spec->element[i].value, mark);
}

/* As few as can be: first none but what comes back of impacts; then all but those that go as inputs, and well */
const bool *find_factors(struct building *b)
{
	const struct spec *spec = b->spec;
	size_t count = (size_t)spec->tuned.count;
	struct attempt a = { b, rationals(count), ARRAY(bool, count) };
	bool *given = ARRAY(bool, count);
	for (int k = 0; k < spec->tuned.count; k++)
		param_value(spec->tuned.tunable[k].symbol, a.nominal[k]);
	for (int i = 0; i < spec->whens; i++)
		if (spec->when[i].restitution)
			mark_read(spec->when[i].restitution, given);
	for (int k = 0; k < spec->tuned.count; k++)
		a.factor[k] = given[k];
	if (silent_guard(build_attempt, &a))
		return a.factor;
	mark_all_forces(spec, given);
	for (int k = 0; k < spec->tuned.count; k++)
		a.factor[k] = true;
	for (int k = 0; k < spec->tuned.count; k++) {
		a.factor[k] = given[k];
		a.factor[k] = given[k] || !silent_guard(build_attempt, &a);
	}
	return a.factor;
}
