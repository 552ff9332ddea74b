/* SPDX-License-Identifier: GPL-3.0-or-later */
/* count ADD MULTIPLY FUSED: what a step of a model takes, and a row of `run`, in the numbers of counted.h; latencies in
 * ns, FUSED -1 where there are no fused multiplications and additions.  Prints a line for each function: its name,
 * multiplications, additions, pairs of both that may be fused, divisions, and by how much [ns] the longest chain grows
 * with a step. */
#include "plrt.h"

#define JOIN(a, b) a##b
#define DESCRIPTOR(name) JOIN(name, _model)
extern "C" const pl_model DESCRIPTOR(MODEL);
static const pl_model *const model = &DESCRIPTOR(MODEL);

counts tally;

enum { STEPS = 1024 };

static void report(const char *name, const counts &before)
{
	printf("%s %g %g %g %g %.6g\n", name, (plain)(tally.multiplications - before.multiplications) / STEPS,
	       (plain)(tally.additions - before.additions) / STEPS, (plain)(tally.pairs - before.pairs) / STEPS,
	       (plain)(tally.divisions - before.divisions) / STEPS, (tally.latest - before.latest) / STEPS);
}

static void count_steps(void *state, const double *u)
{
	counts before = tally;
	for (int half = 0; half < 2; half++) {          /* the second: what it starts with is behind */
		before = tally;
		for (int k = 0; k < STEPS; k++)
			model->step(state, u);
	}
	report("step", before);
}

static void count_rows(void *state, const double *u, double *out)
{
	counts before = tally;
	for (int half = 0; half < 2; half++) {
		before = tally;
		model->run(state, STEPS, u, out);
	}
	report("run", before);
}

int main(int argc, char **argv)
{
	void *state = calloc(1, model->size);
	double *u = (double *)calloc((size_t)STEPS * (size_t)model->inputs + 1, sizeof(double));
	double *out = (double *)calloc((size_t)STEPS * (size_t)model->outputs + 1, sizeof(double));
	if (argc != 4 || !state || !u || !out)
		return 2;
	tally.add = atof(argv[1]);
	tally.multiply = atof(argv[2]);
	tally.fused = atof(argv[3]);
	model->init(state);
	count_steps(state, model->inputs ? u : NULL);
	tally.latest = 0;
	model->init(state);
	count_rows(state, model->inputs ? u : NULL, out);
	free(out);
	free(u);
	free(state);
	return 0;
}
