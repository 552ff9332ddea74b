/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The solution as a Taylor series: a sequence of coefficients for each state, which of them there are, and which are
 * read. */
#include "model/checks.h"
#include "model/contacts/contacts.h"
#include "model/reads.h"
#include "divided.h"
#include "expansion.h"
#include "step/contacts/series_contacts.h"
#include "unseen.h"

/* ---- the states ---- */

static void expand_state(struct sequencing *w, int state)
{
	RATIONALS *scale = integral_scale(w, true);
	struct sum sum = held_slope(w, state);  /* makes sequences: the array may move */
	struct sequence made = w->x->sequence[state];
	sum_numbers(w, &made, &sum, scale);
	if (w->system->segments > 1 && !is_bare(w, state))
		add_changing_loads(w, &made, state, scale);
	w->x->sequence[state] = made;
}

/* ---- which coefficients there are, and are read ---- */

static int degree_of_term(const struct sequencing *w, const struct sequence_term *t)
{
	const struct sequence *all = w->x->sequence;
	int order = w->x->order, degree = 0;
	if (t->kind == TERM_SEQUENCE)
		degree = all[t->a].degree;
	else if (t->kind == TERM_PRODUCT)
		degree = all[t->a].degree + all[t->b].degree;
	else if (t->slot >= 0)
		degree = order + 1;
	else
		for (int k = 0; k <= order; k++)
			degree = t->factor[k] != 0 ? k : degree;
	return degree > order ? order + 1 : degree;
}

static int degree_now(const struct sequencing *w, const struct sequence *s)
{
	int degree = 0, order = w->x->order;
	const struct sequence *all = w->x->sequence;
	bool constant = (s->a == NONE || all[s->a].degree == 0) && (s->b == NONE || all[s->b].degree == 0);
	switch (s->kind) {
	case SEQUENCE_SUM:
	case SEQUENCE_INTEGRAL:
		for (int i = 0; i < s->terms; i++) {
			int of_term = degree_of_term(w, &s->term[i]);
			degree = of_term > degree ? of_term : degree;
		}
		if (s->kind == SEQUENCE_INTEGRAL)
			degree = s->state == NONE && constant ? 0 : degree < order ? degree + 1 : order + 1;
		return degree;
	case SEQUENCE_RATE:
		return all[s->a].degree > order ? order + 1 : all[s->a].degree > 0 ? all[s->a].degree - 1 : 0;
	case SEQUENCE_CHOICE:
		return all[s->a].degree > all[s->b].degree ? all[s->a].degree : all[s->b].degree;
	default:
		return constant ? 0 : order + 1;
	}
}

/* From below: what is found to have more terms makes others have more. */
static void find_degrees(struct sequencing *w)
{
	bool changed = true;
	while (changed) {
		changed = false;
		for (int i = 0; i < w->x->count; i++) {
			int degree = degree_now(w, &w->x->sequence[i]);
			changed = changed || degree > w->x->sequence[i].degree;
			if (degree > w->x->sequence[i].degree)
				w->x->sequence[i].degree = degree;
		}
	}
}

static bool raise(struct expansion *x, int sequence, int top)
{
	struct sequence *s = sequence == NONE ? NULL : &x->sequence[sequence];
	if (!s || top <= s->top)
		return false;
	s->top = top > x->order ? x->order : top;
	return true;
}

/* What sequence i reads up to its top */
static bool raise_operands(struct expansion *x, int i)
{
	const struct sequence *s = &x->sequence[i];
	int top = s->top;
	bool changed = false;
	if (top < 0)
		return false;
	bool integral = s->kind == SEQUENCE_INTEGRAL;
	for (int k = 0; k < s->terms; k++) {
		const struct sequence_term *t = &s->term[k];
		if (t->kind == TERM_SEQUENCE || t->kind == TERM_PRODUCT)
			changed |= raise(x, t->a, top - integral);
		if (t->kind == TERM_PRODUCT)
			changed |= raise(x, t->b, top - integral);
	}
	int operand = integral ? 0 : s->kind == SEQUENCE_RATE ? top + 1 : top;
	changed |= raise(x, s->a, operand);
	changed |= raise(x, s->b, operand);
	if (s->kind == SEQUENCE_CHOICE && s->choice == CHOICE_BY_SEQUENCE)
		changed |= raise(x, s->test, 0);
	return changed;
}

static void find_tops(struct sequencing *w)
{
	struct expansion *x = w->x;
	bool changed = true;
	for (int i = 0; i < w->system->states; i++)
		x->sequence[i].top = x->order;
	for (int i = 0; i < x->columns; i++)
		raise(x, x->column[i], x->column_top[i]);
	while (changed) {
		changed = false;
		for (int i = 0; i < x->count; i++)
			changed |= raise_operands(x, i);
	}
}

/* What reads a rate comes with it one later. */
static void find_late(struct sequencing *w)
{
	struct expansion *x = w->x;
	for (bool changed = true; changed;) {
		changed = false;
		for (int i = 0; i < x->count; i++) {
			struct sequence *s = &x->sequence[i];
			bool late = s->kind == SEQUENCE_RATE;
			for (int k = 0; k < s->terms; k++) {
				const struct sequence_term *t = &s->term[k];
				if (t->kind == TERM_SEQUENCE || t->kind == TERM_PRODUCT)
					late = late || x->sequence[t->a].late;
				if (t->kind == TERM_PRODUCT)
					late = late || x->sequence[t->b].late;
			}
			late = late || (s->a != NONE && x->sequence[s->a].late);
			late = late || (s->b != NONE && x->sequence[s->b].late);
			if (s->kind == SEQUENCE_CHOICE && s->choice == CHOICE_BY_SEQUENCE)
				late = late || x->sequence[s->test].late;
			if (s->kind == SEQUENCE_INTEGRAL)
				late = false;
			changed = changed || late != s->late;
			s->late = late;
		}
	}
}

static void find_time(struct sequencing *w)
{
	for (int i = 0; i < w->x->count; i++)
		for (int k = 0; k < w->x->sequence[i].terms; k++) {
			const struct sequence_term *t = &w->x->sequence[i].term[k];
			w->x->time = w->x->time || (t->kind == TERM_TIME && t->a > 0);
		}
}

/* ---- the whole ---- */

/* Their arguments, and behind these columns what bounds a series but is no part of its error */
static void place_unseen(struct sequencing *w)
{
	struct expansion *x = w->x;
	x->measured = x->columns;
	for (int i = 0; i < x->unseens; i++) {
		int sequence = sequence_of_form(w, x->unseen[i].form);
		x->unseen[i].column = column_of_sequence(x, sequence, x->order);
	}
}

static struct layout place_all(struct sequencing *w)
{
	struct reads reads = { 0 };
	const struct model *model = w->step->model;
	reads = reads_of(model, model->channels, (const struct form *const *)model->operator[0].left);
	bool *needed = ARRAY(bool, w->system->loads);
	for (int l = 0; l < w->system->loads; l++)
		needed[l] = has_contacts(model) || reads.load[l] || load_acts(w->system, &w->system->load[l]);
	return layout_with(w->system, 1, needed);
}

static void start_states(struct sequencing *w)
{
	for (int i = 0; i < w->system->states; i++)
		new_sequence(w, (struct sequence){ .kind = SEQUENCE_INTEGRAL, .state = i, .a = NONE, .b = NONE });
}

static void make_forces(struct sequencing *w)
{
	const struct model *model = w->step->model;
	int *force = ARRAY(int, model->channels);
	for (int e = 0; e < model->channels; e++)
		force[e] = sequence_of_form(w, model->operator[0].left[e]);
	w->x->force = force;
}

/* How often each atom is read */
static void count_uses(struct sequencing *w, const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct atom *atom = form->term[i].basis.atom;
		if (!atom || w->uses[atom->index]++ > 0)
			continue;
		for (int k = 0; k < atom->operands; k++)
			count_uses(w, atom->operand[k]);
	}
}

static struct expansion *expand(const struct step *step, int order, bool with_forces)
{
	const struct linear *system = &step->branch->system;
	const struct model *model = step->model;
	int atoms = atoms_count(model->atoms);
	struct sequencing work = { .step = step, .system = system, .x = NEW(struct expansion) }, *w = &work;
	w->x->order = order;
	w->x->load = ARRAY(bool, system->loads);
	w->x->input = ARRAY(bool, system->inputs);
	w->x->slope = ARRAY(bool, system->inputs);
	w->uses = ARRAY(int, atoms);
	w->atom = ARRAY(int, atoms);
	for (int i = 0; i < atoms; i++)
		w->atom[i] = NONE;
	mpq_init(w->pi);
	constant_pi(w->pi);
	mpq_init(w->unit);
	unit_of_expansion(model, w->unit);
	w->layout = place_all(w);
	w->slopes = ARRAY(mpq_t *, system->segments);
	for (int k = 0; k < system->segments; k++)
		w->slopes[k] = augmented_matrix(&w->layout, system, k);
	for (int e = 0; e < model->channels; e++)
		count_uses(w, model->operator[0].left[e]);
	start_states(w);
	hold_contacts(w);
	if (with_forces)
		make_forces(w);
	for (int i = 0; i < system->states; i++)
		expand_state(w, i);
	rank_breakpoints(w->x);
	w->x->unseen = unseen_of(model, &w->x->unseens, &w->x->looks);
	w->x->crowded = model->truncation.adaptive ? crowded_frequency(system) : 0;
	place_unseen(w);
	find_degrees(w);
	find_tops(w);
	find_late(w);
	find_time(w);
	find_newest(w->x);
	return w->x;
}

struct expansion *expansion_of(const struct step *step, int order)
{
	return expand(step, order, false);
}

struct expansion *expansion_with_forces(const struct step *step, int order)
{
	return expand(step, order, true);
}

/* ---- some of its sequences alone ---- */

/* What a term reads up to the k-th */
static void mark_term(const struct step *step, struct expansion *x, const struct sequence_term *t, int k)
{
	int first;
	bool enters = !t->factor;
	for (int i = 0; t->factor && i <= k; i++)
		enters = enters || t->factor[i] != 0;
	if (!enters)
		return;
	if (t->kind == TERM_LOAD)
		x->load[load_of_column(&step->branch->system, t->a, &first)] = true;
	if (t->kind == TERM_INPUT)
		x->input[t->a] = true;
	if (t->kind == TERM_SLOPE)
		x->slope[t->a] = true;
	x->time = x->time || (t->kind == TERM_TIME && t->a > 0);
	x->params = x->params || t->kind == TERM_PARAM;
	x->slots = !t->factor ? 1 : x->slots;
}

static void mark_terms(const struct step *step, struct expansion *x)
{
	for (int i = 0; i < x->count; i++) {
		const struct sequence *s = &x->sequence[i];
		int top = s->kind == SEQUENCE_INTEGRAL ? s->top - 1 : s->top;
		for (int k = 0; k < s->terms && top >= 0; k++)
			mark_term(step, x, &s->term[k], top);
	}
}

struct expansion *part_of_expansion(const struct step *step, const struct expansion *whole, int order, int columns,
				    int *column)
{
	const struct linear *system = &step->branch->system;
	struct expansion *x = NEW(struct expansion);
	*x = (struct expansion){ .order = order, .count = whole->count, .expressions = whole->expressions,
				 .expression = whole->expression, .columns = columns, .column = column, .alone = true };
	x->sequence = ARRAY(struct sequence, x->count);
	x->column_top = ARRAY(int, x->columns);
	x->load = ARRAY(bool, system->loads);
	x->input = ARRAY(bool, system->inputs);
	x->slope = ARRAY(bool, system->inputs);
	for (int i = 0; i < x->count; i++) {
		x->sequence[i] = whole->sequence[i];
		x->sequence[i].top = -1;
	}
	for (int c = 0; c < x->columns; c++) {
		x->column_top[c] = order;
		raise(x, x->column[c], order);
	}
	for (bool changed = true; changed;) {
		changed = false;
		for (int i = 0; i < x->count; i++)
			changed |= raise_operands(x, i);
	}
	mark_terms(step, x);
	x->slots = x->slots ? whole->slots : 0;
	return x;
}
