/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Behind plrt.h, before the C of a model that is counted (count.c): what has run so far, as step/cost.c counts it.
 * Quotients are products, a call is one of <math.h>. Of what the runtime does with arrays it is an estimate. */
static struct {
	uint64_t multiplications, additions, calls, forcings, waits, pieces, events, terms;
} pl_counted;
const void *const pl_counts = &pl_counted;

/* Of whole numbers nothing counts: pl_real is the type of the others. */
#define PL_IS_REAL(x) __builtin_types_compatible_p(__typeof__(x), pl_real)
#define PL_ADDS(sum) (PL_IS_REAL(sum) ? pl_counted.additions++ : 0)
#define PL_MULTIPLIES(product) (PL_IS_REAL(product) ? pl_counted.multiplications++ : 0)
#define PL_CALLS (pl_counted.calls++)
#define PL_TAKES(m, a) (pl_counted.multiplications += (uint64_t)(m), pl_counted.additions += (uint64_t)(a))
#define PL_TAKES_BOTH(count) PL_TAKES(count, count)

#define pl_cossin(a, z) (pl_counted.forcings++, PL_TAKES(PL_COSSIN_MUL, PL_COSSIN_ADD), pl_cossin(a, z))
#define pl_cossinf(a, z) (pl_counted.forcings++, PL_TAKES(PL_COSSINF_MUL, PL_COSSINF_ADD), pl_cossinf(a, z))
#define pl_envelope_value(a) (PL_TAKES(PL_ENVELOPE_MUL, PL_ENVELOPE_ADD), pl_envelope_value(a))
#define pl_envelopef_value(a) (PL_TAKES(PL_ENVELOPEF_MUL, PL_ENVELOPEF_ADD), pl_envelopef_value(a))
#define pl_accumulate(sum, term, small, rest) (PL_TAKES(0, PL_ACCUMULATE_ADD), pl_accumulate(sum, term, small, rest))
#define pl_accumulatef(sum, term, small, rest) (PL_TAKES(0, PL_ACCUMULATE_ADD), pl_accumulatef(sum, term, small, rest))

/* The time to a change of loads */
#define pl_until(t0, k, h, change) (pl_counted.waits++, pl_until(t0, k, h, change))
#define pl_untilf(t0, k, h, change) (pl_counted.waits++, pl_untilf(t0, k, h, change))

/* Matrices and linear equations */
#define pl_multiply(rows, columns, A, x, y) (PL_TAKES_BOTH((rows) * (columns)), pl_multiply(rows, columns, A, x, y))
#define pl_multiplyf(rows, columns, A, x, y) (PL_TAKES_BOTH((rows) * (columns)), pl_multiplyf(rows, columns, A, x, y))
#define pl_multiply_add(rows, columns, A, x, y) \
	(PL_TAKES_BOTH((rows) * (columns)), pl_multiply_add(rows, columns, A, x, y))
#define pl_multiplyf_add(rows, columns, A, x, y) \
	(PL_TAKES_BOTH((rows) * (columns)), pl_multiplyf_add(rows, columns, A, x, y))
#define PL_FACTORS(n, products) PL_TAKES_BOTH((uint64_t)(products) * (uint64_t)(n) * (uint64_t)(n) * (uint64_t)(n) / 3)
#define pl_factor(n, A, pivot) (PL_FACTORS(n, 1), pl_factor(n, A, pivot))
#define pl_factorf(n, A, pivot) (PL_FACTORS(n, 1), pl_factorf(n, A, pivot))
#define pl_factor_complex(n, A, pivot) (PL_FACTORS(n, 4), pl_factor_complex(n, A, pivot))
#define pl_factorf_complex(n, A, pivot) (PL_FACTORS(n, 4), pl_factorf_complex(n, A, pivot))
#define pl_solve(n, A, pivot, x) (PL_TAKES_BOTH((n) * (n)), pl_solve(n, A, pivot, x))
#define pl_solvef(n, A, pivot, x) (PL_TAKES_BOTH((n) * (n)), pl_solvef(n, A, pivot, x))
#define pl_solve_complex(n, A, pivot, x) (PL_TAKES_BOTH(4 * (n) * (n)), pl_solve_complex(n, A, pivot, x))
#define pl_solvef_complex(n, A, pivot, x) (PL_TAKES_BOTH(4 * (n) * (n)), pl_solvef_complex(n, A, pivot, x))

/* A step of regions, or a part of it, and whether it is clear; how many events it had is in c behind it */
#define PL_PIECE(m, c, call) (pl_counted.pieces++, (call), pl_counted.events += (uint64_t)(c)->crossings, \
	pl_counted.terms += (uint64_t)(c)->crossings * (uint64_t)((m)->degree * (m)->size * (m)->size))
#define PL_PIECES(m, c, words) \
	PL_TAKES_BOTH((m)->size * ((words) * (m)->size + 3 + ((m)->halvings[(c)->matrix] > 0 ? 4 * (m)->size : 0)))
#define pl_switching_step(m, x, c, e, w) (PL_PIECES(m, c, 1), PL_PIECE(m, c, pl_switching_step(m, x, c, e, w)))
#define pl_switchingf_step(m, x, c, e, w) (PL_PIECES(m, c, 1), PL_PIECE(m, c, pl_switchingf_step(m, x, c, e, w)))
#define pl_switching_compensated_step(m, x, c, e, w) (PL_PIECES(m, c, 3), pl_switching_compensated_step(m, x, c, e, w))
#define pl_switchingf_compensated_step(m, x, c, e, w) (PL_PIECES(m, c, 3), pl_switchingf_compensated_step(m, x, c, \
    e, w))
#define pl_switching_advance(m, t, x, c, e, w) (PL_PIECES(m, c, 1), \
	PL_PIECE(m, c, pl_switching_advance(m, t, x, c, e, w)))
#define pl_switchingf_advance(m, t, x, c, e, w) (PL_PIECES(m, c, 1), \
	PL_PIECE(m, c, pl_switchingf_advance(m, t, x, c, e, w)))
#define pl_switching_compensated_advance(m, t, x, c, e, w) (PL_PIECES(m, c, 3), pl_switching_compensated_advance(m, \
    t, x, c, e, w))
#define pl_switchingf_compensated_advance(m, t, x, c, e, w) (PL_PIECES(m, c, 3), \
    pl_switchingf_compensated_advance(m, t, x, c, e, w))

/* The same with friction and impacts */
#define PL_GUARDED(m, words) PL_TAKES_BOTH((m)->size * ((words) * (m)->size + 3 + (m)->switches))
#define pl_guards_step(m, t, x, c, e, w) (PL_GUARDED(m, 1), pl_guards_step(m, t, x, c, e, w))
#define pl_guards_advance(m, t, x, c, e, w) (PL_GUARDED(m, 1), PL_PIECE(m, c, pl_guards_advance(m, t, x, c, e, w)))
#define pl_guardsf_advance(m, t, x, c, e, w) (PL_GUARDED(m, 1), PL_PIECE(m, c, pl_guardsf_advance(m, t, x, c, e, w)))
#define pl_guards_compensated_advance(m, t, x, c, e, w) (PL_GUARDED(m, 3), \
    pl_guards_compensated_advance(m, t, x, c, e, w))
#define pl_guardsf_compensated_advance(m, t, x, c, e, w) (PL_GUARDED(m, 3), \
    pl_guardsf_compensated_advance(m, t, x, c, e, w))

/* A part of a step with a remainder */
#define PL_EVENT_SPLIT_FLOWS(m) PL_TAKES_BOTH((m)->size * (m)->size * ((m)->terms > 0 ? (m)->terms : 1))
#define pl_event_split_flow(m, half, x, out) (PL_EVENT_SPLIT_FLOWS(m), pl_event_split_flow(m, half, x, out))
#define pl_event_splitf_flow(m, half, x, out) (PL_EVENT_SPLIT_FLOWS(m), pl_event_splitf_flow(m, half, x, out))
