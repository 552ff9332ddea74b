/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What gen/math/positive.c says of random sums of waves, against their values at many times, in long double. */
#include "math/math.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

enum { MOST = 4, CASES = 400, SAMPLES = 4000 };

static uint64_t seed = 11;

static long drawn(long least, long most)
{
	seed = seed * 6364136223846793005u + 1442695040888963407u;
	return least + (long)((seed >> 33) % (uint64_t)(most - least + 1));
}

struct known {
	struct summand summand[MOST];
	mpq_t number[MOST][4];
	int count;
};

static void set_summand(struct known *k, long tenths, int power, long a, long w, long p, bool sine)
{
	mpq_t *number = k->number[k->count];
	const long value[4] = { tenths, a, w, p };
	for (int i = 0; i < 4; i++) {
		mpq_init(number[i]);
		mpq_set_si(number[i], value[i], 10);
		mpq_canonicalize(number[i]);
	}
	k->summand[k->count++] = (struct summand){ number[0], number[1], number[2], number[3], power, sine };
}

static long double value_at(const struct known *k, long double t)
{
	long double sum = 0;
	for (int i = 0; i < k->count; i++) {
		const struct summand *s = &k->summand[i];
		const long double angle = (long double)mpq_get_d(s->w) * t + (long double)mpq_get_d(s->p);
		sum += (long double)mpq_get_d(s->factor) * powl(t, s->power) * expl((long double)mpq_get_d(s->a) * t) *
			   (s->sine ? sinl(angle) : cosl(angle));
	}
	return sum;
}

static bool says(const struct known *k, long from_tenths, long to_tenths)
{
	mpq_t from, to;
	mpq_inits(from, to, NULL);
	mpq_set_si(from, from_tenths, 10);
	mpq_set_si(to, to_tenths, 10);
	mpq_canonicalize(from);
	mpq_canonicalize(to);
	const bool is = sum_stays_positive(k->count, k->summand, from, to_tenths < 0 ? NULL : to);
	mpq_clears(from, to, NULL);
	return is;
}

/* In a finite time what is above 0 is seen to be so; what falls below is never said to stay. */
static void sums_over_a_time(void **state)
{
	(void)state;
	int above = 0;
	for (int c = 0; c < CASES; c++) {
		struct known k = { .count = 0 };
		set_summand(&k, drawn(-2, 20), 0, 0, 0, 0, false);
		for (long more = drawn(1, MOST - 1); more > 0; more--) {
			const long w = drawn(0, 1) * drawn(1, 30), p = w ? drawn(-20, 20) : 0;
			set_summand(&k, drawn(-10, 10), (int)drawn(0, 2), drawn(-8, 3), w, p, w && drawn(0, 1));
		}
		const long from = drawn(0, 20), to = from + drawn(1, 50);
		long double least = INFINITY;
		for (int i = 0; i <= SAMPLES; i++)
			least = fminl(least, value_at(&k,
					((long double)from + (long double)(to - from) * i / SAMPLES) / 10));
		const bool is = says(&k, from, to), for_good = says(&k, from, -1);
		if (least < -1e-12L && (is || for_good))
			fail_msg("case %d: at least %Lg between %ld/10 and %ld/10, and said to stay above", c, least,
					from, to);
		if (least > 1e-3L && !is)
			fail_msg("case %d: at least %Lg between %ld/10 and %ld/10, and not seen", c, least, from, to);
		above += is;
	}
	assert_in_range(above, CASES / 5, CASES - CASES / 5);
}

static void sums_for_good(void **state)
{
	(void)state;
	struct known rises = { .count = 0 }, swings = rises, dips = rises, turns = rises, square = rises, fades = rises;
	set_summand(&rises, 2, 0, 0, 0, 0, false);
	set_summand(&swings, 3, 0, 0, 0, 0, false);
	set_summand(&dips, 3, 0, 0, 0, 0, false);
	set_summand(&turns, 2, 0, -5, 0, 0, false);
	set_summand(&square, 10, 2, 0, 0, 0, false);
	set_summand(&fades, 5, 0, 0, 0, 0, false);
	set_summand(&rises, 1, 1, 0, 0, 0, false);          /* 0.2 + 0.1 t */
	assert_true(says(&rises, 0, -1));
	set_summand(&swings, -3, 0, 0, 10, 0, true);        /* 0.3 - 0.3 sin t, which comes to 0 */
	assert_true(says(&swings, 0, -1));
	set_summand(&dips, 4, 0, 0, 10, 0, true);           /* 0.3 + 0.4 sin t */
	assert_false(says(&dips, 0, -1));
	assert_true(says(&dips, 0, 30));
	set_summand(&turns, -5, 1, -10, 0, 0, false);       /* 0.2 e^{-t/2} - 0.5 t e^{-t} */
	assert_false(says(&turns, 0, -1));
	set_summand(&square, -20, 1, 0, 0, 0, false);
	assert_false(says(&square, 0, -1));
	set_summand(&square, 10, 0, 0, 0, 0, false);        /* (t - 1)^2, which comes to 0 */
	assert_true(says(&square, 0, -1));
	set_summand(&fades, -1, 1, 0, 0, 0, false);         /* 0.5 - 0.1 t */
	assert_true(says(&fades, 0, 50));
	assert_false(says(&fades, 0, 51));
	assert_false(says(&fades, 0, -1));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sums_over_a_time),
		cmocka_unit_test(sums_for_good),
	};
	memory_open();
	const int status = cmocka_run_group_tests(tests, NULL, NULL);
	memory_close();
	return status;
}
