/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random numbers, the same everywhere for the same `random_state`; each file that includes this has a sequence of its
 * own. */
#ifndef DRAWN_H
#define DRAWN_H

#include <stdbool.h>
#include <stdint.h>

static uint64_t random_state;

static inline unsigned below(unsigned n)
{
	random_state = random_state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
	return (unsigned)(random_state >> 33) % n;
}

static inline bool chance(unsigned percent)
{
	return below(100) < percent;
}

#endif
