/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rotating beam, from the decimals of models/beam/ (read from the working folder, the top of the source tree):
 *     M q'' + 2 w G q' + (K + w^2 (D - M) + w' G) q = w^2 fu - w' fw,
 * w the spin-up to 4 or 15 rad/s within 15 s (models/beam4.spec, beam15.spec). */
#ifndef QUAD_BEAM_H
#define QUAD_BEAM_H

#include "quad.h"

enum { BEAM_N = 15 };

struct quad_beam {                      /* M^-1: 15 x 15; the others as they stand in their files, row-major */
	quad inverse[BEAM_N][BEAM_N], K[BEAM_N][BEAM_N], G[BEAM_N][BEAM_N], DM[BEAM_N][BEAM_N];  /* DM: D - M */
	quad fu[BEAM_N], fw[BEAM_N];
};
/* Read once; a file that is not there or not Matrix Market ends the program. */
const struct quad_beam *quad_beam_matrices(void);

bool quad_beam_has(const struct problem *p);
/* Fills t->at_end, t->between (at TRUTH_BETWEEN), and the scales, by steps of an eighth of a unit: the unit must divide
 * 15 s. Off by less than 1e-25 a second. */
void quad_beam(const struct problem *p, struct truth *t);

#endif
