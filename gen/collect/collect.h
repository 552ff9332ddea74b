/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nodes to forms: sums of factors times what the linear core carries, and atoms for what it cannot. */
#ifndef PLGEN_COLLECT_H
#define PLGEN_COLLECT_H

#include "read/read.h"

/* ---- form.c: symbolic collection; a form is linear in what the linear core can carry ---- */

struct collector;
struct frame {                      /* the coordinates that forms are over */
	struct symbol **coord;      /* one a coordinate, `highest` its order */
	struct form **const *form;  /* [derivative][written coordinate]: over them; NULL: they are the written ones */
	int coords;                 /* behind them come multipliers of constraints, in forms of equations alone */
};
enum basis_kind { BASIS_ONE, BASIS_PI, BASIS_FORCING, BASIS_INPUT, BASIS_COORD, BASIS_ATOM };
struct basis {
	enum basis_kind kind;
	/* of BASIS_COORD and BASIS_INPUT: which, and how often differentiated; of BASIS_ATOM: its index */
	int index, order;
	struct forcing *forcing;    /* of BASIS_FORCING: t^power times its cos or sin */
	int power;
	bool sine;
	const struct atom *atom;    /* of BASIS_ATOM: an expression that the linear core cannot carry */
};
struct kept_response {              /* e^{a tau} times these of cos w tau and sin w tau: step/linear/loads.c */
	long cosine, sine;
	struct response *response;
	struct kept_response *next;
};
struct forcing {                    /* e^{a t} cos(w t + p) and sin, w > 0; or e^{a t} alone, w = p = 0 */
	mpq_t a, w, p;
	int index;                  /* in the order of first appearance */
	struct kept_response **kept;
	struct forcing *next;       /* of the same hash */
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
int basis_order(const struct basis *a, const struct basis *b); /* by which terms are sorted; 0: the same */
struct form *form_single(struct basis basis, mpq_srcptr factor);
struct form *form_unit(struct basis basis);                 /* factor 1 */
struct form *form_constant(mpq_srcptr value);
struct form *form_alias(const struct form *form);           /* the same terms: neither may be changed from then on */
struct form *form_number(long value);
struct form *form_sum(const struct form *a, const struct form *b, bool subtract);
struct form *form_difference(const struct form *a, const struct form *b);
/* Into `sum`, which nothing else holds: what many parts make costs no more than the parts. `factor` NULL: 1 */
void form_add_to(struct form *sum, const struct form *part, mpq_srcptr factor);
void form_add_basis(struct form *sum, struct basis basis, mpq_srcptr factor);
void form_free(struct form *form);                          /* which nothing else holds */
bool holds_atom(const struct form *form);
const struct form_term *form_find(const struct form *form, const struct basis *basis); /* NULL: it does not occur */
/* The terms of a form (NULL: there are none), each followed by those of its atom's operands, unless `seen`, per atom,
 * is set; then it is. NULL ends them. */
const struct form_term **terms_within(const struct form *form, bool *seen);
struct form *form_scale(const struct form *a, mpq_srcptr factor);
/* one of them constant */
struct form *form_product(struct collector *collector, const struct form *a, const struct form *b);
struct form *terms_of_kinds(const struct form *form, unsigned kinds); /* bit k: those of basis kind k */
struct form constant_terms(const struct form *form);        /* the first: 1 and pi; it shares them */
bool is_constant(const struct form *form);                  /* 1 and pi only */
bool has_coordinate(const struct form *form);               /* or an atom, or what stands behind those */
mpq_srcptr factor_of(const struct form *form, enum basis_kind kind); /* NULL: it does not occur */
bool same_in_states(const struct form *a, const struct form *b); /* they differ in loads only */
void check_form(struct place at, const struct form *form);  /* the limit on exact values */
void met_irrational(struct collector *collector, bool *which); /* one of its irrationals */
void constant_value(struct collector *collector, const struct form *form, mpq_ptr value); /* form of 1 and pi only */
bool same_form(const struct form *a, const struct form *b);
/* it depends on one; a coordinate of first order is one too */
bool is_velocity(const struct frame *frame, const struct basis *basis);
bool is_highest(const struct frame *frame, const struct basis *basis); /* the highest derivative of a coordinate */
struct basis multiplier_basis(const struct frame *frame, int constraint); /* as if it were an acceleration */
/* of a written coordinate; `frame` NULL: over itself */
struct form *coordinate_form(const struct frame *frame, int coord, int order);

/* ---- collector.c: what collection goes by, and what it says ---- */

/* which became rationals of 256 bits; `root`: of a power */
struct irrationals { bool used[FN_FRICTION + 1], pi, root; };
struct collector {
	struct forcings *forcings;  /* made on first use; of the collectors inside it too */
	struct irrationals irrationals;
	int irrational_count;       /* how often one was met */
	const char *scheme;         /* for the message about a term that it cannot treat */
	const struct node *term;    /* the innermost additive term being collected */
	int changes;                /* of formula in time: breakpoints found so far, rising */
	mpq_t *change;
	int interval;               /* between them, which is being collected: 0 .. changes */
	/* in which every condition on time that was met since it was opened has the outcome that it has now */
	struct span span;
	/* the innermost function of which an argument is being collected that must be linear */
	const struct node *argument;
	bool constant_only;         /* a param, a step, an initial value */
	bool tolerant;              /* give up in silence on what is not linear: an output may be */
	/* as atoms: what is piecewise linear; whatever is not linear */
	enum { KEEP_NOTHING, KEEP_PIECEWISE, KEEP_ALL } keep;
	bool vanishes;              /* multiplied by 0: as an atom it may be anything, in any scheme */
	/* with KEEP_ALL: conditions and products of time become atoms too, and time is not divided */
	bool whole_time;
	bool closed;                /* for --solution */
	bool output;                /* an output is being collected: highest derivatives may stand anywhere */
	bool equation;              /* an equation is: with KEEP_ALL they may have factors of the state */
	struct atoms *atoms;
	const struct frame *frame;  /* NULL: there are no coordinates */
	/* in outputs: per constraint its multiplier, solved for; NULL: the series has it, with what holds */
	struct form **multiplier;
	/* tunable params: the spec's values; with KEEP_ALL atoms; held inputs, behind the `inputs` of the spec, but for
	 * factors, which are numbers, and in outputs atoms */
	enum { PARAMS_VALUES, PARAMS_ATOMS, PARAMS_INPUTS } params;
	bool given;                 /* of tunable params only the given ones: what follows from them is put in */
	bool reading;               /* an output is being collected */
	int inputs;
	struct leads *leads;        /* of sines whose frequency such params change */
	int fixings;                /* lets that an operator fixes */
	const struct fixing *fixing;
};
bool keeps(const struct collector *c);                      /* atoms, as a scheme with a remainder takes them */
bool keeps_piecewise(const struct collector *c);            /* those that are piecewise linear */
_Noreturn void not_linear(const struct collector *c, const struct node *node, const char *why);
_Noreturn void not_built(const struct collector *c, struct place at, const char *what);
struct form *constant_call(struct collector *c, const struct node *node, enum function function, const struct form *x);
bool compare_values(enum comparison comparison, int order);
/* what scheme exact could treat in its place; "": none is known. force: of a force, not of an energy or constraint */
const char *rewrite_of(const struct node *term, bool force);

/* ---- constant.c: functions of constants; true where the value is exact, else it is the nearest of 256 bits ---- */

void constant_pi(mpq_ptr value);
bool constant_function(struct place at, enum function function, mpq_srcptr x, mpq_ptr value);
void wide_value(enum function function, mpfr_ptr x);         /* x = function(x) of one argument, at x's precision */
bool constant_atan2(struct place at, mpq_srcptr y, mpq_srcptr x, mpq_ptr value);
bool constant_power(struct place at, mpq_srcptr base, mpq_srcptr exponent, mpq_ptr value);

/* ---- forcing.c: loads in time ---- */

struct forcing *forcing_of(struct collector *collector, mpq_srcptr a, mpq_srcptr w, mpq_srcptr p);
struct form *plain_forcing(struct collector *collector, int power, mpq_srcptr a); /* t^power e^{a t}; a NULL: 0 */
struct form *collect_forcing(struct collector *collector, bool sine, mpq_srcptr frequency, const struct form *phase);
/* of loads and constants */
struct form *load_product(struct collector *collector, const struct form *a, const struct form *b);
/* x = factor t + phase, factor not 0 */
bool linear_in_time(const struct form *x, mpq_srcptr *factor, struct form *phase);
bool is_polynomial(const struct forcing *forcing);          /* t^k alone */
bool is_linear_in_time(const struct form *form);            /* a + b t: it is known when it passes 0 */
bool oscillates(const struct forcing *forcing);

/* ---- atom.c: what is not linear, as expressions that are shared wherever they are the same ---- */

enum atom_kind { ATOM_PRODUCT, ATOM_RECIPROCAL, ATOM_POWER, ATOM_CALL, ATOM_COMPARE, ATOM_CHOOSE, ATOM_PARAM,
		 ATOM_SOLUTION };
struct verdict { signed char piecewise, stepwise; }; /* 1 and -1: is_piecewise_form, is_stepwise; 0: not asked yet */
struct atom {
	enum atom_kind kind;
	enum function function;     /* of ATOM_CALL */
	enum comparison comparison; /* of ATOM_COMPARE: two operands */
	const struct symbol *param; /* of ATOM_PARAM: tunable; it has no operands, and counts as of time alone */
	int component;              /* of ATOM_SOLUTION: of n */
	const struct written_system *written; /* NULL: there is none */
	/* POWER: base, exponent; CHOOSE: condition, then, else; SOLUTION: the right side, then the matrix row by row;
	 * equal forms are one object */
	int operands;
	const struct form **operand;
	unsigned *exponent;         /* of ATOM_PRODUCT, one per factor */
	bool time, input, state, velocity; /* what it depends on; a coordinate of first order counts as a velocity */
	bool params;                /* it is made of tunable params */
	/* a highest derivative stands in it that equations are solved for: none of friction, which regions solve for */
	bool highest;
	const struct basis *moves;  /* of that a coordinate, else an input; NULL: t alone */
	struct verdict *judged;      /* what was found out about it */
	const struct node *node;    /* where it comes from */
	int index;                  /* in the order of first appearance */
	struct atom *next;
};
struct atoms *atoms_new(void);
int  atoms_count(const struct atoms *atoms);
/* Each result is a form, folded where the operands are constant; sums of constants, times and states are multiplied out
 * so far that every constant times a state shows as a linear term, and every term of time alone stands alone. */
struct form *kept_product(struct collector *c, const struct node *node, const struct form *a, const struct form *b);
/* the product, of at least two factors, with one of that factor less */
struct form *kept_others(struct collector *c, const struct node *node, const struct atom *product, int factor);
struct form *kept_reciprocal(struct collector *c, const struct node *node, const struct form *x);
struct form *kept_power(struct collector *c, const struct node *node, const struct form *base,
			const struct form *exponent);
struct form *kept_whole_power(struct collector *c, const struct node *node, const struct form *x, unsigned n);
struct form *kept_call(struct collector *c, const struct node *node, enum function function, int count,
		       struct form *const *x);
struct form *kept_comparison(struct collector *c, const struct node *node, enum comparison comparison,
			     const struct form *a, const struct form *b);
/* A component of a linear system */
struct form *kept_component(struct collector *c, const struct node *node, struct atom wanted, int count,
			    const struct form *const *operand);
struct form *kept_choice(struct collector *c, const struct node *node, const struct form *condition,
			 const struct form *a, const struct form *b);
/* Of what is not loads alone, one atom, whatever constants are in both and whether both are the same */
struct form *unexpanded_product(struct collector *c, const struct node *node, const struct form *a,
				const struct form *b);
struct form *unexpanded_choice(struct collector *c, const struct node *node, const struct form *condition,
			       const struct form *a, const struct form *b);
/* A node that calls a function where another one stands: for messages, which show the place */
const struct node *call_at(const struct node *node, enum function function, int count);
struct form *kept_param(struct collector *c, const struct node *node, const struct symbol *param);
bool reads_params(const struct form *form);                 /* some ATOM_PARAM stands in it */
/* A factor that is constant but for comparisons and sgn, times what is piecewise linear: (x' > 0 ? c1 : c2)*x' = (x' >
 * 0 ? c1*x' : c2*x'); NULL: they are no such factors. */
struct form *kept_switched(struct collector *c, const struct node *node, const struct form *a, const struct form *b);
/* linear but for functions and conditions of linear expressions */
bool is_piecewise_form(const struct form *form);
bool is_stepwise(const struct form *form);                  /* constant but for comparisons and sgn */
/* of which two moves more readily: see struct atom */
const struct basis *moved_basis(const struct basis *known, const struct basis *basis);
bool depends_on_time_only(const struct basis *basis);       /* or on nothing */
bool is_of_time(const struct form *form);                   /* all of it depends on time only */
bool is_friction(const struct atom *atom);                  /* NULL: none */
struct form *time_part(const struct form *form, bool atoms); /* its terms of time alone; or of them the atoms only */

/* ---- solution.c: solutions of linear equations ---- */

/* Of highest derivatives: what they are, and residuals M x - f as they are written, which a series follows, since M and
 * f multiplied out have more products */
struct kink { const struct form *of, *solved; };    /* what chooses formulas by its sign; the same of the solution */
struct written_system {
	int rows;
	const struct basis *highest;
	const struct form *const *residual;
	/* their derivatives by these, where they are not linear in them: M and f are of Newton's last step; or NULL */
	const struct form *const *slope;
	const struct form **found;  /* then what is not linear in each, of their solution */
	bool whole_time;            /* conditions on t are open in them */
	int kinks;                  /* then of these as they are written and at iterates of Newton's method */
	const struct kink *kink;
};
struct linear_system {              /* M x = f, n x n, row by row */
	int n;
	const struct form *const *M, *const *f;
	const struct written_system *written; /* NULL: there is none */
};
struct form *kept_solution(struct collector *c, const struct node *node, const struct linear_system *e, int component);
/* Of such an atom, with these operands in the place of its own: written as another */
struct linear_system system_of(const struct atom *atom, const struct form *const *operand);
void round_long(mpq_ptr value);                            /* to 256 bits, where it has many more */
bool is_constant_system(const struct atom *atom);          /* M of such an atom is: constraints are solved for */
bool same_solution(const struct atom *a, const struct atom *b); /* of two such: they differ in the component alone */

/* ---- calculus.c: derivatives of forms, and forms at a point ---- */

struct fixing {                     /* a name that `operator at` fixes */
	struct place at;
	const struct symbol *symbol; /* a let, a coordinate or an input; NULL: t */
	int coord, order;           /* of a coordinate, one component; of an input */
	const struct form *form;    /* constant: pi stays pi */
	mpq_t value;
	const struct form *by;      /* or what takes its place; NULL: the value does */
};
/* With respect to one state: a coordinate, or its velocity */
struct form **form_derivatives(struct collector *c, int count, const struct form *const *form, bool by_input, int index,
			       int order);
/* The same atom of other operands */
struct form *kept_again(struct collector *c, const struct atom *a, struct form *const *x);
/* With respect to an operand of an atom, wherever it stands in it */
struct form *form_partial(struct collector *c, const struct atom *atom, int operand);
/* In time; `rate` gives the derivative of a term that is no atom. Each atom that is there now is derived once. */
struct differentiation;
struct differentiation *rates_new(struct collector *c,
				  struct form *(*rate)(void *context, const struct form_term *term), void *context);
struct form *form_rate(struct differentiation *rates, const struct form *form);
struct point;                       /* t and coordinates fixed; lets are not looked at */
struct point *point_new(struct collector *c, int fixings, const struct fixing *fixing);
void point_free(struct point *point);                       /* and what forms are at it, where that is a number */
void point_at_values(struct point *point);                  /* tunable params have the spec's values there */
void point_rounded(struct point *point);                    /* long values are doubles there: for estimates */
/* leaves the statement where the form is not defined there */
struct form *form_at(struct point *point, const struct form *form);

/* ---- lead.c: phases that go on where the frequency of a sine changes ---- */

struct lead {
	const struct form *rate;    /* d/dt of what t and tunable params are in the argument of a sine */
	const struct symbol *symbol; /* what the phase has gained over it, 0 at first, as if it were a tunable param */
};
struct leads {
	int params;                 /* of the spec, tunable; the leads are numbered behind them */
	int count;
	struct lead *lead;
	const struct node *jumps;   /* the first whose phase jumps all the same; NULL: none */
};
/* x, the argument of a sine, and its lead; itself, where no tunable param makes its frequency alone */
struct form *with_lead(struct collector *c, const struct node *node, struct form *x);

/* ---- piecewise.c: functions and conditions that divide time ---- */

/* Sign of a - b, constant or linear in t, in the collector's interval of time; breakpoints met are added. */
int order_now(struct collector *c, const struct node *node, const struct form *a, const struct form *b);
/* the function of its arguments' forms */
struct form *piecewise(struct collector *c, const struct node *node, struct form *const *x);
/* of a function that is not taken apart */
void check_breakpoints(struct collector *c, const struct node *node, struct form *const *x);
/* constants and times: conditions on them have an outcome */
bool is_decided(const struct collector *c, int count, struct form *const *x);
/* those, or what moves alike: max(x, x + 1) */
bool is_decided_call(const struct collector *c, const struct node *node, struct form *const *x);
void slope_between(const mpq_srcptr *point, mpq_ptr slope); /* point: x0, y0, x1, y1 */

void narrow_span(struct collector *c, struct span span);
bool holds_now(const struct collector *c, struct span span); /* in the collector's interval of time */

/* ---- collect.c: nodes to values ---- */

struct value {                      /* a scalar is 1 x 1 */
	int rows, columns;
	struct form **cell;         /* row-major */
};
/* leaves the statement at what is not linear */
struct value *collect(struct collector *collector, struct node *node);
struct value *collect_constants(struct collector *collector, struct node *node);
bool is_plain_zero(const struct value *value);
/* Its only cell; one that has others is an error at the node, with a note or NULL */
struct form *scalar_of(const struct value *value, const struct node *node, const char *note);
void collect_constant(struct collector *collector, struct node *node, mpq_ptr number);
void param_value(const struct symbol *param, mpq_ptr value); /* collected before */
void forget_lets(const struct spec *spec);

/* ---- dimensions.c: units, of a spec that has some ---- */

void check_dimensions(struct spec *spec);                   /* says what is wrong; names get the units that follow */
/* Of a spec whose names are those of another one and whose numbers are in its units, by name; nothing is checked. */
void adopt_units(struct spec *spec, const struct spec *given);
void check_time(const struct node *node);                   /* leaves the statement where its unit is another */

/* ---- table.c: the straight pieces of a table() as numbers ---- */

struct straight {                      /* y + slope (argument - x), where the argument is below `end` */
	mpq_srcptr x, y, end;       /* end NULL: the last piece; the first and the last go on beyond the table */
	mpq_t slope;
};
int pieces_of_atom(const struct atom *a, struct straight **list);     /* in order; returns how many */
int pieces_of_call(const struct node *node, struct straight **list);

/* ---- functions.c: of one cell ---- */

struct form *function_of_form(struct collector *c, struct node *node, struct form *x);
/* that divides its arguments' range, of one cell of each */
struct form *piecewise_cell(struct collector *c, struct node *node, struct form *const *x);
_Noreturn void refuse_force_below(const struct node *force);           /* of friction, below 0 */
_Noreturn void refuse_velocity_of_friction(const struct node *friction);

#endif
