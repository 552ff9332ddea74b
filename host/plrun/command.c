/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Other programs: found, started with a list of arguments, and what they say. */
#define _GNU_SOURCE
#include "plrun.h"

#include <errno.h>
#include <fcntl.h>
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

char *run_command(const char *const *argv, FILE *input, bool inherits, struct said *said)
{
	FILE *out = nameless(), *err = nameless();
	posix_spawn_file_actions_t files;
	pid_t child;
	int status;
	size_t length;
	posix_spawn_file_actions_init(&files);
	if (input)
		posix_spawn_file_actions_adddup2(&files, fileno(input), STDIN_FILENO);
	else if (!inherits)
		posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", 0, 0);
	posix_spawn_file_actions_adddup2(&files, fileno(out), STDOUT_FILENO);
	posix_spawn_file_actions_adddup2(&files, fileno(err), STDERR_FILENO);
	int error = posix_spawnp(&child, argv[0], &files, NULL, (char *const *)(uintptr_t)argv, environ);
	posix_spawn_file_actions_destroy(&files);
	if (!error)
		while (waitpid(child, &status, 0) < 0)
			if (errno != EINTR) {
				error = errno;
				break;
			}
	said->out = whole(out, &said->out_length);
	said->err = whole(err, &length);
	if (error)
		return format("cannot run '%s': %s", argv[0], strerror(error));
	said->status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
	return NULL;
}
