/* SPDX-License-Identifier: MIT-0 */
/* What the tests of the runtime share. Each runtime_NAME.c is one text for doubles and floats, as the runtime itself
 * is, and is compiled twice: with REAL_IS_FLOAT `real` is a float and the names of plrt.h stand for those that end in
 * f. */
#ifndef TESTS_RUNTIME_H
#define TESTS_RUNTIME_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <inttypes.h>
#include <float.h>
#include <math.h>
#include <mpfr.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "real.h"

/* The cases of one file; `start` and `end`, where there are any, go around all of them. */
struct room {
	const char *name;
	const struct CMUnitTest *test;
	size_t tests;
	void (*start)(void), (*end)(void);
};

/* The last lines of a file; in the program its cases are called NAME_CASE. */
#define ROOM_WITH(name, start, end, ...)                                                                               \
	static const struct CMUnitTest cases_of_##name[] = {__VA_ARGS__};                                              \
	const struct room room_of_##name = {#name, cases_of_##name, sizeof cases_of_##name / sizeof *cases_of_##name,  \
										start, end};
#define ROOM(name, ...) ROOM_WITH(name, NULL, NULL, __VA_ARGS__)

#define ROOMS(each) \
	each(phases) each(envelope) each(series) each(power) each(until) each(apply) each(crossings) each(increments) \
	each(retune) each(rate) each(dense) each(around)
#define DECLARE_ROOM(name) extern const struct room room_of_##name;
ROOMS(DECLARE_ROOM)

/* xorshift64*; every file draws from a sequence of its own */
static uint64_t seed = 0x9E3779B97F4A7C15u;

static inline uint64_t random_word(void)
{
	seed ^= seed << 13;
	seed ^= seed >> 7;
	seed ^= seed << 17;
	return seed * 0x2545F4914F6CDD1Du;
}

/* What models of these tests are: real.h has said it of its own files. */
#undef PL_SINGLE
#ifdef REAL_IS_FLOAT
#define SINGLE 1
#define real_of(v) mpfr_get_flt(v, MPFR_RNDN)
#else
#define SINGLE 0
#define real_of(v) mpfr_get_d(v, MPFR_RNDN)
#endif

/* v in two words */
static inline pl_two two_of(mpfr_t v)
{
	mpfr_t rest;
	pl_two t;
	mpfr_init2(rest, mpfr_get_prec(v));
	t.hi = real_of(v);
	mpfr_sub_d(rest, v, t.hi, MPFR_RNDN);
	t.lo = real_of(rest);
	mpfr_clear(rest);
	return t;
}

static inline void set_two(mpfr_t v, pl_two t)
{
	mpfr_set_d(v, t.hi, MPFR_RNDN);
	mpfr_add_d(v, v, t.lo, MPFR_RNDN);
}

static inline pl_two word_of(double v)
{
	pl_two t;
	t.hi = (real)v;
	t.lo = 0;
	return t;
}

/* Rates, and times to ask them at */
#ifdef REAL_IS_FLOAT
enum { RATE_WORDS = 2, LONGEST = 600, EXPONENTS = 400, SCALES = 120, LEAST_SCALE = -100 };
#define NUMBER "%.9g"
#define SPECIAL_TIMES {0.0f, -0.0f, 1.0f, -1.0f, 0x1p-149f, -0x1p-149f, 0x1.fffffep127f, 0x1p-126f, \
					   0x0.fffffep-126f, 1e30f, -1e-30f, 0.01f, 30.0f}
#else
enum { RATE_WORDS = 3, LONGEST = 2600, EXPONENTS = 500, SCALES = 240, LEAST_SCALE = -140 };
#define NUMBER "%.17g"
#define SPECIAL_TIMES {0.0, -0.0, 1.0, -1.0, 0x1p-1074, -0x1p-1074, 0x1.fffffffffffffp1023, 0x1p-1022, \
					   0x0.fffffffffffffp-1022, 1e300, -1e-300, 0.01, 30.0}
#endif

/* words 2^-exponent, with a random significand */
static inline pl_rate random_rate(mpfr_t value, int exponent)
{
	pl_rate rate;
	mpz_t z;
	int i;
	for (i = 0; i < RATE_WORDS; i++)
		rate.word[i] = random_word();
	rate.word[0] |= (uint64_t)1 << 63;
	rate.exponent = exponent;
	mpz_init(z);
	mpz_import(z, RATE_WORDS, 1, sizeof rate.word[0], 0, 0, rate.word);
	mpfr_set_z(value, z, MPFR_RNDN);
	mpfr_mul_2si(value, value, -(long)exponent, MPFR_RNDN);
	mpz_clear(z);
	return rate;
}

/* How many samples to draw, of `all`: every one in the long form (LONG in the environment), else a tenth. */
static inline long samples(long all)
{
	return getenv("LONG") ? all : all / 10;
}

#endif
