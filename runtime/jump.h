/* SPDX-License-Identifier: MIT-0 */
/* jump.h: NAME_jump, many steps at once, by powers of the transfer matrix in double-double, split where loads change
 * their formula.  Included by the file of the model, which defines before it
 *
 *     PL_TYPE                    the model, with members y, with segments segment, with low parts low or carry
 *     PL_STATES, PL_LOAD_STATES  the states; the load states that a step reads
 *     PL_SIZE                    these and the states, of several blocks those of the largest
 *     PL_SEGMENTS                of time, in which loads have their formulas
 *     PL_BLOCKS                  independent ones, that are taken one after the other: the states of each are those of
 *                                PL(block_state)[] from PL(block_first)[block] on; 1: the model is one
 *     PL_CONVERTED               1: what is kept are not the states: PL(stored_state)(s, y) and PL(store_state)(s, y);
 *                                not of several blocks
 *     PL_COMPENSATED                    1: of each state what rounding took is in s->low
 *     PL_CARRIES                 of so many, PL(carried)[], it is in s->carry
 *     PL_PHI                     the name of the transfer matrix; PL(Phi_low) has its second words
 *     PL_ENTRIES                 of the load states beside it: PL(power_entry)[], {segment, row, column, value}
 *
 *     PL(leap_loads)(s, load)    the load states now
 *     PL(pass_steps)(s, n)       loads and time pass n steps
 *     PL(until)(s, change)       time from now to a change [s] */
#include "numbers.h"

/* Of a block, whose x is its states and behind them all load states: how many states, and which of the model's each is;
 * where in x one of the model's stands, -1: nowhere.  There is one block, 0, where there are no others. */
#if PL_BLOCKS > 1
static inline int PL(states_of)(int block)
{
	return PL(block_first)[block + 1] - PL(block_first)[block];
}

static inline int PL(state_of)(int block, int i)
{
	return PL(block_state)[PL(block_first)[block] + i];
}

#if PL_ENTRIES > 0 || PL_CARRIES > 0
static int PL(place_of)(int block, int row)
{
	const int states = PL(states_of)(block);
	int i;
	for (i = 0; row < PL_STATES && i < states; i++) {
		if (PL(state_of)(block, i) == row) {
			return i;
		}
	}
	return row < PL_STATES ? -1 : row - PL_STATES + states;
}
#endif
#else
static inline int PL(states_of)(int block)
{
	(void)block;
	return PL_STATES;
}

static inline int PL(state_of)(int block, int i)
{
	(void)block;
	return i;
}

#if PL_ENTRIES > 0 || PL_CARRIES > 0
static inline int PL(place_of)(int block, int row)
{
	(void)block;
	return row;
}
#endif
#endif

static void PL(first_power)(const PL_TYPE *s, int block, pl_two power[PL_SIZE * PL_SIZE])
{
	const int states = PL(states_of)(block), size = states + PL_LOAD_STATES;
	int i, j;
	for (i = 0; i < size * size; i++) {
		power[i].hi = 0;
		power[i].lo = 0;
	}
	for (i = 0; i < states; i++) {
		for (j = 0; j < states; j++) {
			power[size * i + j].hi = PL_PHI[PL(state_of)(block, i)][PL(state_of)(block, j)];
			power[size * i + j].lo = PL(Phi_low)[PL(state_of)(block, i)][PL(state_of)(block, j)];
		}
	}
#if PL_ENTRIES > 0
	for (i = 0; i < PL_ENTRIES; i++) {
		const int row = PL(place_of)(block, PL(power_entry)[i].row);
#if PL_SEGMENTS > 1
		if (PL(power_entry)[i].segment != s->segment) {
			continue;
		}
#endif
		if (row >= 0) {
			power[size * row + PL(place_of)(block, PL(power_entry)[i].column)] = PL(power_entry)[i].value;
		}
	}
#endif
	(void)s;
}

static void PL(leap_from)(const PL_TYPE *s, int block, pl_two x[PL_SIZE])
{
	const int states = PL(states_of)(block);
	int i;
#if PL_CONVERTED
	real y[PL_STATES];
	PL(stored_state)(s, y);
#else
	const real *const y = s->y;
#endif
	for (i = 0; i < states; i++) {
		x[i].hi = y[PL(state_of)(block, i)];
#if PL_COMPENSATED
		x[i].lo = s->low[PL(state_of)(block, i)];
#else
		x[i].lo = 0;
#endif
	}
#if PL_CARRIES > 0
	for (i = 0; i < PL_CARRIES; i++) {
		if (PL(place_of)(block, PL(carried)[i]) >= 0) {
			x[PL(place_of)(block, PL(carried)[i])].lo = s->carry[i];
		}
	}
#endif
#if PL_LOAD_STATES > 0
	PL(leap_loads)(s, x + states);
#endif
}

static void PL(leap_to)(PL_TYPE *s, int block, const pl_two x[PL_SIZE])
{
	const int states = PL(states_of)(block);
	int i;
#if PL_CONVERTED
	real y[PL_STATES];
	for (i = 0; i < states; i++) {
		y[i] = x[i].hi;
	}
	PL(store_state)(s, y);
#else
	for (i = 0; i < states; i++) {
		s->y[PL(state_of)(block, i)] = x[i].hi;
#if PL_COMPENSATED
		s->low[PL(state_of)(block, i)] = x[i].lo;
#endif
	}
#endif
#if PL_CARRIES > 0
	for (i = 0; i < PL_CARRIES; i++) {
		if (PL(place_of)(block, PL(carried)[i]) >= 0) {
			s->carry[i] = x[PL(place_of)(block, PL(carried)[i])].lo;
		}
	}
#endif
}

/* n steps without a change of the loads */
static void PL(leap)(PL_TYPE *s, uint64_t n)
{
	pl_two power[PL_SIZE * PL_SIZE], work[PL_SIZE * PL_SIZE], x[PL_SIZE], w[PL_SIZE];
	int block;
	for (block = 0; block < PL_BLOCKS; block++) {
		PL(first_power)(s, block, power);
		PL(leap_from)(s, block, x);
		pl_power_apply(PL(states_of)(block) + PL_LOAD_STATES, power, work, x, w, n);
		PL(leap_to)(s, block, x);
	}
	PL(pass_steps)(s, n);
}

/* Leaps up to one step before each change of the loads, and steps across it. */
void PL(jump)(PL_TYPE *s, uint64_t n)
{
#if PL_SEGMENTS > 1
	while (n > 0 && s->segment < PL_SEGMENTS - 1) {
		const real ahead = PL(until)(s, s->segment) / PL_H - 1;
		const uint64_t free = ahead < 1 ? 0 : ahead < (real)n ? (uint64_t)ahead : n;
		if (free > 0) {
			PL(leap)(s, free);
			n -= free;
		} else {
			PL(step)(s);
			n--;
		}
	}
	if (n == 0) {
		return;
	}
#endif
	PL(leap)(s, n);
}

#include "undef.h"
