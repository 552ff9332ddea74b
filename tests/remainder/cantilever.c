/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cantilever.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { ELEMENTS = 5, N = CANTILEVER_DOF, NODE = 3, FULL = N + NODE };

/* m, m^2, m^4, kg/m^3, Pa */
static const real length = 8, area = 7.2968e-5L, inertia = 8.2189e-9L, density = 2.7667e3L, young = 6.8952e10L;

/* Gauss-Legendre on [0, 1], exact to degree 9. */
static const real nodes[] = {0.04691007703066800360L, 0.23076534494715845448L, 0.5L, 0.76923465505284154552L,
	0.95308992296933199640L};
static const real weights[] = {0.11846344252809454376L, 0.23931433524968323402L, 0.28444444444444444444L,
	0.23931433524968323402L,
							   0.11846344252809454376L};

/* Products of the inverse mass matrix with the others. */
static struct {
	bool made;
	real K[N][N], G[N][N], D[N][N], fu[N], fw[N];       /* of D - M: D here, minus the unit matrix */
	double K_[N][N], G_[N][N], D_[N][N], fu_[N], fw_[N];
} beam;

struct integrals {
	real M[FULL][FULL], K[FULL][FULL], G[FULL][FULL], D[FULL][FULL], fu[FULL], fw[FULL];
};

/* Shape functions at s = (x - x0)/l: of u in [0], of v in [1], v' in [2], v'' in [3], u' in [4]; by the six dofs of
 * an element. */
static void shapes(real s, real l, real shape[5][6])
{
	const real v[4] = {1 - 3 * s * s + 2 * s * s * s, l * (s - 2 * s * s + s * s * s), 3 * s * s - 2 * s * s * s,
		l * (s * s * s - s * s)};
	const real dv[4] = {(6 * s * s - 6 * s) / l, 1 - 4 * s + 3 * s * s, (6 * s - 6 * s * s) / l, 3 * s * s - 2 * s};
	const real ddv[4] = {(12 * s - 6) / (l * l), (6 * s - 4) / l, (6 - 12 * s) / (l * l), (6 * s - 2) / l};
	memset(shape, 0, 5 * 6 * sizeof(real));
	shape[0][0] = 1 - s;
	shape[0][3] = s;
	shape[4][0] = -1 / l;
	shape[4][3] = 1 / l;
	for (int i = 0; i < 4; i++) {
		const int dof = 1 + i + i / 2;
		shape[1][dof] = v[i];
		shape[2][dof] = dv[i];
		shape[3][dof] = ddv[i];
	}
}

static void integrate(struct integrals *I)
{
	const real l = length / ELEMENTS;
	for (int e = 0; e < ELEMENTS; e++) {
		for (int g = 0; g < 5; g++) {
			const real x = (e + nodes[g]) * l, dx = weights[g] * l, mass = density * area * dx;
			real f[5][6];
			shapes(nodes[g], l, f);
			for (int i = 0; i < 6; i++) {
				const int a = NODE * e + i;
				I->fu[a] += mass * x * f[0][i];
				I->fw[a] += mass * x * f[1][i];
				for (int j = 0; j < 6; j++) {
					const int b = NODE * e + j;
					I->M[a][b] += mass * (f[0][i] * f[0][j] + f[1][i] * f[1][j]);
					I->K[a][b] += young * dx * (area * f[4][i] * f[4][j]
							+ inertia * f[3][i] * f[3][j]);
					I->G[a][b] += mass * (f[1][i] * f[0][j] - f[0][i] * f[1][j]);
					I->D[a][b] += mass / 2 * (length * length - x * x) * f[2][i] * f[2][j];
				}
			}
		}
	}
}

/* B <- M^-1 B, B with n columns, by elimination; M positive definite, destroyed. */
static void solve(real M[N][N], int n, real *B)
{
	for (int k = 0; k < N; k++) {
		for (int i = 0; i < N; i++) {
			const real factor = i == k ? 0 : M[i][k] / M[k][k];
			for (int j = k; j < N; j++)
				M[i][j] -= factor * M[k][j];
			for (int j = 0; j < n; j++)
				B[i * n + j] -= factor * B[k * n + j];
		}
	}
	for (int i = 0; i < N; i++)
		for (int j = 0; j < n; j++)
			B[i * n + j] /= M[i][i];
}

static void make(void)
{
	static struct integrals I;
	real M[N][N], right[N][3 * N + 2];
	integrate(&I);
	for (int i = 0; i < N; i++) {               /* without the clamped root */
		for (int j = 0; j < N; j++) {
			M[i][j] = I.M[i + NODE][j + NODE];
			right[i][j] = I.K[i + NODE][j + NODE];
			right[i][N + j] = I.G[i + NODE][j + NODE];
			right[i][2 * N + j] = I.D[i + NODE][j + NODE];
		}
		right[i][3 * N] = I.fu[i + NODE];
		right[i][3 * N + 1] = I.fw[i + NODE];
	}
	solve(M, 3 * N + 2, &right[0][0]);
	for (int i = 0; i < N; i++) {
		for (int j = 0; j < N; j++) {
			beam.K_[i][j] = (double)(beam.K[i][j] = right[i][j]);
			beam.G_[i][j] = (double)(beam.G[i][j] = right[i][N + j]);
			beam.D_[i][j] = (double)(beam.D[i][j] = right[i][2 * N + j]);
		}
		beam.fu_[i] = (double)(beam.fu[i] = right[i][3 * N]);
		beam.fw_[i] = (double)(beam.fw[i] = right[i][3 * N + 1]);
	}
	beam.made = true;
}

real cantilever_speed(real Om, real t, real *slope)
{
	const real T = 15, turn = 2 * 3.14159265358979323846264338327950288L;
	*slope = t < T ? Om / T * (1 - cosl(turn * t / T)) : 0;
	return t < T ? Om / T * t - Om / turn * sinl(turn * t / T) : Om;
}

void cantilever_slopes(real w, real dw, const real *y, real *dydt)
{
	if (!beam.made)
		make();
	real of_D[N], of_G[N];
	for (int j = 0; j < N; j++) {
		of_D[j] = w * w * y[j];
		of_G[j] = dw * y[j] + 2 * w * y[N + j];
	}
	for (int i = 0; i < N; i++) {
		real a = w * w * beam.fu[i] - dw * beam.fw[i] + w * w * y[i];
		for (int j = 0; j < N; j++)
			a -= beam.K[i][j] * y[j] + beam.D[i][j] * of_D[j] + beam.G[i][j] * of_G[j];
		dydt[i] = y[N + i];
		dydt[N + i] = a;
	}
}

void cantilever_slopes_double(double w, double dw, const double *y, double *dydt)
{
	if (!beam.made)
		make();
	for (int i = 0; i < N; i++) {
		double a = w * w * beam.fu_[i] - dw * beam.fw_[i] + w * w * y[i];
		for (int j = 0; j < N; j++)
			a -= (beam.K_[i][j] + w * w * beam.D_[i][j] + dw * beam.G_[i][j]) * y[j]
					+ 2 * w * beam.G_[i][j] * y[N + j];
		dydt[i] = y[N + i];
		dydt[N + i] = a;
	}
}
