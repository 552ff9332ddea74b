/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lagrange's equations from energies, by reverse differentiation (Griewank and Walther, Evaluating Derivatives, 2008):
 *
 *     d/dt dT/dq' - dT/dq + dV/dq + dD/dq' = sum of forces F dr/dq
 *
 * T is taken as a function of rates w = r', of q' and of q. Where w = g q' is the derivative in time of some r(q), so
 * that dw/dq' = dr/dq = g, the terms of d/dt dT/dq' and dT/dq in which w is differentiated cancel:
 *
 *     sum over w of (dT/dw)' dr/dq - dT/dq with w fixed
 *
 * A chain of n links then has products of the order of n, not of n^2. */
#include "building.h"
#include "lagrange.h"
#include "model/contacts/friction.h"

struct sweep {
	struct building *b;
	bool rates;                 /* stop at them: of T */
	int atoms;
	struct form **adjoint;      /* per atom: the derivative by it */
	struct form **by[2];        /* per coordinate: by itself, by its velocity */
	struct form **force;        /* per coordinate: what goes into its equation */
};

/* ---- time derivatives of terms ---- */

static struct form *rate_of_term(void *building, const struct form_term *term)
{
	return rate_of_form(building, form_single(term->basis, term->factor));
}

static struct form *rate_of(struct building *b, const struct form *form)
{
	return form_rate(&b->collector, form, rate_of_term, b);
}

/* ---- rates ---- */

static bool is_first_derivative(const struct sweep *s, const struct form *form)
{
	bool first = form->terms > 0;
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		first = first && basis->kind == BASIS_COORD && basis->order == 1 &&
			s->b->model->system.velocity[basis->index] >= 0;
	}
	return first;
}

/* Does `form` depend on coordinates by this combination of them alone, whose rate is `rate`? */
static bool is_of_combination(const struct sweep *s, const struct form *form, const struct form *rate)
{
	struct collector *c = &s->b->collector;
	const int n = s->b->model->n;
	const struct form *first = NULL;
	RATIONAL ratio = ZERO;
	for (int j = 0; j < n; j++) {
		const struct form *slope = form_derivatives(c, 1, &form, false, j, 0)[0];
		const struct basis velocity = { .kind = BASIS_COORD, .index = j, .order = 1 };
		const struct form_term *own = form_find(rate, &velocity);
		if (form_derivatives(c, 1, &form, false, j, 1)[0]->terms || (!own && slope->terms))
			return false;
		if (!own)
			continue;
		mpq_inv(ratio, own->factor);
		slope = form_scale(slope, ratio);
		if (first && !same_form(first, slope))
			return false;
		first = slope;
	}
	return true;
}

/* The factor of a product that is a combination of velocities, where the others make it a rate; -1: it is none */
static int rate_within(const struct sweep *s, const struct atom *a)
{
	int found = -1;
	if (a->kind != ATOM_PRODUCT || a->time || a->input)
		return -1;
	for (int i = 0; i < a->operands; i++)
		if (a->exponent[i] == 1 && is_first_derivative(s, a->operand[i]))
			found = i;
	for (int i = 0; i < a->operands && found >= 0; i++)
		if (i != found && !is_of_combination(s, a->operand[i], a->operand[found]))
			return -1;
	return found;
}

/* ---- backwards ---- */

static void add_product(struct sweep *s, struct form **to, const struct form *a, const struct form *b,
			const struct node *node)
{
	struct form *product = kept_product(&s->b->collector, node, a, b);
	*to = *to ? form_sum(*to, product, false) : product;
}

/* The form is multiplied by `adjoint` in what is differentiated. */
static void spread(struct sweep *s, const struct form *form, const struct form *adjoint, const struct node *node)
{
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		struct form **to = basis->kind == BASIS_COORD && basis->order < 2 ? &s->by[basis->order][basis->index]
				   : basis->atom				   ? &s->adjoint[basis->atom->index]
										   : NULL;
		if (to)
			add_product(s, to, adjoint, form_constant(form->term[i].factor), node);
	}
}

/* (dT/dw)' dr/dq of one rate */
static void add_rate(struct sweep *s, const struct atom *a, int velocity)
{
	const struct form *change = rate_of(s->b, s->adjoint[a->index]);
	const struct form *others = kept_others(&s->b->collector, a->node, a, velocity);
	const struct form *rate = a->operand[velocity];
	for (int i = 0; i < rate->terms; i++)
		add_product(s, &s->force[rate->term[i].basis.index], change,
			    form_scale(others, rate->term[i].factor), a->node);
}

static bool stands_before(const struct atom *a, int operand)
{
	for (int i = 0; i < operand; i++)
		if (a->operand[i] == a->operand[operand])
			return true;
	return false;
}

static void visit(struct sweep *s, const struct atom *a)
{
	int rate = s->rates ? rate_within(s, a) : -1;
	if (rate >= 0) {
		add_rate(s, a, rate);
		return;
	}
	for (int i = 0; i < a->operands; i++) {
		if (stands_before(a, i))
			continue;
		struct form *slope = form_partial(&s->b->collector, a, i);
		if (slope->terms)
			spread(s, a->operand[i], kept_product(&s->b->collector, a->node, s->adjoint[a->index], slope),
			       a->node);
	}
}

/* Atoms are numbered in the order in which they are made: what is read has a lower number than its reader. */
static void list_atoms(const struct form *form, const struct atom **atom)
{
	for (int i = 0; i < form->terms; i++) {
		const struct atom *a = form->term[i].basis.atom;
		if (!a || atom[a->index])
			continue;
		atom[a->index] = a;
		for (int k = 0; k < a->operands; k++)
			list_atoms(a->operand[k], atom);
	}
}

static struct sweep sweep_back(struct building *b, const struct form *form, const struct form *seed, bool rates,
			       struct form **force, const struct node *node)
{
	const int atoms = atoms_count(b->collector.atoms);
	struct sweep s = { .b = b, .rates = rates, .atoms = atoms, .force = force };
	const struct atom **atom = ARRAY(const struct atom *, (size_t)atoms + 1);
	s.adjoint = ARRAY(struct form *, (size_t)atoms + 1);
	for (int k = 0; k < 2; k++)
		s.by[k] = ARRAY(struct form *, b->model->n);
	list_atoms(form, atom);
	spread(&s, form, seed, node);
	for (int i = atoms - 1; i >= 0; i--)
		if (atom[i] && s.adjoint[i])
			visit(&s, atom[i]);
	return s;
}

/* ---- the energies ---- */

static void add_to(struct form **force, int coord, const struct form *form, bool subtract)
{
	force[coord] = force[coord] ? form_sum(force[coord], form, subtract)
		       : subtract   ? form_difference(NEW(struct form), form)
				    : form_sum(form, NEW(struct form), false);
}

static void add_kinetic(struct building *b, const struct form *T, struct form **force, const struct node *node)
{
	struct sweep s = sweep_back(b, T, form_number(1), true, force, node);
	for (int j = 0; j < b->model->n; j++) {
		if (s.by[1][j])
			add_to(force, j, rate_of(b, s.by[1][j]), false);
		if (s.by[0][j])
			add_to(force, j, s.by[0][j], true);
	}
}

/* The derivative by each coordinate, or by its velocity */
static void add_gradient(struct building *b, const struct form *form, const struct form *seed, int order,
			 struct form **force, const struct node *node)
{
	struct sweep s = sweep_back(b, form, seed, false, force, node);
	for (int j = 0; j < b->model->n; j++)
		if (s.by[order][j])
			add_to(force, j, s.by[order][j], false);
}

static const struct form *scalar_of(const struct value *value, const struct node *node)
{
	if (value->rows != 1 || value->columns != 1)
		error(node->start, "dot(v, v) is the square of a vector, sum(v) the sum of its components",
		      "expected a scalar, found a %d x %d matrix", value->rows, value->columns);
	return value->cell[0];
}

static void check_energy(struct building *b, const struct energy *energy, const struct form *form)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	for (const struct form_term **term = terms_within(form, seen); *term; term++) {
		const struct basis *basis = &(*term)->basis;
		const bool input = basis->kind == BASIS_INPUT && energy->kind == 'T';
		if ((basis->kind == BASIS_COORD && basis->order == 2) || input)
			error(energy->value->start, input ? "a load of time, or a coordinate, moves it" : NULL,
			      "the energy reads %s, of which a derivative would be needed",
			      input ? "an input" : "an acceleration");
	}
}

static void add_energy(struct building *b, const struct energy *energy, struct form **force)
{
	struct collector *c = &b->collector;
	for (int i = 0; i < (energy->point ? energy->point->children : 0); i++) {
		struct node *point = energy->point->child[i], *value = energy->value->child[i];
		const struct form *r = scalar_of(collect(c, point), point), *F = scalar_of(collect(c, value), value);
		add_gradient(b, r, form_difference(NEW(struct form), F), 0, force, point);
	}
	if (energy->point)
		return;
	const struct form *form = scalar_of(collect(c, energy->value), energy->value);
	check_energy(b, energy, form);
	if (energy->kind == 'T')
		add_kinetic(b, form, force, energy->value);
	else
		add_gradient(b, form, form_number(1), energy->kind == 'D', force, energy->value);
}

struct adding {
	struct building *b;
	struct form **force;
	const struct energy *energy;
};

static void add_guarded(void *context)
{
	const struct adding *a = context;
	add_energy(a->b, a->energy, a->force);
}

struct form **lagrange_terms(struct building *b)
{
	struct form **force = ARRAY(struct form *, b->model->n);
	const int keep = (int)b->collector.keep;
	b->collector.keep = KEEP_ALL;
	for (int i = 0; i < b->spec->energies; i++)
		statement_guard(add_guarded, &(struct adding){ b, force, &b->spec->energy[i] });
	b->collector.keep = (unsigned)keep;
	for (int j = 0; j < b->model->n; j++)
		force[j] = force[j] ? force[j] : NEW(struct form);
	return force;
}
