/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a model follows from tunable params: its equations, outputs and frequencies of loads; of regions, the rows that
 * they have. A param of regions that can be a held input, a gap or a force, stays one (params.c); others are factors,
 * numbers of the model. It is looked at elsewhere (elsewhere.c), regions close to the spec's values, where breakpoints
 * keep their order and factors their sign: what decided on the way which region is which has to keep its sign on the
 * target. */
#include "inner.h"
#include "model/capability.h"
#include "model/contacts/contacts.h"
#include "model/reads.h"
#include "model/linear/modal_truncation.h"

#include <string.h>

/* ---- the model at other values ---- */

static bool same_shape(const struct model *model, const struct model *other)
{
	const struct linear *a = &model->system, *b = &other->system;
	bool same = a->states == b->states && a->inputs == b->inputs && same_loads(a, b, true);
	for (int i = 0; i < a->n && same; i++)
		same = a->velocity[i] == b->velocity[i];
	return same;
}

static bool same_loads_there(const struct model *model, const struct model *other)
{
	return same_loads(&model->system, &other->system, false);
}

static bool same_region(const struct region *a, const struct region *b)
{
	bool same = a->possible == b->possible && a->holds == b->holds && a->releases == b->releases &&
		    (!a->possible || a->system == b->system);
	for (int k = 0; k < a->holds && same; k++)
		same = a->hold[k].state == b->hold[k].state;
	return same;
}

static bool same_impact(const struct impact *full, const struct impact *other, int segment)
{
	const struct impact_law *a = &full->in[segment], *b = &other->in[segment];
	bool same = full->bounces == other->bounces && a->jumps == b->jumps && a->upward == b->upward &&
		    a->function == b->function;
	for (int k = 0; k < a->jumps && same; k++)
		same = a->jump[k].state == b->jump[k].state;
	return same;
}

static bool same_regions(const struct model *model, const struct model *other)
{
	const struct switching *a = model->switching, *b = other->switching;
	if (!b || a->functions != b->functions || a->segments != b->segments || a->regions != b->regions ||
	    a->systems != b->systems || a->impacts != b->impacts || a->frictions != b->frictions)
		return false;
	bool same = true;
	for (int e = 0; e < a->functions; e++)
		same = same && a->function[e].breaks == b->function[e].breaks;
	for (int e = 0; e < a->functions && same; e++)
		for (int k = 1; k < a->function[e].breaks; k++)
			same = same && is_stick(&a->function[e], k) == is_stick(&b->function[e], k);
	for (int r = 0; r < a->regions && same; r++)
		same = same_region(&a->region[r], &b->region[r]);
	for (int i = 0; i < a->segments * a->impacts && same; i++)
		same = same_impact(&a->impact[i % a->impacts], &b->impact[i % a->impacts], i / a->impacts);
	return same;
}

/* Formulas of outputs read the instance's own params; what friction without mass bears beside a damper has numbers. */
static bool same_outputs(const struct model *model, const struct model *other)
{
	bool same = true;
	for (int i = 0; i < model->outputs && same; i++) {
		const struct form *a = model->output[i].left, *b = other->output[i].left;
		if (model->output[i].reads_slider_force && a)
			same = b && strcmp(form_text(model, a), form_text(other, b)) == 0;
	}
	return same;
}

static const struct difference of_linear[] = {
	{ same_reduction, "--reduce would leave other states",
	  "what is left out, and the sums that become states, have to be the same for all values; without --reduce all "
	  "states are kept" },
	{ same_shape, "the model has other loads",
	  "a load is there only where its factor is not 0; its phase, growth and changes in time are fixed" }
};
static const struct difference of_regions[] = {
	{ same_loads_there, "the model has other loads",
	  "a load is there only where its factor is not 0; its frequency, phase and growth are fixed" },
	{ same_regions, "the model has other regions",
	  "what is equal at the spec's values has to stay equal: breakpoints, factors, forces" },
	{ same_outputs, "an output of friction would be another formula",
	  "what it holds without mass is no output then; a small mass slides with its own inertia" }
};

/* Their rows are those of the first. */
static mpq_t *read_rows(struct elsewhere *s, const struct model *model)
{
	struct tuning *t = s->tuning;
	struct listing l = list_rows(model, &t->x, model->system.segments);
	if (s->places == 0) {
		t->rows = l.rows;
		t->row = l.row;
		s->entries = (ptrdiff_t)l.rows * t->x.size;
	}
	if (l.rows != t->rows)
		report_difference(s, &of_regions[1]);
	return l.entry;
}

/* ---- which rows change, which systems are equal ---- */

static ptrdiff_t index_of(const struct elsewhere *s, int row, int column)
{
	return (ptrdiff_t)row * s->tuning->x.size + column;
}

static bool row_changes(const struct elsewhere *s, int row)
{
	bool changes = false;
	for (int j = 0; j < s->tuning->x.size && !changes; j++)
		changes = !entry_stays(s, index_of(s, row, j));
	return changes;
}

static bool entries_agree(const struct elsewhere *s, ptrdiff_t a, ptrdiff_t b)
{
	bool same = true;
	for (int i = 0; i < s->places && same; i++)
		same = mpq_equal(entry_seen(s, i, a), entry_seen(s, i, b));
	return same;
}

/* Their rows come first, x.size of each. */
static bool systems_agree(const struct elsewhere *s, int a, int b)
{
	const struct switching *w = s->model->switching;
	const ptrdiff_t cells = (ptrdiff_t)s->tuning->x.size * s->tuning->x.size;
	bool same = w->system_segment[a] == w->system_segment[b];
	for (ptrdiff_t j = 0; j < cells && same; j++)
		same = entries_agree(s, a * cells + j, b * cells + j);
	return same;
}

/* Systems that are equal for all values are one. */
static void merge_systems(struct elsewhere *s)
{
	struct switching *w = s->model->switching;
	struct retuned_row *row = s->tuning->row;
	int kept = 0, *number = ARRAY(int, w->systems), *merged = ARRAY(int, w->systems);
	for (int k = 0; k < w->systems; k++) {
		merged[k] = k;
		for (int i = 0; i < k && merged[k] == k; i++)
			if (merged[i] == i && systems_agree(s, i, k))
				merged[k] = i;
		number[k] = merged[k] == k ? kept : number[merged[k]];
		if (merged[k] != k)
			continue;
		w->system[kept] = w->system[k];
		w->system_segment[kept++] = w->system_segment[k];
	}
	for (int r = 0; r < w->regions; r++)
		if (w->region[r].possible)
			w->region[r].system = number[w->region[r].system];
	for (int i = 0; i < s->tuning->rows; i++)
		if (row[i].kind == RETUNED_SYSTEM)
			row[i].of = merged[row[i].of] == row[i].of ? number[row[i].of] : -1;
	w->systems = kept;
}

/* ---- entries ---- */

static void take_row(struct elsewhere *s, struct tuned_equations *all, int row)
{
	const int to = all->rows++;
	for (int j = 0; j < all->columns; j++)
		add_tuned_entry(s, index_of(s, row, j), all, to, j);
}

static void place_row(struct elsewhere *s, int row)
{
	struct tuning *t = s->tuning;
	t->row[row].place = t->all.rows;
	t->row[row].positive = mpq_sgn(entry_seen(s, 0, index_of(s, row, 0))) > 0;
	take_row(s, &t->all, row);
}

/* All rows or none; of a linear model they are always there */
static void take_system(struct elsewhere *s, int system)
{
	struct tuning *t = s->tuning;
	struct tuned_equations *all = &t->system[system];
	bool changes = !s->model->switching;
	for (int i = 0; i < t->rows && !changes; i++)
		changes = t->row[i].kind == RETUNED_SYSTEM && t->row[i].of == system && row_changes(s, i);
	all->columns = t->x.size;
	for (int i = 0; i < t->rows && changes; i++)
		if (t->row[i].kind == RETUNED_SYSTEM && t->row[i].of == system)
			take_row(s, all, i);
}

static int systems_of(const struct elsewhere *s)
{
	return s->model->switching ? s->model->switching->systems : 1;
}

static void take_rows(struct elsewhere *s)
{
	struct tuning *t = s->tuning;
	t->all.columns = t->x.size;
	t->system = ARRAY(struct tuned_equations, (size_t)systems_of(s));
	for (int k = 0; k < systems_of(s); k++)
		take_system(s, k);
	for (int i = 0; i < t->rows; i++)
		if (t->row[i].kind != RETUNED_SYSTEM && row_changes(s, i))
			place_row(s, i);
}

/* Per number of the record the given params that it follows from, a bit each */
static unsigned *params_of_record(const struct elsewhere *s)
{
	const struct tuning *t = s->tuning;
	unsigned *params = ARRAY(unsigned, (size_t)t->numbers);
	for (int i = 0; i < t->numbers; i++) {
		const struct traced *n = &t->number[i];
		if (n->op == TRACED_GIVEN)
			params[i] = params_of_tunable(s->model->spec, n->a.number);
		else
			params[i] = (n->a.number < 0 ? 0 : params[n->a.number]) |
				    (n->b.number < 0 ? 0 : params[n->b.number]);
	}
	return params;
}

static void mark_part(bool *behind, const struct traced_part *part)
{
	if (part->number >= 0)
		behind[part->number] = true;
}

bool *numbers_behind(const struct tuning *t, int count, const struct tuned_equations *const *list)
{
	bool *behind = ARRAY(bool, (size_t)t->numbers + 1);
	for (int k = 0; k < count; k++)
		for (int i = 0; i < list[k]->entries; i++)
			mark_part(behind, &list[k]->entry[i].value);
	for (int i = t->numbers - 1; i >= 0; i--)
		if (behind[i] && t->number[i].op != TRACED_GIVEN) {
			mark_part(behind, &t->number[i].a);
			mark_part(behind, &t->number[i].b);
		}
	return behind;
}

int operations_behind(const struct tuning *t, int count, const struct tuned_equations *const *list)
{
	SCRATCH bool *behind = numbers_behind(t, count, list);
	int operations = 0;
	for (int i = 0; i < t->numbers; i++)
		operations += behind[i] && t->number[i].op != TRACED_GIVEN;
	return operations;
}

static void mark_params(struct tuned_equations *all, const unsigned *params)
{
	for (struct tuned_entry *entry = all->entry; entry < all->entry + all->entries; entry++)
		entry->params = entry->value.number < 0 ? 0 : params[entry->value.number];
}

static void keep_record(struct elsewhere *s)
{
	struct tuning *t = s->tuning;
	t->number = trace_record(&t->numbers);
	SCRATCH unsigned *params = params_of_record(s);
	mark_params(&t->all, params);
	for (int k = 0; k < systems_of(s); k++)
		mark_params(&t->system[k], params);
}

static void mark_acting(struct elsewhere *s)
{
	struct tuning *t = s->tuning;
	t->acts = ARRAY(bool, (size_t)(t->all.rows * t->x.size));
	for (int i = 0; i < t->rows; i++)
		for (int j = 0; j < t->x.size && t->row[i].place >= 0; j++)
			t->acts[t->row[i].place * t->x.size + j] = mpq_sgn(entry_seen(s, 0, index_of(s, i, j))) != 0;
}

struct tuned_entry tuned_frequency(const struct tuning *t, int load)
{
	const int at = t->x.load[load];
	const struct tuned_entry *entry = t->system->entry, *end = entry + t->system->entries;
	while (entry < end && (entry->row != at + 1 || entry->column != at))
		entry++;
	return entry < end ? *entry : (struct tuned_entry){ 0 };
}

static void number_rows(struct elsewhere *s)
{
	struct tuning *t = s->tuning;
	t->output = ARRAY(int, s->model->outputs);
	t->frequency = ARRAY(bool, s->model->system.loads);
	for (int i = 0; i < s->model->outputs; i++) {
		t->output[i] = retuned_place(t, RETUNED_OUTPUT, 0, i);
		t->outputs += t->output[i] >= 0;
	}
	for (int i = 0; i < s->model->system.loads; i++) {
		t->frequency[i] = oscillates(s->model->system.load[i].forcing) && tuned_frequency(t, i).params != 0;
		t->frequencies += t->frequency[i];
	}
}

/* ---- what is refused ---- */

static void check_regions(const struct model *model)
{
	check_tuned(model);
	refuse(CAN_TUNABLE, model, model->spec->tuned.tunable[0].at);
}

static void check_linear(const struct model *model)
{
	refuse(CAN_TUNABLE, model, model->spec->tuned.tunable[0].at);
	for (int i = 0; i < model->outputs; i++) {
		const struct node *name = model->output[i].left ? first_tuned(model->output[i].value) : NULL;
		if (name)
			error(name->at, "read the states, and multiply on the target",
			      "'%s' is tunable, or made of what is, and output '%s' is not linear", name->symbol->name,
			      model->output[i].name);
	}
	for (int k = 0; model->equations.highest && k < model->n; k++)
		if (model->equations.highest[k])
			error(model->equations.highest[k]->value->start,
			      "an output that is linear may: give the derivative one of its own",
			      "output '%s' is not linear and reads a derivative that tunable params change",
			      model->equations.highest[k]->name);
	check_tuned(model);
}

/* An instance has A and e^{A d} of each */
static void check_size(const struct tuning *t, int systems)
{
	const int numbers = 2 * systems * t->x.size * t->x.size;
	if (numbers > LIMIT_TUNED_NUMBERS)
		error(t->param[0].at, "fewer breakpoints, or gaps and forces alone",
		      "tunable params of regions are built for up to %d numbers of their matrices in an instance: "
		      "%d systems of %d take %d",
		      LIMIT_TUNED_NUMBERS, systems, t->x.size, numbers);
}

/* ---- all of them ---- */

static struct layout columns_of(const struct model *model)
{
	bool *all = ARRAY(bool, model->system.loads + 1);
	for (int l = 0; l < model->system.loads; l++)
		all[l] = true;
	return model->switching ? layout_with(&model->system, 0, all) : layout_of_columns(&model->system);
}

static void find(void *context)
{
	struct elsewhere *s = context;
	const struct switching *regions = s->model->switching;
	(regions ? check_regions : check_linear)(s->model);
	s->tuning->x = columns_of(s->model);
	look_elsewhere(s);
	s->tuning->other = s->other;
	if (regions) {
		merge_systems(s);
		check_size(s->tuning, regions->systems);
	}
	take_rows(s);
	keep_record(s);
	mark_acting(s);
	if (!regions)
		number_rows(s);
}

struct model *find_tuning(struct model *model, const struct request *request)
{
	if (model->spec->tuned.count == 0)
		return model;
	struct tuning *t = list_tunables(model);
	struct elsewhere s = { .model = model, .request = request, .tuning = t, .factor = model->params.factor,
			       .near = model->params.factor ? t->nominal : NULL, .read = read_rows };
	s.difference = model->params.factor ? of_regions : of_linear;
	s.differences = model->params.factor ? sizeof of_regions / sizeof *of_regions
					     : sizeof of_linear / sizeof *of_linear;
	if (model->params.kept) {
		model->params.held = t;
		model->params.retuned = model->params.factor ? t : NULL;
	} else {
		model->params.tuning = t;
	}
	if ((model->params.factor || !model->params.kept) && !statement_guard(find, &s))
		return NULL;
	warn_of_unread(model);
	return model;
}

int retuned_place(const struct tuning *t, enum retuned_kind kind, int of, int index)
{
	for (int i = 0; i < t->rows; i++)
		if (t->row[i].kind == kind && t->row[i].of == of && t->row[i].index == index)
			return t->row[i].place;
	return -1;
}
