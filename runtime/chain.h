/* SPDX-License-Identifier: MIT-0 */
/* chain.h: impacts that follow each other, for the runtime's own use: by guards.c and events.c.  Those of one instant
 * act one after the other; where that has no end they become slower and slower, and what touches comes to rest. */
#ifndef PLRT_CHAIN_H
#define PLRT_CHAIN_H

#include "roots.h"

/* How many impacts there may be at one instant before they are ended, and how many more before they are ended again;
 * how many are listed; how many events there may be in a step; how often speeds are taken from what comes to rest */
enum { MOST_AT_ONCE = 1000, SOME = 100, LISTED_AT_ONCE = 12, MOST_IN_STEP = 1 << 16, MOST_SWEEPS = 1000 };

/* CALM: of the fastest impact, what is slower is over.  BRIEF: of h, what is over by then is at rest.  SPAN: of h,
 * impacts within that follow each other in no time to speak of.  DEEP: so many times what rounding may have done is no
 * rounding any more.  TINY: below it all is 0, as what impacts have halved for ever without a force: sweeps that
 * leave 7/8 of a speed take it there before there are too many. */
#ifdef REAL_IS_FLOAT
#define CALM 0x1p-20f
#define BRIEF PL_BRIEFF
#define SPAN 0x1p-8f
#define TINY 0x1p-96f
#else
#define CALM 0x1p-48
#define BRIEF PL_BRIEF
#define SPAN 0x1p-10
#define TINY 0x1p-192
#endif
#define DEEP 64

/* Before the first impact of a step */
static inline pl_chain no_impact(real h)
{
    pl_chain chain;
    chain.last = -h;
    chain.most = chain.least = 0;
    chain.acting = 0;
    chain.close = chain.impacts = chain.ended = chain.all = chain.full = 0;
    return chain;
}

static void go_on(pl_chain *chain, real time, real h)
{
    if (time - chain->last > SPAN * h) {
        chain->most = 0;
        chain->close = 0;
    }
    if (time > chain->last) {
        chain->impacts = chain->ended = 0;
        chain->acting = 0;
    }
    chain->last = time;
}

/* One more event; 0: there have been too many in this step. */
static int has_time(pl_chain *chain)
{
    chain->full = ++chain->all > MOST_IN_STEP;
    return !chain->full;
}

/* One more impact, number k.  Whether it is listed: the list has the first ones of an instant and, once it is half
 * full, of no time to speak of. */
static int is_listed(pl_chain *chain, int k, int listed, int most)
{
    if (chain->impacts % (SOME / 2) == 0 && chain->ended == 0) {
        chain->acting = 0;
    }
    chain->acting |= (uint32_t)1 << k;
    chain->impacts++;
    chain->close++;
    return chain->impacts <= LISTED_AT_ONCE && !(2 * listed > most && chain->close > LISTED_AT_ONCE);
}

#endif
