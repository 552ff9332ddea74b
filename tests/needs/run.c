/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The outputs of model `drawn` at every step, as many as asked for, 17 digits. */
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
	for (long i = 0; i < rows; i++) {
		drawn_out(&s, out);
		printf("%.17g\n", (double)out[0]);
		drawn_step(&s);
	}
	return 0;
}
