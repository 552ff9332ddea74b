/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clock RUNS EMPTY -- COMMAND...: wall-clock time of whole processes, COMMAND and EMPTY in turn, so that both meet the
 * same machine; prints minimum, median and maximum of each in milliseconds. Output of the processes is thrown away. */
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include "timing.h"

extern char **environ;

static double run(char **command)
{
	posix_spawn_file_actions_t quiet;
	pid_t child;
	int status;
	posix_spawn_file_actions_init(&quiet);
	posix_spawn_file_actions_addopen(&quiet, 1, "/dev/null", O_WRONLY, 0);
	double start = nanoseconds();
	if (posix_spawnp(&child, command[0], &quiet, NULL, command, environ) != 0 ||
	    waitpid(child, &status, 0) != child || status != 0) {
		fprintf(stderr, "clock: %s failed\n", command[0]);
		exit(1);
	}
	double end = nanoseconds();
	posix_spawn_file_actions_destroy(&quiet);
	return 1e-6 * (end - start);
}

static void report(const char *name, int runs, double *time)
{
	const double median_ms = middle((size_t)runs, time);
	printf("%-48s min %8.2f  median %8.2f  max %8.2f ms\n", name, time[0], median_ms, time[runs - 1]);
}

int main(int argc, char **argv)
{
	int runs = argc > 4 ? atoi(argv[1]) : 0;
	if (runs < 1 || strcmp(argv[3], "--") != 0) {
		fputs("usage: clock RUNS EMPTY -- COMMAND...\n", stderr);
		return 2;
	}
	double *of_empty = calloc((size_t)runs, sizeof *of_empty),
		*of_command = calloc((size_t)runs, sizeof *of_command);
	char *empty[] = { argv[2], NULL }, name[256] = "";
	if (!of_empty || !of_command)
		return 1;
	run(empty);
	run(argv + 4);
	for (int i = 0; i < runs; i++) {
		of_command[i] = run(argv + 4);
		of_empty[i] = run(empty);
	}
	for (int i = 4; i < argc; i++) {
		const char *slash = i == 4 ? strrchr(argv[i], '/') : NULL;
		snprintf(name + strlen(name), sizeof name - strlen(name), "%s%s", i > 4 ? " " : "",
		         slash ? slash + 1 : argv[i]);
	}
	report(name, runs, of_command);
	report("an empty program", runs, of_empty);
	free(of_empty);
	free(of_command);
	return 0;
}
