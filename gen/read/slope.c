/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The derivative of an expression: in time, of a let, f' and f'', and of what an assembly gives to an input of a
 * component which reads the input's slope; by velocities, of energies. Its nodes stand at those of the expression. */
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

static bool is_zero(const struct node *node)
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
	if (is_zero(slope))
		return slope;
	struct node *product = like(slope, NODE_PRODUCT);
	product->each = true;
	append(product, factor, false);
	append(product, slope, false);
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

static struct node *derivative(struct node *node, const struct slope *by);

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

static struct node *slope_of_name(struct node *node, const struct slope *by)
{
	const struct symbol *symbol = node->symbol;
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
		if (!is_zero(slope))
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
		if (is_zero(slope))
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

/* b^n: n b^(n - 1) b' */
static struct node *slope_of_power(struct node *node, const struct slope *by)
{
	struct node *base = derivative(node->child[0], by), *exponent = node->child[1];
	if (!is_zero(derivative(exponent, by)))
		error(by->at, NULL, "this derivative is not found: an exponent depends on time");
	if (is_zero(base))
		return base;
	struct node *less = like(exponent, NODE_SUM), *power = like(node, NODE_POWER);
	append(less, exponent, false);
	append(less, number(exponent, 1), true);
	append(power, node->child[0], false);
	append(power, less, false);
	return times(exponent, times(power, base));
}

/* (a . b)' = a' . b + a . b' */
static struct node *slope_of_dot(struct node *node, const struct slope *by)
{
	struct node *sum = like(node, NODE_SUM);
	for (int i = 0; i < 2; i++) {
		struct node *slope = derivative(node->child[i], by);
		if (is_zero(slope))
			continue;
		struct node *product = call(node, FN_DOT, i ? node->child[0] : slope);
		append(product, i ? slope : node->child[1], false);
		append(sum, product, false);
	}
	return sum;
}

static struct node *slope_of_call(struct node *node, const struct slope *by)
{
	struct node *x = node->child[0], *inner = derivative(x, by);
	bool constant = true;
	for (int i = 0; i < node->children; i++)
		constant = constant && is_zero(derivative(node->child[i], by));
	if (constant)
		return number(node, 0);
	switch (node->function) {
	case FN_SUM:
	case FN_CUMSUM: return call(node, node->function, inner);
	case FN_DOT:  return slope_of_dot(node, by);
	case FN_SIN:  return times(call(node, FN_COS, x), inner);
	case FN_COS:  return negative(times(call(node, FN_SIN, x), inner));
	case FN_SINH: return times(call(node, FN_COSH, x), inner);
	case FN_COSH: return times(call(node, FN_SINH, x), inner);
	case FN_EXP:  return times(node, inner);
	case FN_LOG:  return quotient(inner, x);
	case FN_SQRT: return quotient(inner, times(number(node, 2), node));
	case FN_ABS:  return times(call(node, FN_SGN, x), inner);
	default:
		error(by->at, "found are those of sums, products, powers, sin, cos, exp, log, sqrt, sinh, cosh, abs",
		      "this derivative would hold that of %s, which is not found", function_name(node->function));
	}
}

static struct node *slope_of_matrix(const struct node *node, const struct slope *by)
{
	struct node *matrix = like(node, NODE_MATRIX);
	bool constant = true;
	matrix->columns = node->columns;
	for (int i = 0; i < node->children; i++) {
		append(matrix, derivative(node->child[i], by), false);
		constant = constant && is_zero(matrix->child[i]);
	}
	return constant ? number(node, 0) : matrix;
}

static struct node *derivative(struct node *node, const struct slope *by)
{
	struct node *choice;
	switch (node->kind) {
	case NODE_NUMBER:
	case NODE_PI:      return number(node, 0);
	case NODE_TIME:    return number(node, by->kind == SLOPE_TIME || by->kind == SLOPE_LOADS);
	case NODE_NAME:    return slope_of_name(node, by);
	case NODE_SUM:     return slope_of_sum(node, by);
	case NODE_PRODUCT: return slope_of_product(node, by);
	case NODE_POWER:   return slope_of_power(node, by);
	case NODE_CALL:    return slope_of_call(node, by);
	case NODE_MATRIX:  return slope_of_matrix(node, by);
	case NODE_CHOOSE:
		choice = like(node, NODE_CHOOSE);
		append(choice, node->child[0], false);
		append(choice, derivative(node->child[1], by), false);
		append(choice, derivative(node->child[2], by), false);
		return choice;
	default:
		error(by->at, NULL, "this derivative is not found");
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
