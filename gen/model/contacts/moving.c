/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contacts of mechanisms: where the mass matrix, or the direction in which a contact presses, depends on the state. The
 * gradient n of a guard or a sliding velocity and the accelerations M^-1 n^T by a unit force are forms there. An impact
 * changes velocities by -(1 + e) s M^-1 n^T/(n M^-1 n^T), s the approach speed. */
#include "inner.h"
#include "math/math.h"
#include "model/building.h"
#include "model/checks.h"
#include "model/state_mass.h"

/* ---- derivatives ---- */

static struct form *rate_of_term(void *building, const struct form_term *term)
{
	return rate_of_form(building, form_single(term->basis, term->factor));
}

static struct form *rate_with_atoms(struct building *b, const struct form *form)
{
	b->collector.equation = true;           /* highest derivatives have factors in it */
	struct form *rate = form_rate(rates_new(&b->collector, rate_of_term, b), form);
	b->collector.equation = false;
	return rate;
}

static const struct form **gradient_of(struct building *b, const struct form *form, int order)
{
	const struct form **gradient = ARRAY(const struct form *, b->model->n);
	for (int j = 0; j < b->model->n; j++)
		gradient[j] = form_derivatives(&b->collector, 1, &form, false, j, order)[0];
	return gradient;
}

/* Neither a condition, which has kinks, nor a param that an instance changes */
static bool is_smooth(const struct atom *a)
{
	switch (a->kind) {
	case ATOM_COMPARE:
	case ATOM_CHOOSE:
	case ATOM_PARAM: return false;
	case ATOM_CALL:  return a->function <= FN_ATAN2;
	default:         return true;
	}
}

bool keeps_smooth(const struct building *b, const struct form *form)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	bool smooth = b->collector.keep == KEEP_ALL && !b->collector.whole_time;
	for (const struct form_term **term = terms_within(form, seen); *term; term++)
		smooth = smooth && (!(*term)->basis.atom || is_smooth((*term)->basis.atom)) &&
			 !is_highest(&b->model->frame, &(*term)->basis);
	return smooth;
}

/* ---- whether they depend on each other, at some state that is not special ---- */

static double value_at(struct building *b, struct point *point, const struct form *form)
{
	RATIONAL value = ZERO;
	const struct form *here = form_at(point, form);
	if (!is_constant(here))
		return 1;
	constant_value(&b->collector, here, value);
	return nearest_double(value);
}

static struct point *some_point(struct building *b)
{
	const int states = b->model->system.states;
	mpq_t *state = rationals(states);
	struct jacobian j = { .b = b, .state = state };
	struct fixing *fixing = ARRAY(struct fixing, states + 1);
	for (int i = 0; i < states; i++) {
		mpq_set_si(state[i], 3 + 7 * i % 11, 13UL + (unsigned long)i);
		mpq_canonicalize(state[i]);
	}
	mpq_init(j.t);
	mpq_set_si(j.t, 1, 3);
	return point_new(&b->collector, jacobian_point(&j, fixing), fixing);
}

struct sampling { struct building *b; const struct form **gradient; double *sample; };

static void take_out(int n, const double *direction, double *from)
{
	double product = 0, square = 0;
	for (int j = 0; j < n; j++) {
		product += direction[j] * from[j];
		square += direction[j] * direction[j];
	}
	for (int j = 0; j < n && square > 0; j++)
		from[j] -= product / square * direction[j];
}

/* Without what constraints take from it: where they leave nothing it depends on them. */
static void sample_gradient(void *context)
{
	struct sampling *work = context;
	struct building *b = work->b;
	const int n = b->model->n, constraints = b->spec->count.multipliers;
	double *held = ARRAY(double, constraints * n);
	struct point *point = some_point(b);
	point_at_values(point);
	for (int j = 0; j < n; j++)
		work->sample[j] = value_at(b, point, work->gradient[j]);
	for (int i = 0; i < constraints; i++) {
		const struct form **gradient = gradient_of(b, b->full->constraint[i].by[1], 1);
		for (int j = 0; j < n; j++)
			held[i * n + j] = value_at(b, point, gradient[j]);
		for (int k = 0; k < i; k++)
			take_out(n, held + k * n, held + i * n);
		take_out(n, held + i * n, work->sample);
	}
}

/* ---- the sign of what answers ---- */

struct answering { struct building *b; const struct moving_contact *c; double value; };

static void answer_at_start(void *context)
{
	struct answering *work = context;
	struct building *b = work->b;
	struct jacobian j = { .b = b, .state = b->model->initial };
	struct fixing *fixing = ARRAY(struct fixing, b->model->system.states + 1);
	mpq_init(j.t);
	struct point *point = point_new(&b->collector, jacobian_point(&j, fixing), fixing);
	point_at_values(point);
	work->value = 0;
	for (int i = 0; i < b->model->n; i++)
		if (work->c->gradient[i]->terms && work->c->push[i]->terms)
			work->value += value_at(b, point, work->c->gradient[i]) *
				       value_at(b, point, work->c->push[i]);
}

/* 1 or -1: of what a unit force adds to the rate of its velocity at the start; 0: nothing; 2: not known */
static int sign_at_start(struct building *b, const struct moving_contact *c)
{
	struct answering work = { .b = b, .c = c };
	if (!silent_guard(answer_at_start, &work))
		return 2;
	return (work.value > 1e-12) - (work.value < -1e-12);
}

/* ---- the whole ---- */

/* n(q) q', where that is all of the velocity */
static int only_coordinate(struct building *b, const struct node *node, const struct form **gradient,
			   const struct form *velocity)
{
	int only = -1;
	for (int j = 0; j < b->model->n; j++) {
		if (gradient[j]->terms == 0)
			continue;
		if (only >= 0)
			return -1;
		only = j;
	}
	if (only < 0)
		return -1;
	struct form *speed = form_unit((struct basis){ .kind = BASIS_COORD, .index = only, .order = 1 });
	b->collector.equation = true;
	speed = kept_product(&b->collector, node, gradient[only], speed);
	b->collector.equation = false;
	return form_difference(velocity, speed)->terms == 0 ? only : -1;
}

static struct moving_contact *moving_contact(struct building *b, const struct node *node,
					     const struct form **gradient, const struct form **force,
					     const struct form *velocity, const struct form *rate)
{
	const int n = b->model->n;
	struct moving_contact *c = NEW(struct moving_contact);
	const struct form **row = ARRAY(const struct form *, n);
	for (int j = 0; j < n; j++)
		row[b->owner[j]] = force[j];
	*c = (struct moving_contact){ gradient, force, accelerations_by(b, row), form_at_rest(b, rate),
				      only_coordinate(b, node, gradient, velocity), ARRAY(double, n) };
	if (!silent_guard(sample_gradient, &(struct sampling){ b, gradient, c->sample }))
		for (int j = 0; j < n; j++)
			c->sample[j] = gradient[j]->terms ? 1 : 0;
	return c;
}

bool contact_moves(const struct building *b, const struct form *guard)
{
	bool moves = holds_atom(guard);
	for (int i = 0; i < guard->terms; i++) {
		const struct basis *basis = &guard->term[i].basis;
		moves = moves || (basis->kind == BASIS_COORD && has_moving_mass(b->segment_equations, basis->index));
	}
	return moves;
}

const struct when *curved_guard(const struct building *b)
{
	for (int i = 0; i < b->model->contacts.impacts; i++)
		if (holds_atom(b->model->contacts.impact[i].in->guard))
			return b->model->contacts.impact[i].when;
	return NULL;
}

bool is_moved_by(const struct impact *impact, int coord)
{
	return impact->moves ? impact->in->moving->push[coord]->terms > 0 : mpq_sgn(impact->in->direction[coord]) != 0;
}

_Noreturn void report_velocity(const struct building *b, const struct when *when, int coord)
{
	error(when->guard->start, "of velocities 'when' has guards", "a stop is between places: %s' stands here",
	      b->model->names.coord[coord]);
}

struct form *speed_that_moves(struct building *b, const struct when *when, const struct form *guard)
{
	const struct form **rates = gradient_of(b, guard, 1);
	for (int j = 0; j < b->model->n; j++)
		if (rates[j]->terms > 0)
			report_velocity(b, when, j);
	return rate_with_atoms(b, guard);
}

void find_moving_impact(struct building *b, struct impact *impact)
{
	struct impact_law *law = impact->in;
	const struct form **gradient = gradient_of(b, law->guard, 0);
	const char *coord = unsymmetric_mass(b, gradient);
	if (coord)
		error(impact->when->at, "energy T and V give such equations, or each equation over the factor of its "
		      "momentum",
		      "a stop presses along its gradient, in equations of motion whose mass matrix is symmetric: that "
		      "of %s is not", coord);
	for (int j = 0; j < b->model->n; j++)
		if (gradient[j]->terms > 0 && b->model->system.velocity[j] < 0)
			error(impact->when->at, "a mass, or an equation with its second derivative",
			      "an impact needs a mass: %s is of first order", b->model->names.coord[j]);
	law->press = rate_with_atoms(b, law->speed);
	law->moving = moving_contact(b, impact->when->guard, gradient, gradient, law->speed, law->press);
	if (sign_at_start(b, law->moving) == -1)
		error(impact->when->at, NULL, "the masses at this stop do not make a force part them");
}

void find_masses(struct building *b)
{
	struct model_contacts *c = &b->model->contacts;
	c->mass = ARRAY(const struct linear_system *, b->full->masses);
	for (c->masses = 0; c->masses < b->full->masses; c->masses++)
		c->mass[c->masses] = &b->full->mass[c->masses].system;
}

void find_moving_drag(struct building *b, struct drag *drag)
{
	const struct basis basis = { .kind = BASIS_ATOM, .index = drag->atom->index, .atom = drag->atom };
	const struct form **force = ARRAY(const struct form *, b->model->n);
	bool moves = holds_atom(drag->velocity);
	for (int j = 0; j < b->model->n; j++) {
		const struct form_term *term =
			form_find(residual_as_written(b->full, b->owner, b->owner[j]), &basis);
		force[j] = term ? form_constant(term->factor) : NEW(struct form);
		moves = moves || (term && has_moving_mass(b->full, j));
	}
	if (!moves)
		return;
	drag->rate = rate_with_atoms(b, drag->velocity);
	drag->moving = moving_contact(b, drag->atom->node, gradient_of(b, drag->velocity, 1), force, drag->velocity,
				      drag->rate);
	int sign = sign_at_start(b, drag->moving);
	if (sign == 0)
		error(drag->atom->node->at, "its velocity has to answer to its force",
		      "friction cannot hold what slides there");
	if (sign < 0)
		error(drag->atom->node->at, "on the left side it stands with the sign of a damper: + friction(x', F)",
		      "this friction drives what slides instead of holding it");
}
