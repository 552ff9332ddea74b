/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Residues as one would type them in from the page (Fang, Wang, Dai and Zhang 2020), in double: the poles from GSL's
 * polynomial solver, every pole taken for a simple one, A(s)/B'(s) e^{sh} summed into the matrix of a step. For one or
 * two coordinates. It shows what plgen's exact multiplicities and correct rounding are for; nobody need write it like
 * this. */
#include "charts.h"

#include <complex.h>
#include <gsl/gsl_poly.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 2, DEGREE = 2 * MOST };

struct naive {
	struct run run;
	int n;
	long taken;
	double y[2 * MOST];
	double C[MOST][MOST], K[MOST][MOST];            /* of x'' + C x' + K x = loads */
	double B[DEGREE + 1];                           /* det(s^2 + C s + K), rising powers */
	double Phi[2 * MOST][2 * MOST];
	/* answers to loads 1, cos(w tau), sin(w tau) */
	double held[2 * MOST][MOST], cosine[2 * MOST][MOST], sine[2 * MOST][MOST];
};

static double complex at(const double *polynomial, int degree, double complex s)
{
	double complex sum = 0;
	for (int k = degree; k >= 0; k--)
		sum = sum * s + polynomial[k];
	return sum;
}

static double complex slope_at(const double *polynomial, int degree, double complex s)
{
	double complex sum = 0;
	for (int k = degree; k >= 1; k--)
		sum = sum * s + k * polynomial[k];
	return sum;
}

/* B = P11 P22 - P12 P21, or P11 */
static void characteristic(struct naive *r)
{
	double P[MOST][MOST][3];
	for (int i = 0; i < r->n; i++)
		for (int j = 0; j < r->n; j++) {
			P[i][j][0] = r->K[i][j];
			P[i][j][1] = r->C[i][j];
			P[i][j][2] = i == j;
		}
	if (r->n == 1) {
		memcpy(r->B, P[0][0], sizeof P[0][0]);
		return;
	}
	for (int i = 0; i <= 2; i++)
		for (int j = 0; j <= 2; j++)
			r->B[i + j] += P[0][0][i] * P[1][1][j] - P[0][1][i] * P[1][0][j];
}

/* adj P(s) */
static void adjugate(const struct naive *r, double complex s, double complex adj[MOST][MOST])
{
	if (r->n == 1) {
		adj[0][0] = 1;
		return;
	}
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2; j++)
			adj[i][j] = i == j ? s * s + s * r->C[1 - i][1 - i] + r->K[1 - i][1 - i]
			            : -(s * r->C[i][j] + r->K[i][j]);
}

/* A pole s of B or of a load: X(s) = adj P(s) / ..., whose residue is `weight` adj P(s); velocities are s times as
 * much. */
static void add_response(const struct naive *r, double complex s, double complex weight,
                         double response[2 * MOST][MOST])
{
	double complex adj[MOST][MOST];
	adjugate(r, s, adj);
	for (int i = 0; i < r->n; i++)
		for (int j = 0; j < r->n; j++) {
			response[i][j] += creal(weight * adj[i][j]);
			response[r->n + i][j] += creal(weight * s * adj[i][j]);
		}
}

/* X(s) = adj P(s) ((s + C) x0 + v0) / B(s) */
static void add_free(struct naive *r, double complex s, double complex weight)
{
	double complex adj[MOST][MOST];
	adjugate(r, s, adj);
	for (int i = 0; i < r->n; i++)
		for (int j = 0; j < r->n; j++) {
			double complex x = s * adj[i][j];
			for (int k = 0; k < r->n; k++)
				x += adj[i][k] * r->C[k][j];
			r->Phi[i][j] += creal(weight * x);
			r->Phi[r->n + i][j] += creal(weight * s * x);
			r->Phi[i][r->n + j] += creal(weight * adj[i][j]);
			r->Phi[r->n + i][r->n + j] += creal(weight * s * adj[i][j]);
		}
}

static bool sum_residues(struct naive *r, double h, double w)
{
	const int degree = 2 * r->n;
	double root[2 * DEGREE];
	gsl_poly_complex_workspace *work = gsl_poly_complex_workspace_alloc((size_t)degree + 1);
	const int status = gsl_poly_complex_solve(r->B, (size_t)degree + 1, work, root);
	gsl_poly_complex_workspace_free(work);
	if (status != 0)
		return false;
	for (int k = 0; k < degree; k++) {
		const double complex s = CMPLX(root[2 * k], root[2 * k + 1]),
			weight = cexp(s * h) / slope_at(r->B, degree, s);
		add_free(r, s, weight);
		add_response(r, s, weight / s, r->held);
		add_response(r, s, weight * s / (s * s + w * w), r->cosine);
		add_response(r, s, weight * w / (s * s + w * w), r->sine);
	}
	add_response(r, 0, 1 / r->B[0], r->held);
	for (int sign = 1; sign >= -1; sign -= 2) {
		const double complex s = CMPLX(0, sign * w), weight = cexp(s * h) / at(r->B, degree, s);
		add_response(r, s, weight / 2, r->cosine);
		add_response(r, s, weight * CMPLX(0, -sign) / 2, r->sine);
	}
	return true;
}

/* A load that is not there must not bring in its poles, which may coincide with others and give what is not a
 * number. */
static bool acts(const struct problem *p, const double *b)
{
	for (int i = p->n; i < 2 * p->n; i++)
		if (b[i] != 0)
			return true;
	return false;
}

static void restart(struct run *run)
{
	struct naive *r = (struct naive *)run;
	memcpy(r->y, run->problem->start, 2 * (size_t)r->n * sizeof *r->y);
	r->taken = 0;
}

static void step(struct naive *r)
{
	const struct problem *p = r->run.problem;
	const double phase = p->w * (double)r->taken * r->run.setting, c = cos(phase), s = sin(phase);
	double next[2 * MOST] = { 0 };
	for (int i = 0; i < 2 * r->n; i++) {
		for (int j = 0; j < 2 * r->n; j++)
			next[i] += r->Phi[i][j] * r->y[j];
		for (int j = 0, k = r->n; j < r->n; j++, k++) {
			if (acts(p, p->b0))
				next[i] += r->held[i][j] * p->b0[k];
			if (p->w > 0)
				next[i] += r->cosine[i][j] * (p->b1[k] * c + p->b2[k] * s) +
				           r->sine[i][j] * (p->b2[k] * c - p->b1[k] * s);
		}
	}
	memcpy(r->y, next, sizeof next);
	r->taken++;
}

static bool advance(struct run *run, int units, double *rows)
{
	struct naive *r = (struct naive *)run;
	const int steps = (int)lround(run->problem->unit / run->setting);
	for (int k = 0; k < units; k++) {
		for (int i = 0; i < steps; i++)
			step(r);
		if (rows)
			run_get(run, rows + 2 * k * r->n);
	}
	return true;
}

static void close_run(struct run *run)
{
	free(run);
}

static struct run *open_run(const struct method *method, const struct problem *p, double h)
{
	struct naive *r = p->linear && p->n <= MOST ? calloc(1, sizeof *r) : NULL;
	if (!r)
		return NULL;
	r->n = p->n;
	for (int i = 0; i < p->n; i++)
		for (int j = 0; j < p->n; j++) {
			r->K[i][j] = -p->A[(p->n + i) * 2 * p->n + j];
			r->C[i][j] = -p->A[(p->n + i) * 2 * p->n + p->n + j];
		}
	r->run = (struct run){ .method = method, .problem = p, .setting = h, .restart = restart, .advance = advance,
	                       .get = run_get, .evaluations = run_evaluations, .close = close_run, .now = r->y,
	                       .asked = -1 };
	characteristic(r);
	if (!sum_residues(r, h, p->w)) {
		free(r);
		return NULL;
	}
	restart(&r->run);
	return &r->run;
}

const struct method residues_naive = {
	.name = "naive residues", .family = PROPAGATOR, .linear_only = true,
	.settings = "gsl_poly_complex_solve; every pole taken for a simple one; a matrix of the step in double",
	.open = open_run,
};
