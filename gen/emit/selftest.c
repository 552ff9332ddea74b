/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_selftest: states in closed form, for the target to step to. A wrong constant anywhere in the step, in NAME_jump or in NAME_at
 * shows as a deviation. Inputs follow u = 1 - t/h, which every factor of a sample has a part in; held, u = 1. */
#include "emit/emit.h"

#include <math.h>

static const unsigned long steps[] = { 1, 2, 3, 5, 10, 20, 50, 100 };
enum { ROWS = sizeof steps / sizeof steps[0] };

/* The state itself as an output */
static struct output state_output(const struct linear *system, int state)
{
	struct output output = { .state = rationals((size_t)system->states) };
	output.load = ARRAY(mpq_t *, (size_t)system->loads);
	for (int l = 0; l < system->loads; l++)
		output.load[l] = rationals((size_t)system->load[l].columns * (size_t)system->segments);
	mpq_set_ui(output.state[state], 1, 1);
	return output;
}

/* 1, -3/4, 5/8, -9/16, ...: no two alike, none of them rounded */
static void start_value(int state, mpq_ptr value)
{
	int power = state < 20 ? state : 20;
	mpq_set_ui(value, (1ul << power) + 1, 1ul << power);
	mpq_div_2exp(value, value, 1);
	if (state % 2)
		mpq_neg(value, value);
}

struct closed_form {                /* of one state */
	int count;
	struct started *list;
};

static struct closed_form closed_form_of(const struct step *step, int state, const mpq_t *start)
{
	const struct linear *system = &step->branch->system;
	struct output output = state_output(system, state);
	struct closed_form form;
	form.count = responses_of_output(step->branch->resolvent, system, start, &output, &form.list);
	ENLARGE(form.list, (size_t)form.count + (size_t)system->inputs);
	for (int i = 0; i < system->inputs; i++) {
		form.list[form.count].response = response_of_input(step->branch->resolvent, system, state, i, 0, step->model->h);
		mpq_init(form.list[form.count++].start);
	}
	return form;
}

static double ulp_of(double value, bool single)
{
	int exponent;
	frexp(value, &exponent);
	return ldexp(1, exponent - (single ? 24 : 53));
}

struct reference {
	int states, rows;
	double *start, *value;      /* [states]; [row][states] */
	double *between;            /* at h/2, or NULL */
	double *unit;               /* [states]: one in the last place of the largest value */
};

static bool fill_row(const struct step *step, const struct closed_form *form, mpq_srcptr t, double *row)
{
	bool finite = true;
	for (int i = 0; i < step->branch->system.states; i++) {
		row[i] = started_value(form[i].count, form[i].list, t, step->model->asked.step_at, "a value of the self-test").value;
		finite = finite && isfinite(row[i]);
	}
	return finite;
}

static void fill_reference(const struct step *step, struct reference *r)
{
	int n = step->branch->system.states;
	mpq_t *start = rationals((size_t)n), t;
	struct closed_form *form = ARRAY(struct closed_form, (size_t)n);
	mpq_init(t);
	for (int i = 0; i < n; i++) {
		start_value(i, start[i]);
		r->start[i] = round_rational(start[i]);
	}
	for (int i = 0; i < n; i++)
		form[i] = closed_form_of(step, i, (const mpq_t *)start);
	for (r->rows = 0; r->rows < ROWS; r->rows++) {
		mpq_set_ui(t, steps[r->rows], 1);
		mpq_mul(t, t, step->model->h);
		if (!fill_row(step, form, t, r->value + r->rows * n))
			break;                  /* what grows leaves the range: shorter */
	}
	mpq_div_2exp(t, step->model->h, 1);
	if (step->series.emitted)
		fill_row(step, form, t, r->between);
	for (int i = 0; i < n; i++) {
		double largest = fabs(r->start[i]);
		for (int k = 0; k < r->rows; k++)
			largest = fmax(largest, fabs(r->value[k * n + i]));
		r->unit[i] = ulp_of(largest, step->model->asked.single);
	}
	mpq_clear(t);
}

static void print_row(const struct emitter *e, const double *value)
{
	for (int i = 0; i < e->system->states; i++)
		fprintf(e->to, "%s%s", i ? ", " : "", shortest(value[i]));
}

static void emit_sample(const struct emitter *e, const char *indent, const char *ramp)
{
	for (int i = 0; i < e->system->inputs; i++)
		fprintf(e->to, "%su[%d] = %s;\n", indent, i, e->system->input[i].first_order ? ramp : "1.0");
}

static void emit_begin(const struct emitter *e)
{
	if (e->model->tuning)
		fprintf(e->to, "    s.coeffs = %s_nominal;\n", e->name);
	fprintf(e->to, "    %s_set(&s, 0.0, start);\n", e->name);
	if (e->ramps) {
		emit_sample(e, "    ", "1.0");
		fprintf(e->to, "    %s_hold(&s, u);\n", e->name);
	}
}

static void emit_replay(const struct emitter *e, const struct reference *r)
{
	FILE *to = e->to;
	const char *n = e->name;
	fprintf(to, "    for (i = 0; i < %d; i++) {\n        for (; k < reference[i].steps; k++) {\n", r->rows);
	emit_sample(e, "            ", "-(double)k");
	fprintf(to, "            %s_step(&s%s);\n        }\n", n, e->system->inputs ? ", u" : "");
	fprintf(to, "        %s_get(&s, y);\n        worst = %s_deviation(y, reference[i].y, worst);\n    }\n", n, n);
}

void emit_selftest(const struct emitter *e, bool jumps)
{
	FILE *to = e->to;
	const char *n = e->name, *N = e->upper;
	size_t states = (size_t)e->system->states;
	struct reference r = { 0 };
	r.start = ARRAY(double, states);
	r.value = ARRAY(double, states * ROWS);
	r.between = ARRAY(double, states);
	r.unit = ARRAY(double, states);
	fill_reference(e->step->shown, &r);
	fprintf(to, "\n/* The largest of worst and |y - reference|, in units in the last place of the largest value that each state takes */\n");
	fprintf(to, "static double %s_deviation(const double *y, const double *reference, double worst)\n{\n", n);
	fprintf(to, "    static const double unit[%s_STATES] = {", N);
	print_row(e, r.unit);
	fprintf(to, "};\n    int i;\n    for (i = 0; i < %s_STATES && worst == worst; i++) {\n", N);
	fputs("        const double off = (y[i] < reference[i] ? reference[i] - y[i] : y[i] - reference[i]) / unit[i];\n", to);
	fputs("        if (!(off <= worst))\n            worst = off;  /* not a number, too: and it stays */\n    }\n    return worst;\n}\n", to);
	fprintf(to, "\ndouble %s_selftest(void)\n{\n    static const double start[%s_STATES] = {", n, N);
	print_row(e, r.start);
	fprintf(to, "};\n    static const struct {\n        uint64_t steps;\n        double y[%s_STATES];\n    } reference[%d] = {  /* in closed form */\n", N, r.rows);
	for (int k = 0; k < r.rows; k++) {
		fprintf(to, "        {%lu, {", steps[k]);
		print_row(e, r.value + k * e->system->states);
		fputs("}},\n", to);
	}
	fputs("    };\n", to);
	if (e->step->series.emitted) {
		fprintf(to, "    static const double between[%s_STATES] = {", N);
		print_row(e, r.between);
		fputs("};  /* at h/2 */\n", to);
	}
	fprintf(to, "    %s s;\n    double y[%s_STATES], worst = 0.0;\n    uint64_t k = 0;\n    int i;\n", n, N);
	if (e->system->inputs)
		fprintf(to, "    double u[%s_INPUTS];\n", N);
	emit_begin(e);
	emit_replay(e, &r);
	if (jumps)
		fprintf(to, "    %s_set(&s, 0.0, start);\n    %s_jump(&s, %lu);\n    %s_get(&s, y);\n    worst = %s_deviation(y, reference[%d].y, worst);\n", n, n,
			steps[r.rows - 1], n, n, r.rows - 1);
	if (e->step->series.emitted) {
		emit_begin(e);
		emit_sample(e, "    ", "0.0");
		fprintf(to, "    %s_at(&s%s, 0.5 * %s_H, y);\n    worst = %s_deviation(y, between, worst);\n", n, e->system->inputs ? ", u" : "", N, n);
	}
	fputs("    return worst;\n}\n", to);
}
