/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * largest_step [--quick] OUTDIR VARIANTS
 *
 * The largest step with which each method stays stable on each model: largest_step.csv.  Linear models: by the growth
 * per step of free motion, 1 + 1e-12 at most.  The others: by whole histories, whose coordinates and velocities are to
 * stay within 10 times the largest of a reference (RK4 at a small step).  Steps are tried from small to large, and the
 * first end is found by bisection; so every smaller step that was tried is stable too; a narrow band of unstable steps
 * between two that were tried is missed (the etd schemes have such bands: operator_map).  In the table a step [s], or
 *     none       it grows at every step, however small; then the growth rate at h = 0.01 s stands beside it
 *     below H    unstable at the smallest step tried
 *     any        no end: at all steps tried, up to 100 over the largest frequency, or up to the step told
 *     -          the scheme is not for this model
 */
#include "amplification.h"
#include "cantilever.h"
#include "systems.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct model {
	const char *name;
	bool linear;
	double seconds;                 /* of a history */
	double from, to;                /* steps tried [s] */
	double from_by_hand;            /* of our schemes, by hand: slower */
	double reference, reference_seconds;
	int most_steps;                 /* of a history: the shorter of the two */
	double beam;                    /* rad/s, or 0 */
};
static const struct model models[] = {
	{.name = "scs", .linear = true},
	{.name = "sdcs", .linear = true},
	{.name = "sdcsf", .linear = true},
	{.name = "scs_weak", .linear = true},
	{.name = "linear2dof", .linear = true},
	{"pendulum", false, 100, 1e-3, 10, 0.02, 0.01, 100, 100000, 0},
	{"vanderpol", false, 100, 1e-3, 10, 0.02, 0.01, 100, 100000, 0},
	{"vanderpol_stiff", false, 200, 1e-3, 10, 5e-3, 1e-3, 200, 200000, 0},
	{"quad2dof", false, 100, 1e-3, 10, 0.02, 0.01, 100, 100000, 0},
	{"duffing", false, 100, 1e-3, 10, 0.02, 0.01, 100, 100000, 0},
	{"mathieu", false, 50, 1e-3, 10, 0.02, 0.01, 50, 100000, 0},
	{"gear1", false, 100, 1e-3, 10, 0, 0.01, 100, 100000, 0},
	{"gear2", false, 100, 1e-3, 10, 0, 0.01, 100, 100000, 0},
	{"beam4", false, 50, 5e-5, 1, 4e-4, 2e-4, 20, 5000, 4},
	{"beam15", false, 50, 5e-5, 1, 4e-4, 2e-4, 20, 5000, 15},
};

struct effort { int per_decade; double digits; double shorter; };
static struct effort effort;

static void entry(FILE *csv, const char *model, const char *method, const char *step, const char *rate,
				  const char *criterion)
{
	fprintf(csv, "%s,%s,%s,%s,\"%s\"\n", model, method, step, rate, criterion);
}

/* ---- linear models ---- */

struct free_subject {
	struct free_motion *motion;
	const struct method *method;    /* or NULL, and: */
	const char *scheme;             /* flow: exact; pl */
};

static double growth(const void *of, double h)
{
	const struct free_subject *s = of;
	double complex eigenvalue[MOST_EIGENVALUES];
	if (s->method)
		return largest(amplification(s->motion, s->method, h, eigenvalue), eigenvalue);
	real A[MOST_STATES * MOST_STATES];
	for (int i = 0; i < MOST_STATES * MOST_STATES; i++)
		A[i] = (real)s->motion->A[i];
	return largest(amplification_by_hand(2 * s->motion->problem.n, A, A, s->scheme, h, eigenvalue), eigenvalue);
}

/* Weak growth comes in sight slowly: it is there at smaller steps too, below what rounding lets see */
static bool is_weak(const struct free_subject *s, double end)
{
	return growth(s, 1.02 * end) < 1 + 1e-6;
}

static void free_entry(FILE *csv, const struct free_subject *s, double fastest, const char *name)
{
	const double limit = 1 + NOT_GROWING,
		end = first_end(growth, s, 0.01 / fastest, 100 / fastest, pow(10, 1.0 / 40), limit);
	const char *step = isfinite(end) ? text("%.4g", end) : "any", *rate = "";
	if (isfinite(end) && (end == 0 || is_weak(s, end))) {
		const double rho = growth(s, 0.01);
		step = "none";
		rate = rho <= limit ? text("below %g", NOT_GROWING / 0.01) : text("%.4g", log(rho) / 0.01);
	}
	entry(csv, s->motion->problem.name, name, step, rate, "free motion");
}

static void linear_model(FILE *csv, const struct problem *p)
{
	struct free_motion motion;
	double complex eigenvalue[MOST_EIGENVALUES];
	free_motion_of(&motion, p->name, p->n, p->A);
	const double fastest = largest(eigenvalues_of(2 * p->n, p->A, eigenvalue), eigenvalue);
	for (int k = 0; charted_method(k); k++)
		free_entry(csv, &(struct free_subject){&motion, charted_method(k), NULL}, fastest,
		           charted_method(k)->name);
	free_entry(csv, &(struct free_subject){&motion, NULL, "flow"}, fastest, "exact");
	free_entry(csv, &(struct free_subject){&motion, NULL, "pl"}, fastest, "pl");
	for (int k = 0; k < REMAINDER_SCHEMES; k++)
		entry(csv, p->name, remainder_schemes[k], "any", "", "there is no remainder: as exact");
}

/* ---- histories ---- */

struct bounds { double q, v; };

static bool within(int n, const double *y, const struct bounds *b)
{
	for (int i = 0; i < n; i++)
		if (!(fabs(y[i]) <= b->q && fabs(y[n + i]) <= b->v))
			return false;
	return true;
}

struct history {
	const struct model *model;
	struct problem *problem;        /* its unit is set to the step */
	struct bounds bounds;
	const struct method *method;    /* or NULL, and: */
	const struct system *system;
	const char *scheme;
};

static int steps_in(const struct history *s, double h)
{
	const double steps = ceil(s->model->seconds / h), most = s->model->most_steps * effort.shorter;
	return (int)fmin(steps, most);
}

static bool run_is_bounded(const struct history *s, double h)
{
	enum { CHUNK = 16, MOST = 30 };
	const int size = 2 * s->problem->n;
	double rows[CHUNK * MOST];
	s->problem->unit = h;
	struct run *run = s->method->open(s->method, s->problem, h);
	bool good = run && size <= MOST;
	for (int left = steps_in(s, h); left > 0 && good; left -= CHUNK) {
		const int now = left < CHUNK ? left : CHUNK;
		good = run->advance(run, now, rows);
		for (int k = 0; k < now && good; k++)
			good = within(s->problem->n, rows + k * size, &s->bounds);
	}
	if (run)
		run->close(run);
	return good;
}

static bool scheme_is_bounded(const struct history *s, double h)
{
	const int size = 2 * s->problem->n, steps = steps_in(s, h);
	struct hand *hand = hand_new(s->system, s->scheme, (real)h);
	real y[HAND_MOST] = {0};
	double seen[HAND_MOST];
	bool good = true;
	memcpy(y, s->system->start, sizeof s->system->start);
	for (int k = 0; k < steps && good; k++) {
		hand_step(hand, k * (real)h, NULL, y);
		for (int i = 0; i < size; i++)
			seen[i] = (double)y[i];
		good = within(s->problem->n, seen, &s->bounds);
	}
	hand_free(hand);
	return good;
}

static double bounded(const void *of, double h)
{
	const struct history *s = of;
	return (s->method ? run_is_bounded(s, h) : scheme_is_bounded(s, h)) ? 0 : 1;
}

/* boundary_between, but to few digits */
static double end_between(const struct history *s, double from, double to, double digits)
{
	while (to > from * (1 + digits)) {
		const double middle = sqrt(from * to);
		*(bounded(s, middle) <= 0 ? &from : &to) = middle;
	}
	return from;
}

static void history_entry(FILE *csv, const struct history *s, double from, const char *name)
{
	const bool slow = s->system && s->model->beam > 0;
	const double apart = pow(10, slow && from < 0.01 ? 0.25 : 1.0 / effort.per_decade);
	double h = from;
	char step[40], criterion[400];
	snprintf(criterion, sizeof criterion,
	         "%g s or %g steps, RK4 at %g s; tried: %g s to %g s, by %.3g%s%s", s->model->seconds,
	         s->model->most_steps * effort.shorter, s->model->reference, from, s->model->to, apart,
	         slow ? "; operator at the final speed" : "", s->method ? "" : "; by hand in long double");
	if (bounded(s, h) > 0)
		snprintf(step, sizeof step, "below %g", from);
	else {
		while (h * apart <= 1.001 * s->model->to && bounded(s, h * apart) <= 0)
			h *= apart;
		if (h * apart > 1.001 * s->model->to)
			snprintf(step, sizeof step, "any");
		else
			snprintf(step, sizeof step, slow ? "%.2g" : "%.3g",
			         end_between(s, h, h * apart, slow ? 0.01 : effort.digits));
	}
	entry(csv, s->model->name, name, step, "", criterion);
}

static struct bounds reference_bounds(const struct history *s)
{
	const int n = s->problem->n;
	const double h = s->model->reference;
	const struct method *rk4 = charted_method(2);
	struct bounds b = {0, 0};
	double y[HAND_MOST];
	s->problem->unit = h;
	struct run *run = rk4->open(rk4, s->problem, h);
	for (int left = (int)ceil(s->model->reference_seconds / h); left > 0 && run->advance(run, 1, y); left--)
		for (int i = 0; i < n; i++) {
			b.q = fmax(b.q, 10 * fabs(y[i]));
			b.v = fmax(b.v, 10 * fabs(y[n + i]));
		}
	run->close(run);
	return b;
}

/* ---- the beam by hand ---- */

static double beam_speed;

static void beam_equations(real t, const real *y, const real *u, real *dydt)
{
	real slope;
	(void)u;
	const real w = cantilever_speed((real)beam_speed, t, &slope);
	cantilever_slopes(w, slope, y, dydt);
}

/* At the speed it ends with */
static void beam_operator(const struct system *s, int which, real *A)
{
	enum { N = CANTILEVER_STATES };
	real at_rest[N], slope[N], y[N] = {0};
	(void)s, (void)which;
	cantilever_slopes((real)beam_speed, 0, y, at_rest);
	for (int j = 0; j < N; j++) {
		y[j] = 1;
		cantilever_slopes((real)beam_speed, 0, y, slope);
		for (int i = 0; i < N; i++)
			A[i * N + j] = slope[i] - at_rest[i];
		y[j] = 0;
	}
}

static const struct system beam_by_hand = {.name = "beam", .states = CANTILEVER_STATES, .equations = beam_equations,
										   .linear = beam_operator};

/* ---- nonlinear models ---- */

/* Steps of exact are solved whatever they are: generated code at three of them */
static void exact_entry(FILE *csv, const struct history *s, const char *variants)
{
	static const char *const steps[] = {"0.1", "1", "10"};
	bool good = true;
	for (int k = 0; k < 3; k++) {
		double y[HAND_MOST];
		const pl_model *model = variant_model(variants, text("%s_step%s", s->model->name, steps[k]));
		void *state = calloc(1, model->size);
		model->init(state);
		for (double t = 0; t < s->model->seconds && good; t += model->h) {
			model->step(state, NULL);
			model->get(state, y);
			good = within(s->problem->n, y, &s->bounds) && !(model->status && model->status(state));
		}
		free(state);
	}
	entry(csv, s->model->name, "exact", good ? "any" : "failed", "",
	      "piecewise linear, each region exact; generated code at steps of 0.1 s, 1 s and 10 s, within 10 times "
	      "the largest of RK4 at 0.01 s");
}

static void other_model(FILE *csv, const struct model *m, struct problem *p, const char *variants)
{
	const bool gears = m->from_by_hand <= 0;
	struct history s = {.model = m, .problem = p};
	s.bounds = reference_bounds(&s);
	for (int k = 0; (s.method = charted_method(k)); k++)
		history_entry(csv, &s, m->from, s.method->name);
	if (gears)
		exact_entry(csv, &s, variants);
	else
		entry(csv, m->name, "exact", "-", "", "not linear in each region");
	entry(csv, m->name, "pl", "-", "", "the paper's scheme is for linear models; for one coordinate it is etd1");
	beam_speed = m->beam;
	s.system = gears ? NULL : m->beam > 0 ? &beam_by_hand : system_of(m->name);
	for (int k = 0; k < REMAINDER_SCHEMES; k++) {
		s.scheme = remainder_schemes[k];
		if (gears)
			entry(csv, m->name, remainder_schemes[k], "-", "", "exact is at hand");
		else if (m->beam > 0 && effort.shorter < 1)
			entry(csv, m->name, remainder_schemes[k], "-", "", "in the full run only");
		else    /* etd is stable far beyond the others on the beam, and grows slowly where it does */
			history_entry(csv, &s, m->beam > 0 && k < 3 ? 0.01 : m->from_by_hand, remainder_schemes[k]);
	}
}

int main(int argc, char **argv)
{
	const bool quick = flags_of(argc, &argv, "--quick", 2, 2, "largest_step [--quick] OUTDIR VARIANTS");
	effort = quick ? (struct effort){4, 0.02, 0.1} : (struct effort){10, 0.001, 1};
	FILE *csv = table_open(argv[0], "largest_step.csv",
	                       "model,method,largest_step_s,growth_per_s_at_step_0.01,criterion");
	for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
		const struct model *m = &models[i];
		struct problem *p = problem_load(text("%s/%s.so", argv[1], m->name), m->name, 0.01, 1, m->linear,
		                                 strcmp(m->name, "sdcsf") == 0 ? 5 : 0);
		say_progress("largest_step: %s", m->name);
		if (m->linear)
			linear_model(csv, p);
		else
			other_model(csv, m, p, argv[1]);
		problem_free(p);
	}
	table_close(csv, "largest_step.csv");
	return 0;
}
