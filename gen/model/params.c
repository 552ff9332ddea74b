/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tunable params that the instance has: expressions read them, or they act like inputs. */
#include "model/model.h"

const struct node *first_tuned(const struct node *node)
{
	if (node->kind == NODE_NAME && node->symbol->tuned)
		return node;
	for (int i = 0; i < node->children; i++) {
		const struct node *found = first_tuned(node->child[i]);
		if (found)
			return found;
	}
	return NULL;
}

/* Each stands after what it is made of. */
void spread_tuned(const struct spec *spec)
{
	for (struct symbol *s = spec->first; s; s = s->next)
		s->tuned = s->tuned || (s->value && first_tuned(s->value));
}

int param_of_input(const struct spec *spec, int input)
{
	int k = input < spec->inputs ? -1 : 0;
	while (k >= 0 && (spec->tunable[k].symbol->factor || spec->tunable[k].symbol->acting != input - spec->inputs))
		k++;
	return k;
}

static unsigned params_read(const struct node *node)
{
	const struct symbol *s = node->kind == NODE_NAME ? node->symbol : NULL;
	unsigned params = 0;
	if (s && s->tunable && !s->derived)
		return 1u << (s->tunable - 1);
	if (s && s->tuned && s->value)
		params = params_read(s->value);
	for (int i = 0; i < node->children; i++)
		params |= params_read(node->child[i]);
	return params;
}

unsigned params_of_tunable(const struct spec *spec, int tunable)
{
	const struct symbol *s = spec->tunable[tunable].symbol;
	return s->derived ? params_read(s->value) : 1u << tunable;
}

static void read_by(struct reads *all, const struct model *model, int count, const struct form *const *form)
{
	const struct reads own = reads_of(model, count, form);
	for (int k = 0; k < model->spec->tunables; k++)
		all->param[k] = all->param[k] || own.param[k];
	for (int i = model->spec->inputs; i < model->system.inputs; i++)
		if (own.input[i])
			all->param[param_of_input(model->spec, i)] = true;
}

void warn_of_unread(const struct model *model)
{
	if ((model->switching && rubs(model->switching)) || model->drags > 0)
		return;         /* rows of regions, and what holds beside a series, may read them, too */
	const struct spec *spec = model->spec;
	struct reads all = reads_of(model, model->selector != NULL, &model->selector);
	for (int k = 0; k < model->operators; k++)
		read_by(&all, model, model->channels, (const struct form *const *)model->operator[k].left);
	for (int i = 0; i < model->n && model->whole; i++)
		read_by(&all, model, 1, &(const struct form *){ model->whole->residual[i].form });
	for (int i = 0; i < model->outputs; i++) {
		read_by(&all, model, model->output[i].left != NULL, &(const struct form *){ model->output[i].left });
		for (int k = spec->inputs; k < model->system.inputs; k++)
			if (mpq_sgn(model->output[i].input[0][k]) != 0)
				all.param[param_of_input(spec, k)] = true;
	}
	for (int i = spec->tunables - spec->derived; i < spec->tunables; i++)
		for (int k = 0; k < spec->tunables && (all.param[i] || (model->factor && model->factor[i])); k++)
			all.param[k] = all.param[k] || (params_of_tunable(spec, i) >> k & 1);
	for (int k = 0; k < spec->tunables - spec->derived; k++)
		if (!all.param[k] && !(model->factor && model->factor[k]))
			say_warning(spec->tunable[k].at, NULL, "tunable '%s' changes nothing that the target computes",
				    spec->tunable[k].symbol->name);
}

struct tuning *list_tunables(const struct model *model)
{
	struct tuning *t = NEW(struct tuning);
	t->params = model->spec->tunables;
	t->given = t->params - model->spec->derived;
	t->param = model->spec->tunable;
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
	return model->tuning ? model->tuning : model->held;
}
