/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gnuplot draws: its script goes in and its picture comes out through files without names, so that nothing of it is
 * left where it fails, and no shell reads any of it. */
#define _GNU_SOURCE
#include "report/report.h"

#include <errno.h>
#include <spawn.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static FILE *nameless(void)
{
	FILE *f = tmpfile();
	if (!f) {
		fprintf(stderr, "plgen: error: no room for a temporary file: %s\n", strerror(errno));
		abandon();
	}
	return f;
}

static _Noreturn void cannot_draw(int number)
{
	if (number == ENOENT)
		fputs("plgen: error: gnuplot draws pictures, and it is not installed\n"
		      "note: apt-get install gnuplot-nox, or another package of it\n", stderr);
	else
		fprintf(stderr, "plgen: error: gnuplot does not start: %s\n", strerror(number));
	abandon();
}

/* -d: without the user's own settings. Its exit status */
static int run(FILE *script, FILE *picture, FILE *words)
{
	static char name[] = "gnuplot", settings[] = "-d", input[] = "-";
	char *const argument[] = { name, settings, input, NULL };
	posix_spawn_file_actions_t actions;
	pid_t child;
	int status = -1;
	posix_spawn_file_actions_init(&actions);
	posix_spawn_file_actions_adddup2(&actions, fileno(script), STDIN_FILENO);
	posix_spawn_file_actions_adddup2(&actions, fileno(picture), STDOUT_FILENO);
	posix_spawn_file_actions_adddup2(&actions, fileno(words), STDERR_FILENO);
	int failed = posix_spawnp(&child, name, &actions, NULL, argument, environ);
	posix_spawn_file_actions_destroy(&actions);
	if (failed)
		cannot_draw(failed);
	while (waitpid(child, &status, 0) < 0 && errno == EINTR)
		;
	return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void copy_file(FILE *from, FILE *to)
{
	char part[4096];
	rewind(from);
	for (size_t length; (length = fread(part, 1, sizeof part, from)) > 0;)
		fwrite(part, 1, length, to);
}

void draw(FILE *to, FILE *script)
{
	FILE *picture = nameless(), *words = nameless();
	if (fflush(script) != 0 || ferror(script)) {
		fprintf(stderr, "plgen: error: no room for a temporary file: %s\n", strerror(errno));
		abandon();
	}
	rewind(script);
	int status = run(script, picture, words);
	if (status == 127)
		cannot_draw(ENOENT);
	if (status != 0) {
		fputs("plgen: error: gnuplot could not draw:\n", stderr);
		copy_file(words, stderr);
		abandon();
	}
	copy_file(picture, to);
	fclose(picture);
	fclose(words);
}

FILE *new_script(void)
{
	return nameless();
}
