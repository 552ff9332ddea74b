/* SPDX-License-Identifier: MIT-0 */
/* switches.h: beside the collocation the Taylor series of the solution, part of radau.h: how long one serves, where
 * stability bounds it, and which of the two is next.  The model's file defines beside what radau.h asks
 *
 *     PL_WORTH                   so many series a step of the collocation costs
 *     PL(expand_from), PL(ahead)   as taylor.h; and what reach.h asks
 *     PL(bound_rates)(jacobian, rates)      Gershgorin's, on how fast the motion may decay [1/s], and on the square of
 *                                           how fast it may turn
 *
 * and members series, stiff, product, bounds, patience, run. */

/* The product of a length in h with how fast the motion may be above which stability bounds a series of this order */
#define PL_STABLE ((real)(8 + PL_ORDER) / 10)

static void PL(find_rates)(const PL_TYPE *s, const real start[], const real slope[], real rates[2])
{
	real left[PL_COORDS], jacobian[PL_ROOM(PL_ENTRIES)];
	PL(here)(s, start, slope, left, jacobian);
	rates[0] = rates[1] = 0;
	PL(bound_rates)(jacobian, rates);
}

/* Their product with a length in h, the larger one: what moves to and fro bounds a series less */
static real PL(product)(const real rates[2], real length)
{
	const real dt = length * PL_H, decay = rates[0] * dt, turn = (real)0.5625 * rates[1] * dt * dt;
	return turn > decay * decay ? pl_root(turn, 2) : decay;
}

/* The n-th root of the tolerance over a last term */
static inline real PL(length_of)(real last, int n)
{
	return pl_root(PL_TOLERANCE / (last + PL_NOTHING), n);
}

static inline real PL(shorter)(real a, real b)
{
	return b < a ? b : a;
}

#if PL_UNRESOLVED
/* Whether the series shows over `length` what the equations do, whose slopes it has over `size` */
static inline int PL(is_shown)(const PL_TYPE *s, const real start[], const real slope[], real length, real size)
{
	if (!PL(shows)(s->poly, length)) {
		return 0;
	}
#if PL_SLOPES
	return PL(meets)(s, start, slope, PL(since)(s) * PL_H, PL(when)(s), PL(leg_of)(s), PL(intervals)(s), s->poly,
			size);
#else
	(void)start;
	(void)slope;
	(void)size;
	return 1;
#endif
}
#endif

/* How many h the series serves; 0: it is not finite.  By its last term and the one before; where they are 0, or nearly,
 * by what stands in for them.  Less is left for what comes after them where crossings follow from the state. */
static real PL(length)(const PL_TYPE *s)
{
	real last[3], before[3], length, square;
	PL(remainders)(s, s->poly, last, before);
	if (!((last[0] + last[1]) + (last[2] + before[0]) + (before[1] + before[2]) < PL_HUGE)) {
		return 0;
	}
	length = PL(shorter)(PL(length_of)(last[0], PL_ORDER), PL(length_of)(before[0], PL_ORDER - 1));
	square = length * length;
	if (last[1] * square + last[2] > last[0] * square * square ||
		before[1] * square + before[2] > before[0] * square * square) {
		last[0] = (last[0] * square + last[1]) * square + last[2];
		before[0] = (before[0] * square + before[1]) * square + before[2];
		length = PL(shorter)(length, PL(length_of)(last[0], PL_ORDER - 4));
		length = PL(shorter)(length, PL(length_of)(before[0], PL_ORDER - 5));
	}
	return (PL_SWITCHING_FUNCTIONS > 0 ? (real)0.8 : (real)0.94) * length;
}

/* What stands beside the states in the series has a size too. */
static inline void PL(measure_beside)(PL_TYPE *s)
{
	int i;
	for (i = PL_STATES; i < PL_STATES + PL_MEASURED; i++) {
		if (pl_magnitude(s->poly[0][i]) > s->scale[i]) {
			s->scale[i] = pl_magnitude(s->poly[0][i]);
			s->unit[i] = 1 / s->scale[i];
		}
	}
}

#if PL_CONTACTS
static int PL(end_at_crossing)(PL_TYPE *s, real terms[], real *length);
#elif PL_SWITCHING_FUNCTIONS > 0
/* Up to the first crossing within `length` h, where there is one: 0, or what went wrong; PL_NO_MOVE: it is here */
static inline int PL(end_at_crossing)(PL_TYPE *s, const real terms[PL_SWITCHING_FUNCTIONS], real *length)
{
	real work[PL_SERIES_SWITCHING_WORK(PL_ORDER)], next;
	pl_crossing crossing = s->contact.last;
	int splits = PL_MAX_SPLITS;
	next = pl_series_switching_next(&PL(series_switching), s->poly[0], terms, s->contact.interval, *length, &splits,
									&crossing, work);
	if (splits < 0) {
		return PL_TOO_MANY_EVENTS | pl_not_finite(s->poly[0], (PL_ORDER + 1) * PL_COLUMNS);
	}
	if (next < 0) {
		s->contact.last.expression = -1;
		return 0;
	}
	s->contact.last = crossing;
	s->stop = PL_AT_CROSSING;
	*length = next;
	return next < PL_HERE ? PL_NO_MOVE : 0;
}
#endif

/* An internal step by the series, up to where it serves or a switching function passes a breakpoint: 0, or what went
 * wrong: PL_NOT_FINITE, it is of no use.  Where stability bounds several in a row, the collocation is next. */
static int PL(expand_step)(PL_TYPE *s, const real start[], const real slope[], real limit, const real rates[2])
{
	real terms[PL_ROOM(PL_TERMS)], length, product;
#if PL_SWITCHING_FUNCTIONS > 0
	real most;
	int wrong;
#endif
	PL(expand_from)(s, start, slope, PL(since)(s) * PL_H, PL(when)(s), PL(leg_of)(s), PL(intervals)(s), s->start,
					s->poly, terms);
	PL(measure_beside)(s);
	length = PL(length)(s);
	if (length == 0) {
		return PL_NOT_FINITE;
	}
	if (length > 8 && length > 8 * s->want) {
		length = s->want > 1 ? 8 * s->want : 8;
	}
#if PL_UNRESOLVED
	while (length > PL_SHORTEST && !PL(is_shown)(s, start, slope, length, length < limit ? length : limit)) {
		length /= 2;
	}
	if (!(length > PL_SHORTEST)) {
		return PL_NOT_FINITE;
	}
#endif
	PL(ahead)((const real (*)[PL_COLUMNS])s->poly, PL(wanted)(length, limit), s->gain);
	if (!PL(ends)(s->start, s->gain)) {
		return PL_NOT_FINITE;
	}
	s->want = length;
	length = PL(wanted)(length, limit);
	if (length < limit) {
		s->stop = PL_AT_ERROR;
	}
	product = PL(product)(rates, length);
	s->bounds = product > PL_STABLE ? s->bounds + 1 : 0;
	if (s->bounds >= s->patience) {
		s->stiff = 1;
		s->product = product;
		s->run = s->bounds = 0;
	}
#if PL_SWITCHING_FUNCTIONS > 0
	most = length;
	wrong = PL(end_at_crossing)(s, terms, &length);
	if (wrong) {
		return wrong;
	}
	if (length < most) {
		s->stop = s->stop == PL_AT_CROSSING ? s->stop : PL_AT_ERROR;
		PL(ahead)((const real (*)[PL_COLUMNS])s->poly, length, s->gain);
	}
#endif
	s->size = length;
	s->series = 1;
	s->ready = 0;
	return 0;
}

static int PL(collocate)(PL_TYPE *s, const real start[], const real slope[], real limit, const real rates[2],
						 int *tried);

/* An internal step by one of the two: 0, or what went wrong */
static int PL(choose)(PL_TYPE *s, const real start[], const real slope[], real limit, const real rates[2], int *tried)
{
	int wrong;
	for (;;) {
		const real slow = PL_WORTH * s->product, most = s->run >= 3 && slow > PL_STABLE ? slow : PL_STABLE;
		if (s->stiff && PL(product)(rates, s->want < limit ? s->want : limit) < most) {
			s->stiff = 0; /* and where that was so soon, the series is given more time */
			s->patience = s->run > 8 ? 2 : s->patience < 64 ? 2 * s->patience : 64;
		}
		if (!s->stiff) {
			if ((*tried)++ == PL_TRIES) {
				return PL_TOO_MANY_STEPS;
			}
			wrong = PL(expand_step)(s, start, slope, limit, rates);
			if (wrong != PL_NOT_FINITE) {
				return wrong;
			}
			s->stiff = 1;
			s->run = s->ready = 0;
			s->product = 0;
		}
		wrong = PL(collocate)(s, start, slope, limit, rates, tried);
		if (wrong != PL_BY_SERIES) {
			return wrong;
		}
	}
}
