/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A free drive against the same drive in twist and mean by hand: outputs and crossings, while drive and load change.
 * Each crossing makes a difference about 1.2 times as large, so that rounding in another order shows after some
 * hundred: 229 are looked at. */
#include "model.h"
#include "by_hand.h"
#include "../emitted/worse.h"

#include <math.h>
#include <stdio.h>

int main(void)
{
	static rig s;
	static by_hand e;
	static const double size[3] = { 10, 2000, 200 };
	double a[3], b[3], y[4], z[4], worst = 0, early = 0;
	rig_init(&s);
	by_hand_init(&e);
	for (int k = 0; k < 6000; k++) {
		const double u[2] = { 1.2 + 2 * sin(0.05 * k), 1.1 + cos(0.03 * k) };
		rig_at(&s, u, 0.3 * RIG_H, y);
		by_hand_at(&e, u, 0.3 * RIG_H, z);
		early = worse(early, fabs(y[0] - y[1] - z[0]) / 0.1 + fabs(y[2] / 6 + y[3] * 5 / 6 - z[3]) / 100);
		rig_step(&s, u);
		by_hand_step(&e, u);
		rig_out(&s, a);
		by_hand_out(&e, b);
		for (int i = 0; i < 3; i++)
			worst = worse(worst, fabs(a[i] - b[i]) / size[i]);
	}
	printf("# %d and %d crossings; outputs off by %.3g, between steps %.3g, at most 1e-10\n", (int)rig_crossed(&s),
		(int)by_hand_crossed(&e), worst, early);
        return worst <= 1e-10 && early <= 1e-10 && rig_crossed(&s) == by_hand_crossed(&e) && rig_crossed(&s) > 200 ? 0
                                                                                                                   : 1;
}
