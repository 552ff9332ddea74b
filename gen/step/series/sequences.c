/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forms to sums of sequences, atoms to recurrences, each once. Sources of the recurrences: Moore 1966; Griewank and
 * Walther 2008, chapter 13. */
#include "inner.h"

/* ---- sums ---- */

static void add_forcing(const struct sequencing *w, struct sum *sum, const struct basis *basis, mpq_srcptr factor)
{
	int l = 0;
	if (is_polynomial(basis->forcing)) {
		sum_add(sum, TERM_TIME, basis->power, 0, factor);
		return;
	}
	while (w->system->load[l].forcing != basis->forcing)
		l++;
	int column = oscillates(basis->forcing) ? 2 * basis->power + basis->sine : basis->power;
	sum_add(sum, TERM_LOAD, column_of_load(w->system, l) + column, 0, factor);
}

/* A state, or a highest derivative that equations are solved for */
static int state_of(const struct sequencing *w, const struct basis *basis)
{
	if (is_highest(&w->step->model->frame, basis) && w->highest[basis->index] != NONE)
		return w->highest[basis->index];
	return basis->order ? w->system->velocity[basis->index] : basis->index;
}

static int sequence_of_atom(struct sequencing *w, const struct atom *atom);
static bool add_product(struct sequencing *w, struct sum *sum, const struct atom *atom, mpq_srcptr factor);

void sum_add_form(struct sequencing *w, struct sum *sum, const struct form *form, mpq_srcptr scale)
{
	RATIONAL factor = ZERO;
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		mpq_mul(factor, form->term[i].factor, scale);
		switch (basis->kind) {
		case BASIS_PI:
			mpq_mul(factor, factor, w->pi);
			sum_add(sum, TERM_TIME, 0, 0, factor);
			break;
		case BASIS_ONE:
			sum_add(sum, TERM_TIME, 0, 0, factor);
			break;
		case BASIS_FORCING:
			add_forcing(w, sum, basis, factor);
			break;
		case BASIS_INPUT:
			sum_add(sum, basis->order ? TERM_SLOPE : TERM_INPUT, basis->index, 0, factor);
			break;
		case BASIS_COORD:
			sum_add(sum, TERM_SEQUENCE, state_of(w, basis), 0, factor);
			break;
		case BASIS_ATOM:
			if (is_friction(basis->atom))   /* added by what holds */
				break;
			if (!add_product(w, sum, basis->atom, factor))
				sum_add(sum, TERM_SEQUENCE, sequence_of_atom(w, basis->atom), 0, factor);
			break;
		}
	}
}

/* ---- operands ---- */

int sequence_of_sum(struct sequencing *w, struct sum *sum)
{
	shift_rates(w, sum);
	const struct key *key = sum->key;
	bool plain = sum->keys == 1 && key->kind == TERM_SEQUENCE && mpq_cmp_ui(key->factor, 1, 1) == 0;
	return plain ? key->a : sum_sequence(w, sum);
}

int sequence_of_form(struct sequencing *w, const struct form *form)
{
	struct sum sum = { 0 };
	for (int i = 0; i < w->operands; i++)
		if (w->operand[i].form == form)
			return w->operand[i].sequence;
	RATIONAL one = RATIO(1, 1);
	sum_add_form(w, &sum, form, one);
	int made = sequence_of_sum(w, &sum);
	ENLARGE(w->operand, (size_t)w->operands + 1);
	w->operand[w->operands].form = form;
	w->operand[w->operands++].sequence = made;
	return made;
}

static int power_sequence(struct sequencing *w, int base, unsigned n)
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
static int product_of(struct sequencing *w, const struct atom *atom, bool below, int *last)
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

static int whole_product(struct sequencing *w, const struct atom *atom, bool below)
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

static int quotient_sequence(struct sequencing *w, int a, int b)
{
	return new_sequence(w, (struct sequence){ .kind = SEQUENCE_QUOTIENT, .state = NONE, .a = a, .b = b });
}

/* A product that nothing else reads stands in the sum itself: its highest coefficients are then added last. */
static bool add_product(struct sequencing *w, struct sum *sum, const struct atom *atom, mpq_srcptr factor)
{
	int last;
	if (atom->kind != ATOM_PRODUCT || w->uses[atom->index] > 1 || has_divisor(atom))
		return false;
	int product = product_of(w, atom, false, &last);
	if (product == NONE)
		return false;
	sum_add(sum, TERM_PRODUCT, product < last ? product : last, product < last ? last : product, factor);
	return true;
}

static int sequence_of_product(struct sequencing *w, const struct atom *atom)
{
	int above = whole_product(w, atom, false), below = whole_product(w, atom, true);
	return below == NONE ? above : quotient_sequence(w, above, below);
}

/* ---- derivatives with respect to time ---- */

/* Where a sequence is a sum of coordinates of second order: the same of their velocities, which are there earlier */
static int velocities_of(struct sequencing *w, int sequence)
{
	struct sum sum = { 0 };
	const struct sequence *s = &w->x->sequence[sequence];
	if (s->state != NONE && s->state < w->system->n && w->system->velocity[s->state] >= 0)
		return w->system->velocity[s->state];
	if (s->kind != SEQUENCE_SUM)
		return NONE;
	RATIONAL factor = ZERO;
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *t = &s->term[i];
		bool coordinate = t->kind == TERM_SEQUENCE && t->a < w->system->n && w->system->velocity[t->a] >= 0;
		bool constant = t->kind == TERM_TIME && t->a == 0 && t->factor[0] != 0;
		mpq_set_d(factor, t->factor[0]);
		if (coordinate)
			sum_add(&sum, TERM_SEQUENCE, w->system->velocity[t->a], 0, factor);
		if (!coordinate && !constant)
			return NONE;
	}
	return sum.keys ? sum_sequence(w, &sum) : NONE;
}

/* a' as a sequence times *scale, so that k a_k = *scale times its (k-1)-th */
static int derivative_of(struct sequencing *w, int sequence, mpq_ptr scale)
{
	int velocity = velocities_of(w, sequence);
	mpq_set_ui(scale, 1, 1);
	if (velocity != NONE) {
		mpq_set(scale, w->unit);
		return velocity;
	}
	return new_sequence(w, (struct sequence){ .kind = SEQUENCE_RATE, .state = NONE, .a = sequence, .b = NONE });
}

/* c = function(a_0) at first, c' = sum: set afterwards, since it may read c */
static int new_integral(struct sequencing *w, enum function function, int a, int b)
{
	return new_sequence(w, (struct sequence){ .kind = SEQUENCE_INTEGRAL, .state = NONE, .function = function,
						  .a = a, .b = b });
}

static void set_integrand(struct sequencing *w, int sequence, const struct sum *sum)
{
	RATIONALS *scale = integral_scale(w, false);
	sum_numbers(w, &w->x->sequence[sequence], sum, scale);
}

/* c' = factor a' b */
static void set_product_integrand(struct sequencing *w, int sequence, int rate, int other, mpq_srcptr factor)
{
	struct sum sum = { 0 };
	sum_add(&sum, TERM_PRODUCT, rate < other ? rate : other, rate < other ? other : rate, factor);
	set_integrand(w, sequence, &sum);
}

/* ---- functions ---- */

/* 1 + sign a^2 */
static int one_and_square(struct sequencing *w, int a, long sign)
{
	struct sum sum = { 0 };
	RATIONAL factor = RATIO(1, 1);
	sum_add(&sum, TERM_TIME, 0, 0, factor);
	mpq_set_si(factor, sign, 1);
	sum_add(&sum, TERM_PRODUCT, a, a, factor);
	return sum_sequence(w, &sum);
}

static int root_sequence(struct sequencing *w, int a)
{
	return new_sequence(w, (struct sequence){ .kind = SEQUENCE_ROOT, .state = NONE, .a = a, .b = NONE });
}

/* s' = a' c, c' = sign a' s: both are made, and the one asked for returned */
static int pair_sequence(struct sequencing *w, int a, enum function first, enum function second, long sign,
			 bool want_second)
{
	RATIONAL scale = ZERO;
	for (int i = 0; i < w->x->count; i++) {
		const struct sequence *s = &w->x->sequence[i];
		if (s->kind == SEQUENCE_INTEGRAL && s->state == NONE && s->function == first && s->a == a)
			return want_second ? i + 1 : i;
	}
	int rate = derivative_of(w, a, scale);
	int s = new_integral(w, first, a, NONE), c = new_integral(w, second, a, NONE);
	set_product_integrand(w, s, rate, c, scale);
	if (sign < 0)
		mpq_neg(scale, scale);
	set_product_integrand(w, c, rate, s, scale);
	return want_second ? c : s;
}

/* c' = a' times what multiplies it: c itself, or 1 + sign c^2 */
static int self_sequence(struct sequencing *w, enum function function, int a, long sign)
{
	RATIONAL scale = ZERO;
	int rate = derivative_of(w, a, scale), c = new_integral(w, function, a, NONE);
	int other = sign ? one_and_square(w, c, sign) : c;
	set_product_integrand(w, c, rate, other, scale);
	return c;
}

/* c' = sign a' / below */
static int arc_sequence(struct sequencing *w, enum function function, int a, int below, long sign)
{
	RATIONAL scale = ZERO;
	int rate = derivative_of(w, a, scale), quotient = quotient_sequence(w, rate, below);
	int c = new_integral(w, function, a, NONE);
	struct sum sum = { 0 };
	if (sign < 0)
		mpq_neg(scale, scale);
	sum_add(&sum, TERM_SEQUENCE, quotient, 0, scale);
	set_integrand(w, c, &sum);
	return c;
}

/* atan2(y, x)' = (x y' - y x') / (x^2 + y^2) */
static int angle_sequence(struct sequencing *w, int y, int x)
{
	RATIONAL scale = ZERO, one = RATIO(1, 1);
	struct sum above = { 0 }, below = { 0 }, sum = { 0 };
	int rate = derivative_of(w, y, scale);
	sum_add(&above, TERM_PRODUCT, rate < x ? rate : x, rate < x ? x : rate, scale);
	rate = derivative_of(w, x, scale);
	mpq_neg(scale, scale);
	sum_add(&above, TERM_PRODUCT, rate < y ? rate : y, rate < y ? y : rate, scale);
	sum_add(&below, TERM_PRODUCT, x, x, one);
	sum_add(&below, TERM_PRODUCT, y, y, one);
	int numerator = sum_sequence(w, &above), denominator = sum_sequence(w, &below);
	int quotient = quotient_sequence(w, numerator, denominator), c = new_integral(w, FN_ATAN2, y, x);
	sum_add(&sum, TERM_SEQUENCE, quotient, 0, one);
	set_integrand(w, c, &sum);
	return c;
}

static _Noreturn void no_series(const struct sequencing *w, const struct atom *atom, const char *why)
{
	error(atom->node->start, "etdrk4 and the schemes like it step across it, of lower order there",
	      "scheme %s needs what is smooth between the changes of the loads: '%s' "
	      "%s", scheme_name(w->step->model->scheme),
	      text_between(atom->node->start, atom->node->end), why);
}

/* ---- what has a formula in each interval, of time or of a switching function of the state ---- */

/* `above` where a - b > 0, else `below` */
static int choice_by_state(struct sequencing *w, const struct form *a, const struct form *b, int above, int below)
{
	struct division d = divide_forms(w, a, b);
	if (d.function == NONE)
		return d.above ? above : below;
	if (w->x->function[d.function].sequence == NONE) {
		int made = sequence_of_form(w, w->x->function[d.function].form);
		w->x->function[d.function].sequence = made;
	}
	return new_sequence(w, (struct sequence){ .kind = SEQUENCE_CHOICE, .choice = CHOICE_BY_STATE, .state = NONE,
						  .switching = d.function, .breakpoint = d.breakpoint,
						  .a = d.above ? above : below, .b = d.above ? below : above });
}

static int choice(struct sequencing *w, const struct atom *atom, const struct form *left, enum comparison comparison,
		  const struct form *right, int a, int b)
{
	if (is_linear_in_time(left) && is_linear_in_time(right))
		return new_sequence(w, (struct sequence){ .kind = SEQUENCE_CHOICE, .state = NONE, .left = left,
							  .right = right, .comparison = comparison, .a = a, .b = b });
	if (comparison >= CMP_EQ)
		no_series(w, atom, "asks whether things are equal that are so at single times");
	return comparison <= CMP_LE ? choice_by_state(w, left, right, b, a)
				    : choice_by_state(w, left, right, a, b);
}

int positive_sequence(struct sequencing *w, const struct form *form, int a)
{
	const struct form *zero = form_number(0);
	return choice_by_state(w, form, zero, a, sequence_of_form(w, zero));
}

static int sequence_of_constant(struct sequencing *w, long value)
{
	return sequence_of_form(w, form_number(value));
}

static int best_from(struct sequencing *w, const struct atom *a, int next, int champion)
{
	if (next == a->operands)
		return sequence_of_form(w, a->operand[champion]);
	int other = best_from(w, a, next + 1, next), same = best_from(w, a, next + 1, champion);
	return choice(w, a, a->operand[next], a->function == FN_MIN ? CMP_LT : CMP_GT, a->operand[champion], other,
		      same);
}

static int sequence_of_table(struct sequencing *w, const struct atom *a)
{
	struct straight *piece;
	int pieces = pieces_of_atom(a, &piece), made = NONE;
	RATIONAL shift = ZERO;
	for (int i = pieces - 1; i >= 0; i--) {
		mpq_mul(shift, piece[i].slope, piece[i].x);
		mpq_sub(shift, piece[i].y, shift);
		struct form *line = form_sum(form_scale(a->operand[0], piece[i].slope), form_constant(shift), false);
		int here = sequence_of_form(w, line);
		made = made == NONE ? here
				    : choice(w, a, a->operand[0], CMP_LT, form_constant(piece[i].end), here, made);
	}
	return made;
}

/* x outside low .. high: what it is below, between and above */
static int sequence_in_three(struct sequencing *w, const struct atom *atom, int below, int between, int above)
{
	const struct form *const *x = atom->operand;
	int inner = choice(w, atom, x[0], CMP_GT, x[2], above, between);
	return choice(w, atom, x[0], CMP_LT, x[1], below, inner);
}

/* Of functions with kinks; NONE: of others. Sequences are numbered in the order in which they are made. */
static int sequence_in_pieces(struct sequencing *w, const struct atom *a)
{
	const struct form *x = a->operand[0], *zero = form_number(0);
	struct straight *piece;
	RATIONAL minus = RATIO(-1, 1);
	int between, last;
	switch (a->function) {
	case FN_ABS:
		last = sequence_of_form(w, x);
		return choice(w, a, x, CMP_LT, zero, sequence_of_form(w, form_scale(x, minus)), last);
	case FN_SGN:
		last = sequence_of_constant(w, is_linear_in_time(x) ? 0 : 1);
		last = choice(w, a, x, CMP_LT, zero, sequence_of_constant(w, -1), last);
		return is_linear_in_time(x) ? choice(w, a, x, CMP_GT, zero, sequence_of_constant(w, 1), last) : last;
	case FN_MIN:
	case FN_MAX:
		return a->operands > LIMIT_COMPARED ? NONE : best_from(w, a, 1, 0);
	case FN_CLIP:
		last = sequence_of_form(w, a->operand[2]);
		between = sequence_of_form(w, x);
		return sequence_in_three(w, a, sequence_of_form(w, a->operand[1]), between, last);
	case FN_DEADZONE:
		last = sequence_of_form(w, form_difference(x, a->operand[2]));
		between = sequence_of_constant(w, 0);
		return sequence_in_three(w, a, sequence_of_form(w, form_difference(x, a->operand[1])), between, last);
	case FN_TABLE:
		return pieces_of_atom(a, &piece) > LIMIT_STRAIGHTS ? NONE : sequence_of_table(w, a);
	default:
		return NONE;
	}
}

static int sequence_of_call(struct sequencing *w, const struct atom *atom)
{
	int in_pieces = sequence_in_pieces(w, atom);
	if (in_pieces != NONE)
		return in_pieces;
	int a = sequence_of_form(w, atom->operand[0]);
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
	case FN_ATAN2: return angle_sequence(w, a, sequence_of_form(w, atom->operand[1]));
	case FN_SLIDE:
		error(atom->node->start,
		      "with a small mass it has one; scheme exact takes it beside what is piecewise linear",
		      "scheme %s: friction of what has no mass has no series", scheme_name(w->step->model->scheme));
	default: no_series(w, atom, "is not");
	}
}

static int sequence_of_power(struct sequencing *w, const struct atom *atom)
{
	const struct form *exponent = atom->operand[1];
	int base = sequence_of_form(w, atom->operand[0]);
	RATIONAL value = ZERO;
	if (!is_constant(exponent)) {           /* e^{b log a} */
		int log = arc_sequence(w, FN_LOG, base, base, 1);
		return self_sequence(w, FN_EXP, product_sequence(w, sequence_of_form(w, exponent), log), 0);
	}
	for (int i = 0; i < exponent->terms; i++) {
		RATIONAL part = ZERO;
		mpq_set(part, exponent->term[i].factor);
		if (exponent->term[i].basis.kind == BASIS_PI)
			mpq_mul(part, part, w->pi);
		mpq_add(value, value, part);
	}
	if (mpq_cmp_ui(value, 1, 2) == 0)
		return root_sequence(w, base);
	return new_sequence(w, (struct sequence){ .kind = SEQUENCE_POWER, .state = NONE, .a = base, .b = NONE,
						  .exponent = equation_number(w->step->model, value).value });
}

static int sequence_of_choice(struct sequencing *w, const struct atom *atom)
{
	const struct form *condition = atom->operand[0];
	const struct atom *compare = condition->terms == 1 ? condition->term[0].basis.atom : NULL;
	bool plain = compare && compare->kind == ATOM_COMPARE && mpq_cmp_ui(condition->term[0].factor, 1, 1) == 0;
	if (!plain && !is_stepwise(condition))
		no_series(w, atom, "changes where that is not known beforehand");
	int a = sequence_of_form(w, atom->operand[1]), b = sequence_of_form(w, atom->operand[2]);
	if (plain)
		return choice(w, compare, compare->operand[0], compare->comparison, compare->operand[1], a, b);
	int test = sequence_of_form(w, condition);
	return new_sequence(w, (struct sequence){ .kind = SEQUENCE_CHOICE, .state = NONE, .test = test,
						  .choice = CHOICE_BY_SEQUENCE, .a = a, .b = b });
}

/* What the instance holds: the same at all times */
static int sequence_of_param(struct sequencing *w, const struct atom *atom)
{
	return single_sequence(w, TERM_PARAM, atom->param->tuning.number - 1, 0, 1);
}

static int entry_sequence(struct sequencing *w, const struct form *form)
{
	return form->terms ? sequence_of_form(w, form) : NONE;
}

/* M x - f of a row, as a sum */
static int residual_of_row(struct sequencing *w, const struct linear_equations *e, int row)
{
	struct sum sum = { 0 };
	RATIONAL one = RATIO(1, 1), minus = RATIO(-1, 1);
	for (int j = 0; j < e->n; j++)
		if (e->matrix[row * e->n + j] != NONE)
			sum_add(&sum, TERM_PRODUCT, e->matrix[row * e->n + j], e->first + j, one);
	if (e->right[row] != NONE)
		sum_add(&sum, TERM_SEQUENCE, e->right[row], 0, minus);
	return sum_sequence(w, &sum);
}

/* All components, one after the other; returns the first */
static int solution_sequences(struct sequencing *w, const struct atom *a)
{
	struct linear_equations *e = NEW(struct linear_equations);
	const struct linear_system system = system_of(a, a->operand);
	const int n = system.n;
	*e = (struct linear_equations){ .n = n, .number = w->x->equations++, .first = w->x->count,
					.matrix = ARRAY(int, n * n), .right = ARRAY(int, n),
					.residual = ARRAY(int, n) };
	for (int j = 0; j < n; j++)
		new_sequence(w, (struct sequence){ .kind = SEQUENCE_SOLUTION, .state = NONE, .a = NONE, .b = NONE,
						  .equations = e, .component = j });
	ENLARGE(w->solution, (size_t)w->solutions + 1);  /* its own formulas may be chosen by it */
	w->solution[w->solutions].atom = a;
	w->solution[w->solutions++].first = e->first;
	for (int j = 0; j < n && a->written; j++)
		w->highest[a->written->highest[j].index] = e->first + j;
	for (int i = 0; a->written && i < a->written->kinks; i++)
		*MORE(w->x->kink, w->x->kinks) = a->written->kink[i];
	for (int i = 0; i < n; i++)
		e->right[i] = entry_sequence(w, system.f[i]);
	for (int i = 0; i < n * n; i++)
		e->matrix[i] = entry_sequence(w, system.M[i]);
	w->solving = true;
	for (int i = n - 1; i >= 0; i--)        /* of a chain the last is the smallest sum, to which others add */
		e->residual[i] = a->written ? sequence_of_form(w, a->written->residual[i]) : residual_of_row(w, e, i);
	w->solving = false;
	return e->first;
}

static int solution_sequence(struct sequencing *w, const struct atom *a)
{
	for (int i = 0; i < w->solutions; i++)
		if (same_solution(w->solution[i].atom, a))
			return w->solution[i].first + a->component;
	return solution_sequences(w, a) + a->component;
}

static int sequence_of_atom(struct sequencing *w, const struct atom *atom)
{
	if (w->atom[atom->index] != NONE)
		return w->atom[atom->index];
	int made;
	switch (atom->kind) {
	case ATOM_PARAM:      made = sequence_of_param(w, atom); break;
	case ATOM_PRODUCT:    made = sequence_of_product(w, atom); break;
	case ATOM_RECIPROCAL: made = quotient_sequence(w, NONE, sequence_of_form(w, atom->operand[0])); break;
	case ATOM_POWER:      made = sequence_of_power(w, atom); break;
	case ATOM_CALL:       made = sequence_of_call(w, atom); break;
	case ATOM_CHOOSE:     made = sequence_of_choice(w, atom); break;
	case ATOM_SOLUTION:   made = solution_sequence(w, atom); break;
	default:
		made = sequence_of_constant(w, 0);
		made = choice(w, atom, atom->operand[0], atom->comparison, atom->operand[1],
			      sequence_of_constant(w, 1), made);
	}
	return w->atom[atom->index] = made;
}
