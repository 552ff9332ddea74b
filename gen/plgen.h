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
#define NEW(type) ((type *)allocate(1, sizeof(type)))
#define ARRAY(type, count) ((type *)allocate(count, sizeof(type)))
#define ENLARGE(array, count) ((array) = enlarge(array, count, sizeof *(array)))

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
void say_warning(struct place at, const char *note, const char *fmt, ...) __attribute__((format(printf, 3, 4)));
_Noreturn void error(struct place at, const char *note, const char *fmt, ...) __attribute__((format(printf, 3, 4)));
_Noreturn void abandon(void);                              /* leave the statement; its error has been said before */
bool statement_guard(void (*work)(void *), void *context); /* true if the work ran to its end */
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
	NODE_CHOOSE                 /* condition, then, else */
};
struct node {
	enum node_kind kind;
	struct place at;            /* of the token that makes it: a name, an operator, a function */
	struct place start, end;    /* its text, brackets included */
	mpq_t number;
	struct symbol *symbol;      /* of NODE_NAME */
	int primes;
	enum function function;
	enum comparison comparison;
	int children;
	struct node **child;
	bool *inverse;              /* of SUM and PRODUCT, one per child */
	struct place *operator;     /* of SUM and PRODUCT: the sign before each child */
};
enum symbol_kind { SYMBOL_PARAM, SYMBOL_COORD, SYMBOL_LET, SYMBOL_OUTPUT };
struct symbol {
	enum symbol_kind kind;
	bool used;                  /* by the expressions now being printed */
	const char *c_name, *c_dot; /* C identifiers of it and, for a coordinate, of its velocity */
	const char *name;
	struct place at;
	size_t statement;           /* offset of the statement that declares it */
	int index;                  /* among its kind, in the order of declaration */
	bool broken;                /* its own statement failed: what uses it is passed over in silence */
	struct node *value;         /* of param, let, output */
	struct form *form;          /* value collected, when `collected` */
	enum { FRESH, COLLECTING, COLLECTED } progress;
	struct symbol *next;
};
struct equation {
	struct place at, end;       /* first token; just after the last */
	struct node *left, *right;
};
struct initial {
	struct place at;
	size_t statement;
	struct symbol *coord;
	int primes;
	struct node *value;
};
struct spec {                       /* what the text says, names resolved, nothing evaluated */
	const struct source *source;
	const char *name;
	struct place name_at;
	struct symbol *first, **last;   /* all symbols in the order of declaration */
	int params, coords, lets, outputs;
	int equations;
	struct equation *equation;
	int initials;
	struct initial *initial;
	struct node *step;
	struct place step_at;
	const char *scheme;
	struct place scheme_at;
	struct place end;
};
struct spec *parse_spec(const struct source *source);
struct node *parse_argument(struct spec *spec, const struct source *source, size_t from); /* an expression from the command line */
struct symbol *spec_find(const struct spec *spec, const char *name);
char *text_between(struct place start, struct place end);   /* without comments, white space folded */

/* ---- names.c: words with a meaning of their own ---- */

bool is_reserved(const char *name);                         /* words that a user's name may not be */
const char *prefix_objection(const char *name);             /* why it cannot name generated code, or NULL */
enum function function_of(const char *name);
const char *function_name(enum function function);
const char *nearest_name(const char *name, int count, const char *const *known); /* or NULL */
const char *spec_suggestion(const struct spec *spec, const char *name); /* a note with the nearest known name, or NULL */

/* ---- form.c: symbolic collection; a form is linear in what the linear core can carry ---- */

enum basis_kind { BASIS_ONE, BASIS_PI, BASIS_TIME, BASIS_WAVE, BASIS_COORD };
struct basis {
	enum basis_kind kind;
	int coord, order;           /* of BASIS_COORD: which, and how often differentiated */
	struct wave *wave;          /* of BASIS_WAVE */
	bool sine;
};
struct wave {                       /* cos and sin of w t + p; w > 0 */
	mpq_t w, p;
	int index;                  /* in the order of first appearance */
	struct wave *next;
};
struct form_term {
	struct basis basis;
	mpq_t factor;
};
struct form {                       /* sum of factor * basis, sorted, no zero factors */
	int terms;
	struct form_term *term;
};
struct irrationals { bool used[FN_TABLE + 1], pi, root; };  /* which became rationals of 256 bits; `root`: of a power */
struct collector {
	struct wave *waves;
	int wave_count;
	struct irrationals irrationals;
	const char *scheme;         /* for the message about a term that it cannot treat */
	const struct node *term;    /* the innermost additive term being collected */
	const struct node *argument; /* the innermost function of which an argument is being collected that must be linear */
	bool constant_only;         /* a param, a step, an initial value */
	bool tolerant;              /* give up in silence on what is not linear: an output may be */
};
struct form *collect(struct collector *collector, struct node *node);   /* leaves the statement at what is not linear */
void collect_constant(struct collector *collector, struct node *node, mpq_ptr value);
void constant_value(struct collector *collector, const struct form *form, mpq_ptr value); /* form of 1 and pi only */

/* ---- constant.c: functions of constants; true where the value is exact, else it is the nearest of 256 bits ---- */

void constant_pi(mpq_ptr value);
bool constant_function(struct place at, enum function function, mpq_srcptr x, mpq_ptr value);
bool constant_atan2(struct place at, mpq_srcptr y, mpq_srcptr x, mpq_ptr value);
bool constant_power(struct place at, mpq_srcptr base, mpq_srcptr exponent, mpq_ptr value);

/* ---- model.c: the equations of motion, exact ---- */

struct load {                       /* force on the equations: constant, or cos and sin of one wave */
	const struct wave *wave;    /* NULL: constant */
	int columns;                /* 1 or 2 */
	mpq_t *force[2];            /* per column: one rational per equation */
};
struct linear {                     /* M q'' + C q' + K q = force - heldC q'(t_n) - heldK q(t_n) */
	int n;
	mpq_t *M, *C, *K;           /* n x n, row-major */
	mpq_t *heldC, *heldK;       /* n x n, or NULL where nothing is held */
	int loads;
	struct load *load;
};
struct output {
	const char *name;
	struct node *value;         /* as written */
	struct form *form;          /* NULL where it is not linear in states and loads */
	mpq_t *state;               /* factors of y, one per state, accelerations replaced */
	mpq_t *load[2];             /* factors of cos and sin, one per load; those of a constant load are 0 */
	mpq_t constant, time;       /* and of 1 and t */
};
enum scheme { SCHEME_EXACT, SCHEME_PL };
struct model {
	const struct spec *spec;
	const char *name;           /* prefix of everything generated */
	int n, states;
	const char **state_name;    /* x1, x2, x1', x2' */
	struct symbol **coord;
	struct linear system;       /* as written */
	struct irrationals irrationals;
	mpq_t *initial;             /* one per state */
	mpq_t h;
	struct place step_at;       /* where h is given */
	struct place end_at;         /* where the end of --solution is given, else h */
	enum scheme scheme;
	int outputs;
	struct output *output;
	bool declared_outputs;
};
struct overrides {                  /* from the command line */
	const char *step, *scheme, *prefix;
	int definitions;
	const char **definition;    /* NAME=EXPR */
};
struct model *model_build(struct spec *spec, const struct overrides *overrides);
void argument_value(struct model *model, const char *text, mpq_ptr value); /* of --solution; may use params */
const char *scheme_name(enum scheme scheme);
bool rational_inverse(int n, const mpq_t *A, mpq_t *inverse, int *column); /* false: singular, *column free */
void rational_product(int rows, int inner, int columns, const mpq_t *A, const mpq_t *B, mpq_t *AB);

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

struct resolvent;                   /* adj P and B of one system */
struct resolvent *resolvent_of(const struct linear *system);
struct response *image_of_state(struct resolvent *r, int i, int j);            /* Phi_ij: state i from state j */
struct response *image_of_load(struct resolvent *r, int i, int load, int column); /* state i from cos or sin at the start */
struct response *image_of_solution(struct resolvent *r, const mpq_t *initial, const struct output *output); /* output(t) from the start */
void characteristic_polynomial(const struct resolvent *r, mpq_t *coefficient); /* B(s) = det P, 2n+1 of them */
struct response *image_of_wave(const struct wave *wave, bool sine);            /* cos or sin of w t, without its phase */
const struct poly *resolvent_determinant(const struct resolvent *r);           /* B(s) times the scales of the rows */

/* ---- number.c: the border to rounded numbers ---- */

double round_rational(mpq_srcptr q);                        /* nearest double; +-HUGE_VAL beyond the range */
bool   beyond_double(mpq_srcptr q);
const char *finite_text(struct place at, mpq_srcptr q);     /* shortest; leaves the statement at a value beyond the range */
bool   round_enclosure(mpfi_srcptr x, double *d);           /* false: both ends do not round to one double */
const char *shortest(double d);                             /* fewest digits that read back; a C literal of type double */
const char *exact_text(mpq_srcptr q);                       /* a decimal if there is one, else p/q */
const char *readable_text(mpq_srcptr q);                    /* the same while it is short, else 12 digits */

/* ---- coefficients.c: numbers of the step, each rounded once ---- */

struct coefficient {
	double value, low;          /* value + low is the number in two words (low only where asked for) */
	bool zero;                  /* exactly: no trace in the code */
};
struct table {                      /* of one step: y+ = Phi y + sum of columns */
	int states, columns;
	struct coefficient *Phi;    /* states x states */
	struct coefficient *load;   /* states x columns: of the loads in order, cos before sin */
};
void check_pole_size(const struct model *model, const struct resolvent *resolvent); /* leaves the statement where |p| h is hopeless */
struct coefficient coefficient_of_rational(mpq_srcptr q);
/* Rounded, infinite beyond the range; `at` and `what` name it where it cannot be decided. */
struct coefficient response_value(struct response *response, mpq_srcptr tau, bool two_words, struct place at, const char *what);
struct table *table_of(const struct model *model, struct resolvent *resolvent, const struct linear *system, bool two_words);
void rotation_of(const struct model *model, const struct wave *wave, struct coefficient *cosine, struct coefficient *sine); /* over h */

/* ---- series.c: the Taylor series behind NAME_at ---- */

struct step;
struct series {                     /* x' = A x; x = state, held terms, constant load, cos and sin of each wave */
	bool emitted;               /* max|pole| h <= 8 */
	int size, degree, halvings;
	mpq_t *A;                   /* size x size */
	int held;                   /* index of the first held term, one per coordinate; -1: none */
	int *load;                  /* index of the first state of each load; -1: it acts on nothing */
};
void series_plan(struct step *step);

/* ---- scheme.c: what a scheme steps with, as a program over tables ---- */

enum operand_kind { OPERAND_STATE, OPERAND_LOAD };
struct operand {
	enum operand_kind kind;
	int index;                  /* state; or column of the loads */
};
struct product {
	const struct coefficient *factor;
	struct operand operand;
};
struct assignment {                 /* target <- sum of products */
	int target;                 /* state */
	int terms;
	struct product *term;
};
struct program {
	int assignments;
	struct assignment *assignment;
	bool *reads;                /* per state: whether its old value is read */
	bool *uses;                 /* per column of the loads */
	int oscillators;            /* cos/sin pairs evaluated per step */
	int multiplications, additions;
};
struct step {                       /* everything that is emitted for one model */
	const struct model *model;
	struct linear system;       /* with what the scheme holds taken out of C and K */
	struct resolvent *written;  /* of the model as written: the report's poles, the closed form */
	struct resolvent *solved;   /* of `system` */
	struct table *table;
	struct program *program;
	mpfr_t growth;              /* pl: 1/s, largest real part of the modified equation's poles (report only) */
	struct series series;
};
struct step *step_build(const struct model *model);         /* NULL: it was said why */
int load_columns(const struct linear *system);

/* ---- report.c: poles and polynomials for a reader ---- */

struct pole_report {                /* sorted by |p|, then by real part */
	mpfr_t re, im;              /* rounded from 256 bits */
	mpfr_t hertz, damping_ratio;
	int multiplicity;
	bool pair;                  /* stands for itself and its conjugate */
};
int poles_of(const struct resolvent *resolvent, struct pole_report **report);
const char *pole_text(const struct pole_report *report);
const char *polynomial_text(int length, const mpq_t *c);    /* in s */
const char *wave_text(const struct wave *wave, bool sine);
const char *irrationals_text(const struct irrationals *used);

/* ---- cprint.c: expressions as C ---- */

bool may_be_macro(const char *name);
void name_for_c(const struct spec *spec, const char *name, const char *upper); /* gives every symbol its C identifiers, clear of each other */
const char *c_expression(const struct node *node);          /* fit for a term of a sum; accelerations count as 0 */
bool vanishes(const struct node *node);                     /* nothing is left when accelerations are 0 */
void mark_used(const struct node *node, bool *math);        /* flags the symbols that it needs; *math: it needs <math.h> */

/* ---- the printers ---- */

void emit_header(FILE *to, const struct step *step, const char *options, bool rhs);
void emit_code(FILE *to, const struct step *step, const char *options, const char *header_name, bool rhs); /* header_name NULL: all in one */
void explain_person(FILE *to, const struct step *step);
void explain_json(FILE *to, const struct step *step);
void print_solution(FILE *to, const struct model *model, struct resolvent *written, mpq_srcptr end);

#endif
