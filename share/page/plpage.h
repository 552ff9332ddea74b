/* SPDX-License-Identifier: MIT-0 */
/* What a page calls of its model, behind the model's own C, compiled to WebAssembly.  The page writes states, params
 * and samples where `place` says, and reads a row for each step.  Before this file stand PAGE(name), the model's
 * functions, PAGE_TYPE, its state, PAGE_H, its step, and the numbers PAGE_STATES, PAGE_INPUTS, PAGE_OUTPUTS,
 * PAGE_PARAMS, PAGE_RAMPS (an input is a ramp) and PAGE_CROSSES (breakpoints are counted). */
#define EXPORTED(name) __attribute__((export_name(#name)))

enum { ROWS = 1024, COLUMNS = 1 + PAGE_OUTPUTS + PAGE_STATES };

static PAGE_TYPE s;
static double y[PAGE_STATES], params[PAGE_PARAMS + 1], u[ROWS * PAGE_INPUTS + 1];
static double row[ROWS][COLUMNS]; /* crossings in the step, outputs, states */

/* The addresses of y, params, u, the rows; then how many rows there are */
EXPORTED(place) unsigned long place(int what)
{
	return what == 0 ? (unsigned long)y : what == 1 ? (unsigned long)params : what == 2 ? (unsigned long)u
		 : what == 3 ? (unsigned long)row : ROWS;
}

/* Sets t = 0 and the spec's initial values, and shows them in y. */
EXPORTED(init) void init(void)
{
	PAGE(init)(&s);
	PAGE(get)(&s, y);
}

/* Sets the state y at the time t. */
EXPORTED(set) void set(double t)
{
	PAGE(set)(&s, t, y);
}

/* Takes the params; 0, or why the model cannot have these values. */
EXPORTED(tune) int tune(void)
{
#if PAGE_PARAMS
	return PAGE(any_retune)(&s, params, PAGE_H);
#else
	return 0;
#endif
}

/* Takes the first sample of u as that before the first step. */
EXPORTED(hold) void hold(void)
{
#if PAGE_RAMPS
	PAGE(hold)(&s, u);
#endif
}

/* Writes row k of the state as it is. */
EXPORTED(look) void look(int k)
{
	row[k][0] = 0.0;
	PAGE(out)(&s, row[k] + 1);
	PAGE(get)(&s, row[k] + 1 + PAGE_OUTPUTS);
}

/* Takes n steps, at most ROWS, with a sample of the inputs each; the status, 0 while all is well. */
EXPORTED(steps) int steps(int n)
{
	int k;
	for (k = 0; k < n; k++) {
#if PAGE_CROSSES
		const uint64_t before = PAGE(crossed)(&s);
#endif
#if PAGE_INPUTS
		PAGE(step)(&s, u + k * PAGE_INPUTS);
#else
		PAGE(step)(&s);
#endif
		look(k);
#if PAGE_CROSSES
		row[k][0] = (double)(PAGE(crossed)(&s) - before);
#endif
	}
	return PAGE(status)(&s);
}

/* Writes into row 0 what a step makes of the state y, with the samples before it and of it one behind the other in u;
 * the run itself stays where it is. */
EXPORTED(probe) void probe(void)
{
	static PAGE_TYPE kept;
	kept = s;
	PAGE(set)(&s, PAGE(time)(&s), y);
	hold();
#if PAGE_INPUTS
	PAGE(step)(&s, u + PAGE_INPUTS);
#else
	PAGE(step)(&s);
#endif
	look(0);
	s = kept;
}

EXPORTED(time) double time(void)
{
	return PAGE(time)(&s);
}
