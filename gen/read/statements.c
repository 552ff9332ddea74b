/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statements to declarations. The production stands above each function that reads it. */
#include "read/parser.h"

#include <string.h>

struct token expect_new_name(struct parser *p, const char *what)
{
	if (p->token.kind != TOKEN_NAME)
		unexpected(p, what);
	if (p->token.primes > 0)
		error(p->token.at, NULL, "a name is declared without primes: '%s'", p->token.name);
	if (is_reserved(p->token.name))
		error(p->token.at, NULL, "'%s' is a reserved word", p->token.name);
	return take(p);
}

/* Names that differ in a point for a _ are one in C. Reported where the assembly makes them meet. */
static void check_name_in_c(const struct parser *p, const char *name, struct place at)
{
	for (const struct symbol *s = p->spec->bucket[name_hash(name) % BUCKETS]; s; s = s->next_alike) {
		size_t same = 0;
		while (s->name[same] && (s->name[same] == name[same] || (strchr("._", s->name[same]) && name[same] &&
									 strchr("._", name[same]))))
			same++;
		if (!s->name[same] && !name[same] && strcmp(s->name, name) != 0 && s->kind != SYMBOL_PART)
			error(p->part ? p->part->at : at, "names of parts have a _ for the point there",
			      "'%s' and '%s' are one name in C", s->name, name);
	}
}

struct place last_token(const struct parser *p, size_t length)
{
	return (struct place){ p->end.source, p->end.offset - length };
}

struct symbol *declare(struct parser *p, struct token name, enum symbol_kind kind, bool broken)
{
	struct spec *spec = p->spec;
	struct symbol *known = find_symbol(p, name.name);
	if (strchr(name.name, '.'))
		error(name.at, "names with a point are those of parts", "'%s' is no name to declare", name.name);
	if (known && known->broken)
		abandon();
	if (known)
		error(name.at, NULL, "'%s' is declared already, as %s %s", name.name,
		      known->kind == SYMBOL_OUTPUT || known->kind == SYMBOL_INPUT ? "an" : "a", symbol_kind(known));
	int *counts[] = {
		&spec->count.params, &spec->count.coords,   &spec->count.lets,	       &spec->count.outputs,
		&spec->count.inputs, &spec->count.matrices, &spec->count.multipliers, &spec->count.part_outputs,
		&spec->count.part_names
	};
	const char *whole = p->part ? format("%s.%s", p->part->name, name.name) : name.name;
	if (kind != SYMBOL_PART && !broken)
		check_name_in_c(p, whole, name.at);
	struct symbol *symbol = NEW(struct symbol);
	*symbol = (struct symbol){
		.kind = kind, .name = whole, .at = name.at, .statement = p->statement, .broken = broken, .part = p->part
	};
	symbol->index = broken ? -1 : (*counts[kind])++;
	add_symbol(spec, symbol);
	return symbol;
}

/* What the assembly gives to the part that is read; or NULL */
static const struct binding *binding_of(const struct parser *p, const char *name)
{
	const struct binding *found = NULL;
	for (const struct assembly_part *part = p->part; part; part = part->inside) {
		for (int i = 0; i < part->bindings; i++) {
			struct binding *binding = &part->binding[i];
			if (strcmp(binding->name.name, name) != 0 || binding->name.primes || binding->component)
				continue;
			binding->taken = true;
			found = binding;        /* that of the outermost */
		}
		const char *point = strrchr(part->name, '.');
		name = format("%s.%s", point ? point + 1 : part->name, name);
	}
	return found;
}

/* In a part: what the assembly gives instead; numbers of it count in the unit that is written in the part */
static struct node *given_value(struct parser *p, const char *name, struct node *value, const struct unit *unit)
{
	const struct binding *binding = binding_of(p, name);
	value = binding ? binding->value : value;
	return value && !value->unit ? with_unit(value, unit) : value;
}

static void set_unit(struct symbol *symbol, const struct unit *unit)
{
	symbol->unit = unit;
	symbol->unit_written = unit;
}

/* param: param NAME = expression [ unit ] { , NAME = expression [ unit ] };   let: let NAME = expression [ unit ] */
static void read_definitions(struct parser *p, enum symbol_kind kind)
{
	const bool matrix = kind == SYMBOL_MATRIX;
	do {
		struct token name = expect_new_name(p, matrix ? "the name of a matrix" : "a name");
		expect_op(p, "=", "'='");
		const bool file = matrix && p->token.kind == TOKEN_STRING;
		struct node *value = file ? read_file_name(p) : read_expression(p);
		const struct unit *unit = take_unit(p, value);
		value = kind == SYMBOL_LET ? with_unit(value, unit) : given_value(p, name.name, value, unit);
		struct symbol *symbol = declare(p, name, kind, false);
		symbol->value = value;
		set_unit(symbol, unit);
	} while (take_op(p, ","));
	expect_end(p);
}

void read_param(struct parser *p)
{
	read_definitions(p, SYMBOL_PARAM);
}

void read_let(struct parser *p)
{
	read_definitions(p, SYMBOL_LET);
}

void add_file(struct spec *spec, const char *path)
{
	for (int i = 0; i < spec->data.files; i++)
		if (strcmp(spec->data.file[i], path) == 0)
			return;
	*MORE(spec->data.file, spec->data.files) = path;
}

/* A file that a text names stands beside it unless its path is absolute. */
const char *beside(const struct source *source, const char *name)
{
	const char *slash = strrchr(source->name, '/');
	return name[0] == '/' || !slash ? name : format("%.*s/%s", (int)(slash - source->name), source->name, name);
}

struct node *read_file_name(struct parser *p)
{
	struct token token = take(p);
	const char *name = format("%.*s", (int)token.length - 2, token.at.source->text + token.at.offset + 1);
	struct node *node = node_new(NODE_FILE, token.at);
	node->end = p->end;
	node->path = beside(token.at.source, name);
	add_file(p->spec, node->path);
	return node;
}

/* matrix: matrix NAME = ( STRING | expression ) [ unit ] { , ... } */
void read_matrix_statement(struct parser *p)
{
	read_definitions(p, SYMBOL_MATRIX);
}

/* two-mass as two_mass */
static const char *joined_name(struct token name)
{
	const char *text = name.at.source->text + name.at.offset;
	char *joined = format("%.*s", (int)strcspn(text, " \t\r\n#"), text);
	for (char *c = joined; *c; c++)
		*c = strchr(WORD, *c) ? *c : '_';
	return joined;
}

/* model: model NAME */
void read_model(struct parser *p)
{
	if (p->own->name && *p->own->name)
		error(last_token(p, 5), NULL, "the model is named already: '%s'", p->own->name);
	if (p->token.kind != TOKEN_NAME || p->token.primes > 0 || strchr(p->token.name, '.'))
		unexpected(p, "the model's name");
	struct token name = take(p);
	if (is_op(p, "-") || is_op(p, "+") || is_op(p, "/"))
		error(p->token.at, format("names are made of the letters a to z, digits and _: %s", joined_name(name)),
		      "a model's name has no '%s'", p->token.op);
	expect_end(p);
	p->own->name = name.name;
	p->own->name_at = name.at;
}

/* coord: coord NAME [ '[' NUMBER ']' ] [ unit ] { , ... } */
void read_coord(struct parser *p)
{
	do {
		struct token name = expect_new_name(p, "the name of a coordinate");
		int primes = 0, length = read_component(p, &primes, true);
		if (primes)
			error(name.at, NULL, "a coordinate is declared without primes");
		struct symbol *symbol = declare(p, name, SYMBOL_COORD, false);
		symbol->length = length;
		symbol->index = p->spec->count.components;
		p->spec->count.components += length ? length : 1;
		set_unit(symbol, take_unit(p, NULL));
	} while (take_op(p, ","));
	expect_end(p);
}

/* `hold first` at the end of a list, and nowhere else in it, holds for the whole list. Else it holds for the name
 * before it, and whoever has none is held: after the ramps only, where that cannot be taken for the other. `last`: of
 * the list */
static void apply_hold(struct parser *p, const struct symbol *last, int phrases)
{
	const struct symbol *held = NULL;
	bool whole = phrases == 1 && last->hold;
	for (struct symbol *s = p->spec->first; s && phrases > 0; s = s->next) {
		if (s->statement != p->statement || s->part != p->part)
			continue;
		if (s->hold && held && !whole)
			error(held->at,
			      format("what is held goes last, or has a statement of its own: input %s", held->name),
			      "is '%s' held, or a ramp as '%s' is?", held->name, s->name);
		held = s->hold || held ? held : s;
		s->hold = whole ? last->hold : s->hold;
	}
}

/* The degree that follows `hold` */
static int take_hold(struct parser *p)
{
	static const struct { const char *word; int degree; } known[] = {
		{ "first", 1 }, { "third", 3 }, { "fifth", 5 }, { "seventh", 7 }
	};
	for (size_t i = 0; i < sizeof known / sizeof *known; i++)
		if (take_word(p, known[i].word))
			return known[i].degree;
	error(p->token.at, "without 'hold first' an input is held from sample to sample",
	      "expected 'first', 'third', 'fifth' or 'seventh', found %s", token_text(p->token));
}

/* input: input NAME [ unit ] [ hold DEGREE ] { , NAME [ unit ] [ hold DEGREE ] } */
void read_input(struct parser *p)
{
	struct symbol *input;
	int phrases = 0;
	do {
		struct token name = expect_new_name(p, "the name of an input");
		const struct unit *unit = take_unit(p, NULL);
		struct node *connected = given_value(p, name.name, NULL, unit);
		input = declare(p, name, connected ? SYMBOL_LET : SYMBOL_INPUT, false);
		input->value = connected;
		input->connected = connected;
		set_unit(input, unit);
		if (!take_word(p, "hold"))
			continue;
		input->hold = take_hold(p);
		phrases++;
	} while (take_op(p, ","));
	expect_end(p);
	apply_hold(p, input, phrases);
}

/* What a part has of its own the assembly may give again: the later one counts. */
void add_initial(struct parser *p, struct token name, struct symbol *coord, int component, struct node *value)
{
	struct spec *spec = p->spec;
	for (int i = 0; i < spec->states.initials; i++) {
		const struct initial *other = &spec->states.initial[i];
		if (other->coord == coord && other->primes == name.primes && other->part == p->part &&
		    (!component || !other->component || other->component == component))
			error(name.at, NULL, "the initial value of %s is given already", token_text(name));
	}
	*MORE(spec->states.initial, spec->states.initials) =
		(struct initial){ name.at, p->part, p->statement, coord, name.primes, component, value };
}

/* NAME [ ' ]: a coordinate, its component or their derivative; `what` is for those alone */
struct token read_state_name(struct parser *p, struct symbol **coord, int *component, const char *what)
{
	if (p->token.kind != TOKEN_NAME)
		unexpected(p, "a coordinate");
	struct token name = take(p);
	*component = read_component(p, &name.primes, false);
	name.length = p->end.offset - name.at.offset;
	*coord = find_symbol(p, name.name);
	if (*coord && (*coord)->broken)
		abandon();
	if (!*coord && (strcmp(name.name, "v") == 0 || strcmp(name.name, "v0") == 0))
		error(name.at, "the velocity of a coordinate x is x'", "unknown name '%s'", name.name);
	if (!*coord && !is_reserved(name.name))
		unknown_name(p, name);
	if (!*coord || (*coord)->kind != SYMBOL_COORD)
		error(name.at, format("%ss are for coordinates and their velocities", what),
		      "'%s' is not a coordinate", name.name);
	check_component(*coord, *component, name.at);
	if (name.primes > 1)
		error(name.at, NULL, "an acceleration has no %s: it follows from the equations", what);
	return name;
}

/* init: init NAME [ ' ] = expression [ unit ] { , ... } */
void read_init(struct parser *p)
{
	do {
		struct symbol *coord;
		int component;
		struct token name = read_state_name(p, &coord, &component, "initial value");
		if (is_op(p, "("))
			error(p->token.at, init_note(p, name),
			      "an initial value is the one at t = 0, which is not written");
		expect_op(p, "=", "'='");
		add_initial(p, name, coord, component, read_quantity(p));
	} while (take_op(p, ","));
	expect_end(p);
}

/* The unit in which what an output names is given; NULL: none is written */
static const struct unit *unit_of_named(const struct symbol *known, int primes)
{
	if (!known || !known->unit || known->kind == SYMBOL_PARAM || known->kind == SYMBOL_MATRIX)
		return NULL;
	return primes ? unit_of_derivative(known->unit, primes) : known->unit;
}

/* Whether two outputs have a column in common: the same name, or a vector and a component of it */
static bool shares_column(const char *one, const char *other)
{
	const char *of_one = strchr(one, '['), *of_other = strchr(other, '[');
	if (!of_one == !of_other)
		return strcmp(one, other) == 0;
	const char *component = of_one ? one : other, *opening = of_one ? of_one : of_other;
	return strcmp(format("%.*s%s", (int)(opening - component), component, strchr(opening, ']') + 1),
		      of_one ? other : one) == 0;
}

/* An output that only names something: x1, x2', x1'', a let. */
static void read_plain_output(struct parser *p, struct token name)
{
	const struct symbol *known = find_symbol(p, name.name);
	const bool peak = known && known->kind == SYMBOL_PART_OUTPUT && known->peak;
	struct node *value = strcmp(name.name, "t") == 0 ? node_new(NODE_TIME, name.at)
			     : peak                      ? inlined(known->value, name.at, p->end)
							 : resolve_name(p, name);
	const bool total = !known && value->symbol && value->symbol->kind == SYMBOL_LET;
	const int primes = value->symbol && value->symbol == known ? value->primes : name.primes;
	const char *shown = total ? value->symbol->name
			    : value->component ? format("%s[%d]%.*s", name.name, value->component, primes, "''")
					     : format("%s%.*s", name.name, primes, "''");
	value->end = p->end;
	const struct unit *written = take_unit(p, NULL),
			  *unit = written ? written : unit_of_named(known, primes);
	if (known && known->kind == SYMBOL_INPUT)       /* it is in its own unit already */
		value = written ? convert_unit(value, known->unit, false) : value;
	if (written || (known && known->kind != SYMBOL_INPUT))
		value = convert_unit(value, unit, true);
	if (p->token.kind != TOKEN_END && !is_op(p, ","))
		unexpected(p, "'=' or ','");
	if (p->part)                            /* the assembly names it as it is */
		return;
	for (struct symbol *s = p->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_OUTPUT && shares_column(s->name, shown))
			error(name.at, strcmp(s->name, shown) == 0 ? NULL : "a vector has a column for each component",
			      "output '%s' is declared already", strchr(s->name, '[') ? s->name : shown);
	struct symbol *symbol = NEW(struct symbol);
	*symbol = (struct symbol){
		.kind = SYMBOL_OUTPUT, .name = shown, .at = name.at, .statement = p->statement, .value = value
	};
	symbol->index = p->spec->count.outputs++;
	symbol->peak = peak;
	set_unit(symbol, unit);
	add_symbol(p->spec, symbol);
}

/* `peak(`, unless that is a name of the spec's own */
static bool take_peak(struct parser *p)
{
	if (find_symbol(p, "peak") || !take_word(p, "peak"))
		return false;
	expect_op(p, "(", "'(': peak(x) is the largest |x| so far");
	return true;
}

/* The note of `output x, 2*x` gives the expression a name. */
static _Noreturn void unnamed_output(const struct parser *p, const struct token *first)
{
	const char *at = p->lexer.source->text + first->at.offset;
	size_t length = strcspn(at, ",(#\r\n");
	if (first->kind == TOKEN_END)
		unexpected(p, "the name of an output");
	error(first->at, at[length] == '(' ? "output NAME = ..." : format("output NAME = %.*s", (int)length, at),
	      "an output that is an expression needs a name");
}

/* output: output ( NAME = expression | NAME = peak ( expression ) | name ) [ unit ] { , ... } */
void read_output(struct parser *p)
{
	p->output = true;
	do {
		if (p->token.kind != TOKEN_NAME)
			unnamed_output(p, &p->token);
		struct token name = take(p);
		if (p->token.kind == TOKEN_OPERATOR && strchr("+-*/^", p->token.op[0]))
			unnamed_output(p, &name);
		if (!is_op(p, "=")) {
			read_plain_output(p, name);
			continue;
		}
		if (name.primes > 0 || is_reserved(name.name))
			error(name.at, NULL, "'%s' cannot be the name of an output", name.name);
		take(p);
		struct place at = p->token.at;
		bool peak = take_peak(p);
		struct node *value = read_expression(p);
		if (peak)
			expect_op(p, ")", "')' or an operator");
		if (peak && p->token.kind == TOKEN_OPERATOR && strchr("+-*/^<>=!?", p->token.op[0]))
			peak_inside(at);
		const struct unit *unit = take_unit(p, value);
		struct symbol *output = declare(p, name, p->part ? SYMBOL_PART_OUTPUT : SYMBOL_OUTPUT, false);
		if (is_plain_number(value) || p->part)
			output->value = p->part ? with_unit(value, unit) : value;
		else
			output->value = convert_unit(value, unit, true);
		set_unit(output, unit);
		output->peak = peak;
	} while (take_op(p, ","));
	expect_end(p);
}

/* step: step expression [ unit ] */
void read_step(struct parser *p)
{
	struct place at = last_token(p, 4);
	if (p->own->request.step)
		error(at, NULL, "the step is given already");
	p->own->request.step_at = p->token.at;
	p->own->request.step = read_quantity(p);
	expect_end(p);
}

/* order or stages [ over steps ] */
struct node *take_order(struct parser *p, struct node **over)
{
	struct place at = p->token.at;
	if (!find_symbol(p, "over") && take_word(p, "over"))
		error(at, "scheme taylor N over K", "an expansion over several steps is of fixed order");
	struct node *order = read_expression(p);
	*over = take_word(p, "over") ? read_expression(p) : NULL;
	return order;
}

/* scheme: scheme NAME [ order or stages [ over steps ] ] */
void read_scheme(struct parser *p)
{
	struct place at = last_token(p, 6);
	if (p->own->request.scheme)
		error(at, NULL, "the scheme is given already");
	if (p->token.kind != TOKEN_NAME || p->token.primes > 0)
		unexpected(p, "the name of a scheme");
	struct token name = take(p);
	p->own->request.scheme_at = name.at;
	enum scheme scheme;
	bool counts = scheme_of(name.name, &scheme) && (scheme_row(scheme)->expands || scheme_row(scheme)->stages);
	if (p->token.kind == TOKEN_NUMBER || (counts && p->token.kind != TOKEN_END))
		/* a number behind another scheme is reported later */
		p->own->request.order = take_order(p, &p->own->request.over);
	expect_end(p);
	p->own->request.scheme = name.name;
}
