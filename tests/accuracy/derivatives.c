/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives of linear steps against differences in multiprecision, which know no derivative.
 *
 *     derivatives spec SEED             a random spec
 *     derivatives judge SEED <NUMBERS   what its C computes, against e^{A h} with each param a little more and less
 *
 * Compiled with -DMODEL=NAME it is the other side, and prints NUMBERS: constants, which a step leaves in the
 * derivatives from a state of one 1 and derivatives of 0, and derivatives after STEPS steps; or after as many steps as
 * its argument says statuses, outputs and what these have. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 200 };

#ifdef MODEL

#include "plrt.h"
#define JOINED(a, b) a##b
#define NAMED(a, b) JOINED(a, b)
extern const pl_model NAMED(MODEL, _model);
extern const pl_derivatives NAMED(MODEL, _derivatives);

static void print_end(const pl_model *m, const pl_derivatives *d, int steps)
{
	void *s = malloc(m->size), *ds = malloc(d->size);
	double *y = calloc((size_t)m->outputs, sizeof *y), *J = calloc((size_t)(m->outputs * d->columns), sizeof *J);
	d->init(s, ds);
	for (int k = 0; k < steps; k++)
		d->step(s, ds, NULL, NULL);
	m->out(s, y);
	d->out(s, ds, J);
	printf("%u %d\n", d->status(ds), m->status(s));
	for (int i = 0; i < m->outputs; i++) {
		printf("%.17g", y[i]);
		for (int p = 0; p < d->columns; p++)
			printf(" %.17g", J[i * d->columns + p]);
		printf("\n");
	}
}

int main(int argc, char **argv)
{
	const pl_model *m = &NAMED(MODEL, _model);
	const pl_derivatives *d = &NAMED(MODEL, _derivatives);
	if (argc > 1)
		return print_end(m, d, atoi(argv[1])), 0;
	void *s = malloc(m->size), *alone = malloc(m->size), *ds = malloc(d->size);
	double *y = calloc((size_t)m->states, sizeof *y), *J = calloc((size_t)(m->states * d->columns), sizeof *J);
	double *plain = calloc((size_t)m->states, sizeof *plain);
	for (int j = -1; j < m->states; j++) {          /* -1: from rest, by the load alone, which is 1 at t = 0 */
		d->init(s, ds);
		memset(y, 0, sizeof *y * (size_t)m->states);
		if (j >= 0)
			y[j] = 1;
		m->set(s, j < 0 ? 0 : 1e6, y);          /* and has died away by then */
		d->step(s, ds, NULL, NULL);
		d->out(s, ds, J);
		for (int i = 0; i < m->states * d->columns; i++)
			printf("step %d %d %d %a\n", i % d->columns, i / d->columns, j, J[i]);
	}
	d->init(s, ds);
	m->init(alone);
	for (int k = 0; k < STEPS; k++) {
		d->step(s, ds, NULL, NULL);
		m->step(alone, NULL);
	}
	d->out(s, ds, J);
	m->out(s, y);
	m->out(alone, plain);
	for (int i = 0; i < m->states * d->columns; i++)
		printf("run %d %d 0 %a\n", i % d->columns, i / d->columns, J[i]);
	printf("same %d 0 0 0\n", memcmp(y, plain, sizeof *y * (size_t)m->states) == 0);
	return 0;
}

#else

#include <mpfr.h>
#include <stdbool.h>

/* ---- a random model: M x'' + C x' + K x = f e^{-3 t}, each entry a sum of params and products of them ---- */

enum { PARAMS = 3, MOST = 3, SIZE = 2 * MOST + 1, BITS = 900, APART = 200 };

struct random_model {
	int n, param[PARAMS];           /* thousandths */
	int weight[3][MOST][MOST][3];   /* of M, C, K: thousandths of 1, a, and of b c in C, sqrt(a b) in K, 1/c in M */
	int force[MOST], start[2 * MOST];
};

static unsigned long state;

static int drawn(int from, int to)
{
	state = state * 6364136223846793005ul + 1442695040888963407ul;
	return from + (int)((state >> 33) % (unsigned long)(to - from + 1));
}

static struct random_model model_of(unsigned long seed)
{
	struct random_model m = { 0 };
	state = seed * 2654435761ul + 99991;
	m.n = drawn(1, MOST);
	for (int k = 0; k < PARAMS; k++)
		m.param[k] = drawn(500, 3000);
	for (int which = 0; which < 3; which++)
		for (int i = 0; i < m.n; i++)
			for (int j = 0; j < m.n; j++)
				for (int term = 0; term < 3; term++)
					m.weight[which][i][j][term] = which == 0 && i == j ? drawn(500, 1500)
						: which == 0 ? drawn(0, 3) == 0 ? drawn(-100, 100) : 0
						: drawn(0, 2) ? drawn(-900, 900) * (which == 2 ? 10 : 1) : 0;
	for (int i = 0; i < m.n; i++)
		m.force[i] = drawn(-2000, 2000);
	for (int i = 0; i < 2 * m.n; i++)
		m.start[i] = drawn(-1000, 1000);
	return m;
}

static const char *const third[] = { "1/c", "b*c", "root" };

static void print_spec(unsigned long seed)
{
	const struct random_model m = model_of(seed);
	printf("model r\nparam a = %d/1000, b = %d/1000, c = %d/1000\nparam root = sqrt(a*b)\ncoord x1", m.param[0],
	       m.param[1], m.param[2]);
	for (int i = 1; i < m.n; i++)
		printf(", x%d", i + 1);
	for (int i = 0; i < 2 * m.n; i++)
		printf("%s x%d%s = %d/1000", i ? "," : "\ninit", i % m.n + 1, i < m.n ? "" : "'", m.start[i]);
	printf("\nsensitivity a, b, c\nstep 0.1\n");
	for (int i = 0; i < m.n; i++) {
		for (int which = 0; which < 3; which++)
			for (int j = 0; j < m.n; j++)
				printf("%s(%d/1000 + %d/1000*a + %d/1000*%s)*x%d%.*s", which || j ? " + " : "",
				       m.weight[which][i][j][0], m.weight[which][i][j][1], m.weight[which][i][j][2],
				       third[which], j + 1, 2 - which, "''");
		printf(" = %d/1000*b*exp(-3*t)\n", m.force[i]);
	}
}

/* ---- e^{A h} at params a little off ---- */

struct numbers { mpfr_t of[SIZE][SIZE]; };

static struct numbers *numbers_new(void)
{
	struct numbers *x = malloc(sizeof *x);
	for (int i = 0; i < SIZE * SIZE; i++)
		mpfr_init2(x->of[i / SIZE][i % SIZE], BITS), mpfr_set_ui(x->of[i / SIZE][i % SIZE], 0, MPFR_RNDN);
	return x;
}

static void entry_of(const struct random_model *m, const mpfr_t *param, int which, int i, int j, mpfr_ptr entry)
{
	mpfr_t term;
	const int *weight = m->weight[which][i][j];
	mpfr_init2(term, BITS);
	mpfr_set_si(entry, weight[0], MPFR_RNDN);
	mpfr_mul_si(term, param[0], weight[1], MPFR_RNDN);
	mpfr_add(entry, entry, term, MPFR_RNDN);
	if (which == 0)
		mpfr_ui_div(term, 1, param[2], MPFR_RNDN);
	else
		mpfr_mul(term, param[which == 1 ? 1 : 0], param[which == 1 ? 2 : 1], MPFR_RNDN);
	if (which == 2)
		mpfr_sqrt(term, term, MPFR_RNDN);
	mpfr_mul_si(term, term, weight[2], MPFR_RNDN);
	mpfr_add(entry, entry, term, MPFR_RNDN);
	mpfr_div_ui(entry, entry, 1000, MPFR_RNDN);
	mpfr_clear(term);
}

/* Rows of M x'' = right, solved in place by elimination: right is -K, -C, f, 0 */
static void solve(int n, int columns, struct numbers *M, struct numbers *right)
{
	mpfr_t factor, product;
	mpfr_inits2(BITS, factor, product, (mpfr_ptr)0);
	for (int k = 0; k < n; k++)
		for (int i = 0; i < n; i++) {
			if (i == k)
				continue;
			mpfr_div(factor, M->of[i][k], M->of[k][k], MPFR_RNDN);
			for (int j = 0; j < n; j++) {
				mpfr_mul(product, factor, M->of[k][j], MPFR_RNDN);
				mpfr_sub(M->of[i][j], M->of[i][j], product, MPFR_RNDN);
			}
			for (int j = 0; j < columns; j++) {
				mpfr_mul(product, factor, right->of[k][j], MPFR_RNDN);
				mpfr_sub(right->of[i][j], right->of[i][j], product, MPFR_RNDN);
			}
		}
	for (int i = 0; i < n; i++)
		for (int j = 0; j < columns; j++)
			mpfr_div(right->of[i][j], right->of[i][j], M->of[i][i], MPFR_RNDN);
}

/* A h of states and load */
static struct numbers *slopes_of(const struct random_model *m, const mpfr_t *param)
{
	const int n = m->n, size = 2 * n + 1;
	struct numbers *M = numbers_new(), *right = numbers_new(), *A = numbers_new();
	for (int i = 0; i < n; i++) {
		for (int j = 0; j < n; j++) {
			entry_of(m, param, 0, i, j, M->of[i][j]);
			entry_of(m, param, 2, i, j, right->of[i][j]);
			entry_of(m, param, 1, i, j, right->of[i][n + j]);
			mpfr_neg(right->of[i][j], right->of[i][j], MPFR_RNDN);
			mpfr_neg(right->of[i][n + j], right->of[i][n + j], MPFR_RNDN);
		}
		mpfr_mul_si(right->of[i][2 * n], param[1], m->force[i], MPFR_RNDN);
		mpfr_div_ui(right->of[i][2 * n], right->of[i][2 * n], 1000, MPFR_RNDN);
	}
	solve(n, size, M, right);
	for (int i = 0; i < n; i++) {
		mpfr_set_ui(A->of[i][n + i], 1, MPFR_RNDN);
		for (int j = 0; j < size; j++)
			mpfr_set(A->of[n + i][j], right->of[i][j], MPFR_RNDN);
	}
	mpfr_set_si(A->of[size - 1][size - 1], -3, MPFR_RNDN);
	for (int i = 0; i < size * size; i++)
		mpfr_div_ui(A->of[i / size][i % size], A->of[i / size][i % size], 10, MPFR_RNDN);
	return A;
}

static struct numbers *product_of(int size, const struct numbers *a, const struct numbers *b)
{
	struct numbers *c = numbers_new();
	mpfr_t term;
	mpfr_init2(term, BITS);
	for (int i = 0; i < size; i++)
		for (int j = 0; j < size; j++)
			for (int k = 0; k < size; k++) {
				mpfr_mul(term, a->of[i][k], b->of[k][j], MPFR_RNDN);
				mpfr_add(c->of[i][j], c->of[i][j], term, MPFR_RNDN);
			}
	return c;
}

static struct numbers *exponential_of(int size, const struct numbers *A)
{
	struct numbers *sum = numbers_new(), *term = numbers_new();
	for (int i = 0; i < size; i++) {
		mpfr_set_ui(sum->of[i][i], 1, MPFR_RNDN);
		mpfr_set_ui(term->of[i][i], 1, MPFR_RNDN);
	}
	for (unsigned long k = 1; k < 260; k++) {
		term = product_of(size, term, A);
		for (int i = 0; i < size * size; i++) {
			mpfr_ptr t = term->of[i / size][i % size], s = sum->of[i / size][i % size];
			mpfr_div_ui(t, t, k, MPFR_RNDN);
			mpfr_add(s, s, t, MPFR_RNDN);
		}
	}
	return sum;
}

/* Of e^{A h} and e^{A h STEPS}, by one param, by central differences 2^-APART apart: their error is its square */
static void differences_of(const struct random_model *m, int by, struct numbers **step, struct numbers **run)
{
	const int size = 2 * m->n + 1;
	struct numbers *side[2], *all[2];
	for (int sign = 0; sign < 2; sign++) {
		mpfr_t param[PARAMS], off;
		mpfr_init2(off, BITS);
		mpfr_set_si_2exp(off, sign ? 1 : -1, -APART, MPFR_RNDN);
		for (int k = 0; k < PARAMS; k++) {
			mpfr_init2(param[k], BITS);
			mpfr_set_si(param[k], m->param[k], MPFR_RNDN);
			mpfr_div_ui(param[k], param[k], 1000, MPFR_RNDN);
		}
		mpfr_add(param[by], param[by], off, MPFR_RNDN);
		side[sign] = exponential_of(size, slopes_of(m, param));
		all[sign] = side[sign];
		for (int k = 1; k < STEPS; k++)
			all[sign] = product_of(size, all[sign], side[sign]);
	}
	for (int i = 0; i < size * size; i++) {
		const int row = i / size, column = i % size;
		mpfr_sub(side[1]->of[row][column], side[1]->of[row][column], side[0]->of[row][column], MPFR_RNDN);
		mpfr_mul_2si(side[1]->of[row][column], side[1]->of[row][column], APART - 1, MPFR_RNDN);
		mpfr_sub(all[1]->of[row][column], all[1]->of[row][column], all[0]->of[row][column], MPFR_RNDN);
		mpfr_mul_2si(all[1]->of[row][column], all[1]->of[row][column], APART - 1, MPFR_RNDN);
	}
	*step = side[1];
	*run = all[1];
}

/* ---- what the C has against it ---- */

static double after_run(const struct random_model *m, const struct numbers *run, int row)
{
	mpfr_t sum, term;
	mpfr_inits2(BITS, sum, term, (mpfr_ptr)0);
	mpfr_set(sum, run->of[row][2 * m->n], MPFR_RNDN);
	for (int j = 0; j < 2 * m->n; j++) {
		mpfr_mul_si(term, run->of[row][j], m->start[j], MPFR_RNDN);
		mpfr_div_ui(term, term, 1000, MPFR_RNDN);
		mpfr_add(sum, sum, term, MPFR_RNDN);
	}
	return mpfr_get_d(sum, MPFR_RNDN);
}

static double largest_after(const struct random_model *m, const struct numbers *run)
{
	double largest = 0;
	for (int i = 0; i < 2 * m->n; i++)
		largest = fmax(largest, fabs(after_run(m, run, i)));
	return largest;
}

static int judge(unsigned long seed)
{
	const struct random_model m = model_of(seed);
	struct numbers *step[PARAMS], *run[PARAMS];
	char kind[8];
	int by, row, column, wrong = 0, constants = 0, runs = 0;
	double found;
	for (int k = 0; k < PARAMS; k++)
		differences_of(&m, k, &step[k], &run[k]);
	while (scanf("%7s %d %d %d %la", kind, &by, &row, &column, &found) == 5) {
		const bool same = strcmp(kind, "same") == 0, constant = strcmp(kind, "step") == 0;
		const double truth = same ? 1 : constant
			? mpfr_get_d(step[by]->of[row][column < 0 ? 2 * m.n : column], MPFR_RNDN)
			: after_run(&m, run[by], row);
		const double allowed = same || constant ? 0 : 1e-13 * largest_after(&m, run[by]);
		const double value = same ? by : found;
		constants += constant;
		runs += !same && !constant;
		if (!(fabs(value - truth) <= allowed)) {
			wrong++;
			printf("# seed %lu, %s by %d: row %d, column %d: %.17g, not %.17g within %.3g\n", seed, kind,
			       by, row, column, value, truth, allowed);
		}
	}
	const int states = 2 * m.n;
	if (constants != PARAMS * states * (states + 1) || runs != PARAMS * states)
		printf("# seed %lu: %d constants and %d runs were read\n", seed, constants, runs), wrong++;
	printf("%d constants\n", constants);
	return wrong > 0;
}

int main(int argc, char **argv)
{
	if (argc != 3)
		return 2;
	const unsigned long seed = strtoul(argv[2], NULL, 10);
	if (strcmp(argv[1], "judge") == 0)
		return judge(seed);
	print_spec(seed);
	return 0;
}

#endif
