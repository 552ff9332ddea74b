/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Impacts: where a guard comes true by crossing, the state jumps, linearly. One that turns the speed of its guard, s to
 * -e s, along one direction, v -> v - (1 + e) d s, is a bounce; after infinitely many of them in finite time, or after
 * one where e is 0, its contact rests. */
#include "model/building.h"
#include "inner.h"
#include "model/capability.h"
#include "model/state_mass.h"
#include "model/tunable/tuning.h"

/* ---- guards and jumps as forms ---- */

static struct form *scalar_form(struct building *b, struct node *node)
{
	return scalar_of(collect(&b->collector, node), node, NULL);
}

static void check_not_tuned(const struct node *node, const char *what)
{
	const struct node *tuned = first_tuned(node);
	if (tuned)
		error(tuned->at, "beside a series it may stand in forces, loads and the force of friction",
		      "%s takes no tunable param beside the remainder: '%s'", what, tuned->symbol->name);
}

static void check_linear(const struct building *b, const struct node *node, const struct form *form, const char *what)
{
	for (int i = 0; i < form->terms; i++) {
		if (form->term[i].basis.kind == BASIS_ATOM)
			check_not_tuned(node, what);
		if (form->term[i].basis.kind == BASIS_ATOM)
			error(node->start, NULL, "%s is linear in states, loads and inputs, and '%s' is not", what,
			      text_between(node->start, node->end));
		if (is_highest(&b->model->frame, &form->term[i].basis))
			error(node->start, "it follows from the equations, which change there",
			      "%s cannot read the highest derivative of %s", what,
			      b->model->names.coord[form->term[i].basis.index]);
	}
}

static bool is_rising(const struct when *when)
{
	return when->guard->comparison == CMP_GT || when->guard->comparison == CMP_GE;
}

/* The gap of a stop is a length, and what comes back of the speed a part of it. */
static void check_stop(struct building *b, const struct when *when, mpq_ptr restitution, mpq_ptr gap)
{
	collect_constant(&b->collector, when->restitution, restitution);
	if (b->collector.params == PARAMS_ATOMS)
		check_not_tuned(when->restitution, "a restitution");
	if (mpq_sgn(restitution) < 0 || mpq_cmp_ui(restitution, 1, 1) > 0)
		error(when->restitution->start, "the part of the speed that comes back, 0 to 1",
		      "restitution %s is not within 0 and 1", readable_text(restitution));
	struct form *form = scalar_form(b, when->gap);
	if (is_constant(form))
		constant_value(&b->collector, form, gap);
	if (mpq_sgn(gap) < 0)
		error(when->gap->start, "a gap is 0 or more: what stands first comes up to the second",
		      "a gap of %s is below 0", readable_text(gap));
}

struct collecting {
	struct building *b;
	const struct when *when;
	struct impact_law *impact_law;
};

static int state_at(const struct building *b, const struct node *target)
{
	const struct symbol *s = target->symbol;
	int coord = s->index + (target->component ? target->component - 1 : 0);
	if (target->primes >= s->highest)
		error(target->at, NULL, "'%s' follows from the equations: it cannot jump",
		      text_between(target->start, target->end));
	return target->primes ? b->model->system.velocity[coord] : coord;
}

static void collect_jumps(struct building *b, const struct when *when, struct impact_law *impact_law)
{
	impact_law->jump = ARRAY(struct jump, (size_t)when->jumps + (size_t)b->model->n);
	for (int i = 0; i < when->jumps; i++) {
		struct jump *jump = &impact_law->jump[impact_law->jumps++];
		jump->state = state_at(b, when->jump[i].target);
		jump->form = scalar_form(b, when->jump[i].value);
		check_linear(b, when->jump[i].value, jump->form, "a jump");
	}
}

/* Of a spec with its derivatives */
static void collect_slopes(struct building *b, const struct when *when, struct impact_law *law)
{
	law->slope = ARRAY(struct impact_slope, (size_t)when->slopes);
	for (int k = 0; k < when->slopes; k++) {
		const struct when_slope *from = &when->slope[k];
		struct impact_slope *to = &law->slope[k];
		struct form *guard = scalar_form(b, from->guard);
		to->guard = is_rising(when) ? guard : form_difference(NEW(struct form), guard);
		mpq_init(to->restitution);
		if (from->restitution)
			collect_constant(&b->collector, from->restitution, to->restitution);
		to->jump = ARRAY(struct jump, (size_t)when->jumps);
		for (to->jumps = 0; to->jumps < when->jumps; to->jumps++) {
			const int state = state_at(b, when->jump[to->jumps].target), n = b->model->n;
			const int own = b->model->system.coord[state];
			const int coord = b->spec->joined.own + k * b->spec->joined.stride + own;
			to->jump[to->jumps].state = state < n ? coord : b->model->system.velocity[coord];
			to->jump[to->jumps].form = scalar_form(b, from->jump[to->jumps]);
		}
	}
}

static void collect_impact(void *context)
{
	struct collecting *work = context;
	struct building *b = work->b;
	const struct when *when = work->when;
	struct impact_law *impact_law = work->impact_law;
	struct node *const *side = when->guard->child;
	mpq_inits(impact_law->restitution, impact_law->gap, impact_law->at, impact_law->factor, NULL);
	if (when->restitution)
		check_stop(b, when, impact_law->restitution, impact_law->gap);
	for (int i = 0; i < 2 && when->chosen; i++)
		if (collect(&b->collector, side[i])->rows > 1)
			error(when->at, "with the equation of each component, it is", "a sensitivity where a vector "
			      "chooses a formula for each component is not built");
	struct form *left = scalar_form(b, side[0]), *right = scalar_form(b, side[1]);
	collect_slopes(b, when, impact_law);
	if (!when->chosen && (!when->restitution || !keeps_smooth(b, left) || !keeps_smooth(b, right))) {
		check_linear(b, side[0], left, "a guard");
		check_linear(b, side[1], right, "a guard");
	}
	impact_law->guard = is_rising(when) ? form_difference(left, right) : form_difference(right, left);
	if (is_constant(impact_law->guard))
		error(when->guard->start, "a coordinate, a velocity, a load or an input against a constant",
		      "this guard never changes");
	for (int i = 0; i < impact_law->guard->terms; i++) {
		const struct basis *basis = &impact_law->guard->term[i].basis;
		if (basis->kind == BASIS_INPUT && !input_hold(b, basis->index) && !when->chosen)
			error(when->guard->start, "as a ramp it moves: input ... hold first",
			      "this guard jumps with an input that is held");
	}
	collect_jumps(b, when, impact_law);
}

void collect_impacts(struct building *b, struct segment_equations *segment_equations)
{
	const struct spec *spec = b->spec;
	segment_equations->impact_law = ARRAY(struct impact_law *, spec->whens);
	for (int i = 0; i < spec->whens; i++) {
		struct impact_law *impact_law = NEW(struct impact_law);
		if (statement_guard(collect_impact, &(struct collecting){ b, &spec->when[i], impact_law }))
			segment_equations->impact_law[i] = impact_law;
		b->collector.constant_only = false;     /* where what had to be constant was not */
	}
}

static struct impact_law copied(const struct building *b, const struct when *when, const struct impact_law *from)
{
	struct impact_law copy = *from;
	mpq_inits(copy.restitution, copy.gap, copy.at, copy.factor, NULL);
	mpq_set(copy.gap, from->gap);
	mpq_set(copy.restitution, from->restitution);
	copy.jump = ARRAY(struct jump, (size_t)when->jumps + (size_t)b->model->n);
	for (int k = 0; k < copy.jumps; k++)
		copy.jump[k] = from->jump[k];
	return copy;
}

void gather_impacts(struct building *b)
{
	struct model *model = b->model;
	const struct spec *spec = b->spec;
	const int segments = model->system.segments;
	if (spec->whens > LIMIT_IMPACTS)
		error(spec->when[LIMIT_IMPACTS].at, NULL, "more impacts than the limit of %d", LIMIT_IMPACTS);
	model->contacts.impact = ARRAY(struct impact, spec->whens);
	if (diagnostics_errors())
		return;
	model->contacts.impacts = spec->whens;
	for (int i = 0; i < spec->whens; i++) {
		struct impact *impact = &model->contacts.impact[i];
		*impact = (struct impact){ .when = &spec->when[i], .in = ARRAY(struct impact_law, segments) };
		for (int s = 0; s < segments; s++)
			impact->in[s] = copied(b, impact->when, b->segment_equations[s].impact_law[i]);
	}
}

static bool same_impact_law(const struct impact_law *a, const struct impact_law *b)
{
	bool same = a->jumps == b->jumps && same_form(a->guard, b->guard);
	for (int k = 0; k < a->jumps && same; k++)
		same = same_form(a->jump[k].form, b->jump[k].form);
	return same;
}

bool impacts_change(const struct building *b)
{
	bool changes = false;
	for (int i = 0; i < b->model->contacts.impacts; i++)
		for (int s = 1; s < b->model->system.segments; s++)
			changes = changes ||
				  !same_impact_law(b->model->contacts.impact[i].in,
						   &b->model->contacts.impact[i].in[s]);
	return changes;
}

void report_no_events(const struct building *b, struct place at)
{
	const enum scheme scheme = b->model->scheme;
	if ((stops_at_events(scheme) || scheme == SCHEME_EXACT) && impacts_change(b))
		error(at, "scheme exact takes them beside what is piecewise linear",
		      "beside a series a guard and its jumps have one formula for all time");
	refuse(CAN_CONTACTS, b->model, at);
	abandon();
}

/* ---- what a jump does to a form ---- */

static const struct jump *jump_of(const struct building *b, const struct impact_law *impact_law,
				  const struct basis *basis)
{
	for (int i = 0; i < impact_law->jumps && basis->kind == BASIS_COORD; i++) {
		int state = basis->order ? b->model->system.velocity[basis->index] : basis->index;
		if (impact_law->jump[i].state == state)
			return &impact_law->jump[i];
	}
	return NULL;
}

/* The form of the state behind the jump, over the state before it */
static struct form *behind(const struct building *b, const struct impact_law *impact_law, const struct form *form)
{
	struct form *sum = NEW(struct form);
	for (int i = 0; i < form->terms; i++) {
		const struct jump *jump = jump_of(b, impact_law, &form->term[i].basis);
		if (jump)
			form_add_to(sum, jump->form, form->term[i].factor);
		else
			form_add_basis(sum, form->term[i].basis, form->term[i].factor);
	}
	return sum;
}

static bool reads_highest(const struct building *b, const struct form *form)
{
	bool any = false;
	for (int i = 0; i < form->terms; i++)
		any = any || is_highest(&b->model->frame, &form->term[i].basis);
	return any;
}

static _Noreturn void report_again(const struct when *when, const char *why)
{
	error(when->guard->start, "x' = -0.8*x' turns back what x >= 0.1 has met",
	      "its own jump triggers this 'when' again at once: %s", why);
}

/* Behind its own jump a guard may not stand where it is true, nor go on to there. */
static void check_jump(struct building *b, const struct when *when, const struct impact_law *impact_law)
{
	RATIONAL ratio = ZERO, rest = ZERO;
	bool known = is_along(b, behind(b, impact_law, impact_law->guard), impact_law->guard, ratio, rest);
	if (known && mpq_sgn(rest) > 0)
		report_again(when, "behind it the guard is true, by a constant");
	bool stays = known && mpq_sgn(rest) == 0;
	if (stays && !reads_highest(b, impact_law->speed) && !is_constant(impact_law->speed) &&
	    is_along(b, behind(b, impact_law, impact_law->speed), impact_law->speed, ratio, rest) &&
	    mpq_sgn(rest) == 0 &&
	    mpq_sgn(ratio) > 0)
		report_again(when, "behind it the guard goes on as it came");
}

/* ---- bounces ---- */

/* Constraints take from a direction what they do not allow, and a curved guard has none that lasts. */
static bool may_bounce(const struct building *b, const struct impact_law *law)
{
	return !holds_atom(law->guard) && (b->spec->count.multipliers == 0 || !contact_moves(b, law->guard));
}

/* Whether each jump is v -> v - (1 + e) d s of velocities v, s the speed of the guard; then e and d */
static bool find_bounce(struct building *b, struct impact_law *impact_law)
{
	const struct linear *system = &b->model->system;
	mpq_t *part = rationals(b->model->n);
	bool bounce = !reads_highest(b, impact_law->speed) && !is_constant(impact_law->speed);
	RATIONAL reversed = ZERO, product = ZERO, rest = ZERO;
	for (int i = 0; i < impact_law->jumps && bounce; i++) {
		int state = impact_law->jump[i].state, coord = system->coord[state];
		struct basis basis = { .kind = BASIS_COORD, .index = coord, .order = 1 };
		bounce = state >= b->model->n &&
			 is_along(b, form_difference(form_unit(basis), impact_law->jump[i].form), impact_law->speed,
				  part[coord], rest) &&
			 mpq_sgn(rest) == 0;
		const struct form_term *term = bounce ? form_find(impact_law->speed, &basis) : NULL;
		if (term)
			mpq_mul(product, term->factor, part[coord]);
		if (term)
			mpq_add(reversed, reversed, product);
	}
	mpq_set_ui(rest, 1, 1);
	bounce = bounce && mpq_cmp(reversed, rest) >= 0;
	for (int j = 0; j < b->model->n && bounce; j++)
		mpq_div(part[j], part[j], reversed);
	if (bounce)
		mpq_sub(impact_law->restitution, reversed, rest);
	impact_law->direction = bounce ? part : NULL;
	return bounce;
}

/* ---- stops: the force between two coordinates does it, by the equations' masses ---- */

static void add_row(const struct building *b, const struct node *end, int sign, mpq_t *force)
{
	if (!end)
		return;
	int coord = end->symbol->index + (end->component ? end->component - 1 : 0);
	if (b->model->system.velocity[coord] < 0)
		report_no_mass(b, end->at, coord);
	mpq_set_si(force[b->owner[coord]], sign, 1);
}

/* Between expressions the force acts as the guard changes with the coordinates. */
static void add_gradient(const struct building *b, const struct when *when, const struct form *guard, mpq_t *force)
{
	for (int i = 0; i < guard->terms; i++) {
		const struct basis *basis = &guard->term[i].basis;
		if (basis->kind != BASIS_COORD)
			continue;
		if (basis->order > 0)
			report_velocity(b, when, basis->index);
		if (b->model->system.velocity[basis->index] < 0)
			report_no_mass(b, when->guard->start, basis->index);
		mpq_set(force[b->owner[basis->index]], guard->term[i].factor);
	}
}

/* v -> v - (1 + e) d s; returns how many */
static int velocity_jumps(const struct building *b, const struct impact_law *impact_law, mpq_srcptr e,
			  struct jump *jump)
{
	int jumps = 0;
	RATIONAL factor = ZERO;
	for (int j = 0; j < b->model->n; j++) {
		if (mpq_sgn(impact_law->direction[j]) == 0)
			continue;
		struct basis basis = { .kind = BASIS_COORD, .index = j, .order = 1 };
		mpq_set_si(factor, -1, 1);
		mpq_sub(factor, factor, e);
		mpq_mul(factor, factor, impact_law->direction[j]);
		jump[jumps++] = (struct jump){
			.state = b->model->system.velocity[j],
			.form = form_sum(form_unit(basis), form_scale(impact_law->speed, factor), false)
		};
	}
	return jumps;
}

/* d = M^-1 f/(s M^-1 f), f the force of contact on the equations of the two */
static void find_jumps(struct building *b, const struct when *when, struct impact_law *impact_law)
{
	int n = b->model->n;
	mpq_t *inverse = inverse_masses(b, b->segment_equations), *force = rationals(n), *d = rationals(n);
	RATIONAL speed = ZERO, factor = ZERO;
	add_row(b, when->from, 1, force);
	add_row(b, when->to, -1, force);
	if (!when->from && !when->to)
		add_gradient(b, when, impact_law->guard, force);
	rational_product(n, n, 1, inverse, force, d);
	for (int i = 0; i < impact_law->speed->terms; i++) {
		const struct basis *basis = &impact_law->speed->term[i].basis;
		if (basis->kind != BASIS_COORD)
			continue;
		mpq_mul(factor, impact_law->speed->term[i].factor, d[basis->index]);
		mpq_add(speed, speed, factor);
	}
	if (mpq_sgn(speed) <= 0)
		error(when->at, NULL, "the masses at this stop do not make a force part them");
	for (int j = 0; j < n; j++)
		mpq_div(d[j], d[j], speed);
	impact_law->direction = d;
	impact_law->jumps = velocity_jumps(b, impact_law, impact_law->restitution, impact_law->jump);
}

/* What is left where nothing comes back */
static void still_jumps(struct building *b, struct impact_law *impact_law)
{
	RATIONAL none = ZERO;
	impact_law->still = ARRAY(struct jump, b->model->n);
	impact_law->jump = ARRAY(struct jump, b->model->n);
	velocity_jumps(b, impact_law, none, impact_law->still);
	impact_law->jumps = velocity_jumps(b, impact_law, impact_law->restitution, impact_law->jump);
}

struct indexed {
	struct building *b;
	int index;
};

/* Two that one crossing starts would leave open which of them acts. */
static void check_alike(void *context)
{
	struct indexed *work = context;
	struct building *b = work->b;
	const struct impact *all = b->model->contacts.impact, *impact = &all[work->index];
	RATIONAL ratio = ZERO, rest = ZERO;
	for (int i = 0; i < work->index; i++)
		for (int s = 0; s < b->model->system.segments && !all[i].when->chosen; s++)
			if (is_along(b, impact->in[s].guard, all[i].in[s].guard, ratio, rest) && mpq_sgn(rest) == 0)
				error(impact->when->guard->start,
				      "all that jumps there belongs into one 'when', with commas",
				      "another 'when' or stop has this guard already");
}

/* A contact that rests stays what it is when a load changes its formula. */
static void report_bounce_changes(const struct building *b, const struct when *when, int segment, bool bounces)
{
	error(when->at, "one that turns the speed of its guard does so at all times, or at none",
	      "what jumps here is a bounce %s t = %s and none %s it", bounces ? "from" : "before",
	      readable_text(b->model->system.change[segment - 1]), bounces ? "before" : "from");
}

static void find_slope_speeds(struct building *b, const struct when *when, struct impact_law *law)
{
	for (int k = 0; k < when->slopes; k++)
		law->slope[k].speed = rate_with_atoms(b, law->slope[k].guard);
}

static void build_impact(void *context)
{
	struct indexed *work = context;
	struct building *b = work->b;
	struct impact *impact = &b->model->contacts.impact[work->index];
	const struct when *when = impact->when;
	for (int s = 0; s < b->model->system.segments; s++) {
		struct impact_law *impact_law = &impact->in[s];
		bool bounces = when->restitution != NULL;
		if (when->chosen) {
			impact_law->speed = NEW(struct form);
			continue;
		}
		find_slope_speeds(b, when, impact_law);
		if (when->restitution && (b->spec->joined.columns > 0 || contact_moves(b, impact_law->guard))) {
			impact_law->speed = speed_that_moves(b, when, impact_law->guard);
			impact->bounces = impact->moves = true;
			continue;               /* the rest once the equations are there for all time */
		}
		impact_law->speed = rate_of_form(b, impact_law->guard);
		if (when->restitution)
			find_jumps(b, when, impact_law);
		else
			bounces = may_bounce(b, impact_law) && find_bounce(b, impact_law);
		if (s > 0 && bounces != impact->bounces)
			report_bounce_changes(b, when, s, bounces);
		impact->bounces = bounces;
		check_jump(b, when, impact_law);
		impact->moves = bounces && (b->spec->joined.columns > 0 || contact_moves(b, impact_law->guard));
		if (bounces && !impact->moves)
			still_jumps(b, impact_law);
	}
}

/* Once masses are known: which guards bounce, and how */
void build_impacts(struct building *b)
{
	for (int i = 0; i < b->model->contacts.impacts; i++)
		statement_guard(build_impact, &(struct indexed){ b, i });
	for (int i = 1; i < b->model->contacts.impacts; i++)
		statement_guard(check_alike, &(struct indexed){ b, i });
}

/* ---- guards that jump with a load ---- */

struct jumping {
	struct building *b;
	const struct form *by;
	int segment;                /* behind the change */
	mpq_t value;
};

static void find_value(void *context)
{
	struct jumping *work = context;
	struct collector *c = &work->b->collector;
	mpq_srcptr change = work->b->model->system.change[work->segment - 1];
	struct fixing t = { .form = form_constant(change) };
	mpq_init(t.value);
	mpq_set(t.value, change);
	constant_value(c, form_at(point_new(c, 1, &t), work->by), work->value);
}

bool closes_by_jump(struct building *b, const struct impact *impact, int segment)
{
	struct jumping work = { .b = b, .segment = segment };
	work.by = form_difference(impact->in[segment].guard, impact->in[segment - 1].guard);
	mpq_init(work.value);
	for (int i = 0; i < work.by->terms; i++)
		if (work.by->term[i].basis.kind >= BASIS_INPUT)
			return false;
	bool known = silent_guard(find_value, &work);
	bool closes = known && nearest_double(work.value) > 1e-30;      /* but for irrationals of 256 bits */
	mpq_clear(work.value);
	return closes;
}

/* ---- in regions ---- */

void place_impact_loads(struct building *b, const struct switching *s)
{
	for (int i = 0; i < s->impacts; i++)
		for (int segment = 0; segment < s->segments; segment++) {
			const struct impact_law *impact_law = &s->impact[i].in[segment];
			place_loads(b, impact_law->speed);
			for (int k = 0; k < impact_law->jumps; k++)
				place_loads(b, impact_law->jump[k].form);
		}
}

void build_impact_rows(struct building *b, struct switching *s)
{
	for (int i = 0; i < s->impacts; i++)
		for (int segment = 0; segment < s->segments; segment++) {
			struct impact_law *impact_law = &s->impact[i].in[segment];
			bool bounces = s->impact[i].bounces;
			for (int k = 0; k < impact_law->jumps; k++)
				impact_law->jump[k].row = row_of_form(b, impact_law->jump[k].form);
			for (int k = 0; k < impact_law->jumps && bounces; k++)
				impact_law->still[k].row = row_of_form(b, impact_law->still[k].form);
			if (bounces)
				impact_law->speed_row = row_of_form(b, impact_law->speed);
		}
}
