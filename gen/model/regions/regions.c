/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Piecewise-linear equations: deadzone, clip, table, abs, sgn, min, max and conditions, of switching functions that are
 * linear in states, known loads and inputs. Each comparison is of one switching function with one breakpoint; the
 * breakpoints of a switching function divide it into intervals; a region is one interval for each switching function,
 * and in it every equation is linear. Expressions are found by looking at one region after the other, as breakpoints in
 * time are. */
#include "inner.h"
#include "model/building.h"
#include "model/checks.h"
#include "model/contacts/friction.h"

enum { MOST_SLOTS = 65536 };

/* ---- is it? ---- */

/* In every segment of time; where there are several, somewhere with a breakpoint: factors of what is linear may not
 * change alone. */
bool is_piecewise_linear(const struct building *b)
{
	int segments = b->model->system.segments;
	if (b->crowded)
		return false;
	bool switches = segments == 1 || b->model->contacts.impacts > 0 || b->request->again.by_regions;
	for (int s = 0; s < segments; s++)
		for (int i = 0; i < b->model->n; i++) {
			const struct form *form = b->segment_equations[s].residual[i].form;
			if (!is_piecewise_form(form))
				return false;
			switches = switches || (form->terms > 0 && form->term[form->terms - 1].basis.atom);
		}
	return switches && !curved_guard(b);
}

/* ---- a form in one region ---- */

struct looking {
	struct building *b;
	struct switching *s;
	const int *interval;        /* per switching function */
	struct form **known;        /* per atom */
	int count;
	bool grown;                 /* a switching function or a breakpoint was met for the first time: look again */
	int region, row;            /* where it looks */
	int segment;                /* of time */
	int lowest; /* of the regions, where there is one switching function, that a new breakpoint divides */
	/* Which switching function decides on the atom at hand, and per known atom; -1: none */
	int by, *decided;
	int inside;                 /* so many atoms it is in */
	const struct node *mixed;   /* what two of them decide on together; NULL: nothing */
};

static void note_decision(struct looking *l, const struct node *node, int function)
{
	if (function >= 0 && l->by >= 0 && l->by != function && !l->mixed)
		l->mixed = node;
	l->by = function >= 0 ? function : l->by;
}

static void add_break(struct looking *l, struct switching_function *e, mpq_srcptr at)
{
	mpq_t *breaks = rationals(e->breaks + 1);
	int below = 0;
	while (below < e->breaks && mpq_cmp(e->at[below], at) < 0)
		below++;
	for (int i = 0; i < e->breaks; i++)
		mpq_set(breaks[i < below ? i : i + 1], e->at[i]);
	mpq_set(breaks[below], at);
	e->at = breaks;
	e->breaks++;
	l->grown = true;
	l->lowest = below < l->lowest ? below : l->lowest;
}

/* Is e above `at` here? What is not known yet is noted. Where the breakpoint stands twice, what sticks or rests between
 * counts as below it. */
static bool is_above(struct looking *l, int index, mpq_srcptr at)
{
	struct switching_function *e = &l->s->function[index];
	for (int i = e->breaks - 1; i >= 0; i--)
		if (mpq_equal(e->at[i], at))
			return !l->grown && l->interval[index] > i;
	add_break(l, e, at);
	return false;
}

/* What is decided by the sign of a number that params may change, or by its being at least 0; equal ones are one. */
static void note_sign(const struct building *b, struct switching *s, mpq_srcptr number, bool least)
{
	if (!b->factor)
		return;
	for (int i = 0; i < s->signs; i++)
		if (mpq_equal(s->sign[i].number, number) && s->sign[i].least == least)
			return;
	struct sign *sign = MORE(s->sign, s->signs);
	sign->least = least;
	mpq_init(sign->number);
	mpq_set(sign->number, number);
}

/* In the order in which the equations show switching functions */
static int order_met(const struct looking *l)
{
	return l->row + (l->region > 0 ? l->b->model->n : 0);
}

static void refuse_force(const struct node *node, const struct form *form)
{
	if (form->terms && form->term[form->terms - 1].basis.kind == BASIS_ATOM)
		error(node->at, "a state, a load or an input can decide",
		      "the force of friction cannot decide a function or a condition");
}

/* A form, and the constant in it apart */
static struct compared compared_here(struct looking *l, const struct node *node, const struct form *form,
				     mpq_ptr constant)
{
	const struct form plain = constant_terms(form);
	constant_value(&l->b->collector, &plain, constant);
	return (struct compared){ node, form_sum(form, &plain, true), constant, order_met(l) };
}

/* The switching function of which a form is factor (switching function - at); -1: it is a constant, then in `at` */
static int function_here(struct looking *l, const struct node *node, const struct form *form, mpq_ptr factor,
			   mpq_ptr at)
{
	RATIONAL constant = ZERO;
	struct compared what = compared_here(l, node, form, constant);
	if (what.form->terms == 0) {
		mpq_set(at, constant);
		note_sign(l->b, l->s, at, false);
		return -1;
	}
	int e = find_switching_function(l->s, l->segment, &what, factor, at);
	note_sign(l->b, l->s, factor, false);
	note_decision(l, node, e);
	return e;
}

/* The sign of a - b, linear forms: of a constant its own, else by the interval of the switching function that it is a
 * multiple of. What is compared with a constant is written as it is, on whichever side it stands. */
static int sign_here(struct looking *l, const struct node *node, const struct form *a, const struct form *b)
{
	bool reversed = is_constant(a) && !is_constant(b);
	struct form *form = reversed ? form_difference(b, a) : form_difference(a, b);
	RATIONAL factor = ZERO, at = ZERO;
	refuse_force(node, form);
	int e = function_here(l, node, form, factor, at), sign = mpq_sgn(at);
	if (e >= 0)
		sign = is_above(l, e, at) == (mpq_sgn(factor) > 0) ? 1 : -1;
	form_free(form);
	return reversed ? -sign : sign;
}

static struct form *form_here(struct looking *l, const struct form *form);

static struct form *table_here(struct looking *l, const struct atom *a, struct form *const *x)
{
	int piece = 1;
	RATIONAL slope = ZERO, width = ZERO;
	for (int k = 3; k + 2 < a->operands; k += 2)
		if (sign_here(l, a->node, x[0], x[k]) > 0)
			piece = k;
	struct collector *c = &l->b->collector;
	constant_value(c, form_difference(x[piece + 3], x[piece + 1]), slope);
	constant_value(c, form_difference(x[piece + 2], x[piece]), width);
	mpq_div(slope, slope, width);
	return form_sum(x[piece + 1], form_scale(form_difference(x[0], x[piece]), slope), false);
}

static struct form *extreme_here(struct looking *l, const struct atom *a, struct form *const *x)
{
	struct form *best = x[0];
	for (int i = 1; i < a->operands; i++)
		if ((sign_here(l, a->node, best, x[i]) > 0) == (a->function == FN_MIN))
			best = x[i];
	return best;
}

/* ---- friction: a breakpoint that stands twice, with the interval of sticking between ---- */

static void add_stick(struct looking *l, struct switching_function *e, mpq_srcptr at)
{
	int known = 0;
	for (int i = 0; i < e->breaks; i++)
		known += mpq_equal(e->at[i], at) != 0;
	for (; known < 2; known++)
		add_break(l, e, at);
}

/* From the start of this segment of time on; t = 0 of the first */
static mpq_srcptr segment_start(const struct looking *l, mpq_srcptr zero)
{
	return l->segment > 0 ? l->b->model->system.change[l->segment - 1] : zero;
}

static mpq_srcptr segment_end(const struct looking *l)
{
	const struct linear *system = &l->b->model->system;
	return l->segment < system->segments - 1 ? system->change[l->segment] : NULL;
}

/* As far as its size tells, which params may change; *least: by what it was decided; *bounded: that is known */
static bool is_positive_by_size(const struct form *form, mpq_ptr least, bool *bounded)
{
	RATIONAL size = ZERO;
	*bounded = true;
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		mpq_abs(size, form->term[i].factor);
		if (basis->kind == BASIS_ONE)
			mpq_add(least, least, form->term[i].factor);
		else
			mpq_sub(least, least, size);
		*bounded = *bounded && (basis->kind == BASIS_ONE || (basis->kind == BASIS_FORCING && !basis->power &&
								     mpq_sgn(basis->forcing->a) <= 0));
	}
	return *bounded && mpq_sgn(least) >= 0;
}

/* Never below 0 in this segment of time: it needs no breakpoint there */
static bool is_positive_here(struct looking *l, const struct form *form)
{
	bool bounded;
	RATIONAL least = ZERO, zero = ZERO;
	bool positive = is_positive_by_size(form, least, &bounded);
	if (bounded)
		note_sign(l->b, l->s, least, positive);
	if (!positive && !l->b->factor)
		positive = stays_above_zero(form, segment_start(l, zero), segment_end(l));
	return positive;
}

/* Below 0 no force is left */
static struct form *force_here(struct looking *l, const struct node *node, struct form *force, bool *negative)
{
	if (is_positive_here(l, force) || sign_here(l, node, force, form_number(0)) >= 0)
		return force;
	*negative = *negative || !l->grown;
	return form_number(0);
}

/* What it can hold while it sticks: no less than its force. It is that of the regions next to where it sticks. */
static struct form *rest_here(struct looking *l, struct friction *f, struct form *const *x, struct form *force)
{
	int side = l->grown ? 0 : l->interval[f->function] - stick_of(l->s, f);
	if (side != 1 && side != -1)
		return x[2];
	struct form *more = less_in_velocity(x[2], force, x[0]);
	if (is_positive_here(l, more) || sign_here(l, f->atom->node, more, form_number(0)) >= 0)
		return x[2];
	f->low = f->low || !l->grown;
	return force;
}

static int add_friction(struct looking *l, const struct atom *a)
{
	struct switching *s = l->s;
	int known = friction_of(s, l->segment, a);
	if (known >= 0)
		return known;
	struct friction *f = MORE(s->friction, s->frictions);
	*f = (struct friction){ .atom = a, .segment = l->segment };
	mpq_inits(f->at, f->factor, NULL);
	return s->frictions - 1;
}

/* As written, in this segment of time */
static void check_forces_here(const struct looking *l, const struct atom *a)
{
	if (l->b->factor)
		return;
	RATIONAL zero = ZERO;
	for (int i = 1; i < a->operands; i++)
		check_force(a->node->child[i], a->operand[i], segment_start(l, zero), segment_end(l));
}

/* It stands for itself: what it is depends on the whole region */
static struct form *friction_here(struct looking *l, const struct atom *a, struct form *const *x)
{
	int index = add_friction(l, a);
	struct friction *f = &l->s->friction[index];
	f->function = function_here(l, a->node, x[0], f->factor, f->at);
	check_forces_here(l, a);
	add_stick(l, &l->s->function[f->function], f->at);
	for (int i = 1; i < a->operands; i++)
		refuse_force(a->node, x[i]);
	struct region *region = &l->s->region[l->region];
	bool negative = false;
	region->force[a->index] = force_here(l, a->node, x[1], &negative);
	f->negative = f->negative || negative;
	region->rest[a->index] = a->operands > 2 ? rest_here(l, f, x, region->force[a->index])
						 : region->force[a->index];
	return form_unit((struct basis){ .kind = BASIS_ATOM, .index = a->index, .atom = a });
}

/* Whether a > b, by which switching function and which way that is passed */
static bool exceeds(struct looking *l, const struct node *node, const struct form *a, const struct form *b,
		    struct slide *slide, int side)
{
	struct form *form = form_difference(a, b);
	RATIONAL factor = ZERO;
	refuse_force(node, form);
	int e = function_here(l, node, form, factor, slide->at[side]);
	if (e < 0)
		error(node->at, "a force of its own, F", "the force through this slider equals its limit");
	slide->function[side] = e;
	slide->upward[side] = mpq_sgn(factor) > 0;
	return is_above(l, e, slide->at[side]) == slide->upward[side];
}

static struct slider *slider_of(struct switching *s, const struct atom *a)
{
	for (int i = 0; i < s->sliders; i++)
		if (s->slider[i].atom == a)
			return &s->slider[i];
	struct slider *slider = MORE(s->slider, s->sliders);
	*slider = (struct slider){ .atom = a };
	return slider;
}

/* 0 where it sticks; where it slides its equation is another one, which stands once all regions are known */
static struct form *slider_here(struct looking *l, const struct atom *a, struct form *const *x)
{
	struct region *region = &l->s->region[l->region];
	bool negative = false;
	check_forces_here(l, a);
	struct form *force = force_here(l, a->node, x[1], &negative);
	struct slider *slider = slider_of(l->s, a);
	struct slide *slide = &region->slide[a->index];
	mpq_inits(slide->at[0], slide->at[1], NULL);
	bool above = exceeds(l, a->node, x[0], force, slide, 0),
	     below = exceeds(l, a->node, form_difference(NEW(struct form), x[0]), force, slide, 1);
	slider->negative = slider->negative || negative;
	region->force[a->index] = force;
	region->rest[a->index] = x[0];
	slide->way = above ? 1 : below ? -1 : 0;
	return form_number(0);
}

static struct form *call_here(struct looking *l, const struct atom *a, struct form *const *x)
{
	int side;
	switch (a->function) {
	case FN_ABS:
		return sign_here(l, a->node, x[0], form_number(0)) < 0 ? form_difference(form_number(0), x[0]) : x[0];
	case FN_SGN:   return form_number(sign_here(l, a->node, x[0], form_number(0)));
	case FN_MIN:
	case FN_MAX:   return extreme_here(l, a, x);
	case FN_TABLE: return table_here(l, a, x);
	case FN_FRICTION: return friction_here(l, a, x);
	case FN_SLIDE: return slider_here(l, a, x);
	default:
		side = sign_here(l, a->node, x[0], x[1]) < 0 ? 1 : sign_here(l, a->node, x[0], x[2]) > 0 ? 2 : 0;
		return a->function == FN_CLIP ? x[side] : side ? form_difference(x[0], x[side]) : form_number(0);
	}
}

/* <= and < differ on the breakpoint alone, where the motion decides */
static bool comparison_here(struct looking *l, const struct atom *a)
{
	int sign = sign_here(l, a->node, form_here(l, a->operand[0]), form_here(l, a->operand[1]));
	return a->comparison <= CMP_LE ? sign < 0 : sign > 0;
}

static struct form *atom_here(struct looking *l, const struct atom *a)
{
	if (a->kind == ATOM_COMPARE)
		return form_number(comparison_here(l, a));
	if (a->kind == ATOM_CHOOSE)
		return form_here(l, a->operand[comparison_here(l, a->operand[0]->term[0].basis.atom) ? 1 : 2]);
	struct form **x = ARRAY(struct form *, a->operands);
	for (int i = 0; i < a->operands; i++)
		x[i] = form_here(l, a->operand[i]);
	return call_here(l, a, x);
}

static const struct form *known_here(struct looking *l, const struct atom *atom)
{
	const int at = atom->index, outer = l->by;
	if (!l->known[at]) {
		work_at(atom->node->start);
		l->by = -1;
		l->inside++;
		l->known[at] = atom_here(l, atom);
		l->inside--;
		l->decided[at] = l->by;
		l->by = outer;
	}
	if (l->inside > 0)
		note_decision(l, atom->node, l->decided[at]);
	return l->known[at];
}

/* Not to be changed: it may share the terms of the form, or be what an atom is */
static struct form *form_here(struct looking *l, const struct form *form)
{
	if (form->terms == 0 || !form->term[form->terms - 1].basis.atom)
		return form_alias(form);
	struct form *total = NEW(struct form);
	for (int i = 0; i < form->terms; i++) {
		const struct form_term *term = &form->term[i];
		const struct atom *atom = term->basis.atom;
		if (atom)
			form_add_to(total, known_here(l, atom), term->factor);
		else
			form_add_basis(total, term->basis, term->factor);
	}
	return total;
}

/* ---- all regions: in each segment of time those of all intervals ---- */

static int *intervals_of(const struct switching *s, int region)
{
	int *interval = ARRAY(int, s->functions + 1);
	for (int i = 0; i < s->functions; i++)
		interval[i] = interval_of(s, region, i);
	return interval;
}

/* A guard is a breakpoint of its switching function; of a bounce one that stands twice, with the interval of rest
 * between. */
static void meet_impact(struct looking *l, const struct impact *impact, mpq_ptr constant)
{
	struct impact_law *impact_law = &impact->in[l->segment];
	const struct node *node = impact->when->guard;
	bool rising = node->comparison == CMP_GT || node->comparison == CMP_GE;
	const struct form *guard = rising ? impact_law->guard : form_difference(NEW(struct form), impact_law->guard);
	struct compared what = compared_here(l, node, guard, constant);
	impact_law->function = find_switching_function(l->s, l->segment, &what, impact_law->factor, impact_law->at);
	note_sign(l->b, l->s, impact_law->factor, false);
	impact_law->upward = (mpq_sgn(impact_law->factor) > 0) == rising;
	if (!rising)
		mpq_neg(impact_law->factor, impact_law->factor);
	if (impact->bounces)
		add_stick(l, &l->s->function[impact_law->function], impact_law->at);
	else
		(void)is_above(l, impact_law->function, impact_law->at);
}

static void meet_impacts(struct looking *l)
{
	const struct model *model = l->b->model;
	RATIONAL constant = ZERO;
	for (int i = 0; i < model->contacts.impacts; i++)
		meet_impact(l, &model->contacts.impact[i], constant);
}

/* What a look has left that was not the last */
static void forget_region(const struct region *region)
{
	discard(region->residual);
	discard(region->force);
	discard(region->rest);
	discard(region->carried);
	discard(region->slide);
}

/* One look at every region but the first `known`; false: something new was met on the way, but of the first `known`
 * then. The regions of one switching function are its intervals, in order, so that those below a new breakpoint stay
 * what they are. */
static bool look(struct building *b, struct switching *s, int *known)
{
	struct region *before = s->region;
	for (int r = *known; r < s->regions; r++)
		forget_region(&before[r]);
	bool single = s->functions == 1 && s->segments == 1 && !s->cached;
	int in_one = count_candidates(s);
	s->many = in_one == 0;
	if (s->many)
		return true;
	s->regions = (s->cached ? 1 + breaks_of_all(s) : in_one) * s->segments;
	s->region = ARRAY(struct region, s->regions);
	for (int r = 0; r < *known; r++)
		s->region[r] = before[r];
	for (int r = *known; r < s->regions; r++) {
		int atoms = atoms_count(b->collector.atoms), *interval = intervals_of(s, r);
		struct looking l = { .b = b,
				     .s = s,
				     .interval = interval,
				     .known = ARRAY(struct form *, atoms),
				     .decided = ARRAY(int, atoms),
				     .by = -1,
				     .count = atoms,
				     .region = r,
				     .segment = segment_of_region(s, r),
				     .lowest = r };
		s->region[r].residual = ARRAY(struct form *, b->model->n);
		s->region[r].force = ARRAY(struct form *, atoms);
		s->region[r].rest = ARRAY(struct form *, atoms);
		s->region[r].carried = ARRAY(struct form *, atoms);
		s->region[r].slide = ARRAY(struct slide, atoms);
		for (int k = 0; k < s->rows; k++) {
			l.row = s->row[k];
			s->region[r].residual[l.row] =
				form_here(&l, b->segment_equations[l.segment].residual[l.row].form);
		}
		meet_impacts(&l);
		discard(l.known);
		discard(l.decided);
		discard(interval);
		*known = single && s->functions == 1 ? l.lowest : 0;
		if (s->torn)
			s->functions = *known = 0;
		s->torn = false;
		if (l.grown)
			return false;
		if (s->cached && l.mixed)
			refuse_cache(b, s, l.mixed, "two switching functions decide on it together");
	}
	return true;
}

/* ---- all of it ---- */

static bool rows_change(const struct building *b, int rows, const int *row)
{
	bool changes = false;
	for (int s = 1; s < b->model->system.segments; s++)
		for (int k = 0; k < rows; k++)
			changes = changes || !same_form(b->segment_equations[s].residual[row[k]].form,
							b->segment_equations->residual[row[k]].form);
	return changes || impacts_change(b);
}

/* Whether friction stands in an equation with others, or with what switches else */
static bool frictions_meet(const struct building *b, const struct switching *s)
{
	bool meet = false;
	for (int k = 0; k < s->rows; k++) {
		const struct form *form = b->segment_equations[0].residual[s->row[k]].form;
		int atoms = 0, frictions = 0;
		for (int i = 0; i < form->terms; i++) {
			const struct atom *a = form->term[i].basis.atom;
			atoms += a != NULL;
			frictions += a && is_friction(a);
		}
		meet = meet || (frictions > 0 && atoms > 1);
	}
	return meet;
}

/* Whether regions that are too many for tables may be made on the target; what stands against it else is said */
static bool may_cache(const struct building *b, const struct switching *s)
{
	return !b->factor && s->impacts == 0;
}

/* All of them, or those that the target sums up the others from */
static struct switching *regions_found(struct building *b, int rows, int *row, bool cached)
{
	struct switching *s = NEW(struct switching);
	const struct node *slots = b->spec->request.cached;
	int known = 0;
	s->cached = cached;
	s->slots = slots ? whole_number(b, b->spec->request.cached, 2, MOST_SLOTS, "regions that are cached") : 0;
	s->impacts = b->model->contacts.impacts;
	s->impact = b->model->contacts.impact;
	s->rows = rows;
	s->row = row;
	s->segments = rows_change(b, rows, row) ? b->model->system.segments : 1;
	while (!look(b, s, &known))
		;
	b->crowded = cached && s->many;
	if (cached && (s->many || !may_cache(b, s)))
		refuse_cache(b, s, s->many ? s->function[s->functions - 1].node : b->spec->request.cached,
			     s->many ? "regions have no number below 2^31"
			     : b->factor ? "tunable params change matrices"
					 : "what bounces has another inertia where it rests");
	if (!s->many) {
		complete_switching_functions(s);
		mark_possible(b, s);
	}
	return s;
}

/* Highest derivatives cannot decide on their own equations; the collector has refused them. */
struct switching *regions_of_rows(struct building *b, int rows, int *row)
{
	/* through all of them; or the model has none but for its derivatives */
	const bool all = b->request->solution || b->request->again.by_regions;
	struct switching *s = regions_found(b, rows, row, b->spec->request.cached && !all);
	if (s->many_in_time && !may_cache(b, s))
		too_many_in_time(s);
	if (s->many && (!may_cache(b, s) || frictions_meet(b, s)))
		too_many(b, s);
	if (s->many)
		s = regions_found(b, rows, row, true);
	if (!b->model->relative)                /* else its error was reported */
		check_jumps(b, s);
	if (has_events(s))
		resolve_friction(b, s);
	return s;
}
