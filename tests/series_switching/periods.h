/* SPDX-License-Identifier: MIT-0 */
/* A mass of 1 with a spring of 1 below 0 and of 4 above, from x = 1 at rest, beside its closed form: ten periods of a
 * model `spring` by hand, behind which this is included. */

/* x = cos 2t down to 0, then -2 sin (t - pi/4) for half a period of the first spring alone, and up again; a period is
 * 3 pi / 2. */
static double position(double t)
{
	const double pi = acos(-1.0), part = fmod(t, 1.5 * pi), behind = part - 0.25 * pi;
	return behind < 0 ? cos(2 * part) : behind < pi ? -2 * sin(behind) : sin(2 * (behind - pi));
}

static double crossing_time(int number)
{
	const double pi = acos(-1.0);
	return 1.5 * pi * (number / 2) + 0.25 * pi + (number % 2 ? pi : 0.0);
}

/* In so many steps [s]: each crossing in its place, and the state exact behind it, to the bound */
static void check_periods(int steps, double step, double bound)
{
	spring s = {.y = {1, 0}};
	double worst = 0, between = 0, late = 0;
	int k, i, crossed = 0;
	spring_place(&s);
	for (k = 0; k < steps; k++) {
		real y[2];
		spring_state_at(&s, NULL, (real)(0.625 * step), y);
		between = fmax(between, fabs((double)y[0] - position((k + 0.625) * step)));
		spring_serve(&s, NULL);
		worst = fmax(worst, fabs((double)s.y[0] - position((k + 1) * step)));
		for (i = 0; i < s.contact.crossings; i++) {
			late = fmax(late,
				    fabs(k * step + (double)s.contact.crossing[i].time - crossing_time(crossed++)));
		}
	}
	ok(worst <= bound && between <= bound && s.status == 0,
	   "ten periods: off the closed form by %.17g at steps, %.17g between, bound %.17g; status %d", worst, between,
	   bound, s.status);
	ok(crossed == 20 && s.contact.total == 20 && late <= bound,
	   "%d crossings, 20 wanted, off by %.17g s, bound %.17g", crossed, late, bound);
}
