/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plgen: the command line, then the pipeline as one column of calls. Text is written to memory and published only when
 * all went well. */
#define _GNU_SOURCE     /* getopt_long, open_memstream, realpath */
#include "emit/emit.h"

#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <signal.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum print { PRINT_C, PRINT_HEADER, PRINT_EXPLAIN, PRINT_JSON, PRINT_SOLUTION };

struct options {
	const char *spec, *output, *depfile, *solution;
	enum print print;
	bool rhs;
	struct request request;
	const char *banner;             /* what of them belongs in a banner */
};

static const char usage[] =
	"usage: plgen [options] MODEL.spec      ('-' reads standard input)\n"
	"\n"
	"Reads the equations of a vibration model and writes C that steps it to standard output.\n"
	"\n"
	"  -o FILE.c           write FILE.c and the header FILE.h beside it\n"
	"  --header            print the header instead of the C\n"
	"  --explain[=json]    print what was derived: matrices, B(s), poles, Phi, cost\n"
	"  --solution T        print the closed-form solution at every step up to T as CSV\n"
	"  --rhs               also emit NAME_rhs: the equations as written\n"
	"  --step EXPR         instead of the spec's step\n"
	"  --scheme NAME       instead of the spec's: exact pl etd1 etdrk2 etdrk4 nc2 nc3 dq4 bm3\n"
	"  --real float        numbers and arithmetic of type float (default: double)\n"
	"  --form NAME         of a linear step: auto direct delta kick-drift-kick\n"
	"  --accuracy compensated   two-word factors, and what rounding takes from the state is kept\n"
	"  --loads leftover    leave known loads to the scheme's quadrature (default: exact)\n"
	"  -D NAME=EXPR        another value for a param; EXPR may use the spec's params\n"
	"  --prefix NAME       instead of the model's name for everything generated\n"
	"  --reduce            leave out what the outputs cannot see\n"
	"  --depfile FILE      also write a make/ninja dependency file\n"
	"  --selftest          also emit NAME_selftest: steps against the closed form\n"
	"  --help, --version\n"
	"\n"
	"Exit status: 0 done; 1 the spec is wrong or a file cannot be read or written; 2 the command line is wrong.\n";

static _Noreturn void wrong_usage(const char *message)
{
	fprintf(stderr, "plgen: error: %s\nnote: plgen --help lists the options\n", message);
	exit(2);
}

static void need_print(struct options *options, enum print print)
{
	if (options->print != PRINT_C)
		wrong_usage("--header, --explain and --solution exclude each other");
	options->print = print;
}

static void add_definition(struct request *request, const char *text)
{
	const char *equals = strchr(text, '=');
	if (!equals || equals == text || equals[1] == 0)
		wrong_usage(format("-D takes NAME=EXPR, found '%s'", text));
	ENLARGE(request->definition, (size_t)request->definitions + 1);
	request->definition[request->definitions++] = text;
}

static void note_in_banner(struct options *options, const char *option)
{
	options->banner = format("%s%s%s", options->banner, *options->banner ? " " : "", option);
}

enum { OPT_HEADER = 256, OPT_EXPLAIN, OPT_SOLUTION, OPT_RHS, OPT_STEP, OPT_SCHEME, OPT_PREFIX, OPT_REDUCE, OPT_DEPFILE, OPT_LOADS, OPT_REAL, OPT_FORM, OPT_ACCURACY, OPT_SELFTEST, OPT_HELP, OPT_VERSION };

static const struct option long_options[] = {
	{ "header", no_argument, NULL, OPT_HEADER }, { "explain", optional_argument, NULL, OPT_EXPLAIN },
	{ "solution", required_argument, NULL, OPT_SOLUTION }, { "rhs", no_argument, NULL, OPT_RHS },
	{ "step", required_argument, NULL, OPT_STEP }, { "scheme", required_argument, NULL, OPT_SCHEME },
	{ "prefix", required_argument, NULL, OPT_PREFIX }, { "depfile", required_argument, NULL, OPT_DEPFILE },
	{ "help", no_argument, NULL, OPT_HELP }, { "version", no_argument, NULL, OPT_VERSION },
	{ "real", required_argument, NULL, OPT_REAL }, { "form", required_argument, NULL, OPT_FORM },
	{ "accuracy", required_argument, NULL, OPT_ACCURACY }, { "loads", required_argument, NULL, OPT_LOADS },
	{ "reduce", no_argument, NULL, OPT_REDUCE }, { "selftest", no_argument, NULL, OPT_SELFTEST }, { 0 }
};

static bool told;               /* that standard output cannot be written */

struct file {
	const char *path;
	const char *volatile temporary;
	char *text;                     /* ends with a 0 */
	size_t length;
	bool lost;                      /* there was no memory for some of it */
};

enum { FILES = 3 };              /* C, header, depfile */
static struct file file[FILES];
static int files;

static void remove_temporaries(void)
{
	for (int i = 0; i < files; i++)
		if (file[i].temporary)
			unlink(file[i].temporary);
}

static void finish(void)
{
	remove_temporaries();
	memory_close();
	if (!told && (fflush(stdout) != 0 || ferror(stdout))) {
		fprintf(stderr, "plgen: error: cannot write to standard output: %s\n", strerror(errno));
		_exit(1);
	}
}

static _Noreturn void say_and_stop(const char *text)
{
	fputs(text, stdout);
	exit(0);
}

static void take_option(struct options *options, int option)
{
	switch (option) {
	case 'o': options->output = optarg; break;
	case 'D':
		add_definition(&options->request, optarg);
		note_in_banner(options, format("-D %s", optarg));
		break;
	case OPT_HEADER: need_print(options, PRINT_HEADER); break;
	case OPT_EXPLAIN:
		if (optarg && strcmp(optarg, "json") != 0)
			wrong_usage(format("--explain takes nothing or =json, found '%s'", optarg));
		need_print(options, optarg ? PRINT_JSON : PRINT_EXPLAIN);
		break;
	case OPT_SOLUTION:
		need_print(options, PRINT_SOLUTION);
		options->solution = optarg;
		options->request.solution = true;
		break;
	case OPT_RHS: options->rhs = true; break;
	case OPT_STEP: options->request.step = optarg; break;
	case OPT_SCHEME: options->request.scheme = optarg; break;
	case OPT_PREFIX: options->request.prefix = optarg; break;
	case OPT_REDUCE:
		options->request.reduce = true;
		note_in_banner(options, "--reduce");
		break;
	case OPT_LOADS:
		if (strcmp(optarg, "leftover") != 0 && strcmp(optarg, "exact") != 0)
			wrong_usage(format("--loads takes exact or leftover, found '%s'", optarg));
		options->request.loads_left = strcmp(optarg, "leftover") == 0;
		break;
	case OPT_REAL:
		if (strcmp(optarg, "double") != 0 && strcmp(optarg, "float") != 0)
			wrong_usage(format("--real takes double or float, found '%s'", optarg));
		options->request.single = strcmp(optarg, "float") == 0;
		break;
	case OPT_FORM:
		if (!step_form_of(optarg, &options->request.form))
			wrong_usage(format("--form takes auto, direct, delta or kick-drift-kick, found '%s'", optarg));
		break;
	case OPT_ACCURACY:
		if (strcmp(optarg, "compensated") != 0)
			wrong_usage(format("--accuracy takes compensated, found '%s'", optarg));
		options->request.compensated = true;
		break;
	case OPT_SELFTEST: options->request.selftest = true; break;
	case OPT_DEPFILE: options->depfile = optarg; break;
	case OPT_HELP: say_and_stop(usage);
	case OPT_VERSION: say_and_stop("plgen " PLGEN_VERSION "\n");
	case ':': wrong_usage(format("option %s needs a value", optopt > 0 && optopt < 256 ? format("-%c", optopt) : "above"));
	default: wrong_usage(format("unknown option '%s'", optopt > 0 && optopt < 256 ? format("-%c", optopt) : "above"));
	}
}

/* Where a file that is not there yet would be: the folder, and the name in it */
static bool same_place(const char *a, const char *b)
{
	struct stat of_a, of_b;
	const char *slash_a = strrchr(a, '/'), *slash_b = strrchr(b, '/');
	const char *folder_a = slash_a ? format("%.*s/", (int)(slash_a - a), a) : ".", *folder_b = slash_b ? format("%.*s/", (int)(slash_b - b), b) : ".";
	return strcmp(slash_a ? slash_a + 1 : a, slash_b ? slash_b + 1 : b) == 0 && stat(folder_a, &of_a) == 0 && stat(folder_b, &of_b) == 0 &&
	       of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
}

/* One file under two names, links and - for standard input too; devices and pipes may be named twice. */
static bool same_file(const char *a, const char *b)
{
	struct stat of_a, of_b;
	bool there_a = (strcmp(a, "-") == 0 ? fstat(STDIN_FILENO, &of_a) : stat(a, &of_a)) == 0, there_b = stat(b, &of_b) == 0;
	if (there_a && there_b)
		return S_ISREG(of_a.st_mode) && of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
	return !there_a && !there_b && same_place(a, b);
}

static void read_options(int argc, char **argv, struct options *options)
{
	int option;
	options->banner = "";
	opterr = 0;
	for (int before = optind; (option = getopt_long(argc, argv, ":o:D:", long_options, NULL)) != -1; before = optind) {
		if ((option == '?' || option == ':') && (optopt == 0 || optopt >= 256))
			wrong_usage(format(option == ':' ? "option '%s' needs a value" : "unknown option or surplus value: '%s'", argv[before]));
		take_option(options, option);
	}
	if (optind == argc)
		wrong_usage("no spec is given");
	if (optind + 1 < argc)
		wrong_usage(format("one spec at a time: surplus argument '%s'", argv[optind + 1]));
	options->spec = argv[optind];
	if (options->request.scheme)
		note_in_banner(options, format("--scheme %s", options->request.scheme));
	if (options->request.step)
		note_in_banner(options, format("--step %s", options->request.step));
	if (options->request.prefix)
		note_in_banner(options, format("--prefix %s", options->request.prefix));
	if (options->request.loads_left)
		note_in_banner(options, "--loads leftover");
	if (options->request.single)
		note_in_banner(options, "--real float");
	if (options->request.form != FORM_AUTO)
		note_in_banner(options, format("--form %s", step_form_name(options->request.form)));
	if (options->request.compensated)
		note_in_banner(options, "--accuracy compensated");
	if (options->request.selftest)
		note_in_banner(options, "--selftest");
	if (options->rhs)
		note_in_banner(options, "--rhs");
	size_t length = options->output ? strlen(options->output) : 0;
	if (options->output && options->print == PRINT_C && (length < 3 || strcmp(options->output + length - 2, ".c") != 0))
		wrong_usage(format("-o takes the name of a C file, FILE.c, found '%s'", options->output));
	const char *header = options->output && options->print == PRINT_C ? format("%.*s.h", (int)length - 2, options->output) : NULL;
	const char *path[] = { options->spec, options->output, header, options->depfile };
	for (int i = 0; i < 4; i++)
		for (int j = i + 1; j < 4; j++)
			if (path[i] && path[j] && same_file(path[i], path[j]))
				wrong_usage(format("'%s' would be written over: each file needs a name of its own", path[i]));
}

/* ---- publishing: all files are written beside their places first, then moved in ---- */

static _Noreturn void cannot_write(const struct file *failed)
{
	fprintf(stderr, "%s: error: cannot write: %s\n", failed->path ? failed->path : "standard output", strerror(errno));
	told = told || !failed->path;
	exit(1);
}

/* A signal that ends the program takes what was not published along. */
static void clean_up(int number)
{
	remove_temporaries();
	signal(number, SIG_DFL);
	raise(number);
}

static void catch_signals(void)
{
	static const int number[] = { SIGHUP, SIGINT, SIGTERM };
	for (size_t i = 0; i < sizeof number / sizeof *number; i++)
		if (signal(number[i], clean_up) == SIG_IGN)
			signal(number[i], SIG_IGN);
}

static void write_all(const struct file *f, int descriptor)
{
	for (size_t done = 0; done < f->length;) {
		ssize_t written = write(descriptor, f->text + done, f->length - done);
		if (written < 0 && errno == EINTR)
			continue;
		if (written < 0)
			cannot_write(f);
		done += (size_t)written;
	}
	if (close(descriptor) != 0)
		cannot_write(f);
}

/* A device or pipe, or what a link to nowhere names, is written where it is; a file gets its new content whole, with
 * the mode it had. */
static void write_beside(struct file *f)
{
	struct stat status, link;
	bool exists = stat(f->path, &status) == 0;
	bool dangling = !exists && lstat(f->path, &link) == 0 && S_ISLNK(link.st_mode);
	if (dangling || (exists && !S_ISREG(status.st_mode))) {
		int descriptor = open(f->path, O_WRONLY | (dangling ? O_CREAT : 0), 0666);
		if (descriptor < 0)
			cannot_write(f);
		write_all(f, descriptor);
		return;
	}
	char *real = exists ? realpath(f->path, NULL) : NULL;
	if (exists && !real)
		cannot_write(f);
	if (real)
		f->path = format("%s", real);
	free(real);
	mode_t mask = umask(0);
	umask(mask);
	char *temporary = format("%s.XXXXXX", f->path);
	f->temporary = temporary;               /* before it is there: a signal may come at any time */
	int descriptor = mkstemp(temporary);
	if (descriptor < 0) {
		f->temporary = NULL;
		cannot_write(f);
	}
	if (fchmod(descriptor, exists ? status.st_mode & 07777 : 0666 & ~mask) != 0)
		cannot_write(f);
	write_all(f, descriptor);
}

static void publish(void)
{
	catch_signals();
	for (int i = 0; i < files; i++)
		if (file[i].path)
			write_beside(&file[i]);
	for (int i = 0; i < files; i++) {
		errno = 0;
		if (!file[i].path && (fwrite(file[i].text, 1, file[i].length, stdout) != file[i].length || fflush(stdout) != 0))
			cannot_write(&file[i]);
		if (file[i].temporary && rename(file[i].temporary, file[i].path) != 0)
			cannot_write(&file[i]);
		file[i].temporary = NULL;
		free(file[i].text);
	}
}

static _Noreturn void out_of_memory(void)
{
	fputs("plgen: error: out of memory\n", stderr);
	exit(1);
}

static ssize_t keep(void *cookie, const char *bytes, size_t size)
{
	struct file *f = cookie;
	char *text = f->lost ? NULL : realloc(f->text, f->length + size + 1);
	if (!text) {
		f->lost = true;
		return 0;
	}
	memcpy(text + f->length, bytes, size);
	f->text = text;
	f->length += size;
	text[f->length] = 0;
	return (ssize_t)size;
}

/* Its text grows in memory: a stream of the library's own would lose what it has no memory for without a word. */
static FILE *open_text(struct file *f)
{
	FILE *stream = fopencookie(f, "w", (cookie_io_functions_t){ .write = keep });
	f->text = NULL;
	f->length = 0;
	if (!stream)
		out_of_memory();
	return stream;
}

static void close_file(FILE *stream, const struct file *f)
{
	if (fclose(stream) != 0 || f->lost)
		out_of_memory();
}

static FILE *open_file(const char *path)
{
	file[files].path = path;
	return open_text(&file[files++]);
}

/* ---- the pipeline ---- */

static const char *header_path(const char *path)
{
	return format("%.*s.h", (int)strlen(path) - 2, path);
}

static const char *base_name(const char *path)
{
	const char *slash = strrchr(path, '/');
	return slash ? slash + 1 : path;
}

/* A name in a make rule. */
static const char *escaped(const char *path)
{
	const char *text = "";
	for (; *path; path++)
		text = format("%s%s%c", text, *path == ' ' || *path == '#' ? "\\" : *path == '$' ? "$" : "", *path);
	return text;
}

static void print_depfile(FILE *to, const struct options *options, const struct model *model)
{
	if (!options->output)
		fprintf(to, "%s_pl.c:", model->name);
	else if (options->print == PRINT_C)
		fprintf(to, "%s %s:", escaped(options->output), escaped(header_path(options->output)));
	else
		fprintf(to, "%s:", escaped(options->output));
	if (strcmp(options->spec, "-") != 0)
		fprintf(to, " %s", escaped(options->spec));
	for (int i = 0; i < model->spec->files; i++)
		fprintf(to, " %s", escaped(model->spec->file[i]));
	fputc('\n', to);
}

struct printing {
	const struct options *options;
	struct model *model;
	struct step *step;
	FILE *to;
};

static void print_main_text(void *context)
{
	const struct printing *p = context;
	const struct options *options = p->options;
	mpq_t end;
	switch (options->print) {
	case PRINT_C:
		emit_code(p->to, p->step, options->banner, options->output ? base_name(header_path(options->output)) : NULL, options->rhs);
		break;
	case PRINT_HEADER:
		emit_header(p->to, p->step, options->banner, options->rhs);
		break;
	case PRINT_EXPLAIN:
		explain_person(p->to, p->step);
		break;
	case PRINT_JSON:
		explain_json(p->to, p->step);
		break;
	case PRINT_SOLUTION:
		mpq_init(end);
		argument_value(p->model, options->solution, end);
		print_solution(p->to, p->model, resolvent_of(&p->model->system), end);
		break;
	}
}

static void print_as_float(FILE *to, const char *text, const char *name)
{
	(void)name;
	print_single(to, text);
}

/* C becomes other C: for the target float, or with locals apart from the model's name. */
static void rewrite(struct file *f, const char *name, void (*print)(FILE *to, const char *text, const char *name))
{
	char *text = f->text;
	FILE *stream = open_text(f);
	print(stream, text, name);
	close_file(stream, f);
	free(text);
}

/* ---- a header and its C: of two runs, a kill between two renames for one, they must not compile ---- */

static void insert_after(struct file *f, const char *line, const char *more)
{
	char *text = f->text;
	const char *end = strchr(strstr(text, line) + strlen(line), '\n') + 1;
	FILE *stream = open_text(f);
	fprintf(stream, "%.*s%s%s", (int)(end - text), text, more, end);
	close_file(stream, f);
	free(text);
}

/* The header's own text as a number (FNV-1a, without its sign bit); C beside another header is refused by the compiler. */
static void mark(struct file *code, struct file *header)
{
	static const char declared[] = "\n#ifndef ";
	unsigned long long hash = 0xcbf29ce484222325;
	const char *name = strstr(header->text, declared) + strlen(declared);
	int length = (int)(strstr(name, "_DECLARED\n") - name);
	for (const char *c = header->text; *c; c++)
		hash = (hash ^ (unsigned char)*c) * 0x100000001b3;
	name = format("%.*s", length, name);
	hash &= 0x7fffffffffffffff;
	insert_after(header, "_DECLARED\n#define ", format("#define %s_PAIR 0x%016llx  /* its C has the same */\n", name, hash));
	if (code)
		insert_after(code, "\n#include \"", format("#if %s_PAIR != 0x%016llx\n#error \"this file and its header were not made together\"\n#endif\n", name, hash));
}

/* What the spec reads is not written over. */
static bool spares_data(const struct model *model)
{
	for (int i = 0; i < files; i++)
		for (int k = 0; k < model->spec->files; k++)
			if (file[i].path && same_file(model->spec->file[k], file[i].path)) {
				fprintf(stderr, "%s: error: the spec reads this file: it is not written over\n", file[i].path);
				return false;
			}
	return true;
}

static int fail(void)
{
	diagnostics_print(stderr);
	return 1;
}

/* The coordinate from which all of its group are measured */
static int root_of(const struct relative *r, int coord)
{
	while (r->link[coord].kind == LINK_PARENT)
		coord = r->link[coord].from;
	return coord;
}

/* Positions that a reduced model keeps as they are written, though they may move as a whole */
static void warn_of_kept(const struct model *model)
{
	const struct relative *r = relative_of(model->written);
	for (int i = 0; r && i < model->written->n; i++) {
		const char *names = model->written->coord_name[i];
		int count = 1;
		for (int j = i + 1; j < model->written->n; j++)
			if (model->reduction.place[i] >= 0 && model->reduction.place[j] >= 0 && root_of(r, i) == root_of(r, j)) {
				names = format("%s, %s", names, model->written->coord_name[j]);
				count++;
			}
		if (count > 1) {
			say_warning(model->spec->name_at, "without --reduce differences are states of their own",
				    "the reduced model keeps %s, which may move as a whole: where they grow, their differences lose digits", names);
			return;
		}
	}
}

/* The model over coordinates that part what moves as a whole from what moves in it, where there are such; else itself */
static struct model *over_relative(struct model *model, struct spec *spec, const struct request *request)
{
	struct request again = *request;
	if (model->written != model) {
		warn_of_kept(model);
		return model;
	}
	again.relative = relative_of(model);
	if (!again.relative)
		return model;
	if (model->scheme == SCHEME_PL) {
		say_warning(model->asked.scheme_at.source ? model->asked.scheme_at : spec->name_at, "any other scheme steps differences as states of their own",
			    "pl keeps coordinates as they are written, and some may move as a whole: where they grow, their differences lose digits");
		return model;
	}
	again.reduce = again.reduce && !model->reduction.irreducible;
	struct model *relative = model_build(spec, &again);
	if (!relative || !find_tuning(relative, &again))
		return NULL;
	relative->reduction.irreducible = model->reduction.irreducible;
	return relative;
}

static int compile(int argc, char **argv)
{
	struct options options = { 0 };
	memory_open();
	memory_on_limit(give_up);
	atexit(finish);
	read_options(argc, argv, &options);

	if (options.request.single && options.print != PRINT_SOLUTION)
		target_float();
	const struct source *source = source_read(options.spec);
	if (!source)
		return fail();
	struct spec *spec = parse_spec(source);
	struct model *model = model_build(spec, &options.request);
	if (!model || (options.print != PRINT_SOLUTION && !find_tuning(model, &options.request)))
		return fail();
	if (options.request.reduce)
		model = model_reduce(model);
	if (!model)
		return fail();
	struct model *stepped = options.print == PRINT_SOLUTION ? model : over_relative(model, spec, &options.request);
	struct step *step = !stepped || options.print == PRINT_SOLUTION ? NULL : step_build(stepped);
	if (!step && options.print != PRINT_SOLUTION)
		return fail();

	FILE *to = open_file(options.output);
	bool printed = statement_guard(print_main_text, &(struct printing){ &options, model, step, to });
	close_file(to, &file[files - 1]);
	if (!printed) {
		free(file[0].text);
		return fail();
	}
	if (options.output && options.print == PRINT_C) {
		to = open_file(header_path(options.output));
		emit_header(to, step, options.banner, options.rhs);
		close_file(to, &file[files - 1]);
	}
	for (int i = 0; i < files && options.print <= PRINT_HEADER; i++) {
		if (options.request.single)
			rewrite(&file[i], model->name, print_as_float);
		rewrite(&file[i], model->name, print_apart);
	}
	if (options.print == PRINT_HEADER)
		mark(NULL, &file[0]);
	else if (options.print == PRINT_C && options.output)
		mark(&file[0], &file[1]);
	if (options.depfile) {
		to = open_file(options.depfile);
		print_depfile(to, &options, model);
		close_file(to, &file[files - 1]);
	}
	if (!spares_data(model))
		return fail();
	publish();
	diagnostics_print(stderr);
	return 0;
}

/* ---- a stack that is large enough for whatever the limits allow ---- */

/* The walks over expressions recurse, LIMIT_DEPTH deep at most; what stack a program is started with differs from system to
 * system, and a limit of the user's cannot be raised from here. So all work is done on a stack of its own, of pages that cost
 * nothing until they are used. */
enum { STACK_SIZE = 96 << 20 };

struct command { int argc; char **argv; int status; };

static void *work(void *context)
{
	struct command *command = context;
	command->status = compile(command->argc, command->argv);
	return NULL;
}

int main(int argc, char **argv)
{
	struct command command = { argc, argv, 1 };
	pthread_attr_t attributes;
	pthread_t thread;
#ifdef M_ARENA_MAX
	mallopt(M_ARENA_MAX, 1);        /* one thread works: it needs no heap of its own */
#endif
	if (pthread_attr_init(&attributes) != 0 || pthread_attr_setstacksize(&attributes, STACK_SIZE) != 0 ||
	    pthread_create(&thread, &attributes, work, &command) != 0) {
		fputs("plgen: error: out of memory\n", stderr);
		return 1;
	}
	pthread_join(thread, NULL);
	return command.status;
}
