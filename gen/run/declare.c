/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declarations of generated C: types, names, and what stands outside of functions. */
#include "run/run.h"

#include <string.h>

void not_run(const struct code *c, const char *what)
{
	error(c->at, NULL, "internal error: the C of the model cannot be run here: %s at '%s'", what, peek(c)->text);
}

/* ---- lexemes ---- */

const struct lexeme *peek(const struct code *c)
{
	return &c->lexemes.list[c->here];
}

bool is_next(const struct code *c, unsigned mark)
{
	return peek(c)->kind == LEXEME_MARK && peek(c)->mark == mark;
}

bool is_word_next(const struct code *c, const char *word)
{
	return peek(c)->kind == LEXEME_NAME && strcmp(peek(c)->text, word) == 0;
}

bool take_mark(struct code *c, unsigned mark)
{
	bool taken = is_next(c, mark);
	c->here += taken;
	return taken;
}

bool take_keyword(struct code *c, const char *word)
{
	bool taken = is_word_next(c, word);
	c->here += taken;
	return taken;
}

void need(struct code *c, unsigned mark)
{
	if (!take_mark(c, mark))
		not_run(c, format("no '%c'", (int)(mark & 127)));
}

const char *take_name(struct code *c)
{
	if (peek(c)->kind != LEXEME_NAME)
		not_run(c, "no name");
	return c->lexemes.list[c->here++].text;
}

/* A bracket that is next, with all in it */
static void skip_to_end(struct code *c, unsigned open, unsigned close)
{
	int depth = 0;
	do {
		if (peek(c)->kind == LEXEME_END)
			not_run(c, "a bracket is not closed");
		depth += is_next(c, open) - is_next(c, close);
		c->here++;
	} while (depth > 0);
}

static void skip_statement(struct code *c)
{
	while (!is_next(c, ';') && peek(c)->kind != LEXEME_END) {
		if (is_next(c, '{'))
			skip_to_end(c, '{', '}');
		else
			c->here++;
	}
	take_mark(c, ';');
}

/* ---- names ---- */

static struct entity *named(struct entity *from, const char *name)
{
	for (struct entity *e = from; e; e = e->next)
		if (strcmp(e->name, name) == 0)
			return e;
	return NULL;
}

struct entity *entity_find(const struct code *c, const char *name)
{
	return named(c->newest, name);
}

struct entity *entity_new(struct code *c, enum entity_kind kind, const char *name, const struct ctype *type)
{
	struct entity *e = NEW(struct entity);
	*e = (struct entity){ .kind = kind, .name = name, .type = type, .next = c->newest };
	c->newest = e;
	return e;
}

/* ---- types ---- */

static const struct { const char *name; const struct ctype *type; } known_types[] = {
	{ "void", &ctype_void }, { "char", &ctype_char }, { "short", &ctype_short }, { "int", &ctype_int },
	{ "unsigned", &ctype_unsigned },
	{ "double", &ctype_double }, { "float", &ctype_float }, { "uint32_t", &ctype_unsigned },
	{ "int32_t", &ctype_int }, { "uint64_t", &ctype_wide }, { "int64_t", &ctype_long }, { "size_t", &ctype_wide },
	{ "ptrdiff_t", &ctype_long }, { "long", &ctype_long },
};
static const char *const qualifiers[] = { "const", "static", "extern", "inline", "typedef", "PL_RESTRICT", "PL_APART",
					  "volatile" };

static const struct ctype *known_type(const struct code *c, const char *name)
{
	for (size_t i = 0; i < sizeof known_types / sizeof *known_types; i++)
		if (strcmp(name, known_types[i].name) == 0)
			return known_types[i].type;
	const struct entity *e = entity_find(c, name);
	return e && e->kind == ENTITY_TYPE ? e->type : NULL;
}

static bool is_qualifier(const char *name)
{
	for (size_t i = 0; i < sizeof qualifiers / sizeof *qualifiers; i++)
		if (strcmp(name, qualifiers[i]) == 0)
			return true;
	return false;
}

static bool skip_qualifiers(struct code *c)
{
	bool any = false;
	while (peek(c)->kind == LEXEME_NAME && is_qualifier(peek(c)->text)) {
		any = true;
		c->here++;
	}
	return any;
}

bool is_type_next(const struct code *c)
{
	const char *name = peek(c)->text;
	if (peek(c)->kind != LEXEME_NAME)
		return false;
	return is_qualifier(name) || strcmp(name, "struct") == 0 || known_type(c, name);
}

static struct ctype *struct_of(struct code *c, const char *tag)
{
	struct entity *e = named(c->tagged, tag);
	if (!e) {
		struct ctype *type = NEW(struct ctype);
		*type = (struct ctype){ .kind = CTYPE_STRUCT, .align = 1 };
		e = NEW(struct entity);
		*e = (struct entity){ .kind = ENTITY_TYPE, .name = tag, .type = type, .next = c->tagged, .at = type };
		c->tagged = e;
	}
	return e->at;
}

/* As the ABI of every target at hand lays them out: each member at the next multiple of its alignment */
static void add_member(struct code *c, struct ctype *type, struct declared d)
{
	if (!d.name || d.function)
		not_run(c, "a member of an unknown kind");
	ENLARGE(type->member, (size_t)type->members + 1);
	size_t offset = (type->size + d.type->align - 1) / d.type->align * d.type->align;
	type->member[type->members++] = (struct ctype_member){ d.name, d.type, offset };
	type->size = offset + d.type->size;
	type->align = d.type->align > type->align ? d.type->align : type->align;
}

static const struct ctype *read_struct(struct code *c)
{
	static int unnamed;
	const char *tag = peek(c)->kind == LEXEME_NAME ? take_name(c) : format("%d", ++unnamed);
	struct ctype *type = struct_of(c, tag);
	if (!take_mark(c, '{'))
		return type;
	while (!take_mark(c, '}')) {
		const struct ctype *of = read_type(c);
		do
			add_member(c, type, read_declarator(c, of));
		while (take_mark(c, ','));
		need(c, ';');
	}
	type->size = (type->size + type->align - 1) / type->align * type->align;
	return type;
}

static const struct ctype *read_enum(struct code *c)
{
	int64_t next = 0;
	if (peek(c)->kind == LEXEME_NAME)
		c->here++;
	if (!take_mark(c, '{'))
		return &ctype_int;
	while (!take_mark(c, '}')) {
		const char *name = take_name(c);
		next = take_mark(c, '=') ? c->constant(c) : next;
		entity_new(c, ENTITY_NUMBER, name, &ctype_int)->number = next++;
		take_mark(c, ',');
	}
	return &ctype_int;
}

const struct ctype *read_type(struct code *c)
{
	const struct ctype *type = NULL;
	skip_qualifiers(c);
	if (take_keyword(c, "struct"))
		type = read_struct(c);
	else if (take_keyword(c, "enum"))
		type = read_enum(c);
	else if (peek(c)->kind == LEXEME_NAME)
		type = known_type(c, take_name(c));
	if (!type)
		not_run(c, "no type that is known");
	take_keyword(c, "int");                                    /* unsigned int */
	skip_qualifiers(c);
	return type;
}

/* ---- declarators ---- */

static const struct ctype *read_dimensions(struct code *c, const struct ctype *type)
{
	if (!take_mark(c, '['))
		return type;
	int count = is_next(c, ']') ? -1 : (int)c->constant(c);
	need(c, ']');
	return array_of(read_dimensions(c, type), count);
}

static void read_parameters(struct code *c, struct declared *d)
{
	d->function = true;
	if (take_mark(c, ')'))
		return;
	do {
		struct declared p = read_declarator(c, read_type(c));
		const struct ctype *type = p.type->kind == CTYPE_ARRAY ? pointer_to(p.type->of) : p.type;
		if (type->kind == CTYPE_VOID)
			break;
		ENLARGE(d->parameter, (size_t)d->parameters + 1);
		d->parameter[d->parameters++] = (struct entity){ .kind = ENTITY_VARIABLE, .type = type,
								 .name = p.name ? p.name : "" };
	} while (take_mark(c, ','));
	need(c, ')');
}

struct declared read_declarator(struct code *c, const struct ctype *type)
{
	struct declared d = { .type = type };
	for (; take_mark(c, '*'); skip_qualifiers(c))
		d.type = pointer_to(d.type);
	skip_qualifiers(c);
	if (is_next(c, '(') && c->lexemes.list[c->here + 1].mark == '*') { /* (*const x)[3]: a pointer to an array */
		c->here += 2;
		skip_qualifiers(c);
		d.name = peek(c)->kind == LEXEME_NAME ? take_name(c) : NULL;
		const struct ctype *many = is_next(c, '[') ? read_dimensions(c, &ctype_int) : NULL;
		need(c, ')');
		if (is_next(c, '('))
			not_run(c, "a pointer to a function");
		d.type = pointer_to(read_dimensions(c, d.type));
		if (many)
			d.type = array_of(d.type, many->count);
		return d;
	}
	if (peek(c)->kind == LEXEME_NAME)
		d.name = take_name(c);
	if (take_mark(c, '('))
		read_parameters(c, &d);
	else
		d.type = read_dimensions(c, d.type);
	return d;
}

/* ---- outside of functions ---- */

static void keep_function(struct code *c, struct declared d)
{
	struct entity *e = entity_find(c, d.name);
	if (!e)
		e = entity_new(c, ENTITY_FUNCTION, d.name, d.type);
	if (!is_next(c, '{'))
		return;
	e->parameters = d.parameters;
	e->parameter = ARRAY(struct entity *, (size_t)d.parameters + 1);
	for (int i = 0; i < d.parameters; i++) {
		e->parameter[i] = &d.parameter[i];
		e->parameter[i]->at = allocate(1, d.parameter[i].type->size);
	}
	e->body = c->here;
	skip_to_end(c, '{', '}');
}

static void keep_variable(struct code *c, struct declared d)
{
	struct entity *e = entity_find(c, d.name);
	if (!e)
		e = entity_new(c, ENTITY_VARIABLE, d.name, d.type);
	if (!take_mark(c, '='))
		return;
	e->filled = c->here;
	while (!is_next(c, ';') && !is_next(c, ',') && peek(c)->kind != LEXEME_END) {
		if (is_next(c, '{'))
			skip_to_end(c, '{', '}');
		else
			c->here++;
	}
}

static void read_declaration(struct code *c)
{
	bool type = is_word_next(c, "typedef");
	const struct ctype *of = read_type(c);
	while (!take_mark(c, ';')) {
		struct declared d = read_declarator(c, of);
		if (!d.name)
			not_run(c, "a declaration of an unknown kind");
		bool body = d.function && is_next(c, '{');
		if (type)
			entity_new(c, ENTITY_TYPE, d.name, d.type);
		else if (d.function)
			keep_function(c, d);
		else
			keep_variable(c, d);
		if (body)
			return;
		take_mark(c, ',');
	}
}

/* The same functions for programs that drive any model: pointers to functions, which nothing here calls */
static bool is_for_drivers(const struct code *c)
{
	for (int i = c->here; i < c->lexemes.count && i < c->here + 4; i++)
		if (strncmp(c->lexemes.list[i].text, "pl_model", 8) == 0)
			return true;
	return false;
}

void read_outside(struct code *c)
{
	while (peek(c)->kind != LEXEME_END) {
		if (is_word_next(c, "PL_ASSERT") || is_for_drivers(c))
			skip_statement(c);
		else
			read_declaration(c);
	}
}
