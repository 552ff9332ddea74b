/* SPDX-License-Identifier: MIT-0 */
/* measure.h: what counts as the size of a state, for steps by tolerance: the largest so far.  Part of taylor.h, and
 * beside a collocation on its own, after
 *
 *     PL(name), PL_TYPE, PL_STATES     the model's prefix before a name; its type, with members scale and unit
 *     PL_NOW                     the member whose sizes are taken
 *     PL_KINDS, PL_KIND(i)       whether states of one kind are measured together; of which one state i is, 0 .. 2
 *     PL_COUNTS(i)                1, where state i counts; in models of derivatives 2 where its size is known; else 0
 *     PL_FLOORS                  whether PL(floor)[] is there: what counts beside the size that a state has now */
#include "numbers.h"

#if PL_SINGLE
#define PL_TRACE ((real)1e-25) /* the first trace of a pulse that is to come is measured by it */
#define PL_UNIT ((real)1e25)   /* 1 over it */
#else
#define PL_TRACE 1e-40
#define PL_UNIT 1e40
#endif

/* 1 over a size; `none` where that is 0 */
static inline real PL(one_over)(real size, real none)
{
	return size > PL_TRACE ? 1 / size : size > 0 ? PL_UNIT : none;
}

/* The size of state i now, where it counts; whether it did */
static inline int PL(take_size)(PL_TYPE *s, int i)
{
	const real size = pl_magnitude(s->PL_NOW[i]);
#if PL_FLOORS
	if (PL(floor)[i] > 0) {
		s->scale[i] = size + PL(floor)[i];
		return 1;
	}
#endif
	if (size > s->scale[i]) {
		s->scale[i] = size;
		return 1;
	}
	return 0;
}

#if PL_KINDS
/* The sizes of all states, and 1 over them; 0: it is 0.  Some are 0 for a while, or all but 0, and grow as high powers
 * of time: relative to themselves nothing would do.  So the largest of its kind counts for each too, by a millionth. */
static void PL(measure)(PL_TYPE *s)
{
	real most[3] = {0, 0, 0};
	int i, grown = 0;
	for (i = 0; i < PL_STATES; i++) {
		grown = (PL_COUNTS(i) == 1 && PL(take_size)(s, i)) || grown;
	}
	if (!grown) {
		return;
	}
	for (i = 0; i < PL_STATES; i++) {
		if (PL_COUNTS(i) == 1 && s->scale[i] > most[PL_KIND(i)]) {
			most[PL_KIND(i)] = s->scale[i];
		}
	}
	for (i = 0; i < PL_STATES; i++) {
		real least = most[PL_KIND(i)] / 1048576, size;
#if PL_FLOORS
		least = PL(floor)[i] > 0 ? 0 : least;
#endif
		size = s->scale[i] > least ? s->scale[i] : least;
		s->unit[i] = PL_COUNTS(i) == 1 ? PL(one_over)(size, 0) : s->unit[i];
	}
}
#else
/* The sizes of all states, and 1 over them; 0: it is 0 */
static void PL(measure)(PL_TYPE *s)
{
	int i;
	for (i = 0; i < PL_STATES; i++) {
		if (PL_COUNTS(i) == 1 && PL(take_size)(s, i)) {
			s->unit[i] = 1 / s->scale[i];
		}
	}
}
#endif
