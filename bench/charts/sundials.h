/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run by SUNDIALS (solvers_sundials.c). A solver that stops at roots and begins anew behind them begins with this
 * struct, and fills in what they are before cvode_make; what else it has is its own. */
#ifndef SUNDIALS_H
#define SUNDIALS_H

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunmatrix/sunmatrix_dense.h>

#include "adaptive.h"

enum { MOST_ROOTS = 8 };

struct sundials {
	struct adaptive adaptive;
	SUNContext context;
	void *memory;               /* of CVODE or ARKODE */
	N_Vector y, tolerances;
	SUNNonlinearSolver fixed_point;
	SUNMatrix jacobian;
	SUNLinearSolver dense;
	double start;               /* CVODE: time, and has it taken the first step since */
	bool begun;
	int roots;                  /* how many; 0: none are looked for. distance: of `of`, a struct sundials */
	int (*distance)(realtype t, N_Vector y, realtype *g, void *of);
	/* At t, where y may change; found[k]: 1 or -1, the sign of the slope of root k, or 0 */
	void (*crossed)(struct sundials *s, double t, const int *found);
};

/* As struct solver has them; roots_reach: over all roots until `end`, else false */
bool cvode_make(struct adaptive *a);
bool cvode_begin(struct adaptive *a, double t, const double *y);
bool roots_reach(struct adaptive *a, double end, double *y);
void cvode_discard(struct adaptive *a);

#endif
