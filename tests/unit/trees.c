/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random expressions as trees and as forms. */
#include "trees.h"

/* ---- trees ---- */

struct tree *new_tree(enum kind kind, int children)
{
	struct tree *tree = NEW(struct tree);
	tree->kind = kind;
	tree->children = children;
	mpq_init(tree->number);
	return tree;
}

struct tree *number_tree(long value)
{
	struct tree *tree = new_tree(NUMBER, 0);
	mpq_set_si(tree->number, value, 1);
	return tree;
}

bool constants_only;         /* no state and no time in what is drawn */

struct tree *draw_leaf(void)
{
	static const enum kind kinds[] = { NUMBER, TIME, WAVE, STATE, STATE, STATE, STATE, STATE };
	struct tree *tree = new_tree(constants_only ? NUMBER : kinds[draw(8)], 0);
	draw_fraction(tree->number, 20, 6);
	if (tree->kind == WAVE)
		mpq_set_si(tree->number, 1 + (long)draw(3), 1);
	tree->index = (int)draw(COORDS);
	tree->order = (int)draw(2);
	return tree;
}

struct tree *draw_tree(int depth);

static struct tree *draw_call(int depth)
{
	static const enum function all[] = { FN_SIN,   FN_COS,  FN_TAN,  FN_EXP,      FN_LOG,  FN_SQRT, FN_ABS,
						 FN_SGN,   FN_SINH, FN_COSH, FN_TANH,     FN_ASIN, FN_ACOS, FN_ATAN,
							 FN_ATAN2, FN_MIN,  FN_MAX,  FN_DEADZONE, FN_CLIP, FN_TABLE };
	enum function function = all[draw(sizeof all / sizeof *all)];
	int count = function == FN_TABLE      ? 7
				: function >= FN_DEADZONE ? 3
				: function >= FN_MIN      ? 2 + (int)draw(2)
				: function == FN_ATAN2    ? 2
										  : 1;
	struct tree *tree = new_tree(CALL, count);
	tree->function = function;
	for (int i = 0; i < count; i++)
		tree->child[i] = i > 0 && function >= FN_DEADZONE ? number_tree(-(long)draw(4)) : draw_tree(depth - 1);
	if (function == FN_DEADZONE || function == FN_CLIP)
		mpq_set_si(tree->child[2]->number, (long)draw(3), 1);
	for (int i = 1; i < count && function == FN_TABLE; i += 2)       /* -1, 0, 2 */
		mpq_set_si(tree->child[i]->number, i == 1 ? -1 : i == 3 ? 0 : 2, 1);
	return tree;
}

struct tree *draw_tree(int depth)
{
	static const enum kind kinds[] = { SUM,   SUM,   DIFFERENCE, PRODUCT, PRODUCT, PRODUCT, QUOTIENT,
						   POWER, POWER, RAISED,     CALL,    CALL,    CALL,    CHOICE };
	if (depth == 0 || draw(8) == 0)
		return draw_leaf();
	enum kind kind = kinds[draw(sizeof kinds / sizeof *kinds)];
	if (kind == CALL)
		return draw_call(depth);
	struct tree *tree = new_tree(kind, kind == CHOICE ? 4 : kind == POWER ? 1 : 2);
	for (int i = 0; i < tree->children; i++)
		tree->child[i] = draw_tree(depth - 1);
	tree->exponent = draw(5);
	tree->comparison = (enum comparison)draw(4);
	return tree;
}

const char *tree_text(const struct tree *tree)
{
	static const char *const sign[] = {
		[SUM] = "+", [DIFFERENCE] = "-", [PRODUCT] = "*", [QUOTIENT] = "/", [RAISED] = "^"
	};
	const char *text = "";
	switch (tree->kind) {
	case NUMBER: return mpq_get_str(NULL, 10, tree->number);
	case TIME:   return "t";
	case WAVE:   return format("sin(%s t + 1)", mpq_get_str(NULL, 10, tree->number));
	case STATE:  return format("x%d%s", tree->index, tree->order ? "'" : "");
	case POWER:  return format("(%s)^%u", tree_text(tree->child[0]), tree->exponent);
	case CHOICE:
		return format("(%s %s %s ? %s : %s)", tree_text(tree->child[0]),
					  (const char *[]){ "<", "<=", ">", ">=" }[tree->comparison],
							tree_text(tree->child[1]),
					  tree_text(tree->child[2]), tree_text(tree->child[3]));
	case CALL:
		for (int i = 0; i < tree->children; i++)
			text = format("%s%s%s", text, i ? ", " : "", tree_text(tree->child[i]));
		return format("%s(%s)", function_name(tree->function), text);
	default:
		return format("(%s %s %s)", tree_text(tree->child[0]), sign[tree->kind], tree_text(tree->child[1]));
	}
}

/* ---- their values ---- */

void draw_point(struct at *at)
{
	for (int i = 0; i < COORDS; i++)
		for (int order = 0; order < 2; order++)
			mpq_set_si(at->state[i][order], draw_integer(4000), 1009);     /* no breakpoint of a table */
	mpq_set_si(at->t, 1 + (long)draw(3000), 1013);
	for (int i = 0; i < COORDS; i++)
		for (int order = 0; order < 2; order++)
			mpq_canonicalize(at->state[i][order]);
	mpq_canonicalize(at->t);
}

/* A few digits of a rational are lost where a quotient of values nearly 0 is formed: what is nearer to 0 than this, or
 * farther, is not compared. */
bool is_plain(mpfr_srcptr x)
{
	return mpfr_zero_p(x) || (mpfr_regular_p(x) && mpfr_get_exp(x) > -60 && mpfr_get_exp(x) < 60);
}

void value_of(const struct tree *tree, const struct at *at, mpfr_ptr value);

static void value_of_table(mpfr_t *x, int points, mpfr_ptr value)
{
	int piece = 0;
	while (piece + 2 < points && mpfr_cmp(x[0], x[1 + 2 * (piece + 1)]) > 0)
		piece++;
	mpfr_t *p = x + 1 + 2 * piece, part;
	mpfr_init2(part, BITS);
	mpfr_sub(part, x[0], p[0], MPFR_RNDN);
	mpfr_sub(value, p[2], p[0], MPFR_RNDN);
	mpfr_div(part, part, value, MPFR_RNDN);         /* y0 (1 - part) + y1 part */
	mpfr_mul(value, part, p[3], MPFR_RNDN);
	mpfr_ui_sub(part, 1, part, MPFR_RNDN);
	mpfr_fma(value, part, p[1], value, MPFR_RNDN);
	mpfr_clear(part);
}

static void value_of_call(const struct tree *tree, mpfr_t *x, mpfr_ptr value)
{
	switch (tree->function) {
	case FN_SIN:   mpfr_sin(value, x[0], MPFR_RNDN); break;
	case FN_COS:   mpfr_cos(value, x[0], MPFR_RNDN); break;
	case FN_TAN:   mpfr_tan(value, x[0], MPFR_RNDN); break;
	case FN_EXP:   mpfr_exp(value, x[0], MPFR_RNDN); break;
	case FN_LOG:   mpfr_log(value, x[0], MPFR_RNDN); break;
	case FN_SQRT:  mpfr_sqrt(value, x[0], MPFR_RNDN); break;
	case FN_ABS:   mpfr_abs(value, x[0], MPFR_RNDN); break;
	case FN_SGN:   mpfr_set_si(value, mpfr_sgn(x[0]), MPFR_RNDN); break;
	case FN_SINH:  mpfr_sinh(value, x[0], MPFR_RNDN); break;
	case FN_COSH:  mpfr_cosh(value, x[0], MPFR_RNDN); break;
	case FN_TANH:  mpfr_tanh(value, x[0], MPFR_RNDN); break;
	case FN_ASIN:  mpfr_asin(value, x[0], MPFR_RNDN); break;
	case FN_ACOS:  mpfr_acos(value, x[0], MPFR_RNDN); break;
	case FN_ATAN:  mpfr_atan(value, x[0], MPFR_RNDN); break;
	case FN_ATAN2: mpfr_atan2(value, x[0], x[1], MPFR_RNDN); break;
	case FN_TABLE: value_of_table(x, (tree->children - 1) / 2, value); break;
	default:
		mpfr_set(value, x[0], MPFR_RNDN);
		for (int i = 1; i < tree->children; i++) {
			bool low = tree->function == FN_MAX || (tree->function >= FN_DEADZONE && i == 1);
			if (low ? mpfr_cmp(x[i], value) > 0 : mpfr_cmp(x[i], value) < 0)
				mpfr_set(value, x[i], MPFR_RNDN);
		}
		if (tree->function == FN_DEADZONE)
			mpfr_sub(value, x[0], value, MPFR_RNDN);
	}
}

static bool compares(enum comparison comparison, int order)
{
	return comparison == CMP_LT   ? order < 0
		   : comparison == CMP_LE ? order <= 0
		   : comparison == CMP_GT ? order > 0
								  : order >= 0;
}

static void value_of_operation(const struct tree *tree, mpfr_t *x, mpfr_ptr value)
{
	switch (tree->kind) {
	case SUM:        mpfr_add(value, x[0], x[1], MPFR_RNDN); break;
	case DIFFERENCE: mpfr_sub(value, x[0], x[1], MPFR_RNDN); break;
	case PRODUCT:    mpfr_mul(value, x[0], x[1], MPFR_RNDN); break;
	case QUOTIENT:   mpfr_div(value, x[0], x[1], MPFR_RNDN); break;
	case POWER:      mpfr_pow_ui(value, x[0], tree->exponent, MPFR_RNDN); break;
	case RAISED:     mpfr_pow(value, x[0], x[1], MPFR_RNDN); break;
	case CHOICE:     mpfr_set(value, x[compares(tree->comparison, mpfr_cmp(x[0], x[1])) ? 2 : 3], MPFR_RNDN); break;
	default:         value_of_call(tree, x, value);
	}
}

/* NaN where some part is not plain: there nothing is compared */
void value_of(const struct tree *tree, const struct at *at, mpfr_ptr value)
{
	mpfr_t x[MOST];
	bool plain = true;
	for (int i = 0; i < tree->children; i++) {
		mpfr_init2(x[i], BITS);
		value_of(tree->child[i], at, x[i]);
		plain = plain && is_plain(x[i]);
	}
	if (tree->kind == NUMBER) {
		mpfr_set_q(value, tree->number, MPFR_RNDN);
	} else if (tree->kind == TIME) {
		mpfr_set_q(value, at->t, MPFR_RNDN);
	} else if (tree->kind == WAVE) {
		mpfr_set_q(value, at->t, MPFR_RNDN);
		mpfr_mul_q(value, value, tree->number, MPFR_RNDN);
		mpfr_add_ui(value, value, 1, MPFR_RNDN);
		mpfr_sin(value, value, MPFR_RNDN);
	} else if (tree->kind == STATE) {
		mpfr_set_q(value, at->state[tree->index][tree->order], MPFR_RNDN);
	} else if (plain) {
		value_of_operation(tree, x, value);
	}
	if (!plain || !is_plain(value))
		mpfr_set_nan(value);
	for (int i = 0; i < tree->children; i++)
		mpfr_clear(x[i]);
}

/* ---- forms ---- */

struct collector collector;
struct frame frame;
struct node node;

void new_collector(void)
{
	static const struct source source = { .name = "m.spec", .base = "m.spec", .text = "x'' + x = "
		"0\n", .length = 12 };
	static struct symbol coord[COORDS];
	static struct symbol *coords[COORDS];
	for (int i = 0; i < COORDS; i++) {
		coord[i] = (struct symbol){ .kind = SYMBOL_COORD, .name = i ? "y" : "x", .index = i, .highest = 2 };
		coords[i] = &coord[i];
	}
	discard(collector.atoms);
	frame = (struct frame){ .coord = coords };
	node = (struct node){ .kind = NODE_TIME, .at = { &source, 0 }, .start = { &source, 0 }, .end = { &source, 3 } };
	collector = (struct collector){
		.atoms = atoms_new(), .frame = &frame, .keep = KEEP_ALL, .whole_time = true, .scheme = "nc3",
				.term = &node
	};
}

struct form *state_form(int index, int order)
{
	return form_unit((struct basis){ .kind = BASIS_COORD, .index = index, .order = order });
}

struct form *form_of(const struct tree *tree);

static struct form *form_of_call(const struct tree *tree, struct form *const *x)
{
	struct node *call = NEW(struct node);
	*call = node;
	call->kind = NODE_CALL;
	call->function = tree->function;
	call->children = tree->children;
	call->child = ARRAY(struct node *, (size_t)tree->children);
	for (int i = 0; i < tree->children; i++)
		call->child[i] = &node;
	return kept_call(&collector, call, tree->function, tree->children, x);
}

struct form *form_of(const struct tree *tree)
{
	struct collector *c = &collector;
	struct form *x[MOST];
	for (int i = 0; i < tree->children; i++)
		x[i] = form_of(tree->child[i]);
	switch (tree->kind) {
	case NUMBER:     return form_constant(tree->number);
	case TIME:       return plain_forcing(c, 1, NULL);
	case WAVE:       return collect_forcing(c, true, tree->number, form_number(1));
	case STATE:      return state_form(tree->index, tree->order);
	case SUM:        return form_sum(x[0], x[1], false);
	case DIFFERENCE: return form_sum(x[0], x[1], true);
	case PRODUCT:    return kept_product(c, &node, x[0], x[1]);
	case QUOTIENT:   return kept_product(c, &node, x[0], kept_reciprocal(c, &node, x[1]));
	case POWER:      return kept_whole_power(c, &node, x[0], tree->exponent);
	case RAISED:     return kept_power(c, &node, x[0], x[1]);
	case CALL:       return form_of_call(tree, x);
	default:         return kept_choice(c, &node, kept_comparison(c, &node, tree->comparison, x[0], x[1]), x[2],
			x[3]);
	}
}

static void leaf(void *context, const struct basis *basis, mpfr_ptr value)
{
	const struct at *at = context;
	mpfr_set_q(value, at->state[basis->index][basis->order], MPFR_RNDN);
}

void sampled(const struct form *form, struct at *at, mpfr_ptr value)
{
	mpfr_t t;
	struct sample *sample = sample_new(BITS, leaf, at);
	mpfr_init2(t, BITS);
	mpfr_set_q(t, at->t, MPFR_RNDN);
	sample_at(sample, t);
	sample_form(sample, form, value);
	mpfr_clear(t);
}

void make_form(void *context)
{
	struct attempt *a = context;
	a->form = form_of(a->tree);
}

void make_slope(void *context)
{
	struct attempt *a = context;
	a->slope = form_derivatives(&collector, 1, (const struct form *const *)&a->form, false, a->coord, a->order);
}

void make_placed(void *context)
{
	struct attempt *a = context;
	a->form = form_at(a->point, a->form);
}

/* |found - expected| <= 2^bits (1 + |expected|) */
void assert_close(const char *what, int n, const struct tree *tree, mpfr_srcptr found, mpfr_srcptr expected,
						 int bits)
{
	mpfr_t off, most;
	mpfr_inits2(BITS, off, most, NULL);
	mpfr_sub(off, found, expected, MPFR_RNDN);
	mpfr_abs(most, expected, MPFR_RNDN);
	mpfr_add_ui(most, most, 1, MPFR_RNDN);
	mpfr_mul_2si(most, most, bits, MPFR_RNDN);
	if (!(mpfr_cmpabs(off, most) <= 0) || mpfr_nan_p(off))
		fail_msg("%s, case %d, %s: found %.17g, expected %.17g; off by %.3g, tolerance "
			"%.3g", what, n, tree_text(tree),
				 mpfr_get_d(found, MPFR_RNDN), mpfr_get_d(expected, MPFR_RNDN),
						mpfr_get_d(off, MPFR_RNDN),
				 mpfr_get_d(most, MPFR_RNDN));
	mpfr_clears(off, most, NULL);
}

void at_init(struct at *at)
{
	for (int i = 0; i < COORDS; i++)
		mpq_inits(at->state[i][0], at->state[i][1], NULL);
	mpq_init(at->t);
}
