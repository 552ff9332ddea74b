/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An assembly of parts: each is a spec of its own, whose names get the part's name in front, front.body. What belongs
 * to all parts together is one flat spec, as if all had been written in one text. */
#include "read/parser.h"

#include <string.h>
#include <sys/stat.h>

/* ---- texts of parts: each is read, and looked at by itself, once ---- */

struct text {
	dev_t device;
	ino_t file;
	struct source *source;      /* NULL: of the assembly itself */
	bool good;                  /* by itself nothing is wrong with it */
	bool open;                  /* it is being looked at: what uses it now stands in it */
	const char *shown;
	struct text *next, *outer;  /* outer: the text that was open before */
};
static struct text *known, *innermost;

static struct text *text_of(const char *path)
{
	struct stat status;
	if (stat(path, &status) != 0)
		return NULL;
	for (struct text *t = known; t; t = t->next)
		if (t->device == status.st_dev && t->file == status.st_ino)
			return t;
	struct text *text = NEW(struct text);
	*text = (struct text){ status.st_dev, status.st_ino, .shown = path, .next = known };
	return known = text;
}

static void open_assembly(const struct source *source)
{
	struct text *text = text_of(source->name);
	if (text)
		text->open = true;
	innermost = text;
}

/* b.spec, which uses c.spec, which uses a.spec: from the innermost text out to `text` */
static const char *circle_text(const struct text *text)
{
	const char *list = text->shown;
	for (const struct text *t = innermost; t && t != text; t = t->outer)
		list = format("%s, which uses %s", t->shown, list);
	return format("%s uses %s", text->shown, list);
}

static int depth_of_texts(void)
{
	int depth = 0;
	for (const struct text *t = innermost; t; t = t->outer)
		depth++;
	return depth;
}

static void read_use(struct parser *p);
static void use_failed(struct parser *p, size_t after);
static const struct part_reader reader = { read_use, use_failed };

/* Names, expressions and statements: reported once, with the part's own names, however often the part is used. */
static void look_at(struct text *text)
{
	int before = diagnostics_errors();
	text->open = true;
	text->outer = innermost;
	innermost = text;
	parse_whole(text->source, &reader);
	innermost = text->outer;
	text->open = false;
	text->good = diagnostics_errors() == before;
}

static const struct text *read_text(const char *path, struct place at)
{
	struct text *text = text_of(path);
	if (text && text->open)
		error(at, circle_text(text), "a part uses itself");
	if (text && text->source)
		return text;
	if (depth_of_texts() > LIMIT_PARTS_INSIDE)
		error(at, NULL, "parts inside each other over the limit of %d", LIMIT_PARTS_INSIDE);
	struct source *source = source_read(path, at);
	if (!source)
		abandon();
	text = text ? text : text_of(path);
	text->source = source;
	source->repeats = true;
	look_at(text);
	return text;
}

/* ---- what the assembly gives ---- */

/* binding: NAME [ component ] { ' } = expression [ unit ] */
static struct binding read_binding(struct parser *p)
{
	if (p->token.kind != TOKEN_NAME)
		unexpected(p, "a param, an input or a coordinate of the part");
	struct token name = take(p);
	struct binding binding = { .name = name };
	binding.component = read_component(p, &binding.name.primes, false);
	expect_op(p, "=", "'='");
	binding.value = p->token.kind == TOKEN_STRING ? read_file_name(p) : read_expression(p);
	binding.value = with_unit(binding.value, take_unit(p, binding.value));
	return binding;
}

static void read_bindings(struct parser *p, struct assembly_part *use)
{
	bool before = p->no_acceleration;
	p->no_acceleration = true;
	do {
		struct binding binding = read_binding(p);
		for (const struct binding *b = use->binding; b < use->binding + use->bindings; b++)
			if (strcmp(b->name.name, binding.name.name) == 0 && b->name.primes == binding.name.primes &&
			    b->component == binding.component)
				error(binding.name.at, NULL, "%s is given already", token_text(binding.name));
		*MORE(use->binding, use->bindings) = binding;
	} while (take_op(p, ","));
	p->no_acceleration = before;
}

/* The nearest of the part's names, without the part's own */
static const char *nearest_in_part(const struct spec *spec, const struct assembly_part *part, const char *name)
{
	int count = 0;
	size_t length = strlen(part->name);
	const char **own = ARRAY(const char *, spec->count.symbols + 1);
	for (const struct symbol *s = spec->first; s; s = s->next)
		if (strncmp(s->name, part->name, length) == 0 && s->name[length] == '.')
			own[count++] = s->name + length + 1;
	const char *nearest = nearest_name(name, count, own);
	return nearest ? format("did you mean '%s'?", nearest) : NULL;
}

/* What was not taken as the part was read: initial values, and what a part has not */
static void bind(struct parser *p, const struct assembly_part *part, const struct binding *binding)
{
	struct spec *spec = p->spec;
	struct token name = binding->name;
	struct symbol *symbol = spec_find(spec, format("%s.%s", part->name, name.name));
	if (!symbol)
		error(name.at, nearest_in_part(spec, part, name.name), "%s has no '%s'", part->file, name.name);
	if (symbol->broken)
		abandon();
	bool settable = symbol->kind == SYMBOL_PARAM || symbol->kind == SYMBOL_MATRIX || symbol->kind == SYMBOL_INPUT ||
			symbol->connected;
	if (symbol->kind != SYMBOL_COORD)
		error(name.at, "after with: params, matrices, inputs, initial values x and x'",
		      settable ? "%s '%s' is given as a whole" : "%s '%s' is not given a value", symbol_kind(symbol),
		      name.name);
	check_component(symbol, binding->component, name.at);
	if (name.primes > 1)
		error(name.at, NULL, "an acceleration has no initial value: it follows from the equations");
	add_initial(p, name, symbol, binding->component, binding->value);
}

/* ---- parts ---- */

/* What says how the part is stepped by itself */
static const char *left_aside(const struct spec *own)
{
	const struct { const char *word; bool there;
	} statement[] = { { "step", own->request.step != NULL },
			  { "scheme", own->request.scheme != NULL },
			  { "tolerance", own->request.tolerance != NULL || own->request.absolutes > 0 },
			  { "substeps", own->request.substeps != NULL },
			  { "regions", own->request.cached != NULL },
			  { "events", own->request.events != NULL },
			  { "operator", own->operators.given },
			  { "modes", own->modes.count > 0 },
			  { "need", own->required.needs > 0 },
			  { "budget", own->required.budget.instructions != NULL } };
	const char *list = "";
	for (size_t i = 0; i < sizeof statement / sizeof *statement; i++)
		if (statement[i].there)
			list = format("%s%s%s", list, *list ? ", " : "", statement[i].word);
	return list;
}

static void add_part(struct parser *p, struct token name, const struct assembly_part *use, const struct text *text)
{
	struct spec *spec = p->spec;
	struct assembly_part *part = NEW(struct assembly_part);
	declare(p, name, SYMBOL_PART, !text->good);
	if (!text->good)
		return;
	if (spec->assembly.parts == LIMIT_ASSEMBLY)
		error(name.at, NULL, "more parts than the limit of %d", LIMIT_ASSEMBLY);
	*part = *use;
	part->name = p->part ? format("%s.%s", p->part->name, name.name) : name.name;
	part->at = name.at;
	part->source = text->source;
	part->inside = p->part;
	part->binding = ARRAY(struct binding, use->bindings);
	for (int i = 0; i < use->bindings; i++)
		part->binding[i] = use->binding[i];
	*MORE(spec->assembly.part, spec->assembly.parts) = part;
	struct spec *own = NEW(struct spec);
	parse_statements(spec, own, part, text->source);
	part->aside = left_aside(own);
	for (int i = 0; i < part->bindings; i++)
		if (!part->binding[i].taken)
			bind(p, part, &part->binding[i]);
}

/* use: use STRING as NAME { , NAME } [ with binding { , binding } ] */
static const char *parts_folder;

void read_parts_from(const char *folder)
{
	parts_folder = folder;
}

static bool is_there(const char *path)
{
	FILE *file = fopen(path, "rb");
	if (file)
		fclose(file);
	return file;
}

/* Beside the text that names it; else, of a name alone, among the parts that come with plgen */
static const char *path_of_part(const struct source *source, const char *name)
{
	const char *path = beside(source, name);
	const char *shared = parts_folder && !strchr(name, '/') ? format("%s/%s", parts_folder, name) : NULL;
	return shared && !is_there(path) && is_there(shared) ? shared : path;
}

static void read_use(struct parser *p)
{
	struct assembly_part use = { 0 };
	struct token file = p->token, *name = NULL;
	size_t names = 0;
	if (p->token.kind != TOKEN_STRING)
		error(p->token.at, "use \"axle.spec\" as front", "expected the file of a part in quotes, found %s",
		      token_text(p->token));
	take(p);
	use.file = format("%.*s", (int)file.length - 2, file.at.source->text + file.at.offset + 1);
	if (!take_word(p, "as"))
		unexpected(p, "'as' and the part's name");
	do {
		ENLARGE(name, names + 1);
		name[names++] = expect_new_name(p, "the name of a part");
	} while (take_op(p, ","));
	if (take_word(p, "with"))
		read_bindings(p, &use);
	if (p->token.kind != TOKEN_END && use.bindings == 0)
		unexpected(p, "',', 'with' or the end of the statement");
	expect_end(p);
	const char *path = path_of_part(file.at.source, use.file);
	const struct text *text = read_text(path, file.at);
	add_file(p->spec, path);
	for (size_t i = 0; i < names; i++)
		add_part(p, name[i], &use, text);
}

/* Their names are known but broken, so that their use is not reported as well. */
static void use_failed(struct parser *p, size_t after)
{
	static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789";
	const char *text = p->lexer.source->text, *end = text + p->lexer.end;
	bool named = false;
	for (const char *c = text + after; c < end && *c != '#';) {
		size_t length = strspn(c, letters);
		if (*c == '"')
			c = strpbrk(c + 1, "\"\n") ? strpbrk(c + 1, "\"\n") : end - 1;
		if (length == 0) {
			c++;
			continue;
		}
		const char *word = format("%.*s", (int)length, c);
		if (strcmp(word, "with") == 0)
			return;
		if (named)
			declare_quietly(p, (struct token){ .kind = TOKEN_NAME,
							   .at = { p->lexer.source, (size_t)(c - text) },
							   .length = length, .name = word }, SYMBOL_PART);
		named = named || strcmp(word, "as") == 0;
		c += length;
	}
}

/* ---- the whole ---- */

struct spec *parse_spec(const struct source *source)
{
	open_assembly(source);
	struct spec *spec = parse_whole(source, &reader);
	if (source->tunables)
		parse_tunables(spec, source->tunables);
	if (spec->assembly.parts && !spec->lagrange.energies && !spec->lagrange.totals && !diagnostics_errors())
		leave_unobservable(spec);       /* energies tie together what stands in them */
	fill_totals(spec);
	add_energy_elements(spec);
	return spec;
}

/* ---- for a reader ---- */

const char *written_text(const struct assembly_part *part, struct place at, struct place end)
{
	const char *text = text_between(at, end);
	return part ? format("%s: %s", part->name, text) : text;
}

const char *energy_text(const struct spec *spec, int index)
{
	const struct energy *e = &spec->lagrange.energy[index];
	const bool begins = index == 0 || e[-1].at.offset != e->at.offset || e[-1].at.source != e->at.source;
	return begins ? written_text(e->part, e->at, e->end) : NULL;
}

/* Parts of one file, all modelled or none, are reported together at the first of them. */
const char *parts_text(const struct spec *spec, int index)
{
	const struct assembly_part *part = spec->assembly.part[index];
	const char *names = "";
	for (int i = 0; i < spec->assembly.parts; i++) {
		const struct assembly_part *other = spec->assembly.part[i];
		if (other->source != part->source || other->unobservable != part->unobservable)
			continue;
		if (i < index)
			return NULL;
		names = format("%s%s%s", names, *names ? ", " : "", other->name);
	}
	return format("%s as %s%s%s", part->file, names,
		      part->unobservable ? ", which no output sees: not modelled" : "",
		      !part->unobservable && *part->aside ? format("; not used of it: %s", part->aside) : "");
}
