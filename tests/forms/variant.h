/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Variants of models, as ../remainder/variants.sh makes them; for double or, with REAL_FLOAT, for float. */
#ifndef VARIANT_H
#define VARIANT_H

#include "plrt.h"

#include <float.h>

#ifdef REAL_FLOAT
typedef float real;
typedef pl_modelf real_model;
#define TYPE "float"
#define EPSILON ((double)FLT_EPSILON)
#define ABSOLUTE fabsf
#else
typedef double real;
typedef pl_model real_model;
#define TYPE "double"
#define EPSILON DBL_EPSILON
#define ABSOLUTE fabs
#endif

struct variant {
	const real_model *model;
	const real *Phi;                        /* states x states */
};

/* The variant MODEL_FORM, or NULL */
const struct variant *variant_of(const struct variant *table, const char *model, const char *form);

#endif
