/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of emit/many have from one another, and nobody else. */
#ifndef PLGEN_EMIT_MANY_INNER_H
#define PLGEN_EMIT_MANY_INNER_H

#include "emit/steps.h"

struct batch {
	const struct emitter *e;
	int shared;                     /* numbers that instances share in a step: `now` */
	const char **shared_text;       /* first those that the step reads, before it; */
	int after;                      /* from here on those of the outputs, after it */
	struct tape *step, *out;        /* what lanes compute */
	bool out_alone;                 /* outputs are no such sums: they are those of NAME_out */
	int forced;                     /* index of the forced part; -1: none */
	bool sampled;                   /* of peaks: nothing acts on the states but polynomials through samples */
	const char **acting;            /* of a step that loops: what acts on blocks and modes */
	int *own;                       /* ... and of each group where its table begins in the factors of an instance */
	int lanes;                      /* factors of the instance that lanes have; */
	int factors;                    /* of an instance, that its params decide */
	const char **factor_text;       /* s->coeffs.step[0][1] */
};

bool has_regions(const struct emitter *e);
bool has_series(const struct emitter *e);
bool leaves_lanes(const struct emitter *e);     /* what may have an event in a step, or loses the finite numbers */
typedef const char *shared_text(const struct emitter *e, const struct tape_node *n); /* C of what all share; NULL */
void emit_over_lanes(struct batch *b, const struct tape *t, int from, shared_text *text_of);
/* emit_lanes_series.c: steps of a series of fixed order */
shared_text shared_of_series;
void emit_shared_of_series(const struct batch *b);
void emit_lanes_of_series(struct batch *b);
void emit_kernel_of_series(struct batch *b);
int  steps_of_series(const struct emitter *e);  /* that one is over; 0: there is none */
bool calls_functions(const struct tape *t);
struct batch plan_batch(const struct emitter *e);
bool takes_whole_steps(const struct batch *b);  /* a work item of a device, as NAME_step; else sums of lanes */
const char *row_count(const struct emitter *e);                   /* numbers of an instance */
int  inputs_of(const struct emitter *e);
const char *shared_head_text(const struct emitter *e);
const char *shared_row_text(const struct batch *b);
void emit_factor_places(const struct batch *b);
int batch_stepped_rows(const struct emitter *e);                  /* of an instance's memory: those a step changes */
int batch_groups(const struct emitter *e);                        /* of lanes that step in turns */
void emit_lanes_step(struct batch *b);
void emit_lanes_out(struct batch *b);
void emit_lanes_bend(struct batch *b);                            /* how far outputs may be off their chords */

#endif
