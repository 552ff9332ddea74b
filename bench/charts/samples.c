/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time, taken in turns: what disturbs the machine for a while then meets all methods alike, and the median does not
 * see it. It is the process's own time, so that what else the machine does meanwhile is not in it but for the
 * caches. */
#include "charts.h"

#include <stdlib.h>

enum { SAMPLES_LEAST = 3, SAMPLES_MOST = 201, CHUNK = 1000 };
/* ns of one run: what takes this long in one pass or two is not disturbed by much */
#define ENOUGH 1e9

double now_ns(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
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
	int repeats;                    /* of its history in a sample */
	double ns[SAMPLES_MOST];        /* per unit */
	double spent;                   /* ns */
	int count;
};

/* Rows are written over one another, so that they stay in the cache as in a program that uses them up. */
static void pass(struct run *run, double *rows)
{
	run->restart(run);
	for (int k = 0; k < run->problem->units; k += CHUNK) {
		const int units = run->problem->units - k < CHUNK ? run->problem->units - k : CHUNK;
		if (run->timed)
			run->timed(run, units);
		else
			run->advance(run, units, rows);
	}
}

/* Returns nanoseconds of all of it. */
static double passes(struct run *run, int repeats, double *rows)
{
	const double start = own_ns();
	for (int k = 0; k < repeats; k++)
		pass(run, rows);
	return own_ns() - start;
}

/* How many it takes to last long against the clock's own time */
static int repeats_for(double ns)
{
	const double long_enough = 100e3;
	return ns >= long_enough ? 1 : (int)(long_enough / (ns > 100 ? ns : 100)) + 1;
}

static void keep(struct turn *turn, const struct run *run, double ns)
{
	turn->ns[turn->count++] = ns / turn->repeats / run->problem->units;
	turn->spent += ns;
}

/* CHARTS_ONCE in the environment: a pass of each, whatever its time is worth. For tests, which do not look at it. */
static bool is_once(void)
{
	return getenv("CHARTS_ONCE") != NULL;
}

/* The first pass meets cold caches: it is kept only where it is so long that they do not count. Returns what a pass
 * takes [ns]. */
static double prepare(struct turn *turn, struct run *run, double *rows)
{
	turn->repeats = 1;
	double ns = passes(run, 1, rows);
	if (ns >= 20e6 || is_once()) {
		keep(turn, run, ns);
		return ns;
	}
	ns = passes(run, 1, rows);
	turn->repeats = repeats_for(ns);
	return ns;
}

static bool wants_more(const struct turn *turn, double share)
{
	if (is_once() || turn->spent >= ENOUGH)
		return false;
	return turn->count < SAMPLES_LEAST || (turn->count < SAMPLES_MOST && turn->spent < share);
}

static double *rows_of(int runs, struct run *const *run)
{
	size_t most = 0;
	for (int i = 0; i < runs; i++) {
		size_t room = 2 * (size_t)run[i]->problem->n * CHUNK;
		most = most > room ? most : room;
	}
	return room_for(most, sizeof(double));
}

void sample_ladders(int runs, struct run *const *run, double seconds,
					bool (*is_dear)(int k, const struct samples *so_far, void *of), void *of,
					struct samples *result)
{
	struct turn *turn = room_for((size_t)runs, sizeof *turn);
	double *rows = rows_of(runs, run), share = 1e9 * seconds / (runs > 0 ? runs : 1);
	for (int i = 0; i < runs; i++) {
		result[i] = (struct samples){ 0 };
		if (is_dear && is_dear(i, result, of))
			continue;
		const double ns = prepare(&turn[i], run[i], rows) / run[i]->problem->units;
		result[i] = (struct samples){ ns, ns, ns, 1 };
	}
	for (bool any = true; any;) {
		any = false;
		for (int i = 0; i < runs; i++)
			if (result[i].count > 0 && wants_more(&turn[i], share)) {
				any = true;
				keep(&turn[i], run[i], passes(run[i], turn[i].repeats, rows));
			}
	}
	for (int i = 0; i < runs; i++)
		result[i] = sample_summary(turn[i].count, turn[i].ns);
	free(turn);
	free(rows);
}

void sample_runs(int runs, struct run *const *run, double seconds, struct samples *result)
{
	sample_ladders(runs, run, seconds, NULL, NULL, result);
}

double sample_pass(struct run *run)
{
	double *rows = rows_of(1, &run);
	double ns = passes(run, 1, rows);
	const int repeats = repeats_for(ns);
	if (repeats > 1 && !is_once())
		ns = passes(run, repeats, rows) / repeats;
	free(rows);
	return ns / run->problem->units;
}
