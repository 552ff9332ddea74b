/* SPDX-License-Identifier: MIT-0 */
/* passage.h: formulas that the state chooses beside a collocation, part of radau.h: a step is solved with those of its
 * start.  Each switching function is a polynomial through its values at the start and the nodes; at its first root
 * behind a breakpoint the step ends, and is made anew with that length, since its end is more exact than its inside.
 * The model's file defines beside what radau.h asks
 *
 *     PL(watch)(known, interval, y, value, terms)   the switching functions at y; the sizes of what they are summed
 *                                from
 *     PL(breaks), PL(breakpoint), PL(passing)   of each switching function how many breakpoints, these, a
 *                                pl_series_switching
 *
 * and a member contact.  Where there are impacts, contacts at rest and friction, what these are watched by stands
 * behind the switching functions, PL_TERMS in all, the first PL_WAYS by polynomials, and is looked for like them; what
 * happens at an event is the law of events.c, by the first terms of a series there.  The file defines
 *
 *     PL(expand_from)            as taylor.h, of order PL_EVENT_ORDER with PL_EVENT_COLUMNS columns
 *     PL(events), PL(along)      a pl_events of that series; of polynomials along a step
 *
 * and members chain and rested of contact.  placed is 1; 2 where what holds may have changed, 3 where that has just
 * been looked at. */

/* ---- the switching functions where the internal step starts, and along it ---- */

/* Where it starts: c[0]; all further coefficients are 0 */
static void PL(values_here)(const PL_TYPE *s, const real start[], const real slope[],
                            real c[PL_WAY + 1][PL_TERMS], real terms[PL_TERMS])
{
    real known[PL_ROOM(PL_KNOWN)];
    PL(no_slopes)(PL_WAY, PL_TERMS, c[0]);
    PL(known_at)(s, PL_WATCH_READS, start, slope, 0, (real)1e-9, known);
    PL(watch)(known, s->contact.interval, s->start, c[0], terms);
}

#if PL_CONTACTS
/* All states are solved for at once: what rounding makes of that grows with their number, and does not heed which
 * contact at rest bears much, and which none.  What flies bears nothing: by the sizes of its own pull it has
 * just left its guard, or is on its way back. */
static void PL(level_pulls)(const int interval[], real terms[PL_TERMS])
{
    const pl_events *const m = &PL(events);
    real *const size = &terms[PL_SWITCHING_FUNCTIONS], most = 0;
    int i, level;
    for (level = 0; level < 2; level++) {
        for (i = 0; i < 2 * m->holds; i++) {
            const pl_hold *const h = &m->hold[i / 2];
            const int watch = i % 2 ? h->up : h->down;
            if (watch >= 0 && h->impact >= 0 && interval[h->expression] == h->interval) {
                most = level == 0 && size[watch] > most ? size[watch] : most;
                size[watch] = level ? 8 * PL_STATES * most : size[watch];
            }
        }
    }
}
#endif

/* ... along a step, of which known has what is known at its nodes: polynomials through their values there and at the
 * nodes */
static void PL(values_along)(const PL_TYPE *s, const real start[], const real slope[],
                             const real known[PL_STAGES][PL_ROOM(PL_KNOWN)],
                             const real poly[PL_STAGES + 1][PL_COLUMNS], real c[PL_WAY + 1][PL_TERMS],
                             real terms[PL_TERMS])
{
    real y[PL_STATES], value[PL_TERMS], spare[PL_TERMS];
    int k;
    PL(values_here)(s, start, slope, c, terms);
    for (k = 0; k < PL_STAGES; k++) {
        PL(at_node)(s, poly, k, y);
        PL(watch)(known[k], s->contact.interval, y, value, spare);
        PL(add_node)(PL_TERMS, PL_WAYS, k, value, c[0]);
    }
#if PL_CONTACTS
    PL(level_pulls)(s->contact.interval, terms);
    PL(guards_along)(s->size * PL_H, c);
#endif
}

/* ---- between internal steps ---- */

#if PL_ORDER == 0 && !PL_CONTACTS
/* The intervals of a state that was set, by values; the first step then says where that goes which is on a breakpoint.
 * The interval of one switching function may choose what another is. */
static void PL(locate)(PL_TYPE *s, const real start[], const real slope[])
{
    real c[PL_WAY + 1][PL_TERMS], terms[PL_TERMS];
    int i, again = PL_CHANGES;
    for (i = 0; i < PL_SWITCHING_FUNCTIONS; i++) {
        s->contact.interval[i] = 0;
    }
    s->contact.last.expression = -1;
    s->contact.placed = -PL_CHANGES;
    do {
        PL(values_here)(s, start, slope, c, terms);
    } while (pl_series_switching_place(&PL(passing), c[0], terms, s->contact.interval) && again-- > 0);
}
#endif

#if PL_CONTACTS

typedef struct PL(meeting) { /* where the next internal step starts */
    struct PL_TYPE *s;
    const real *start, *slope;
    real when, c[PL_EVENT_ORDER + 1][PL_EVENT_COLUMNS], terms[PL_TERMS];
    real work[PL_EVENT_WORK(PL_EVENT_ORDER, PL_HELD, PL_STATES)];
    pl_instant at;
#if PL_MOVED
    real moved[PL_MOVED_WORK(PL_STATES, PL_MOVED)];
#endif
} PL(meeting);

static void PL(again)(const void *from, const int *interval, const real *y, real *c, real *terms)
{
    const PL(meeting) *const m = (const PL(meeting) *)from;
    PL(expand_from)(m->s, m->start, m->slope, m->at.time, m->when, PL(leg_of)(m->s), interval, y,
                    (real (*)[PL_EVENT_COLUMNS])c, terms);
}

static void PL(look_here)(PL(meeting) *m, PL_TYPE *s, const real start[], const real slope[])
{
    m->s = s;
    m->start = start;
    m->slope = slope;
    PL(open)(&m->at, &s->contact, s->start, s->low, m->c[0], m->terms, m->work);
    m->at.expand = PL(again);
    m->at.from = m;
#if PL_MOVED
    m->at.moved = m->moved;
#endif
    m->at.time = PL(since)(s) * PL_H;
    m->at.chain = s->contact.chain;
    m->when = PL(when)(s);
}

/* What has happened there: from the states behind it the next step starts anew. */
static void PL(look_on)(PL(meeting) *m)
{
    m->s->contact.chain = m->at.chain;
    m->s->status |= m->at.status;
    m->s->ready = 0;
    PL(measure)(m->s);
}

/* Passes the event of contact.last, where the next internal step starts; 0: there were too many */
static PL_APART int PL(pass_here)(PL_TYPE *s, const real start[], const real slope[])
{
    PL(meeting) m;
    int passed;
    PL(look_here)(&m, s, start, slope);
    pl_events_meet(&PL(events), &m.at, &s->contact.last);
    passed = pl_events_pass(&PL(events), &m.at);
    PL(look_on)(&m);
    return passed;
}

/* What holds where the next internal step starts, if it may be another than at the end of the last: 0, or
 * PL_ANOTHER: something has happened there, or PL_TOO_MANY_EVENTS */
static PL_APART int PL(look_again)(PL_TYPE *s, const real start[], const real slope[])
{
    PL(meeting) m;
    int changed;
    PL(look_here)(&m, s, start, slope);
    if (!s->contact.placed) {
        pl_events_place(&PL(events), &m.at);
    }
    changed = pl_events_begin(&PL(events), &m.at);
    PL(look_on)(&m);
    s->contact.placed = changed ? 2 : 3;
    return changed > 0 ? PL_ANOTHER : changed < 0 ? PL_TOO_MANY_EVENTS : 0;
}

static inline int PL(begin)(PL_TYPE *s, const real start[], const real slope[])
{
    return s->contact.placed == 0 || s->contact.placed == 2 ? PL(look_again)(s, start, slope) : 0;
}

#else

/* Passes the breakpoint of contact.last, where the next internal step starts; 0: there were too many */
static int PL(pass_here)(PL_TYPE *s, const real start[], const real slope[])
{
    (void)start;
    (void)slope;
    s->ready = 0;
    return PL(cross)(&s->contact, PL(since)(s) * PL_H);
}

/* Whether a switching function has left its interval where the next internal step starts: by a jump */
static int PL(left)(PL_TYPE *s, const real start[], const real slope[])
{
    real c[PL_WAY + 1][PL_TERMS], terms[PL_TERMS];
    PL(values_here)(s, start, slope, c, terms);
    return pl_series_switching_left(&PL(passing), c[0], terms, s->contact.interval, &s->contact.last);
}

#endif

/* ---- the first crossing in a step ---- */

typedef struct PL(search) { /* of a step */
    real c[PL_WAY + 1][PL_TERMS], terms[PL_TERMS], work[PL_SERIES_SWITCHING_WORK(PL_WAY)];
    pl_crossing found;
    int splits, exact; /* the guard of a bounce that has just left it: its way is known better than its place */
#if PL_CONTACTS
    pl_events along;
    pl_instant at;
#endif
} PL(search);

/* Whether what is found was passed last */
static inline int PL(is_last)(const PL(search) *f, const PL_TYPE *s)
{
    return f->found.expression == s->contact.last.expression && f->found.breakpoint == s->contact.last.breakpoint;
}

#if PL_CONTACTS

/* Looks for events along a step of `size` h. */
static void PL(look_along)(PL(search) *f, PL_TYPE *s)
{
    f->splits = PL_MAX_SPLITS;
    f->along = PL(along);
    f->along.h = s->size * PL_H;
    PL(open)(&f->at, &s->contact, s->start, s->low, f->c[0], f->terms, f->work);
    f->at.chain = s->contact.chain;
}

/* There is no step yet: what holds may be known by then, or not. */
static inline int PL(not_yet)(PL_TYPE *s, int placed)
{
    s->contact.placed = placed;
    s->size = 0;
    s->ready = 0;
    return PL_ANOTHER;
}

/* The size of the largest coordinate so far, or of the way of the largest velocity in a step of h */
static real PL(largest_place)(const PL_TYPE *s)
{
    real most = 0;
    int i;
    for (i = 0; i < PL_STATES; i++) {
        const real size = i < PL_COORDS ? s->scale[i] : PL_H * s->scale[i];
        most = size > most ? size : most;
    }
    return most;
}

#if PL_ORDER > 0
/* Up to the first event within `length` h of a series, where there is one, or not as far, as short flights say: 0, or
 * what went wrong; PL_NO_MOVE: it is here */
static int PL(end_at_crossing)(PL_TYPE *s, real terms[], real *length)
{
    real work[PL_SERIES_SWITCHING_WORK(PL_ORDER)], next;
    int splits = PL_MAX_SPLITS;
    pl_instant at;
    PL(open)(&at, &s->contact, s->start, s->low, s->poly[0], terms, work);
    at.chain = s->contact.chain;
    if (s->contact.placed < 3 && pl_events_left(&PL(events), &at)) {
        return PL(not_yet)(s, 2);
    }
    next = pl_events_next(&PL(events), &at, length, &splits);
    if (splits < 0) {
        return PL_TOO_MANY_EVENTS | pl_not_finite(s->poly[0], (PL_ORDER + 1) * PL_COLUMNS);
    }
    s->contact.placed = 1;
    if (next < 0) {
        s->contact.last.expression = -1;
        s->status |= pl_events_places(&PL(events), &at, *length, PL_TOLERANCE * PL(largest_place)(s));
        return 0;
    }
    s->contact.last = at.next;
    s->stop = PL_AT_CROSSING;
    *length = next;
    return next < PL_HERE ? PL_NO_MOVE : 0;
}
#endif

/* Where the first is, before *end, which may become less, as parts of the step; below 0: there is none */
static real PL(find_first)(PL(search) *f, const PL_TYPE *s, real *end)
{
    real theta;
    f->at.unit = s->size;
    f->along.h = s->size * PL_H;
    theta = pl_events_next(&f->along, &f->at, end, &f->splits);
    f->found = f->at.next;
    f->exact = f->at.starting >= 0 && PL(along).impact[f->at.starting].hold >= 0 && PL(is_last)(f, s);
    return theta;
}

/* What passes b there: a column of c */
static int PL(column_found)(const PL(search) *f, real *b)
{
    const pl_hold *const h = &PL(along).hold[f->at.freed < 0 ? 0 : f->at.freed];
    *b = f->at.freed < 0 ? PL(breakpoint_of)(&f->found) : 0;
    return f->at.freed < 0 ? f->found.expression : PL_SWITCHING_FUNCTIONS + (f->found.upward ? h->up : h->down);
}

#else

static void PL(look_along)(PL(search) *f, PL_TYPE *s)
{
    f->splits = PL_MAX_SPLITS;
    f->found = s->contact.last;
    f->exact = 0;
}

static real PL(find_first)(PL(search) *f, const PL_TYPE *s, const real *end)
{
    return pl_series_switching_next(&PL(passing), f->c[0], f->terms, s->contact.interval, *end, &f->splits, &f->found,
                                    f->work);
}

static int PL(column_found)(const PL(search) *f, real *b)
{
    *b = PL(breakpoint_of)(&f->found);
    return f->found.expression;
}

#endif

/* Moves the end of the step to theta, near 1, and from there to where what is found passes its breakpoint; f->c: the
 * switching functions along the step.  The coefficients of a polynomial of many stages have more rounding than its
 * values at the nodes: what is on its breakpoint is the switching function itself, at the state there. */
static void PL(move_end)(PL_TYPE *s, const real start[], const real slope[],
                         const real poly[PL_STAGES + 1][PL_COLUMNS], const PL(search) *f, real theta)
{
    const real size = s->size;
    real whole[PL_STATES], y[PL_STATES], value[PL_TERMS], spare[PL_TERMS], known[PL_ROOM(PL_KNOWN)], b;
    const int which = PL(column_found)(f, &b);
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
        if (again == 2 || f->exact) {
            return;
        }
        PL(known_at)(s, PL_WATCH_READS, start, slope, theta * size, size / 2, known);
        PL(watch)(known, s->contact.interval, y, value, spare);
        for (m = PL_WAY; m > 0; m--) {
            rate = rate * theta + (real)m * f->c[m][which];
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
                    real known[PL_STAGES][PL_ROOM(PL_KNOWN)], real unit[PL_STATES],
                    real poly[PL_STAGES + 1][PL_COLUMNS])
{
    PL(search) f;
    real k[PL_UNKNOWNS], theta, part, end = 1, till;
    int again, back, met;
    PL(look_along)(&f, s);
    for (again = 0;; again++) {
        PL(values_along)(s, start, slope, (const real (*)[PL_ROOM(PL_KNOWN)])known, (const real (*)[PL_COLUMNS])poly,
                         f.c, f.terms);
#if PL_CONTACTS
        if (s->contact.placed < 3 && pl_events_left(&f.along, &f.at)) {
            return PL(not_yet)(s, 2);
        }
        s->contact.placed = 3;
#elif PL_ORDER == 0
        if (s->contact.placed < 0) {
            if (pl_series_switching_rises(&PL(passing), f.c[0], f.terms, s->contact.interval)) {
                s->contact.placed++;
                s->size = 0;
                return PL_NO_MOVE;
            }
            s->contact.placed = 1;
        }
#endif
        till = end;
        theta = PL(find_first)(&f, s, &till);
        if (f.splits < 0) {
            return PL_TOO_MANY_EVENTS;
        }
        if (theta < 0 && !(till < end && till < 1)) {
            if (again) { /* shorter than what would have ended it; from far too short a part nothing goes on */
                s->stop = PL_AT_ERROR;
                s->ready = s->ready && s->want < (real)0x1p26 * s->size;
            }
            s->contact.last.expression = -1;
#if PL_CONTACTS
            s->contact.placed = 1;
            s->status |= pl_events_places(&f.along, &f.at, 1, PL_TOLERANCE * PL(largest_place)(s));
#endif
            return 0;
        }
        met = theta >= 0;
        theta = met ? theta : till;
        back = met && PL(is_last)(&f, s) && theta < (real)0.0625;
        if (met && (again == 12 || theta > 1 - PL_NEAR || (!back && theta * s->size < PL_HERE))) {
            break;
        }
        part = back ? (real)0.0625 : theta;
        PL(continue)((const real (*)[PL_COLUMNS])poly, 0, part, 1 / (s->size * PL_H), k);
        if (!PL(solve)(s, start, slope, jacobian, part * s->size, known, unit, k)) {
            if (met) {
                break;
            }
#if PL_CONTACTS
            s->want = part * s->size / 4;
            return PL(not_yet)(s, 1);
#endif
        }
        s->size *= part;
        s->per = 1 / s->size;
        (void)PL(finish)(s->start, s->size * PL_H, unit, k, poly, s->gain);
        end = limit < (1 + PL_NEAR) * s->size ? limit / s->size : 1 + PL_NEAR;
    }
    s->contact.last = f.found;
    s->stop = PL_AT_CROSSING;
    s->ready = 0;
#if PL_CONTACTS
    s->contact.placed = 1;
#endif
    if (theta * s->size < PL_HERE) {
        s->size = 0;
        return PL_NO_MOVE;
    }
    PL(move_end)(s, start, slope, (const real (*)[PL_COLUMNS])poly, &f, theta);
    return 0;
}
