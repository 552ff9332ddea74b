/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * stability [--quick] OUTDIR VARIANTS
 *
 * Where does each method stay bounded on x'' + 2 zeta w x' + w^2 x = 0?  The spectral radius of one step over (w h,
 * zeta), and where it passes 1: stability_map_raw.csv, stability_boundary.csv; what is known of these boundaries beside
 * what is measured: stability_check.csv. `exact` is e^{A h} by hand, compared with generated code at a few points
 * (VARIANTS/oscillator_*.so).
 *
 * What happens when the exact part of a step is not the whole motion?
 *   etd1 ... bm3: x'' + w^2 x = 0 under an operator of frequency wA, the difference left to the scheme, over
 *   (w h, wA/w): operator_map_raw.csv
 *   pl: two equal masses, each on a spring k1 and with k2 between them; each one's own (k1 + k2) x is exact, k2 times
 *   the other one is held over the step, over (w h, k2/k1), w = sqrt((k1 + k2)/m): pl_map_raw.csv
 * rho: growth per step; growth: of the amplitude within one true period 2 pi/w, 0: none.  Both by the schemes of
 * tests/remainder/hand.c in long double; generated code at a few points beside it: operator_check.csv.  Where stability
 * ends: operator_boundary.csv.
 */
#include "amplification.h"

#include <math.h>
#include <string.h>

/* w h from 1e-2 to 1e2, `zetas` from 0 to 1.5 */
static void chart(const char *folder, int steps, int zetas)
{
	const struct map map = {table_open(folder, "stability_map_raw.csv", "method,wh,zeta,rho,growth"),
	                        table_open(folder, "stability_boundary.csv", "method,branch,wh,zeta"), steps, 4, false};
	struct subject s;
	for (int k = 0; subject_at(k, &s) && strncmp(s.name, "pl", 2) != 0; k++) {
		say_progress("stability: %s", s.name);
		for (int j = 0; j < zetas; j++) {
			s.zeta = 1.5 * j / (zetas - 1);
			map_row(&map, s.name, growth_of, &s, s.zeta);
		}
	}
	table_close(map.csv, "stability_map_raw.csv");
	table_close(map.ends, "stability_boundary.csv");
}

/* ---- what is known ---- */

/* From w h = 0.01 up to 100, beyond which rounding alone makes 1e-12 */
static double end_of(const char *name, double zeta, double limit)
{
	const struct subject s = subject_named(name, zeta);
	return first_end(growth_of, &s, 0.01, 100, pow(10, 0.01), limit);
}

/* |R(i y)|^2 - 1 of the formula of order 5 of Dormand and Prince: R(z) = 1 + z + ... + z^5/120 + z^6/600 (Hairer,
 * Norsett and Wanner, Solving ODEs I, section IV.2 of volume II) */
static double dormand_prince_end(void)
{
	double from = 0.5, to = 1.5;
	while (to - from > 1e-14) {
		const double y = (from + to) / 2, q = y * y;
		const double re = 1 + q * (-1 / 2.0 + q * (1 / 24.0 - q / 600)),
			im = y * (1 + q * (-1 / 6.0 + q / 120));
		*(re * re + im * im <= 1 ? &from : &to) = y;
	}
	return from;
}

static void check_ends(struct checks *c)
{
	static const char *const implicit[] = {"implicit trapezoid", "Newmark", "generalized-alpha"};
	const double limit = 1 + NOT_GROWING;
	check(c, 0, end_of("explicit Euler", 0, limit), 0, "explicit Euler zeta 0: end of stability w h (0: none)");
	check(c, 0.2, end_of("explicit Euler", 0.1, limit), 1e-6, "explicit Euler zeta 0.1: w h = 2 zeta");
	check(c, 0, end_of("explicit trapezoid", 0, limit), 0,
	      "explicit trapezoid zeta 0: end of stability w h (0: none)");
	check(c, sqrt(8), end_of("RK4", 0, limit), 1e-6, "RK4 zeta 0: w h = 2 sqrt(2)");
	check(c, 2.785293563405, end_of("RK4", 1, limit), 1e-6, "RK4 zeta 1: the end on the negative real axis");
	check(c, 2, end_of("central difference", 0, limit), 1e-6, "central difference zeta 0: w h = 2");
	check(c, 2, end_of("central difference", 0.5, limit), 1e-6, "central difference zeta 0.5: w h = 2");
	check(c, dormand_prince_end(), end_of("Dormand-Prince 5 (fixed step)", 0, limit), 1e-3,
	      "Dormand-Prince 5 zeta 0: |R(i w h)| = 1");
	for (int i = 0; i < 3; i++)
		for (int z = 0; z < 2; z++)
			check(c, INFINITY, end_of(implicit[i], 0.1 * z, limit), 0,
			      "%s zeta %g: end of stability w h", implicit[i], 0.1 * z);
}

/* Chung and Hulbert, J. Applied Mechanics 60 (1993): q, v and a of one step on x'' + x = 0; alpha_m = 1/3, alpha_f =
 * 4/9 */
static double alpha_by_hand(double h)
{
	const double m = 1 / 3.0, f = 4 / 9.0, beta = 25 / 81.0, gamma = 11 / 18.0,
		left = 1 - m + (1 - f) * beta * h * h;
	const double a[3] = {-1 / left, -(1 - f) * h / left, -(m + (1 - f) * h * h * (0.5 - beta)) / left};
	double matrix[9];
	double complex eigenvalue[3];
	for (int j = 0; j < 3; j++) {
		matrix[j] = (j == 0) + h * (j == 1) + h * h * ((0.5 - beta) * (j == 2) + beta * a[j]);
		matrix[3 + j] = (j == 1) + h * ((1 - gamma) * (j == 2) + gamma * a[j]);
		matrix[6 + j] = a[j];
	}
	return largest(eigenvalues_of(3, matrix, eigenvalue), eigenvalue);
}

static void check_growth(struct checks *c)
{
	const struct subject euler = subject_named("explicit Euler", 0), heun = subject_named("explicit trapezoid", 0),
		rk4 = subject_named("RK4", 0), rk8pd = subject_named("GSL rk8pd (fixed step)", 0),
		alpha = subject_named("generalized-alpha", 0);
	check(c, sqrt(1.01), growth_of(&euler, 0.1), 1e-14,
	      "explicit Euler zeta 0 w h 0.1: rho = sqrt(1 + (w h)^2)");
	check(c, sqrt(1 + 1e-4 / 4), growth_of(&heun, 0.1), 1e-14,
	      "explicit trapezoid zeta 0 w h 0.1: rho = sqrt(1 + (w h)^4/4)");
	check(c, sqrt(1 - 1e-6 / 72 + 1e-8 / 576), growth_of(&rk4, 0.1), 1e-14,
	      "RK4 zeta 0 w h 0.1: rho^2 = 1 - (w h)^6/72 + (w h)^8/576");
	check(c, alpha_by_hand(0.1), growth_of(&alpha, 0.1), 1e-12,
	      "generalized-alpha zeta 0 w h 0.1: rho of its matrix by hand");
	check(c, alpha_by_hand(10), growth_of(&alpha, 10), 1e-12,
	      "generalized-alpha zeta 0 w h 10: rho of its matrix by hand");
	check(c, 0.8, growth_of(&alpha, 1e4), 1e-2, "generalized-alpha zeta 0 w h 1e4: rho at infinity as chosen");
	/* Weak growth looks like stability where rounding hides it, so its power is looked at where it shows */
	check(c, 10, log((growth_of(&rk8pd, 0.45) - 1) / (growth_of(&rk8pd, 0.36) - 1)) /
	      log(0.45 / 0.36), 0.03,
	      "GSL rk8pd zeta 0: growth per step goes as (w h)^10, so it has no end of stability (below 1e-12 for w h "
	      "< %.3g)",
	      end_of(rk8pd.name, 0, 1 + NOT_GROWING));
}

/* Generated code at three points beside e^{-zeta w h}, e^{A h} by hand beside it on the whole axis */
static void check_exact(struct checks *c, const char *variants)
{
	static const struct { const char *file; double wh, zeta; } points[] = {
		{"oscillator_undamped", 0.5, 0}, {"oscillator_damped", 5, 0.05},
		{"oscillator_overdamped", 2, 1.25}};
	const struct subject undamped = subject_named("exact", 0);
	double worst = 0;
	for (double wh = 0.01; wh <= 100; wh *= 1.1)
		worst = fmax(worst, fabs(growth_of(&undamped, wh) - 1));
	check(c, 0, worst, 1e-13, "exact by hand zeta 0 w h 0.01 to 100: largest |rho - 1|");
	for (int i = 0; i < 3; i++) {
		const double over = points[i].zeta > 1 ? points[i].zeta - sqrt(points[i].zeta * points[i].zeta - 1)
		                    : points[i].zeta;
		const double *Phi = variant_symbol(variants, points[i].file, "subject_Phi");
		double complex eigenvalue[2];
		check(c, exp(-over * points[i].wh), largest(eigenvalues_of(2, Phi, eigenvalue), eigenvalue),
		      1e-14, "exact generated zeta %g w h %g: rho of the emitted Phi", points[i].zeta, points[i].wh);
	}
}

/* ---- what happens when the exact part of a step is not the whole motion ---- */

/* Of the two masses, w = 1 */
static double growth_of_pl(double coupling, double wh)
{
	double complex eigenvalue[MOST_EIGENVALUES];
	const real k1 = 1 / (1 + (real)coupling), k2 = 1 - k1, both = k1 + k2;
	const real A[] = {0, 0, 1, 0, 0, 0, 0, 1, -both, k2, 0, 0, k2, -both, 0, 0};
	return largest(amplification_by_hand(4, A, A, "pl", wh, eigenvalue), eigenvalue);
}

/* The scheme pl is over the coupling k2/k1, the others over wA/w */
static struct subject subject_of(const char *scheme, double across)
{
	return (struct subject){scheme, NULL, scheme, 0, across};
}

static double growth_by_hand(const void *of, double wh)
{
	const struct subject *s = of;
	return strcmp(s->scheme, "pl") == 0 ? growth_of_pl(s->ratio, wh) : growth_of(s, wh);
}

/* Of the second variable the logarithms of the least and the most */
static void chart_scheme(const struct map *map, const char *scheme, int rows, double least, double most)
{
	say_progress("operator_map: %s", scheme);
	for (int j = 0; j < rows; j++) {
		const struct subject s = subject_of(scheme, pow(10, least + (most - least) * j / (rows - 1)));
		map_row(map, scheme, growth_by_hand, &s, s.ratio);
	}
}

static void chart_operators(const char *folder, bool quick)
{
	struct map map = {.ends = table_open(folder, "operator_boundary.csv", "method,wh,across"),
	                  .csv = table_open(folder, "operator_map_raw.csv", "method,wh,ratio,rho,growth"),
	                  .steps = quick ? 22 : 71, .decades = 3.5, .periods = true};
	for (int k = 0; k < REMAINDER_SCHEMES; k++)
		chart_scheme(&map, remainder_schemes[k], quick ? 13 : 41, -1, 1);
	table_close(map.csv, "operator_map_raw.csv");
	map.csv = table_open(folder, "pl_map_raw.csv", "method,wh,coupling,rho,growth");
	map.steps = quick ? 29 : 71;
	chart_scheme(&map, "pl", quick ? 17 : 49, -3, 1);
	table_close(map.csv, "pl_map_raw.csv");
	table_close(map.ends, "operator_boundary.csv");
}

static double rate(const char *scheme, double across, double wh)
{
	const struct subject s = subject_of(scheme, across);
	return log(growth_by_hand(&s, wh)) / wh;
}

static void check_rates(struct checks *c)
{
	const double h = 0.01;
	check(c, h / 4 * (1 - 0.25), rate("etd1", 0.5, h), 0.01, "etd1 wA/w 0.5: growth rate (h/4)(w^2 - wA^2)");
	check(c, h / 4 * (1 - 4), rate("etd1", 2, h), 0.01, "etd1 wA/w 2: growth rate (h/4)(w^2 - wA^2)");
	for (int k = 0; k < 2; k++) {
		const double coupling = k == 0 ? 0.01 : 1, k2 = coupling / (1 + coupling), in_phase = 1 - k2,
			out_of_phase = 1 + k2;
		const struct subject soft = subject_of("etd1", sqrt(1 / out_of_phase)),
			stiff = subject_of("etd1", sqrt(1 / in_phase));
		const double wh = 0.5, modes = fmax(growth_by_hand(&soft, wh * sqrt(out_of_phase)),
		                                    growth_by_hand(&stiff, wh * sqrt(in_phase)));
		check(c, k2 * h / 4, rate("pl", coupling, h), 0.01, "pl k2/k1 %g: growth rate kappa h/4, kappa = k2/m",
		      coupling);
		check(c, modes, growth_of_pl(coupling, wh), 1e-13,
		      "pl k2/k1 %g w h 0.5: as etd1 of its modes, whose operators are too soft and too stiff",
		      coupling);
	}
	const struct subject free = subject_of("etd1", 1e-8);
	check(c, sqrt(1 + 0.125), growth_by_hand(&free, 0.5), 1e-12,
	      "etd1 wA 0 w h 0.5: the force held over a step, rho = sqrt(1 + (w h)^2/2)");
}

/* Of the generated code of a spring whose operator is fixed away from rest, at motions so small that its cubic term is
 * below rounding */
static void check_generated(struct checks *c, const char *variants)
{
	static const struct { const char *file, *scheme; double across, wh; } points[] = {
		{"operator_etd1", "etd1", 0.5, 0.1}, {"operator_etdrk2", "etdrk2", 2, 0.5},
		{"operator_etdrk4", "etdrk4", 0.5, 1},
		{"operator_nc2", "nc2", 2, 1}, {"operator_nc3", "nc3", 2, 1}, {"operator_dq4", "dq4", 2, 1},
		{"operator_bm3", "bm3", 0.5, 2},
		{"pl_weak", "pl", 0.01, 0.5}, {"pl_equal", "pl", 1, 1}, {"pl_strong", "pl", 4, 3}};
	for (size_t i = 0; i < sizeof points / sizeof *points; i++) {
		const struct subject s = subject_of(points[i].scheme, points[i].across);
		const bool pl = strcmp(points[i].scheme, "pl") == 0;
		double complex eigenvalue[MOST_EIGENVALUES];
		const int count = pl ? eigenvalues_of(4, variant_symbol(variants, points[i].file, "subject_Phi"),
			eigenvalue)
		                  : amplification_of_model(variant_model(variants, points[i].file), 1e-12, eigenvalue);
		check(c, growth_by_hand(&s, points[i].wh), largest(count, eigenvalue), 1e-13,
		      "%s %s %g w h %g: rho of generated code", points[i].scheme, pl ? "k2/k1" : "wA/w",
			points[i].across,
		      points[i].wh);
	}
}

int main(int argc, char **argv)
{
	const bool quick = flags_of(argc, &argv, "--quick", 2, 2, "stability [--quick] OUTDIR VARIANTS");
	struct checks c;
	const char *folder = argv[0], *variants = argv[1];
	chart(folder, quick ? 41 : 81, quick ? 16 : 31);
	checks_open(&c, folder, "stability_check.csv");
	check_ends(&c);
	check_growth(&c);
	check_exact(&c, variants);
	const int off = checks_close(&c);
	chart_operators(folder, quick);
	checks_open(&c, folder, "operator_check.csv");
	check_rates(&c);
	check_generated(&c, variants);
	return checks_close(&c) | off;
}
