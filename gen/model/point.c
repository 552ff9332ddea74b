/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The point where a model is linearised: what forms are there, slopes of the equations as written, which accelerations
 * and multipliers they determine, and whether slopes jump. */
#include "checks.h"
#include "linearise.h"

#include <math.h>

/* ---- the point ---- */

void check_unit(const struct linearising *l, const struct node *node, int state)
{
	const struct linear *system = &l->b->model->system;
	if (state == l->states)
		check_time(node);
	if (state == l->states || !node->unit)
		return;
	const int coord = state < system->n ? state : system->coord[state];
	const struct unit *unit = l->b->model->frame.coord[coord]->unit;
	unit = unit ? unit_of_derivative(unit, state >= system->n) : NULL;
	if (unit && !rationals_equal(UNIT_BASES, (const mpq_t *)node->unit->base, (const mpq_t *)unit->base))
		error(node->unit->at, NULL, "'%s' is in %s", l->b->model->names.state[state], unit->text);
}

static struct fixing *add_fixing(struct linearising *l, const struct symbol *symbol, int index, int order)
{
	struct fixing *f = MORE(l->fixing, l->fixings);
	*f = (struct fixing){ .at = l->b->spec->name_at, .symbol = symbol, .coord = index, .order = order };
	mpq_init(f->value);
	f->form = form_constant(f->value);
	return f;
}

static int state_order(const struct linearising *l, int state)
{
	return state >= l->n;
}

/* The first `states` fixings are the states, the next n the highest derivatives, then multipliers. */
void list_fixings(struct linearising *l)
{
	const struct model *model = l->b->model;
	for (int i = 0; i < l->states; i++) {
		const int coord = model->system.coord[i];
		add_fixing(l, model->frame.coord[coord], coord, state_order(l, i));
	}
	for (int i = 0; i < l->rows; i++)
		add_fixing(l, model->frame.coord[i], i, i < l->n && model->system.velocity[i] < 0 ? 1 : 2);
	for (int i = 0; i < l->inputs; i++)
		for (int order = 0; order < 2; order++)
			add_fixing(l, l->input[i], i, order);
	add_fixing(l, NULL, 0, 0);
}

const struct constraint *constraint_of(const struct linearising *l, int row)
{
	return &l->b->full->constraint[row - l->n];
}

/* As written: solved for highest derivatives, forces on one coordinate would stand in all equations that the mass
 * matrix couples. Loads are as at t, or left out. */
void list_residuals(struct linearising *l)
{
	l->residual = ARRAY(const struct form *, l->rows);
	for (int i = 0; i < l->rows; i++) {
		const struct form *const *by = i < l->n ? NULL : constraint_of(l, i)->by;
		const struct form *form = !by ? residual_as_written(l->b->full, l->b->owner, i) : by[by[0] ? 0 : 1];
		l->residual[i] = l->timed ? form : terms_of_kinds(form, ~(1u << BASIS_FORCING));
	}
}

/* A coordinate, or a multiplier behind them */
mpq_ptr unknown_of(struct linearising *l, int k)
{
	return k < l->n ? l->state[k] : l->fixing[l->states + k].value;
}

struct point *point_of(struct linearising *l)
{
	for (int i = 0; i < l->states; i++)
		mpq_set(l->fixing[i].value, l->state[i]);
	struct point *point = point_new(&l->b->collector, l->fixings, l->fixing);
	point_at_values(point);
	return point;
}

void value_at(struct linearising *l, struct point *point, const struct form *form, mpq_ptr value)
{
	struct form *there = form_at(point, form);
	if (!is_constant(there))
		error(l->b->spec->name_at, NULL, "a term has no value at the point where the model is linearised");
	constant_value(&l->b->collector, there, value);
	if (!is_constant(form))
		form_free(there);
}

void find_residuals(struct linearising *l)
{
	struct point *point;
	for (int i = 0; i < l->n; i++)
		mpq_set_ui(l->fixing[l->states + i].value, 0, 1);
	point = point_of(l);
	for (int i = 0; i < l->rows; i++)
		value_at(l, point, l->residual[i], l->F[i]);
	point_free(point);
}

bool is_equilibrium(const struct linearising *l)
{
	for (int i = 0; i < l->rows; i++)
		if (mpq_sgn(l->F[i]) != 0)
			return false;
	return true;
}


/* ---- derivatives ---- */

static struct form **derivatives_of(struct linearising *l, int count, const struct form *const *form, int fixing)
{
	const struct fixing *f = &l->fixing[fixing];
	return form_derivatives(&l->b->collector, count, form, f->symbol->kind == SYMBOL_INPUT, f->coord, f->order);
}

/* Of all residuals, once for all points */
struct form **residuals_by(struct linearising *l, int fixing)
{
	if (!l->by)
		l->by = ARRAY(struct form **, l->fixings);
	if (!l->by[fixing])
		l->by[fixing] = derivatives_of(l, l->rows, l->residual, fixing);
	return l->by[fixing];
}

void slopes_at(struct linearising *l, int count, const struct form *const *form, int fixing, mpq_t *slope)
{
	struct form **by = form ? derivatives_of(l, count, form, fixing) : residuals_by(l, fixing);
	struct point *point = point_of(l);
	for (int i = 0; i < count; i++)
		value_at(l, point, by[i], slope[i]);
	point_free(point);
	for (int i = 0; i < count && l->always; i++)
		l->varies = l->varies || !is_constant(form_at(l->always, by[i]));
}

void look_for_time(struct linearising *l)
{
	l->always = point_new(&l->b->collector, l->fixings - 1, l->fixing);
	point_at_values(l->always);
}

/* ---- what accelerates: [M G^T; G 0], of equations and of the accelerations that constraints hold ---- */

static const struct form *accelerating(const struct linearising *l, int row)
{
	const struct form *form = row < l->n ? l->residual[row] : constraint_of(l, row)->by[2];
	return row < l->n || l->timed ? form : terms_of_kinds(form, ~(1u << BASIS_FORCING));
}

static void derive_masses(struct linearising *l)
{
	const struct form **form = ARRAY(const struct form *, l->held);
	for (int i = 0; i < l->held; i++)
		form[i] = accelerating(l, l->n + i);
	l->mass = ARRAY(struct form **, l->rows);
	for (int j = 0; j < l->rows; j++) {
		struct form **by = residuals_by(l, l->states + j);
		struct form **held = derivatives_of(l, l->held, form, l->states + j);
		l->mass[j] = ARRAY(struct form *, l->rows);
		for (int i = 0; i < l->rows; i++)
			l->mass[j][i] = i < l->n ? by[i] : held[i - l->n];
	}
}

/* That of a double, or not many more than 256 bits */
static void round_value(mpq_ptr value, bool roughly)
{
	if (roughly)
		round_roughly(value, value);
	else
		round_long(value);
}

/* Where Newton's method starts: 0, or what iterates have found of those in which equations are not linear */
static void start_highest(struct linearising *l)
{
	const struct segment_equations *s = l->b->full;
	struct point *point = point_of(l);
	for (int k = 0; k < l->rows; k++) {
		mpq_ptr value = l->fixing[l->states + k].value;
		const struct form *residual = k < l->n ? s->residual[l->b->owner[k]].form : NULL;
		const struct basis highest = { .kind = BASIS_COORD, .index = k,
					       .order = l->fixing[l->states + k].order };
		mpq_set_ui(value, 0, 1);
		if (l->b->model->equations.implicit)
			value_at(l, point, residual ? form_difference(form_unit(highest), residual)
						    : s->multiplier[k - l->n], value);
	}
	point_free(point);
}

/* Highest derivatives and multipliers at the point, into their fixings; false: it does not determine them */
bool solve_highest(struct linearising *l, bool roughly)
{
	const int n = l->rows;
	int column;
	RATIONALS *A = rationals((size_t)(n * n)), *inverse = rationals((size_t)(n * n)), *b = rationals((size_t)n);
	if (!l->mass)
		derive_masses(l);
	start_highest(l);
	struct point *point = point_of(l);
	for (int i = 0; i < n; i++) {
		value_at(l, point, accelerating(l, i), b[i]);
		round_value(b[i], roughly);
		for (int j = 0; j < n; j++) {
			value_at(l, point, l->mass[j][i], A[i * n + j]);
			round_value(A[i * n + j], roughly);
		}
	}
	point_free(point);
	if (!rational_inverse(n, A, inverse, &column))
		return false;
	for (int i = 0; i < n; i++) {
		mpq_ptr value = l->fixing[l->states + i].value;
		for (int k = 0; k < n; k++)
			rational_submul(value, inverse[i * n + k], b[k]);
		round_value(value, roughly);
	}
	return true;
}

/* Accelerations that are rounding beside the multipliers' forces are 0. */
void find_highest(struct linearising *l)
{
	double force = 1;
	l->stays = true;
	if (!solve_highest(l, false))
		error(l->b->spec->name_at, l->held ? "gradients of constraints may depend on each other there" : NULL,
		      "the equations do not determine accelerations at the point where the model is linearised");
	for (int i = l->n; i < l->rows; i++)
		force = fmax(force, fabs(mpq_get_d(l->fixing[l->states + i].value)));
	for (int i = 0; i < l->n; i++) {
		mpq_ptr value = l->fixing[l->states + i].value;
		if (l->held > 0 && fabs(mpq_get_d(value)) < 1e-50 * force)
			mpq_set_ui(value, 0, 1);
		l->stays = l->stays && mpq_sgn(value) == 0;
	}
}

/* ---- kinks ---- */

static double largest_of(int count, const mpq_t *value)
{
	double largest = 0;
	for (int i = 0; i < count; i++)
		largest = fmax(largest, fabs(mpq_get_d(value[i])));
	return largest;
}

/* Of all equations by one state, a hair beside it */
static void slopes_beside(struct linearising *l, int state, mpq_srcptr hair, mpq_t *slope)
{
	mpq_add(l->state[state], l->state[state], hair);
	slopes_at(l, l->rows, NULL, state, slope);
	mpq_sub(l->state[state], l->state[state], hair);
}

void check_kinks(struct linearising *l)
{
	enum { HAIR = 80 };         /* of 2^-HAIR */
	const int n = l->rows;
	mpq_t *here = rationals((size_t)(n * l->states)), *there = rationals((size_t)n);
	RATIONAL hair = ZERO, difference = ZERO;
	for (int k = 0; k < l->states; k++)
		slopes_at(l, n, NULL, k, here + k * n);
	const double least = 1e-12 * largest_of(n * l->states, here);
	for (int k = 0; k < 2 * l->states; k++) {
		const int state = k / 2;
		mpq_set_si(hair, k % 2 ? -1 : 1, 1);
		mpq_div_2exp(hair, hair, HAIR);
		slopes_beside(l, state, hair, there);
		for (int i = 0; i < n; i++) {
			mpq_sub(difference, there[i], here[state * n + i]);
			if (fabs(mpq_get_d(difference)) > least)
				error(l->b->spec->name_at, "--at with a value on one side of it takes that side",
				      "at %s = %.6g the slope of an equation differs between the sides: it has no "
				      "linear equation there", l->b->model->names.state[state],
				      mpq_get_d(l->state[state]));
		}
	}
}
