/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * integrators [--quick] OUTDIR
 *
 * The time integrators of structural dynamics on x'' + w^2 x = 0: spectral radius, period elongation and amplitude
 * decay over h/T (integrators.csv); their orders from rest under a smooth load, under one that sets in at once, and
 * from a displaced start (integrators_orders.csv); and what their authors and others state of them beside what is
 * measured (integrators_check.csv), where each eigenvalue is found twice: from one step asked at every state, and from
 * the positions of a long run. Period elongation and amplitude decay of other methods too, as the textbooks draw them
 * (Bathe, Finite Element Procedures, figure 9.3; Hughes, The Finite Element Method, section 9.3): quality.csv,
 * quality_check.csv. Exit status 1 where one is off.
 */
#include "amplification.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct method *need(const char *name)
{
	const struct method *m = method_find(name);
	if (!m)
		leave(name, "no method");
	return m;
}

/* ---- one oscillator ---- */

/* l = e^{(-xi + i) phi}, the eigenvalue that stands for the oscillation: the period seen is 2 pi h/phi, the amplitude
 * falls by 1 - e^{-2 pi xi} in each of them, and xi is the algorithmic damping ratio. NAN: no oscillation */
struct quality { double rho, elongation, decay, damping; };

static struct quality quality_of(double rho, double complex l, double wh)
{
	const double phi = carg(l), xi = -log(cabs(l)) / phi;
	if (!(cimag(l) > 0))
		return (struct quality){rho, NAN, NAN, NAN};
	return (struct quality){rho, wh / phi - 1 + 0.0, 0.0 - expm1(-2 * M_PI * xi), xi + 0.0};
}

static struct quality asked_of_subject(const struct subject *s, double wh)
{
	double complex eigenvalue[MOST_EIGENVALUES];
	const int count = oscillator_eigenvalues(s, wh, eigenvalue);
	return quality_of(largest(count, eigenvalue), oscillation(count, eigenvalue, wh), wh);
}

/* NULL: exact, by hand */
static struct quality asked(const struct method *method, double wh)
{
	return asked_of_subject(&(struct subject){.method = method, .scheme = "flow"}, wh);
}

/* The other road: once what else there is has died away, positions keep x+ = s x - p x-, whose roots are the pair. The
 * weights s and p of least squares over a period. */
static struct quality run_long(const struct method *method, double wh)
{
	enum { STEPS = 400, LAST = 60 };
	struct free_motion m;
	double rows[2 * STEPS], xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
	free_oscillator(&m, 1, 0);
	m.problem.unit = wh;
	m.problem.units = STEPS;
	m.start[0] = 1;
	struct run *run = method->open(method, &m.problem, wh);
	run->advance(run, STEPS, rows);
	run->close(run);
	for (int k = STEPS - LAST; k < STEPS; k++) {
		const double z = rows[2 * k], x = rows[2 * k - 2], y = rows[2 * k - 4];
		xx += x * x, xy += x * y, yy += y * y, xz += x * z, yz += y * z;
	}
	const double det = xx * yy - xy * xy, s = (xz * yy - yz * xy) / det, p = -(yz * xx - xz * xy) / det;
	const double complex l = s / 2 + I * sqrt(p - s * s / 4);
	return quality_of(cabs(l), l, wh);
}

/* ---- the curves ---- */

static void put(FILE *csv, double x)
{
	if (isfinite(x))
		fprintf(csv, ",%.6g", fabs(x) < 1e-11 ? 0.0 : x);
	else
		fputs(",none", csv);              /* no oscillation */
}

static void chart(const char *folder, int points)
{
	static const char *const names[] = {"central difference", "Newmark", "generalized-alpha", "HHT-alpha", "Bathe",
	                                    "rho-Bathe 0.5", "CR", "KR-alpha 0.5", "exact"};
	FILE *csv = table_open(folder, "integrators.csv",
	                       "method,h_over_T,spectral_radius,period_elongation_percent,"
	                       "amplitude_decay_percent_per_period");
	for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
		const struct method *method = strcmp(names[k], "exact") == 0 ? NULL : need(names[k]);
		for (int i = 0; i < points; i++) {
			const double share = 0.01 * pow(1e4, (double)i / (points - 1));
			const struct quality q = asked(method, 2 * M_PI * share);
			fprintf(csv, "%s,%.6g", names[k], share);
			put(csv, q.rho);
			put(csv, share <= 0.4 ? 100 * q.elongation : NAN);
			put(csv, share <= 0.4 ? 100 * q.decay : NAN);
			putc('\n', csv);
		}
	}
	table_close(csv, "integrators.csv");
}

/* ---- two masses under a step load ---- */

/* Bathe and Wilson's example: diag(2, 1) x'' + [6 -2; -2 4] x = (0, 10), from rest; Bathe, Finite Element Procedures,
 * example 9.1, h = 0.28 */
static void two_masses_slope(const void *of, double t, const double y[], double dydt[])
{
	(void)of, (void)t;
	dydt[0] = y[2];
	dydt[1] = y[3];
	dydt[2] = -3 * y[0] + y[1];
	dydt[3] = 2 * y[0] - 4 * y[1] + 10;
}

static void two_masses(const struct method *method, double x[2])
{
	double A[] = {0, 0, 1, 0, 0, 0, 0, 1, -3, 1, 0, 0, 2, -4, 0, 0}, b0[] = {0, 0, 0, 10}, none[4] = {0}, y[4];
	const double start[4] = {0};
	const struct problem p = {.name = "two masses", .n = 2, .rhs_of = two_masses_slope, .of = A, .start = start,
	                          .unit = 0.28, .units = 12, .linear = true, .A = A, .b0 = b0, .b1 = none, .b2 = none};
	struct run *run = method->open(method, &p, p.unit);
	run->advance(run, p.units, NULL);
	run->get(run, y);
	run->close(run);
	x[0] = y[0];
	x[1] = y[1];
}

/* ---- orders ---- */

enum onset { SMOOTH, AT_ONCE, DISPLACED };
static const char *const onsets[] = {"from rest, load sin 2t", "from rest, load 1 from t = 0 on",
									 "from x = 1, no load"};

static void loaded_slope(const void *of, double t, const double y[], double dydt[])
{
	const enum onset onset = *(const enum onset *)of;
	dydt[0] = y[1];
	dydt[1] = -y[0] - 0.1 * y[1] + (onset == SMOOTH ? sin(2 * t) : onset == AT_ONCE ? 1.0 : 0.0);
}

static void end_of(const struct method *method, enum onset onset, int parts, double y[2])
{
	double A[] = {0, 1, -1, -0.1}, none[2] = {0};
	const double start[2] = {onset == DISPLACED, 0};
	const struct problem p = {.name = "loaded", .n = 1, .rhs_of = loaded_slope, .of = &onset, .start = start,
	                          .unit = 1, .units = 5, .linear = true, .w = 2, .A = A, .b0 = none, .b1 = none,
	                          .b2 = none};
	struct run *run = method->open(method, &p, p.unit / parts);
	run->advance(run, p.units, NULL);
	run->get(run, y);
	run->close(run);
}

static void error_of_order(const struct method *method, enum onset onset, int parts, double error[2])
{
	double y[2], truth[2];
	end_of(method, onset, parts, y);
	end_of(need("RK4"), onset, 1000, truth);
	for (int i = 0; i < 2; i++)
		error[i] = fabs(y[i] - truth[i]);
}

/* With steps of 0.02 and 0.01 s. The velocities of CR and KR-alpha are sums of the accelerations before, so they lag by
 * half a step: they lose their second order where motion sets in smoothly, and coordinates do where it does not. */
static void put_order(FILE *csv, struct checks *c, const char *name, enum onset onset)
{
	const bool lags = strcmp(name, "CR") == 0 || strncmp(name, "KR", 2) == 0;
	double coarse[2], fine[2];
	error_of_order(need(name), onset, 50, coarse);
	error_of_order(need(name), onset, 100, fine);
	const double x = log2(coarse[0] / fine[0]), v = log2(coarse[1] / fine[1]);
	fprintf(csv, "%s,\"%s\",%.4g,%.4g,%.3g,%.3g\n", name, onsets[onset], coarse[0], fine[0], x, v);
	check(c, lags && onset != SMOOTH ? 1 : 2, x, 0.08, "%s: order of x %s", name, onsets[onset]);
	check(c, lags && onset == SMOOTH ? 1 : 2, v, 0.08, "%s: order of v %s", name, onsets[onset]);
}

static void orders(const char *folder, struct checks *c)
{
	static const char *const names[] = {"central difference", "Newmark", "generalized-alpha", "HHT-alpha", "Bathe",
	                                    "rho-Bathe 0.5", "CR", "KR-alpha 0.5"};
	FILE *csv = table_open(folder, "integrators_orders.csv",
	                       "method,start_and_load,error_of_x_h_0.02,error_of_x_h_0.01,order_of_x,order_of_v");
	for (size_t k = 0; k < sizeof names / sizeof *names; k++)
		for (enum onset onset = SMOOTH; onset <= DISPLACED; onset++)
			put_order(csv, c, names[k], onset);
	table_close(csv, "integrators_orders.csv");
}

/* ---- what is known ---- */

/* Spectral radius at w h = 1, pi, 10 and without end; period elongation at h/T = 0.1 and 0.05 and amplitude decay at
 * 0.1, in percent; x of the two masses after 12 steps. From independent programs of the formulas, of which those of
 * Newmark and Bathe agree with the values by which ONSAS tests its own. */
static const struct known {
	const char *name;
	double rho[4], elongation[2], decay, x[2];              /* NAN: none stated */
} known[] = {
	{"Newmark", {1, 1, 1, 1}, {3.2075, 0.8171}, 0, {1.39678, 2.31292}},
	{"HHT-alpha", {0.993847, 0.921404, 0.837803, 0.818182}, {3.9506, 1.0202}, 1.3146, {1.44223, 2.29191}},
	{"generalized-alpha", {0.999475, 0.985954, 0.929792, 0.8}, {3.3828, 0.8623}, 0.0988, {1.40856, 2.30565}},
	{"generalized-alpha 0.5", {0.989313, 0.868234, 0.682528, 0.5}, {4.6715, 1.2157}, 2.3471, {NAN, NAN}},
	{"Bathe", {0.997054, 0.894680, 0.457287, 0}, {1.6179, 0.4095}, 0.5131, {1.27943, 2.39755}},
	{"rho-Bathe 0", {0.996874, 0.888701, 0.444858, 0}, {1.5714, 0.3975}, 0.5438, {NAN, NAN}},
	{"rho-Bathe 0.5", {0.998316, 0.933274, 0.649747, 0.5}, {1.1489, 0.2900}, 0.2878, {NAN, NAN}},
	{"rho-Bathe 1", {1, 1, 1, 1}, {0.8171, 0.2053}, 0, {NAN, NAN}},
	{"CR", {1, 1, 1, 1}, {3.2075, 0.8171}, 0, {0.89148, 2.33381}},
	{"KR-alpha 1", {1, 1, 1, 1}, {3.2075, 0.8171}, 0, {0.89148, 2.33381}},
	{"KR-alpha 0.5", {0.989313, 0.868234, 0.682528, 0.5}, {4.6715, 1.2157}, 2.3471, {0.71257, 2.23177}},
	{"KR-alpha 0", {0.906563, 0.545757, 0.242536, 0}, {12.3206, NAN}, 29.21, {0.82499, 1.96512}},
};

/* A tolerance of check: half a unit of the last digit that is stated, and a little for ours */
static double digits(double stated, double unit)
{
	return stated == 0 ? 1e-5 : 0.6 * unit / fabs(stated);
}

static void check_known(struct checks *c, const struct known *k)
{
	static const double wh[] = {1, M_PI, 10, 1e6};          /* roots that meet at infinity split by rounding */
	const struct method *m = need(k->name);
	for (int i = 0; i < 4; i++)
		check(c, k->rho[i], asked(m, wh[i]).rho, i == 3 ? 1e-3 : digits(k->rho[i], 1e-6),
		      "%s: spectral radius at w h = %.4g", k->name, wh[i]);
	for (int i = 0; i < 2; i++)
		if (!isnan(k->elongation[i]))
			check(c, k->elongation[i], 100 * asked(m, 2 * M_PI * (i ? 0.05 : 0.1)).elongation,
			      digits(k->elongation[i], 1e-4), "%s: period elongation [%%] at h/T = %g", k->name,
			      i ? 0.05 : 0.1);
	check(c, k->decay, 100 * asked(m, 2 * M_PI * 0.1).decay, digits(k->decay, k->decay > 10 ? 1e-2 : 1e-4),
	      "%s: amplitude decay [%%] in a period at h/T = 0.1", k->name);
	if (!isnan(k->x[0])) {
		double x[2];
		two_masses(m, x);
		for (int i = 0; i < 2; i++)
			check(c, k->x[i], x[i], digits(k->x[i], 1e-5), "%s: x%d of two masses after 12 steps of 0.28 s",
			      k->name, i + 1);
	}
}

/* KR-alpha 1 and 0 have a further eigenvalue of modulus 1, or lose the oscillation, before the run is long */
static void check_roads(struct checks *c, const char *name)
{
	const struct method *m = need(name);
	for (int i = 0; i < 2; i++) {
		const double wh = i ? 0.9 : 0.3;
		const struct quality one = asked(m, wh), two = run_long(m, wh);
		check(c, 100 * one.elongation, 100 * two.elongation, 1e-7,
		      "%s: period elongation [%%] at w h = %g, by a step's eigenvalues and by a run of 400", name, wh);
		check(c, one.decay < 1e-11 ? 0 : 100 * one.decay, 100 * two.decay, 1e-7,
		      "%s: amplitude decay [%%] at w h = %g, by a step's eigenvalues and by a run of 400", name, wh);
	}
}

/* ---- the quality of other methods ---- */

static void chart_quality(FILE *csv, int points)
{
	struct subject s;
	for (int k = 0; subject_at(k, &s); k++) {
		for (int i = 0; i < points; i++) {
			const double share = 0.005 * pow(100, (double)i / (points - 1));
			const struct quality q = asked_of_subject(&s, 2 * M_PI * share);
			if (!isnan(q.damping))
				fprintf(csv, "%s,%.6g,%.6g,%.6g,%.6g\n", s.name, share, 100 * q.elongation,
					100 * q.decay, q.damping);
			else
				fprintf(csv, "%s,%.6g,none,none,none\n", s.name, share);
		}
	}
}

/* What the literature has for small steps: the first power of w h with its factor */
static void check_small(struct checks *c, const char *name, double wh, double elongation, double damping,
						double tolerance)
{
	const struct subject s = subject_named(name, 0);
	const struct quality q = asked_of_subject(&s, wh);
	check(c, elongation, q.elongation, elongation == 0 ? 1e-13 : tolerance,
	      "%s: period elongation at w h = %g, first term for small steps", name, wh);
	check(c, damping, q.damping, damping == 0 ? 1e-13 : tolerance,
	      "%s: algorithmic damping ratio at w h = %g, first term", name, wh);
}

static void check_damping(struct checks *c, const char *name, double wh, double damping)
{
	const struct subject s = subject_named(name, 0);
	check(c, damping, asked_of_subject(&s, wh).damping, 1e-2,
	      "%s: algorithmic damping ratio at w h = %g, first term", name, wh);
}

/* The methods of all fields, without damping */
static int quality(const char *folder, int points)
{
	struct checks c;
	FILE *csv = table_open(folder, "quality.csv",
	                       "method,h_over_T,period_elongation_percent,amplitude_decay_percent_per_period,"
	                       "algorithmic_damping_ratio");
	say_progress("quality: period elongation and amplitude decay");
	chart_quality(csv, points);
	table_close(csv, "quality.csv");
	checks_open(&c, folder, "quality_check.csv");
	const double wh = 0.05, q = wh * wh;
	check_small(&c, "explicit Euler", wh, q / 3, -wh / 2, 1e-2);
	check_small(&c, "explicit trapezoid", wh, -q / 6, -q * wh / 8, 1e-2);
	check_small(&c, "RK4", wh, q * q / 120, q * q * wh / 144, 1e-2);
	check_small(&c, "central difference", wh, -q / 24, 0, 1e-2);
	check_small(&c, "implicit trapezoid", wh, q / 12, 0, 1e-2);
	check_small(&c, "Newmark", wh, q / 12, 0, 1e-2);
	check_small(&c, "exact", wh, 0, 0, 0);
	/* Damping ratio (h/4)(wA^2 - w^2)/w: wA^2/w^2 - 1 is 0.1 and -0.1/1.2 */
	check_damping(&c, "pl 0.1 in phase", wh, 0.1 * wh / 4);
	check_damping(&c, "pl 0.1 out of phase", wh, -0.1 / 1.2 * wh / 4);
	return checks_close(&c);
}

int main(int argc, char **argv)
{
	const bool quick = flags_of(argc, &argv, "--quick", 1, 1, "integrators [--quick] OUTDIR");
	const char *folder = argv[0];
	struct checks c;
	chart(folder, quick ? 41 : 81);
	checks_open(&c, folder, "integrators_check.csv");
	orders(folder, &c);
	for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
		check_known(&c, &known[i]);
		if (strcmp(known[i].name, "KR-alpha 1") != 0 && strcmp(known[i].name, "KR-alpha 0") != 0)
			check_roads(&c, known[i].name);
	}
	return checks_close(&c) | quality(folder, quick ? 25 : 41);
}
