/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * operator_map [--quick] OUTDIR VARIANTS
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

/* Of the two masses, w = 1 */
static double growth_of_pl(double coupling, double wh)
{
	double complex eigenvalue[MOST_EIGENVALUES];
	const real k1 = 1 / (1 + (real)coupling), k2 = 1 - k1, both = k1 + k2;
	const real A[] = {0, 0, 1, 0, 0, 0, 0, 1, -both, k2, 0, 0, k2, -both, 0, 0};
	return largest(amplification_by_hand(4, A, A, "pl", wh, eigenvalue), eigenvalue);
}

/* ---- maps ---- */

/* The scheme pl is over the coupling k2/k1, the others over wA/w */
static struct subject subject_of(const char *scheme, double across)
{
	return (struct subject){scheme, NULL, scheme, 0, across};
}

static double growth(const void *of, double wh)
{
	const struct subject *s = of;
	return strcmp(s->scheme, "pl") == 0 ? growth_of_pl(s->ratio, wh) : growth_of(s, wh);
}

/* Of the second variable the logarithms of the least and the most */
static void chart(const struct map *map, const char *scheme, int rows, double least, double most)
{
	say_progress("operator_map: %s", scheme);
	for (int j = 0; j < rows; j++) {
		const struct subject s = subject_of(scheme, pow(10, least + (most - least) * j / (rows - 1)));
		map_row(map, scheme, growth, &s, s.ratio);
	}
}

static void charts(const char *folder, bool quick)
{
	struct map map = {.ends = table_open(folder, "operator_boundary.csv", "method,wh,across"),
	                  .csv = table_open(folder, "operator_map_raw.csv", "method,wh,ratio,rho,growth"),
	                  .steps = quick ? 22 : 71, .decades = 3.5, .periods = true};
	for (int k = 0; k < REMAINDER_SCHEMES; k++)
		chart(&map, remainder_schemes[k], quick ? 13 : 41, -1, 1);
	table_close(map.csv, "operator_map_raw.csv");
	map.csv = table_open(folder, "pl_map_raw.csv", "method,wh,coupling,rho,growth");
	map.steps = quick ? 29 : 71;
	chart(&map, "pl", quick ? 17 : 49, -3, 1);
	table_close(map.csv, "pl_map_raw.csv");
	table_close(map.ends, "operator_boundary.csv");
}

/* ---- what is known, and generated code ---- */

static double rate(const char *scheme, double across, double wh)
{
	const struct subject s = subject_of(scheme, across);
	return log(growth(&s, wh)) / wh;
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
		const double wh = 0.5, modes = fmax(growth(&soft, wh * sqrt(out_of_phase)),
		                                    growth(&stiff, wh * sqrt(in_phase)));
		check(c, k2 * h / 4, rate("pl", coupling, h), 0.01, "pl k2/k1 %g: growth rate kappa h/4, kappa = k2/m",
		      coupling);
		check(c, modes, growth_of_pl(coupling, wh), 1e-13,
		      "pl k2/k1 %g w h 0.5: as etd1 of its modes, whose operators are too soft and too stiff",
		      coupling);
	}
	const struct subject free = subject_of("etd1", 1e-8);
	check(c, sqrt(1 + 0.125), growth(&free, 0.5), 1e-12,
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
		check(c, growth(&s, points[i].wh), largest(count, eigenvalue), 1e-13,
		      "%s %s %g w h %g: rho of generated code", points[i].scheme, pl ? "k2/k1" : "wA/w",
			points[i].across,
		      points[i].wh);
	}
}

int main(int argc, char **argv)
{
	const bool quick = flags_of(argc, &argv, "--quick", 2, 2, "operator_map [--quick] OUTDIR VARIANTS");
	struct checks c;
	const char *folder = argv[0], *variants = argv[1];
	charts(folder, quick);
	checks_open(&c, folder, "operator_check.csv");
	check_rates(&c);
	check_generated(&c, variants);
	return checks_close(&c);
}
