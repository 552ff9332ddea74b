/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * The judge judged: reference values, closed forms, the semigroup identity, and whether enclosures enclose.
 *
 *     evaluator_test [exponentials.txt]        (or the path in the environment variable EXPONENTIALS)
 */
#include <stdio.h>                      /* before gmp.h, which then declares gmp_fscanf */

#include "evaluator.h"
#include "rationals.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { LARGEST_N = 12, CLOSED_FORM_BITS = 4096 };

static const char *exponentials = "exponentials.txt";

/* ---- matrices ---- */

static mpq_t *new_rationals(size_t count)
{
	mpq_t *q = malloc(count * sizeof *q);
	assert_non_null(q);
	for (size_t i = 0; i < count; i++)
		mpq_init(q[i]);
	return q;
}

static void free_rationals(mpq_t *q, size_t count)
{
	for (size_t i = 0; i < count; i++)
		mpq_clear(q[i]);
	free(q);
}

/* the next of the white-space separated numbers in text */
static const char *read_rational(mpq_t q, const char *text)
{
	char word[400];
	int length = 0;
	assert_int_equal(sscanf(text, "%399s%n", word, &length), 1);
	assert_int_equal(rational_parse(q, word), 0);
	return text + length;
}

static mpq_t *matrix(size_t count, const char *text)
{
	mpq_t *q = new_rationals(count);
	for (size_t i = 0; i < count; i++)
		text = read_rational(q[i], text);
	return q;
}

static int exponential(size_t n, mpq_t *A, const mpq_t tau, double *E)
{
	return evaluator_exponential(n, (const mpq_t *)A, tau, E);
}

static int apply(size_t n, mpq_t *A, const mpq_t tau, mpq_t *x, double *y)
{
	return evaluator_apply(n, (const mpq_t *)A, tau, (const mpq_t *)x, y);
}

/* e^{A tau} of matrices written as text; flags as for evaluator_round, X = I */
static void exponential_of(size_t n, const char *A_text, const char *tau_text, unsigned flags, double *E)
{
	mpq_t *A = matrix(n * n, A_text), *tau = matrix(1, tau_text), *I = new_rationals(n * n);
	for (size_t i = 0; i < n; i++)
		mpq_set_ui(I[i * n + i], 1, 1);
	assert_int_equal(evaluator_round(n, (const mpq_t *)A, tau[0], n, (const mpq_t *)I, flags, E), 0);
	free_rationals(A, n * n);
	free_rationals(tau, 1);
	free_rationals(I, n * n);
}

/* ---- comparisons ---- */

static void same_double(double found, double expected, const char *what, size_t index)
{
	if (memcmp(&found, &expected, sizeof found) == 0)
		return;
	fail_msg("%s, entry %zu: found %a = %.17g, expected %a = %.17g", what, index, found, found, expected, expected);
}

/* expected: as good as exact, rounded here once */
static void same_value(double found, const mpfr_t expected, unsigned flags, const char *what, size_t index)
{
	const double e =
		flags & EVALUATOR_FLOAT ? (double)mpfr_get_flt(expected, MPFR_RNDN) : mpfr_get_d(expected, MPFR_RNDN);
	same_double(found, e == 0 ? 0.0 : e, what, index);
}

/* |difference| <= bound */
static void within(const mpq_t difference, const mpq_t bound, const char *what)
{
	mpq_t d;
	mpq_init(d);
	mpq_abs(d, difference);
	const int good = mpq_cmp(d, bound) <= 0;
	const double found = mpq_get_d(d), allowed = mpq_get_d(bound);
	mpq_clear(d);
	if (!good)
		fail_msg("%s: difference %a = %.17g, allowed %a = %.17g", what, found, found, allowed, allowed);
}

/* ---- random numbers: the same at every run ---- */

static uint64_t random_state;

static unsigned long random_below(unsigned long n)
{
	random_state = random_state * 6364136223846793005u + 1442695040888963407u;
	return (unsigned long)(random_state >> 33) % n;
}

static void random_rational(mpq_t q, unsigned long top, unsigned long bottom)
{
	mpq_set_si(q, (long)random_below(2 * top + 1) - (long)top, 1 + random_below(bottom));
	mpq_canonicalize(q);
}

/* a vibrating system of n/2 coordinates, or any matrix with some zeros */
static mpq_t *random_matrix(size_t n, int vibration)
{
	mpq_t *A = new_rationals(n * n);
	for (size_t i = 0; i < n; i++)
		for (size_t j = 0; j < n; j++)
			if (vibration && i < n / 2)
				mpq_set_ui(A[i * n + j], j == i + n / 2, 1);
			else if (random_below(4))
				random_rational(A[i * n + j], vibration && j < n / 2 ? 500 : 5, 60);
	return A;
}

/* ---- tests ---- */

static void parser(void **state)
{
	(void)state;
	static const char *good[][2] = {
		{ "1e-12", "1/1000000000000" }, { "-220/3", "-220/3" }, { "0.5", "1/2" }, { "+1.5E3/7", "1500/7" },
		{ "-.25e+1", "-5/2" },          { "0", "0" },           { "6/4", "3/2" }, { "1/-0.2", "-5" },
	};
	static const char *bad[] = { "", "-", ".", "e5", "1e", "1e+", "1/", "1/0", "1x", "1//2", "1.2.3",
			"1e999999999" };
	mpq_t q, expected;
	mpq_inits(q, expected, NULL);
	for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
		assert_int_equal(rational_parse(q, good[i][0]), 0);
		mpq_set_str(expected, good[i][1], 10);
		assert_true(mpq_equal(q, expected));
	}
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		assert_int_equal(rational_parse(q, bad[i]), -1);
	mpq_clears(q, expected, NULL);
}

static void reference_values(void **state)
{
	(void)state;
	FILE *f = fopen(exponentials, "r");
	char name[100];
	size_t n, count = 0;
	mpq_t tau;

	if (!f)
		fail_msg("cannot open %s", exponentials);
	for (int c; (c = getc(f)) == '#';)
		while (c != '\n' && c != EOF)
			c = getc(f);
	mpq_init(tau);
	while (fscanf(f, " %99[^\n]", name) == 1) {
		assert_int_equal(gmp_fscanf(f, "%zu %Qd", &n, tau), 2);
		assert_in_range(n, 1, LARGEST_N);
		mpq_t *A = new_rationals(n * n);
		double expected, E[LARGEST_N * LARGEST_N];
		for (size_t i = 0; i < n * n; i++)
			assert_int_equal(gmp_fscanf(f, "%Qd", A[i]), 1);
		assert_int_equal(exponential(n, A, tau, E), 0);
		for (size_t i = 0; i < n * n; i++) {
			assert_int_equal(fscanf(f, "%la", &expected), 1);
			same_double(E[i], expected, name, i);
		}
		free_rationals(A, n * n);
		count++;
	}
	mpq_clear(tau);
	assert_int_equal(ferror(f), 0);
	fclose(f);
	assert_int_equal(count, 25);
}

/* 1 x 1: e^{a tau}, from overflow through the subnormals to 0, in double and float */
static void scalar(void **state)
{
	(void)state;
	static const char *arguments[] = {
		"1",        "-1",      "0.5",     "1e-12",    "-1e-300", "709.782712893383", "709.782712893384",
		"710",      "-708.5",  "-740.25", "-744.44",  "-745.13", "-745.1332",        "-745.14",
		"88.72283", "88.7229", "-87.5",   "-100.125", "-103.97", "-103.98",          "1e6",
		"-1e6",     "-1e14",   "1/3",     "-22/7",    "5000/3",
	};
	mpq_t q;
	mpfr_t e;
	mpq_init(q);
	mpfr_init2(e, CLOSED_FORM_BITS);
	for (size_t i = 0; i < sizeof arguments / sizeof *arguments; i++)
		for (unsigned flags = 0; flags < 4; flags++) {
			double E;
			exponential_of(1, arguments[i], "1", flags, &E);
			assert_int_equal(rational_parse(q, arguments[i]), 0);
			mpfr_set_q(e, q, MPFR_RNDN);
			if (flags & EVALUATOR_LESS_X)
				mpfr_expm1(e, e, MPFR_RNDN);
			else
				mpfr_exp(e, e, MPFR_RNDN);
			same_value(E, e, flags, arguments[i], flags);
		}
	mpfr_clear(e);
	mpq_clear(q);
}

static void rotation(void **state)
{
	(void)state;
	static const char *angles[] = { "1", "1e-9", "1e-12", "22/7", "355/113", "1e3", "1e5", "123456789.125",
			"1e15" };
	mpq_t q;
	mpfr_t c, s;
	mpq_init(q);
	mpfr_inits2(CLOSED_FORM_BITS, c, s, (mpfr_ptr)NULL);
	for (size_t i = 0; i < sizeof angles / sizeof *angles; i++)
		for (unsigned flags = 0; flags < 4; flags++) {
			double E[4];
			exponential_of(2, "0 1  -1 0", angles[i], flags, E);
			rational_parse(q, angles[i]);
			mpfr_set_q(s, q, MPFR_RNDN);
			mpfr_sin_cos(s, c, s, MPFR_RNDN);
			if (flags & EVALUATOR_LESS_X)
				mpfr_sub_ui(c, c, 1, MPFR_RNDN);
			same_value(E[0], c, flags, angles[i], 0);
			same_value(E[1], s, flags, angles[i], 1);
			mpfr_neg(s, s, MPFR_RNDN);
			same_value(E[2], s, flags, angles[i], 2);
			same_value(E[3], c, flags, angles[i], 3);
		}
	mpfr_clears(c, s, (mpfr_ptr)NULL);
	mpq_clear(q);
}

/* Undamped and stiff, x'' = -1e12 x: units so unequal that every squaring costs 20 bits and the first precisions are of
 * no use */
static void unequal_units(void **state)
{
	(void)state;
	static const char *times[] = { "1e-12", "1e-3", "1", "1e6" };
	mpfr_t c, s, t;
	mpfr_inits2(CLOSED_FORM_BITS, c, s, t, (mpfr_ptr)NULL);
	for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
		mpq_t *angle = matrix(1, times[i]), *w = matrix(1, "1e6");
		double E[4];
		exponential_of(2, "0 1  -1e12 0", times[i], 0, E);
		mpq_mul(angle[0], angle[0], w[0]);
		mpfr_set_q(t, angle[0], MPFR_RNDN);
		mpfr_sin_cos(s, c, t, MPFR_RNDN);
		same_value(E[0], c, 0, times[i], 0);
		same_value(E[3], c, 0, times[i], 3);
		mpfr_div_q(t, s, w[0], MPFR_RNDN);
		same_value(E[1], t, 0, times[i], 1);
		mpfr_mul_q(t, s, w[0], MPFR_RNDN);
		mpfr_neg(t, t, MPFR_RNDN);
		same_value(E[2], t, 0, times[i], 2);
		free_rationals(angle, 1);
		free_rationals(w, 1);
	}
	mpfr_clears(c, s, t, (mpfr_ptr)NULL);
}

/* (I lambda + N) tau: entry (i, j) is e^{lambda tau} tau^k / k!, k = j - i; exact polynomials for lambda = 0 */
static void jordan_block(void **state)
{
	(void)state;
	static const char *cases[][2] = {
		{ "0", "0.01" },  { "0", "1/3" },    { "0", "1e-12" }, { "0", "3" },    { "-2", "0.01" },
		{ "1/3", "1e3" }, { "-7/3", "1e2" }, { "-1e3", "1" },  { "0", "-1/3" }, { "-2", "-1/7" },
	};
	enum { N = 5 };
	mpfr_t e;
	mpfr_init2(e, CLOSED_FORM_BITS);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		mpq_t *A = new_rationals(N * N), *lambda = matrix(1, cases[i][0]), *tau = matrix(1, cases[i][1]),
			  *term = new_rationals(1);
		double E[N * N];
		for (size_t j = 0; j < N; j++) {
			mpq_set(A[j * N + j], lambda[0]);
			if (j + 1 < N)
				mpq_set_ui(A[j * N + j + 1], 1, 1);
		}
		assert_int_equal(exponential(N, A, tau[0], E), 0);
		mpq_set_ui(term[0], 1, 1);
		for (size_t k = 0; k < N; k++) {
			mpq_mul(lambda[0], A[0], tau[0]);
			mpfr_set_q(e, lambda[0], MPFR_RNDN);
			mpfr_exp(e, e, MPFR_RNDN);
			mpfr_mul_q(e, e, term[0], MPFR_RNDN);
			for (size_t j = 0; j + k < N; j++) {
				same_value(E[j * N + j + k], e, 0, cases[i][0], j * N + j + k);
				if (k)
					same_double(E[(j + k) * N + j], 0.0, cases[i][0], (j + k) * N + j);
			}
			mpq_mul(term[0], term[0], tau[0]);
			mpz_mul_ui(mpq_denref(term[0]), mpq_denref(term[0]), k + 1);
			mpq_canonicalize(term[0]);
		}
		free_rationals(A, N * N);
		free_rationals(lambda, 1);
		free_rationals(tau, 1);
		free_rationals(term, 1);
	}
	mpfr_clear(e);
}

/* Two real poles -a, -b far apart, by their partial fractions:
 * Phi_12 = (e^{-a tau} - e^{-b tau}) / (b - a),  Phi_11 = (b e^{-a tau} - a e^{-b tau}) / (b - a),  Phi_21 = -a b
 * Phi_12, Phi_22 = (b e^{-b tau} - a e^{-a tau}) / (b - a) */
static void stiff(void **state)
{
	(void)state;
	static const char *times[] = { "1e-12", "1e-9", "1e-7", "0.01", "1", "1e3", "7e5", "1e6", "1e12" };
	mpfr_t ea, eb, phi[4];
	mpfr_inits2(CLOSED_FORM_BITS, ea, eb, phi[0], phi[1], phi[2], phi[3], (mpfr_ptr)NULL);
	mpq_t *A = matrix(4, "0 1  -100000 -100000000.001"), *a = matrix(1, "0.001"), *b = matrix(1, "1e8"),
		  *ab = matrix(1, "1e5");
	mpq_t *gap = matrix(1, "99999999.999"), *product = new_rationals(1);
	for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
		mpq_t *tau = matrix(1, times[i]);
		double E[4];
		mpq_mul(product[0], a[0], tau[0]);
		mpfr_set_q(ea, product[0], MPFR_RNDN);
		mpfr_neg(ea, ea, MPFR_RNDN);
		mpfr_exp(ea, ea, MPFR_RNDN);
		mpq_mul(product[0], b[0], tau[0]);
		mpfr_set_q(eb, product[0], MPFR_RNDN);
		mpfr_neg(eb, eb, MPFR_RNDN);
		mpfr_exp(eb, eb, MPFR_RNDN);

		mpfr_sub(phi[1], ea, eb, MPFR_RNDN);
		mpfr_mul_q(phi[2], phi[1], ab[0], MPFR_RNDN);
		mpfr_neg(phi[2], phi[2], MPFR_RNDN);
		mpfr_mul_q(phi[0], ea, b[0], MPFR_RNDN);
		mpfr_mul_q(phi[3], eb, a[0], MPFR_RNDN);
		mpfr_sub(phi[0], phi[0], phi[3], MPFR_RNDN);
		mpfr_mul_q(phi[3], eb, b[0], MPFR_RNDN);
		mpfr_mul_q(ea, ea, a[0], MPFR_RNDN);
		mpfr_sub(phi[3], phi[3], ea, MPFR_RNDN);

		assert_int_equal(exponential(2, A, tau[0], E), 0);
		for (size_t j = 0; j < 4; j++) {
			mpfr_div_q(phi[j], phi[j], gap[0], MPFR_RNDN);
			same_value(E[j], phi[j], 0, times[i], j);
		}
		free_rationals(tau, 1);
	}
	free_rationals(A, 4);
	free_rationals(a, 1);
	free_rationals(b, 1);
	free_rationals(ab, 1);
	free_rationals(gap, 1);
	free_rationals(product, 1);
	mpfr_clears(ea, eb, phi[0], phi[1], phi[2], phi[3], (mpfr_ptr)NULL);
}

/* Exact rationals at and near the midpoints, the smallest and the largest numbers: Phi_12 = a tau of [[0, a], [0, 0]]
 */
static void rounding(void **state)
{
	(void)state;
	static const struct {
		const char *name;
		long odd, power, plus, plus_power;              /* odd 2^power + plus 2^plus_power */
		double expected;
		unsigned flags;
	} cases[] = {
		{ "half the least subnormal", 1, -1075, 0, 0, 0.0, 0 },
		{ "the same, negative", -1, -1075, 0, 0, 0.0, 0 },
		{ "a little more", 1, -1075, 1, -1300, 0x1p-1074, 0 },
		{ "three halves", 3, -1075, 0, 0, 0x1p-1073, 0 },
		{ "five halves", 5, -1075, 0, 0, 0x1p-1073, 0 },
		{ "five halves and more", -5, -1075, -1, -2000, -0x3p-1074, 0 },
		{ "tie to even below", (1L << 53) + 1, 0, 0, 0, 0x1p53, 0 },
		{ "tie to even above", (1L << 53) + 3, 0, 0, 0, 0x1p53 + 4, 0 },
		{ "above a tie", (1L << 53) + 1, 0, 1, -200, 0x1p53 + 2, 0 },
		{ "below a tie", (1L << 53) + 1, 0, -1, -200, 0x1p53, 0 },
		{ "largest double", (1L << 53) - 1, 971, 0, 0, 0x1.fffffffffffffp1023, 0 },
		{ "below overflow", (1L << 54) - 1, 970, -1, 0, 0x1.fffffffffffffp1023, 0 },
		{ "overflow", (1L << 54) - 1, 970, 0, 0, INFINITY, 0 },
		{ "overflow, negative", 1 - (1L << 54), 970, 0, 0, -INFINITY, 0 },
		{ "float, not via double", 1, 0, (1L << 30) + 1, -54, 0x1.000002p0, EVALUATOR_FLOAT },
		{ "float tie", 1, 0, 1, -24, 1.0, EVALUATOR_FLOAT },
		{ "float subnormal tie", 3, -150, 0, 0, 0x1p-148, EVALUATOR_FLOAT },
		{ "float subnormal, not via double", 3, -150, -1, -300, 0x1p-149, EVALUATOR_FLOAT },
		{ "float overflow", (1L << 25) - 1, 103, 0, 0, INFINITY, EVALUATOR_FLOAT },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		const long powers[2] = { cases[i].power, cases[i].plus_power },
				factors[2] = { cases[i].odd, cases[i].plus };
		mpq_t *A = new_rationals(4), *x = matrix(2, "0 1"), *tau = matrix(1, "3"), *part = new_rationals(1);
		double y[2];
		for (size_t j = 0; j < 2; j++) {
			mpq_set_si(part[0], factors[j], 3);
			mpq_canonicalize(part[0]);
			if (powers[j] >= 0)
				mpq_mul_2exp(part[0], part[0], (mp_bitcnt_t)powers[j]);
			else
				mpq_div_2exp(part[0], part[0], (mp_bitcnt_t)-powers[j]);
			mpq_add(A[1], A[1], part[0]);
		}
		assert_int_equal(evaluator_round(2, (const mpq_t *)A, tau[0], 1, (const mpq_t *)x, cases[i].flags, y),
				0);
		same_double(y[0], cases[i].expected, cases[i].name, i);
		same_double(y[1], 1.0, cases[i].name, i);
		free_rationals(A, 4);
		free_rationals(x, 2);
		free_rationals(tau, 1);
		free_rationals(part, 1);
	}
}

/* Zero at one tau only, out of all range, and exponents that saturate */
static void extremes(void **state)
{
	(void)state;
	double E[4];

	evaluator_presumed_zeros = 0;
	exponential_of(2, "0 1  -10000 -200", "0.01", 0, E);
	same_double(E[3], 0.0, "critically damped", 3);
	assert_int_equal(evaluator_presumed_zeros, 1);
	exponential_of(2, "0 1  -10000 -200", "0.01000000000000000000000000000001", 0, E);
	assert_true(E[3] < -3e-31 && E[3] > -4e-31);

	exponential_of(2, "-1e30 0  1 -1e29", "1", 0, E);
	for (size_t i = 0; i < 4; i++)
		same_double(E[i], 0.0, "e^{-1e29}", i);
	exponential_of(1, "1e30", "1", 0, E);
	same_double(E[0], INFINITY, "e^{1e30}", 0);
	exponential_of(2, "-1e30 0  0 -1e25", "1", EVALUATOR_LESS_X, E);
	same_double(E[0], -1.0, "e^{-1e30} - 1", 0);
	same_double(E[3], -1.0, "e^{-1e25} - 1", 3);
	exponential_of(2, "1 2  3 4", "0", 0, E);
	for (size_t i = 0; i < 4; i++)
		same_double(E[i], i % 3 == 0, "tau = 0", i);

	/* e^{-1e5} beside e^{1e5}: more than 16384 bits apart, and one radius for both.  Given up, not guessed. */
	mpq_t *A = matrix(4, "1e5 0  0 -1e5"), *one = matrix(1, "1");
	assert_int_equal(exponential(2, A, one[0], E), -1 - 3);
	same_double(E[0], INFINITY, "e^{1e5}", 0);
	free_rationals(A, 4);
	free_rationals(one, 1);
}

/* apply, and the increment, against sums of 1500-bit midpoints; apply to unit vectors is a column */
static void combinations(void **state)
{
	(void)state;
	random_state = 1;
	for (int round = 0; round < 60; round++) {
		const size_t n = 1 + random_below(7);
		mpq_t *A = random_matrix(n, round % 2), *x = new_rationals(n), *tau = new_rationals(1),
			  *I = new_rationals(n * n);
		mpfr_t *M = malloc(n * n * sizeof *M), sum, term;
		double E[49], D[49], y[7];

		assert_non_null(M);
		for (size_t i = 0; i < n * n; i++)
			mpfr_init(M[i]);
		mpfr_inits2(CLOSED_FORM_BITS, sum, term, (mpfr_ptr)NULL);
		do
			random_rational(tau[0], 9, 1u << random_below(12));
		while (!mpq_sgn(tau[0]));
		for (size_t i = 0; i < n; i++) {
			random_rational(x[i], 1000, 77);
			mpq_set_ui(I[i * n + i], 1, 1);
		}
		assert_int_equal(exponential(n, A, tau[0], E), 0);
		assert_int_equal(apply(n, A, tau[0], x, y), 0);
		assert_int_equal(evaluator_round(n, (const mpq_t *)A, tau[0], n, (const mpq_t *)I, EVALUATOR_LESS_X,
				D), 0);
		assert_int_equal(evaluator_midpoints(n, (const mpq_t *)A, tau[0], 1500, M), 0);
		for (size_t i = 0; i < n; i++) {
			mpfr_set_ui(sum, 0, MPFR_RNDN);
			for (size_t j = 0; j < n; j++) {
				same_value(E[i * n + j], M[i * n + j], 0, "entry", i * n + j);
				mpfr_mul_q(term, M[i * n + j], x[j], MPFR_RNDN);
				mpfr_add(sum, sum, term, MPFR_RNDN);
				mpfr_sub_ui(term, M[i * n + j], i == j, MPFR_RNDN);
				same_value(D[i * n + j], term, 0, "increment", i * n + j);
			}
			same_value(y[i], sum, 0, "apply", i);
		}
		for (size_t j = 0; j < n; j++) {
			for (size_t i = 0; i < n; i++)
				mpq_set(x[i], I[i * n + j]);
			assert_int_equal(apply(n, A, tau[0], x, y), 0);
			for (size_t i = 0; i < n; i++)
				same_double(y[i], E[i * n + j], "column", i * n + j);
		}
		for (size_t i = 0; i < n * n; i++)
			mpfr_clear(M[i]);
		free(M);
		mpfr_clears(sum, term, (mpfr_ptr)NULL);
		free_rationals(A, n * n);
		free_rationals(x, n);
		free_rationals(tau, 1);
		free_rationals(I, n * n);
	}
}

/* q <- z 2^exponent */
static void dyadic(mpq_t q, const mpz_t z, long exponent)
{
	mpq_set_z(q, z);
	if (exponent >= 0)
		mpq_mul_2exp(q, q, (mp_bitcnt_t)exponent);
	else
		mpq_div_2exp(q, q, (mp_bitcnt_t)-exponent);
}

typedef struct {
	size_t n;
	mpq_t *mid, radius, norm;                           /* norm: largest absolute row sum of mid, plus radius */
} rational_enclosure;

static void enclose(mpq_t *A, const mpq_t tau, unsigned long bits, rational_enclosure *R, size_t n)
{
	evaluator_enclosure E;
	mpq_t sum, term;

	evaluator_enclosure_init(&E, n);
	assert_int_equal(evaluator_enclose((const mpq_t *)A, tau, bits, &E), 0);
	mpq_inits(sum, term, R->radius, R->norm, NULL);
	R->n = n;
	R->mid = new_rationals(n * n);
	dyadic(R->radius, E.radius, E.exponent);
	for (size_t i = 0; i < n; i++) {
		mpq_set_ui(sum, 0, 1);
		for (size_t j = 0; j < n; j++) {
			dyadic(R->mid[i * n + j], E.mid[i * n + j], E.exponent);
			mpq_abs(term, R->mid[i * n + j]);
			mpq_add(sum, sum, term);
		}
		if (mpq_cmp(sum, R->norm) > 0)
			mpq_set(R->norm, sum);
	}
	/* the promised accuracy: radius <= 2^-bits max <= 2^-bits norm */
	mpq_div_2exp(term, R->norm, bits);
	within(R->radius, term, "radius of an enclosure");
	mpq_add(R->norm, R->norm, R->radius);
	mpq_clears(sum, term, NULL);
	evaluator_enclosure_clear(&E);
}

static void release(rational_enclosure *R)
{
	free_rationals(R->mid, R->n * R->n);
	mpq_clears(R->radius, R->norm, NULL);
}

/* e^{A (t1 + t2)} = e^{A t1} e^{A t2}, 500 bits, in rationals; the allowance is what the three radii allow and no more
 */
static void semigroup(void **state)
{
	(void)state;
	random_state = 2;
	for (int round = 0; round < 60; round++) {
		const size_t n = 1 + random_below(6);
		mpq_t *A = random_matrix(n, round % 3 != 0), *t = new_rationals(3), *work = new_rationals(3);
		rational_enclosure E[3];

		random_rational(t[0], 9, 1u << random_below(12));
		random_rational(t[1], 200, 1u << random_below(12));
		mpq_add(t[2], t[0], t[1]);
		for (size_t k = 0; k < 3; k++)
			enclose(A, t[k], 500, &E[k], n);
		/* r1 norm2 + norm1 r2 + r3 */
		mpq_mul(work[0], E[0].radius, E[1].norm);
		mpq_mul(work[1], E[0].norm, E[1].radius);
		mpq_add(work[0], work[0], work[1]);
		mpq_add(work[0], work[0], E[2].radius);
		for (size_t i = 0; i < n; i++)
			for (size_t j = 0; j < n; j++) {
				mpq_neg(work[1], E[2].mid[i * n + j]);
				for (size_t l = 0; l < n; l++) {
					mpq_mul(work[2], E[0].mid[i * n + l], E[1].mid[l * n + j]);
					mpq_add(work[1], work[1], work[2]);
				}
				within(work[1], work[0], "semigroup");
			}
		for (size_t k = 0; k < 3; k++)
			release(&E[k]);
		free_rationals(A, n * n);
		free_rationals(t, 3);
		free_rationals(work, 3);
	}
}

/* An enclosure of few bits holds the midpoint of one with many, but for the radius of that */
static void enclosures_enclose(void **state)
{
	(void)state;
	random_state = 3;
	for (int round = 0; round < 100; round++) {
		const size_t n = 1 + random_below(8);
		mpq_t *A = random_matrix(n, round % 3 != 0), *work = new_rationals(2), *tau = new_rationals(1);
		rational_enclosure coarse, fine;

		random_rational(tau[0], 90, 1u << random_below(12));
		enclose(A, tau[0], 1 + random_below(60), &coarse, n);
		enclose(A, tau[0], 700, &fine, n);
		mpq_add(work[0], coarse.radius, fine.radius);
		for (size_t i = 0; i < n * n; i++) {
			mpq_sub(work[1], coarse.mid[i], fine.mid[i]);
			within(work[1], work[0], "enclosure");
		}
		release(&coarse);
		release(&fine);
		free_rationals(A, n * n);
		free_rationals(work, 2);
		free_rationals(tau, 1);
	}
}

static int free_caches(void **state)
{
	(void)state;
	mpfr_free_cache();
	return 0;
}

int main(int argc, char **argv)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(parser),
		cmocka_unit_test(reference_values),
		cmocka_unit_test(scalar),
		cmocka_unit_test(rotation),
		cmocka_unit_test(unequal_units),
		cmocka_unit_test(jordan_block),
		cmocka_unit_test(stiff),
		cmocka_unit_test(rounding),
		cmocka_unit_test(extremes),
		cmocka_unit_test(combinations),
		cmocka_unit_test(semigroup),
		cmocka_unit_test(enclosures_enclose),
	};
	if (argc > 1)
		exponentials = argv[1];
	else if (getenv("EXPONENTIALS"))
		exponentials = getenv("EXPONENTIALS");
	return cmocka_run_group_tests(tests, NULL, free_caches);
}
