/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far the states of a verified trajectory may be off its core, which is known to rounding: by Q r, |r_k| at most
 * radius_k. Each map takes it on into axes of its own. Boxes put around boxes would be wider by about two at each
 * event, also where states come together; these widths are those of the motion (R. Lohner, Computation of guaranteed
 * enclosures for the solutions of ordinary initial and boundary value problems, in: Computational ordinary differential
 * equations, Oxford 1992). */
#include "model/contacts/contacts.h"
#include "model/regions/regions.h"
#include "trajectory.h"

#include <math.h>
#include <string.h>

static const double rounding = 1e-12;   /* of sums of products in double, more than all of them lose */

/* ---- room ---- */

static struct turned_box new_turned_box(int n)
{
	return (struct turned_box){ .axis = ARRAY(double, (size_t)(n * n)), .radius = ARRAY(double, n) };
}

static struct map new_map(int n)
{
	return (struct map){ ARRAY(double, (size_t)(n * n)), ARRAY(double, (size_t)(n * n)) };
}

void deviation_make(struct trajectory *t)
{
	struct deviation *d = t->deviation = NEW(struct deviation);
	d->core = enclosures(t->n, t->precision);
	d->next_core = enclosures(t->n, t->precision);
	d->next_x = enclosures(t->n, t->precision);
	d->before = enclosures(t->n, t->precision);
	d->jump = rationals((size_t)(t->n * t->n));
	d->now = new_turned_box(t->n);
	d->next = new_turned_box(t->n);
	d->map = new_map(t->n);
	d->piece = ARRAY(struct map, t->s->systems);
}

void deviation_free(struct trajectory *t)
{
	clear_intervals(&t->deviation->core);
	clear_intervals(&t->deviation->next_core);
	clear_intervals(&t->deviation->next_x);
	clear_intervals(&t->deviation->before);
	rationals_free(t->deviation->jump, (size_t)(t->n * t->n));
	series_room_free(&t->deviation->room);
}

/* ---- the core and its width ---- */

/* The middle of x remains; the rest is `width` */
static void take_width(const struct trajectory *t, mpfi_ptr x, mpfr_ptr width)
{
	REAL middle = WITH_BITS(t->precision), other = WITH_BITS(64);
	mpfi_mid(middle, x);
	mpfr_sub(width, &x->right, middle, MPFR_RNDU);
	mpfr_sub(other, middle, &x->left, MPFR_RNDU);
	mpfr_max(width, width, other, MPFR_RNDU);
	mpfi_set_fr(x, middle);
}

/* Of all entries of x likewise, in units of 2^unit: of the largest that there is, from `unit` on */
static void take_widths(const struct trajectory *t, mpfi_t *x, long *unit, double *width)
{
	SCRATCH mpfr_t *off = ARRAY(mpfr_t, t->n);
	for (int i = 0; i < t->n; i++) {
		mpfr_init2(off[i], 64);
		take_width(t, x[i], off[i]);
		if (mpfr_regular_p(off[i]) && mpfr_get_exp(off[i]) > *unit)
			*unit = mpfr_get_exp(off[i]);
	}
	for (int i = 0; i < t->n; i++) {
		mpfr_mul_2si(off[i], off[i], -*unit, MPFR_RNDU);
		width[i] = mpfr_get_d(off[i], MPFR_RNDU);
		mpfr_clear(off[i]);
	}
}

void deviation_renew(struct trajectory *t)
{
	struct deviation *d = t->deviation;
	for (int i = 0; i < t->n; i++) {
		mpfi_set(d->core[i], t->x[i]);
		for (int j = 0; j < t->n; j++)
			d->now.axis[i * t->n + j] = i == j;
	}
	d->now.unit = mpfr_get_emin();
	take_widths(t, d->core, &d->now.unit, d->now.radius);
}

static bool is_load(const struct trajectory *t, int entry)
{
	for (int l = 0; l < t->system->loads; l++)
		if (t->layout.load[l] >= 0 && entry >= t->layout.load[l] &&
		    entry < t->layout.load[l] + t->system->load[l].columns)
			return true;
	return false;
}

void deviation_loads(struct trajectory *t)
{
	struct deviation *d = t->deviation;
	for (int i = 0; i < t->n; i++)
		if (is_load(t, i))
			mpfi_set(d->core[i], t->x[i]);
}

/* ---- a map ---- */

static void widths_of(const struct turned_box *s, int n, double *width)
{
	for (int i = 0; i < n; i++) {
		width[i] = 0;
		for (int j = 0; j < n; j++)
			width[i] += fabs(s->axis[j * n + i]) * s->radius[j];
		width[i] *= 1 + rounding;
	}
}

static double dot(int n, const double *a, const double *b)
{
	double sum = 0;
	for (int i = 0; i < n; i++)
		sum += a[i] * b[i];
	return sum;
}

/* Gram and Schmidt's, twice; what adds no direction is left out. Entries that are 0 in all of them stay so, which
 * Householder's reflections would not see to: what rests is known without a width. */
static int add_axis(int n, int axes, double *axis, double *v)
{
	const double before = sqrt(dot(n, v, v));
	for (int pass = 0; pass < 2; pass++)
		for (int k = 0; k < axes; k++) {
			const double along = dot(n, axis + k * n, v);
			for (int i = 0; i < n; i++)
				v[i] -= along * axis[k * n + i];
		}
	const double length = sqrt(dot(n, v, v));
	if (!(length > 1e-7 * before))
		return axes;
	for (int i = 0; i < n; i++)
		axis[axes * n + i] = v[i] / length;
	return axes + 1;
}

/* The axes of `next`: those of `now` as the map turns them, in their order, so that R' of map Q = Q' R' is triangular
 * in the same way each time and products of such grow as their diagonals do; then what else is not known, an entry
 * each */
static int turn_axes(struct deviation *d, int n, const double *image, const double *unknown)
{
	int axes = 0;
	SCRATCH double *v = ARRAY(double, n);
	for (int j = 0; j < n; j++)
		if (d->now.radius[j] > 0) {
			memcpy(v, image + j * n, (size_t)n * sizeof *v);
			axes = add_axis(n, axes, d->next.axis, v);
		}
	for (int i = 0; i < n; i++)
		if (unknown[i] > 0) {
			memset(v, 0, (size_t)n * sizeof *v);
			v[i] = 1;
			axes = add_axis(n, axes, d->next.axis, v);
		}
	return axes;
}

/* What is off by so much in each entry, along axes that are orthogonal but for rounding */
static void add_box(int n, int axes, struct turned_box *s, const double *box)
{
	SCRATCH double *along = ARRAY(double, n), *back = ARRAY(double, n);
	for (int k = 0; k < axes; k++)
		for (int i = 0; i < n; i++)
			along[k] += fabs(s->axis[k * n + i]) * box[i];
	for (int again = 0; again < 2; again++) {
		memset(back, 0, (size_t)n * sizeof *back);
		for (int k = 0; k < axes; k++)
			for (int i = 0; i < n; i++)
				back[i] += fabs(s->axis[k * n + i]) * along[k];
		for (int k = 0; k < axes; k++)
			for (int i = 0; i < n; i++)
				along[k] += rounding * fabs(s->axis[k * n + i]) * back[i];
	}
	for (int k = 0; k < axes; k++)
		s->radius[k] += along[k] * (1 + rounding);
}

/* That of the largest radius */
static long largest_unit(const struct turned_box *s, int n)
{
	double largest = 0;
	int exponent = 0;
	for (int k = 0; k < n; k++)
		largest = fmax(largest, s->radius[k]);
	frexp(largest, &exponent);
	return largest > 0 ? s->unit + exponent : mpfr_get_emin();
}

static void change_unit(struct turned_box *s, int n, long unit)
{
	const long by = s->unit - unit;
	for (int k = 0; k < n; k++)
		if (s->radius[k] > 0)
			s->radius[k] = fmax(ldexp(s->radius[k], by < -2000 ? -2000 : (int)by), 0x1p-1000);
	s->unit = unit;
}

/* next = map of now, and what next_core is wide: r' = Q'^-1 ((map +- slack) Q r + width) */
static void take_map(struct trajectory *t, const struct map *map)
{
	struct deviation *d = t->deviation;
	const int n = t->n;
	SCRATCH double *image = ARRAY(double, (size_t)(n * n)), *width = ARRAY(double, n), *lost = ARRAY(double, n);
	d->next.unit = largest_unit(&d->now, n);
	take_widths(t, d->next_core, &d->next.unit, lost);
	change_unit(&d->now, n, d->next.unit);
	widths_of(&d->now, n, width);
	for (int j = 0; j < n; j++)
		for (int i = 0; i < n && d->now.radius[j] > 0; i++) {
			image[j * n + i] = dot(n, map->entry + i * n, d->now.axis + j * n);
			lost[i] += rounding * fabs(image[j * n + i]) * d->now.radius[j];
		}
	for (int i = 0; i < n; i++)
		for (int k = 0; k < n; k++)
			lost[i] += (map->slack[i * n + k] + rounding * fabs(map->entry[i * n + k])) * width[k];
	memset(d->next.axis, 0, (size_t)(n * n) * sizeof *d->next.axis);
	const int axes = turn_axes(d, n, image, lost);
	for (int k = 0; k < n; k++) {
		d->next.radius[k] = 0;
		for (int j = 0; j < n && k < axes; j++)
			d->next.radius[k] += fabs(dot(n, d->next.axis + k * n, image + j * n)) * d->now.radius[j];
	}
	add_box(n, axes, &d->next, lost);
}

static void widen_next(struct trajectory *t)
{
	struct deviation *d = t->deviation;
	REAL off = WITH_BITS(64);
	SCRATCH double *width = ARRAY(double, t->n);
	widths_of(&d->next, t->n, width);
	for (int i = 0; i < t->n; i++) {
		mpfr_set_d(off, width[i], MPFR_RNDU);
		mpfr_mul_2si(off, off, d->next.unit, MPFR_RNDU);
		mpfi_set(d->next_x[i], d->next_core[i]);
		mpfi_increase(d->next_x[i], off);
	}
}

void deviation_take(struct trajectory *t)
{
	struct deviation *d = t->deviation;
	const struct turned_box box = d->now;
	for (int i = 0; i < t->n; i++) {
		mpfi_set(d->core[i], d->next_core[i]);
		mpfi_set(t->x[i], d->next_x[i]);
	}
	d->now = d->next;
	d->next = box;
}

/* ---- between events ---- */

static void make_piece(const struct trajectory *t, struct map *map)
{
	REAL width = WITH_BITS(64);
	*map = new_map(t->n);
	for (int k = 0; k < t->n * t->n; k++) {
		map->entry[k] = mpfi_get_d(t->at->flow->power[0][k]);
		mpfi_diam_abs(width, t->at->flow->power[0][k]);
		map->slack[k] = mpfr_get_d(width, MPFR_RNDU) + 1e-15 * fabs(map->entry[k]);
	}
}

void deviation_over_piece(struct trajectory *t)
{
	struct map *map = &t->deviation->piece[t->at->system];
	if (!map->entry)
		make_piece(t, map);
	take_map(t, map);
	widen_next(t);
}

int deviation_expand(struct trajectory *t, mpq_srcptr tau)
{
	struct deviation *d = t->deviation;
	SCRATCH double *width = ARRAY(double, t->n);
	widths_of(&d->now, t->n, width);
	int degree = stream_expand(t->at->flow, d->core, tau, &d->room);
	stream_widen(t->at->flow, &d->room, degree, width, d->now.unit, tau, &t->piece.room);
	return degree;
}

/* e^{A time} as a Taylor polynomial; the growth over a whole piece bounds what is rounded. |A| time is no more than 1
 * in the scales of the stream, so that 25 terms leave less. */
static void exponential(struct trajectory *t, double time)
{
	enum { TERMS = 25 };
	const struct stream *f = t->at->flow;
	const struct map *map = &t->deviation->map;
	const int n = t->n;
	SCRATCH double *term = ARRAY(double, (size_t)(n * n)), *next = ARRAY(double, (size_t)(n * n));
	SCRATCH double *a = ARRAY(double, f->first[n]);
	for (int k = 0; k < f->first[n]; k++)
		a[k] = mpfi_get_d(f->entry[k]) * time;
	for (int k = 0; k < n * n; k++) {
		map->entry[k] = term[k] = k / n == k % n;
		map->slack[k] = rounding * t->at->growth[k];
	}
	for (int m = 1; m <= TERMS; m++) {
		memset(next, 0, (size_t)(n * n) * sizeof *next);
		for (int i = 0; i < n; i++)
			for (int k = f->first[i]; k < f->first[i + 1]; k++)
				for (int j = 0; j < n; j++)
					next[i * n + j] += a[k] / m * term[f->column[k] * n + j];
		for (int k = 0; k < n * n; k++)
			map->entry[k] += term[k] = next[k];
	}
}

void deviation_over_part(struct trajectory *t, int degree, mpq_srcptr tau, mpfr_srcptr s)
{
	struct deviation *d = t->deviation;
	stream_sum(t->at->flow, &d->room, degree, s, d->next_core);
	exponential(t, mpq_get_d(tau) * mpfr_get_d(s, MPFR_RNDN));
	take_map(t, &d->map);
	widen_next(t);
}

/* ---- an event ---- */

/* max |x_i| / D_i and sum of |g_j| D_j, of which a product with g bounds entries in the scales D */
static double scaled(const struct stream *f, const double *x, bool row)
{
	double size = 0;
	for (int i = 0; i < f->n; i++)
		size = row ? size + fabs(x[i]) * f->scale[i] : fmax(size, fabs(x[i]) / f->scale[i]);
	return size;
}

/* How much the speed of a switching function may be another within `off`, by the norms of its second derivative */
static double bend_within(const struct trajectory *t, const struct guard *guard, const struct stream *f, double rates,
			  double off)
{
	SCRATCH double *x = ARRAY(double, t->n);
	for (int i = 0; i < t->n; i++)
		x[i] = fabs(mpfi_get_d(t->deviation->before[i])) * (1 + rounding);
	return 2 * off * rates * rates * scaled(f, x, false) * scaled(f, guard->near_row, true);
}

void deviation_begin(struct trajectory *t)
{
	struct deviation *d = t->deviation;
	for (int i = 0; i < t->n; i++)
		mpfi_set(d->before[i], t->x[i]);
	for (int k = 0; k < t->n * t->n; k++)
		mpq_set_ui(d->jump[k], k / t->n == k % t->n, 1);
	d->jumps = 0;
}

enum { MOST_JUMPS = 64 };               /* each makes the numbers of those before it longer */

void deviation_assign(struct trajectory *t, int count, const int *state, mpq_t *const *row)
{
	struct deviation *d = t->deviation;
	const int n = t->n;
	SCRATCH mpq_t **next = ARRAY(mpq_t *, (size_t)count + 1);
	if (count == 0 || (d->jumps += count) > MOST_JUMPS)
		return;
	for (int k = 0; k < count; k++)
		next[k] = trajectory_times(t, row[k], (const mpq_t *)d->jump);
	for (int k = 0; k < count; k++) {
		for (int j = 0; j < n; j++)
			mpq_set(d->jump[state[k] * n + j], next[k][j]);
		rationals_free(next[k], (size_t)n);
	}
}

/* y = jump x */
static void take_jump(const struct trajectory *t, const mpfi_t *x, mpfi_t *y)
{
	for (int i = 0; i < t->n; i++)
		trajectory_dot(t, (const mpq_t *)t->deviation->jump + i * t->n, x, y[i]);
}

/* What is held behind it has the width of what it is held by: none where that is a number. */
static void hold_map(struct trajectory *t)
{
	struct map *map = &t->deviation->map;
	const struct region *r = &t->s->region[t->region];
	const int n = t->n;
	const size_t room = (size_t)(r->holds * n) + 1;
	SCRATCH double *entry = ARRAY(double, room), *slack = ARRAY(double, room);
	for (int k = 0; k < r->holds; k++) {
		RATIONALS *row = trajectory_row_of(t, r->hold[k].row);
		for (int i = 0; i < n; i++) {
			const double by = mpq_get_d(row[i]);
			for (int j = 0; j < n && by != 0; j++) {
				entry[k * n + j] += by * map->entry[i * n + j];
				slack[k * n + j] += fabs(by) * (1 + rounding) *
						    (map->slack[i * n + j] + rounding * fabs(map->entry[i * n + j]));
			}
		}
	}
	for (int k = 0; k < r->holds; k++) {
		const size_t to = (size_t)(r->hold[k].state * n);
		memcpy(map->entry + to, entry + k * n, (size_t)n * sizeof *entry);
		memcpy(map->slack + to, slack + k * n, (size_t)n * sizeof *slack);
	}
}

/* The norm of the jump in the scales D, at least 1 */
static double norm_of_jump(const struct trajectory *t, const struct stream *f)
{
	double norm = 1;
	for (int i = 0; i < t->n; i++) {
		double sum = 0;
		for (int j = 0; j < t->n; j++)
			sum += fabs(mpq_get_d(t->deviation->jump[i * t->n + j])) * f->scale[j] / f->scale[i];
		norm = fmax(norm, sum * (1 + rounding));
	}
	return norm;
}

/* The derivative of what an event makes of a state by its jump R: R - (R A_before - A_after R) x row / slope, the jump
 * matrix of a crossing, whose R is the identity; what it is off by the time `off`, of first order in that. False: its
 * speed is not known well enough. */
static bool jump_matrix(struct trajectory *t, const struct guard *guard, const struct stream *before,
			mpfi_srcptr slope, double off)
{
	struct deviation *d = t->deviation;
	const struct stream *after = t->at->flow;
	const int n = t->n;
	INTERVALS *old = enclosures(n, t->precision), *new = enclosures(n, t->precision);
	INTERVALS *y = enclosures(n, t->precision);
	REAL width = WITH_BITS(64);
	SCRATCH double *jump = ARRAY(double, n), *wide = ARRAY(double, n);
	SCRATCH double *row = ARRAY(double, n), *x = ARRAY(double, n);
	const double speed = mpfi_get_d(slope), rates = stream_rates(before, after), norm = norm_of_jump(t, before);
	mpfi_diam_abs(width, slope);
	const bool known = !mpfi_has_zero(slope) && mpfr_get_d(width, MPFR_RNDU) < 1e-14 * fabs(speed) &&
			   off * rates < 1e-14;
	stream_slope(before, d->before, new);
	take_jump(t, (const mpfi_t *)new, old);
	take_jump(t, (const mpfi_t *)d->before, y);
	stream_slope(after, y, new);
	for (int i = 0; i < n && known; i++) {
		mpfi_sub(old[i], old[i], new[i]);
		jump[i] = mpfi_get_d(old[i]);
		mpfi_diam_abs(width, old[i]);
		wide[i] = mpfr_get_d(width, MPFR_RNDU);
		row[i] = guard->near_row[i] / speed;
		x[i] = mpfi_get_d(d->before[i]);
	}
	const double turned = 8 * off * rates *
			      (norm + 2 * (scaled(before, jump, false) + rates * norm * scaled(before, x, false)) *
					      scaled(before, row, true));
	for (int i = 0; i < n && known; i++)
		for (int j = 0; j < n; j++) {
			const double entry = jump[i] * row[j], kept = mpq_get_d(d->jump[i * n + j]);
			d->map.entry[i * n + j] = kept - entry;
			d->map.slack[i * n + j] = rounding * (fabs(kept) + fabs(entry)) + 2 * wide[i] * fabs(row[j]) +
					      turned * before->scale[i] / before->scale[j];
		}
	if (known)
		hold_map(t);
	return known;
}

/* The core behind it, when it is met there */
static bool core_behind(struct trajectory *t, const struct stream *before, mpfi_ptr when)
{
	struct deviation *d = t->deviation;
	const struct region *r = &t->s->region[t->region];
	if (d->jumps == 0) {
		for (int i = 0; i < t->n; i++)
			mpfi_set(d->next_core[i], d->core[i]);
		return stream_change_within(before, t->at->flow, when, d->next_core);
	}
	INTERVALS *x = enclosures(t->n, t->precision);
	for (int i = 0; i < t->n; i++)
		mpfi_set(x[i], d->core[i]);
	bool known = stream_change_within(before, NULL, when, x);
	take_jump(t, (const mpfi_t *)x, d->next_core);
	mpfi_neg(when, when);
	known = stream_change_within(t->at->flow, NULL, when, d->next_core) && known;
	for (int k = 0; k < r->holds; k++) {
		RATIONALS *row = trajectory_row_of(t, r->hold[k].row);
		trajectory_dot(t, row, (const mpfi_t *)d->next_core, x[r->hold[k].state]);
	}
	for (int k = 0; k < r->holds; k++)
		mpfi_set(d->next_core[r->hold[k].state], x[r->hold[k].state]);
	return known;
}

bool deviation_cross(struct trajectory *t, const struct guard *guard, const struct stream *before, mpfr_srcptr off)
{
	struct deviation *d = t->deviation;
	INTERVAL slope = OVER_BITS(t->precision), when = OVER_BITS(t->precision);
	REAL bend = WITH_BITS(64);
	const double most = mpfr_get_d(off, MPFR_RNDU);
	if (d->jumps > MOST_JUMPS)
		return false;
	trajectory_dot(t, guard->slope, (const mpfi_t *)d->before, slope);
	mpfr_set_d(bend, bend_within(t, guard, before, stream_rates(before, t->at->flow), most), MPFR_RNDU);
	mpfi_increase(slope, bend);
	bool known = jump_matrix(t, guard, before, slope, most);
	if (known) {
		/* when the core meets it, by the mean value theorem */
		trajectory_dot(t, guard->row, (const mpfi_t *)d->core, when);
		mpfi_q_sub(when, guard->limit, when);
		mpfi_div(when, when, slope);
		known = core_behind(t, before, when);
	}
	if (known) {
		take_map(t, &d->map);
		widen_next(t);
		deviation_take(t);
	}
	return known;
}
