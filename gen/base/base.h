/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Memory, texts and what is said about them, numbers of the target: what every room stands on.
 *
 * Glossary.  The field's letters collide; in this program they mean:
 *   M, C, K    mass, damping and stiffness matrix of the equations as written
 *   P(s)       M s^2 + C s + K, the dynamic stiffness: P(s) Q(s) = (M s + C) q(0) + M q'(0) + F(s)
 *   B(s)       det P(s), the characteristic polynomial; its roots are the poles
 *   N/D        the image of one number in s: numerator and denominator, coprime
 *   Phi        transfer matrix over one step: y(t+h) = Phi y(t) + loads; y = coordinates, then velocities
 *   h, tau     the step; a time after the step's start
 *   w, p       angular frequency [rad/s] and phase [rad] of a load cos(w t + p)
 *   forcing term       a load cos(w t + p) or sin(w t + p); the two of one (w, p) share an oscillator
 *   held       terms that a scheme keeps at their value at the start of the step
 *
 * Data flow: source -> tokens -> nodes -> model (exact) -> images N/D (exact) -> poles, residues (enclosed)
 *            -> coefficients (rounded once) -> step program -> C, header, report.
 * No double stands before `coefficients`, the starting values of the root iteration excepted.
 */
#ifndef PLGEN_BASE_H
#define PLGEN_BASE_H

#include <gmp.h>
#include <mpfr.h>
#include <mpfi.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

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
	LIMIT_SENSITIVITIES = 64,   /* params, initial values and inputs that derivatives are by */
	LIMIT_FORMULAS = 65535,     /* numbers that follow from them, constants counted: a short in pl_operation */
	/* states, loads and inputs of an independent block whose e^{A h} the target computes */
	LIMIT_TUNED_BLOCK = 64,
	LIMIT_REGIONS = 243,        /* of a piecewise-linear model, in one segment of time */
	LIMIT_REGIONS_IN_TIME = 1024, /* in all */
	LIMIT_IMPACTS = 30,         /* 'when' and stops that bounce: bits of a word in pl_guards */
	MAX_EVENTS = 32,            /* crossings in a step of generated code, unless the spec says */
	MOST_IN_STEP = 1 << 16,     /* with those of friction and impacts that are not listed */
	LIMIT_EVENTS = 512,         /* that a spec may ask for */
	SPLIT_POWERS = 3,           /* of a force over a part of a step: its value and two derivatives */
	LIMIT_COMPARED = 6,         /* operands of min and max whose crossings are found */
	LIMIT_STRAIGHTS = 100,      /* pieces of a table likewise */
	LIMIT_PIECES = 30,          /* halvings of a step in which crossings are looked for */
	MAX_SPLITS = 1000,          /* looks at polynomials in search of them, in a step, */
	LOOKS_OF_STEP = 16,         /* or where the spec says how many events: these, */
	LOOKS_OF_EVENT = 12,        /* and for each of them */
	LIMIT_FORCINGS = 500,       /* frequencies, phases and growths of loads */
	LIMIT_LOAD_POWER = 32,      /* exponent of a load, as in t^3 */
	LIMIT_TUNED_NUMBERS = 8192, /* of matrices of regions that an instance has, where params change them */
	LIMIT_UNROLLED_STATES = 16, /* beyond, a step loops over its tables */
	LIMIT_RESIDUE_STATES = 12,  /* beyond, a Taylor series gives the numbers: residues get slow */
	LIMIT_DELAY = 100000,       /* steps */
	LIMIT_DELAY_PARTS = 64,     /* of a step, of which all delays are multiples */
	LIMIT_BLOCK_ROWS = 64,      /* in a block of NAME_run */
	LIMIT_NEED_STATES = 128,    /* of a model with needs */
	LIMIT_MODES = 128,          /* of a scheme in normal modes */
	LIMIT_WITHIN = 1000,        /* radians of a mode in a step that has values inside: as many series */
	LIMIT_SHAPES = 40,          /* coordinates of a model whose mode shapes are reported */
	LIMIT_TRANSFERS = 24,       /* states of one whose transfer functions are, */
	LIMIT_SWEPT = 64,           /* states of one that is swept */
	LIMIT_SAMPLES = 1000000,    /* in a period of a sweep */
	LIMIT_HELD_STATES = 64,     /* and whose discrete state space is */
	LIMIT_FREQUENCIES = 100000, /* rows of --response */
	LIMIT_SERIES = 5000000,     /* multiplications of a Taylor series */
	LIMIT_COLLOCATED = 128,      /* coordinates of a collocation, whose matrices stand on the stack */
	LIMIT_TURNS = 256,          /* log2 of a load's angle in a step, for models of more states than that */
	LIMIT_ASSEMBLY = 1000,      /* of an assembly, */
	LIMIT_PARTS_INSIDE = 32,    /* inside each other */
	LIMIT_ERRORS = 100,         /* reported before the rest is not looked at */
	/* of an expression in operations, through params and lets; a function of many arguments counts as many */
	LIMIT_DEPTH = 10000,
	LIMIT_TERMS = 10000000,     /* of forms, made on the way to the equations */
	LIMIT_BYTES = 470000000,    /* held at a time */
	LIMIT_ROWS = 10000000,      /* of --solution */
	LIMIT_PRECISION = 16384,    /* bits of an enclosure before a coefficient is given up */
	IRRATIONAL_BITS = 256       /* pi, sqrt(2), ... become rationals of this many bits */
};

/* ---- memory.c: everything lives until the program ends; GMP, MPFR and MPFI allocate here too ---- */

void  memory_open(void);
void  memory_close(void);
bool  run_deep(void *(*work)(void *), void *context);       /* on a large stack; false: there is no memory for it */
/* what says that a limit is reached, and ends the program */
void  memory_on_limit(void (*report)(const char *message));
double memory_used(void);                                  /* part of LIMIT_BYTES */
void *allocate(size_t count, size_t size);                 /* zeroed */
void *need_memory(void *block);                            /* of a library: NULL ends the program as others do */
void *enlarge(void *block, size_t count, size_t size);     /* contents kept, the rest undefined */
char *format(const char *fmt, ...) __attribute__((format(printf, 1, 2)));
const char *name_list(int count, const char *const *name);     /* x, y; "" of none */
int place_among(int count, const char *const *name, const char *text, size_t length); /* of so long a text; -1: not */
int  *numbers_up_to(int count);                            /* 0, 1, ... */
mpq_t *rationals(size_t count);                            /* initialised to 0 */
mpq_t *rationals_copied(size_t count, const mpq_t *q);
mpz_t *integers(size_t count);                             /* 0 */
mpfr_t *reals(size_t count, mpfr_prec_t bits);             /* 0, of so many bits */
mpfi_t *enclosures(size_t count, mpfr_prec_t bits);        /* likewise */
bool  rationals_equal(size_t count, const mpq_t *a, const mpq_t *b);
bool  rationals_zero(size_t count, const mpq_t *q);       /* all of them are 0 */
void  rationals_free(mpq_t *q, size_t count);
void  discard(void *block);                                /* gives it back before the end; what it points to stays */
/* from the budget of LIMIT_TERMS; gives up when it is spent */
void  spend_terms(size_t count);
#define NEW(type) ((type *)allocate(1, sizeof(type)))
#define ARRAY(type, count) ((type *)allocate((size_t)(count), sizeof(type)))
#define ENLARGE(array, count) ((array) = enlarge(array, count, sizeof *(array)))
/* One more element: where it is */
#define MORE(array, count) (ENLARGE(array, (size_t)(count) + 1), &(array)[(count)++])

/* ---- what belongs to one block: cleared where that is left, by `return` too; `error` leaves it to the end ---- */

#define RATIONAL  __attribute__((cleanup(clear_rational))) mpq_t  /* RATIONAL x = ZERO, y = ZERO; */
#define INTEGER   __attribute__((cleanup(clear_integer))) mpz_t   /* INTEGER n = INTEGER_ZERO; */
#define REAL      __attribute__((cleanup(clear_real))) mpfr_t     /* REAL x = WITH_BITS(64); it is no number yet */
#define INTERVAL  __attribute__((cleanup(clear_interval))) mpfi_t /* INTERVAL x = OVER_BITS(64); likewise */
#define RATIONALS __attribute__((cleanup(clear_rationals))) mpq_t /* RATIONALS *x = rationals(n); */
#define INTEGERS  __attribute__((cleanup(clear_integers))) mpz_t
#define REALS     __attribute__((cleanup(clear_reals))) mpfr_t    /* REALS *x = reals(n, 64); */
#define INTERVALS __attribute__((cleanup(clear_intervals))) mpfi_t /* INTERVALS *x = enclosures(n, 64); */
#define SCRATCH   __attribute__((cleanup(clear_scratch)))         /* SCRATCH double *x = ARRAY(double, n); */
#define ZERO { new_rational() }
#define RATIO(p, q) { new_ratio(p, q) }                           /* without a common factor */
#define INTEGER_ZERO { new_integer() }
#define WITH_BITS(bits) { new_real(bits) }
#define OVER_BITS(bits) { new_interval(bits) }

size_t block_size(void *block);                            /* bytes; NULL: 0 */
/* What is held elsewhere is cleared by its address; NULL: nothing. */
void clear_rationals(mpq_t **q);
void clear_integers(mpz_t **z);
void clear_reals(mpfr_t **x);
void clear_intervals(mpfi_t **x);
void clear_scratch(void *block);                           /* the address of what points to it */

static inline __mpq_struct new_rational(void)
{
	mpq_t x;
	mpq_init(x);
	return *x;
}

static inline __mpq_struct new_ratio(long p, unsigned long q)
{
	mpq_t x;
	mpq_init(x);
	mpq_set_si(x, p, q);
	return *x;
}

static inline __mpz_struct new_integer(void)
{
	mpz_t n;
	mpz_init(n);
	return *n;
}

static inline __mpfr_struct new_real(mpfr_prec_t bits)
{
	mpfr_t x;
	mpfr_init2(x, bits);
	return *x;
}

static inline __mpfi_struct new_interval(mpfr_prec_t bits)
{
	mpfi_t x;
	mpfi_init2(x, bits);
	return *x;
}

static inline void clear_rational(mpq_t *x) { mpq_clear(*x); }
static inline void clear_integer(mpz_t *n) { mpz_clear(*n); }
static inline void clear_real(mpfr_t *x) { mpfr_clear(*x); }
static inline void clear_interval(mpfi_t *x) { mpfi_clear(*x); }

/* ---- progress.c: how far slow work is, on stderr ---- */

void progress(const char *what, int done, int all);         /* done = 0 starts the clock */
void progress_end(void);                                    /* the line goes */

/* ---- source.c: texts, places in them, and what is said about a place ---- */

struct source {
	const char *name;           /* as the user named it */
	const char *base;           /* without folders: what generated text shows */
	const char *text;           /* ends with a 0 byte that does not count */
	size_t length;
	int order;                  /* in which they were opened: the spec first */
	bool repeats;               /* a part, in the model as often as it is used: of a place the first is reported */
	const struct source *tunables;  /* the list of --tunable, which is read behind this text */
};
struct place {
	const struct source *source;
	size_t offset;
};
/* "-" is standard input, unless `at` names the file; says what went wrong, there or at its start, and returns NULL */
struct source *source_read(const char *path, struct place at);
struct source *source_text(const char *name, const char *text);
struct source *source_argument(const char *text);          /* a value from the command line */
struct place place_end(const struct source *source);       /* just after the last character of the last line */

/* An error is kept until diagnostics_print, which sorts by place. `error` does not return: it leaves the statement
 * through the innermost `statement_guard`. */
void say_error(struct place at, const char *note, const char *fmt, ...) __attribute__((format(printf, 3, 4)));
_Noreturn void error(struct place at, const char *note, const char *fmt, ...) __attribute__((format(printf, 3, 4)));
void work_at(struct place at);                             /* what is said to cost too much from now on */
struct place working_at(void);
/* an error there, and the end: what is spent does not come back */
_Noreturn void give_up(const char *message);
_Noreturn void abandon(void);                              /* leave the statement; its error has been said before */
void say_warning(struct place at, const char *note, const char *fmt, ...) __attribute__((format(printf, 3, 4)));
void say_note(struct place at, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
/* An option that only makes a step cheaper has no effect here, and why */
void stand_aside(struct place at, const char *option, const char *why);
const char *next_aside(int *from);                         /* of those said, from number `from` on; NULL: no more */
bool statement_guard(void (*work)(void *), void *context); /* true if the work ran to its end */
bool silent_guard(void (*work)(void *), void *context);    /* the same; what it says when it fails is forgotten */
const char *refusal_of(void (*work)(void *), void *context); /* so; NULL: it ran to its end; else the first error */
const char *unheard_refusal_of(void (*work)(void *), void *context); /* its warnings are forgotten too */
bool warnings_are_heard(void);                             /* false: inside that */
void diagnostics_context(const char *note);                /* the note of what has none from now on; NULL: none */
int  diagnostics_errors(void);
bool diagnostics_harden(void);                             /* warnings become errors: are there any? */
void diagnostics_print(FILE *to);
void check_bits(struct place at, mpq_srcptr value);        /* the limit on exact values */
void check_power(struct place at, mpq_srcptr base, unsigned long exponent); /* the same, before the work */

/* ---- traced.c: how exact numbers follow from given ones ---- */

enum traced_op { TRACED_GIVEN, TRACED_SUM, TRACED_PRODUCT, TRACED_QUOTIENT };
struct traced_part {
	int number;                 /* of the record; -1: a constant */
	bool negative;              /* it is taken off */
	mpq_srcptr constant;        /* its size */
};
struct traced {                     /* above 0 where it was recorded; GIVEN: a.number of what was given */
	enum traced_op op;
	struct traced_part a, b;
};
/* Records what is made of numbers that have these values, here, until it pauses; others at another place and in the
 * spec. */
void trace_from(int count, const mpq_t *here, const mpq_t *there, const mpq_t *spec);
void trace_pause(void);
bool is_traced(size_t count, mpq_srcptr x);                 /* now, and some of them is one of the record's */
/* Its number, or that of its opposite; -1: it is none, or has another value there */
int  traced_as(mpq_srcptr here, mpq_srcptr there);
/* x, as the spec's values give it, times the factor: not recorded */
void product_at_spec(mpq_ptr product, mpq_srcptr x, mpq_srcptr factor);
const struct traced *trace_record(int *count);              /* as it is by now: what a number is made of, before it */
void traced_add(mpq_ptr result, mpq_srcptr a, mpq_srcptr b);
void traced_sub(mpq_ptr result, mpq_srcptr a, mpq_srcptr b);
void traced_mul(mpq_ptr result, mpq_srcptr a, mpq_srcptr b);
void traced_div(mpq_ptr result, mpq_srcptr a, mpq_srcptr b);
#undef mpq_add
#undef mpq_sub
#undef mpq_mul
#undef mpq_div
#define mpq_add traced_add
#define mpq_sub traced_sub
#define mpq_mul traced_mul
#define mpq_div traced_div

/* ---- number.c: the border to rounded numbers ---- */

/* The target's type is double, or float after target_float; a double holds its numbers. */
void   target_float(void);
void   target_double(void);
const char *target_name(void);
/* nearest of the target's numbers; +-HUGE_VAL beyond the range */
double round_rational(mpq_srcptr q);
void   round_roughly(mpq_ptr to, mpq_srcptr q);             /* to a double; beyond their range to is q */
double rounding_rest(mpq_srcptr q);                         /* what that leaves out of q, rounded */
double nearest_double(mpq_srcptr q);                        /* whatever the target */
bool   beyond_range(mpq_srcptr q);
/* shortest; leaves the statement at a value beyond the range */
const char *finite_text(struct place at, mpq_srcptr q);
bool   round_enclosure(mpfi_srcptr x, double *d);           /* false: both ends do not round to one number */
/* the same, to the nearest integer */
bool   round_integer(mpfi_srcptr x, mpz_ptr n);
/* to digits 2^exponent, so many bits; x is not 0 */
bool   round_bits(mpfi_srcptr x, int bits, mpz_ptr digits, long *exponent);
/* fewest digits that read back; a C literal, of type double */
const char *shortest(double d);

/* ---- texts.c: the runtime, inside the program ---- */

const char *runtime_text(const char *name);                 /* plrt.h, phases.c, ...; NULL: there is none */
const char *runtime_name(int file);                         /* of all of them, from 0; NULL: there are no more */

/* ---- rational.c: exact numbers: a step of a sum of products, and as text ---- */

void rational_addmul(mpq_ptr sum, mpq_srcptr a, mpq_srcptr b);     /* sum + a b */
void rational_submul(mpq_ptr sum, mpq_srcptr a, mpq_srcptr b);     /* sum - a b */
/* x is ratio times another, which is not 0 */
bool rationals_multiple(size_t count, const mpq_t *x, const mpq_t *of, mpq_ptr ratio);
long rational_bits(mpq_srcptr q);                           /* before its point, or one more */
const char *exact_text(mpq_srcptr q);                       /* a decimal if there is one, else p/q */
const char *readable_text(mpq_srcptr q);                    /* the same while it is short, else 12 digits */

#endif
