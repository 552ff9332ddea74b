/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A case through the generator, in a process that is forked: nothing of it has run in this one before. */
#define _GNU_SOURCE
#include "cases.h"

#include <dirent.h>
#include <fcntl.h>
#include <fnmatch.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

int plgen(int argc, char **argv);
void __lsan_do_leak_check(void) __attribute__((weak));          /* where it is linked with sanitizers */

static const char *const kept[] = { "kept.c", "step_map.h" };
static const struct text as_it_was = { "left as it was\n", 15 };
static char *folder, *in, *out;         /* in: where a case runs; out: with files that have to stay */
static int output, messages;            /* what is written to standard output and error */
static const struct one *running;
static FILE *told;                      /* what is wrong with it */
static int complaints;
static volatile sig_atomic_t stopped;
static const int ends[] = { SIGHUP, SIGINT, SIGTERM };

__attribute__((format(printf, 2, 3)))
static void complain(const char *when, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	complaints++;
	fprintf(told, "# %s: %s", running->name, when);
	vfprintf(told, format, arguments);
	putc('\n', told);
	va_end(arguments);
}

static int open_temporary(void)
{
	FILE *file = tmpfile();
	if (!file)
		bail_out("no temporary file");
	int own = dup(fileno(file));
	fclose(file);
	return own;
}

static void put_kept(void)
{
	for (int i = 0; i < 2; i++)
		write_file(out, kept[i], as_it_was);
}

/* ---- before and after all ---- */

static void stop(int number)
{
	stopped = number;
}

static void close_all(void)
{
	empty(folder);
	rmdir(folder);
}

static void make_folders(void)
{
	folder = scratch();
	in = print("%s/in", folder);
	out = print("%s/out", folder);
	if (mkdir(in, 0777) != 0 || mkdir(out, 0777) != 0)
		bail_out("%s cannot be made", in);
	put_kept();
}

void run_open(void)
{
	/* What the limits allow needs no more of the stack that a program starts with. */
	const struct rlimit stack = { 256 << 10, 256 << 10 };
	setrlimit(RLIMIT_STACK, &stack);
	make_folders();
	atexit(close_all);
	for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
		sigaction(ends[i], &(struct sigaction){ .sa_handler = stop }, NULL);
	output = open_temporary();
	messages = open_temporary();
}

/* ---- a run ---- */

/* After all that plgen does at its end. What else would be done there is for this process, which goes on, or takes
 * longer under sanitizers than a case. */
static void end(int status, void *nothing)
{
	(void)nothing;
	if (__lsan_do_leak_check)
		__lsan_do_leak_check();
	_exit(status);
}

static _Noreturn void become_plgen(int argc, char **argv)
{
	enum { LIMIT = 400 };           /* seconds for what should take a fraction of one */
	int nothing = open("/dev/null", O_RDONLY);
	for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
		signal(ends[i], SIG_DFL);
	if (chdir(in) != 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(output, STDOUT_FILENO) < 0 ||
	    dup2(messages, STDERR_FILENO) < 0)
		_exit(99);
	alarm(LIMIT);
	on_exit(end, NULL);
	exit(plgen(argc, argv));
}

/* Exit status, or 128 and the signal */
static int wait_for(pid_t child)
{
	int status;
	if (child < 0 || waitpid(child, &status, 0) < 0)
		bail_out("no process could be started");
	return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

static void rewind_both(void)
{
	if (ftruncate(output, 0) != 0 || lseek(output, 0, SEEK_SET) < 0 || ftruncate(messages, 0) != 0 ||
	    lseek(messages, 0, SEEK_SET) < 0)
		bail_out("a temporary file cannot be emptied");
}

/* With the options `before`, two or none */
static int run(const struct one *c, char *const *before)
{
	char *spec = print("%s.spec", c->name), *argument[c->arguments + 5];
	int count = 0;
	argument[count++] = "plgen";
	for (int i = 0; before && i < 2; i++)
		argument[count++] = before[i];
	for (int i = 0; i < c->arguments; i++)
		argument[count++] = c->argument[i];
	if (c->spec.at)
		argument[count++] = spec;
	argument[count] = NULL;
	rewind_both();
	fflush(stdout);
	pid_t child = fork();
	if (child == 0)
		become_plgen(count, argument);
	free(spec);
	return wait_for(child);
}

static off_t size_of(int descriptor)
{
	struct stat status;
	return fstat(descriptor, &status) == 0 ? status.st_size : 0;
}

/* ---- what was said, beside what should be ---- */

/* Without the lines of slow work, as gen/base/progress.c writes them: sanitizers on a busy machine make work slow. */
static size_t without_progress(char *text)
{
	char *to = text;
	for (char *line = text, *next; *line; line = next) {
		next = line + strcspn(line, "\n");
		const char end = *next;
		*next = 0;
		const bool stays = fnmatch("plgen: *, [0-9]* of [0-9]*, [0-9]* s", line, 0) != 0;
		*next = end;
		next += end != 0;
		if (stays) {
			memmove(to, line, (size_t)(next - line));
			to += next - line;
		}
	}
	*to = 0;
	return (size_t)(to - text);
}

static struct text said(void)
{
	size_t length = (size_t)size_of(messages);
	char *text = calloc(length + 1, 1);
	if (!text || pread(messages, text, length, 0) != (ssize_t)length)
		bail_out("standard error cannot be read");
	return (struct text){ text, strlen(text) == length ? without_progress(text) : length };
}

/* A line of a text, without its end; at NULL: there is none */
static struct text line_of(struct text text, int number)
{
	const char *at = text.at, *end = text.at + text.length, *stop = NULL;
	for (; at < end; at = stop + 1, number--) {
		stop = memchr(at, '\n', (size_t)(end - at));
		stop = stop ? stop : end;
		if (number == 0)
			return (struct text){ at, (size_t)(stop - at) };
	}
	return (struct text){ 0 };
}

static int lines_of(struct text text)
{
	int count = 0;
	while (line_of(text, count).at)
		count++;
	return count;
}

static bool same(struct text a, struct text b)
{
	return a.length == b.length && memcmp(a.at, b.at, a.length) == 0;
}

/* Shortened, in ASCII */
static void show(char mark, struct text line)
{
	fprintf(told, "#   %c", mark);
	for (size_t i = 0; i < line.length && i < 200; i++)
		putc(line.at[i] >= ' ' && line.at[i] <= '~' ? line.at[i] : line.at[i] == '\t' ? '\t' : '?', told);
	putc('\n', told);
}

static void show_lines(char mark, struct text text, int from, int to)
{
	enum { MOST = 20 };
	for (int i = from; i < to && i < from + MOST; i++)
		show(mark, line_of(text, i));
}

/* The lines between the first that differs and the last, with two around them */
static void show_difference(struct text wanted, struct text found)
{
	int first = 0, of_wanted = lines_of(wanted), of_found = lines_of(found);
	int least = of_wanted < of_found ? of_wanted : of_found, last = 0;
	while (first < least && same(line_of(wanted, first), line_of(found, first)))
		first++;
	while (last < least - first &&
	       same(line_of(wanted, of_wanted - 1 - last), line_of(found, of_found - 1 - last)))
		last++;
	show_lines(' ', wanted, first < 2 ? 0 : first - 2, first);
	show_lines('-', wanted, first, of_wanted - last);
	show_lines('+', found, first, of_found - last);
	show_lines(' ', wanted, of_wanted - last, of_wanted - last + (last < 2 ? last : 2));
}

static void check_said(const char *when)
{
	const struct text found = said();
	if (!same(running->said, found)) {
		complain(when, "standard error differs (- expected, + found)");
		show_difference(running->said, found);
	}
	free((char *)found.at);
}

/* ---- files that have to stay ---- */

static bool is_kept(const char *name)
{
	char text[32], *path = print("%s/%s", out, name);
	int from = open(path, O_RDONLY);
	ssize_t length = from < 0 ? -1 : read(from, text, sizeof text);
	close(from);
	free(path);
	return length == (ssize_t)as_it_was.length && memcmp(text, as_it_was.at, as_it_was.length) == 0;
}

/* Changed, gone, or new */
static void check_files(void)
{
	static const char when[] = "with -o: ";
	const int before = complaints;
	for (int i = 0; i < 2; i++)
		if (!is_kept(kept[i]))
			complain(when, "%s was changed", kept[i]);
	DIR *all = opendir(out);
	for (const struct dirent *entry; all && (entry = readdir(all));)
		if (entry->d_name[strspn(entry->d_name, ".")] && strcmp(entry->d_name, kept[0]) != 0 &&
		    strcmp(entry->d_name, kept[1]) != 0)
			complain(when, "%s is left over", entry->d_name);
	closedir(all);
	if (complaints > before) {
		empty(out);
		put_kept();
	}
}

/* ---- a case ---- */

static void check_status(const char *when, int status)
{
	if (status != running->status)
		complain(when, "exit status %d, expected %d", status, running->status);
}

static void run_to_stdout(const struct one *c)
{
	check_status("", run(c, NULL));
	if (c->status != 0 && size_of(output) > 0)
		complain("", "standard output is not empty");
	if (c->status == 0 && size_of(output) == 0)
		complain("", "standard output is empty");
	check_said("");
}

static void run_onto_files(const struct one *c)
{
	char option[] = "-o", *path = print("%s/kept.c", out);
	check_status("with -o: ", run(c, (char *const[]){ option, path }));
	if (size_of(output) > 0)
		complain("with -o: ", "standard output is not empty");
	check_said("with -o: ");
	check_files();
	free(path);
}

/* A list of equilibria goes to standard output alone. */
static bool prints_alone(const struct one *c)
{
	for (int i = 0; i < c->arguments; i++)
		if (strcmp(c->argument[i], "--equilibrium") == 0)
			return true;
	return false;
}

char *run_case(const struct one *c, bool to_stdout, bool onto_files)
{
	char *text;
	size_t length;
	if (stopped)
		bail_out("stopped by signal %d", (int)stopped);
	running = c;
	complaints = 0;
	told = open_memstream(&text, &length);
	if (!told)
		bail_out("out of memory");
	lay_out(c, in);
	if (c->status != 1 || to_stdout)
		run_to_stdout(c);
	if (c->status == 1 && onto_files && !prints_alone(c))
		run_onto_files(c);
	empty(in);
	fclose(told);
	return text;
}
