/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts of a scene that no output can see are not modelled. What an equation or an element of a sketch names holds
 * together; a force on something, or an expression that an input is connected to, makes that see what it reads, and not
 * the other way round. The scene's own coordinates count as one more part. */
#include "read/parser.h"

struct sight {
	struct spec *spec;
	bool *seen;                 /* by part; the last is the scene's own */
	bool grown;
};

static int place_of(const struct spec *spec, const struct scene_part *part)
{
	int place = 0;
	while (place < spec->parts && spec->part[place] != part)
		place++;
	return place;
}

/* ---- which parts an expression reads ---- */

/* A let is looked through once at a time. */
static void mark_parts(const struct spec *spec, const struct node *node, bool *let, bool *part)
{
	struct symbol *symbol = node->kind == NODE_NAME ? node->symbol : NULL;
	if (symbol && symbol->kind == SYMBOL_COORD)
		part[place_of(spec, symbol->part)] = true;
	if (symbol && symbol->kind == SYMBOL_LET && !let[symbol->number]) {
		let[symbol->number] = true;
		mark_parts(spec, symbol->value, let, part);
	}
	for (int i = 0; i < node->children; i++)
		mark_parts(spec, node->child[i], let, part);
}

static bool *parts_read(const struct spec *spec, const struct node *left, const struct node *right)
{
	bool *let = ARRAY(bool, (size_t)spec->symbols + 1), *part = ARRAY(bool, (size_t)spec->parts + 1);
	mark_parts(spec, left, let, part);
	if (right)
		mark_parts(spec, right, let, part);
	discard(let);
	return part;
}

static void see(struct sight *sight, int part)
{
	sight->grown = sight->grown || !sight->seen[part];
	sight->seen[part] = true;
}

static void see_all(struct sight *sight, const bool *part)
{
	for (int i = 0; i <= sight->spec->parts; i++)
		if (part[i])
			see(sight, i);
}

/* ---- what is seen ---- */

static void see_outputs(struct sight *sight)
{
	for (const struct symbol *s = sight->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_OUTPUT)
			see_all(sight, parts_read(sight->spec, s->value, NULL));
}

struct tie {                        /* of an equation or element */
	bool *together, *read;      /* parts; read: by those, NULL: none */
};

static struct tie tie_of_equation(const struct spec *spec, const struct equation *equation)
{
	struct tie tie = { parts_read(spec, equation->left, equation->right), NULL };
	bool any = false;
	for (int i = 0; i <= spec->parts; i++)
		any = any || tie.together[i];
	if (!any)
		tie.together[place_of(spec, equation->part)] = true;
	return tie;
}

static struct tie tie_of_element(const struct spec *spec, const struct element *element)
{
	struct tie tie = { parts_read(spec, element->from, element->to), NULL };
	tie.read = parts_read(spec, element->value, NULL);
	return tie;
}

static bool is_seen(const struct sight *sight, const struct tie *tie)
{
	bool seen = false;
	for (int i = 0; i <= sight->spec->parts; i++)
		seen = seen || (tie->together[i] && sight->seen[i]);
	return seen;
}

static void follow(struct sight *sight, const struct tie *tie, int ties)
{
	do {
		sight->grown = false;
		for (int i = 0; i < ties; i++) {
			if (!is_seen(sight, &tie[i]))
				continue;
			see_all(sight, tie[i].together);
			if (tie[i].read)
				see_all(sight, tie[i].read);
		}
	} while (sight->grown);
}

/* ---- what is not goes ---- */

static bool goes(const struct sight *sight, const struct symbol *symbol)
{
	bool own = symbol->kind == SYMBOL_COORD || (symbol->kind == SYMBOL_INPUT && symbol->part);
	if (own || (symbol->kind == SYMBOL_PARAM && symbol->part))
		return !sight->seen[place_of(sight->spec, symbol->part)];
	if (symbol->kind != SYMBOL_LET)
		return false;
	const bool *part = parts_read(sight->spec, symbol->value, NULL);
	bool unseen = symbol->part && !sight->seen[place_of(sight->spec, symbol->part)];
	for (int i = 0; i <= sight->spec->parts; i++)
		unseen = unseen || (part[i] && !sight->seen[i]);
	return unseen;
}

static bool accelerates(const struct node *node, const struct symbol *coord)
{
	bool found = node->kind == NODE_NAME && node->symbol == coord && node->primes > 1;
	for (int i = 0; i < node->children && !found; i++)
		found = accelerates(node->child[i], coord);
	return found;
}

static bool has_velocity(const struct spec *spec, const struct symbol *coord)
{
	bool found = false;
	for (int i = 0; i < spec->equations && !found; i++)
		found = accelerates(spec->equation[i].left, coord) || accelerates(spec->equation[i].right, coord);
	for (int i = 0; i < spec->elements && !found; i++)
		found = spec->element[i].kind == ELEMENT_MASS && spec->element[i].from->symbol == coord;
	return found;
}

static void name_unseen(struct spec *spec, const struct symbol *coord)
{
	int count = coord->length ? coord->length : 1;
	for (int k = 0; k < (has_velocity(spec, coord) ? 2 : 1) * count; k++) {
		const char *prime = k < count ? "" : "'";
		ENLARGE(spec->unseen_name, (size_t)spec->unseen + 1);
		spec->unseen_name[spec->unseen++] = coord->length ? format("%s[%d]%s", coord->name, k % count + 1, prime)
								  : format("%s%s", coord->name, prime);
	}
}

/* Params keep their names: -D may still give one of a part that is not there another value. */
static void drop_symbols(struct sight *sight, const bool *gone)
{
	struct spec *spec = sight->spec;
	spec->components = spec->coords = spec->inputs = spec->tunables = 0;
	for (struct symbol *s = spec->first, **link = &spec->first; s; s = s->next) {
		bool drop = gone[s->number] && s->kind != SYMBOL_PARAM;
		if (drop && s->kind == SYMBOL_COORD)
			name_unseen(spec, s);
		if (gone[s->number])
			s->tuned = false;
		if (drop)
			continue;
		if (s->kind == SYMBOL_COORD) {
			s->index = spec->components;
			spec->components += s->length ? s->length : 1;
			spec->coords++;
		}
		if (s->kind == SYMBOL_INPUT)
			s->index = spec->inputs++;
		*link = s;
		link = &s->next;
		spec->last = link;
	}
	*spec->last = NULL;
}

static void drop_others(struct spec *spec, const bool *gone, int tunables)
{
	int initials = 0, fixeds = 0;
	for (int i = 0; i < tunables; i++)
		if (!gone[spec->tunable[i].symbol->number])
			spec->tunable[spec->tunables++] = spec->tunable[i];
	for (int i = 0; i < spec->initials; i++)
		if (!gone[spec->initial[i].coord->number])
			spec->initial[initials++] = spec->initial[i];
	for (int i = 0; i < spec->fixeds; i++)
		if (!spec->fixed[i].symbol || !gone[spec->fixed[i].symbol->number])
			spec->fixed[fixeds++] = spec->fixed[i];
	spec->initials = initials;
	spec->fixeds = fixeds;
	spec->has_operator = fixeds > 0;
}

static void drop_ties(struct sight *sight, const struct tie *tie)
{
	struct spec *spec = sight->spec;
	int equations = 0, elements = 0;
	for (int i = 0; i < spec->equations; i++)
		if (is_seen(sight, &tie[i]))
			spec->equation[equations++] = spec->equation[i];
	for (int i = 0; i < spec->elements; i++)
		if (is_seen(sight, &tie[spec->equations + i]))
			spec->element[elements++] = spec->element[i];
	spec->equations = equations;
	spec->elements = elements;
}

/* A part inside one that is told is not told as well. */
static void tell(struct sight *sight)
{
	struct spec *spec = sight->spec;
	bool *own = ARRAY(bool, (size_t)spec->parts + 1);
	for (const struct symbol *s = spec->first; s; s = s->next)
		if (s->kind == SYMBOL_COORD)
			own[place_of(spec, s->part)] = true;
	for (int i = spec->parts - 1; i >= 0; i--) {
		struct scene_part *part = spec->part[i];
		part->unseen = own[i] && !sight->seen[i];
	}
	for (int i = 0; i < spec->parts; i++) {
		const struct scene_part *part = spec->part[i];
		if (part->unseen && !(part->inside && part->inside->unseen))
			say_note(part->at, "part '%s' is not modelled: no output sees it", part->name);
	}
	for (const struct symbol *s = spec->first; s && !sight->seen[spec->parts]; s = s->next)
		if (s->kind == SYMBOL_COORD && !s->part)
			say_note(s->at, "'%s' is not modelled: no output sees it", s->name);
}

void leave_unseen(struct spec *spec)
{
	struct sight sight = { .spec = spec, .seen = ARRAY(bool, (size_t)spec->parts + 1) };
	int ties = spec->equations + spec->elements;
	struct tie *tie = ARRAY(struct tie, (size_t)ties);
	see_outputs(&sight);
	if (!sight.grown)                       /* without outputs all states are */
		return;
	for (int i = 0; i < spec->equations; i++)
		tie[i] = tie_of_equation(spec, &spec->equation[i]);
	for (int i = 0; i < spec->elements; i++)
		tie[spec->equations + i] = tie_of_element(spec, &spec->element[i]);
	follow(&sight, tie, ties);
	tell(&sight);
	bool *gone = ARRAY(bool, (size_t)spec->symbols + 1);
	for (const struct symbol *s = spec->first; s; s = s->next)
		gone[s->number] = goes(&sight, s);
	int tunables = spec->tunables;
	drop_symbols(&sight, gone);
	drop_others(spec, gone, tunables);
	drop_ties(&sight, tie);
}
