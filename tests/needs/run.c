/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run STEPS PARAM...: the outputs of model `drawn` at every step, as many as asked for, 17 digits; with these values of
 * its tunable params. */
#include <stdio.h>
#include <stdlib.h>

#include "drawn_pl.c"

#ifdef PL_FLOAT_ONLY
typedef float real;
#else
typedef double real;
#endif

int main(int argc, char **argv)
{
	static drawn s;
	real out[DRAWN_OUTPUTS];
	const long rows = argc > 1 ? atol(argv[1]) : 0;
	drawn_init(&s);
#ifdef TUNED
	real param[TUNED];
	for (int k = 0; k < TUNED && k + 2 < argc; k++)
		param[k] = (real)atof(argv[k + 2]);
	if (drawn_model.retune(&s, param, drawn_model.h) != 0)
		return 1;
#endif
	for (long i = 0; i < rows; i++) {
		drawn_out(&s, out);
		printf("%.17g\n", (double)out[0]);
#ifdef INPUT
		const real u[] = { INPUT };
		drawn_step(&s, u);
#else
		drawn_step(&s);
#endif
	}
	return 0;
}
