/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The equations of the models, written a second time by hand: x' = A x in exact rationals, x = states, then what
 * acts on them. */
#ifndef EQUATIONS_H
#define EQUATIONS_H

#include <gmp.h>

enum load { NO_LOAD, CONSTANT, WAVE };  /* CONSTANT: one more entry, 1; WAVE: two more, cos(w t) and sin(w t) */

struct equations {
	const char *name;
	int states, size;
	enum load load;
	mpq_t *A;                           /* size x size */
	mpq_t h, w;
	mpq_t *initial;                     /* states */
	int outputs;
	const char *const *state_names, *const *output_names;
};

/* NULL where nobody has written them yet. */
struct equations *equations_of(const char *name);
void equations_free(struct equations *e);

/* x (size) <- the states y, exactly, and the loads at the time t, to 400 bits */
void equations_vector(const struct equations *e, const double *y, const mpq_t t, mpq_t *x);

/* t <- k h, exactly */
void equations_time(const struct equations *e, unsigned long k, mpq_t t);

double nearest_double(const mpq_t q);

mpq_t *new_rationals(int count);
void free_rationals(mpq_t *q, int count);

#endif
