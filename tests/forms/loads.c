/* SPDX-License-Identifier: GPL-3.0-or-later */
/* loads FOLDER: models with loads, in double and in float, beside FOLDER/NAME.csv, their closed form at every step.
 *
 * Over 1000 steps every output stays within 1e-12, in float 2e-4, of its largest value; so it does after a jump to the
 * end, after NAME_at to the end of a step. From a state set on the way, itself rounded, it stays as near to the largest
 * number of all. Where outputs are states, nothing is further off than what plgen states, and what is set is read
 * again. NAME_at(0) is NAME_get, bit for bit. */
#include "plrt.h"
#include "tap.h"

#include "load_models.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 1000, MIDDLE = 400, COLUMNS = 32 };

static double truth[STEPS + 1][COLUMNS], later[STEPS + 1][COLUMNS], largest[COLUMNS];

/* Rows t,x1,...; false: no such file, or not so many rows */
static bool read_truth(const char *folder, const char *name, int columns)
{
	char line[4096];
	int row = -1;
	FILE *from;
	snprintf(line, sizeof line, "%s/%s.csv", folder, name);
	from = fopen(line, "r");
	if (!from)
		return false;
	memset(largest, 0, sizeof largest);
	while (fgets(line, sizeof line, from) && row <= STEPS) {
		char *at = line;
		int i;
		for (i = -1; i < columns && row >= 0; i++, at++) {
			const double value = strtod(at, &at);
			if (i < 0)
				continue;
			truth[row][i] = value;
			largest[i] = fmax(largest[i], fabs(value));
		}
		row++;
	}
	fclose(from);
	return row == STEPS + 1;
}

struct worst {
	double off;
	int which, row;
};

/* What never gets above `least` is too small for the type. */
static void compare(const double *y, int row, int columns, double least, struct worst *worst)
{
	int i;
	for (i = 0; i < columns; i++) {
        const double off = largest[i] > least ? fabs(y[i] - truth[row][i]) / largest[i] : fabs(y[i]) <= 2 * least ? 0
			: INFINITY;
		if (!(off <= worst->off)) {
			worst->off = off;
			worst->which = i;
			worst->row = row;
		}
	}
}

static void judge(const char *name, const char *what, struct worst worst, double bound)
{
    ok(worst.off <= bound, "%s, %s: number %d off by %.2g of its largest value at step %d, at most %.2g", name, what,
		worst.which + 1, worst.off, worst.row, bound);
}

/* A model of either type, its numbers as doubles */
struct subject {
	const pl_model *model;
	const pl_modelf *modelf;
	void *s;
};

static void init(struct subject *m)
{
	m->model ? m->model->init(m->s) : m->modelf->init(m->s);
}

static void step(struct subject *m)
{
	static const double u[4];
	static const float uf[4];
	m->model ? m->model->step(m->s, u) : m->modelf->step(m->s, uf);
}

static void widen(double *y, const float *yf, int count)
{
	int i;
	for (i = 0; i < count; i++)
		y[i] = (double)yf[i];
}

static void out(const struct subject *m, double *y)
{
	float yf[COLUMNS];
	if (m->model) {
		m->model->out(m->s, y);
	} else {
		m->modelf->out(m->s, yf);
		widen(y, yf, m->modelf->outputs);
	}
}

static void get(const struct subject *m, double *y)
{
	float yf[COLUMNS];
	if (m->model) {
		m->model->get(m->s, y);
	} else {
		m->modelf->get(m->s, yf);
		widen(y, yf, m->modelf->states);
	}
}

static void set(struct subject *m, double t, const double *y)
{
	float yf[COLUMNS];
	int i;
	if (m->model) {
		m->model->set(m->s, t, y);
		return;
	}
	for (i = 0; i < m->modelf->states; i++)
		yf[i] = (float)y[i];
	m->modelf->set(m->s, (float)t, yf);
}

static bool at_part(const struct subject *m, int part, double *y)
{
	static const double u[4];
	static const float uf[4];
	float yf[COLUMNS];
	if (m->model ? !m->model->at : !m->modelf->at)
		return false;
	if (m->model) {
		m->model->at(m->s, u, part * m->model->h, y);
	} else {
		m->modelf->at(m->s, uf, (float)part * m->modelf->h, yf);
		widen(y, yf, m->modelf->states);
	}
	return true;
}

static bool jump(struct subject *m, int steps)
{
	if (m->model ? !m->model->jump : !m->modelf->jump)
		return false;
	m->model ? m->model->jump(m->s, (uint64_t)steps) : m->modelf->jump(m->s, (uint64_t)steps);
	return true;
}

/* What an ulp of the time that is set makes: of cos(w t) w t ulp */
static void run_later(struct subject *m, double t, const double *y)
{
	int k;
	set(m, nextafter(t, INFINITY), y);
	for (k = MIDDLE; k < STEPS; k++) {
		step(m);
		out(m, later[k + 1]);
	}
}

static void run(struct subject *m, double stated)
{
	const int states = m->model ? m->model->states : m->modelf->states,
		outputs = m->model ? m->model->outputs : m->modelf->outputs;
	const char *name = m->model ? m->model->name : m->modelf->name;
	const double limit = m->model ? 1e-12 : 2e-4, unit = m->model ? 0x1p-53 : 0x1p-24,
		least = m->model ? 1e-300 : 1e-30, h = m->model ? m->model->h : (double)m->modelf->h;
	double y[COLUMNS], now[COLUMNS], again[COLUMNS], scale = 0, off = 0;
	struct worst steps = {0, 0, 0}, jumped = steps, reached = steps;
	int k, i, wrong = 0, apart = 0;
	const int whole = outputs == states;
	init(m);
	for (k = 0; k < STEPS; k++) {
		get(m, now);
		if (k % 10 < 2 && at_part(m, 0, y))
			apart += memcmp(y, now, (size_t)states * sizeof *y) != 0;
        if (whole && (k % 100 == 7 || k % 100 == 0) && at_part(m, 1, y)) /* loads change from step 300, 400, 500 on */
			compare(y, k + 1, states, least, &reached);
		step(m);
		out(m, y);
		compare(y, k + 1, outputs, least, &steps);
		if (k + 1 == MIDDLE)
			get(m, again);
	}
	judge(name, "steps", steps, limit);
	if (whole)
		judge(name, "steps as stated", steps, stated);
	judge(name, "at", reached, limit);
	ok(apart == 0, "%s: at 0 after now it is now, but for %d of %d times", name, apart, STEPS / 5);
	if (m->model) { /* a float holds neither the time nor the state well enough to go on as before */
		run_later(m, MIDDLE * h, again);
		set(m, MIDDLE * h, again);
		get(m, y);
		for (i = 0; i < states; i++)
			wrong += !(fabs(y[i] - again[i]) <= 2 * unit * fabs(again[i]));
		ok(wrong == 0, "%s: what is set is read again", name);
		for (i = 0; i < COLUMNS; i++)
			scale = fmax(scale, i < outputs ? largest[i] : 0);
		for (k = MIDDLE; k < STEPS; k++) {
			step(m);
			out(m, y);
			for (i = 0; i < outputs; i++)
                off = worse(off, (fabs(y[i] - truth[k + 1][i]) - 2 * fabs(y[i] - later[k + 1][i])) / scale);
		}
        ok(off <= limit, "%s, from a state set: off by %.2g of the largest number of all, but for rounding of its "
			"time, at most %.2g", name, off, limit);
	}
	init(m);
	if (jump(m, STEPS)) {
		out(m, y);
		compare(y, STEPS, outputs, least, &jumped);
		judge(name, "jump", jumped, limit);
	}
}

int main(int argc, char **argv)
{
	const int count = (int)(sizeof load_models / sizeof *load_models);
	int i;
	for (i = 0; i < count && argc > 1; i++) {
		const struct load_model *m = &load_models[i];
		struct subject wide = {m->model, NULL, malloc(m->model->size)},
			narrow = {NULL, m->modelf, malloc(m->modelf->size)};
		if (ok(read_truth(argv[1], m->name, m->model->outputs), "%s: its closed form", m->name)) {
			run(&wide, m->bound);
			run(&narrow, m->boundf);
		}
		free(wide.s);
		free(narrow.s);
	}
	return tap_end();
}
