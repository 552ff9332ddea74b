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

enum { CHUNK = 1000, MOST_STATES = 4 };         /* units from one call; states of the models here */

struct ours { const char *name, *file, *options; };
static const struct ours ours[] = {
	{ "exact", "exact", "--scheme exact" },
	{ "exact, direct", "direct", "--form direct" },
	{ "exact, delta", "delta", "--form delta" },
	{ "exact, kick-drift-kick", "kick", "--form kick-drift-kick" },
	{ "exact, compensated", "compensated", "--accuracy compensated" },
	{ "exact, float", "float", "--real float" },
};
enum { OURS_COUNT = sizeof ours / sizeof *ours };

/* Frequencies 10 and 10 (1 + gap) rad/s. Twins: scs whose masses hardly feel each other; its modes stay apart however
 * near the frequencies. One-way: the first mass drives the second and feels nothing; the modes become one, and A
 * defective at gap 0. */
struct meeting { const char *gap, *twins, *one_way; };
static const struct meeting meetings[] = {
	{ "1e-4", "k2=1e-2", "w2=10.001" }, { "1e-6", "k2=1e-4", "w2=10.00001" },
	{ "1e-8", "k2=1e-6", "w2=10.0000001" },
	{ "1e-10", "k2=1e-8", "w2=10.000000001" }, { "0", "k2=0", "w2=10" }
};
enum { MEETINGS = sizeof meetings / sizeof *meetings };

static void list_one(const char *base, const char *spec, const char *options)
{
	printf("%s.so %s --step 1/100 --scheme exact%s\n", base, spec, options);
	for (int i = 1; i < OURS_COUNT; i++)
		printf("%s-%s.so %s --step 1/100 %s%s\n", base, ours[i].file, spec, ours[i].options, options);
}

static void list(void)
{
	char base[100], options[100];
	list_one("scs", "models/scs.spec", "");
	for (int i = 0; i < MEETINGS; i++) {
		snprintf(base, sizeof base, "twins-%s", meetings[i].gap);
		snprintf(options, sizeof options, " -D %s", meetings[i].twins);
		list_one(base, "models/scs.spec", options);
		snprintf(base, sizeof base, "one-way-%s", meetings[i].gap);
		snprintf(options, sizeof options, " -D %s", meetings[i].one_way);
		list_one(base, "bench/charts/specs/confluent.spec", options);
	}
}

/* ---- errors at outputs ---- */

/* The largest error at the outputs; INFINITY where the run fails */
static double error_at_outputs(struct run *run, const struct truth *t)
{
	static double rows[CHUNK * MOST_STATES];
	const int size = 2 * t->n;
	double most = 0;
	run->restart(run);
	for (int k = 0; k < t->units; k += CHUNK) {
		const int units = t->units - k < CHUNK ? t->units - k : CHUNK;
		if (!run->advance(run, units, rows))
			return INFINITY;
		for (int i = 0; i < units * size; i++) {
			const double off = fabs(rows[i] - t->at_end[k * size + i]) / (i % size < t->n ? t->scale_q
				: t->scale_v);
			if (!isfinite(off))
				return INFINITY;
			most = fmax(most, off);
		}
	}
	return most;
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
		if (error <= target)
			reaches = k;
	}
	if (!reaches)
		return best;
	for (int low = COARSEST, high = reaches; high - low > 1;) {
		int k = high - low > 2 * DECADE ? high - DECADE : (low + high) / 2;
		double setting = pow(10, -k / 10.0), error = error_with(method, p, t, setting);
		if (error <= target) {
			best = (struct found){ setting, error, true, 0 };
			high = k;
		} else {
			low = k;
		}
	}
	return best;
}

/* Parts of a unit: from the error with some and the order follows how many it takes; from there one down as long as
 * that does, or up. */
static struct found find_step(const struct method *method, const struct problem *p, const struct truth *t,
                              double target, int most)
{
	const double unit = p->unit;
	struct found best = { 0, INFINITY, false, 0 };
	int low = 0, high = 0, parts = 1;
	for (int tries = 0; tries < 12 && !high; tries++) {
		double error = error_with(method, p, t, unit / parts);
		if (error <= target) {
			high = parts;
			best = (struct found){ unit / parts, error, true, 0 };
			break;
		}
		if (error < best.error)
			best = (struct found){ unit / parts, error, false, 0 };
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
		double error = error_with(method, p, t, unit / parts);
		if (error <= target) {
			best = (struct found){ unit / parts, error, true, 0 };
			high = parts;
		} else {
			low = parts;
		}
	}
	return best;
}

/* ---- the first table ---- */

struct row {
	const struct method *method;
	double target;
	struct found found;
	struct run *run;
	struct samples samples;
};

struct rows { struct row row[80]; int count; };

static const char *const families[] = { "ours", "fixed", "adaptive", "propagator" };

/* What no tolerance has reached, none reaches: of the same method with another target */
static const struct found *found_before(const struct rows *rows, const struct method *method)
{
	for (int i = 0; i < rows->count - 1; i++)
		if (rows->row[i].method == method)
			return &rows->row[i].found;
	return NULL;
}

/* VARIANTS/settings: target, method, setting, error, whether it is reached, estimate; the same bytes whenever it is
 * written */
static FILE *open_settings(const char *variants, const char *mode)
{
	char path[4096];
	snprintf(path, sizeof path, "%s/settings", variants);
	FILE *file = fopen(path, mode);
	if (!file) {
		fprintf(stderr, "headline: %s: headline --find makes it\n", path);
		exit(1);
	}
	return file;
}

static void keep_settings(const struct rows *rows, const char *variants)
{
	FILE *out = open_settings(variants, "w");
	for (const struct row *row = rows->row; row < rows->row + rows->count; row++)
		fprintf(out, "%g %.17g %.17g %d %.17g %s\n", row->target, row->found.setting, row->found.error,
		        row->found.reached, row->found.estimate, row->method->name);
	if (ferror(out) || fclose(out) != 0) {
		fputs("headline: cannot write settings\n", stderr);
		exit(1);
	}
}

static void read_settings(struct rows *rows, const struct problem *p, const char *variants)
{
	FILE *in = open_settings(variants, "r");
	char name[100];
	int reached;
	for (;;) {
		struct row *row = &rows->row[rows->count];
		*row = (struct row){ 0 };
		if (fscanf(in, "%lf %lf %lf %d %lf %99[^\n]", &row->target, &row->found.setting, &row->found.error,
		           &reached, &row->found.estimate, name) != 6)
			break;
		row->method = method_find(name);
		row->found.reached = reached;
		if (reached && row->method)
			row->run = row->method->open(row->method, p, row->found.setting);
		if (!row->method || (reached && !row->run)) {
			fprintf(stderr, "headline: settings of %s, which is not there\n", name);
			exit(1);
		}
		rows->count++;
	}
	fclose(in);
}

static void look_for(struct rows *rows, const struct method *const *methods, const struct problem *p,
                     const struct truth *t, double target, int most)
{
	for (; *methods; methods++) {
		struct row *row = &rows->row[rows->count++];
		*row = (struct row){ .method = *methods, .target = target };
		const struct found *looser = found_before(rows, *methods);
		if (!(*methods)->tolerance)
			row->found = find_step(*methods, p, t, target, most);
		else
			row->found = looser && !looser->reached ? *looser : find_tolerance(*methods, p, t, target);
	}
}

static void sample_rows(struct rows *rows, double seconds)
{
	struct run *run[80];
	struct samples samples[80];
	int count = 0;
	for (int i = 0; i < rows->count; i++)
		if (rows->row[i].run)
			run[count++] = rows->row[i].run;
	sample_runs(count, run, seconds, samples);
	for (int i = 0, k = 0; i < rows->count; i++)
		if (rows->row[i].run)
			rows->row[i].samples = samples[k++];
}

static FILE *create(const char *folder, const char *name, const char *head)
{
	char path[4096];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *out = fopen(path, "w");
	if (!out) {
		perror(path);
		exit(1);
	}
	fputs(head, out);
	return out;
}

static void finish(FILE *out)
{
	if (ferror(out) || fclose(out) != 0) {
		fputs("headline: cannot write a table\n", stderr);
		exit(1);
	}
}

static void put_quoted(FILE *out, const char *text)
{
	putc('"', out);
	for (; text && *text; text++)
		putc(*text == '"' ? '\'' : *text, out);
	putc('"', out);
}

static void put_times(FILE *out, const struct samples *s, double of_exact)
{
	if (s->count == 0)
		fputs("none,none,none,none,none", out);
	else
		fprintf(out, "%.4g,%.4g,%.4g,%d,%.4g", s->min, s->median, s->max, s->count, s->median / of_exact);
}

static void put_row(FILE *out, const struct row *row, double of_exact)
{
	const struct found *f = &row->found;
	fprintf(out, "%.0e,", row->target);
	put_quoted(out, row->method->name);
	fprintf(out, ",%s,%s,%.6g,", families[row->method->family], row->method->tolerance ? "tolerance" : "step",
		f->setting);
	if (isfinite(f->error))
		fprintf(out, "%.4g,", f->error);
	else
		fputs("failed,", out);
	fputs(f->reached ? "reached," : "not reached,", out);
	if (f->estimate > 0)
		fprintf(out, "%.2g,", f->estimate);
	else
		fputs("none,", out);
	put_times(out, &row->samples, of_exact);
	putc(',', out);
	put_quoted(out, row->method->settings);
	putc('\n', out);
}

/* ---- ours ---- */

struct mine {
	struct method method;
	char *refused;
	struct run *run;
};

static void open_mine(struct mine *m, const struct ours *o, const struct problem *p, const char *folder,
                      const char *base)
{
	char file[4096];
	if (o == ours)
		snprintf(file, sizeof file, "%s/%s.so", folder, base);
	else
		snprintf(file, sizeof file, "%s/%s-%s.so", folder, base, o->file);
	*m = (struct mine){ .method = { .name = o->name, .family = OURS, .settings = o->options } };
	m->refused = variant_refused(file);
	m->run = m->refused ? NULL : generated_open(&m->method, p, file);
}

/* At one step per output: what it reaches, a row for each target; its time stands in both */
static void add_exact(struct rows *rows, const struct method *method, struct run *run, const struct truth *t,
                      const double targets[2])
{
	const double error = error_at_outputs(run, t);
	for (int k = 0; k < 2; k++)
		rows->row[rows->count++] = (struct row){ .method = method, .target = targets[k],
		                                         .run = k == 0 ? run : NULL,
		                                         .found = { run->problem->unit, error, error <= targets[k],
		                                                    0 } };
}

static bool is_float(const char *name)
{
	return strstr(name, "float") != NULL;
}

static const double targets[] = { 1e-9, 1e-12 };

static void find_settings(const struct problem *p, const struct truth *t, const char *variants, bool quick)
{
	static struct rows rows;
	for (int k = 0; k < 2; k++) {
		look_for(&rows, fixed_methods, p, t, targets[k], quick ? 64 : 1024);
		look_for(&rows, adaptive_methods, p, t, targets[k], quick ? 64 : 1024);
	}
	keep_settings(&rows, variants);
}

static void integrators(const struct problem *p, const struct truth *t, const char *variants, const char *folder,
                        bool quick)
{
	static struct rows rows;
	struct mine mine[OURS_COUNT];
	read_settings(&rows, p, variants);
	/* In float none comes near these errors; the next table has them */
	for (const struct method *const *m = propagator_methods; *m; m++) {
		struct run *run = is_float((*m)->name) ? NULL : (*m)->open(*m, p, p->unit);
		if (run)
			add_exact(&rows, *m, run, t, targets);
	}
	for (int i = 0; i < OURS_COUNT; i++) {
		open_mine(&mine[i], &ours[i], p, variants, "scs");
		if (mine[i].run && !is_float(ours[i].name))
			add_exact(&rows, &mine[i].method, mine[i].run, t, targets);
		else if (mine[i].run)
			mine[i].run->close(mine[i].run);
	}
	say_progress("scs: time");
	sample_rows(&rows, quick ? 1 : 20);
	double of_exact = NAN;
	for (int i = 0; i < rows.count; i++)
		if (rows.row[i].method->family == OURS || rows.row[i].method->family == PROPAGATOR) {
			struct row *row = &rows.row[i];
			if (row->method == &mine[0].method && row->samples.count > 0)
				of_exact = row->samples.median;
			if (row->samples.count == 0)
				row->samples = rows.row[i - 1].samples; /* the same run, once for each target */
		}
	FILE *out = create(folder, "headline_integrators.csv",
		"target,method,family,setting_kind,setting,error,reached,parts_estimated,ns_min,ns_median,ns_max,"
		"ns_samples,ns_over_exact,settings\n");
	for (int i = 0; i < rows.count; i++) {
		put_row(out, &rows.row[i], of_exact);
		if (rows.row[i].run)
			rows.row[i].run->close(rows.row[i].run);
	}
	finish(out);
	for (int i = 0; i < OURS_COUNT; i++)
		free(mine[i].refused);
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
	double y[MOST_STATES], start;
	run->restart(run);
	run->get(run, y);
	start = energy(y);
	if (!run->advance(run, units, NULL))
		return NAN;
	run->get(run, y);
	return (energy(y) - start) / start;
}

struct entry {
	const struct method *method;
	const char *refused;
	struct run *run;
	double error, drift, long_drift;
	struct samples samples;
};

static int entries_of(struct entry *entry, struct mine *mine, const struct problem *p, const char *variants,
                      const char *base)
{
	int count = 0;
	for (const struct method *const *m = propagator_methods; *m; m++)
		entry[count++] = (struct entry){ .method = *m, .run = (*m)->open(*m, p, p->unit) };
	for (int i = 0; i < OURS_COUNT; i++) {
		open_mine(&mine[i], &ours[i], p, variants, base);
		entry[count++] = (struct entry){ .method = &mine[i].method, .refused = mine[i].refused,
		                                 .run = mine[i].run };
	}
	return count;
}

static void close_entries(struct entry *entry, int count, struct mine *mine)
{
	for (int i = 0; i < count; i++)
		if (entry[i].run)
			entry[i].run->close(entry[i].run);
	for (int i = 0; i < OURS_COUNT; i++)
		free(mine[i].refused);
}

static void put_number(FILE *out, const struct entry *e, double value)
{
	if (e->refused)
		fputs("refused,", out);
	else if (!e->run)
		fputs("cannot,", out);
	else if (!isfinite(value))
		fputs("failed,", out);
	else
		fprintf(out, "%.4g,", value);
}

static void sample_entries(struct entry *entry, int count, double seconds)
{
	struct run *run[40];
	struct samples samples[40];
	int runs = 0;
	for (int i = 0; i < count; i++)
		if (entry[i].run)
			run[runs++] = entry[i].run;
	sample_runs(runs, run, seconds, samples);
	for (int i = 0, k = 0; i < count; i++)
		if (entry[i].run)
			entry[i].samples = samples[k++];
}

static void equal_step(const struct problem *p, const struct truth *t, const char *variants, const char *folder,
                       bool quick)
{
	struct entry entry[40];
	struct mine mine[OURS_COUNT];
	const int count = entries_of(entry, mine, p, variants, "scs");
	double of_exact = NAN;
	for (int i = 0; i < count; i++) {
		if (!entry[i].run)
			continue;
		say_progress("scs: drift of %s", entry[i].method->name);
		entry[i].error = error_at_outputs(entry[i].run, t);
		entry[i].drift = drift(entry[i].run, t->units);
		entry[i].long_drift = drift(entry[i].run, quick ? 1000000 : 10000000);
	}
	say_progress("scs: time");
	sample_entries(entry, count, quick ? 0.5 : 5);
	for (int i = 0; i < count; i++)
		if (entry[i].method == &mine[0].method && entry[i].run)
			of_exact = entry[i].samples.median;
	FILE *out = create(folder, "headline_equal_step.csv",
		"method,family,step,error,energy_drift,energy_drift_long,long_steps,ns_min,ns_median,ns_max,"
		"ns_samples,ns_over_exact,settings\n");
	for (int i = 0; i < count; i++) {
		const struct entry *e = &entry[i];
		put_quoted(out, e->method->name);
		fprintf(out, ",%s,%g,", families[e->method->family], p->unit);
		put_number(out, e, e->error);
		put_number(out, e, e->drift);
		put_number(out, e, e->long_drift);
		fprintf(out, "%d,", quick ? 1000000 : 10000000);
		put_times(out, &e->samples, of_exact);
		putc(',', out);
		put_quoted(out, e->refused ? e->refused : e->method->settings);
		putc('\n', out);
	}
	finish(out);
	close_entries(entry, count, mine);
}

/* ---- the third ---- */

static void meet(FILE *out, const char *kind, const char *gap, const char *variants)
{
	struct entry entry[40];
	struct mine mine[OURS_COUNT];
	char base[100], path[4096];
	snprintf(base, sizeof base, "%s-%s", kind, gap);
	snprintf(path, sizeof path, "%s/%s.so", variants, base);
	struct problem *p = problem_load(path, base, 0.01, 10000, true, 0);
	struct truth *t = truth_of(p);
	const int count = entries_of(entry, mine, p, variants, base);
	for (int i = 0; i < count; i++) {
		fprintf(out, "%s,%s,", kind, gap);
		put_quoted(out, entry[i].method->name);
		fprintf(out, ",%s,", families[entry[i].method->family]);
		put_number(out, &entry[i], entry[i].run ? error_at_outputs(entry[i].run, t) : NAN);
		put_quoted(out, entry[i].refused ? entry[i].refused : entry[i].method->settings);
		fprintf(out, ",%.2g\n", t->agreement);
	}
	close_entries(entry, count, mine);
	truth_free(t);
	problem_free(p);
}

static void confluence(const char *variants, const char *folder)
{
	FILE *out = create(folder, "headline_confluence.csv",
	                   "case,gap,method,family,error,settings,truth_agreement\n");
	for (int i = 0; i < MEETINGS; i++)
		meet(out, "twins", meetings[i].gap, variants);
	for (int i = 0; i < MEETINGS; i++)
		meet(out, "one-way", meetings[i].gap, variants);
	finish(out);
}

int main(int argc, char **argv)
{
	bool quick = false, listed = false, find = false;
	int at = 1;
	for (; at < argc && argv[at][0] == '-'; at++) {
		listed = listed || strcmp(argv[at], "--list") == 0;
		find = find || strcmp(argv[at], "--find") == 0;
		quick = quick || strcmp(argv[at], "--quick") == 0;
	}
	if (listed) {
		list();
		return 0;
	}
	if (argc - at != 2) {
		fputs("usage: headline --list\n       headline [--find] [--quick] VARIANTS OUTDIR\n", stderr);
		return 2;
	}
	char path[4096];
	snprintf(path, sizeof path, "%s/scs.so", argv[at]);
	struct problem *p = problem_load(path, "scs", 0.01, quick ? 10000 : 100000, true, 0);
	struct truth *t = truth_of(p);
	fprintf(stderr, "\ntwo roads to the truth agree to %.2g\n", t->agreement);
	if (find) {
		find_settings(p, t, argv[at], quick);
		confluence(argv[at], argv[at + 1]);
	} else {
		integrators(p, t, argv[at], argv[at + 1], quick);
		equal_step(p, t, argv[at], argv[at + 1], quick);
	}
	truth_free(t);
	problem_free(p);
	return 0;
}
