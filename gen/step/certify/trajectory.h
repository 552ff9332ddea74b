/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of verified trajectories share. */
#ifndef PLGEN_TRAJECTORY_H
#define PLGEN_TRAJECTORY_H

#include "math/math.h"
#include "model/linear/linear.h"
#include "plrt.h"

struct event_state;
struct deviation;

/* What so many bits do not tell apart is one: two instants, a force and its limit. */
enum { TRAJECTORY_SLOTS = 64, BITS_OF_ONE = 768 };
struct near {                       /* x in double, and how far off it may be */
	double *x, *off;
};
struct guard {                      /* a row over x that must not become greater than its limit */
	int function, breakpoint, leads;
	bool upward;
	bool release;               /* its value is a force, which then lets go what it held */
	int impact;                 /* that begins there; -1: none */
	mpq_t *row, *slope;         /* slope: of its derivative with respect to time */
	mpq_t limit;
	/* the same in double; fourth . |x| bounds the fourth derivative */
	double *near_row, *near_slope, *fourth, near_limit;
};
struct area {                       /* a region as it is met */
	int system;
	mpq_t *A;                   /* x' = A x */
	struct stream *flow;          /* NULL: it was not met yet */
	double *growth;             /* e^{|A| piece} */
	int guards;
	struct guard *guard;
};
struct trajectory_grid {            /* of pieces, from where it was met: x after so many, by the lowest one of them */
	bool met;
	unsigned long pieces;
	mpfi_t *slot[TRAJECTORY_SLOTS + 1];
};
struct trajectory_piece {
	struct series_room room;
	int terms;
	mpfi_t *value, *slope;      /* polynomials */
	mpfr_t one;
	struct near near[2];
	double *most;
	int at_once;
};
struct trajectory_fresh {           /* let go at base, but for so much [s]: 0 there with their first derivatives */
	int *order;                 /* per switching function; 0: it was not */
	bool *back;                 /* which way it would come back */
	mpfr_t off, most_off;
};
struct trajectory_time {
	int segments, segment;      /* of time */
	const mpq_t *change;
};
struct trajectory_list {            /* of crossings */
	int count, most;            /* most: 0: any number */
	struct passed *list;
	double speed, size; /* of the switching function that was met last, as in struct passed; 0: a load jumps */
};
struct trajectory {
	const struct model *full, *model;
	const struct region_part *part; /* NULL: both are one */
	const struct switching *s;
	const struct linear *system; /* the first: coordinates, loads and inputs are those of all */
	int precision, n;           /* bits; entries of x */
	struct layout layout;
	struct trajectory_time when;
	mpq_t **A;                  /* per system */
	struct stream **flow;
	double **growth;
	struct area *area, *at;     /* per region; where it is */
	int region;
	bool *resting; /* per switching function: it stands on a breakpoint, exactly, while the region stays */
	mpq_t base;                 /* [s] */
	mpfi_t *x, *y;              /* x at that time, in the equations of `at` */
	struct deviation *deviation;
	mpq_t *exact;               /* x at the start; NULL: it is not rational */
	struct trajectory_grid grid;
	struct trajectory_piece piece;
	struct trajectory_fresh fresh;
	struct trajectory_list noted;
	/* Of impacts.c: */
	double time;                /* base [s] */
	pl_chain chain;
	const struct law *law;      /* impacts of this segment of time; NULL: none yet */
	struct event_state *event_state;
	const char *undecided;
};

/* ---- areas.c: regions as they are met, loads at a time ---- */

void trajectory_row(const struct trajectory *t, const struct output *output, mpq_t *row); /* over x, now */
mpq_t *trajectory_row_of(const struct trajectory *t, const struct output *output);
void trajectory_dot(const struct trajectory *t, const mpq_t *row, const mpfi_t *x, mpfi_ptr sum);
mpq_t *trajectory_times(const struct trajectory *t, const mpq_t *row, const mpq_t *A);  /* row A */
struct area *trajectory_area(struct trajectory *t, int region);
/* Whether both let go at the same time, always: what slides with one velocity */
bool trajectory_meets(const struct trajectory *t, const struct guard *one, const struct guard *other);
void trajectory_enter(struct trajectory *t, int region);
void trajectory_loads(struct trajectory *t);                 /* load states at base */
const char *trajectory_time(mpq_srcptr time);
bool trajectory_lost(struct trajectory *t, const struct guard *guard, const char *what); /* false: it is not known */

/* ---- deviation.c: x as a core that is known to rounding, and how far it may be off that ---- */

struct deviation {
	mpfi_t *core, *next_core;   /* here; behind what is tried */
	struct turned_box {         /* off by Q r, |r_k| at most radius_k 2^unit; Q orthogonal but for rounding */
		long unit;
		double *axis, *radius; /* axis: columns of Q, one after the other; where the radius is 0, any */
	} now, next;
	mpfi_t *next_x;             /* next_core and next */
	struct map {                /* n x n: what takes the deviation on, and how far off its entries may be */
		double *entry, *slack;
	} map, *piece;              /* piece: per system, over a piece; NULL: not made yet */
	struct series_room room;    /* of the core */
	mpfi_t *before;             /* x where an event began */
	mpq_t *jump;                /* what it has made of that so far, n x n */
	int jumps;                  /* in so many assignments */
};
void deviation_make(struct trajectory *t);
void deviation_free(struct trajectory *t);
void deviation_renew(struct trajectory *t);     /* all that x is wide is a box from here on */
void deviation_over_piece(struct trajectory *t); /* next by e^{A piece}, which stream_pieces has made; next_x */
/* The polynomial of the core and, in piece.room, of x, as by stream_expand; returns its degree */
int  deviation_expand(struct trajectory *t, mpq_srcptr tau);
/* The core, `next` and next_x by e^{A s tau}, with the polynomials of tau */
void deviation_over_part(struct trajectory *t, int degree, mpq_srcptr tau, mpfr_srcptr s);
void deviation_take(struct trajectory *t);      /* x, core and deviation are those behind it */
void deviation_loads(struct trajectory *t);     /* loads are known there */
void deviation_begin(struct trajectory *t);     /* an event, with x as it is now */
/* of x so many states become what the rows make of it, all of the same x */
void deviation_assign(struct trajectory *t, int count, const int *state, mpq_t *const *row);
/* From the equations `before` to those here where the guard is met, at most `off` from where the event began: x, core
 * and deviation behind what was assigned since; false: it is too wide for that, and nothing is changed */
bool deviation_cross(struct trajectory *t, const struct guard *guard, const struct stream *before, mpfr_srcptr off);

/* ---- passes.c: the first event of a piece, and what is behind it ---- */

bool trajectory_event_free(struct trajectory *t, const mpfi_t *y, double tau); /* nothing is met up to y, tau on */
/* In t->room, of that degree: 1: found; -1: not known; 0: none. at: s */
int  trajectory_first(struct trajectory *t, int degree, mpq_srcptr tau, const struct guard **found, mpfi_ptr at);
bool trajectory_pass(struct trajectory *t, const struct guard *guard, int degree, mpq_srcptr tau, mpfi_srcptr at);

/* ---- noted.c: the list of crossings, and where switching functions stand ---- */

/* of e - at: 1 above, -1 below; 0: not told apart */
int  trajectory_side(const struct trajectory *t, int function, mpq_srcptr at);
void trajectory_note(struct trajectory *t, const struct guard *guard, mpfr_srcptr off);
void trajectory_note_plain(struct trajectory *t, int function, int breakpoint, bool upward, mpfr_srcptr off);

#endif
