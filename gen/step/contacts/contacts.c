/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Impacts, contacts at rest and dry friction beside a Taylor series. What is held is a switching function in an
 * interval between two equal breakpoints: of friction its velocity, of a contact at rest the guard of its impacts. The
 * force that holds it is a sequence like others: what makes the rate of its velocity 0, of the accelerations without
 * it, which are sequences too. Where several act on each other, each combination of those that hold has its own. */
#include "model/contacts/friction.h"
#include "model/contacts/contacts.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"
#include "series_contacts.h"

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

/* ---- who holds, and how each acts on the others ---- */

struct constraint {
	int impact, drag;           /* one of them NONE */
	const struct form *velocity, *rate;
	const struct node *node;    /* of friction */
	mpq_t *force_direction;     /* per state: what its force, 1, adds to the slope; of a contact it presses off */
	mpq_t *gives;               /* per force column: what its force, 1, adds */
	mpq_t *delassus;            /* per constraint: what the force of that adds to the rate of the velocity here */
	int bare;                   /* sequences: that rate without any of these forces, */
	int slips, force;           /* the force while it slips, NONE: there is none; now */
	int group;
};

struct constraints {
	struct sequencing *w;
	int constraints;
	struct constraint *constraint;
	struct contacts *c;
	int none;                   /* a sequence: 0 */
};

static int rate_state(const struct sequencing *w, const struct basis *basis)
{
	if (basis->kind != BASIS_COORD || basis->order < w->step->model->frame.coord[basis->index]->highest)
		return NONE;
	return basis->order > 1 ? w->system->velocity[basis->index] : basis->index;
}

/* What one unit of this friction's force adds to the slope of each state */
static void direction_of_drag(const struct sequencing *w, struct constraint *h, const struct atom *atom)
{
	const struct model *model = w->step->model;
	struct basis basis = { .kind = BASIS_ATOM, .index = atom->index, .atom = atom };
	for (int e = 0; e < w->system->force_columns; e++) {
		const struct form_term *term = form_find(model->schedule.operator[0].left[e], &basis);
		if (term)
			mpq_set(h->gives[e], term->factor);
		for (int i = 0; i < w->system->states && term; i++) {
			rational_addmul(h->force_direction[i], term->factor,
					w->slopes[0][i * w->layout.size + w->layout.force_column + e]);
		}
	}
}

static void direction_of_contact(const struct sequencing *w, struct constraint *h, const struct impact *impact)
{
	const int n = w->system->n;
	for (int j = 0; j < n; j++)
		if (mpq_sgn(impact->in->direction[j]) != 0)
			mpq_neg(h->force_direction[w->system->velocity[j]], impact->in->direction[j]);
	for (int e = 0; e < w->system->force_columns; e++)
		for (int j = 0; j < n; j++) {
			mpq_srcptr mass = w->system->M[w->step->model->remainder.row[e] * n + j];
			if (w->system->velocity[j] >= 0)
				rational_addmul(h->gives[e], mass, h->force_direction[w->system->velocity[j]]);
		}
}

static struct constraint *add_constraint(struct constraints *all)
{
	struct constraint *h = MORE(all->constraint, all->constraints);
	*h = (struct constraint){ .impact = NONE, .drag = NONE, .slips = NONE,
			      .force_direction = rationals(all->w->system->states),
			      .gives = rationals(all->w->system->force_columns) };
	return h;
}

static void find_constraints(struct constraints *all)
{
	const struct model *model = all->w->step->model;
	for (int i = 0; i < model->contacts.impacts; i++) {
		if (!model->contacts.impact[i].bounces)
			continue;
		struct constraint *h = add_constraint(all);
		h->impact = i;
		h->velocity = model->contacts.impact[i].in->speed;
		h->rate = model->contacts.impact[i].in->press;
		direction_of_contact(all->w, h, &model->contacts.impact[i]);
	}
	for (int i = 0; i < model->contacts.drags; i++) {
		struct constraint *h = add_constraint(all);
		h->drag = i;
		h->velocity = model->contacts.drag[i].velocity;
		h->rate = model->contacts.drag[i].rate;
		h->node = model->contacts.drag[i].atom->node;
		direction_of_drag(all->w, h, model->contacts.drag[i].atom);
	}
}

static void find_delassus(struct constraints *all, const struct constraint *h, const struct constraint *of,
			  mpq_ptr delassus)
{
	for (int i = 0; i < h->rate->terms; i++) {
		int state = rate_state(all->w, &h->rate->term[i].basis);
		if (state == NONE)
			continue;
		rational_addmul(delassus, h->rate->term[i].factor, of->force_direction[state]);
	}
}

static void find_all_delassus(struct constraints *all)
{
	for (int i = 0; i < all->constraints; i++) {
		struct constraint *h = &all->constraint[i];
		h->delassus = rationals(all->constraints);
		for (int j = 0; j < all->constraints; j++)
			find_delassus(all, h, &all->constraint[j], h->delassus[j]);
		if (h->node && mpq_sgn(h->delassus[i]) == 0)
			error(h->node->at, "its velocity has to answer to its force",
			      "friction cannot hold what slides there");
		if (h->node && mpq_sgn(h->delassus[i]) > 0)
			error(h->node->at, "on the left side it stands with the sign of a damper: + friction(x', F)",
			      "this friction drives what slides instead of holding it");
	}
}

static bool meets(const struct constraints *all, int i, int j)
{
	return mpq_sgn(all->constraint[i].delassus[j]) != 0 || mpq_sgn(all->constraint[j].delassus[i]) != 0;
}

/* Those that act on each other, over others too, have one number. */
static void group_constraints(struct constraints *all)
{
	for (int i = 0; i < all->constraints; i++)
		all->constraint[i].group = i;
	for (bool changed = true; changed;) {
		changed = false;
		for (int i = 0; i < all->constraints; i++)
			for (int j = 0; j < all->constraints; j++)
				if (meets(all, i, j) && all->constraint[j].group > all->constraint[i].group) {
					all->constraint[j].group = all->constraint[i].group;
					changed = true;
				}
	}
}

/* ---- sequences ---- */

/* The slope of a state without what holds, once */
static int bare_slope(struct sequencing *w, int state)
{
	int *made = &w->x->contacts->bare[state];
	if (*made == NONE) {
		struct sum slope = slope_of_state(w, state);
		int sequence = sum_sequence(w, &slope);
		if (loads_change(w->system)) {
			RATIONALS *scale = plain_scale(w);
			add_changing_loads(w, &w->x->sequence[sequence], state, scale);
		}
		*made = sequence;
	}
	return *made;
}

/* The rate of a velocity, without what holds: highest derivatives by their equations */
static int bare_rate(struct sequencing *w, const struct form *rate)
{
	struct sum sum = { 0 };
	RATIONAL one = RATIO(1, 1);
	for (int i = 0; i < rate->terms; i++) {
		const struct form_term *term = &rate->term[i];
		struct form single = { 1, &rate->term[i], 0 };
		int state = rate_state(w, &term->basis);
		if (state == NONE)
			sum_add_form(w, &sum, &single, one);
		else
			sum_add(&sum, TERM_SEQUENCE, bare_slope(w, state), 0, term->factor);
	}
	return sequence_of_sum(w, &sum);
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

static int hold_choice(struct sequencing *w, const struct series_hold *hold, int held, int other)
{
	return new_sequence(w, (struct sequence){ .kind = SEQUENCE_CHOICE, .choice = CHOICE_BY_HOLD, .state = NONE,
						  .switching = hold->function, .breakpoint = hold->breakpoint,
						  .a = held, .b = other });
}

/* ---- forces of those that hold together ---- */

struct together {
	struct constraints *all;
	int of;                     /* the constraint whose force is made */
	int members, *member;       /* of its group, itself first */
	bool *holds;                /* per member */
};

/* inverse: of the answers among those that hold; false: there is none */
static bool invert(const struct together *t, int count, const int *which, mpq_t *inverse)
{
	mpq_t *a = rationals((size_t)(count * count));
	for (int i = 0; i < count; i++)
		for (int j = 0; j < count; j++)
			mpq_set(a[i * count + j], t->all->constraint[which[i]].delassus[which[j]]);
	int column;
	return rational_inverse(count, a, inverse, &column);
}

/* Of friction that a contact at rest leaves no velocity: it brakes what the contact stops, and so slips that way. */
static int side_beside(const struct constraints *all, int friction, int contact)
{
	bool along = mpq_sgn(all->constraint[friction].delassus[contact]) < 0;
	return along == all->c->hold[friction].above ? 1 : -1;
}

static void note_conflict(const struct constraints *all, int count, const int *which)
{
	struct contacts *c = all->c;
	struct conflict new = { .hold = NONE };
	for (int i = 0; i < count; i++)
		new.set |= 1UL << which[i];
	for (int i = 0; i < c->conflicts; i++)
		if ((c->conflict[i].set & new.set) == c->conflict[i].set)
			return;
	int frictions = 0, at = 0;
	for (int i = 0; i < count; i++) {
		bool drags = all->constraint[which[i]].drag != NONE;
		frictions += drags;
		at = drags ? i : at;
	}
	if (frictions == count)
		error(all->constraint[which[0]].node->at, "without one of them its part is known",
		      "friction holds what other friction holds already: while all of it sticks its force is not "
		      "determined");
	if (count == 2 && frictions == 1) {
		new.hold = which[at];
		new.side = side_beside(all, which[at], which[!at]);
	}
	*MORE(c->conflict, c->conflicts) = new;
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
			if (t->holds[j] || other->slips == NONE)
				continue;
			mpq_neg(part, inverse[i]);
			mpq_mul(part, part, h->delassus[t->member[j]]);
			sum_add(&sum, TERM_SEQUENCE, other->slips, 0, part);
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

static void make_force(struct constraints *all, int index)
{
	enum { MOST = 4 };
	struct sequencing *w = all->w;
	struct constraint *h = &all->constraint[index];
	struct together t = { all, index, 1, ARRAY(int, all->constraints), ARRAY(bool, all->constraints) };
	t.member[0] = index;
	t.holds[0] = true;
	for (int i = 0; i < all->constraints; i++)
		if (i != index && all->constraint[i].group == h->group)
			t.member[t.members++] = i;
	if (t.members > MOST)
		error(h->node ? h->node->at : w->step->model->contacts.impact[h->impact].when->at,
		      "a piecewise-linear model takes more",
		      "beside what is not piecewise linear at most %d frictions and contacts act on each other", MOST);
	int held = force_in_cases(&t, 1);
	h->force = hold_choice(w, &all->c->hold[index], held, h->slips == NONE ? all->none : h->slips);
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
	const struct constraint *h = &all->constraint[index];
	struct sum sum = { 0 };
	RATIONAL factor = ZERO, part = ZERO;
	mpq_set_si(factor, -sign, 1);
	mpq_div(factor, factor, h->delassus[index]);
	sum_add(&sum, TERM_SEQUENCE, h->bare, 0, factor);
	for (int j = 0; j < all->constraints; j++) {
		if (j == index || mpq_sgn(h->delassus[j]) == 0)
			continue;
		mpq_mul(part, factor, h->delassus[j]);
		sum_add(&sum, TERM_SEQUENCE, all->constraint[j].force, 0, part);
	}
	return sum;
}

static double *row_of_back(const struct constraints *all, int index)
{
	const struct constraint *h = &all->constraint[index];
	int states = all->w->system->states;
	double *back = ARRAY(double, states);
	RATIONAL part = ZERO;
	for (int i = 0; i < states; i++) {
		mpq_div(part, h->force_direction[i], h->delassus[index]);
		back[i] = round_rational(part);
	}
	return back;
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
	hold->back = row_of_back(all, index);
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
				   .restitution = round_rational(impact->in->restitution) };
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
	series_impact->still = all->c->assignments;
	assign(all, impact->in->still, impact->in->jumps);
	series_impact->speed = watch(w, sequence_of_form(w, impact->in->speed), false);
	for (int j = 0; j < w->system->n; j++)
		series_impact->back[j] = round_rational(impact->in->direction[j]);
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
		if (mpq_sgn(c->hold[i].force_direction[state]) != 0)
			sum_add(&slope, TERM_SEQUENCE, c->hold[i].force, 0, c->hold[i].force_direction[state]);
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
		if (mpq_sgn(c->hold[i].gives[force_column]) != 0)
			sum_add(&force, TERM_SEQUENCE, c->hold[i].force, 0, c->hold[i].gives[force_column]);
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
	find_all_delassus(&all);
	group_constraints(&all);
	c->hold = ARRAY(struct series_hold, all.constraints);
	c->holds = all.constraints;
	for (int i = 0; i < all.constraints; i++)
		make_hold(&all, i);
	for (int i = 0; i < all.constraints; i++)
		make_slip(&all, i);
	for (int i = 0; i < all.constraints; i++)
		all.constraint[i].bare = bare_rate(w, all.constraint[i].rate);
	for (int i = 0; i < all.constraints; i++)
		make_force(&all, i);
	for (int i = 0; i < all.constraints; i++)
		watch_hold(&all, i);
	for (int i = 0; i < model->contacts.impacts; i++)
		watch_impact(&all, i);
	sort_watches(c);
	for (int i = 0; i < all.constraints; i++) {
		c->hold[i].force = all.constraint[i].force;
		c->hold[i].force_direction = all.constraint[i].force_direction;
		c->hold[i].gives = all.constraint[i].gives;
		c->hold[i].only = only_state(w, all.constraint[i].velocity);
	}
}
