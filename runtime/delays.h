/* SPDX-License-Identifier: MIT-0 */
/* delays.h: delayed inputs: it stores samples of the inputs, and gives the core, whose further inputs are the delayed
 * ones, those of the past.  Included by the file of the model, which defines before it
 *
 *     PL(name), PL_CORE(name)    the prefix of the model and of its core before a name
 *     PL_TYPE                    the model, with members core, past[PL_INPUTS][PL_RING], newest, and with ramps ends
 *     PL_STATES, PL_OUTPUTS      of both
 *     PL_INPUTS, PL_ALL          samples that are given; inputs of the core, the delayed ones behind those
 *     PL_PARTS                   steps of the core in one of the model
 *     PL_RING                    samples of each input, the newest among them
 *     PL_RAMPS                   whether some input goes straight from sample to sample
 *     PL_DERIVATIVES             columns of derivatives, those of the core; 0: none
 *     PL_LATE                    1: some param moves a delay: PL(late)[column][input][state]
 *     PL_PARAMS                  tunable ones; PL_SPEC_H then: step of the model [s]
 *     PL_AT                      whether there are values between steps; PL_CORE_H then: step of the core [s]
 *
 *     PL(input_of)[PL_ALL]       of each input of the core: of which sample it is,
 *     PL(parts_ago)[PL_ALL]      how many steps of the core ago,
 *     PL(is_ramp)[PL_ALL]        and whether it is a ramp */
#include "numbers.h"

static void PL(keep)(PL_TYPE *s, const real u[PL_INPUTS])
{
	int i;
	s->newest = s->newest + 1 == PL_RING ? 0 : s->newest + 1;
	for (i = 0; i < PL_INPUTS; i++) {
		s->past[i][s->newest] = u[i];
#if PL_RAMPS
		s->ends[i][s->newest] = u[i];
#endif
	}
}

/* Where the sample so many steps before the newest is: not the sample, of which a pointer to all samples would be an
 * address more in a loop over inputs */
static int PL(slot)(const PL_TYPE *s, int steps)
{
	const int at = s->newest - steps;
	return at < 0 ? at + PL_RING : at;
}

#if PL_RAMPS
#define PL_IS_HELD(i) !PL(is_ramp)[i]
#else
#define PL_IS_HELD(i) 1
#endif

#if PL_RAMPS
/* A ramp ends where PL(hold) may make the next begin anew, with a jump; delayed ones do so later. */
static real PL(ramp_now)(const PL_TYPE *s, int i, int ago)
{
	const int whole = ago / PL_PARTS;
	const real between = (real)(ago % PL_PARTS) / (real)PL_PARTS;
	const real now = s->ends[PL(input_of)[i]][PL(slot)(s, whole)];
	return between > 0 ? now + between * (s->past[PL(input_of)[i]][PL(slot)(s, whole + 1)] - now) : now;
}

/* Samples from which ramps of the core begin with a part of the step: u of those that do so there */
static void PL(starts)(const PL_TYPE *s, int part, real u[PL_ALL])
{
	int i;
	for (i = 0; i < PL_ALL; i++) {
		const int ago = PL(parts_ago)[i] + PL_PARTS - part;
		if (ago % PL_PARTS == 0 && PL(is_ramp)[i]) {
			u[i] = s->past[PL(input_of)[i]][PL(slot)(s, ago / PL_PARTS)];
		}
	}
}
#endif

/* Inputs of the core in a part of the step: 0 .. PL_PARTS - 1 */
static void PL(samples)(const PL_TYPE *s, int part, real u[PL_ALL])
{
	int i, at;
	for (i = 0; i < PL_ALL; i++) {
		const int ago = PL(parts_ago)[i] - part;
#if PL_RAMPS
		if (PL(is_ramp)[i]) {
			u[i] = PL(ramp_now)(s, i, ago + PL_PARTS - 1);
			continue;
		}
#endif
		at = PL(slot)(s, ago > 0 ? (ago + PL_PARTS - 1) / PL_PARTS : 0);
		u[i] = s->past[PL(input_of)[i]][at];
	}
}

/* The inputs of the core over a part of the step, of which ramps begin anew */
static void PL(samples_of_part)(PL_TYPE *s, int part, real all[PL_ALL])
{
	PL(samples)(s, part, all);
#if PL_RAMPS
	PL(starts)(s, part, s->core.u);
#endif
}

static void PL(step_core)(PL_TYPE *s, int part)
{
	real all[PL_ALL];
	PL(samples_of_part)(s, part, all);
	PL_CORE(step)(&s->core, all);
}

void PL(init)(PL_TYPE *s)
{
	int i, k;
	PL_CORE(init)(&s->core);
	for (i = 0; i < PL_INPUTS; i++) {
		for (k = 0; k < PL_RING; k++) {
			s->past[i][k] = 0;
#if PL_RAMPS
			s->ends[i][k] = 0;
#endif
		}
	}
	s->newest = 0;
}

void PL(set)(PL_TYPE *s, real t, const real y[PL_STATES])
{
	PL_CORE(set)(&s->core, t, y);
}

void PL(get)(const PL_TYPE *s, real y[PL_STATES])
{
	PL_CORE(get)(&s->core, y);
}

real PL(time)(const PL_TYPE *s)
{
	return PL_CORE(time)(&s->core);
}

int PL(status)(const PL_TYPE *s)
{
	return PL_CORE(status)(&s->core);
}

void PL(out)(const PL_TYPE *s, real out[PL_OUTPUTS])
{
	PL_CORE(out)(&s->core, out);
}

#if PL_RAMPS
void PL(hold)(PL_TYPE *s, const real u[PL_INPUTS])
{
	real all[PL_ALL];
	int i;
	for (i = 0; i < PL_INPUTS; i++) {
		if (PL(is_ramp)[i]) {
			s->past[i][s->newest] = u[i];
		}
	}
	PL(samples)(s, PL_PARTS - 1, all);
	PL(starts)(s, PL_PARTS, all);
	for (i = 0; i < PL_INPUTS; i++) {
		all[i] = u[i];
	}
	PL_CORE(hold)(&s->core, all);
}
#endif

void PL(step)(PL_TYPE *s, const real u[PL_INPUTS])
{
	int part;
	PL(keep)(s, u);
	for (part = 0; part < PL_PARTS; part++) {
		PL(step_core)(s, part);
	}
}

void PL(run)(PL_TYPE *s, size_t n, const real *u, real *out)
{
	for (; n > 0u; n--, u += PL_INPUTS) {
		PL(step)(s, u);
		if (out != NULL) {
			PL(out)(s, out);
			out += PL_OUTPUTS;
		}
	}
}

#if PL_PARAMS > 0
/* Delays are so many steps of the core, of which none is another. */
int PL(retune)(PL(coeffs) *c, const real params[PL_PARAMS], real h)
{
	return h == PL_SPEC_H ? PL_CORE(retune)(c, params, PL_CORE_H) : PL_NO_STEP;
}

void PL(use)(PL_TYPE *s, const PL(coeffs) *c)
{
	PL_CORE(use)(&s->core, c);
}
#endif

#if PL_AT
/* The part of the step in which tau is, and where in it */
static int PL(part_at)(real *tau)
{
	int part;
	for (part = 0; part < PL_PARTS - 1 && *tau > (real)(part + 1) * PL_CORE_H; part++) {
		;
	}
	*tau -= (real)part * PL_CORE_H;
	*tau = *tau < PL_CORE_H ? *tau : PL_CORE_H; /* rounding must not lead behind the part */
	return part;
}

void PL(at)(const PL_TYPE *s, const real u[PL_INPUTS], real tau, real y[PL_STATES])
{
	PL_TYPE now = *s;
	real all[PL_ALL];
	const int part = PL(part_at)(&tau);
	int k;
	PL(keep)(&now, u);
	for (k = 0; k < part; k++) {
		PL(step_core)(&now, k);
	}
	PL(samples_of_part)(&now, part, all);
	PL_CORE(at)(&now.core, all, tau, y);
}
#endif

#if PL_DERIVATIVES > 0

/* The same beside derivatives: where an input jumps, later by a param as dt is, they lose what the jump does in dt. */
static void PL(samples_of_part_d)(PL_TYPE *s, PL(d) *ds, int part, real all[PL_ALL])
{
#if PL_LATE
	real before[PL_ALL], jump;
	int p, i, k;
	for (k = 0; k < PL_ALL; k++) {
		before[k] = s->core.u[k];
	}
#endif
	PL(samples_of_part)(s, part, all);
#if PL_LATE
	for (k = 0; k < PL_ALL; k++) {
		jump = (PL_IS_HELD(k) ? all[k] : s->core.u[k]) - before[k];
		for (p = 0; p < PL_DERIVATIVES; p++) {
			for (i = 0; i < PL_STATES; i++) {
				ds->s[p][i] += PL(late)[p][k][i] * jump;
			}
		}
	}
#else
	(void)ds;
#endif
}

static void PL(step_core_d)(PL_TYPE *s, PL(d) *ds, int part)
{
	real all[PL_ALL];
	PL(samples_of_part_d)(s, ds, part, all);
	PL_CORE(step_d)(&s->core, ds, all);
}

void PL(step_d)(PL_TYPE *s, PL(d) *ds, const real u[PL_INPUTS])
{
	int part;
	PL(keep)(s, u);
	for (part = 0; part < PL_PARTS; part++) {
		PL(step_core_d)(s, ds, part);
	}
}

void PL(out_d)(const PL_TYPE *s, const PL(d) *ds, real J[PL_OUTPUTS][PL_DERIVATIVES])
{
	PL_CORE(out_d)(&s->core, ds, J);
}

#if PL_AT
void PL(at_d)(const PL_TYPE *s, const PL(d) *ds, const real u[PL_INPUTS], real tau,
			  real S[PL_DERIVATIVES][PL_STATES])
{
	PL_TYPE now = *s;
	PL(d) then = *ds;
	real all[PL_ALL];
	const int part = PL(part_at)(&tau);
	int k;
	PL(keep)(&now, u);
	for (k = 0; k < part; k++) {
		PL(step_core_d)(&now, &then, k);
	}
	PL(samples_of_part_d)(&now, &then, part, all);
	PL_CORE(at_d)(&now.core, &then, all, tau, S);
}
#endif
#endif

#include "undef.h"
