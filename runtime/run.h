/* SPDX-License-Identifier: MIT-0 */
/* run.h: NAME_run, many steps in one call; it sets states to 0 that are so small that they would become denormal.
 * Included by the file of the model, which defines before it
 *
 *     PL_TYPE                    the model, with members y, k
 *     PL_INSIDE                  1: a series serves several steps: members served, valid, PL(inside)(s)
 *     PL_ROWS                    steps that PL(block) takes at once, with their outputs; 0: there is none
 *     PL_OVER                    1: they are those of one series, member served, and 0 of PL(block): its end is not
 *                                finite, and s as it was
 *     PL_REFRESHED                1: loads have a refresh, which stands at the start of a block
 *     PL_RESTS                   0: nothing comes to rest; 1: all states at once; n: n - 1 parts, of each state
 *                                PL(part)[], -1: that does not
 *     PL_IN_STEP                 1: the step looks for that, not the run
 *     PL_COMPENSATED                    1: s->rest is what rounding took of states that rest at once */
#include "numbers.h"

#if PL_RESTS > 0
/* Numbers that small, well above where they have fewer bits, soon take many times as long as others.  To look every 64
 * steps is often enough, and no step shows it. */
static void PL(rest)(PL_TYPE *s)
{
#if PL_SINGLE
    const real least = (real)1e-35;
#else
    const real least = 1e-290;
#endif
    int i;
#if PL_RESTS > 1
    char moves[PL_RESTS - 1];
    for (i = 0; i < PL_RESTS - 1; i++) {
        moves[i] = 0;
    }
    for (i = 0; i < PL_STATES; i++) {
        if (PL(part)[i] >= 0 && !(s->y[i] > -least && s->y[i] < least)) {
            moves[PL(part)[i]] = 1;
        }
    }
    for (i = 0; i < PL_STATES; i++) {
        if (PL(part)[i] >= 0 && !moves[PL(part)[i]]) {
            s->y[i] = 0;
        }
    }
#else
    for (i = 0; i < PL_STATES; i++) {
        if (!(s->y[i] > -least && s->y[i] < least)) {
            return;
        }
    }
    for (i = 0; i < PL_STATES; i++) {
        s->y[i] = 0;
#if PL_COMPENSATED
        s->low[i] = 0;
#endif
    }
#endif
}
#endif

#if PL_SOFT && defined __GNUC__ && !defined __clang__ /* gcc would put it into all that call it */
PL_APART void PL(out)(const PL_TYPE *s, real out[PL_OUTPUTS]);
#endif

/* A step, and the outputs behind it unless out is NULL; where the next go */
static inline real *PL(run_on)(PL_TYPE *s, const real *u, real *out)
{
#if PL_INSIDE
    if (s->served + 1 < s->valid) {
        PL(inside)(s);
    } else {
        PL(step)(s);
    }
#elif PL_INPUTS > 0
    PL(step)(s, u);
#else
    PL(step)(s);
#endif
    (void)u;
    if (out == NULL) {
        return NULL;
    }
    PL(out)(s, out);
    return out + PL_OUTPUTS;
}

/* Not once more where the descriptor calls it */
#if PL_INPUTS > 0
PL_APART void PL(run)(PL_TYPE *s, size_t n, const real *u, real *out)
{
#else
PL_APART void PL(run)(PL_TYPE *s, size_t n, real *out)
{
    const real *const u = NULL;
#endif
#if PL_OVER
    for (; n > 0 && s->served > 0; n--) {
        out = PL(run_on)(s, u, out);
    }
#endif
#if PL_ROWS > 0
    if (n >= PL_ROWS) {
        PL_TYPE now = *s; /* over all blocks, so that its states may be in registers */
#if PL_REFRESHED
        PL(refresh_phasors)(&now);
#endif
        for (; n >= PL_ROWS; n -= PL_ROWS) {
#if PL_OVER
            if (!PL(block)(&now, out)) {
                break;
            }
#elif PL_INPUTS > 0
            PL(block)(&now, u, out);
            u += PL_ROWS * PL_INPUTS;
#else
            PL(block)(&now, out);
#endif
#if PL_RESTS > 0 && !PL_IN_STEP
            if ((now.k & 63) < PL_ROWS) {
                PL(rest)(&now);
            }
#endif
            if (out != NULL) {
                out += PL_ROWS * PL_OUTPUTS;
            }
        }
        *s = now;
    }
#endif
    for (; n > 0; n--) {
        out = PL(run_on)(s, u, out);
#if PL_INPUTS > 0
        u += PL_INPUTS;
#endif
#if PL_RESTS > 0 && !PL_IN_STEP
        if ((s->k & 63) == 0) {
            PL(rest)(s);
        }
#endif
    }
}

#include "undef.h"
