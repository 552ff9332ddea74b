/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who holds beside a series, how the force of each acts on the others, and forces of those that hold together. Factors
 * are numbers; those of mechanisms, whose mass matrix or whose directions depend on the state, are sequences. */
#include "model/contacts/friction.h"
#include "model/contacts/contacts.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"
#include "inner.h"

/* ---- factors ---- */

static struct entry *entries(int count)
{
	struct entry *all = ARRAY(struct entry, count);
	for (int i = 0; i < count; i++) {
		mpq_init(all[i].number);
		all[i].sequence = NONE;
	}
	return all;
}

static bool is_zero(const struct entry *e)
{
	return e->sequence == NONE && mpq_sgn(e->number) == 0;
}

bool is_number_entry(const struct entry *e)
{
	return e->sequence == NONE;
}

static void set_entry(struct sequencing *w, const struct form *form, struct entry *entry)
{
	RATIONAL part = ZERO;
	if (!is_constant(form)) {
		entry->sequence = sequence_of_form(w, form);
		return;
	}
	for (int i = 0; i < form->terms; i++) {
		mpq_set(part, form->term[i].factor);
		if (form->term[i].basis.kind == BASIS_PI)
			mpq_mul(part, part, w->pi);
		mpq_add(entry->number, entry->number, part);
	}
}

static void add_product(struct sum *sum, int a, int b, mpq_srcptr factor)
{
	sum_add(sum, TERM_PRODUCT, a < b ? a : b, a < b ? b : a, factor);
}

void sum_add_entry(struct sum *sum, int sequence, const struct entry *entry, mpq_srcptr factor)
{
	RATIONAL part = ZERO;
	mpq_mul(part, factor, entry->number);
	if (entry->sequence != NONE)
		add_product(sum, sequence, entry->sequence, factor);
	else if (mpq_sgn(part) != 0)
		sum_add(sum, TERM_SEQUENCE, sequence, 0, part);
}

/* entry += the products of `count` pairs */
static void dot_entries(struct sequencing *w, int count, const struct entry *a, const struct entry *b,
			struct entry *entry)
{
	RATIONAL one = RATIO(1, 1);
	struct sum sum = { 0 };
	for (int i = 0; i < count; i++) {
		if (is_zero(&a[i]) || is_zero(&b[i]))
			continue;
		if (is_number_entry(&a[i]) && is_number_entry(&b[i]))
			rational_addmul(entry->number, a[i].number, b[i].number);
		else if (is_number_entry(&a[i]))
			sum_add_entry(&sum, b[i].sequence, &a[i], one);
		else
			sum_add_entry(&sum, a[i].sequence, &b[i], one);
	}
	if (sum.keys == 0)
		return;
	if (mpq_sgn(entry->number) != 0)
		sum_add(&sum, TERM_TIME, 0, 0, entry->number);
	entry->sequence = sequence_of_sum(w, &sum);
}

int entry_sequence(struct sequencing *w, const struct entry *entry)
{
	return is_number_entry(entry) ? sequence_of_form(w, form_constant(entry->number)) : entry->sequence;
}

int quotient_by_entry(struct sequencing *w, int a, const struct entry *below)
{
	RATIONAL part = ZERO;
	struct sum sum = { 0 };
	if (!is_number_entry(below))
		return new_sequence(w, (struct sequence){ .kind = SEQUENCE_QUOTIENT, .state = NONE, .a = a,
							  .b = below->sequence });
	mpq_inv(part, below->number);
	sum_add(&sum, TERM_SEQUENCE, a, 0, part);
	return sequence_of_sum(w, &sum);
}

/* ---- who holds, and how each acts on the others ---- */

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
			mpq_set(h->gives[e].number, term->factor);
		for (int i = 0; i < w->system->states && term; i++) {
			rational_addmul(h->force_direction[i].number, term->factor,
					w->slopes[0][i * w->layout.size + w->layout.force_column + e]);
		}
	}
}

/* M times its accelerations, where it stands in a force column */
static void gives_of(struct sequencing *w, struct constraint *h)
{
	const int n = w->system->n;
	struct entry *mass = entries(n), *direction = ARRAY(struct entry, n);
	for (int j = 0; j < n; j++)
		direction[j] = h->force_direction[w->system->velocity[j] >= 0 ? w->system->velocity[j] : j];
	for (int e = 0; e < w->system->force_columns; e++) {
		for (int j = 0; j < n; j++)
			mpq_set(mass[j].number, w->system->M[w->step->model->remainder.row[e] * n + j]);
		dot_entries(w, n, mass, direction, &h->gives[e]);
	}
}

static void direction_of_contact(struct sequencing *w, struct constraint *h, const struct impact *impact)
{
	for (int j = 0; j < w->system->n; j++)
		if (mpq_sgn(impact->in->direction[j]) != 0)
			mpq_neg(h->force_direction[w->system->velocity[j]].number, impact->in->direction[j]);
	gives_of(w, h);
}

/* Of mechanisms: what 1 of its force takes from the slopes, and the factors of those in its rate */
static void directions_that_move(struct sequencing *w, struct constraint *h)
{
	const struct form *zero = form_number(0);
	for (int j = 0; j < w->system->n; j++) {
		const int velocity = w->system->velocity[j], state = velocity >= 0 ? velocity : j;
		set_entry(w, form_difference(zero, h->moving->push[j]), &h->force_direction[state]);
		set_entry(w, h->moving->gradient[j], &h->row[state]);
		h->sample[state] = h->moving->sample[j];
	}
	gives_of(w, h);
}

static void rows_of_rate(const struct sequencing *w, struct constraint *h)
{
	for (int i = 0; i < h->rate->terms; i++) {
		int state = rate_state(w, &h->rate->term[i].basis);
		if (state != NONE)
			mpq_set(h->row[state].number, h->rate->term[i].factor);
	}
	for (int i = 0; i < w->system->states; i++)
		h->sample[i] = mpq_get_d(h->row[i].number);
}

static struct constraint *add_constraint(struct constraints *all, const struct moving_contact *moving)
{
	const int states = all->w->system->states;
	struct constraint *h = MORE(all->constraint, all->constraints);
	*h = (struct constraint){ .impact = NONE, .drag = NONE, .slips = NONE, .moving = moving,
				  .force_direction = entries(states),
				  .slope_direction = ARRAY(struct entry, states), .row = entries(states),
				  .sample = ARRAY(double, states),
				  .gives = entries(all->w->system->force_columns) };
	return h;
}

static void add_contact(struct constraints *all, int index)
{
	const struct impact *impact = &all->w->step->model->contacts.impact[index];
	struct constraint *h = add_constraint(all, impact->in->moving);
	h->impact = index;
	h->velocity = impact->in->speed;
	h->rate = impact->in->press;
	if (h->moving)
		return;
	direction_of_contact(all->w, h, impact);
	rows_of_rate(all->w, h);
}

static void add_drag(struct constraints *all, int index)
{
	const struct drag *drag = &all->w->step->model->contacts.drag[index];
	struct constraint *h = add_constraint(all, drag->moving);
	h->drag = index;
	h->velocity = drag->velocity;
	h->rate = drag->rate;
	h->node = drag->atom->node;
	if (h->moving)
		return;
	direction_of_drag(all->w, h, drag->atom);
	rows_of_rate(all->w, h);
}

static void add_constraints(struct constraints *all)
{
	const struct model *model = all->w->step->model;
	for (int i = 0; i < model->contacts.impacts; i++)
		if (model->contacts.impact[i].bounces)
			add_contact(all, i);
	for (int i = 0; i < model->contacts.drags; i++)
		add_drag(all, i);
	for (int i = 0; i < all->constraints; i++)
		if (all->constraint[i].moving)
			directions_that_move(all->w, &all->constraint[i]);
}

static void check_answer(const struct constraint *h, const struct entry *answer)
{
	if (!h->node || !is_number_entry(answer))
		return;
	if (mpq_sgn(answer->number) == 0)
		error(h->node->at, "its velocity has to answer to its force", "friction cannot hold what slides there");
	if (mpq_sgn(answer->number) > 0)
		error(h->node->at, "on the left side it stands with the sign of a damper: + friction(x', F)",
		      "this friction drives what slides instead of holding it");
}

static void find_all_delassus(struct constraints *all)
{
	for (int i = 0; i < all->constraints; i++) {
		struct constraint *h = &all->constraint[i];
		h->delassus = entries(all->constraints);
		for (int j = 0; j < all->constraints; j++)
			dot_entries(all->w, all->w->system->states, h->row, all->constraint[j].force_direction,
				    &h->delassus[j]);
		check_answer(h, &h->delassus[i]);
	}
}

static bool meets(const struct constraints *all, int i, int j)
{
	return !is_zero(&all->constraint[i].delassus[j]) || !is_zero(&all->constraint[j].delassus[i]);
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

void find_constraints(struct constraints *all)
{
	add_constraints(all);
	find_all_delassus(all);
	for (int i = 0; i < all->constraints; i++)
		for (int k = 0; k < all->w->system->states; k++)
			all->constraint[i].slope_direction[k] = all->constraint[i].force_direction[k];
	group_constraints(all);
}

/* ---- rates ---- */

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

int bare_rate(struct sequencing *w, const struct constraint *h)
{
	struct sum sum = { 0 };
	RATIONAL one = RATIO(1, 1);
	for (int i = 0; i < h->rate->terms; i++) {
		const struct form_term *term = &h->rate->term[i];
		struct form single = { 1, &h->rate->term[i], 0 };
		int state = rate_state(w, &term->basis);
		if (state == NONE)
			sum_add_form(w, &sum, &single, one);
		else
			sum_add(&sum, TERM_SEQUENCE, bare_slope(w, state), 0, term->factor);
	}
	return sequence_of_sum(w, &sum);
}

/* ---- where they move: one system for the group, in which what does not hold has a row of its own ---- */

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
	int *coord;                 /* per acceleration; a multiplier has none, and a number beyond the coordinates */
	bool *coupled;              /* per state: its slope is one of them */
	struct linear_equations *e;
};

static int state_of_coord(const struct sequencing *w, int coord)
{
	int velocity = coord < w->system->n ? w->system->velocity[coord] : NONE;
	return coord >= w->system->n ? NONE : velocity >= 0 ? velocity : coord;
}

static bool acts_on(const struct joined *g, const struct linear_system *mass)
{
	bool any = false;
	for (int i = 0; i < mass->n; i++) {
		int state = state_of_coord(g->all->w, mass->written->highest[i].index);
		for (int k = 0; k < g->members && state != NONE; k++) {
			const struct constraint *h = &g->all->constraint[g->member[k]];
			any = any || !is_zero(&h->row[state]) || !is_zero(&h->force_direction[state]);
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
static void answer_beside(const struct joined *g, int k, const struct constraint *of, struct entry *answer)
{
	struct sequencing *w = g->all->w;
	const struct constraint *h = &g->all->constraint[g->member[k]];
	struct entry *beside = entries(w->system->states);
	for (int i = 0; i < w->system->states; i++)
		if (!g->coupled[i] && of)
			beside[i] = of->force_direction[i];
		else if (!g->coupled[i] && !is_zero(&h->row[i]))
			beside[i].sequence = bare_slope(w, i);
	dot_entries(w, w->system->states, h->row, beside, answer);
}

/* The rate without what the system solves for, reversed */
static int right_where_held(const struct joined *g, int k)
{
	struct sequencing *w = g->all->w;
	const struct constraint *h = &g->all->constraint[g->member[k]];
	struct entry *beside = entries(1);
	struct sum sum = { 0 };
	RATIONAL minus = RATIO(-1, 1);
	answer_beside(g, k, NULL, beside);
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

static void add_member(struct joined *g, int k)
{
	const struct constraints *all = g->all;
	struct linear_equations *e = g->e;
	const struct constraint *h = &all->constraint[g->member[k]];
	const int row = g->accelerations + k, one = sequence_of_form(all->w, form_number(1));
	for (int i = 0; i < g->accelerations; i++) {
		int state = state_of_coord(all->w, g->coord[i]);
		if (state != NONE && !is_zero(&h->row[state]))
			e->matrix[row * e->n + i] = where_it_holds(all, g->member[k],
								   entry_sequence(all->w, &h->row[state]), all->none);
		e->matrix[i * e->n + row] = force_on(g, i, k);
	}
	for (int l = 0; l < g->members; l++) {
		struct entry *answer = entries(1);
		answer_beside(g, k, &all->constraint[g->member[l]], answer);
		if (l == k || !is_zero(answer))
			e->matrix[row * e->n + g->accelerations + l] = where_it_holds(
				all, g->member[k], entry_sequence(all->w, answer), l == k ? one : all->none);
	}
	e->right[row] = where_it_holds(all, g->member[k], right_where_held(g, k),
				       h->slips == NONE ? all->none : h->slips);
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
		struct entry *factor = entries(1);
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

void solve_group(const struct constraints *all, int members, int *member)
{
	struct sequencing *w = all->w;
	const struct model_contacts *contacts = &w->step->model->contacts;
	struct linear_equations *e = NEW(struct linear_equations);
	struct joined g = { .all = all, .members = members, .member = member, .e = e,
			   .coupled = ARRAY(bool, w->system->states) };
	e->n = members;
	for (int i = 0; i < contacts->masses; i++)
		e->n += acts_on(&g, contacts->mass[i]) ? contacts->mass[i]->n : 0;
	e->number = w->x->equations++;
	e->matrix = ARRAY(int, e->n * e->n);
	e->right = ARRAY(int, e->n);
	e->residual = ARRAY(int, e->n);
	for (int i = 0; i < e->n * e->n; i++)
		e->matrix[i] = NONE;
	for (int i = 0; i < contacts->masses; i++)
		if (acts_on(&g, contacts->mass[i]))
			add_mass(&g, contacts->mass[i]);
	for (int k = 0; k < members; k++)
		add_member(&g, k);
	e->first = w->x->count;
	for (int i = 0; i < e->n; i++)
		new_sequence(w, (struct sequence){ .kind = SEQUENCE_SOLUTION, .state = NONE, .a = NONE, .b = NONE,
						   .equations = e, .component = i });
	for (int k = 0; k < members; k++)
		all->constraint[member[k]].force = e->first + g.accelerations + k;
	find_highest(&g);
	for (int i = 0, row = 0; i < contacts->masses; i++)
		for (int j = 0; j < contacts->mass[i]->n && acts_on(&g, contacts->mass[i]); j++, row++)
			e->residual[row] = residual_of_motion(&g, contacts->mass[i]->written->residual[j], row);
	for (int k = 0; k < members; k++) {
		struct constraint *h = &all->constraint[member[k]];
		h->solved = true;
		e->residual[g.accelerations + k] = residual_of_member(&g, k);
		for (int i = 0; i < w->system->states; i++)     /* their slopes are solved for */
			if (g.coupled[i])
				h->slope_direction[i] = entries(1)[0];
	}
}
