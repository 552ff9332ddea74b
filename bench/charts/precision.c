/* SPDX-License-Identifier: GPL-3.0-or-later */
/* precision: what accuracy costs. Each method on each model with several steps or tolerances: its largest error over
 * the whole history against the time it takes for a unit of output, and against its evaluations of the right-hand
 * side.
 *
 *     precision --list [--quick] [MODEL...]              the variants wanted: one line each, FILE SPEC and plgen's
 *                                                        options
 *     precision [--quick] VARIANTS FILE.csv [MODEL...]   VARIANTS: the folder with those files
 *     precision --scales [--quick] VARIANTS [MODEL...]   what tolerances stand on, a line for each model: name, shared
 *                                                        object, unit [s], units, largest |coordinate|, |velocity|
 */
#include "charts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- what is measured ---- */

/* stiff: steps from coarse to fine; large: fewer settings, each of which takes long; stiffer: as stiff, without
 * the multistep solvers and the one of order 8 that are for what is not stiff: a run of theirs takes minutes there */
enum kind { ORDINARY, STIFF, LARGE, STIFFER };

struct charted {
	const char *name;
	const char *unit;               /* of output [s], as a fraction */
	int units, quick_units;
	bool linear;
	double w;                       /* of its load [rad/s] */
	enum kind kind;
	bool quick;                     /* part of a quick run */
	bool here;                      /* its spec stands in bench/charts/specs, not in models */
};

static const struct charted models[] = {
	{ "pendulum", "1/10", 100, 100, false, 0, ORDINARY, true, false },
	{ "vanderpol", "1/10", 200, 200, false, 0, ORDINARY, false, false },
	{ "vanderpol_stiff", "1/10", 2000, 200, false, 0, STIFF, false, false },
	{ "vanderpol_stiffer", "1", 2000, 200, false, 0, STIFFER, false, true },
	{ "quad2dof", "1/10", 300, 100, false, 0, ORDINARY, false, false },
	{ "duffing", "1/10", 300, 100, false, 0, ORDINARY, false, false },
	{ "mathieu", "1/10", 300, 100, false, 0, ORDINARY, false, false },
	{ "beam4", "1/100", 2000, 100, false, 0, LARGE, true, false },
	{ "beam15", "1/100", 2000, 100, false, 0, LARGE, false, false },
	{ "henon_heiles", "1/10", 300, 100, false, 0, ORDINARY, false, true },
	{ "coupled_vanderpol", "1/10", 300, 100, false, 0, ORDINARY, false, true },
	{ "double_pendulum", "1/10", 300, 100, false, 0, ORDINARY, false, true },
	{ "rayleigh", "1/10", 300, 100, false, 0, ORDINARY, false, true },
	{ "duffing_pair", "1/10", 300, 100, false, 0, ORDINARY, false, true },
	{ "spherical_pendulum", "1/10", 300, 100, false, 0, ORDINARY, false, true },
	{ "gear1", "1/10", 500, 200, false, 0, ORDINARY, true, false },
	{ "gear2", "1/10", 200, 200, false, 0, ORDINARY, false, false },
	{ "gear3", "1/100", 2000, 500, false, 0, ORDINARY, false, false },
	{ "scs", "1/100", 3000, 1000, true, 0, ORDINARY, true, false },
	{ "sdcs", "1/100", 3000, 1000, true, 0, ORDINARY, false, false },
	{ "sdcsf", "1/100", 3000, 1000, true, 5, ORDINARY, false, false },
	{ "scs_weak", "1/100", 3000, 1000, true, 0, ORDINARY, false, false },
	{ "linear2dof", "1/5", 50, 50, true, 0, ORDINARY, false, false },
	{ "tuned_floor", "1/100", 3000, 1000, true, 4 * M_PI, ORDINARY, false, true },
};
enum { MODELS = sizeof models / sizeof *models };

/* Steps, as the unit over these, and tolerances, as TOLERANCE; 0 ends. A step of the beams must be below
 * 2.7e-4 s for RK4; their implicit methods, which solve for 30 unknowns, and their schemes stay at the first. */
#define TOLERANCE(digit, power) (10 * (power) + (digit))        /* digit e-power */
static const int parts_fixed[][8] = { { 1, 2, 4, 8, 16, 32, 64, 0 }, { 4, 16, 64, 256, 1024, 0 },
                                      { 1, 4, 16, 40, 80, 0 }, { 16, 64, 256, 1024, 4096, 0 } };
static const int parts_fixed_quick[][8] = { { 1, 8, 64, 0 }, { 16, 256, 0 }, { 1, 16, 40, 0 }, { 16, 4096, 0 } };
static const int parts_scheme[][8] = { { 1, 2, 4, 8, 16, 32, 0 }, { 1, 4, 16, 64, 256, 1024, 0 }, { 1, 4, 16, 0 },
                                       { 1, 4, 16, 64, 256, 1024, 0 } };
static const int parts_scheme_quick[][8] = { { 1, 8, 0 }, { 4, 64, 0 }, { 1, 8, 0 }, { 4, 64, 0 } };
/* Units that a step of inlined.c goes over */
static const int spans[] = { 2, 3, 4, 5, 6, 8, 10, 15, 0 }, spans_quick[] = { 4, 0 };
static const int parts_implicit_large[] = { 1, 2, 4, 16, 0 }, parts_exact[] = { 1, 4, 0 },
	parts_exact_quick[] = { 1, 0 };
/* Of a series of fixed order on a smooth model: between the others, as those that are compiled in have them */
static const int parts_series[] = { 1, 2, 3, 4, 6, 8, 16, 32, 0 };
static const int parts_modes[] = { 1, 2, 4, 0 };
/* Close together where errors are 1e-3, for which a fixed step is often enough */
static const int tolerances_all[] = {
	TOLERANCE(1, 1), TOLERANCE(3, 2), TOLERANCE(1, 2), TOLERANCE(3, 3), TOLERANCE(1, 3), TOLERANCE(5, 4),
	TOLERANCE(2, 4), TOLERANCE(1, 4), TOLERANCE(1, 5), TOLERANCE(1, 6), TOLERANCE(1, 7), TOLERANCE(1, 8),
	TOLERANCE(1, 9), TOLERANCE(1, 10), TOLERANCE(1, 11), TOLERANCE(1, 12), TOLERANCE(1, 13), TOLERANCE(1, 14), 0 };
static const int tolerances_large[] = { TOLERANCE(1, 2), TOLERANCE(1, 4), TOLERANCE(1, 6), TOLERANCE(1, 8),
                                        TOLERANCE(1, 10), TOLERANCE(1, 12), 0 };
static const int tolerances_quick[] = { TOLERANCE(1, 3), TOLERANCE(1, 8), TOLERANCE(1, 12), 0 };
/* Of what is compiled with its right-hand side */
static const int parts_inlined[] = { 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 0 };

struct ours {
	const char *name, *options;
	bool exact;                     /* else with a leftover */
	bool series;                    /* of smooth models with few states */
	bool modes;                     /* of large ones, with a bank of their own: specs/modes_NAME.spec */
	bool tolerance;                 /* settings are tolerances, not steps */
};

static const struct ours ours[] = {
	{ .name = "exact", .options = "", .exact = true },
	{ .name = "exact, direct", .options = "--form direct", .exact = true },
	{ .name = "exact, delta", .options = "--form delta", .exact = true },
	{ .name = "exact, kick-drift-kick", .options = "--form kick-drift-kick", .exact = true },
	{ .name = "exact, compensated", .options = "--accuracy compensated", .exact = true },
	{ .name = "exact, float", .options = "--real float", .exact = true },
	{ .name = "exact, float, delta", .options = "--real float --form delta", .exact = true },
	{ .name = "exact, float, kick-drift-kick", .options = "--real float --form kick-drift-kick", .exact = true },
	{ .name = "exact, float, compensated", .options = "--real float --accuracy compensated", .exact = true },
	{ .name = "pl", .options = "--scheme pl" },
	{ .name = "etd1", .options = "--scheme etd1" },
	{ .name = "etdrk2", .options = "--scheme etdrk2" },
	{ .name = "etdrk4", .options = "--scheme etdrk4" },
	{ .name = "nc2", .options = "--scheme nc2" },
	{ .name = "nc3", .options = "--scheme nc3" },
	{ .name = "dq4", .options = "--scheme dq4" },
	{ .name = "bm3", .options = "--scheme bm3" },
	{ .name = "taylor", .options = "--scheme taylor", .series = true, .tolerance = true },
	{ .name = "radau", .options = "--scheme radau", .series = true, .tolerance = true },
	{ .name = "auto", .options = "--scheme auto", .series = true, .tolerance = true },
	{ .name = "taylor 4", .options = "'--scheme=taylor 4'", .series = true },
	{ .name = "taylor 5", .options = "'--scheme=taylor 5'", .series = true },
	{ .name = "taylor 6", .options = "'--scheme=taylor 6'", .series = true },
	{ .name = "taylor 8", .options = "'--scheme=taylor 8'", .series = true },
	{ .name = "taylor 9", .options = "'--scheme=taylor 9'", .series = true },
	{ .name = "taylor 12", .options = "'--scheme=taylor 12'", .series = true },
	{ .name = "etdam4", .options = "--scheme etdam4", .modes = true },
	{ .name = "etdam5", .options = "--scheme etdam5", .modes = true },
	{ .name = "etdam6", .options = "--scheme etdam6", .modes = true },
	{ .name = "etdcol 4", .options = "'--scheme=etdcol 4'", .modes = true },
	{ .name = "etdcol 6", .options = "'--scheme=etdcol 6'", .modes = true },
};
enum { OURS_COUNT = sizeof ours / sizeof *ours };

/* Linear models leave nothing over but to pl; clearances are exact in every region, or else a leftover. */
static bool applies(const struct charted *m, const struct ours *o)
{
	const bool piecewise = strncmp(m->name, "gear", 4) == 0;
	if (o->modes)
		return m->kind == LARGE;
	if (o->series)
		return !m->linear && !piecewise && m->kind != LARGE;
	return o->exact ? m->linear || piecewise : !m->linear || strcmp(o->name, "pl") == 0;
}

static const char *options_of(const struct ours *o)
{
	return *o->options ? o->options : "--scheme exact";
}

/* Ours and a peer's alike */
static const int *tolerances_of(const struct charted *m, bool quick)
{
	return quick ? tolerances_quick : m->kind == LARGE ? tolerances_large : tolerances_all;
}

static double tolerance_of(int code)
{
	return code % 10 * pow(10, -(code / 10));
}

static const int *parts_of_ours(const struct charted *m, const struct ours *o, bool quick)
{
	if (o->tolerance)
		return tolerances_of(m, quick);
	if (o->exact)
		return quick ? parts_exact_quick : parts_exact;
	if (o->modes)
		return quick ? parts_exact_quick : parts_modes;
	if (o->series && m->kind == ORDINARY && !quick)
		return parts_series;
	return quick ? parts_scheme_quick[m->kind] : parts_scheme[m->kind];
}

static const struct charted *model_named(const char *name)
{
	for (int i = 0; i < MODELS; i++)
		if (strcmp(models[i].name, name) == 0)
			return &models[i];
	fprintf(stderr, "precision: no model %s\n", name);
	exit(2);
}

static double value_of(const char *fraction)
{
	const char *bar = strchr(fraction, '/');
	return bar ? atof(fraction) / atof(bar + 1) : atof(fraction);
}

/* ---- the list ---- */

/* scs, exact, delta, 4: scs-exact-delta-4.so; pendulum, taylor, TOLERANCE(3, 2): pendulum-taylor-3e-2.so */
static void file_of(const struct charted *m, const struct ours *o, int parts, char *name, size_t room)
{
	size_t length = 0;
	if (o->tolerance)
		snprintf(name, room, "%s-%s-%de-%d.so", m->name, o->name, parts % 10, parts / 10);
	else
		snprintf(name, room, "%s-%s-%d.so", m->name, o->name, parts);
	for (const char *c = name; *c; c++)
		if (*c != ' ')
			name[length++] = *c == ',' ? '-' : *c;
	name[length] = '\0';
}

static const char *folder_of(const struct charted *m)
{
	return m->here ? "bench/charts/specs" : "models";
}

static void list_model(const struct charted *m, bool quick)
{
	char name[200];
	printf("%s.so %s/%s.spec\n", m->name, folder_of(m), m->name);
	for (const struct ours *o = ours; o < ours + OURS_COUNT; o++)
		for (const int *parts = parts_of_ours(m, o, quick); applies(m, o) && *parts; parts++) {
			file_of(m, o, *parts, name, sizeof name);
			if (o->tolerance)
				printf("%s %s/%s.spec --step %s %s --tolerance %de-%d\n", name, folder_of(m), m->name,
				       m->unit, options_of(o), *parts % 10, *parts / 10);
			else
				printf("%s %s/%s%s.spec --step %s/%d %s\n", name,
				       o->modes ? "bench/charts/specs" : folder_of(m), o->modes ? "modes_" : "",
				       m->name, m->unit, *parts,
				       options_of(o));
		}
}

/* ---- the runs of one model ---- */

struct line {                       /* one row of the CSV */
	struct method ours;             /* of ours */
	const struct method *method;
	double setting;
	struct run *run;                /* NULL: refused or failed to open */
	char file[200];                 /* of ours, in the folder of variants */
	char *refused;
	struct error error;
	double evaluations;             /* per unit; below 0: none */
	struct samples samples;
	double pass;                    /* ns per unit of one more pass, by itself */
};

struct lines { struct line *line; int count; };

static struct line *add_line(struct lines *lines)
{
	struct line *line = realloc(lines->line, (size_t)(lines->count + 1) * sizeof *line);
	if (!line) {
		fputs("precision: out of memory\n", stderr);
		exit(1);
	}
	lines->line = line;
	line += lines->count++;
	memset(line, 0, sizeof *line);
	return line;
}

static void add_peer(struct lines *lines, const struct problem *p, const struct method *method, double setting)
{
	struct line *line = add_line(lines);
	line->method = method;
	line->setting = setting;
	line->run = method->open(method, p, setting);
}

static bool is_implicit(const struct method *method)
{
	return strcmp(method->name, "implicit trapezoid") == 0 || strcmp(method->name, "Newmark") == 0 ||
	       strcmp(method->name, "generalized-alpha") == 0;
}

static bool is_slow_on(const struct charted *m, const struct method *method)
{
	return m->kind == STIFFER && (strcmp(method->name, "GSL msadams") == 0 ||
	       strcmp(method->name, "CVODE Adams") == 0 || strcmp(method->name, "ARKODE order 8") == 0);
}

static const int *parts_of_peer(const struct charted *m, const struct method *method, bool quick)
{
	if (method->family == PROPAGATOR)
		return quick ? parts_exact_quick : parts_exact;
	if (m->kind == LARGE && !quick && is_implicit(method))
		return parts_implicit_large;
	if (strstr(method->name, "inlined") && m->kind == ORDINARY && !quick)
		return parts_inlined;
	return quick ? parts_fixed_quick[m->kind] : parts_fixed[m->kind];
}

/* everywhere: else what cannot on this model is left out */
static void add_peers(struct lines *lines, const struct charted *m, const struct problem *p,
                      const struct method *const *methods, bool quick, bool everywhere)
{
	for (; *methods; methods++) {
		const struct method *method = *methods;
		if ((method->linear_only && !p->linear) || is_slow_on(m, method))
			continue;
		if (method->tolerance)
			for (const int *code = tolerances_of(m, quick); *code; code++)
				add_peer(lines, p, method, tolerance_of(*code));
		else
			for (const int *parts = parts_of_peer(m, method, quick); *parts; parts++)
				add_peer(lines, p, method, p->unit / *parts);
		while (!everywhere && lines->count > 0 && !lines->line[lines->count - 1].run)
			lines->count--;
	}
}

static void add_spans(struct lines *lines, const struct charted *m, const struct problem *p, bool quick)
{
	for (const struct method *const *method = inlined_methods; *method && m->kind == ORDINARY; method++)
		for (const int *span = quick ? spans_quick : spans; *span; span++) {
			add_peer(lines, p, *method, *span * p->unit);
			if (!lines->line[lines->count - 1].run)
				lines->count--;
		}
}

static void add_ours(struct lines *lines, const struct charted *m, const struct problem *p, bool quick)
{
	for (const struct ours *o = ours; o < ours + OURS_COUNT; o++)
		for (const int *parts = parts_of_ours(m, o, quick); applies(m, o) && *parts; parts++) {
			struct line *line = add_line(lines);
			line->ours = (struct method){ .name = o->name, .family = OURS, .settings = options_of(o),
			                              .tolerance = o->tolerance };
			line->setting = o->tolerance ? tolerance_of(*parts) : p->unit / *parts;
			file_of(m, o, *parts, line->file, sizeof line->file);
		}
}

/* Once no line moves any more: a run keeps where its method is. */
static void open_ours(struct lines *lines, const struct problem *p, const char *folder)
{
	char path[4096];
	for (struct line *line = lines->line; line < lines->line + lines->count; line++) {
		if (line->method)
			continue;
		snprintf(path, sizeof path, "%s/%s", folder, line->file);
		line->refused = variant_refused(path);
		line->run = line->refused ? NULL : generated_open(&line->ours, p, path);
	}
}

static const struct method *method_of(const struct line *line)
{
	return line->method ? line->method : &line->ours;
}

static void find_error(struct line *line, const struct problem *p, const struct truth *t)
{
	line->error = error_of(line->run, t);
	long evaluations = line->run->evaluations(line->run);
	line->evaluations = evaluations < 0 ? -1 : (double)evaluations / p->units;
}

static void find_times(struct lines *lines, double seconds)
{
	struct run **run = calloc((size_t)lines->count + 1, sizeof *run);
	struct samples *samples = calloc((size_t)lines->count + 1, sizeof *samples);
	int count = 0;
	if (!run || !samples)
		exit(1);
	for (int i = 0; i < lines->count; i++)
		if (lines->line[i].run && !lines->line[i].error.failed)
			run[count++] = lines->line[i].run;
	sample_runs(count, run, seconds, samples);
	for (int i = 0, k = 0; i < lines->count; i++)
		if (lines->line[i].run && !lines->line[i].error.failed) {
			lines->line[i].pass = sample_pass(run[k]);
			lines->line[i].samples = samples[k++];
		}
	free(run);
	free(samples);
}

/* ---- the table ---- */

static const char *const families[] = { "ours", "fixed", "adaptive", "propagator" };

static void put_quoted(FILE *out, const char *text)
{
	putc('"', out);
	for (; *text; text++)
		putc(*text == '"' ? '\'' : *text, out);
	putc('"', out);
}

static void put_word(FILE *out, const char *word, int columns)
{
	for (int i = 0; i < columns; i++)
		fprintf(out, ",%s", word);
}

static void put_settings(FILE *out, const struct line *line)
{
	const struct method *method = method_of(line);
	char text[400];
	snprintf(text, sizeof text, "%s; %s", method->settings, line->run &&
	         !line->method ? generated_between(line->run) : "");
	put_quoted(out, line->refused ? line->refused : line->method ? method->settings : text);
}

static void put_line(FILE *out, const struct line *line, const struct problem *p, const struct truth *t)
{
	const struct method *method = method_of(line);
	const struct error *e = &line->error;
	fprintf(out, "%s,", p->name);
	put_quoted(out, method->name);
	fprintf(out, ",%s,%s,%.6g", families[method->family], method->tolerance ? "tolerance" : "step", line->setting);
	if (line->refused)
		put_word(out, "refused", 6);
	else if (!line->run)
		put_word(out, "cannot", 6);
	else if (e->failed)
		put_word(out, "failed", 5), fputs(",1", out);
	else
		fprintf(out, ",%.4g,%.4g,%.4g,%.4g,%.4g,0", e->q_end, e->q_between, e->v_end, e->v_between, e->largest);
	if (line->run && !e->failed && line->evaluations >= 0)
		fprintf(out, ",%.6g", line->evaluations);
	else
		fputs(",none", out);
	if (line->samples.count > 0)
		fprintf(out, ",%.5g,%.5g,%.5g,%d,%d,%.5g,", line->samples.min, line->samples.median, line->samples.max,
		        line->samples.count, p->units, line->pass);
	else
		put_word(out, "none", 6), putc(',', out);
	put_settings(out, line);
	fprintf(out, ",%.2g,%g,%g\n", t->agreement, p->unit, p->unit * p->units);
}

static struct problem *load(const struct charted *m, const char *folder, bool quick, char path[4096])
{
	snprintf(path, 4096, "%s/%s.so", folder, m->name);
	return problem_load(path, m->name, value_of(m->unit), quick ? m->quick_units : m->units, m->linear, m->w);
}

static void say_scales(FILE *out, const struct charted *m, const char *folder, bool quick)
{
	char path[4096];
	struct problem *p = load(m, folder, quick, path);
	double scale_q, scale_v;
	truth_free(truth_of(p));
	adaptive_scales(p, &scale_q, &scale_v);
	fprintf(out, "%s\t%s\t%.17g\t%d\t%.10g\t%.10g\n", m->name, path, p->unit, p->units, scale_q, scale_v);
	problem_free(p);
}

static void measure(FILE *out, const struct charted *m, const char *folder, bool quick, double seconds)
{
	char path[4096];
	struct problem *p = load(m, folder, quick, path);
	struct truth *t = truth_of(p);
	struct lines lines = { NULL, 0 };
	/* A peer is added to one of these lists */
	add_peers(&lines, m, p, fixed_methods, quick, true);
	add_peers(&lines, m, p, inlined_methods, quick, false);
	add_spans(&lines, m, p, quick);
	add_peers(&lines, m, p, structural_methods, quick, true);
	add_peers(&lines, m, p, adaptive_methods, quick, true);
	add_peers(&lines, m, p, clearance_methods, quick, false);
	add_peers(&lines, m, p, propagator_methods, quick, true);
	add_ours(&lines, m, p, quick);
	open_ours(&lines, p, folder);
	for (int i = 0; i < lines.count; i++) {
		struct line *line = &lines.line[i];
		say_progress("%s: error of %s, %g", m->name, method_of(line)->name, line->setting);
		if (line->run)
			find_error(line, p, t);
	}
	say_progress("%s: time", m->name);
	find_times(&lines, seconds);
	for (int i = 0; i < lines.count; i++) {
		put_line(out, &lines.line[i], p, t);
		if (lines.line[i].run)
			lines.line[i].run->close(lines.line[i].run);
		free(lines.line[i].refused);
	}
	free(lines.line);
	truth_free(t);
	problem_free(p);
}

/* ---- */

int main(int argc, char **argv)
{
	bool list = false, scales = false, quick = false;
	int at = 1;
	for (; at < argc && argv[at][0] == '-'; at++) {
		list = list || strcmp(argv[at], "--list") == 0;
		scales = scales || strcmp(argv[at], "--scales") == 0;
		quick = quick || strcmp(argv[at], "--quick") == 0;
	}
	const int files = list ? 0 : scales ? 1 : 2;
	if (argc - at < files) {
		fputs("usage: precision --list [--quick] [MODEL...]\n"
		      "       precision [--quick] VARIANTS FILE.csv [MODEL...]\n"
		      "       precision --scales [--quick] VARIANTS [MODEL...]\n", stderr);
		return 2;
	}
	FILE *out = list || scales ? stdout : fopen(argv[at + 1], "w");
	if (!out) {
		perror(argv[at + 1]);
		return 1;
	}
	if (!list && !scales)
		fputs("model,method,family,setting_kind,setting,q_end,q_between,v_end,v_between,largest,failed,"
		      "evaluations_per_unit,ns_min,ns_median,ns_max,ns_samples,ns_units,ns_pass,settings,"
		      "truth_agreement,unit_s,history_s\n", out);
	for (int i = 0; i < (argc > at + files ? argc - at - files : MODELS); i++) {
		const struct charted *m = argc > at + files ? model_named(argv[at + files + i]) : &models[i];
		if (argc == at + files && quick && !scales && !m->quick)
			continue;
		if (list)
			list_model(m, quick);
		else if (scales)
			say_scales(out, m, argv[at], quick);
		else
			measure(out, m, argv[at], quick, quick ? 0.5 : 10);
		fflush(out);
	}
	if (ferror(out) || fclose(out) != 0) {
		fputs("precision: cannot write the table\n", stderr);
		return 1;
	}
	return 0;
}
