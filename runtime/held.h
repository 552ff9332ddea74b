/* SPDX-License-Identifier: MIT-0 */
/* held.h: tunable params of an instance that switching functions read.  Included by the file of the model, which
 * defines before it
 *
 *     PL_TYPE                    the model, with member coeffs, with leads lead, with modes k, y, which, eta and rate
 *     PL_PARAMS                  how many
 *     PL_WRAPPED                 1: PL(retune) is the model's own, and calls PL(retune_all)
 *     PL_RETUNED                 1: PL(retune) is the model's own, of whose numbers coeffs has more
 *     PL_LEADS                   sines in t whose frequency the params change, PL(frequencies)(s, w) [rad/s]
 *     PL_MODES                   normal modes of a step, from which PL(of_modes)(which, mode, q) makes coordinates
 *     PL_PLACES                  1: PL(place)(s) finds what follows from a state that was set */
#include "numbers.h"

#if !PL_RETUNED
#if PL_WRAPPED
static int PL(retune_all)(PL(coeffs) *c, const real params[PL_PARAMS], real h)
#else
int PL(retune)(PL(coeffs) *c, const real params[PL_PARAMS], real h)
#endif
{
	int i;
	if (h != PL_H) {
		return PL_NO_STEP;
	}
	if (pl_not_finite(params, PL_PARAMS)) {
		return PL_NOT_FINITE;
	}
	for (i = 0; i < PL_PARAMS; i++) {
		c->params[i] = params[i];
	}
	return 0;
}
#endif

/* A phase goes on from what it is now. */
void PL(use)(PL_TYPE *s, const PL(coeffs) *c)
{
#if PL_LEADS > 0
	const real t = PL(time)(s);
	real before[PL_LEADS], after[PL_LEADS];
	int i;
	PL(frequencies)(s, before);
	s->coeffs = *c;
	PL(frequencies)(s, after);
	for (i = 0; i < PL_LEADS; i++) {
		pl_lead_change(&s->lead[i], before[i], after[i], t);
	}
#else
	s->coeffs = *c;
#endif
#if PL_MODES > 0
	if (s->k > 0u) { /* s->y is the state that was set */
		PL(of_modes)(s->which, s->eta, s->y);
		PL(of_modes)(s->which, s->rate, s->y + PL_MODES);
	}
#endif
#if PL_PLACES
	PL(place)(s);
#endif
}

#include "undef.h"
