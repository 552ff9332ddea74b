/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The right side as sequences of Taylor coefficients: forms to sums, atoms to recurrences, each once. Their numbers are
 * exact up to one rounding. Sources of the recurrences: Moore 1966; Griewank and Walther 2008, chapter 13. */
#include "step/step.h"

struct key {                        /* what a sum adds up, before its factors are numbers */
	enum term_kind kind;
	int a, b;
	mpq_t factor;
};
struct sum {
	int keys;
	struct key *key;
};
struct work {
	const struct step *step;
	const struct linear *system;
	struct expansion *x;
	struct layout layout;       /* states, loads, inputs, channels */
	mpq_t **slopes;             /* per segment: x' = slopes x */
	mpq_t pi;
	int *uses;                  /* per atom */
	int *atom;                  /* per atom: its sequence; NONE: not made yet */
	int operands;               /* forms that are no single atom, each made once */
	struct { const struct form *form; int sequence; } *operand;
	int *rate;                  /* per sequence: that of its derivative, and the factor that is left */
};

static int new_sequence(struct work *w, struct sequence sequence)
{
	struct expansion *x = w->x;
	ENLARGE(x->sequence, (size_t)x->count + 1);
	sequence.top = -1;
	x->sequence[x->count] = sequence;
	return x->count++;
}

/* ---- sums ---- */

static void add_key(struct sum *sum, enum term_kind kind, int a, int b, mpq_srcptr factor)
{
	for (int i = 0; i < sum->keys; i++) {
		struct key *key = &sum->key[i];
		if (key->kind == kind && key->a == a && key->b == b) {
			mpq_add(key->factor, key->factor, factor);
			return;
		}
	}
	ENLARGE(sum->key, (size_t)sum->keys + 1);
	struct key *key = &sum->key[sum->keys++];
	*key = (struct key){ .kind = kind, .a = a, .b = b };
	mpq_init(key->factor);
	mpq_set(key->factor, factor);
}

static int first_column(const struct linear *system, int load)
{
	int column = 0;
	for (int l = 0; l < load; l++)
		column += system->load[l].columns;
	return column;
}

static void add_wave(const struct work *w, struct sum *sum, const struct basis *basis, mpq_srcptr factor)
{
	int l = 0;
	if (is_polynomial(basis->wave)) {
		add_key(sum, TERM_TIME, basis->power, 0, factor);
		return;
	}
	while (w->system->load[l].wave != basis->wave)
		l++;
	int column = oscillates(basis->wave) ? 2 * basis->power + basis->sine : basis->power;
	add_key(sum, TERM_LOAD, first_column(w->system, l) + column, 0, factor);
}

static int state_of(const struct work *w, const struct basis *basis)
{
	return basis->order ? w->system->velocity[basis->index] : basis->index;
}

static int sequence_of_atom(struct work *w, const struct atom *atom);
static bool add_product(struct work *w, struct sum *sum, const struct atom *atom, mpq_srcptr factor);

static void add_form(struct work *w, struct sum *sum, const struct form *form, mpq_srcptr scale)
{
	mpq_t factor;
	mpq_init(factor);
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		mpq_mul(factor, form->term[i].factor, scale);
		switch (basis->kind) {
		case BASIS_PI:
			mpq_mul(factor, factor, w->pi);
			add_key(sum, TERM_TIME, 0, 0, factor);
			break;
		case BASIS_ONE:
			add_key(sum, TERM_TIME, 0, 0, factor);
			break;
		case BASIS_WAVE:
			add_wave(w, sum, basis, factor);
			break;
		case BASIS_INPUT:
			add_key(sum, basis->order ? TERM_SLOPE : TERM_INPUT, basis->index, 0, factor);
			break;
		case BASIS_COORD:
			add_key(sum, TERM_SEQUENCE, state_of(w, basis), 0, factor);
			break;
		case BASIS_ATOM:
			if (!add_product(w, sum, basis->atom, factor))
				add_key(sum, TERM_SEQUENCE, sequence_of_atom(w, basis->atom), 0, factor);
			break;
		}
	}
	mpq_clear(factor);
}

/* ---- numbers of sums ---- */

static double rounded(const struct work *w, mpq_srcptr q)
{
	return equation_number(w->step->model, q).value;
}

/* binomial(m, k) D^k t^{m-k}, k = 0 .. m */
static void add_powers(struct work *w, struct sequence *s, int m, mpq_srcptr factor, const mpq_t *scale)
{
	mpq_t part, binomial;
	mpq_inits(part, binomial, NULL);
	mpq_set(part, factor);
	for (int k = 0; k <= m && k <= w->x->order; k++) {
		ENLARGE(s->term, (size_t)s->terms + 1);
		struct sequence_term *term = &s->term[s->terms++];
		*term = (struct sequence_term){ .kind = TERM_TIME, .a = m - k, .slot = -1 };
		term->factor = ARRAY(double, (size_t)w->x->order + 1);
		mpq_mul(binomial, part, scale[k]);
		term->factor[k] = rounded(w, binomial);
		mpq_set_ui(binomial, (unsigned long)(m - k), (unsigned long)k + 1);
		mpq_canonicalize(binomial);
		mpq_mul(part, part, binomial);
		mpq_mul(part, part, w->step->model->h);
	}
	mpq_clears(part, binomial, NULL);
}

/* row (D S)^k / k!, S the load's own slopes: exact, times what the sum scales its k-th with */
static void next_row(const struct work *w, int load, int k, mpq_t *row)
{
	const struct load *l = &w->system->load[load];
	int n = l->columns, at = w->layout.load[load], size = w->layout.size;
	mpq_t *next = rationals((size_t)n), part;
	mpq_init(part);
	for (int j = 0; j < n; j++)
		for (int i = 0; i < n; i++) {
			mpq_mul(part, row[i], w->slopes[0][(at + i) * size + at + j]);
			mpq_add(next[j], next[j], part);
		}
	mpq_set_ui(part, 1, (unsigned long)k + 1);
	mpq_mul(part, part, w->step->model->h);
	for (int j = 0; j < n; j++)
		mpq_mul(row[j], next[j], part);
	mpq_clear(part);
	rationals_free(next, (size_t)n);
}

/* value[k][column] */
static double *load_numbers(const struct work *w, int load, mpq_t *row, const mpq_t *scale)
{
	int n = w->system->load[load].columns, order = w->x->order;
	double *value = ARRAY(double, (size_t)((order + 1) * n));
	mpq_t scaled;
	mpq_init(scaled);
	for (int k = 0; k <= order; k++) {
		for (int j = 0; j < n; j++) {
			mpq_mul(scaled, row[j], scale[k]);
			value[k * n + j] = rounded(w, scaled);
		}
		next_row(w, load, k, row);
	}
	mpq_clear(scaled);
	return value;
}

static void add_load_numbers(struct work *w, struct sequence *s, int load, mpq_t *row, const mpq_t *scale)
{
	int n = w->system->load[load].columns, order = w->x->order, first = first_column(w->system, load);
	const double *value = load_numbers(w, load, row, scale);
	w->x->load[load] = true;
	for (int j = 0; j < n; j++) {
		ENLARGE(s->term, (size_t)s->terms + 1);
		struct sequence_term *term = &s->term[s->terms++];
		*term = (struct sequence_term){ .kind = TERM_LOAD, .a = first + j, .slot = -1 };
		term->factor = ARRAY(double, (size_t)order + 1);
		for (int k = 0; k <= order; k++)
			term->factor[k] = value[k * n + j];
	}
}

/* All loads of a sum, whose columns change into each other */
static void add_loads(struct work *w, struct sequence *s, const struct sum *sum, const mpq_t *scale)
{
	for (int l = 0; l < w->system->loads; l++) {
		int first = first_column(w->system, l), n = w->system->load[l].columns;
		mpq_t *row = rationals((size_t)n);
		bool any = false;
		for (int i = 0; i < sum->keys; i++) {
			const struct key *key = &sum->key[i];
			if (key->kind != TERM_LOAD || key->a < first || key->a >= first + n)
				continue;
			mpq_set(row[key->a - first], key->factor);
			any = any || mpq_sgn(key->factor) != 0;
		}
		if (any)
			add_load_numbers(w, s, l, row, scale);
		rationals_free(row, (size_t)n);
	}
}

/* u = value + slope tau; its slope alone */
static void add_input(struct work *w, struct sequence *s, const struct key *key, const mpq_t *scale)
{
	bool ramps = w->system->input[key->a].hold > 0;
	mpq_t number;
	if (key->kind == TERM_SLOPE && !ramps)
		return;
	mpq_init(number);
	for (int k = 0; k <= (key->kind == TERM_INPUT && ramps); k++) {
		ENLARGE(s->term, (size_t)s->terms + 1);
		struct sequence_term *term = &s->term[s->terms++];
		*term = (struct sequence_term){ .kind = k ? TERM_SLOPE : key->kind, .a = key->a, .slot = -1 };
		term->factor = ARRAY(double, (size_t)w->x->order + 1);
		mpq_mul(number, key->factor, scale[k]);
		if (k)
			mpq_mul(number, number, w->step->model->h);
		term->factor[k] = rounded(w, number);
		(term->kind == TERM_INPUT ? w->x->input : w->x->slope)[key->a] = true;
	}
	mpq_clear(number);
}

static void add_plain(struct work *w, struct sequence *s, const struct key *key, const mpq_t *scale)
{
	mpq_t number;
	mpq_init(number);
	ENLARGE(s->term, (size_t)s->terms + 1);
	struct sequence_term *term = &s->term[s->terms++];
	*term = (struct sequence_term){ .kind = key->kind, .a = key->a, .b = key->b, .slot = -1 };
	term->factor = ARRAY(double, (size_t)w->x->order + 1);
	for (int k = 0; k <= w->x->order; k++) {
		mpq_mul(number, key->factor, scale[k]);
		term->factor[k] = rounded(w, number);
	}
	mpq_clear(number);
}

/* Its keys as terms, scaled by scale[k] at k */
static void fill_sum(struct work *w, struct sequence *s, const struct sum *sum, const mpq_t *scale)
{
	for (int i = 0; i < sum->keys; i++) {
		const struct key *key = &sum->key[i];
		if (mpq_sgn(key->factor) == 0 || key->kind == TERM_LOAD)
			continue;
		if (key->kind == TERM_TIME)
			add_powers(w, s, key->a, key->factor, scale);
		else if (key->kind == TERM_INPUT || key->kind == TERM_SLOPE)
			add_input(w, s, key, scale);
		else
			add_plain(w, s, key, scale);
	}
	add_loads(w, s, sum, scale);
}

static mpq_t *plain_scale(const struct work *w)
{
	mpq_t *scale = rationals((size_t)w->x->order + 1);
	for (int k = 0; k <= w->x->order; k++)
		mpq_set_ui(scale[k], 1, 1);
	return scale;
}

/* D/(k+1): of a derivative with respect to time; or 1/(k+1), where D is in the factors already */
static mpq_t *integral_scale(const struct work *w, bool times_h)
{
	mpq_t *scale = rationals((size_t)w->x->order + 1);
	for (int k = 0; k <= w->x->order; k++) {
		mpq_set_ui(scale[k], 1, (unsigned long)k + 1);
		if (times_h)
			mpq_mul(scale[k], scale[k], w->step->model->h);
	}
	return scale;
}

static int sum_sequence(struct work *w, const struct sum *sum)
{
	struct sequence s = { .kind = SEQUENCE_SUM, .state = NONE, .a = NONE, .b = NONE };
	mpq_t *scale = plain_scale(w);
	fill_sum(w, &s, sum, (const mpq_t *)scale);
	rationals_free(scale, (size_t)w->x->order + 1);
	return new_sequence(w, s);
}

/* ---- operands ---- */

/* One sequence and nothing else; NONE: it is more */
static int only_sequence(const struct sum *sum)
{
	const struct key *key = sum->key;
	bool plain = sum->keys == 1 && key->kind == TERM_SEQUENCE && mpq_cmp_ui(key->factor, 1, 1) == 0;
	return plain ? key->a : NONE;
}

static int sequence_of_form(struct work *w, const struct form *form)
{
	struct sum sum = { 0 };
	mpq_t one;
	for (int i = 0; i < w->operands; i++)
		if (w->operand[i].form == form)
			return w->operand[i].sequence;
	mpq_init(one);
	mpq_set_ui(one, 1, 1);
	add_form(w, &sum, form, one);
	mpq_clear(one);
	int only = only_sequence(&sum), made = only != NONE ? only : sum_sequence(w, &sum);
	ENLARGE(w->operand, (size_t)w->operands + 1);
	w->operand[w->operands].form = form;
	w->operand[w->operands++].sequence = made;
	return made;
}

static struct sum single_key(enum term_kind kind, int a, int b)
{
	struct sum sum = { 0 };
	mpq_t one;
	mpq_init(one);
	mpq_set_ui(one, 1, 1);
	add_key(&sum, kind, a, b, one);
	mpq_clear(one);
	return sum;
}

static int product_sequence(struct work *w, int a, int b)
{
	struct sum sum = single_key(TERM_PRODUCT, a < b ? a : b, a < b ? b : a);
	return sum_sequence(w, &sum);
}

static int power_sequence(struct work *w, int base, unsigned n)
{
	if (n == 1)
		return base;
	int half = power_sequence(w, base, n / 2), even = product_sequence(w, half, half);
	return n % 2 ? product_sequence(w, even, base) : even;
}

/* ---- products ---- */

static const struct form *divisor_of(const struct form *form)
{
	const struct form_term *only = form->terms == 1 ? form->term : NULL;
	const struct atom *atom = only && mpq_cmp_ui(only->factor, 1, 1) == 0 ? only->basis.atom : NULL;
	return atom && atom->kind == ATOM_RECIPROCAL ? atom->operand[0] : NULL;
}

/* All its factors above, or below, but for one occurrence that *last receives; returns the product of the others, NONE:
 * there are none */
static int product_of(struct work *w, const struct atom *atom, bool below, int *last)
{
	int product = NONE;
	*last = NONE;
	for (int i = 0; i < atom->operands; i++) {
		const struct form *divisor = divisor_of(atom->operand[i]);
		unsigned times = atom->exponent[i];
		if (below != (divisor != NULL))
			continue;
		int factor = sequence_of_form(w, divisor ? divisor : atom->operand[i]);
		if (times > 2) {                /* x^3 is x^2 x, x^4 is x^2 x^2 */
			int half = power_sequence(w, factor, times / 2), rest = times - times / 2;
			int other = power_sequence(w, factor, (unsigned)rest);
			product = product == NONE ? half : product_sequence(w, product, half);
			factor = other;
			times = 1;
		}
		for (; times > 0; times--) {
			if (*last != NONE)
				product = product == NONE ? *last : product_sequence(w, product, *last);
			*last = factor;
		}
	}
	return product;
}

static int whole_product(struct work *w, const struct atom *atom, bool below)
{
	int last, product = product_of(w, atom, below, &last);
	return product == NONE ? last : product_sequence(w, product, last);
}

static bool has_divisor(const struct atom *atom)
{
	for (int i = 0; i < atom->operands; i++)
		if (divisor_of(atom->operand[i]))
			return true;
	return false;
}

static int quotient_sequence(struct work *w, int a, int b)
{
	return new_sequence(w, (struct sequence){ .kind = SEQUENCE_QUOTIENT, .state = NONE, .a = a, .b = b });
}

/* A product that nothing else reads stands in the sum itself: its newest terms are then added last. */
static bool add_product(struct work *w, struct sum *sum, const struct atom *atom, mpq_srcptr factor)
{
	int last;
	if (atom->kind != ATOM_PRODUCT || w->uses[atom->index] > 1 || has_divisor(atom))
		return false;
	int product = product_of(w, atom, false, &last);
	if (product == NONE)
		return false;
	add_key(sum, TERM_PRODUCT, product < last ? product : last, product < last ? last : product, factor);
	return true;
}

static int sequence_of_product(struct work *w, const struct atom *atom)
{
	int above = whole_product(w, atom, false), below = whole_product(w, atom, true);
	return below == NONE ? above : quotient_sequence(w, above, below);
}

/* ---- derivatives with respect to time ---- */

/* Where a sequence is a sum of coordinates of second order: the same of their velocities, which are there earlier */
static int velocities_of(struct work *w, int sequence)
{
	struct sum sum = { 0 };
	const struct sequence *s = &w->x->sequence[sequence];
	mpq_t factor;
	if (s->state != NONE && s->state < w->system->n && w->system->velocity[s->state] >= 0)
		return w->system->velocity[s->state];
	if (s->kind != SEQUENCE_SUM)
		return NONE;
	mpq_init(factor);
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *t = &s->term[i];
		bool coordinate = t->kind == TERM_SEQUENCE && t->a < w->system->n && w->system->velocity[t->a] >= 0;
		bool constant = t->kind == TERM_TIME && t->a == 0 && t->factor[0] != 0;
		mpq_set_d(factor, t->factor[0]);
		if (coordinate)
			add_key(&sum, TERM_SEQUENCE, w->system->velocity[t->a], 0, factor);
		if (!coordinate && !constant)
			return NONE;
	}
	mpq_clear(factor);
	return sum.keys ? sum_sequence(w, &sum) : NONE;
}

/* a' as a sequence times *scale, so that k a_k = *scale times its (k-1)-th */
static int derivative_of(struct work *w, int sequence, mpq_ptr scale)
{
	int velocity = velocities_of(w, sequence);
	mpq_set_ui(scale, 1, 1);
	if (velocity != NONE) {
		mpq_set(scale, w->step->model->h);
		return velocity;
	}
	return new_sequence(w, (struct sequence){ .kind = SEQUENCE_RATE, .state = NONE, .a = sequence, .b = NONE });
}

/* c = function(a_0) at first, c' = sum: set afterwards, since it may read c */
static int new_integral(struct work *w, enum function function, int a, int b)
{
	return new_sequence(w, (struct sequence){ .kind = SEQUENCE_INTEGRAL, .state = NONE, .function = function,
						  .a = a, .b = b });
}

static void set_integrand(struct work *w, int sequence, const struct sum *sum)
{
	struct sequence made = w->x->sequence[sequence];
	mpq_t *scale = integral_scale(w, false);
	fill_sum(w, &made, sum, (const mpq_t *)scale);
	w->x->sequence[sequence] = made;
	rationals_free(scale, (size_t)w->x->order + 1);
}

/* c' = factor a' b */
static void set_product_integrand(struct work *w, int sequence, int rate, int other, mpq_srcptr factor)
{
	struct sum sum = { 0 };
	add_key(&sum, TERM_PRODUCT, rate < other ? rate : other, rate < other ? other : rate, factor);
	set_integrand(w, sequence, &sum);
}

/* ---- functions ---- */

/* 1 + sign a^2 */
static int one_and_square(struct work *w, int a, long sign)
{
	struct sum sum = { 0 };
	mpq_t factor;
	mpq_init(factor);
	mpq_set_ui(factor, 1, 1);
	add_key(&sum, TERM_TIME, 0, 0, factor);
	mpq_set_si(factor, sign, 1);
	add_key(&sum, TERM_PRODUCT, a, a, factor);
	mpq_clear(factor);
	return sum_sequence(w, &sum);
}

static int root_sequence(struct work *w, int a)
{
	return new_sequence(w, (struct sequence){ .kind = SEQUENCE_ROOT, .state = NONE, .a = a, .b = NONE });
}

/* s' = a' c, c' = sign a' s: both are made, and the one asked for returned */
static int pair_sequence(struct work *w, int a, enum function first, enum function second, long sign, bool want_second)
{
	mpq_t scale, turned;
	mpq_inits(scale, turned, NULL);
	for (int i = 0; i < w->x->count; i++) {
		const struct sequence *s = &w->x->sequence[i];
		if (s->kind == SEQUENCE_INTEGRAL && s->state == NONE && s->function == first && s->a == a)
			return want_second ? i + 1 : i;
	}
	int rate = derivative_of(w, a, scale);
	int s = new_integral(w, first, a, NONE), c = new_integral(w, second, a, NONE);
	set_product_integrand(w, s, rate, c, scale);
	mpq_set_si(turned, sign, 1);
	mpq_mul(scale, scale, turned);
	set_product_integrand(w, c, rate, s, scale);
	mpq_clears(scale, turned, NULL);
	return want_second ? c : s;
}

/* c' = a' times what multiplies it: c itself, or 1 + sign c^2 */
static int self_sequence(struct work *w, enum function function, int a, long sign)
{
	mpq_t scale;
	mpq_init(scale);
	int rate = derivative_of(w, a, scale), c = new_integral(w, function, a, NONE);
	int other = sign ? one_and_square(w, c, sign) : c;
	set_product_integrand(w, c, rate, other, scale);
	mpq_clear(scale);
	return c;
}

/* c' = sign a' / below */
static int arc_sequence(struct work *w, enum function function, int a, int below, long sign)
{
	mpq_t scale, turned;
	mpq_inits(scale, turned, NULL);
	int rate = derivative_of(w, a, scale), quotient = quotient_sequence(w, rate, below);
	int c = new_integral(w, function, a, NONE);
	struct sum sum = { 0 };
	mpq_set_si(turned, sign, 1);
	mpq_mul(scale, scale, turned);
	add_key(&sum, TERM_SEQUENCE, quotient, 0, scale);
	set_integrand(w, c, &sum);
	mpq_clears(scale, turned, NULL);
	return c;
}

/* atan2(y, x)' = (x y' - y x') / (x^2 + y^2) */
static int angle_sequence(struct work *w, int y, int x)
{
	mpq_t scale, one;
	mpq_inits(scale, one, NULL);
	mpq_set_ui(one, 1, 1);
	struct sum above = { 0 }, below = { 0 }, sum = { 0 };
	int rate = derivative_of(w, y, scale);
	add_key(&above, TERM_PRODUCT, rate < x ? rate : x, rate < x ? x : rate, scale);
	rate = derivative_of(w, x, scale);
	mpq_neg(scale, scale);
	add_key(&above, TERM_PRODUCT, rate < y ? rate : y, rate < y ? y : rate, scale);
	add_key(&below, TERM_PRODUCT, x, x, one);
	add_key(&below, TERM_PRODUCT, y, y, one);
	int numerator = sum_sequence(w, &above), denominator = sum_sequence(w, &below);
	int quotient = quotient_sequence(w, numerator, denominator), c = new_integral(w, FN_ATAN2, y, x);
	add_key(&sum, TERM_SEQUENCE, quotient, 0, one);
	set_integrand(w, c, &sum);
	mpq_clears(scale, one, NULL);
	return c;
}

static _Noreturn void no_series(const struct atom *atom, const char *why)
{
	error(atom->node->start, "etdrk4 and the schemes like it step across it, of lower order there",
	      "scheme taylor needs what is smooth between the changes of the loads: '%s' %s",
	      text_between(atom->node->start, atom->node->end), why);
}

static int sequence_of_call(struct work *w, const struct atom *atom)
{
	int a = atom->operands ? sequence_of_form(w, atom->operand[0]) : NONE, b;
	switch (atom->function) {
	case FN_SIN:  return pair_sequence(w, a, FN_SIN, FN_COS, -1, false);
	case FN_COS:  return pair_sequence(w, a, FN_SIN, FN_COS, -1, true);
	case FN_SINH: return pair_sequence(w, a, FN_SINH, FN_COSH, 1, false);
	case FN_COSH: return pair_sequence(w, a, FN_SINH, FN_COSH, 1, true);
	case FN_EXP:  return self_sequence(w, FN_EXP, a, 0);
	case FN_TAN:  return self_sequence(w, FN_TAN, a, 1);
	case FN_TANH: return self_sequence(w, FN_TANH, a, -1);
	case FN_SQRT: return root_sequence(w, a);
	case FN_LOG:  return arc_sequence(w, FN_LOG, a, a, 1);
	case FN_ATAN: return arc_sequence(w, FN_ATAN, a, one_and_square(w, a, 1), 1);
	case FN_ASIN: return arc_sequence(w, FN_ASIN, a, root_sequence(w, one_and_square(w, a, -1)), 1);
	case FN_ACOS: return arc_sequence(w, FN_ACOS, a, root_sequence(w, one_and_square(w, a, -1)), -1);
	case FN_ATAN2:
		b = sequence_of_form(w, atom->operand[1]);
		return angle_sequence(w, a, b);
	default: no_series(atom, "is not");
	}
}

static int sequence_of_power(struct work *w, const struct atom *atom)
{
	const struct form *exponent = atom->operand[1];
	int base = sequence_of_form(w, atom->operand[0]);
	mpq_t value;
	mpq_init(value);
	if (!is_constant(exponent)) {           /* e^{b log a} */
		int log = arc_sequence(w, FN_LOG, base, base, 1);
		return self_sequence(w, FN_EXP, product_sequence(w, sequence_of_form(w, exponent), log), 0);
	}
	mpq_set_ui(value, 0, 1);
	for (int i = 0; i < exponent->terms; i++) {
		mpq_t part;
		mpq_init(part);
		mpq_set(part, exponent->term[i].factor);
		if (exponent->term[i].basis.kind == BASIS_PI)
			mpq_mul(part, part, w->pi);
		mpq_add(value, value, part);
		mpq_clear(part);
	}
	struct sequence made = { .kind = SEQUENCE_POWER, .state = NONE, .a = base, .b = NONE };
	made.exponent = rounded(w, value);
	bool half = mpq_cmp_ui(value, 1, 2) == 0;
	mpq_clear(value);
	return half ? root_sequence(w, base) : new_sequence(w, made);
}

/* Constant, or a + b t */
static bool is_linear_in_time(const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		bool time = basis->kind == BASIS_WAVE && is_polynomial(basis->wave) && basis->power <= 1;
		if (!time && basis->kind > BASIS_PI)
			return false;
	}
	return true;
}

static int sequence_of_choice(struct work *w, const struct atom *atom)
{
	const struct form *condition = atom->operand[0];
	const struct atom *compare = condition->terms == 1 ? condition->term[0].basis.atom : NULL;
	if (!compare || compare->kind != ATOM_COMPARE || mpq_cmp_ui(condition->term[0].factor, 1, 1) != 0 ||
	    !is_linear_in_time(compare->operand[0]) || !is_linear_in_time(compare->operand[1]))
		no_series(atom, "changes where that is not known beforehand");
	struct sequence made = { .kind = SEQUENCE_CHOICE, .state = NONE, .left = compare->operand[0],
				 .right = compare->operand[1], .comparison = compare->comparison };
	made.a = sequence_of_form(w, atom->operand[1]);
	made.b = sequence_of_form(w, atom->operand[2]);
	return new_sequence(w, made);
}

static int sequence_of_atom(struct work *w, const struct atom *atom)
{
	if (w->atom[atom->index] != NONE)
		return w->atom[atom->index];
	int made;
	switch (atom->kind) {
	case ATOM_PRODUCT:    made = sequence_of_product(w, atom); break;
	case ATOM_RECIPROCAL: made = quotient_sequence(w, NONE, sequence_of_form(w, atom->operand[0])); break;
	case ATOM_POWER:      made = sequence_of_power(w, atom); break;
	case ATOM_CALL:       made = sequence_of_call(w, atom); break;
	case ATOM_CHOOSE:     made = sequence_of_choice(w, atom); break;
	default:              no_series(atom, "jumps");
	}
	return w->atom[atom->index] = made;
}

/* ---- how often each atom is read ---- */

static void count_uses(struct work *w, const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct atom *atom = form->term[i].basis.atom;
		if (!atom || w->uses[atom->index]++ > 0)
			continue;
		for (int k = 0; k < atom->operands; k++)
			count_uses(w, atom->operand[k]);
	}
}

/* ---- the states ---- */

/* Loads whose force changes in time have their factors in a table. */
static void add_changing_loads(struct work *w, struct sequence *s, int state, const mpq_t *scale)
{
	struct expansion *x = w->x;
	int size = w->layout.size, segments = w->system->segments, stride = x->order + 1;
	for (int l = 0; l < w->system->loads; l++) {
		int at = w->layout.load[l], n = w->system->load[l].columns, first = first_column(w->system, l);
		bool any = false;
		for (int k = 0; k < segments && at >= 0; k++)
			for (int j = 0; j < n; j++)
				any = any || mpq_sgn(w->slopes[k][state * size + at + j]) != 0;
		if (!any)
			continue;
		x->load[l] = true;
		for (int j = 0; j < n; j++) {
			ENLARGE(s->term, (size_t)s->terms + 1);
			s->term[s->terms++] = (struct sequence_term){ .kind = TERM_LOAD, .a = first + j,
								      .slot = x->slots + j };
		}
		ENLARGE(x->slot_load, (size_t)(x->slots + n));
		ENLARGE(x->changing, (size_t)((x->slots + n) * segments * stride));
		for (int k = 0; k < segments; k++) {
			mpq_t *row = rationals((size_t)n);
			for (int j = 0; j < n; j++)
				mpq_set(row[j], w->slopes[k][state * size + at + j]);
			const double *value = load_numbers(w, l, row, scale);
			for (int j = 0; j < n; j++)
				for (int m = 0; m < stride; m++)
					x->changing[((x->slots + j) * segments + k) * stride + m] = value[m * n + j];
			rationals_free(row, (size_t)n);
		}
		for (int j = 0; j < n; j++)
			x->slot_load[x->slots++] = first + j;
	}
}

/* y' of a state: its row of A, loads, inputs, and what is left over, whose linear terms may cancel */
static struct sum slope_of_state(struct work *w, int state)
{
	const struct model *model = w->step->model;
	const struct layout *layout = &w->layout;
	mpq_t *row = w->slopes[0] + state * layout->size;
	struct sum sum = { 0 };
	for (int j = 0; j < layout->states; j++)
		if (mpq_sgn(row[j]) != 0)
			add_key(&sum, TERM_SEQUENCE, j, 0, row[j]);
	for (int i = 0; i < w->system->inputs; i++) {
		if (mpq_sgn(row[layout->input[i]]) != 0)
			add_key(&sum, TERM_INPUT, i, 0, row[layout->input[i]]);
		if (w->system->input[i].hold && mpq_sgn(row[layout->input[i] + 1]) != 0)
			add_key(&sum, TERM_SLOPE, i, 0, row[layout->input[i] + 1]);
	}
	for (int l = 0, column = 0; l < w->system->loads; column += w->system->load[l++].columns)
		for (int j = 0; j < w->system->load[l].columns && layout->load[l] >= 0; j++) {
			mpq_srcptr factor = row[layout->load[l] + j];
			if (mpq_sgn(factor) == 0 || w->system->segments > 1)
				continue;
			bool power = is_polynomial(w->system->load[l].wave);
			add_key(&sum, power ? TERM_TIME : TERM_LOAD, power ? j : column + j, 0, factor);
		}
	for (int e = 0; e < w->system->channels; e++)
		if (mpq_sgn(row[layout->channel + e]) != 0)
			add_form(w, &sum, model->operator[0].left[e], row[layout->channel + e]);
	return sum;
}

static void expand_state(struct work *w, int state)
{
	mpq_t *scale = integral_scale(w, true);
	struct sum sum = slope_of_state(w, state);      /* makes sequences: the array may move */
	struct sequence made = w->x->sequence[state];
	fill_sum(w, &made, &sum, (const mpq_t *)scale);
	if (w->system->segments > 1)
		add_changing_loads(w, &made, state, (const mpq_t *)scale);
	w->x->sequence[state] = made;
	rationals_free(scale, (size_t)w->x->order + 1);
}

/* ---- which coefficients there are, and are read ---- */

static int degree_of_term(const struct work *w, const struct sequence_term *t)
{
	const struct sequence *all = w->x->sequence;
	int order = w->x->order, degree = 0;
	if (t->kind == TERM_SEQUENCE)
		degree = all[t->a].degree;
	else if (t->kind == TERM_PRODUCT)
		degree = all[t->a].degree + all[t->b].degree;
	else if (t->slot >= 0)
		degree = order + 1;
	else
		for (int k = 0; k <= order; k++)
			degree = t->factor[k] != 0 ? k : degree;
	return degree > order ? order + 1 : degree;
}

static int degree_now(const struct work *w, const struct sequence *s)
{
	int degree = 0, order = w->x->order;
	const struct sequence *all = w->x->sequence;
	bool constant = (s->a == NONE || all[s->a].degree == 0) && (s->b == NONE || all[s->b].degree == 0);
	switch (s->kind) {
	case SEQUENCE_SUM:
	case SEQUENCE_INTEGRAL:
		for (int i = 0; i < s->terms; i++) {
			int of_term = degree_of_term(w, &s->term[i]);
			degree = of_term > degree ? of_term : degree;
		}
		if (s->kind == SEQUENCE_INTEGRAL)
			degree = s->state == NONE && constant ? 0 : degree < order ? degree + 1 : order + 1;
		return degree;
	case SEQUENCE_RATE:
		return all[s->a].degree > order ? order + 1 : all[s->a].degree > 0 ? all[s->a].degree - 1 : 0;
	case SEQUENCE_CHOICE:
		return all[s->a].degree > all[s->b].degree ? all[s->a].degree : all[s->b].degree;
	default:
		return constant ? 0 : order + 1;
	}
}

/* From below: what is found to have more terms makes others have more. */
static void find_degrees(struct work *w)
{
	bool changed = true;
	while (changed) {
		changed = false;
		for (int i = 0; i < w->x->count; i++) {
			int degree = degree_now(w, &w->x->sequence[i]);
			changed = changed || degree > w->x->sequence[i].degree;
			if (degree > w->x->sequence[i].degree)
				w->x->sequence[i].degree = degree;
		}
	}
}

static bool raise(struct expansion *x, int sequence, int top)
{
	struct sequence *s = sequence == NONE ? NULL : &x->sequence[sequence];
	if (!s || top <= s->top)
		return false;
	s->top = top > x->order ? x->order : top;
	return true;
}

/* What sequence i reads up to its top */
static bool raise_operands(struct expansion *x, int i)
{
	const struct sequence *s = &x->sequence[i];
	int top = s->top;
	bool changed = false;
	if (top < 0)
		return false;
	bool integral = s->kind == SEQUENCE_INTEGRAL;
	for (int k = 0; k < s->terms; k++) {
		const struct sequence_term *t = &s->term[k];
		if (t->kind == TERM_SEQUENCE || t->kind == TERM_PRODUCT)
			changed |= raise(x, t->a, top - integral);
		if (t->kind == TERM_PRODUCT)
			changed |= raise(x, t->b, top - integral);
	}
	int operand = integral ? 0 : s->kind == SEQUENCE_RATE ? top + 1 : top;
	changed |= raise(x, s->a, operand);
	changed |= raise(x, s->b, operand);
	return changed;
}

static void find_tops(struct work *w)
{
	struct expansion *x = w->x;
	bool changed = true;
	for (int i = 0; i < w->system->states; i++)
		x->sequence[i].top = x->order;
	while (changed) {
		changed = false;
		for (int i = 0; i < x->count; i++)
			changed |= raise_operands(x, i);
	}
}

/* What reads a rate comes with it one later. */
static void find_late(struct work *w)
{
	struct expansion *x = w->x;
	for (bool changed = true; changed;) {
		changed = false;
		for (int i = 0; i < x->count; i++) {
			struct sequence *s = &x->sequence[i];
			bool late = s->kind == SEQUENCE_RATE;
			for (int k = 0; k < s->terms; k++) {
				const struct sequence_term *t = &s->term[k];
				if (t->kind == TERM_SEQUENCE || t->kind == TERM_PRODUCT)
					late = late || x->sequence[t->a].late;
				if (t->kind == TERM_PRODUCT)
					late = late || x->sequence[t->b].late;
			}
			late = late || (s->a != NONE && x->sequence[s->a].late) || (s->b != NONE && x->sequence[s->b].late);
			if (s->kind == SEQUENCE_INTEGRAL)
				late = false;
			changed = changed || late != s->late;
			s->late = late;
		}
	}
}

static void find_time(struct work *w)
{
	for (int i = 0; i < w->x->count; i++)
		for (int k = 0; k < w->x->sequence[i].terms; k++) {
			const struct sequence_term *t = &w->x->sequence[i].term[k];
			w->x->time = w->x->time || (t->kind == TERM_TIME && t->a > 0);
		}
}

/* ---- the whole ---- */

static struct layout place_all(struct work *w)
{
	struct reads reads = { 0 };
	const struct model *model = w->step->model;
	reads = reads_of(model, model->channels, (const struct form *const *)model->operator[0].left);
	bool *needed = ARRAY(bool, (size_t)w->system->loads);
	for (int l = 0; l < w->system->loads; l++)
		needed[l] = reads.load[l] || load_acts(w->system, &w->system->load[l]);
	return layout_with(w->system, 1, needed);
}

static void start_states(struct work *w)
{
	for (int i = 0; i < w->system->states; i++)
		new_sequence(w, (struct sequence){ .kind = SEQUENCE_INTEGRAL, .state = i, .a = NONE, .b = NONE });
}

struct expansion *expansion_of(const struct step *step)
{
	const struct linear *system = &step->branch->system;
	const struct model *model = step->model;
	int atoms = atoms_count(model->atoms);
	struct work work = { .step = step, .system = system, .x = NEW(struct expansion) }, *w = &work;
	w->x->order = model->truncation.order;
	w->x->load = ARRAY(bool, (size_t)system->loads);
	w->x->input = ARRAY(bool, (size_t)system->inputs);
	w->x->slope = ARRAY(bool, (size_t)system->inputs);
	w->uses = ARRAY(int, (size_t)atoms);
	w->atom = ARRAY(int, (size_t)atoms);
	for (int i = 0; i < atoms; i++)
		w->atom[i] = NONE;
	mpq_init(w->pi);
	constant_pi(w->pi);
	w->layout = place_all(w);
	w->slopes = ARRAY(mpq_t *, (size_t)system->segments);
	for (int k = 0; k < system->segments; k++)
		w->slopes[k] = augmented_matrix(&w->layout, system, k);
	for (int e = 0; e < model->channels; e++)
		count_uses(w, model->operator[0].left[e]);
	start_states(w);
	for (int i = 0; i < system->states; i++)
		expand_state(w, i);
	find_degrees(w);
	find_tops(w);
	find_late(w);
	find_time(w);
	return w->x;
}
