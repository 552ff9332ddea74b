/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command line: options as a table, from which usage is written, and their values. */
#define _GNU_SOURCE     /* getopt_long */
#include "command.h"
#include "report/report.h"
#include "step/linear/forms.h"

#include <getopt.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- what each option sets ---- */

static void note_in_banner(struct options *options, const char *option)
{
	options->banner = format("%s%s%s", options->banner, *options->banner ? " " : "", option);
}

static void set_print(struct options *options, enum print print)
{
	if (options->print != PRINT_C)
		wrong_usage("--header, --target, --explain, --solution, --response, --plot and --report exclude "
			    "each other");
	options->print = print;
}

/* Of an option with two values: is it the second? */
static bool is_second(const char *option, const char *value, const char *first, const char *second)
{
	if (strcmp(value, first) != 0 && strcmp(value, second) != 0)
		wrong_usage(format("%s takes %s or %s, found '%s'", option, first, second, value));
	return strcmp(value, second) == 0;
}

static void take_explain(struct options *options, const char *value)
{
	if (value && strcmp(value, "json") != 0 && strcmp(value, "program") != 0)
		wrong_usage(format("--explain takes nothing, =json or =program, found '%s'", value));
	set_print(options, !value ? PRINT_EXPLAIN : strcmp(value, "json") == 0 ? PRINT_JSON : PRINT_PROGRAM);
}

static void take_solution(struct options *options, const char *value)
{
	if (ends_in(value, ".spec"))
		wrong_usage(format("--solution takes a time before the spec, --solution 10, found '%s'", value));
	set_print(options, PRINT_SOLUTION);
	options->solution = value;
	options->request.solution = true;
}

static void take_plot(struct options *options, const char *value)
{
	options->campbell.wanted = strcmp(value, "campbell") == 0;
	const char *wrong = options->campbell.wanted ? NULL : wrong_picture(value);
	if (wrong)
		wrong_usage(format("--plot takes %s, found '%s'", PICTURE_KINDS, wrong));
	set_print(options, PRINT_PLOT);
	options->value = value;
}

static void take_size(struct options *options, const char *value)
{
	if (!picture_size(&options->look, value))
		wrong_usage(format("--size takes WIDTHxHEIGHT, each from 20 to 10000, found '%s'", value));
}

static void take_real(struct options *options, const char *value)
{
	options->request.real_given = true;
	options->request.single = is_second("--real", value, "double", "float");
}

static void take_form(struct options *options, const char *value)
{
	if (!step_form_of(value, &options->request.form))
		wrong_usage(format("--form takes auto, direct, delta, kick-drift-kick or modal, found '%s'", value));
}

static void take_loads(struct options *options, const char *value)
{
	const char *name = strcmp(value, "leftover") == 0 ? "remainder" : value; /* its name in earlier versions */
	options->request.loads_left = is_second("--loads", name, "exact", "remainder");
}

/* 0: it is none from 1 to `most` */
static int count_of(const char *value, int most)
{
	char *end;
	const long count = strtol(value, &end, 10);
	return *value < '0' || *value > '9' || *end || count < 1 || count > most ? 0 : (int)count;
}

static void take_refresh(struct options *options, const char *value)
{
	options->request.refresh = count_of(value, MOST_REFRESHED);
	if (!options->request.refresh)
		wrong_usage(format("--refresh takes a number of steps, 1 to %d, found '%s'", MOST_REFRESHED, value));
}

static void take_definition(struct options *options, const char *value)
{
	const char *equals = strchr(value, '=');
	if (!equals || equals == value || equals[1] == 0)
		wrong_usage(format("-D takes NAME=EXPR, found '%s'", value));
	*MORE(options->definition, options->definitions) = value;
	note_in_banner(options, format("-D %s", value));
}

static void take_params(struct options *options, const char *value)
{
	if (!ends_in(value, ".json") && !ends_in(value, ".csv"))
		wrong_usage(format("--params takes FILE.json or FILE.csv, found '%s'", value));
	if (options->params)
		wrong_usage("--params is given twice");
	options->params = value;
}

static void take_reduce(struct options *options, const char *value)
{
	(void)value;
	options->request.reduce = true;
	note_in_banner(options, "--reduce");
}

static void take_fmu_version(struct options *options, const char *value)
{
	options->fmu.version = is_second("--fmu-version", value, "2", "3") ? 3 : 2;
}

static void take_external(struct options *options, const char *value)
{
	if (strcmp(value, "casadi") != 0)
		wrong_usage(format("--external takes casadi, found '%s'", value));
	options->request.external = true;
	note_in_banner(options, "--external casadi");
}

static void take_target(struct options *options, const char *value)
{
	if (strcmp(value, "opencl") != 0 && strcmp(value, "cuda") != 0 && strcmp(value, "openmp") != 0)
		wrong_usage(format("--target takes opencl, cuda or openmp, found '%s'", value));
	set_print(options, PRINT_KERNEL);
	options->target = value;
	options->request.many.batch = options->request.many.device = true;
	note_in_banner(options, format("--target %s", value));
}

static void take_fmu_binary(struct options *options, const char *value)
{
	options->fmu.binary = true;
	options->fmu.headers = value;
}

/* Its model steps as plrun's does, but for the functions of libm, which WebAssembly has not. */
static void take_page(struct options *options)
{
	if (!options->page)
		return;
	options->bundle = options->request.fast = options->request.own_math = true;
	options->page_in_report = options->print == PRINT_REPORT;
	if (options->page_in_report)
		options->print = PRINT_C;
}

static void take_rows(struct options *options, const char *value)
{
	options->request.rows = count_of(value, LIMIT_BLOCK_ROWS);
	if (!options->request.rows)
		wrong_usage(format("--rows takes a number from 1 to %d, found '%s'", LIMIT_BLOCK_ROWS, value));
}

static void print_usage(struct options *options, const char *value);

/* The folder of this program, so that what is installed together may be moved together; NULL: not known */
static const char *own_folder(void)
{
	static char path[4096];
	ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
	path[length > 0 ? length : 0] = 0;
	char *slash = strrchr(path, '/');
	if (!slash)
		return NULL;
	*slash = 0;
	return path;
}

/* What is installed as datadir/plgen/NAME and stands in the source tree at `tree`, seen from this program: the folder
 * that has `file`, `named` first and `otherwise` last, where they are not NULL; NULL: none */
static const char *data_folder(const char *name, const char *tree, const char *file, const char *named,
			       const char *otherwise)
{
	const char *own = own_folder();
	const char *place[] = { named && *named ? named : NULL,
				own ? format("%s/%s/plgen/%s", own, PLGEN_DATA_FROM_BIN, name) : NULL,
				own ? format("%s/../%s", own, tree) : NULL, otherwise };
	for (size_t i = 0; i < sizeof place / sizeof *place; i++)
		if (place[i] && access(format("%s/%s", place[i], file), R_OK) == 0) {
			char *real = need_memory(realpath(place[i], NULL));
			const char *folder = format("%s", real);
			free(real);
			return folder;
		}
	return NULL;
}

/* Ends the program where it is not found. */
static const char *runtime_folder(void)
{
	const char *folder = data_folder("runtime", "runtime", "plrt.h", getenv("PLGEN_RUNTIME"), PLGEN_RUNTIME);
	if (folder)
		return folder;
	fputs("plgen: error: the runtime, plrt.h, is not there\n"
	      "note: the environment's PLGEN_RUNTIME names its folder\n", stderr);
	exit(1);
}

static void print_runtime_folder(struct options *options, const char *value)
{
	(void)options;
	(void)value;
	printf("%s\n", runtime_folder());
	exit(0);
}

static void print_version(struct options *options, const char *value)
{
	(void)options;
	(void)value;
	fputs("plgen " PLGEN_VERSION "\n", stdout);
	exit(0);
}

/* ---- the options, in the order of usage ---- */

#define AT(member) offsetof(struct options, member)

static const struct row {
	const char *name;               /* of one letter: -o; else --name */
	const char *argument;           /* in brackets: optional; NULL: none */
	/* NULL: of the last line, which lists those that need no words; older names, with arguments, are not listed */
	const char *help;
	void (*take)(struct options *options, const char *value);
	const char *(*values)(const char *separator); /* closes the help */
	/* without `take`: what is set to the value; to true, where there is an argument only by that word; what is
	 * printed. All 0: it is a line of usage only */
	size_t text, flag;
	enum print print;
} rows[] = {
	{ "o", "FILE.c", "write FILE.c and the header FILE.h beside it", .text = AT(output) },
	{ "header", NULL, "print the header instead of the C", .print = PRINT_HEADER },
	{ "explain", "[=json]", "print what was derived: matrices, B(s), poles, Phi, cost", .take = take_explain },
	{ "explain", "=program", "print what a step does, before it is C", .take = NULL },
	{ "solution", "T", "print the closed-form solution at every step up to T as CSV", .take = take_solution },
	{ "response", "F0:F1[:N]", "print the frequency response from F0 to F1 Hz as CSV, N frequencies (200)",
	  .text = AT(value), .print = PRINT_RESPONSE },
	{ "amplitude", "A", "of an excitation: clearances are swept by it, up and down (--response, --plot frf)",
	  .text = AT(amplitude) },
	{ "at", "rest|t=3|x=0.1,...", "of a nonlinear model: its linear equations at rest, then, or at these states",
	  .text = AT(at) },
	{ "equilibrium", NULL, "list equilibria: coordinates, stability, poles (--explain=json: for a program)",
	  .flag = AT(equilibrium) },
	{ "plot", "KIND,...", "draw response, poles, modes, frf by gnuplot; -o FILE.svg, .png or .pdf",
	  .take = take_plot },
	{ "sweep", "w=0:500[:N]", "of --plot campbell: poles over a param, 61 values; -o also FILE.csv, FILE.json",
	  .text = AT(campbell.sweep) },
	{ "orders", "1,2,...", "of --plot campbell: multiples of the speed that are drawn (default: 1)",
	  .text = AT(campbell.orders) },
	{ "whirl", "x:y,...", "of --plot campbell: pairs of coordinates, forward from the first to the second",
	  .text = AT(campbell.whirl) },
	{ "title", "TEXT", "of a picture, or of the page of --report", .text = AT(look.title) },
	{ "size", "WxH", "of a picture: pixels, with --paper millimetres", .take = take_size },
	{ "dark", NULL, "pictures and page light on dark", .flag = AT(look.dark) },
	{ "paper", NULL, "a picture for print: a column of 85 mm; .pdf has its fonts inside", .flag = AT(look.paper) },
	{ "report", NULL, "print a page of HTML: equations, modes, pictures, what was chosen", .print = PRINT_REPORT },
	{ "page", "FILE.html", "write one page that runs the model in a browser; made by clang", .text = AT(page) },
	{ "rhs", NULL, "also emit NAME_rhs: the equations as written", .flag = AT(rhs) },
	{ "step", "EXPR", "instead of the spec's step", .text = AT(request.step) },
	{ "scheme", "NAME", "instead of the spec's: ", .values = all_schemes, .text = AT(request.scheme) },
	{ "tolerance", "EXPR", "of taylor, radau, auto: the error that a step may make, relative to each state",
	  .text = AT(request.tolerance) },
	{ "real", "float", "numbers and arithmetic of type float (default: double)", .take = take_real },
	{ "form", "NAME", "of a linear step: auto direct delta kick-drift-kick modal", .take = take_form },
	{ "accuracy", "compensated", "two-word factors, and what rounding takes from the state is kept",
	  .flag = AT(request.compensated) },
	{ "math", "own", "sin, exp, pow and their kin of the runtime: the same bits on every target",
	  .flag = AT(request.own_math) },
	{ "loads", "remainder", "leave known loads to the scheme's quadrature (default: exact)", .take = take_loads },
	{ "sensitivity", "k,c,x", "also emit derivatives by params, initial values, inputs: NAME_step_d",
	  .text = AT(request.sensitivity) },
	{ "tunable", "k,c", "more params that the running program may change, as the statement says",
	  .text = AT(tunable) },
	{ "external", "casadi", "also emit NAME_casadi: one step with its Jacobian, as an external function of CasADi",
	  .take = take_external },
	{ "target", "opencl", "print a kernel instead, of the step of NAME_batch: opencl, cuda or openmp",
	  .take = take_target },
	{ "fast", NULL, "with tables for long runs: NAME_run by blocks of rows, and --refresh",
	  .flag = AT(request.fast) },
	{ "refresh", "N", "cos, sin, exp of loads every N steps, rotated between by a table; 1: every step (default)",
	  .take = take_refresh },
	{ "anchors", "N", .take = take_refresh },
	{ "D", "NAME=EXPR", "another value for a param, or matrix; of the spec's params too", .take = take_definition },
	{ "params", "FILE", "values of params from FILE.json or FILE.csv; those of -D win", .take = take_params },
	{ "prefix", "NAME", "instead of the model's name for everything generated", .text = AT(request.prefix) },
	{ "reduce", NULL, "leave out what the outputs cannot see", .take = take_reduce },
	{ "modes", "N", "keep the N modes that matter most to the outputs; 1,2,9: those", .text = AT(request.modes) },
	{ "rows", "K", "in a block of NAME_run; 1: step by step (default; with --fast: by the model's size)",
	  .take = take_rows },
	{ "a2l", "FILE.a2l", "also write names of states, outputs and tunable params for calibration tools",
	  .text = AT(a2l) },
	{ "depfile", "FILE", "also write a make/ninja dependency file", .text = AT(depfile) },
	{ "selftest", NULL, "also emit NAME_selftest: steps against the closed form", .flag = AT(request.selftest) },
	{ "batch", NULL, "also emit NAME_batch: many instances in one call",
	  .flag = AT(request.many.batch) },
	{ "fmu", "FILE.fmu", "write an FMU for co-simulation, with its C as source", .text = AT(fmu) },
	{ "fmu-version", "2", "of FMI: 2 or 3 (default: 3)", .take = take_fmu_version },
	{ "fmu-binary", "[=DIR]", "compiled too; with DIR against the standard's headers there",
	  .take = take_fmu_binary },
	{ "bundle", NULL, "the C with what it needs of the runtime inside", .flag = AT(bundle) },
	{ "runtime-dir", NULL, "print the folder of the runtime", .take = print_runtime_folder },
	{ "strict", NULL, "warnings are errors", .flag = AT(strict) },
	{ "h", .take = print_usage },
	{ "help", .take = print_usage },
	{ "version", .take = print_version }
};
/* LONG + its row is what getopt_long returns for a long option. */
enum { ROWS = sizeof rows / sizeof *rows, LONG = 256 };

static bool is_short(const struct row *row)
{
	return !row->name[1];
}

static int values_of(const struct row *row)
{
	return !row->argument ? no_argument : row->argument[0] == '[' ? optional_argument : required_argument;
}

/* ---- usage ---- */

static void print_row(const struct row *row)
{
	const char *argument = row->argument ? row->argument : "", *space = strchr("[=", *argument) ? "" : " ";
	const char *option = format("%s%s%s%s", is_short(row) ? "-" : "--", row->name, space, argument);
	printf("  %-19s%s%s%s\n", option, strlen(option) < 19 ? " " : "   ", row->help,
	       row->values ? row->values(" ") : "");
}

static _Noreturn void print_usage(struct options *options, const char *value)
{
	const char *rest = "";
	(void)options;
	(void)value;
	fputs("usage: plgen [options] MODEL.spec      ('-' reads standard input)\n\n"
	      "Reads the equations of a vibration model and writes C that steps it to standard output.\n\n", stdout);
	for (int i = 0; i < ROWS; i++)
		if (rows[i].help)
			print_row(&rows[i]);
		else if (!rows[i].argument)
			rest = format("%s%s%s%s", rest, *rest ? ", " : "", is_short(&rows[i]) ? "-" : "--",
				      rows[i].name);
	printf("  %s\n\n"
	       "Exit status: 0 done; 1 the spec is wrong or a file cannot be read or written; 2 the command line is "
	       "wrong.\n",
	       rest);
	exit(0);
}

/* ---- the line ---- */

/* For getopt_long: ":o:D:", and the long options */
static const char *fill_known(struct option *known)
{
	const char *letters = ":";
	for (int i = 0; i < ROWS; i++) {
		const struct row *row = &rows[i];
		if (is_short(row))
			letters = format("%s%s%s", letters, row->name, row->argument ? ":" : "");
		else if (row->take || row->text || row->flag || row->print)
			*known++ = (struct option){ row->name, values_of(row), NULL, LONG + i };
	}
	return letters;
}

static const struct row *row_of(int option)
{
	if (option >= LONG)
		return &rows[option - LONG];
	for (int i = 0; i < ROWS; i++)
		if (is_short(&rows[i]) && rows[i].name[0] == option)
			return &rows[i];
	return NULL;
}

/* What is meant by an option that there is not: --steps, --float; or NULL */
static const char *nearest_option(const char *word)
{
	static const struct { const char *word, *option; } habit[] = {
		{ "float", "real float" }, { "single", "real float" }, { "double", "real double" },
		{ "json", "explain=json" }, { "output", NULL }, { "dt", "step" }, { "method", "scheme" },
		{ "solver", "scheme" }, { "until", "solution" }, { "usage", "help" }, { "Werror", "strict" },
		{ "werror", "strict" }
	};
	const char *known[ROWS];
	word += strspn(word, "-");
	word = format("%.*s", (int)strcspn(word, "="), word);
	for (size_t i = 0; i < sizeof habit / sizeof *habit; i++)
		if (strcmp(word, habit[i].word) == 0)
			return habit[i].option ? format("--%s", habit[i].option) : "-o";
	int long_ones = 0;                      /* what is one letter is like any short word */
	for (int i = 0; i < ROWS; i++) {
		if (strcmp(word, rows[i].name) == 0)
			return NULL;            /* it is there, and takes no value */
		if (rows[i].name[1])
			known[long_ones++] = rows[i].name;
	}
	const char *nearest = nearest_name(word, long_ones, known);
	return nearest ? format("--%s", nearest) : NULL;
}

/* `word` is where getopt_long stood: of a long option it does not say more. */
static _Noreturn void not_taken(int option, const char *word)
{
	bool letter = optopt > 0 && optopt < LONG;
	const char *shown = letter ? format("-%c", optopt) : format("'%s'", word);
	if (option == ':')
		wrong_usage(format("option %s needs a value", shown));
	const char *nearest = letter ? NULL : nearest_option(word);
	if (nearest)
		wrong_usage(format("unknown option or surplus value: %s; did you mean %s?", shown, nearest));
	wrong_usage(letter ? format("unknown option '%s'", shown)
			   : format("unknown option or surplus value: %s", shown));
}

static void take(const struct row *row, struct options *options, const char *value)
{
	if (row->print)
		set_print(options, row->print);
	if (row->take)
		row->take(options, value);
	else if (row->text)
		*(const char **)((char *)options + row->text) = value;
	else if (row->flag && row->argument && strcmp(value, row->argument) != 0)
		wrong_usage(format("--%s takes %s, found '%s'", row->name, row->argument, value));
	else if (row->flag)
		*(bool *)((char *)options + row->flag) = true;
}

static void take_all(int argc, char **argv, struct options *options)
{
	struct option known[ROWS + 1] = { 0 };
	const char *letters = fill_known(known);
	int option;
	opterr = 0;
	for (int before = optind; (option = getopt_long(argc, argv, letters, known, NULL)) != -1; before = optind) {
		if (option == '?' || option == ':')
			not_taken(option, argv[before]);
		take(row_of(option), options, optarg);
	}
	for (int i = optind; i < argc && options->print == PRINT_EXPLAIN; i++)
		if (strcmp(argv[i], "json") == 0 || strcmp(argv[i], "program") == 0)
			wrong_usage(format("the value of --explain is written with =: --explain=%s", argv[i]));
	if (optind == argc)
		wrong_usage("no spec is given");
	if (optind + 1 < argc)
		wrong_usage(format("one spec at a time: surplus argument '%s'", argv[optind + 1]));
	options->spec = argv[optind];
}

static void note_value(struct options *options, const char *option, const char *value)
{
	if (value)
		note_in_banner(options, format("%s %s", option, value));
}

static void note_flag(struct options *options, const char *option, bool is)
{
	if (is)
		note_in_banner(options, option);
}

/* Those that change the model come as they are given; these in one order, so that the banner has them alike. */
static void note_all(struct options *options)
{
	const struct request *request = &options->request;
	note_value(options, "--scheme", request->scheme);
	note_value(options, "--tolerance", request->tolerance);
	const char *slash = options->params ? strrchr(options->params, '/') : NULL;
	note_value(options, "--params", slash ? slash + 1 : options->params);
	note_value(options, "--modes", request->modes ? format("\"%s\"", request->modes) : NULL);
	note_value(options, "--sensitivity", request->sensitivity);
	note_value(options, "--tunable", options->tunable);
	note_value(options, "--step", request->step);
	note_value(options, "--prefix", request->prefix);
	note_flag(options, "--loads remainder", request->loads_left);
	note_flag(options, "--real float", request->single);
	note_value(options, "--form", request->form != FORM_AUTO ? step_form_name(request->form) : NULL);
	note_flag(options, "--accuracy compensated", request->compensated);
	note_flag(options, "--math own", request->own_math);
	note_flag(options, "--fast", request->fast);
	note_value(options, "--refresh", request->refresh ? format("%d", request->refresh) : NULL);
	note_value(options, "--rows", request->rows ? format("%d", request->rows) : NULL);
	note_flag(options, "--selftest", request->selftest);
	note_flag(options, "--rhs", options->rhs);
	note_flag(options, "--bundle", options->bundle);
}

void read_options(int argc, char **argv, struct options *options)
{
	options->banner = "";
	read_parts_from(data_folder("parts", "share/parts", "road_iso8608.spec", NULL, NULL));
	take_all(argc, argv, options);
	take_page(options);
	options->request.phasors = options->request.fast || options->request.many.batch || options->fmu.path;
	if (options->request.external && (options->request.sensitivity || options->request.single || options->fmu.path))
		wrong_usage(format("--external casadi has derivatives by states and inputs, in doubles: without %s",
				   options->request.sensitivity ? "--sensitivity" : options->fmu.path ? "--fmu"
								: "--real float"));
	options->request.explained = options->print == PRINT_EXPLAIN || options->print == PRINT_JSON;
	note_all(options);
	find_together(options);
}
