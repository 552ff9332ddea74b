/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steady motion of gear1 against the balance of nine harmonics, whose equations know nothing of steps or crossings. */
#include "drive.h"
#include "steady_variants.h"
#include "tap.h"

#include <math.h>

enum { HARMONICS = 9, UNKNOWNS = 2 * HARMONICS + 1, SAMPLES = 4096 };
static const double zeta = 0.05, f0 = 0.1, fa = 0.05, tolerance = 1e-4;

struct swing {
	double amplitude, mean;         /* half the way between the ends; the average */
};

static double deadzone(double x)
{
	return x > 1 ? x - 1 : x < -1 ? x + 1 : 0;
}

/* a[0] + sum a[2k-1] cos k phi + a[2k] sin k phi */
static double series(const double *a, double phi)
{
	double x = a[0];
	for (int k = 1; k <= HARMONICS; k++)
		x += a[2 * k - 1] * cos(k * phi) + a[2 * k] * sin(k * phi);
	return x;
}

/* What the harmonics lack: of x'' + 2 zeta x' + deadzone(x) - f0 - fa cos phi, with phi = eta t */
static void lacks(double eta, const double *a, double *r)
{
	for (int i = 0; i < UNKNOWNS; i++)
		r[i] = 0;
	for (int n = 0; n < SAMPLES; n++) {
		const double phi = 2 * acos(-1) * n / SAMPLES, g = deadzone(series(a, phi)) / SAMPLES;
		r[0] += g;
		for (int k = 1; k <= HARMONICS; k++) {
			r[2 * k - 1] += 2 * g * cos(k * phi);
			r[2 * k] += 2 * g * sin(k * phi);
		}
	}
	for (int k = 1; k <= HARMONICS; k++) {
		const double w = k * eta, c = a[2 * k - 1], s = a[2 * k];
		r[2 * k - 1] += -w * w * c + 2 * zeta * w * s;
		r[2 * k] += -w * w * s - 2 * zeta * w * c;
	}
	r[0] -= f0;
	r[1] -= fa;
}

/* A x = b by elimination; b becomes x */
static void solve(double A[UNKNOWNS][UNKNOWNS], double *b)
{
	for (int k = 0; k < UNKNOWNS; k++) {
		int pivot = k;
		for (int i = k; i < UNKNOWNS; i++)
			pivot = fabs(A[i][k]) > fabs(A[pivot][k]) ? i : pivot;
		for (int j = 0; j < UNKNOWNS; j++) {
			const double swap = A[k][j];
			A[k][j] = A[pivot][j];
			A[pivot][j] = swap;
		}
		const double swap = b[k];
		b[k] = b[pivot];
		b[pivot] = swap;
		for (int i = 0; i < UNKNOWNS; i++) {
			const double factor = i == k ? 0 : A[i][k] / A[k][k];
			for (int j = k; j < UNKNOWNS; j++)
				A[i][j] -= factor * A[k][j];
			b[i] -= factor * b[k];
		}
	}
	for (int k = 0; k < UNKNOWNS; k++)
		b[k] /= A[k][k];
}

/* Newton's method; how much the harmonics lack at the end */
static double balance(double eta, double *a)
{
	double r[UNKNOWNS], left = 1;
	for (int round = 0; round < 50 && left > 1e-13; round++) {
		static double J[UNKNOWNS][UNKNOWNS];
		lacks(eta, a, r);
		for (int j = 0; j < UNKNOWNS; j++) {
			double up[UNKNOWNS], down[UNKNOWNS];
			a[j] += 1e-6;
			lacks(eta, a, up);
			a[j] -= 2e-6;
			lacks(eta, a, down);
			a[j] += 1e-6;
			for (int i = 0; i < UNKNOWNS; i++)
				J[i][j] = (up[i] - down[i]) / 2e-6;
		}
		solve(J, r);
		for (int i = 0; i < UNKNOWNS; i++)
			a[i] -= r[i];
		lacks(eta, a, r);
		left = 0;
		for (int i = 0; i < UNKNOWNS; i++)
			left = worse(left, fabs(r[i]));
	}
	return left;
}

static struct swing by_balance(double eta)
{
	double a[UNKNOWNS] = { 1.05, -0.2 }, low = INFINITY, high = -INFINITY;
	const double left = balance(eta, a);
	ok(close_to(left, 0, 1e-12, "what the harmonics lack"), "eta = %g: the balance of %d harmonics is found", eta,
		HARMONICS);
	for (int n = 0; n < SAMPLES; n++) {
		const double x = series(a, 2 * acos(-1) * n / SAMPLES);
		low = fmin(low, x);
		high = worse(high, x);
	}
	return (struct swing){ (high - low) / 2, a[0] };
}

/* After 600 time units what was at the start has decayed by e^-30; samples between steps by NAME_at */
static struct swing by_steps(const struct variant *of, double eta)
{
	const double period = 2 * acos(-1) / eta, h = of->model->h;
	struct run r = run_new(of);
	double low = INFINITY, high = -INFINITY, sum = 0;
	run_until(&r, 600);
	const double begun = of->model->time(r.state);
	for (int n = 0; n < SAMPLES; n++) {
		double y[2];
		const double t = begun + period * n / SAMPLES;
		while (of->model->time(r.state) + h < t)
			run_step(&r, NULL);
		of->model->at(r.state, NULL, t - of->model->time(r.state), y);
		low = fmin(low, y[0]);
		high = worse(high, y[0]);
		sum += y[0];
	}
	run_free(&r);
	return (struct swing){ (high - low) / 2, sum / SAMPLES };
}

static void compare(int tenths, struct swing published)
{
	const double eta = tenths / 10.0;
	const struct swing expected = by_balance(eta);
	for (int step = 0; step < 2; step++) {
		const struct variant *of = variant_of(steady_table, "steady_%d_%d", tenths, step);
		const struct swing found = by_steps(of, eta);
				const bool good = close_to(found.amplitude, expected.amplitude, tolerance,
                                           "eta = %g, h = %g: amplitude", eta, of->model->h);
                ok(close_to(found.mean, expected.mean, tolerance, "eta = %g, h = %g: mean", eta, of->model->h) && good,
                   "eta = %g, h = %g: amplitude %.7f, mean %.7f; by harmonics %.7f, %.7f", eta, of->model->h,
				   found.amplitude, found.mean, expected.amplitude, expected.mean);
				const bool known = close_to(found.amplitude, published.amplitude, 6e-5,
                                            "eta = %g, h = %g: known amplitude", eta, of->model->h);
                ok(close_to(found.mean, published.mean, 3e-4, "eta = %g, h = %g: known mean", eta, of->model->h) &&
					   known,
				   "eta = %g, h = %g: amplitude and mean known before", eta, of->model->h);
		}
}

int main(void)
{
	compare(8, (struct swing){ .3248, .9935 });
	compare(10, (struct swing){ .1870, 1.0733 });
	compare(12, (struct swing){ .1071, 1.0997 });
	return tap_end();
}
