/* SPDX-License-Identifier: MIT-0 */
/* served.h: part of taylor.h: how many steps a series serves, or which part of one, by what reach.h finds of it. */

#if PL_ADAPTIVE

/* The part of a step that the series serves, a power of 2 up to 1; 0: none */
static real PL(part)(const PL_TYPE *s, const real c[PL_ORDER + 1][PL_COLUMNS])
{
	const real shrink = 1 / (real)((uint64_t)1 << PL_ORDER);
	real last[PL_REMAINDERS], before[PL_REMAINDERS], part = 1;
	int halvings = 0;
	PL(remainders)(s, c, last, before);
	while (halvings < 60 && !(last[0] + last[1] + last[2] <= PL_TOLERANCE &&
							  before[0] + before[1] + before[2] <= PL_TOLERANCE)) {
		last[0] *= shrink;
		before[0] *= 2 * shrink;
		last[1] *= 4 * shrink;
		before[1] *= 8 * shrink;
		last[2] *= 16 * shrink;
		before[2] *= 32 * shrink;
		part /= 2;
		halvings++;
	}
#if PL_UNRESOLVED
	for (; halvings < 60 && !PL(shows)(c, part); halvings++) {
		part /= 2;
	}
#endif
	return halvings < 60 ? part : 0;
}

#if PL_INPUTS > 0
/* Steps that the series serves: 1, the samples to come are not known; 0: not even that */
static int PL(reach)(const PL_TYPE *s)
{
	return PL(part)(s, (const real (*)[PL_COLUMNS])s->series) >= 1;
}
#else
/* 1 over the largest size of column i so far, or where it has always been 0 over what it gains */
static inline real PL(unit_so_far)(const PL_TYPE *s, int i)
{
	const real one = pl_magnitude(s->series[1][i]), two = pl_magnitude(s->series[2][i]);
#if PL_KINDS && PL_CONSTRAINTS
	const real least = s->unit[i] == 0 && i < PL_STATES
						   ? PL(unit_of_gain)((const real (*)[PL_COLUMNS])s->series, i) : 0;
	if (least > 0) {
		return least;
	}
#endif
	return s->unit[i] == 0 ? PL(one_over)(one > two ? one : two, 1) : s->unit[i];
}

/* Steps that the series serves, at most PL_SERVES; 0: not even one.  What precedes it has shown that its last terms
 * tell what follows. */
static int PL(reach)(const PL_TYPE *s)
{
	real last = 0, before = 0;
	int i, m = s->valid;
	for (i = 0; i < PL_STATES + PL_MEASURED; i++) {
		const real unit = PL_COUNTS(i) ? PL(unit_so_far)(s, i) : 0;
		const real p = pl_magnitude(s->series[PL_ORDER][i]) * unit;
		const real q = pl_magnitude(s->series[PL_ORDER - 1][i]) * unit;
		last = p > last ? p : last;
		before = q > before ? q : before;
	}
	while (m < PL_SERVES && last <= PL(last)[m] && before <= PL(before_last)[m]) {
		m++;
	}
	while (m > 0 && !(last <= PL(last)[m - 1] && before <= PL(before_last)[m - 1])) {
		m--;
	}
#if PL_UNRESOLVED
	while (m > 0 && !PL(shows)((const real (*)[PL_COLUMNS])s->series, (real)m)) {
		m /= 2;
	}
#endif
	return m;
}
#endif

/* Whether the series c has at its end, `size` later, the slope that the equations have there: d is the series from
 * there on.  A first series may say nothing of what comes: x'' + x^3 = t^5 from rest has one term up to t^22.  What
 * lacks at the order P + 1 lacks P + 1 times in the slope at its end.  What rounding may take from the slope of a state
 * is counted by the largest of all. */
static int PL(agrees)(const PL_TYPE *s, const real c[PL_ORDER + 1][PL_COLUMNS],
					  const real d[PL_ORDER + 1][PL_COLUMNS], real size)
{
	real most = 0;
	int i;
	for (i = 0; i < PL_STATES; i++) {
		most = PL_COUNTS(i) && pl_magnitude(d[0][i]) > most ? pl_magnitude(d[0][i]) : most;
	}
	for (i = 0; i < PL_STATES; i++) {
		const real along = PL(slope_along)(c, i, size);
		real large = pl_magnitude(d[0][i]);
		large = s->scale[i] > large ? s->scale[i] : large;
		if (PL_KINDS && s->unit[i] > 0 && large * s->unit[i] < 1) {
			large = 1 / s->unit[i];
		}
#if PL_KINDS && PL_CONSTRAINTS
		if (s->unit[i] == 0 && large < PL(least_size)(d[0], i)) {
			large = PL(least_size)(d[0], i);
		}
#endif
		if (PL_COUNTS(i) && !(pl_magnitude(along - d[1][i]) * size <= PL_ORDER * PL_TOLERANCE * large
				+ PL_STATE_ROUNDED * most)) {
			return 0;
		}
	}
	return 1;
}

#endif

#if PL_WATCHED
/* Whether the last two terms, at this part of a step, are within the tolerance */
static inline int PL(is_accurate)(const PL_TYPE *s, const real c[PL_ORDER + 1][PL_COLUMNS], real size)
{
	real last[1], before[1], power = size;
	int k;
	PL(remainders)(s, c, last, before);
	for (k = 2; k < PL_ORDER && size < 1; k++) {
		power *= size;
	}
	return last[0] * (power * size) <= PL_TOLERANCE && before[0] * power <= PL_TOLERANCE;
}
#endif
