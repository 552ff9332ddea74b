/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step program and its tables as C. Everything printed here is meant to be read. */
#include "plgen.h"

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
		needed = needed || (left && reads_of(model->written, 1, &left).load[load]);
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
	struct emitter e = { .to = to, .step = step, .model = step->model, .system = &step->system, .options = options };
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

static bool has_status(const struct emitter *e)
{
	return has_leftover(e->step) || e->model->switching;
}

const char *input_name(const struct emitter *e, int input, int order)
{
	for (const struct symbol *s = e->model->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_INPUT && s->index == input)
			return order ? s->c_dot : s->c_name;
	return NULL;
}

int coordinate_of_row(const struct model *model, int row)
{
	int coord = 0;
	while (model->owner[coord] != row)
		coord++;
	return coord;
}

/* ---- sums of velocities that are kept ---- */

static int parts_kept(const struct emitter *e)
{
	int parts = 0;
	for (int k = 0; k < e->step->keepers; k++)
		parts += e->step->keeper[k].parts;
	return parts;
}

static const char *keepers_text(const struct emitter *e)
{
	const char *text = "";
	for (int k = 0; k < e->step->keepers; k++)
		text = format("%s%s%s", text, k ? ", " : "", e->model->state_name[e->step->keeper[k].state]);
	return text;
}

static const char *others_text(const struct emitter *e)
{
	const char *text = "";
	for (int k = 0; k < e->step->keepers; k++)
		for (int i = 0; i < e->step->keeper[k].parts; i++)
			text = format("%s%s%s", text, *text ? ", " : "", e->model->state_name[e->step->keeper[k].part[i].operand.index]);
	return text;
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
	const struct model *model = e->model;
	const char *at = model->operator[0].text;
	fprintf(e->to, " * y' = A y + loads + inputs + r(t, y). A: the %s%s%s.\n", *at ? "equations' Jacobian at " : model->scheme == SCHEME_PL ? "own terms of each coordinate" : "linear terms with constant coefficients",
		at, e->step->operators > 1 ? format(", and so on: %d operators", e->step->operators) : "");
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
	const struct switching *s = e->model->switching;
	fprintf(e->to, " * Scheme exact: nothing is approximated. The equations are piecewise linear: %d regions, %d different, in each of which\n"
		       " * every constant is its closed form, correctly rounded; crossings inside a step are found in order, to rounding.\n",
		possible_regions(s), s->systems);
	for (int i = 0; i < s->expressions; i++) {
		const char *at = "";
		for (int k = 0; k < s->expression[i].breaks; k++)
			at = format("%s%s%s", at, k ? ", " : "", readable_text(s->expression[i].at[k]));
		fprintf(e->to, " *     expression %d: %s, at %s\n", i, printable(form_text(e->model, s->expression[i].form)), at);
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
	if (e->step->keepers)
		fprintf(e->to, " * No force from outside acts: what %s gained since the last set, %s lost; so momentum stays as it is.\n", others_text(e), keepers_text(e));
	if (drift.known)
		fprintf(e->to, " * %s.\n", drift_text(&drift));
	if (e->model->single)
		fputs(" * Numbers and arithmetic are float; each constant is rounded to it once.\n", e->to);
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
	if (e->model->tuning)
		banner_tuning(e);
	fprintf(e->to, " * State y = %s.\n", state_list(e->model));
	for (int i = 0; i < e->system->inputs; i++)
		fprintf(e->to, " * Input %s: %s.\n", e->system->input[i].name, e->system->input[i].first_order
			? "a ramp from sample to sample; u is its value at the end of the step" : "held over the step");
	if (e->system->segments > 1)
		fprintf(e->to, " * The loads change their formula %d time%s; a step across a change is exact too, by a series that stops there.\n",
			e->system->segments - 1, e->system->segments > 2 ? "s" : "");
	if (e->model->dropped)
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
		e->step->momenta ? format("; velocities times mass / mass of %s", e->model->coord_name[0]) : "",
		e->step->keepers ? format("; %s at the last set", keepers_text(e)) : "");
	if (e->step->program->compensated)
		fprintf(to, "    double rest[%s_STATES];  /* what rounding took from y so far */\n", e->upper);
	if (e->step->keepers)
		fprintf(to, "    double base[%d];      /* %s at the last set; what was gained since, %s lost */\n", parts_kept(e), others_text(e), keepers_text(e));
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
	if (has_status(e))
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
	if (has_status(e))
		declare(e, format("int    %s_status(const %s *s);", n, n), e->model->switching ? "0, or bits: PL_NOT_FINITE, PL_TOO_MANY_EVENTS"
			: "0, or PL_NOT_FINITE once a step has left the finite numbers");
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
			e->model->written != e->model ? format("as written; y: all %d written states", e->model->written->system.states)
			: e->ramps ? "as written; u: inputs, then their slopes" : "the equations as written");
	if (e->model->selftest)
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
	fprintf(to, "#ifndef %s_DECLARED\n#define %s_DECLARED\n\n#include \"plrt.h\"\n\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n", N, N);
	fprintf(to, "enum { %s_STATES = %d, %s_INPUTS = %d, %s_OUTPUTS = %d };\n", N, e->system->states, N, e->system->inputs, N, e->model->outputs);
	if (e->model->switching)
		fprintf(to, "enum { %s_MAX_EVENTS = %d };  /* crossings in a step */\n", N, MAX_EVENTS);
	fprintf(to, "#define %s_H %s  /* step [s] */\n\n", N, shortest(round_rational(e->model->h)));
	emit_state_struct(e);
	emit_functions(e, rhs);
	fputs("\n#ifdef __cplusplus\n}\n#endif\n\n#endif\n", to);
}

/* ---- sums ---- */

/* (a + b) + (c + d): the shortest chain of dependent additions; lines break at the middle of what is too long for one. */
const char *tree(int terms, const char *const *term, int indent)
{
	enum { WIDTH = 100 };
	if (terms == 1)
		return term[0];
	int half = (terms + 1) / 2;
	half += terms > 3 && half % 2;          /* pairs stay together */
	const char *left = tree(half, term, indent + 1), *right = tree(terms - half, term + half, indent + 1);
	left = half > 1 ? format("(%s)", left) : left;
	right = terms - half > 1 ? format("(%s)", right) : right;
	bool subtract = terms - half == 1 && right[0] == '-';
	const char *sign = subtract ? "-" : "+";
	right += subtract;
	bool wide = (int)(strlen(left) + strlen(right)) + indent > WIDTH;
	return wide ? format("%s\n%*s%s %s", left, indent, "", sign, right) : format("%s %s %s", left, sign, right);
}

double finite_number(const struct emitter *e, mpq_srcptr q)
{
	if (beyond_range(q))
		error(e->model->step_at, NULL, "a number of the equations is beyond the range of %s", target_name());
	return round_rational(q);
}

const char *scaled(double factor, const char *operand)
{
	if (!operand)
		return shortest(factor);
	if (factor == 1)
		return operand;
	return factor == -1 ? format("-%s", operand) : format("%s * %s", shortest(factor), operand);
}

/* The mass that a kept velocity is multiplied with; NULL: 1 */
static const char *factor_of_momentum(const struct emitter *e, int state)
{
	if (!e->step->momenta || state < e->model->n || mpq_cmp_ui(e->step->mass[e->system->coord[state]], 1, 1) == 0)
		return NULL;
	return shortest(finite_number(e, e->step->mass[e->system->coord[state]]));
}

/* What another velocity has gained since the last set: from locals, or from s->y */
static const char *gain(const struct emitter *e, const struct keeper *keeper, int part, bool locals)
{
	int state = keeper->part[part].operand.index, at = keeper->first + part;
	const char *now = locals ? e->local[state] : format("s->y[%d]", state);
	return e->step->program->compensated ? format("((%s - s->base[%d]) + s->rest[%d])", now, at, state) : format("(%s - s->base[%d])", now, at);
}

const char *keeper_text(const struct emitter *e, const struct keeper *keeper, bool locals)
{
	const char **term = ARRAY(const char *, 2 * (size_t)keeper->parts + 1);
	int terms = 0;
	for (int k = 0; k < keeper->parts; k++) {
		const struct coefficient *weight = keeper->part[k].factor;
		term[terms++] = scaled(weight->value, gain(e, keeper, k, locals));
		if (e->step->program->compensated && weight->low != 0)
			term[terms++] = scaled(weight->low, gain(e, keeper, k, locals));
	}
	bool plain = terms == 1 && term[0][0] != '-';
	return format(plain ? "s->y[%d] - %s" : "s->y[%d] - (%s)", keeper->state, tree(terms, term, 22));
}

/* The states wanted. `velocities`: without masses, and with those that are not stepped; else as the struct has them, those left out. */
static void write_locals(const struct emitter *e, const bool *reads, const char *type, const char *vector, bool velocities)
{
	const char *list = "";
	for (int i = 0; i < e->system->states; i++) {
		const char *mass = velocities ? factor_of_momentum(e, i) : NULL;
		const struct keeper *keeper = velocities ? keeper_of(e->step, i) : NULL;
		const char *value = keeper ? format(mass ? "(%s)" : "%s", keeper_text(e, keeper, false)) : format("%s[%d]", vector, i);
		if (reads[i] && (velocities || !keeper_of(e->step, i)))
			list = format("%s%s%s = %s%s", list, *list ? ", " : format("    %s ", type), e->local[i], value, mass ? format(" / %s", mass) : "");
	}
	for (int width = 0; *list; list++) {            /* a line break instead of the blank that would pass column 110 */
		putc(*list == ' ' && width > 100 && list[-1] == ',' ? '\n' : *list, e->to);
		if (*list == ' ' && width > 100 && list[-1] == ',') {
			fputs("                 ", e->to);
			width = 17;
		}
		width++;
		if (!list[1])
			fputs(";\n", e->to);
	}
}

void emit_locals(const struct emitter *e, const bool *reads)
{
	write_locals(e, reads, "const double", "s->y", true);
}

void emit_raw_locals(const struct emitter *e, const bool *reads, bool changing)
{
	write_locals(e, reads, changing ? "double" : "const double", "s->y", false);
}

void emit_locals_of(const struct emitter *e, const bool *reads, const char *vector)
{
	write_locals(e, reads, "const double", vector, false);
}

/* ---- init, set, get, time ---- */

static void emit_init(const struct emitter *e)
{
	fprintf(e->to, "\nvoid %s_init(%s *s)\n{\n    static const double start[%s_STATES] = {", e->name, e->name, e->upper);
	for (int i = 0; i < e->system->states; i++)
		fprintf(e->to, "%s%s", i ? ", " : "", shortest(round_rational(e->model->initial[i])));
	fputs("};\n", e->to);
	if (e->model->tuning)
		fprintf(e->to, "    s->coeffs = %s_nominal;\n", e->name);
	for (int i = 0; i < e->system->inputs; i++) {
		fprintf(e->to, "    s->u[%d] = 0.0;\n", i);
		if (e->ramps)
			fprintf(e->to, "    s->slope[%d] = 0.0;\n", i);
	}
	fprintf(e->to, "    %s_set(s, 0.0, start);\n}\n", e->name);
}

const char *step_length(const struct emitter *e)
{
	return e->model->tuning ? "s->coeffs.h" : format("%s_H", e->upper);
}

/* t0 + k p/q with p and q exact is one rounding away from the exact time while k p < 2^53. */
static void emit_time(const struct emitter *e)
{
	if (e->model->tuning) {
		fprintf(e->to, "\ndouble %s_time(const %s *s)\n{\n    return s->t0 + (double)s->k * s->coeffs.h;\n}\n", e->name, e->name);
		return;
	}
	mpz_srcptr p = mpq_numref(e->model->h), q = mpq_denref(e->model->h);
	bool short_fraction = e->model->single ? mpz_sizeinbase(p, 2) <= 12 && mpz_sizeinbase(q, 2) <= 24 : mpz_sizeinbase(p, 2) <= 40 && mpz_sizeinbase(q, 2) <= 53;
	const char *factor = mpz_cmp_ui(p, 1) == 0 ? "" : format(" * %s", shortest(mpz_get_d(p)));
	const char *divisor = mpz_cmp_ui(q, 1) == 0 ? "" : format(" / %s", shortest(mpz_get_d(q)));
	fprintf(e->to, "\ndouble %s_time(const %s *s)\n{\n    return s->t0 + (double)s->k%s%s;\n}\n", e->name, e->name,
		short_fraction ? factor : format(" * %s_H", e->upper), short_fraction ? divisor : "");
}

/* s->y from a vector of states, nothing left of earlier rounding */
void emit_store(const struct emitter *e, const char *vector, const char *indent)
{
	FILE *to = e->to;
	bool rest = e->step->program->compensated;
	fprintf(to, "%sfor (i = 0; i < %s_STATES; i++)%s\n%s    s->y[i] = %s[i];\n", indent, e->upper, rest ? " {" : "", indent, vector);
	if (rest)
		fprintf(to, "%s    s->rest[i] = 0.0;\n%s}\n", indent, indent);
	for (int i = 0; i < e->system->states; i++)
		if (factor_of_momentum(e, i))
			fprintf(to, "%ss->y[%d] = %s * %s[%d];\n", indent, i, factor_of_momentum(e, i), vector, i);
	for (int k = 0; k < e->step->keepers; k++)
		for (int i = 0; i < e->step->keeper[k].parts; i++)
			fprintf(to, "%ss->base[%d] = s->y[%d];\n", indent, e->step->keeper[k].first + i, e->step->keeper[k].part[i].operand.index);
}

/* A vector of states from s->y */
void emit_load_state(const struct emitter *e, const char *vector)
{
	fprintf(e->to, "    for (i = 0; i < %s_STATES; i++)\n        %s[i] = s->y[i];\n", e->upper, vector);
	for (int i = 0; i < e->system->states; i++)
		if (factor_of_momentum(e, i) && !keeper_of(e->step, i))
			fprintf(e->to, "    %s[%d] = s->y[%d] / %s;\n", vector, i, i, factor_of_momentum(e, i));
	for (int k = 0; k < e->step->keepers; k++) {
		const struct keeper *keeper = &e->step->keeper[k];
		const char *mass = factor_of_momentum(e, keeper->state), *value = keeper_text(e, keeper, false);
		fprintf(e->to, mass ? "    %s[%d] = (%s) / %s;\n" : "    %s[%d] = %s;\n", vector, keeper->state, value, mass);
	}
}

static void emit_access(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name, *N = e->upper;
	emit_init(e);
	fprintf(to, "\nvoid %s_set(%s *s, double t, const double y[%s_STATES])\n{\n    int i;\n", n, n, N);
	emit_store(e, "y", "    ");
	fputs("    s->t0 = t;\n    s->k = 0;\n", to);
	if (has_status(e))
		fputs("    s->status = 0;\n", to);
	emit_load_set(e);
	if (e->system->segments > 1)
		fprintf(to, "    for (s->segment = 0; s->segment < %d && %s_until(s, s->segment) <= 1e-18 * %s;)\n        s->segment++;\n",
			e->system->segments - 1, n, step_length(e));
	if (e->model->switching)
		fprintf(to, "    %s_place(s);\n", n);
	fprintf(to, "}\n\nvoid %s_get(const %s *s, double y[%s_STATES])\n{\n    int i;\n", n, n, N);
	emit_load_state(e, "y");
	fputs("}\n", to);
	emit_time(e);
	if (has_status(e))
		fprintf(to, "\nint %s_status(const %s *s)\n{\n    return s->status;\n}\n", n, n);
	if (e->ramps)
		fprintf(to, "\nvoid %s_hold(%s *s, const double u[%s_INPUTS])\n{\n    int i;\n    for (i = 0; i < %s_INPUTS; i++)\n        s->u[i] = u[i];\n}\n",
			n, n, N, N);
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

void emit_number_rows(const struct emitter *e, int rows, int columns, const double *value, const char *const *row_note)
{
	for (int i = 0; i < rows; i++) {
		fputs("    {", e->to);
		for (int j = 0; j < columns; j++) {
			if (!isfinite(value[i * columns + j]))
				error(e->model->step_at, NULL, "a number in the row of %s is beyond the range of %s", row_note[i], target_name());
			fprintf(e->to, "%s%s", j ? ", " : "", shortest(value[i * columns + j]));
		}
		fprintf(e->to, "},  /* %s */\n", row_note[i]);
	}
}

static void emit_phi(const struct emitter *e)
{
	int n = e->system->states;
	double *value = ARRAY(double, (size_t)(n * n));
	for (int i = 0; i < n * n; i++)
		value[i] = e->step->table->Phi[i].value;
	fprintf(e->to, "\nconst double %s_Phi[%s_STATES][%s_STATES] = {  /* columns: %s */\n", e->name, e->upper, e->upper, state_list(e->model));
	emit_number_rows(e, n, n, value, e->model->state_name);
	fputs("};\n", e->to);
}

static void emit_gamma(const struct emitter *e)
{
	const struct table *table = e->step->table;
	double *value = ARRAY(double, (size_t)(table->states * table->inputs));
	for (int i = 0; i < table->states * table->inputs; i++)
		value[i] = table->input[i].value;
	fprintf(e->to, "\nconst double %s_Gamma[%s_STATES][%d] = {\n", e->name, e->upper, table->inputs);
	emit_number_rows(e, table->states, table->inputs, value, e->model->state_name);
	fputs("};\n", e->to);
}

void emit_name_list(const struct emitter *e, const char *array, int count, const char *const *name)
{
	fprintf(e->to, "static const char *const %s_%s[] = {", e->name, array);
	for (int i = 0; i < count; i++)
		fprintf(e->to, "%s\"%s\"", i == 0 ? "" : i % 10 ? ", " : ",\n    ", name[i]);
	fputs("};\n", e->to);
}

static void emit_wrapper(const struct emitter *e, const char *result, const char *function, const char *parameters, const char *arguments, bool is_const)
{
	const char *state = format(is_const ? "const struct %s" : "struct %s", e->name); /* the tag: a parameter may bear the name */
	fprintf(e->to, "static %s %s_any_%s(%svoid *s%s) { %s%s_%s((%s *)s%s); }\n", result, e->name, function, is_const ? "const " : "", parameters,
		*result != 'v' ? "return " : !e->system->inputs && strstr(parameters, "*u") ? "(void)u; " : "", e->name, function, state, arguments);
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
	emit_name_list(e, "state_names", e->system->states, e->model->state_name);
	if (inputs)
		emit_name_list(e, "input_names", e->system->inputs, input);
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
	if (has_status(e))
		emit_wrapper(e, "int", "status", "", "", true);
	if (e->model->tuning)
		emit_tuning_wrapper(e);
	fprintf(to, "\nconst pl_model %s_model = {\n    \"%s\", sizeof(struct %s), %s_STATES, %s_INPUTS, %s_OUTPUTS, %s_H,\n", n, n, n, N, N, N, N);
	fprintf(to, "    %s_state_names, %s, %s_output_names,\n", n, inputs ? format("%s_input_names", n) : "NULL", n);
	fprintf(to, "    %s_any_init, %s_any_set, %s_any_get, %s_any_time, %s_any_step,\n    %s_any_out, %s_any_run, %s, %s, %s,\n", n, n, n, n, n, n, n,
		at ? format("%s_any_at", n) : "NULL", has_jump(e) ? format("%s_any_jump", n) : "NULL", has_status(e) ? format("%s_any_status", n) : "NULL");
	fprintf(to, "    %s\n};\n", e->model->tuning ? format("%s_PARAMS, %s_param_names, %s_nominal.params, %s_any_retune", N, n, n, n) : "0, NULL, NULL, NULL");
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
		math = math || (left && reads_of(e->model->written, 1, &left).math);
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
	if (step->program->compensated)
		fputs("\n#ifdef __FAST_MATH__\n#error \"two-word arithmetic needs rounding errors as they are: compile it without -ffast-math\"\n#endif\n", to);
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
	if (e.model->selftest)
		emit_selftest(&e, has_jump(&e));
	if (rhs)
		emit_rhs(&e);
	emit_descriptor(&e);
}
