/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a parsed spec to a model: params, scheme, step and initial values here, the rest by the files before it. */
#include "building.h"
#include "capability.h"
#include "checks.h"
#include "model.h"
#include "model/contacts/contacts.h"
#include "model/linear/relative.h"
#include "model/tunable/tuning.h"

#include <string.h>

/* ---- params, lets ---- */

static void define_override(struct building *b, const struct definition *d)
{
	struct symbol *symbol = spec_find(b->spec, d->name);
	if (symbol && symbol->broken)
		return;
	if (!symbol || (symbol->kind != SYMBOL_PARAM && symbol->kind != SYMBOL_MATRIX)) {
		const char *note = symbol ? "-D and --params give params and matrices another value"
					  : spec_suggestion(b->spec, d->name);
		say_error(d->at, note, symbol ? "'%s' is not a param" : "no param is named '%s'", d->name);
		return;
	}
	const struct place given = symbol->value->start;        /* when a model is built again, by this one itself */
	if (given.source == d->at.source && (given.offset < d->from || given.offset >= d->until))
		say_error(d->at, NULL, "'%s' is given already", d->name);
	struct node *value = parse_definition(b->spec, d, symbol);
	if (value)
		symbol->value = value->unit ? value : with_unit(value, symbol->unit_written ? symbol->unit : NULL);
	else
		symbol->broken = true;
}

static void set_value(struct symbol *symbol, struct place at, mpq_srcptr value)
{
	symbol->value = NEW(struct node);
	*symbol->value = (struct node){ .kind = NODE_NUMBER, .at = at, .start = at, .end = at };
	mpq_init(symbol->value->number);
	mpq_set(symbol->value->number, value);
}

/* Whether a symbol of the statement of `first`, its first one, is broken; those of a statement stand together */
static bool statement_failed(const struct symbol *first)
{
	for (const struct symbol *s = first; s && s->statement == first->statement; s = s->next)
		if (s->broken && s->index >= 0)
			return true;
	return false;
}

struct symbol_work {
	struct building *b;
	struct symbol *symbol;
};

static void evaluate_symbol(void *context)
{
	struct symbol_work *work = context;
	const struct place at = work->symbol->at;
	struct node name = { .kind = NODE_NAME, .at = at, .start = at, .end = at, .symbol = work->symbol };
	collect(&work->b->collector, &name);
}

static void evaluate_params(struct building *b)
{
	b->collector.constant_only = true;
	bool failed = false;
	for (struct symbol *s = b->spec->first, *before = NULL; s; before = s, s = s->next) {
		failed = before && before->statement == s->statement ? failed || (before->broken && before->index >= 0)
								     : statement_failed(s);
		if ((s->kind != SYMBOL_PARAM && s->kind != SYMBOL_MATRIX) || s->broken)
			continue;
		if (s->made.progress == COLLECTING || failed ||
		    !statement_guard(evaluate_symbol, &(struct symbol_work){ b, s }))
			s->broken = true;
	}
	b->collector.constant_only = false;
}

/* A let that nothing linear uses may be anything; but a division by zero in it is reported all the same. */
static void evaluate_lets(struct building *b)
{
	b->collector.tolerant = true;
	for (struct symbol *s = b->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_LET && !s->broken && s->made.progress != COLLECTED)
			statement_guard(evaluate_symbol, &(struct symbol_work){ b, s });
	b->collector.tolerant = false;
}

/* ---- scheme and step ---- */

/* Without a scheme: exact where the model allows it, by the equations. */
static void choose_scheme(void *context)
{
	struct building *b = context;
	const char *requested = b->request->scheme, *blank = requested ? strchr(requested, ' ') : NULL;
	const char *wanted = blank   ? format("%.*s", (int)(blank - requested), requested)
			     : requested ? requested
				     : b->spec->request.scheme;
	b->collector.scheme = "exact";
	b->collector.closed = b->request->solution;
	b->collector.keep = wanted || b->request->solution ? KEEP_PIECEWISE : KEEP_ALL;
	if (!wanted)
		return;
	struct place at = requested ? (struct place){ source_argument(requested), 0 } : b->spec->request.scheme_at;
	struct node *order = requested ? NULL : b->spec->request.order,
		*over = requested ? NULL : b->spec->request.over;
	enum scheme scheme;
	if (scheme_of(wanted, &scheme)) {
		b->model->scheme = b->request->solution ? SCHEME_EXACT : scheme;
		b->model->request.at.scheme = at;
		b->model->request.series.order =
			blank ? parse_scheme_order(b->spec, at.source, (size_t)(blank - requested), &over) : order;
		b->model->request.series.over = over;
		b->collector.scheme = scheme_name(b->model->scheme);
		b->collector.keep = b->model->scheme == SCHEME_EXACT ? KEEP_PIECEWISE : KEEP_ALL;
		return;
	}
	const char *nearest = nearest_scheme(wanted);
	b->collector.keep = KEEP_ALL;           /* whatever was meant: one message is enough */
	error(at, nearest ? format("did you mean '%s'?", nearest) : format("the schemes are %s", all_schemes(", ")),
	      "unknown scheme '%s'", wanted);
}

static void evaluate_step(void *context)
{
	struct building *b = context;
	struct place at = b->spec->request.step_at;
	struct node *node = requested_or_written(b, b->request->step, b->spec->request.step, &at);
	b->model->request.at.step = b->model->request.at.end = at;
	if (b->request->step)
		check_time(node);
	collect_constant(&b->collector, node, b->model->h);
	if (mpq_sgn(b->model->h) <= 0)
		error(at, NULL, "the step must be above 0");
	if (beyond_range(b->model->h) || round_rational(b->model->h) == 0)
		error(at, NULL, "the step is beyond the range of %s", target_name());
}

/* ---- initial values ---- */

struct initial_work {
	struct building *b;
	int index;
	bool known;                             /* each equation was read, and with it the order of its coordinates */
};

static void evaluate_initial(void *context)
{
	struct initial_work *work = context;
	const struct initial *initial = &work->b->spec->states.initial[work->index];
	const struct symbol *coord = initial->coord;
	struct model *model = work->b->model;
	int first = coord->index + (initial->component ? initial->component - 1 : 0),
	    count = initial->component || !coord->length ? 1 : coord->length;
	struct value *value = collect_constants(&work->b->collector, initial->value);
	bool single = value->rows == 1 && value->columns == 1;
	if (initial->primes == 1 && coord->highest == 1 && !work->known)
		return;
	if (initial->primes == 1 && coord->highest == 1)
		error(initial->at, "it appears only as a first derivative, so its start fixes all",
		      "%s is of first order: its derivative has no initial value", coord->name);
	if (!single && value->rows * value->columns != count)
		error(initial->value->start, NULL, "sizes do not fit: %s has %d components, the value is %d x %d",
		      coord->name, count, value->rows, value->columns);
	for (int i = 0; i < count; i++) {
		int state = initial->primes ? model->system.velocity[first + i] : first + i;
		constant_value(&work->b->collector, value->cell[single ? 0 : i], model->initial[state]);
		if (beyond_range(model->initial[state]))
			error(initial->value->start, NULL, "the initial value is beyond the range of %s",
			      target_name());
	}
}

static void evaluate_initials(struct building *b)
{
	size_t failed = SIZE_MAX;
	const bool known = !diagnostics_errors();
	for (int i = 0; i < b->spec->states.initials; i++) {
		size_t statement = b->spec->states.initial[i].statement;
		if (statement != failed && !statement_guard(evaluate_initial, &(struct initial_work){ b, i, known }))
			failed = statement;
	}
	for (int i = 0; b->request->again.start && i < b->model->system.states; i++)
		mpq_set_d(b->model->initial[i], b->request->again.start[i]);
}

/* ---- the whole ---- */

/* Coordinates that are kept in the place of written ones, with an order each: each has a symbol of its own */
static void name_relative(struct building *b)
{
	struct model *model = b->model;
	const struct relative *relative = model->relative;
	size_t n = (size_t)relative->n;
	model->n = model->system.n = relative->n;
	model->frame.coord = ARRAY(struct symbol *, n);
	model->frame.coords = relative->n;
	model->names.coord = relative->name;
	model->equations.owner = ARRAY(int, n);
	model->equations.reversed = relative->written->equations.reversed;
	for (int j = 0; j < relative->n; j++) {
		const struct model *written = relative->written;
		int like = j < written->n ? j : 0;
		model->frame.coord[j] = NEW(struct symbol);
		*model->frame.coord[j] = (struct symbol){ .kind = SYMBOL_COORD, .name = relative->name[j],
							  .at = written->frame.coord[like]->at, .index = j,
							  .highest = relative->order[j] };
		model->equations.owner[j] = j < written->n ? written->equations.owner[j] : j;
	}
}

static void name_coordinates(struct building *b)
{
	struct model *model = b->model;
	if (model->relative) {
		name_relative(b);
		return;
	}
	size_t n = (size_t)b->spec->count.components;
	model->n = model->system.n = b->spec->count.components;
	const size_t all = n + (size_t)b->spec->count.multipliers;
	model->frame.coords = model->n;
	model->frame.coord = ARRAY(struct symbol *, all);
	model->names.coord = ARRAY(const char *, all);
	for (struct symbol *s = b->spec->first; s; s = s->next) {
		if (s->kind == SYMBOL_MULTIPLIER && !s->broken) {
			model->frame.coord[model->n + s->index] = s;
			model->names.coord[model->n + s->index] = s->name;
			s->highest = 2;         /* as if it were an acceleration */
		}
		if (s->kind != SYMBOL_COORD)
			continue;
		for (int i = 0; i < (s->length ? s->length : 1); i++) {
			model->frame.coord[s->index + i] = s;
			model->names.coord[s->index + i] = s->length ? format("%s[%d]", s->name, i + 1) : s->name;
		}
	}
}

/* Of a derivative that of what it is of: no energy may name it. */
static int order_of_coordinate(const struct spec *spec, int coord)
{
	const int behind = spec->joined.along ? coord - spec->joined.own : -1;
	const int of = behind < 0 ? coord : behind % spec->joined.stride;
	return find_order(spec, of < spec->joined.own ? of : coord);
}

/* The states are the coordinates, then the velocities of those of second order. A vector is of one order. */
static void name_states(struct building *b)
{
	struct model *model = b->model;
	struct linear *system = &model->system;
	size_t n = (size_t)model->n;
	model->names.state = ARRAY(const char *, 2 * n);
	system->velocity = ARRAY(int, n);
	system->coord = ARRAY(int, 2 * n);
	system->states = model->n;
	for (int j = 0; j < model->n && model->n <= LIMIT_STATES && !model->relative; j++) {
		int order = order_of_coordinate(b->spec, j);
		model->frame.coord[j]->highest =
			order > model->frame.coord[j]->highest ? order : model->frame.coord[j]->highest;
	}
	for (int j = 0; j < model->n; j++) {
		model->names.state[j] = model->names.coord[j];
		system->coord[j] = j;
		system->velocity[j] = model->frame.coord[j]->highest == 2 ? system->states : -1;
		if (system->velocity[j] < 0)
			continue;
		system->coord[system->states] = j;
		model->names.state[system->states++] =
			format(strchr(model->names.coord[j], ' ') ? "(%s)'" : "%s'", model->names.coord[j]);
	}
}

static void check_prefix(const struct building *b)
{
	const char *prefix = b->model->name, *why = prefix_objection(prefix);
	bool given = b->request->prefix != NULL;
	struct place at = given ? (struct place){ source_argument(prefix), 0 } : b->spec->name_at;
	bool identifier = *prefix &&
			  prefix[strspn(prefix, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789")] ==
				  0 &&
			  !strchr("0123456789", prefix[0]);
	if (given && !identifier)
		say_error(at, NULL, "'%s' is not a C identifier", prefix);
	else if (why)
		say_error(at, given ? NULL : "give another with --prefix NAME",
			  "'%s' %s and cannot name generated code", prefix, why);
}

static void check_parts(const struct building *b)
{
	const struct spec *spec = b->spec;
	if (spec->count.coords == 0)
		say_error(spec->end, "coord x", "missing coordinates: there is no statement 'coord'");
	if (!spec->request.step && !b->request->step)
		say_error(spec->end, "step 0.01, or --step 0.01 on the command line", "missing step");
	if (b->model->system.states > LIMIT_STATES)
		say_error(b->model->frame.coord[b->model->n - 1]->at, NULL, "more states than the limit of %d",
			  LIMIT_STATES);
}

static void collect_interval(struct building *b, struct segment_equations *segment_equations)
{
	forget_lets(b->spec);
	collect_equations(b, segment_equations);
	collect_impacts(b, segment_equations);
	forget_lets(b->spec);                   /* collected anew: in an output no atom is kept */
	collect_outputs(b, segment_equations);
}

/* Intervals that were one when they were collected get residuals of their own. */
static void part_segments(struct segment_equations *segment_equations, int count)
{
	for (int i = count - 1; i > 0; i--) {
		struct segment_equations *s = &segment_equations[i];
		struct residual *residual = s->residual;
		if (residual != s[-1].residual)
			continue;
		s->residual = ARRAY(struct residual, s->residuals);
		for (int k = 0; k < s->residuals; k++)
			s->residual[k] = residual[k];
	}
}

/* Equations, impacts and outputs in each interval of time. When a change of formula is met for the first time, the
 * intervals before that are known, even where it divides them: what they read does not change there. */
static void collect_intervals(struct building *b)
{
	struct collector *c = &b->collector;
	/* of the intervals that the changes known then left, the first `done` of them */
	struct segment_equations *old = NULL;
	const mpq_t *change = NULL;
	int known, done = 0;
	do {
		const mpq_t *list = c->change;
		known = c->changes;
		b->segment_equations = ARRAY(struct segment_equations, known + 1);
		int within = 0;                 /* the old interval in which this one lies */
		for (c->interval = 0;
		     c->interval <= known && c->changes == known && !(c->interval && diagnostics_errors());
		     c->interval++) {
			if (within < done && c->interval > 0 && mpq_equal(change[within], list[c->interval - 1]))
				within++;
			if (within < done)
				b->segment_equations[c->interval] = old[within];
			else
				collect_interval(b, &b->segment_equations[c->interval]);
		}
		discard(old);
		old = b->segment_equations;
		change = list;
		done = c->interval - 1;         /* in the last one a change was met */
	} while (c->changes != known && !diagnostics_errors());
	part_segments(b->segment_equations, known + 1);
	c->interval = 0;
	b->model->system.segments = c->changes + 1;
	b->model->system.change = c->change;
}

struct derivation {
	struct building *b;
	int derived;
};

/* As a number, and as a form over the params that are given */
static void collect_derived(void *context)
{
	const struct derivation *d = context;
	struct collector own = d->b->collector;
	const int given = d->b->spec->tuned.count - d->b->spec->tuned.derived;
	struct symbol *symbol = d->b->spec->tuned.tunable[given + d->derived].symbol;
	evaluate_symbol(&(struct symbol_work){ d->b, symbol });
	forget_lets(d->b->spec);
	own.params = PARAMS_ATOMS;
	own.keep = KEEP_ALL;
	own.given = own.whole_time = true;
	d->b->model->params.derived[d->derived] = collect(&own, symbol->value)->cell[0];
	forget_lets(d->b->spec);
}

static void derive_model(struct building *b)
{
	derive_params(b->spec);
	b->model->params.leads.params = b->spec->tuned.count;
	b->model->params.derived = ARRAY(const struct form *, (size_t)b->spec->tuned.derived + 1);
	for (int k = 0; k < b->spec->tuned.derived && !b->request->again.tunable; k++)
		statement_guard(collect_derived, &(struct derivation){ b, k });
}

/* Where a scheme has a remainder, the instance's own params stand in it: collected anew, with them as atoms. Of
 * regions they move breakpoints and add forces, as held inputs do. */
static void collect_with_params(struct building *b)
{
	struct collector *c = &b->collector;
	const bool left = !b->request->again.factor && leaves_over(b);
	if (!left)
		derive_model(b);
	if (!left && !b->request->again.factor && (b->request->solution || !needs_regions(b)))
		return;
	spread_tuned(b->spec);
	if (!left)
		part_factors(b);
	b->nominal = b->segment_equations;
	b->nominals = c->changes + 1;
	b->model->params.kept = true;
	c->params = left ? PARAMS_ATOMS : PARAMS_INPUTS;
	c->inputs = b->spec->count.inputs;
	c->keep = left ? KEEP_ALL : KEEP_PIECEWISE;
	c->changes = 0;
	c->change = NULL;
	collect_intervals(b);
}

/* What is known before anything is collected */
static void begin_model(struct building *b)
{
	struct model *model = b->model;
	const struct request *request = b->request;
	mpq_srcptr zero = rationals(1)[0];
	model->spec = b->spec;
	model->request = *request;
	model->written = request->again.relative ? request->again.relative->written : model;
	model->relative = request->again.relative;
	model->frame.form = model->relative ? model->relative->form : NULL;
	if (model->relative)                    /* its params were collected for the written one */
		b->collector.irrationals = model->written->equations.irrationals;
	b->collector.frame = &model->frame;
	model->equations.atoms = b->collector.atoms = atoms_new();
	model->params.leads.params = b->spec->tuned.count;
	b->collector.leads = &model->params.leads;
	model->request.at.form = (struct place){ source_argument(step_form_name(request->form)), 0 };
	model->request.at.compensated = (struct place){ source_argument("compensated"), 0 };
	model->name = request->prefix ? request->prefix : b->spec->name;
	mpq_init(model->h);
	for (struct symbol *s = b->spec->first; s; s = s->next)
		s->made.full = NULL;
	b->polynomial = forcing_of(&b->collector, zero, zero, zero);
}

/* Params, equations and outputs as forms; initial values and the step. With values of the tunable params no more than
 * the equations: what nothing reads may not be defined there. */
static void collect_model(struct building *b)
{
	struct model *model = b->model;
	const struct request *request = b->request;
	bool all = !request->again.tunable;
	if (all)
		evaluate_params(b);
	statement_guard(choose_scheme, b);
	if (all)
		statement_guard(evaluate_truncation, b);
	if (all && b->spec->request.events)
		statement_guard(evaluate_events, b);
	if (all && (b->spec->modes.at.source || request->modes))
		statement_guard(evaluate_modes, b);
	b->collector.constant_only = false;     /* where what had to be constant was not */
	collect_intervals(b);
	if (b->spec->tuned.count > 0 && !diagnostics_errors())
		go_by_regions_where_tuned(b);
	if (b->spec->tuned.count > 0 && (all || request->again.factor) && !diagnostics_errors())
		collect_with_params(b);
	gather_impacts(b);
	if (all)
		evaluate_lets(b);
	model->initial = rationals(model->system.states);
	if (all && model->relative)
		relative_values(model, model->written->initial, model->initial);
	else if (all)
		evaluate_initials(b);
	if (all)
		evaluate_absolutes(b);
	if (all && !model->relative)
		evaluate_ranges(b);
	evaluate_param_ranges(b);
	if (all && (b->spec->request.step || request->step))
		statement_guard(evaluate_step, b);
	b->collector.constant_only = false;
	find_delays(b);
}

/* It only leaves states out: where that cannot be all are kept. */
static void check_reduction(const struct building *b)
{
	struct model *model = b->model;
	const struct facts facts = facts_of_model(model);
	const char *why = objection_to(CAN_REDUCTION, &facts, model).why;
	if (!model->request.reduce || !why)
		return;
	stand_aside(b->spec->name_at, "--reduce", why);
	model->request.reduce = false;
}

/* Forms to matrices, operators, outputs, regions */
static void build_parts(struct building *b)
{
	struct model *model = b->model;
	bool clean = !diagnostics_errors();
	if (clean)
		check_parts(b);
	if (clean && model->n > 0 && model->system.states <= LIMIT_STATES)
		build_system(b);
	if (!diagnostics_errors())
		build_operators(b);
	check_reduction(b);
	if (!diagnostics_errors())
		build_outputs(b);
	if (!diagnostics_errors())
		check_contact_outputs(b);
	if (!diagnostics_errors() && model->switching)
		build_regions(b);
}

static void forget_tunables(struct spec *spec)
{
	for (int k = 0; k < spec->tuned.count; k++)
		spec->tuned.tunable[k].symbol->tuning = (struct symbol_tuning){ 0 };
	spec->tuned.count = 0;
}

/* Which are asked for, and the equations of those that this model has */
static void take_derivatives(void *context)
{
	struct building *b = context;
	const struct request *request = b->request;
	if (request->sensitivity && !parse_sensitivities(b->spec, source_argument(request->sensitivity)))
		abandon();
	const struct again *again = &request->again;
	add_derivatives(b->spec, again->derivatives_from, again->derivatives, again->jumps, again->remainder,
			again->probe);
	b->spec->joined.held = again->held;
}

/* Params that are varied; of tunable ones behind derivatives, which go through what is made of them. */
static void set_values(struct building *b)
{
	const struct again *again = &b->request->again;
	if (again->varied)
		set_value(spec_find(b->spec, again->varied), b->spec->name_at, again->value);
	statement_guard(take_derivatives, b);
	if (again->tunable)
		derive_params(b->spec);
	for (int i = 0; again->tunable && i < b->spec->tuned.count; i++)
		set_value(b->spec->tuned.tunable[i].symbol, b->spec->tuned.tunable[i].at, again->tunable[i]);
}

struct model *model_build(struct spec *spec, const struct request *request)
{
	struct building b = { .spec = spec, .model = NEW(struct model), .request = request };
	struct model *model = b.model;
	if (request->linear.where)                 /* params are those of the spec */
		forget_tunables(spec);
	begin_model(&b);
	for (int i = 0; i < request->definitions.count; i++)
		define_override(&b, &request->definitions.definition[i]);
	set_values(&b);
	if (!request->again.relative && (request->prefix || (model->name && *model->name)))
		check_prefix(&b);
	name_coordinates(&b);
	name_states(&b);
	give_states_in_units(&b);
	if (spec->units.written && !spec->units.adopted && !request->again.tunable && !request->again.relative)
		check_dimensions(spec);
	collect_model(&b);
	build_parts(&b);
	model->equations.irrationals = b.collector.irrationals;
	if (!diagnostics_errors() && request->linear.where) {
		silent_guard(find_nonlinear, &b);
		if (model->nonlinear.terms > 0 || strcmp(request->linear.where, EQUILIBRIA) == 0)
			statement_guard(linearise, &b);
	}
	if (!diagnostics_errors() && request->explained && spec->lagrange.energies)
		silent_guard(find_symmetries, &b);
	bool reported = request->linear.where || request->solution || request->again.tunable ||
			request->again.relative || request->again.undivided || request->again.derivatives > 0 ||
			request->again.varied;
	if (!diagnostics_errors() && (!reported || request->again.derivatives > 0))
		judge_smoothness(&b);
	if (!diagnostics_errors() && !reported && warnings_are_heard())
		warn(&b);
	if (!diagnostics_errors() && !request->solution && !request->again.tunable)
		silent_guard(find_nonlinear, &b);
	return diagnostics_errors() ? NULL : model;
}

struct model *model_copy(const struct model *model)
{
	struct model *copy = NEW(struct model);
	*copy = *model;
	if (model->written == model)
		copy->written = copy;
	return copy;
}

void argument_value(struct model *model, const char *text, mpq_ptr value)
{
	struct collector collector = { .scheme = "exact" };
	struct place at = { source_argument(text), 0 };
	struct node *node = parse_argument(model->spec, at.source, 0, at.source->length);
	if (!node)
		abandon();
	check_time(node);
	collect_constant(&collector, node, value);
	if (mpq_sgn(value) < 0)
		error(at, NULL, "--solution takes a time that is not below 0");
	model->request.at.end = at;
}
