/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Piecewise-linear equations of coordinates that have nothing to do with each other: each such part has its own
 * regions, so that their numbers add up where they would be multiplied, and crosses breakpoints at its own times. Parts
 * are told apart by what the equations read, in any region; loads and inputs are of all. Coordinates without
 * breakpoints are one part, whatever they read. */
#include "inner.h"
#include "model/building.h"
#include "model/contacts/friction.h"

#include <limits.h>

/* ---- which equations and coordinates go together: nodes as in blocks.c ---- */

static void join_form(const struct building *b, int *parent, bool *seen, int row, const struct form *form)
{
	for (const struct form_term **term = terms_within(form, seen); *term; term++)
		if ((*term)->basis.kind == BASIS_COORD)
			join_nodes(parent, row, b->model->n + (*term)->basis.index);
}

static int *components_of_equations(const struct building *b)
{
	int n = b->model->n, *parent = numbers_up_to(2 * n);
	for (int row = 0; row < n; row++) {
		SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
		for (int s = 0; s < b->model->system.segments; s++)
			join_form(b, parent, seen, row, b->segment_equations[s].residual[row].form);
	}
	return parent;
}

/* ---- the regions of each ---- */

struct parting {
	struct building *b;
	int *parent;
	struct switching **of;      /* per coordinate: of its component, at the first of it; NULL: at others */
};

static struct switching *regions_of_component(const struct parting *p, int coord)
{
	int n = p->b->model->n, rows = 0, *row = ARRAY(int, n);
	for (int i = 0; i < n; i++)
		if (root_of_node(p->parent, i) == root_of_node(p->parent, n + coord))
			row[rows++] = i;
	return regions_of_rows(p->b, rows, row);
}

static void find_components(struct parting *p)
{
	int n = p->b->model->n;
	for (int j = 0; j < n; j++) {
		bool first = !is_seen_before(n, p->parent, j);
		if (!first)
			p->of[j] = NULL;
		else if (!p->of[j])
			p->of[j] = regions_of_component(p, j);
	}
}

/* Two components become one, whose regions are still to be found. */
static void unite(struct parting *p, int coord, int other)
{
	join_nodes(p->parent, p->b->model->n + other, p->b->model->n + coord);
	p->of[coord] = p->of[other] = NULL;
}

/* Those that compare the same load or input with breakpoints pass them together. False: there are no such. */
static bool unite_sharing(struct parting *p)
{
	int n = p->b->model->n;
	for (int i = 0; i < n; i++)
		for (int j = i + 1; j < n; j++)
			if (p->of[i] && p->of[j] && share_function(p->of[i], p->of[j])) {
				unite(p, i, j);
				return true;
			}
	return false;
}

static void unite_linear(struct parting *p)
{
	int first = -1;
	for (int j = 0; j < p->b->model->n; j++) {
		if (!p->of[j] || p->of[j]->functions > 0)
			continue;
		if (first >= 0)
			unite(p, first, j);
		else
			first = j;
	}
}

/* ---- the whole of them ---- */

static int functions_of_parts(const struct switching *s)
{
	int count = 0;
	for (int p = 0; p < s->parts; p++)
		count += s->part[p].model->switching->functions;
	return count;
}

/* The next of all parts in the order in which they were met; *of: whose it is. next: per part, of it */
static int next_function(const struct switching *s, const int *next)
{
	int of = -1;
	for (int p = 0; p < s->parts; p++) {
		const struct switching *own = s->part[p].model->switching;
		if (next[p] == own->functions)
			continue;
		if (of < 0 || own->function[next[p]].met < s->part[of].model->switching->function[next[of]].met)
			of = p;
	}
	return of;
}

/* Numbers the switching functions of all parts, and the regions that they make together. */
static void number_switching_functions(struct switching *s)
{
	int *next = ARRAY(int, s->parts);
	long regions = 1;
	s->functions = functions_of_parts(s);
	s->function = ARRAY(struct switching_function, s->functions);
	for (int p = 0; p < s->parts; p++)
		s->part[p].function = ARRAY(int, s->part[p].model->switching->functions);
	for (int i = 0; i < s->functions; i++) {
		int of = next_function(s, next);
		const struct switching_function *e = &s->part[of].model->switching->function[next[of]];
		s->function[i] = *e;
		s->function[i].stride = (int)regions;
		s->part[of].function[next[of]++] = i;
		regions *= e->breaks + 1;
		if (regions > INT_MAX)
			error(e->node->at, "a scheme with a remainder, such as etdrk4, needs no regions",
			      "more regions of independent parts together than the limit of %d", INT_MAX);
	}
	s->regions = (int)regions;
}

/* NULL: all coordinates belong to one part */
static struct switching *regions_of_parts(struct building *b)
{
	size_t n = (size_t)b->model->n;
	struct parting p = { b, components_of_equations(b), ARRAY(struct switching *, n) };
	struct switching *s = NEW(struct switching);
	s->part = ARRAY(struct region_part, n);
	do
		find_components(&p);
	while (unite_sharing(&p));
	unite_linear(&p);
	find_components(&p);
	for (int linear = 0; linear < 2; linear++)      /* the linear part comes last */
		for (int j = 0; j < b->model->n; j++) {
			if (!p.of[j] || (p.of[j]->functions == 0) != linear)
				continue;
			struct region_part *part = &s->part[s->parts++];
			*part = (struct region_part){ .coord = j, .model = NEW(struct model) };
			part->model->switching = p.of[j];
		}
	if (s->parts < 2)
		return NULL;
	number_switching_functions(s);
	return s;
}

int share_of_region(const struct region_part *part, const struct switching *full, int region)
{
	const struct switching *s = part->model->switching;
	int share = 0;
	for (int i = 0; i < s->functions; i++)
		share += interval_of(s, region, i) * full->function[part->function[i]].stride;
	return share;
}

static void search(void *context)
{
	struct building *b = context;
	int n = b->model->n, *all = ARRAY(int, n);
	bool together = b->factor || b->model->relative || b->request->again.undivided || b->request->solution ||
			holds_friction(b) || b->model->contacts.impacts > 0 || b->spec->request.cached;
	struct switching *s = together ? NULL : regions_of_parts(b);
	for (int p = 0; s && p < s->parts; p++)         /* a number of a region is then no sum of those in a table */
		if (s->part[p].model->switching->cached)
			s = NULL;
	for (int i = 0; i < n; i++)
		all[i] = i;
	b->model->switching = s ? s : regions_of_rows(b, n, all);
}

void find_regions(struct building *b)
{
	statement_guard(search, b);
}

bool has_too_many_regions(struct building *b)
{
	if (!refusal_of(search, b))
		return false;
	b->model->switching = NULL;
	return b->crowded;
}

static void place_loads_of(struct building *b, const struct switching *s)
{
	for (int r = 0; r < s->regions; r++)
		for (int k = 0; k < s->rows && s->region[r].possible; k++)
			place_loads(b, s->region[r].residual[s->row[k]]);
	for (int r = 0; r < s->regions; r++) {
		const struct region *region = &s->region[r];
		for (int k = 0; k < region->holds; k++)
			place_loads(b, region->hold[k].form);
		for (int k = 0; k < region->releases; k++)
			place_loads(b, region->release[k].form);
		for (int k = 0; k < s->frictions; k++)
			if (region->carried[s->friction[k].atom->index])
				place_loads(b, region->carried[s->friction[k].atom->index]);
		for (int k = 0; k < s->sliders; k++)
			if (region->carried[s->slider[k].atom->index])
				place_loads(b, region->carried[s->slider[k].atom->index]);
	}
	for (int e = 0; e < s->functions; e++)
		for (int segment = 0; segment < s->segments; segment++)
			place_loads(b, form_in(&s->function[e], segment));
	place_impact_loads(b, s);
}

void place_region_loads(struct building *b)
{
	const struct switching *s = b->model->switching;
	for (int p = 0; p < s->parts; p++)
		place_loads_of(b, s->part[p].model->switching);
	if (!s->parts)
		place_loads_of(b, s);
}

/* ---- their systems ---- */

/* Of the whole model; the rows of others are 0 */
static struct linear system_in_region(struct building *b, const struct switching *s, int region)
{
	struct linear system = empty_system(b->model);
	system.segments = 1;
	for (int k = 0; k < s->rows; k++)
		fill_system(b, &system, s->row[k], s->region[region].residual[s->row[k]]);
	return system;
}

static int first_region(const struct switching *s)
{
	int r = 0;
	while (!s->region[r].possible)
		r++;
	return r;
}

static void find_inputs(struct region_part *part)
{
	const struct switching *s = part->model->switching;
	part->input = ARRAY(int, s->system->inputs);
	for (int i = 0; i < s->system->inputs; i++) {
		bool needed = false;
		for (int k = 0; k < 2 * s->systems; k++)
			needed = needed ||
				 !rationals_zero((size_t)s->system->n, s->system[k / 2].input[i].force[k % 2]);
		for (int e = 0; e < s->functions; e++)
			for (int k = 0; k < 2; k++)
				needed = needed || mpq_sgn(s->function[e].row->input[k][i]) != 0;
		if (needed)
			part->input[part->model->system.inputs++] = i;
	}
}

static void take_inputs(const struct region_part *part, struct linear *system)
{
	const struct input *all = system->input;
	system->inputs = part->model->system.inputs;
	system->input = ARRAY(struct input, system->inputs);
	for (int i = 0; i < system->inputs; i++)
		system->input[i] = all[part->input[i]];
}

static mpq_t *picked(const mpq_t *all, int count, const int *place)
{
	mpq_t *some = rationals(count);
	for (int i = 0; i < count; i++)
		mpq_set(some[i], all[place[i]]);
	return some;
}

/* The row over the part's own states and inputs */
static struct output *own_row(const struct region_part *part, const struct output *row)
{
	struct output *own = NEW(struct output);
	*own = *row;
	own->state = picked(row->state, part->model->system.states, part->state);
	for (int k = 0; k < 2; k++)
		own->input[k] = picked(row->input[k], part->model->system.inputs, part->input);
	return own;
}

static bool same_rows(const struct switching *s, int a, int b)
{
	bool same = true;
	for (int e = 0; e < s->functions && a != b; e++)
		same = same && mpq_equal(s->function[e].shift[a], s->function[e].shift[b]) &&
		       same_form(s->function[e].in[a], s->function[e].in[b]);
	return same;
}

/* Its index; apart: with no other's, though they are equal */
static int add_system(struct switching *s, const struct linear *system, int segment, bool apart)
{
	for (int i = 0; i < s->systems && !apart; i++)
		if (same_equations(&s->system[i], system, 0, system->n) && same_rows(s, s->system_segment[i], segment))
			return i;
	ENLARGE(s->system, (size_t)s->systems + 1);
	ENLARGE(s->system_segment, (size_t)s->systems + 1);
	s->system[s->systems] = *system;
	s->system_segment[s->systems] = segment;
	return s->systems++;
}

static void take_model(struct building *b, struct region_part *part, const struct block *block)
{
	const struct model *full = b->model;
	struct model *model = part->model;
	struct switching *s = model->switching;
	*model = *full;
	model->switching = s;
	model->written = model;
	model->n = block->system.n;
	model->system = block->system;
	model->system.inputs = 0;               /* find_inputs counts them */
	model->outputs = model->remainder.force_columns = model->schedule.operators = 0;
	model->names.coord = ARRAY(const char *, model->n);
	model->names.state = ARRAY(const char *, model->system.states);
	for (int i = 0; i < model->n; i++)
		model->names.coord[i] = full->names.coord[block->coord[i]];
	for (int i = 0; i < model->system.states; i++)
		model->names.state[i] = full->names.state[block->state[i]];
	part->state = block->state;
}

static void build_part(struct building *b, int *parent, struct region_part *part)
{
	struct switching *s = part->model->switching;
	struct block block = block_at(&b->model->system, parent, part->coord);
	take_model(b, part, &block);
	for (int r = 0; r < s->regions; r++) {
		if (!s->region[r].possible)
			continue;
		struct linear full = system_in_region(b, s, r);
		struct block own = block_at(&full, parent, part->coord);
		s->region[r].system = add_system(s, &own.system, segment_of_region(s, r), false);
	}
	remove_idle_breaks(s);
	for (int e = 0; e < s->functions; e++)
		s->function[e].row = row_of_function(b, s, &s->function[e]);
	find_inputs(part);
	for (int e = 0; e < s->functions; e++)
		s->function[e].row = own_row(part, s->function[e].row);
	for (int k = 0; k < s->systems; k++)
		take_inputs(part, &s->system[k]);
	part->model->system = s->system[0];
}

static void fill_first_regions(struct building *b, struct switching *s)
{
	s->systems = 1;
	s->system = NEW(struct linear);
	*s->system = empty_system(b->model);
	s->system->segments = 1;
	for (int p = 0; p < s->parts; p++) {
		const struct switching *own = s->part[p].model->switching;
		int first = first_region(own);
		for (int k = 0; k < own->rows; k++)
			fill_system(b, s->system, own->row[k], own->region[first].residual[own->row[k]]);
	}
}

/* The parts as a graph: rows and coordinates of each together */
static int *graph_of_parts(const struct building *b, const struct switching *s)
{
	int *parent = components_of_equations(b), n = b->model->n;
	for (int p = 0; p < s->parts; p++) {
		const struct switching *own = s->part[p].model->switching;
		for (int k = 0; k < own->rows; k++)
			join_nodes(parent, own->row[k], n + s->part[p].coord);
	}
	return parent;
}

static void build_all_parts(struct building *b, struct switching *s)
{
	int *parent = graph_of_parts(b, s);
	for (int p = 0; p < s->parts; p++)
		build_part(b, parent, &s->part[p]);
	fill_first_regions(b, s);
	number_switching_functions(s);
}

static void build_full(struct building *b, struct switching *s)
{
	for (int r = 0; r < s->regions; r++) {
		if (!s->region[r].possible)
			continue;
		struct linear system = system_in_region(b, s, r);
		s->region[r].system = add_system(s, &system, segment_of_region(s, r), b->factor != NULL);
	}
	if (!b->factor)                         /* what is idle at these values may act at others */
		remove_idle_breaks(s);
	if (has_events(s) || b->factor)         /* highest derivatives of outputs follow from tunable params, too */
		build_friction(b, s);
	build_impact_rows(b, s);
	if (s->cached)
		check_sum(b, s);
}

void build_regions(struct building *b)
{
	struct switching *s = b->model->switching;
	(s->parts ? build_all_parts : build_full)(b, s);
	for (int e = 0; e < s->functions; e++)
		s->function[e].row = row_of_function(b, s, &s->function[e]);
}
