/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Formulas that the state chooses: each comparison is of an expression, smooth until the next event, with a breakpoint.
 * The series is that of the formulas between two events; where an expression passes a breakpoint it ends. */
#include "step/step.h"

#include <limits.h>

/* ---- expressions and breakpoints ---- */

static int find_divided(struct sequencing *w, const struct form *form, mpq_ptr of)
{
	struct expansion *x = w->x;
	for (int i = 0; i < x->expressions; i++)
		if (is_form_multiple(form, x->expression[i].form, of))
			return i;
	ENLARGE(x->expression, (size_t)x->expressions + 1);
	x->expression[x->expressions] = (struct divided){ .form = form, .sequence = NONE };
	mpq_set_ui(of, 1, 1);
	return x->expressions++;
}

void add_twin(struct divided *d, int breakpoint)
{
	mpq_t *all = rationals((size_t)d->breaks + 1);
	for (int i = 0; i < d->breaks; i++)
		mpq_set(all[i], d->at[i]);
	mpq_set(all[d->breaks++], d->at[breakpoint]);
	d->at = all;
}

static int find_breakpoint(struct divided *d, mpq_srcptr at)
{
	for (int i = 0; i < d->breaks; i++)
		if (mpq_equal(d->at[i], at))
			return i;
	mpq_t *all = rationals((size_t)d->breaks + 1);
	for (int i = 0; i < d->breaks; i++)
		mpq_set(all[i], d->at[i]);
	mpq_set(all[d->breaks], at);
	d->at = all;
	return d->breaks++;
}

/* The first terms: 1 and pi */
static int constant_terms(const struct form *form)
{
	int count = 0;
	while (count < form->terms && form->term[count].basis.kind <= BASIS_PI)
		count++;
	return count;
}

static void value_of_constants(const struct sequencing *w, const struct form *form, int count, mpq_ptr value)
{
	mpq_t part;
	mpq_init(part);
	mpq_set_ui(value, 0, 1);
	for (int i = 0; i < count; i++) {
		mpq_set(part, form->term[i].factor);
		if (form->term[i].basis.kind == BASIS_PI)
			mpq_mul(part, part, w->pi);
		mpq_add(value, value, part);
	}
	mpq_clear(part);
}

struct division divide_forms(struct sequencing *w, const struct atom *atom, const struct form *a, const struct form *b)
{
	bool turned = is_constant(a) && !is_constant(b);        /* what stands beside a constant is as it was written */
	const struct form *d = turned ? form_difference(b, a) : form_difference(a, b);
	int constants = constant_terms(d);
	struct form plain = { constants, d->term, 0 };
	struct division division = { .expression = NONE };
	mpq_t value, factor;
	if (scheme_row(w->step->model->scheme)->collocates)
		error(atom->node->start,
		      "scheme taylor goes from one such place to the next; etdrk4 and the schemes like it step "
		      "across, of lower order there",
		      "scheme %s needs what is smooth between the changes of the loads: '%s' changes its formula where "
		      "the state decides",
		      scheme_name(w->step->model->scheme), text_between(atom->node->start, atom->node->end));
	mpq_inits(value, factor, NULL);
	value_of_constants(w, d, constants, value);
	division.above = (mpq_sgn(value) > 0) != turned;
	if (constants < d->terms) {
		division.expression = find_divided(w, form_sum(d, &plain, true), factor);
		mpq_div(value, value, factor);
		mpq_neg(value, value);          /* e = (d - constant)/factor against -constant/factor */
		division.breakpoint = find_breakpoint(&w->x->expression[division.expression], value);
		division.above = (mpq_sgn(factor) > 0) != turned;
	}
	mpq_clears(value, factor, NULL);
	return division;
}

struct division divide_form(struct sequencing *w, const struct form *form, mpq_ptr factor)
{
	int constants = constant_terms(form);
	struct form plain = { constants, form->term, 0 };
	struct division division = { .expression = NONE };
	mpq_t value;
	mpq_init(value);
	value_of_constants(w, form, constants, value);
	division.expression = find_divided(w, form_sum(form, &plain, true), factor);
	mpq_div(value, value, factor);
	mpq_neg(value, value);
	division.breakpoint = find_breakpoint(&w->x->expression[division.expression], value);
	division.above = mpq_sgn(factor) > 0;
	mpq_clear(value);
	return division;
}

/* ---- once all are there ---- */

static int find_column(struct expansion *x, int states, int sequence, int top)
{
	int i = 0;
	if (sequence < states)
		return sequence;
	while (i < x->columns && x->column[i] != sequence)
		i++;
	if (i == x->columns) {
		ENLARGE(x->column, (size_t)x->columns + 1);
		ENLARGE(x->column_top, (size_t)x->columns + 1);
		x->column_top[x->columns] = 0;
		x->column[x->columns++] = sequence;
	}
	x->column_top[i] = top > x->column_top[i] ? top : x->column_top[i];
	return states + i;
}

void rank_breakpoints(struct expansion *x)
{
	int states = 0;
	while (states < x->count && x->sequence[states].state != NONE)
		states++;
	for (int i = 0; i < x->expressions; i++) {
		struct divided *d = &x->expression[i];
		d->rank = ARRAY(int, (size_t)d->breaks);
		for (int k = 0; k < d->breaks; k++)
			for (int j = 0; j < d->breaks; j++)
				d->rank[k] += mpq_cmp(d->at[j], d->at[k]) < (j < k);
		d->column = find_column(x, states, d->sequence, x->order);
	}
	for (int i = 0; x->contacts && i < x->contacts->watches; i++) {
		struct watch *watch = &x->contacts->watch[i];
		watch->column = find_column(x, states, watch->sequence, watch->whole ? x->order : 1);
	}
}

int breakpoint_rank(const struct expansion *x, const struct sequence *choice)
{
	return x->expression[choice->expression].rank[choice->breakpoint];
}

mpq_t *rising_breakpoints(const struct divided *d)
{
	mpq_t *rising = rationals((size_t)d->breaks);
	for (int k = 0; k < d->breaks; k++)
		mpq_set(rising[d->rank[k]], d->at[k]);
	return rising;
}

const struct expansion *divided_series(const struct step *step)
{
	return step->cut ? step->cut->look : step->expansion;
}

const char *divided_text(const struct step *step, int expression)
{
	const struct expansion *x = divided_series(step), *shown = divided_series(step->shown);
	bool same = shown && shown->expressions == x->expressions;
	return form_text(same ? step->shown->model : step->model, (same ? shown : x)->expression[expression].form);
}

int regions_of_series(const struct expansion *x)
{
	int regions = 1;
	for (int i = 0; i < x->expressions; i++) {
		if (regions > INT_MAX / (x->expression[i].breaks + 1))
			return 0;
		regions *= x->expression[i].breaks + 1;
	}
	return regions;
}

void check_divided(const struct step *step)
{
	const struct expansion *x = step->expansion;
	const struct model *model = step->model;
	const struct smoothness *smooth = &model->smooth;
	if (!x || x->expressions == 0)
		return;
	if (model->truncation.over > 1)
		error(model->asked.scheme_over->start, "over 1",
		      "one expansion is over several steps: it ends where %s passes a breakpoint",
		      form_text(model, x->expression[0].form));
	if (smooth->singular)
		error(smooth->singular->start, "etdrk4 and the schemes like it step across it, of lower order there",
		      "scheme %s: '%s' has no Taylor series where %s", scheme_name(model->scheme),
		      text_between(smooth->singular->start, smooth->singular->end), smooth->singular_where);
}
