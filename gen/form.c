/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Symbolic collection. A form is a sum of rational factors times basis elements: 1, pi, t, cos and sin of waves,
 * coordinates and their derivatives. pi stays a basis element until it meets another factor, so that quarter turns
 * are decided exactly. */
#include "plgen.h"

#include <string.h>

static struct form *collect_node(struct collector *c, struct node *node);

/* ---- forms ---- */

static int basis_order(const struct basis *a, const struct basis *b)
{
	if (a->kind != b->kind)
		return (int)a->kind - (int)b->kind;
	if (a->kind == BASIS_WAVE)
		return a->wave != b->wave ? a->wave->index - b->wave->index : (int)a->sine - (int)b->sine;
	if (a->kind == BASIS_COORD)
		return a->coord != b->coord ? a->coord - b->coord : a->order - b->order;
	return 0;
}

static struct form *form_single(struct basis basis, mpq_srcptr factor)
{
	struct form *form = NEW(struct form);
	if (mpq_sgn(factor) == 0)
		return form;
	form->terms = 1;
	form->term = ARRAY(struct form_term, 1);
	form->term[0].basis = basis;
	mpq_init(form->term[0].factor);
	mpq_set(form->term[0].factor, factor);
	return form;
}

static struct form *form_constant(mpq_srcptr value)
{
	return form_single((struct basis){ .kind = BASIS_ONE }, value);
}

static struct form *form_unit(struct basis basis)
{
	mpq_t one;
	mpq_init(one);
	mpq_set_ui(one, 1, 1);
	struct form *form = form_single(basis, one);
	mpq_clear(one);
	return form;
}

/* a + factor * b, merged in basis order */
static struct form *form_add(const struct form *a, const struct form *b, mpq_srcptr factor)
{
	struct form *sum = NEW(struct form);
	sum->term = ARRAY(struct form_term, (size_t)(a->terms + b->terms));
	mpq_t scaled;
	mpq_init(scaled);
	for (int i = 0, j = 0; i < a->terms || j < b->terms;) {
		int order = i == a->terms ? 1 : j == b->terms ? -1 : basis_order(&a->term[i].basis, &b->term[j].basis);
		struct form_term *term = &sum->term[sum->terms];
		term->basis = order <= 0 ? a->term[i].basis : b->term[j].basis;
		mpq_init(term->factor);
		if (order <= 0)
			mpq_set(term->factor, a->term[i++].factor);
		if (order >= 0) {
			mpq_mul(scaled, b->term[j++].factor, factor);
			mpq_add(term->factor, term->factor, scaled);
		}
		sum->terms += mpq_sgn(term->factor) != 0;
	}
	mpq_clear(scaled);
	return sum;
}

static struct form *form_sum(const struct form *a, const struct form *b, bool subtract)
{
	mpq_t sign;
	mpq_init(sign);
	mpq_set_si(sign, subtract ? -1 : 1, 1);
	struct form *sum = form_add(a, b, sign);
	mpq_clear(sign);
	return sum;
}

static struct form *form_scale(const struct form *a, mpq_srcptr factor)
{
	static const struct form zero;
	return form_add(&zero, a, factor);
}

static bool is_constant(const struct form *form)
{
	return form->terms == 0 || form->term[form->terms - 1].basis.kind <= BASIS_PI;
}

static mpq_srcptr factor_of(const struct form *form, enum basis_kind kind)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == kind)
			return form->term[i].factor;
	return NULL;
}

void constant_value(struct collector *c, const struct form *form, mpq_ptr value)
{
	mpq_t sum;
	mpq_init(sum);
	mpq_srcptr one = factor_of(form, BASIS_ONE), pi = factor_of(form, BASIS_PI);
	if (pi) {
		constant_pi(sum);
		mpq_mul(sum, sum, pi);
		c->irrationals.pi = true;
	}
	if (one)
		mpq_add(sum, sum, one);
	mpq_set(value, sum);
	mpq_clear(sum);
}

/* a * b, one of them constant. Products with pi keep it symbolic only beside a plain number. */
static struct form *form_product(struct collector *c, const struct form *a, const struct form *b)
{
	const struct form *constant = is_constant(a) ? a : b, *other = is_constant(a) ? b : a;
	mpq_srcptr plain = factor_of(constant, BASIS_ONE);
	bool only_plain = !factor_of(constant, BASIS_PI);
	mpq_t value;
	mpq_init(value);
	if (only_plain && plain) {
		mpq_set(value, plain);
	} else if (is_constant(other) && !factor_of(other, BASIS_PI)) {
		struct form *swapped = form_scale(constant, other->terms ? other->term[0].factor : value);
		mpq_clear(value);
		return swapped;
	} else {
		constant_value(c, constant, value);
	}
	struct form *product = form_scale(other, value);
	mpq_clear(value);
	return product;
}

static void check_form(struct place at, const struct form *form)
{
	for (int i = 0; i < form->terms; i++)
		check_bits(at, form->term[i].factor);
}

/* ---- what cannot be treated ---- */

static bool holds_acceleration(const struct node *node)
{
	if (node->kind == NODE_NAME)
		return node->primes == 2 || (node->symbol->kind == SYMBOL_LET && holds_acceleration(node->symbol->value));
	for (int i = 0; i < node->children; i++)
		if (holds_acceleration(node->child[i]))
			return true;
	return false;
}

static _Noreturn void not_linear(const struct collector *c, const struct node *node, const char *why)
{
	if (c->tolerant)
		abandon();
	const struct node *term = c->term ? c->term : node;
	if (holds_acceleration(term))
		error(term->start, "accelerations stand in every equation with constant factors: no scheme treats this",
		      "term '%s' %s", text_between(term->start, term->end), why);
	error(term->start, "etd1, etdrk2, etdrk4, nc2, nc3, dq4 and bm3 are the schemes that could; they are not built yet",
	      "term '%s' %s: scheme %s cannot treat it", text_between(term->start, term->end), why, c->scheme);
}

static _Noreturn void not_built(const struct collector *c, struct place at, const char *what)
{
	if (c->tolerant)
		abandon();
	if (c->argument)                        /* not even then */
		not_linear(c, c->argument, "is not linear");
	error(at, NULL, "%s not built yet", what);
}

static void need_constant(const struct collector *c, const struct node *node, const char *what)
{
	if (c->constant_only)
		error(node->at, NULL, "%s is not a constant", what);
}

/* ---- waves ---- */

static struct wave *wave_of(struct collector *c, mpq_srcptr w, mpq_srcptr p)
{
	struct wave **link = &c->waves;
	for (; *link; link = &(*link)->next)
		if (mpq_equal((*link)->w, w) && mpq_equal((*link)->p, p))
			return *link;
	struct wave *wave = *link = NEW(struct wave);
	mpq_inits(wave->w, wave->p, NULL);
	mpq_set(wave->w, w);
	mpq_set(wave->p, p);
	wave->index = c->wave_count++;
	return wave;
}

/* The number of quarter turns in `phase` = turns * pi, if it is nothing else. */
static bool quarter_turns(const struct form *phase, int *quarters)
{
	*quarters = 0;
	if (phase->terms == 0)
		return true;
	mpq_srcptr pi = factor_of(phase, BASIS_PI);
	if (phase->terms != 1 || !pi || mpz_cmp_ui(mpq_denref(pi), 2) > 0)
		return false;
	unsigned long halves = mpz_fdiv_ui(mpq_numref(pi), 4);
	*quarters = (int)(mpz_cmp_ui(mpq_denref(pi), 1) == 0 ? 2 * halves % 4 : halves);
	return true;
}

/* cos or sin of w t + phase as +-cos or +-sin of the wave with w > 0; whole quarter turns leave no phase behind. */
static struct form *collect_wave(struct collector *c, bool sine, mpq_srcptr frequency, const struct form *phase)
{
	mpq_t w, p, sign;
	mpq_inits(w, p, sign, NULL);
	mpq_set(w, frequency);
	mpq_set_si(sign, 1, 1);
	int quarters;
	if (quarter_turns(phase, &quarters)) {  /* cos(x + q pi/2): cos, -sin, -cos, sin; sin(x + ...) is one quarter behind */
		int turn = (quarters + (sine ? 3 : 0)) % 4;
		sine = turn % 2 == 1;
		mpq_set_si(sign, turn == 1 || turn == 2 ? -1 : 1, 1);
	} else {
		constant_value(c, phase, p);
	}
	if (mpq_sgn(w) < 0) {
		mpq_neg(w, w);
		mpq_neg(p, p);
		if (sine)
			mpq_neg(sign, sign);
	}
	struct form *form = form_single((struct basis){ .kind = BASIS_WAVE, .wave = wave_of(c, w, p), .sine = sine }, sign);
	mpq_clears(w, p, sign, NULL);
	return form;
}

/* ---- functions ---- */

/* sin, cos of q pi are rational at multiples of pi/6 only where it shows here: 0, +-1/2, +-1 (Niven). */
static bool niven(bool sine, const struct form *x, mpq_ptr value)
{
	static const int halves[12] = { 2, 99, 1, 0, -1, 99, -2, 99, -1, 0, 1, 99 };   /* 2 cos(k pi/6); 99: irrational */
	mpq_srcptr pi = factor_of(x, BASIS_PI);
	if (x->terms != 1 || !pi || mpz_cmp_ui(mpq_denref(pi), 6) > 0 || 6 % mpz_get_ui(mpq_denref(pi)) != 0)
		return false;
	mpz_t k;
	mpz_init(k);
	mpz_mul_ui(k, mpq_numref(pi), 6);
	mpz_divexact(k, k, mpq_denref(pi));
	unsigned long sixth = (mpz_fdiv_ui(k, 12) + (sine ? 9 : 0)) % 12;
	mpz_clear(k);
	if (halves[sixth] == 99)
		return false;
	mpq_set_si(value, halves[sixth], 2);
	mpq_canonicalize(value);
	return true;
}

/* tan of q pi is rational at multiples of pi/4 only. */
static bool tangent(const struct node *node, const struct form *x, mpq_ptr value)
{
	mpq_srcptr pi = factor_of(x, BASIS_PI);
	if (x->terms != 1 || !pi || mpz_cmp_ui(mpq_denref(pi), 4) > 0 || 4 % mpz_get_ui(mpq_denref(pi)) != 0)
		return false;
	mpz_t k;
	mpz_init(k);
	mpz_mul_ui(k, mpq_numref(pi), 4);
	mpz_divexact(k, k, mpq_denref(pi));
	unsigned long eighth = mpz_fdiv_ui(k, 4);
	mpz_clear(k);
	if (eighth == 2)
		error(node->at, NULL, "tan of an odd number of quarter turns");
	mpq_set_si(value, eighth == 0 ? 0 : eighth == 1 ? 1 : -1, 1);
	return true;
}

static struct form *constant_call(struct collector *c, const struct node *node, const struct form *x)
{
	mpq_t value;
	mpq_init(value);
	bool trigonometric = node->function == FN_SIN || node->function == FN_COS;
	bool rational = node->function == FN_TAN ? tangent(node, x, value) : trigonometric && niven(node->function == FN_SIN, x, value);
	if (!rational) {
		constant_value(c, x, value);
		if (!constant_function(node->at, node->function, value, value))
			c->irrationals.used[node->function] = true;
	}
	check_bits(node->at, value);
	struct form *form = form_constant(value);
	mpq_clear(value);
	return form;
}

/* The argument of a function that no exact scheme will take apart. */
static struct form *collect_argument(struct collector *c, const struct node *node)
{
	const struct node *outer = c->argument, *term = c->term;
	c->argument = node;
	struct form *x = collect_node(c, node->child[0]);
	c->argument = outer;
	c->term = term;
	return x;
}

static struct form *collect_sine(struct collector *c, struct node *node)
{
	struct form *x = collect_argument(c, node);
	if (is_constant(x))
		return constant_call(c, node, x);
	mpq_srcptr w = factor_of(x, BASIS_TIME);
	struct form *phase = NEW(struct form);
	phase->term = x->term;
	while (phase->terms < x->terms && x->term[phase->terms].basis.kind <= BASIS_PI)
		phase->terms++;
	if (!w || phase->terms + 1 != x->terms)
		not_linear(c, node, "is not linear");
	return collect_wave(c, node->function == FN_SIN, w, phase);
}

/* The points of a table: piecewise linear, extended by its end slopes. */
static void table_value(const struct node *node, const mpq_t *v, mpq_ptr value)
{
	int points = (node->children - 1) / 2, left = 0;
	for (int i = 1; i < points; i++)
		if (mpq_cmp(v[2 * i - 1], v[2 * i + 1]) >= 0)
			error(node->child[2 * i + 1]->start, NULL, "the breakpoints of a table rise");
	while (left + 2 < points && mpq_cmp(v[0], v[2 * left + 3]) > 0)
		left++;
	const mpq_t *p = v + 2 * left + 1;      /* x0, y0, x1, y1 around the value */
	mpq_t slope, width;
	mpq_inits(slope, width, NULL);
	mpq_sub(slope, p[3], p[1]);
	mpq_sub(width, p[2], p[0]);
	mpq_div(slope, slope, width);
	mpq_sub(width, v[0], p[0]);
	mpq_mul(slope, slope, width);
	mpq_add(value, p[1], slope);
	mpq_clears(slope, width, NULL);
}

static void clip_value(const struct node *node, const mpq_t *v, mpq_ptr value)
{
	if (mpq_cmp(v[1], v[2]) > 0)
		error(node->child[1]->start, NULL, "the lower breakpoint is above the upper one");
	int side = mpq_cmp(v[0], v[1]) < 0 ? 1 : mpq_cmp(v[0], v[2]) > 0 ? 2 : 0;
	if (node->function == FN_CLIP)
		mpq_set(value, v[side]);
	else if (side)
		mpq_sub(value, v[0], v[side]);
	else
		mpq_set_ui(value, 0, 1);
}

static void piecewise_value(const struct node *node, const mpq_t *v, mpq_ptr value)
{
	switch (node->function) {
	case FN_ABS:
		mpq_abs(value, v[0]);
		break;
	case FN_SGN:
		mpq_set_si(value, mpq_sgn(v[0]), 1);
		break;
	case FN_MIN: case FN_MAX:
		mpq_set(value, v[0]);
		for (int i = 1; i < node->children; i++)
			if ((mpq_cmp(v[i], value) < 0) == (node->function == FN_MIN))
				mpq_set(value, v[i]);
		break;
	case FN_TABLE:
		table_value(node, v, value);
		break;
	default:
		clip_value(node, v, value);
	}
}

/* abs, sgn, min, max, deadzone, clip, table and atan2 of constants */
static struct form *collect_piecewise(struct collector *c, struct node *node)
{
	mpq_t *v = rationals((size_t)node->children), value;
	for (int i = 0; i < node->children; i++) {
		struct form *x = collect_node(c, node->child[i]);
		if (!is_constant(x) && node->function == FN_ATAN2)
			not_linear(c, node, "is not linear");
		if (!is_constant(x))
			not_built(c, node->at, format("'%s' of what moves is", function_name(node->function)));
		constant_value(c, x, v[i]);
	}
	mpq_init(value);
	if (node->function != FN_ATAN2)
		piecewise_value(node, v, value);
	else if (!constant_atan2(node->at, v[0], v[1], value))
		c->irrationals.used[FN_ATAN2] = true;
	struct form *form = form_constant(value);
	mpq_clear(value);
	return form;
}

static struct form *collect_call(struct collector *c, struct node *node)
{
	if (node->function == FN_SIN || node->function == FN_COS)
		return collect_sine(c, node);
	if (node->function >= FN_MIN || node->function == FN_ABS || node->function == FN_SGN || node->function == FN_ATAN2)
		return collect_piecewise(c, node);
	struct form *x = collect_argument(c, node);
	if (is_constant(x))
		return constant_call(c, node, x);
	if (node->function == FN_EXP && x->terms <= 3 && x->term[x->terms - 1].basis.kind == BASIS_TIME)
		not_built(c, node->at, "exponential loads are");
	not_linear(c, node, "is not linear");
}

/* ---- operators ---- */

static struct form *collect_sum(struct collector *c, struct node *node)
{
	struct form *sum = NEW(struct form);
	const struct node *outer = c->term;
	for (int i = 0; i < node->children; i++) {
		if (node->children > 1)
			c->term = node->child[i];
		sum = form_sum(sum, collect_node(c, node->child[i]), node->inverse[i]);
		check_form(node->operator[i], sum);
	}
	c->term = outer;
	return sum;
}

static struct form *collect_division(struct collector *c, struct form *a, const struct form *b, struct place at)
{
	mpq_t value;
	mpq_init(value);
	mpq_srcptr one = factor_of(a, BASIS_PI), pi = factor_of(b, BASIS_PI);
	if (one && pi && a->terms == 1 && b->terms == 1) {      /* pi/pi */
		mpq_div(value, one, pi);
		struct form *ratio = form_constant(value);
		mpq_clear(value);
		return ratio;
	}
	constant_value(c, b, value);
	if (mpq_sgn(value) == 0)
		error(at, NULL, "division by zero");
	mpq_inv(value, value);
	struct form *quotient = form_scale(a, value);
	mpq_clear(value);
	return quotient;
}

static bool has_coordinate(const struct form *form)
{
	return form->terms > 0 && form->term[form->terms - 1].basis.kind == BASIS_COORD;
}

static struct form *collect_product(struct collector *c, struct node *node)
{
	struct form *product = collect_node(c, node->child[0]);
	for (int i = 1; i < node->children; i++) {
		struct form *factor = collect_node(c, node->child[i]);
		if (node->inverse[i]) {
			if (!is_constant(factor))
				not_linear(c, node, "divides by what moves");
			product = collect_division(c, product, factor, node->operator[i]);
		} else if (is_constant(product) || is_constant(factor)) {
			product = form_product(c, product, factor);
		} else if (has_coordinate(product) && has_coordinate(factor)) {
			not_linear(c, node, "is not linear");
		} else if (has_coordinate(product) || has_coordinate(factor)) {
			not_linear(c, node, "has a factor that changes in time");
		} else {
			not_built(c, node->operator[i], "products of loads are");
		}
		check_form(node->operator[i], product);
	}
	return product;
}

static struct form *collect_power(struct collector *c, struct node *node)
{
	struct form *base = collect_node(c, node->child[0]), *exponent = collect_node(c, node->child[1]);
	if (!is_constant(exponent))
		not_linear(c, node, "is not linear");
	mpq_t b, e;
	mpq_inits(b, e, NULL);
	constant_value(c, exponent, e);
	struct form *power = NULL;
	if (is_constant(base)) {
		constant_value(c, base, b);
		if (!constant_power(node->at, b, e, b))
			c->irrationals.root = true;
		power = form_constant(b);
		check_form(node->at, power);
	} else if (mpq_cmp_ui(e, 1, 1) == 0) {
		power = base;
	} else if (mpq_sgn(e) == 0) {
		mpq_set_ui(b, 1, 1);
		power = form_constant(b);
	}
	mpq_clears(b, e, NULL);
	if (power)
		return power;
	if (has_coordinate(base))
		not_linear(c, node, "is not linear");
	not_built(c, node->at, "powers of loads are");
}

static bool compare_values(enum comparison comparison, int order)
{
	switch (comparison) {
	case CMP_LT: return order < 0;
	case CMP_LE: return order <= 0;
	case CMP_GT: return order > 0;
	case CMP_GE: return order >= 0;
	case CMP_EQ: return order == 0;
	default:     return order != 0;
	}
}

/* A condition on constants; true is 1, false is 0. */
static struct form *collect_comparison(struct collector *c, struct node *node)
{
	struct form *left = collect_node(c, node->child[0]), *right = collect_node(c, node->child[1]);
	if (!is_constant(left) || !is_constant(right))
		not_built(c, node->at, "conditions on what moves are");
	mpq_t a, b;
	mpq_inits(a, b, NULL);
	constant_value(c, left, a);
	constant_value(c, right, b);
	mpq_set_ui(a, compare_values(node->comparison, mpq_cmp(a, b)), 1);
	struct form *form = form_constant(a);
	mpq_clears(a, b, NULL);
	return form;
}

static struct form *collect_choice(struct collector *c, struct node *node)
{
	struct form *condition = collect_node(c, node->child[0]);
	if (!is_constant(condition))
		not_built(c, node->at, "conditions on what moves are");
	return collect_node(c, node->child[condition->terms ? 1 : 2]);
}

/* ---- names ---- */

static void collect_value(struct collector *c, struct symbol *symbol)
{
	struct collector inner = *c;
	inner.term = symbol->value;
	if (symbol->kind == SYMBOL_PARAM)
		inner.constant_only = true;
	symbol->progress = COLLECTING;
	symbol->form = NULL;
	struct form *form = collect_node(&inner, symbol->value);
	c->waves = inner.waves;
	c->wave_count = inner.wave_count;
	c->irrationals = inner.irrationals;
	symbol->form = form;
	symbol->progress = COLLECTED;
}

static struct form *collect_name(struct collector *c, struct node *node)
{
	struct symbol *symbol = node->symbol;
	if (symbol->broken)
		abandon();
	if (symbol->kind == SYMBOL_COORD) {
		need_constant(c, node, format("coordinate '%s'", symbol->name));
		return form_unit((struct basis){ .kind = BASIS_COORD, .coord = symbol->index, .order = node->primes });
	}
	if (symbol->kind == SYMBOL_LET)
		need_constant(c, node, format("let '%s'", symbol->name));
	if (symbol->progress == COLLECTING && symbol->kind == SYMBOL_PARAM)
		error(node->at, NULL, "param '%s' is defined by itself", symbol->name);
	if (symbol->progress != COLLECTED)
		collect_value(c, symbol);
	return symbol->form;
}

static struct form *collect_node(struct collector *c, struct node *node)
{
	switch (node->kind) {
	case NODE_NUMBER:  return form_constant(node->number);
	case NODE_PI:      return form_unit((struct basis){ .kind = BASIS_PI });
	case NODE_TIME:
		need_constant(c, node, "'t'");
		return form_unit((struct basis){ .kind = BASIS_TIME });
	case NODE_NAME:    return collect_name(c, node);
	case NODE_SUM:     return collect_sum(c, node);
	case NODE_PRODUCT: return collect_product(c, node);
	case NODE_POWER:   return collect_power(c, node);
	case NODE_CALL:    return collect_call(c, node);
	case NODE_COMPARE: return collect_comparison(c, node);
	default:           return collect_choice(c, node);
	}
}

struct form *collect(struct collector *c, struct node *node)
{
	c->term = node;
	return collect_node(c, node);
}

void collect_constant(struct collector *c, struct node *node, mpq_ptr value)
{
	bool outer = c->constant_only;
	c->constant_only = true;
	struct form *form = collect(c, node);
	c->constant_only = outer;
	constant_value(c, form, value);
}
