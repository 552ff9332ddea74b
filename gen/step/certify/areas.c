/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of a verified trajectory: regions as they are met, what ends them, and loads at a time. */
#include "inner.h"
#include "model/tunable/elsewhere.h"
#include "model/contacts/friction.h"
#include "trajectory.h"

#include <math.h>

/* ---- rows ---- */

void trajectory_row(const struct trajectory *t, const struct output *output, mpq_t *row)
{
	row_of_output(&t->layout, t->system, output, t->when.segments, t->when.segment, row);
}

mpq_t *trajectory_row_of(const struct trajectory *t, const struct output *output)
{
	mpq_t *row = rationals(t->n);
	trajectory_row(t, output, row);
	return row;
}

void trajectory_dot(const struct trajectory *t, const mpq_t *row, const mpfi_t *x, mpfi_ptr sum)
{
	INTERVAL part = OVER_BITS(t->precision);
	mpfi_set_ui(sum, 0);
	for (int i = 0; i < t->n; i++) {
		if (mpq_sgn(row[i]) == 0)
			continue;
		mpfi_mul_q(part, x[i], row[i]);
		mpfi_add(sum, sum, part);
	}
}

void trajectory_value(const struct trajectory *t, const struct output *output, mpfi_ptr value)
{
	RATIONALS *row = rationals(t->n);
	mpfi_set_prec(value, t->precision);
	trajectory_row(t, output, row);
	trajectory_dot(t, row, t->x, value);
}

void trajectory_state(const struct trajectory *t, int state, mpfi_ptr value)
{
	mpfi_set_prec(value, t->precision);
	mpfi_set(value, t->x[state]);
}

/* ---- guards: what ends a region ---- */

static double *doubles(int n, const mpq_t *row)
{
	double *value = ARRAY(double, n);
	for (int i = 0; i < n; i++)
		value[i] = mpq_get_d(row[i]);
	return value;
}

mpq_t *trajectory_times(const struct trajectory *t, const mpq_t *row, const mpq_t *A)
{
	mpq_t *product = rationals(t->n);
	for (int i = 0; i < t->n; i++)
		for (int j = 0; j < t->n && mpq_sgn(row[i]) != 0; j++) {
			if (mpq_sgn(A[i * t->n + j]) == 0)
				continue;
			rational_addmul(product[j], row[i], A[i * t->n + j]);
		}
	return product;
}

/* |row A^4|, and something for what doubles round */
static double *fourth_of(const struct trajectory *t, const double *row, const mpq_t *A)
{
	int n = t->n;
	SCRATCH double *a = doubles(n * n, A);
	double *now = ARRAY(double, n), *size = ARRAY(double, n);
	for (int i = 0; i < n; i++)
		size[i] = fabs(now[i] = row[i]);
	for (int k = 0; k < 4; k++) {
		double *next = ARRAY(double, n), *bound = ARRAY(double, n);
		for (int i = 0; i < n; i++)
			for (int j = 0; j < n; j++) {
				next[j] += now[i] * a[i * n + j];
				bound[j] += size[i] * fabs(a[i * n + j]);
			}
		now = next;
		size = bound;
	}
	for (int j = 0; j < n; j++)
		now[j] = fabs(now[j]) + 1e-12 * size[j];
	return now;
}

static void add_guard(const struct trajectory *t, struct area *area, struct guard guard, mpq_t *row, mpq_srcptr limit)
{
	mpq_init(guard.limit);
	mpq_set(guard.limit, limit);
	guard.row = row;
	guard.slope = trajectory_times(t, row, area->A);
	guard.near_limit = mpq_get_d(limit);
	guard.near_row = doubles(t->n, row);
	guard.near_slope = doubles(t->n, guard.slope);
	guard.fourth = fourth_of(t, guard.near_row, area->A);
	*MORE(area->guard, area->guards) = guard;
}

/* The ends of an interval of a switching function */
static void add_ends(const struct trajectory *t, struct area *area, int region, int function)
{
	const struct switching_function *e = &t->s->function[function];
	int interval = interval_of(t->s, region, function), segment = segment_of_region(t->s, region);
	RATIONAL limit = ZERO;
	for (int upward = 0; upward < 2; upward++) {
		int breakpoint = interval - !upward;
		if (breakpoint < 0 || breakpoint == e->breaks ||
		    (t->s->region[region].possible && is_released(&t->s->region[region], function, upward)))
			continue;
		mpq_t *row = rationals(t->n);
		int leads = upward ? e->stride : -e->stride;
		int impact = impact_at(t->s, segment, function, e->at[breakpoint], upward);
		if (impact < 0 && impact_resting(t->s, segment, function, interval + (upward ? 1 : -1)) >= 0)
			leads *= 2;             /* past the interval of rest, which impacts alone lead to */
		trajectory_row(t, e->row, row);
		mpq_set(limit, e->at[breakpoint]);
		if (!upward)
			mpq_neg(limit, limit);
		for (int i = 0; i < t->n && !upward; i++)
			mpq_neg(row[i], row[i]);
		add_guard(t, area,
			 (struct guard){ .function = function, .breakpoint = breakpoint, .upward = upward,
					.impact = impact, .leads = leads },
			 row, limit);
	}
}

/* e^{|A| piece}, rounded up: entry by entry it bounds how far states grow in a piece */
static double *growth_of(const struct stream *f)
{
	int n = f->n;
	double *E = ARRAY(double, (size_t)(n * n)), *term = ARRAY(double, (size_t)(n * n)), d = mpq_get_d(f->piece);
	for (int i = 0; i < n * n; i++)
		E[i] = term[i] = i % n == i / n;
	for (int k = 1; k < 60; k++) {
		double *next = ARRAY(double, (size_t)(n * n));
		for (int i = 0; i < n; i++)
			for (int m = 0; m < n; m++)
				for (int j = 0; j < n && term[i * n + m] != 0; j++)
					next[i * n + j] += term[i * n + m] * f->size[m * n + j] * d / k;
		for (int i = 0; i < n * n; i++)
			E[i] += next[i];
		discard(term);
		term = next;
	}
	for (int i = 0; i < n * n; i++)
		E[i] *= 1 + 1e-9;
	discard(term);
	return E;
}

static struct stream *stream_of_system(struct trajectory *t, int system, mpq_t **A)
{
	if (!t->A[system]) {
		t->A[system] = augmented_matrix(&t->layout, &t->s->system[system], 0);
		t->flow[system] = stream_of(t->n, t->A[system], t->model->h, t->precision);
		t->growth[system] = growth_of(t->flow[system]);
	}
	*A = t->A[system];
	return t->flow[system];
}

/* What lets go a switching function that is held */
static void add_releases(const struct trajectory *t, struct area *area, int region, int function)
{
	const struct region *r = &t->s->region[region];
	int stride = t->s->function[function].stride, interval = interval_of(t->s, region, function);
	RATIONAL zero = ZERO;
	for (int k = 0; k < r->releases; k++) {
		const struct release *release = &r->release[k];
		if (release->function != function)
			continue;
		mpq_t *row = rationals(t->n);
		trajectory_row(t, release->row, row);
		add_guard(t, area,
			 (struct guard){ .function = function, .breakpoint = interval - !release->upward,
					.upward = release->upward, .release = true, .impact = -1,
					.leads = release->upward ? stride : -stride },
			 row, zero);
	}
}

/* Regions that cannot be are passed through where two switching functions cross at once; the equations stay those
 * before. */
struct area *trajectory_area(struct trajectory *t, int region)
{
	struct area *area = &t->area[region];
	const struct region *r = &t->s->region[region];
	if (area->flow && r->possible)
		return area;
	int system = r->possible ? r->system : t->at ? t->at->system : 0;
	*area = (struct area){ .system = system };
	area->flow = stream_of_system(t, system, &area->A);
	area->growth = t->growth[system];
	for (int e = 0; e < t->s->functions; e++) {
		bool held = r->possible && is_stick(&t->s->function[e], interval_of(t->s, region, e));
		if (!held)
			add_ends(t, area, region, e);
		if (r->possible)
			add_releases(t, area, region, e);
	}
	return area;
}

void trajectory_enter(struct trajectory *t, int region)
{
	struct area *area = trajectory_area(t, region);
	t->region = region;
	t->grid.met = false;
	for (int e = 0; e < t->s->functions; e++) {
		t->resting[e] = false;
		t->fresh.order[e] = 0;
	}
	t->at = area;
}

/* ---- what loads and inputs are at a time ---- */

static void forcing_at(const struct trajectory *t, const struct load *load, int column, mpq_srcptr time, mpfi_ptr z)
{
	const struct forcing *forcing = load->forcing;
	bool turns = oscillates(forcing);
	RATIONAL argument = ZERO;
	INTERVAL factor = OVER_BITS(t->precision);
	mpq_mul(argument, forcing->a, time);
	mpfi_set_q(factor, argument);
	mpfi_exp(z, factor);
	for (int k = 0; k < (turns ? column / 2 : column); k++)
		mpfi_mul_q(z, z, time);
	if (turns) {
		mpq_mul(argument, forcing->w, time);
		mpq_add(argument, argument, forcing->p);
		mpfi_set_q(factor, argument);
		if (mpq_sgn(argument) == 0)
			mpfi_set_ui(factor, column % 2 == 0);
		else
			(column % 2 ? mpfi_sin : mpfi_cos)(factor, factor);
		mpfi_mul(z, z, factor);
	}
}

void trajectory_loads(struct trajectory *t)
{
	for (int l = 0; l < t->system->loads; l++)
		for (int k = 0; k < t->system->load[l].columns && t->layout.load[l] >= 0; k++)
			forcing_at(t, &t->system->load[l], k, t->base, t->x[t->layout.load[l] + k]);
}

bool trajectory_meets(const struct trajectory *t, const struct guard *one, const struct guard *other)
{
	RATIONAL ratio = ZERO;
	return one->release && other->release && rationals_multiple((size_t)t->n, other->row, one->row, ratio) &&
	       mpq_sgn(ratio) > 0;
}

/* ---- what cannot be decided ---- */

const char *trajectory_time(mpq_srcptr time)
{
	return format("%.12g", mpq_get_d(time));
}

bool trajectory_lost(struct trajectory *t, const struct guard *guard, const char *what)
{
	t->undecided = format("from t = %s s on it is not known whether %s passes %s: %s", trajectory_time(t->base),
			      text_of_function(t->model, guard->function),
			      readable_text(t->s->function[guard->function].at[guard->breakpoint]), what);
	return false;
}
