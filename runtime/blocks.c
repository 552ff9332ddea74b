/* SPDX-License-Identifier: MIT-0 */
/* retune.c for a large model: e^{A tau} of one independent block after the other, each as large as it is. */
#include "two.h"

static int size_of(const pl_block *b)
{
    return b->states + b->loads + b->inputs;
}

/* A of x' = A x in a segment of time, from the solved equations; width: of their rows */
static void fill_slopes(const pl_block *b, const pl_two *value, int width, int segment, pl_two *A)
{
    const int size = size_of(b), loads = b->states + segment * b->loads, inputs = b->states + b->segments * b->loads;
    int i, j;
    for (i = 0; i < size * size; i++)
        A[i] = two(0, 0);
    for (i = 0; i < b->entries; i++)
        A[b->entry[i].row * size + b->entry[i].column] = b->entry[i].value;
    for (i = 0; i < b->turns; i++) {
        const int at = b->turn[2 * i + 1];
        const pl_two w = value[b->turn[2 * i] * width];
        A[at * size + at + 1] = two(-w.hi, -w.lo);
        A[(at + 1) * size + at] = w;
    }
    for (i = 0; i < b->derivatives; i++) {
        const pl_two *const from = value + i * width;
        pl_two *const to = A + b->row[i] * size;
        for (j = 0; j < b->states; j++)
            to[j] = from[j];
        for (j = 0; j < b->loads; j++)
            to[b->states + j] = from[loads + j];
        for (j = 0; j < b->inputs; j++)
            to[b->states + b->loads + j] = from[inputs + j];
    }
}

static int width_of(const pl_equations *e)
{
    return e->columns + (e->solves ? e->rows : 0);
}

static int ramp_cancels(const pl_block *b, const pl_two *D, real tau)
{
    int i;
    for (i = 0; i < b->ramps; i++)
        if (pl_ramp_cancels(size_of(b), b->states, D, b->ramp[i], tau))
            return 1;
    return 0;
}

int pl_block_increment(const pl_block *b, const real *params, real tau, pl_two *D, pl_two *work)
{
    const int size = size_of(b), width = width_of(&b->equations);
    pl_two *const A = work + b->equations.rows * width, *const further = A + size * size;
    int segment, status = pl_equations_at(&b->equations, params, work, further);

    for (segment = 0; segment < b->segments && status == 0; segment++, D += b->states * size) {
        fill_slopes(b, work, width, segment, A);
        status = pl_increment(size, b->states, A, tau, 1, D, further);
        if (status == 0 && ramp_cancels(b, D, tau))
            status = pl_increment(size, b->states, A, tau, 2, D, further);
    }
    return status;
}

static real infinity_of_type(void)
{
    real_parts u;
    u.bits = (real_bits)(2 * REAL_EXPONENTS - 1) << (REAL_DIGITS - 1);
    return u.value;
}

void pl_block_advance(const pl_block *b, const real *params, int segment, real tau, real *x, pl_two *work)
{
    const int size = size_of(b), width = width_of(&b->equations), rows = b->segments > 1 ? size : b->states;
    pl_two *const A = work + b->equations.rows * width, *const D = A + size * size, *const further = D + size * size;
    int i, j, status = pl_equations_at(&b->equations, params, work, further);

    if (status == 0) {
        fill_slopes(b, work, width, segment, A);
        status = pl_increment(size, rows, A, tau, 1, D, further);
    }
    for (i = 0; i < rows && status == 0; i++) {
        real more = 0;
        for (j = 0; j < size; j++)
            more += D[i * size + j].hi * x[j];
        A[i].hi = x[i] + more;
    }
    for (i = 0; i < rows; i++)
        x[i] = status == 0 ? A[i].hi : infinity_of_type();
}
