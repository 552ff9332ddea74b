/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rotating beam of Fang, Wang and Guo: its equations by hand, its solution by ARKODE on NAME_rhs (implicit: the
 * orders of BDF that are accurate enough are unstable for its undamped high frequencies), and what the choice of the
 * operator does to the schemes. Two programs: Om = 4, and with FULL_SPEED Om = 15. */
#ifdef FULL_SPEED
#include "beam15_variants.h"
#else
#include "beam_variants.h"
#endif
#include "cantilever.h"
#include "tap.h"
#include "truth.h"

#include <math.h>

enum { SECONDS = 50, PER_SECOND = 10, ROWS = SECONDS * PER_SECOND, N = CANTILEVER_STATES, TIP = CANTILEVER_TIP };

static const double spin_up = 15;           /* [s] */
static const double gone = 1000;            /* a deflection [m] that tells divergence: the beam is 8 m long */
/* a deflection [m] after the spin-up that a plot shows: the true one is below 0.015 */
static const double seen = 0.1;

typedef void right_side(double t, const double *y, double *dydt);

struct truth_of {
	const char *name;
	double Om;
	right_side *rhs;
	double tip[ROWS + 1], stretch[ROWS + 1];
	double least, when;                     /* the minimum of the deflection, by parabolas through rows */
	double late;                            /* largest deflection after the spin-up */
};

/* ---- the equations ---- */

static double random_number(void)
{
	static unsigned seed = 1;
	seed = seed * 1103515245u + 12345u;
	return (double)(seed >> 8) / 8388608 - 1;
}

static void as_written(const struct truth_of *b)
{
	enum { POINTS = 500 };
	double most[N] = {0}, worst = 0;
	bool good = true;
	for (int point = -POINTS; point < POINTS; point++) {        /* the first half only to see sizes */
		const double t = 20 * fabs(random_number());
		double y[N], dydt[N];
		real wide[N], expected[N], dw;
		for (int i = 0; i < N; i++)
			wide[i] = y[i] = random_number();
		const real w = cantilever_speed((real)b->Om, t, &dw);
		cantilever_slopes(w, dw, wide, expected);
		b->rhs(t, y, dydt);
		for (int i = 0; i < N; i++) {
			most[i] = fmax(most[i], fabs((double)expected[i]));
			if (point < 0)
				continue;
			good = close_to(dydt[i], (double)expected[i], 1e-13 * most[i], "%s_rhs, t = %g, entry "
				"%d", b->name, t, i) &&
				good;
			worst = worse(worst, fabs(dydt[i] - (double)expected[i]) / most[i]);
		}
	}
	ok(good, "%s_rhs: the equations by hand, matrices by quadrature (largest difference %.2g)", b->name, worst);
}

/* ---- the solution ---- */

static void slopes_of(const void *truth, double t, const double *y, const double *u, double *dydt)
{
	(void)u;
	((const struct truth_of *)truth)->rhs(t, y, dydt);
}

static void least_of(struct truth_of *b, const double tip[3], double t, double apart)
{
	const double curve = tip[0] - 2 * tip[1] + tip[2], slope = (tip[2] - tip[0]) / 2;
	if (tip[1] > tip[0] || tip[1] > tip[2])
		return;
	const double least = tip[1] - slope * slope / (2 * curve);
	if (least < b->least) {
		b->least = least;
		b->when = t - apart * slope / curve;
	}
}

static void solve(struct truth_of *b)
{
	enum { FINE = 2 };                      /* solved rows per row */
	double scale[N], y[N] = {0}, tip[3] = {0};
	bool good = true;
	for (int i = 0; i < N; i++)
		scale[i] = 0.1;
	struct truth *solver = truth_new(N, slopes_of, b, ARKODE_AFFINE, 1e-8, scale);
	for (int k = 1; k <= ROWS * FINE && good; k++) {
		const double rate = PER_SECOND * FINE;
		good = truth_advance(solver, (k - 1) / rate, k / rate, 0, NULL, y);
		tip[0] = tip[1];
		tip[1] = tip[2];
		tip[2] = y[TIP];
		least_of(b, tip, (k - 1) / rate, 1 / rate);
		if (k / rate > spin_up + 1)
			b->late = worse(b->late, fabs(y[TIP]));
		if (k % FINE == 0) {
			b->tip[k / FINE] = y[TIP];
			b->stretch[k / FINE] = y[CANTILEVER_STRETCH];
		}
	}
	ok(good, "%s: a solution by ARKODE (minimum %.7g m at %.5g s, then up to %.4g m)", b->name, b->least, b->when,
		b->late);
	truth_free(solver);
}

/* Tip deflections as recovered; the axial stretch of the steady turning is rho w^2 L^3/(3 E). */
static void known(const struct truth_of *b, double least, double half_unit, double when, double late)
{
	const double stretch = 2.7667e3 * b->Om * b->Om * 512 / (3 * 6.8952e10);
	double mean = 0;
	for (int row = 20 * PER_SECOND; row < ROWS; row++)
		mean += b->stretch[row] / (ROWS - 20 * PER_SECOND);
	ok(close_to(b->least, least, half_unit, "least deflection"), "%s: least deflection %.7g m, known %g m", b->name,
		b->least, least);
	ok(close_to(b->when, when, 0.005, "when"), "%s: at %.5g s, known %g s", b->name, b->when, when);
	if (late > 0)
		ok(close_to(b->late, late, 0.00005, "later"), "%s: then up to %.4g m, known %g "
			"m", b->name, b->late, late);
	ok(close_to(mean, stretch, 0.002 * stretch, "stretch"), "%s: mean stretch %.5g m, rho w^2 L^3/(3 E) = %.5g m",
		b->name, mean, stretch);
}

/* ---- runs ---- */

struct run {
	double error;                           /* largest of the tip over all rows */
	double seen, gone;                      /* when a plot shows it, when it has left all bounds; infinite: never */
	double early, last;                     /* largest deflections: of 16 s to 26 s, of the last 10 s */
};

static struct run run_of(const struct variant *of, const char *name, const struct truth_of *b)
{
	const pl_model *m = variant_of(of, "%s", name)->model;
	const size_t every = (size_t)lround(1 / (PER_SECOND * m->h));
	struct run r = {.seen = INFINITY, .gone = INFINITY};
	double y[N];
	void *state = calloc(1, m->size);
	m->init(state);
	for (int row = 1; row <= ROWS && !isfinite(r.gone); row++) {
		const double t = (double)row / PER_SECOND;
		m->run(state, every, NULL, NULL);
		m->get(state, y);
		const double tip = fabs(y[TIP]);
		r.error = isfinite(tip) ? fmax(r.error, fabs(y[TIP] - b->tip[row])) : INFINITY;
		if (!(tip < seen) && t > spin_up + 1)
			r.seen = fmin(r.seen, t);
		if (!(tip < gone))
			r.gone = t;
		if (t > spin_up + 1 && t < spin_up + 11)
			r.early = worse(r.early, tip);
		if (t > SECONDS - 10)
			r.last = worse(r.last, tip);
	}
	free(state);
	note("%s, h = %g: largest error %.3g m, seen %.3g s, gone %.3g s, up to %.3g m early, %.3g m at "
		"last", name, m->h,
		r.error, r.seen,
		 r.gone, r.early, r.last);
	return r;
}

static void diverges(const struct run *r, const char *name, double when, double tolerance)
{
	ok(close_to(r->gone, when, tolerance, "%s: gone", name),
		"%s: diverges (seen at %.3g s, gone at %.3g s; known near %g s)", name, r->seen,
	   r->gone, when);
}

/* At most `most` [m] at the end. */
static void bounded(const struct run *r, const char *name, double most)
{
	ok(!isfinite(r->seen) && r->last <= most, "%s: bounded (last up to %.4g m, bound %.4g m)", name, r->last, most);
}

static const char *const schemes[] = {"etd1", "etdrk2", "etdrk4"};

#ifndef FULL_SPEED

static struct truth_of beam4 = {.name = "beam4", .Om = 4, .rhs = beam4_etdrk4_0_rhs};

/* etd1 at Om = 4, by the speed at which the operator is taken: too soft an operator makes it grow, too stiff a one
 * decay. The known times are read from plots. At h = 0.1 the deflection passes 1000 m six seconds before "near 30
 * s". */
static void operators(void)
{
	static const double h[] = {0.1, 0.01, 0.001};
	static const struct { double when[4], tolerance; } divergence[] = {
		{{30, 30, 35, 0}, 6.5}, {{27.5, 28, 35, 0}, 1.5}, {{45, 48, 0, 0}, 1.5}};
	for (int step = 0; step < 3; step++) {
		struct run r[7];
		for (int w = 0; w <= 6; w++) {
			char name[50], what[50];
			snprintf(name, sizeof name, "beam4_A%d_etd1_%d", w, step);
			snprintf(what, sizeof what, "etd1, h = %g, A(%d)", h[step], w);
			r[w] = run_of(beam, name, &beam4);
			if (w < 4 && divergence[step].when[w] > 0)
				diverges(&r[w], what, divergence[step].when[w], divergence[step].tolerance);
			else if (w >= 4)
				bounded(&r[w], what, beam4.late);
		}
		if (step < 2) {
			ok(r[3].last > 2 * r[3].early && r[3].seen > r[2].seen, "etd1, h = %g, A(3): grows (from %.3g "
				"m to %.3g m)",
				h[step], r[3].early, r[3].last);
			ok(r[5].last < 0.95 * r[5].early && r[6].last < 0.95 * r[6].early,
				"etd1, h = %g, A(5) and A(6): decay (%.3g to %.3g m, %.3g to %.3g m)",
			   h[step], r[5].early, r[5].last, r[6].early, r[6].last);
		} else {
			ok(r[2].last > 5 * r[2].early && r[2].last < 0.1,
				"etd1, h = 0.001, A(2): visibly growing (from %.3g m to %.3g "
					"m)", r[2].early, r[2].last);
			ok(r[3].last > 1.003 * beam4.late && r[3].last < 1.1 * beam4.late,
				"etd1, h = 0.001, A(3): only just (%.5g m, true %.5g m)", r[3].last,
			   beam4.late);
		}
	}
}

/* 2,000 s with a stiff operator. */
static void long_runs(void)
{
	for (int step = 0; step < 2; step++) {
		for (int w = 5; w <= 6; w++) {
			const pl_model *m = variant_of(beam, "beam4_A%d_etd1_%d", w, step)->model;
			const int rows = 2000 * PER_SECOND;
			double y[N], last = 0;
			bool good = true;
			void *state = calloc(1, m->size);
			m->init(state);
			for (int row = 1; row <= rows; row++) {
				m->run(state, (size_t)lround(1 / (PER_SECOND * m->h)), NULL, NULL);
				m->get(state, y);
				if (row > (int)(spin_up + 1) * PER_SECOND)
					good = close_to(y[TIP], 0, beam4.late, "A(%d), t = %g: "
						"tip", w, (double)row / PER_SECOND) && good;
				last = row > rows - 100 * PER_SECOND ? fmax(last, fabs(y[TIP])) : 0;
			}
			ok(good && m->status(state) == 0, "etd1, h = %g, A(%d): bounded for 2,000 s (last up to %.3g "
				"m)", m->h, w,
				last);
			free(state);
		}
	}
}

/* Om = 4: the accurate schemes, and a bank. */
static void slow(void)
{
	for (int i = 0; i < 3; i++) {
		char name[50];
		snprintf(name, sizeof name, "beam4_%s_0", schemes[i]);
		const struct run one = run_of(beam, name, &beam4);
		bounded(&one, name, 1.001 * beam4.late);
		snprintf(name, sizeof name, "beam4_bank_%s_0", schemes[i]);
		const struct run bank = run_of(beam, name, &beam4);
		bounded(&bank, name, 1.001 * beam4.late);
		ok(bank.error <= one.error, "Om = 4, %s: the bank (error %.3g m) is at least as accurate as A(4) "
			"(%.3g m)",
			schemes[i], bank.error, one.error);
	}
}

int main(void)
{
	as_written(&beam4);
	solve(&beam4);
	known(&beam4, -0.534406, 1e-6, 6.765, 0.0083);
	operators();
	long_runs();
	slow();
	return tap_end();
}

#else

static struct truth_of full = {.name = "beam15", .Om = 15, .rhs = beam15_bank_etdrk4_0_rhs};

/* Om = 15: with the operator at rest all three diverge, one after the other; with that at full speed none does. */
static void full_speed(void)
{
	static const double when[] = {10, 22, 26};
	struct run at_rest[3], at_speed[3], fine[3], between[3], bank[3];
	for (int i = 0; i < 3; i++) {
		char name[50];
		snprintf(name, sizeof name, "beam15_A0_%s_0", schemes[i]);
		at_rest[i] = run_of(beam15, name, &full);
		diverges(&at_rest[i], name, when[i], 2.5);
		snprintf(name, sizeof name, "beam15_A15_%s_0", schemes[i]);
		at_speed[i] = run_of(beam15, name, &full);
		bounded(&at_speed[i], name, full.late);
		snprintf(name, sizeof name, "beam15_A15_%s_1", schemes[i]);
		fine[i] = run_of(beam15, name, &full);
		bounded(&fine[i], name, 1.001 * full.late);
		snprintf(name, sizeof name, "beam15_A8_%s_0", schemes[i]);
		between[i] = run_of(beam15, name, &full);
		snprintf(name, sizeof name, "beam15_bank_%s_0", schemes[i]);
		bank[i] = run_of(beam15, name, &full);
		bounded(&bank[i], name, full.late);
		const double best = fmin(fmin(at_rest[i].error, at_speed[i].error), between[i].error);
		ok(bank[i].error <= best, "Om = 15, %s: the bank (error %.3g m) is at least as accurate as the best "
			"single "
			"operator (%.3g m)", schemes[i],
		   bank[i].error, best);
	}
	ok(at_rest[0].gone < at_rest[1].gone && at_rest[1].gone < at_rest[2].gone,
		"Om = 15, A(0): etd1 goes first, etdrk4 last");
	ok(at_speed[1].error < at_speed[2].error, "Om = 15, A(15), h = 0.01: etdrk2 (%.3g m) better than etdrk4 (%.3g "
		"m)",
		at_speed[1].error,
	   at_speed[2].error);
	ok(fine[2].error < fine[1].error / 50, "Om = 15, A(15), h = 0.001: etdrk4 (%.3g m) leads etdrk2 (%.3g m)",
		fine[2].error, fine[1].error);
}

/* The figures of the two schemes with the loads left to them; exact loads are better. */
static void known_errors(void)
{
	static const double known_error[2][2] = {{7.5e-4, 8.8e-5}, {1.5e-3, 6.3e-7}};
	for (int i = 0; i < 2; i++) {
		for (int step = 0; step < 2; step++) {
			char name[50];
			snprintf(name, sizeof name, "beam15_left_%s_%d", schemes[i + 1], step);
			const struct run r = run_of(beam15, name, &full);
			ok(close_to(r.error, known_error[i][step], 0.04 * known_error[i][step], "%s", name),
				"%s: loads left to the scheme: error %.3g m, known %.2g m",
			   name, r.error, known_error[i][step]);
			snprintf(name, sizeof name, "beam15_A15_%s_%d", schemes[i + 1], step);
			const struct run exact = run_of(beam15, name, &full);
			ok(exact.error < r.error, "%s: with exact loads %.3g m", name, exact.error);
		}
	}
}

int main(void)
{
	as_written(&full);
	solve(&full);
	known(&full, -1.3736, 0.6e-4, 5.70, 0);
	full_speed();
	known_errors();
	return tap_end();
}

#endif
