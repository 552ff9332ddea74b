/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of kernels share: phi_weights_columns.c has the plant and sums of e^{A tau} w, phi_weights_specs.c
 * models. */
#ifndef PHI_WEIGHTS_H
#define PHI_WEIGHTS_H

#include "algebra.h"
#include "cases.h"
#include "drawn.h"
#include "random_spec.h"
#include "measuring.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- kernels.c ---- */

/* One case: what is compared now, and what went wrong so far */
extern struct tried {
	const char *spec, *path;            /* text of the spec, and where it stands */
	const char *scheme, *table, *name;  /* table: full, half, part3; name: of the columns being compared */
	bool loads_left;                    /* known loads are left to the scheme */
	int operator, segment;
	int compared, failed, refused, unsettled; /* unsettled: too small for the judge to tell from 0 */
} trial;

void complain(const char *what, const char *message);

/* ---- phi_weights_columns.c ---- */

/* x = states, [held states,] loads, inputs (with their slopes), then for each channel a chain u0' = u1, u1' = u2, u2' =
 * 0, whose u0 is the force on its equation: the response to a unit u2 is tau^3 phi3(A tau) B, B what a unit force gives
 * the derivatives. */
struct plant {
	size_t states, held, loads, inputs, force_columns;
	size_t load_at, input_at, force_column_at, size;
	mpq_t *A, *B;                       /* B: channels x size, 0 beyond the states */
};

enum { LEVELS = 7, MOMENTS = 16, ZERO_LEVEL = 4 };

struct moment {
	mpq_t fraction, tau;
	evaluator_enclosure *level[LEVELS];
	bool given_up[LEVELS];
};
struct judge {
	struct plant plant;
	uint64_t *residue;                  /* of A, modulo PRIME */
	mpq_t h;
	int moments;
	struct moment moment[MOMENTS];
};

/* One number per state: a sum over times of e^{A tau} w */
struct part {
	struct moment *moment;
	mpq_t *w;                           /* one per entry of x */
	bool *zero, *polynomial;            /* per state, at every tau; see screen */
	mpq_t *value;                       /* per state, where polynomial; NULL: not asked for yet */
};
struct column {
	int parts;
	struct part part[2];
};

bool make_plant(struct plant *p, const struct model *model, int which, int segment, bool split);
struct moment *moment_at(struct judge *judge, mpq_srcptr fraction);
const evaluator_enclosure *enclosure(const struct judge *judge, struct moment *m, int level);
struct part *add_part(struct judge *judge, struct column *column, mpq_srcptr fraction);
void compare_column(const struct model *model, const struct judge *judge, struct column *column,
					const struct coefficient *found, size_t stride);

/* ---- phi_weights_specs.c ---- */

/* Specs that are hard */
extern const struct hard_spec { const char *name, *text; } specs[];
extern const unsigned long spec_count;

/* Random models: linear ones with springs, dampers and products added */
char *random_text(uint64_t seed);
char *large_text(uint64_t seed);

#endif
