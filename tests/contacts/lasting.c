/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lasting STEPS: piecewise-linear models that lose no energy, so many steps long, with and without --accuracy
 * compensated, in double and float: their energy, and their state beside its closed form, both in multiprecision from
 * the decimals of the spec. Rounding e^{A h} to one word loses a part of the energy that is the same in every step; in
 * two words what is left is the rounding of increments, which wanders: its energy by their root of the number of steps,
 * the state, which falls behind or comes too early by what the energy is off, by the power 3/2 of it. */
#include "balls.h"
#include "balls_two.h"
#include "ballsf.h"
#include "ballsf_two.h"
#include "bounce.h"
#include "bounce_two.h"
#include "bouncef.h"
#include "bouncef_two.h"
#include "gap.h"
#include "gap_two.h"
#include "gapf.h"
#include "gapf_two.h"
#include "pair.h"
#include "pair_two.h"
#include "pairf.h"
#include "pairf_two.h"
#include "tap.h"

#include <math.h>
#include <mpfr.h>
#include <stdlib.h>

enum { BITS = 400, MOST = 4 };
#define UP MPFR_RNDN

/* ---- numbers ---- */

static void decimal(mpfr_t x, const char *text)
{
	mpfr_init2(x, BITS);
	mpfr_set_str(x, text, 10, UP);
}

static void numbers(int count, mpfr_t *x)
{
	for (int i = 0; i < count; i++)
		mpfr_init2(x[i], BITS);
}

static void cleared(int count, mpfr_t *x)
{
	for (int i = 0; i < count; i++)
		mpfr_clear(x[i]);
}

/* sum += factor x x / 2 */
static void add_square(mpfr_t sum, const char *factor, mpfr_t x)
{
	mpfr_t f;
	decimal(f, factor);
	mpfr_mul(f, f, x, UP);
	mpfr_mul(f, f, x, UP);
	mpfr_div_ui(f, f, 2, UP);
	mpfr_add(sum, sum, f, UP);
	mpfr_clear(f);
}

/* x beyond -b .. b */
static void beyond(mpfr_t d, mpfr_t x, const char *b)
{
	mpfr_t end;
	decimal(end, b);
	mpfr_abs(d, x, UP);
	mpfr_sub(d, d, end, UP);
	if (mpfr_sgn(d) < 0)
		mpfr_set_zero(d, 0);
	mpfr_clear(end);
}

/* ---- closed forms, from 0 with the velocity v on; t is used up ---- */

/* x'' + k x = 0: x, and its velocity in `rate`; k = 0 too */
static void swing(mpfr_t k, mpfr_t v, mpfr_t t, mpfr_t x, mpfr_t rate)
{
	mpfr_t w;
	mpfr_init2(w, BITS);
	mpfr_sqrt(w, k, UP);
	mpfr_mul(x, w, t, UP);
	mpfr_sin_cos(x, rate, x, UP);
	mpfr_mul(rate, rate, v, UP);
	if (mpfr_zero_p(w)) {
		mpfr_mul(x, v, t, UP);
	} else {
		mpfr_mul(x, x, v, UP);
		mpfr_div(x, x, w, UP);
	}
	mpfr_clear(w);
}

/* When it is at b first */
static void arrival(mpfr_t k, mpfr_t v, mpfr_t b, mpfr_t t)
{
	mpfr_t w;
	mpfr_init2(w, BITS);
	mpfr_sqrt(w, k, UP);
	mpfr_div(t, b, v, UP);
	if (!mpfr_zero_p(w)) {
		mpfr_mul(t, t, w, UP);
		mpfr_asin(t, t, UP);
		mpfr_div(t, t, w, UP);
	}
	mpfr_clear(w);
}

/* x'' + k x + s deadzone(x, -b, b) = 0: a quarter of the period is the way to b and half the contact. */
static void between_stops(const char *stiffness, const char *stop, const char *clearance, mpfr_t v, mpfr_t t, mpfr_t x,
			  mpfr_t rate)
{
	enum { K, W, B, MIDDLE, FREE, CONTACT, SPEED, HALF, PART, NUMBERS };
	mpfr_t n[NUMBERS], s;
	bool down = false;
	numbers(NUMBERS, n);
	mpfr_set_str(n[K], stiffness, 10, UP);
	mpfr_set_str(n[B], clearance, 10, UP);
	decimal(s, stop);
	arrival(n[K], v, n[B], n[FREE]);
	mpfr_set(n[PART], n[FREE], UP);
	swing(n[K], v, n[PART], x, n[SPEED]);
	mpfr_add(n[W], n[K], s, UP);
	mpfr_mul(n[MIDDLE], s, n[B], UP);
	mpfr_div(n[MIDDLE], n[MIDDLE], n[W], UP);
	mpfr_sqrt(n[W], n[W], UP);
	mpfr_sub(n[B], n[B], n[MIDDLE], UP);    /* from the middle of the contact's motion */
	mpfr_div(n[SPEED], n[SPEED], n[W], UP);
	mpfr_atan2(n[CONTACT], n[SPEED], n[B], UP);
	mpfr_mul_ui(n[CONTACT], n[CONTACT], 2, UP);
	mpfr_div(n[CONTACT], n[CONTACT], n[W], UP);
	mpfr_mul_ui(n[HALF], n[FREE], 2, UP);
	mpfr_add(n[HALF], n[HALF], n[CONTACT], UP);
	mpfr_mul_ui(n[PART], n[HALF], 2, UP);
	mpfr_fmod(t, t, n[PART], UP);
	if (mpfr_cmp(t, n[HALF]) > 0) {
		mpfr_sub(t, t, n[HALF], UP);
		down = true;
	}
	mpfr_sub(n[PART], n[HALF], t, UP);      /* to the end of the half */
	if (mpfr_cmp(t, n[FREE]) <= 0) {
		swing(n[K], v, t, x, rate);
	} else if (mpfr_cmp(n[PART], n[FREE]) <= 0) {
		swing(n[K], v, n[PART], x, rate);
		mpfr_neg(rate, rate, UP);
	} else {
		mpfr_sub(t, t, n[FREE], UP);
		mpfr_mul(t, t, n[W], UP);
		mpfr_sin_cos(n[PART], n[HALF], t, UP);  /* B cos + SPEED sin */
		mpfr_mul(x, n[B], n[HALF], UP);
		mpfr_fma(x, n[SPEED], n[PART], x, UP);
		mpfr_add(x, x, n[MIDDLE], UP);
		mpfr_mul(rate, n[SPEED], n[HALF], UP);
		mpfr_mul(n[B], n[B], n[PART], UP);
		mpfr_sub(rate, rate, n[B], UP);
		mpfr_mul(rate, rate, n[W], UP);
	}
	if (down) {
		mpfr_neg(x, x, UP);
		mpfr_neg(rate, rate, UP);
	}
	cleared(NUMBERS, n);
	mpfr_clear(s);
}

static void gap_state(mpfr_t *start, mpfr_t t, mpfr_t *y)
{
	between_stops("0", "40", "1.1", start[1], t, y[0], y[1]);
}

/* With r = a - b and s = a + b: r'' + 16.7 r + 63.4 deadzone(r, -0.23, 0.23) = 0, s'' + 9.3 s = 0 */
static void pair_state(mpfr_t *start, mpfr_t t, mpfr_t *y)
{
	mpfr_t n[7], k;
	numbers(7, n);
	decimal(k, "9.3");
	mpfr_sub(n[0], start[2], start[3], UP);
	mpfr_add(n[1], start[2], start[3], UP);
	mpfr_set(n[6], t, UP);
	swing(k, n[1], n[6], n[4], n[5]);
	between_stops("16.7", "63.4", "0.23", n[0], t, n[2], n[3]);
	for (int i = 0; i < 2; i++) {
		mpfr_add(y[2 * i], n[4 + i], n[2 + i], UP);
		mpfr_sub(y[2 * i + 1], n[4 + i], n[2 + i], UP);
		mpfr_div_ui(y[2 * i], y[2 * i], 2, UP);
		mpfr_div_ui(y[2 * i + 1], y[2 * i + 1], 2, UP);
	}
	cleared(7, n);
	mpfr_clear(k);
}

/* Back from the floor as it came, so that the period is half a swing and twice the way from 0 to it */
static void bounce_state(mpfr_t *start, mpfr_t t, mpfr_t *y)
{
	enum { K, B, DOWN, HALF, PERIOD, NUMBERS };
	mpfr_t n[NUMBERS];
	numbers(NUMBERS, n);
	mpfr_set_str(n[K], "40.3", 10, UP);
	mpfr_set_str(n[B], "0.45", 10, UP);
	arrival(n[K], start[1], n[B], n[DOWN]);
	mpfr_const_pi(n[HALF], UP);
	mpfr_sqrt(n[PERIOD], n[K], UP);
	mpfr_div(n[HALF], n[HALF], n[PERIOD], UP);
	mpfr_add(n[DOWN], n[DOWN], n[HALF], UP);
	mpfr_mul_ui(n[PERIOD], n[DOWN], 2, UP);
	mpfr_sub(n[PERIOD], n[PERIOD], n[HALF], UP);
	mpfr_fmod(t, t, n[PERIOD], UP);
	const bool back = mpfr_cmp(t, n[DOWN]) > 0;
	if (back)
		mpfr_sub(t, n[PERIOD], t, UP);
	swing(n[K], start[1], t, y[0], y[1]);
	if (back)
		mpfr_neg(y[0], y[0], UP);
	cleared(NUMBERS, n);
}

/* ---- energies ---- */

static void gap_energy(mpfr_t *y, mpfr_t energy)
{
	mpfr_t d;
	mpfr_init2(d, BITS);
	beyond(d, y[0], "1.1");
	add_square(energy, "40", d);
	add_square(energy, "1", y[1]);
	mpfr_clear(d);
}

static void pair_energy(mpfr_t *y, mpfr_t energy)
{
	mpfr_t r, d;
	mpfr_inits2(BITS, r, d, (mpfr_ptr)0);
	mpfr_sub(r, y[0], y[1], UP);
	beyond(d, r, "0.23");
	add_square(energy, "31.7", d);
	add_square(energy, "3.7", r);
	for (int i = 0; i < 2; i++) {
		add_square(energy, "9.3", y[i]);
		add_square(energy, "1", y[2 + i]);
	}
	mpfr_clears(r, d, (mpfr_ptr)0);
}

static void bounce_energy(mpfr_t *y, mpfr_t energy)
{
	add_square(energy, "40.3", y[0]);
	add_square(energy, "1", y[1]);
}

static void balls_energy(mpfr_t *y, mpfr_t energy)
{
	add_square(energy, "13.7", y[0]);
	add_square(energy, "41.9", y[1]);
	add_square(energy, "1.3", y[2]);
	add_square(energy, "2.9", y[3]);
}

/* ---- a run ---- */

struct scene {
	const char *name, *step;
	void (*energy)(mpfr_t *y, mpfr_t energy);
	void (*state)(mpfr_t *start, mpfr_t t, mpfr_t *y);      /* NULL: no closed form */
	const pl_model *model[2];       /* without, with two words */
	const pl_modelf *modelf[2];
	double energy_off, state_off;   /* in double after a million steps, at most; in float 2^29 times that */
};

struct errors { double energy, state; };

union room { max_align_t align; char bytes[8192]; };

static void get(const struct scene *c, bool kept, bool single, const void *s, mpfr_t *y)
{
	double now[MOST];
	float nowf[MOST];
	if (single)
		c->modelf[kept]->get(s, nowf);
	else
		c->model[kept]->get(s, now);
	for (int i = 0; i < c->model[kept]->states; i++)
		mpfr_set_d(y[i], single ? (double)nowf[i] : now[i], UP);
}

static double relative(mpfr_t found, mpfr_t expected, mpfr_t size)
{
	mpfr_t d;
	mpfr_init2(d, BITS);
	mpfr_sub(d, found, expected, UP);
	mpfr_div(d, d, size, UP);
	double off = fabs(mpfr_get_d(d, UP));
	mpfr_clear(d);
	return off;
}

static struct errors run(const struct scene *c, bool kept, bool single, unsigned long steps)
{
	static union room s;
	struct errors off = { 0, 0 };
	const int states = c->model[kept]->states;
	mpfr_t start[MOST], now[MOST], true_y[MOST], e[2], t, one;
	numbers(MOST, start);
	numbers(MOST, now);
	numbers(MOST, true_y);
	numbers(2, e);
	decimal(t, c->step);
	decimal(one, "1");
	if (single) {
		c->modelf[kept]->init(&s);
		get(c, kept, single, &s, start);
		c->modelf[kept]->run(&s, steps, NULL, NULL);
	} else {
		c->model[kept]->init(&s);
		get(c, kept, single, &s, start);
		c->model[kept]->run(&s, steps, NULL, NULL);
	}
	get(c, kept, single, &s, now);
	mpfr_set_zero(e[0], 0);
	mpfr_set_zero(e[1], 0);
	c->energy(start, e[0]);
	c->energy(now, e[1]);
	off.energy = relative(e[1], e[0], e[0]);
	mpfr_mul_ui(t, t, steps, UP);
	if (c->state)
		c->state(start, t, true_y);
	for (int i = 0; i < states && c->state; i++)
		off.state = worse(off.state, relative(now[i], true_y[i], one));
	int status = single ? c->modelf[kept]->status(&s) : c->model[kept]->status(&s);
	if (status != 0)
		off.energy = off.state = HUGE_VAL;
	cleared(MOST, start);
	cleared(MOST, now);
	cleared(MOST, true_y);
	cleared(2, e);
	mpfr_clear(t);
	mpfr_clear(one);
	return off;
}

static void scene(const struct scene *c, unsigned long steps)
{
	static const char *const real[] = { "double", "float" };
	const double share = (double)steps / 1e6, wander = sqrt(share);
	for (int single = 0; single < 2; single++) {
		const double unit = single ? 0x1p29 : 1;
		const struct errors one = run(c, false, single, steps), two = run(c, true, single, steps);
		const double energy = unit * c->energy_off * (wander + 0.05), state = unit * c->state_off *
										      (wander * share + 0.001);
		note("%s, %s: energy off by %.2g, two words %.2g; state by %.2g, %.2g", c->name, real[single],
		     one.energy, two.energy, one.state, two.state);
		ok(two.energy <= energy, "%s, %s: %.2g of the energy after %lu steps, allowed %.2g", c->name,
		   real[single], two.energy, steps, energy);
		if (c->state)
			ok(two.state <= state, "%s, %s: the state off by %.2g, allowed %.2g", c->name, real[single],
			   two.state, state);
		ok(20 * two.energy < one.energy || steps < 100000, "%s, %s: one word %.2g", c->name, real[single],
		   one.energy);
	}
}

int main(int argc, char **argv)
{
	static const struct scene scenes[] = {
		{ "gap", "0.01", gap_energy, gap_state, { &gap_model, &gap_two_model },
		  { &gapf_model, &gapf_two_model }, 5e-14, 5e-10 },
		{ "pair", "0.013", pair_energy, pair_state, { &pair_model, &pair_two_model },
		  { &pairf_model, &pairf_two_model }, 5e-14, 2e-10 },
		{ "bounce", "0.01", bounce_energy, bounce_state, { &bounce_model, &bounce_two_model },
		  { &bouncef_model, &bouncef_two_model }, 5e-14, 2e-9 },
		{ "balls", "0.01", balls_energy, NULL, { &balls_model, &balls_two_model },
		  { &ballsf_model, &ballsf_two_model }, 2e-14, 0 },
	};
	const unsigned long steps = argc > 1 ? strtoul(argv[1], NULL, 10) : 100000;
	for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++)
		scene(&scenes[i], steps);
	return tap_end();
}
