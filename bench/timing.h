/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time of short samples, and the sample in the middle: programs that measure two things in turn compare these. */
#ifndef TIMING_H
#define TIMING_H

#include <stdlib.h>
#include <time.h>

static inline double nanoseconds_of(clockid_t clock)
{
	struct timespec t;
	clock_gettime(clock, &t);
	return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static inline double nanoseconds(void)
{
	return nanoseconds_of(CLOCK_MONOTONIC);
}

/* Of the process alone, while other programs run */
static inline double own_nanoseconds(void)
{
	return nanoseconds_of(CLOCK_PROCESS_CPUTIME_ID);
}

static inline int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static inline double middle(size_t samples, double *time)
{
	qsort(time, samples, sizeof *time, ascending);
	return time[samples / 2];
}

/* Of an array, which is sorted by it */
#define median(array) middle(sizeof(array) / sizeof *(array), array)

#endif
