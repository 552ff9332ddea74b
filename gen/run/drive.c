/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inputs within a bound that a model is tried with: what excites it most, as far as few can tell. The largest response
 * of a linear model to a bounded input is to one that jumps between its bounds (Bulgakov's problem), so all but one do:
 * one jump at the start, square waves at the model's frequencies, a random telegraph; and a chirp through them all. */
#include "run/run.h"

#include <math.h>

enum { CONSTANT, TELEGRAPH, CHIRP, SQUARE };       /* SQUARE + k: at frequency k */

static uint64_t next_random(uint64_t *state)       /* Marsaglia's xorshift */
{
	*state ^= *state << 13;
	*state ^= *state >> 7;
	*state ^= *state << 17;
	return *state;
}

/* Of size 1, by time and frequencies [rad/s]; `sign` is that of the telegraph */
static double shape(int kind, double t, double until, const double *w, int count, double sign)
{
	if (kind == CONSTANT)
		return 1;
	if (kind == TELEGRAPH)
		return sign;
	if (kind == CHIRP) {            /* the logarithm of its frequency grows evenly */
		const double first = w[0] / 2, rate = log(2 * w[count - 1] / first) / until;
		return sin(first * (exp(rate * t) - 1) / rate);
	}
	return sin(w[kind - SQUARE] * t) >= 0 ? 1 : -1;
}

struct sampled drive_of(const struct linear *system, int kind, const double *w, int count, double h, long samples,
		      const mpq_t *most)
{
	const int inputs = system->inputs;
	struct sampled d = { .inputs = inputs, .h = h, .samples = samples, .ramps = ARRAY(bool, inputs),
			   .sample = ARRAY(double, (size_t)(samples + 2) * (size_t)inputs) };
	/* it changes sign once in half of the shortest period, on average */
	const double chance = fmin(0.5, h * w[count - 1] / 3.14159265358979);
	uint64_t state = UINT64_C(0x9e3779b97f4a7c15);
	SCRATCH double *sign = ARRAY(double, inputs);
	for (int i = 0; i < inputs; i++) {
		d.ramps[i] = system->input[i].hold > 0;
		sign[i] = 1;
	}
	for (long k = 0; k < samples + 2; k++)
		for (int i = 0; i < inputs; i++) {
			if ((double)(next_random(&state) >> 11) * 0x1p-53 < chance)
				sign[i] = -sign[i];
			d.sample[k * inputs + i] = mpq_get_d(most[i]) * shape(kind, (double)k * h, h * (double)samples,
									     w, count, sign[i]);
		}
	return d;
}

int drive_kinds(int count)
{
	return SQUARE + count;
}

void drive_step(const struct sampled *d, long k, double *u)
{
	for (int i = 0; i < d->inputs; i++)
		u[i] = d->sample[(d->ramps[i] ? k + 1 : k) * d->inputs + i];
}

void drive_at(const struct sampled *d, long k, double t, double *u)
{
	for (int i = 0; i < d->inputs; i++) {
		const double *here = &d->sample[k * d->inputs + i], there = here[d->inputs];
		u[d->inputs + i] = d->ramps[i] ? (there - *here) / d->h : 0;
		u[i] = *here + (t - (double)k * d->h) * u[d->inputs + i];
	}
}
