/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A tape as C: locals for what is read more than once, the rest inside one another. */
#include "tape/tape.h"

#include <ctype.h>
#include <string.h>

/* What the place of a text binds by: a choice stands in brackets everywhere */
enum level { CHOICE, COMPARISON, SUM, PRODUCT, PRIMARY };
enum { WIDTH = 100, LONG = 400 };           /* of a line; of an argument: compilers limit how deep brackets nest */

struct printing {
	const struct tape *t;
	const struct tape_target *to;
	FILE *out;
	int *uses, parts;           /* locals so far that have no name of their own */
	int indent;
	const char **local;         /* per node: what holds it; NULL: nothing yet */
	bool *wide;                 /* per node: is it lanes? NULL: none is */
};

static const char *text_of(struct printing *p, tape_ref ref, enum level level, int indent);

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

static const char *widened(const struct printing *p, tape_ref ref, const char *text)
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
	const char *text = text_of(p, ref, CHOICE, 18);
	return is_word(text) ? text : declare(p, ref, text);
}

static const char *argument_of(struct printing *p, tape_ref ref)
{
	const char *text = text_of(p, ref, CHOICE, 18);
	return strlen(text) > LONG && !tape_node(p->t, ref)->choice ? declare(p, ref, text) : text;
}

/* ---- operations ---- */

/* What is negative is subtracted, or added where rows are to be alike. Of (a + b) + (c + d) lines break at the middle
 * of what is too long for one, of a + b + c + d before what would not fit. */
static const char *sum_text(struct printing *p, const struct tape_node *n, int indent)
{
	bool halves = tape_node(p->t, n->b)->op == TAPE_ADD && !is_shared(p, n->b);
	const char *left = text_of(p, n->a, halves ? PRODUCT : SUM, indent + halves);
	const char *right = text_of(p, n->b, PRODUCT, indent + 1);
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
	const char *left = text_of(p, n->a, PRODUCT, indent);
	return format("%s %s %s", left, n->op == TAPE_MUL ? "*" : "/", text_of(p, n->b, PRIMARY, indent));
}

static const char *comparison_text(struct printing *p, const struct tape_node *n)
{
	static const char *const sign[2][4] = { { "<", "<=", "==", "!=" }, { ">", ">=", "==", "!=" } };
	bool turned = tape_node(p->t, n->a)->op == TAPE_CONSTANT;       /* x > 0.0, not 0.0 < x */
	const char *left = text_of(p, turned ? n->b : n->a, SUM, 18);
	return format("%s %s %s", left, sign[turned][n->op - TAPE_LESS], text_of(p, turned ? n->a : n->b, SUM, 18));
}

static const char *select_text(struct printing *p, const struct tape_node *n)
{
	const char *condition = text_of(p, n->a, COMPARISON, 18), *first = argument_of(p, n->b);
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
	const char *a = widened(p, n->a, text_of(p, n->a, CHOICE, indent));
	const char *b = widened(p, n->b, text_of(p, n->b, CHOICE, indent));
	const char *c = widened(p, n->c, text_of(p, n->c, CHOICE, indent));
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
	const char *first = widened(p, n->a, argument_of(p, n->a));
	return n->b == TAPE_NONE ? format("%s(%s)", name, first)
				 : format("%s(%s, %s)", name, first, widened(p, n->b, argument_of(p, n->b)));
}

static const char *bare_text(struct printing *p, tape_ref ref, int indent)
{
	const struct tape_node *n = tape_node(p->t, ref);
	const char *x;
	switch (n->op) {
	case TAPE_CONSTANT:
		return p->to->number ? p->to->number(p->to->context, n->value) : shortest(round_rational(n->value));
	case TAPE_TRUE:     return "1";
	case TAPE_FALSE:    return "0";
	case TAPE_NEG:
		x = text_of(p, n->a, PRODUCT, indent);
		return format(*x == '-' ? "-(%s)" : "-%s", x);
	case TAPE_NOT:      return format("!%s", text_of(p, n->a, PRIMARY, indent));
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

static const char *text_of(struct printing *p, tape_ref ref, enum level level, int indent)
{
	if (p->local[ref])
		return p->local[ref];
	bool shared = is_shared(p, ref);
	const char *text = bare_text(p, ref, shared ? 18 : indent);
	if (shared)
		return declare(p, ref, text);
	return enclosed(level_of(tape_node(p->t, ref), text) < level, text);
}

/* ---- the whole ---- */

static bool *find_wide(const struct tape *t, const struct tape_target *to)
{
	bool *wide = ARRAY(bool, tape_length(t) + 1);
	for (int i = 0; i < tape_length(t); i++) {
		const struct tape_node *n = tape_node(t, i);
		bool operand = tape_is_operand(t, i) && n->op != TAPE_CONSTANT;
		wide[i] = operand ? to->lanes->varies(to->context, n) : n->op == TAPE_ACCUMULATE;
		const tape_ref ref[3] = { n->a, n->b, n->c };
		for (int k = 0; k < 3; k++)
			wide[i] = wide[i] || (ref[k] != TAPE_NONE && wide[ref[k]]);
	}
	return wide;
}

/* A line that opens or closes a block */
static void print_line(struct printing *p, const char *line)
{
	const size_t length = strlen(line);
	p->indent -= *line == '}' ? 4 : 0;
	if (length > 0)
		fprintf(p->out, "%*s%s\n", p->indent, "", line);
	p->indent += length > 0 && line[length - 1] == '{' ? 4 : 0;
}

static void print_out(const struct printing *p, const struct tape_out *set, const char *text)
{
	const char *note = set->note ? format("  /* %s */", set->note) : "";
	if (!set->local)
		fprintf(p->out, "%*s%s = %s;%s\n", p->indent, "", set->target, text, note);
	else if (strcmp(text, set->target) != 0)
		fprintf(p->out, "%*sconst %s %s = %s;\n", p->indent, "", p->to->real, set->target, text);
}

void tape_print(const struct tape *t, const struct tape_target *to, FILE *out)
{
	struct printing p = { .t = t, .to = to, .out = out, .uses = tape_uses(t), .indent = to->indent };
	int outs = tape_outs(t);
	p.local = ARRAY(const char *, tape_length(t) + 1);
	p.wide = to->lanes ? find_wide(t, to) : NULL;
	const char **text = ARRAY(const char *, outs + 1);
	for (int i = 0; i < outs; i++) {
		tape_ref ref = tape_out(t, i)->ref;
		if (!tape_out(t, i)->target) {
			print_line(&p, tape_out(t, i)->note);
			continue;
		}
		text[i] = widened(&p, ref, text_of(&p, ref, CHOICE, tape_out(t, i)->indent));
		if (!to->locals_first)
			print_out(&p, tape_out(t, i), text[i]);
	}
	for (int i = 0; i < outs && to->locals_first; i++)
		print_out(&p, tape_out(t, i), text[i]);
}
