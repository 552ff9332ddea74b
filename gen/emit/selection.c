/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bank: which of its operators serves now. */
#include "emit/emit.h"

static void emit_selection_locals(const struct emitter *e, const struct reads *r)
{
	emit_locals_of(e, r->state, "s->y");
	emit_param_locals(e, r->param);
	if (r->time)
		say(e, "    const double t = $n_time(s);\n");
	for (int i = 0; i < e->system->inputs; i++) {
		if (r->input[i])
			say(e, "    const double %s = u[%d];\n", input_name(e, i, 0), i);
		if (r->input[e->system->inputs + i])
			say(e, "    const double %s = slope[%d];\n", input_name(e, i, 1), i);
	}
	emit_load_states(e, r->load, true);
}

void emit_selection(const struct emitter *e)
{
	const struct form *selector = e->model->selector;
	const struct operator *operator = e->model->operator;
	struct reads r = reads_of(e->model, 1, &selector);
	int last = e->model->operators - 1;
	say(e, "\n/* The first operator whose value is not below the current one */\n"
	       "static int $n_operator(const $n *s%s%s)\n"
	       "{\n", any_of(r.input, e->system->inputs) ? ", const double u[]" : "",
	    reads_slope(e, &r) ? ", const double slope[]" : "");
	emit_selection_locals(e, &r);
	struct formulas *f = formulas_new(e, (struct reading){ 0 }, 1, &selector);
	tape_set(formulas_tape(f), "const double now", formula(f, selector), 8, NULL);
	emit_formulas(f, 4);
	say(e, "    (void)s;\n"
	       "    return ");
	for (int k = 0; k < last; k++)
		say(e, "now <= %s ? %d : ", shortest(equation_number(e->model, operator[k].at).value), k);
	say(e, "%d;\n"
	       "}\n", last);
}

const char *selection_call(const struct emitter *e)
{
	struct reads r = reads_of(e->model, 1, &e->model->selector);
	const char *u = !any_of(r.input, e->system->inputs) ? "" : e->ramps ? ", start" : ", u";
	return format("%s_operator(s%s%s)", e->name, u, reads_slope(e, &r) ? ", slope" : "");
}
