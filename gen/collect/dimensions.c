/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statements to groups of terms that have to be alike; what follows from them, and what contradicts. */
#include "collect/dimensions.h"

#include <stdlib.h>
#include <string.h>

/* ---- statements ---- */

static void add_equations(struct dimensions *w)
{
	const struct spec *spec = w->spec;
	for (int i = 0; i < spec->equations; i++) {
		const struct equation *equation = &spec->equation[i];
		w->statement = equation;
		if (!equation->right)
			continue;
		int group = new_group(w, "the equation");
		add_terms(w, group, equation->left);
		add_terms(w, group, equation->right);
	}
}

static struct dimension of_state(const struct dimensions *w, const struct symbol *coord, int component, int primes)
{
	struct node name = { .kind = NODE_NAME, .symbol = (struct symbol *)(uintptr_t)coord, .component = component,
			     .primes = primes };
	return of_name(w, &name);
}

/* Something named, and what is said of it */
static int add_pair(struct dimensions *w, const void *statement, const char *what, const char *name, struct place at,
		    struct dimension d)
{
	w->statement = statement;
	int group = new_group(w, what);
	add_term(&w->group[group], NULL, name, at, d);
	return group;
}

static const char *state_text(const struct symbol *coord, int component, int primes)
{
	return component ? format("%s[%d]%.*s", coord->name, component, primes, "''")
			 : format("%s%.*s", coord->name, primes, "''");
}

/* A number is a force or a mass in its own statement; in the products of a total it would be a factor. */
static bool add_total(struct dimensions *w, const struct symbol *s)
{
	const struct total *total = w->spec->lagrange.total, *end = total + w->spec->lagrange.totals;
	while (total < end && total->let != s)
		total++;
	if (total == end)
		return false;
	RATIONAL time = RATIO(total->kind == TOTAL_POWER ? -1 : total->kind == TOTAL_MOMENTUM, 1), minus = RATIO(-1, 1);
	int group = add_pair(w, s, format("'%s'", s->name), NULL, s->at, of_symbol(w, s, 0));
	struct dimension d = of_energies(w);
	mpq_add(d.base[SECOND], d.base[SECOND], time);
	if (total->kind == TOTAL_MOMENTUM) {
		const struct dimension at = of_name(w, total->coord);
		add_dimension(w, &d, &at, minus);
	}
	w->group[group].defines = true;
	add_term(&w->group[group], NULL, NULL, s->at, d);
	return true;
}

static void add_value(struct dimensions *w, const struct symbol *s)
{
	if (s->delayed) {
		int time = add_pair(w, s, "the time of a delay", "t", s->at, dimension_of_time());
		add_terms(w, time, s->when);
		return;
	}
	if (!s->value || s->kind == SYMBOL_PART_OUTPUT || add_total(w, s))
		return;
	if (s->kind == SYMBOL_MATRIX && !s->unit_written) {
		w->statement = s;
		dimension_of(w, s->value);
		return;
	}
	const bool output = s->kind == SYMBOL_OUTPUT;
	int group = add_pair(w, s, output ? format("output '%s'", s->name) : format("'%s'", s->name), NULL,
			     s->unit_written ? s->unit->at : s->at, of_symbol(w, s, 0));
	if (w->group[group].terms && s->unit_written)
		w->group[group].term[0].text = format("\"%s\"", s->unit->text);
	w->group[group].defines = true;
	add_terms(w, group, s->value);
}

static void add_bounds(struct dimensions *w, int count, const struct state_bound *bound)
{
	for (int i = 0; i < count; i++) {
		const struct state_bound *b = &bound[i];
		int group = add_pair(w, b, "the state", state_text(b->coord, b->component, b->primes), b->at,
				     of_state(w, b->coord, b->component, b->primes));
		add_terms(w, group, b->low);
		if (b->high)
			add_terms(w, group, b->high);
	}
}

static bool is_same_place(const struct node *a, const struct node *b)
{
	return a && b && a->symbol == b->symbol && a->component == b->component;
}

/* Forces on a coordinate have one dimension; an element between two acts on both with one dimension. */
static void add_elements(struct dimensions *w)
{
	const struct spec *spec = w->spec;
	struct dimension *force = ARRAY(struct dimension, spec->elements);
	for (int i = 0; i < spec->elements; i++) {
		const struct element *e = &spec->element[i];
		w->statement = e;
		force[i] = of_element(w, e);
		if (e->to) {
			int group = new_group(w, "the two ends");
			add_term(&w->group[group], e->from, NULL, e->from->start, of_name(w, e->from));
			add_term(&w->group[group], e->to, NULL, e->to->start, of_name(w, e->to));
		}
	}
	for (int i = 0; i < spec->elements; i++)
		for (int end = 0; end < 2; end++) {
			const struct node *at = end ? spec->element[i].to : spec->element[i].from;
			bool first = at;
			for (int k = 0; k < i; k++)
				first = first && !is_same_place(at, spec->element[k].from) &&
					!is_same_place(at, spec->element[k].to);
			if (!first)
				continue;
			w->statement = NULL;
			int group = new_group(w, format("what acts on %s", state_text(at->symbol, at->component, 0)));
			for (int k = i; k < spec->elements; k++) {
				const struct element *e = &spec->element[k];
				if (is_same_place(at, e->from) || is_same_place(at, e->to))
					add_term(&w->group[group], e->value, text_between(e->at, e->end),
						 e->value->start, force[k]);
			}
		}
}

static bool reads_velocities(const struct node *node, bool *seen)
{
	const struct symbol *s = node->kind == NODE_NAME ? node->symbol : NULL;
	bool reads = s && s->kind == SYMBOL_COORD && node->primes > 0;
	if (s && s->kind == SYMBOL_LET && s->value && !seen[s->number]) {
		seen[s->number] = true;
		reads = reads_velocities(s->value, seen);
	}
	for (int i = 0; !s && i < node->children && !reads; i++)
		reads = reads_velocities(node->child[i], seen);
	return reads;
}

/* Its terms are alike. The multiplier times it is an energy, of velocities a power. */
static void add_constraint(struct dimensions *w, const struct energy *e)
{
	RATIONAL minus = RATIO(-1, 1);
	SCRATCH bool *seen = ARRAY(bool, (size_t)w->spec->count.symbols + 1);
	add_terms(w, new_group(w, "the constraint"), e->value);
	struct dimension multiplier = of_energies(w), g = dimension_of(w, e->value->child[0]);
	g = g.kind == GIVEN ? g : dimension_of(w, e->value->child[1]);
	if (g.kind != GIVEN || multiplier.kind != GIVEN)
		return;
	if (reads_velocities(e->value, seen))
		mpq_add(multiplier.base[SECOND], multiplier.base[SECOND], minus);
	add_dimension(w, &multiplier, &g, minus);
	int group = add_pair(w, e, format("'%s'", e->multiplier->name), NULL, e->at, of_symbol(w, e->multiplier, 0));
	w->group[group].defines = true;
	add_term(&w->group[group], NULL, NULL, e->at, multiplier);
}

/* Energies have one dimension, as has a force at a point times its place; dissipated power is that over time. */
static void add_energies(struct dimensions *w)
{
	const struct spec *spec = w->spec;
	const struct energy *first = first_energy(w);
	RATIONAL one = RATIO(1, 1);
	for (int i = 0; i < spec->lagrange.energies; i++) {
		const struct energy *e = &spec->lagrange.energy[i];
		w->statement = e;
		if (e->kind == 'G')
			add_constraint(w, e);
		const struct dimension energy = of_written_energy(w);
		if (e->kind == 'G' || energy.kind != GIVEN)
			continue;
		int group = new_group(w, e->kind == 'D' ? "the dissipation" : "the energies");
		if (e->kind == 'D')
			mpq_sub(energy.base[SECOND], energy.base[SECOND], one);
		if (e != first)
			add_term(&w->group[group], NULL, format("%c", first->kind), first->at, energy);
		for (int k = 0; k < (e->point ? e->point->children : 0); k++) {
			struct dimension F = dimension_of(w, e->value->child[k]);
			struct dimension r = dimension_of(w, e->point->child[k]);
			if (F.kind != GIVEN || r.kind != GIVEN)
				continue;
			add_dimension(w, &F, &r, one);
			add_term(&w->group[group], e->value->child[k], NULL, e->value->child[k]->start, F);
		}
		if (!e->point)
			add_terms(w, group, e->value);
	}
}

/* Places and radii are of one dimension, a turn is a number. */
static void add_drawings(struct dimensions *w)
{
	const struct spec *spec = w->spec;
	w->statement = NULL;
	const int group = spec->page.drawings ? new_group(w, "what is drawn") : 0;
	for (int i = 0; i < spec->page.drawings; i++) {
		const struct drawing *d = &spec->page.drawing[i];
		struct node *node[MOST_DRAWN];
		const int count = nodes_of_drawing(d, node);
		for (int k = 0; k < count; k++) {
			const struct dimension of = dimension_of(w, node[k]);   /* it may add groups */
			if (node[k] != d->turn)
				add_term(&w->group[group], node[k], NULL, node[k]->start, of);
		}
		if (d->turn)
			need_number(w, "turned", d->turn, dimension_of(w, d->turn));
	}
}

static void add_whens(struct dimensions *w)
{
	const struct spec *spec = w->spec;
	for (int i = 0; i < spec->whens; i++) {
		const struct when *when = &spec->when[i];
		w->statement = when;
		dimension_of(w, when->guard);
		if (when->restitution)
			need_number(w, "a restitution", when->restitution, dimension_of(w, when->restitution));
		for (int k = 0; k < when->jumps; k++) {
			int group = new_group(w, "the jump");
			add_terms(w, group, when->jump[k].target);
			add_terms(w, group, when->jump[k].value);
		}
	}
}

static const struct symbol *named(const struct spec *spec, const char *name, enum symbol_kind kind)
{
	for (const struct symbol *s = spec->first; s; s = s->next)
		if (s->kind == kind && strcmp(s->name, name) == 0)
			return s;
	return NULL;
}

static void add_need(struct dimensions *w, const struct need *need)
{
	const struct symbol *output = named(w->spec, need->output, SYMBOL_OUTPUT);
	if (output && !need->percent) {
		int group = add_pair(w, need->bound, "the output", need->output, need->output_at,
				     of_symbol(w, output, 0));
		add_terms(w, group, need->bound);
	}
	int time = add_pair(w, need->until, "an end", "t", need->at, dimension_of_time());
	add_terms(w, time, need->until);
	for (int i = 0; i < need->inputs; i++) {
		const struct symbol *input = named(w->spec, need->input[i].name, SYMBOL_INPUT);
		if (!input)
			continue;
		int group = add_pair(w, need->input[i].most, "the input", input->name, need->input[i].at,
				     of_symbol(w, input, 0));
		add_terms(w, group, need->input[i].most);
	}
}

static void add_requested(struct dimensions *w)
{
	const struct spec *spec = w->spec;
	for (int i = 0; i < spec->states.initials; i++) {
		const struct initial *initial = &spec->states.initial[i];
		int group = add_pair(w, initial, "the state",
				     state_text(initial->coord, initial->component, initial->primes), initial->at,
				     of_state(w, initial->coord, initial->component, initial->primes));
		add_terms(w, group, initial->value);
	}
	add_bounds(w, spec->states.ranges, spec->states.range);
	add_bounds(w, spec->request.absolutes, spec->request.absolute_of);
	for (int i = 0; i < spec->tuned.count; i++) {
		const struct tunable *tunable = &spec->tuned.tunable[i];
		if (!tunable->low)
			continue;
		int group = add_pair(w, tunable, "the param", tunable->symbol->name, tunable->at,
				     of_symbol(w, tunable->symbol, 0));
		add_terms(w, group, tunable->low);
		add_terms(w, group, tunable->high);
	}
	for (int i = 0; i < spec->operators.fixeds; i++) {
		const struct fixed *f = &spec->operators.fixed[i];
		int group = add_pair(w, f, "the name", f->symbol ? f->symbol->name : "t", f->at,
				     f->symbol ? of_state(w, f->symbol, f->component, f->primes)
					       : dimension_of_time());
		for (int k = 0; k < f->values; k++)
			add_terms(w, group, f->value[k]);
	}
	if (spec->request.step) {
		int group = add_pair(w, &spec->request, "a step", "t", spec->request.step_at, dimension_of_time());
		add_terms(w, group, spec->request.step);
	}
	for (int i = 0; i < spec->required.needs; i++)
		add_need(w, &spec->required.need[i]);
}

/* ---- messages ---- */

/* One message for each statement and for each place */
static bool has_failed(struct dimensions *w, const void *statement)
{
	for (int i = 0; i < w->statements && statement; i++)
		if (w->failed[i] == statement)
			return true;
	*MORE(w->failed, w->statements) = statement;
	return false;
}

static const char *unit_text(const struct dimension *d)
{
	const mpq_t *base = (const mpq_t *)d->base;
	return rationals_zero(UNIT_BASES, base) ? "a plain number" : si_unit_text(base);
}

/* in N = kg m/s^2 */
static const char *dimension_text(const struct dimension *d)
{
	const char *name = unit_text(d), *base = base_unit_text((const mpq_t *)d->base);
	if (rationals_zero(UNIT_BASES, (const mpq_t *)d->base))
		return name;
	return strcmp(name, base) == 0 ? format("in %s", base) : format("in %s = %s", name, base);
}

/* The names in a term with their units, each once: k: N/m, x': m/s */
static void list_names(const struct dimensions *w, const struct node *node, const char **list, bool *literal)
{
	const struct symbol *symbol = node->let ? node->let : node->symbol;
	const int looked_at = symbol ? 0 : node->kind == NODE_POWER ? 1 : node->children;
	for (int i = 0; i < looked_at && !(node->unit && node->counted); i++)
		list_names(w, node->child[i], list, literal);
	*literal = *literal || (node->kind == NODE_NUMBER && node->end.offset > node->start.offset);
	if (!symbol)
		return;
	struct dimension d = of_name(w, node);
	const char *name = state_text(symbol, node->component, node->primes), *entry;
	entry = d.kind == SILENT || d.parts ? format("%s: not known", name)
		: symbol->unit_written
			? format("%s: %s", name, unit_of_derivative(symbol->unit, node->primes)->text)
			: format("%s: %s", name, unit_text(&d));
	if (!strstr(format(", %s,", *list), format(", %s,", entry)))
		*list = format("%s%s%s", *list, **list ? ", " : "", entry);
}

static const char *text_of_term(const struct term *term)
{
	return term->text ? term->text : term->node ? text_between(term->node->start, term->node->end) : NULL;
}

/* Why the two terms are what they are */
static const char *names_note(const struct dimensions *w, const struct term *odd, const struct term *other)
{
	const char *list = "", *of_other = "";
	bool literal = false, ignored = false;
	if (odd->node)
		list_names(w, odd->node, &list, &literal);
	if (other->node)
		list_names(w, other->node, &of_other, &ignored);
	const char *text = text_of_term(other), *note = list;
	if (*of_other && text)
		note = format("%s%sof '%s' %s", note, *note ? "; " : "", text, of_other);
	if (literal)
		note = format("%s%sa number has no unit but one behind it, as in (3 \"N/m\")", note, *note ? "; " : "");
	return *note ? note : NULL;
}

static void report_term(struct dimensions *w, const struct group *group, const struct term *odd,
			const struct term *other)
{
	struct dimension a = dimension_resolved(w, &odd->dimension), b = dimension_resolved(w, &other->dimension);
	const char *text = text_of_term(odd), *by = text_of_term(other);
	if (has_failed(w, group->statement) || has_failed(w, odd->at.source->text + odd->at.offset))
		return;
	by = by && strcmp(by, "t") != 0 ? format(" by %s", by[0] == '"' ? by : format("'%s'", by)) : "";
	say_error(odd->at, names_note(w, odd, other), "%s is %s, and %s %s%s",
		  !text ? group->what : text[0] == '"' ? format("the unit %s", text) : format("'%s'", text),
		  dimension_text(&a), text ? group->what : "its value", dimension_text(&b), by);
}

/* ---- solving ---- */

/* d = 0 binds its last variable. */
static void bind_one(struct dimensions *w, const struct dimension *d)
{
	const struct part *last = &d->part[d->parts - 1];
	struct dimension rest = *d, solution = dimension_in(NULL);
	RATIONAL factor = ZERO;
	rest.parts--;
	mpq_inv(factor, last->factor);
	mpq_neg(factor, factor);
	add_dimension(w, &solution, &rest, factor);
	w->solution[last->variable] = solution;
}

/* Every variable in it is bound, and what binds it is known. */
static bool is_known(struct dimensions *w, const struct dimension *d)
{
	for (int i = 0; i < d->parts; i++) {
		struct dimension *solution = &w->solution[d->part[i].variable];
		if (!solution->base || !(solution->known || is_known(w, solution)))
			return false;
		solution->known = true;
	}
	return true;
}

static int count_known(struct dimensions *w, const struct group *group)
{
	int count = 0;
	for (int i = 0; i < group->terms; i++)
		count += is_known(w, &group->term[i].dimension);
	return count;
}

/* Of the known terms one that most others agree with, the first of such; where none is known the first */
static int reference_of(const struct group *group)
{
	int best = 0, most = 0;
	for (int i = 0; i < group->terms; i++) {
		const struct dimension *d = &group->term[i].dimension;
		int count = 0;
		for (int k = 0; k < group->terms && d->parts == 0; k++)
			count += group->term[k].dimension.parts == 0 &&
				 rationals_equal(UNIT_BASES, (const mpq_t *)d->base,
						 (const mpq_t *)group->term[k].dimension.base);
		if (count > most) {
			best = i;
			most = count;
		}
	}
	return best;
}

/* Known terms are compared first: nothing follows from a group that contradicts itself. */
static void solve_group(struct dimensions *w, struct group *group)
{
	for (int i = 0; i < group->terms; i++)
		group->term[i].dimension = dimension_resolved(w, &group->term[i].dimension);
	const struct term *reference = &group->term[reference_of(group)];
	group->done = true;
	for (int round = 0; round < 2; round++)
		for (int i = 0; i < group->terms; i++) {
			struct dimension d = dimension_difference(w, &group->term[i].dimension, &reference->dimension);
			if (d.parts == 0 && !is_number_dimension(&d)) {
				report_term(w, group, &group->term[i], reference);
				return;
			}
			if (d.parts > 0 && round == 1)
				bind_one(w, &d);
		}
}

static int inner_first(const void *left, const void *right)
{
	const struct group *a = left, *b = right;
	return a->depth != b->depth ? b->depth - a->depth : a->place - b->place;
}

/* Within a statement inner groups come before those that contain them. */
static void sort_groups(struct dimensions *w)
{
	for (int first = 0, last; first < w->groups; first = last) {
		for (last = first + 1; last < w->groups && w->group[last].statement == w->group[first].statement;)
			last++;
		qsort(w->group + first, (size_t)(last - first), sizeof *w->group, inner_first);
	}
}

static struct group *next_group(struct dimensions *w, int wanted, bool defines)
{
	for (int i = 0; i < w->groups; i++) {
		struct group *group = &w->group[i];
		if (!group->done && group->terms > 1 && (group->defines || !defines) && count_known(w, group) >= wanted)
			return group;
	}
	return NULL;
}

/* Names that are defined by what is known come first, then groups of which most is known. */
static void solve(struct dimensions *w)
{
	sort_groups(w);
	for (int wanted = 2; wanted >= 0;) {
		struct group *next = next_group(w, 1, true);
		next = next ? next : next_group(w, wanted, false);
		if (next)
			solve_group(w, next);
		wanted = next ? 2 : wanted - 1;
	}
}

static void check_assertion(struct dimensions *w, const struct assertion *a)
{
	const struct unit *unit = a->node->unit;
	const char *text = text_between(a->node->start, a->node->end);
	struct dimension in_unit = dimension_in((const mpq_t *)unit->base);
	struct dimension d = dimension_difference(w, &a->dimension, &in_unit);
	if (a->dimension.kind == GIVEN && is_number_dimension(&d))
		return;
	const char *note = format("if numbers are meant: (%s)*(1 \"%s\"); else without the unit, which changes no "
				  "value", text, unit->text);
	d = dimension_resolved(w, &a->dimension);
	if (a->dimension.kind != GIVEN || d.parts)
		say_error(unit->at, note, "'%s' has no unit that is known: is it given in \"%s\", or so many of it?",
			  text, unit->text);
	else
		say_error(unit->at, note, "'%s' is %s, and the unit \"%s\" %s", text, dimension_text(&d), unit->text,
			  dimension_text(&in_unit));
}

/* ---- the whole ---- */

static void open_variables(struct dimensions *w, struct spec *spec)
{
	w->first = ARRAY(int, spec->count.symbols + 1);
	for (const struct symbol *s = spec->first; s; s = s->next) {
		w->first[s->number] = w->variables;
		w->variables += count_variables(s);
	}
	w->solution = ARRAY(struct dimension, w->variables + 1);
	for (const struct symbol *s = spec->first; s; s = s->next)
		if (s->unit_written)
			w->solution[w->first[s->number]] = dimension_in((const mpq_t *)s->unit->base);
}

/* What is known of names without a unit, for those who show them */
static void keep_found(const struct dimensions *w, struct spec *spec)
{
	for (struct symbol *s = spec->first; s; s = s->next) {
		struct dimension d = of_variable(w->first[s->number]);
		d = dimension_resolved(w, &d);
		if (!s->unit_written && d.parts == 0 && count_variables(s) == 1 && s->kind != SYMBOL_PART)
			s->unit = unit_of_dimension((const mpq_t *)d.base);
	}
}

static void check_all(void *context)
{
	struct dimensions *w = context;
	add_equations(w);
	add_elements(w);
	add_energies(w);
	add_drawings(w);
	for (const struct symbol *s = w->spec->first; s; s = s->next)
		if (!s->broken)
			add_value(w, s);
	add_whens(w);
	add_requested(w);
	solve(w);
	for (int i = 0; i < w->assertions; i++)
		check_assertion(w, &w->assertion[i]);
}

void check_dimensions(struct spec *spec)
{
	struct dimensions w = { .spec = spec };
	if (diagnostics_errors())
		return;
	open_variables(&w, spec);
	if (statement_guard(check_all, &w))
		keep_found(&w, spec);
}

void adopt_units(struct spec *spec, const struct spec *given)
{
	for (struct symbol *s = spec->first; s; s = s->next) {
		const struct symbol *like = given->first;
		while (like && (like->kind != s->kind || strcmp(like->name, s->name) != 0))
			like = like->next;
		s->unit = like ? like->unit : NULL;
	}
	spec->units.written = given->units.written;
	spec->units.adopted = given->units.written;
}

void check_time(const struct node *node)
{
	struct dimension time = dimension_of_time();
	if (node->unit && !rationals_equal(UNIT_BASES, (const mpq_t *)node->unit->base, (const mpq_t *)time.base))
		error(node->unit->at, NULL, "the unit \"%s\" is no time", node->unit->text);
}
