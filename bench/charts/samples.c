/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time, taken in turns: what disturbs the machine for a while then meets all methods alike, and the median does not see it. It is the
 * process's own time, so that what else the machine does meanwhile is not in it but for the caches. */
#include "charts.h"

#include <stdarg.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

enum { SAMPLES_LEAST = 3, SAMPLES_MOST = 201 };

double now_ns(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static double own_ns(void)
{
	struct timespec t;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

void say_progress(const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	if (isatty(2))
		fputs("\r\033[K", stderr);
	vfprintf(stderr, format, arguments);
	if (!isatty(2))
		fputc('\n', stderr);
	va_end(arguments);
	fflush(stderr);
}

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

struct samples sample_summary(int count, double *ns)
{
	if (count == 0)
		return (struct samples){ 0 };
	qsort(ns, (size_t)count, sizeof *ns, ascending);
	return (struct samples){ ns[0], ns[count / 2], ns[count - 1], count };
}

struct turn {                       /* of one run */
	int repeats;                    /* of its units in a sample */
	double ns[SAMPLES_MOST];        /* per unit */
	double spent;                   /* ns */
	int count;
};

static void go(struct run *run, int units, double *rows)
{
	if (run->timed)
		run->timed(run, units);
	else
		run->advance(run, units, rows);
}

/* Returns nanoseconds of all of it. */
static double sample(struct turn *turn, struct run *run, int units, double *rows)
{
	run->restart(run);
	double start = own_ns();
	go(run, units, rows);
	for (int k = 1; k < turn->repeats; k++) {
		run->restart(run);
		go(run, units, rows);
	}
	double ns = own_ns() - start;
	turn->spent += ns;
	return ns;
}

/* The first sample meets cold caches, and is not kept; the second says how many it takes to last long against the clock's own time. */
static void prepare(struct turn *turn, struct run *run, int units, double *rows)
{
	const double long_enough = 100e3;
	turn->repeats = 1;
	sample(turn, run, units, rows);
	double ns = sample(turn, run, units, rows);
	turn->repeats = ns >= long_enough ? 1 : (int)(long_enough / (ns > 100 ? ns : 100)) + 1;
}

static bool wants_more(const struct turn *turn, double share)
{
	return turn->count < SAMPLES_LEAST || (turn->count < SAMPLES_MOST && turn->spent < share);
}

void sample_runs_of(int runs, struct run *const *run, const int *units, double seconds, struct samples *result)
{
	struct turn *turn = calloc((size_t)runs + 1, sizeof *turn);
	size_t most = 0;
	for (int i = 0; i < runs; i++) {
		size_t room = 2 * (size_t)run[i]->problem->n * (size_t)units[i];
		most = most > room ? most : room;
	}
	double *rows = calloc(most + 1, sizeof *rows), share = 1e9 * seconds / (runs > 0 ? runs : 1);
	if (!turn || !rows) {
		fputs("samples: out of memory\n", stderr);
		exit(1);
	}
	for (bool any = true; any;) {
		any = false;
		for (int i = 0; i < runs; i++) {
			if (!wants_more(&turn[i], share))
				continue;
			any = true;
			if (turn[i].count == 0)
				prepare(&turn[i], run[i], units[i], rows);
			double ns = sample(&turn[i], run[i], units[i], rows);
			turn[i].ns[turn[i].count++] = ns / units[i] / turn[i].repeats;
		}
	}
	for (int i = 0; i < runs; i++)
		result[i] = sample_summary(turn[i].count, turn[i].ns);
	free(turn);
	free(rows);
}

void sample_runs(int runs, struct run *const *run, int units, double seconds, struct samples *result)
{
	int *same = calloc((size_t)runs + 1, sizeof *same);
	if (!same)
		exit(1);
	for (int i = 0; i < runs; i++)
		same[i] = units;
	sample_runs_of(runs, run, same, seconds, result);
	free(same);
}
