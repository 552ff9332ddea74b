/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Source 000: Fang, Wang, Dai and Zhang, "Piecewise-Laplace method ...", Science Progress 2020: coupled masses. Its
 * methods are Euler, trapezoid, ode45, RK4 and its own (`pl`: coupling held over a step), judged against RK4 at 0.001
 * s; here against the closed form too. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "papers.h"

#define DORMAND_TYPE const struct problem
#define DORMAND_SLOPES problem_slope
#include "dormand_step.h"

static const char source[] = "000";
static const double whole = 30;             /* [s]: its histories */

static const struct system {
	const char *name;
	double frequency;                       /* of the load */
	const char *time_ratio[2];              /* CPU time of PL over RK4 that it reports, at h = 0.01 and 0.001 */
} systems[] = { { "scs", 0, { "0.53", "0.51" } }, { "sdcs", 0, { "0.72", "0.57" } },
				{ "sdcsf", 5, { "0.81", "0.62" } } };

static const struct method pl = { .name = "pl", .family = OURS, .linear_only = true, .order = 1,
								  .settings = "plgen --scheme pl" };
static const struct method exact = { .name = "exact", .family = OURS, .linear_only = true,
									 .settings = "plgen --scheme exact" };

/* ---- ode45 ----
 *
 * What MATLAB's ode45 does by its documentation and Shampine and Reichelt, "The MATLAB ODE suite", 1997: the pair of
 * Dormand and Prince (J. Comput. Appl. Math. 6, 1980) with local extrapolation and the defaults RelTol = 1e-3, AbsTol
 * = 1e-6, and values between steps by the pair's continuous extension. */

enum { STATES = 4 };
static const double relative = 1e-3, absolute = 1e-6;

struct ode45 {
	const struct problem *p;
	double t, h, y[STATES], next[STATES], slope[7][STATES], *k[7];
};

static double weighted(const double *x, const double *a, const double *b)
{
	double largest = 0;
	for (int i = 0; i < STATES; i++)
		largest = fmax(largest, fabs(x[i]) / fmax(fmax(fabs(a[i]), fabs(b[i])), absolute / relative));
	return largest;
}

/* Tries a step of h from t; its error over the tolerance */
static double attempt(struct ode45 *s)
{
	double off[STATES];
	dormand_stages(s->p, STATES, s->t, s->h, s->y, s->k, s->next);
	for (int i = 0; i < STATES; i++)
		off[i] = dormand_error(s->h, s->k, i);
	return weighted(off, s->y, s->next) / relative;
}

/* rows: at the end of each unit; how many steps it took */
static int ode45_solve(const struct problem *p, double *rows)
{
	struct ode45 s = { .p = p };
	const double end = p->unit * p->units;
	int taken = 0, row = 0;
	memcpy(s.y, p->start, sizeof s.y);
	for (int i = 0; i < 7; i++)
		s.k[i] = s.slope[i];
	problem_slope(p, 0, s.y, s.k[0]);
	s.h = fmin(end / 10, 0.8 * pow(relative, 0.2) / weighted(s.k[0], s.y, s.y));
	while (row < p->units) {
		bool failed = false;
		s.h = fmin(s.h, end / 10);
		if (1.1 * s.h >= end - s.t)
			s.h = end - s.t;
		double error = attempt(&s);
		for (; error > 1; error = attempt(&s)) {
			s.h *= failed ? 0.5 : fmax(0.1, 0.8 * pow(1 / error, 0.2));
			failed = true;
		}
		for (; row < p->units && ((row + 1) * p->unit <= s.t + s.h || s.t + s.h >= end); row++)
			dormand_inside(STATES, s.h, ((row + 1) * p->unit - s.t) / s.h, s.y, s.k, rows + row * STATES);
		s.t += s.h;
		memcpy(s.y, s.next, sizeof s.y);
		memcpy(s.k[0], s.k[6], sizeof s.slope[0]);
		taken++;
		if (!failed)
			s.h *= fmin(5, 0.8 * pow(1 / error, 0.2));
	}
	return taken;
}

/* ---- errors ---- */

/* Largest of any displacement, over the initial one */
static double largest(const struct problem *p, const double *rows, const double *reference, int units)
{
	return largest_off(p->n, p->n, rows, reference, units) / fabs(p->start[0]);
}

/* RK4 at a tenth of the unit */
static double *fine_rk4(const struct problem *p)
{
	const struct method *rk4 = method_find("RK4");
	return rows_of(rk4->open(rk4, p, p->unit / 10));
}

enum { METHODS = 6 };

static void order_errors(const struct papers *papers, FILE *table, const struct system *system)
{
	static const char *const names[METHODS] = { "explicit Euler", "explicit trapezoid", "ode45", "RK4", "pl",
	                                            "exact" };
	static const double horizon[2] = { 30, 0.6 };
	static const char *const against[2] = { "RK4 at 0.001 s", "the closed form" };
	struct problem *p = papers_problem(papers, text("%s_exact_100", system->name), system->name, 0.01, 3000,
	                                   system->frequency);
	struct truth *truth = truth_of(p);
	double *rows[METHODS], *fine = fine_rk4(p);
	int steps = 0;
	for (int i = 0; i < METHODS; i++) {
		const struct method *peer = method_find(names[i]);
		if (i == 2) {
			rows[i] = calloc((size_t)(STATES * p->units), sizeof **rows);
			steps = ode45_solve(p, rows[i]);
		} else if (peer) {
			rows[i] = rows_of(peer->open(peer, p, p->unit));
		} else {
			rows[i] = rows_of(papers_run(papers, i == 4 ? &pl : &exact, p,
			                             text("%s_%s_100", system->name, names[i])));
		}
	}
	for (int k = 0; k < 2; k++) {
		struct placing placing[2][METHODS];
		const double *const reference[] = { fine, truth->at_end };
		const int units = (int)lround(horizon[k] / p->unit);
		for (int i = 0; i < METHODS; i++) {
			const char *settings = i == 2 ? text("RelTol 1e-3; AbsTol 1e-6; %d steps in 30 s", steps)
			                       : "h = 0.01 s";
			for (int r = 0; r < 2; r++) {
				placing[r][i] = (struct placing){ names[i], largest(p, rows[i], reference[r], units) };
				put_row(table, system->name, names[i],
					text("largest displacement error over x1(0), %g s, against %s", horizon[k],
					     against[r]),
					NULL, NULL, percent(placing[r][i].error), settings);
			}
		}
		for (int r = 0; r < 2; r++)
			put_row(table, system->name, "all",
				text("order of these errors, %g s, against %s", horizon[k], against[r]),
				r == 0 ? "PL < RK4" : NULL, NULL, ordering(METHODS, placing[r]), r == 0 ?
				"smallest first; its printed tables contradict its text: stated largest error "
				"10.18 %, a printed row 19.8 %" : "smallest first");
	}
	put_row(table, system->name, "RK4", "its reference itself: RK4 at 0.001 s, 30 s, against the closed form",
		NULL, NULL, percent(largest(p, fine, truth->at_end, p->units)), truth->roads);
	for (int i = 0; i < METHODS; i++)
		free(rows[i]);
	free(fine);
	problem_free(p);
}

/* ---- stiff springs, weak coupling ---- */

static const struct springs {
	int k1, k2, k3;
	const char *reported[2], *recovered[2]; /* pl, RK4 */
} springs[] = {
	{ 4000, 40, 2000, { "1.54 % (parameters unknown)", "6.15 % (parameters unknown)" }, { "1.5 %", "4.8 %" } },
	{ 4000, 40, 4000, { NULL, NULL }, { "5.6 %", "4.8 %" } },
	{ 4000, 400, 4000, { NULL, NULL }, { "58 %", "6.0 %" } },
	{ 100, 100, 100, { NULL, NULL }, { "12.8 %", "0.0032 %" } },
};

static void compare_springs(const struct papers *papers, FILE *table, const struct springs *s)
{
	char model[64], variant[64];
	snprintf(model, sizeof model, "scs k = %d %d %d", s->k1, s->k2, s->k3);
	snprintf(variant, sizeof variant, "k%d_%d_%d", s->k1, s->k2, s->k3);
	const struct method *rk4 = method_find("RK4");
	struct problem *p = papers_problem(papers, text("%s_exact", variant), model, 0.01, 60, 0);
	struct truth *truth = truth_of(p);
	struct run *run[] = { papers_run(papers, &pl, p, text("%s_pl", variant)), rk4->open(rk4, p, p->unit),
	                      papers_run(papers, &exact, p, text("%s_exact", variant)) };
	for (int i = 0; i < 3; i++) {
		const char *name = run[i]->method->name;
		double *rows = rows_of(run[i]);
		put_row(table, model, name, "largest displacement error over x1(0), 0.6 s, against the closed form",
			i < 2 ? s->reported[i] : NULL, i < 2 ? s->recovered[i] : NULL,
			percent(largest(p, rows, truth->at_end, p->units)), "h = 0.01 s; m = 1; undamped");
		free(rows);
	}
	problem_free(p);
}

/* ---- time ---- */

static void time_histories(const struct papers *papers, const struct system *system, int fine)
{
	const int rate = fine ? 1000 : 100;
	const struct method *rk4 = method_find("RK4");
	struct problem *p = papers_problem(papers, text("%s_exact_%d", system->name, rate), system->name, 1.0 / rate,
	                                   (int)whole * rate, system->frequency);
	struct run *run[] = { rk4->open(rk4, p, p->unit),
	                      papers_run(papers, &pl, p, text("%s_pl_%d", system->name, rate)),
		papers_run(papers, &exact, p, text("%s_exact_%d", system->name, rate)) };
	const char *const reported[3] = { NULL, system->time_ratio[fine], NULL };
	put_times(papers, system->name, text("time of a step over RK4's, 30 s at h = %g s", p->unit), 3, run,
	          papers->quick ? 0.15 : 0.8, reported,
	          "compiled C, -O2; RK4 on the generated NAME_rhs; a row kept at each step");
	problem_free(p);
}

void coupled_systems(struct papers *papers)
{
	FILE *table = table_begin(papers, "papers_000.csv");
	for (size_t i = 0; i < sizeof systems / sizeof *systems; i++) {
		say_progress("papers: 000, errors of %s", systems[i].name);
		order_errors(papers, table, &systems[i]);
	}
	for (size_t i = 0; i < sizeof springs / sizeof *springs; i++)
		compare_springs(papers, table, &springs[i]);
	table_close(table, "papers");
}

void coupled_times(const struct papers *papers)
{
	for (size_t i = 0; i < sizeof systems / sizeof *systems; i++)
		for (int fine = 0; fine < 2; fine++)
			time_histories(papers, &systems[i], fine);
}
