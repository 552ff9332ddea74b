/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sweeps MODEL UP A TOLERANCE CSV: what --response --amplitude A tells of a model with clearances, by another road. The
 * equations stand here again; the classical Runge-Kutta method takes them over hundreds of periods at each frequency of
 * the CSV, from what it came to at the one before by way of nine between them, up and then down. A step in which a
 * contact begins or ends is cut there by bisection. Each harmonic is a sum over samples that cut the period evenly. Up
 * and down must differ at UP frequencies at least, by half of the larger. */
#include "../emitted/tap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STATES = 4, COLUMNS = 4, ROWS = 64, PERIODS = 150, SAMPLES = 600, BETWEEN = 10 };

/* ---- the equations ---- */

struct motion { double w, a; };

static double drive(const struct motion *m, double t) { return m->a * cos(m->w * t); }
static double drive_rate(const struct motion *m, double t) { return -m->a * m->w * sin(m->w * t); }

/* In contact as the flags say, bit by bit */
static void gear_slope(const struct motion *m, unsigned on, double t, const double *y, double *slope)
{
	double force = (on & 1 ? y[0] - 1 : 0) + (on & 2 ? y[0] + 1 : 0);
	slope[0] = y[1];
	slope[1] = 0.1 + 0.05 * drive(m, t) - 0.1 * y[1] - force;
}

static void gear_gap(const double *y, double t, const struct motion *m, double *gap)
{
	(void)t;
	(void)m;
	gap[0] = y[0] - 1;
	gap[1] = -1 - y[0];
}

static void two_slope(const struct motion *m, unsigned on, double t, const double *y, double *slope)
{
	double u = drive(m, t), v = drive_rate(m, t);
	slope[0] = y[1];
	slope[1] = 4 * (u - y[0]) + 0.2 * (v - y[1]) - (on & 1 ? 40 * (y[0] - 0.5) + 0.6 * y[1] : 0);
	slope[2] = y[3];
	slope[3] = -9 * y[2] - 0.3 * y[3] + u - (on & 2 ? 20 * (y[2] - u - 0.1) : 0);
}

static void two_gap(const double *y, double t, const struct motion *m, double *gap)
{
	gap[0] = y[0] - 0.5;
	gap[1] = y[2] - drive(m, t) - 0.1;
}

/* A damper of 2 where x rises, of 5 where it falls */
static void rates_slope(const struct motion *m, unsigned on, double t, const double *y, double *slope)
{
	slope[0] = y[1];
	slope[1] = drive(m, t) - (on & 1 ? 2 : 5) * y[1] - 9.81 * y[0];
}

static void rates_gap(const double *y, double t, const struct motion *m, double *gap)
{
	(void)t;
	(void)m;
	gap[0] = y[1];
	gap[1] = -1;
}

static double gear_output(int k, const double *y, double t, const struct motion *m)
{
	(void)t;
	(void)m;
	return y[k];
}

static double two_output(int k, const double *y, double t, const struct motion *m)
{
	return k == 0 ? y[0] : k == 1 ? y[2] - y[0] : drive(m, t) + 2 * y[1] + drive_rate(m, t);
}

static const struct truth {
	const char *name;
	int states, columns;
	void (*slope)(const struct motion *m, unsigned on, double t, const double *y, double *slope);
	void (*gap)(const double *y, double t, const struct motion *m, double *gap);    /* two of them */
	double (*output)(int k, const double *y, double t, const struct motion *m);
	double start;
} truths[] = {
	{ "gear", 2, 2, gear_slope, gear_gap, gear_output, 1.1 },
	{ "two", 4, 3, two_slope, two_gap, two_output, 0 },
	{ "rates", 2, 2, rates_slope, rates_gap, gear_output, 0 },
};
static const struct truth *truth;

/* ---- their motion ---- */

static void runge_kutta(const struct motion *m, unsigned on, double t, double h, const double *y, double *to)
{
	double k[4][STATES], at[STATES];
	for (int s = 0; s < 4; s++) {
		double by = s == 0 ? 0 : s == 3 ? h : h / 2;
		for (int i = 0; i < truth->states; i++)
			at[i] = y[i] + (s ? by * k[s - 1][i] : 0);
		truth->slope(m, on, t + by, at, k[s]);
	}
	for (int i = 0; i < truth->states; i++)
		to[i] = y[i] + h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
}

static unsigned contacts(const struct motion *m, double t, const double *y)
{
	double gap[2];
	truth->gap(y, t, m, gap);
	return (gap[0] > 0 ? 1u : 0) | (gap[1] > 0 ? 2u : 0);
}

static void advance(const struct motion *m, double t, double h, double *y)
{
	double to[STATES];
	for (int cut = 0; cut < 20 && h > 0; cut++) {
		unsigned on = contacts(m, t, y);
		double low = 0, high = h;
		runge_kutta(m, on, t, h, y, to);
		if (contacts(m, t + h, to) != on) {
			for (int k = 0; k < 60; k++) {
				double middle = (low + high) / 2;
				runge_kutta(m, on, t, middle, y, to);
				*(contacts(m, t + middle, to) == on ? &low : &high) = middle;
			}
			runge_kutta(m, on, t, high, y, to);
		}
		memcpy(y, to, sizeof to);
		t += high;
		h -= high;
	}
}

/* The state after so many periods; the harmonics of the last, over a */
static void sweep_on(const struct motion *m, int periods, double *y, double (*harmonic)[2])
{
	double period = 2 * acos(-1) / m->w, h = period / SAMPLES;
	memset(harmonic, 0, COLUMNS * sizeof *harmonic);
	for (int p = 0; p < periods; p++)
		for (int k = 0; k < SAMPLES; k++) {
			for (int i = 0; i < truth->columns && p == periods - 1; i++) {
				double value = truth->output(i, y, k * h, m) * 2 / (SAMPLES * m->a);
				harmonic[i][0] += value * cos(m->w * k * h);
				harmonic[i][1] -= value * sin(m->w * k * h);
			}
			advance(m, k * h, h, y);
		}
}

/* ---- against the table ---- */

static double table[ROWS][1 + 4 * COLUMNS];

static int read_table(const char *path)
{
	FILE *f = fopen(path, "r");
	char line[4096];
	int rows = 0;
	if (!f || !fgets(line, sizeof line, f))
		exit(99);
	while (rows < ROWS && fgets(line, sizeof line, f)) {
		char *at = line;
		for (int k = 0; k < 1 + 4 * truth->columns; k++, at++)
			table[rows][k] = strtod(at, &at);
		rows++;
	}
	fclose(f);
	return rows;
}

/* Of one direction: the largest difference, as a part of the size */
static double difference(int row, int down, double (*harmonic)[2])
{
	double worst = 0;
	for (int i = 0; i < truth->columns; i++) {
		const double *cell = &table[row][1 + 4 * i + 2 * down];
		double angle = cell[1] * acos(-1) / 180;
		double off = hypot(cell[0] * cos(angle) - harmonic[i][0], cell[0] * sin(angle) - harmonic[i][1]);
		worst = worse(worst, off / hypot(harmonic[i][0], harmonic[i][1]));
	}
	return worst;
}

int main(int argc, char **argv)
{
	double y[STATES] = { 0 }, harmonic[COLUMNS][2], worst = 0, at = 0, before = 0;
	if (argc != 6)
		return 99;
	for (size_t i = 0; i < sizeof truths / sizeof *truths; i++)
		if (strcmp(truths[i].name, argv[1]) == 0)
			truth = &truths[i];
	if (!truth)
		return 99;
	int rows = read_table(argv[5]), apart = 0;
	y[0] = truth->start;
	for (int k = 0; k < 2 * rows; k++) {
		int down = k >= rows, row = down ? 2 * rows - 1 - k : k;
		struct motion m = { 2 * acos(-1) * table[row][0], atof(argv[3]) };
		for (int between = 1; k > 0 && between < BETWEEN; between++) {
			struct motion slow = { m.w * pow(before / m.w, 1 - between / (double)BETWEEN), m.a };
			sweep_on(&slow, PERIODS / BETWEEN, y, harmonic);
		}
		before = m.w;
		sweep_on(&m, PERIODS, y, harmonic);
		double off = difference(row, down, harmonic);
		at = worse(worst, off) != worst ? table[row][0] : at;
		worst = worse(worst, off);
	}
	for (int row = 0; row < rows; row++)
		apart += fabs(table[row][1] - table[row][3]) > 0.5 * fmax(table[row][1], table[row][3]);
	ok(rows > 9, "%s: %d frequencies", argv[1], rows);
	ok(close_to(worst, 0, atof(argv[4]), "of a harmonic, at %g Hz", at), "%s: harmonics within %s", argv[1],
			argv[4]);
	ok(apart >= atoi(argv[2]), "%s: up and down differ at %d frequencies, at least %s", argv[1], apart, argv[2]);
	return tap_end();
}
