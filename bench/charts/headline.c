/* SPDX-License-Identifier: GPL-3.0-or-later */
/* headline: the two comparisons that lead the page, on scs over 1000 s with output every 0.01 s.
 *
 *   headline_integrators.csv  each integrator at the coarsest setting found that reaches an error of 1e-9 and of
 *                             1e-12: time per output; and what is exact at any step, ours and e^{A h}, at one step per
 *                             output
 *   headline_equal_step.csv   beside a precomputed e^{A h} and modal superposition at the same step: time, error,
 *                             drift of the energy
 *   headline_confluence.csv   the same methods where frequencies nearly meet: the largest error over 100 s
 *
 *     headline --list [--quick]             the variants wanted: FILE SPEC options, a line each
 *     headline --find [--quick] VARIANTS OUTDIR  what is no time: the settings, VARIANTS/settings, and the last table
 *     headline [--quick] VARIANTS OUTDIR    the first two tables, at these settings
 *
 * Errors are the largest over the whole history at the outputs, relative to the largest displacement and velocity. */
#include "charts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK = 1000, MOST_STATES = 4, MOST_ROWS = 80 };         /* units from one call; states of the models here */

struct ours { const char *name, *file, *options; };
static const struct ours ours[] = {
	{ "exact", "", "--scheme exact" }, { "exact, direct", "-direct", "--form direct" },
	{ "exact, delta", "-delta", "--form delta" }, { "exact, kick-drift-kick", "-kick", "--form kick-drift-kick" },
	{ "exact, compensated", "-compensated", "--accuracy compensated" },
	{ "exact, float", "-float", "--real float" },
};
enum { OURS_COUNT = sizeof ours / sizeof *ours };

/* Frequencies 10 and 10 (1 + gap) rad/s. Twins: scs whose masses hardly feel each other; its modes stay apart however
 * near the frequencies. One-way: the first mass drives the second and feels nothing; the modes become one, and A
 * defective at gap 0. */
static const struct meeting { const char *gap, *twins, *one_way; } meetings[] = {
	{ "1e-4", "k2=1e-2", "w2=10.001" }, { "1e-6", "k2=1e-4", "w2=10.00001" },
	{ "1e-8", "k2=1e-6", "w2=10.0000001" },
	{ "1e-10", "k2=1e-8", "w2=10.000000001" }, { "0", "k2=0", "w2=10" }
};
enum { MEETINGS = sizeof meetings / sizeof *meetings };

static void list_one(const char *base, const char *spec, const char *options)
{
	for (int i = 0; i < OURS_COUNT; i++)
		printf("%s%s.so %s --step 1/100 %s%s\n", base, ours[i].file, spec, ours[i].options, options);
}

static void list(void)
{
	list_one("scs", "models/scs.spec", "");
	for (const struct meeting *m = meetings; m < meetings + MEETINGS; m++) {
		list_one(text("twins-%s", m->gap), "models/scs.spec", text(" -D %s", m->twins));
		list_one(text("one-way-%s", m->gap), "bench/charts/specs/confluent.spec", text(" -D %s", m->one_way));
	}
}

/* ---- errors at outputs ---- */

/* The largest, of rows as a user takes them, many from one call; INFINITY where the run fails */
static double error_at_outputs(struct run *run, const struct truth *t)
{
	static double rows[CHUNK * MOST_STATES];
	struct truth part = *t;
	double most = 0;
	run->restart(run);
	for (int k = 0; k < t->units && isfinite(most); k += CHUNK) {
		part.units = t->units - k < CHUNK ? t->units - k : CHUNK;
		part.at_end = t->at_end + (ptrdiff_t)k * 2 * t->n;
		const double error = run->advance(run, part.units, rows) ? truth_error(&part, rows) : INFINITY;
		most = error <= most ? most : error;
	}
	return isfinite(most) ? most : INFINITY;
}

static double error_with(const struct method *method, const struct problem *p, const struct truth *t, double setting)
{
	struct run *run = method->open(method, p, setting);
	double error = run ? error_at_outputs(run, t) : INFINITY;
	if (run)
		run->close(run);
	say_progress("%s, %g: error %.3g", method->name, setting, error);
	return error;
}

/* ---- the setting that reaches an error ---- */

/* estimate: parts of a unit it would take, where too many */
struct found { double setting, error; bool reached; double estimate; };

/* Tolerances, ten to the decade: bisection between one that does not reach it and one that does. Near the end of
 * double precision errors are not monotonic, so that first every decade is asked. */
static struct found find_tolerance(const struct method *method, const struct problem *p, const struct truth *t,
								   double target)
{
	enum { COARSEST = 40, FINEST = 150, DECADE = 10 };
	struct found best = { 0, INFINITY, false, 0 };
	int reaches = 0;
	for (int k = target < 1e-10 ? 110 : 80; k <= FINEST && !reaches; k += DECADE) {
		double setting = pow(10, -k / 10.0), error = error_with(method, p, t, setting);
		if (error < best.error)
			best = (struct found){ setting, error, error <= target, 0 };
		reaches = error <= target ? k : 0;
	}
	for (int low = COARSEST, high = reaches; reaches && high - low > 1;) {
		int k = high - low > 2 * DECADE ? high - DECADE : (low + high) / 2;
		double setting = pow(10, -k / 10.0), error = error_with(method, p, t, setting);
		if (error <= target)
			best = (struct found){ setting, error, true, 0 };
		*(error <= target ? &high : &low) = k;
	}
	return best;
}

/* Parts of a unit: from the error with some and the order follows how many it takes; from there one down as long as
 * that does, or up. */
static struct found find_step(const struct method *method, const struct problem *p, const struct truth *t,
							  double target, int most)
{
	struct found best = { 0, INFINITY, false, 0 };
	int low = 0, high = 0, parts = 1;
	for (int tries = 0; tries < 12 && !high; tries++) {
		double error = error_with(method, p, t, p->unit / parts);
		if (error <= target) {
			high = parts;
			best = (struct found){ p->unit / parts, error, true, 0 };
			break;
		}
		if (error < best.error)
			best = (struct found){ p->unit / parts, error, false, 0 };
		else if (tries > 0 && low >= 16)
			return best;                    /* finer steps only add rounding */
		low = parts;
		double wanted = isfinite(error) && error < 0.1 ? parts * pow(error / target, 1.0 / method->order)
		                : 4.0 * parts;
		if (wanted > most) {
			best.estimate = error < 0.1 ? wanted : 0;
			return best;
		}
		parts = (int)fmax(parts + 1, ceil(1.02 * wanted));
	}
	while (high - low > 1 && high - low > high / 50) {
		parts = (low + high) / 2;
		double error = error_with(method, p, t, p->unit / parts);
		if (error <= target)
			best = (struct found){ p->unit / parts, error, true, 0 };
		*(error <= target ? &high : &low) = parts;
	}
	return best;
}

/* ---- rows of all three tables ---- */

struct row {
	const struct method *method;
	double target;
	struct found found;
	char *refused;
	struct run *run;
	double drift, long_drift;
	struct samples samples;
};
struct rows { int count; struct row row[MOST_ROWS]; struct method ours[OURS_COUNT]; };
#define EACH_ROW(rows) struct row *row = (rows)->row; row < (rows)->row + (rows)->count; row++

static struct row *add_row(struct rows *rows, const struct method *method, struct run *run)
{
	struct row *row = &rows->row[rows->count++];
	*row = (struct row){ .method = method, .run = run };
	return row;
}

/* What is exact at any step, a step an output: matrices of a step, then ours */
static void add_exact(struct rows *rows, const struct problem *p, const char *folder, const char *base)
{
	for (const struct method *const *m = propagator_methods; *m; m++)
		add_row(rows, *m, (*m)->open(*m, p, p->unit));
	for (int i = 0; i < OURS_COUNT; i++) {
		const char *file = text("%s/%s%s.so", folder, base, ours[i].file);
		rows->ours[i] = (struct method){ .name = ours[i].name, .family = OURS, .settings = ours[i].options };
		struct row *row = add_row(rows, &rows->ours[i], NULL);
		row->refused = variant_refused(file);
		row->run = row->refused ? NULL : generated_open(row->method, p, file);
	}
}

static void close_rows(struct rows *rows)
{
	for (EACH_ROW(rows)) {
		if (row->run)
			row->run->close(row->run);
		free(row->refused);
	}
}

static void sample_rows(struct rows *rows, double seconds)
{
	struct run *run[MOST_ROWS];
	struct samples samples[MOST_ROWS], *next = samples;
	int count = 0;
	for (EACH_ROW(rows))
		if (row->run)
			run[count++] = row->run;
	say_progress("scs: time");
	sample_runs(count, run, seconds, samples);
	for (EACH_ROW(rows))
		if (row->run)
			row->samples = *next++;
}

static void put_times(FILE *out, const struct row *row, double of_exact)
{
	const struct samples *s = &row->samples;
	if (s->count == 0)
		fputs("none,none,none,none,none,", out);
	else
		fprintf(out, "%.4g,%.4g,%.4g,%d,%.4g,", s->min, s->median, s->max, s->count, s->median / of_exact);
	put_quoted(out, row->refused ? row->refused : row->method->settings);
	putc('\n', out);
}

/* ---- the first table ---- */

static const double targets[] = { 1e-9, 1e-12 };

/* What no tolerance has reached, none reaches: of the same method with another target */
static const struct found *found_before(const struct rows *rows, const struct method *method)
{
	for (int i = 0; i < rows->count - 1; i++)
		if (rows->row[i].method == method)
			return &rows->row[i].found;
	return NULL;
}

static void look_for(struct rows *rows, const struct method *const *methods, const struct problem *p,
					 const struct truth *t, double target, int most)
{
	for (; *methods; methods++) {
		struct row *row = add_row(rows, *methods, NULL);
		const struct found *looser = found_before(rows, *methods);
		row->target = target;
		if (!(*methods)->tolerance)
			row->found = find_step(*methods, p, t, target, most);
		else
			row->found = looser && !looser->reached ? *looser : find_tolerance(*methods, p, t, target);
	}
}

/* VARIANTS/settings: target, setting, error, whether it is reached, estimate, method; the same bytes whenever it is
 * written */
static void find_settings(const struct problem *p, const struct truth *t, const char *variants, bool quick)
{
	static struct rows rows;
	for (int k = 0; k < 2; k++) {
		look_for(&rows, fixed_methods, p, t, targets[k], quick ? 64 : 1024);
		look_for(&rows, adaptive_methods, p, t, targets[k], quick ? 64 : 1024);
	}
	FILE *out = file_in(variants, "settings", "w");
	for (EACH_ROW(&rows))
		fprintf(out, "%g %.17g %.17g %d %.17g %s\n", row->target, row->found.setting, row->found.error,
		        row->found.reached, row->found.estimate, row->method->name);
	table_close(out, "settings");
}

static void read_settings(struct rows *rows, const struct problem *p, const char *variants)
{
	FILE *in = file_in(variants, "settings", "r");
	char name[100];
	int reached;
	double target;
	struct found f = { 0 };
	while (fscanf(in, "%lf %lf %lf %d %lf %99[^\n]", &target, &f.setting, &f.error, &reached, &f.estimate,
		name) == 6) {
		struct row *row = add_row(rows, method_find(name), NULL);
		row->target = target;
		f.reached = reached;
		row->found = f;
		if (reached && row->method)
			row->run = row->method->open(row->method, p, f.setting);
		if (!row->method || (reached && !row->run))
			leave(name, "has settings, and is not there");
	}
	fclose(in);
}

static void put_row(FILE *out, const struct row *row, double of_exact)
{
	const struct found *f = &row->found;
	fprintf(out, "%.0e,", row->target);
	put_quoted(out, row->method->name);
	fprintf(out, ",%s,%s,%.6g,", family_names[row->method->family], row->method->tolerance ? "tolerance" : "step",
		f->setting);
	put_number(out, "%.4g", f->error, "failed");
	fputs(f->reached ? "reached," : "not reached,", out);
	put_number(out, "%.2g", f->estimate > 0 ? f->estimate : NAN, "none");
	put_times(out, row, of_exact);
}

/* What takes one step per output: what it reaches, a row for each target; its time stands in both. In float none comes
 * near these errors; the next table has them */
static void add_targets(struct rows *rows, struct rows *exact, const struct truth *t, double unit)
{
	for (EACH_ROW(exact)) {
		if (!row->run || strstr(row->method->name, "float"))
			continue;
		const double error = error_at_outputs(row->run, t);
		for (int k = 0; k < 2; k++) {
			struct row *to = add_row(rows, row->method, k == 0 ? row->run : NULL);
			to->target = targets[k];
			to->found = (struct found){ unit, error, error <= targets[k], 0 };
		}
	}
}

static void integrators(const struct problem *p, const struct truth *t, const char *variants, const char *folder,
						bool quick)
{
	static struct rows rows, exact;
	double of_exact = NAN;
	read_settings(&rows, p, variants);
	add_exact(&exact, p, variants, "scs");
	add_targets(&rows, &exact, t, p->unit);
	sample_rows(&rows, quick ? 1 : 20);
	for (EACH_ROW(&rows)) {
		if (!row->run && row > rows.row && row->method == row[-1].method && row->found.setting == p->unit)
			row->samples = row[-1].samples;
		if (row->method == &exact.ours[0] && row->run)
			of_exact = row->samples.median;
	}
	FILE *out = table_open(folder, "headline_integrators.csv",
		"target,method,family,setting_kind,setting,error,reached,parts_estimated,ns_min,ns_median,ns_max,"
		"ns_samples,ns_over_exact,settings");
	for (EACH_ROW(&rows))
		put_row(out, row, of_exact);
	table_close(out, "headline_integrators.csv");
	close_rows(&exact);
}

/* ---- the second table ---- */

/* Of scs: masses 1, springs 100 */
static double energy(const double *y)
{
	const long double x1 = y[0], x2 = y[1], v1 = y[2], v2 = y[3];
	return (double)((v1 * v1 + v2 * v2) / 2 + 50 * (x1 * x1 + (x2 - x1) * (x2 - x1) + x2 * x2));
}

static double drift(struct run *run, int units)
{
	double y[MOST_STATES];
	run->restart(run);
	run->get(run, y);
	const double start = energy(y);
	if (!run->advance(run, units, NULL))
		return NAN;
	run->get(run, y);
	return (energy(y) - start) / start;
}

static void put_found(FILE *out, const struct row *row, double value)
{
	put_number(out, "%.4g", row->run ? value : NAN, row->refused ? "refused" : row->run ? "failed" : "cannot");
}

static void equal_step(const struct problem *p, const struct truth *t, const char *variants, const char *folder,
					   bool quick)
{
	static struct rows rows;
	const int long_steps = quick ? 1000000 : 10000000;
	double of_exact = NAN;
	add_exact(&rows, p, variants, "scs");
	for (EACH_ROW(&rows)) {
		if (!row->run)
			continue;
		say_progress("scs: drift of %s", row->method->name);
		row->found.error = error_at_outputs(row->run, t);
		row->drift = drift(row->run, t->units);
		row->long_drift = drift(row->run, long_steps);
	}
	sample_rows(&rows, quick ? 0.5 : 5);
	FILE *out = table_open(folder, "headline_equal_step.csv",
		"method,family,step,error,energy_drift,energy_drift_long,long_steps,ns_min,ns_median,ns_max,"
		"ns_samples,ns_over_exact,settings");
	for (EACH_ROW(&rows))
		if (row->method == &rows.ours[0] && row->run)
			of_exact = row->samples.median;
	for (EACH_ROW(&rows)) {
		put_quoted(out, row->method->name);
		fprintf(out, ",%s,%g,", family_names[row->method->family], p->unit);
		put_found(out, row, row->found.error);
		put_found(out, row, row->drift);
		put_found(out, row, row->long_drift);
		fprintf(out, "%d,", long_steps);
		put_times(out, row, of_exact);
	}
	table_close(out, "headline_equal_step.csv");
	close_rows(&rows);
}

/* ---- the third ---- */

static void meet(FILE *out, const char *kind, const char *gap, const char *variants)
{
	static struct rows rows;
	char base[100];         /* the problem's name for as long as it is there */
	snprintf(base, sizeof base, "%s-%s", kind, gap);
	struct problem *p = problem_load(text("%s/%s.so", variants, base), base, 0.01, 10000, true, 0);
	struct truth *t = truth_of(p);
	rows.count = 0;
	add_exact(&rows, p, variants, base);
	for (EACH_ROW(&rows)) {
		fprintf(out, "%s,%s,", kind, gap);
		put_quoted(out, row->method->name);
		fprintf(out, ",%s,", family_names[row->method->family]);
		put_found(out, row, row->run ? error_at_outputs(row->run, t) : NAN);
		fprintf(out, "%.2g\n", t->agreement);
	}
	close_rows(&rows);
	truth_free(t);
	problem_free(p);
}

int main(int argc, char **argv)
{
	const unsigned flags = flags_of(argc, &argv, "--quick --find --list", 0, 2,
	                                "headline --list\n       headline [--find] [--quick] VARIANTS OUTDIR");
	const bool quick = flags & 1;
	if (flags & 4) {
		list();
		return 0;
	}
	struct problem *p = problem_load(text("%s/scs.so", argv[0]), "scs", 0.01, quick ? 10000 : 100000, true, 0);
	struct truth *t = truth_of(p);
	fprintf(stderr, "\ntwo roads to the truth agree to %.2g\n", t->agreement);
	if (flags & 2) {
		find_settings(p, t, argv[0], quick);
		FILE *out = table_open(argv[1], "headline_confluence.csv",
		                       "case,gap,method,family,error,truth_agreement");
		for (int i = 0; i < 2 * MEETINGS; i++)
			meet(out, i < MEETINGS ? "twins" : "one-way", meetings[i % MEETINGS].gap, argv[0]);
		table_close(out, "headline_confluence.csv");
	} else {
		integrators(p, t, argv[0], argv[1], quick);
		equal_step(p, t, argv[0], argv[1], quick);
	}
	truth_free(t);
	problem_free(p);
	return 0;
}
