/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a model is linearised: an equilibrium by Newton's method, whose directions are found in double and whose
 * residuals are rationals, so that each iteration gains the digits of a double; the slopes of equations there. */
#include "linearise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BITS = 256, MOST_ITERATIONS = 80 };

/* ---- the point ---- */

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

/* The first `states` fixings are the states, the next n the highest derivatives. */
void list_fixings(struct linearising *l)
{
	const struct model *model = l->b->model;
	for (int i = 0; i < l->states; i++) {
		const int coord = model->system.coord[i];
		add_fixing(l, model->frame.coord[coord], coord, state_order(l, i));
	}
	for (int i = 0; i < l->n; i++)
		add_fixing(l, model->frame.coord[i], i, model->system.velocity[i] < 0 ? 1 : 2);
	for (int i = 0; i < l->inputs; i++)
		for (int order = 0; order < 2; order++)
			add_fixing(l, l->input[i], i, order);
	add_fixing(l, NULL, 0, 0);
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
	const struct form *there = form_at(point, form);
	if (!is_constant(there))
		error(l->b->spec->name_at, NULL, "a term has no value at the point where the model is linearised");
	constant_value(&l->b->collector, there, value);
}

void find_residuals(struct linearising *l)
{
	struct point *point;
	for (int i = 0; i < l->n; i++)
		mpq_set_ui(l->fixing[l->states + i].value, 0, 1);
	point = point_of(l);
	for (int i = 0; i < l->n; i++)
		value_at(l, point, l->residual[i], l->F[i]);
}

bool is_equilibrium(const struct linearising *l)
{
	for (int i = 0; i < l->n; i++)
		if (mpq_sgn(l->F[i]) != 0)
			return false;
	return true;
}

void find_highest(struct linearising *l)
{
	const struct linear *system = &l->b->model->system;
	mpq_t *inverse = inverse_of_leading(system);
	for (int i = 0; i < l->n; i++) {
		mpq_ptr sum = l->fixing[l->states + i].value;
		mpq_set_ui(sum, 0, 1);
		for (int k = 0; k < l->n; k++)
			rational_addmul(sum, inverse[i * l->n + k], l->F[k]);
		mpq_neg(sum, sum);
	}
}

/* ---- derivatives ---- */

void slopes_at(struct linearising *l, int count, const struct form *const *form, int fixing, mpq_t *slope)
{
	const struct fixing *f = &l->fixing[fixing];
	struct form **by = form_derivatives(&l->b->collector, count, form, f->symbol->kind == SYMBOL_INPUT, f->coord,
					    f->order);
	struct point *point = point_of(l);
	for (int i = 0; i < count; i++)
		value_at(l, point, by[i], slope[i]);
	if (!l->looks)
		return;
	struct point *always = point_new(&l->b->collector, l->fixings - 1, l->fixing);
	point_at_values(always);
	for (int i = 0; i < count; i++)
		l->varies = l->varies || !is_constant(form_at(always, by[i]));
}

/* ---- Newton's method ---- */

/* Of A x = b what pivots above rounding determine; coordinates that may move together stay where they are. */
static void solve_partly(int n, double *A, double *b, double *x)
{
	int *column = ARRAY(int, n), rank = 0;
	double largest = 0;
	for (int i = 0; i < n * n; i++)
		largest = fmax(largest, fabs(A[i]));
	for (int i = 0; i < n; i++)
		column[i] = i;
	for (; rank < n; rank++) {
		int row = rank, best = rank;
		for (int i = rank; i < n; i++)
			for (int j = rank; j < n; j++)
				if (fabs(A[i * n + column[j]]) > fabs(A[row * n + column[best]])) {
					row = i;
					best = j;
				}
		if (fabs(A[row * n + column[best]]) <= 1e-11 * largest)
			break;
		for (int j = 0; j < n; j++) {
			const double kept = A[row * n + j];
			A[row * n + j] = A[rank * n + j];
			A[rank * n + j] = kept;
		}
		const double side = b[row];
		const int taken = column[best];
		b[row] = b[rank];
		b[rank] = side;
		column[best] = column[rank];
		column[rank] = taken;
		for (int i = rank + 1; i < n; i++) {
			const double factor = A[i * n + taken] / A[rank * n + taken];
			for (int j = 0; j < n; j++)
				A[i * n + j] -= factor * A[rank * n + j];
			b[i] -= factor * b[rank];
		}
	}
	memset(x, 0, sizeof *x * (size_t)n);
	for (int i = rank - 1; i >= 0; i--) {
		double sum = b[i];
		for (int j = i + 1; j < rank; j++)
			sum -= A[i * n + column[j]] * x[column[j]];
		x[column[i]] = sum / A[i * n + column[i]];
	}
}

static double size_of_residuals(const struct linearising *l)
{
	double size = 0;
	for (int i = 0; i < l->n; i++)
		size = fmax(size, fabs(mpq_get_d(l->F[i])));
	return size;
}

/* Largest of |K x + F| */
static double left_of(const struct linearising *l, const double *K, const double *x)
{
	double largest = 0;
	for (int i = 0; i < l->n; i++) {
		double sum = mpq_get_d(l->F[i]);
		for (int j = 0; j < l->n; j++)
			sum += K[i * l->n + j] * x[j];
		largest = fmax(largest, fabs(sum));
	}
	return largest;
}

/* Where stiffness does not hold the forces the model falls: along its acceleration, until something holds it. */
static void fall(struct linearising *l, double *direction)
{
	double largest = 0;
	find_highest(l);
	for (int i = 0; i < l->n; i++) {
		direction[i] = mpq_get_d(l->fixing[l->states + i].value);
		largest = fmax(largest, fabs(direction[i]));
	}
	for (int i = 0; i < l->n; i++)
		direction[i] *= largest > 0 ? l->fall / largest : 0;
	l->fall *= 2;
}

static void find_direction(struct linearising *l, double *direction)
{
	const int n = l->n;
	double *K = ARRAY(double, n * n), *work = ARRAY(double, n * n), *b = ARRAY(double, n);
	RATIONALS *slope = rationals((size_t)n);
	for (int j = 0; j < n; j++) {
		slopes_at(l, n, l->residual, j, slope);
		for (int i = 0; i < n; i++)
			K[i * n + j] = mpq_get_d(slope[i]);
	}
	for (int i = 0; i < n; i++)
		b[i] = -mpq_get_d(l->F[i]);
	memcpy(work, K, sizeof *K * (size_t)(n * n));
	solve_partly(n, work, b, direction);
	if (left_of(l, K, direction) > 1e-6 * size_of_residuals(l))
		fall(l, direction);
}

/* state = from + part * direction, in BITS bits */
static void move(struct linearising *l, mpq_t *from, const double *direction, double part)
{
	REAL sum = WITH_BITS(BITS);
	RATIONAL change = ZERO;
	for (int i = 0; i < l->n; i++) {
		mpq_set_d(change, part * direction[i]);
		mpq_add(change, change, from[i]);
		mpfr_set_q(sum, change, MPFR_RNDN);
		mpfr_get_q(l->state[i], sum);
	}
	find_residuals(l);
}

/* To 15 significant digits; what is below 1e-30 to 0 */
static void round_decimal(mpq_ptr value)
{
	enum { DIGITS = 15 };
	const double size = fabs(mpq_get_d(value));
	const int places = size < 1e-30 ? 0 : DIGITS - 1 - (int)floor(log10(size));
	RATIONAL power = ZERO, half = ZERO;
	INTEGER full = INTEGER_ZERO;
	mpz_ui_pow_ui(mpq_numref(power), 10, (unsigned long)abs(places));
	mpq_set_ui(half, 1, 2);
	(places < 0 ? mpq_div : mpq_mul)(value, value, power);
	mpq_add(value, value, half);
	mpz_fdiv_q(full, mpq_numref(value), mpq_denref(value));
	mpq_set_z(value, full);
	(places < 0 ? mpq_mul : mpq_div)(value, value, power);
}

/* Where a value of 15 digits is an equilibrium exactly, it is meant: 0, -0.0327. */
static void take_short(struct linearising *l)
{
	mpq_t *kept = rationals((size_t)l->n);
	for (int i = 0; i < l->n; i++) {
		mpq_set(kept[i], l->state[i]);
		round_decimal(l->state[i]);
	}
	find_residuals(l);
	if (is_equilibrium(l))
		return;
	for (int i = 0; i < l->n; i++)
		mpq_set(l->state[i], kept[i]);
	find_residuals(l);
}

/* Steps are halved while they do not bring the equations closer to 0. */
void find_equilibrium(struct linearising *l)
{
	double *direction = ARRAY(double, l->n), size, scale = 0, step = 0;
	mpq_t *from = rationals((size_t)l->n);
	for (int i = l->n; i < l->states; i++)
		mpq_set_ui(l->state[i], 0, 1);
	find_residuals(l);
	for (int k = 0; k < MOST_ITERATIONS && !is_equilibrium(l); k++) {
		size = size_of_residuals(l);
		find_direction(l, direction);
		step = scale = 0;
		for (int i = 0; i < l->n; i++) {
			mpq_set(from[i], l->state[i]);
			step = fmax(step, fabs(direction[i]));
			scale = fmax(scale, fabs(mpq_get_d(l->state[i])));
		}
		if (step <= 1e-60 * scale || (step == 0 && scale == 0))
			break;
		double part = 1;
		for (move(l, from, direction, part); size_of_residuals(l) > size && part > 1e-6; part /= 2)
			move(l, from, direction, part / 2);
	}
	if (!is_equilibrium(l))
		take_short(l);
	if (!is_equilibrium(l) && !(step <= 1e-55 * scale && scale > 0 && step > 0))
		error(l->b->spec->name_at, "--at x=0.1 linearises at given values",
		      "no equilibrium is found from the initial values");
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
	slopes_at(l, l->n, l->residual, state, slope);
	mpq_sub(l->state[state], l->state[state], hair);
}

void check_kinks(struct linearising *l)
{
	enum { HAIR = 80 };         /* of 2^-HAIR */
	const int n = l->n;
	mpq_t *here = rationals((size_t)(n * l->states)), *there = rationals((size_t)n);
	RATIONAL hair = ZERO, difference = ZERO;
	for (int k = 0; k < l->states; k++)
		slopes_at(l, n, l->residual, k, here + k * n);
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
