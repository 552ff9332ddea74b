/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of piecewise-linear models, and what they find their crossings with. */
#ifndef PLGEN_STEP_REGIONS_H
#define PLGEN_STEP_REGIONS_H

#include "step/step.h"

/* Of a step that is not left to the search: crossings, and parts looked at */
enum { MOST_FAST_PATH = 4, MOST_EVENT_CHECKS = 10 };

/* ---- switched.c: steps of piecewise-linear models ---- */

void build_regions_step(struct step *step);
void build_parts_step(struct step *step);
int products_of_piece(const struct step *step);             /* and of the bound that shows it clear */
bool is_checked_by_tables(const struct step *step);         /* over h for events: by tables, not case by case */
long products_of_unmet(const struct step *step); /* of the check for events over h, with friction or impacts, at most */

/* ---- pieces.c: what a piecewise-linear model finds its crossings with ---- */

struct region_piece {               /* of a branch, d = h 2^-halvings is its shortest piece; x as in struct layout */
	double *row;                /* of each switching function: row . x, switching functions x size */
	double *slopes;             /* A of x' = A x, size x size [x/s]; second words behind them */
	double *Phi;                /* e^{A h}, size x size */
	double *gain;               /* e^{A h} - I in two words, 2 size x size: first ones, then second ones; or NULL */
	double **rung;              /* as in pl_ladder, the shortest first */
	double *reach;              /* of each switching function, of each rung but the first, and of h */
	double *slope; /* slope . x is d/3 times the slope of each switching function; switching functions x size */
	double *second, *fourth;    /* second . |x(0)|, fourth . |x(0)| bound, on 0 .. d, d^2/8 times the second and */
				    /* d^4/384 times the fourth derivative of each; switching functions x size */
	/* Where a step is checked for events over h: each switching function is off its chord by at most off . |x(0)| +
	 * still. With the fast path: rounding and what its Taylor polynomial leaves out make its value and h times its
	 * slope wrong by at most slack . |x(0)|; turn and bend are slope and fourth over h */
	double *off, *still, *slack, *turn, *bend;
	double *added;              /* of a retuned model: what stays of x adds to each state over h */
	double *third;              /* third . |x(0)| bounds h^3/24 times the third derivative of each */
	double *turns;              /* h A */
};
struct pieces {
	double **rows; /* of each switching function: row . x, switching functions x size; in each segment of time */
	double *row;                /* in the first */
	double *breakpoint;         /* those of the first switching function, rising; of the second; ... */
	struct region_piece *piece;        /* per branch */
	/* Where a step is checked for events over h: */
	bool *bounded;              /* per entry of x: never above 1, and with the fast path part of `still` */
	double large;               /* no number of a step overflows where |x| is smaller, other entries summed */
	double *edge;               /* of a retuned model: see folded.c */
	/* With the fast path: */
	double *low, *high; /* bounds of each switching function in each region: regions x switching functions */
	int degree;
	double *weight;             /* 1/k!, k = 0 .. degree */
};
#define OPEN_END 0x1p1000           /* of an interval that no breakpoint ends */
struct pieces pieces_of(const struct step *step);
#define LARGE_ENOUGH (0x1p500)      /* no sum of products of such a number overflows; of floats: */
#define LARGE_FLOAT (0x1p60)
double *full_step_of(const struct step *step, int branch);   /* e^{A h}, size x size */
/* Of regions whose matrices the target makes: how many an instance keeps, and what each takes */
int slots_of(const struct step *step);
long bytes_of_slot(const struct step *step);
bool has_ladder(const struct step *step);
int room_for_rungs(const struct step *step);
double *Phi_over(const struct step *step, const struct table *table, int halvings);
void row_over_x(const struct step *step, const struct output *output, int segment, double *row);
/* Of |x|: how far row . x is at most off its chord over h, entry by entry */
void bend_of_row(const struct step *step, const double *A, double h, const double *row, double *bend);

/* ---- folded.c: what stays of x, in the tables of an instance ---- */

bool is_bounded_load(const struct step *step, int load);    /* it has load states that are never above 1 */
/* sqrt(a^2 + b^2) is at most the larger and so much of the smaller, 2^1/2 - 1 */
#define FOLDED 0.41421356237309515
int *staying_columns(const struct step *step, int *count);  /* of x: 1, and held params */
bool any_stays(const struct step *step);
bool any_still(const struct step *step);                    /* that, or something is never above 1 */
int param_of_column(const struct step *step, int column);   /* of such a one; -1: it is 1 */
int edges_of_regions(const struct switching *s); /* breakpoints, and two open ends of each switching function */

struct guards;

/* ---- variation.c: derivatives of the tables of regions by params ---- */

struct varied_model {               /* a column: the model at two values of its param */
	const struct model *more, *less; /* themselves, where it is by no param */
	mpq_t apart;                /* by so much the params are */
};
struct varied_entry {
	int row, column;
	double value;
	struct traced_part made;    /* where the target makes it anew: the number of the record whose slope it is */
};
/* Blocks of a column: A of each matrix, switching functions, breakpoints, guards, assignments, times of changes */
enum { VARIED_TABLES = 5 };
struct variation {                  /* as pl_variation has it: of all columns the blocks in turn */
	int blocks, *first;
	int entries;
	struct varied_entry *entry;
	double *over;               /* derivatives of e^{A h}: of each column those of each matrix; or NULL */
};
/* of each of step->derivatives, of a model that goes by regions; leaves the statement */
struct varied_model *varied_models(const struct step *step, const struct model *model);
double varied_number(const struct varied_model *v, mpq_srcptr more, mpq_srcptr less); /* its derivative, rounded */
/* of outputs, rows over x of this layout: per column and segment of time a block */
struct variation variation_of_outputs(const struct step *step, const struct layout *x);
void vary_start(const struct step *step, int column, double *value); /* of its initial state */
/* Where tables are an instance's own: the tunable param that a column is by; NONE: none */
int tunable_of_column(const struct step *step, int column);
/* of the tables of a step, or of one of its parts; g NULL: it has no guards */
struct variation variation_of(const struct step *step, int part, const struct guards *g);

#endif
