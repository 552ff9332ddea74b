/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "jacobian.h"

#include <math.h>
#include <string.h>

#include "equations.h"
#include "quad_beam.h"

void beam_jacobian(double Om, double t, double *Jq, double *Jv)
{
	static double K[BEAM_N * BEAM_N], G[BEAM_N * BEAM_N], DM[BEAM_N * BEAM_N];
	static bool made;
	const double T = 15.0, turn = 2.0 * M_PI / T;
	const double w = t < T ? Om / T * t - Om / (2.0 * M_PI) * sin(turn * t) : Om;
	const double dw = t < T ? Om / T * (1.0 - cos(turn * t)) : 0.0;
	if (!made) {
		const struct quad_beam *beam = quad_beam_matrices();
		for (int i = 0; i < BEAM_N; i++)
			for (int j = 0; j < BEAM_N; j++) {
				__float128 k = 0, g = 0, dm = 0;
				for (int l = 0; l < BEAM_N; l++) {
					k += beam->inverse[i][l] * beam->K[l][j];
					g += beam->inverse[i][l] * beam->G[l][j];
					dm += beam->inverse[i][l] * beam->DM[l][j];
				}
				K[i * BEAM_N + j] = (double)k;
				G[i * BEAM_N + j] = (double)g;
				DM[i * BEAM_N + j] = (double)dm;
			}
		made = true;
	}
	for (int i = 0; i < BEAM_N * BEAM_N; i++) {
		Jq[i] = -K[i] - w * w * DM[i] - dw * G[i];
		Jv[i] = -2.0 * w * G[i];
	}
}

static void beam_of(const struct problem *p, double t, const double *y, double *Jq, double *Jv)
{
	(void)y;
	beam_jacobian(strcmp(p->name, "beam4") == 0 ? 4.0 : 15.0, t, Jq, Jv);
}

static void matrix_of(const struct problem *p, double t, const double *y, double *Jq, double *Jv)
{
	const int n = p->n;
	(void)t, (void)y;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			Jq[i * n + j] = p->A[(n + i) * 2 * n + j];
			Jv[i * n + j] = p->A[(n + i) * 2 * n + n + j];
		}
}

#define CALLABLE(NAME, N) \
static void NAME##_of(const struct problem *p, double t, const double *y, double *Jq, double *Jv) \
{ \
	(void)p; \
	NAME##_jacobian(t, y, Jq, Jv); \
}
EQUATIONS(CALLABLE)

#define ROW(NAME, N) { #NAME, NAME##_of },
static const struct { const char *name; jacobian_function *function; } known[] = {
	EQUATIONS(ROW) { "beam4", beam_of }, { "beam15", beam_of }
};

jacobian_function *jacobian_of(const struct problem *p)
{
	if (p->jacobian || (p->linear && p->A))
		return p->jacobian ? p->jacobian : matrix_of;
	for (size_t i = 0; i < sizeof known / sizeof *known && !p->rhs_of; i++)
		if (strcmp(known[i].name, p->name) == 0)
			return known[i].function;
	return NULL;
}
