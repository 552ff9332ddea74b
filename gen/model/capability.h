/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is so of a model and its step, and what stands against what is asked of them: capability.def. */
#ifndef PLGEN_MODEL_CAPABILITY_H
#define PLGEN_MODEL_CAPABILITY_H

#include "model/model.h"

/* ---- capability.c: what goes with what ---- */

enum { MOST_ROW_LOADS = 16 };       /* each column takes numbers of its own to build, powers of t large ones */

enum flow {                         /* how a state goes on, without events */
	FLOW_LINEAR,                /* e^{A tau}: there is no remainder */
	FLOW_RECIPE,                /* a list of actions on stages and remainders */
	FLOW_SERIES,                /* the Taylor series of the solution */
	FLOW_COLLOCATION,           /* polynomials that solve the equations at nodes; beside them a series, or none */
	FLOW_NORMAL                 /* normal modes, and the remainder as forces on them */
};
enum flow flow_of(const struct model *model);
struct descriptor {                 /* what a step is made of, as its model says */
	enum flow flow;
	enum {
		EVENTS_NONE,
		EVENTS_OF_REGIONS,
		EVENTS_SPLIT
	} events;   /* SPLIT: the step is cut at events; else a series */
	bool tuned; /* coefficients are of an instance, of a large step those of some blocks; else constant */
	bool two_words;             /* accumulation */
	bool many;                  /* width: NAME_batch too */
	bool apart;                 /* layout: independent parts, each with regions of its own, or linear */
};

struct facts {
#define FACT(name, is) bool name;
#define STEP_FACT(name) bool name;
#include "model/capability.def"
};
enum capability {
#define REQUESTED(name, words) CAN_##name,
#include "model/capability.def"
	CAPABILITIES
};
struct facts facts_of_model(const struct model *model);      /* as far as it is built; those of its step are false */

struct objection { const char *why, *way; };                 /* the reason; a hint, or NULL */
/* What stands against it; why is NULL where nothing does */
struct objection objection_to(enum capability requested, const struct facts *f, const struct model *model);
/* leaves the statement where it does */
void refuse(enum capability requested, const struct model *model, struct place at);
const char *words_before(enum capability requested);             /* before a reason */

bool steps_exactly(const struct model *model);               /* by scheme exact, or by one that nothing is left to */
bool goes_by_events(const struct model *model);              /* friction, impacts, jumps */
bool is_measured(const struct model *model);                 /* no bound is known: it is not linear, or in pieces */
bool has_peak(const struct model *model);                    /* some output is one */
int  output_named(const struct model *model, const char *name); /* its index; -1: there is none */

#endif
