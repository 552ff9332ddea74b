/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Other programs: found, started with a list of arguments, and what they say. Each is a group of its own, with all
 * that it starts, which ends with plrun. */
#define _GNU_SOURCE
#include "plrun.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

const char *folder_of_program(void)
{
	static char path[4096];
	ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
	if (length <= 0)
		return NULL;
	path[length] = 0;
	char *slash = strrchr(path, '/');
	if (!slash)
		return NULL;
	*slash = 0;
	return path;
}

char *find_in_path(const char *name)
{
	const char *path = getenv("PATH");
	if (strchr(name, '/'))
		return access(name, X_OK) == 0 ? format("%s", name) : NULL;
	for (path = path ? path : "/usr/bin:/bin"; ; path++) {
		size_t length = strcspn(path, ":");
		char *file = length ? format("%.*s/%s", (int)length, path, name) : format("./%s", name);
		if (access(file, X_OK) == 0)
			return file;
		free(file);
		path += length;
		if (!*path)
			return NULL;
	}
}

/* An open file without a name */
static FILE *nameless(void)
{
	const char *folder = getenv("TMPDIR");
	char *path = format("%s/plrun.XXXXXX", folder && *folder ? folder : "/tmp");
	int file = mkostemp(path, O_CLOEXEC);
	if (file < 0)
		fail(WRONG_DATA, format("cannot write '%s': %s", path, strerror(errno)));
	unlink(path);
	free(path);
	return need(fdopen(file, "w+b"));
}

static char *whole(FILE *f, size_t *length)
{
	fseek(f, 0, SEEK_END);
	long size = ftell(f);
	rewind(f);
	char *text = need(malloc((size_t)size + 1));
	*length = fread(text, 1, (size_t)size, f);
	text[*length] = 0;
	fclose(f);
	return text;
}

FILE *input_kept(void)
{
	static FILE *kept;
	char part[4096];
	if (kept)
		return kept;
	kept = nameless();
	for (size_t length; (length = fread(part, 1, sizeof part, stdin)) > 0;)
		if (fwrite(part, 1, length, kept) != length)
			fail(WRONG_DATA, format("no room for standard input: %s", strerror(errno)));
	if (ferror(stdin))
		fail(WRONG_DATA, format("cannot read standard input: %s", strerror(errno)));
	return kept;
}

/* Without the signals that plrun waits for: it ends what it has started itself. */
static int start(const char *const *argv, FILE *const standard[3], pid_t *child)
{
	posix_spawn_file_actions_t files;
	posix_spawnattr_t attributes;
	sigset_t none;
	sigemptyset(&none);
	posix_spawn_file_actions_init(&files);
	posix_spawnattr_init(&attributes);
	posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
	posix_spawnattr_setpgroup(&attributes, 0);
	posix_spawnattr_setsigmask(&attributes, &none);
	for (int i = 0; i < 3; i++)
		if (standard[i])
			posix_spawn_file_actions_adddup2(&files, fileno(standard[i]), i);
		else
			posix_spawn_file_actions_addopen(&files, i, "/dev/null", 0, 0);
	int error = posix_spawnp(child, argv[0], &files, &attributes, (char *const *)(uintptr_t)argv, environ);
	posix_spawn_file_actions_destroy(&files);
	posix_spawnattr_destroy(&attributes);
	return error;
}

static int wait_for(pid_t child, int *status)
{
	while (waitpid(child, status, 0) < 0)
		if (errno != EINTR)
			return errno;
	return 0;
}

char *run_command(const char *const *argv, FILE *input, struct said *said)
{
	FILE *out = nameless(), *err = nameless();
	struct unfinished program = { 0 };
	int status = 0;
	size_t length;
	if (input)
		rewind(input);          /* what is in memory is written, too */
	unfinished_begins();
	int error = start(argv, (FILE *const[]){ input, out, err }, &program.group);
	unfinished_is(error ? NULL : &program);
	if (!error) {
		error = wait_for(program.group, &status);
		unfinished_ends(&program);
	}
	said->out = whole(out, &said->out_length);
	said->err = whole(err, &length);
	if (error)
		return format("cannot run '%s': %s", argv[0], strerror(error));
	said->status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
	return NULL;
}
