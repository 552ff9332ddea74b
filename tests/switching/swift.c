/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step that is seen to be clear, or whose few crossings are certain, against the runtime's search from the same
 * state: over random starts, many of them beside breakpoints, the same crossings at the same times, and the same state.
 * The emitted code is part of this file, whose NAME_cross says whether it was sure, and NAME_switching is what the
 * search takes. */
#include "swift_variants.c"
#include "tap.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { STARTS = 4000, MOST = 32 };
/* Of a step: times of crossings that are no grazing; in parts of the largest state: the state after it */
static const double of_time = 1e-12, of_state = 1e-12;

static uint64_t seed = 1;

static double random_number(void)           /* -1 .. 1 */
{
	seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
	return (double)(int64_t)(seed >> 11) * 0x1p-52 - 1;
}

struct outcome {
	int sure, crossings, region;
	uint64_t total;
	pl_crossing crossing[MOST];
	double y[MOST];
};

static struct tally {
	int clear, once, more, unsure, wrong;
	double time, state;         /* the largest differences */
} tally;
static int several;                         /* crossings in a step of which it was sure: how many such steps */

static bool same_crossings(const struct outcome *a, const struct outcome *b, double h)
{
	bool same = a->crossings == b->crossings && a->region == b->region && a->total == b->total;
	for (int i = 0; i < a->crossings && same; i++) {
		const pl_crossing *x = &a->crossing[i], *y = &b->crossing[i];
		double apart = fabs(x->time - y->time) / h;
		tally.time = worse(tally.time, apart);
		same = x->expression == y->expression && x->breakpoint == y->breakpoint && x->upward == y->upward &&
		       apart <= of_time;
	}
	return same;
}

static void compare(const char *name, int start, const struct outcome *swift, const struct outcome *search, int states,
	double h)
{
	double size = DBL_MIN, apart = 0;
	tally.unsure += !swift->sure;
	tally.clear += swift->sure && search->crossings == 0;
	tally.once += swift->sure && search->crossings == 1;
	tally.more += search->crossings > 1;
	several += swift->sure && search->crossings > 1;
	if (!swift->sure)
		return;
	for (int i = 0; i < states; i++) {
		size = fmax(size, fabs(search->y[i]));
		apart = worse(apart, fabs(swift->y[i] - search->y[i]));
	}
	tally.state = worse(tally.state, apart / size);
	if (same_crossings(swift, search, h) && apart / size <= of_state)
		return;
	if (tally.wrong++ < 5)
		note("%s, start %d: %d crossings, first at %.17g h, region %d, states off by %.3g; by the search %d, "
		     "at %.17g h, region %d", name, start, swift->crossings, swift->crossing[0].time / h,
		     swift->region, apart / size, search->crossings, search->crossing[0].time / h, search->region);
}

struct place {                              /* where a model's starts are */
	double size, speed;         /* of positions, of velocities */
	int entry, less;            /* of the state: entry, less -1, or entry - less is compared with -at and at */
	double at;
};

/* Beside a breakpoint every second time */
static void random_start(double *y, int states, double h, const struct place *p, bool below)
{
	for (int i = 0; i < states; i++)
		y[i] = (i < states / 2 ? p->size : p->speed) * random_number();
	if (random_number() < 0)
		return;
	double ahead = random_number() < -0.9 ? 0 : random_number() * (random_number() < 0 ? 1 : 0.01);
	y[p->entry] = (below ? -p->at : p->at) + h * y[states / 2 + p->entry] * ahead + (p->less < 0 ? 0 : y[p->less]);
}

/* x = states, then what the loads are made of.  States are set as they are kept. */
#define MODEL(NAME, STATES, SIZE, LOADS)                                                                               \
	static void fill_##NAME(const NAME *s, double *x)                                                              \
	{                                                                                                              \
		for (int i = 0; i < STATES; i++)                                                                       \
			x[i] = s->y[i];                                                                                \
		LOADS                                                                                                  \
	}                                                                                                              \
	static void keep_##NAME(const NAME *s, const double *y, struct outcome *o)                                     \
	{                                                                                                              \
		o->crossings = s->contact.crossings;                                                                   \
		o->region = s->contact.region;                                                                         \
		o->total = s->contact.total;                                                                           \
		memcpy(o->crossing, s->crossing, sizeof s->crossing);                                                  \
		memcpy(o->y, y, STATES * sizeof *y);                                                                   \
	}                                                                                                              \
	static void one_##NAME(int start, const struct place *p)                                                       \
	{                                                                                                              \
		NAME s, t;                                                                                             \
		double y[STATES], x[SIZE], work[PL_SWITCHING_WORK(SIZE, 4, 40)];                                       \
		struct outcome swift, search;                                                                          \
		memset(&swift, 0, sizeof swift);                                                                       \
		memset(&s, 0, sizeof s);                                                                               \
		memset(y, 0, sizeof y);                                                                                \
		NAME##_set(&s, 10 * random_number(), y);                                                               \
		random_start(s.y, STATES, NAME##_model.h, p, start & 1);                                               \
		NAME##_place(&s);                                                                                      \
		t = s;                                                                                                 \
		fill_##NAME(&s, x);                                                                                    \
		const int sure = NAME##_cross(&s, x);                                                                  \
		keep_##NAME(&s, s.y, &swift);                                                                          \
		swift.sure = sure;                                                                                     \
		fill_##NAME(&t, x);                                                                                    \
		pl_switching_step(&NAME##_switching, x, &t.contact, t.crossing, work);                                 \
		keep_##NAME(&t, x, &search);                                                                           \
		compare(#NAME, start, &swift, &search, STATES, NAME##_model.h);                                        \
	}
#define NO_LOADS
#define ONE_COS_SIN                                                                                                    \
	x[STATES_OF(s)] = 1;                                                                                           \
	pl_cossin(s->phase[0], x + STATES_OF(s) + 1);
#define COS_SIN_ONE                                                                                                    \
	pl_cossin(s->phase[0], x + STATES_OF(s));                                                                      \
	x[STATES_OF(s) + 2] = 1;
#define STATES_OF(s) (int)(sizeof(s)->y / sizeof *(s)->y)

MODEL(gear1_0, 2, 5, ONE_COS_SIN)
MODEL(gear1_1, 2, 5, ONE_COS_SIN)
MODEL(gear1_2, 2, 5, ONE_COS_SIN)
MODEL(gear2_0, 4, 7, ONE_COS_SIN)
MODEL(gear2_1, 4, 7, ONE_COS_SIN)
MODEL(gear3_0, 6, 9, COS_SIN_ONE)
MODEL(two_masses_0, 4, 7, COS_SIN_ONE)
MODEL(two_masses_1, 4, 7, COS_SIN_ONE)
MODEL(stop_0, 2, 2, NO_LOADS)
MODEL(stop_1, 2, 2, NO_LOADS)
MODEL(bilinear_0, 2, 2, NO_LOADS)
MODEL(bilinear_1, 2, 2, NO_LOADS)

/* least: that many of all starts it has to be sure of, and of so many that cross */
static void all_starts(const char *name, void (*one)(int start, const struct place *p), struct place p, int least,
	int least_once)
{
	tally = (struct tally){ 0 };
	for (int i = 0; i < STARTS; i++)
		one(i, &p);
	ok(tally.wrong == 0, "%s: %d clear steps and %d with a crossing, as the search has them; unsure of %d", name,
	    tally.clear, tally.once, tally.unsure);
	bool many = tally.clear + tally.once >= least && tally.once >= least_once;
	ok(many, "%s: it is sure of %d, at least %d, %d of them with a crossing, at least %d", name,
	   tally.clear + tally.once, least, tally.once, least_once);
	note("%s: times off by %.2g h, states by %.2g of the largest; several crossings in %d steps", name, tally.time,
	    tally.state, tally.more);
}

int main(void)
{
	const struct place gear = { 1.5, 1, 0, -1, 1 }, mesh = { 0.04, 1, 1, -1, 0.01 },
			   masses = { 0.03, 1, 0, 1, 0.02 }, zero = { 0.01, 1, 0, -1, 0 };
	all_starts("gear1, h = 0.01", one_gear1_0, gear, 3700, 900);
	all_starts("gear1, h = 0.1", one_gear1_1, gear, 3700, 950);
	all_starts("gear1, h = 1", one_gear1_2, gear, 3700, 1450);
	all_starts("gear2, h = 0.1", one_gear2_0, gear, 3700, 1000);
	all_starts("gear2, h = 1", one_gear2_1, gear, 3700, 1400);
	all_starts("gear3, h = 0.01", one_gear3_0, mesh, 3700, 1250);
	all_starts("two_masses, h = 0.002", one_two_masses_0, masses, 3800, 450);
	all_starts("two_masses, h = 0.01", one_two_masses_1, masses, 3800, 800);
	all_starts("stop, h = 0.001", one_stop_0, zero, 3700, 900);
	all_starts("stop, h = 0.01", one_stop_1, zero, 3700, 1450);
	all_starts("bilinear, h = 0.01", one_bilinear_0, zero, 3700, 1350);
	all_starts("bilinear, h = 0.1", one_bilinear_1, zero, 3700, 1850);
	ok(several >= 150, "all models: it is sure of %d steps with several crossings, at least 150", several);
	return tap_end();
}
