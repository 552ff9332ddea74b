/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What all emitters write with, and what symbols are called. */
#ifndef PLGEN_EMIT_TEXT_H
#define PLGEN_EMIT_TEXT_H

#include "step/step.h"

struct printers;
struct region_part;

/* ---- text.c: what all emitters write with ---- */

struct standing {                   /* what is not in s: C per state, output, input; of an output NULL: not wanted */
	const char **state, **output, **input, **slope;
	bool since;                 /* phases and envelopes in s are those of the last refresh */
};
struct emitter {
	FILE *to;
	const struct step *step;
	const struct printers *prints; /* what its step has of its own */
	const struct model *model;
	const struct linear *system;
	const char *name, *upper;   /* scs, SCS */
	/* of independent parts of a piecewise-linear model the one that is printed; NULL: none */
	const struct region_part *part;
	struct {                    /* of that part, as say() spells them */
		const char *own;    /* what its names begin with, scs_part1; else the name */
		const char *place;  /* its index, [1]; else nothing */
		const char *degree; /* the first part's whose polynomials are of its degree */
		const char *columns; /* of a row of a series' coefficients: the states, and what breakpoints divide */
	} spelled;
	const char *options;
	struct identifiers *c;      /* of every symbol */
	const char **local;         /* per state: the C local that holds it */
	int phases, envelopes;        /* in the state */
	int *phase, *envelope;        /* per load: index of its phase and of its envelope; -1: none */
	bool ramps;                 /* some input is of first order */
	struct {                    /* of phasors */
		int states;         /* load states in the state, at the last refresh */
		int *phasor;        /* per load: index of its first there; -1: none */
		bool keeps;         /* load states are written where the refresh keeps them */
	} refresh;
	const char **sample;        /* of a block of steps: per column of its inputs; NULL: of one step */
	bool at_node;               /* load states are those at `node` of the step, not at its start; */
	const char *after;          /* those this long after now [s]; NULL: not so */
	struct emitter *beside;     /* per block of the step's derivatives: of its model */
	bool is_beside;             /* it is of such a block, as a model of its own */
	const struct standing *at;  /* where numbers of derivatives stand; NULL: as they do in s */
	bool drawn;                 /* of the outputs those alone that a page draws, which else are left out */
	bool at_state;              /* of a series: what is known beside the state stands in locals */
	bool wide;                  /* over lanes: a state is pl_lanes y[i], of as many instances; */
	const int *own;             /* where in factor[] the table of each group begins */
	const char *device;         /* what tables of a kernel begin with, __constant; NULL: those of C */
	const struct emitter *members; /* prints what declares tables of an instance, to it; NULL: not so */
};
/* The only writer: a printf format in which $n is the model's name and $N the same in capitals, $o and $p a part's own
 * name and place, $d that of the first part of its degree, $c the columns of a series, $$ a dollar. */
void say(const struct emitter *e, const char *layout, ...) __attribute__((format(printf, 2, 3)));
/* the same as text */
const char *spell(const struct emitter *e, const char *layout, ...) __attribute__((format(printf, 2, 3)));
/* Behind a blank line and the note, NULL: none, what is before the body, which begins; the end of it, before which
 * stand the names that nothing may have read, blanks or commas between */
void open_function(const struct emitter *e, const char *note, const char *layout, ...)
	__attribute__((format(printf, 3, 4)));
void close_function(const struct emitter *e, const char *unread);
void emit_if_any(void (*printer)(const struct emitter *e), const struct emitter *e);  /* NULL: none */
void put(FILE *to, const char *text, size_t length);              /* of finished C, as it is */
/* static const int NAME_name[]; of none there is a 0 */
void emit_int_list(const struct emitter *e, const char *name, int count, const int *value);
void emit_integers(const struct emitter *e, const char *type, const char *name, int count, const int *value);
/* static const TYPE NAME_name = {{...}, ...}; the name has its dimensions, as entry[7][3] */
void emit_integer_rows(const struct emitter *e, const char *type, const char *name, int rows, int columns,
		       const int *value);
/* Members of NAME_coeffs: of the spec's values, numbers between the two; or in declare_members what declares them */
void open_member(const struct emitter *e, const char *type, const char *name, const char *shape, const char *note);
void close_member(const struct emitter *e);
void number_member(const struct emitter *e, const char *name, const char *value, const char *note);
void declare_members(const struct emitter *e, void (*print)(const struct emitter *e));
void emit_nominal_of(const struct emitter *e, void (*print)(const struct emitter *e));    /* NAME_nominal */

struct summands {
	int terms;
	const char **term;
};
void add_summand(struct summands *s, const char *text);
const char *sum_of(const struct summands *s, int indent);         /* as a tree; of none 0.0 */
void say_wrapped(const struct emitter *e, const char *text);      /* a statement, broken where it is long */
/* const double name[count] = {...}; NULL: 1 */
void say_vector(const struct emitter *e, const char *name, int count, const char *const *text);
const char *integer_text(int number);
/* Lines of a comment that stands open, broken between words */
void say_words(const struct emitter *e, const char *text);
/* A comment, broken where it is long; no word of it is longer than a line */
void say_comment(const struct emitter *e, const char *indent, const char *text);
/* Behind a blank line a comment: an algorithm of the runtime and what it is for, the first sentence of its text */
void say_purpose(const struct emitter *e, const char *algorithm);
void say_include(const struct emitter *e, const char *algorithm);
/* For an algorithm that the file includes: PL_NAME, as it is called there; nothing, where numbers.h says the same */
void say_macro(const struct emitter *e, const char *name, const char *text);
const char *scaled(double factor, const char *operand);           /* operand NULL: 1 */
/* rounded; an error at the step where it overflows */
double finite_number(const struct emitter *e, mpq_srcptr q);
void emit_number_rows(const struct emitter *e, int rows, int columns, const double *value, const char *const *row_note);
void emit_inner_matrix(const struct emitter *e, int rows, int columns, const double *value,
		       const char *const *row_note);
/* static const double NAME_name[size[0]]...[size[dimensions - 1]], behind a blank line and the note, NULL: none; `row`:
 * of those of the last dimension, NULL: nothing is said of them */
const char *state_vector(const struct emitter *e);                /* s->y, or over lanes y */
const char *table_words(const struct emitter *e);                 /* static const */
void emit_array(const struct emitter *e, const char *note, const char *name, int dimensions, const int *size,
		const double *value, const char *const *row);
void emit_name_list(const struct emitter *e, const char *array, int count, const char *const *name);
const char *low_text(mpq_srcptr q);                               /* what its rounding leaves out, rounded */
const char *two_text(mpq_srcptr q);                               /* {hi, lo} */

/* ---- identifiers.c: what symbols are called in C ---- */

/* What every symbol is called; `local` receives the same of every state. */
struct identifiers *identifiers_of(const struct model *model, const char *upper, const char **local);
const char *c_name(const struct identifiers *c, const struct symbol *s, int order); /* of it, of its first derivative */
const char *written_local(const struct identifiers *c, const struct model *written, int state); /* of a written state */

#endif
