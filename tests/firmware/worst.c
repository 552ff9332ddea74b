/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The longest step of the model MODEL that a search finds, from starts of random signs and sizes at random times: a
 * line of SysTick's ticks, in the mean and at most, and of the bound in the model's header, which is included before.
 * Under QEMU's -icount, SysTick counts instructions. */
#include "port.h"
#include "variant.h"
extern const real_model MODEL;

enum { STARTS = 40, STEPS = 64, STATE = 1024, INPUTS = 16, MOST = 64 };
#define SYSTICK ((volatile uint32_t *)0xE000E010) /* control, reload, value */

static uint64_t state[STATE];
static real inputs[INPUTS], y[MOST];
static uint32_t seed = 1;

static uint32_t draw(void)
{
	seed = seed * 1664525u + 1013904223u;
	return seed >> 8;
}

/* Of either sign, within 2^+-range */
static real any_size(int range)
{
	real size = 1 + (real)(draw() & 0xFFFFF) / (real)0x100000 + (real)(draw() & 0xFFFFF) / (real)1e12;
	int e = range > 0 ? (int)(draw() % (uint32_t)(2 * range)) - range : 0;
	for (; e > 0; e--)
		size *= 2;
	for (; e < 0; e++)
		size /= 2;
	return draw() & 1 ? size : -size;
}

#ifdef TIMES /* when loads change their formula */
static const real times[] = { TIMES };
#endif

/* Where there are such times, mostly up to two steps before one of them */
static real any_time(real most)
{
#ifdef TIMES
	if (draw() % 4) {
		const real time = times[draw() % (sizeof times / sizeof *times)];
		const real before = MODEL.h * (real)(draw() % 2048) / 1024;
		return time > before ? time - before : 0;
	}
#endif
	return most * (real)(draw() % 100000) / 100000;
}

static void nothing(void *s, const real *u)
{
	(void)s, (void)u;
}

static uint32_t ticks_of(void (*volatile f)(void *, const real *))
{
	const uint32_t before = SYSTICK[2];
	f(state, inputs);
	return (before - SYSTICK[2]) & 0xFFFFFF;
}

/* The next step's instructions, in ticks */
static uint32_t next_step(void)
{
	const uint32_t spent = ticks_of(MODEL.step);
	int i;
	for (i = 0; i < INPUTS; i++)
		inputs[i] = any_size(3);
	return spent - ticks_of(nothing);
}

#ifdef SPECIAL
/* Places of events, from which starts are found that are the slowest: one entry after the other is moved a little or
 * far, to 0 or to such a place, and what takes no less time is kept. */
static const real special[] = { SPECIAL };
enum { TRIES = 1000, CLIMBS = 4, AHEAD = 2, SPECIALS = sizeof special / sizeof *special };

static void change(real *entry)
{
	const uint32_t way = draw() % 8;
	const real small = any_size(0) / (real)((uint64_t)1 << draw() % 50);
	if (way < 3)
		*entry += small;
	else if (way < 6)
		*entry *= 1 + small;
	else if (way == 6)
		*entry = draw() % 2 ? 0 : any_size(4);
	else
		*entry = special[draw() % SPECIALS] * (draw() % 2 ? 1 : 1 + small);
}

static uint32_t most_from(real t)
{
	uint32_t most = 0;
	int k;
	MODEL.init(state);
	MODEL.set(state, t, y);
	for (k = 0; k < AHEAD; k++) {
		const uint32_t spent = next_step();
		most = spent > most ? spent : most;
	}
	return most;
}

static uint32_t climbed(void)
{
	uint32_t best = 0;
	int climb, i, j;
	for (climb = 0; climb < CLIMBS; climb++) {
		real kept[MOST], t = 0;
		uint32_t top = 0;
		for (i = 0; i < MODEL.states; i++)
			y[i] = kept[i] = any_size(0);
		for (j = 0; j < TRIES; j++) {
			const real then = draw() % 8 ? t : any_time(14);
			uint32_t spent;
			for (i = (int)(draw() % 3); i >= 0; i--)
				change(&y[draw() % (uint32_t)MODEL.states]);
			spent = most_from(then);
			if (spent >= top) {
				top = spent;
				t = then;
			}
			for (i = 0; i < MODEL.states; i++)
				*(spent >= top ? &kept[i] : &y[i]) = spent >= top ? y[i] : kept[i];
		}
		best = top > best ? top : best;
	}
	return best;
}
#else
static uint32_t climbed(void)
{
	return 0;
}
#endif

int main(void)
{
	uint32_t most = 0, calls = 0, far;
	uint64_t total = 0;
	int i, j, k;
	if (MODEL.size > sizeof state)
		stop(3);
	SYSTICK[1] = 0xFFFFFF;
	SYSTICK[2] = 0;
	SYSTICK[0] = 5; /* on, from the processor's clock, no interrupt */
	for (j = 0; j < STARTS; j++) {
		MODEL.init(state);
		for (i = 0; i < MODEL.states; i++)
			y[i] = any_size(j % 4 ? 12 * (j % 4) : 0);
		MODEL.set(state, any_time(14000), y);
		for (k = 0; k < STEPS; k++) {
			const uint32_t spent = next_step();
			most = spent > most ? spent : most;
			total += spent;
			calls++;
		}
	}
	far = climbed();
	put_count((uint32_t)(total / calls));
	put(" ");
	put_count(far > most ? far : most);
	put(" ");
	put_count(COUNTED_STEP_MAX);
	put("\n");
	stop(0);
}
