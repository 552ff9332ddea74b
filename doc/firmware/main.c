/* SPDX-License-Identifier: MIT-0 */
/* A quarter car beside the real one: stepped by a timer interrupt at 1 kHz, and kept near it by what a sensor measures.
 *
 * Bare metal: no operating system, no allocation, no library but the runtime.  board.h is what your board has to offer.
 */
#include "board.h"
#include "quarter_car_pl.h"

/* Written by the interrupt, so read outside it only by snapshot(). */
static quarter_car car;
static volatile uint32_t ticks; /* of 1 ms: QUARTER_CAR_H */

/* The sensor tells how far the suspension is pressed, wheel - body [m].  Each gain says how much of a surprise of 1 m
 * goes into that state: body, wheel [m], body', wheel' [m/s].  These are a Kalman filter's, for a measurement every 10
 * ms that is good to 1 mm. */
static void correct(float travel)
{
    static const float gain[QUARTER_CAR_STATES] = {-0.64f, 0.15f, -6.0f, 11.4f};
    float y[QUARTER_CAR_STATES], surprise;
    int i;
    quarter_car_get(&car, y);
    surprise = travel - (y[1] - y[0]);
    for (i = 0; i < QUARTER_CAR_STATES; i++)
        y[i] += gain[i] * surprise;
    /* The time comes from the counter of ticks.  Time that is read back and set again, in float, would be rounded each
     * time. */
    quarter_car_set(&car, (float)ticks * QUARTER_CAR_H, y);
}

void SysTick_Handler(void)
{
    float travel;
    quarter_car_step(&car);
    ticks++;
    if (board_travel(&travel))
        correct(travel);
}

/* A state that no interrupt is about to change: a copy is all it takes. */
static quarter_car snapshot(void)
{
    quarter_car copy;
    __asm__ volatile("cpsid i" ::: "memory");
    copy = car;
    __asm__ volatile("cpsie i" ::: "memory");
    return copy;
}

int main(void)
{
    volatile uint32_t *const systick = (volatile uint32_t *)0xE000E010; /* control, reload, value */
    uint32_t shown = 0;

    quarter_car_init(&car);
    systick[1] = BOARD_CLOCK_HZ / 1000 - 1;
    systick[2] = 0;
    systick[0] = 7; /* on, with interrupt, from the processor's clock */

    for (;;) {
        __asm__ volatile("wfi");
        if (ticks - shown >= 50) {
            const quarter_car now = snapshot();
            float out[QUARTER_CAR_OUTPUTS]; /* body, wheel, travel in mm, comfort, force on the tyre */
            shown += 50;
            quarter_car_out(&now, out);
            board_show(&now, out);
        }
    }
}
