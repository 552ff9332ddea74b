/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Expressions of a spec as C. A coordinate x is the local x, its velocity x_dot; an acceleration counts as 0, since
 * NAME_rhs prints what the equations leave when accelerations are taken out. */
#include "emit/emit.h"

#include <string.h>

enum { BUCKETS = 1 << 12 };

struct taken {
	const char *name;
	struct taken *next;
};
struct identifier {                 /* of a symbol; [1]: of its first derivative */
	const char *name[2];
	const char **component[2];  /* of a vector coordinate */
	bool used[2];               /* by the expressions now being printed */
};
struct identifiers {
	struct taken *taken[BUCKETS]; /* by name: those given away so far */
	const char *model, *upper;  /* what begins with one of these and _ is generated */
	int symbols;
	struct identifier *symbol;  /* by the symbols' numbers */
};

/* What the generated functions use themselves. */
static const char *const own_names[] = {
	"s", "y", "t", "u", "out", "dydt", "residual", "growth", "factor", "left", "node", "which", "start", "slope",
	"interval", "excess", "now", "first", "turn", "turned", "samples", "cell", "clear",
	"fabs", "fmin", "fmax", "pow"   /* of <math.h>, which no function of a spec is named after */
};

static bool begins_with(const char *name, const char *prefix)
{
	size_t length = strlen(prefix);
	return strncmp(name, prefix, length) == 0 && name[length] == '_';
}

/* load2, part3, ...: the locals of generated functions */
static bool is_load_local(const char *name)
{
	static const char *const stem[] = { "wave", "load", "part", "left", "flow", "stage", "driven", "accel", "end",
					    "from", "to", "off", "before" };
	for (size_t i = 0; i < sizeof stem / sizeof *stem; i++) {
		size_t length = strlen(stem[i]);
		const char *number = strncmp(name, stem[i], length) == 0 ? name + length : "";
		if (*number && strspn(number, "0123456789") == strlen(number))
			return true;
	}
	return false;
}

static bool is_taken(const struct identifiers *c, const char *name)
{
	for (size_t i = 0; i < sizeof own_names / sizeof *own_names; i++)
		if (strcmp(name, own_names[i]) == 0)
			return true;
	if (is_load_local(name))
		return true;
	for (const struct taken *t = c->taken[name_hash(name) % BUCKETS]; t; t = t->next)
		if (strcmp(name, t->name) == 0)
			return true;
	return false;
}

static bool is_generated(const struct identifiers *c, const char *name)
{
	return begins_with(name, c->model) || begins_with(name, c->upper);
}

static const char *claim(struct identifiers *c, const char *wish)
{
	char *own = format("%s", wish);         /* of a part: front.body is front_body */
	for (char *point = own; (point = strchr(point, '.'));)
		*point = '_';
	const char *name = may_be_macro(own) ? format("v%s", own) : own;
	while (is_generated(c, name) || is_taken(c, name) || may_be_macro(name))
		name = is_generated(c, name) ? format("v%s", name) : format("%s_", name);
	struct taken **first = &c->taken[name_hash(name) % BUCKETS], *taken = NEW(struct taken);
	*taken = (struct taken){ name, *first };
	*first = taken;
	return name;
}

static const char *component_name(const struct identifiers *c, const struct symbol *s, int component, int order)
{
	return c->symbol[s->number].component[order][component];
}

const char *c_name(const struct identifiers *c, const struct symbol *s, int order)
{
	return c->symbol[s->number].name[order];
}

const char *written_local(const struct identifiers *c, const struct model *written, int state)
{
	int coord = written->system.coord[state], order = state >= written->n;
	const struct symbol *s = written->frame.coord[coord];
	return s->length ? component_name(c, s, coord - s->index, order) : c_name(c, s, order);
}

/* s'' as s_dot_dot, q[1] as q1, (a - b)' as a_from_b_dot; a factor in front goes */
static const char *identifier(const char *name)
{
	const char *text = "";
	for (; *name; name++) {
		const char *times = strchr(name, '*');
		if (times && strspn(name, "0123456789./-e") == (size_t)(times - name))
			name = times + 1;
		if (strncmp(name, " - ", 3) == 0) {
			text = format("%s_from_", text);
			name += 2;
		} else if (*name == '\'') {
			text = format("%s_dot", text);
		} else if (!strchr("[]()", *name)) {
			text = format("%s%c", text, *name);
		}
	}
	return text;
}

static void name_symbols(struct identifiers *c, const struct spec *spec)
{
	for (const struct symbol *s = spec->first; s; s = s->next)
		if (s->kind != SYMBOL_OUTPUT && s->kind < SYMBOL_PART_OUTPUT)
			c->symbol[s->number].name[0] = claim(c, s->name);
	for (const struct symbol *s = spec->first; s; s = s->next) {
		struct identifier *own = &c->symbol[s->number];
		if (s->kind == SYMBOL_COORD || s->kind == SYMBOL_INPUT)
			own->name[1] = claim(c, format("%s_dot", s->name));
		for (int order = 0; order < 2; order++)
			own->component[order] = ARRAY(const char *, (size_t)s->length);
		for (int i = 0; i < s->length; i++) {
			own->component[0][i] = claim(c, format("%s%d", s->name, i + 1));
			own->component[1][i] = claim(c, format("%s%d_dot", s->name, i + 1));
		}
	}
}

/* The state that is a written one; -1: none is */
static int place_of_written(const struct model *model, int state)
{
	if (model->reduction.place)
		return model->reduction.place[state];
	return model->relative ? relative_place(model, state) : state;
}

struct identifiers *identifiers_of(const struct model *model, const char *upper, const char **local)
{
	struct identifiers *c = NEW(struct identifiers);
	*c = (struct identifiers){ .model = model->name, .upper = upper, .symbols = model->spec->symbols };
	c->symbol = ARRAY(struct identifier, (size_t)c->symbols + 1);
	name_symbols(c, model->spec);
	for (int i = 0; i < model->written->system.states; i++) {
		int place = place_of_written(model, i);
		if (place >= 0)
			local[place] = written_local(c, model->written, i);
	}
	for (int i = 0; i < model->system.states; i++)
		if (!local[i])
			local[i] = claim(c, identifier(model->state_name[i]));
	return c;
}

bool vanishes(const struct node *node)
{
	bool all = node->children > 0, any = false;
	for (int i = 0; i < node->children; i++) {
		bool gone = vanishes(node->child[i]);
		all = all && gone;
		any = any || gone;
	}
	switch (node->kind) {
	case NODE_NAME:    return node->symbol->kind == SYMBOL_COORD && node->primes == node->symbol->highest;
	case NODE_SUM:     return all;
	case NODE_PRODUCT: return any;
	case NODE_POWER:   return vanishes(node->child[0]);
	default:           return false;
	}
}

/* The integer exponent of a power, 0 where it is none from 2 to 4. */
static int small_exponent(const struct node *exponent)
{
	if (exponent->kind != NODE_NUMBER || mpz_cmp_ui(mpq_denref(exponent->number), 1) != 0)
		return 0;
	return mpz_cmp_ui(mpq_numref(exponent->number), 2) >= 0 && mpz_cmp_ui(mpq_numref(exponent->number), 4) <= 0
		       ? (int)mpz_get_ui(mpq_numref(exponent->number)) : 0;
}

static bool is_plain(const struct node *node)
{
	return node->kind == NODE_NAME || node->kind == NODE_TIME || node->kind == NODE_NUMBER;
}

void forget_used(struct identifiers *c)
{
	for (int i = 0; i <= c->symbols; i++)
		c->symbol[i].used[0] = c->symbol[i].used[1] = false;
}

bool is_used(const struct identifiers *c, const struct symbol *s, int order)
{
	return c->symbol[s->number].used[order];
}

static void mark_symbol(struct identifiers *c, const struct node *name, bool *math)
{
	const struct symbol *s = name->symbol;
	bool *used = c->symbol[s->number].used, before = used[0];
	used[0] = true;
	used[1] = used[1] || (s->kind == SYMBOL_INPUT && name->primes);
	if (!before && s->kind == SYMBOL_LET)
		mark_used(c, s->value, math);
}

void mark_used(struct identifiers *c, const struct node *node, bool *math)
{
	if (vanishes(node))
		return;
	if (node->kind == NODE_NAME)
		mark_symbol(c, node, math);
	if (node->kind == NODE_CALL)
		*math = true;
	if (node->kind == NODE_POWER && !(small_exponent(node->child[1]) && is_plain(node->child[0])))
		*math = true;
	bool table = node->kind == NODE_CALL && node->function == FN_TABLE; /* its points are printed as numbers */
	const int read = table ? 1 : node->children;
	for (int i = 0; i < read; i++)
		mark_used(c, node->child[i], math);
}

/* ---- text; `tight` is the precedence that the surroundings need: 0 choice, 1 comparison, 2 sum, 3 product, 4 unary,
 * 5 primary ---- */

static const char *text_of(const struct identifiers *c, const struct node *node, int tight);

static const char *enclose(bool needed, const char *text)
{
	return needed ? format("(%s)", text) : text;
}

static const char *sum_text(const struct identifiers *c, const struct node *node, int tight)
{
	const char *text = "";
	int shown = 0;
	bool leading_sign = false;
	for (int i = 0; i < node->children; i++) {
		if (vanishes(node->child[i]))
			continue;
		const char *term = text_of(c, node->child[i], 3);
		const char *sign = node->inverse[i] ? (shown ? " - " : "-") : shown ? " + " : "";
		if (*term == '-' && *sign)
			term = format("(%s)", term);
		leading_sign = leading_sign || (!shown && node->inverse[i]);
		text = format("%s%s%s", text, sign, term);
		shown++;
	}
	return enclose(shown > 1 ? tight > 2 : leading_sign && tight > 3, text);
}

static const char *product_text(const struct identifiers *c, const struct node *node, int tight)
{
	const char *text = text_of(c, node->child[0], 3);
	for (int i = 1; i < node->children; i++)
		text = format("%s%s%s", text, node->inverse[i] ? "/" : "*", text_of(c, node->child[i], 4));
	return enclose(tight > 3, text);
}

static const char *power_text(const struct identifiers *c, const struct node *node)
{
	int exponent = small_exponent(node->child[1]);
	const char *base = text_of(c, node->child[0], exponent && is_plain(node->child[0]) ? 5 : 0);
	if (!exponent || !is_plain(node->child[0]))
		return format("pow(%s, %s)", base, text_of(c, node->child[1], 0));
	const char *text = base;
	for (int i = 1; i < exponent; i++)
		text = format("%s*%s", text, base);
	return format("(%s)", text);
}

/* min, max: two by two */
static const char *fold_text(const struct identifiers *c, const char *function, const struct node *node)
{
	const char *text = text_of(c, node->child[0], 0);
	for (int i = 1; i < node->children; i++)
		text = format("%s(%s, %s)", function, text, text_of(c, node->child[i], 0));
	return text;
}

/* (x < x1 ? y0 + slope*(x - x0) : x < x2 ? ... ): one piece between each two points, the end ones extended */
static const char *table_text(const struct identifiers *c, const struct node *node)
{
	const char *x = text_of(c, node->child[0], 5), *text = "";
	struct straight *piece;
	int pieces = pieces_of_call(node, &piece);
	for (const struct straight *p = piece; p < piece + pieces; p++) {
		const char *condition = p->end ? format("%s < %s ? ", x, finite_text(node->at, p->end)) : "";
		text = format("%s%s%s%s + %s*(%s - %s)", text, *text ? " : " : "", condition,
			      finite_text(node->at, p->y), finite_text(node->at, p->slope), x,
			      finite_text(node->at, p->x));
	}
	return format("(%s)", text);
}

static const char *sign_text(const struct identifiers *c, const struct node *operand)
{
	const char *x = text_of(c, operand, 2);
	return format("(double)((%s > 0) - (%s < 0))", x, x);
}

static const char *clip_text(const struct identifiers *c, const struct node *node)
{
	const char *x = text_of(c, node->child[0], 0);
	return format("fmin(fmax(%s, %s), %s)", x, text_of(c, node->child[1], 0), text_of(c, node->child[2], 0));
}

static const char *call_text(const struct identifiers *c, const struct node *node)
{
	if (node->function == FN_TABLE)
		return table_text(c, node);
	const char *x = text_of(c, node->child[0], 0);
	switch (node->function) {
	case FN_ABS: return format("fabs(%s)", x);
	case FN_SGN: return sign_text(c, node->child[0]);
	case FN_MIN: return fold_text(c, "fmin", node);
	case FN_MAX: return fold_text(c, "fmax", node);
	case FN_ATAN2: return format("atan2(%s, %s)", x, text_of(c, node->child[1], 0));
	case FN_CLIP: return clip_text(c, node);
	case FN_DEADZONE: return format("(%s - %s)", text_of(c, node->child[0], 2), clip_text(c, node));
	default: return format("%s(%s)", function_name(node->function), x);
	}
}

static const char *choice_text(const struct identifiers *c, const struct node *node, int tight)
{
	const char *condition = text_of(c, node->child[0], 1);
	const char *then = text_of(c, node->child[1], 1), *otherwise = text_of(c, node->child[2], 0);
	return enclose(tight > 0, format("%s ? %s : %s", condition, then, otherwise));
}

static const char *comparison_text(const struct identifiers *c, const struct node *node, int tight)
{
	static const char *const sign[] = { "<", "<=", ">", ">=", "==", "!=" };
	const char *left = text_of(c, node->child[0], 2), *right = text_of(c, node->child[1], 2);
	return enclose(tight > 1, format("%s %s %s", left, sign[node->comparison], right));
}

static const char *name_text(const struct identifiers *c, const struct node *node)
{
	const struct symbol *s = node->symbol;
	int order = node->primes > 0;
	return node->component ? component_name(c, s, node->component - 1, order) : c_name(c, s, order);
}

static const char *text_of(const struct identifiers *c, const struct node *node, int tight)
{
	if (vanishes(node))
		return "0.0";
	switch (node->kind) {
	case NODE_NUMBER:  return finite_text(node->at, node->number);
	case NODE_PI:      return "3.141592653589793";
	case NODE_TIME:    return "t";
	case NODE_NAME:    return name_text(c, node);
	case NODE_SUM:     return sum_text(c, node, tight);
	case NODE_PRODUCT: return product_text(c, node, tight);
	case NODE_POWER:   return power_text(c, node);
	case NODE_CALL:    return call_text(c, node);
	case NODE_CHOOSE:  return choice_text(c, node, tight);
	default:           return comparison_text(c, node, tight);
	}
}

const char *c_expression(const struct identifiers *c, const struct node *node)
{
	return text_of(c, node, 2);
}
