/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tunable params that change the matrices of regions: stiffness, damping, mass, restitution. What a held input can be,
 * a gap or a force, stays one (params.c); the others are factors, numbers of the model. It is looked at close to the
 * spec's values (elsewhere.c), where breakpoints keep their order and factors their sign. What decided on the way which
 * region is which has to keep its sign on the target. */
#include "model/model.h"

#include <string.h>

/* ---- the model at other values ---- */

struct search {
	struct elsewhere at;        /* entries: rows over x */
	struct model *model;
	struct retuned *r;
	struct tuning *t;
	struct listing own;         /* of the spec's values, without signs */
	int *merged;                /* per system: the first that is equal for all values */
};

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

static bool same_impact(const struct impact *whole, const struct impact *other, int segment)
{
	const struct strike *a = &whole->in[segment], *b = &other->in[segment];
	bool same = whole->bounces == other->bounces && a->jumps == b->jumps && a->upward == b->upward &&
		    a->expression == b->expression;
	for (int k = 0; k < a->jumps && same; k++)
		same = a->jump[k].state == b->jump[k].state;
	return same;
}

static bool same_regions(const struct model *model, const struct model *other)
{
	const struct switching *a = model->switching, *b = other->switching;
	if (!b || a->expressions != b->expressions || a->segments != b->segments || a->regions != b->regions ||
	    a->systems != b->systems || a->impacts != b->impacts || a->frictions != b->frictions)
		return false;
	bool same = true;
	for (int e = 0; e < a->expressions; e++)
		same = same && a->expression[e].breaks == b->expression[e].breaks;
	for (int e = 0; e < a->expressions && same; e++)
		for (int k = 1; k < a->expression[e].breaks; k++)
			same = same && is_stick(&a->expression[e], k) == is_stick(&b->expression[e], k);
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
		if (model->output[i].bears && a)
			same = b && strcmp(form_text(model, a), form_text(other, b)) == 0;
	}
	return same;
}

static const struct difference difference[] = {
	{ same_loads_there, "the model has other loads",
	  "a load is there only where its factor is not 0; its frequency, phase and growth are fixed" },
	{ same_regions, "the model has other regions",
	  "what is equal at the spec's values has to stay equal: breakpoints, factors, forces" },
	{ same_outputs, "an output of friction would be another formula",
	  "what it holds without mass is no output then; a small mass slides with its own inertia" }
};

/* Their rows are those of the first. */
static mpq_t *read_rows(struct elsewhere *at, const struct model *model)
{
	struct search *s = (struct search *)at;
	struct listing l = list_rows(model, &s->t->x, true);
	if (at->points == 0) {
		s->r->rows = l.rows;
		s->r->row = l.row;
		at->entries = (ptrdiff_t)l.rows * s->t->x.size;
	}
	if (l.rows != s->r->rows)
		tell_difference(at, &difference[1]);
	return l.entry;
}

/* ---- which rows change, which systems are equal ---- */

static ptrdiff_t index_of(const struct search *s, int row, int column)
{
	return (ptrdiff_t)row * s->t->x.size + column;
}

static bool row_changes(const struct search *s, int row)
{
	bool changes = false;
	for (int j = 0; j < s->t->x.size && !changes; j++)
		changes = !entry_stays(&s->at, index_of(s, row, j));
	return changes;
}

static bool entries_agree(const struct search *s, ptrdiff_t a, ptrdiff_t b)
{
	bool same = mpq_equal(s->own.entry[a], s->own.entry[b]);
	for (int i = 0; i < s->at.points && same; i++)
		same = mpq_equal(entry_seen(&s->at, i, a), entry_seen(&s->at, i, b));
	return same;
}

static bool systems_agree(const struct search *s, int a, int b)
{
	const struct switching *w = s->model->switching;
	const int n = s->model->n, size = s->t->x.size;
	bool same = w->system_segment[a] == w->system_segment[b];
	for (int j = 0; j < n * size && same; j++)
		same = entries_agree(s, index_of(s, a * n, j), index_of(s, b * n, j));
	return same;
}

/* Systems come first among the rows, n of each. */
static void merge_systems(struct search *s)
{
	struct switching *w = s->model->switching;
	int kept = 0, *number = ARRAY(int, w->systems);
	s->merged = ARRAY(int, w->systems);
	for (int k = 0; k < w->systems; k++) {
		s->merged[k] = k;
		for (int i = 0; i < k && s->merged[k] == k; i++)
			if (s->merged[i] == i && systems_agree(s, i, k))
				s->merged[k] = i;
		number[k] = s->merged[k] == k ? kept : number[s->merged[k]];
		if (s->merged[k] != k)
			continue;
		w->system[kept] = w->system[k];
		w->system_segment[kept++] = w->system_segment[k];
	}
	for (int r = 0; r < w->regions; r++)
		if (w->region[r].possible)
			w->region[r].system = number[w->region[r].system];
	for (int i = 0; i < s->own.rows; i++)
		if (s->r->row[i].kind <= RETUNED_W)
			s->r->row[i].of = s->merged[s->r->row[i].of] == s->r->row[i].of
						  ? number[s->r->row[i].of]
						  : -1;
	w->systems = kept;
}

/* ---- terms ---- */

/* Row `row` of the numbers as row `to` from column `from` on, up to `columns` of them */
static void fit_row(struct search *s, struct tuned_equations *all, int row, int to, int from, int columns)
{
	for (int j = 0; j < columns; j++)
		if (!fit_entry(&s->at, index_of(s, row, j), all, to, from + j))
			refuse_fit(&s->at, "regions", "only masses in equations may be sums");
}

static bool fits(struct search *s, int row)
{
	bool fit = true;
	for (int j = 0; j < s->t->x.size && fit; j++)
		fit = fits_entry(&s->at, index_of(s, row, j));
	return fit;
}

/* Is the row one of a system: its slopes, and what reads them? */
static bool is_of_system(const struct search *s, int row, int system)
{
	const struct retuned_row *r = &s->r->row[row];
	if (r->kind == RETUNED_SLOPE)
		return r->of == system;
	return (r->kind == RETUNED_RELEASE || r->kind == RETUNED_GRIP) &&
	       s->model->switching->region[r->of].system == system;
}

/* Slopes have theirs elsewhere; of others they follow */
static int row_apart(const struct search *s, int row, bool W)
{
	const struct retuned_row *of = &s->r->row[row];
	if (of->kind != RETUNED_SLOPE)
		return row + (W ? 1 : 2);
	int i = 0;
	while (s->r->row[i].kind != (W ? RETUNED_W : RETUNED_R) || s->r->row[i].of != of->of ||
	       s->r->row[i].index != of->index)
		i++;
	return i;
}

static struct tuned_equations *new_block(struct search *s)
{
	struct retuned_block *block = MORE(s->r->block, s->r->blocks);
	*block = (struct retuned_block){ { .columns = s->t->x.size, .solves = true }, s->t->all.rows };
	return &block->all;
}

/* The next of its rows, which is that of the whole */
static int add_row(struct search *s, struct tuned_equations *all)
{
	all->rows++;
	return s->t->all.rows++;
}

/* W a = R x, and what reads a: b - F a = G x */
static void add_block(struct search *s, int system)
{
	const int n = s->model->n, size = s->t->x.size;
	struct tuned_equations *all = new_block(s);
	for (int i = 0; i < s->r->rows; i++) {
		struct retuned_row *row = &s->r->row[i];
		if (!is_of_system(s, i, system))
			continue;
		bool slope = row->kind == RETUNED_SLOPE;
		fit_row(s, all, row_apart(s, i, false), all->rows, 0, size);
		fit_row(s, all, row_apart(s, i, true), all->rows, size, n);
		if (!slope)
			add_tuned_unit(all, all->rows, size + all->rows);
		row->place = add_row(s, all);
	}
}

static bool is_of_jumps(enum retuned_kind kind)
{
	return kind == RETUNED_JUMP || kind == RETUNED_STILL || kind == RETUNED_BACK;
}

/* Of a stop's impact: its answer, a sum of parts that masses divide, divides them. */
static bool add_divided(struct search *s, int row)
{
	struct retuned_row *r = &s->r->row[row];
	int answer = row;
	if (!is_of_jumps(r->kind) || fits(s, row))
		return false;
	while (s->r->row[answer].kind != RETUNED_ANSWER || s->r->row[answer].of != r->of)
		answer--;
	struct tuned_equations *all = new_block(s);
	r->place = add_row(s, all);
	fit_row(s, all, row + 1, 0, 0, s->t->x.size);
	fit_row(s, all, answer, 0, s->t->x.size, 1);
	return true;
}

static void place_row(struct search *s, int row)
{
	if (add_divided(s, row))
		return;
	struct retuned_row *r = &s->r->row[row];
	r->place = s->t->all.rows++;
	r->positive = mpq_sgn(entry_seen(&s->at, 0, index_of(s, row, 0))) > 0;
	fit_row(s, &s->t->all, row, r->place, 0, s->t->x.size);
}

/* All rows of a system or none */
static void fit_system(struct search *s, int system)
{
	bool changes = false, direct = true;
	for (int i = 0; i < s->r->rows; i++)
		if (is_of_system(s, i, system))
			changes = changes || row_changes(s, i);
	for (int i = 0; i < s->r->rows && changes; i++)
		if (is_of_system(s, i, system))
			direct = direct && fits(s, i);
	if (!direct) {
		add_block(s, system);
		return;
	}
	for (int i = 0; i < s->r->rows && changes; i++)
		if (is_of_system(s, i, system))
			place_row(s, i);
}

static void fit_rows(struct search *s)
{
	for (int k = 0; k < s->model->switching->systems; k++)
		fit_system(s, k);
	for (int i = 0; i < s->r->rows; i++) {
		enum retuned_kind kind = s->r->row[i].kind;
		bool apart = kind <= RETUNED_W || kind == RETUNED_TIMES || kind == RETUNED_ANSWER ||
			     (kind >= RETUNED_RELEASE && kind <= RETUNED_GRIP_W);
		if (!apart && row_changes(s, i))
			place_row(s, i);
	}
}

/* ---- what is refused ---- */

static void check_outputs(const struct model *model)
{
	for (int i = 0; i < model->outputs; i++) {
		const struct output *output = &model->output[i];
		const struct form *form = output->form ? output->form : output->left;
		struct reads reads = reads_of(model, form != NULL, &form);
		for (int k = 0; k < model->n; k++)
			if (reads.highest[k])
				error(output->value->start, "the program has the masses and forces to divide",
				      "output '%s' reads a highest derivative, which tunable params change",
				      output->name);
	}
}

static void check_model(const struct model *model)
{
	const struct spec *spec = model->spec;
	check_tuned(model, true);
	check_outputs(model);
	if (model->switching->sliders > 0)
		error(spec->tunable[0].at, "a small mass slides with its own inertia",
		      "tunable params beside what slides without mass are not built yet");
	if (model->system.states > LIMIT_UNROLLED_STATES)
		error(spec->tunable[0].at, "gaps and forces alone may be tunable with any number of states",
		      "tunable params of regions are built for up to %d states: the model has %d",
		      LIMIT_UNROLLED_STATES, model->system.states);
}

/* An instance has A and e^{A d} of each */
static void check_size(const struct search *s)
{
	int numbers = 2 * s->model->switching->systems * s->t->x.size * s->t->x.size;
	if (numbers > LIMIT_TUNED_NUMBERS)
		error(s->t->param[0].at, "fewer breakpoints, or gaps and forces alone",
		      "tunable params of regions are built for up to %d numbers of their matrices in an instance: "
		      "%d systems of %d take %d",
		      LIMIT_TUNED_NUMBERS, s->model->switching->systems, s->t->x.size, numbers);
}

static void find(void *context)
{
	struct search *s = context;
	check_model(s->model);
	bool *all = ARRAY(bool, s->model->system.loads + 1);
	for (int l = 0; l < s->model->system.loads; l++)
		all[l] = true;
	s->t->x = layout_with(&s->model->system, 0, all);
	s->t->all.columns = s->t->x.size;
	s->own = list_rows(s->model, &s->t->x, false);
	look_elsewhere(&s->at);
	s->r->other = s->at.other;
	merge_systems(s);
	check_size(s);
	fit_rows(s);
	if (!s->model->relative)
		warn_of_idle(&s->at);
}

/* model->retuned; false: it was said why not */
static bool find_retuning(struct model *model, const struct request *request)
{
	struct retuned *r = NEW(struct retuned);
	struct tuning *t = NEW(struct tuning);
	struct search s = { .model = model, .r = r, .t = t };
	*t = *model->held;
	s.at = (struct elsewhere){ .model = model, .request = request, .tuning = t, .factor = model->factor,
				   .near = t->nominal, .difference = difference,
				   .differences = sizeof difference / sizeof *difference, .read = read_rows };
	r->factor = model->factor;
	r->tuning = t;
	model->retuned = r;
	return statement_guard(find, &s);
}

int retuned_place(const struct retuned *r, enum retuned_kind kind, int of, int index)
{
	for (int i = 0; i < r->rows; i++)
		if (r->row[i].kind == kind && r->row[i].of == of && r->row[i].index == index)
			return r->row[i].place;
	return -1;
}

/* What is solved reads all that any of its equations reads. */
bool retuned_reads(const struct retuned *r, int place, int column)
{
	const struct tuned_equations *all = &r->tuning->all;
	bool reads = false;
	for (int b = 0; b < r->blocks; b++)
		if (place >= r->block[b].place && place < r->block[b].place + r->block[b].all.rows)
			all = &r->block[b].all;
	for (const struct tuned_term *term = all->term; term < all->term + all->terms; term++)
		reads = reads || (term->column == column && (all->solves || term->row == place));
	return reads;
}

bool find_all_tuning(struct model *model, const struct request *request)
{
	return find_tuning(model, request) && (!model->factor || find_retuning(model, request));
}
