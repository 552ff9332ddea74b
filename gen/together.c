/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which options go together, and which names of files. */
#include "command.h"
#include "report/report.h"

#include <stdlib.h>
#include <string.h>

_Noreturn void wrong_usage(const char *message)
{
	fprintf(stderr, "plgen: error: %s\nnote: plgen --help lists the options\n", message);
	exit(2);
}

bool ends_in(const char *text, const char *end)
{
	size_t length = strlen(text), tail = strlen(end);
	return length > tail && strcmp(text + length - tail, end) == 0;
}

const char *base_name(const char *path)
{
	const char *slash = path ? strrchr(path, '/') : NULL;
	return slash ? slash + 1 : path;
}

/* The option that asks for another text than C */
static const char *option_of_print(enum print print)
{
	static const char *const option[] = {
		[PRINT_HEADER] = "--header", [PRINT_KERNEL] = "--target", [PRINT_EXPLAIN] = "--explain",
		[PRINT_JSON] = "--explain",
		[PRINT_PROGRAM] = "--explain", [PRINT_SOLUTION] = "--solution", [PRINT_RESPONSE] = "--response",
		[PRINT_PLOT] = "--plot", [PRINT_REPORT] = "--report"
	};
	return option[print];
}

static void find_header(struct options *options)
{
	size_t length = options->output ? strlen(options->output) : 0;
	const enum picture_format as = picture_of_file(options->output);
	if (options->print == PRINT_PLOT && (as == PICTURE_NONE || (as > PICTURE_PDF && !options->campbell.wanted)))
		wrong_usage(format("-o of --plot takes FILE.svg, FILE.png or FILE.pdf%s, found '%s'",
				   options->campbell.wanted ? ", of campbell also FILE.csv and FILE.json" : "",
				   options->output));
	if (!options->output || options->print != PRINT_C || options->equilibrium)
		return;
	if (length < 3 || strcmp(options->output + length - 2, ".c") != 0)
		wrong_usage(format("-o takes the name of a C file, FILE.c, found '%s'", options->output));
	options->header = format("%.*s.h", (int)length - 2, options->output);
}

static void check_print(const struct options *options)
{
	if (options->bundle && options->print != PRINT_C)
		wrong_usage(format("--bundle is of C: it does not go with %s", option_of_print(options->print)));
	if (options->amplitude && options->print != PRINT_RESPONSE &&
	    !(options->print == PRINT_PLOT && !options->campbell.wanted && has_frf(options->value)))
		wrong_usage("--amplitude goes with --response and --plot frf");
}

static void check_math(const struct options *options)
{
	if (options->request.own_math && options->request.single)
		wrong_usage("--math own is of doubles: it does not go with --real float");
}

static void check_a2l(const struct options *options)
{
	if (options->a2l && (options->print != PRINT_C || options->fmu.path))
		wrong_usage(format("--a2l goes with C: it does not go with %s",
				   options->fmu.path ? "--fmu" : option_of_print(options->print)));
	if (options->a2l && !ends_in(options->a2l, ".a2l"))
		wrong_usage(format("--a2l takes the name of a file, FILE.a2l, found '%s'", options->a2l));
}

static void check_equilibrium(const struct options *o)
{
	const enum print print = o->print;
	const char *other = o->at ? "--at" : o->fmu.path ? "--fmu" : o->page ? "--page" : o->a2l ? "--a2l"
			    : o->bundle ? "--bundle"
			    : print != PRINT_C && print != PRINT_JSON ? option_of_print(print) : NULL;
	if (o->equilibrium && other)
		wrong_usage(format("--equilibrium does not go with %s", other));
}

static void check_campbell(const struct options *options)
{
	const struct { const char *value, *option; } of[] = {
		{ options->campbell.sweep, "--sweep" },
		{ options->campbell.orders, "--orders" },
		{ options->campbell.whirl, "--whirl" }
	};
	for (size_t i = 0; i < sizeof of / sizeof *of; i++)
		if (of[i].value && !options->campbell.wanted)
			wrong_usage(format("%s goes with --plot campbell", of[i].option));
	if (options->campbell.wanted && !options->campbell.sweep)
		wrong_usage("--plot campbell takes the param and its values from --sweep w=0:500");
}

static bool has_control(const char *text)
{
	for (; *text; text++)
		if ((unsigned char)*text < ' ' || *text == 127)
			return true;
	return false;
}

static bool is_page(const struct options *options)
{
	return options->print == PRINT_REPORT || options->page;
}

static void check_look(const struct options *options)
{
	const struct picture_look *look = &options->look;
	const char *of_files = look->paper ? "--paper" : look->width > 0 ? "--size" : NULL;
	const char *any = of_files ? of_files : look->dark ? "--dark" : look->title ? "--title" : NULL;
	const enum picture_format as = picture_of_file(options->output);
	if (any && options->print != PRINT_PLOT && !is_page(options))
		wrong_usage(format("%s is of a picture: --plot KIND draws it", any));
	if (of_files && is_page(options))
		wrong_usage(format("%s is of --plot: the page of --report is as wide as its window", of_files));
	if (any && options->campbell.wanted && as > PICTURE_PDF)
		wrong_usage(format("%s is of a picture, and '%s' is a table", any, options->output));
	if (look->dark && look->paper)
		wrong_usage("--paper is light, and --dark is not");
	if (look->title && has_control(look->title))
		wrong_usage("--title: the title of the picture has a control character in it");
	if (look->paper && as == PICTURE_SVG)
		fputs("plgen: note: an SVG names its fonts and has none inside; a .pdf has\n", stderr);
}

/* Of an FMU everything else that is printed, and what nothing in it would call */
static void check_fmu(const struct options *options)
{
	const size_t length = options->fmu.path ? strlen(options->fmu.path) : 0;
	const struct { bool requested; const char *option; } against[] = {
		{ options->output, "-o" }, { options->print != PRINT_C, option_of_print(options->print) },
		{ options->rhs, "--rhs" }, { options->request.selftest, "--selftest" },
		{ options->request.many.batch, "--batch" }, { options->bundle, "--bundle" }
	};
	if (!options->fmu.path && (options->fmu.version || options->fmu.binary))
		wrong_usage(format("%s goes with --fmu FILE.fmu",
				   options->fmu.version ? "--fmu-version" : "--fmu-binary"));
	if (!options->fmu.path)
		return;
	if (length < 5 || strcmp(options->fmu.path + length - 4, ".fmu") != 0)
		wrong_usage(format("--fmu takes the name of an FMU, FILE.fmu, found '%s'", options->fmu.path));
	for (size_t i = 0; i < sizeof against / sizeof *against; i++)
		if (against[i].requested)
			wrong_usage(format("%s does not go with --fmu", against[i].option));
}

static void check_live_page(const struct options *options)
{
	const struct { bool requested; const char *option; } against[] = {
		{ options->output, "-o" }, { options->fmu.path, "--fmu" }, { options->a2l, "--a2l" },
		{ options->print != PRINT_C, option_of_print(options->print) }, { options->rhs, "--rhs" },
		{ options->request.selftest, "--selftest" }, { options->request.many.batch, "--batch" },
		{ options->look.dark && !options->page_in_report, "--dark" },
		{ options->request.single, "--real float" }, { options->request.sensitivity, "--sensitivity" }
	};
	if (!options->page)
		return;
	if (!ends_in(options->page, ".html") && !ends_in(options->page, ".htm"))
		wrong_usage(format("--page takes the name of a page, FILE.html, found '%s'", options->page));
	for (size_t i = 0; i < sizeof against / sizeof *against; i++)
		if (against[i].requested)
			wrong_usage(format("%s does not go with --page", against[i].option));
}

/* The C includes the header by its name, and in a rule of make the paths stand too. */
static void check_spelling(const struct options *options, const char *const *path, int paths)
{
	const char *slash = options->header ? strrchr(options->header, '/') : NULL;
	const char *name = slash ? slash + 1 : options->header ? options->header : "";
	if (has_control(name) || strpbrk(name, "\"\\"))
		wrong_usage("-o: an #include cannot name this file: a quote, a backslash or a control character is in "
			    "its name");
	for (int i = 0; i < paths; i++)
		if (options->depfile && path[i] && has_control(path[i]))
			wrong_usage("--depfile: a rule of make cannot name a file with a control character in its "
				    "path");
}

static void check_names(const struct options *options)
{
	const char *path[] = { options->spec, options->output, options->header, options->depfile, options->fmu.path,
			       options->a2l, options->params, options->page };
	enum { PATHS = sizeof path / sizeof *path };
	check_spelling(options, path, PATHS);
	for (int i = 1; i < PATHS; i++)
		if (path[i] && !*path[i])
			wrong_usage("the name of a file is empty");
	for (int i = 0; i < PATHS; i++)
		for (int j = i + 1; j < PATHS; j++)
			if (path[i] && path[j] && same_file(path[i], path[j]))
				wrong_usage(format("'%s' would be written over: each file needs a name of its own",
						   path[i]));
}

void find_together(struct options *options)
{
	check_live_page(options);
	check_print(options);
	check_math(options);
	check_a2l(options);
	check_equilibrium(options);
	check_campbell(options);
	check_look(options);
	check_fmu(options);
	find_header(options);
	check_names(options);
}
