/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Atoms, derivatives and forms at a point: random expressions are made as forms and, beside them, as plain trees that
 * are evaluated by MPFR directly; both have the same values. Derivatives are held against difference quotients of the
 * tree. */
#include "trees.h"

static struct at at;                    /* where a form and its tree are compared; their values there */
static mpfr_t found, expected;

/* ---- values ---- */

static bool irrational_met(void)
{
	return collector.irrational_count > 0;
}

/* Functions of constants become rationals of 256 bits: what holds one is compared to fewer digits */
static void forms_have_the_values_of_their_trees(void **state)
{
	int compared = 0;
	(void)state;
	for (int n = 0; n < CASES; n++) {
		new_collector();
		struct attempt a = { .tree = draw_tree(1 + (int)draw(4)) };
		if (!silent_guard(make_form, &a))
			continue;
		draw_point(&at);
		value_of(a.tree, &at, expected);
		if (mpfr_nan_p(expected))
			continue;
		sampled(a.form, &at, found);
		assert_close("value", n, a.tree, found, expected, irrational_met() ? -100 : -250);
		compared++;
	}
	print_message("# %d of %d forms compared\n", compared, CASES);
	assert_true(compared > CASES / 2);
}

static void constants_are_folded(void **state)
{
	int compared = 0;
	constants_only = true;
	(void)state;
	for (int n = 0; n < CASES; n++) {
		new_collector();
		struct attempt a = { .tree = draw_tree(1 + (int)draw(4)) };
		if (!silent_guard(make_form, &a))
			continue;
		value_of(a.tree, &at, expected);
		if (mpfr_nan_p(expected))
			continue;
		if (!is_constant(a.form) || atoms_count(collector.atoms) > 0)
			fail_msg("case %d: %s is not folded: %d terms, %d atoms", n, tree_text(a.tree), a.form->terms,
					 atoms_count(collector.atoms));
		sampled(a.form, &at, found);
		assert_close("constant", n, a.tree, found, expected, irrational_met() ? -100 : -250);
		compared++;
	}
	constants_only = false;
	print_message("# %d of %d constants compared\n", compared, CASES);
	assert_true(compared > CASES / 3);
}

/* With sums turned round */
static struct tree *copied_tree(const struct tree *from)
{
	bool turned = from->kind == SUM;
	struct tree *tree = NEW(struct tree);
	*tree = *from;
	for (int i = 0; i < from->children; i++)
		tree->child[i] = copied_tree(from->child[turned ? 1 - i : i]);
	return tree;
}

/* The same again, with sums turned round: the same form, and no atom more */
static void same_expressions_are_shared(void **state)
{
	int atoms = 0;
	(void)state;
	for (int n = 0; n < CASES; n++) {
		new_collector();
		struct attempt a = { .tree = draw_tree(1 + (int)draw(4)) }, again = { .tree = copied_tree(a.tree) };
		if (!silent_guard(make_form, &a))
			continue;
		int count = atoms_count(collector.atoms);
		assert_true(silent_guard(make_form, &again));
		atoms += count;
		if (!same_form(a.form, again.form) || atoms_count(collector.atoms) != count)
			fail_msg("case %d: %s made twice: %d atoms, then %d; expected one form, no atom "
				"more", n, tree_text(a.tree),
					 count, atoms_count(collector.atoms));
		if (same_form(a.form, form_sum(a.form, form_number(1), false)))
			fail_msg("case %d: %s is the same as itself plus 1", n, tree_text(a.tree));
	}
	assert_true(atoms > CASES);
}

/* Thousands in one collector, so that many fall into one bucket: powers of one sum, functions of one argument. */
static void different_expressions_are_not_shared(void **state)
{
	static const enum function functions[] = { FN_SIN,  FN_COS,  FN_EXP, FN_SINH, FN_COSH,
										   FN_TANH, FN_ATAN, FN_ABS, FN_SGN };
	enum { FUNCTIONS = sizeof functions / sizeof *functions };
	struct form *sum;
	int count = 0;
	(void)state;
	new_collector();
	sum = form_sum(state_form(0, 0), form_number(1), false);
	for (unsigned n = 2; n < 4000; n++) {
		kept_whole_power(&collector, &node, sum, n);
		if (atoms_count(collector.atoms) != ++count)
			fail_msg("power %u: %d atoms, expected %d", n, atoms_count(collector.atoms), count);
	}
	for (int k = 1; k < 1000; k++) {
		struct form *argument = form_sum(state_form(0, 0), form_number(k), false);
		for (int f = 0; f < FUNCTIONS; f++) {
			kept_call(&collector, &node, functions[f], 1, &argument);
			if (atoms_count(collector.atoms) != ++count)
				fail_msg("%s(x + %d): %d atoms, expected %d", function_name(functions[f]), k,
						 atoms_count(collector.atoms), count);
		}
		for (int comparison = CMP_LT; comparison <= CMP_GE; comparison++) {
			kept_comparison(&collector, &node, (enum comparison)comparison, argument, form_number(0));
			if (atoms_count(collector.atoms) != ++count)
				fail_msg("comparison %d of x + %d: %d atoms, expected "
					"%d", comparison, k, atoms_count(collector.atoms),
						 count);
		}
	}
}

/* a b and b a are one; so are a b c in any order, for sums that are not multiplied out into each other */
static void products_commute(void **state)
{
	(void)state;
	for (int n = 0; n < CASES; n++) {
		new_collector();
		struct form *x[3];
		for (int i = 0; i < 3; i++) {
			struct form *inner = form_sum(state_form((int)draw(2), (int)draw(2)),
					form_number((long)draw(5)), false);
			x[i] = kept_call(&collector, &node, draw(2) ? FN_SIN : FN_EXP, 1, &inner);
		}
		struct form *left = kept_product(&collector, &node, kept_product(&collector, &node, x[0], x[1]), x[2]);
		struct form *right = kept_product(&collector, &node, kept_product(&collector, &node, x[2], x[0]), x[1]);
		if (!same_form(left, right) || left->terms != 1)
			fail_msg("case %d: (a b) c and (c a) b are different products, of %d and %d "
				"terms", n, left->terms,
					 right->terms);
		const struct atom *product = left->term[0].basis.atom;
		for (int i = 0; i < product->operands; i++) {
			if (product->operands == 1 && product->exponent[0] == 1)
				continue;
			struct form *others = product->operands == 1 && product->exponent[0] == 2
				? form_sum(product->operand[0], form_number(0), false) : kept_others(&collector, &node,
						product, i);
			struct form *whole = kept_product(&collector, &node, others, product->operand[i]);
			if (!same_form(whole, left))
				fail_msg("case %d: what is left without factor %d, times that factor, is another "
					"product", n, i);
		}
	}
}

/* A factor that jumps times what is piecewise linear, as choices: the same value */
static void switched_products_keep_their_value(void **state)
{
	int switched = 0;
	(void)state;
	for (int n = 0; n < CASES; n++) {
		new_collector();
		struct tree *jump = draw(2) ? new_tree(CALL, 1) : new_tree(CHOICE, 4), *product = new_tree(PRODUCT, 2),
					*x = draw_leaf();
		jump->function = FN_SGN;
		jump->comparison = (enum comparison)draw(4);
		for (int i = 0; i < jump->children; i++)
			jump->child[i] = i < 2 ? draw_leaf() : number_tree(draw_integer(9));
		product->child[0] = jump;
		product->child[1] = draw(3) ? x : jump->child[0];
		struct form *a = form_of(product->child[0]), *b = form_of(product->child[1]);
		struct form *made = draw(2) ? kept_switched(&collector, &node, a, b) : kept_switched(&collector, &node,
				b, a);
		if (!made)
			continue;
		switched++;
		if (!is_piecewise_form(made))
			fail_msg("case %d: %s is not piecewise linear", n, tree_text(product));
		draw_point(&at);
		value_of(product, &at, expected);
		sampled(made, &at, found);
		assert_close("switched product", n, product, found, expected, -250);
	}
	print_message("# %d of %d products switched\n", switched, CASES);
	assert_true(switched > CASES / 4);
}

/* What a form depends on is what changes its value. */
static bool names_state(const struct tree *tree, int index, int order)
{
	bool named = tree->kind == STATE && (index < 0 || tree->index == index) && (order < 0 || tree->order == order);
	for (int i = 0; i < tree->children && !named; i++)
		named = names_state(tree->child[i], index, order);
	return named;
}

static bool names_kind(const struct tree *tree, bool piecewise)
{
	bool bent = tree->kind == QUOTIENT || tree->kind == RAISED || tree->kind == PRODUCT || tree->kind == POWER;
	bool call = tree->kind == CALL && tree->function != FN_ABS && tree->function != FN_SGN
			&& tree->function < FN_MIN;
	bool named = piecewise ? bent || call : tree->kind == TIME || tree->kind == WAVE;
	for (int i = 0; i < tree->children && !named; i++)
		named = names_kind(tree->child[i], piecewise);
	return named;
}

/* Does it hold such a basis, however deep? */
static bool holds(const struct atom *atom, enum basis_kind kind)
{
	for (int k = 0; k < atom->operands; k++)
		for (int i = 0; i < atom->operand[k]->terms; i++) {
			const struct basis *basis = &atom->operand[k]->term[i].basis;
			if (basis->kind == kind || (basis->atom && holds(basis->atom, kind)))
				return true;
		}
	return false;
}

static void dependence_is_of_what_is_named(void **state)
{
	(void)state;
	for (int n = 0; n < CASES; n++) {
		new_collector();
		struct attempt a = { .tree = draw_tree(1 + (int)draw(3)) };
		if (!silent_guard(make_form, &a))
			continue;
		bool moves = names_state(a.tree, -1, -1), fast = names_state(a.tree, -1, 1),
				timed = names_kind(a.tree, false);
		for (int i = 0; i < a.form->terms; i++) {
			const struct basis *basis = &a.form->term[i].basis;
			const struct atom *atom = basis->atom;
			if (atom && (atom->time != holds(atom, BASIS_FORCING)
					|| atom->state != holds(atom, BASIS_COORD)))
				fail_msg("case %d: a term of %s depends on time: %d, on a state: %d; it holds some: "
					"%d, %d", n,
						 tree_text(a.tree), atom->time, atom->state, holds(atom, BASIS_FORCING),
						 holds(atom, BASIS_COORD));
			if ((atom && atom->time && !timed) || (is_velocity(&frame, basis) && !fast) ||
				(!depends_on_time_only(basis) && !moves))
				fail_msg("case %d: a term of %s depends on what it does not "
					"name", n, tree_text(a.tree));
			if (atom && atom->state != (moved_basis(NULL, basis) != NULL))
				fail_msg("case %d: a term of %s depends on a state: %d; it has one that moves: %d", n,
						 tree_text(a.tree), atom->state, moved_basis(NULL, basis) != NULL);
		}
		if (!names_kind(a.tree, true) && !is_piecewise_form(a.form))
			fail_msg("case %d: %s is not found piecewise linear", n, tree_text(a.tree));
	}
	struct form *sine = state_form(0, 0), *square = kept_whole_power(&collector, &node, sine, 2);
	sine = kept_call(&collector, &node, FN_SIN, 1, &sine);
	assert_false(is_piecewise_form(sine));
	assert_false(is_piecewise_form(square));
	assert_false(is_stepwise(sine));
	assert_true(is_stepwise(kept_comparison(&collector, &node, CMP_LT, sine, form_number(0))));
}

/* ---- derivatives ---- */

/* Of the tree by (f(x + d) - f(x - d))/(2 d), d = 2^-80: off by some f''' d^2. False: not plain on both sides */
static bool difference_quotient(const struct tree *tree, int coord, int order, mpfr_ptr slope)
{
	enum { STEP = 80 };
	mpfr_t before;
	mpq_t kept, step;
	mpq_inits(kept, step, NULL);
	mpfr_init2(before, BITS);
	mpq_set(kept, at.state[coord][order]);
	mpq_set_ui(step, 1, 1);
	mpq_div_2exp(step, step, STEP);
	mpq_add(at.state[coord][order], kept, step);
	value_of(tree, &at, slope);
	mpq_sub(at.state[coord][order], kept, step);
	value_of(tree, &at, before);
	mpq_set(at.state[coord][order], kept);
	mpfr_sub(slope, slope, before, MPFR_RNDN);
	mpfr_mul_2ui(slope, slope, STEP - 1, MPFR_RNDN);
	mpfr_clear(before);
	mpq_clears(kept, step, NULL);
	return is_plain(slope);
}

static void derivatives_are_difference_quotients(void **state)
{
	int compared = 0, moving = 0;
	(void)state;
	for (int n = 0; n < 3 * CASES; n++) {
		new_collector();
		struct attempt a = { .tree = draw_tree(1 + (int)draw(3)), .coord = (int)draw(COORDS),
				.order = (int)draw(2) };
		if (!silent_guard(make_form, &a) || !silent_guard(make_slope, &a))
			continue;
		if (!names_state(a.tree, a.coord, a.order) && a.slope[0]->terms > 0)
			fail_msg("case %d: %s has a derivative for x%d, order %d, which it does not "
				"hold", n, tree_text(a.tree),
					 a.coord, a.order);
		draw_point(&at);
		if (!difference_quotient(a.tree, a.coord, a.order, expected))
			continue;
		sampled(a.slope[0], &at, found);
		if (mpfr_nan_p(found))                          /* 0 * log(negative) of an even power */
			continue;
		assert_close("derivative", n, a.tree, found, expected, -60);
		compared++;
		moving += mpfr_sgn(expected) != 0;
	}
	print_message("# %d of %d derivatives compared, %d not 0\n", compared, 3 * CASES, moving);
	assert_true(moving > CASES / 2);
}

/* ---- at a point ---- */

static void forms_at_a_point(void **state)
{
	int compared = 0, constant = 0;
	static struct symbol coord = { .kind = SYMBOL_COORD };
	(void)state;
	for (int n = 0; n < 2 * CASES; n++) {
		struct fixing fixing[LEAVES];
		int fixings = 0;
		bool all = draw(3) != 0;
		new_collector();
		struct attempt a = { .tree = draw_tree(1 + (int)draw(4)) };
		if (!silent_guard(make_form, &a))
			continue;
		draw_point(&at);
		value_of(a.tree, &at, expected);
		if (mpfr_nan_p(expected))
			continue;
		for (int k = 0; k < LEAVES; k++) {              /* the states, and t */
			struct fixing *f = &fixing[fixings];
			if (!all && draw(2))
				continue;
			fixings++;
			*f = (struct fixing){
				.at = node.at, .symbol = k < 2 * COORDS ? &coord : NULL, .coord = k / 2, .order = k % 2
			};
			mpq_init(f->value);
			mpq_set(f->value, k < 2 * COORDS ? at.state[k / 2][k % 2] : at.t);
			f->form = form_constant(f->value);
		}
		a.point = point_new(&collector, fixings, fixing);
		if (!silent_guard(make_placed, &a))
			continue;
		if (all && !is_constant(a.form))
			fail_msg("case %d: %s with everything fixed is no constant", n, tree_text(a.tree));
		sampled(a.form, &at, found);
		assert_close("at a point", n, a.tree, found, expected, irrational_met() ? -100 : -250);
		/* what is fixed has no say any more */
		if (all) {
			draw_point(&at);
			sampled(a.form, &at, found);
			assert_close("at another point", n, a.tree, found, expected, irrational_met() ? -100 : -250);
		}
		compared++;
		constant += all;
	}
	print_message("# %d of %d forms at a point compared, %d of them constants\n", compared, 2 * CASES, constant);
	assert_true(constant > CASES / 2 && compared > constant + CASES / 8);
}

/* ---- pi ---- */

static void assert_constant(const char *what, int n, const struct form *form, mpfr_srcptr truth)
{
	mpq_t value;
	mpfr_t off;
	mpq_init(value);
	mpfr_init2(off, BITS);
	constant_value(&collector, form, value);
	mpfr_sub_q(off, truth, value, MPFR_RNDN);
	if (!mpfr_zero_p(off) && mpfr_get_exp(off) > -250)
		fail_msg("%s, %d (pi/12, or case) is %.17g, expected %.17g", what, n, mpq_get_d(value),
				 mpfr_get_d(truth, MPFR_RNDN));
	mpq_clear(value);
	mpfr_clear(off);
}

/* sin, cos and tan of multiples of pi/12, some of which are rational */
static void functions_of_pi(void **state)
{
	static const enum function functions[] = { FN_SIN, FN_COS, FN_TAN };
	mpq_t q;
	mpfr_t x;
	(void)state;
	mpq_init(q);
	mpfr_init2(x, BITS);
	for (int n = -30; n <= 30; n++)
		for (int f = 0; f < 3; f++) {
			new_collector();
			mpq_set_si(q, n, 12);
			mpq_canonicalize(q);
			const struct form *angle = form_single((struct basis){ .kind = BASIS_PI }, q);
			mpfr_const_pi(x, MPFR_RNDN);
			mpfr_mul_q(x, x, q, MPFR_RNDN);
			assert_constant("", n, angle, x);
			if (f == 2 && n % 12 != 0 && n % 6 == 0)
				continue;               /* a pole */
			wide_value(functions[f], x);
			assert_constant(function_name(functions[f]), n,
					constant_call(&collector, &node, functions[f], angle), x);
		}
	mpq_clear(q);
	mpfr_clear(x);
}

static struct form *draw_pi(mpfr_ptr value)
{
	mpq_t one, pi;
	mpq_inits(one, pi, NULL);
	draw_fraction(one, 9, 5);
	draw_fraction(pi, 9, 5);
	mpfr_const_pi(value, MPFR_RNDN);
	mpfr_mul_q(value, value, pi, MPFR_RNDN);
	mpfr_add_q(value, value, one, MPFR_RNDN);
	struct form *form = form_sum(form_constant(one), form_single((struct basis){ .kind = BASIS_PI }, pi), false);
	mpq_clears(one, pi, NULL);
	return form;
}

static void products_with_pi(void **state)
{
	mpfr_t x, y;
	(void)state;
	mpfr_inits2(BITS, x, y, NULL);
	for (int n = 0; n < 200; n++) {
		new_collector();
		const struct form *a = draw_pi(x), *b = draw_pi(y);
		mpfr_mul(x, x, y, MPFR_RNDN);
		mpfr_div_2ui(x, x, 16, MPFR_RNDN);      /* of numbers up to 2^12 */
		mpq_t scale;
		mpq_init(scale);
		mpq_set_ui(scale, 1, 1 << 16);
		assert_constant("product", n, form_scale(form_product(&collector, a, b), scale), x);
		mpq_clear(scale);
	}
	mpfr_clears(x, y, NULL);
}

/* ---- loads ---- */

/* Of constants and waves, in double */
static double value_in_time(const struct form *form, double t)
{
	double sum = 0;
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		double value = basis->kind == BASIS_PI ? acos(-1) : 1;
		assert_true(basis->kind <= BASIS_FORCING);
		if (basis->kind == BASIS_FORCING) {
			double angle = mpq_get_d(basis->forcing->w) * t + mpq_get_d(basis->forcing->p);
			value = pow(t, basis->power) * exp(mpq_get_d(basis->forcing->a) * t);
			value *= basis->sine ? sin(angle) : cos(angle);
		}
		sum += mpq_get_d(form->term[i].factor) * value;
	}
	return sum;
}

/* t^k e^{a t} sin or cos of w t + q pi + r, as a form and its value at t */
static struct form *draw_load(double t, double *value)
{
	mpq_t a, w, q, r;
	mpq_inits(a, w, q, r, NULL);
	int power = (int)draw(3), sine = (int)draw(2);
	draw_fraction(a, 3, 4);
	draw_fraction(w, 9, 4);
	mpq_set_si(q, draw_integer(12), 1 + draw(4));
	mpq_canonicalize(q);
	if (draw(3) == 0)
		draw_fraction(r, 5, 4);
	struct form *phase = form_sum(form_single((struct basis){ .kind = BASIS_PI }, q), form_constant(r), false);
	double angle = mpq_get_d(w) * t + acos(-1) * mpq_get_d(q) + mpq_get_d(r);
	*value = pow(t, power) * exp(mpq_get_d(a) * t) * (sine ? sin(angle) : cos(angle));
	struct form *forcing = collect_forcing(&collector, sine, w, phase);
	struct form *load = load_product(&collector, plain_forcing(&collector, power, a), forcing);
	mpq_clears(a, w, q, r, NULL);
	return load;
}

static void loads_and_their_products_have_their_values(void **state)
{
	(void)state;
	for (int n = 0; n < CASES; n++) {
		new_collector();
		double t = 0.1 + 0.02 * (double)draw(100), x, y;
		struct form *a = draw_load(t, &x), *b = draw_load(t, &y), *product = load_product(&collector, a, b);
		double one = value_in_time(a, t), both = value_in_time(product, t);
		if (!(fabs(one - x) <= 1e-11 * (1 + exp(3 * t) * t * t)))
			fail_msg("case %d: a load is %.17g at t = %g, expected %.17g", n, one, t, x);
		if (!(fabs(both - x * y) <= 1e-11 * (1 + exp(6 * t) * t * t * t * t)))
			fail_msg("case %d: a product of loads is %.17g at t = %g, expected %.17g", n, both, t, x * y);
	}
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(forms_have_the_values_of_their_trees),
		cmocka_unit_test(constants_are_folded),
		cmocka_unit_test(same_expressions_are_shared),
		cmocka_unit_test(different_expressions_are_not_shared),
		cmocka_unit_test(products_commute),
		cmocka_unit_test(switched_products_keep_their_value),
		cmocka_unit_test(dependence_is_of_what_is_named),
		cmocka_unit_test(derivatives_are_difference_quotients),
		cmocka_unit_test(forms_at_a_point),
		cmocka_unit_test(functions_of_pi),
		cmocka_unit_test(products_with_pi),
		cmocka_unit_test(loads_and_their_products_have_their_values),
	};
	choose_cases(argc, argv);
	memory_open();
	at_init(&at);
	mpfr_inits2(BITS, found, expected, NULL);
	const int status = cmocka_run_group_tests(tests, NULL, NULL);
	mpfr_clears(found, expected, NULL);
	memory_close();
	return status;
}
