/* SPDX-License-Identifier: GPL-3.0-or-later */
/* runtime/crossings.c against closed forms and published values; starts on breakpoints, crossings that are easily
 * missed. */
#include "roots.h"
#include "runtime_switched.h"

/* ---- closed forms ---- */

const double several_steps[SEVERAL] = {0.01, 0.1, 1.0, 4.0};

static void bilinear_period(void **state)
{
	static const double from[5] = {0.0, 1.0, 1.0, 1.0, 0.0};
	const double w1 = 1.0, w2 = 3.0, period = acos(-1.0) * (1.0 / w1 + 1.0 / w2);
	int i, k, n;
	(void)state;
	for (i = 0; i < SEVERAL; i++) {
		model *s = single(w1 * w1, 0.0, 0.0, 1.0, 0.0, 1, 0.0, 0.0);
		spring(s, 0, 1, 0, w2 * w2 - w1 * w1, 0.0);
		build(s, several_steps[i]);
		start(s, from);
		assert_int_equal(s->c.region, 1);
		for (n = 0; s->c.total < 12; n++) {
			const uint64_t before = s->c.total;
			step(s);
			for (k = 0; k < s->c.crossings; k++) {
				const uint64_t count = before + (uint64_t)k + 1;
				const double expected = (double)(count / 2) * period + (count % 2 ? acos(-1.0) / w2
						: 0.0);
				assert_int_equal(s->crossing[k].upward, count % 2 == 0);
				assert_near(n * s->m.h + s->crossing[k].time, expected, 1e-12, "crossing", s->m.h);
			}
		}
		free_model(s);
	}
}

static void stiff_stop(void **state)
{
	static const double from[5] = {0.0, 1.0, 1.0, 1.0, 0.0}, some[] = {0.001, 0.01, 0.1};
	const double contact = 0.03126001526812332;
	int i, n;
	(void)state;
	for (i = 0; i < 3; i++) {
		model *s = single(1e4 / 100.0, 0.0, 0.0, 1.0, 0.0, 1, 0.0, 0.0);
		spring(s, 0, 1, 0, 1e6 / 100.0, 0.0);
		build(s, some[i]);
		start(s, from);
		for (n = 0; s->c.total == 0; n++)
			step(s);
		assert_near(n * s->m.h - s->m.h + s->crossing[0].time, contact, 1e-15, "contact", s->m.h);
		start(s, from);
		for (n = 0; (n + 1) * s->m.h < contact / 2.0; n++)
			step(s);
		pl_switching_advance(&s->m, (real)(contact / 2.0 - n * s->m.h), s->x, &s->c, s->crossing, s->work);
		assert_near(1e6 * s->x[0], 9950.371902, 1e-6, "largest force", s->m.h);
		start(s, from);
		steps(s, (int)(0.2 / s->m.h + 0.5)); /* half a period of 10 rad/s back, from the end of the contact */
		assert_near(10.0 * 10.0 * s->x[0] * s->x[0] + s->x[1] * s->x[1], 1.0, 1e-12, "speed kept", s->m.h);
		assert_near(s->x[0], -sin(10.0 * (0.2 - contact)) / 10.0, 1e-14, "after contact", s->m.h);
		free_model(s);
	}
}

/* ---- gear pairs with clearance ---- */

static model *gear1(double eta)
{
	model *s = single(0.0, 0.1, 0.1, eta, 0.0, 2, -1.0, 1.0);
	couple(s, 3, 0, 0, 0.05);
	spring(s, 0, 0, 0, 1.0, -1.0);
	spring(s, 0, 2, 0, 1.0, 1.0);
	return s;
}

static void gear_of_one(void **state)
{
	static const double from[5] = {1.1, 0.0, 1.0, 1.0, 0.0}, h[] = {0.01, 0.1, 1.0};
	int i;
	(void)state;
	for (i = 0; i < 3; i++) {
		model *s = gear1(0.8);
		build(s, h[i]);
		start(s, from);
		steps(s, (int)(50.0 / h[i] + 0.5));
		assert_near(s->x[0], 1.3462716421777, 1e-12, "eta 0.8, q", h[i]);
		assert_near(s->x[1], 0.0182023595639939, 1e-12, "eta 0.8, q'", h[i]);
		assert_count(s, 12, "eta 0.8", h[i]);
		free_model(s);
		s = gear1(1.0);
		build(s, h[i]);
		start(s, from);
		steps(s, (int)(50.0 / h[i] + 0.5));
		assert_near(s->x[0], 0.9044965191187, 1e-12, "eta 1, q", h[i]);
		assert_near(s->x[1], 0.0052437460534, 1e-12, "eta 1, q'", h[i]);
		assert_count(s, 15, "eta 1", h[i]);
		free_model(s);
	}
}

static void gear_of_two(void **state)
{
	static const double from[7] = {1.2, 0.1, 0.0, 0.0, 1.0, 1.0, 0.0}, h[] = {0.01, 0.1, 1.0};
	static const double expected[4] = {1.255478222291, 0.278107931790, -0.141334496941, -0.146319581244};
	static const double Om[2][2] = {{1.0, -0.5}, {-0.5, 1.0}};
	int i, j, r;
	(void)state;
	for (r = 0; r < 3; r++) {
		model *s = oscillator(2, 1, 0.8);
		s->row[0] = 1.0;
		s->breaks[0] = 2;
		s->at[0] = -1.0;
		s->at[1] = 1.0;
		for (i = 0; i < 2; i++) {
			couple(s, 0, i, 1, -Om[i][1]);
			for (j = 0; j < 2; j++)
				couple(s, 2, i, j, -0.1 * Om[i][j]);
			spring(s, 0, 0, i, Om[i][0], -1.0);
			spring(s, 0, 2, i, Om[i][0], 1.0);
		}
		couple(s, 4, 0, 0, 0.1);
		couple(s, 4, 1, 0, 0.05);
		couple(s, 5, 0, 0, 0.05);
		build(s, h[r]);
		start(s, from);
		steps(s, (int)(20.0 / h[r] + 0.5));
		for (i = 0; i < 4; i++)
			assert_near(s->x[i], expected[i], 2e-12, "gear2", h[r]);
		assert_count(s, 2, "gear2", h[r]);
		free_model(s);
	}
}

/* ---- crossings that are easily missed ---- */

/* x = (1 + d) sin t towards a breakpoint at 1 */
static void grazing(void **state)
{
	int i, power, sign;
	(void)state;
	for (i = 0; i < SEVERAL; i++)
		for (power = 2; power <= LEAST_GRAZING; power++)
			for (sign = -1; sign <= 1; sign++) {
				const double d = sign * pow(10.0, -power), h = several_steps[i],
							 from[5] = {0.0, 1.0 + d, 1.0, 1.0, 0.0};
				model *s = single(1.0, 0.0, 0.0, 1.0, 0.0, 1, 1.0, 0.0);
				int n;
				spring(s, 0, 1, 0, 5.0, 1.0);
				build(s, h);
				start(s, from);
				for (n = 0; n * h < 4.0 && s->c.total == 0; n++)
					step(s);
				if (sign > 0) {
					assert_near((n - 1) * h + s->crossing[0].time, asin(1.0 / (1.0 + d)),
							4e-15 / sqrt(d), "grazing",
								h);
					for (; n * h < 4.0; n++)
						step(s);
				}
				assert_count(s, sign > 0 ? 2 : 0, "grazing", d);
				free_model(s);
			}
}

/* Free flight, x = p + d^2/8 - (t - c)^2/2 with p the breakpoint: two crossings d apart around t = c in the one step of
 * 1 */
static void two_crossings_in_a_step(void **state)
{
	static const double when[] = {0.001, 0.1, 0.5, 0.50001, 0.77, 0.999};
	int i, power;
	(void)state;
	for (i = 0; i < 6; i++)
		for (power = FIRST_APART; power <= LAST_APART; power++) {
			const double c = when[i], d = pow(10.0, -power),
						 from[5] = {3.0 + d * d / 8.0 - c * c / 2.0, c, 1.0, 1.0, 0.0};
			model *s;
			if (c <= d / 2.0 || c >= 1.0 - d / 2.0) /* not both within the step */
				continue;
			s = single(0.0, 0.0, -1.0, 1.0, 0.0, 1, 3.0, 0.0);
			spring(s, 0, 1, 0, 1e-3, 3.0);
			build(s, 1.0);
			start(s, from);
			step(s);
			assert_count(s, 2, "two crossings", d);
			assert_near(s->crossing[0].time, c - d / 2.0, 8e-15 / d, "first", c);
			assert_near(s->crossing[1].time, c + d / 2.0, 8e-15 / d, "second", c);
			assert_near(s->x[1], c - 1.0, 1e-12, "velocity", c);
			free_model(s);
		}
}

/* A load that is a polynomial in t with the given roots, as a switch of its own: a step of 1 that meets them all, and
 * its slope at the ends need not tell.  In between the mass is pushed one way or the other. */
static model *polynomial(const double *root, int roots)
{
	model *s = new_model(2, 8, 1);
	const int n = s->m.size;
	double product[6] = {1.0}, factorial = 1.0;
	int i, k;
	s->base[1] = 1.0;
	for (i = 3; i < n; i++)
		s->base[i * n + i - 1] = 1.0; /* 1, t, t^2/2, ... */
	for (i = 0; i < roots; i++)
		for (k = i + 1; k >= 0; k--)
			product[k] = (k > 0 ? product[k - 1] : 0.0) - root[i] * product[k];
	for (k = 0; k <= roots; factorial *= ++k)
		s->row[2 + k] = (real)(product[k] * factorial);
	s->breaks[0] = 1;
	s->add[0][0][n + 2] = -1.0;
	s->add[0][1][n + 2] = 1.0;
	build(s, 1.0);
	return s;
}

static double slope_at(const double *root, int roots, int i)
{
	double slope = 1.0;
	int j;
	for (j = 0; j < roots; j++)
		slope *= j == i ? 1.0 : fabs(root[i] - root[j]);
	return slope;
}

/* Whether the load rises above noise between the roots */
static int told_apart(const double *root, int roots)
{
	int i;
	for (i = 1; i < roots; i++)
		if (slope_at(root, roots, i) * (root[i] - root[i - 1]) < 1e-12 * COARSER)
			return 0;
	return 1;
}

static void all_roots_of_a_load(void **state)
{
	static const double from[8] = {0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0};
	int trial, i;
	(void)state;
	for (trial = 0; trial < samples(3000); trial++) {
		const int roots = 1 + trial % 5;
		const double apart = pow(10.0, -uniform(1.0, 4.0));
		double root[5], v = 0.0, last = 0.0;
		model *s;
		root[0] = uniform(0.001, 0.5);
		for (i = 1; i < roots; i++)
			root[i] = root[i - 1] + (below(2) ? apart : uniform(0.01, 0.1));
		if (!told_apart(root, roots))
			continue;
		s = polynomial(root, roots);
		start(s, from);
		step(s);
		assert_count(s, (uint64_t)roots, "roots of a load", trial);
		for (i = 0; i < roots; i++) {
			const double sign = (roots - i) % 2 ? -1.0 : 1.0;
			assert_near(s->crossing[i].time, root[i], 4e-15 + 4e-15 / slope_at(root, roots, i), "root",
					trial);
			assert_int_equal(s->crossing[i].upward, sign < 0.0);
			v += sign * (s->crossing[i].time - last);
			last = s->crossing[i].time;
		}
		assert_near(s->x[1], v + (1.0 - last), 1e-14, "pushed", trial);
		free_model(s);
	}
}

/* e = 1 - 16 (1 + d) t^2 (1 - t)^2: 1 and level at both ends of the step, and below 0 in its middle */
static void hidden_in_the_middle(void **state)
{
	static const double from[8] = {0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0}, root = 0.5;
	int power;
	(void)state;
	for (power = 1; power <= LEAST_HIDDEN; power++) {
		const double d = pow(10.0, -power), c = 16.0 * (1.0 + d), off = 0.5 * sqrt(1.0 - 1.0 / sqrt(1.0 + d));
		const real row[8] = {0, 0, 1, 0, (real)(-2.0 * c), (real)(12.0 * c), (real)(-24.0 * c), 0};
		model *s = polynomial(&root, 1);
		memcpy(s->row, row, sizeof row);
		build(s, 1.0);
		start(s, from);
		step(s);
		assert_count(s, 2, "hidden in the middle", d);
		assert_near(s->crossing[0].time, 0.5 - off, 1e-14 / sqrt(d), "down", d);
		assert_near(s->crossing[1].time, 0.5 + off, 1e-14 / sqrt(d), "up", d);
		free_model(s);
	}
}

/* Through a narrow interval, both ways, by x = 2 sin t */
static void narrow_interval(void **state)
{
	static const double from[5] = {0.0, 2.0, 1.0, 1.0, 0.0};
	int i, k;
	(void)state;
	for (i = 0; i < SEVERAL; i++) {
		const double h = several_steps[i];
		model *s = single(1.0, 0.0, 0.0, 1.0, 0.0, 2, 1.0, 1.0 + NARROW);
		int n;
		build(s, h);
		start(s, from);
		for (n = 0; n * h < 4.0; n++) {
			step(s);
			for (k = 1; k < s->c.crossings; k++)
				assert_true(s->crossing[k - 1].time <= s->crossing[k].time);
		}
		assert_count(s, 4, "narrow interval", h);
		assert_near(s->x[0], 2.0 * sin(n * h), 1e-12, "nothing changed", h);
		free_model(s);
	}
}

model *one_stop(double h)
{
	model *s = single(1.0, 0.0, 0.0, 1.0, 0.0, 1, 1.0, 0.0);
	spring(s, 0, 1, 0, 8.0, 1.0);
	build(s, h);
	return s;
}

/* Two alike masses that meet their stops together */
static model *twins(double h)
{
	model *s = oscillator(2, 2, 1.0);
	int i;
	s->breaks[0] = s->breaks[1] = 1;
	s->at[0] = s->at[1] = 1.0;
	s->row[0] = s->row[s->m.size + 1] = 1.0;
	for (i = 0; i < 2; i++) {
		couple(s, 0, i, i, -1.0);
		spring(s, i, 1, i, 8.0, 1.0);
	}
	build(s, h);
	return s;
}

/* One stop said twice, x > 1 and -x < -1: two regions cannot occur. */
static model *said_twice(double h)
{
	model *s = single(1.0, 0.0, 0.0, 1.0, 0.0, 1, 1.0, 0.0);
	s->m.switches = 2;
	s->breaks[1] = 1;
	s->at[1] = -1.0;
	s->row[s->m.size] = -1.0;
	spring(s, 0, 1, 0, 3.0, 1.0);
	spring(s, 1, 0, 0, -5.0, -1.0);
	build(s, h);
	s->matrix[0] = s->matrix[3] = -1;
	return s;
}

static void together(void **state)
{
	static const double one[5] = {0.0, 2.0, 1.0, 1.0, 0.0}, two[7] = {0.0, 0.0, 2.0, 2.0, 1.0, 1.0, 0.0};
	int i, n;
	(void)state;
	for (i = 0; i < SEVERAL; i++) {
		const double h = several_steps[i];
		model *a = one_stop(h), *b = twins(h), *c = said_twice(h);
		start(a, one);
		start(b, two);
		start(c, one);
		assert_int_equal(c->c.region, 2);
		for (n = 0; n * h < 20.0; n++) {
			step(a);
			step(b);
			step(c);
			assert_near(b->x[0], a->x[0], 1e-12, "first twin", h);
			assert_near(b->x[1], a->x[0], 1e-12, "second twin", h);
			assert_near(c->x[0], a->x[0], 1e-12, "said twice", h);
		}
		assert_count(b, 2 * a->c.total, "twins", h);
		assert_count(c, 2 * a->c.total, "said twice", h);
		free_model(a);
		free_model(b);
		free_model(c);
	}
}

/* ---- starts and jumps ---- */

static void assert_region(model *s, double q, double v, double u, int expected, const char *what)
{
	const double x[5] = {q, v, 1.0, u, 0.0};
	start(s, x);
	if (s->c.region != expected || s->c.matrix != s->matrix[expected])
		fail_msg("%s, from %.17g, %.17g: region %d, matrix %d; expected %d", what, q, v, s->c.region,
				s->c.matrix,
				 expected);
	assert_count(s, 0, what, q);
}

static void starts_on_a_breakpoint(void **state)
{
	model *s = single(0.0, 0.0, 0.0, 0.0, 0.0, 2, -1.0, 1.0);
	(void)state;
	couple(s, 3, 0, 0, 1.0); /* x'' = u, held, and a soft stop above */
	spring(s, 0, 2, 0, 3.0, 1.0);
	build(s, 0.1);
	assert_region(s, 1.0, 1e-3, 0.0, 2, "moving up");
	assert_region(s, 1.0, -1e-3, 0.0, 1, "moving down");
	assert_region(s, 1.0, 0.0, 1e-3, 2, "pushed up");
	assert_region(s, 1.0, 0.0, -1e-3, 1, "pushed down");
	assert_region(s, 1.0, 0.0, 0.0, 1, "resting");
	assert_region(s, 1.0 + (double)REAL_EPSILON, 0.0, 0.0, 1, "resting, off by rounding");
	assert_region(s, 1.0 + JUST, 0.0, 0.0, 2, "just above");
	assert_region(s, 1.0 - JUST, 1.0, 0.0, 1, "just below");
	assert_region(s, -1.0, 0.0, 0.0, 0, "resting below");
	assert_region(s, -1.0, 1e-9, 0.0, 1, "moving up from below");
	assert_region(s, 0.0, 1e9, 0.0, 1, "in between");
	free_model(s);
}

/* From x where nothing else decides */
static void assert_start(model *s, const double *x, int expected, const char *what)
{
	start(s, x);
	if (s->c.region != expected)
		fail_msg("%s: region %d, expected %d", what, s->c.region, expected);
	free_model(s);
}

static void starts_by_higher_derivatives(void **state)
{
	static const double quarter[5] = {0.0, 0.0, 1.0, 0.0, 1.0}, top[5] = {1.0, 0.0, 1.0, 1.0, 0.0};
	static const double still[5] = {0.0, 0.0, 1.0, 1.0, 0.0}, off[5] = {1e-17, -1.0, 1.0, 1.0, 0.0};
	int i;
	(void)state;
	for (i = 0; i < 2; i++) {
		model *s = single(0.0, 0.0, 0.0, 1.0, 1.0, 1, 0.0, 0.0); /* q - cos t */
		build(s, 0.1);
		assert_start(s, i ? top : quarter, 1, i ? "cos t falls by its second derivative" : "cos t falls");
		s = single(0.0, 0.0, 0.0, 1.0, 0.0, 1, 0.0, 0.0);
		couple(s, 4, 0, 0, i ? 1.0 : -1.0); /* q'' = +- sin t */
		build(s, 0.1);
		assert_start(s, still, i, "the third derivative");
	}
	{
		model *s = single(0.0, 0.0, 0.0, 1.0, 0.0, 1, 0.0, 0.0);
		build(s, 0.1);
		assert_start(s, off, 0, "off by what rounding leaves of a moving mass");
	}
}

/* Where the region of all that is counted as below cannot occur; matrix 0 is of no use then. */
static void starts_where_regions_cannot_occur(void **state)
{
	static const double from[5] = {1.0, 0.0, 1.0, 1.0, 0.0};
	model *s = said_twice(0.1);
	int i;
	(void)state;
	for (i = 0; i < 25; i++)
		s->A[i] = -s->A[i];
	assert_start(s, from, 2, "pulled down");
	s = said_twice(0.1);
	for (i = 0; i < 4; i++)
		s->A[i * 25 + 5 + 2] += 1.0; /* a force that holds it where it is */
	start(s, from);
	assert_true(s->matrix[s->c.region] >= 0);
	free_model(s);
}

/* What rests on a breakpoint, or on one that presses without a gap, stays there without a crossing. */
static void resting(void **state)
{
	static const double from[5] = {1.0, 0.0, 1.0, 1.0, 0.0};
	int i;
	(void)state;
	for (i = 0; i < SEVERAL; i++) {
		model *s = single(1.0, 0.1, 1.0, 1.0, 0.0, 1, 1.0, 0.0); /* at equilibrium */
		spring(s, 0, 1, 0, 8.0, 1.0);
		build(s, several_steps[i]);
		start(s, from);
		steps(s, 200);
		assert_near(s->x[0], 1.0, 1e-14, "resting", several_steps[i]);
		assert_count(s, 0, "resting", several_steps[i]);
		free_model(s);
	}
}

/* The breakpoint moves with a held input: it jumps over the mass and back. */
static void input_jumps(void **state)
{
	static const double from[5] = {0.0, 0.1, 1.0, 0.0, 0.0};
	model *s = single(0.0, 0.0, 0.0, 0.0, 1.0, 2, 1.0, 1.5);
	(void)state;
	spring(s, 0, 2, 0, 1.0, 1.5);
	build(s, 0.1);
	start(s, from);
	step(s);
	assert_int_equal(s->c.crossings, 0);
	s->x[3] = -2.0; /* q - u: from 0.01 to 2.01, past both */
	step(s);
	assert_int_equal(s->c.crossings, 2);
	assert_int_equal(s->c.region, 2);
	assert_true(s->crossing[0].time == 0.0 && s->crossing[0].breakpoint == 0 && s->crossing[0].upward == 1);
	assert_true(s->crossing[1].time == 0.0 && s->crossing[1].breakpoint == 1 && s->crossing[1].upward == 1);
	assert_near(s->x[0], 0.01 + 0.1 * sin(0.1) - 0.51 * (1.0 - cos(0.1)), 1e-15, "pushed", 0.1);
	s->x[3] = 0.0;
	step(s);
	assert_int_equal(s->c.crossings, 2);
	assert_int_equal(s->c.region, 0);
	assert_true(s->crossing[1].breakpoint == 0 && s->crossing[1].upward == 0);
	assert_count(s, 4, "input jumps", 0.1);
	free_model(s);
}

/* Roots of random polynomials below 0 at the start: first ones, by values at many places */
static void tops_are_seen(void **state)
{
	real e[7], c[7], one[1] = {1};
	int t, i, k;
	(void)state;
	for (t = 0; t < 20000; t++) {
		beyond f = {6, c, 0, 0, 0, 0};
		int splits = 100;
		real root;
		for (k = 0; k < 7; k++)
			e[k] = (real)(k ? uniform(-1, 1) / (1 << k) : uniform(-0.05, 0));
		if (!look_beyond(&f, e, 1, 0, sizes(1, one, one)))
			continue;
		root = first_root(&f, 1, &splits);
		for (i = 1; i < 50; i++)
			assert_true(point_of(&f,
					(root < 0 ? 1 : root) * (real)i / 50).g < 16 * f.noise + 4 * REAL_EPSILON);
	}
}

ROOM(crossings,
	cmocka_unit_test(bilinear_period),
	cmocka_unit_test(stiff_stop),
	cmocka_unit_test(gear_of_one),
	cmocka_unit_test(gear_of_two),
	cmocka_unit_test(grazing),
	cmocka_unit_test(two_crossings_in_a_step),
	cmocka_unit_test(all_roots_of_a_load),
	cmocka_unit_test(hidden_in_the_middle),
	cmocka_unit_test(narrow_interval),
	cmocka_unit_test(together),
	cmocka_unit_test(starts_on_a_breakpoint),
	cmocka_unit_test(starts_by_higher_derivatives),
	cmocka_unit_test(starts_where_regions_cannot_occur),
	cmocka_unit_test(resting),
	cmocka_unit_test(input_jumps),
	cmocka_unit_test(chatter),
	cmocka_unit_test(held_behind_the_last),
	cmocka_unit_test(overflow_is_not_chatter),
	cmocka_unit_test(tops_are_seen),
	cmocka_unit_test(bounds_hold),
	cmocka_unit_test(random_systems),
	cmocka_unit_test(parts_of_a_step))
