/* SPDX-License-Identifier: GPL-3.0-or-later */
/* init, set, get, time, status, hold. */
#include "emit/emit.h"

static void emit_initial_values(const struct emitter *e, const struct model *model)
{
	mpq_t *value = model->initial;
	for (int i = 0; i < e->system->states; i++)
		say(e, "%s%s", i ? ", " : "", shortest(round_rational(value[i])));
	say(e, "};");
}

/* The tables are read through pointers whose value no compiler knows: with AVX-512, gcc 12 copies a table that it knows
 * by wide constants, and of {1, 1, 0, 0} it makes {1, 1, 1, 1}. */
static void emit_init(const struct emitter *e)
{
	const struct model *model = e->model;
	bool relative = model->relative;
	open_function(e, NULL, "void $n_init($n *s)");
	say(e, "    static const double start[$N_STATES] = {");
	emit_initial_values(e, model);
	if (relative) {
		say(e, "  /* %s */\n"
		       "    static const double set[$N_STATES] = {", state_list(model));
		emit_initial_values(e, model->written);
	}
	say(e, "\n"
	       "    const double *volatile from = start%s;  /* not known: gcc 12 errs as it copies a known table */\n",
	    relative ? ", *volatile whole = set" : "");
	emit_nominal_factors(e);
	for (int i = 0; i < given_inputs(e); i++) {
		say(e, "    s->u[%d] = 0.0;\n", i);
		if (e->ramps)
			say(e, "    s->slope[%d] = 0.0;\n", i);
		for (int c = 0; c < e->system->input[i].hold && e->system->input[i].hold > 1; c++)
			say(e, "    s->past[%d][%d] = 0.0;\n", i, c);
	}
	say(e, "    $n_%s, from);\n", relative ? "begin(s, 0.0, whole" : "set(s, 0.0");
	close_function(e, "");
}

/* ---- set ---- */

/* A state at the place of s->y: what else of the instance follows from it and from t */
static void emit_rest_of_state(const struct emitter *e)
{
	say(e, "    s->t0 = t;\n"
	       "    s->k = 0;\n");
	if (keeps_status(e))
		say(e, "    s->status = 0;\n");
	emit_load_set(e);
	emit_held_set(e);
	if (e->step->anchors)
		say(e, "    s->since = 0;\n"
		       "    $n_drop_anchor(s);\n");
	if (e->system->segments > 1)
		say(e, "    for (s->segment = 0; s->segment < %d && $n_until(s, s->segment) <= 1e-18 * %s;)\n"
		       "        s->segment++;\n", e->system->segments - 1, step_length(e));
	if (e->step->forced)
		emit_set_forced_state(e, e->model->relative ? "x" : "y", "    ");
	emit_peak_set(e);
	if (e->kind->places && e->kind->places(e))
		say(e, "    $n_place(s);\n");
	close_function(e, "");
}

static void emit_set_as_written(const struct emitter *e)
{
	emit_init(e);
	if (e->step->forced)
		emit_forced(e);
	open_function(e, NULL, "void $n_set($n *s, double t, const double y[$N_STATES])");
	say(e, "    int i;\n");
	if (e->step->forced)
		say(e, "    double now[$N_STATES];\n");
	else
		emit_set_state(e, "y", "    ");
	emit_rest_of_state(e);
}

/* What is kept has been rounded to momenta: its gains count from there. */
static void emit_origin_of_momenta(const struct emitter *e)
{
	for (int i = 0; i < e->system->states; i++)
		if (factor_of_momentum(e, i))
			say(e, "    s->from[%d] = s->y[%d] / %s;\n", i, i, factor_of_momentum(e, i));
}

static void emit_set_over_relative(const struct emitter *e)
{
	emit_conversions(e);
	if (e->step->forced)
		emit_forced(e);
	open_function(e, "From the states as written, and as they are kept",
		      "static void $n_begin($n *s, double t, const double y[$N_STATES], const double x[$N_STATES])");
	say(e, "    int i;\n");
	if (e->step->forced)
		say(e, "    double now[$N_STATES];\n");
	say(e, "    for (i = 0; i < $N_STATES; i++) {\n"
	       "        s->set[i] = y[i];\n"
	       "        s->from[i] = x[i];\n"
	       "    }\n");
	if (!e->step->forced) {
		emit_set_state(e, "x", "    ");
		emit_origin_of_momenta(e);
	}
	emit_rest_of_state(e);
	emit_init(e);
	open_function(e, NULL, "void $n_set($n *s, double t, const double y[$N_STATES])");
	say(e, "    double x[$N_STATES];\n"
	       "    $n_keep(y, x);\n"
	       "    $n_begin(s, t, y, x);\n");
	close_function(e, "");
}

/* ---- get ---- */

static void emit_get_itself(const struct emitter *e)
{
	bool relative = e->model->relative != NULL;
	open_function(e, NULL, "void $n_get(const $n *s, double y[$N_STATES])");
	say(e, "    int i;\n%s", relative ? spell(e, "    double x[$N_STATES];\n") : "");
	emit_get_state(e, relative ? "x" : "y");
	if (relative)
		say(e, "    $n_written(s, x, y);\n");
	close_function(e, "");
}

/* Outputs read what is kept, its forced part added, too: a function of its own */
static void emit_get_over_forced(const struct emitter *e)
{
	open_function(e, "The states as they are kept, their forced part added",
		      "static void $n_kept(const $n *s, double x[$N_STATES])");
	say(e, "    int i;\n");
	emit_get_state(e, "x");
	close_function(e, "");
	open_function(e, NULL, "void $n_get(const $n *s, double y[$N_STATES])");
	say(e, "    double x[$N_STATES];\n"
	       "    $n_kept(s, x);\n"
	       "    $n_written(s, x, y);\n");
	close_function(e, "");
}

/* ---- time, status, hold ---- */

/* k h: of the spec's step p/q, with p and q exact, it is one rounding away from the exact time while k p < 2^53. */
static const char *elapsed_text(const struct emitter *e)
{
	mpz_srcptr p = mpq_numref(e->model->h), q = mpq_denref(e->model->h);
	size_t bits = mpz_sizeinbase(p, 2), divisor_bits = mpz_sizeinbase(q, 2);
	bool single = e->model->asked.single;
	bool short_fraction = bits <= (single ? 12 : 40) && divisor_bits <= (single ? 24 : 53);
	if (e->kind->own_factors || !short_fraction)
		return format("(double)s->k * %s", step_length(e));
	const char *factor = mpz_cmp_ui(p, 1) == 0 ? "" : format(" * %s", shortest(mpz_get_d(p)));
	const char *divisor = mpz_cmp_ui(q, 1) == 0 ? "" : format(" / %s", shortest(mpz_get_d(q)));
	return format("(double)s->k%s%s", factor, divisor);
}

static void emit_time(const struct emitter *e)
{
	open_function(e, NULL, "double $n_time(const $n *s)");
	say(e, "    return s->t0 + %s;\n", elapsed_text(e));
	close_function(e, "");
}

/* What is not finite is seen in the state now, in both words where it has two: a step has nothing to do for it, and
 * none can pass over it. */
static void emit_status(const struct emitter *e)
{
	bool written = e->step->momenta || e->model->relative;  /* s->y is not the state */
	open_function(e, NULL, "int $n_status(const $n *s)");
	if (written)
		say(e, "    double y[$N_STATES];\n"
		       "    $n_get(s, y);\n");
	say(e, "    return %spl_not_finite(%s, $N_STATES)%s;\n", keeps_status(e) ? "s->status | " : "",
	    written ? "y" : "s->y",
	    e->step->program->compensated ? spell(e, " | pl_not_finite(s->rest, $N_STATES)") : "");
	close_function(e, "");
}

/* ---- ranges that the spec gives ---- */

/* What is not a number has left none: PL_NOT_FINITE tells it. */
static void emit_ranges(const struct emitter *e)
{
	const struct model *written = e->model->written;
	if (!has_ranges(e))
		return;
	open_function(e, "Whether the states are in their ranges: the end of a step", "static void $n_stay($n *s)");
	say(e, "    double y[$N_STATES];\n"
	       "    $n_get(s, y);\n"
	       "    if (");
	for (int i = 0; i < written->ranges; i++) {
		const struct state_range *range = &written->range[i];
		say(e, "%sy[%d] < %s || y[%d] > %s", i ? " ||\n        " : "", range->state,
		    shortest(round_rational(range->low)), range->state, shortest(round_rational(range->high)));
	}
	say(e, ")\n"
	       "        s->status |= PL_LEFT_RANGE;\n");
	close_function(e, "");
}

/* Where an input has several samples before the next */
static void emit_hold_taps(const struct emitter *e)
{
	open_function(e, NULL, "void $n_hold($n *s, const double u[$N_INPUTS])");
	for (int i = 0; i < given_inputs(e); i++)
		if (e->system->input[i].hold > 1)
			emit_next_tap(e, i);
		else
			say(e, "    s->u[%d] = u[%d];\n", i, i);
	close_function(e, "");
}

static void emit_hold(const struct emitter *e)
{
	if (most_taps_before(e)) {
		emit_hold_taps(e);
		return;
	}
	open_function(e, NULL, "void $n_hold($n *s, const double u[$N_INPUTS])");
	say(e, "    int i;\n"
	       "    for (i = 0; i < $N_INPUTS; i++)\n"
	       "        s->u[i] = u[i];\n");
	if (e->kind->places && e->kind->places(e))
		say(e, "    if (s->k == 0u)\n"
		       "        $n_place(s);\n");
	close_function(e, "");
}

void emit_access(const struct emitter *e)
{
	bool relative = e->model->relative != NULL;
	(relative ? emit_set_over_relative : emit_set_as_written)(e);
	(relative && e->step->forced ? emit_get_over_forced : emit_get_itself)(e);
	emit_time(e);
	emit_status(e);
	emit_ranges(e);
	if (e->ramps)
		emit_hold(e);
}
