/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Impacts with their derivatives among the states: behind it v + f L, and v_k + f_k L + f L_k, f the accelerations by a
 * force of 1, L the impulse. */
#include "model/contacts/contacts.h"
#include "step/series/expansion.h"
#include "inner.h"

int watch(struct sequencing *w, int sequence, bool full)
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

/* The only state of a velocity that no load moves; else NONE */
int only_state(const struct sequencing *w, const struct constraint *h)
{
	int state = NONE;
	if (h->moving && h->moving->only >= 0)
		return w->system->velocity[h->moving->only];
	for (int i = 0; i < h->velocity->terms; i++) {
		const struct basis *basis = &h->velocity->term[i].basis;
		if (basis->kind <= BASIS_PI)
			continue;
		if (basis->kind != BASIS_COORD || state != NONE)
			return NONE;
		state = basis->order ? w->system->velocity[basis->index] : basis->index;
	}
	return state;
}

/* The impulse L: n f L = -(1 + e) s, or of a derivative n f L_k = -(1 + e) s_k - e_k s - n_k f L; e 0: `still` */
static int impulse_sequence(const struct constraints *all, int index, int of, bool still)
{
	struct sequencing *w = all->w;
	const struct constraint *h = &all->constraint[index], *own = &all->constraint[held_by(all, index)];
	const struct impact_law *law = w->step->model->contacts.impact[h->impact].in;
	RATIONAL minus = RATIO(-1, 1), factor = RATIO(-1, 1);
	struct sum sum = { 0 };
	if (!still)
		mpq_sub(factor, factor, law->restitution);
	sum_add(&sum, TERM_SEQUENCE, sequence_of_form(w, h->velocity), 0, factor);
	if (h->of != NONE && !still && mpq_sgn(law->slope[h->column].restitution) != 0) {
		mpq_neg(factor, law->slope[h->column].restitution);
		sum_add(&sum, TERM_SEQUENCE, sequence_of_form(w, own->velocity), 0, factor);
	}
	if (h->of != NONE)
		sum_add_entry(&sum, of, &h->delassus[h->of], minus);
	return quotient_by_entry(w, sum_sequence(w, &sum), &own->delassus[held_by(all, index)]);
}

static bool acts_on_state(const struct constraint *h, int state)
{
	const struct entry *direction = &h->force_direction[state];
	return !is_number_entry(direction) || mpq_sgn(direction->number) != 0;
}

void assign_with_slopes(struct constraints *all, int hold, bool still)
{
	struct sequencing *w = all->w;
	struct contacts *c = all->c;
	const int only = only_state(w, &all->constraint[hold]);
	int *impulse = ARRAY(int, all->constraints);
	for (int i = 0; i < all->constraints; i++)
		if (held_by(all, i) == hold)
			impulse[i] = impulse_sequence(all, i, impulse[hold], still);
	for (int state = 0; state < w->system->states; state++) {
		struct sum sum = { 0 };
		RATIONAL one = RATIO(1, 1);
		bool any = false;
		sum_add(&sum, TERM_SEQUENCE, state, 0, one);
		for (int i = 0; i < all->constraints; i++)
			if (held_by(all, i) == hold && acts_on_state(&all->constraint[i], state)) {
				sum_add_entry(&sum, impulse[i], &all->constraint[i].force_direction[state], one);
				any = true;
			}
		if (!any)
			continue;
		const int value = still && state == only ? all->none : sum_sequence(w, &sum);
		*MORE(c->assignment, c->assignments) = (struct series_jump){ state, watch(w, value, false) };
	}
}
