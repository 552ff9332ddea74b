/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step program and its tables as C. Everything printed here is meant to be read. */
#include "emit/emit.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

static const char *upper_case(const char *name)
{
	char *upper = format("%s", name);
	for (char *c = upper; *c; c++)
		*c = (char)toupper((unsigned char)*c);
	return upper;
}

/* A load leaves no trace where it acts on nothing and no output shows it. */
struct wave_search {
	const struct wave *wave;
	bool found;
};

static void look_for_wave(void *context, const struct form *form)
{
	struct wave_search *search = context;
	for (int i = 0; i < form->terms; i++)
		search->found = search->found || (form->term[i].basis.kind == BASIS_WAVE && form->term[i].basis.wave == search->wave);
}

static bool load_is_needed(const struct model *model, const struct linear *system, int load)
{
	struct wave_search search = { system->load[load].wave, false };
	visit_leftovers(model, look_for_wave, &search);
	bool needed = search.found || load_acts(system, &system->load[load]);
	for (int o = 0; o < model->outputs; o++) {
		const struct form *left = model->output[o].left;
		needed = needed || (left && reads_of(speaker(model), 1, &left).load[load]);
	}
	for (int x = 0; model->switching && x < model->switching->expressions; x++)
		for (int k = 0; k < system->load[load].columns; k++)
			needed = needed || mpq_sgn(model->switching->expression[x].row->load[load][k]) != 0;
	for (int x = 0; model->switching && x < model->switching->systems; x++)
		needed = needed || load_acts(&model->switching->system[x], &model->switching->system[x].load[load]);
	for (int o = 0; o < model->n; o++)
		for (int k = 0; model->highest && model->highest[o] && k < system->load[load].columns * system->segments; k++)
			needed = needed || mpq_sgn(model->highest[o]->load[load][k]) != 0;
	for (int o = 0; o < model->outputs; o++)
		for (int k = 0; k < system->load[load].columns * system->segments; k++)
			needed = needed || mpq_sgn(model->output[o].load[load][k]) != 0;
	return needed;
}

static struct emitter emitter_new(FILE *to, const struct step *step, const char *options)
{
	struct emitter e = { .to = to, .step = step, .model = step->model, .system = &step->branch->system, .options = options };
	size_t loads = (size_t)e.system->loads;
	e.name = step->model->name;
	e.upper = upper_case(e.name);
	e.phase = ARRAY(int, loads);
	e.growth = ARRAY(int, loads);
	for (size_t l = 0; l < loads; l++) {
		const struct wave *wave = e.system->load[l].wave;
		bool needed = e.model->tuning || load_is_needed(e.model, e.system, (int)l);
		e.phase[l] = needed && oscillates(wave) ? e.phases++ : -1;
		e.growth[l] = needed && mpq_sgn(wave->a) != 0 ? e.growths++ : -1;
	}
	for (int i = 0; i < e.system->inputs; i++)
		e.ramps = e.ramps || e.system->input[i].first_order;
	e.local = ARRAY(const char *, (size_t)e.system->states);
	name_for_c(step->model, e.upper, e.local);
	return e;
}

static bool has_jump(const struct emitter *e)
{
	return e->system->inputs == 0 && !has_leftover(e->step) && !e->model->switching && !e->model->tuning;
}

/* Others look at the state when they are asked. */
static bool keeps_status(const struct emitter *e)
{
	return has_leftover(e->step) || e->model->switching;
}

/* ---- banner ---- */

static const char *printable(const char *text)
{
	char *clean = format("%s", text);
	for (char *c = clean; *c; c++)
		if ((unsigned char)*c < ' ' || *c == 127 || (c > clean && ((c[-1] == '*' && *c == '/') || (c[-1] == '/' && *c == '*'))))
			*c = '?';               /* a comment in an option neither ends nor opens ours */
	return clean;
}

static void banner_equations(const struct emitter *e)
{
	const struct spec *spec = e->model->spec;
	for (int i = 0; i < spec->equations; i++)
		fprintf(e->to, " *     %s\n", text_between(spec->equation[i].at, spec->equation[i].end));
	for (int i = 0; i < spec->elements; i++)
		fprintf(e->to, " *     %s\n", text_between(spec->element[i].at, spec->element[i].end));
}

static void banner_poles(const struct emitter *e)
{
	int length = resolvent_determinant(e->step->written)->length;
	mpq_t *B = rationals((size_t)length);
	characteristic_polynomial(e->step->written, B);
	fprintf(e->to, " *\n *     B(s) = %s\n", polynomial_text(length, (const mpq_t *)B));
	struct pole_report *pole;
	int count = poles_of(e->model, e->step->written, &pole);
	fprintf(e->to, " *     %-34s %-16s damping ratio\n", "pole [1/s]", "frequency [Hz]");
	for (int i = 0; i < count; i++)
		fprintf(e->to, " *     %-34s %-16.8g %.8g\n", pole_text(&pole[i]), mpfr_get_d(pole[i].hertz, MPFR_RNDN),
			mpfr_get_d(pole[i].damping_ratio, MPFR_RNDN));
}

static const char *const scheme_notes[SCHEMES] = {
	[SCHEME_PL] = "Scheme pl, of first order in h: the coupling terms (the other coordinates and their velocities, after\n"
		      " * division by the mass matrix) are held at their value at the start of the step; a coordinate's own terms and\n"
		      " * the loads are exact.",
	[SCHEME_ETD1] = "Scheme etd1, of first order in h: exponential time differencing (Cox and Matthews).",
	[SCHEME_ETDRK2] = "Scheme etdrk2, of second order in h: exponential time differencing (Cox and Matthews).",
	[SCHEME_ETDRK4] = "Scheme etdrk4, of fourth order in h: exponential time differencing (Cox and Matthews).",
	[SCHEME_NC2] = "Scheme nc2, of fourth order in h: precise integration, Simpson's rule on nodes that RK4 predicts.",
	[SCHEME_NC3] = "Scheme nc3, of fourth order in h: precise integration, the 3/8 rule on nodes that RK4 predicts.",
	[SCHEME_DQ4] = "Scheme dq4, of fourth order in h: precise integration, differential quadrature on nodes that RK4 predicts.",
	[SCHEME_BM3] = "Scheme bm3, of fourth order in h: precise integration, a block method on nodes that RK4 predicts."
};

/* One line for each equation that has a leftover, as far as they are few and short */
static void banner_leftover(const struct emitter *e)
{
	enum { SHOWN = 6, WIDTH = 90 };
	const struct model *model = e->step->shown->model;
	const char *at = model->operator[0].text;
	fprintf(e->to, " * y' = A y + loads + inputs + r(t, y). A: the %s%s%s.\n", *at ? "equations' Jacobian at " : model->scheme == SCHEME_PL ? "own terms of each coordinate" : "linear terms with constant coefficients",
		at, e->step->branches > 1 ? format(", and so on: %d operators", e->step->branches) : "");
	fprintf(e->to, " * Exact: A%s; approximated: r, which is\n", model->loads_left ? " and the inputs, each constant correctly rounded" :
		", the loads and the inputs, each constant correctly rounded");
	for (int c = 0; c < model->channels && c < SHOWN; c++) {
		const char *text = form_text(model, model->operator[0].left[c]);
		fprintf(e->to, " *     %.*s%s  in the equation of %s\n", WIDTH, printable(text), strlen(text) > WIDTH ? " ..." : "",
			model->coord_name[coordinate_of_row(model, model->channel_row[c])]);
	}
	if (model->channels > SHOWN)
		fprintf(e->to, " *     and so in %d more equations\n", model->channels - SHOWN);
}

/* Regions, and what each expression is compared with */
static void banner_regions(const struct emitter *e)
{
	const struct model *model = e->step->shown->model;
	const struct switching *s = model->switching;
	fprintf(e->to, " * Scheme exact: nothing is approximated. The equations are piecewise linear: %d regions, %d different, in each of which\n"
		       " * every constant is its closed form, correctly rounded; crossings inside a step are found in order, to rounding.\n",
		possible_regions(s), s->systems);
	for (int i = 0; i < s->expressions; i++) {
		const char *at = "";
		for (int k = 0; k < s->expression[i].breaks; k++)
			at = format("%s%s%s", at, k ? ", " : "", readable_text(s->expression[i].at[k]));
		fprintf(e->to, " *     expression %d: %s, at %s\n", i, printable(form_text(model, s->expression[i].form)), at);
	}
	fputs(" * The poles above are those of the terms that are linear everywhere.\n", e->to);
	fputs(" * A region's number is the sum of its intervals, each times the product of the numbers of intervals before it.\n", e->to);
}

static void banner_scheme(const struct emitter *e)
{
	FILE *to = e->to;
	if (e->model->switching) {
		banner_regions(e);
		return;
	}
	if (e->model->scheme != SCHEME_EXACT)
		fprintf(to, " * %s\n", scheme_notes[e->model->scheme]);
	if (loses_order(e->step->shown->model))
		fprintf(to, " * So where all is smooth; here of order %s at most: %s.\n", order_text(e->step->shown->model), printable(smoothness_text(e->step->shown->model)));
	if (has_leftover(e->step))
		banner_leftover(e);
	else if (e->model->scheme != SCHEME_PL)
		fprintf(to, " * %sothing is approximated; each constant is its closed form, correctly rounded.\n",
			e->model->scheme == SCHEME_EXACT ? "Scheme exact: n" : "Nothing is left over: n");
	if (e->model->scheme == SCHEME_PL)
		fprintf(to, " * Each constant is its closed form, correctly rounded.\n"
			    " * The modified equation of its linear part grows at %.3g 1/s (largest real part of its poles; the poles above are exact).\n",
			mpfr_get_d(e->step->growth, MPFR_RNDN));
}

static void banner_irrationals(const struct emitter *e)
{
	const char *which = irrationals_text(&e->model->irrationals);
	if (*which)
		fprintf(e->to, " * Irrational constants (%s) were taken as rationals of %d bits.\n", which, IRRATIONAL_BITS);
}

static const char *state_list(const struct model *model)
{
	const char *list = "";
	for (int i = 0; i < model->system.states; i++)
		list = format("%s%s%s", list, i ? ", " : "", model->state_name[i]);
	return list;
}

static const char *carried_text(const struct emitter *e)
{
	const char *list = "";
	for (int i = 0; i < e->system->states; i++)
		if (e->step->carry[i] >= 0)
			list = format("%s%s%s", list, *list ? ", " : "", e->model->state_name[i]);
	return list;
}

/* What is kept in the place of positions that only differences of matter */
static void banner_relative(const struct emitter *e)
{
	const struct relative *r = e->model->relative;
	const char *list = "", *centre = "";
	for (int j = 0; j < r->written->n; j++)
		if (r->link[j].kind != LINK_NONE)
			list = format("%s%s%s", list, *list ? ", " : "", r->name[j]);
	for (int j = 0; j < r->written->n; j++)
		for (int k = 0; r->link[j].kind == LINK_CENTRE && k < r->written->n; k++)
			if (mpq_sgn(r->link[j].weight[k]) != 0)
				centre = format("%s%s%s*%s", centre, *centre ? " + " : format("; %s = ", r->name[j]), readable_text(r->link[j].weight[k]),
						r->written->coord_name[k]);
	fprintf(e->to, " * What may move as a whole is kept apart from what moves in it: %s%s.\n", list, centre);
	if (*centre)
		fputs(" * Only loads and inputs act on a centre; nothing that rounds inside changes its velocity.\n", e->to);
}

/* What the form does to rounding, and what rounding has done to its constants */
static void banner_form(const struct emitter *e)
{
	static const char *const kept[STEP_FORMS] = {
		[FORM_DELTA] = "Delta: y += (Phi - I) y, Phi - I rounded relative to itself",
		[FORM_KICK_DRIFT_KICK] = "Kick, drift, kick: p += X q; q += S p; p += X q, S and X symmetric: symplectic whatever their rounding"
	};
	struct drift drift = drift_of(e->step);
	if (kept[e->step->form])
		fprintf(e->to, " * %s%s.\n", kept[e->step->form],
			e->step->program->compensated ? "; factors in two words,\n * and what rounding takes from the state is kept in rest" : "");
	if (e->model->relative)
		banner_relative(e);
	if (e->step->carries)
		fprintf(e->to, " * Nothing leads back from %s: what rounding takes from %s is carried on.\n", carried_text(e), e->step->carries > 1 ? "each" : "it");
	if (drift.known)
		fprintf(e->to, " * %s.\n", drift_text(&drift));
	if (e->step->rounding.known)
		fprintf(e->to, " * %s.\n", rounding_text(e->step));
	if (e->model->asked.single)
		fputs(" * Numbers and arithmetic are float; each constant is rounded to it once.\n", e->to);
}

/* What is left out of the step, and what it costs where it comes back */
static void banner_forced(const struct emitter *e)
{
	const char *list = "";
	int shown = 0;
	for (int l = 0; l < e->system->loads; l++)
		if (e->step->forced->load[l])
			list = shown++ >= 4 ? list
				: format("%s%s%s", list, *list ? ", " : "", column_text(&e->system->load[l], e->system->load[l].columns - 1 - oscillates(e->system->load[l].wave)));
	fprintf(e->to, " * The step would round to what %s%s drive%s: the state is kept less their forced part, which is added where it is\n"
		       " * read (get, out, at): %d multiplications, %d additions.\n", list, shown > 4 ? format(" and %d more loads", shown - 4) : "", shown == 1 ? "s" : "",
		e->step->forced->multiplications, e->step->forced->additions);
}

static void banner_cost(const struct emitter *e)
{
	const struct program *program = e->step->program;
	if (e->model->switching)
		fprintf(e->to, " * A step that stays clear of every breakpoint, in a region whose piece is the step:\n");
	fprintf(e->to, " * One step of h = %s s, form %s: %d multiplications, %d additions", readable_text(e->model->h), form_text_of(e->step),
		program->multiplications, program->additions);
	if (program->wave_multiplications)
		fprintf(e->to, ", %d of them and %d for the functions of the loads", program->wave_multiplications,
			program->wave_additions);
	if (program->calls)
		fprintf(e->to, ", %d calls of the model's own functions", program->calls);
	fputs(".\n", e->to);
	banner_form(e);
	if (e->step->forced)
		banner_forced(e);
	if (e->model->tuning)
		banner_tuning(e);
	fprintf(e->to, " * State y = %s.\n", state_list(e->step->shown->model));
	for (int i = 0; i < e->system->inputs; i++)
		fprintf(e->to, " * Input %s: %s.\n", e->system->input[i].name, e->system->input[i].first_order
			? "a ramp from sample to sample; u is its value at the end of the step" : "held over the step");
	if (e->system->segments > 1)
		fprintf(e->to, " * The loads change their formula %d time%s; a step across a change is exact too, by a series that stops there.\n",
			e->system->segments - 1, e->system->segments > 2 ? "s" : "");
	if (e->model->reduction.dropped)
		fprintf(e->to, " * Reduced to what the outputs can see: %d of %d states.\n", e->system->states, e->model->written->system.states);
	if (has_jump(e) && e->system->states > 12)
		fprintf(e->to, " * %s_jump needs some %d KB of stack.\n", e->name, 1 + 32 * e->system->states * e->system->states / 1024);
	if (!has_jump(e))
		fprintf(e->to, " * There is no %s_jump: %s.\n", e->name, e->model->switching ? "crossings are found step by step" : e->model->tuning ? "retuned coefficients have one word" : has_leftover(e->step) ? "what is left over is not linear in the state"
									  : "the samples to come are not known");
	if (has_leftover(e->step) && !e->step->series.powers)
		fprintf(e->to, " * There is no %s_at: between its steps the scheme has no values of its order.\n", e->name);
	else if (!e->step->series.emitted)
		fprintf(e->to, " * There is no %s_at: the largest |pole| times h is above 8.\n", e->name);
}

static void emit_banner(const struct emitter *e)
{
	fprintf(e->to, "/* %s: made by plgen " PLGEN_VERSION " from %s%s%s; do not edit.\n", e->name, printable(e->model->spec->source->base),
		*e->options ? " with " : "", printable(e->options));
	fputs(" * SPDX-License-Identifier: MIT-0\n *\n", e->to);
	banner_equations(e);
	banner_poles(e);
	fputs(" *\n", e->to);
	banner_scheme(e);
	banner_irrationals(e);
	banner_cost(e);
	fputs(" */\n", e->to);
}

/* ---- declarations ---- */

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

static void emit_declarations(const struct emitter *e, bool rhs)
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

/* ---- sums ---- */

/* ---- init, set, get, time ---- */

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

/* ---- states as written, and as they are kept ---- */

/* The rate of a coordinate, over written values y; or what was gained of it, y being gains */
static const char *rate_text(const struct emitter *e, const struct form *rate, bool whole)
{
	const char **term = ARRAY(const char *, (size_t)rate->terms + 1);
	int terms = 0;
	for (int i = 0; i < rate->terms; i++) {
		const struct basis *basis = &rate->term[i].basis;
		if (basis->kind == BASIS_COORD || whole)
			term[terms++] = scaled(finite_number(e, rate->term[i].factor), basis->kind == BASIS_COORD ? format("y[%d]", basis->index) : NULL);
	}
	return terms > 1 ? format("(%s)", tree(terms, term, 12)) : terms ? term[0] : "0.0";
}

/* What is kept at a coordinate, over the written ones or their velocities, which stand `shift` behind */
static const char *kept_text(const struct emitter *e, const struct link *link, int coord, const int *at)
{
	const struct relative *r = e->model->relative;
	const char **term = ARRAY(const char *, (size_t)r->written->n + 1), *own = format("y[%d]", at[coord]);
	int terms = 0;
	if (link->kind == LINK_PARENT) {
		bool rate = link->rate && coord < r->written->n && at[coord] >= r->written->n;
		const char *from = scaled(finite_number(e, link->ratio), rate ? rate_text(e, link->rate, true) : format("y[%d]", at[link->from]));
		return link->turned ? format("%s - %s", from, own) : format(*from == '-' ? "%s - (%s)" : "%s - %s", own, from);
	}
	for (int k = 0; k < r->written->n && link->kind == LINK_CENTRE; k++)
		if (mpq_sgn(link->weight[k]) != 0)
			term[terms++] = scaled(finite_number(e, link->weight[k]), format("y[%d]", at[k]));
	return link->kind == LINK_CENTRE ? tree(terms, term, 12) : own;
}

/* What the written one has gained since the last set: d is what was gained of what is kept, y of the others so far */
static const char *gain_text(const struct emitter *e, const struct link *link, int coord, const int *at, const int *kept)
{
	const struct relative *r = e->model->relative;
	const char **term = ARRAY(const char *, (size_t)r->written->n + 1);
	int terms = 0;
	if (link->kind == LINK_PARENT && link->rate && at[coord] >= r->written->n)
		return format("%s %c d[%d]", scaled(finite_number(e, link->ratio), rate_text(e, link->rate, false)), link->turned ? '-' : '+', kept[coord]);
	if (link->kind == LINK_PARENT)
		return format("%s %c d[%d]", scaled(finite_number(e, link->ratio), format("y[%d]", at[link->from])), link->turned ? '-' : '+', kept[coord]);
	term[terms++] = format("d[%d]", kept[coord]);
	for (int k = 0; k < r->written->n && link->kind == LINK_CENTRE; k++)
		if (mpq_sgn(link->shift[k]) != 0)
			term[terms++] = scaled(finite_number(e, link->shift[k]), format("d[%d]", kept[k]));
	return tree(terms, term, 12);
}

/* Places of positions (order 0) and velocities in the vector of states, -1: there is none; of velocities that stand alone in `kept` too */
static void find_places(const struct emitter *e, int order, int *at, int *kept)
{
	const struct relative *r = e->model->relative;
	for (int j = 0; j < r->written->n; j++) {
		at[j] = order ? r->written->system.velocity[j] : j;
		kept[j] = !order ? j : r->link[j].velocity >= 0 ? r->link[j].velocity : e->system->velocity[j];
	}
}

static void emit_keep(const struct emitter *e, int order, const int *at, const int *kept)
{
	const struct relative *r = e->model->relative;
	for (int j = 0; j < r->written->n; j++) {
		const struct link plain = { .kind = LINK_NONE }, *link = order && r->link[j].velocity >= 0 ? &plain : &r->link[j];
		if (at[j] >= 0)
			fprintf(e->to, "    x[%d] = %s;  /* %s */\n", kept[j], kept_text(e, link, j, at), e->model->state_name[kept[j]]);
	}
}

/* A coordinate that is measured from another comes after it. */
static void emit_gains(const struct emitter *e, int order, const int *at, const int *kept)
{
	const struct relative *r = e->model->relative;
	int n = r->written->n;
	for (int i = 0; i < n + r->links; i++) {
		int j = i < n ? i : r->sequence[i - n];
		bool alone = order && r->link[j].velocity >= 0, linked = !alone && r->link[j].kind == LINK_PARENT;
		if (at[j] >= 0 && !alone && r->link[j].kind != LINK_NONE && linked == (i >= n))
			fprintf(e->to, "    y[%d] = %s;\n", at[j], gain_text(e, &r->link[j], j, at, kept));
	}
}

/* What is kept as it is written */
static void emit_unlinked(const struct emitter *e, int order, const int *at, const int *kept, bool gains)
{
	const struct relative *r = e->model->relative;
	for (int j = 0; j < r->written->n; j++)
		if (at[j] >= 0 && ((order && r->link[j].velocity >= 0) || r->link[j].kind == LINK_NONE))
			fprintf(e->to, gains ? "    y[%d] = d[%d];\n" : "    y[%d] = x[%d];\n", at[j], kept[j]);
}

/* NAME_keep, NAME_written: a state is what it was at the last set, and what it has gained since; so get gives what set was given. */
static void emit_conversions(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name, *N = e->upper;
	int coords = e->model->relative->written->n, *at = ARRAY(int, 2 * (size_t)coords), *kept = ARRAY(int, 2 * (size_t)coords);
	find_places(e, 0, at, kept);
	find_places(e, 1, at + coords, kept + coords);
	fprintf(to, "\n/* What may move as a whole is kept apart from what moves in it: x, from the states y as written */\n");
	fprintf(to, "static void %s_keep(const double y[%s_STATES], double x[%s_STATES])\n{\n", n, N, N);
	for (int order = 0; order < 2; order++)
		emit_keep(e, order, at + order * coords, kept + order * coords);
	fprintf(to, "}\n\n/* And back: what they were at the last set, and what was gained since */\n");
	fprintf(to, "static void %s_written(const %s *s, const double x[%s_STATES], double y[%s_STATES])\n{\n    double d[%s_STATES];\n    int i;\n", n, n, N, N, N);
	fprintf(to, "    for (i = 0; i < %s_STATES; i++)\n        d[i] = x[i] - s->from[i];\n", N);
	for (int order = 0; order < 2; order++) {
		emit_unlinked(e, order, at + order * coords, kept + order * coords, true);
		emit_gains(e, order, at + order * coords, kept + order * coords);
	}
	fprintf(to, "    for (i = 0; i < %s_STATES; i++)\n        y[i] += s->set[i];\n", N);
	for (int order = 0; order < 2; order++)
		emit_unlinked(e, order, at + order * coords, kept + order * coords, false);
	fputs("}\n", to);
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

static void emit_access(const struct emitter *e)
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
		emit_store(e, kept, "    ");
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
		emit_state_forced(e, kept, "    ");
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
		emit_load_state(e, "x");
		fputs("}\n", to);
	}
	fprintf(to, "\nvoid %s_get(const %s *s, double y[%s_STATES])\n{\n%s", n, n, N, apart ? "" : "    int i;\n");
	if (e->model->relative)
		fprintf(to, "    double x[%s_STATES];\n", N);
	if (apart)
		fprintf(to, "    %s_kept(s, x);\n", n);
	else
		emit_load_state(e, kept);
	if (e->model->relative)
		fprintf(to, "    %s_written(s, x, y);\n", n);
	fputs("}\n", to);
	emit_time(e);
	emit_status(e);
	if (e->ramps)
		fprintf(to, "\nvoid %s_hold(%s *s, const double u[%s_INPUTS])\n{\n    int i;\n    for (i = 0; i < %s_INPUTS; i++)\n        s->u[i] = u[i];\n%s}\n",
			n, n, N, N, e->model->switching ? format("    if (s->k == 0)\n        %s_place(s);\n", n) : "");
}

/* ---- run ---- */

static void emit_run(const struct emitter *e)
{
	bool inputs = e->system->inputs > 0;
	fprintf(e->to, "\nvoid %s_run(%s *s, size_t n, %sdouble *out)\n{\n    for (; n > 0; n--) {\n", e->name, e->name, inputs ? "const double *u, " : "");
	if (inputs)
		fprintf(e->to, "        %s_step(s, u);\n        u += %s_INPUTS;\n", e->name, e->upper);
	else
		fprintf(e->to, "        %s_step(s);\n", e->name);
	fprintf(e->to, "        if (out) {\n            %s_out(s, out);\n            out += %s_OUTPUTS;\n        }\n    }\n}\n", e->name, e->upper);
}

/* ---- tables and descriptor ---- */

static void emit_matrix(const struct emitter *e, const struct step *step, const char *declaration)
{
	int n = e->system->states;
	double *value = ARRAY(double, (size_t)(n * n));
	for (int i = 0; i < n * n; i++)
		value[i] = step->branch->whole->Phi[i].value;
	fprintf(e->to, "\n%s[%s_STATES][%s_STATES] = {  /* columns: %s */\n", declaration, e->upper, e->upper, state_list(step->model));
	emit_number_rows(e, n, n, value, step->model->state_name);
	fputs("};\n", e->to);
}

/* Does a loop of the step read Phi? */
static bool step_reads_phi(const struct emitter *e)
{
	const struct program *program = e->step->program;
	bool reads = !has_leftover(e->step) && e->step->form == FORM_DIRECT;
	for (int i = 0; i < program->actions && has_leftover(e->step); i++)
		reads = reads || program->action[i].flow == 0;
	return reads && program->loops && !e->model->switching;
}

/* Of the states as written; of those that are kept where a function reads it */
static void emit_phi(const struct emitter *e)
{
	emit_matrix(e, e->step->shown, format("const double %s_Phi", e->name));
	if (e->model->relative && (has_jump(e) || step_reads_phi(e)))
		emit_matrix(e, e->step, format("static const double %s", stepped_table(e, "Phi")));
}

static void emit_input_matrix(const struct emitter *e, const struct step *step, const char *declaration)
{
	const struct table *table = step->branch->whole;
	double *value = ARRAY(double, (size_t)(table->states * table->inputs));
	for (int i = 0; i < table->states * table->inputs; i++)
		value[i] = table->input[i].value;
	fprintf(e->to, "\n%s[%s_STATES][%d] = {\n", declaration, e->upper, table->inputs);
	emit_number_rows(e, table->states, table->inputs, value, step->model->state_name);
	fputs("};\n", e->to);
}

static void emit_gamma(const struct emitter *e)
{
	emit_input_matrix(e, e->step->shown, format("const double %s_Gamma", e->name));
	if (e->model->relative && e->step->program->loops && !e->model->switching && !has_leftover(e->step))
		emit_input_matrix(e, e->step, format("static const double %s", stepped_table(e, "Gamma")));
}

static void emit_wrapper(const struct emitter *e, const char *result, const char *function, const char *parameters, const char *arguments, bool is_const)
{
	const char *state = format(is_const ? "const struct %s" : "struct %s", e->name); /* the tag: a parameter may bear the name */
	fprintf(e->to, "static %s %s_any_%s(%svoid *s%s) { %s%s_%s((%s *)s%s); }\n", result, e->name, function, is_const ? "const " : "", parameters,
		*result != 'v' ? "return " : !e->system->inputs && strstr(parameters, "*u") ? "(void)u; " : "", e->name, function, state, arguments);
}

static void emit_start_samples(const struct emitter *e)
{
	fprintf(e->to, "static const int %s_start_samples[] = {", e->name);
	for (int i = 0; i < e->system->inputs; i++)
		fprintf(e->to, "%s%d", i ? ", " : "", e->system->input[i].first_order);
	fputs("};\n", e->to);
}

static void emit_descriptor(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name, *N = e->upper;
	bool at = e->step->series.emitted, inputs = e->system->inputs > 0;
	const char **output = ARRAY(const char *, (size_t)e->model->outputs), **input = ARRAY(const char *, (size_t)e->system->inputs);
	for (int i = 0; i < e->model->outputs; i++)
		output[i] = e->model->output[i].name;
	for (int i = 0; i < e->system->inputs; i++)
		input[i] = e->system->input[i].name;
	fputs("\n/* The same functions for programs that drive any model. */\n\n", to);
	emit_name_list(e, "state_names", e->system->states, e->step->shown->model->state_name);
	if (inputs) {
		emit_name_list(e, "input_names", e->system->inputs, input);
		emit_start_samples(e);
	}
	emit_name_list(e, "output_names", e->model->outputs, output);
	fputc('\n', to);
	emit_wrapper(e, "void", "init", "", "", false);
	emit_wrapper(e, "void", "set", ", double t, const double *y", ", t, y", false);
	emit_wrapper(e, "void", "get", ", double *y", ", y", true);
	emit_wrapper(e, "double", "time", "", "", true);
	emit_wrapper(e, "void", "step", ", const double *u", inputs ? ", u" : "", false);
	emit_wrapper(e, "void", "out", ", double *out", ", out", true);
	emit_wrapper(e, "void", "run", ", size_t n, const double *u, double *out", inputs ? ", n, u, out" : ", n, out", false);
	if (at)
		emit_wrapper(e, "void", "at", ", const double *u, double tau, double *y", inputs ? ", u, tau, y" : ", tau, y", true);
	if (has_jump(e))
		emit_wrapper(e, "void", "jump", ", uint64_t n", ", n", false);
	emit_wrapper(e, "int", "status", "", "", true);
	if (e->model->tuning)
		emit_tuning_wrapper(e);
	if (e->ramps)
		emit_wrapper(e, "void", "hold", ", const double *u", ", u", false);
	fprintf(to, "\nconst pl_model %s_model = {\n    \"%s\", sizeof(struct %s), %s_STATES, %s_INPUTS, %s_OUTPUTS, sizeof(double), %s_H,\n", n, n, n, N, N, N,
		N);
	fprintf(to, "    %s_state_names, %s, %s_output_names,\n", n, inputs ? format("%s_input_names", n) : "NULL", n);
	fprintf(to, "    %s_any_init, %s_any_set, %s_any_get, %s_any_time, %s_any_step,\n    %s_any_out, %s_any_run, %s, %s, %s,\n", n, n, n, n, n, n, n,
		at ? format("%s_any_at", n) : "NULL", has_jump(e) ? format("%s_any_jump", n) : "NULL", format("%s_any_status", n));
	fprintf(to, "    %s,\n", e->model->tuning ? format("%s_PARAMS, %s_param_names, %s_nominal.params, %s_any_retune", N, n, n, n) : "0, NULL, NULL, NULL");
	fprintf(to, "    %s, %s\n};\n", e->ramps ? format("%s_any_hold", n) : "NULL", inputs ? format("%s_start_samples", n) : "NULL");
}

/* Does an output read an acceleration that something left over acts on? */
static bool reads_channels(const struct model *model)
{
	bool any = false;
	for (int i = 0; i < model->outputs + model->n; i++) {
		const struct output *output = i < model->outputs ? &model->output[i] : model->highest[i - model->outputs];
		for (int c = 0; output && c < model->channels; c++)
			any = any || mpq_sgn(output->channel[c]) != 0;
	}
	return any;
}

/* ---- the two texts ---- */

void emit_header(FILE *to, const struct step *step, const char *options, bool rhs)
{
	struct emitter e = emitter_new(to, step, options);
	emit_banner(&e);
	emit_declarations(&e, rhs);
}

static bool needs_math(const struct emitter *e, bool rhs)
{
	bool math = false;
	for (int i = 0; i < e->model->outputs; i++) {
		const struct form *left = e->model->output[i].left;
		math = math || (left && reads_of(speaker(e->model), 1, &left).math);
	}
	for (int k = 0; k < e->model->operators; k++)
		math = math || reads_of(e->model, e->model->channels, (const struct form *const *)e->model->operator[k].left).math;
	if (e->model->selector)
		math = math || reads_of(e->model, 1, &e->model->selector).math;
	return math || (rhs && rhs_needs_math(e->model));
}

void emit_code(FILE *to, const struct step *step, const char *options, const char *header_name, bool rhs)
{
	struct emitter e = emitter_new(to, step, options);
	emit_banner(&e);
	if (header_name)
		fprintf(to, "#include \"%s\"\n", header_name);
	else
		emit_declarations(&e, rhs);
	if (needs_math(&e, rhs))
		fputs("\n#include <math.h>\n", to);
	if (step->program->compensated || step->carries)
		fprintf(to, "\n#if PL_EXCESS_PRECISION%s\n#error \"two-word arithmetic needs sums that have the bits of their type: on x86 compile it with -msse2 "
			    "-mfpmath=sse\"\n#endif\n", step->model->asked.single ? "F" : "");
	emit_phi(&e);
	if (e.system->inputs)
		emit_gamma(&e);
	emit_load_tables(&e);
	if (step->model->tuning)
		emit_nominal(&e);
	if (e.system->segments > 1)
		emit_changes(&e);
	if (step->model->switching) {
		emit_regions(&e);
		emit_region_start(&e);
	}
	emit_access(&e);
	if (step->model->tuning)
		emit_retune(&e);
	else if (e.system->segments > 1)
		emit_passing(&e);
	if (step->model->switching && reads_channels(step->model))
		emit_leftover_functions(&e);
	if (step->model->switching) {
		emit_region_step(&e);
	} else if (has_leftover(step)) {
		emit_leftover_functions(&e);
		emit_leftover_step(&e);
	} else {
		emit_step(&e);
	}
	emit_out(&e);
	emit_run(&e);
	if (step->model->switching)
		emit_region_at(&e);
	else if (step->model->tuning)
		emit_tuned_at(&e);
	else if (step->series.emitted)
		emit_at(&e);
	if (has_jump(&e))
		emit_jump(&e);
	if (e.model->asked.selftest)
		emit_selftest(&e, has_jump(&e));
	if (rhs)
		emit_rhs(&e);
	emit_descriptor(&e);
}
