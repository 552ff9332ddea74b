/* SPDX-License-Identifier: GPL-3.0-or-later */
/* retune_blocks COUNT: one retune of ten independent blocks of four states with COUNT params changed, one of each
 * block; COUNT below 0: e^{A h} - I of all 40 states at once, as it would be without blocks. For counts of
 * instructions. */
#include "ten_pl.h"

#include <stdlib.h>

#ifdef REAL_FLOAT
typedef float real;
typedef pl_twof two;
#define INCREMENT pl_incrementf
#else
typedef double real;
typedef pl_two two;
#define INCREMENT pl_increment
#endif
enum { STATES = 40, MASSES = 20 };
static two A[STATES * STATES], D[STATES * STATES], work[PL_INCREMENT_WORK(STATES)];
static ten_coeffs coeffs;

int whole(void);
int whole(void)
{
	for (int i = 0; i < MASSES; i++) {
		A[i * STATES + MASSES + i].hi = 1;
		A[(MASSES + i) * STATES + i].hi = -(real)(150 + i);
		A[(MASSES + i) * STATES + (i ^ 1)].hi = 50;
		A[(MASSES + i) * STATES + MASSES + i].hi = (real)-0.5;
	}
	return INCREMENT(STATES, STATES, A, TEN_H, 1, D, work);
}

int main(int argc, char **argv)
{
	const int count = argc > 1 ? atoi(argv[1]) : 0;
	real params[TEN_PARAMS];
	for (int i = 0; i < TEN_PARAMS; i++)
		params[i] = ten_nominal.params[i] * (i < count ? (real)1.125 : 1);
	return count < 0 ? whole() : ten_retune(&coeffs, params, TEN_H);
}
