/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One line on a terminal for what takes longer than a second; silent elsewhere. Nothing that is generated depends on
 * it. */
#define _POSIX_C_SOURCE 200809L
#include "base/base.h"

#include <time.h>
#include <unistd.h>

static bool shown;

static long milliseconds(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return 1000 * (long)t.tv_sec + t.tv_nsec / 1000000;
}

void progress(const char *what, int done, int all)
{
	static long start, last;
	long now = milliseconds();
	if (done == 0)
		start = now;
	if (!isatty(STDERR_FILENO) || now - start < 1000 || now - last < 200)
		return;
	last = now;
	shown = true;
	fprintf(stderr, "\rplgen: %s, %d of %d ", what, done, all);
	fflush(stderr);
}

void progress_end(void)
{
	if (shown)
		fputs("\r\033[K", stderr);
	shown = false;
}
