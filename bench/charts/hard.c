/* SPDX-License-Identifier: GPL-3.0-or-later */
/* hard [--quick] VARIANTS FOLDER: where methods fail. Every method on every hard case, in FOLDER/hard_raw.csv: the
 * largest error of any displacement and velocity at the ends of units, relative to the largest displacement and
 * velocity of the history, or why there is none:
 *
 *     ok            the error is below a thousandth
 *     poor          it is not, but below a tenth
 *     wrong         nor that
 *     diverged      it passes 10, or left the finite numbers
 *     gave up       the method said so, or wanted more right-hand sides than most_evaluations
 *     refused       it cannot be set up for this model; of ours: plgen says so
 *     linear only   it is for linear models
 *     as exact      there is no remainder for this scheme: it is the exact step
 *
 * hard --list prints the generated code that it opens in VARIANTS, a line each: FILE SPEC options; with CHARTS_PROBLEMS
 * in the environment that of the cases'
 * equations. Steps are powers of two except in van der Pol's case, so that a double holds them and time itself is no
 * error. What is true: e^{A t} in quadruple precision (truth.c), or the closed forms below; for van der Pol truth_of.
 *
 * hard --scales [--quick] VARIANTS: the scales of each case, as precision --scales has them. */
#include <gsl/gsl_errno.h>
#include <math.h>
#include <quadmath.h>
#include <setjmp.h>
#include <stdlib.h>

#include "quad.h"

enum { MOST_STATES = 4 };

/* ---- what is true: q, then their velocities ---- */

/* x1'' + u^2 x1 = 0, x2'' + w^2 x2 = x1, w = u + 1e-10, whose square no double has:
 * x2 is 0.01 (cos ut - cos wt)/(w^2 - u^2) */
static void poles_apart(quad t, quad *y)
{
	const quad u = 10, w = 10 + 1e-10Q, sum = (u + w) / 2, half = (w - u) / 2, s = sinq(half * t) / (2 * half);
	y[0] = 0.01Q * cosq(u * t);
	y[1] = 0.01Q * (s * sinq(sum * t) / sum);
	y[2] = -0.1Q * sinq(u * t);
	y[3] = 0.01Q * (cosq(half * t) / 2 * sinq(sum * t) / sum + s * cosq(sum * t));
}

/* x'' + x = 0 up to the stop at b = 1 - 1e-6, reached with speed v; inside, e = x - b: e'' + (1 + K) e + b = 0. A
 * period is from -1 to -1, symmetric about the deepest point, where tan(W t) = v W / b. */
static void graze(quad t, quad *y)
{
	const quad b = 1 - 1e-6Q, W = sqrtq(1 + 1e8Q), v = sqrtq((1 - b) * (1 + b));
	const quad reach = acosq(-b), touch = atanq(v * W / b) / W, period = 2 * (reach + touch);
	quad s = t - floorq(t / period) * period;
	const bool back = s > period / 2;
	if (back)
		s = period - s;
	if (s <= reach) {
		y[0] = -cosq(s);
		y[1] = sinq(s);
	} else {
		s -= reach;
		y[0] = b + v / W * sinq(W * s) - b / (W * W) * (1 - cosq(W * s));
		y[1] = v * cosq(W * s) - b / W * sinq(W * s);
	}
	if (back)
		y[1] = -y[1];
}

/* ---- the cases ---- */

#define SPECS "bench/charts/specs/"
static const struct hard_case {
	const char *name;
	double unit;                            /* [s] */
	int units, quick_units;
	double frequency;                       /* of its load */
	bool linear;
	/* NULL: e^{A t}; where it is not linear truth_of models/vanderpol_stiff.spec */
	void (*exact)(quad t, quad *y);
	/* scale of velocities where ends of units have no larger: van der Pol's jump, 4/3 mu, falls between them */
	double least_v;
	const char *steps[3], *spec;            /* to take, NULL at the end; with options */
	long most_evaluations;
} cases[] = {
	{ "stiff van der Pol", 0.1, 1000, 1000, 0, false, NULL, 133, { "0.1", "0.01" },
	  "models/vanderpol_stiff.spec", 5000000 },
	{ "stiff spring", 0.125, 800, 80, 0, true, NULL, 0, { "1/8", "1/128" }, SPECS "stiff_spring.spec", 20000000 },
	{ "resonance", 0.125, 8000, 800, 10, true, NULL, 0, { "1/128" }, SPECS "resonance.spec", 5000000 },
	{ "resonance, 1e-9 off", 0.125, 8000, 800, 10 + 1e-9, true, NULL, 0, { "1/128" },
	  SPECS "resonance.spec -D off=1e-9", 5000000 },
	{ "equal poles", 0.125, 8000, 800, 0, true, NULL, 0, { "1/128" }, SPECS "confluent.spec", 5000000 },
	{ "poles 1e-10 apart", 0.125, 8000, 800, 0, true, poles_apart, 0, { "1/128" },
	  SPECS "confluent.spec -D w2=10.0000000001", 5000000 },
	{ "critical damping", 0.125, 80, 80, 0, true, NULL, 0, { "1/128" }, SPECS "critical.spec", 5000000 },
	{ "rigid body", 0.125, 8000, 800, 0, true, NULL, 0, { "1/128" }, SPECS "rigid.spec", 5000000 },
	{ "long run", 1, 9766, 98, 0, true, NULL, 0, { "1/1024" }, "models/scs.spec", 200000000 },
	{ "grazing contact", 0.125, 800, 800, 0, false, graze, 0, { "1/128" }, SPECS "graze.spec", 5000000 },
	{ "poles -1e8 and -1e-3", 1024, 8, 8, 0, true, NULL, 1e-3, { "1024" }, SPECS "fast_slow.spec", 5000000 },
	{ "the same, long step", 1048576, 8, 8, 0, true, NULL, 1e-3, { "1048576" }, SPECS "fast_slow.spec", 5000000 },
};
static const double tolerance = 1e-10;          /* of adaptive methods */

enum { CASES = sizeof cases / sizeof *cases };
/* The equations, which are ours no further, then what is tried of them at each step */
static const struct { const char *name, *options; bool of_remainder; } ours[] = {
	{ "problem", "", false }, { "exact", "--scheme exact", false },
	{ "exact, compensated", "--scheme exact --accuracy compensated", false },
	{ "exact, float", "--scheme exact --real float", false }, { "pl", "--scheme pl", false },
	{ "etd1", "--scheme etd1", true }, { "etdrk2", "--scheme etdrk2", true }, { "etdrk4", "--scheme etdrk4", true },
	{ "bm3", "--scheme bm3", true },
};
enum { OURS_COUNT = sizeof ours / sizeof *ours };

/* NULL: there is no remainder for it */
static const char *file_of(const struct hard_case *c, int step, int k)
{
	return c->linear && ours[k].of_remainder ? NULL : text("hard%d_%d_%d.so", (int)(c - cases), step, k);
}

static void list(bool problems)
{
	for (const struct hard_case *c = cases; c < cases + CASES; c++)
		for (int i = 0; c->steps[i]; i++)
			for (int k = i > 0; k < (problems ? 1 : OURS_COUNT); k++)
				if (file_of(c, i, k))
					printf("%s %s %s --step %s\n", file_of(c, i, k), c->spec, ours[k].options,
					       c->steps[i]);
}

/* What is true at the ends of units; and the problem's scales, which are the history's */
static struct truth *history_of(const struct hard_case *c, struct problem *p)
{
	struct truth *t = c->linear || c->exact ? truth_new(p) : truth_of(p);
	for (int k = 0; k < t->units && c->exact; k++) {
		quad y[MOST_STATES];
		c->exact((k + 1) * (quad)c->unit, y);
		for (int i = 0; i < 2 * p->n; i++)
			t->at_end[k * 2 * p->n + i] = (double)y[i];
	}
	if (c->linear && !c->exact)
		truth_of_linear(p, t);
	if (c->linear || c->exact)
		truth_scales(p, t);
	else
		say_progress("hard: %s: two roads to what is true agree to %.2g", c->name, t->agreement);
	p->scale_v = t->scale_v = fmax(t->scale_v, c->least_v);
	return t;
}

/* ---- right-hand sides, counted: some methods on some cases would go on for days ---- */

static struct {
	const struct problem *problem;
	long left;
	jmp_buf out;
} budget;

static void counted(const void *of, double t, const double *y, double *dydt)
{
	(void)of;
	if (budget.left-- <= 0)
		longjmp(budget.out, 1);
	budget.problem->rhs(t, y, dydt);
}

/* ---- a cell of the table ---- */

struct cell { double error; const char *word; };        /* NAN where it has failed */

static struct cell cell_of_error(double error)
{
	if (!isfinite(error) || error > 10)
		return (struct cell){ NAN, "diverged" };
	return (struct cell){ error, error < 1e-3 ? "ok" : error < 0.1 ? "poor" : "wrong" };
}

/* Until the end, or to where it is hopeless */
static struct cell follow(struct run *run, const struct truth *t)
{
	double y[MOST_STATES], largest = 0;
	run->restart(run);
	for (int k = 0; k < t->units; k++) {
		const bool good = run->advance(run, 1, NULL);
		run->get(run, y);
		const double e = truth_farther(0, t, k, y);
		if (!good && isfinite(e))
			return (struct cell){ NAN, "gave up" };
		if (!(e <= largest))
			largest = e;
		if (!isfinite(largest))
			break;
	}
	return cell_of_error(largest);
}

static struct cell try_method(const struct method *m, const struct problem *p, const struct truth *t, double setting,
							  const char *file, long most_evaluations)
{
	struct problem asked = *p;
	if (m->linear_only && !p->linear)
		return (struct cell){ NAN, "linear only" };
	asked.rhs_of = counted;
	asked.rhs = NULL;
	budget.problem = p;
	budget.left = most_evaluations;
	if (setjmp(budget.out) != 0)            /* what the run held is lost */
		return (struct cell){ NAN, "gave up" };
	struct run *run = file ? generated_open(m, p, file) : m->open(m, &asked, setting);
	if (!run)
		return (struct cell){ NAN, "refused" };
	const struct cell cell = follow(run, t);
	run->close(run);
	return cell;
}

/* ---- the table ---- */

static void print_cell(FILE *out, const struct hard_case *c, const struct method *m, double setting, struct cell cell,
					   const char *settings)
{
	fprintf(out, "\"%s\",\"%s\",%s,%s,%.8g,", c->name, m->name, family_names[m->family], m->tolerance ? "tolerance"
		: "step", setting);
	put_number(out, "%.3g", cell.error, "failed");
	fprintf(out, "%s,", cell.word);
	put_quoted(out, settings);
	putc('\n', out);
	say_progress("hard: %s: %s %g: %s", c->name, m->name, setting, cell.word);
}

static void try_peer(FILE *out, const struct hard_case *c, const struct problem *p, const struct truth *t,
					 const struct method *m)
{
	for (int i = 0; c->steps[i] && !(m->tolerance && i > 0); i++) {
		const double setting = m->tolerance ? tolerance : value_of(c->steps[i]);
		print_cell(out, c, m, setting, try_method(m, p, t, setting, NULL, c->most_evaluations), m->settings);
	}
}

static void try_peers(FILE *out, const struct hard_case *c, const struct problem *p, const struct truth *t)
{
	const struct method *const *const lists[] = { fixed_methods, structural_methods, adaptive_methods,
	                                              propagator_methods };
	for (int k = 0; k < 4; k++)
		for (const struct method *const *m = lists[k]; *m; m++)
			try_peer(out, c, p, t, *m);
	try_peer(out, c, p, t, residues_naive);
}

static void try_ours(FILE *out, const struct hard_case *c, const struct problem *p, const struct truth *t, int i, int k,
					 const char *variants)
{
	const struct method m = { .name = ours[k].name, .family = OURS };
	const double step = value_of(c->steps[i]);
	if (!file_of(c, i, k)) {
		print_cell(out, c, &m, step, (struct cell){ NAN, "as exact" }, "");
		return;
	}
	char file[4096];
	snprintf(file, sizeof file, "%s/%s", variants, file_of(c, i, k));
	char *refusal = variant_refused(file);
	const struct cell cell = refusal ? (struct cell){ NAN, "refused" } : try_method(&m, p, t, step, file,
		c->most_evaluations);
	print_cell(out, c, &m, step, cell, refusal);
	free(refusal);
}

static struct problem *problem_of(const struct hard_case *c, const char *file, bool quick)
{
	return problem_load(file, c->linear || c->exact ? c->name : "vanderpol_stiff", c->unit,
	                    quick ? c->quick_units : c->units, c->linear, c->frequency);
}

int main(int argc, char **argv)
{
	const unsigned flags = flags_of(argc, &argv, "--quick --scales --list", 0, 2, "hard [--quick] VARIANTS FOLDER\n"
	                                "       hard --scales [--quick] VARIANTS\n       hard --list");
	const bool quick = flags & 1, scales = flags & 2;
	if (flags & 4) {
		list(getenv("CHARTS_PROBLEMS") != NULL);
		return 0;
	}
	gsl_set_error_handler_off();            /* its statuses say it too */
	FILE *out = scales ? stdout : table_open(argv[1], "hard_raw.csv",
		"case,method,family,setting_kind,setting,error,word,settings");
	for (const struct hard_case *c = cases; c < cases + CASES; c++) {
		struct problem *p = problem_of(c, text("%s/%s", argv[0], file_of(c, 0, 0)), quick);
		struct truth *t = history_of(c, p);
		if (scales) {
			put_scales(out, p, c->name, text("%s/%s", argv[0], file_of(c, 0, 0)));
			continue;
		}
		try_peers(out, c, p, t);
		for (int i = 0; c->steps[i]; i++)
			for (int k = 1; k < OURS_COUNT; k++)
				try_ours(out, c, p, t, i, k, argv[0]);
	}
	table_close(out, "hard_raw.csv");
	return 0;
}
