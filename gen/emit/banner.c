/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The comment at the top: the equations, the poles, what the scheme does, what a step costs. */
#include "emit/emit.h"

#include <string.h>

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
		say(e, " *     %s\n", text_between(spec->equation[i].at, spec->equation[i].end));
	for (int i = 0; i < spec->elements; i++)
		say(e, " *     %s\n", text_between(spec->element[i].at, spec->element[i].end));
}

static void banner_poles(const struct emitter *e)
{
	int length = resolvent_determinant(e->step->written)->length;
	mpq_t *B = rationals((size_t)length);
	characteristic_polynomial(e->step->written, B);
	say(e, " *\n"
	       " *     B(s) = %s\n", polynomial_text(length, (const mpq_t *)B));
	struct pole_report *pole;
	int count = poles_of(e->model, e->step->written, &pole);
	say(e, " *     %-34s %-16s damping ratio\n", "pole [1/s]", "frequency [Hz]");
	for (int i = 0; i < count; i++)
		say(e, " *     %-34s %-16.8g %.8g\n", pole_text(&pole[i]), mpfr_get_d(pole[i].hertz, MPFR_RNDN),
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
	say(e, " * y' = A y + loads + inputs + r(t, y). A: the %s%s%s.\n",
	       *at ? "equations' Jacobian at " : model->scheme == SCHEME_PL ? "own terms of each coordinate" : "linear terms with constant coefficients",
	       at, e->step->branches > 1 ? format(", and so on: %d operators", e->step->branches) : "");
	say(e, " * Exact: A%s; approximated: r, which is\n",
	       model->loads_left ? " and the inputs, each constant correctly rounded" : ", the loads and the inputs, each constant correctly rounded");
	for (int c = 0; c < model->channels && c < SHOWN; c++) {
		const char *text = form_text(model, model->operator[0].left[c]);
		say(e, " *     %.*s%s  in the equation of %s\n", WIDTH, printable(text),
		       strlen(text) > WIDTH ? " ..." : "",
		       model->coord_name[coordinate_of_row(model, model->channel_row[c])]);
	}
	if (model->channels > SHOWN)
		say(e, " *     and so in %d more equations\n", model->channels - SHOWN);
}

/* Regions, and what each expression is compared with */
static void banner_regions(const struct emitter *e)
{
	const struct model *model = e->step->shown->model;
	const struct switching *s = model->switching;
	say(e, " * Scheme exact: nothing is approximated. The equations are piecewise linear: %d regions, %d different, in each of which\n"
	       " * every constant is its closed form, correctly rounded; crossings inside a step are found in order, to rounding.\n",
	       possible_regions(s), s->systems);
	for (int i = 0; i < s->expressions; i++) {
		const char *at = "";
		for (int k = 0; k < s->expression[i].breaks; k++)
			at = format("%s%s%s", at, k ? ", " : "", readable_text(s->expression[i].at[k]));
		say(e, " *     expression %d: %s, at %s\n", i, printable(form_text(model, s->expression[i].form)),
		       at);
	}
	say(e, " * The poles above are those of the terms that are linear everywhere.\n");
	say(e, " * A region's number is the sum of its intervals, each times the product of the numbers of intervals before it.\n");
}

static void banner_scheme(const struct emitter *e)
{
	if (e->model->switching) {
		banner_regions(e);
		return;
	}
	if (e->model->scheme != SCHEME_EXACT)
		say(e, " * %s\n", scheme_notes[e->model->scheme]);
	if (loses_order(e->step->shown->model))
		say(e, " * So where all is smooth; here of order %s at most: %s.\n",
		       order_text(e->step->shown->model), printable(smoothness_text(e->step->shown->model)));
	if (has_leftover(e->step))
		banner_leftover(e);
	else if (e->model->scheme != SCHEME_PL)
		say(e, " * %sothing is approximated; each constant is its closed form, correctly rounded.\n",
		       e->model->scheme == SCHEME_EXACT ? "Scheme exact: n" : "Nothing is left over: n");
	if (e->model->scheme == SCHEME_PL)
		say(e, " * Each constant is its closed form, correctly rounded.\n"
		       " * The modified equation of its linear part grows at %.3g 1/s (largest real part of its poles; the poles above are exact).\n",
		       mpfr_get_d(e->step->growth, MPFR_RNDN));
}

static void banner_irrationals(const struct emitter *e)
{
	const char *which = irrationals_text(&e->model->irrationals);
	if (*which)
		say(e, " * Irrational constants (%s) were taken as rationals of %d bits.\n", which, IRRATIONAL_BITS);
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
	say(e, " * What may move as a whole is kept apart from what moves in it: %s%s.\n", list, centre);
	if (*centre)
		say(e, " * Only loads and inputs act on a centre; nothing that rounds inside changes its velocity.\n");
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
		say(e, " * %s%s.\n", kept[e->step->form],
		       e->step->program->compensated ? "; factors in two words,\n * and what rounding takes from the state is kept in rest" : "");
	if (e->model->relative)
		banner_relative(e);
	if (e->step->carries)
		say(e, " * Nothing leads back from %s: what rounding takes from %s is carried on.\n",
		       carried_text(e), e->step->carries > 1 ? "each" : "it");
	if (drift.known)
		say(e, " * %s.\n", drift_text(&drift));
	if (e->step->rounding.known)
		say(e, " * %s.\n", rounding_text(e->step));
	if (e->model->asked.single)
		say(e, " * Numbers and arithmetic are float; each constant is rounded to it once.\n");
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
	say(e, " * The step would round to what %s%s drive%s: the state is kept less their forced part, which is added where it is\n"
	       " * read (get, out, at): %d multiplications, %d additions.\n", list,
	       shown > 4 ? format(" and %d more loads", shown - 4) : "", shown == 1 ? "s" : "",
	       e->step->forced->multiplications, e->step->forced->additions);
}

static void banner_cost(const struct emitter *e)
{
	const struct program *program = e->step->program;
	if (e->model->switching)
		say(e, " * A step that stays clear of every breakpoint, in a region whose piece is the step:\n");
	say(e, " * One step of h = %s s, form %s: %d multiplications, %d additions", readable_text(e->model->h),
	       form_text_of(e->step), program->multiplications, program->additions);
	if (program->wave_multiplications)
		say(e, ", %d of them and %d for the functions of the loads", program->wave_multiplications,
		       program->wave_additions);
	if (program->calls)
		say(e, ", %d calls of the model's own functions", program->calls);
	say(e, ".\n");
	banner_form(e);
	if (e->step->forced)
		banner_forced(e);
	if (e->model->tuning)
		banner_tuning(e);
	say(e, " * State y = %s.\n", state_list(e->step->shown->model));
	for (int i = 0; i < e->system->inputs; i++)
		say(e, " * Input %s: %s.\n", e->system->input[i].name,
		       e->system->input[i].first_order ? "a ramp from sample to sample; u is its value at the end of the step" : "held over the step");
	if (e->system->segments > 1)
		say(e, " * The loads change their formula %d time%s; a step across a change is exact too, by a series that stops there.\n",
		       e->system->segments - 1, e->system->segments > 2 ? "s" : "");
	if (e->model->reduction.dropped)
		say(e, " * Reduced to what the outputs can see: %d of %d states.\n", e->system->states,
		       e->model->written->system.states);
	if (has_jump(e) && e->system->states > 12)
		say(e, " * $n_jump needs some %d KB of stack.\n",
		       1 + 32 * e->system->states * e->system->states / 1024);
	if (!has_jump(e))
		say(e, " * There is no $n_jump: %s.\n",
		       e->model->switching ? "crossings are found step by step" : e->model->tuning ? "retuned coefficients have one word" : has_leftover(e->step) ? "what is left over is not linear in the state" : "the samples to come are not known");
	if (has_leftover(e->step) && !e->step->series.powers)
		say(e, " * There is no $n_at: between its steps the scheme has no values of its order.\n");
	else if (!e->step->series.emitted)
		say(e, " * There is no $n_at: the largest |pole| times h is above 8.\n");
}

void emit_banner(const struct emitter *e)
{
	say(e, "/* $n: made by plgen " PLGEN_VERSION " from %s%s%s; do not edit.\n"
	       " * SPDX-License-Identifier: MIT-0\n"
	       " *\n", printable(e->model->spec->source->base), *e->options ? " with " : "", printable(e->options));
	banner_equations(e);
	banner_poles(e);
	say(e, " *\n");
	banner_scheme(e);
	banner_irrationals(e);
	banner_cost(e);
	say(e, " */\n");
}
