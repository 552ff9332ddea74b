/* SPDX-License-Identifier: GPL-3.0-or-later */
/* 30 s of NAME_rhs, the equations as written, by CVODE (Adams; dense Newton) and ARKODE (explicit, order 8) against the
 * steps.  One problem is one integration: no restarts, a stop time where the results are compared, absolute
 * tolerances that follow each component's size. */
#include "../cvode.h"
#include "models.h"
#include "tap.h"

#include <arkode/arkode_erkstep.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SECONDS = 30, MOST_STEPS = 10000000 };

static const double absolute = 1e-3;    /* tolerance over the relative one, per largest value of the component */
static const double rounding = 2e-13;   /* differences below are the solver's rounding errors, and fall no further */

struct history {
	const struct emitted *of;
	int states, rows, every;            /* compared at k = every, 2 every, .. */
	double *y, *largest;                /* (rows + 1) x states; states */
};

static void *need(size_t size)
{
	void *memory = calloc(size, 1);
	if (!memory)
		abort();
	return memory;
}

static struct history stepped(const struct emitted *of)
{
	const pl_model *model = of->model;
	struct history h = {.of = of, .states = model->states};
	void *state = need(model->size);
	double *y = need((size_t)h.states * sizeof *y);
	h.every = model->h < 0.25 ? (int)lround(0.5 / model->h) : 1;
	h.rows = (int)lround(SECONDS / model->h) / h.every;
	h.y = need((size_t)((h.rows + 1) * h.states) * sizeof *h.y);
	h.largest = need((size_t)h.states * sizeof *h.largest);
	model->init(state);
	for (int k = 0; k <= h.rows * h.every; k++) {
		model->get(state, y);
		for (int i = 0; i < h.states; i++)
			h.largest[i] = fmax(h.largest[i], fabs(y[i]));
		if (k % h.every == 0)
			memcpy(h.y + k / h.every * h.states, y, (size_t)h.states * sizeof *y);
		model->step(state, NULL);
	}
	free(y);
	free(state);
	return h;
}

/* Where the solver's time starts. */
struct equations_from {
	const struct emitted *of;
	double t0;
};

static int slope(realtype t, N_Vector y, N_Vector dydt, void *from)
{
	const struct equations_from *e = from;
	e->of->rhs(e->t0 + t, N_VGetArrayPointer(y), N_VGetArrayPointer(dydt));
	return 0;
}

static N_Vector start_of(const struct history *h, SUNContext context)
{
	N_Vector y = N_VNew_Serial(h->states, context);
	memcpy(N_VGetArrayPointer(y), h->y, (size_t)h->states * sizeof *h->y);
	return y;
}

static N_Vector absolute_tolerance(const struct history *h, double relative, SUNContext context)
{
	N_Vector tolerance = N_VNew_Serial(h->states, context);
	for (int i = 0; i < h->states; i++)
		N_VGetArrayPointer(tolerance)[i] = relative * absolute * h->largest[i];
	return tolerance;
}

static double difference(const struct history *h, int row, N_Vector y)
{
	double worst = 0;
	for (int i = 0; i < h->states; i++)
		worst = worse(worst, fabs(N_VGetArrayPointer(y)[i] - h->y[row * h->states + i]) / h->largest[i]);
	return worst;
}

/* Largest difference over the largest value of the component; NAN where the solver gives up */
static double by_cvode(const struct history *h, double relative)
{
	struct equations_from from = {h->of, 0};
	struct cvode c;
	bool good = cvode_open(&c, CV_ADAMS, h->states, h->y, slope, &from, relative, relative * absolute, h->largest);
	double worst = 0;
	long steps = 0;
	for (int row = 1; row <= h->rows && good; row++) {
		good = cvode_until(&c, row * h->every * h->of->model->h);
		worst = worse(worst, difference(h, row, c.y));
	}
	CVodeGetNumSteps(c.memory, &steps);
	note("%s: CVODE at %.0e, %ld steps: largest difference %.3g", h->of->model->name, relative, steps, worst);
	cvode_close(&c);
	return good ? worst : NAN;
}

/* ARKODE adds its steps up in double.  Over 30 s that rounding is a phase error (2e-10 in scs_weak), so each stretch
 * between two compared rows has its own time from 0, and starts with the last step size. */
static double by_arkode(const struct history *h, double relative)
{
	struct equations_from from = {h->of, 0};
	SUNContext context;
	SUNContext_Create(NULL, &context);
	N_Vector y = start_of(h, context), tolerance = absolute_tolerance(h, relative, context);
	void *arkode = ERKStepCreate(slope, 0, y, context);
	bool good = ERKStepSetUserData(arkode, &from) == ARK_SUCCESS &&
		ERKStepSVtolerances(arkode, relative, tolerance) == ARK_SUCCESS &&
				ERKStepSetTableNum(arkode, ARKODE_FEHLBERG_13_7_8) == ARK_SUCCESS &&
					ERKStepSetMaxNumSteps(arkode, MOST_STEPS) == ARK_SUCCESS;
	const double stretch = h->every * h->of->model->h;
	double worst = 0, t = 0;
	long steps = 0;
	for (int row = 1; row <= h->rows && good; row++) {
		double size = 0;
		from.t0 = (row - 1) * stretch;
		good = row == 1 ||
			(ERKStepGetCurrentStep(arkode, &size) == ARK_SUCCESS &&
					ERKStepReset(arkode, 0, y) == ARK_SUCCESS &&
							ERKStepSetInitStep(arkode, size) == ARK_SUCCESS);
		good = good && ERKStepSetStopTime(arkode, stretch) == ARK_SUCCESS &&
			ERKStepEvolve(arkode, stretch, y, &t, ARK_NORMAL) >= 0;
		worst = worse(worst, difference(h, row, y));
	}
	ERKStepGetNumSteps(arkode, &steps);
	note("%s: ARKODE at %.0e, %ld steps: largest difference %.3g", h->of->model->name, relative, steps, worst);
	ERKStepFree(&arkode);
	N_VDestroy(y);
	N_VDestroy(tolerance);
	SUNContext_Free(&context);
	return good ? worst : NAN;
}

static bool falls(double before, double after)
{
	return after < before / 5 || after < rounding;
}

static void judge(const struct emitted *of)
{
	struct history h = stepped(of);
	const char *name = of->model->name;
	const double loose = by_cvode(&h, 1e-8), middle = by_cvode(&h, 1e-10), tight = by_cvode(&h, 1e-12);
	ok(close_to(middle, 0, 1e-7, "%s, CVODE", name), "%s: CVODE at rtol 1e-10 agrees within 1e-7 over 30 s", name);
	ok(falls(loose, middle) && falls(middle, tight),
		"%s: the difference to CVODE falls with its tolerance: %.3g, %.3g, %.3g", name,
	   loose, middle, tight);
	const double coarse = by_arkode(&h, 1e-7), fine = by_arkode(&h, 1e-10), finest = by_arkode(&h, 1e-13);
	ok(close_to(finest, 0, 1e-10, "%s, ARKODE", name),
		"%s: ARKODE of order 8 at rtol 1e-13 agrees within 1e-10 over 30 s", name);
	ok(falls(coarse, fine) && falls(fine, finest),
		"%s: the difference to ARKODE falls with its tolerance: %.3g, %.3g, %.3g", name,
	   coarse, fine, finest);
	free(h.y);
	free(h.largest);
}

int main(void)
{
	for (int i = 0; i < MODELS; i++)
		judge(&emitted[i]);
	return tap_end();
}
