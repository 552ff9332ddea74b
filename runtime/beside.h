/* SPDX-License-Identifier: MIT-0 */
/* beside.h: derivatives of a model by a model of its own, whose states are those of the model and their derivatives by
 * some params: it goes the way of its own step beside the model.  Included by the file of the model for each of them,
 * which defines before it
 *
 *     PL(name), PL_OF(name)      the prefix of this model, and of the one that it is beside: PL_OF_TYPE
 *     PL_TYPE, PL_STATES, PL_INPUTS, PL_OUTPUTS      of this one
 *     PL_OWN_STATES, PL_OWN_OUTPUTS, PL_OWN_INPUTS, PL_DERIVATIVES, PL_SEEDED, PL_SLOPED    of the one beside
 *     PL_FROM, PL_WIDE          the first of its columns, and how many it has
 *     PL_DECLARED                  1: outputs are declared; else they are the states
 *     PL_ENDED(b)                whether b has no more of a series in hand, so that its states may be written
 *     PL_PAST_SAMPLES            of an input before the last
 *     PL_CONSTRAINTS             1: some hold, and PL(project_rounded) of constraints.h
 *     PL_SEGMENTS, PL_PLACES     spans of time in which loads have a formula each; 1: PL(place) follows a state
 *     PL_TUNED                   1: of a linear model, whose step may be tunable too
 *
 *     PL(moved_column)[PL_STATES]    of each state the column that it is of, -1: it is a state of the model;
 *     PL(moved_state)[PL_STATES]     and of which state; -1: of none, and 0; -2: it is t;
 *                                -3 - i: i, of a derivative by nothing
 *     PL_PROBED                  1: series as long as a tolerance allows end where the model's do, or where the
 *                                derivative of which PL_COUNTS is 2 lets them, whatever the others are
 *     PL_ALIGNED                 1: a collocation, whose steps begin anew where PL_ENDED(s) of the model, as long as
 *                                PL_SHARE of its own; PL_TURNS 1: it takes turns with a series
 *     PL_MOVED                   columns that go through events: member contact.doubt
 *     PL(moved_input)[PL_INPUTS]     of each input the model's; behind the first PL_OWN_INPUTS stand seeds */
#include "numbers.h"

/* t as a state, late by more than rounding: what changes where a step starts changes in that step, from wherever it is
 * taken */
static inline real PL(clock)(const PL_OF_TYPE *s)
{
	const real t = PL_OF(time)(s);
	return t - (real)0x1p-30 * PL_H - (PL_SINGLE ? (real)0x1p-17 : (real)0x1p-46) * pl_magnitude(t);
}

/* The states and derivatives that the model and ds have */
static void PL(both_states)(const PL_OF_TYPE *s, const PL_OF(d) *ds, real z[PL_STATES])
{
	real y[PL_OWN_STATES];
	int i;
	PL_OF(get)(s, y);
	for (i = 0; i < PL_STATES; i++) {
		const int p = PL(moved_column)[i], of = PL(moved_state)[i];
		z[i] = of == -2 ? PL(clock)(s) : of < 0 ? 0 : p < 0 ? y[of] : ds->s[p][of];
	}
}

/* Whether the model and ds are what the last step of both has left */
static int PL(is_left)(const PL_TYPE *b, const PL_OF_TYPE *s, const PL_OF(d) *ds, const real z[PL_STATES])
{
	real w[PL_STATES];
	int i, left = PL_OF(time)(s) == ds->time;
	PL(get)(b, w);
	for (i = 0; i < PL_STATES; i++) {
		const int own = PL(moved_column)[i] < 0 && PL(moved_state)[i] >= 0;
		left = left && (PL(moved_state)[i] < -1 || z[i] == (own ? ds->left[PL(moved_state)[i]] : w[i]));
	}
	return left;
}

static void PL(take_samples)(PL_TYPE *b, const PL_OF_TYPE *s, const PL_OF(d) *ds)
{
#if PL_INPUTS > 0
	int i;
	for (i = 0; i < PL_OWN_INPUTS; i++) {
		b->u[i] = s->u[i];
#if PL_PAST_SAMPLES > 0
		{
			int k;
			for (k = 0; k < PL_PAST_SAMPLES; k++) {
				b->past[i][k] = s->past[i][k];
			}
		}
#endif
	}
#if PL_SEEDED
	for (i = PL_OWN_INPUTS; i < PL_INPUTS; i++) {
		b->u[i] = ds->du[PL(moved_input)[i]];
	}
#endif
#endif
	(void)b;
	(void)s;
	(void)ds;
}

#if PL_PARAMS > 0
/* As the model has been retuned meanwhile; not 0: there are no such factors */
static int PL(follow_params)(PL_TYPE *b, const PL_OF_TYPE *s)
{
	int i, same = 1, status = 0;
	for (i = 0; i < PL_PARAMS; i++) {
		same = same && b->coeffs.params[i] == s->coeffs.params[i];
	}
#if PL_TUNED
	same = same && b->coeffs.h == s->coeffs.h;
#endif
	if (!same) {
		PL(coeffs) fresh = b->coeffs;
#if PL_TUNED
		status = PL(retune)(&fresh, s->coeffs.params, s->coeffs.h);
#else
		status = PL(retune)(&fresh, s->coeffs.params, PL_H);
#endif
		PL(use)(b, &fresh);
	}
	return status;
}
#endif

#if PL_PROBED
/* A series begins where the model's does, with what that knows: so derivatives are those of its numbers, and backwards
 * they are the same. */
static void PL(begin_series)(PL_TYPE *b, const PL_OF_TYPE *s, const real z[PL_STATES])
{
	int i;
	b->served = b->valid = s->valid;
	b->most = s->most;
	for (i = 0; i < PL_STATES; i++) {
		const int of = PL(moved_state)[i];
		b->y[i] = z[i];
		if (PL_COUNTS(i) == 1) {
			b->low[i] = s->low[of];
			b->scale[i] = s->scale[of];
			b->unit[i] = s->unit[of];
		}
	}
}

/* The one by nothing has something of every pattern of motion, each state as large as the model's. */
static void PL(probe)(PL_TYPE *b, const PL_OF_TYPE *s)
{
	int i;
	for (i = 0; i < PL_STATES; i++) {
		if (PL_COUNTS(i) == 2) {
			const int of = -3 - PL(moved_state)[i];
			const real turn = (real)0.6180339887 * (real)of, part = 1 - (turn - (real)(int)turn) / 2;
			b->scale[i] = part * (s->unit[of] > 0 ? 1 / s->unit[of] : 1);
			b->unit[i] = 1 / b->scale[i];
			b->y[i] = of % 2 ? -b->scale[i] : b->scale[i];
			b->low[i] = 0;
		}
	}
}
#endif

#if PL_ALIGNED
/* Anew at every eighth step of h, unless the model is in the internal step that it was in at the one before, with what
 * that knows: they start from nothing that they have chosen, so backwards they are the same. */
static void PL(begin_steps)(PL_TYPE *b, const PL_OF_TYPE *s, real z[PL_STATES])
{
	const real past = (real)(s->k % 8), ends = past + s->size + (s->at - (real)s->back);
	const int eighths = (int)(ends / 8);
	real y[PL_OWN_STATES];
	int i;
	PL_OF(exactly)(s, y);
	for (i = 0; i < PL_STATES; i++) {
		z[i] = PL_COUNTS(i) ? y[PL(moved_state)[i]] : z[i];
	}
#if PL_CONSTRAINTS
	(void)PL(project_rounded)(b, 0, z);
#endif
	for (i = 0; i < PL_STATES; i++) {
		const int of = PL(moved_state)[i];
		b->y[i] = z[i];
		b->low[i] = PL_COUNTS(i) ? s->low[of] : 0;
		b->scale[i] = PL_COUNTS(i) ? s->scale[of] : 0;
		b->unit[i] = PL_COUNTS(i) ? s->unit[of] : 0;
	}
	PL(anew)(b);
	b->until = b->k - s->k % 8 + 8 * (eighths + (ends > (real)(8 * eighths)));
	b->want = (real)PL_SHARE * (s->size > 0 ? s->size : s->want);
#if PL_TURNS
	b->series = s->series;
	b->stiff = s->stiff;
	b->product = s->product;
	b->bounds = s->bounds;
	b->patience = s->patience;
	b->run = s->run;
#endif
}
#endif

/* The states are the model's where a series begins, so that the derivatives are of what it computes; what was set
 * meanwhile begins anew. */
static void PL(follow)(PL_TYPE *b, const PL_OF_TYPE *s, const PL_OF(d) *ds)
{
	real z[PL_STATES];
	int i, left;
#if PL_PARAMS > 0
	(void)PL(follow_params)(b, s);
#endif
	PL(both_states)(s, ds, z);
	PL(take_samples)(b, s, ds);
	left = PL(is_left)(b, s, ds, z);
	if (!left) {
		PL(set)(b, PL_OF(time)(s), z);
#if PL_CONSTRAINTS && !PL_PROBED && !PL_ALIGNED
		/* Seeds, which have no time (back.h), need not fulfil the derivatives of the constraints: what they
		 * miss would
		 * go other ways by other steps, and the derivatives of a step were not linear in them. */
		if (ds->time <= (real)-0x1p120) {
			(void)PL(project_rounded)(b, 0, z);
			PL(set)(b, PL_OF(time)(s), z);
		}
#endif
#if PL_SEGMENTS > 1
		/* its time is counted in steps, not rounded: what changes now has changed */
		b->t0 = s->t0;
		b->k = s->k;
		b->segment = 0;
		PL(pass_segments)(b);
#if PL_PLACES
		PL(place)(b);
#endif
#endif
	}
	for (i = 0; i < PL_STATES && left && PL_ENDED(b); i++) {
		b->y[i] = PL(moved_column)[i] < 0 ? z[i] : b->y[i];
	}
#if PL_PROBED
	if (!left || PL_ENDED(s)) {
		PL(begin_series)(b, s, z);
	}
	if (PL_ENDED(b)) {
		PL(probe)(b, s);
	}
#elif PL_ALIGNED
	if (!left || PL_ENDED(s)) {
		PL(begin_steps)(b, s, z);
	}
#endif
}

#if PL_INPUTS > 0
static void PL(both_samples)(const real *u, const real *du, real both[PL_INPUTS])
{
	int i;
	for (i = 0; i < PL_INPUTS; i++) {
		both[i] = i < PL_OWN_INPUTS ? u[i] : du == NULL ? 0 : du[PL(moved_input)[i]];
	}
}
#define PL_BOTH , both
#else
#define PL_BOTH
#endif

static void PL(step_beside)(PL_TYPE *b, const PL_OF_TYPE *s, PL_OF(d) *ds, const real *u, const real *du)
{
	real z[PL_STATES];
	int i;
#if PL_INPUTS > 0
	real both[PL_INPUTS];
	PL(both_samples)(u, du, both);
#endif
#if PL_PARAMS > 0
	if (PL(follow_params)(b, s)) {
		pl_doubt_add(&ds->doubt, PL_D_FAILED, -1, PL_OF(time)(s));
	}
#endif
	PL(follow)(b, s, ds);
	PL(step)(b PL_BOTH);
	PL(get)(b, z);
	for (i = 0; i < PL_STATES; i++) {
		if (PL(moved_column)[i] >= 0) {
			ds->s[PL(moved_column)[i]][PL(moved_state)[i]] = z[i];
		}
	}
	if (PL(status)(b) & ~(PL_UNDECIDED | PL_INACCURATE)) {
		pl_doubt_add(&ds->doubt, PL_D_FAILED, -1, PL_OF(time)(s));
	}
#if PL_MOVED
	pl_doubt_join(&ds->doubt, &b->contact.doubt, PL_OF(time)(s));
#endif
	ds->status = ds->doubt.status;
	(void)u;
	(void)du;
}

#if PL_DECLARED
static void PL(out_beside)(const PL_OF_TYPE *s, const PL_OF(d) *ds, const PL_TYPE *from,
						   real J[PL_OWN_OUTPUTS][PL_DERIVATIVES])
{
	PL_TYPE b = *from;
	real out[PL_OUTPUTS];
	int i, p;
	PL(follow)(&b, s, ds);
	PL(out)(&b, out);
	for (i = 0; i < PL_OWN_OUTPUTS; i++) {
		for (p = 0; p < PL_WIDE; p++) {
			J[i][PL_FROM + p] = out[PL_OWN_OUTPUTS * (p + 1) + i];
		}
	}
}
#endif

#if PL_AT
static void PL(at_beside)(const PL_OF_TYPE *s, const PL_OF(d) *ds, const PL_TYPE *from, const real *u, const real *du,
						  real tau, real S[PL_DERIVATIVES][PL_OWN_STATES])
{
	PL_TYPE b = *from;
	real z[PL_STATES];
	int i;
#if PL_INPUTS > 0
	real both[PL_INPUTS];
	PL(both_samples)(u, du, both);
#endif
	PL(follow)(&b, s, ds);
	PL(at)(&b PL_BOTH, tau, z);
	for (i = 0; i < PL_STATES; i++) {
		if (PL(moved_column)[i] >= 0) {
			S[PL(moved_column)[i]][PL(moved_state)[i]] = z[i];
		}
	}
	(void)u;
	(void)du;
}
#endif

#include "undef.h"
