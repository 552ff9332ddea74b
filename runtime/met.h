/* SPDX-License-Identifier: MIT-0 */
/* met.h: what a part of a step meets, part of event_split.h.  Crossings of breakpoints are those of cubics through
 * values and slopes at both ends.  Impacts, contacts at rest and friction are looked for on the same cubics, as
 * passage.h looks at the polynomials of a collocation; at an event the law of events.c is asked of a series there.
 * What holds is a force like others of the remainder, to the order of the scheme: behind each part what is held is put
 * back. */

#if !PL_CONTACTS
#define PL_LET_GO(p) 0 /* nothing is held */

/* What happens where a part begins: 0, and c is what is watched there; 1: it begins anew; below 0: there is too much */
static int PL(begin_part)(PL(piece) *p, const real y[PL_STATES], real c[PL_WAY + 1][PL_TERMS], real terms[PL_TERMS])
{
	PL(look)(p, p->done, y, c, terms);
	if (!pl_series_switching_left(&PL(passing), c[0], terms, p->contact->interval, &p->contact->last)) {
		return 0;
	}
	return PL(cross)(p->contact, p->done * PL_H) ? 1 : -1;
}

/* When, in a part of *size h, a switching function first leaves its interval; below 0: none does */
static real PL(meets)(PL(piece) *p, real c[PL_WAY + 1][PL_TERMS], const real d[2][PL_TERMS],
					  const real terms[PL_TERMS], const real *size)
{
	real work[PL_EVENT_WORK(3, PL_HELD, PL_STATES)];
	PL(make_cubics)(c, d, *size);
	p->found = p->contact->last;
	return pl_series_switching_next(&PL(passing), c[0], terms, p->contact->interval, *size, &p->splits, &p->found,
									work);
}

static inline int PL(gave_up)(const PL(piece) *p)
{
	(void)p;
	return PL_TOO_MANY_EVENTS;
}

static inline real PL(onto_event)(const PL(piece) *p, real at, real size, real left, real y[PL_STATES])
{
	return PL(onto)(p, at, size, left, PL(column)[p->found.expression], PL(breakpoint_of)(&p->found),
			p->found.upward,
					y);
}

/* Where the part ends: met, there is what it meets */
static inline int PL(end_part)(PL(piece) *p, real size, int met)
{
	(void)size;
	p->contact->last = p->found;
	if (!met) {
		p->contact->last.expression = -1;
		return 1;
	}
	return PL(cross)(p->contact, p->done * PL_H);
}

#else

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
#if PL_MOVED
	p->at.moved = p->moved;
#endif
}

/* Where the part begins; what is asked there is of a series. */
static void PL(stand)(PL(piece) *p)
{
	p->at.time = p->done * PL_H;
	p->at.c = p->law[0];
	p->at.terms = p->terms;
}

/* What happens there: 0, and c is what is watched there; 1: it begins anew; below 0: there is too much */
static int PL(begin_part)(PL(piece) *p, const real y[PL_STATES], real c[PL_WAY + 1][PL_TERMS], real terms[PL_TERMS])
{
	int begun;
	PL(stand)(p);
	begun = pl_events_begin(&PL(events), &p->at);
	if (begun == 0) {
		PL(look)(p, p->done, y, c, terms);
	}
	return begun;
}

/* When the first event comes in a part of *size h, which may become less; below 0: none does.  c becomes polynomials,
 * that of what is held the constant as which it is put back. */
static real PL(meets)(PL(piece) *p, real c[PL_WAY + 1][PL_TERMS], const real d[2][PL_TERMS],
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

#if PL_MOVED
/* The derivatives of what this one holds */
static void PL(put_moved_back)(int hold, const real d[2][PL_TERMS], real y[PL_STATES])
{
	const real *const value = d[0] + PL_SWITCHING_FUNCTIONS;
	const int impact = PL(along).hold[hold].impact;
	int p, k;
	for (p = 0; p < PL_MOVED; p++) {
		const ptrdiff_t row = (ptrdiff_t)hold * PL_MOVED + p;
		const real *const back = PL(moved).back + 2 * row * PL_STATES;
		const real speed = value[PL(moved).velocity[row]];
		const real off = impact < 0 ? 0 : value[PL(moved).place[impact * PL_MOVED + p]];
		for (k = 0; k < PL_STATES; k++) {
			y[k] -= back[k] * speed + back[PL_STATES + k] * off;
		}
	}
}
#endif

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
#if PL_MOVED
			PL(put_moved_back)(i, d, y);
#endif
		}
	}
	return any;
}

/* Where the part ends: met, there is an event */
static int PL(end_part)(PL(piece) *p, real size, int met)
{
	if (!met) {
		p->at.status |= pl_events_places(&PL(along), &p->at, size, 0);
		p->contact->last.expression = -1;
		return 1;
	}
	PL(stand)(p);
	return pl_events_pass(&PL(events), &p->at);
}

#define PL_LET_GO(p) pl_events_left(&PL(along), &(p)->at) /* whether what is held is let go */

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

#endif
