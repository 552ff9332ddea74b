/* SPDX-License-Identifier: GPL-3.0-or-later */
/* follow FOUND STEPS TOLERANCE: whether the emitted model `scene` meets every event in FOUND, in order, and ends where
 * FOUND says, off by at most TOLERANCE of the largest value, times 0.1 over the slowest speed at which something was
 * met, where that is more, and times what an error of the start grows by. Events of one instant count once: which
 * intervals are passed on the way is the model's own affair. Status 3: its steps are too long for all their events.
 * With SCENE_VALUES the model has tunable params, which take these values first. */
#include "scene.h"
#include "worse.h"

#ifndef SCENE_STATUS_ALLOWED
#define SCENE_STATUS_ALLOWED 0
#endif

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 20000 };
/* One instant, in steps: what comes to rest is there within 2^-23 h, in float within 2^-10 */
#ifdef FLOAT
typedef pl_crossingf crossing_of_scene;
typedef float number;
static const double together = 0x1p-8;
#else
typedef pl_crossing crossing_of_scene;
typedef double number;
static const double together = 0x1p-20;
#endif
enum { FEW_DIGITS = sizeof(number) < sizeof(double) };
static double scale = 1; /* units of time in a second */
static double expected[MOST], found[MOST];
static char what[MOST][80];

static int follow(scene *s, long steps)
{
	crossing_of_scene crossing[SCENE_MAX_EVENTS];
	int count = 0;
	for (long k = 0; k < steps; k++) {
		scene_step(s);
		int here = scene_crossings(s, crossing);
		for (int i = 0; i < here && count < MOST; i++) {
			double time = ((double)k * SCENE_H + (double)crossing[i].time) / scale;
			if (count == 0 || time > found[count - 1] + together * SCENE_H / scale)
				found[count++] = time;
		}
	}
	return count;
}

/* Whether more may happen in a step than is told of one; from slip to slip two breakpoints are passed. */
static bool is_crowded(int events)
{
	int first = 0;
	for (int i = 0; i < events; i++) {
		while (expected[i] - expected[first] > SCENE_H / scale)
			first++;
		if (3 * (i - first + 1) > SCENE_MAX_EVENTS)
			return true;
	}
	return false;
}

static bool is_near(double time, const double *of, int count, double off)
{
	bool near = false;
	for (int i = 0; i < count; i++)
		near = near || fabs(time - of[i]) <= off;
	return near;
}

/* In float, which of the last bounces are told before something rests is a matter of rounding: events that stand alone
 * are met, and nothing happens where there is none. */
static int strays(int events, int met, double late)
{
	const double alone = 0x1p-5 * SCENE_H / scale;
	int faults = 0;
	for (int i = 0; i < events; i++) {
		const bool crowd = (i > 0 && expected[i] - expected[i - 1] < alone) ||
				   (i + 1 < events && expected[i + 1] - expected[i] < alone);
		if (!crowd && !is_near(expected[i], found, met, late))
			printf("# nothing near %g (%s), stray %d\n", expected[i], what[i], ++faults);
	}
	for (int i = 0; i < met; i++)
		if (!is_near(found[i], expected, events, late + alone))
			printf("# nothing expected near %g, stray %d\n", found[i], ++faults);
	return faults;
}

int main(int count, char **argument)
{
	FILE *from = count == 4 ? fopen(argument[1], "r") : NULL;
	char line[512];
	int events = 0, faults = 0;
	double end[SCENE_STATES] = { 0 }, most = 0.1, worst = 0, slowest, growth;
	double tolerance = count == 4 ? atof(argument[3]) : 0, late = tolerance * 1e3;  /* the latter of times [s] */
	number y[SCENE_STATES];
	while (from && fgets(line, sizeof line, from)) {
		double time;
		if (sscanf(line, "event %lf %79[^\n]", &time, what[events]) == 2) {
			if (events == 0 || time > expected[events - 1] + together * SCENE_H / scale)
				expected[events++] = time;
		} else if (sscanf(line, "slowest %lf", &slowest) == 1) {
			tolerance *= fmax(1, 0.1 / slowest);
		} else if (sscanf(line, "growth %lf", &growth) == 1) {
			tolerance *= growth;
			late *= growth;
		} else if (sscanf(line, "scale %lf", &scale) == 1) {
			continue;
		} else if (strncmp(line, "end", 3) == 0) {
			char *at = line + 3;
			for (int i = 0; i < SCENE_STATES; i++)
				end[i] = strtod(at, &at);
		}
	}
	if (!from)
		return 1;
	if (is_crowded(events))
		return 3;
	scene s;
	scene_init(&s);
#ifdef SCENE_VALUES
	static scene_coeffs fresh;
	const double values[] = { SCENE_VALUES };
	const int refused = scene_retune(&fresh, values, SCENE_H);
	if (refused == PL_OUT_OF_RANGE)        /* the order of breakpoints is another, which it says */
		return 2;
	if (refused)
		printf("# retune: %d\n", refused);
	scene_use(&s, &fresh);
#endif
	const int met = follow(&s, atol(argument[2]));
	for (int i = 0; i < events || i < met; i++)
		if (!FEW_DIGITS && (i >= events || i >= met || !(fabs(expected[i] - found[i]) <= late))) {
			printf("# event %d: %.17g found, %.17g expected (%s)\n", i, i < met ? found[i] : NAN,
			       i < events ? expected[i] : NAN, i < events ? what[i] : "none");
			if (++faults > 4)
				break;
		}
	faults = FEW_DIGITS ? strays(events, met, late) : faults;
	scene_get(&s, y);
	for (int i = 0; i < SCENE_STATES; i++)
		most = fmax(most, fabs(end[i]));
	for (int i = 0; i < SCENE_STATES; i++) {
		const double value = (double)y[i] * (i < SCENE_STATES / 2 ? 1 : scale);
		const double off = fabs(value - end[i]) / most;
		if (!(off <= tolerance))
			printf("# state %d: %.17g found, %.17g expected\n", i, value, end[i]);
		worst = worse(worst, off);
	}
	if (scene_status(&s) & ~SCENE_STATUS_ALLOWED)
		printf("# status %d\n", scene_status(&s));
	printf("# events %d, worst state %.3g, allowed %.3g\n", events, worst, tolerance);
	return faults > 0 || !(worst <= tolerance) || (scene_status(&s) & ~SCENE_STATUS_ALLOWED);
}
