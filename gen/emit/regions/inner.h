/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of emit/regions have from one another, and nobody else. */
#ifndef PLGEN_EMIT_REGIONS_INNER_H
#define PLGEN_EMIT_REGIONS_INNER_H

#include "regions.h"
#include "step/regions/regions.h"

struct guards;

/* ---- region_tables.c: of regions, tables that there is one of for each matrix, and sums over their rows ---- */

/* Of the table chord_off */
#define CHORD_NOTE "How far each switching function leaves its chord over h, at most: this row times |x|"
#define OF_PIECE(table) offsetof(struct region_piece, table)     /* a table of each branch, by its place */

struct region_tables {
	const char *text;           /* of one of them: [row][column] follows */
	int rows, columns;
	int from, to;               /* of branches from .. to - 1 */
	double **value;             /* per branch */
	const bool *own;            /* rows x columns: tunable params may change it, an instance has it; NULL: none */
};
/* over x, of all branches; and the same of one */
struct region_tables tables_of_regions(const struct emitter *e, const struct pieces *p, const char *text, int rows,
				       size_t of);
struct region_tables of_branch(struct region_tables t, int branch);
/* e^{A h}; of a state in two words the same less I, second words behind the first */
struct region_tables steps_of_regions(const struct emitter *e, const struct pieces *p, const char *text);
bool acts_at(const struct region_tables *t, int row, int column); /* an entry is not 0 everywhere */
bool agree_at(const struct region_tables *t, int row, int column);
bool is_table(const struct region_tables *t);                     /* else all its entries are numbers in the text */
/* Sum of a row over the operands of its columns; further: a term more, or NULL */
const char *row_text(const struct region_tables *t, int row, const char *const *operand, const char *further,
		     int indent);
/* The largest that a switching function may be off its chord: `size` of the entries of x that are not bounded.  branch
 * -1: of all */
const char *off_text(const struct emitter *e, const struct pieces *p, int branch, int function,
		     const char *const *size, int indent);
int functions_of(const struct emitter *e);
bool any_pieces(const struct emitter *e);                         /* of h: then there are tables of all of it too */
const char **places(const struct emitter *e, const char *layout); /* of each entry of x: x[%d] */
const char **entries(const struct emitter *e, const char *layout); /* the same; "" where x is 1 */
const char *text_of_switching(const struct emitter *e, const struct pieces *p, int function,
			    const char *const *operand, int indent);
/* Sum of the sizes of those that are not bounded */
const char *size_of_x(const struct emitter *e, const struct pieces *p, const char *const *size, int indent);
/* Of a step with the fast path; `function`: names */
void emit_spans(const struct emitter *e); /* region by region: intervals of switching functions */
void emit_fast_path_tables(const struct emitter *e, const struct pieces *p, const char *const *function);

bool has_variation(const struct emitter *e);                      /* the step has derivatives beside it */
void emit_variation(const struct emitter *e, const struct guards *guards); /* tables of how tables vary */
void emit_own_variation(const struct emitter *e, const struct guards *guards); /* what of them an instance has */
struct variation;
void put_entries(const struct emitter *e, bool own, const char *name, const struct variation *v);
void emit_variation_macros(const struct emitter *e);
const char *no_variation(const struct emitter *e);                /* a last argument of the search; or nothing */
/* How the forcing of a load varies with a column; whether it does, or whether any load or input does */
struct varied_load { double a, w, p; };
bool vary_load(const struct emitter *e, int column, int load, struct varied_load *by);
bool acts_beside(const struct emitter *e, int column);
/* A step that derivatives share, in which ds goes on by NAME_vary_all or NAME_vary_clear; samples: u, du */
const char *sample_parameters(const struct emitter *e);
const char *sample_arguments(const struct emitter *e);
void declare_shared_step(const struct emitter *e);
void open_shared_step(const struct emitter *e);
void emit_shared_call(const struct emitter *e, const char *function, const char *last);
void emit_shared_search(const struct emitter *e, const char *x, const char *own); /* of both, or by $o_OWN of s alone */
void emit_seek(const struct emitter *e);                          /* from x; states are not there before */
void close_shared_step(const struct emitter *e);

/* ---- emit_parts.c: the parts, each as it would be alone ---- */

void for_parts(const struct emitter *e, int count, void (*emit)(const struct emitter *part));
void emit_linear_tables(const struct emitter *part);              /* of one without switching functions */
const char *start_of_search(const struct emitter *part);          /* the region where it begins */

/* ---- emit_regions.c, emit_guards.c, emit_ladder.c: their tables, a step ---- */

void emit_friction_forces(const struct emitter *e);               /* what friction carries, for outputs */
/* of dry friction and impacts in regions: their lists, numbers, descriptor */
void emit_guards(const struct emitter *e, const struct guards *guards);
/* the same where the target makes matrices */
void emit_guards_beside(const struct emitter *e, const struct guards *guards);
void emit_numbers_of_guards(const struct emitter *e, const struct guards *guards);
/* numbers of regions: a table of the file, or where params are tunable a member of NAME_coeffs */
void open_table(const struct emitter *e, const char *type, const char *name, const char *shape, const char *note);
/* whole numbers; own: of an instance */
void put_wholes(const struct emitter *e, bool own, const char *name, const char *note, int count, const int *number);
void put_numbers(const struct emitter *e, const char *name, const char *note, int count, const double *number);
void put_matrix(const struct emitter *e, const char *name, const char *note, int rows, int columns,
		 const double *value, const char *const *row_name);
void put_matrices(const struct emitter *e, const char *name, const char *note, int count, int rows, int columns,
		   double *const *value, const char *const *row_name);
double **of_branches(const struct emitter *e, const struct pieces *p, size_t of);
/* A row of each branch */
void emit_of_branches(const struct emitter *e, const struct pieces *p, const char *name, const char *note, int columns,
		      size_t of);
void close_table(const struct emitter *e);
/* emit_ladder.c: pieces shorter than h: where those of each matrix begin, their tables, what the descriptor has of
 * them, where `none` stands for numbers that are not read; how many there are, rows of each, and of what bounds them */
void emit_ladder_places(const struct emitter *e, const struct guards *guards);
void emit_spacing(const struct emitter *e);
void emit_ladder(const struct emitter *e, const struct pieces *pieces, const struct guards *guards);
const char *ladder_text(const struct emitter *e, const struct guards *guards);
/* of a part as of the whole: x from the state, in a step or at its start; its declaration, and room to work in; from
 * x, into the state; the same apart, where a step has the fast path */
void emit_region_vector(const struct emitter *e, bool step);
void declare_region_room(const struct emitter *e);                /* x, work */
void declare_region_vector(const struct emitter *e);              /* x, i */
/* own: what names of an algorithm begin with */
void begin_macros(const struct emitter *e, const char *algorithm, const char *own);
/* what search.h asks for; ladder: as ladder_text */
void emit_search(const struct emitter *e, const char *ladder);
void emit_region_start_call(const struct emitter *e);
void emit_segment_end(const struct emitter *e);                   /* of a step: in which segment outputs are */
bool regions_change(const struct emitter *e);                     /* they are others in each segment of time */
bool is_compensated(const struct emitter *e);                     /* the state has two words: its rests are behind x */
int size_of_vector(const struct emitter *e);                      /* of x, with them */
/* A list behind itself: first and second words */
const char **listed_twice(int count, const char *const *text);
/* emit_cached.c: of regions whose matrices the target makes: what these are sums of, where they are kept, none of them
 * yet, what search.h asks for */
#define cached_ladder \
	"{PL(first_rung), PL_KEPT(spacing), PL_KEPT(rungs)[0][0], PL_KEPT(bend)[0], PL(bend_rung)}"
void emit_cached(const struct emitter *e, const struct guards *guards);      /* NULL: crossings alone */
void emit_cached_member(const struct emitter *e);
void emit_cached_start(const struct emitter *e);
void emit_cached_macros(const struct emitter *e);
void emit_state_of_x(const struct emitter *e);                    /* the state from x; `i` is declared */
/* emit_cross.c: of a step with the fast path; emit_event_check.c: of one that is checked for events over h first */
void emit_crossing(const struct emitter *e, const struct pieces *p); /* what few.h calls, and asks for */
void emit_crossing_macros(const struct emitter *e, const struct pieces *p);
const char **operands_of_x(const struct emitter *e);               /* of a step: locals; "" where x is 1 */
void emit_event_check(const struct emitter *e);                   /* states and loads are in locals */
void emit_slopes_of_ramps(const struct emitter *e);                /* locals that operands_of_x names */
void emit_lanes_check(const struct emitter *e);                   /* the same check over lanes */

#endif
