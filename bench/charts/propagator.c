/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Linear problems by what everyone can do with a library: a matrix exponential computed once and multiplied with the
 * state at each step, and modal superposition. Loads are states of their own, so both act on
 *
 *     z = y, 1, cos w t, sin w t        z' = [A b0 b1 b2; 0; 0 0 0 -w; 0 0 w 0] z
 *
 * of which what a problem does not have is left out. A step is unit/k for an integer k; `between` is as exact as a
 * step. The matrix is applied by a loop, by code for its size, by code that has its entries as constants, by a
 * library, and in float.
 */
#include <dlfcn.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cblas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>

#include "propagator.h"

/* ---- the augmented system ---- */

static bool any(int count, const double *x)
{
	for (int i = 0; x && i < count; i++)
		if (x[i] != 0.0)
			return true;
	return false;
}

static bool is_pushed(const struct problem *p)
{
	return any(2 * p->n, p->b0);
}

static bool is_shaken(const struct problem *p)
{
	return p->w != 0.0 && (any(2 * p->n, p->b1) || any(2 * p->n, p->b2));
}

static void set_column(struct propagator *r, int column, const double *b)
{
	for (int i = 0; i < r->own; i++)
		r->generator[i * r->size + column] = b[i];
}

static void augment(struct propagator *r)
{
	const struct problem *p = r->run.problem;
	int next = r->own, size = r->size;
	for (int i = 0; i < r->own; i++)
		memcpy(r->generator + i * size, p->A + i * r->own, (size_t)r->own * sizeof *p->A);
	memcpy(r->start, p->start, (size_t)r->own * sizeof *p->start);
	if (is_pushed(p)) {
		set_column(r, next, p->b0);
		r->start[next++] = 1.0;
	}
	if (is_shaken(p)) {
		set_column(r, next, p->b1);
		set_column(r, next + 1, p->b2);
		r->generator[next * size + next + 1] = -p->w;
		r->generator[(next + 1) * size + next] = p->w;
		r->start[next] = 1.0;
	}
}

/* GSL's own, which loses more in squaring: its Taylor series takes a shorter part than it needs */
static void gsl_exponential(int entries, const double *generator, double length, double *result)
{
	const size_t size = (size_t)entries;
	double *scaled = calloc(size * size, sizeof *scaled);
	for (size_t i = 0; scaled && i < size * size; i++)
		scaled[i] = length * generator[i];
	gsl_matrix_view from = gsl_matrix_view_array(scaled, size, size),
		to = gsl_matrix_view_array(result, size, size);
	if (!scaled || gsl_linalg_exponential_ss(&from.matrix, &to.matrix, GSL_PREC_DOUBLE) != GSL_SUCCESS)
		for (size_t i = 0; i < size * size; i++)
			result[i] = NAN;
	free(scaled);
}

/* ---- a step as a plain loop ---- */

/* spare <- matrix z; nothing acts on the loads but themselves */
static inline void multiply(int own, int size, const double *restrict matrix, const double *restrict z,
                            double *restrict spare)
{
	for (int i = 0; i < own; i++) {
		double sum = 0.0;
		for (int j = 0; j < size; j++)
			sum += matrix[i * size + j] * z[j];
		spare[i] = sum;
	}
	for (int i = own; i < size; i++) {
		double sum = 0.0;
		for (int j = own; j < size; j++)
			sum += matrix[i * size + j] * z[j];
		spare[i] = sum;
	}
}

static void loop_unit(struct propagator *r)
{
	double *z = r->z, *next = r->spare;
	for (int k = 0; k < r->steps; k++) {
		multiply(r->own, r->size, r->Phi, z, next);
		double *before = z;
		z = next;
		next = before;
	}
	r->z = z;
	r->spare = next;
}

/* The size is known when this is compiled, and the loops are unrolled: the matrix stays in reach, the state in
 * registers */
enum { FOUR = 4 };
static inline void fixed_size_step(const double *restrict Phi, double *restrict z)
{
	double next[FOUR];
#pragma GCC unroll 4
	for (int i = 0; i < FOUR; i++) {
		next[i] = Phi[i * FOUR] * z[0];
#pragma GCC unroll 4
		for (int j = 1; j < FOUR; j++)
			next[i] += Phi[i * FOUR + j] * z[j];
	}
#pragma GCC unroll 4
	for (int i = 0; i < FOUR; i++)
		z[i] = next[i];
}

static void dgemv_unit(struct propagator *r)
{
	for (int k = 0; k < r->steps; k++) {
		double *z = r->z;
		cblas_dgemv(CblasRowMajor, CblasNoTrans, r->size, r->size, 1.0, r->Phi, r->size, z, 1, 0.0, r->spare,
		            1);
		r->z = r->spare;
		r->spare = z;
	}
}

/* ---- the run as charts.h has it ---- */

static void propagator_restart(struct run *run)
{
	struct propagator *r = (struct propagator *)run;
	memcpy(r->z, r->start, (size_t)r->size * sizeof *r->z);
	if (r->modes)
		modes_restart(r);
	r->failed = false;
}

/* What is not finite stays so: looked at once is enough */
static bool goes_on(struct propagator *r)
{
	r->failed = r->failed || !all_finite(r->own, r->z);
	return !r->failed;
}

static inline __attribute__((always_inline)) bool march(struct run *run, int units, double *rows,
                                                        void (*unit)(struct propagator *r))
{
	struct propagator *r = (struct propagator *)run;
	for (int u = 0; u < units && !r->failed; u++) {
		unit(r);
		if (rows)
			memcpy(rows + (ptrdiff_t)u * r->own, r->z, (size_t)r->own * sizeof *rows);
	}
	return goes_on(r);
}

static bool loop_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, loop_unit);
}

/* The state stays in registers from one output to the next */
static bool fixed_size_advance(struct run *run, int units, double *rows)
{
	struct propagator *r = (struct propagator *)run;
	const int steps = r->steps;
	double z[FOUR];
	memcpy(z, r->z, sizeof z);
	for (int u = 0; u < units; u++) {
		for (int k = 0; k < steps; k++)
			fixed_size_step(r->Phi, z);
		if (rows)
			memcpy(rows + (ptrdiff_t)u * FOUR, z, sizeof z);
	}
	memcpy(r->z, z, sizeof z);
	return goes_on(r);
}

static bool dgemv_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, dgemv_unit);
}

static bool modal_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, modal_unit);
}

static bool literals_advance(struct run *run, int units, double *rows)
{
	struct propagator *r = (struct propagator *)run;
	r->literals(r->z, units, rows);
	return goes_on(r);
}

/* ---- in float: the matrix, the state and the rows ---- */

static float *single_state(const struct propagator *r)
{
	return r->single + r->size * r->size;
}

static void single_steps(struct propagator *r, int steps)
{
	const int own = r->own, size = r->size;
	const float *restrict Phi = r->single;
	float *restrict z = single_state(r), *restrict next = z + size;
	for (int k = 0; k < steps; k++) {
		for (int i = 0; i < size; i++) {
			float sum = 0;
			for (int j = i < own ? 0 : own; j < size; j++)
				sum += Phi[i * size + j] * z[j];
			next[i] = sum;
		}
		memcpy(z, next, (size_t)size * sizeof *z);
	}
}

/* Rows stay as the user of a float has them; the state goes to z, where the rest of this file looks for it */
static bool single_timed(struct run *run, int units)
{
	struct propagator *r = (struct propagator *)run;
	float *z = single_state(r);
	if (units > r->rows) {
		free(r->row);
		r->rows = units;
		r->row = room_for((size_t)units * (size_t)r->own, sizeof *r->row);
	}
	if (r->literals_single)
		r->literals_single(z, units, r->row);
	else
		for (int u = 0; u < units; u++) {
			single_steps(r, r->steps);
			memcpy(r->row + (ptrdiff_t)u * r->own, z, (size_t)r->own * sizeof *z);
		}
	for (int i = 0; i < r->size; i++)
		r->z[i] = z[i];
	return goes_on(r);
}

static bool single_advance(struct run *run, int units, double *rows)
{
	enum { CHUNK = 1000 };
	struct propagator *r = (struct propagator *)run;
	for (int k = 0; k < units; k += CHUNK) {
		const int some = units - k < CHUNK ? units - k : CHUNK;
		single_timed(run, some);
		for (int i = 0; rows && i < some * r->own; i++)
			rows[k * r->own + i] = r->row[i];
	}
	return !r->failed;
}

static void single_restart(struct run *run)
{
	struct propagator *r = (struct propagator *)run;
	float *z = single_state(r);
	propagator_restart(run);
	for (int i = 0; i < r->size; i++)
		r->z[i] = z[i] = (float)r->start[i];
}

/* Whole steps, and the exponential of the rest (in double); what it needs for that is its own, or spare */
static void propagator_between(struct run *run, double fraction, double *y)
{
	struct propagator *r = (struct propagator *)run;
	const int whole = (int)floor(fraction * r->steps + 1e-9);
	const double rest = fraction * run->problem->unit - whole * r->h;
	const size_t bytes = (size_t)r->size * sizeof(double);
	double *ahead = r->ahead, *next = r->spare;
	if (rest != r->part_length)
		pade_exponential(r->size, r->generator, r->part_length = rest, r->part);
	memcpy(ahead, r->z, bytes);
	for (int k = 0; k < whole; k++) {
		multiply(r->own, r->size, r->Phi, ahead, next);
		memcpy(ahead, next, bytes);
	}
	multiply(r->own, r->size, r->part, ahead, next);
	memcpy(y, next, (size_t)r->own * sizeof *y);
}

static void propagator_get(const struct run *run, double *y)
{
	const struct propagator *r = (const struct propagator *)run;
	memcpy(y, r->z, (size_t)r->own * sizeof *y);
}

static void propagator_close(struct run *run)
{
	struct propagator *r = (struct propagator *)run;
	free(r->generator);
	modes_discard(r->modes);
	free(r->single);
	free(r->row);
	if (r->code)
		dlclose(r->code);
	free(r);
}

/* In one block of memory */
static void allot(struct propagator *r)
{
	const size_t size = (size_t)r->size;
	r->generator = room_for(3 * size * size + 4 * size, sizeof(double));
	r->Phi = r->generator + size * size;
	r->part = r->Phi + size * size;
	r->start = r->part + size * size;
	r->z = r->start + size;
	r->spare = r->z + size;
	r->ahead = r->spare + size;
}

/* How the matrix of a step is found, and how it is applied */
enum way { LOOP, FIXED_SIZE, DGEMV, LITERALS, MODAL };
struct kind {
	struct method method;       /* first: a pointer to it is a pointer to this */
	enum way way;
	void (*exponential)(int size, const double *generator, double length, double *result);  /* NULL: pade.c */
	bool single;
};
static bool (*const advances[])(struct run *run, int units, double *rows) = {
	loop_advance, fixed_size_advance, dgemv_advance, literals_advance, modal_advance
};

/* Its matrix as it then is, as code */
static bool with_literals(struct propagator *r)
{
	const struct literals l = {.own = r->own, .size = r->size, .steps = r->steps, .single = r->single != NULL,
	                           .Phi = r->Phi};
	r->code = literals_load(&l);
	void *advance = r->code ? dlsym(r->code, "advance") : NULL;
	memcpy(&r->literals, &advance, sizeof advance);
	memcpy(&r->literals_single, &advance, sizeof advance);
	return advance;
}

/* The matrix as it then is, rounded to float, and a state in float */
static bool in_float(struct propagator *r)
{
	const size_t size = (size_t)r->size;
	r->single = calloc(size * size + 2 * size, sizeof *r->single);
	for (size_t i = 0; r->single && i < size * size; i++)
		r->Phi[i] = r->single[i] = (float)r->Phi[i];
	r->run.restart = single_restart;
	r->run.advance = single_advance;
	r->run.timed = single_timed;
	return r->single;
}

static bool make(struct propagator *r, const struct kind *kind)
{
	allot(r);
	augment(r);
	if (kind->exponential)
		kind->exponential(r->size, r->generator, r->h, r->Phi);
	else
		pade_exponential(r->size, r->generator, r->h, r->Phi);
	return !(kind->single && !in_float(r)) && !(kind->way == LITERALS && !with_literals(r)) &&
	       !(kind->way == MODAL && !modes_find(r));
}

static struct run *propagator_open(const struct method *method, const struct problem *p, double setting)
{
	const struct kind *kind = (const struct kind *)method;
	const int steps = steps_of(p, setting);
	const bool four = 2 * p->n == FOUR && p->A && !is_pushed(p) && !is_shaken(p);
	struct propagator *r = p->linear && p->A && steps > 0 && (four || kind->way != FIXED_SIZE) ?
		calloc(1, sizeof *r) : NULL;
	if (!r)
		return NULL;
	gsl_set_error_handler_off();
	r->run = (struct run){.method = method, .problem = p, .setting = p->unit / steps, .restart = propagator_restart,
	                      .advance = advances[kind->way],
	                      .between = kind->way == MODAL ? modal_between : propagator_between,
	                      .get = propagator_get, .evaluations = run_evaluations, .close = propagator_close,
	                      .asked = -1};
	r->own = 2 * p->n;
	r->size = r->own + is_pushed(p) + 2 * is_shaken(p);
	r->steps = steps;
	r->h = r->run.setting;
	r->part_length = NAN;
	if (!make(r, kind)) {
		propagator_close(&r->run);
		return NULL;
	}
	r->run.restart(&r->run);
	return &r->run;
}

/* ---- the list ---- */

#define EXPONENTIAL \
	"e^{Ah} once by Pade's approximant of degree 13, scaling and squaring (Higham 2005), loads as states; "
#define ROUNDED "e^{Ah} once in long double, each entry then rounded to double"
#define AS_CODE "printed as C whose entries are constants, zeros left out; compiled as plgen's code is"
#define BY(NAME, SETTINGS) \
	.method = {.name = NAME, .family = PROPAGATOR, .linear_only = true, .settings = SETTINGS, \
	           .open = propagator_open}

static const struct kind kinds[] = {
	{BY("exp(A h), loop", EXPONENTIAL "applied by a double loop, size known at run time")},
	{BY("exp(A h) by GSL, loop",
	    "e^{Ah} once by gsl_linalg_exponential_ss, GSL_PREC_DOUBLE, loads as states; applied by a double "
	    "loop, size "
	    "known at run time"), .exponential = gsl_exponential},
	{BY("exp(A h) rounded, loop", ROUNDED "; applied by a double loop, size known at run time"),
	 .exponential = rounded_exponential},
	{BY("exp(A h), fixed size", EXPONENTIAL "applied by a double loop, unrolled, size 4 known at compile time"),
	 .way = FIXED_SIZE},
	{BY("exp(A h), literals", EXPONENTIAL AS_CODE), .way = LITERALS},
	{BY("exp(A h) rounded, literals", ROUNDED "; " AS_CODE), .way = LITERALS, .exponential = rounded_exponential},
	{BY("exp(A h), CBLAS", EXPONENTIAL "applied by cblas_dgemv of gslcblas, the CBLAS that comes with GSL"),
	 .way = DGEMV},
	{BY("modal superposition",
	    "gsl_eigen_nonsymmv: real modes where damping is classical, else complex; each advanced by its own "
	    "exponential in closed form, loads by the exponential of the mode with them; output by the matrix "
	    "of shapes"),
	 .way = MODAL},
	{BY("exp(A h), loop, float",
	    EXPONENTIAL "each entry rounded to float; applied by a double loop in float, size known at run time"),
	 .single = true},
	{BY("exp(A h) rounded, literals, float", ROUNDED " and to float; " AS_CODE), .way = LITERALS,
	 .exponential = rounded_exponential, .single = true},
};
static const struct kind naive = {
	BY("naive residues",
	   "gsl_poly_complex_solve; every pole taken for a simple one; a matrix of the step in double"),
	.exponential = naive_exponential,
};
const struct method *const residues_naive = &naive.method;
const struct method *const propagator_methods[] = {
	&kinds[0].method, &kinds[1].method, &kinds[2].method, &kinds[3].method, &kinds[4].method, &kinds[5].method,
	&kinds[6].method, &kinds[7].method, &kinds[8].method, &kinds[9].method, NULL,
};
