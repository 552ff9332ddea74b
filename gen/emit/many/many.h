/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Many instances in one call. */
#ifndef PLGEN_EMIT_MANY_H
#define PLGEN_EMIT_MANY_H

#include "emit/state.h"

/* ---- emit_lanes.c, emit_batch.c: many instances in one call ---- */

struct batch {
	const struct emitter *e;
	int shared;                     /* numbers that instances share in a step: `now` */
	const char **shared_text;       /* first those that the step reads, before it; */
	int after;                      /* from here on those of the outputs, after it */
	struct tape *step, *out;        /* what lanes compute */
	int forced;                     /* index of the forced part; -1: none */
	bool sampled;                   /* of peaks: nothing acts on the states but polynomials through samples */
	int lanes;                      /* factors of the instance that lanes have; */
	int factors;                    /* of an instance, that its params decide */
	const char **factor_text;       /* s->coeffs.step[0][1] */
};
void emit_batch_declarations(const struct emitter *e);
void emit_batch(const struct emitter *e);

#endif
