/* SPDX-License-Identifier: MIT-0 */
/* runtime/radau.h without the generator: models by hand, of three stages, beside their closed forms. Compiled for
 * doubles, and with REAL_IS_FLOAT for floats. */
#include "real.h"
#include "tap.h"

#include <math.h>

static const double nodes[3] = {0.15505102572168219, 0.6449489742783178, 1}; /* (4 -+ sqrt(6)) / 10, 1 */

/* x' = -1000 (x - cos t) - sin t, of which cos t is one: a thousand times as fast as what it follows */
static const short stiff_entry[1][3] = {{0, 0, 0}};
static void stiff_motion(real t, const real y[], real left[], real jacobian[])
{
	left[0] = -1000 * (y[0] - (real)cos((double)t)) - (real)sin((double)t);
	jacobian[0] = -1000;
}

/* x'' = -x */
static const short turning_entry[1][3] = {{0, 0, 1}};
static void turning_motion(real t, const real y[], real left[], real jacobian[])
{
	(void)t;
	left[0] = -y[0];
	jacobian[0] = -1;
}

/* x' = -x */
static const short fading_entry[1][3] = {{0, 0, 0}};
static void fading_motion(real t, const real y[], real left[], real jacobian[])
{
	(void)t;
	left[0] = -y[0];
	jacobian[0] = -1;
}

#ifdef REAL_IS_FLOAT
#define EXACT 1e-5
#else
#define EXACT 1e-10
#endif

#define MODEL stiff
#define MODEL_H 0.0625
#define MODEL_TOLERANCE EXACT
#define MODEL_TRIES 10000
#define MODEL_STATES 1
#define MODEL_ENTRIES 1
#include "written.h"

#define MODEL turning
#define MODEL_H 0.125
#define MODEL_TOLERANCE EXACT
#define MODEL_TRIES 1000
#define MODEL_STATES 2
#define MODEL_ENTRIES 1
#include "written.h"

#define MODEL fading
#define MODEL_H 1
#define MODEL_TOLERANCE EXACT
#define MODEL_TRIES 3
#define MODEL_STATES 1
#define MODEL_ENTRIES 1
#include "written.h"

/* From 2 it falls onto cos t within some hundredths of a second, and follows it. */
static void check_stiff(void)
{
	stiff s = {.y = {2}};
	const double bound = 10 * EXACT;
	double worst = 0, between = 0;
	int k;
	stiff_place(&s);
	for (k = 1; k <= 400; k++) {
		const double t = 0.0625 * k, middle = t - 0.03125;
		real y[1];
		stiff_between(&s, NULL, (real)0.03125, y);
		between = fmax(between, fabs((double)y[0] - cos(middle) - exp(-1000 * middle)));
		stiff_step(&s);
		worst = fmax(worst, fabs((double)s.y[0] - cos(t) - exp(-1000 * t)));
	}
	ok(worst <= bound && between <= bound && s.status == 0,
	   "a stiff equation: off its closed form by %.17g at steps, %.17g between, bound %.17g; status %d", worst,
	between,
	   bound, s.status);
}

static void check_turning(void)
{
	turning s = {.y = {1, 0}};
	const double bound = 10 * EXACT;
	double worst = 0;
	int k;
	turning_place(&s);
	for (k = 1; k <= 200; k++) {
		real y[2];
		turning_between(&s, NULL, (real)0.0625, y);
		worst = fmax(worst, fabs((double)y[0] - cos(0.125 * k - 0.0625)));
		turning_step(&s);
		worst = fmax(worst, fmax(fabs((double)s.y[0] - cos(0.125 * k)), fabs((double)s.y[1] + sin(0.125 * k))));
	}
	ok(worst <= bound && s.status == 0,
	   "an oscillator over 25 s, at and between steps: off its closed form by %.17g, bound %.17g; status %d", worst,
	   bound, s.status);
}

/* One step of `size` h, whatever its error is */
static double one_step(double size)
{
	fading s = {.y = {1}};
	real known[3][1], unit[1], k[3] = {0, 0, 0}, poly[4][1];
	fading_place(&s);
	if (!fading_solve(&s, NULL, NULL, NULL, (real)size, known, unit, k)) {
		return NAN;
	}
	(void)fading_finish(s.start, (real)size, unit, k, poly, s.gain);
	return 1 + (double)s.gain[0];
}

/* Three stages make of e^z its Pade approximant of degrees 2 and 3, which is of order 5. */
static void check_rational(void)
{
	double worst = 0;
	int k;
	for (k = 1; k <= 16; k++) {
		const double z = -0.25 * k, top = 1 + z * (0.4 + z / 20), below = 1 - z * (0.6 - z * (0.15 - z / 60));
		worst = fmax(worst, fabs(one_step(-z) - top / below));
	}
	ok(worst <= 8 * (double)REAL_EPSILON, "steps of x' = -x: off Pade's (2, 3) by %.17g, bound %.17g", worst,
	   8 * (double)REAL_EPSILON);
}

/* What takes more internal steps than allowed ends at the last good state, and goes on. */
static void check_limit(void)
{
	fading s = {.y = {1}};
	const real bound = (real)exp(-1.0);
	real y[1];
	fading_place(&s);
	fading_between(&s, NULL, (real)0.0009765625, y);
	fading_step(&s);
	ok((s.status & PL_TOO_MANY_STEPS) != 0 && s.y[0] < y[0] && s.y[0] > bound,
	   "three internal steps at most: status %d, the state is %.17g, between %.17g and %.17g", s.status,
	   (double)s.y[0], (double)bound, (double)y[0]);
}

static void check_not_finite(void)
{
	turning s = {.y = {(real)NAN, 1}};
	turning_place(&s);
	turning_step(&s);
	ok(s.status != 0 && s.y[1] == 1, "NaN: status %d, the velocity is still %.17g", s.status, (double)s.y[1]);
}

int main(void)
{
	stiff_tables();
	turning_tables();
	fading_tables();
	check_stiff();
	check_turning();
	check_rational();
	check_limit();
	check_not_finite();
	return tap_end();
}
