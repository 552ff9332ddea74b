/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How the equations follow from tunable params. Params stand in a spec wherever a number may: in equations, sketches,
 * matrices, other params. So nothing is derived from its text: the model is built anew at a few exact values, and every
 * entry of it is found from its values there (fit.c). What could only seem to be a sum of products, a function or a
 * condition, is refused before. */
#include "model/model.h"

/* ---- what cannot be recomputed ---- */

static const char *const refused_note = "sums, products and quotients of tunables are recomputed on the target; make "
					"what the function gives a tunable of its own";
static const char *const decided_note = "which way it goes is decided when plgen runs: where formulas change is fixed";

static void refuse_within(const struct node *node, const char *inside, const char *note)
{
	const struct node *name = first_tuned(node);
	if (name)
		error(name->at, note, "'%s' is tunable, or made of what is, and stands inside %s", name->symbol->name,
		      inside);
}

static bool reads_time(const struct node *node)
{
	if (node->kind == NODE_TIME ||
	    (node->kind == NODE_NAME && node->symbol->value && reads_time(node->symbol->value)))
		return true;
	for (int i = 0; i < node->children; i++)
		if (reads_time(node->child[i]))
			return true;
	return false;
}

static void check_node(const struct node *node)
{
	if (node->kind == NODE_NAME && node->symbol->tuned && node->symbol->value && !node->symbol->tuning_checked) {
		node->symbol->tuning_checked = true;
		check_node(node->symbol->value);
	}
	for (int i = 0; i < node->children; i++) {
		bool wave = (node->function == FN_SIN || node->function == FN_COS) && reads_time(node->child[i]);
		/* a load's frequency may be tunable; its phase is looked at with the model */
		if (node->kind == NODE_CALL && !wave)
			refuse_within(node->child[i], format("%s()", function_name(node->function)), refused_note);
		if (node->kind == NODE_COMPARE)
			refuse_within(node->child[i], "a comparison", decided_note);
		if (node->kind == NODE_CHOOSE && i == 0)
			refuse_within(node->child[i], "a condition", decided_note);
		if (node->kind == NODE_POWER && i == 1)
			refuse_within(node->child[i], "an exponent", refused_note);
		check_node(node->child[i]);
	}
}

static void check_model(const struct model *model)
{
	const struct spec *spec = model->spec;
	for (int i = 0; i < spec->equations; i++) {
		check_node(spec->equation[i].left);
		check_node(spec->equation[i].right);
	}
	for (int i = 0; i < spec->elements; i++)
		check_node(spec->element[i].value);
	for (int i = 0; i < model->outputs; i++)
		if (model->output[i].value && !model->output[i].left)
			check_node(model->output[i].value);
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

struct search {
	struct tuning *tuning;
	const struct model *model;
	const struct request *request;
	struct model *found;
	mpq_t *values;
	int points;                 /* looked at so far */
	mpq_t **point;              /* params */
	mpq_ptr **seen;             /* entries there, NULL: 0; of the first points all, of others those that change */
	mpq_t zero;
	ptrdiff_t entries, changing;
	ptrdiff_t *place;           /* per entry: which of those that change; -1: it does not. NULL: not known yet */
	const bool *wanted;         /* outputs, in the raw equations */
};

static void build_there(void *context)
{
	struct search *s = context;
	struct request request = *s->request;
	request.tunable = (const mpq_t *)s->values;
	struct spec *spec = parse_spec(s->model->spec->source);
	s->found = model_build(spec, &request);
	if (s->found && request.reduce)
		s->found = model_reduce(s->found);
	if (!s->found)
		abandon();
}

static bool same_load(const struct load *a, const struct load *b)
{
	return a->powers == b->powers && mpq_equal(a->wave->a, b->wave->a) && mpq_equal(a->wave->p, b->wave->p) &&
	       (mpq_sgn(a->wave->w) != 0) == (mpq_sgn(b->wave->w) != 0);
}

static bool same_shape(const struct model *model, const struct model *other)
{
	const struct linear *a = &model->system, *b = &other->system;
	if (a->states != b->states || a->loads != b->loads || a->inputs != b->inputs || a->segments != b->segments)
		return false;
	for (int i = 0; i < a->n; i++)
		if (a->velocity[i] != b->velocity[i])
			return false;
	for (int l = 0; l < a->loads; l++)
		if (!same_load(&a->load[l], &b->load[l]))
			return false;
	for (int s = 0; s < a->segments - 1; s++)
		if (!mpq_equal(a->change[s], b->change[s]))
			return false;
	return true;
}

/* Points of which all entries are kept: what is the same at all of them does not change. */
enum { WHOLE_POINTS = FIT_POINTS + 1 };

/* Entries of one point: W^-1 R of all rows, then [R | W], then the frequencies of the loads. Rows: the coordinates,
 * then the outputs. */
static int all_rows(const struct search *s)
{
	return s->model->n + s->model->outputs;
}

static int all_columns(const struct search *s)
{
	return s->tuning->x.size + all_rows(s);
}

static ptrdiff_t solved_index(const struct search *s, int row, int column)
{
	return (ptrdiff_t)row * s->tuning->x.size + column;
}

static ptrdiff_t raw_index(const struct search *s, int row, int column)
{
	return solved_index(s, all_rows(s), 0) + (ptrdiff_t)row * all_columns(s) + column;
}

static ptrdiff_t frequency_index(const struct search *s, int load)
{
	return raw_index(s, all_rows(s), 0) + load;
}

static mpq_t *solved_entry(const struct search *s, mpq_t *entry, int row, int column)
{
	return &entry[solved_index(s, row, column)];
}

static mpq_t *raw_entry(const struct search *s, mpq_t *entry, int row, int column)
{
	return &entry[raw_index(s, row, column)];
}

/* An entry at a point that was looked at */
static mpq_srcptr seen_at(const struct search *s, int point, ptrdiff_t index)
{
	const bool all = point < WHOLE_POINTS;
	mpq_srcptr entry = all ? s->seen[point][index]
			   : s->place[index] < 0 ? s->seen[0][index] : s->seen[point][s->place[index]];
	return entry ? entry : s->zero;
}

static bool stays(const struct search *s, ptrdiff_t index)
{
	return s->place[index] < 0;
}

/* Calls take(context, column, force) for what acts on the equations, in the order of the columns behind the states */
static void each_force(const struct linear *system, void (*take)(void *context, int column, const mpq_t *force),
		       void *context)
{
	int column = system->states;
	const mpq_t *none = rationals((size_t)system->n); /* of further derivatives of inputs */
	for (int s = 0; s < system->segments; s++)
		for (int l = 0; l < system->loads; l++)
			for (int k = 0; k < system->load[l].columns; k++)
				take(context, column++, (const mpq_t *)system->load[l].force[k] + s * system->n);
	for (int i = 0; i < system->inputs; i++)
		for (int k = 0; k <= system->input[i].hold; k++)
			take(context, column++, k < 2 ? (const mpq_t *)system->input[i].force[k] : none);
}

struct reading {
	const struct search *search;
	const struct model *model;
	const mpq_t *inverse;
	mpq_t *entry;
};

static void read_force(void *context, int column, const mpq_t *force)
{
	const struct reading *r = context;
	int n = r->model->n;
	mpq_t *product = rationals((size_t)n);
	rational_product(n, n, 1, r->inverse, force, product);
	for (int i = 0; i < n; i++) {
		mpq_set(*raw_entry(r->search, r->entry, i, column), force[i]);
		mpq_set(*solved_entry(r->search, r->entry, i, column), product[i]);
	}
	rationals_free(product, (size_t)n);
}

/* W highest = -(K q + C v) + forces, and the same solved */
static void read_equations(struct reading *r)
{
	const struct search *s = r->search;
	const struct linear *system = &r->model->system;
	int n = system->n, states = system->states, column;
	mpq_t *inverse = rationals((size_t)(n * n)), *highest = rationals((size_t)(n * states));
	leading_inverse(system, inverse, &column);
	highest_derivatives(system, (const mpq_t *)inverse, false, highest);
	r->inverse = (const mpq_t *)inverse;
	for (int i = 0; i < n; i++) {
		for (int j = 0; j < states; j++) {
			mpq_set(*solved_entry(s, r->entry, i, j), highest[i * states + j]);
			mpq_neg(*raw_entry(s, r->entry, i, j),
				(j < n ? system->K : system->C)[i * n + system->coord[j]]);
		}
		for (int j = 0; j < n; j++)
			mpq_set(*raw_entry(s, r->entry, i, s->tuning->x.size + j),
				(system->velocity[j] >= 0 ? system->M : system->C)[i * n + j]);
	}
	each_force(system, read_force, r);
	rationals_free(inverse, (size_t)(n * n));
	rationals_free(highest, (size_t)(n * states));
}

/* The whole row of an output over the columns */
static void read_output_row(const struct reading *r, int row, const struct output *output)
{
	const struct linear *system = &r->model->system;
	int column = 0;
	for (int j = 0; j < system->states; j++)
		mpq_set(*solved_entry(r->search, r->entry, row, column++), output->state[j]);
	for (int s = 0; s < system->segments; s++)
		for (int l = 0; l < system->loads; l++)
			for (int k = 0; k < system->load[l].columns; k++)
				mpq_set(*solved_entry(r->search, r->entry, row, column++),
					output->load[l][k * system->segments + s]);
	for (int i = 0; i < system->inputs; i++) {
		for (int k = 0; k <= system->input[i].hold; k++)
			if (k < 2)
				mpq_set(*solved_entry(r->search, r->entry, row, column + k), output->input[k][i]);
		column += system->input[i].hold + 1;
	}
}

/* output - sum of factors of highest derivatives times these = what is left of the row without them */
static void part_output_row(const struct reading *r, int row, const struct output *output)
{
	const struct search *s = r->search;
	/* a reduced model has no highest derivatives of what is written */
	const struct form *form = r->model->reduction.row ? NULL : output->form;
	mpq_t product;
	mpq_init(product);
	for (int j = 0; j < s->tuning->x.size; j++)
		mpq_set(*raw_entry(s, r->entry, row, j), *solved_entry(s, r->entry, row, j));
	mpq_set_ui(*raw_entry(s, r->entry, row, s->tuning->x.size + row), 1, 1);
	for (int i = 0; form && i < form->terms; i++) {
		const struct form_term *term = &form->term[i];
		int coord = term->basis.index;
		if (term->basis.kind != BASIS_COORD || term->basis.order < r->model->frame.coord[coord]->highest)
			continue;
		mpq_neg(*raw_entry(s, r->entry, row, s->tuning->x.size + coord), term->factor);
		for (int j = 0; j < s->tuning->x.size; j++) {
			mpq_mul(product, term->factor, *solved_entry(s, r->entry, coord, j));
			mpq_sub(*raw_entry(s, r->entry, row, j), *raw_entry(s, r->entry, row, j), product);
		}
	}
	mpq_clear(product);
}

static mpq_t *read_entries(const struct search *s, const struct model *model)
{
	struct reading r = { s, model, NULL, rationals((size_t)s->entries) };
	read_equations(&r);
	for (int o = 0; o < model->outputs; o++) {
		read_output_row(&r, model->n + o, &model->output[o]);
		part_output_row(&r, model->n + o, &model->output[o]);
	}
	for (int l = 0; l < model->system.loads; l++)
		mpq_set(r.entry[frequency_index(s, l)], model->system.load[l].wave->w);
	return r.entry;
}

static void find_changing(struct search *s)
{
	s->place = ARRAY(ptrdiff_t, (size_t)s->entries);
	for (ptrdiff_t i = 0; i < s->entries; i++) {
		bool changes = false;
		for (int p = 1; p < WHOLE_POINTS; p++)
			changes = changes || !mpq_equal(seen_at(s, p, i), seen_at(s, 0, i));
		s->place[i] = changes ? s->changing++ : -1;
	}
}

/* Those that are not 0, of all entries, or of those that change */
static mpq_ptr *keep(const struct search *s, mpq_t *all)
{
	mpq_ptr *kept = ARRAY(mpq_ptr, (size_t)(s->place ? s->changing : s->entries));
	for (ptrdiff_t i = 0; i < s->entries; i++) {
		if (mpq_sgn(all[i]) == 0 || (s->place && s->place[i] < 0))
			continue;
		mpq_ptr entry = *rationals(1);
		mpq_swap(entry, all[i]);
		kept[s->place ? s->place[i] : i] = entry;
	}
	rationals_free(all, (size_t)s->entries);
	return kept;
}

/* Of the model at a point that is not looked at again, matrices and rows: what a large one is made of */
static void forget(struct search *s)
{
	struct linear *system = &s->found->system;
	const size_t cells = (size_t)system->n * (size_t)system->n;
	rationals_free(system->M, cells);
	rationals_free(system->C, cells);
	rationals_free(system->K, cells);
	for (int o = 0; o < s->found->outputs; o++)
		rationals_free(s->found->output[o].state, (size_t)system->states);
	s->found = NULL;
}

/* The param that alone, with another value, gives another model in this sense; else the first */
static const struct tunable *suspect(struct search *s, bool (*same)(const struct model *, const struct model *))
{
	const struct tuning *t = s->tuning;
	for (int k = 0; k < t->params; k++) {
		s->values = rationals((size_t)t->params);
		for (int i = 0; i < t->params; i++)
			mpq_set(s->values[i], t->nominal[i]);
		mpq_set(s->values[k], scattered_values(t->params, 0)[k]);
		if (silent_guard(build_there, s) && !same(s->found, s->model))
			return &t->param[k];
	}
	return &t->param[0];
}

/* The point where the params have these values; kept, since several questions ask for the same */
static int look(struct search *s, const mpq_t *values)
{
	struct tuning *t = s->tuning;
	for (int i = 0; i < s->points; i++) {
		bool same = true;
		for (int k = 0; k < t->params; k++)
			same = same && mpq_equal(s->point[i][k], values[k]);
		if (same)
			return i;
	}
	s->values = rationals((size_t)t->params);
	for (int k = 0; k < t->params; k++)
		mpq_set(s->values[k], values[k]);
	if (!silent_guard(build_there, s))
		error(t->param[0].at, NULL, "with other values of the tunable params this is no model");
	if (!same_reduction(s->found, s->model)) {
		const struct tunable *why = suspect(s, same_reduction);
		error(why->at,
		      "what is left out, and the outputs that become states, have to be the same for all values; "
		      "without --reduce all states are kept",
		      "with another value of '%s' --reduce would leave other states", why->symbol->name);
	}
	if (!same_shape(s->found, s->model)) {
		const struct tunable *why = suspect(s, same_shape);
		error(why->at,
		      "a load is there only where its factor is not 0; its phase, growth and changes in time are fixed",
		      "with another value of '%s' the model has other loads", why->symbol->name);
	}
	ENLARGE(s->point, (size_t)s->points + 1);
	ENLARGE(s->seen, (size_t)s->points + 1);
	s->point[s->points] = s->values;
	s->seen[s->points] = keep(s, read_entries(s, s->found));
	if (s->place)
		forget(s);
	return s->points++;
}

/* ---- all of them ---- */

/* The number of a product of powers, each made of one that is a step nearer to 1 */
static int monomial_of(struct tuning *t, signed char *power)
{
	int last = t->params - 1, from;
	while (last >= 0 && power[last] == 0)
		last--;
	if (last < 0)
		return 0;
	bool divides = power[last] < 0;
	power[last] = (signed char)(power[last] + (divides ? 1 : -1));
	from = monomial_of(t, power);
	for (int m = 0; m < t->monomials; m++)
		if (t->monomial[m].from == from && t->monomial[m].param == last && t->monomial[m].divides == divides)
			return m + 1;
	ENLARGE(t->monomial, (size_t)t->monomials + 1);
	t->monomial[t->monomials] = (struct tuned_monomial){ from, last, divides };
	return ++t->monomials;
}

static struct tuned_term *add_term(struct tuning *t, int row, int column, int monomial)
{
	ENLARGE(t->term, (size_t)t->terms + 1);
	struct tuned_term *term = &t->term[t->terms++];
	*term = (struct tuned_term){ .row = row, .column = column, .monomial = monomial };
	mpq_init(term->factor);
	return term;
}

void add_tuned_unit(struct tuning *t, int row, int column)
{
	mpq_set_ui(add_term(t, row, column, 0)->factor, 1, 1);
}

void add_tuned_terms(struct tuning *t, const struct fit *f, int row, int column)
{
	for (int i = 0; i < f->products; i++) {
		signed char power[LIMIT_TUNABLES];
		if (mpq_sgn(f->factor[i]) == 0)
			continue;
		for (int k = 0; k < t->params; k++)
			power[k] = f->power[i][k];
		int monomial = monomial_of(t, power);
		mpq_set(add_term(t, row, column, monomial)->factor, f->factor[i]);
	}
}

/* An output or a frequency that no param changes stays as it is. */
static void number_rows(struct search *s)
{
	struct tuning *t = s->tuning;
	const struct linear *system = &s->model->system;
	t->rows = s->model->n;
	t->output = ARRAY(int, (size_t)s->model->outputs);
	for (int o = 0; o < s->model->outputs; o++) {
		bool changes = false;
		for (int j = 0; j < t->x.size; j++)
			changes = changes || !stays(s, solved_index(s, s->model->n + o, j));
		t->output[o] = changes ? t->rows++ : -1;
		t->outputs += changes;
	}
	t->frequency = ARRAY(int, (size_t)system->loads);
	for (int l = 0; l < system->loads; l++) {
		const bool changes = !stays(s, frequency_index(s, l));
		t->frequency[l] = changes ? t->rows++ : -1;
		t->frequencies += changes;
	}
}

/* The row of the entries that is row `row` of the equations */
static int entry_row(const struct search *s, int row)
{
	for (int o = 0; o < s->model->outputs; o++)
		if (s->tuning->output[o] == row)
			return s->model->n + o;
	return row;
}

/* Columns of W: a row for each row of the equations, those of outputs that stay as they are left out */
static int entry_column(const struct search *s, int column)
{
	return column < s->tuning->x.size ? column : s->tuning->x.size + entry_row(s, column - s->tuning->x.size);
}

struct entry {
	struct search *search;
	ptrdiff_t index;
};

static mpq_srcptr entry_at(void *context, const mpq_t *values)
{
	const struct entry *entry = context;
	return seen_at(entry->search, look(entry->search, values), entry->index);
}

static bool fit_into(struct search *s, ptrdiff_t index, int row, int column, int *culprit)
{
	if (stays(s, index)) {
		if (mpq_sgn(seen_at(s, 0, index)) != 0)
			mpq_set(add_term(s->tuning, row, column, 0)->factor, seen_at(s, 0, index));
		return true;
	}
	struct fit *f = NEW(struct fit);
	f->params = s->tuning->params;
	f->value = entry_at;
	f->context = &(struct entry){ s, index };
	if (!fit_value(f)) {
		*culprit = f->culprit;
		return false;
	}
	add_tuned_terms(s->tuning, f, row, column);
	return true;
}

/* A frequency is its own row: w = w. */
static bool fit_frequencies(struct search *s, int *culprit)
{
	struct tuning *t = s->tuning;
	for (int l = 0; l < s->model->system.loads; l++) {
		int row = t->frequency[l];
		if (row >= 0 && !fit_into(s, frequency_index(s, l), row, 0, culprit))
			return false;
		if (row >= 0 && t->solves)
			add_tuned_unit(t, row, t->x.size + row);
	}
	return true;
}

static bool fit_all(struct search *s, bool solved, int *culprit)
{
	struct tuning *t = s->tuning;
	int rows = t->rows - t->frequencies;
	t->solves = !solved;
	t->terms = t->monomials = 0;
	for (int i = 0; i < rows; i++)
		for (int j = 0; j < t->x.size + (solved ? 0 : rows); j++) {
			const ptrdiff_t index = solved ? solved_index(s, entry_row(s, i), j)
						       : raw_index(s, entry_row(s, i), entry_column(s, j));
			if (!fit_into(s, index, i, j, culprit))
				return false;
		}
	return fit_frequencies(s, culprit);
}

static void mark_acting(struct search *s)
{
	struct tuning *t = s->tuning;
	t->acts = ARRAY(bool, (size_t)(t->rows * t->x.size));
	for (int i = 0; i < t->rows - t->frequencies; i++)
		for (int j = 0; j < t->x.size; j++) {
			const ptrdiff_t index = solved_index(s, entry_row(s, i), j);
			bool *acts = &t->acts[i * t->x.size + j];
			for (int p = 0; p < (stays(s, index) ? 1 : s->points); p++)
				*acts = *acts || mpq_sgn(seen_at(s, p, index)) != 0;
		}
}

static void warn_of_idle(const struct tuning *t)
{
	for (int k = 0; k < t->params; k++) {
		bool used = false;
		for (int m = 0; m < t->monomials; m++)
			used = used || t->monomial[m].param == k;
		if (!used)
			say_warning(t->param[k].at, NULL, "tunable '%s' changes nothing that the target recomputes",
				    t->param[k].symbol->name);
	}
}

static void refuse_form(const struct search *s, int culprit)
{
	const struct tunable *why = &s->tuning->param[culprit < 0 ? 0 : culprit];
	const char *way = s->model->reduction.row ? "without --reduce the target solves equations with such a mass"
						  : "multiply an equation by what divides it";
	error(why->at,
	      format("sums and products, and quotients by single terms, up to the power %d of each and %d of them in "
		     "an entry, are recomputed on the target; %s",
		     FIT_DEGREE, LIMIT_MONOMIALS, way),
	      "the equations depend on '%s' in a way that cannot be recomputed on the target", why->symbol->name);
}

static void find(void *context)
{
	struct search *s = context;
	struct tuning *t = s->tuning;
	int culprit = -1;
	check_kind(s->model);
	spread_tuned(s->model->spec);
	check_model(s->model);
	for (int k = 0; k < t->params; k++)
		param_value(t->param[k].symbol, t->nominal[k]);
	for (int i = 0; i < WHOLE_POINTS; i++)
		look(s, (const mpq_t *)scattered_values(t->params, i));
	t->other = s->found;
	find_changing(s);
	number_rows(s);
	if (!fit_all(s, true, &culprit) && !fit_all(s, false, &culprit))
		refuse_form(s, culprit);
	mark_acting(s);
	warn_of_idle(t);
}

bool find_tuning(struct model *model, const struct request *request)
{
	const struct linear *system = &model->system;
	const struct spec *spec = model->spec;
	if (spec->tunables == 0)
		return true;
	if (model->keeps_params) {
		list_held(model);
		return true;
	}
	struct tuning *t = NEW(struct tuning);
	struct search s = { .tuning = t, .model = model, .request = request };
	mpq_init(s.zero);
	t->params = spec->tunables;
	t->param = spec->tunable;
	t->nominal = rationals((size_t)t->params);
	t->x = layout_of_columns(system);
	s.entries = frequency_index(&s, system->loads);
	model->tuning = t;
	return statement_guard(find, &s);
}
