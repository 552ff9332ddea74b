/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Expressions of a spec as they are written, as nodes of a tape; highest derivatives count as 0 unless they are asked
 * for. */
#include "tape/tape.h"

struct tape_expressions {
	struct tape *tape;
	bool highest;
	const char *(*let_name)(const void *context, const struct symbol *let);
	const void *context;
	tape_ref *let;              /* by the symbols' numbers; UNMADE: not yet */
};
enum { UNMADE = -2 };               /* beside TAPE_NONE: nothing is left of it when accelerations are 0 */

struct tape_expressions *tape_expressions_new(struct tape *t, int symbols, bool highest,
					      const char *(*let_name)(const void *context, const struct symbol *let),
					      const void *context)
{
	struct tape_expressions *x = NEW(struct tape_expressions);
	*x = (struct tape_expressions){ .tape = t, .highest = highest, .let_name = let_name, .context = context };
	x->let = ARRAY(tape_ref, symbols + 1);
	for (int i = 0; i <= symbols; i++)
		x->let[i] = UNMADE;
	return x;
}

static tape_ref read_node(struct tape_expressions *x, const struct node *node);

/* As a number: a condition that holds is 1 */
static tape_ref number_of(struct tape_expressions *x, const struct node *node)
{
	struct tape *t = x->tape;
	tape_ref ref = read_node(x, node);
	if (ref == TAPE_NONE)
		return tape_number(t, 0);
	return tape_node(t, ref)->choice ? tape_select(t, ref, tape_number(t, 1), tape_number(t, 0)) : ref;
}

/* ---- operations ---- */

static tape_ref sum(struct tape_expressions *x, const struct node *node)
{
	struct tape *t = x->tape;
	tape_ref all = TAPE_NONE;
	for (int i = 0; i < node->children; i++) {
		if (read_node(x, node->child[i]) == TAPE_NONE)
			continue;
		tape_ref term = number_of(x, node->child[i]);
		term = node->inverse[i] ? tape_unary(t, TAPE_NEG, term) : term;
		all = all == TAPE_NONE ? term : tape_binary(t, TAPE_ADD, all, term);
	}
	return all;
}

static tape_ref product(struct tape_expressions *x, const struct node *node)
{
	tape_ref all = TAPE_NONE;
	for (int i = 0; i < node->children; i++) {
		if (read_node(x, node->child[i]) == TAPE_NONE)
			return TAPE_NONE;
		tape_ref factor = number_of(x, node->child[i]);
		all = i == 0 ? factor : tape_binary(x->tape, node->inverse[i] ? TAPE_DIV : TAPE_MUL, all, factor);
	}
	return all;
}

static tape_ref power(struct tape_expressions *x, const struct node *node)
{
	enum { SMALL = 4 };
	const struct node *exponent = node->child[1];
	if (read_node(x, node->child[0]) == TAPE_NONE)
		return TAPE_NONE;
	tape_ref base = number_of(x, node->child[0]);
	bool whole = exponent->kind == NODE_NUMBER && mpz_cmp_ui(mpq_denref(exponent->number), 1) == 0 &&
		     mpz_cmp_ui(mpq_numref(exponent->number), 1) >= 0 &&
		     mpz_cmp_ui(mpq_numref(exponent->number), SMALL) <= 0;
	return whole ? tape_power(x->tape, base, (unsigned)mpz_get_ui(mpq_numref(exponent->number)))
		     : tape_binary(x->tape, TAPE_POWER, base, number_of(x, exponent));
}

static tape_ref extreme(struct tape *t, enum comparison comparison, tape_ref a, tape_ref b)
{
	return tape_select(t, tape_compare(t, comparison, a, b), a, b);
}

static tape_ref clipped(struct tape_expressions *x, const struct node *node)
{
	tape_ref low = number_of(x, node->child[1]), high = number_of(x, node->child[2]);
	return extreme(x->tape, CMP_LT, high, extreme(x->tape, CMP_GT, low, number_of(x, node->child[0])));
}

static tape_ref table(struct tape_expressions *x, const struct node *node)
{
	struct tape *t = x->tape;
	struct straight *piece;
	int pieces = pieces_of_call(node, &piece);
	tape_ref argument = number_of(x, node->child[0]), *below = ARRAY(tape_ref, pieces + 1);
	for (int p = 0; p < pieces && piece[p].end; p++)
		below[p] = tape_compare(t, CMP_LT, argument, tape_constant(t, piece[p].end));
	return tape_table(t, argument, pieces, piece, below);
}

static tape_ref call(struct tape_expressions *x, const struct node *node)
{
	struct tape *t = x->tape;
	if (node->function == FN_TABLE)
		return table(x, node);
	tape_ref a = number_of(x, node->child[0]);
	switch (node->function) {
	case FN_ABS:   return tape_unary(t, TAPE_SIZE, a);
	case FN_SGN:   return tape_unary(t, TAPE_SIGN, a);
	case FN_MIN:
	case FN_MAX:
		for (int i = 1; i < node->children; i++)
			a = extreme(t, node->function == FN_MIN ? CMP_LT : CMP_GT, number_of(x, node->child[i]), a);
		return a;
	case FN_ATAN2: return tape_binary(t, TAPE_ATAN2, a, number_of(x, node->child[1]));
	case FN_CLIP:  return clipped(x, node);
	case FN_DEADZONE:
		return tape_binary(t, TAPE_ADD, a, tape_unary(t, TAPE_NEG, clipped(x, node)));
	default:       return tape_call(t, node->function, a);
	}
}

static tape_ref choice(struct tape_expressions *x, const struct node *node)
{
	struct tape *t = x->tape;
	tape_ref condition = read_node(x, node->child[0]);
	if (condition == TAPE_NONE || !tape_node(t, condition)->choice)
		condition = tape_binary(t, TAPE_UNEQUAL, number_of(x, node->child[0]), tape_number(t, 0));
	tape_ref a = number_of(x, node->child[1]);
	return tape_select(t, condition, a, number_of(x, node->child[2]));
}

static tape_ref let(struct tape_expressions *x, const struct symbol *s)
{
	tape_ref *made = &x->let[s->number];
	if (*made == UNMADE) {
		*made = read_node(x, s->value);
		if (*made != TAPE_NONE && !tape_is_operand(x->tape, *made))
			tape_name(x->tape, *made, x->let_name(x->context, s));
	}
	return *made;
}

static tape_ref name(struct tape_expressions *x, const struct node *node)
{
	const struct symbol *s = node->symbol;
	int place = s->index + (node->component ? node->component - 1 : 0);
	switch (s->kind) {
	case SYMBOL_LET:   return let(x, s);
	case SYMBOL_PARAM: return tape_operand(x->tape, TAPE_PARAM, s->number, 0);
	case SYMBOL_INPUT: return tape_operand(x->tape, TAPE_INPUT, place, node->primes);
	default:           break;
	}
	if (node->primes == s->highest && !x->highest)
		return TAPE_NONE;
	return tape_operand(x->tape, TAPE_COORD, place, node->primes);
}

static tape_ref read_node(struct tape_expressions *x, const struct node *node)
{
	struct tape *t = x->tape;
	switch (node->kind) {
	case NODE_NUMBER:  return tape_constant(t, node->number);
	case NODE_PI:      return tape_pi(t);
	case NODE_TIME:    return tape_operand(t, TAPE_TIME, 0, 0);
	case NODE_NAME:    return name(x, node);
	case NODE_SUM:     return sum(x, node);
	case NODE_PRODUCT: return product(x, node);
	case NODE_POWER:   return power(x, node);
	case NODE_CALL:    return call(x, node);
	case NODE_CHOOSE:  return choice(x, node);
	default:           break;
	}
	tape_ref left = number_of(x, node->child[0]);
	return tape_compare(t, node->comparison, left, number_of(x, node->child[1]));
}

tape_ref tape_expression(struct tape_expressions *x, const struct node *node)
{
	return number_of(x, node);
}
