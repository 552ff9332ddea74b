/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stiff oscillator of van der Pol (mu = 100) from (2, 0), with the Jacobian at the start as operator: the etd
 * family stays stable at every step, the precise-integration schemes fail where their explicit predictor does; the
 * implicit trapezoid beside them. 400 s; but etdrk4 at 0.1 and 0.05 only to the first jump, 80 s.  Behind it x is no
 * longer near the start, the run becomes a matter of chance, and of forty starts within 4e-8 of (2, 0) sixteen to
 * nineteen leave all bounds between 150 s and 1000 s. */
#include "stiff_variants.h"
#include "tap.h"

#include <math.h>

enum { SECONDS = 400, BEFORE_JUMPS = 80 };

static const double mu = 100;
static const double true_period = 162.837;  /* by CVODE (BDF) at rtol 1e-10 */
static const double bound = 2.1;            /* the true amplitude is 2.0013 */

struct run {
	double most;                            /* largest |x|; infinite once it is not finite */
	double ended;                           /* when the numbers ended, or SECONDS */
	double period;                          /* between the last two upward zeros, 0 without two */
	double up[2];
	int ups;
};

static void see(struct run *r, double t, double h, double before, double x)
{
	r->most = isfinite(x) ? fmax(r->most, fabs(x)) : INFINITY;
	r->ended = isfinite(x) ? t : r->ended;
	if (before < 0 && x >= 0) {
		r->up[0] = r->up[1];
		r->up[1] = t - h * x / (x - before);
		if (++r->ups > 1)
			r->period = r->up[1] - r->up[0];
	}
}

static struct run emitted(const pl_model *m, double seconds, int *status)
{
	struct run r = {0};
	const long steps = lround(seconds / m->h);
	double y[2];
	void *state = calloc(1, m->size);
	m->init(state);
	m->get(state, y);
	for (long k = 1; k <= steps && isfinite(r.most); k++) {
		const double before = y[0];
		m->step(state, NULL);
		m->get(state, y);
		see(&r, (double)k * m->h, m->h, before, isfinite(y[1]) ? y[0] : y[1]);
	}
	*status = m->status ? m->status(state) : -1;
	free(state);
	return r;
}

/* One step of the implicit trapezoid, by Newton's method. */
static void trapezoid(double h, double *x, double *v)
{
	const double x0 = *x, v0 = *v, a0 = mu * (1 - x0 * x0) * v0 - x0;
	for (int i = 0; i < 30; i++) {
		const double F = *x - x0 - h / 2 * (v0 + *v), G = *v - v0 - h / 2 * (a0 + mu * (1 - *x * *x) * *v - *x);
		const double c = -h / 2 * (-2 * mu * *x * *v - 1), d = 1 - h / 2 * mu * (1 - *x * *x),
				det = d + h / 2 * c;
		const double dx = (F * d + h / 2 * G) / det, dv = (G - F * c) / det;
		*x -= dx;
		*v -= dv;
		if (fabs(dx) + fabs(dv) < 1e-14)
			break;
	}
}

static struct run by_trapezoid(double h)
{
	struct run r = {0};
	double x = 2, v = 0;
	for (long k = 1; k <= lround(SECONDS / h); k++) {
		const double before = x;
		trapezoid(h, &x, &v);
		see(&r, (double)k * h, h, before, x);
	}
	return r;
}

static struct run of(const char *scheme, int variant, double seconds, int *status)
{
	const pl_model *m = variant_of(stiff, "vanderpol_stiff_%s_%d", scheme, variant)->model;
	const struct run r = emitted(m, seconds, status);
	note("%s, h = %g: largest |x| %.6g, period %.5g, to %.5g s, status %d", scheme, m->h, r.most, r.period, r.ended,
		*status);
	return r;
}

static void stable(const char *scheme, int variant, double seconds)
{
	int status;
	const struct run r = of(scheme, variant, seconds, &status);
	const bool good = close_to(r.most, 2, bound - 2, "%s: largest |x|", scheme) &&
		close_to(r.ended, seconds, 1e-6, "%s: end", scheme);
	ok(good && status == 0, "%s, variant %d: bounded over %g s", scheme, variant, seconds);
}

static void failing(const char *scheme, int variant)
{
	int status;
	const struct run r = of(scheme, variant, SECONDS, &status);
	ok(!isfinite(r.most) && r.ended < 1, "%s, variant %d: fails at once (at %.3g s)", scheme, variant, r.ended);
	ok(status == PL_NOT_FINITE, "%s, variant %d: the status says so (%d)", scheme, variant, status);
}

static void accurate(const char *scheme, int variant, double tolerance)
{
	int status;
	const struct run r = of(scheme, variant, SECONDS, &status);
	ok(close_to(r.period, true_period, tolerance, "%s: period", scheme),
		"%s, h = 0.001: the period of the oscillation, %.6g s", scheme, r.period);
}

int main(void)
{
	static const char *const etd[] = {"etd1", "etdrk2", "etdrk4"}, *const precise[] = {"nc2", "nc3", "dq4", "bm3"};
	static const double etd_period[] = {0.6, 2, 0.02};      /* how far off it is at h = 0.001 */
	for (int i = 0; i < 3; i++) {
		for (int variant = 0; variant < 4; variant++)
			stable(etd[i], variant, i == 2 && variant < 2 ? BEFORE_JUMPS : SECONDS);
		accurate(etd[i], 4, etd_period[i]);
	}
	for (int i = 0; i < 4; i++) {
		for (int variant = 0; variant < 2; variant++)
			failing(precise[i], variant);
		for (int variant = 2; variant < 4; variant++)
			stable(precise[i], variant, SECONDS);
		accurate(precise[i], 4, 0.02);
	}
	static const double h[] = {0.1, 0.05, 0.02, 0.01, 0.001};
	struct run r = {0};
	for (int i = 0; i < 5; i++) {
		r = by_trapezoid(h[i]);
		note("implicit trapezoid, h = %g: largest |x| %.6g, period %.5g", h[i], r.most, r.period);
		ok(isfinite(r.most), "implicit trapezoid, h = %g: stable, as it is at every step", h[i]);
	}
	ok(close_to(r.period, true_period, 0.3, "trapezoid: period"),
		"implicit trapezoid, h = 0.001: the period of the oscillation");
	return tap_end();
}
