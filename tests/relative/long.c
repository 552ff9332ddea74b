/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drives that turn: after a million steps the torque, which is a difference of positions, is what the load asks for
 * to the last digits, and the position is where the speed has brought it. The specs are such that both have closed
 * forms: constant drive and load, so that in the end nothing but the whole moves. Each form, double or float.
 * Two have a body at rest beside one that runs away: its place, 1, is their torque. */
#include "../forms/variant.h"
#include "../emitted/tap.h"

#include VARIANTS_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct expected {
	const char *model;
	uint64_t steps;
	double torque, speed;                   /* in the end; [1/s] */
	/* of the place from speed times time: the centre started at 0, and the springs are wound */
	double offset;
};

static const struct expected expected[] = {
	{"drive", 1000000, 1.2, 100, -0.01 / 6},
	{"train", 1000000, 1.2, 100, -(0.002 * 0.014 + 0.005 * 0.004) / 0.017},
	{"geared", 1000000, 1.2, 100, -0.006 * 0.024 / 0.068},
	{"backlash", 200000, 1.2, 100, -0.03 / 3.5 - (0.057 + 0.5 * 0.035) / 3.5},
	{"hardening", 200000, 1.2, 100, -0.05230395601095225 / 6},   /* 12 r + 4000 r^3 = 1.2 */
	{"changing", 200000, 1.2, 100, -0.05230395601095225 / 6},
	{"follower", 1000000, 1.2, 100, 0.03},
	{"retuned", 1000000, 1.2, 100, -0.01 / 6},
	{"still", 800, 1, 1, 0},
	{"sources", 10000, 1, 1e9, 0},
	{"row", 40000, 1.2, 10000, -(11 * 12 / 2) * (1.2 / 300) / 12},
};

/* What moves in it has come to rest after half of the steps. */
static void check(const struct variant *v, const struct expected *e, uint64_t times)
{
	const uint64_t steps = e->steps * times;
	const real_model *m = v->model;
	real out[2], u[2] = {(real)1.2, (real)1.2};
	void *s = malloc(m->size);
	double worst = 0;
	bool single = EPSILON > 1e-10;
	m->init(s);
	for (uint64_t k = 1; k <= steps; k++) {
		m->step(s, u);
		if (k < steps / 2 || k % 16)
			continue;
		m->out(s, out);
		const double off = fabs((double)out[0] - e->torque) / e->torque;
		worst = off <= worst ? worst : off;
	}
	m->out(s, out);
	close_to(worst, 0, single ? 1e-5 : 1e-13, "%s, %s: the torque's largest error relative to it", m->name, TYPE);
	ok(worst <= (single ? 1e-5 : 1e-13), "%s, %s: torque within %.2g of its size", m->name, TYPE, worst);
	const double far = e->speed * (double)steps * m->h, place = far + e->offset;
	ok(close_to((double)out[1], place, (single ? 1e-6 : 1e-14) * far, "%s, %s: place", m->name, TYPE),
		"%s, %s: place after %.3g steps", m->name, TYPE,
	   (double)steps);
	free(s);
}

/* long MODEL TIMES: of one model (- of all), with TIMES as many steps; 1e7 of `drive` are long - 10 */
int main(int argc, char **argv)
{
	const uint64_t times = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
	for (size_t i = 0; i < sizeof expected / sizeof *expected; i++)
		for (const struct variant *v = VARIANTS; v->model; v++)
			if (argc < 2 || strcmp(argv[1], "-") == 0 || strcmp(argv[1], expected[i].model) == 0)
				if (strncmp(v->model->name, expected[i].model, strlen(expected[i].model)) == 0)
					check(v, &expected[i], times);
	return tap_end();
}
