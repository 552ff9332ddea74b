/* SPDX-License-Identifier: MIT-0 */
/* external.h: NAME_casadi, one step as an external function of CasADi, and jac_NAME_casadi, its Jacobian, under the
 * names and signatures of its user's guide.  (x, u, t) -> (x_next, y): states, held inputs where there are some, time;
 * states and outputs h later.  Included by the file of the model behind derivatives.h, whose columns are by every
 * initial state and then along every input; it defines before it
 *
 *     PL_TYPE                    the model
 *     PL_JAC(name)               the prefix of functions of the Jacobian: jac_NAME_casadi */
#include "numbers.h"

#ifndef casadi_real
#define casadi_real double
#endif
#ifndef casadi_int
#define casadi_int long long int
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define PL_ARGUMENTS (PL_INPUTS > 0 ? 3 : 2)
enum { PL(casadi_results) = 2 };

/* Rows, columns, and 1: all entries are there; 0, 0: of one column none is */
static const casadi_int PL(casadi_shape)[] = {PL_STATES, 1, 1, PL_INPUTS, 1, 1, 1, 1, 1, PL_OUTPUTS, 1, 1};
static const casadi_int PL(casadi_none)[] = {PL_STATES, 1, 0, 0, PL_OUTPUTS, 1, 0, 0};
static const casadi_int PL(casadi_blocks)[] = {PL_STATES, PL_STATES, 1, PL_STATES, PL_INPUTS, 1,
								   PL_OUTPUTS, PL_STATES, 1, PL_OUTPUTS, PL_INPUTS, 1};

/* 0: x, 1: u, 2: t */
static int PL(casadi_kind)(casadi_int i)
{
	return PL_INPUTS > 0 || i == 0 ? (int)i : 2;
}

casadi_int PL(casadi_n_in)(void)
{
	return PL_ARGUMENTS;
}

casadi_int PL(casadi_n_out)(void)
{
	return PL(casadi_results);
}

const char *PL(casadi_name_in)(casadi_int i)
{
	static const char *const name[] = {"x", "u", "t"};
	return i < 0 || i >= PL_ARGUMENTS ? NULL : name[PL(casadi_kind)(i)];
}

const char *PL(casadi_name_out)(casadi_int i)
{
	return i == 0 ? "x_next" : i == 1 ? "y" : NULL;
}

const casadi_int *PL(casadi_sparsity_in)(casadi_int i)
{
	return i < 0 || i >= PL_ARGUMENTS ? NULL : PL(casadi_shape) + 3 * PL(casadi_kind)(i);
}

const casadi_int *PL(casadi_sparsity_out)(casadi_int i)
{
	return i == 0 ? PL(casadi_shape) : i == 1 ? PL(casadi_shape) + 9 : NULL;
}

/* The step goes from t, and no derivative by t is there. */
casadi_int PL(casadi_is_diff_in)(casadi_int i)
{
	return PL(casadi_kind)(i) != 2;
}

int PL(casadi_work)(casadi_int *sz_arg, casadi_int *sz_res, casadi_int *sz_iw, casadi_int *sz_w)
{
	if (sz_arg != NULL) {
		*sz_arg = PL_ARGUMENTS;
	}
	if (sz_res != NULL) {
		*sz_res = PL(casadi_results);
	}
	if (sz_iw != NULL) {
		*sz_iw = 0;
	}
	if (sz_w != NULL) {
		*sz_w = 0;
	}
	return 0;
}

static void PL(casadi_start)(const casadi_real **arg, PL_TYPE *s, PL(d) *ds, real u[])
{
	const casadi_real *const at = arg[PL_ARGUMENTS - 1];
	real y[PL_STATES];
	int i;
	for (i = 0; i < PL_STATES; i++) {
		y[i] = arg[0] == NULL ? 0 : arg[0][i];
	}
	for (i = 0; i < PL_INPUTS; i++) {
		u[i] = arg[1] == NULL ? 0 : arg[1][i];
	}
	PL(init_d)(s, ds);
	PL(set)(s, at == NULL ? 0 : at[0], y);
}

int PL(casadi)(const casadi_real **arg, casadi_real **res, casadi_int *iw, casadi_real *w, int mem)
{
	PL_TYPE s;
	PL(d) ds;
	real u[PL_INPUTS + 1];
	PL(casadi_start)(arg, &s, &ds, u);
#if PL_INPUTS > 0
	PL(step)(&s, u);
#else
	PL(step)(&s);
#endif
	if (res[0] != NULL) {
		PL(get)(&s, res[0]);
	}
	if (res[1] != NULL) {
		PL(out)(&s, res[1]);
	}
	(void)iw;
	(void)w;
	(void)mem;
	return PL(status)(&s) != 0;
}

/* ---- the Jacobian: of each result by each argument, column by column; the results themselves are not read ---- */

casadi_int PL_JAC(_n_in)(void)
{
	return PL_ARGUMENTS + PL(casadi_results);
}

casadi_int PL_JAC(_n_out)(void)
{
	return PL_ARGUMENTS * PL(casadi_results);
}

const casadi_int *PL_JAC(_sparsity_in)(casadi_int i)
{
	return i < PL_ARGUMENTS ? PL(casadi_sparsity_in)(i)
		 : i < PL_ARGUMENTS + PL(casadi_results) ? PL(casadi_none) + 4 * (i - PL_ARGUMENTS) : NULL;
}

const casadi_int *PL_JAC(_sparsity_out)(casadi_int i)
{
	const casadi_int result = i / PL_ARGUMENTS;
	const int kind = PL(casadi_kind)(i % PL_ARGUMENTS);
	if (i < 0 || result >= PL(casadi_results)) {
		return NULL;
	}
	return kind == 2 ? PL(casadi_none) + 4 * result : PL(casadi_blocks) + 6 * result + 3 * kind;
}

int PL_JAC(_work)(casadi_int *sz_arg, casadi_int *sz_res, casadi_int *sz_iw, casadi_int *sz_w)
{
	PL(casadi_work)(sz_arg, sz_res, sz_iw, sz_w);
	if (sz_arg != NULL) {
		*sz_arg = PL_ARGUMENTS + PL(casadi_results);
	}
	if (sz_res != NULL) {
		*sz_res = PL_ARGUMENTS * PL(casadi_results);
	}
	return 0;
}

int PL_JAC()(const casadi_real **arg, casadi_real **res, casadi_int *iw, casadi_real *w, int mem)
{
	PL_TYPE s;
	PL(d) ds;
	real u[PL_INPUTS + 1], du[PL_INPUTS + 1], J[PL_OUTPUTS][PL_DERIVATIVES];
	int i, p;
	PL(casadi_start)(arg, &s, &ds, u);
	PL(set_d)(&ds, NULL);
	for (p = 0; p < PL_STATES; p++) {
		ds.s[p][p] = 1;
	}
	for (p = 0; p < PL_INPUTS; p++) {
		du[p] = 1;
	}
#if PL_INPUTS > 0
	PL(step_d)(&s, &ds, u, du);
#else
	(void)du;
	PL(step_d)(&s, &ds);
#endif
	PL(out_d)(&s, &ds, J);
	for (p = 0; p < PL_DERIVATIVES; p++) {
		const int block = p >= PL_STATES, column = p - block * PL_STATES;
		casadi_real *const next = res[block], *const y = res[PL_ARGUMENTS + block];
		for (i = 0; i < PL_STATES && next != NULL; i++) {
			next[column * PL_STATES + i] = ds.s[p][i];
		}
		for (i = 0; i < PL_OUTPUTS && y != NULL; i++) {
			y[column * PL_OUTPUTS + i] = J[i][p];
		}
	}
	(void)iw;
	(void)w;
	(void)mem;
	return PL(status)(&s) != 0 || ds.status != 0;
}

#ifdef __cplusplus
}
#endif

#include "undef.h"
