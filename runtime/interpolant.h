/* SPDX-License-Identifier: MIT-0 */
/* interpolant.h: part of radau.h: the polynomial of an internal step, by what Newton's method finds at its nodes. */

/* What it gains from its start, theta of the step later */
static void PL(within)(const real c[PL_STAGES + 1][PL_COLUMNS], real theta, real gain[PL_STATES])
{
	int i, k;
	for (i = 0; i < PL_STATES; i++) {
		gain[i] = c[PL_STAGES][i];
	}
	for (k = PL_STAGES - 1; k > 0; k--) {
		for (i = 0; i < PL_STATES; i++) {
			gain[i] = gain[i] * theta + c[k][i];
		}
	}
	for (i = 0; i < PL_STATES; i++) {
		gain[i] *= theta;
	}
}

/* So long is the next internal step if it is no longer than `limit`, in h */
static inline real PL(wanted)(real want, real limit)
{
#if PL_ALIGNED
    const real steps = limit / want + (real)0.8; /* all that are left as long, a fifth longer than wanted at most */
    return steps < 2 ? limit : steps < 1024 ? limit / (real)(int)steps : want;
#else
    return want < limit ? want : limit;
#endif
}

#if PL_ORDER > 0
#include "switches.h"
#endif

/* The state `ahead` h after the start of the internal step, which reaches so far */
static void PL(inside)(const PL_TYPE *s, real ahead, real y[PL_STATES])
{
	real gain[PL_STATES];
	int i;
	if (ahead == s->size) {
		for (i = 0; i < PL_STATES; i++) {
			y[i] = s->start[i] + (s->gain[i] + s->low[i]);
		}
		return;
	}
#if PL_ORDER > 0
	if (s->series) {
		PL(ahead)(s->poly, ahead, gain);
	} else {
		PL(within)(s->poly, ahead * s->per, gain);
	}
#else
	PL(within)(s->poly, ahead * s->per, gain);
#endif
	for (i = 0; i < PL_STATES; i++) {
		y[i] = s->start[i] + (gain[i] + s->low[i]);
	}
}

#include "newton.h"

/* The highest derivatives of a polynomial, of which the unit of time is 1/per, at the nodes of a step that is so long
 * and begins at `from`: of the velocity the derivative, or of first order the coordinate's own, beyond its end */
static void PL(continue)(const real poly[PL_STAGES + 1][PL_COLUMNS], real from, real size, real per,
						 real k[PL_UNKNOWNS])
{
	int i, j, m;
	for (i = 0; i < PL_STAGES; i++) {
		const real theta = from + PL(node)[i] * size;
		for (j = 0; j < PL_COORDS; j++) {
			const int state = PL(highest)(j);
			real sum = PL_STAGES * poly[PL_STAGES][state];
			for (m = PL_STAGES - 1; m > 0; m--) {
				sum = sum * theta + (real)m * poly[m][state];
			}
			k[i * PL_COORDS + j] = sum * per;
		}
	}
}

/* The polynomial through the nodes; returns its last term as an error, relative to the sizes: over 2^(2 stages - 1) it
 * is what a polynomial of one degree less leaves out on 0 .. 1 (Chebyshev) */
static real PL(finish)(const real y[PL_STATES], real dt, const real unit[PL_STATES], const real k[PL_UNKNOWNS],
					   real poly[PL_STAGES + 1][PL_COLUMNS], real gain[PL_STATES])
{
	real most = 0;
	int i, j, m;
	for (j = 0; j < PL_COORDS; j++) {
		real v[PL_STAGES], once = 0, twice = 0;
		const int state = PL(highest)(j), twofold = state != j;
		for (i = 0; i < PL_STAGES; i++) {
			real sum = 0;
			for (m = 0; m < PL_STAGES; m++) {
				sum += PL(once)[i][m] * k[m * PL_COORDS + j];
			}
			v[i] = y[state] + dt * sum;
			once = sum;
			twice += PL(twice)[PL_STAGES - 1][i] * k[i * PL_COORDS + j];
		}
		gain[state] = dt * once;
		if (twofold) {
			gain[j] = dt * (y[state] + dt * twice);
		}
		for (i = 0; i < PL_STAGES; i++) {
			real rate = 0, speed = 0;
			for (m = 0; m < PL_STAGES; m++) {
				rate += PL(monomial)[i][m] * k[m * PL_COORDS + j];
				speed += PL(monomial)[i][m] * v[m];
			}
			poly[i + 1][state] = rate * (dt / (real)(i + 1));
			if (twofold) {
				poly[i + 1][j] = speed * (dt / (real)(i + 1));
			}
		}
	}
	for (i = 0; i < PL_STATES; i++) {
		const real last = pl_magnitude(poly[PL_STAGES][i]) * unit[i];
		most = last > most || last != last ? last : most;
	}
	return PL(ends)(y, gain) ? most / (real)((uint32_t)1 << (2 * PL_STAGES - 1)) : (real)1e35;
}

#if PL_FOLLOWED
/* The state now: the polynomial of an internal step is less exact than its end, so there is one that ends here. */
static void PL(exactly)(const PL_TYPE *s, real y[PL_STATES])
{
    const real none[1] = {0}, ahead = -PL(since)(s);
    real known[PL_STAGES][PL_ROOM(PL_KNOWN)], jacobian[PL_ROOM(PL_ENTRIES)], left[PL_COORDS];
    real poly[PL_STAGES + 1][PL_COLUMNS], unit[PL_STATES], k[PL_UNKNOWNS], gain[PL_STATES];
    int i, short_of = ahead > 0 && ahead < s->size;
#if PL_ORDER > 0
    short_of = short_of && !s->series; /* that is as exact all along */
#endif
    for (i = 0; i < PL_STATES; i++) {
        y[i] = s->y[i];
    }
    if (short_of) {
        PL(here)(s, none, none, left, jacobian);
        PL(continue)((const real (*)[PL_COLUMNS])s->poly, 0, ahead * s->per, s->per / PL_H, k);
        if (PL(solve)(s, none, none, jacobian, ahead, known, unit, k)) {
            (void)PL(finish)(s->start, ahead * PL_H, unit, k, poly, gain);
            for (i = 0; i < PL_STATES; i++) {
                y[i] = s->start[i] + (gain[i] + s->low[i]);
            }
        }
    }
}
#endif

#if PL_ARGUMENTS > 0 || PL_SWITCHING_FUNCTIONS > 0
/* Polynomials in powers of theta that are constant so far: c[0] is theirs to fill */
static void PL(no_slopes)(int degree, int columns, real c[])
{
	int i;
	for (i = columns; i < (degree + 1) * columns; i++) {
		c[i] = 0;
	}
}

/* The states at node k of a step with this polynomial */
static void PL(at_node)(const PL_TYPE *s, const real poly[PL_STAGES + 1][PL_COLUMNS], int k, real y[PL_STATES])
{
	int i;
	PL(within)(poly, PL(node)[k], y);
	for (i = 0; i < PL_STATES; i++) {
		y[i] += s->start[i];
	}
}

/* Polynomials of the first `count` columns through what stands in c[0] at the start, and in value at node k: what
 * that adds */
static inline void PL(add_node)(int columns, int count, int k, const real value[], real c[])
{
	int i, m;
	for (i = 0; i < count; i++) {
		const real rise = (value[i] - c[i]) / PL(node)[k];
		real *const at = c + i;
		PL_UNROLL
		for (m = 0; m < PL_STAGES; m++) {
			at[(m + 1) * columns] += PL(monomial)[m][k] * rise;
		}
	}
}
#endif
