/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * plgen: from the equations of a vibration model to C that steps it.
 *
 * Glossary.  The field's letters collide; in this program they mean:
 *   M, C, K    mass, damping and stiffness matrix of the equations as written
 *   P(s)       M s^2 + C s + K, the dynamic stiffness: P(s) Q(s) = (M s + C) q(0) + M q'(0) + F(s)
 *   B(s)       det P(s), the characteristic polynomial; its roots are the poles
 *   N/D        the image of one number in s: numerator and denominator, coprime
 *   Phi        transfer matrix over one step: y(t+h) = Phi y(t) + loads; y = coordinates, then velocities
 *   h, tau     the step; a time after the step's start
 *   w, p       angular frequency [rad/s] and phase [rad] of a load cos(w t + p)
 *   wave       a load cos(w t + p) or sin(w t + p); the two of one (w, p) share an oscillator
 *   held       terms that a scheme keeps at their value at the start of the step
 *
 * Data flow: source -> tokens -> nodes -> model (exact) -> images N/D (exact) -> poles, residues (enclosed)
 *            -> coefficients (rounded once) -> step program -> C, header, report.
 * No double stands before `coefficients`, the starting values of the root iteration excepted.
 */
#ifndef PLGEN_H
#define PLGEN_H

#include <gmp.h>
#include <mpfr.h>
#include <mpfi.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "plrt.h"           /* the cost of its routines */

#define PLGEN_VERSION "0.1.0"

/* Limits; each names itself in the message that it causes. */
enum {
	LIMIT_LINE = 1 << 20,       /* bytes of a line */
	LIMIT_NESTING = 1000,       /* brackets, signs and powers inside each other */
	LIMIT_EXPONENT = 9999,      /* of a literal such as 1e9999 */
	LIMIT_BITS = 1000000,       /* of an exact value */
	LIMIT_STATES = 512,
	LIMIT_CHANGES = 1000,       /* of formula in time */
	LIMIT_TUNABLES = 16,        /* params that the target may change */
	LIMIT_MONOMIALS = 64,       /* products of them in one factor of a state */
	LIMIT_REGIONS = 243,        /* of a piecewise-linear model */
	MAX_EVENTS = 32,            /* crossings in a step of generated code */
	LIMIT_PIECES = 16,          /* halvings of a step in which crossings are looked for */
	MAX_SPLITS = 500,           /* of intervals in search of them, in a step */
	LIMIT_WAVES = 500,          /* frequencies, phases and growths of loads */
	LIMIT_LOAD_POWER = 32,      /* exponent of a load, as in t^3 */
	LIMIT_UNROLLED_STATES = 16, /* beyond, a step loops over its tables */
	LIMIT_RESIDUE_STATES = 12,  /* beyond, a Taylor series gives the numbers: residues get slow */
	LIMIT_TURNS = 256,          /* log2 of a load's angle in a step, for models of more states than that */
	LIMIT_ERRORS = 100,         /* told before the rest is not looked at */
	LIMIT_DEPTH = 10000,        /* of an expression in operations, through params and lets; a function of many arguments counts as many */
	LIMIT_TERMS = 10000000,     /* of forms, made on the way to the equations */
	LIMIT_BYTES = 470000000,    /* held at a time */
	LIMIT_ROWS = 10000000,      /* of --solution */
	LIMIT_PRECISION = 16384,    /* bits of an enclosure before a coefficient is given up */
	IRRATIONAL_BITS = 256       /* pi, sqrt(2), ... become rationals of this many bits */
};

/* ---- memory.c: everything lives until the program ends; GMP, MPFR and MPFI allocate here too ---- */

void  memory_open(void);
void  memory_close(void);
void *allocate(size_t count, size_t size);                 /* zeroed */
void *enlarge(void *block, size_t count, size_t size);     /* contents kept, the rest undefined */
char *format(const char *fmt, ...) __attribute__((format(printf, 1, 2)));
mpq_t *rationals(size_t count);                            /* initialised to 0 */
void  rationals_free(mpq_t *q, size_t count);
void  discard(void *block);                                /* gives it back before the end; what it points to stays */
void  spend_terms(size_t count);                            /* from the budget of LIMIT_TERMS; gives up when it is spent */
#define NEW(type) ((type *)allocate(1, sizeof(type)))
#define ARRAY(type, count) ((type *)allocate(count, sizeof(type)))
#define ENLARGE(array, count) ((array) = enlarge(array, count, sizeof *(array)))

/* ---- progress.c: a line on a terminal for what takes longer than a second ---- */

void progress(const char *what, int done, int all);         /* done = 0 starts the clock */
void progress_end(void);                                    /* the line goes */

/* ---- source.c: texts, places in them, and what is said about a place ---- */

struct source {
	const char *name;           /* as the user named it */
	const char *base;           /* without folders: what generated text shows */
	const char *text;           /* ends with a 0 byte that does not count */
	size_t length;
	int order;                  /* in which they were opened: the spec first */
};
struct place {
	const struct source *source;
	size_t offset;
};
struct source *source_read(const char *path);              /* "-" is standard input; says what went wrong and returns NULL */
struct source *source_argument(const char *text);          /* a value from the command line */
struct place place_end(const struct source *source);       /* just after the last character of the last line */

/* An error is kept until diagnostics_print, which sorts by place. `error` does not return: it leaves the statement
 * through the innermost `statement_guard`. */
void say_error(struct place at, const char *note, const char *fmt, ...) __attribute__((format(printf, 3, 4)));
_Noreturn void error(struct place at, const char *note, const char *fmt, ...) __attribute__((format(printf, 3, 4)));
void work_at(struct place at);                             /* what is said to cost too much from now on */
struct place working_at(void);
_Noreturn void give_up(const char *message);               /* an error there, and the end: what is spent does not come back */
_Noreturn void abandon(void);                              /* leave the statement; its error has been said before */
void say_warning(struct place at, const char *note, const char *fmt, ...) __attribute__((format(printf, 3, 4)));
void say_note(struct place at, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
bool statement_guard(void (*work)(void *), void *context); /* true if the work ran to its end */
bool silent_guard(void (*work)(void *), void *context);    /* the same; what it says when it fails is forgotten */
void diagnostics_context(const char *note);                /* the note of what has none from now on; NULL: none */
int  diagnostics_errors(void);
void diagnostics_print(FILE *to);
void check_bits(struct place at, mpq_srcptr value);        /* the limit on exact values */
void check_power(struct place at, mpq_srcptr base, unsigned long exponent); /* the same, before the work */

/* ---- lex.c: text to tokens ---- */

enum token_kind { TOKEN_END, TOKEN_NUMBER, TOKEN_NAME, TOKEN_STRING, TOKEN_OPERATOR };
struct token {
	enum token_kind kind;
	struct place at;
	size_t length;
	char op[3];                 /* of TOKEN_OPERATOR */
	const char *name;           /* of TOKEN_NAME, without its primes */
	int primes;
};
struct lexer {
	const struct source *source;
	size_t position, end;       /* a statement: line ends inside brackets are white space */
};
/* Where the statement that starts at `from` ends: the line end outside brackets. `unclosed` receives the offset of a
 * bracket that no later text closes (the statement is then its line), else SIZE_MAX. */
size_t lex_statement_end(const struct source *source, size_t from, size_t *unclosed);
struct token lex_next(struct lexer *lexer);
const char *token_text(struct token token);                /* for messages: 'x1', the end of the line */
void lex_number(struct token token, mpq_ptr value);        /* the decimal, exactly */

/* ---- parse.c: tokens to nodes and declarations ---- */

enum function {
	FN_NONE, FN_SIN, FN_COS, FN_TAN, FN_EXP, FN_LOG, FN_SQRT, FN_ABS, FN_SGN, FN_SINH, FN_COSH, FN_TANH,
	FN_ASIN, FN_ACOS, FN_ATAN, FN_ATAN2, FN_MIN, FN_MAX, FN_DEADZONE, FN_CLIP, FN_TABLE
};
enum comparison { CMP_LT, CMP_LE, CMP_GT, CMP_GE, CMP_EQ, CMP_NE };
enum node_kind {
	NODE_NUMBER, NODE_PI, NODE_TIME, NODE_NAME,
	NODE_SUM,                   /* children added; those with `inverse` subtracted */
	NODE_PRODUCT,               /* children multiplied; those with `inverse` divide */
	NODE_POWER,                 /* two children */
	NODE_CALL,
	NODE_COMPARE,               /* two children */
	NODE_CHOOSE,                /* condition, then, else */
	NODE_MATRIX,                /* children row by row */
	NODE_FILE                   /* a matrix in a file */
};
struct node {
	enum node_kind kind;
	struct place at;            /* of the token that makes it: a name, an operator, a function */
	struct place start, end;    /* its text, brackets included */
	mpq_t number;
	struct symbol *symbol;      /* of NODE_NAME */
	int primes, component;      /* of NODE_NAME; component 0: the whole */
	int columns;                /* of NODE_MATRIX */
	const char *path;           /* of NODE_FILE */
	enum function function;
	enum comparison comparison;
	int depth;                  /* operations inside each other, those of the names in it included */
	int children;
	struct node **child;
	bool *inverse;              /* of SUM and PRODUCT, one per child */
	struct place *operator;     /* of SUM and PRODUCT: the sign before each child */
	enum { TIMELY_UNKNOWN, TIMELY, NOT_TIMELY } timely; /* reads nothing but t and params */
	struct kept *kept;          /* of one that is: its value, and when it holds */
};
struct span { mpq_srcptr after, before; };   /* of time; NULL: no bound */
enum symbol_kind { SYMBOL_PARAM, SYMBOL_COORD, SYMBOL_LET, SYMBOL_OUTPUT, SYMBOL_INPUT, SYMBOL_MATRIX };
struct symbol {
	enum symbol_kind kind;
	bool used, slope_used;      /* by the expressions now being printed */
	const char *c_name, *c_dot; /* C identifiers of it and of its first derivative */
	const char **c_component, **c_component_dot; /* of a vector coordinate */
	const char *name;
	struct place at;
	size_t statement;           /* offset of the statement that declares it */
	int index;                  /* among its kind, in the order of declaration; of a coordinate: of its first component */
	int length;                 /* of a vector coordinate; 0: scalar */
	bool broken;                /* its own statement failed: what uses it is passed over in silence */
	bool tuned, tuning_checked; /* it is tunable, or made of something that is; of that: tune.c has looked through its value */
	bool first_order;           /* of an input: hold first */
	int highest;                /* of a coordinate: its order, 1 or 2; of a let: 1 if it reads a highest derivative, else -1, 0 unknown */
	enum { TIME_UNKNOWN, TIME_READ, TIME_NOT_READ } time; /* of a let */
	bool marked;                /* of a let: its states are marked */
	struct node *value;         /* of param, let, output */
	struct value *collected;    /* value, when COLLECTED */
	const struct form *whole;   /* of a scalar let: its value for all time, where something is left over */
	enum { FRESH, COLLECTING, COLLECTED } progress;
	struct symbol *next_alike;  /* of the same bucket */
	struct span span;           /* when it holds, if COLLECTED */
	bool irrational;            /* something in it has become a rational, if COLLECTED */
	struct symbol *next;
};
struct equation {
	struct place at, end;       /* first token; just after the last */
	struct node *left, *right;
};
struct element {                    /* of a sketch */
	enum { ELEMENT_MASS, ELEMENT_SPRING, ELEMENT_DAMPER, ELEMENT_FORCE } kind;
	struct place at, end;
	struct node *value, *from, *to; /* coordinates, or components; `to` NULL: the ground, or none */
};
struct initial {
	struct place at;
	size_t statement;
	struct symbol *coord;
	int primes, component;
	struct node *value;
};
struct fixed {                      /* of `operator at NAME = value, value, ...` */
	struct place at, end;
	const struct symbol *symbol; /* a coordinate or a let; NULL: t */
	int primes, component;
	int values;
	struct node **value;
};
struct tunable {                    /* a param that the target may change */
	struct place at;
	struct symbol *symbol;
};
struct spec {                       /* what the text says, names resolved, nothing evaluated */
	const struct source *source;
	const char *name;
	struct place name_at;
	struct symbol *first, **last;   /* all symbols in the order of declaration */
	struct symbol **bucket;         /* the same by name */
	int components;                 /* of all coordinates together */
	int params, coords, lets, outputs, inputs, matrices;
	int equations;
	struct equation *equation;
	int elements;
	struct element *element;
	int files;                      /* data files, for the dependency file */
	const char **file;
	int initials;
	struct initial *initial;
	struct node *step;
	struct place step_at;
	const char *scheme;
	struct place scheme_at;
	bool has_operator;
	struct place operator_at;
	int fixeds;
	struct fixed *fixed;
	int tunables;
	struct tunable *tunable;
	struct place end;
};
struct spec *parse_spec(const struct source *source);
struct node *parse_argument(struct spec *spec, const struct source *source, size_t from); /* an expression from the command line */
struct symbol *spec_find(const struct spec *spec, const char *name);
char *text_between(struct place start, struct place end);   /* without comments, white space folded */

/* ---- names.c: words with a meaning of their own ---- */

bool is_reserved(const char *name);                         /* words that a user's name may not be */
const char *prefix_objection(const char *name);             /* why it cannot name generated code, or NULL */
size_t name_hash(const char *name);
enum function function_of(const char *name);
const char *function_name(enum function function);
const char *nearest_name(const char *name, int count, const char *const *known); /* or NULL */
const char *spec_suggestion(const struct spec *spec, const char *name); /* a note with the nearest known name, or NULL */

/* ---- form.c: symbolic collection; a form is linear in what the linear core can carry ---- */

enum basis_kind { BASIS_ONE, BASIS_PI, BASIS_WAVE, BASIS_INPUT, BASIS_COORD, BASIS_ATOM };
struct basis {
	enum basis_kind kind;
	int index, order;           /* of BASIS_COORD and BASIS_INPUT: which, and how often differentiated; of BASIS_ATOM: its index */
	struct wave *wave;          /* of BASIS_WAVE: t^power times its cos or sin */
	int power;
	bool sine;
	const struct atom *atom;    /* of BASIS_ATOM: an expression that the linear core cannot carry */
};
struct wave {                       /* e^{a t} cos(w t + p) and sin, w > 0; or e^{a t} alone, w = p = 0 */
	mpq_t a, w, p;
	int index;                  /* in the order of first appearance */
	struct wave *next;          /* of the same hash */
};
struct form_term {
	struct basis basis;
	mpq_t factor;
};
struct form {                       /* sum of factor * basis, sorted, no zero factors */
	int terms;
	struct form_term *term;
	int room;                   /* of one that form_add_to has enlarged; else 0 */
};
struct irrationals { bool used[FN_TABLE + 1], pi, root; };  /* which became rationals of 256 bits; `root`: of a power */
struct collector {
	struct waves *waves;        /* made on first use; of the collectors inside it too */
	struct irrationals irrationals;
	int irrational_count;       /* how often one was met */
	const char *scheme;         /* for the message about a term that it cannot treat */
	const struct node *term;    /* the innermost additive term being collected */
	int changes;                /* of formula in time: breakpoints found so far, rising */
	mpq_t *change;
	int interval;               /* between them, which is being collected: 0 .. changes */
	struct span span;           /* in which every condition on time that was met since it was opened has the outcome that it has now */
	const struct node *argument; /* the innermost function of which an argument is being collected that must be linear */
	bool constant_only;         /* a param, a step, an initial value */
	bool tolerant;              /* give up in silence on what is not linear: an output may be */
	enum { KEEP_NOTHING, KEEP_PIECEWISE, KEEP_ALL } keep; /* as atoms: what is piecewise linear; whatever is not linear */
	bool whole_time;            /* with KEEP_ALL: conditions and products of time become atoms too, and time is not divided */
	bool closed;                /* for --solution */
	bool output;                /* an output is being collected: highest derivatives may stand anywhere */
	struct atoms *atoms;
	const struct model *model;  /* for the orders of its coordinates; NULL: there are none */
	int fixings;                /* lets that an operator fixes */
	const struct fixing *fixing;
};
int basis_order(const struct basis *a, const struct basis *b); /* by which terms are sorted; 0: the same */
struct form *form_single(struct basis basis, mpq_srcptr factor);
struct form *form_unit(struct basis basis);                 /* factor 1 */
struct form *form_constant(mpq_srcptr value);
struct form *form_number(long value);
struct form *form_sum(const struct form *a, const struct form *b, bool subtract);
struct form *form_difference(const struct form *a, const struct form *b);
/* Into `sum`, which nothing else holds: what many parts make costs no more than the parts. `factor` NULL: 1 */
void form_add_to(struct form *sum, const struct form *part, mpq_srcptr factor);
void form_add_basis(struct form *sum, struct basis basis, mpq_srcptr factor);
void form_free(struct form *form);                          /* which nothing else holds */
const struct form_term *form_find(const struct form *form, const struct basis *basis); /* NULL: it does not occur */
struct form *form_scale(const struct form *a, mpq_srcptr factor);
struct form *form_product(struct collector *collector, const struct form *a, const struct form *b); /* one of them constant */
bool is_constant(const struct form *form);                  /* 1 and pi only */
mpq_srcptr factor_of(const struct form *form, enum basis_kind kind); /* NULL: it does not occur */
bool same_in_states(const struct form *a, const struct form *b); /* they differ in loads only */
void check_form(struct place at, const struct form *form);  /* the limit on exact values */
void met_irrational(struct collector *collector, bool *which); /* one of its irrationals */
void constant_value(struct collector *collector, const struct form *form, mpq_ptr value); /* form of 1 and pi only */

/* ---- atom.c: what is not linear, as expressions that are shared wherever they are the same ---- */

enum atom_kind { ATOM_PRODUCT, ATOM_RECIPROCAL, ATOM_POWER, ATOM_CALL, ATOM_COMPARE, ATOM_CHOOSE };
struct atom {
	enum atom_kind kind;
	enum function function;     /* of ATOM_CALL */
	enum comparison comparison; /* of ATOM_COMPARE: two operands */
	int operands;               /* POWER: base, exponent; CHOOSE: condition, then, else; equal forms are one object */
	const struct form **operand;
	unsigned *exponent;         /* of ATOM_PRODUCT, one per factor */
	bool time, input, state, velocity; /* what it depends on; a coordinate of first order counts as a velocity */
	const struct basis *moves;  /* of that a coordinate, else an input; NULL: t alone */
	signed char piecewise, stepwise; /* 1 and -1: is_piecewise_form, is_stepwise; 0: not asked yet */
	const struct node *node;    /* where it comes from */
	int index;                  /* in the order of first appearance */
	struct atom *next;
};
struct atoms *atoms_new(void);
int  atoms_count(const struct atoms *atoms);
/* Each result is a form, folded where the operands are constant; sums of constants, times and states are multiplied out so
 * far that every constant times a state shows as a linear term, and every term of time alone stands alone. */
struct form *kept_product(struct collector *c, const struct node *node, const struct form *a, const struct form *b);
struct form *kept_others(struct collector *c, const struct node *node, const struct atom *product, int factor); /* the product, of at least two factors, with one of that factor less */
struct form *kept_reciprocal(struct collector *c, const struct node *node, const struct form *x);
struct form *kept_power(struct collector *c, const struct node *node, const struct form *base, const struct form *exponent);
struct form *kept_whole_power(struct collector *c, const struct node *node, const struct form *x, unsigned n);
struct form *kept_call(struct collector *c, const struct node *node, enum function function, int count, struct form *const *x);
struct form *kept_comparison(struct collector *c, const struct node *node, enum comparison comparison, const struct form *a, const struct form *b);
struct form *kept_choice(struct collector *c, const struct node *node, const struct form *condition, const struct form *a, const struct form *b);
/* A factor that is constant but for comparisons and sgn, times what is piecewise linear: (x' > 0 ? c1 : c2)*x' = (x' > 0 ? c1*x' : c2*x');
 * NULL: they are no such factors. */
struct form *kept_switched(struct collector *c, const struct node *node, const struct form *a, const struct form *b);
bool is_piecewise_form(const struct form *form);            /* linear but for functions and conditions of linear expressions */
bool is_stepwise(const struct form *form);                  /* constant but for comparisons and sgn */
bool is_velocity(const struct model *model, const struct basis *basis); /* it depends on one; a coordinate of first order is one too */
const struct basis *moved_basis(const struct basis *known, const struct basis *basis); /* of which two moves more readily: see struct atom */
bool depends_on_time_only(const struct basis *basis);       /* or on nothing */
struct form *time_part(const struct form *form, bool atoms); /* its terms of time alone; or of them the atoms only */
bool same_form(const struct form *a, const struct form *b);

/* ---- calculus.c: derivatives of forms, and forms at a point ---- */

struct fixing {                     /* a name that `operator at` fixes */
	struct place at;
	const struct symbol *symbol; /* a let or a coordinate; NULL: t */
	int coord, order;           /* of a coordinate, one component */
	const struct form *form;    /* constant: pi stays pi */
	mpq_t value;
};
/* With respect to one state: a coordinate, or its velocity */
struct form **form_derivatives(struct collector *c, int count, const struct form *const *form, int coord, int order);
struct point;                       /* t and coordinates fixed; lets are not looked at */
struct point *point_new(struct collector *c, int fixings, const struct fixing *fixing);
struct form *form_at(struct point *point, const struct form *form); /* leaves the statement where the form is not defined there */

/* ---- value.c: forms as numbers at a point ---- */

struct sample;                      /* `leaf` says what a coordinate or an input is there */
struct sample *sample_new(int precision, void (*leaf)(void *context, const struct basis *basis, mpfr_ptr value), void *context);
long sample_work(const struct sample *sample);             /* terms that were taken so far */
void sample_at(struct sample *sample, mpfr_srcptr t);       /* a new point: what was found at the last is forgotten */
void sample_form(struct sample *sample, const struct form *form, mpfr_ptr value); /* NaN where it is not defined */

/* ---- wave.c: loads in time ---- */

struct wave *wave_of(struct collector *collector, mpq_srcptr a, mpq_srcptr w, mpq_srcptr p);
struct form *plain_wave(struct collector *collector, int power, mpq_srcptr a); /* t^power e^{a t}; a NULL: 0 */
struct form *collect_wave(struct collector *collector, bool sine, mpq_srcptr frequency, const struct form *phase);
struct form *load_product(struct collector *collector, const struct form *a, const struct form *b); /* of loads and constants */
bool linear_in_time(const struct form *x, mpq_srcptr *factor, struct form *phase); /* x = factor t + phase, factor not 0 */

/* ---- collect.c: nodes to values ---- */

struct value {                      /* a scalar is 1 x 1 */
	int rows, columns;
	struct form **cell;         /* row-major */
};
struct value *collect(struct collector *collector, struct node *node);   /* leaves the statement at what is not linear */
struct value *collect_constants(struct collector *collector, struct node *node);
void collect_constant(struct collector *collector, struct node *node, mpq_ptr number);

_Noreturn void not_linear(const struct collector *c, const struct node *node, const char *why);
struct form *constant_call(struct collector *c, const struct node *node, enum function function, const struct form *x);
const char *rewrite_of(const struct node *term);            /* what scheme exact could treat in its place; "": there is nothing known */
bool compare_values(enum comparison comparison, int order);
void forget_lets(const struct spec *spec);
_Noreturn void not_built(const struct collector *c, struct place at, const char *what);

/* ---- piecewise.c: functions and conditions that divide time ---- */

/* Sign of a - b, constant or linear in t, in the collector's interval of time; breakpoints met are added. */
int order_now(struct collector *c, const struct node *node, const struct form *a, const struct form *b);
struct form *piecewise(struct collector *c, const struct node *node, struct form *const *x); /* the function of its arguments' forms */
void check_breakpoints(struct collector *c, const struct node *node, struct form *const *x);  /* of a function that is not taken apart */
bool is_decided(const struct collector *c, int count, struct form *const *x); /* constants and times: conditions on them have an outcome */
bool is_decided_call(const struct collector *c, const struct node *node, struct form *const *x); /* those, or what moves alike: max(x, x + 1) */

void narrow_span(struct collector *c, struct span span);
bool holds_now(const struct collector *c, struct span span); /* in the collector's interval of time */

/* ---- mtx.c: Matrix Market files ---- */

struct mtx {
	int rows, columns;
	mpq_t *cell;                /* row-major */
};
struct mtx *mtx_read(const char *path, struct place at);    /* `at`: what names the file */

/* ---- constant.c: functions of constants; true where the value is exact, else it is the nearest of 256 bits ---- */

void constant_pi(mpq_ptr value);
bool constant_function(struct place at, enum function function, mpq_srcptr x, mpq_ptr value);
void wide_value(enum function function, mpfr_ptr x);         /* x = function(x) of one argument, at x's precision */
bool constant_atan2(struct place at, mpq_srcptr y, mpq_srcptr x, mpq_ptr value);
bool constant_power(struct place at, mpq_srcptr base, mpq_srcptr exponent, mpq_ptr value);

/* ---- model.c: the equations of motion, exact ---- */

struct load {                       /* force on the equations: t^k times one wave */
	const struct wave *wave;
	int powers;                 /* k = 0 .. powers-1 */
	int columns;                /* t^k, or t^k cos and t^k sin: the load states z */
	mpq_t **force;              /* per column: [segment][equation] */
};
struct input {                      /* a sampled input u */
	const char *name;
	bool first_order;           /* ramp between samples; else held */
	mpq_t *force[2];            /* of u and of u': one rational per equation */
};
struct linear {                     /* M q'' + C q' + K q = force - heldC q'(t_n) - heldK q(t_n) */
	int n, states;              /* states: the coordinates, then the velocities of those of second order */
	int *velocity;              /* per coordinate: the state that is its velocity; -1: of first order */
	int *coord;                 /* per state: its coordinate */
	mpq_t *M, *C, *K;           /* n x n, row-major; a coordinate of first order has no column in M */
	mpq_t *heldC, *heldK;       /* n x n, or NULL where nothing is held */
	int segments;               /* of time, in which the loads have one formula each */
	mpq_t *change;              /* segments - 1 times, rising */
	int loads;
	struct load *load;
	int inputs;
	struct input *input;
	int channels;               /* of what is left over: one for each equation that has some */
	mpq_t **channel;            /* its force on the equations */
};
struct output {
	const char *name;
	struct node *value;         /* as written */
	int statement, cell;        /* which output statement, and which cell of its value */
	struct form *form;          /* in the first segment of time; NULL where it is not linear in states and loads */
	struct form *left;          /* then: for all time, with atoms; highest derivatives stand for themselves */
	mpq_t *state;               /* factors of y, one per state, accelerations replaced */
	mpq_t **load;               /* per load: factors of its columns, [column][segment] */
	mpq_t *input[2];            /* per input: factors of u and u' */
	mpq_t *channel;             /* factors of what is left over, where an acceleration is read */
};
struct operator {                   /* A of y' = A y + loads + inputs + r(t, y); its M is that of the equations */
	mpq_t *C, *K;
	struct form **left;         /* per channel: the leftover, a force on its equation */
	mpq_t at;                   /* of a bank: the value up to which it serves */
	const char *text;           /* x = 2, x' = 0 */
};
enum step_form { FORM_AUTO, FORM_DIRECT, FORM_DELTA, FORM_KICK_DRIFT_KICK, STEP_FORMS };
enum scheme { SCHEME_EXACT, SCHEME_PL, SCHEME_ETD1, SCHEME_ETDRK2, SCHEME_ETDRK4, SCHEME_NC2, SCHEME_NC3, SCHEME_DQ4, SCHEME_BM3, SCHEMES };
struct smoothness {                 /* of what is left over, else of the equations; where nothing is found all is 0 */
	int tenths;                 /* of the order that no scheme exceeds here: 10 at a jump, 20 at a kink */
	enum { SMOOTH_ALL, SMOOTH_KINK, SMOOTH_JUMP } kind;
	const struct node *node;    /* what jumps or has the kink */
	const char *where;          /* x passes 0.5 */
	bool piecewise;             /* exact could treat it alone */
	bool timed;                 /* it lies at a time */
};
struct model {
	const struct spec *spec;
	const char *name;           /* prefix of everything generated */
	int n;                      /* coordinates */
	const char **coord_name;
	const char **state_name;    /* x1, x2, x1', x2' */
	struct symbol **coord;
	struct linear system;       /* as written */
	struct residual *residual;  /* per row of the system, in the first segment of time */
	struct snapshot *snapshot;  /* per segment */
	struct snapshot *whole;     /* for all time, conditions and products of time kept; NULL: nothing is left over */
	struct irrationals irrationals;
	mpq_t *initial;             /* one per state */
	mpq_t h;
	struct place step_at;       /* where h is given */
	struct place end_at;         /* where the end of --solution is given, else h */
	enum scheme scheme;
	struct place scheme_at;     /* source NULL: it was not given */
	bool loads_left;            /* known loads are left to the scheme */
	enum step_form form;        /* as asked for */
	struct place form_at;       /* on the command line */
	bool compensated;           /* two-word arithmetic is asked for */
	struct place compensated_at;
	bool single;                /* the target's numbers are floats */
	bool selftest;              /* NAME_selftest is asked for */
	int operators;              /* 0: exact, or nothing is left over */
	struct operator *operator;
	int *owner;                 /* per coordinate: the row of its equation */
	int channels;               /* of what is left over, of each operator: one for each equation that has some */
	int *channel_row;           /* its equation */
	const struct atoms *atoms;
	struct switching *switching; /* exact: the regions of a piecewise-linear model; NULL: it has one */
	struct smoothness smooth;
	const struct node *obstacle; /* the first term that stood in the way of exact, where no scheme was asked for; */
	const char *obstacle_text;  /* why it did, and the way out if there is one */
	const struct form *selector; /* of a bank: what is compared with `at`; NULL: one operator */
	const struct tuning *tuning; /* tunable params, and how the equations follow from them; NULL: there are none */
	int outputs;
	struct output *output;
	bool declared_outputs;
	struct output **highest;    /* per coordinate: its highest derivative as a row, where an output that is not linear reads it */
	const struct model *written; /* itself; of a reduced model: the one that it was made of */
	int *place;                 /* of a reduced model, per written state: the state that is it, or -1 */
	const struct relative *relative; /* the model is over other coordinates than the written ones; NULL: over those */
	bool irreducible;           /* --reduce was asked for, and every state is seen */
	int dropped;                /* written states that are no combination of the reduced ones */
	const char **dropped_name;
};
/* ---- relative.c: coordinates in which what may move as a whole is parted from what moves in it ---- */

struct link {                       /* of a written coordinate x: what is kept in its place */
	enum { LINK_NONE, LINK_PARENT, LINK_CENTRE } kind; /* x itself; its distance from another; the centre of its group */
	int from;                   /* LINK_PARENT: the other, x_p */
	mpq_t ratio;                /* x - ratio x_p is kept, */
	bool turned;                /* or ratio x_p - x */
	mpq_t *weight, *shift;      /* LINK_CENTRE, per coordinate: X = sum of weight x; x = X + sum of shift times what is kept */
	struct form *rate;          /* LINK_PARENT, x of second order, x_p of first: x_p' over written coordinates, so that x' - ratio x_p' is kept, */
	int velocity;               /* or else the kept coordinate that is x', of first order; -1: that of what is kept */
};
struct relative {
	const struct model *written;
	int n;                      /* coordinates kept: in the place of each written one, then velocities that stand alone */
	const char **name;
	int *order;
	struct link *link;          /* per written coordinate */
	int links, *sequence;       /* those of LINK_PARENT, each after the one that it is measured from */
	struct form **form[3];      /* per derivative and written coordinate: over what is kept */
	struct form **extra;        /* equations r' = v - ... of velocities that stand alone, after all others */
	mpq_t *solved;              /* per written coordinate: what its equation is divided by, so that equations are combined as coordinates are; */
	                            /* NULL: equations stay as written */
};
struct relative *relative_of(const struct model *model);     /* NULL: nothing moves as a whole that has parts */
/* What is kept at a coordinate, from the written coordinates, or their velocities, that it takes */
void relative_value(const struct relative *r, int coord, mpq_t *const *value, mpq_ptr kept);
struct form *combined_equation(const struct relative *r, int coord, const struct form *const *equation); /* that of what is kept there */
void relative_values(const struct model *model, mpq_t *written, mpq_t *kept); /* of all states */
int  relative_place(const struct model *model, int written); /* the kept state that is a written one; -1: none is */

struct expression {                 /* what is compared with breakpoints: linear in states, loads and inputs */
	struct form *form;          /* without constant; sign and scale as first written */
	struct output *row;         /* the same as a row */
	int breaks;
	mpq_t *at;                  /* rising */
	const struct node *node;    /* where it comes from */
	int stride;                 /* of its interval in the index of a region */
};
struct region {                     /* one interval for each expression */
	bool possible;              /* its inequalities can hold together */
	int system;                 /* index of its equations; equal ones are one */
	struct form **residual;     /* per row: linear */
};
struct switching {
	int expressions;
	struct expression *expression;
	int regions;                /* all, possible or not: products of the expressions' intervals */
	struct region *region;
	int systems;
	struct linear *system;
};
struct overrides {                  /* from the command line */
	const char *step, *scheme, *prefix;
	bool reduce, loads_left, compensated, single, selftest;
	enum step_form form;
	bool solution;              /* the closed form is wanted, whatever the scheme */
	const mpq_t *tunable;       /* values of the tunable params in place of the spec's, to see what the equations become: no step, no initial values, no warnings */
	const struct relative *relative; /* the coordinates to build the model over; NULL: the written ones; then nothing is told a second time */
	int definitions;
	const char **definition;    /* NAME=EXPR */
};
struct residual {                   /* left side minus right side of one scalar equation */
	struct form *form;
	struct place at, end;
};
struct building {                   /* what the builders share */
	struct spec *spec;
	struct model *model;
	struct collector collector;
	const struct overrides *overrides;
	const struct wave *polynomial; /* the wave of t^k alone */
	struct snapshot *snapshot;  /* per interval between changes of formula in time */
	struct snapshot *whole;     /* the same for all time, with atoms; NULL: there is no leftover */
	struct form **load;         /* [segment][row]: the residual's part that depends on time alone, as the linear core carries it */
	struct form **time_left;    /* per row: what depends on time alone and it cannot carry */
	int *owner;                 /* per coordinate: its residual */
};
struct snapshot {                   /* the equations and outputs in one interval of time */
	int residuals, written;     /* all; those of written equations come first */
	struct residual *residual;
	struct form **element;      /* per element of the sketch: its force */
	struct value **output;      /* per output statement; NULL: not linear */
};
struct model *model_build(struct spec *spec, const struct overrides *overrides);
struct form *coordinate_form(const struct model *model, int coord, int order); /* of a written coordinate, over those of the model */
void argument_value(struct model *model, const char *text, mpq_ptr value); /* of --solution; may use params */
const char *scheme_name(enum scheme scheme);

/* ---- blocks.c: coordinates that do not influence each other ---- */

struct block {
	struct linear system;
	int *equation, *coord;      /* of the whole system, per equation and coordinate of the block */
	int *state;                 /* likewise per state */
};
int blocks_of(const struct linear *system, struct block **blocks); /* M regular, so that a block has as many equations as coordinates */

/* ---- equations.c, outputs.c: the builders of a model ---- */

void collect_equations(struct building *b, struct snapshot *snapshot);
void collect_outputs(struct building *b, struct snapshot *snapshot);
int  find_order(const struct spec *spec, int coord);
void build_system(struct building *b);                      /* M, C, K, loads, inputs */
bool is_linear(const struct building *b);                   /* with constant coefficients, loads in time excepted */
void collect_whole(struct building *b);                     /* the equations for all time, atoms kept: b->whole */
void place_loads(struct building *b, const struct form *form); /* every load of the form gets load states */
void spread_loads(struct building *b, const struct form *form, void (*spread)(void *context, int load, int column, mpq_srcptr factor), void *context);
void build_outputs(struct building *b);
struct output *row_of_form(struct building *b, struct form *form); /* of states, loads and inputs; no highest derivatives */
void fill_system(struct building *b, struct linear *system, int segment, int row, const struct form *residual); /* one row of everything */
struct linear empty_system(const struct model *model);      /* the model's coordinates, loads and inputs; no factors yet */

/* ---- regions.c: piecewise-linear equations as regions with linear ones ---- */

bool is_piecewise_linear(const struct building *b);
void find_regions(struct building *b);                      /* says what cannot be treated */
void place_region_loads(struct building *b);
void build_regions(struct building *b);                     /* their systems; after the loads of all have their places */
int  interval_of(const struct switching *s, int region, int expression);
int  possible_regions(const struct switching *s);

/* ---- operator.c: the linear operator of a scheme, and what it leaves over ---- */

void build_operators(struct building *b);
struct linear operator_system(const struct model *model, int k); /* the model's, with the operator's C and K and the channels */
/* Every form that the leftovers and the selector are made of, once, operands before what they make. */
void visit_leftovers(const struct model *model, void (*visit)(void *context, const struct form *form), void *context);

/* ---- smooth.c: how smooth the equations are, and what order that leaves to a scheme ---- */

void judge_smoothness(struct building *b);                  /* model->smooth; says where dry friction stands in what is left over */
bool reads_velocity(const struct model *model, const struct form *form); /* or a coordinate of first order, which is one */
_Noreturn void tell_friction(const struct node *node, const char *where);
int  order_of_scheme(const struct model *model);            /* where all is smooth; 0: of exact */
bool loses_order(const struct model *model);                /* to what is not smooth */
int  order_that_holds(const struct model *model);           /* rounded down; 0: nothing is left over */
const char *order_text(const struct model *model);          /* that is left: 2, 2.5 */
const char *smoothness_text(const struct model *model);     /* max(x - 0.5, 0) has a kink where x passes 0.5 */

/* ---- warnings.c: what a spec may say but is better told about ---- */

void warn(struct building *b);

/* ---- fit.c: functions of params from their values ---- */

enum { FIT_DEGREE = 3, FIT_POINTS = 3 };    /* powers up to it, and down to its negative; points that tell what is constant */
struct fit {
	int params;
	mpq_srcptr (*value)(void *context, const mpq_t *params);    /* of the function */
	void *context;
	int products;               /* found: factors, some 0, times powers of params */
	signed char power[LIMIT_MONOMIALS + 1][LIMIT_TUNABLES];
	mpq_t *factor;
	int culprit;                /* the param of which no power fits; -1: too many products, or there is none */
	bool exponent[LIMIT_TUNABLES][2 * FIT_DEGREE + 1]; /* on the way: which powers of each occur, from the lowest on; */
	bool depends[LIMIT_TUNABLES], together[LIMIT_TUNABLES][LIMIT_TUNABLES]; /* whether any does; whether a product holds both */
};
bool fit_value(struct fit *fit);                            /* params, value and context given; false: it is no such sum */
mpq_t *scattered_values(int params, int number);            /* values that are related by nothing */

/* ---- tune.c: how the equations follow from tunable params ---- */

struct tuned_monomial { int from, param; bool divides; };  /* an earlier one times a param, or divided by it; number 0 is 1, these are 1, 2, ... */
struct tuned_term {
	int row, column, monomial;
	mpq_t factor;
};
/* W a = R x, exactly, for all values of the params: a holds the highest derivatives of the coordinates, then the outputs that
 * depend on params, then the frequencies of loads that do (in column 0); x is the states, the load states in each segment of time, the inputs (of ramps: u, u'). */
struct tuning {
	int params;
	const struct tunable *param;
	mpq_t *nominal;             /* the spec's values */
	int columns, loads;         /* of x; of the load states in one segment */
	int rows, outputs, frequencies; /* rows: of coordinates, such outputs, such frequencies */
	int *output, *frequency;    /* per output, per load: its row, or -1: no param changes it */
	bool solves;                /* there is a W, columns behind those of R; else it is the unit matrix */
	int monomials;
	struct tuned_monomial *monomial;
	int terms;
	struct tuned_term *term;    /* by rows, then by columns */
	bool *acts;                 /* rows x columns: of W^-1 R, whether it is anything but 0 for some values */
	const struct model *other;  /* the model at values that are related by nothing: what holds there holds for all */
};
bool find_tuning(struct model *model, const struct overrides *overrides); /* model->tuning, where something is tunable; false: it was said why not */
struct step;
void mark_tuned_zeros(struct step *step);                    /* in its table: what vanishes at these values only is no zero */

/* ---- reduce.c: the smallest model with the same outputs ---- */

struct model *model_reduce(struct model *model);             /* itself where nothing can go */

/* ---- linear.c: rational matrices, and linear systems over them ---- */

bool rational_inverse(int n, const mpq_t *A, mpq_t *inverse, int *column); /* false: singular, *column free */
void rational_subtract_row(int n, mpq_t *target, const mpq_t *row, mpq_srcptr factor); /* target - factor row */
void rational_product(int rows, int inner, int columns, const mpq_t *A, const mpq_t *B, mpq_t *AB);
struct linear linear_like(const struct linear *shape);      /* the same coordinates and states, matrices 0, no loads */
struct linear first_order_system(int n, const mpq_t *A);    /* x' = A x */
/* W^-1, n x n; W has the columns of M, and those of C where a coordinate is of first order. False: singular. */
bool leading_inverse(const struct linear *system, mpq_t *inverse, int *column);
/* Highest derivatives of the coordinates, -W^-1 (C v + K q), n x states; `held`: of the held terms alone */
void highest_derivatives(const struct linear *system, const mpq_t *inverse, bool held, mpq_t *row);
mpq_t *state_matrix(const struct linear *system, bool held); /* A of y' = A y, states x states */

/* ---- poly.c: polynomials over Z, constant term first ---- */

struct poly {
	int length;                 /* degree + 1; 0 is the zero polynomial; the last coefficient is not 0 */
	mpz_t *c;
};
struct poly poly_new(int length);                           /* coefficients 0; call poly_trim after filling */
void poly_trim(struct poly *p);
struct poly poly_add(struct poly a, struct poly b);
struct poly poly_sub(struct poly a, struct poly b);
struct poly poly_mul(struct poly a, struct poly b);
struct poly poly_scale(struct poly a, mpz_srcptr factor);
struct poly poly_shift(struct poly a, int powers);          /* times s^powers; negative: exact division */
struct poly poly_divide(struct poly a, struct poly b);      /* b divides a exactly, over Q; primitive up to a factor: see .c */
struct poly poly_gcd(struct poly a, struct poly b);         /* primitive, leading coefficient positive */
struct poly poly_derivative(struct poly a);
struct poly poly_hasse(struct poly a, int k);               /* k-th derivative over k! */
struct poly poly_mirror(struct poly a);                     /* a(-s) */
struct poly poly_primitive(struct poly a, mpz_ptr content); /* a = content * result, result's leading coefficient positive */
bool poly_divides(struct poly d, struct poly a);            /* d | a over Q */
bool poly_equal(struct poly a, struct poly b);
int  poly_valuation(struct poly a);                         /* how often s divides a (not 0) */

struct factor {                     /* square-free, no root at 0 */
	struct poly g;
	int multiplicity;
	bool symmetric;             /* g(s) = +-g(-s): for every root its negative */
};
int poly_square_free(struct poly a, struct factor **factors); /* a primitive; roots at 0 left out; returns the count */

/* ---- polymat.c: square matrices of polynomials ---- */

struct polymat {
	int n;
	struct poly *cell;          /* row-major */
};
/* det P not the zero polynomial; adj may be NULL, its n x n cells are filled in */
void polymat_adjugate(struct polymat P, struct poly *det, struct polymat *adj);

/* ---- enclosure.c: complex numbers enclosed in rectangles; targets may be operands ---- */

struct rectangle { mpfi_t re, im; };
void rectangle_init(struct rectangle *z, int precision);    /* 0 */
void rectangle_clear(struct rectangle *z);
void rectangle_set(struct rectangle *z, const struct rectangle *a);
void rectangle_sub(struct rectangle *z, const struct rectangle *a, const struct rectangle *b);
void rectangle_mul(struct rectangle *z, const struct rectangle *a, const struct rectangle *b);
void rectangle_div(struct rectangle *z, const struct rectangle *a, const struct rectangle *b);
void rectangle_exp(struct rectangle *z, const struct rectangle *a, mpq_srcptr tau);         /* e^{a tau} */
void rectangle_evaluate(struct rectangle *z, struct poly p, const struct rectangle *a);     /* p(a); z is not a */

/* ---- poles.c: roots with proof ---- */

struct pole {                       /* of the upper half plane or real; its conjugate is implied */
	struct rectangle at;        /* encloses the pole; a part that is 0 is exactly [0,0] */
	bool real, imaginary;
};
struct spectrum {                   /* the distinct poles of one denominator, 0 excepted */
	struct poly D;              /* primitive */
	int zero;                   /* multiplicity of the pole 0 */
	int factors;
	struct factor *factor;
	int *poles;                 /* per factor */
	struct pole **pole;
	int precision;              /* bits to which the poles are known now; 0: not yet */
	struct iteration *iteration; /* poles.c: where the iteration stands, per factor */
	struct growth *growth;      /* residues.c: e^{p tau} and the denominator's series at the poles */
	struct spectrum *next;
};
struct spectrum *spectrum_of(struct poly D);                /* the same object for the same D */
bool spectrum_refine(struct spectrum *spectrum, int precision); /* relative 2^-precision; false: not isolated within the limits */

/* ---- residues.c: values of c e^{A tau} b as sums of residues, enclosed ---- */

struct response {                   /* scale * N/D, N and D coprime */
	mpq_t scale;
	struct poly N;
	struct spectrum *spectrum;
	mpq_t *at_zero;             /* residue at 0 as a polynomial in tau: zero-th coefficient first */
	struct rectangle ***residue; /* [factor][pole][k], for `precision` bits */
	int precision;
};
struct response *response_of(mpq_srcptr scale, struct poly N, struct poly D);
/* True if the value at tau is rational: then `exact` is it. False: it is transcendental and response_enclose converges. */
bool response_exact(struct response *response, mpq_srcptr tau, mpq_ptr exact);
bool response_enclose(struct response *response, mpq_srcptr tau, int precision, mpfi_ptr value); /* false: poles not isolated */

/* ---- resolvent.c: the Laplace images of what a step needs ---- */

struct excitation {                 /* acts from tau = 0 on: sum over m of tau^m e^{a tau} times cos(w tau) and sin(w tau) */
	mpq_srcptr a, w;
	int powers;                 /* m = 0 .. powers-1; where w = 0 there is no sine */
	mpq_t *force;               /* [m][cos, sin][equation]: on the equations */
	mpq_t *direct;              /* [m][cos, sin]: added to the result itself */
};
struct excitation excitation_new(int n, mpq_srcptr a, mpq_srcptr w, int powers); /* all 0; a, w NULL: 0 */
struct question {                   /* row . y(tau) */
	const mpq_t *initial;       /* y(0), one per state; NULL: 0 */
	int excitations;
	struct excitation *excitation;
	const mpq_t *row;           /* one per state */
};
struct resolvent;                   /* adj P and B of one system */
struct resolvent *resolvent_of(const struct linear *system);
struct response *image_of(struct resolvent *r, const struct question *question);
void characteristic_polynomial(const struct resolvent *r, mpq_t *coefficient); /* B(s) = det P, as many as its degree + 1 */
const struct poly *resolvent_determinant(const struct resolvent *r);           /* B(s) times the scales of the rows */

/* ---- loads.c: loads, inputs and held terms as excitations of a step ---- */

struct response *response_of_state(struct resolvent *r, const struct linear *system, int i, int j); /* Phi_ij, held terms included */
struct response *response_of_load(struct resolvent *r, const struct linear *system, int segment, int i, int load, int column);
struct response *response_of_input(struct resolvent *r, const struct linear *system, int i, int input, int column, mpq_srcptr h);
struct response *response_of_load_state(const struct load *load, int to, int from); /* of one load: z_to(t+tau) from z_from(t) */
struct kernel_part;
struct response *response_of_kernel(struct resolvent *r, const struct linear *system, int i, int channel, const struct kernel_part *part, mpq_srcptr h);
mpq_t *impulse_of_channel(const struct linear *system, int channel);         /* what its unit force gives the states' derivatives */
struct started {                    /* a response that starts at a time of its own */
	struct response *response;
	mpq_t start;
};
/* output(t) from t = 0 as a sum of responses; returns how many */
int responses_of_output(struct resolvent *r, const struct linear *system, const mpq_t *initial, const struct output *output, struct started **list);
void load_state(const struct load *load, int column, mpq_srcptr t, mpq_ptr z);   /* its value, rational or the nearest of 256 bits */
int load_columns(const struct linear *system);
int input_columns(const struct linear *system);
bool load_acts(const struct linear *system, const struct load *load);
bool is_polynomial(const struct wave *wave);                /* t^k alone */
bool oscillates(const struct wave *wave);

/* ---- taylor.c: e^{A tau} as a whole, enclosed by a Taylor series and squarings ---- */

struct taylor;                      /* one rational A (n x n, row-major) and one tau */
struct taylor *taylor_of(int n, const mpq_t *A, mpq_srcptr tau);
/* Every entry to an absolute error below 2^-precision times the largest entry's size (of the real e^{A tau} or its
 * enclosure); small entries of short paths come out to nearly that many bits of their own. Cached: asking for less than
 * is known costs nothing. False: |A tau| above 2^512, an entry beyond 2^(2^50), or errors that outgrow 64 kbit. */
bool taylor_enclose(struct taylor *t, int precision);
void taylor_entry(const struct taylor *t, int i, int j, mpfi_ptr value);    /* sets value's precision; after taylor_enclose */
/* True if the entry is a polynomial in tau, zero included, for every tau: then `exact` is its value at this one. */
bool taylor_exact(struct taylor *t, int i, int j, mpq_ptr exact);

/* ---- number.c: the border to rounded numbers ---- */

/* The target's type is double, or float after target_float; a double holds its numbers. */
void   target_float(void);
const char *target_name(void);
double round_rational(mpq_srcptr q);                        /* nearest of the target's numbers; +-HUGE_VAL beyond the range */
double nearest_double(mpq_srcptr q);                        /* whatever the target */
bool   beyond_range(mpq_srcptr q);
const char *finite_text(struct place at, mpq_srcptr q);     /* shortest; leaves the statement at a value beyond the range */
bool   round_enclosure(mpfi_srcptr x, double *d);           /* false: both ends do not round to one number */
const char *shortest(double d);                             /* fewest digits that read back; a C literal, of type double */
const char *exact_text(mpq_srcptr q);                       /* a decimal if there is one, else p/q */
const char *readable_text(mpq_srcptr q);                    /* the same while it is short, else 12 digits */

/* ---- series.c: the Taylor series behind NAME_at ---- */

struct step;
struct series {                     /* x' = A x; x = state, held terms, constant load, cos and sin of each wave */
	bool emitted;               /* max|pole| h <= 8 */
	int size, degree, halvings;
	int held;                   /* index of the first held term, one per coordinate; -1: none */
	int *load;                  /* index of the first state of each load; -1: it acts on nothing */
	int *input;                 /* index of each input (then of its slope, if of first order) */
	int channel, powers;        /* index of the first leftover; each is a chain of so many integrators, its force the first */
};
void series_place(struct series *series, const struct linear *system, int powers); /* which entry of x is what */
void series_place_loads(struct series *series, const struct linear *system, int powers, const bool *needed); /* of loads those needed */
void series_plan(struct step *step);                        /* degree, halvings */
double largest_pole_angle(const struct step *step);         /* max|pole| h, rounded up */
int  series_halvings(const struct step *step, int operator); /* of the time h, so that |pole| tau <= 1 */
int  series_degree(const struct step *step, int first, int last, int halvings); /* for these operators, over h 2^-halvings */
mpq_t *series_matrix(const struct series *series, const struct linear *system, int segment); /* A in one segment of time */

/* ---- coefficients.c: numbers of the step, each rounded once ---- */

struct coefficient {
	double value, low;          /* of the target's type; value + low is the number in two words (low only where asked for) */
	bool zero;                  /* exactly: no trace in the code */
};
/* What multiplies a leftover, as a sum of parts: at tau = fraction h, B the force of its channel,
 *     impulse e^{A tau} B + integral over 0..tau of e^{A (tau - s)} B (power[0] + power[1] s/h + power[2] (s/h)^2) ds
 * so h phi_k(A h) B is power k-1 over (k-1)!. The sum is rounded once. */
struct kernel_part {
	mpq_t fraction, impulse, power[3];
	int powers;
};
struct kernel {
	const char *name;           /* b1 */
	int parts;
	struct kernel_part part[2];
};
struct wanted {                     /* of one table */
	mpq_t fraction;             /* its time, as a part of h */
	bool Phi, two_words;
	bool increments;            /* Phi - I */
	const mpq_t *mass;          /* kicks and drifts; one per coordinate, in units of the first; NULL: not wanted */
	const char *name;           /* full, half */
	int kernels;
	struct kernel kernel[4];
};
struct table {                      /* of one time: y(tau) = Phi y + sum of columns */
	const struct wanted *wanted;
	int states, columns, inputs, channels;
	struct coefficient *Phi;    /* states x states, or NULL */
	struct coefficient *increment; /* Phi - I, each entry rounded as it is; or NULL */
	struct coefficient *drift, *kick; /* coordinates x coordinates, symmetric: S = Phi_12 M^-1 and X = S^-1 (Phi_11 - I); or NULL */
	struct coefficient *load;   /* [segment of time][states x columns]: of the loads in order */
	struct coefficient *input;  /* states x inputs: u held; or its value before the step and after it */
	struct coefficient **kernel; /* per kernel: states x channels */
};
void check_pole_size(const struct model *model, const struct resolvent *resolvent); /* leaves the statement where |p| h is hopeless */
/* Rounded, infinite beyond the range; `at` and `what` name it where it cannot be decided. */
struct coefficient started_value(int count, const struct started *list, mpq_srcptr t, struct place at, const char *what); /* their sum */
struct coefficient response_value(struct response *response, mpq_srcptr tau, bool two_words, struct place at, const char *what);
/* Block by block; by residues, beyond LIMIT_RESIDUE_STATES states by Taylor series. `resolvent` is that of the whole. */
struct table **tables_of(const struct model *model, struct resolvent *resolvent, const struct linear *system, int count, const struct wanted *wanted);

/* ---- scheme.c: what a scheme steps with, as a program over tables ---- */

enum operand_kind { OPERAND_STATE, OPERAND_LOAD, OPERAND_INPUT };
struct operand {
	enum operand_kind kind;
	int index;                  /* state; or column of the loads, of the inputs */
};
struct product {
	const struct coefficient *factor; /* of a load: in the first segment of time */
	struct operand operand;
};
struct assignment {                 /* target <- sum of products */
	int target;                 /* state */
	bool added;                 /* target <- target + sum of products */
	bool carried;               /* with what rounding takes kept in carry */
	int terms;
	struct product *term;
};
/* A step of a scheme that leaves something over is a list of actions on vectors: stages are states (0: the state itself),
 * lefts are leftovers. */
enum { STAGE_STATE = 0, NONE = -1 };
struct action {
	enum { ACTION_LEFTOVER, ACTION_COMBINE, ACTION_SUM, ACTION_PREDICT } kind;
	int target;                 /* LEFTOVER, COMBINE: a left; SUM, PREDICT: a stage */
	int node, from;             /* LEFTOVER: when, and of which stage; PREDICT: when it ends */
	int half;                   /* PREDICT: the node in the middle */
	int plus, minus;            /* COMBINE: lefts; minus NONE: twice `plus`; `added` adds instead */
	bool added;
	int flow;                   /* SUM: table whose Phi, loads and inputs act on the state, or NONE */
	int plain;                  /* SUM: stage added as it is, or NONE */
	int kernels;                /* SUM: kernel of table times left, added */
	struct { int table, kernel, left; } kernel[4];
	const char *note;           /* a = F y + q1 r0 */
};
struct program {
	int assignments;            /* of a scheme that leaves nothing over */
	struct assignment *assignment;
	bool in_order;              /* each assignment reads what those before it have left; else all read the old state */
	bool compensated;           /* factors in two words, and what rounding takes from a state is kept */
	bool *reads;                /* per state: whether its old value is read */
	bool *uses;                 /* per column of the loads */
	int oscillators, growths;   /* cos/sin pairs and exponentials evaluated per step */
	int wave_multiplications, wave_additions; /* for them, counted below too */
	int multiplications, additions, calls; /* calls: of the model's own functions */
	bool loops;                 /* over the tables, zeros included: a large model */
	bool tuned;                 /* factors are read from the instance's coefficients */
	int actions;                /* 0: assignments */
	struct action *action;
	int stages, lefts;          /* vectors, the state not counted */
	int nodes;                  /* times at which leftovers are evaluated, as parts of h; the first is 0 */
	mpq_t *node;
	int *node_table;            /* per node: the table of loads and inputs that a predictor adds, or NONE */
	bool predicts;
};
struct forced {                     /* part times the load states solves the equations: what some loads sustain by themselves */
	bool *load;                 /* per load: one of them; then the step is without it */
	struct coefficient *part;   /* [segment of time][states x load columns] */
	struct coefficient *change; /* the same, from each segment to the next: what the state gains that is kept */
	bool changes;               /* any of it */
	int multiplications, additions; /* to add it */
};
struct rounding {                   /* a bound over the first steps from the initial values, inputs 0 */
	bool known;
	int steps, state;           /* the state where it is largest */
	double relative;            /* to the state's largest value */
	bool tiny;                  /* there are states too small for the target's range, which it leaves out */
};
struct step {                       /* everything that is emitted for one model */
	const struct model *model;
	struct linear system;       /* of the first operator: with what the scheme holds taken out of C and K */
	struct resolvent *written;  /* of the model as written: the report's poles, the closed form */
	const struct step *shown;   /* what users see of tables: over the states as written; itself, where those are stepped */
	struct resolvent *solved;   /* of `system` */
	struct table *table;        /* of the whole step, of the first operator */
	int operators, tables;      /* 1 and 1 where nothing is left over */
	struct linear *operator;    /* the system of each */
	struct resolvent **resolvent;
	struct table ***all;        /* [operator][table] */
	struct program *program;
	enum step_form form;        /* FORM_DIRECT, FORM_DELTA or FORM_KICK_DRIFT_KICK */
	const mpq_t *mass;          /* of kick-drift-kick, per coordinate; in units of the first */
	bool momenta;               /* NAME keeps mass times velocity, since not all masses are equal */
	int carries, *carry;        /* states that nothing leads back from, which only add up: index of what rounding takes from each; -1: of others */
	struct forced *forced;      /* NAME keeps the state less this; NULL: as it is */
	struct rounding rounding;
	mpfr_t growth;              /* pl: 1/s, largest real part of the modified equation's poles (report only) */
	struct series series;
	int *halvings;              /* of a piecewise-linear model, per operator */
};
struct step *step_build(const struct model *model);         /* NULL: it was said why */
bool has_leftover(const struct step *step);                 /* or nothing is left over, and a step is assignments */

/* ---- stepform.c: a linear step as direct, delta or kick-drift-kick ---- */

const char *step_form_name(enum step_form form);
const char *form_text_of(const struct step *step);          /* delta, compensated */
bool step_form_of(const char *name, enum step_form *form);  /* false: there is none of this name */
void choose_form(struct step *step);                        /* leaves the statement where the one asked for cannot be */
void need_direct(const struct step *step);                  /* the same where another than direct is asked for */
void find_carries(struct step *step);                       /* before its program; none where all of the state is compensated */
struct program *linear_program(const struct step *step);    /* from its table */
bool has_second_word(const struct product *p, const struct linear *system); /* in the code: loads that change have none */
void count_loads(struct program *program, const struct linear *system, bool single); /* what the load states of the columns in use cost */

/* ---- forced.c: what rounding does to a step with loads ---- */

void plan_forced(struct step *step);                         /* its rounding; its forced part, where the bound is the better for it */
bool is_forced(const struct step *step, int column);         /* is this load state's load left out of the step? */
const char *rounding_text(const struct step *step);

/* ---- drift.c: what the rounding of its constants does to a linear step ---- */

struct drift {                      /* per step, of the mode where it is largest */
	double amplitude;           /* ln|z| - Re p h */
	double phase;               /* |arg z - Im p h| [rad] */
	bool known;                 /* nothing is left over, and the step does not loop over tables */
};
struct drift drift_of(const struct step *step);
const char *drift_text(const struct drift *drift);          /* over 1e9 steps */

/* ---- left.c: forms with atoms as C ---- */

struct emitter;
struct cost { int multiplications, additions, calls; };
struct cost leftover_cost(const struct step *step);         /* of one evaluation */
struct reads {                    /* what forms read */
	bool *state, *input, *load; /* inputs, then their slopes */
	bool *highest;              /* per coordinate: its highest derivative */
	bool time, math;            /* t itself; <math.h> */
};
struct reads reads_of(const struct model *model, int count, const struct form *const *form);
struct writer;                      /* declares locals for what several places use as it goes */
struct writer *writer_new(const struct emitter *e, const char *(*basis_text)(const struct emitter *, const struct basis *), int count,
			  const struct form *const *form);
const char *write_form(struct writer *w, const struct form *form, int indent);

/* ---- report.c: poles and polynomials for a reader ---- */

struct pole_report {                /* sorted by |p|, then by real part */
	mpfr_t re, im;              /* rounded from 256 bits */
	mpfr_t hertz, damping_ratio;
	int multiplicity;
	bool pair;                  /* stands for itself and its conjugate */
};
int poles_of(const struct model *model, const struct resolvent *resolvent, struct pole_report **report); /* an error at the step where they are not told apart */
const char *pole_text(const struct pole_report *report);
const char *polynomial_text(int length, const mpq_t *c);    /* in s */
const char *column_text(const struct load *load, int column); /* t*exp(-2*t)*cos(5*t) */
const char *equation_text(const struct model *model, const struct form *residual); /* coordinates = loads */
const char *form_text(const struct model *model, const struct form *form);          /* atoms spelled out, long ones cut short */
const char *irrationals_text(const struct irrationals *used);

/* ---- cprint.c: expressions as C ---- */

bool may_be_macro(const char *name);
void name_for_c(const struct model *model, const char *upper, const char **local); /* gives every symbol and every state its C identifier */
const char *written_local(const struct model *written, int state); /* after that: of a written state */
const char *c_expression(const struct node *node);          /* fit for a term of a sum; accelerations count as 0 */
bool vanishes(const struct node *node);                     /* nothing is left when accelerations are 0 */
void mark_used(const struct node *node, bool *math);        /* flags the symbols that it needs; *math: it needs <math.h> */

/* ---- emit.c, emit_step.c, emit_left.c, emit_out.c, emit_loads.c, emit_time.c, emit_tune.c, emit_rhs.c: a step as C ---- */

struct emitter {
	FILE *to;
	const struct step *step;
	const struct model *model;
	const struct linear *system;
	const char *name, *upper;   /* scs, SCS */
	const char *options;
	const char **local;         /* per state: the C local that holds it */
	int phases, growths;        /* in the state */
	int *phase, *growth;        /* per load: index of its phase and of its growth; -1: none */
	bool ramps;                 /* some input is of first order */
	bool at_node;               /* load states are those at `node` of the step, not at its start */
};
void emit_header(FILE *to, const struct step *step, const char *options, bool rhs);
void emit_code(FILE *to, const struct step *step, const char *options, const char *header_name, bool rhs); /* header_name NULL: all in one */

const char *tree(int terms, const char *const *term, int indent); /* a balanced sum */
const struct model *speaker(const struct model *model);            /* over whose coordinates its forms are */
const char *stepped_table(const struct emitter *e, const char *table); /* Phi or Gamma of the states as they are kept */
double finite_number(const struct emitter *e, mpq_srcptr q);       /* rounded; an error at the step where it overflows */
const char *scaled(double factor, const char *operand);           /* operand NULL: 1 */
void emit_number_rows(const struct emitter *e, int rows, int columns, const double *value, const char *const *row_note);

void emit_load_tables(const struct emitter *e);                   /* phases and growths: start, step, rate */
void emit_load_members(const struct emitter *e);
void emit_load_set(const struct emitter *e);
void emit_load_advance(const struct emitter *e, const char *steps); /* `steps` NULL: one */
void emit_load_states(const struct emitter *e, const bool *loads, bool time_is_there); /* declares load1[...] for the loads wanted */
void emit_forced(const struct emitter *e);                        /* NAME_forced: what is not kept of the state */
const char *load_operand(const struct emitter *e, int load, int column); /* NULL: the constant 1 */
const char *column_operand(const struct emitter *e, int column);

void emit_phase_rates(const struct emitter *e);                   /* rows of initialisers */
const char *phase_step_text(const struct emitter *e, int load);   /* in one step: a turn, as an initialiser */
const char *growth_step_text(const struct emitter *e, int load);
const char *low_text(mpq_srcptr q);                               /* what its rounding leaves out, rounded */
const char *two_text(mpq_srcptr q);                               /* {hi, lo} */
const char *step_length(const struct emitter *e);                 /* NAME_H; of tunable models that of the instance s */
void emit_changes(const struct emitter *e);                       /* loads that change their formula: when */
void emit_passing(const struct emitter *e);                       /* ... and pass(), across a change */
void emit_series_vector(const struct emitter *e);                 /* declares i and load states; x[...] = what the series advances */
void emit_set_aside(const struct emitter *e);                     /* in a step that is no list of assignments: what only adds up is 0 over it */
void emit_take_back(const struct emitter *e);
void emit_hand_over(const struct emitter *e);                     /* in at: y from the states in x */
void emit_locals(const struct emitter *e, const bool *reads);     /* the states wanted, under their names */
void emit_raw_locals(const struct emitter *e, const bool *reads, bool changing); /* as kept: of kick-drift-kick, momenta */
void emit_store(const struct emitter *e, const char *vector, const char *indent); /* s->y from states */
void emit_load_state(const struct emitter *e, const char *vector);  /* states from s->y */
void emit_kept_state(const struct emitter *e, const char *vector);  /* the same, less their forced part where the step keeps them so */
void emit_state_forced(const struct emitter *e, const char *vector, const char *indent); /* s->y from states that are whole */
void emit_locals_of(const struct emitter *e, const bool *reads, const char *vector);
void emit_step(const struct emitter *e);
void emit_step_end(const struct emitter *e);                      /* samples, phases and time move on */
const char *step_parameters(const struct emitter *e);
const char *input_operand(const struct emitter *e, int column);
const char *input_name(const struct emitter *e, int input, int order); /* the C name of an input, of its slope */
void emit_regions(const struct emitter *e);                       /* tables of a piecewise-linear model */
void emit_region_declarations(const struct emitter *e);
void emit_region_members(const struct emitter *e);
void emit_region_start(const struct emitter *e);                  /* in set */
void emit_region_step(const struct emitter *e);
void emit_region_at(const struct emitter *e);
void emit_leftover_functions(const struct emitter *e);            /* what is left over; which operator serves */
void emit_leftover_step(const struct emitter *e);
const char *basis_now(const struct emitter *e, const struct basis *basis); /* in terms of locals: states, inputs, load states, t */
const char *leftover_of_step(const struct emitter *e);            /* its call at the start of a step, into `left` */
const char *leftover_of_outputs(const struct emitter *e);
void emit_samples(const struct emitter *e);                       /* start, slope: what leftovers read of ramps */
/* Of models with tunable params: */
void emit_coefficient_struct(const struct emitter *e);
void emit_tuning_declarations(const struct emitter *e);
void emit_tuning_wrapper(const struct emitter *e);                /* of the descriptor */
void emit_name_list(const struct emitter *e, const char *array, int count, const char *const *name);
void banner_tuning(const struct emitter *e);
void emit_nominal(const struct emitter *e);                       /* the generator's own coefficients, of the spec's values */
void emit_retune(const struct emitter *e);                        /* the equations, retune, use */
void emit_tuned_at(const struct emitter *e);                      /* pass, from change to change of the loads; at */
const char *tuned_factor(const struct emitter *e, int row, const struct operand *operand);
const char *tuned_output(const struct emitter *e, const struct output *output); /* its sum; NULL: no param changes it */
bool tuned_output_reads(const struct emitter *e, const struct output *output, int column); /* columns of x as in struct tuning */
const char *selection_call(const struct emitter *e);              /* which operator of a bank serves now */
void emit_node_phases(const struct emitter *e, const bool *loads); /* phases and growths from the start of the step to each node */
int  coordinate_of_row(const struct model *model, int row);       /* whose equation it is */
void emit_out(const struct emitter *e);
/* A number for each output, then for each highest derivative that outputs which are not linear read */
int place_of_output(const struct model *model, const struct output *output);
void emit_at(const struct emitter *e);
void emit_jump(const struct emitter *e);
void emit_rhs(const struct emitter *e);
bool rhs_needs_math(const struct model *model);

/* ---- selftest.c: reference states in closed form, for the target to step to ---- */

void need_closed_form(const struct step *step);              /* leaves the statement where there is none */
void emit_selftest(const struct emitter *e, bool jumps);

/* ---- single.c: the target float ---- */

void print_single(FILE *to, const char *text);               /* C for double as C for float */

/* ---- apart.c: locals apart from the model's type ---- */

void print_apart(FILE *to, const char *text, const char *name); /* the C of a model of this name, none of whose locals are called so */

/* ---- explain.c, solution.c ---- */

void explain_person(FILE *to, const struct step *step);
void explain_json(FILE *to, const struct step *step);
void print_solution(FILE *to, const struct model *model, struct resolvent *written, mpq_srcptr end);

#endif
