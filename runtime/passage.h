/* SPDX-License-Identifier: MIT-0 */
/* passage.h: formulas that the state chooses beside a collocation, part of radau.h: a step is solved with those of its
 * start.  Each expression is a polynomial through its values at the start and the nodes; at its first root behind a
 * breakpoint the step ends, and is made anew with that length, since its end is more exact than its inside.  The
 * model's file defines beside what radau.h asks
 *
 *     PL(watch)(known, interval, y, value, terms)   the expressions at y; the sizes of what they are summed from
 *     PL(breaks), PL(breakpoint), PL(passing)       of each expression how many breakpoints, these, a pl_divided
 *
 * and a member contact. */

/* ---- the expressions where the internal step starts, and along it ---- */

/* Where it starts: c[0]; all further coefficients are 0 */
static void PL(values_here)(const PL_TYPE *s, const real start[], const real slope[],
                            real c[PL_STAGES + 1][PL_EXPRESSIONS], real terms[PL_EXPRESSIONS])
{
    real known[PL_ROOM(PL_KNOWN)];
    PL(no_slopes)(PL_EXPRESSIONS, c[0]);
    PL(known_at)(s, PL_WATCH_READS, start, slope, 0, (real)1e-9, known);
    PL(watch)(known, s->contact.interval, s->start, c[0], terms);
}

/* ... along a step of `size` h: polynomials through their values there and at the nodes */
static void PL(values_along)(const PL_TYPE *s, const real start[], const real slope[], real size,
                             const real poly[PL_STAGES + 1][PL_COLUMNS], real c[PL_STAGES + 1][PL_EXPRESSIONS],
                             real terms[PL_EXPRESSIONS])
{
    real y[PL_STATES], value[PL_EXPRESSIONS], spare[PL_EXPRESSIONS], known[PL_ROOM(PL_KNOWN)];
    int k;
    PL(values_here)(s, start, slope, c, terms);
    for (k = 0; k < PL_STAGES; k++) {
        PL(known_at)(s, PL_WATCH_READS, start, slope, PL(node)[k] * size, size / 2, known);
        PL(at_node)(s, poly, k, y);
        PL(watch)(known, s->contact.interval, y, value, spare);
        PL(add_node)(PL_EXPRESSIONS, k, value, c[0]);
    }
}

/* ---- between internal steps ---- */

#if PL_ORDER == 0
/* The intervals of a state that was set, by values; the first step then says where that goes which is on a breakpoint.
 * The interval of one expression may choose what another is. */
static void PL(locate)(PL_TYPE *s, const real start[], const real slope[])
{
    real c[PL_STAGES + 1][PL_EXPRESSIONS], terms[PL_EXPRESSIONS];
    int i, again = PL_CHANGES;
    for (i = 0; i < PL_EXPRESSIONS; i++) {
        s->contact.interval[i] = 0;
    }
    s->contact.last.expression = -1;
    s->contact.placed = -PL_CHANGES;
    do {
        PL(values_here)(s, start, slope, c, terms);
    } while (pl_divided_place(&PL(passing), c[0], terms, s->contact.interval) && again-- > 0);
}
#endif

/* Passes the breakpoint of contact.last, where the next internal step starts; 0: there were too many */
static int PL(pass_here)(PL_TYPE *s)
{
    s->ready = 0;
    return PL(cross)(&s->contact, PL(since)(s) * PL_H);
}

/* Whether an expression has left its interval where the next internal step starts: by a jump */
static int PL(left)(PL_TYPE *s, const real start[], const real slope[])
{
    real c[PL_STAGES + 1][PL_EXPRESSIONS], terms[PL_EXPRESSIONS];
    PL(values_here)(s, start, slope, c, terms);
    return pl_divided_left(&PL(passing), c[0], terms, s->contact.interval, &s->contact.last);
}

/* ---- the first crossing in a step ---- */

/* Moves the end of the step to theta, near 1, and from there to where what contact.last says passes its breakpoint b;
 * c: the expressions along the step.  The coefficients of a polynomial of many stages have more rounding than its
 * values at the nodes: what is on its breakpoint is the expression itself, at the state there. */
static void PL(move_end)(PL_TYPE *s, const real start[], const real slope[],
                         const real poly[PL_STAGES + 1][PL_COLUMNS], const real c[PL_STAGES + 1][PL_EXPRESSIONS],
                         real theta, real b)
{
    const real size = s->size;
    const int which = s->contact.last.expression;
    real whole[PL_STATES], y[PL_STATES], value[PL_EXPRESSIONS], spare[PL_EXPRESSIONS], known[PL_ROOM(PL_KNOWN)];
    int i, m, again;
    PL(within)(poly, 1, whole);
    for (i = 0; i < PL_STATES; i++) {
        whole[i] = s->gain[i] - whole[i];
    }
    for (again = 0;; again++) {
        real rate = 0, change;
        PL(within)(poly, theta, y);
        for (i = 0; i < PL_STATES; i++) {
            s->gain[i] = whole[i] + y[i];
            y[i] = s->start[i] + s->gain[i];
        }
        s->size = theta * size;
        if (again == 2) {
            return;
        }
        PL(known_at)(s, PL_WATCH_READS, start, slope, theta * size, size / 2, known);
        PL(watch)(known, s->contact.interval, y, value, spare);
        for (m = PL_STAGES; m > 0; m--) {
            rate = rate * theta + (real)m * c[m][which];
        }
        change = (b - value[which]) / rate;
        if (!(pl_magnitude(change) < PL_CORRECTION)) {
            return;
        }
        theta += change;
    }
}

/* Ends the step that was found at the first crossing in it, where there is one: 0, or what went wrong; PL_NO_MOVE: it
 * is at the start, so that nothing moves.  Near its start a polynomial may leave out more than what has just passed its
 * breakpoint has moved since: that comes back only if it does so along a shorter step too. */
static int PL(pass)(PL_TYPE *s, const real start[], const real slope[], const real jacobian[], real limit,
                    real unit[PL_STATES], real poly[PL_STAGES + 1][PL_COLUMNS])
{
    real c[PL_STAGES + 1][PL_EXPRESSIONS], terms[PL_EXPRESSIONS], k[PL_UNKNOWNS], work[PL_DIVIDED_WORK(PL_STAGES)];
    real theta, part, end = 1;
    pl_crossing crossing = s->contact.last;
    int splits = PL_MAX_SPLITS, again, back;
    for (again = 0;; again++) {
        PL(values_along)(s, start, slope, s->size, (const real (*)[PL_COLUMNS])poly, c, terms);
#if PL_ORDER == 0
        if (s->contact.placed < 0) {
            if (pl_divided_rises(&PL(passing), c[0], terms, s->contact.interval)) {
                s->contact.placed++;
                s->size = 0;
                return PL_NO_MOVE;
            }
            s->contact.placed = 1;
        }
#endif
        theta = pl_divided_next(&PL(passing), c[0], terms, s->contact.interval, end, &splits, &crossing, work);
        if (splits < 0) {
            return PL_TOO_MANY_EVENTS;
        }
        if (theta < 0) {
            s->contact.last.expression = -1;
            return 0;
        }
        back = crossing.expression == s->contact.last.expression && crossing.breakpoint == s->contact.last.breakpoint &&
               theta < (real)0.0625;
        if (again == 12 || theta > 1 - PL_NEAR || (!back && theta * s->size < PL_HERE)) {
            break;
        }
        part = back ? (real)0.0625 : theta;
        PL(continue)((const real (*)[PL_COLUMNS])poly, 0, part, 1 / (s->size * PL_H), k);
        if (!PL(solve)(s, start, slope, jacobian, part * s->size, unit, k)) {
            break;
        }
        s->size *= part;
        s->per = 1 / s->size;
        (void)PL(finish)(s->start, s->size * PL_H, unit, k, poly, s->gain);
        end = limit < (1 + PL_NEAR) * s->size ? limit / s->size : 1 + PL_NEAR;
    }
    s->contact.last = crossing;
    s->stop = PL_AT_CROSSING;
    s->ready = 0;
    if (theta * s->size < PL_HERE) {
        s->size = 0;
        return PL_NO_MOVE;
    }
    PL(move_end)(s, start, slope, (const real (*)[PL_COLUMNS])poly, (const real (*)[PL_EXPRESSIONS])c, theta,
                 PL(breakpoint_of)(&crossing));
    return 0;
}
