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

#include "periods.h"

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
	/* what ten of their forty parts of a step may be off, (w h)^5 / 6!, and rounding */
	check_periods(753, h, 10 * pow(2 * h, 5) / 720 + 100 * epsilon);
	check_approach();
	check_not_finite();
	return tap_end();
}
