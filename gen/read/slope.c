/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives of expressions. In time: of a let, f' and f'', and of what an assembly gives to an input of a component
 * which reads the input's slope; by velocities, of energies; by a param, at fixed time, of an expression whose
 * coordinates follow the param too. The nodes of a derivative stand at those of its expression. */
#include "read/parser.h"

static struct node *like(const struct node *node, enum node_kind kind)
{
	struct node *made = node_new(kind, node->at);
	made->start = node->start;
	made->end = node->end;
	return made;
}

static struct node *number(const struct node *node, long value)
{
	struct node *made = like(node, NODE_NUMBER);
	mpq_set_si(made->number, value, 1);
	return made;
}

static struct node *derivative(struct node *node, const struct slope *by);

bool is_zero_node(const struct node *node)
{
	return node->kind == NODE_NUMBER && mpq_sgn(node->number) == 0;
}

static void append(struct node *node, struct node *child, bool inverse)
{
	struct place end = node->end;
	add_child(node, child, inverse, node->at);
	node->end = end;
}

static struct node *call(const struct node *like_this, enum function function, struct node *argument)
{
	struct node *made = like(like_this, NODE_CALL);
	made->function = function;
	append(made, argument, false);
	return made;
}

/* factor * slope, or factor / slope's place with `inverse`; 0 stays 0 */
static struct node *times(struct node *factor, struct node *slope)
{
	if (is_zero_node(slope))
		return slope;
	struct node *product = like(slope, NODE_PRODUCT);
	product->each = true;
	append(product, factor, false);
	append(product, slope, false);
	return product;
}

/* factor * slope, of factor^2 or the like, of which no linear term goes into an operator: none of this may either. */
static struct node *unexpanded(struct node *factor, struct node *slope, const struct slope *by)
{
	struct node *product = times(factor, slope);
	product->unexpanded = by->unexpanded && product->kind == NODE_PRODUCT;
	return product;
}

static struct node *negative(struct node *node)
{
	struct node *sum = like(node, NODE_SUM);
	append(sum, node, true);
	return sum;
}

static struct node *quotient(struct node *above, struct node *below)
{
	struct node *made = like(above, NODE_PRODUCT);
	made->each = true;
	append(made, above, false);
	append(made, below, true);
	return made;
}

/* q' of all velocities, or 1 of one of them: of a vector in its place */
static struct node *slope_by_velocity(struct node *node, const struct slope *by)
{
	const struct symbol *symbol = node->symbol;
	const bool whole = symbol->length && !node->component;
	if (symbol->kind != SYMBOL_COORD || node->primes != 1)
		return number(node, 0);
	if (by->kind == SLOPE_VELOCITIES)
		return node;
	if (symbol != by->of->symbol || (!whole && node->component != by->of->component))
		return number(node, 0);
	if (!whole)
		return number(node, 1);
	struct node *unit = like(node, NODE_MATRIX);
	unit->columns = 1;
	for (int i = 1; i <= symbol->length; i++)
		append(unit, number(node, i == by->of->component), false);
	return unit;
}

/* ---- by a param ---- */

/* The program sets a tunable param, which then follows no other. */
static bool stands_alone(const struct symbol *symbol)
{
	return symbol->tuning.number && !symbol->tuning.derived;
}

bool follows_param(const struct node *node, const struct symbol *param)
{
	const struct symbol *s = node->kind == NODE_NAME ? node->symbol : NULL;
	bool found = s && s == param;
	if (s && !found && s->value && !stands_alone(s))
		found = follows_param(s->value, param);
	for (int i = 0; i < node->children && !found; i++)
		found = follows_param(node->child[i], param);
	return found;
}

static bool is_constant_node(const struct node *node)
{
	const struct symbol *s = node->kind == NODE_NAME ? node->symbol : NULL;
	bool constant = node->kind != NODE_TIME && !(s && (s->kind == SYMBOL_COORD || s->kind == SYMBOL_INPUT));
	if (s && constant && s->value)
		constant = is_constant_node(s->value);
	for (int i = 0; i < node->children && constant; i++)
		constant = is_constant_node(node->child[i]);
	return constant;
}

bool reads_states(const struct node *node)
{
	const struct symbol *s = node->kind == NODE_NAME ? node->symbol : NULL;
	bool reads = s && (s->kind == SYMBOL_COORD || (s->kind == SYMBOL_LET && s->value && reads_states(s->value)));
	for (int i = 0; i < node->children && !reads; i++)
		reads = reads_states(node->child[i]);
	return reads;
}

/* A formula changes where this goes through 0. In time that moves with the param, and there the derivative jumps; what
 * jumps as the state chooses is watched (sensitivity.c). */
static void check_condition(const struct node *node, const struct slope *by)
{
	if (by->kind == SLOPE_PARAM && follows_param(node, by->param) && !is_constant_node(node) && !reads_states(node))
		error(node->at, "where a formula changes has to stay where it is",
		      "no derivative by %s is built here: it moves where the formula changes", by->name);
}

/* The derivative of t where that moves */
static struct node *moved_time(const struct node *node, const struct slope *by)
{
	struct node *made = like(node, NODE_NAME);
	made->symbol = by->time;
	return made;
}

/* Of an input on its ramp, beside its own: u' times that of t */
static struct node *along_time(const struct node *node, struct node *own, const struct slope *by)
{
	struct node *sum = like(node, NODE_SUM), *rate = like(node, NODE_NAME);
	rate->symbol = node->symbol;
	rate->component = node->component;
	rate->primes = 1;
	if (own)
		append(sum, own, false);
	if (node->primes == 0)
		append(sum, times(rate, moved_time(node, by)), false);
	return sum->children ? sum : number(node, 0);
}

static struct node *varied_name(struct node *node, const struct slope *by)
{
	const struct symbol *symbol = node->symbol;
	struct node **known = &by->known[symbol->number];
	if (symbol == by->param)
		return number(node, 1);
	if (stands_alone(symbol))
		return number(node, 0);
	if (symbol->value) {
		*known = *known ? *known : derivative(symbol->value, by);
		return *known;
	}
	struct node *made = like(node, NODE_NAME);
	made->symbol = by->moved[symbol->number];
	made->component = node->component;
	made->primes = node->primes;
	if (symbol->kind == SYMBOL_INPUT && by->time && symbol->hold > 0)
		return along_time(node, made->symbol ? made : NULL, by);
	/* u(t - d): its slope along a ramp; where it jumps: step/derivatives.c */
	if (symbol->delayed && symbol->hold > 0 && node->primes == 0 && follows_param(symbol->when, by->param)) {
		made->symbol = node->symbol;
		made->primes = 1;
		return times(made, derivative(symbol->when, by));
	}
	return made->symbol ? made : number(node, 0);
}

static struct node *slope_of_name(struct node *node, const struct slope *by)
{
	const struct symbol *symbol = node->symbol;
	if (by->kind == SLOPE_PARAM)
		return varied_name(node, by);
	if (symbol->kind == SYMBOL_PARAM || symbol->kind == SYMBOL_MATRIX)
		return number(node, 0);
	if (symbol->kind == SYMBOL_LET)
		return derivative(symbol->value, by);
	if (by->kind == SLOPE_VELOCITY || by->kind == SLOPE_VELOCITIES)
		return slope_by_velocity(node, by);
	if (by->kind == SLOPE_LOADS && symbol->kind == SYMBOL_COORD)
		return number(node, 0);
	if (node->primes > (symbol->kind == SYMBOL_COORD))
		error(by->at, NULL, "this derivative would hold that of %s, which is not known",
		      format("%s%.*s", symbol->name, node->primes, "''"));
	if (symbol->kind == SYMBOL_INPUT && !symbol->hold)
		error(by->at, "an input with 'hold first' ramps between samples and has one",
		      "this derivative would hold that of input '%s', which is held over a step: it has none",
		      symbol->name);
	struct node *made = like(node, NODE_NAME);
	made->symbol = node->symbol;
	made->component = node->component;
	made->primes = node->primes + 1;
	return made;
}

static struct node *slope_of_sum(const struct node *node, const struct slope *by)
{
	struct node *sum = like(node, NODE_SUM);
	for (int i = 0; i < node->children; i++) {
		struct node *slope = derivative(node->child[i], by);
		if (!is_zero_node(slope))
			append(sum, slope, node->inverse[i]);
	}
	return sum->children ? sum : number(node, 0);
}

/* a b / c: a' b / c + a b' / c - a b / c * c' / c */
static struct node *slope_of_product(struct node *node, const struct slope *by)
{
	struct node *sum = like(node, NODE_SUM);
	for (int i = 0; i < node->children; i++) {
		struct node *slope = derivative(node->child[i], by);
		if (is_zero_node(slope))
			continue;
		struct node *product = like(node, NODE_PRODUCT);
		product->each = node->each;
		for (int k = 0; k < node->children; k++)
			append(product, k == i && !node->inverse[i] ? slope : node->child[k], node->inverse[k]);
		append(sum, node->inverse[i] ? times(quotient(product, node->child[i]), slope) : product,
		       node->inverse[i]);
	}
	return sum->children ? sum : number(node, 0);
}

/* b^n: n b^(n - 1) b', and b^n log(b) n' where a param is in n */
static struct node *slope_of_power(struct node *node, const struct slope *by)
{
	struct node *base = derivative(node->child[0], by), *exponent = node->child[1];
	struct node *moves = derivative(exponent, by), *sum = like(node, NODE_SUM);
	if (!is_zero_node(moves) && by->kind == SLOPE_PARAM && !is_constant_node(node) && !reads_states(node))
		error(by->at, NULL, "this derivative is not found: an exponent depends on %s", by->name);
	if (!is_zero_node(moves))
		append(sum, times(node, times(call(node, FN_LOG, node->child[0]), moves)), false);
	if (!is_zero_node(base)) {
		struct node *less = like(exponent, NODE_SUM), *power = like(node, NODE_POWER);
		append(less, exponent, false);
		append(less, number(exponent, 1), true);
		append(power, node->child[0], false);
		append(power, less, false);
		append(sum, times(exponent, unexpanded(power, base, by)), false);
	}
	return sum->children ? sum : number(node, 0);
}

/* (a . b)' = a' . b + a . b' */
static struct node *slope_of_dot(struct node *node, const struct slope *by)
{
	struct node *sum = like(node, NODE_SUM);
	for (int i = 0; i < 2; i++) {
		struct node *slope = derivative(node->child[i], by);
		if (is_zero_node(slope))
			continue;
		struct node *product = call(node, FN_DOT, i ? node->child[0] : slope);
		append(product, i ? slope : node->child[1], false);
		append(sum, product, false);
	}
	return sum;
}

/* 1 + sign x */
static struct node *one_and(const struct node *node, struct node *x, bool minus)
{
	struct node *sum = like(node, NODE_SUM);
	append(sum, number(node, 1), false);
	append(sum, x, minus);
	return sum;
}

static struct node *one_and_square(const struct node *node, struct node *x, bool minus)
{
	return one_and(node, times(x, x), minus);
}

/* Of tan and tanh; the constant of 1 - tanh^2 would be a linear term of the derivative that tanh itself has not. */
static struct node *slope_of_tangent(struct node *node, struct node *inner, const struct slope *by)
{
	const bool minus = node->function == FN_TANH;
	if (!by->unexpanded)
		return times(one_and_square(node, node, minus), inner);
	if (minus)
		return times(unexpanded(one_and(node, node, true), one_and(node, node, false), by), inner);
	struct node *cosine = call(node, FN_COS, node->child[0]);
	return quotient(inner, times(cosine, cosine));
}

/* condition ? a : b, the condition x < y */
static struct node *chosen(const struct node *node, struct node *x, struct node *y, struct node *a, struct node *b,
			   const struct slope *by)
{
	struct node *less = like(node, NODE_COMPARE), *made = like(node, NODE_CHOOSE);
	less->comparison = CMP_LT;
	made->unexpanded = by->unexpanded;
	append(less, x, false);
	append(less, y, false);
	append(made, less, false);
	append(made, a, false);
	append(made, b, false);
	return made;
}

/* Of min and max: that of the one which is taken */
static struct node *slope_of_extreme(struct node *node, const struct slope *by)
{
	struct node *best = node->child[0], *slope = derivative(best, by);
	for (int i = 1; i < node->children; i++) {
		struct node *x = node->child[i], *y = best, *own = derivative(x, by);
		bool least = node->function == FN_MIN;
		slope = chosen(node, least ? x : y, least ? y : x, own, slope, by);
		best = chosen(node, least ? x : y, least ? y : x, x, y, by);
	}
	return slope;
}

/* deadzone(x, lo, hi), clip(x, lo, hi) */
static struct node *slope_of_clipped(struct node *node, const struct slope *by)
{
	struct node *x = node->child[0], *lo = node->child[1], *hi = node->child[2];
	struct node *inner = derivative(x, by), *below = derivative(lo, by), *above = derivative(hi, by);
	if (node->function == FN_DEADZONE) {
		struct node *from_lo = like(node, NODE_SUM), *from_hi = like(node, NODE_SUM);
		append(from_lo, inner, false);
		append(from_lo, below, true);
		append(from_hi, inner, false);
		append(from_hi, above, true);
		return chosen(node, x, lo, from_lo, chosen(node, hi, x, from_hi, number(node, 0), by), by);
	}
	return chosen(node, x, lo, below, chosen(node, hi, x, above, inner, by), by);
}

/* Of table(x; x0, y0; x1, y1; ...): of the line from point to point on which x is, the last ones going on */
static struct node *slope_of_table(struct node *node, const struct slope *by)
{
	struct node *x = node->child[0], *slope = NULL;
	for (int i = node->children - 4; i > 0; i -= 2) {
		struct node *const *at = &node->child[i];
		struct node *along = like(node, NODE_SUM), *wide = like(node, NODE_SUM), *high = like(node, NODE_SUM);
		struct node *line = like(node, NODE_SUM);
		append(along, x, false);
		append(along, at[0], true);
		append(wide, at[2], false);
		append(wide, at[0], true);
		append(high, at[3], false);
		append(high, at[1], true);
		append(line, at[1], false);
		append(line, times(quotient(high, wide), along), false);
		line = derivative(line, by);
		slope = slope ? chosen(node, x, at[2], line, slope, by) : line;
	}
	return slope;
}

/* (y' x - x' y)/(x^2 + y^2) */
static struct node *slope_of_angle(struct node *node, const struct slope *by)
{
	struct node *y = node->child[0], *x = node->child[1];
	struct node *sum = like(node, NODE_SUM), *square = like(node, NODE_SUM);
	append(sum, times(x, derivative(y, by)), false);
	append(sum, times(y, derivative(x, by)), true);
	append(square, times(x, x), false);
	append(square, times(y, y), false);
	return quotient(sum, square);
}

/* Of dry friction: what holds it holds its derivative, what slips has that of its force. */
static struct node *slope_of_friction(struct node *node, const struct slope *by)
{
	struct node *made = call(node, FN_FRICTION, derivative(node->child[0], by->event));
	for (int i = 1; i < node->children; i++)
		append(made, derivative(node->child[i], by), false);
	made->follows = node;
	return made;
}

static struct node *slope_of_call(struct node *node, const struct slope *by)
{
	if (node->function == FN_FRICTION && by->event)
		return slope_of_friction(node, by);
	struct node *x = node->child[0], *inner = derivative(x, by), *root;
	bool constant = true;
	for (int i = 0; i < node->children; i++)
		constant = constant && is_zero_node(derivative(node->child[i], by));
	if (constant)
		return number(node, 0);
	switch (node->function) {
	case FN_SUM:
	case FN_CUMSUM: return call(node, node->function, inner);
	case FN_DOT:  return slope_of_dot(node, by);
	case FN_SIN:  return times(call(node, FN_COS, x), inner);
	case FN_COS:  return negative(times(call(node, FN_SIN, x), inner));
	case FN_TAN:
	case FN_TANH: return slope_of_tangent(node, inner, by);
	case FN_SINH: return times(call(node, FN_COSH, x), inner);
	case FN_COSH: return times(call(node, FN_SINH, x), inner);
	case FN_EXP:  return times(node, inner);
	case FN_LOG:  return quotient(inner, x);
	case FN_SQRT: return quotient(inner, times(number(node, 2), node));
	case FN_ASIN:
	case FN_ACOS:
		root = call(node, FN_SQRT, one_and_square(node, x, true));
		return node->function == FN_ASIN ? quotient(inner, root) : negative(quotient(inner, root));
	case FN_ATAN: return quotient(inner, one_and_square(node, x, false));
	case FN_ATAN2: return slope_of_angle(node, by);
	case FN_ABS:  return times(call(node, FN_SGN, x), inner);
	case FN_SGN:
		check_condition(node, by);
		return number(node, 0);
	case FN_MIN:
	case FN_MAX:  return slope_of_extreme(node, by);
	case FN_DEADZONE:
	case FN_CLIP: return slope_of_clipped(node, by);
	case FN_TABLE: return slope_of_table(node, by);
	default:
		error(by->kind == SLOPE_PARAM ? node->at : by->at, NULL,
		      "this derivative would hold that of %s, which is not found", function_name(node->function));
	}
}

static struct node *slope_of_matrix(struct node *node, const struct slope *by)
{
	struct node *made = like(node, NODE_MATRIX);
	bool any = false;
	made->columns = node->columns;
	for (int i = 0; i < node->children; i++) {
		struct node *slope = derivative(node->child[i], by);
		any = any || !is_zero_node(slope);
		append(made, slope, false);
	}
	return any ? made : number(node, 0);
}

static struct node *slope_of_choice(struct node *node, const struct slope *by)
{
	struct node *first = derivative(node->child[1], by), *second = derivative(node->child[2], by);
	check_condition(node->child[0], by);
	if (is_zero_node(first) && is_zero_node(second))
		return first;
	struct node *choice = like(node, NODE_CHOOSE);
	choice->unexpanded = by->unexpanded;
	append(choice, node->child[0], false);
	append(choice, first, false);
	append(choice, second, false);
	return choice;
}

static struct node *derivative(struct node *node, const struct slope *by)
{
	switch (node->kind) {
	case NODE_NUMBER:
	case NODE_PI:      return number(node, 0);
	case NODE_TIME:
		return by->time ? moved_time(node, by)
				: number(node, by->kind == SLOPE_TIME || by->kind == SLOPE_LOADS);
	case NODE_NAME:    return slope_of_name(node, by);
	case NODE_SUM:     return slope_of_sum(node, by);
	case NODE_PRODUCT: return slope_of_product(node, by);
	case NODE_POWER:   return slope_of_power(node, by);
	case NODE_CALL:    return slope_of_call(node, by);
	case NODE_CHOOSE:  return slope_of_choice(node, by);
	case NODE_MATRIX:  return slope_of_matrix(node, by);
	default:
		if (by->kind != SLOPE_PARAM)
			error(by->at, NULL, "this derivative is not found");
		check_condition(node, by);       /* a comparison, or a matrix in a file */
		return number(node, 0);
	}
}

struct node *slope_by(struct node *node, struct slope by)
{
	return derivative(node, &by);
}

struct node *slope_of(struct node *node, struct place at)
{
	return slope_by(node, (struct slope){ .at = at });
}
