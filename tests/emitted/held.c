/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scheme pl on scs: of first order, and growing as its analysis says.
 *
 *     held EXPLAIN.json         from plgen --scheme pl --explain=json
 */
#include "tap.h"

#include "scs_pl_100_pl.h"
#include "scs_pl_200_pl.h"
#include "scs_pl_400_pl.h"
#include "scs_pl_500_pl.h"
#include "scs_pl_1000_pl.h"

#include <gsl/gsl_eigen.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { RUNS = 5 };

static const struct {
	const pl_model *model;
	int per_second;
} runs[RUNS] = {{&scs_pl_100_model, 100}, {&scs_pl_200_model, 200}, {&scs_pl_400_model, 400}, {&scs_pl_500_model, 500},
				{&scs_pl_1000_model, 1000}};

/* at t = 0.6, against the normal modes of scs: displacements over the first one's amplitude, velocities over 17.3
 * times it */
static double error_of(int run)
{
	const double t = 0.6, fast = sqrt(300), p = 0.005 * cos(10 * t), q = 0.005 * cos(fast * t),
		dp = -0.05 * sin(10 * t),
				 dq = -0.005 * fast * sin(fast * t);
	const double exact[4] = {p + q, p - q, dp + dq, dp - dq}, unit[4] = {0.01, 0.01, 0.01 * fast, 0.01 * fast};
	union {
		scs_pl_100 s;
		char bytes[1024];
	} state;
	double y[4], sum = 0;
	runs[run].model->init(&state);
	runs[run].model->run(&state, (size_t)(runs[run].per_second * 6 / 10), NULL, NULL);
	runs[run].model->get(&state, y);
	for (int i = 0; i < 4; i++)
		sum += (y[i] - exact[i]) * (y[i] - exact[i]) / (unit[i] * unit[i]);
	return sqrt(sum);
}

/* of log(error) over log(h), by least squares */
static double slope(void)
{
	double x[RUNS], y[RUNS], mx = 0, my = 0, xx = 0, xy = 0;
	for (int i = 0; i < RUNS; i++) {
		const double error = error_of(i);
		note("h = 1/%d: error %.6g", runs[i].per_second, error);
		x[i] = -log(runs[i].per_second);
		y[i] = log(error);
		mx += x[i] / RUNS;
		my += y[i] / RUNS;
	}
	for (int i = 0; i < RUNS; i++) {
		xx += (x[i] - mx) * (x[i] - mx);
		xy += (x[i] - mx) * (y[i] - my);
	}
	return xy / xx;
}

static double spectral_radius(const double *Phi, size_t n)
{
	gsl_matrix *A = gsl_matrix_alloc(n, n);
	gsl_vector_complex *eigenvalue = gsl_vector_complex_alloc(n);
	gsl_eigen_nonsymm_workspace *work = gsl_eigen_nonsymm_alloc(n);
	double radius = 0;
	for (size_t i = 0; i < n * n; i++)
		gsl_matrix_set(A, i / n, i % n, Phi[i]);
	gsl_eigen_nonsymm(A, eigenvalue, work);
	for (size_t i = 0; i < n; i++)
		radius = fmax(radius,
			hypot(GSL_REAL(gsl_vector_complex_get(eigenvalue, i)),
			GSL_IMAG(gsl_vector_complex_get(eigenvalue, i))));
	gsl_eigen_nonsymm_free(work);
	gsl_vector_complex_free(eigenvalue);
	gsl_matrix_free(A);
	return radius;
}

static double growth_rate_in(const char *path)
{
	static const char key[] = "\"growth_rate\":";
	char line[4096];
	double rate = NAN;
	FILE *f = fopen(path, "r");
	while (f && fgets(line, sizeof line, f)) {
		const char *at = strstr(line, key);
		if (at)
			sscanf(at + sizeof key - 1, "%lf", &rate);
	}
	if (f)
		fclose(f);
	return rate;
}

int main(int argc, char **argv)
{
	const double order = slope(), growth = log(spectral_radius(scs_pl_100_Phi[0], 4)) * 100;
	ok(close_to(order, 1, 0.05, "slope"), "slope of the error at t = 0.6: %.4f", order);
	note("ln(spectral radius)/h = %.6g", growth);
	ok(close_to(growth, 0.249, 0.249e-2, "growth"), "ln(spectral radius of Phi)/h is 0.249 at h = 0.01");
	const double told = argc > 1 ? growth_rate_in(argv[1]) : NAN;
	ok(close_to(told, 0.25, 1e-6, "growth_rate"), "growth_rate of --explain=json is 0.25");
	return tap_end();
}
