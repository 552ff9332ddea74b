/* SPDX-License-Identifier: MIT-0 */
/* retuned.h: NAME_retune of a piecewise-linear model whose instances have tables of their own, as tunable params change
 * the matrices of its regions; and coefficients of them for event-free steps.  Included by the model's file, which
 * defines before it
 *
 *     PL(name), PL_SINGLE, PL_H          the model's prefix before a name; 1: in float; its step [s]
 *     PL_WRAPPED                         1: PL(retune) is the model's own, and calls PL(retune_all)
 *     PL_PARAMS, PL_SIZE, PL_STATES      sizes; of x; states, which x begins with
 *     PL_SWITCHING_FUNCTIONS, PL_BREAKS, PL_SEGMENTS   switching functions, breakpoints of all; segments of time of the
 *                                        loads
 *     PL_BRANCHES, PL(system)[]          linear systems that regions have; of each A in x' = A x, no places: it stays
 *     PL(segment)[]                      of each, the segment of time it is of, where there are several
 *     PL_OPERATIONS, PL(formulas)        by which all numbers follow from params
 *     PL_ROWS, PL(numbers)               rows over x that params change
 *     PL_BOUNDS                          1: some of these are rows that systems have bounds of
 *     PL(check)[2 PL_CHECKS]             a number that may not have any value, and which: 0: at least 0, 1: at most 1,
 *                                        too, 2: above 0, 3: below 0
 *     PL_FROM, PL(from)[]                per row of an instance's tables where it is found among the numbers, from 1;
 *                                        below 0: with the other sign, 0: it stays. 0: all do
 *     PL_COLUMNS_D                       derivatives, whose tables are an instance's too; 0: none
 *     PL(vary_params)(params, by)        how params vary with each column
 *     PL(varied_number)[]                of each, where the derivative of a number goes: the row is an entry of
 *                                        c->varied, which PL(varied_first)[] divides as pl_variation says
 *     PL_STEPS_D                         1: those of e^{A h} are c->varied_step
 *     PL_HALVINGS, PL_RUNGS              of pl_region_of: most; rungs
 *     PL(first_rung)[]                   of each linear system
 *     PL_GUARDS, PL_GUARD_ROWS, PL_VALUES, PL_IMPACTS, PL_FRICTION_FORCES   of friction and impacts: guards, their
 *                                        rows, what is held, impacts in all segments of time, what friction carries;
 *                                        else 0
 *     PL(guard_branch)[], PL(guard_rung)[] of rows of guards
 *     PL_BOUNDED, PL(bounded)[]          columns of x that are never above 1
 *     PL_EVENT_FREE                          1: event-free steps need no search, for which
 *     PL_STAYS, PL(stays)[], PL(stay_param)[]    columns of x stay; which param each is, -1: 1
 *     PL_PAIRS, PL(pair)[]               loads oscillate, the first column of each; the next is its other one
 *     PL_STILL                           1: steps are looked at that stay still
 *     PL(breaks)[]                       breakpoints of each switching function
 *     PL_LARGE, PL_FOLDED, PL_OPEN_END   what no number may pass; root of 2 less 1; of intervals without end */
#include "numbers.h"

#if PL_CHECKS > 0
static int PL(out_of_range)(const pl_two *value)
{
    int i, out = 0;
    for (i = 0; i < PL_CHECKS; i++) {
        const real number = value[PL(check)[2 * i] * PL_SIZE].hi;
        const int kind = PL(check)[2 * i + 1];
        out |= kind < 2 ? number < 0 || (kind == 1 && number > 1) : kind == 2 ? !(number > 0) : !(number < 0);
    }
    return out;
}
#endif

#if PL_FROM > 0
/* ---- into the tables ---- */

/* The next of them, `rows` of so many columns, into a table; what is behind them in from[] */
static PL_APART const short *PL(take)(const short *from, int rows, int columns, const pl_two *value, real *to)
{
    int i;
    for (; rows > 0; rows--, from++) {
        const int sign = *from < 0 ? -1 : 1;
        const pl_two *const row = value + (*from != 0 ? sign * *from - 1 : 0) * PL_SIZE;
        for (i = 0; i < columns; i++, to++) {
            if (*from != 0) {
                *to = (real)sign * row[i].hi + 0; /* no -0 */
            }
        }
    }
    return from;
}

#if PL_GUARD_ROWS > 0
#if PL_BOUNDED > 0
/* The sizes of a row's factors of what is never above 1 */
static real PL(amplitude)(const real *row)
{
    real sum = 0;
    int j;
    for (j = 0; j < PL_BOUNDED; j++) {
        sum += pl_magnitude(row[PL(bounded)[j]]);
    }
    return sum;
}
#endif

static const short *PL(take_guards)(PL(coeffs) *c, const short *from, const pl_two *value)
{
    int i;
    from = PL(take)(from, PL_GUARD_ROWS, PL_SIZE, value, c->guard_row[0]);
    from = PL(take)(from, PL_GUARDS, 1, value, c->limit);
    from = PL(take)(from, PL_VALUES, PL_SIZE, value, c->value[0]);
    for (i = 0; i < PL_IMPACTS; i++) {
        from = PL(take)(from, 1, 1, value, &c->impact[i].restitution);
        from = PL(take)(from, 1, PL_SIZE, value, c->speed[i]);
        from = PL(take)(from, 1, PL_SIZE, value, c->retreat[i]);
    }
#if PL_BOUNDED > 0
    for (i = 0; i < PL_SEGMENTS * PL_SWITCHING_FUNCTIONS; i++) {
#if PL_SEGMENTS > 1
        c->amplitude[i] = PL(amplitude)(c->row[i / PL_SWITCHING_FUNCTIONS][i % PL_SWITCHING_FUNCTIONS]);
#else
        c->amplitude[i] = PL(amplitude)(c->row[i]);
#endif
    }
    for (i = 0; i < PL_GUARD_ROWS; i++) {
        c->guard_amplitude[i] = PL(amplitude)(c->guard_row[i]);
    }
    for (i = 0; i < PL_IMPACTS; i++) {
        c->impact[i].amplitude = PL(amplitude)(c->speed[i]);
    }
#endif
    return from;
}
#endif

static void PL(take_all)(PL(coeffs) *c, const pl_two *value)
{
    const short *from = PL(from);
#if PL_SEGMENTS > 1
    from = PL(take)(from, PL_SEGMENTS * PL_SWITCHING_FUNCTIONS, PL_SIZE, value, c->row[0][0]);
#else
    from = PL(take)(from, PL_SWITCHING_FUNCTIONS, PL_SIZE, value, c->row[0]);
#endif
    from = PL(take)(from, PL_BREAKS, 1, value, c->breakpoint);
#if PL_GUARD_ROWS > 0
    from = PL(take_guards)(c, from, value);
#endif
#if PL_FRICTION_FORCES > 0
    from = PL(take)(from, PL_FRICTION_FORCES, PL_SIZE, value, c->friction_forces[0][0]);
#endif
    (void)from;
}

#endif

/* ---- matrices ---- */

/* e^{A d} of one system */
static int PL(matrices)(PL(coeffs) *c, int k, const real params[PL_PARAMS], const pl_two *made, real h)
{
    pl_two A[PL_SIZE * PL_SIZE], work[PL_REGION_WORK(PL_SIZE)];
    int status = pl_entries_at(&PL(system)[k], &PL(formulas), params, made, A);
    if (status == 0) {
        status = pl_region_of(PL_SIZE, A, h, PL_HALVINGS, PL_RUNGS, &c->halvings[k], &c->spacing[k], c->slopes[k][0],
                              c->pieces[k][0], c->rungs[PL(first_rung)[k]][0], work);
    }
#if PL_EVENT_FREE
    if (status == 0) {
        c->large[k] = pl_region_large(PL_SIZE, c->halvings[k], c->pieces[k][0], PL_LARGE);
    }
#endif
    return status;
}

/* ---- bounds ---- */

#if PL_GUARD_ROWS > 0
/* Of the rows of guards that are a system's; they stand together */
static void PL(bound_guard_rows)(PL(coeffs) *c, int k, real h, real d, real *room)
{
    int first, last;
    for (first = 0; first < PL_GUARD_ROWS; first = last) {
        const int own = PL(guard_branch)[first] == k;
        for (last = first + 1; last < PL_GUARD_ROWS && PL(guard_branch)[last] == PL(guard_branch)[first]; last++) {
        }
        if (own) {
            pl_region_bounds(PL_SIZE, d, c->slopes[k][0], last - first, c->guard_row[first], c->guard_tangent[first],
                             c->guard_chord_error[first], c->guard_cubic_error[first], room);
        }
        for (; own && first < last; first++) {
            pl_region_reach(PL_SIZE, h, c->halvings[k], c->spacing[k], c->slopes[k][0], 1, c->guard_row[first],
                            c->bend[PL(guard_rung)[first]], room);
        }
    }
}
#endif

static void PL(bound)(PL(coeffs) *c, int k, real h)
{
    const real d = h / (real)((uint32_t)1 << c->halvings[k]);
    real room[PL_REACH_WORK(PL_SIZE, PL_SWITCHING_FUNCTIONS)];
#if PL_GUARD_ROWS > 0 || PL_EVENT_FREE
    real spare[2][PL_SWITCHING_FUNCTIONS * PL_SIZE];
#endif
#if PL_SEGMENTS > 1
    const real *const row = c->row[PL(segment)[k]][0];
#else
    const real *const row = c->row[0];
#endif
#if PL_GUARD_ROWS > 0
    pl_region_bounds(PL_SIZE, d, c->slopes[k][0], PL_SWITCHING_FUNCTIONS, row, c->tangent[k][0], spare[0], spare[1],
                     room);
    PL(bound_guard_rows)(c, k, h, d, room);
#else
    pl_region_bounds(PL_SIZE, d, c->slopes[k][0], PL_SWITCHING_FUNCTIONS, row, c->tangent[k][0], c->chord_error[k][0],
                     c->cubic_error[k][0],
                     room);
    pl_region_reach(PL_SIZE, h, c->halvings[k], c->spacing[k], c->slopes[k][0], PL_SWITCHING_FUNCTIONS, row,
                    c->bend[PL(first_rung)[k] * PL_SWITCHING_FUNCTIONS], room);
#endif
#if PL_EVENT_FREE
    if (c->halvings[k] == 1) {
        pl_region_bounds(PL_SIZE, h, c->slopes[k][0], PL_SWITCHING_FUNCTIONS, row, spare[0], c->chord_off[k][0],
                         spare[1], room);
    }
    if (c->halvings[k] == 0) {
        int i, j;
        for (i = 0; i < PL_SWITCHING_FUNCTIONS; i++) {
            for (j = 0; j < PL_SIZE; j++) {
                c->chord_off[k][i][j] = c->chord_error[k][i][j];
            }
        }
    }
#endif
}

/* ---- event-free steps: what stays of x from step to step summed, bounds over what is never above 1 ---- */

#if PL_EVENT_FREE
#if PL_STILL
/* At least the root of a^2 + b^2 */
static real PL(folded)(real a, real b)
{
    return a > b ? a + PL_FOLDED * b : b + PL_FOLDED * a;
}

/* What one system adds to the states, and how far switching functions may be off their chords */
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
    for (i = 0; i < PL_SWITCHING_FUNCTIONS; i++) {
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
    for (i = 0; i < PL_SWITCHING_FUNCTIONS; i++) {
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
#endif

#if PL_COLUMNS_D > 0
/* ---- derivatives of the tables: those of the formulas ---- */

static int PL(take_varied)(PL(coeffs) *c, const real params[PL_PARAMS], const pl_two *made)
{
    pl_two slope[PL_OPERATIONS + 1];
    real by[PL_COLUMNS_D][PL_PARAMS];
    int p, i, status = 0;
    PL(vary_params)(params, by);
    for (p = 0; p < PL_COLUMNS_D; p++) {
        const pl_entries *const to = &PL(varied_number)[p];
        if (to->places > 0) {
            pl_formulas_slope(&PL(formulas), params, made, by[p], slope);
        }
        for (i = 0; i < to->places; i++) {
            const real value = pl_entries_slope(to->place + i, &PL(formulas), by[p], slope);
            c->varied[to->place[i].row].value = value;
            status = value - value == 0 ? status : PL_NOT_FINITE;
        }
    }
    return status;
}

#if PL_STEPS_D
/* Of e^{A h} of system k by column p: it stands in the lower rows of that of [A, 0; A_p, A] (Van Loan 1978), A_p in
 * units of its largest number */
static int PL(take_varied_step)(PL(coeffs) *c, int p, int k)
{
    enum { TWICE = 2 * PL_SIZE };
    const int *const first = PL(varied_first) + p * (PL_BRANCHES + 5) + k;
    real *const over = c->varied_step[p * PL_BRANCHES + k];
    pl_two Z[TWICE * TWICE], D[TWICE * TWICE], work[PL_INCREMENT_WORK(TWICE)];
    real most = 0;
    int i, j, status;
    for (i = 0; i < TWICE * TWICE; i++) {
        const int row = i / TWICE, column = i % TWICE;
        Z[i].lo = 0;
        Z[i].hi = row / PL_SIZE == column / PL_SIZE ? c->slopes[k][row % PL_SIZE][column % PL_SIZE] : 0;
    }
    for (i = first[0]; i < first[1]; i++) {
        most = pl_magnitude(c->varied[i].value) > most ? pl_magnitude(c->varied[i].value) : most;
    }
    for (i = first[0]; i < first[1] && most > 0; i++) {
        Z[(PL_SIZE + c->varied[i].row) * TWICE + c->varied[i].column].hi = c->varied[i].value / most;
    }
    status = most > 0 ? pl_increment(TWICE, TWICE, Z, PL_H, 1, D, work) : 0;
    for (i = 0; i < PL_SIZE && status == 0; i++) {
        for (j = 0; j < PL_SIZE; j++) {
            over[i * PL_SIZE + j] = most > 0 ? most * D[(PL_SIZE + i) * TWICE + j].hi : 0;
        }
    }
    return status;
}
#endif
#endif

/* ---- all ---- */

#if PL_WRAPPED
static int PL(retune_all)(PL(coeffs) *c, const real params[PL_PARAMS], real h)
#else
int PL(retune)(PL(coeffs) *c, const real params[PL_PARAMS], real h)
#endif
{
    PL(coeffs) fresh = PL(nominal);
    pl_two made[PL_OPERATIONS + 1];
#if PL_ROWS > 0
    pl_two value[PL_ROWS * PL_SIZE];
#endif
    int i, status;
    if (h != PL_H) {
        return PL_NO_STEP;
    }
    status = pl_formulas_at(&PL(formulas), params, made);
#if PL_ROWS > 0
    if (status == 0) {
        status = pl_entries_at(&PL(numbers), &PL(formulas), params, made, value);
    }
#endif
#if PL_CHECKS > 0
    if (status == 0 && PL(out_of_range)(value)) {
        status = PL_OUT_OF_RANGE;
    }
#endif
#if PL_COLUMNS_D > 0
    if (status == 0) {
        status = PL(take_varied)(&fresh, params, made);
    }
#endif
    if (status != 0) {
        return status;
    }
    for (i = 0; i < PL_PARAMS; i++) {
        fresh.params[i] = params[i];
    }
#if PL_FROM > 0
    PL(take_all)(&fresh, value);
#endif
    for (i = 0; i < PL_BRANCHES; i++) {
        const int changes = PL(system)[i].places > 0;
        if (changes) {
            status = PL(matrices)(&fresh, i, params, made, h);
        }
        if (status != 0) {
            return status;
        }
        if (PL_BOUNDS || changes) {
            PL(bound)(&fresh, i, h);
        }
    }
#if PL_COLUMNS_D > 0 && PL_STEPS_D
    for (i = 0; i < PL_COLUMNS_D * PL_BRANCHES && status == 0; i++) {
        status = PL(take_varied_step)(&fresh, i / PL_BRANCHES, i % PL_BRANCHES);
    }
    if (status != 0) {
        return status;
    }
#endif
#if PL_EVENT_FREE
    PL(gather)(&fresh);
#endif
    *c = fresh;
    return 0;
}

#include "undef.h"
