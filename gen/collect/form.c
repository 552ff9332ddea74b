/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forms: sums of rational factors times basis elements: 1, pi, forcing terms (t^k e^{at} cos or sin), inputs,
 * coordinates and their derivatives. pi stays a basis element until it meets another factor: quarter turns are decided
 * exactly. */
#include "collect/collect.h"

#include <string.h>

int basis_order(const struct basis *a, const struct basis *b)
{
	if (a->kind != b->kind)
		return (int)a->kind - (int)b->kind;
	if (a->kind != BASIS_FORCING)
		return a->index != b->index ? a->index - b->index : a->order - b->order;
	if (a->forcing != b->forcing)
		return a->forcing->index - b->forcing->index;
	return a->power != b->power ? a->power - b->power : (int)a->sine - (int)b->sine;
}

/* Inside of an atom once: solutions of many equations have their n^2 factors in common. */
static void list_terms(const struct form *form, bool inside, bool *seen, int *count, const struct form_term ***list)
{
	for (int i = 0; form && i < form->terms; i++) {
		const struct atom *atom = form->term[i].basis.atom;
		const bool known = atom && seen[atom->index];
		if (!known || !inside)
			*MORE(*list, *count) = &form->term[i];
		if (!atom || known)
			continue;
		seen[atom->index] = true;
		for (int k = 0; k < atom->operands; k++)
			list_terms(atom->operand[k], true, seen, count, list);
	}
}

const struct form_term **terms_within(const struct form *form, bool *seen)
{
	const struct form_term **list = NULL;
	int count = 0;
	list_terms(form, false, seen, &count, &list);
	*MORE(list, count) = NULL;
	return list;
}

struct form *form_single(struct basis basis, mpq_srcptr factor)
{
	struct form *form = NEW(struct form);
	if (mpq_sgn(factor) == 0)
		return form;
	form->terms = 1;
	form->term = ARRAY(struct form_term, 1);
	form->term[0].basis = basis;
	mpq_init(form->term[0].factor);
	mpq_set(form->term[0].factor, factor);
	return form;
}

struct form *form_alias(const struct form *form)
{
	struct form *alias = NEW(struct form);
	*alias = *form;
	return alias;
}

struct form *form_constant(mpq_srcptr value)
{
	return form_single((struct basis){ .kind = BASIS_ONE }, value);
}

struct form *form_number(long value)
{
	RATIONAL q = RATIO(value, 1);
	return form_constant(q);
}

struct form *form_unit(struct basis basis)
{
	RATIONAL one = RATIO(1, 1);
	return form_single(basis, one);
}

/* a + factor * b, merged in basis order */
static struct form *form_add(const struct form *a, const struct form *b, mpq_srcptr factor)
{
	struct form *sum = NEW(struct form);
	sum->term = ARRAY(struct form_term, (size_t)(a->terms + b->terms));
	spend_terms((size_t)(a->terms + b->terms));
	for (int i = 0, j = 0; i < a->terms || j < b->terms;) {
		int order = i == a->terms ? 1 : j == b->terms ? -1 : basis_order(&a->term[i].basis, &b->term[j].basis);
		struct form_term *term = &sum->term[sum->terms];
		term->basis = order <= 0 ? a->term[i].basis : b->term[j].basis;
		mpq_init(term->factor);
		if (order <= 0)
			mpq_set(term->factor, a->term[i++].factor);
		if (order >= 0)
			rational_addmul(term->factor, b->term[j++].factor, factor);
		if (mpq_sgn(term->factor) != 0)
			sum->terms++;
		else
			mpq_clear(term->factor);
	}
	return sum;
}

/* Where the basis stands in a form, or would */
static int find_place(const struct form *form, const struct basis *basis, bool *found)
{
	int low = 0, high = form->terms;
	*found = false;
	while (low < high && !*found) {
		int middle = low + (high - low) / 2, order = basis_order(&form->term[middle].basis, basis);
		*found = order == 0;
		low = order < 0 ? middle + 1 : order == 0 ? middle : low;
		high = order > 0 ? middle : high;
	}
	return low;
}

bool holds_atom(const struct form *form)
{
	return form->terms > 0 && form->term[form->terms - 1].basis.kind == BASIS_ATOM;
}

const struct form_term *form_find(const struct form *form, const struct basis *basis)
{
	bool found;
	int at = find_place(form, basis, &found);
	return found ? &form->term[at] : NULL;
}

static void make_room(struct form *sum, int more)
{
	if (sum->terms + more <= sum->room)
		return;
	sum->room = 2 * sum->terms + more;
	ENLARGE(sum->term, (size_t)sum->room);
}

static void add_factor(mpq_ptr sum, mpq_srcptr value, mpq_srcptr factor)
{
	if (!factor) {
		mpq_add(sum, sum, value);
		return;
	}
	rational_addmul(sum, value, factor);
}

static void insert_term(struct form *sum, const struct form_term *term, mpq_srcptr factor)
{
	bool found;
	int at = find_place(sum, &term->basis, &found);
	if (!found) {
		make_room(sum, 1);
		memmove(sum->term + at + 1, sum->term + at, (size_t)(sum->terms - at) * sizeof *sum->term);
		sum->term[at].basis = term->basis;
		mpq_init(sum->term[at].factor);
		sum->terms++;
	}
	add_factor(sum->term[at].factor, term->factor, factor);
	if (mpq_sgn(sum->term[at].factor) != 0)
		return;
	mpq_clear(sum->term[at].factor);
	sum->terms--;
	memmove(sum->term + at, sum->term + at + 1, (size_t)(sum->terms - at) * sizeof *sum->term);
}

/* All at once, into a new list */
static void merge_terms(struct form *sum, const struct form *part, mpq_srcptr factor)
{
	struct form merged = { 0, ARRAY(struct form_term, (size_t)(sum->terms + part->terms)),
			       sum->terms + part->terms };
	spend_terms((size_t)sum->terms / 4);
	for (int i = 0, j = 0; i < sum->terms || j < part->terms;) {
		int order = i == sum->terms    ? 1
			    : j == part->terms ? -1
					       : basis_order(&sum->term[i].basis, &part->term[j].basis);
		struct form_term *term = &merged.term[merged.terms];
		if (order <= 0) {
			*term = sum->term[i++];
		} else {
			term->basis = part->term[j].basis;
			mpq_init(term->factor);
		}
		if (order >= 0)
			add_factor(term->factor, part->term[j++].factor, factor);
		if (mpq_sgn(term->factor) != 0)
			merged.terms++;
		else
			mpq_clear(term->factor);
	}
	discard(sum->term);
	*sum = merged;
}

void form_add_to(struct form *sum, const struct form *part, mpq_srcptr factor)
{
	enum { SINGLY = 8 };
	spend_terms((size_t)part->terms);
	if (factor && mpq_sgn(factor) == 0)
		return;
	if (part->terms > SINGLY) {
		merge_terms(sum, part, factor);
		return;
	}
	for (int i = 0; i < part->terms; i++)
		insert_term(sum, &part->term[i], factor);
}

void form_add_basis(struct form *sum, struct basis basis, mpq_srcptr factor)
{
	struct form_term term = { .basis = basis };
	if (mpq_sgn(factor) == 0)
		return;
	term.factor[0] = factor[0];             /* read only */
	insert_term(sum, &term, NULL);
	spend_terms(1);
}

void form_free(struct form *form)
{
	for (int i = 0; i < form->terms; i++)
		mpq_clear(form->term[i].factor);
	discard(form->term);
	discard(form);
}

struct form *form_sum(const struct form *a, const struct form *b, bool subtract)
{
	RATIONAL sign = ZERO;
	mpq_set_si(sign, subtract ? -1 : 1, 1);
	return form_add(a, b, sign);
}

struct form *form_difference(const struct form *a, const struct form *b)
{
	return form_sum(a, b, true);
}

struct form *form_scale(const struct form *a, mpq_srcptr factor)
{
	static const struct form zero;
	return form_add(&zero, a, factor);
}

bool is_constant(const struct form *form)
{
	return form->terms == 0 || form->term[form->terms - 1].basis.kind <= BASIS_PI;
}

mpq_srcptr factor_of(const struct form *form, enum basis_kind kind)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == kind)
			return form->term[i].factor;
	return NULL;
}

void met_irrational(struct collector *c, bool *which)
{
	*which = true;
	c->irrational_count++;
}

void constant_value(struct collector *c, const struct form *form, mpq_ptr value)
{
	RATIONAL sum = ZERO;
	mpq_srcptr one = factor_of(form, BASIS_ONE), pi = factor_of(form, BASIS_PI);
	if (pi) {
		constant_pi(sum);
		mpq_mul(sum, sum, pi);
		met_irrational(c, &c->irrationals.pi);
	}
	if (one)
		mpq_add(sum, sum, one);
	mpq_set(value, sum);
}

/* a * b, one of them constant. Products with pi keep it symbolic only beside a plain number. */
struct form *form_product(struct collector *c, const struct form *a, const struct form *b)
{
	const struct form *constant = is_constant(a) ? a : b, *other = is_constant(a) ? b : a;
	mpq_srcptr plain = factor_of(constant, BASIS_ONE);
	bool only_plain = !factor_of(constant, BASIS_PI);
	RATIONAL value = ZERO;
	if (only_plain && plain) {
		mpq_set(value, plain);
	} else if (is_constant(other) && !factor_of(other, BASIS_PI)) {
		struct form *swapped = form_scale(constant, other->terms ? other->term[0].factor : value);
		return swapped;
	} else {
		constant_value(c, constant, value);
	}
	return form_scale(other, value);
}

void check_form(struct place at, const struct form *form)
{
	for (int i = 0; i < form->terms; i++)
		check_bits(at, form->term[i].factor);
}

bool same_in_states(const struct form *a, const struct form *b)
{
	int i = 0, j = 0;
	while (i < a->terms && a->term[i].basis.kind < BASIS_INPUT)
		i++;
	while (j < b->terms && b->term[j].basis.kind < BASIS_INPUT)
		j++;
	const struct form left = { a->terms - i, a->term + i, 0 }, right = { b->terms - j, b->term + j, 0 };
	return same_form(&left, &right);
}

bool same_form(const struct form *a, const struct form *b)
{
	if (a->terms != b->terms)
		return false;
	for (int i = 0; i < a->terms; i++)
		if (basis_order(&a->term[i].basis, &b->term[i].basis) != 0 ||
		    !mpq_equal(a->term[i].factor, b->term[i].factor))
			return false;
	return true;
}

struct basis multiplier_basis(const struct frame *frame, int constraint)
{
	return (struct basis){ .kind = BASIS_COORD, .index = frame->coords + constraint, .order = 2 };
}

bool is_highest(const struct frame *frame, const struct basis *basis)
{
	return basis->kind == BASIS_COORD && basis->order > 0 && basis->order >= frame->coord[basis->index]->highest;
}

bool is_velocity(const struct frame *frame, const struct basis *basis)
{
	return basis->atom
		       ? basis->atom->velocity
		       : basis->kind == BASIS_COORD && (basis->order > 0 || frame->coord[basis->index]->highest == 1);
}

struct form *coordinate_form(const struct frame *frame, int coord, int order)
{
	if (frame && frame->form)
		return frame->form[order][coord];
	return form_unit((struct basis){ .kind = BASIS_COORD, .index = coord, .order = order });
}

bool has_coordinate(const struct form *form)
{
	return form->terms > 0 && form->term[form->terms - 1].basis.kind >= BASIS_COORD;
}

struct form *terms_of_kinds(const struct form *form, unsigned kinds)
{
	struct form *part = NEW(struct form);
	for (int i = 0; i < form->terms; i++)
		if (kinds >> form->term[i].basis.kind & 1)
			form_add_basis(part, form->term[i].basis, form->term[i].factor);
	return part;
}

struct form constant_terms(const struct form *form)
{
	struct form plain = { 0, form->term, 0 };
	while (plain.terms < form->terms && form->term[plain.terms].basis.kind <= BASIS_PI)
		plain.terms++;
	return plain;
}
