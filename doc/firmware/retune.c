/* SPDX-License-Identifier: MIT-0 */
/* A quarter car whose damper is turned while it runs: a timer interrupt steps it at 1 kHz, the background computes what
 * another cs makes of the coefficients.  suspension_pl.c is of `quarter_car.spec` with a line `tunable cs`.
 *
 * suspension_retune takes longer than a step may and touches the coefficients alone: it may be interrupted anywhere,
 * and nothing is masked.  suspension_use copies them into the instance, which is the interrupt's: there it is called,
 * between two steps.  One buffer is enough, since the background leaves it alone from when it hands it over until it
 * was taken. To call suspension_use outside instead, mask the interrupt around it, never around suspension_retune. */
#include "suspension_pl.h"

#ifndef BOARD_CLOCK_HZ
#define BOARD_CLOCK_HZ 25000000u /* of the processor, which SysTick counts */
#endif

/* Of your board: 1 and a new cs [N s/m] where the knob was turned, else 0; called in the background. */
int board_knob(float *cs);
/* Called in the interrupt, after each step; took: it was the first with other coefficients. */
void board_tick(const suspension *now, int took);

static suspension car;                 /* the interrupt's */
static suspension_coeffs next;         /* the background's while `ready` is 0, the interrupt's while it is 1 */
static volatile int ready;

void SysTick_Handler(void)
{
    const int took = ready;
    if (took) {
        suspension_use(&car, &next); /* state and time stay */
        ready = 0;
    }
    suspension_step(&car);
    board_tick(&car, took);
}

/* What cannot be computed, with a mass of 0, leaves the coefficients as they were. */
static void background(void)
{
    float cs;
    if (!ready && board_knob(&cs) && suspension_retune(&next, &cs, SUSPENSION_H) == 0) {
        __asm__ volatile("" ::: "memory"); /* all of it is stored before it is handed over */
        ready = 1;
    }
}

int main(void)
{
    volatile uint32_t *const systick = (volatile uint32_t *)0xE000E010; /* control, reload, value */
    suspension_init(&car);
    systick[1] = BOARD_CLOCK_HZ / 1000 - 1;
    systick[2] = 0;
    systick[0] = 7; /* on, with interrupt, from the processor's clock */
    for (;;)
        background();
}
