/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The models with clearances, by hand. */
#include "gears.h"

#include <stddef.h>
#include <string.h>

/* Both sides of a gap: while row . x is beyond gap, the accelerations have -push k times by how much */
static void add_gap(struct hand_system *s, const real *row, const real *push, real k, real gap)
{
	for (int side = 1; side >= -1; side -= 2) {
		struct hand_stop *stop = &s->stop[s->stops++];
		*stop = (struct hand_stop){ .k = k, .gap = gap };
		for (int i = 0; i < s->n; i++) {
			stop->row[i] = side * row[i];
			stop->push[i] = side * push[i];
		}
	}
}

/* models/gear1.spec */
static void gear1(struct hand_system *s)
{
	*s = (struct hand_system){ .n = 1, .C = { { 0.1L } }, .f0 = { 0.1L }, .fa = { 0.05L }, .w = 0.8L,
	                           .start = { 1.1L } };
	add_gap(s, (real[]){ 1 }, (real[]){ 1 }, 1, 1);
}

/* models/gear2.spec */
static void gear2(struct hand_system *s)
{
	*s = (struct hand_system){ .n = 2, .K = { { 0, -0.5L }, { 0, 1 } }, .C = { { 0.1L, -0.05L }, { -0.05L, 0.1L } },
	                           .f0 = { 0.1L, 0.05L },
	                           .fa = { 0.05L }, .w = 0.8L, .start = { 1.2L, 0.1L } };
	add_gap(s, (real[]){ 1, 0 }, (real[]){ 1, -0.5L }, 1, 1);
}

/* models/gear3.spec: masses 1, 0.5, 2 divided out */
static void gear3(struct hand_system *s)
{
	*s = (struct hand_system){ .n = 3, .C = { { 0.4L, -0.4L, 0 }, { -0.8L, 1.4L, -0.6L }, { 0, -0.15L, 0.15L } },
	                           .f0 = { 1, 0, -0.5L },
	                           .fa = { 0.8L }, .w = 7, .start = { 0.03L, 0, -0.03L } };
	add_gap(s, (real[]){ 1, -1, 0 }, (real[]){ 1, -2, 0 }, 100, 0.01L);
	add_gap(s, (real[]){ 0, 1, -1 }, (real[]){ 0, 2, -0.5L }, 80, 0.02L);
}

/* models/stop.spec and bilinear.spec are not charted */
void (*gears_of(const char *name))(struct hand_system *)
{
	static const struct { const char *name; void (*make)(struct hand_system *s); } gears[] = {
		{ "gear1", gear1 }, { "gear2", gear2 }, { "gear3", gear3 }
	};
	for (size_t i = 0; i < sizeof gears / sizeof *gears; i++)
		if (strcmp(gears[i].name, name) == 0)
			return gears[i].make;
	return NULL;
}
