/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tunable params that the instance has: expressions read them, or they act like inputs. */
#include "inner.h"
#include "model/building.h"

const struct node *first_tuned(const struct node *node)
{
	if (node->kind == NODE_NAME && node->symbol->tuning.tuned)
		return node;
	for (int i = 0; i < node->children; i++) {
		const struct node *found = first_tuned(node->child[i]);
		if (found)
			return found;
	}
	return NULL;
}

static bool is_of_tunables(const struct node *node)
{
	const struct symbol *s = node->kind == NODE_NAME ? node->symbol : NULL;
	bool is = s && (s->tuning.tuned || (s->value && is_of_tunables(s->value)));
	for (int i = 0; i < node->children && !is; i++)
		is = is_of_tunables(node->child[i]);
	return is;
}

void refuse_what_stays(const struct spec *spec)
{
	const char *note = "by another value it would stay: --tunable is for what makes the same model as -D";
	for (int i = 0; i < spec->states.initials; i++)
		if (is_of_tunables(spec->states.initial[i].value))
			say_error(spec->states.initial[i].at, note, "this initial value reads a tunable param");
	if (spec->request.step && is_of_tunables(spec->request.step))
		say_error(spec->request.step_at, note, "the step reads a tunable param");
	if (spec->required.needs)
		say_error(spec->required.need[0].at, note, "what meets a need depends on the values of params");
}

/* Each stands after what it is made of. */
void spread_tuned(const struct spec *spec)
{
	for (struct symbol *s = spec->first; s; s = s->next)
		s->tuning.tuned = s->tuning.tuned || (s->value && first_tuned(s->value));
}

int param_of_input(const struct spec *spec, int input)
{
	int k = input < spec->count.inputs ? -1 : 0;
	while (k >= 0 && (spec->tuned.tunable[k].symbol->tuning.factor ||
			  spec->tuned.tunable[k].symbol->tuning.acting != input - spec->count.inputs))
		k++;
	return k;
}

unsigned params_read(const struct node *node)
{
	struct symbol *s = node->kind == NODE_NAME ? node->symbol : NULL;
	unsigned params = 0;
	if (s && s->tuning.number && !s->tuning.derived)
		return 1u << (s->tuning.number - 1);
	if (s && s->tuning.tuned && s->value && !s->tuning.made_of)
		s->tuning.made_of = params_read(s->value);
	for (int i = 0; i < node->children; i++)
		params |= params_read(node->child[i]);
	return s ? s->tuning.made_of : params;
}

unsigned params_of_tunable(const struct spec *spec, int tunable)
{
	const struct symbol *s = spec->tuned.tunable[tunable].symbol;
	return s->tuning.derived ? params_read(s->value) : 1u << tunable;
}

struct tuning *list_tunables(const struct model *model)
{
	struct tuning *t = NEW(struct tuning);
	t->params = model->spec->tuned.count;
	t->given = t->params - model->spec->tuned.derived;
	t->param = model->spec->tuned.tunable;
	t->nominal = rationals(t->params);
	for (int k = 0; k < t->params; k++)
		param_value(t->param[k].symbol, t->nominal[k]);
	return t;
}

const struct model *model_elsewhere(const struct model *model)
{
	return tunables_of(model) ? tunables_of(model)->other : NULL;
}

const struct tuning *tunables_of(const struct model *model)
{
	return model->params.tuning ? model->params.tuning : model->params.held;
}

const struct param_range *range_of_param(const struct model *model, const struct symbol *param)
{
	const struct tuning *t = tunables_of(model);
	for (int k = 0; t && k < t->given; k++)
		if (t->param[k].symbol == param)
			return model->params.range[k];
	return NULL;
}

void part_factors(struct building *b)
{
	const struct request *request = b->request;
	const bool *factor = request->again.factor         ? request->again.factor
			     : request->find_factors ? request->find_factors(b)
						     : ARRAY(bool, b->spec->tuned.count);
	for (int i = 0, acting = 0; i < b->spec->tuned.count; i++) {
		b->spec->tuned.tunable[i].symbol->tuning.factor = factor[i];
		b->spec->tuned.tunable[i].symbol->tuning.acting = factor[i] ? acting : acting++;
		if (factor[i])
			b->factor = b->model->params.factor = factor;
	}
}
