/* SPDX-License-Identifier: MIT-0 */
/* flush.h: states that are all but nothing become 0.  Such numbers soon have fewer bits, for which some processors take
 * many times as long; to look every 64 steps is often enough.  A part of a model is what no other state acts on.  A
 * state becomes 0 that is below 2^-900 (float: 2^-120) of the largest of its part, and in a part that decays one below
 * 1e-290 (1e-35).  Included by the file of the model before its steps, and in batch.h for a lane each.  The file of the
 * model defines before it
 *
 *     PL_TYPE                    the model, with a member y, and low if compensated
 *     PL_FLUSHES, PL_DECAYING    parts; the first of them, which decay
 *     PL(flush_part)[]           of each state its part, where there is more than one
 *     PL_COMPENSATED             1: low parts of states become 0 with them */
#include "numbers.h"

#if PL_FLUSHES > 1
#define PL_PART(i) PL(flush_part)[i]
#else
#define PL_PART(i) 0
#endif

#if PL_SINGLE
#define PL_FLUSH_LEAST ((real)1e-35)
#define PL_FLUSH_SMALL ((real)0x1p-120)
#else
#define PL_FLUSH_LEAST 1e-290
#define PL_FLUSH_SMALL 0x1p-900
#endif

#if PL_FLUSHES_LANES
#define PL_FLUSHED pl_lanes
#define PL_FLUSH_ALL(value) pl_lanes_all(value)
#define PL_FLUSH_LARGER(size, value) pl_lanes_peak(size, value)
#define PL_FLUSH_KEPT(of, value, least) pl_lanes_kept(of, value, least)
PL_LANES_INLINE void PL(lanes_flush)(pl_lanes *y, pl_lanes *low)
#else
#define PL_FLUSHED real
#define PL_FLUSH_ALL(value) (value)
#define PL_FLUSH_LARGER(size, value) (pl_magnitude(value) > (size) ? pl_magnitude(value) : (size))
#define PL_FLUSH_KEPT(of, value, least) (pl_magnitude(of) < (least) && (least) < 1 ? 0 : (value))
static inline void PL(flush_states)(real *y, real *low)
#endif
{
    PL_FLUSHED least[PL_FLUSHES];
    int i;
    for (i = 0; i < PL_FLUSHES; i++) {
        least[i] = PL_FLUSH_ALL(0);
    }
    for (i = 0; i < PL_STATES; i++) {
        least[PL_PART(i)] = PL_FLUSH_LARGER(least[PL_PART(i)], y[i]);
    }
    for (i = 0; i < PL_FLUSHES; i++) {
        least[i] = least[i] * PL_FLUSH_SMALL;
        if (i < PL_DECAYING) {
            least[i] = PL_FLUSH_LARGER(least[i], PL_FLUSH_ALL(PL_FLUSH_LEAST));
        }
    }
    for (i = 0; i < PL_STATES; i++) {
#if PL_COMPENSATED
        low[i] = PL_FLUSH_KEPT(y[i], low[i], least[PL_PART(i)]);
#endif
        y[i] = PL_FLUSH_KEPT(y[i], y[i], least[PL_PART(i)]);
    }
    (void)low;
}
#undef PL_PART
#undef PL_FLUSHED
#undef PL_FLUSH_LEAST
#undef PL_FLUSH_SMALL
#undef PL_FLUSH_ALL
#undef PL_FLUSH_LARGER
#undef PL_FLUSH_KEPT

#if !PL_FLUSHES_LANES
static PL_APART void PL(flush)(PL_TYPE *s)
{
#if PL_COMPENSATED
    PL(flush_states)(s->y, s->low);
#else
    PL(flush_states)(s->y, NULL);
#endif
}

#include "undef.h"
#endif
