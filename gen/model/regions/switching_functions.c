/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is compared with breakpoints: terms that compare multiples of one form share a switching function. Its loads may
 * have another formula in each segment of time; it is known again there by the terms that compare it, and by what of it
 * is not of time alone. */
#include "inner.h"
#include "model/building.h"
#include "model/contacts/friction.h"
#include "model/reads.h"

#include <limits.h>

enum { LIMIT_CANDIDATES = 6561 };      /* regions looked at, before those that cannot be are left out */

/* ---- intervals and rates ---- */

/* Where all of them are cached, of those beside the lowest the first that this switching function is in */
static int first_beside(const struct switching *s, int function)
{
	int first = 1;
	for (int i = 0; i < function; i++)
		first += s->function[i].breaks;
	return first;
}

int interval_of(const struct switching *s, int region, int function)
{
	const struct switching_function *e = &s->function[function];
	if (!s->cached)
		return region / e->stride % (e->breaks + 1);
	int interval = region % regions_at_once(s) - first_beside(s, function) + 1;
	return interval > 0 && interval <= e->breaks ? interval : 0;
}

int breaks_of_all(const struct switching *s)
{
	int count = 0;
	for (int e = 0; e < s->functions; e++)
		count += s->function[e].breaks;
	return count;
}

int beside_lowest(const struct switching *s, int segment, int function, int interval)
{
	return segment * regions_at_once(s) + (interval > 0 ? first_beside(s, function) + interval - 1 : 0);
}

int region_below(const struct switching *s, int region, int function)
{
	const int interval = interval_of(s, region, function);
	return interval == 0 ? -1 : !s->cached ? region - s->function[function].stride
	       : interval > 1 ? region - 1 : region - region % regions_at_once(s);
}

bool caches_regions(const struct model *model)
{
	return model->switching && model->switching->cached;
}

int region_numbers(const struct switching *s)
{
	int count = 1;
	for (int i = 0; i < s->functions && s->cached; i++)
		count *= s->function[i].breaks + 1;
	return s->cached ? count : regions_at_once(s);
}

int region_above(const struct switching *s, int region, int function)
{
	const struct switching_function *e = &s->function[function];
	const int interval = interval_of(s, region, function);
	if (interval == e->breaks || (s->cached && interval == 0 && region % regions_at_once(s) > 0))
		return -1;
	return region + (!s->cached ? e->stride : interval > 0 ? 1 : first_beside(s, function));
}

bool is_stick(const struct switching_function *e, int interval)
{
	return interval > 0 && interval < e->breaks && mpq_equal(e->at[interval - 1], e->at[interval]);
}

int input_hold(const struct building *b, int index)
{
	for (const struct symbol *s = b->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_INPUT && s->index == index)
			return s->hold;
	return 0;
}

/* Its derivative with respect to time; of a ramp u', of what is held nothing */
struct form *rate_of_form(struct building *b, const struct form *form)
{
	struct form *rate = NEW(struct form);
	RATIONAL factor = ZERO;
	for (int i = 0; i < form->terms; i++) {
		struct basis basis = form->term[i].basis;
		mpq_srcptr given = form->term[i].factor;
		if (basis.kind == BASIS_COORD || (basis.kind == BASIS_INPUT && basis.order == 0 &&
						  input_hold(b, basis.index))) {
			basis.order++;
			form_add_basis(rate, basis, given);
		}
		if (basis.kind != BASIS_FORCING)
			continue;
		mpq_mul(factor, given, basis.forcing->a);
		if (mpq_sgn(factor) != 0)
			form_add_basis(rate, basis, factor);
		mpq_mul(factor, given, basis.forcing->w);
		if (!basis.sine)
			mpq_neg(factor, factor);
		basis.sine = !basis.sine;
		if (mpq_sgn(factor) != 0)
			form_add_basis(rate, basis, factor);
		basis.sine = !basis.sine;
		if (basis.power == 0)
			continue;
		mpq_set_ui(factor, (unsigned long)basis.power, 1);
		mpq_mul(factor, factor, given);
		if (--basis.power == 0 && is_polynomial(basis.forcing))
			basis = (struct basis){ .kind = BASIS_ONE };
		form_add_basis(rate, basis, factor);
	}
	return rate;
}

/* ---- multiples ---- */

bool is_form_multiple(const struct form *form, const struct form *e, mpq_ptr of)
{
	if (form->terms != e->terms || basis_order(&form->term[0].basis, &e->term[0].basis) != 0)
		return false;
	mpq_div(of, form->term[0].factor, e->term[0].factor);
	struct form *same = form_scale(e, of);
	bool multiple = same_form(form, same);
	form_free(same);
	return multiple;
}

bool share_function(const struct switching *a, const struct switching *b)
{
	bool shared = false;
	RATIONAL factor = ZERO;
	for (int i = 0; i < a->functions; i++)
		for (int k = 0; k < b->functions && !shared; k++)
			shared = is_form_multiple(a->function[i].form, b->function[k].form, factor);
	return shared;
}

/* ---- the terms that compare it ---- */

struct comparing {
	const struct node *node;
	mpq_t first;                /* where it is compared first, in the unit of the switching function */
	bool *seen;                 /* per segment of time: it is compared there */
};

static struct comparing *term_of(const struct switching_function *e, const struct node *node)
{
	for (int i = 0; i < e->terms; i++)
		if (e->term[i].node == node)
			return &e->term[i];
	return NULL;
}

static void add_term(const struct switching *s, struct switching_function *e, int segment, const struct compared *what,
		     mpq_srcptr at)
{
	struct comparing *term = MORE(e->term, e->terms);
	*term = (struct comparing){ .node = what->node, .seen = ARRAY(bool, s->segments) };
	term->seen[segment] = true;
	mpq_init(term->first);
	mpq_set(term->first, at);
}

static bool is_apart(const struct switching *s, const struct node *node)
{
	bool apart = false;
	for (int i = 0; i < s->aparts; i++)
		apart = apart || s->apart[i] == node;
	return apart;
}

/* Terms that were taken to compare one switching function do so in no longer: all begins anew, with this one by itself.
 * */
static void tear(struct switching *s, const struct node *node)
{
	*MORE(s->apart, s->aparts) = node;
	s->torn = true;
}

/* ---- from segment to segment ---- */

/* Is form what this switching function has become? */
static bool has_become(const struct switching_function *e, const struct form *form, mpq_ptr of)
{
	const unsigned moving = 1u << BASIS_COORD | 1u << BASIS_INPUT;
	const struct form *here = terms_of_kinds(form, moving), *there = terms_of_kinds(e->form, moving);
	mpq_set_ui(of, 1, 1);
	return here->terms == 0 ? there->terms == 0 : there->terms > 0 && is_form_multiple(here, there, of);
}

/* form + constant = of (e - at) */
static void find_at(const struct switching_function *e, int segment, const struct compared *what, mpq_srcptr of,
		    mpq_ptr at)
{
	mpq_div(at, what->constant, of);
	mpq_sub(at, e->shift[segment], at);
}

/* In this segment for the first time. A constant that is a part of the load now moves no breakpoint. */
static void follow(struct switching_function *e, const struct comparing *term, int segment, const struct compared *what,
		   mpq_srcptr of)
{
	RATIONAL at = ZERO, scale = ZERO;
	find_at(e, segment, what, of, at);
	mpq_sub(e->shift[segment], term->first, at);
	mpq_inv(scale, of);
	e->in[segment] = form_scale(what->form, scale);
}

/* ---- which switching function it is ---- */

static int met_before(const struct switching *s, int segment, const struct compared *what, mpq_ptr of)
{
	for (int i = 0; i < s->functions; i++) {
		const struct comparing *term = term_of(&s->function[i], what->node);
		if (term && term->seen[segment] && is_form_multiple(what->form, s->function[i].in[segment], of))
			return i;
	}
	return -1;
}

/* By a term of another segment */
static int met_elsewhere(struct switching *s, int segment, const struct compared *what, mpq_ptr of)
{
	RATIONAL at = ZERO;
	int found = -1;
	bool torn = false;
	for (int i = 0; i < s->functions && found < 0; i++) {
		struct switching_function *e = &s->function[i];
		struct comparing *term = term_of(e, what->node);
		if (!term || term->seen[segment] || !has_become(e, what->form, of))
			continue;
		if (!e->in[segment])
			follow(e, term, segment, what, of);
		find_at(e, segment, what, of, at);
		if (is_form_multiple(what->form, e->in[segment], of) && mpq_equal(at, term->first)) {
			found = i;
			term->seen[segment] = true;
		} else {
			torn = torn || !is_apart(s, what->node);
		}
	}
	if (found < 0 && torn)
		tear(s, what->node);
	return found;
}

/* That of another term */
static int met_by_others(struct switching *s, int segment, const struct compared *what, mpq_ptr of)
{
	RATIONAL at = ZERO;
	int found = -1;
	for (int i = 0; i < s->functions && found < 0 && !is_apart(s, what->node); i++) {
		struct switching_function *e = &s->function[i];
		const struct form *here = e->in[segment] ? e->in[segment] : e->form;
		if (is_apart(s, e->node) || term_of(e, what->node) || !is_form_multiple(what->form, here, of))
			continue;
		e->in[segment] = form_alias(here);
		find_at(e, segment, what, of, at);
		add_term(s, e, segment, what, at);
		found = i;
	}
	return found;
}

static int new_function(struct switching *s, int segment, const struct compared *what, mpq_ptr of)
{
	RATIONAL at = ZERO;
	mpq_set_ui(of, 1, 1);
	ENLARGE(s->function, (size_t)s->functions + 1);
	struct switching_function *e = &s->function[s->functions];
	*e = (struct switching_function){ .form = what->form,
				  .in = ARRAY(struct form *, s->segments),
				  .shift = rationals(s->segments),
				  .segments = s->segments,
				  .node = what->node,
				  .met = what->met };
	e->in[segment] = what->form;
	find_at(e, segment, what, of, at);
	add_term(s, e, segment, what, at);
	return s->functions++;
}

int find_switching_function(struct switching *s, int segment, const struct compared *what, mpq_ptr of, mpq_ptr at)
{
	int found = met_before(s, segment, what, of);
	if (found < 0)
		found = met_elsewhere(s, segment, what, of);
	if (found < 0)
		found = met_by_others(s, segment, what, of);
	if (found < 0)
		found = new_function(s, segment, what, of);
	find_at(&s->function[found], segment, what, of, at);
	return found;
}

struct form *form_in(const struct switching_function *e, int segment)
{
	return form_sum(e->in[segment], form_constant(e->shift[segment]), false);
}

void complete_switching_functions(struct switching *s)
{
	for (int i = 0; i < s->functions; i++) {
		struct switching_function *e = &s->function[i];
		int first = 0;
		while (!e->in[first])
			first++;
		for (int segment = 0; segment < s->segments; segment++) {
			int as = segment < first ? first : segment - 1;
			if (e->in[segment])
				continue;
			e->in[segment] = e->in[as];
			mpq_set(e->shift[segment], e->shift[as]);
		}
	}
}

/* ---- for a reader ---- */

static const char *text_in(const struct model *model, const struct switching_function *e, int segment)
{
	return form_text(model, form_in(e, segment));
}

static bool is_as_before(const struct switching_function *e, int segment)
{
	return mpq_equal(e->shift[segment], e->shift[segment - 1]) && same_form(e->in[segment], e->in[segment - 1]);
}

const char *text_of_function(const struct model *model, int index)
{
	enum { SHOWN = 3 };
	const struct switching_function *e = &model->switching->function[index];
	const char *text = e->segments > 1 ? text_in(model, e, 0) : form_text(model, e->form);
	int shown = 0;
	for (int s = 1; s < e->segments && shown <= SHOWN; s++)
		if (!is_as_before(e, s))
			text = shown++ == SHOWN ? format("%s; ...", text)
						: format("%s; from t = %s on %s", text,
							 readable_text(model->system.change[s - 1]),
							 text_in(model, e, s));
	return text;
}

int regions_at_once(const struct switching *s)
{
	return s->regions / s->segments;
}

int segment_of_region(const struct switching *s, int region)
{
	return region / regions_at_once(s);
}

int count_candidates(struct switching *s)
{
	const int limit = s->cached ? INT_MAX / s->segments : LIMIT_CANDIDATES;
	int count = 1;
	for (int i = 0; i < s->functions; i++) {
		s->function[i].stride = count;
		if (count > limit / (s->function[i].breaks + 1))
			return 0;
		count *= s->function[i].breaks + 1;
	}
	return count;
}
