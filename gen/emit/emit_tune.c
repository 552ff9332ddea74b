/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models with tunable params: an instance holds its own coefficients, and NAME_retune computes them anew on the target. */
#include "emit/emit.h"

#include <string.h>

/* Columns of a step's factors: states, load states in each segment of time, inputs */
static int step_columns(const struct emitter *e)
{
	return e->model->tuning->columns;
}

static int tuned_outputs(const struct emitter *e)
{
	return e->model->tuning->outputs;
}

static const char *param_list(const struct emitter *e)
{
	const struct tuning *t = e->model->tuning;
	const char *list = "";
	for (int k = 0; k < t->params; k++)
		list = format("%s%s%s", list, k ? ", " : "", t->param[k].symbol->name);
	return list;
}

/* x1, x2, x1', x2', cos(5*t), sin(5*t), u */
static const char **column_names(const struct emitter *e)
{
	const char **name = ARRAY(const char *, (size_t)step_columns(e));
	int column = 0;
	for (int i = 0; i < e->system->states; i++)
		name[column++] = e->model->state_name[i];
	for (int s = 0; s < e->system->segments; s++)
		for (int l = 0; l < e->system->loads; l++)
			for (int k = 0; k < e->system->load[l].columns; k++)
				name[column++] = format("%s%s", column_text(&e->system->load[l], k), s ? format(" (segment %d)", s) : "");
	for (int i = 0; i < e->system->inputs; i++) {
		name[column++] = e->system->input[i].name;
		if (e->system->input[i].first_order)
			name[column++] = format("%s'", e->system->input[i].name);
	}
	return name;
}

/* The same as a comment says it: the load states once, lines broken */
static const char *column_list(const struct emitter *e)
{
	enum { WIDTH = 110 };
	const char **name = column_names(e), *list = "", *line = "";
	int states = e->system->states, loads = e->model->tuning->loads, segments = e->system->segments;
	for (int i = 0; i < step_columns(e); i++) {
		if (i >= states + loads && i < states + segments * loads)
			continue;
		bool first = segments > 1 && loads && i == states, last = segments > 1 && loads && i == states + loads - 1;
		const char *text = format("%s%s%s", first ? "(" : "", name[i], last ? format(") in each of %d segments of time", segments) : "");
		bool wide = strlen(line) + strlen(text) > WIDTH;
		list = format("%s%s%s%s", list, i ? "," : "", wide ? "\n *     " : i ? " " : "", text);
		line = wide ? text : format("%s, %s", line, text);
	}
	return list;
}

/* ---- sizes of what NAME_retune works in ---- */

static int equation_width(const struct emitter *e)
{
	const struct tuning *t = e->model->tuning;
	return t->columns + (t->solves ? t->rows : 0);
}

static int work_size(const struct emitter *e)
{
	int size = e->step->series.size, increment = PL_INCREMENT_WORK(size), products = e->model->tuning->monomials + 1;
	return increment > products ? increment : products;
}

/* Bytes, frames of the calls not counted */
static int retune_stack(const struct emitter *e)
{
	int size = e->step->series.size, real = e->model->asked.single ? 4 : 8;
	int twos = e->model->tuning->rows * equation_width(e) + size * size + work_size(e) + e->system->segments * e->system->states * size;
	return 2 * real * twos;
}

/* ---- the header ---- */

void banner_tuning(const struct emitter *e)
{
	fprintf(e->to, " * Tunable: %s. %s_retune computes the factors of a step from other values and another h on the target; of the spec's\n"
		       " * values they are these, correctly rounded. It needs some %d KB of stack.\n", param_list(e), e->name, 1 + retune_stack(e) / 1024);
}

/* A member, its comment at a common column */
static void member(const struct emitter *e, const char *text, const char *comment)
{
	fprintf(e->to, *comment ? "    %-38s /* %s */\n" : "    %s\n", text, comment);
}

static const char *ramp_note(const struct emitter *e, const char *what)
{
	return e->ramps ? format("; of a ramp %s", what) : "";
}

void emit_coefficient_struct(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name, *N = e->upper;
	fprintf(to, "enum { %s_PARAMS = %d };  /* tunable: %s */\n", N, e->model->tuning->params, param_list(e));
	fprintf(to, "typedef struct %s_coeffs %s_coeffs;  /* what a step multiplies with, at one set of params and one h */\n", n, n);
	fprintf(to, "/* z = %s%s */\n", column_list(e), ramp_note(e, "its value before the step, then after it"));
	fprintf(to, "struct %s_coeffs {\n", n);
	member(e, "double h;", "[s]");
	if (e->system->segments > 1)
		member(e, "double h_low;", "of the spec's step: what h leaves out; else 0");
	member(e, format("double params[%s_PARAMS];", N), param_list(e));
	member(e, format("double step[%s_STATES][%d];", N, step_columns(e)), e->step->form == FORM_DELTA ? "y += step z" : "y = step z");
	if (tuned_outputs(e))
		member(e, format("double out[%d][%d];", tuned_outputs(e), step_columns(e)),
		       format("out z, where outputs depend on params%s", ramp_note(e, "its value and its slope")));
	if (e->phases)
		member(e, format("pl_turn phase_step[%d];", e->phases), "of the loads, in one step");
	if (e->model->tuning->frequencies)
		member(e, format("pl_rate phase_rate[%d];", e->phases), "in turns per second");
	if (e->growths)
		member(e, format("pl_growth growth_step[%d];", e->growths), e->phases ? "" : "of the loads, in one step");
	fputs("};\n\n", to);
}

void emit_tuning_declarations(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name;
	fprintf(to, "\n/* Computes c anew from params (%s) and h [s]. 0, or c is as it was and\n", param_list(e));
	fputs(" *     PL_NO_STEP     h is not above 0\n"
	      " *     PL_SINGULAR    the mass matrix has no inverse, or a divisor is 0\n", to);
	if (e->model->tuning->frequencies)
		fputs(" *     PL_NO_RATE     a frequency of a load is below 0\n", to);
	fputs(" *     PL_NOT_FINITE  a number of it is infinite, or not a number\n"
	      " * c may be that of an instance as long as h stays. */\n", to);
	fprintf(to, "int    %s_retune(%s_coeffs *c, const double params[%s_PARAMS], double h);\n\n", n, n, e->upper);
	fprintf(to, "/* From now on with c. State and time stay%s. */\n", e->phases ? "; phases of loads go on from where they are" : "");
	fprintf(to, "void   %s_use(%s *s, const %s_coeffs *c);\n\n", n, n, n);
	fprintf(to, "/* Of the spec's values, correctly rounded: what %s_init starts with */\nextern const %s_coeffs %s_nominal;\n\n", n, n, n);
}

void emit_tuning_wrapper(const struct emitter *e)
{
	const struct tuning *t = e->model->tuning;
	const char **name = ARRAY(const char *, (size_t)t->params);
	const char *n = e->name;
	for (int k = 0; k < t->params; k++)
		name[k] = t->param[k].symbol->name;
	fputc('\n', e->to);
	emit_name_list(e, "param_names", t->params, name);
	fprintf(e->to, "\nstatic int %s_any_retune(void *s, const double *params, double h)\n{\n    %s_coeffs fresh = %s_nominal;\n", n, n, n);
	fprintf(e->to, "    const int status = %s_retune(&fresh, params, h);\n    if (status == 0)\n        %s_use((struct %s *)s, &fresh);\n    return status;\n}\n", n, n, n);
}

/* ---- the generator's own coefficients ---- */

static double *nominal_step(const struct emitter *e)
{
	const struct table *table = e->step->branch->whole;
	const struct coefficient *square = e->step->form == FORM_DELTA ? table->increment : table->Phi;
	int n = table->states, width = step_columns(e), segments = e->system->segments;
	double *value = ARRAY(double, (size_t)(n * width));
	for (int i = 0; i < n; i++) {
		double *row = value + i * width;
		for (int j = 0; j < n; j++)
			row[j] = square[i * n + j].value;
		for (int s = 0; s < segments; s++)
			for (int k = 0; k < table->columns; k++)
				row[n + s * table->columns + k] = table->load[(s * n + i) * table->columns + k].value;
		for (int k = 0; k < table->inputs; k++)
			row[n + segments * table->columns + k] = table->input[i * table->inputs + k].value;
	}
	return value;
}

/* A row of an output over the columns */
static void nominal_output(const struct emitter *e, const struct output *output, double *row)
{
	const struct linear *system = e->system;
	int column = 0;
	for (int j = 0; j < system->states; j++)
		row[column++] = finite_number(e, output->state[j]);
	for (int s = 0; s < system->segments; s++)
		for (int l = 0; l < system->loads; l++)
			for (int k = 0; k < system->load[l].columns; k++)
				row[column++] = finite_number(e, output->load[l][k * system->segments + s]);
	for (int i = 0; i < system->inputs; i++)
		for (int k = 0; k < (system->input[i].first_order ? 2 : 1); k++)
			row[column++] = finite_number(e, output->input[k][i]);
}

static void emit_nominal_outputs(const struct emitter *e)
{
	int width = step_columns(e);
	double *value = ARRAY(double, (size_t)(tuned_outputs(e) * width));
	const char **name = ARRAY(const char *, (size_t)tuned_outputs(e));
	for (int o = 0; o < e->model->outputs; o++) {
		int row = e->model->tuning->output[o] - e->model->n;
		if (row < 0)
			continue;
		nominal_output(e, &e->model->output[o], value + row * width);
		name[row] = e->model->output[o].name;
	}
	fputs("    {\n", e->to);
	emit_number_rows(e, tuned_outputs(e), width, value, name);
	fputs("    },\n", e->to);
}

void emit_nominal(const struct emitter *e)
{
	FILE *to = e->to;
	const struct tuning *t = e->model->tuning;
	fprintf(to, "\nconst %s_coeffs %s_nominal = {\n    %s_H,\n    ", e->name, e->name, e->upper);
	if (e->system->segments > 1)
		fprintf(to, "%s,\n    ", low_text(e->model->h));
	fputc('{', to);
	for (int k = 0; k < t->params; k++)
		fprintf(to, "%s%s", k ? ", " : "", finite_text(t->param[k].at, t->nominal[k]));
	fputs("},\n    {\n", to);
	emit_number_rows(e, e->system->states, step_columns(e), nominal_step(e), e->model->state_name);
	fputs("    },\n", to);
	if (tuned_outputs(e))
		emit_nominal_outputs(e);
	for (int turns = 1; turns >= 0; turns--) {
		if ((turns ? e->phases : e->growths) == 0)
			continue;
		fputs("    {\n", to);
		for (int l = 0; l < e->system->loads; l++)
			if ((turns ? e->phase : e->growth)[l] >= 0)
				fprintf(to, "    %s,  /* %s */\n", (turns ? phase_step_text : growth_step_text)(e, l), column_text(&e->system->load[l], 0));
		fputs("    },\n", to);
		if (turns && t->frequencies) {
			fputs("    {\n", to);
			emit_phase_rates(e);
			fputs("    },\n", to);
		}
	}
	fputs("};\n", to);
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

static void emit_monomials(const struct emitter *e)
{
	const struct tuning *t = e->model->tuning;
	if (t->monomials == 0)
		return;
	fprintf(e->to, "\nstatic const pl_monomial %s_monomial[%d] = {\n", e->name, t->monomials);
	for (int m = 0; m < t->monomials; m++)
		fprintf(e->to, "    {%d, %d, %d},  /* %s */\n", t->monomial[m].from, t->monomial[m].param, t->monomial[m].divides, monomial_text(t, m + 1));
	fputs("};\n", e->to);
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

static const char *product_text(const struct tuning *t, const struct tuned_term *term)
{
	const char *product = monomial_text(t, term->monomial);
	if (term->monomial == 0)
		return readable_text(term->factor);
	if (mpq_cmp_si(term->factor, 1, 1) == 0)
		return product;
	return mpq_cmp_si(term->factor, -1, 1) == 0 ? format("-%s", product) : format("%s*%s", readable_text(term->factor), product);
}

static const char *term_note(const struct emitter *e, const struct tuned_term *term)
{
	const struct tuning *t = e->model->tuning;
	bool left = term->column >= t->columns;
	if (term->row >= t->rows - t->frequencies)
		return format("%s: %s", row_name(e, term->row), product_text(t, term));
	const char *of = left ? row_name(e, term->column - t->columns) : column_names(e)[term->column];
	const char *where = t->solves ? format("equation %d, %s", term->row + 1, left ? "left" : "right") : row_name(e, term->row);
	return format("%s: %s %s", where, product_text(t, term), of);
}

static void emit_equations(const struct emitter *e)
{
	FILE *to = e->to;
	const struct tuning *t = e->model->tuning;
	const char *n = e->name;
	emit_monomials(e);
	fprintf(to, "\nstatic const pl_term %s_term[%d] = {  /* row, column, product of params, factor */\n", n, t->terms);
	for (int i = 0; i < t->terms; i++) {
		finite_number(e, t->term[i].factor);
		fprintf(to, "    {%d, %d, %d, %s},  /* %s */\n", t->term[i].row, t->term[i].column, t->term[i].monomial, two_text(t->term[i].factor),
			term_note(e, &t->term[i]));
	}
	fprintf(to, "};\n\n/* The highest derivatives%s, over x%s */\n", tuned_outputs(e) ? " and outputs" : "", t->frequencies ? "; frequencies of loads, in column 0" : "");
	fprintf(to, "static const pl_equations %s_equations = {%d, %d, %d, %s_PARAMS, %d, %d, %s, %s_term};\n", n, t->rows, t->columns, t->solves, e->upper,
		t->monomials, t->terms, t->monomials ? format("%s_monomial", n) : "NULL", n);
}

/* Is this entry of A w or -w of a load whose frequency depends on params? */
static bool is_tuned_frequency(const struct emitter *e, int row, int column)
{
	for (int l = 0; l < e->system->loads; l++) {
		int from = e->step->series.load[l];
		if (e->model->tuning->frequency[l] >= 0 && row >= from && row < from + e->system->load[l].columns && row != column && (row - from) / 2 == (column - from) / 2)
			return true;
	}
	return false;
}

static void emit_tuned_frequencies(const struct emitter *e)
{
	for (int l = 0; l < e->system->loads; l++) {
		int row = e->model->tuning->frequency[l], from = e->step->series.load[l];
		for (int k = from; row >= 0 && k < from + e->system->load[l].columns; k += 2)
			fprintf(e->to, "    A[%d][%d].hi = -value[%d][0].hi;\n    A[%d][%d].lo = -value[%d][0].lo;\n    A[%d][%d] = value[%d][0];\n", k, k + 1, row, k, k + 1,
				row, k + 1, k, row);
	}
}

/* What no param changes: velocities, and how loads and ramps go on. Returns how many. */
static int emit_fixed_entries(const struct emitter *e)
{
	const struct linear *system = e->system;
	int size = e->step->series.size, count = 0;
	mpq_t *A = series_matrix(&e->step->series, system, 0);
	for (int i = 0; i < size; i++)
		for (int j = 0; j < size; j++) {
			bool derivative = i < system->states && (i >= system->n || system->velocity[i] < 0);
			if (derivative || mpq_sgn(A[i * size + j]) == 0 || is_tuned_frequency(e, i, j))
				continue;
			finite_number(e, A[i * size + j]);
			fprintf(e->to, "%s{%d, %d, %s}", count++ ? ", " : "    static const struct {\n        int row, column;\n        pl_two value;\n    } fixed[] = {", i, j,
				two_text(A[i * size + j]));
		}
	fputs(count ? "};\n" : "", e->to);
	return count;
}

/* A of x' = A x, x = states, load states, inputs, from the solved equations */
static void emit_slopes(const struct emitter *e)
{
	FILE *to = e->to;
	const struct tuning *t = e->model->tuning;
	const struct linear *system = e->system;
	int size = e->step->series.size, inputs = input_columns(system);
	bool segments = system->segments > 1;
	fprintf(to, "\n/* x' = A x%s */\nstatic void %s_slopes(pl_two value[%d][%d], %spl_two A[%d][%d])\n{\n", segments ? ", in a segment of time" : "", e->name, t->rows,
		equation_width(e), segments ? "int segment, " : "", size, size);
	int fixed = emit_fixed_entries(e);
	fprintf(to, "    static const int row[%d] = {", system->n);
	for (int i = 0; i < system->n; i++)
		fprintf(to, "%s%d", i ? ", " : "", system->velocity[i] >= 0 ? system->velocity[i] : i);
	fprintf(to, "};  /* of the highest derivatives */\n    int i, j;\n    for (i = 0; i < %d; i++)\n        for (j = 0; j < %d; j++)\n            A[i][j].hi = A[i][j].lo = 0.0;\n",
		size, size);
	if (fixed)
		fprintf(to, "    for (i = 0; i < %d; i++)\n        A[fixed[i].row][fixed[i].column] = fixed[i].value;\n", fixed);
	emit_tuned_frequencies(e);
	fprintf(to, "    for (i = 0; i < %d; i++)%s\n        for (j = 0; j < %d; j++)\n            A[row[i]][j] = value[i][j];\n", system->n, segments ? " {" : "",
		segments ? system->states : size);
	if (!segments)
		fputs("}\n", to);
	if (segments)
		fprintf(to, "        for (j = 0; j < %d; j++)\n            A[row[i]][%s_STATES + j] = value[i][%s_STATES + segment * %d + j];\n", t->loads, e->upper, e->upper, t->loads);
	if (segments && inputs)
		fprintf(to, "        for (j = 0; j < %d; j++)\n            A[row[i]][%d + j] = value[i][%d + j];\n", inputs, system->states + t->loads,
			system->states + system->segments * t->loads);
	if (segments)
		fputs("    }\n}\n", to);
}

/* ---- retune, use ---- */

/* Declares what the equations are solved in. */
static void emit_work(const struct emitter *e)
{
	int size = e->step->series.size;
	fprintf(e->to, "    pl_two value[%d][%d], A[%d][%d], work[%d];\n", e->model->tuning->rows, equation_width(e), size, size, work_size(e));
}

/* The columns of inputs in c->step, from D */
static void emit_input_factors(const struct emitter *e, const char *D)
{
	int column = e->system->states + e->system->segments * e->model->tuning->loads;
	for (int i = 0; i < e->system->inputs; i++) {
		int at = e->step->series.input[i];
		if (e->system->input[i].first_order) {
			fprintf(e->to, "        c->step[i][%d] = pl_ramp_before(%s[i][%d], %s[i][%d], h);\n", column, D, at, D, at + 1);
			fprintf(e->to, "        c->step[i][%d] = %s[i][%d].hi / h;\n", column + 1, D, at + 1);
			column += 2;
		} else {
			fprintf(e->to, "        c->step[i][%d] = %s[i][%d].hi;\n", column++, D, at);
		}
	}
}

static void emit_take_factors(const struct emitter *e)
{
	FILE *to = e->to;
	const struct tuning *t = e->model->tuning;
	const char *N = e->upper;
	bool segments = e->system->segments > 1;
	const char *D = segments ? "D[0]" : "D";
	fprintf(to, "    for (i = 0; i < %s_STATES; i++) {\n        for (j = 0; j < %s%s; j++)\n            c->step[i][j] = %s[i][j].hi;\n", N,
		segments ? N : format("%d", e->system->states + t->loads), segments ? "_STATES" : "", D);
	if (segments && t->loads)
		fprintf(to, "        for (j = 0; j < %d; j++)\n            c->step[i][%s_STATES + j] = D[j / %d][i][%s_STATES + j %% %d].hi;\n", e->system->segments * t->loads, N,
			t->loads, N, t->loads);
	emit_input_factors(e, D);
	if (e->step->form == FORM_DIRECT)
		fprintf(to, "        c->step[i][i] = (1.0 + c->step[i][i]) + %s[i][i].lo;\n", D);
	fputs("    }\n", to);
	if (tuned_outputs(e))
		fprintf(to, "    for (i = 0; i < %d; i++)\n        for (j = 0; j < %d; j++)\n            c->out[i][j] = value[%d + i][j].hi;\n", tuned_outputs(e), step_columns(e),
			e->model->n);
}

static void emit_take_loads(const struct emitter *e)
{
	const struct tuning *t = e->model->tuning;
	for (int l = 0; l < e->system->loads && t->frequencies; l++) {
		int phase = e->phase[l], row = t->frequency[l];
		if (phase >= 0)
			fprintf(e->to, "    c->phase_rate[%d] = %s;\n", phase, row >= 0 ? format("pl_rate_of(value[%d][0])", row) : format("%s_nominal.phase_rate[%d]", e->name, phase));
	}
	if (e->phases)
		fprintf(e->to, "    for (i = 0; i < %d; i++)\n        c->phase_step[i] = pl_turn_at(&%sphase_rate[i], h);\n", e->phases,
			t->frequencies ? "c->" : format("%s_", e->name));
	for (int l = 0; l < e->system->loads; l++)
		if (e->growth[l] >= 0)
			fprintf(e->to, "    c->growth_step[%d] = pl_growth_at(&%s_growth_rate[%d], %d, h);\n", e->growth[l], e->name, e->growth[l],
				mpq_sgn(e->system->load[l].wave->a) < 0);
}

/* In one word where that is enough, also for what is left of a ramp's value before the step */
static void emit_increment(const struct emitter *e, const char *D)
{
	int size = e->step->series.size;
	const char *cancels = "";
	for (int i = 0; i < e->system->inputs; i++)
		if (e->system->input[i].first_order)
			cancels = format("%s%spl_ramp_cancels(%d, %s_STATES, %s, %d, h)", cancels, *cancels ? " || " : "", size, e->upper, D, e->step->series.input[i]);
	fprintf(e->to, "        status = pl_increment(%d, %s_STATES, A[0], h, 1, %s, work);\n", size, e->upper, D);
	if (*cancels)
		fprintf(e->to, "        if (status == 0 && (%s))\n            status = pl_increment(%d, %s_STATES, A[0], h, 2, %s, work);\n", cancels, size, e->upper, D);
}

/* A frequency below 0 has no rate. */
static void emit_frequency_check(const struct emitter *e)
{
	const char *below = "";
	for (int l = 0; l < e->system->loads; l++)
		if (e->model->tuning->frequency[l] >= 0)
			below = format("%s%svalue[%d][0].hi < 0.0", below, *below ? " || " : "", e->model->tuning->frequency[l]);
	if (*below)
		fprintf(e->to, "    if (status == 0 && (%s))\n        return PL_NO_RATE;\n", below);
}

static void emit_retune_function(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name, *N = e->upper;
	int segments = e->system->segments, size = e->step->series.size;
	fprintf(to, "\nint %s_retune(%s_coeffs *c, const double params[%s_PARAMS], double h)\n{\n", n, n, N);
	emit_work(e);
	fprintf(to, "    pl_two D%s[%s_STATES][%d];  /* e^{A h} - I */\n    int i, j, status;\n", segments > 1 ? format("[%d]", segments) : "", N, size);
	fprintf(to, "    if (!(h > 0.0))\n        return PL_NO_STEP;\n    status = pl_equations_at(&%s_equations, params, value[0], work);\n", n);
	emit_frequency_check(e);
	if (segments > 1) {
		fprintf(to, "    for (i = 0; i < %d && status == 0; i++) {\n        %s_slopes(value, i, A);\n", segments, n);
		emit_increment(e, "D[i][0]");
		fputs("    }\n    if (status != 0)\n        return status;\n", to);
	} else {
		fprintf(to, "    if (status == 0) {\n        %s_slopes(value, A);\n", n);
		emit_increment(e, "D[0]");
		fputs("    }\n    if (status != 0)\n        return status;\n", to);
	}
	if (segments > 1)
		fputs("    c->h_low = 0.0;\n", to);
	fprintf(to, "    c->h = h;\n    for (i = 0; i < %s_PARAMS; i++)\n        c->params[i] = params[i];\n", N);
	emit_take_factors(e);
	emit_take_loads(e);
	fputs("    return 0;\n}\n", to);
}

/* ---- any time ---- */

/* x <- e^{A tau} x; where the loads change their formula, all of it, since more may follow */
static void emit_advance(const struct emitter *e)
{
	FILE *to = e->to;
	int size = e->step->series.size;
	bool segments = e->system->segments > 1;
	const char *rows = segments ? format("%d", size) : format("%s_STATES", e->upper);
	fprintf(to, "\n/* The states tau on */\nstatic void %s_advance(pl_two value[%d][%d], %sdouble tau, double x[%d])\n{\n", e->name, e->model->tuning->rows, equation_width(e),
		segments ? "int segment, " : "", size);
	fprintf(to, "    pl_two A[%d][%d], D[%s][%d], work[%d];\n    double more[%s];\n    int i, j;\n", size, size, rows, size, work_size(e), rows);
	fprintf(to, "    %s_slopes(value, %sA);\n    pl_increment(%d, %s, A[0], tau, 1, D[0], work);\n", e->name, segments ? "segment, " : "", size, rows);
	fprintf(to, "    for (i = 0; i < %s; i++) {\n        more[i] = 0.0;\n        for (j = 0; j < %d; j++)\n            more[i] += D[i][j].hi * x[j];\n    }\n", rows, size);
	fprintf(to, "    for (i = 0; i < %s; i++)\n        x[i] += more[i];\n}\n", rows);
}

static void emit_tuned_pass(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name, *N = e->upper;
	int size = e->step->series.size, changes = e->system->segments - 1;
	const char *u = e->system->inputs ? format("const double u[%s_INPUTS], ", N) : "";
	emit_advance(e);
	fprintf(to, "\n/* The state tau after now%s */\n", changes ? ", from change to change of the loads on the way" : "");
	fprintf(to, "static void %s_pass(const %s *s, %sdouble tau, double y[%s_STATES])\n{\n", n, n, u, N);
	fprintf(to, "    pl_two value[%d][%d], work[%d];\n    double x[%d]%s;\n", e->model->tuning->rows, equation_width(e), e->model->tuning->monomials + 1, size,
		changes ? ", done = 0.0" : "");
	if (changes)
		fputs("    int segment = s->segment;\n", to);
	emit_series_vector(e);
	fprintf(to, "    pl_equations_at(&%s_equations, s->coeffs.params, value[0], work);\n", n);
	if (changes) {
		fprintf(to, "    for (; segment < %d && %s_until(s, segment) < tau; segment++) {\n        const double ahead = %s_until(s, segment);\n", changes, n, n);
		fprintf(to, "        if (ahead > done) {\n            %s_advance(value, segment, ahead - done, x);\n            done = ahead;\n        }\n    }\n", n);
	}
	fprintf(to, "    %s_advance(value, %s, x);\n    for (i = 0; i < %s_STATES; i++)\n        y[i] = x[i];\n}\n", n, changes ? "segment, tau - done" : "tau", N);
}

void emit_retune(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name;
	emit_equations(e);
	emit_slopes(e);
	emit_retune_function(e);
	fprintf(to, "\nvoid %s_use(%s *s, const %s_coeffs *c)\n{\n    if (c->h != s->coeffs.h) {\n        s->t0 = %s_time(s);\n        s->k = 0;\n    }\n    s->coeffs = *c;\n}\n",
		n, n, n, n);
	emit_tuned_pass(e);
}

void emit_tuned_at(const struct emitter *e)
{
	bool inputs = e->system->inputs > 0, relative = e->model->relative != NULL;
	fprintf(e->to, "\nvoid %s_at(const %s *s, %sdouble tau, double y[%s_STATES])\n{\n", e->name, e->name,
		inputs ? format("const double u[%s_INPUTS], ", e->upper) : "", e->upper);
	if (relative)
		fprintf(e->to, "    double x[%s_STATES];\n", e->upper);
	fprintf(e->to, "    %s_pass(s, %stau, %s);\n", e->name, inputs ? "u, " : "", relative ? "x" : "y");
	if (relative)
		fprintf(e->to, "    %s_written(s, x, y);\n", e->name);
	fputs("}\n", e->to);
}

/* ---- in the code of a step and of the outputs ---- */

/* In c->step or c->out; load columns are those of the segment of time that it is in */

