/* SPDX-License-Identifier: GPL-3.0-or-later */
/* init, set, get, time, status. */
#include "emit/emit.h"

static void emit_values(const struct emitter *e, const mpq_t *value)
{
	for (int i = 0; i < e->system->states; i++)
		say(e, "%s%s", i ? ", " : "", shortest(round_rational(value[i])));
	say(e, "};");
}

static void emit_init(const struct emitter *e)
{
	say(e, "\nvoid $n_init($n *s)\n"
	       "{\n"
	       "    static const double start[$N_STATES] = {");
	emit_values(e, (const mpq_t *)e->model->initial);
	if (e->model->relative) {
		say(e, "  /* %s */\n"
		       "    static const double set[$N_STATES] = {", state_list(e->model));
		emit_values(e, (const mpq_t *)e->model->written->initial);
	}
	say(e, "\n");
	if (e->model->tuning)
		say(e, "    s->coeffs = $n_nominal;\n");
	for (int i = 0; i < e->system->inputs; i++) {
		say(e, "    s->u[%d] = 0.0;\n", i);
		if (e->ramps)
			say(e, "    s->slope[%d] = 0.0;\n", i);
	}
	say(e, "    $n_%s, start);\n"
	       "}\n", e->model->relative ? "begin(s, 0.0, set" : "set(s, 0.0");
}

/* t0 + k p/q with p and q exact is one rounding away from the exact time while k p < 2^53. */
static void emit_time(const struct emitter *e)
{
	if (e->model->tuning) {
		say(e, "\ndouble $n_time(const $n *s)\n"
		       "{\n"
		       "    return s->t0 + (double)s->k * s->coeffs.h;\n"
		       "}\n");
		return;
	}
	mpz_srcptr p = mpq_numref(e->model->h), q = mpq_denref(e->model->h);
	bool short_fraction = e->model->asked.single ? mpz_sizeinbase(p, 2) <= 12 && mpz_sizeinbase(q, 2) <= 24 : mpz_sizeinbase(p, 2) <= 40 && mpz_sizeinbase(q, 2) <= 53;
	const char *factor = mpz_cmp_ui(p, 1) == 0 ? "" : format(" * %s", shortest(mpz_get_d(p)));
	const char *divisor = mpz_cmp_ui(q, 1) == 0 ? "" : format(" / %s", shortest(mpz_get_d(q)));
	say(e, "\ndouble $n_time(const $n *s)\n"
	       "{\n"
	       "    return s->t0 + (double)s->k%s%s;\n"
	       "}\n", short_fraction ? factor : spell(e, " * $N_H"), short_fraction ? divisor : "");
}

/* Of a linear model from its state, in both words where it has two: a step has nothing to do for it. */
static void emit_status(const struct emitter *e)
{
	bool written = e->step->momenta || e->model->relative;  /* s->y is not the state */
	say(e, "\nint $n_status(const $n *s)\n"
	       "{\n");
	if (keeps_status(e)) {
		say(e, "    return s->status;\n"
		       "}\n");
		return;
	}
	if (written)
		say(e, "    double y[$N_STATES];\n"
		       "    $n_get(s, y);\n");
	say(e, "    return pl_not_finite(%s, $N_STATES)%s;\n"
	       "}\n", written ? "y" : "s->y",
	       e->step->program->compensated ? spell(e, " | pl_not_finite(s->rest, $N_STATES)") : "");
}

void emit_access(const struct emitter *e)
{
	const char *kept = e->model->relative ? "x" : "y";
	if (e->model->relative)
		emit_conversions(e);
	else
		emit_init(e);
	if (e->step->forced)
		emit_forced(e);
	if (e->model->relative)
		say(e, "\n/* From the states as written, and as they are kept */\n"
		       "static void $n_begin($n *s, double t, const double y[$N_STATES], const double x[$N_STATES])\n"
		       "{\n"
		       "    int i;\n");
	else
		say(e, "\nvoid $n_set($n *s, double t, const double y[$N_STATES])\n"
		       "{\n"
		       "    int i;\n");
	if (e->step->forced)
		say(e, "    double now[$N_STATES];\n");
	if (e->model->relative)
		say(e, "    for (i = 0; i < $N_STATES; i++) {\n"
		       "        s->set[i] = y[i];\n"
		       "        s->from[i] = x[i];\n"
		       "    }\n");
	if (!e->step->forced)
		emit_set_state(e, kept, "    ");
	for (int i = 0; i < e->system->states; i++)
		if (e->model->relative && !e->step->forced && factor_of_momentum(e, i))
			say(e, "    s->from[%d] = s->y[%d] / %s;\n", i, i, factor_of_momentum(e, i));
	say(e, "    s->t0 = t;\n"
	       "    s->k = 0;\n");
	if (keeps_status(e))
		say(e, "    s->status = 0;\n");
	emit_load_set(e);
	if (e->system->segments > 1)
		say(e, "    for (s->segment = 0; s->segment < %d && $n_until(s, s->segment) <= 1e-18 * %s;)\n"
		       "        s->segment++;\n", e->system->segments - 1, step_length(e));
	if (e->step->forced)
		emit_set_forced_state(e, kept, "    ");
	if (e->model->switching)
		say(e, "    $n_place(s);\n");
	say(e, "}\n");
	if (e->model->relative) {
		emit_init(e);
		say(e, "\nvoid $n_set($n *s, double t, const double y[$N_STATES])\n"
		       "{\n"
		       "    double x[$N_STATES];\n"
		       "    $n_keep(y, x);\n"
		       "    $n_begin(s, t, y, x);\n"
		       "}\n");
	}
	bool apart = e->model->relative && e->step->forced; /* outputs read it too */
	if (apart) {
		say(e, "\n/* The states as they are kept, their forced part added */\n"
		       "static void $n_kept(const $n *s, double x[$N_STATES])\n"
		       "{\n"
		       "    int i;\n");
		emit_get_state(e, "x");
		say(e, "}\n");
	}
	say(e, "\nvoid $n_get(const $n *s, double y[$N_STATES])\n"
	       "{\n"
	       "%s", apart ? "" : "    int i;\n");
	if (e->model->relative)
		say(e, "    double x[$N_STATES];\n");
	if (apart)
		say(e, "    $n_kept(s, x);\n");
	else
		emit_get_state(e, kept);
	if (e->model->relative)
		say(e, "    $n_written(s, x, y);\n");
	say(e, "}\n");
	emit_time(e);
	emit_status(e);
	if (e->ramps)
		say(e, "\nvoid $n_hold($n *s, const double u[$N_INPUTS])\n"
		       "{\n"
		       "    int i;\n"
		       "    for (i = 0; i < $N_INPUTS; i++)\n"
		       "        s->u[i] = u[i];\n"
		       "%s}\n", e->model->switching ? spell(e, "    if (s->k == 0)\n        $n_place(s);\n") : "");
}
