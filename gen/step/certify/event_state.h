/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a verified trajectory does where contacts are. */
#ifndef PLGEN_EVENT_STATE_H
#define PLGEN_EVENT_STATE_H

#include "trajectory.h"

struct event_state {                /* of what happens at one instant */
	const struct guard *met;    /* NULL: none */
	mpfr_srcptr off;            /* how far from base it may be; NULL: nothing is listed */
	int before;                 /* the region before it */
	unsigned acted;             /* impacts that have acted, as bits */
	int begins;                 /* the impact whose guard was met, before it acts; -1 */
	int doubtful;               /* the contact of which it is not known whether a force presses it; -1: none */
	int swept;                  /* speeds taken from what comes to rest */
	bool together;              /* several come to rest together */
	bool flies, bounces;        /* of the contact that was looked at last: its flights [s], not all at once */
	mpfi_t flight;
};

/* ---- signs.c: signs, and where what was held goes ---- */

/* Of row . x - less: its sign, 0 where it is 0; *known false: it is not told apart from 0 */
int  trajectory_sign(const struct trajectory *t, const mpq_t *row, mpq_srcptr less, bool *known);
/* Whether all of an enclosure is 0 to half of the bits, BITS_OF_ONE or fewer, of such a size, or of 2^-64 */
bool trajectory_is_none(const struct trajectory *t, mpfi_srcptr value, double size);
double trajectory_size(const struct trajectory *t, const mpq_t *row); /* what row . x may be summed from */
bool trajectory_unknown(struct trajectory *t, const char *what); /* false */
/* States, all from the same state, by rows over x */
void trajectory_assign(struct trajectory *t, int count, const int *state, mpq_t *const *row);
void trajectory_hold(struct trajectory *t);                  /* states that the region gives */
/* The side to which a switching function on a breakpoint moves in a region, by its first derivative that is not 0;
 * still: its first one is but rounding */
int  trajectory_heads(const struct trajectory *t, const struct area *area, int function, bool still, bool *known);
/* A slider without mass whose velocity an event has turned round sticks from there on. */
bool trajectory_slide(struct trajectory *t, const struct guard *guard, mpfr_srcptr off);
/* its switching function is 0 now: how often */
void trajectory_let_go(struct trajectory *t, const struct guard *guard);

/* ---- impacts.c: impacts, what comes to rest by them, what sticks and what slips ---- */

/* guard: what was met, NULL: nothing; off NULL: what changes is not listed */
bool trajectory_resolve(struct trajectory *t, const struct guard *guard, mpfr_srcptr off);
bool trajectory_take_up(struct trajectory *t, mpfr_srcptr off); /* behind a change of the loads */
bool trajectory_impact(struct trajectory *t, const struct guard *guard, mpfr_srcptr off);

/* ---- begun.c ---- */

bool trajectory_place(struct trajectory *t);                 /* the region of the start */

#endif
