/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Piecewise-linear functions and conditions of constants and of time. Time is divided at the breakpoints found so far;
 * a collection looks at one interval between them, in which every condition has one outcome. A breakpoint that is met
 * for the first time is added, and the collection is done again. */
#include "collect/collect.h"

#include <string.h>

/* ---- time ---- */

/* The collectors that a collection has left behind may still look at the old list. */
static mpq_srcptr add_change(struct collector *c, mpq_srcptr t)
{
	int low = 0, high = c->changes;
	while (low < high) {
		int middle = low + (high - low) / 2, order = mpq_cmp(c->change[middle], t);
		if (order == 0)
			return c->change[middle];
		low = order < 0 ? middle + 1 : low;
		high = order < 0 ? high : middle;
	}
	if (c->changes == LIMIT_CHANGES)
		error(c->term->start, NULL, "more changes of formula than the limit of %d", LIMIT_CHANGES);
	mpq_t *change = ARRAY(mpq_t, c->changes + 1);
	if (low > 0)
		memcpy(change, c->change, (size_t)low * sizeof *change);
	if (low < c->changes)
		memcpy(change + low + 1, c->change + low, (size_t)(c->changes - low) * sizeof *change);
	mpq_init(change[low]);
	mpq_set(change[low], t);
	c->change = change;
	c->changes++;
	return change[low];
}

/* ---- spans: when what was collected holds ---- */

void narrow_span(struct collector *c, struct span span)
{
	if (span.after && (!c->span.after || mpq_cmp(span.after, c->span.after) > 0))
		c->span.after = span.after;
	if (span.before && (!c->span.before || mpq_cmp(span.before, c->span.before) < 0))
		c->span.before = span.before;
}

bool holds_now(const struct collector *c, struct span span)
{
	if (span.after && (c->interval == 0 || mpq_cmp(c->change[c->interval - 1], span.after) < 0))
		return false;
	return !span.before || (c->interval < c->changes && mpq_cmp(c->change[c->interval], span.before) <= 0);
}

/* A time inside interval `index` of those that the breakpoints leave. */
static void sample_time(const struct collector *c, int index, mpq_ptr t)
{
	RATIONAL one = RATIO(1, 1);
	if (c->changes == 0) {
		mpq_set_ui(t, 0, 1);
	} else if (index == 0) {
		mpq_sub(t, c->change[0], one);
	} else if (index == c->changes) {
		mpq_add(t, c->change[c->changes - 1], one);
	} else {
		mpq_add(t, c->change[index - 1], c->change[index]);
		mpq_div_2exp(t, t, 1);
	}
}

/* The sign of factor t + phase in the collector's interval; where it is 0 there is a breakpoint. */
static int sign_in_time(struct collector *c, mpq_srcptr factor, mpq_srcptr phase)
{
	RATIONAL t = ZERO, root = ZERO;
	mpq_div(root, phase, factor);
	mpq_neg(root, root);
	sample_time(c, c->interval, t);
	int side = mpq_cmp(t, root);
	mpq_srcptr change = add_change(c, root);
	if (side != 0)
		narrow_span(c, side > 0 ? (struct span){ change, NULL } : (struct span){ NULL, change });
	else
		narrow_span(c, (struct span){ change, change });
	return side * mpq_sgn(factor);
}

int order_now(struct collector *c, const struct node *node, const struct form *a, const struct form *b)
{
	struct form *difference = form_sum(a, b, true), phase;
	mpq_srcptr factor;
	RATIONAL value = ZERO;
	int sign;
	if (is_constant(difference)) {
		constant_value(c, difference, value);
		sign = mpq_sgn(value);
	} else if (linear_in_time(difference, &factor, &phase)) {
		constant_value(c, &phase, value);
		sign = sign_in_time(c, factor, value);
	} else {
		not_built(c, node->at,
			  node->kind == NODE_CALL ? format("'%s' of what moves is", function_name(node->function))
						  : "conditions on what moves are");
	}
	form_free(difference);
	return sign;
}

bool is_decided(const struct collector *c, int count, struct form *const *x)
{
	struct form phase;
	mpq_srcptr factor;
	for (int i = 0; i < count; i++)
		if (!is_constant(x[i]) && (c->whole_time || !linear_in_time(x[i], &factor, &phase)))
			return false;
	return true;
}

bool is_decided_call(const struct collector *c, const struct node *node, struct form *const *x)
{
	if (is_decided(c, node->children, x) || (node->function == FN_TABLE && node->children == 5))
		return true;            /* two points of a table are a straight line */
	if (node->function != FN_MIN && node->function != FN_MAX && node->function != FN_CLIP &&
	    node->function != FN_DEADZONE)
		return false;
	for (int i = 1; i < node->children; i++)
		if (!is_constant(form_sum(x[i], x[0], true)))
			return false;
	return true;
}

/* ---- functions ---- */

static struct form *extreme(struct collector *c, const struct node *node, struct form *const *x)
{
	struct form *best = x[0];
	for (int i = 1; i < node->children; i++)
		if ((order_now(c, node, x[i], best) < 0) == (node->function == FN_MIN))
			best = x[i];
	return best;
}

static struct form *clipped(struct collector *c, const struct node *node, struct form *const *x)
{
	if (order_now(c, node, x[1], x[2]) > 0)
		error(node->child[1]->start, NULL, "the lower breakpoint is above the upper one");
	int side = order_now(c, node, x[0], x[1]) < 0 ? 1 : order_now(c, node, x[0], x[2]) > 0 ? 2 : 0;
	if (node->function == FN_CLIP)
		return x[side];
	return side ? form_sum(x[0], x[side], true) : NEW(struct form);
}

/* The value of a point: where it stands, if it is a plain number, else in `room` */
static mpq_srcptr constant_point(struct collector *c, const struct node *node, const struct form *x, mpq_ptr room)
{
	if (!is_constant(x))
		error(node->start, NULL, "the points of a table are constants");
	if (x->terms == 1 && x->term[0].basis.kind == BASIS_ONE)
		return x->term[0].factor;
	mpq_init(room);
	constant_value(c, x, room);
	return room;
}

/* The numbers of a table at their arguments' places; its breakpoints rise. */
static mpq_srcptr *table_points(struct collector *c, const struct node *node, struct form *const *x, mpq_t *room)
{
	mpq_srcptr *v = ARRAY(mpq_srcptr, node->children);
	for (int i = 1; i < node->children; i++)
		v[i] = constant_point(c, node->child[i], x[i], room[i]);
	for (int i = 3; i < node->children; i += 2)
		if (mpq_cmp(v[i - 2], v[i]) >= 0)
			error(node->child[i]->start, NULL, "the breakpoints of a table rise");
	return v;
}

void check_breakpoints(struct collector *c, const struct node *node, struct form *const *x)
{
	if (node->function == FN_TABLE)
		table_points(c, node, x, ARRAY(mpq_t, node->children));
	else if (is_constant(x[1]) && is_constant(x[2]) && order_now(c, node, x[1], x[2]) > 0)
		error(node->child[1]->start, NULL, "the lower breakpoint is above the upper one");
}

void slope_between(const mpq_srcptr *point, mpq_ptr slope)
{
	RATIONAL width = ZERO;
	mpq_sub(slope, point[3], point[1]);
	mpq_sub(width, point[2], point[0]);
	mpq_div(slope, slope, width);
}

/* y0 + slope (x - x0) on the piece that holds x; extended by the end slopes */
static struct form *tabulated(struct collector *c, const struct node *node, struct form *const *x)
{
	int points = (node->children - 1) / 2, left = 0;
	SCRATCH mpq_t *room = ARRAY(mpq_t, node->children);
	SCRATCH mpq_srcptr *v = table_points(c, node, x, room);
	RATIONAL slope = ZERO;
	/* all breakpoints at the first sight */
	for (int i = 1; i + 1 < points && (left == i - 1 || c->interval == 0); i++)
		left = order_now(c, node, x[0], x[2 * i + 1]) > 0 ? i : left;
	slope_between(v + 2 * left + 1, slope);
	struct form *value = form_sum(x[0], x[2 * left + 1], true), *piece = form_scale(value, slope);
	form_free(value);
	form_add_to(piece, x[2 * left + 2], NULL);
	return piece;
}

static struct form *angle(struct collector *c, const struct node *node, struct form *const *x)
{
	RATIONAL a = ZERO, b = ZERO;
	if (!is_constant(x[0]) || !is_constant(x[1]))
		not_linear(c, node, "is not linear");
	constant_value(c, x[0], a);
	constant_value(c, x[1], b);
	if (!constant_atan2(node->at, a, b, a))
		met_irrational(c, &c->irrationals.used[FN_ATAN2]);
	return form_constant(a);
}

struct form *piecewise(struct collector *c, const struct node *node, struct form *const *x)
{
	struct form *zero = NEW(struct form);
	switch (node->function) {
	case FN_ABS:   return order_now(c, node, x[0], zero) < 0 ? form_sum(NEW(struct form), x[0], true) : x[0];
	case FN_SGN:   return form_number(order_now(c, node, x[0], zero));
	case FN_MIN:
	case FN_MAX:   return extreme(c, node, x);
	case FN_TABLE: return tabulated(c, node, x);
	case FN_ATAN2: return angle(c, node, x);
	default:       return clipped(c, node, x);
	}
}
