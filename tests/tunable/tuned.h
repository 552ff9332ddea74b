/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models with tunable params, as tuned.sh makes them; for double or, with REAL_FLOAT, for float. */
#ifndef TUNED_H
#define TUNED_H

#include "../forms/variant.h"

struct tuned {
    const char *name;
    const real_model *model, *plain;        /* plain: the spec without `tunable` */
    const real_model *there;                /* the same at other values, as plgen's options `options` say; or NULL */
    const char *options;
    int direct;                             /* step is Phi, not Phi - I */
    size_t size, place;                     /* of NAME_coeffs; in the instance */
    const void *nominal;
    int (*retune)(void *coeffs, const real *params, real h);
    void (*use)(void *s, const void *coeffs);
    size_t h, params;                       /* in NAME_coeffs */
    int columns;
    size_t step, out, phase_step, envelope_step;
    int step_entries, out_entries, phase_step_entries, envelope_step_entries; /* rows of it; 0: no such member */
};
extern const struct tuned tuned[];          /* up to one without a name */

#endif
