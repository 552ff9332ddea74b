/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a model has of params that an instance holds: types, retune. */
#include "inner.h"
#include "emit/formulas.h"
#include "emit/regions/regions.h"
#include "model/reads.h"
#include "step/exponential/normal.h"
#include "step/regions/regions.h"
#include "step/tunable/tuned.h"

static const struct tuning *held(const struct emitter *e)
{
	return e->model->params.held;
}

int held_leads(const struct emitter *e)
{
	return e->model->params.held ? e->model->params.leads.count : 0;
}

/* What an instance has */
static void emit_members(const struct emitter *e)
{
	if (e->step->is.tuned)
		emit_tuned_members(e);
	else
		(e->model->params.retuned ? emit_retuned_numbers : emit_nominal_params)(e);
}

void emit_held_types(const struct emitter *e)
{
	if (!tunables_of(e->model))
		return;
	const char *what = e->model->params.held ? "What the equations and outputs read"
			   : format("Factors of a step by z: states, load states%s, inputs%s",
				    loads_change(e->system) ? " in each segment of time" : "",
				    e->ramps ? ", of a ramp its value before the step, then after it" : "");
	say(e, "enum { $N_PARAMS = %d };  /* tunable: %s */\n"
	       "/* %s */\n"
	       "typedef struct $n_coeffs $n_coeffs;\n"
	       "struct $n_coeffs {\n", tunables_of(e->model)->given, param_list(e), what);
	declare_members(e, emit_members);
	say(e, "};\n"
	       "\n");
}

void emit_held_member(const struct emitter *e)
{
	if (held(e))
		say(e, "    $n_coeffs coeffs;    /* coefficients of this instance */\n");
	if (held_leads(e))
		say(e, "    pl_lead lead[%d];     /* what phases have gained where $n_use changed frequencies */\n",
		    held_leads(e));
}

void emit_nominal_factors(const struct emitter *e)
{
	if (tunables_of(e->model))
		say(e, "    s->coeffs = $n_nominal;\n");
}

void emit_held_declarations(const struct emitter *e)
{
	if (!tunables_of(e->model))
		return;
	const bool own = e->step->is.tuned, any = own && e->step->blocks->full;
	const char *more = own ? e->model->params.tuning->frequencies ? ", PL_SINGULAR, PL_NO_RATE" : ", PL_SINGULAR"
			       : e->model->params.retuned ? ", PL_SINGULAR, PL_OUT_OF_RANGE" : "";
	const char *ranged = has_param_ranges(e) && !e->model->params.retuned ? ", PL_OUT_OF_RANGE" : "";
	say(e, "\n/* Sets c to params (%s), for steps of h [s]%s. 0, or c is as it was and, as plrt.h\n"
	       " * says, PL_NO_STEP%s%s, PL_NOT_FINITE */\n", param_list(e), any ? "" : ", the spec's", more, ranged);
	say(e, "int    $n_retune($n_coeffs *c, const double params[$N_PARAMS], double h);\n"
	       "void   $n_use($n *s, const $n_coeffs *c);  /* from now on; state and time stay%s%s */\n"
	       "extern const $n_coeffs $n_nominal;         /* of the spec's values: what $n_init starts with */\n\n",
	    held_leads(e) || e->phases ? ", and phases go on" : "", has_place(e) ? "; the scheme starts anew" : "");
}

static void banner_blocks(const struct emitter *e)
{
	const struct tuned_blocks *p = e->step->blocks;
	if (!p->solved)
		say(e, "They touch %s independent blocks, and factors of the others stay.\n"
		       " * ",
		    p->touched == p->all ? format("all %d", p->all) : format("%d of %d", p->touched, p->all));
	say(e, "$n_retune computes factors from other values%s on the\n"
	       " * target; those of the spec's values are correctly rounded. It needs some %d KB of stack.\n",
	    p->full ? " and another h" : "", p->kilobytes);
}

void banner_held(const struct emitter *e)
{
	const bool acts = e->system->inputs > e->model->spec->count.inputs;
	if (!tunables_of(e->model))
		return;
	say(e, " * Tunable: %s. ", param_list(e));
	if (e->step->is.tuned)
		banner_blocks(e);
	else if (e->model->params.retuned)
		say(e, "An instance has the tables of its regions, %d numbers of matrices, which\n"
		       " * $n_retune computes from other values on the target; of the spec's values they are these, "
		       "correctly rounded. It\n"
		       " * needs as much stack as they take, and some %d KB.\n", retuned_numbers(e),
		    retuned_kilobytes(e));
	else
		say(e, "%s\n",
		    acts ? "They act like held inputs, with the instance's own values."
			 : "Expressions read the instance's own values; operators, orders and choices are those of the "
			   "spec's.");
}

void emit_nominal(const struct emitter *e)
{
	if (tunables_of(e->model))
		emit_nominal_of(e, emit_members);
}

/* Angular frequencies of the sines that have a lead */
static void emit_frequencies(const struct emitter *e)
{
	const struct form **rate = ARRAY(const struct form *, (size_t)held_leads(e));
	for (int k = 0; k < held_leads(e); k++)
		rate[k] = e->model->params.leads.lead[k].rate;
	const struct reads reads = reads_of(e->model, held_leads(e), rate);
	open_function(e, "Frequencies of loads from params [rad/s]",
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

/* Beside regions: what of the params varies with what each derivative is by */
static void emit_varied_params(const struct emitter *e)
{
	const struct derivatives *d = e->step->derivatives;
	const int given = held(e)->given, derived = e->model->spec->tuned.derived;
	struct formulas *f = formulas_new(e, (struct reading){ 0 }, derived, e->model->params.derived);
	struct tape *t = formulas_tape(f);
	bool *reads = ARRAY(bool, (size_t)held_values(e->model) + 1);
	open_function(e, NULL, "static void $n_vary_params(const double y[], double by[$N_D][%d])", given + derived);
	for (int p = 0; p < d->columns; p++)
		for (int k = 0; k < given + derived; k++) {
			const int by = tunable_of_column(e->step, p);
			const tape_ref slope = k < given || by < 0
				? tape_number(t, by == k)
				: tape_forward(t, formula(f, e->model->params.derived[k - given]), TAPE_PARAM, by, 0);
			tape_set(t, format("by[%d][%d]", p, k), slope, 15, NULL);
		}
	tape_mark(t, TAPE_PARAM, 0, reads);
	for (int k = 0; k < given; k++)
		if (reads[k])
			say(e, "    const double %s = y[%d];\n", param_local(e, k), k);
	emit_formulas(f, 4);
	close_function(e, "y");
}

static void emit_held(const struct emitter *e)
{
	if (varies_params(e))
		emit_varied_params(e);
	if (e->model->params.retuned)
		emit_retuned(e);
	if (held_leads(e))
		emit_frequencies(e);
	emit_sizes(e, "held.h", { "PARAMS", held(e)->params }, { "WRAPPED", wraps_retune(e) },
		   { "RETUNED", e->model->params.retuned != NULL },
		   { "LEADS", held_leads(e) },
		   { "MODES", keeps_modes(e) ? e->step->normal->modes : 0 }, { "PLACES", has_place(e) });
	say(e, "#include \"held.h\"\n");
}

static void emit_derive(const struct emitter *e)
{
	const int derived = e->model->spec->tuned.derived, given = tunables_of(e->model)->given;
	const struct reads reads = reads_of(e->model, derived, e->model->params.derived);
	open_function(e, "Numbers that follow from params", "static void $n_derive(const double y[], double out[])");
	for (int k = 0; k < given; k++)
		if (reads.param[k])
			say(e, "    const double %s = y[%d];\n", param_local(e, k), k);
	struct formulas *f = formulas_new(e, (struct reading){ 0 }, derived, e->model->params.derived);
	for (int k = 0; k < derived; k++)
		tape_set(formulas_tape(f), format("out[%d]", k), formula(f, e->model->params.derived[k]), 13, NULL);
	emit_formulas(f, 4);
	close_function(e, "");
}

/* Bounds are rounded as values are, so a param that is at one in the spec is within. */
static void emit_range_checks(const struct emitter *e)
{
	const struct tuning *t = tunables_of(e->model);
	for (int k = 0; k < t->given; k++) {
		const struct param_range *range = e->model->params.range[k];
		const struct place at = t->param[k].at;
		if (!range)
			continue;
		say(e, "    if (!(params[%d] >= %s && params[%d] <= %s)) {\n", k, finite_text(at, range->low), k,
		    finite_text(at, range->high));
		say(e, "        return PL_OUT_OF_RANGE;  /* %s */\n"
		       "    }\n", t->param[k].symbol->name);
	}
}

/* NAME_retune of the params that are given, within their ranges, by that of all */
static void emit_wrapper(const struct emitter *e)
{
	const int derived = e->model->spec->tuned.derived;
	if (derived)
		emit_derive(e);
	say(e, "\nint $n_retune($n_coeffs *c, const double params[$N_PARAMS], double h)\n"
	       "{\n");
	if (derived)
		say(e, "    double all[$N_PARAMS + %d];\n"
		       "    int i;\n", derived);
	emit_range_checks(e);
	if (derived)
		say(e, "    for (i = 0; i < $N_PARAMS; i++) {\n"
		       "        all[i] = params[i];\n"
		       "    }\n"
		       "    $n_derive(params, all + $N_PARAMS);\n");
	say(e, "    return $n_retune_all(c, %s, h);\n"
	       "}\n", derived ? "all" : "params");
}

void emit_held_retune(const struct emitter *e)
{
	if (e->step->is.tuned)
		emit_retune(e);
	if (held(e))
		emit_held(e);
	if (tunables_of(e->model) && wraps_retune(e))
		emit_wrapper(e);
}
