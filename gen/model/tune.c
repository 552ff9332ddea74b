/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How the equations follow from tunable params: rows of them, of outputs and of loads' frequencies, as entries of a
 * model that is looked at elsewhere (elsewhere.c). */
#include "model/model.h"

/* ---- what cannot be recomputed ---- */

static void check_model(const struct model *model)
{
	check_tuned(model, false);
	for (int i = 0; i < model->outputs; i++) {
		const struct node *name = model->output[i].left ? first_tuned(model->output[i].value) : NULL;
		if (name)
			error(name->at, "read the states, and multiply on the target",
			      "'%s' is tunable, or made of what is, and output '%s' is not linear", name->symbol->name,
			      model->output[i].name);
	}
	for (int k = 0; model->highest && k < model->n; k++)
		if (model->highest[k])
			error(model->highest[k]->value->start,
			      "an output that is linear may: give the derivative one of its own",
			      "output '%s' is not linear and reads a derivative that tunable params change",
			      model->highest[k]->name);
}

static void check_kind(const struct model *model)
{
	struct place at = model->spec->tunable[0].at;
	if (scheme_row(model->scheme)->holds_coupling)
		error(at, "tunable params are for scheme exact, and for what a scheme leaves over",
		      "scheme %s cannot be retuned", scheme_name(model->scheme));
}

/* ---- the model at other values ---- */

static bool same_shape(const struct model *model, const struct model *other)
{
	const struct linear *a = &model->system, *b = &other->system;
	bool same = a->states == b->states && a->inputs == b->inputs && same_loads(a, b, true);
	for (int i = 0; i < a->n && same; i++)
		same = a->velocity[i] == b->velocity[i];
	return same;
}

/* Entries of one point: W^-1 R of all rows, then [R | W], then the frequencies of the loads. Rows: the coordinates,
 * then the outputs. */
static int all_rows(const struct elsewhere *s)
{
	return s->model->n + s->model->outputs;
}

static int all_columns(const struct elsewhere *s)
{
	return s->tuning->x.size + all_rows(s);
}

static ptrdiff_t solved_index(const struct elsewhere *s, int row, int column)
{
	return (ptrdiff_t)row * s->tuning->x.size + column;
}

static ptrdiff_t raw_index(const struct elsewhere *s, int row, int column)
{
	return solved_index(s, all_rows(s), 0) + (ptrdiff_t)row * all_columns(s) + column;
}

static ptrdiff_t frequency_index(const struct elsewhere *s, int load)
{
	return raw_index(s, all_rows(s), 0) + load;
}

static mpq_t *read_entries(struct elsewhere *s, const struct model *model)
{
	const struct linear *system = &model->system;
	const int n = system->n, size = s->tuning->x.size;
	mpq_t *entry = rationals(s->entries);
	rows_of_highest(&s->tuning->x, system, entry);
	for (int i = 0; i < n; i++)
		equation_row(system, i, size, entry, &entry[raw_index(s, i, 0)], &entry[raw_index(s, i, size)]);
	for (int o = 0; o < model->outputs; o++) {
		/* a reduced model has no highest derivatives of what is written */
		const struct form *form = model->reduction.row ? NULL : model->output[o].form;
		const int row = n + o;
		mpq_t *whole = &entry[solved_index(s, row, 0)];
		row_of_output(&s->tuning->x, system, &model->output[o], system->segments, 0, whole);
		part_row(model, form, size, entry, whole, &entry[raw_index(s, row, 0)],
			 &entry[raw_index(s, row, size)]);
		mpq_set_ui(entry[raw_index(s, row, size + row)], 1, 1);
	}
	for (int l = 0; l < system->loads; l++)
		mpq_set(entry[frequency_index(s, l)], system->load[l].wave->w);
	return entry;
}

/* ---- all of them ---- */

/* An output or a frequency that no param changes stays as it is. */
static void number_rows(struct elsewhere *s)
{
	struct tuning *t = s->tuning;
	const struct linear *system = &s->model->system;
	t->all.rows = s->model->n;
	t->output = ARRAY(int, s->model->outputs);
	for (int o = 0; o < s->model->outputs; o++) {
		bool changes = false;
		for (int j = 0; j < t->x.size; j++)
			changes = changes || !entry_stays(s, solved_index(s, s->model->n + o, j));
		t->output[o] = changes ? t->all.rows++ : -1;
		t->outputs += changes;
	}
	t->frequency = ARRAY(int, system->loads);
	for (int l = 0; l < system->loads; l++) {
		const bool changes = !entry_stays(s, frequency_index(s, l));
		t->frequency[l] = changes ? t->all.rows++ : -1;
		t->frequencies += changes;
	}
}

/* The row of the entries that is row `row` of the equations */
static int entry_row(const struct elsewhere *s, int row)
{
	for (int o = 0; o < s->model->outputs; o++)
		if (s->tuning->output[o] == row)
			return s->model->n + o;
	return row;
}

/* Columns of W: a row for each row of the equations, those of outputs that stay as they are left out */
static int entry_column(const struct elsewhere *s, int column)
{
	return column < s->tuning->x.size ? column : s->tuning->x.size + entry_row(s, column - s->tuning->x.size);
}

/* A frequency is its own row: w = w. */
static bool fit_frequencies(struct elsewhere *s)
{
	struct tuning *t = s->tuning;
	for (int l = 0; l < s->model->system.loads; l++) {
		int row = t->frequency[l];
		if (row >= 0 && !fit_entry(s, frequency_index(s, l), &t->all, row, 0))
			return false;
		if (row >= 0 && t->all.solves)
			add_tuned_unit(&t->all, row, t->x.size + row);
	}
	return true;
}

static bool fit_all(struct elsewhere *s, bool solved)
{
	struct tuning *t = s->tuning;
	int rows = t->all.rows - t->frequencies;
	t->all.solves = !solved;
	t->all.terms = t->monomials = 0;
	for (int i = 0; i < rows; i++)
		for (int j = 0; j < t->x.size + (solved ? 0 : rows); j++) {
			const ptrdiff_t index = solved ? solved_index(s, entry_row(s, i), j)
						       : raw_index(s, entry_row(s, i), entry_column(s, j));
			if (!fit_entry(s, index, &t->all, i, j))
				return false;
		}
	return fit_frequencies(s);
}

static void mark_acting(struct elsewhere *s)
{
	struct tuning *t = s->tuning;
	t->acts = ARRAY(bool, (size_t)(t->all.rows * t->x.size));
	for (int i = 0; i < t->all.rows - t->frequencies; i++)
		for (int j = 0; j < t->x.size; j++) {
			const ptrdiff_t index = solved_index(s, entry_row(s, i), j);
			bool *acts = &t->acts[i * t->x.size + j];
			for (int p = 0; p < (entry_stays(s, index) ? 1 : s->points); p++)
				*acts = *acts || mpq_sgn(entry_seen(s, p, index)) != 0;
		}
}

static void find(void *context)
{
	struct elsewhere *s = context;
	struct tuning *t = s->tuning;
	check_kind(s->model);
	spread_tuned(s->model->spec);
	check_model(s->model);
	for (int k = 0; k < t->params; k++)
		param_value(t->param[k].symbol, t->nominal[k]);
	look_elsewhere(s);
	t->other = s->other;
	number_rows(s);
	if (!fit_all(s, true) && !fit_all(s, false))
		refuse_fit(s, "equations",
			   s->model->reduction.row ? "without --reduce the target solves equations with such a mass"
						   : "multiply an equation by what divides it");
	mark_acting(s);
	warn_of_idle(s);
}

bool find_tuning(struct model *model, const struct request *request)
{
	static const struct difference difference[] = {
		{ same_reduction, "--reduce would leave other states",
		  "what is left out, and the sums that become states, have to be the same for all values; without "
		  "--reduce all states are kept" },
		{ same_shape, "the model has other loads",
		  "a load is there only where its factor is not 0; its phase, growth and changes in time are fixed" }
	};
	const struct linear *system = &model->system;
	const struct spec *spec = model->spec;
	if (spec->tunables == 0)
		return true;
	if (model->keeps_params) {
		list_held(model);
		return true;
	}
	struct tuning *t = NEW(struct tuning);
	struct elsewhere s = { .model = model, .request = request, .tuning = t, .difference = difference,
			       .differences = sizeof difference / sizeof *difference, .read = read_entries };
	t->params = spec->tunables;
	t->given = spec->tunables - spec->derived;
	t->param = spec->tunable;
	t->nominal = rationals(t->params);
	t->x = layout_of_columns(system);
	t->all.columns = t->x.size;
	s.entries = frequency_index(&s, system->loads);
	model->tuning = t;
	return statement_guard(find, &s);
}
