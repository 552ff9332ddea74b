/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives of forms with respect to a state, and forms at a point: what a Jacobian is made of. */
#include "collect/collect.h"

#include <math.h>

/* ---- derivatives ---- */

struct differentiation {
	struct collector *c;
	enum basis_kind kind;       /* BASIS_COORD, or BASIS_INPUT: */
	int index, order;           /* what it is by */
	const struct form *by;      /* or by this, an operand of the atom */
	/* or in time, of which this is the derivative of a term that is no atom */
	struct form *(*rate)(void *context, const struct form_term *term);
	void *context;
	bool held;                  /* highest derivatives are constant */
	struct form **known;        /* per atom: its derivative, once found */
	int count;
	int systems;                /* of linear equations: those of the derivatives, for all components */
	struct { const struct atom *atom; struct linear_system solved; } *system;
};

static struct form *derive(struct differentiation *d, const struct form *form);

static struct form *sum(const struct form *a, const struct form *b)
{
	return form_sum(a, b, false);
}

/* sum over the factors: e f^{e-1} f' times the others */
static struct form *derive_product(struct differentiation *d, const struct atom *a)
{
	enum { MANY = 16 };
	struct collector *c = d->c;
	struct form *total = NEW(struct form);
	for (int i = 0; i < a->operands; i++) {
		struct form *term = derive(d, a->operand[i]);
		if (term->terms == 0)
			continue;
		if (a->operands > MANY)         /* one by one they would be as many products as there are pairs */
			term = kept_product(c, a->node, term, kept_others(c, a->node, a, i));
		for (int j = 0; j < a->operands && a->operands <= MANY; j++)
			term = kept_product(c, a->node, term,
					    kept_whole_power(c, a->node, a->operand[j], a->exponent[j] - (j == i)));
		total = sum(total, kept_product(c, a->node, form_number((long)a->exponent[i]), term));
	}
	return total;
}

/* (b^e)' = e b^{e-1} b', and b^e log(b) e' where e moves too */
static struct form *derive_power(struct differentiation *d, const struct atom *a, const struct form *itself)
{
	struct collector *c = d->c;
	const struct form *base = a->operand[0], *exponent = a->operand[1];
	struct form *outer = derive(d, base), *inner = derive(d, exponent), *total = NEW(struct form);
	if (outer->terms) {
		struct form *lower = kept_power(c, a->node, base, form_difference(exponent, form_number(1)));
		total = kept_product(c, a->node, kept_product(c, a->node, exponent, lower), outer);
	}
	if (inner->terms) {
		struct form *log = kept_call(c, a->node, FN_LOG, 1, (struct form *[]){ sum(base, form_number(0)) });
		total = sum(total, kept_product(c, a->node, kept_product(c, a->node, itself, log), inner));
	}
	return total;
}

/* f'(x) of a function of one argument; `y` is f(x) */
static struct form *slope_of_function(struct collector *c, const struct atom *a, struct form *x, const struct form *y)
{
	const struct node *node = a->node;
	struct form *one = form_number(1), *square;
	switch (a->function) {
	case FN_SIN:  return kept_call(c, node, FN_COS, 1, &x);
	case FN_COS:  return form_difference(form_number(0), kept_call(c, node, FN_SIN, 1, &x));
	case FN_TAN:  return sum(one, kept_product(c, node, y, y));
	case FN_EXP:  return sum(y, form_number(0));
	case FN_LOG:  return kept_reciprocal(c, node, x);
	case FN_SQRT: return kept_reciprocal(c, node, kept_product(c, node, form_number(2), y));
	case FN_ABS:  return kept_call(c, node, FN_SGN, 1, &x);
	case FN_SINH: return kept_call(c, node, FN_COSH, 1, &x);
	case FN_COSH: return kept_call(c, node, FN_SINH, 1, &x);
	case FN_TANH: return form_difference(one, kept_product(c, node, y, y));
	case FN_ASIN:
	case FN_ACOS:
		square = form_difference(one, kept_product(c, node, x, x));
		square = kept_reciprocal(c, node, kept_call(c, node, FN_SQRT, 1, &square));
		return a->function == FN_ASIN ? square : form_difference(form_number(0), square);
	case FN_ATAN: return kept_reciprocal(c, node, sum(one, kept_product(c, node, x, x)));
	default:      return NEW(struct form);      /* sgn */
	}
}

/* (y' x - x' y)/(x^2 + y^2) */
static struct form *derive_angle(struct differentiation *d, const struct atom *a)
{
	struct collector *c = d->c;
	const struct form *y = a->operand[0], *x = a->operand[1];
	struct form *turning =
		form_difference(kept_product(c, a->node, derive(d, y), x), kept_product(c, a->node, derive(d, x), y));
	struct form *square = sum(kept_product(c, a->node, x, x), kept_product(c, a->node, y, y));
	return kept_product(c, a->node, turning, kept_reciprocal(c, a->node, square));
}

/* min(a, b, ...): the derivative of the least so far */
static struct form *derive_extreme(struct differentiation *d, const struct atom *a)
{
	struct collector *c = d->c;
	const struct form *best = a->operand[0];
	struct form *slope = derive(d, best);
	for (int i = 1; i < a->operands; i++) {
		struct form *better =
			kept_comparison(c, a->node, a->function == FN_MIN ? CMP_LT : CMP_GT, a->operand[i], best);
		slope = kept_choice(c, a->node, better, derive(d, a->operand[i]), slope);
		best = kept_choice(c, a->node, better, a->operand[i], best);
	}
	return slope;
}

static struct form *derive_clipped(struct differentiation *d, const struct atom *a)
{
	struct collector *c = d->c;
	const struct form *x = a->operand[0], *low = a->operand[1], *high = a->operand[2];
	struct form *inside = derive(d, x), *below = derive(d, low), *above = derive(d, high);
	if (a->function == FN_DEADZONE) {
		below = form_difference(inside, below);
		above = form_difference(inside, above);
		inside = NEW(struct form);
	}
	struct form *rest = kept_choice(c, a->node, kept_comparison(c, a->node, CMP_GT, x, high), above, inside);
	return kept_choice(c, a->node, kept_comparison(c, a->node, CMP_LT, x, low), below, rest);
}

/* The slope of the piece that holds x, from the last piece to the first */
static struct form *derive_table(struct differentiation *d, const struct atom *a)
{
	struct collector *c = d->c;
	struct form *slope = NULL;
	for (int k = a->operands - 4; k >= 1; k -= 2) {
		struct form *width = form_difference(a->operand[k + 2], a->operand[k]),
			    *rise = form_difference(a->operand[k + 3], a->operand[k + 1]);
		struct form *here = kept_product(c, a->node, rise, kept_reciprocal(c, a->node, width));
		slope = !slope ? here
			       : kept_choice(c, a->node,
					     kept_comparison(c, a->node, CMP_LT, a->operand[0], a->operand[k + 2]),
					     here, slope);
	}
	return kept_product(c, a->node, slope, derive(d, a->operand[0]));
}

static struct form *derive_call(struct differentiation *d, const struct atom *a, const struct form *itself)
{
	struct form *x = form_alias(a->operand[0]);
	switch (a->function) {
	case FN_ATAN2:    return derive_angle(d, a);
	case FN_MIN:
	case FN_MAX:      return derive_extreme(d, a);
	case FN_DEADZONE:
	case FN_CLIP:     return derive_clipped(d, a);
	case FN_TABLE:    return derive_table(d, a);
	default:
		return kept_product(d->c, a->node, slope_of_function(d->c, a, x, itself), derive(d, a->operand[0]));
	}
}

static struct form *derive_reciprocal(struct differentiation *d, const struct atom *a, const struct form *itself)
{
	struct form *slope = derive(d, a->operand[0]), *square = kept_product(d->c, a->node, itself, itself);
	return form_difference(form_number(0), kept_product(d->c, a->node, square, slope));
}

/* f' - M' x */
static const struct form **right_of_solution(struct differentiation *d, const struct atom *a)
{
	struct collector *c = d->c;
	const struct linear_system e = system_of(a, a->operand);
	const struct form **right = ARRAY(const struct form *, e.n);
	struct form **x = ARRAY(struct form *, e.n);
	for (int j = 0; j < e.n; j++)
		x[j] = kept_solution(c, a->node, &e, j);
	for (int i = 0; i < e.n; i++) {
		struct form *slope = derive(d, e.f[i]);
		for (int j = 0; j < e.n; j++) {
			const struct form *change = derive(d, e.M[i * e.n + j]);
			if (change->terms)
				slope = form_difference(slope, kept_product(c, a->node, change, x[j]));
		}
		right[i] = slope;
	}
	return right;
}

/* Of F(x) = 0, not linear in x: F_x x' = -F', F' the derivative of the residuals while x stays */
static void solve_curved(struct differentiation *d, const struct atom *a, struct linear_system *e)
{
	const int n = e->n, atoms = atoms_count(d->c->atoms);
	const bool equation = d->c->equation, whole_time = d->c->whole_time;
	struct differentiation inner = *d;
	struct fixing *fixing = ARRAY(struct fixing, n);
	const struct form **slope = ARRAY(const struct form *, n * n), **right = ARRAY(const struct form *, n);
	d->c->equation = inner.held = true;
	d->c->whole_time = a->written->whole_time;
	inner.known = ARRAY(struct form *, inner.count = atoms);
	inner.systems = 0;
	inner.system = NULL;
	for (int j = 0; j < n; j++) {
		const struct basis *x = &a->written->highest[j];
		fixing[j] = (struct fixing){ .symbol = d->c->frame->coord[x->index], .coord = x->index,
					     .order = x->order, .by = kept_solution(d->c, a->node, e, j) };
	}
	struct point *there = point_new(d->c, n, fixing);
	for (int i = 0; i < n * n; i++)
		slope[i] = form_at(there, a->written->slope[i]);
	for (int i = 0; i < n; i++)
		right[i] = form_difference(NEW(struct form), form_at(there, derive(&inner, a->written->residual[i])));
	d->c->equation = equation;
	d->c->whole_time = whole_time;
	e->M = slope;
	e->f = right;
}

/* M x' = f' - M' x */
static struct form *derive_solution(struct differentiation *d, const struct atom *a)
{
	struct linear_system e = system_of(a, a->operand);
	int known = 0;
	while (known < d->systems && !same_solution(d->system[known].atom, a))
		known++;
	if (known == d->systems) {
		if (a->written && a->written->slope)
			solve_curved(d, a, &e);
		else
			e.f = right_of_solution(d, a);
		known = d->systems++;           /* operands may have been solutions themselves */
		ENLARGE(d->system, (size_t)d->systems);
		d->system[known].atom = a;
		d->system[known].solved = e;
	}
	e = d->system[known].solved;
	e.written = NULL;
	return kept_solution(d->c, a->node, &e, a->component);
}

static struct form *derive_atom(struct differentiation *d, const struct atom *a)
{
	const struct form *itself = form_unit((struct basis){ .kind = BASIS_ATOM, .index = a->index, .atom = a });
	if (!d->by && !d->rate && (d->kind == BASIS_INPUT ? !a->input : !a->state))
		return NEW(struct form);
	switch (a->kind) {
	case ATOM_PRODUCT:    return derive_product(d, a);
	case ATOM_RECIPROCAL: return derive_reciprocal(d, a, itself);
	case ATOM_POWER:      return derive_power(d, a, itself);
	case ATOM_CALL:       return derive_call(d, a, itself);
	case ATOM_SOLUTION:   return derive_solution(d, a);
	case ATOM_PARAM:
	case ATOM_COMPARE:    return NEW(struct form);
	default: return kept_choice(d->c, a->node, a->operand[0], derive(d, a->operand[1]), derive(d, a->operand[2]));
	}
}

/* Atoms that exist at the start are differentiated once; those made on the way are not. */
static struct form *known_derivative(struct differentiation *d, const struct atom *a)
{
	if (a->index >= d->count)
		return derive_atom(d, a);
	if (!d->known[a->index])
		d->known[a->index] = derive_atom(d, a);
	return d->known[a->index];
}

static struct form *derive(struct differentiation *d, const struct form *form)
{
	struct form *total = NEW(struct form);
	if (d->by)
		return form == d->by ? form_number(1) : total;
	for (int i = 0; i < form->terms; i++) {
		const struct form_term *term = &form->term[i];
		if (term->basis.kind == BASIS_ATOM)
			form_add_to(total, known_derivative(d, term->basis.atom), term->factor);
		else if (d->held && is_highest(d->c->frame, &term->basis))
			continue;
		else if (d->rate)
			form_add_to(total, d->rate(d->context, term), NULL);
		else if (term->basis.kind == d->kind && term->basis.index == d->index &&
			 term->basis.order == d->order)
			form_add_basis(total, (struct basis){ .kind = BASIS_ONE }, term->factor);
	}
	return total;
}

struct form **form_derivatives(struct collector *c, int count, const struct form *const *form, bool by_input, int index,
			       int order)
{
	int atoms = atoms_count(c->atoms);
	struct differentiation d = { .c = c, .kind = by_input ? BASIS_INPUT : BASIS_COORD, .index = index,
				     .order = order, .known = ARRAY(struct form *, atoms), .count = atoms };
	struct form **slope = ARRAY(struct form *, count);
	for (int i = 0; i < count; i++)
		slope[i] = derive(&d, form[i]);
	return slope;
}

struct form *form_partial(struct collector *c, const struct atom *atom, int operand)
{
	struct differentiation d = { .c = c, .by = atom->operand[operand] };
	return derive_atom(&d, atom);
}

struct differentiation *rates_new(struct collector *c,
				  struct form *(*rate)(void *context, const struct form_term *term), void *context)
{
	struct differentiation *d = NEW(struct differentiation);
	*d = (struct differentiation){ .c = c, .rate = rate, .context = context, .count = atoms_count(c->atoms) };
	d->known = ARRAY(struct form *, d->count);
	return d;
}

struct form *form_rate(struct differentiation *rates, const struct form *form)
{
	return derive(rates, form);
}

/* ---- at a point ---- */

struct point {
	struct collector *c;
	int fixings;
	const struct fixing *fixing;
	bool values;                /* tunable params have the spec's */
	bool rounded;               /* long values are doubles */
	struct form **known;        /* per atom */
	struct span *span;          /* when it holds */
	int count;
};

static struct form *place_form(struct point *p, const struct form *form);

static const struct fixing *fixed(const struct point *p, const struct basis *basis)
{
	const bool input = basis->kind == BASIS_INPUT;
	for (int i = 0; i < p->fixings; i++) {
		const struct fixing *f = &p->fixing[i];
		const enum symbol_kind kind = f->symbol ? f->symbol->kind : SYMBOL_LET;
		if ((input ? kind == SYMBOL_INPUT : kind == SYMBOL_COORD || kind == SYMBOL_MULTIPLIER) &&
		    f->coord == basis->index && f->order == basis->order)
			return f;
	}
	return NULL;
}

static const struct fixing *fixed_time(const struct point *p)
{
	for (int i = 0; i < p->fixings; i++)
		if (!p->fixing[i].symbol)
			return &p->fixing[i];
	return NULL;
}

/* t^k e^{a t} cos or sin(w t + p) */
static struct form *forcing_at(const struct point *p, const struct basis *basis, const struct fixing *time)
{
	const struct forcing *forcing = basis->forcing;
	const struct node *node = &(struct node){ .kind = NODE_CALL, .at = time->at };
	struct form *value = constant_call(p->c, node, FN_EXP, form_scale(time->form, forcing->a));
	for (int k = 0; k < basis->power; k++)
		value = form_product(p->c, value, time->form);
	if (!oscillates(forcing))
		return value;
	const struct form *angle = sum(form_scale(time->form, forcing->w), form_constant(forcing->p));
	return form_product(p->c, value, constant_call(p->c, node, basis->sine ? FN_SIN : FN_COS, angle));
}

/* Multiplied out while that is short: (2 - y)^2 with y not fixed has the constant part 4 */
enum { EXPANDED = 8 };

static struct form *place_product(struct point *p, const struct atom *a, struct form *const *x)
{
	struct form *product = form_number(1);
	for (int i = 0; i < a->operands; i++) {
		bool expand = a->exponent[i] <= EXPANDED && !is_constant(x[i]);
		for (unsigned k = 0; k < a->exponent[i] && expand; k++)
			product = kept_product(p->c, a->node, product, x[i]);
		if (!expand) {
			struct form *power = kept_whole_power(p->c, a->node, x[i], a->exponent[i]), *before = product;
			product = kept_product(p->c, a->node, before, power);
			if (is_constant(before))        /* else atoms may hold it */
				form_free(before);
		}
		check_form(a->node->at, product);
	}
	return product;
}

struct form *kept_again(struct collector *c, const struct atom *a, struct form *const *x)
{
	struct form *product = form_number(1);
	struct linear_system equations;
	switch (a->kind) {
	case ATOM_PRODUCT:
		for (int i = 0; i < a->operands; i++)
			product = kept_product(c, a->node, product, kept_whole_power(c, a->node, x[i], a->exponent[i]));
		return product;
	case ATOM_PARAM:      return kept_param(c, a->node, a->param);
	case ATOM_RECIPROCAL: return kept_reciprocal(c, a->node, x[0]);
	case ATOM_POWER:      return kept_power(c, a->node, x[0], x[1]);
	case ATOM_CALL:       return kept_call(c, a->node, a->function, a->operands, x);
	case ATOM_SOLUTION:
		equations = system_of(a, (const struct form *const *)x);
		return kept_solution(c, a->node, &equations, a->component);
	case ATOM_COMPARE:    return kept_comparison(c, a->node, a->comparison, x[0], x[1]);
	default:              return kept_choice(c, a->node, x[0], x[1], x[2]);
	}
}

static struct form *place_param(const struct point *p, const struct atom *a)
{
	if (!p->values)
		return form_unit((struct basis){ .kind = BASIS_ATOM, .index = a->index, .atom = a });
	RATIONAL value = ZERO;
	param_value(a->param, value);
	return form_constant(value);
}

static bool shares_terms(const struct form *a, const struct form *b)
{
	return a == b || (a->terms && a->term == b->term);
}

/* These terms belong to the point, which frees them. */
static struct form *place_atom(struct point *p, const struct atom *a)
{
	if (a->kind == ATOM_PARAM)
		return place_param(p, a);
	SCRATCH struct form **x = ARRAY(struct form *, a->operands);
	x[0] = place_form(p, a->operand[0]);
	if (a->kind == ATOM_CHOOSE && is_constant(x[0])) {      /* the other branch need not be defined here */
		RATIONAL truth = ZERO;
		constant_value(p->c, x[0], truth);
		const struct form *taken = a->operand[mpq_sgn(truth) != 0 ? 1 : 2];
		return is_constant(taken) ? sum(taken, NEW(struct form)) : place_form(p, taken);
	}
	for (int i = 1; i < a->operands; i++)
		x[i] = place_form(p, a->operand[i]);
	struct form *placed = a->kind == ATOM_PRODUCT ? place_product(p, a, x) : kept_again(p->c, a, x);
	for (int i = 0; i < a->operands && is_constant(placed); i++) /* else atoms may hold them */
		if (is_constant(a->operand[i]) && shares_terms(placed, x[i]))
			placed = sum(placed, NEW(struct form));
		else if (is_constant(x[i]) && !is_constant(a->operand[i]) && !shares_terms(placed, x[i]))
			form_free(x[i]);
	return placed;
}

/* Digits of iterates multiply with each: what a double holds is left of them. */
static struct form *shortened(const struct point *p, struct form *form)
{
	enum { LONG = 512 };            /* bits */
	RATIONAL value = ZERO;
	if (!p->rounded || !is_constant(form))
		return form;
	constant_value(p->c, form, value);
	const double rounded = mpq_get_d(value);
	if (mpz_sizeinbase(mpq_numref(value), 2) + mpz_sizeinbase(mpq_denref(value), 2) < LONG || !isnormal(rounded))
		return form;
	mpq_set_d(value, rounded);
	return form_constant(value);
}

static struct form *place_basis(struct point *p, const struct basis *basis)
{
	const struct fixing *time = fixed_time(p);
	const bool is_named = basis->kind == BASIS_COORD || basis->kind == BASIS_INPUT;
	const struct fixing *f = is_named ? fixed(p, basis) : NULL;
	if (f)
		return f->by ? sum(f->by, NEW(struct form)) : form_constant(f->value);
	if (basis->kind == BASIS_FORCING && time)
		return forcing_at(p, basis, time);
	if (basis->kind != BASIS_ATOM)
		return form_unit(*basis);
	int index = basis->atom->index;
	if (index >= p->count)
		return place_atom(p, basis->atom);
	struct collector *c = p->c;
	if (!p->known[index] || !holds_now(c, p->span[index])) {
		struct span outer = c->span;
		c->span = (struct span){ NULL, NULL };
		p->known[index] = shortened(p, place_atom(p, basis->atom));
		p->span[index] = c->span;
		narrow_span(c, outer);
	} else {
		narrow_span(c, p->span[index]);
	}
	return p->known[index];
}

/* The result must not be changed: it may share the terms of the form. */
static struct form *place_form(struct point *p, const struct form *form)
{
	if (is_constant(form))
		return form_alias(form);
	struct form *total = NEW(struct form);
	for (int i = 0; i < form->terms; i++) {
		struct form *part = place_basis(p, &form->term[i].basis);
		form_add_to(total, part, form->term[i].factor);
		if (form->term[i].basis.kind != BASIS_ATOM) /* else the point knows it */
			form_free(part);
	}
	return total;
}

struct point *point_new(struct collector *c, int fixings, const struct fixing *fixing)
{
	struct point *p = NEW(struct point);
	*p = (struct point){ .c = c, .fixings = fixings, .fixing = fixing };
	return p;
}

void point_free(struct point *p)
{
	for (int i = 0; i < p->count; i++)
		if (p->known[i] && is_constant(p->known[i]))
			form_free(p->known[i]);
	discard(p->known);
	discard(p->span);
	discard(p);
}

void point_at_values(struct point *p)
{
	p->values = true;
}

void point_rounded(struct point *p)
{
	p->rounded = true;
}

struct form *form_at(struct point *p, const struct form *form)
{
	int count = atoms_count(p->c->atoms);
	if (count > p->count) {
		struct form **known = ARRAY(struct form *, count);
		struct span *span = ARRAY(struct span, count);
		for (int i = 0; i < p->count; i++) {
			known[i] = p->known[i];
			span[i] = p->span[i];
		}
		discard(p->known);
		discard(p->span);
		p->known = known;
		p->span = span;
		p->count = count;
	}
	return place_form(p, form);
}
