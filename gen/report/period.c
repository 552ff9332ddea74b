/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One period of a harmonic excitation over a piecewise-linear model, in double: e^{A h} of the region from one sample
 * to the next, crossings of breakpoints bracketed to rounding, where the region changes. How the end follows from the
 * start is the product of the exponentials that were passed, and at a crossing where a force jumps of what the jump
 * does to a shift in time (Aizerman and Gantmakher 1958). */
#include "model/regions/switching_functions.h"
#include "model/regions/regions.h"
#include "report/report.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

/* z = [y, a cos(w t), a sin(w t), 1] */
enum { OVER = 3, TERMS = 60, MOST_CROSSINGS = 2000 };
static const double two_pi = 6.283185307179586;

static void matrix_product(int n, const double *a, const double *b, double *to)
{
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			double sum = 0;
			for (int k = 0; k < n; k++)
				sum += a[i * n + k] * b[k * n + j];
			to[i * n + j] = sum;
		}
}

/* ---- the matrices ---- */

/* What acts on equation i: over a cos, over u' = -w a sin, and all the time */
static void forces_on(const struct linear *system, const struct drive *drive, int input, int i, mpq_t *over)
{
	for (int k = 0; k < OVER; k++)
		mpq_set_ui(over[k], 0, 1);
	for (int k = 0; k < 2 && input >= 0; k++)
		mpq_set(over[k], system->input[input].force[k][i]);
	for (int l = 0; l < system->loads; l++)
		for (int c = 0; c < system->load[l].columns; c++) {
			mpq_srcptr force = system->load[l].force[c][drive->segment * system->n + i];
			if (drive->input < 0 && drive->load == l && drive->column == c)
				mpq_add(over[0], over[0], force);
			else if (is_constant_column(system, column_of_load(system, l) + c))
				mpq_add(over[2], over[2], force);
		}
}

/* z' = A z; columns of a sin are those of u', to be multiplied by -w */
static double *matrix_of(const struct linear *system, const struct drive *drive, int input)
{
	int n = system->n, states = system->states, size = states + OVER;
	double *A = ARRAY(double, (size_t)size * (size_t)size);
	RATIONALS *free = state_matrix(system, false), *inverse = inverse_of_leading(system);
	RATIONALS *over = rationals((size_t)(OVER * n)), *row = rationals(OVER);
	for (int i = 0; i < n; i++)
		forces_on(system, drive, input, i, over + OVER * i);
	for (int i = 0; i < states; i++)
		for (int j = 0; j < states; j++)
			A[i * size + j] = mpq_get_d(free[i * states + j]);
	for (int i = 0; i < n; i++) {
		int state = highest_state(system, i);
		for (int k = 0; k < OVER; k++) {
			mpq_set_ui(row[k], 0, 1);
			for (int j = 0; j < n; j++)
				rational_addmul(row[k], inverse[i * n + j], over[OVER * j + k]);
			A[state * size + states + k] = mpq_get_d(row[k]);
		}
	}
	return A;
}

/* A row over z; its column of a sin as above */
static double *row_of(const struct linear *system, const struct output *row, const struct drive *drive, int input)
{
	double *over = ARRAY(double, (size_t)(system->states + OVER)), *rest = over + system->states;
	for (int j = 0; j < system->states; j++)
		over[j] = mpq_get_d(row->state[j]);
	for (int k = 0; k < 2 && input >= 0; k++)
		rest[k] = mpq_get_d(row->input[k][input]);
	for (int l = 0; l < system->loads; l++)
		for (int c = 0; c < system->load[l].columns; c++) {
			double factor = mpq_get_d(row->load[l][c * system->segments + drive->segment]);
			if (drive->input < 0 && drive->load == l && drive->column == c)
				rest[0] += factor;
			else if (is_constant_column(system, column_of_load(system, l) + c))
				rest[2] += factor;
		}
	return over;
}

/* The largest modulus of a pole [1/s] */
static double rate_of(int states, int size, const double *A)
{
	SCRATCH double *free = ARRAY(double, (size_t)states * (size_t)states);
	for (int i = 0; i < states; i++)
		memcpy(free + i * states, A + i * size, sizeof(double) * (size_t)states);
	return spectral_radius(states, free);
}

/* ---- what moves on its own ---- */

static void take_switching(struct mover *m, const struct switching *s, const struct drive *drive, int input)
{
	const struct linear *first = &s->system[0];
	m->states = first->states;
	m->size = m->states + OVER;
	m->systems = s->systems;
	m->A = ARRAY(double *, s->systems);
	m->at = ARRAY(double *, s->systems);
	m->E = ARRAY(double *, s->systems);
	for (int k = 0; k < s->systems; k++) {
		m->A[k] = matrix_of(&s->system[k], drive, input);
		m->at[k] = ARRAY(double, (size_t)m->size * (size_t)m->size);
		m->E[k] = ARRAY(double, (size_t)m->size * (size_t)m->size);
		m->rate = fmax(m->rate, rate_of(m->states, m->size, m->A[k]));
	}
	m->of = s;
	m->row = ARRAY(double *, s->functions + 1);
	m->row_at = ARRAY(double *, s->functions + 1);
	m->limit = ARRAY(double *, s->functions + 1);
	for (int e = 0; e < s->functions; e++) {
		const struct switching_function *x = &s->function[e];
		m->row[e] = row_of(first, x->row, drive, input);
		m->row_at[e] = ARRAY(double, m->size);
		m->limit[e] = ARRAY(double, x->breaks + 1);
		for (int i = 0; i < x->breaks; i++)
			m->limit[e][i] = mpq_get_d(x->at[i]);
	}
	m->known = ARRAY(bool, s->systems);
	for (int k = 0; k < WORK; k++)
		m->work[k] = ARRAY(double, m->size);
	for (int k = 0; k < 3; k++)
		m->square[k] = ARRAY(double, (size_t)m->size * (size_t)m->size);
	m->piece = ARRAY(double, (size_t)m->size * (size_t)m->size);
	m->integral[0] = ARRAY(double, m->size);
	m->integral[1] = ARRAY(double, m->size);
}

int movers_of(const struct model *model, const struct drive *drive, struct mover **list)
{
	const struct switching *s = model->switching;
	int count = s->parts ? s->parts : 1;
	*list = ARRAY(struct mover, count);
	for (int p = 0; p < count; p++) {
		const struct region_part *part = s->parts ? &s->part[p] : NULL;
		int input = part ? -1 : drive->input;
		for (int i = 0; part && i < part->model->system.inputs; i++)
			if (part->input[i] == drive->input)
				input = i;
		take_switching(&(*list)[p], part ? part->model->switching : s, drive, input);
		(*list)[p].place = part ? part->state : NULL;
	}
	return count;
}

double *output_over(const struct model *model, int output, const struct drive *drive)
{
	return row_of(&model->system, &model->output[output], drive, drive->input);
}

/* ---- at one frequency ---- */

void mover_tune(struct mover *m, double w)
{
	int size = m->size, c = m->states, s = c + 1;
	enum { LEAST = 64 };
	m->w = w;
	m->period = two_pi / w;
	m->samples = (int)fmax(LEAST, ceil(2 * m->period * m->rate));
	for (int k = 0; k < m->systems; k++) {
		memcpy(m->at[k], m->A[k], sizeof(double) * (size_t)size * (size_t)size);
		for (int i = 0; i < m->states; i++)
			m->at[k][i * size + s] *= -w;
		m->at[k][c * size + s] = -w;
		m->at[k][s * size + c] = w;
		m->known[k] = false;
	}
	for (int e = 0; e < m->of->functions; e++) {
		memcpy(m->row_at[e], m->row[e], sizeof(double) * (size_t)size);
		m->row_at[e][s] *= -w;
	}
}

static void exponential(struct mover *m, int system, double t, double *E)
{
	int size = m->size;
	for (int i = 0; i < size * size; i++)
		m->square[0][i] = m->at[system][i] * t;
	gsl_matrix_view in = gsl_matrix_view_array(m->square[0], (size_t)size, (size_t)size);
	gsl_matrix_view out = gsl_matrix_view_array(E, (size_t)size, (size_t)size);
	gsl_linalg_exponential_ss(&in.matrix, &out.matrix, GSL_PREC_DOUBLE);
}

static double product(int size, const double *row, const double *z)
{
	double sum = 0;
	for (int i = 0; i < size; i++)
		sum += row[i] * z[i];
	return sum;
}

static void apply(int size, const double *A, const double *z, double *to)
{
	for (int i = 0; i < size; i++)
		to[i] = product(size, A + i * size, z);
}

/* e^{A t} z by its series, for t of a sample at most */
static void flow(struct mover *m, int system, double t, const double *z, double *to)
{
	int size = m->size;
	double *term = m->work[0], *next = m->work[1];
	memcpy(term, z, sizeof(double) * (size_t)size);
	memcpy(to, z, sizeof(double) * (size_t)size);
	for (int k = 1; k < TERMS; k++) {
		double largest = 0, size_of = 0;
		apply(size, m->at[system], term, next);
		for (int i = 0; i < size; i++) {
			term[i] = next[i] * t / k;
			to[i] += term[i];
			largest = fmax(largest, fabs(term[i]));
			size_of = fmax(size_of, fabs(to[i]));
		}
		if (largest <= 1e-19 * size_of)
			break;
	}
}

/* ---- regions ---- */

static int interval_at(const struct mover *m, int e, const double *z)
{
	double value = product(m->size, m->row_at[e], z);
	int i = 0;
	while (i < m->of->function[e].breaks && value > m->limit[e][i])
		i++;
	return i;
}

static int region_at(const struct mover *m, const double *z)
{
	int region = 0;
	for (int e = 0; e < m->of->functions; e++)
		region += interval_at(m, e, z) * m->of->function[e].stride;
	return region;
}

/* Where a row from g over t to h, with these slopes, may turn: of the cubic through them; up to two times */
static int turns_of(double t, double g, double slope, double h, double last, double *at)
{
	double d = h - g, a = 3 * (t * (slope + last) - 2 * d), b = 2 * (3 * d - t * (2 * slope + last)), c = t * slope;
	double discriminant = b * b - 4 * a * c;
	int count = 0;
	if (discriminant < 0)
		return 0;
	double q = -0.5 * (b + copysign(sqrt(discriminant), b));
	double root[2] = { a != 0 ? q / a : -1, q != 0 ? c / q : -1 };
	for (int i = 0; i < 2; i++)
		if (root[i] > 0 && root[i] < 1)
			at[count++] = root[i] * t;
	return count;
}

/* A time up to t at which the region is another, from z to end; 0: there is none. Turns inside are looked at. */
static double time_outside(struct mover *m, int system, int region, double t, const double *z, const double *end)
{
	double *slope = m->work[2], *last = m->work[3], *inside = m->work[4], first = 0;
	apply(m->size, m->at[system], z, slope);
	apply(m->size, m->at[system], end, last);
	for (int e = 0; e < m->of->functions; e++) {
		const double *row = m->row_at[e];
		double at[2];
		int turns = turns_of(t, product(m->size, row, z), product(m->size, row, slope),
				     product(m->size, row, end), product(m->size, row, last), at);
		for (int i = 0; i < turns; i++) {
			flow(m, system, at[i], z, inside);
			if (region_at(m, inside) != region && (first == 0 || at[i] < first))
				first = at[i];
		}
	}
	return first > 0 ? first : region_at(m, end) != region ? t : 0;
}

/* Into `to`, where the region has just become another, and when: between z and a time when it has */
static double crossing(struct mover *m, int system, int region, double outside, const double *z, double *to)
{
	double low = 0, high = outside, *inside = m->work[4];
	flow(m, system, high, z, to);
	while (high - low > 1e-15 * m->period && high - low > 4e-16 * high) {
		double middle = low + (high - low) / 2;
		flow(m, system, middle, z, inside);
		if (region_at(m, inside) == region) {
			low = middle;
		} else {
			high = middle;
			memcpy(to, inside, sizeof(double) * (size_t)m->size);
		}
	}
	return high;
}

/* ---- what is reported of a period ---- */

/* y e^{-iwt} and its first two derivatives, of state j */
static void rotated(const struct mover *m, const double *z, const double *slope, const double *second, int j,
		   double (*f)[2])
{
	double c = z[m->states] / m->amplitude, s = z[m->states + 1] / m->amplitude, w = m->w;
	double re[3] = { z[j], slope[j], second[j] - w * w * z[j] }, im[3] = { 0, -w * z[j], -2 * w * slope[j] };
	for (int k = 0; k < 3; k++) {
		f[k][0] = re[k] * c + im[k] * s;
		f[k][1] = im[k] * c - re[k] * s;
	}
}

/* Adds the integral of y e^{-iwt} from z to end, t later: by both values and two derivatives at each (Hermite, error
 * of order t^7). */
static void integrate(struct mover *m, int system, double t, const double *z, const double *end)
{
	const double *A = m->at[system];
	double f[3][2], g[3][2];
	apply(m->size, A, z, m->work[0]);
	apply(m->size, A, m->work[0], m->work[1]);
	apply(m->size, A, end, m->work[2]);
	apply(m->size, A, m->work[2], m->work[3]);
	for (int j = 0; j < m->states; j++) {
		rotated(m, z, m->work[0], m->work[1], j, f);
		rotated(m, end, m->work[2], m->work[3], j, g);
		for (int k = 0; k < 2; k++)
			m->integral[k][j] += t / 2 * (f[0][k] + g[0][k]) + t * t / 10 * (f[1][k] - g[1][k]) +
					     t * t * t / 120 * (f[2][k] + g[2][k]);
	}
}

/* M = e^{A t} M, over the states */
static void vary(struct mover *m, const double *E, double *M)
{
	int n = m->states;
	double *block = m->square[1], *product_of = m->square[2];
	for (int i = 0; i < n; i++)
		memcpy(block + i * n, E + i * m->size, sizeof(double) * (size_t)n);
	matrix_product(n, block, M, product_of);
	memcpy(M, product_of, sizeof(double) * (size_t)n * (size_t)n);
}

/* M = (I + (f+ - f-) n^T / (n^T f-)) M, where z crosses the row n, of the slopes f- before and f+ after */
static void shift(struct mover *m, int before, const double *z, double *M)
{
	const struct switching *s = m->of;
	int region = region_at(m, z), after = s->region[region].system, n = m->states, e = 0;
	double *f = m->work[0], *jump = m->work[1];
	while (e < s->functions - 1 && interval_of(s, region, e) == interval_of(s, before, e))
		e++;
	apply(m->size, m->at[s->region[before].system], z, f);
	apply(m->size, m->at[after], z, jump);
	double rate = product(m->size, m->row_at[e], f);
	for (int j = 0; j < n && rate != 0; j++) {
		double sum = 0;
		for (int i = 0; i < n; i++)
			sum += m->row_at[e][i] * M[i * n + j];
		for (int i = 0; i < n; i++)
			M[i * n + j] += (jump[i] - f[i]) / rate * sum;
	}
}

static void enlarge_scale(const struct mover *m, const double *z, double *scale)
{
	for (int i = 0; i < m->states; i++)
		scale[i] = fmax(scale[i], fabs(z[i]));
}

/* ---- the period ---- */

/* To the next sample. M, scale as below */
static void sample(struct mover *m, double h, double *z, double *M, double *scale)
{
	double *end = m->work[5], left = h;
	for (int crossings = 0; left > 0; crossings++) {
		int region = region_at(m, z), system = m->of->region[region].system;
		double t = left;
		if (t == h && !m->known[system])
			exponential(m, system, h, m->E[system]);
		m->known[system] = m->known[system] || t == h;
		if (t == h)
			apply(m->size, m->E[system], z, end);
		else
			flow(m, system, t, z, end);
		double outside = crossings < MOST_CROSSINGS ? time_outside(m, system, region, t, z, end) : 0;
		if (outside > 0)
			t = crossing(m, system, region, outside, z, end);
		m->crossings += outside > 0;
		if (M && t == h) {
			vary(m, m->E[system], M);
		} else if (M) {
			exponential(m, system, t, m->piece);
			vary(m, m->piece, M);
		}
		if (M && outside > 0)
			shift(m, region, end, M);
		if (scale) {
			integrate(m, system, t, z, end);
			enlarge_scale(m, end, scale);
		}
		memcpy(z, end, sizeof(double) * (size_t)m->size);
		left = outside > 0 ? left - t : 0;
	}
}

void mover_period(struct mover *m, double *y, double *M, double *scale)
{
	int n = m->states;
	double *z = m->work[6], h = m->period / m->samples;
	memset(m->integral[0], 0, sizeof(double) * (size_t)n);
	memset(m->integral[1], 0, sizeof(double) * (size_t)n);
	m->crossings = 0;
	for (int i = 0; M && i < n * n; i++)
		M[i] = i % (n + 1) == 0;
	memcpy(z, y, sizeof(double) * (size_t)n);
	for (int k = 0; k < m->samples; k++) {
		z[n] = m->amplitude * cos(two_pi * k / m->samples);
		z[n + 1] = m->amplitude * sin(two_pi * k / m->samples);
		z[n + 2] = 1;
		sample(m, h, z, M, scale);
	}
	memcpy(y, z, sizeof(double) * (size_t)n);
}
