/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lines of a sweep that are done, in a file of the cache: "row sum length", the line. What a kill has left half
 * written does not have its sum, and the journal ends before it. */
#define _GNU_SOURCE
#include "plrun.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

struct journal {
	char *path;
	int file;
};

static char *sum_of(const char *line)
{
	struct hash h;
	hash_begin(&h);
	hash_text(&h, line);
	return hash_name(&h);
}

/* One entry of `text`, which ends with a 0; the number of its bytes, 0: there is none whole */
static size_t take_entry(const char *text, size_t rows, char **line)
{
	size_t row, length;
	int head = 0;
	char sum[33];
	if (sscanf(text, "%zu %32s %zu%n", &row, sum, &length, &head) != 3 || text[head] != '\n' || row >= rows)
		return 0;
	const char *from = text + head + 1;
	if (strnlen(from, length) != length)
		return 0;
	char *copy = need(strndup(from, length));
	if (strcmp(sum_of(copy), sum) != 0)
		return 0;
	line[row] = copy;
	return (size_t)head + 1 + length;
}

static void read_entries(struct journal *j, size_t rows, char **line)
{
	size_t length, at = 0, taken;
	char *text = read_whole(j->path, &length);
	while (text && at < length && (taken = take_entry(text + at, rows, line)) > 0)
		at += taken;
	if (ftruncate(j->file, (off_t)at) != 0)
		fail(WRONG_DATA, format("cannot write '%s': %s", j->path, strerror(errno)));
	free(text);
}

struct journal *journal_open(const char *key, bool resume, size_t rows, char **line)
{
	struct journal *j = need(calloc(1, sizeof *j));
	j->path = format("%s/sweep-%s", cache_folder(), key);
	j->file = open(j->path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
	if (j->file < 0)
		fail(WRONG_DATA, format("cannot write '%s': %s", j->path, strerror(errno)));
	if (flock(j->file, LOCK_EX | LOCK_NB) != 0)
		fail(WRONG_DATA, "the same sweep is running");
	if (resume)
		read_entries(j, rows, line);
	else if (ftruncate(j->file, 0) != 0)
		fail(WRONG_DATA, format("cannot write '%s': %s", j->path, strerror(errno)));
	return j;
}

void journal_add(struct journal *j, size_t row, const char *line)
{
	char *entry = format("%zu %s %zu\n%s", row, sum_of(line), strlen(line), line);
	size_t length = strlen(entry);
	if (write(j->file, entry, length) != (ssize_t)length)
		fail(WRONG_DATA, format("cannot write '%s': %s", j->path, strerror(errno)));
	free(entry);
}

void journal_end(struct journal *j)
{
	unlink(j->path);
	close(j->file);
	free(j->path);
	free(j);
}
