/* SPDX-License-Identifier: GPL-3.0-or-later */
/* 30 s by step, run and jump against plgen --solution 30.
 *
 *     history MODEL SOLUTION.csv
 */
#include "equations.h"
#include "models.h"
#include "tap.h"

#include "../accuracy/evaluator.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const pl_model *model;
static int outputs;
static size_t rows;                     /* of the solution: k = 0 .. rows - 1 */
static double *solution, *times;        /* rows x outputs, rows */
static double *largest;                 /* |value| of each column */
static void *state;

static void *need(size_t size)
{
	void *memory = calloc(size, 1);
	if (!memory)
		abort();
	return memory;
}

/* The first line must name t and the outputs. */
static bool header_fits(const char *line)
{
	char expected[1000] = "t";
	for (int i = 0; i < outputs; i++) {
		strcat(expected, ",");
		strcat(expected, model->output_names[i]);
	}
	strcat(expected, "\n");
	if (strcmp(line, expected) != 0)
		note("found %s# expected %s", line, expected);
	return strcmp(line, expected) == 0;
}

static bool read_row(char *line)
{
	size_t k = rows++;
	char *end;
	solution = realloc(solution, rows * (size_t)outputs * sizeof *solution);
	times = realloc(times, rows * sizeof *times);
	if (!solution || !times)
		abort();
	times[k] = strtod(line, &end);
	for (int i = 0; i < outputs; i++) {
		if (*end != ',')
			return false;
		double *value = &solution[k * (size_t)outputs + (size_t)i];
		*value = strtod(end + 1, &end);
		largest[i] = fmax(largest[i], fabs(*value));
	}
	return *end == '\n';
}

static bool read_solution(const char *path)
{
	char line[4096];
	FILE *f = fopen(path, "r");
	bool good = f && fgets(line, sizeof line, f) && header_fits(line);
	while (good && fgets(line, sizeof line, f))
		good = read_row(line);
	if (f)
		fclose(f);
	return good && rows > 1;
}

/* difference over the largest value of its column, since the last time it was told */
static double worst;

static bool row_agrees(const double *out, size_t k, const char *how)
{
	bool good = true;
	for (int i = 0; i < outputs; i++) {
		const double expected = solution[k * (size_t)outputs + (size_t)i];
		good = close_to(out[i], expected, 1e-12 * largest[i], "%s, row %zu, %s", how, k,
				model->output_names[i]) &&
			good;
		worst = worse(worst, fabs(out[i] - expected) / largest[i]);
	}
	return good;
}

static void tell(bool good, const char *how)
{
	note("%s by %s: largest difference %.3g of the column", model->name, how, worst);
	worst = 0;
	ok(good, "%s: %s, 30 s within 1e-12 of the closed form", model->name, how);
}

static double *by_step(void)
{
	double *row = need(rows * (size_t)outputs * sizeof *row);
	bool good = true;
	model->init(state);
	for (size_t k = 0; k < rows; k++) {
		if (k)
			model->step(state, NULL);
		model->out(state, row + k * (size_t)outputs);
		good = row_agrees(row + k * (size_t)outputs, k, "step") && good;
		good = close_to(model->time(state), times[k], 0, "time, row %zu", k) && good;
	}
	tell(good, "step");
	return row;
}

/* run writes the rows after each step: row 0 is before it */
static double *by_run(void)
{
	double *row = need(rows * (size_t)outputs * sizeof *row);
	bool good = true;
	model->init(state);
	model->out(state, row);
	model->run(state, rows - 1, NULL, row + outputs);
	for (size_t k = 0; k < rows; k++)
		good = row_agrees(row + k * (size_t)outputs, k, "run") && good;
	tell(good, "run");
	return row;
}

static double unit_in_the_last_place(double x)
{
	return nextafter(fabs(x), INFINITY) - fabs(x);
}

/* Rounding errors of earlier steps travel on, so after k steps it is units of the column's largest value. */
static void run_as_step(const double *stepped, const double *run)
{
	bool good = true;
	for (size_t k = 0; k < rows; k++)
		for (int i = 0; i < outputs; i++) {
			const size_t at = k * (size_t)outputs + (size_t)i;
			const double allowed = 2 * (double)k * unit_in_the_last_place(largest[i]);
			good = close_to(run[at], stepped[at], allowed, "run, row %zu, %s", k, model->output_names[i]) &&
					good;
		}
	ok(good, "%s: run agrees with step, 2 units in the last place per step", model->name);
}

/* One step from the same state. */
static void one_by_run(void)
{
	void *other = need(model->size);
	double *a = need((size_t)outputs * sizeof *a), *b = need((size_t)outputs * sizeof *b);
	bool good = true;
	model->init(state);
	for (size_t k = 1; k < rows; k++) {
		memcpy(other, state, model->size);
		model->run(other, 1, NULL, b);
		model->step(state, NULL);
		model->out(state, a);
		for (int i = 0; i < outputs; i++)
			good = close_to(b[i], a[i], 2 * unit_in_the_last_place(a[i]), "one step, row %zu, %s", k,
				model->output_names[i]) && good;
	}
	ok(good, "%s: one step by run is one by step, within 2 units in the last place", model->name);
	free(other);
	free(a);
	free(b);
}

/* run without a place for the outputs: to the last bit as with it, if it is taken in the same parts */
static void run_blind(const double *run)
{
	const size_t part[2] = {rows / 3, rows - 1 - rows / 3};
	double *out = need((size_t)outputs * sizeof *out), *seen = need(rows * (size_t)outputs * sizeof *seen);
	void *other = need(model->size);
	bool good = true;
	model->init(state);
	memcpy(other, state, model->size);
	model->run(state, 0, NULL, NULL);
	for (int i = 0; i < 2; i++) {
		model->run(state, part[i], NULL, NULL);
		model->run(other, part[i], NULL, seen);
		good = memcmp(state, other, model->size) == 0 && good;
	}
	ok(good, "%s: run without rows, in parts, ends where run with rows does", model->name);
	model->out(state, out);
	good = close_to(model->time(state), times[rows - 1], 0, "time");
	for (int i = 0; i < outputs; i++)
		good = close_to(out[i], run[(rows - 1) * (size_t)outputs + (size_t)i],
			2 * (double)(rows - 1) * unit_in_the_last_place(largest[i]), "in parts, %s",
			model->output_names[i]) &&
			good;
	ok(good, "%s: run in parts ends where the whole does, 2 units in the last place per step", model->name);
	free(out);
	free(seen);
	free(other);
}

static bool jump_lands(size_t parts, const uint64_t *part, const char *how)
{
	double *out = need((size_t)outputs * sizeof *out);
	size_t k = 0;
	model->init(state);
	for (size_t i = 0; i < parts; i++) {
		model->jump(state, part[i]);
		k += (size_t)part[i];
	}
	model->out(state, out);
	bool good = row_agrees(out, k, how);
	good = close_to(model->time(state), times[k], 0, "time after %s to %zu", how, k) && good;
	free(out);
	return good;
}

static void by_jump(void)
{
	const uint64_t all = rows - 1, goals[] = {0, 1, 2, 7, 64, 149, 1000, all / 2, all - 1, all};
	const uint64_t parts[][3] = {{0, all, 0}, {1, all - 1, 0}, {all / 3, all - all / 3, 0}, {all - 7, 0, 7}};
	bool good = true;
	for (size_t i = 0; i < sizeof goals / sizeof *goals; i++)
		if (goals[i] <= all)
			good = jump_lands(1, &goals[i], "jump") && good;
	tell(good, "jump");
	good = true;
	for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
		good = jump_lands(3, parts[i], "jump in parts") && good;
	tell(good, "jump in parts");
}

/* A jump, then steps: the loads must be where they belong. */
static void step_after_jump(void)
{
	double *out = need((size_t)outputs * sizeof *out);
	bool good = true;
	model->init(state);
	model->jump(state, rows / 2);
	for (size_t k = rows / 2; k < rows; k++) {
		model->out(state, out);
		good = row_agrees(out, k, "step after jump") && good;
		model->step(state, NULL);
	}
	tell(good, "step after jump");
	free(out);
}

/* the largest |y_i| of 30 s */
static void most_of_states(double *most)
{
	double *y = need((size_t)model->states * sizeof *y);
	model->init(state);
	for (size_t k = 0; k < rows; k++) {
		model->get(state, y);
		for (int i = 0; i < model->states; i++)
			most[i] = fmax(most[i], fabs(y[i]));
		model->step(state, NULL);
	}
	free(y);
}

/* e^{A n h} of the equations written by hand, n = 10^9, where only jump gets */
static void far_jump(void)
{
	enum { FAR = 1000000000 };
	struct equations *e = equations_of(model->name);
	if (!ok(e != NULL, "%s: its equations are written in equations.c", model->name))
		return;
	mpq_t *x = new_rationals(e->size), *t = new_rationals(1);
	const size_t bytes = (size_t)e->size * sizeof(double);
	double *start = need(bytes), *y = need(bytes), *jumped = need(bytes), *most = need(bytes);
	for (int i = 0; i < e->states; i++)
		start[i] = nearest_double(e->initial[i]);
	equations_time(e, 0, t[0]);
	equations_vector(e, start, t[0], x);
	equations_time(e, FAR, t[0]);
	bool good = evaluator_apply((size_t)e->size, (const mpq_t *)e->A, t[0], (const mpq_t *)x, y) == 0;
	if (!good)
		note("%s: the evaluator gave up", model->name);
	most_of_states(most);
	model->init(state);
	model->jump(state, FAR);
	model->get(state, jumped);
	for (int i = 0; i < e->states; i++) {
		good = close_to(jumped[i], y[i], 1e-12 * most[i], "after 10^9 steps, %s", model->state_names[i]) &&
				good;
		worst = worse(worst, fabs(jumped[i] - y[i]) / most[i]);
	}
	good = close_to(model->time(state), nearest_double(t[0]), 0, "time after 10^9 steps") && good;
	note("%s, jump of 10^9 steps: largest difference %.3g", model->name, worst);
	ok(good, "%s: a jump of 10^9 steps within 1e-12", model->name);
	free(start);
	free(y);
	free(jumped);
	free(most);
	free_rationals(x, e->size);
	free_rationals(t, 1);
	equations_free(e);
}

int main(int argc, char **argv)
{
	for (int i = 0; i < MODELS && argc == 3; i++)
		if (strcmp(emitted[i].model->name, argv[1]) == 0)
			model = emitted[i].model;
	if (!model) {
		fprintf(stderr, "usage: history MODEL SOLUTION.csv\n");
		return 2;
	}
	outputs = model->outputs;
	largest = need((size_t)outputs * sizeof *largest);
	state = need(model->size);
	if (ok(read_solution(argv[2]), "%s: the solution names t and the outputs, and every line is full",
			model->name)) {
		double *stepped = by_step(), *run = by_run();
		run_as_step(stepped, run);
		one_by_run();
		run_blind(run);
		by_jump();
		step_after_jump();
		far_jump();
		free(stepped);
		free(run);
	}
	free(solution);
	free(times);
	free(largest);
	free(state);
	return tap_end();
}
