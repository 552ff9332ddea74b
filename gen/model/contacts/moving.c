/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contacts of mechanisms: where the mass matrix, or the direction in which a contact presses, depends on the state. The
 * gradient n of a guard or a sliding velocity and the accelerations M^-1 n^T by a unit force are forms there. An impact
 * changes velocities by -(1 + e) s M^-1 n^T/(n M^-1 n^T), s the approach speed. */
#include "inner.h"
#include "model/building.h"
#include "model/checks.h"
#include "model/state_mass.h"

/* ---- derivatives ---- */

static struct form *rate_of_term(void *building, const struct form_term *term)
{
	return rate_of_form(building, form_single(term->basis, term->factor));
}

struct form *rate_with_atoms(struct building *b, const struct form *form)
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

/* ---- the sign of a Delassus entry ---- */

struct answering { struct building *b; const struct moving_contact *c; double value; };

static void answer_at_start(void *context)
{
	struct answering *work = context;
	struct building *b = work->b;
	struct point *point = point_at_state(b, b->model->initial, NULL);
	work->value = 0;
	for (int i = 0; i < b->model->n; i++)
		if (work->c->gradient[i]->terms && work->c->force_direction[i]->terms)
			work->value += value_at(b, point, work->c->gradient[i]) *
				       value_at(b, point, work->c->force_direction[i]);
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
	return impact->moves ? impact->in->moving->force_direction[coord]->terms > 0
			     : mpq_sgn(impact->in->direction[coord]) != 0;
}

void report_no_mass(const struct building *b, struct place at, int coord)
{
	error(at, "a mass, or an equation with its second derivative", "an impact needs a mass: %s is of first order",
	      b->model->names.coord[coord]);
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

/* ---- derivatives: the force f n of a contact has the derivative f n_k + f_k n ---- */

static int moved_coord(const struct building *b, int column, int coord)
{
	return b->spec->joined.own + column * b->spec->joined.stride + coord;
}

/* Those that are no derivatives of others */
static int own_coordinates(const struct building *b)
{
	return b->spec->joined.columns > 0 ? b->spec->joined.own : b->model->n;
}

/* What f acts with on all coordinates: n, and n_k on their derivatives */
static const struct form **with_slopes(struct building *b, const struct impact_law *law,
				       const struct form *const *gradient)
{
	const int own = own_coordinates(b);
	const struct form **force = ARRAY(const struct form *, b->model->n);
	for (int j = 0; j < b->model->n; j++)
		force[j] = j < own ? gradient[j] : NEW(struct form);
	for (int k = 0; k < b->spec->joined.columns; k++) {
		const struct form **slope = gradient_of(b, law->slope[k].guard, 0);
		for (int j = 0; j < own; j++)
			force[moved_coord(b, k, j)] = slope[j];
	}
	return force;
}

/* ... and f_k, which holds the derivative of the guard */
static void find_moving_slope(struct building *b, const struct impact *impact, int column,
			      const struct form *const *gradient)
{
	struct impact_slope *slope = &impact->in->slope[column];
	const struct form **force = ARRAY(const struct form *, b->model->n);
	for (int j = 0; j < b->model->n; j++)
		force[j] = NEW(struct form);
	for (int j = 0; j < b->spec->joined.own; j++)
		force[moved_coord(b, column, j)] = gradient[j];
	slope->press = rate_with_atoms(b, slope->speed);
	slope->moving = moving_contact(b, impact->when->guard, gradient_of(b, slope->guard, 0), force, slope->speed,
				       slope->press);
}

void find_moving_impact(struct building *b, struct impact *impact)
{
	struct impact_law *law = impact->in;
	const struct form **gradient = gradient_of(b, law->guard, 0);
	const char *coord = b->spec->joined.columns > 0 ? NULL : unsymmetric_mass(b, gradient);
	if (coord)
		error(impact->when->at, "energy T and V give such equations, or each equation over the factor of its "
		      "momentum",
		      "a stop presses along its gradient, in equations of motion whose mass matrix is symmetric: that "
		      "of %s is not", coord);
	for (int j = 0; j < b->model->n; j++)
		if (gradient[j]->terms > 0 && b->model->system.velocity[j] < 0)
			report_no_mass(b, impact->when->at, j);
	law->press = rate_with_atoms(b, law->speed);
	const struct form **force = with_slopes(b, law, gradient);
	law->moving = moving_contact(b, impact->when->guard, gradient, force, law->speed, law->press);
	for (int k = 0; k < b->spec->joined.columns; k++)
		find_moving_slope(b, impact, k, gradient);
	if (sign_at_start(b, law->moving) == -1)
		error(impact->when->at, NULL, "the masses at this stop do not make a force part them");
}

bool is_along(struct building *b, const struct form *a, const struct form *along, mpq_ptr ratio, mpq_ptr rest)
{
	const struct form_term *last = &along->term[along->terms - 1], *same = form_find(a, &last->basis);
	mpq_set_ui(ratio, 0, 1);
	if (same)
		mpq_div(ratio, same->factor, last->factor);
	const struct form *off = form_difference(a, form_scale(along, ratio));
	if (!is_constant(off))
		return false;
	constant_value(&b->collector, off, rest);
	return true;
}

/* ---- bounces as jumps: of v - (1 + e) d s follows v_k - (1 + e) d s_k - ((1 + e) d)_k s ---- */

/* Of a jump's derivative what is taken from it for s = 1, ((1 + e) d)_k; false: it is no such derivative */
static bool slope_of_jump(struct building *b, const struct impact_law *law, const struct impact_slope *slope, int jump,
			  mpq_ptr factor)
{
	const struct linear *system = &b->model->system;
	const int own = system->coord[law->jump[jump].state], moved = system->coord[slope->jump[jump].state];
	struct basis basis = { .kind = BASIS_COORD, .index = moved, .order = 1 };
	RATIONAL part = RATIO(1, 1), rest = ZERO;
	mpq_add(part, part, law->restitution);
	mpq_mul(part, part, law->direction[own]);
	struct form *less = form_difference(form_unit(basis), slope->jump[jump].form);
	less = form_difference(less, form_scale(slope->speed, part));
	return is_along(b, less, law->speed, factor, rest) && mpq_sgn(rest) == 0;
}

static void add_share(const struct form *speed, int coord, mpq_srcptr factor, mpq_ptr sum)
{
	struct basis basis = { .kind = BASIS_COORD, .index = coord, .order = 1 };
	const struct form_term *term = form_find(speed, &basis);
	if (term)
		rational_addmul(sum, term->factor, factor);
}

/* e_k of (1 + e) = n (1 + e) d, and d_k; per coordinate, on the derivatives */
static void split_slope(struct building *b, struct impact *impact, int column, mpq_t *direction)
{
	const struct impact_law *law = impact->in;
	struct impact_slope *slope = &impact->in->slope[column];
	RATIONAL back = RATIO(1, 1), part = ZERO;
	mpq_add(back, back, law->restitution);
	mpq_set_ui(slope->restitution, 0, 1);
	for (int i = 0; i < law->jumps; i++) {
		const int own = b->model->system.coord[law->jump[i].state], moved = moved_coord(b, column, own);
		if (!slope_of_jump(b, law, slope, i, direction[moved]))
			error(impact->when->at, "stop x at 0.1 restitution 0.8 has one",
			      "no derivative is found of this bounce");
		add_share(law->speed, own, direction[moved], slope->restitution);
		mpq_mul(part, back, law->direction[own]);
		add_share(slope->speed, own, part, slope->restitution);
	}
	for (int i = 0; i < law->jumps; i++) {
		const int own = b->model->system.coord[law->jump[i].state], moved = moved_coord(b, column, own);
		rational_submul(direction[moved], slope->restitution, law->direction[own]);
		mpq_div(direction[moved], direction[moved], back);
	}
}

/* A contact that presses along d, whatever the masses */
static struct moving_contact *contact_along(struct building *b, const struct form *speed, const struct form *press,
					    mpq_t *direction)
{
	const int n = b->model->n;
	struct moving_contact *c = NEW(struct moving_contact);
	*c = (struct moving_contact){ gradient_of(b, speed, 1), forces_of_accelerations(b, direction),
				      ARRAY(const struct form *, n), form_at_rest(b, press), -1, ARRAY(double, n) };
	for (int j = 0; j < n; j++) {
		c->force_direction[j] = form_constant(direction[j]);
		c->sample[j] = c->gradient[j]->terms ? 1 : 0;
	}
	return c;
}

void find_bounce_with_slopes(struct building *b, struct impact *impact)
{
	struct impact_law *law = impact->in;
	mpq_t *all = rationals((size_t)b->model->n);
	for (int j = 0; j < own_coordinates(b); j++)
		mpq_set(all[j], law->direction[j]);
	for (int k = 0; k < b->spec->joined.columns; k++) {
		struct impact_slope *slope = &law->slope[k];
		mpq_t *direction = rationals((size_t)b->model->n);
		slope->speed = form_at_rest(b, slope->speed); /* t_k' is 0 */
		split_slope(b, impact, k, all);
		for (int j = 0; j < b->spec->joined.own; j++)
			mpq_set(direction[moved_coord(b, k, j)], law->direction[j]);
		slope->press = rate_with_atoms(b, slope->speed);
		slope->moving = contact_along(b, slope->speed, slope->press, direction);
	}
	law->press = rate_with_atoms(b, law->speed);
	law->moving = contact_along(b, law->speed, law->press, all);
	law->jumps = 0;
}

void find_masses(struct building *b)
{
	struct model_contacts *c = &b->model->contacts;
	c->multiplier = b->full->multiplier;
	c->mass = ARRAY(const struct linear_system *, b->full->masses);
	for (c->masses = 0; c->masses < b->full->masses; c->masses++)
		c->mass[c->masses] = &b->full->mass[c->masses].system;
}

void find_moving_drag(struct building *b, struct drag *drag)
{
	const struct basis basis = { .kind = BASIS_ATOM, .index = drag->atom->index, .atom = drag->atom };
	const struct form **force = ARRAY(const struct form *, b->model->n);
	bool moves = holds_atom(drag->velocity) || b->spec->joined.columns > 0;
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
		report_unheld(drag->atom->node->at);
	if (sign < 0)
		report_drives(drag->atom->node);
}
