/* SPDX-License-Identifier: MIT-0 */
/* constraints.h: part of taylor.h and radau.h: a state is put back onto the model's constraints, positions and
 * velocities, at the end of each step, expansion and internal step, always: with a threshold the state would lean to
 * one side of them, and energy would drift.  The model has
 *
 *     PL(misses)(s, tau, y, miss)   tau after now: what has to be taken from each state so that the constraints hold to
 *                                first order: M^-1 G^T (G M^-1 G^T)^-1 g of positions, the same of velocities. The
 *                                mass matrix M measures how near that is, so motion along the constraints stays.
 *
 * and, where its mass matrix depends on the state, so that a step that fails tells that it is singular:
 *
 *     PL_MASSES                  rows of M; PL(masses)(s, tau, y, mass) its entries that are not 0; PL(mass_at_start)
 *                                the sizes of its diagonal at the start */
#define PL_PASSES 2 /* the second takes what the velocities' own miss is by that of the positions */

#if PL_CONSTRAINTS
/* 0; PL_SINGULAR_MASS where none of its corrections is finite, and the state stays as it was */
static PL_APART int PL(project)(const PL_TYPE *s, real tau, real y[PL_STATES], real low[PL_STATES])
{
    real miss[PL_STATES];
    int i, pass;
    for (pass = 0; pass < PL_PASSES; pass++) {
        PL(misses)(s, tau, y, miss);
        if (pl_not_finite(miss, PL_STATES)) {
            return PL_SINGULAR_MASS;
        }
        for (i = 0; i < PL_STATES; i++) {
            y[i] = pl_accumulate(y[i], -miss[i], 0, &low[i]);
        }
    }
    return 0;
}

/* The same where no low parts are kept */
static inline int PL(project_rounded)(const PL_TYPE *s, real tau, real y[PL_STATES])
{
    real low[PL_STATES] = {0};
    return PL(project)(s, tau, y, low);
}
#define PL_PUT_BACK(s, tau, y) (void)PL(project_rounded)(s, tau, y)
#else
#define PL_PUT_BACK(s, tau, y) (void)(y)
#endif

/* ---- why a step fails ---- */

#if PL_MASSES > 0
#if PL_SINGLE
#define PL_PIVOT ((real)0.001953125) /* 2^-9 */
#else
#define PL_PIVOT 5.9604644775390625e-8 /* 2^-24 */
#endif

/* Whether M is singular at y, tau after now: the elimination meets a pivot that is not finite, or small beside its
 * diagonal entry here or at the start.  Only where a step has failed is that asked: it ends shortly before a singular
 * place. */
static PL_APART int PL(is_singular)(const PL_TYPE *s, real tau, const real y[PL_STATES])
{
    real mass[PL_MASSES][PL_MASSES] = {{0}}, size[PL_MASSES];
    int i, j, k;
    PL(masses)(s, tau, y, mass);
    for (k = 0; k < PL_MASSES; k++) {
        size[k] = pl_magnitude(mass[k][k]);
        size[k] = size[k] < PL(mass_at_start)[k] ? PL(mass_at_start)[k] : size[k];
    }
    for (k = 0; k < PL_MASSES; k++) {
        if (!(pl_magnitude(mass[k][k]) > PL_PIVOT * size[k]) || pl_not_finite(mass[k], PL_MASSES)) {
            return 1;
        }
        for (i = k + 1; i < PL_MASSES; i++) {
            for (j = k + 1; j < PL_MASSES; j++) {
                mass[i][j] -= mass[i][k] / mass[k][k] * mass[k][j];
            }
        }
    }
    return 0;
}

/* What a step tells that went wrong and left the state y, tau after now */
static PL_APART int PL(cause)(const PL_TYPE *s, real tau, const real y[PL_STATES], int wrong)
{
    const int ended = (int)PL_NOT_FINITE | (int)PL_TOO_MANY_STEPS;
    return (wrong & ended) != 0 && PL(is_singular)(s, tau, y) ? (wrong & ~ended) | (int)PL_SINGULAR_MASS : wrong;
}
#define PL_CAUSE(s, tau, y, wrong) PL(cause)(s, tau, y, wrong)
#else
#define PL_CAUSE(s, tau, y, wrong) (wrong)
#endif
