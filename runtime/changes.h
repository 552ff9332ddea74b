/* SPDX-License-Identifier: MIT-0 */
/* changes.h: a linear model over part of a step: x' = A x by Taylor's series, x being the states, load states and
 * inputs; split where loads change their formula, and block by block where blocks are independent. Included by the file
 * of the model, which defines before it
 *
 *     PL_TYPE                    the model, with member segment
 *     PL_STATES, PL_SIZE         the states; length of x
 *     PL_BLOCKS, PL_LARGEST      how many independent blocks; what x has of the largest.  Their states are those of
 *                                PL(block_state)[] from PL(block_first)[block] on.  0: what follows counts
 *     PL_SEGMENTS                of time, in which loads have their formulas
 *     PL_DEGREE, PL_HALVINGS     of a series: as in pl_series
 *     PL_CHANGING, PL_FIRST      columns of A that are others in each segment; the first of them
 *     PL_FORCED                  load states whose share the model leaves out of the state that it keeps
 *     PL_LOSES                   whether what is kept changes where their formulas do
 *
 *     PL(load_slope)[PL_SEGMENTS][PL_STATES][PL_CHANGING]   those columns
 *     PL(forced_at)[PL_FORCED][2]        places of such a load state in the next two, and in x
 *     PL(forced_part)[PL_SEGMENTS][PL_STATES][]     its share
 *     PL(forced_change)[][PL_STATES][]   what the state gains at each change
 *     PL(until)(s, change)               time from now to a change [s] */
#include "numbers.h"

#if PL_BLOCKS > 0

/* x goes on by tau [s], each block with all that acts on some */
static void PL(pass_blocks)(const real slope[PL_SIZE][PL_SIZE], real tau, real x[PL_SIZE])
{
    real part[PL_LARGEST], A[PL_LARGEST * PL_LARGEST], work[2 * PL_LARGEST];
    int block, i, j;
    pl_series series;
    series.degree = PL_DEGREE;
    series.halvings = PL_HALVINGS;
    series.A = A;
    for (block = 0; block < PL_BLOCKS; block++) {
        const unsigned short *const at = PL(block_state) + PL(block_first)[block];
        const int states = PL(block_first)[block + 1] - PL(block_first)[block];
        const int size = states + PL_SIZE - PL_STATES;
        for (i = 0; i < size; i++) {
            const int row = i < states ? at[i] : PL_STATES + i - states;
            part[i] = x[row];
            for (j = 0; j < size; j++) {
                A[size * i + j] = slope[row][j < states ? at[j] : PL_STATES + j - states];
            }
        }
        series.size = size;
        series.states = states;
        pl_series_advance(&series, tau, part, work);
        for (i = 0; i < (block + 1 < PL_BLOCKS ? states : size); i++) { /* what acts, behind the last that it acts on */
            x[i < states ? at[i] : PL_STATES + i - states] = part[i];
        }
    }
}

#else

#if PL_FORCED > 0
static void PL(add_forced)(const real share[PL_STATES][PL_LOAD_STATES], real x[PL_SIZE])
{
    int i, k;
    for (i = 0; i < PL_STATES; i++) {
        for (k = 0; k < PL_FORCED; k++) {
            x[i] += share[i][PL(forced_at)[k][0]] * x[PL(forced_at)[k][1]];
        }
    }
}
#endif

static void PL(use_segment)(real A[PL_SIZE][PL_SIZE], int segment)
{
#if PL_CHANGING > 0
    int i, j;
    for (i = 0; i < PL_STATES; i++) {
        for (j = 0; j < PL_CHANGING; j++) {
            A[i][PL_FIRST + j] = PL(load_slope)[segment][i][j];
        }
    }
#else
    (void)A;
    (void)segment;
#endif
}

#if PL_SEGMENTS > 1
#define PL_SEGMENT(s) (s)->segment
#else
#define PL_SEGMENT(s) 0
#endif

/* x goes on by tau [s]; `whole`: then to the state as it is known outside.  The segment in which that is */
static int PL(pass_changes)(const PL_TYPE *s, const real slope[PL_SIZE][PL_SIZE], int whole, real tau, real x[PL_SIZE])
{
    real A[PL_SIZE][PL_SIZE], work[2 * PL_SIZE], done = 0;
    int i, j, segment = PL_SEGMENT(s);
    pl_series series;
    for (i = 0; i < PL_SIZE; i++) {
        for (j = 0; j < PL_SIZE; j++) {
            A[i][j] = slope[i][j];
        }
    }
    series.size = PL_SIZE;
    series.states = PL_STATES;
    series.degree = PL_DEGREE;
    series.halvings = PL_HALVINGS;
    series.A = A[0];
#if PL_SEGMENTS > 1
    for (; segment < PL_SEGMENTS - 1 && PL(until)(s, segment) < tau; segment++) {
        const real ahead = PL(until)(s, segment);
        PL(use_segment)(A, segment);
        if (ahead > done) {
            pl_series_advance(&series, ahead - done, x, work);
            done = ahead;
        }
#if PL_LOSES
        PL(add_forced)(PL(forced_change)[segment], x);
#endif
    }
#endif
    PL(use_segment)(A, segment);
    pl_series_advance(&series, tau - done, x, work);
#if PL_FORCED > 0
    if (whole) {
        PL(add_forced)(PL(forced_part)[segment], x);
    }
#endif
    (void)s;
    (void)whole;
    return segment;
}

#endif

#include "undef.h"
