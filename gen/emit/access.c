/* SPDX-License-Identifier: GPL-3.0-or-later */
/* init, set, get, time, status. */
#include "emit/emit.h"

static void emit_values(const struct emitter *e, const mpq_t *value)
{
	for (int i = 0; i < e->system->states; i++)
		fprintf(e->to, "%s%s", i ? ", " : "", shortest(round_rational(value[i])));
	fputs("};", e->to);
}

static void emit_init(const struct emitter *e)
{
	fprintf(e->to, "\nvoid %s_init(%s *s)\n{\n    static const double start[%s_STATES] = {", e->name, e->name, e->upper);
	emit_values(e, (const mpq_t *)e->model->initial);
	if (e->model->relative) {
		fprintf(e->to, "  /* %s */\n    static const double set[%s_STATES] = {", state_list(e->model), e->upper);
		emit_values(e, (const mpq_t *)e->model->written->initial);
	}
	fputc('\n', e->to);
	if (e->model->tuning)
		fprintf(e->to, "    s->coeffs = %s_nominal;\n", e->name);
	for (int i = 0; i < e->system->inputs; i++) {
		fprintf(e->to, "    s->u[%d] = 0.0;\n", i);
		if (e->ramps)
			fprintf(e->to, "    s->slope[%d] = 0.0;\n", i);
	}
	fprintf(e->to, e->model->relative ? "    %s_begin(s, 0.0, set, start);\n}\n" : "    %s_set(s, 0.0, start);\n}\n", e->name);
}

/* t0 + k p/q with p and q exact is one rounding away from the exact time while k p < 2^53. */
static void emit_time(const struct emitter *e)
{
	if (e->model->tuning) {
		fprintf(e->to, "\ndouble %s_time(const %s *s)\n{\n    return s->t0 + (double)s->k * s->coeffs.h;\n}\n", e->name, e->name);
		return;
	}
	mpz_srcptr p = mpq_numref(e->model->h), q = mpq_denref(e->model->h);
	bool short_fraction = e->model->asked.single ? mpz_sizeinbase(p, 2) <= 12 && mpz_sizeinbase(q, 2) <= 24 : mpz_sizeinbase(p, 2) <= 40 && mpz_sizeinbase(q, 2) <= 53;
	const char *factor = mpz_cmp_ui(p, 1) == 0 ? "" : format(" * %s", shortest(mpz_get_d(p)));
	const char *divisor = mpz_cmp_ui(q, 1) == 0 ? "" : format(" / %s", shortest(mpz_get_d(q)));
	fprintf(e->to, "\ndouble %s_time(const %s *s)\n{\n    return s->t0 + (double)s->k%s%s;\n}\n", e->name, e->name,
		short_fraction ? factor : format(" * %s_H", e->upper), short_fraction ? divisor : "");
}

/* Of a linear model from its state, in both words where it has two: a step has nothing to do for it. */
static void emit_status(const struct emitter *e)
{
	const char *n = e->name, *N = e->upper;
	bool written = e->step->momenta || e->model->relative;  /* s->y is not the state */
	fprintf(e->to, "\nint %s_status(const %s *s)\n{\n", n, n);
	if (keeps_status(e)) {
		fputs("    return s->status;\n}\n", e->to);
		return;
	}
	if (written)
		fprintf(e->to, "    double y[%s_STATES];\n    %s_get(s, y);\n", N, n);
	fprintf(e->to, "    return pl_not_finite(%s, %s_STATES)%s;\n}\n", written ? "y" : "s->y", N,
		e->step->program->compensated ? format(" | pl_not_finite(s->rest, %s_STATES)", N) : "");
}

void emit_access(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name, *N = e->upper;
	const char *kept = e->model->relative ? "x" : "y";
	if (e->model->relative)
		emit_conversions(e);
	else
		emit_init(e);
	if (e->step->forced)
		emit_forced(e);
	if (e->model->relative)
		fprintf(to, "\n/* From the states as written, and as they are kept */\nstatic void %s_begin(%s *s, double t, const double y[%s_STATES], const double x[%s_STATES])\n"
			    "{\n    int i;\n", n, n, N, N);
	else
		fprintf(to, "\nvoid %s_set(%s *s, double t, const double y[%s_STATES])\n{\n    int i;\n", n, n, N);
	if (e->step->forced)
		fprintf(to, "    double now[%s_STATES];\n", N);
	if (e->model->relative)
		fprintf(to, "    for (i = 0; i < %s_STATES; i++) {\n        s->set[i] = y[i];\n        s->from[i] = x[i];\n    }\n", N);
	if (!e->step->forced)
		emit_set_state(e, kept, "    ");
	for (int i = 0; i < e->system->states; i++)
		if (e->model->relative && !e->step->forced && factor_of_momentum(e, i))
			fprintf(to, "    s->from[%d] = s->y[%d] / %s;\n", i, i, factor_of_momentum(e, i));
	fputs("    s->t0 = t;\n    s->k = 0;\n", to);
	if (keeps_status(e))
		fputs("    s->status = 0;\n", to);
	emit_load_set(e);
	if (e->system->segments > 1)
		fprintf(to, "    for (s->segment = 0; s->segment < %d && %s_until(s, s->segment) <= 1e-18 * %s;)\n        s->segment++;\n",
			e->system->segments - 1, n, step_length(e));
	if (e->step->forced)
		emit_set_forced_state(e, kept, "    ");
	if (e->model->switching)
		fprintf(to, "    %s_place(s);\n", n);
	fputs("}\n", to);
	if (e->model->relative) {
		emit_init(e);
		fprintf(to, "\nvoid %s_set(%s *s, double t, const double y[%s_STATES])\n{\n    double x[%s_STATES];\n    %s_keep(y, x);\n    %s_begin(s, t, y, x);\n}\n",
			n, n, N, N, n, n);
	}
	bool apart = e->model->relative && e->step->forced; /* outputs read it too */
	if (apart) {
		fprintf(to, "\n/* The states as they are kept, their forced part added */\nstatic void %s_kept(const %s *s, double x[%s_STATES])\n{\n    int i;\n", n, n, N);
		emit_get_state(e, "x");
		fputs("}\n", to);
	}
	fprintf(to, "\nvoid %s_get(const %s *s, double y[%s_STATES])\n{\n%s", n, n, N, apart ? "" : "    int i;\n");
	if (e->model->relative)
		fprintf(to, "    double x[%s_STATES];\n", N);
	if (apart)
		fprintf(to, "    %s_kept(s, x);\n", n);
	else
		emit_get_state(e, kept);
	if (e->model->relative)
		fprintf(to, "    %s_written(s, x, y);\n", n);
	fputs("}\n", to);
	emit_time(e);
	emit_status(e);
	if (e->ramps)
		fprintf(to, "\nvoid %s_hold(%s *s, const double u[%s_INPUTS])\n{\n    int i;\n    for (i = 0; i < %s_INPUTS; i++)\n        s->u[i] = u[i];\n%s}\n",
			n, n, N, N, e->model->switching ? format("    if (s->k == 0)\n        %s_place(s);\n", n) : "");
}
