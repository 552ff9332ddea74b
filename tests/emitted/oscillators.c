/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Phi and a step of the model of oscillators.sh against x'' + c x' + k x = 0 in closed form; exactly 0 elsewhere. */
#include "oscillators.h"

#include <math.h>
#include <stdio.h>

enum { STATES = OSCILLATORS_STATES, COUNT = STATES / 2 };

static const long double h = 0.01L;

/* e^{A h} of number i, from 0 */
static void closed_form(int i, long double Phi[2][2])
{
	long double a = ((i + 1) % 7 + 1) / 200.0L, k = 10 + 3 * (i + 1), w = sqrtl(k - a * a), decay = expl(-a * h);
	long double sine = decay * sinl(w * h) / w, cosine = decay * cosl(w * h);
	Phi[0][0] = cosine + a * sine;
	Phi[0][1] = sine;
	Phi[1][0] = -k * sine;
	Phi[1][1] = cosine - a * sine;
}

/* Rounded once: half a unit in the last place, and what long double leaves */
static int is_rounded(double found, long double truth)
{
	return fabsl(found - truth) <= 1.15e-16L * fabsl(truth);
}

static int check_Phi(void)
{
	int faults = 0;
	for (int row = 0; row < STATES; row++) {
		long double own[2][2];
		closed_form(row % COUNT, own);
		for (int column = 0; column < STATES; column++) {
			double found = oscillators_Phi[row][column];
			long double truth = row % COUNT == column % COUNT ? own[row / COUNT][column / COUNT] : 0;
			if (!is_rounded(found, truth) && faults++ < 5)
				printf("Phi[%d][%d] = %.17g, expected %.20Lg\n", row, column, found, truth);
		}
	}
	return faults;
}

static int check_step(void)
{
	oscillators s;
	double y[STATES];
	int faults = 0;
	oscillators_init(&s);
	oscillators_step(&s);
	oscillators_get(&s, y);
	for (int i = 0; i < STATES; i++) {
		long double own[2][2];
		closed_form(i % COUNT, own);
		long double truth = own[i / COUNT][0] / (i % COUNT + 1);
		if (fabsl(y[i] - truth) > 4e-16L * fabsl(truth) && faults++ < 5)
			printf("state %d after a step: %.17g, expected %.20Lg\n", i, y[i], truth);
	}
	return faults;
}

int main(void)
{
	return check_Phi() + check_step() > 0;
}
