/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions of forms: forcing terms and exponentials where the argument is linear in time, atoms where a scheme takes
 * them, and dry friction. */
#include "collect/collect.h"

static struct form *not_a_load(struct collector *c, const struct node *node, struct form *x)
{
	if (!keeps(c))
		not_linear(c, node, "is not linear");
	if (node->function == FN_SIN || node->function == FN_COS || node->function == FN_TAN)
		x = with_lead(c, node, x);
	return kept_call(c, node, node->function, 1, &x);
}

static struct form *sine_of(struct collector *c, struct node *node, struct form *x)
{
	struct form phase;
	mpq_srcptr w;
	if (is_constant(x))
		return constant_call(c, node, node->function, x);
	if (!linear_in_time(x, &w, &phase))
		return not_a_load(c, node, x);
	return collect_forcing(c, node->function == FN_SIN, w, &phase);
}

/* e^{a t + b} = e^b e^{a t} */
static struct form *exponential_of(struct collector *c, struct node *node, struct form *x)
{
	struct form phase;
	mpq_srcptr a;
	if (is_constant(x))
		return constant_call(c, node, FN_EXP, x);
	if (!linear_in_time(x, &a, &phase))
		return not_a_load(c, node, x);
	struct form *forcing = plain_forcing(c, 0, a);
	return phase.terms ? form_product(c, constant_call(c, node, FN_EXP, &phase), forcing) : forcing;
}

struct form *function_of_form(struct collector *c, struct node *node, struct form *x)
{
	if (node->function == FN_SIN || node->function == FN_COS)
		return sine_of(c, node, x);
	if (node->function == FN_EXP)
		return exponential_of(c, node, x);
	return is_constant(x) ? constant_call(c, node, node->function, x) : not_a_load(c, node, x);
}

/* F is no less than 0, and no more than what is held, where they are constant */
static void check_friction(struct collector *c, const struct node *node, struct form *const *x)
{
	RATIONAL force = ZERO, rest = ZERO;
	for (int i = 1; i < node->children; i++) {
		if (is_constant(x[i]))
			constant_value(c, x[i], rest);
		if (is_constant(x[i]) && mpq_sgn(rest) < 0)
			refuse_force_below(node->child[i]);
	}
	if (node->children > 2 && is_constant(x[1]) && is_constant(x[2])) {
		constant_value(c, x[1], force);
		if (mpq_cmp(rest, force) < 0)
			error(node->child[2]->start, "friction(v, F, S): F while it slides, S up to which it sticks",
			      "friction that sticks holds no less than it brakes while it slides");
	}
}

void refuse_force_below(const struct node *force)
{
	error(force->start, "it acts against the sliding: friction(v, F) is F sgn(v) on the left side",
	      "the force of friction is below 0");
}

void refuse_velocity_of_friction(const struct node *friction)
{
	error(friction->child[0]->start, "x', x' - y', or x' - 0.2 against what moves",
	      "the velocity of friction is linear in velocities");
}

/* Dry friction: a force, which only scheme exact can treat, where it switches; elsewhere it says so */
static struct form *friction_form(struct collector *c, const struct node *node, struct form *const *x)
{
	if (c->tolerant)
		not_linear(c, node, "is dry friction");
	if (!keeps_piecewise(c))
		error(node->at, "x' and what else moves has friction", "friction stands in equations and outputs");
	if (!node->follows)
		check_friction(c, node, x);
	/* for all time, what moves with x may be an atom of time: each segment has been looked at */
	if (!has_coordinate(x[0]) ||
	    (x[0]->term[x[0]->terms - 1].basis.kind == BASIS_ATOM && !c->whole_time && !node->follows))
		refuse_velocity_of_friction(node);
	bool none = node->children == 2 && x[1]->terms == 0 && !node->follows;
	return none ? NEW(struct form) : kept_call(c, node, FN_FRICTION, node->children, x);
}

struct form *piecewise_cell(struct collector *c, struct node *node, struct form *const *x)
{
	if (node->function == FN_FRICTION)
		return friction_form(c, node, x);
	/* an angle has a single formula: known when it is of time alone, and no load all the same */
	bool kept = node->function == FN_ATAN2 ? keeps(c) : keeps_piecewise(c) && !is_decided_call(c, node, x);
	return kept ? kept_call(c, node, node->function, node->children, x) : piecewise(c, node, x);
}
