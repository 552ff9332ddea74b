/* SPDX-License-Identifier: MIT-0 */
/* derivatives.h: NAME_init_d, NAME_set_d, NAME_get_d and NAME_run_d, derivatives beside the states that they are of,
 * and NAME_derivatives, by which programs find them.  Included by the file of the model, which defines before it
 *
 *     PL_TYPE, PL_DERIVATIVES    the model; how many columns
 *     PL_SEEDED                  1: some are along inputs: the last du is in ds->du, with slopes in ds->slope
 *     PL_SLOPED                  1: it is
 *     PL_BESIDE                  1: models of their own go beside it: members left, time, PL(init_beside)(ds)
 *     PL_BY_PHI                  1: PL(Phi) is what every step does to the state
 *     PL_SCALED                  1: the largest size of each state is in ds->scale
 *
 *     PL_PEAKS, PL_PEAK_OF(s)    outputs that are peaks, PL(peak_output)[]; their values.  Not where PL_AROUND is 1:
 *                                PL(one_step_d), PL(now_d) in the place of PL(step_d), PL(out_d), and ds->peak
 *
 *     PL_OUT_SIZE                of x, of which outputs are rows: PL(out_row)[segment][output][];
 *                                PL(columns)(s, ds, x, S) sets x and what of it varies, but for the states;
 *                                PL(out_first), PL(out_varied): the entries of the rows' derivatives.  0: PL(out_d) is
 *                                there already.  PL_RELATIVE 1: of what is kept of states, PL(keep_d)(S, kept)
 *     PL_BY_SLOPES               1: some outputs are no rows: PL(out_by_slopes)(s, ds, J) adds theirs
 *
 *     PL(d_initial)[][], PL(d_names)[]     of the first state; what the columns are by
 *     PL(d_input)[]              of each column the input that it is along, or -1; where PL_SEEDED
 *     PL(d_by)[][]               of each column what pl_derivatives says
 *     PL(step_d), PL(out_d)      a step of both; derivatives of outputs */
#include "numbers.h"

#if PL_INPUTS > 0
#define PL_TAKES , u
#define PL_GIVES , const real u[PL_INPUTS]
#else
#define PL_TAKES
#define PL_GIVES
#endif
#if PL_SEEDED
#define PL_ALONG , du
#define PL_GIVEN , u, du
#else
#define PL_ALONG
#define PL_GIVEN PL_TAKES
#endif

void PL(set_d)(PL(d) *ds, real S[PL_DERIVATIVES][PL_STATES])
{
	int i, p;
	for (p = 0; p < PL_DERIVATIVES; p++) {
		for (i = 0; i < PL_STATES; i++) {
			ds->s[p][i] = S == NULL ? 0 : S[p][i];
		}
	}
#if PL_SCALED
	for (i = 0; i < PL_STATES; i++) {
		ds->scale[i] = 0;
	}
#endif
#if PL_PEAKS > 0
	for (i = 0; i < PL_PEAKS; i++) {
		for (p = 0; p < PL_DERIVATIVES; p++) {
			ds->peak[i][p] = 0;
		}
	}
#endif
	ds->status = ds->doubt.status = 0;
}

void PL(get_d)(const PL_TYPE *s, const PL(d) *ds, real S[PL_DERIVATIVES][PL_STATES])
{
	int i, p;
	for (p = 0; p < PL_DERIVATIVES; p++) {
		for (i = 0; i < PL_STATES; i++) {
			S[p][i] = ds->s[p][i];
		}
	}
	(void)s;
}

void PL(init_d)(PL_TYPE *s, PL(d) *ds)
{
	int i, p;
	PL(init)(s);
	PL(set_d)(ds, NULL);
#if PL_BESIDE
	PL(init_beside)(ds);
	PL(get)(s, ds->left);
	ds->time = PL(time)(s);
#endif
	for (p = 0; p < PL_DERIVATIVES; p++) {
		for (i = 0; i < PL_STATES; i++) {
			ds->s[p][i] = PL(d_initial)[p][i];
		}
	}
#if PL_SEEDED
	for (i = 0; i < PL_INPUTS; i++) {
		ds->du[i] = 0;
#if PL_SLOPED
		ds->slope[i] = 0;
#endif
	}
#endif
}

#if PL_SLOPED
void PL(hold_d)(PL(d) *ds, const real du[PL_INPUTS])
{
	int i;
	for (i = 0; i < PL_INPUTS; i++) {
		ds->du[i] = du[i];
	}
}
#endif

#if PL_OUT_SIZE > 0
/* Outputs are rows over x, which vary too. */
#if PL_PEAKS > 0
static void PL(now_d)(
#else
void PL(out_d)(
#endif
	const PL_TYPE *s, const PL(d) *ds, real J[PL_OUTPUTS][PL_DERIVATIVES])
{
	real x[PL_OUT_SIZE], S[PL_DERIVATIVES][PL_OUT_SIZE] = {{0}};
#if PL_SEGMENTS > 1
	const int segment = s->segment;
#else
	const int segment = 0;
#endif
	int i, j, p;
	PL(columns)(s, ds, x, S);
	for (p = 0; p < PL_DERIVATIVES; p++) {
		const int *first = PL(out_first) + p * PL_SEGMENTS + segment;
#if PL_RELATIVE
		PL(keep_d)(ds->s[p], S[p]);
#else
		for (i = 0; i < PL_STATES; i++) {
			S[p][i] = ds->s[p][i];
		}
#endif
		for (i = 0; i < PL_OUTPUTS; i++) {
			J[i][p] = 0;
			for (j = 0; j < PL_OUT_SIZE; j++) {
				J[i][p] += PL(out_row)[segment][i][j] * S[p][j];
			}
		}
		for (j = first[0]; j < first[1]; j++) {
			J[PL(out_varied)[j].row][p] += PL(out_varied)[j].value * x[PL(out_varied)[j].column];
		}
	}
#if PL_BY_SLOPES
	PL(out_by_slopes)(s, ds, J);
#endif
}
#endif

#if PL_PEAKS > 0 && !PL_AROUND
/* ---- peaks: the derivative of an output is taken where it is largest ---- */

typedef struct PL(stride) {     /* a step: its start and end; a time in it */
	PL_TYPE from, s;
	PL(d) from_d, ds;
	const PL_TYPE *to;
	const PL(d) *to_d;
	const real *u, *du;
} PL(stride);

typedef struct PL(instant) {    /* states, and behind them an output; how each varies */
	real x[PL_STATES + 1], S[PL_DERIVATIVES][PL_STATES + 1];
} PL(instant);

static PL_APART void PL(instant_at)(PL(stride) *w, int o, real part, PL(instant) *at)
{
	const PL_TYPE *const s = &w->from;
	const real *const u = w->u, *const du = w->du;
	real out[PL_OUTPUTS], J[PL_OUTPUTS][PL_DERIVATIVES];
	int i, p;
	PL(values)(s, w->to, u, part, &w->s, out);
	w->ds = *w->to_d;
	PL(at_d)(s, &w->from_d PL_GIVEN, part * PL_H, w->ds.s);
#if PL_SLOPED
	for (i = 0; i < PL_INPUTS; i++) {
		w->ds.du[i] -= (1 - part) * PL_H * w->ds.slope[i];
	}
#endif
	PL(now_d)(&w->s, &w->ds, J);
	PL(get)(&w->s, at->x);
	at->x[PL_STATES] = out[o];
	for (p = 0; p < PL_DERIVATIVES; p++) {
		for (i = 0; i < PL_STATES; i++) {
			at->S[p][i] = w->ds.s[p][i];
		}
		at->S[p][PL_STATES] = J[o][p];
	}
	(void)u;
	(void)du;
}

#if PL_BY_VALUES
/* Values tell the time of a top to half their digits: here by the quartic through five of them, as long as that has it
 * there.  0: the output has a kink, or jumps */
static int PL(is_round)(PL(stride) *w, int o, real *when)
{
	const real epsilon = sizeof(real) == sizeof(float) ? (real)0x1p-23 : (real)0x1p-52;
	real apart = sizeof(real) == sizeof(float) ? (real)0x1p-4 : (real)0x1p-8;
	int k, i;
	for (k = 0; k < 3; k++, apart /= 4) {
		const real low = 2 * apart, middle = *when < low ? low : *when > 1 - low ? 1 - low : *when;
		real v[5], c[5], z = (*when - middle) / apart, off;
		for (i = 0; i < 5; i++) {
			real out[PL_OUTPUTS];
			PL(values)(&w->from, w->to, w->u, middle + (real)(i - 2) * apart, &w->s, out);
			v[i] = out[o];
		}
		c[1] = (8 * (v[3] - v[1]) - (v[4] - v[0])) / 12;
		c[2] = (16 * (v[3] - 2 * v[2] + v[1]) - (v[4] - 2 * v[2] + v[0])) / 24;
		c[3] = ((v[4] - v[0]) - 2 * (v[3] - v[1])) / 12;
		c[4] = ((v[4] + v[0]) - 4 * (v[3] + v[1]) + 6 * v[2]) / 24;
		off = 4 * (apart * pl_root(epsilon * pl_magnitude(v[2] / c[2]), 2) + pl_root(epsilon, 2));
		for (i = 0; i < 4; i++) {
			z -= (c[1] + z * (2 * c[2] + z * (3 * c[3] + z * 4 * c[4]))) / (2 * c[2]
					+ z * (6 * c[3] + z * 12 * c[4]));
		}
		z = middle + z * apart;
		if (pl_magnitude(z - *when) <= off && c[2] * v[2] < 0 &&
			pl_magnitude(c[4]) <= pl_magnitude(c[2]) / 32 + epsilon * pl_magnitude(v[2])) {
			*when = z < 0 ? 0 : z > 1 ? 1 : z;
			return 1;
		}
	}
	return 0;
}

/* Values and slopes, per step, at the event by those on one of its sides */
static void PL(side_of)(PL(stride) *w, int o, real when, real apart, PL(instant) *value, PL(instant) *slope)
{
	static const real of[3] = { 3, -3, 1 }, of_slope[3] = { -5, 8, -3 };
	PL(instant) at;
	int i, p, k;
	for (k = 0; k < 3; k++) {
		PL(instant_at)(w, o, when + (real)(k + 1) * apart, &at);
		for (i = 0; i <= PL_STATES; i++) {
			value->x[i] = of[k] * at.x[i] + (k ? value->x[i] : 0);
			slope->x[i] = of_slope[k] * at.x[i] / (2 * apart) + (k ? slope->x[i] : 0);
			for (p = 0; p < PL_DERIVATIVES; p++) {
				value->S[p][i] = of[k] * at.S[p][i] + (k ? value->S[p][i] : 0);
			}
		}
	}
}

/* At an event: dp/dp of its time is what takes one side of something that has a kink there to the other.  0: nothing
 * has, or the step ends */
static int PL(is_kink)(PL(stride) *w, int o, real when, real peak, real of[PL_DERIVATIVES])
{
	const real near = sizeof(real) == sizeof(float) ? (real)1e-3 : (real)1e-5; /* so close the time is known */
	real apart = 32 * near, best = (real)1e-3;
	PL(instant) value[2], slope[2];
	int i, p, kink = -1, side;
	apart = when < 3 * apart ? when / 3 : 1 - when < 3 * apart ? (1 - when) / 3 : apart;
	if (!(apart > near / 8)) {
		return 0;
	}
	PL(side_of)(w, o, when, -apart, &value[0], &slope[0]);
	PL(side_of)(w, o, when, apart, &value[1], &slope[1]);
	for (i = 0; i <= PL_STATES; i++) {
		const real turn = pl_magnitude(slope[1].x[i] - slope[0].x[i]);
		const real part = turn / (pl_magnitude(slope[1].x[i]) + pl_magnitude(slope[0].x[i]));
		if (part > best && pl_magnitude(value[1].x[i] - value[0].x[i]) < near * turn) {
			best = part;
			kink = i;
		}
	}
	side = pl_magnitude(value[1].x[PL_STATES]) > pl_magnitude(value[0].x[PL_STATES]);
	if (kink < 0 || pl_magnitude(pl_magnitude(value[side].x[PL_STATES]) - peak) > near * peak) {
		return 0;
	}
	for (p = 0; p < PL_DERIVATIVES; p++) {
		const real moved = -(value[1].S[p][kink] - value[0].S[p][kink]) / (slope[1].x[kink] - slope[0].x[kink]);
		of[p] = value[side].S[p][PL_STATES] + slope[side].x[PL_STATES] * moved;
	}
	return 1;
}
#endif

/* Of a peak in the step, `when` as a part of it.  0: it is not known */
static int PL(peak_moves)(PL(stride) *w, int o, real when, real peak, real of[PL_DERIVATIVES])
{
	PL(instant) at;
	real out[PL_OUTPUTS];
	int p, known = 1;
#if PL_BY_VALUES
	if (when > 0 && when < 1 && !PL(is_round)(w, o, &when)) {
		if (PL(is_kink)(w, o, when, peak, of)) {
			PL(instant_at)(w, o, when, &at);
			for (p = 0; p < PL_DERIVATIVES && at.x[PL_STATES] < 0; p++) {
				of[p] = -of[p];
			}
			return 1;
		}
		known = 0;
	}
#else
	(void)peak;
#endif
	if (when < 1) {
		PL(instant_at)(w, o, when, &at);
	} else {
		real J[PL_OUTPUTS][PL_DERIVATIVES];
		PL(now_d)(w->to, w->to_d, J);
		PL(now)(w->to, out);
		at.x[PL_STATES] = out[o];
		for (p = 0; p < PL_DERIVATIVES; p++) {
			at.S[p][PL_STATES] = J[o][p];
		}
	}
	for (p = 0; p < PL_DERIVATIVES; p++) {
		of[p] = at.x[PL_STATES] < 0 ? -at.S[p][PL_STATES] : at.S[p][PL_STATES];
	}
	return known;
}

/* Of two that are as large, with other derivatives, one is taken: do a and b differ by more than states' rounding? */
static int PL(is_other)(const PL(d) *ds, const real *a, const real *b)
{
	int i, p, other = 0;
	for (p = 0; p < PL_DERIVATIVES; p++) {
		real size = pl_magnitude(a[p]) + pl_magnitude(b[p]);
		for (i = 0; i < PL_STATES; i++) {
			size = pl_magnitude(ds->s[p][i]) > size ? pl_magnitude(ds->s[p][i]) : size;
		}
		other |= pl_magnitude(a[p] - b[p]) > size / 1024;
	}
	return other;
}

void PL(step_d)(PL_TYPE *s, PL(d) *ds PL_GIVES
#if PL_SEEDED
				, const real du[PL_INPUTS]
#endif
				)
{
	const real near = sizeof(real) == sizeof(float) ? (real)0x1p-14 : (real)0x1p-36;
	real begin[PL_OUTPUTS];
	PL(stride) w;
	int p, k;
	w.from = w.s = *s;
	w.from_d = *ds;
	w.to = s;
	w.to_d = ds;
	w.u = w.du = NULL;
#if PL_INPUTS > 0
	w.u = u;
#endif
#if PL_SEEDED
	w.du = du;
#endif
	PL(one_step_d)(s, ds PL_GIVEN);
	PL(now)(&w.from, begin);
	for (p = 0; p < PL_PEAKS; p++) {
		const int o = PL(peak_output)[p];
		const real before = w.from.peak[p];
		real when, of[PL_DERIVATIVES], most = PL(top)(&w.from, s, w.u, p, before * (1 - near), &when);
		if (when >= 0) {
			const int known = PL(peak_moves)(&w, o, when, most, of), past = pl_magnitude(begin[o]) < before;
			const int tied = past && most <= before * (1 + near) && PL(is_other)(ds, of, ds->peak[p]);
			if (tied || (!known && s->peak[p] > before)) {
				pl_doubt_add(&ds->doubt, PL_D_ONE_SIDED, -1, PL(time)(&w.from) + when * PL_H);
				ds->status = ds->doubt.status;
			}
			for (k = 0; k < PL_DERIVATIVES && s->peak[p] > before; k++) {
				ds->peak[p][k] = of[k];
			}
		}
	}
}

void PL(out_d)(const PL_TYPE *s, const PL(d) *ds, real J[PL_OUTPUTS][PL_DERIVATIVES])
{
	real out[PL_OUTPUTS];
	int p, k;
	PL(now_d)(s, ds, J);
	PL(now)(s, out);
	for (p = 0; p < PL_PEAKS; p++) {
		const int o = PL(peak_output)[p], past = s->peak[p] > pl_magnitude(out[o]);
		for (k = 0; k < PL_DERIVATIVES; k++) {
			J[o][k] = past ? ds->peak[p][k] : out[o] < 0 ? -J[o][k] : J[o][k];
		}
	}
}
#endif

void PL(run_d)(PL_TYPE *s, PL(d) *ds, size_t n
#if PL_INPUTS > 0
			   , const real *u
#endif
#if PL_SEEDED
			   , const real *du
#endif
			   , real *out, real *J)
{
	size_t k;
	for (k = 0; k < n; k++) {
		PL(step_d)(s, ds PL_GIVEN);
#if PL_INPUTS > 0
		u += PL_INPUTS;
#endif
#if PL_SEEDED
		du += du == NULL ? 0 : PL_INPUTS;
#endif
		if (out != NULL) {
			PL(out)(s, out + k * PL_OUTPUTS);
		}
		if (J != NULL) {
			PL(out_d)(s, ds, (real (*)[PL_DERIVATIVES])(J + k * PL_OUTPUTS * PL_DERIVATIVES));
		}
	}
}

#include "back.h"

/* ---- for programs ---- */

static void PL(any_init_d)(void *s, void *ds)
{
	PL(init_d)((struct PL_TYPE *)s, (PL(d) *)ds);
}

static void PL(any_step_d)(void *s, void *ds, const real *u, const real *du)
{
	(void)u;
	(void)du;
	PL(step_d)((struct PL_TYPE *)s, (PL(d) *)ds PL_GIVEN);
}

static void PL(any_out_d)(const void *s, const void *ds, real *J)
{
	PL(out_d)((const struct PL_TYPE *)s, (const PL(d) *)ds, (real (*)[PL_DERIVATIVES])J);
}

#if PL_SLOPED
static void PL(any_hold_d)(void *ds, const real *du)
{
	PL(hold_d)((PL(d) *)ds, du);
}
#endif

static unsigned PL(any_status_d)(const void *ds)
{
	return ((const PL(d) *)ds)->status;
}

static const pl_doubt *PL(any_doubt)(const void *ds)
{
	return &((const PL(d) *)ds)->doubt;
}

const pl_derivatives PL(derivatives) = {
	sizeof(PL(d)), PL_DERIVATIVES, PL(d_names), PL(any_init_d), PL(any_step_d), PL(any_out_d),
#if PL_SLOPED
	PL(any_hold_d),
#else
	NULL,
#endif
	PL(any_status_d), PL(d_by), PL(any_gradient), PL(any_doubt)
};

#include "undef.h"
