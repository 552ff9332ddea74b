/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads, steps and values between them as C. */
#ifndef PLGEN_EMIT_STEPS_H
#define PLGEN_EMIT_STEPS_H

#include "formulas.h"
#include "state.h"

void emit_load_tables(const struct emitter *e);                   /* phases and envelopes: start, step, rate */
void emit_load_members(const struct emitter *e);
const char *phase_rate_text(const struct emitter *e);             /* of the model, or the instance */
void emit_load_advance(const struct emitter *e, const char *steps); /* `steps` NULL: one */
/* declares load1[...] for the loads wanted */
void emit_load_states(const struct emitter *e, const bool *loads, bool time_is_there);
bool outputs_read(const struct emitter *e, int load);
void emit_refresh_tables(const struct emitter *e);                /* of refreshes: tables, and NAME_refresh */
void emit_refresh_members(const struct emitter *e);
void emit_loads_at_refresh(const struct emitter *e, const bool *loads);   /* where one stands now */
void emit_rotated_loads(const struct emitter *e, const bool *loads, bool time_is_there);
void emit_forced(const struct emitter *e);                        /* NAME_forced: what is not kept of the state */
void banner_forced(const struct emitter *e);                      /* what of the state it is, what that costs */
const char *load_operand(const struct emitter *e, int load, int column); /* NULL: the constant 1 */
const char *column_operand(const struct emitter *e, int column);

void emit_phase_rates(const struct emitter *e);                   /* rows of initialisers */
const char *phase_step_text(const struct emitter *e, int load);   /* in one step: a turn, as an initialiser */
const char *envelope_step_text(const struct emitter *e, int load);
void emit_changes(const struct emitter *e);                       /* loads that change their formula: when */
void emit_held_remainder(const struct emitter *e);                /* which operator serves, and the remainder now */
void emit_passing(const struct emitter *e);                       /* ... and pass(), across a change */
/* in a step that is no list of assignments: what only adds up is 0 over it */
void emit_set_aside(const struct emitter *e);
void emit_take_back(const struct emitter *e);
void emit_hand_over(const struct emitter *e);                     /* in at: y from the states in x */
void emit_vector_now(const struct emitter *e);                    /* NAME_vector_now(s, u, x) */
void emit_at_by(const struct emitter *e, const char *function);   /* NAME_at, by NAME_function(s, u, tau, y) */
void emit_at_start(const struct emitter *e);
int most_samples_before(const struct emitter *e);                  /* samples kept of an input; 0: the last alone */
bool *loads_of_step(const struct emitter *e);                    /* per load: its states are read */
void emit_step(const struct emitter *e);
/* Of a step that loops over blocks or modes: what acts, columns of loads, then inputs; states in rows, NULL: all */
const char **acting_texts(const struct emitter *e);
bool *states_in_rows(const struct emitter *e);
void emit_groups(const struct emitter *e);                        /* tables and functions of its independent blocks */
void emit_modes(const struct emitter *e);                         /* tables; nothing of other forms */
void emit_loops_of_step(const struct emitter *e, const char *const *acting_text);
/* what a step assigns to states that are `stepped` (NULL: all), to be printed */
struct formulas *formulas_of_step(const struct emitter *e, const bool *stepped);
void emit_keep_inputs(const struct emitter *e, int samples);      /* of u, which has those of so many steps */
void begin_flush(const struct emitter *e);                        /* its sizes: flush.h is what follows */
void emit_flush(const struct emitter *e);                         /* NAME_flush, of decayed states */
void emit_step_advance(const struct emitter *e);                  /* samples, phases and time move on */
const char *checks_of_step(const struct emitter *e);              /* what is looked at in the state behind it */
void emit_step_end(const struct emitter *e);                      /* both */
const char *head_of_step(const struct emitter *e);

/* ---- emit_delays.c: delayed inputs, around a model that has them as inputs ---- */

void emit_delay_declarations(const struct emitter *core);
void emit_delays(const struct emitter *core);
void emit_delays_on_device(const struct emitter *core, const char *target);

void emit_out(const struct emitter *e);
int  slopes_of_outputs(const struct model *model);
void emit_output_slopes(const struct emitter *e);                 /* into slope[], of all in order */
void emit_outputs_now(const struct emitter *e);                   /* into out, or where they stand */
/* ---- emit_derivatives.c: derivatives beside the states ---- */

void emit_derivative_declarations(const struct emitter *e);
void emit_step_derivatives(const struct emitter *e);
void emit_derivatives_around(const struct emitter *e);

void emit_run(const struct emitter *e);
void emit_at(const struct emitter *e);
void emit_jump(const struct emitter *e);
void emit_rhs(const struct emitter *e);
void check_rhs(const struct emitter *e);  /* refuses what no formula gives */
bool rhs_needs_math(const struct emitter *e);

/* ---- emit_constraints.c ---- */

void emit_constraints(const struct emitter *e);                   /* NAME_misses, NAME_masses, where there are some */
void emit_mass_matrix(const struct emitter *e);                  /* NAME_masses, where it moves */
void emit_mass_members(const struct emitter *e);
void emit_energies(const struct emitter *e);
bool holds_energy(const struct emitter *e);
bool steps_may_fail(const struct emitter *e);                     /* and say why */
bool may_be_singular(const struct emitter *e);
int  moving_masses(const struct emitter *e);                      /* rows of the latter; 0: there is none */
bool constraints_need_math(const struct emitter *e);

/* ---- emit_normal.c: steps in normal modes ---- */

void emit_normal_members(const struct emitter *e);
void emit_normal_tables(const struct emitter *e);

/* ---- emit_batch.c: many instances in one call ---- */

void emit_batch_declarations(const struct emitter *e);
void emit_batch(const struct emitter *e);
/* emit_kernel.c: by the sums of lanes, or by NAME_step, whose C stands before it and print_opencl rewrites */
bool is_whole_on_device(const struct emitter *e);
void emit_kernel(const struct emitter *e, const char *target);
void emit_whole_kernel(const struct emitter *e, const char *target);

#endif
