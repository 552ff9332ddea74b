/* SPDX-License-Identifier: GPL-3.0-or-later */
/* DOP853 of the kept charts, with the model's equations in its steps. */
#include "kept.h"

enum { MOST_ENTRIES = N + N % 2 };
#define SIZE N
#define EXTENT (MOST_ENTRIES / 2)
#define SLOPES(t, y, f) model_slope(t, y, f)
#include "../dop853.c"

bool own_dop853(double setting, double *rows)
{
	static struct dop853 d;
	memset(&d, 0, sizeof d);
	d.adaptive = (struct adaptive){.rhs = {.rhs = model_slope}, .n = N / 2, .size = N, .scale = history.scale};
	return kept_history(&d.adaptive, &dop853, setting, &d.h, as_it_is, 0, rows);
}
