/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a way through crossings does where contacts are. */
#ifndef PLGEN_STRUCK_H
#define PLGEN_STRUCK_H

#include "through.h"

struct telling {                    /* of what happens at one instant */
	const struct guard *met;    /* NULL: none */
	mpfr_srcptr off;            /* how far from base it may be; NULL: nothing is listed */
	unsigned struck;            /* impacts that have acted, as bits */
	int begins;                 /* the impact whose guard was met, before it acts; -1 */
	int doubtful;               /* the contact of which it is not known whether a force presses it; -1: none */
	int swept;                  /* speeds taken from what comes to rest */
	bool together;              /* several come to rest together */
	bool flies, bounces;        /* of the contact that was looked at last: its flights [s], not all at once */
	mpfi_t flight;
};

/* ---- settling.c: signs, and where what was held goes ---- */

/* Of row . x - less: its sign, 0 where it is 0; *known false: it is not told apart from 0 */
int  through_sign(const struct through *t, const mpq_t *row, mpq_srcptr less, bool *known);
/* Whether all of an enclosure is 0 to half of the bits, BITS_OF_ONE or fewer, of such a size, or of 2^-64 */
bool through_is_none(const struct through *t, mpfi_srcptr value, double size);
double through_size(const struct through *t, const mpq_t *row);      /* what row . x may be summed from */
mpq_t *through_row_of(const struct through *t, const struct output *output);
void through_assign(struct through *t, int state, const struct output *output, mpfi_t *fresh);
bool through_unknown(struct through *t, const char *what);   /* false */
void through_hold(struct through *t);                        /* states that the region gives */
/* The side to which an expression on a breakpoint moves in a region, by its first derivative that is not 0; still: its
 * first one is but rounding */
int  through_heads(const struct through *t, const struct area *area, int expression, bool still, bool *known);
/* A slider without mass whose velocity an event has turned round sticks from there on. */
bool through_slide(struct through *t, const struct guard *guard, mpfr_srcptr off);
void through_let_go(struct through *t, const struct guard *guard);   /* its expression is 0 now: how often */

/* ---- struck.c: impacts, what comes to rest by them, what sticks and what slips ---- */

/* guard: what was met, NULL: nothing; off NULL: what changes is not listed */
bool through_settle(struct through *t, const struct guard *guard, mpfr_srcptr off);
bool through_take_up(struct through *t, mpfr_srcptr off);   /* behind a change of the loads */
bool through_strike(struct through *t, const struct guard *guard, mpfr_srcptr off);

/* ---- begun.c ---- */

bool through_place(struct through *t);                       /* the region of the start */

#endif
