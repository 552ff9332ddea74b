/* SPDX-License-Identifier: MIT-0 */
/* search.h: events of a piecewise-linear model: the region of a state, and a step from event to event, by crossings.c,
 * or with friction and impacts by guards.c; a step is also split where loads change their formula.  There the number of
 * a region in pl_contact has its segment of time as the last interval, so that a change goes to the region with the
 * same intervals in the next segment; what has left its interval by that, the search finds at the start of the stretch.
 *
 * Included by the file of the model behind its tables, for each of its independent parts, which defines before it
 *
 *     PL(name), PL_TYPE          the prefix of the part before a name; the model, with members contact and crossing
 *     PL_SINGLE, PL_COMPENSATED         whether its numbers are floats; whether x is in two words
 *     PL_SIZE, PL_STATES         entries of x, of which the first are states; PL_ALL: of the model's
 *     PL_VECTOR, PL_WORK         words of x; numbers that the search works in
 *     PL_H, PL_DEGREE            [s]; of its Taylor polynomials
 *     PL_SWITCHING_FUNCTIONS, PL_IMPACTS that breakpoints divide; impacts
 *     PL_MAX_EVENTS, PL_MAX_SPLITS, PL_MOST_EVENTS  in a step: crossings listed, looks, with friction or impacts all
 *     PL_PLACE(i), PL_PART       where state i of the part is in s->y; which of s->contact is its: [1], or nothing
 *     PL_SEARCH, PL_START, PL_ADVANCE, PL_CHANGE  the search: its descriptor, its functions
 *     PL_GUARDS                  whether it is that of guards.c
 *     PL_LADDER                  shorter pieces, as braces around what pl_ladder has
 *     PL_OWN, PL_SEGMENTS        whether an instance has the tables; of time, each with its own regions
 *     PL_SLOTS                   matrices of regions that an instance keeps, made when they are met; 0: all are there.
 *                                Beside them PL_RUNGS, PL_HALVINGS, and in the place of tables PL(sum), PL(constant)
 *     PL_REGIONS                 in each segment
 *     PL_LOST, PL_UNTIL(s, k)    of several: whether some cannot be in the next one; when segment k ends
 *     PL_ALONE, PL_BOUNCES       whether it is all of the model, which is asked about; whether something bounces
 *     PL_EVENT_FREE, PL_CAPPED   whether a bound shows most steps to be event-free before: of guards by unmet.h, with
 *                                bit i where x_i is never above 1
 *     PL_FEW                     crossings by few.h, which is included then; 0: none
 *     PL_COLUMNS_D               derivatives; 0: none.  PL_D: the type that has them, PL_MATRICES_D, PL_DEGREE_D: of
 *                                pl_variation, and PL(varied_first), PL(varied), PL_VARIED_STEP its tables;
 *                                PL_ACTING_D(p), PL_MOVING_D(p): whether in column p what acts varies, and e^{A h};
 *                                PL_RELATIVE 1: PL(keep_d), PL(written_d) are there
 *     PL_SHARED                  1: the step calls PL(vary_free) where it is surely event-free, PL(vary), by PL_FOLLOW,
 *                                where PL(cross) has found all crossings, else PL(vary_searched), which moves s */
#include "numbers.h"

/* ---- what the search goes by ---- */

#if PL_OWN
#define PL_OF(name) s->coeffs.name
#else
#define PL_OF(name) PL(name)
#endif

/* An instance is const where it is asked about a time in a step; what it keeps is no part of what it tells. */
#if PL_SLOTS > 0
#define PL_KEPT(name) own->cached.name
#define PL_MATRIX (const int *)0
#define PL_CACHED(search, first, g) pl_cached cached = PL(cached)(s, first, g); (search).cached = &cached;
#if PL_GUARDS
#define PL_CACHE(search, first) const pl_cached_guards ended = PL(cached_guards)(s); PL_CACHED(search, first, &ended)
#else
#define PL_CACHE(search, first) PL_CACHED(search, first, (const pl_cached_guards *)0)
#endif
#else
#define PL_KEPT(name) PL_OF(name)
#define PL_MATRIX PL(matrix)
#define PL_CACHE(search, first)
#endif

#if PL_SWITCHING_FUNCTIONS == 0 /* what is theirs is not read */
#define PL_SWITCHING_TABLES PL(slopes)[0][0], PL(matrix), PL(slopes)[0][0]
#elif PL_SEGMENTS > 1
#define PL_SWITCHING_TABLES PL_OF(row)[segment][0], PL(breaks), PL_OF(breakpoint)
#else
#define PL_SWITCHING_TABLES PL_OF(row)[0], PL(breaks), PL_OF(breakpoint)
#endif

#if PL_SEGMENTS > 1
#define PL_FIRST(count) segment * (count)
#else
#define PL_FIRST(count) 0
#endif

#define PL_MATRICES PL_MATRIX, PL_KEPT(halvings), PL_KEPT(slopes)[0][0], PL_KEPT(pieces)[0][0], PL_LADDER

#define PL_AMPLITUDES PL_OF(amplitude) + PL_FIRST(PL_SWITCHING_FUNCTIONS)
#if PL_GUARDS && PL_SLOTS > 0
#define PL_GUARD_ERRORS PL_KEPT(guard_chord_error)[0], PL_KEPT(guard_cubic_error)[0]
#define PL_GUARD_TABLES {PL_KEPT(guard_row)[0], PL_KEPT(guard_tangent)[0], PL_GUARD_ERRORS, PL_KEPT(guard_amplitude)}
#define PL_LISTS (const int *)0, PL_KEPT(guard), PL_KEPT(limit), (const int *)0
#define PL_ENDED PL_KEPT(tangent)[0][0], PL_LISTS, PL_GUARD_TABLES, PL_AMPLITUDES
#define PL_SET PL_KEPT(sets), PL_KEPT(held), PL_KEPT(value)[0]
#define PL_BOUNDS PL_ENDED, PL_SET, 0, PL(impact), PL(speed)[0], PL(retreat)[0]
#elif PL_GUARDS
#define PL_GUARD_ERRORS PL_OF(guard_chord_error)[0], PL_OF(guard_cubic_error)[0]
#define PL_GUARD_TABLES {PL_OF(guard_row)[0], PL_OF(guard_tangent)[0], PL_GUARD_ERRORS, PL_OF(guard_amplitude)}
#define PL_ENDED PL_OF(tangent)[0][0], PL(first), PL(guard), PL_OF(limit), PL(holding), PL_GUARD_TABLES, PL_AMPLITUDES
#define PL_SET PL(sets), PL(held), PL_OF(value)[0]
#define PL_SPEEDS PL_OF(speed)[PL_FIRST(PL_IMPACTS)], PL_OF(retreat)[PL_FIRST(PL_IMPACTS)]
#define PL_BOUNDS PL_ENDED, PL_SET, PL_IMPACTS, PL_OF(impact) + PL_FIRST(PL_IMPACTS), PL_SPEEDS
#elif PL_SWITCHING_FUNCTIONS > 0
#define PL_BOUNDS PL_KEPT(tangent)[0][0], PL_KEPT(chord_error)[0][0], PL_KEPT(cubic_error)[0][0]
#else
#define PL_BOUNDS PL(slopes)[0][0], PL(slopes)[0][0], PL(slopes)[0][0]
#endif

#if PL_GUARDS
#define PL_MOST PL_DEGREE, PL_MAX_EVENTS, PL_MAX_SPLITS, (pl_cached *)0, PL_MOST_EVENTS
#else
#define PL_MOST PL_DEGREE, PL_MAX_EVENTS, PL_MAX_SPLITS, (pl_cached *)0
#endif
#define PL_TABLES PL_SIZE, PL_H, PL_SWITCHING_FUNCTIONS, PL_SWITCHING_TABLES, PL_MATRICES, PL_BOUNDS, PL_MOST

#if PL_SLOTS > 0
#if PL_SEGMENTS > 1
#define PL_ROWS_OF_ALL PL(row)[0][0]
#else
#define PL_ROWS_OF_ALL PL(row)[0]
#endif

#if PL_GUARDS
#define PL_FUNCTION_BOUNDS (real *)0, (real *)0, (real *)0
static pl_cached_guards PL(cached_guards)(const PL_TYPE *s)
{
	struct PL_TYPE *const own = (struct PL_TYPE *)s;
	const pl_cached_guards g = {
		PL_MOST_GUARDS, PL_MOST_HOLDS, PL(first), PL(guard), PL(limit), PL(guard_row)[0], PL(guard_amplitude),
		PL(holding), PL(sets), PL(held), PL(owner), PL(value)[0], PL_KEPT(count), PL_KEPT(guard),
				PL_KEPT(limit),
		PL_KEPT(guard_row)[0], PL_KEPT(guard_tangent)[0], PL_KEPT(guard_chord_error)[0],
				PL_KEPT(guard_cubic_error)[0],
		PL_KEPT(guard_amplitude), PL_KEPT(bend)[0], PL_KEPT(sets), PL_KEPT(held), PL_KEPT(value)[0]
	};
	return g;
}
#else
#define PL_FUNCTION_BOUNDS PL_KEPT(chord_error)[0][0], PL_KEPT(cubic_error)[0][0], PL_KEPT(bend)[0]
#endif

static pl_cached PL(cached)(const PL_TYPE *s, int first, const pl_cached_guards *g)
{
	struct PL_TYPE *const own = (struct PL_TYPE *)s;
	const pl_cached c = {
		pl_cached_matrix, PL_SIZE, PL_SWITCHING_FUNCTIONS, PL_SLOTS, PL_RUNGS, PL_HALVINGS, PL_REGIONS, first,
				PL_H,
		PL(breaks), PL_ROWS_OF_ALL, PL(sum), PL(constant), PL_KEPT(slot), &PL_KEPT(clock), PL_KEPT(halvings),
		PL_KEPT(spacing), PL_KEPT(slopes)[0][0], PL_KEPT(pieces)[0][0], PL_KEPT(rungs)[0][0],
				PL_KEPT(tangent)[0][0],
		PL_FUNCTION_BOUNDS, PL_KEPT(work), -1, g
	};
	return c;
}
#endif

#if PL_OWN || PL_SEGMENTS > 1 || PL_SLOTS > 0
/* Made anew for each call: an instance that is copied would have to point into itself. */
static PL_SEARCH PL(switching)(const PL_TYPE *s, int segment)
{
#if PL_SLOTS > 0
	struct PL_TYPE *const own = (struct PL_TYPE *)s;
#endif
	const PL_SEARCH tables = {PL_TABLES};
	(void)s;
	(void)segment;
	return tables;
}
#else
static const PL_SEARCH PL(switching) = {PL_TABLES};
#endif

#if PL_COLUMNS_D > 0
#define PL_AND_VARIATION , pl_variation *v
#define PL_V , v
#define PL_NO_V , (pl_variation *)0
#else
#define PL_AND_VARIATION
#define PL_V
#define PL_NO_V
#endif

/* ---- regions ---- */

#if PL_SWITCHING_FUNCTIONS > 0
/* The region of x in a segment of time */
static void PL(begin_contact)(const PL_TYPE *s, int segment, const real x[PL_VECTOR], pl_contact *contact,
							  real work[PL_WORK])
{
#if PL_SEGMENTS > 1
	PL_SEARCH here = PL(switching)(s, segment);
#if PL_SLOTS == 0
	here.matrix += segment * PL_REGIONS;
#endif
#if PL_GUARDS && PL_SLOTS == 0
	here.first += segment * PL_REGIONS;
	here.hold += segment * PL_REGIONS;
#endif
	PL_CACHE(here, segment * PL_REGIONS)
	PL_START(&here, x, contact, work);
	contact->region += segment * PL_REGIONS;
#elif PL_OWN || PL_SLOTS > 0
	PL_SEARCH here = PL(switching)(s, segment);
	PL_CACHE(here, 0)
	PL_START(&here, x, contact, work);
#else
	(void)s;
	(void)segment;
	PL_START(&PL(switching), x, contact, work);
#endif
}
#endif

#if PL_EVENT_FREE && PL_GUARDS
/* Of few regions each has code of its own, in which its tables are numbers and what is 0 in them is left out. */
#define PL_FEW_REGIONS (PL_REGIONS <= 16 && PL_REGIONS * PL_SIZE <= 64 && PL_SIZE <= 16)

/* row . x in the order of the runtime's sums: of each fourth term, then these */
static PL_INLINE double PL(dot)(const double *row, const double *x)
{
	double s[4] = {-0.0, -0.0, -0.0, -0.0};
	int j;
	PL_UNROLL
	for (j = 0; j < PL_SIZE; j++) {
		s[j % 4] += row[j] * x[j];
	}
	return (s[0] + s[2]) + (s[1] + s[3]);
}
#if !PL_FEW_REGIONS
#define PL_SUM(row, x) PL(dot)(row, x)
#define PL_EACH
#endif
#ifdef PL_AS_ON_BOARDS /* small processors take steps with events by the search alone */
#define PL_MEETS 0
#else
#define PL_MEETS (!PL_OWN && PL_SEGMENTS < 2 && !PL_SLOTS && PL_SIZE < 9 && PL_DEGREE < 17)
#endif
#include "unmet.h"
#endif

#if PL_SEGMENTS > 1
/* The same intervals after the next change; where they cannot be then, the equations of the region where x is */
static void PL(next_segment)(const PL_TYPE *s, const real x[PL_VECTOR], pl_contact *contact, real work[PL_WORK])
{
	contact->region += PL_REGIONS;
#if PL_SLOTS > 0 /* the search makes it */
	(void)s;
	(void)x;
	(void)work;
#else
#if PL_LOST
	if (PL(matrix)[contact->region] < 0) {
		pl_contact now;
		PL(begin_contact)(s, contact->region / PL_REGIONS, x, &now, work);
		contact->matrix = now.matrix;
		return;
	}
#else
	(void)s;
	(void)x;
	(void)work;
#endif
	contact->matrix = PL(matrix)[contact->region];
#endif
}

/* Counts what is found from `done` on, as of the start. */
static int PL(counted)(const pl_contact *contact, real done, int count, pl_crossing *crossing)
{
	int i;
	for (i = count; i < count + contact->crossings; i++) {
		crossing[i].time += done;
	}
	return count + contact->crossings;
}

/* Whether segment k ends in the step, or in what is left of it to tau.  Where there are no regions the next step begins
 * in the segment behind a change at the end of this one, so that derivatives have to pass it here. */
#define PL_INSTANT (PL_H * (PL_SINGLE ? (real)0x1p-20 : (real)0x1p-48))
static int PL(ends_before)(real change, real tau PL_AND_VARIATION)
{
#if PL_COLUMNS_D > 0
	if (PL_SWITCHING_FUNCTIONS == 0 && v != NULL) {
		return change <= tau + PL_INSTANT;
	}
#endif
	return PL_GUARDS ? change <= tau : change < tau;
}

/* x on by tau, from change to change of the loads.  Of what sticks and bounces a change at the end, too, is decided at
 * once: outputs read it. */
static void PL(search_step)(const PL_TYPE *s, real tau, real x[PL_VECTOR], pl_contact *contact,
							pl_crossing *crossing PL_AND_VARIATION)
{
	const real never = PL_GUARDS || PL_SWITCHING_FUNCTIONS == 0 ? 2 * PL_H : tau;
	real done = 0, work[PL_WORK];
	int count = 0;
	for (;;) {
		const int segment = contact->region / PL_REGIONS;
		const real change = segment < PL_SEGMENTS - 1 ? PL_UNTIL(s, segment) : never;
		const real to = change < tau ? change : tau;
		PL_SEARCH here = PL(switching)(s, segment);
		PL_CACHE(here, 0)
		here.max_events -= count;
#if PL_COLUMNS_D > 0
		if (v != NULL) {
			v->segment = segment;
		}
#endif
		PL_ADVANCE(&here, to - done, x, contact, crossing + count, work PL_V);
		count = PL(counted)(contact, done, count, crossing);
		if (!PL(ends_before)(change, tau PL_V)) {
			break;
		}
		if (to > done) {
			done = to;
		}
#if PL_COLUMNS_D > 0
		if (v != NULL && !(PL_SWITCHING_FUNCTIONS == 0 && change <= PL_INSTANT)) {
			pl_variation_change(v, PL_SIZE, here.A + (ptrdiff_t)contact->matrix * PL_VECTOR * PL_SIZE, x);
			v->segment = segment + 1;
		}
#endif
		PL(next_segment)(s, x, contact, work);
#if PL_GUARDS
		here = PL(switching)(s, segment + 1);
#if PL_SLOTS > 0
		here.cached = &cached;
#endif
		here.max_events -= count;
		PL_CHANGE(&here, done, x, contact, crossing + count, work PL_V);
		count += contact->crossings;
#endif
	}
	contact->crossings = count;
}
#else
/* x on by tau */
static void PL(search_step)(const PL_TYPE *s, real tau, real x[PL_VECTOR], pl_contact *contact,
							pl_crossing *crossing PL_AND_VARIATION)
{
	real work[PL_WORK];
#if PL_OWN || PL_SLOTS > 0
	PL_SEARCH here = PL(switching)(s, 0);
	PL_CACHE(here, 0)
	PL_ADVANCE(&here, tau, x, contact, crossing, work PL_V);
#else
	(void)s;
#if PL_EVENT_FREE && PL_GUARDS && !(PL_COLUMNS_D > 0)
	if (PL_SOFT) {
		pl_guards_step(&PL(switching), tau, x, contact, crossing, work);
		return;
	}
#endif
#if PL_MEETS
	if (tau >= PL_H && PL(meets_one)(&PL(switching), x, contact, crossing, work PL_V)) {
		return;
	}
#endif
	PL_ADVANCE(&PL(switching), tau, x, contact, crossing, work PL_V);
#endif
}

#endif

/* ---- a step, and what is asked about it ---- */
#if PL_EVENT_FREE && PL_GUARDS
#define PL_SOUGHT PL_APART_HARD void PL(by_search)
#elif PL_EVENT_FREE
#define PL_SOUGHT PL_APART void PL(seek)
#else
#define PL_SOUGHT void PL(seek)
#endif

#if PL_SWITCHING_FUNCTIONS > 0
/* Where the search has come to */
static inline void PL(arrive)(PL_TYPE *s, const real x[PL_VECTOR])
{
	int i;
	for (i = 0; i < PL_STATES; i++) {
		s->y[PL_PLACE(i)] = x[i];
#if PL_COMPENSATED
		s->low[PL_PLACE(i)] = x[PL_SIZE + i];
#endif
	}
	s->status |= s->contact PL_PART.status | pl_not_finite(s->y, PL_ALL);
}

/* By the search, from x; its states are those of s */
static PL_SOUGHT(PL_TYPE *s, real x[PL_VECTOR])
{
#if PL_EVENT_FREE && PL_GUARDS
	int i;
	for (i = 0; i < PL_STATES && !PL_SOFT; i++) {
		x[i] = s->y[PL_PLACE(i)];
	}
#endif
	PL(search_step)(s, PL_H, x, &s->contact PL_PART, s->crossing PL_PART PL_NO_V);
	PL(arrive)(s, x);
}
#endif

#if PL_EVENT_FREE && PL_GUARDS
#define PL_SEEKS 1
#include "unmet.h"
#undef PL_SEEKS
#endif

#if PL_COLUMNS_D > 0
#if !PL_RELATIVE
static PL_INLINE void PL(keep_d)(const real *y, real *S)
{
	int i;
	for (i = 0; i < PL_STATES; i++) {
		S[i] = y[PL_PLACE(i)];
	}
}

static PL_INLINE void PL(written_d)(const real *S, real *y)
{
	int i;
	for (i = 0; i < PL_STATES; i++) {
		y[PL_PLACE(i)] = S[i];
	}
}
#endif

/* The derivatives of the states over tau, from S, which has those of all else in x, and x where s is, which moves
 * along.  known: so many crossings are there, and all; -1: they are searched for, as the state does */
static void PL(vary_along)(const PL_TYPE *s, real tau, real x[PL_VECTOR], pl_contact *contact, pl_crossing *crossing,
						   int known, real S[PL_COLUMNS_D + 1][PL_SIZE], PL_D *ds)
{
	real scale[PL_SIZE], when[PL_COLUMNS_D], dg[PL_COLUMNS_D], noise[PL_SIZE];
	real work[PL_VARIATION_WORK(PL_SIZE, PL_DEGREE_D)];
	pl_varied acting[PL_SIZE * PL_SIZE + 1];
	pl_variation v;
	int i, p;
	v.columns = PL_COLUMNS_D;
	v.matrices = PL_MATRICES_D;
	v.degree = PL_DEGREE_D;
	v.first = PL(varied_first);
	v.entry = PL_OF(varied);
	v.over = PL_VARIED_STEP;
	v.S = S[0];
	v.scale = scale;
	v.when = when;
	v.dg = dg;
	v.noise = noise;
	v.work = work;
	v.acting = acting;
	v.segment = v.pending = v.sticks = v.upward = v.jumped = 0;
	v.function = v.last = -1;
	v.doubt.status = v.acted = 0;
	for (i = 0; i < PL_SIZE; i++) {
		scale[i] = i < PL_STATES ? ds->scale[PL_PLACE(i)] : 0;
		S[PL_COLUMNS_D][i] = 0;
	}
	for (p = 0; p < PL_COLUMNS_D; p++) {
		PL(keep_d)(ds->s[p], S[p]);
	}
#if PL_SHARED && PL_FEW > 0
	if (known >= 0) {
		PL_FOLLOW(&PL(switching), known, crossing, x, contact, &v);
	} else {
		PL(search_step)(s, tau, x, contact, crossing, &v);
	}
#else
	PL(search_step)(s, tau, x, contact, crossing, &v);
#endif
	(void)known;
	for (i = 0; i < PL_STATES; i++) {
		ds->scale[PL_PLACE(i)] = scale[i];
	}
	for (p = 0; p < PL_COLUMNS_D; p++) {
		PL(written_d)(S[p], ds->s[p]);
	}
	if (contact->status & PL_UNDECIDED) {
		pl_doubt_add(&v.doubt, PL_D_UNDECIDED, -1, tau);
	}
#if !PL_ALONE
	for (i = 0; i < 4; i++) {
		v.doubt.function[i] = -1; /* they are numbers of this part */
	}
#endif
	pl_doubt_join(&ds->doubt, &v.doubt, 0); /* the step starts then: who calls it adds that */
	ds->status = ds->doubt.status;
}

/* s stays, or has moved on, with so many crossings known. */
static void PL(vary)(const PL_TYPE *s, real tau, real x[PL_VECTOR], pl_contact contact, int known,
					 real S[PL_COLUMNS_D + 1][PL_SIZE], PL_D *ds)
{
	pl_crossing crossing[PL_ROOM(PL_MAX_EVENTS)];
#if PL_SHARED && PL_FEW > 0
	int i;
	for (i = 0; i < known; i++) {
		crossing[i] = s->crossing PL_PART[i];
	}
#endif
	PL(vary_along)(s, tau, x, &contact, crossing, known, S, ds);
}
#endif

#if PL_SHARED
/* s over h too, by the same search */
static void PL(vary_searched)(PL_TYPE *s, real x[PL_VECTOR], real S[PL_COLUMNS_D + 1][PL_SIZE], PL_D *ds)
{
	PL(vary_along)(s, PL_H, x, &s->contact PL_PART, s->crossing PL_PART, -1, S, ds);
	PL(arrive)(s, x);
}

#if PL_EVENT_FREE
/* row . x, of so many entries */
static PL_INLINE real PL(part_of_row)(const real *row, const real *x, int entries)
{
	real sum = 0;
	int j;
	PL_UNROLL
	for (j = 0; j < entries; j++) {
		sum += row[j] * x[j];
	}
	return sum;
}

/* The same over h, of which it is sure that x, where the step began, meets nothing in it: S+ = Phi S + Phi_p x */
static PL_INLINE void PL(vary_free)(const PL_TYPE *s, const real x[PL_SIZE], real S[PL_COLUMNS_D + 1][PL_SIZE],
									PL_D *ds)
{
	const int which = s->contact PL_PART.matrix;
	const real *Phi = PL_OF(pieces)[which][0], *over = PL_VARIED_STEP;
	int i, p;
	if (over == NULL) {
		real from[PL_VECTOR];
		for (i = 0; i < PL_VECTOR; i++) {
			from[i] = i < PL_SIZE ? x[i] : 0;
		}
		PL(vary)(s, PL_H, from, s->contact PL_PART, PL_FEW > 0 ? 0 : -1, S, ds);
		return;
	}
	for (p = 0; p < PL_COLUMNS_D; p++) {
		const real *const change = over + (p * PL_MATRICES_D + which) * PL_SIZE * PL_SIZE;
		real next[PL_STATES];
		PL(keep_d)(ds->s[p], S[p]);
		for (i = 0; i < PL_STATES; i++) {
			const int row = i * PL_SIZE;
			real sum = PL_ACTING_D(p) ? PL(part_of_row)(Phi + row, S[p], PL_SIZE)
									  : PL(part_of_row)(Phi + row, S[p], PL_STATES);
			if (PL_COMPENSATED) { /* of e^{A h} - I; second words are not small in columns of loads */
				sum += S[p][i] + PL(part_of_row)(Phi + PL_SIZE * PL_SIZE + row, S[p], PL_SIZE);
			}
			if (PL_MOVING_D(p)) {
				sum += PL(part_of_row)(change + row, x, PL_SIZE);
			}
			next[i] = sum;
		}
		PL(written_d)(next, ds->s[p]);
	}
	for (i = 0; i < PL_STATES; i++) {
		if (pl_magnitude(x[i]) > ds->scale[PL_PLACE(i)]) {
			ds->scale[PL_PLACE(i)] = pl_magnitude(x[i]);
		}
	}
}
#endif
#endif

#if PL_ALONE
int PL(region)(const PL_TYPE *s)
{
#if PL_SEGMENTS > 1
	return s->contact.region % PL_REGIONS;
#else
	return s->contact.region;
#endif
}

uint64_t PL(crossed)(const PL_TYPE *s)
{
	return s->contact.total;
}

int PL(crossings)(const PL_TYPE *s, pl_crossing crossing[PL_MAX_EVENTS])
{
	const int count = s->contact.crossings < PL_MAX_EVENTS ? s->contact.crossings : PL_MAX_EVENTS;
	int i;
	for (i = 0; i < count; i++) {
		crossing[i] = s->crossing[i];
	}
	return count;
}

#if PL_BOUNCES
int PL(rested)(const PL_TYPE *s)
{
	return s->contact.rested;
}
#endif
#endif

#if PL_FEW > 0
#include "few.h"
#endif
#include "undef.h"
