/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a model has of params that an instance holds: types, retune. */
#include "emit/emit.h"

static const struct tuning *held(const struct emitter *e)
{
	return e->model->held;
}

int held_leads(const struct emitter *e)
{
	return e->model->held ? e->model->leads.count : 0;
}

void emit_held_types(const struct emitter *e)
{
	if (!held(e))
		return;
	say(e, "enum { $N_PARAMS = %d };  /* tunable: %s */\n"
	       "typedef struct $n_coeffs $n_coeffs;  /* what %s read */\n"
	       "struct $n_coeffs {\n", held(e)->params, param_list(e),
	    e->model->retuned ? "a step and outputs" : "the equations and outputs");
	declare_members(e, e->model->retuned ? emit_retuned_numbers : emit_nominal_params);
	say(e, "};\n"
	       "\n");
}

void emit_held_member(const struct emitter *e)
{
	if (held(e))
		say(e, "    $n_coeffs coeffs;    /* its own */\n");
	if (held_leads(e))
		say(e, "    pl_lead lead[%d];     /* what phases have gained where $n_use changed frequencies */\n",
		    held_leads(e));
}

void emit_nominal_factors(const struct emitter *e)
{
	if (held(e) || e->kind->own_factors)
		say(e, "    s->coeffs = $n_nominal;\n");
}

void emit_held_declarations(const struct emitter *e)
{
	if (!held(e))
		return;
	const char *more = !e->model->retuned ? "" :
		format("; PL_SINGULAR: a divisor is 0, as a mass is;\n"
		       " * PL_OUT_OF_RANGE: a restitution is not within 0 and 1, a gap or a force of friction below\n"
		       " * 0, breakpoints change their order, or a pole times h is above 2^%d", LIMIT_PIECES);
	say(e, "\n/* Sets c to params (%s), for steps of the spec's h alone [s]. 0, or c is as it was and\n"
	       " * PL_NO_STEP: h is not $N_H; PL_NOT_FINITE: a param%s is not a number, or infinite%s */\n",
	    param_list(e), e->model->retuned ? ", or a number of it," : "", more);
	say(e, "int    $n_retune($n_coeffs *c, const double params[$N_PARAMS], double h);\n"
	       "void   $n_use($n *s, const $n_coeffs *c);  /* from now on; state and time stay%s%s */\n"
	       "extern const $n_coeffs $n_nominal;         /* of the spec's values: what $n_init starts with */\n\n",
	    held_leads(e) ? ", and phases of sines in t" : "", has_place(e) ? "; the scheme starts anew" : "");
}

void banner_held(const struct emitter *e)
{
	const bool acts = e->system->inputs > e->model->spec->inputs;
	if (e->model->retuned) {
		say(e, " * Tunable: %s. An instance has the tables of its regions, %d numbers of matrices, which\n"
		       " * $n_retune computes from other values on the target; of the spec's values they are these, "
		       "correctly rounded. It\n"
		       " * needs as much stack as they take, and some %d KB.\n", param_list(e), retuned_numbers(e),
		    retuned_kilobytes(e));
		return;
	}
	if (held(e))
		say(e, " * Tunable: %s. %s\n", param_list(e),
		    acts ? "They act like held inputs, with the instance's own values."
			 : "Expressions read the instance's own values; operators, orders and choices are those of the "
			   "spec's.");
}

void emit_held_nominal(const struct emitter *e)
{
	if (!held(e) || e->model->retuned)
		return;                         /* with the tables of regions */
	emit_nominal_of(e, emit_nominal_params);
}

/* Angular frequencies of the sines that have a lead */
static void emit_frequencies(const struct emitter *e)
{
	const struct form **rate = ARRAY(const struct form *, (size_t)held_leads(e));
	for (int k = 0; k < held_leads(e); k++)
		rate[k] = e->model->leads.lead[k].rate;
	const struct reads reads = reads_of(e->model, held_leads(e), rate);
	open_function(e, "Of sines, as params have them [rad/s]",
		      "static void $n_frequencies(const $n *s, double slope[%d])", held_leads(e));
	emit_param_locals(e, reads.param);
	for (int i = 0; i < e->system->inputs; i++)
		if (reads.input[i])
			say(e, "    const double %s = %s;\n", input_name(e, i, 0), sample_kept(e, i));
	struct formulas *f = formulas_new(e, (struct reading){ 0 }, held_leads(e), rate);
	for (int k = 0; k < held_leads(e); k++)
		tape_set(formulas_tape(f), format("slope[%d]", k), formula(f, rate[k]), 15, NULL);
	emit_formulas(f, 4);
	close_function(e, "");
}

void emit_held_retune(const struct emitter *e)
{
	if (!held(e))
		return;
	if (e->model->retuned)
		emit_retuned(e);
	if (held_leads(e))
		emit_frequencies(e);
	const struct size sizes[] = {
		{ "PARAMS", held(e)->params }, { "RETUNED", e->model->retuned != NULL }, { "LEADS", held_leads(e) },
		{ "MODES", e->step->normal ? e->step->normal->modes : 0 }, { "PLACES", has_place(e) }
	};
	emit_sizes(e, sizeof sizes / sizeof *sizes, sizes);
	say(e, "#include \"held.h\"\n");
}
