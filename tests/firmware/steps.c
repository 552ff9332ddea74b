/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps every variant from its initial values and prints its bits on the way: states, time, outputs.  Then between two steps, after a
 * jump, and what its selftest says, as far as it has these.
 * Compiled once for double and once, with REAL_FLOAT, for float; steps_main.c calls both. */
#include "variant.h"

#include "port.h"

#include <string.h>

static void put_reals(const real *x, int n)
{
    int i;
    for (i = 0; i < n; i++) {
        real_bits bits;
        memcpy(&bits, &x[i], sizeof bits);
        put(" ");
        put_bits(bits, 2 * (int)sizeof bits);
    }
}

static void put_state(const real_model *m, const void *s, uint32_t k)
{
    real x[16];
    put(m->name);
    put(" ");
    put_count(k);
    m->get(s, x);
    put_reals(x, m->states);
    x[0] = m->time(s);
    put_reals(x, 1);
    m->out(s, x);
    put_reals(x, m->outputs);
    if (m->status) {
        put(" status ");
        put_count((uint32_t)m->status(s));
    }
    put("\n");
}

static void put_line(const real_model *m, const char *what, const real *x, int n)
{
    put(m->name);
    put(what);
    put_reals(x, n);
    put("\n");
}

/* Samples for models with inputs: steps of 1/16, up to 1/8 */
static const real *sample(uint32_t k)
{
    static real u[4];
    u[0] = (real)(k / 50 * 37 % 3) / 16;
    u[1] = u[2] = u[3] = u[0];
    return u;
}

void OF_REAL(steps)(uint32_t last)
{
    static uint64_t state[256];
    const struct variant *v;
    for (v = OF_REAL(variants); v->model; v++) {
        const real_model *const m = v->model;
        uint32_t k = 0, next = 1;
        real x[16];
        if (m->size > sizeof state || m->states > 16 || m->outputs > 16 || m->inputs > 4)
            stop(3);
        m->init(state);
        while (k < last) {
            for (; k < next; k++)
                m->step(state, sample(k));
            put_state(m, state, k);
            next = 10 * next < last ? 10 * next : last;
        }
        if (m->at) {
            m->at(state, sample(k), m->h / 3, x);
            put_line(m, " between", x, m->states);
        }
        if (m->jump) {
            m->jump(state, 1000003);
            put_state(m, state, k + 1000003);
        }
        if (v->selftest) {
            x[0] = v->selftest();
            put_line(m, " selftest", x, 1);
        }
    }
}
