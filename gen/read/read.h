/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text to what it says: names resolved, nothing evaluated. */
#ifndef PLGEN_READ_H
#define PLGEN_READ_H

#include "base/base.h"

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
	bool points;                /* names may have some: front.body */
	bool needs;                 /* of a need: % and | are operators too */
};
/* Where the statement that starts at `from` ends: the line end outside brackets. `unclosed` receives the offset of a
 * bracket that no later text closes (the statement is then its line), else SIZE_MAX. */
size_t lex_statement_end(const struct source *source, size_t from, size_t *unclosed);
struct token lex_next(struct lexer *lexer);
const char *token_text(struct token token);                /* for messages: 'x1', the end of the line */
/* digits [. digits] [e [+-] digits], with a digit before or after the point: how long what begins here is */
size_t number_length(const char *text);
void lex_number(struct token token, mpq_ptr value);        /* the decimal, exactly */

/* ---- habits.c: what is written from habit of other programs, for the lexer ---- */

/* 1 and ms: a unit stands in quotes: 1 "ms". NULL: the second is no unit */
const char *unit_note(const char *number, size_t digits, const char *unit, size_t length);

/* ---- units.c: "kN s/m" as exponents of base units and a factor ---- */

enum { UNIT_BASES = 7 };            /* m kg s A K mol cd; angles have none */
struct unit {
	const char *text;           /* as written, without quotes */
	struct place at;            /* its opening quote */
	mpq_t *base;                /* exponents, UNIT_BASES */
	mpq_t factor;               /* one of it is factor pi^pi of the coherent SI unit */
	int pi;
	int angle;                  /* exponent of the radian, which no check looks at */
};
struct unit *unit_parse(struct place at, const char *text, size_t length); /* `at`: of its first character */
bool is_unit_name(const char *name, size_t length);         /* with its prefix */
double unit_factor(const struct unit *unit);                /* to the SI unit, for programs; NULL: 1 */
bool is_coherent(const struct unit *unit);                  /* its factor is 1 */
struct unit *unit_of_derivative(const struct unit *of, int primes);
struct unit *unit_of_dimension(const mpq_t *base);          /* the coherent one, with its text */
const struct unit *unit_in_si(const struct unit *of);       /* of one that is written, with its text */
const char *base_unit_text(const mpq_t *base);              /* kg m/s^2 */
const char *si_unit_text(const mpq_t *base);                /* N; where it has no such name, as above */

/* ---- parse.c, statements.c: tokens to nodes and declarations ---- */

enum function {
	FN_NONE,
#define REAL_FUNCTION(NAME, name, argument, value, low, high) FN_##NAME,
#include "read/functions.def"
#undef REAL_FUNCTION
	FN_ATAN2,                   /* of two numbers; those behind it are piecewise */
	FN_ABS, FN_SGN, FN_MIN, FN_MAX, FN_DEADZONE, FN_CLIP, FN_TABLE,
	FN_FRICTION,
	FN_SLIDE,                   /* of no text: the velocity of a slider without mass, by what it bears and holds */
	FN_SUM, FN_CUMSUM, FN_DOT   /* of vectors */
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
	bool each;                  /* of PRODUCT: of vectors component by component */
	bool unexpanded;            /* of PRODUCT and CHOOSE: one factor of a remainder */
	const struct symbol *let;   /* of a SUM of one child, which is the derivative of this; else NULL */
	const struct node *follows; /* of friction: it is the derivative of this one, and acts where that does */
	struct place *operator;     /* of SUM and PRODUCT: the sign before each child */
	const struct unit *unit;    /* of a SUM of one child: what stands behind it; else NULL */
	bool counted;               /* the child is a number of these, times its factor; else it comes out in it */
	enum { TIMELY_UNKNOWN, TIMELY, NOT_TIMELY } timely; /* reads nothing but t and params */
	struct kept *kept;          /* of one that is: its value, and when it holds */
};
struct span { mpq_srcptr after, before; };   /* of time; NULL: no bound */
enum symbol_kind { SYMBOL_PARAM, SYMBOL_COORD, SYMBOL_LET, SYMBOL_OUTPUT, SYMBOL_INPUT, SYMBOL_MATRIX,
		   SYMBOL_MULTIPLIER, /* of a constraint */
		   SYMBOL_PART_OUTPUT, SYMBOL_PART };
struct symbol_tuning {
	/* it is tunable, or made of something that is; of that: check_tuned has looked through its value */
	bool tuned, checked;
	unsigned made_of;           /* given tunables, a bit each; 0: not looked at yet */
	int number;                 /* in the statements `tunable`, from 1; 0: it stands in none */
	bool derived;               /* of these: it follows from others; else, derived.c has looked through its value */
	bool factor;                /* tunable, and in regions no input: it changes their matrices; */
	int acting;                 /* else its number among those that act as inputs */
};
struct symbol_value {               /* its `value`, collected */
	enum { FRESH, COLLECTING, COLLECTED } progress;
	struct value *value;        /* if COLLECTED */
	struct span span;           /* when it holds, */
	bool irrational;            /* something in it has become a rational */
	const struct form *full;   /* of a scalar let: its value for all time, where there is a remainder */
};
struct symbol {
	enum symbol_kind kind;
	int number;                 /* 1, 2, ... in the order of declaration; 0: no statement declares it */
	const char *name;           /* of what belongs to a part: front.body */
	struct place at;
	const struct assembly_part *part; /* whose text declares it; NULL: the assembly's */
	size_t statement;           /* offset of the statement that declares it */
	/* among its kind, in the order of declaration; of a coordinate: of its first component */
	int index;
	int length;                 /* of a vector coordinate; 0: scalar */
	bool used;                  /* some expression reads it */
	bool broken;                /* its own statement failed: what uses it is passed over in silence */
	struct symbol_tuning tuning;
	int hold;                   /* of an input: degree of what goes through its samples; 0: held */
	/* of a coordinate: its order, 1 or 2; of a let: 1 if it reads a highest derivative, else -1, 0 unknown */
	int highest;
	bool peak;                  /* of an output: peak(value) */
	bool connected;             /* of a let: an input of a part, to which the assembly gives its value */
	/* of an input that is another one as it was some time ago, declared by u(t - d): that one, and t - d; else
	 * NULL */
	const struct symbol *delayed;
	struct node *when;
	struct node *value;         /* of param, let, output */
	const struct unit *unit;    /* as written, or found by collect/dimensions.c; NULL: not known */
	bool unit_written;
	struct symbol_value made;
	struct symbol *next_alike;  /* of the same bucket */
	struct symbol *next;
};
struct equation {
	struct place at, end;       /* first token; just after the last */
	const struct assembly_part *part; /* whose text has it; NULL: the assembly's */
	struct node *left, *right;
};
struct element {                    /* of a network */
	/* ELEMENT_ENERGY: what the energies say of a coordinate, for which there is no text of its own */
	enum { ELEMENT_MASS, ELEMENT_SPRING, ELEMENT_DAMPER, ELEMENT_FORCE, ELEMENT_FRICTION, ELEMENT_ENERGY } kind;
	const struct assembly_part *part; /* whose text has it; NULL: the assembly's */
	struct place at, end;
	struct node *value, *from, *to; /* coordinates, or components; `to` NULL: the ground, or none */
};
struct energy {                     /* or the force at a point, or a constraint */
	/* 'T', 'V', 'D'; 'Q': components `value` of a force at the point `point`; 'G': `value` is 0 at all times */
	char kind;
	const struct assembly_part *part;
	struct place at, end;
	struct node *value, *point;
	struct symbol *multiplier;  /* of a constraint */
	/* of a derivative: what the first `own` coordinates' equations would have of it stands so many further behind;
	 * of a constraint's the multiplier of that; 0: of none */
	int own, behind;
	const struct symbol *of;
};
struct drawing {                    /* draw WHAT at POINT, or from POINT to POINT: for pages */
	struct place at, end;
	const struct assembly_part *part;
	const char *what;
	int points;
	struct node *point[2][2];   /* x, y; y NULL: 0 */
	struct node *radius, *turn; /* of a wheel; NULL: not given */
};
struct total {                      /* of a mechanism, or of network elements */
	enum { TOTAL_ENERGY, TOTAL_POWER, TOTAL_MOMENTUM } kind;
	struct symbol *let;
	struct node *coord;         /* of TOTAL_MOMENTUM */
};
struct state_jump {                 /* of `when`: state = value just behind it */
	struct node *target, *value;
};
struct when {                       /* when guard: jump, jump;  or a stop that bounces */
	struct place at, end;
	const struct assembly_part *part; /* whose text has it; NULL: the assembly's */
	struct node *guard;         /* a comparison, < <= > or >= */
	int jumps;
	struct state_jump *jump;
	/* of stop: between two coordinates, NULL: the ground; what comes up to `gap` is from - to; both NULL: between
	 * expressions. restitution NULL: it is no stop */
	struct node *from, *to, *gap, *restitution;
	bool chosen, timed;         /* it is where a formula jumps, beside derivatives, and no state; by time alone */
	int slopes;                 /* one per derivative of the equations */
	struct when_slope *slope;
};
struct when_slope {                 /* what follows a param of a guard, left less right side, of e and of each jump */
	struct node *guard, *restitution, **jump;
};
struct initial {
	struct place at;
	const struct assembly_part *part; /* whose text gives it; NULL: the assembly's */
	size_t statement;
	struct symbol *coord;
	int primes, component;
	struct node *value;
};
struct state_bound {                /* range NAME in [LOW, HIGH]; tolerance of NAME = LOW */
	struct place at;
	const struct assembly_part *part; /* whose text gives it; NULL: the assembly's */
	struct symbol *coord;
	int primes, component;
	struct node *low, *high;    /* high NULL: there is none */
};
struct fixed {                      /* of `operator at NAME = value, value, ...` */
	struct place at, end;
	struct symbol *symbol; /* a coordinate or a let; NULL: t */
	int primes, component;
	int values;
	struct node **value;
};
struct mode_list {                  /* of `modes 6` or `modes 1, 2, 9`, and `without static` behind it */
	struct place at;            /* source NULL: there is none */
	struct node **number;
	int count;
	bool each;                  /* a comma stands there: modes by their numbers; else so many, the best */
	bool without_static;
};
struct tunable {                    /* a param that the target may change */
	struct place at;
	struct symbol *symbol;
	struct node *low, *high;    /* its range; NULL: it has none */
};
struct sensitivity {                /* what derivatives are by: a param, a state's initial value, an input */
	struct place at;
	struct symbol *symbol;
	int component, primes;      /* of a state */
	const char *name;           /* k, x', q[2] */
};
struct spec;
bool is_zero_node(const struct node *node);
/* By a param, at fixed t, of what reads neither states nor inputs */
struct node *slope_by_param(const struct spec *spec, const struct sensitivity *by, struct node *node);
struct assembly_part {                    /* of an assembly: a spec in it, as often as `use` names it */
	const char *name;           /* front; inside another: half.front */
	const char *file;           /* as written */
	struct place at;            /* what names it */
	const struct source *source;
	const struct assembly_part *inside; /* another part; NULL: the assembly */
	bool broken;                /* what is wrong was reported */
	bool unobservable;          /* by any output: not in the model */
	const char *aside;          /* statements of its text that an assembly does not read; "": none */
	int bindings;
	struct binding *binding;
};
struct need_input {                 /* of a need: |NAME| <= most */
	struct place at;
	const char *name;
	struct node *most;
};
struct need {                       /* need OUTPUT within BOUND [%] until END [for |NAME| <= MOST, ...] */
	struct place at, output_at; /* of the word; of the output's name */
	const char *output;         /* as outputs are named: x1, q[3]' */
	struct node *bound, *until;
	bool percent;               /* of the output's largest value */
	int inputs;
	struct need_input *input;
};
struct budget {                     /* budget N instructions on TARGET [for the worst step] */
	struct place at;
	struct node *instructions;  /* NULL: there is none */
	struct token target;
	bool worst;                 /* of any step, by its bound */
};
struct requested_scheme {
	struct node *step;
	struct place step_at;
	const char *scheme;
	struct place scheme_at;
	/* of a scheme in powers of h: its order, as an expression; the steps that one expansion is over; the error that
	 * a step may make; the most steps within one h. NULL: not given */
	struct node *order, *over, *tolerance, *substeps;
	struct node *cached;        /* matrices of regions that an instance keeps; NULL: not given */
	struct node *events;        /* the most in a step; NULL: not given */
	struct node *absolute;      /* behind the tolerance: what a step may add to any state; NULL: not given */
	int absolutes;
	struct state_bound *absolute_of;  /* the same of some states */
};
struct requested_operators {
	bool given;
	struct node *count;         /* of a schedule between two values; NULL: each has a value of its own */
	struct place at;
	int fixeds;
	struct fixed *fixed;
};
struct spec_counts {
	int symbols, params, coords, lets, outputs, inputs, matrices, multipliers, part_outputs, part_names;
	int components;             /* of all coordinates together */
	int delays;                 /* of the inputs, those that are others some time ago */
};
struct assembly {
	bool uses;                  /* there is a statement `use` */
	const struct part_reader *reader;
	int parts;                  /* in the order of `use`, those inside a part after it */
	struct assembly_part **part;
	int unobservable;           /* states of parts that no output sees, and their names */
	const char **unobservable_name;
};
struct spec {                       /* what the text says, names resolved, nothing evaluated */
	const struct source *source;
	const char *name;
	struct place name_at;
	struct symbol *first, **last;   /* all symbols in the order of declaration */
	struct symbol **bucket;         /* the same by name */
	struct spec_counts count;
	struct assembly assembly;
	bool lacks_coords;          /* there is no coordinate, and that was reported */
	int equations;
	struct equation *equation;
	int elements;
	struct element *element;
	struct { int energies; struct energy *energy; int totals; struct total *total; } lagrange;
	struct {
		int drawings;
		struct drawing *drawing;
		int outputs;        /* the last so many outputs are none of the text: drawings read them */
	} page;
	int whens;                      /* in the order in which they act at one instant */
	struct when *when;
	struct { int files; const char **file; } data;  /* for the dependency file */
	struct { int initials; struct initial *initial; int ranges; struct state_bound *range; } states;
	struct requested_scheme request;
	struct requested_operators operators;
	struct {
		int count, derived; /* the last `derived` of them follow from the others: derived.c */
		struct tunable *tunable;
	} tuned;
	int sensitivities;
	struct sensitivity *sensitivity;
	/* derivatives: coordinates before them, apart; behind them one that no param drives; along: those of energies
	 * say what a param does alone, and equations are derived along the states as forms */
	struct { int columns, own, stride; bool probe, held, along; } joined;
	struct { int needs; struct need *need; struct budget budget; } required;
	struct mode_list modes;
	struct { bool written, adopted; } units; /* dimensions are checked, unless they are another spec's */
	struct place end;
};
struct spec *parse_spec(const struct source *source);
/* an expression from the command line; `until`: where it ends */
struct node *parse_argument(struct spec *spec, const struct source *source, size_t from, size_t until);
/* Behind the name of a scheme: its order, and NULL or what follows the word `over` */
struct node *parse_scheme_order(struct spec *spec, const struct source *source, size_t from, struct node **over);
bool parse_tunables(struct spec *spec, const struct source *source); /* of --tunable, behind the spec's */
struct mode_list parse_mode_list(struct spec *spec, const struct source *source); /* likewise; at.source NULL: wrong */
void add_symbol(struct spec *spec, struct symbol *symbol);  /* behind all others: of equal names the first is found */
struct symbol *spec_find(const struct spec *spec, const char *name);
char *text_between(struct place start, struct place end);   /* without comments, white space folded */

/* ---- network.c ---- */

enum { MOST_DRAWN = 6 };
int nodes_of_drawing(const struct drawing *d, struct node **node); /* what it reads; the turn, where it has one, last */

/* ---- energy.c: equations from energies ---- */

void add_energy_elements(struct spec *spec);                /* one for each coordinate that they name, at the end */
void fill_totals(struct spec *spec);                        /* what outputs read of energy, power and momentum */
bool has_kinetic_energy(const struct spec *spec, int component); /* then the coordinate is of second order */
bool is_constrained(const struct spec *spec, int component);

/* ---- sensitivity.c: derivatives by params, initial values and along inputs ---- */

bool parse_sensitivities(struct spec *spec, const struct source *source); /* of --sensitivity, instead of the spec's */
/* To the spec, what so many derivatives follow: coordinates, equations, initial values, outputs behind its own */
/* jumps: of formulas that the state, or a time that moves, chooses, too */
void add_derivatives(struct spec *spec, int first, int count, bool jumps, bool remainder, bool probe);

/* ---- params.c: other values of params than the spec's ---- */

struct definition {
	const char *name;
	struct place at;            /* of the name; in the same text, */
	size_t from, until;         /* the value */
};
struct definitions {                /* of a name that is there again the last counts */
	int count;
	struct definition *definition;
};
/* the value, of a param or of a matrix: "FILE.mtx" too; NULL: it was said what is wrong */
struct node *parse_definition(struct spec *spec, const struct definition *d, const struct symbol *symbol);
bool definitions_read(const char *path, struct definitions *to); /* FILE.json, FILE.csv; false: it says what is wrong */
void definitions_add(const char *text, struct definitions *to); /* NAME=EXPR of the command line */

/* of node.c: units of values */
bool is_plain_number(const struct node *node);              /* made of numbers alone */
struct node *with_unit(struct node *value, const struct unit *unit); /* unit NULL: the value */
/* times its factor, or divided by it */
struct node *convert_unit(struct node *value, const struct unit *unit, bool inverse);
struct node *state_node(struct symbol *coord, int component, int primes); /* at its declaration */

/* ---- use.c: parts of an assembly, for a reader ---- */

void read_parts_from(const char *folder);                   /* those that come with plgen; NULL: there are none */

/* an equation or element: front: M*x'' = 0 */
const char *written_text(const struct assembly_part *part, struct place at, struct place end);
/* of the statement of an energy; NULL: that of the one before it */
const char *energy_text(const struct spec *spec, int index);
/* axle.spec as front, rear; NULL: it is reported with a part before it */
const char *parts_text(const struct spec *spec, int index);

/* ---- names.c: words with a meaning of their own ---- */

bool is_reserved(const char *name);                         /* words that a user's name may not be */
const char *prefix_objection(const char *name);             /* why it cannot name generated code, or NULL */
size_t name_hash(const char *name);
enum function function_of(const char *name);
enum function vector_function_of(const char *name);         /* whose names are no reserved words */
const char *function_name(enum function function);
const char *nearest_name(const char *name, int count, const char *const *known); /* or NULL */
/* a note with the nearest known name, or NULL */
const char *spec_suggestion(const struct spec *spec, const char *name);
bool may_be_macro(const char *name);

/* ---- mtx.c: Matrix Market files ---- */

struct mtx {
	int rows, columns;
	mpq_t *cell;                /* row-major */
};
struct mtx *mtx_read(const char *path, struct place at);    /* `at`: what names the file */

/* ---- schemes.c: the schemes and the forms of a step ---- */

enum step_form { FORM_AUTO, FORM_DIRECT, FORM_DELTA, FORM_KICK_DRIFT_KICK, FORM_MODAL, STEP_FORMS };
#define SCHEME(id, recipe, ...) SCHEME_##id,
enum scheme {
#include "read/schemes.def"
	SCHEMES
};
#undef SCHEME
struct scheme_row {
	const char *name;           /* as users write it */
	int order;                  /* in h, where all is smooth; 0: exact */
	const char *method;         /* what it does, for the banner; NULL: exact */
	const char *citation;       /* of its recipe */
	bool leaves;                /* a quadrature of its own treats its nonlinear remainder */
	bool by_default;            /* where exact is not possible and no scheme is asked for */
	bool holds_coupling;        /* over the step: A is each coordinate's own terms, of linear models too */
	bool holds_remainder;        /* over the step: there is a value of its order at any time between steps */
	bool event_split;           /* its steps end where the state chooses other formulas: see follows_crossings() */
	bool predicts;              /* the nodes by an explicit method, which bears no stiffness */
	bool expands;               /* the whole right side, nothing taken out: as a Taylor series in time, */
	bool collocates;            /* or by collocation, which bears stiffness; */
	bool switches;              /* or by both, as the stiffness is */
	bool modes;                 /* in normal modes of symmetric operators; loads are in the remainder too */
	int points;                 /* of an exponential multistep method: past forces that a step reads */
	int stages;                 /* of collocation in modes, where no number is given; 0: it is none */
	/* Stability: where the operator's squared frequencies are below the model's by d, the state grows at h d over
	 * this; 0: its phase drifts, by the order. */
	int growth_divisor;
};
const struct scheme_row *scheme_row(enum scheme scheme);
bool chooses_operator(enum scheme scheme);                  /* `operator at` has a meaning */
const char *scheme_name(enum scheme scheme);
bool scheme_of(const char *name, enum scheme *scheme);      /* false: there is none of this name */
const char *nearest_scheme(const char *name);               /* or NULL */
enum scheme default_scheme(void);                           /* with a remainder */
const char *all_schemes(const char *separator);             /* their names */
const char *leaving_schemes(const char *last);              /* of those with a quadrature: a, b<last>c */
const char *stopping_schemes(void);                         /* of those that go from event to event by events.c */
bool stops_at_events(enum scheme scheme);                   /* whether it does, with steps that are cut into parts */
bool is_event_split(enum scheme scheme);
const char *holding_schemes(void);                          /* of those that hold coupling terms */
/* Scheme etd1, of first order in h: ... `order`: of a scheme that expands */
const char *scheme_note(enum scheme scheme, int order);
const char *step_form_name(enum step_form form);
bool step_form_of(const char *name, enum step_form *form);  /* false: there is none of this name */

#endif
