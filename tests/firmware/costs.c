/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a step of the model MODEL_model takes: a line SIZE TICKS, sizeof the state and SysTick's ticks over STEPS steps,
 * those of as many calls of an empty function taken off. Under QEMU's -icount, SysTick counts instructions. */
#include "port.h"
#include "variant.h"

extern const real_model MODEL;

enum { STEPS = 200, BEFORE = 50, STATE = 4096, INPUTS = 16 };
#define SYSTICK ((volatile uint32_t *)0xE000E010) /* control, reload, value */

static uint64_t state[STATE];
static real inputs[INPUTS];

static void nothing(void *s, const real *u)
{
	(void)s;
	(void)u;
}

/* SysTick has 24 bits: of each call, since a step may take a million. */
static uint32_t ticks_of(void (*volatile f)(void *, const real *))
{
	uint32_t total = 0;
	int i;
	for (i = 0; i < STEPS; i++) {
		const uint32_t before = SYSTICK[2];
		f(state, inputs);
		total += (before - SYSTICK[2]) & 0xFFFFFF;
	}
	return total;
}

int main(void)
{
	int i;
	if (MODEL.size > sizeof state)
		stop(3);
	SYSTICK[1] = 0xFFFFFF;
	SYSTICK[2] = 0;
	SYSTICK[0] = 5; /* on, from the processor's clock, no interrupt */
	MODEL.init(state);
	for (i = 0; i < INPUTS; i++)
		inputs[i] = (real)0.01;
	for (i = 0; i < BEFORE; i++)
		MODEL.step(state, inputs); /* away from zeros, with which soft float is done early */
	put_count((uint32_t)MODEL.size);
	put(" ");
	put_count(ticks_of(MODEL.step) - ticks_of(nothing));
	put("\n");
	stop(0);
}
