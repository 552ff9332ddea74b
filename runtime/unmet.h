/* SPDX-License-Identifier: MIT-0 */
/* unmet.h: a step of a model with friction or impacts that meets none of the guards of its region or, with PL_MEETS,
 * one, by the tables of its search: part of search.h, for small processors of guards.c, and over lanes of NAME_batch of
 * unmet_lanes.h.  Where none is met the search would take the same step, to the last bit: sums have its order, and what
 * is accepted here leaves nothing to take up, nothing that touches, and each guard below its limit by the bound of the
 * search.  A guard that has just been left, and what is less certain, go by the search.  PL_SUM(row, x) is of PL_SIZE
 * products; bit i of PL_CAPPED is set where x_i is never above 1.  PL_VALUE is a number, or lanes of numbers, and what
 * is true then so in some lanes.  With PL_SEEKS, behind these: a step of s. */
#ifndef PL_SEEKS
#ifndef PL_VALUE
#define PL_VALUE double
#define PL_TRUTH int
#define PL_UNMET(name) PL(name)
#define PL_ALL_OF(value) (value)
#define PL_MAGNITUDE(value) pl_magnitude(value)
#define PL_LARGER(a, b) ((a) > (b) ? (a) : (b))
#define PL_BELOW(a, b) ((a) < (b))
#define PL_IS_ZERO(size) ((size) <= 0.0)
#define PL_AND(a, b) ((a) & (b))
#define PL_FAILS(truth) (!(truth))
#define PL_STRANGE(x) (PL_SOFT && pl_not_finite(x, PL_SIZE))
#endif

#if PL_FEW_REGIONS
/* row . x in the order of the runtime's sums: of each fourth term, then these */
static PL_INLINE PL_VALUE PL_UNMET(product)(int j, const double *row, const PL_VALUE *x)
{
	return j < PL_SIZE && (row[j] < 0.0 || row[j] > 0.0) ? row[j] * x[j] : PL_ALL_OF(-0.0);
}

static PL_INLINE PL_VALUE PL_UNMET(fourth)(int j, const double *row, const PL_VALUE *x)
{
	return ((PL_UNMET(product)(j, row, x) + PL_UNMET(product)(j + 4, row, x)) + PL_UNMET(product)(j + 8, row, x)) +
		   PL_UNMET(product)(j + 12, row, x);
}

static PL_INLINE PL_VALUE PL_UNMET(sum)(const double *row, const PL_VALUE *x)
{
	return (PL_UNMET(fourth)(0, row, x) + PL_UNMET(fourth)(2, row, x)) +
		   (PL_UNMET(fourth)(1, row, x) + PL_UNMET(fourth)(3, row, x));
}
#define PL_SUM(row, x) PL_UNMET(sum)(row, x)
#define PL_EACH PL_UNROLL
#endif

/* Whether what a set holds is where it is held; at the end it is put there, all from the same x.  place: size */
static PL_INLINE PL_TRUTH PL_UNMET(holds)(const pl_guards *m, int set, const PL_VALUE *x, PL_VALUE *end,
										  PL_VALUE *place)
{
	const int first = m->set[set], last = m->set[set + 1];
	PL_TRUTH held = PL_BELOW(PL_ALL_OF(0.0), PL_ALL_OF(1.0));
	int k;
	PL_EACH
	for (k = first; k < last; k++) {
		const double *const value = m->value + k * PL_SIZE;
		held = PL_AND(held, PL_IS_ZERO(PL_MAGNITUDE(PL_SUM(value, x) - x[m->state[k]])));
		if (PL_FAILS(held)) {
			return held;
		}
		place[k - first] = 0.0 + PL_SUM(value, end);
	}
	PL_EACH
	for (k = first; k < last; k++) {
		end[m->state[k]] = place[k - first];
	}
	return held;
}

/* Whether guard k keeps below its limit from x to end: by its chord, h^2/8 of its second derivative, and what rounding
 * may hide at the start, 9 units in the last place of all terms; those of x are in the table */
static PL_INLINE PL_TRUTH PL_UNMET(keeps)(const pl_guards *m, int k, const PL_VALUE *x, const PL_VALUE *end,
										  const PL_VALUE *size)
{
	const int row = m->guard[k].row;
	const PL_VALUE from = PL_SUM(m->guards.row + row * PL_SIZE, x), to = PL_SUM(m->guards.row + row * PL_SIZE, end);
	const PL_VALUE off = PL_SUM(m->guards.chord_error + row * PL_SIZE, size);
	return PL_BELOW(PL_LARGER(from, to) + off,
					PL_ALL_OF(m->limit[k] - 2e-15 * (pl_magnitude(m->limit[k])
							+ m->guards.amplitude[row])));
}

/* Row i of a product, with 0 in the place of -0 as the search has it.  Where what multiplies x_i is above 0 there is no
 * -0 unless x_i was one; the addition that is spared there is one of the few that the next step waits for. */
static PL_INLINE PL_VALUE PL_UNMET(row_of)(const pl_guards *m, const double *matrix, int i, const PL_VALUE *x)
{
	const PL_VALUE sum = PL_SUM(matrix + i * PL_SIZE, x);
	(void)m; /* which a sum that is written out does not read */
	return matrix[i * PL_SIZE + i] > 0.0 ? sum : 0.0 + sum;
}

/* x over h in a region to end, and whether it is sure that nothing is met.  size, place: for sizes of x, and work */
static PL_INLINE PL_TRUTH PL_UNMET(keeps_all)(const pl_guards *m, int region, const PL_VALUE *x, PL_VALUE *end,
										  PL_VALUE *size, PL_VALUE *place)
{
	const int which = m->matrix[region], set = m->hold[region];
	PL_VALUE all = PL_ALL_OF(-0.0); /* which adds nothing: a compiler need not add it */
	PL_TRUTH kept;
	int i;
	if (which < 0 || PL_STRANGE(x)) {
		return PL_BELOW(PL_ALL_OF(0.0), PL_ALL_OF(-1.0));
	}
	PL_EACH
	for (i = 0; i < PL_SIZE; i++) {
		const int capped = i < 31 && (PL_CAPPED >> i) % 2 == 1;
		end[i] = PL_UNMET(row_of)(m, m->Phi + which * PL_SIZE * PL_SIZE, i, x);
		size[i] = capped ? PL_ALL_OF(1.0) : PL_MAGNITUDE(x[i]);
		all = all + (PL_SOFT || capped ? PL_ALL_OF(-0.0) : size[i]);
	}
	kept = PL_BELOW(all, PL_ALL_OF(1e300));
	if (!PL_FAILS(kept) && set >= 0) {
		kept = PL_AND(kept, PL_UNMET(holds)(m, set, x, end, place));
	}
	if (PL_FAILS(kept)) {
		return kept;
	}
	PL_EACH
	for (i = m->first[region]; i < m->first[region + 1]; i++) {
		kept = PL_AND(kept, PL_UNMET(keeps)(m, i, x, end, size));
		if (PL_FAILS(kept)) {
			return kept;
		}
	}
	return kept;
}

#if PL_MEETS
#if PL_COLUMNS_D > 0
/* Columns from x to end, h on: y is where guard k is met, if one is, and `behind` the region after it.  Where the
 * search would decide otherwise, it takes them. */
static void PL(take_along)(const pl_guards *m, int k, double when, double *x, double *y, double *end,
						   const pl_contact *before, int behind, double *work, pl_variation *v)
{
	const pl_variation begun = *v;
	pl_crossing crossing[PL_ROOM(PL_MAX_EVENTS)];
	pl_contact c = *before;
	double from[(PL_COLUMNS_D + 1) * PL_SIZE];
	int i;
	for (i = 0; i < (PL_COLUMNS_D + 1) * PL_SIZE; i++) {
		from[i] = v->S[i];
	}
	pl_guards_vary_d(m, when * m->h, x, k < 0 ? end : y, &c, v);
	if (k >= 0 && pl_guards_meet_d(m, k, when * m->h, y, &c, crossing, work, v) && c.region == behind) {
		pl_guards_vary_d(m, (1.0 - when) * m->h, y, end, &c, v);
	} else if (k >= 0) {
		*v = begun;
		for (i = 0; i < (PL_COLUMNS_D + 1) * PL_SIZE; i++) {
			v->S[i] = from[i];
		}
		c = *before;
		pl_guards_advance_d(m, m->h, x, &c, crossing, work, v);
	}
}
#endif
#include "meets.h"
#endif

#else

/* s over h in a region, where it is sure that no guard is met.  Stored here, as what all regions store behind them goes
 * through memory; and one by one, as two in one store would have to be put together first. */
static PL_INLINE int PL(unmet)(PL_TYPE *s, int region, const double x[PL_SIZE])
{
	double end[PL_SIZE], size[PL_SIZE], place[PL_SIZE];
	volatile double *const y = s->y;
	int i;
	if (!PL(keeps_all)(&PL(switching), region, x, end, size, place)) {
		return 0;
	}
	PL_EACH
	for (i = 0; i < PL_STATES; i++) {
		y[PL_PLACE(i)] = end[i];
	}
	s->contact PL_PART.crossings = 0;
	return 1;
}

#if PL_FEW_REGIONS
#define PL_CASE(k) case k: return k < PL_REGIONS && PL(unmet)(s, k, x);
#define PL_CASES(k) PL_CASE(k) PL_CASE(k + 1) PL_CASE(k + 2)

/* The same in the region where s is */
static PL_INLINE int PL(unmet_here)(PL_TYPE *s, double x[PL_VECTOR])
{
	const volatile double *const y = s->y; /* one by one, as they are stored: two in one load would wait for that */
	int i;
	PL_UNROLL
	for (i = 0; i < PL_STATES; i++) {
		x[i] = y[PL_PLACE(i)];
	}
	switch (s->contact PL_PART.region) {
	PL_CASES(0)
#if PL_REGIONS > 3
	PL_CASES(3)
	PL_CASES(6)
#endif
#if PL_REGIONS > 9
	PL_CASES(9)
	PL_CASES(12)
	PL_CASE(15)
#endif
	default:
		return 0;
	}
}
#else
static PL_INLINE int PL(unmet_here)(PL_TYPE *s, double x[PL_VECTOR])
{
	return PL(unmet)(s, s->contact PL_PART.region, x);
}
#endif

/* By the search.  x has no place in memory there, which each step would have to fill. */
static PL_INLINE void PL(seek_again)(PL_TYPE *s, const real x[PL_VECTOR])
{
	real again[PL_VECTOR];
	volatile real *const from = again;
	int i;
	PL_EACH
	for (i = PL_SOFT ? 0 : PL_STATES; i < PL_VECTOR; i++) {
		from[i] = x[i];
	}
	PL(by_search)(s, again);
}

/* s over h by that, or by the search */
static PL_INLINE void PL(seek)(PL_TYPE *s, real x[PL_VECTOR])
{
	if (PL_SOFT) {
		PL(by_search)(s, x);
	} else if (!PL(unmet_here)(s, x)) {
		PL(seek_again)(s, x);
	}
}
#endif
