/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a model is linearised: an equilibrium by Newton's method, whose directions are found in double and whose
 * residuals are rationals, so that each iteration gains the digits of a double. */
#include "linearise.h"
#include "state_mass.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BITS = 256, MOST_ITERATIONS = 80 };

/* ---- Newton's method ---- */

/* The pivot's row, in place `rank`, becomes 1 there, and the column 0 in all others. */
static void eliminate(int n, int wide, double *A, int rank, int row, int column)
{
	double *pivot = A + rank * wide;
	for (int j = 0; j < wide; j++) {
		const double kept = A[row * wide + j];
		A[row * wide + j] = pivot[j];
		pivot[j] = kept;
	}
	const double size = pivot[column];
	for (int j = 0; j < wide; j++)
		pivot[j] /= size;
	for (int i = 0; i < n; i++) {
		const double factor = i == rank ? 0 : A[i * wide + column];
		for (int j = 0; j < wide && factor != 0; j++)
			A[i * wide + j] -= factor * pivot[j];
	}
}

/* A of n rows and n + 1 columns to 1 in the columns `pivot`, 0 above and below, by pivots above rounding; the last
 * column takes part. Returns how many. */
static int echelon_of(int n, double *A, int *pivot)
{
	const int wide = n + 1;
	int rank = 0;
	double largest = 0;
	bool *taken = ARRAY(bool, n);
	for (int i = 0; i < n * wide; i++)
		largest = fmax(largest, i % wide < n ? fabs(A[i]) : 0);
	for (; rank < n; rank++) {
		int row = rank, best = -1;
		double size = 1e-11 * largest;
		for (int i = rank; i < n; i++)
			for (int j = 0; j < n; j++)
				if (!taken[j] && fabs(A[i * wide + j]) > size) {
					size = fabs(A[i * wide + j]);
					row = i;
					best = j;
				}
		if (best < 0)
			return rank;
		taken[pivot[rank] = best] = true;
		eliminate(n, wide, A, rank, row, best);
	}
	return rank;
}

/* Of A x = b what pivots determine; coordinates that may move together stay where they are. b: the last column */
static void solve_partly(int n, double *A, double *x)
{
	int *pivot = ARRAY(int, n), rank = echelon_of(n, A, pivot);
	memset(x, 0, sizeof *x * (size_t)n);
	for (int i = 0; i < rank; i++)
		x[pivot[i]] = A[i * (n + 1) + n];
}

static double size_of_residuals(const struct linearising *l)
{
	double size = 0;
	for (int i = 0; i < l->rows; i++)
		size = fmax(size, fabs(mpq_get_d(l->F[i])));
	return size;
}

/* Largest of |K x - b| */
static double left_of(int n, const double *K, const double *x)
{
	double largest = 0;
	for (int i = 0; i < n; i++) {
		double sum = -K[i * (n + 1) + n];
		for (int j = 0; j < n; j++)
			sum += K[i * (n + 1) + j] * x[j];
		largest = fmax(largest, fabs(sum));
	}
	return largest;
}

/* Where stiffness does not hold the forces the model falls: along its acceleration, until something holds it. Its
 * multipliers are those of the motion. */
static void fall(struct linearising *l, double *direction)
{
	double largest = 0;
	const bool solved = solve_highest(l, true);
	for (int i = 0; i < l->n; i++) {
		mpq_ptr highest = l->fixing[l->states + i].value;
		direction[i] = solved ? mpq_get_d(highest) : -mpq_get_d(l->F[i]);
		largest = fmax(largest, fabs(direction[i]));
		mpq_set_ui(highest, 0, 1);
	}
	for (int i = 0; i < l->rows; i++)
		direction[i] = i >= l->n ? 0 : largest > 0 ? direction[i] * l->fall / largest : 0;
	l->fall *= 2;
}

/* Of the residuals by each unknown, once for all points. A velocity constraint leaves positions that are reached by
 * velocities along it, so what it holds is derived by those. */
static void derive_residuals(struct linearising *l)
{
	l->slope = ARRAY(struct form **, l->rows);
	for (int j = 0; j < l->rows; j++) {
		struct form **by = residuals_by(l, j < l->n ? j : l->states + j);
		l->slope[j] = ARRAY(struct form *, l->rows);
		for (int i = 0; i < l->rows; i++)
			l->slope[j][i] = i < l->n || j >= l->n || constraint_of(l, i)->by[0] ||
							 l->b->model->system.velocity[j] < 0
						 ? by[i] : residuals_by(l, l->b->model->system.velocity[j])[i];
	}
}

/* K, and -F behind it */
static double *stiffness_at(struct linearising *l)
{
	const int n = l->rows;
	double *K = ARRAY(double, n * (n + 1));
	struct point *point = point_of(l);
	RATIONAL slope = ZERO;
	for (int j = 0; j < n; j++)
		for (int i = 0; i < n; i++) {
			value_at(l, point, l->slope[j][i], slope);
			K[i * (n + 1) + j] = mpq_get_d(slope);
		}
	for (int i = 0; i < n; i++)
		K[i * (n + 1) + n] = -mpq_get_d(l->F[i]);
	point_free(point);
	return K;
}

/* Newton's direction by a matrix of stiffness, and -F behind it; false: pivots determine only a part of it */
static bool direction_by(const struct linearising *l, const double *K, double *direction)
{
	const int n = l->rows;
	SCRATCH double *work = ARRAY(double, n * (n + 1));
	memcpy(work, K, sizeof *K * (size_t)(n * (n + 1)));
	solve_partly(n, work, direction);
	return left_of(n, K, direction) <= 1e-6 * size_of_residuals(l);
}

static double largest_of_vector(int n, const double *x)
{
	double largest = 0;
	for (int i = 0; i < n; i++)
		largest = isfinite(largest + x[i]) ? fmax(largest, fabs(x[i])) : INFINITY;
	return largest;
}

/* How far the equations are from 0 here: by the direction that Newton's method has with the stiffness at the last
 * point, which does not depend on units of equations; where it has none by the equations themselves */
static double distance(const struct linearising *l, double *K, bool solved, double *direction)
{
	const int n = l->rows;
	for (int i = 0; i < n; i++)
		K[i * (n + 1) + n] = -mpq_get_d(l->F[i]);
	if (!solved)
		return size_of_residuals(l);
	direction_by(l, K, direction);
	return largest_of_vector(n, direction);
}

/* state = from + part * direction, in BITS bits */
static void move(struct linearising *l, mpq_t *from, const double *direction, double part)
{
	REAL sum = WITH_BITS(BITS);
	RATIONAL change = ZERO;
	for (int i = 0; i < l->rows; i++) {
		mpq_set_d(change, part * direction[i]);
		mpq_add(change, change, from[i]);
		mpfr_set_q(sum, change, MPFR_RNDN);
		mpfr_get_q(unknown_of(l, i), sum);
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
	mpq_t *kept = rationals((size_t)l->rows);
	for (int i = 0; i < l->rows; i++) {
		mpq_set(kept[i], unknown_of(l, i));
		round_decimal(unknown_of(l, i));
	}
	find_residuals(l);
	if (is_equilibrium(l))
		return;
	for (int i = 0; i < l->rows; i++)
		mpq_set(unknown_of(l, i), kept[i]);
	find_residuals(l);
}

/* Less `way`, if that is an equilibrium too */
static bool move_coordinate(struct linearising *l, int coord, mpq_srcptr way)
{
	mpq_sub(l->state[coord], l->state[coord], way);
	find_residuals(l);
	if (size_of_residuals(l) < 1e-40)
		return true;
	mpq_add(l->state[coord], l->state[coord], way);
	find_residuals(l);
	return false;
}

/* To its initial value, which `way` leads from, where nothing holds it: on the way there are equilibria too */
static bool move_free(struct linearising *l, int coord, mpq_srcptr way)
{
	RATIONAL part = ZERO, rest = ZERO;
	mpq_set_d(part, 0.375);
	mpq_mul(part, part, way);
	mpq_sub(rest, way, part);
	return move_coordinate(l, coord, part) && move_coordinate(l, coord, rest);
}

/* To the initial value of what nothing holds, and whole turns towards it, where the equations are the same there */
static void move_back(struct linearising *l)
{
	REAL pi = WITH_BITS(BITS);
	RATIONAL turns = ZERO, way = ZERO;
	mpfr_const_pi(pi, MPFR_RNDN);
	for (int k = 0; k < 2 * l->n; k++) {                    /* twice: from far away turns are counted roughly */
		const int i = k % l->n;
		mpq_set(way, l->state[i]);
		if (fabs(mpq_get_d(way)) < 1e-30)
			move_coordinate(l, i, way);             /* its rounding, where another is not rational */
		mpq_sub(way, l->state[i], l->b->model->initial[i]);
		mpq_set_d(turns, 2 * ceil(mpq_get_d(way) / 6.283185307179586 - 0.5 - 1e-9)); /* -pi to pi */
		if (mpq_sgn(way) == 0 || move_free(l, i, way) || mpq_sgn(turns) == 0)
			continue;
		mpfr_get_q(way, pi);
		mpq_mul(way, way, turns);
		move_coordinate(l, i, way);
	}
}

/* Steps are halved while they do not bring the equations closer to 0. */
void find_equilibrium(struct linearising *l)
{
	SCRATCH double *direction = ARRAY(double, l->rows), *next = ARRAY(double, l->rows);
	RATIONALS *from = rationals((size_t)l->rows);
	double scale = 0, step = 0;
	for (int i = l->n; i < l->states; i++)
		mpq_set_ui(l->state[i], 0, 1);
	find_residuals(l);
	if (!l->slope)
		derive_residuals(l);
	for (int k = 0; k < MOST_ITERATIONS && !is_equilibrium(l); k++) {
		SCRATCH double *K = stiffness_at(l);
		const bool solved = direction_by(l, K, direction);
		const double before = solved ? largest_of_vector(l->rows, direction) : size_of_residuals(l);
		if (!solved)
			fall(l, direction);
		step = largest_of_vector(l->rows, direction);
		scale = 0;
		for (int i = 0; i < l->rows; i++) {
			mpq_set(from[i], unknown_of(l, i));
			scale = fmax(scale, fabs(mpq_get_d(unknown_of(l, i))));
		}
		if (step <= 1e-60 * scale || (step == 0 && scale == 0) || !isfinite(step))
			break;
		double part = 1;
		for (move(l, from, direction, part); distance(l, K, solved, next) > before && part > 1e-6; part /= 2)
			move(l, from, direction, part / 2);
	}
	if (!is_equilibrium(l)) {
		move_back(l);
		take_short(l);
	}
	if (!is_equilibrium(l) && !(step <= 1e-55 * scale && scale > 0 && step > 0))
		error(l->b->spec->name_at, "--at x=0.1 linearises at given values",
		      "no equilibrium is found from the initial values");
}

/* ---- all that are found ---- */

/* Of A x = 0, in double: a row for each direction, largest entry 1; returns how many. A gets another one. */
static int null_space(int n, double *A, double *direction)
{
	int *pivot = ARRAY(int, n), rank = echelon_of(n, A, pivot), count = 0;
	for (int free = 0; free < n; free++) {
		double *d = direction + count * n, largest = 1;
		bool is_pivot = false;
		for (int i = 0; i < rank; i++)
			is_pivot = is_pivot || pivot[i] == free;
		if (is_pivot)
			continue;
		memset(d, 0, sizeof *d * (size_t)n);
		d[free] = 1;
		for (int i = 0; i < rank; i++)
			largest = fmax(largest, fabs(d[pivot[i]] = -A[i * (n + 1) + free]));
		for (int j = 0; j < n; j++)
			d[j] /= largest;
		count++;
	}
	return count;
}

/* On the straight way between both all are equilibria too, with the multipliers there: the model is free to move. */
static bool is_known(struct linearising *l, const struct equilibrium *other)
{
	mpq_t *found = rationals((size_t)l->rows);
	double apart = 0, worst = 0;
	for (int i = 0; i < l->rows; i++)
		mpq_set(found[i], unknown_of(l, i));
	for (int i = 0; i < l->n; i++) {
		mpq_sub(l->state[i], l->state[i], other->state[i]);
		apart = fmax(apart, fabs(mpq_get_d(l->state[i])));
	}
	for (int part = 1; part < 4; part++) {          /* at 1/4, 1/2, 3/4 */
		RATIONAL weight = ZERO;
		mpq_set_ui(weight, (unsigned long)part, 4);
		for (int i = 0; i < l->n; i++) {
			mpq_sub(l->state[i], found[i], other->state[i]);
			mpq_mul(l->state[i], l->state[i], weight);
			mpq_add(l->state[i], l->state[i], other->state[i]);
		}
		if (l->held > 0)
			solve_highest(l, true);
		find_residuals(l);
		worst = fmax(worst, size_of_residuals(l));
	}
	for (int i = 0; i < l->rows; i++)
		mpq_set(unknown_of(l, i), found[i]);
	return apart < 1e-9 || worst < 1e-9 * l->scale;
}

/* The k-th of points around the initial values, in a box of a turn: Halton's sequence */
static void start_at(struct linearising *l, int k)
{
	static const int prime[] = { 2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37 };
	RATIONAL way = ZERO;
	for (int i = 0; i < l->n; i++) {
		const int base = prime[i % (int)(sizeof prime / sizeof *prime)];
		double part = 0, digit = 1;
		for (int rest = k ? k + i / 12 : 0; rest; rest /= base)
			part += rest % base * (digit /= base);
		mpq_set_d(way, k ? 6.283185307179586 * (part - 0.5) : 0);
		mpq_add(l->state[i], l->b->model->initial[i], way);
	}
	for (int i = l->n; i < l->rows; i++)
		mpq_set_ui(unknown_of(l, i), 0, 1);
}

/* A start is brought onto the constraints, where they are near. */
static void find_one(void *context)
{
	struct linearising *l = context;
	if (l->held > 0)
		meet_constraints_near(l->b, l->state, NULL, NULL);
	find_equilibrium(l);
}

/* What coordinates have of the directions along which nothing holds them and no constraint keeps them; the largest
 * entry 1 */
static void find_free(struct linearising *l, struct equilibrium *found)
{
	double *free = ARRAY(double, l->rows * l->rows);
	const int count = null_space(l->rows, stiffness_at(l), free);
	found->free = ARRAY(double, l->n * l->rows);
	for (int k = 0; k < count; k++) {
		const double *from = free + k * l->rows, largest = largest_of_vector(l->n, from);
		for (int i = 0; i < l->n && largest > 1e-9; i++)
			found->free[found->directions * l->n + i] = from[i] / largest;
		found->directions += largest > 1e-9;
	}
}

/* Whether each coordinate is between those of both, where given, but for rounding */
static bool is_between(const struct linearising *l, const mpq_t *one, const mpq_t *other)
{
	bool between = true;
	for (int i = 0; i < l->n && one; i++) {
		const double x = mpq_get_d(l->state[i]), a = mpq_get_d(one[i]), b = mpq_get_d(other[i]);
		between = between && x >= fmin(a, b) - 1e-9 && x <= fmax(a, b) + 1e-9;
	}
	return between;
}

/* From where the state is to the nearest one, which is kept where it is new, and between two others where given */
static void look_from_here(struct linearising *l, const mpq_t *one, const mpq_t *other)
{
	struct equations *e = &l->b->model->equations;
	bool known = false;
	l->fall = 1e-4;
	find_residuals(l);
	l->scale = fmax(l->scale, size_of_residuals(l));
	if (unheard_refusal_of(find_one, l) || !is_between(l, one, other))
		return;
	for (int i = 0; i < e->equilibria && !known; i++)
		known = is_known(l, &e->equilibrium[i]);
	if (known)
		return;
	struct equilibrium *found = MORE(e->equilibrium, e->equilibria);
	*found = (struct equilibrium){ .state = rationals((size_t)l->n) };
	for (int i = 0; i < l->n; i++)
		mpq_set(found->state[i], l->state[i]);
	find_free(l, found);
}

/* A part of the way from one to the other: what is stable has an unstable one between, however near they are */
static void start_between(struct linearising *l, int one, int other, double part)
{
	const struct equilibrium *found = l->b->model->equations.equilibrium;
	RATIONAL way = ZERO, weight = ZERO;
	mpq_set_d(weight, part);
	for (int i = 0; i < l->n; i++) {
		mpq_sub(way, found[other].state[i], found[one].state[i]);
		mpq_mul(way, way, weight);
		mpq_add(l->state[i], found[one].state[i], way);
	}
	for (int i = l->n; i < l->rows; i++)
		mpq_set_ui(unknown_of(l, i), 0, 1);
}

void find_equilibria(struct linearising *l)
{
	static const double part[] = { 0.5, 0.3125, 0.6875 };
	struct equations *e = &l->b->model->equations;
	int between = 0;
	for (int most = l->n < 5 ? 32 : 12; e->starts == 0 || (e->starts < most && memory_used() < 0.3); e->starts++) {
		start_at(l, e->starts);
		look_from_here(l, NULL, NULL);
	}
	for (int i = 1; i < e->equilibria && l->n < 5; i++)
		for (int k = 0; k < 3 * i && between < 24 && memory_used() < 0.3; k++) {
			const struct equilibrium one = e->equilibrium[k / 3], other = e->equilibrium[i];
			if (one.directions + other.directions > 0)
				continue;       /* of a row of equilibria any is between two of its others */
			between++;
			start_between(l, k / 3, i, part[k % 3]);
			look_from_here(l, one.state, other.state);
		}
}

/* ---- symmetry ---- */

/* Any values of coordinates, velocities and highest derivatives: multiples of the golden ratio, less whole numbers */
static void start_anywhere(struct linearising *l, int which)
{
	for (int i = 0; i < l->states + l->rows; i++) {
		const double part = (which * (l->states + l->rows) + i + 1) * 0.6180339887498949;
		mpq_set_d(i < l->states ? l->state[i] : l->fixing[i].value, part - floor(part) + 0.1);
	}
}

/* dF/dq d = 0, and constraints keep d, at a few points, in general position: A is the sum of K^T K at these, d its
 * null space */
void find_free_directions(struct linearising *l)
{
	enum { POINTS = 3 };
	struct equations *e = &l->b->model->equations;
	const int n = l->n, wide = n + 1;
	double *A = ARRAY(double, n * wide), *free = ARRAY(double, n * n);
	derive_residuals(l);
	for (int point = 0; point < POINTS; point++) {
		start_anywhere(l, point);
		const double *K = stiffness_at(l);
		for (int i = 0; i < n; i++)
			for (int j = 0; j < n; j++)
				for (int k = 0; k < l->rows; k++)
					A[i * wide + j] += K[k * (l->rows + 1) + i] * K[k * (l->rows + 1) + j];
	}
	e->directions = null_space(n, A, free);
	e->free = free;
}
