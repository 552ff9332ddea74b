/* SPDX-License-Identifier: GPL-3.0-or-later */
/* retuned NAME: times of a step of a piecewise-linear model that an instance has tunable params of, beside that with
 * their values written: steps that stay clear of every breakpoint, steps with one crossing, and a run as it comes; in
 * short samples that take turns so that all meet the same machine; prints medians and ratios. */
#include "retuned_pl.h"
#include "timing.h"
#include "written_pl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 501, STEPS = 20, RUN = 200, LOOKED_AT = 400000, AWAY = 5 };

static retuned a[STEPS], tuned_on, tuned_clear, tuned;
static written b[STEPS], written_on, written_clear, plain;

/* Both from the same states: a run without a crossing, AWAY steps from any; steps that cross one breakpoint.  How many
 * of these */
static int find(void)
{
	int found = 0, clear = 0, seen = 0;
	retuned_init(&tuned);
	written_init(&plain);
	tuned_on = tuned;
	written_on = plain;
	for (int k = 0; k < LOOKED_AT && (found < STEPS || clear < STEPS + 2 * AWAY); k++) {
		const uint64_t before = written_crossed(&plain), other = retuned_crossed(&tuned);
		if (clear == AWAY) {
			written_clear = plain;
			tuned_clear = tuned;
		}
		if (found < STEPS) {
			a[found] = tuned;
			b[found] = plain;
		}
		retuned_step(&tuned);
		written_step(&plain);
		seen = (int)(written_crossed(&plain) - before);
		if (clear < STEPS + 2 * AWAY)
			clear = seen == 0 ? clear + 1 : 0;
		found += found < STEPS && seen == 1 && retuned_crossed(&tuned) - other == 1;
	}
	for (int k = found; k < STEPS && found > 0; k++) {
		a[k] = a[k % found];
		b[k] = b[k % found];
	}
	return clear == STEPS + 2 * AWAY ? found : 0;
}

/* STEPS from one state, a step from each of STEPS, RUN on */
#define SAMPLE(name, first, each, run)                                    \
	static double name##_clear_steps(void)                            \
	{                                                                 \
		plain = written_clear;                                    \
		tuned = tuned_clear;                                      \
		double start = nanoseconds();                             \
		for (int k = 0; k < STEPS; k++)                           \
			name##_step(&first);                              \
		return (nanoseconds() - start) / STEPS;                   \
	}                                                                 \
	static double name##_crossing(void)                               \
	{                                                                 \
		static name at[STEPS];                                    \
		memcpy(at, each, sizeof at);                              \
		double start = nanoseconds();                             \
		for (int k = 0; k < STEPS; k++)                           \
			name##_step(&at[k]);                              \
		return (nanoseconds() - start) / STEPS;                   \
	}                                                                 \
	static double name##_steps(void)                                  \
	{                                                                 \
		double start = nanoseconds();                             \
		for (int k = 0; k < RUN; k++)                             \
			name##_step(&run);                                \
		return (nanoseconds() - start) / RUN;                     \
	}

SAMPLE(written, plain, b, written_on)
SAMPLE(retuned, tuned, a, tuned_on)

int main(int argc, char **argv)
{
	static double clear[2][SAMPLES], one[2][SAMPLES], run[2][SAMPLES];
	if (argc != 2 || !find())
		return 2;
	for (int k = 0; k < SAMPLES; k++) {
		clear[0][k] = written_clear_steps();
		clear[1][k] = retuned_clear_steps();
		one[0][k] = written_crossing();
		one[1][k] = retuned_crossing();
		run[0][k] = written_steps();
		run[1][k] = retuned_steps();
	}
	const double plain_step = median(clear[0]), step = median(clear[1]), cross = median(one[0]);
	const double search = median(one[1]), level = median(run[0]), as_it_comes = median(run[1]);
	printf("%-22s clear: written %6.1f ns, tuned %6.1f, %.2f times that; one crossing: %5.0f, %5.0f, %.1f times; a "
	       "run: %6.1f, %6.1f, %.2f times\n", argv[1], plain_step, step, step / plain_step, cross, search,
	       search / cross, level, as_it_comes, as_it_comes / level);
	return 0;
}
