/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Formulas that the state chooses: each comparison is of a switching function, smooth until the next event, with a
 * breakpoint. A series, or a step of a collocation, is of the formulas between two events; where a switching function
 * passes a breakpoint it ends. */
#include "inner.h"
#include "model/reads.h"
#include "model/regions/regions.h"
#include "step/contacts/series_contacts.h"

#include <limits.h>

/* ---- switching functions and breakpoints ---- */

static int known_function(const struct expansion *x, const struct form *form, mpq_ptr of)
{
	for (int i = 0; i < x->functions; i++)
		if (is_form_multiple(form, x->function[i].form, of))
			return i;
	return NONE;
}

static int find_series_switching(struct sequencing *w, const struct form *form, mpq_ptr of)
{
	struct expansion *x = w->x;
	int known = known_function(x, form, of);
	if (known != NONE)
		return known;
	*MORE(x->function, x->functions) = (struct series_switching){ .form = form, .sequence = NONE };
	mpq_set_ui(of, 1, 1);
	return x->functions - 1;
}

static int add_breakpoint(struct series_switching *d, mpq_srcptr at)
{
	mpq_t *all = rationals(d->breaks + 1);
	for (int i = 0; i < d->breaks; i++)
		mpq_set(all[i], d->at[i]);
	mpq_set(all[d->breaks], at);
	d->at = all;
	return d->breaks++;
}

void add_twin(struct series_switching *d, int breakpoint)
{
	add_breakpoint(d, d->at[breakpoint]);
}

static int known_breakpoint(const struct series_switching *d, mpq_srcptr at)
{
	for (int i = 0; i < d->breaks; i++)
		if (mpq_equal(d->at[i], at))
			return i;
	return NONE;
}

static int find_breakpoint(struct series_switching *d, mpq_srcptr at)
{
	int known = known_breakpoint(d, at);
	return known != NONE ? known : add_breakpoint(d, at);
}

static void value_of_constants(const struct form *plain, mpq_ptr value)
{
	RATIONAL part = ZERO, pi = ZERO;
	constant_pi(pi);
	mpq_set_ui(value, 0, 1);
	for (int i = 0; i < plain->terms; i++) {
		mpq_set(part, plain->term[i].factor);
		if (plain->term[i].basis.kind == BASIS_PI)
			mpq_mul(part, part, pi);
		mpq_add(value, value, part);
	}
}

/* What stands beside the constants of a form, and their value */
static const struct form *beside_constants(const struct form *form, mpq_ptr value)
{
	const struct form plain = constant_terms(form);
	value_of_constants(&plain, value);
	return form_sum(form, &plain, true);
}

/* e = (form - constant)/factor passes -constant/factor */
static void to_breakpoint(mpq_ptr value, mpq_srcptr factor)
{
	mpq_div(value, value, factor);
	mpq_neg(value, value);
}

/* a - b, or what stands beside a constant as it was written: b - a */
static const struct form *difference_of(const struct form *a, const struct form *b, bool *reversed)
{
	*reversed = is_constant(a) && !is_constant(b);
	return *reversed ? form_difference(b, a) : form_difference(a, b);
}

struct division divide_form(struct sequencing *w, const struct form *form, mpq_ptr factor)
{
	struct division division = { .function = NONE };
	RATIONAL value = ZERO;
	division.function = find_series_switching(w, beside_constants(form, value), factor);
	to_breakpoint(value, factor);
	division.breakpoint = find_breakpoint(&w->x->function[division.function], value);
	division.above = mpq_sgn(factor) > 0;
	return division;
}

/* Of constants */
static struct division decided(const struct form *d)
{
	RATIONAL value = ZERO;
	value_of_constants(d, value);
	return (struct division){ .function = NONE, .above = mpq_sgn(value) > 0 };
}

/* In the place of unknowns what they are solved as, for which all formulas are chosen */
static const struct form *solved_kink(const struct expansion *x, const struct form *d)
{
	RATIONAL factor = ZERO;
	for (int i = 0; i < x->kinks && !is_constant(d); i++)
		if (is_form_multiple(d, x->kink[i].of, factor))
			return form_scale(x->kink[i].solved, factor);
	return d;
}

struct division divide_forms(struct sequencing *w, const struct form *a, const struct form *b)
{
	bool reversed;
	RATIONAL factor = ZERO;
	const struct form *d = solved_kink(w->x, difference_of(a, b, &reversed));
	struct division division = is_constant(d) ? decided(d) : divide_form(w, d, factor);
	division.above = division.above != reversed;
	return division;
}

bool find_division(const struct expansion *x, const struct form *a, const struct form *b, struct division *division)
{
	bool reversed, known = true;
	RATIONAL value = ZERO, factor = ZERO;
	const struct form *d = solved_kink(x, difference_of(a, b, &reversed));
	*division = decided(d);
	if (!is_constant(d)) {
		division->function = known_function(x, beside_constants(d, value), factor);
		known = division->function != NONE;
	}
	if (known && !is_constant(d)) {
		to_breakpoint(value, factor);
		division->breakpoint = known_breakpoint(&x->function[division->function], value);
		division->above = mpq_sgn(factor) > 0;
		known = division->breakpoint != NONE;
	}
	division->above = division->above != reversed;
	return known;
}

/* ---- once all are there ---- */

int column_of_sequence(struct expansion *x, int sequence, int top)
{
	int i = 0, states = 0;
	while (states < x->count && x->sequence[states].state != NONE)
		states++;
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

int order_of_form(const struct sequencing *w, const struct form *form)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(w->step->model->equations.atoms));
	bool solved = false;
	for (const struct form_term **term = terms_within(form, seen); *term; term++)
		solved = solved || ((*term)->basis.atom && (*term)->basis.atom->kind == ATOM_SOLUTION);
	return w->x->order - solved;
}

void rank_breakpoints(struct sequencing *w)
{
	struct expansion *x = w->x;
	for (int i = 0; i < x->functions; i++) {
		struct series_switching *d = &x->function[i];
		d->rank = ARRAY(int, d->breaks);
		for (int k = 0; k < d->breaks; k++)
			for (int j = 0; j < d->breaks; j++)
				d->rank[k] += mpq_cmp(d->at[j], d->at[k]) < (j < k);
		d->column = column_of_sequence(x, d->sequence, order_of_form(w, d->form));
	}
	for (int i = 0; x->contacts && i < x->contacts->watches; i++) {
		struct watch *watch = &x->contacts->watch[i];
		watch->column = column_of_sequence(x, watch->sequence, watch->full ? x->order : 1);
	}
}

int breakpoint_rank(const struct expansion *x, int function, int breakpoint)
{
	return x->function[function].rank[breakpoint];
}

int upper_rank(const struct expansion *x, int function, int breakpoint)
{
	const struct series_switching *d = &x->function[function];
	int rank = d->rank[breakpoint];
	for (int k = 0; k < d->breaks; k++)
		if (mpq_equal(d->at[k], d->at[breakpoint]) && d->rank[k] > rank)
			rank = d->rank[k];
	return rank;
}

mpq_t *rising_breakpoints(const struct series_switching *d)
{
	mpq_t *rising = rationals(d->breaks);
	for (int k = 0; k < d->breaks; k++)
		mpq_set(rising[d->rank[k]], d->at[k]);
	return rising;
}

int most_changes(const struct expansion *x)
{
	int most = 1;
	for (int i = 0; i < x->functions; i++)
		most += x->function[i].breaks + 1;
	return most;
}

const char *series_switching_text(const struct step *step, int function)
{
	const struct step *shown = step->shown;
	bool same = shown->taylor.switching && shown->taylor.switching->functions == step->taylor.switching->functions;
	shown = same ? shown : step;
	return form_text(shown->model, shown->taylor.switching->function[function].form);
}

int regions_of_series(const struct expansion *x)
{
	int regions = 1;
	for (int i = 0; i < x->functions; i++) {
		if (regions > INT_MAX / (x->function[i].breaks + 1))
			return 0;
		regions *= x->function[i].breaks + 1;
	}
	return regions;
}

void check_series_switching(const struct step *step)
{
	const struct expansion *x = step->taylor.switching;
	const struct model *model = step->model;
	const struct smoothness *smooth = &model->remainder.smooth;
	if (!x)
		return;
	if (smooth->singular)
		error(smooth->singular->start, "etdrk4 and the schemes like it step across it, of lower order there",
		      "scheme %s: '%s' has no Taylor series where %s", scheme_name(model->scheme),
		      text_between(smooth->singular->start, smooth->singular->end), smooth->singular_where);
}

/* ---- what the search looks at besides ---- */

static bool has_way(const struct contacts *c, int watch)
{
	bool any = false;
	for (int i = 0; i < c->holds; i++)
		any = any || c->hold[i].pull[0] == watch || c->hold[i].pull[1] == watch;
	for (int i = 0; i < c->series_impacts; i++)
		any = any || (c->series_impact[i].hold != NONE && c->series_impact[i].speed == watch);
	return any;
}

static void renumber(const int *place, int *watch)
{
	if (*watch != NONE)
		*watch = place[*watch];
}

static void renumber_all(const int *place, int count, int *watch)
{
	for (int i = 0; i < count; i++)
		renumber(place, &watch[i]);
}

void sort_watches(struct contacts *c, int states)
{
	int *place = ARRAY(int, c->watches), places = 0;
	struct watch *sorted = ARRAY(struct watch, c->watches);
	for (int way = 1; way >= 0; way--) {
		for (int i = 0; i < c->watches; i++) {
			if (has_way(c, i) != way)
				continue;
			sorted[places] = c->watch[i];
			place[i] = places++;
		}
		c->ways = way ? places : c->ways;
	}
	c->watch = sorted;
	for (int i = 0; i < c->forces; i++) {
		renumber(place, &c->hold[i].velocity);
		renumber(place, &c->hold[i].pull[0]);
		renumber(place, &c->hold[i].pull[1]);
		renumber_all(place, states, c->hold[i].back_watch);
	}
	for (int i = 0; i < c->series_impacts; i++) {
		renumber(place, &c->series_impact[i].place);
		renumber(place, &c->series_impact[i].speed);
		renumber_all(place, states, c->series_impact[i].back_watch);
		renumber_all(place, c->columns, c->series_impact[i].slope);
	}
	for (int i = 0; i < c->assignments; i++)
		renumber(place, &c->assignment[i].watch);
	for (int i = 0; i < c->conflicts; i++)
		renumber(place, &c->conflict[i].watch);
}
