/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sampled inputs, held and as ramps, over 10,000 random samples against a recurrence with e^{A h} of the augmented
 * matrix to 300 bits.
 *
 *     linear_inputs                       the tests
 *     linear_inputs samples N             N random samples as CSV
 *     linear_inputs expected MODEL N      what the driver should write for them
 */
#include "equations.h"
#include "reference.h"
#include "tap.h"

#include "first2_pl.h"
#include "held2_pl.h"
#include "ramped2_pl.h"
#include "switched_pl.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 10000, SIZE = 8, OUTPUTS = 5, SKIP = 1234 };

static const double tolerance = 1e-12;

static void hold_held(void *s, const double *u)
{
	(void)s;
	(void)u;
}

static void hold_ramped(void *s, const double *u)
{
	ramped2_hold((ramped2 *)s, u);
}

static void hold_first(void *s, const double *u)
{
	first2_hold((first2 *)s, u);
}

static const struct subject {
	const pl_model *model;
	void (*hold)(void *s, const double *u);
	bool ramp[2];
	const double *Gamma;
} subjects[] = {
	{&held2_model, hold_held, {false, false}, held2_Gamma[0]},
	{&ramped2_model, hold_ramped, {true, false}, ramped2_Gamma[0]},
	{&first2_model, hold_first, {true, true}, first2_Gamma[0]}};

static double random_sample(void)
{
	static unsigned long long seed = 20240611;
	seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
	return (double)(seed >> 11) * 0x1p-52 - 1;
}

static double (*random_samples(void))[2]
{
	static double u[SAMPLES][2];
	for (int k = 0; k < SAMPLES; k++)
		for (int i = 0; i < 2; i++)
			u[k][i] = (i ? 3 : 1) * random_sample();
	return u;
}

/* The inputs of x at the start of a step: held, or from the sample before to u. */
static void set_inputs(const struct subject *s, const double *before, const double *u, mpfr_t *x)
{
	for (int i = 0; i < 2; i++) {
		mpfr_set_d(x[4 + i], s->ramp[i] ? before[i] : u[i], MPFR_RNDN);
		mpfr_set_zero(x[6 + i], 1);
		if (s->ramp[i]) {
			mpfr_set_d(x[6 + i], u[i], MPFR_RNDN);
			mpfr_sub(x[6 + i], x[6 + i], x[4 + i], MPFR_RNDN);
			mpfr_mul_ui(x[6 + i], x[6 + i], 50, MPFR_RNDN);
		}
	}
}

/* x, y, x'', y'', x' + 2 u - 0.5 v */
static void outputs_of(const struct reference *r, mpfr_t *x, double *out)
{
	mpfr_t a;
	mpfr_init2(a, REFERENCE_PRECISION);
	out[0] = mpfr_get_d(x[0], MPFR_RNDN);
	out[1] = mpfr_get_d(x[1], MPFR_RNDN);
	for (int i = 0; i < 2; i++) {
		reference_row(r, 0, 2 + i, x, a);
		out[2 + i] = mpfr_get_d(a, MPFR_RNDN);
	}
	mpfr_div_si(a, x[5], -4, MPFR_RNDN);
	mpfr_add(a, a, x[4], MPFR_RNDN);
	mpfr_mul_ui(a, a, 2, MPFR_RNDN);
	mpfr_add(a, a, x[2], MPFR_RNDN);
	out[4] = mpfr_get_d(a, MPFR_RNDN);
	mpfr_clear(a);
}

struct run {
	double (*y)[4], (*out)[OUTPUTS];
	double most_y[4], most_out[OUTPUTS];
};

static struct run referred(const struct subject *s, const struct reference *r, double (*u)[2])
{
	struct run run = {malloc((SAMPLES + 1) * sizeof *run.y), malloc((SAMPLES + 1) * sizeof *run.out), {0}, {0}};
	static const double none[2], start[4] = {0.1, 0, 0, -0.2};
	mpfr_t *x = new_floats(SIZE), *E = new_floats(SIZE * SIZE);
	mpq_t *h = new_rationals(1);
	mpq_set_ui(h[0], 1, 50);
	reference_matrix(r, 0, h[0], E);
	reference_start(r, h[0], start, x);
	for (int k = 0; k <= SAMPLES; k++) {
		for (int i = 0; i < 4; i++) {
			run.y[k][i] = mpfr_get_d(x[i], MPFR_RNDN);
			run.most_y[i] = fmax(run.most_y[i], fabs(run.y[k][i]));
		}
		outputs_of(r, x, run.out[k]);
		for (int i = 0; i < OUTPUTS; i++)
			run.most_out[i] = worse(run.most_out[i], fabs(run.out[k][i]));
		if (k < SAMPLES) {
			set_inputs(s, k ? u[k - 1] : none, u[k], x);
			reference_apply(r, E, x);
		}
	}
	free_rationals(h, 1);
	free_floats(x, SIZE);
	free_floats(E, SIZE * SIZE);
	return run;
}

static bool near(const double *found, const double *expected, const double *most, int n, double *worst,
	const char *what, int k)
{
	bool good = true;
	for (int i = 0; i < n; i++) {
		good = close_to(found[i], expected[i], tolerance * most[i], "%s %d, %d", what, k, i) && good;
		*worst = fmax(*worst, fabs(found[i] - expected[i]) / most[i]);
	}
	return good;
}

static void by_step_and_run(const struct subject *s, const struct run *run, double (*u)[2])
{
	const pl_model *m = s->model;
	void *state = calloc(1, m->size);
	double y[4], out[OUTPUTS], worst = 0;
	bool good = true;
	m->init(state);
	for (int k = 0; k <= SAMPLES; k++) {
		m->get(state, y);
		m->out(state, out);
		good = near(y, run->y[k], run->most_y, 4, &worst, "state", k) && good;
		good = near(out, run->out[k], run->most_out, OUTPUTS, &worst, "output", k) && good;
		if (k < SAMPLES)
			m->step(state, u[k]);
	}
	ok(good, "%s: states and outputs of %d random samples by step, within %g", m->name, SAMPLES, tolerance);
	note("%s by step: largest difference %.3g", m->name, worst);
	double (*rows)[OUTPUTS] = malloc(SAMPLES * sizeof *rows);
	worst = 0;
	good = true;
	m->init(state);
	m->run(state, 7, u[0], NULL);
	m->run(state, SAMPLES - 7, u[7], rows[7]);
	for (int k = 7; k < SAMPLES; k++)
		good = near(rows[k], run->out[k + 1], run->most_out, OUTPUTS, &worst, "run", k) && good;
	ok(good, "%s: the same by run, in parts, within %g", m->name, tolerance);
	ok(m->jump == NULL, "%s: there is no jump", m->name);
	free(rows);
	free(state);
}

/* hold, and set keeping the sample: from the middle of the run on */
static void held_sample(const struct subject *s, const struct run *run, double (*u)[2])
{
	const pl_model *m = s->model;
	void *state = calloc(1, m->size);
	double y[4], worst = 0;
	m->init(state);
	m->set(state, SKIP * m->h, run->y[SKIP]);
	s->hold(state, u[SKIP - 1]);
	m->step(state, u[SKIP]);
	m->get(state, y);
	ok(near(y, run->y[SKIP + 1], run->most_y, 4, &worst, "hold", SKIP), "%s: set, hold, step", m->name);
	m->init(state);
	m->step(state, u[SKIP - 1]);
	m->set(state, SKIP * m->h, run->y[SKIP]);
	m->step(state, u[SKIP]);
	m->get(state, y);
	ok(near(y, run->y[SKIP + 1], run->most_y, 4, &worst, "set", SKIP), "%s: set keeps the sample before", m->name);
	m->init(state);
	m->step(state, u[0]);
	m->init(state);
	m->step(state, u[0]);
	m->get(state, y);
	ok(near(y, run->y[1], run->most_y, 4, &worst, "init", 1), "%s: init makes the sample before 0", m->name);
	free(state);
}

static void between(const struct subject *s, const struct reference *r, const struct run *run, double (*u)[2])
{
	const pl_model *m = s->model;
	void *state = calloc(1, m->size), *before = calloc(1, m->size);
	mpfr_t *x = new_floats(SIZE), *E = new_floats(SIZE * SIZE);
	mpq_t *t = new_rationals(2);
	double found[4], expected[4], worst = 0;
	bool good = m->at != NULL;
	static const double none[2];
	m->init(state);
	for (int k = 0; k < 200 && good; k++) {
		const double tau = k % 5 == 4 ? m->h : m->h * (k % 5) / 4;
		m->get(state, found);
		mpq_set_d(t[1], tau);
		reference_start(r, t[0], found, x);
		set_inputs(s, k ? u[k - 1] : none, u[k], x);
		reference_matrix(r, 0, t[1], E);
		reference_apply(r, E, x);
		for (int i = 0; i < 4; i++)
			expected[i] = mpfr_get_d(x[i], MPFR_RNDN);
		memcpy(before, state, m->size);
		m->at(state, u[k], tau, found);
		good = memcmp(before, state, m->size) == 0 && good;
		/* the states of this run are those of the reference but for rounding: 16 eps of the largest value is
		 * generous here */
		for (int i = 0; i < 4; i++) {
			good = close_to(found[i], expected[i], 16 * DBL_EPSILON * run->most_y[i], "at %d, %d", k, i) &&
					good;
			worst = worse(worst, fabs(found[i] - expected[i]) / (DBL_EPSILON * run->most_y[i]));
		}
		m->step(state, u[k]);
	}
	ok(good, "%s: at between samples, within 16 eps of the largest value, changing nothing", m->name);
	note("%s, at: largest difference %.3g eps", m->name, worst);
	free_rationals(t, 2);
	free_floats(x, SIZE);
	free_floats(E, SIZE * SIZE);
	free(state);
	free(before);
}

/* Column of a held input: that of u in e^{A h}; of a ramp: u - slope/h before, slope/h after.  Bit for bit. */
static void by_gamma(const struct subject *s, const struct reference *r)
{
	mpfr_t *E = new_floats(SIZE * SIZE), g;
	mpq_t *h = new_rationals(1);
	const int columns = 2 + s->ramp[0] + s->ramp[1];
	bool good = true;
	mpfr_init2(g, REFERENCE_PRECISION);
	mpq_set_ui(h[0], 1, 50);
	reference_matrix(r, 0, h[0], E);
	for (int i = 0; i < 4; i++)
		for (int j = 0, c = 0; j < 2; j++)
			for (int after = 0; after <= s->ramp[j]; after++, c++) {
				mpfr_mul_ui(g, E[i * SIZE + 6 + j], 50, MPFR_RNDN);
				if (!s->ramp[j])
					mpfr_set(g, E[i * SIZE + 4 + j], MPFR_RNDN);
				else if (!after)
					mpfr_sub(g, E[i * SIZE + 4 + j], g, MPFR_RNDN);
				good = close_to(s->Gamma[i * columns + c], mpfr_get_d(g, MPFR_RNDN), 0, "Gamma %d, %d",
						i, c) && good;
			}
	ok(good, "%s: Gamma, bit for bit", s->model->name);
	free_rationals(h, 1);
	mpfr_clear(g);
	free_floats(E, SIZE * SIZE);
}

/* By printf and strtod: 15 digits are never too many */
static void print_shortest(double value, const char *before)
{
	char text[40];
	int digits = 15;
	do
		snprintf(text, sizeof text, "%.*g", digits, value);
	while (strtod(text, NULL) != value && digits++ < 17);
	printf("%s%s", before, text);
}

/* Blocks of rows, bit for bit: from one state, one sample or one sample before that is 1, all else 0, every number of a
 * row is what its table has. */
enum { ROWS = 8, ONES = 4 + 2 + 2 * ROWS };

static void start_one(const struct subject *s, const struct reference *r, int one, void *state, double (*u)[2],
	mpfr_t *x)
{
	double y[4] = {0}, before[2] = {0};
	mpq_t *t = new_rationals(1);
	memset(u, 0, ROWS * sizeof *u);
	if (one < 4)
		y[one] = 1;
	else if (one < 6)
		before[one - 4] = 1;
	else
		u[(one - 6) / 2][one % 2] = 1;
	s->model->init(state);
	s->model->set(state, 0, y);
	s->hold(state, before);
	reference_start(r, t[0], y, x);
	set_inputs(s, before, u[0], x);
	free_rationals(t, 1);
}

static void by_rows(const struct subject *s, const struct reference *r)
{
	void *state = calloc(1, s->model->size);
	mpfr_t *x = new_floats(SIZE), *E = new_floats(SIZE * SIZE);
	mpq_t *h = new_rationals(1);
	double u[ROWS][2], rows[ROWS][OUTPUTS], expected[OUTPUTS];
	bool good = true;
	mpq_set_ui(h[0], 1, 50);
	reference_matrix(r, 0, h[0], E);
	for (int one = 0; one < ONES; one++) {
		start_one(s, r, one, state, u, x);
		s->model->run(state, ROWS, u[0], rows[0]);
		for (int k = 0; k < ROWS; k++) {
			if (k > 0)
				set_inputs(s, u[k - 1], u[k], x);
			reference_apply(r, E, x);
			outputs_of(r, x, expected);
			for (int i = 0; i < OUTPUTS; i++)
				good = close_to(rows[k][i], expected[i], 0, "row %d, output %d, one %d", k, i, one) &&
						good;
		}
	}
	ok(good, "%s: rows of a block, bit for bit", s->model->name);
	free_rationals(h, 1);
	free_floats(x, SIZE);
	free_floats(E, SIZE * SIZE);
	free(state);
}

/* Row k is the sample at k h: held over step k, or where a ramp starts it. */
static void expected_rows(const pl_model *m, int n, double (*u)[2])
{
	void *state = calloc(1, m->size);
	double out[OUTPUTS], now[2];
	printf("t");
	for (int i = 0; i < m->outputs; i++)
		printf(",%s", m->output_names[i]);
	printf("\n");
	m->init(state);
	if (m->hold != NULL)
		m->hold(state, u[0]);
	for (int k = 0; k <= n; k++) {
		m->out(state, out);
		print_shortest(m->time(state), "");
		for (int i = 0; i < m->outputs; i++)
			print_shortest(out[i], ",");
		printf("\n");
		for (int i = 0; i < 2; i++)
			now[i] = u[k + m->start_samples[i]][i];
		m->step(state, now);
	}
	free(state);
}

int main(int argc, char **argv)
{
	double (*u)[2] = random_samples();
	if (argc == 3 && strcmp(argv[1], "samples") == 0) {
		printf("u,v\n");
		for (int k = 0; k < atoi(argv[2]) && k < SAMPLES; k++)
			printf("%.17g,%.17g\n", u[k][0], u[k][1]);
		return 0;
	}
	if (argc == 4 && strcmp(argv[1], "expected") == 0 && strcmp(argv[2], "switched") == 0)
		expected_rows(&switched_model, atoi(argv[3]), u);
	for (size_t i = 0; i < sizeof subjects / sizeof *subjects; i++) {
		const struct subject *s = &subjects[i];
		if (argc == 4 && strcmp(argv[1], "expected") == 0) {
			if (strcmp(argv[2], s->model->name) == 0)
				expected_rows(s->model, atoi(argv[3]), u);
			continue;
		}
		struct reference *r = reference_of(s->model->name);
		struct run run = referred(s, r, u);
		by_step_and_run(s, &run, u);
		held_sample(s, &run, u);
		between(s, r, &run, u);
		by_gamma(s, r);
		by_rows(s, r);
		free(run.y);
		free(run.out);
		reference_free(r);
	}
	return argc > 1 ? 0 : tap_end();
}
