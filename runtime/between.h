/* SPDX-License-Identifier: MIT-0 */
/* between.h: part of taylor.h: a step whose series is made anew on the way, as it serves a part of it, the loads change
 * their formulas, or the state meets what chooses formulas, an impact, a contact at rest, friction. */

#if PL_SWITCHING_FUNCTIONS > 0
#define PL_MET PL(contact)
#define PL_MET_BY(s) (&(s)->contact)
#define PL_INTERVAL p->contact->interval
#else
#define PL_MET void
#define PL_MET_BY(s) NULL
#define PL_INTERVAL NULL
#endif
#define PL_LEAST_PART ((real)1e-9) /* of a step: none shorter is tried because of slopes */

typedef struct PL(piece) { /* a part of a step */
	const struct PL_TYPE *s;
	real *y, *low;         /* the state, and what rounding took from it, `done` after the start of the step [h] */
	real c[PL_ORDER + 1][PL_COLUMNS], terms[PL_ROOM(PL_TERMS)]; /* the series from there */
	real start[PL_ROOM(PL_INPUTS)], slope[PL_ROOM(PL_INPUTS)];
	real done, limit;      /* the loads change there, or the step ends */
	real longest;          /* that is tried; */
	int fresh;             /* nothing is known of how long it may be */
	int segment, parts;
#if PL_SWITCHING_FUNCTIONS > 0
	PL(contact) *contact;
	real work[PL_EVENT_WORK(PL_ORDER, PL_HELD, PL_STATES)];
	int splits;
#endif
#if PL_CONTACTS
	real tau, when;        /* where a series begins, after now; between then and its end */
	pl_instant at;
#if PL_MOVED
	real moved[PL_MOVED_WORK(PL_STATES, PL_MOVED)];
#endif
#endif
} PL(piece);

/* A time by which conditions on t are decided from there on */
static inline real PL(when)(const PL(piece) *p)
{
	return PL(time_between)(p->s, p->done, p->limit);
}

/* ---- what it meets ---- */

#if PL_CONTACTS

static void PL(again)(const void *from, const int *interval, const real *y, real *c, real *terms)
{
	const PL(piece) *const p = (const PL(piece) *)from;
	PL(expand_from)(p->s, p->start, p->slope, p->tau, p->when, p->segment, interval, y, (real (*)[PL_COLUMNS])c,
					terms);
}

static PL_APART void PL(watch)(PL(piece) *p, PL(contact) *contact)
{
	p->contact = contact;
	p->tau = 0;
	p->when = PL(middle)(p->s);
	PL(open)(&p->at, contact, p->y, p->low, p->c[0], p->terms, p->work);
	p->at.expand = PL(again);
	p->at.from = p;
#if PL_MOVED
	p->at.moved = p->moved;
#endif
}

/* The series from there, behind what happens there: 0; 1: it begins anew; below 0: there is too much of that */
static inline int PL(expand_piece)(PL(piece) *p)
{
	p->tau = p->at.time = p->done * PL_H;
	p->when = PL(when)(p);
	return pl_events_begin(&PL(events), &p->at);
}

/* When it meets something within *size, which may become less: below 0, not there */
static inline real PL(meet)(PL(piece) *p, real *size)
{
	return pl_events_next(&PL(events), &p->at, size, &p->splits);
}

/* What happens there; 0: there is too much of that */
static inline int PL(pass_event)(PL(piece) *p)
{
	p->tau = p->at.time = p->done * PL_H;
	return pl_events_pass(&PL(events), &p->at);
}

static inline int PL(status_of)(const PL(piece) *p)
{
	return p->at.status;
}

#else

#if PL_SWITCHING_FUNCTIONS > 0

static inline void PL(watch)(PL(piece) *p, PL(contact) *contact)
{
	p->contact = contact;
}

static inline int PL(pass_event)(PL(piece) *p)
{
	return PL(cross)(p->contact, p->done * PL_H);
}

static inline int PL(expand_piece)(PL(piece) *p)
{
	PL(expand_from)(p->s, p->start, p->slope, p->done * PL_H, PL(when)(p), p->segment, p->contact->interval, p->y,
			p->c,
					p->terms);
	if (!pl_series_switching_left(&PL(series_switching), p->c[0], p->terms, p->contact->interval,
			&p->contact->last)) {
		return 0;
	}
	return PL(pass_event)(p) ? 1 : -1;
}

static inline real PL(meet)(PL(piece) *p, real *size)
{
	return pl_series_switching_next(&PL(series_switching), p->c[0], p->terms, p->contact->interval, *size,
			&p->splits,
						   &p->contact->last, p->work);
}

#else

static inline int PL(expand_piece)(PL(piece) *p)
{
	PL(expand_from)(p->s, p->start, p->slope, p->done * PL_H, PL(when)(p), p->segment, NULL, p->y, p->c, p->terms);
	return 0;
}

#endif

static inline int PL(status_of)(const PL(piece) *p)
{
	(void)p;
	return 0;
}

#endif

/* Where the search gave up: what is not finite may be why. */
static PL_APART int PL(gave_up)(const PL(piece) *p)
{
	return PL_TOO_MANY_EVENTS | pl_not_finite(p->c[0], (PL_ORDER + 1) * PL_COLUMNS) | PL(status_of)(p);
}

/* ---- how far it goes ---- */

/* Up to which part of the step, of which `end` is asked, the loads have one formula */
static inline void PL(find_limit)(PL(piece) *p, real end)
{
	const int segment = p->segment;
	p->limit = PL(limit_of)(p->s, p->done, end, &p->segment);
	p->fresh = p->fresh || p->segment != segment;
}

#if PL_ADAPTIVE
/* How much of the step the series serves; 0: it is not finite.  Where nothing is known of it, the slopes at its end
 * tell whether what comes shows in it. */
static real PL(size)(PL(piece) *p)
{
	const int *const interval = PL_INTERVAL;
	real size = PL(part)(p->s, (const real (*)[PL_COLUMNS])p->c);
	int i;
	if (size == 0) {
		return 0;
	}
	size = size < p->longest ? size : p->longest;
	size = size < p->limit - p->done ? size : p->limit - p->done;
#if PL_SLOPES
	while (size > PL_LEAST_PART && !PL(meets)(p->s, p->start, p->slope, p->done * PL_H, PL(when)(p), p->segment,
								  interval, (const real (*)[PL_COLUMNS])p->c, size)) {
		size /= 2;
	}
#endif
	for (p->longest *= 2; p->fresh && p->parts <= PL_TRIES; p->longest = 2 * size) {
		real gain[PL_STATES], next[PL_STATES], d[PL_ORDER + 1][PL_COLUMNS], terms[PL_ROOM(PL_TERMS)];
		PL(ahead)((const real (*)[PL_COLUMNS])p->c, size, gain);
		for (i = 0; i < PL_STATES; i++) {
			next[i] = p->y[i] + gain[i];
		}
		PL(expand_from)(p->s, p->start, p->slope, (p->done + size) * PL_H, PL(when)(p), p->segment, interval,
				next, d,
						terms);
		p->fresh = !PL(agrees)(p->s, (const real (*)[PL_COLUMNS])p->c, (const real (*)[PL_COLUMNS])d, size);
		if (p->fresh) {
			size /= 2;
			p->fresh = size > PL_LEAST_PART;
			p->parts++; /* one that is too long is an internal step, too */
		}
	}
	return size;
}
#else
static inline real PL(size)(const PL(piece) *p)
{
	return p->limit - p->done;
}
#endif

/* The state on over this part: 0, or PL_NOT_FINITE, and it stays as it was */
static inline int PL(go_on)(PL(piece) *p, real size)
{
	real gain[PL_STATES], ends[PL_STATES];
	int i;
	PL(ahead)((const real (*)[PL_COLUMNS])p->c, size, gain);
	for (i = 0; i < PL_STATES; i++) {
		ends[i] = p->y[i] + gain[i];
	}
	if (pl_not_finite(ends, PL_STATES)) {
		return PL_NOT_FINITE;
	}
	for (i = 0; i < PL_STATES; i++) {
		p->y[i] = pl_accumulate(p->y[i], gain[i], 0, &p->low[i]);
	}
	p->done = size < p->limit - p->done ? p->done + size : p->limit;
#if PL_PROJECTS
	return PL(project)(p->s, p->done * PL_H, p->y, p->low);
#else
	return 0;
#endif
}

/* The next part: 0, or what went wrong */
static inline int PL(go_through)(PL(piece) *p, int *inaccurate)
{
	const int begun = PL(expand_piece)(p);
	int wrong;
	real size;
#if PL_SWITCHING_FUNCTIONS > 0
	real meets;
#endif
	if (begun != 0) {
		p->fresh = PL_CONTACTS || p->fresh;
		return begun > 0 ? 0 : PL(gave_up)(p);
	}
	size = PL(size)(p);
	if (size == 0) {
		return PL_NOT_FINITE;
	}
	if (PL_ADAPTIVE && p->parts > PL_TRIES) {
		return PL_TOO_MANY_STEPS;
	}
#if PL_SWITCHING_FUNCTIONS > 0
	meets = PL(meet)(p, &size);
	if (p->splits < 0) {
		return PL(gave_up)(p);
	}
	size = meets >= 0 ? meets : size;
#endif
#if PL_WATCHED
	*inaccurate = !PL(is_accurate)(p->s, (const real (*)[PL_COLUMNS])p->c, size) || *inaccurate;
#endif
	(void)inaccurate;
	wrong = PL(go_on)(p, size);
	if (wrong != 0) {
		return wrong == PL_NOT_FINITE ? PL_LOST : wrong;
	}
#if PL_SWITCHING_FUNCTIONS > 0
	if (meets < 0) {
		p->contact->last.expression = -1;
#if PL_CONTACTS
		p->at.status |= pl_events_places(&PL(events), &p->at, size, 0);
#endif
	} else if (!PL(pass_event)(p)) {
		return PL(gave_up)(p);
	} else {
		p->fresh = 1;
		p->parts--; /* events have a limit of their own */
	}
#endif
	return 0;
}

/* The same.  Events move states too: what is not finite behind one is not kept. */
static inline int PL(advance)(PL(piece) *p, int *inaccurate)
{
#if PL_CONTACTS
	real y[PL_STATES], low[PL_STATES];
	int i, wrong;
	for (i = 0; i < PL_STATES; i++) {
		y[i] = p->y[i];
		low[i] = p->low[i];
	}
	wrong = PL(go_through)(p, inaccurate);
	if (!pl_not_finite(p->y, PL_STATES)) {
		return wrong;
	}
	for (i = 0; i < PL_STATES; i++) {
		p->y[i] = y[i];
		p->low[i] = low[i];
	}
	return PL_LOST;
#else
	return PL(go_through)(p, inaccurate);
#endif
}

/* y and what rounding took from it, `end` h later: 0; or what went wrong, and y as far as it went.  fresh: nothing is
 * known of how long a series may be */
static int PL(between)(const PL_TYPE *s, const real u[], int fresh, real end, real y[PL_STATES], real low[PL_STATES],
					   PL_MET *contact)
{
	PL(piece) p;
	int wrong = 0, inaccurate = 0;
	p.s = s;
	p.y = y;
	p.low = low;
	PL(inputs_now)(s, u, p.start, p.slope);
	p.done = 0;
	p.longest = 1;
	p.fresh = fresh;
	p.segment = PL(segment_of)(s);
	p.parts = 0;
#if PL_SWITCHING_FUNCTIONS > 0
	p.splits = PL_MAX_SPLITS;
	PL(watch)(&p, contact);
#else
	(void)contact;
#endif
	while (p.done < end && wrong == 0) {
		PL(find_limit)(&p, end);
		wrong = PL_ADAPTIVE && p.parts++ == PL_TRIES ? PL_TOO_MANY_STEPS : PL(advance)(&p, &inaccurate);
	}
	return wrong != 0 ? PL_CAUSE(s, p.done * PL_H, y, wrong) : PL(status_of)(&p) | (inaccurate ? PL_INACCURATE : 0);
}

/* ---- a state that was set ---- */

#if PL_CONTACTS
/* Its intervals */
static void PL(locate)(const PL_TYPE *s, const real u[], PL(contact) *contact)
{
	PL(piece) p;
	real y[PL_STATES], low[PL_STATES];
	int i;
	for (i = 0; i < PL_STATES; i++) {
		y[i] = s->y[i];
		low[i] = 0;
	}
	p.s = s;
	p.y = y;
	p.low = low;
	p.segment = PL(segment_of)(s);
	PL(inputs_now)(s, u, p.start, p.slope);
	PL(watch)(&p, contact);
	contact->placed = 1;
	pl_events_place(&PL(events), &p.at);
}
#endif
