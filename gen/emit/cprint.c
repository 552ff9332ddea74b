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
struct naming {                     /* the identifiers given away so far */
	struct taken *taken[BUCKETS]; /* by name */
	const char *name, *upper;   /* the model's: what begins with one of these and _ is generated */
};

/* What the generated functions use themselves. */
static const char *const own_names[] = {
	"s", "y", "t", "u", "out", "dydt", "residual", "growth", "factor", "left", "node", "which", "start", "slope", "excess", "now", "first",
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
	static const char *const stem[] = { "wave", "load", "part", "left", "flow", "stage", "driven", "accel" };
	for (size_t i = 0; i < sizeof stem / sizeof *stem; i++) {
		size_t length = strlen(stem[i]);
		if (strncmp(name, stem[i], length) == 0 && name[length] && strspn(name + length, "0123456789") == strlen(name + length))
			return true;
	}
	return false;
}

static bool is_taken(const struct naming *naming, const char *name)
{
	for (size_t i = 0; i < sizeof own_names / sizeof *own_names; i++)
		if (strcmp(name, own_names[i]) == 0)
			return true;
	if (is_load_local(name))
		return true;
	for (const struct taken *t = naming->taken[name_hash(name) % BUCKETS]; t; t = t->next)
		if (strcmp(name, t->name) == 0)
			return true;
	return false;
}

static bool is_generated(const struct naming *naming, const char *name)
{
	return begins_with(name, naming->name) || begins_with(name, naming->upper);
}

static const char *claim(struct naming *naming, const char *wish)
{
	const char *name = may_be_macro(wish) ? format("v%s", wish) : wish;
	while (is_generated(naming, name) || is_taken(naming, name) || may_be_macro(name))
		name = is_generated(naming, name) ? format("v%s", name) : format("%s_", name);
	struct taken **first = &naming->taken[name_hash(name) % BUCKETS], *taken = NEW(struct taken);
	*taken = (struct taken){ name, *first };
	*first = taken;
	return name;
}

/* C's name of a written state */
const char *written_local(const struct model *written, int state)
{
	int coord = written->system.coord[state];
	const struct symbol *s = written->frame.coord[coord];
	bool velocity = state >= written->n;
	if (s->length)
		return (velocity ? s->c_component_dot : s->c_component)[coord - s->index];
	return velocity ? s->c_dot : s->c_name;
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

void name_for_c(const struct model *model, const char *upper, const char **local)
{
	const struct spec *spec = model->spec;
	struct naming all = { .name = model->name, .upper = upper }, *naming = &all;
	for (struct symbol *s = spec->first; s; s = s->next)
		if (s->kind != SYMBOL_OUTPUT)
			s->c_name = claim(naming, s->name);
	for (struct symbol *s = spec->first; s; s = s->next) {
		if (s->kind == SYMBOL_COORD || s->kind == SYMBOL_INPUT)
			s->c_dot = claim(naming, format("%s_dot", s->name));
		s->c_component = ARRAY(const char *, (size_t)s->length);
		s->c_component_dot = ARRAY(const char *, (size_t)s->length);
		for (int i = 0; i < s->length; i++) {
			s->c_component[i] = claim(naming, format("%s%d", s->name, i + 1));
			s->c_component_dot[i] = claim(naming, format("%s%d_dot", s->name, i + 1));
		}
	}
	for (int i = 0; i < model->written->system.states; i++) {
		int place = model->reduction.place ? model->reduction.place[i] : model->relative ? relative_place(model, i) : i;
		if (place >= 0)
			local[place] = written_local(model->written, i);
	}
	for (int i = 0; i < model->system.states; i++)
		if (!local[i])
			local[i] = claim(naming, identifier(model->state_name[i]));
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

void mark_used(const struct node *node, bool *math)
{
	if (vanishes(node))
		return;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_INPUT && node->primes)
		node->symbol->slope_used = true;
	if (node->kind == NODE_NAME && !node->symbol->used) {
		node->symbol->used = true;
		if (node->symbol->kind == SYMBOL_LET)
			mark_used(node->symbol->value, math);
	}
	if (node->kind == NODE_CALL)
		*math = true;
	if (node->kind == NODE_POWER && !(small_exponent(node->child[1]) && is_plain(node->child[0])))
		*math = true;
	const int read = node->kind == NODE_CALL && node->function == FN_TABLE ? 1 : node->children;  /* the points are printed as numbers */
	for (int i = 0; i < read; i++)
		mark_used(node->child[i], math);
}

/* ---- text; `tight` is the precedence that the surroundings need: 0 choice, 1 comparison, 2 sum, 3 product, 4 unary, 5 primary ---- */

static const char *text_of(const struct node *node, int tight);

static const char *enclose(bool needed, const char *text)
{
	return needed ? format("(%s)", text) : text;
}

static const char *sum_text(const struct node *node, int tight)
{
	const char *text = "";
	int shown = 0;
	bool leading_sign = false;
	for (int i = 0; i < node->children; i++) {
		if (vanishes(node->child[i]))
			continue;
		const char *term = text_of(node->child[i], 3);
		const char *sign = node->inverse[i] ? (shown ? " - " : "-") : shown ? " + " : "";
		if (*term == '-' && *sign)
			term = format("(%s)", term);
		leading_sign = leading_sign || (!shown && node->inverse[i]);
		text = format("%s%s%s", text, sign, term);
		shown++;
	}
	return enclose(shown > 1 ? tight > 2 : leading_sign && tight > 3, text);
}

static const char *product_text(const struct node *node, int tight)
{
	const char *text = text_of(node->child[0], 3);
	for (int i = 1; i < node->children; i++)
		text = format("%s%s%s", text, node->inverse[i] ? "/" : "*", text_of(node->child[i], 4));
	return enclose(tight > 3, text);
}

static const char *power_text(const struct node *node)
{
	int exponent = small_exponent(node->child[1]);
	const char *base = text_of(node->child[0], exponent && is_plain(node->child[0]) ? 5 : 0);
	if (!exponent || !is_plain(node->child[0]))
		return format("pow(%s, %s)", base, text_of(node->child[1], 0));
	const char *text = base;
	for (int i = 1; i < exponent; i++)
		text = format("%s*%s", text, base);
	return format("(%s)", text);
}

/* min, max: two by two */
static const char *fold_text(const char *function, const struct node *node)
{
	const char *text = text_of(node->child[0], 0);
	for (int i = 1; i < node->children; i++)
		text = format("%s(%s, %s)", function, text, text_of(node->child[i], 0));
	return text;
}

static void point(const struct node *node, int index, mpq_ptr value)
{
	struct collector collector = { .scheme = "exact" };
	collect_constant(&collector, node->child[index], value);
}

/* (x < x1 ? y0 + slope*(x - x0) : x < x2 ? ... ): one piece between each two points, the end ones extended */
static const char *table_text(const struct node *node)
{
	const char *x = text_of(node->child[0], 5), *text = "";
	mpq_t x0, y0, x1, y1;
	mpq_inits(x0, y0, x1, y1, NULL);
	for (int k = 1; k + 3 < node->children; k += 2) {
		point(node, k, x0);
		point(node, k + 1, y0);
		point(node, k + 2, x1);
		point(node, k + 3, y1);
		const char *condition = k + 5 < node->children ? format("%s < %s ? ", x, finite_text(node->at, x1)) : "";
		mpq_sub(y1, y1, y0);
		mpq_sub(x1, x1, x0);
		mpq_div(y1, y1, x1);
		text = format("%s%s%s%s + %s*(%s - %s)", text, *text ? " : " : "", condition, finite_text(node->at, y0), finite_text(node->at, y1), x,
			      finite_text(node->at, x0));
	}
	mpq_clears(x0, y0, x1, y1, NULL);
	return format("(%s)", text);
}

static const char *call_text(const struct node *node)
{
	if (node->function == FN_TABLE)
		return table_text(node);
	const char *x = text_of(node->child[0], 0);
	switch (node->function) {
	case FN_ABS: return format("fabs(%s)", x);
	case FN_SGN: return format("(double)((%s > 0) - (%s < 0))", text_of(node->child[0], 2), text_of(node->child[0], 2));
	case FN_MIN: return fold_text("fmin", node);
	case FN_MAX: return fold_text("fmax", node);
	case FN_ATAN2: return format("atan2(%s, %s)", x, text_of(node->child[1], 0));
	case FN_CLIP:
		return format("fmin(fmax(%s, %s), %s)", x, text_of(node->child[1], 0), text_of(node->child[2], 0));
	case FN_DEADZONE:
		return format("(%s - fmin(fmax(%s, %s), %s))", text_of(node->child[0], 2), x, text_of(node->child[1], 0), text_of(node->child[2], 0));
	default: return format("%s(%s)", function_name(node->function), x);
	}
}

static const char *choice_text(const struct node *node, int tight)
{
	return enclose(tight > 0, format("%s ? %s : %s", text_of(node->child[0], 1), text_of(node->child[1], 1), text_of(node->child[2], 0)));
}

static const char *name_text(const struct node *node)
{
	const struct symbol *s = node->symbol;
	if (node->component)
		return (node->primes ? s->c_component_dot : s->c_component)[node->component - 1];
	return node->primes ? s->c_dot : s->c_name;
}

static const char *text_of(const struct node *node, int tight)
{
	static const char *const comparisons[] = { "<", "<=", ">", ">=", "==", "!=" };
	if (vanishes(node))
		return "0.0";
	switch (node->kind) {
	case NODE_NUMBER:  return finite_text(node->at, node->number);
	case NODE_PI:      return "3.141592653589793";
	case NODE_TIME:    return "t";
	case NODE_NAME:    return name_text(node);
	case NODE_SUM:     return sum_text(node, tight);
	case NODE_PRODUCT: return product_text(node, tight);
	case NODE_POWER:   return power_text(node);
	case NODE_CALL:    return call_text(node);
	case NODE_CHOOSE:  return choice_text(node, tight);
	default:
		return enclose(tight > 1, format("%s %s %s", text_of(node->child[0], 2), comparisons[node->comparison], text_of(node->child[1], 2)));
	}
}

const char *c_expression(const struct node *node)
{
	return text_of(node, 2);
}
