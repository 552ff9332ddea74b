/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a header has: the struct of the state, the functions. */
#include "emit/emit.h"

/* One declaration, its comment at a common column. */
static void declare(const struct emitter *e, const char *text, const char *comment)
{
	fprintf(e->to, *comment ? "%-76s  /* %s */\n" : "%s\n", text, comment);
}

static void emit_state_struct(const struct emitter *e)
{
	FILE *to = e->to;
	if (e->model->tuning)
		emit_coefficient_struct(e);
	fprintf(to, "typedef struct %s %s;  /* copy it to save, assign it to restore */\n", e->name, e->name);
	fprintf(to, "struct %s {\n    double y[%s_STATES];  /* %s%s%s */\n", e->name, e->upper, state_list(e->model),
		e->step->momenta ? format("; velocities times mass / mass of %s", e->model->coord_name[0]) : "", e->step->forced ? "; less their forced part" : "");
	if (e->step->program->compensated)
		fprintf(to, "    double rest[%s_STATES];  /* what rounding took from y so far */\n", e->upper);
	else if (e->step->forced)
		fprintf(to, "    double rest[%s_STATES];  /* what rounding took from y at the last set */\n", e->upper);
	if (e->step->carries)
		fprintf(to, "    double carry[%d];      /* what rounding took from %s so far */\n", e->step->carries, carried_text(e));
	if (e->model->relative)
		fprintf(to, "    double set[%s_STATES], from[%s_STATES];  /* at the last set: the states as written, and as they are kept */\n", e->upper, e->upper);
	if (e->model->tuning)
		fprintf(to, "    %s_coeffs coeffs;    /* its own */\n", e->name);
	if (e->system->inputs)
		fprintf(to, "    double u[%s_INPUTS];  /* the last sample */\n", e->upper);
	if (e->ramps)
		fprintf(to, "    double slope[%s_INPUTS];  /* of the inputs over the last step [1/s] */\n", e->upper);
	emit_load_members(e);
	if (e->system->segments > 1)
		fputs("    int segment;          /* of time: how many changes of the loads are past */\n", to);
	fputs("    double t0;            /* [s]; time is t0 + k h */\n    uint64_t k;           /* steps since then */\n", to);
	if (e->model->switching)
		emit_region_members(e);
	if (keeps_status(e))
		fputs("    int status;           /* sticky: 0, or what pl_status names */\n", to);
	fputs("};\n\n", to);
}

static void emit_functions(const struct emitter *e, bool rhs)
{
	const char *n = e->name, *N = e->upper;
	const char *u = e->system->inputs ? format(", const double u[%s_INPUTS]", N) : "";
	bool inputs = e->system->inputs > 0;
	declare(e, format("void   %s_init(%s *s);", n, n), e->model->tuning ? "first: t = 0, the spec's initial values and coefficients" : "t = 0, the spec's initial values");
	declare(e, format("void   %s_set(%s *s, double t, const double y[%s_STATES]);", n, n, N), "any state at any time [s]");
	declare(e, format("void   %s_get(const %s *s, double y[%s_STATES]);", n, n, N), "");
	declare(e, format("double %s_time(const %s *s);", n, n), "[s]");
	declare(e, format("int    %s_status(const %s *s);", n, n), e->model->switching ? "0, or bits: PL_NOT_FINITE, PL_TOO_MANY_EVENTS"
		: has_leftover(e->step) ? "0, or PL_NOT_FINITE once a step has left the finite numbers"
		: "0, or PL_NOT_FINITE: a state is infinite or not a number");
	if (e->model->switching)
		emit_region_declarations(e);
	if (e->ramps)
		declare(e, format("void   %s_hold(%s *s, const double u[%s_INPUTS]);", n, n, N), "the previous sample");
	declare(e, format("void   %s_step(%s *s%s);", n, n, u), !inputs ? "one step of h" : e->ramps ? "one step of h; a ramp ends at u" : "one step of h with u held");
	declare(e, format("void   %s_out(const %s *s, double out[%s_OUTPUTS]);", n, n, N), "outputs now");
	declare(e, format("void   %s_run(%s *s, size_t n, %sdouble *out);", n, n, inputs ? "const double *u, " : ""),
		inputs ? "n steps, n rows of u; out: n rows, or NULL" : "n steps; out: n rows of outputs, or NULL");
	if (e->step->series.emitted)
		declare(e, format("void   %s_at(const %s *s%s, double tau, double y[%s_STATES]);", n, n, u, N), "tau after now, 0 <= tau <= h");
	if (has_jump(e))
		declare(e, format("void   %s_jump(%s *s, uint64_t n);", n, n), "as n steps would, in log n time");
	if (e->model->tuning)
		emit_tuning_declarations(e);
	if (rhs)
		declare(e, format("void   %s_rhs(double t, const double y[], %sdouble dydt[]);", n, inputs ? "const double u[], " : ""),
			e->model->reduction.place ? format("as written; y: all %d written states", e->model->written->system.states)
			: e->ramps ? "as written; u: inputs, then their slopes" : "the equations as written");
	if (e->model->asked.selftest)
		declare(e, format("double %s_selftest(void);", n), "largest deviation from the closed form, in units in the last place");
	declare(e, format("extern const double %s_Phi[%s_STATES][%s_STATES];", n, N, N), "y(t+h) = Phi y(t) + ...");
	if (inputs)
		declare(e, format("extern const double %s_Gamma[%s_STATES][%d];", n, N, input_columns(e->system)),
			e->ramps ? "... + Gamma u; of a ramp: before, after" : "... + Gamma u");
	declare(e, format("extern const pl_model %s_model;", n), "");
}

void emit_declarations(const struct emitter *e, bool rhs)
{
	FILE *to = e->to;
	const char *N = e->upper;
	fprintf(to, "#ifndef %s_DECLARED\n#define %s_DECLARED\n\n%s#include \"plrt.h\"\n\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n", N, N,
		e->model->asked.single ? "#define PL_FLOAT_ONLY\n" : "");
	fprintf(to, "enum { %s_STATES = %d, %s_INPUTS = %d, %s_OUTPUTS = %d };\n", N, e->system->states, N, e->system->inputs, N, e->model->outputs);
	if (e->model->switching)
		fprintf(to, "enum { %s_MAX_EVENTS = %d };  /* crossings in a step */\n", N, MAX_EVENTS);
	fprintf(to, "#define %s_H %s  /* step [s] */\n\n", N, shortest(round_rational(e->model->h)));
	emit_state_struct(e);
	emit_functions(e, rhs);
	fputs("\n#ifdef __cplusplus\n}\n#endif\n\n#endif\n", to);
}
