/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Impacts, contacts at rest and dry friction beside a Taylor series. What is held is a switching function in an
 * interval between two equal breakpoints: of friction its velocity, of a contact at rest the guard of its impacts. The
 * force that holds it is a sequence like others: what makes the rate of its velocity 0, of the accelerations without
 * it, which are sequences too. Where several act on each other, each combination of those that hold has its own. */
#include "model/contacts/friction.h"
#include "model/contacts/contacts.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"
#include "inner.h"

/* ---- what divides ---- */

/* By the form, which has a sequence then */
static struct division divide_made(struct sequencing *w, const struct form *form, mpq_ptr factor)
{
	struct division division = divide_form(w, form, factor);
	if (w->x->function[division.function].sequence == NONE) {
		int made = sequence_of_form(w, w->x->function[division.function].form);
		w->x->function[division.function].sequence = made;
	}
	return division;
}

/* The guard as it was written: where it rises or falls to its breakpoint; *factor: of the switching function */
static struct division divide_guard(struct sequencing *w, const struct impact *impact, mpq_ptr factor)
{
	const enum comparison comparison = impact->when->guard->comparison;
	const bool rises = comparison == CMP_GT || comparison == CMP_GE;
	const struct form *guard = rises ? impact->in->guard : form_difference(form_number(0), impact->in->guard);
	struct division d = divide_made(w, guard, factor);
	d.above = d.above == rises;
	mpq_abs(factor, factor);
	return d;
}

static _Noreturn void report_held_twice(struct place at)
{
	error(at, "a piecewise-linear model takes several",
	      "beside what is not piecewise linear one friction, stop or 'when' is for each value of an expression");
}

static void make_hold(struct constraints *all, int index)
{
	struct sequencing *w = all->w;
	const struct constraint *h = &all->constraint[index];
	const struct model *model = w->step->model;
	struct series_hold *hold = &all->c->hold[index];
	*hold = (struct series_hold){ .impact = h->impact, .pull = { NONE, NONE } };
	RATIONAL factor = ZERO;
	struct division d = h->node ? divide_made(w, h->velocity, factor)
				    : divide_guard(w, &model->contacts.impact[h->impact], factor);
	for (int i = 0; i < index; i++)
		if (all->c->hold[i].function == d.function && all->c->hold[i].breakpoint == d.breakpoint)
			report_held_twice(h->node ? h->node->at : model->contacts.impact[h->impact].when->at);
	hold->function = d.function;
	hold->breakpoint = d.breakpoint;
	hold->above = d.above;
	add_twin(&w->x->function[d.function], d.breakpoint);
}

/* A force that may become negative counts as 0 there. */
static int force_sequence(struct sequencing *w, const struct form *force)
{
	int made = sequence_of_form(w, force);
	return never_falls_below(force) ? made : positive_sequence(w, force, made);
}

/* What it can hold, no less than its force: S > F ? S : F */
static int rest_sequence(struct sequencing *w, const struct drag *drag)
{
	int rest = force_sequence(w, drag->rest);
	const struct form *more = less_in_velocity(drag->rest, drag->force, drag->velocity);
	if (never_falls_below(more))
		return rest;
	const struct form *less = form_difference(form_number(0), more);
	struct sum sum = { 0 };
	RATIONAL one = RATIO(1, 1);
	sum_add(&sum, TERM_SEQUENCE, positive_sequence(w, more, rest), 0, one);
	int force = force_sequence(w, drag->force);
	sum_add(&sum, TERM_SEQUENCE, positive_sequence(w, less, force), 0, one);
	return sum_sequence(w, &sum);
}

static void make_slip(struct constraints *all, int index)
{
	struct sequencing *w = all->w;
	struct constraint *h = &all->constraint[index];
	const struct series_hold *hold = &all->c->hold[index];
	if (h->drag == NONE)
		return;
	const struct drag *drag = &w->step->model->contacts.drag[h->drag];
	int force = force_sequence(w, drag->force), back = minus_sequence(w, force);
	h->slips = new_sequence(w, (struct sequence){
		.kind = SEQUENCE_CHOICE, .choice = CHOICE_BY_STATE, .state = NONE, .switching = hold->function,
		.breakpoint = hold->breakpoint, .a = hold->above ? force : back, .b = hold->above ? back : force });
}

/* ---- what the search of events looks at ---- */

static int watch(struct sequencing *w, int sequence, bool full)
{
	struct contacts *c = w->x->contacts;
	for (int i = 0; i < c->watches; i++)
		if (c->watch[i].sequence == sequence) {
			c->watch[i].full |= full;
			return i;
		}
	*MORE(c->watch, c->watches) = (struct watch){ .sequence = sequence, .full = full };
	return c->watches - 1;
}

/* The force that it would take to hold this one, the others as they are: -(bare + answers of the others)/answer */
static struct sum needed_force(const struct constraints *all, int index, long sign)
{
	struct sequencing *w = all->w;
	const struct constraint *h = &all->constraint[index];
	const struct entry *answer = &h->delassus[index];
	struct sum sum = { 0 };
	RATIONAL factor = ZERO;
	mpq_set_si(factor, -sign, 1);
	if (answer->sequence == NONE)
		mpq_div(factor, factor, answer->number);
	sum_add(&sum, TERM_SEQUENCE, h->bare, 0, factor);
	for (int j = 0; j < all->constraints; j++)
		if (j != index)
			sum_add_entry(&sum, all->constraint[j].force, &h->delassus[j], factor);
	if (answer->sequence == NONE)
		return sum;
	struct sum force = { 0 };
	RATIONAL one = RATIO(1, 1);
	sum_add(&force, TERM_SEQUENCE, quotient_by_entry(w, sequence_of_sum(w, &sum), answer), 0, one);
	return force;
}

/* What is taken from each state for a velocity of 1: numbers, or what is watched */
static void find_back(const struct constraints *all, int index, struct series_hold *hold)
{
	struct sequencing *w = all->w;
	const struct constraint *h = &all->constraint[index];
	const struct entry *answer = &h->delassus[index];
	const int states = w->system->states;
	RATIONAL part = ZERO;
	hold->back = ARRAY(double, states);
	hold->back_watch = ARRAY(int, states);
	for (int i = 0; i < states; i++) {
		const struct entry *direction = &h->force_direction[i];
		hold->back_watch[i] = NONE;
		if (direction->sequence == NONE && mpq_sgn(direction->number) == 0)
			continue;
		if (direction->sequence == NONE && answer->sequence == NONE) {
			mpq_div(part, direction->number, answer->number);
			hold->back[i] = round_rational(part);
			continue;
		}
		hold->back_watch[i] = watch(w, quotient_by_entry(w, entry_sequence(w, direction), answer), false);
		all->c->moves = true;
	}
}

/* Beyond 0 it lets go: of friction either way, of a contact where it would have to pull */
static void watch_hold(struct constraints *all, int index)
{
	struct sequencing *w = all->w;
	const struct constraint *h = &all->constraint[index];
	struct series_hold *hold = &all->c->hold[index];
	RATIONAL minus = ZERO;
	mpq_set_si(minus, -1, 1);
	hold->velocity = watch(w, sequence_of_form(w, h->velocity), false);
	find_back(all, index, hold);
	if (h->drag == NONE) {
		struct sum pull = needed_force(all, index, -1);
		hold->pull[!hold->above] = watch(w, sum_sequence(w, &pull), true);
	}
	for (int up = 0; up < 2 && h->drag != NONE; up++) {
		const struct drag *drag = &w->step->model->contacts.drag[h->drag];
		struct sum pull = needed_force(all, index, up == hold->above ? 1 : -1);
		sum_add(&pull, TERM_SEQUENCE, rest_sequence(w, drag), 0, minus);
		hold->pull[up] = watch(w, sum_sequence(w, &pull), true);
	}
}

static void assign(struct constraints *all, const struct jump *jump, int jumps)
{
	struct contacts *c = all->c;
	for (int k = 0; k < jumps; k++) {
		*MORE(c->assignment, c->assignments) = (struct series_jump){
			jump[k].state, watch(all->w, sequence_of_form(all->w, jump[k].form), false)
		};
	}
}

/* v - (1 + e) d s of each velocity, d what is watched; e = 0 where it comes to rest */
static void assign_moving(struct constraints *all, int index, int hold, bool still)
{
	struct sequencing *w = all->w;
	const struct impact_law *law = w->step->model->contacts.impact[index].in;
	const int speed = sequence_of_form(w, law->speed);
	struct contacts *c = all->c;
	RATIONAL one = RATIO(1, 1), factor = RATIO(-1, 1);
	if (!still)
		mpq_sub(factor, factor, law->restitution);
	for (int i = 0; i < w->system->states; i++) {
		const int back = c->hold[hold].back_watch[i];
		struct sum sum = { 0 };
		if (back == NONE)
			continue;
		const int d = c->watch[back].sequence;
		sum_add(&sum, TERM_SEQUENCE, i, 0, one);
		sum_add(&sum, TERM_PRODUCT, speed < d ? speed : d, speed < d ? d : speed, factor);
		*MORE(c->assignment, c->assignments) =
			(struct series_jump){ i, watch(w, sum_sequence(w, &sum), false) };
	}
}

/* Places are put back along the same direction as velocities. */
static void watch_moving_bounce(struct constraints *all, int index)
{
	struct sequencing *w = all->w;
	struct contacts *c = all->c;
	struct series_impact *impact = &c->series_impact[index];
	for (int j = 0; j < w->system->n; j++)
		if (w->system->velocity[j] >= 0)
			impact->back_watch[j] = c->hold[impact->hold].back_watch[w->system->velocity[j]];
	impact->jump = c->assignments;
	assign_moving(all, index, impact->hold, false);
	impact->still = c->assignments;
	impact->jumps = impact->still - impact->jump;
	assign_moving(all, index, impact->hold, true);
}

static void watch_bounce(struct constraints *all, int index)
{
	struct sequencing *w = all->w;
	const struct impact *impact = &w->step->model->contacts.impact[index];
	struct series_impact *series_impact = &all->c->series_impact[index];
	series_impact->speed = watch(w, sequence_of_form(w, impact->in->speed), false);
	if (impact->moves) {
		watch_moving_bounce(all, index);
		return;
	}
	for (int j = 0; j < w->system->n; j++)
		series_impact->back[j] = round_rational(impact->in->direction[j]);
}

static void watch_impact(struct constraints *all, int index)
{
	struct sequencing *w = all->w;
	const struct impact *impact = &w->step->model->contacts.impact[index];
	struct series_impact *series_impact = &all->c->series_impact[index];
	RATIONAL factor = ZERO;
	struct division d = divide_guard(w, impact, factor);
	for (int i = 0; i < all->c->holds && !impact->bounces; i++)
		if (all->c->hold[i].function == d.function && all->c->hold[i].breakpoint == d.breakpoint)
			report_held_twice(impact->when->at);
	*series_impact =
		(struct series_impact){ .function = d.function, .breakpoint = d.breakpoint, .upward = d.above,
				   .hold = NONE, .jump = all->c->assignments, .still = all->c->assignments,
				   .jumps = impact->in->jumps, .back = ARRAY(double, w->system->states),
				   .back_watch = ARRAY(int, w->system->states),
				   .restitution = round_rational(impact->in->restitution) };
	for (int i = 0; i < w->system->states; i++)
		series_impact->back_watch[i] = NONE;
	mpq_inv(factor, factor);
	series_impact->per = round_rational(factor);
	for (int i = 0; i < all->constraints; i++)
		if (all->constraint[i].impact == index)
			series_impact->hold = i;
	assign(all, impact->in->jump, impact->in->jumps);
	series_impact->place = watch(w, sequence_of_form(w, impact->in->guard), false);
	series_impact->speed = series_impact->place;
	if (series_impact->hold == NONE)
		return;
	if (!impact->moves) {
		series_impact->still = all->c->assignments;
		assign(all, impact->in->still, impact->in->jumps);
	}
	watch_bounce(all, index);
}

/* ---- the whole ---- */

/* The only state of a velocity that no load moves; else NONE */
static int only_state(const struct sequencing *w, const struct form *velocity)
{
	int state = NONE;
	for (int i = 0; i < velocity->terms; i++) {
		const struct basis *basis = &velocity->term[i].basis;
		if (basis->kind <= BASIS_PI)
			continue;
		if (basis->kind != BASIS_COORD || state != NONE)
			return NONE;
		state = basis->order ? w->system->velocity[basis->index] : basis->index;
	}
	return state;
}

bool is_bare(const struct sequencing *w, int state)
{
	return w->x->contacts && w->x->contacts->bare[state] != NONE;
}

struct sum held_slope(struct sequencing *w, int state)
{
	const struct contacts *c = w->x->contacts;
	struct sum slope = { 0 };
	if (!c)
		return slope_of_state(w, state);
	if (c->bare[state] == NONE)
		slope = slope_of_state(w, state);
	RATIONAL one = RATIO(1, 1);
	if (c->bare[state] != NONE)
		sum_add(&slope, TERM_SEQUENCE, c->bare[state], 0, one);
	for (int i = 0; i < c->holds; i++)
		sum_add_entry(&slope, c->hold[i].force, &c->hold[i].force_direction[state], one);
	for (int i = 0; i < c->holds; i++) {
		if (c->hold[i].only != state)
			continue;
		int moves = sum_sequence(w, &slope);
		slope = (struct sum){ 0 };
		sum_add(&slope, TERM_SEQUENCE, hold_choice(w, &c->hold[i], c->none, moves), 0, one);
	}
	return slope;
}

int held_force(struct sequencing *w, int force_column)
{
	const struct contacts *c = w->x->contacts;
	struct sum force = { 0 };
	if (!c)
		return w->x->force[force_column];
	RATIONAL one = ZERO;
	mpq_set_ui(one, 1, 1);
	sum_add(&force, TERM_SEQUENCE, w->x->force[force_column], 0, one);
	for (int i = 0; i < c->holds; i++)
		sum_add_entry(&force, c->hold[i].force, &c->hold[i].gives[force_column], one);
	return sum_sequence(w, &force);
}

void hold_contacts(struct sequencing *w)
{
	const struct model *model = w->step->model;
	struct constraints all = { .w = w };
	if (!has_contacts(model))
		return;
	struct contacts *c = all.c = w->x->contacts = NEW(struct contacts);
	c->bare = ARRAY(int, w->system->states);
	for (int i = 0; i < w->system->states; i++)
		c->bare[i] = NONE;
	c->none = all.none = sequence_of_form(w, form_number(0));
	c->series_impacts = model->contacts.impacts;
	c->series_impact = ARRAY(struct series_impact, model->contacts.impacts);
	find_constraints(&all);
	c->hold = ARRAY(struct series_hold, all.constraints);
	c->holds = all.constraints;
	for (int i = 0; i < all.constraints; i++)
		make_hold(&all, i);
	for (int i = 0; i < all.constraints; i++)
		make_slip(&all, i);
	for (int i = 0; i < all.constraints; i++)
		all.constraint[i].bare = bare_rate(w, &all.constraint[i]);
	for (int i = 0; i < all.constraints; i++)
		make_force(&all, i);
	for (int i = 0; i < all.constraints; i++)
		watch_hold(&all, i);
	for (int i = 0; i < model->contacts.impacts; i++)
		watch_impact(&all, i);
	sort_watches(c, w->system->states);
	for (int i = 0; i < all.constraints; i++) {
		c->hold[i].force = all.constraint[i].force;
		c->hold[i].force_direction = all.constraint[i].force_direction;
		c->hold[i].gives = all.constraint[i].gives;
		c->hold[i].only = only_state(w, all.constraint[i].velocity);
	}
}
