/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stands PART SECONDS: what has to hold of the emitted model `scene` whatever its motion is. No stop is penetrated, the
 * energy never grows, the momentum of what nothing holds stays, but for this part of the largest size; status 0. Says
 * how far it was off. */
#include "drawn.h"
#include "scene.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef FLOAT
typedef float number;
#else
typedef double number;
#endif

static double energy(const number *y)
{
	double sum = 0;
	for (int i = 0; i < BODIES; i++) {
		const double x = (double)y[i], v = (double)y[BODIES + i], off = x - start[i];
		sum += mass[i] * v * v / 2 + spring[i] * off * off / 2 - force[i] * x;
	}
	return sum + cubic * pow((double)y[0], 4) / 4;
}

static double momentum(const number *y)
{
	double sum = 0;
	for (int i = 0; i < BODIES; i++)
		sum += mass[i] * (double)y[BODIES + i];
	return sum;
}

static double deepest(const number *y)
{
	double worst = 0;
	for (int k = 0; k < GUARDS; k++) {
		double e = -gap[k];
		for (int i = 0; i < BODIES; i++)
			e += row[k][i] * (double)y[i];
		worst = fmax(worst, e);
	}
	return worst;
}

/* What acts on all together; nothing, where no ground does */
static bool is_free(void)
{
	for (int k = 0; k < GUARDS; k++) {
		double sum = 0;
		for (int i = 0; i < BODIES; i++)
			sum += row[k][i];
		if (fabs(sum) > 0)
			return false;
	}
	for (int i = 0; i < BODIES; i++)
		if (fabs(force[i]) > 0 || spring[i] > 0 || cubic > 0)
			return false;
	return true;
}

int main(int argc, char **argv)
{
	const double part = argc > 2 ? atof(argv[1]) : 0, end = argc > 2 ? atof(argv[2]) : 0;
	const bool loose = is_free();
	double depth = 0, growth = 0, drift = 0, size = 1, last, first;
	number y[SCENE_STATES];
	int late = 0;
	scene s;
	scene_init(&s);
	scene_get(&s, y);
	last = energy(y);
	first = momentum(y);
	for (long k = 1; (double)k * (double)SCENE_H <= end; k++) {
		scene_step(&s);
		scene_get(&s, y);
		const double now = energy(y);
		for (int i = 0; i < BODIES; i++)
			size = fmax(size, fmax(fabs((double)y[i]), fabs((double)y[BODIES + i])));
		depth = fmax(depth, deepest(y));
		growth = fmax(growth, now - last);
		drift = loose ? fmax(drift, fabs(momentum(y) - first)) : 0;
		last = fmin(now, last);
		late = late == 0 && scene_status(&s) != 0 ? (int)k : late;
	}
	printf("depth %.3g growth %.3g drift %.3g status %d at %d size %.3g rested %d crossed %ld\n", depth, growth,
	    drift, scene_status(&s), late, size, (int)scene_rested(&s), (long)scene_crossed(&s));
	return scene_status(&s) != 0 || !(depth <= part * size) || !(growth <= part * 20 * size * size) ||
	       !(drift <= part * 20 * size);
}
