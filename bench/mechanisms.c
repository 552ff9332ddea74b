/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mechanisms.sh compiles this for one model: a history by plgen's step, without OURS by DOP853 or RADAU5 of the kept
 * charts. `measured` is what callgrind counts; then the last state is printed.
 *
 *     mechanisms UNITS taylor | dop853 TOLERANCE | radau5 TOLERANCE */
#ifdef OURS
#include "subject_pl.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
enum { N = SUBJECT_STATES };
static subject model;
#else
#include "own.h"
bool own_dop853(double setting, double *rows);          /* the files of the kept charts, of this model */
bool own_radau5(double setting, double *rows);
struct history history;
static double rows[100000];
#endif

__attribute__((noinline)) void measured(int units, const char *method, double tolerance, double *last)
{
#ifdef OURS
	(void)method;
	(void)tolerance;
	subject_run(&model, (size_t)units, NULL);
	subject_get(&model, last);
#else
	const bool good = strcmp(method, "dop853") == 0 ? own_dop853(tolerance, rows) : own_radau5(tolerance, rows);
	for (int i = 0; i < N; i++)
		last[i] = good ? rows[(units - 1) * N + i] : NAN;
#endif
}

int main(int argc, char **argv)
{
	const int units = atoi(argv[1]);
	double last[N] = { 0 };
#ifdef OURS
	subject_init(&model);
#else
	const double start[N] = { START };
	history.every = EVERY;
	history.units = units;
	history.most = 1000000000;
	for (int i = 0; i < N; i++) {
		history.start[i] = start[i];
		history.scale[i] = i < N / 2 ? 1.0 : 5.0;
	}
#endif
	measured(units, argv[2], argc > 3 ? atof(argv[3]) : 0.0, last);
	for (int i = 0; i < N; i++)
		printf("%.17g%c", last[i], i < N - 1 ? ' ' : '\n');
	return 0;
}
