/* SPDX-License-Identifier: GPL-3.0-or-later */
/* methods VARIANTS: the methods that the charts compare are what they are called: those with a fixed step have their
 * order, on an equation that is not linear and on linear ones; plgen's exact step has no error but rounding. And what
 * is timed is whole histories. VARIANTS: what methods.sh made. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "charts.h"
#include "tap.h"

static const double order_tolerance = 0.15;

/* Not a number where it fails, or could not be opened */
static double error_at_ends(struct run *run, const struct truth *truth)
{
	if (!run)
		return NAN;
	const struct error e = error_of(run, truth);
	run->close(run);
	return e.failed ? NAN : fmax(e.q_end, e.v_end);
}

/* From the errors with two steps, the second half the first */
static void check_order(const char *name, const char *model, double expected, double coarse, double fine)
{
	const double order = log2(coarse / fine);
		ok(close_to(order, expected, order_tolerance, "errors %.6g and %.6g: order", coarse, fine),
		   "%s on %s: order %g", name, model, expected);
}

/* Parts of a unit where errors fall as their order says: small enough, and far above rounding */
static int parts_for(int order)
{
	return order == 1 ? 512 : order == 2 ? 32 : order == 4 ? 8 : 1;
}

/* CR and KR-alpha are of second order only from rest under a load that sets in smoothly */
static int order_of(const struct method *m, const struct problem *p)
{
	const bool lags = strcmp(m->name, "CR") == 0 || strncmp(m->name, "KR", 2) == 0;
	return lags && p->start[0] != 0 ? 1 : m->order;
}

static void check_fixed(struct problem *p, const struct method *const *methods)
{
	const struct truth *truth = truth_of(p);
	for (const struct method *const *m = methods; *m; m++) {
		const int order = order_of(*m, p), parts = parts_for(order);
		struct run *coarse = (*m)->open(*m, p, p->unit / parts),
			*fine = (*m)->open(*m, p, p->unit / (2 * parts));
		check_order((*m)->name, p->name, order, error_at_ends(coarse, truth), error_at_ends(fine, truth));
	}
}

static struct run *open_variant(const struct method *m, const struct problem *p, const char *folder, const char *name,
	int parts)
{
	char file[4096];
	snprintf(file, sizeof file, "%s/%s-%s-%d.so", folder, name, m->name, parts);
	return generated_open(m, p, file);
}

static void check_schemes(struct problem *p, const char *folder, const char *name)
{
	static const struct { struct method method; int parts;
		} schemes[] = {
			{ { .name = "pl", .family = OURS, .order = 1 }, 256 },
			{ { .name = "etd1", .family = OURS, .order = 1 }, 256 },
			{ { .name = "etdrk2", .family = OURS, .order = 2 }, 32 },
			{ { .name = "etdrk4", .family = OURS, .order = 4 }, 8 },
			{ { .name = "nc2", .family = OURS, .order = 4 }, 8 },
			{ { .name = "nc3", .family = OURS, .order = 4 }, 8 },
			{ { .name = "dq4", .family = OURS, .order = 4 }, 8 },
			{ { .name = "bm3", .family = OURS, .order = 4 }, 8 },
		};
		const struct truth *truth = truth_of(p);
	for (size_t k = 0; k < sizeof schemes / sizeof *schemes; k++) {
		const struct method *m = &schemes[k].method;
		if (p->linear && strcmp(m->name, "pl") != 0)
			continue;
		struct run *coarse = open_variant(m, p, folder, name, schemes[k].parts),
			*fine = open_variant(m, p, folder, name, 2 * schemes[k].parts);
		check_order(m->name, p->name, m->order, error_at_ends(coarse, truth), error_at_ends(fine, truth));
	}
}

/* 30 s, at outputs and between */
static void check_exact(struct problem *p, const char *folder, const char *name)
{
	static const struct method exact = { .name = "exact", .family = OURS };
	const struct truth *truth = truth_of(p);
	struct run *run = open_variant(&exact, p, folder, name, 1);
	const struct error e = run ? error_of(run, truth) : (struct error){ .failed = true };
	ok(close_to(e.failed ? NAN : e.largest, 0, 1e-11, "largest error of exact on %s", name),
		"exact on %s: below 1e-11 over 30 s", name);
	if (run)
		run->close(run);
}

/* ---- what is timed ---- */

/* A run that does nothing but keep where it is. Its first units take no time, its last ones do: those are what a sample
 * must not miss. */
struct walk {
	struct run run;
	int now;                    /* units since the start */
	int passes, whole;          /* begun, and gone to the end */
};

static void walk_restart(struct run *run)
{
	struct walk *w = (struct walk *)run;
	w->whole += w->now == run->problem->units;
	w->passes++;
	w->now = 0;
}

static bool walk_advance(struct run *run, int units, double *rows)
{
	struct walk *w = (struct walk *)run;
	volatile double x = 1;
	for (int k = 0; k < units; k++) {
		for (int i = 0; 10 * w->now > 9 * run->problem->units && i < 20000; i++)
			x = x * 1.0000001;
		rows[2 * k] = rows[2 * k + 1] = x;
		w->now++;
	}
	return true;
}

static void check_walk(int units)
{
	const struct problem p = { .name = "walk", .n = 1, .unit = 1, .units = units };
	struct walk w = { .run = { .problem = &p, .restart = walk_restart, .advance = walk_advance } };
	struct run *run = &w.run;
	struct samples samples;
	sample_runs(1, &run, 0, &samples);
	walk_restart(run);
	ok(w.passes > 3 && close_to(w.whole, w.passes - 1, 0, "%d units: passes to the end, of those begun", units),
	   "samples go through all of %d units", units);
	ok(samples.count >= 3, "%d samples of %d units, at least 3", samples.count, units);
}

/* Right-hand sides of the last sample, from its start on, against those of a pass a unit at a time: a history whose
 * jumps cost most of it. Of its first tenth for comparison */
static void check_evaluations(const struct problem *p, const char *name)
{
	const struct method *m = method_find(name);
	struct run *run = m->open(m, p, 1e-8);
	struct samples samples;
	run->restart(run);
	run->advance(run, p->units / 10, NULL);
	const long tenth = run->evaluations(run);
	for (int k = p->units / 10; k < p->units; k++)
		run->advance(run, 1, NULL);
	const long whole = run->evaluations(run);
	sample_runs(1, &run, 0, &samples);
		ok(close_to((double)run->evaluations(run), (double)whole, 0, "right-hand sides of a sample of %s",
				name),
		   "a sample of %s on %s evaluates what the history does: %ld (its first tenth: %ld)", name, p->name,
		whole,
		   tenth);
		run->close(run);
}

static struct problem *load(const char *folder, const char *name, double unit, int units, bool linear, double w)
{
	char file[4096];
	snprintf(file, sizeof file, "%s/%s.so", folder, name);
	return problem_load(file, name, unit, units, linear, w);
}

int main(int argc, char **argv)
{
	if (argc != 2) {
		fputs("usage: methods VARIANTS\n", stderr);
		return 2;
	}
	const char *folder = argv[1];
	struct problem *pendulum = load(folder, "pendulum", 0.4, 10, false, 0),
		*forced = load(folder, "sdcsf", 0.2, 10, true, 5);
	check_fixed(pendulum, fixed_methods);
	check_fixed(forced, fixed_methods);
	check_fixed(forced, structural_methods);
	check_fixed(forced, structural_others);
	check_schemes(pendulum, folder, "pendulum");
	check_schemes(load(folder, "scs", 0.2, 3, true, 0), folder, "scs");
	check_exact(load(folder, "scs", 0.01, 3000, true, 0), folder, "scs");
	check_exact(load(folder, "sdcs", 0.01, 3000, true, 0), folder, "sdcs");
	check_exact(load(folder, "sdcsf", 0.01, 3000, true, 5), folder, "sdcsf");
	check_exact(load(folder, "scs_weak", 0.01, 3000, true, 0), folder, "scs_weak");
	check_exact(load(folder, "linear2dof", 0.2, 150, true, 0), folder, "linear2dof");
	check_exact(load(folder, "tuned_floor", 0.01, 3000, true, 4 * M_PI), folder, "tuned_floor");
	check_exact(load(folder, "quarter_car", 0.001, 30000, true, 0), folder, "quarter_car");
	check_walk(10);
	check_walk(1000);
	check_walk(2500);
	struct problem *jumps = load(folder, "vanderpol_stiff", 0.1, 2000, false, 0);
	truth_free(truth_of(jumps));
	check_evaluations(jumps, "CVODE BDF");
	check_evaluations(jumps, "CVODE Adams");
	check_evaluations(jumps, "GSL rk8pd");
	return tap_end();
}
