/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The equations of motion, exact: M, C, K, loads, operators, regions, outputs. */
#ifndef PLGEN_MODEL_H
#define PLGEN_MODEL_H

#include "collect/collect.h"
#include "math/math.h"
#include "tape/tape.h"

/* ---- linear.c: linear systems of coordinates ---- */

struct load {                       /* force on the equations: t^k times one wave */
	const struct wave *wave;
	int powers;                 /* k = 0 .. powers-1 */
	int columns;                /* t^k, or t^k cos and t^k sin: the load states z */
	mpq_t **force;              /* per column: [segment][equation] */
};
struct input {                      /* a sampled input u */
	const char *name;
	int hold;                   /* degree of the polynomial through samples around; 0: held, 1: a ramp */
	mpq_t *force[2];            /* of u and of u': one rational per equation */
};
struct linear {                     /* M q'' + C q' + K q = force - heldC q'(t_n) - heldK q(t_n) */
	int n, states;              /* states: the coordinates, then the velocities of those of second order */
	int *velocity;              /* per coordinate: the state that is its velocity; -1: of first order */
	int *coord;                 /* per state: its coordinate */
	mpq_t *M, *C, *K;           /* n x n, row-major; a coordinate of first order has no column in M */
	mpq_t *heldC, *heldK;       /* n x n, or NULL where nothing is held */
	int segments;               /* of time, in which the loads have one formula each */
	mpq_t *change;              /* segments - 1 times, rising */
	int loads;
	struct load *load;
	int inputs;
	struct input *input;
	int channels;               /* of what is left over: one for each equation that has some */
	mpq_t **channel;            /* its force on the equations */
};
struct linear linear_like(const struct linear *shape);      /* the same coordinates and states, matrices 0, no loads */
struct linear first_order_system(int n, const mpq_t *A);    /* x' = A x */
/* W^-1, n x n; W has the columns of M, and those of C where a coordinate is of first order. False: singular. */
bool leading_inverse(const struct linear *system, mpq_t *inverse, int *column);
mpq_t *inverse_of_leading(const struct linear *system);     /* where it is known to be regular */
int highest_state(const struct linear *system, int coord);  /* whose derivative is the highest of the coordinate */
mpq_t *slopes_by_force(const struct linear *system, const mpq_t *inverse, const mpq_t *force); /* W^-1 force in y' */
/* The loads, inputs and channels of another system, each force as `map` makes `rows` numbers of it */
typedef void force_map(const void *context, const mpq_t *force, mpq_t *mapped);
void take_forces(struct linear *system, const struct linear *other, int rows, force_map *map, const void *context);
/* Highest derivatives of the coordinates, -W^-1 (C v + K q), n x states; `held`: of the held terms alone */
void highest_derivatives(const struct linear *system, const mpq_t *inverse, bool held, mpq_t *row);
mpq_t *state_matrix(const struct linear *system, bool held); /* A of y' = A y, states x states */
/* [a - A, w; -w, a - A]^-1, of 2m x 2m; w NULL: (a - A)^-1, m x m. NULL: a + i w is a pole */
mpq_t *shifted_inverse(int m, const mpq_t *A, mpq_srcptr a, mpq_srcptr w);
/* What of x' = A x + B z goes with the states z of a load, x = P z; P, columns x m, is B before */
void solve_forced(int m, const mpq_t *shifted, const struct load *load, mpq_t *P);
int load_columns(const struct linear *system);
int column_of_load(const struct linear *system, int load);  /* its first */
int input_columns(const struct linear *system);
bool is_constant_column(const struct linear *system, int column); /* of the loads: it is 1 */
bool load_acts(const struct linear *system, const struct load *load);
bool any_load_acts(const struct linear *system);
bool is_driven(const struct linear *system);                 /* by a load or an input */

/* ---- model.c: the equations of motion, exact ---- */

struct output {
	const char *name;
	struct node *value;         /* as written */
	bool peak, bears;           /* the largest size so far is asked for; reads what friction without mass bears */
	int statement, cell;        /* which output statement, and which cell of its value */
	struct form *form;          /* in the first segment of time; NULL where it is not linear in states and loads */
	struct form *left;          /* then: for all time, with atoms; highest derivatives stand for themselves */
	mpq_t *state;               /* factors of y, one per state, accelerations replaced */
	mpq_t **load;               /* per load: factors of its columns, [column][segment] */
	mpq_t *input[2];            /* per input: factors of u and u' */
	mpq_t *channel;             /* factors of what is left over, where an acceleration is read */
};
struct operator {                   /* A of y' = A y + loads + inputs + r(t, y); its M is that of the equations */
	mpq_t *C, *K;
	struct form **left;         /* per channel: the leftover, a force on its equation */
	mpq_t at;                   /* of a bank: the value up to which it serves */
	const char *text;           /* x = 2, x' = 0 */
};
struct time_function {              /* what stands with it in the leftover of the first operator */
	const struct form *form;    /* of time alone */
	/* n x n: force on the equation of coordinate i of coordinate j, of its velocity; NULL: none */
	mpq_t *position, *velocity;
	mpq_t *force;               /* on the equation of each coordinate; NULL: none */
	mpq_t last;                 /* its value in the last segment of time, where it is constant there */
};
struct rest_force {                 /* on the equation of a coordinate: a function of time times one of the states */
	int coord, function;
	struct form *form;
};
struct wave_force {                 /* of a wave alone, of its cos and its sin: on the equation of each coordinate */
	struct wave *wave;
	mpq_t *force[2];
};
struct splitting {                  /* the leftover, sorted: see split.c */
	int functions;
	struct time_function *function; /* the first is 1 */
	int rests;                  /* forces that are neither */
	struct rest_force *rest;
	int waves;                  /* known loads to which modes respond exactly; none where loads are left over */
	struct wave_force *wave;
	const struct node *mixed;   /* time and states in one function: none of this; NULL: there is none such */
	bool settles;               /* there is a last segment of time, in which all functions are constant */
	const struct atom *unknown; /* changes its formula in time, it is not known when; NULL: none does */
	int selector;               /* function that a bank is chosen by; -1: there is no bank, or it is by states */
};
struct smoothness {                 /* of what is left over, else of the equations; where nothing is found all is 0 */
	int tenths;                 /* of the order that no scheme exceeds here: 10 at a jump, 20 at a kink */
	enum { SMOOTH_ALL, SMOOTH_KINK, SMOOTH_JUMP } kind;
	const struct node *node;    /* what jumps or has the kink */
	const char *where;          /* x passes 0.5 */
	bool piecewise;             /* exact could treat it alone */
	bool timed;                 /* it lies at a time */
	/* a formula that ends there, as abs(x)^1.5, whose derivatives are not finite, and where; NULL: none does */
	const struct node *singular;
	const char *singular_where;
};
struct building;
struct request {                    /* what the user asks for on the command line; of most, a spec may say it too */
	const char *step, *scheme, *prefix, *tolerance;
	const char *modes;
	/* which tunable params regions have as numbers, not as inputs; stands on what builds a model. NULL: none */
	const bool *(*find_factors)(struct building *b);
	bool reduce;
	bool loads_left;            /* known loads are left to the scheme */
	bool compensated;           /* two-word arithmetic */
	bool single;                /* the target's numbers are floats */
	bool step_open;             /* nothing says how long a step is: one is chosen */
	bool real_given;            /* that was said: --real */
	bool selftest;              /* NAME_selftest */
	int rows;                   /* in a block of NAME_run; 0: as many as serve best, 1: no blocks */
	bool batch;                 /* NAME_batch */
	enum step_form form;
	int anchors;                /* steps from one evaluation of a load's functions to the next; 0: as it is best */
	bool solution;              /* the closed form is wanted, whatever the scheme */
	const char *passed_over;    /* why the scheme that would be best has no step; NULL: it was not tried yet */
	int definitions;
	const char **definition;    /* NAME=EXPR */
	/* Where it is asked for, command line or spec: found when the model is built */
	struct place scheme_at;     /* source NULL: it is not */
	struct node *scheme_order, *scheme_over; /* of a series; NULL: not given */
	struct place step_at, form_at, compensated_at;
	struct place end_at;        /* the end of --solution, else as step_at */
	/* What builders ask for to build a model a second time; then nothing is told again */
	/* values of the tunable params in place of the spec's, to see what the equations become: */
	const mpq_t *tunable;
	                            /* no step, no initial values */
	/* with them: those of the tunable params that regions have as numbers, the others as inputs; else NULL */
	const bool *factor;
	const struct relative *relative; /* the coordinates to build the model over; NULL: the written ones */
	bool undivided;             /* regions are those of all coordinates together */
	bool trial;                 /* its step and its outputs alone: no NAME_at, no blocks of rows */
};
struct truncation {                 /* of a Taylor series */
	int order;                  /* of its last term in h; of collocation in h */
	int stages;                 /* of a collocation; 0: there is none */
	bool adaptive;              /* steps as long as the tolerance lets them be; else each is h, */
	int over;                   /* and one expansion is over so many of them */
	mpq_t tolerance;            /* of the last terms, relative to the largest of each state; 0: not looked at */
	/* per state: what a step may add to it beside the tolerance of its size now; 0: its largest size counts. NULL:
	 * so of all */
	mpq_t *absolute;
	int substeps;               /* most within one h */
};
struct state_range {                /* in which the spec says that a state stays */
	struct place at;
	int state;
	mpq_t low, high;
};
struct requirement {                /* a need, evaluated */
	const struct need *need;
	int output;
	mpq_t bound, until;         /* in the output's unit, or as a part of its largest value; [s] */
	mpq_t *most;                /* per input: of its size */
};
struct wanted_modes {               /* of the statement `modes`, or of --modes */
	struct place at;            /* source NULL: all */
	int count, *number;
	bool each;                  /* those numbers; else number[0] is how many, the best */
	bool statics;               /* what is dropped follows loads and inputs at once */
};
struct reduction {                  /* what --reduce found */
	int *place;                 /* of a reduced model, per written state: the state that is it, or -1 */
	bool irreducible;           /* it was asked for, and every state is seen */
	int dropped;                /* written states that are no combination of the reduced ones */
	const char **dropped_name;
	mpq_t *row;                 /* of a reduced model, states x written states: each state over the written ones */
};
struct nonlinear {                  /* a term of the equations, or what jumps */
	struct place at;
	const char *text;           /* as written */
};
struct delay {                      /* of an input */
	const struct symbol *symbol; /* what it is then: an input of the model */
	int back;                   /* in parts of the step */
};
struct delays {                     /* NULL in a model without */
	const char *name;           /* the model's own; that of what has all inputs is NAME_core */
	mpq_t h;                    /* the step; the model's is a part of it */
	int parts;
	int inputs;                 /* that the text declares: they come first */
	int count, most;            /* most: of `back` */
	struct delay *delay;        /* by index of the input */
};
struct model {
	struct spec *spec;
	struct request asked;
	const char *name;           /* prefix of everything generated */
	int n;                      /* coordinates */
	const char **coord_name;
	const char **state_name;    /* x1, x2, x1', x2' */
	struct frame frame;         /* the coordinates, and how the written ones follow from them */
	struct linear system;       /* as written */
	struct residual *residual;  /* per row of the system, in the first segment of time */
	struct snapshot *snapshot;  /* per segment */
	struct snapshot *whole;     /* for all time, conditions and products of time kept; NULL: nothing is left over */
	struct irrationals irrationals;
	mpq_t *initial;             /* one per state */
	mpq_t h;
	enum scheme scheme;
	struct truncation truncation; /* of a scheme that expands; else all 0 */
	bool loads_left;            /* known loads are left to the scheme */
	int stages;                 /* of collocation: nodes after the step's start; 0: another scheme */
	int operators;              /* 0: exact, or nothing is left over */
	struct operator *operator;
	int *owner;                 /* per coordinate: the row of its equation */
	int channels;               /* of what is left over, of each operator: one for each equation that has some */
	int *channel_row;           /* its equation */
	struct form **left_slope;   /* of a scheme that collocates: [channel][state], the leftover's derivative */
	const struct atoms *atoms;
	int bearings;
	struct bearing *bearing;    /* friction without mass, by what it bears */
	struct switching *switching; /* exact: the regions of a piecewise-linear model; NULL: it has one */
	int impacts;                /* in the order in which they act at one instant */
	struct impact *impact;
	int drags;                  /* friction that a Taylor series goes beside */
	struct drag *drag;
	struct smoothness smooth;
	const struct node *obstacle; /* the first term that stood in the way of exact, where no scheme was asked for; */
	const char *obstacle_text;  /* why it did, and the way out if there is one */
	int nonlinears;             /* terms that no M, C and K have, by place */
	struct nonlinear *nonlinear;
	struct splitting *split;    /* of a scheme in normal modes; else NULL */
	const struct form *selector; /* of a bank: what is compared with `at`; NULL: one operator */
	const struct tuning *tuning; /* tunable params, and how the equations follow from them; NULL: there are none */
	/* the instance has tunable params: what is left over and outputs read them, or they act like held inputs */
	bool keeps_params;
	struct leads leads;         /* what the instance has behind them */
	const struct tuning *held;  /* those that the instance has in such a way: no more than a list */
	const struct form **derived; /* spec->derived: over the params that are given */
	const bool *factor;         /* per param: regions have it as a number, in their matrices; NULL: none */
	const struct tuning *retuned; /* held, and how these follow from it; NULL: no param is such */
	int outputs;
	struct output *output;
	bool declared_outputs;
	/* per coordinate: its highest derivative as a row, where an output that is not linear reads it */
	struct output **highest;
	int requirements;           /* needs; the target of a budget, its instructions a step; 0: there is none */
	struct requirement *requirement;
	const struct target *target;
	double budget;
	const struct delays *delays;
	const struct model *written; /* itself; of a reduced model: the one that it was made of */
	struct reduction reduction;
	struct wanted_modes modes;
	int ranges;                 /* of the written model's states */
	struct state_range *range;
	/* the model is over other coordinates than the written ones; NULL: over those */
	const struct relative *relative;
	const struct shortening *shortened; /* it is of some modes of another; NULL: it is not */
};

/* ---- relative.c: coordinates in which what may move as a whole is parted from what moves in it ---- */

struct link {                       /* of a written coordinate x: what is kept in its place */
	/* x itself; its distance from another; the centre of its group */
	enum { LINK_NONE, LINK_PARENT, LINK_CENTRE } kind;
	int from;                   /* LINK_PARENT: the other, x_p */
	mpq_t ratio;                /* x - ratio x_p is kept, */
	bool turned;                /* or ratio x_p - x */
	/* LINK_CENTRE, per coordinate: X = sum of weight x; x = X + sum of shift times what is kept */
	mpq_t *weight, *shift;
	/* LINK_PARENT, x of second order, x_p of first: x_p' over written coordinates, so that x' - ratio x_p' is
	 * kept, */
	struct form *rate;
	/* or else the kept coordinate that is x', of first order; -1: that of what is kept */
	int velocity;
};
struct relative {
	const struct model *written;
	/* coordinates kept: in the place of each written one, then velocities that stand alone */
	int n;
	const char **name;
	int *order;
	struct link *link;          /* per written coordinate */
	int links, *sequence;       /* those of LINK_PARENT, each after the one that it is measured from */
	struct form **form[3];      /* per derivative and written coordinate: over what is kept */
	struct form **extra;        /* equations r' = v - ... of velocities that stand alone, after all others */
	/* per written coordinate: what its equation is divided by, so that equations are combined as coordinates
	 * are; */
	mpq_t *solved;
	                            /* NULL: equations stay as written */
};
struct relative *relative_new(const struct model *model);    /* without a link */
void complete_relative(struct relative *r);                  /* once it is linked: names, orders and forms */
struct relative *relative_of(const struct model *model);     /* NULL: nothing moves as a whole that has parts */
/* What is kept at a coordinate, from the written coordinates, or their velocities, that it takes */
void relative_value(const struct relative *r, int coord, mpq_t *const *value, mpq_ptr kept);
/* that of what is kept there */
struct form *combined_equation(const struct relative *r, int coord, struct form *const *equation);
void relative_values(const struct model *model, mpq_t *written, mpq_t *kept); /* of all states */
/* Of each written state its factors over those kept, then what is added */
mpq_t *relative_rows(const struct model *model);
int  relative_place(const struct model *model, int written); /* the kept state that is a written one; -1: none is */

struct expression {                 /* what is compared with breakpoints: linear in states, loads and inputs */
	struct form *form;          /* without constant; sign and scale as first written */
	/* in each segment of time it is in + shift: its loads may have other formulas */
	int segments;
	struct form **in;
	mpq_t *shift;
	int terms;
	struct comparing *term;     /* that compare it: expressions.c */
	struct output *row;         /* the same as a row */
	int breaks;
	mpq_t *at;                  /* rising */
	const struct node *node;    /* where it comes from */
	int stride;                 /* of its interval in the index of a region */
	int met;                    /* rises in the order in which the equations show expressions */
};
struct jump {                       /* a state just behind an impact, over states, loads and inputs before it */
	int state;
	struct form *form;
	struct output *row;
};
struct strike {                     /* what an impact is in one segment of time */
	struct form *guard, *speed; /* turned so that it rises where it comes true, through 0; its derivative */
	struct form *press;         /* of a bounce: that of the speed; it may have highest derivatives */
	int jumps;
	struct jump *jump;
	mpq_t restitution;          /* of a bounce: e */
	mpq_t gap, answer;          /* of a stop, as numbers; answer: of its speed to a force of contact */
	mpq_t *direction;           /* d, per coordinate */
	struct jump *still;         /* its jumps if e were 0 */
	struct output *speed_row;
	int expression;             /* its guard is a multiple of this one, less a breakpoint, */
	mpq_t at, factor;           /* guard = factor (expression - at) */
	bool upward;                /* which it passes this way */
};
struct impact {                     /* of `when`, or of a stop */
	const struct when *when;
	/* v -> v - (1 + e) d s, s the speed: a bounce, which may come to rest; else the jump is any other */
	bool bounces;
	struct strike *in;          /* per segment of time of the model */
};
/* friction(v, F): v is an expression less a breakpoint that stands there twice, the interval of sticking between */
struct friction {                   /* in one segment of time */
	const struct atom *atom;
	int segment, expression;
	mpq_t at;                   /* that breakpoint */
	mpq_t factor;               /* v = factor (expression - at) */
	bool negative;              /* F may fall below 0, and counts as 0 there */
	bool low;                   /* S may fall below F, and counts as F there */
};
struct bearing { const struct atom *atom; const struct form *borne; };
/* Of FN_SLIDE: friction of what has no mass, by what it bears */
struct slider {
	const struct atom *atom;
	bool negative;              /* F may fall below 0 */
};
/* It slides beyond a breakpoint of q - F or of -q - F; F may be another one in each region */
struct slide {
	int way;                    /* 1 or -1 where it slides */
	int expression[2];          /* that of either */
	mpq_t at[2];                /* its breakpoint, */
	bool upward[2];             /* which is passed upward where the sliding begins */
};
/* Friction beside what is not piecewise linear, where there are no regions */
struct drag {
	const struct atom *atom;
	const struct form *velocity, *rate; /* v, and its derivative; that has highest derivatives */
	const struct form *force, *rest;    /* F, and up to what it sticks */
};
struct hold {                       /* a state that a region gives: of what sticks a velocity follows from the others */
	int state;
	struct form *form;          /* of states, loads and inputs, none of them held */
	struct output *row;
};
struct release {                    /* of what sticks: the interval is left where the form becomes greater than 0 */
	int expression;
	bool upward;
	struct form *form;          /* it may have highest derivatives */
	struct output *row;         /* over states, loads and inputs alone */
};
struct region {                     /* one interval for each expression, in one segment of time */
	bool possible;              /* its inequalities can hold together */
	int system;                 /* index of its equations; equal ones are one */
	struct form **residual;     /* per row: linear; friction stands in it as an atom until its force is put in */
	struct form **force, **rest; /* per friction: F, and what it holds up to at rest; NULL: none acts here */
	struct form **carried;      /* per friction's atom: what it carries, as it stands on the left side */
	struct output **grip;       /* per friction that outputs read: the same as a row; NULL: nothing */
	struct slide *slide;        /* per slider's atom */
	int holds, releases;
	struct hold *hold;
	struct release *release;
};
struct sign { mpq_t number; bool least; };  /* by which something was decided; least: by its being at least 0 */
struct switching {
	int rows, *row;             /* of the equations that it is of */
	int expressions;
	struct expression *expression;
	int segments;               /* of time: those of the model, or 1 where nothing of it changes */
	/* all, possible or not: products of the expressions' intervals, of each segment of time in order */
	int regions;
	struct region *region;      /* NULL where there are parts */
	int systems;
	/* where there are parts one: that of the first region of each; one segment of time */
	struct linear *system;
	int aparts;
	const struct node **apart;  /* terms that share no expression with others */
	bool torn;                  /* one has become such: the search begins anew */
	/* per system: a segment in which it serves; there expressions are the same in all */
	int *system_segment;
	int parts;                  /* 0: its regions are those of all coordinates together */
	struct region_part *part;
	int frictions;
	struct friction *friction;
	int sliders;
	struct slider *slider;
	int impacts;                /* the model's */
	struct impact *impact;
	int felts;                  /* friction of which outputs read what it carries: as they have it, for all time */
	const struct atom **felt;
	int signs;                  /* where there are factors */
	struct sign *sign;
	int sharing;                /* parts that have these regions together, since some move as a whole */
};
/* Coordinates that nothing outside of them acts on, in no region: they have regions of their own, and cross breakpoints
 * at times of their own. */
struct region_part {
	int coord;                  /* the first */
	struct model *model;        /* of them alone; its `switching` has no expressions where they are linear */
	int *state;                 /* per state of it: that of the whole model */
	int *input;                 /* likewise of the inputs that act on it or are in its expressions */
	int *expression;            /* likewise */
};
struct model *model_build(struct spec *spec, const struct request *request);
struct model *model_copy(const struct model *model);         /* to change what is asked of it */
void argument_value(struct model *model, const char *text, mpq_ptr value); /* of --solution; may use params */

/* ---- the builders of a model share ---- */

struct residual {                   /* left side minus right side of one scalar equation */
	struct form *form;
	struct place at, end;
};
struct building {                   /* what the builders share */
	struct spec *spec;
	struct model *model;
	struct collector collector;
	const struct request *request;
	const struct wave *polynomial; /* the wave of t^k alone */
	struct snapshot *snapshot;  /* per interval between changes of formula in time */
	struct snapshot *whole;     /* the same for all time, with atoms; NULL: there is no leftover */
	struct snapshot *nominal;   /* with the spec's values, where `snapshot` has tunable params; else NULL */
	int nominals;               /* its intervals */
	const bool *factor;         /* per tunable param: a number of regions, and no input; NULL: none is */
	struct point *values;       /* nothing fixed but tunable params; made on first use */
	/* [segment][row]: the residual's part that depends on time alone, as the linear core carries it */
	struct form **load;
	struct form **time_left;    /* per row: what depends on time alone and it cannot carry */
	int *owner;                 /* per coordinate: its residual */
};
struct snapshot {                   /* the equations and outputs in one interval of time */
	int residuals, written;     /* all; those of written equations come first */
	struct residual *residual;
	struct form **element;      /* per element of the sketch: its force */
	struct value **output;      /* per output statement; NULL: not linear */
	struct strike **strike;     /* per `when` and stop; NULL: it has been told */
};

/* ---- blocks.c: coordinates that do not influence each other ---- */

struct block {
	struct linear system;
	int *equation, *coord;      /* of the whole system, per equation and coordinate of the block */
	int *state;                 /* likewise per state */
};
/* M regular, so that a block has as many equations as coordinates */
int blocks_of(const struct linear *system, struct block **blocks);
/* Components of a graph whose nodes are n equations and then n coordinates, by their parents */
struct block block_at(const struct linear *system, int *parent, int coord);  /* the component of that coordinate */
bool is_seen_before(int n, int *parent, int coord);          /* an earlier coordinate is of the same one */

/* ---- augmented.c: the augmented state ---- */

/* x = [states, held terms, load states, inputs, channels]; every column of a table or of tuned equations has its place
 * here too */
struct layout {
	int size, states;
	int held;                   /* index of the first held term, one per coordinate; -1: none */
	int first_load, loads;      /* index of the load states; how many, in one segment of time */
	int segments;               /* of time that have load states of their own: 1, or all */
	int *load;                  /* per load: index of its first state, in the first of them; -1: it has none */
	int *input;                 /* index of each input (then of its slope, if of first order) */
	/* index of the first leftover; each is a chain of so many integrators, its force the first */
	int channel, powers;
};
enum { PARABOLA = 3 };              /* powers of a leftover: its value and two derivatives */
struct layout layout_of(const struct linear *system, int powers);   /* of loads those that act */
/* the same, in all segments of time where that is at most twice as large */
struct layout layout_of_segments(const struct linear *system, int powers);
struct layout layout_with(const struct linear *system, int powers, const bool *needed); /* of loads those needed */
/* states, all load states of all segments, inputs */
struct layout layout_of_columns(const struct linear *system);
const char **layout_names(const struct layout *layout, const struct linear *system, const struct model *model);
/* A of x' = A x; `segment` where the layout is of one */
mpq_t *augmented_matrix(const struct layout *layout, const struct linear *system, int segment);

/* ---- spell.c: loads, forms and equations for a reader ---- */

const char *column_text(const struct load *load, int column); /* t*exp(-2*t)*cos(5*t) */
const char *equation_text(const struct model *model, const struct form *residual); /* coordinates = loads */
/* atoms spelled out, long ones cut short */
const char *form_text(const struct model *model, const struct form *form);

/* ---- equations.c: equations and sketches to residuals ---- */

void collect_equations(struct building *b, struct snapshot *snapshot);
void collect_outputs(struct building *b, struct snapshot *snapshot);
int  find_order(const struct spec *spec, int coord);
void build_outputs(struct building *b);
/* of states, loads and inputs; no highest derivatives */
struct output *row_of_expression(struct building *b, const struct switching *of, const struct expression *e);
struct output *row_of_form(struct building *b, struct form *form);
/* the same with the highest derivatives that a system gives */
struct output *row_in_system(struct building *b, const struct linear *system, struct form *form);
void collect_whole(struct building *b);                     /* the equations for all time, atoms kept: b->whole */
bool assign_equations(struct building *b);                  /* false: it was said which is missing or too many */
void add_elements(struct building *b, struct snapshot *s); /* the sketch's forces to the residuals */
void check_mass(const struct building *b);

/* ---- delays.c: inputs as they were some time ago ---- */

void find_delays(struct building *b);                       /* model->delays; after the step is known */

/* ---- reads.c: what forms read ---- */

int held_values(const struct model *model);     /* that an instance has: tunable params, then leads */
const struct symbol *held_symbol(const struct model *model, int held);
struct reads {                    /* what forms read */
	bool *state, *input, *load; /* inputs, then their slopes */
	bool *highest;              /* per coordinate: its highest derivative */
	bool *param;                /* of held_values, where the instance has the spec's params */
	bool time, math;            /* t itself; <math.h> */
};
bool reads_input_slope(const struct model *model, int input);      /* does an output? */
struct reads reads_of(const struct model *model, int count, const struct form *const *form);
int  coordinate_of_row(const struct model *model, int row);       /* whose equation it is */

/* ---- system.c: residuals to M, C, K, loads and inputs ---- */

void fill_states(struct building *b, const struct snapshot *rows); /* M, C, K, inputs */
/* Tunable params that the instance has, at the spec's values: what is linear there belongs to the linear core, and the
 * difference is left over. Itself, where it reads none. */
const struct form *nominal_form(struct building *b, const struct form *form);
/* Whether what params multiply is parted so for inputs and loads too: a series puts both together again */
bool parts_params(const struct building *b);
void fill_loads(struct building *b, int segment, int row, const struct form *residual);
void place_loads(struct building *b, const struct form *form); /* every load of the form gets load states */
void spread_loads(struct building *b, const struct form *form,
		  void (*spread)(void *context, int load, int column, mpq_srcptr factor), void *context);
/* one row of everything */
void fill_system(struct building *b, struct linear *system, int segment, int row, const struct form *residual);
/* the model's coordinates, loads and inputs; no factors yet */
struct linear empty_system(const struct model *model);

/* ---- operator.c: the linear operator of a scheme, and what it leaves over ---- */

void build_operators(struct building *b);
/* the model's, with the operator's C and K and the channels */
struct linear operator_system(const struct model *model, int k);
/* Every form that the leftovers and the selector are made of, once, operands before what they make. */
void visit_leftovers(const struct model *model, void (*visit)(void *context, const struct form *form), void *context);

/* ---- split.c: what is left over as matrices times functions of time, and the rest ---- */

void split_leftover(struct building *b);                    /* model->split; after the operators */

/* ---- smooth.c: how smooth the equations are, and what order that leaves to a scheme ---- */

/* model->smooth; says where dry friction stands in what is left over */
void judge_smoothness(struct building *b);
/* or a coordinate of first order, which is one */
bool reads_velocity(const struct model *model, const struct form *form);
_Noreturn void tell_friction(const struct node *node, const char *where);
int  order_of_scheme(const struct model *model);            /* where all is smooth; 0: of exact */
bool loses_order(const struct model *model);                /* to what is not smooth */
int  order_that_holds(const struct model *model);           /* rounded down; 0: nothing is left over */
/* A scheme of the etd family goes from crossing to crossing here: what the state chooses is compared with
 * breakpoints. */
bool follows_crossings(const struct model *model);
const char *order_text(const struct model *model);          /* that is left: 2, 2.5 */
const char *smoothness_text(const struct model *model);     /* max(x - 0.5, 0) has a kink where x passes 0.5 */

/* ---- expressions.c: what is compared with breakpoints ---- */

struct compared {                   /* form + constant with 0 */
	const struct node *node;    /* by this term */
	struct form *form;          /* without constant */
	mpq_srcptr constant;
	int met;                    /* of struct expression, where it is one */
};
/* The expression that form is a multiple of in this segment of time; met for the first time it is one, with the sign
 * and scale in which it was written, and form is its own. form + constant = of (e - at) */
int  find_expression(struct switching *s, int segment, const struct compared *what, mpq_ptr of, mpq_ptr at);
/* In segments where nothing depends on it, it is as in the one before, or after. */
void complete_expressions(struct switching *s);
struct form *form_in(const struct expression *e, int segment); /* what breakpoints divide, in a segment of time */
bool share_expression(const struct switching *a, const struct switching *b);
bool changes_in_time(const struct expression *e);
const char *spoken_expression(const struct model *model, int index);  /* x - t; from t = 2 on x - 1 */

/* ---- regions.c: piecewise-linear equations as regions with linear ones ---- */

bool is_piecewise_linear(const struct building *b);
int  interval_of(const struct switching *s, int region, int expression);
/* of these rows of the equations; leaves the statement where they are too many, or with dry friction */
struct switching *regions_of_rows(struct building *b, int rows, int *row);
void remove_idle_breaks(struct switching *s);
/* its index; apart: with no other's, though they are equal */
int  add_system(struct switching *s, const struct linear *system, int segment, bool apart);
int  segment_of_region(const struct switching *s, int region);      /* of time */
int  regions_at_once(const struct switching *s);                    /* in one segment of time, possible or not */
bool is_form_multiple(const struct form *form, const struct form *e, mpq_ptr of);   /* of: the factor */
int  count_candidates(struct switching *s);                 /* in one segment of time; strides of expressions */
void mark_possible(const struct building *b, struct switching *s); /* which may be: possible.c */
void check_jumps(struct building *b, const struct switching *s); /* forces that jump with a velocity are refused */
_Noreturn void too_many(const struct building *b, const struct switching *s);
_Noreturn void too_many_in_time(const struct switching *s);
int  breaks_of_all(const struct switching *s);               /* breakpoints of all its expressions */
int  possible_regions(const struct switching *s);

/* ---- impacts.c: state jumps, and what bounces ---- */

void collect_impacts(struct building *b, struct snapshot *snapshot); /* in one interval of time */
void gather_impacts(struct building *b);                    /* of all of them */
void build_impacts(struct building *b);                     /* once the masses are known */
bool strikes_change(const struct building *b);              /* from interval to interval */
/* At the start of this segment of time a load takes the guard up, so that it may come true by no crossing. */
bool closes_by_jump(struct building *b, const struct impact *impact, int segment);
void place_impact_loads(struct building *b, const struct switching *s);
void build_impact_rows(struct building *b, struct switching *s);
/* Why a scheme cannot treat friction or impacts */
_Noreturn void tell_no_events(const struct building *b, struct place at);

/* ---- events.c: what is held in regions, and what begins there ---- */

bool is_stick(const struct expression *e, int interval);    /* between two equal breakpoints */
/* In one segment of time: which begins where an expression passes a breakpoint this way; -1: none does */
int  impact_at(const struct switching *s, int segment, int expression, mpq_srcptr at, bool upward);
int  impact_resting(const struct switching *s, int segment, int expression, int interval); /* there; -1: none does */
/* the interval in which it rests; -1: it is no bounce */
int  rest_of(const struct switching *s, int segment, const struct impact *impact);
bool has_bounces(const struct model *model);
const char *restitution_text(const struct model *model, const struct impact *impact); /* of a bounce, at all times */
bool rubs(const struct switching *s);                       /* there is friction, with mass or without */
bool has_events(const struct switching *s);                 /* each region has its own: friction, impacts */

/* ---- force_sign.c: whether a friction force may fall below 0 ---- */

/* At 0 or above, at 0 or below, from `from` to `to` (NULL: for good), as far as that is seen of what time alone
 * moves */
bool stays_above_zero(const struct form *force, mpq_srcptr from, mpq_srcptr to);
bool never_falls_below(const struct form *force);           /* below 0, from t = 0 on, as far as it is seen */
/* that it is above 0 at some time between; `node`: where it stands */
void check_force(const struct node *node, const struct form *force, mpq_srcptr from, mpq_srcptr to);

/* ---- friction.c: dry friction in regions, where it slips and where it sticks ---- */

bool holds_friction(const struct building *b);              /* somewhere in the equations */
_Noreturn void tell_no_friction(const struct building *b);  /* why a scheme cannot treat it */
/* What is held exceeds the force of what slides by this, where the velocity is 0 */
struct form *less_in_velocity(const struct form *rest, const struct form *force, const struct form *velocity);
int  input_hold(const struct building *b, int index);      /* the degree of what goes through its samples */
struct form *rate_of_form(struct building *b, const struct form *form); /* its derivative with respect to time */
int  stick_of(const struct switching *s, const struct friction *f); /* the interval in which it sticks */
/* puts in the forces of what slips, and the constraints of what sticks */
/* its index; -1: no equation has it in this segment of time */
int  friction_of(const struct switching *s, int segment, const struct atom *a);
int  felt_of(const struct switching *s, const struct atom *a); /* among those that outputs read */
bool is_repeated(const struct switching *s, int friction);  /* as written it stands there for an earlier segment too */
void resolve_friction(struct building *b, struct switching *s);
void build_friction(struct building *b, struct switching *s); /* rows of holds and releases; after all systems */
struct holding {                    /* states of a region that follow from the others, as they are found */
	const struct building *b;
	struct region *region;
	struct basis *of;
};
const struct form *free_of_holds(const struct holding *h, const struct form *form);     /* without what is held */
void hold_state(struct holding *h, const struct form *v, int at);   /* v = 0, solved for the state of its term `at` */
void add_release(struct region *region, int expression, bool upward, struct form *form);
bool same_friction(const struct region *a, const struct region *b); /* what sticks is held and released alike */

/* ---- slider.c: friction of what has no mass ---- */

/* Whether friction stands in the form whose velocity is of a coordinate of first order: this one; -1: any */
bool has_slider(const struct building *b, const struct form *form, int coord);
void resolve_sliders(struct building *b, struct snapshot *snapshot); /* its equation gives the force that it bears */
/* in a region: the equations of what slides, where that ends, and the places that follow from what it bears */
void slide_sliders(struct building *b, const struct switching *s, int region);
/* Whether a guard of its own stands where the interval of an expression ends: what lets go a slider without mass */
bool is_released(const struct region *region, int expression, bool upward);
void hold_sliders(struct holding *h, const struct switching *s);
struct form *borne_form(const struct building *b, const struct form *form); /* of an output: what friction bears */
/* where it slides, of the slider that is written there; NULL: it sticks */
struct form *slide_velocity(const struct switching *s, const struct region *region, const struct node *node);
bool is_repeated_slider(const struct switching *s, int index);      /* it stands there for an earlier segment too */
/* Where it slides: as many as its force differs in regions */
int slides_of(const struct switching *s, int index, const struct slide ***slide);
const char *slider_text(const struct switching *s, int index);      /* the same for a reader */
/* ---- contacts.c: impacts and friction beside what is not piecewise linear ---- */

void find_contacts(struct building *b);                     /* of the equations for all time */
void place_contact_loads(struct building *b);
void check_contact_outputs(struct building *b);             /* says what they cannot read */
bool has_contacts(const struct model *model);               /* without regions */

/* ---- parts.c: regions of independent coordinates ---- */

void find_regions(struct building *b);                      /* says what cannot be treated */
/* of a region of a part in the number of the model's: its intervals, by the strides of the whole */
int  share_of_region(const struct region_part *part, const struct switching *whole, int region);
void place_region_loads(struct building *b);
/* their systems; after the loads of all have their places */
void build_regions(struct building *b);

/* ---- truncation.c: where a series ends ---- */

enum { MOST_OVER = 32 };            /* steps of one expansion of fixed order: as many as one by tolerance serves */
/* h times those of one expansion: the unit of time of its coefficients */
void unit_of_expansion(const struct model *model, mpq_ptr unit);

enum { LEAST_ORDER = 4, MOST_ORDER = 30 };
enum { LEAST_STAGES = 3, MOST_STAGES = 9 };
void evaluate_truncation(void *context);                    /* of a building: order of a series, its most substeps */
int  whole_number(struct building *b, struct node *node, int low, int high, const char *what); /* else it is refused */
/* from its tolerance, which is the default where it is 0; of what is no series, none */
void choose_order(struct model *model, bool single);
/* An argument of the command line, then *at is where it stands; else what the spec has */
struct node *asked_or_written(struct building *b, const char *asked, struct node *written, struct place *at);

/* ---- bounds.c: what a spec says of single states ---- */

void evaluate_absolutes(struct building *b);                /* into truncation.absolute */
void evaluate_ranges(struct building *b);                   /* behind the initial values, which have to be in them */

/* ---- jacobian.c: of the equations for all time, where states and time are fixed ---- */

struct jacobian {
	struct building *b;
	/* [coordinate][row]: of the equations for all time, by velocity and by coordinate */
	struct form ***C, ***K;
	struct linear at;           /* evaluated */
	bool damped;                /* C too */
	const mpq_t *state;         /* where the states are fixed */
	mpq_t t;
};
void jacobian_forms(void *jacobian);                        /* C, K and what `at` has of the system */
/* K, and C where it is wanted, at j->t and j->state; leaves the statement where they are not defined */
void jacobian_evaluate(void *jacobian);
int  jacobian_point(const struct jacobian *j, struct fixing *fixing); /* states + 1, which it fixes */
/* [1/s^2] of the coordinates' stiffness alone, eigenvalues of W^-1 K, rising; false: not found */
bool squared_frequencies(const struct linear *system, double *value);
double fastest_pole(const struct linear *system);           /* its size [1/s]; 0: not found */
double fastest_decay(const struct linear *system);          /* the largest -Re of a pole [1/s], at least 0 */

/* ---- settle.c: which scheme the equations allow ---- */

bool is_linear(const struct building *b);                   /* with constant coefficients, loads in time excepted */
/* of equations that were collected, whichever coordinates they belong to: a scheme is for them that leaves something */
bool leaves_over(const struct building *b);
bool needs_regions(const struct building *b);                    /* scheme exact has regions for them */
void build_system(struct building *b);                      /* M, C, K, loads, inputs */
/* whose coordinates or inputs do not have the factors of the first segment; NULL: none */
const struct node *changing_factor(struct building *b, int segment);

/* ---- nonlinear.c: what is not in M, C and K ---- */

void find_nonlinear(void *building);                        /* each with its place and its text */

/* ---- needs.c: how exact outputs have to be ---- */

struct target {                     /* a processor: what it takes of instructions */
	const char *name;
	struct { double multiplication, addition, wave, step; } cost[2]; /* in double, in float */
};
/* of the model that is stepped: its requirements, its target; false: it was said what stands in the way */
bool find_requirements(struct model *model);
bool steps_exactly(const struct model *model);              /* by scheme exact, or by one that nothing is left to */
bool is_measured(const struct model *model);                /* no bound is known: it is not linear, or in pieces */

/* ---- amplitudes.c ---- */

bool differ_in_loads(const struct model *a, const struct model *b); /* in nothing but how large their loads are */

/* ---- reduce.c: the smallest model with the same outputs ---- */

struct model *model_reduce(struct model *model);             /* itself where nothing can go, or shall */
/* Are the states of both the same combinations of the same written ones? */
bool same_reduction(const struct model *a, const struct model *b);

/* ---- modes.c, survey.c: the modes of a linear model, and what each of them gives to the outputs ---- */

/* A mode is an invariant part of y' = A y that is real and as small as it can be: z = left y, z' = block z + left b u,
 * and right z is its share of y; left right = 1. It has the two states of a pair of poles, or the one of a real pole;
 * more where poles coincide or nearly do, as those of repeated frequencies and of what moves as a whole. Where M^-1 K
 * and M^-1 C share their modes (proportional damping, none) z is a coordinate and its velocity, z = (m, m'). */
struct mode {
	int number;                 /* by rising size of its poles, from 1; of several coordinates: the first's */
	int states;                 /* of z */
	int weight;                 /* how many it counts for: its pairs of poles and real poles; two poles 0 as one */
	bool moves;                 /* z = (m, m') */
	bool rigid;                 /* a pole is 0 */
	bool seen;                  /* some output reads it, and a load, an input or the start reaches it */
	double re, im;              /* its pole [1/s], im >= 0; where there are several: their middle */
	/* In units of the output: the largest size it can ever have in it by the start and the loads, the same of what
	 * is left once the forced part of loads is kept, and per input the largest that a step of height 1 gives;
	 * HUGE_VAL: no bound. In double precision: to choose by, and to tell. */
	double *size;               /* [output] */
	double *transient;          /* [output] */
	double *by_input;           /* [output * inputs + input] */
	double share;               /* the largest part of the sum over all modes, in any output by any of these */
	/* Known once mode_refine was called; each number to 2^-MODE_BITS of the largest in its row */
	mpq_t *block;               /* states x states */
	mpq_t *right, *left;        /* states of the model x states; states x states of the model */
	int first, columns;         /* of the basis: modes.c; coordinates, where it moves */
};
struct modes {
	const struct model *model;
	int count;
	struct mode *mode;          /* by number */
	struct mode_basis *basis;   /* modes.c */
};
struct shortening {                 /* of a model of modes */
	const struct modes *modes;
	const bool *kept;           /* per mode */
	bool statics;               /* what is dropped still follows loads and inputs at once */
	/* z = to y of the whole model's states y, and from z is what is kept of y: states x the whole's, and back */
	mpq_t *to, *from;
};
/* Of a linear model with declared outputs. NULL: `*why` says what stands against it ("a param is tunable"). */
struct modes *modes_of(const struct model *model, const char **why);
/* block, right and left; doing it again costs nothing. False: it does not converge, as of a model whose poles lie too
 * close for double precision. */
bool mode_refine(struct modes *modes, int index);
/* by falling share, rigid ones that are seen before all others: indices into `mode` */
int *modes_by_share(const struct modes *modes);

/* ---- shorten.c: the model of some of its modes ---- */

/*
 * To try subsets of modes, and to go on with one:
 *
 *     struct modes *modes = modes_of(model, &why);
 *     bool *kept = ARRAY(bool, (size_t)modes->count);
 *     ... kept[i] = true ...                  modes->mode[i].size, transient, by_input say what each would add
 *     struct model *error = modes_dropped(modes, kept, true);     what would be lost, exactly
 *     struct model *shorter = modes_kept(modes, kept, true);      what is stepped: step_build(shorter)
 *
 * Both are ordinary rational linear models with an own block of `system` for each mode, so their B(s) have degree 2 and
 * residues are cheap: output i of `modes_dropped` is e_i(t) = output i of the model less that of `modes_kept`, under
 * the same loads (rows `load` of its outputs), inputs (rows `input`) and from its own `initial`. With r = c e^{block t}
 * of a mode, e(t) = sum over dropped modes of r (z(0) - P q(0)) where the forced parts P q(t) of loads q are kept, and
 * for inputs h_e = r left b, less the static gain. `written` of both is the model.
 *
 * `statics`: what is dropped still follows its loads and inputs at once: the outputs get the forced part of what is
 * dropped for each load, and its static gain for each input (rows `load` and `input` of struct output; no states).
 * What is dropped has rigid modes, or a load has a pole of it: that part is not kept.
 * NULL: a mode is not found (mode_refine), or, of modes_dropped, none is dropped.
 */
struct model *modes_kept(struct modes *modes, const bool *kept, bool statics);
struct model *modes_dropped(struct modes *modes, const bool *kept, bool statics);
/* The largest that output can lose by what is dropped, from the start and by loads, at any time; HUGE_VAL: no bound.
 * In double precision. */
double modes_loss(const struct modes *modes, const bool *kept, bool statics, int output);
/* What the statement `modes` or --modes asks for; the model itself where neither does. NULL: it was said why not */
struct model *model_shorten(struct model *model);

/* ---- lint.c: what is no mistake of language, and yet seldom meant ---- */

void lint(struct building *b);

/* ---- warnings.c: what a spec may say but is better told about ---- */

void warn(struct building *b);

/* ---- retuned.c: how equations, outputs and regions follow from tunable params that are no inputs of them ---- */

/* an earlier one times a param, or divided by it; number 0 is 1, these are 1, 2, ... */
struct tuned_monomial { int from, param; bool divides; };
struct tuned_term {
	int row, column, monomial;
	mpq_t factor;
};
/* W a = R x, exactly, for all values of the params */
struct tuned_equations {
	int rows, columns;          /* entries of a, of x */
	bool solves;                /* there is a W, columns behind those of R; else it is the unit matrix */
	int terms;
	struct tuned_term *term;    /* the same entry's one after the other */
};
enum retuned_kind {                 /* of rows: */
	RETUNED_SLOPE,              /* of system: coordinate's highest derivative over x, */
	/* which is that of W a = R x: of R, and of W over highest derivatives; likewise of what reads these */
	RETUNED_R, RETUNED_W,
	RETUNED_OUTPUT, RETUNED_OUTPUT_R, RETUNED_OUTPUT_W, RETUNED_FREQUENCY, /* of linear models; load, a number */
	RETUNED_EXPRESSION,         /* of segment of time: expression */
	RETUNED_BREAK,              /* of expression: breakpoint; a number, in column 0, as those below are */
	RETUNED_HOLD, RETUNED_RELEASE, RETUNED_GRIP, /* of region: one of its holds, releases; friction */
	RETUNED_RELEASE_R, RETUNED_RELEASE_W, RETUNED_GRIP_R, RETUNED_GRIP_W,
	RETUNED_JUMP, RETUNED_STILL, /* of impact: one of its jumps, of those without restitution */
	RETUNED_TIMES, RETUNED_ANSWER, /* answer times the row before; that number */
	RETUNED_SPEED, RETUNED_BACK, RETUNED_RESTITUTION, /* of impact; restitution is a number */
	RETUNED_LEAST,              /* a number that is at least 0: a force of friction, the gap of a stop */
	RETUNED_SIGN                /* a number that stays above, or below, 0 */
};
struct retuned_row {
	enum retuned_kind kind;
	int of, index, place;       /* place: row of what the target evaluates; -1: no param changes it */
	bool positive;
};
struct retuned_block {              /* a system that the target solves, and what reads its highest derivatives */
	struct tuned_equations all;       /* products of params are those of the whole */
	int place;                  /* of its first row */
};
struct tuning {
	int params, given;          /* given: in the statements `tunable`; the others follow from these */
	const struct tunable *param;
	mpq_t *nominal;             /* the spec's values */
	/* what follows is not there where an instance has no more than the params */
	struct layout x;            /* states, load states (linear: of each segment of time), inputs: of ramps u, u' */
	int rows;
	struct retuned_row *row;
	/* Of a linear model the highest derivatives of the coordinates, then the outputs that depend on params, then
	 * frequencies of loads that do (in column 0). Of regions all rows, of which blocks have terms of their own. */
	struct tuned_equations all;
	int blocks;
	struct retuned_block *block;
	int outputs, frequencies;   /* of a linear model: of its rows, behind those of coordinates */
	int *output, *frequency;    /* per output, per load: its row, or -1: no param changes it */
	bool *acts;                 /* rows x columns, solved: whether it is anything but 0 for some values */
	int monomials;
	struct tuned_monomial *monomial;
	const struct model *other;  /* at values that are related by nothing: what holds there holds for all */
};
/* model->tuning, or held and retuned, where something is tunable: of this model, or of one whose sums of params are
 * params of their own; NULL: it was said why not */
struct model *find_tuning(struct model *model, const struct request *request);
int  retuned_place(const struct tuning *t, enum retuned_kind kind, int of, int index);

/* ---- elsewhere.c: a model at other values of its tunable params; its entries as sums of products of these ---- */

enum { WHOLE_POINTS = FIT_POINTS + 1 };         /* of which all entries are kept: what is equal at them stays */
struct difference {                 /* two models may not have it; with another value of a param ... */
	bool (*same)(const struct model *, const struct model *);
	const char *text, *note;
};
struct elsewhere {
	const struct model *model;
	const struct request *request;
	struct tuning *tuning;      /* params, the spec's values */
	const bool *factor;         /* as in struct request */
	const mpq_t *near;          /* as in struct fit */
	int differences;
	const struct difference *difference;
	mpq_t *(*read)(struct elsewhere *s, const struct model *model);     /* its entries */
	ptrdiff_t entries, changing;
	const struct model *other;  /* the first of them */
	struct model *found;
	mpq_t *values, **point;     /* params at points looked at so far */
	int points;
	mpq_ptr **seen;             /* entries there, NULL: 0; of the first points all, of others those that change */
	ptrdiff_t *place;           /* per entry: which of those that change; -1: it does not. NULL: not known yet */
	mpq_t zero;
	struct fit fit;             /* of the last entry */
};
/* Waves, their order, times at which they change; any_rate: frequencies may differ */
bool same_loads(const struct linear *a, const struct linear *b, bool any_rate);
_Noreturn void tell_difference(struct elsewhere *s, const struct difference *difference);
void look_elsewhere(struct elsewhere *s);
mpq_srcptr entry_seen(const struct elsewhere *s, int point, ptrdiff_t index);
bool entry_stays(const struct elsewhere *s, ptrdiff_t index);
/* its terms; false: it is no such sum, as refuse_fit says */
bool fit_entry(struct elsewhere *s, ptrdiff_t index, struct tuned_equations *all, int row, int column);
_Noreturn void refuse_fit(const struct elsewhere *s, const char *what, const char *way);
void add_tuned_unit(struct tuned_equations *all, int row, int column);

struct listing {                    /* retuned_rows.c: the numbers of one model, in columns of x */
	const struct model *model;
	const struct layout *x;
	int rows;
	struct retuned_row *row;
	mpq_t *entry;               /* rows x columns */
};
struct listing list_rows(const struct model *model, const struct layout *x);
/* An output, whose loads have so many segments of time, in one of these, or as x in all */
void row_of_output(const struct layout *x, const struct linear *system, const struct output *output, int segments,
		   int segment, mpq_t *row);
/* factors.c */
const bool *find_factors(struct building *b);   /* per tunable param, of regions: it cannot go as a held input */

/* ---- derived.c: what is computed from tunable params as if it were one ---- */

/* Puts names of further params, spec->derived of them, in the place of what no sum of products is. Again it finds
 * nothing. */
void derive_params(struct spec *spec);
struct spec *spec_again(const struct spec *spec);   /* from its text, where the same params are put there */
void warn_of_unread(const struct model *model);
void check_tuned(const struct model *model);    /* what is left of it leaves the statement */

/* ---- params.c: tunable params that the instance has ---- */

void spread_tuned(const struct spec *spec);     /* to params, matrices and lets that are made of tunable ones */
/* the first name in it that is tunable, or made of what is; NULL: there is none */
const struct node *first_tuned(const struct node *node);
unsigned params_read(const struct node *node);  /* the given ones it follows from, a bit each */
unsigned params_of_tunable(const struct spec *spec, int tunable);
int  param_of_input(const struct spec *spec, int input);   /* -1: it is an input of the spec */
struct tuning *list_tunables(const struct model *model);
const struct tuning *tunables_of(const struct model *model); /* of either kind; NULL: nothing is */
/* at values related by nothing; NULL: no param is tunable in this way */
const struct model *model_elsewhere(const struct model *model);

/* ---- stepped.c: the model that a step is built of ---- */

struct model *stepped_model(struct model *model, struct spec *spec, const struct request *request); /* NULL: said why */

#endif
