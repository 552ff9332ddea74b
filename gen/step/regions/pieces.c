/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a piecewise-linear model finds its crossings with: the switching functions that breakpoints divide, and how fast
 * each may change within a piece of the step. */
#include "inner.h"
#include "model/tunable/elsewhere.h"
#include "model/regions/switching_functions.h"
#include "model/regions/regions.h"

#include <math.h>
#include <string.h>

double *full_step_of(const struct step *step, int branch)
{
	return Phi_over(step, step->branch[branch].full, 0);
}

static double *finite_slopes(const struct step *step, int branch)
{
	int cells = step->layout.size * step->layout.size;
	double *A = slopes_of(step, branch);
	for (int i = 0; i < cells; i++)
		if (!isfinite(A[i]))
			report_range(step);
	return A;
}

/* ---- switching functions as rows over x ---- */

static double word_of(const struct step *step, mpq_srcptr number, bool second)
{
	struct coefficient c = equation_number(step->model, number);
	return second ? c.low : c.value;
}

static void fill_row(const struct step *step, const struct output *function, int segment, bool second, double *row)
{
	const int size = step->layout.size;
	RATIONALS *exact = rationals(size);
	row_of_output(&step->layout, &step->branch->system, function, step->shown->model->system.segments, segment,
		      exact);
	for (int i = 0; i < size; i++)
		row[i] = word_of(step, exact[i], second);
}

void row_over_x(const struct step *step, const struct output *function, int segment, double *row)
{
	fill_row(step, function, segment, false, row);
}

void row_in_words(const struct step *step, const struct output *function, int segment, double *row)
{
	fill_row(step, function, segment, false, row);
	fill_row(step, function, segment, true, row + step->layout.size);
}

static double **rows_of(const struct step *step)
{
	const struct switching *s = step->model->switching;
	double **row = ARRAY(double *, s->segments);
	for (int segment = 0; segment < s->segments; segment++) {
		row[segment] = ARRAY(double, (size_t)s->functions * (size_t)step->layout.size);
		for (int i = 0; i < s->functions; i++)
			row_over_x(step, s->function[i].row, segment, row[segment] + i * step->layout.size);
	}
	return row;
}

static double *breakpoints_of(const struct step *step)
{
	const struct switching *s = step->model->switching;
	int count = 0;
	for (int i = 0; i < s->functions; i++)
		count += s->function[i].breaks;
	double *breakpoint = ARRAY(double, count), *next = breakpoint;
	for (int i = 0; i < s->functions; i++)
		for (int k = 0; k < s->function[i].breaks; k++)
			*next++ = equation_number(step->model, s->function[i].at[k]).value;
	return breakpoint;
}

/* ---- bounds: no numbers of the model, so doubles rounded up a little will do ---- */

/* Do terms, of which each is at most half of the one before, change no digit of E any more? */
static bool are_lost(int n, const double *term, const double *E)
{
	double least = INFINITY;
	for (int i = 0; i < n * n; i++)
		least = E[i] != 0 ? fmin(least, fabs(E[i])) : least;
	return norm_of_rows(n, term) < ldexp(least, -60);
}

static void exponential(int n, const double *A, double tau, bool sizes, double *E)
{
	const double turn = norm_of_rows(n, A) * tau;
	SCRATCH double *term = ARRAY(double, (size_t)(n * n)), *next = ARRAY(double, (size_t)(n * n));
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
		if (k >= n && turn < 0.5 * k && are_lost(n, term, E))   /* what is 0 now, no power of A reaches */
			break;
	}
}

static void times_matrix(int n, double *row, const double *A)
{
	SCRATCH double *product = ARRAY(double, n);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			product[j] += row[i] * A[i * n + j];
	memcpy(row, product, (size_t)n * sizeof *row);
}

enum { PARTS = 8 };                 /* of a piece: within one, a derivative grows by e^{|A| d / PARTS} at most */
struct growth {                     /* over a part: e^{A d / PARTS}, e^{|A| d / PARTS}, size x size, in one block */
	double *E, *most;
};

static struct growth growth_of(int n, const double *A, double d)
{
	size_t cells = (size_t)n * (size_t)n;
	double *both = ARRAY(double, 2 * cells);
	struct growth growth = { both, both + cells };
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

/* factor times the slopes of so many rows */
static void slope_rows(int size, int count, const double *rows, const double *A, double factor, double *slope)
{
	memcpy(slope, rows, (size_t)count * (size_t)size * sizeof *slope);
	for (int i = 0; i < count; i++)
		times_matrix(size, slope + i * size, A);
	for (int j = 0; j < count * size; j++)
		slope[j] = factor * slope[j];
}

/* factor times a bound of their derivatives of this order */
static void bound_rows(const struct step *step, int count, const double *rows, const double *A,
		       const struct growth *growth, int order, double factor, double *bound)
{
	int size = step->layout.size;
	SCRATCH double *row = ARRAY(double, size);
	for (int i = 0; i < count; i++) {
		memcpy(row, rows + i * size, (size_t)size * sizeof *row);
		for (int k = 0; k < order; k++)
			times_matrix(size, row, A);
		bound_row(size, growth, row, factor, bound + i * size);
	}
	for (int j = 0; j < count * size && step->model->request.single; j++)
		bound[j] *= 1 + ldexp(1, -22);          /* still a bound when it is printed as a float */
}

void bend_of_row(const struct step *step, const double *A, double h, const double *row, double *bend)
{
	struct growth growth = growth_of(step->layout.size, A, h);
	bound_rows(step, 1, row, A, &growth, 2, h * h / 8, bend);
	discard(growth.E);
}

void bounds_of_rows(const struct step *step, const struct pieces *pieces, int branch, int rows, const double *row,
		    double *slope, double *second, double *fourth)
{
	const double *A = pieces->piece[branch].slopes;
	double d = ldexp(round_rational(step->model->h), -step->branch[branch].halvings);
	struct growth growth = growth_of(step->layout.size, A, d);
	slope_rows(step->layout.size, rows, row, A, d / 3, slope);
	bound_rows(step, rows, row, A, &growth, 2, d * d / 8, second);
	bound_rows(step, rows, row, A, &growth, 4, d * d * d * d / 384, fourth);
	discard(growth.E);
}

/* Room for a row of each switching function */
static double *rows_new(const struct step *step)
{
	return ARRAY(double, (size_t)step->model->switching->functions * (size_t)step->layout.size);
}

static void fill_bounds(const struct step *step, const struct pieces *pieces, int branch)
{
	struct region_piece *piece = &pieces->piece[branch];
	int functions = step->model->switching->functions;
	piece->slope = rows_new(step);
	piece->second = rows_new(step);
	piece->fourth = rows_new(step);
	bounds_of_rows(step, pieces, branch, functions, piece->row, piece->slope, piece->second, piece->fourth);
	piece->reach = reach_of_rows(step, branch, piece->slopes, functions, piece->row);
}

/* ---- a step over the whole of h, which most often a bound shows to be event-free ---- */

/* The least and the largest that each switching function may be: region by region, switching functions of each */
static void fill_intervals(const struct step *step, struct pieces *pieces)
{
	const struct switching *s = step->model->switching;
	size_t cells = (size_t)s->regions * (size_t)s->functions;
	pieces->low = ARRAY(double, cells);
	pieces->high = ARRAY(double, cells);
	for (int r = 0; r < s->regions; r++)
		for (int i = 0, first = 0; i < s->functions; first += s->function[i++].breaks) {
			int interval = interval_of(s, r, i), cell = r * s->functions + i;
			const double *at = pieces->breakpoint + first + interval;
			pieces->low[cell] = interval > 0 ? at[-1] : -OPEN_END;
			pieces->high[cell] = interval < s->function[i].breaks ? at[0] : OPEN_END;
		}
}

static bool *bounded_entries(const struct step *step)
{
	bool *bounded = ARRAY(bool, step->layout.size);
	for (int l = 0; l < step->branch->system.loads; l++)
		for (int k = 0; k < step->branch->system.load[l].columns && is_bounded_load(step, l); k++)
			bounded[step->layout.load[l] + k] = true;
	return bounded;
}

double size_of_bounded(const struct step *step, const double *row)
{
	SCRATCH bool *bounded = bounded_entries(step);
	double size = 0;
	for (int j = 0; j < step->layout.size; j++)
		size += bounded[j] ? fabs(row[j]) : 0;
	return size;
}

/* What loads that are never above 1 add to a bound over x goes from there to *still. */
static void fold_loads(const struct step *step, double *bound, double *still)
{
	for (int l = 0; l < step->branch->system.loads; l++) {
		const struct load *load = &step->branch->system.load[l];
		double *at = bound + step->layout.load[l];
		if (!is_bounded_load(step, l))
			continue;
		*still += load->columns == 2 ? hypot(at[0], at[1]) : at[0];
		for (int k = 0; k < load->columns; k++)
			at[k] = 0;
	}
	*still *= step->model->request.single ? 1 + ldexp(1, -22) : 1 + 1e-9;
}

/* h |e'|, which is above |e|, of what a Taylor polynomial of this degree leaves out over 0 .. h, and what rounding may
 * add to its terms, whose chains are as long as their order; all of them are added up */
static void add_slack(int size, const double *A, double h, int degree, double epsilon, double *term, double *slack)
{
	enum { FURTHER = 40 };
	SCRATCH double *next = ARRAY(double, size);
	for (int k = 1; k <= degree + FURTHER; k++) {
		for (int j = 0; j < size; j++) {
			next[j] = 0;
			for (int m = 0; m < size; m++)
				next[j] += term[m] * fabs(A[m * size + j]) * h / k;
		}
		for (int j = 0; j < size; j++) {
			double part = k > degree ? 1 : epsilon * ((k + 2) * (size + 2) + degree);
			slack[j] += part * k * next[j] * (1 + 1e-9);
			term[j] = next[j];
		}
	}
}

/* That number at the first of their places */
static void gather_loads(const struct step *step, const bool *bounded, double *bound)
{
	double still = 0;
	int first = 0;
	while (first < step->layout.size && !bounded[first])
		first++;
	fold_loads(step, bound, &still);
	if (first < step->layout.size)
		bound[first] = still;
}

static double *slack_rows(const struct step *step, const double *rows, const double *A, int degree)
{
	int size = step->layout.size, functions = step->model->switching->functions;
	SCRATCH double *term = ARRAY(double, size);
	double *slack = ARRAY(double, (size_t)(functions * size));
	double epsilon = ldexp(1, step->model->request.single ? -23 : -52);
	for (int i = 0; i < functions; i++) {
		for (int j = 0; j < size; j++) {
			term[j] = fabs(rows[i * size + j]);
			slack[i * size + j] = 8 * epsilon * term[j];    /* as in the search */
		}
		add_slack(size, A, round_rational(step->model->h), degree, epsilon, term, slack + i * size);
	}
	return slack;
}

/* h A, rounded once */
static double *turns_of(const struct step *step, int branch)
{
	size_t cells = (size_t)step->layout.size * (size_t)step->layout.size;
	RATIONALS *exact = augmented_matrix(&step->layout, &step->branch[branch].system, 0);
	double *turns = ARRAY(double, cells);
	for (size_t i = 0; i < cells; i++) {
		mpq_mul(exact[i], exact[i], step->model->h);
		turns[i] = round_rational(exact[i]);
	}
	return turns;
}

static void fill_full(const struct step *step, const struct pieces *pieces, int branch)
{
	struct region_piece *piece = &pieces->piece[branch];
	double h = round_rational(step->model->h);
	struct growth growth = growth_of(step->layout.size, piece->slopes, h);
	piece->off = rows_new(step);
	piece->still = ARRAY(double, step->model->switching->functions);
	bound_rows(step, step->model->switching->functions, piece->row, piece->slopes, &growth, 2, h * h / 8,
		   piece->off);
	discard(growth.E);
}

static void fill_crossing(const struct step *step, const struct pieces *pieces, int branch)
{
	struct region_piece *piece = &pieces->piece[branch];
	int size = step->layout.size, functions = step->model->switching->functions;
	double h = round_rational(step->model->h);
	struct growth growth = growth_of(size, piece->slopes, h);
	piece->turn = rows_new(step);
	piece->third = rows_new(step);
	piece->bend = rows_new(step);
	slope_rows(size, functions, piece->row, piece->slopes, h / 3, piece->turn);
	bound_rows(step, functions, piece->row, piece->slopes, &growth, 3, h * h * h / 24, piece->third);
	bound_rows(step, functions, piece->row, piece->slopes, &growth, 4, h * h * h * h / 384, piece->bend);
	piece->turns = turns_of(step, branch);
	piece->slack = slack_rows(step, piece->row, piece->slopes, pieces->degree);
	for (int i = 0; i < functions; i++) {
		fold_loads(step, piece->off + i * size, &piece->still[i]);
		gather_loads(step, pieces->bounded, piece->slack + i * size);
		gather_loads(step, pieces->bounded, piece->third + i * size);
	}
	discard(growth.E);
}

/* Below this size of all entries of x together, no number of a step overflows */
static double largest_of(const struct step *step, const struct pieces *pieces)
{
	int cells = step->layout.size * step->layout.size;
	double factor = 1;
	for (int k = 0; k < step->branches; k++)
		for (int i = 0; i < cells; i++)
			factor = fmax(factor, fabs(pieces->piece[k].Phi[i]));
	return ldexp(step->model->request.single ? LARGE_FLOAT : LARGE_ENOUGH, -ilogb(factor));
}

/* 1/k!, k = 0 .. degree */
static double *weights_of(const struct step *step)
{
	double *weight = ARRAY(double, step->regions.event_check.degree + 1);
	RATIONAL factorial = ZERO;
	for (int k = 0; k <= step->regions.event_check.degree; k++) {
		mpz_fac_ui(mpq_denref(factorial), (unsigned long)k);
		mpz_set_ui(mpq_numref(factorial), 1);
		weight[k] = round_rational(factorial);
	}
	return weight;
}

static void fill_check(const struct step *step, struct pieces *pieces)
{
	pieces->bounded = bounded_entries(step);
	for (int k = 0; k < step->branches; k++)
		fill_full(step, pieces, k);
	pieces->large = largest_of(step, pieces);
}

static void fill_fast_path(const struct step *step, struct pieces *pieces)
{
	pieces->degree = step->regions.event_check.degree;
	pieces->weight = weights_of(step);
	fill_intervals(step, pieces);
	for (int k = 0; k < step->branches; k++)
		fill_crossing(step, pieces, k);
}

struct pieces pieces_of(const struct step *step)
{
	struct pieces pieces = { .rows = rows_of(step), .breakpoint = breakpoints_of(step),
				 .piece = ARRAY(struct region_piece, step->branches) };
	pieces.row = pieces.rows[0];
	for (int k = 0; k < step->branches; k++) {
		pieces.piece[k].slopes = finite_slopes(step, k);
		pieces.piece[k].row = pieces.rows[step->model->switching->system_segment[k]];
	}
	for (int k = 0; k < step->branches; k++) {
		pieces.piece[k].Phi = full_step_of(step, k);
		pieces.piece[k].gain = gain_of(step, step->branch[k].full, 0);
		pieces.piece[k].rung = rungs_of(step, k);
	}
	for (int k = 0; k < step->branches && step->model->switching->functions > 0; k++)
		fill_bounds(step, &pieces, k);
	if (step->regions.event_check.is_made)
		fill_check(step, &pieces);
	if (step->regions.event_check.fast_path)
		fill_fast_path(step, &pieces);
	else if (step->regions.event_check.is_made && step->model->params.retuned)
		gather(step, &pieces);
	return pieces;
}
