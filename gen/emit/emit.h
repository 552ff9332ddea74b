/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step as C. */
#ifndef PLGEN_EMIT_H
#define PLGEN_EMIT_H

#include "report/report.h"

/* ---- text.c: what all emitters write with ---- */

struct emitter {
	FILE *to;
	const struct step *step;
	const struct model *model;
	const struct linear *system;
	const char *name, *upper;   /* scs, SCS */
	const char *options;
	const char **local;         /* per state: the C local that holds it */
	int phases, growths;        /* in the state */
	int *phase, *growth;        /* per load: index of its phase and of its growth; -1: none */
	bool ramps;                 /* some input is of first order */
	bool at_node;               /* load states are those at `node` of the step, not at its start */
};
/* The only writer: a printf format in which $n is the model's name and $N the same in capitals, $$ a dollar. */
void say(const struct emitter *e, const char *layout, ...) __attribute__((format(printf, 2, 3)));

const char *tree(int terms, const char *const *term, int indent); /* a balanced sum */
const char *scaled(double factor, const char *operand);           /* operand NULL: 1 */
/* rounded; an error at the step where it overflows */
double finite_number(const struct emitter *e, mpq_srcptr q);
void emit_number_rows(const struct emitter *e, int rows, int columns, const double *value, const char *const *row_note);
void emit_name_list(const struct emitter *e, const char *array, int count, const char *const *name);
const char *low_text(mpq_srcptr q);                               /* what its rounding leaves out, rounded */
const char *two_text(mpq_srcptr q);                               /* {hi, lo} */

/* ---- single.c: the target float ---- */

void print_single(FILE *to, const char *text);               /* C for double as C for float */

/* ---- apart.c: locals apart from the model's type ---- */

/* the C of a model of this name, none of whose locals are called so */
void print_apart(FILE *to, const char *text, const char *name);

/* ---- cprint.c: expressions as C ---- */

/* gives every symbol and every state its C identifier */
void name_for_c(const struct model *model, const char *upper, const char **local);
const char *written_local(const struct model *written, int state); /* after that: of a written state */
const char *c_expression(const struct node *node);          /* fit for a term of a sum; accelerations count as 0 */
bool vanishes(const struct node *node);                     /* nothing is left when accelerations are 0 */
/* flags the symbols that it needs; *math: it needs <math.h> */
void mark_used(const struct node *node, bool *math);

/* ---- state.c: the state in emitted code ---- */

const struct model *speaker(const struct model *model);            /* over whose coordinates its forms are */
const char *input_name(const struct emitter *e, int input, int order); /* the C name of an input, of its slope */
const char *stepped_table(const struct emitter *e, const char *table); /* Phi or Gamma of the states as they are kept */
/* of a velocity that is kept as a momentum; NULL: it is not */
const char *factor_of_momentum(const struct emitter *e, int state);
void emit_locals(const struct emitter *e, const bool *reads);     /* the states wanted, under their names */
/* as kept: of kick-drift-kick, momenta */
void emit_raw_locals(const struct emitter *e, const bool *reads, bool changing);
void emit_locals_of(const struct emitter *e, const bool *reads, const char *vector);
const char *step_length(const struct emitter *e);                 /* NAME_H; of tunable models that of the instance s */
void emit_store(const struct emitter *e, const char *vector, const char *indent); /* s->y from states */
/* s->y from states that are whole */
void emit_state_forced(const struct emitter *e, const char *vector, const char *indent);
void emit_load_state(const struct emitter *e, const char *vector);  /* states from s->y */
/* the same, less their forced part where the step keeps them so */
void emit_kept_state(const struct emitter *e, const char *vector);
const char *tuned_factor(const struct emitter *e, int row, const struct operand *operand);
const char *tuned_output(const struct emitter *e, const struct output *output); /* its sum; NULL: no param changes it */
/* columns of x as in struct tuning */
bool tuned_output_reads(const struct emitter *e, const struct output *output, int column);

/* ---- left.c: forms with atoms as C ---- */

struct writer;                      /* declares locals for what several places use as it goes */
struct writer *writer_new(const struct emitter *e,
			  const char *(*basis_text)(const struct emitter *, const struct basis *), int count,
			  const struct form *const *form);
const char *write_form(struct writer *w, const struct form *form, int indent);

/* ---- selftest.c: reference states in closed form, for the target to step to ---- */

void emit_selftest(const struct emitter *e, bool jumps);

/* ---- emit.c, emit_step.c, emit_left.c, emit_out.c, emit_loads.c, emit_time.c, emit_tune.c, emit_rhs.c: a step as C
 * ---- */

void emit_header(FILE *to, const struct step *step, const char *options, bool rhs);
/* header_name NULL: all in one */
void emit_code(FILE *to, const struct step *step, const char *options, const char *header_name, bool rhs);

void emit_load_tables(const struct emitter *e);                   /* phases and growths: start, step, rate */
void emit_load_members(const struct emitter *e);
void emit_load_set(const struct emitter *e);
void emit_load_advance(const struct emitter *e, const char *steps); /* `steps` NULL: one */
/* declares load1[...] for the loads wanted */
void emit_load_states(const struct emitter *e, const bool *loads, bool time_is_there);
void emit_forced(const struct emitter *e);                        /* NAME_forced: what is not kept of the state */
const char *load_operand(const struct emitter *e, int load, int column); /* NULL: the constant 1 */
const char *column_operand(const struct emitter *e, int column);

void emit_phase_rates(const struct emitter *e);                   /* rows of initialisers */
const char *phase_step_text(const struct emitter *e, int load);   /* in one step: a turn, as an initialiser */
const char *growth_step_text(const struct emitter *e, int load);
void emit_changes(const struct emitter *e);                       /* loads that change their formula: when */
void emit_passing(const struct emitter *e);                       /* ... and pass(), across a change */
/* declares i and load states; x[...] = what the series advances */
void emit_series_vector(const struct emitter *e);
/* in a step that is no list of assignments: what only adds up is 0 over it */
void emit_set_aside(const struct emitter *e);
void emit_take_back(const struct emitter *e);
void emit_hand_over(const struct emitter *e);                     /* in at: y from the states in x */
void emit_step(const struct emitter *e);
void emit_step_end(const struct emitter *e);                      /* samples, phases and time move on */
const char *step_parameters(const struct emitter *e);
const char *input_operand(const struct emitter *e, int column);
void emit_regions(const struct emitter *e);                       /* tables of a piecewise-linear model */
void emit_region_declarations(const struct emitter *e);
void emit_region_members(const struct emitter *e);
void emit_region_start(const struct emitter *e);                  /* in set */
void emit_region_step(const struct emitter *e);
void emit_region_at(const struct emitter *e);
void emit_leftover_functions(const struct emitter *e);            /* what is left over; which operator serves */
void emit_leftover_step(const struct emitter *e);
/* in terms of locals: states, inputs, load states, t */
const char *basis_now(const struct emitter *e, const struct basis *basis);
const char *leftover_of_step(const struct emitter *e);            /* its call at the start of a step, into `left` */
const char *leftover_of_outputs(const struct emitter *e);
void emit_samples(const struct emitter *e);                       /* start, slope: what leftovers read of ramps */
/* Of models with tunable params: */
void emit_coefficient_struct(const struct emitter *e);
void emit_tuning_declarations(const struct emitter *e);
void emit_tuning_wrapper(const struct emitter *e);                /* of the descriptor */
void banner_tuning(const struct emitter *e);
/* the generator's own coefficients, of the spec's values */
void emit_nominal(const struct emitter *e);
void emit_retune(const struct emitter *e);                        /* the equations, retune, use */
void emit_tuned_at(const struct emitter *e);                      /* pass, from change to change of the loads; at */
const char *selection_call(const struct emitter *e);              /* which operator of a bank serves now */
/* phases and growths from the start of the step to each node */
void emit_node_phases(const struct emitter *e, const bool *loads);
void emit_out(const struct emitter *e);
/* A number for each output, then for each highest derivative that outputs which are not linear read */
int place_of_output(const struct model *model, const struct output *output);
void emit_at(const struct emitter *e);
void emit_jump(const struct emitter *e);
void emit_rhs(const struct emitter *e);
bool rhs_needs_math(const struct model *model);

#endif
