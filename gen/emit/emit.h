/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step as C. */
#ifndef PLGEN_EMIT_H
#define PLGEN_EMIT_H

#include "report/report.h"

/* ---- text.c: what all emitters write with ---- */

struct emitter {
	FILE *to;
	const struct step *step;
	const struct kind *kind;    /* of the step */
	const struct model *model;
	const struct linear *system;
	const char *name, *upper;   /* scs, SCS */
	/* of independent parts of a piecewise-linear model the one that is printed; NULL: none */
	const struct region_part *part;
	const char *own, *place;    /* what its names begin with, scs_part1, its index, [1]; else the name, nothing */
	const char *degree;         /* the first part's whose polynomials are of its degree */
	const char *columns;        /* of a row of a series' coefficients: the states, and what breakpoints divide */
	const char *options;
	struct identifiers *c;      /* of every symbol */
	const char **local;         /* per state: the C local that holds it */
	int phases, growths;        /* in the state */
	int *phase, *growth;        /* per load: index of its phase and of its growth; -1: none */
	bool ramps;                 /* some input is of first order */
	int anchored;               /* load states in the state, at the last anchor */
	int *anchor;                /* per load: index of its first there; -1: none */
	bool at_anchor;             /* load states are written where the anchor keeps them */
	const char **sample;        /* of a block of steps: per column of its inputs; NULL: of one step */
	bool at_node;               /* load states are those at `node` of the step, not at its start; */
	const char *after;          /* those this long after now [s]; NULL: not so */
	bool at_state;              /* of a series: what is known beside the state stands in locals */
	const struct emitter *members; /* prints what declares tables of an instance, to it; NULL: not so */
};
/* The only writer: a printf format in which $n is the model's name and $N the same in capitals, $o and $p a part's own
 * name and place, $d that of the first part of its degree, $c the columns of a series, $$ a dollar. */
void say(const struct emitter *e, const char *layout, ...) __attribute__((format(printf, 2, 3)));
/* the same as text */
const char *spell(const struct emitter *e, const char *layout, ...) __attribute__((format(printf, 2, 3)));
/* Behind a blank line and the note, NULL: none, what is before the body, which begins; the end of it, before which
 * stand the names that nothing may have read, blanks between */
void open_function(const struct emitter *e, const char *note, const char *layout, ...)
	__attribute__((format(printf, 3, 4)));
void close_function(const struct emitter *e, const char *unread);
void emit_if_any(void (*printer)(const struct emitter *e), const struct emitter *e);  /* NULL: none */
void put(FILE *to, const char *text, size_t length);              /* of finished C, as it is */
/* static const int NAME_name[]; of none there is a 0 */
void emit_int_list(const struct emitter *e, const char *name, int count, const int *value);
void emit_integers(const struct emitter *e, const char *type, const char *name, int count, const int *value);
/* static const TYPE NAME_name = {{...}, ...}; the name has its dimensions, as entry[7][3] */
void emit_integer_rows(const struct emitter *e, const char *type, const char *name, int rows, int columns,
		       const int *value);
/* Members of NAME_coeffs: of the spec's values, numbers between the two; or in declare_members what declares them */
void open_member(const struct emitter *e, const char *type, const char *name, const char *shape, const char *note);
void close_member(const struct emitter *e);
void number_member(const struct emitter *e, const char *name, const char *value, const char *note);
void declare_members(const struct emitter *e, void (*print)(const struct emitter *e));
void emit_nominal_of(const struct emitter *e, void (*print)(const struct emitter *e));    /* NAME_nominal */

const char *tree(int terms, const char *const *term, int indent); /* a balanced sum */
void say_wrapped(const struct emitter *e, const char *text);      /* a statement, broken where it is long */
/* const double name[count] = {...}; NULL: 1 */
void say_vector(const struct emitter *e, const char *name, int count, const char *const *text);
const char *whole_text(int number);
void say_include(const struct emitter *e, const char *algorithm);
/* For an algorithm that the file includes: PL_NAME, as it is called there */
void say_macro(const struct emitter *e, const char *name, const char *text);
const char *scaled(double factor, const char *operand);           /* operand NULL: 1 */
/* rounded; an error at the step where it overflows */
double finite_number(const struct emitter *e, mpq_srcptr q);
void emit_number_rows(const struct emitter *e, int rows, int columns, const double *value, const char *const *row_note);
/* static const double NAME_name[size[0]]...[size[dimensions - 1]], behind a blank line and the note, NULL: none; `row`:
 * of those of the last dimension, NULL: nothing is said of them */
void emit_array(const struct emitter *e, const char *note, const char *name, int dimensions, const int *size,
		const double *value, const char *const *row);
void emit_name_list(const struct emitter *e, const char *array, int count, const char *const *name);
const char *low_text(mpq_srcptr q);                               /* what its rounding leaves out, rounded */
const char *two_text(mpq_srcptr q);                               /* {hi, lo} */

/* ---- included.c, single.c, apart.c: C that was printed, printed again, in this order ---- */

typedef void rewriter(FILE *to, const char *text, const char *name); /* of a model of this name */
rewriter print_included;        /* the runtime's algorithms in the place of the lines that include them, for double */
rewriter print_single;          /* C for double as C for float */
rewriter print_apart;           /* no local is called as the model */
bool algorithms_use(const char *text, const char *name);     /* is it a word of what the text includes, or a header? */

/* ---- printed.c: C that was printed, read again ---- */

bool in_name(char c);
size_t name_length(const char *text);
bool is_named(const char *text, size_t length, const char *name); /* is a word of that length this one? */
const char *behind_plain(const char *text);                       /* a character, and all up to a word, a string, a / */
/* Behind a comment, a string, or a line of the preprocessor that starts here; NULL: none does */
const char *behind_quoted(const char *text, bool line_start);
const char *behind(const char *text, char last);                  /* the first `last` that is in no braces */

/* ---- identifiers.c: what symbols are called in C ---- */

/* What every symbol is called; `local` receives the same of every state. */
struct identifiers *identifiers_of(const struct model *model, const char *upper, const char **local);
const char *c_name(const struct identifiers *c, const struct symbol *s, int order); /* of it, of its first derivative */
const char *written_local(const struct identifiers *c, const struct model *written, int state); /* of a written state */

/* ---- state.c: the state in emitted code ---- */

const struct expansion *own_expansion(const struct emitter *e);   /* of the step */
const struct truncation *truncation_of(const struct emitter *e);  /* of the model */
bool has_jump(const struct emitter *e);
bool has_peak_rows(const struct emitter *e);                      /* which are found from x */
bool has_ranges(const struct emitter *e);       /* the spec says in which some states stay */
bool keeps_status(const struct emitter *e);
bool tells_tolerance(const struct emitter *e);  /* of its states, as written */
bool has_floors(const struct emitter *e);       /* some states have an absolute tolerance */
bool has_peaks(const struct emitter *e);                          /* some output is the largest size so far */
const char *state_list(const struct model *model);                /* x, x' */
const char *carried_text(const struct emitter *e);                /* the states that only add up */
const struct model *speaker(const struct model *model);            /* over whose coordinates its forms are */
const char *input_name(const struct emitter *e, int input, int order); /* the C name of an input, of its slope */
const char *stepped_table(const struct emitter *e, const char *table); /* Phi or Gamma of the states as they are kept */
/* of a velocity that is kept as a momentum; NULL: it is not */
const char *factor_of_momentum(const struct emitter *e, int state);
void emit_locals(const struct emitter *e, const bool *reads);     /* the states wanted, under their names */
/* as kept: of kick-drift-kick, momenta; reads NULL: all */
void emit_raw_locals(const struct emitter *e, const bool *reads);
void emit_locals_of(const struct emitter *e, const bool *reads, const char *vector);
/* of a part, in the model: a state of it, an input; how many states it has; state i in a loop, as text */
int place_of_state(const struct emitter *e, int state);
/* a tunable param, or a lead, in an instance s; */
const char *param_text(const struct emitter *e, int param);
const char *param_local(const struct emitter *e, int param);      /* its C name */
int given_inputs(const struct emitter *e);                        /* samples of a step: without params that act so */
const char *sample_now(const struct emitter *e, int input);       /* of the whole: what a step is given, or a param */
const char *sample_kept(const struct emitter *e, int input);      /* the same between steps */
int place_of_input(const struct emitter *e, int input);
const char *tap_text(const struct emitter *e, int input, int tap); /* a sample that the step has, oldest first */
const char *input_operand(const struct emitter *e, int column);   /* the same, by the columns of all inputs */
const char *own_states(const struct emitter *e);
const char *place_in_loop(const struct emitter *e);
const char *step_length(const struct emitter *e);                 /* NAME_H; of tunable models that of the instance s */
const char *slope_of_samples(const struct emitter *e, const char *to, const char *from); /* samples a step apart */
const char *ramp_slope(const struct emitter *e, int input);       /* of an input that ramps to u over the step */
bool has_place(const struct emitter *e);                           /* NAME_place */
/* a table of what a step adds: the instance's own, or the model's */
const char *of_step(const struct emitter *e, const char *table);

struct size { const char *name; int value; };
/* Before an algorithm of the runtime is included: PL(name), PL_TYPE, PL_H, PL_SINGLE, and PL_... of each size, up to
 * one without a name; emit_sizes: of those listed */
void open_algorithm(const struct emitter *e, const struct size *size);
#define emit_sizes(e, ...) open_algorithm(e, (const struct size[]){ __VA_ARGS__, { NULL, 0 } })

const char *param_list(const struct emitter *e);                  /* names, commas between */
void emit_nominal_params(const struct emitter *e);                /* a member */
void emit_param_locals(const struct emitter *e, const bool *reads); /* of those that forms read: struct reads */
void emit_nominal_params_read(const struct emitter *e, const struct reads *reads); /* the spec's values */

/* ---- formulas.c: forms with atoms as C, by a tape ---- */

struct formulas;
enum formula_table { TABLE_NODE = LINEAR_TABLES, TABLE_EXCESS };  /* of TAPE_TABLE too: node[], excess[] */
/* How forms are read: over y[], u[] and t as the equations are written, else by the locals of the step; what the state
 * chooses as interval[] says, the intervals of the step's expressions, else as the state is; conditions on time alone
 * as at the time that the C `when` is, NULL: at t */
struct reading { bool written, by_intervals; const char *when; };
const char *basis_now(const struct emitter *e, const struct basis *basis); /* its operand; NULL: 1 */
/* What is to be formulas, all of it: what several read is computed once, under the name of a let where it has one. */
struct formulas *formulas_new(const struct emitter *e, struct reading how, int count, const struct form *const *form);
struct tape *formulas_tape(const struct formulas *f);             /* to set targets in */
tape_ref formula(struct formulas *f, const struct form *form);
tape_ref formula_sizes(struct formulas *f, const struct form *form); /* the sum of the sizes of its terms */
void formulas_finish(struct formulas *f);                         /* once all is set */
struct reads reads_of_formulas(const struct formulas *f);         /* of what is finished, but for <math.h> */
void note_reads(struct reads *r, const struct emitter *e, const struct tape *t); /* what it reads, too */
void emit_formulas(struct formulas *f, int indent);

/* ---- leftover.c: what a scheme leaves over, as a function ---- */

bool many_operators(const struct emitter *e);
bool any_of(const bool *flag, int count);
/* What a leftover, an operator, is handed in a step: samples at its start, their slopes [1/s] */
const char *samples_of_step(const struct emitter *e);
/* A call at a node of the step, and one in the outputs, into `left` */
const char *leftover_of_step(const struct emitter *e, int node, const char *state, const char *left);
const char *leftover_of_outputs(const struct emitter *e);
/* Does an output read an acceleration that something left over acts on? */
bool reads_channels(const struct model *model);
void emit_leftover(const struct emitter *e);                      /* and of a bank the choice of an operator */

const char *selection_call(const struct emitter *e);              /* of a bank: which operator serves now */

/* ---- loops.c: a step with a leftover that loops over its tables ---- */

void emit_loop_tables(const struct emitter *e);
const char *matrix_text(const struct emitter *e, const char *name); /* its first entry, of the operator that serves */
const char *vector_name(int stage);
bool flows_apart(const struct emitter *e);                        /* where a change of the loads may interrupt them */
void emit_operands(const struct emitter *e);                      /* declares load, input, which the tables multiply */
/* target = Phi y + loads + inputs over the time of table t; from rest: the loads and inputs alone */
void emit_flow_loop(const struct emitter *e, int t, bool from_rest, const char *target, const char *margin);
void emit_combination_loop(const struct emitter *e, const struct action *a);
void emit_sum_loop(const struct emitter *e, const struct action *a);

/* ---- actions.c: the step of a scheme that leaves something over ---- */

void emit_actions_of_step(const struct emitter *e);                /* its body, without time */
void emit_leftover_step(const struct emitter *e);
void emit_samples(const struct emitter *e);                       /* start, slope: what leftovers read of ramps */

/* ---- tuned_terms.c: factors that the instance has ---- */

bool is_tuned_output(const struct emitter *e, const struct output *output); /* params change it */
/* Entry of an enum linear_table in a step, in outputs */
const char *linear_entry(const struct emitter *e, const struct tape_node *n);
int  place_in(int count, const int *list, int what);              /* count: it is not there */
/* Its row of factors, in struct NAME_coeffs */
const char *tuned_output_row(const struct emitter *e, const struct output *output);

/* ---- emit_peaks.c: the largest sizes of outputs ---- */

void emit_peak_tables(const struct emitter *e);
void emit_peak_members(const struct emitter *e);
void emit_peak_step(const struct emitter *e);
/* Members of NAME_coeffs, of tunable models */
void emit_nominal_peaks(const struct emitter *e);

/* ---- emit_lanes.c, emit_batch.c: many instances in one call ---- */

struct batch {
	const struct emitter *e;
	int shared;                     /* numbers that instances share in a step: `now` */
	const char **shared_text;       /* first those that the step reads, before it; */
	int after;                      /* from here on those of the outputs, after it */
	struct tape *step, *out;        /* what lanes compute */
	int forced;                     /* index of the forced part; -1: none */
	bool sampled;                   /* of peaks: nothing acts on the states but polynomials through samples */
	int lanes;                      /* factors of the instance that lanes have; */
	int factors;                    /* of an instance, that its params decide */
	const char **factor_text;       /* s->coeffs.step[0][1] */
};
struct batch plan_batch(const struct emitter *e);
int batch_stepped_rows(const struct emitter *e);                  /* of an instance's memory: those a step changes */
int batch_groups(const struct emitter *e);                        /* of lanes that step in turns */
void emit_lanes_step(struct batch *b);
void emit_lanes_out(struct batch *b);
void emit_lanes_bend(struct batch *b);                            /* how far outputs may be off their chords */
void emit_batch_declarations(const struct emitter *e);
void emit_batch(const struct emitter *e);

/* ---- selftest.c: reference states in closed form, for the target to step to ---- */

void emit_selftest(const struct emitter *e, bool jumps);

/* ---- kinds.c: what the C of a step has that depends on its kind, in the order of the C ---- */

struct kind {                           /* NULL: none of its own */
	/* The comment at the top: what is approximated; before what a step costs */
	void (*banner)(const struct emitter *e);
	const char *step_note;
	const char *no_jump;                            /* why there never is a NAME_jump; NULL: there may be one */
	/* The header: constants; types before that of the state; at its end; functions */
	void (*constants)(const struct emitter *e);
	void (*types)(const struct emitter *e);
	void (*members)(const struct emitter *e);
	bool keeps_status;                              /* else NAME_status looks at the state when it is asked */
	const char *status_note;
	void (*declare_state)(const struct emitter *e); /* of what else the state has */
	/* The state */
	bool own_factors;                               /* what depends on h is in s->coeffs; else in tables */
	bool (*places)(const struct emitter *e);        /* NAME_place(s) finds what follows from a state that was set */
	/* Tables and functions */
	bool (*reads_phi)(const struct step *step);     /* of what is kept, in a loop */
	void (*tables)(const struct emitter *e);
	void (*pass)(const struct emitter *e);          /* over what changes at a time */
	void (*step)(const struct emitter *e);
	void (*held)(const struct emitter *e);          /* in at: what is held over the step */
	void (*at)(const struct emitter *e);
};
const struct kind *row_of_kind(enum step_kind kind);

/* ---- emit_forces.c: tables of modes, and forces on them ---- */

const struct normal *normal_of_step(const struct emitter *e);
int  functions_of_time(const struct emitter *e);                  /* beside the constant one */
bool has_bank(const struct emitter *e);                           /* of several operators */
struct row_sum {                    /* of what is written out in a loop over i */
	int terms, room;
	const char **term;
};
void add_summand(struct row_sum *s, const char *text);
/* target[i] = sum for so many i, in as many loops as its terms ask for */
void say_row_sum(const struct emitter *e, const char *target, int rows, const struct row_sum *s);
void emit_to_modes(const struct emitter *e);                      /* NAME_modes_of */
void emit_from_modes(const struct emitter *e);                    /* NAME_of_modes */
void emit_function_values(const struct emitter *e);               /* NAME_functions */
void emit_forces(const struct emitter *e);                        /* NAME_forces */

/* ---- emit_normal.c: steps in normal modes ---- */

void emit_normal_members(const struct emitter *e);
void emit_normal_tables(const struct emitter *e);

/* ---- banner.c, declarations.c: what a header has ---- */

void emit_banner(const struct emitter *e);
void banner_linear(const struct emitter *e);                      /* what is approximated, of each kind */
void banner_leftover(const struct emitter *e);
void banner_cut(const struct emitter *e);
void banner_regions(const struct emitter *e);
void banner_parts(const struct emitter *e);
void banner_expanded(const struct emitter *e);
void banner_collocated(const struct emitter *e);
void banner_normal(const struct emitter *e);
const char **names_of_outputs(const struct emitter *e);             /* index_names.c: as the user knows them */
const char **names_of_inputs(const struct emitter *e);
void emit_index_names(const struct emitter *e);                    /* NAME_OUT_TIP and the like */
void announce(const struct emitter *e, const char *text, const char *comment);     /* one declaration */
void open_declarations(const struct emitter *e, const char *included);
void close_declarations(const struct emitter *e);
void emit_counts(const struct emitter *e, int inputs);            /* NAME_STATES and the like */
void declare_reading(const struct emitter *e, const char *status_note);           /* get, time, status */
void declare_driven_step(const struct emitter *e, const char *note);              /* step, out, run, at */
void emit_declarations(const struct emitter *e, bool rhs);

/* ---- kept.c: states as written, and as they are kept ---- */

void emit_conversions(const struct emitter *e);

/* ---- access.c: init, set, get, time, status ---- */

void emit_access(const struct emitter *e);

/* ---- descriptor.c: tables for all to read, and the descriptor ---- */

void emit_phi(const struct emitter *e);
void emit_mode_matrices(const struct emitter *e);               /* of a model of some modes: from and to all states */
void emit_gamma(const struct emitter *e);
void emit_descriptor(const struct emitter *e);
/* names, NAME_any_init and the like, NAME_model; `core`: with what only a whole model has */
void emit_model(const struct emitter *e, int inputs, bool core);

/* ---- emit_large.c: the step of a large model ---- */

void emit_groups(const struct emitter *e);                        /* tables and functions of its independent blocks */
void emit_group_steps(const struct emitter *e, const char *const *acting_text); /* but rows; loads, then inputs */
struct group_shape {                /* of its numbers, where they are a table or stand in the instance */
	const char *name;           /* columns */
	int rows, columns;
	int changing;               /* rows of what it has in each segment of time beside them */
};
struct group_shape shape_of_group(const struct emitter *e, const struct group *g);
void emit_group_numbers(const struct emitter *e, const struct group *g, bool changing);
const char *group_note(const struct emitter *e, const struct group *g);
/* Which row and column of its blocks a row of numbers of blocks alike is of; columns: states, loads, inputs */
int  alike_entry(const struct emitter *e, const struct group *g, bool changing, int index, int *column);

/* ---- blockwise.c: the independent blocks of a large model, one after the other between steps and many at once ---- */

bool is_blockwise(const struct emitter *e);
int  count_blocks(const struct emitter *e);
int  states_of_largest_block(const struct emitter *e);
void emit_block_list(const struct emitter *e);

/* ---- emit_modal.c: a step of modes ---- */

void emit_modes(const struct emitter *e);                         /* tables; nothing of other forms */
void emit_modal_step(const struct emitter *e, const char *const *acting_text);

/* ---- emit.c and emit_step, _out, _run, _loads, _forced, _anchors, _time, _rhs: a step as C ---- */

void emit_header(FILE *to, const struct step *step, const char *options, bool rhs);
/* header_name NULL: all in one */
void emit_code(FILE *to, const struct step *step, const char *options, const char *header_name, bool rhs);

void emit_load_tables(const struct emitter *e);                   /* phases and growths: start, step, rate */
void emit_load_members(const struct emitter *e);
const char *phase_rate_text(const struct emitter *e);             /* of the model, or the instance */
void emit_load_advance(const struct emitter *e, const char *steps); /* `steps` NULL: one */
/* declares load1[...] for the loads wanted */
void emit_load_states(const struct emitter *e, const bool *loads, bool time_is_there);
void emit_load_array(const struct emitter *e, int load);          /* load1[2], what its states are called */
void emit_load_functions(const struct emitter *e, int load);      /* its states, from its phase and growth */
void emit_load_powers(const struct emitter *e, int load);         /* those with t, from those without */
bool outputs_read(const struct emitter *e, int load);
void emit_anchor_tables(const struct emitter *e);                 /* of anchors: tables, and NAME_anchor */
void emit_anchor_members(const struct emitter *e);
/* as emit_load_states, in a step: at the anchor, to be multiplied with turned[...]; elsewhere: of now */
void emit_anchored_loads(const struct emitter *e, const bool *loads);
void emit_loads_at_anchor(const struct emitter *e, const bool *loads);    /* where one stands now */
void emit_turned_loads(const struct emitter *e, const bool *loads, bool time_is_there);
void emit_forced(const struct emitter *e);                        /* NAME_forced: what is not kept of the state */
const char *load_operand(const struct emitter *e, int load, int column); /* NULL: the constant 1 */
const char *column_operand(const struct emitter *e, int column);

void emit_phase_rates(const struct emitter *e);                   /* rows of initialisers */
const char *phase_step_text(const struct emitter *e, int load);   /* in one step: a turn, as an initialiser */
const char *growth_step_text(const struct emitter *e, int load);
void emit_changes(const struct emitter *e);                       /* loads that change their formula: when */
void emit_held_leftover(const struct emitter *e);                 /* which operator serves, and what is left over now */
void emit_passing(const struct emitter *e);                       /* ... and pass(), across a change */
/* declares load states, and i where one is `looped` over; x[...] = what the series advances */
void emit_series_vector(const struct emitter *e, bool looped);
void emit_series_slopes(const struct emitter *e);                  /* A, of x' = A x */
/* in a step that is no list of assignments: what only adds up is 0 over it */
void emit_set_aside(const struct emitter *e);
void emit_take_back(const struct emitter *e);
void emit_hand_over(const struct emitter *e);                     /* in at: y from the states in x */
void emit_vector_now(const struct emitter *e);                    /* NAME_vector_now(s, u, x) */
void emit_at_by(const struct emitter *e, const char *function);   /* NAME_at, by NAME_function(s, u, tau, y) */
void emit_at_start(const struct emitter *e);
int most_taps_before(const struct emitter *e);                     /* samples kept of an input; 0: the last alone */
bool *loads_of_step(const struct emitter *e);                    /* per load: its states are read */
void emit_step(const struct emitter *e);
/* what a step assigns to states that are `stepped` (NULL: all), to be printed */
struct formulas *formulas_of_step(const struct emitter *e, const bool *stepped);
void emit_keep_inputs(const struct emitter *e, int samples);      /* of u, which has those of so many steps */
void emit_step_end(const struct emitter *e);                      /* samples, phases and time move on */
const char *step_parameters(const struct emitter *e);
const char *head_of_step(const struct emitter *e);

/* ---- emit_delays.c: delayed inputs, around a model that has them as inputs ---- */

void emit_delay_declarations(const struct emitter *core);
void emit_delays(const struct emitter *core);

/* ---- emit_tuned_blocks.c: linear models with tunable params ---- */

void emit_tuned_members(const struct emitter *e);                 /* of NAME_coeffs */
void emit_entries(const struct emitter *e, int count, const struct fixed_slope *fixed);
/* Products and terms of all of the list; of each what a pl_equations has */
const char **emit_equations(const struct emitter *e, const struct tuning *t, int count,
			    const struct tuned_equations *const *list);

/* ---- emit_retuned.c: regions whose matrices tunable params change ---- */

void emit_retuned(const struct emitter *e);                       /* the equations, NAME_retune */
int  retuned_numbers(const struct emitter *e);                    /* of matrices, in NAME_coeffs */
int  retuned_kilobytes(const struct emitter *e);                  /* of stack, beside a NAME_coeffs */

/* ---- emit_held.c: params that an instance holds; of models without, nothing is printed ---- */

void emit_held_types(const struct emitter *e);
void emit_held_member(const struct emitter *e);
int  held_leads(const struct emitter *e);
void emit_nominal_factors(const struct emitter *e);              /* those that an instance begins with */
void emit_held_declarations(const struct emitter *e);
void banner_held(const struct emitter *e);
void emit_held_retune(const struct emitter *e);
/* the generator's own coefficients, of the spec's values */
void emit_nominal(const struct emitter *e);
void emit_retune(const struct emitter *e);                        /* the equations, retune, use */
void emit_tuned_at(const struct emitter *e);                      /* pass, from change to change of the loads; at */
void emit_node_times(const struct emitter *e);                     /* NAME_node */
/* phases and growths from the start of the step to each node */
void emit_node_phases(const struct emitter *e, const bool *loads);
void emit_out(const struct emitter *e);
void emit_run(const struct emitter *e);
void emit_at(const struct emitter *e);
void emit_jump(const struct emitter *e);
void emit_rhs(const struct emitter *e);
bool rhs_needs_math(const struct emitter *e);

#include "emit/regions.h"
#include "emit/series.h"

#endif
