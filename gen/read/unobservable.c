/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What no output of an assembly can see is not modelled: parts, and coordinates. What an equation names is seen
 * together, and what an element of a network acts on; a force sees what it reads, and not the other way round. */
#include "read/parser.h"

struct list {                       /* of coordinates */
	int count;
	const struct symbol **coord;
};
struct tie {                        /* of an equation or element */
	struct list together, read; /* read: by those */
};
struct sight {
	struct spec *spec;
	bool *seen;                 /* coordinates, by the symbols' numbers */
	int *met;                   /* by the symbols' numbers: in which walk last */
	int walk;
	bool grown;
};

/* ---- which coordinates an expression reads ---- */

static void add_coordinates(struct sight *sight, const struct node *node, struct list *list)
{
	const struct symbol *symbol = node->kind == NODE_NAME ? node->symbol : NULL;
	bool fresh = symbol && sight->met[symbol->number] != sight->walk;
	if (fresh)
		sight->met[symbol->number] = sight->walk;
	if (fresh && symbol->kind == SYMBOL_COORD)
		*MORE(list->coord, list->count) = symbol;
	if (fresh && symbol->kind == SYMBOL_LET)
		add_coordinates(sight, symbol->value, list);
	for (int i = 0; i < node->children; i++)
		add_coordinates(sight, node->child[i], list);
}

static struct list read_by(struct sight *sight, const struct node *left, const struct node *right)
{
	struct list list = { 0 };
	sight->walk++;
	add_coordinates(sight, left, &list);
	if (right)
		add_coordinates(sight, right, &list);
	return list;
}

static struct list read_by_when(struct sight *sight, const struct when *when)
{
	struct list list = { 0 };
	sight->walk++;
	add_coordinates(sight, when->guard, &list);
	for (int i = 0; i < when->jumps; i++) {
		add_coordinates(sight, when->jump[i].target, &list);
		add_coordinates(sight, when->jump[i].value, &list);
	}
	return list;
}

/* ---- what is seen ---- */

static void see(struct sight *sight, const struct list *list)
{
	for (int i = 0; i < list->count; i++) {
		sight->grown = sight->grown || !sight->seen[list->coord[i]->number];
		sight->seen[list->coord[i]->number] = true;
	}
}

static void see_outputs(struct sight *sight)
{
	for (const struct symbol *s = sight->spec->first; s; s = s->next) {
		if (s->kind != SYMBOL_OUTPUT)
			continue;
		struct list list = read_by(sight, s->value, NULL);
		see(sight, &list);
	}
}

/* One that names no coordinate at all is not judged here. */
static bool is_seen(const struct sight *sight, const struct list *list)
{
	bool seen = list->count == 0;
	for (int i = 0; i < list->count; i++)
		seen = seen || sight->seen[list->coord[i]->number];
	return seen;
}

static struct tie *ties_of(struct sight *sight)
{
	const struct spec *spec = sight->spec;
	struct tie *tie = ARRAY(struct tie, (size_t)(spec->equations + spec->elements + spec->whens));
	for (int i = 0; i < spec->equations; i++)
		tie[i].together = read_by(sight, spec->equation[i].left, spec->equation[i].right);
	for (int i = 0; i < spec->elements; i++) {
		const struct element *element = &spec->element[i];
		struct tie *own = &tie[spec->equations + i];
		own->together = read_by(sight, element->from, element->to);
		own->read = read_by(sight, element->value, NULL);
	}
	for (int i = 0; i < spec->whens; i++)
		tie[spec->equations + spec->elements + i].together = read_by_when(sight, &spec->when[i]);
	return tie;
}

static void follow(struct sight *sight, const struct tie *tie)
{
	do {
		sight->grown = false;
		for (int i = 0; i < sight->spec->equations + sight->spec->elements + sight->spec->whens; i++) {
			if (!is_seen(sight, &tie[i].together))
				continue;
			see(sight, &tie[i].together);
			see(sight, &tie[i].read);
		}
	} while (sight->grown);
}

/* A part is unseen if it has coordinates of its own, and none of them is seen. */
static void find_unobservable_parts(struct sight *sight)
{
	struct spec *spec = sight->spec;
	for (int i = 0; i < spec->assembly.parts; i++) {
		bool any = false, seen = false;
		for (const struct symbol *s = spec->first; s; s = s->next)
			if (s->kind == SYMBOL_COORD && s->part == spec->assembly.part[i]) {
				any = true;
				seen = seen || sight->seen[s->number];
			}
		spec->assembly.part[i]->unobservable = any && !seen;
	}
}

/* ---- what is not goes ---- */

static bool goes(struct sight *sight, const struct symbol *symbol)
{
	bool unobservable = symbol->part && symbol->part->unobservable;
	if (symbol->kind == SYMBOL_COORD)
		return !sight->seen[symbol->number];
	if (symbol->kind != SYMBOL_LET)
		return unobservable && (symbol->kind == SYMBOL_INPUT || symbol->kind == SYMBOL_PARAM);
	struct list list = read_by(sight, symbol->value, NULL);
	for (int i = 0; i < list.count; i++)
		unobservable = unobservable || !sight->seen[list.coord[i]->number];
	return unobservable;
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
	for (int i = 0; i < (coord->length ? coord->length : 1) && !found; i++)
		found = has_kinetic_energy(spec, coord->index + i);
	return found;
}

static void name_unobservable(struct spec *spec, const struct symbol *coord)
{
	int count = coord->length ? coord->length : 1;
	for (int k = 0; k < (has_velocity(spec, coord) ? 2 : 1) * count; k++) {
		const char *prime = k < count ? "" : "'";
		*MORE(spec->assembly.unobservable_name, spec->assembly.unobservable) =
			coord->length ? format("%s[%d]%s", coord->name, k % count + 1, prime)
				      : format("%s%s", coord->name, prime);
	}
}

/* Params keep their names: -D may still give one of a part that is not there another value. */
static void drop_symbols(struct sight *sight, const bool *gone)
{
	struct spec *spec = sight->spec;
	spec->count.components = spec->count.coords = spec->count.inputs = spec->tuned.count = 0;
	for (struct symbol *s = spec->first, **link = &spec->first; s; s = s->next) {
		bool drop = gone[s->number] && s->kind != SYMBOL_PARAM;
		if (drop && s->kind == SYMBOL_COORD)
			name_unobservable(spec, s);
		if (gone[s->number]) {
			s->tuning.tuned = false;
			s->tuning.number = 0;
		}
		if (drop)
			continue;
		if (s->kind == SYMBOL_COORD) {
			s->index = spec->count.components;
			spec->count.components += s->length ? s->length : 1;
			spec->count.coords++;
		}
		if (s->kind == SYMBOL_INPUT)
			s->index = spec->count.inputs++;
		*link = s;
		link = &s->next;
		spec->last = link;
	}
	*spec->last = NULL;
}

static void drop_bounds(int *count, struct state_bound *bound, const bool *gone)
{
	int kept = 0;
	for (int i = 0; i < *count; i++)
		if (!gone[bound[i].coord->number])
			bound[kept++] = bound[i];
	*count = kept;
}

static void drop_others(struct spec *spec, const bool *gone, int tunables)
{
	int initials = 0, fixeds = 0;
	for (int i = 0; i < tunables; i++)
		if (!gone[spec->tuned.tunable[i].symbol->number])
			spec->tuned.tunable[spec->tuned.count++] = spec->tuned.tunable[i];
	for (int i = 0; i < spec->tuned.count; i++)
		spec->tuned.tunable[i].symbol->tuning.number = i + 1;
	for (int i = 0; i < spec->states.initials; i++)
		if (!gone[spec->states.initial[i].coord->number])
			spec->states.initial[initials++] = spec->states.initial[i];
	for (int i = 0; i < spec->operators.fixeds; i++)
		if (!spec->operators.fixed[i].symbol || !gone[spec->operators.fixed[i].symbol->number])
			spec->operators.fixed[fixeds++] = spec->operators.fixed[i];
	spec->states.initials = initials;
	spec->operators.fixeds = fixeds;
	spec->operators.given = fixeds > 0;
	drop_bounds(&spec->states.ranges, spec->states.range, gone);
	drop_bounds(&spec->request.absolutes, spec->request.absolute_of, gone);
}

static void drop_ties(struct sight *sight, const struct tie *tie)
{
	struct spec *spec = sight->spec;
	int equations = 0, elements = 0, whens = 0, first = spec->equations + spec->elements;
	for (int i = 0; i < spec->equations; i++)
		if (is_seen(sight, &tie[i].together))
			spec->equation[equations++] = spec->equation[i];
	for (int i = 0; i < spec->elements; i++)
		if (is_seen(sight, &tie[spec->equations + i].together))
			spec->element[elements++] = spec->element[i];
	for (int i = 0; i < spec->whens; i++)
		if (is_seen(sight, &tie[first + i].together))
			spec->when[whens++] = spec->when[i];
	spec->whens = whens;
	spec->equations = equations;
	spec->elements = elements;
}

/* A part inside one that is reported is not reported as well; nor are the coordinates of either. */
static void report(const struct sight *sight)
{
	const struct spec *spec = sight->spec;
	for (int i = 0; i < spec->assembly.parts; i++) {
		const struct assembly_part *part = spec->assembly.part[i];
		if (part->unobservable && !(part->inside && part->inside->unobservable))
			say_note(part->at, "part '%s' is not modelled: no output sees it", part->name);
	}
	for (const struct symbol *s = spec->first; s; s = s->next)
		if (s->kind == SYMBOL_COORD && !sight->seen[s->number] && !(s->part && s->part->unobservable))
			say_note(s->at, "'%s' is not modelled: no output sees it", s->name);
}

void leave_unobservable(struct spec *spec)
{
	size_t symbols = (size_t)spec->count.symbols + 1;
	struct sight sight = { .spec = spec, .seen = ARRAY(bool, symbols), .met = ARRAY(int, symbols) };
	see_outputs(&sight);
	if (!sight.grown)                       /* without outputs all states are */
		return;
	const struct tie *tie = ties_of(&sight);
	follow(&sight, tie);
	find_unobservable_parts(&sight);
	report(&sight);
	bool *gone = ARRAY(bool, symbols);
	for (const struct symbol *s = spec->first; s; s = s->next)
		gone[s->number] = goes(&sight, s);
	int tunables = spec->tuned.count;
	drop_symbols(&sight, gone);
	drop_others(spec, gone, tunables);
	drop_ties(&sight, tie);
}
