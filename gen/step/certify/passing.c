/* SPDX-License-Identifier: GPL-3.0-or-later */
/* States and crossings of a piecewise-linear model in closed form, for the target's self-test to step to. Of several
 * starts one is taken that crosses and that rounding does not lead astray: a second start beside it must pass the same
 * breakpoints and stay close. */
#include "inner.h"
#include "model/regions/switching_functions.h"
#include "model/regions/regions.h"
#include "step/regions/guards.h"

#include <math.h>
#include <stdlib.h>

enum {
	LEAST_ROWS = 8,             /* without a crossing */
	ENOUGH = 5, MANY = 40,      /* crossings */
	STARTS = 13,
	FEWEST_BITS = 192, MOST_BITS = 768,
	MOST = 150,                 /* crossings that are followed */
	PASSED_AT_START = 10,       /* crossings in the first 2^-10 of a step are none that is counted */
	LISTED_AT_ONCE = 12,        /* of impacts at one instant, as in runtime/chain.h */
	BESIDE = 36,                /* the second start is off by 2^-36; in float */
	GROWTH = 8,                 /* and grows by no more than that */
	MOST_LOST = 30              /* bits that enclosures may lose: each bounce of several loses some */
};

/* 1, -3/4, 5/8, -9/16, ...: no two alike, none of them rounded */
void reference_start(int state, mpq_ptr value)
{
	int power = state < 20 ? state : 20;
	mpq_set_ui(value, (1ul << power) + 1, 1ul << power);
	mpq_div_2exp(value, value, 1);
	if (state % 2)
		mpq_neg(value, value);
}

double ulp_of(double value, bool single)
{
	int exponent;
	frexp(value, &exponent);
	return ldexp(1, exponent - (single ? 24 : 53));
}

/* The model on its way, all parts of it */
struct ways {
	const struct step *step;
	int count;
	struct trajectory **way;
};

static const struct switching *regions_of(const struct step *step)
{
	return step->model->switching;
}

static struct ways ways_of(const struct step *step, const mpq_t *start, int bits)
{
	const struct switching *s = regions_of(step);
	struct ways w = { .step = step, .count = s->parts ? s->parts : 1 };
	w.way = ARRAY(struct trajectory *, w.count);
	for (int p = 0; p < w.count; p++)
		trajectory_limit(w.way[p] = trajectory_start(step->model, s->parts ? &s->part[p] : NULL, start, bits),
				 MOST);
	return w;
}

static void free_ways(struct ways *w)
{
	for (int p = 0; p < w->count; p++)
		trajectory_free(w->way[p]);
	discard(w->way);
}

static const char *reach(const struct ways *w, mpq_srcptr time)
{
	for (int p = 0; p < w->count; p++)
		if (!trajectory_reach(w->way[p], time))
			return trajectory_undecided(w->way[p]);
	return NULL;
}

/* Rounded, what is 0 but for its enclosure to 0; false: not known well enough. *width: of the widest enclosure */
static bool states_of(const struct ways *w, double *y, mpfr_ptr width)
{
	const struct switching *s = regions_of(w->step);
	bool known = true;
	mpfi_t x;
	mpfi_init(x);
	REAL here = WITH_BITS(53);
	mpfr_set_zero(width, 1);
	for (int p = 0; p < w->count; p++) {
		int count = s->parts ? s->part[p].model->system.states : w->step->branch->system.states;
		for (int i = 0; i < count; i++) {
			double *value = &y[s->parts ? s->part[p].state[i] : i];
			trajectory_state(w->way[p], i, x);
			mpfi_diam_abs(here, x);
			mpfr_max(width, width, here, MPFR_RNDU);
			if (round_enclosure(x, value))
				continue;
			known = known && mpfi_has_zero(x) && fabs(mpfr_get_d(&x->left, MPFR_RNDA)) < 0x1p-160;
			*value = 0;
		}
	}
	mpfi_clear(x);
	return known;
}

static int crossings_of(const struct ways *w)
{
	const struct passed *list;
	int count = 0;
	for (int p = 0; p < w->count; p++)
		count += trajectory_passed(w->way[p], &list);
	return count;
}

static double largest_of(const struct reference *r, int state)
{
	double largest = fabs(r->start[state]);
	for (int k = 0; k < r->rows; k++)
		largest = fmax(largest, fabs(r->value[k * r->states + state]));
	return largest;
}

static double largest_of_all(const struct reference *r, const double *y)
{
	double largest = 0;
	for (int i = 0; i < r->states; i++)
		largest = fmax(largest, fmax(largest_of(r, i), fabs(y[i])));
	return largest;
}

/* ---- crossings, of all parts by time ---- */

struct moment {
	double at;                  /* [s] */
	const struct region_part *part;
	struct passed passed;
};

static int by_time(const void *a, const void *b)
{
	const struct moment *x = a, *y = b;
	return (x->at > y->at) - (x->at < y->at);
}

static struct moment *all_crossings(const struct ways *w, int *count)
{
	struct moment *all = ARRAY(struct moment, crossings_of(w) + 1);
	*count = 0;
	for (int p = 0; p < w->count; p++) {
		const struct passed *list;
		const struct switching *s = regions_of(w->step);
		const struct region_part *part = s->parts ? &s->part[p] : NULL;
		int passed = trajectory_passed(w->way[p], &list);
		for (int k = 0; k < passed; k++)
			all[(*count)++] = (struct moment){ mpfi_get_d(list[k].at), part, list[k] };
	}
	qsort(all, (size_t)*count, sizeof *all, by_time);
	return all;
}

/* What the switching function is summed from where the states are largest */
static double size_of_function(const struct step *step, const struct reference *r, const struct moment *now)
{
	const struct region_part *part = now->part;
	const struct model *model = part ? part->model : step->model;
	const struct output *row = model->switching->function[now->passed.function].row;
	double size = 0;
	for (int i = 0; i < model->system.states; i++)
		size += fabs(mpq_get_d(row->state[i])) * largest_of(r, part ? part->state[i] : i);
	return size;
}

/* Steps before it, what of the time is after them, and what rounding takes: of the switching function as it is summed,
 * by its speed, and of the step */
static void take_crossing(const struct step *step, struct reference *r, const struct moment *now)
{
	bool single = step->model->request.single;
	double h = mpq_get_d(step->model->h), speed = now->passed.jumped ? HUGE_VAL : now->passed.speed;
	double size = now->passed.size + size_of_function(step, r, now);
	RATIONAL time = ZERO, full = ZERO;
	INTEGER before = INTEGER_ZERO;
	mpfr_get_q(time, &now->passed.at->left);
	mpq_div(full, time, step->model->h);
	mpz_fdiv_q(before, mpq_numref(full), mpq_denref(full));
	ENLARGE(r->crossing, (size_t)r->crossings + 1);
	r->crossing[r->crossings].step = mpz_get_ui(before);
	mpq_set_z(full, before);
	mpq_mul(full, full, step->model->h);
	mpq_sub(time, time, full);
	r->crossing[r->crossings].after = round_rational(time);
	r->crossing[r->crossings++].unit = ulp_of(fmax(h, size / speed), single);
}

static void take_crossings(struct reference *r, const struct ways *w)
{
	int count;
	SCRATCH struct moment *all = all_crossings(w, &count);
	r->crossings = 0;
	for (int k = 0; k < count; k++)
		if (all[k].at > ldexp(mpq_get_d(w->step->model->h), -PASSED_AT_START))
			take_crossing(w->step, r, &all[k]);
}

/* ---- a start, and beside it another ---- */

static void start_of(const struct step *step, int number, mpq_t *start)
{
	static const int power[STARTS] = { 0, 0, 3, -3, 6, -6, 9, -9, 12, -12, 16, -16, -20 };
	for (int i = 0; i < step->branch->system.states; i++) {
		if (number == 0)                        /* as the target has it */
			mpq_set_d(start[i], round_rational(step->model->initial[i]));
		if (number == 0)
			continue;
		reference_start(i, start[i]);
		if (power[number] > 0)
			mpq_mul_2exp(start[i], start[i], (mp_bitcnt_t)power[number]);
		else
			mpq_div_2exp(start[i], start[i], (mp_bitcnt_t)-power[number]);
	}
}

/* Each state off by a part of itself: off 0, what lies would bounce. */
static mpq_t *start_beside(const struct step *step, const mpq_t *start)
{
	int states = step->branch->system.states, bits = step->model->request.single ? 18 : BESIDE;
	mpq_t *beside = rationals(states);
	RATIONAL off = ZERO;
	for (int i = 0; i < states; i++) {
		mpq_abs(off, start[i]);
		mpq_div_2exp(off, off, (mp_bitcnt_t)bits);
		(i % 3 == 1 ? mpq_sub : mpq_add)(beside[i], start[i], off);
	}
	return beside;
}

/* Whether the target may meet number k and those of the instant before in another order, or one of them not: floats,
 * and contacts that bounce together */
static bool blurs(const struct step *step, const struct reference *r, const struct moment *all, int k)
{
	bool single = step->model->request.single, blurred = false;
	if (k == 0 || !(single || regions_of(step)->impacts > 1) || !(all[k].at > all[k - 1].at))
		return false;
	for (int j = k - 1; j >= 0 && !blurred && !(all[j].at < all[k - 1].at); j--) {
		double size = all[j].passed.size + size_of_function(step, r, &all[j]);
		blurred = all[j].passed.speed > 0 &&
			  all[k].at - all[j].at < 4 * ulp_of(size / all[j].passed.speed, single);
	}
	return blurred;
}

/* Whether the target may leave number k out of its list, or another one of that step: of bounces it lists no more than
 * so many at one instant, and once the list of a step is half full, not all that follow each other closely. It lays
 * what bounces to rest by another rule, too, where little room is left. */
static bool is_unlisted(const struct step *step, const struct moment *all, int k)
{
	int half = max_events(step->model) / 2;
	double h = mpq_get_d(step->model->h);
	return regions_of(step)->impacts > 0 &&
	       ((k >= LISTED_AT_ONCE && !(all[k].at > all[k - LISTED_AT_ONCE].at)) ||
		(k >= half && !(all[k].at - all[k - half].at > h)));
}

/* Whether both have passed the same, and are no further apart than a start may be. What was let go at rest floats do
 * not tell apart from what is not; and what is 0 by impacts alone is on the target what rounding makes of it. */
static bool are_close(const struct reference *r, const struct ways *a, const struct ways *b, const double *y,
		      const double *beside)
{
	int count, other;
	const struct moment *x = all_crossings(a, &count), *z = all_crossings(b, &other);
	bool close = count == other;
	double apart = ldexp(GROWTH, -(a->step->model->request.single ? 18 : BESIDE));
	for (int k = 0; k < count && close; k++)
		close = !x[k].passed.stands && !(x[k].passed.faint && a->step->model->request.single) &&
			x[k].passed.function == z[k].passed.function &&
			x[k].passed.breakpoint == z[k].passed.breakpoint && x[k].passed.upward == z[k].passed.upward &&
			!blurs(a->step, r, x, k) && !is_unlisted(a->step, x, k);
	for (int i = 0; i < r->states && close; i++) {
		double largest = fmax(largest_of(r, i), fabs(y[i]));
		close = isfinite(y[i]) && fabs(y[i] - beside[i]) <= apart * largest;
	}
	return close;
}

/* The references from one start, with so many bits; false: these were too few */
static bool try_start(const struct step *step, struct reference *r, const mpq_t *start, int bits)
{
	RATIONALS *near = start_beside(step, start);
	double *other = ARRAY(double, r->states);
	struct ways a = ways_of(step, start, bits), b = ways_of(step, near, bits);
	bool known = true, goes = true;
	RATIONAL time = ZERO;
	REAL width = WITH_BITS(53), unused = WITH_BITS(53);
	mpq_div_2exp(time, step->model->h, 1);
	r->rows = r->crossings = 0;
	for (int i = 0; i < r->states; i++)
		r->start[i] = round_rational(start[i]);
	known = !reach(&a, time) && states_of(&a, r->between, unused);
	while (known && goes && r->rows < REFERENCE_ROWS &&
	       (r->crossings < ENOUGH || (r->rows < LEAST_ROWS && r->crossings < MANY))) {
		double *y = r->value + r->rows * r->states;
		mpq_set_ui(time, r->steps[r->rows], 1);
		mpq_mul(time, time, step->model->h);
		goes = !reach(&a, time);
		known = goes ? states_of(&a, y, width) : crossings_of(&a) >= MOST;
		goes = goes && known && !reach(&b, time);
		if (goes)
			(void)states_of(&b, other, unused);
		goes = goes && mpfr_cmp_d(width, ldexp(largest_of_all(r, y), MOST_LOST - bits)) <= 0;
		if (goes && (goes = are_close(r, &a, &b, y, other))) {
			r->rows++;
			take_crossings(r, &a);
		}
	}
	free_ways(&a);
	free_ways(&b);
	return known || r->rows >= LEAST_ROWS;
}

static void fill_units(struct reference *r, bool single)
{
	for (int i = 0; i < r->states; i++) {
		double largest = largest_of(r, i);
		r->unit[i] = largest > 0 ? ulp_of(largest, single) : 1;
	}
}

static const unsigned long steps[REFERENCE_ROWS] = { 1, 2, 3, 5, 10, 20, 50, 100, 200, 500, 1000 };

struct reference new_reference(int states)
{
	const size_t n = (size_t)states;
	return (struct reference){ .states = states, .steps = steps, .start = ARRAY(double, n),
				   .value = ARRAY(double, n * REFERENCE_ROWS), .between = ARRAY(double, n),
				   .unit = ARRAY(double, n) };
}

struct reference reference_of_trajectory(const struct step *step)
{
	struct reference best = { 0 };
	mpq_t *start = rationals(step->branch->system.states);
	for (int number = 0; number < STARTS && best.crossings < ENOUGH; number++) {
		struct reference r = new_reference(step->branch->system.states);
		start_of(step, number, start);
		for (int bits = FEWEST_BITS; !try_start(step, &r, start, bits) && bits < MOST_BITS;)
			bits *= 2;
		if (r.rows > 0 && (r.crossings > best.crossings || best.rows == 0))
			best = r;
	}
	if (best.crossings == 0)
		error((struct place){ source_argument("--selftest"), 0 }, NULL,
		      "--selftest finds no start from which a breakpoint is passed in %lu steps, apart from others and "
		      "clearly", steps[REFERENCE_ROWS - 1]);
	fill_units(&best, step->model->request.single);
	return best;
}
