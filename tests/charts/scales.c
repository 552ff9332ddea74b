/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scales: the scales that the tolerances of adaptive integrators stand on are those of the motion. Standard input has a
 * line for each problem, from `precision --scales` and `hard --scales`: name, shared object, unit [s], units, largest
 * |coordinate|, largest |velocity|. The other road: CVODE's BDF on NAME_rhs, whose largest values over its own steps
 * must be within a factor of 2. Its tolerances know nothing of the motion: 1e-6 relative, 1e-9 absolute. */
#include <math.h>
#include <stdlib.h>
#include <string.h>


#include "../cvode.h"
#include "charts.h"
#include "tap.h"

static const double factor = 2;

static int slope(realtype t, N_Vector y, N_Vector dydt, void *of)
{
	problem_slope(of, t, NV_DATA_S(y), NV_DATA_S(dydt));
	return 0;
}

static void keep_largest(const struct problem *p, const double *y, double largest[2])
{
	for (int i = 0; i < 2 * p->n; i++)
		largest[i >= p->n] = fmax(largest[i >= p->n], fabs(y[i]));
}

/* Of coordinates and of velocities over the history; false: CVODE gave up */
static bool follow(struct problem *p, double largest[2])
{
	const double end = p->unit * p->units;
	double t = 0;
	struct cvode c;
	keep_largest(p, p->start, largest);
	bool good = cvode_open(&c, CV_BDF, 2 * p->n, p->start, slope, p, 1e-6, 1e-9, NULL) &&
	            CVodeSetStopTime(c.memory, end) == 0;
	while (good && t < end) {
		good = CVode(c.memory, end, c.y, &t, CV_ONE_STEP) >= 0;
		keep_largest(p, NV_DATA_S(c.y), largest);
	}
	cvode_close(&c);
	return good;
}

static void compare(const char *name, const char *of, double scale, double largest)
{
	const double share = largest / scale;
		ok(close_to(share >= 1 ? share : 1 / share, 1, factor - 1,
				"%s: scale of %s %.6g, CVODE's largest %.6g: ratio",
					name, of, scale, largest),
		   "%s: scale of %s", name, of);
}

int main(void)
{
	char line[5000], name[64], file[4096];
	double unit, scale_q, scale_v;
	int units;
	while (fgets(line, sizeof line, stdin)) {
			if (sscanf(line, "%63[^\t]\t%4095[^\t]\t%lf\t%d\t%lf\t%lf", name, file, &unit, &units, &scale_q,
					   &scale_v) != 6) {
				ok(false, "a line with scales: %s", line);
				continue;
			}
				struct problem *p = problem_load(file, name, unit, units, false, 0);
		double largest[2] = { 0, 0 };
		ok(follow(p, largest), "%s: CVODE comes to the end", name);
		compare(name, "coordinates", scale_q, largest[0]);
		compare(name, "velocities", scale_v, largest[1]);
		problem_free(p);
	}
	return tap_end();
}
