/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tunable params of what is not linear: an instance holds their values, which expressions read where they stand. */
#include "emit/emit.h"

static const struct tuning *held(const struct emitter *e)
{
	return e->model->held;
}

/* ---- in functions ---- */

const char *param_text(int param)
{
	return format("s->coeffs.params[%d]", param);
}

const char *param_local(const struct emitter *e, int param)
{
	return c_name(e->c, e->model->spec->tunable[param].symbol, 0);
}

void emit_param_locals(const struct emitter *e, const bool *reads)
{
	for (int k = 0; k < e->model->spec->tunables; k++)
		if (reads[k])
			say(e, "    const double %s = %s;\n", param_local(e, k), param_text(k));
}

void emit_nominal_params_read(const struct emitter *e, const struct reads *reads)
{
	const struct tuning *t = tunables_of(e->model);
	const int inputs = e->model->spec->inputs;
	for (int k = 0; k < e->model->spec->tunables; k++)
		if (reads->param[k] || (inputs + k < e->system->inputs && reads->input[inputs + k]))
			say(e, "    const double %s = %s;\n", param_local(e, k),
			    finite_text(t->param[k].at, t->nominal[k]));
}

/* ---- the header ---- */

void emit_held_types(const struct emitter *e)
{
	if (!held(e))
		return;
	say(e, "enum { $N_PARAMS = %d };  /* tunable: %s */\n"
	       "typedef struct $n_coeffs $n_coeffs;  /* what the equations and outputs read */\n"
	       "struct $n_coeffs {\n"
	       "    double params[$N_PARAMS];  /* %s */\n"
	       "};\n"
	       "\n", held(e)->params, param_list(e), param_list(e));
}

void emit_held_member(const struct emitter *e)
{
	if (held(e))
		say(e, "    $n_coeffs coeffs;    /* its own */\n");
}

void emit_held_start(const struct emitter *e, const char *s)
{
	if (held(e))
		say(e, "    %scoeffs = $n_nominal;\n", s);
}

static bool starts_anew(const struct emitter *e)
{
	return e->kind->places && e->kind->places(e);
}

void emit_held_declarations(const struct emitter *e)
{
	if (!held(e))
		return;
	say(e, "\n/* Sets c to params (%s), for steps of the spec's h alone [s]. 0, or c is as it was and\n"
	       " *     PL_NO_STEP     h is not $N_H\n"
	       " *     PL_NOT_FINITE  a param is infinite, or not a number */\n"
	       "int    $n_retune($n_coeffs *c, const double params[$N_PARAMS], double h);\n"
	       "\n"
	       "/* From now on with c. State and time stay%s. */\n"
	       "void   $n_use($n *s, const $n_coeffs *c);\n"
	       "\n"
	       "/* Of the spec's values: what $n_init starts with */\n"
	       "extern const $n_coeffs $n_nominal;\n"
	       "\n", param_list(e), starts_anew(e) ? spell(e, "; the scheme starts anew, as after $n_set") : "");
}

void banner_held(const struct emitter *e)
{
	const bool acts = e->system->inputs > e->model->spec->inputs;
	if (held(e))
		say(e, " * Tunable: %s. %s\n", param_list(e),
		    acts ? "They act like held inputs, with the instance's own values."
			 : "Expressions read the instance's own values; operators, orders and choices are those of the spec's.");
}

/* ---- the C ---- */

void emit_held_nominal(const struct emitter *e)
{
	if (!held(e))
		return;
	say(e, "\nconst $n_coeffs $n_nominal = {\n"
	       "    ");
	emit_nominal_params(e);
	say(e, "};\n");
}

void emit_held_retune(const struct emitter *e)
{
	if (!held(e))
		return;
	say(e, "\nint $n_retune($n_coeffs *c, const double params[$N_PARAMS], double h)\n"
	       "{\n"
	       "    int i;\n"
	       "    if (h != $N_H)\n"
	       "        return PL_NO_STEP;\n"
	       "    for (i = 0; i < $N_PARAMS; i++)\n"
	       "        if (params[i] - params[i] != 0.0)\n"
	       "            return PL_NOT_FINITE;\n"
	       "    for (i = 0; i < $N_PARAMS; i++)\n"
	       "        c->params[i] = params[i];\n"
	       "    return 0;\n"
	       "}\n"
	       "\n"
	       "void $n_use($n *s, const $n_coeffs *c)\n"
	       "{\n"
	       "    s->coeffs = *c;\n"
	       "%s}\n", starts_anew(e) ? spell(e, "    $n_place(s);\n") : "");
}

void emit_held_wrapper(const struct emitter *e)
{
	if (held(e))
		emit_tuning_wrapper(e);
}

void emit_params_line(const struct emitter *e)
{
	if (tunables_of(e->model))
		say(e, "    $N_PARAMS, $n_param_names, $n_nominal.params, $n_any_retune,\n");
	else
		say(e, "    0, NULL, NULL, NULL,\n");
}
