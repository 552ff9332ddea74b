/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is known of the systems of the source texts: printed values, closed forms. */
#include "models.h"
#include "scs_pl_100_pl.h"
#include "tap.h"

#include <math.h>

/* Printed with 8 decimals. */
static const double half_unit = 0.5e-8;

static void printed(const char *name, const double *y, const double expected[4])
{
	bool good = true;
	for (int i = 0; i < 4; i++)
		good = close_to(y[i], expected[i], half_unit, "%s, entry %d", name, i) && good;
	ok(good, "%s", name);
}

static void scs_at_0_6(void)
{
	scs s;
	scs_init(&s);
	scs_run(&s, 60, NULL);
	printed("scs, t = 0.6", s.y, (double[]){0.00196416, 0.00763754, 0.08528668, -0.05734513});
}

static void sdcs_at_0_6(void)
{
	sdcs s;
	sdcs_init(&s);
	sdcs_run(&s, 60, NULL);
	printed("sdcs, t = 0.6", s.y, (double[]){0.00215233, 0.00604688, 0.05731391, -0.0331019});
}

static void sdcsf_at_1_6(void)
{
	sdcsf s;
	sdcsf_init(&s);
	sdcsf_run(&s, 160, NULL);
	printed("sdcsf, t = 1.6", s.y, (double[]){-0.0006463, 0.00133904, -0.05371799, -0.01737217});
}

static void scs_held_at_0_6(void)
{
	scs_pl_100 s;
	scs_pl_100_init(&s);
	scs_pl_100_run(&s, 60, NULL);
	printed("scs, scheme pl, h = 0.01, t = 0.6", s.y, (double[]){0.00083429, 0.00737685, 0.09415443, -0.07035938});
}

/* Normal modes of scs: in phase at 10 rad/s, against each other at sqrt(300). */
static void scs_closed_form(void)
{
	const long double fast = sqrtl(300);
	bool good = true;
	scs s;
	scs_init(&s);
	for (int k = 0; k <= 3000; k++, scs_step(&s)) {
		const long double t = k / 100.0L, p = 0.005L * cosl(10 * t), q = 0.005L * cosl(fast * t);
		const long double dp = -0.05L * sinl(10 * t), dq = -0.005L * fast * sinl(fast * t);
		good = close_to(s.y[0], (double)(p + q), 1e-14, "x1, step %d", k) && good;
		good = close_to(s.y[1], (double)(p - q), 1e-14, "x2, step %d", k) && good;
		good = close_to(s.y[2], (double)(dp + dq), 1.4e-13, "x1', step %d", k) && good;
		good = close_to(s.y[3], (double)(dp - dq), 1.4e-13, "x2', step %d", k) && good;
	}
	ok(good, "scs, 30 s: 1e-12 of its amplitudes from its normal modes");
}

static void linear2dof_closed_form(void)
{
	const long double a = sqrtl(2), b = sqrtl(5);
	const double largest[] = {10.0 / 3, 6, 5.0 / 3 * sqrt(2) + 2.0 / 3 * sqrt(5),
		5.0 / 3 * sqrt(2) + 4.0 / 3 * sqrt(5)};
	double worst = 0;
	bool good = true;
	linear2dof s;
	linear2dof_init(&s);
	for (int k = 0; k <= 50; k++, linear2dof_step(&s)) {
		const long double t = k / 5.0L;
		const long double y[] = {1 - 5 / 3.0L * cosl(a * t) + 2 / 3.0L * cosl(b * t),
			3 - 5 / 3.0L * cosl(a * t) - 4 / 3.0L * cosl(b * t),
							 5 / 3.0L * a * sinl(a * t) - 2 / 3.0L * b * sinl(b * t),
							 5 / 3.0L * a * sinl(a * t) + 4 / 3.0L * b * sinl(b * t)};
		for (int i = 0; i < 4; i++) {
			good = close_to(s.y[i], (double)y[i], 1e-13 * largest[i], "entry %d, step %d", i, k) && good;
			worst = worse(worst, fabs(s.y[i] - (double)y[i]) / largest[i]);
		}
	}
	note("linear2dof: largest difference over the amplitude %.3g", worst);
	ok(good, "linear2dof, h = 0.2, 10 s: 1e-13 of its amplitudes from its closed form");
}

int main(void)
{
	scs_at_0_6();
	sdcs_at_0_6();
	sdcsf_at_1_6();
	scs_held_at_0_6();
	scs_closed_form();
	linear2dof_closed_form();
	return tap_end();
}
