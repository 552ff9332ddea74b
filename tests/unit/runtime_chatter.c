/* SPDX-License-Identifier: GPL-3.0-or-later */
/* runtime/crossings.c where crossings have no end, and random systems against small steps in long double with crossings
 * by bisection. */
#include "runtime_switched.h"

/* ---- chatter ---- */

/* x'' = -x' + 1 below 0, -x' - 1 above: ever more crossings a second, without end */
void chatter(void **state)
{
	static const double from[5] = {0.1, 0.0, 1.0, 1.0, 0.0};
	int i, n;
	(void)state;
	for (i = 0; i < SEVERAL; i++) {
		model *s = single(0.0, 1.0, 0.0, 1.0, 0.0, 1, 0.0, 0.0);
		const int one = 2, v = s->m.size;
		s->add[0][0][v + one] = 1.0;
		s->add[0][1][v + one] = -1.0;
		build(s, several_steps[i]);
		start(s, from);
		for (n = 0; n * several_steps[i] < 40.0; n++) {
			step(s);
			assert_true(s->c.crossings <= EVENTS);
			assert_int_equal(pl_not_finite(s->x, s->m.size), 0);
			assert_true(fabs(s->x[0]) < 5.0);
		}
		assert_int_equal(s->c.status, PL_TOO_MANY_EVENTS);
		start(s, from);
		assert_int_equal(s->c.status, 0);
		free_model(s);
	}
}

/* x'' = 400 x - 0.5 x' + 1 below 0, - 1 above: comes to rest at 0, where it switches for ever.  Either region by itself
 * is unstable: e^20 in a step of 1.  What a step does behind its last crossing does not grow. */
void held_behind_the_last(void **state)
{
	static const double from[5] = {0.001, 0.0, 1.0, 1.0, 0.0};
	const int one = 2, v = 2 + 3;
	double largest = 0;
	int n;
	model *s = single(-400.0, 0.5, 0.0, 1.0, 0.0, 1, 0.0, 0.0);
	(void)state;
	assert_int_equal(s->m.size, v);
	s->add[0][0][v + one] = 1.0;
	s->add[0][1][v + one] = -1.0;
	build(s, 1.0);
	start(s, from);
	for (n = 0; n < 100; n++) {
		step(s);
		largest = fmax(largest, fabs((double)s->x[0]));
	}
	assert_int_equal(s->c.status, PL_TOO_MANY_EVENTS);
	if (!(largest < 1.0 / 400))
		fail_msg("at most %.3g expected, found %.3g", 1.0 / 400, largest);
	free_model(s);
}

/* x'' = 4 x, twice as steep above 1, until it overflows: that, and nothing of crossings; likewise x'' = 0.5 x' - 100 x,
 * of which ever larger ones cross till the end. */
void overflow_is_not_chatter(void **state)
{
	static const double from[5] = {0.5, 0.5, 1.0, 1.0, 0.0};
	static const double stiffness[2] = {-4.0, 100.0}, damping[2] = {0.0, -2.0};
	int kind, n, crossed = 0;
	(void)state;
	for (kind = 0; kind < 2; kind++) {
		model *s = single(stiffness[kind], damping[kind], 0.0, 1.0, 0.0, 1, 1.0, 0.0);
		build(s, 0.25);
		start(s, from);
		for (n = 0; n < 100000 && !pl_not_finite(s->x, 2); n++) {
			step(s);
			crossed += s->c.crossings;
			assert_int_equal(s->c.status, 0);
		}
		assert_true(n < 100000 && crossed > 0);
		steps(s, 3);
		assert_int_equal(s->c.status, 0);
		assert_int_equal(pl_not_finite(s->x, 2), PL_NOT_FINITE);
		free_model(s);
	}
}

/* Bounds of 1, and what is not finite: every loop ends. */
void bounds_hold(void **state)
{
	static const double from[5] = {0.0, 2.0, 1.0, 1.0, 0.0}, almost[5] = {0.0, 1.0 - NEAR, 1.0, 1.0, 0.0};
	static const real bad[] = {(real)INFINITY, (real)NAN, (real)LARGE, (real)LARGEST};
	model *s = one_stop(4.0);
	int i;
	(void)state;
	s->m.max_events = 1;
	start(s, from);
	step(s); /* up and down again: the second is one too many, and passed but not listed */
	assert_int_equal(s->c.region, 0);
	assert_int_equal(s->c.crossings, 1);
	assert_int_equal(s->c.status, PL_TOO_MANY_EVENTS);
	steps(s, 3);
	assert_int_equal(pl_not_finite(s->x, 5), 0);
	s->m.max_events = EVENTS;
	s->m.max_splits = 1;
	start(s, almost);
	steps(s, 3);
	assert_int_equal(s->c.status, PL_TOO_MANY_EVENTS);
	assert_int_equal(pl_not_finite(s->x, 5), 0);
	s->m.max_splits = SPLITS;
	for (i = 0; i < 8; i++) {
		start(s, from);
		s->x[i / 4] = bad[i % 4];
		steps(s, 2);
		start_here(s);
	}
	free_model(s);
}

/* ---- random systems against small steps ---- */

/* A stop on coordinate j against ground, moving in one case of two, or against coordinate l */
static void random_stop(model *s, int i, const double *mass)
{
	const int dof = s->states / 2, n = s->m.size, j = below(dof), l = below(dof), side = below(3);
	const double k = uniform(0.5, 15.0), gap = uniform(0.2, 1.2);
	real *row = s->row + i * n;
	row[j] = 1.0;
	if (l != j)
		row[l] = -1.0;
	if (below(2))
		row[2 * dof + 1] = (real)-uniform(0.1, 0.5);
	s->breaks[i] = side == 2 ? 2 : 1;
	s->at[i * B] = (real)(side == 1 ? gap : -gap); /* packed later */
	s->at[i * B + 1] = (real)gap;
	if (side != 1)
		spring(s, i, 0, j, k / mass[j], -gap);
	if (side != 0)
		spring(s, i, s->breaks[i], j, k / mass[j], gap);
	if (l == j)
		return;
	if (side != 1)
		spring(s, i, 0, l, -k / mass[l], -gap);
	if (side != 0)
		spring(s, i, s->breaks[i], l, -k / mass[l], gap);
}

/* A damper of two rates: a switch on a speed, relative or not; the force is continuous. */
static void random_damper(model *s, int i, const double *mass)
{
	const int dof = s->states / 2, n = s->m.size, j = below(dof), l = below(dof);
	const double c = uniform(0.1, 1.0), b = uniform(-0.5, 0.5);
	s->row[i * n + dof + j] = 1.0;
	s->breaks[i] = 1;
	s->at[i * B] = (real)b;
	if (l != j)
		s->row[i * n + dof + l] = -1.0;
	spring(s, i, 1, j, c / mass[j], b);
	if (l != j)
		spring(s, i, 1, l, -c / mass[l], b);
}

/* Beyond its last breakpoint, a stop damps as well: the force jumps. */
static void damp_stop(model *s, int i)
{
	const int dof = s->states / 2, j = below(dof);
	s->add[i][s->breaks[i]][(dof + j) * s->m.size + dof + j] -= uniform(0.05, 0.5);
}

static model *random_model(double *x)
{
	const int dof = 1 + below(3), switches = 1 + below(3);
	model *s = oscillator(dof, switches, uniform(0.4, 2.0));
	double mass[3];
	real packed[S * B];
	int i, j, count = 0;
	for (i = 0; i < dof; i++)
		mass[i] = uniform(0.5, 2.0);
	for (i = 0; i < dof; i++) {
		const double k = uniform(0.2, 1.5), c = uniform(0.0, 0.1);
		couple(s, 0, i, i, -k / mass[i]);
		couple(s, dof, i, i, -c / mass[i]);
		if (i > 0) {
			couple(s, 0, i, i - 1, k / mass[i]);
			couple(s, dof, i, i - 1, c / mass[i]);
			couple(s, 0, i - 1, i, k / mass[i - 1]);
			couple(s, 0, i - 1, i - 1, -k / mass[i - 1]);
			couple(s, dof, i - 1, i, c / mass[i - 1]);
			couple(s, dof, i - 1, i - 1, -c / mass[i - 1]);
		}
		couple(s, 2 * dof + 1, i, 0, uniform(-1.0, 1.0) / mass[i]);
	}
	for (i = 0; i < switches; i++) {
		const int kind = below(5);
		if (kind == 4)
			random_damper(s, i, mass);
		else
			random_stop(s, i, mass);
		if (kind == 3)
			damp_stop(s, i);
	}
	for (i = 0; i < switches; i++)
		for (j = 0; j < s->breaks[i]; j++)
			packed[count++] = s->at[i * B + j];
	memcpy(s->at, packed, sizeof *packed * (size_t)count);
	for (i = 0; i < 2 * dof; i++)
		x[i] = uniform(-1.0, 1.0);
	x[2 * dof] = x[2 * dof + 1] = 1.0;
	x[2 * dof + 2] = 0.0;
	return s;
}

/* The other road: steps of `h`, e and e' looked at only at their ends */
typedef struct tracer {
	const model *s;
	long double h, Phi[R][N * N], x[N];
	int interval[S], extrema; /* extrema: whether a maximum inside a step is looked for too */
	int crossings;
} tracer;

static int region_of(const tracer *t)
{
	int i, region = 0;
	for (i = t->s->m.switches - 1; i >= 0; i--)
		region = region * (t->s->breaks[i] + 1) + t->interval[i];
	return region;
}

/* e^{A tau} x */
static void flow(const tracer *t, long double tau, const long double *x, long double *y)
{
	const int n = t->s->m.size;
	const real *A = t->s->A + region_of(t) * n * n;
	const int parts = 1 + (int)(tau * 12.0L);
	long double w[N], z[N];
	int i, j, k, p;
	memcpy(y, x, sizeof *y * (size_t)n);
	for (p = 0; p < parts; p++) {
		memcpy(w, y, sizeof w);
		for (k = 1; k <= 22; k++) {
			for (i = 0; i < n; i++)
				for (z[i] = 0.0L, j = 0; j < n; j++)
					z[i] += A[i * n + j] * w[j];
			for (i = 0; i < n; i++)
				y[i] += w[i] = z[i] * (tau / parts) / k;
		}
	}
}

/* sign (e - b), or its derivative */
static long double beyond(const tracer *t, int i, int sign, double b, int derivative, const long double *x)
{
	const int n = t->s->m.size;
	const real *A = t->s->A + region_of(t) * n * n, *row = t->s->row + i * n;
	long double sum = derivative ? 0.0L : -(long double)b;
	int j, k;
	for (j = 0; j < n; j++)
		if (!derivative)
			sum += row[j] * x[j];
		else
			for (k = 0; k < n; k++)
				sum += (long double)row[j] * A[j * n + k] * x[k];
	return sign * sum;
}

/* Where g, or its derivative, changes sign between 0 and tau */
static long double bisect(const tracer *t, int i, int sign, double b, int derivative, long double tau)
{
	long double lo = 0.0L, hi = tau, y[N];
	const int up = !derivative;
	int k;
	for (k = 0; k < 64; k++) {
		const long double middle = (lo + hi) / 2.0L;
		flow(t, middle, t->x, y);
		if ((beyond(t, i, sign, b, derivative, y) > 0.0L) == up)
			hi = middle;
		else
			lo = middle;
	}
	return (lo + hi) / 2.0L;
}

/* The time of a crossing of this breakpoint in the next tau, or tau; y: x(tau) */
static long double crossing_of(const tracer *t, int i, int sign, double b, long double tau, const long double *y)
{
	long double peak, z[N];
	if (beyond(t, i, sign, b, 0, t->x) > 0.0L && beyond(t, i, sign, b, 1, t->x) <= 0.0L)
		return tau;
	if (beyond(t, i, sign, b, 0, y) > 0.0L)
		return bisect(t, i, sign, b, 0, tau);
	if (!t->extrema || beyond(t, i, sign, b, 1, t->x) <= 0.0L || beyond(t, i, sign, b, 1, y) >= 0.0L)
		return tau;
	peak = bisect(t, i, sign, b, 1, tau);
	flow(t, peak, t->x, z);
	return beyond(t, i, sign, b, 0, z) > 1e-15L ? bisect(t, i, sign, b, 0, peak) : tau;
}

static void trace_step(tracer *t)
{
	const int n = t->s->m.size;
	long double left = t->h, y[N];
	int i, j, sign;
	while (left > 0.0L) {
		long double first = left;
		int which = -1, direction = 0;
		const real *at = t->s->at;
		if (left == t->h) {
			const long double *Phi = t->Phi[region_of(t)];
			for (i = 0; i < n; i++)
				for (y[i] = 0.0L, j = 0; j < n; j++)
					y[i] += Phi[i * n + j] * t->x[j];
		} else
			flow(t, left, t->x, y);
		for (i = 0; i < t->s->m.switches; at += t->s->breaks[i++])
			for (sign = -1; sign <= 1; sign += 2) {
				const int breakpoint = t->interval[i] - (sign < 0);
				long double when;
				if (breakpoint < 0 || breakpoint == t->s->breaks[i])
					continue;
				when = crossing_of(t, i, sign, at[breakpoint], left, y);
				if (when < first) {
					first = when;
					which = i;
					direction = sign;
				}
			}
		if (which >= 0) {
			flow(t, first, t->x, y);
			t->crossings++;
		}
		memcpy(t->x, y, sizeof y);
		if (which >= 0)
			t->interval[which] += direction;
		left -= first;
	}
}

/* n steps of h; the region to start in is that of s. */
static void trace(tracer *t, const model *s, const double *x, double h, int extrema, int n)
{
	const int size = s->m.size;
	int i, code = s->c.region;
	memset(t, 0, sizeof *t);
	t->s = s;
	t->h = h;
	t->extrema = extrema;
	for (i = 0; i < size; i++)
		t->x[i] = (real)x[i];
	for (i = 0; i < s->m.switches; i++) {
		t->interval[i] = code % (s->breaks[i] + 1);
		code /= s->breaks[i] + 1;
	}
	for (i = 0; i < s->regions; i++)
		exponential(size, s->A + i * size * size, h, 0, t->Phi[i]);
	while (n-- > 0)
		trace_step(t);
}

static int differs(const model *s, const tracer *t, double tolerance, double *worst)
{
	int i, wrong = 0;
	for (i = 0; i < s->states; i++) {
		const double off = fabs(s->x[i] - (double)t->x[i]);
		wrong |= !(off <= tolerance);
		if (off > *worst)
			*worst = off;
	}
	return wrong;
}

/* CROSSINGS_SYSTEMS: how many, unless told 100, in the short form 10 */
void random_systems(void **state)
{
	static const double steps_of[] = {0.5, 1.0, 2.0, 4.0};
	const char *told = getenv("CROSSINGS_SYSTEMS");
	const int systems = told ? atoi(told) : (int)samples(100);
	int by_signs[4] = {0, 0, 0, 0}, i, k;
	double worst = 0.0;
	uint64_t crossings = 0;
	(void)state;
	for (i = 0; i < systems; i++) {
		double x[N], ignored = 0.0;
		static tracer fine, coarse;
		model *s = random_model(x);
		for (k = 0; k < 4; k++) {
			const double h = steps_of[k];
			build(s, h);
			start(s, x);
			if (k == 0)
				trace(&fine, s, x, 0.01, 1, 2000);
			fine.s = s;
			start(s, x);
			trace(&coarse, s, x, h, 0, (int)(20.0 / h));
			steps(s, (int)(20.0 / h));
			if (differs(s, &fine, ALIKE, &worst) || s->c.status != 0
					|| s->c.total != (uint64_t)fine.crossings)
				fail_msg("system %d (%d states, %d switches), h = %g: %d crossings, expected %d; "
					"status %d; x %.17g, "
						 "expected %.17g",
				 i, s->states, s->m.switches, h, (int)s->c.total, fine.crossings, s->c.status, s->x[0],
						 (double)fine.x[0]);
			by_signs[k] += coarse.crossings != fine.crossings || differs(s, &coarse, ALIKE, &ignored);
			crossings += s->c.total;
		}
		free_model(s);
	}
	printf(
		"# %d systems, %d crossings, worst end state off by %.2g; "
		"wrong by signs at step ends, h = 0.5, 1, 2, 4: %d %d %d %d\n",
		systems, (int)crossings, worst, by_signs[0], by_signs[1], by_signs[2], by_signs[3]);
}

/* Parts of a step come to where the step does: NAME_at. */
void parts_of_a_step(void **state)
{
	double x[N];
	int i, j, n;
	(void)state;
	for (i = 0; i < 20; i++) {
		model *s = random_model(x), *parts;
		build(s, 1.0);
		start(s, x);
		parts = new_model(s->states, s->m.size, s->m.switches);
		memcpy(parts->x, s->x, sizeof s->x);
		parts->c = s->c;
		for (n = 0; n < 20; n++) {
			step(s);
			for (j = 0; j < 3; j++)
				pl_switching_advance(&s->m, (real)((j + 1) / 6.0), parts->x, &parts->c, s->crossing,
						s->work);
			for (j = 0; j < s->states; j++)
				assert_near(parts->x[j], s->x[j], 1e-11, "in parts", i);
		}
		assert_count(s, parts->c.total, "in parts", i);
		free_model(parts);
		free_model(s);
	}
}
