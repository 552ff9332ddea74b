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

/* Steps, as the unit over these, by kind. A step of the beams must be below 2.7e-4 s for RK4; their implicit methods,
 * which solve for 30 unknowns, and their schemes stay at the first. */
static const char *const steps_fixed[] = { "1 2 4 8 16 32 64", "4 16 64 256 1024", "1 4 16 40 80",
											"16 64 256 1024 4096" };
static const char *const steps_fixed_quick[] = { "1 8 64", "16 256", "1 16 40", "16 4096" };
static const char *const steps_scheme[] = { "1 2 4 8 16 32", "1 4 16 64 256 1024", "1 4 16", "1 4 16 64 256 1024" };
static const char *const steps_scheme_quick[] = { "1 8", "4 64", "1 8", "4 64" };
/* Units that a step of inlined.c goes over */
#define SPANS "2 3 4 5 6 8 10 15"
/* Of a series of fixed order on a smooth model, and of what is compiled with its right-hand side: between the others */
#define STEPS_SERIES "1 2 3 4 6 8 16 32"
#define STEPS_INLINED "1 2 3 4 6 8 12 16 24 32 48 64"
/* Close together where errors are 1e-3, for which a fixed step is often enough */
#define FINE_TOLERANCES " 1e-8 1e-9 1e-10 1e-11 1e-12 1e-13 1e-14"
#define TOLERANCES_ALL "1e-1 3e-2 1e-2 3e-3 1e-3 5e-4 2e-4 1e-4 1e-5 1e-6 1e-7" FINE_TOLERANCES
/* Of a stiff oscillator, whose jumps are off in time: an error of 1e-3 takes a tolerance far below it */
#define TOLERANCES_STIFF \
	"1e-1 3e-2 1e-2 3e-3 2e-3 1e-3 5e-4 2e-4 1e-4 3e-5 1e-5 5e-6 2e-6 1e-6 5e-7 2e-7 1e-7" FINE_TOLERANCES
/* Of radau and auto where nothing is stiff, so that taylor is the cheaper one: their code takes compilers long */
#define TOLERANCES_FEW "1e-2 1e-3 1e-4 1e-6 1e-7 1e-9 1e-10 1e-12 1e-13"

struct ours {
	const char *name, *options;
	bool exact;                     /* else with a remainder */
	bool series;                    /* of smooth models with few states */
	bool modes;                     /* of large ones, with a bank of their own: specs/modes_beam.spec */
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
	EXACT("exact", "--scheme exact"), EXACT("exact, direct", "--form direct"),
	EXACT("exact, delta", "--form delta"), EXACT("exact, kick-drift-kick", "--form kick-drift-kick"),
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

/* Settings between blanks: steps as the unit over them, or tolerances. Ours and a peer's tolerances are alike. */
static const char *tolerances_of(const struct charted *m, bool quick)
{
	return quick ? "1e-3 1e-8 1e-12" : m->kind == LARGE ? "1e-2 1e-4 1e-6 1e-8 1e-10 1e-12"
		: m->kind == ORDINARY ? TOLERANCES_ALL : TOLERANCES_STIFF;
}

static const char *ladder_of_ours(const struct charted *m, const struct ours *o, bool quick)
{
	if (!applies(m, o))
		return "";
	if (o->tolerance)
		return m->kind == ORDINARY && !quick && strcmp(o->name, "taylor") != 0 ? TOLERANCES_FEW
			: tolerances_of(m, quick);
	if (o->over)
		return "1";
	if (o->exact || o->modes)
		return quick ? "1" : o->exact ? "1 4" : "1 2 4";
	if (o->series && m->kind == ORDINARY && !quick)
		return STEPS_SERIES;
	return quick ? steps_scheme_quick[m->kind] : steps_scheme[m->kind];
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

static const char *ladder_of_peer(const struct charted *m, const struct method *method, bool quick)
{
	if ((method->linear_only && !m->linear) || is_slow_on(m, method))
		return "";
	if (method->tolerance)
		return tolerances_of(m, quick);
	if (method->family == PROPAGATOR)
		return quick ? "1" : "1 4";
	if (m->kind == LARGE && !quick && is_implicit(method))
		return "1 2 4 16";
	if (strstr(method->name, "inlined") && m->kind == ORDINARY && !quick)
		return STEPS_INLINED;
	return quick ? steps_fixed_quick[m->kind] : steps_fixed[m->kind];
}

/* The next word of a list; false: there is none */
static bool next_word(const char **list, char word[16])
{
	int length = 0;
	const bool found = sscanf(*list, "%15s%n", word, &length) == 1;
	*list += length;
	return found;
}

static double tolerance_of(const char *word)
{
	return (word[0] - '0') * pow(10, atoi(word + 2));
}

static const struct charted *model_named(const char *name)
{
	for (int i = 0; i < MODELS; i++)
		if (strcmp(models[i].name, name) == 0)
			return &models[i];
	leave(name, "no model");
}

/* ---- the list ---- */

/* scs, exact, delta, 4: scs-exact-delta-4.so; pendulum, taylor, 3e-2: pendulum-taylor-3e-2.so */
static const char *file_of(const struct charted *m, const struct ours *o, const char *setting)
{
	char name[100];
	size_t length = 0;
	for (const char *c = o->name; *c; c++)
		if (*c != ' ')
			name[length++] = *c == ',' ? '-' : *c;
	name[length] = '\0';
	return text("%s-%s-%s.so", m->name, name, setting);
}

static void list_model(const struct charted *m, bool quick)
{
	char word[16], spec[100], modes[100];
	snprintf(spec, sizeof spec, "%s/%s.spec", m->here ? "bench/charts/specs" : "models", m->name);
	snprintf(modes, sizeof modes, "bench/charts/specs/modes_beam.spec -D Om=%s", m->name + strcspn(m->name, "14"));
	printf("%s.so %s\n", m->name, spec);
	for (const struct ours *o = ours; o < ours + OURS_COUNT; o++)
		for (const char *at = ladder_of_ours(m, o, quick); next_word(&at, word);)
			if (o->tolerance)
				printf("%s %s --step %s %s --tolerance %s\n", file_of(m, o, word), spec, m->unit,
				       o->options, word);
			else
				printf("%s %s --step %s/%s %s\n", file_of(m, o, word), o->modes ? modes : spec, m->unit,
				       word, o->options);
}

/* ---- the runs of one model: a row of the table each ---- */

struct line {
	struct method ours;             /* of ours */
	const struct method *method;    /* a peer's, or that */
	double setting;
	struct run *run;                /* NULL: refused or failed to open */
	char *refused;
	char found[120];                /* columns of the table: five errors, failed, evaluations per unit */
	double largest;                 /* of the errors; NAN: failed, or there is no run */
	int rung;                       /* of the ladder of one method's settings, from the cheapest; 0: its first */
	struct samples samples;
	double pass;                    /* ns per unit of one more pass, by itself; 0: not taken */
	bool dear;                      /* too dear to be timed: sample_ladders */
};

enum { MOST_LINES = 2000 };
struct lines {
	struct line *line;              /* which stay where they are: a run keeps where its method is */
	int count;
	double agreement;               /* of the truth's two roads */
};

#define EACH_LINE(lines) struct line *line = (lines)->line; line < (lines)->line + (lines)->count; line++

static struct line *add_line(struct lines *lines)
{
	if (lines->count == MOST_LINES)
		leave("precision", "too many runs");
	return &lines->line[lines->count++];
}

/* everywhere: else what cannot on this model is left out */
static void add_peer(struct lines *lines, const struct problem *p, const struct method *method, double setting,
					 bool everywhere)
{
	struct run *run = method->open(method, p, setting);
	if (!run && !everywhere)
		return;
	struct line *line = add_line(lines);
	*line = (struct line){ .method = method, .setting = setting, .run = run };
	line->rung = lines->count > 1 && line[-1].method == method ? line[-1].rung + 1 : 0;
}

static void add_peers(struct lines *lines, const struct charted *m, const struct problem *p,
					  const struct method *const *methods, bool quick, bool everywhere)
{
	char word[16];
	for (; *methods; methods++)
		for (const char *at = ladder_of_peer(m, *methods, quick); next_word(&at, word);)
			add_peer(lines, p, *methods, (*methods)->tolerance ? tolerance_of(word) : p->unit / atoi(word),
			         everywhere);
}

static void add_spans(struct lines *lines, const struct charted *m, const struct problem *p, bool quick)
{
	char word[16];
	for (const struct method *const *method = inlined_methods; *method && m->kind == ORDINARY; method++)
		for (const char *at = quick ? "4" : SPANS; next_word(&at, word);)
			add_peer(lines, p, *method, atoi(word) * p->unit, false);
}

static void add_ours(struct lines *lines, const struct charted *m, const struct problem *p, bool quick,
					 const char *folder)
{
	char word[16];
	for (const struct ours *o = ours; o < ours + OURS_COUNT; o++)
		for (const char *at = ladder_of_ours(m, o, quick); next_word(&at, word);) {
			struct line *line = add_line(lines);
			const char *path = text("%s/%s", folder, file_of(m, o, word));
			line->ours = (struct method){ .name = o->name, .family = OURS, .settings = o->options,
			                              .tolerance = o->tolerance };
			line->method = &line->ours;
			line->setting = o->tolerance ? tolerance_of(word) : p->unit / atoi(word);
			line->refused = variant_refused(path);
			line->run = line->refused ? NULL : generated_open(line->method, p, path);
		}
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
	add_ours(lines, m, p, quick, folder);
}

/* ---- errors: what is no time ---- */

static const char *error_columns(const struct line *line, const struct problem *p, const struct truth *t)
{
	const char *w = line->refused ? "refused" : "cannot";
	if (!line->run)
		return text("%s,%s,%s,%s,%s,%s,none,", w, w, w, w, w, w);
	const struct error e = error_of(line->run, t);
	const long evaluations = line->run->evaluations(line->run);
	if (e.failed)
		return "failed,failed,failed,failed,failed,1,none,";
	return text("%.4g,%.4g,%.4g,%.4g,%.4g,0,%s,", e.q_end, e.q_between, e.v_end, e.v_between, e.largest,
	            evaluations < 0 ? "none" : text("%.6g", (double)evaluations / p->units));
}

/* The largest error is the fifth column; what is no number there has failed */
static void keep_found(struct line *line, const char *found)
{
	snprintf(line->found, sizeof line->found, "%s", found);
	if (sscanf(line->found, "%*[^,],%*[^,],%*[^,],%*[^,],%lf,", &line->largest) != 1)
		line->largest = NAN;
}

static void find_errors(struct lines *lines, const struct problem *p, const struct truth *t)
{
	lines->agreement = t->agreement;
	for (EACH_LINE(lines)) {
		say_progress("%s: error of %s, %g", p->name, line->method->name, line->setting);
		keep_found(line, error_columns(line, p, t));
	}
}

/* FOLDER/NAME.errors keeps these: first what the problem learns of its truth, then a line a run, which is its name,
 * setting and columns */
static void keep_errors(const struct lines *lines, const struct problem *p, const char *folder)
{
	FILE *out = file_in(folder, text("%s.errors", p->name), "w");
	fprintf(out, "%d %.17g %.17g %.17g\n", p->units, p->scale_q, p->scale_v, lines->agreement);
	for (EACH_LINE(lines))
		fprintf(out, "%s\t%.6g\t%s\n", line->method->name, line->setting, line->found);
	table_close(out, p->name);
}

/* The problem's scales alone, before a run is opened; NULL: there is no such file */
static FILE *open_errors(struct lines *lines, struct problem *p, const char *folder)
{
	FILE *in = fopen(text("%s/%s.errors", folder, p->name), "r");
	int units;
	if (in && (fscanf(in, "%d %lf %lf %lf\n", &units, &p->scale_q, &p->scale_v, &lines->agreement) != 4 ||
	           units != p->units))
		leave(p->name, "its .errors is of another history");
	return in;
}

/* Leaves the program where the file has not the same runs */
static void read_errors(struct lines *lines, const struct problem *p, FILE *in)
{
	char row[400];
	bool good = true;
	for (EACH_LINE(lines)) {
		const char *expected = text("%s\t%.6g\t", line->method->name, line->setting);
		good = good && fgets(row, sizeof row, in) && strncmp(row, expected, strlen(expected)) == 0;
		row[strcspn(row, "\n")] = '\0';
		keep_found(line, good ? row + strlen(expected) : "");
	}
	if (!good || fgets(row, sizeof row, in))
		leave(p->name, "its .errors has not the runs that there are");
	fclose(in);
}

/* ---- times: once errors are known, of what did not fail ----
 *
 * A ladder is a peer's tolerances from the widest on, and a narrower one takes no less time. So where a pass is long
 * and one setting takes 20 times what is cheapest at the error of the next, that and all after it are left without a
 * time: they could only be dearer still. */

enum { DEAR = 20 };
static const double long_pass = 0.25e9;         /* ns of a history */

static bool is_dear(int k, const struct samples *so_far, void *of)
{
	struct line *const *turn = of, *const line = turn[k], *const before = line - 1;
	if (line->rung == 0 || !line->method->tolerance)
		return false;
	line->dear = before->dear;
	const struct samples *last = &so_far[k - 1];
	if (k == 0 || turn[k - 1] != before || last->count == 0 ||
	    last->min * line->run->problem->units < long_pass)
		return line->dear;
	for (int i = 0; i < k && !line->dear; i++)
		line->dear = turn[i]->largest <= line->largest && so_far[i].count > 0 &&
		             DEAR * so_far[i].min <= last->min;
	return line->dear;
}

/* First what has no ladder, so that it is known which of their settings are dear */
static int in_turn(struct lines *lines, struct line **turn)
{
	int count = 0;
	for (int ladders = 0; ladders < 2; ladders++)
		for (EACH_LINE(lines))
			if (line->run && !isnan(line->largest) &&
			    ladders == (line->method->family != OURS && line->method->tolerance))
				turn[count++] = line;
	return count;
}

static void find_times(struct lines *lines, double seconds)
{
	static struct run *run[MOST_LINES];
	static struct samples samples[MOST_LINES];
	static struct line *turn[MOST_LINES];
	const int count = in_turn(lines, turn);
	for (int k = 0; k < count; k++)
		run[k] = turn[k]->run;
	sample_ladders(count, run, seconds, is_dear, turn, samples);
	for (int k = 0; k < count; k++) {
		turn[k]->samples = samples[k];
		if (samples[k].count > 0 && samples[k].median * run[k]->problem->units < long_pass)
			turn[k]->pass = sample_pass(run[k]);
	}
}

/* ---- the table ---- */

static void put_line(FILE *out, const struct lines *lines, const struct line *line, const struct problem *p)
{
	const struct method *method = line->method;
	const struct samples *ns = &line->samples;
	const bool of_ours = method->family == OURS;
	fprintf(out, "%s,", p->name);
	put_quoted(out, method->name);
	fprintf(out, ",%s,%s,%.6g,%s", family_names[method->family], method->tolerance ? "tolerance" : "step",
	        line->setting, line->found);
	if (ns->count > 0)
		fprintf(out, "%.5g,%.5g,%.5g,%d,%d,", ns->min, ns->median, ns->max, ns->count, p->units);
	else
		fputs(line->dear ? "dear,dear,dear,dear,dear," : "none,none,none,none,none,", out);
	put_number(out, "%.5g", line->pass > 0 ? line->pass : NAN, line->dear ? "dear" : "none");
	put_quoted(out, line->refused ? line->refused : of_ours ? text("%s; %s", method->settings, line->run ?
		generated_between(line->run) : "") : method->settings);
	fprintf(out, ",%.2g,%g,%g\n", lines->agreement, p->unit, p->unit * p->units);
}

static struct problem *load(const struct charted *m, const char *folder, bool quick)
{
	return problem_load(text("%s/%s.so", folder, m->name), m->name, value_of(m->unit),
	                    quick ? m->quick_units : m->units, m->linear, m->w);
}

static void say_scales(FILE *out, const struct charted *m, const char *folder, bool quick)
{
	struct problem *p = load(m, folder, quick);
	truth_free(truth_of(p));
	put_scales(out, p, m->name, text("%s/%s.so", folder, m->name));
	problem_free(p);
}

/* out: the table; NULL: errors alone, which are kept */
static void measure(FILE *out, const struct charted *m, const char *folder, bool quick, double seconds)
{
	struct problem *p = load(m, folder, quick);
	struct lines lines = { .line = room_for(MOST_LINES, sizeof *lines.line) };
	FILE *known = out ? open_errors(&lines, p, folder) : NULL;
	struct truth *t = known ? NULL : truth_of(p);
	add_all(&lines, m, p, quick, folder);
	if (known) {
		read_errors(&lines, p, known);
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
	for (EACH_LINE(&lines)) {
		if (out)
			put_line(out, &lines, line, p);
		if (line->run)
			line->run->close(line->run);
		free(line->refused);
	}
	free(lines.line);
	problem_free(p);
}

int main(int argc, char **argv)
{
	const unsigned flags = flags_of(argc, &argv, "--quick --list --names --scales --errors", 0, MODELS + 2,
		"precision --list [--quick] [MODEL...]\n"
		"       precision [--quick] VARIANTS FILE.csv [MODEL...]\n"
		"       precision --names [--quick] [MODEL...]\n"
		"       precision --errors [--quick] VARIANTS [MODEL...]\n"
		"       precision --scales [--quick] VARIANTS [MODEL...]");
	const bool quick = flags & 1, list = flags & 2, names = flags & 4, scales = flags & 8, errors = flags & 16;
	char **named = argv + (list || names ? 0 : scales || errors ? 1 : 2);
	FILE *out = named < argv + 2 ? stdout : table_open("", argv[1], "model,method,family,setting_kind,setting,"
		"q_end,q_between,v_end,v_between,largest,failed,evaluations_per_unit,ns_min,ns_median,ns_max,"
		"ns_samples,ns_units,ns_pass,settings,truth_agreement,unit_s,history_s");
	for (int i = 0; *named ? named[i] != NULL : i < MODELS; i++) {
		const struct charted *m = *named ? model_named(named[i]) : &models[i];
		if (!*named && quick && !scales && !m->quick)
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
