/* SPDX-License-Identifier: GPL-3.0-or-later */
/* methods VARIANTS: the methods that the charts compare are what they are called: those with a fixed step have their order, on an
 * equation that is not linear and on linear ones; plgen's exact step has no error but rounding. VARIANTS: what methods.sh made. */
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
	ok(close_to(order, expected, order_tolerance, "errors %.6g and %.6g: order", coarse, fine), "%s on %s: order %g", name, model, expected);
}

/* Parts of a unit where errors fall as their order says: small enough, and far above rounding */
static int parts_for(int order)
{
	return order == 1 ? 512 : order == 2 ? 32 : order == 4 ? 8 : 1;
}

static void check_fixed(const struct problem *p)
{
	const struct truth *truth = truth_of(p);
	for (const struct method *const *m = fixed_methods; *m; m++) {
		const int parts = parts_for((*m)->order);
		struct run *coarse = (*m)->open(*m, p, p->unit / parts), *fine = (*m)->open(*m, p, p->unit / (2 * parts));
		check_order((*m)->name, p->name, (*m)->order, error_at_ends(coarse, truth), error_at_ends(fine, truth));
	}
}

static struct run *open_variant(const struct method *m, const struct problem *p, const char *folder, const char *name, int parts)
{
	char file[4096];
	snprintf(file, sizeof file, "%s/%s-%s-%d.so", folder, name, m->name, parts);
	return generated_open(m, p, file);
}

static void check_schemes(const struct problem *p, const char *folder, const char *name)
{
	static const struct { struct method method; int parts; } schemes[] = {
		{ { .name = "pl", .family = OURS, .order = 1 }, 256 }, { { .name = "etd1", .family = OURS, .order = 1 }, 256 },
		{ { .name = "etdrk2", .family = OURS, .order = 2 }, 32 }, { { .name = "etdrk4", .family = OURS, .order = 4 }, 8 },
		{ { .name = "nc2", .family = OURS, .order = 4 }, 8 }, { { .name = "nc3", .family = OURS, .order = 4 }, 8 },
		{ { .name = "dq4", .family = OURS, .order = 4 }, 8 }, { { .name = "bm3", .family = OURS, .order = 4 }, 8 },
	};
	const struct truth *truth = truth_of(p);
	for (size_t k = 0; k < sizeof schemes / sizeof *schemes; k++) {
		const struct method *m = &schemes[k].method;
		if (p->linear && strcmp(m->name, "pl") != 0)
			continue;
		struct run *coarse = open_variant(m, p, folder, name, schemes[k].parts), *fine = open_variant(m, p, folder, name, 2 * schemes[k].parts);
		check_order(m->name, p->name, m->order, error_at_ends(coarse, truth), error_at_ends(fine, truth));
	}
}

/* 30 s, at outputs and between */
static void check_exact(const struct problem *p, const char *folder, const char *name)
{
	static const struct method exact = { .name = "exact", .family = OURS };
	const struct truth *truth = truth_of(p);
	struct run *run = open_variant(&exact, p, folder, name, 1);
	const struct error e = run ? error_of(run, truth) : (struct error){ .failed = true };
	ok(close_to(e.failed ? NAN : e.largest, 0, 1e-11, "largest error of exact on %s", name), "exact on %s: below 1e-11 over 30 s", name);
	if (run)
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
	struct problem *pendulum = load(folder, "pendulum", 0.4, 10, false, 0), *forced = load(folder, "sdcsf", 0.2, 10, true, 5);
	check_fixed(pendulum);
	check_fixed(forced);
	check_schemes(pendulum, folder, "pendulum");
	check_schemes(load(folder, "scs", 0.2, 3, true, 0), folder, "scs");
	check_exact(load(folder, "scs", 0.01, 3000, true, 0), folder, "scs");
	check_exact(load(folder, "sdcs", 0.01, 3000, true, 0), folder, "sdcs");
	check_exact(load(folder, "sdcsf", 0.01, 3000, true, 5), folder, "sdcsf");
	check_exact(load(folder, "scs_weak", 0.01, 3000, true, 0), folder, "scs_weak");
	check_exact(load(folder, "linear2dof", 0.2, 150, true, 0), folder, "linear2dof");
	check_exact(load(folder, "tuned_floor", 0.01, 3000, true, 4 * M_PI), folder, "tuned_floor");
	check_exact(load(folder, "quarter_car", 0.001, 30000, true, 0), folder, "quarter_car");
	return tap_end();
}
