/* SPDX-License-Identifier: MIT-0 */
/* jump.h: a linear model over many steps by powers of the matrix of one, in two words, from change to change of its
 * loads.  Included by the file of the model, which defines before it
 *
 *     PL(name), PL_SINGLE        the prefix of the model before a name; 1: in float
 *     PL_TYPE                    the model, with members y, with segments segment, with low words rest or carry
 *     PL_STATES, PL_SIZE         the states; with the load states that a step reads
 *     PL_SEGMENTS                of time, in which loads have their formulas
 *     PL_BLOCKS                  1: PL(leap) is there already, by independent blocks
 *     PL_CONVERTED               1: what is kept are not the states: PL(kept_state)(s, y) and PL(keep_state)(s, y)
 *     PL_KEPT                    1: of each state what rounding took is in s->rest
 *     PL_CARRIES                 of so many, PL(carried)[], it is in s->carry
 *     PL_PHI                     the name of the transfer matrix; PL(Phi_low) has its second words
 *     PL_ENTRIES                 of the load states beside it: PL(power_entry)[], {segment, row, column, value}
 *     PL_H                       step [s]
 *
 *     PL(leap_loads)(s, load)    the load states now
 *     PL(pass_steps)(s, n)       loads and time pass n steps
 *     PL(until)(s, change)       time from now to a change [s] */
#include "numbers.h"

#if !PL_BLOCKS
static void PL(first_power)(const PL_TYPE *s, pl_two power[PL_SIZE * PL_SIZE])
{
    int i, j;
    for (i = 0; i < PL_SIZE * PL_SIZE; i++) {
        power[i].hi = 0;
        power[i].lo = 0;
    }
    for (i = 0; i < PL_STATES; i++) {
        for (j = 0; j < PL_STATES; j++) {
            power[PL_SIZE * i + j].hi = PL_PHI[i][j];
            power[PL_SIZE * i + j].lo = PL(Phi_low)[i][j];
        }
    }
#if PL_ENTRIES > 0
    for (i = 0; i < PL_ENTRIES; i++) {
#if PL_SEGMENTS > 1
        if (PL(power_entry)[i].segment != s->segment) {
            continue;
        }
#endif
        power[PL_SIZE * PL(power_entry)[i].row + PL(power_entry)[i].column] = PL(power_entry)[i].value;
    }
#endif
    (void)s;
}

static void PL(leap_from)(const PL_TYPE *s, pl_two x[PL_SIZE])
{
    int i;
#if PL_CONVERTED
    real y[PL_STATES];
    PL(kept_state)(s, y);
#else
    const real *const y = s->y;
#endif
    for (i = 0; i < PL_STATES; i++) {
        x[i].hi = y[i];
#if PL_KEPT
        x[i].lo = s->rest[i];
#else
        x[i].lo = 0;
#endif
    }
#if PL_CARRIES > 0
    for (i = 0; i < PL_CARRIES; i++) {
        x[PL(carried)[i]].lo = s->carry[i];
    }
#endif
#if PL_SIZE > PL_STATES
    PL(leap_loads)(s, x + PL_STATES);
#endif
}

static void PL(leap_to)(PL_TYPE *s, const pl_two x[PL_SIZE])
{
    int i;
#if PL_CONVERTED
    real y[PL_STATES];
    for (i = 0; i < PL_STATES; i++) {
        y[i] = x[i].hi;
    }
    PL(keep_state)(s, y);
#else
    for (i = 0; i < PL_STATES; i++) {
        s->y[i] = x[i].hi;
#if PL_KEPT
        s->rest[i] = x[i].lo;
#endif
    }
#endif
#if PL_CARRIES > 0
    for (i = 0; i < PL_CARRIES; i++) {
        s->carry[i] = x[PL(carried)[i]].lo;
    }
#endif
}

/* n steps without a change of the loads */
static void PL(leap)(PL_TYPE *s, uint64_t n)
{
    pl_two power[PL_SIZE * PL_SIZE], work[PL_SIZE * PL_SIZE], x[PL_SIZE], w[PL_SIZE];
    PL(first_power)(s, power);
    PL(leap_from)(s, x);
    pl_power_apply(PL_SIZE, power, work, x, w, n);
    PL(leap_to)(s, x);
    PL(pass_steps)(s, n);
}
#endif

/* Leaps up to one step before each change of the loads, and steps across it. */
void PL(jump)(PL_TYPE *s, uint64_t n)
{
#if PL_SEGMENTS > 1
    while (n > 0 && s->segment < PL_SEGMENTS - 1) {
        const real ahead = PL(until)(s, s->segment) / PL_H - 1;
        const uint64_t free = ahead < 1 ? 0 : ahead < (real)n ? (uint64_t)ahead : n;
        if (free > 0) {
            PL(leap)(s, free);
            n -= free;
        } else {
            PL(step)(s);
            n--;
        }
    }
    if (n == 0) {
        return;
    }
#endif
    PL(leap)(s, n);
}

#include "undef.h"
