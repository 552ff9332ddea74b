/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the constraints miss, for the runtime's constraints.h. */
#include "steps.h"
#include "model/reads.h"

static const struct form **corrections(const struct emitter *e)
{
	return e->model->equations.correction;
}

static struct formulas *misses(const struct emitter *e)
{
	const int states = e->system->states;
	struct formulas *f = formulas_new(e, (struct reading){ .written = true }, states, corrections(e));
	for (int i = 0; i < states; i++)
		tape_set(formulas_tape(f), format("miss[%d]", i), formula(f, corrections(e)[i]), 14,
			 e->model->names.state[i]);
	return f;
}

bool constraints_need_math(const struct emitter *e)
{
	return corrections(e) && tape_cost(formulas_tape(misses(e))).calls > 0;
}

void emit_constraints(const struct emitter *e)
{
	if (!corrections(e))
		return;
	struct formulas *f = misses(e);
	const struct reads r = reads_of_formulas(f);
	open_function(e, "What has to be taken from y, tau after now, for the constraints to hold, to first order",
		      "static void $n_misses(const $n *s, double tau, const double y[$N_STATES], "
		      "double miss[$N_STATES])");
	emit_param_locals(e, r.param);
	if (r.time)
		say(e, "    const double t = $n_time(s) + tau;\n");
	emit_formulas(f, 4);
	close_function(e, "s tau y");
}
