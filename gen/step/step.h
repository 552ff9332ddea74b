/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model to the program of its step, and every number of it, rounded once. */
#ifndef PLGEN_STEP_H
#define PLGEN_STEP_H

#include "model/model.h"

/* ---- resolvent.c: the Laplace images of what a step needs ---- */

/* acts from tau = 0 on: sum over m of tau^m e^{a tau} times cos(w tau) and sin(w tau) */
struct excitation {
	mpq_srcptr a, w;
	int powers;                 /* m = 0 .. powers-1; where w = 0 there is no sine */
	mpq_t *force;               /* [m][cos, sin][equation]: on the equations */
	mpq_t *direct;              /* [m][cos, sin]: added to the result itself */
};
struct excitation excitation_new(int n, mpq_srcptr a, mpq_srcptr w, int powers); /* all 0; a, w NULL: 0 */
struct question {                   /* row . y(tau) */
	const mpq_t *initial;       /* y(0), one per state; NULL: 0 */
	int excitations;
	struct excitation *excitation;
	const mpq_t *row;           /* one per state */
};
struct resolvent;                   /* adj P and B of one system */
struct resolvent *resolvent_of(const struct linear *system);
struct response *image_of(struct resolvent *r, const struct question *question);
/* Where the response of this number to a state or load of `system` is kept for who asks again: NULL at first, and for
 * another system than before. Of many states none is. */
struct response **response_kept(struct resolvent *r, const struct linear *system, int number);
/* B(s) = det P, as many as its degree + 1 */
void characteristic_polynomial(const struct resolvent *r, mpq_t *coefficient);
struct spectrum *resolvent_spectrum(const struct resolvent *r);                /* of B(s) */
const struct poly *resolvent_determinant(const struct resolvent *r);           /* B(s) times the scales of the rows */

/* ---- loads.c: loads, inputs and held terms as excitations of a step ---- */

/* Phi_ij, held terms included */
struct response *response_of_state(struct resolvent *r, const struct linear *system, int i, int j);
struct response *response_of_load(struct resolvent *r, const struct linear *system, int segment, int i, int load,
				  int column);
struct response *response_of_input(struct resolvent *r, const struct linear *system, int i, int input, int column,
				   mpq_srcptr h);
/* of one load: z_to(t+tau) from z_from(t) */
struct response *response_of_load_state(const struct load *load, int to, int from);
struct kernel_part;
struct response *response_of_kernel(struct resolvent *r, const struct linear *system, int i, int channel,
				    const struct kernel_part *part, mpq_srcptr h);
/* what its unit force gives the states' derivatives */
mpq_t *impulse_of_channel(const struct linear *system, int channel);
struct started {                    /* a response that starts at a time of its own */
	struct response *response;
	mpq_t start;
};
/* output(t) from t = 0 as a sum of responses; returns how many */
int responses_of_output(struct resolvent *r, const struct linear *system, const mpq_t *initial,
			const struct output *output, struct started **list);
struct output state_as_output(const struct linear *system, int state); /* read alone */
/* what an output is after tau: from these states alone; from a load state 1, and these states (NULL: 0), in the first
 * segment of time; of an input u = value + slope tau, from rest */
struct response *output_of_states(struct resolvent *r, const struct output *output, const mpq_t *initial);
struct response *output_of_load(struct resolvent *r, const struct linear *system, const struct output *output, int load,
				int column, const mpq_t *initial);
struct response *output_of_input(struct resolvent *r, const struct linear *system, const struct output *output,
				 int input, mpq_srcptr value, mpq_srcptr slope);
/* its value, rational or the nearest of 256 bits */
void load_state(const struct load *load, int column, mpq_srcptr t, mpq_ptr z);

/* ---- numbers.c, coefficients.c: numbers of the step, each rounded once ---- */

struct coefficient {
	/* of the target's type; value + low is the number in two words (low only where asked for) */
	double value, low;
	bool zero;                  /* exactly: no trace in the code */
};
/* What multiplies a leftover, as a sum of parts: at tau = fraction h, B the force of its channel,
 *     impulse e^{A tau} B + integral over 0..tau of e^{A (tau - s)} B (power[0] + power[1] s/h + power[2] (s/h)^2) ds
 * so h phi_k(A h) B is power k-1 over (k-1)!. The sum is rounded once. */
enum { PART_POWERS = 3, KERNEL_PARTS = 2, TABLE_KERNELS = 4 };
struct kernel_part {
	mpq_t fraction, impulse, power[PART_POWERS];
	int powers;
};
struct kernel {
	const char *name;           /* b1 */
	int parts;
	struct kernel_part part[KERNEL_PARTS];
};
struct wanted {                     /* of one table */
	mpq_t fraction;             /* its time, as a part of h */
	bool Phi, two_words;
	bool increments;            /* Phi - I */
	const mpq_t *mass;          /* kicks and drifts; one per coordinate, in units of the first; NULL: not wanted */
	const char *name;           /* full, half */
	int kernels;
	struct kernel kernel[TABLE_KERNELS];
};
struct table {                      /* of one time: y(tau) = Phi y + sum of columns */
	const struct wanted *wanted;
	int states, columns, inputs, channels;
	struct coefficient *Phi;    /* states x states, or NULL */
	struct coefficient *increment; /* Phi - I, each entry rounded as it is; or NULL */
	/* coordinates x coordinates, symmetric: S = Phi_12 M^-1 and X = S^-1 (Phi_11 - I); or NULL */
	struct coefficient *drift, *kick;
	struct coefficient *load;   /* [segment of time][states x columns]: of the loads in order */
	struct coefficient *input;  /* states x inputs: u held; or its value before the step and after it */
	struct coefficient **kernel; /* per kernel: states x channels */
};
/* leaves the statement where |p| h is hopeless */
void check_pole_size(const struct model *model, const struct resolvent *resolvent);
/* Rounded, infinite beyond the range; `at` and `what` name it where it cannot be decided. */
/* their sum */
struct coefficient started_value(int count, const struct started *list, mpq_srcptr t, bool two_words, struct place at,
				 const char *what);
struct coefficient response_value(struct response *response, mpq_srcptr tau, bool two_words, struct place at,
				  const char *what);
/* Block by block; by residues, beyond LIMIT_RESIDUE_STATES states by Taylor series. `resolvent`: of the whole */
struct table **tables_of(const struct model *model, struct resolvent *resolvent, const struct linear *system, int count,
			 const struct wanted *wanted);

/* ---- frequencies.c: natural frequencies and damping ratios ---- */

struct pole_report {                /* sorted by |p|, then by real part */
	mpfr_t re, im;              /* rounded from 256 bits */
	mpfr_t hertz, damping_ratio;
	int multiplicity;
	bool pair;                  /* stands for itself and its conjugate */
};
/* an error at the step where they are not told apart */
int poles_of(const struct model *model, const struct resolvent *resolvent, struct pole_report **report);

/* ---- program.c: what a scheme steps with, as a program over tables ---- */

enum operand_kind { OPERAND_STATE, OPERAND_LOAD, OPERAND_INPUT };
struct operand {
	enum operand_kind kind;
	int index;                  /* state; or column of the loads, of the inputs */
};
struct product {
	const struct coefficient *factor; /* of a load: in the first segment of time */
	struct operand operand;
};
struct assignment {                 /* target <- sum of products */
	int target;                 /* state */
	bool added;                 /* target <- target + sum of products */
	bool carried;               /* with what rounding takes kept in carry */
	int terms;
	struct product *term;
};
/* Of a step that loops: independent blocks that are stepped in one way */
enum group_kind {
	GROUP_ROWS,                 /* one small block: its assignments */
	GROUP_ALIKE,                /* small ones of one shape, each with factors of its own: one loop over them */
	GROUP_COLUMNS               /* one block: a matrix by its columns */
};
struct group {
	enum group_kind kind;
	int states, blocks;         /* states of a block; how many blocks there are */
	int *state;                 /* [states][blocks]: which it is */
	int loads, *load;           /* columns of loads that act on it, */
	int inputs, *input;         /* and of inputs */
	bool tuned;                 /* tunable params touch its factors: the instance has them */
};
/* A step of a scheme that leaves something over is a list of actions on vectors: stages are states (0: the state
 * itself), lefts are leftovers. */
enum { STAGE_STATE = 0, NONE = -1, SUM_KERNELS = 4 };
struct action {
	enum { ACTION_LEFTOVER, ACTION_COMBINE, ACTION_SUM, ACTION_PREDICT } kind;
	int target;                 /* LEFTOVER, COMBINE: a left; SUM, PREDICT: a stage */
	int node, from;             /* LEFTOVER: when, and of which stage; PREDICT: when it ends */
	int half;                   /* PREDICT: the node in the middle */
	int plus, minus;            /* COMBINE: lefts; minus NONE: twice `plus`; `added` adds instead */
	bool added;
	int flow;                   /* SUM: table whose Phi, loads and inputs act on the state, or NONE */
	int plain;                  /* SUM: stage added as it is, or NONE */
	int kernels;                /* SUM: kernel of table times left, added */
	struct { int table, kernel, left; } kernel[SUM_KERNELS];
	const char *note;           /* a = F y + q1 r0 */
};
struct program {
	int assignments;            /* of a scheme that leaves nothing over */
	struct assignment *assignment;
	/* each assignment reads what those before it have left; else all read the old state */
	bool in_order;
	bool compensated;           /* factors in two words, and what rounding takes from a state is kept */
	bool *reads;                /* per state: whether its old value is read */
	bool *uses;                 /* per column of the loads */
	/* for cos/sin pairs and exponentials: counted below too, or beside it what comes at each anchor */
	int wave_multiplications, wave_additions;
	int multiplications, additions, calls; /* calls: of the model's own functions */
	int peak_multiplications, peak_additions; /* beside them: the outputs, and that none passes its peak */
	bool loops;                 /* over tables: a large model */
	/* of a list that loops: how its assignments are done, by blocks */
	int groups;
	struct group *group;
	bool products_added;        /* to the state */
	bool tuned;                 /* factors are read from the instance's coefficients */
	int actions;                /* 0: assignments */
	struct action *action;
	int stages, lefts;          /* vectors, the state not counted */
	int nodes;                  /* times at which leftovers are evaluated, as parts of h; the first is 0 */
	mpq_t *node;
	int *node_table;            /* per node: the table of loads and inputs that a predictor adds, or NONE */
	bool predicts;
};
/* part times the load states solves the equations: what some loads sustain by themselves */
struct forced {
	bool *load;                 /* per load: one of them; then the step is without it */
	int rows, written;          /* the states as they are kept, and those as written from this row on */
	struct coefficient *part;   /* [segment of time][row][load column] */
	mpq_t *exact;               /* the same */
	/* [segment of time][state][load column]: what the state that is kept gains from there to the next */
	struct coefficient *change;
	bool changes;               /* any of it */
	int multiplications, additions; /* to add it */
};
/* Of a step that is not left to the search: crossings, and parts looked at */
enum { MOST_SWIFT = 4, MOST_LOOKS = 10 };
enum { MOST_ANCHORED = 256 };       /* steps from one anchor to the next */
struct anchored_term { int state, column; };
struct anchors {                    /* load states at an anchor, and tables for the steps to the next */
	int steps;                  /* from one to the next */
	bool *load;                 /* per load: an anchor keeps its states */
	bool turned;                /* the step turns them into those of now, and has no terms */
	int terms;                  /* of a step: by state, then by column of a load */
	struct anchored_term *term;
	struct coefficient *factor; /* [steps since the anchor][term]: of the load state there */
	double *turn;               /* [load][steps since][2]: e^{a l h} cos(w l h) and sin */
};
struct rounding {                   /* a bound over the first steps from the initial values, inputs 0 */
	bool known;
	int steps;
	const char *state;          /* as written or as it is kept: where it is largest */
	double relative;            /* to the state's largest value */
	bool tiny;                  /* there are states too small for the target's range, which it leaves out */
};
/* an operator of a scheme, a region of a piecewise-linear model, or the linear model */
struct branch {
	struct linear system;       /* with what the scheme holds taken out of C and K */
	struct resolvent *resolvent; /* of `system` */
	struct table **table;       /* of regions: of the step, then of the rungs of its ladder */
	struct table *whole;        /* of the whole step: the first */
	int halvings;               /* of a region: log2 of the pieces of a step in which crossings are looked for */
	int rungs, spacing;         /* lengths of pieces below h: from those on, so many halvings apart */
};
struct series {                     /* of e^{A tau} x: the Taylor series behind NAME_at, and the pieces of regions */
	bool emitted;               /* max|pole| h <= 8 */
	int degree, halvings;
};
enum step_kind {                    /* what a step is made of */
	KIND_LINEAR,                /* assignments, or loops over tables: nothing is left over */
	KIND_TUNED,                 /* the same, with factors that the instance has; of a large one, of some blocks */
	KIND_REGIONS,               /* the series of a region, and a search for crossings */
	KIND_PARTS,                 /* independent parts, each with regions of its own, or linear */
	KIND_LEFTOVER,              /* a list of actions on stages and leftovers */
	KIND_CUT,                   /* the same, from crossing to crossing */
	KIND_EXPANDED,              /* the Taylor series of the solution */
	KIND_COLLOCATED,            /* polynomials that solve the equations at nodes; beside them a series, or none */
	KIND_NORMAL,                /* normal modes, and what is left over as forces on them */
	KINDS
};
/* Phases and growths of loads e^{at} cos(wt + p) in fixed point: 128 bits; for the target float 64, in `low` */
struct fixed_point { uint64_t high, low; };
struct advance {                    /* over some time tau; 0 where there is no w, no a */
	struct fixed_point turn;          /* w tau / 2 pi in units of 2^-128 (2^-64), wrapped */
	struct fixed_point growth;        /* a tau / ln 2 in units of 2^-112 (2^-48), two's complement; saturated */
};
struct rate {                       /* word[0] word[1] word[2] 2^exponent, as one number of 64 bits a word [1/s] */
	int words;                  /* 3; for float 2 */
	uint64_t word[3];
	long exponent;
};
struct load_phase {                 /* of one load */
	struct fixed_point start;         /* p / 2 pi, as a turn */
	struct advance step, *node; /* over the step; from its start to each node of the program */
	struct rate turns, growth;  /* |w| / 2 pi, |a| / ln 2 */
};
struct step {                       /* everything that is emitted for one model */
	const struct model *model;
	struct model *plain;        /* without an option that stands aside: to be built in its place; or NULL */
	enum step_kind kind;
	struct resolvent *written;  /* of the model as written: the report's poles, the closed form */
	/* what users see of tables: over the states as written; itself, where those are stepped */
	const struct step *shown;
	int branches;               /* 1 where nothing is left over */
	struct branch *branch;
	int tables;                 /* of each; 1 where nothing is left over */
	struct program *program;
	enum step_form form;        /* any but FORM_AUTO */
	const mpq_t *mass;          /* of kick-drift-kick, per coordinate; in units of the first */
	struct modal *modal;        /* NAME keeps modal states; NULL: of another form */
	const char *no_modal;       /* why not, where it would be cheaper; NULL: it would not */
	bool momenta;               /* NAME keeps mass times velocity, since not all masses are equal */
	/* states that nothing leads back from, which only add up: index of what rounding takes from each; -1: of
	 * others */
	int carries, *carry;
	const char *no_lanes;       /* why instances of a batch step each by itself; NULL: as lanes, or there is none */
	struct anchors *anchors;    /* NULL: functions of loads in every step */
	const char *no_anchors;     /* why, where a load has some; NULL: there are anchors, or none has */
	struct forced *forced;      /* NAME keeps the state less this; NULL: as it is */
	struct rest *rest;          /* what comes to rest where it is all but nothing; NULL: no part does */
	struct rounding rounding;
	struct choice *choice;      /* what it was chosen from; NULL: there are no needs */
	struct tuned_blocks *blocks; /* NULL: no linear step with tunable params */
	mpfr_t growth;              /* pl: 1/s, largest real part of the modified equation's poles (report only) */
	struct layout layout;       /* of x */
	struct series series;
	/* of regions: a step looks over the whole of h whether it is clear; and for few crossings, by Taylor
	 * polynomials of this degree */
	bool clears, swift;
	const char *searches;       /* why it does not look whether it is clear */
	int swift_degree;
	struct expansion *expansion; /* of an expanded step; else NULL */
	struct expansion *divided; /* whose expressions choose formulas by the state; NULL: none does */
	const struct expansion *unseen; /* what polynomials may not show of it bounds them; NULL: nothing does */
	struct expansion *slopes;   /* of the states, where such a series is looked at further on; else NULL */
	const char *no_phi;         /* why e^{A h}, which a collocated step does not need, is not there; NULL: it is */
	struct cut *cut;            /* of a step of this kind; else NULL */
	struct collocation *collocation; /* of a collocated step; else NULL */
	struct motion *motion;      /* likewise */
	struct { int multiplications, additions, calls; } iteration; /* of Newton's method: what one costs */
	struct normal *normal;      /* of a step in normal modes; else NULL */
	int parts;                  /* of a piecewise-linear model that are independent, each with a step of its own */
	struct step **part;
	struct load_phase *phase;   /* per load */
	struct rows *rows;          /* NAME_run in blocks of rows; NULL: step by step */
	const char *no_rows;        /* why it is so, where a reader would ask */
};
enum step_kind kind_of_step(const struct model *model);
bool is_anchored(const struct step *step, int load);        /* its functions are evaluated at anchors only */
const char *text_of_column(const struct linear *system, int column);
int load_of_column(const struct linear *system, int column, int *first); /* *first: the first column of that load */
bool is_forced(const struct step *step, int column);         /* is this load state's load left out of the step? */
/* those that a system or an expression reads */
bool *loads_of_regions(const struct step *step);
bool has_leftover(const struct step *step);                 /* it is of that kind, or expanded */
void need_closed_form(const struct step *step);              /* leaves the statement where there is none */

/* ---- tapes.c: what forms read, a linear step and rows of outputs as nodes of a tape ---- */

int load_of_wave(const struct linear *system, const struct wave *wave); /* the number of loads: of none */
/* What a form reads of a coordinate, an input, a load now */
tape_ref tape_of_basis(struct tape *t, const struct linear *system, const struct basis *basis);

/* What TAPE_TABLE is an entry of: */
enum linear_table {
	TABLE_TURNED,               /* factors of load states at an anchor, second words behind them */
	TABLE_OWN,                  /* the instance's, of a step: state x states, then loads, then inputs */
	TABLE_OWN_OUT,              /* the same, of outputs: row x column of tuning->x */
	TABLE_FACTOR,               /* of load states that change their formula: state x column */
	TABLE_DIRECT,               /* likewise of outputs: place of an output x column */
	TABLE_FORCED,               /* likewise of what the step leaves out: state x column */
	TABLE_LEFT,                 /* what is left over: channel */
	TABLE_SEEN,                 /* what an output sees of the modes */
	LINEAR_TABLES
};
enum { PLACE_REST, PLACE_CARRY };   /* `part` of TAPE_ACCUMULATE */
const struct linear *system_of_outputs(const struct step *step); /* of regions one with all segments of time */
/* Column of the loads; TAPE_NONE: the constant 1 */
tape_ref tape_of_column(struct tape *t, const struct linear *system, int column);
/* What loads sustain by themselves of the states as they are kept */
void tape_of_forced(struct tape *t, const struct step *step, const char *vector);
/* Rows of outputs read the state as it is kept, and what loads sustain of it by the factors of the load states */
bool rows_sustained(const struct step *step);
/* Per segment of time, what a row of outputs takes of a load state, by itself and so */
const mpq_t *direct_factors(const struct step *step, const struct output *output, int load, int column);
/* Sets vector[i] to state i after a step, of those that are stepped; NULL: all */
void tape_of_step(struct tape *t, const struct step *step, const bool *stepped, const char *vector);
bool has_second_word(const struct product *p, const struct step *step);
tape_ref tape_of_row(struct tape *t, const struct step *step, const struct output *output); /* not what is left over */
int own_row(const struct step *step, const struct output *output); /* of tuning, where params change it; else -1 */
int place_of_output(const struct model *model, const struct output *output); /* highest derivatives stand behind */
bool differs_in_time(const mpq_t *factor, int segments);
/* where its states stand in its blocks: `row` */
const struct group *group_of_state(const struct step *step, int state, int *index, int *row);

/* ---- check.c: between those who write programs and those who read them ---- */

/* a violation is an internal error, and leaves the statement */
void program_check(const struct step *step);

/* ---- recipe.c: what recipes are written in; one that asks for more than there is room for is refused ---- */

enum { RECIPE_TABLES = 8 };
struct recipe {                     /* of one scheme, being written */
	const struct step *step;
	struct program *program;
	int tables;
	struct wanted table[RECIPE_TABLES];
};
_Noreturn void internal_error(const struct step *step, const char *what); /* a fault of this program's own */
int  add_table(struct recipe *r, const char *name, long p, unsigned long q, bool Phi); /* at p/q of the step */
/* h (c0 phi1 + c1 phi2 + 2 c2 phi3) of A h as the response to c0 + c1 s/h + c2 (s/h)^2, over p/q of the step */
int  add_phi(struct recipe *r, int table, const char *name, long p, unsigned long q, int powers, const long *c);
/* added to that */
void add_phi_part(struct recipe *r, int table, int kernel, long p, unsigned long q, int powers, const long *c);
int  add_weighted(struct recipe *r, int table, const char *name, long p, unsigned long q, long weight,
		 unsigned long over); /* e^{A h p/q} h weight/over */
int  add_node(struct recipe *r, long p, unsigned long q);   /* a time at which leftovers are evaluated */
void need_loads_at(struct recipe *r, int node);
int  new_stage(struct recipe *r);
/* valid until the next is added, as that of add_sum is */
struct action *add_action(struct recipe *r, struct action action);
int  add_leftover(struct recipe *r, int node, int stage);
int  add_combination(struct recipe *r, int plus, int minus, bool added);
struct action *add_sum(struct recipe *r, int stage, int flow, int plain, const char *note);
void times_left(struct recipe *r, struct action *sum, int table, int kernel, int left); /* one term more of the sum */

/* ---- recipes.c: of each scheme ---- */

void write_recipe(struct recipe *r);

/* ---- held.c: what scheme pl holds over a step ---- */

struct linear piecewise_laplace(const struct linear *written);
struct linear modified_equation(const struct linear *written, const struct linear *split, mpq_srcptr h);

/* ---- series.c: the Taylor series behind NAME_at ---- */

void series_plan(struct step *step);                        /* degree, halvings */
double largest_pole_angle(const struct step *step);         /* max|pole| h, rounded up */
int  series_halvings(const struct step *step, int operator); /* of the time h, so that |pole| tau <= 1 */
/* for these operators, over h 2^-halvings */
int  series_degree(const struct step *step, int first, int last, int halvings);

/* ---- phases.c: phases and growths of loads in fixed point ---- */

int  phase_bits(const struct step *step);                    /* 128, or 64, all behind the point */
int  growth_bits(const struct step *step);                   /* 112, or 48: those behind the point */
void plan_phases(struct step *step);                        /* step->phase; after the program, for its nodes */

/* ---- slopes.c: A of x' = A x, rounded; x as in struct layout ---- */

struct load_slopes {                /* the columns of A that change from segment to segment of time */
	int first, columns;         /* of x; first -1: no load acts */
	double **segment;           /* states x columns [x/s]; 0 of loads that the step leaves out */
};
_Noreturn void tell_range(const struct step *step);          /* an error at the step: a number overflows */
/* size x size [x/s], loads as in the first segment, and the second words of the same; */
double *slopes_of(const struct step *step, int branch);
							     /* infinite beyond the range */
struct load_slopes load_slopes_of(const struct step *step);
struct coefficient *held_forces_of(const struct step *step); /* n x states: what a scheme holds, as forces */

/* ---- leap.c: the step as one matrix, for powers of it ---- */

struct leap {                       /* x(t+h) = matrix x; x = states, then the load states that the step reads */
	int size;
	int *load;                  /* index of the first state of each load; -1: the step does not read it */
};
struct leap_entry {                 /* in a segment of time, in two words */
	int segment, row, column;
	struct coefficient value;
};
struct leap leap_of(const struct step *step);
/* Beyond Phi, what is not 0; returns how many */
int leap_entries_of(const struct step *step, const struct leap *leap, struct leap_entry **entry);

/* ---- branches.c: the linear systems that a step is made of ---- */

void take_operators(struct step *step);

/* ---- switched.c: steps of piecewise-linear models ---- */

void build_regions_step(struct step *step);
void build_parts_step(struct step *step);
int products_of_piece(const struct step *step);             /* and of the bound that shows it clear */
bool is_cleared_by_tables(const struct step *step);         /* a step that clears does by tables, not case by case */
long products_of_unmet(const struct step *step);            /* of one with friction or impacts that clears, at most */

/* ---- pieces.c: what a piecewise-linear model finds its crossings with ---- */

struct region_piece {               /* of a branch, d = h 2^-halvings is its shortest piece; x as in struct layout */
	double *row;                /* of each expression: row . x, expressions x size */
	double *slopes;             /* A of x' = A x, size x size [x/s]; second words behind them */
	double *Phi;                /* e^{A h}, size x size */
	double *gain;               /* e^{A h} - I in two words, 2 size x size: first ones, then second ones; or NULL */
	double **rung;              /* as in pl_ladder, the shortest first */
	double *reach;              /* of each expression, of each rung but the first, and of h */
	double *slope;              /* slope . x is d/3 times the slope of each expression; expressions x size */
	double *second, *fourth;    /* second . |x(0)|, fourth . |x(0)| bound, on 0 .. d, d^2/8 times the second and */
				    /* d^4/384 times the fourth derivative of each; expressions x size */
	/* Where a step clears: over h, each expression is off its chord by at most off . |x(0)| + still.
	 * Where it is swift: rounding and what its Taylor polynomial leaves out make its value and h times its slope
	 * wrong by at most slack . |x(0)|; turn and bend are slope and fourth
	 * over h */
	double *off, *still, *slack, *turn, *bend;
	double *added;              /* of a retuned model: what stays of x adds to each state over h */
	double *third;              /* third . |x(0)| bounds h^3/24 times the third derivative of each */
	double *turns;              /* h A */
};
struct pieces {
	double **rows;              /* of each expression: row . x, expressions x size; in each segment of time */
	double *row;                /* in the first */
	double *breakpoint;         /* those of the first expression, rising; of the second; ... */
	struct region_piece *piece;        /* per branch */
	/* Where a step clears: */
	bool *bounded;              /* per entry of x: never above 1, and where a step is swift part of `still` */
	double large;               /* no number of a step overflows where |x| is smaller, other entries summed */
	double *edge;               /* of a retuned model: see gathered.c */
	/* Where it is swift: */
	double *low, *high;         /* bounds of each expression in each region: regions x expressions */
	int degree;
	double *weight;             /* 1/k!, k = 0 .. degree */
};
#define OPEN_END 0x1p1000           /* of an interval that no breakpoint ends */
struct pieces pieces_of(const struct step *step);
/* Sum of the sizes of a row's factors of loads that are never above 1 */
double size_of_bounded(const struct step *step, const double *row);
/* Of rows over x in one branch's system: d/3 times the slope, and bounds as in struct region_piece; rows x size each */
void bounds_of_rows(const struct step *step, const struct pieces *pieces, int branch, int rows, const double *row,
		    double *slope, double *second, double *fourth);
#define LARGE_ENOUGH (0x1p500)      /* no sum of products of such a number overflows; of floats: */
#define LARGE_FLOAT (0x1p60)
double *whole_step_of(const struct step *step, int branch);  /* e^{A h}, size x size */
/* gains.c: e^{A d} - I over d = h 2^-halvings, from its table: 2 size x size, first words, then second ones; NULL: the
 * state has one word */
double *gain_of(const struct step *step, const struct table *table, int halvings);
/* e^{A d} of load states among themselves, to Phi, size x size; low: the second words, NULL: none */
void growth_of_loads(const struct step *step, mpq_srcptr d, double *Phi, double *low);
/* ladder.c: e^{A d} over h 2^-halvings; the rungs of a branch, as pl_ladder has them; what is off its chord in them, of
 * rows over x: so many for each row as it has rungs; whether any has some, and how many each has room for where an
 * instance has its tables */
void plan_ladder(struct step *step, int branch);
double **rungs_of(const struct step *step, int branch);
double *reach_of_rows(const struct step *step, int branch, const double *A, int rows, const double *row);
bool has_ladder(const struct step *step);
int room_for_rungs(const struct step *step);
int rung_halvings(const struct branch *branch, int rung);   /* of h, to its length */
double *Phi_over(const struct step *step, const struct table *table, int halvings);
void row_over_x(const struct step *step, const struct output *output, int segment, double *row);
/* the same in two words: 2 x size */
void row_in_words(const struct step *step, const struct output *output, int segment, double *row);
/* Of |x|: how far row . x is at most off its chord over h, entry by entry */
void bend_of_row(const struct step *step, const double *A, double h, const double *row, double *bend);

/* ---- gathered.c: what stays of x, in the tables of an instance ---- */

bool is_bounded_load(const struct step *step, int load);    /* it has load states that are never above 1 */
/* sqrt(a^2 + b^2) is at most the larger and so much of the smaller, 2^1/2 - 1 */
#define FOLDED 0.41421356237309515
int *staying_columns(const struct step *step, int *count);  /* of x: 1, and held params */
bool any_stays(const struct step *step);
bool any_still(const struct step *step);                    /* that, or something is never above 1 */
int param_of_column(const struct step *step, int column);   /* of such a one; -1: it is 1 */
int edges_of_regions(const struct switching *s);            /* breakpoints, and two open ends of each expression */
/* Of a step that clears and is not swift: `added` and `still` of each piece, `edge` */
void gather(const struct step *step, struct pieces *pieces);

/* ---- guards.c: events of regions with dry friction ---- */

struct guard {                      /* row . x must not become greater than the limit */
	int row, expression, breakpoint;
	bool upward;
	int leads;                  /* to the region of this number, less that where it stands */
	double limit;
	int impact;                 /* that begins there; -1: none */
};
struct struck {                     /* an impact */
	int expression, breakpoint;
	bool upward;
	int rest;                   /* the interval in which it rests; -1: it is no bounce */
	int jump, still;            /* sets of assignments: its jump; that of a bounce without restitution */
	double *speed;              /* of its guard, as a row over x */
	double *back;               /* over x: so much times how far the expression is beyond, and it is on its guard */
	double restitution, play;   /* play: the sizes of its speed's factors of cos and sin */
};
struct held_state {                 /* x[state] = value . x */
	int state;
	double *value;              /* size; of a state that is kept in two words size more, the second ones */
	enum retuned_kind kind;     /* where it comes from: a row of the regions */
	int of, index;
};
struct gate_key { int expression, region, release, segment; bool upward; };  /* up or down; expression -1: a release */
struct guards {
	bool apart;                 /* rows that are equal may become others: params are tunable */
	int *first;                 /* per region, and one more: its guards, of those of all */
	int guards;
	struct guard *guard;
	int rows, *branch;          /* of each row: whose it is, */
	struct gate_key *gate;          /* and what */
	/* rows x size; of a step that clears `second` has what rounding may hide where it begins, too */
	double *row, *slope, *second, *fourth;
	int reaches, *reach_at;     /* of each row: where it begins in reach, reaches x size, as in pl_ladder */
	double *reach;
	/* per segment of time and expression, per row: the sizes of its factors of cos and sin */
	double *play, *row_play;
	int sets, *set;             /* per set, and one more: the first of its assignments */
	int *hold;                  /* per region: the set that holds its states; -1: none */
	int assignments;
	struct held_state *assignment;
	int impacts;
	struct struck *impact;      /* per segment of time and impact */
};
struct guards guards_of(const struct step *step, const struct pieces *pieces);
/* of one step: MAX_EVENTS and MAX_SPLITS, and room for the bounces before a contact rests */
int max_events(const struct model *model);
int max_splits(const struct model *model);
double *grips_of(const struct step *step); /* what friction carries that outputs read: regions x felts x size */

/* ---- peaks.c: outputs of which the largest size is asked for ---- */

struct peaks {                      /* of each of them, over x */
	double *row, *bend;         /* the output; bend . |x| bounds how far it is off its chord in a step */
};
int peak_outputs(const struct model *model);                 /* how many */
int peak_place(const struct model *model, const struct output *output); /* among them */
bool peaks_by_values(const struct step *step);               /* and not from x at the start of a step */
void check_peaks(const struct step *step);                   /* leaves the statement where one cannot be found */
struct peaks peaks_of(const struct step *step);

/* ---- cost.c: what a step costs ---- */

void count_program(const struct step *step, struct program *program); /* of a step with a leftover, not its loads */
void count_expansion(const struct step *step, struct program *program); /* of one series, and its sum */
/* of a collocated step an iteration of Newton's method; where there is no series, that is what its program costs */
void count_collocation(struct step *step);
void count_normal(const struct step *step, struct program *program); /* of a multistep step in normal modes */
/* what the load states of the columns in use cost; where there are anchors, at each of them */
void count_loads(struct program *program, const struct step *step);
/* ... and to turn them into those of now */
void count_turned_loads(struct program *program, const struct step *step);
/* of a step of regions: its sums, and the load states of all of them */
void count_regions(struct step *step, int multiplications, int additions);
/* a step, and its outputs where they are linear: instructions; without a target operations, those of double twice */
double cost_of_step(const struct step *step, const struct target *target);
void count_peaks(struct step *step);                        /* after its program and layout */
int anchor_numbers(const struct step *step);                /* of the table for steps between anchors */
int row_numbers(const struct step *step);                   /* of the tables of a block of rows */

/* ---- forced.c: what rounding does to a step with loads ---- */

/* its rounding; its forced part, where the bound is the better for it */
void plan_forced(struct step *step);
const char *rounding_text(const struct step *step);

/* ---- rounding.c: how far an output of the emitted program may be off ---- */

struct certificate {                /* of one requirement, in the output's unit */
	bool known;
	const char *why;            /* it is not */
	/* at every sample up to the end: bounds of what rounds, of what modes are missed; of one that is measured the
	 * whole error, and 0 */
	double rounding, dropped;
	double needed;
	/* its C has run beside the exact outputs: the error itself, where each product and each sum is rounded as it is
	 * written; the bounds above hold where a compiler contracts them too */
	bool walked;
	double error;
};
double error_told(const struct certificate *c);             /* as walked, or bounded */
/* `exact`: the same step with the numbers of double */
struct certificate certificate_of(const struct step *step, const struct step *exact, const struct requirement *r);
double needed_error(const struct requirement *r, double largest);       /* of the output */
long samples_until(const struct requirement *r, mpq_srcptr h); /* below 0: too many */
/* what it surely reaches; `exact` in double; 0: it is not known */
double largest_of_output(const struct step *exact, const struct requirement *r);
/* [modes + 1]: what the output loses at most where the first so many of the order are kept. HUGE_VAL: not known.
 * To be called with the target double */
double *losses_of(struct modes *modes, const int *order, bool statics, const struct requirement *r);

struct alternative {                /* one way to step a model with needs */
	bool single, compensated;
	enum step_form form;
	struct model *model;        /* that is stepped: of all modes, or of some */
	/* of one that is measured: what was left open and is tried, else NULL; its scheme; what its step costs, and
	 * `cost` is that over the step, [1/s]; how many neighbouring starts were tried, the largest of error over need
	 * there, and where */
	bool measured;
	const char *scheme, *step, *tolerance, *name;
	double step_cost;
	int neighbours;
	double worst_neighbour;
	const char *worst_name, *neighbour_names;
	int inputs_tried, worst_input; /* how many courses of the inputs; with which the error was largest */
	const char *refused;        /* why there is no such step; NULL: there is */
	double cost;                /* of a step and its outputs, as cost_of_step counts */
	const char *why;            /* its error is not known; NULL: it is */
	double excess;              /* the largest of error over need; at most 1: all needs are met */
	/* so whatever a compiler contracts; else the C refuses one that does, where it has to: `as_written` */
	double bound_excess;
	bool as_written;
	struct certificate *certificate; /* per requirement */
	struct step *made;          /* as it was tried */
};
struct choice {
	int alternatives, taken;
	struct alternative *alternative; /* those that there are come first, the cheapest before others */
};

/* ---- anchors.c: functions of loads every so many steps, tables between ---- */

void check_anchors(struct step *step);                      /* says where they are asked for in vain */
void drop_anchors(struct step *step, const char *why);
void plan_anchors(struct step *step);                       /* after its table */
void fill_anchors(struct step *step);                       /* after its forced part is chosen */
int anchored_term(const struct step *step, int state, int column);   /* its index; -1: it is none */

/* ---- stepform.c: a linear step as direct, delta or kick-drift-kick ---- */

const char *step_form_text(const struct step *step);          /* delta, compensated */
void choose_form(struct step *step);                        /* leaves the statement where the one asked for cannot be */
void check_step_form(struct step *step);                         /* before the step: leaves what its kind has not */
/* The step is built again in another form; where forms are tried in turn, this one is refused. */
_Noreturn void leave_form(struct step *step, const char *why);
void need_one_word(const struct step *step);                /* leaves the statement where two are asked for */
void choose_form_of_regions(struct step *step);             /* the same of a piecewise-linear model */
/* before its program; none where all of the state is compensated */
void find_carries(struct step *step);
struct program *linear_program(const struct step *step);    /* from its table */
/* in the code: loads that change have none */
bool is_constant_column(const struct linear *system, int column); /* of the loads: it is 1 */

/* ---- large.c: a large step by its independent blocks ---- */

void find_groups(struct program *program, const struct step *step);     /* and what they cost */
/* of a block's row; a state is one of the block */
const struct coefficient *group_factor(const struct step *step, const struct group *g, int row, int block,
				       const struct operand *operand, int segment);
/* In some segment of time, of some block: else it leaves no trace. */
bool group_acts(const struct step *step, const struct group *g, int row, const struct operand *operand);

/* ---- drift.c: what the rounding of its constants does to a linear step ---- */

struct drift {                      /* per step, of the mode where it is largest */
	double amplitude;           /* ln|z| - Re p h */
	double phase;               /* |arg z - Im p h| [rad] */
	bool known;                 /* nothing is left over, and the step does not loop over Phi */
};
struct drift drift_of(const struct step *step);
const char *drift_text(const struct drift *drift);          /* over 1e9 steps */

/* ---- modal.c: a step of modes instead of states ---- */

struct modal {                      /* modal states: the real parts of the pairs, their imaginary parts, what is real */
	int states, pairs, reals, loads, inputs;
	double *turn;               /* e^{p h}, as the modal states stand */
	double *to, *from;          /* modal states from states, and back; states x states */
	double *load, *input;       /* what a step adds; states x columns */
	double *output;             /* outputs x states: what of them is linear; NULL: they are the states */
	struct drift drift;
	double condition;           /* what rounding gains that goes through both, 1 at best */
};
struct modal *modal_of(const struct step *step);             /* NULL: a number is not decided */

/* ---- by_modes.c: whether it is taken ---- */

void plan_modal(struct step *step);                          /* where it is asked for, or cheaper and as exact */

/* ---- weights.c: what a force that is a polynomial over a step gives a mode ---- */

struct normal_mode { mpfr_t lambda, delta; };      /* eta'' + 2 delta eta' + lambda eta = F [1/s^2, 1/s] */
struct lagrange {                   /* polynomials of s/h, each 1 at one of the nodes and 0 at all others */
	int nodes;
	mpfr_t *node;
	mpfr_t *factor;             /* nodes x nodes: of polynomial i that of (s/h)^j */
};
struct lagrange lagrange_of(int nodes, const mpq_t *node);
void lagrange_at(const struct lagrange *l, mpq_srcptr sigma, mpfr_t *value); /* each at s = sigma h */
mpq_t *past_nodes(int count);                               /* 0, -1, ...: the last force first */
struct mode_flow {                  /* of one mode over theta h */
	/* eta = e eta0 + s eta0' + ..., eta' = de eta0 + ds eta0' + ... */
	mpfr_t e, s, de, ds;
	mpfr_t *position, *rate;    /* ... + what a force of each polynomial adds to eta, to eta' */
};
struct mode_flow mode_flow_of(const struct normal_mode *mode, mpq_srcptr h, mpq_srcptr theta, const struct lagrange *l);
void mode_flow_free(struct mode_flow *flow);

/* ---- normal.c: normal modes of the operators of a bank, and what is left over in them ---- */

enum { NORMAL_BITS = 192 };         /* of modes and weights, before they are rounded */
struct mode_block {                 /* modes that no entry of M and K couples with others */
	int modes, *coord;          /* as many coordinates as modes */
	int place, rows;            /* in vectors of modes: where they stand; with what makes their number even */
};
struct normal_matrix {              /* a matrix of forces on the modes: times a sum of vectors of modes */
	double *value;              /* [bank][mode i][mode j]; nothing below 2^-160 of the largest */
	int terms;
	/* factor[bank] times function times eta, eta' */
	struct normal_term { int function; bool velocity; double *factor; } *term;
};
struct normal_stage {               /* modes at a time after the step's start, from it and from forces */
	int points;
	double *flow;               /* [bank][e, s, de, ds][place] */
	double *weight;             /* [bank][point][eta, eta'][place] */
	double *wave;               /* [bank][wave][of cos, of sin at the step's start][eta, eta'][place] */
};
struct stability {                  /* of a multistep method, functions of time frozen */
	double span;                /* [s] over which they are looked at */
	double radius;              /* the largest spectral radius of a step; */
	int bank;                   /* where that is: the operator, */
	double time;                /* the time [s] */
	double growth;              /* ln of what all steps of the span together let grow at most; */
	double growth_factor;       /* that itself */
};
struct within {                     /* a step: states inside it, by Taylor series over its parts */
	double angle;               /* by which a mode or a wave turns or decays in a step at most: in as many parts */
	int terms;
	double *stiffness, *damping; /* [bank][place] lambda, 2 delta; no damping: NULL */
	/* Of the force's polynomial, the factors of what forces exceed that at the step's start by,
	 * [power - 1][node - 1]: through past forces and the new one (NULL: of a method of one step); through those
	 * at all nodes */
	double *past, *nodes;
};
struct normal {
	int modes, width;           /* n; length of a vector of modes */
	int banks, blocks;
	struct mode_block *block;
	int *place;                 /* per mode: in a vector */
	double *to, *from;          /* [bank][mode][coordinate] V^T M; [bank][coordinate][mode] V */
	double *turn;               /* [bank but the last][place][place] V^T M V - I, from its modes to the next's */
	double *frequency, *ratio;  /* [bank][mode]: sqrt(lambda), 0 below 0; delta over it */
	int matrices;
	struct normal_matrix *matrix;
	double **force;             /* per function: [bank][place]; NULL: none */
	double *wave;               /* forces of waves: [bank][wave][cos, sin][place] */
	int points;                 /* of the multistep method; 0: each step is by collocation */
	bool twice;                 /* predict, evaluate, correct, evaluate; else the last is left out */
	struct normal_stage step;   /* the predictor: points past forces, the last first */
	double *correct;            /* [bank][eta, eta'][place]: of the force's excess over its extrapolation */
	double *extrapolate;        /* [point] */
	int stages;                 /* of a step by collocation; */
	/* its sweeps, from forces extrapolated from the step before; where there is none, all equal at first */
	int sweeps, first_sweeps;
	double *ahead;              /* [stage][node]: forces extrapolated to this step's nodes from those of the last */
	int kept;                   /* forces that are kept between steps: points, or stages + 1 */
	struct normal_stage *stage;
	mpq_t *node;                /* stages + 1, from 0 to 1 */
	/* Once all functions of time are constant: over [omega eta, eta', 1, waves], by columns: [size][2 width]; the
	 * operator whose modes they are. NULL: they never are */
	double *settled, *omega, *period; /* omega and 1/omega: [place] */
	int settled_bank;
	struct stability stability; /* of a multistep method */
	struct within within;
};
void check_mode_orders(const struct step *step);      /* of what has no modes of second order there is no operator */
struct normal *normal_of(struct step *step);                /* leaves the statement where there is none */
struct normal_work {                /* what its builders share */
	struct step *step;
	const struct model *model;
	struct normal *normal;
	mpq_t *M;                   /* rows are those of the equations of the coordinates */
	struct eigenpairs *pairs;   /* per bank */
	struct normal_mode *mode;          /* per bank and mode */
};

/* ---- normal_left.c: what is left over, in modes ---- */

double round_real(mpfr_srcptr x);
mpq_t *by_coordinates(const struct model *model, const mpq_t *matrix); /* rows as those of the coordinates' equations */
void find_transforms(struct normal_work *w);
void find_turns(struct normal_work *w);
void find_matrices(struct normal_work *w);
void find_forces(struct normal_work *w);

/* ---- waves.c: known loads, to which modes respond exactly ---- */

void check_turns(const struct step *step);
void find_waves(struct normal_work *w);
double *waves_of_stage(const struct normal_work *w, mpq_srcptr theta);     /* of all banks; see struct normal_stage */

/* ---- settled.c: a step once all functions of time are constant ---- */

int settled_size(const struct model *model);                /* 2n + 1, and 2 for each wave */
/* Over [omega eta, eta', 1, cos and sin of each wave] of these modes, one omega each, above 0: of that size. M, C and
 * K: of the first operator, rows by coordinates */
mpfr_t *settled_matrix(const struct model *model, const mpq_t *M, const mpq_t *C, const mpq_t *K,
		       const struct eigenpairs *pairs, mpfr_t *omega);

/* ---- within.c: states inside a step in normal modes ---- */

void find_within(struct normal_work *w);

/* ---- frozen.c: stability of multistep methods in normal modes ---- */

struct stability stability_of(const struct step *step, bool twice);

/* ---- rest.c: what is too small to count ---- */

struct rest {                       /* parts of the state that nothing but themselves moves, and that decay */
	bool in_step;               /* the step looks; else the run does */
	int parts, *part;           /* per state as it is kept: its part; -1: of none that comes to rest */
};
void leave_out_lost(struct step *step);                      /* factors; before the program */
void plan_rest(struct step *step);                           /* step->rest */

/* ---- tuned_zeros.c: factors that are 0 whatever the tunable params are ---- */

/* in its table: what vanishes at these values only is no zero */
void mark_tuned_zeros(struct step *step);
/* size x size: x_i follows x_j in time, in a branch's region (-1: some), for some values of the params */
bool *reached_elsewhere(const struct step *step, int branch);

/* ---- exact.c: exact numbers of the equations that stand in the code as they are, each rounded once ---- */

/* An error at the step where it is beyond the range */
struct coefficient equation_number(const struct model *model, mpq_srcptr q);
double time_in_step(const struct model *model, mpq_srcptr fraction);      /* a part of h [s] */
struct slopes {                     /* y' = A y + B r: r is what is left over, or another force on the channels */
	struct coefficient *A, *B;  /* states x states; states x channels */
};
struct slopes state_slopes(const struct step *step, int operator);

/* ---- bank.c: what the leftovers of a bank's operators have in common ---- */

struct excess {                     /* a linear term in which they differ: a coordinate or its velocity, on a channel */
	int channel, coord, order;
};
struct bank {                       /* the leftover of an operator = common + sum of factor times term */
	int count;                  /* 0: of one operator */
	struct excess *excess;
	double *factor;             /* [operator][excess] */
	const struct form **common; /* per channel */
};
struct bank bank_of(const struct step *step);

/* ---- through.c: a piecewise-linear model through its crossings, enclosed ---- */

struct passed {                     /* a breakpoint, by its expression */
	int expression, breakpoint;
	bool upward;
	bool jumped;                /* by a load that jumps, not by crossing */
	bool faint;                 /* it begins with speed and acceleration 0: what rested is let go */
	bool stands;                /* it rests as impacts have left it with speed 0 where it would bounce */
	mpfi_t at;                  /* when [s] */
	double speed;               /* of the expression there [its unit/s] */
	double size;                /* of what it is summed from there [its unit] */
};
struct through;
/* From t = 0 on in so many bits. NULL: of the whole model, which then has no parts; `initial` has its states. Inputs
 * follow u = 1 - t/h; held, u = 1; those that stand for params have the spec's values. */
struct through *through_start(const struct model *model, const struct region_part *part, const mpq_t *initial,
			      int precision);
bool through_reach(struct through *t, mpq_srcptr time);     /* false: it is not decided what comes before */
const char *through_undecided(const struct through *t);     /* why */
void through_state(const struct through *t, int state, mpfi_ptr value);        /* where it has got to */
void through_value(const struct through *t, const struct output *output, mpfi_ptr value);
int  through_passed(const struct through *t, const struct passed **list);      /* so far, in order */
void through_limit(struct through *t, int most);            /* crossings; what comes behind them is not decided */
void through_free(struct through *t);

/* ---- closed.c: states in closed form for the self-test ---- */

struct reference {                  /* from t = 0 on; inputs follow u = 1 - t/h; held, u = 1 */
	int states, rows;           /* rows: fewer where the states leave the range */
	const unsigned long *steps; /* per row: how many have been taken */
	double *start, *value;      /* [states]; [row][states] */
	double *between;            /* [states] at h/2, where NAME_at is there */
	double *unit;               /* [states]: one in the last place of the largest value */
	/* of a piecewise-linear model the crossings up to the last row: when, and how much of that is rounding */
	int crossings;
	struct { unsigned long step; double after, unit; } *crossing;  /* steps before it, and [s] */
};
struct reference reference_of(const struct step *step);

/* ---- passing.c: the same through crossings ---- */

double ulp_of(double value, bool single);
void reference_start(int state, mpq_ptr value);              /* a start that has nothing special */
struct reference new_reference(const struct step *step);    /* room for its rows */
struct reference reference_through(const struct step *step); /* leaves the statement where nothing is known */

/* ---- tuned_blocks.c: a linear step with tunable params, a large one block by block ---- */

double *nominal_outputs(const struct step *step);   /* those that depend on params: x columns of struct tuning */
struct fixed_slope {                /* an entry of A, x' = A x, that no param changes: velocities, how loads go on */
	int row, column;
	struct coefficient value;
};
int fixed_slopes(const struct step *step, struct fixed_slope **list);
struct tuned_part {                 /* some of the equations of struct tuning, which the target solves by themselves */
	struct tuned_equations all;
	int *row, *unknown;         /* of struct tuning: what row i is, and what is found in its place */
	unsigned params;            /* that it depends on, a bit each */
};
struct tuned_block {                /* an independent block; x: its states, load states and inputs that act on it */
	const struct group *group;
	int index, block;           /* of the group */
	struct tuned_part part;     /* its highest derivatives, then frequencies of its loads */
	int derivatives;            /* of the rows, */
	int *place;                 /* and of which state each is */
	int size, *from;            /* of x, and which of the whole each is */
	int slopes;
	struct fixed_slope *slope;  /* entries of A that no param changes */
	int turns, *turn;           /* pairs of load states whose frequency changes: row of the part, place in x */
};
struct tuned_blocks {
	int blocks, all, touched;   /* those that the code has, of all, of which params touch some */
	struct tuned_block *block;  /* in the order of groups; where NAME_at is not there, those that params touch */
	bool solved;                /* there is one, the whole model, whose equations have what others would */
	/* outputs and frequencies that depend on params, and what accelerations these read */
	struct tuned_part others;
	int first_output;           /* row there of the first output that does; the others follow */
	int *frequency;             /* per load: its row there, or -1 */
	int work, more;             /* numbers of two words: for NAME_retune, beside those rows; for NAME_at */
	bool whole;                 /* params touch every block: any h will do */
	int kilobytes;              /* of stack */
};
int width_of_equations(const struct tuned_equations *all);        /* columns, W's among them */
/* Per state: tunable params touch its independent block. NULL: there are none */
bool *touched_states(const struct step *step);
/* Per state: a number that those whose equations hang together share. NULL: there are no tunable params */
int *tuned_components(const struct step *step);
/* step->blocks; leaves the statement where a block is too large */
void plan_tuned_blocks(struct step *step);

/* ---- written.c: the equations as written, for NAME_rhs ---- */

const struct form *without_highest(const struct model *model, const struct form *form);
/* -W^-1, n x n: the highest derivatives are it times the residuals */
struct coefficient *derivatives_of_residuals(const struct model *model);

/* ---- rows.c: outputs after several steps, from what stands at the start of a block of them ---- */

struct row_column {                 /* of a block: what this gives every number of it */
	struct operand operand;     /* a state, a load state; an input: the sample before the block */
	double *value;              /* [row][output] */
};
struct rows {
	int count, outputs;         /* rows in a block; numbers in a row */
	int columns;                /* those that give something */
	struct row_column *column;
	int group;                  /* rows summed side by side: samples after all of them are left out */
	/* per input, what a sample gives the outputs at the end of its step, after one more, ...: [row][output] */
	double **sample;
	/* The step of `count` h. Columns of inputs: those of ramps before the block, then each of its samples */
	struct step *block;
};
int  held_columns(const struct linear *system);              /* ramps: the samples before the block */
void plan_rows(struct step *step);                           /* step->rows; last, since it is a step of its own */

/* ---- hold.c: what inputs do between samples ---- */

void tap_weight(int hold, int power, int tap, mpq_ptr weight);     /* of (s/h)^power in that of a tap */
void tap_derivative(int hold, int power, int tap, mpq_srcptr h, mpq_ptr derivative); /* at the step's start */
/* what |d^power u / d s^power| h^power at the step's start is at most where no sample is above 1 */
double tap_reach(int hold, int power);
void tap_slope(int hold, int tap, mpq_ptr slope);            /* h u' at the step's end, per tap */
bool further_samples(const struct linear *system);           /* an input goes through more than two */
int samples_ahead(int hold);                                 /* that an input has had when the first step comes */
void check_holds(const struct step *step);                   /* leaves the statement where one cannot be */

/* ---- sequences of Taylor coefficients, each made from those before it ---- */

/* Of a quantity a(t) the k-th number is D^k a^(k)/k!, D = h. What stands in a sum at k is factor[k] times: the constant
 * 1, a power of t, an entry of a load's states, an input's value at the start or its slope, the k-th number of another
 * sequence, or sum over j = 0..k of a_j b_{k-j} (Moore; Griewank and Walther 2008, chapter 13). */
enum term_kind { TERM_TIME, TERM_LOAD, TERM_INPUT, TERM_SLOPE, TERM_PARAM, TERM_SEQUENCE, TERM_PRODUCT };
struct sequence_term {
	enum term_kind kind;
	int a, b;                   /* which; the power of t; the load's column; the two sequences */
	double *factor;             /* per k */
	/* of a load that changes its formula: its place in the table of factors; -1: factor[] holds in all segments */
	int slot;
};
enum sequence_kind {
	SEQUENCE_SUM,               /* c_k = sum at k */
	SEQUENCE_INTEGRAL,          /* c_0 = function of a_0, or a state; c_{k+1} = sum at k, 1/(k+1) in its factors */
	SEQUENCE_QUOTIENT,          /* c = a/b; a NONE: 1/b */
	SEQUENCE_ROOT,              /* c^2 = a */
	SEQUENCE_POWER,             /* c = a^exponent, which is constant */
	SEQUENCE_RATE,              /* c_k = (k+1) a_{k+1} */
	SEQUENCE_CHOICE             /* a where the condition holds, else b */
};
/* By which a choice is made: two forms linear in t that are compared, an expression of the state above a breakpoint,
 * or another sequence that is not 0 and changes with such choices alone */
/* or whether an expression is held between two breakpoints, this and its twin */
enum choice_kind { CHOICE_BY_TIME, CHOICE_BY_STATE, CHOICE_BY_HOLD, CHOICE_BY_SEQUENCE };
struct sequence {
	enum sequence_kind kind;
	int state;                  /* of an integral that is one; NONE */
	enum function function;     /* of another: its value from a (and b) */
	int a, b;
	double exponent;
	enum choice_kind choice;
	const struct form *left, *right; /* what the condition compares, linear in t */
	enum comparison comparison;
	int expression, breakpoint; /* or which it is above; of the expression's, in order of their first appearance */
	int test;                   /* or the sequence */
	int terms;
	struct sequence_term *term;
	int degree;                 /* all beyond are 0; order + 1: none need be */
	int top;                    /* the last that something reads; -1: none */
	bool late;                  /* the k-th stands where others have their (k+1)-th */
	bool known;                 /* it depends on time and inputs alone */
	/* The k-th, of an integral the (k+1)-th, is for k >= 1 an early part + sum over these of factors times their
	 * k-th */
	int gains;                  /* 0: not made so */
	int *gain;
	bool split;                 /* others read its early part and gains */
};
struct divided {                    /* an expression of the state that breakpoints divide, smooth between events */
	const struct form *form;    /* without constant; sign and scale as first written */
	int sequence, column;       /* its coefficients: the place behind those of the states, or of one that it is */
	int breaks;
	mpq_t *at;                  /* in order of their first appearance */
	int *rank;                  /* of each of them, how many are below it; the twin of one is above it */
};

/* ---- unseen.c: what coefficients at one time may not show ---- */

enum unseen_kind {                  /* what of the argument a series has to follow: */
	UNSEEN_RISE,                /* exp: how far it rises, */
	UNSEEN_SPREAD,              /* sinh, cosh: how far it goes off 0, */
	UNSEEN_TURN,                /* tanh: how near it comes to 0, */
	UNSEEN_TEETH,               /* high powers of sin and cos: how far it goes, */
	UNSEEN_ARC,                 /* atan: likewise, */
	UNSEEN_DIVISOR              /* log, and what is divided by: by which factor it falls */
};
struct unseen {
	const struct form *form;
	enum unseen_kind kind;
	int power;                  /* of TEETH */
	int column;                 /* as of an expression */
};
/* *looks: there is what no argument bounds, or what is steep: the slope inside and at the end is looked at too */
struct unseen *unseen_of(const struct model *model, int *count, bool *looks);
double crowded_frequency(const struct linear *system);      /* 1/s: the highest of loads that may cancel; 0: of few */

/* Impacts and what is held beside a series. Beside dividing expressions the search watches other sequences. */
struct watch {
	int sequence, column;
	bool whole;                 /* all coefficients are read, else the first two */
};
struct series_hold {                /* a velocity that is kept at 0: by friction that sticks, by a contact at rest */
	int expression, breakpoint; /* held between this and its twin */
	bool above;                 /* the velocity of friction, or the guard, rises with the expression */
	int impact;                 /* whose contact rests; NONE: it is friction */
	int velocity, pull[2];      /* watches; beyond 0 it is let go to the interval below, above; NONE: it is not */
	double *back;               /* per state: what is taken from it for a velocity of 1 */
	int force, only;            /* a sequence; the only state of the velocity, or NONE */
	mpq_t *push;                /* per state: what that force, 1, adds to its slope */
};
struct series_strike {                     /* an impact */
	int expression, breakpoint;
	bool upward;
	int hold;                   /* in which its contact rests; NONE: it is no bounce */
	int place, speed;           /* watches: how far its guard is beyond 0; its rate */
	int jump, still, jumps;     /* assignments, so many from each on */
	double *back;               /* per state: what is taken from it for a guard of 1 */
	double restitution;
	double per;                 /* the expression's for a guard of 1 */
};
struct conflict {                   /* holds that cannot be all at once */
	unsigned long set;          /* as bits */
	int hold, side;             /* friction of what a contact holds: 1 or -1, where it slips then; NONE: others */
};
struct series_jump { int state, watch; }; /* a state takes the value of what is watched */
struct contacts {
	int none, *bare;            /* sequences: 0; per state its slope without what holds, NONE: not made */
	int holds;
	struct series_hold *hold;
	int strikes;
	struct series_strike *strike;
	int assignments;
	struct series_jump *assignment;
	int conflicts;
	struct conflict *conflict;
	int watches;
	struct watch *watch;
};
struct expansion {
	int order;                  /* of the series in its unit of time, h or several of them */
	int count;                  /* sequences; the first are the states */
	struct sequence *sequence;
	int slots;                  /* factors that change from segment to segment: */
	double *changing;           /* [segment][k][slot] */
	int *slot_load;             /* per slot: column of the loads */
	bool *load;                 /* per load: read */
	bool *input, *slope;        /* per input: read */
	bool time, params;          /* t is read; tunable params are */
	int expressions;            /* what chooses formulas by the state: an event where one passes a breakpoint */
	struct divided *expression;
	int columns, *column;       /* beside the states: sequences whose coefficients are kept for them, */
	int *column_top;            /* up to these */
	int measured;               /* the first of them: their last terms count as those of states do */
	int unseens;                /* what bounds how far a series serves beside its last terms */
	struct unseen *unseen;
	bool looks;                 /* at slopes further on */
	double crowded;             /* 1/s, of loads that may cancel the highest frequency */
	struct contacts *contacts;  /* NULL: there are none */
	/* per channel: what is left over, as a sequence; NULL: it stands in the states' sums */
	int *force;
	bool alone;                 /* the states' own coefficients are not wanted */
	int multiplications;        /* of one expansion, that of its end and of the loads with it */
};
/* ---- recurrences.c: the coefficients as nodes of a tape ---- */

/* Operands: TAPE_STATE, TAPE_LOAD, TAPE_INPUT, TAPE_PARAM, TAPE_TIME, TAPE_TABLE of slot `index` at the k
 * `part`; what the state chooses TAPE_ABOVE and TAPE_HELD, where nodes have no names by their numbers. */
struct series_names {               /* of a sequence's nodes, x of x_3; NULL: they have none */
	const char *(*name)(const void *context, int sequence);
	const void *context;
};
struct recurrences;
struct recurrences *recurrences_new(const struct step *step, const struct expansion *x, struct series_names names);
struct tape *tape_of_recurrences(const struct recurrences *r);
tape_ref recurrence(struct recurrences *r, int sequence, int k);     /* TAPE_NONE: 0 */
tape_ref recurrence_size(struct recurrences *r, int sequence);       /* of its first: the sum of its terms' sizes */
tape_ref recurrence_whole_size(struct recurrences *r, int sequence); /* ... of the terms that those are summed from */

/* ---- sums.c: what is added up exactly, and its factors as numbers ---- */

struct key {                        /* of a sum, before its factors are numbers; kind, a and b as in sequence_term */
	enum term_kind kind;
	int a, b;
	mpq_t factor;
};
struct sum {
	int keys;
	struct key *key;
};
struct sequencing {                 /* what the makers of sequences share */
	const struct step *step;
	const struct linear *system;
	struct expansion *x;
	struct layout layout;       /* states, loads, inputs, channels */
	mpq_t **slopes;             /* per segment: x' = slopes x */
	mpq_t pi;
	mpq_t unit;                 /* of time: D, h or several of them */
	int *uses;                  /* per atom */
	int *atom;                  /* per atom: its sequence; NONE: not made yet */
	int operands;               /* forms that are no single atom, each made once */
	struct { const struct form *form; int sequence; } *operand;
};
void sum_add(struct sum *sum, enum term_kind kind, int a, int b, mpq_srcptr factor);
/* Its terms into s, at k times scale[k] */
void sum_numbers(struct sequencing *w, struct sequence *s, const struct sum *sum, const mpq_t *scale);
mpq_t *plain_scale(const struct sequencing *w);             /* 1 */
mpq_t *integral_scale(const struct sequencing *w, bool times_unit);  /* 1/(k+1), or D/(k+1) */
/* of a state, whose force changes from segment to segment: in a table */
void add_changing_loads(struct sequencing *w, struct sequence *s, int state, const mpq_t *scale);

/* ---- sequences.c: forms to sums, atoms to recurrences ---- */

int  new_sequence(struct sequencing *w, struct sequence sequence);
int  sum_sequence(struct sequencing *w, const struct sum *sum);
int  sequence_of_sum(struct sequencing *w, const struct sum *sum);  /* of a single one itself */
int  sequence_of_form(struct sequencing *w, const struct form *form);
int  minus_sequence(struct sequencing *w, int a);
int  positive_sequence(struct sequencing *w, const struct form *form, int a);  /* or else 0: the state chooses */
/* sum += scale form; leaves the statement at what has no series */
void sum_add_form(struct sequencing *w, struct sum *sum, const struct form *form, mpq_srcptr scale);

/* ---- divided.c: formulas that the state chooses ---- */

struct division {                   /* the sign of a difference */
	int expression, breakpoint; /* it changes where that passes this; NONE: it is constant, */
	bool above;                 /* and this its sign; else: is it positive above the breakpoint? */
};
/* Of a - b. The sequence of an expression that is new is to be made. */
struct division divide_forms(struct sequencing *w, const struct form *a, const struct form *b);
/* The same of what is known by then; false: it is not */
bool find_division(const struct expansion *x, const struct form *a, const struct form *b, struct division *division);
/* Of the state, by 0: factor times its expression less the breakpoint; with its sequence */
struct division divide_form(struct sequencing *w, const struct form *form, mpq_ptr factor);
void add_twin(struct divided *d, int breakpoint);            /* a second breakpoint there */
int  column_of_sequence(struct expansion *x, int sequence, int top);  /* kept up to this coefficient */
void rank_breakpoints(struct expansion *x);                  /* once all are there */
int  breakpoint_rank(const struct expansion *x, int expression, int breakpoint);  /* how many are below it */
/* of two alike that of the upper: what is held between them counts as below */
int  upper_rank(const struct expansion *x, int expression, int breakpoint);
mpq_t *rising_breakpoints(const struct divided *d);
const char *divided_text(const struct step *step, int expression); /* over the written coordinates */
/* The number of a region is its expressions' intervals in mixed radix; 0: too many for an int */
int  regions_of_series(const struct expansion *x);
/* Leaves the statement where what is chosen by the state is not treated */
void check_divided(const struct step *step);

/* ---- contacts.c: impacts and friction beside a series ---- */

void hold_contacts(struct sequencing *w);                    /* before the states have their slopes */
bool is_bare(const struct sequencing *w, int state);         /* its slope without what holds is a sequence of its own */
/* y' with what holds; where its velocity alone is held that is 0, exactly */
struct sum held_slope(struct sequencing *w, int state);

/* ---- cut.c: a scheme with a leftover, from crossing to crossing ---- */

struct cut {
	struct expansion *look;     /* of the solution, as far as where it is heading */
	struct expansion *ends;     /* of it the expressions' values and slopes, */
	struct expansion *forces;   /* and what is left over, with the formulas of given intervals */
	struct layout layout;       /* of x, each force with its derivatives: see pl_cut */
	double **slopes;            /* per segment of time: A of x' = A x, size x size [1/s] */
	int multiplications, additions, calls; /* of the looks in a step */
	double fastest;             /* above the poles of the sizes |A| [1/s] */
	double certain;             /* so much of a step that no pole turns by more than 1; 1: cubics hold over it */
	int kilobytes;              /* of stack for tables */
};
void plan_cut(struct step *step);                           /* step->cut */

/* ---- newest.c: how the newest coefficients enter the next ones ---- */

void find_newest(struct expansion *x);

/* ---- expansion.c: the solution as a Taylor series ---- */

struct expansion *expansion_of(const struct step *step, int order);
/* the same with what is left over as sequences of their own; and some of its sequences alone, up to a lower order */
struct expansion *expansion_with_forces(const struct step *step, int order);
struct expansion *part_of_expansion(const struct step *step, const struct expansion *whole, int order, int columns,
				    int *column);
struct sum slope_of_state(struct sequencing *w, int state);  /* without friction and contacts */

/* ---- order.c: the order of a series ---- */

/* The one that was asked for, or that of the tolerance, or a lower one that is cheaper. Leaves step->expansion. */
int economical_order(struct step *step);
/* In h, of its scheme where all is smooth */
int order_of_step(const struct step *step);

/* ---- radius.c: how far a series reaches from the start ---- */

enum { EXPANSION_SERVES = 32 };     /* most steps that one expansion serves */
struct reach {                      /* estimates, at t = 0 from the initial values, inputs 0 */
	bool known;                 /* every coefficient is finite */
	double radius;              /* of convergence [s]; infinite: no singularity is seen */
	double served;              /* by tolerance: steps that one series serves, below 1 the part of one; else 0 */
};
struct reach reach_of_series(const struct step *step);

/* ---- collocation.c: Radau IIA ---- */

struct stage_mode {                 /* of A: A v = z v, u A = z u, u v = 1 */
	bool pair;                  /* it stands for itself and its conjugate; else it is real */
	double re, im;              /* z */
	double *left, *right;       /* [stage][re, im]: u; v, of a pair twice that */
};
struct collocation {
	int stages;
	double *node;               /* c, rising, parts of the step; the last is 1 */
	double *once, *twice;       /* A and A^2, [stage][stage] */
	double *monomial;           /* [power][stage]: polynomials that are 1 at one node, 0 at the others */
	int modes;                  /* of A */
	struct stage_mode *mode;    /* the real one first */
};
mpq_t *lobatto_nodes(int stages);                           /* stages + 1 of them, 0 and 1 among them; to 256 bits */
struct collocation *collocation_of(const struct step *step);

/* ---- motion.c: the highest derivatives of the coordinates ---- */

struct motion_entry {               /* of the Jacobian, where it is not 0 */
	int coord, of;              /* row; the coordinate by which, or by whose velocity, it is derived */
	bool twice;                 /* by the coordinate, and that is of second order */
	const struct form *slope;
};
struct motion {
	int coords;
	/* so many that stages are solved by their modes, and the Jacobian is that of the step's start */
	bool apart;
	/* per coordinate: without what depends on time alone in the linear part, which there is where it is driven;
	 * beside contacts there are no forms, of slopes neither: set_motion says them */
	const struct form **force;
	bool *driven;
	int columns;                /* of the loads */
	double *load, *input;       /* [segment][coordinate][column]; [coordinate][input][value, slope] */
	int entries;
	struct motion_entry *entry;
};
struct motion *motion_of(const struct step *step);
/* left[] of the coordinates, slope[] of the entries: beside contacts, from what the series of their events has */
struct recurrences *motion_recurrences(const struct step *step);
void set_motion(const struct step *step, struct recurrences *r, bool slopes);

/* ---- batch.c: many instances in one call ---- */

void find_lanes(struct step *step);                         /* whether they step as lanes */

/* ---- scheme.c: the step of a model ---- */

struct step *step_build(const struct model *model);         /* NULL: it was said why */

#endif
