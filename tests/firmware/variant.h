/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What variants.sh makes: a table for double or, with REAL_FLOAT, for float. */
#ifndef VARIANT_H
#define VARIANT_H

#include "plrt.h"

#ifdef REAL_FLOAT
typedef float real;
typedef uint32_t real_bits;
typedef pl_modelf real_model;
#define OF_REAL(name) name##_float
#else
typedef double real;
typedef uint64_t real_bits;
typedef pl_model real_model;
#define OF_REAL(name) name##_double
#endif

struct variant {
    const real_model *model;
    real (*selftest)(void); /* or NULL */
    void (*step)(void *s); /* NAME_step itself, not the descriptor's */
};

/* Every function that takes the state takes a pointer: the cast hides only to what. */
#define VARIANT(name) {&name##_model, name##_selftest, (void (*)(void *))(void (*)(void))name##_step}
#define UNTESTED(name) {&name##_model, 0, (void (*)(void *))(void (*)(void))name##_step}

extern const struct variant OF_REAL(variants)[]; /* up to one without a model */

#endif
