/* SPDX-License-Identifier: MIT-0 */
/* runtime/power.c against closed forms in MPFR. */
#include "runtime.h"

enum { BITS = 400 };

/* UNIT: what a step loses, of the whole.  NUMBERS: how many Fibonacci numbers fit two words.  2^(MANY + FEW) is within
 * the range, 2^(2 MANY) beyond it. */
#ifdef REAL_IS_FLOAT
#define UNIT 0x1p-46
enum { NUMBERS = 66, MANY = 75, FEW = 45, COUPLED = 101 };
static const uint64_t counts[] = {1, 2, 3, 1000, 123456789, 1000000000};
#else
#define UNIT 0x1p-104
enum { NUMBERS = 150, MANY = 600, FEW = 420, COUPLED = 1001 };
static const uint64_t counts[] = {1, 2, 3, 1000, 123456789, 1000000000, 1000000000000};
#endif
enum { COUNTS = sizeof counts / sizeof counts[0] };

static double worst; /* error, in tolerances */

static void assert_within(pl_two found, mpfr_t expected, double tolerance, const char *what, uint64_t k)
{
	mpfr_t error;
	double off;
	mpfr_init2(error, BITS);
	set_two(error, found);
	mpfr_sub(error, error, expected, MPFR_RNDN);
	off = mpfr_get_d(error, MPFR_RNDN);
	mpfr_clear(error);
	if (fabs(off) > worst * tolerance)
		worst = fabs(off) / tolerance;
	if (!(fabs(off) <= tolerance)) {
		pl_two e = two_of(expected);
		fail_msg("%s, k = %" PRIu64 ": found %.17g + %.17g, expected %.17g + %.17g; off by %.17g, "
			 "tolerance %.17g",
				 what, k, found.hi, found.lo, e.hi, e.lo, off, tolerance);
	}
}

static void assert_double(double found, double expected, const char *what)
{
	if (found != expected)
		fail_msg("%s: found %.17g, expected %.17g, exactly", what, found, expected);
}

/* A rotation by 0.05 a step, from (1, 0).  What its two-word entries are off by is 2^-107 each, or 2^-49, k times; so
 * is what the powers lose. */
static void rotation(void **state)
{
	mpfr_t angle, c, s;
	size_t i;
	(void)state;
	mpfr_inits2(BITS, angle, c, s, (mpfr_ptr)0);
	for (i = 0; i < COUNTS; i++) {
		pl_two P[4], W[4], x[2], w[2];
		const double tolerance = (double)counts[i] * UNIT;
		mpfr_set_d(angle, 0.05, MPFR_RNDN);
		mpfr_sin_cos(s, c, angle, MPFR_RNDN);
		P[0] = P[3] = two_of(c);
		P[2] = two_of(s);
		P[1].hi = -P[2].hi;
		P[1].lo = -P[2].lo;
		x[0] = word_of(1.0);
		x[1] = word_of(0.0);
		pl_power_apply(2, P, W, x, w, counts[i]);
		mpfr_mul_ui(angle, angle, (unsigned long)counts[i], MPFR_RNDN);
		mpfr_sin_cos(s, c, angle, MPFR_RNDN);
		assert_within(x[0], c, tolerance, "cosine", counts[i]);
		assert_within(x[1], s, tolerance, "sine", counts[i]);
	}
	mpfr_clears(angle, c, s, (mpfr_ptr)0);
}

/* Entries as the numbers they are, powered in MPFR by repeated squaring: a 3 x 3 matrix, coupled and of all signs. */
static void coupled(void **state)
{
	const real entries[9] = {0.5, -0.75, (real)0.1, (real)0.7, (real)0.4, (real)-0.3,
							 (real)0.2, (real)0.3, (real)0.6};
	mpfr_t P[9], Q[9], x[3], y[3], t;
	int i, j, k, bit;
	const uint64_t count = COUPLED;
	pl_two p[9], W[9], v[3], w[3];
	(void)state;
	mpfr_init2(t, BITS);
	for (i = 0; i < 9; i++) {
		mpfr_init2(P[i], BITS);
		mpfr_init2(Q[i], BITS);
		mpfr_set_d(P[i], entries[i], MPFR_RNDN);
		p[i] = word_of(entries[i]);
	}
	for (i = 0; i < 3; i++) {
		mpfr_init2(x[i], BITS);
		mpfr_init2(y[i], BITS);
		v[i] = word_of(1.0 + 0.3 * i);
		set_two(x[i], v[i]);
	}
	for (bit = 0; count >> bit != 0; bit++) {
		if (count >> bit & 1) {
			for (i = 0; i < 3; i++) {
				mpfr_set_zero(y[i], 1);
				for (j = 0; j < 3; j++) {
					mpfr_mul(t, P[3 * i + j], x[j], MPFR_RNDN);
					mpfr_add(y[i], y[i], t, MPFR_RNDN);
				}
			}
			for (i = 0; i < 3; i++)
				mpfr_set(x[i], y[i], MPFR_RNDN);
		}
		for (i = 0; i < 3; i++)
			for (j = 0; j < 3; j++) {
				mpfr_set_zero(Q[3 * i + j], 1);
				for (k = 0; k < 3; k++) {
					mpfr_mul(t, P[3 * i + k], P[3 * k + j], MPFR_RNDN);
					mpfr_add(Q[3 * i + j], Q[3 * i + j], t, MPFR_RNDN);
				}
			}
		for (i = 0; i < 9; i++)
			mpfr_set(P[i], Q[i], MPFR_RNDN);
	}
	pl_power_apply(3, p, W, v, w, count);
	for (i = 0; i < 3; i++)
		assert_within(v[i], x[i],
					  (double)count * UNIT *
			  fmax(fabs((double)v[0].hi), fmax(fabs((double)v[1].hi), fabs((double)v[2].hi))),
					  "coupled", count);
	for (i = 0; i < 9; i++)
		mpfr_clears(P[i], Q[i], (mpfr_ptr)0);
	for (i = 0; i < 3; i++)
		mpfr_clears(x[i], y[i], (mpfr_ptr)0);
	mpfr_clear(t);
}

/* Integers stay exact: Fibonacci numbers up to 2^104, or 2^46. */
static void fibonacci(void **state)
{
	uint64_t k;
	mpz_t f;
	mpfr_t v;
	(void)state;
	mpz_init(f);
	mpfr_init2(v, BITS);
	for (k = 1; k <= NUMBERS; k++) {
		pl_two P[4], W[4], x[2], w[2];
		P[0] = P[1] = P[2] = word_of(1.0);
		P[3] = word_of(0.0);
		x[0] = word_of(1.0);
		x[1] = word_of(0.0);
		pl_power_apply(2, P, W, x, w, k);
		mpz_fib_ui(f, (unsigned long)k);
		mpfr_set_z(v, f, MPFR_RNDN);
		assert_within(x[1], v, 0.0, "Fibonacci number", k);
	}
	mpz_clear(f);
	mpfr_clear(v);
}

static void no_steps(void **state)
{
	pl_two P[4], W[4], x[2], w[2];
	int i;
	(void)state;
	for (i = 0; i < 4; i++)
		P[i] = word_of(3.0);
	x[0].hi = (real)0.1;
	x[0].lo = (real)1e-18;
	x[1].hi = -INFINITY;
	x[1].lo = 0;
	pl_power_apply(2, P, W, x, w, 0);
	assert_double(x[0].hi, (double)(real)0.1, "high word");
	assert_double(x[0].lo, (double)(real)1e-18, "low word");
	assert_double(x[1].hi, -(double)INFINITY, "high word");
}

/* diag(growing block, decaying entry): the block overflows, the other is as if alone. */
static void overflow_is_infinite_and_stays_where_it_is(void **state)
{
	pl_two P[9], W[9], x[3], w[3];
	int i, sign;
	(void)state;
	for (sign = -1; sign <= 1; sign += 2) {
		for (i = 0; i < 9; i++)
			P[i] = word_of(0.0);
		P[0] = P[4] = word_of(1.5); /* growing, turning the other way round */
		P[1] = word_of(-0.75);
		P[3] = word_of(0.75);
		P[8] = word_of(0.5);
		x[0] = word_of(sign);
		x[1] = word_of(-0.25);
		x[2] = word_of(3.0);
		pl_power_apply(3, P, W, x, w, 1000000);
		for (i = 0; i < 2; i++)
			if (!isinf(x[i].hi) || x[i].lo != 0)
				fail_msg("entry %d: found %.17g + %.17g, expected an infinity", i, x[i].hi, x[i].lo);
		assert_double(x[2].hi, 0.0, "decoupled entry");
	}
	for (i = 0; i < 9; i++)
		P[i] = word_of(0.0);
	P[0] = P[1] = P[3] = P[4] = word_of(1.5);
	P[8] = word_of(-1.0);
	x[0] = x[1] = word_of(1.0);
	x[2] = word_of(5.0);
	pl_power_apply(3, P, W, x, w, UINT64_MAX);
	assert_double(x[0].hi, (double)INFINITY, "growing entry");
	assert_double(x[2].hi, -5.0, "decoupled entry");
}

/* Large terms of both signs meet before the sum is known to fit, or not to. */
static void overflow_has_the_sign_of_the_sum(void **state)
{
	pl_two P[9], W[9], x[3], w[3];
	int i;
	(void)state;
	for (i = 0; i < 9; i++)
		P[i] = word_of(0.0);
	P[0] = word_of(ldexp(1.0, MANY));
	P[1] = word_of(-ldexp(1.0, MANY));
	P[2] = word_of(-ldexp(1.0, MANY));
	P[3] = word_of(ldexp(1.0, MANY));
	P[4] = word_of(-ldexp(1.0, MANY));
	P[5] = word_of(ldexp(1.0, FEW));
	x[0] = x[1] = x[2] = word_of(ldexp(1.0, MANY));
	pl_power_apply(3, P, W, x, w, 1);
	assert_double(x[0].hi, -(double)INFINITY, "+inf - inf - inf");
	assert_double(x[1].hi, ldexp(1.0, MANY + FEW), "+inf - inf + a power of 2");
	assert_double(x[2].hi, 0.0, "no terms");
}

/* y0 doubles at each step and y1 triples and gains 1: two independent blocks, the second state's first.  NAME_run takes
 * four steps at once where it can: run.h and jump.h without the generator */
typedef struct paired {
	real y[2];
	int k;
} paired;
typedef struct paired_entry {
	int row, column;
	pl_two value;
} paired_entry;
static const real paired_Phi[2][2] = {{2, 0}, {0, 3}}, paired_Phi_low[2][2] = {{0}};
static const unsigned short paired_block_first[] = {0, 1, 2}, paired_block_state[] = {1, 0};
static const paired_entry paired_power_entry[] = {{1, 2, {1, 0}}, {2, 2, {1, 0}}};
static int blocks; /* taken at once */

static void paired_leap_loads(const paired *s, pl_two load[])
{
	(void)s;
	load[0] = word_of(1.0);
}

static void paired_pass_steps(paired *s, uint64_t n)
{
	s->k += (int)n;
}

static void paired_step(paired *s)
{
	s->y[0] = 2 * s->y[0];
	s->y[1] = 3 * s->y[1] + 1;
	s->k++;
}

static void paired_out(const paired *s, real out[1])
{
	out[0] = s->y[0] + s->y[1];
}

static void paired_block(paired *s, real *out)
{
	int i;
	for (i = 0; i < 4; i++) {
		paired_step(s);
		if (out)
			paired_out(s, out + i);
	}
	blocks++;
}

/* y triples at each step of 1 s and gains 1, after 4 s 2, after 9 s 0: jump.h without the generator */
typedef struct tripled {
	real y[1], low[1];
	int segment, k;
} tripled;
typedef struct tripled_entry {
	int segment, row, column;
	pl_two value;
} tripled_entry;
static const real tripled_Phi[1][1] = {{3}}, tripled_Phi_low[1][1] = {{0}};
static const tripled_entry tripled_power_entry[] = {
	{0, 0, 1, {1, 0}}, {0, 1, 1, {1, 0}}, {1, 0, 1, {2, 0}}, {1, 1, 1, {1, 0}}, {2, 1, 1, {1, 0}},
};
static int crossed; /* changes, in a step */

static real tripled_until(const tripled *s, int change)
{
	return (real)(change ? 9 : 4) - (real)s->k;
}

static void tripled_leap_loads(const tripled *s, pl_two load[])
{
	(void)s;
	load[0] = word_of(1.0);
}

static void tripled_pass_steps(tripled *s, uint64_t n)
{
	s->k += (int)n;
}

static double tripled_sum(const tripled *s)
{
	return (double)s->y[0] + (double)s->low[0];
}

static void tripled_step(tripled *s)
{
	const int before = s->segment;
	const double next = 3 * tripled_sum(s) + (before == 0 ? 1 : before == 1 ? 2 : 0);
	s->y[0] = (real)next;
	s->low[0] = (real)(next - (double)s->y[0]);
	s->k++;
	while (s->segment < 2 && tripled_until(s, s->segment) <= 0)
		s->segment++;
	crossed += s->segment != before;
}

#define PL_SINGLE SINGLE
#define PL(name) tripled_##name
#define PL_TYPE tripled
#define PL_STATES 1
#define PL_LOAD_STATES 1
#define PL_SIZE 2
#define PL_SEGMENTS 3
#define PL_BLOCKS 1
#define PL_COMPENSATED 1
#define PL_PHI tripled_Phi
#define PL_ENTRIES 5
#define PL_H 1
void tripled_jump(tripled *s, uint64_t n);
#include "jump.h"

static void from_change_to_change(void **state)
{
	int n, k;
	(void)state;
	for (n = 0; n <= 20; n++) {
		tripled stepped = {{1}, {0}, 0, 0}, jumped = stepped;
		for (k = 0; k < n; k++)
			tripled_step(&stepped);
		crossed = 0;
		tripled_jump(&jumped, (uint64_t)n);
		assert_double(tripled_sum(&jumped), tripled_sum(&stepped), "the state");
		assert_int_equal(jumped.k, n);
		assert_int_equal(crossed, n < 4 ? 0 : n < 9 ? 1 : 2);
	}
}

#define PL_SINGLE SINGLE
#define PL(name) paired_##name
#define PL_TYPE paired
#define PL_STATES 2
#define PL_LOAD_STATES 1
#define PL_SIZE 2
#define PL_BLOCKS 2
#define PL_PHI paired_Phi
#define PL_ENTRIES 2
#define PL_H 1
void paired_jump(paired *s, uint64_t n);
#include "jump.h"

#define PL_SINGLE SINGLE
#define PL(name) paired_##name
#define PL_TYPE paired
#define PL_STATES 2
#define PL_OUTPUTS 1
#define PL_ROWS 4
void paired_run(paired *s, size_t n, real *out);
#include "run.h"

static void by_blocks(void **state)
{
	int n, k;
	(void)state;
	for (n = 0; n <= 12; n++) {
		paired stepped = {{1, 0}, 0}, jumped = stepped, run = stepped;
		real row[12], sum[1];
		blocks = 0;
		paired_run(&run, (size_t)n, row);
		assert_int_equal(blocks, n / 4);
		for (k = 0; k < n; k++) {
			paired_step(&stepped);
			paired_out(&stepped, sum);
			assert_double((double)row[k], (double)sum[0], "a row");
		}
		paired_jump(&jumped, (uint64_t)n);
		for (k = 0; k < 2; k++)
			assert_double((double)jumped.y[k], (double)stepped.y[k], "a state");
		assert_int_equal(jumped.k, n);
		assert_int_equal(run.k, n);
	}
}

/* States halve at each step.  Where a multiple of 64 steps is passed what is below `lowest` becomes 0: of `faded` in
 * two parts, not in a third, which does not decay; of `faded_whole` with what rounding took. */
typedef struct faded {
	real y[3], low[3];
	int k;
} faded;
typedef struct faded faded_whole;
static const short faded_flush_part[] = {0, 1, 2};
#ifdef REAL_IS_FLOAT
static const real lowest = (real)0x1p-116, beside = (real)0x1p-120;
#else
static const real lowest = 0x1p-963, beside = 0x1p-900;
#endif

#define PL_SINGLE SINGLE
#define PL(name) faded_##name
#define PL_TYPE faded
#define PL_STATES 3
#define PL_FLUSHES 3
#define PL_DECAYING 2
#include "flush.h"

#define PL_SINGLE SINGLE
#define PL(name) faded_whole_##name
#define PL_TYPE faded_whole
#define PL_STATES 3
#define PL_FLUSHES 1
#define PL_DECAYING 1
#define PL_FLUSHES_BESIDE 1
#define PL_COMPENSATED 1
#include "flush.h"

static void halve(faded *s)
{
	int i;
	for (i = 0; i < 3; i++)
		s->y[i] /= 2;
	s->k++;
}

static void faded_step(faded *s)
{
	halve(s);
	if ((s->k & 63) == 0)
		faded_flush(s);
}

static void faded_whole_step(faded *s)
{
	halve(s);
	if ((s->k & 63) == 0)
		faded_whole_flush(s);
}

static void faded_out(const faded *s, real out[1])
{
	out[0] = s->y[0];
}

static void faded_block(faded *s, real *out)
{
	int i;
	for (i = 0; i < 4; i++) {
		halve(s);
		if (out)
			faded_out(s, out + i);
	}
}

#define faded_whole_out faded_out
#define faded_whole_block faded_block

#define PL_SINGLE SINGLE
#define PL(name) faded_##name
#define PL_TYPE faded
#define PL_STATES 3
#define PL_OUTPUTS 1
#define PL_ROWS 4
#define PL_FLUSHES 1
void faded_run(faded *s, size_t n, real *out);
#include "run.h"

#define PL_SINGLE SINGLE
#define PL(name) faded_whole_##name
#define PL_TYPE faded_whole
#define PL_STATES 3
#define PL_OUTPUTS 1
#define PL_ROWS 4
#define PL_FLUSHES 1
void faded_whole_run(faded_whole *s, size_t n, real *out);
#include "run.h"

/* After n steps from step k, from so many times what is lowest then */
static faded fading(void (*run)(faded *, size_t, real *), int k, int n, double a, double b, double c)
{
	faded s = {{0}, {1, 1, 1}, 0};
	s.k = k;
	s.y[0] = (real)ldexp(a * (double)lowest, n);
	s.y[1] = (real)ldexp(b * (double)lowest, n);
	s.y[2] = (real)ldexp(c * (double)lowest, n);
	run(&s, (size_t)n, NULL);
	return s;
}

static void small_states_become_0(void **state)
{
	static const int start[] = {60, 61, 62, 63, 63, 124, 64, 60, 65}, steps[] = {4, 4, 4, 4, 1, 4, 4, 3, 4};
	size_t i;
	(void)state;
	for (i = 0; i < sizeof start / sizeof *start; i++) {
		const int flushes = i < 6;
		faded s = fading(faded_run, start[i], steps[i], 0.9, 1.1, 0.9);
		assert_int_equal(s.y[0] > 0, !flushes);
		assert_true(s.y[1] > 0 && s.y[2] > 0);
		s = fading(faded_run, start[i], steps[i], -1.1, -0.9, 0.9);
		assert_int_equal(s.y[1] < 0, !flushes);
		assert_true(s.y[0] < 0 && s.y[2] > 0);
		s = fading(faded_whole_run, start[i], steps[i], -0.9, 1.1, 0.9);
		assert_int_equal(s.y[0] < 0 && s.y[2] > 0 && s.low[0] > 0 && s.low[2] > 0, !flushes);
		assert_int_equal(s.y[0] < 0 || s.y[2] > 0 || s.low[0] > 0 || s.low[2] > 0, !flushes);
		assert_true(s.y[1] > 0 && s.low[1] > 0);
	}
}

/* Beside the largest of their part: the first is 0 before 1 and stays before what is not finite, or as small */
static void states_are_small_beside_others(void **state)
{
	const real unit = 256, size[] = {unit, 2 * unit, 1 / beside, (real)INFINITY, unit * beside};
	size_t i;
	(void)state;
	for (i = 0; i < sizeof size / sizeof *size; i++) {
		faded s = {{(real)1.1 * unit * beside, (real)0.9 * unit * beside, size[i]}, {1, 1, 1}, 64};
		faded_whole_flush(&s);
		assert_int_equal(s.y[0] > 0, i != 1);
		assert_int_equal(s.y[1] > 0, i > 1);
		assert_true(s.y[2] >= size[i]);
	}
}

static void report(void)
{
	print_message("# largest error of pl_power_apply: %.2g k 2^%d\n", worst, ilogb(UNIT));
}

ROOM_WITH(power, NULL, report,
	cmocka_unit_test(rotation),
	cmocka_unit_test(coupled),
	cmocka_unit_test(fibonacci),
	cmocka_unit_test(no_steps),
	cmocka_unit_test(overflow_is_infinite_and_stays_where_it_is),
	cmocka_unit_test(overflow_has_the_sign_of_the_sum),
	cmocka_unit_test(small_states_become_0),
	cmocka_unit_test(states_are_small_beside_others),
	cmocka_unit_test(from_change_to_change),
	cmocka_unit_test(by_blocks))
