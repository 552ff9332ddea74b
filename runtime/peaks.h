/* SPDX-License-Identifier: MIT-0 */
/* peaks.h: output NAME = peak(EXPR), the largest |EXPR| so far: a step looks for larger values inside, before it moves
 * the state.  Included by the file of the model, which defines before it
 *
 *     PL_SIZE                           numbers of x: the states and what acts on them
 *     PL_PEAKS, PL(peak_output)[]       how many such outputs, and which
 *     PL_SLOPE, PL_BEND                 [PL_SIZE][PL_SIZE], [PL_PEAKS][PL_SIZE] of s: x' = slope x; bend |x| is at
 *                                       least what an output is off its chord in a step
 *     PL_PEAK_ROW(c, p)                 peak p over x, with coefficients c
 *     PL_OWN, PL_REACHES                whether params change them; is c->reach[] there: as many times the
 *                                       PL(nominal).bend of what acts on the states is at least theirs
 *
 * and behind it PL(begin_step)(s, u, x), x at the start of a step; PL(move), the step itself; PL(now), outputs as they
 * are.  Instances of a batch look for peaks by PL(look), too. */
#include "numbers.h"

static void PL(begin_step)(const PL_TYPE *s, const real *u, real x[PL_SIZE]);
static void PL(now)(const PL_TYPE *s, real out[PL_OUTPUTS]);

/* Larger values inside the step from x to outputs `end`, into peak[] */
static void PL(look)(const PL_TYPE *s, const real x[PL_SIZE], const real end[PL_OUTPUTS], real peak[PL_PEAKS])
{
    real work[PL_PEAK_WORK(PL_SIZE)];
    int p;
    for (p = 0; p < PL_PEAKS; p++) {
        peak[p] = pl_peak(PL_SIZE, PL_SLOPE[0], PL_PEAK_ROW(&s->coeffs, p), PL_BEND[p], PL_H, x,
                          end[PL(peak_output)[p]], peak[p], work);
    }
    (void)s;
}

#if PL_OWN
/* Of the slopes A, bends over a step h [s] */
static void PL(retune_peaks)(PL(coeffs) *c, const pl_two *A, real h)
{
    real work[PL_PEAK_WORK(PL_SIZE)];
    int i, j, p;
    for (i = 0; i < PL_SIZE; i++) {
        for (j = 0; j < PL_SIZE; j++) {
            c->slope[i][j] = A[i * PL_SIZE + j].hi;
        }
    }
    for (p = 0; p < PL_PEAKS; p++) {
        pl_peak_bend(PL_SIZE, c->slope[0], PL_PEAK_ROW(c, p), h, c->bend[p], work);
#if PL_REACHES
        c->reach[p] = 0;
        for (i = PL_STATES; i < PL_SIZE; i++) {
            if (c->bend[p][i] > c->reach[p] * PL(nominal).bend[p][i]) {
                c->reach[p] = c->bend[p][i] / PL(nominal).bend[p][i];
            }
        }
#endif
    }
}
#endif

#if PL_INPUTS > 0
static void PL(move)(PL_TYPE *s, const real u[PL_INPUTS]);

void PL(step)(PL_TYPE *s, const real u[PL_INPUTS])
#else
static void PL(move)(PL_TYPE *s);

void PL(step)(PL_TYPE *s)
#endif
{
    real x[PL_SIZE], end[PL_OUTPUTS];
#if PL_INPUTS > 0
    PL(begin_step)(s, u, x);
    PL(move)(s, u);
#else
    PL(begin_step)(s, NULL, x);
    PL(move)(s);
#endif
    PL(now)(s, end);
    PL(look)(s, x, end, s->peak);
}

void PL(out)(const PL_TYPE *s, real out[PL_OUTPUTS])
{
    int p;
    PL(now)(s, out);
    for (p = 0; p < PL_PEAKS; p++) {
        const int o = PL(peak_output)[p];
        const real size = pl_magnitude(out[o]);
        out[o] = s->peak[p] > size ? s->peak[p] : size;
    }
}

#include "undef.h"
