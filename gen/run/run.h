/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The C of a model, run inside the generator: what it does is measured before it is published. */
#ifndef PLGEN_RUN_H
#define PLGEN_RUN_H

#include "emit/emit.h"

/* The C that the emitters write, and no more of the language: numbers, arrays, structs, pointers, loops and functions
 * that call no function which is not done yet; no goto, no pointer to a function, no recursion. What is not read is not
 * looked at: a function is compiled when another first calls it, a table filled when it is first named. */

/* ---- lexeme.c: a text to lexemes, macros without arguments put in ---- */

enum lexeme_kind { LEXEME_END, LEXEME_NAME, LEXEME_NUMBER, LEXEME_STRING, LEXEME_MARK };
struct lexeme {
	enum lexeme_kind kind;
	const char *text;
	unsigned mark;              /* of LEXEME_MARK: its characters, the first lowest */
	bool real, single;          /* of a number: it has a point or an exponent; it ends with f */
	bool wide, positive;        /* of a whole one: 64 bits; unsigned */
	double x;
	uint64_t n;
};
#define MARK(a) ((unsigned)(a))
#define MARK2(a, b) (MARK(a) | MARK(b) << 8)
#define MARK3(a, b, c) (MARK2(a, b) | MARK(c) << 16)
struct lexemes { int count; struct lexeme *list; };
struct lexemes lexemes_of(struct place at, const char *text);

/* ---- operation.c: what runs ---- */

enum ctype_kind { CTYPE_VOID, CTYPE_WHOLE, CTYPE_REAL, CTYPE_POINTER, CTYPE_ARRAY, CTYPE_STRUCT };
struct ctype {
	enum ctype_kind kind;
	size_t size, align;
	bool positive;              /* of a whole number: unsigned */
	const struct ctype *of;     /* of a pointer, of an array */
	int count;                  /* of an array; -1: as many as it is filled with */
	int members;
	struct ctype_member { const char *name; const struct ctype *type; size_t offset; } *member;
};
/* Nothing recurs, so each variable has one place for good, and an operation has the address in it. */
enum going { GOES_ON, BREAKS, CONTINUES, RETURNS };         /* after a statement */
struct operation {
	union {                     /* by what its type is: */
		int64_t (*whole)(const struct operation *o);
		double (*real)(const struct operation *o);      /* of a float too, rounded to one */
		void *(*place)(const struct operation *o);      /* a pointer; where an array or a struct is */
		enum going (*act)(const struct operation *o);   /* a statement */
	} go;
	const struct ctype *type;   /* NULL: a statement */
	bool stored;                /* go.place says where its value is, whatever the type: see value_of */
	const struct operation *a, *b, *c, *d;
	const struct operation *const *list;
	int count;
	void *at;
	int64_t n;
	double x;
};
extern const struct ctype ctype_void, ctype_char, ctype_short, ctype_int, ctype_unsigned, ctype_long, ctype_wide,
	ctype_double, ctype_float;
/* What has run so far, as step/cost.c counts it: quotients are products, a call is one of <math.h>. Of what the runtime
 * does with arrays it is an estimate. */
extern struct counted { uint64_t multiplications, additions, calls; } counted;
const struct ctype *pointer_to(const struct ctype *type);
const struct ctype *array_of(const struct ctype *type, int count);
struct operation *number_whole(const struct ctype *type, int64_t n);
struct operation *number_real(const struct ctype *type, double x);
struct operation *stored_at(const struct ctype *type, void *at);                    /* a variable */
struct operation *stored_where(const struct ctype *type, const struct operation *place, size_t offset);
const struct operation *value_of(const struct operation *o);  /* read; of an array a pointer to its first */
const struct operation *place_of(const struct operation *o);  /* where it is stored */
/* NULL: these operands have no such operation */
const struct operation *converted(const struct operation *o, const struct ctype *type);
const struct operation *combined(unsigned mark, const struct operation *a, const struct operation *b);
const struct operation *negated(unsigned mark, const struct operation *a);        /* - + ! ~ */
const struct operation *element_of(const struct operation *a, const struct operation *index);
const struct operation *assigned(const struct operation *to, const struct operation *value);
const struct operation *chosen(const struct operation *condition, const struct operation *a, const struct operation *b);
const struct operation *stepped(const struct operation *o, int by, bool after);   /* ++ and -- */
const struct operation *in_sequence(const struct operation *a, const struct operation *b); /* a, then the value of b */
const struct operation *as_condition(const struct operation *o);                  /* whole: 0 or not */

/* ---- flow.c: statements ---- */

const struct operation *act_evaluate(const struct operation *o);
const struct operation *act_clear(void *at, size_t size);
const struct operation *act_list(int count, const struct operation *const *list);
const struct operation *act_if(const struct operation *condition, const struct operation *yes,
			       const struct operation *no);
/* while (condition) { body; next; }; `late`: the condition is asked after the body */
const struct operation *act_loop(const struct operation *condition, const struct operation *next,
				 const struct operation *body, bool late);
/* into the list's statement with the number `cases` has for the value, at the end -1 for the others */
struct switch_case { bool others; int64_t value; int to; };
const struct operation *act_switch(const struct operation *value, const struct operation *list, int cases,
				   const struct switch_case *of);
const struct operation *act_leave(enum going going);
const struct operation *act_return(const struct operation *store);
const struct operation *act_body(const struct operation *list);                  /* of a function: its return ends it */

/* ---- library.c: the functions of the runtime and of <math.h> ---- */

union word { int64_t whole; double real; void *place; };
struct library_function {
	/* type, the result first: i, l, u whole, d, f real, p pointer, s a struct, by where it is, v none */
	const char *name, *type;
	const char *structure;      /* of a result that is one: its name */
	void (*run)(union word *result, const union word *argument); /* of a struct: result->place says where to */
	double (*real)(double x);   /* of one number: that alone */
	int multiplications, additions; /* that it takes, beside */
	enum { TAKES_NO_MORE, TAKES_CALL, TAKES_MATRIX, TAKES_FACTORS, TAKES_SOLUTION, TAKES_PIECES } takes;
};
const struct library_function *library_function(const char *name); /* NULL: it has none of this name */
extern const char library_types[];                          /* its structs, in C */
const struct operation *library_call(const struct library_function *f, const struct ctype *result, int arguments,
				     const struct operation *const *argument);

/* ---- declare.c: types and names ---- */

enum entity_kind { ENTITY_TYPE, ENTITY_NUMBER, ENTITY_VARIABLE, ENTITY_FUNCTION };
struct entity {                     /* what a name stands for */
	enum entity_kind kind;
	const char *name;
	const struct ctype *type;   /* of a function: its result */
	int64_t number;
	void *at;                   /* of a variable */
	int filled, body;           /* place of a table's numbers, of a function's body; 0: none, or done */
	int parameters;
	struct entity **parameter;
	void *result;               /* of a function */
	void *shared;               /* of a parameter: while a call is being compiled, where its argument waits */
	const struct operation *act; /* its body, once compiled */
	struct entity *next;        /* the one declared before */
};
struct code {                       /* a text, being compiled as it is called */
	struct place at;            /* whom what cannot be run is told at */
	struct lexemes lexemes;
	int here;                   /* the lexeme to be read next */
	struct entity *newest;      /* names in scope, the last declared first */
	struct entity *tagged;      /* structs */
	struct entity *outside;     /* the newest name outside of functions */
	const struct ctype *result; /* of the function being compiled */
	void *result_at;
	int calls;                  /* that were read so far */
	/* what declarations and expressions ask of files that use theirs: the value of a constant expression; an act
	 * that is the function's body */
	int64_t (*constant)(struct code *c);
	const struct operation *(*body)(struct code *c, struct entity *function);
};
_Noreturn void not_run(const struct code *c, const char *what);     /* leaves the statement */
const struct lexeme *peek(const struct code *c);
bool is_next(const struct code *c, unsigned mark);
bool is_word_next(const struct code *c, const char *word);
bool take_mark(struct code *c, unsigned mark);                    /* true: it was next, and is behind */
bool take_keyword(struct code *c, const char *word);
void need(struct code *c, unsigned mark);
const char *take_name(struct code *c);
struct entity *entity_find(const struct code *c, const char *name); /* NULL: there is none */
struct entity *entity_new(struct code *c, enum entity_kind kind, const char *name, const struct ctype *type);
bool is_type_next(const struct code *c);
const struct ctype *read_type(struct code *c);               /* specifiers: static const double */
struct declared {
	const char *name;
	const struct ctype *type;
	bool function;
	struct entity *parameter;
	int parameters;
};
/* what follows it: *const x[2]; name NULL: of a cast. Parameters are entities that are in no scope yet */
struct declared read_declarator(struct code *c, const struct ctype *type);
void read_outside(struct code *c);                           /* all that stands outside of functions */

/* ---- expression.c ---- */

const struct operation *read_operation(struct code *c);     /* with commas */
const struct operation *read_assignment(struct code *c);     /* without; its value */
int64_t read_constant(struct code *c);
/* Of a variable `to`, from what is next: acts are added to the list, but for numbers where it is filled `now`; *type
 * gets the count of an array that has none, and its place is made here */
struct acts { bool now; int count; const struct operation **list; };
void add_act(struct acts *acts, const struct operation *act);
void *read_filling(struct code *c, struct acts *acts, const struct ctype **type, void *to);

/* ---- statement.c ---- */

const struct operation *read_body(struct code *c, struct entity *function);

/* ---- code.c: the C of a step, and calls of its functions ---- */

/* `at`: the place of whoever wants it run; rhs: with NAME_rhs */
struct code *code_of_step(struct place at, const struct step *step, bool rhs);
struct running;                     /* an instance */
/* one of a model; what its functions need is compiled now, and may leave the statement; then the text goes */
struct running *running_new(struct code *code, const struct step *step);
const struct step *running_step_of(const struct running *r);
void   running_start(struct running *r, double t, const double *y);  /* any state; y NULL: the spec's, at 0 */
void   running_step(struct running *r, const double *u);     /* by h */
void   running_state(struct running *r, double *y);
double running_time(struct running *r);
void   running_outputs(struct running *r, double *out);
int    running_status(struct running *r);
void   running_rhs(struct running *r, double t, const double *y, const double *u, double *slope);

/* ---- drive.c: inputs that are tried ---- */

struct sampled {                      /* samples at t = 0, h, 2 h, ... */
	int inputs;
	double h;                   /* [s] */
	long samples;               /* there are two more, for the ends of ramps */
	bool *ramps;                /* per input: straight between samples; else a sample holds until the next */
	double *sample;             /* [sample][input] */
};
/* One of drive_kinds(count): within `most`, by the frequencies w [rad/s], in rising order */
struct sampled drive_of(const struct linear *system, int kind, const double *w, int count, double h, long samples,
		      const mpq_t *most);
int  drive_kinds(int count);
void drive_step(const struct sampled *d, long k, double *u);           /* what step k is given */
void drive_at(const struct sampled *d, long k, double t, double *u);   /* at t in step k: inputs, then their slopes */
void running_drive(struct running *r, const struct sampled *d, long k); /* as if k steps were done; a start follows */

/* ---- reference.c: the equations as written, solved by two roads ---- */

struct course {                     /* outputs at t = 0, h, 2 h, ... */
	long samples;               /* after the first */
	int outputs;
	double *value;              /* [sample][output] */
};
enum { ROADS = 2 };
struct roads {                      /* of NAME_rhs: two methods that have nothing in common but it */
	struct running *r;          /* in double */
	double h, until;            /* [s] */
	int changes;                /* of formula in time, at which a method starts anew */
	const double *change;
	uint64_t most;              /* operations that one may take */
	bool stiff;                 /* the implicit pair */
	double tolerance;           /* of a step, relative to the largest of each state */
	double *size;               /* that; NULL: not known yet */
	const struct sampled *drive;  /* with these inputs; NULL: there are none */
};
/* From these states (NULL: the spec's) by the first road or the second; NULL: *why */
struct course *road_of(struct roads *roads, int which, const double *start, const char **why);
/* at samples up to this one: the largest difference in an output, NaN where there is one; its largest size */
double apart(const struct course *a, const struct course *b, int output, long samples);
double largest_of(const struct course *a, int output, long samples);
void course_free(struct course *course);

/* ---- measure.c: how far the outputs of a step are off ---- */

enum { LIMIT_MEASURED = 400000000 };   /* operations of one road, or of one step that is tried */
struct trial {                      /* of a step, against a reference */
	double multiplications, additions, calls; /* of a step and its outputs, on average */
	const char *why;            /* it came to no end; NULL: it did */
	double *error;              /* per output: the largest, at every sample */
};
/* ends: per output, [s]: later errors do not count */
struct trial trial_of(struct running *r, const struct course *reference, const double *start, const double *ends,
		      const struct sampled *drive);

#endif
