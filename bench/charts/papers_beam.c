/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Source 004: Fang, Wang and Guo, exponential time differencing for a rotating flexible beam: which operator A(speed)
 * makes a scheme diverge, what the others' errors are, and what they cost. */
#include <math.h>
#include <stdlib.h>

#include "papers.h"

static const char source[] = "004";
enum { COORDINATES = 15, SECONDS = 50, PER_SECOND = 10, ROWS = SECONDS * PER_SECOND, FINE = 10, TIP = 13 };
static const double spin_up = 15;           /* [s] */
static const double gone = 1000;            /* a deflection [m] that tells divergence: the beam is 8 m long */
/* a deflection [m] after the spin-up that a plot shows: the true one is below 0.015 */
static const double seen = 0.1;

struct reference {
	const char *model;
	struct problem *p;
	double tip[ROWS], fine[ROWS * FINE];    /* each tenth and hundredth of a second */
	double least, when, late;               /* smallest deflection, its time, and the largest after the spin-up */
	double agreement;                       /* largest difference of the two roads [m] */
};

/* Tip deflections at the end of each unit; NAN after the finite numbers are left */
static void tips_of(struct run *run, double *tip)
{
	const int units = run->problem->units;
	double *rows = rows_of(run);
	for (int row = 0; row < units; row++)
		tip[row] = rows[row * 2 * COORDINATES + TIP];
	free(rows);
}

/* The minimum is of the parabola through three rows. */
static void describe(struct reference *b)
{
	for (int row = 0; row < ROWS; row++)
		b->tip[row] = b->fine[row * FINE + FINE - 1];
	for (int i = 1; i < ROWS * FINE - 1; i++) {
		const double *tip = b->fine + i, curve = tip[-1] - 2 * tip[0] + tip[1], slope = (tip[1] - tip[-1]) / 2;
		if (tip[0] <= tip[-1] && tip[0] <= tip[1] && tip[0] - slope * slope / (2 * curve) < b->least) {
			b->least = tip[0] - slope * slope / (2 * curve);
			b->when = (i + 1 - slope / curve) / (PER_SECOND * FINE);
		}
		if ((i + 1.0) / (PER_SECOND * FINE) > spin_up + 1)
			b->late = fmax(b->late, fabs(tip[0]));
	}
}

static const struct method etdrk4 = { .name = "etdrk4", .family = OURS, .order = 4,
									  .settings = "plgen --scheme etdrk4" };
static const struct method etdrk2 = { .name = "etdrk2", .family = OURS, .order = 2,
									  .settings = "plgen --scheme etdrk2" };
static const struct method etd1 = { .name = "etd1", .family = OURS, .order = 1, .settings = "plgen --scheme etd1" };
static const struct method *const schemes[] = { &etd1, &etdrk2, &etdrk4 };

/* Two roads at h = 0.0001: etdrk4 with the operator of full speed, and RK4 on the equations as written, which share
 * nothing. */
static void solve(const struct papers *papers, const char *variant, struct reference *b)
{
	static double other[ROWS * FINE];
	const struct method *rk4 = method_find("RK4");
	struct problem *p = papers_problem(papers, variant, b->model, 1.0 / (PER_SECOND * FINE), ROWS * FINE, -1);
	say_progress("papers: 004, %s, reference", b->model);
	tips_of(papers_run(papers, &etdrk4, p, variant), b->fine);
	tips_of(rk4->open(rk4, p, 1e-4), other);
	for (int row = 0; row < ROWS * FINE; row++)
		b->agreement = fmax(b->agreement, fabs(b->fine[row] - other[row]));
	describe(b);
	problem_free(p);
	b->p = papers_problem(papers, variant, b->model, 1.0 / PER_SECOND, ROWS, -1);
}

static void compare_reference(FILE *table, const struct reference *b, const char *least, const char *when,
							  const char *late)
{
	const char *roads = text("etdrk4 at h = 0.0001 s; RK4 at 0.0001 s on the equations differs by at most %.2g m",
	                         b->agreement);
	put_row(table, b->model, "reference", "smallest tip deflection [m]", NULL, least, text("%.6g", b->least),
		roads);
	put_row(table, b->model, "reference", "its time [s]", NULL, when, text("%.5g", b->when),
		"parabola through rows of 0.01 s");
	if (late)
		put_row(table, b->model, "reference", "largest deflection after the spin-up [m]", NULL, late,
			text("%.2g", b->late), roads);
}

/* ---- what becomes of a run ---- */

struct fate {
	double error;                           /* largest of the tip over all rows [m] */
	double seen, gone;                      /* when a plot shows it, when it has left all bounds; infinite: never */
	double early, last;                     /* largest deflections: of 16 s to 26 s, of the last 10 s */
	double tip[ROWS];
};

static struct fate fate_of(struct run *run, const struct reference *b)
{
	struct fate f = { .seen = INFINITY, .gone = INFINITY };
	tips_of(run, f.tip);
	for (int row = 0; row < ROWS; row++) {
		const double t = (row + 1.0) / PER_SECOND, tip = fabs(f.tip[row]);
		const double off = fabs(f.tip[row] - b->tip[row]);
		f.error = off <= f.error ? f.error : isfinite(off) ? off : INFINITY;
		if (!(tip < seen) && t > spin_up + 1)
			f.seen = fmin(f.seen, t);
		if (!(tip < gone)) {
			f.gone = fmin(f.gone, t);
			f.seen = fmin(f.seen, t);
		}
		if (t > spin_up + 1 && t < spin_up + 11)
			f.early = fmax(f.early, tip);
		if (t > SECONDS - 10)
			f.last = tip <= f.last ? f.last : isfinite(tip) ? tip : INFINITY;
	}
	return f;
}

static const char *say(const struct fate *f, const struct reference *b)
{
	if (isfinite(f->gone))
		return text("diverges: seen at %.3g s, beyond 1000 m at %.3g s", f->seen, f->gone);
	if (isfinite(f->seen))
		return text("grows: beyond 0.1 m at %.3g s, %.2g m at the end", f->seen, f->last);
	return text("%s: largest in the last 10 s %.3g m, in the first 10 s after the spin-up %.3g m",
	            f->last > 1.001 * f->early && f->last > 1.001 * b->late ? "grows" : f->last < 0.95 * f->early
	            ? "decays" : "bounded", f->last, f->early);
}

/* Largest |deflection| in each second, for the picture */
static void draw(FILE *picture, int rate, int speed, const double *tip)
{
	for (int second = 0; second < SECONDS; second++) {
		double most = 0;
		for (int i = 0; i < PER_SECOND; i++) {
			const double off = fabs(tip[second * PER_SECOND + i]);
			most = off <= most ? most : isfinite(off) ? off : INFINITY;
		}
		fprintf(picture, "%g,%s,%d,", 1.0 / rate, speed < 0 ? "reference" : text("A(%d)", speed), second + 1);
		if (isfinite(most))
			fprintf(picture, "%.6g\n", most);
		else
			fputs("diverged\n", picture);
	}
}

/* etd1 at Om = 4 with the operator at each speed */
static void compare_operators(const struct papers *papers, FILE *table, FILE *picture, const struct reference *b)
{
	static const int rates[] = { 10, 100, 1000, 10000 };
	static const char *const recovered[4][7] = {
		{ "diverges near 30 s", "diverges near 30 s", "diverges near 35 s", "grows", "bounded",
		  "bounded; decays", "bounded; decays" },
		{ "diverges near 27.5 s", "diverges near 28 s", "diverges near 35 s", "grows", "bounded",
		  "bounded; decays", "bounded; decays" },
		{ "diverges near 45 s", "diverges near 48 s", "visibly growing", "only just growing", NULL, NULL,
		  NULL },
		{ "nothing visible: grows by 0.117 a second", "nothing visible: by 0.109 a second",
		  "nothing visible: by 0.088 a second", "nothing visible: by 0.051 a second", "bounded", "bounded",
		  "bounded" },
	};
	for (int i = papers->quick ? 1 : 0; i < (papers->quick ? 2 : 4); i++) {
		say_progress("papers: 004, etd1, h = %g", 1.0 / rates[i]);
		if (i < 3)              /* the shortest steps show nothing */
			draw(picture, rates[i], -1, b->tip);
		for (int speed = 0; speed <= 6; speed++) {
			const struct fate f = fate_of(papers_run(papers, &etd1, b->p,
			                                         text("beam4_A%d_etd1_%d", speed, rates[i])), b);
			put_row(table, b->model, "etd1",
				text("operator A(%d), h = %g s, 50 s", speed, 1.0 / rates[i]), NULL,
				recovered[i][speed], say(&f, b), "Om = 4; operator at w = the number in brackets");
			if (i < 3)
				draw(picture, rates[i], speed, f.tip);
		}
	}
}

/* Om = 4 over 2000 s, with the operators that stay bounded over 50 s */
static void compare_long(const struct papers *papers, FILE *table, const struct reference *b)
{
	enum { LONG = 2000 };
	for (int rate = papers->quick ? 100 : 10; rate <= 100; rate *= 10)
		for (int speed = 4; speed <= 6; speed++) {
			const char *variant = text("beam4_A%d_etd1_%d", speed, rate);
			struct problem *p = papers_problem(papers, variant, b->model, 1.0 / PER_SECOND,
			                                   LONG * PER_SECOND, -1);
			double *tip = calloc(LONG * PER_SECOND, sizeof *tip), early = 0, last = 0;
			say_progress("papers: 004, etd1, %s, %d s", variant, LONG);
			tips_of(papers_run(papers, &etd1, p, variant), tip);
			for (int row = 0; row < LONG * PER_SECOND; row++) {
				const double t = (row + 1.0) / PER_SECOND, off = fabs(tip[row]);
				double *most = t > LONG - 100 ? &last : &early;
				if (t > spin_up + 1 && (t < 116 || t > LONG - 100))
					*most = off <= *most ? *most : isfinite(off) ? off : INFINITY;
			}
			put_row(table, b->model, "etd1",
				text("operator A(%d), h = %g s, %d s", speed, 1.0 / rate, LONG), NULL,
				speed == 4 ? "bounded" : "bounded; decays",
				text("%s: largest in the last 100 s %.3g m, in the first 100 s after the "
					"spin-up %.3g m", !(last <= gone) ? "diverges" : last > 1.001 * early
						? "grows" : last < 0.95 * early ? "decays" : "bounded", last, early),
				"Om = 4");
			free(tip);
			problem_free(p);
		}
}

/* Om = 15: the operator at rest, and at full speed */
static void compare_schemes(const struct papers *papers, FILE *table, const struct reference *b)
{
	static const char *const at_rest[] = { "diverges near 10 s", "diverges near 22 s", "diverges near 26 s" };
	static const char *const left[2][2] = { { "7.5e-4", "8.8e-5" }, { "1.5e-3", "6.3e-7" } };
	for (int i = 0; i < 6; i++) {
		const struct method *scheme = schemes[i % 3];
		const int speed = i < 3 ? 0 : 15;
		const struct fate f = fate_of(papers_run(papers, scheme, b->p,
		                                         text("beam15_A%d_%s_100", speed, scheme->name)), b);
		put_row(table, b->model, scheme->name, text("operator A(%d), h = 0.01 s, 50 s", speed), NULL,
			i < 3 ? at_rest[i] : "bounded", say(&f, b), "Om = 15");
	}
	for (int k = 0; k < (papers->quick ? 4 : 8); k++) {
		const int fine = k / 4, exact = k % 4 / 2, i = k % 2 + 1, rate = fine ? 1000 : 100;
		const struct fate f = fate_of(papers_run(papers, schemes[i], b->p,
		                                         text("beam15_%s_%s_%d", exact ? "A15" : "left",
		                                              schemes[i]->name, rate)), b);
		put_row(table, b->model, schemes[i]->name,
			text("largest error of the tip [m], A(15), h = %g s", 1.0 / rate), NULL,
			exact ? NULL : left[i - 1][fine], text("%.2g", f.error),
			exact ? "Om = 15; loads carried exactly, plgen's default"
				: "Om = 15; loads left to the scheme");
	}
}

void beam_times(const struct papers *papers)
{
	static const char *const reported[] = { "1", "about 2", "about 4" };
	struct problem *p = papers_problem(papers, "beam15_A15_etd1_100", "beam15", 0.01, 5000, -1);
	struct run *run[3];
	for (int i = 0; i < 3; i++)
		run[i] = papers_run(papers, schemes[i], p, text("beam15_A15_%s_100", schemes[i]->name));
	put_times(papers, "beam15", "time of a step over etd1's", 3, run, papers->quick ? 0.3 : 1.5, reported,
	          "one operator A(15), h = 0.01 s, loads exact; compiled C, -O2");
	problem_free(p);
}

void rotating_beam(struct papers *papers)
{
	FILE *table = table_begin(papers, "papers_004.csv");
	FILE *picture = table_open(papers->folder, "papers_beam_tip.csv",
		"h_s,operator,t_s,largest_tip_in_last_second_m");
	static struct reference beam4, beam15;
	beam4.model = "beam4";
	beam15.model = "beam15";
	solve(papers, "beam4_A4_etdrk4_10000", &beam4);
	solve(papers, "beam15_A15_etdrk4_10000", &beam15);
	compare_reference(table, &beam4, "-0.534406", "6.765", "0.0083");
	compare_reference(table, &beam15, "-1.3736", "5.70", NULL);
	compare_operators(papers, table, picture, &beam4);
	compare_long(papers, table, &beam4);
	compare_schemes(papers, table, &beam15);
	problem_free(beam4.p);
	problem_free(beam15.p);
	table_close(table, "papers");
	table_close(picture, "papers");
}
