/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who holds beside a series, how the force of each acts on the others, and forces of those that hold together. Factors
 * are numbers; those of mechanisms, whose mass matrix or whose directions depend on the state, are sequences. */
#include "model/contacts/friction.h"
#include "model/contacts/contacts.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"
#include "inner.h"

#include <math.h>
#include <stdlib.h>

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

static bool is_number(const struct entry *e)
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
		if (is_number(&a[i]) && is_number(&b[i]))
			rational_addmul(entry->number, a[i].number, b[i].number);
		else if (is_number(&a[i]))
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
	return is_number(entry) ? sequence_of_form(w, form_constant(entry->number)) : entry->sequence;
}

int quotient_by_entry(struct sequencing *w, int a, const struct entry *below)
{
	RATIONAL part = ZERO;
	struct sum sum = { 0 };
	if (!is_number(below))
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
				  .force_direction = entries(states), .row = entries(states),
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
	if (!h->node || !is_number(answer))
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

/* Highest derivatives stand inside of atoms there: those of a mass matrix that moves are known by their solution. */
static int bare_rate_with_atoms(struct sequencing *w, const struct form *rate)
{
	for (int j = 0; j < w->system->n; j++) {
		int velocity = w->system->velocity[j], slope = bare_slope(w, velocity >= 0 ? velocity : j);
		if (w->highest[j] == NONE)
			w->highest[j] = slope;
	}
	return sequence_of_form(w, rate);
}

int bare_rate(struct sequencing *w, const struct constraint *h)
{
	struct sum sum = { 0 };
	RATIONAL one = RATIO(1, 1);
	if (h->moving)
		return bare_rate_with_atoms(w, h->rate);
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

/* ---- forces of those that hold together ---- */

int hold_choice(struct sequencing *w, const struct series_hold *hold, int held, int other)
{
	return new_sequence(w, (struct sequence){ .kind = SEQUENCE_CHOICE, .choice = CHOICE_BY_HOLD, .state = NONE,
						  .switching = hold->function, .breakpoint = hold->breakpoint,
						  .a = held, .b = other });
}

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
			mpq_set(a[i * count + j], t->all->constraint[which[i]].delassus[which[j]].number);
	int column;
	return rational_inverse(count, a, inverse, &column);
}

static double dot_samples(const struct constraints *all, int a, int b)
{
	double sum = 0;
	for (int i = 0; i < all->w->system->states; i++)
		sum += all->constraint[a].sample[i] * all->constraint[b].sample[i];
	return sum;
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

/* Of friction that a contact at rest leaves no velocity: it brakes what the contact stops, and so slips that way. */
static int side_beside(const struct constraints *all, int friction, int contact)
{
	const struct entry *answer = &all->constraint[friction].delassus[contact];
	bool along = is_number(answer) ? mpq_sgn(answer->number) < 0 : dot_samples(all, friction, contact) > 0;
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

/* What its velocity would gain without the forces of those that hold, reversed */
static struct sum needed_rate(const struct together *t, int constraint)
{
	const struct constraint *h = &t->all->constraint[constraint];
	struct sum sum = { 0 };
	RATIONAL minus = RATIO(-1, 1);
	sum_add(&sum, TERM_SEQUENCE, h->bare, 0, minus);
	for (int j = 0; j < t->members; j++) {
		const struct constraint *other = &t->all->constraint[t->member[j]];
		if (!t->holds[j] && other->slips != NONE)
			sum_add_entry(&sum, other->slips, &h->delassus[t->member[j]], minus);
	}
	return sum;
}

/* Of constraint `of`, where answers are numbers */
static int force_by_numbers(const struct together *t, int count, const int *which, const mpq_t *inverse)
{
	struct sum sum = { 0 };
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
	return sum_sequence(t->all->w, &sum);
}

static int residual_of_answers(struct sequencing *w, const struct linear_equations *e, int row)
{
	struct sum sum = { 0 };
	RATIONAL one = RATIO(1, 1), minus = RATIO(-1, 1);
	for (int j = 0; j < e->n; j++)
		if (e->matrix[row * e->n + j] != NONE)
			add_product(&sum, e->matrix[row * e->n + j], e->first + j, one);
	sum_add(&sum, TERM_SEQUENCE, e->right[row], 0, minus);
	return sum_sequence(w, &sum);
}

/* The first of the forces of all that hold, in the order of `which` */
static int solve_answers(const struct together *t, int count, const int *which)
{
	struct sequencing *w = t->all->w;
	struct linear_equations *e = NEW(struct linear_equations);
	*e = (struct linear_equations){ .n = count, .number = w->x->equations++,
					.matrix = ARRAY(int, count * count), .right = ARRAY(int, count),
					.residual = ARRAY(int, count) };
	for (int i = 0; i < count; i++) {
		struct sum rate = needed_rate(t, which[i]);
		e->right[i] = sum_sequence(w, &rate);
		for (int j = 0; j < count; j++) {
			const struct entry *answer = &t->all->constraint[which[i]].delassus[which[j]];
			e->matrix[i * count + j] = is_zero(answer) ? NONE : entry_sequence(w, answer);
		}
	}
	e->first = w->x->count;
	for (int j = 0; j < count; j++)
		new_sequence(w, (struct sequence){ .kind = SEQUENCE_SOLUTION, .state = NONE, .a = NONE, .b = NONE,
						   .equations = e, .component = j });
	for (int i = 0; i < count; i++)
		e->residual[i] = residual_of_answers(w, e, i);
	return e->first;
}

static int compare_members(const void *a, const void *b)
{
	return *(const int *)a - *(const int *)b;
}

/* The same where the answers move; forces of the same ones are made once. */
static int force_that_moves(const struct together *t, int count, int *which)
{
	struct constraints *all = t->all;
	unsigned long set = 0;
	int known = 0, place = 0;
	qsort(which, (size_t)count, sizeof *which, compare_members);
	for (int i = 0; i < count; i++) {
		set |= 1UL << which[i];
		place = which[i] == t->of ? i : place;
	}
	while (known < all->solved && all->forces[known].set != set)
		known++;
	if (known == all->solved) {
		struct sum rate = needed_rate(t, which[0]);
		int first = count > 1 ? solve_answers(t, count, which)
				      : quotient_by_entry(all->w, sequence_of_sum(all->w, &rate),
							  &all->constraint[which[0]].delassus[which[0]]);
		*MORE(all->forces, all->solved) = (struct answered){ set, first };
	}
	return all->forces[known].first + place;
}

/* Of member 0, where these hold and the others of the group slip */
static int force_together(const struct together *t)
{
	int count = 0, *which = ARRAY(int, t->members);
	bool moves = false;
	for (int i = 0; i < t->members; i++)
		if (t->holds[i])
			which[count++] = t->member[i];
	for (int i = 0; i < count * count; i++)
		moves = moves || !is_number(&t->all->constraint[which[i / count]].delassus[which[i % count]]);
	mpq_t *inverse = rationals((size_t)(count * count));
	if (moves ? are_dependent(t->all, count, which) : !invert(t, count, which, inverse)) {
		note_conflict(t->all, count, which);
		return t->all->none;
	}
	return moves ? force_that_moves(t, count, which) : force_by_numbers(t, count, which, inverse);
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

void make_force(struct constraints *all, int index)
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
