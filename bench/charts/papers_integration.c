/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Source 001: Liu, Wang, Li, Yi and others, improved precise integration, Journal of Vibration and Shock 2022: the
 * Duhamel integral by quadrature, at nodes that one step of RK4 each predicts. It finds its block method bm3 the best
 * of the four, and all better than RK4. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "papers.h"

static const char source[] = "001";
enum { SCHEMES = 4 };

static const struct method schemes[SCHEMES] = {
	{ .name = "bm3", .family = OURS, .order = 4, .settings = "plgen --scheme bm3" },
	{ .name = "nc3", .family = OURS, .order = 4, .settings = "plgen --scheme nc3" },
	{ .name = "dq4", .family = OURS, .order = 4, .settings = "plgen --scheme dq4" },
	{ .name = "nc2", .family = OURS, .order = 4, .settings = "plgen --scheme nc2" },
};

static const struct history {
	const char *model;
	int rate;                           /* steps a second */
	double seconds;
	int first;                          /* how many coordinates are judged */
	bool linear;
	const char *recovered[SCHEMES], *recovered_rk4, *operator_of;
} histories[] = {
	{ "linear2dof", 5, 10, 1, true, { "4.61e-06", "8.18e-06", "1.61e-05", "1.84e-05" }, "4.2e-3",
	  "load left to the scheme (--loads remainder) as its source has it; the scheme exact has no error" },
	{ "pendulum", 10, 10, 1, false, { "1.4e-8", "3.2e-8", "5.4e-8", "6.9e-8" }, NULL,
	  "operator: Jacobian at 0; g/l = 1 chosen" },
	{ "vanderpol", 10, 10, 1, false, { NULL }, NULL, "mu = 1, x(0) = 2 chosen" },
	{ "quad2dof", 10, 10, 2, false, { NULL }, NULL, "equations deduced" },
	{ "quad2dof", 2, 10, 2, false, { NULL }, NULL, "equations deduced" },
	{ "vanderpol_stiff", 100, 100, 1, false, { NULL }, NULL, "mu = 100, x(0) = 2 chosen; operator at the start" },
	{ "vanderpol_stiff", 1000, 100, 1, false, { NULL }, NULL, "mu = 100, x(0) = 2 chosen; operator at the start" },
};

/* Largest error of a judged coordinate at the ends of steps, in its own unit */
static double largest(struct run *run, const struct truth *truth, int judged)
{
	const struct problem *p = run->problem;
	double *rows = rows_of(run);
	const double worst = largest_off(p->n, judged, rows, truth->at_end, p->units);
	free(rows);
	return worst;
}

static const char *number(double error)
{
	return isfinite(error) ? text("%.3g", error) : "diverged";
}

static void compare(const struct papers *papers, FILE *table, const struct history *h)
{
	struct problem *p = papers_problem(papers, text("%s_bm3_%d", h->model, h->rate), h->model, 1.0 / h->rate,
	                                   (int)lround(h->seconds * h->rate), h->linear ? 0 : -1);
	struct truth *truth = truth_of(p);
	const struct method *rk4 = method_find("RK4");
	const bool stiff = strcmp(h->model, "vanderpol_stiff") == 0;
	struct placing placing[SCHEMES + 2];
	char quantity[200], settings[300];
	say_progress("papers: 001, %s, h = %g", h->model, p->unit);
	snprintf(quantity, sizeof quantity, "largest error of %s, h = %g s, %g s", h->first == 1 ? p->n == 1 ? "x"
	         : "x1" : "x and y", p->unit, h->seconds);
	for (int i = 0; i < SCHEMES; i++) {
		placing[i] = (struct placing){ schemes[i].name,
		                               largest(papers_run(papers, &schemes[i], p,
		                                                  text("%s_%s_%d", h->model, schemes[i].name, h->rate)),
		                                                  truth, h->first) };
		snprintf(settings, sizeof settings, "%s; %d evaluations of the remainder a step", h->operator_of,
		         remainder_evaluations(schemes[i].name));
		put_row(table, h->model, schemes[i].name, quantity, NULL, h->recovered[i], number(placing[i].error),
			settings);
	}
	placing[SCHEMES] = (struct placing){ "RK4", largest(rk4->open(rk4, p, p->unit), truth, h->first) };
	put_row(table, h->model, "RK4", quantity, NULL, h->recovered_rk4, number(placing[SCHEMES].error),
		"4 evaluations a step");
	put_row(table, h->model, "RK4, h/3", quantity, NULL, NULL,
		number(largest(rk4->open(rk4, p, p->unit / 3), truth, h->first)),
		"12 evaluations a step of h: about as many as nc3, dq4 and bm3");
	if (stiff) {            /* what it is set against there; how it did is not stated */
		const struct method *trapezoid = method_find("implicit trapezoid");
		struct run *run = trapezoid->open(trapezoid, p, p->unit);
		placing[SCHEMES + 1] = (struct placing){ trapezoid->name, largest(run, truth, h->first) };
		put_row(table, h->model, trapezoid->name, quantity, NULL, NULL, number(placing[SCHEMES + 1].error),
			trapezoid->settings);
	}
	put_row(table, h->model, "all", text("order of these errors, h = %g s", p->unit),
		stiff ? NULL : "bm3 leads; RK4 last",
		stiff ? NULL : "bm3 < nc3 < dq4 < nc2 < RK4 (by error constants)",
		ordering(SCHEMES + 1 + stiff, placing), text("smallest first; truth: %s", truth->roads));
	problem_free(p);
}

void precise_integration(struct papers *papers)
{
	FILE *table = table_begin(papers, "papers_001.csv");
	for (size_t i = 0; i < sizeof histories / sizeof *histories; i++)
		compare(papers, table, &histories[i]);
	table_close(table, "papers");
}

/* Of a step of 0.1 s on the pendulum, as the source has it for all schemes (its figures are lost) */
void integration_times(const struct papers *papers)
{
	const struct method *rk4 = method_find("RK4");
	struct problem *p = papers_problem(papers, "pendulum_bm3_10", "pendulum", 0.1, 1000, -1);
	struct run *run[SCHEMES + 1];
	run[0] = rk4->open(rk4, p, p->unit);
	for (int i = 0; i < SCHEMES; i++)
		run[i + 1] = papers_run(papers, &schemes[i], p, text("pendulum_%s_10", schemes[i].name));
	put_times(papers, "pendulum", "time of a step over RK4's, h = 0.1 s", SCHEMES + 1, run,
	          papers->quick ? 0.15 : 0.8, NULL,
	          "compiled C, -O2; RK4 on the generated NAME_rhs; a row kept at each step");
	problem_free(p);
}
