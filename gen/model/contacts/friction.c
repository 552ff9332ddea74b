/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dry friction in regions. The sliding velocity v of friction(v, F) is a switching function with a breakpoint that
 * stands twice: below it the force is -F, above it F, and between, where it sticks, what keeps v at 0. There an
 * equation that the force acts on is solved for it and put into the others, and v' = 0 stands in its place; the state
 * whose rate that is follows from the others. Sticking ends where the force would have to be above F, the convention of
 * Filippov (Differential Equations with Discontinuous Righthand Sides, 1988). */
#include "inner.h"
#include "model/building.h"
#include "model/checks.h"

/* ---- is there any? ---- */

const struct atom *friction_in(const struct form *form, bool *seen)
{
	for (const struct form_term **term = terms_within(form, seen); *term; term++) {
		const struct atom *a = (*term)->basis.atom;
		if (a && a->kind == ATOM_CALL && a->function >= FN_FRICTION)
			return a;
	}
	return NULL;
}

void report_no_equation(const struct atom *friction)
{
	error(friction->node->at, "an output repeats it as an equation has it", "no equation has this friction");
}

static const struct atom *first_friction(const struct building *b)
{
	bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	const struct atom *found = NULL;
	for (int s = 0; s < b->model->system.segments; s++)
		for (int i = 0; i < b->model->n && !found; i++)
			found = friction_in(residual_as_written(&b->segment_equations[s], b->owner, i), seen);
	return found;
}

bool holds_friction(const struct building *b)
{
	return first_friction(b) != NULL;
}

void report_no_friction(const struct building *b)
{
	report_no_events(b, first_friction(b)->node->at);
}

/* ---- where it sticks ---- */

struct form *less_in_velocity(const struct form *rest, const struct form *force, const struct form *velocity)
{
	struct form *more = form_difference(rest, force);
	const struct form_term *last = velocity->terms > 0 ? &velocity->term[velocity->terms - 1] : NULL;
	const struct form_term *term = last ? form_find(more, &last->basis) : NULL;
	if (!term)
		return more;
	RATIONAL ratio = ZERO;
	mpq_div(ratio, term->factor, last->factor);
	more = form_difference(more, form_scale(velocity, ratio));
	return more;
}

int friction_of(const struct switching *s, int segment, const struct atom *a)
{
	int index = s->frictions - 1;
	while (index >= 0 && (s->friction[index].atom != a || s->friction[index].segment != segment))
		index--;
	return index;
}

bool is_repeated(const struct switching *s, int friction)
{
	bool repeated = false;
	for (int i = 0; i < friction; i++)
		repeated = repeated || (s->friction[i].atom->node == s->friction[friction].atom->node &&
					s->friction[i].segment != s->friction[friction].segment);
	return repeated;
}

int stick_of(const struct switching *s, const struct friction *f)
{
	const struct switching_function *e = &s->function[f->function];
	int interval = 1;
	while (!is_stick(e, interval) || !mpq_equal(e->at[interval], f->at))
		interval++;
	return interval;
}

static mpq_srcptr factor_of_friction(const struct form *residual, const struct friction *f)
{
	struct basis basis = { .kind = BASIS_ATOM, .index = f->atom->index, .atom = f->atom };
	const struct form_term *term = form_find(residual, &basis);
	return term ? term->factor : NULL;
}

/* ---- forces of what slips ---- */

static void put_in(const struct switching *s, struct region *region, const struct friction *f, mpq_srcptr factor)
{
	struct basis basis = { .kind = BASIS_ATOM, .index = f->atom->index, .atom = f->atom };
	RATIONAL size = ZERO, minus = ZERO;
	for (int k = 0; k < s->rows; k++) {
		struct form *residual = region->residual[s->row[k]], *sum = NEW(struct form);
		mpq_srcptr stands = factor_of_friction(residual, f);
		if (!stands)
			continue;
		mpq_neg(minus, stands);
		mpq_mul(size, stands, factor);
		form_add_to(sum, residual, NULL);
		form_add_basis(sum, basis, minus);
		form_add_to(sum, region->force[f->atom->index], size);
		region->residual[s->row[k]] = sum;
	}
}

static void slip(const struct switching *s, int index)
{
	struct region *region = &s->region[index];
	RATIONAL sign = ZERO;
	for (int i = 0; i < s->frictions; i++) {
		const struct friction *f = &s->friction[i];
		if (f->segment != segment_of_region(s, index))
			continue;
		int side = interval_of(s, index, f->function) - stick_of(s, f);
		mpq_set_si(sign, side < 0 ? -mpq_sgn(f->factor) : mpq_sgn(f->factor), 1);
		if (side != 0) {
			put_in(s, region, f, sign);
			const struct form *force = region->force[f->atom->index];
			region->carried[f->atom->index] = force ? form_scale(force, sign) : form_number(0);
		}
	}
}

/* ---- constraints of what sticks ---- */

struct stuck {                      /* one switching function that is held, in one region */
	int function;
	const struct atom *atom;    /* the first that acts; NULL: none does */
	const struct impact *impact; /* that rests there; NULL: it is friction */
	const struct impact_law *impact_law; /* the same in this segment of time */
	struct form *place;         /* of that: 0 too */
	mpq_t *direction;           /* per row: of its force */
	mpq_t *share;               /* per friction: what it carries of that force */
	struct form *velocity, *rate, *force;
	int pivot;                  /* the row that is solved for the force */
};

/* a = ratio b */
static bool is_ratio(const struct form *a, const struct form *b, mpq_ptr ratio)
{
	mpq_set_ui(ratio, 0, 1);
	return a->terms == 0 || is_form_multiple(a, b, ratio);
}

static void add_direction(const struct switching *s, const struct region *region, const struct friction *f,
			  mpq_srcptr ratio, struct stuck *stuck)
{
	RATIONAL part = ZERO;
	for (int k = 0; k < s->rows; k++) {
		mpq_srcptr factor = factor_of_friction(region->residual[s->row[k]], f);
		if (!factor)
			continue;
		mpq_mul(part, factor, ratio);
		(mpq_sgn(f->factor) > 0 ? mpq_add : mpq_sub)(stuck->direction[k], stuck->direction[k], part);
	}
}

static bool acts(const struct switching *s, const struct region *region, const struct friction *f)
{
	bool any = false;
	for (int k = 0; k < s->rows; k++)
		any = any || factor_of_friction(region->residual[s->row[k]], f);
	return any;
}

/* Several of one velocity are one: their forces are multiples of one another, and so their parts of it. */
static void find_direction(const struct switching *s, int index, int function, struct stuck *stuck)
{
	const struct region *region = &s->region[index];
	RATIONAL ratio = ZERO;
	for (int i = 0; i < s->frictions; i++) {
		const struct friction *f = &s->friction[i];
		if (f->segment != segment_of_region(s, index) || f->function != function ||
		    stick_of(s, f) != interval_of(s, index, function) || !acts(s, region, f))
			continue;
		int at = f->atom->index;
		if (!stuck->atom || region->force[stuck->atom->index]->terms == 0)
			stuck->atom = f->atom;
		int base = stuck->atom->index;
		if (at != base && (!is_ratio(region->force[at], region->force[base], ratio) ||
				   !same_form(region->rest[at], form_scale(region->rest[base], ratio))))
			error(f->atom->node->at,
			      "several of one velocity need forces that are multiples of one another",
			      "how friction of one velocity is shared out while it sticks is not determined");
		if (at == base)
			mpq_set_ui(ratio, 1, 1);
		add_direction(s, region, f, ratio, stuck);
		mpq_set(stuck->share[i], ratio);
		if (mpq_sgn(f->factor) < 0)
			mpq_neg(stuck->share[i], ratio);
	}
}

/* What rests is held in place, along the direction of its impacts. */
static void find_rest(struct building *b, const struct switching *s, int index, struct stuck *stuck)
{
	const struct region *region = &s->region[index];
	stuck->place = stuck->velocity;
	stuck->velocity = rate_of_form(b, stuck->place);
	stuck->rate = rate_of_form(b, stuck->velocity);
	for (int k = 0; k < s->rows; k++)
		for (int j = 0; j < b->model->n; j++) {
			struct basis basis = { .kind = BASIS_COORD, .index = j, .order = 2 };
			const struct form_term *mass = form_find(region->residual[s->row[k]], &basis);
			if (!mass)
				continue;
			rational_addmul(stuck->direction[k], mass->factor, stuck->impact_law->direction[j]);
		}
}

static bool is_borne(const struct stuck *stuck)
{
	return stuck->atom || stuck->impact;
}

static struct place place_of_stuck(const struct stuck *stuck)
{
	return stuck->impact ? stuck->impact->when->at : stuck->atom->node->at;
}

static struct stuck *find_stuck(struct building *b, const struct switching *s, int index, int *count)
{
	struct stuck *stuck = ARRAY(struct stuck, s->functions);
	int segment = segment_of_region(s, index);
	*count = 0;
	for (int e = 0; e < s->functions; e++) {
		const struct switching_function *function = &s->function[e];
		int interval = interval_of(s, index, e);
		if (!is_stick(function, interval))
			continue;
		struct stuck *new = &stuck[(*count)++];
		*new = (struct stuck){ .function = e, .direction = rationals(s->rows),
				       .share = rationals(s->frictions), .pivot = -1 };
		new->velocity = form_difference(form_in(function, segment), form_constant(function->at[interval]));
		new->rate = rate_of_form(b, new->velocity);
		int impact = impact_resting(s, segment, e, interval);
		if (impact >= 0) {
			new->impact = &s->impact[impact];
			new->impact_law = &new->impact->in[segment];
		}
		if (impact >= 0)
			find_rest(b, s, index, new);
		else
			find_direction(s, index, e, new);
	}
	return stuck;
}

static bool has_states(const struct form *form)
{
	return form->terms > 0 && form->term[form->terms - 1].basis.kind == BASIS_COORD;
}

/* The place of a coordinate; -1: there is none */
static int place_term(const struct form *form)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == BASIS_COORD && form->term[i].basis.order == 0)
			return i;
	return -1;
}

/* v = 0, solved for a state; false: it follows from what is held already, or contradicts it */
static bool hold_form(struct holding *h, const struct form *v, bool place)
{
	v = free_of_holds(h, v);
	int at = has_states(v) ? place ? place_term(v) : velocity_term(h->b, v, false) : -1;
	if (at >= 0)
		hold_state(h, v, at);
	return at >= 0;
}

/* What friction cannot hold beside what is held */
static void report_held(const struct holding *h, const struct stuck *stuck)
{
	const struct form *v = free_of_holds(h, stuck->velocity);
	const struct node *node = stuck->atom->node;
	if (v->terms == 0)
		error(node->at, "without one of them its part is known",
		      "friction holds what other friction holds already: while all of it sticks its force is not "
		      "determined");
	if (has_states(v))
		refuse_velocity_of_friction(node);
}

/* States that follow from the others; false: not all of these can stick together. */
static bool find_holds(const struct building *b, const struct switching *s, int index, const struct stuck *stuck,
		       int count)
{
	struct region *region = &s->region[index];
	size_t most = 2 * (size_t)count + (size_t)s->sliders;
	struct holding h = { b, region, ARRAY(struct basis, most) };
	bool possible = true;
	region->hold = ARRAY(struct hold, most);
	region->holds = 0;
	for (int k = 0; k < 2 * count && possible; k++) {       /* no friction sticks beside what rests that way */
		const struct stuck *one = &stuck[k % count];
		if (k < count ? !one->atom : !one->impact)
			continue;
		possible = hold_form(&h, one->velocity, false);
		if (!possible && one->atom)
			report_held(&h, one);
	}
	for (int k = 0; k < count && possible; k++)
		possible = !stuck[k].impact || hold_form(&h, stuck[k].place, true);
	if (possible)
		hold_sliders(&h, s);
	return possible;
}

/* Row `to` less `factor` times row `from` */
static void subtract_row(const struct switching *s, struct region *region, struct stuck *stuck, int count, int from,
			 int to, mpq_srcptr factor)
{
	for (int k = 0; k < count; k++)
		rational_submul(stuck[k].direction[to], factor, stuck[k].direction[from]);
	region->residual[s->row[to]] = form_difference(region->residual[s->row[to]],
						       form_scale(region->residual[s->row[from]], factor));
}

/* The row with the force of stuck[k] alone; others without it. The force is then what the row leaves. */
static void solve_for_force(const struct switching *s, struct region *region, struct stuck *stuck, int count, int k)
{
	bool taken = true;
	int pivot = -1;
	RATIONAL factor = ZERO, one = RATIO(1, 1);
	while (taken && ++pivot < s->rows) {
		taken = mpq_sgn(stuck[k].direction[pivot]) == 0;
		for (int i = 0; i < k; i++)
			taken = taken || stuck[i].pivot == pivot;
	}
	if (pivot == s->rows)
		error(place_of_stuck(&stuck[k]), NULL, "the forces of what sticks and rests are not determined");
	mpq_inv(factor, stuck[k].direction[pivot]);     /* less 1 - 1/d times itself: divided by d */
	mpq_neg(factor, factor);
	mpq_add(factor, factor, one);
	subtract_row(s, region, stuck, count, pivot, pivot, factor);
	for (int i = 0; i < s->rows; i++) {
		if (i == pivot || mpq_sgn(stuck[k].direction[i]) == 0)
			continue;
		mpq_set(factor, stuck[k].direction[i]);
		subtract_row(s, region, stuck, count, pivot, i, factor);
	}
	stuck[k].pivot = pivot;
}

/* The force may be as large as it is at rest, on either side where sliding would begin. */
static void add_releases(const struct switching *s, int index, const struct stuck *stuck)
{
	struct region *region = &s->region[index];
	const struct form *up = NEW(struct form), *down = up;
	if (stuck->impact) {                    /* it presses, and does not pull */
		add_release(region, stuck->function, !stuck->impact_law->upward,
			    form_difference(NEW(struct form), stuck->force));
		return;
	}
	if (stuck->atom) {
		up = s->region[region_above(s, index, stuck->function)].rest[stuck->atom->index];
		down = s->region[region_below(s, index, stuck->function)].rest[stuck->atom->index];
	}
	const struct form *force = stuck->atom ? stuck->force : stuck->rate;
	add_release(region, stuck->function, true, form_difference(force, up ? up : NEW(struct form)));
	add_release(region, stuck->function, false,
		    form_difference(form_difference(NEW(struct form), force), down ? down : NEW(struct form)));
}

static void stick(struct building *b, const struct switching *s, int index)
{
	struct region *region = &s->region[index];
	int count;
	struct stuck *stuck = find_stuck(b, s, index, &count);
	region->possible = find_holds(b, s, index, stuck, count);
	if (!region->possible)
		return;
	for (int k = 0; k < s->rows; k++)
		region->residual[s->row[k]] = terms_of_kinds(region->residual[s->row[k]], ~(1u << BASIS_ATOM));
	for (int k = 0; k < count; k++)
		if (is_borne(&stuck[k]))
			solve_for_force(s, region, stuck, count, k);
	for (int k = 0; k < count; k++) {
		if (!is_borne(&stuck[k]))
			continue;
		int row = s->row[stuck[k].pivot];
		stuck[k].force = form_difference(NEW(struct form), region->residual[row]);
		region->residual[row] = stuck[k].rate;
		for (int i = 0; i < s->frictions; i++)
			if (mpq_sgn(stuck[k].share[i]) != 0)
				region->carried[s->friction[i].atom->index] =
					form_scale(stuck[k].force, stuck[k].share[i]);
	}
	for (int k = 0; k < count; k++)
		add_releases(s, index, &stuck[k]);
}

void resolve_friction(struct building *b, struct switching *s)
{
	for (int r = 0; r < s->regions; r++) {
		s->region[r].possible = true;   /* but where what sticks contradicts itself */
		slip(s, r);
		slide_sliders(b, s, r);
		stick(b, s, r);
	}
}

/* ---- rows ---- */

/* The Delassus entry of a friction, g W^-1 G: above 0, or the force drives what it should hold */
static void check_response(struct building *b, const struct switching *s, const struct friction *f)
{
	const struct model *model = b->model;
	const struct linear *system = &model->system;
	int n = model->n;
	mpq_t *inverse = inverse_of_leading(system);
	const struct form *rate = rate_of_form(b, s->function[f->function].form);
	RATIONAL delassus = ZERO, part = ZERO;
	for (int i = 0; i < n; i++) {
		mpq_srcptr acts = factor_of_friction(b->segment_equations[f->segment].residual[i].form, f);
		for (int k = 0; k < rate->terms && acts; k++) {
			const struct basis *basis = &rate->term[k].basis;
			if (basis->kind != BASIS_COORD || basis->order != model->frame.coord[basis->index]->highest)
				continue;
			mpq_mul(part, inverse[basis->index * n + i], rate->term[k].factor);
			mpq_mul(part, part, acts);
			mpq_add(delassus, delassus, part);
		}
	}
	int sign = mpq_sgn(delassus) * mpq_sgn(f->factor);
	if (sign < 0)
		report_drives(f->atom->node);
}

/* What outputs read of it */
static void feel(struct switching *s, bool *seen, const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct atom *a = form->term[i].basis.atom;
		if (!a || seen[a->index])
			continue;
		seen[a->index] = true;
		bool friction = a->kind == ATOM_CALL && a->function >= FN_FRICTION;
		if (friction)
			*MORE(s->transmitted, s->transmitted_forces) = a;
		for (int k = 0; k < a->operands && !friction; k++)
			feel(s, seen, a->operand[k]);
	}
}

int transmitted_of(const struct switching *s, const struct atom *a)
{
	int index = s->transmitted_forces - 1;
	while (index >= 0 && s->transmitted[index] != a)
		index--;
	return index;
}

struct feeling {
	struct building *b;
	const struct switching *s;
	const struct atom *a;
	int segment, found;
};

/* Which of a segment of time it is: that which its text is there */
static void find_transmitted(void *context)
{
	struct feeling *work = context;
	struct collector *c = &work->b->collector;
	c->interval = work->segment;
	forget_lets(work->b->spec);
	struct node *node = NEW(struct node);
	*node = *work->a->node;                 /* collecting notes what it finds */
	const struct value *value = collect(c, node);
	for (int i = 0; i < value->cell[0]->terms && work->found < 0; i++)
		if (value->cell[0]->term[i].basis.atom)
			work->found = friction_of(work->s, work->segment, value->cell[0]->term[i].basis.atom);
}

static int *transmitted_in_segments(struct building *b, const struct switching *s, const struct atom *a)
{
	int *index = ARRAY(int, s->segments);
	bool any = false;
	for (int k = 0; k < s->segments; k++) {
		index[k] = friction_of(s, k, a);
		if (index[k] < 0 && s->segments > 1) {
			struct feeling work = { b, s, a, k, -1 };
			statement_guard(find_transmitted, &work);
			index[k] = work.found;
		}
		any = any || index[k] >= 0;
	}
	b->collector.interval = 0;
	forget_lets(b->spec);
	if (!any)
		report_no_equation(a);
	return index;
}

/* An acceleration follows from its equation, and so reads the remainder; that is computed of all equations. */
static bool reads_remainder(const struct model *model)
{
	bool any = false;
	for (int i = 0; i < model->outputs; i++)
		any = any || !rationals_zero((size_t)model->remainder.force_columns, model->output[i].force_column);
	for (int k = 0; k < model->n; k++)
		any = any || (model->equations.highest[k] &&
			      !rationals_zero((size_t)model->remainder.force_columns,
					      model->equations.highest[k]->force_column));
	return any;
}

/* A contact that rests changes highest derivatives by its force, which no equation has: they are rows of regions, as
 * those are that tunable params change. */
static void find_highest_of_regions(const struct building *b, struct switching *s)
{
	const struct model *model = b->model;
	s->highest = ARRAY(int, model->n);
	for (int k = 0; k < model->n; k++) {
		const bool own = (has_bounces(model) || b->factor) && model->equations.highest[k];
		s->highest[k] = own ? s->transmitted_forces : -1;
		if (own)
			*MORE(s->transmitted, s->transmitted_forces) = NULL;
	}
}

static void build_highest_of_regions(struct building *b, struct switching *s)
{
	for (int k = 0; k < b->model->n; k++)
		for (int r = 0; s->highest[k] >= 0 && r < s->regions; r++)
			if (s->region[r].possible)
				s->region[r].friction_force[s->highest[k]] =
					row_of_highest(b, &s->system[s->region[r].system], k);
}

static void build_friction_forces(struct building *b, struct switching *s)
{
	bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	const struct model *model = b->model;
	for (int i = 0; i < model->outputs; i++)
		if (model->output[i].left)
			feel(s, seen, model->output[i].left);
	for (int c = 0; c < model->remainder.force_columns && reads_remainder(model); c++)
		feel(s, seen, model->schedule.operator[0].left[c]);
	const int frictions = s->transmitted_forces;
	find_highest_of_regions(b, s);
	for (int r = 0; r < s->regions; r++)
		s->region[r].friction_force = ARRAY(struct output *, s->transmitted_forces);
	for (int i = 0; i < frictions; i++) {
		bool slides = s->transmitted[i]->function == FN_SLIDE;
		const int *index = slides ? NULL : transmitted_in_segments(b, s, s->transmitted[i]);
		for (int r = 0; r < s->regions; r++) {
			struct region *region = &s->region[r];
			if (!region->possible)          /* nothing is carried there */
				continue;
			int here = slides ? -1 : index[segment_of_region(s, r)];
			struct form *carried = slides     ? slide_velocity(s, region, s->transmitted[i]->node)
					       : here < 0 ? NULL
							  : region->carried[s->friction[here].atom->index];
			if (carried)
				region->friction_force[i] = row_in_system(b, &s->system[region->system], carried);
			if (region->friction_force[i])
				region->friction_force[i]->form = carried;
		}
	}
	build_highest_of_regions(b, s);
}

void build_friction(struct building *b, struct switching *s)
{
	int column;
	mpq_t *inverse = rationals((size_t)b->model->n * (size_t)b->model->n);
	for (int i = 0; i < s->frictions; i++)
		check_response(b, s, &s->friction[i]);
	for (int r = 0; r < s->regions; r++) {
		struct region *region = &s->region[r];
		if (!region->possible || (region->holds == 0 && region->releases == 0))
			continue;
		const struct linear *system = &s->system[region->system];
		if (!leading_inverse(system, inverse, &column))
			report_unheld(s->frictions ? s->friction->atom->node->at : s->impact->when->at);
		for (int k = 0; k < region->holds; k++)
			region->hold[k].row = row_of_form(b, region->hold[k].form);
		for (int k = 0; k < region->releases; k++)
			region->release[k].row = row_in_system(b, system, region->release[k].form);
	}
	build_friction_forces(b, s);
}
