/* SPDX-License-Identifier: MIT-0 */
/* derivatives.h: NAME_init_d, NAME_set_d, NAME_get_d and NAME_run_d, derivatives beside the states that they are of,
 * and NAME_derivatives, by which programs find them.  Included by the file of the model, which defines before it
 *
 *     PL_TYPE, PL_DERIVATIVES    the model; how many columns
 *     PL_SEEDED                  1: some are along inputs: the last du is in ds->du, with slopes in ds->slope
 *     PL_SLOPED                  1: it is
 *     PL_BESIDE                  1: models of their own go beside it: members left, time, PL(init_beside)(ds)
 *     PL_BY_PHI                  1: PL(Phi) is what every step does to the state
 *     PL_SCALED                  1: the largest size of each state is in ds->scale
 *
 *     PL_OUT_SIZE                of x, of which outputs are rows: PL(out_row)[segment][output][];
 *                                PL(columns)(s, ds, x, S) sets x and what of it varies, but for the states;
 *                                PL(out_first), PL(out_varied): the entries of the rows' derivatives.  0: PL(out_d) is
 *                                there already
 *
 *     PL(d_initial)[][], PL(d_names)[]     of the first state; what the columns are by
 *     PL(d_input)[]              of each column the input that it is along, or -1; where PL_SEEDED
 *     PL(d_by)[][]               of each column what pl_derivatives says
 *     PL(step_d), PL(out_d)      a step of both; derivatives of outputs */
#include "numbers.h"

#if PL_SEEDED
#define PL_GIVEN , u, du
#elif PL_INPUTS > 0
#define PL_GIVEN , u
#else
#define PL_GIVEN
#endif

void PL(set_d)(PL(d) *ds, real S[PL_DERIVATIVES][PL_STATES])
{
    int i, p;
    for (p = 0; p < PL_DERIVATIVES; p++) {
        for (i = 0; i < PL_STATES; i++) {
            ds->s[p][i] = S == NULL ? 0 : S[p][i];
        }
    }
#if PL_SCALED
    for (i = 0; i < PL_STATES; i++) {
        ds->scale[i] = 0;
    }
#endif
    ds->status = ds->doubt.status = 0;
}

void PL(get_d)(const PL_TYPE *s, const PL(d) *ds, real S[PL_DERIVATIVES][PL_STATES])
{
    int i, p;
    for (p = 0; p < PL_DERIVATIVES; p++) {
        for (i = 0; i < PL_STATES; i++) {
            S[p][i] = ds->s[p][i];
        }
    }
    (void)s;
}

void PL(init_d)(PL_TYPE *s, PL(d) *ds)
{
    int i, p;
    PL(init)(s);
    PL(set_d)(ds, NULL);
#if PL_BESIDE
    PL(init_beside)(ds);
    PL(get)(s, ds->left);
    ds->time = PL(time)(s);
#endif
    for (p = 0; p < PL_DERIVATIVES; p++) {
        for (i = 0; i < PL_STATES; i++) {
            ds->s[p][i] = PL(d_initial)[p][i];
        }
    }
#if PL_SEEDED
    for (i = 0; i < PL_INPUTS; i++) {
        ds->du[i] = 0;
#if PL_SLOPED
        ds->slope[i] = 0;
#endif
    }
#endif
}

#if PL_SLOPED
void PL(hold_d)(PL(d) *ds, const real du[PL_INPUTS])
{
    int i;
    for (i = 0; i < PL_INPUTS; i++) {
        ds->du[i] = du[i];
    }
}
#endif

#if PL_OUT_SIZE > 0
/* Outputs are rows over x, which vary too. */
void PL(out_d)(const PL_TYPE *s, const PL(d) *ds, real J[PL_OUTPUTS][PL_DERIVATIVES])
{
    real x[PL_OUT_SIZE], S[PL_DERIVATIVES][PL_OUT_SIZE] = {{0}};
#if PL_SEGMENTS > 1
    const int segment = s->segment;
#else
    const int segment = 0;
#endif
    int i, j, p;
    PL(columns)(s, ds, x, S);
    for (p = 0; p < PL_DERIVATIVES; p++) {
        const int *first = PL(out_first) + p * PL_SEGMENTS + segment;
        for (i = 0; i < PL_STATES; i++) {
            S[p][i] = ds->s[p][i];
        }
        for (i = 0; i < PL_OUTPUTS; i++) {
            J[i][p] = 0;
            for (j = 0; j < PL_OUT_SIZE; j++) {
                J[i][p] += PL(out_row)[segment][i][j] * S[p][j];
            }
        }
        for (j = first[0]; j < first[1]; j++) {
            J[PL(out_varied)[j].row][p] += PL(out_varied)[j].value * x[PL(out_varied)[j].column];
        }
    }
}
#endif

void PL(run_d)(PL_TYPE *s, PL(d) *ds, size_t n
#if PL_INPUTS > 0
               , const real *u
#endif
#if PL_SEEDED
               , const real *du
#endif
               , real *out, real *J)
{
    size_t k;
    for (k = 0; k < n; k++) {
        PL(step_d)(s, ds PL_GIVEN);
#if PL_INPUTS > 0
        u += PL_INPUTS;
#endif
#if PL_SEEDED
        du += du == NULL ? 0 : PL_INPUTS;
#endif
        if (out != NULL) {
            PL(out)(s, out + k * PL_OUTPUTS);
        }
        if (J != NULL) {
            PL(out_d)(s, ds, (real (*)[PL_DERIVATIVES])(J + k * PL_OUTPUTS * PL_DERIVATIVES));
        }
    }
}

#include "back.h"

/* ---- for programs ---- */

static void PL(any_init_d)(void *s, void *ds)
{
    PL(init_d)((struct PL_TYPE *)s, (PL(d) *)ds);
}

static void PL(any_step_d)(void *s, void *ds, const real *u, const real *du)
{
    (void)u;
    (void)du;
    PL(step_d)((struct PL_TYPE *)s, (PL(d) *)ds PL_GIVEN);
}

static void PL(any_out_d)(const void *s, const void *ds, real *J)
{
    PL(out_d)((const struct PL_TYPE *)s, (const PL(d) *)ds, (real (*)[PL_DERIVATIVES])J);
}

#if PL_SLOPED
static void PL(any_hold_d)(void *ds, const real *du)
{
    PL(hold_d)((PL(d) *)ds, du);
}
#endif

static unsigned PL(any_status_d)(const void *ds)
{
    return ((const PL(d) *)ds)->status;
}

static const pl_doubt *PL(any_doubt)(const void *ds)
{
    return &((const PL(d) *)ds)->doubt;
}

const pl_derivatives PL(derivatives) = {
    sizeof(PL(d)), PL_DERIVATIVES, PL(d_names), PL(any_init_d), PL(any_step_d), PL(any_out_d),
#if PL_SLOPED
    PL(any_hold_d),
#else
    NULL,
#endif
    PL(any_status_d), PL(d_by), PL(any_gradient), PL(any_doubt)
};

#include "undef.h"
