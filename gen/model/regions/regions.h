/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Piecewise-linear equations as regions with linear ones. */
#ifndef PLGEN_MODEL_REGIONS_H
#define PLGEN_MODEL_REGIONS_H

#include "model/model.h"

struct switching_function;
struct friction;
struct hold;
struct release;
struct slide;
struct slider;

struct region {                     /* one interval for each switching function, in one segment of time */
	bool possible;              /* its inequalities can hold together */
	int system;                 /* index of its equations; equal ones are one */
	struct form **residual;     /* per row: linear; friction stands in it as an atom until its force is put in */
	struct form **force, **rest; /* per friction: F, and what it holds up to at rest; NULL: none acts here */
	struct form **carried;      /* per friction's atom: what it carries, as it stands on the left side */
	struct output **friction_force; /* per friction that outputs read: the same as a row; NULL: nothing */
	struct slide *slide;        /* per slider's atom */
	int holds, releases;
	struct hold *hold;
	struct release *release;
};
struct sign { mpq_t number; bool least; };  /* by which something was decided; least: by its being at least 0 */
struct switching {
	int rows, *row;             /* of the equations that it is of */
	int functions;
	struct switching_function *function;
	int segments;               /* of time: those of the model, or 1 where nothing of it changes */
	/* all, possible or not: products of the switching functions' intervals, of each segment of time in order */
	int regions;
	struct region *region;      /* NULL where there are parts */
	/* The target makes the matrices of regions that it meets, A of the first one and what an interval of each
	 * switching function adds to it: `region` has the first of each segment of time, in which all intervals are
	 * the lowest, and those beside it in which one is not. slots: so many are kept; 0: as many as are small */
	bool cached;
	int slots;
	bool many, many_in_time;    /* too many for tables of all of them; in all segments together */
	int systems;
	/* where there are parts one: that of the first region of each; one segment of time */
	struct linear *system;
	int aparts;
	const struct node **apart;  /* terms that share no switching function with others */
	bool torn;                  /* one has become such: the search begins anew */
	/* per system: a segment in which it serves; there switching functions are the same in all */
	int *system_segment;
	int parts;                  /* 0: its regions are those of all coordinates together */
	struct region_part *part;
	int frictions;
	struct friction *friction;
	int sliders;
	struct slider *slider;
	int impacts;                /* the model's */
	struct impact *impact;
	/* Friction of which outputs read what it carries, as they have it, for all time; NULL: a highest derivative */
	int transmitted_forces;
	const struct atom **transmitted;
	int *highest;               /* per coordinate: which of them is its highest derivative; -1: none */
	int signs;                  /* where there are factors */
	struct sign *sign;
	int sharing;                /* parts that have these regions together, since rigid-body modes couple them */
};
/* Coordinates that nothing outside of them acts on, in no region: they have regions of their own, and cross breakpoints
 * at times of their own. */
struct region_part {
	int coord;                  /* the first */
	struct model *model; /* of them alone; its `switching` has no switching functions where they are linear */
	int *state;                 /* per state of it: that of the whole model */
	int *input;                 /* likewise of the inputs that act on it or are in its switching functions */
	int *function;              /* likewise */
};

/* ---- regions.c: piecewise-linear equations as regions with linear ones ---- */

bool is_piecewise_linear(const struct building *b);
int  interval_of(const struct switching *s, int region, int function);
int  segment_of_region(const struct switching *s, int region);      /* of time */
int  regions_at_once(const struct switching *s);                    /* in one segment of time, possible or not */
/* one interval up, or down; -1: it is not listed */
int  region_above(const struct switching *s, int region, int function);
int  region_below(const struct switching *s, int region, int function);
int  beside_lowest(const struct switching *s, int segment, int function, int interval);    /* where all are cached */
/* Of regions that are cached, the switching function by which a state is held; -1: none */
int  owner_of_hold(const struct switching *s, int state);
bool caches_regions(const struct model *model);                     /* the target makes their matrices */
int  region_numbers(const struct switching *s);                     /* numbers that regions may have in one of them */
bool is_form_multiple(const struct form *form, const struct form *e, mpq_ptr of);   /* of: the factor */
int  breaks_of_all(const struct switching *s);               /* breakpoints of all its switching functions */
int  possible_regions(const struct switching *s);

/* ---- parts.c: regions of independent coordinates ---- */

bool has_too_many_regions(struct building *b);              /* also finds them, where that can be done */
void find_regions(struct building *b);                      /* says what cannot be treated */
/* of a region of a part in the number of the model's: its intervals, by the strides of the whole */
int  share_of_region(const struct region_part *part, const struct switching *full, int region);
void place_region_loads(struct building *b);
/* their systems; after the loads of all have their places */
void build_regions(struct building *b);

/* ---- sides.c: what decides ---- */

/* What a decision on the sign of `d` makes of it: a product is decided by its factors of odd power. */
void visit_surfaces(const struct form *d, void (*visit)(void *context, const struct form *g), void *context);
/* All forms on whose signs an atom decides itself */
void visit_decisions(const struct atom *a, void (*visit)(void *context, const struct form *d), void *context);

#endif
