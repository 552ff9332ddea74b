/* SPDX-License-Identifier: MIT-0 */
/* The series that the generated model `drawn` has made at its first step, beside the coefficients of drawn_series on
 * standard input. `order`: prints that of the series. DRIVEN: the model has inputs; RELATIVE: it may move as a
 * whole. */
#include "drawn_pl.h"
#include "../emitted/worse.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { ORDER = (int)(sizeof((drawn *)0)->series / sizeof((drawn *)0)->series[0]) - 1 };

static int state_of(const char *name)
{
	for (int i = 0; i < DRAWN_STATES; i++)
		if (strcmp(drawn_model.state_names[i], name) == 0)
			return i;
	return -1;
}

/* Of a difference, in units of what the rounding of each operation, once, makes of the coefficient: a recurrence rounds
 * as often as it has terms. Of 120 models the largest was 139, once 473, most stay below 20. */
#define BOUND 5000.0

/* Coefficient k of the states as written: what moves as a whole may be kept apart from what moves in it. Returns what
 * the sums of both may have lost. */
static double written_at(const drawn *s, int k, double c[DRAWN_STATES])
{
	double most = 0;
	memcpy(c, s->series[k], DRAWN_STATES * sizeof(double));
#ifdef RELATIVE
	drawn copy = *s;
	memcpy(copy.y, s->series[k], sizeof copy.y);
	if (k > 0) {
		memset(copy.from, 0, sizeof copy.from);
		memset(copy.set, 0, sizeof copy.set);
	}
	drawn_get(&copy, c);
	for (int i = 0; i < DRAWN_STATES; i++)
		most = fmax(most, fabs(s->series[k][i]));
#endif
	return 4 * 0x1p-53 * most;
}

int main(int argc, char **argv)
{
	static drawn s;
	double start, y[DRAWN_STATES], c[DRAWN_STATES], worst = 0;
	char name[20];
	int k, wrong = 0, seen = 0;
	double expected, unit;
	if (argc > 1 && strcmp(argv[1], "order") == 0) {
		printf("%d\n", ORDER);
		return 0;
	}
	if (scanf("start %la", &start) != 1)
		return 2;
#ifdef DRIVEN
	double before[DRAWN_INPUTS], u[DRAWN_INPUTS];
	for (int i = 0; i < DRAWN_INPUTS; i++)
		if (scanf("%la %la", &before[i], &u[i]) != 2)
			return 2;
#endif
	for (int i = 0; i < DRAWN_STATES; i++) {
		double value;
		if (scanf("%19s %la", name, &value) != 2 || state_of(name) < 0)
			return 2;
		y[state_of(name)] = value;
	}
	drawn_set(&s, start, y);
#ifdef DRIVEN
	drawn_hold(&s, before);
	drawn_step(&s, u);
#else
	drawn_step(&s);
#endif
	while (scanf("%19s %d %lf %lf", name, &k, &expected, &unit) == 4) {
		int i = state_of(name);
		if (i < 0 || k > ORDER)
			return 2;
		const double lost = written_at(&s, k, c), found = c[i], difference = fabs(found - expected);
		const double tolerance = BOUND * unit * 0x1p-53 + lost;
		worst = worse(worst, unit > 0 ? fmax(difference - lost, 0) / (unit * 0x1p-53) : 0);
		seen++;
		if (difference <= tolerance)
			continue;
		if (wrong++ < 10)
			printf("%s, coefficient %d: found %.17g, expected %.17g, difference %.3g, tolerance %.3g\n",
					name, k, found,
				expected, difference, tolerance);
	}
	if (seen != (ORDER + 1) * DRAWN_STATES) {
		printf("%d of %d coefficients\n", seen, (ORDER + 1) * DRAWN_STATES);
		return 2;
	}
	printf("order %d, largest difference %.3g roundings of each operation\n", ORDER, worst);
	return wrong != 0;
}
