/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * quality [--quick] OUTDIR
 *
 * How well does each method keep period and amplitude of a free undamped oscillation?  Period elongation and amplitude
 * decay against h/T, as the textbooks of structural dynamics draw them (Bathe, Finite Element Procedures, figure 9.3;
 * Hughes, The Finite Element Method, section 9.3), from the eigenvalue of one step that stands for the oscillation, l
 * = e^{(-xi + i) phi}: the period seen is 2 pi h/phi, the amplitude falls by 1 - e^{-2 pi xi} in each of them, and xi
 * is the algorithmic damping ratio.  quality.csv, quality_check.csv.
 */
#include "amplification.h"

#include <math.h>
#include <string.h>

struct quality {
	bool oscillates;
	double elongation, decay, damping;      /* relative, per period; xi */
};

static struct quality quality_of(const struct subject *s, double wh)
{
	double complex eigenvalue[MOST_EIGENVALUES];
	const int count = oscillator_eigenvalues(s, wh, eigenvalue);
	const double complex l = oscillation(count, eigenvalue, wh);
	const double phi = carg(l), xi = -log(cabs(l)) / phi;
	struct quality q = {.oscillates = cimag(l) > 0};
	if (q.oscillates)
		q = (struct quality){true, wh / phi - 1 + 0.0, 0.0 - expm1(-2 * M_PI * xi), xi + 0.0};
	return q;
}

/* Sizes for a log axis; 0 what rounding makes */
static double seen(double x)
{
	return fabs(x) < 1e-13 ? 0 : fabs(x);
}

static void chart(FILE *csv, int points)
{
	struct subject s;
	for (int k = 0; subject_at(k, &s); k++) {
		for (int i = 0; i < points; i++) {
			const double share = 0.005 * pow(100, (double)i / (points - 1));
			const struct quality q = quality_of(&s, 2 * M_PI * share);
			if (q.oscillates)
				fprintf(csv, "%s,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g\n", s.name, share, 100 * q.elongation,
					100 * q.decay, q.damping, 100 * seen(q.elongation), 100 * seen(q.decay));
			else
				fprintf(csv, "%s,%.6g,none,none,none,none,none\n", s.name, share);
		}
	}
}

/* What the literature has for small steps: the first power of w h with its factor */
static void check_small(struct checks *c, const char *name, double wh, double elongation, double damping,
                        double tolerance)
{
	const struct subject s = subject_named(name, 0);
	const struct quality q = quality_of(&s, wh);
	check(c, elongation, q.elongation, elongation == 0 ? 1e-13 : tolerance,
	      "%s: period elongation at w h = %g, first term for small steps", name, wh);
	check(c, damping, q.damping, damping == 0 ? 1e-13 : tolerance,
	      "%s: algorithmic damping ratio at w h = %g, first term", name, wh);
}

static void check_damping(struct checks *c, const char *name, double wh, double damping)
{
	const struct subject s = subject_named(name, 0);
	check(c, damping, quality_of(&s, wh).damping, 1e-2, "%s: algorithmic damping ratio at w h = %g, first term",
	      name, wh);
}

int main(int argc, char **argv)
{
	const bool quick = flags_of(argc, &argv, "--quick", 1, 1, "quality [--quick] OUTDIR");
	const char *folder = argv[0];
	struct checks c;
	FILE *csv = table_open(folder, "quality.csv",
	                       "method,h_over_T,period_elongation_percent,amplitude_decay_percent_per_period,"
	                       "algorithmic_damping_ratio,elongation_size,decay_size");
	say_progress("quality: period elongation and amplitude decay");
	chart(csv, quick ? 25 : 41);
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
