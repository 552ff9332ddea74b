/* SPDX-License-Identifier: MIT-0 */
/* access.h: NAME_init, NAME_set, NAME_get, NAME_time, NAME_status and NAME_hold, which convert between states of the
 * spec and of the step.  Included by the file of the model, which defines before it
 *
 *     PL_TYPE                    the model, with members y, t0, k, with a status status, with low parts low or carry
 *     PL_MODAL                   1: s->y are modes: PL(to_modes)[], PL(from_modes)[], PL(dot)(row, x); s->set is as set
 *     PL_NORMAL                  so many normal modes, from which PL(of_modes)(which, mode, q) makes coordinates
 *     PL_MOMENTA                 1: s->y is PL(mass)[] times a state
 *     PL_FORCED                  1: s->y is without PL(forced)(s, now); of PL_RELATIVE that is PL_SUSTAINED, a table of
 *                                PL_COLUMNS, times what PL(forced_loads)(s, load) gives; behind it stand the rows of
 *                                the states as written, whose product was s->start at the last set
 *     PL_WHOLE                   1: outputs read PL(kept)(s, x), of PL_RELATIVE too
 *     PL_COMPENSATED, PL_CARRIES        1: of each state what rounding took is in s->low; of so many in s->carry
 *     PL_RELATIVE                1: PL(keep)(y, x) and PL(written)(s, x, y), of models with rigid-body modes; set, from
 *     PL_PHASES, PL_ENVELOPES      of loads; PL_PHASE_RATE, PL(envelope_rate)[]; of envelopes below 0 PL(falls)[] is 1
 *     PL_LEADS, PL_PEAKS         members lead and peak; PL_BY_VALUES  1: rise too
 *     PL_REFRESHED                1: loads have a refresh: since, PL(refresh_phasors)(s)
 *     PL_SEGMENTS                of time, with PL(until)(s, change) [s]
 *     PL_STATUS, PL_RANGES       1: member status; ranges of PL(range_state)[]: PL(range)[][2]
 *     PL_PLACES                  1: PL(place)(s) finds what follows from a state that was set
 *     PL_MASSES                  of the state: with masses.h
 *     PL_OWN                     1: member coeffs, which begins as PL(nominal)
 *     PL_RAMPS, PL_PAST_SAMPLES   1: members slope and PL(hold); of inputs through PL(past_samples)[] + 1 samples at
 *                                most, past
 *     PL_H, PL_ELAPSED           step; time since t0 [s]
 *     PL(initial)[], PL(initial_set)[]     the first state as it is kept; the same as written */
#include "numbers.h"

/* Stores a state as written in the form that steps have (modes, momenta); its low parts become 0. */
static void PL(store_state)(PL_TYPE *s, const real y[PL_STATES])
{
	int i;
	for (i = 0; i < PL_STATES; i++) {
#if PL_MODAL
		s->set[i] = y[i];
		s->y[i] = PL(dot)(PL(to_modes)[i], y);
#elif PL_MOMENTA
		s->y[i] = PL(mass)[i] * y[i];
#else
		s->y[i] = y[i];
#endif
#if PL_COMPENSATED
		s->low[i] = 0;
#endif
	}
#if PL_CARRIES > 0
	for (i = 0; i < PL_CARRIES; i++) {
		s->carry[i] = 0;
	}
#endif
}

/* The state as written, read back from that form; a forced part is not added. */
static inline void PL(stored_state)(const PL_TYPE *s, real y[PL_STATES])
{
	int i;
#if PL_NORMAL > 0
	if (s->k > 0u) {
		PL(of_modes)(s->which, s->eta, y);
		PL(of_modes)(s->which, s->rate, y + PL_NORMAL);
		return;
	}
#endif
	for (i = 0; i < PL_STATES; i++) {
#if PL_MODAL
		y[i] = s->k == 0u ? s->set[i] : PL(dot)(PL(from_modes)[i], s->y);
#elif PL_MOMENTA
		y[i] = s->y[i] / PL(mass)[i];
#else
		y[i] = s->y[i];
#endif
	}
}

#if PL_FORCED && PL_RELATIVE
static void PL(sustained)(const real part[PL_STATES][PL_COLUMNS], const real load[PL_COLUMNS], real now[PL_STATES])
{
	int i, j;
	for (i = 0; i < PL_STATES; i++) {
		now[i] = 0;
		for (j = 0; j < PL_COLUMNS; j++) {
			now[i] += part[i][j] * load[j];
		}
	}
}

/* To y, the states as written, what these load states have moved them by since the last set */
static void PL(add_sustained)(const PL_TYPE *s, const real part[PL_STATES][PL_COLUMNS], const real load[PL_COLUMNS],
							  real y[PL_STATES])
{
	real now[PL_STATES];
	int i;
	PL(sustained)(part, load, now);
	for (i = 0; i < PL_STATES; i++) {
		y[i] += now[i] - s->start[i];
	}
}

static void PL(forced)(const PL_TYPE *s, real now[PL_STATES])
{
	real load[PL_COLUMNS];
	PL(forced_loads)(s, load);
	PL(sustained)(PL_SUSTAINED, load, now);
}
#endif

#if PL_FORCED && (!PL_RELATIVE || PL_WHOLE)
/* With it: what rounds off in the sum counts, so that it is what was set */
static void PL(kept)(const PL_TYPE *s, real x[PL_STATES])
{
	real now[PL_STATES];
	int i;
	PL(stored_state)(s, x);
	PL(forced)(s, now);
	for (i = 0; i < PL_STATES; i++) {
		const real z = x[i], sum = z + now[i], back = sum - z;
#if PL_COMPENSATED
		const real low = s->low[i];
#elif PL_RELATIVE
		const real low = 0;
#else
		const real low = s->k == 0u ? s->low[i] : 0;
#endif
		x[i] = sum + (((z - (sum - back)) + (now[i] - back)) + low);
	}
}
#endif

#if PL_FORCED

/* x = z + f, f the forced part: what rounds off in z = x - f is kept in low */
static void PL(keep_forced)(PL_TYPE *s, const real x[PL_STATES])
{
	real now[PL_STATES];
	int i;
	PL(forced)(s, now);
	for (i = 0; i < PL_STATES; i++) {
		const real f = now[i], z = x[i] - f, lost = z - x[i];
		s->y[i] = z;
#if PL_COMPENSATED || !PL_RELATIVE
		s->low[i] = (x[i] - (z - lost)) - (f + lost);
#else
		(void)lost;
#endif
#if PL_RELATIVE
		s->from[i] = z;
#endif
	}
#if PL_RELATIVE
	{
		real load[PL_COLUMNS];
		PL(forced_loads)(s, load);
		PL(sustained)(PL_SUSTAINED + PL_STATES, load, s->start);
	}
#endif
}
#endif

#if PL_SEGMENTS > 1
/* Changes of the loads that are now, but for what rounding of times is of a step, or past */
static inline void PL(pass_segments)(PL_TYPE *s)
{
#if PL_SINGLE
	const real now = (real)1e-8 * PL_H;
#else
	const real now = (real)1e-18 * PL_H;
#endif
	while (s->segment < PL_SEGMENTS - 1 && PL(until)(s, s->segment) <= now) {
		s->segment++;
	}
}
#endif

#if PL_INDEFINITE
static void PL(begin_mass)(PL_TYPE *s);
#endif

/* ---- set ---- */

/* What follows from t alone */
static void PL(begin_time)(PL_TYPE *s, real t)
{
#if PL_PHASES > 0 || PL_ENVELOPES > 0 || PL_LEADS > 0 || PL_PEAKS > 0
	int i;
#endif
	s->t0 = t;
	s->k = 0;
#if PL_STATUS
	s->status = 0;
#endif
#if PL_PHASES > 0
	for (i = 0; i < PL_PHASES; i++) {
		s->phase[i] = pl_phase_add(PL(phase_start)[i], pl_phase_at(&PL_PHASE_RATE[i], t));
	}
#endif
#if PL_ENVELOPES > 0
	for (i = 0; i < PL_ENVELOPES; i++) {
		s->envelope[i] = pl_envelope_at(&PL(envelope_rate)[i], PL(falls)[i], t);
	}
#endif
#if PL_LEADS > 0
	for (i = 0; i < PL_LEADS; i++) {
		pl_lead_start(&s->lead[i]);
	}
#endif
#if PL_PEAKS > 0
	for (i = 0; i < PL_PEAKS; i++) {
		s->peak[i] = 0;
#if PL_BY_VALUES
		s->rise[i] = (real)1e30; /* not known */
#endif
	}
#endif
#if PL_REFRESHED
	s->since = 0;
	PL(refresh_phasors)(s);
#endif
#if PL_SEGMENTS > 1
	s->segment = 0;
	PL(pass_segments)(s);
#endif
}

#if PL_RELATIVE
/* From the states as written, and as they are kept */
static void PL(begin_state)(PL_TYPE *s, real t, const real y[PL_STATES], const real x[PL_STATES])
#else
void PL(set)(PL_TYPE *s, real t, const real x[PL_STATES])
#endif
{
	PL(store_state)(s, x);
#if PL_RELATIVE
	{
		int i;
		for (i = 0; i < PL_STATES; i++) {
			s->set[i] = y[i];
#if PL_MOMENTA
			s->from[i] = s->y[i] / PL(mass)[i]; /* momenta have been rounded: gains count from there */
#else
			s->from[i] = x[i];
#endif
		}
	}
#endif
	PL(begin_time)(s, t);
#if PL_FORCED
	PL(keep_forced)(s, x);
#endif
#if PL_PLACES
	PL(place)(s);
#endif
#if PL_INDEFINITE
	PL(begin_mass)(s);
#endif
#if PL_CONSERVES
	{
		real energy[2];
		PL(energies)(s, x, energy);
		s->energy = energy[0] + energy[1];
	}
#endif
}

#if PL_RELATIVE
void PL(set)(PL_TYPE *s, real t, const real y[PL_STATES])
{
	real x[PL_STATES];
	PL(keep)(y, x);
	PL(begin_state)(s, t, y, x);
}
#endif

/* The tables are read through pointers whose value no compiler knows: with AVX-512, gcc 12 copies a table that it knows
 * by wide constants, and of {1, 1, 0, 0} it makes {1, 1, 1, 1}. */
void PL(init)(PL_TYPE *s)
{
	const real *volatile from = PL(initial);
#if PL_RELATIVE
	const real *volatile whole = PL(initial_set);
#endif
#if PL_INPUTS > 0
	int i;
#if PL_PAST_SAMPLES > 0
	int k;
#endif
	for (i = 0; i < PL_INPUTS; i++) {
		s->u[i] = 0;
#if PL_RAMPS
		s->slope[i] = 0;
#endif
#if PL_PAST_SAMPLES > 0
		for (k = 0; k < PL_PAST_SAMPLES; k++) {
			s->past[i][k] = 0;
		}
#endif
	}
#endif
#if PL_OWN
	s->coeffs = PL(nominal);
#endif
#if PL_RELATIVE
	PL(begin_state)(s, 0, whole, from);
#else
	PL(set)(s, 0, from);
#endif
}

/* ---- get, time, status ---- */

void PL(get)(const PL_TYPE *s, real y[PL_STATES])
{
#if PL_RELATIVE
	real x[PL_STATES];
#else
	real *const x = y;
#endif
#if PL_FORCED && !PL_RELATIVE
	PL(kept)(s, x);
#else
	PL(stored_state)(s, x);
#endif
#if PL_RELATIVE
	PL(written)(s, x, y);
#endif
#if PL_FORCED && PL_RELATIVE
	{
		real load[PL_COLUMNS];
		PL(forced_loads)(s, load);
		PL(add_sustained)(s, PL_SUSTAINED + PL_STATES, load, y);
	}
#endif
}

real PL(time)(const PL_TYPE *s)
{
	return s->t0 + PL_ELAPSED;
}

/* What is not finite is seen in the state now, in both words where it has two: a step has nothing to do for it, and
 * none can pass over it. */
int PL(status)(const PL_TYPE *s)
{
#if PL_RELATIVE || PL_MOMENTA
	real y[PL_STATES];
	int status;
	PL(get)(s, y);
	status = pl_not_finite(y, PL_STATES);
#else
	int status = pl_not_finite(s->y, PL_STATES);
#endif
#if PL_STATUS
	status |= s->status;
#endif
#if PL_COMPENSATED
	status |= pl_not_finite(s->low, PL_STATES);
#endif
	return status;
}

#if PL_RANGES > 0
/* Whether the states are in their ranges, at the end of a step.  What is not a number has left none, which
 * PL_NOT_FINITE tells. */
static void PL(stay)(PL_TYPE *s)
{
	real y[PL_STATES];
	int i;
	PL(get)(s, y);
	for (i = 0; i < PL_RANGES; i++) {
		if (y[PL(range_state)[i]] < PL(range)[i][0] || y[PL(range_state)[i]] > PL(range)[i][1]) {
			s->status |= PL_LEFT_RANGE;
		}
	}
}
#endif

#if PL_MASSES > 0
#include "masses.h"
#endif

/* ---- samples ---- */

#if PL_PAST_SAMPLES > 0
/* u is the next sample of an input that goes through some before it */
static void PL(next_sample)(PL_TYPE *s, int input, real u)
{
	const int past_samples = PL(past_samples)[input];
	int k;
	for (k = 0; k + 1 < past_samples; k++) {
		s->past[input][k] = s->past[input][k + 1];
	}
	s->past[input][past_samples - 1] = u;
	s->u[input] = s->past[input][(past_samples - 1) / 2];
}
#endif

#if PL_RAMPS
void PL(hold)(PL_TYPE *s, const real u[PL_INPUTS])
{
	int i;
	for (i = 0; i < PL_INPUTS; i++) {
#if PL_PAST_SAMPLES > 0
		if (PL(past_samples)[i] > 1) {
			PL(next_sample)(s, i, u[i]);
			continue;
		}
#endif
		s->u[i] = u[i];
	}
#if PL_PLACES && !PL_PAST_SAMPLES
	if (s->k == 0u) {
		PL(place)(s);
	}
#endif
}
#endif

#include "undef.h"
