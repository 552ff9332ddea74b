/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "elliptic.h"

#include <gsl/gsl_sf_ellint.h>
#include <gsl/gsl_sf_elljac.h>
#include <math.h>

void pendulum_swing(double x0, double t, double y[2])
{
	const double k = sin(x0 / 2), K = gsl_sf_ellint_Kcomp(k, GSL_PREC_DOUBLE);
	double sn, cn, dn;
	gsl_sf_elljac_e(t + K, k * k, &sn, &cn, &dn);
	y[0] = 2 * asin(k * sn);
	y[1] = 2 * k * cn;
}
