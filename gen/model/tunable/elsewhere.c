/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model at other values of its tunable params. Params stand in a spec wherever a number may: in equations, sketches,
 * matrices, other params. So nothing is derived from its text: the model is built anew at a few exact values, and every
 * entry of it is found from its values there (fit.c). What could only seem to be a sum of products, a function or a
 * condition, is a param of its own where it is made of params alone (derived.c), or refused before. */
#include "elsewhere.h"
#include "model/linear/shortening.h"
#include "tuning.h"

/* ---- points ---- */

static bool same_load(const struct load *a, const struct load *b, bool any_rate)
{
	mpq_srcptr wa = a->wave->w, wb = b->wave->w;
	return a->powers == b->powers && mpq_equal(a->wave->a, b->wave->a) && mpq_equal(a->wave->p, b->wave->p) &&
	       (mpq_sgn(wa) != 0) == (mpq_sgn(wb) != 0) && (any_rate || mpq_equal(wa, wb));
}

bool same_loads(const struct linear *a, const struct linear *b, bool any_rate)
{
	bool same = a->loads == b->loads && a->segments == b->segments;
	for (int l = 0; l < a->loads && same; l++)
		same = same_load(&a->load[l], &b->load[l], any_rate);
	for (int s = 0; s < a->segments - 1 && same; s++)
		same = mpq_equal(a->change[s], b->change[s]);
	return same;
}

static void build_there(void *context)
{
	struct elsewhere *s = context;
	struct request request = *s->request;
	request.again.tunable = s->values;
	request.again.factor = s->factor;
	s->found = model_build(spec_again(s->model->spec), &request);
	if (s->found && !s->factor)
		s->found = model_reduce(s->found);
	if (!s->found)
		abandon();
}

/* What others are like */
static const struct model *pattern(const struct elsewhere *s)
{
	return s->other ? s->other : s->model;
}

/* The param that alone, with another value, gives another model in this sense; else the first */
static const struct tunable *suspect(struct elsewhere *s, bool (*same)(const struct model *, const struct model *))
{
	const struct tuning *t = s->tuning;
	int first = -1;
	for (int k = 0; k < t->params; k++) {
		if (s->factor && !s->factor[k])
			continue;
		first = first < 0 ? k : first;
		s->values = rationals_copied(t->params, t->nominal);
		mpq_set(s->values[k], scattered_near(t->params, 0, s->near)[k]);
		if (silent_guard(build_there, s) && !same(pattern(s), s->found))
			return &t->param[k];
	}
	return &t->param[first];
}

void tell_difference(struct elsewhere *s, const struct difference *difference)
{
	const struct tunable *why = suspect(s, difference->same);
	error(why->at, difference->note, "with another value of '%s' %s", why->symbol->name, difference->text);
}

static void find_changing(struct elsewhere *s)
{
	s->place = ARRAY(ptrdiff_t, s->entries);
	for (ptrdiff_t i = 0; i < s->entries; i++) {
		bool changes = false;
		for (int p = 1; p < s->points; p++)
			changes = changes || !mpq_equal(entry_seen(s, p, i), entry_seen(s, 0, i));
		s->place[i] = changes ? s->changing++ : -1;
	}
}

/* Those that are not 0, of all entries, or of those that change */
static mpq_ptr *keep(const struct elsewhere *s, mpq_t *all)
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
static void forget(struct elsewhere *s)
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

static int point_with(const struct elsewhere *s, const mpq_t *values)
{
	for (int i = 0; i < s->points; i++)
		if (rationals_equal(s->tuning->params, s->point[i], values))
			return i;
	return -1;
}

/* The point where the params have these values; kept, since several questions ask for the same */
static int look(struct elsewhere *s, const mpq_t *values)
{
	const int known = point_with(s, values);
	if (known >= 0)
		return known;
	mpq_t *at = s->values = rationals_copied(s->tuning->params, values);
	if (!silent_guard(build_there, s))
		error(s->tuning->param[0].at, NULL, "with other values of the tunable params this is no model");
	for (int i = 0; i < s->differences; i++)
		if (!s->difference[i].same(pattern(s), s->found))
			tell_difference(s, &s->difference[i]);
	s->other = s->other ? s->other : s->found;
	ENLARGE(s->point, (size_t)s->points + 1);
	ENLARGE(s->seen, (size_t)s->points + 1);
	s->point[s->points] = at;
	s->seen[s->points] = keep(s, s->read(s, s->found));
	if (s->place)
		forget(s);
	return s->points++;
}

void look_elsewhere(struct elsewhere *s)
{
	const int params = s->tuning->params;
	mpq_init(s->zero);
	for (int i = 0; i < WHOLE_POINTS; i++)
		look(s, scattered_near(params, i, s->near));
	find_changing(s);
}

mpq_srcptr entry_seen(const struct elsewhere *s, int point, ptrdiff_t index)
{
	const bool all = point < WHOLE_POINTS;
	mpq_srcptr entry = all ? s->seen[point][index]
			   : s->place[index] < 0 ? s->seen[0][index] : s->seen[point][s->place[index]];
	return entry ? entry : s->zero;
}

bool entry_stays(const struct elsewhere *s, ptrdiff_t index)
{
	return s->place[index] < 0;
}

/* ---- sums of products ---- */

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
	*MORE(t->monomial, t->monomials) = (struct tuned_monomial){ from, last, divides };
	return t->monomials;
}

static struct tuned_term *add_term(struct tuned_equations *all, int row, int column, int monomial)
{
	struct tuned_term *term = MORE(all->term, all->terms);
	*term = (struct tuned_term){ .row = row, .column = column, .monomial = monomial };
	mpq_init(term->factor);
	return term;
}

void add_tuned_unit(struct tuned_equations *all, int row, int column)
{
	mpq_set_ui(add_term(all, row, column, 0)->factor, 1, 1);
}

static void add_fitted(struct elsewhere *s, struct tuned_equations *all, int row, int column)
{
	const struct fit *f = &s->fit;
	for (int i = 0; i < f->products; i++) {
		signed char power[FIT_PARAMS];
		if (mpq_sgn(f->factor[i]) == 0)
			continue;
		for (int k = 0; k < f->params; k++)
			power[k] = f->power[i][k];
		mpq_set(add_term(all, row, column, monomial_of(s->tuning, power))->factor, f->factor[i]);
	}
}

struct entry {
	struct elsewhere *search;
	ptrdiff_t index;
};

static mpq_srcptr entry_at(void *context, const mpq_t *values)
{
	const struct entry *entry = context;
	return entry_seen(entry->search, look(entry->search, values), entry->index);
}

static bool fits_entry(struct elsewhere *s, ptrdiff_t index)
{
	struct fit *f = &s->fit;
	*f = (struct fit){ .params = s->tuning->params, .near = s->near, .value = entry_at,
			   .context = &(struct entry){ s, index } };
	if (!entry_stays(s, index))
		return fit_value(f);
	f->products = 1;
	f->factor = rationals(1);
	mpq_set(f->factor[0], entry_seen(s, 0, index));
	return true;
}

bool fit_entry(struct elsewhere *s, ptrdiff_t index, struct tuned_equations *all, int row, int column)
{
	const bool fits = fits_entry(s, index);
	if (fits)
		add_fitted(s, all, row, column);
	return fits;
}

void refuse_fit(const struct elsewhere *s, const char *what, const char *way)
{
	const int culprit = s->fit.culprit;
	const struct tunable *why = &s->tuning->param[culprit < 0 ? 0 : culprit];
	error(why->at,
	      format("sums and products, and quotients by single terms, up to the power %d of each and %d of them in "
		     "an entry, are recomputed on the target; %s", FIT_DEGREE, LIMIT_MONOMIALS, way),
	      "the %s depend on '%s' in a way that cannot be recomputed on the target", what, why->symbol->name);
}
