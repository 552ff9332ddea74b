/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nodes of a tape as C: locals for what is read more than once, the rest inside one another. */
#include "tape/print.h"

#include <ctype.h>
#include <string.h>

enum { WIDTH = 100, LONG = 400 };           /* of a line; of an argument: compilers limit how deep brackets nest */

static const char *enclosed(bool needed, const char *text)
{
	return needed ? format("(%s)", text) : text;
}

/* ---- locals ---- */

static bool is_shared(const struct printing *p, tape_ref ref)
{
	bool plain = tape_is_operand(p->t, ref) || tape_is_cheap(p->t, ref), named = tape_node(p->t, ref)->name != NULL;
	return named || (!plain && p->uses[ref] > 1);
}

const char *tape_widened(const struct printing *p, tape_ref ref, const char *text)
{
	return p->wide && !p->wide[ref] ? format("%s(%s)", p->to->lanes->widen, text) : text;
}

static const char *declare(struct printing *p, tape_ref ref, const char *text)
{
	const char *name = tape_node(p->t, ref)->name;
	name = name ? name : format("part%d", ++p->parts);
	const char *type = p->wide && p->wide[ref] ? p->to->lanes->type : p->to->real;
	fprintf(p->out, "%*sconst %s %s = %s;\n", p->indent, "", type, name, text);
	return p->local[ref] = name;
}

static bool is_word(const char *text)
{
	return text[strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789.[]")] == 0;
}

/* What a text needs more than once is a name. */
static const char *word_of(struct printing *p, tape_ref ref)
{
	const char *text = tape_text(p, ref, CHOICE, 18);
	return is_word(text) || p->leaf ? text : declare(p, ref, text);
}

static const char *argument_of(struct printing *p, tape_ref ref)
{
	const char *text = tape_text(p, ref, CHOICE, 18);
	const bool deep = strlen(text) > LONG && !tape_node(p->t, ref)->choice && !p->leaf;
	return deep ? declare(p, ref, text) : text;
}

/* ---- operations ---- */

/* What is negative is subtracted, or added where rows are to be alike. Of (a + b) + (c + d) lines break at the middle
 * of what is too long for one, of a + b + c + d before what would not fit. */
static const char *sum_text(struct printing *p, const struct tape_node *n, int indent)
{
	bool halves = tape_node(p->t, n->b)->op == TAPE_ADD && !is_shared(p, n->b);
	const char *left = tape_text(p, n->a, halves ? PRODUCT : SUM, indent + halves);
	const char *right = tape_text(p, n->b, PRODUCT, indent + 1);
	const bool subtracted = *right == '-' && !(p->to->rows_alike && isdigit((unsigned char)right[1]));
	const char *sign = subtracted ? "-" : "+";
	right += subtracted;
	const char *line = strrchr(left, '\n');
	int width = line && !halves ? (int)strlen(line + 1) : (int)strlen(left) + indent;
	bool first = halves && is_word(left), wide = !first && width + (int)strlen(right) > WIDTH;
	return wide ? format("%s\n%*s%s %s", left, indent, "", sign, right) : format("%s %s %s", left, sign, right);
}

static const char *product_text(struct printing *p, const struct tape_node *n, int indent)
{
	const char *left = tape_text(p, n->a, PRODUCT, indent);
	return format("%s %s %s", left, n->op == TAPE_MUL ? "*" : "/", tape_text(p, n->b, PRIMARY, indent));
}

static const char *comparison_text(struct printing *p, const struct tape_node *n)
{
	static const char *const sign[2][4] = { { "<", "<=", "==", "!=" }, { ">", ">=", "==", "!=" } };
	bool turned = tape_node(p->t, n->a)->op == TAPE_CONSTANT;       /* x > 0.0, not 0.0 < x */
	const char *left = tape_text(p, turned ? n->b : n->a, SUM, 18);
	return format("%s %s %s", left, sign[turned][n->op - TAPE_LESS], tape_text(p, turned ? n->a : n->b, SUM, 18));
}

static const char *select_text(struct printing *p, const struct tape_node *n)
{
	const char *condition = tape_text(p, n->a, COMPARISON, 18), *first = argument_of(p, n->b);
	return format("(%s ? %s : %s)", condition, first, argument_of(p, n->c));
}

static const char *call_text(struct printing *p, const char *function, const struct tape_node *n)
{
	const char *first = argument_of(p, n->a);
	return n->b == TAPE_NONE ? format("%s(%s)", function, first)
				 : format("%s(%s, %s)", function, first, argument_of(p, n->b));
}

/* Each argument on a line of its own where it is long */
static const char *accumulated_text(struct printing *p, const struct tape_node *n, int indent)
{
	const char *a = tape_widened(p, n->a, tape_text(p, n->a, CHOICE, indent));
	const char *b = tape_widened(p, n->b, tape_text(p, n->b, CHOICE, indent));
	const char *c = tape_widened(p, n->c, tape_text(p, n->c, CHOICE, indent));
	const char *between = strlen(b) + strlen(c) > WIDTH / 2 ? format(",\n%*s", indent, "") : ", ";
	return format("%s(%s%s%s%s%s, &%s)", p->to->accumulate, a, between, b, between, c,
		      p->to->operand(p->to->context, n));
}

/* Of <math.h>; of lanes the function that takes each by itself */
static const char *function_text(struct printing *p, tape_ref ref, const char *function)
{
	const struct tape_node *n = tape_node(p->t, ref);
	if (!p->wide || !p->wide[ref])
		return call_text(p, function, n);
	const char *name = format("%s%s", p->to->lanes->function, function);
	const char *first = tape_widened(p, n->a, argument_of(p, n->a));
	return n->b == TAPE_NONE ? format("%s(%s)", name, first)
				 : format("%s(%s, %s)", name, first, tape_widened(p, n->b, argument_of(p, n->b)));
}

const char *tape_bare_text(struct printing *p, tape_ref ref, int indent)
{
	const struct tape_node *n = tape_node(p->t, ref);
	const char *x;
	switch (n->op) {
	case TAPE_CONSTANT:
		return p->to->number ? p->to->number(p->to->context, n->value) : shortest(round_rational(n->value));
	case TAPE_TRUE:     return "1";
	case TAPE_FALSE:    return "0";
	case TAPE_NEG:
		x = tape_text(p, n->a, PRODUCT, indent);
		return format(*x == '-' ? "-(%s)" : "-%s", x);
	case TAPE_NOT:      return format("!%s", tape_text(p, n->a, PRIMARY, indent));
	case TAPE_SIGN:
		x = word_of(p, n->a);
		return format("(%s)((%s > 0.0) - (%s < 0.0))", p->to->real, x, x);
	case TAPE_SIZE:     return call_text(p, p->to->size, n);
	case TAPE_CALL:     return function_text(p, ref, function_name((enum function)n->index));
	case TAPE_POWER:    return function_text(p, ref, "pow");
	case TAPE_ATAN2:    return function_text(p, ref, "atan2");
	case TAPE_ADD:      return sum_text(p, n, indent);
	case TAPE_MUL:
	case TAPE_DIV:      return product_text(p, n, indent);
	case TAPE_SELECT:   return select_text(p, n);
	case TAPE_ACCUMULATE: return accumulated_text(p, n, indent);
	default:            break;
	}
	return n->op >= TAPE_LESS ? comparison_text(p, n) : p->to->operand(p->to->context, n);
}

static enum level level_of(const struct tape_node *n, const char *text)
{
	switch (n->op) {
	case TAPE_ADD:      return SUM;
	case TAPE_NEG:
	case TAPE_MUL:
	case TAPE_DIV:      return PRODUCT;
	case TAPE_CONSTANT: return *text == '-' ? PRODUCT : PRIMARY;
	case TAPE_NOT:      return PRIMARY;
	case TAPE_ABOVE:    return COMPARISON;
	default:            return n->op >= TAPE_LESS && n->op <= TAPE_UNEQUAL ? COMPARISON : PRIMARY;
	}
}

const char *tape_text(struct printing *p, tape_ref ref, enum level level, int indent)
{
	const char *leaf = p->leaf ? p->leaf(p, ref) : p->local[ref];
	if (leaf)
		return enclosed(!p->local[ref] && level_of(tape_node(p->t, ref), leaf) < level, leaf);
	bool shared = !p->leaf && is_shared(p, ref);
	const char *text = tape_bare_text(p, ref, shared ? 18 : indent);
	if (shared)
		return declare(p, ref, text);
	return enclosed(level_of(tape_node(p->t, ref), text) < level, text);
}

void tape_set_text(const struct printing *p, const struct tape_out *set, const char *text)
{
	const char *note = set->note ? format("  /* %s */", set->note) : "";
	if (!set->local)
		fprintf(p->out, "%*s%s = %s;%s\n", p->indent, "", set->target, text, note);
	else if (strcmp(text, set->target) != 0)
		fprintf(p->out, "%*sconst %s %s = %s;\n", p->indent, "", p->to->real, set->target, text);
}
