/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forces of those that hold together beside a series, where the mass matrix or their directions depend on the state:
 * one system for the group, in which what does not hold has a row of its own. Friction by multipliers of constraints is
 * solved for with them. */
#include "model/contacts/friction.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"
#include "inner.h"

#include <math.h>

/* ---- what cannot be held all at once ---- */

static double dot_samples(const struct constraints *all, int a, int b)
{
	double sum = 0;
	for (int i = 0; i < all->w->system->states; i++)
		sum += all->constraint[a].sample[i] * all->constraint[b].sample[i];
	return sum;
}

/* Of friction that a contact at rest leaves no velocity: it brakes what the contact stops, and so slips that way. Where
 * they go together by way of a constraint that way follows the state. */
static void find_side_beside(const struct constraints *all, int contact, struct conflict *c)
{
	const struct entry *delassus = &all->constraint[c->hold].delassus[contact];
	const bool along = is_number_entry(delassus) && mpq_sgn(delassus->number) < 0;
	c->side = along == all->c->hold[c->hold].above ? 1 : -1;
	c->watch = is_number_entry(delassus) ? NONE : watch(all->w, delassus->sequence, false);
}

void note_conflict(const struct constraints *all, int count, const int *which)
{
	struct contacts *c = all->c;
	struct conflict new = { .hold = NONE, .watch = NONE };
	for (int i = 0; i < count; i++)
		new.set |= (uint64_t)1 << which[i];
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
		find_side_beside(all, which[!at], &new);
	}
	*MORE(c->conflict, c->conflicts) = new;
}

struct place place_of(const struct constraints *all, int index)
{
	const struct constraint *h = &all->constraint[index];
	return h->node ? h->node->at : all->w->step->model->contacts.impact[h->impact].when->at;
}

static _Noreturn void report_dependent(const struct constraints *all, int index)
{
	error(place_of(all, index), "without one of them its part is known",
	      "while all frictions stick and all contacts rest that act on each other their forces are not determined");
}

/* Whether one is always a sum of others: by their Gram matrix at some state, by Cholesky */
static bool are_dependent(const struct constraints *all, int count, const int *which)
{
	double *a = ARRAY(double, count * count);
	for (int i = 0; i < count; i++)
		for (int j = 0; j <= i; j++) {
			double sum = dot_samples(all, which[i], which[j]);
			for (int k = 0; k < j; k++)
				sum -= a[i * count + k] * a[j * count + k];
			if (i == j && !(sum > 1e-9 * dot_samples(all, which[i], which[i])))
				return true;
			a[i * count + j] = i == j ? sqrt(sum) : sum / a[j * count + j];
		}
	return false;
}

/* Those of a group that are no derivatives, which are held with what they follow, come first. */
int own_of(const struct constraints *all, int members, const int *member)
{
	while (members > 0 && all->constraint[member[members - 1]].of != NONE)
		members--;
	return members;
}

/* Pairs, and that nothing else is a sum of others: friction that one of its pair excludes is left out of those */
static void note_pairs(const struct constraints *all, int members, const int *member)
{
	int count = 0, *kept = ARRAY(int, members);
	for (int i = 0; i < members; i++) {
		bool alone = true;
		for (int j = 0; j < members; j++) {
			const int pair[] = { member[i < j ? i : j], member[i < j ? j : i] };
			if (i == j || !are_dependent(all, 2, pair))
				continue;
			note_conflict(all, 2, pair);
			alone = alone && all->constraint[member[i]].drag == NONE;
		}
		if (alone)
			kept[count++] = member[i];
	}
	if (are_dependent(all, count, kept))
		report_dependent(all, kept[count - 1]);
}

/* Sets of few come first, so that those with a conflict in them are not noted again. */
void note_conflicts(const struct constraints *all, int members, const int *member)
{
	enum { MOST = 8 };              /* so many have sets that all can be looked at */
	members = own_of(all, members, member);
	if (members > MOST)
		note_pairs(all, members, member);
	for (int size = 2; size <= members && members <= MOST; size++)
		for (int set = 0; set < 1 << members; set++) {
			int count = 0, *which = ARRAY(int, members);
			for (int i = 0; i < members; i++)
				if (set >> i & 1)
					which[count++] = member[i];
			if (count == size && are_dependent(all, count, which))
				note_conflict(all, count, which);
		}
}

/* ---- forces ---- */

/* With the sign of the sliding velocity */
int along_sliding(struct sequencing *w, const struct series_hold *hold, int force)
{
	const int back = minus_sequence(w, force);
	return new_sequence(w, (struct sequence){
		.kind = SEQUENCE_CHOICE, .choice = CHOICE_BY_STATE, .state = NONE, .switching = hold->function,
		.breakpoint = hold->breakpoint, .a = hold->above ? force : back, .b = hold->above ? back : force });
}

int hold_choice(struct sequencing *w, const struct series_hold *hold, int held, int other)
{
	return new_sequence(w, (struct sequence){ .kind = SEQUENCE_CHOICE, .choice = CHOICE_BY_HOLD, .state = NONE,
						  .switching = hold->function, .breakpoint = hold->breakpoint,
						  .a = held, .b = other });
}

/* `held` where a constraint holds and no conflict, of which it is the last, stands against that; else `other` */
static int where_it_holds(const struct constraints *all, int index, int held, int other)
{
	struct sequencing *w = all->w;
	const struct contacts *c = all->c;
	index = held_by(all, index);
	if (held == other)
		return held;
	for (int k = 0; k < c->conflicts; k++) {
		int all_hold = other;
		if (c->conflict[k].set >> index != 1)
			continue;
		for (int i = 0; i < index; i++)
			if (c->conflict[k].set >> i & 1)
				all_hold = hold_choice(w, &c->hold[i], all_hold, held);
		held = all_hold;
	}
	return hold_choice(w, &c->hold[index], held, other);
}

/* Accelerations of all equations that the group's mass matrices couple, then the forces of its members. A motion is
 * M q'' + sum of c force = f, and of a force n q'' + n' q' = 0 where it holds, else it is known. */
struct joined {
	const struct constraints *all;
	int members, *member;
	int accelerations;
	int iterate, iterates;      /* of Newton's method for friction by multipliers; iterate 0: without it */
	int *coord;                 /* per acceleration; a multiplier has none, and a number beyond the coordinates */
	bool *coupled;              /* per state: its slope is one of them */
	struct linear_equations *e;
};

static int state_of_coord(const struct sequencing *w, int coord)
{
	int velocity = coord < w->system->n ? w->system->velocity[coord] : NONE;
	return coord >= w->system->n ? NONE : velocity >= 0 ? velocity : coord;
}

/* Friction whose force reads multipliers; NULL: it does not */
static const struct drag *reaction_of(const struct joined *g, int k)
{
	const struct constraint *h = &g->all->constraint[g->member[k]];
	const struct drag *drag = h->drag == NONE ? NULL : &g->all->w->step->model->contacts.drag[h->drag];
	return drag && drag->by ? drag : NULL;
}

static bool acts_on(const struct joined *g, const struct linear_system *mass)
{
	bool any = false;
	for (int i = 0; i < mass->n; i++) {
		int state = state_of_coord(g->all->w, mass->written->highest[i].index);
		for (int k = 0; k < g->members; k++) {
			const struct constraint *h = &g->all->constraint[g->member[k]];
			const struct drag *drag = reaction_of(g, k);
			any = any || (drag && drag->by[mass->written->highest[i].index]->terms) ||
			      (state != NONE && !(is_zero_entry(&h->row[state]) &&
						  is_zero_entry(&h->force_direction[state])));
		}
	}
	return any;
}

static void add_mass(struct joined *g, const struct linear_system *mass)
{
	struct sequencing *w = g->all->w;
	struct linear_equations *e = g->e;
	const int first = g->accelerations;
	for (int i = 0; i < mass->n; i++) {
		const int row = first + i, coord = mass->written->highest[i].index;
		*MORE(g->coord, g->accelerations) = coord;
		e->right[row] = mass->f[i]->terms ? sequence_of_form(w, mass->f[i]) : NONE;
		for (int j = 0; j < mass->n; j++)
			if (mass->M[i * mass->n + j]->terms)
				e->matrix[row * e->n + first + j] = sequence_of_form(w, mass->M[i * mass->n + j]);
		if (state_of_coord(w, coord) != NONE)
			g->coupled[state_of_coord(w, coord)] = true;
	}
}

static int force_on(const struct joined *g, int acceleration, int k)
{
	const struct moving_contact *moving = g->all->constraint[g->member[k]].moving;
	const int coord = g->coord[acceleration];
	const struct form *force = moving && coord < g->all->w->system->n ? moving->force[coord] : NULL;
	return force && force->terms ? sequence_of_form(g->all->w, force) : NONE;
}

/* What the slopes of the other states are, as they stand in its rate: by a force of 1, or without any */
static void delassus_beside(const struct joined *g, int k, const struct constraint *of, struct entry *delassus)
{
	struct sequencing *w = g->all->w;
	const struct constraint *h = &g->all->constraint[g->member[k]];
	struct entry *beside = entries_new(w->system->states);
	for (int i = 0; i < w->system->states; i++)
		if (!g->coupled[i] && of)
			beside[i] = of->force_direction[i];
		else if (!g->coupled[i] && !is_zero_entry(&h->row[i]))
			beside[i].sequence = bare_slope(w, i);
	dot_entries(w, w->system->states, h->row, beside, delassus);
}

/* The rate without what the system solves for, reversed */
static int right_where_held(const struct joined *g, int k)
{
	struct sequencing *w = g->all->w;
	const struct constraint *h = &g->all->constraint[g->member[k]];
	struct entry *beside = entries_new(1);
	struct sum sum = { 0 };
	RATIONAL minus = RATIO(-1, 1);
	delassus_beside(g, k, NULL, beside);
	sum_add(&sum, TERM_SEQUENCE, entry_sequence(w, beside), 0, minus);
	if (h->moving)
		sum_add_form(w, &sum, h->moving->rest, minus);
	for (int i = 0; i < h->rate->terms && !h->moving; i++) {
		struct form single = { 1, &h->rate->term[i], 0 };
		if (rate_state(w, &h->rate->term[i].basis) == NONE)
			sum_add_form(w, &sum, &single, minus);
	}
	return sum_sequence(w, &sum);
}

static int root_of(struct sequencing *w, int force, int size, long sign)
{
	enum { WITHIN = 1000000 };
	RATIONAL factor = RATIO(sign, 1), other = RATIO(-sign * (WITHIN - sign), WITHIN);
	struct sum sum = { 0 };
	sum_add_product(&sum, force, force, factor);
	sum_add_product(&sum, size, size, other);
	return new_sequence(w, (struct sequence){ .kind = SEQUENCE_ROOT, .state = NONE, .b = NONE,
						  .a = sum_sequence(w, &sum) });
}

/* 1; no number where the force f of the system before is not F of its multipliers, so that Newton's method does not
 * find it: too much friction has no force. Roots of f^2 - (1 - e) F^2 and of (1 + e) F^2 - f^2 see that. */
static int one_where_found(const struct joined *g, int k, int size)
{
	struct sequencing *w = g->all->w;
	const int force = g->all->constraint[g->member[k]].force;
	RATIONAL one = RATIO(1, 1), tiny = RATIO(1, 1);
	struct sum sum = { 0 };
	mpq_div_2exp(tiny, tiny, 100);
	sum_add(&sum, TERM_TIME, 0, 0, one);
	sum_add(&sum, TERM_SEQUENCE, root_of(w, force, size, 1), 0, tiny);
	sum_add(&sum, TERM_SEQUENCE, root_of(w, force, size, -1), 0, tiny);
	return sum_sequence(w, &sum);
}

/* Where it slips by a force F that reads multipliers: f - s F'(u) u = s (F(u) - F'(u) u), u those of the system before,
 * first without friction: Newton's method. Forces that are linear between kinks are there at once. */
static void add_reaction(struct joined *g, int k, int *slip, int *right, int *one)
{
	const struct constraints *all = g->all;
	struct sequencing *w = all->w;
	const struct series_hold *hold = &all->c->hold[g->member[k]];
	const struct drag *drag = reaction_of(g, k);
	RATIONAL plus = RATIO(1, 1), minus = RATIO(-1, 1);
	struct sum sum = { 0 };
	for (int i = 0; i < g->accelerations; i++)
		slip[i] = all->none;
	*right = all->none;
	*one = sequence_of_form(w, form_number(1));
	if (!drag || g->iterate == 0)
		return;
	const int size = force_sequence(w, drag->force, drag->force);
	if (drag->curved && g->iterate == g->iterates)
		*one = one_where_found(g, k, size);
	sum_add(&sum, TERM_SEQUENCE, size, 0, plus);
	for (int i = 0; i < g->accelerations; i++) {
		const struct form *by = drag->by[g->coord[i]];
		if (by->terms == 0)
			continue;
		int slope = sequence_of_form(w, by);
		slope = never_falls_below(drag->force) ? slope : positive_sequence(w, drag->force, slope);
		sum_add_product(&sum, slope, w->highest[g->coord[i]], minus);
		slip[i] = along_sliding(w, hold, minus_sequence(w, slope));
	}
	*right = along_sliding(w, hold, sequence_of_sum(w, &sum));
}

static void add_member(struct joined *g, int k)
{
	const struct constraints *all = g->all;
	struct linear_equations *e = g->e;
	const struct constraint *h = &all->constraint[g->member[k]];
	const int row = g->accelerations + k;
	SCRATCH int *slip = ARRAY(int, g->accelerations);
	int slips, one;
	add_reaction(g, k, slip, &slips, &one);
	for (int i = 0; i < g->accelerations; i++) {
		int state = state_of_coord(all->w, g->coord[i]);
		const bool held = state != NONE && !is_zero_entry(&h->row[state]);
		if (held || slip[i] != all->none)
			e->matrix[row * e->n + i] = where_it_holds(
				all, g->member[k], held ? entry_sequence(all->w, &h->row[state]) : all->none, slip[i]);
		e->matrix[i * e->n + row] = force_on(g, i, k);
	}
	for (int l = 0; l < g->members; l++) {
		struct entry *delassus = entries_new(1);
		delassus_beside(g, k, &all->constraint[g->member[l]], delassus);
		if (l == k || !is_zero_entry(delassus))
			e->matrix[row * e->n + g->accelerations + l] = where_it_holds(
				all, g->member[k], entry_sequence(all->w, delassus), l == k ? one : all->none);
	}
	e->right[row] = where_it_holds(all, g->member[k], right_where_held(g, k), h->slips == NONE ? slips : h->slips);
}

static int residual_of_motion(const struct joined *g, const struct form *written, int row)
{
	struct sequencing *w = g->all->w;
	struct sum sum = { 0 };
	RATIONAL one = RATIO(1, 1);
	sum_add_form(w, &sum, written, one);
	for (int k = 0; k < g->members; k++) {
		const struct moving_contact *moving = g->all->constraint[g->member[k]].moving;
		const int coord = g->coord[row], force = g->all->constraint[g->member[k]].force;
		struct entry *factor = entries_new(1);
		if (!moving || coord >= w->system->n)
			continue;
		set_entry(w, moving->force[coord], factor);
		sum_add_entry(&sum, force, factor, one);
	}
	return sequence_of_sum(w, &sum);
}

static int residual_of_member(const struct joined *g, int k)
{
	struct sequencing *w = g->all->w;
	struct constraint *h = &g->all->constraint[g->member[k]];
	struct sum known = { 0 };
	RATIONAL one = RATIO(1, 1), minus = RATIO(-1, 1);
	sum_add(&known, TERM_SEQUENCE, h->force, 0, one);
	if (h->slips != NONE)
		sum_add(&known, TERM_SEQUENCE, h->slips, 0, minus);
	h->bare = sequence_of_form(w, h->rate);
	return where_it_holds(g->all, g->member[k], h->bare, sequence_of_sum(w, &known));
}

/* Highest derivatives of all coordinates, with the forces of the group */
static void find_highest(const struct joined *g)
{
	struct sequencing *w = g->all->w;
	RATIONAL one = RATIO(1, 1);
	for (int i = 0; i < g->accelerations; i++) {
		w->highest[g->coord[i]] = g->e->first + i;
		const int state = state_of_coord(w, g->coord[i]);
		if (state == NONE)
			continue;
		g->all->c->bare[state] = g->e->first + i;
		g->all->c->solved[state] = true;
	}
	for (int j = 0; j < w->system->n; j++) {
		const int state = state_of_coord(w, j);
		struct sum slope = { 0 };
		if (g->coupled[state])
			continue;
		sum_add(&slope, TERM_SEQUENCE, bare_slope(w, state), 0, one);
		for (int k = 0; k < g->members; k++)
			sum_add_entry(&slope, g->all->constraint[g->member[k]].force,
				      &g->all->constraint[g->member[k]].force_direction[state], one);
		w->highest[j] = sequence_of_sum(w, &slope);
	}
}

/* M x = f, and its solution as sequences */
static void make_equations(struct joined *g)
{
	struct sequencing *w = g->all->w;
	const struct model_contacts *contacts = &w->step->model->contacts;
	struct linear_equations *e = g->e = NEW(struct linear_equations);
	g->accelerations = 0;
	e->n = g->members;
	for (int i = 0; i < contacts->masses; i++)
		e->n += acts_on(g, contacts->mass[i]) ? contacts->mass[i]->n : 0;
	e->number = w->x->equations++;
	e->matrix = ARRAY(int, e->n * e->n);
	e->right = ARRAY(int, e->n);
	e->residual = ARRAY(int, e->n);
	for (int i = 0; i < e->n * e->n; i++)
		e->matrix[i] = NONE;
	for (int i = 0; i < contacts->masses; i++)
		if (acts_on(g, contacts->mass[i]))
			add_mass(g, contacts->mass[i]);
	for (int k = 0; k < g->members; k++)
		add_member(g, k);
	e->first = w->x->count;
	for (int i = 0; i < e->n; i++)
		new_sequence(w, (struct sequence){ .kind = SEQUENCE_SOLUTION, .state = NONE, .a = NONE, .b = NONE,
						   .equations = e, .component = i });
	for (int k = 0; k < g->members; k++)
		g->all->constraint[g->member[k]].force = e->first + g->accelerations + k;
}

/* What was made of multipliers of the system before is made again. */
static void forget_reactions(const struct joined *g)
{
	struct sequencing *w = g->all->w;
	const struct frame *frame = &w->step->model->frame;
	bool *seen = ARRAY(bool, (size_t)atoms_count(w->step->model->equations.atoms));
	int kept = 0;
	for (int i = 0; i < w->operands; i++) {
		SCRATCH bool *all = ARRAY(bool, (size_t)atoms_count(w->step->model->equations.atoms));
		bool reads = false;
		for (const struct form_term **term = terms_within(w->operand[i].form, all); *term; term++)
			reads = reads || is_highest(frame, &(*term)->basis);
		for (const struct form_term **term = terms_within(w->operand[i].form, seen); *term && reads; term++)
			if ((*term)->basis.atom && (*term)->basis.atom->highest)
				w->atom[(*term)->basis.atom->index] = NONE;
		if (!reads)
			w->operand[kept++] = w->operand[i];
	}
	w->operands = kept;
}

/* Of a system that Newton's method leaves behind, whose first coefficients alone are read: as it stands */
static void plain_residuals(const struct joined *g)
{
	struct linear_equations *e = g->e;
	RATIONAL one = RATIO(1, 1), minus = RATIO(-1, 1);
	for (int i = 0; i < e->n; i++) {
		struct sum sum = { 0 };
		for (int j = 0; j < e->n; j++)
			if (e->matrix[i * e->n + j] != NONE)
				sum_add_product(&sum, e->matrix[i * e->n + j], e->first + j, one);
		if (e->right[i] != NONE)
			sum_add(&sum, TERM_SEQUENCE, e->right[i], 0, minus);
		e->residual[i] = sequence_of_sum(g->all->w, &sum);
	}
	for (int i = 0; i < g->accelerations; i++)
		g->all->w->highest[g->coord[i]] = e->first + i;
	forget_reactions(g);
}

/* Without friction that reads multipliers, then with it, again where it is curved */
static int iterates_of(const struct joined *g)
{
	enum { CURVED = 6 };
	int iterates = 0;
	for (int k = 0; k < g->members; k++) {
		const struct drag *drag = reaction_of(g, k);
		const int needed = !drag ? 0 : drag->curved ? CURVED : 1;
		iterates = needed > iterates ? needed : iterates;
	}
	return iterates;
}

/* The force of what slips, of the multipliers that are solved for; kinks are where those pass them */
static void take_reactions(const struct joined *g)
{
	struct sequencing *w = g->all->w;
	const struct frame *frame = &w->step->model->frame;
	forget_reactions(g);
	for (int i = 0; i < w->x->functions; i++) {
		SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(w->step->model->equations.atoms));
		bool reads = false;
		for (const struct form_term **term = terms_within(w->x->function[i].form, seen); *term; term++)
			reads = reads || is_highest(frame, &(*term)->basis);
		if (reads)
			w->x->function[i].sequence = sequence_of_form(w, w->x->function[i].form);
	}
	for (int k = 0; k < g->members; k++)
		if (reaction_of(g, k))
			g->all->constraint[g->member[k]].slips = along_sliding(
				w, &g->all->c->hold[g->member[k]],
				force_sequence(w, reaction_of(g, k)->force, reaction_of(g, k)->force));
}

void solve_group(const struct constraints *all, int members, int *member)
{
	struct sequencing *w = all->w;
	const struct model_contacts *contacts = &w->step->model->contacts;
	struct joined g = { .all = all, .members = members, .member = member,
			   .coupled = ARRAY(bool, w->system->states) };
	g.iterates = iterates_of(&g);
	for (; g.iterate < g.iterates; g.iterate++) {
		make_equations(&g);
		plain_residuals(&g);
	}
	make_equations(&g);
	find_highest(&g);
	if (g.iterates > 0)
		take_reactions(&g);
	for (int i = 0, row = 0; i < contacts->masses; i++)
		for (int j = 0; j < contacts->mass[i]->n && acts_on(&g, contacts->mass[i]); j++, row++)
			g.e->residual[row] = residual_of_motion(&g, contacts->mass[i]->written->residual[j], row);
	for (int k = 0; k < members; k++) {
		struct constraint *h = &all->constraint[member[k]];
		h->solved = true;
		g.e->residual[g.accelerations + k] = residual_of_member(&g, k);
		for (int i = 0; i < w->system->states; i++)     /* their slopes are solved for */
			if (g.coupled[i])
				h->slope_direction[i] = entries_new(1)[0];
	}
}
