/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "judge.h"
#include "evaluator.h"

#include <stdlib.h>

enum { BITS = 1024, MORE_BITS = 4096 };

/* ---- what influences what ---- */

static void mark_blocks(struct judge *j)
{
	const struct linear *system = j->system;
	const int n = system->n;
	j->block = ARRAY(int, (size_t)n);
	for (int i = 0; i < n; i++)
		j->block[i] = i;
	for (int pass = 0; pass < n; pass++)
		for (int e = 0; e < n; e++)
			for (int a = 0; a < n; a++)
				for (int b = 0; b < n; b++) {
					const int p = e * n + a, q = e * n + b;
					if ((mpq_sgn(system->M[p]) || mpq_sgn(system->C[p]) || mpq_sgn(system->K[p])) &&
						(mpq_sgn(system->M[q]) || mpq_sgn(system->C[q]) ||
						mpq_sgn(system->K[q])) &&
							j->block[a] < j->block[b])
						j->block[b] = j->block[a];
				}
}

static bool is_undamped(const struct linear *system)
{
	const int n = system->n;
	bool good = !system->heldK;
	for (int i = 0; i < n; i++)
		for (int k = 0; k < n; k++) {
			good = good && system->velocity[i] >= 0 && mpq_sgn(system->C[i * n + k]) == 0;
			good = good && (i == k ? mpq_sgn(system->M[i * n + k]) > 0
					: mpq_sgn(system->M[i * n + k]) == 0);
			good = good && mpq_equal(system->K[i * n + k], system->K[k * n + i]);
		}
	return good;
}

/* ---- x' = A x in one segment of time: states, load states, inputs and slopes ---- */

struct leg {
	int size, first_load, first_input;
	mpq_t *A;
};

/* row <- row + factor * other */
static void add_row(int width, mpq_t *row, mpq_srcptr factor, mpq_t *other)
{
	mpq_t product;
	mpq_init(product);
	for (int k = 0; k < width; k++) {
		mpq_mul(product, factor, other[k]);
		mpq_add(row[k], row[k], product);
	}
	mpq_clear(product);
}

/* Gauss and Jordan on rows of width n + right, n of them */
static void solve(int n, int right, mpq_t *W)
{
	const int width = n + right;
	mpq_t factor;
	mpq_init(factor);
	for (int k = 0; k < n; k++) {
		int pivot = k;
		while (mpq_sgn(W[pivot * width + k]) == 0)
			pivot++;
		for (int c = 0; c < width; c++)
			mpq_swap(W[pivot * width + c], W[k * width + c]);
		mpq_inv(factor, W[k * width + k]);
		for (int c = 0; c < width; c++)
			mpq_mul(W[k * width + c], W[k * width + c], factor);
		for (int r = 0; r < n; r++) {
			mpq_neg(factor, W[r * width + k]);
			if (r != k && mpq_sgn(factor) != 0)
				add_row(width, W + r * width, factor, W + k * width);
		}
	}
	mpq_clear(factor);
}

static void fill_waves(const struct linear *system, struct leg *f)
{
	int at = f->first_load;
	for (int l = 0; l < system->loads; at += system->load[l++].columns) {
		const struct forcing *forcing = system->load[l].forcing;
		const int trig = mpq_sgn(forcing->w) ? 2 : 1;
		for (int c = 0; c < system->load[l].columns; c++) {
			mpq_t *row = f->A + (at + c) * f->size + at;
			mpq_set(row[c], forcing->a);
			if (c >= trig)
				mpq_set_ui(row[c - trig], (unsigned long)(c / trig), 1);
			if (trig == 2 && c % 2 == 0)
				mpq_neg(row[c + 1], forcing->w);
			else if (trig == 2)
				mpq_set(row[c - 1], forcing->w);
		}
	}
}

/* Equations M q'' + C q' + K q = forces, solved for the highest derivative of each coordinate */
static struct leg flow_in(const struct judge *j, int segment)
{
	const struct linear *system = j->system;
	const int n = system->n, forces = j->loads + 2 * system->inputs;
	struct leg f = { .first_load = system->states, .first_input = system->states + j->loads };
	f.size = f.first_input + 2 * system->inputs;
	f.A = rationals((size_t)(f.size * f.size));
	const int right = system->states + forces, width = n + right;
	mpq_t *W = rationals((size_t)(n * width));
	for (int e = 0; e < n; e++) {
		mpq_t *row = W + e * width, *force = row + n + system->states;
		for (int c = 0; c < n; c++) {
			const int v = system->velocity[c], p = e * n + c;
			mpq_set(row[c], v < 0 ? system->C[p] : system->M[p]);
			mpq_neg(row[n + c], system->K[p]);
			if (v >= 0)
				mpq_neg(row[n + v], system->C[p]);
		}
		for (int l = 0; l < system->loads; l++)
			for (int k = 0; k < system->load[l].columns; k++)
				mpq_set(*force++, system->load[l].force[k][segment * n + e]);
		for (int u = 0; u < system->inputs; u++)
			for (int k = 0; k < 2; k++)
				mpq_set(*force++, system->input[u].force[k][e]);
	}
	solve(n, right, W);
	for (int c = 0; c < n; c++) {
		const int v = system->velocity[c];
		for (int k = 0; k < right; k++)
			mpq_set(f.A[(v < 0 ? c : v) * f.size + k], W[c * width + n + k]);
		if (v >= 0)
			mpq_set_ui(f.A[c * f.size + v], 1, 1);
	}
	fill_waves(system, &f);
	for (int u = 0; u < system->inputs; u++)
		if (system->input[u].hold)
			mpq_set_ui(f.A[(f.first_input + 2 * u) * f.size + f.first_input + 2 * u + 1], 1, 1);
	return f;
}

/* Is there a path from `column` to `row`? */
static bool *reach_of(const struct leg *f)
{
	const int n = f->size;
	bool *reach = ARRAY(bool, (size_t)(n * n));
	for (int i = 0; i < n * n; i++)
		reach[i] = mpq_sgn(f->A[i]) != 0 || i % (n + 1) == 0;
	for (int k = 0; k < n; k++)
		for (int i = 0; i < n; i++)
			for (int c = 0; c < n; c++)
				reach[i * n + c] = reach[i * n + c] || (reach[i * n + k] && reach[k * n + c]);
	return reach;
}

/* ---- numbers ---- */

/* An entry of e^{A tau} */
static void take_entry(mpfi_ptr x, const evaluator_enclosure *E, int i, int k)
{
	mpz_t end;
	mpz_init(end);
	const size_t entry = (size_t)i * E->n + (size_t)k;
	const size_t bits = mpz_sizeinbase(E->mid[entry], 2) + 64;
	mpfi_set_prec(x, (mpfr_prec_t)(bits > BITS ? bits : BITS));
	mpz_sub(end, E->mid[entry], E->radius);
	mpfr_set_z_2exp(&x->left, end, E->exponent, MPFR_RNDD);
	mpz_add(end, E->mid[entry], E->radius);
	mpfr_set_z_2exp(&x->right, end, E->exponent, MPFR_RNDU);
	mpz_clear(end);
}

/* One column of e^{A h} X: a state, a load, an input (held: u; a ramp: its values before and after) */
static void take_column(const struct judge *j, const struct leg *f, const evaluator_enclosure *E, int i, int column,
	mpfi_ptr x)
{
	const struct linear *system = j->system;
	int u = 0, part = column - j->states - j->loads;
	if (part < 0) {
		take_entry(x, E, i, column);
		return;
	}
	for (; part > system->input[u].hold; u++)
		part -= 1 + system->input[u].hold;
	if (!system->input[u].hold) {
		take_entry(x, E, i, f->first_input + 2 * u);
		return;
	}
	mpfi_t slope;
	mpfi_init2(slope, MORE_BITS);
	take_entry(slope, E, i, f->first_input + 2 * u + 1);
	mpfi_div_q(slope, slope, j->h);
	take_entry(x, E, i, f->first_input + 2 * u);
	if (part)
		mpfi_set(x, slope);
	else
		mpfi_sub(x, x, slope);
	mpfi_clear(slope);
}

static bool column_reaches(const struct judge *j, const struct leg *f, const bool *reach, int i, int column)
{
	int part = column - j->states - j->loads, at = f->first_input;
	if (part < 0)
		return reach[i * f->size + column];
	for (int u = 0; part > j->system->input[u].hold; u++, at += 2)
		part -= 1 + j->system->input[u].hold;
	return reach[i * f->size + at] || reach[i * f->size + at + 1];
}

/* Twice: what is not apart from 0 with BITS, or whose second word they leave open, is looked at with MORE_BITS; what is
 * not apart from 0 then is taken for 0. */
static void fill_segment(struct judge *j, int segment)
{
	struct leg f = flow_in(j, segment);
	const bool *reach = reach_of(&f);
	evaluator_enclosure E;
	double word, low;
	bool open = true;
	evaluator_enclosure_init(&E, (size_t)f.size);
	for (int bits = BITS; open; bits = MORE_BITS) {
		open = false;
		if (evaluator_enclose((const mpq_t *)f.A, j->h, (unsigned long)bits, &E)) {
			printf("# the judge gives up\n");
			exit(1);
		}
		for (int i = 0; i < j->states; i++)
			for (int k = 0; k < j->columns; k++) {
				struct judged_number *number = &j->step[(segment * j->states + i) * j->columns + k];
				number->zero = !column_reaches(j, &f, reach, i, k);
				take_column(j, &f, &E, i, k, number->x);
				if (mpfi_has_zero(number->x) && !number->zero) {
					open = open || bits == BITS;
					number->zero = bits == MORE_BITS;
				}
				if (segment || k >= j->states)
					continue;
				struct judged_number *increment = &j->increment[i * j->states + k];
				mpfi_set_prec(increment->x, mpfi_get_prec(number->x));
				mpfi_sub_ui(increment->x, number->x, i == k);
				increment->zero = number->zero && i != k;
				if (mpfi_has_zero(increment->x) && !increment->zero) {
					open = open || bits == BITS;
					increment->zero = bits == MORE_BITS;
				}
				open = open || (bits == BITS && !judge_words(increment, false, &word, &low));
			}
	}
	evaluator_enclosure_clear(&E);
}

/* R <- L^-1 R, n x n */
static void solve_intervals(int n, mpfi_t *L, mpfi_t *R)
{
	mpfi_t factor, product;
	mpfi_init2(factor, 2 * BITS);
	mpfi_init2(product, 2 * BITS);
	for (int k = 0; k < n; k++) {
		int pivot = k;
		for (int r = k; r < n; r++)
			if (mpfr_cmpabs(&L[r * n + k]->left, &L[pivot * n + k]->left) > 0)
				pivot = r;
		for (int c = 0; c < n; c++) {
			mpfi_swap(L[pivot * n + c], L[k * n + c]);
			mpfi_swap(R[pivot * n + c], R[k * n + c]);
		}
		for (int r = 0; r < n; r++) {
			if (r == k)
				continue;
			mpfi_div(factor, L[r * n + k], L[k * n + k]);
			for (int c = 0; c < n; c++) {
				mpfi_mul(product, factor, L[k * n + c]);
				mpfi_sub(L[r * n + c], L[r * n + c], product);
				mpfi_mul(product, factor, R[k * n + c]);
				mpfi_sub(R[r * n + c], R[r * n + c], product);
			}
		}
	}
	for (int r = 0; r < n; r++)
		for (int c = 0; c < n; c++)
			mpfi_div(R[r * n + c], R[r * n + c], L[r * n + r]);
	mpfi_clear(factor);
	mpfi_clear(product);
}

/* S = Phi_12 M^-1, X = M Phi_11(h/2)^-1 Phi_21(h/2), masses in units of the first */
static void fill_kicks(struct judge *j)
{
	const struct linear *system = j->system;
	const int n = system->n;
	struct leg f = flow_in(j, 0);
	evaluator_enclosure E;
	mpfi_t *L = ARRAY(mpfi_t, (size_t)(n * n)), *R = ARRAY(mpfi_t, (size_t)(n * n));
	mpq_t half, mass;
	mpq_inits(half, mass, NULL);
	mpq_div_2exp(half, j->h, 1);
	evaluator_enclosure_init(&E, (size_t)f.size);
	if (evaluator_enclose((const mpq_t *)f.A, half, BITS, &E)) {
		printf("# the judge gives up\n");
		exit(1);
	}
	for (int i = 0; i < n * n; i++) {
		mpfi_init2(L[i], BITS);
		mpfi_init2(R[i], BITS);
		take_entry(L[i], &E, i / n, i % n);
		take_entry(R[i], &E, system->velocity[i / n], i % n);
	}
	solve_intervals(n, L, R);
	for (int i = 0; i < n * n; i++) {
		const bool apart = j->block[i / n] != j->block[i % n];
		const struct judged_number *Phi_12 = &j->step[(i / n) * j->columns + system->velocity[i % n]];
		mpq_div(mass, system->M[i / n * (n + 1)], system->M[0]);
		mpfi_mul_q(R[i], R[i], mass);
		mpfi_set_prec(j->kick[i].x, mpfi_get_prec(R[i]));
		mpfi_set(j->kick[i].x, R[i]);
		j->kick[i].zero = apart || mpfi_has_zero(R[i]);
		mpq_div(mass, system->M[i % n * (n + 1)], system->M[0]);
		mpfi_set_prec(j->drift[i].x, mpfi_get_prec(Phi_12->x));
		mpfi_div_q(j->drift[i].x, Phi_12->x, mass);
		j->drift[i].zero = Phi_12->zero;
	}
	evaluator_enclosure_clear(&E);
}

static struct judged_number *numbers(int count)
{
	struct judged_number *x = ARRAY(struct judged_number, (size_t)count);
	for (int i = 0; i < count; i++)
		mpfi_init2(x[i].x, BITS);
	return x;
}

/* How load states go on by themselves: the corner of A that is theirs */
static mpq_t *load_matrix(const struct judge *j)
{
	struct leg f = flow_in(j, 0);
	mpq_t *A = rationals((size_t)(j->loads * j->loads));
	for (int i = 0; i < j->loads * j->loads; i++)
		mpq_set(A[i], f.A[(f.first_load + i / j->loads) * f.size + f.first_load + i % j->loads]);
	return A;
}

/* target <- A B, of which A has so many rows and B and the target so many columns, here and there */
static void multiply(int rows, int n, const mpfi_t *A, const mpfi_t *B, mpfi_t *target)
{
	mpfi_t product;
	mpfi_init2(product, 2 * BITS);
	for (int i = 0; i < rows * n; i++) {
		mpfi_set_ui(target[i], 0);
		for (int m = 0; m < n; m++) {
			mpfi_mul(product, A[i / n * n + m], B[m * n + i % n]);
			mpfi_add(target[i], target[i], product);
		}
	}
	mpfi_clear(product);
}

static mpfi_t *intervals(int count)
{
	mpfi_t *x = ARRAY(mpfi_t, (size_t)count);
	for (int i = 0; i < count; i++)
		mpfi_init2(x[i], 2 * BITS);
	return x;
}

/* The columns of the loads; then each time what they are times e^{A h} of the loads alone */
static void fill_turns(struct judge *j)
{
	const int n = j->loads, cells = j->states * n;
	mpfi_t *E = intervals(n * n), *now = intervals(cells), *next = intervals(cells);
	evaluator_enclosure enclosure;
	evaluator_enclosure_init(&enclosure, (size_t)n);
	if (evaluator_enclose((const mpq_t *)load_matrix(j), j->h, BITS, &enclosure)) {
		printf("# the judge gives up\n");
		exit(1);
	}
	for (int i = 0; i < n * n; i++)
		take_entry(E[i], &enclosure, i / n, i % n);
	for (int i = 0; i < cells; i++) {
		const struct judged_number *column = &j->step[i / n * j->columns + j->states + i % n];
		if (!column->zero)
			mpfi_set(now[i], column->x);
		else
			mpfi_set_ui(now[i], 0);
	}
	j->turned = numbers(JUDGED_TURNS * cells);
	for (int l = 0; l < JUDGED_TURNS; l++) {
		for (int i = 0; i < cells; i++) {
			mpfi_set_prec(j->turned[l * cells + i].x, 2 * BITS);
			mpfi_set(j->turned[l * cells + i].x, now[i]);
		}
		multiply(j->states, n, (const mpfi_t *)now, (const mpfi_t *)E, next);
		for (int i = 0; i < cells; i++)
			mpfi_swap(now[i], next[i]);
	}
	evaluator_enclosure_clear(&enclosure);
}

struct judge *judge_of(const struct linear *system, mpq_srcptr h)
{
	struct judge *j = NEW(struct judge);
	*j = (struct judge){ .system = system, .h = h, .states = system->states, .undamped = is_undamped(system) };
	for (int l = 0; l < system->loads; l++)
		j->loads += system->load[l].columns;
	for (int u = 0; u < system->inputs; u++)
		j->inputs += 1 + system->input[u].hold;
	j->columns = j->states + j->loads + j->inputs;
	mark_blocks(j);
	j->step = numbers(system->segments * j->states * j->columns);
	j->increment = numbers(j->states * j->states);
	for (int s = 0; s < system->segments; s++)
		fill_segment(j, s);
	if (j->loads && system->segments == 1 && j->states <= LIMIT_UNROLLED_STATES)
		fill_turns(j);
	if (j->undamped) {
		j->kick = numbers(system->n * system->n);
		j->drift = numbers(system->n * system->n);
		fill_kicks(j);
	}
	return j;
}

static double rounded(mpfr_srcptr x, bool single)
{
	const double d = single ? (double)mpfr_get_flt(x, MPFR_RNDN) : mpfr_get_d(x, MPFR_RNDN);
	return d == 0 ? 0 : d;
}

static bool decided(mpfi_srcptr x, bool single, double *value)
{
	*value = rounded(&x->left, single);
	return *value == rounded(&x->right, single);
}

/* Nothing within 200 bits below the value */
static bool is_narrow(mpfi_srcptr rest, double value)
{
	mpfr_t width;
	mpfr_init2(width, 64);
	mpfi_diam_abs(width, rest);
	mpfr_div_d(width, width, value == 0 ? 1 : value, MPFR_RNDU);
	const bool narrow = mpfr_zero_p(width) || mpfr_get_exp(width) < -200;
	mpfr_clear(width);
	return narrow;
}

bool judge_words(const struct judged_number *number, bool single, double *value, double *low)
{
	bool good;
	mpfi_t rest;
	*value = *low = 0;
	if (number->zero)
		return true;
	if (!decided(number->x, single, value))
		return false;
	mpfi_init2(rest, mpfi_get_prec(number->x));
	mpfi_sub_d(rest, number->x, *value);
	good = mpfi_has_zero(rest) ? is_narrow(rest, *value) : decided(rest, single, low);
	mpfi_clear(rest);
	return good;
}
