/* SPDX-License-Identifier: MIT-0 */
/* runtime/event_split.h without the generator: an oscillator that a second spring holds above 0, beside its closed
 * form. Compiled for doubles, and with REAL_IS_FLOAT for floats. */
#include "real.h"
#include "tap.h"

#include <math.h>

#define PL(name) spring_##name
#define PL_TYPE spring
#define PL_H ((real)0.0625)
#ifdef REAL_IS_FLOAT
#define PL_SINGLE 1
#endif
#define PL_STATES 2
#define PL_ACTING 0
#define PL_FORCES 1
#define PL_ORDER 2
#define PL_COLUMNS 2
#define PL_SWITCHING_FUNCTIONS 1
#define PL_TERMS 1
#define PL_CHANGES 2
#define PL_MAX_EVENTS 8
#define PL_MAX_SPLITS 500
#define PL_FAST_PATH 0
#define PL_FASTEST 2
#define PL_CERTAIN 1
#define PL_IN_MODES 0

typedef struct spring_contact {
	uint64_t total;
	int crossings, placed, interval[1];
	pl_crossing last, crossing[PL_MAX_EVENTS];
} spring_contact;

typedef struct spring {
	real y[2], end[2][1], terms[1];
	spring_contact contact;
	int ended, status;
	uint64_t k;
} spring;

static const int spring_column[] = {0}, spring_breaks[] = {1};
static const real spring_breakpoint[] = {0};
static const pl_series_switching spring_series_switching = {1, 2, 2, spring_column, spring_breaks, spring_breakpoint};
static const pl_series_switching spring_passing = {1, 1, 3, spring_column, spring_breaks, spring_breakpoint};

/* x' = v, v' = -x + force */
static const real spring_slope_matrix[1][5][5] = {
	{{0, 1, 0, 0, 0}, {-1, 0, 1, 0, 0}, {0, 0, 0, 1, 0}, {0, 0, 0, 0, 1}, {0, 0, 0, 0, 0}}};

static void spring_inputs_now(const spring *s, const real u[], real start[], real slope[])
{
	(void)s, (void)u, (void)start, (void)slope;
}

static void spring_acting(const spring *s, const real start[], const real slope[], real tau, real acting[])
{
	(void)s, (void)start, (void)slope, (void)tau, (void)acting;
}

static real stiffness(const int interval[])
{
	return interval[0] == 1 ? 4 : 1;
}

static void spring_forces_at(const spring *s, const real u[], const real slope[], real tau, real when, int segment,
							 const int interval[], const real y[], real force[])
{
	(void)s, (void)u, (void)slope, (void)tau, (void)when, (void)segment;
	force[0] = (1 - stiffness(interval)) * y[0];
}

static void spring_ends_at(const spring *s, const real u[], const real slope[], real tau, real when, int segment,
						   const int interval[], const real y[], real e[][1], real terms[])
{
	(void)s, (void)u, (void)slope, (void)tau, (void)when, (void)segment, (void)interval;
	e[0][0] = y[0];
	e[1][0] = PL_H * y[1];
	terms[0] = pl_magnitude(y[0]);
}

static void spring_expand_from(const spring *s, const real u[], const real slope[], real tau, real when, int segment,
							   const int interval[], const real y[], real c[][2],
							real terms[])
{
	const real by = -PL_H * stiffness(interval);
	(void)s, (void)u, (void)slope, (void)tau, (void)when, (void)segment;
	c[0][0] = y[0];
	c[0][1] = y[1];
	c[1][0] = PL_H * c[0][1];
	c[1][1] = by * c[0][0];
	c[2][0] = PL_H * c[1][1] / 2;
	c[2][1] = by * c[1][0] / 2;
	terms[0] = pl_magnitude(y[0]);
}

/* Exact, of the frozen formula */
static void spring_full_step(spring *s, const real u[], const real start[], const real slope[], real when,
						 const int interval[])
{
	const double w = sqrt((double)stiffness(interval)), x = (double)s->y[0], v = (double)s->y[1];
	const double cosine = cos(w * (double)PL_H), sine = sin(w * (double)PL_H);
	(void)u, (void)start, (void)slope, (void)when;
	s->y[0] = (real)(x * cosine + v * sine / w);
	s->y[1] = (real)(v * cosine - w * x * sine);
}

static void spring_pass_time(spring *s, const real u[])
{
	(void)u;
	s->k++;
}

#include "event_split.h"

static const double h = 0.0625, epsilon = (double)REAL_EPSILON;

/* From x = 1 at rest: x = cos 2t down to 0, then -2 sin (t - pi/4) for half a period of the first spring alone, and up
 * again; a period is 3 pi / 2. */
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

/* Ten periods; bounds: what ten of their forty parts of a step may be off, (w h)^5 / 6!, and rounding */
static void check_periods(void)
{
	spring s = {.y = {1, 0}};
	const double off_a_part = pow(2 * h, 5) / 720, bound = 10 * off_a_part + 100 * epsilon;
	double worst = 0, between = 0, late = 0;
	int k, i, crossed = 0;
	spring_place(&s);
	for (k = 0; k < 753; k++) {
		real y[2];
		spring_state_at(&s, NULL, (real)(0.625 * h), y);
		between = fmax(between, fabs((double)y[0] - position((k + 0.625) * h)));
		spring_serve(&s, NULL);
		worst = fmax(worst, fabs((double)s.y[0] - position((k + 1) * h)));
		for (i = 0; i < s.contact.crossings; i++)
			late = fmax(late, fabs(k * h + (double)s.contact.crossing[i].time - crossing_time(crossed++)));
	}
	ok(worst <= bound && between <= bound && s.status == 0,
	   "ten periods: off the closed form by %.17g at steps, %.17g between, bound %.17g; status %d", worst, between,
	   bound, s.status);
	ok(crossed == 20 && s.contact.total == 20 && late <= bound,
			"%d crossings, 20 wanted, off by %.17g s, bound %.17g",
	   crossed, late, bound);
}

/* A step that comes near a breakpoint is looked at closely, and stands; the next one passes it, if slowly. */
static void check_approach(void)
{
	spring s = {.y = {(real)-1e-3, (real)0.01}};
	int before;
	spring_place(&s);
	spring_serve(&s, NULL);
	before = (int)s.contact.total;
	spring_serve(&s, NULL);
	ok(before == 0 && s.contact.total == 1 && s.contact.interval[0] == 1 && s.y[0] > 0,
	   "slowly up: %d crossings, then %d, in interval %d, at %.17g", before, (int)s.contact.total,
	   s.contact.interval[0], (double)s.y[0]);
}

/* What is no number is not followed, and the state stays as it was. */
static void check_not_finite(void)
{
	spring s = {.y = {(real)NAN, 1}};
	spring_place(&s);
	spring_serve(&s, NULL);
	ok((s.status & PL_NOT_FINITE) != 0 && s.y[1] == 1 && s.k == 1, "NaN: status %d, the velocity is still %.17g",
	   s.status, (double)s.y[1]);
}

int main(void)
{
	check_periods();
	check_approach();
	check_not_finite();
	return tap_end();
}
