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

#include <math.h>

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
	if (h->of != NONE) {
		*hold = all->c->hold[h->of];
		return;
	}
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

/* What it can hold, no less than its force: S > F ? S : F, or of that what follows a param */
static int rest_sequence(struct sequencing *w, const struct drag *drag, const struct drag *of)
{
	int rest = force_sequence(w, drag->rest, of->rest);
	const struct form *more = less_in_velocity(drag->rest, drag->force, drag->velocity);
	if (never_falls_below(more))
		return rest;
	const struct form *less = form_difference(form_number(0), more);
	struct sum sum = { 0 };
	RATIONAL one = RATIO(1, 1);
	sum_add(&sum, TERM_SEQUENCE, positive_sequence(w, more, rest), 0, one);
	int force = force_sequence(w, drag->force, of->force);
	sum_add(&sum, TERM_SEQUENCE, positive_sequence(w, less, force), 0, one);
	return sum_sequence(w, &sum);
}

/* The friction that decides, of a derivative's, too */
static const struct drag *drag_of(const struct constraints *all, int index)
{
	return &all->w->step->model->contacts.drag[all->constraint[held_by(all, index)].drag];
}

static void make_slip(struct constraints *all, int index)
{
	struct sequencing *w = all->w;
	struct constraint *h = &all->constraint[index];
	const struct series_hold *hold = &all->c->hold[index];
	if (h->drag != NONE && !w->step->model->contacts.drag[h->drag].by)
		h->slips = along_sliding(w, hold, force_sequence(w, drag_of(all, index)->force,
								 w->step->model->contacts.drag[h->drag].force));
}

/* ---- forces ---- */

/* ---- where Delassus entries are numbers: each combination of those that hold has its own sum ---- */

struct together {
	struct constraints *all;
	int members, *member;       /* of a group, the one whose force is made first */
	bool *holds;                /* per member */
};

/* inverse: of the Delassus matrix of those that hold; false: there is none */
static bool invert(const struct together *t, int count, const int *which, mpq_t *inverse)
{
	mpq_t *a = rationals((size_t)(count * count));
	for (int i = 0; i < count; i++)
		for (int j = 0; j < count; j++)
			mpq_set(a[i * count + j], t->all->constraint[which[i]].delassus[which[j]].number);
	int column;
	return rational_inverse(count, a, inverse, &column);
}

/* Of member 0, where these hold and the others of the group slip */
static int force_together(const struct together *t)
{
	struct sequencing *w = t->all->w;
	int count = 0, *which = ARRAY(int, t->members);
	for (int i = 0; i < t->members; i++)
		if (t->holds[i])
			which[count++] = t->member[i];
	mpq_t *inverse = rationals((size_t)(count * count));
	struct sum sum = { 0 };
	if (!invert(t, count, which, inverse)) {
		note_conflict(t->all, count, which);
		return t->all->none;
	}
	RATIONAL part = ZERO;
	for (int i = 0; i < count; i++) {
		const struct constraint *h = &t->all->constraint[which[i]];
		mpq_neg(part, inverse[i]);
		sum_add(&sum, TERM_SEQUENCE, h->bare, 0, part);
		for (int j = 0; j < t->members; j++) {
			const struct constraint *other = &t->all->constraint[t->member[j]];
			if (!t->holds[j] && other->slips != NONE)
				sum_add_entry(&sum, other->slips, &h->delassus[t->member[j]], part);
		}
	}
	return sum_sequence(w, &sum);
}

static int force_in_cases(struct together *t, int next)
{
	if (next == t->members)
		return force_together(t);
	t->holds[next] = true;
	int held = force_in_cases(t, next + 1);
	t->holds[next] = false;
	int free = force_in_cases(t, next + 1);
	return hold_choice(t->all->w, &t->all->c->hold[t->member[next]], held, free);
}

static bool moves(const struct constraints *all, int members, const int *member)
{
	enum { MOST = 4 };              /* beyond, a sum for each combination is too much */
	bool any = own_of(all, members, member) > MOST;
	for (int i = 0; i < members; i++) {
		const struct constraint *h = &all->constraint[member[i]];
		any = any || h->moving || (h->drag != NONE && all->w->step->model->contacts.drag[h->drag].by);
	}
	for (int i = 0; i < members * members; i++)
		any = any || !is_number_entry(&all->constraint[member[i / members]].delassus[member[i % members]]);
	return any;
}

static void make_force(struct constraints *all, int index, int members, const int *member)
{
	struct sequencing *w = all->w;
	struct constraint *h = &all->constraint[index];
	struct together t = { all, 1, ARRAY(int, members), ARRAY(bool, members) };
	t.member[0] = index;
	t.holds[0] = true;
	for (int i = 0; i < members; i++)
		if (member[i] != index)
			t.member[t.members++] = member[i];
	int held = force_in_cases(&t, 1);
	h->force = hold_choice(w, &all->c->hold[index], held, h->slips == NONE ? all->none : h->slips);
}

/* The members of its group */
static int *members_of(const struct constraints *all, int index, int *members)
{
	int *member = ARRAY(int, all->constraints);
	*members = 0;
	for (int i = 0; i < all->constraints; i++)
		if (all->constraint[i].group == all->constraint[index].group)
			member[(*members)++] = i;
	return member;
}

static void make_forces(struct constraints *all)
{
	for (int i = 0; i < all->constraints; i++) {
		int members, *member = members_of(all, i, &members);
		if (!moves(all, members, member))
			all->constraint[i].bare = bare_rate(all->w, &all->constraint[i]);
	}
	for (int i = 0; i < all->constraints; i++) {
		int members, *member = members_of(all, i, &members);
		if (!moves(all, members, member)) {
			make_force(all, i, members, member);
		} else if (member[0] == i) {
			note_conflicts(all, members, member);
			solve_group(all, members, member);
		}
	}
}

/* ---- what the search of events looks at ---- */

/* The force that would hold this one, the others as they are: -(bare + Delassus entries of the others)/its own */
static struct sum needed_force(const struct constraints *all, int index, long sign)
{
	const struct constraint *h = &all->constraint[index];
	struct sum sum = { 0 };
	RATIONAL factor = ZERO;
	mpq_set_si(factor, -sign, 1);
	mpq_div(factor, factor, h->delassus[index].number);
	sum_add(&sum, TERM_SEQUENCE, h->bare, 0, factor);
	for (int j = 0; j < all->constraints; j++)
		if (j != index)
			sum_add_entry(&sum, all->constraint[j].force, &h->delassus[j], factor);
	return sum;
}

/* By how much that is beyond what holds. Where the force is solved for it is known while it holds; while it slips by
 * the same force, its rate has that sign. */
static int pull_sequence(const struct constraints *all, int index, long sign, const struct drag *drag)
{
	struct sequencing *w = all->w;
	const struct constraint *h = &all->constraint[index];
	const struct drag *decides = drag ? drag_of(all, index) : NULL;
	RATIONAL minus = RATIO(-1, 1), factor = ZERO;
	struct sum sum = { 0 }, rate = { 0 };
	mpq_set_si(factor, sign, 1);
	if (h->solved)
		sum_add(&sum, TERM_SEQUENCE, h->force, 0, factor);
	else
		sum = needed_force(all, index, sign);
	if (drag)
		sum_add(&sum, TERM_SEQUENCE, rest_sequence(w, decides, drag), 0, minus);
	if (!h->solved || h->of != NONE)
		return sum_sequence(w, &sum);
	if (!drag || drag->rest == drag->force) {
		sum_add(&rate, TERM_SEQUENCE, h->bare, 0, factor);
		const int slope = sum_sequence(w, &rate);
		return hold_choice(w, &all->c->hold[index], sum_sequence(w, &sum), slope);
	}
	const int held = sum_sequence(w, &sum);
	mpq_neg(factor, factor);
	sum_add(&sum, TERM_SEQUENCE, quotient_by_entry(w, h->bare, &h->delassus[index]), 0, factor);
	return hold_choice(w, &all->c->hold[index], held, sum_sequence(w, &sum));
}

/* What is taken from each state for a velocity of 1: numbers, or what is watched */
static void find_back(const struct constraints *all, int index, struct series_hold *hold)
{
	struct sequencing *w = all->w;
	const struct constraint *h = &all->constraint[index];
	const struct entry *delassus = &h->delassus[index];
	const int states = w->system->states;
	RATIONAL part = ZERO;
	hold->back = ARRAY(double, states);
	hold->back_watch = ARRAY(int, states);
	for (int i = 0; i < states; i++) {
		const struct entry *direction = &h->force_direction[i];
		hold->back_watch[i] = NONE;
		if (direction->sequence == NONE && mpq_sgn(direction->number) == 0)
			continue;
		if (direction->sequence == NONE && delassus->sequence == NONE) {
			mpq_div(part, direction->number, delassus->number);
			hold->back[i] = round_rational(part);
			continue;
		}
		hold->back_watch[i] = watch(w, quotient_by_entry(w, entry_sequence(w, direction), delassus), false);
		all->c->moves = true;
	}
}

/* Beyond 0 it lets go: of friction either way, of a contact where it would have to pull */
static void watch_hold(struct constraints *all, int index)
{
	struct sequencing *w = all->w;
	const struct constraint *h = &all->constraint[index];
	struct series_hold *hold = &all->c->hold[index];
	const bool full = h->of == NONE;        /* of a derivative its value is looked at */
	hold->velocity = watch(w, sequence_of_form(w, h->velocity), false);
	find_back(all, index, hold);
	if (h->drag == NONE) {
		hold->pull[!hold->above] = watch(w, pull_sequence(all, index, -1, NULL), full);
	}
	for (int up = 0; up < 2 && h->drag != NONE; up++) {
		const struct drag *drag = &w->step->model->contacts.drag[h->drag];
		hold->pull[up] = watch(w, pull_sequence(all, index, up == hold->above ? 1 : -1, drag), full);
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

/* v - (1 + e) d s, d what is watched, or a number; e = 0 where it comes to rest */
static int velocity_behind(struct sequencing *w, const struct impact_law *law, int state, int d, double number,
			   bool still)
{
	const int speed = sequence_of_form(w, law->speed);
	RATIONAL one = RATIO(1, 1), factor = RATIO(-1, 1), part = ZERO;
	struct sum sum = { 0 };
	if (!still)
		mpq_sub(factor, factor, law->restitution);
	sum_add(&sum, TERM_SEQUENCE, state, 0, one);
	mpq_set_d(part, number);
	mpq_mul(part, part, factor);
	if (d == NONE)
		sum_add(&sum, TERM_SEQUENCE, speed, 0, part);
	else
		sum_add(&sum, TERM_PRODUCT, speed < d ? speed : d, speed < d ? d : speed, factor);
	return sum_sequence(w, &sum);
}

static void assign_moving(struct constraints *all, int index, int hold, bool still)
{
	struct sequencing *w = all->w;
	const struct impact_law *law = w->step->model->contacts.impact[index].in;
	struct contacts *c = all->c;
	/* Where it alone moves the guard it is 0 at rest, exactly. */
	const int only = law->moving->only < 0 ? NONE : w->system->velocity[law->moving->only];
	for (int i = 0; i < w->system->states; i++) {
		const int back = c->hold[hold].back_watch[i], d = back == NONE ? NONE : c->watch[back].sequence;
		const double number = c->hold[hold].back[i];
		if (back == NONE && number == 0)
			continue;
		int value = velocity_behind(w, law, i, d, number, still);
		value = watch(w, still && i == only ? all->none : value, false);
		*MORE(c->assignment, c->assignments) = (struct series_jump){ i, value };
	}
}

static void assign_bounce(struct constraints *all, int index, int hold, bool still)
{
	if (all->c->columns > 0)
		assign_with_slopes(all, hold, still);
	else
		assign_moving(all, index, hold, still);
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
	for (int j = 0; j < w->system->n; j++)
		if (w->system->velocity[j] >= 0)
			impact->back[j] = c->hold[impact->hold].back[w->system->velocity[j]];
	impact->jump = c->assignments;
	assign_bounce(all, index, impact->hold, false);
	impact->still = c->assignments;
	impact->jumps = impact->still - impact->jump;
	assign_bounce(all, index, impact->hold, true);
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
	for (int i = 0; i < all->own; i++)
		if (all->constraint[i].impact == index)
			series_impact->hold = i;
	assign(all, impact->in->jump, impact->in->jumps);
	series_impact->slope = ARRAY(int, all->c->columns);
	for (int k = 0; k < all->c->columns; k++) {
		const struct impact_slope *slope = &impact->in->slope[k];
		series_impact->slope[k] = watch(w, sequence_of_form(w, slope->guard), false);
		assign(all, slope->jump, impact->bounces ? 0 : slope->jumps);
		series_impact->jumps += impact->bounces ? 0 : slope->jumps;
	}
	series_impact->place = watch(w, sequence_of_form(w, impact->in->guard), false);
	series_impact->speed = series_impact->place;
	series_impact->still = impact->when->timed ? -1 : series_impact->still;
	if (series_impact->hold == NONE)
		return;
	if (!impact->moves) {
		series_impact->still = all->c->assignments;
		assign(all, impact->in->still, impact->in->jumps);
	}
	watch_bounce(all, index);
}

/* ---- the whole ---- */

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
	for (int i = 0; i < c->forces; i++)
		sum_add_entry(&slope, c->hold[i].force, &c->hold[i].force_direction[state], one);
	for (int i = 0; i < c->forces; i++) {
		if (c->hold[i].only != state)
			continue;
		int moves = sum_sequence(w, &slope);
		slope = (struct sum){ 0 };
		sum_add(&slope, TERM_SEQUENCE, hold_choice(w, &c->hold[i], c->none, moves), 0, one);
	}
	return slope;
}

/* Whether the equation of this force column is solved together with what holds */
static bool is_solved(const struct sequencing *w, int force_column)
{
	const struct model *model = w->step->model;
	bool solved = false;
	for (int j = 0; j < w->system->n && w->x->contacts; j++) {
		const int velocity = w->system->velocity[j], state = velocity >= 0 ? velocity : j;
		solved = solved || (model->equations.owner[j] == model->remainder.row[force_column] &&
				    w->x->contacts->solved[state]);
	}
	return solved;
}

int solved_force(struct sequencing *w, int force_column)
{
	const int row = w->step->model->remainder.row[force_column];
	struct sum force = { 0 };
	RATIONAL one = RATIO(1, 1);
	if (!is_solved(w, force_column))
		return NONE;
	for (int j = 0; j < w->system->n; j++) {
		mpq_srcptr mass = w->system->M[row * w->system->n + j];
		if (mpq_sgn(mass) != 0)
			sum_add(&force, TERM_SEQUENCE, w->highest[j], 0, mass);
	}
	sum_add_form(w, &force, carried_form(w->step->model, force_column), one);
	return sequence_of_sum(w, &force);
}

int held_force(struct sequencing *w, int force_column)
{
	const struct contacts *c = w->x->contacts;
	struct sum force = { 0 };
	if (!c || is_solved(w, force_column))
		return w->x->force[force_column];
	RATIONAL one = ZERO;
	mpq_set_ui(one, 1, 1);
	sum_add(&force, TERM_SEQUENCE, w->x->force[force_column], 0, one);
	for (int i = 0; i < c->forces; i++)
		sum_add_entry(&force, c->hold[i].force, &c->hold[i].gives[force_column], one);
	return sum_sequence(w, &force);
}

static int motion_sequence(struct sequencing *w, int place)
{
	const struct contacts *c = w->x->contacts;
	const int n = w->system->n, drag = place - n - w->step->model->spec->count.multipliers;
	int hold = 0;
	if (place < n)
		return highest_state(w->system, place);
	if (drag < 0 && w->highest[place] == NONE)
		return sequence_of_form(w, w->step->model->contacts.multiplier[place - n]);
	while (drag >= 0 && c->hold[hold].drag != drag)
		hold++;
	return drag < 0 ? w->highest[place] : c->hold[hold].force;
}

int *motion_sequences(struct sequencing *w)
{
	const struct model *model = w->step->model;
	const int count = w->system->n + model->spec->count.multipliers + model->contacts.drags;
	const bool *read = motion_read(model);
	int *sequence = ARRAY(int, count), any = 0;
	for (int i = 0; i < count; i++) {
		sequence[i] = read[i] ? motion_sequence(w, i) : NONE;
		any += read[i];
	}
	return any ? sequence : NULL;
}

/* The target has those that hold, and impacts, as bits. */
static void check_number(const struct constraints *all)
{
	enum { HELD = 64, IMPACTS = 32 };
	const struct model_contacts *contacts = &all->w->step->model->contacts;
	if (all->own > HELD)
		error(place_of(all, HELD), NULL, "beside a series more than the limit of %d frictions and contacts",
		      HELD);
	if (contacts->impacts > IMPACTS)
		error(contacts->impact[IMPACTS].when->at, NULL, "beside a series more than the limit of %d impacts",
		      IMPACTS);
}

void hold_contacts(struct sequencing *w)
{
	const struct model *model = w->step->model;
	struct constraints all = { .w = w };
	if (!has_contacts(model))
		return;
	struct contacts *c = all.c = w->x->contacts = NEW(struct contacts);
	c->bare = ARRAY(int, w->system->states);
	c->solved = ARRAY(bool, w->system->states);
	for (int i = 0; i < w->system->states; i++)
		c->bare[i] = NONE;
	c->none = all.none = sequence_of_form(w, form_number(0));
	c->series_impacts = model->contacts.impacts;
	c->series_impact = ARRAY(struct series_impact, model->contacts.impacts);
	c->columns = model->spec->joined.columns;
	find_constraints(&all);
	check_number(&all);
	c->hold = ARRAY(struct series_hold, all.constraints);
	c->holds = all.own;
	c->forces = all.constraints;
	for (int i = 0; i < all.constraints; i++)
		make_hold(&all, i);
	for (int i = 0; i < all.constraints; i++)
		make_slip(&all, i);
	make_forces(&all);
	for (int i = 0; i < all.constraints; i++)
		watch_hold(&all, i);
	for (int i = 0; i < c->series_impacts; i++)
		watch_impact(&all, i);
	sort_watches(c, w->system->states);
	for (int i = 0; i < all.constraints; i++) {
		c->hold[i].force = all.constraint[i].force;
		c->hold[i].force_direction = all.constraint[i].slope_direction;
		c->hold[i].gives = all.constraint[i].gives;
		c->hold[i].only = only_state(w, &all.constraint[i]);
		c->hold[i].drag = all.constraint[i].drag;
	}
}
