/* SPDX-License-Identifier: MIT-0 */
/* run.h: NAME_run, many steps in one call.  Included by the file of the model, which defines before it
 *
 *     PL_TYPE                    the model, with members y, k
 *     PL_INSIDE                  1: a series serves several steps: members served, valid, PL(inside)(s)
 *     PL_ROWS                    steps that PL(block) takes at once, with their outputs; 0: there is none
 *     PL_OVER                    1: they are those of one series, member served, and 0 of PL(block): its end is not
 *                                finite, and s as it was
 *     PL_REFRESHED                1: loads have a refresh, which stands at the start of a block
 *     PL_FLUSHES                 1: blocks of rows flush states, as steps do (flush.h) */
#include "numbers.h"

#if PL_SOFT && defined __GNUC__ && !defined __clang__ /* gcc would put it into all that call it */
PL_APART void PL(out)(const PL_TYPE *s, real out[PL_OUTPUTS]);
#endif

/* A step, and the outputs behind it unless out is NULL; where the next go */
static inline real *PL(run_on)(PL_TYPE *s, const real *u, real *out)
{
#if PL_INSIDE
	if (s->served + 1 < s->valid) {
		PL(inside)(s);
	} else {
		PL(step)(s);
	}
#elif PL_INPUTS > 0
	PL(step)(s, u);
#else
	PL(step)(s);
#endif
	(void)u;
	if (out == NULL) {
		return NULL;
	}
	PL(out)(s, out);
	return out + PL_OUTPUTS;
}

/* Not once more where the descriptor calls it */
#if PL_INPUTS > 0
PL_APART void PL(run)(PL_TYPE *s, size_t n, const real *u, real *out)
{
#else
PL_APART void PL(run)(PL_TYPE *s, size_t n, real *out)
{
	const real *const u = NULL;
#endif
#if PL_OVER
	for (; n > 0 && s->served > 0; n--) {
		out = PL(run_on)(s, u, out);
	}
#endif
#if PL_ROWS > 0
	if (n >= PL_ROWS) {
		PL_TYPE now = *s; /* over all blocks, so that its states may be in registers */
#if PL_REFRESHED
		PL(refresh_phasors)(&now);
#endif
		for (; n >= PL_ROWS; n -= PL_ROWS) {
#if PL_OVER
			if (!PL(block)(&now, out)) {
				break;
			}
#elif PL_INPUTS > 0
			PL(block)(&now, u, out);
			u += PL_ROWS * PL_INPUTS;
#else
			PL(block)(&now, out);
#endif
#if PL_FLUSHES > 0
			if ((now.k & 63u) < PL_ROWS) {
				PL(flush)(&now);
			}
#endif
			if (out != NULL) {
				out += PL_ROWS * PL_OUTPUTS;
			}
		}
		*s = now;
	}
#endif
	for (; n > 0; n--) {
		out = PL(run_on)(s, u, out);
#if PL_INPUTS > 0
		u += PL_INPUTS;
#endif
	}
}

#include "undef.h"
