/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is written: texts grow in memory, and become files when all went well. */
#define _GNU_SOURCE     /* fopencookie, realpath */
#include "command.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool reported;           /* that standard output cannot be written */

enum { FILES = 4 };              /* C, header, depfile, names for calibration */
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
	if (!reported && (fflush(stdout) != 0 || ferror(stdout))) {
		fprintf(stderr, "plgen: error: cannot write to standard output: %s\n", strerror(errno));
		_exit(1);
	}
}

void publish_open(void)
{
	atexit(finish);
}

/* ---- names of one file ---- */

/* Where a file that is not there yet would be: the folder, and the name in it */
static bool same_place(const char *a, const char *b)
{
	struct stat of_a, of_b;
	const char *slash_a = strrchr(a, '/'), *slash_b = strrchr(b, '/');
	const char *folder_a = slash_a ? format("%.*s/", (int)(slash_a - a), a) : ".";
	const char *folder_b = slash_b ? format("%.*s/", (int)(slash_b - b), b) : ".";
	return strcmp(slash_a ? slash_a + 1 : a, slash_b ? slash_b + 1 : b) == 0 && stat(folder_a, &of_a) == 0 &&
	       stat(folder_b, &of_b) == 0 && of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
}

/* One file under two names, links and - for standard input too; devices and pipes may be named twice. */
bool same_file(const char *a, const char *b)
{
	struct stat of_a, of_b;
	bool there_a = (strcmp(a, "-") == 0 ? fstat(STDIN_FILENO, &of_a) : stat(a, &of_a)) == 0;
	bool there_b = stat(b, &of_b) == 0;
	if (there_a && there_b)
		return S_ISREG(of_a.st_mode) && of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
	return !there_a && !there_b && same_place(a, b);
}

/* What the spec reads is not written over. */
bool spares(int count, const char *const *path)
{
	for (int i = 0; i < files; i++)
		for (int k = 0; k < count; k++)
			if (file[i].path && same_file(path[k], file[i].path)) {
				fprintf(stderr, "%s: error: the spec reads this file: it is not written over\n",
					file[i].path);
				return false;
			}
	return true;
}

/* ---- texts ---- */

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
static void open_text(struct file *f)
{
	f->to = fopencookie(f, "w", (cookie_io_functions_t){ .write = keep });
	f->text = NULL;
	f->length = 0;
	if (!f->to)
		out_of_memory();
}

void file_close(struct file *f)
{
	if (fclose(f->to) != 0 || f->lost)
		out_of_memory();
}

struct file *file_new(const char *path)
{
	struct file *f = &file[files++];
	f->path = path;
	open_text(f);
	return f;
}

struct file *file_inside(void)
{
	struct file *f = NEW(struct file);
	open_text(f);
	return f;
}

void file_drop(struct file *f)
{
	free(f->text);
	f->text = NULL;
}

void file_replace(struct file *f, void (*print)(FILE *to, const char *text, const void *context), const void *context)
{
	char *text = f->text;
	open_text(f);
	print(f->to, text, context);
	file_close(f);
	free(text);
}

void file_rewrite(struct file *f, const char *name, rewriter *print)
{
	char *text = f->text;
	open_text(f);
	print(f->to, text, name);
	file_close(f);
	free(text);
}

/* ---- a header and its C: of two runs, a kill between two renames for one, they must not compile ---- */

static void insert_after(struct file *f, const char *line, const char *more)
{
	char *text = f->text;
	const char *end = strchr(strstr(text, line) + strlen(line), '\n') + 1;
	open_text(f);
	fprintf(f->to, "%.*s%s%s", (int)(end - text), text, more, end);
	file_close(f);
	free(text);
}

/* The header's own text as a number (FNV-1a, without its sign bit); C beside another header is refused by the
 * compiler. */
void mark_pair(struct file *code, struct file *header)
{
	static const char declared[] = "\n#ifndef ";
	unsigned long long hash = 0xcbf29ce484222325;
	const char *name = strstr(header->text, declared) + strlen(declared);
	int length = (int)(strstr(name, "_DECLARED\n") - name);
	for (const char *c = header->text; *c; c++)
		hash = (hash ^ (unsigned char)*c) * 0x100000001b3;
	name = format("%.*s", length, name);
	hash &= 0x7fffffffffffffff;
	insert_after(header, "_DECLARED\n#define ",
		     format("#define %s_PAIR 0x%016llx  /* its C has the same */\n", name, hash));
	if (code)
		insert_after(code, "\n#include \"",
			     format("#if %s_PAIR != 0x%016llx\n#error \"this file and its header were not made "
				    "together\"\n#endif\n", name, hash));
}

/* ---- files: all are written beside their places first, then moved in ---- */

static _Noreturn void cannot_write(const struct file *failed)
{
	fprintf(stderr, "%s: error: cannot write: %s\n", failed->path ? failed->path : "standard output",
		strerror(errno));
	reported = reported || !failed->path;
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

/* A device or pipe, or what a link to nowhere names, is written where it is. */
static void write_there(const struct file *f, int flags)
{
	int descriptor = open(f->path, O_WRONLY | flags, 0666);
	if (descriptor < 0)
		cannot_write(f);
	write_all(f, descriptor);
}

/* Beside the file itself, not beside a link to it */
static void write_temporary(struct file *f, mode_t mode)
{
	char *temporary = format("%s.XXXXXX", f->path);
	f->temporary = temporary;               /* before it is there: a signal may come at any time */
	int descriptor = mkstemp(temporary);
	if (descriptor < 0) {
		f->temporary = NULL;
		cannot_write(f);
	}
	if (fchmod(descriptor, mode) != 0)
		cannot_write(f);
	write_all(f, descriptor);
}

static void follow_links(struct file *f)
{
	char *real = realpath(f->path, NULL);
	if (!real)
		cannot_write(f);
	f->path = format("%s", real);
	free(real);
}

/* A file gets its new content whole, with the mode it had. */
static void write_beside(struct file *f)
{
	struct stat status, link;
	bool exists = stat(f->path, &status) == 0;
	bool dangling = !exists && lstat(f->path, &link) == 0 && S_ISLNK(link.st_mode);
	if (dangling || (exists && !S_ISREG(status.st_mode))) {
		write_there(f, dangling ? O_CREAT : 0);
		return;
	}
	if (exists)
		follow_links(f);
	mode_t mask = umask(0);
	umask(mask);
	write_temporary(f, exists ? status.st_mode & 07777 : 0666 & ~mask);
}

void publish(void)
{
	catch_signals();
	for (int i = 0; i < files; i++)
		if (file[i].path)
			write_beside(&file[i]);
	for (int i = 0; i < files; i++) {
		errno = 0;
		if (!file[i].path &&
		    (fwrite(file[i].text, 1, file[i].length, stdout) != file[i].length || fflush(stdout) != 0))
			cannot_write(&file[i]);
		if (file[i].temporary && rename(file[i].temporary, file[i].path) != 0)
			cannot_write(&file[i]);
		file[i].temporary = NULL;
		free(file[i].text);
	}
}

/* ---- what was read, for make and ninja ---- */

/* A name in a make rule */
static const char *escaped(const char *path)
{
	const char *text = "";
	for (; *path; path++)
		text = format("%s%s%c", text, *path == ' ' || *path == '#' ? "\\" : *path == '$' ? "$" : "", *path);
	return text;
}

void print_depfile(const struct options *options, const struct spec *spec, const struct model *model)
{
	if (!options->depfile)
		return;
	struct file *f = file_new(options->depfile);
	const char *made = options->fmu.path ? options->fmu.path : options->page ? options->page : options->output;
	fprintf(f->to, "%s", made ? escaped(made) : format("%s_pl.c", model->name));
	fprintf(f->to, "%s:", options->header ? format(" %s", escaped(options->header)) : "");
	if (strcmp(options->spec, "-") != 0)
		fprintf(f->to, " %s", escaped(options->spec));
	if (options->params)
		fprintf(f->to, " %s", escaped(options->params));
	for (int i = 0; i < spec->data.files; i++)
		fprintf(f->to, " %s", escaped(spec->data.file[i]));
	fputc('\n', f->to);
	file_close(f);
}
