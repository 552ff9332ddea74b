/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The modes of a linear model and what each of them gives to the outputs. Where M^-1 C has the invariant subspaces of
 * M^-1 K, which it has if both commute (Caughey and O'Kelly 1965), modes are coordinates, m'' + c m' + lambda m =
 * force; else they are those of the state matrix. Sizes are sums of |residues| in double precision: to choose by and to
 * tell.
 */
#include "inner.h"
#include "model/capability.h"

#include <math.h>
#include <stdlib.h>

enum { MODE_BITS = 128 };           /* of the numbers that a model of modes is made of */
#define PERHAPS_RIGID 1e-9          /* of the largest pole's square: whether it is 0 is found in more digits */

/* ---- which matrix ---- */

static bool commute(int n, const mpq_t *A, const mpq_t *B)
{
	const size_t cells = (size_t)n * (size_t)n;
	RATIONALS *AB = rationals(cells), *BA = rationals(cells);
	rational_product(n, n, n, A, B, AB);
	rational_product(n, n, n, B, A, BA);
	return rationals_equal(cells, AB, BA);
}

static bool all_real(const struct invariants *of)
{
	for (int p = 0; p < invariants_count(of); p++)
		if (!invariant_part(of, p)->real)
			return false;
	return true;
}

/* false: coordinates do not have modes of their own */
static bool take_coordinates(struct mode_basis *basis, const struct linear *system)
{
	const int n = system->n;
	const size_t cells = (size_t)n * (size_t)n;
	if (system->states < 2 * n)             /* some are of first order */
		return false;
	basis->A = rationals(cells);
	basis->D = rationals(cells);
	rational_product(n, n, n, basis->inverse, system->K, basis->A);
	rational_product(n, n, n, basis->inverse, system->C, basis->D);
	if (!rationals_zero(cells, basis->D) && !commute(n, basis->A, basis->D))
		return false;
	if (rational_symmetric(n, system->M) && rational_symmetric(n, system->K))
		basis->invariants = invariants_symmetric(n, basis->A, system->M, system->K);
	if (!basis->invariants)
		basis->invariants = invariants_of(n, basis->A, n);
	basis->moves = basis->invariants && all_real(basis->invariants);
	return basis->moves;
}

static struct mode_basis *basis_of(const struct linear *system)
{
	struct mode_basis *basis = NEW(struct mode_basis);
	basis->inverse = inverse_of_leading(system);
	if (take_coordinates(basis, system))
		return basis;
	basis->A = state_matrix(system, false);
	basis->invariants = invariants_of(system->states, basis->A, system->n);
	return basis->invariants ? basis : NULL;
}

/* ---- shares ---- */

static void find_shares(struct modes *modes)
{
	const int outputs = modes->model->outputs, inputs = modes->model->system.inputs;
	for (int o = 0; o < outputs; o++)
		for (int e = 0; e <= inputs; e++) {
			double sum = 0;
			for (int i = 0; i < modes->count; i++) {
				const struct mode *mode = &modes->mode[i];
				const double part = e ? mode->by_input[o * inputs + e - 1] : mode->size[o];
				sum += isinf(part) ? 0 : part;
			}
			for (int i = 0; i < modes->count; i++) {
				struct mode *mode = &modes->mode[i];
				const double part = e ? mode->by_input[o * inputs + e - 1] : mode->size[o];
				const double share = part == 0 ? 0 : isinf(part) ? HUGE_VAL : part / sum;
				mode->share = share > mode->share ? share : mode->share;
			}
		}
}

int *modes_by_share(const struct modes *modes)
{
	int *order = ARRAY(int, modes->count + 1);
	for (int i = 0; i < modes->count; i++) {
		int at = i;
		for (; at > 0; at--) {
			const struct mode *a = &modes->mode[order[at - 1]], *b = &modes->mode[i];
			const bool first = a->rigid && a->seen, second = b->rigid && b->seen;
			if (first > second || (first == second && a->share >= b->share))
				break;
			order[at] = order[at - 1];
		}
		order[at] = i;
	}
	return order;
}

/* ---- the whole ---- */

static double largest_eigenvalue(const struct mode_basis *basis)
{
	double largest = 0;
	for (int i = 0; i < invariants_count(basis->invariants); i++) {
		const struct invariant *part = invariant_part(basis->invariants, i);
		largest = fmax(largest, hypot(part->re, part->im));
	}
	return largest;
}

/* To the nearest of so many bits as modes have */
static void round_to_bits(mpq_ptr q)
{
	REAL x = WITH_BITS(MODE_BITS);
	mpfr_set_q(x, q, MPFR_RNDN);
	mpfr_get_q(q, x);
}

static void clear_small(int count, mpq_t *x, int stride)
{
	double largest = 0;
	for (int i = 0; i < count; i++)
		largest = fmax(largest, fabs(nearest_double(x[i * stride])));
	for (int i = 0; i < count; i++)
		if (fabs(nearest_double(x[i * stride])) <= 1e-30 * largest)
			mpq_set_ui(x[i * stride], 0, 1);
		else
			round_to_bits(x[i * stride]);
}

/* Of two poles 0: 1 in the largest coordinate, in which the second state has no part */
static void make_unit(int states, int coords, mpq_t *left, mpq_t *right)
{
	int at = 0;
	RATIONAL scale = ZERO, part = ZERO;
	for (int i = 1; i < coords; i++)
		if (fabs(nearest_double(right[2 * i])) > fabs(nearest_double(right[2 * at])) * (1 + 1e-9))
			at = i;
	mpq_set(scale, right[2 * at]);
	for (int i = 0; i < 2 * states && mpq_sgn(scale) != 0; i++) {
		mpq_div(right[i], right[i], scale);
		mpq_mul(left[i], left[i], scale);
	}
	mpq_set(part, right[2 * at + 1]);
	for (int i = 0; i < states && mpq_sgn(scale) != 0; i++) {
		rational_submul(right[2 * i + 1], part, right[2 * i]);
		rational_addmul(left[i], part, left[states + i]);
	}
	for (int i = 0; i < 2; i++) {
		clear_small(states, right + i, 2);
		clear_small(states, left + i * states, 1);
	}
}

/* Two poles 0 with one eigenvector: z becomes (z_i, row i of the block times z), i the larger row, whose derivatives
 * are exactly the second and 0. */
static void straighten(struct mode *mode, int states, int coords)
{
	RATIONALS *S = rationals(4), *inverse = rationals(4), *left = rationals(2 * (size_t)states),
		  *right = rationals(2 * (size_t)states);
	const mpq_t *T = mode->block;
	int column;
	const bool second = fabs(nearest_double(T[2])) + fabs(nearest_double(T[3])) >
			    fabs(nearest_double(T[0])) + fabs(nearest_double(T[1]));
	mpq_set_ui(S[second], 1, 1);
	mpq_set(S[2], T[2 * second]);
	mpq_set(S[3], T[2 * second + 1]);
	if (rational_inverse(2, S, inverse, &column)) {
		rational_product(2, 2, states, S, mode->left, left);
		rational_product(states, 2, 2, mode->right, inverse, right);
		make_unit(states, coords, left, right);
		for (int i = 0; i < 2 * states; i++) {
			mpq_swap(mode->left[i], left[i]);
			mpq_swap(mode->right[i], right[i]);
		}
		for (int i = 0; i < 4; i++)
			mpq_set_ui(mode->block[i], i == 1, 1);
	}
}

/* T^2 = 0, as far as its digits tell, or of one state T = 0 */
static bool is_nilpotent(const struct mode *mode, double largest)
{
	const int k = mode->states;
	RATIONALS *square = rationals((size_t)k * (size_t)k);
	double most = 0;
	rational_product(k, k, k, mode->block, mode->block, square);
	for (int i = 0; i < k * k; i++)
		most = fmax(most, fabs(nearest_double(square[i])));
	return most <= 1e-25 * largest * largest;
}

/* What may have a pole 0 is looked at in more digits. */
static bool find_rigid(struct modes *modes, int index)
{
	struct mode *mode = &modes->mode[index];
	if (!mode_refine(modes, index))
		return false;
	const int c = mode->moves ? mode->columns : mode->states, k = mode->states;
	bool zero = true;
	const double largest = largest_eigenvalue(modes->basis);
	for (int i = 0; i < c; i++)
		for (int j = 0; j < c && mode->moves; j++)
			zero = zero && mpq_sgn(mode->block[(c + i) * k + j]) == 0;
	if (!mode->moves)
		zero = is_nilpotent(mode, largest);
	mode->rigid = zero;
	if (zero && !mode->moves) {
		mode->re = 0;
		mode->weight = (mode->states + 1) / 2;
		if (mode->states == 2)
			straighten(mode, modes->model->system.states, modes->model->n);
	}
	return true;
}

static int by_frequency(const void *a, const void *b)
{
	const struct mode *p = a, *q = b;
	const double x = hypot(p->re, p->im), y = hypot(q->re, q->im);
	return x < y ? -1 : x > y ? 1 : p->first - q->first;
}

static void list_modes(struct modes *modes, const struct participation *participation)
{
	modes->count = invariants_count(modes->basis->invariants);
	modes->mode = ARRAY(struct mode, modes->count + 1);
	for (int i = 0; i < modes->count; i++) {
		const struct invariant *part = invariant_part(modes->basis->invariants, i);
		struct mode *mode = &modes->mode[i];
		*mode = (struct mode){ .first = i, .columns = part->columns, .moves = modes->basis->moves };
		mode->states = part->columns * (mode->moves ? 2 : 1);
		mode->weight = mode->moves || part->real ? part->columns : part->columns / 2;
		participation_of_poles(participation, mode);
	}
	qsort(modes->mode, (size_t)modes->count, sizeof *modes->mode, by_frequency);
}

struct modes *modes_of(const struct model *model, const char **why)
{
	const struct facts facts = facts_of_model(model);
	*why = objection_to(CAN_MODES, &facts, model).why;
	if (*why)
		return NULL;
	struct mode_basis *basis = basis_of(&model->system);
	*why = basis ? NULL : "its poles are not found in double precision";
	if (*why)
		return NULL;
	struct modes *modes = NEW(struct modes);
	*modes = (struct modes){ .model = model, .basis = basis };
	struct participation *participation = participation_of(modes);
	list_modes(modes, participation);
	const double largest = largest_eigenvalue(basis);
	for (int i = 0; i < modes->count; i++) {
		const struct invariant *part = invariant_part(basis->invariants, modes->mode[i].first);
		const double size = hypot(part->re, part->im) / largest;
		if (!*why && size * (basis->moves ? 1 : size) <= PERHAPS_RIGID && !find_rigid(modes, i))
			*why = "two poles are too close for double precision";
	}
	for (int i = 0, number = 1; i < modes->count; number += modes->mode[i++].weight)
		modes->mode[i].number = number;
	for (int i = 0; i < modes->count && !*why; i++)
		participation_of_mode(participation, &modes->mode[i]);
	participation_free(participation);
	find_shares(modes);
	return *why ? NULL : modes;
}

/* ---- in more digits ---- */

/* block, right and left of a mode of coordinates, from Theta, X and Y^T */
static void lift_exactly(const struct modes *modes, struct mode *mode, const mpq_t *theta, const mpq_t *X,
			 const mpq_t *Y)
{
	const int n = modes->model->n, c = mode->columns, k = mode->states, states = 2 * n;
	const int *velocity = modes->model->system.velocity;
	RATIONALS *DX = rationals((size_t)n * (size_t)c), *damping = rationals((size_t)c * (size_t)c);
	rational_product(n, n, c, modes->basis->D, X, DX);
	rational_product(c, n, c, Y, DX, damping);
	for (int i = 0; i < c; i++) {
		mpq_set_ui(mode->block[i * k + c + i], 1, 1);
		for (int j = 0; j < c; j++) {
			mpq_neg(mode->block[(c + i) * k + j], theta[i * c + j]);
			mpq_neg(mode->block[(c + i) * k + c + j], damping[i * c + j]);
			round_to_bits(mode->block[(c + i) * k + c + j]);
		}
		for (int j = 0; j < n; j++) {
			mpq_set(mode->right[j * k + i], X[j * c + i]);
			mpq_set(mode->right[velocity[j] * k + c + i], X[j * c + i]);
			mpq_set(mode->left[i * states + j], Y[i * n + j]);
			mpq_set(mode->left[(c + i) * states + velocity[j]], Y[i * n + j]);
		}
	}
}

bool mode_refine(struct modes *modes, int index)
{
	struct mode *mode = &modes->mode[index];
	struct mode_basis *basis = modes->basis;
	const int states = modes->model->system.states, n = basis->moves ? modes->model->n : states;
	const size_t k = (size_t)mode->states, c = (size_t)mode->columns, cells = (size_t)n * c;
	if (mode->block)
		return true;
	mpq_t *theta = rationals(c * c), *X = rationals(cells), *Y = rationals(cells);
	if (!invariant_refine(basis->invariants, mode->first, MODE_BITS, theta, X, Y))
		return false;
	if (!mode->moves) {
		mode->block = theta;
		mode->right = X;
		mode->left = Y;
		return true;
	}
	mode->block = rationals(k * k);
	mode->right = rationals(k * (size_t)states);
	mode->left = rationals(k * (size_t)states);
	lift_exactly(modes, mode, theta, X, Y);
	rationals_free(theta, c * c);
	rationals_free(X, cells);
	rationals_free(Y, cells);
	return true;
}
