/* SPDX-License-Identifier: GPL-3.0-or-later */
/* 30 s by step, run, jump and at against --solution: within 1e-12 of the largest value so far of the column.
 *
 *     linear_history MODEL SOLUTION.csv
 */
#include "linear.h"
#include "tap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double tolerance = 1e-12;

static const pl_model *model;
static int outputs;
static size_t rows, room;
static double *times, *solution, *most;         /* rows; rows x outputs, and the largest value so far */
static double worst;

static void *need(void *memory)
{
	if (!memory)
		abort();
	return memory;
}

static bool read_solution(const char *path)
{
	static char line[65536];
	FILE *from = fopen(path, "r");
	if (!from || !fgets(line, sizeof line, from))
		return false;
	bool good = true;
	line[strcspn(line, "\n")] = '\0';
	const char *p = line;
	for (int i = -1; i < outputs; i++) {
		const char *name = i < 0 ? "t" : model->output_names[i];
		const size_t length = strlen(name);
		good = good && strncmp(p, name, length) == 0 && p[length] == (i + 1 < outputs ? ',' : '\0');
		p += good ? length + 1 : 0;
	}
	while (fgets(line, sizeof line, from)) {
		if (rows == room) {
			room = 2 * room + 1000;
			times = need(realloc(times, room * sizeof *times));
			solution = need(realloc(solution, room * (size_t)outputs * sizeof *solution));
			most = need(realloc(most, room * (size_t)outputs * sizeof *most));
		}
		char *end = line;
		times[rows] = strtod(end, &end);
		for (int i = 0; i < outputs; i++) {
			good = good && *end == ',';
			const size_t at = rows * (size_t)outputs + (size_t)i;
			solution[at] = strtod(end + 1, &end);
			most[at] = fmax(fabs(solution[at]), rows ? most[at - (size_t)outputs] : 0);
		}
		good = good && *end == '\n';
		rows++;
	}
	fclose(from);
	return good && rows > 100;
}

static bool agrees(const double *out, size_t k, const char *how)
{
	bool good = true;
	for (int i = 0; i < outputs; i++) {
		const size_t at = k * (size_t)outputs + (size_t)i;
		good = close_to(out[i], solution[at], tolerance * most[at], "%s to %zu, %s", how, k,
				model->output_names[i]) &&
			good;
		if (most[at] > 0)
			worst = worse(worst, fabs(out[i] - solution[at]) / most[at]);
	}
	return good;
}

static void tell(bool good, const char *how)
{
	ok(good, "%s: %s, within %g", model->name, how, tolerance);
	note("%s, %s: largest difference %.3g", model->name, how, worst);
	worst = 0;
}

int main(int argc, char **argv)
{
	model = argc == 3 ? linear_model(argv[1]) : NULL;
	if (!model) {
		fprintf(stderr, "usage: linear_history MODEL SOLUTION.csv\n");
		return 2;
	}
	outputs = model->outputs;
	if (!ok(read_solution(argv[2]), "%s: the solution names t and the outputs, and every line is full",
			model->name))
		return tap_end();
	const size_t n = (size_t)outputs;
	void *s = need(calloc(1, model->size));
	double *out = need(calloc(rows * n, sizeof *out)), *y = need(calloc((size_t)model->states * 2, sizeof *y)),
		*next = y + model->states;
	double *scale = need(calloc((size_t)model->states, sizeof *scale));

	bool good = true, on_time = true, ends = true, starts = true;
	double gap = 0;
	model->init(s);
	for (size_t k = 0; k < rows; k++) {
		model->out(s, out);
		good = agrees(out, k, "step") && good;
		on_time = close_to(model->time(s), times[k], 0, "time of step %zu", k) && on_time;
		model->get(s, next);
		for (int i = 0; i < model->states; i++)
			scale[i] = fmax(scale[i], fabs(next[i]));
		if (model->at) {
			if (k > 0)
				for (int i = 0; i < model->states; i++) {
					ends = close_to(y[i], next[i], tolerance * scale[i], "at h after step %zu, %s",
							k - 1,
						model->state_names[i]) && ends;
					gap = scale[i] > 0 ? fmax(gap, fabs(y[i] - next[i]) / scale[i]) : gap;
				}
			model->at(s, NULL, 0, y);
			starts = memcmp(y, next, (size_t)model->states * sizeof *y) == 0 && starts;
			model->at(s, NULL, model->h, y);
		}
		model->step(s, NULL);
	}
	tell(good, "step");
	ok(on_time, "%s: the time is the solution's", model->name);
	if (model->at) {
		ok(starts, "%s: at 0 is the state itself", model->name);
		ok(ends, "%s: at h is the next state, within %g", model->name, tolerance);
		note("%s, at h: largest difference %.3g", model->name, gap);
	}

	good = true;
	model->init(s);
	model->run(s, rows - 1, NULL, out);
	for (size_t k = 1; k < rows; k++)
		good = agrees(out + (k - 1) * n, k, "run") && good;
	tell(good, "run");

	if (model->jump) {
		const size_t goals[] = {0, 1, 2, 3, 17, 100, (rows - 1) / 2, rows - 2, rows - 1};
		good = true;
		for (size_t i = 0; i < sizeof goals / sizeof *goals; i++) {
			model->init(s);
			model->jump(s, goals[i] / 3);
			model->jump(s, goals[i] - goals[i] / 3);
			model->out(s, out);
			good = agrees(out, goals[i], "jump") && good;
			good = close_to(model->time(s), times[goals[i]], 0, "time after a jump to %zu", goals[i]) &&
					good;
		}
		model->init(s);
		model->jump(s, rows / 2);
		for (size_t k = rows / 2; k < rows; k++) {
			model->out(s, out);
			good = agrees(out, k, "step after jump") && good;
			model->step(s, NULL);
		}
		tell(good, "jump");
	}
	free(scale);
	free(y);
	free(out);
	free(s);
	return tap_end();
}
