/* SPDX-License-Identifier: MIT-0 */
/* What every model by hand has before taylor.h: steps by tolerance.  The model's file defines MODEL, MODEL_H,
 * MODEL_TOLERANCE, MODEL_AT (values between steps are asked for) and MODEL_series(y, h, c); MODEL_STATES, where it has
 * not two; MODEL_KINDS, 1: its even states are measured together and its odd ones, by the largest of them;
 * MODEL_BREAKPOINT, where its first state chooses the formulas there: MODEL_series_in(y, h, interval, c) then. */
#ifndef MODEL_STATES
#define MODEL_STATES 2
#endif
#ifndef MODEL_KINDS
#define MODEL_KINDS 0
#endif
#define PASTE(a, b) a##_##b
#define JOIN(a, b) PASTE(a, b)
#define PL(name) JOIN(MODEL, name)
#define PL_TYPE MODEL
#define PL_H ((real)(MODEL_H))
#define PL_TOLERANCE ((real)(MODEL_TOLERANCE))
#ifdef REAL_IS_FLOAT
#define PL_SINGLE 1
#endif
#define PL_STATES MODEL_STATES
#define PL_COLUMNS MODEL_STATES
#define PL_ORDER 12
#ifdef MODEL_BREAKPOINT
#define PL_SWITCHING_FUNCTIONS 1
#define PL_TERMS 1
#define PL_CHANGES 2
#define PL_MAX_EVENTS 8
#define PL_MAX_SPLITS 500
#endif
#define PL_ADAPTIVE 1
#define PL_REMAINDERS 3
#define PL_KINDS MODEL_KINDS
#define PL_KIND(i) ((i) % 2)
#define PL_OVER 1
#define PL_PARTS 1
#define PL_WRITTEN_OUT 0
#define PL_SERVES 1
#define PL_TRIES 1000
#define PL_NOW y
#define PL_AT MODEL_AT

#include "numbers.h"

#if PL_SWITCHING_FUNCTIONS
typedef struct PL(contact) {
	uint64_t total;
	int crossings, placed, interval[1];
	pl_crossing last, crossing[PL_MAX_EVENTS];
} PL(contact);

static const int PL(column)[] = {0}, PL(breaks)[] = {1};
static const real PL(breakpoint)[] = {MODEL_BREAKPOINT};
static const pl_series_switching PL(series_switching) = {1,          PL_COLUMNS, PL_ORDER,
                                                         PL(column), PL(breaks), PL(breakpoint)};
#endif

typedef struct MODEL {
	real y[MODEL_STATES], low[MODEL_STATES], t0;
	uint64_t k;
	int status, served, valid, most;
	real series[PL_ORDER + 1][MODEL_STATES], base[MODEL_STATES], next[MODEL_STATES], left[MODEL_STATES];
	real scale[MODEL_STATES], unit[MODEL_STATES];
#if PL_SWITCHING_FUNCTIONS
	PL(contact) contact;
#endif
} MODEL;

static const real PL(last)[1] = {PL_TOLERANCE}, PL(before_last)[1] = {PL_TOLERANCE};

static inline void PL(expand_from)(const MODEL *s, const real u[], const real slope[], real tau, real when, int segment,
                                   const int interval[], const real y[], real c[][MODEL_STATES], real terms[])
{
	(void)s, (void)u, (void)slope, (void)tau, (void)when, (void)segment, (void)interval, (void)terms;
#if PL_SWITCHING_FUNCTIONS
	PL(series_in)(y, PL_H, interval, c);
	terms[0] = pl_magnitude(y[0]);
#else
	PL(series)(y, PL_H, c);
#endif
}

static inline void PL(pass_time)(MODEL *s, const real u[])
{
	(void)u;
	s->k++;
}

#include "taylor.h"

#undef PASTE
#undef JOIN
#undef MODEL
#undef MODEL_H
#undef MODEL_AT
#undef MODEL_TOLERANCE
#undef MODEL_STATES
#undef MODEL_KINDS
#undef MODEL_BREAKPOINT
