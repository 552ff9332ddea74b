/* SPDX-License-Identifier: MIT-0 */
/* real.h: one text for doubles and floats, for the runtime's own use.  series.c, power.c, until.c, apply.c,
 * crossings.c and retune.c are written over `real`, a double with the names of plrt.h; seriesf.c and so on
 * define REAL_IS_FLOAT and include them, and then the same names stand for those that end in f.  Constants are
 * integers there, which are of either type: no float is promoted. */
#ifndef PLRT_REAL_H
#define PLRT_REAL_H

#ifdef REAL_IS_FLOAT
#define PL_FLOAT_ONLY
#endif

#include "plrt.h"

#include <float.h>

#ifdef REAL_IS_FLOAT

typedef float real;
typedef uint32_t real_bits;
enum { REAL_DIGITS = FLT_MANT_DIG, REAL_EXPONENTS = FLT_MAX_EXP };
#define REAL_EPSILON FLT_EPSILON
#define REAL_LARGE 0x1p72f /* products of any two numbers, divided by its square, can be summed */

#define pl_rate pl_ratef
#define pl_rate_of pl_ratef_of
#define pl_turn pl_turnf
#define pl_turn_at pl_turnf_at
#define pl_turn_add pl_turnf_add
#define pl_lead pl_leadf
#define pl_lead_start pl_leadf_start
#define pl_lead_change pl_leadf_change
#define pl_series pl_seriesf
#define pl_series_advance pl_seriesf_advance
#define pl_two pl_twof
#define pl_power_apply pl_powerf_apply
#define pl_until pl_untilf
#define pl_accumulate pl_accumulatef
#define pl_multiply pl_multiplyf
#define pl_multiply_add pl_multiplyf_add
#define pl_not_finite pl_not_finitef
#define pl_magnitude pl_magnitudef
#define pl_switching pl_switchingf
#define pl_crossing pl_crossingf
#define pl_divided pl_dividedf
#define pl_divided_place pl_dividedf_place
#define pl_divided_rises pl_dividedf_rises
#define pl_divided_left pl_dividedf_left
#define pl_divided_next pl_dividedf_next
#define pl_impact pl_impactf
#define pl_guards pl_guardsf
#define pl_strike pl_strikef
#define pl_instant pl_instantf
#define pl_chain pl_chainf
#define pl_events pl_eventsf
#define pl_events_place pl_eventsf_place
#define pl_events_begin pl_eventsf_begin
#define pl_events_next pl_eventsf_next
#define pl_events_pass pl_eventsf_pass
#define pl_events_end pl_eventsf_end
#define pl_events_places pl_eventsf_places
#define pl_term pl_termf
#define pl_equations pl_equationsf
#define pl_equations_at pl_equationsf_at
#define pl_increment pl_incrementf
#define pl_region_of pl_regionf_of
#define pl_region_bounds pl_regionf_bounds
#define pl_cut pl_cutf
#define pl_cut_begin pl_cutf_begin
#define pl_cut_flow pl_cutf_flow
#define pl_region_large pl_regionf_large
#define pl_region_reach pl_regionf_reach
#define pl_ladder pl_ladderf
#define pl_ramp_before pl_rampf_before
#define pl_ramp_cancels pl_rampf_cancels
#define pl_root pl_rootf
#define pl_factor pl_factorf
#define pl_solve pl_solvef
#define pl_factor_complex pl_factorf_complex
#define pl_solve_complex pl_solvef_complex
#define pl_peak pl_peakf
#define pl_peak_bend pl_peakf_bend

#ifdef REST_IS_KEPT
#define pl_switching_start pl_switchingf_kept_start
#define pl_switching_step pl_switchingf_kept_step
#define pl_switching_advance pl_switchingf_kept_advance
#define pl_switching_move pl_switchingf_kept_move
#define pl_guards_start pl_guardsf_kept_start
#define pl_guards_advance pl_guardsf_kept_advance
#define pl_guards_change pl_guardsf_kept_change
#else
#define pl_switching_start pl_switchingf_start
#define pl_switching_step pl_switchingf_step
#define pl_switching_advance pl_switchingf_advance
#define pl_guards_start pl_guardsf_start
#define pl_guards_advance pl_guardsf_advance
#define pl_guards_change pl_guardsf_change
#endif

#else

#ifdef REST_IS_KEPT
#define pl_switching_start pl_switching_kept_start
#define pl_switching_step pl_switching_kept_step
#define pl_switching_advance pl_switching_kept_advance
#define pl_switching_move pl_switching_kept_move
#define pl_guards_start pl_guards_kept_start
#define pl_guards_advance pl_guards_kept_advance
#define pl_guards_change pl_guards_kept_change
#endif

typedef double real;
typedef uint64_t real_bits;
enum { REAL_DIGITS = DBL_MANT_DIG, REAL_EXPONENTS = DBL_MAX_EXP };
#define REAL_EPSILON DBL_EPSILON
#define REAL_LARGE 0x1p520

#endif

/* row . x, of n entries.  Four sums, so that an addition need not wait for the one before it: as fast as several rows
 * at a time, in one order for all.  Inline: of many rows a call for each costs a fifth of the time. */
static inline real dot_product(int n, const real *row, const real *x)
{
    const int whole = n - n % 4;
    real s0 = 0, s1 = 0, s2 = 0, s3 = 0;
    int j;
    for (j = 0; j < whole; j += 4) {
        s0 += row[j] * x[j];
        s1 += row[j + 1] * x[j + 1];
        s2 += row[j + 2] * x[j + 2];
        s3 += row[j + 3] * x[j + 3];
    }
    if (j < n) {
        s0 += row[j] * x[j];
    }
    if (j + 1 < n) {
        s1 += row[j + 1] * x[j + 1];
    }
    if (j + 2 < n) {
        s2 += row[j + 2] * x[j + 2];
    }
    return (s0 + s2) + (s1 + s3);
}

/* A number and its bits, IEEE 754: sign, exponent + REAL_EXPONENTS - 1, then REAL_DIGITS - 1 bits of the fraction */
typedef union real_parts {
    real value;
    real_bits bits;
} real_parts;

#define REAL_FRACTION (((real_bits)1 << (REAL_DIGITS - 1)) - 1)

#endif
