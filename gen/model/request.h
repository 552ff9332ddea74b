/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is asked of a model, on the command line and in the spec. */
#ifndef PLGEN_MODEL_REQUEST_H
#define PLGEN_MODEL_REQUEST_H

#include "collect/collect.h"
#include "math/math.h"
#include "tape/tape.h"

struct relative;
struct target;

struct building;
struct again {                      /* to build a model a second time, for builders; then nothing is reported again */
	/* values of the tunable params in place of the spec's, to see what the equations become: no step, no initial
	 * values */
	const mpq_t *tunable;
	/* with them: those of the tunable params that regions have as numbers, the others as inputs; else NULL */
	const bool *factor;
	const struct relative *relative; /* the coordinates to build the model over; NULL: the written ones */
	bool undivided;             /* regions are those of all coordinates together */
	bool by_regions;            /* a linear model as one of regions, of which it has one in each segment of time */
	/* so many of the spec's derivatives, from the first on, as coordinates behind its own; 0: none */
	int derivatives_from, derivatives;
	bool jumps, remainder;      /* of formulas that jump, too; of the operator and the remainder each */
	bool probe;                 /* with what says how long a series of theirs may be, */
	int order;                  /* of this order; 0: as is best */
	bool held;                  /* a collocation with lengths that they do not choose */
	/* this param has that value, to see how the equations follow it; NULL: none has */
	const char *varied;
	mpq_srcptr value;
	const double *start;        /* from these states; NULL: from the initial values */
	bool trial;                 /* its step and its outputs alone: no NAME_at, no blocks of rows */
};
#define EQUILIBRIA "all equilibria"
struct request {                    /* what the user asks for on the command line; of most, a spec may say it too */
	const char *step, *scheme, *prefix, *tolerance;
	const char *modes;
	bool external;              /* also a step as an external function, by derivatives of states and inputs */
	const char *sensitivity;    /* by what derivatives are, in place of the statement's; NULL: it says so */
	/* which tunable params regions have as numbers, not as inputs; stands on what builds a model. NULL: none */
	const bool *(*find_factors)(struct building *b);
	bool reduce;
	bool loads_left;            /* known loads are left to the scheme */
	bool compensated;           /* two-word arithmetic */
	bool single;                /* the target's numbers are floats */
	bool own_math;              /* elementary functions are the runtime's */
	bool step_open;             /* nothing says how long a step is: one is chosen */
	bool real_given;            /* that was said: --real */
	bool selftest;              /* NAME_selftest */
	bool fast;                  /* tables for long runs on a workstation: rows of outputs, rotated phasors */
	bool phasors;               /* of these the phasors, which pay in every step: of --fast, batches and FMUs */
	int rows;                   /* in a block of NAME_run; 0: with `fast` as many as serve best, else none */
	struct { bool batch, device; } many; /* NAME_batch; of its C only what a device takes */
	enum step_form form;
	int refresh;                /* steps from one evaluation of a load's functions to the next; 0: see `phasors` */
	struct {                    /* a point at which the equations are made linear */
		/* rest, t=EXPR, or states and their values; EQUILIBRIA: they are searched for; NULL: nowhere */
		const char *where;
		const char *moved_by; /* the scheme that brought the states there; NULL: they were given */
		const char *found;  /* the point that these equations are at; NULL: they are the model's own */
	} linear;
	bool explained;             /* what holds of the equations is wanted too */
	bool solution;              /* the closed form is wanted, whatever the scheme */
	const char *passed_over;    /* why the scheme that would be best has no step; NULL: it was not tried yet */
	struct definitions definitions;
	struct {                    /* where it is asked for, command line or spec: found when the model is built */
		struct place scheme; /* source NULL: it is not */
		struct place step, form, compensated;
		struct place end;   /* of --solution, else as step */
	} at;
	struct { struct node *order, *over; } series; /* as its scheme has them; NULL: not given */
	struct again again;
};

/* Whether NAME_run is to go by blocks of rows */
static inline bool wants_rows(const struct request *requested)
{
	return requested->rows ? requested->rows > 1 : requested->fast;
}

struct truncation {                 /* of a Taylor series */
	int order;                  /* of its last term in h; of collocation in h */
	int stages;                 /* of a collocation: nodes after the step's start; 0: there is none */
	bool adaptive;              /* steps as long as the tolerance lets them be; else each is h, */
	int over;                   /* and one expansion is over so many of them */
	mpq_t tolerance;            /* of the last terms, relative to the largest of each state; 0: not looked at */
	/* per state: what a step may add to it beside the tolerance of its size now; 0: its largest size counts. NULL:
	 * so of all */
	mpq_t *absolute;
	int substeps;               /* most within one h */
};
struct param_range {                /* in which the spec says that a tunable param stays */
	mpq_t low, high;
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
struct needs {
	int requirements;
	struct requirement *requirement;
	const struct target *target; /* of a budget: its instructions a step; 0: there is none */
	double budget;
};
struct wanted_modes {               /* of the statement `modes`, or of --modes */
	struct place at;            /* source NULL: all */
	int count, *number;
	bool each;                  /* those numbers; else number[0] is how many, the best */
	bool static_correction;     /* what is dropped follows loads and inputs at once */
};
struct reduction {                  /* what --reduce found, and 'modes' */
	int *place;                 /* of a reduced model, per written state: the state that is it, or -1 */
	bool irreducible;           /* it was asked for, and every state is seen */
	int dropped;                /* written states that are no combination of the reduced ones */
	const char **dropped_name;
	mpq_t *row;                 /* of a reduced model, states x written states: each state over the written ones */
	const struct modal_truncation *truncated; /* the model is of some modes of another; NULL: it is not */
};
struct nonlinear {                  /* what no M, C and K have */
	const struct node *obstacle; /* the first term that stood in the way of exact, where no scheme was asked for; */
	const char *why;            /* it did, and the way out if there is one */
	int terms;                  /* of the equations, and what jumps, by place */
	struct nonlinear_term { struct place at; const char *text; } *term; /* as written */
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

#endif
