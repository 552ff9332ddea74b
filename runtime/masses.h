/* SPDX-License-Identifier: MIT-0 */
/* masses.h: part of access.h: where the mass matrix M of the state becomes singular.  Pivots of its elimination say it:
 * their signs stay as long as it is regular, those of a symmetric matrix one by one in their number, of another their
 * product; one that is never negative may touch 0.  The model has
 *
 *     PL_MASSES                  rows of M, multipliers of constraints among them; PL(masses)(s, tau, y, mass) its
 *                                entries that are not 0, tau after now; PL(mass_at_start) the sizes of its diagonal at
 *                                the start
 *     PL_FAILS                   1: a step may end before its time: PL(cause) says why
 *     PL_INDEFINITE              1: the end of each step is looked at, as nothing shows that M stays regular; members
 *                                pivot, regular; PL(mass_block)[]: 0, and at the last row of a block 1, or 2 of one
 *                                that is not symmetric; PL(rate_of)[]: the state that is the slope of another; -1: none
 *     PL_SAMPLED                 1: no tolerance bounds the step, which may pass more than one singular place */

/* Pivots at y, tau after now, and what they are small beside: their diagonal entries there or at the start */
static PL_APART void PL(pivots)(const PL_TYPE *s, real tau, const real y[PL_STATES], real pivot[PL_MASSES],
								real size[PL_MASSES])
{
	real mass[PL_MASSES][PL_MASSES] = {{0}};
	int i, j, k;
	PL(masses)(s, tau, y, mass);
	for (k = 0; k < PL_MASSES; k++) {
		size[k] = pl_magnitude(mass[k][k]);
		size[k] = size[k] < PL(mass_at_start)[k] ? PL(mass_at_start)[k] : size[k];
	}
	for (k = 0; k < PL_MASSES; k++) {
		pivot[k] = mass[k][k];
		for (i = k + 1; i < PL_MASSES; i++) {
			for (j = k + 1; j < PL_MASSES && !(mass[i][k] == 0); j++) {
				mass[i][j] -= mass[i][k] / pivot[k] * mass[k][j];
			}
		}
	}
}

#if PL_INDEFINITE
/* From y on as long as `time`, coordinates with their velocities */
static void PL(go_ahead)(const real y[PL_STATES], real time, real ahead[PL_STATES])
{
	int i;
	for (i = 0; i < PL_STATES; i++) {
		ahead[i] = y[i] + (PL(rate_of)[i] < 0 ? 0 : time * y[PL(rate_of)[i]]);
	}
}

/* Whether M is singular somewhere between two states, by its pivots there */
static int PL(passes_zero)(const real from[PL_MASSES], const real to[PL_MASSES])
{
	int changes = 0, k;
	for (k = 0; k < PL_MASSES; k++) {
		if (!(to[k] < 0 || to[k] > 0)) {
			return 1;
		}
		changes += (to[k] < 0) - (from[k] < 0);
		if (PL(mass_block)[k] == 1 ? changes != 0 : PL(mass_block)[k] == 2 && changes % 2 != 0) {
			return 1;
		}
		changes = PL(mass_block)[k] ? 0 : changes;
	}
	return 0;
}
#endif

#if PL_FAILS
#if PL_SINGLE
#define PL_PIVOT ((real)0.001953125) /* 2^-9 */
#else
#define PL_PIVOT 5.9604644775390625e-8 /* 2^-24 */
#endif

/* Whether M is singular a little ahead: where the coordinates are when they keep their velocities so long */
static int PL(ends_soon)(const PL_TYPE *s, real tau, const real y[PL_STATES], const real pivot[PL_MASSES])
{
#if PL_INDEFINITE
	real ahead[PL_STATES], then[PL_MASSES], size[PL_MASSES];
	PL(go_ahead)(y, PL_H / 64, ahead);
	PL(pivots)(s, tau, ahead, then, size);
	return PL(passes_zero)(pivot, then);
#else
	(void)s;
	(void)tau;
	(void)y;
	(void)pivot;
	return 0;
#endif
}

/* What a step tells that went wrong and left the state y, tau after now: one that fails ends shortly before a singular
 * place.  In float that is less near: terms of a series overflow before. */
static PL_APART int PL(cause)(const PL_TYPE *s, real tau, const real y[PL_STATES], int wrong)
{
	const int ended = (int)PL_NOT_FINITE | (int)PL_TOO_MANY_STEPS;
	real pivot[PL_MASSES], size[PL_MASSES];
	int k;
	if ((wrong & ended) == 0) {
		return wrong;
	}
	PL(pivots)(s, tau, y, pivot, size);
	for (k = 0; k < PL_MASSES && pl_magnitude(pivot[k]) > PL_PIVOT * size[k]; k++) {
	}
	return k < PL_MASSES || pl_not_finite(pivot, PL_MASSES) || PL(ends_soon)(s, tau, y, pivot)
			   ? (wrong & ~ended) | (int)PL_SINGULAR_MASS : wrong;
}
#endif

#if PL_INDEFINITE
/* From a state that was set */
static void PL(begin_mass)(PL_TYPE *s)
{
	real size[PL_MASSES];
	PL(get)(s, s->regular);
	PL(pivots)(s, 0, s->regular, s->pivot, size);
}

#if PL_SAMPLED
/* Whether pivots are the same but for a factor */
static int PL(are_near)(const real a[PL_MASSES], const real b[PL_MASSES], real factor)
{
	int k;
	for (k = 0; k < PL_MASSES && pl_magnitude(a[k]) <= factor * pl_magnitude(b[k]) &&
				pl_magnitude(b[k]) <= factor * pl_magnitude(a[k]); k++) {
	}
	return k == PL_MASSES;
}

/* Whether one is far smaller at a than at the ends of the step */
static int PL(touches_zero)(const real a[PL_MASSES], const real from[PL_MASSES], const real to[PL_MASSES])
{
	int k;
	for (k = 0; k < PL_MASSES && pl_magnitude(a[k]) > (real)1e-6 * (pl_magnitude(from[k])
			+ pl_magnitude(to[k])); k++) {
	}
	return k < PL_MASSES;
}

/* Pivots `ahead` of the step behind its start, on the cubic that has the places and velocities of both its ends */
static void PL(pivots_within)(const PL_TYPE *s, const real end[PL_STATES], real ahead, real pivot[PL_MASSES])
{
	real y[PL_STATES], size[PL_MASSES];
	int i;
	for (i = 0; i < PL_STATES; i++) {
		const real gain = end[i] - s->regular[i];
		const int rate = PL(rate_of)[i];
		y[i] = gain;
		if (rate >= 0) {
			const real from = PL_H * s->regular[rate], to = PL_H * end[rate];
			y[i] = from + ahead * ((3 * gain - 2 * from - to) + ahead * (from + to - 2 * gain));
		}
		y[i] = s->regular[i] + ahead * y[i];
	}
	PL(pivots)(s, (ahead - 1) * PL_H, y, pivot, size);
}

/* Whether M is singular somewhere on the way to `end`, where pivots are `to`.  It is looked at so closely that pivots
 * change by less than a half from one look to the next, also one that touches 0, or nearly vanish. */
static int PL(passes_zero_within)(const PL_TYPE *s, const real end[PL_STATES], const real to[PL_MASSES])
{
	const real longest = (real)0.125;
	real from[PL_MASSES], pivot[PL_MASSES], done = 0, part = longest;
	int k, looks, near;
	for (k = 0; k < PL_MASSES; k++) {
		from[k] = s->pivot[k];
	}
	for (looks = 0; looks < 1000 && done < 1; looks++) {
		part = part < 1 - done ? part : 1 - done;
		PL(pivots_within)(s, end, done + part, pivot);
		if (PL(passes_zero)(s->pivot, pivot)) {
			return 1;
		}
		near = PL(are_near)(from, pivot, (real)1.5);
		if (!near && part > (real)1e-6) {
			part /= 2;
			continue;
		}
		if (!near && PL(touches_zero)(pivot, s->pivot, to)) {
			return 1;
		}
		for (k = 0; k < PL_MASSES; k++) {
			from[k] = pivot[k];
		}
		done += part;
		part = 2 * part < longest ? 2 * part : longest;
	}
	return 0;
}

/* The same of the step behind.  One that is far too long may pass singular places twice, or land anywhere: then it is
 * on the straight way that its start would go on. */
static int PL(passes_within)(const PL_TYPE *s, const real y[PL_STATES], const real to[PL_MASSES],
							 const real size[PL_MASSES])
{
	real ahead[PL_STATES], pivot[PL_MASSES], there[PL_MASSES];
	int i;
	for (i = 0; i < PL_MASSES && pl_magnitude(s->pivot[i]) > size[i] / 16
			&& pl_magnitude(to[i]) > size[i] / 16; i++) {
	}
	if (i == PL_MASSES && PL(are_near)(s->pivot, to, 4)) {
		return 0;
	}
	PL(go_ahead)(s->regular, PL_H, ahead);
	PL(pivots)(s, 0, ahead, pivot, there);
	return PL(passes_zero_within)(s, y, to) || PL(passes_zero)(s->pivot, pivot) ||
		   PL(passes_zero_within)(s, ahead, pivot);
}
#endif

/* At the end of a step: one that has passed a singular place is not kept. */
static PL_APART void PL(stay_regular)(PL_TYPE *s)
{
	real y[PL_STATES], pivot[PL_MASSES], size[PL_MASSES];
	int i, passes;
	PL(get)(s, y);
	if (pl_not_finite(y, PL_STATES)) {
		return;
	}
	PL(pivots)(s, 0, y, pivot, size);
#if PL_SAMPLED
	passes = PL(passes_zero)(s->pivot, pivot) || PL(passes_within)(s, y, pivot, size);
#else
	passes = PL(passes_zero)(s->pivot, pivot);
#endif
	if (passes) {
		s->status |= PL_SINGULAR_MASS;
		PL(store_state)(s, s->regular);
#if PL_PLACES
		PL(place)(s);
#endif
		return;
	}
	for (i = 0; i < PL_STATES; i++) {
		s->regular[i] = y[i];
	}
	for (i = 0; i < PL_MASSES; i++) {
		s->pivot[i] = pivot[i];
	}
}
#endif
