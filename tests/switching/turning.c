/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Free drives with gaps that turn for a long time, in the type that the model was made in: -DFLOAT for float; -DKIND
 * says which. The torque is that of the drive at rest, momentum is that of the start. */
#include "model.h"
#include "../emitted/worse.h"
#if KIND == 3
#define rig gear3
#define rig_init gear3_init
#define rig_step gear3_step
#define rig_get gear3_get
#define rig_set gear3_set
#define rig_out gear3_out
#define rig_status gear3_status
#define RIG_STATES GEAR3_STATES
#define RIG_OUTPUTS GEAR3_OUTPUTS
#endif

#include <float.h>
#include <math.h>
#include <stdio.h>

#ifdef FLOAT
typedef float real;
#define EPSILON FLT_EPSILON
#define TORQUE 1e-5
#else
typedef double real;
#define EPSILON DBL_EPSILON
#define TORQUE 1e-13
#endif

#if KIND == 1
/* Drive and load are 1.2, and so is the torque, but for what still swings in the first 100 s */
static int check(void)
{
	static rig s;
	const real u[2] = { (real)1.2, (real)1.2 };
	real out[RIG_OUTPUTS];
	double worst = 0, speed = 0;
	rig_init(&s);
	for (long k = 1; k <= 2000000; k++) {
		rig_step(&s, u);
		if (k <= 100000 || k % 1009)
			continue;
		rig_out(&s, out);
		worst = worse(worst, fabs((double)out[0] - (double)u[0]) / 1.2);
		speed = worse(speed, fabs((double)out[2] - 100) / 100);
	}
		printf("# torque off by %.3g of its size, at most %.3g; speed by %.3g, at most %.3g\n", worst, TORQUE,
				speed,
			   TORQUE);
		return worst <= TORQUE && speed <= TORQUE && rig_status(&s) == 0;
}
#elif KIND == 2
/* J1 x1' + J2 x2' + 3/2 J3 x3' */
static double momentum(const rig *s)
{
	real y[RIG_STATES];
	rig_get(s, y);
	return 0.3 * (double)y[3] + 1.1 * (double)y[4] + 1.05 * (double)y[5];
}

static int check(void)
{
	static rig s;
	double worst = 0;
	rig_init(&s);
	const double start = momentum(&s);
	for (long k = 1; k <= 200000; k++) {
		rig_step(&s);
		worst = worse(worst, fabs(momentum(&s) - start) / start / (double)EPSILON);
	}
	printf("# %d crossings; momentum off by %.3g epsilon, at most 4\n", (int)rig_crossed(&s), worst);
	return worst <= 4 && rig_crossed(&s) > 10000 && rig_status(&s) == 0;
}
#else
/* As a whole turning at 100, all else is as at rest. */
static int check(void)
{
	static rig turning, resting;
	real y[RIG_STATES], a[RIG_OUTPUTS], b[RIG_OUTPUTS];
	double worst = 0, largest = 0;
	rig_init(&resting);
	rig_get(&resting, y);
	for (int i = 3; i < 6; i++)
		y[i] += 100;
	rig_set(&turning, 0, y);
	for (long k = 1; k <= 200000; k++) {
		rig_step(&turning);
		rig_step(&resting);
		rig_out(&turning, a);
		rig_out(&resting, b);
		for (int i = 0; i < 2; i++) {
			worst = worse(worst, fabs((double)a[i] - (double)b[i]));
			largest = fmax(largest, fabs((double)b[i]));
		}
	}
	printf("# twists up to %.3g, off by %.3g of that, at most %.3g\n", largest, worst / largest, TORQUE);
	return worst <= TORQUE * largest && rig_status(&turning) == 0;
}
#endif

int main(void)
{
	return check() ? 0 : 1;
}
