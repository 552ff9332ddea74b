/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives of a subject's outputs that NAME_step_d makes, against differences of runs of the same scheme in double,
 * with other values of k and from other values of a. Backwards they are the same sums. */
#include "driving.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 2, CALLS = 5 };

static double J[STEPS + 1][MOST * COLUMNS], difference[STEPS + 1][MOST];

static size_t bytes_of_derivatives(void)
{
	return of->varied ? of->varied->size : of->variedf->size;
}

static void varied_out(const void *s, const void *ds, double *values)
{
	float narrowed[MOST * COLUMNS];
	if (of->varied) {
		of->varied->out(s, ds, values);
		return;
	}
	of->variedf->out(s, ds, narrowed);
	widen(narrowed, values, outputs * COLUMNS);
}

static void varied_init(void *s, void *ds)
{
	if (of->varied)
		of->varied->init(s, ds);
	else
		of->variedf->init(s, ds);
}

/* The run once more, with its derivatives: that of `row` to the last bit */
static void run_derivatives(void *s, void *ds)
{
	double u[MOST], out[MOST];
	float narrowed[MOST];
	varied_init(s, ds);
	for (int k = 0; k < STEPS; k++) {
		samples(k, u);
		narrow(u, narrowed, inputs);
		if (of->varied)
			of->varied->step(s, ds, u, NULL);
		else
			of->variedf->step(s, ds, narrowed, NULL);
		model_out(s, out);
		if (memcmp(out, row[k + 1].out, sizeof *out * (size_t)outputs) != 0)
			complain("a step with derivatives is another step, t = %.17g", row[k + 1].t);
		varied_out(s, ds, J[k + 1]);
	}
	const unsigned status = of->varied ? of->varied->status(ds) : of->variedf->status(ds);
	if (status)
		complain("derivatives have the status %u", status);
}

static void judge_column(int column, const char *name, double tolerance)
{
	double largest = 0;
	bool good = true;
	for (int k = 1; k <= STEPS; k++)
		for (int i = 0; i < outputs; i++)
			largest = fmax(largest, fabs(difference[k][i]));
	for (int k = 1; k <= STEPS && good; k++)
		for (int i = 0; i < outputs; i++) {
			char which[100];
			snprintf(which, sizeof which, "d%s/d%s", output_name(i), name);
			good = near(J[k][i * COLUMNS + column], difference[k][i], tolerance * largest,
				    "a derivative against differences", row[k].t, which) && good;
		}
}

/* Adds `weight` times the outputs of a model, from a state in which a is more by so much */
static void add_run(const pl_model *model, double more, double weight)
{
	void *const s = malloc(model->size);
	double u[MOST], out[MOST], y[MOST];
	if (!s)
		exit(3);
	model->init(s);
	if (more != 0) {
		model->get(s, y);
		y[place_of("a")] += more;
		model->set(s, 0, y);
	}
	for (int k = 0; k < STEPS; k++) {
		samples(k, u);
		model->step(s, inputs ? u : NULL);
		model->out(s, out);
		for (int i = 0; i < outputs; i++)
			difference[k + 1][i] += weight * out[i];
	}
	free(s);
}

static void judge_columns(void)
{
	const double apart = 0x1p-13, tolerance = in_float ? 3e-3 : 1e-5;
	memset(difference, 0, sizeof difference);
	add_run(of->beside[0], 0, -1 / (12.0012 - 11.9988));
	add_run(of->beside[2], 0, 1 / (12.0012 - 11.9988));
	judge_column(0, "k", tolerance);
	memset(difference, 0, sizeof difference);
	add_run(of->beside[1], apart, 0.5 / apart);
	add_run(of->beside[1], -apart, -0.5 / apart);
	judge_column(1, "a", tolerance);
}

/* The sum of all outputs behind the last step, by k and by a: backwards */
static void judge_gradient(void *s, void *ds)
{
	double lam[MOST] = { 0 }, pb[COLUMNS] = { 0 }, w[STEPS * MOST] = { 0 }, u[STEPS * MOST], most = 0;
	float lamf[MOST] = { 0 }, pbf[COLUMNS] = { 0 }, wf[STEPS * MOST] = { 0 }, uf[STEPS * MOST];
	void *const kept = malloc(CALLS * bytes());
	if (!kept)
		exit(3);
	for (int k = 0; k < STEPS; k++)
		samples(k, u + k * inputs);
	narrow(u, uf, STEPS * inputs);
	for (int i = 0; i < outputs; i++)
		w[(STEPS - 1) * outputs + i] = wf[(STEPS - 1) * outputs + i] = 1;
	varied_init(s, ds);
	if (of->varied) {
		of->varied->gradient(s, ds, STEPS, inputs ? u : NULL, w, lam, pb, NULL, kept, CALLS);
	} else {
		of->variedf->gradient(s, ds, STEPS, inputs ? uf : NULL, wf, lamf, pbf, NULL, kept, CALLS);
		widen(pbf, pb, COLUMNS);
	}
	for (int column = 0; column < COLUMNS; column++) {
		double expected = 0;
		for (int i = 0; i < outputs; i++) {
			expected += J[STEPS][i * COLUMNS + column];
			most = fmax(most, fabs(J[STEPS][i * COLUMNS + column]));
		}
		near(pb[column], expected, (in_float ? 1e-3 : 1e-9) * most, "a gradient against derivatives forwards",
		     row[STEPS].t, column ? "a" : "k");
	}
	free(kept);
}

void judge_derivatives(void)
{
	if (!of->varied && !of->variedf)
		return;
	void *const s = fresh(), *const ds = malloc(bytes_of_derivatives());
	if (!ds)
		exit(3);
	run_derivatives(s, ds);
	judge_columns();
	judge_gradient(s, ds);
	free(s), free(ds);
}
