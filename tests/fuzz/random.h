/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random numbers that a seed decides. */
#ifndef RANDOM_H
#define RANDOM_H

#include <stdbool.h>
#include <stdint.h>

extern uint64_t state;  /* defined in the file of main */

/* splitmix64 (Steele, Lea, Flood 2014) */
static inline uint64_t next(void)
{
	uint64_t z = state += UINT64_C(0x9e3779b97f4a7c15);
	z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
	z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
	return z ^ (z >> 31);
}

static inline int below(int n)
{
	return (int)(next() % (uint64_t)n);
}

static inline bool chance(int percent)
{
	return below(100) < percent;
}

#endif
