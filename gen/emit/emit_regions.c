/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A piecewise-linear model as C: tables of its regions, and a step that leaves finding crossings to the runtime. */
#include "emit/emit.h"

#include <math.h>
#include <string.h>

static const struct switching *regions_of(const struct emitter *e)
{
	return e->model->switching;
}

/* ---- e^{A h} of a region over x = states, load states, inputs ---- */

/* The load states among themselves */
static void fill_load_states(const struct emitter *e, mpq_srcptr piece, double *Phi)
{
	const struct series *series = &e->step->series;
	for (int l = 0; l < e->system->loads; l++) {
		const struct load *load = &e->system->load[l];
		for (int to = 0; to < load->columns && series->load[l] >= 0; to++)
			for (int from = 0; from < load->columns; from++)
				Phi[(series->load[l] + to) * series->size + series->load[l] + from] =
					response_value(response_of_load_state(load, to, from), piece, false, e->model->asked.step_at, column_text(load, to)).value;
	}
}

static void fill_input_states(const struct emitter *e, mpq_srcptr piece, double *Phi)
{
	const struct series *series = &e->step->series;
	for (int i = 0; i < e->system->inputs; i++) {
		int at = series->input[i];
		Phi[at * series->size + at] = 1;
		if (!e->system->input[i].first_order)
			continue;
		Phi[at * series->size + at + 1] = round_rational(piece);
		Phi[(at + 1) * series->size + at + 1] = 1;
	}
}

/* u, and of a ramp u': held, and as the slope of u */
static void fill_inputs(const struct emitter *e, const struct table *table, double *Phi)
{
	const struct series *series = &e->step->series;
	for (int row = 0; row < table->states; row++)
		for (int i = 0; i < e->system->inputs; i++) {
			const struct coefficient *held = &table->kernel[0][row * table->channels], *ramp = &table->kernel[1][row * table->channels];
			Phi[row * series->size + series->input[i]] = held[2 * i].value;
			if (e->system->input[i].first_order)
				Phi[row * series->size + series->input[i] + 1] = ramp[2 * i].value + held[2 * i + 1].value;
		}
}

static double *phi_of(const struct emitter *e, int system)
{
	const struct series *series = &e->step->series;
	const struct table *table = e->step->branch[system].table[0];
	double *Phi = ARRAY(double, (size_t)series->size * (size_t)series->size);
	for (int i = 0; i < table->states; i++) {
		for (int j = 0; j < table->states; j++)
			Phi[i * series->size + j] = table->Phi[i * table->states + j].value;
		for (int l = 0, column = 0; l < e->system->loads; l++)
			for (int k = 0; k < e->system->load[l].columns; k++, column++)
				if (series->load[l] >= 0)
					Phi[i * series->size + series->load[l] + k] = table->load[i * table->columns + column].value;
	}
	fill_inputs(e, table, Phi);
	mpq_t piece;
	mpq_init(piece);
	mpq_div_2exp(piece, e->model->h, (mp_bitcnt_t)e->step->branch[system].halvings);
	fill_load_states(e, piece, Phi);
	fill_input_states(e, piece, Phi);
	mpq_clear(piece);
	return Phi;
}

static double *slopes_of(const struct emitter *e, int system)
{
	int size = e->step->series.size;
	mpq_t *exact = series_matrix(&e->step->series, &e->step->branch[system].system, 0);
	double *A = ARRAY(double, (size_t)size * (size_t)size);
	for (int i = 0; i < size * size; i++)
		A[i] = finite_number(e, exact[i]);
	return A;
}

/* ---- expressions as rows over x ---- */

static double *row_of(const struct emitter *e, const struct expression *x)
{
	const struct series *series = &e->step->series;
	double *row = ARRAY(double, (size_t)series->size);
	for (int i = 0; i < e->system->states; i++)
		row[i] = finite_number(e, x->row->state[i]);
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && series->load[l] >= 0; k++)
			row[series->load[l] + k] = finite_number(e, x->row->load[l][k]);
	for (int i = 0; i < e->system->inputs; i++) {
		row[series->input[i]] = finite_number(e, x->row->input[0][i]);
		if (e->system->input[i].first_order)
			row[series->input[i] + 1] = finite_number(e, x->row->input[1][i]);
	}
	return row;
}

/* ---- bounds: no numbers of the model, so doubles rounded up a little will do ---- */

static void exponential(int n, const double *A, double tau, bool sizes, double *E)
{
	double *term = ARRAY(double, (size_t)(n * n)), *next = ARRAY(double, (size_t)(n * n));
	for (int i = 0; i < n * n; i++)
		E[i] = term[i] = i % n == i / n;
	for (int k = 1; k < 60; k++) {
		for (int i = 0; i < n; i++)
			for (int j = 0; j < n; j++) {
				double sum = 0;
				for (int m = 0; m < n; m++)
					sum += term[i * n + m] * (sizes ? fabs(A[m * n + j]) : A[m * n + j]);
				next[i * n + j] = sum * tau / k;
			}
		double *swap = term;
		term = next;
		next = swap;
		for (int i = 0; i < n * n; i++)
			E[i] += term[i];
	}
}

static void times_matrix(int n, double *row, const double *A)
{
	double *product = ARRAY(double, (size_t)n);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			product[j] += row[i] * A[i * n + j];
	memcpy(row, product, (size_t)n * sizeof *row);
}

/* Entrywise bound of |row A^order e^{A tau}| over 0 .. d, times `factor`: part by part, growing within one by e^{|A| delta} */
static void bound_derivative(const struct emitter *e, const double *A, const double *expression, int order, double d, double factor, double *bound)
{
	enum { PARTS = 8 };
	int n = e->step->series.size, pieces = PARTS;
	double delta = d / PARTS, *row = ARRAY(double, (size_t)n);
	double *E = ARRAY(double, (size_t)(n * n)), *growth = ARRAY(double, (size_t)(n * n));
	exponential(n, A, delta, false, E);
	exponential(n, A, delta, true, growth);
	memcpy(row, expression, (size_t)n * sizeof *row);
	for (int k = 0; k < order; k++)
		times_matrix(n, row, A);
	for (int k = 0; k < pieces; k++) {
		for (int j = 0; j < n; j++) {
			double most = 0;
			for (int i = 0; i < n; i++)
				most += fabs(row[i]) * growth[i * n + j];
			bound[j] = fmax(bound[j], most * factor * (1 + 1e-9));
		}
		times_matrix(n, row, E);
	}
}

/* ---- tables ---- */

static const char **entry_names(const struct emitter *e)
{
	const struct series *series = &e->step->series;
	const char **name = ARRAY(const char *, (size_t)series->size);
	for (int i = 0; i < e->system->states; i++)
		name[i] = e->model->state_name[i];
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && series->load[l] >= 0; k++)
			name[series->load[l] + k] = column_text(&e->system->load[l], k);
	for (int i = 0; i < e->system->inputs; i++) {
		name[series->input[i]] = e->system->input[i].name;
		if (e->system->input[i].first_order)
			name[series->input[i] + 1] = format("%s'", e->system->input[i].name);
	}
	return name;
}

static const char **expression_names(const struct emitter *e)
{
	const struct switching *s = regions_of(e);
	const char **name = ARRAY(const char *, (size_t)s->expressions);
	for (int i = 0; i < s->expressions; i++)
		name[i] = form_text(e->step->shown->model, e->step->shown->model->switching->expression[i].form);
	return name;
}

static void emit_matrices(const struct emitter *e, const char *name, const char *note, double *(*of)(const struct emitter *, int))
{
	int size = e->step->series.size;
	fprintf(e->to, "\nstatic const double %s_%s[%d][%d][%d] = {  /* %s */\n", e->name, name, e->step->branches, size, size, note);
	for (int k = 0; k < e->step->branches; k++) {
		fputs("  {\n", e->to);
		emit_number_rows(e, size, size, of(e, k), entry_names(e));
		fputs("  },\n", e->to);
	}
	fputs("};\n", e->to);
}

static void emit_rows(const struct emitter *e)
{
	const struct switching *s = regions_of(e);
	int size = e->step->series.size;
	double *row = ARRAY(double, (size_t)(s->expressions * size));
	for (int i = 0; i < s->expressions; i++)
		memcpy(row + i * size, row_of(e, &s->expression[i]), (size_t)size * sizeof *row);
	fprintf(e->to, "\nstatic const double %s_row[%d][%d] = {  /* expressions that breakpoints divide */\n", e->name, s->expressions, size);
	emit_number_rows(e, s->expressions, size, row, expression_names(e));
	fputs("};\n", e->to);
}

static void emit_breakpoints(const struct emitter *e)
{
	const struct switching *s = regions_of(e);
	const char *count = "", *at = "";
	for (int i = 0; i < s->expressions; i++) {
		count = format("%s%s%d", count, i ? ", " : "", s->expression[i].breaks);
		for (int k = 0; k < s->expression[i].breaks; k++)
			at = format("%s%s%s", at, *at ? ", " : "", shortest(finite_number(e, s->expression[i].at[k])));
	}
	fprintf(e->to, "\nstatic const int %s_breaks[] = {%s};\nstatic const double %s_breakpoint[] = {%s};\n", e->name, count, e->name, at);
	fprintf(e->to, "\nstatic const int %s_matrix[%d] = {  /* of each region; -1: its inequalities cannot hold together */\n    ", e->name, s->regions);
	for (int r = 0; r < s->regions; r++)
		fprintf(e->to, "%s%d", r == 0 ? "" : r % 20 ? ", " : ",\n    ", s->region[r].possible ? s->region[r].system : -1);
	fputs("\n};\n\n", e->to);
	fprintf(e->to, "static const int %s_halvings[] = {", e->name);
	for (int k = 0; k < e->step->branches; k++)
		fprintf(e->to, "%s%d", k ? ", " : "", e->step->branch[k].halvings);
	fputs("};\n", e->to);
}

/* Of e over a piece d: d/3 times its slope, or a bound of d^2/8 times its second, d^4/384 times its fourth derivative */
static double *bound_of(const struct emitter *e, int k, const double *A, int expression, int order)
{
	int size = e->step->series.size;
	double d = ldexp(round_rational(e->model->h), -e->step->branch[k].halvings), factor = order == 1 ? d / 3 : order == 2 ? d * d / 8 : d * d * d * d / 384;
	double *row = row_of(e, &regions_of(e)->expression[expression]), *bound = ARRAY(double, (size_t)size);
	if (order > 1) {
		bound_derivative(e, A, row, order, d, factor, bound);
		for (int j = 0; j < size && e->model->asked.single; j++)
			bound[j] *= 1 + ldexp(1, -22);  /* still a bound when it is printed as a float */
		return bound;
	}
	times_matrix(size, row, A);
	for (int j = 0; j < size; j++)
		bound[j] = factor * row[j];
	return bound;
}

/* A row for each expression in each matrix */
static void emit_bound(const struct emitter *e, const char *name, const char *note, int order)
{
	const struct switching *s = regions_of(e);
	int size = e->step->series.size;
	fprintf(e->to, "\nstatic const double %s_%s[%d][%d][%d] = {  /* %s */\n", e->name, name, e->step->branches, s->expressions, size, note);
	for (int k = 0; k < e->step->branches; k++) {
		double *A = slopes_of(e, k), *value = ARRAY(double, (size_t)(s->expressions * size));
		for (int i = 0; i < s->expressions; i++)
			memcpy(value + i * size, bound_of(e, k, A, i, order), (size_t)size * sizeof *value);
		fputs("  {\n", e->to);
		emit_number_rows(e, s->expressions, size, value, expression_names(e));
		fputs("  },\n", e->to);
	}
	fputs("};\n", e->to);
}

void emit_regions(const struct emitter *e)
{
	const struct switching *s = regions_of(e);
	const char *n = e->name;
	emit_rows(e);
	emit_breakpoints(e);
	emit_matrices(e, "slopes", "x' = A x; x = states, load states, inputs", slopes_of);
	emit_matrices(e, "pieces", "e^{A d}, d = h 2^-halvings", phi_of);
	emit_bound(e, "lean", "d/3 times the slope of each expression", 1);
	emit_bound(e, "sag", "d^2/8 times its second derivative, at most", 2);
	emit_bound(e, "sway", "d^4/384 times its fourth derivative, at most", 4);
	fprintf(e->to, "\nstatic const pl_switching %s_switching = {\n    %d, %s_H, %d, %s_row[0], %s_breaks, %s_breakpoint, %s_matrix, %s_halvings,\n", n,
		e->step->series.size, e->upper, s->expressions, n, n, n, n, n);
	fprintf(e->to, "    %s_slopes[0][0], %s_pieces[0][0], %s_lean[0][0], %s_sag[0][0], %s_sway[0][0], %d, %s_MAX_EVENTS, %d\n};\n", n, n, n, n, n,
		e->step->series.degree, e->upper, MAX_SPLITS);
}

/* ---- in the model's own functions ---- */

void emit_region_declarations(const struct emitter *e)
{
	const char *n = e->name;
	fprintf(e->to, "int    %s_region(const %s *s);           /* its number: an interval of each expression, see the source */\n", n, n);
	fprintf(e->to, "uint64_t %s_crossed(const %s *s);        /* breakpoints crossed since init or set */\n", n, n);
	fprintf(e->to, "int    %s_crossings(const %s *s, pl_crossing crossing[%s_MAX_EVENTS]);  /* those of the last step; how many */\n", n, n, e->upper);
}

void emit_region_members(const struct emitter *e)
{
	fprintf(e->to, "    pl_contact contact;   /* region, crossings */\n    pl_crossing crossing[%s_MAX_EVENTS];  /* of the last step */\n", e->upper);
}

static bool *needed_loads(const struct emitter *e)
{
	bool *needed = ARRAY(bool, (size_t)e->system->loads);
	for (int l = 0; l < e->system->loads; l++)
		needed[l] = e->step->series.load[l] >= 0;
	return needed;
}

/* x from y; `u`: the samples, slope: of ramps, or NULL */
static void emit_x(const struct emitter *e, const char *y, bool step)
{
	const struct series *series = &e->step->series;
	fprintf(e->to, "    for (i = 0; i < %s_STATES; i++)\n        x[i] = %s[i];\n", e->upper, y);
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && series->load[l] >= 0; k++) {
			const char *operand = load_operand(e, l, k);
			fprintf(e->to, "    x[%d] = %s;\n", series->load[l] + k, operand ? operand : "1.0");
		}
	for (int i = 0; i < e->system->inputs; i++) {
		bool ramp = e->system->input[i].first_order;
		fprintf(e->to, "    x[%d] = %s[%d];\n", series->input[i], step && !ramp ? "u" : "s->u", i);
		if (ramp && step)
			fprintf(e->to, "    x[%d] = (u[%d] - s->u[%d]) / %s_H;\n", series->input[i] + 1, i, i, e->upper);
		else if (ramp)
			fprintf(e->to, "    x[%d] = 0.0;\n", series->input[i] + 1);
	}
}

static void declare_room(const struct emitter *e)
{
	fprintf(e->to, "    double x[%d], work[PL_SWITCHING_WORK(%d, %d, %d)];\n", e->step->series.size, e->step->series.size, regions_of(e)->expressions,
		e->step->series.degree);
}

void emit_region_start(const struct emitter *e)
{
	fprintf(e->to, "\n/* The region of a state */\nstatic void %s_place(%s *s)\n{\n    int i;\n", e->name, e->name);
	declare_room(e);
	emit_load_states(e, needed_loads(e), false);
	emit_x(e, "s->y", false);
	fprintf(e->to, "    pl_switching_start(&%s_switching, x, &s->contact, work);\n}\n", e->name);
}

void emit_region_step(const struct emitter *e)
{
	const char *n = e->name, *N = e->upper;
	fprintf(e->to, "\nvoid %s_step(%s)\n{\n    int i;\n", n, step_parameters(e));
	declare_room(e);
	emit_set_aside(e);
	emit_load_states(e, needed_loads(e), false);
	emit_x(e, "s->y", true);
	fprintf(e->to, "    pl_switching_step(&%s_switching, x, &s->contact, s->crossing, work);\n", n);
	fprintf(e->to, "    for (i = 0; i < %s_STATES; i++)\n        s->y[i] = x[i];\n", N);
	emit_take_back(e);
	emit_step_end(e);
	fprintf(e->to, "    s->status |= s->contact.status | pl_not_finite(s->y, %s_STATES);\n}\n", N);
	fprintf(e->to, "\nint %s_region(const %s *s)\n{\n    return s->contact.region;\n}\n", n, n);
	fprintf(e->to, "\nuint64_t %s_crossed(const %s *s)\n{\n    return s->contact.total;\n}\n", n, n);
	fprintf(e->to, "\nint %s_crossings(const %s *s, pl_crossing crossing[%s_MAX_EVENTS])\n{\n", n, n, N);
	fprintf(e->to, "    const int count = s->contact.crossings < %s_MAX_EVENTS ? s->contact.crossings : %s_MAX_EVENTS;\n    int i;\n", N, N);
	fputs("    for (i = 0; i < count; i++)\n        crossing[i] = s->crossing[i];\n    return count;\n}\n", e->to);
}

void emit_region_at(const struct emitter *e)
{
	const char *u = e->system->inputs ? format("const double u[%s_INPUTS], ", e->upper) : "";
	fprintf(e->to, "\nvoid %s_at(const %s *s, %sdouble tau, double y[%s_STATES])\n{\n    pl_contact contact = s->contact;\n", e->name, e->name, u, e->upper);
	fprintf(e->to, "    pl_crossing crossing[%s_MAX_EVENTS];\n    int i;\n", e->upper);
	declare_room(e);
	emit_load_states(e, needed_loads(e), false);
	emit_x(e, "s->y", true);
	fprintf(e->to, "    pl_switching_advance(&%s_switching, tau, x, &contact, crossing, work);\n", e->name);
	emit_hand_over(e);
	fputs("}\n", e->to);
}
