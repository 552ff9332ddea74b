/* SPDX-License-Identifier: MIT-0 */
/* within.h: part of normal.h: states inside a step.  The step is made on a copy, for its forces; between the times of
 * these they are a polynomial, along which modes go on by series.  The model's file defines beside what normal.h asks
 *
 *     PL_TERMS, PL_TURNS         of the series; parts of a step in which no mode turns by more than 1
 *     PL_DAMPED                  whether PL(damping) is there
 *     PL(of_nodes)[], PL(of_past)[]     of polynomials through forces at nodes, through past ones and the new one:
 *                                powers 1 and up from what the other forces exceed that at the start by
 *     PL(stiffness)[][PL_WIDTH], PL(damping)[][PL_WIDTH]   of each operator: lambda [1/s^2], 2 delta [1/s] of each mode
 *     PL(swing_on)(which, by, forcing, swing, force)   of known loads: adds their part to the forces of a term, their
 *                                next term to forcing */

#if PL_POINTS > 0
#define PL_DEGREE PL_POINTS
#else
#define PL_DEGREE PL_STAGES
#endif

/* Forces, that at the start of the step first, become the coefficients of their polynomial. */
static void PL(powers)(int degree, const real factor[], real force[PL_DEGREE + 1][PL_WIDTH])
{
    real rise[PL_DEGREE][PL_WIDTH];
    int i, j, k;
    for (k = 0; k < degree; k++) {
        for (i = 0; i < PL_WIDTH; i++) {
            rise[k][i] = force[k + 1][i] - force[0][i];
        }
    }
    for (j = 1; j <= degree; j++) {
        for (i = 0; i < PL_WIDTH; i++) {
            real sum = 0;
            for (k = 0; k < degree; k++) {
                sum += factor[(j - 1) * degree + k] * rise[k][i];
            }
            force[j][i] = sum;
        }
    }
}

/* The polynomial of the forces over the step that begins now; its degree.  next: a copy, which makes the step */
static int PL(forces_of_step)(const PL_TYPE *s, PL_TYPE *next, real force[PL_DEGREE + 1][PL_WIDTH])
{
    int i, k;
#if PL_POINTS > 0
    int at = s->newest;
    if (s->known < PL_POINTS) {
        PL(collocate)(next, force);
        PL(powers)(PL_STAGES, PL(of_nodes), force);
        return PL_STAGES;
    }
    for (k = 0; k < PL_POINTS; k++) {
        for (i = 0; i < PL_WIDTH; i++) {
            force[k][i] = s->force[at][i];
        }
        at = at ? at - 1 : PL_POINTS - 1;
    }
    PL(advance)(next, force[PL_POINTS]);
#if !PL_TWICE
    for (i = 0; i < PL_WIDTH; i++) {
        force[PL_POINTS][i] = next->force[next->newest][i];
    }
#endif
    PL(powers)(PL_POINTS, PL(of_past), force);
    return PL_POINTS;
#else
    PL(collocate)(next);
    for (k = 0; k < PL_NODES; k++) {
        for (i = 0; i < PL_WIDTH; i++) {
            force[k][i] = next->force[k][i];
        }
    }
    PL(powers)(PL_STAGES, PL(of_nodes), force);
    (void)s;
    return PL_STAGES;
#endif
}

/* eta and rate go on by tau, over parts of it.  power: the polynomial of forces; or else f: functions of time that no
 * longer change, and forces are what acts on each term. */
static void PL(go_on)(const PL_TYPE *s, int which, real tau, int degree, real power[PL_DEGREE + 1][PL_WIDTH],
                      const real *f, real forcing[], real eta[PL_WIDTH], real rate[PL_WIDTH])
{
    const real theta = tau / PL_H;
    const int parts = theta > 0 && theta < 1 ? 1 + (int)(theta * PL_TURNS) : PL_TURNS + 1;
    const real d = theta / (real)parts;
    real x[PL_WIDTH], v[PL_WIDTH], force[PL_WIDTH], still[PL_WIDTH], swing[PL_FORCINGS + 1];
    int i, j, k, part;
    for (i = 0; i < PL_WIDTH; i++) {
        x[i] = v[i] = still[i] = 0;
    }
    if (f != NULL) {
        PL(mode_forces)(s, which, f, x, v, still);
    }
    for (part = 0; part < parts; part++) {
        real scale = 1;
        for (i = 0; i < PL_WIDTH; i++) {
            x[i] = eta[i];
            v[i] = rate[i];
        }
        for (i = 0; i < PL_FORCINGS; i++) {
            swing[i] = forcing[i];
        }
        for (k = 0; k < PL_TERMS; k++) {
            const real by = d * PL_H / (real)(k + 1);
            if (f != NULL) {
                PL(mode_forces)(s, which, f, x, v, force);
            }
            for (i = 0; i < PL_WIDTH; i++) {
                force[i] = f != NULL ? force[i] - (k ? still[i] : 0) : k <= degree ? scale * power[k][i] : 0;
            }
#if PL_FORCINGS > 0
            PL(swing_on)(which, by, forcing, swing, force);
#endif
            for (i = 0; i < PL_WIDTH; i++) {
#if PL_DAMPED
                const real change = by * (force[i] - PL(stiffness)[which][i] * x[i] - PL(damping)[which][i] * v[i]);
#else
                const real change = by * (force[i] - PL(stiffness)[which][i] * x[i]);
#endif
                x[i] = by * v[i];
                v[i] = change;
                eta[i] += x[i];
                rate[i] += v[i];
            }
            scale *= d;
        }
        for (j = 0; j < degree; j++) { /* powers from the end of the part on */
            for (k = degree - 1; k >= j; k--) {
                for (i = 0; i < PL_WIDTH; i++) {
                    power[k][i] += d * power[k + 1][i];
                }
            }
        }
    }
    (void)swing;
}

/* The state tau after now */
void PL(at)(const PL_TYPE *s, real tau, real y[2 * PL_MODES])
{
    PL_TYPE next = *s;
    real force[PL_DEGREE + 1][PL_WIDTH], forcing[PL_FORCINGS + 1];
    const real *steady = NULL;
    int i, degree = 0;
#if PL_STEADY
    real f[PL_FUNCTIONS + 1];
    if (s->segment == PL_SEGMENTS - 1) {
        PL(functions_at)(s, 0, 0, f);
        steady = f;
#if PL_OPERATORS > 1
        if (s->which != PL_STEADY_IN) {
            PL(serve)(&next, PL_STEADY_IN);
        }
#endif
    }
#endif
    PL(forcings_now)(s, forcing);
    if (steady == NULL) {
        degree = PL(forces_of_step)(s, &next, force);
        next.which = s->which;
        for (i = 0; i < PL_WIDTH; i++) {
            next.eta[i] = s->eta[i];
            next.rate[i] = s->rate[i];
        }
    }
    PL(go_on)(s, next.which, tau, degree, force, steady, forcing, next.eta, next.rate);
    PL(of_modes)(next.which, next.eta, y);
    PL(of_modes)(next.which, next.rate, y + PL_MODES);
}
