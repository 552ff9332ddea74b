/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The comment at the top: the equations, the poles, what the scheme does, what a step costs. */
#include "emit/linear/blocks.h"
#include "declarations.h"
#include "state.h"
#include "steps.h"
#include "emit/series/series.h"
#include "emit/tunable/tunable.h"
#include "model/contacts/contacts.h"
#include "model/reads.h"
#include "model/linear/relative.h"
#include "report/report.h"
#include "step/collocation/collocation.h"
#include "step/cost.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"
#include "step/linear/forms.h"
#include "step/linear/images.h"
#include "step/exponential/normal.h"
#include "step/regions/regions.h"
#include "step/linear/rows.h"
#include "step/contacts/series_contacts.h"

#include <string.h>

static const char *printable(const char *text)
{
	char *clean = format("%s", text);
	for (char *c = clean; *c; c++) {
		bool mark = c > clean && ((c[-1] == '*' && *c == '/') || (c[-1] == '/' && *c == '*'));
		if (mark || (unsigned char)*c < ' ' || *c == 127)
			*c = '?';               /* a comment in an option neither ends nor opens ours */
	}
	return clean;
}

static void banner_equations(const struct emitter *e)
{
	const struct spec *spec = e->model->spec;
	const struct equation *equation = spec->equation;
	const struct element *element = spec->element;
	for (int i = 0; i < spec->equations; i++)
		say(e, " *     %s\n", written_text(equation[i].part, equation[i].at, equation[i].end));
	for (int i = 0; i < spec->elements; i++)
		if (element[i].kind != ELEMENT_ENERGY)
			say(e, " *     %s\n", written_text(element[i].part, element[i].at, element[i].end));
	for (int i = 0; i < spec->energies; i++)
		if (energy_text(spec, i))
			say(e, " *     %s\n", energy_text(spec, i));
	for (int i = 0; i < spec->assembly.parts; i++)
		if (parts_text(spec, i))
			say(e, "%s%s.\n", i ? " *     and " : " *\n * Of parts: ", printable(parts_text(spec, i)));
}

static void banner_poles(const struct emitter *e)
{
	int length = resolvent_determinant(e->step->written)->length;
	mpq_t *B = rationals((size_t)length);
	characteristic_polynomial(e->step->written, B);
	say(e, " *\n");
	if (is_nonlinear(e->step) && has_remainder(e->step))
		say(e, " * Of the terms that are linear with constant coefficients:\n");
	say(e, " *     B(s) = %s\n", polynomial_text(length, (const mpq_t *)B));
	struct pole_report *pole;
	int count = poles_of(e->model, e->step->written, &pole);
	say(e, " *     %-34s %-16s damping ratio\n", "pole [1/s]", "frequency [Hz]");
	for (int i = 0; i < count; i++)
		say(e, " *     %s\n", pole_row(&pole[i], 34));
}

#define banner_sentence(e, ...) say_words(e, format(__VA_ARGS__))

static const char *region_number(int functions)
{
	return functions == 1 ? "The number of a region is that of its interval of switching function 0."
			      : "The number of a region is i0 + n0*(i1 + n1*(i2 + ...)), i0 being its interval of "
				"switching function 0, n0 how many intervals that has.";
}

/* What the scheme is; nothing of exact */
static void banner_scheme(const struct emitter *e)
{
	const struct model *shown = e->step->shown->model;
	if (e->model->scheme != SCHEME_EXACT)
		banner_sentence(e, "%s", scheme_note(e->model->scheme, order_of_step(e->step)));
	if (loses_order(shown))
		say(e, " * So where all is smooth; here of order %s at most: %s.\n", order_text(shown),
		    printable(smoothness_text(shown)));
}

/* What holding the coupling terms does */
static void banner_growth(const struct emitter *e)
{
	if (!scheme_row(e->model->scheme)->holds_coupling)
		return;
	say(e, " * Each constant is its closed form, correctly rounded.\n"
	       " * The modified equation of its linear part grows at %.3g 1/s "
	       "(largest real part of its poles; the poles above are exact).\n", growth_rate(e->step));
}

/* Which modes are kept, and what is lost at most */
static void banner_modal_truncation(const struct emitter *e)
{
	const struct model *model = e->model;
	const char *lost = "";
	for (int i = 0; i < model->outputs; i++)
		lost = format("%s%s%s", lost, i ? ", " : "", truncation_text(model, i));
	banner_sentence(e, "Modes %s of %d are kept; %s. From the start and under the loads%s outputs lose at most %s "
			"(sums of |residues|, for all time).", mode_numbers(model->truncated, true),
			modes_of_model(model->truncated), static_correction_text(model),
			model->system.inputs ? ", inputs 0," :
			"", lost);
}

void banner_linear(const struct emitter *e)
{
	banner_scheme(e);
	if (!scheme_row(e->model->scheme)->holds_coupling)
		say(e, " * %s is approximated; each constant is its closed form, correctly rounded.\n",
		    e->model->truncated                ? "Scheme exact: modes are dropped, nothing else"
		    : e->model->scheme == SCHEME_EXACT ? "Scheme exact: nothing"
						       : "There is no remainder: nothing");
	if (e->model->truncated)
		banner_modal_truncation(e);
	banner_growth(e);
}

static const char *operator_text(const struct model *model)
{
	if (*model->schedule.operator[0].text)
		return format("equations' Jacobian at %s", model->schedule.operator[0].text);
	bool own = scheme_row(model->scheme)->holds_coupling;
	return own ? "own terms of each coordinate" : "linear terms with constant coefficients";
}

void banner_remainder(const struct emitter *e)
{
	const struct model *model = e->step->shown->model;
	banner_scheme(e);
	say(e, " * y' = A y + loads + inputs + r(t, y). A: the %s%s.\n", operator_text(model),
	    e->step->branches > 1 ? format(", and so on: %d operators", e->step->branches) : "");
	say(e, " * Exact: A%s, each constant correctly rounded; approximated: r, a force on %d equation%s.\n",
	    model->remainder.loads ? " and the inputs" : ", the loads and the inputs", model->remainder.force_columns,
	    model->remainder.force_columns == 1 ? "" : "s");
	banner_growth(e);
}

static void banner_breakpoints(const struct emitter *e, const struct expansion *x)
{
	for (int i = 0; i < x->functions; i++)
		say(e, " *     switching function %d: %s, at %s\n", i, printable(series_switching_text(e->step, i)),
		    rising_text(&x->function[i]));
	if (regions_of_series(x))
		banner_sentence(e, "%s", region_number(x->functions));
}

static void report_no_phi(const struct emitter *e)
{
	say(e, " * The state is double-double: its low parts, which hold the rounding errors, are in low.\n");
	if (e->step->shown->no.phi)
		say(e, " * There is no Phi: %s.\n", e->step->shown->no.phi);
}

static void banner_impacts(const struct emitter *e)
{
	const struct model *model = e->step->shown->model;
	for (int i = 0; i < model->contacts.impacts; i++) {
		const struct impact *impact = &model->contacts.impact[i];
		const char *text = text_between(impact->when->at, impact->when->end);
		say(e, " *     impact %d: %s%s\n", i, printable(text),
		    impact->bounces ? format(", a bounce of restitution %s", restitution_text(model, impact)) : "");
	}
	if (model->contacts.impacts > 1)
		say(e, " * Those of one instant act in this order, each from the state that the one before has "
		       "left.\n");
	if (has_bounces(model))
		say(e, " * Bounces that would all be over within 2^-23 h come to rest: $n_rested counts.\n");
}

/* What is held beside a series, and what strikes */
static void banner_contacts(const struct emitter *e)
{
	const struct contacts *c = e->step->taylor.switching->contacts;
	for (int i = 0, friction = 0; c && i < c->holds; i++)
		if (c->hold[i].impact == NONE)
			say(e, " *     friction %d: %s\n", friction++, printable(contact_text(e->step, i)));
	if (c)
		banner_impacts(e);
}

/* What chooses formulas by the state */
static void banner_series_switching(const struct emitter *e)
{
	const struct expansion *x = e->step->taylor.switching;
	if (!x)
		return;
	banner_sentence(e,
			"The state chooses formulas: %s is of those between two crossings. Where a switching function "
			"passes a breakpoint is the first root of its %s, found before it is stepped over; costs "
			"below are without the search.",
			e->step->collocation ? "an internal step" : "a series",
			!e->step->collocation	    ? "own series"
			: e->step->taylor.expansion ? "own series, or of its polynomial through the nodes"
						    : "polynomial through the start and the nodes");
	banner_breakpoints(e, x);
	banner_contacts(e);
}

/* Where errors are measured otherwise than by the largest size of a state */
static void banner_floors(const struct emitter *e)
{
	const char *list = "";
	for (int i = 0; i < e->system->states && has_floors(e); i++)
		if (mpq_sgn(e->model->truncation.absolute[i]) != 0)
			list = format("%s%s%s %s", list, *list ? ", " : "", e->model->names.state[i],
				      readable_text(e->model->truncation.absolute[i]));
	if (*list)
		banner_sentence(e, "Beside the tolerance of their size now states may be off by an absolute one: %s.",
				list);
}

/* The ranges of states */
static void banner_ranges(const struct emitter *e)
{
	const struct model *written = e->model->written;
	const char *list = "";
	for (int i = 0; i < written->ranges; i++)
		list = format("%s%s%s in [%s, %s]", list, i ? ", " : "",
			      written->names.state[written->range[i].state], readable_text(written->range[i].low),
			      readable_text(written->range[i].high));
	if (*list)
		banner_sentence(e, "%s_status says PL_LEFT_RANGE once a state is outside at the end of a step: %s.",
				e->name, list);
}

void banner_expanded(const struct emitter *e)
{
	const struct truncation *truncation = &e->model->truncation;
	const char *tolerance = readable_text(truncation->tolerance);
	banner_scheme(e);
	banner_sentence(e, "%s", truncation->adaptive ? format("Each step is as long as its last two terms are below "
			"%s of the largest value of each state so far: %s, or a part of h, of which there are %d at "
			"most.", tolerance, e->system->inputs ? "h" : "several h, whose states the one series gives",
			truncation->substeps) : mpq_sgn(truncation->tolerance) != 0 ? format("One way through, "
			"whatever the numbers are; where the last two terms are above %s of the largest value of a "
			"state so far, %s_status says PL_INACCURATE.", tolerance, e->name) : "One way through, "
			"whatever the numbers are; nothing looks at the error.");
	banner_floors(e);
	if (spans_steps(e))
		banner_sentence(e, "One expansion is over %d steps, with the error of one of %d h; those before the "
				"last are values of its series. Costs are a step's share.", truncation->over,
				truncation->over);
	banner_series_switching(e);
	report_no_phi(e);
}

/* What is solved at which nodes, how long an internal step is */
void banner_collocated(const struct emitter *e)
{
	const struct truncation *truncation = &e->model->truncation;
	banner_scheme(e);
	banner_sentence(e, "%s%d stages, of order %d; an internal step is as long as its error is below %s of the "
			"largest value of each state so far: several h, whose states its polynomial gives, or a part "
			"of h, of which %d are tried at most.", e->step->taylor.expansion ? "The collocation: " : "",
			truncation->stages, 2 * truncation->stages - 1, readable_text(truncation->tolerance),
			truncation->substeps);
	banner_floors(e);
	banner_sentence(e, splits(e) ? "Newton's method with the Jacobian of its start, by the modes of its stages: "
			"one real and %d complex systems of %d." : "Newton's method with the Jacobian at each node: "
			"%d stages by %d unknowns.", splits(e) ? (truncation->stages - 1) / 2 : truncation->stages,
			e->step->collocation->motion->coords);
	if (e->step->taylor.expansion)
		say(e, " * One iteration of it: %d multiplications, %d additions, %d calls.\n",
		    e->step->collocation->iteration.multiplications, e->step->collocation->iteration.additions,
		    e->step->collocation->iteration.calls);
	banner_series_switching(e);
	report_no_phi(e);
}

/* The modes, the remainder in them, how a step goes */
void banner_normal(const struct emitter *e)
{
	const struct normal *m = e->step->normal;
	const struct model *model = e->model;
	banner_scheme(e);
	banner_sentence(e, "Normal modes of M q'' + C q' + K q = 0, K and C symmetric: %s.",
			operators_of_modes(e->step));
	banner_sentence(e, "Exact: %s; approximated, by polynomials in time: all %s forces on the modes.",
			exact_in_modes(e->step), model->remainder.split->forcings ? "other" : "these");
	banner_sentence(e, "Step: %s.", course_of_modes(e->step));
	banner_sentence(e, "Stability: %s.", stability_of_modes(e->step));
	banner_sentence(e, "Tables: at most %d numbers, of which a step reads those of one operator.",
			numbers_of_modes(e->step));
	if (loads_change(e->system) && keeps_modes(e))
		banner_sentence(e, "Where functions of time change their formula, the method starts anew%s.",
				m->steady.flow ? "; after the last change steps are exact" : "");
}

/* From crossing to crossing */
void banner_event_split(const struct emitter *e)
{
	const struct event_split *event_split = e->step->event_split;
	(e->step->normal ? banner_normal : banner_remainder)(e);
	banner_sentence(e, "The state chooses formulas: steps go from crossing to crossing, the first root of the "
			"cubic through a switching function's values and slopes at both ends; there formulas change.");
	banner_breakpoints(e, event_split->event_check);
	banner_sentence(e, "Parts of such a step%s go by scheme etdrk4, with e^{A tau} made by the target: some %d KB "
			"of stack. The look takes %d multiplications and %d additions beside the costs below.",
			event_split->certain < 1 ? ", so short that no pole turns by more than 1," : "",
			event_split->kilobytes,
			event_split->multiplications, event_split->additions);
}

static void banner_switching_functions(const struct emitter *e)
{
	const struct model *model = e->step->shown->model;
	const struct switching *s = model->switching;
	for (int i = 0; i < s->functions; i++)
		say(e, " *     switching function %d: %s%s, at %s\n", i,
		    printable(form_text(model, s->function[i].form)),
		    changes_in_time(&s->function[i]) ? " at first, with other loads later" : "",
		    breakpoints_text(s->function[i].breaks, (const mpq_t *)s->function[i].at));
}

static void banner_region_number(const struct emitter *e)
{
	say(e, " * The poles above are those of the terms that are linear everywhere.\n");
	banner_sentence(e, "%s", region_number(e->step->shown->model->switching->functions));
}

/* Regions, and what each expression is compared with */
void banner_regions(const struct emitter *e)
{
	const struct switching *s = e->step->shown->model->switching;
	say(e, " * Scheme exact: nothing is approximated. "
	       "The equations are piecewise linear: %d regions, %d different, in each of which\n"
	       " * every constant is its closed form, correctly rounded; "
	       "crossings inside a step are found in order, to rounding.\n", possible_regions(s), s->systems);
	if (s->segments > 1)
		say(e, " * Loads change their formula: each of the %d segments of time has its own regions.\n",
		    s->segments);
	banner_switching_functions(e);
	say(e, "%s", frictions_text(s, " *     "));
	banner_impacts(e);
	if (s->sharing)
		say(e, " * Rigid-body modes couple %d independent parts, so these share their regions.\n",
		    s->sharing);
	const struct event_check *event_check = &e->step->regions.event_check;
	banner_sentence(e, "%s",
			event_check->fast_path ? format("A step that a bound shows to be free of events is one matrix "
			"product; up to %d crossings that are certain are computed by Taylor polynomials of "
			"degree %d; the search does all other steps.", MOST_FAST_PATH,
				event_check->degree) : event_check->is_made ?
			"A step that a bound shows to be free of events is one matrix product; the search does all "
			"other steps." : format("Every step goes by the search: %s.", event_check->searches));
	banner_region_number(e);
}

static void banner_part(const struct emitter *e, int index)
{
	const struct step *part = e->step->regions.part[index];
	const struct switching *s = part->model->switching;
	const int *function = e->model->switching->part[index].function;
	const char *coords = name_list(part->model->n, part->model->names.coord), *divides = "";
	const char *text = format("part %d: %s", index, coords);
	for (int i = 0; i < s->functions; i++)
		divides = format("%s%s %d", divides, i ? "," : "", function[i]);
	if (s->functions == 0)
		say(e, " *     %s; linear\n", text);
	else
		say(e, " *     %s; switching function%s%s; %d regions, %d different%s\n", text,
		    s->functions > 1 ? "s" : "",
		    divides, possible_regions(s), s->systems,
		    part->regions.event_check.fast_path
		    ? format("; polynomials of degree %d", part->regions.event_check.degree)
				: format("; every step goes by the search: %s", part->regions.event_check.searches));
}

/* Of independent parts */
void banner_parts(const struct emitter *e)
{
	bool fast_path = false;
	say(e, " * Scheme exact: nothing is approximated. The equations are piecewise linear, in %d independent parts, "
	       "each with\n"
	       " * regions and crossings of its own: in each region every constant is its closed form, correctly "
	       "rounded;\n"
	       " * crossings inside a step are found in order, to rounding.\n", e->step->regions.parts);
	banner_switching_functions(e);
	for (int p = 0; p < e->step->regions.parts; p++) {
		banner_part(e, p);
		fast_path = fast_path || e->step->regions.part[p]->regions.event_check.fast_path;
	}
	if (fast_path)
		banner_sentence(e, "A step of a part that a bound shows to be free of events is one matrix product; "
				"up to %d crossings that are certain are computed by Taylor polynomials; the "
				"search does all other steps.", MOST_FAST_PATH);
	banner_region_number(e);
}

/* ; X = 0.5*x1 + 0.5*x2 */
static const char *centre_text(const struct relative *r)
{
	const char *text = "";
	for (int j = 0; j < r->written->n; j++)
		for (int k = 0; r->link[j].kind == LINK_CENTRE && k < r->written->n; k++)
			if (mpq_sgn(r->link[j].weight[k]) != 0)
				text = format("%s%s%s*%s", text, *text ? " + " : format("; %s = ", r->name[j]),
					      readable_text(r->link[j].weight[k]), r->written->names.coord[k]);
	return text;
}

/* What is kept in the place of positions that only differences of matter */
static void banner_relative(const struct emitter *e)
{
	const struct relative *r = e->model->relative;
	const char *centre = centre_text(r);
	say(e, " * Rigid-body modes are kept apart from relative coordinates: %s%s.\n", relative_text(e->model),
	    centre);
	if (*centre)
		say(e, " * Only loads and inputs act on a centre; nothing that rounds inside changes its velocity.\n");
}

/* What modes cost, and what their arithmetic loses */
static void banner_modes(const struct emitter *e)
{
	const struct modal *modal = e->step->modal;
	const char *unit = e->model->request.single ? "2^-24" : "2^-53";
	const int lost = e->system->states / 8 + 5;
	banner_sentence(e, "Modal: %d pairs of modes turned and damped, %d real ones; residues enclosed, each number "
			"rounded once.%s", modal->pairs, modal->reals, e->model->request.form == FORM_AUTO ? " It is "
			"the cheapest for so few outputs; --form delta or --form direct step the states." : "");
	if (modal->output)
		say(e, " * A row of outputs: %d multiplications.\n", e->system->states * e->model->outputs);
	banner_sentence(e, "A step rounds a mode by 3 %s of its amplitude at most, what it reads of loads and inputs "
			"apart; an output by %d %s of the sum of its modes' sizes. States become modes in set and "
			"states again in get: of what a state itself has in the modes, up to %.3g times its size, %d "
			"%s are rounding.", unit, lost, unit, modal->condition, 2 * lost, unit);
}

/* What the form does to rounding, and what rounding has done to its constants */
static void banner_form(const struct emitter *e)
{
	static const char *const kept[STEP_FORMS] = {
		[FORM_DELTA] = "Delta: y += (Phi - I) y, Phi - I rounded relative to itself",
		[FORM_KICK_DRIFT_KICK] = "Kick, drift, kick: p += X q; q += S p; p += X q, "
					 "S and X symmetric: symplectic whatever their rounding"
	};
	struct drift drift = drift_of(e->step);
	if (kept[e->step->form])
		say(e, " * %s%s.\n", kept[e->step->form], e->step->program->compensated
		    ? "; factors are double-double,\n * and so is the state, whose low parts are in low" : "");
	if (e->step->modal)
		banner_modes(e);
	if (e->step->no.modal)
		say(e, " * The form modal would be cheaper for so few outputs, but %s.\n", e->step->no.modal);
	if (e->step->linear.flush)
		say(e, " * Denormal flush: every 64 steps $n_%s sets a motion that has decayed below %s to 0.\n",
		    e->step->linear.flush->in_step ? "step" : "run", e->model->request.single ? "1e-35" : "1e-290");
	if (e->model->relative)
		banner_relative(e);
	if (e->step->carried.count)
		say(e, " * No other state depends on %s: the rounding errors of %s are carried along.\n",
		       carried_text(e), e->step->carried.count > 1 ? "each" : "it");
	if (drift.known)
		say(e, " * %s.\n", drift_text(&drift, e->model->h));
	if (e->step->rounding.known)
		say(e, " * %s.\n", rounding_text(e->step));
	if (e->model->request.single)
		say(e, " * Numbers and arithmetic are float; each constant is rounded to it once.\n");
}

/* By its program alone; --explain counts what steps do. */
static void banner_board(const struct emitter *e)
{
	const bool counted = is_linear_alone(e->step) || e->model->switching || e->system->loads == 0;
	if (counted && !e->step->refresh)
		say(e, " * On a Cortex-M4, %s: about %s instructions.\n",
		    e->model->request.single ? "whose FPU has float" : "double in software",
		    two_digits(instructions_of_program(e->step)));
	else
		say(e, " * plgen --explain counts its instructions on a Cortex-M4.\n");
}

static void banner_cost(const struct emitter *e)
{
	const struct program *program = e->step->program;
	const char *of = !e->step->collocation ? format("form %s", step_form_text(e->step))
		       : e->step->taylor.expansion ? "a series, which may serve several steps"
		       : "an iteration of Newton's method,\n * of which an internal step takes two to four";
	say(e, "%s * One step of h = %s s, %s: %d multiplications, %d additions",
	    e->prints->step_note ? e->prints->step_note : "", readable_text(e->model->h), of,
	    program->multiplications, program->additions);
	if (e->step->refresh)
		say(e, ";\n * every %d steps, for the functions of the loads, %d and %d more",
		    e->step->refresh->steps, program->forcing_multiplications, program->forcing_additions);
	else if (program->forcing_multiplications)
		say(e, ", %d of them and %d for the functions of the loads", program->forcing_multiplications,
		    program->forcing_additions);
	if (program->calls)
		say(e, ", %d calls of the model's own functions", program->calls);
	say(e, ".\n");
	banner_board(e);
	if (peaks_by_values(e->step))
		banner_sentence(e, "Peaks are looked for by values inside a step where the last three ends do not "
				   "show that none is passed.");
	else if (has_peaks(e))
		say(e, " * The look for peaks takes %d and %d more, the outputs counted, where a bound shows that none "
		       "passes its peak.\n", program->peak_multiplications, program->peak_additions);
	if (e->step->refresh && e->step->refresh->terms)
		say(e, " * What loads add in the steps between comes from a table of %d bytes, each number correctly "
		       "rounded.\n", 8 * refresh_numbers(e->step));
}

/* Each need, and what is certified: two lines */
static void banner_needs(const struct emitter *e)
{
	for (int i = 0; i < e->model->needs.requirements && e->step->choice; i++)
		say(e, " * Needed: %s;\n *     %s.\n", printable(need_text(&e->model->needs.requirement[i])),
		    margin_text(e->step, i));
}

static const char *input_text(int hold)
{
	if (hold > 1)
		return format("between samples a polynomial of degree %d through the %d around the step; u is the one"
			      "\n *     %d h after its end, and n steps need those up to n + %d",
			      hold, hold + 1, (hold - 1) / 2, (hold - 1) / 2);
	return hold ? "a ramp from sample to sample; u is its value at the end of the step" : "held over the step";
}

static void banner_state(const struct emitter *e)
{
	int changes = e->system->segments - 1;
	say(e, " * State y = %s.\n", state_list(e->step->shown->model));
	if (units_text(e->step))
		banner_sentence(e, "%s", printable(units_text(e->step)));
	for (int i = 0; i < given_inputs(e); i++)
		say(e, " * Input %s: %s.\n", e->system->input[i].name, input_text(e->system->input[i].hold));
	if (changes > 0 && !keeps_modes(e))
		say(e, " * The loads change their formula %d time%s; "
		       "a step across a change is exact too, by %s that stops there.\n", changes,
		    changes > 1 ? "s" : "", e->model->switching ? "a search" : "a series");
	if (e->model->reduction.dropped)
		say(e, " * Reduced to what the outputs can see: %d of %d states.\n", e->system->states,
		    e->model->written->system.states);
}

/* What --fast would try: blocks of rows for a linear model, rotated phasors for loads that are not polynomials */
static void banner_fast(const struct emitter *e)
{
	const struct request *request = &e->model->request;
	bool rows = !request->rows && !request->single && is_linear_alone(e->step) && !e->step->is.tuned &&
		    !step_objection(e->step, CAN_ROWS);
	bool phasors = !request->refresh && !e->step->refresh && e->step->program->forcing_multiplications &&
		       !step_objection(e->step, CAN_REFRESH);
	if (!request->fast && !request->phasors && (rows || phasors))
		say(e, " * For long runs plgen --fast adds tables where they pay:%s%s%s.\n",
		    rows ? " outputs by blocks of rows" : "", rows && phasors ? "," : "",
		    phasors ? " rotated phasors of the loads" : "");
}

/* How NAME_run goes, where it has a choice */
static void banner_run(const struct emitter *e)
{
	const struct rows *rows = e->step->rows;
	if (rows)
		say(e, " * $n_run takes %d rows at a time, each from the state at the start of its block: "
		       "tables of %d numbers.\n", rows->count, row_numbers(e->step));
	else if (runs_in_blocks(e))
		say(e, " * $n_run takes %d rows at a time, those of an expansion.\n", e->model->truncation.over);
	else if (e->step->no.rows)
		say(e, " * $n_run goes step by step, without blocks of rows: %s.\n", e->step->no.rows);
	banner_fast(e);
}

/* Functions that there are not, and why; what one of them needs */
static void banner_functions(const struct emitter *e)
{
	const char *no_at = step_objection(e->step, CAN_AT), *no_jump = step_objection(e->step, CAN_JUMP);
	int states = is_blockwise(e) ? 0 : e->system->states;
	if (no_jump)
		say(e, " * There is no $n_jump: %s.\n", no_jump);
	else if (states > 12)
		say(e, " * $n_jump needs some %d KB of stack.\n", 1 + 32 * states * states / 1024);
	if (no_at)
		say(e, " * There is no $n_at: %s.\n", no_at);
	else if (e->step->layout.powers == PARABOLA)
		banner_sentence(e, "%s", spell(e, "$n_at is of fourth order: a parabola through the remainder at "
						  "both ends and in the middle."));
}

static void banner_asides(const struct emitter *e)
{
	int from = 0;
	for (const char *text = next_aside(&from); text; text = next_aside(&from))
		banner_sentence(e, "%s.", printable(text));
}

void emit_banner(const struct emitter *e)
{
	say(e, "/* $n: made by plgen " PLGEN_VERSION " from %s%s%s; do not edit.\n"
	       " * SPDX-License-Identifier: MIT-0\n"
	       " *\n", printable(e->model->spec->source->base), *e->options ? " with " : "", printable(e->options));
	banner_asides(e);
	banner_equations(e);
	banner_poles(e);
	say(e, " *\n");
	e->prints->banner(e);
	const char *irrationals = irrationals_text(&e->model->equations.irrationals);
	if (irrationals)
		say(e, " * %s\n", irrationals);
	banner_cost(e);
	banner_needs(e);
	banner_form(e);
	if (e->step->forced)
		banner_forced(e);
	banner_held(e);
	banner_state(e);
	banner_run(e);
	banner_functions(e);
	banner_ranges(e);
	say(e, " */\n");
}
