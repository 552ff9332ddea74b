/* SPDX-License-Identifier: MIT-0 */
/* normal.h: steps in normal modes: each mode by itself is exact, under known loads too; other modal forces are
 * polynomials in time, through the forces at the ends of past steps (exponential Adams methods: predict, evaluate,
 * correct; Hochbruck and Ostermann, Acta Numerica 2010, section 2.5), or through those at Lobatto nodes of the step,
 * found by sweeps (exponential collocation; section 2.2).  Included by the file of the model, which defines before it
 *
 *     PL_TYPE                    the model, with members y, k, eta[PL_WIDTH], rate[PL_WIDTH], status, which, known, and
 *                                force[][PL_WIDTH], past[][2][PL_WIDTH], f[][PL_FUNCTIONS] of points or else nodes; of
 *                                methods with points newest, of several segments segment; past of the latter and of
 *                                operators alone, f where there are functions
 *     PL_MODES, PL_WIDTH         modes; length of a vector of them
 *     PL_POINTS                  past forces of an Adams method, as many as nodes; 0: each step is by collocation
 *     PL_TWICE                   whether those evaluate forces again once they have corrected
 *     PL_STAGES                  nodes of a step by collocation, beside its start
 *     PL_SWEEPS, PL_FIRST_SWEEPS from forces of the step before; where it begins anew
 *     PL_FUNCTIONS               of time, that forces read
 *     PL_FORCINGS                   values of known loads
 *     PL_OPERATORS               operators; of several PL_SELECTOR is the function of time that says which one serves
 *     PL_SEGMENTS                of time, in which loads and functions have their formulas
 *     PL_STEADY, PL_STEADY_IN  whether all functions are constant in the last one; the operator of the step then
 *     PL_AT                      whether there are states inside a step, by within.h
 *     PL_IN_MODES                1: part of event_split.h, whose step is PL(full_step), by collocation: s->y is the
 *                                state, and functions of time are the time of the node alone
 *     PL_PEAKS                   above 0: peaks.h has PL(step), and its PL(one_step) is here
 *
 *     PL(functions)(s, node, start, f)   functions of time at a node, with the formulas that hold at `start` [s]
 *     PL(forcings)(s, forcing)                 values of known loads now
 *     PL(mode_forces)(s, which, f, eta, rate, force)   on the modes; in event_split.h PL(on_modes)(which, left, force):
 *                                those of the remainder
 *     PL(modes_of)(which, q, mode), PL(of_modes)(which, mode, q)   modes of coordinates, and back
 *     PL(node_modes)(s, which, node, force, forcing, eta, rate)   modes at a node, 1 to PL_STAGES, from forces at all
 *     PL(forces_ahead)(s, force)         of collocation: those at the nodes that go on from the step before
 *     PL(predict)(s, which, forcing, eta, rate, expected)   of points: modes after the step, and the forces there
 *     PL(correct)[][2][PL_WIDTH]         what a force adds by its excess over that, of all operators or of one
 *     PL(bound)[], PL(next)[][][]   of a schedule: value up to which an operator serves; modes of the next from its
 *     PL(still)(x, forcing, sum)            once steady: [omega eta, eta'] after a step from those before
 *     PL(omega)[2][PL_WIDTH]             omega, 1 over it
 *     PL(until), PL(change)              of segments: time to each change, and the changes
 *     PL(pass_time)(s, u)                phases and time of a step
 *     PL(look)(s)                        at the state behind it: its ranges, its mass matrix */
#include "numbers.h"

#define PL_NODES (PL_STAGES + 1)
#if PL_OPERATORS > 1
#define PL_SERVING s->which
#else
#define PL_SERVING 0
#endif

/* At a node, with the formulas that hold in the step; `ended`: at its start, with those of the step before */
static inline void PL(functions_at)(const PL_TYPE *s, int node, int ended, real f[])
{
#if PL_IN_MODES
	(void)s;
	(void)ended;
	f[0] = PL(node)[node];
#elif PL_FUNCTIONS > 0
	PL(functions)(s, node, ended ? PL(time)(s) - PL_H / 2 : PL(time)(s) + PL_H / 2, f);
#else
	(void)s;
	(void)node;
	(void)ended;
	f[0] = 0; /* there are none */
#endif
}

static inline void PL(forcings_now)(const PL_TYPE *s, real forcing[])
{
#if PL_FORCINGS > 0
	PL(forcings)(s, forcing);
#else
	(void)s;
	forcing[0] = 0;
#endif
}

/* Functions of time of a point or node */
static inline void PL(keep_functions)(PL_TYPE *s, int place, const real f[])
{
#if PL_FUNCTIONS > 0
	int i;
	for (i = 0; i < PL_FUNCTIONS; i++) {
		s->f[place][i] = f[i];
	}
#else
	(void)s;
	(void)place;
	(void)f;
#endif
}

/* ---- a schedule of operators ---- */

#if PL_OPERATORS > 1
/* The first operator whose value is not below this */
static int PL(operator_at)(int which, real now)
{
	while (which < PL_OPERATORS - 1 && now > PL(bound)[which]) {
		which++;
	}
	while (which > 0 && now <= PL(bound)[which - 1]) {
		which--;
	}
	return which;
}

/* V^T M V is orthogonal: what goes back is transposed. */
static void PL(turn)(int from, int to, real mode[PL_WIDTH])
{
	while (from != to) {
		const int up = from < to, at = up ? from : from - 1;
		real more[PL_WIDTH];
		int i, j;
		for (i = 0; i < PL_WIDTH; i++) {
			more[i] = 0;
			for (j = 0; j < PL_WIDTH; j++) {
				more[i] += (up ? PL(next)[at][i][j] : PL(next)[at][j][i]) * mode[j];
			}
		}
		for (i = 0; i < PL_WIDTH; i++) {
			mode[i] += more[i];
		}
		from += up ? 1 : -1;
	}
}

/* From the modes of one operator to those of another: what is kept of the last steps too */
static void PL(serve)(PL_TYPE *s, int which)
{
	int k, d;
	PL(turn)(s->which, which, s->eta);
	PL(turn)(s->which, which, s->rate);
	for (k = 0; k < s->known; k++) {
		for (d = 0; d < 2; d++) {
			PL(turn)(s->which, which, s->past[k][d]);
		}
		PL(mode_forces)(s, which, s->f[k], s->past[k][0], s->past[k][1], s->force[k]);
	}
	s->which = which;
}
#endif

#if PL_IN_MODES
/* At f[0] after the start of the step, by the formulas that hold over it */
static void PL(mode_forces)(const PL_TYPE *s, int which, const real f[], const real eta[], const real rate[],
							real force[PL_WIDTH])
{
	real y[PL_STATES], left[PL_FORCES];
	PL(of_modes)(which, eta, y);
	PL(of_modes)(which, rate, y + PL_MODES);
	PL(forces_at)(s, NULL, NULL, f[0], PL(time_between)(s, 0, 1), PL(segment_of)(s), s->contact.interval, y, left);
	PL(on_modes)(which, left, force);
}
#endif

/* ---- a step by collocation ---- */

/* Forces at the nodes to begin with; how many sweeps go on from them */
static inline int PL(first_forces)(const PL_TYPE *s, int which, const real f[], real force[PL_NODES][PL_WIDTH])
{
	int i, k;
#if PL_POINTS == 0
	if (s->known) {
		PL(forces_ahead)(s, force);
		return PL_SWEEPS;
	}
#endif
	PL(mode_forces)(s, which, f, s->eta, s->rate, force[0]);
	for (k = 1; k < PL_NODES; k++) {
		for (i = 0; i < PL_WIDTH; i++) {
			force[k][i] = force[0][i];
		}
	}
	return PL_FIRST_SWEEPS;
}

#if PL_POINTS > 0
/* In a ring, the end of the step behind those of the steps before */
static inline void PL(keep_point)(PL_TYPE *s, const real f[], const real force[PL_WIDTH])
{
	int i;
	s->newest = s->newest + 1 < PL_POINTS ? s->newest + 1 : 0;
	s->known += s->known < PL_POINTS;
	for (i = 0; i < PL_WIDTH; i++) {
		s->force[s->newest][i] = force[i];
		s->past[s->newest][0][i] = s->eta[i];
		s->past[s->newest][1][i] = s->rate[i];
	}
	PL(keep_functions)(s, s->newest, f);
}
#endif

/* Forces are a polynomial through those at the nodes, which are left in `force`, of collocation alone in s->force. */
#if PL_POINTS > 0
static void PL(collocate)(PL_TYPE *s, real force[PL_NODES][PL_WIDTH])
{
#else
static void PL(collocate)(PL_TYPE *s)
{
	real force[PL_NODES][PL_WIDTH];
#endif
	real f[PL_NODES][PL_FUNCTIONS + 1], eta[PL_NODES][PL_WIDTH], rate[PL_NODES][PL_WIDTH], forcing[PL_FORCINGS + 1];
	const int which = PL_SERVING;
	int i, k, sweep, sweeps;
	PL(forcings_now)(s, forcing);
	for (k = 0; k < PL_NODES; k++) {
		PL(functions_at)(s, k, 0, f[k]);
	}
	sweeps = PL(first_forces)(s, which, f[0], force);
#if PL_POINTS > 0
	if (s->known == 0) {
		PL(keep_point)(s, f[0], force[0]);
	}
#elif PL_OPERATORS > 1
	for (i = 0; i < PL_WIDTH; i++) {
		eta[0][i] = s->eta[i];
		rate[0][i] = s->rate[i];
	}
#endif
	for (sweep = 0; sweep < sweeps; sweep++) {
		for (k = 1; k < PL_NODES; k++) {
			PL(node_modes)(s, which, k, force, forcing, eta[k], rate[k]);
			PL(mode_forces)(s, which, f[k], eta[k], rate[k], force[k]);
		}
	}
	for (i = 0; i < PL_WIDTH; i++) {
		s->eta[i] = eta[PL_STAGES][i];
		s->rate[i] = rate[PL_STAGES][i];
	}
#if PL_POINTS > 0
	PL(keep_point)(s, f[PL_STAGES], force[PL_STAGES]);
#else
	for (k = 0; k < PL_NODES; k++) {
		for (i = 0; i < PL_WIDTH; i++) {
			s->force[k][i] = force[k][i];
#if PL_OPERATORS > 1
			s->past[k][0][i] = eta[k][i];
			s->past[k][1][i] = rate[k][i];
#endif
		}
		PL(keep_functions)(s, k, f[k]);
	}
	s->known = PL_NODES;
#endif
}

/* ---- a step from past forces ---- */

#if PL_POINTS > 0
/* Predict, evaluate, correct; PL_TWICE: evaluate, `first` being the forces of the first time */
static void PL(advance)(PL_TYPE *s, real first[PL_WIDTH])
{
	real eta[PL_WIDTH], rate[PL_WIDTH], force[PL_WIDTH], expected[PL_WIDTH], f[PL_FUNCTIONS + 1],
		forcing[PL_FORCINGS + 1];
	const int which = PL_SERVING;
	int i;
	PL(forcings_now)(s, forcing);
	PL(predict)(s, which, forcing, eta, rate, expected);
	PL(pass_time)(s, NULL);
	PL(functions_at)(s, 0, 1, f);
	PL(mode_forces)(s, which, f, eta, rate, force);
	for (i = 0; i < PL_WIDTH; i++) {
		const real excess = force[i] - expected[i];
		s->eta[i] = eta[i] + PL(correct)[which][0][i] * excess;
		s->rate[i] = rate[i] + PL(correct)[which][1][i] * excess;
	}
#if PL_TWICE
	for (i = 0; i < PL_WIDTH; i++) {
		first[i] = force[i];
	}
	PL(mode_forces)(s, which, f, s->eta, s->rate, force);
#else
	(void)first;
#endif
	PL(keep_point)(s, f, force);
}
#endif

/* ---- once nothing changes any more ---- */

#if PL_STEADY
/* The step is exact. */
static void PL(settled_step)(PL_TYPE *s)
{
	real x[2 * PL_WIDTH], sum[2 * PL_WIDTH], forcing[PL_FORCINGS + 1];
	int i;
	PL(forcings_now)(s, forcing);
#if PL_OPERATORS > 1
	if (s->which != PL_STEADY_IN) {
		PL(serve)(s, PL_STEADY_IN);
	}
#endif
	for (i = 0; i < PL_WIDTH; i++) {
		x[i] = PL(omega)[0][i] * s->eta[i];
		x[PL_WIDTH + i] = s->rate[i];
	}
	PL(still)(x, forcing, sum);
	for (i = 0; i < PL_WIDTH; i++) {
		s->eta[i] = PL(omega)[1][i] * sum[i];
		s->rate[i] = sum[PL_WIDTH + i];
	}
	s->known = 0;
	PL(pass_time)(s, NULL);
}
#endif

/* ---- the whole ---- */

#if PL_IN_MODES
/* The modes of the state */
static void PL(take_modes)(PL_TYPE *s)
{
	PL(modes_of)(0, s->y, s->eta);
	PL(modes_of)(0, s->y + PL_MODES, s->rate);
}

/* The step, of which event_split.h asks whether it stands */
static inline void PL(full_step)(PL_TYPE *s)
{
	PL(collocate)(s);
	PL(of_modes)(0, s->eta, s->y);
	PL(of_modes)(0, s->rate, s->y + PL_MODES);
}
#else

/* Nothing is known of the steps before. */
static inline void PL(forget)(PL_TYPE *s)
{
	s->known = 0;
#if PL_POINTS > 0
	s->newest = PL_POINTS - 1;
#endif
}

/* What follows from a state that was set */
static void PL(place)(PL_TYPE *s)
{
#if PL_OPERATORS > 1
	real f[PL_FUNCTIONS + 1];
	PL(functions_at)(s, 0, 0, f);
	s->which = PL(operator_at)(0, f[PL_SELECTOR]);
#else
	s->which = 0;
#endif
	PL(forget)(s);
	PL(modes_of)(s->which, s->y, s->eta);
	PL(modes_of)(s->which, s->y + PL_MODES, s->rate);
}

#if PL_SEGMENTS > 1
/* Whether the next change of formula may be at hand: until then the time in one word is enough. */
static inline int PL(near)(const PL_TYPE *s)
{
	return PL(change)[s->segment].hi - PL(time)(s) <= PL_H + (real)1e-6 * PL(change)[s->segment].hi;
}

/* Where formulas change, past forces are of no use.  A change that is not at the end of a step is one of another t0
 * than 0. */
static inline void PL(pass_changes)(PL_TYPE *s)
{
	while (s->segment < PL_SEGMENTS - 1 && PL(near)(s) && PL(until)(s, s->segment) <= (real)1e-9 * PL_H) {
		if (PL(until)(s, s->segment) < (real)-1e-9 * PL_H) {
			s->status |= PL_INACCURATE; /* it was inside the step */
		}
		s->segment++;
		PL(forget)(s);
	}
}
#endif

#if PL_OPERATORS > 1
/* The operator for what the function of time is at the end of the step */
static inline void PL(choose)(PL_TYPE *s)
{
#if PL_POINTS > 0
	const int which = PL(operator_at)(s->which, s->f[s->newest][PL_SELECTOR]);
#else
	const int which = PL(operator_at)(s->which, s->f[PL_STAGES][PL_SELECTOR]);
#endif
	if (which != s->which) {
		PL(serve)(s, which);
	}
}
#endif

/* The step while something changes */
static inline void PL(changing_step)(PL_TYPE *s)
{
#if PL_POINTS > 0
	real force[PL_NODES][PL_WIDTH]; /* of the first steps */
	if (s->known < PL_POINTS) {
		PL(collocate)(s, force);
		PL(pass_time)(s, NULL);
	} else {
		PL(advance)(s, force[0]);
	}
#else
	PL(collocate)(s);
	PL(pass_time)(s, NULL);
#endif
#if PL_OPERATORS > 1
	PL(choose)(s);
#endif
#if PL_SEGMENTS > 1
	PL(pass_changes)(s);
#endif
}

#if PL_PEAKS > 0
static void PL(one_step)(PL_TYPE *s)
#else
void PL(step)(PL_TYPE *s)
#endif
{
#if PL_STEADY
	if (s->segment == PL_SEGMENTS - 1) {
		PL(settled_step)(s);
	} else {
		PL(changing_step)(s);
	}
#else
	PL(changing_step)(s);
#endif
	PL(look)(s);
	s->status |= pl_not_finite(s->eta, PL_WIDTH) | pl_not_finite(s->rate, PL_WIDTH);
}

#if PL_AT
#include "within.h"
#endif

#include "undef.h"
#endif
