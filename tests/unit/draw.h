/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the tests of the generator's rooms share: cmocka, numbers drawn from a fixed seed, and a case chosen by name. */
#ifndef DRAW_H
#define DRAW_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <gmp.h>

static uint64_t seed;

static inline uint32_t draw(uint32_t below)
{
	seed = seed * 6364136223846793005u + 1442695040888963407u;
	return (uint32_t)((seed >> 33) % below);
}

/* -most .. most */
static inline long draw_integer(long most)
{
	return (long)draw((uint32_t)(2 * most + 1)) - most;
}

/* Numerator up to `most` in size, denominator up to `parts` */
static inline void draw_fraction(mpq_ptr q, long most, uint32_t parts)
{
	mpq_set_si(q, draw_integer(most), 1 + draw(parts));
	mpq_canonicalize(q);
}

/* PROGRAM [PATTERN]: all cases, or those whose names match, as in 'poly_*' */
static inline void choose_cases(int argc, char **argv)
{
	if (argc > 1)
		cmocka_set_test_filter(argv[1]);
}

#endif
