/* SPDX-License-Identifier: MIT-0 */
/* runtime/taylor.h without the generator: models by hand, an oscillator beside its closed form, a pendulum beside its
 * energy and its period. Compiled for doubles, and with REAL_IS_FLOAT for floats. */
#include "real.h"
#include "tap.h"

#include <math.h>

/* The state's series by h^k: x' = v, v' = -x */
static void oscillator_series(const real y[], real h, real c[][2])
{
	int k;
	c[0][0] = y[0];
	c[0][1] = y[1];
	for (k = 0; k < 12; k++) {
		c[k + 1][0] = h * c[k][1] / (real)(k + 1);
		c[k + 1][1] = -h * c[k][0] / (real)(k + 1);
	}
}

/* x' = v, v' = -sin x, by (sin x)' = cos x v and (cos x)' = -sin x v */
static void pendulum_series(const real y[], real h, real c[][2])
{
	real sine[13], cosine[13];
	int k, j;
	c[0][0] = y[0];
	c[0][1] = y[1];
	sine[0] = (real)sin((double)y[0]);
	cosine[0] = (real)cos((double)y[0]);
	for (k = 0; k < 12; k++) {
		real s = 0, m = 0;
		for (j = 0; j <= k; j++) {
			s += cosine[k - j] * c[j][1];
			m += sine[k - j] * c[j][1];
		}
		c[k + 1][0] = h * c[k][1] / (real)(k + 1);
		c[k + 1][1] = -h * sine[k] / (real)(k + 1);
		sine[k + 1] = h * s / (real)(k + 1);
		cosine[k + 1] = -h * m / (real)(k + 1);
	}
}

/* x'' = -x, and z'' = -z + 1e-9 x, which is at rest at first; how often a series was made */
static int series_made;

static void follower_series(const real y[], real h, real c[][4])
{
	int k, i;
	series_made++;
	for (i = 0; i < 4; i++) {
		c[0][i] = y[i];
	}
	for (k = 0; k < 12; k++) {
		const real by = h / (real)(k + 1);
		c[k + 1][0] = by * c[k][1];
		c[k + 1][1] = -by * c[k][0];
		c[k + 1][2] = by * c[k][3];
		c[k + 1][3] = by * ((real)1e-9 * c[k][0] - c[k][2]);
	}
}

/* An oscillator that a second spring holds above 0: x'' = -x or -4 x */
static void spring_series_in(const real y[], real h, const int interval[], real c[][2])
{
	const real by = -h * (interval[0] == 1 ? 4 : 1);
	int k;
	c[0][0] = y[0];
	c[0][1] = y[1];
	for (k = 0; k < 12; k++) {
		c[k + 1][0] = h * c[k][1] / (real)(k + 1);
		c[k + 1][1] = by * c[k][0] / (real)(k + 1);
	}
}

#define MODEL oscillator
#define MODEL_H 0.125
#define MODEL_AT 1
#define MODEL_TOLERANCE (16 * REAL_EPSILON)
#include "written.h"

#define MODEL pendulum
#define MODEL_H 0.125
#define MODEL_AT 1
#define MODEL_TOLERANCE (16 * REAL_EPSILON)
#include "written.h"

#define MODEL spring
#define MODEL_H 0.125
#define MODEL_AT 1
#define MODEL_TOLERANCE (16 * REAL_EPSILON)
#define MODEL_BREAKPOINT 0
#include "written.h"

#define MODEL coarse
#define coarse_series pendulum_series
#define MODEL_H 16
#define MODEL_AT 0
#define MODEL_TOLERANCE 1e-4
#include "written.h"

#define MODEL follower
#define MODEL_STATES 4
#define MODEL_KINDS 1
#define MODEL_H 10
#define MODEL_AT 0
#define MODEL_TOLERANCE 1e-3
#include "written.h"

#define MODEL follower_fine
#define follower_fine_series follower_series
#define MODEL_STATES 4
#define MODEL_KINDS 1
#define MODEL_H 10
#define MODEL_AT 0
#define MODEL_TOLERANCE 1e-6
#include "written.h"

#define MODEL follower_alone
#define follower_alone_series follower_series
#define MODEL_STATES 4
#define MODEL_H 10
#define MODEL_AT 0
#define MODEL_TOLERANCE 1e-3
#include "written.h"

static const double epsilon = (double)REAL_EPSILON;

/* x = cos t, at the ends of steps and between them */
static void check_oscillator(void)
{
	oscillator s = {.y = {1, 0}};
	double worst = 0, between = 0;
	int k;
	oscillator_place(&s);
	for (k = 1; k <= 800; k++) {
		real y[2];
		oscillator_state_at(&s, NULL, (real)0.0625, y);
		between = fmax(between, fabs((double)y[0] - cos(0.125 * k - 0.0625)));
		oscillator_serve(&s, NULL);
		worst = fmax(worst, fabs((double)s.y[0] - cos(0.125 * k)));
	}
	ok(worst <= 16 * epsilon && between <= 16 * epsilon && s.status == 0,
	   "an oscillator over 100 s: off its closed form by %.17g at steps, %.17g between, bound %.17g; status "
		"%d", worst,
	   between, 16 * epsilon, s.status);
}

/* From pi/3 its quarter period is K(1/2), by the arithmetic-geometric mean; v^2/2 - cos x stays. */
static double quarter_period(void)
{
	double a = 1, b = cos(acos(-1.0) / 6);
	int i;
	for (i = 0; i < 8; i++) {
		const double mean = (a + b) / 2;
		b = sqrt(a * b);
		a = mean;
	}
	return acos(-1.0) / (2 * a);
}

static void check_pendulum(void)
{
	const real start = (real)(acos(-1.0) / 3);
	const double energy = -cos((double)start), quarter = quarter_period();
	const int steps = (int)(quarter / 0.125);
	pendulum s = {.y = {start, 0}};
	real y[2];
	double worst = 0;
	int k;
	pendulum_place(&s);
	for (k = 0; k < 800; k++) {
		if (k == steps) {
			pendulum_state_at(&s, NULL, (real)(quarter - 0.125 * steps), y);
		}
		pendulum_serve(&s, NULL);
		worst = fmax(worst, fabs((double)(s.y[1] * s.y[1] / 2) - cos((double)s.y[0]) - energy));
	}
	ok(fabs((double)y[0]) <= 16 * epsilon, "a pendulum passes below after a quarter of its period, %.17g s: %.17g",
	   quarter, (double)y[0]);
	ok(worst <= 32 * epsilon && s.status == 0, "its energy over 100 s: off by %.17g, bound %.17g; status %d", worst,
	   32 * epsilon, s.status);
}

/* A step of several periods goes in parts, each as the tolerance says. */
static void check_parts(void)
{
	coarse s = {.y = {(real)1.5, 0}};
	pendulum fine = {.y = {(real)1.5, 0}};
	double bound = 5e-4 + 32 * epsilon;
	int k;
	coarse_place(&s);
	coarse_serve(&s, NULL);
	pendulum_place(&fine);
	for (k = 0; k < 128; k++) {
		pendulum_serve(&fine, NULL);
	}
	ok(s.status == 0 && fabs((double)(s.y[0] - fine.y[0])) <= bound,
	   "a step of 16 s in parts, by a tolerance of 1e-4: %.17g beside %.17g, bound %.17g; status "
		"%d", (double)s.y[0],
	   (double)fine.y[0], bound, s.status);
}

#include "periods.h"

/* What is no number is not followed, and the state stays as it was. */
static void check_not_finite(void)
{
	pendulum s = {.y = {(real)NAN, 1}};
	pendulum_place(&s);
	pendulum_serve(&s, NULL);
	ok((s.status & PL_NOT_FINITE) != 0 && s.y[1] == 1 && s.k == 1, "NaN: status %d, the velocity is still %.17g",
	   s.status, (double)s.y[1]);
}

/* Series that `steps` steps of a follower take from its start */
#define SERIES_OF(model, steps) \
	do { \
		model s = {.y = {1, 0, 0, 0}}; \
		int k; \
		series_made = 0; \
		model##_place(&s); \
		for (k = 0; k < (steps); k++) { \
			model##_serve(&s, NULL); \
		} \
	} while (0)

/* A part of a model that is at rest does not make steps short: measured by the largest of its kind it takes no more
 * series by a coarse tolerance than by a fine one; measured by itself it does. */
static void check_rest(void)
{
	int coarse_series, fine_series;
	SERIES_OF(follower, 10);
	coarse_series = series_made;
	SERIES_OF(follower_fine, 10);
	fine_series = series_made;
	SERIES_OF(follower_alone, 10);
	ok(coarse_series <= fine_series && coarse_series < series_made,
	   "a follower at rest, 100 s: %d series by 1e-3, %d by 1e-6, each measured by itself %d", coarse_series,
	   fine_series, series_made);
}

int main(void)
{
	check_oscillator();
	check_pendulum();
	check_parts();
	check_periods(377, 0.125, 400 * epsilon);
	check_not_finite();
	check_rest();
	return tap_end();
}
