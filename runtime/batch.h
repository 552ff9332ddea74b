/* SPDX-License-Identifier: MIT-0 */
/* batch.h: NAME_batch, the step of a linear model over lanes, each an instance.  What instances share of a step (load
 * states, samples) is computed once, for some steps ahead; then groups of lanes go through these, their states in
 * locals.  The sums are those of NAME_step, in its order, so that an instance gets the bits of one that steps alone.
 * Included by the file of the model, behind lanes.h and where it defines
 *
 *     PL_ROWS, PL_STEPPED            numbers of an instance, the first of PL_TYPE: those that it has of its own, and,
 *                                    at the head of these, those that a step changes
 *     PL_GROUPS                      of lanes, that step in turns: sums of one wait for none of their own
 *     PL_SHARED                      numbers of a step that instances share: `now`
 *     PL_FACTORS, PL_LANES           that params decide: of an instance; of these those that lanes read
 *     PL_RAMPS                       whether there is PL(hold)
 *     PL_SHARES, PL_NOW              of PL(batch_share): 1: a row is `now`, 2: PL_HEAD, then inputs; its numbers
 *     PL_HEAD                        bytes at the head of PL_TYPE that hold all that instances share
 *     PL_TUNED                       whether what params decide is of one step: member h
 *
 *     PL(factor_at)[PL_FACTORS]               where in PL_TYPE each is
 *     PL(share_step)(s, u, now)               what a step reads of what instances share, which takes the step
 *     PL(share_out)(s, now)                   what outputs read of it
 *     PL(lanes_step)(y, factor, now)          one step of as many instances as there are lanes
 *     PL(lanes_out)(y, factor, now, out)      and their outputs
 *     PL_FLUSHES, PL_FLUSHES_BESIDE, PL_DECAYING, PL(flush_part)[], PL_COMPENSATED     of flush.h, where a step flushes
 *
 *     PL_EVENTS                      1: PL(lanes_step) leaves lanes that may have an event in the step as they are, and
 *                                    says which it has stepped; behind the states y has the region
 *     PL_OVER                        above 0: steps of a series of fixed order, series_lanes.h
 *     PL_LANES_PAY, PL_OUT_ALONE     of these, how many lanes pay; 1: outputs are those of NAME_out
 *
 * and where there are outputs that are the largest of something (peaks.h)
 *
 *     PL_PEAKS, PL(peak_output)[]             how many, and which
 *     PL_SIZE                                 numbers of x: the states and what acts on them
 *     PL_MOMENTA                              whether PL(velocities)(x) divides what is kept by masses
 *     PL_NOMINAL                              the bends of peaks.h with the values of the spec
 *     PL(lanes_bend)(state, factor, reach, bend)      how far outputs are off their chords at most, by |states| and by
 *                                             what else acts with the values of the spec
 *     PL_SAMPLED                              whether nothing acts but polynomials through samples:
 *     PL_H                                    a step of s [s],
 *     PL(sample_column)[], PL(sample_degree)[], PL(sample_reach)[][]     of each input where in x its polynomial is,
 *                                             its degree; how much of the largest sample is in each derivative, in h */
#include "numbers.h"

#include "given.h"

#define PL_AT_ONCE (sizeof(pl_lanes) / sizeof(real))
#define PL_HAS(count) ((count) > 0 ? (count) : 1) /* no array is empty */
#ifndef PL_NOW
#define PL_NOW PL_SHARED
#endif
#if PL_OVER > 0
#define PL_AHEAD 16 /* the struct of each step ahead is kept */
#else
#define PL_AHEAD 64
#endif
#if PL_FLUSHES > 0
#define PL_READY(k) (PL_AHEAD - (size_t)((k) & (PL_AHEAD - 1))) /* up to where a step flushes */
#else
#define PL_READY(k) PL_AHEAD
#endif

/* What instances share in some steps ahead: [0] before the first, [k] in step k and behind it */
typedef struct PL(steps_ahead) {
	size_t steps;
	int flushes; /* the last step does */
	real now[PL_AHEAD + 1][PL_HAS(PL_SHARED)];
#if PL_PEAKS > 0
	real acting[PL_AHEAD + 1][PL_SIZE - PL_STATES + PL_PEAKS]; /* on the states, then how far it bends outputs */
	real reach[PL_PEAKS];                                      /* that at most */
	int known; /* is `acting` filled in?  From these, the samples of the steps: */
	PL_TYPE from;
#endif
#if PL_EVENTS
	unsigned char head[PL_AHEAD + 1][PL_HEAD]; /* of an instance, what all share */
#endif
	const real *u;
} PL(steps_ahead);

#include "lanes_alone.h"

/* ---- lanes from the arrays and back ---- */

/* From j on: beyond the last there are none. */
PL_LANES_INLINE size_t PL(lanes_left)(const PL_INSTANCES *b, size_t j)
{
	return j < b->count ? b->count - j : 0;
}

/* As many instances as there are lanes, from j on */
PL_LANES_INLINE void PL(lanes_take)(const PL_INSTANCES *b, size_t j, pl_lanes *y, pl_lanes *factor, pl_lanes *peak)
{
	const size_t left = PL(lanes_left)(b, j), first = left ? j : 0;
	size_t i;
	PL_LANES_UNROLL
	for (i = 0; i < PL_STEPPED; i++) {
		y[i] = pl_lanes_load(b->y + i * b->count + first, left);
	}
	PL_LANES_UNROLL
	for (i = 0; i < PL_OUTPUTS; i++) {
		peak[i] = pl_lanes_load(b->peak ? b->peak + i * b->count + first : b->y, b->peak ? left : 0);
	}
#if PL_FACTORS > 0
	for (i = 0; i < PL_LANES; i++) {
		if (b->factors) {
			factor[i] = pl_lanes_load(b->factors + i * b->count + first, left);
		} else {
			real all;
			memcpy(&all, (const char *)&b->shared + PL(factor_at)[i], sizeof all);
			factor[i] = pl_lanes_all(all);
		}
	}
#else
	factor[0] = pl_lanes_all(0);
#endif
}

PL_LANES_INLINE void PL(lanes_give)(PL_INSTANCES *b, size_t j, const pl_lanes *y, const pl_lanes *peak)
{
	const size_t left = PL(lanes_left)(b, j), first = left ? j : 0;
	size_t i;
	PL_LANES_UNROLL
	for (i = 0; i < PL_STEPPED; i++) {
		pl_lanes_store(b->y + i * b->count + first, y[i], left);
	}
	if (!b->peak) {
		return;
	}
	PL_LANES_UNROLL
	for (i = 0; i < PL_OUTPUTS; i++) {
		pl_lanes_store(b->peak + i * b->count + first, peak[i], left);
	}
}

#if PL_PEAKS > 0
/* ---- what acts on the states, and how far it bends outputs ---- */

/* At the start of a step, with the values of the spec */
static void PL(share_acting)(const PL_TYPE *s, const real *u, real acting[PL_SIZE - PL_STATES + PL_PEAKS])
{
	real x[PL_SIZE];
	int i, p;
	PL(begin_step)(s, u, x);
	for (i = PL_STATES; i < PL_SIZE; i++) {
		acting[i - PL_STATES] = x[i];
	}
	for (p = 0; p < PL_PEAKS; p++) {
		real reach = 0;
		for (i = PL_STATES; i < PL_SIZE; i++) {
			reach += PL_NOMINAL[p][i] * pl_magnitude(x[i]);
		}
		acting[PL_SIZE - PL_STATES + p] = reach;
	}
}

#if PL_SAMPLED
/* How far at most the samples of the steps bend outputs: by each derivative of the polynomial through them */
static void PL(share_reach)(const PL_TYPE *s, const real *u, size_t n, real reach[PL_PEAKS])
{
	size_t k;
	int i, m, p;
	for (p = 0; p < PL_PEAKS; p++) {
		reach[p] = 0;
	}
	for (i = 0; i < PL_INPUTS; i++) {
		real most = 0;
		for (m = 0; m < PL(sample_degree)[i]; m++) {
			most = pl_larger_size(most, s->past[i][m]);
		}
		for (k = 0; k < n; k++) {
			most = pl_larger_size(most, u[k * PL_INPUTS + (size_t)i]);
		}
		for (m = 0; m <= PL(sample_degree)[i]; m++) {
			for (p = 0; p < PL_PEAKS; p++) {
				reach[p] += most * (PL(sample_reach)[i][m] * PL_NOMINAL[p][PL(sample_column)[i] + m]);
			}
			most /= PL_H;
		}
	}
}
#endif

/* What acts on the states in the steps ahead, where samples alone did not say */
static void PL(ahead_acting)(PL(steps_ahead) *ahead)
{
	real now[PL_HAS(PL_SHARED)];
	size_t k;
	for (k = 1; k <= ahead->steps && !ahead->known; k++) {
		PL(share_acting)(&ahead->from, ahead->u, ahead->acting[k]);
		PL(share_step)(&ahead->from, ahead->u, now);
		ahead->u += PL_INPUTS;
	}
	ahead->known = 1;
}

/* ---- peaks in a step ---- */

/* Of what lanes' states and outputs are at most, in a step or in some: may values in between have passed a peak? */
PL_LANES_INLINE int PL(lanes_may_pass)(const pl_lanes *state, const pl_lanes *factor, const real *reach,
							   const pl_lanes *top, const pl_lanes *peak, pl_lanes *most)
{
	int any = 0, p;
	PL(lanes_bend)(state, factor, reach, most);
	PL_LANES_UNROLL
	for (p = 0; p < PL_PEAKS; p++) {
		most[p] = top[PL(peak_output)[p]] + most[p];
		any |= pl_lanes_above(most[p], peak[PL(peak_output)[p]]);
	}
	return any;
}

/* Peaks of which values inside the step may pass are looked for: only then lanes are in memory. */
PL_LANES_INLINE void PL(lanes_between)(const PL_INSTANCES *b, size_t j, const pl_lanes *start, const pl_lanes *factor,
					   const real *acting, pl_lanes *before, pl_lanes *value, pl_lanes *peak)
{
	pl_lanes top[PL_OUTPUTS], most[PL_PEAKS]; /* at its ends, in it */
	int i;
	PL_LANES_UNROLL
	for (i = 0; i < PL_OUTPUTS; i++) {
		top[i] = pl_lanes_peak(pl_lanes_peak(pl_lanes_all(0), before[i]), value[i]);
	}
	if (PL(lanes_may_pass)(start, factor, acting + (PL_SIZE - PL_STATES), top, peak, most)) {
		pl_lanes from[PL_STATES], bound[PL_PEAKS], to[PL_OUTPUTS], largest[PL_OUTPUTS];
		memcpy(from, start, sizeof from);
		memcpy(bound, most, sizeof bound);
		memcpy(to, value, sizeof to);
		memcpy(largest, peak, sizeof largest);
		PL(lanes_look)(b, j, from, acting, bound, to, largest);
		memcpy(peak, largest, sizeof largest);
	}
	PL(lanes_widen)(peak, value, PL_OUTPUTS);
	memcpy(before, value, PL_OUTPUTS * sizeof *before);
	PL_LANES_UNROLL
	for (i = 0; i < PL_PEAKS; i++) {
		value[PL(peak_output)[i]] = peak[PL(peak_output)[i]];
	}
}
#endif

/* ---- groups of lanes over the steps ahead ---- */

/* Of some instances the sums as NAME_many has them, or back */
PL_LANES_INLINE void PL(sums_move)(const PL_INSTANCES *b, size_t j, real *sum, pl_lanes *part, const int back)
{
	const size_t left = PL(lanes_left)(b, j), first = left ? j : 0;
	size_t i;
	PL_LANES_UNROLL
	for (i = 0; i < 3 * PL_OUTPUTS; i++) {
		if (back) {
			pl_lanes_store(sum + i * b->count + first, part[i], left);
		} else {
			part[i] = pl_lanes_load(sum + i * b->count + first, left);
		}
	}
}

/* As pl_sum_squares */
PL_LANES_INLINE void PL(sums_add)(pl_lanes *sum, const pl_lanes *value)
{
	int i;
	PL_LANES_UNROLL
	for (i = 0; i < PL_OUTPUTS; i++) {
		const pl_lanes square = value[i] * value[i], whole = sum[i] + square, part = whole - sum[i];
		sum[PL_OUTPUTS + i] += (sum[i] - (whole - part)) + (square - part);
		sum[i] = whole;
		sum[2 * PL_OUTPUTS + i] = value[i];
	}
}

#if PL_FLUSHES > 0 && PL_FLUSHES_BESIDE
/* Beside others of their part states are compared in each instance by itself. */
static PL_APART void PL(lanes_flush_beside)(pl_lanes *y)
{
	size_t l;
	int i;
	for (l = 0; l < PL_AT_ONCE; l++) {
		PL_TYPE one;
		for (i = 0; i < PL_STATES; i++) {
			one.y[i] = PL(lane)(&y[i], l);
		}
		PL(flush)(&one);
		for (i = 0; i < PL_STATES; i++) {
			PL(set_lane)(&y[i], l, one.y[i]);
		}
	}
}
#endif

/* Behind step k of these, as flush.h: all but nothing is 0, in every lane */
PL_LANES_INLINE void PL(lanes_flush)(const PL(steps_ahead) *ahead, size_t k, pl_lanes *y)
{
#if PL_FLUSHES > 0 && PL_FLUSHES_BESIDE
	if (k == ahead->steps && ahead->flushes) {
		PL(lanes_flush_beside)(y);
	}
#elif PL_FLUSHES > 0
#if PL_SINGLE
	const pl_lanes least = pl_lanes_all((real)0x1p-116);
#else
	const pl_lanes least = pl_lanes_all(0x1p-963);
#endif
	int i;
	if (k < ahead->steps || !ahead->flushes) {
		return;
	}
	PL_LANES_UNROLL
	for (i = 0; i < PL_STATES; i++) {
#if PL_FLUSHES > 1
		if (PL(flush_part)[i] >= PL_DECAYING) {
			continue;
		}
#endif
#if PL_COMPENSATED
		y[PL_STATES + i] = pl_lanes_kept(y[i], y[PL_STATES + i], least);
#endif
		y[i] = pl_lanes_kept(y[i], y[i], least);
	}
#endif
	(void)ahead, (void)k, (void)y;
}

/* Instances from `first` on, `groups` a lane, step by step with outputs of each, or sums of these */
PL_LANES_INLINE void PL(lanes_go)(PL_INSTANCES *b, size_t first, PL(steps_ahead) *ahead, real *out, real *sum,
				  const int groups)
{
	pl_lanes y[PL_GROUPS][PL_STEPPED], peak[PL_GROUPS][PL_OUTPUTS], factor[PL_GROUPS][PL_HAS(PL_LANES)];
	pl_lanes part[PL_GROUPS][3 * PL_OUTPUTS];
#if PL_PEAKS > 0
	pl_lanes start[PL_GROUPS][PL_STATES], before[PL_GROUPS][PL_OUTPUTS];
#endif
	size_t k;
	int g;
	PL_LANES_UNROLL
	for (g = 0; g < groups; g++) {
		PL(lanes_take)(b, first + (size_t)g * PL_AT_ONCE, y[g], factor[g], peak[g]);
		if (sum) {
			PL(sums_move)(b, first + (size_t)g * PL_AT_ONCE, sum, part[g], 0);
		}
#if PL_PEAKS > 0
		PL(lanes_out)(y[g], factor[g], ahead->now[0], before[g]);
#endif
	}
	for (k = 1; k <= ahead->steps; k++) {
		PL_LANES_UNROLL
		for (g = 0; g < groups; g++) {
#if PL_PEAKS > 0
			memcpy(start[g], y[g], sizeof start[g]);
#endif
#if PL_EVENTS
			PL(lanes_step_all)(b, first + (size_t)g * PL_AT_ONCE, ahead, k, y[g], factor[g], b->peak
					|| out || sum);
#else
			PL(lanes_step)(y[g], factor[g], ahead->now[k]);
#endif
			PL(lanes_flush)(ahead, k, y[g]);
		}
		if (b->peak || out || sum) {
			PL_LANES_UNROLL
			for (g = 0; g < groups; g++) {
				const size_t j = first + (size_t)g * PL_AT_ONCE;
				pl_lanes value[PL_OUTPUTS];
#if PL_OUT_ALONE
				PL(out_alone)(b, j, ahead, k, y[g], value);
#else
				PL(lanes_out)(y[g], factor[g], ahead->now[k], value);
#endif
#if PL_PEAKS > 0
				PL(lanes_between)(b, j, start[g], factor[g], ahead->acting[k], before[g], value,
						peak[g]);
#else
				PL(lanes_widen)(peak[g], value, PL_OUTPUTS);
#endif
				PL(lanes_report)(b, j, value, out);
				if (sum) {
					PL(sums_add)(part[g], value);
				}
			}
			out = out ? out + PL_OUTPUTS * b->count : NULL;
		}
	}
	PL_LANES_UNROLL
	for (g = 0; g < groups; g++) {
		PL(lanes_give)(b, first + (size_t)g * PL_AT_ONCE, y[g], peak[g]);
		if (sum) {
			PL(sums_move)(b, first + (size_t)g * PL_AT_ONCE, sum, part[g], 1);
		}
	}
}

#if PL_PEAKS > 0
static void PL(batch_one_by_one)(PL_INSTANCES *b, size_t first, PL(steps_ahead) *ahead, real *out)
{
	PL(ahead_acting)(ahead);
	PL(lanes_go)(b, first, ahead, out, NULL, 1);
}

/* After steps of which only the peaks are wanted: those at ends of steps are known before extremes are looked for, and
 * few are larger.  Where there may be more in between the steps are taken again, one by one. */
PL_LANES_INLINE void PL(lanes_end)(PL_INSTANCES *b, size_t j, PL(steps_ahead) *ahead, const pl_lanes *y,
				   const pl_lanes *factor, const pl_lanes *state, const pl_lanes *top, pl_lanes *peak)
{
	pl_lanes most[PL_PEAKS];
	size_t i;
	PL(lanes_widen)(peak, top, PL_OUTPUTS);
	if (!b->peak || !PL(lanes_may_pass)(state, factor, ahead->reach, top, peak, most)) {
		PL(lanes_give)(b, j, y, peak);
		return;
	}
	for (i = 0; i < PL_OUTPUTS; i++) {
		pl_lanes_store(b->peak + i * b->count + j, peak[i], b->count - j);
	}
	PL(batch_one_by_one)(b, j, ahead, NULL);
}

/* Instances from `first` on: bounds of states and outputs show most steps to be event-free */
PL_LANES_INLINE void PL(lanes_event_free)(PL_INSTANCES *b, size_t first, PL(steps_ahead) *ahead, const int groups)
{
	pl_lanes y[PL_GROUPS][PL_STEPPED], peak[PL_GROUPS][PL_OUTPUTS], factor[PL_GROUPS][PL_HAS(PL_LANES)];
	pl_lanes state[PL_GROUPS][PL_STATES], top[PL_GROUPS][PL_OUTPUTS]; /* the largest |state|, |output| */
	size_t k;
	int g, i;
	PL_LANES_UNROLL
	for (g = 0; g < groups; g++) {
		pl_lanes value[PL_OUTPUTS];
		PL(lanes_take)(b, first + (size_t)g * PL_AT_ONCE, y[g], factor[g], peak[g]);
		PL(lanes_out)(y[g], factor[g], ahead->now[0], value);
		PL_LANES_UNROLL
		for (i = 0; i < PL_STATES; i++) {
			state[g][i] = pl_lanes_peak(pl_lanes_all(0), y[g][i]);
		}
		PL_LANES_UNROLL
		for (i = 0; i < PL_OUTPUTS; i++) {
			top[g][i] = pl_lanes_all(0);
		}
		PL_LANES_UNROLL
		for (i = 0; i < PL_PEAKS; i++) {
			top[g][PL(peak_output)[i]] = pl_lanes_peak(pl_lanes_all(0), value[PL(peak_output)[i]]);
		}
	}
	for (k = 1; k <= ahead->steps; k++) {
		PL_LANES_UNROLL
		for (g = 0; g < groups; g++) {
			PL(lanes_step)(y[g], factor[g], ahead->now[k]);
			PL(lanes_flush)(ahead, k, y[g]);
		}
		PL_LANES_UNROLL
		for (g = 0; g < groups; g++) {
			pl_lanes value[PL_OUTPUTS];
			PL(lanes_out)(y[g], factor[g], ahead->now[k], value);
			PL(lanes_widen)(state[g], y[g], PL_STATES);
			PL(lanes_widen)(top[g], value, PL_OUTPUTS);
		}
	}
	PL_LANES_UNROLL
	for (g = 0; g < groups; g++) {
		PL(lanes_end)(b, first + (size_t)g * PL_AT_ONCE, ahead, y[g], factor[g], state[g], top[g], peak[g]);
	}
}
#define PL_GO(groups) PL(lanes_event_free)(b, first, ahead, groups)
#else
#define PL_GO(groups) PL(lanes_go)(b, first, ahead, out, PL_EVENTS ? sum : NULL, groups)
#endif

static void PL(batch_block)(PL_INSTANCES *b, size_t first, PL(steps_ahead) *ahead, real *out, real *sum)
{
	PL_GO(PL_GROUPS);
	(void)out, (void)sum;
}

#if PL_GROUPS > 1
static void PL(batch_group)(PL_INSTANCES *b, size_t first, PL(steps_ahead) *ahead, real *out)
{
	real *const sum = NULL;
	PL_GO(1);
	(void)out, (void)sum;
}
#endif

#if PL_FACTORS > 0 && !PL_EVENTS
/* Their numbers fill the registers by a group. With events there are no more groups, and one text takes both. */
static void PL(batch_sums)(PL_INSTANCES *b, PL(steps_ahead) *ahead, real *sum)
{
	size_t first;
#if PL_PEAKS > 0
	PL(ahead_acting)(ahead);
#endif
	for (first = 0; first < b->count; first += PL_AT_ONCE) {
		PL(lanes_go)(b, first, ahead, NULL, sum, 1);
	}
}
#endif

/* As many whole blocks as there are, then single groups; with sums, or outputs, or neither */
static void PL(batch_go)(PL_INSTANCES *b, PL(steps_ahead) *ahead, real *out, real *sum)
{
	size_t first = 0;
#if PL_EVENTS
	first = PL(all_alone)(b, ahead, out, sum);
#elif PL_FACTORS > 0
	if (sum) {
		PL(batch_sums)(b, ahead, sum);
		return;
	}
#endif
#if PL_PEAKS > 0
	for (; out && first < b->count; first += PL_AT_ONCE) {
		PL(batch_one_by_one)(b, first, ahead, out);
	}
#endif
	for (; first < b->count && b->count - first > (PL_GROUPS - 1) * PL_AT_ONCE; first += PL_GROUPS * PL_AT_ONCE) {
		PL(batch_block)(b, first, ahead, out, sum);
	}
#if PL_GROUPS > 1
	for (; first < b->count; first += PL_AT_ONCE) {
		PL(batch_group)(b, first, ahead, out);
	}
#endif
}

/* ---- NAME_batch ---- */

/* What instances share in the steps ahead, computed; of samples bounded where that does */
static void PL(share)(PL_TYPE *s, const real *u, PL(steps_ahead) *ahead)
{
	size_t k;
#if PL_PEAKS > 0
	int p;
	ahead->known = !PL_SAMPLED;
	ahead->from = *s;
	for (p = 0; p < PL_PEAKS; p++) {
		ahead->reach[p] = 0;
	}
#endif
#if PL_SAMPLED
	PL(share_reach)(s, u, ahead->steps, ahead->reach);
#endif
	ahead->u = u;
#if PL_EVENTS
	memcpy(ahead->head[0], s, sizeof ahead->head[0]);
#endif
	PL(share_out)(s, ahead->now[0]);
	for (k = 1; k <= ahead->steps; k++) {
#if PL_PEAKS > 0 && PL_SIZE > PL_STATES && !PL_SAMPLED
		PL(share_acting)(s, u, ahead->acting[k]);
		for (p = 0; p < PL_PEAKS; p++) {
			ahead->reach[p] = pl_larger_size(ahead->reach[p], ahead->acting[k][PL_SIZE - PL_STATES + p]);
		}
#endif
		PL(share_step)(s, u, ahead->now[k]);
		PL(share_out)(s, ahead->now[k]);
#if PL_EVENTS
		memcpy(ahead->head[k], s, sizeof ahead->head[k]);
#endif
#if PL_INPUTS > 0
		u += PL_INPUTS;
#endif
	}
}

/* n steps, with sums as NAME_many has them, or without */
static void PL(batch_steps)(PL_INSTANCES *b, size_t n PL_TAKEN_ROWS, real *out, real *sum)
{
	PL(steps_ahead) ahead;
	for (; n > 0; n -= ahead.steps) {
		const size_t ready = PL_READY(b->shared.k);
		ahead.steps = n < ready ? n : ready;
		ahead.flushes = ahead.steps == ready;
		PL(share)(&b->shared, PL_THE_INPUTS, &ahead);
#if PL_INPUTS > 0
		u += ahead.steps * PL_INPUTS;
#endif
		PL(batch_go)(b, &ahead, out, sum);
		out = out ? out + ahead.steps * PL_OUTPUTS * b->count : NULL;
	}
}

#if PL_FACTORS > 0
/* ---- of many.h ---- */

#if PL_RAMPS
static void PL(many_hold)(void *b, const real *u)
{
	PL(hold)(&((PL_INSTANCES *)b)->shared, u);
}
#endif

static int PL(many_use)(PL_INSTANCES *b, size_t j, const PL(coeffs) *c, real *out)
{
	PL_TYPE one;
	size_t i;
	const int status = PL(batch_use)(b, j, c);
	if (status != 0) {
		return status;
	}
	PL(batch_take)(b, j, &one);
	PL(use)(&one, c);
	PL(out)(&one, out);
	for (i = 0; i < PL_OUTPUTS && b->peak; i++) {
		b->peak[i * b->count + j] = pl_magnitude(out[i]);
	}
	return 0;
}
#endif

#define PL_DRIVES (PL_FACTORS > 0)
#include "many.h"
#include "undef.h"
