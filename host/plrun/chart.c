/* SPDX-License-Identifier: GPL-3.0-or-later */
/* --chart: error against time of plgen's steps and of other solvers on one model. A script does it, bench/charts/own,
 * which is installed beside the runtime; plrun becomes that script. */
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

void run_chart(const struct toolchain *t, const struct options *o)
{
	const char *folder = o->output ? o->output : "charts";
	const char *argv[] = { "sh", find_script(runtime_of(t)), plgen_of(t), o->spec, folder,
			       o->until >= 0 ? shortest(o->until, false) : "",
			       o->every > 0 ? shortest(o->every, false) : "", NULL };
	sigset_t none;
	sigemptyset(&none);
	sigprocmask(SIG_SETMASK, &none, NULL);  /* signals end the script, and it what it has started */
	setenv("PLGEN_RUNTIME", runtime_of(t), 1);
	execvp(argv[0], (char *const *)(uintptr_t)argv);
	fail(WRONG_DATA, format("--chart: cannot start sh: %s", strerror(errno)));
}
