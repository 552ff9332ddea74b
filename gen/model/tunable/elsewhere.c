/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model at other values of its tunable params. Params stand in a spec wherever a number may: in equations, sketches,
 * matrices, other params. So nothing is derived from its text: the model is built anew at values drawn at random, and
 * what is done to them on the way to its entries is recorded (base/traced.c). Functions and conditions of params are
 * params of their own (derived.c); where they hold more, they are refused before. */
#include "inner.h"
#include "model/linear/modal_truncation.h"

/* ---- places ---- */

/* A value like no other */
static void set_value(mpq_ptr value, int index)
{
	uint32_t bits = (uint32_t)index * 2654435761u + 12345u;
	bits ^= bits >> 15;
	bits *= 2246822519u;
	bits ^= bits >> 13;
	mpq_set_ui(value, (1ul << 24) + bits % 16769023, (1ul << 17) + (bits >> 12) % 131071);
	mpq_canonicalize(value);
}

/* Related by nothing; or near + 2^-40 |near| of that, on the side that a range leaves: what has a sign there, or an
 * order, keeps it */
static mpq_t *values_at(const struct elsewhere *s, int place)
{
	enum { APART = 1 << 20 };   /* more than there are params */
	mpq_t *values = rationals(s->tuning->params);
	RATIONAL unit = ZERO;
	for (int k = 0; k < s->tuning->params; k++) {
		set_value(values[k], place * APART + k);
		if (!s->near)
			continue;
		mpq_abs(unit, s->near[k]);
		if (mpq_sgn(unit) == 0)
			mpq_set_ui(unit, 1, 1);
		mpq_div_2exp(unit, unit, 40);
		mpq_mul(values[k], values[k], unit);
		const struct param_range *range = range_of_param(s->model, s->tuning->param[k].symbol);
		if (range && mpq_equal(range->high, s->near[k]))
			mpq_neg(values[k], values[k]);
		mpq_add(values[k], values[k], s->near[k]);
	}
	return values;
}

static bool same_load(const struct load *a, const struct load *b, bool any_rate)
{
	mpq_srcptr wa = a->forcing->w, wb = b->forcing->w;
	return a->powers == b->powers && mpq_equal(a->forcing->a, b->forcing->a) &&
	       mpq_equal(a->forcing->p, b->forcing->p) &&
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
	s->found = model_build(parse_spec(s->model->spec->source), &request);
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
		mpq_set(s->values[k], values_at(s, 0)[k]);
		if (silent_guard(build_there, s) && !same(pattern(s), s->found))
			return &t->param[k];
	}
	return &t->param[first];
}

void report_difference(struct elsewhere *s, const struct difference *difference)
{
	const struct tunable *why = suspect(s, difference->same);
	error(why->at, difference->note, "with another value of '%s' %s", why->symbol->name, difference->text);
}

/* Those that are not 0 */
static mpq_ptr *keep(const struct elsewhere *s, mpq_t *all)
{
	mpq_ptr *kept = ARRAY(mpq_ptr, (size_t)s->entries);
	for (ptrdiff_t i = 0; i < s->entries; i++) {
		if (mpq_sgn(all[i]) == 0)
			continue;
		kept[i] = *rationals(1);
		mpq_swap(kept[i], all[i]);
	}
	rationals_free(all, (size_t)s->entries);
	return kept;
}

static void look(struct elsewhere *s)
{
	s->values = values_at(s, s->places);
	const char *why = refusal_of(build_there, s);
	if (why)
		error(s->tuning->param[0].at, NULL, "with other values of the tunable params this is no model%s%s",
		      *why ? ": " : "", why);
	for (int i = 0; i < s->differences; i++)
		if (!s->difference[i].same(pattern(s), s->found))
			report_difference(s, &s->difference[i]);
	s->other = s->other ? s->other : s->found;
	s->seen[s->places] = keep(s, s->read(s, s->found));
	s->places++;
}

static void look_at_both(void *context)
{
	struct elsewhere *s = context;
	trace_from(s->tuning->params, values_at(s, 0), values_at(s, 1), s->tuning->nominal);
	look(s);
	trace_pause();
	look(s);
}

void look_elsewhere(struct elsewhere *s)
{
	mpq_init(s->zero);
	const bool looked = statement_guard(look_at_both, s);
	trace_pause();
	if (!looked)
		abandon();
}

mpq_srcptr entry_seen(const struct elsewhere *s, int place, ptrdiff_t index)
{
	mpq_srcptr entry = s->seen[place][index];
	return entry ? entry : s->zero;
}

bool entry_stays(const struct elsewhere *s, ptrdiff_t index)
{
	return mpq_equal(entry_seen(s, 0, index), entry_seen(s, 1, index));
}

/* ---- entries ---- */

void add_tuned_entry(struct elsewhere *s, ptrdiff_t index, struct tuned_equations *all, int row, int column)
{
	mpq_srcptr here = entry_seen(s, 0, index), there = entry_seen(s, 1, index);
	if (mpq_sgn(here) == 0 && mpq_sgn(there) == 0)
		return;
	const int number = traced_as(here, there);
	if (number < 0 && !entry_stays(s, index))
		error(s->tuning->param[0].at, NULL,
		      "the equations depend on tunable params in a way that cannot be recomputed on the target");
	mpq_t *size = rationals(1);
	mpq_abs(*size, here);
	*MORE(all->entry, all->entries) =
		(struct tuned_entry){ .row = row, .column = column, .value = { number, mpq_sgn(here) < 0, *size } };
}
