/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives of a step: the spec joined by its derivative is a model of its own, of which the steps of the derivatives
 * are taken. What it does not couple leaves no trace there, and each of its numbers is rounded once. */
#include "step/regions/regions.h"
#include "step/series/expansion.h"
#include "model/reads.h"
#include "model/tunable/tuning.h"

/* Whose factors the target makes, or whose step is no list of rows: it is stepped as the model is. */
static bool goes_apart(const struct step *step)
{
	return has_remainder(step) || step->model->spec->tuned.count > 0;
}

/* By the scheme of the model: the derivative of what it computes is what the scheme computes of the derivative. */
static const char *scheme_of_derivatives(const struct step *step)
{
	const struct model *model = step->model;
	if (!has_remainder(step))
		return scheme_name(SCHEME_EXACT);
	return model->request.at.scheme.source ? model->request.scheme : scheme_name(model->scheme);
}

/* Of an external function: by every state, then along every input */
static const char *external_columns(const struct model *model)
{
	const struct linear *system = &model->written->system;
	const char *list = model->written->names.state[0];
	for (int i = 1; i < system->states; i++)
		list = format("%s,%s", list, model->written->names.state[i]);
	for (struct symbol *s = model->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_INPUT && !s->delayed)
			list = format("%s,%s", list, s->name);
	return list;
}

/* Whether a formula may jump, and the derivatives with it */
static bool has_jumps(const struct step *step)
{
	return has_remainder(step) &&
	       (step->model->remainder.smooth.kind == SMOOTH_JUMP || loads_change(&step->model->system));
}

/* Whether series, or steps of a collocation, are as long as a tolerance allows, for all columns alike: the derivatives
 * behind a step are linear in those before it, and backwards the same. */
static bool holds_lengths(const struct step *step)
{
	return (step->collocation || (step->is.flow == FLOW_SERIES && step->taylor.expansion)) &&
	       step->model->truncation.adaptive && !step->taylor.switching && !goes_by_events(step->model) &&
	       !has_jumps(step);
}

/* What of the request concerns how a step is made faster, or reports it, does not hold for the derivatives. */
static struct request request_of_derivatives(const struct step *step, int first, int count)
{
	struct request request = step->model->request;
	request.external = false;
	if (step->model->request.external)
		request.sensitivity = external_columns(step->model);
	const bool held = holds_lengths(step), series = held && !step->collocation;
	request.again = (struct again){ .derivatives_from = first, .derivatives = count, .jumps = has_jumps(step),
				  .remainder = step->is.flow == FLOW_RECIPE, .probe = series, .held = held && !series,
				  .order = series ? order_of_step(step) : 0 };
	request.scheme = scheme_of_derivatives(step);
	if (goes_apart(step))
		request.prefix = format("%s_d%d", step->model->name, first);
	request.modes = NULL;
	request.reduce = request.compensated = request.selftest = false;
	request.fast = request.phasors = request.many.batch = false;
	request.rows = request.refresh = 1;
	request.form = step->form == FORM_DIRECT ? FORM_DIRECT : FORM_DELTA;
	return request;
}

int load_alike(const struct linear *system, const struct load *load)
{
	for (int l = 0; l < system->loads; l++) {
		const struct forcing *own = system->load[l].forcing, *other = load->forcing;
		if (mpq_equal(own->a, other->a) && mpq_equal(own->w, other->w) && mpq_equal(own->p, other->p))
			return l;
	}
	return NONE;
}

/* Phases and envelopes are those of the model. */
static void check_loads(const struct step *step, const struct step *made, const struct sensitivity *by)
{
	const struct linear *own = &step->branch->system, *system = &made->branch->system;
	for (int l = 0; l < system->loads; l++)
		if (load_acts(system, &system->load[l]) && !is_polynomial(system->load[l].forcing) &&
		    load_alike(own, &system->load[l]) == NONE)
			error(by->at, "another amplitude than 0 makes it one",
			      "the derivative by '%s' is driven by %s, which is no load of the model", by->name,
			      column_text(&system->load[l], 0));
}

static struct step *step_by(const struct step *step, const struct request *request)
{
	struct model *model = model_build(parse_spec(step->model->spec->source), request);
	model = model ? find_tuning(model, request) : NULL;
	struct step *made = model ? step_build(model) : NULL;
	if (!made)
		abandon();
	model->delays = NULL;                   /* its inputs are given to it */
	return made;
}

static void check_derivable(const struct step *step)
{
	const struct facts facts = facts_of_step(step);
	const struct objection against = objection_to(CAN_DERIVATIVES, &facts, step->model);
	if (against.why)
		error(step->model->spec->sensitivity[0].at, against.way, "%s%s", words_before(CAN_DERIVATIVES),
		      against.why);
}

/* Where loads change their formula, a step from change to change, each like an event */
static struct step *step_of_changes(const struct step *step)
{
	struct request request = request_of_derivatives(step, 0, 0);
	request.again.by_regions = true;
	request.form = FORM_AUTO;
	struct step *made = step_by(step, &request);
	const struct linear *own = &step->branch->system, *system = &made->branch->system;
	bool same = own->loads == system->loads;
	for (int l = 0; l < own->loads && same; l++)
		same = load_alike(own, &system->load[l]) == l;
	if (!same)
		error(step->model->spec->sensitivity[0].at, NULL, "a sensitivity beside loads of which some act in "
		      "outputs alone, and that change their formula in time, is not built yet");
	check_derivable(made);
	made->shown = step;
	return made;
}

static struct step *step_of(const struct step *step, int first, int count)
{
	const struct request request = request_of_derivatives(step, first, count);
	struct step *made = step_by(step, &request);
	if (!goes_apart(step))
		check_loads(step, made, &step->model->spec->sensitivity[first]);
	return made;
}

/* Nodes of a collocation solve the equations of all columns at once where masses move: not by lists, if it is up to
 * that. A constraint may have a multiplier for each coordinate. */
static int most_solved(const struct model *model)
{
	const int equations = model->written->n * (model->equations.correction ? 2 : 1);
	return model->equations.moving_mass ? LISTED_EQUATIONS / equations - 1 : LIMIT_UNROLLED_STATES;
}

/* As many together as have a step that is unrolled: those share the loads' functions. Those of a series share the
 * model's own, too. Parts of a step that events split have tables of their size. */
static int columns_together(const struct step *step)
{
	const struct model *model = step->model;
	const int states = model->written->system.states, forces = 3 * model->remainder.force_columns;
	const bool solves = step->collocation && holds_lengths(step);
	const int most = LIMIT_UNROLLED_STATES * (step->is.flow == FLOW_SERIES || solves ? 4 : 1);
	const bool splits = step->is.flow == FLOW_RECIPE && (has_jumps(step) || goes_by_events(model));
	const int together = splits ? LIMIT_TUNED_BLOCK / (states + forces + 3) - 1 : most / states - 1;
	const int least = solves && most_solved(model) < together ? most_solved(model) : together;
	return least > 1 ? least : 1;
}

/* A delay moves the jumps of an input, those at samples that are held, and at the first one of a ramp. */
static void derive_delays(const struct step *step, struct derivatives *d)
{
	const struct delays *delays = step->model->delays;
	struct collector collector = { .scheme = "exact" };
	RATIONAL slope = ZERO;
	double *late = ARRAY(double, (size_t)(d->columns * delays->count));
	for (int p = 0; p < d->columns; p++) {
		const struct sensitivity *by = &d->column[p];
		if (by->symbol->kind == SYMBOL_INPUT)
			error(by->at, NULL, "a derivative along '%s' is not built beside delayed inputs", by->name);
		for (int k = 0; k < delays->count; k++) {
			struct node *node = slope_by_param(step->model->spec, by, delays->delay[k].symbol->when);
			if (is_zero_node(node))
				continue;
			if (has_remainder(step) || step->model->switching || has_peak(step->model))
				error(by->at, NULL, "a derivative by '%s', which delays an input, is built for linear "
				      "models%s", by->name, has_peak(step->model) ? " without peaks" : "");
			collect_constant(&collector, node, slope);
			late[p * delays->count + k] = round_rational(slope);
			d->late = late;
		}
	}
}

/* Over the states as written, too */
static void show_derivatives(struct step *step)
{
	struct step *shown = NEW(struct step);
	*shown = *step->shown;
	shown->derivatives = step->derivatives;
	step->shown = shown;
}

static void derive(void *context)
{
	struct step *step = context;
	const struct spec *spec = step->model->spec;
	check_derivable(step);
	struct derivatives *d = NEW(struct derivatives);
	*d = (struct derivatives){ .columns = spec->sensitivities, .column = spec->sensitivity,
				    .apart = !step->model->switching && goes_apart(step) };
	for (int i = 0; i < d->columns; i++)
		d->seeded = d->seeded || d->column[i].symbol->kind == SYMBOL_INPUT;
	if (step->model->delays)
		derive_delays(step, d);
	if (!step->model->switching && loads_change(&step->model->system) && !d->apart)
		d->regions = step_of_changes(step);
	if (step->model->switching || d->regions) {
		step->derivatives = d;
		d->varied = varied_models(step, d->regions ? d->regions->model : step->model);
		if (step->model->relative)
			show_derivatives(step);
		return;
	}
	const int together = columns_together(step);
	for (int first = 0; first < d->columns; first += together) {
		const int left = d->columns - first, count = left < together ? left : together;
		struct derivative_block *block = MORE(d->block, d->blocks);
		*block = (struct derivative_block){ first, count, NULL };
		d->block[d->blocks - 1].step = step_of(step, first, count);
		if (has_peak(step->model) && !d->block[d->blocks - 1].step->series.emitted)
			error(spec->sensitivity[first].at, "with fewer states, or by fewer params at once",
			      "a sensitivity of peaks needs derivatives inside steps, which this model has none of");
	}
	step->derivatives = d;
}

static void take_external(void *context)
{
	const struct model *model = context;
	for (struct symbol *s = model->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_INPUT && s->hold > 0)
			error(s->at, NULL, "--external casadi takes held inputs, and '%s' is a ramp", s->name);
	if (model->spec->sensitivities > 0)
		say_note(model->spec->sensitivity[0].at, "--external casadi has derivatives by states and inputs");
	if (!parse_sensitivities(model->spec, source_argument(external_columns(model))))
		abandon();
}

bool find_derivatives(struct step *step)
{
	if (step->model->request.external &&
	    !statement_guard(take_external, (void *)(uintptr_t)step->model))
		return false;
	return step->model->spec->sensitivities == 0 || statement_guard(derive, step);
}

bool derivatives_read_load(const struct step *step, int load)
{
	bool read = false;
	for (int b = 0; step->derivatives && !step->derivatives->apart && b < step->derivatives->blocks; b++) {
		const struct step *made = step->derivatives->block[b].step;
		const int own = load_alike(&made->branch->system, &step->branch->system.load[load]);
		read = read || (own != NONE && load_acts(&made->branch->system, &made->branch->system.load[own]));
	}
	return read;
}
