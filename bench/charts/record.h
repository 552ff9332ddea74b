/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A record of an earthquake's ground that is made by a formula: 20 s, 50 samples a second [m/s^2]. */
#ifndef RECORD_H
#define RECORD_H

#include <math.h>
#include <stdint.h>

enum { RECORD_SAMPLES = 1001 };
#define RECORD_STEP 0.02

/* As recorders give it, in thousandths of a m/s^2: noise through a soil of 2.5 Hz with 60 % of critical damping (Kanai,
 * Tajimi), strong from 3 to 9 s. Sums and products alone, so it is the same everywhere. */
static inline double record_noise(uint64_t *seed)
{
	double sum = -6;
	for (int i = 0; i < 12; i++) {
		*seed = *seed * 6364136223846793005u + 1442695040888963407u;
		sum += (double)(*seed >> 40) / 16777216.0;
	}
	return sum;
}

static inline double record_strength(double t)
{
	return t < 3 ? t * t / 9 : t <= 9 ? 1 : 1 / (1 + (t - 9) * (t - 9) / 9);
}

static inline void record_of_quake(double *sample)
{
	enum { PARTS = 4 };
	const double w = 15.7, zeta = 0.6, h = RECORD_STEP / PARTS;
	double x = 0, v = 0;
	uint64_t seed = 1;
	for (int k = 0; k < RECORD_SAMPLES; k++) {
		const double force = 3 * record_strength(k * RECORD_STEP) * record_noise(&seed);
		for (int i = 0; i < PARTS; i++) {
			v -= h * (2 * zeta * w * v + w * w * x - force);
			x += h * v;
		}
		const double ground = k == 0 ? 0 : 2 * zeta * w * v + w * w * x;
		sample[k] = floor(1000 * ground + 0.5) / 1000;
	}
}

#endif
