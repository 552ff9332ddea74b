/* SPDX-License-Identifier: MIT-0 */
/* Frequencies that change while a model runs: the phase goes on from where it is. Beside the closed form of an
 * oscillator that such a load drives, whose phase is summed segment by segment here. TOLERANCE: of the scheme. */
#include "phase_pl.h"
#include "tap.h"
#include "worse.h"

#include <float.h>
#include <math.h>
#include <string.h>

#ifdef REAL_FLOAT
typedef float real;
#define MODEL pl_modelf
#define EPSILON FLT_EPSILON
static const double far = 300;
#else
typedef double real;
#define MODEL pl_model
#define EPSILON DBL_EPSILON
static const double far = 1e5;
#endif

enum { STEPS = 1000, CHANGES = 4, MANY = 1000, A = 0, TURN = 1, SLOW = 2 };

static const MODEL *const model = &phase_model;
static const long double turn = 6.283185307179586476925286766559L;

/* ---- what is expected ---- */

struct truth {
	double f, w, F, lag;                    /* from t = since on */
	bool drives;                            /* f is that of the load on a, too */
	long double since, turned, slowed;      /* 2 pi f t and w t there, as they have gone on */
	double a, v;                            /* there */
};

/* Params by their names: a model has those that it can have */
static void take(struct truth *truth, const char *name, double value, real *params)
{
	double *const known[] = {&truth->f, &truth->w, &truth->F, &truth->lag};
	static const char *const names[] = {"f", "w", "F", "lag"};
	for (int k = 0; k < model->params; k++)
		if (strcmp(model->param_names[k], name) == 0) {
			params[k] = (real)value;
			for (int i = 0; i < 4; i++)
				if (strcmp(names[i], name) == 0)
					*known[i] = (double)params[k];
		}
}

static bool has(const char *name)
{
	for (int k = 0; k < model->params; k++)
		if (strcmp(model->param_names[k], name) == 0)
			return true;
	return false;
}

static struct truth truth_of_start(void)
{
	struct truth start = {0.7, 4, 2, 0.5, has("F"), 0, 0, 0, 0, 0};
	real params[PHASE_PARAMS];
	for (int k = 0; k < model->params; k++)
		take(&start, model->param_names[k], (double)model->param_values[k], params);
	return start;
}

/* a'' + 9 a = F cos(W s + p): the state s after its start */
static void oscillate(const struct truth *truth, long double s, double *a, double *v)
{
	const long double f = 0.7L, of_load = truth->drives ? truth->f : f, W = turn * of_load;
	const long double since = turn * f * truth->since, p = (truth->drives ? truth->turned : since) + 0.3L;
	const long double F = truth->F, start = truth->a, speed = truth->v; /* tcc takes no double times a long one */
	const long double size = F / (9 - W * W), A0 = start - size * cosl(p), B0 = (speed + size * W * sinl(p)) / 3;
	*a = (double)(A0 * cosl(3 * s) + B0 * sinl(3 * s) + size * cosl(W * s + p));
	*v = (double)(3 * (B0 * cosl(3 * s) - A0 * sinl(3 * s)) - size * W * sinl(W * s + p));
}

static void expected(const struct truth *truth, double t, double out[3])
{
	const long double s = t - truth->since;
	double v;
	oscillate(truth, s, &out[A], &v);
	out[TURN] = (double)sinl(truth->turned + turn * truth->f * s);
	const long double behind = has("lag") ? truth->w * truth->lag : 2;
	out[SLOW] = (double)cosl(truth->slowed + truth->w * s - behind);
}

static void go_on(struct truth *truth, double t)
{
	const long double s = t - truth->since;
	oscillate(truth, s, &truth->a, &truth->v);
	truth->turned += turn * truth->f * s;
	truth->slowed += truth->w * s;
	truth->since = t;
}

/* ---- changes on the way ---- */

static const struct { int step; double f, w, F, lag; } change[CHANGES] = {
	{130, 1.3, 7, 2, 0.5}, {402, 0.2, 1, 1, 0.5}, {750, 0.9, 4.5, 1.5, 0.8}, {811, 0.7, 4, 2, 0.5}};

static int change_at(int k)
{
	int i = 0;
	while (i < CHANGES && change[i].step != k)
		i++;
	return i;
}

static void retune(phase *s, struct truth *truth, int k)
{
	const int i = change_at(k);
	phase_coeffs c = phase_nominal;
	real params[PHASE_PARAMS];
	if (i == CHANGES)
		return;
	memcpy(params, model->param_values, sizeof params);
	go_on(truth, k * (double)PHASE_H);
	take(truth, "f", change[i].f, params);
	take(truth, "w", change[i].w, params);
	take(truth, "F", change[i].F, params);
	take(truth, "lag", change[i].lag, params);
	phase_retune(&c, params, PHASE_H);
	phase_use(s, &c);
}

static void compare(double worst[3], const real *found, const double *truth)
{
	for (int i = 0; i < 3; i++)
		worst[i] = worse(worst[i], fabs((double)found[i] - truth[i]));
}

static void follows(void)
{
	static phase s, copy;
	struct truth truth = truth_of_start();
	double worst[3] = {0, 0, 0}, within = 0, jump = 0, out[3];
	real row[3], before[3], y[PHASE_STATES];
	bool same = true;
	phase_init(&s);
	for (int k = 0; k < STEPS; k++) {
		phase_out(&s, before);
		retune(&s, &truth, k);
		phase_out(&s, row);
		jump = worse(jump, fabs((double)row[TURN] - (double)before[TURN]));
		if (model->at && k % 50 == 2) {
			model->at(&s, NULL, PHASE_H / 2, y);
			expected(&truth, (k + 0.5) * (double)PHASE_H, out);
			within = worse(within, fabs((double)y[0] - out[A]));
		}
		if (k == 450)
			copy = s;
		phase_step(&s);
		phase_out(&s, row);
		expected(&truth, (k + 1) * (double)PHASE_H, out);
		compare(worst, row, out);
	}
	ok(worst[A] <= TOLERANCE, "a driven oscillator, %d changes: the closed form within %.0e "
		"(%.2g)", CHANGES, TOLERANCE,
		worst[A]);
	ok(within <= TOLERANCE, "inside steps too (%.2g)", within);
	const double bound = 100 * EPSILON;     /* 2 pi f t is 57 at most */
	ok(worst[TURN] <= bound && worst[SLOW] <= bound, "outputs: within %.1e (%.2g, %.2g)", bound, worst[TURN],
		worst[SLOW]);
	ok(jump <= bound, "no jump of them (%.2g)", jump);

	static real rows[STEPS][3];
	truth = truth_of_start();
	for (int k = 450; k < STEPS; k++) {
		int next = k;
		retune(&copy, &truth, k);
		do
			next++;
		while (next < STEPS && change_at(next) == CHANGES);
		phase_run(&copy, (size_t)(next - k), rows[k]);
		k = next - 1;
	}
	for (int i = 0; i < 3; i++)
		same = same && row[i] == rows[STEPS - 1][i];
	ok(same, "a copy, by NAME_run: the same bits");
}

/* A state that is set: sines are those of the params as they are, from t = 0 on. */
static void begins(void)
{
	static phase s;
	struct truth truth = truth_of_start();
	real row[3], y[PHASE_STATES] = {0};
	double out[3];
	phase_init(&s);
	for (int k = 0; k <= 402; k++) {
		retune(&s, &truth, k);
		phase_step(&s);
	}
	phase_set(&s, (real)7, y);
	phase_out(&s, row);
	truth.since = truth.turned = truth.slowed = 0;
	expected(&truth, 7, out);
	ok(fabs((double)row[TURN] - out[TURN]) <= 40 * EPSILON && fabs((double)row[SLOW] - out[SLOW]) <= 40 * EPSILON,
		"set: phases from t = 0 on (%.2g, %.2g)", fabs((double)row[TURN] - out[TURN]),
		fabs((double)row[SLOW] - out[SLOW]));
	phase_init(&s);
	for (int k = 0; k < 7; k++)
		phase_step(&s);
	phase_out(&s, row);
	const double off = fabs((double)row[TURN] - sin(6.283185307179586 * (double)(real)0.7 * 7 * (double)PHASE_H));
	ok(off <= 4 * EPSILON, "init: too (%.2g)", off);
}

/* Far into a run many changes add nothing to what the product w t is off by. */
static void lasts(void)
{
	static phase s;
	struct truth truth = truth_of_start();
	real row[3], y[PHASE_STATES] = {0}, params[PHASE_PARAMS];
	double out[3];
	phase_init(&s);
	phase_set(&s, (real)far, y);
	go_on(&truth, far);
	memcpy(params, model->param_values, sizeof params);
	for (int k = 0; k < MANY; k++) {
		phase_coeffs c = phase_nominal;
		take(&truth, "f", 0.7 + 0.5 * sin(k), params);
		take(&truth, "w", 4 + 3 * sin(1.7 * k), params);
		phase_retune(&c, params, PHASE_H);
		phase_use(&s, &c);
		phase_step(&s);
		go_on(&truth, (double)phase_time(&s));
	}
	phase_out(&s, row);
	expected(&truth, (double)phase_time(&s), out);
	const double bound = 4 * EPSILON * 6.3 * 1.2 * far, off = fabs((double)row[TURN] - out[TURN]),
				 slow = fabs((double)row[SLOW] - out[SLOW]);
	ok(off <= bound && slow <= bound, "%d changes from t = %g on: within %.1e (%.2g, %.2g)", MANY, far, bound, off,
		slow);
}

int main(void)
{
	follows();
	begins();
	lasts();
	return tap_end();
}
