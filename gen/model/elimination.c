/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear constraints in linear equations: as many coordinates as there are constraints follow from the others. All
 * equations are solved for highest derivatives and multipliers before, in rationals; where the constraints hold,
 * dependent coordinates and their velocities are linear forms of the others, which take their place. So the others have
 * the equations of a model without constraints, which nothing that rounds in a dependent coordinate enters.
 *
 * Dependent ones stay states, held by x'' + 2 a x' + a^2 x = g'' + 2 a g' + a^2 g, where x = g is what they follow from
 * (J. Baumgarte, Computer Methods in Applied Mechanics and Engineering 1, 1972): a state that meets the constraints
 * moves as it does, and what it misses of them decays as (1 + a t) e^{-a t}, here with a = 4/h. */
#include "building.h"
#include "state_mass.h"

enum { LEVELS = 2 };

struct elimination {
	struct building *b;
	struct segment_equations *s;
	int *coord;                 /* per constraint, those of positions first: what it gives */
	/* per derivative and coordinate: what it follows from; NULL: it is independent */
	const struct form **follows[LEVELS];
};

static mpq_srcptr factor_in(const struct form *form, int coord, int order)
{
	const struct basis basis = { .kind = BASIS_COORD, .index = coord, .order = order };
	const struct form_term *term = form_find(form, &basis);
	return term ? term->factor : NULL;
}

/* The last coordinate that has not been taken and whose factor is no less than a quarter of the largest; -1: none has
 * a factor */
static int pivot_in(const struct elimination *e, const struct form *form, int order, int taken)
{
	RATIONAL largest = ZERO, size = ZERO;
	int pivot = -1;
	for (int all = 0; all < 2; all++)
		for (int j = 0; j < e->b->model->n; j++) {
			mpq_srcptr factor = factor_in(form, j, order);
			bool free = factor != NULL;
			for (int k = 0; k < taken; k++)
				free = free && e->coord[k] != j;
			if (!free)
				continue;
			mpq_abs(size, factor);
			if (all) {
				mpq_mul_2exp(size, size, 2);
				pivot = mpq_cmp(size, largest) >= 0 ? j : pivot;
			} else if (mpq_cmp(size, largest) > 0) {
				mpq_set(largest, size);
			}
		}
	return pivot;
}

/* Coordinate by coordinate, factor 1 in its constraint and 0 in all others; `first`: coordinates of those before are
 * known. False: constraints depend on each other. */
static bool solve_level(struct elimination *e, int level, int first, int count, const struct form **g)
{
	RATIONAL factor = ZERO;
	for (int k = 0; k < count; k++) {
		if (k >= first)
			e->coord[k] = pivot_in(e, g[k], level, k);
		if (e->coord[k] < 0)
			return false;
		mpq_srcptr pivot = factor_in(g[k], e->coord[k], level);
		if (!pivot)
			return false;
		mpq_inv(factor, pivot);
		g[k] = form_scale(g[k], factor);
		for (int i = 0; i < count; i++) {
			mpq_srcptr other = factor_in(g[i], e->coord[k], level);
			if (i == k || !other)
				continue;
			mpq_set(factor, other);
			g[i] = form_difference(g[i], form_scale(g[k], factor));
		}
	}
	for (int k = 0; k < count; k++)
		e->follows[level][e->coord[k]] = form_difference(
			form_unit((struct basis){ .kind = BASIS_COORD, .index = e->coord[k], .order = level }), g[k]);
	return true;
}

/* What constraints give, those of positions, then of velocities; false: they depend on each other */
static bool find_dependent(struct elimination *e)
{
	const int m = e->b->spec->count.multipliers;
	const struct form **place = ARRAY(const struct form *, m), **rate = ARRAY(const struct form *, m);
	int held = 0, count = 0;
	for (int i = 0; i < m; i++)
		if (e->s->constraint[i].by[0]) {
			place[held] = e->s->constraint[i].by[0];
			rate[held++] = e->s->constraint[i].by[1];
		}
	count = held;
	for (int i = 0; i < m; i++)
		if (!e->s->constraint[i].by[0])
			rate[count++] = e->s->constraint[i].by[1];
	return solve_level(e, 0, 0, held, place) && solve_level(e, 1, held, count, rate);
}

/* A form over independent coordinates */
static struct form *independent(const struct elimination *e, const struct form *form)
{
	struct form *sum = NEW(struct form);
	for (int i = 0; i < form->terms; i++) {
		const struct form_term *term = &form->term[i];
		const bool state = term->basis.kind == BASIS_COORD && term->basis.order < LEVELS;
		const struct form *follows = state ? e->follows[term->basis.order][term->basis.index] : NULL;
		if (follows)
			form_add_to(sum, follows, term->factor);
		else
			form_add_basis(sum, term->basis, term->factor);
	}
	return sum;
}

/* Accelerations of dependent ones without what holds them: a^2 times rounding would be seen */
static void take_accelerations(const struct elimination *e)
{
	const int n = e->b->model->n;
	for (int order = 0; order < 3; order++) {
		e->s->form[order] = ARRAY(struct form *, n);
		for (int j = 0; j < n; j++) {
			struct form *own = form_unit((struct basis){ .kind = BASIS_COORD, .index = j, .order = order });
			e->s->form[order][j] = order == 2 && e->follows[1][j]
				? form_difference(own, e->s->residual[e->b->owner[j]].form) : own;
		}
	}
}

/* x'' - its acceleration + 2 a (x' - what it follows from) + a^2 (x - ...); a x' - ... of a constraint on velocities */
static void hold_dependent(const struct elimination *e, int coord)
{
	struct residual *own = &e->s->residual[e->b->owner[coord]];
	RATIONAL a = RATIO(DECAY_OF_MISSES, 1), by = ZERO;
	if (mpq_sgn(e->b->model->h) > 0)
		mpq_div(a, a, e->b->model->h);
	mpq_mul(by, a, a);
	for (int level = 0; level < LEVELS; level++) {
		const struct form *follows = e->follows[level][coord];
		if (level == 1)
			e->follows[0][coord] ? mpq_mul_2exp(by, a, 1) : mpq_set(by, a);
		if (follows)
			form_add_to(own->form,
				    form_difference(form_unit((struct basis){ .kind = BASIS_COORD, .index = coord,
									      .order = level }), follows), by);
	}
}

void eliminate_dependent(struct building *b, struct segment_equations *s)
{
	struct elimination e = { .b = b, .s = s, .coord = ARRAY(int, b->spec->count.multipliers) };
	for (int level = 0; level < LEVELS; level++)
		e.follows[level] = ARRAY(const struct form *, b->model->n);
	b->eliminates = find_dependent(&e);
	for (int i = 0; i < b->model->n && b->eliminates; i++)
		s->residual[i].form = independent(&e, s->residual[i].form);
	for (int i = 0; i < b->spec->count.multipliers && b->eliminates; i++)
		s->multiplier[i] = independent(&e, s->multiplier[i]);
	if (!b->eliminates)
		return;
	take_accelerations(&e);
	b->model->equations.misses = 0;
	for (int j = 0; j < b->model->n; j++)
		if (e.follows[1][j]) {
			hold_dependent(&e, j);
			b->model->equations.misses += e.follows[0][j] ? 2 : 1;
		}
}
