/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far slow work is: on a terminal one line that changes, for what takes longer than a second; elsewhere, so that a
 * log shows it, a line for every ten seconds of computing, which no short work ever reaches. Nothing that is generated
 * depends on it. */
#define _POSIX_C_SOURCE 200809L
#include "base/base.h"

#include <time.h>
#include <unistd.h>

static bool shown;

static int64_t milliseconds(clockid_t clock)
{
	struct timespec t;
	clock_gettime(clock, &t);
	return 1000 * (int64_t)t.tv_sec + t.tv_nsec / 1000000;
}

static void change_line(const char *what, int done, int all)
{
	static int64_t start, last;
	int64_t now = milliseconds(CLOCK_MONOTONIC);
	if (done == 0)
		start = now;
	if (now - start < 1000 || now - last < 200)
		return;
	last = now;
	shown = true;
	fprintf(stderr, "\rplgen: %s, %d of %d ", what, done, all);
	fflush(stderr);
}

static void add_line(const char *what, int done, int all)
{
	static int64_t last, soonest;           /* soonest: by the other clock, which is read in a tenth of the time */
	int64_t now;
	if (milliseconds(CLOCK_MONOTONIC) < soonest)
		return;
	now = milliseconds(CLOCK_PROCESS_CPUTIME_ID);
	soonest = milliseconds(CLOCK_MONOTONIC) + last + 10000 - now;
	if (now - last < 10000)
		return;
	last = now;
	fprintf(stderr, "plgen: %s, %d of %d, %d s\n", what, done, all, (int)(now / 1000));
	fflush(stderr);
}

void progress(const char *what, int done, int all)
{
	static int terminal = -1;
	if (terminal < 0)
		terminal = isatty(STDERR_FILENO);
	(terminal ? change_line : add_line)(what, done, all);
}

void progress_end(void)
{
	if (shown)
		fputs("\r\033[K", stderr);
	shown = false;
}
