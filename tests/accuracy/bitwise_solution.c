/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The closed-form solution, across changes of formula in time too. */
#include "bitwise.h"

/* ---- the closed-form solution ---- */

/* x = states, loads, 1, t, outputs: an output o = c x, c constant, has o' = c A x */
struct solution {
	size_t size, outputs;               /* the outputs come last */
	mpq_t *A, *start;
};

/* exp, cos or sin of q as the generator takes it: to 256 bits, from a number of so many that it need not be looked at
 * twice */
static void set_function(mpq_ptr value, mpq_srcptr q, int (*function)(mpfr_t, const mpfr_t, mpfr_rnd_t))
{
	mpfr_t wide, rounded;
	mpfr_init2(wide, 4096);
	mpfr_init2(rounded, IRRATIONAL_BITS);
	mpfr_set_q(wide, q, MPFR_RNDN);
	function(wide, wide, MPFR_RNDN);
	mpfr_set(rounded, wide, MPFR_RNDN);
	mpfr_get_q(value, rounded);
	mpfr_clears(wide, rounded, (mpfr_ptr)NULL);
}

/* The load states at time t as the generator takes them: functions to 256 bits, powers exact */
static void set_load_states(const struct linear *system, mpq_srcptr t, mpq_t *z)
{
	mpq_t angle;
	mpq_init(angle);
	for (size_t at = 0, l = 0; l < (size_t)system->loads; at += (size_t)system->load[l++].columns) {
		const struct forcing *forcing = system->load[l].forcing;
		const size_t trig = mpq_sgn(forcing->w) != 0 ? 2 : 1;
		for (size_t c = 0; c < (size_t)system->load[l].columns; c++) {
			mpq_mul(angle, forcing->a, t);
			set_function(z[at + c], angle, mpfr_exp);
			for (size_t k = 0; k < c / trig; k++)
				mpq_mul(z[at + c], z[at + c], t);
			if (trig == 1)
				continue;
			mpq_mul(angle, forcing->w, t);
			mpq_add(angle, angle, forcing->p);
			set_function(angle, angle, c % 2 ? mpfr_sin : mpfr_cos);
			mpq_mul(z[at + c], z[at + c], angle);
		}
	}
	mpq_clear(angle);
}

static mpq_t *output_row(const struct model *model, const struct augmented *a, int segment, const struct output *output)
{
	mpq_t *row = rationals(a->size);
	for (size_t i = 0; i < a->states; i++)
		mpq_set(row[i], output->state[i]);
	for (size_t at = a->first_load, l = 0; l < (size_t)model->system.loads; l++)
		for (int k = 0; k < model->system.load[l].columns; k++, at++)
			mpq_set(row[at], output->load[l][k * model->system.segments + segment]);
	return row;
}

/* In one segment of time; `segment` is that which holds t = 0. */
static struct solution solution_of(const struct model *model, const struct augmented *a, int segment)
{
	const size_t first = a->size, outputs = (size_t)model->outputs, size = first + outputs;
	struct solution s = { size, outputs, rationals(size * size), rationals(size) };
	mpq_t zero;
	mpq_init(zero);
	for (size_t i = 0; i < a->size; i++)
		for (size_t j = 0; j < a->size; j++)
			mpq_set(s.A[i * size + j], a->A[i * a->size + j]);
	for (size_t i = 0; i < a->states; i++)
		mpq_set(s.start[i], model->initial[i]);
	set_load_states(&model->system, zero, s.start + a->first_load);
	for (size_t o = 0; o < outputs; o++) {
		const mpq_t *factors = (const mpq_t *)output_row(model, a, segment, &model->output[o]);
		for (size_t i = 0; i < first; i++) {
			add_product(s.start[first + o], factors[i], s.start[i], false);
			for (size_t j = 0; j < first; j++)
				add_product(s.A[(first + o) * size + j], factors[i], s.A[i * size + j], false);
		}
	}
	mpq_clear(zero);
	return s;
}

static int first_segment(const struct linear *system)
{
	int first = 0;
	while (first < system->segments - 1 && mpq_sgn(system->change[first]) <= 0)
		first++;
	return first;
}

struct solution_work {
	const struct model *model;
	const struct solution *solution;
	double *expected;
};

/* False: the judge cannot decide.  That is no failure where another value is out of range: e^{1e5} beside 1 is beyond
 * its 16384 bits. */
static bool expected_outputs(const struct solution *s, mpq_srcptr t, double *expected)
{
	const int undecided = evaluator_apply(s->size, (const mpq_t *)s->A, t, (const mpq_t *)s->start, expected);
	bool overflow = false;
	for (size_t i = 0; i < s->size; i++)
		overflow = overflow || isinf(expected[i]);
	if (undecided && !overflow)
		complain("solution", "the judge cannot decide");
	trial.beyond += undecided && overflow;
	return !undecided;
}

static void compare_solution_values(void *context)
{
	static const unsigned long multiples[] = { 0, 1, 17, 3000 };
	struct solution_work *work = context;
	const struct model *model = work->model;
	const size_t first = work->solution->size - work->solution->outputs;
	struct resolvent *resolvent = resolvent_of(&model->system);
	mpq_t t;
	mpq_init(t);
	for (int k = 0; k < 4; k++) {
		mpq_set_ui(t, multiples[k], 1);
		mpq_mul(t, t, model->h);
		trial.time = format("%lu h", multiples[k]);
		if (!expected_outputs(work->solution, t, work->expected))
			continue;
		for (int o = 0; o < model->outputs; o++) {
			struct started *list;
			const int count =
				responses_of_output(resolvent, &model->system, (const mpq_t *)model->initial,
						&model->output[o], &list);
			const struct coefficient c = started_value(count, list, t, false, model->request.at.step,
											   model->output[o].name);
			compare(model->output[o].name, c.value, work->expected[first + (size_t)o]);
		}
	}
	mpq_clear(t);
}

enum { TEXT_ROWS = 4 };

/* The text of --solution at 0, h, 2 h, 3 h */
static void compare_solution_text(void *context)
{
	struct solution_work *work = context;
	const struct model *model = work->model;
	const size_t first = work->solution->size - work->solution->outputs;
	char *text = NULL, *at;
	size_t length;
	mpq_t t;
	mpq_init(t);
	mpq_set_ui(t, TEXT_ROWS - 1, 1);
	mpq_mul(t, t, model->h);
	FILE *to = open_memstream(&text, &length);
	print_solution(to, model, resolvent_of(&model->system), t);
	fclose(to);
	at = text + strcspn(text, "\n");
	for (unsigned long k = 0; k < TEXT_ROWS; k++) {
		mpq_set_ui(t, k, 1);
		mpq_mul(t, t, model->h);
		trial.time = format("row %lu of the text", k);
		if (!expected_outputs(work->solution, t, work->expected))
			return;
		strtod(at, &at);
		for (int o = 0; o < model->outputs; o++) {
			if (*at != ',')
				complain(model->output[o].name, "not in the text");
			else
				compare(model->output[o].name, strtod(at + 1, &at), work->expected[first + (size_t)o]);
		}
	}
	if (strcmp(at, "\n") != 0)
		complain("text", "more than the rows asked for");
	free(text);
	mpq_clear(t);
}

/* Refused as a whole is right if a value in it is out of range, and if that is what was said. */
static void compare_solution_refusal(const struct solution_work *work)
{
	const char *said = diagnostics();
	bool overflow = false;
	mpq_t t;
	mpq_init(t);
	for (unsigned long k = 0; k < TEXT_ROWS && !overflow; k++) {
		mpq_set_ui(t, k, 1);
		mpq_mul(t, t, work->model->h);
		if (!expected_outputs(work->solution, t, work->expected))
			return;
		for (size_t o = 0; o < work->solution->outputs; o++)
			overflow = overflow || isinf(work->expected[work->solution->size - 1 - o]);
	}
	trial.compared++;
	if (!overflow || !strstr(said, "leaves the range of double"))
		complain("solution refused", first_line(said));
	mpq_clear(t);
}

/* ---- the same across changes of formula in time ---- */

enum { MIDPOINT_BITS = 1500 };

/* target (prec MIDPOINT_BITS) += a b */
static void add_real(mpfr_ptr target, mpfr_srcptr a, mpq_srcptr b)
{
	mpfr_t product;
	mpfr_init2(product, MIDPOINT_BITS);
	mpfr_mul_q(product, a, b, MPFR_RNDN);
	mpfr_add(target, target, product, MPFR_RNDN);
	mpfr_clear(product);
}

/* y <- e^{A tau} y */
static mpfr_t *advance(const struct augmented *a, mpq_srcptr tau, const mpfr_t *y)
{
	const size_t n = a->size;
	mpfr_t *E = reals(n * n, MIDPOINT_BITS), *next = reals(n, MIDPOINT_BITS), product;
	if (evaluator_midpoints(n, (const mpq_t *)a->A, tau, MIDPOINT_BITS, E) != 0)
		return NULL;
	mpfr_init2(product, MIDPOINT_BITS);
	for (size_t i = 0; i < n; i++)
		for (size_t j = 0; j < n; j++) {
			mpfr_mul(product, E[i * n + j], y[j], MPFR_RNDN);
			mpfr_add(next[i], next[i], product, MPFR_RNDN);
		}
	mpfr_clear(product);
	return next;
}

/* All states at t, driven from change to change; the loads are states that run on.  Phases are 256-bit numbers at t = 0
 * here and at the changes there: the two differ by about 2^-256 of what they are summed from.  `segment` becomes that
 * of t. */
static mpfr_t *driven(const struct model *model, mpq_srcptr t, int *segment)
{
	const struct linear *system = &model->system;
	const int first = first_segment(system);
	mpq_t now, tau;
	mpq_inits(now, tau, NULL);
	struct augmented a = augment(system, first, false, model->h);
	mpfr_t *y = reals(a.size, MIDPOINT_BITS);
	mpq_t *z = rationals(a.loads);
	set_load_states(system, now, z);
	for (size_t i = 0; i < a.states; i++)
		mpfr_set_q(y[i], model->initial[i], MPFR_RNDN);
	for (size_t i = 0; i < a.loads; i++)
		mpfr_set_q(y[a.first_load + i], z[i], MPFR_RNDN);
	for (*segment = first; *segment < system->segments - 1
			&& mpq_cmp(system->change[*segment], t) <= 0; ++*segment) {
		a = augment(system, *segment, false, model->h);
		mpq_sub(tau, system->change[*segment], now);
		mpq_set(now, system->change[*segment]);
		if (!(y = advance(&a, tau, (const mpfr_t *)y)))
			return NULL;
	}
	a = augment(system, *segment, false, model->h);
	mpq_sub(tau, t, now);
	return advance(&a, tau, (const mpfr_t *)y);
}

/* |found - sum| is to be half a unit in the last place, or 2^-200 of the largest term. */
static void compare_driven(const struct model *model, const struct augmented *a, int segment,
						   const struct output *output, const mpfr_t *y, double found)
{
	const mpq_t *row = (const mpq_t *)output_row(model, a, segment, output);
	mpfr_t sum, size, error;
	mpfr_inits2(MIDPOINT_BITS, sum, size, error, (mpfr_ptr)NULL);
	mpfr_set_zero(sum, 1);
	mpfr_set_zero(size, 1);
	for (size_t i = 0; i < a->size; i++) {
		add_real(sum, y[i], row[i]);
		mpfr_mul_q(error, y[i], row[i], MPFR_RNDN);
		mpfr_abs(error, error, MPFR_RNDN);
		mpfr_max(size, size, error, MPFR_RNDN);
		mpfr_abs(error, y[i], MPFR_RNDN);
		mpfr_max(size, size, error, MPFR_RNDN);
	}
	trial.compared++;
	const double expected = mpfr_get_d(sum, MPFR_RNDN);
	if (expected != found) {            /* it may have lain next to a tie, or near 0 */
		mpfr_sub_d(error, sum, found, MPFR_RNDN);
		mpfr_abs(error, error, MPFR_RNDN);
		mpfr_mul_2si(size, size, -200, MPFR_RNDN);
		const double spacing = nextafter(fabs(found), HUGE_VAL) - fabs(found);
		mpfr_sub_d(error, error, found == 0 ? 0 : spacing / 2, MPFR_RNDN);
		if (!(mpfr_cmp(error, size) <= 0))
			complain(output->name,
					 format("found %a = %.17g, expected %a = %.17g "
						"(driven)", found, found, expected, expected));
	}
	mpfr_clears(sum, size, error, (mpfr_ptr)NULL);
}

static void compare_changes(void *context)
{
	static const unsigned long multiples[] = { 0, 1, 17, 60, 101, 3000 };
	const struct model *model = ((struct solution_work *)context)->model;
	const struct augmented a = augment(&model->system, 0, false, model->h);
	struct resolvent *resolvent = resolvent_of(&model->system);
	mpq_t t;
	mpq_init(t);
	for (size_t k = 0; k < sizeof multiples / sizeof *multiples; k++) {
		int segment;
		mpq_set_ui(t, multiples[k], 1);
		mpq_mul(t, t, model->h);
		trial.time = format("%lu h", multiples[k]);
		const mpfr_t *y = (const mpfr_t *)driven(model, t, &segment);
		if (!y) {
			trial.beyond++;
			continue;
		}
		for (int o = 0; o < model->outputs; o++) {
			struct started *list;
			const int count =
				responses_of_output(resolvent, &model->system, (const mpq_t *)model->initial,
						&model->output[o], &list);
			const struct coefficient c = started_value(count, list, t, false, model->request.at.step,
											   model->output[o].name);
			compare_driven(model, &a, segment, &model->output[o], y, c.value);
		}
	}
	mpq_clear(t);
}

void compare_solution(struct model *model, mpq_srcptr written_step)
{
	mpq_set(model->h, written_step);
	const int first = first_segment(&model->system);
	const struct augmented a = augment(&model->system, first, false, model->h);
	const struct solution s = solution_of(model, &a, first);
	struct solution_work work = { model, &s, ARRAY(double, s.size) };
	trial.scheme = "exact (solution)";
	if (model->system.segments > 1) {
		if (!statement_guard(compare_changes, &work))
			complain("solution", first_line(diagnostics()));
		return;
	}
	if (!statement_guard(compare_solution_values, &work))
		complain("solution", first_line(diagnostics()));
	else if (model->system.inputs)
		return;                         /* --solution does not know their samples */
	else if (!statement_guard(compare_solution_text, &work))
		compare_solution_refusal(&work);
}
