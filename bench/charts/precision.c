/* SPDX-License-Identifier: GPL-3.0-or-later */
/* precision: what accuracy costs. Each method on each model with several steps or tolerances: its largest error over
 * the whole history against the time it takes for a unit of output, and against its evaluations of the right-hand
 * side.
 *
 *     precision --list [--quick] [MODEL...]              the variants wanted: one line each, FILE SPEC and plgen's
 *                                                        options
 *     precision --names [--quick] [MODEL...]             the models of a run
 *     precision --errors [--quick] VARIANTS [MODEL...]   VARIANTS: the folder with those files. VARIANTS/NAME.errors:
 *                                                        all that is no time, the same bytes whenever it is made
 *     precision [--quick] VARIANTS FILE.csv [MODEL...]   the table: errors of NAME.errors where that is there, else
 *                                                        found; and times
 *     precision --scales [--quick] VARIANTS [MODEL...]   what tolerances stand on, a line for each model: name, shared
 *                                                        object, unit [s], units, largest |coordinate|, |velocity|
 */
#include "precision_lines.h"

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
	{ "quad2dof", "1/10", 300, 100, false, 0, ORDINARY, false, true },
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
	{ "gear3", "1/100", 2000, 500, false, 0, ORDINARY, false, true },
	{ "half_car_lifting", "1/100", 300, 300, false, 0, ORDINARY, false, true },
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
/* Of one expansion over several units, whose values are the rows */
static const int parts_over[] = { 1, 0 };
static const int parts_modes[] = { 1, 2, 4, 0 };
/* Close together where errors are 1e-3, for which a fixed step is often enough */
static const int tolerances_all[] = {
	TOLERANCE(1, 1), TOLERANCE(3, 2), TOLERANCE(1, 2), TOLERANCE(3, 3), TOLERANCE(1, 3), TOLERANCE(5, 4),
	TOLERANCE(2, 4), TOLERANCE(1, 4), TOLERANCE(1, 5), TOLERANCE(1, 6), TOLERANCE(1, 7), TOLERANCE(1, 8),
	TOLERANCE(1, 9), TOLERANCE(1, 10), TOLERANCE(1, 11), TOLERANCE(1, 12), TOLERANCE(1, 13), TOLERANCE(1, 14), 0 };
/* Of a stiff oscillator, whose jumps are off in time: an error of 1e-3 takes a tolerance far below it */
static const int tolerances_stiff[] = {
	TOLERANCE(1, 1), TOLERANCE(3, 2), TOLERANCE(1, 2), TOLERANCE(3, 3), TOLERANCE(2, 3), TOLERANCE(1, 3),
	TOLERANCE(5, 4), TOLERANCE(2, 4), TOLERANCE(1, 4), TOLERANCE(3, 5), TOLERANCE(1, 5), TOLERANCE(5, 6),
	TOLERANCE(2, 6), TOLERANCE(1, 6), TOLERANCE(5, 7), TOLERANCE(2, 7), TOLERANCE(1, 7), TOLERANCE(1, 8),
	TOLERANCE(1, 9), TOLERANCE(1, 10), TOLERANCE(1, 11), TOLERANCE(1, 12), TOLERANCE(1, 13), TOLERANCE(1, 14), 0 };
static const int tolerances_large[] = { TOLERANCE(1, 2), TOLERANCE(1, 4), TOLERANCE(1, 6), TOLERANCE(1, 8),
                                        TOLERANCE(1, 10), TOLERANCE(1, 12), 0 };
/* Of radau and auto where nothing is stiff, so that taylor is the cheaper one: their code takes compilers long */
static const int tolerances_few[] = { TOLERANCE(1, 2), TOLERANCE(1, 3), TOLERANCE(1, 4), TOLERANCE(1, 6),
                                      TOLERANCE(1, 7), TOLERANCE(1, 9), TOLERANCE(1, 10), TOLERANCE(1, 12),
                                      TOLERANCE(1, 13), 0 };
static const int tolerances_quick[] = { TOLERANCE(1, 3), TOLERANCE(1, 8), TOLERANCE(1, 12), 0 };
/* Of what is compiled with its right-hand side */
static const int parts_inlined[] = { 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 0 };

struct ours {
	const char *name, *options;
	bool exact;                     /* else with a remainder */
	bool series;                    /* of smooth models with few states */
	bool modes;                     /* of large ones, with a bank of their own: specs/modes_NAME.spec */
	bool tolerance;                 /* settings are tolerances, not steps */
	bool over;                      /* one expansion is over several units */
};

#define EXACT(NAME, OPTIONS) {.name = NAME, .options = OPTIONS, .exact = true}
#define LEFT(NAME) {.name = NAME, .options = "--scheme " NAME}
#define CHOSEN(NAME) {.name = NAME, .options = "--scheme " NAME, .series = true, .tolerance = true}
#define SERIES(NAME) {.name = "taylor " NAME, .options = "'--scheme=taylor " NAME "'", .series = true}
#define OVER(NAME) {.name = "taylor " NAME, .options = "'--scheme=taylor " NAME "'", .series = true, .over = true}
#define MODES(NAME, OPTIONS) {.name = NAME, .options = OPTIONS, .modes = true}
static const struct ours ours[] = {
	EXACT("exact", ""), EXACT("exact, direct", "--form direct"), EXACT("exact, delta", "--form delta"),
	EXACT("exact, kick-drift-kick", "--form kick-drift-kick"),
	EXACT("exact, compensated", "--accuracy compensated"),
	EXACT("exact, float", "--real float"), EXACT("exact, float, delta", "--real float --form delta"),
	EXACT("exact, float, kick-drift-kick", "--real float --form kick-drift-kick"),
	EXACT("exact, float, compensated", "--real float --accuracy compensated"),
	LEFT("pl"), LEFT("etd1"), LEFT("etdrk2"), LEFT("etdrk4"), LEFT("nc2"), LEFT("nc3"), LEFT("dq4"), LEFT("bm3"),
	CHOSEN("taylor"), CHOSEN("radau"), CHOSEN("auto"),
	SERIES("4"), SERIES("5"), SERIES("6"), SERIES("8"), SERIES("9"), SERIES("12"),
	OVER("4 over 2"), OVER("5 over 2"), OVER("6 over 2"), OVER("6 over 3"), OVER("6 over 4"), OVER("8 over 2"),
	OVER("8 over 3"), OVER("8 over 4"), OVER("12 over 2"), OVER("12 over 3"),
	MODES("etdam4", "--scheme etdam4"), MODES("etdam5", "--scheme etdam5"), MODES("etdam6", "--scheme etdam6"),
	MODES("etdcol 4", "'--scheme=etdcol 4'"), MODES("etdcol 6", "'--scheme=etdcol 6'"),
};
enum { OURS_COUNT = sizeof ours / sizeof *ours };

/* Linear models leave nothing over but to pl; clearances are exact in every region, or else a remainder. Of series the
 * half car has those by tolerance, to see what they are worth where sixteen regions meet. */
static bool applies(const struct charted *m, const struct ours *o)
{
	const bool half_car = strcmp(m->name, "half_car_lifting") == 0,
		piecewise = half_car || strncmp(m->name, "gear", 4) == 0;
	if (o->modes)
		return m->kind == LARGE;
	if (o->over)
		return m->kind == ORDINARY && !m->linear && !piecewise;
	if (o->series)
		return !m->linear && (half_car ? o->tolerance : !piecewise) && m->kind != LARGE;
	return o->exact ? m->linear || piecewise : !m->linear || strcmp(o->name, "pl") == 0;
}

static const char *options_of(const struct ours *o)
{
	return *o->options ? o->options : "--scheme exact";
}

/* Ours and a peer's alike */
static const int *tolerances_of(const struct charted *m, bool quick)
{
	return quick ? tolerances_quick : m->kind == LARGE ? tolerances_large
		: m->kind == ORDINARY ? tolerances_all : tolerances_stiff;
}

static double tolerance_of(int code)
{
	return code % 10 * pow(10, -(code / 10));
}

static const int *parts_of_ours(const struct charted *m, const struct ours *o, bool quick)
{
	if (o->tolerance)
		return m->kind == ORDINARY && !quick && strcmp(o->name, "taylor") != 0 ? tolerances_few
			: tolerances_of(m, quick);
	if (o->over)
		return parts_over;
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
	leave(name, "no model");
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

static struct line *add_line(struct lines *lines)
{
	struct line *line = realloc(lines->line, (size_t)(lines->count + 1) * sizeof *line);
	if (!line)
		leave("precision", "out of memory");
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
	line->rung = lines->count > 1 && line[-1].method == method ? line[-1].rung + 1 : 0;
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

static struct problem *load(const struct charted *m, const char *folder, bool quick, char path[4096])
{
	snprintf(path, 4096, "%s/%s.so", folder, m->name);
	return problem_load(path, m->name, value_of(m->unit), quick ? m->quick_units : m->units, m->linear, m->w);
}

static void say_scales(FILE *out, const struct charted *m, const char *folder, bool quick)
{
	char path[4096];
	struct problem *p = load(m, folder, quick, path);
	truth_free(truth_of(p));
	put_scales(out, p, m->name, path);
	problem_free(p);
}

static void add_all(struct lines *lines, const struct charted *m, const struct problem *p, bool quick,
                    const char *folder)
{
	/* A peer is added to one of these lists */
	add_peers(lines, m, p, fixed_methods, quick, true);
	add_peers(lines, m, p, inlined_methods, quick, false);
	add_spans(lines, m, p, quick);
	add_peers(lines, m, p, structural_methods, quick, true);
	add_peers(lines, m, p, adaptive_methods, quick, true);
	add_peers(lines, m, p, clearance_methods, quick, false);
	add_peers(lines, m, p, propagator_methods, quick, true);
	add_ours(lines, m, p, quick);
	open_ours(lines, p, folder);
}

/* out: the table; NULL: errors alone, which are kept */
static void measure(FILE *out, const struct charted *m, const char *folder, bool quick, double seconds)
{
	char path[4096];
	struct problem *p = load(m, folder, quick, path);
	struct lines lines = { NULL, 0, 0 };
	const bool known = out && read_scales(&lines, p, folder);
	struct truth *t = known ? NULL : truth_of(p);
	add_all(&lines, m, p, quick, folder);
	if (known) {
		read_errors(&lines, p, folder);
	} else {
		find_errors(&lines, p, t);
		truth_free(t);
	}
	if (out) {
		say_progress("%s: time", m->name);
		find_times(&lines, seconds);
	} else {
		keep_errors(&lines, p, folder);
	}
	for (struct line *line = lines.line; line < lines.line + lines.count; line++) {
		if (out)
			put_line(out, &lines, line, p);
		if (line->run)
			line->run->close(line->run);
		free(line->refused);
	}
	free(lines.line);
	problem_free(p);
}

/* ---- */

int main(int argc, char **argv)
{
	const unsigned flags = flags_of(argc, &argv, "--quick --list --names --scales --errors", 0, MODELS + 2,
		"precision --list [--quick] [MODEL...]\n"
		"       precision [--quick] VARIANTS FILE.csv [MODEL...]\n"
		"       precision --names [--quick] [MODEL...]\n"
		"       precision --errors [--quick] VARIANTS [MODEL...]\n"
		"       precision --scales [--quick] VARIANTS [MODEL...]");
	const bool quick = flags & 1, list = flags & 2, names = flags & 4, scales = flags & 8, errors = flags & 16;
	const int files = list || names ? 0 : scales || errors ? 1 : 2;
	int named = 0;
	while (argv[files + named])
		named++;
	FILE *out = files < 2 ? stdout : fopen(argv[1], "w");
	if (!out) {
		perror(argv[1]);
		return 1;
	}
	if (files == 2)
		put_head(out);
	for (int i = 0; i < (named > 0 ? named : MODELS); i++) {
		const struct charted *m = named > 0 ? model_named(argv[files + i]) : &models[i];
		if (named == 0 && quick && !scales && !m->quick)
			continue;
		if (names)
			puts(m->name);
		else if (list)
			list_model(m, quick);
		else if (scales)
			say_scales(out, m, argv[0], quick);
		else
			measure(errors ? NULL : out, m, argv[0], quick, quick ? 0.5 : 5);
		fflush(out);
	}
	table_close(out, "precision");
	return 0;
}
