/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What variants.sh makes: a table for double or, with REAL_FLOAT, for float. */
#ifndef VARIANT_H
#define VARIANT_H

#ifdef REAL_FLOAT
#define REAL_IS_FLOAT
#endif
#include "real.h"

#ifdef REAL_FLOAT
typedef pl_modelf real_model;
#define OF_REAL(name) name##_float
#else
typedef pl_model real_model;
#define OF_REAL(name) name##_double
#endif

/* Coefficients that a model with tunable params computes itself */
struct tuning {
	int (*retune)(void *coeffs, const real *params, real h);
	void (*use)(void *s, const void *coeffs);
	size_t size;
	int reals; /* with which they begin: h, params, factors of a step and of outputs */
};

struct variant {
	const real_model *model;
	real (*selftest)(void); /* or NULL */
	void (*step)(void *s); /* NAME_step itself, not the descriptor's */
	const struct tuning *tuning; /* or NULL */
};

/* Every function that takes the state, or coefficients, takes a pointer: the cast hides only to what. */
#define VARIANT(name) {&name##_model, name##_selftest, (void (*)(void *))(void (*)(void))name##_step, 0}
#define UNTESTED(name) {&name##_model, 0, (void (*)(void *))(void (*)(void))name##_step, 0}
#define TUNABLE(name) {&name##_model, name##_selftest, (void (*)(void *))(void (*)(void))name##_step, \
	&(const struct tuning){ \
	(int (*)(void *, const real *, real))(void (*)(void))name##_retune, \
	(void (*)(void *, const void *))(void (*)(void))name##_use, \
	sizeof name##_nominal, (int)((offsetof(name##_coeffs, out) + sizeof name##_nominal.out) / sizeof(real))}}

extern const struct variant OF_REAL(variants)[]; /* up to one without a model */

#endif
