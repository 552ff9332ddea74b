/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is not linear, as atoms: expressions over forms, each made once. A form may then hold atoms beside coordinates
 * and loads, so that linear terms are found, and remainders shared, wherever they stand. */
#include "collect/collect.h"

#include <string.h>

enum { BUCKETS = 4096, FLATTENED = 64 };

struct shared {                     /* an operand; equal ones are one object */
	const struct form *form;
	int index;
	struct shared *next;
};
struct atoms {
	int forms, count;
	struct shared *form[BUCKETS];
	struct atom *atom[BUCKETS];
	struct { int count; const struct form **given, **operand; } system; /* the last that was asked for */
};

struct atoms *atoms_new(void)
{
	return NEW(struct atoms);
}

int atoms_count(const struct atoms *atoms)
{
	return atoms->count;
}

/* ---- operands ---- */

static size_t mix(size_t hash, size_t value)
{
	return (hash ^ value) * 0x9e3779b97f4a7c15u;
}

static size_t form_hash(const struct form *form)
{
	size_t hash = (size_t)form->terms;
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		hash = mix(hash, (size_t)basis->kind * 8 + (size_t)basis->order * 2 + basis->sine);
		hash = mix(hash,
			   basis->forcing ? (size_t)basis->forcing->index * 64 + (size_t)basis->power
			   : (size_t)basis->index);
		hash = mix(hash, mpz_get_ui(mpq_numref(form->term[i].factor)) +
					 3 * mpz_get_ui(mpq_denref(form->term[i].factor)));
	}
	return (hash >> 20) % BUCKETS;
}

static const struct shared *share(struct collector *c, const struct form *form)
{
	struct shared **link = &c->atoms->form[form_hash(form)];
	for (; *link; link = &(*link)->next)
		if (same_form((*link)->form, form))
			return *link;
	*link = NEW(struct shared);
	**link = (struct shared){ form, c->atoms->forms++, NULL };
	return *link;
}

/* ---- atoms ---- */

/* What of two bases moves more readily: a coordinate, then an input */
const struct basis *moved_basis(const struct basis *known, const struct basis *basis)
{
	basis = basis->atom                                                ? basis->atom->moves
		: basis->kind == BASIS_COORD || basis->kind == BASIS_INPUT ? basis
									   : NULL;
	return !known || (basis && basis->kind == BASIS_COORD && known->kind != BASIS_COORD) ? basis : known;
}

static void add_dependence(const struct collector *c, struct atom *atom, const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		atom->time = atom->time || basis->kind == BASIS_FORCING || (basis->atom && basis->atom->time);
		atom->input = atom->input || basis->kind == BASIS_INPUT || (basis->atom && basis->atom->input);
		atom->state = atom->state || basis->kind == BASIS_COORD || (basis->atom && basis->atom->state);
		atom->velocity = atom->velocity || is_velocity(c->frame, basis);
		atom->params = atom->params || (basis->atom && basis->atom->params);
		atom->moves = moved_basis(atom->moves, basis);
		atom->highest = atom->highest || (basis->atom ? basis->atom->highest : is_highest(c->frame, basis));
	}
	if (atom->kind == ATOM_CALL && atom->function >= FN_FRICTION)
		atom->highest = false;
}

bool depends_on_time_only(const struct basis *basis)
{
	return basis->atom ? !basis->atom->input && !basis->atom->state : basis->kind <= BASIS_FORCING;
}

/* Highest derivatives are what the equations are solved for: inside they stand in equations alone, whose other factors
 * may be of the state, and as the velocity of friction where there is no mass. */
static void check_highest(const struct collector *c, const struct node *node, const struct form *form, bool params,
			  bool slides)
{
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		const bool allowed = c->output || (c->equation && keeps(c)) || (slides && basis->order == 1);
		if (!allowed && is_highest(c->frame, basis))
			not_linear(c, node, params ? "has a tunable factor, by which the equation can be divided"
						   : "is not linear");
	}
}

struct form *time_part(const struct form *form, bool atoms)
{
	struct form *part = NEW(struct form);
	for (int i = 0; i < form->terms; i++)
		if (depends_on_time_only(&form->term[i].basis) && (!atoms || form->term[i].basis.kind == BASIS_ATOM))
			form_add_basis(part, form->term[i].basis, form->term[i].factor);
	return part;
}

static bool same_atom(const struct atom *a, const struct atom *b)
{
	if (a->kind != b->kind || a->function != b->function || a->comparison != b->comparison ||
	    a->operands != b->operands || a->param != b->param || a->component != b->component)
		return false;
	if (a->operand == b->operand && a->exponent == b->exponent)
		return true;
	for (int i = 0; i < a->operands; i++)
		if (a->operand[i] != b->operand[i] || (a->exponent && a->exponent[i] != b->exponent[i]))
			return false;
	return true;
}

static struct form *form_of_atom(struct collector *c, const struct node *node, struct atom wanted)
{
	enum { HASHED = 64 };           /* operands: the first of them tell most atoms apart */
	size_t hash = (size_t)wanted.kind * 64 + wanted.function + (size_t)wanted.component * 1024;
	for (int i = 0; i < wanted.operands && i < HASHED; i++)
		hash = mix(hash, form_hash(wanted.operand[i]) + (wanted.exponent ? wanted.exponent[i] : 0));
	struct atom **link = &c->atoms->atom[(hash >> 20) % BUCKETS];
	while (*link && !same_atom(*link, &wanted))
		link = &(*link)->next;
	if (!*link) {
		for (int i = 0; i < wanted.operands; i++)
			add_dependence(c, &wanted, wanted.operand[i]);
		for (int i = 0; i < wanted.operands; i++)
			check_highest(c, node, wanted.operand[i], wanted.params,
				      i == 0 && wanted.kind == ATOM_CALL && wanted.function == FN_FRICTION);
		wanted.node = node;
		wanted.params = wanted.params || wanted.kind == ATOM_PARAM;
		wanted.index = c->atoms->count++;
		wanted.judged = NEW(struct verdict);
		*link = NEW(struct atom);
		**link = wanted;
	}
	return form_unit((struct basis){ .kind = BASIS_ATOM, .index = (*link)->index, .atom = *link });
}

static const struct form **shared(struct collector *c, int count, const struct form *const *operand)
{
	const struct form **list = ARRAY(const struct form *, count);
	for (int i = 0; i < count; i++)
		list[i] = share(c, operand[i])->form;
	return list;
}

static struct form *new_atom(struct collector *c, const struct node *node, struct atom wanted, int count,
			     const struct form *const *operand)
{
	wanted.operands = count;
	wanted.operand = shared(c, count, operand);
	return form_of_atom(c, node, wanted);
}

/* One after the other are asked for all components of a system, whose n (n + 1) operands they share. */
struct form *kept_component(struct collector *c, const struct node *node, struct atom wanted, int count,
			    const struct form *const *operand)
{
	struct atoms *atoms = c->atoms;
	const size_t size = (size_t)count * sizeof *operand;
	if (atoms->system.count != count || memcmp(atoms->system.given, operand, size) != 0) {
		ENLARGE(atoms->system.given, (size_t)count);
		memcpy(atoms->system.given, operand, size);
		atoms->system.count = count;
		atoms->system.operand = shared(c, count, operand);
	}
	wanted.operands = count;
	wanted.operand = atoms->system.operand;
	return form_of_atom(c, node, wanted);
}

struct form *kept_param(struct collector *c, const struct node *node, const struct symbol *param)
{
	return form_of_atom(c, node, (struct atom){ .kind = ATOM_PARAM, .param = param });
}

bool reads_params(const struct form *form)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.atom && form->term[i].basis.atom->params)
			return true;
	return false;
}

/* ---- products: a rational times powers of shared forms, sorted ---- */

struct monomial {
	mpq_t factor;
	int count;
	const struct shared **base;
	unsigned *exponent;
};

static void monomial_init(struct monomial *m)
{
	*m = (struct monomial){ .count = 0 };
	mpq_init(m->factor);
	mpq_set_ui(m->factor, 1, 1);
}

static void check_exponent(const struct node *node, unsigned long exponent)
{
	if (exponent > LIMIT_EXPONENT)
		error(node->at, NULL, "power beyond the limit of %d", LIMIT_EXPONENT);
}

/* The factors of a product join another while their powers stay small. */
static bool flattens(const struct atom *product, unsigned exponent)
{
	for (int i = 0; i < product->operands; i++)
		if (exponent > FLATTENED / product->exponent[i])
			return false;
	return true;
}

/* m->factor *= factor^exponent */
static void multiply_factor(const struct node *node, struct monomial *m, mpq_srcptr factor, unsigned exponent)
{
	RATIONAL power = ZERO, whole = RATIO((long)exponent, 1);
	constant_power(node->at, factor, whole, power);
	mpq_mul(m->factor, m->factor, power);
}

static void multiply_base(const struct node *node, struct monomial *m, const struct shared *base, unsigned exponent)
{
	int at = 0;
	while (at < m->count && m->base[at]->index < base->index)
		at++;
	if (at < m->count && m->base[at] == base) {
		check_exponent(node, (unsigned long)m->exponent[at] + exponent);
		m->exponent[at] += exponent;
		return;
	}
	ENLARGE(m->base, (size_t)m->count + 1);
	ENLARGE(m->exponent, (size_t)m->count + 1);
	memmove(m->base + at + 1, m->base + at, (size_t)(m->count - at) * sizeof *m->base);
	memmove(m->exponent + at + 1, m->exponent + at, (size_t)(m->count - at) * sizeof *m->exponent);
	m->base[at] = base;
	m->exponent[at] = exponent;
	m->count++;
}

/* A single term brings its factor and the factors of its own product; a sum is a base, with its first term positive. */
static void multiply_form(struct collector *c, const struct node *node, struct monomial *m, const struct form *form,
			  unsigned exponent)
{
	const struct atom *atom = form->terms == 1 ? form->term[0].basis.atom : NULL;
	mpq_srcptr first = form->term[0].factor;
	RATIONAL unit = ZERO;
	mpq_set_si(unit, mpq_sgn(first), 1);
	multiply_factor(node, m, form->terms == 1 ? first : unit, exponent);
	if (atom && atom->kind == ATOM_PRODUCT && flattens(atom, exponent))
		for (int i = 0; i < atom->operands; i++)
			multiply_form(c, node, m, atom->operand[i], exponent * atom->exponent[i]);
	else if (form->terms == 1)
		multiply_base(node, m, share(c, form_unit(form->term[0].basis)), exponent);
	else
		multiply_base(node, m, share(c, form_scale(form, unit)), exponent);
}

bool is_friction(const struct atom *atom)
{
	return atom && atom->kind == ATOM_CALL && atom->function == FN_FRICTION;
}

bool is_of_time(const struct form *form)
{
	for (int i = 0; i < form->terms; i++)
		if (!depends_on_time_only(&form->term[i].basis))
			return false;
	return true;
}

static struct form *form_of_powers(struct collector *c, const struct node *node, int count, const struct shared **base,
				   unsigned *exponent)
{
	if (count == 1 && exponent[0] == 1)
		return form_sum(base[0]->form, NEW(struct form), false);
	struct atom atom = { .kind = ATOM_PRODUCT,
			     .operands = count,
			     .operand = ARRAY(const struct form *, count),
			     .exponent = exponent };
	for (int i = 0; i < count; i++)
		atom.operand[i] = base[i]->form;
	return form_of_atom(c, node, atom);
}

/* The powers of time make an atom of their own, so that products that share it compute it once. */
static struct form *form_of_monomial(struct collector *c, const struct node *node, const struct monomial *m)
{
	struct monomial time, rest;
	monomial_init(&time);
	monomial_init(&rest);
	for (int i = 0; i < m->count; i++)
		multiply_base(node, is_of_time(m->base[i]->form) ? &time : &rest, m->base[i], m->exponent[i]);
	if (time.count > 0 && rest.count > 0)
		multiply_base(node, &rest, share(c, form_of_powers(c, node, time.count, time.base, time.exponent)), 1);
	struct monomial *all = rest.count ? &rest : &time;
	struct form *form = form_scale(form_of_powers(c, node, all->count, all->base, all->exponent), m->factor);
	check_form(node->at, form);
	mpq_clears(time.factor, rest.factor, NULL);
	return form;
}

static struct form *whole_product(struct collector *c, const struct node *node, const struct form *a, unsigned n,
				  const struct form *b)
{
	struct monomial m;
	monomial_init(&m);
	multiply_form(c, node, &m, a, n);
	if (b)
		multiply_form(c, node, &m, b, 1);
	struct form *form = form_of_monomial(c, node, &m);
	mpq_clear(m.factor);
	return form;
}

struct form *kept_others(struct collector *c, const struct node *node, const struct atom *product, int factor)
{
	struct monomial m;
	monomial_init(&m);
	for (int i = 0; i < product->operands; i++)
		if (product->exponent[i] > (i == factor))
			multiply_form(c, node, &m, product->operand[i], product->exponent[i] - (i == factor));
	struct form *form = form_of_monomial(c, node, &m);
	mpq_clear(m.factor);
	return form;
}

/* Terms of constants, of time alone, and the rest, in this order of sorts. */
struct parts { struct form *constant, *time, *rest; };

static struct parts parts_of(const struct collector *c, const struct form *form)
{
	struct parts parts = { NEW(struct form), NEW(struct form), NEW(struct form) };
	for (int i = 0; i < form->terms; i++) {
		const struct form_term *term = &form->term[i];
		bool time = term->basis.kind == BASIS_FORCING || (c->whole_time && depends_on_time_only(&term->basis));
		struct form **part = term->basis.kind <= BASIS_PI ? &parts.constant : time ? &parts.time : &parts.rest;
		form_add_basis(*part, term->basis, term->factor);
	}
	return parts;
}

struct form *kept_product(struct collector *c, const struct node *node, const struct form *a, const struct form *b)
{
	if (is_constant(a) || is_constant(b))
		return form_product(c, a, b);
	struct parts x = parts_of(c, a), y = parts_of(c, b);
	const struct form *moving_a = form_sum(a, x.constant, true), *moving_b = form_sum(b, y.constant, true);
	struct form *sum = form_sum(form_product(c, x.constant, b), form_product(c, moving_a, y.constant), false);
	if (x.time->terms && y.time->terms)
		sum = form_sum(sum,
			       (c->whole_time ? whole_product(c, node, x.time, 1, y.time)
					      : load_product(c, x.time, y.time)),
			       false);
	if (x.time->terms && y.rest->terms)
		sum = form_sum(sum, whole_product(c, node, x.time, 1, y.rest), false);
	if (x.rest->terms)
		sum = form_sum(sum, whole_product(c, node, x.rest, 1, moving_b), false);
	return sum;
}

/* What a linear core without the remainder carries, in one interval of time */
static bool is_load(const struct collector *c, const struct form *form)
{
	return !c->whole_time && is_of_time(form) && time_part(form, true)->terms == 0;
}

struct form *unexpanded_product(struct collector *c, const struct node *node, const struct form *a,
				const struct form *b)
{
	const bool expands = is_constant(a) || is_constant(b) || (is_load(c, a) && is_load(c, b));
	return expands ? kept_product(c, node, a, b) : whole_product(c, node, a, 1, b);
}

/* ---- the others ---- */

struct form *kept_reciprocal(struct collector *c, const struct node *node, const struct form *x)
{
	RATIONAL value = ZERO;
	struct form *form;
	if (is_constant(x)) {
		constant_value(c, x, value);
		if (mpq_sgn(value) == 0)
			error(node->at, NULL, "division by zero");
		mpq_inv(value, value);
		form = form_constant(value);
	} else if (x->terms == 1) {             /* 1/(2 x) = 0.5 (1/x) */
		const struct form *unit = form_unit(x->term[0].basis);
		mpq_inv(value, x->term[0].factor);
		form = form_scale(new_atom(c, node, (struct atom){ .kind = ATOM_RECIPROCAL }, 1, &unit), value);
	} else {
		form = new_atom(c, node, (struct atom){ .kind = ATOM_RECIPROCAL }, 1, &x);
	}
	return form;
}

static struct form *constant_to_power(struct collector *c, const struct node *node, const struct form *base,
				      mpq_srcptr exponent)
{
	RATIONAL value = ZERO;
	constant_value(c, base, value);
	if (!constant_power(node->at, value, exponent, value))
		met_irrational(c, &c->irrationals.root);
	struct form *form = form_constant(value);
	check_form(node->at, form);
	return form;
}

/* Of loads that the linear core carries: multiplied out */
static struct form *load_power(struct collector *c, const struct node *node, const struct form *x, unsigned n)
{
	struct form *form = form_unit((struct basis){ .kind = BASIS_ONE });
	for (unsigned k = 0; k < n; k++)
		form = kept_product(c, node, form, x);
	return form;
}

struct form *kept_whole_power(struct collector *c, const struct node *node, const struct form *x, unsigned n)
{
	RATIONAL exponent = RATIO((long)n, 1);
	bool load = n <= LIMIT_LOAD_POWER && is_load(c, x);
	return is_constant(x) ? constant_to_power(c, node, x, exponent)
	       : n == 0       ? form_unit((struct basis){ .kind = BASIS_ONE })
	       : load         ? load_power(c, node, x, n)
			      : whole_product(c, node, x, n, NULL);
}

struct form *kept_power(struct collector *c, const struct node *node, const struct form *base,
			const struct form *exponent)
{
	const struct form *operand[] = { base, exponent };
	if (!is_constant(exponent))
		return new_atom(c, node, (struct atom){ .kind = ATOM_POWER }, 2, operand);
	RATIONAL e = ZERO;
	constant_value(c, exponent, e);
	bool whole = mpz_cmp_ui(mpq_denref(e), 1) == 0 && mpz_cmpabs_ui(mpq_numref(e), LIMIT_EXPONENT) <= 0;
	struct form *form;
	if (is_constant(base)) {
		form = constant_to_power(c, node, base, e);
	} else if (whole) {
		form = kept_whole_power(c, node, base, (unsigned)mpz_get_ui(mpq_numref(e)));    /* its size */
		form = mpq_sgn(e) < 0 ? kept_reciprocal(c, node, form) : form;
	} else {
		form = new_atom(c, node, (struct atom){ .kind = ATOM_POWER }, 2, operand);
	}
	return form;
}

static bool all_constant(int count, struct form *const *x)
{
	for (int i = 0; i < count; i++)
		if (!is_constant(x[i]))
			return false;
	return true;
}

const struct node *call_at(const struct node *node, enum function function, int count)
{
	struct node *call = NEW(struct node);
	*call = *node;
	call->function = function;
	if (call->children < count || call->kind != NODE_CALL) {
		call->child = ARRAY(struct node *, count);
		struct node *place = NEW(struct node);
		*place = *node;
		for (int i = 0; i < count; i++)
			call->child[i] = place;
	}
	call->kind = NODE_CALL;
	call->children = count;
	return call;
}

struct form *kept_call(struct collector *c, const struct node *node, enum function function, int count,
		       struct form *const *x)
{
	bool single = function < FN_ATAN2;
	if (all_constant(count, x) || (!single && function != FN_ATAN2 && is_decided(c, count, x)))
		return single ? constant_call(c, node, function, x[0])
			      : piecewise(c, call_at(node, function, count), x);
	if (function >= FN_DEADZONE && function < FN_FRICTION)
		check_breakpoints(c, node, x);
	return new_atom(c, node, (struct atom){ .kind = ATOM_CALL, .function = function }, count,
			(const struct form *const *)x);
}

struct form *kept_comparison(struct collector *c, const struct node *node, enum comparison comparison,
			     const struct form *a, const struct form *b)
{
	struct form *difference = form_sum(a, b, true);
	const struct form *operand[] = { a, b };
	if (!is_decided(c, 1, &difference))
		return new_atom(c, node, (struct atom){ .kind = ATOM_COMPARE, .comparison = comparison }, 2, operand);
	RATIONAL value = ZERO;
	mpq_set_ui(value, compare_values(comparison, order_now(c, node, difference, NEW(struct form))), 1);
	return form_constant(value);
}

struct form *unexpanded_choice(struct collector *c, const struct node *node, const struct form *condition,
			       const struct form *a, const struct form *b)
{
	const struct form *operand[] = { condition, a, b };
	return is_constant(condition) ? kept_choice(c, node, condition, a, b)
				      : new_atom(c, node, (struct atom){ .kind = ATOM_CHOOSE }, 3, operand);
}

struct form *kept_choice(struct collector *c, const struct node *node, const struct form *condition,
			 const struct form *a, const struct form *b)
{
	if (is_constant(condition) || same_form(a, b)) {
		RATIONAL value = ZERO;
		bool first = true;
		if (is_constant(condition)) {
			constant_value(c, condition, value);
			first = mpq_sgn(value) != 0;
		}
		return form_sum(first ? a : b, NEW(struct form), false);
	}
	return unexpanded_choice(c, node, condition, a, b);
}
