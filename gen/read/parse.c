/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A text, statement by statement: which of them a line is, and what follows an error. */
#include "read/parser.h"

#include <string.h>

/* By a file that stands on this one */
static void read_part(struct parser *p)
{
	p->spec->assembly.uses = p->lexer.points = true;
	p->spec->assembly.reader->read(p);
}

static const struct statement {
	const char *word;
	void (*read)(struct parser *);
} statements[] = {
	{ "model", read_model }, { "param", read_param }, { "coord", read_coord }, { "init", read_init },
	{ "let", read_let }, { "output", read_output }, { "step", read_step }, { "scheme", read_scheme },
	{ "input", read_input }, { "matrix", read_matrix_statement }, { "mass", read_mass }, { "spring", read_spring },
	{ "damper", read_damper }, { "force", read_force }, { "operator", read_operator }, { "tunable", read_tunable },
	{ "tolerance", read_tolerance }, { "substeps", read_substeps }, { "modes", read_modes }, { "use", read_part },
	{ "regions", read_cached }, { "events", read_events },
	{ "need", read_need }, { "budget", read_budget }, { "friction", read_friction },
	{ "energy", read_energy }, { "dissipation", read_dissipation },
	{ "constraint", read_constraint }, { "when", read_when }, { "stop", read_stop },
	{ "range", read_range }, { "draw", read_draw }, { "sensitivity", read_sensitivity }
};

/* tolerance, substeps, events, regions, modes, use, need, budget, when, stop, range and sensitivity may be names of a
 * spec's own: in an equation an operator or a prime follows; a sign is that of a number where the line has no =; an =
 * is no equation where there is no such name. */
static bool opens_statement(const struct parser *p, const struct statement *statement, struct token token)
{
	const char *next = token.at.source->text + token.at.offset + token.length;
	next += strspn(next, " \t");
	bool sign = *next == '-' || *next == '+';
	if (strcmp(statement->word, "when") == 0 && next[strcspn(next, ":\n")] == ':' && sign)
		return true;                    /* when -x > 0: x' = 0 */
	if (strcmp(statement->word, "friction") == 0 && *next == '(') {     /* friction(v, F) of an equation */
		const char *between = strstr(next, " between ");
		return between && between < next + strcspn(next, "\n#");
	}
	return is_reserved(statement->word) || strspn(next, WORD) > 0 || strchr(".\"", *next) || *next == '(' ||
	       *next == '\n' || *next == '#' || (sign && next[strcspn(next, "=\n")] != '=') ||
	       (*next == '=' && !find_symbol(p, statement->word));
}

static const struct statement *statement_of(const struct parser *p, struct token token)
{
	for (size_t i = 0; token.kind == TOKEN_NAME && token.primes == 0 && i < sizeof statements / sizeof *statements;
	     i++)
		if (strcmp(token.name, statements[i].word) == 0 && opens_statement(p, &statements[i], token))
			return &statements[i];
	return NULL;
}

static const char *nearest_statement(const char *word)
{
	const char *known[sizeof statements / sizeof *statements], *habit = statement_habit(word);
	if (habit)
		return habit;
	for (size_t i = 0; i < sizeof statements / sizeof *statements; i++)
		known[i] = statements[i].word;
	return nearest_name(word, (int)(sizeof statements / sizeof *statements), known);
}

/* A line such as `parm m = 1` or `stpe 0.01`: no expression starts with a name and a name or number. */
static bool resembles_statement(const struct parser *p, struct token token)
{
	const char *text = token.at.source->text + token.at.offset + token.length;
	size_t space = strspn(text, " \t");
	return token.kind == TOKEN_NAME && token.primes == 0 && space > 0 && strspn(text + space, WORD) > 0 &&
	       !find_symbol(p, token.name) && (!is_reserved(token.name) || statement_habit(token.name));
}

/* It is meant as a statement: say so rather than that its first word is unknown. */
static void check_statement_word(const struct parser *p)
{
	struct token token = p->token;
	if (!resembles_statement(p, token))
		return;
	const char *nearest = nearest_statement(token.name);
	error(token.at, nearest ? format("did you mean '%s'?", nearest) : NULL, "unknown statement '%s'", token.name);
}

/* equation: expression = expression */
static void read_equation(struct parser *p)
{
	check_statement_word(p);
	struct spec *spec = p->spec;
	struct equation equation = { .at = p->token.at, .part = p->part };
	spec->equations++;                      /* counted even if broken: its absence is not to be reported as well */
	ENLARGE(spec->equation, (size_t)spec->equations);
	spec->equation[spec->equations - 1] = equation;
	equation.left = read_expression(p);
	if (p->token.kind == TOKEN_END && equation.left->kind == NODE_COMPARE && equation.left->comparison == CMP_EQ)
		error(equation.left->at, "an equation has a single =",
		      "expected an operator or the '=' of the equation, found '=='");
	if (p->token.kind == TOKEN_END && !is_unfinished(p))
		error(p->token.at, "an equation of motion has two sides: m*x'' + c*x' + k*x = 0",
		      "expected an operator or the '=' of the equation, found %s", token_text(p->token));
	if (!is_op(p, "="))
		unexpected(p, "an operator or the '=' of the equation");
	take(p);
	equation.right = read_expression(p);
	equation.end = p->end;
	if (is_op(p, "="))
		error(p->token.at, NULL, "an equation has a single =");
	expect_end(p);
	spec->equation[spec->equations - 1] = equation;
}

static void read_statement(void *context)
{
	struct parser *p = context;
	p->token = lex_next(&p->lexer);
	p->end = p->token.at;
	const struct statement *statement = statement_of(p, p->token);
	if (!p->own->name && !(statement && statement->read == read_model)) {
		p->own->name = "";              /* reported once */
		error(p->token.at, "a spec begins with its name: model NAME",
		      "expected the statement 'model', found %s", token_text(p->token));
	}
	if (!p->own->name)
		p->own->name = "";              /* should its statement fail, that is reported */
	if (!statement) {
		read_equation(p);
	} else {
		take(p);
		statement->read(p);
	}
}

/* ---- after an error ---- */

struct quiet { struct parser *parser; struct token name; enum symbol_kind kind; };

static void declare_broken(void *context)
{
	struct quiet *quiet = context;
	if (!find_symbol(quiet->parser, quiet->name.name))
		declare(quiet->parser, quiet->name, quiet->kind, true);
}

void declare_quietly(struct parser *p, struct token name, enum symbol_kind kind)
{
	statement_guard(declare_broken, &(struct quiet){ p, name, kind });
}

/* The statement that starts at `from`, or that its misspelt first word is meant for. Nothing is lexed: what cannot be
 * has been reported, and no guard stands around this. */
static const struct statement *failed_statement(const struct parser *p, size_t from, size_t *after)
{
	const char *text = p->lexer.source->text + from;
	size_t length = strspn(text, WORD);
	struct token token = { TOKEN_NAME, { p->lexer.source, from }, length, "", format("%.*s", (int)length, text),
			       text[length] == '\'' };
	const struct statement *statement = statement_of(p, token);
	*after = from + length;
	if (statement || !resembles_statement(p, token))
		return statement;
	const char *nearest = nearest_statement(token.name);
	for (size_t i = 0; nearest && i < sizeof statements / sizeof *statements; i++)
		if (strcmp(nearest, statements[i].word) == 0)
			return &statements[i];
	return NULL;
}

/* The names that a failed statement has declared, from `declared` on, or would have, are known but broken: their use
 * is not reported as well. */
static void declare_what_failed(struct parser *p, size_t from, struct symbol *declared)
{
	const char *text = p->lexer.source->text;
	size_t after;
	const struct statement *statement = failed_statement(p, from, &after);
	for (struct symbol *s = declared; s; s = s->next)
		if (s->statement == p->statement && s->part == p->part &&
		    (s->kind == SYMBOL_PARAM || s->kind == SYMBOL_MATRIX))
			s->broken = true;
	if (statement && statement->read == read_part)
		p->spec->assembly.reader->failed(p, after);
	bool all = statement && (statement->read == read_coord || statement->read == read_input);
	if (!statement || (!all && statement->read != read_param && statement->read != read_let &&
			   statement->read != read_output && statement->read != read_matrix_statement &&
			   statement->read != read_constraint))
		return;
	bool listed = true;                     /* here a definition starts, even one without its = */
	int depth = 0;
	for (size_t i = after; i < p->lexer.end; i++) {
		if (text[i] == '#')
			i += strcspn(text + i, "\n");
		if (text[i] == '"')             /* a unit, a file */
			i += 1 + strcspn(text + i + 1, "\"\n");
		if (i >= p->lexer.end)
			break;
		size_t length = strspn(text + i, WORD);
		if (length == 0) {
			depth += strchr("([{", text[i]) ? 1 : strchr(")]}", text[i]) ? -1 : 0;
			listed = depth == 0 && (text[i] == ',' || (listed && strchr(" \t\r\n", text[i])));
			continue;
		}
		const char *next = text + i + length + strspn(text + i + length, " \t");
		bool defined = listed || (next[0] == '=' && next[1] != '=');
		listed = false;
		if ((all || defined) && !strchr("0123456789", text[i])) {
			struct token token = {
				TOKEN_NAME, { p->lexer.source, i }, length, "", format("%.*s", (int)length, text + i), 0
			};
			declare_quietly(p, token, SYMBOL_PARAM);
		}
		i += length - 1;
	}
}

/* Whether the line from `from` to `end` can be the rest of an unfinished statement: one that opens a statement cannot,
 * one that is not set in where it goes on with a list: k = 100 */
static bool is_rest(const struct parser *p, size_t from, size_t end)
{
	const char *text = p->lexer.source->text;
	size_t first = from + strspn(text + from, " \t"), after;
	size_t word = first + strspn(text + first, WORD);
	word += strspn(text + word, " \t");
	bool listed = failed_statement(p, p->statement, &after) && strchr("=,#\r\n", text[word]);
	return first < end && (first > from || listed) && !failed_statement(p, first, &after);
}

static bool goes_on(const struct parser *p)
{
	const struct source *source = p->lexer.source;
	size_t unclosed, from = p->lexer.end + 1;
	return is_unfinished(p) && from < source->length &&
	       is_rest(p, from, lex_statement_end(source, from, &unclosed));
}

/* The lines that go on with an unfinished statement: what it declares there is known, and they are no equations. */
static void take_unfinished_lines(struct parser *p)
{
	const struct source *source = p->lexer.source;
	bool more = is_unfinished(p);
	while (more && p->lexer.end + 1 < source->length) {
		size_t unclosed, from = p->lexer.end + 1, end = lex_statement_end(source, from, &unclosed);
		if (!is_rest(p, from, end))
			break;
		p->lexer.end = end;
		size_t last = from + strcspn(source->text + from, "#\n");
		while (last > from && strchr(" \t\r", source->text[last - 1]))
			last--;
		more = last > from && strchr(",+-*/^=", source->text[last - 1]);
	}
}

/* spec: { statement line-end } */
void parse_statements(struct spec *spec, struct spec *own, struct assembly_part *part, const struct source *source)
{
	size_t position = strncmp(source->text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
	while (position < source->length) {
		size_t unclosed, from = position;
		struct symbol **declared = spec->last;
		struct parser p = { .spec = spec, .own = own, .part = part, .goes_on = goes_on };
		p.lexer = (struct lexer){ source, from, lex_statement_end(source, from, &unclosed), spec->assembly.uses,
					  false };
		position = p.lexer.end + 1;
		for (size_t i = from; strchr(" \t\r\f\v", source->text[i]) && i < p.lexer.end;)
			from = ++i;
		if (from >= p.lexer.end || source->text[from] == '#')
			continue;
		p.statement = from;
		bool good = false;
		if (unclosed != SIZE_MAX)
			say_error((struct place){ source, unclosed }, NULL, "'%c' is not closed",
				  source->text[unclosed]);
		else
			good = statement_guard(read_statement, &p);
		if (good)
			continue;
		if (unclosed == SIZE_MAX)
			take_unfinished_lines(&p);
		position = p.lexer.end + 1;
		declare_what_failed(&p, from, *declared);
	}
	struct place end = place_end(source);
	if (!own->name)
		say_error(end.offset ? end : (struct place){ source, 0 }, "a spec begins with its name: model NAME",
			  source->length ? "there is no statement in this file" : "the file is empty");
}

struct spec *parse_whole(const struct source *source, const struct part_reader *reader)
{
	struct spec *spec = NEW(struct spec);
	spec->source = source;
	spec->assembly.reader = reader;
	spec->last = &spec->first;
	spec->bucket = ARRAY(struct symbol *, BUCKETS);
	spec->end = place_end(source);
	spec->name_at = (struct place){ source, 0 };    /* until `model` is read */
	parse_statements(spec, spec, NULL, source);
	return spec;
}

struct argument {
	struct parser parser;
	struct node *value, **over; /* over: behind the name of a scheme */
	bool matrix;                /* the name of a file may stand there */
};

static void read_argument(void *context)
{
	struct argument *argument = context;
	struct parser *p = &argument->parser;
	p->token = lex_next(&p->lexer);
	p->end = p->token.at;
	const bool file = argument->matrix && p->token.kind == TOKEN_STRING;
	struct node *value = file ? read_file_name(p)
			     : argument->over ? take_order(p, argument->over)
					      : read_quantity(p);
	expect_end(p);
	argument->value = value;
}

static struct node *parse_part(struct spec *spec, struct lexer lexer, struct argument argument)
{
	argument.parser = (struct parser){ .spec = spec, .own = spec, .lexer = lexer };
	argument.parser.lexer.points = spec->assembly.uses;
	statement_guard(read_argument, &argument);
	return argument.value;
}

struct node *parse_scheme_order(struct spec *spec, const struct source *source, size_t from, struct node **over)
{
	return parse_part(spec, (struct lexer){ .source = source, .position = from, .end = source->length },
			  (struct argument){ .over = over });
}

struct node *parse_argument(struct spec *spec, const struct source *source, size_t from, size_t until)
{
	return parse_part(spec, (struct lexer){ .source = source, .position = from, .end = until },
			  (struct argument){ 0 });
}

struct node *parse_definition(struct spec *spec, const struct definition *d, const struct symbol *symbol)
{
	return parse_part(spec, (struct lexer){ .source = d->at.source, .position = d->from, .end = d->until },
			  (struct argument){ .matrix = symbol->kind == SYMBOL_MATRIX });
}

struct listing {
	struct parser parser;
	struct mode_list list;
};

static void read_listing(void *context)
{
	struct listing *listing = context;
	take(&listing->parser);                 /* the first token, before which there is none */
	listing->list = take_modes(&listing->parser);
}

struct mode_list parse_mode_list(struct spec *spec, const struct source *source)
{
	struct listing listing = { .parser = { .spec = spec, .lexer = { source, 0, source->length } } };
	const struct mode_list none = { .count = 0 };
	return statement_guard(read_listing, &listing) ? listing.list : none;
}
