/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which regions can be: inequalities of their switching functions that hold together, by elimination (Fourier and
 * Motzkin). Whether forces jump with a velocity from one to the next. */
#include "inner.h"
#include "model/building.h"
#include "model/contacts/friction.h"
#include "model/reads.h"

static const struct node *last_term(const struct switching *s)
{
	return s->function[s->functions - 1].node;
}

_Noreturn void too_many_in_time(const struct switching *s)
{
	error(last_term(s)->at,
	      "a load that is sampled can be an input; a scheme with a remainder, such as etdrk4, needs no regions",
	      "more regions than the limit of %d, in %d segments of time together", LIMIT_REGIONS_IN_TIME, s->segments);
}

_Noreturn void too_many(struct building *b, const struct switching *s)
{
	const char *hint = "a scheme with a remainder, such as etdrk4, needs no regions";
	if (has_events(s))
		hint = "what sticks, slips or bounces has three intervals, and all of them have their regions "
		       "together; scheme taylor needs no regions";
	b->crowded = true;
	error(last_term(s)->at, hint, "more regions than the limit of %d", LIMIT_REGIONS);
}

_Noreturn void refuse_cache(const struct building *b, const struct switching *s, const struct node *node,
			    const char *why)
{
	if (!b->spec->request.cached)
		error(last_term(s)->at, format("the target could make them, but at '%s' %s",
					       text_between(node->start, node->end), why),
		      "more regions than the limit of %d", LIMIT_REGIONS);
	error(node->at, "without 'regions cached' all of them are in tables",
	      "a region's matrix is no sum over switching functions: %s", why);
}

/* ---- whether a region is the sum of what each switching function does to the lowest one ---- */

static const struct hold *hold_of_state(const struct region *region, int state)
{
	int k = region->holds - 1;
	while (k >= 0 && region->hold[k].state != state)
		k--;
	return k < 0 ? NULL : &region->hold[k];
}

static bool holds_alike(const struct region *a, const struct region *b, int state)
{
	const struct hold *one = hold_of_state(a, state), *other = hold_of_state(b, state);
	return !one || !other ? one == other : same_form(one->form, other->form);
}

/* The one switching function besides which a region differs from the lowest; -1: none */
static int beside_by(const struct switching *s, int region)
{
	int e = s->functions - 1;
	while (e >= 0 && interval_of(s, region, e) == 0)
		e--;
	return e;
}

int owner_of_hold(const struct switching *s, int state)
{
	int owner = -1;
	for (int r = 0; r < s->regions; r++)
		if (!holds_alike(&s->region[r], &s->region[r - r % regions_at_once(s)], state))
			owner = beside_by(s, r);
	return owner;
}

bool same_equations(const struct linear *a, const struct linear *b, int row, int rows)
{
	const size_t n = (size_t)a->n, at = (size_t)row * n, cells = (size_t)rows * n, count = (size_t)rows;
	bool same = rationals_equal(cells, a->M + at, b->M + at) && rationals_equal(cells, a->C + at, b->C + at) &&
		    rationals_equal(cells, a->K + at, b->K + at);
	for (int l = 0; l < a->loads && same; l++)
		for (int k = 0; k < a->load[l].columns && same; k++)
			same = rationals_equal(count, a->load[l].force[k] + row, b->load[l].force[k] + row);
	for (int i = 0; i < 2 * a->inputs && same; i++)
		same = rationals_equal(count, a->input[i / 2].force[i % 2] + row, b->input[i / 2].force[i % 2] + row);
	return same;
}

/* The factor of a coordinate's highest derivative in an equation */
static mpq_srcptr leading_factor(const struct linear *system, int row, int coord)
{
	return (system->velocity[coord] >= 0 ? system->M : system->C)[row * system->n + coord];
}

/* Whether an equation has one highest derivative, which no other equation has */
static bool has_own_inertia(const struct linear *system, int row)
{
	int found = 0, others = 0;
	for (int j = 0; j < system->n; j++) {
		if (mpq_sgn(leading_factor(system, row, j)) == 0)
			continue;
		found++;
		for (int i = 0; i < system->n; i++)
			others += i != row && mpq_sgn(leading_factor(system, i, j)) != 0;
	}
	return found == 1 && others == 0;
}

/* Of an equation that what sticks or slides puts another one in the place of */
static void check_row(const struct building *b, const struct switching *s, int region, int row)
{
	const int by = beside_by(s, region), in_one = regions_at_once(s);
	const struct node *node = s->function[by].node;
	for (int r = 0; r < s->regions; r++) {
		const struct linear *low = &s->system[s->region[r - r % in_one].system],
				    *here = &s->system[s->region[r].system];
		if (!has_own_inertia(here, row))
			refuse_cache(b, s, node,
				     "its equation has other highest derivatives, or these other equations");
		if (r % in_one > 0 && beside_by(s, r) != by && !same_equations(low, here, row, 1))
			refuse_cache(b, s, node, "its equation has other terms that switch");
	}
}

static void check_held(const struct building *b, const struct switching *s, const struct region *region)
{
	const struct linear *system = s->system;
	for (int k = 0; k < region->holds; k++) {
		const struct form *form = region->hold[k].form;
		const int owner = owner_of_hold(s, region->hold[k].state);
		const struct node *node = s->function[owner < 0 ? 0 : owner].node;
		if (owner < 0)
			refuse_cache(b, s, node, "a state is held everywhere");
		for (int i = 0; i < form->terms; i++) {
			const struct basis *basis = &form->term[i].basis;
			const int state = basis->kind != BASIS_COORD ? -1
					  : basis->order	     ? system->velocity[basis->index] : basis->index;
			if (state >= 0 && owner_of_hold(s, state) >= 0)
				refuse_cache(b, s, node, "its place follows from what another one holds");
		}
	}
	for (int j = 0; j < system->states; j++) {
		int owners = 0;
		for (int e = 0; e < s->functions; e++) {
			bool differs = false;
			for (int r = 0; r < s->regions; r++)
				differs = differs || (beside_by(s, r) == e &&
						      !holds_alike(&s->region[r],
								   &s->region[r - r % regions_at_once(s)], j));
			owners += differs;
		}
		if (owners > 1)
			refuse_cache(b, s, s->function[0].node, "two switching functions hold one state");
	}
}

/* Whether what it compares sticks or slides somewhere */
static bool has_own_events(const struct switching *s, int function)
{
	bool any = false;
	for (int r = 0; r < s->regions; r++)
		for (int k = 0; k < s->region[r].releases; k++)
			any = any || s->region[r].release[k].function == function;
	return any;
}

/* Once their systems are built */
void check_sum(const struct building *b, const struct switching *s)
{
	for (int r = 0; r < s->regions; r++) {
		const struct region *here = &s->region[r], *low = &s->region[r - r % regions_at_once(s)];
		if (!here->possible)
			refuse_cache(b, s, s->function[0].node, "what sticks contradicts itself");
		check_held(b, s, here);
		for (int k = 0; k < s->rows && (here->releases > 0 || low->releases > 0); k++)
			if (beside_by(s, r) >= 0 && has_own_events(s, beside_by(s, r)) &&
			    !same_equations(&s->system[low->system], &s->system[here->system], s->row[k], 1))
				check_row(b, s, r, s->row[k]);
	}
	if (s->transmitted_forces > 0)
		error(last_term(s)->at, NULL,
		      "an output of what friction carries needs tables of regions, which are made on the target");
}

struct inequality { mpq_t *a; };    /* a[0] v0 + a[1] v1 + ... < a[count] */

struct inequalities {
	int variables, count;
	struct inequality *row;
};

static void add_inequality(struct inequalities *set, mpq_t *a)
{
	MORE(set->row, set->count)->a = a;
}

/* upper and lower bound on variable v combined, so that it drops out */
static mpq_t *combined(int size, int v, const mpq_t *upper, const mpq_t *lower)
{
	mpq_t *a = rationals(size + 1);
	RATIONAL product = ZERO, factor = ZERO;
	for (int i = 0; i <= size; i++) {
		mpq_div(product, upper[i], upper[v]);
		mpq_div(factor, lower[i], lower[v]);
		mpq_sub(a[i], product, factor); /* v + ... < ., and -v - ... < -. */
	}
	return a;
}

static bool can_hold(struct inequalities set)
{
	for (int v = 0; v < set.variables; v++) {
		struct inequalities rest = { set.variables, 0, NULL };
		for (int i = 0; i < set.count; i++) {
			int sign = mpq_sgn(set.row[i].a[v]);
			if (sign == 0)
				add_inequality(&rest, set.row[i].a);
			for (int j = 0; j < set.count && sign > 0; j++)
				if (mpq_sgn(set.row[j].a[v]) < 0)
					add_inequality(&rest, combined(set.variables, v, set.row[i].a, set.row[j].a));
		}
		set = rest;
	}
	for (int i = 0; i < set.count; i++)
		if (mpq_sgn(set.row[i].a[set.variables]) <= 0)
			return false;           /* 0 < what is not above 0 */
	return true;
}

/* The bases that switching functions are made of, as variables */
static int find_bases(const struct switching *s, int segment, struct basis **basis)
{
	int count = 0;
	*basis = NULL;
	for (int i = 0; i < s->functions; i++)
		for (int k = 0; k < s->function[i].in[segment]->terms; k++) {
			const struct basis *found = &s->function[i].in[segment]->term[k].basis;
			bool known = false;
			for (int j = 0; j < count; j++)
				known = known || basis_order(&(*basis)[j], found) == 0;
			if (known)
				continue;
			*MORE(*basis, count) = *found;
		}
	return count;
}

static mpq_t *bound_row(const struct switching_function *e, int segment, int bases, const struct basis *basis,
			mpq_srcptr at,
			bool below)
{
	mpq_t *a = rationals(bases + 1);
	const struct form *form = e->in[segment];
	for (int k = 0; k < form->terms; k++)
		for (int j = 0; j < bases; j++)
			if (basis_order(&basis[j], &form->term[k].basis) == 0)
				mpq_set(a[j], form->term[k].factor);
	mpq_sub(a[bases], at, e->shift[segment]);
	for (int j = 0; j <= bases && !below; j++)
		mpq_neg(a[j], a[j]);
	return a;
}

static bool is_possible(const struct switching *s, int region, int bases, const struct basis *basis)
{
	struct inequalities set = { bases, 0, NULL };
	for (int i = 0; i < s->functions; i++) {
		const struct switching_function *e = &s->function[i];
		int interval = interval_of(s, region, i), segment = segment_of_region(s, region);
		if (is_stick(e, interval))
			continue;
		if (interval < e->breaks)
			add_inequality(&set, bound_row(e, segment, bases, basis, e->at[interval], true));
		if (interval > 0)
			add_inequality(&set, bound_row(e, segment, bases, basis, e->at[interval - 1], false));
	}
	return can_hold(set);
}

/* Expressions of which each has a basis of its own are independent: then every region can be. */
static bool independent(const struct switching *s, int segment)
{
	for (int i = 0; i < s->functions; i++) {
		bool own = false;
		const struct form *form = s->function[i].in[segment];
		for (int k = 0; k < form->terms && !own; k++) {
			own = true;
			for (int j = 0; j < s->functions; j++)
				for (int m = 0; m < s->function[j].in[segment]->terms; m++)
					own = own &&
					      (i == j ||
					       basis_order(&form->term[k].basis,
							   &s->function[j].in[segment]->term[m].basis) != 0);
		}
		if (!own)
			return false;
	}
	return true;
}

void mark_possible(const struct building *b, struct switching *s)
{
	int in_one = regions_at_once(s), in_all = 0;
	for (int segment = 0; segment < s->segments; segment++) {
		struct basis *basis;
		int bases = find_bases(s, segment, &basis), count = 0;
		/* by other values others are */
		bool all = b->factor || s->cached || independent(s, segment);
		for (int r = segment * in_one; r < (segment + 1) * in_one; r++) {
			s->region[r].possible = all || is_possible(s, r, bases, basis);
			count += s->region[r].possible;
		}
		in_all += count;
		s->many = s->many || (count > LIMIT_REGIONS && !s->cached);
		s->many_in_time = s->many_in_time || (!s->many && s->segments > 1 && !s->cached && s->functions > 0 &&
						      in_all > LIMIT_REGIONS_IN_TIME);
		s->many = s->many || s->many_in_time;
	}
}

/* ---- what cannot be treated: forces that jump with a velocity ---- */

/* Is the form a multiple of e - at, so that it vanishes on the breakpoint? */
static bool vanishes_on(struct collector *c, const struct form *form, const struct switching_function *e, int segment,
			mpq_srcptr at)
{
	const struct form *here = e->in[segment];
	RATIONAL factor = ZERO, constant = ZERO;
	for (int i = 0; i < form->terms; i++)
		if (basis_order(&form->term[i].basis, &here->term[0].basis) == 0)
			mpq_div(factor, form->term[i].factor, here->term[0].factor);
	mpq_sub(constant, at, e->shift[segment]);
	const struct form *rest =
		form_sum(form, form_scale(form_sum(here, form_constant(constant), true), factor), true);
	bool gone = is_constant(rest);
	if (gone)
		constant_value(c, rest, constant);
	gone = gone && mpq_sgn(constant) == 0;
	return gone;
}

static void check_face(struct building *b, const struct switching *s, int below, int above, int function)
{
	const struct switching_function *e = &s->function[function];
	const struct region *low = &s->region[below], *high = &s->region[above];
	mpq_srcptr at = e->at[interval_of(s, below, function)];
	for (int k = 0; k < s->rows; k++) {
		int i = s->row[k];
		const struct form *jump = form_sum(high->residual[i], low->residual[i], true);
		if (vanishes_on(&b->collector, jump, e, segment_of_region(s, below), at))
			continue;
		report_friction(e->node, format("%s passes %s", form_text(b->model, e->form), readable_text(at)));
	}
}

void check_jumps(struct building *b, const struct switching *s)
{
	for (int e = 0; e < s->functions; e++)
		for (int r = 0; r < s->regions && reads_velocity(b->model, s->function[e].form); r++) {
			const int above = region_above(s, r, e);
			if (above >= 0 && s->region[r].possible && s->region[above].possible)
				check_face(b, s, r, above, e);
		}
}

int possible_regions(const struct switching *s)
{
	int count = s->parts > 0;
	for (int p = 0; p < s->parts; p++)
		count *= possible_regions(s->part[p].model->switching);
	for (int r = 0; r < s->regions && !s->parts; r++)
		count += s->region[r].possible;
	return count;
}
