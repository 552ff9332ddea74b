/* SPDX-License-Identifier: GPL-3.0-or-later */
/* RADAU of the kept charts, with the model's equations in its steps. A model that is not of second order throughout
 * goes through it as x'' = f(t, x'), y = x', whose method and systems of equations are those of y' = f(t, y); nothing
 * depends on x, which has no weight in any error. */
#include <float.h>

#include "kept.h"

enum { OWN_COORDINATES = SECOND_ORDER ? N / 2 : N, WHOLE = 2 * OWN_COORDINATES,
	   MOST_COORDINATES = OWN_COORDINATES > 7 ? OWN_COORDINATES : 7 };         /* the method's own systems: 7 */

INLINE void whole_slope(double t, const double *state, double *f)
{
	model_slope(t, state + WHOLE - N, f + WHOLE - N);
	for (int i = 0; i < WHOLE - N; i++)
		f[i] = state[N + i];
}

#define complex _Complex
#define I _Complex_I
#define COORDINATES OWN_COORDINATES
#define EXTENT OWN_COORDINATES
#define SLOPES(t, y, f) whole_slope(t, y, f)
#define JACOBIAN(t, y, Jq, Jv) other_differences(d, WHOLE - N)
#include "../radau.c"

static void as_whole(const double *y, double *state)
{
	memset(state, 0, WHOLE * sizeof *state);
	memcpy(state + WHOLE - N, y, N * sizeof *y);
}

static bool own_radau(const struct kind *kind, double setting, double *rows)
{
	static struct radau d;
	static double scale[WHOLE];
	memset(&d, 0, sizeof d);
	for (int i = 0; i < WHOLE; i++)
		scale[i] = i < WHOLE - N ? 1e150 : history.scale[i - (WHOLE - N)];
	d.adaptive = (struct adaptive){.rhs = {.rhs = whole_slope}, .n = OWN_COORDINATES, .size = WHOLE,
	                               .scale = scale};
	return kept_history(&d.adaptive, kind, setting, &d.h, as_whole, WHOLE - N, rows);
}

bool own_radau5(double setting, double *rows)
{
	return own_radau(&radau5, setting, rows);
}

bool own_radau9(double setting, double *rows)
{
	return own_radau(&radau9, setting, rows);
}

bool own_radau13(double setting, double *rows)
{
	return own_radau(&radau13, setting, rows);
}
