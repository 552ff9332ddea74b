/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * frame VARIANTS OUTDIR
 *
 * A building of three storeys (models/frame.spec) under 20 s of a record with 50 samples a second, straight between
 * them: the largest error of the roof over its largest displacement, for the time integrators of structural dynamics
 * and for plgen's step, at the record's own step, a half and a quarter of it (frame.csv; frame_history.csv for the
 * picture; the record: frame_record.csv). VARIANTS has frame-1.so, frame-2.so, frame-4.so: steps of 1/50, 1/100 and
 * 1/200 s.
 *
 * What is true: e^{A h} and the response to a ramp in 33 digits, sample by sample; the other road is RK4 with 1/256 of
 * the record's step.
 */
#include "amplification.h"
#include "quad.h"
#include "record.h"

#include <math.h>
#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = RECORD_SAMPLES, STOREYS = 3, SIZE = 2 * STOREYS, ROOF = 2 };
static const double sample_time = RECORD_STEP;

/* ---- the building ---- */

typedef void rhs_function(double t, const double y[], const double u[], double dydt[]);
struct building {
	double A[SIZE * SIZE], b[SIZE];                 /* y' = A y + b ground */
	double sample[SAMPLES];
};

static double ground_at(const struct building *b, double t)
{
	const double share = t / sample_time;
	const int k = share >= SAMPLES - 1 ? SAMPLES - 2 : (int)share;
	return b->sample[k] + (share - k) * (b->sample[k + 1] - b->sample[k]);
}

static void slope(const void *of, double t, const double y[], double dydt[])
{
	const struct building *b = of;
	const double ground = ground_at(b, t);
	for (int i = 0; i < SIZE; i++) {
		double sum = b->b[i] * ground;
		for (int j = 0; j < SIZE; j++)
			sum += b->A[i * SIZE + j] * y[j];
		dydt[i] = sum;
	}
}

/* The equations as plgen's user wrote them, asked at unit states and a unit input */
static void ask(struct building *b, const char *folder)
{
	rhs_function *rhs;
	void *symbol = variant_symbol(folder, "frame-1", "subject_rhs");
	memcpy(&rhs, &symbol, sizeof rhs);
	for (int j = 0; j <= SIZE; j++) {
		double y[SIZE] = {0}, u[2] = {j == SIZE, 0}, column[SIZE];
		if (j < SIZE)
			y[j] = 1;
		rhs(0, y, u, column);
		for (int i = 0; i < SIZE; i++)
			*(j < SIZE ? &b->A[i * SIZE + j] : &b->b[i]) = column[i];
	}
}

/* ---- what is true ---- */

enum { MOST = SIZE + 2 };

/* Of states, the ground and its slope */
static void flow(const struct building *b, quad h, quad *E)
{
	quad B[MOST * MOST] = {0};
	for (int i = 0; i < SIZE; i++) {
		for (int j = 0; j < SIZE; j++)
			B[i * MOST + j] = b->A[i * SIZE + j];
		B[i * MOST + SIZE] = b->b[i];
	}
	B[SIZE * MOST + SIZE + 1] = 1;
	quad_exponential(MOST, B, h, E);
}

/* roof: `parts` a sample, from t = 0 on */
static void truth_of_roof(const struct building *b, int parts, double *roof)
{
	const quad h = 0.02Q / parts;
	quad E[MOST * MOST], x[MOST] = {0}, next[MOST];
	flow(b, h, E);
	roof[0] = 0;
	for (int k = 0; k < (SAMPLES - 1) * parts; k++) {
		const int s = k / parts, i = k % parts;
		const quad rise = (quad)b->sample[s + 1] - b->sample[s];
		x[SIZE] = b->sample[s] + rise * i / parts;
		x[SIZE + 1] = rise / 0.02Q;
		for (int r = 0; r < MOST; r++) {
			next[r] = 0;
			for (int c = 0; c < MOST; c++)
				next[r] += E[r * MOST + c] * x[c];
		}
		memcpy(x, next, sizeof x);
		roof[k + 1] = (double)x[ROOF];
	}
}

/* ---- the runs ---- */

/* An output at each step of `parts` a sample; inner: steps of the method in each of these */
static void peer(const struct method *m, const struct building *b, int parts, int inner, double *roof)
{
	double A[SIZE * SIZE], none[SIZE] = {0};
	const double start[SIZE] = {0};
	memcpy(A, b->A, sizeof A);
	const struct problem p = {.name = "frame", .n = STOREYS, .rhs_of = slope, .of = b, .start = start,
	                          .unit = sample_time / parts, .units = (SAMPLES - 1) * parts, .linear = true, .w = 1,
	                          .A = A, .b0 = none, .b1 = none, .b2 = none};      /* w: its load changes */
	struct run *run = m->open(m, &p, p.unit / inner);
	double *rows = history_rows(run, p.units);
	roof[0] = 0;
	for (int k = 0; k < p.units; k++)
		roof[k + 1] = rows[k * SIZE + ROOF];
	run->close(run);
	free(rows);
}

static void ours(const char *folder, const struct building *b, int parts, double *roof)
{
	const pl_model *model = variant_model(folder, text("frame-%d", parts));
	void *state = calloc(1, model->size);
	double y[SIZE];
	model->init(state);
	model->hold(state, b->sample);
	roof[0] = 0;
	for (int k = 0; k < (SAMPLES - 1) * parts; k++) {
		const int s = (k + 1) / parts, i = (k + 1) % parts;
		const double *from = b->sample + s, ground = i ? from[0] + i * (from[1] - from[0]) / parts : from[0];
		model->step(state, &ground);
		model->get(state, y);
		roof[k + 1] = y[ROOF];
	}
	free(state);
}

static double largest_of(int count, const double *x, const double *than)
{
	double most = 0;
	for (int i = 0; i < count; i++)
		most = fmax(most, fabs(x[i] - (than ? than[i] : 0)));
	return most;
}

/* ---- the tables ---- */

static const struct { const char *name, *work; } charted[] = {
	{"central difference", "1 evaluation, 1 solution of 3 equations"},
	{"Newmark", "1 evaluation, 1 solution of 3 equations"},
	{"generalized-alpha", "1 evaluation, 1 solution of 3 equations"},
	{"HHT-alpha", "1 evaluation, 1 solution of 3 equations"},
	{"Bathe", "2 evaluations, 2 solutions of 3 equations"},
	{"rho-Bathe 0.5", "2 evaluations, 2 solutions of 3 equations"},
	{"CR", "1 evaluation, products with 4 matrices 3 x 3"},
	{"KR-alpha 0.5", "1 evaluation, products with 4 matrices 3 x 3"},
	{"exact", "1 product, 6 x 8 (6 states, 2 samples)"},
};
enum { CHARTED = sizeof charted / sizeof *charted };

/* From 8 to 12 s, which the picture shows */
static void put_history(FILE *csv, const char *name, const double *roof)
{
	for (int k = (int)lround(8 / sample_time); k <= (int)lround(12 / sample_time); k++)
		fprintf(csv, "%s,%.2f,%.6g\n", name, k * sample_time, 1000 * roof[k]);
}

static void chart(const char *variants, const char *folder, const struct building *b)
{
	FILE *csv = table_open(folder, "frame.csv",
	                       "method,h_s,roof_error_over_peak,order_since_last,peak_mm,truth_agreement,"
	                       "work_of_a_step");
	FILE *history = table_open(folder, "frame_history.csv", "method,t_s,roof_mm");
	static double truth[3][4 * SAMPLES], roof[4 * SAMPLES];
	double agreement[3];
	for (int i = 0; i < 3; i++) {
		const int parts = 1 << i, count = (SAMPLES - 1) * parts + 1;
		truth_of_roof(b, parts, truth[i]);
		peer(method_find("RK4"), b, parts, 256 / parts, roof);
		agreement[i] = largest_of(count, roof, truth[i]) / largest_of(count, truth[i], NULL);
	}
	for (int m = 0; m < CHARTED; m++) {
		const struct method *method = method_find(charted[m].name);
		double before = NAN;
		for (int i = 0; i < 3; i++) {
			const int parts = 1 << i, count = (SAMPLES - 1) * parts + 1;
			const double peak = largest_of(count, truth[i], NULL);
			if (method)
				peer(method, b, parts, 1, roof);
			else
				ours(variants, b, parts, roof);
			const double error = largest_of(count, roof, truth[i]) / peak;
			fprintf(csv, "%s,%g,%.4g,", charted[m].name, sample_time / parts, error);
			if (i > 0 && method)
				fprintf(csv, "%.3g", log2(before / error));
			fprintf(csv, ",%.5g,%.2g,\"%s\"\n", 1000 * peak, agreement[i], charted[m].work);
			if (i == 0 && (!method || strcmp(charted[m].name, "Newmark") == 0))
				put_history(history, charted[m].name, roof);
			before = error;
		}
	}
	table_close(csv, "frame.csv");
	table_close(history, "frame_history.csv");
}

int main(int argc, char **argv)
{
	static struct building b;
	(void)flags_of(argc, &argv, "", 2, 2, "frame VARIANTS OUTDIR");
	ask(&b, argv[0]);
	record_of_quake(b.sample);
	FILE *csv = table_open(argv[1], "frame_record.csv", "quake_m_per_s2_each_0.02_s");
	for (int k = 0; k < SAMPLES; k++)
		fprintf(csv, "%g\n", b.sample[k]);
	table_close(csv, "frame_record.csv");
	say_progress("frame: three storeys under a record");
	chart(argv[0], argv[1], &b);
	return 0;
}
