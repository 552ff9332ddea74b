/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parser, for the files that read statements with it. */
#ifndef PLGEN_PARSER_H
#define PLGEN_PARSER_H

#include "read/read.h"

struct parser {
	struct spec *spec;          /* the whole assembly */
	/* what is the text's own: its name, step, scheme, operator. Of the assembly's text: the same; of a part's:
	 * read, and then left aside */
	struct spec *own;
	struct assembly_part *part;       /* whose text it is; NULL: the assembly's */
	struct lexer lexer;
	struct token token;         /* the next one, not yet taken */
	struct place end;           /* just after the last one taken */
	size_t operand_end;         /* just after the last operand: there an operator may be missing */
	size_t statement;           /* offset where it starts */
	/* whether the statement, unfinished, goes on in the next line: parse.c knows statements */
	bool (*goes_on)(const struct parser *p);
	int nesting;
	bool no_acceleration;       /* in what a component is given */
	bool output;                /* of an output statement: there energy, power and momentum(q) are known */
};

struct binding {                    /* of `with NAME = value` */
	struct token name;
	int component;
	struct node *value;
	bool taken;                 /* it replaced what the part's text has */
};
struct part_reader {                /* what parse.c asks use.c for, which stands on it */
	void (*read)(struct parser *p);
	/* names of parts that a failed statement would have made */
	void (*failed)(struct parser *p, size_t after);
};

/* ---- node.c ---- */

struct node *node_new(enum node_kind kind, struct place at);
void add_child(struct node *node, struct node *child, bool inverse, struct place operator);
/* an output of a part in an expression: its value, at this place */
struct node *inlined(struct node *value, struct place at, struct place end);
bool has_acceleration(const struct node *node);

/* ---- tokens.c, expression.c ---- */

void nest(struct parser *p, struct place at);                /* a level deeper, within the limit */
struct token take(struct parser *p);
bool is_op(const struct parser *p, const char *op);
bool take_op(struct parser *p, const char *op);
bool take_word(struct parser *p, const char *word);
void expect_word(struct parser *p, const char *word);
_Noreturn void unexpected(const struct parser *p, const char *expected);
void expect_op(struct parser *p, const char *op, const char *expected);
void expect_end(struct parser *p);
enum { BUCKETS = 1 << 14 };         /* of symbols, by their names */
_Noreturn void peak_inside(struct place at);
_Noreturn void unknown_name(struct parser *p, struct token token);
struct node *resolve_name(struct parser *p, struct token token); /* what it stands for; a component of it follows */
struct node *read_expression(struct parser *p);
const struct unit *take_unit(struct parser *p, const struct node *value); /* behind it; NULL: none stands here */
struct node *read_quantity(struct parser *p);               /* an expression, and a unit behind it or none */
bool has_two_arguments(const struct parser *p);             /* at a bracket: a comma stands in it, in no inner one */
struct node *read_condition(struct parser *p);              /* an expression, or a single comparison of two */
struct node *read_state(struct parser *p);                  /* at a name: what it stands for */
/* a scalar coordinate, or a component; `ground`: or NULL, the ground */
struct node *read_coordinate(struct parser *p, bool ground);
int  read_component(struct parser *p, int *primes, bool declared);
void check_component(const struct symbol *symbol, int component, struct place at);
const char *symbol_kind(const struct symbol *symbol);
struct symbol *find_symbol(const struct parser *p, const char *name); /* as the text has it; or NULL */

/* ---- statements.c ---- */

struct token expect_new_name(struct parser *p, const char *what);
struct place last_token(const struct parser *p, size_t length); /* where the one just taken begins */
struct token read_state_name(struct parser *p, struct symbol **coord, int *component, const char *what);
struct symbol *declare(struct parser *p, struct token name, enum symbol_kind kind, bool broken);
void add_file(struct spec *spec, const char *path);
const char *beside(const struct source *source, const char *name); /* the path of what a text names */
struct node *read_file_name(struct parser *p);
/* of a coordinate; what a part's own text gives, the assembly gives again */
void add_initial(struct parser *p, struct token name, struct symbol *coord, int component, struct node *value);
void read_param(struct parser *p);
void read_let(struct parser *p);
void read_matrix_statement(struct parser *p);
void read_model(struct parser *p);
void read_coord(struct parser *p);
void read_input(struct parser *p);
void read_init(struct parser *p);
void read_output(struct parser *p);
void read_step(struct parser *p);
struct node *take_order(struct parser *p, struct node **over);
void read_scheme(struct parser *p);

/* ---- requests.c ---- */

void read_tolerance(struct parser *p);
void read_substeps(struct parser *p);
void read_cached(struct parser *p);
void read_events(struct parser *p);
void read_range(struct parser *p);
struct mode_list take_modes(struct parser *p);
void read_modes(struct parser *p);
void read_operator(struct parser *p);
void read_tunable(struct parser *p);
/* What an option has in the place of a statement, by the reader of that, from behind the statement's word on */
bool parse_list(struct spec *spec, const struct source *source, void (*read)(struct parser *p));
void read_sensitivity(struct parser *p);                    /* of sensitivity.c */
void read_need(struct parser *p);
void read_budget(struct parser *p);

/* ---- parse.c ---- */

void declare_quietly(struct parser *p, struct token name, enum symbol_kind kind); /* broken, unless it is known */
struct spec *parse_whole(const struct source *source, const struct part_reader *reader);
void parse_statements(struct spec *spec, struct spec *own, struct assembly_part *part, const struct source *source);

/* ---- network.c ---- */

void read_mass(struct parser *p);
void read_spring(struct parser *p);
void read_damper(struct parser *p);
void read_force(struct parser *p);
void read_friction(struct parser *p);
void read_draw(struct parser *p);

/* ---- energy.c ---- */

void read_energy(struct parser *p);
void read_dissipation(struct parser *p);
void read_constraint(struct parser *p);
void read_point_force(struct parser *p, struct node *first);

/* ---- when.c ---- */

void read_when(struct parser *p);
void read_stop(struct parser *p);

/* ---- habits.c: what is written from habit of paper and of other programs; notes, or NULL ---- */

extern const char WORD[];           /* the characters of names */
typedef bool is_coordinate(const struct parser *p, const char *name);
const char *stray_unit_note(const struct parser *p);        /* at the N of 100 N/m, where that is no name */
/* of `x(0) = 2` and `init x(0) = 2`, at the bracket: init x = 2 */
const char *init_note(const struct parser *p, struct token name);
/* at an unknown name: x1dot, der(x1), Pi, csv(...) */
const char *habit_note(const struct parser *p, struct token name, is_coordinate *is);
const char *statement_habit(const char *word);              /* parameter: param */
const char *statement_form(const struct parser *p);         /* spring k between x, y, of a statement spring */
bool opens_comment(const struct parser *p);                 /* at one of the signs of // */
bool is_unfinished(const struct parser *p);                 /* at the end of a line that a , or + ends */

/* ---- slope.c ---- */

struct slope {                      /* a derivative; an error at `at` where it has none that is known */
	struct place at;
	/* in time; in time with the coordinates fixed; by the velocity of the coordinate `of`; by all velocities, each
	 * times it */
	enum { SLOPE_TIME, SLOPE_LOADS, SLOPE_VELOCITY, SLOPE_VELOCITIES, SLOPE_PARAM } kind;
	const struct node *of;
	/* SLOPE_PARAM: by what, and its name in messages; NULL: a state's initial value, an input */
	const struct symbol *param;
	const char *name;
	struct symbol **moved;      /* per number of a symbol: derivatives of coordinates and inputs; NULL: 0 */
	struct node **known;        /* likewise of what has a value: the derivative, once found */
	struct symbol *time;        /* the derivative of t, at an event that moves; NULL: 0 */
	const struct slope *event;  /* of what is watched for events */
	bool unexpanded;            /* it has linear terms of linear ones alone */
};
struct node *slope_by(struct node *node, struct slope by);
struct node *slope_of(struct node *node, struct place at);  /* in time */
bool reads_states(const struct node *node);
bool follows_param(const struct node *node, const struct symbol *param);   /* whether it is made of the param */

/* ---- unobservable.c ---- */

void leave_unobservable(struct spec *spec);                 /* parts that no output can see */

#endif
