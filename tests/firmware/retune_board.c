/* SPDX-License-Identifier: MIT-0 */
/* A board for doc/firmware/retune.c, whose knob is turned all the time. Beside it another instance gets the same
 * coefficients, computed in the interrupt that first has them: both have the same bits after each step, however often
 * the computation in the background was interrupted. Printed: ticks, how many of them were inside a computation, how
 * many had other coefficients, and in how many the bits differed. */
#include "suspension_pl.h"

#include "port.h"

static suspension beside;
static uint32_t ticks, inside, taken, different;
static volatile int computing;
static float value;

/* 200 to 2400, up and down */
int board_knob(float *cs)
{
	static uint32_t turn;
	turn++;
	value = 200.0f + 100.0f * (float)(turn % 44 < 22 ? turn % 44 : 44 - turn % 44);
	*cs = value;
	computing = 1;
	return 1;
}

static void take(void)
{
	static suspension_coeffs coeffs;
	if (suspension_retune(&coeffs, &value, SUSPENSION_H) != 0)
		stop(4);
	suspension_use(&beside, &coeffs);
	taken++;
	computing = 0;
}

void board_tick(const suspension *now, int took)
{
	union {
		float y[SUSPENSION_STATES];
		uint32_t bits[SUSPENSION_STATES];
	} a, b;
	int i, same = 1;
	if (ticks++ == 0)
		suspension_init(&beside);
	if (took)
		take();
	else
		inside += computing != 0;
	suspension_step(&beside);
	suspension_get(now, a.y);
	suspension_get(&beside, b.y);
	for (i = 0; i < SUSPENSION_STATES; i++)
		same = same && a.bits[i] == b.bits[i];
	different += !same;
	if (ticks < 1000)
		return;
	put_count(ticks);
	put(" ");
	put_count(inside);
	put(" ");
	put_count(taken);
	put(" ");
	put_count(different);
	put("\n");
	stop(0);
}
