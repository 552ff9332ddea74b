/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cases.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

const char *base_name(const char *path)
{
	const char *slash = strrchr(path, '/');
	return slash ? slash + 1 : path;
}

char *read_text(const char *path)
{
	size_t length = 0, got;
	FILE *f = fopen(path, "r");
	if (!f) {
		printf("Bail out! cannot read %s\n", path);
		exit(1);
	}
	char *text = ARRAY(char, 4096);
	while ((got = fread(text + length, 1, 4095, f)) > 0) {
		length += got;
		ENLARGE(text, length + 4096);
	}
	text[length] = 0;
	fclose(f);
	return text;
}

struct spec *spec_of(const char *path, const char *text)
{
	struct source *source = NEW(struct source);
	*source = (struct source){ .name = path, .base = "spec", .text = text, .length = strlen(text) };
	return parse_spec(source);
}

const char *diagnostics(void)
{
	char *text = NULL;
	size_t length;
	FILE *to = open_memstream(&text, &length);
	diagnostics_print(to);
	fclose(to);
	const char *copy = format("%s", text);
	free(text);
	return copy;
}

const char *first_line(const char *text)
{
	return format("%.*s", (int)strcspn(text, "\n"), text);
}

void show_spec(const char *text)
{
	while (*text) {
		const size_t length = strcspn(text, "\n");
		printf("# | %.*s\n", (int)length, text);
		text += length + (text[length] == '\n');
	}
}

void take_options(int argc, char **argv, const struct command_option *options)
{
	const struct command_option *o;
	const char *letters = "";
	for (o = options; o->letter; o++)
		letters = format(o->number ? "%s%c:" : "%s%c", letters, o->letter);
	for (int letter; (letter = getopt(argc, argv, letters)) != -1;) {
		for (o = options; o->letter && o->letter != letter; o++)
			;
		if (!o->letter)
			exit(2);
		if (o->number)
			*o->number = strtoul(optarg, NULL, 10);
		else
			*o->on = true;
	}
}

/* ---- cases ---- */

static int reported, failures;

int cases_reported(void)
{
	return reported;
}

int cases_failed(void)
{
	return failures;
}

void report_case(const char *name, bool good)
{
	failures += !good;
	printf("%sok %d - %s\n", good ? "" : "not ", ++reported, name);
	fflush(stdout);
}

bool run_case(const char *name, unsigned seconds, bool (*work)(void *context), void *context)
{
	int status;
	fflush(stdout);
	const pid_t child = fork();
	if (child == 0) {
		alarm(seconds);
		const bool good = work(context);
		fflush(stdout);
		_exit(!good);
	}
	if (child < 0 || waitpid(child, &status, 0) != child) {
		puts("Bail out! cannot start a process");
		exit(1);
	}
	if (WIFSIGNALED(status))
		printf("# ended by signal %d%s\n", WTERMSIG(status), WTERMSIG(status) == SIGALRM ? ": took too long"
				: "");
	const bool good = WIFEXITED(status) && WEXITSTATUS(status) == 0;
	report_case(name, good);
	return good;
}
