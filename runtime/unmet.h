/* SPDX-License-Identifier: MIT-0 */
/* unmet.h: a step of a model with friction or impacts that meets none of the guards of its region, by the tables of its
 * search: part of search.h, and for small processors of guards.c.  The search would take the same one, to the last bit:
 * sums have its order, and what is accepted here leaves nothing to take up, nothing that touches, and each guard below
 * its limit by the bound of the search.  A guard that has just been left, and one that a cubic alone clears, goes by
 * the search.  PL_SUM(row, x) is of PL_SIZE products; bit i of PL_CAPPED is set where x_i is never above 1. */

/* Whether what a set holds is where it is held; at the end it is put there, all from the same x.  place: size */
static PL_INLINE int PL(holds)(const pl_guards *m, int set, const double *x, double *end, double *place)
{
    const int first = m->set[set], last = m->set[set + 1];
    int k;
    PL_EACH
    for (k = first; k < last; k++) {
        const double *const value = m->value + k * PL_SIZE;
        if (!(pl_magnitude(PL_SUM(value, x) - x[m->state[k]]) <= 0.0)) {
            return 0;
        }
        place[k - first] = 0.0 + PL_SUM(value, end);
    }
    PL_EACH
    for (k = first; k < last; k++) {
        end[m->state[k]] = place[k - first];
    }
    return 1;
}

/* Whether guard k keeps below its limit from x to end: by its chord, h^2/8 of its second derivative, and what rounding
 * may hide at the start, 9 units in the last place of all terms; those of x are in the table */
static PL_INLINE int PL(keeps)(const pl_guards *m, int k, const double *x, const double *end, const double *size)
{
    const int row = m->guard[k].row;
    const double from = PL_SUM(m->guard_row + row * PL_SIZE, x), to = PL_SUM(m->guard_row + row * PL_SIZE, end);
    const double off = PL_SUM(m->chord_error + row * PL_SIZE, size);
    return (from > to ? from : to) + off < m->limit[k] - 2e-15 * (pl_magnitude(m->limit[k]) + m->guard_amplitude[row]);
}

/* Row i of a product, with 0 in the place of -0 as the search has it.  Where what multiplies x_i is above 0 there is no
 * -0 unless x_i was one; the addition that is spared there is one of the few that the next step waits for. */
static PL_INLINE double PL(row_of)(const pl_guards *m, const double *matrix, int i, const double *x)
{
    const double sum = PL_SUM(matrix + i * PL_SIZE, x);
    (void)m; /* which a sum that is written out does not read */
    return matrix[i * PL_SIZE + i] > 0.0 ? sum : 0.0 + sum;
}

/* x over h in a region to end, and whether it is sure that nothing is met.  size, place: for sizes of x, and work */
static PL_INLINE int PL(keeps_all)(const pl_guards *m, int region, const double *x, double *end, double *size,
                                   double *place)
{
    const int which = m->matrix[region], set = m->hold[region];
    double all = -0.0; /* which adds nothing: a compiler need not add it */
    int i;
    if (which < 0 || (PL_SOFT && pl_not_finite(x, PL_SIZE))) {
        return 0;
    }
    PL_EACH
    for (i = 0; i < PL_SIZE; i++) {
        const int capped = i < 31 && (PL_CAPPED >> i) % 2 == 1;
        end[i] = PL(row_of)(m, m->Phi + which * PL_SIZE * PL_SIZE, i, x);
        size[i] = capped ? 1.0 : pl_magnitude(x[i]);
        all += PL_SOFT || capped ? -0.0 : size[i];
    }
    if (!(all < 1e300) || (set >= 0 && !PL(holds)(m, set, x, end, place))) {
        return 0;
    }
    PL_EACH
    for (i = m->first[region]; i < m->first[region + 1]; i++) {
        if (!PL(keeps)(m, i, x, end, size)) {
            return 0;
        }
    }
    return 1;
}
