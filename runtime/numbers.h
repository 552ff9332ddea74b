/* SPDX-License-Identifier: MIT-0 */
/* numbers.h: with what begins what a model's file includes for its steps: the type of its numbers, `real`, and the
 * runtime's names for it, until undef.h: the next model in a file may have another one.  PL_SINGLE: float, else double.
 * Constants are integers, or cast: no float is promoted. */
#include "plrt.h"

#if PL_SINGLE
#define real float
#define pl_accumulate pl_accumulatef
#define pl_not_finite pl_not_finitef
#define pl_magnitude pl_magnitudef
#define pl_crossing pl_crossingf
#define pl_divided pl_dividedf
#define pl_divided_place pl_dividedf_place
#define pl_divided_rises pl_dividedf_rises
#define pl_divided_left pl_dividedf_left
#define pl_divided_next pl_dividedf_next
#define pl_cut pl_cutf
#define pl_cut_begin pl_cutf_begin
#define pl_cut_flow pl_cutf_flow
#define pl_instant pl_instantf
#define pl_chain pl_chainf
#define pl_events_place pl_eventsf_place
#define pl_events_begin pl_eventsf_begin
#define pl_events_next pl_eventsf_next
#define pl_events_pass pl_eventsf_pass
#define pl_events_end pl_eventsf_end
#define pl_events_places pl_eventsf_places
#define pl_root pl_rootf
#define pl_factor pl_factorf
#define pl_solve pl_solvef
#define pl_factor_complex pl_factorf_complex
#define pl_solve_complex pl_solvef_complex
#define pl_series pl_seriesf
#define pl_series_advance pl_seriesf_advance
#define pl_two pl_twof
#define pl_lead_change pl_leadf_change
#define pl_lead_start pl_leadf_start
#define pl_power_apply pl_powerf_apply
#define pl_peak pl_peakf
#define pl_peak_bend pl_peakf_bend
#define pl_larger_size pl_larger_sizef
#define pl_lanes pl_lanesf
#define pl_lanes_load pl_lanesf_load
#define pl_lanes_store pl_lanesf_store
#define pl_lanes_all pl_lanesf_all
#define pl_lanes_peak pl_lanesf_peak
#define pl_lanes_above pl_lanesf_above
#define pl_lanes_accumulate pl_lanesf_accumulate
#define pl_lanes_bits pl_lanesf_bits
#define pl_lanes_size pl_lanesf_size
#define pl_rate pl_ratef
#define pl_rate_of pl_ratef_of
#define pl_turn_at pl_turnf_at
#define pl_turn_add pl_turnf_add
#define pl_growth_at pl_growthf_at
#define pl_equations_at pl_equationsf_at
#define pl_increment pl_incrementf
#define pl_ramp_before pl_rampf_before
#define pl_ramp_cancels pl_rampf_cancels
#define pl_region_of pl_regionf_of
#define pl_region_large pl_regionf_large
#define pl_region_bounds pl_regionf_bounds
#define pl_region_reach pl_regionf_reach
#define pl_block pl_blockf
#define pl_group pl_groupf
#define pl_model pl_modelf
#else
#define real double
#endif
