/* SPDX-License-Identifier: MIT-0 */
/* runtime/series.c against e^{A tau} in MPFR, computed from the systems as written:
 * the rounding of A counts as error. */
#include "runtime.h"

enum { MOST = 6, BITS = 256, GRID = 16 };

/* d, the longest way in a chain with its load, is 5 */
#ifdef REAL_IS_FLOAT
enum { DEGREE = 8 + 5 };
#define real_of(v) mpfr_get_flt(v, MPFR_RNDN)
#else
enum { DEGREE = 15 + 5 };
#define real_of(v) mpfr_get_d(v, MPFR_RNDN)
#endif

typedef struct matrix {
	int n;
	mpfr_t e[MOST][MOST];
} matrix;

static void matrix_init(matrix *m, int n)
{
	int i, j;
	m->n = n;
	for (i = 0; i < MOST; i++)
		for (j = 0; j < MOST; j++) {
			mpfr_init2(m->e[i][j], BITS);
			mpfr_set_ui(m->e[i][j], i == j, MPFR_RNDN);
		}
}

static void matrix_clear(matrix *m)
{
	int i, j;
	for (i = 0; i < MOST; i++)
		for (j = 0; j < MOST; j++)
			mpfr_clear(m->e[i][j]);
}

static void matrix_copy(matrix *to, const matrix *from)
{
	int i, j;
	for (i = 0; i < from->n; i++)
		for (j = 0; j < from->n; j++)
			mpfr_set(to->e[i][j], from->e[i][j], MPFR_RNDN);
}

/* c <- a b, c apart from both */
static void matrix_multiply(matrix *c, const matrix *a, const matrix *b)
{
	mpfr_t t;
	int i, j, k;
	mpfr_init2(t, BITS);
	for (i = 0; i < a->n; i++)
		for (j = 0; j < a->n; j++) {
			mpfr_set_zero(c->e[i][j], 1);
			for (k = 0; k < a->n; k++) {
				mpfr_mul(t, a->e[i][k], b->e[k][j], MPFR_RNDN);
				mpfr_add(c->e[i][j], c->e[i][j], t, MPFR_RNDN);
			}
		}
	mpfr_clear(t);
}

/* e <- e^{A tau}: 60 terms at tau/2^12, squared 12 times */
static void exponential(matrix *e, const matrix *A, double tau)
{
	matrix term, next, scaled;
	int i, j, k;
	matrix_init(&term, A->n);
	matrix_init(&next, A->n);
	matrix_init(&scaled, A->n);
	for (i = 0; i < A->n; i++)
		for (j = 0; j < A->n; j++) {
			mpfr_set_ui(e->e[i][j], i == j, MPFR_RNDN);
			mpfr_mul_d(scaled.e[i][j], A->e[i][j], tau, MPFR_RNDN);
			mpfr_div_2ui(scaled.e[i][j], scaled.e[i][j], 12, MPFR_RNDN);
		}
	for (k = 1; k <= 60; k++) {
		matrix_multiply(&next, &term, &scaled);
		for (i = 0; i < A->n; i++)
			for (j = 0; j < A->n; j++) {
				mpfr_div_ui(term.e[i][j], next.e[i][j], (unsigned long)k, MPFR_RNDN);
				mpfr_add(e->e[i][j], e->e[i][j], term.e[i][j], MPFR_RNDN);
			}
	}
	for (k = 0; k < 12; k++) {
		matrix_multiply(&next, e, e);
		matrix_copy(e, &next);
	}
	matrix_clear(&term);
	matrix_clear(&next);
	matrix_clear(&scaled);
}

/* Two masses between walls, as decimals: m1 x1'' + (c1 + c2) x1' - c2 x2' + (k1 + k2) x1 - k2 x2 = cos(w t), and so on;
 * w = 0: no load.  States x1, x2, v1, v2, cos, sin. */
typedef struct chain {
	const char *name, *m[2], *k[3], *c[3];
	unsigned load;
	double fastest; /* |pole| [1/s], an upper bound within a few per cent */
} chain;

static const chain chains[] = {
	{"plain", {"1", "1"}, {"100", "100", "100"}, {"0", "0", "0"}, 0, 17.33},
	{"weakly coupled", {"1", "1"}, {"4000", "40", "2000"}, {"0", "0", "0"}, 0, 63.6},
	{"hardly coupled", {"1", "1"}, {"4000", "0.04", "2000"}, {"0", "0", "0"}, 0, 63.3},
	{"stiff", {"1", "100"}, {"10000", "100", "10000"}, {"0", "0", "0"}, 0, 100.6},
	{"stiff, light second mass", {"100", "1"}, {"10000", "10000", "100"}, {"0", "0", "0"}, 0, 101.1},
	{"not binary", {"0.3", "0.7"}, {"33.3", "77.7", "100.1"}, {"0", "0", "0"}, 0, 23.0},
	{"free", {"1", "0.3"}, {"0", "100", "0"}, {"0", "0", "0"}, 0, 20.9},
	{"damped", {"1", "1"}, {"100", "50", "100"}, {"0.2", "0.1", "0.2"}, 0, 14.2},
	{"overdamped", {"1", "1"}, {"100", "50", "100"}, {"40", "30", "40"}, 0, 98.0},
	{"loaded", {"1", "1"}, {"100", "100", "100"}, {"0", "0", "0"}, 7, 17.33},
	{"fast load", {"1", "1"}, {"100", "100", "100"}, {"0.2", "0.1", "0.2"}, 60, 60.0},
};

static void entry(mpfr_t a, const char *first, const char *second, const char *mass)
{
	mpfr_t t;
	mpfr_init2(t, BITS);
	mpfr_set_str(a, first, 10, MPFR_RNDN);
	mpfr_set_str(t, second, 10, MPFR_RNDN);
	mpfr_add(a, a, t, MPFR_RNDN);
	mpfr_set_str(t, mass, 10, MPFR_RNDN);
	mpfr_div(a, a, t, MPFR_RNDN);
	mpfr_clear(t);
}

static void chain_matrix(matrix *A, const chain *s)
{
	int i, j;
	A->n = s->load ? 6 : 4;
	for (i = 0; i < MOST; i++)
		for (j = 0; j < MOST; j++)
			mpfr_set_zero(A->e[i][j], 1);
	for (i = 0; i < 2; i++) {
		mpfr_set_ui(A->e[i][2 + i], 1, MPFR_RNDN);
		entry(A->e[2 + i][i], s->k[i], s->k[i + 1], s->m[i]);
		entry(A->e[2 + i][2 + i], s->c[i], s->c[i + 1], s->m[i]);
		mpfr_neg(A->e[2 + i][i], A->e[2 + i][i], MPFR_RNDN);
		mpfr_neg(A->e[2 + i][2 + i], A->e[2 + i][2 + i], MPFR_RNDN);
		entry(A->e[2 + i][1 - i], s->k[1], "0", s->m[i]);
		entry(A->e[2 + i][3 - i], s->c[1], "0", s->m[i]);
	}
	if (s->load) {
		mpfr_set_str(A->e[2][4], s->m[0], 10, MPFR_RNDN);
		mpfr_ui_div(A->e[2][4], 1, A->e[2][4], MPFR_RNDN);
		mpfr_set_si(A->e[4][5], -(long)s->load, MPFR_RNDN);
		mpfr_set_ui(A->e[5][4], s->load, MPFR_RNDN);
	}
}

/* -1 .. 1 */
static double random_number(void)
{
	return (double)(int64_t)random_word() * 0x1p-63;
}

static double worst_ratio;

/* Every |x_i - exact| against 16 REAL_EPSILON sum_j most_ij |x0_j| */
static void assert_state(const chain *s, const matrix *Phi, double most[MOST][MOST], const real *x0, const real *x,
						 double tau)
{
	mpfr_t exact, t;
	int i, j;
	mpfr_inits2(BITS, exact, t, (mpfr_ptr)0);
	for (i = 0; i < Phi->n; i++) {
		double size = 0.0, error;
		mpfr_set_zero(exact, 1);
		for (j = 0; j < Phi->n; j++) {
			mpfr_mul_d(t, Phi->e[i][j], x0[j], MPFR_RNDN);
			mpfr_add(exact, exact, t, MPFR_RNDN);
			size += most[i][j] * fabs(x0[j]);
		}
		mpfr_sub_d(t, exact, x[i], MPFR_RNDN);
		error = fabs(mpfr_get_d(t, MPFR_RNDN));
		if (!(error <= 16 * (double)REAL_EPSILON * size))
			fail_msg("%s, tau = %.17g: entry %d is %.17g, expected %.17g; off by %.17g, tolerance %.17g",
					s->name, tau,
					 i, x[i], mpfr_get_d(exact, MPFR_RNDN), error,
					16 * (double)REAL_EPSILON * size);
		if (size > 0.0 && error / ((double)REAL_EPSILON * size) > worst_ratio)
			worst_ratio = error / ((double)REAL_EPSILON * size);
	}
	mpfr_clears(exact, t, (mpfr_ptr)0);
}

/* |pole| h = reach: unit and random states, at sixteenths of h */
static void check_chain(const chain *s, double reach)
{
	const double h = ldexp(floor(ldexp(reach / s->fastest, 20)), -20); /* so that sixteenths of h are exact */
	double most[MOST][MOST];
	real a[MOST * MOST];
	matrix A, step, Phi[GRID + 1];
	pl_series p;
	int i, j, g, trial;

	matrix_init(&A, MOST);
	chain_matrix(&A, s);
	matrix_init(&step, A.n);
	exponential(&step, &A, h / GRID);
	for (g = 0; g <= GRID; g++) {
		matrix_init(&Phi[g], A.n);
		if (g > 0)
			matrix_multiply(&Phi[g], &Phi[g - 1], &step);
	}
	for (i = 0; i < A.n; i++)
		for (j = 0; j < A.n; j++) {
			a[i * A.n + j] = real_of(A.e[i][j]);
			most[i][j] = 0.0;
			for (g = 0; g <= GRID; g++)
				most[i][j] = fmax(most[i][j], fabs(mpfr_get_d(Phi[g].e[i][j], MPFR_RNDN)));
		}
	p.size = A.n;
	p.states = 4;
	p.degree = DEGREE;
	for (p.halvings = 0; ldexp(reach, -p.halvings) > 1.0; p.halvings++)
		;
	p.A = a;
	for (g = 0; g <= GRID; g++)
		for (trial = 0; trial < A.n + 8; trial++) {
			real x0[MOST], x[MOST], work[2 * MOST];
			for (i = 0; i < A.n; i++)
				x0[i] = (real)(trial < A.n ? i == trial
						: random_number() * (i == 2 || i == 3 ? s->fastest : 1.0));
			memcpy(x, x0, sizeof x);
			pl_series_advance(&p, (real)(h / GRID * g), x, work);
			assert_state(s, &Phi[g], most, x0, x, h / GRID * g);
		}
	for (g = 0; g <= GRID; g++)
		matrix_clear(&Phi[g]);
	matrix_clear(&step);
	matrix_clear(&A);
}

static void chains_within_a_step(void **state)
{
	static const double reach[] = {0.25, 1.0, 2.0, 4.5, 8.0};
	size_t i, j;
	(void)state;
	for (i = 0; i < sizeof chains / sizeof chains[0]; i++)
		for (j = 0; j < sizeof reach / sizeof reach[0]; j++)
			check_chain(&chains[i], reach[j]);
	print_message("# largest error of pl_series_advance: %.2f epsilon sum_j max|Phi_ij| |x_j|\n", worst_ratio);
}

static void assert_exactly(double found, double expected, const char *what)
{
	if (found != expected)
		fail_msg("%s: found %.17g, expected %.17g, exactly", what, found, expected);
}

/* An acceleration of 2 on a free mass: x = 3 + 5 tau + tau^2 in three terms, and tau = 0 changes nothing. */
static void free_fall_is_exact(void **state)
{
	const real A[9] = {0, 1, 0, 0, 0, 1, 0, 0, 0};
	const pl_series p = {3, 2, 2, 2, A};
	real x[3] = {3, 5, 2}, work[6];
	(void)state;
	pl_series_advance(&p, 0, x, work);
	assert_exactly(x[0], 3.0, "position at 0");
	assert_exactly(x[1], 5.0, "velocity at 0");
	pl_series_advance(&p, (real)0.5, x, work);
	assert_exactly(x[0], 5.75, "position");
	assert_exactly(x[1], 6.0, "velocity");
	assert_exactly(x[2], 2.0, "acceleration");
}

/* A mass of 1 under a force of 2, from 1 s on of -1, from 3 s on of 0: changes.h without the generator. What is kept of
 * its place is less by 1, 2, 3 in these times. */
typedef struct pushed {
	real now;
	int segment;
} pushed;
static const real pushed_slope[3][3] = {{0, 1, 0}, {0, 0, 5}, {0, 0, 0}}; /* x, v, 1; its forces: below */
static const real pushed_load_slope[3][2][1] = {{{0}, {2}}, {{0}, {-1}}, {{0}, {0}}};
static const int pushed_forced_at[1][2] = {{1, 2}};
static const real pushed_forced_part[3][2][2] = {{{7, 1}, {7, 0}}, {{7, 2}, {7, 0}}, {{7, 3}, {7, 0}}};
static const real pushed_forced_change[2][2][2] = {{{7, -1}, {7, 0}}, {{7, -1}, {7, 0}}};
static real pushed_until(const pushed *s, int change)
{
	return (real)(change ? 3 : 1) - s->now;
}

/* Where it is at t, from 0 and at rest; its speed */
static void pushed_at(double t, double at[2])
{
	const double late = fmin(t, 3) - 1, end = fmax(t - 3, 0);
	at[1] = t < 1 ? 2 * t : 2 - late;
	at[0] = t < 1 ? t * t : 1 + 2 * late - late * late / 2 + end * at[1];
}

#define PL_SINGLE SINGLE
#define PL(name) pushed_##name
#define PL_TYPE pushed
#define PL_STATES 2
#define PL_SIZE 3
#define PL_SEGMENTS 3
#define PL_DEGREE 2
#define PL_CHANGING 1
#define PL_FIRST 2
#define PL_FORCED 1
#define PL_LOAD_STATES 2
#define PL_LOSES 1
#include "changes.h"

static void from_change_to_change(void **state)
{
	const double from[] = {0, 0.5, 1, 2.5, 3}, to[] = {0, 0.75, 1, 3, 6};
	int i, k, whole;
	(void)state;
	for (i = 0; i < 5; i++)
		for (k = 0; k < 5; k++)
			for (whole = 0; whole <= 1 && to[k] >= from[i]; whole++) {
				const pushed s = {(real)from[i], from[i] < 1 ? 0 : from[i] < 3 ? 1 : 2};
				const int last = to[k] <= 1 && s.segment == 0 ? 0 : to[k] <= 3 && s.segment < 2 ? 1 : 2;
				double start[2], end[2];
				real x[3];
				pushed_at(from[i], start);
				pushed_at(to[k], end);
				x[0] = (real)(start[0] - 1 - s.segment);
				x[1] = (real)start[1];
				x[2] = 1;
				assert_int_equal(pushed_pass_changes(&s, pushed_slope, whole, (real)(to[k] - from[i]),
						x), last);
				assert_exactly(x[0], end[0] - (whole ? 0 : 1 + last), "where it is");
				assert_exactly(x[1], end[1], "its speed");
			}
}

ROOM(series,
	cmocka_unit_test(free_fall_is_exact),
	cmocka_unit_test(from_change_to_change),
	cmocka_unit_test(chains_within_a_step))
