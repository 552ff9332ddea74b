/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who holds beside a series, how the force of each acts on the others, without them what
 * their rates are. Factors are numbers; those of mechanisms, whose mass matrix or whose directions depend on the state,
 * are sequences. */
#include "model/contacts/friction.h"
#include "step/series/expansion.h"
#include "inner.h"

/* ---- factors ---- */

struct entry *entries_new(int count)
{
	struct entry *all = ARRAY(struct entry, count);
	for (int i = 0; i < count; i++) {
		mpq_init(all[i].number);
		all[i].sequence = NONE;
	}
	return all;
}

bool is_zero_entry(const struct entry *e)
{
	return e->sequence == NONE && mpq_sgn(e->number) == 0;
}

bool is_number_entry(const struct entry *e)
{
	return e->sequence == NONE;
}

void set_entry(struct sequencing *w, const struct form *form, struct entry *entry)
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

void sum_add_product(struct sum *sum, int a, int b, mpq_srcptr factor)
{
	sum_add(sum, TERM_PRODUCT, a < b ? a : b, a < b ? b : a, factor);
}

void sum_add_entry(struct sum *sum, int sequence, const struct entry *entry, mpq_srcptr factor)
{
	RATIONAL part = ZERO;
	mpq_mul(part, factor, entry->number);
	if (entry->sequence != NONE)
		sum_add_product(sum, sequence, entry->sequence, factor);
	else if (mpq_sgn(part) != 0)
		sum_add(sum, TERM_SEQUENCE, sequence, 0, part);
}

/* entry += the products of `count` pairs */
void dot_entries(struct sequencing *w, int count, const struct entry *a, const struct entry *b,
			struct entry *entry)
{
	RATIONAL one = RATIO(1, 1);
	struct sum sum = { 0 };
	for (int i = 0; i < count; i++) {
		if (is_zero_entry(&a[i]) || is_zero_entry(&b[i]))
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

/* Of a force, or of what follows a param of it: where the force may become negative it counts as 0. */
int force_sequence(struct sequencing *w, const struct form *force, const struct form *of)
{
	int made = sequence_of_form(w, of);
	return never_falls_below(force) ? made : positive_sequence(w, force, made);
}

/* ---- who holds, and how each acts on the others ---- */

int rate_state(const struct sequencing *w, const struct basis *basis)
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
	struct entry *mass = entries_new(n), *direction = ARRAY(struct entry, n);
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
		set_entry(w, form_difference(zero, h->moving->force_direction[j]), &h->force_direction[state]);
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
	*h = (struct constraint){ .impact = NONE, .drag = NONE, .of = NONE, .slips = NONE, .moving = moving,
				  .force_direction = entries_new(states),
				  .slope_direction = ARRAY(struct entry, states), .row = entries_new(states),
				  .sample = ARRAY(double, states),
				  .gives = entries_new(all->w->system->force_columns) };
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

static void add_slope_of_contact(struct constraints *all, int of, int column)
{
	const struct impact_law *law = all->w->step->model->contacts.impact[all->constraint[of].impact].in;
	struct constraint *h = add_constraint(all, law->slope[column].moving);
	h->impact = all->constraint[of].impact;
	h->velocity = law->slope[column].speed;
	h->rate = law->slope[column].press;
	h->of = of;
	h->column = column;
}

/* In the order of columns, as they were found */
static void add_slopes_of_drag(struct constraints *all, int of)
{
	const struct model_contacts *contacts = &all->w->step->model->contacts;
	for (int i = 0, column = 0; i < contacts->drags; i++) {
		if (contacts->drag[i].of != all->constraint[of].drag)
			continue;
		add_drag(all, i);
		all->constraint[all->constraints - 1].of = of;
		all->constraint[all->constraints - 1].column = column++;
	}
}

static void add_constraints(struct constraints *all)
{
	const struct model *model = all->w->step->model;
	for (int i = 0; i < model->contacts.impacts; i++)
		if (model->contacts.impact[i].bounces)
			add_contact(all, i);
	for (int i = 0; i < model->contacts.drags; i++)
		if (model->contacts.drag[i].of < 0)
			add_drag(all, i);
	all->own = all->constraints;
	for (int i = 0; i < all->own && all->c->columns > 0; i++)
		if (all->constraint[i].drag != NONE)
			add_slopes_of_drag(all, i);
		else
			for (int k = 0; k < all->c->columns; k++)
				add_slope_of_contact(all, i, k);
	for (int i = 0; i < all->constraints; i++)
		if (all->constraint[i].moving)
			directions_that_move(all->w, &all->constraint[i]);
}

static void check_delassus(const struct constraint *h, const struct entry *delassus)
{
	if (!h->node || h->of != NONE || !is_number_entry(delassus))
		return;
	if (mpq_sgn(delassus->number) == 0)
		report_unheld(h->node->at);
	if (mpq_sgn(delassus->number) > 0)
		report_drives(h->node);
}

static void find_all_delassus(struct constraints *all)
{
	for (int i = 0; i < all->constraints; i++) {
		struct constraint *h = &all->constraint[i];
		h->delassus = entries_new(all->constraints);
		for (int j = 0; j < all->constraints; j++)
			dot_entries(all->w, all->w->system->states, h->row, all->constraint[j].force_direction,
				    &h->delassus[j]);
		check_delassus(h, &h->delassus[i]);
	}
}

static bool meets(const struct constraints *all, int i, int j)
{
	return !is_zero_entry(&all->constraint[i].delassus[j]) || !is_zero_entry(&all->constraint[j].delassus[i]);
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
int bare_slope(struct sequencing *w, int state)
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

int held_by(const struct constraints *all, int index)
{
	return all->constraint[index].of == NONE ? index : all->constraint[index].of;
}
