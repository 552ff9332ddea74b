/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The remainder, sorted: forces that are linear in coordinates and velocities with factors of time alone, forcing
 * terms, other forces of time alone, and the rest. All but the last are matrices and vectors, one for each function of
 * time.
 */
#include "model/building.h"
#include "model/contacts/contacts.h"
#include "model/reads.h"

struct split_work {
	struct building *b;
	struct splitting *split;
	int coord;                  /* in whose equation the term stands */
	const struct basis *basis;  /* of time alone; */
	/* the same as a sum of forcing terms; NULL: it is none, or not at all times the same */
	const struct form *plain;
};

static mpq_t *zeros_if_none(mpq_t **matrix, size_t cells)
{
	if (!*matrix)
		*matrix = rationals(cells);
	return *matrix;
}

/* Its number among the functions; of one that is a term alone without its factor, which *factor is times then */
static int number_of_function(struct splitting *s, const struct form *form, mpq_ptr factor)
{
	if (form->terms == 1) {
		mpq_mul(factor, factor, form->term[0].factor);
		form = form_unit(form->term[0].basis);
	}
	for (int i = 0; i < s->functions; i++)
		if (same_form(s->function[i].form, form))
			return i;
	*MORE(s->function, s->functions) = (struct time_function){ .form = form };
	return s->functions - 1;
}

static void add_state(struct split_work *w, const struct form *function, const struct basis *state, mpq_srcptr by)
{
	const struct linear *system = &w->b->model->system;
	size_t cells = (size_t)system->n * (size_t)system->n;
	RATIONAL factor = ZERO;
	mpq_set(factor, by);
	int k = number_of_function(w->split, function, factor);         /* the array may move */
	struct time_function *f = &w->split->function[k];
	mpq_t *matrix = zeros_if_none(state->order ? &f->velocity : &f->position, cells);
	mpq_ptr entry = matrix[w->coord * system->n + state->index];
	mpq_add(entry, entry, factor);
}

static bool is_of_states(const struct form *form)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind != BASIS_COORD)
			return false;
	return true;
}

/* The one factor of a product that is linear in the states, all others being of time alone; -1: there is none such */
static int linear_factor(const struct atom *a)
{
	int found = -1;
	if (a->kind != ATOM_PRODUCT)
		return -1;
	for (int k = 0; k < a->operands; k++) {
		if (is_of_time(a->operand[k]))
			continue;
		if (found >= 0 || a->exponent[k] != 1 || !is_of_states(a->operand[k]))
			return -1;
		found = k;
	}
	return found;
}

static void add_product(struct split_work *w, const struct atom *a, int k, mpq_srcptr by)
{
	const struct form *others = kept_others(&w->b->collector, a->node, a, k), *states = a->operand[k];
	RATIONAL factor = ZERO;
	for (int i = 0; i < states->terms; i++) {
		mpq_mul(factor, by, states->term[i].factor);
		add_state(w, others, &states->term[i].basis, factor);
	}
}

/* e^{a t} cos(w t + p), or its sin: a force to which the response of a mode, and of a constraint, is known. */
static bool is_forcing(const struct split_work *w, const struct basis *basis)
{
	return basis->kind == BASIS_FORCING && basis->power == 0 && !w->b->request->loads_left &&
	       !has_contacts(w->b->model) &&
	       (mpq_sgn(basis->forcing->w) != 0 || mpq_sgn(basis->forcing->a) != 0);
}

static void add_forcing(struct split_work *w, const struct basis *basis, mpq_srcptr by)
{
	struct splitting *s = w->split;
	int k = 0, n = w->b->model->n;
	while (k < s->forcings && s->forcing[k].forcing != basis->forcing)
		k++;
	if (k == s->forcings) {
		*MORE(s->forcing, s->forcings) = (struct forcing_force){
			basis->forcing, { rationals(n), rationals(n) }
		};
	}
	mpq_ptr entry = s->forcing[k].force[basis->sine][w->coord];
	mpq_add(entry, entry, by);
}

/* Products of forcing terms are forcing terms: exp(-t)*sin(5*t) */
static void find_plain(void *context)
{
	struct split_work *w = context;
	struct collector *c = &w->b->collector;
	struct point *point = point_new(c, 0, NULL);
	const struct form *first = NULL;
	bool plain = true;
	for (c->interval = 0; c->interval < w->b->model->system.segments; c->interval++) {
		const struct form *here = form_at(point, form_unit(*w->basis));
		first = first ? first : here;
		plain = plain && same_form(first, here);
	}
	for (int i = 0; i < first->terms; i++)
		plain = plain && is_forcing(w, &first->term[i].basis);
	w->plain = plain ? first : NULL;
}

static const struct form *plain_form(struct split_work *w, const struct basis *basis)
{
	w->basis = basis;
	w->plain = NULL;
	if (!basis->atom)
		return is_forcing(w, basis) ? form_unit(*basis) : NULL;
	if (!silent_guard(find_plain, w))
		w->plain = NULL;
	w->b->collector.interval = 0;
	return w->plain;
}

static void add_forcings(struct split_work *w, const struct form *plain, mpq_srcptr by)
{
	RATIONAL factor = ZERO;
	place_loads(w->b, plain);
	for (int i = 0; i < plain->terms; i++) {
		mpq_mul(factor, by, plain->term[i].factor);
		add_forcing(w, &plain->term[i].basis, factor);
	}
}

static void add_force(struct split_work *w, const struct basis *basis, mpq_srcptr by)
{
	RATIONAL factor = ZERO;
	mpq_set(factor, by);
	int k = number_of_function(w->split, form_unit(*basis), factor);
	mpq_t *force = zeros_if_none(&w->split->function[k].force, (size_t)w->b->model->n);
	mpq_add(force[w->coord], force[w->coord], factor);
}

/* By a product's factor of time alone: they are one (atom.c), or none */
static int time_factor(const struct atom *a)
{
	for (int k = 0; a->kind == ATOM_PRODUCT && k < a->operands; k++)
		if (is_of_time(a->operand[k]) && a->exponent[k] == 1)
			return k;
	return -1;
}

static void add_rest(struct split_work *w, const struct basis *basis, mpq_srcptr by)
{
	struct splitting *s = w->split;
	const struct atom *a = basis->atom;
	const struct form *states = form_unit(*basis), *function = s->function[0].form;
	int k = a ? time_factor(a) : -1, r = 0;
	RATIONAL factor = ZERO;
	mpq_set(factor, by);
	if (k >= 0) {
		states = kept_others(&w->b->collector, a->node, a, k);
		function = a->operand[k];
	}
	for (int i = 0; i < states->terms; i++)
		if (states->term[i].basis.atom && states->term[i].basis.atom->time)
			s->mixed = a->node;
	k = number_of_function(s, function, factor);
	while (r < s->rests && (s->rest[r].coord != w->coord || s->rest[r].function != k))
		r++;
	if (r == s->rests)
		*MORE(s->rest, s->rests) = (struct rest_force){ w->coord, k, NEW(struct form) };
	form_add_to(s->rest[r].form, states, factor);
}

static void add_term(struct split_work *w, const struct form_term *term)
{
	const struct basis *basis = &term->basis;
	const struct form *one = w->split->function[0].form;
	int k = basis->atom ? linear_factor(basis->atom) : -1;
	const struct form *plain;
	if (basis->kind == BASIS_COORD)
		add_state(w, one, basis, term->factor);
	else if (k >= 0)
		add_product(w, basis->atom, k, term->factor);
	else if (depends_on_time_only(basis) && (plain = plain_form(w, basis)))
		add_forcings(w, plain, term->factor);
	else if (depends_on_time_only(basis))
		add_force(w, basis, term->factor);
	else
		add_rest(w, basis, term->factor);
}

/* ---- when functions of time change their formula, and what they are in the end ---- */

static bool has_formulas(const struct atom *a)
{
	return a->kind == ATOM_COMPARE || (a->kind == ATOM_CALL && a->function >= FN_ABS);
}

static const struct atom *first_unknown(const struct form *form)
{
	const struct atom *found = NULL;
	for (int i = 0; i < form->terms && !found; i++) {
		const struct atom *a = form->term[i].basis.atom;
		if (!a)
			continue;
		bool known = true;
		for (int k = 0; k < a->operands; k++) {
			known = known && is_linear_in_time(a->operand[k]);
			found = found ? found : first_unknown(a->operand[k]);
		}
		found = found ? found : has_formulas(a) && !known ? a : NULL;
	}
	return found;
}

static void find_last_values(void *context)
{
	struct split_work *w = context;
	struct collector *c = &w->b->collector;
	struct splitting *s = w->split;
	struct point *point = point_new(c, 0, NULL);
	s->ends_steady = loads_change(&w->b->model->system);
	for (int i = 0; i < s->functions; i++) {
		const struct form *here = form_at(point, s->function[i].form);
		mpq_init(s->function[i].last);
		if (is_constant(here))
			constant_value(c, here, s->function[i].last);
		else
			s->ends_steady = false;
	}
	s->ends_steady = s->ends_steady && s->rests == 0 && !has_contacts(w->b->model);
}

static void find_course(struct split_work *w)
{
	struct collector *c = &w->b->collector;
	struct splitting *s = w->split;
	for (int i = 0; i < s->functions && !s->unknown; i++)
		s->unknown = first_unknown(s->function[i].form);
	c->interval = w->b->model->system.segments - 1;
	if (!silent_guard(find_last_values, w))
		s->ends_steady = false;
	c->interval = 0;
}

void split_remainder(struct building *b)
{
	struct model *model = b->model;
	struct splitting *s = NEW(struct splitting);
	struct split_work w = { .b = b, .split = s };
	RATIONAL one = RATIO(1, 1);
	number_of_function(s, form_unit((struct basis){ .kind = BASIS_ONE }), one);
	for (int c = 0; c < model->remainder.force_columns; c++) {
		const struct form *left = model->schedule.operator[0].left[c];
		w.coord = coordinate_of_row(model, model->remainder.row[c]);
		for (int i = 0; i < left->terms; i++)
			add_term(&w, &left->term[i]);
	}
	s->selector = -1;
	if (model->schedule.selector && is_of_time(model->schedule.selector)) {
		ENLARGE(s->function, (size_t)s->functions + 1);
		s->selector = s->functions;
		s->function[s->functions++] = (struct time_function){ .form = model->schedule.selector };
		for (int i = 1; i < s->selector; i++)
			if (same_form(s->function[i].form, model->schedule.selector)) {
				s->selector = i;
				s->functions--;
			}
	}
	find_course(&w);
	model->remainder.split = s;
}
