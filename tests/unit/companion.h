/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The inverse Laplace transform of scale N/D, of lower degree than D, by e^{A tau} of D's companion matrix. */
#ifndef COMPANION_H
#define COMPANION_H

#include "math/math.h"

struct companion { int n; struct taylor *taylor; struct taylor_place *place; };

static inline struct companion companion_of(mpq_srcptr scale, struct poly N, struct poly D, mpq_srcptr tau)
{
    struct companion c = { .n = D.length - 1 };
    mpq_t *A = rationals((size_t)(c.n * c.n));
    c.place = ARRAY(struct taylor_place, c.n);
    for (int k = 0; k < c.n; k++) {
        mpq_ptr last = A[(c.n - 1) * c.n + k];
        mpq_set_num(last, D.c[k]);
        mpq_set_den(last, D.c[c.n]);
        mpq_canonicalize(last);
        mpq_neg(last, last);
        if (k + 1 < c.n)
            mpq_set_ui(A[k * c.n + k + 1], 1, 1);
        c.place[k].row = k;
        c.place[k].column = c.n - 1;
        mpq_init(c.place[k].weight);
        if (k >= N.length)
            continue;
        mpq_set_num(c.place[k].weight, N.c[k]);
        mpq_set_den(c.place[k].weight, D.c[c.n]);
        mpq_canonicalize(c.place[k].weight);
        mpq_mul(c.place[k].weight, c.place[k].weight, scale);
    }
    c.taylor = taylor_of(c.n, A, tau);
    return c;
}

static inline bool companion_exact(struct companion *c, mpq_ptr exact)
{
    return taylor_rational(c->taylor, c->n, c->place, exact);
}

static inline bool companion_enclose(struct companion *c, int precision, mpfi_ptr sum)
{
    INTERVAL entry = OVER_BITS(precision);
    const bool good = taylor_enclose(c->taylor, precision);
    mpfi_set_prec(sum, precision + 64);
    mpfi_set_ui(sum, 0);
    for (int k = 0; k < c->n && good; k++) {
        taylor_entry(c->taylor, k, c->n - 1, entry);
        mpfi_mul_q(entry, entry, c->place[k].weight);
        mpfi_add(sum, sum, entry);
    }
    return good;
}

#endif
