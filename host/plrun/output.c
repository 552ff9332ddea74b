/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that are written: a file gets its new content when all of it is there, and until then stays as it was. What is
 * no file, a device or a pipe, is written where it is. */
#define _GNU_SOURCE
#include "plrun.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct output {
	const char *path;
	char *temporary;                        /* beside it; NULL: it is written itself */
	struct unfinished unfinished;
};

static _Noreturn void cannot_write(const char *path)
{
	fail(WRONG_DATA, format("cannot write '%s': %s", path, strerror(errno)));
}

static void remove_file(const char *path)
{
	unlink(path);
}

static mode_t usual_mode(void)
{
	mode_t mask = umask(0);
	umask(mask);
	return 0666 & ~mask;
}

/* Beside the file itself, not beside a link to it, with the mode that it has */
static FILE *open_beside(struct output *o, mode_t mode)
{
	o->temporary = format("%s.XXXXXX", o->path);
	unfinished_begins();
	int file = mkostemp(o->temporary, O_CLOEXEC);
	o->unfinished = (struct unfinished){ .path = o->temporary, .remove = remove_file };
	unfinished_is(file < 0 ? NULL : &o->unfinished);
	if (file < 0 || fchmod(file, mode) != 0)
		cannot_write(o->path);
	return fdopen(file, "wb");
}

FILE *output_open(const char *path, struct output **output)
{
	struct output *o = *output = need(calloc(1, sizeof *o));
	struct stat about, link;
	if (!path)
		return stdout;
	bool there = stat(path, &about) == 0, leads_nowhere = !there && lstat(path, &link) == 0;
	bool beside = there ? S_ISREG(about.st_mode) : !leads_nowhere;
	o->path = there && beside ? realpath(path, NULL) : path;
	FILE *to = !o->path ? NULL : !beside ? fopen(path, "wbe")
		   : open_beside(o, there ? about.st_mode & 07777 : usual_mode());
	if (!to)
		cannot_write(path);
	return to;
}

void output_done(struct output *o, FILE *to)
{
	if (o->path && fclose(to) != 0)
		cannot_write(o->path);
	if (o->temporary && rename(o->temporary, o->path) != 0)
		cannot_write(o->path);
	unfinished_ends(&o->unfinished);
	free(o);
}
