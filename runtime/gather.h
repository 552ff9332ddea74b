/* SPDX-License-Identifier: MIT-0 */
/* gather.h: regions whose tables an instance has: what NAME_retune gathers of them for steps that stay clear: what
 * stays of x from step to step summed, and bounds over what is never above 1.  Included by the file of the model,
 * behind
 *
 *     PL(name), PL_SINGLE, PL_STATES     the model's prefix before a name; 1: in float; numbers of states,
 *     PL_EXPRESSIONS, PL_BRANCHES        of expressions, of linear systems that its regions have
 *     PL_STAYS, PL(stays)[], PL(stay_param)[]     columns of x that stay; which param each is, -1: 1
 *     PL_PAIRS, PL(pair)[]               loads that oscillate, the first column of each; the next is its other one
 *     PL_STILL                           whether steps are looked at that stay still
 *     PL(breaks)[]                       breakpoints of each expression
 *     PL_LARGE, PL_FOLDED, PL_OPEN_END   what no number may pass; root of 2 less 1; of intervals without end
 *
 * PL(coeffs) has pieces, chord_off, row and breakpoint; added, large, still and edge follow. */
#include "numbers.h"

#if PL_STILL
/* At least the root of a^2 + b^2 */
static real PL(folded)(real a, real b)
{
    return a > b ? a + PL_FOLDED * b : b + PL_FOLDED * a;
}

/* What one system adds to the states, and how far expressions may be off their chords */
static void PL(gather_branch)(PL(coeffs) *c, int k, const real at[])
{
    int i, j;
#if PL_STAYS > 0
    for (i = 0; i < PL_STATES; i++) {
        c->added[k][i] = 0;
        for (j = 0; j < PL_STAYS; j++) {
            c->added[k][i] += c->pieces[k][i][PL(stays)[j]] * at[j];
        }
        if (!(pl_magnitude(c->added[k][i]) < PL_LARGE)) {
            c->large[k] = 0;
        }
    }
#endif
    for (i = 0; i < PL_EXPRESSIONS; i++) {
        const real *const off = c->chord_off[k][i];
        real still = 0;
        for (j = 0; j < PL_PAIRS; j++) {
            still += PL(folded)(off[PL(pair)[j]], off[PL(pair)[j] + 1]);
        }
        for (j = 0; j < PL_STAYS; j++) {
            still += off[PL(stays)[j]] * pl_magnitude(at[j]);
        }
        c->still[k][i] = still * (real)1.000000001;
    }
}
#endif

static void PL(gather)(PL(coeffs) *c)
{
    real at[PL_STAYS + 1];
    int i, j, from = 0, edge = 0;
    for (j = 0; j < PL_STAYS; j++) {
        at[j] = PL(stay_param)[j] < 0 ? 1 : c->params[PL(stay_param)[j]];
    }
#if PL_STILL
    for (i = 0; i < PL_BRANCHES; i++) {
        PL(gather_branch)(c, i, at);
    }
#endif
    for (i = 0; i < PL_EXPRESSIONS; i++) {
        real shift = 0;
        for (j = 0; j < PL_STAYS; j++) {
            shift += c->row[i][PL(stays)[j]] * at[j];
        }
        c->edge[edge++] = -PL_OPEN_END;
        for (j = 0; j < PL(breaks)[i]; j++) {
            c->edge[edge++] = c->breakpoint[from++] - shift;
        }
        c->edge[edge++] = PL_OPEN_END;
    }
}

#include "undef.h"
