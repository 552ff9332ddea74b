/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * From a time on all functions of time are constant: then M q'' + C q' + K q = g + forcing terms with constant
 * matrices, and a step is e^{A h} of x = [q, q', 1, cos and sin of each forcing term]. It is taken over [omega eta,
 * eta', 1, ...], whose matrix has entries of the size of 1, where that over coordinates has frequencies for entries.
 */
#include "inner.h"

enum { ENTRY_BITS = 640 };

/* X += by Y */
static void add_multiple(size_t cells, mpq_t *X, mpq_srcptr by, const mpq_t *Y)
{
	for (size_t i = 0; i < cells && Y; i++)
		rational_addmul(X[i], by, Y[i]);
}

int steady_size(const struct model *model)
{
	return 2 * model->n + 1 + 2 * model->remainder.split->forcings;
}

/* Rows of the forcing terms: (a + i w) (cos + i sin); their forces, as columns of the accelerations */
static void add_forcings(const struct model *model, mpq_t *A, const mpq_t *inverse)
{
	int n = model->n, size = steady_size(model);
	for (int k = 0; k < model->remainder.split->forcings; k++) {
		const struct forcing_force *own = &model->remainder.split->forcing[k];
		int c = 2 * n + 1 + 2 * k, s = c + 1;
		mpq_set(A[c * size + c], own->forcing->a);
		mpq_set(A[s * size + s], own->forcing->a);
		mpq_set(A[s * size + c], own->forcing->w);
		mpq_neg(A[c * size + s], own->forcing->w);
		for (int i = 0; i < 2 * n * n; i++) {
			mpq_ptr entry = A[(n + i / 2 / n) * size + c + i % 2];
			rational_addmul(entry, inverse[i / 2], own->force[i % 2][i / 2 % n]);
		}
	}
}

/* A of [q, q', 1, forcing terms], by the first operator and its remainder at the end */
static mpq_t *last_matrix(const struct model *model, const mpq_t *M, const mpq_t *C, const mpq_t *K)
{
	int n = model->n, size = steady_size(model), column;
	size_t cells = (size_t)n * (size_t)n;
	const struct splitting *split = model->remainder.split;
	mpq_t *inverse = rationals(cells), *of[3] = { rationals(cells), rationals(cells), rationals(n) };
	mpq_t *A = rationals((size_t)size * (size_t)size);
	RATIONAL minus = RATIO(-1, 1);
	add_multiple(cells, of[0], minus, K);
	add_multiple(cells, of[1], minus, C);
	for (int f = 0; f < split->functions; f++) {
		const struct time_function *function = &split->function[f];
		add_multiple(cells, of[0], function->last, function->position);
		add_multiple(cells, of[1], function->last, function->velocity);
		add_multiple((size_t)n, of[2], function->last, function->force);
	}
	rational_inverse(n, M, inverse, &column);
	for (int i = 0; i < n; i++) {
		mpq_set_ui(A[i * size + n + i], 1, 1);
		for (int d = 0; d < 3; d++)
			for (int j = 0; j < (d < 2 ? n : 1); j++)
				for (int k = 0; k < n; k++) {
					mpq_ptr entry = A[(n + i) * size + d * n + j];
					if (mpq_sgn(inverse[i * n + k]) == 0)
						continue;
					rational_addmul(entry, inverse[i * n + k], of[d][k * (d < 2 ? n : 1) + j]);
				}
	}
	add_forcings(model, A, inverse);
	return A;
}

/* Z <- X Y, of rows x inner and inner x columns */
static void real_product(int rows, int inner, int columns, mpfr_t *X, mpfr_t *Y, mpfr_t *Z)
{
	REAL part = WITH_BITS(ENTRY_BITS);
	for (int i = 0; i < rows; i++)
		for (int j = 0; j < columns; j++) {
			mpfr_set_zero(Z[i * columns + j], 1);
			for (int k = 0; k < inner; k++) {
				if (mpfr_zero_p(X[i * inner + k]) || mpfr_zero_p(Y[k * columns + j]))
					continue;
				mpfr_mul(part, X[i * inner + k], Y[k * columns + j], MPFR_RNDN);
				mpfr_add(Z[i * columns + j], Z[i * columns + j], part, MPFR_RNDN);
			}
		}
}

/* [V^T M, 0, 0; 0, V^T M, 0; 0, 0, I], its first rows times omega; or what undoes that */
static mpfr_t *transform(const struct model *model, const mpq_t *M, const struct eigenpairs *pairs, mpfr_t *omega,
			 bool back)
{
	int n = model->n, size = steady_size(model);
	mpfr_t *T = reals((size_t)size * (size_t)size, ENTRY_BITS);
	REAL part = WITH_BITS(ENTRY_BITS);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			mpfr_ptr of_q = T[i * size + j], of_rate = T[(n + i) * size + n + j];
			for (int k = 0; k < n && !back; k++) {
				mpfr_mul_q(part, pairs->vector[k * n + i], M[k * n + j], MPFR_RNDN);
				mpfr_add(of_rate, of_rate, part, MPFR_RNDN);
			}
			if (back)
				mpfr_set(of_rate, pairs->vector[i * n + j], MPFR_RNDN);
			if (back)
				mpfr_div(of_q, of_rate, omega[j], MPFR_RNDN);
			else
				mpfr_mul(of_q, of_rate, omega[i], MPFR_RNDN);
		}
	for (int i = 2 * n; i < size; i++)
		mpfr_set_ui(T[i * size + i], 1, MPFR_RNDN);
	return T;
}

mpfr_t *steady_matrix(const struct model *model, const mpq_t *M, const mpq_t *C, const mpq_t *K,
		       const struct eigenpairs *pairs, mpfr_t *omega)
{
	int size = steady_size(model);
	size_t cells = (size_t)size * (size_t)size;
	struct taylor *taylor = taylor_of(size, last_matrix(model, M, C, K), model->h);
	mpfr_t *Phi = reals(cells, ENTRY_BITS), *half = reals(cells, ENTRY_BITS);
	INTERVAL entry = OVER_BITS(ENTRY_BITS);
	if (!taylor_enclose(taylor, ENTRY_BITS))
		error(model->request.at.step, NULL, "the step is too long for the model's fastest mode");
	for (int i = 0; i < size; i++)
		for (int j = 0; j < size; j++) {
			taylor_entry(taylor, i, j, entry);
			mpfi_get_fr(Phi[i * size + j], entry);
		}
	real_product(size, size, size, transform(model, M, pairs, omega, false), Phi, half);
	real_product(size, size, size, half, transform(model, M, pairs, omega, true), Phi);
	return Phi;
}
