/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The comment at the top: the equations, the poles, what the scheme does, what a step costs. */
#include "emit/linear/blocks.h"
#include "declarations.h"
#include "steps.h"
#include "emit/series/series.h"
#include "emit/tunable/tunable.h"
#include "model/linear/relative.h"
#include "report/report.h"
#include "step/cost.h"
#include "step/linear/forms.h"
#include "step/linear/rows.h"

#include <stdlib.h>
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

/* Sentences, and lists that are indented */
static void banner_words(const struct emitter *e, void (*print)(FILE *to, const struct step *step))
{
	char *text = NULL, *end;
	size_t size;
	FILE *to = need_memory(open_memstream(&text, &size));
	print(to, e->step);
	fclose(to);
	for (char *line = need_memory(text); *line; line = end + 1) {
		end = strchr(line, '\n');
		*end = 0;
		if (*line && *line != ' ')
			say_words(e, printable(line));
		else
			say(e, " *%s%s\n", *line ? " " : "", printable(line));
	}
	free(text);
}

static void banner_parts(const struct emitter *e)
{
	const struct spec *spec = e->model->spec;
	for (int i = 0; i < spec->assembly.parts; i++)
		if (parts_text(spec, i))
			say(e, "%s%s.\n", i ? " *     and " : " *\n * Of parts: ", printable(parts_text(spec, i)));
}

#define banner_sentence(e, ...) say_words(e, format(__VA_ARGS__))

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
		say(e, " * Only loads and inputs act on a centre; rounding of inner forces does not change it.\n");
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

static void banner_flush(const struct emitter *e)
{
	const struct denormal_flush *flush = e->step->linear.flush;
	const bool single = e->model->request.single;
	say(e, " * Denormal flush: every 64 steps those states are set to 0 that are below ");
	if (flush->decaying > 0)
		say(e, "%s%s", single ? "2^-116" : "2^-963",
		    flush->decaying < flush->parts ? " where motions decay" : "");
	if (flush->beside)
		say(e, "%s%s of the largest%s", flush->decaying > 0 ? ", or\n * " : "", single ? "2^-120" : "2^-900",
		    flush->parts > 1 ? " that they act on" : "");
	say(e, ".\n");
}

/* What the form does to rounding, and what rounding has done to its constants */
static void banner_form(const struct emitter *e)
{
	static const char *const kept[STEP_FORMS] = {
		[FORM_DELTA] = "Delta: y += (Phi - I) y, Phi - I rounded relative to itself",
		[FORM_KICK_DRIFT_KICK] = "Kick, drift, kick: p += X q; q += S p; p += X q, "
					 "S and X symmetric: symplectic whatever their rounding"
	};
	if (kept[e->step->form])
		say(e, " * %s%s.\n", kept[e->step->form], e->step->program->compensated
		    ? "; factors are double-double,\n * and so is the state, whose low parts are in low" : "");
	if (e->step->modal)
		banner_modes(e);
	if (e->step->no.modal)
		say(e, " * The form modal would be cheaper for so few outputs, but %s.\n", e->step->no.modal);
	if (e->step->linear.flush)
		banner_flush(e);
	if (e->model->relative)
		banner_relative(e);
	if (e->step->carried.count)
		say(e, " * No other state depends on %s: the rounding errors of %s are carried along.\n",
		       carried_text(e), e->step->carried.count > 1 ? "each" : "it");
	banner_words(e, text_rounding);
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
	if (unbounded_text(e->step))
		banner_sentence(e, "There is no bound on the instructions of a step: %s.", unbounded_text(e->step));
	else
		banner_sentence(e, "Fitted bound on the instructions of a step by gcc -O2, no number subnormal: %s.",
				worst_text(e->step));
}

static void banner_cost(const struct emitter *e)
{
	const char *of = !e->step->collocation ? format("form %s", step_form_text(e->step))
		       : e->step->taylor.expansion ? "a series, which may serve several steps"
		       : "an iteration of Newton's method,\n * of which an internal step takes two to four";
	say(e, " * One step of h = %s s, %s%s%s.\n", readable_text(e->model->h), of,
	    e->prints->step_note ? e->prints->step_note : ": ", operations_text(e->step));
	banner_board(e);
	banner_words(e, text_peaks);
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
	if (e->step->shown->no.phi)
		say(e, " * There is no Phi: %s.\n", e->step->shown->no.phi);
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
	banner_words(e, text_written);
	banner_parts(e);
	banner_words(e, text_linear_part);
	say(e, " *\n");
	banner_words(e, text_scheme);
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
