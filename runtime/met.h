/* SPDX-License-Identifier: MIT-0 */
/* met.h: impacts, contacts at rest and friction in a part of a step, part of event_split.h: of what is watched the
 * cubics through values and slopes at both ends are looked at as passage.h looks at the polynomials of a collocation;
 * at an event the law of events.c is asked of a series there.  What holds is a force like others of the remainder, to
 * the order of the scheme: behind each part what is held is put back. */

/* ---- where a part begins, and along it ---- */

static void PL(again)(const void *from, const int *interval, const real *y, real *c, real *terms)
{
    const PL(piece) *const p = (const PL(piece) *)from;
    PL(expand_from)(p->s, p->start, p->slope, p->done * PL_H, PL(when)(p), p->segment, interval, y,
                    (real (*)[PL_COLUMNS])c, terms);
}

static void PL(watch)(PL(piece) *p, real y[PL_STATES])
{
    int i;
    for (i = 0; i < PL_STATES; i++) {
        p->low[i] = 0;
    }
    PL(open)(&p->at, p->contact, y, p->low, p->law[0], p->terms, p->work);
    p->at.expand = PL(again);
    p->at.from = p;
}

/* Where the part begins; what is asked there is of a series. */
static void PL(stand)(PL(piece) *p)
{
    p->at.time = p->done * PL_H;
    p->at.c = p->law[0];
    p->at.terms = p->terms;
}

/* When the first event comes in a part of *size h, which may become less; below 0: none does.  c becomes polynomials,
 * that of what is held the constant as which it is put back. */
static real PL(look_along)(PL(piece) *p, real c[PL_WAY + 1][PL_TERMS], const real d[2][PL_TERMS],
                           real terms[PL_TERMS], real *size)
{
    int i, m;
    PL(make_cubics)(c, d, *size);
    for (i = 0; i < PL(along).holds; i++) {
        const pl_hold *const h = &PL(along).hold[i];
        for (m = 1; m <= PL_WAY && p->contact->interval[h->expression] == h->interval; m++) {
            c[m][h->expression] = 0;
        }
    }
    p->at.c = c[0];
    p->at.terms = terms;
    return pl_events_next(&PL(along), &p->at, size, &p->splits);
}

/* Where the search gave up: what is not finite may be why. */
static int PL(gave_up)(const PL(piece) *p)
{
    return PL_TOO_MANY_EVENTS | pl_not_finite(p->law[0], (PL_ORDER + 1) * PL_COLUMNS);
}

/* Onto the event that was found, from `at`, near it.  The way of a bounce that has just left its guard is known better
 * than its place. */
static real PL(onto_event)(const PL(piece) *p, real at, real size, real left, real y[PL_STATES])
{
    const pl_crossing *const e = &p->at.next, *const last = p->at.last;
    if (p->at.freed >= 0) {
        const pl_hold *const h = &PL(along).hold[p->at.freed];
        return PL(onto)(p, at, size, left, PL(events).watch[e->upward ? h->up : h->down], 0, 1, y);
    }
    if (p->at.starting >= 0 && PL(along).impact[p->at.starting].hold >= 0 && e->expression == last->expression &&
        e->breakpoint == last->breakpoint) {
        return 0;
    }
    return PL(onto)(p, at, size, left, PL(column)[e->expression], PL(breakpoint_of)(e), e->upward, y);
}

/* Puts back what was held and, as forces are polynomials in a part, has moved by the error of that; d: at its end.
 * Whether there was any */
static int PL(put_back)(const PL(contact) *contact, const real d[2][PL_TERMS], real y[PL_STATES])
{
    int i, k, any = 0;
    for (i = 0; i < PL(along).holds; i++) {
        const pl_hold *const h = &PL(along).hold[i];
        const real *const back = PL(along).back + (ptrdiff_t)i * PL_STATES;
        const real *const place = PL(along).place_back + (ptrdiff_t)(h->impact < 0 ? 0 : h->impact) * PL_STATES;
        const real speed = d[0][PL_SWITCHING_FUNCTIONS + h->velocity];
        const real off = h->impact < 0 ? 0 : d[0][PL_SWITCHING_FUNCTIONS + PL(along).impact[h->impact].place];
        if (contact->interval[h->expression] == h->interval) {
            any = 1;
            for (k = 0; k < PL_STATES; k++) {
                y[k] -= back[k] * speed + place[k] * off;
            }
        }
    }
    return any;
}

/* The next part, y at its start and then at its end: 0, PL_SHORTER, or what went wrong */
static int PL(go_on)(PL(piece) *p, real y[PL_STATES])
{
    real c[PL_WAY + 1][PL_TERMS], d[2][PL_TERMS], terms[PL_TERMS], spare[PL_TERMS], next[PL_STATES], to, size, end, met;
    int i, begun;
    PL(stand)(p);
    begun = pl_events_begin(&PL(events), &p->at);
    if (begun != 0) {
        return begun > 0 ? 0 : PL(gave_up)(p);
    }
    PL(look)(p, p->done, y, c, terms);
    to = p->limit - p->done < p->longest ? p->limit : p->done + p->longest;
    size = to - p->done;
    if (PL(advance)(p, size, y, next) != 0) {
        return PL(halve)(p, size);
    }
    PL(look)(p, to, next, d, spare);
    end = size;
    met = PL(look_along)(p, c, (const real (*)[PL_TERMS])d, terms, &end);
    if (p->splits < 0) {
        return PL(gave_up)(p);
    }
#if PL_FAST_PATH
    if (size > PL_CERTAIN && (met >= 0 || !PL(stays)((const real (*)[PL_TERMS])c, (const real (*)[PL_TERMS])d,
                                                     p->contact->interval, size, terms, PL_NOISE))) {
        p->longest = size / 2;
        return PL_SHORTER;
    }
#endif
    end = met >= 0 ? met : end;
    if (end > 0 && end < size) {
        if (PL(advance)(p, end, y, next) != 0) {
            return PL(halve)(p, end);
        }
        PL(look)(p, p->done + end, next, d, spare);
    }
    (void)PL(put_back)(p->contact, (const real (*)[PL_TERMS])d, next);
    if (met > 0) {
        end += PL(onto_event)(p, p->done + end, end, size - end, next);
    } else if (met < 0) {
        p->at.status |= pl_events_places(&PL(along), &p->at, end, 0);
        p->contact->last.expression = -1;
    }
    p->longest = PL_FAST_PATH && 2 * size < PL_LONGEST ? 2 * size : PL_LONGEST;
    for (i = 0; i < PL_STATES && end > 0; i++) {
        y[i] = next[i];
    }
    p->done = end < size ? p->done + end : to;
    if (met < 0) {
        return 0;
    }
    PL(stand)(p);
    return pl_events_pass(&PL(events), &p->at) ? 0 : PL(gave_up)(p);
}

/* ---- the step ---- */

/* Whether a step over all of h stands that comes near an event.  c, d: of its ends */
static PL_APART int PL(is_event_free)(PL(piece) *p, real c[PL_WAY + 1][PL_TERMS], const real d[2][PL_TERMS],
                                 real terms[PL_TERMS])
{
    real y[PL_STATES], end = 1, met;
    PL(watch)(p, y);
    met = PL(look_along)(p, c, d, terms, &end);
#if PL_FAST_PATH
    if (!PL(stays)((const real (*)[PL_TERMS])c, d, p->contact->interval, 1, terms, PL_NOISE)) {
        return 0;
    }
#endif
    return met < 0 && !(end < 1) && p->splits >= 0 && !pl_events_left(&PL(along), &p->at) &&
           pl_not_finite(p->s->y, PL_STATES) == 0;
}

/* The intervals of a state that was set */
static void PL(locate)(const PL_TYPE *s, const real u[], PL(contact) *contact)
{
    PL(piece) p;
    real y[PL_STATES];
    int i;
    for (i = 0; i < PL_STATES; i++) {
        y[i] = s->y[i];
    }
    PL(begin)(&p, s, u, contact);
    p.limit = PL(limit_of)(s, 0, 1, &p.segment);
    PL(watch)(&p, y);
    contact->placed = 1;
    pl_events_place(&PL(events), &p.at);
}
