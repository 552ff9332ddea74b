/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sweep: steady amplitude and mean of a gear pair over the frequency of its force, up and then down, each start being
 * the end of the one before; where two motions are stable the two ways differ. One line each: eta, amplitude, mean; a
 * blank line between. */
#include "plrt.h"

#include <stdio.h>
#include <stdlib.h>

extern const pl_model *const sweep_models[];
extern const double sweep_eta[];
extern const int sweep_count;

enum { SETTLING = 300, LOOKED_AT = 20 };        /* periods */

/* y: the state, turns: the phase of the force; both in and out */
static void settle(const pl_model *model, double eta, double *y, double *turns)
{
	const double period = 6.283185307179586 / eta;
	const long steps = (long)(period / model->h) + 1, all = steps * SETTLING;
	void *state = malloc(model->size);
	double low = 1e300, high = -1e300;
	if (!state)
		exit(1);
	model->set(state, *turns * period, y);
	for (long k = 0; k < all; k++) {
		model->step(state, NULL);
		model->get(state, y);
		if (k >= all - steps * LOOKED_AT) {
			low = y[0] < low ? y[0] : low;
			high = y[0] > high ? y[0] : high;
		}
	}
	*turns += (double)all * model->h / period;
	*turns -= (double)(long)*turns;
	printf("%.6g %.9g %.9g\n", eta, (high - low) / 2, (high + low) / 2);
	free(state);
}

int main(void)
{
	double y[2] = {1.1, 0.0}, turns = 0.0;
	for (int i = 0; i < sweep_count; i++)
		settle(sweep_models[i], sweep_eta[i], y, &turns);
	printf("\n\n");
	for (int i = sweep_count - 1; i >= 0; i--)
		settle(sweep_models[i], sweep_eta[i], y, &turns);
	return 0;
}
