/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The models with clearances, by hand. */
#include "gears.h"

#include <string.h>

/* models/gear1.spec to gear3.spec, the masses of the last, 1, 0.5, 2, divided out; while row . x is beyond a gap, to
 * either side, the accelerations have -push k times by how much */
static const struct {
	const char *name;
	struct hand_system s;
	int gaps;
	struct { real row[HAND_MASSES], push[HAND_MASSES], k, gap; } gap[2];
} gears[] = {
	{ "gear1", { .n = 1, .C = { { 0.1L } }, .f0 = { 0.1L }, .fa = { 0.05L }, .w = 0.8L, .start = { 1.1L } },
	  1, { { { 1 }, { 1 }, 1, 1 } } },
	{ "gear2", { .n = 2, .K = { { 0, -0.5L }, { 0, 1 } }, .C = { { 0.1L, -0.05L }, { -0.05L, 0.1L } },
	             .f0 = { 0.1L, 0.05L }, .fa = { 0.05L }, .w = 0.8L, .start = { 1.2L, 0.1L } },
	  1, { { { 1, 0 }, { 1, -0.5L }, 1, 1 } } },
	{ "gear3", { .n = 3, .C = { { 0.4L, -0.4L, 0 }, { -0.8L, 1.4L, -0.6L }, { 0, -0.15L, 0.15L } },
	             .f0 = { 1, 0, -0.5L }, .fa = { 0.8L }, .w = 7, .start = { 0.03L, 0, -0.03L } },
	  2, { { { 1, -1, 0 }, { 1, -2, 0 }, 100, 0.01L }, { { 0, 1, -1 }, { 0, 2, -0.5L }, 80, 0.02L } } },
};

bool gears_of(const char *name, struct hand_system *s)
{
	size_t k = 0;
	while (k < sizeof gears / sizeof *gears && strcmp(gears[k].name, name) != 0)
		k++;
	if (k == sizeof gears / sizeof *gears || !s)
		return k < sizeof gears / sizeof *gears;
	*s = gears[k].s;
	for (int g = 0; g < 2 * gears[k].gaps; g++) {
		const real side = g % 2 ? -1 : 1;
		struct hand_stop *stop = &s->stop[s->stops++];
		*stop = (struct hand_stop){ .k = gears[k].gap[g / 2].k, .gap = gears[k].gap[g / 2].gap };
		for (int i = 0; i < s->n; i++) {
			stop->row[i] = side * gears[k].gap[g / 2].row[i];
			stop->push[i] = side * gears[k].gap[g / 2].push[i];
		}
	}
	return true;
}
