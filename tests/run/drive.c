/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The same C, compiled, with -DMODEL=NAME -DRHS=NAME_rhs -DREAL=double and -DINPUTS where it has some: prints what
 * inside.c does; without -DRHS no slopes. With END FACTOR instead of STEPS: to this time, from the spec's initial
 * values times the factor. */
#include <stdio.h>
#include <stdlib.h>
#include "plrt.h"

#define NAME_(model) model##_model
#define NAME(model) NAME_(model)
#ifdef FLOAT
typedef float real;
extern const pl_modelf NAME(MODEL);
#else
typedef double real;
extern const pl_model NAME(MODEL);
#endif
#if !defined RHS
#elif defined INPUTS
void RHS(real t, const real y[], const real u[], real dydt[]);
#else
void RHS(real t, const real y[], real dydt[]);
#endif

static void print_row(char name, const real *value, int count)
{
	printf("%c", name);
	for (int i = 0; i < count; i++)
		printf(" %a", (double)value[i]);
	putchar('\n');
}

int main(int argc, char **argv)
{
	static real value[600], u[64];
	void *s = calloc(1, NAME(MODEL).size);
	long steps = argc > 2 ? (long)(atof(argv[1]) / (double)NAME(MODEL).h * (1 + 1e-6)) : atol(argv[1]);
	NAME(MODEL).init(s);
	if (argc > 2) {
		NAME(MODEL).get(s, value);
		for (int i = 0; i < NAME(MODEL).states; i++)
			value[i] = (real)((double)value[i] * atof(argv[2]));
		NAME(MODEL).set(s, 0, value);
	}
	for (long n = 0; n < steps; n++) {
		for (int i = 0; i < NAME(MODEL).inputs; i++)
			u[i] = (real)((n * 7 + i * 3) % 11 - 5) / 8;
		NAME(MODEL).step(s, u);
		value[0] = NAME(MODEL).time(s);
		print_row('t', value, 1);
		NAME(MODEL).get(s, value);
		print_row('y', value, NAME(MODEL).states);
		NAME(MODEL).out(s, value);
		print_row('o', value, NAME(MODEL).outputs);
	}
	NAME(MODEL).get(s, value);
#if !defined RHS
#elif defined INPUTS
	for (int i = 0; i < NAME(MODEL).inputs; i++) /* of ramps */
		u[NAME(MODEL).inputs + i] = (real)(i + 1) / 4;
	RHS(NAME(MODEL).time(s), value, u, value + 300);
#else
	RHS(NAME(MODEL).time(s), value, value + 300);
#endif
	print_row('r', value + 300, NAME(MODEL).states);
	printf("s %d\n", NAME(MODEL).status(s));
	return 0;
}
