/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models with tunable params: an instance holds its own coefficients, and NAME_retune computes them anew on the
 * target. */
#include "emit/emit.h"

#include <string.h>

/* Columns of a step's factors: states, load states in each segment of time, inputs */
static int step_columns(const struct emitter *e)
{
	return e->model->tuning->x.size;
}

static int tuned_outputs(const struct emitter *e)
{
	return e->model->tuning->outputs;
}

/* Names of the columns as a comment says them: the load states once, lines broken */
static const char *column_list(const struct emitter *e)
{
	enum { WIDTH = 110 };
	const char **name = layout_names(&e->model->tuning->x, e->system, e->model), *list = "", *line = "";
	int states = e->system->states, loads = e->model->tuning->x.loads, segments = e->system->segments;
	for (int i = 0; i < step_columns(e); i++) {
		if (i >= states + loads && i < states + segments * loads)
			continue;
		bool several = segments > 1 && loads, last = several && i == states + loads - 1;
		const char *end = last ? format(") in each of %d segments of time", segments) : "";
		const char *text = format("%s%s%s", several && i == states ? "(" : "", name[i], end);
		bool wide = strlen(line) + strlen(text) > WIDTH;
		list = format("%s%s%s%s", list, i ? "," : "", wide ? "\n *     " : i ? " " : "", text);
		line = wide ? text : format("%s, %s", line, text);
	}
	return list;
}

/* ---- the header ---- */

void banner_tuning(const struct emitter *e)
{
	say(e, " * Tunable: %s. $n_retune computes the factors of a step from other values and another h on the target;"
	       " of the spec's\n"
	       " * values they are these, correctly rounded. It needs some %d KB of stack.\n", param_list(e),
	    workspace_of(e->step).kilobytes);
}

/* A member, its comment at a common column */
void coefficient_member(const struct emitter *e, const char *text, const char *comment)
{
	if (*comment)
		say(e, "    %-38s /* %s */\n", text, comment);
	else
		say(e, "    %s\n", text);
}

static const char *ramp_note(const struct emitter *e, const char *what)
{
	return e->ramps ? format("; of a ramp %s", what) : "";
}

/* Of the loads, in one step */
static void load_members(const struct emitter *e)
{
	if (e->phases)
		coefficient_member(e, format("pl_turn phase_step[%d];", e->phases), "of the loads, in one step");
	if (e->model->tuning->frequencies)
		coefficient_member(e, format("pl_rate phase_rate[%d];", e->phases), "in turns per second");
	if (e->growths)
		coefficient_member(e, format("pl_growth growth_step[%d];", e->growths),
		       e->phases ? "" : "of the loads, in one step");
}

static void emit_step_member(const struct emitter *e)
{
	coefficient_member(e, format("double step[%s_STATES][%d];", e->upper, step_columns(e)),
			   e->step->form == FORM_DELTA ? "y += step z" : "y = step z");
}

void emit_coefficients_with(const struct emitter *e, void (*factors)(const struct emitter *e))
{
	say(e, "enum { $N_PARAMS = %d };  /* tunable: %s */\n"
	       "typedef struct $n_coeffs $n_coeffs;"
	       "  /* what a step multiplies with, at one set of params and one h */\n"
	       "/* z = %s%s */\n"
	       "struct $n_coeffs {\n", e->model->tuning->params, param_list(e), column_list(e),
	    ramp_note(e, "its value before the step, then after it"));
	coefficient_member(e, "double h;", "[s]");
	if (e->system->segments > 1)
		coefficient_member(e, "double h_low;", "of the spec's step: what h leaves out; else 0");
	coefficient_member(e, format("double params[%s_PARAMS];", e->upper), param_list(e));
	factors(e);
	if (tuned_outputs(e))
		coefficient_member(e, format("double out[%d][%d];", tuned_outputs(e), step_columns(e)),
		       format("out z, where outputs depend on params%s", ramp_note(e, "its value and its slope")));
	emit_peak_coefficients(e);
	load_members(e);
	say(e, "};\n\n");
}

void emit_coefficient_struct(const struct emitter *e)
{
	emit_coefficients_with(e, emit_step_member);
}

void emit_tuning_functions(const struct emitter *e, bool one)
{
	say(e, "\n/* Computes c anew from params (%s) and h [s]%s. 0, or c is as it was and\n"
	       " *     PL_NO_STEP     h is not %s\n"
	       " *     PL_SINGULAR    the mass matrix has no inverse, or a divisor is 0\n", param_list(e),
	    one ? ", the spec's" : "", one ? spell(e, "$N_H") : "above 0");
	if (e->model->tuning->frequencies)
		say(e, " *     PL_NO_RATE     a frequency of a load is below 0\n");
	say(e, " *     PL_NOT_FINITE  a number of it is infinite, or not a number\n"
	       " * c may be that of an instance as long as h stays. */\n"
	       "int    $n_retune($n_coeffs *c, const double params[$N_PARAMS], double h);\n"
	       "\n"
	       "/* From now on with c. State and time stay%s. */\n"
	       "void   $n_use($n *s, const $n_coeffs *c);\n"
	       "\n"
	       "/* Of the spec's values, correctly rounded: what $n_init starts with */\n"
	       "extern const $n_coeffs $n_nominal;\n"
	       "\n", e->phases ? "; phases of loads go on from where they are" : "");
}

void emit_tuning_declarations(const struct emitter *e)
{
	emit_tuning_functions(e, false);
}

/* ---- the generator's own coefficients ---- */

static void emit_nominal_outputs(const struct emitter *e)
{
	const char **name = ARRAY(const char *, (size_t)tuned_outputs(e));
	for (int o = 0; o < e->model->outputs; o++)
		if (e->model->tuning->output[o] >= 0)
			name[e->model->tuning->output[o] - e->model->n] = e->model->output[o].name;
	say(e, "    {\n");
	emit_number_rows(e, tuned_outputs(e), step_columns(e), nominal_outputs(e->step), name);
	say(e, "    },\n");
}

/* What of each load moves on in a step: its phase, or its growth */
static void emit_nominal_loads(const struct emitter *e, const int *index,
			       const char *(*step_text)(const struct emitter *, int))
{
	say(e, "    {\n");
	for (int l = 0; l < e->system->loads; l++)
		if (index[l] >= 0)
			say(e, "    %s,  /* %s */\n", step_text(e, l), column_text(&e->system->load[l], 0));
	say(e, "    },\n");
}

static void emit_nominal_step(const struct emitter *e)
{
	say(e, "    {\n");
	emit_number_rows(e, e->system->states, step_columns(e), nominal_step(e->step), e->model->state_name);
	say(e, "    },\n");
}

void emit_nominal_with(const struct emitter *e, void (*factors)(const struct emitter *e))
{
	say(e, "\nconst $n_coeffs $n_nominal = {\n"
	       "    $N_H,\n"
	       "    ");
	if (e->system->segments > 1)
		say(e, "%s,\n"
		       "    ", low_text(e->model->h));
	emit_nominal_params(e);
	factors(e);
	if (tuned_outputs(e))
		emit_nominal_outputs(e);
	emit_nominal_peaks(e);
	if (e->phases)
		emit_nominal_loads(e, e->phase, phase_step_text);
	if (e->phases && e->model->tuning->frequencies) {
		say(e, "    {\n");
		emit_phase_rates(e);
		say(e, "    },\n");
	}
	if (e->growths)
		emit_nominal_loads(e, e->growth, growth_step_text);
	say(e, "};\n");
}

void emit_nominal(const struct emitter *e)
{
	emit_nominal_with(e, emit_nominal_step);
}

/* ---- the equations on the target ---- */

static const char *monomial_text(const struct tuning *t, int number)
{
	if (number == 0)
		return "1";
	const struct tuned_monomial *m = &t->monomial[number - 1];
	const char *param = t->param[m->param].symbol->name, *from = monomial_text(t, m->from);
	return m->from == 0 && !m->divides ? param : format("%s%s%s", from, m->divides ? "/" : "*", param);
}

void emit_monomials(const struct emitter *e, const struct tuning *t, const char *suffix)
{
	if (t->monomials == 0)
		return;
	say(e, "\nstatic const pl_monomial $n_monomial%s[%d] = {\n", suffix, t->monomials);
	for (int m = 0; m < t->monomials; m++) {
		const struct tuned_monomial *made = &t->monomial[m];
		const char *text = monomial_text(t, m + 1);
		say(e, "    {%d, %d, %d},  /* %s */\n", made->from, made->param, made->divides, text);
	}
	say(e, "};\n");
}

/* What a row of the equations gives, and what a column of them multiplies */
static const char *row_name(const struct emitter *e, int row)
{
	for (int o = 0; o < e->model->outputs; o++)
		if (e->model->tuning->output[o] == row)
			return e->model->output[o].name;
	for (int l = 0; l < e->system->loads; l++)
		if (e->model->tuning->frequency[l] == row)
			return format("frequency of %s", column_text(&e->system->load[l], 0));
	return format("%s%.*s", e->model->coord_name[row], e->system->velocity[row] >= 0 ? 2 : 1, "''");
}

const char *tuned_product(const struct tuning *t, const struct tuned_term *term)
{
	const char *product = monomial_text(t, term->monomial), *factor = readable_text(term->factor);
	if (term->monomial == 0)
		return factor;
	if (mpq_cmp_si(term->factor, 1, 1) == 0)
		return product;
	bool minus = mpq_cmp_si(term->factor, -1, 1) == 0;
	return minus ? format("-%s", product) : format("%s*%s", factor, product);
}

const char *tuned_term_note(const struct emitter *e, const struct tuned_term *term)
{
	const struct tuning *t = e->model->tuning;
	bool left = term->column >= t->x.size;
	if (term->row >= t->rows - t->frequencies)
		return format("%s: %s", row_name(e, term->row), tuned_product(t, term));
	const char *of = left ? row_name(e, term->column - t->x.size)
			      : layout_names(&e->model->tuning->x, e->system, e->model)[term->column];
	const char *equation = format("equation %d, %s", term->row + 1, left ? "left" : "right");
	const char *where = t->solves ? equation : row_name(e, term->row);
	return format("%s: %s %s", where, tuned_product(t, term), of);
}

const char *two_words(struct coefficient number)
{
	return format("{%s, %s}", shortest(number.value), shortest(number.low));
}

/* An array has one element at least. */
void emit_term_start(const struct emitter *e, const struct tuning *t, const char *suffix)
{
	say(e, "\nstatic const pl_term $n_term%s[%d] = {  /* row, column, product of params, factor */\n", suffix,
	    t->terms > 0 ? t->terms : 1);
	if (t->terms == 0)
		say(e, "    {0, 0, 0, {0.0, 0.0}},\n");
}

static void emit_equations(const struct emitter *e)
{
	const struct tuning *t = e->model->tuning;
	emit_monomials(e, t, "");
	emit_term_start(e, t, "");
	for (const struct tuned_term *term = t->term; term < t->term + t->terms; term++)
		say(e, "    {%d, %d, %d, %s},  /* %s */\n", term->row, term->column, term->monomial,
		    two_words(equation_number(e->model, term->factor)), tuned_term_note(e, term));
	say(e, "};\n"
	       "\n"
	       "/* The highest derivatives%s, over x%s */\n", tuned_outputs(e) ? " and outputs" : "",
	    t->frequencies ? "; frequencies of loads, in column 0" : "");
	say(e, "static const pl_equations $n_equations = {%d, %d, %d, $N_PARAMS, %d, %d, %s, $n_term};\n",
	    t->rows, t->x.size, t->solves, t->monomials, t->terms,
	    t->monomials ? format("%s_monomial", e->name) : "NULL");
}

static void emit_tuned_frequencies(const struct emitter *e)
{
	for (int l = 0; l < e->system->loads; l++) {
		int row = e->model->tuning->frequency[l], from = e->step->layout.load[l];
		for (int k = from; row >= 0 && k < from + e->system->load[l].columns; k += 2) {
			say(e, "    A[%d][%d].hi = -value[%d][0].hi;\n"
			       "    A[%d][%d].lo = -value[%d][0].lo;\n", k, k + 1, row, k, k + 1, row);
			say(e, "    A[%d][%d] = value[%d][0];\n", k + 1, k, row);
		}
	}
}

static void emit_fixed_slopes(const struct emitter *e, int count, const struct fixed_slope *fixed)
{
	if (count == 0)
		return;
	say(e, "    static const struct {\n"
	       "        int row, column;\n"
	       "        pl_two value;\n"
	       "    } fixed[] = {");
	for (int k = 0; k < count; k++)
		say(e, "%s{%d, %d, %s}", k ? ", " : "", fixed[k].row, fixed[k].column, two_words(fixed[k].value));
	say(e, "};\n");
}

void emit_slopes_begin(const struct emitter *e)
{
	const struct linear *system = e->system;
	struct fixed_slope *list;
	int size = e->step->layout.size, fixed = fixed_slopes(e->step, &list);
	emit_fixed_slopes(e, fixed, list);
	say(e, "    static const int row[%d] = {", system->n);
	for (int i = 0; i < system->n; i++)
		say(e, "%s%d", i ? ", " : "", system->velocity[i] >= 0 ? system->velocity[i] : i);
	say(e, "};  /* of the highest derivatives */\n"
	       "    int i, j;\n"
	       "    for (i = 0; i < %d; i++)\n"
	       "        for (j = 0; j < %d; j++) {\n"
	       "            A[i][j].hi = 0.0;\n"
	       "            A[i][j].lo = 0.0;\n"
	       "        }\n", size, size);
	if (fixed)
		say(e, "    for (i = 0; i < %d; i++)\n"
		       "        A[fixed[i].row][fixed[i].column] = fixed[i].value;\n", fixed);
}

/* Rows of A that are rows of the solved equations, whose load states are those of a segment of time */
static void emit_segment_rows(const struct emitter *e)
{
	int loads = e->model->tuning->x.loads, inputs = input_columns(e->system), states = e->system->states;
	say(e, "    for (i = 0; i < %d; i++) {\n"
	       "        for (j = 0; j < %d; j++)\n"
	       "            A[row[i]][j] = value[i][j];\n"
	       "        for (j = 0; j < %d; j++)\n"
	       "            A[row[i]][$N_STATES + j] = value[i][$N_STATES + segment * %d + j];\n",
	    e->system->n, states, loads, loads);
	if (inputs)
		say(e, "        for (j = 0; j < %d; j++)\n"
		       "            A[row[i]][%d + j] = value[i][%d + j];\n", inputs, states + loads,
		    states + e->system->segments * loads);
	say(e, "    }\n");
}

/* A of x' = A x, x = states, load states, inputs, from the solved equations */
static void emit_slopes(const struct emitter *e)
{
	const struct linear *system = e->system;
	int size = e->step->layout.size, width = workspace_of(e->step).width;
	bool segments = system->segments > 1;
	say(e, "\n/* x' = A x%s */\n"
	       "static void $n_slopes(pl_two value[%d][%d], %spl_two A[%d][%d])\n"
	       "{\n", segments ? ", in a segment of time" : "", e->model->tuning->rows, width,
	    segments ? "int segment, " : "", size, size);
	emit_slopes_begin(e);
	emit_tuned_frequencies(e);
	if (segments)
		emit_segment_rows(e);
	else
		say(e, "    for (i = 0; i < %d; i++)\n"
		       "        for (j = 0; j < %d; j++)\n"
		       "            A[row[i]][j] = value[i][j];\n", system->n, size);
	say(e, "}\n");
}

/* ---- retune, use ---- */

/* Of an input that goes through further taps: what D's columns of its derivatives, from `at` on, make of a tap */
const char *tap_factor(const struct emitter *e, int input, int tap, const char *row, int at)
{
	int hold = e->system->input[input].hold, terms = 0;
	const char **term = ARRAY(const char *, (size_t)hold + 1);
	mpq_t weight, one;
	mpq_inits(weight, one, NULL);
	mpq_set_ui(one, 1, 1);
	for (int m = 0; m <= hold; m++) {
		tap_derivative(hold, m, tap, one, weight);
		const char *entry = m ? format("%s[%d].hi / power[%d]", row, at + m, m - 1)
				      : format("%s[%d].hi", row, at);
		if (mpq_sgn(weight) != 0)
			term[terms++] = scaled(round_rational(weight), entry);
	}
	mpq_clears(weight, one, NULL);
	return tree(terms, term, 27);
}

void emit_powers_of_h(const struct emitter *e)
{
	int most = most_taps_before(e);
	if (!most)
		return;
	say(e, "    double power[%d];  /* h, h^2, ... */\n"
	       "    power[0] = h;\n"
	       "    for (i = 1; i < %d; i++)\n"
	       "        power[i] = power[i - 1] * h;\n", most, most);
}

/* The columns of inputs in c->step, from D */
static void emit_input_factors(const struct emitter *e, const char *D)
{
	int column = e->system->states + e->system->segments * e->model->tuning->x.loads;
	for (int i = 0; i < e->system->inputs; i++) {
		int at = e->step->layout.input[i];
		if (e->system->input[i].hold > 1) {
			for (int c = 0; c <= e->system->input[i].hold; c++)
				say(e, "        c->step[i][%d] = %s;\n", column++,
				    tap_factor(e, i, c, format("%s[i]", D), at));
		} else if (e->system->input[i].hold) {
			say(e, "        c->step[i][%d] = pl_ramp_before(%s[i][%d], %s[i][%d], h);\n"
			       "        c->step[i][%d] = %s[i][%d].hi / h;\n", column, D, at, D, at + 1, column + 1, D,
			    at + 1);
			column += 2;
		} else {
			say(e, "        c->step[i][%d] = %s[i][%d].hi;\n", column++, D, at);
		}
	}
}

static void emit_take_factors(const struct emitter *e)
{
	int loads = e->model->tuning->x.loads;
	bool segments = e->system->segments > 1;
	const char *D = segments ? "D[0]" : "D";
	emit_powers_of_h(e);
	const char *columns = segments ? format("%s_STATES", e->upper) : format("%d", e->system->states + loads);
	say(e, "    for (i = 0; i < $N_STATES; i++) {\n"
	       "        for (j = 0; j < %s; j++)\n"
	       "            c->step[i][j] = %s[i][j].hi;\n", columns, D);
	if (segments && loads)
		say(e, "        for (j = 0; j < %d; j++)\n"
		       "            c->step[i][$N_STATES + j] = D[j / %d][i][$N_STATES + j %% %d].hi;\n",
		    e->system->segments * loads, loads, loads);
	emit_input_factors(e, D);
	if (e->step->form == FORM_DIRECT)
		say(e, "        c->step[i][i] = (1.0 + c->step[i][i]) + %s[i][i].lo;\n", D);
	say(e, "    }\n");
	if (tuned_outputs(e))
		say(e, "    for (i = 0; i < %d; i++)\n"
		       "        for (j = 0; j < %d; j++)\n"
		       "            c->out[i][j] = value[%d + i][j].hi;\n", tuned_outputs(e), step_columns(e),
		    e->model->n);
}

void emit_take_loads(const struct emitter *e, const int *frequency)
{
	const struct tuning *t = e->model->tuning;
	for (int l = 0; l < e->system->loads && t->frequencies; l++) {
		int phase = e->phase[l], row = frequency[l];
		if (phase >= 0 && row >= 0)
			say(e, "    c->phase_rate[%d] = pl_rate_of(value[%d][0]);\n", phase, row);
		else if (phase >= 0)
			say(e, "    c->phase_rate[%d] = $n_nominal.phase_rate[%d];\n", phase, phase);
	}
	if (e->phases)
		say(e, "    for (i = 0; i < %d; i++)\n"
		       "        c->phase_step[i] = pl_turn_at(&%sphase_rate[i], h);\n", e->phases,
		    t->frequencies ? "c->" : format("%s_", e->name));
	for (int l = 0; l < e->system->loads; l++)
		if (e->growth[l] >= 0)
			say(e, "    c->growth_step[%d] = pl_growth_at(&$n_growth_rate[%d], %d, h);\n", e->growth[l],
			    e->growth[l], mpq_sgn(e->system->load[l].wave->a) < 0);
}

/* In one word where that is enough, also for what is left of a ramp's value before the step */
static void emit_increment(const struct emitter *e, const char *D)
{
	int size = e->step->layout.size;
	const char *cancels = "";
	for (int i = 0; i < e->system->inputs; i++) {
		int at = e->step->layout.input[i];
		const char *one = format("pl_ramp_cancels(%d, %s_STATES, %s, %d, h)", size, e->upper, D, at);
		if (e->system->input[i].hold == 1)
			cancels = format("%s%s%s", cancels, *cancels ? " || " : "", one);
	}
	say(e, "        status = pl_increment(%d, $N_STATES, A[0], h, 1, %s, work);\n", size, D);
	if (*cancels)
		say(e, "        if (status == 0 && (%s))\n"
		       "            status = pl_increment(%d, $N_STATES, A[0], h, 2, %s, work);\n", cancels, size, D);
}

void emit_frequency_check(const struct emitter *e, const int *frequency)
{
	const char *below = "";
	for (int l = 0; l < e->system->loads; l++)
		if (frequency[l] >= 0)
			below = format("%s%svalue[%d][0].hi < 0.0", below, *below ? " || " : "", frequency[l]);
	if (*below)
		say(e, "    if (status == 0 && (%s))\n"
		       "        return PL_NO_RATE;\n", below);
}

/* D = e^{A h} - I, in each segment of time */
static void emit_increments(const struct emitter *e)
{
	int segments = e->system->segments;
	if (segments > 1)
		say(e, "    for (i = 0; i < %d && status == 0; i++) {\n"
		       "        $n_slopes(value, i, A);\n", segments);
	else
		say(e, "    if (status == 0) {\n"
		       "        $n_slopes(value, A);\n");
	emit_increment(e, segments > 1 ? "D[i][0]" : "D[0]");
	say(e, "    }\n"
	       "    if (status != 0)\n"
	       "        return status;\n");
}

static void emit_retune_function(const struct emitter *e)
{
	int segments = e->system->segments, size = e->step->layout.size;
	struct workspace space = workspace_of(e->step);
	say(e, "\nint $n_retune($n_coeffs *c, const double params[$N_PARAMS], double h)\n"
	       "{\n"
	       "    pl_two value[%d][%d], A[%d][%d], work[%d];\n", e->model->tuning->rows, space.width, size, size,
	    space.work);
	say(e, "    pl_two D%s[$N_STATES][%d];  /* e^{A h} - I */\n"
	       "    int i, j, status;\n"
	       "    if (!(h > 0.0))\n"
	       "        return PL_NO_STEP;\n"
	       "    status = pl_equations_at(&$n_equations, params, value[0], work);\n",
	    segments > 1 ? format("[%d]", segments) : "", size);
	emit_frequency_check(e, e->model->tuning->frequency);
	emit_increments(e);
	if (segments > 1)
		say(e, "    c->h_low = 0.0;\n");
	say(e, "    c->h = h;\n"
	       "    for (i = 0; i < $N_PARAMS; i++)\n"
	       "        c->params[i] = params[i];\n");
	emit_take_factors(e);
	emit_take_loads(e, e->model->tuning->frequency);
	emit_retune_peaks(e);
	say(e, "    return 0;\n"
	       "}\n");
}

/* ---- any time ---- */

/* x <- e^{A tau} x; where the loads change their formula, all of it, since more may follow */
static void emit_advance(const struct emitter *e)
{
	int size = e->step->layout.size;
	struct workspace space = workspace_of(e->step);
	bool segments = e->system->segments > 1;
	const char *rows = segments ? format("%d", size) : format("%s_STATES", e->upper);
	say(e, "\n/* The states tau on */\n"
	       "static void $n_advance(pl_two value[%d][%d], %sdouble tau, double x[%d])\n"
	       "{\n"
	       "    pl_two A[%d][%d], D[%s][%d], work[%d];\n", e->model->tuning->rows, space.width,
	    segments ? "int segment, " : "", size, size, size, rows, size, space.work);
	say(e, "    double more[%s];\n"
	       "    int i, j;\n"
	       "    $n_slopes(value, %sA);\n"
	       "    (void)pl_increment(%d, %s, A[0], tau, 1, D[0], work);\n", rows, segments ? "segment, " : "", size,
	    rows);
	say(e, "    for (i = 0; i < %s; i++) {\n"
	       "        more[i] = 0.0;\n"
	       "        for (j = 0; j < %d; j++)\n"
	       "            more[i] += D[i][j].hi * x[j];\n"
	       "    }\n"
	       "    for (i = 0; i < %s; i++)\n"
	       "        x[i] += more[i];\n"
	       "}\n", rows, size, rows);
}

/* To each change of the loads on the way */
static void emit_pass_changes(const struct emitter *e, int changes)
{
	say(e, "    for (; segment < %d && $n_until(s, segment) < tau; segment++) {\n"
	       "        const double ahead = $n_until(s, segment);\n"
	       "        if (ahead > done) {\n"
	       "            $n_advance(value, segment, ahead - done, x);\n"
	       "            done = ahead;\n"
	       "        }\n"
	       "    }\n", changes);
}

static void emit_tuned_pass(const struct emitter *e)
{
	const struct tuning *t = e->model->tuning;
	int changes = e->system->segments - 1;
	emit_advance(e);
	say(e, "\n/* The state tau after now%s */\n"
	       "static void $n_pass(const $n *s, %sdouble tau, double y[$N_STATES])\n"
	       "{\n", changes ? ", from change to change of the loads on the way" : "",
	    e->system->inputs ? format("const double u[%s_INPUTS], ", e->upper) : "");
	say(e, "    pl_two value[%d][%d], work[%d];\n"
	       "    double x[%d]%s;\n", t->rows, workspace_of(e->step).width, t->monomials + 1, e->step->layout.size,
	    changes ? ", done = 0.0" : "");
	if (changes)
		say(e, "    int segment = s->segment;\n");
	emit_series_vector(e);
	say(e, "    (void)pl_equations_at(&$n_equations, s->coeffs.params, value[0], work);\n");
	if (changes)
		emit_pass_changes(e, changes);
	say(e, "    $n_advance(value, %s, x);\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        y[i] = x[i];\n"
	       "}\n", changes ? "segment, tau - done" : "tau");
}

void emit_use_function(const struct emitter *e)
{
	say(e, "\nvoid $n_use($n *s, const $n_coeffs *c)\n"
	       "{\n"
	       "    if (c->h != s->coeffs.h) {\n"
	       "        s->t0 = $n_time(s);\n"
	       "        s->k = 0;\n"
	       "    }\n"
	       "    s->coeffs = *c;\n"
	       "}\n");
}

void emit_retune(const struct emitter *e)
{
	emit_equations(e);
	emit_slopes(e);
	emit_retune_function(e);
	emit_use_function(e);
	emit_tuned_pass(e);
}

void emit_tuned_at(const struct emitter *e)
{
	bool inputs = e->system->inputs > 0, relative = e->model->relative != NULL;
	say(e, "\nvoid $n_at(const $n *s, %sdouble tau, double y[$N_STATES])\n"
	       "{\n", inputs ? format("const double u[%s_INPUTS], ", e->upper) : "");
	if (relative)
		say(e, "    double x[$N_STATES];\n");
	say(e, "    $n_pass(s, %stau, %s);\n", inputs ? "u, " : "", relative ? "x" : "y");
	if (relative)
		say(e, "    $n_written(s, x, y);\n");
	say(e, "}\n");
}
