/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scales: the scales that the tolerances of adaptive integrators stand on are those of the motion. Standard input has a
 * line for each problem, from `precision --scales` and `hard --scales`: name, shared object, unit [s], units, largest
 * |coordinate|, largest |velocity|. The other road: CVODE's BDF on NAME_rhs, whose largest values over its own steps
 * must be within a factor of 2. Its tolerances know nothing of the motion: 1e-6 relative, 1e-9 absolute. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

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
	SUNContext context;
	if (SUNContext_Create(NULL, &context) != 0)
		return false;
	N_Vector y = N_VNew_Serial(2 * p->n, context);
	SUNMatrix jacobian = SUNDenseMatrix(2 * p->n, 2 * p->n, context);
	SUNLinearSolver dense = SUNLinSol_Dense(y, jacobian, context);
	void *memory = CVodeCreate(CV_BDF, context);
	const double end = p->unit * p->units;
	double t = 0;
	memcpy(NV_DATA_S(y), p->start, 2 * (size_t)p->n * sizeof(double));
	keep_largest(p, p->start, largest);
	bool good = CVodeInit(memory, slope, 0, y) == 0 && CVodeSStolerances(memory, 1e-6, 1e-9) == 0 &&
	            CVodeSetUserData(memory, p) == 0 && CVodeSetLinearSolver(memory, dense, jacobian) == 0 &&
	            CVodeSetStopTime(memory, end) == 0;
	while (good && t < end) {
		good = CVode(memory, end, y, &t, CV_ONE_STEP) >= 0;
		keep_largest(p, NV_DATA_S(y), largest);
	}
	CVodeFree(&memory);
	SUNLinSolFree(dense);
	SUNMatDestroy(jacobian);
	N_VDestroy(y);
	SUNContext_Free(&context);
	return good;
}

static void compare(const char *name, const char *of, double scale, double largest)
{
	const double share = largest / scale;
	ok(close_to(share >= 1 ? share : 1 / share, 1, factor - 1, "%s: scale of %s %.6g, CVODE's largest %.6g: ratio", name,
	            of, scale, largest), "%s: scale of %s", name, of);
}

int main(void)
{
	char line[5000], name[64], file[4096];
	double unit, scale_q, scale_v;
	int units;
	while (fgets(line, sizeof line, stdin)) {
		if (sscanf(line, "%63[^\t]\t%4095[^\t]\t%lf\t%d\t%lf\t%lf", name, file, &unit, &units, &scale_q, &scale_v) != 6) {
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
