/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cases as files. */
#define _GNU_SOURCE     /* nftw */
#include "cases.h"

#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

char *scratch(void)
{
	const char *parent = getenv("TMPDIR");
	char *folder = print("%s/plgen.XXXXXX", parent && *parent ? parent : "/tmp");
	if (!mkdtemp(folder))
		bail_out("%s cannot be made", folder);
	return folder;
}

static int remove_one(const char *path, const struct stat *status, int kind, struct FTW *where)
{
	(void)status;
	(void)kind;
	return where->level > 0 ? remove(path) : 0;
}

void empty(const char *folder)
{
	if (nftw(folder, remove_one, 16, FTW_DEPTH | FTW_PHYS) != 0)
		bail_out("%s cannot be emptied", folder);
}

void write_file(const char *folder, const char *name, struct text text)
{
	char *path = print("%s/%s", folder, name);
	FILE *to = fopen(path, "wb");
	if (!to || fwrite(text.at, 1, text.length, to) != text.length || fclose(to) != 0)
		bail_out("%s cannot be written", path);
	free(path);
}

/* ---- a spec that a script prints ---- */

static bool is_script(struct text text)
{
	static const char first[] = "#!/bin/sh\n";
	return text.length >= strlen(first) && memcmp(text.at, first, strlen(first)) == 0;
}

static _Noreturn void become_script(const char *folder, const char *name, const char *script)
{
	int to = chdir(folder) == 0 ? open(name, O_WRONLY | O_CREAT | O_TRUNC, 0666) : -1;
	if (to >= 0 && dup2(to, STDOUT_FILENO) >= 0)
		execlp("sh", "sh", "-eu", "-c", script, (char *)NULL);
	_exit(99);
}

static void run_script(const struct one *c, const char *folder, const char *name)
{
	int status;
	char *script = print("%.*s", (int)c->spec.length, c->spec.at);
	fflush(stdout);
	pid_t child = fork();
	if (child == 0)
		become_script(folder, name, script);
	if (child < 0 || waitpid(child, &status, 0) < 0 || status != 0)
		bail_out("the script of %s failed", c->name);
	free(script);
}

/* ---- a case ---- */

static void write_files(const struct files *files, const char *folder)
{
	for (int i = 0; i < files->count; i++)
		write_file(folder, files->file[i].name, files->file[i].text);
}

void lay_out(const struct one *c, const char *folder)
{
	char *name = print("%s.spec", c->name);
	write_files(&c->topic->shared, folder);
	write_files(&c->beside, folder);
	if (is_script(c->spec))
		run_script(c, folder, name);
	else if (c->spec.at)
		write_file(folder, name, c->spec);
	free(name);
}

static void write_part(const struct one *c, const char *folder, const char *ending, struct text text)
{
	char *name = print("%s.%s", c->name, ending);
	write_file(folder, name, text);
	free(name);
}

void keep(const struct one *c, const char *folder)
{
	char *topic = print("%s/%s", folder, c->topic->name), *own = print("%s/%s", topic, c->name);
	char *arguments = print("%s", ""), *status = print("%d\n", c->status);
	mkdir(topic, 0777);
	if (mkdir(own, 0777) != 0)
		bail_out("%s cannot be made", own);
	lay_out(c, own);
	for (int i = 0; i < c->arguments; i++)
		arguments = print("%s%s\n", arguments, c->argument[i]);
	write_part(c, own, "args", (struct text){ arguments, strlen(arguments) });
	write_part(c, own, "status", (struct text){ status, strlen(status) });
	write_part(c, own, "expect", c->said);
}
