/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The longest step of the model MODEL that a search finds, from starts of random signs and sizes at random times: a
 * line of SysTick's ticks, in the mean and at most, and of the bound in the model's header, which is included before.
 * Under QEMU's -icount, SysTick counts instructions. */
#include "plrt.h"
#include "port.h"
#ifdef REAL_FLOAT
typedef float real;
typedef pl_modelf description;
#else
typedef double real;
typedef pl_model description;
#endif
extern const description MODEL;

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

int main(void)
{
    uint32_t most = 0, calls = 0;
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
        MODEL.set(state, (real)(draw() % 100000) / 7, y);
        for (k = 0; k < STEPS; k++) {
            uint32_t spent;
            for (i = 0; i < INPUTS; i++)
                inputs[i] = any_size(3);
            spent = ticks_of(MODEL.step) - ticks_of(nothing);
            most = spent > most ? spent : most;
            total += spent;
            calls++;
        }
    }
    put_count((uint32_t)(total / calls));
    put(" ");
    put_count(most);
    put(" ");
    put_count(COUNTED_STEP_MAX);
    put("\n");
    stop(0);
}
