/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command line. What is plgen's is passed on as it stands; messages about it are plgen's. */
#define _GNU_SOURCE
#include "plrun.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct words {                          /* of the command line, and which is next */
	char **word;
	int count, next;
};

static double time_of(const char *what, const char *text)
{
	double value;
	if (!read_number(text, &value) || value < 0)
		wrong_usage(format("%s: expected a time in seconds, finite and not negative, found '%s'", what, text));
	return value;
}

static struct pair pair_of(const char *option, const char *what, const char *text)
{
	const char *equals = strchr(text, '=');
	if (!equals || equals == text || !equals[1])
		wrong_usage(format("%s takes %s, found '%s'", option, what, text));
	return (struct pair){ need(strndup(text, (size_t)(equals - text))), equals + 1 };
}

static void add_pair(struct pair **list, size_t *count, struct pair pair)
{
	for (size_t i = 0; i < *count; i++)
		if (strcmp((*list)[i].name, pair.name) == 0)
			wrong_usage(format("'%s' is given twice", pair.name));
	*list = need(reallocarray(*list, *count + 1, sizeof pair));
	(*list)[(*count)++] = pair;
}

static void pass_on(struct options *o, const char *word)
{
	o->passed = grown(o->passed, o->passed_count, &o->passed_room, sizeof *o->passed);
	o->passed[o->passed_count++] = word;
}

/* ---- what each option sets ---- */

static void take_until(struct options *o, const char *value)
{
	if (o->until >= 0)
		wrong_usage("the time of the end is given twice");
	o->until = time_of("--until", value);
}

static void take_every(struct options *o, const char *value) { o->every = time_of("--every", value); }
static void take_psd(struct options *o, const char *value) { read_window(o, value); }
static void take_progress(struct options *o, const char *value) { (void)o; (void)value; progress_always(); }

static void take_log(struct options *o, const char *value)
{
	o->look.log_x = *value == 'x';
	o->look.log_y = strcmp(value + o->look.log_x, "y") == 0;
	o->look.log = true;
	if (strlen(value) != (size_t)(o->look.log_x + o->look.log_y))
		wrong_usage(format("--log takes x, y or xy, found '%s'", value));
}

static void take_size(struct options *o, const char *value)
{
	if (!picture_size(&o->look.as, value))
		wrong_usage(format("--size takes WIDTHxHEIGHT, each from 20 to 10000, found '%s'", value));
}

/* A file, or ranges: of several every combination */
static void take_sweep(struct options *o, const char *value)
{
	if (o->sweep && (!is_range(value) || o->ranges == 0))
		wrong_usage("--sweep: one file, or ranges");
	o->sweep = o->sweep ? o->sweep : value;
	if (!is_range(value))
		return;
	o->range = need(reallocarray(o->range, o->ranges + 1, sizeof *o->range));
	o->range[o->ranges++] = range_of(value);
}

/* k or k=FROM:TO */
static void add_fit(struct options *o, char *word)
{
	char *range = strchr(word, '='), *to = range ? strchr(range, ':') : NULL;
	double *ends;
	o->fit = need(reallocarray(o->fit, o->fits + 2, sizeof *o->fit));
	o->fit_range = need(reallocarray(o->fit_range, o->fits + 1, sizeof *o->fit_range));
	ends = o->fit_range[o->fits];
	ends[0] = ends[1] = 0;
	if (range)
		*range = 0;
	if (to)
		*to = 0;
	if (!*word || (range && !(to && read_number(range + 1, &ends[0]) && read_number(to + 1, &ends[1]) &&
				  ends[0] < ends[1])))
		wrong_usage("--fit takes names of params and states, k,c,x, each with a range or none: k=100:900");
	o->fit[o->fits++] = word;
	o->fit[o->fits] = NULL;
}

static void take_fit(struct options *o, const char *value)
{
	char *rest = need(strdup(value));
	if (o->fit)
		wrong_usage("--fit: one list, k,c,x");
	for (char *word; (word = strsep(&rest, ",")) != NULL;)
		add_fit(o, word);
}

static void take_sigma(struct options *o, const char *value)
{
	const struct pair pair = pair_of("--sigma", "NAME=NUMBER", value);
	double sigma;
	if (!read_number(pair.value, &sigma) || !(sigma > 0))
		wrong_usage(format("--sigma takes a number above 0, found '%s'", value));
	add_pair(&o->sigma, &o->sigmas, pair);
}

static void take_column(struct options *o, const char *value)
{
	add_pair(&o->column, &o->columns, pair_of("--column", "NAME=HEADER", value));
}

static void take_definition(struct options *o, const char *value)
{
	add_pair(&o->definition, &o->definitions, pair_of("-D", "NAME=EXPR", value));
}

static void take_jobs(struct options *o, const char *value)
{
	char *end;
	long jobs = strtol(value, &end, 10);
	if (*value < '0' || *value > '9' || *end || jobs < 1 || jobs > 4096)
		wrong_usage(format("--jobs takes a number from 1 to 4096, found '%s'", value));
	o->jobs = (int)jobs;
}

/* It would be a command of gnuplot. */
static void refuse_controls(const char *value, const char *what)
{
	for (const char *c = value; *c; c++)
		if ((unsigned char)*c < ' ' || *c == 127)
			wrong_usage(format("%s of the picture has a control character in it", what));
}

static void take_title(struct options *o, const char *value)
{
	refuse_controls(value, "--title: the title");
	o->look.as.title = value;
}

static void take_plot(struct options *o, const char *value)
{
	refuse_controls(value ? value : "", "--plot: the name");
	o->plot = true;
	o->plot_file = value;
}

static _Noreturn void print_usage(struct options *o, const char *value);

static _Noreturn void print_version(struct options *o, const char *value)
{
	(void)o;
	(void)value;
	puts("plrun " PLRUN_VERSION);
	exit(0);
}

/* ---- the options, in the order of usage ---- */

#define AT(member) offsetof(struct options, member)

static const struct row {
	const char *name, *argument, *help;     /* argument: NULL: none, in brackets: a picture's name or none */
	void (*take)(struct options *o, const char *value);
	size_t text, flag;              /* without `take`: what is set to the value, to true; all 0: plgen's */
} rows[] = {
	{ "until", "T", "time of the end [s], as T behind the spec (default with --input: where the record ends)",
	  .take = take_until },
	{ "every", "DT", "rows and points every DT seconds, a multiple of the step (default: every step)",
	  .take = take_every },
	{ "input", "FILE.csv", "samples of the inputs, one column each, in any order; - reads standard input",
	  .text = AT(input) },
	{ "column", "NAME=HEADER", "the input NAME is the column HEADER; columns without use are then passed over",
	  .take = take_column },
	{ "time", "HEADER", "the column of times [s] (default: one called t or time); without one row k is at k steps",
	  .text = AT(time) },
	{ "D", "NAME=EXPR", "another value for a param; of a tunable one nothing is compiled anew",
	  .take = take_definition },
	{ "o", "FILE.csv", "the rows, or what a sweep comes to, in a file (default: standard output)",
	  .text = AT(output) },
	{ "raw", NULL, "the rows as doubles in the machine's order of bytes, t and the columns, no names",
	  .flag = AT(raw) },
	{ "plot", "[FILE]", "a picture by gnuplot: .svg, .png or .pdf; without FILE a window", .take = take_plot },
	{ "show", "LIST", "outputs or states in rows and picture: z,acc panels, z+zf in one, x:x' is x' over x",
	  .text = AT(show) },
	{ "units", NULL, "... names of columns with their units, x [mm], where the model has some", .flag = AT(units) },
	{ "log", "x|y|xy", "... logarithmic axes", .take = take_log },
	{ "title", "TEXT", "... the title (default: the model's name)", .take = take_title },
	{ "size", "WxH", "... in pixels, with --paper in millimetres", .take = take_size },
	{ "dark", NULL, "... light on dark", .flag = AT(look.as.dark) },
	{ "paper", NULL, "... for print: a column of 85 mm; .pdf has its fonts inside", .flag = AT(look.as.paper) },
	{ "psd", "[WINDOW]", "in the place of rows power spectral densities: hann:1024:50 is window:steps:overlap [%]",
	  .take = take_psd },
	{ "stats", NULL, "in the place of rows a line for each output: final, mean, rms, least, largest, peak and when",
	  .flag = AT(stats) },
	{ "sweep", "FILE.csv", "a run for each row of params; a line each: last values and root mean squares;",
	  .take = take_sweep },
	{ "sweep", "K=A:B:N", "... for N values of K from A to B, with :log in equal ratios; again: every combination",
	  .take = take_sweep },
	{ "fit", "LIST", "params, initial values by which outputs come closest to records: SPEC [T] --fit k,c,x r.csv",
	  .take = take_fit },
	{ "sigma", "NAME=X", "... how far samples of this output scatter (default: each as its own values do)",
	  .take = take_sigma },
	{ "profile", NULL, "... in the place of the table the sum of squares as each of them is held elsewhere",
	  .flag = AT(profile) },
	{ "peak", NULL, "... and the largest |value| at the ends of steps", .flag = AT(peak) },
	{ "histories", NULL, "... its picture: every run, at most 8, one on the other", .flag = AT(histories) },
	{ "jobs", "N", "... on N cores (default: all)", .take = take_jobs },
	{ "device", NULL, "... steps on a device of OpenCL, where plgen has a kernel of the model; the same bytes",
	  .flag = AT(device) },
	{ "resume", NULL, "... going on where the same sweep was interrupted", .flag = AT(resume) },
	{ "chart", NULL, "error against time of plgen's steps and other solvers, in the folder -o (default: charts)",
	  .flag = AT(chart) },
	{ "page", "FILE.html", "in the place of a run one page that runs the model in a browser", .text = AT(page) },
	{ "progress", NULL, "how far it is on standard error, also where that is no terminal", .take = take_progress },
	{ "step", "EXPR", .take = NULL }, { "scheme", "NAME", .take = NULL }, { "tolerance", "EXPR", .take = NULL },
	{ "real", "TYPE", .take = NULL }, { "form", "NAME", .take = NULL }, { "accuracy", "NAME", .take = NULL },
	{ "loads", "NAME", .take = NULL }, { "prefix", "NAME", .take = NULL }, { "params", "FILE", .take = NULL },
	{ "refresh", "N", .take = NULL }, { "math", "own", .take = NULL },
	{ "sensitivity", "LIST", .take = NULL }, { "anchors", "N", "", .take = NULL }, { "reduce", NULL, .take = NULL },
	{ "help", NULL, "", .take = print_usage }, { "version", NULL, "", .take = print_version }
};
enum { ROWS = sizeof rows / sizeof *rows };

static _Noreturn void print_usage(struct options *o, const char *value)
{
	(void)o;
	(void)value;
	fputs("usage: plrun [options] MODEL.spec [T]\n\n"
	      "Runs a vibration model from t = 0 to T and writes its outputs as CSV to standard output.\n\n", stdout);
	for (int i = 0; i < ROWS; i++)
		if (rows[i].help && *rows[i].help)
			printf("  %s%s %-*s %s\n", rows[i].name[1] ? "--" : "-", rows[i].name,
			       18 - (int)strlen(rows[i].name) - (rows[i].name[1] != 0),
			       rows[i].argument ? rows[i].argument : "", rows[i].help);
	fputs("  passed on to plgen:", stdout);
	for (int i = 0; i < ROWS; i++)
		if (!rows[i].help)
			printf(" --%s", rows[i].name);
	fputs("\n  --help, --version\n\n"
	      "PLGEN names the generator (default: beside plrun, then in PATH), CC the compiler (cc), CFLAGS more\n"
	      "flags for it, XDG_CACHE_HOME where what is compiled is kept (~/.cache).\n"
	      "Exit status: 0 done; 1 something in the files is wrong, or the run, or a row of a sweep; 2 the command\n"
	      "line is wrong.\n", stdout);
	exit(0);
}

/* ---- the line ---- */

static bool is_picture(const char *word)
{
	const char *dot = word ? strrchr(word, '.') : NULL;
	return dot && (strcmp(dot, ".svg") == 0 || strcmp(dot, ".png") == 0 || strcmp(dot, ".pdf") == 0);
}

/* `length` letters of `word` are the option's name */
static const struct row *row_of(const char *name, size_t length)
{
	for (int i = 0; i < ROWS; i++)
		if (strlen(rows[i].name) == length && strncmp(rows[i].name, name, length) == 0)
			return &rows[i];
	return NULL;
}

/* The value of an option: behind '=' or the letter, or the next word */
static const char *value_of(struct words *w, const struct row *row, const char *given)
{
	const char *next = w->next < w->count ? w->word[w->next] : NULL;
	const char *dashes = row->name[1] ? "--" : "-";
	if (!row->argument) {
		if (given)
			wrong_usage(format("--%s takes no value, found '%s'", row->name, given));
		return NULL;
	}
	if (row->argument[0] == '[') {
		const bool plot = row->take == take_plot;
		if (!given && (plot ? is_picture(next) : is_window(next))) {
			w->next++;
			return next;
		}
		if (given && plot && !is_picture(given))
			wrong_usage(format("--plot draws .svg, .png or .pdf, found '%s'", given));
		return given;
	}
	if (!given && !next)
		wrong_usage(format("option %s%s needs a value: %s", dashes, row->name, row->argument));
	if (!given)
		w->next++;
	return given ? given : next;
}

static void take_option(struct words *w, struct options *o)
{
	const char *word = w->word[w->next++], *name = word[1] == '-' ? word + 2 : word + 1;
	bool is_long = word[1] == '-';
	size_t length = is_long ? strcspn(name, "=") : 1;
	const struct row *row = row_of(name, length);
	if (!row || is_long != (row->name[1] != 0))
		wrong_usage(format("unknown option '%s'", word));
	const char *given = is_long ? (name[length] ? name + length + 1 : NULL) : name[1] ? name + 1 : NULL;
	const char *value = value_of(w, row, given);
	if (row->take)
		row->take(o, value);
	else if (row->text)
		*(const char **)((char *)o + row->text) = value;
	else if (row->flag)
		*(bool *)((char *)o + row->flag) = true;
	else
		pass_on(o, value ? format("--%s=%s", row->name, value) : format("--%s", row->name));
}

static void take_word(struct options *o, const char *word)
{
	if (!o->spec) {
		o->spec = word;
		return;
	}
	const char *dot = strrchr(word, '.');
	if (dot && strcmp(dot, ".spec") == 0)
		wrong_usage(format("one spec at a time: surplus argument '%s'", word));
	if (o->plot && !o->plot_file && dot && !(dot[1] >= '0' && dot[1] <= '9') && dot[1])
		wrong_usage(format("--plot draws .svg, .png or .pdf, found '%s'", word));
	double number;
	if (!read_number(word, &number)) {
		o->fit_record = need(reallocarray(o->fit_record, o->fit_records + 1, sizeof *o->fit_record));
		o->fit_record[o->fit_records++] = word;
		return;
	}
	if (o->until >= 0)
		wrong_usage(format("surplus argument '%s': the time of the end is given", word));
	o->until = time_of("T", word);
}

static void check_look(const struct options *o)
{
	const struct look *l = &o->look;
	const struct picture_look *as = &l->as;
	const char *of_files = as->dark ? "--dark" : as->paper ? "--paper" : as->width > 0 ? "--size" : NULL;
	const char *any = of_files ? of_files : as->title ? "--title" : l->log ? "--log" : NULL;
	if (any && !o->plot)
		wrong_usage(format("%s is of a picture: --plot FILE draws it", any));
	if (of_files && !o->plot_file)
		wrong_usage(format("%s is of a picture in a file: --plot FILE.svg", of_files));
	if (as->dark && as->paper)
		wrong_usage("--paper is light, and --dark is not");
	if (l->log && o->ranges == 2 && !o->histories)
		wrong_usage("--log: the axes of a map are logarithmic where its ranges are, K=A:B:N:log");
	if (as->paper && strcmp(strrchr(o->plot_file, '.'), ".svg") == 0)
		say_note("an SVG names its fonts and has none inside; a .pdf has");
}

/* A chart is of the model as it is written. */
static void check_chart(const struct options *o)
{
	const char *surplus = o->definitions ? "-D" : o->input ? "--input" : o->sweep ? "--sweep" : o->plot ? "--plot"
			    : o->stats ? "--stats" : o->window ? "--psd" : o->show ? "--show"
			    : o->passed_count ? o->passed[0] : NULL;
	if (o->chart && surplus)
		wrong_usage(format("--chart takes the spec, T, --every and -o FOLDER alone, found %s", surplus));
	if (o->chart && o->spec && strcmp(o->spec, "-") == 0)
		wrong_usage("--chart reads the spec many times: it has to be a file");
}

/* A word that is no number is a record of a fit; else a time that cannot be read */
static void check_fit(const struct options *o)
{
	const char *surplus = o->sweep ? "--sweep" : o->stats ? "--stats" : o->window ? "--psd" : o->show ? "--show"
			    : o->every >= 0 ? "--every" : o->units ? "--units" : NULL;
	if (!o->fit && o->fit_records && o->until >= 0)
		wrong_usage(format("surplus argument '%s': the time of the end is given", o->fit_record[0]));
	if (!o->fit && o->fit_records)
		time_of("T", o->fit_record[0]);
	if (!o->fit && (o->sigmas || o->profile))
		wrong_usage(format("%s goes with --fit", o->sigmas ? "--sigma" : "--profile"));
	if (o->fit && o->fit_records == 0)
		wrong_usage("--fit: which record? plrun SPEC [T] --fit k,c record.csv");
	if (o->fit && surplus)
		wrong_usage(format("--fit and %s: one at a time", surplus));
	for (size_t i = 0; o->fit && i < o->passed_count; i++)
		if (strncmp(o->passed[i], "--sensitivity=", strlen("--sensitivity=")) == 0)
			wrong_usage("--fit has derivatives by its own list, and no --sensitivity beside it");
}

/* What a page shows is chosen on it. */
static void check_page(const struct options *o)
{
	const char *surplus = o->input ? "--input" : o->sweep ? "--sweep" : o->plot ? "--plot" : o->stats ? "--stats"
			    : o->window ? "--psd" : o->show ? "--show" : o->output ? "-o" : o->chart ? "--chart"
			    : o->fit ? "--fit" : o->until >= 0 ? "a time" : NULL;
	if (o->page && surplus)
		wrong_usage(format("%s does not go with --page: a page has its controls", surplus));
}

/* A file has many names; devices and pipes may be named twice. */
static void check_name(const char *written, const char *other)
{
	struct stat a, b;
	if (!written || !other)
		return;
	const bool both = stat(written, &a) == 0 && stat(other, &b) == 0;
	if (both ? S_ISREG(a.st_mode) && a.st_dev == b.st_dev && a.st_ino == b.st_ino : strcmp(written, other) == 0)
		wrong_usage(format("'%s' would be written over", written));
}

static void check_names(const struct options *o)
{
	const char *written[] = { o->plot_file, o->output }, *read[] = { o->spec, o->input, o->sweep };
	check_name(o->plot_file, o->output);
	for (int i = 0; i < 2; i++) {
		for (int j = 0; j < 3; j++)
			check_name(written[i], read[j]);
		for (size_t k = 0; k < o->fit_records; k++)
			check_name(written[i], o->fit_record[k]);
		for (size_t k = 0; k < o->passed_count; k++)
			if (strncmp(o->passed[k], "--params=", strlen("--params=")) == 0)
				check_name(written[i], o->passed[k] + strlen("--params="));
	}
}

static void check(const struct options *o)
{
	check_fit(o);
	check_chart(o);
	check_page(o);
	check_look(o);
	if (!o->spec)
		wrong_usage("no spec is given");
	if (!o->sweep && (o->peak || o->resume || o->jobs || o->device))
		wrong_usage(format("%s goes with --sweep", o->peak ? "--peak" : o->resume ? "--resume"
				   : o->jobs ? "--jobs" : "--device"));
	if (o->histories && !(o->sweep && o->plot))
		wrong_usage("--histories is a picture of a sweep: it goes with --sweep and --plot");
	if (o->sweep && o->plot && !o->histories && (o->ranges == 0 || o->ranges > 2))
		wrong_usage("--plot draws a sweep over one range, or two, or its --histories");
	if (o->sweep && o->stats)
		wrong_usage("--stats is of one run; a line of a sweep has them of its own");
	if (o->window && (o->sweep || o->stats))
		wrong_usage(format("--psd and %s: one at a time", o->sweep ? "--sweep" : "--stats"));
	if (o->window && o->every >= 0)
		wrong_usage("--psd takes every step: rows that are further apart would fold high frequencies "
			    "onto low ones");
	if (o->window && o->show && strchr(o->show, ':'))
		wrong_usage("--psd is over frequency: --show takes no X:Y with it");
	if (o->sweep && o->every >= 0)
		wrong_usage("--every is for the rows of one run; a sweep looks at every step");
	if (o->sweep && strcmp(o->spec, "-") == 0)
		wrong_usage("a sweep may read the spec many times: it has to be a file");
	if (o->input && strcmp(o->input, "-") == 0 && strcmp(o->spec, "-") == 0)
		wrong_usage("standard input is the spec, or the samples");
	if (!o->input && !o->fit && (o->columns || o->time))
		wrong_usage(format("%s goes with --input", o->columns ? "--column" : "--time"));
	const char *no_rows = o->sweep ? "--sweep" : o->fit ? "--fit" : o->stats ? "--stats" : o->window ? "--psd"
			    : o->chart ? "--chart" : o->page ? "--page" : NULL;
	if (o->raw && no_rows)
		wrong_usage(format("--raw is for the rows of one run: %s has none", no_rows));
	if (o->raw && !o->output && isatty(STDOUT_FILENO))
		wrong_usage("--raw is not for a terminal: -o FILE");
	if (o->every == 0)
		wrong_usage("--every: expected a time above 0");
	check_names(o);
}

void read_options(int argc, char **argv, struct options *o)
{
	struct words w = { argv, argc, 1 };
	bool options = true;
	o->until = o->every = -1;
	while (w.next < argc) {
		const char *word = argv[w.next];
		if (options && strcmp(word, "--") == 0) {
			options = false;
			w.next++;
		} else if (options && word[0] == '-' && word[1]) {
			take_option(&w, o);
		} else {
			take_word(o, word);
			w.next++;
		}
	}
	check(o);
	const char *list = o->fit ? o->fit[0] : "";
	for (size_t i = 1; i < o->fits; i++)
		list = format("%s,%s", list, o->fit[i]);
	if (o->fit)
		pass_on(o, format("--sensitivity=%s", list));
	pass_on(o, NULL);
	o->passed_count--;
}
