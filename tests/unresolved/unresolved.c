/* SPDX-License-Identifier: GPL-3.0-or-later */
/* unresolved spec SEED: the spec of a random system.
 * unresolved judge SEED: reads lines `NAME STATUS state ...`, the states at whole seconds, and prints `GOOD NAME
 * RATIO`: the largest error over the largest state, the tolerance, and the conditioning, which is by how much a
 * deviation at one of several times grows at most. GOOD is 0 where that is within BOUND, or where the status has told.
 * */
#include "unresolved_system.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BOUND = 100, MOST = 4 };

struct truth {
	real y[UNRESOLVED_SECONDS + 1][HAND_MOST];
	double largest, conditioning;
};

static void deviate(const struct unresolved *u, struct truth *truth, int from)
{
	const int n = 2 * u->masses;
	const real little = 1e-8L * (real)truth->largest;
	real y[HAND_MOST] = { 0 };
	for (int i = 0; i < n; i++)
		y[i] = truth->y[from][i] + little;
	for (int k = from; k < UNRESOLVED_SECONDS; k++) {
		follow_unresolved(u, k, k + 1, y);
		for (int i = 0; i < n; i++)
			truth->conditioning = fmax(truth->conditioning,
					(double)(fabsl(y[i] - truth->y[k + 1][i]) / little));
	}
}

static void find_truth(const struct unresolved *u, struct truth *truth)
{
	const int n = 2 * u->masses;
	real y[HAND_MOST] = { 0 };
	for (int i = 0; i < n; i++)
		y[i] = (real)u->start[i];
	truth->largest = 0;
	truth->conditioning = 1;
	for (int k = 0; k <= UNRESOLVED_SECONDS; k++) {
		memcpy(truth->y[k], y, sizeof y);
		for (int i = 0; i < n; i++)
			truth->largest = fmax(truth->largest, (double)fabsl(y[i]));
		if (k < UNRESOLVED_SECONDS)
			follow_unresolved(u, k, k + 1, y);
	}
	for (int k = 0; k < UNRESOLVED_SECONDS; k += UNRESOLVED_SECONDS / 3)
		deviate(u, truth, k);
}

/* Of one line, behind its name; NaN where a number lacks */
static double error_of(const struct unresolved *u, const struct truth *truth)
{
	double worst = 0;
	for (int k = 1; k <= UNRESOLVED_SECONDS; k++)
		for (int i = 0; i < 2 * u->masses; i++) {
			double found = NAN;
			if (scanf("%lf", &found) != 1)
				return NAN;
			const double error = (double)fabsl((real)found - truth->y[k][i]);
			worst = error <= worst ? worst : error;
		}
	return worst;
}

int main(int count, char **argument)
{
	if (count != 3)
		return 2;
	const struct unresolved u = unresolved_of((unsigned)strtoul(argument[2], NULL, 10));
	if (strcmp(argument[1], "spec") == 0) {
		print_unresolved(stdout, &u);
		return 0;
	}
	static struct truth truth;
	char name[32];
	int status;
	find_truth(&u, &truth);
	while (scanf("%31s %d", name, &status) == 2) {
		const double ratio = error_of(&u, &truth) / (truth.largest * u.tolerance * truth.conditioning);
		printf("%d %s %.3g, told %d\n", !(status || ratio <= BOUND), name, ratio, status);
	}
	return 0;
}
