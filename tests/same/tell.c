/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the model of model.h does, as CSV: a row has its table, the steps taken before it and numbers of 17 digits.
 * Compiled with what run.sh finds in model.h: -DFLOAT, -DBATCH, -DHAS_INPUTS, -DOWN (a batch has factors of each
 * instance), -DCROSSINGS, -DRESTED, -DSELFTEST. */
#include "model.h"

#include <math.h>
#include <stdio.h>

#ifdef FLOAT
typedef float real;
typedef pl_modelf descriptor;
#else
typedef double real;
typedef pl_model descriptor;
#endif

enum { STEPS = 300, INPUTS = MADE_INPUTS + 1, BLOCK = 21, COUNT = 5 };

static made state;
static const descriptor *const model = &made_model;
static double amplitude = 0.02; /* of the inputs' record */

static void tell(const char *table, unsigned long step, int count, const real *value)
{
	int i;
	printf("%s,%lu", table, step);
	for (i = 0; i < count; i++)
		if (isnan(value[i]))
			printf(",nan");             /* the sign of which means nothing */
		else
			printf(",%.17g", (double)value[i]);
	printf("\n");
}

/* u of row k of a record, each input as far ahead as it has to be */
static void sample(long k, real *u)
{
	int i;
	for (i = 0; i < MADE_INPUTS; i++) {
		const double row = (double)(k + model->start_samples[i]);
		u[i] = row < 0 ? 0 : (real)(amplitude * (sin((0.2 + (i + 1) / 10.0) * row) + 0.5));
	}
}

static void start(void)
{
	real u[INPUTS];
	long ahead = 0;
	int i;
	model->init(&state);
	for (i = 0; i < MADE_INPUTS; i++)
		if (model->start_samples[i] > ahead)
			ahead = model->start_samples[i];
	for (; ahead > 0; ahead--) {
		sample(-ahead, u);
		model->hold(&state, u);
	}
}

static void tell_state(const char *table, unsigned long step)
{
	real row[3 + MADE_OUTPUTS + MADE_STATES];
	row[0] = model->time(&state);
	row[1] = (real)model->status(&state);
	model->out(&state, row + 2);
	model->get(&state, row + 2 + MADE_OUTPUTS);
	tell(table, step, 2 + MADE_OUTPUTS + MADE_STATES, row);
}

static void tell_between(unsigned long step)
{
	static const double part[] = {0.0, 0.25, 0.8125, 1.0};
	real u[INPUTS], y[MADE_STATES + 1];
	int i;
	if (model->at == NULL)
		return;
	sample((long)step, u);
	for (i = 0; i < 4; i++) {
		model->at(&state, u, (real)part[i] * model->h, y);
		tell("at", step, MADE_STATES, y);
	}
}

static void tell_crossings(unsigned long step)
{
#ifdef CROSSINGS
#ifdef FLOAT
	pl_crossingf crossing[MADE_MAX_EVENTS];
#else
	pl_crossing crossing[MADE_MAX_EVENTS];
#endif
	const int count = made_crossings(&state, crossing);
	real row[5];
	int i;
	for (i = 0; i < count && i < MADE_MAX_EVENTS; i++) {
		row[0] = crossing[i].time;
		row[1] = (real)crossing[i].expression;
		row[2] = (real)crossing[i].breakpoint;
		row[3] = (real)crossing[i].upward;
		row[4] = (real)made_region(&state);
		tell("crossing", step, 5, row);
	}
#ifdef RESTED
	row[0] = (real)made_rested(&state);
	tell("rested", step, 1, row);
#endif
#endif
	(void)step;
}

static void walk(const char *table, unsigned long steps)
{
	real u[INPUTS];
	unsigned long k;
	for (k = 0; k < steps; k++) {
		if (k % 16 == 3)
			tell_between(k);
		sample((long)k, u);
		model->step(&state, u);
		tell_state(table, k + 1);
		tell_crossings(k + 1);
	}
}

/* Outputs of blocks of 1, 2, ... steps, and none of a block */
static void blocks(void)
{
	static real u[BLOCK * INPUTS], out[BLOCK * (MADE_OUTPUTS + 1)];
	unsigned long taken = 0, block, k;
	for (block = 1; block <= BLOCK; block += 4) {
		for (k = 0; k < block; k++)
			sample((long)(taken + k), u + k * MADE_INPUTS);
		model->run(&state, block, u, block == 9 ? NULL : out);
		for (k = 0; k < block && block != 9; k++)
			tell("run", taken + k + 1, MADE_OUTPUTS, out + k * MADE_OUTPUTS);
		taken += block;
	}
	tell_state("after run", taken);
}

static void jumps(void)
{
	static const unsigned long by[] = {1, 7, 1000, 1234567};
	unsigned long taken = 0;
	int i;
	for (i = 0; i < 4 && model->jump != NULL; i++) {
		model->jump(&state, by[i]);
		taken += by[i];
		tell_state("jump", taken);
	}
}

/* Other params and the same step, then another step */
static void retuned(void)
{
	real params[64], status;
	int i;
	if (model->retune == NULL)
		return;
	for (i = 0; i < model->params && i < 64; i++)
		params[i] = model->param_values[i] * (real)(1.0 + 0.02 * (i + 1));
	for (i = 0; i < 2; i++) {
		status = (real)model->retune(&state, params, model->h * (real)(1.0 + 0.25 * i));
		tell("retune", 0, 1, &status);
		walk(i == 0 ? "retuned" : "other step", 50);
	}
}

/* Another state and time, and inputs that go across what smaller ones stay before */
static void placed(void)
{
	real y[MADE_STATES + 1];
	int i;
	model->get(&state, y);
	for (i = 0; i < MADE_STATES; i++)
		y[i] = y[i] * (real)0.75 + (real)(0.001 * i);
	model->set(&state, (real)3.7, y);
	amplitude = 0.7;
	walk("placed", 60);
	amplitude = 0.02;
}

static void many(void)
{
#ifdef BATCH
	static real y[MADE_BATCH_ROWS * COUNT], peak[MADE_OUTPUTS * COUNT], out[40 * MADE_OUTPUTS * COUNT];
	real u[40 * INPUTS], one[MADE_STATES];
	static made_instances all;
	size_t j, k;
	int i;
	all.count = COUNT;
	all.y = y;
	all.peak = peak;
#ifdef OWN
	static real factors[MADE_BATCH_FACTORS * COUNT];
	all.factors = factors;
#endif
	made_batch_init(&all);
#ifdef OWN
	made_coeffs own = made_nominal;
	real params[MADE_PARAMS];
	for (i = 0; i < MADE_PARAMS; i++)
		params[i] = own.params[i] * (real)1.1;
	one[0] = (real)made_retune(&own, params, own.h);
	tell("own", 0, 1, one);
	made_batch_use(&all, 1, &own);
#endif
	for (j = 1; j < COUNT; j++) {
		made_batch_get(&all, j, one);
		for (i = 0; i < MADE_STATES; i++)
			one[i] += (real)(0.01 * (double)j * (i + 1));
		made_batch_set(&all, j, one);
	}
	for (k = 0; k < 40; k++)
		sample((long)k, u + k * MADE_INPUTS);
#ifdef HAS_INPUTS
	made_batch(&all, 40, u, out);
#else
	made_batch(&all, 40, out);
#endif
	for (k = 0; k < 40; k++)
		tell("batch", k + 1, MADE_OUTPUTS * COUNT, out + k * MADE_OUTPUTS * COUNT);
	tell("peaks", 40, MADE_OUTPUTS * COUNT, peak);
#endif
}

int main(void)
{
	const real size = (real)sizeof(real);
	tell("size of a number", 0, 1, &size);
	start();
	tell_state("step", 0);
	walk("step", STEPS);
	start();
	blocks();
	start();
	jumps();
	start();
	retuned();
	start();
	placed();
	many();
#ifdef SELFTEST
	{
		const real worst = (real)made_selftest();
		tell("selftest", 0, 1, &worst);
	}
#endif
	return 0;
}
