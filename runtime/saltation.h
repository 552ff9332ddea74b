/* SPDX-License-Identifier: MIT-0 */
/* saltation.h: what an event does to derivatives S = x_p at fixed time: part of plreal.h, for every flow.  A guard g
 * comes to 0 while g' = g_x f- + g_t > 0, the state jumps, x+ = R(t, x-, p), and goes on with the field f+ in place of
 * f-.  Then (Aizerman and Gantmakher 1958; Leine and Nijmeijer 2004)
 *
 *     t*_p = -(g_x S- + g_p)/g'            S+ = R_x S- + R_p + q t*_p,      q = R_x f- + R_t - f+
 *
 * A flow gives directional derivatives alone: of g and R along the solution, (f-, 1), and along columns, (S-, p). */

/* The derivative of the event's time: dg of that column, rate: g' */
static inline PL_REAL pl_saltation_time(PL_REAL dg, PL_REAL rate)
{
    return -dg / rate;
}

/* S becomes S+, from R_x S- + R_p.  when: t*_p */
static inline void pl_saltation_pass(int n, const PL_REAL *q, PL_REAL when, PL_REAL *S)
{
    int i;
    for (i = 0; i < n; i++) {
        S[i] += q[i] * when;
    }
}

/* Whether a guard that turns back, g'' = bend < 0, is met so flatly that S+ is not known: the rounding of g, whose
 * terms have this size, is not small beside the depth rate^2/(2 |bend|) that would be reached behind it.  S+ itself
 * grows as 1/rate there, and depends on whether the guard is met at all. */
static inline int pl_saltation_grazes(PL_REAL size, PL_REAL rate, PL_REAL bend)
{
    const PL_REAL known = sizeof(PL_REAL) == sizeof(float) ? (PL_REAL)0x1p-16 : (PL_REAL)0x1p-33;
    return bend < 0 && rate * rate < -bend * size * known;
}

/* The same of a guard that is not met: `gap`, its distance where it turns back. */
static inline int pl_saltation_misses(PL_REAL size, PL_REAL gap)
{
    const PL_REAL known = sizeof(PL_REAL) == sizeof(float) ? (PL_REAL)0x1p-17 : (PL_REAL)0x1p-34;
    return gap < size * known;
}
