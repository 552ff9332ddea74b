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
 * A chain of n links then has products of the order of n, not of n^2.
 *
 * A constraint g = 0 adds its multiplier times dg/dq, one on velocities its multiplier times dg/dq'. */
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
	struct differentiation *rate; /* in time */
};

/* ---- time derivatives of terms ---- */

static struct form *rate_of_term(void *building, const struct form_term *term)
{
	return rate_of_form(building, form_single(term->basis, term->factor));
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

static const struct form_term *velocity_in(const struct form *rate, int coord)
{
	const struct basis velocity = { .kind = BASIS_COORD, .index = coord, .order = 1 };
	return form_find(rate, &velocity);
}

/* Does `form` depend on coordinates by this combination of them alone, whose rate is `rate`? */
static bool is_of_combination(const struct sweep *s, const struct form *form, const struct form *rate)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(s->b->collector.atoms));
	const struct form *first = NULL;
	RATIONAL ratio = ZERO;
	for (const struct form_term **term = terms_within(form, seen); *term; term++) {
		const struct basis *basis = &(*term)->basis;
		if (basis->kind == BASIS_COORD && (basis->order > 0 || !velocity_in(rate, basis->index)))
			return false;
	}
	for (int i = 0; i < rate->terms; i++) {
		mpq_inv(ratio, rate->term[i].factor);
		const struct form *slope = form_scale(form_derivatives(&s->b->collector, 1, &form, false,
								       rate->term[i].basis.index, 0)[0], ratio);
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

/* factor times form into a sum, which is made where there is none yet */
static void add_to(struct form **sum, const struct form *form, mpq_srcptr factor)
{
	*sum = *sum ? *sum : NEW(struct form);
	form_add_to(*sum, form, factor);
}

/* The form is multiplied by `adjoint` in what is differentiated. */
static void spread(struct sweep *s, const struct form *form, const struct form *adjoint)
{
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind == BASIS_COORD && basis->order < 2)
			add_to(&s->by[basis->order][basis->index], adjoint, form->term[i].factor);
		else if (basis->atom)
			add_to(&s->adjoint[basis->atom->index], adjoint, form->term[i].factor);
	}
}

/* (dT/dw)' dr/dq of one rate */
static void add_rate(struct sweep *s, const struct atom *a, int velocity)
{
	const struct form *change = form_rate(s->rate, s->adjoint[a->index]);
	const struct form *others = kept_others(&s->b->collector, a->node, a, velocity);
	const struct form *rate = a->operand[velocity];
	const struct form *product = kept_product(&s->b->collector, a->node, change, others);
	for (int i = 0; i < rate->terms; i++)
		add_to(&s->force[rate->term[i].basis.index], product, rate->term[i].factor);
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
			spread(s, a->operand[i], kept_product(&s->b->collector, a->node, s->adjoint[a->index], slope));
	}
}

static struct sweep sweep_back(struct building *b, const struct form *form, const struct form *seed, bool rates,
			       struct form **force)
{
	const int atoms = atoms_count(b->collector.atoms);
	struct sweep s = { .b = b, .rates = rates, .atoms = atoms, .force = force };
	const struct atom **atom = ARRAY(const struct atom *, (size_t)atoms + 1);
	s.adjoint = ARRAY(struct form *, (size_t)atoms + 1);
	s.rate = rates_new(&b->collector, rate_of_term, b);
	for (int k = 0; k < 2; k++)
		s.by[k] = ARRAY(struct form *, b->model->n);
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms + 1);
	for (const struct form_term **term = terms_within(form, seen); *term; term++)
		if ((*term)->basis.atom)
			atom[(*term)->basis.atom->index] = (*term)->basis.atom;
	spread(&s, form, seed);
	/* numbered in the order in which they are made: what is read has a lower number than its reader */
	for (int i = atoms - 1; i >= 0; i--)
		if (atom[i] && s.adjoint[i])
			visit(&s, atom[i]);
	return s;
}

/* ---- the energies ---- */

static void add_kinetic(struct building *b, const struct form *T, struct form **force)
{
	RATIONAL minus = RATIO(-1, 1);
	struct sweep s = sweep_back(b, T, form_number(1), true, force);
	for (int j = 0; j < b->model->n; j++) {
		if (s.by[1][j])
			add_to(&force[j], form_rate(s.rate, s.by[1][j]), NULL);
		if (s.by[0][j])
			add_to(&force[j], s.by[0][j], minus);
	}
}

/* The derivative by each coordinate, or by its velocity */
static void add_gradient(struct building *b, const struct form *form, const struct form *seed, int order,
			 struct form **force)
{
	struct sweep s = sweep_back(b, form, seed, false, force);
	for (int j = 0; j < b->model->n; j++)
		if (s.by[order][j])
			add_to(&force[j], s.by[order][j], NULL);
}

static const struct form *energy_of(const struct value *value, const struct node *node)
{
	return scalar_of(value, node, "dot(v, v) is the square of a vector, sum(v) the sum of its components");
}

static void check_energy(struct building *b, const struct energy *energy, const struct form *form)
{
	const bool differentiated = energy->kind == 'T' || energy->kind == 'G';
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	for (const struct form_term **term = terms_within(form, seen); *term; term++) {
		const struct basis *basis = &(*term)->basis;
		const bool input = basis->kind == BASIS_INPUT && differentiated;
		if (basis->kind == BASIS_COORD && basis->index >= b->model->n)
			error(energy->value->start, "'force EXPR on q' takes it", "no energy has the multiplier '%s'",
			      b->model->names.coord[basis->index]);
		if ((basis->kind == BASIS_COORD && basis->order == 2) || input)
			error(energy->value->start, input ? "a load of time, or a coordinate, moves it" : NULL,
			      "the %s reads %s, of which a derivative would be needed",
			      energy->kind == 'G' ? "constraint" : "energy", input ? "an input" : "an acceleration");
	}
}

/* ---- constraints ---- */

static bool moves_by_rates(const struct building *b, const struct form *form)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	bool reads = false;
	for (const struct form_term **term = terms_within(form, seen); *term; term++)
		reads = reads || ((*term)->basis.kind == BASIS_COORD && (*term)->basis.order == 1);
	return reads;
}

/* What it constrains has accelerations, of which its last derivative holds some. */
static void check_constraint(const struct building *b, const struct energy *energy, const struct form *form)
{
	const struct model *model = b->model;
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	bool any = false;
	for (const struct form_term **term = terms_within(form, seen); *term; term++) {
		const struct basis *basis = &(*term)->basis;
		any = any || basis->kind == BASIS_COORD;
		if (basis->kind == BASIS_COORD && model->system.velocity[basis->index] < 0)
			error(energy->value->start, "constraints hold coordinates of second order, by forces",
			      "'%s' is of first order: no force acts on it", model->names.coord[basis->index]);
	}
	if (!any)
		error(energy->value->start, NULL, "no coordinate stands in the constraint '%s'",
		      energy->multiplier->name);
}

static void add_constraint(struct building *b, const struct energy *energy, const struct form *form,
			   struct segment_equations *s, struct form **force)
{
	const int index = energy->multiplier->index;
	struct constraint *constraint = &s->constraint[index];
	check_constraint(b, energy, form);
	const int first = moves_by_rates(b, form);
	constraint->statement = energy;
	constraint->by[first] = form;
	for (int k = first; k < 2; k++)
		constraint->by[k + 1] = form_rate(rates_new(&b->collector, rate_of_term, b), constraint->by[k]);
	add_gradient(b, form, form_unit(multiplier_basis(&b->model->frame, index)), first, force);
}

static void add_energy(struct building *b, const struct energy *energy, struct segment_equations *s,
		       struct form **force)
{
	struct collector *c = &b->collector;
	for (int i = 0; i < (energy->point ? energy->point->children : 0); i++) {
		struct node *point = energy->point->child[i], *value = energy->value->child[i];
		const struct form *r = energy_of(collect(c, point), point), *F = energy_of(collect(c, value), value);
		add_gradient(b, r, form_difference(NEW(struct form), F), 0, force);
	}
	if (energy->point)
		return;
	const struct form *form = energy_of(collect(c, energy->value), energy->value);
	check_energy(b, energy, form);
	if (energy->kind == 'T' || energy->kind == 'V') {
		const struct form **total = &s->energy[energy->kind == 'V'];
		*total = *total ? form_sum(*total, form, false) : form;
	}
	s->negative_kinetic = s->negative_kinetic || (energy->kind == 'T' && !never_falls_below(form));
	if (energy->kind == 'T')
		add_kinetic(b, form, force);
	else if (energy->kind == 'G')
		add_constraint(b, energy, form, s, force);
	else
		add_gradient(b, form, form_number(1), energy->kind == 'D', force);
}

static void add_where(struct form **to, struct form **from, int first, int end)
{
	for (int j = first; j < end; j++)
		if (from[j])
			add_to(&to[j], from[j], NULL);
}

/* Of a derivative: into the equations of the coordinates' derivatives. Of a constraint its own multiplier's force
 * stands where it is, and that of the constraint that it is of goes along as it turns. */
static void add_derivative(struct building *b, const struct energy *energy, struct segment_equations *s,
			   struct form **force)
{
	const int n = b->model->n;
	struct form **by = ARRAY(struct form *, n);
	add_energy(b, energy, s, by);
	if (energy->of) {
		const struct constraint *constraint = &s->constraint[energy->multiplier->index];
		const int first = constraint->by[0] == NULL;
		add_where(force, by, energy->own, n);
		by = ARRAY(struct form *, n);
		add_gradient(b, constraint->by[first], form_unit(multiplier_basis(&b->model->frame, energy->of->index)),
			     first, by);
	}
	add_where(force + energy->behind, by, 0, energy->own);
}

struct adding {
	struct building *b;
	struct segment_equations *s;
	struct form **force;
	const struct energy *energy;
};

static void add_guarded(void *context)
{
	const struct adding *a = context;
	(a->energy->own ? add_derivative : add_energy)(a->b, a->energy, a->s, a->force);
}

/* A coordinate's derivative by one of the params */
static struct form *slope_of_term(void *first, const struct form_term *term)
{
	struct form *slope = NEW(struct form);
	struct basis basis = term->basis;
	basis.index += *(const int *)first;
	if (basis.kind == BASIS_COORD)
		form_add_basis(slope, basis, term->factor);
	return slope;
}

/* The equations of the derivatives have those of the model along them: forms that all columns share, where the
 * derivative of an energy would give each term of an equation anew. */
static void add_along(struct building *b, struct form **force)
{
	const struct spec *spec = b->spec;
	for (int k = 0; k < spec->joined.columns + spec->joined.probe; k++) {
		int first = spec->joined.own + k * spec->joined.stride;
		struct differentiation *along = rates_new(&b->collector, slope_of_term, &first);
		for (int j = 0; j < spec->joined.own; j++)
			if (force[j])
				add_to(&force[first + j], form_rate(along, force[j]), NULL);
	}
}

struct form **lagrange_terms(struct building *b, struct segment_equations *s)
{
	struct form **force = ARRAY(struct form *, b->model->n);
	const int keep = (int)b->collector.keep;
	b->collector.keep = KEEP_ALL;
	s->constraint = ARRAY(struct constraint, (size_t)b->spec->count.multipliers + 1);
	for (int i = 0; i < b->spec->lagrange.energies; i++)
		statement_guard(add_guarded, &(struct adding){ b, s, force, &b->spec->lagrange.energy[i] });
	if (b->spec->joined.along)
		add_along(b, force);
	b->collector.keep = (unsigned)keep;
	for (int j = 0; j < b->model->n; j++)
		force[j] = force[j] ? force[j] : NEW(struct form);
	return force;
}
