/* SPDX-License-Identifier: GPL-3.0-or-later */
/* enclosed MODEL.spec ...: what is known of piecewise-linear motions, with friction and impacts too, in 192 bits holds
 * what is known in twice as many from starts at the ends of its own, and is no wider than the motion makes it: widths
 * that double at each event would be some 2^200 at the end. And the first model, bilinear, against its closed form over
 * thousands of periods. */
#include "model/regions/regions.h"
#include "step/certify/certify.h"
#include "step/certify/inner.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

enum { BITS = 192, MORE_BITS = 2 * BITS, TIMES = 20, START = 150 };

static int models;
static char **model;

static struct model *model_in(const char *name)
{
	static const struct request request = { .prefix = "m" };
	const struct source *source = source_read(name, (struct place){ 0 });
	struct model *found = source ? model_build(parse_spec(source), &request) : NULL;
	diagnostics_print(stderr);
	assert_non_null(found);
	return found;
}

static void check_states(const char *name, const struct trajectory *few, const struct trajectory *many, int states,
			 double time)
{
	INTERVAL wide = OVER_BITS(BITS);
	INTERVAL narrow = OVER_BITS(BITS);
	REAL width = WITH_BITS(53);
	for (int i = 0; i < states; i++) {
		trajectory_state(few, i, wide);
		trajectory_state(many, i, narrow);
		const double off = mpfi_get_d(wide) - mpfi_get_d(narrow);
		mpfi_diam_abs(width, wide);
		const double most = mpfr_get_d(width, MPFR_RNDU);
		if (!mpfi_is_inside(narrow, wide) || !(most < 0x1p-100))
			fail_msg("%s: at t = %g s state %d is known to %g, the other is %g off", name, time, i, most,
				 off);
	}
}

/* Values at the start are known to 2^-START. */
static struct trajectory *wide_start(const struct model *of)
{
	struct trajectory *t = trajectory_start(of, NULL, of->initial, BITS);
	REAL off = WITH_BITS(2);
	mpfr_set_ui_2exp(off, 1, -START, MPFR_RNDN);
	for (int i = 0; i < of->system.states; i++)
		if (mpq_sgn(of->initial[i]) != 0)
			trajectory_widen(t, i, off);
	return t;
}

/* From one of their ends each */
static struct trajectory *end_start(const struct model *of, int ends)
{
	RATIONALS *initial = rationals((size_t)of->system.states);
	RATIONAL off = ZERO;
	mpq_set_ui(off, 1, 1);
	mpq_div_2exp(off, off, START);
	for (int i = 0; i < of->system.states; i++) {
		mpq_set(initial[i], of->initial[i]);
		if (mpq_sgn(initial[i]) != 0)
			(ends >> i & 1 ? mpq_add : mpq_sub)(initial[i], initial[i], off);
	}
	return trajectory_start(of, NULL, initial, MORE_BITS);
}

static void holds_more_digits(void **state)
{
	(void)state;
	for (int m = 0; m < models; m++) {
		const struct model *of = model_in(model[m]);
		struct trajectory *few = wide_start(of), *many = end_start(of, m);
		RATIONAL time = ZERO, between = ZERO;
		mpq_set_ui(between, 7, 3);
		for (int k = 1; k <= TIMES; k++) {
			mpq_add(time, time, between);
			if (!trajectory_reach(few, time) || !trajectory_reach(many, time))
				fail_msg("%s: %s", model[m], trajectory_undecided(few));
			check_states(model[m], few, many, of->system.states, mpq_get_d(time));
		}
		const struct passed *list;
		if (trajectory_passed(few, &list) < TIMES)
			fail_msg("%s: only %d events", model[m], trajectory_passed(few, &list));
		trajectory_free(few);
		trajectory_free(many);
	}
}

/* x = sin(5 t)/5 from x = 0 on, then -sin(2 t)/2, and its speed at 0 stays 1 */
static void is_the_closed_form(void **state)
{
	(void)state;
	const double pi = acos(-1), period = pi / 5 + pi / 2;
	const struct model *of = model_in(model[0]);
	struct trajectory *way = trajectory_start(of, NULL, of->initial, BITS);
	INTERVAL x = OVER_BITS(BITS);
	RATIONAL time = ZERO, between = ZERO;
	mpq_set_ui(between, 401, 10);
	for (int k = 1; k <= 50; k++) {
		mpq_add(time, time, between);
		if (!trajectory_reach(way, time))
			fail_msg("%s", trajectory_undecided(way));
		trajectory_state(way, 0, x);
		const double after = fmod(mpq_get_d(time), period);
		const double closed = after < pi / 5 ? sin(5 * after) / 5 : -sin(2 * (after - pi / 5)) / 2;
		if (fabs(mpfi_get_d(x) - closed) > 3e-12)
			fail_msg("t = %g s: %.17g, in closed form %.17g", mpq_get_d(time), mpfi_get_d(x), closed);
	}
	trajectory_free(way);
}

int main(int argc, char **argv)
{
	models = argc - 1;
	model = argv + 1;
	memory_open();
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(holds_more_digits),
		cmocka_unit_test(is_the_closed_form),
	};
	int failed = cmocka_run_group_tests(tests, NULL, NULL);
	memory_close();
	return failed;
}
