/* SPDX-License-Identifier: MIT-0 */
/* What stands around a step, without the generator: inputs that act later (delays.h), the largest value inside steps
 * (peaks.h), many instances one by one (each.h) and in lanes (batch.h). */
#include "runtime.h"

#ifdef REAL_IS_FLOAT
#define LANES pl_lanesf
#else
#define LANES pl_lanes
#endif

static void assert_same(real found, real expected, const char *what)
{
	if (memcmp(&found, &expected, sizeof found) != 0)
		fail_msg("%s: found %.17g, expected %.17g", what, (double)found, (double)expected);
}

static void assert_near(double found, double expected, double bound, const char *what, int step)
{
	if (!(fabs(found - expected) <= bound))
		fail_msg("%s, step %d: found %.17g, expected %.17g, bound %.3g", what, step, found, expected, bound);
}

/* ---- delays.h ---- */

enum { GIVEN = 2, ACTING = 4, LATE_PARTS = 2, RING = 4, AGO = 3 };
#define CORE_H ((real)0.5)

/* The integrals of what acts: a held input and a ramp, now and three halves of a step later */
typedef struct late_core {
	real y[ACTING], u[ACTING];
	int k;
} late_core;

typedef struct late {
	late_core core;
	real past[GIVEN][RING], ends[GIVEN][RING];
	int newest;
} late;

static void late_core_init(late_core *s)
{
	memset(s, 0, sizeof *s);
}

static void late_core_set(late_core *s, real t, const real y[ACTING])
{
	(void)t;
	memcpy(s->y, y, sizeof s->y);
}

static void late_core_get(const late_core *s, real y[ACTING])
{
	memcpy(y, s->y, sizeof s->y);
}

static real late_core_time(const late_core *s)
{
	return (real)s->k * CORE_H;
}

static int late_core_status(const late_core *s)
{
	(void)s;
	return 0;
}

static void late_core_out(const late_core *s, real out[1])
{
	out[0] = s->y[2];
}

/* Where a ramp begins anew */
static void late_core_hold(late_core *s, const real u[ACTING])
{
	memcpy(s->u, u, sizeof s->u);
}

static void late_core_at(const late_core *s, const real u[ACTING], real tau, real y[ACTING])
{
	int i;
	for (i = 0; i < ACTING; i++) {
		const real ramp = s->u[i] + (u[i] - s->u[i]) * tau / CORE_H / 2;
		y[i] = s->y[i] + tau * (i % 2 ? ramp : u[i]);
	}
}

static void late_core_step(late_core *s, const real u[ACTING])
{
	real y[ACTING];
	late_core_at(s, u, CORE_H, y);
	memcpy(s->y, y, sizeof y);
	memcpy(s->u, u, ACTING * sizeof *u);
	s->k++;
}

#define PL(name) late_##name
#define PL_CORE(name) late_core_##name
#define PL_TYPE late
#define PL_SINGLE SINGLE
#define PL_STATES ACTING
#define PL_OUTPUTS 1
#define PL_INPUTS GIVEN
#define PL_ALL ACTING
#define PL_PARTS LATE_PARTS
#define PL_RING RING
#define PL_RAMPS 1
#define PL_AT 1
#define PL_CORE_H CORE_H
static const int late_input_of[ACTING] = {0, 1, 0, 1}, late_parts_ago[ACTING] = {0, 0, AGO, AGO};
static const int late_is_ramp[ACTING] = {0, 1, 0, 1};
void late_init(late *s);
void late_set(late *s, real t, const real y[ACTING]);
void late_get(const late *s, real y[ACTING]);
real late_time(const late *s);
int late_status(const late *s);
void late_out(const late *s, real out[1]);
void late_hold(late *s, const real u[GIVEN]);
void late_step(late *s, const real u[GIVEN]);
void late_run(late *s, size_t n, const real *u, real *out);
void late_at(const late *s, const real u[GIVEN], real tau, real y[ACTING]);
#include "delays.h"

enum { LATE_STEPS = 12, HELD_ANEW = 5 };

/* The samples of step k = 1, 2, ..., and where its ramp begins: step HELD_ANEW with a jump */
static double sample(int input, int k)
{
	return k < 1 ? 0 : (input ? 2.5 : 1) * ((k * 7) % 5 - 2) + 0.25 * input;
}

static double ramp_start(int k)
{
	return k == HELD_ANEW ? -3 : sample(1, k - 1);
}

/* The integral from 0 to t of what acts so long after it was given, step by step of length 1 */
static double integral(int ramp, double t, double ago)
{
	double sum = 0;
	int k;
	for (k = 1; k <= LATE_STEPS; k++) {
		double long_of = t - ago - (k - 1);
		long_of = long_of < 0 ? 0 : long_of > 1 ? 1 : long_of;
		sum += ramp ? long_of * (ramp_start(k) + (sample(1, k) - ramp_start(k)) * long_of / 2)
					: long_of * sample(0, k);
	}
	return sum;
}

static void compare_late(const real y[ACTING], double t, int step)
{
	int i;
	for (i = 0; i < ACTING; i++)
		assert_near((double)y[i], integral(i % 2, t, i < 2 ? 0 : 1.5), 64 * (double)REAL_EPSILON, "an "
			"integral", step);
}

static void inputs_act_later(void **state)
{
	late s;
	real y[ACTING], out[1];
	int k, part;
	(void)state;
	late_init(&s);
	for (k = 1; k <= LATE_STEPS; k++) {
		const real u[GIVEN] = {(real)sample(0, k), (real)sample(1, k)};
		const real anew[GIVEN] = {u[0], (real)ramp_start(k)};
		if (k == HELD_ANEW)
			late_hold(&s, anew);
		for (part = 1; part <= 8; part++) {
			late_at(&s, u, (real)part / 8, y);
			compare_late(y, k - 1 + part / 8.0, k);
		}
		late_run(&s, 1, u, out);
		late_get(&s, y);
		compare_late(y, k, k);
		assert_same(out[0], y[2], "the output");
		assert_near((double)late_time(&s), k, 0, "the time", k);
	}
}

/* ---- peaks.h ---- */

/* x'' = -x, exactly from step to step; x and v are told by their peaks, the sum of both as it is */
typedef struct swinging {
	real y[2], peak[2];
	struct { int none; } coeffs;
} swinging;

#define SWING_H 0.5
static const int swinging_peak_output[2] = {0, 1};
static const real swinging_slope[2][2] = {{0, 1}, {-1, 0}}, swinging_row[2][2] = {{1, 0}, {0, 1}};
static const real swinging_bend[2][2] = {{(real)(SWING_H * SWING_H / 8), (real)(SWING_H * SWING_H / 8)},
						 {(real)(SWING_H * SWING_H / 8), (real)(SWING_H * SWING_H / 8)}};

#define PL(name) swinging_##name
#define PL_TYPE swinging
#define PL_SINGLE SINGLE
#define PL_STATES 2
#define PL_SIZE 2
#define PL_PEAKS 2
#define PL_OUTPUTS 3
#define PL_H ((real)SWING_H)
#define PL_SLOPE swinging_slope
#define PL_BEND swinging_bend
#define PL_PEAK_ROW(c, p) swinging_row[p]
#define PL_REACHES 0
void swinging_step(swinging *s);
void swinging_out(const swinging *s, real out[3]);
#include "peaks.h"

static void swinging_begin_step(const swinging *s, const real *u, real x[2])
{
	(void)u;
	memcpy(x, s->y, sizeof s->y);
}

static void swinging_one_step(swinging *s)
{
	const double c = cos(SWING_H), d = sin(SWING_H), x = (double)s->y[0], v = (double)s->y[1];
	s->y[0] = (real)(c * x + d * v);
	s->y[1] = (real)(c * v - d * x);
}

static void swinging_now(const swinging *s, real out[3])
{
	out[0] = s->y[0];
	out[1] = s->y[1];
	out[2] = s->y[0] + s->y[1];
}

/* From x = sin a, v = cos a the largest x so far is sin(a + t) until a + t = pi/2, and then 1; of v it is cos a, then 1
 * from pi on. */
static void largest_inside_steps(void **state)
{
	const double start = 0.3, quarter = acos(0.0), bound = 64 * (double)REAL_EPSILON;
	swinging s = {.y = {(real)sin(start), (real)cos(start)}};
	int k;
	(void)state;
	for (k = 1; k <= 12; k++) {
		const double at = start + k * SWING_H;
		real out[3];
		swinging_step(&s);
		swinging_out(&s, out);
		assert_near((double)out[0], at < quarter ? sin(at) : 1, bound, "the peak of x", k);
		assert_near((double)out[1], at < 2 * quarter ? fmax(cos(start), -cos(at)) : 1, bound, "the peak of "
			"v", k);
		assert_near((double)out[2], sin(at) + cos(at), bound, "x + v, no peak", k);
	}
}

/* ---- each.h, batch.h ---- */

enum { MANY = 23, MANY_STEPS = 90 };

/* What an instance is in both, and what is the same of it; only a step is not. */
typedef struct instance {
	real y[2], u[1];
	int k;
} instance;

typedef struct instances {
	size_t count;
	real *y, *peak;
	instance shared;
} instances;

static void instance_set(instance *s, real t, const real y[2])
{
	(void)t;
	s->y[0] = y[0];
	s->y[1] = y[1];
}

static void instance_init(instance *s)
{
	static const real start[2] = {(real)0.5, (real)0.5};
	s->u[0] = 0;
	s->k = 0;
	instance_set(s, 0, start);
}

static void instance_get(const instance *s, real y[2])
{
	y[0] = s->y[0];
	y[1] = s->y[1];
}

static real instance_time(const instance *s)
{
	return (real)s->k / 16;
}

static int instance_status(const instance *s)
{
	return s->y[0] > 1;
}

static void instance_out(const instance *s, real out[2])
{
	out[0] = s->y[0] - s->y[1];
	out[1] = s->y[1];
}

/* x' = u - x^3, a step of Euler's: no more than something that is not linear */
static void cubic_step(instance *s, const real u[1])
{
	s->y[0] += (u[0] - s->y[0] * s->y[0] * s->y[0]) / 16;
	s->y[1] -= s->y[0] / 16;
	s->k++;
}

#define cubic_init instance_init
#define cubic_set instance_set
#define cubic_get instance_get
#define cubic_time instance_time
#define cubic_status instance_status
#define cubic_out instance_out

#define CUBIC_ROWS ((sizeof(instance) + sizeof(real) - 1) / sizeof(real))
#define PL(name) cubic_##name
#define PL_TYPE instance
#define PL_INSTANCES instances
#define PL_SINGLE SINGLE
#define PL_ROWS CUBIC_ROWS
#define PL_STATES 2
#define PL_INPUTS 1
#define PL_OUTPUTS 2
void cubic_batch_take(const instances *b, size_t j, instance *s);
void cubic_batch_give(instances *b, size_t j, const instance *s);
void cubic_batch_init(instances *b);
void cubic_batch_set(instances *b, size_t j, const real y[2]);
void cubic_batch_get(const instances *b, size_t j, real y[2]);
int cubic_batch_status(const instances *b, size_t j);
void cubic_batch(instances *b, size_t n, const real *u, real *out);
#include "each.h"

#define PL(name) driven_##name
#define PL_TYPE instance
#define PL_SINGLE SINGLE
#define PL_STATES 2
#define PL_FLUSHES 1
#define PL_DECAYING 1
#include "flush.h"

/* A damped oscillator under a force that is held */
static void driven_step(instance *s, const real u[1])
{
	const real x = s->y[0], v = s->y[1];
	s->y[0] = x + ((real)-0.0625 * x + (real)0.25 * v + (real)0.03125 * u[0]);
	s->y[1] = v + ((real)-0.25 * x - (real)0.125 * v + (real)0.25 * u[0]);
	s->u[0] = u[0];
	if ((++s->k & 63) == 0) {
		driven_flush(s);
	}
}

#define driven_init instance_init
#define driven_set instance_set
#define driven_get instance_get
#define driven_time instance_time
#define driven_status instance_status
#define driven_out instance_out

#define PL(name) driven_##name
#define PL_SINGLE SINGLE
#include "lanes.h"

static void driven_share_step(instance *s, const real *u, real *now)
{
	now[0] = u[0];
	s->u[0] = u[0];
	s->k++;
}

static void driven_share_out(const instance *s, real *now)
{
	(void)s, (void)now;
}

PL_LANES_INLINE void driven_lanes_step(LANES *y, const LANES *factor, const real *now)
{
	const LANES x = y[0], v = y[1];
	y[0] = x + ((real)-0.0625 * x + (real)0.25 * v + (real)0.03125 * now[0]);
	y[1] = v + ((real)-0.25 * x - (real)0.125 * v + (real)0.25 * now[0]);
	(void)factor;
}

PL_LANES_INLINE void driven_lanes_out(const LANES *y, const LANES *factor, const real *now, LANES *out)
{
	out[0] = y[0] - y[1];
	out[1] = y[1];
	(void)factor, (void)now;
}

#define PL(name) driven_##name
#define PL_TYPE instance
#define PL_INSTANCES instances
#define PL_SINGLE SINGLE
#define PL_H ((real)0.0625)
#define PL_STATES 2
#define PL_INPUTS 1
#define PL_OUTPUTS 2
#define PL_ROWS 2
#define PL_STEPPED 2
#define PL_GROUPS 2
#define PL_SHARED 1
#define PL_FACTORS 0
#define PL_LANES 0
#define PL_SIZE 3
#define PL_FLUSHES 1
#define PL_DECAYING 1
void driven_batch_init(instances *b);
void driven_batch_set(instances *b, size_t j, const real y[2]);
void driven_batch_get(const instances *b, size_t j, real y[2]);
int driven_batch_status(const instances *b, size_t j);
void driven_batch(instances *b, size_t n, const real *u, real *out);
#include "batch.h"

struct many {
	void (*step)(instance *s, const real u[1]);
	void (*init)(instances *b);
	void (*set)(instances *b, size_t j, const real y[2]);
	void (*get)(const instances *b, size_t j, real y[2]);
	int (*status)(const instances *b, size_t j);
	void (*batch)(instances *b, size_t n, const real *u, real *out);
};

/* The first keeps the values that all have at the start. */
static void start_of(int j, real size, real start[2])
{
	start[0] = j ? (real)j / 16 * size : (real)0.5;
	start[1] = j ? (real)(j % 5) / 8 * size : (real)0.5;
}

static void widen(const instance *s, real most[2])
{
	real now[2];
	int i;
	instance_out(s, now);
	for (i = 0; i < 2; i++) {
		const real size = (real)fabs((double)now[i]);
		most[i] = size > most[i] ? size : most[i];
	}
}

/* Instance j by itself: its outputs, step by step, its peaks, its states and its status */
static void compare_alone(const struct many *m, const instances *b, int j, real size, const real *u, const real *out)
{
	real start[2], now[2], most[2] = {0, 0};
	instance one;
	int k, i;
	instance_init(&one);
	start_of(j, size, start);
	instance_set(&one, 0, start);
	widen(&one, most);
	for (k = 0; k < MANY_STEPS; k++) {
		m->step(&one, u + k);
		widen(&one, most);
		instance_out(&one, now);
		for (i = 0; i < 2; i++)
			assert_same(out[(2 * k + i) * MANY + j], now[i], "an output");
	}
	m->get(b, (size_t)j, now);
	for (i = 0; i < 2; i++) {
		assert_same(now[i], one.y[i], "a state");
		assert_same(b->peak[i * MANY + j], most[i], "a peak");
	}
	assert_int_equal(m->status(b, (size_t)j), instance_status(&one));
}

/* Each of many has the bits of one that steps alone; all but the first begin and are driven by so much. */
static void compare_many(const struct many *m, real size)
{
	static real y[CUBIC_ROWS * MANY], peak[2 * MANY], out[MANY_STEPS * 2 * MANY];
	instances b = {MANY, y, peak, {{0, 0}, {0}, 0}};
	real u[MANY_STEPS], start[2];
	int j, k;
	for (k = 0; k < MANY_STEPS; k++)
		u[k] = (real)((k * 11) % 7 - 3) / 4 * size;
	m->init(&b);
	for (j = 1; j < MANY; j++) {
		start_of(j, size, start);
		m->set(&b, (size_t)j, start);
	}
	m->batch(&b, MANY_STEPS, u, out);
	for (j = 0; j < MANY; j++)
		compare_alone(m, &b, j, size, u, out);
	assert_near((double)instance_time(&b.shared), MANY_STEPS / 16.0, 0, "the time", MANY_STEPS);
}

static void instances_one_by_one(void **state)
{
	static const struct many cubic = {cubic_step, cubic_batch_init, cubic_batch_set, cubic_batch_get,
									  cubic_batch_status, cubic_batch};
	(void)state;
	compare_many(&cubic, 1);
}

static void instances_in_lanes(void **state)
{
	static const struct many driven = {driven_step, driven_batch_init, driven_batch_set, driven_batch_get,
									   driven_batch_status, driven_batch};
	(void)state;
	compare_many(&driven, 1);
	compare_many(&driven, SINGLE ? (real)4e-35 : (real)4e-290); /* some are flushed, some are not */
}

ROOM(around,
	cmocka_unit_test(inputs_act_later),
	cmocka_unit_test(largest_inside_steps),
	cmocka_unit_test(instances_one_by_one),
	cmocka_unit_test(instances_in_lanes))
