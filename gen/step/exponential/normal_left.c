/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The remainder, in normal modes: V^T times matrices times V, times functions of time. Matrices that are multiples
 * of each other are one. */
#include "inner.h"

#include <math.h>

enum { NOTHING = 160 };             /* below 2^-160 of the largest in its matrix, an entry counts as 0 */

double round_real(mpfr_srcptr x)
{
	RATIONAL q = ZERO;
	mpfr_get_q(q, x);
	return round_rational(q);
}

mpq_t *by_coordinates(const struct model *model, const mpq_t *matrix)
{
	int n = model->n;
	mpq_t *sorted = rationals((size_t)n * (size_t)n);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			mpq_set(sorted[i * n + j], matrix[model->equations.owner[i] * n + j]);
	return sorted;
}

/* ---- matrices in modes ---- */

/* value <- V^T X V */
static void project(const struct normal_work *w, int schedule, const mpq_t *X, double *value)
{
	int n = w->model->n;
	size_t cells = (size_t)n * (size_t)n;
	const struct eigenpairs *pairs = &w->pairs[schedule];
	int precision = (int)mpfr_get_prec(pairs->value[0]);
	REALS *XV = reals(cells, precision), *made = reals(cells, precision);
	REAL part = WITH_BITS(precision), largest = WITH_BITS(precision);
	mpfr_set_zero(largest, 1);
	for (int i = 0; i < n; i++)
		for (int k = 0; k < n; k++)
			for (int j = 0; j < n && mpq_sgn(X[i * n + k]) != 0; j++) {
				mpfr_mul_q(part, pairs->vector[k * n + j], X[i * n + k], MPFR_RNDN);
				mpfr_add(XV[i * n + j], XV[i * n + j], part, MPFR_RNDN);
			}
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			for (int k = 0; k < n; k++) {
				mpfr_mul(part, pairs->vector[k * n + i], XV[k * n + j], MPFR_RNDN);
				mpfr_add(made[i * n + j], made[i * n + j], part, MPFR_RNDN);
			}
			if (mpfr_cmpabs(made[i * n + j], largest) > 0)
				mpfr_abs(largest, made[i * n + j], MPFR_RNDN);
		}
	mpfr_div_2ui(largest, largest, NOTHING, MPFR_RNDN);
	for (size_t i = 0; i < cells; i++)
		value[i] = mpfr_cmpabs(made[i], largest) <= 0 ? 0 : round_real(made[i]);
}

void find_transforms(struct normal_work *w)
{
	struct normal *normal = w->normal;
	int n = normal->modes;
	size_t cells = (size_t)n * (size_t)n;
	normal->to = ARRAY(double, (size_t)normal->operators * cells);
	normal->from = ARRAY(double, (size_t)normal->operators * cells);
	normal->frequency = ARRAY(double, (size_t)(normal->operators * n));
	normal->ratio = ARRAY(double, (size_t)(normal->operators * n));
	for (int b = 0; b < normal->operators; b++) {
		const struct eigenpairs *pairs = &w->pairs[b];
		REAL sum = WITH_BITS(mpfr_get_prec(pairs->value[0])), part = WITH_BITS(mpfr_get_prec(pairs->value[0]));
		for (int i = 0; i < n; i++)
			for (int j = 0; j < n; j++) {
				normal->from[(b * n + i) * n + j] = round_real(pairs->vector[i * n + j]);
				mpfr_set_zero(sum, 1);          /* entry (j, i) of V^T M */
				for (int k = 0; k < n; k++) {
					mpfr_mul_q(part, pairs->vector[k * n + j], w->M[k * n + i], MPFR_RNDN);
					mpfr_add(sum, sum, part, MPFR_RNDN);
				}
				normal->to[(b * n + j) * n + i] = round_real(sum);
			}
		for (int j = 0; j < n; j++) {
			const struct normal_mode *mode = &w->mode[b * n + j];
			double lambda = mpfr_get_d(mode->lambda, MPFR_RNDN);
			normal->frequency[b * n + j] = lambda > 0 ? sqrt(lambda) : 0;
			normal->ratio[b * n + j] =
				lambda > 0 ? mpfr_get_d(mode->delta, MPFR_RNDN) / sqrt(lambda) : 0;
		}
	}
}

/* From the modes of an operator to those of the next, without the way over coordinates: there what a slow mode has
 * would leave its rounding in fast ones, times their frequency in their rates. */
void find_turns(struct normal_work *w)
{
	struct normal *normal = w->normal;
	int n = normal->modes, width = normal->width;
	REALS *MV = reals((size_t)n * (size_t)n, NORMAL_BITS);
	REAL sum = WITH_BITS(NORMAL_BITS), part = WITH_BITS(NORMAL_BITS);
	normal->turn = ARRAY(double, (size_t)(normal->operators * width * width));
	for (int b = 0; b + 1 < normal->operators; b++) {
		for (int i = 0; i < n * n; i++) {
			mpfr_set_zero(MV[i], 1);
			for (int k = 0; k < n; k++) {
				mpfr_mul_q(part, w->pairs[b].vector[k * n + i % n], w->M[i / n * n + k], MPFR_RNDN);
				mpfr_add(MV[i], MV[i], part, MPFR_RNDN);
			}
		}
		for (int i = 0; i < n * n; i++) {
			mpfr_set_si(sum, i / n == i % n ? -1 : 0, MPFR_RNDN);
			for (int k = 0; k < n; k++) {
				mpfr_mul(part, w->pairs[b + 1].vector[k * n + i / n], MV[k * n + i % n], MPFR_RNDN);
				mpfr_add(sum, sum, part, MPFR_RNDN);
			}
			if (!mpfr_zero_p(sum) && mpfr_get_exp(sum) > -NOTHING)
				normal->turn[(b * width + normal->place[i / n]) * width + normal->place[i % n]] =
					round_real(sum);
		}
	}
}

/* ---- the remainder ---- */

struct pattern {                    /* of a matrix, as rationals */
	const mpq_t **exact;        /* per schedule */
	bool own;                   /* it differs from schedule to schedule */
};
struct pattern_list {
	int count;
	struct pattern *pattern;
};

static void add_matrix_term(struct normal *normal, int matrix, int function, bool velocity, double *factor)
{
	struct normal_matrix *m = &normal->matrix[matrix];
	*MORE(m->term, m->terms) = (struct normal_term){ .function = function, .velocity = velocity, .factor = factor };
}

static int new_pattern(struct normal *normal, struct pattern_list *list, struct pattern pattern)
{
	ENLARGE(list->pattern, (size_t)list->count + 1);
	ENLARGE(normal->matrix, (size_t)list->count + 1);
	list->pattern[list->count] = pattern;
	normal->matrix[list->count] = (struct normal_matrix){ 0 };
	normal->matrices = list->count + 1;
	return list->count++;
}

/* Per schedule the factor by which X[schedule] is a multiple of this; NULL: of some it is none */
static double *multiples_of(const struct normal_work *w, const struct pattern *pattern, const mpq_t **X)
{
	size_t cells = (size_t)w->model->n * (size_t)w->model->n;
	double *factor = ARRAY(double, w->normal->operators);
	RATIONAL ratio = ZERO;
	bool all = !pattern->own;
	for (int b = 0; b < w->normal->operators && all; b++) {
		all = rationals_multiple(cells, X[b], pattern->exact[b], ratio);
		factor[b] = all ? round_rational(ratio) : 0;
	}
	return all ? factor : NULL;
}

/* The matrix of one function, on coordinates or velocities, in each schedule */
static void add_matrix(struct normal_work *w, struct pattern_list *list, int function, bool velocity, const mpq_t **X)
{
	size_t cells = (size_t)w->model->n * (size_t)w->model->n;
	struct pattern made = { .exact = X };
	bool any = false;
	for (int b = 0; b < w->normal->operators; b++) {
		any = any || !rationals_zero(cells, X[b]);
		for (size_t i = 0; i < cells && !made.own; i++)
			made.own = !mpq_equal(X[b][i], X[0][i]);
	}
	for (int k = 0; k < list->count && any; k++) {
		double *factor = multiples_of(w, &list->pattern[k], X);
		if (factor) {
			add_matrix_term(w->normal, k, function, velocity, factor);
			return;
		}
	}
	if (!any)
		return;
	double *factor = ARRAY(double, w->normal->operators);
	for (int b = 0; b < w->normal->operators; b++)
		factor[b] = 1;
	add_matrix_term(w->normal, new_pattern(w->normal, list, made), function, velocity, factor);
}

static const mpq_t **same_in_all(const struct normal_work *w, const mpq_t *X)
{
	const mpq_t **all = ARRAY(const mpq_t *, w->normal->operators);
	for (int b = 0; b < w->normal->operators; b++)
		all[b] = X;
	return all;
}

/* Of the constant function: what the operator of each schedule has beyond that of the first is added */
static const mpq_t **constant_matrices(const struct normal_work *w, const mpq_t *first, bool velocity)
{
	const mpq_t **all = ARRAY(const mpq_t *, w->normal->operators);
	const struct operator *operator = w->model->schedule.operator;
	int n = w->model->n;
	for (int b = 0; b < w->normal->operators; b++) {
		mpq_t *X = by_coordinates(w->model, (velocity ? operator[b].C : operator[b].K));
		mpq_t *base = by_coordinates(w->model, (velocity ? operator[0].C : operator[0].K));
		for (int i = 0; i < n * n; i++) {
			mpq_sub(X[i], X[i], base[i]);
			if (first)
				mpq_add(X[i], X[i], first[i]);
		}
		all[b] = X;
	}
	return all;
}

void find_matrices(struct normal_work *w)
{
	const struct splitting *split = w->model->remainder.split;
	struct normal *normal = w->normal;
	struct pattern_list list = { 0 };
	size_t cells = (size_t)normal->modes * (size_t)normal->modes;
	for (int f = 1; f < split->functions; f++) {
		const struct time_function *function = &split->function[f];
		if (function->position)
			add_matrix(w, &list, f, false, same_in_all(w, function->position));
		if (function->velocity)
			add_matrix(w, &list, f, true, same_in_all(w, function->velocity));
	}
	const struct time_function *one = &split->function[0];
	add_matrix(w, &list, 0, false, constant_matrices(w, one->position, false));
	add_matrix(w, &list, 0, true, constant_matrices(w, one->velocity, true));
	for (int k = 0; k < list.count; k++) {
		normal->matrix[k].value = ARRAY(double, (size_t)normal->operators * cells);
		for (int b = 0; b < normal->operators; b++)
			project(w, b, list.pattern[k].exact[b], normal->matrix[k].value + (size_t)b * cells);
	}
}

void find_forces(struct normal_work *w)
{
	const struct splitting *split = w->model->remainder.split;
	struct normal *normal = w->normal;
	int n = normal->modes;
	normal->force = ARRAY(double *, split->functions);
	for (int f = 0; f < split->functions; f++) {
		if (!split->function[f].force)
			continue;
		normal->force[f] = ARRAY(double, (size_t)(normal->operators * normal->width));
		for (int b = 0; b < normal->operators; b++)
			for (int j = 0; j < n; j++) {
				REAL sum = WITH_BITS(mpfr_get_prec(w->pairs[b].value[0])),
				     part = WITH_BITS(mpfr_get_prec(w->pairs[b].value[0]));
				mpfr_set_zero(sum, 1);
				for (int i = 0; i < n; i++) {
					mpfr_mul_q(part, w->pairs[b].vector[i * n + j], split->function[f].force[i],
						   MPFR_RNDN);
					mpfr_add(sum, sum, part, MPFR_RNDN);
				}
				normal->force[f][b * normal->width + normal->place[j]] = round_real(sum);
			}
	}
}
