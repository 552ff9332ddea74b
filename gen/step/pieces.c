/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a piecewise-linear model finds its crossings with: e^{A d} of its regions for pieces d of the step, the
 * expressions that breakpoints divide, and how fast each may change within a piece. */
#include "step/step.h"

#include <math.h>
#include <string.h>

/* ---- e^{A d} of a region over x = states, load states, inputs ---- */

/* The load states among themselves */
static void fill_load_states(const struct step *step, mpq_srcptr d, double *Phi)
{
	const struct layout *layout = &step->layout;
	const struct linear *system = &step->branch->system;
	for (int l = 0; l < system->loads; l++) {
		const struct load *load = &system->load[l];
		int n = load->columns, at = layout->load[l];
		for (int i = 0; i < n * n && at >= 0; i++) {
			struct response *response = response_of_load_state(load, i / n, i % n);
			const char *what = column_text(load, i / n);
			Phi[(at + i / n) * layout->size + at + i % n] =
				response_value(response, d, false, step->model->asked.step_at, what).value;
		}
	}
}

static void fill_input_states(const struct step *step, mpq_srcptr d, double *Phi)
{
	const struct layout *layout = &step->layout;
	for (int i = 0; i < step->branch->system.inputs; i++) {
		int at = layout->input[i];
		Phi[at * layout->size + at] = 1;
		if (!step->branch->system.input[i].hold)
			continue;
		Phi[at * layout->size + at + 1] = round_rational(d);
		Phi[(at + 1) * layout->size + at + 1] = 1;
	}
}

/* u, and of a ramp u': held, and as the slope of u */
static void fill_inputs(const struct step *step, const struct table *table, double *Phi)
{
	const struct layout *layout = &step->layout;
	for (int row = 0; row < table->states; row++)
		for (int i = 0; i < step->branch->system.inputs; i++) {
			const struct coefficient *held = &table->kernel[0][row * table->channels];
			const struct coefficient *ramp = &table->kernel[1][row * table->channels];
			double *cell = Phi + row * layout->size + layout->input[i];
			cell[0] = held[2 * i].value;
			if (step->branch->system.input[i].hold)
				cell[1] = ramp[2 * i].value + held[2 * i + 1].value;
		}
}

static void fill_state_rows(const struct step *step, const struct table *table, double *Phi)
{
	const struct layout *layout = &step->layout;
	const struct linear *system = &step->branch->system;
	for (int i = 0; i < table->states; i++) {
		double *row = Phi + i * layout->size;
		for (int j = 0; j < table->states; j++)
			row[j] = table->Phi[i * table->states + j].value;
		for (int l = 0, column = 0; l < system->loads; column += system->load[l++].columns)
			for (int k = 0; k < system->load[l].columns && layout->load[l] >= 0; k++)
				row[layout->load[l] + k] = table->load[i * table->columns + column + k].value;
	}
}

static double *Phi_of(const struct step *step, int branch)
{
	const struct table *table = step->branch[branch].table[0];
	double *Phi = ARRAY(double, (size_t)step->layout.size * (size_t)step->layout.size);
	mpq_t d;
	mpq_init(d);
	mpq_div_2exp(d, step->model->h, (mp_bitcnt_t)step->branch[branch].halvings);
	fill_state_rows(step, table, Phi);
	fill_inputs(step, table, Phi);
	fill_load_states(step, d, Phi);
	fill_input_states(step, d, Phi);
	mpq_clear(d);
	return Phi;
}

static double *finite_slopes(const struct step *step, int branch)
{
	int cells = step->layout.size * step->layout.size;
	double *A = slopes_of(step, branch);
	for (int i = 0; i < cells; i++)
		if (!isfinite(A[i]))
			tell_range(step);
	return A;
}

/* ---- expressions as rows over x ---- */

void row_over_x(const struct step *step, const struct output *expression, double *row)
{
	const struct layout *layout = &step->layout;
	const struct linear *system = &step->branch->system;
	for (int i = 0; i < system->states; i++)
		row[i] = equation_number(step->model, expression->state[i]).value;
	for (int l = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns && layout->load[l] >= 0; k++)
			row[layout->load[l] + k] = equation_number(step->model, expression->load[l][k]).value;
	for (int i = 0; i < system->inputs; i++) {
		row[layout->input[i]] = equation_number(step->model, expression->input[0][i]).value;
		if (system->input[i].hold)
			row[layout->input[i] + 1] = equation_number(step->model, expression->input[1][i]).value;
	}
}

static double *rows_of(const struct step *step)
{
	const struct switching *s = step->model->switching;
	double *row = ARRAY(double, (size_t)s->expressions * (size_t)step->layout.size);
	for (int i = 0; i < s->expressions; i++)
		row_over_x(step, s->expression[i].row, row + i * step->layout.size);
	return row;
}

static double *breakpoints_of(const struct step *step)
{
	const struct switching *s = step->model->switching;
	int count = 0;
	for (int i = 0; i < s->expressions; i++)
		count += s->expression[i].breaks;
	double *breakpoint = ARRAY(double, (size_t)count), *next = breakpoint;
	for (int i = 0; i < s->expressions; i++)
		for (int k = 0; k < s->expression[i].breaks; k++)
			*next++ = equation_number(step->model, s->expression[i].at[k]).value;
	return breakpoint;
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
	discard(term);
	discard(next);
}

static void times_matrix(int n, double *row, const double *A)
{
	double *product = ARRAY(double, (size_t)n);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			product[j] += row[i] * A[i * n + j];
	memcpy(row, product, (size_t)n * sizeof *row);
	discard(product);
}

enum { PARTS = 8 };                 /* of a piece: within one, a derivative grows by e^{|A| d / PARTS} at most */
struct growth {                     /* over a part: e^{A d / PARTS}, e^{|A| d / PARTS}, size x size */
	double *E, *most;
};

static struct growth growth_of(int n, const double *A, double d)
{
	size_t cells = (size_t)n * (size_t)n;
	struct growth growth = { ARRAY(double, cells), ARRAY(double, cells) };
	exponential(n, A, d / PARTS, false, growth.E);
	exponential(n, A, d / PARTS, true, growth.most);
	return growth;
}

/* Entrywise bound of |row e^{A tau}| over 0 .. d, times `factor`: part by part; `row` is lost */
static void bound_row(int n, const struct growth *growth, double *row, double factor, double *bound)
{
	for (int k = 0; k < PARTS; k++) {
		for (int j = 0; j < n; j++) {
			double most = 0;
			for (int i = 0; i < n; i++)
				most += fabs(row[i]) * growth->most[i * n + j];
			bound[j] = fmax(bound[j], most * factor * (1 + 1e-9));
		}
		times_matrix(n, row, growth->E);
	}
}

/* factor times the slope of each expression */
static double *slope_rows(const struct step *step, const struct pieces *pieces, const double *A, double factor)
{
	int size = step->layout.size, expressions = step->model->switching->expressions;
	double *slope = ARRAY(double, (size_t)expressions * (size_t)size);
	memcpy(slope, pieces->row, (size_t)expressions * (size_t)size * sizeof *slope);
	for (int i = 0; i < expressions; i++)
		times_matrix(size, slope + i * size, A);
	for (int j = 0; j < expressions * size; j++)
		slope[j] = factor * slope[j];
	return slope;
}

/* factor times a bound of each expression's derivative of this order */
static double *bound_rows(const struct step *step, const struct pieces *pieces, const double *A,
			  const struct growth *growth, int order, double factor)
{
	int size = step->layout.size, expressions = step->model->switching->expressions;
	double *bound = ARRAY(double, (size_t)expressions * (size_t)size), *row = ARRAY(double, (size_t)size);
	for (int i = 0; i < expressions; i++) {
		memcpy(row, pieces->row + i * size, (size_t)size * sizeof *row);
		for (int k = 0; k < order; k++)
			times_matrix(size, row, A);
		bound_row(size, growth, row, factor, bound + i * size);
	}
	for (int j = 0; j < expressions * size && step->model->asked.single; j++)
		bound[j] *= 1 + ldexp(1, -22);          /* still a bound when it is printed as a float */
	discard(row);
	return bound;
}

void bend_of_row(const struct step *step, const double *A, double h, const double *row, double *bend)
{
	int size = step->layout.size;
	struct growth growth = growth_of(size, A, h);
	double *second = ARRAY(double, (size_t)size);
	memcpy(second, row, (size_t)size * sizeof *row);
	times_matrix(size, second, A);
	times_matrix(size, second, A);
	bound_row(size, &growth, second, h * h / 8, bend);
	for (int j = 0; j < size && step->model->asked.single; j++)
		bend[j] *= 1 + ldexp(1, -22);           /* still a bound when it is printed as a float */
	discard(growth.E);
	discard(growth.most);
	discard(second);
}

static void fill_bounds(const struct step *step, const struct pieces *pieces, int branch)
{
	struct region_piece *piece = &pieces->piece[branch];
	double d = ldexp(round_rational(step->model->h), -step->branch[branch].halvings);
	struct growth growth = growth_of(step->layout.size, piece->slopes, d);
	piece->slope = slope_rows(step, pieces, piece->slopes, d / 3);
	piece->second = bound_rows(step, pieces, piece->slopes, &growth, 2, d * d / 8);
	piece->fourth = bound_rows(step, pieces, piece->slopes, &growth, 4, d * d * d * d / 384);
	discard(growth.E);
	discard(growth.most);
}

struct pieces pieces_of(const struct step *step)
{
	struct pieces pieces = { rows_of(step), breakpoints_of(step),
				 ARRAY(struct region_piece, (size_t)step->branches) };
	for (int k = 0; k < step->branches; k++)
		pieces.piece[k].slopes = finite_slopes(step, k);
	for (int k = 0; k < step->branches; k++)
		pieces.piece[k].Phi = Phi_of(step, k);
	for (int k = 0; k < step->branches; k++)
		fill_bounds(step, &pieces, k);
	return pieces;
}
