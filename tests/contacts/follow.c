/* SPDX-License-Identifier: GPL-3.0-or-later */
/* follow FOUND STEPS TOLERANCE: whether the emitted model `scene` meets every event in FOUND, in order, and ends where
 * FOUND says, off by at most TOLERANCE of the largest value, times 0.1 over the slowest speed at which something was
 * met, where that is more. Events of one instant count once: which intervals are
 * passed on the way is the model's own affair.
 * With SCENE_VALUES the model has tunable params, which take these values first. */
#include "scene.h"
#include "worse.h"

#ifndef SCENE_STATUS_ALLOWED
#define SCENE_STATUS_ALLOWED 0
#endif

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 20000 };
static const double together = 0x1p-20 * SCENE_H; /* one instant [s]: what comes to rest is there within 2^-23 h */
static const double late = 1e-9; /* how far a time may be off [s] */
static double expected[MOST], found[MOST];
static char what[MOST][80];

static int follow(scene *s, long steps)
{
	pl_crossing crossing[SCENE_MAX_EVENTS];
	int count = 0;
	for (long k = 0; k < steps; k++) {
		scene_step(s);
		int here = scene_crossings(s, crossing);
		for (int i = 0; i < here && count < MOST; i++) {
			double time = (double)k * SCENE_H + crossing[i].time;
			if (count == 0 || time > found[count - 1] + together)
				found[count++] = time;
		}
	}
	return count;
}

int main(int count, char **argument)
{
	FILE *from = count == 4 ? fopen(argument[1], "r") : NULL;
	char line[512];
	int events = 0, faults = 0;
	double end[SCENE_STATES] = { 0 }, y[SCENE_STATES], most = 0.1, worst = 0, slowest;
	double tolerance = count == 4 ? atof(argument[3]) : 0;
	while (from && fgets(line, sizeof line, from)) {
		double time;
		if (sscanf(line, "event %lf %79[^\n]", &time, what[events]) == 2) {
			if (events == 0 || time > expected[events - 1] + together)
				expected[events++] = time;
		} else if (sscanf(line, "slowest %lf", &slowest) == 1) {
			tolerance *= fmax(1, 0.1 / slowest);
		} else if (strncmp(line, "end", 3) == 0) {
			char *at = line + 3;
			for (int i = 0; i < SCENE_STATES; i++)
				end[i] = strtod(at, &at);
		}
	}
	if (!from)
		return 1;
	scene s;
	scene_init(&s);
#ifdef SCENE_VALUES
	static scene_coeffs fresh;
	const double values[] = { SCENE_VALUES };
	const int refused = scene_retune(&fresh, values, SCENE_H);
	if (refused)
		printf("# retune: %d\n", refused);
	scene_use(&s, &fresh);
#endif
	const int met = follow(&s, atol(argument[2]));
	for (int i = 0; i < events || i < met; i++)
		if (i >= events || i >= met || !(fabs(expected[i] - found[i]) <= late)) {
			printf("# event %d: %.17g found, %.17g expected (%s)\n", i, i < met ? found[i] : NAN,
			       i < events ? expected[i] : NAN, i < events ? what[i] : "none");
			if (++faults > 4)
				break;
		}
	scene_get(&s, y);
	for (int i = 0; i < SCENE_STATES; i++)
		most = fmax(most, fabs(end[i]));
	for (int i = 0; i < SCENE_STATES; i++) {
		const double off = fabs(y[i] - end[i]) / most;
		if (!(off <= tolerance))
			printf("# state %d: %.17g found, %.17g expected\n", i, y[i], end[i]);
		worst = worse(worst, off);
	}
	if (scene_status(&s) & ~SCENE_STATUS_ALLOWED)
		printf("# status %d\n", scene_status(&s));
	printf("# events %d, worst state %.3g\n", events, worst);
	return faults > 0 || !(worst <= tolerance) || (scene_status(&s) & ~SCENE_STATUS_ALLOWED);
}
