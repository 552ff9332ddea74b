/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What another program does in the place of plrun. --chart: error against time of plgen's steps and of other solvers on
 * one model, by a script, bench/charts/own, which is installed beside the runtime. --page: by plgen. */
#define _GNU_SOURCE
#include "plrun.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *find_script(const char *runtime)
{
	const char *place[] = { format("%s/../charts/own/own.sh", runtime),
				format("%s/../bench/charts/own/own.sh", runtime) };
	for (int i = 0; i < 2; i++)
		if (access(place[i], R_OK) == 0)
			return place[i];
	fail(WRONG_DATA, format("--chart: '%s' is not there: install plgen with its charts", place[0]));
}

/* In the place of this program; signals end it, and it what it has started. */
static _Noreturn void become(const char **argv, const char *option)
{
	sigset_t none;
	sigemptyset(&none);
	sigprocmask(SIG_SETMASK, &none, NULL);
	execvp(argv[0], (char *const *)(uintptr_t)argv);
	fail(WRONG_DATA, format("%s: cannot start %s: %s", option, argv[0], strerror(errno)));
}

void make_page(const struct toolchain *t, const struct options *o)
{
	const char **argv = need(calloc(o->passed_count + 2 * o->definitions + 6, sizeof *argv));
	size_t count = 0;
	argv[count++] = plgen_of(t);
	for (size_t i = 0; i < o->passed_count; i++)
		argv[count++] = o->passed[i];
	for (size_t i = 0; i < o->definitions; i++) {
		argv[count++] = "-D";
		argv[count++] = format("%s=%s", o->definition[i].name, o->definition[i].value);
	}
	argv[count++] = "--page";
	argv[count++] = o->page;
	argv[count++] = "--";
	argv[count++] = o->spec;
	become(argv, "--page");
}

void run_chart(const struct toolchain *t, const struct options *o)
{
	const char *folder = o->output ? o->output : "charts";
	const char *argv[] = { "sh", find_script(runtime_of(t)), plgen_of(t), o->spec, folder,
			       o->until >= 0 ? shortest(o->until, false) : "",
			       o->every > 0 ? shortest(o->every, false) : "", NULL };
	setenv("PLGEN_RUNTIME", runtime_of(t), 1);
	become(argv, "--chart");
}
