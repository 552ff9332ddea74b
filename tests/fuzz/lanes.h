/* SPDX-License-Identifier: GPL-3.0-or-later */
/* LANES(id, ID, real, with): id_lanes(), how far instances of ID_batch are off one that steps alone, in states
 * and in their last outputs, over the largest of these or 1; with: `u COMMA`, or nothing where there are no inputs.
 * SUSTAINED(id, ID, real): id_sustained(), what loads sustain of a state at the start at most, where it is kept less
 * that. */
#ifndef LANES_H
#define LANES_H

#include <math.h>

#define COMMA ,
#define LANES(id, ID, real, with)                                                                                     \
	static double id##_lanes(void)                                                                                 \
	{                                                                                                              \
		enum { COUNT = 5, ROWS = 12, OUT = ID##_OUTPUTS };                                                     \
		static real y[ID##_BATCH_ROWS * COUNT], peak[OUT * COUNT], out[ROWS * OUT * COUNT];                    \
		static real u[ROWS * (ID##_INPUTS + 1)], expected[OUT];                                                \
		real now[ID##_STATES], state[ID##_STATES];                                                             \
		double most = 0, size = 1;                                                                             \
		id##_instances b = {0};                                                                                \
		id one;                                                                                                \
		for (int k = 0; k < ROWS * (ID##_INPUTS + 1); k++)                                                     \
			u[k] = (real)((k * 37 + 11) % 61 - 30) / 32;                                                   \
		b.count = COUNT;                                                                                       \
		b.y = y;                                                                                               \
		b.peak = peak;                                                                                         \
		id##_batch_init(&b);                                                                                   \
		id##_batch(&b, ROWS, with out);                                                                        \
		id##_init(&one);                                                                                       \
		for (int k = 0; k < ROWS; k++)                                                                         \
			id##_model.step(&one, ID##_INPUTS ? u + k * ID##_INPUTS : NULL);                               \
		id##_get(&one, state);                                                                                 \
		id##_out(&one, expected);                                                                              \
		for (size_t j = 0; j < COUNT; j++) {                                                                   \
			id##_batch_get(&b, j, now);                                                                    \
			for (int i = 0; i < ID##_STATES; i++) {                                                        \
				size = fmax(size, fabs((double)state[i]));                                             \
				most = fmax(most, fabs((double)now[i] - (double)state[i]));                            \
			}                                                                                              \
			for (int i = 0; i < OUT; i++) {                                                                \
				double found = (double)out[((ROWS - 1) * OUT + i) * COUNT + (int)j];                   \
				size = fmax(size, fabs((double)expected[i]));                                          \
				most = fmax(most, fabs(found - (double)expected[i]));                                  \
			}                                                                                              \
		}                                                                                                      \
		return most / size;                                                                                    \
	}

#define SUSTAINED(id, ID, real)                                                                                       \
	static double id##_sustained(void)                                                                             \
	{                                                                                                              \
		real state[ID##_STATES];                                                                               \
		double most = 0;                                                                                       \
		id one;                                                                                                \
		id##_init(&one);                                                                                       \
		id##_get(&one, state);                                                                                 \
		for (int i = 0; i < ID##_STATES; i++)                                                                  \
			most = fmax(most, fabs((double)state[i] - (double)one.y[i]));                                  \
		return most;                                                                                           \
	}

#endif
