/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A board for the example of doc/firmware/, without a car: the true one is a model that started elsewhere, and the
 * sensor tells its travel every 10 ms. Printed, in micrometres: how far the body of the corrected model is from the
 * true one, and how far it is without corrections. */
#include "board.h"

#include "port.h"

static quarter_car truth, left_alone;
static uint32_t calls;

int board_travel(float *travel)
{
	float y[QUARTER_CAR_STATES];
	if (calls++ == 0) {
		const float start[QUARTER_CAR_STATES] = {0.03f, 0.01f, -0.4f, 0.5f};
		quarter_car_init(&left_alone);
		quarter_car_set(&truth, 0.0f, start);
	}
	quarter_car_step(&truth);
	quarter_car_step(&left_alone);
	if (calls % 10 != 0)
		return 0;
	quarter_car_get(&truth, y);
	*travel = y[1] - y[0];
	return 1;
}

static void put_distance(const quarter_car *model)
{
	float y[QUARTER_CAR_STATES], right[QUARTER_CAR_STATES], off;
	quarter_car_get(model, y);
	quarter_car_get(&truth, right);
	off = y[0] < right[0] ? right[0] - y[0] : y[0] - right[0];
	put_count((uint32_t)(off * 1e6f + 0.5f));
	put(" ");
}

void board_show(const quarter_car *now, const float out[QUARTER_CAR_OUTPUTS])
{
	(void)out;
	put_count((uint32_t)(quarter_car_time(now) * 1000.0f + 0.5f));
	put(" ");
	put_count(calls);
	put(" ");
	put_distance(now);
	put_distance(&left_alone);
	put("\n");
	if (calls >= 1000)
		stop(0);
}
