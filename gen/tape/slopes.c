/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives of a tape as further nodes of it (Griewank and Walther, Evaluating Derivatives, 2008, sections 3.1 and
 * 3.2): forward along one operand, in reverse for all of a kind. */
#include "tape/tape.h"

static bool is_number(const struct tape *t, tape_ref ref, long value)
{
	const struct tape_node *n = tape_node(t, ref);
	return n->op == TAPE_CONSTANT && mpq_cmp_si(n->value, value, 1) == 0;
}

/* What is 0 or 1 by structure leaves no operation. */
static tape_ref product(struct tape *t, tape_ref a, tape_ref b)
{
	if (is_number(t, a, 0) || is_number(t, b, 1))
		return a;
	if (is_number(t, b, 0) || is_number(t, a, 1))
		return b;
	if (is_number(t, a, -1) || is_number(t, b, -1))
		return tape_unary(t, TAPE_NEG, is_number(t, a, -1) ? b : a);
	return tape_binary(t, TAPE_MUL, a, b);
}

static tape_ref sum(struct tape *t, tape_ref a, tape_ref b)
{
	return is_number(t, a, 0) ? b : is_number(t, b, 0) ? a : tape_binary(t, TAPE_ADD, a, b);
}

static tape_ref quotient(struct tape *t, tape_ref a, tape_ref b)
{
	return tape_binary(t, TAPE_DIV, a, b);
}

static tape_ref negative(struct tape *t, tape_ref a)
{
	return tape_unary(t, TAPE_NEG, a);
}

static tape_ref square(struct tape *t, tape_ref a)
{
	return tape_binary(t, TAPE_MUL, a, a);
}

/* f'(x) of a function of one argument; y is f(x) */
static tape_ref slope_of_function(struct tape *t, enum function function, tape_ref x, tape_ref y)
{
	tape_ref one = tape_number(t, 1);
	switch (function) {
	case FN_SIN:  return tape_call(t, FN_COS, x);
	case FN_COS:  return negative(t, tape_call(t, FN_SIN, x));
	case FN_TAN:  return sum(t, one, square(t, y));
	case FN_EXP:  return y;
	case FN_LOG:  return quotient(t, one, x);
	case FN_SQRT: return quotient(t, one, tape_binary(t, TAPE_ADD, y, y));
	case FN_SINH: return tape_call(t, FN_COSH, x);
	case FN_COSH: return tape_call(t, FN_SINH, x);
	case FN_TANH: return sum(t, one, negative(t, square(t, y)));
	case FN_ASIN:
	case FN_ACOS:
		x = quotient(t, one, tape_call(t, FN_SQRT, sum(t, one, negative(t, square(t, x)))));
		return function == FN_ASIN ? x : negative(t, x);
	case FN_ATAN: return quotient(t, one, sum(t, one, square(t, x)));
	default:      return tape_number(t, 0);
	}
}

/* b^e by its base, and by its exponent: b^e log b */
static tape_ref slope_of_power(struct tape *t, tape_ref power, const struct tape_node *n, int which)
{
	if (which)
		return tape_binary(t, TAPE_MUL, power, tape_call(t, FN_LOG, n->a));
	return product(t, n->b, tape_binary(t, TAPE_POWER, n->a, tape_binary(t, TAPE_ADD, n->b, tape_number(t, -1))));
}

static tape_ref slope_of_atan2(struct tape *t, const struct tape_node *n, int which)
{
	tape_ref size = sum(t, square(t, n->a), square(t, n->b));
	return which ? negative(t, quotient(t, n->a, size)) : quotient(t, n->b, size);
}

/* Of node `ref` by its first operand, or its second. The node's copy: the list moves as it grows. */
static tape_ref partial(struct tape *t, tape_ref ref, int which)
{
	const struct tape_node n = *tape_node(t, ref);
	switch (n.op) {
	case TAPE_NEG:   return tape_number(t, -1);
	case TAPE_SIZE:  return tape_unary(t, TAPE_SIGN, n.a);
	case TAPE_CALL:  return slope_of_function(t, (enum function)n.index, n.a, ref);
	case TAPE_ADD:
	case TAPE_ACCUMULATE: return tape_number(t, 1);
	case TAPE_MUL:   return which ? n.a : n.b;
	case TAPE_DIV:   return which ? negative(t, quotient(t, ref, n.b)) : quotient(t, tape_number(t, 1), n.b);
	case TAPE_POWER: return slope_of_power(t, ref, &n, which);
	case TAPE_ATAN2: return slope_of_atan2(t, &n, which);
	default:         return tape_number(t, 0);
	}
}

tape_ref tape_forward(struct tape *t, tape_ref ref, enum tape_op kind, int index, int part)
{
	SCRATCH tape_ref *slope = ARRAY(tape_ref, ref + 1);
	tape_ref zero = tape_number(t, 0), one = tape_number(t, 1);
	for (int i = 0; i <= ref; i++) {
		const struct tape_node n = *tape_node(t, i);
		slope[i] = (n.op == kind && n.index == index && n.part == part) ? one : zero;
		if (n.op == TAPE_SELECT && !n.choice)
			slope[i] = tape_select(t, n.a, slope[n.b], slope[n.c]);
		const tape_ref operand[3] = { n.a, n.b, n.c };
		for (int k = 0; k < 3 && n.op != TAPE_SELECT && !n.choice; k++)
			if (operand[k] != TAPE_NONE && slope[operand[k]] != zero)
				slope[i] = sum(t, slope[i], product(t, partial(t, i, k), slope[operand[k]]));
	}
	return slope[ref];
}

/* What d ref by node i adds to that by each of its operands */
static void hand_back(struct tape *t, int i, tape_ref *by)
{
	const struct tape_node n = *tape_node(t, i);
	const tape_ref operand[3] = { n.a, n.b, n.c };
	if (n.op == TAPE_SELECT) {
		tape_ref zero = tape_number(t, 0);
		by[n.b] = sum(t, by[n.b], tape_select(t, n.a, by[i], zero));
		by[n.c] = sum(t, by[n.c], tape_select(t, n.a, zero, by[i]));
		return;
	}
	for (int k = 0; k < 3; k++)
		if (operand[k] != TAPE_NONE)
			by[operand[k]] = sum(t, by[operand[k]], product(t, partial(t, i, k), by[i]));
}

void tape_reverse(struct tape *t, tape_ref ref, enum tape_op kind, int count, tape_ref *slope)
{
	SCRATCH tape_ref *by = ARRAY(tape_ref, ref + 1);
	tape_ref zero = tape_number(t, 0);
	for (int i = 0; i <= ref; i++)
		by[i] = zero;
	for (int i = 0; i < count; i++)
		slope[i] = zero;
	by[ref] = tape_number(t, 1);
	for (int i = ref; i >= 0; i--) {
		const struct tape_node *n = tape_node(t, i);
		if (n->op == kind && n->index < count)
			slope[n->index] = by[i];
		else if (by[i] != zero && !n->choice)
			hand_back(t, i, by);
	}
}
