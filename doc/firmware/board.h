/* SPDX-License-Identifier: MIT-0 */
/* What main.c wants of a board. */
#ifndef BOARD_H
#define BOARD_H

#include "quarter_car_pl.h"

#ifndef BOARD_CLOCK_HZ
#define BOARD_CLOCK_HZ 25000000u /* of the processor, which SysTick counts */
#endif

/* Called every millisecond, in the interrupt: 1 and the travel of the suspension [m] where there is a new measurement,
 * else 0. */
int board_travel(float *travel);

/* Called every 50 ms, outside. */
void board_show(const quarter_car *now, const float out[QUARTER_CAR_OUTPUTS]);

#endif
