/* SPDX-License-Identifier: MIT-0 */
/* constraints.h: part of taylor.h and radau.h: a state is put back onto the model's constraints, positions and
 * velocities, at the end of each step, expansion and internal step, always: with a threshold the state would lean to
 * one side of them, and energy would drift.  The model has
 *
 *     PL(misses)(s, tau, y, miss)   tau after now: what has to be taken from each state so that the constraints hold to
 *                                first order: M^-1 G^T (G M^-1 G^T)^-1 g of positions, the same of velocities. The
 *                                mass matrix M measures how near that is, so motion along the constraints stays.
 *     PL_CONSERVES               T + V stays s->energy: PL(energies)(s, y, {T, V}), T quadratic in velocities, that is
 *                                in the second half of the states; constraints hold of any multiple of these
 *     PL_MASSES                  above 0: PL(cause) of masses.h says why a step has failed */
#define PL_PASSES 2 /* the second takes what the velocities' own miss is by that of the positions */

#if PL_CONSERVES
/* Velocities are scaled towards the energy that stays: what rounding changes of it is of one sign, and adds up.  By a
 * sixteenth of what is missing, as its own rounding is of no sign: so that adds less than the state's. */
static inline void PL(hold_energy)(const PL_TYPE *s, real y[PL_STATES], real low[PL_STATES])
{
	real energy[2], size, share;
	int i;
	PL(energies)(s, y, energy);
	size = 2 * energy[0] + pl_magnitude(energy[1]);
	share = (energy[0] + energy[1] - s->energy) / (16 * size);
	if (!(size > 0) || pl_not_finite(&share, 1)) {
		return;
	}
	for (i = PL_STATES / 2; i < PL_STATES; i++) {
		y[i] = pl_accumulate(y[i], -share * y[i], 0, &low[i]);
	}
}
#endif

#if PL_CONSTRAINTS
/* 0; PL_SINGULAR_MASS where none of its corrections is finite, and the state stays as it was */
static PL_APART int PL(put_back)(const PL_TYPE *s, real tau, real y[PL_STATES], real low[PL_STATES])
{
	real miss[PL_STATES];
	int i, pass;
	for (pass = 0; pass < PL_PASSES; pass++) {
		PL(misses)(s, tau, y, miss);
		if (pl_not_finite(miss, PL_STATES)) {
			return PL_SINGULAR_MASS;
		}
		for (i = 0; i < PL_STATES; i++) {
			y[i] = pl_accumulate(y[i], -miss[i], 0, &low[i]);
		}
	}
	return 0;
}

/* The same where no low parts are kept */
static inline int PL(project_rounded)(const PL_TYPE *s, real tau, real y[PL_STATES])
{
	real low[PL_STATES] = {0};
	return PL(put_back)(s, tau, y, low);
}
#define PL_PUT_BACK(s, tau, y) (void)PL(project_rounded)(s, tau, y)
#else
#define PL_PUT_BACK(s, tau, y) (void)(y)
#endif

#define PL_PROJECTS (PL_CONSTRAINTS || PL_CONSERVES)
#if PL_PROJECTS
static inline int PL(project)(const PL_TYPE *s, real tau, real y[PL_STATES], real low[PL_STATES])
{
#if PL_CONSTRAINTS
	const int wrong = PL(put_back)(s, tau, y, low);
#else
	const int wrong = 0;
	(void)tau;
#endif
#if PL_CONSERVES
	PL(hold_energy)(s, y, low);
#endif
	return wrong;
}
#endif

#if PL_MASSES > 0
#define PL_CAUSE(s, tau, y, wrong) PL(cause)(s, tau, y, wrong)
#else
#define PL_CAUSE(s, tau, y, wrong) (wrong)
#endif
