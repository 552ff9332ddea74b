/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Taylor series by automatic differentiation, in libquadmath's __float128.
 *
 * A model is a tape: nodes in the order of their evaluation, each with its coefficients c_k of (t - t0)^k. Coefficient
 * k of every node is found from coefficients of those before it (Griewank and Walther, Evaluating Derivatives, ch. 13;
 * Moore), then q_{k+1} = v_k/(k + 1), v_{k+1} = a_k/(k + 1). A step is as long as its last two terms allow
 * (Jorba and Zou, Experimental Mathematics 14, 2005), and ends of units and their insides are read from the series. */
#include "quad_taylor.h"
#include "quad_beam.h"

#include <math.h>
#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

typedef __float128 quad;
enum { ORDER = 40, MOST_NODES = 80, MOST_COORDINATES = 4 };

quad quad_of_decimal(double x)
{
	char text[40];
	snprintf(text, sizeof text, "%.12e", x);
	return strtod(text, NULL) == x ? strtoflt128(text, NULL) : (quad)x;
}

/* ---- the tape ---- */

/* SIN has its cosine in the node after it, which is its b, and COS its sine in the node before it */
enum op { LEAF, ADD, SUBTRACT, TIMES, OVER, SCALED, SHIFTED, ROOT, SIN, COS };

struct node {
	enum op op;
	int a, b;                       /* nodes before this one */
	quad factor;                    /* SCALED: times; SHIFTED: plus */
	quad c[ORDER + 1];
};

struct tape {
	int n, count;
	int time, q, v;                 /* nodes: t, the first coordinate, the first velocity; the others follow */
	int acceleration[MOST_COORDINATES];
	struct node node[MOST_NODES];
};

static int push(struct tape *x, enum op op, int a, int b, quad factor)
{
	if (x->count == MOST_NODES)
		leave("quad_taylor", "a tape is full");
	struct node *node = &x->node[x->count];
	node->op = op;
	node->a = a;
	node->b = b;
	node->factor = factor;
	return x->count++;
}

#define add(x, a, b) push(x, ADD, a, b, 0)
#define subtract(x, a, b) push(x, SUBTRACT, a, b, 0)
#define times(x, a, b) push(x, TIMES, a, b, 0)
#define over(x, a, b) push(x, OVER, a, b, 0)
#define scaled(x, factor, a) push(x, SCALED, a, 0, factor)
#define shifted(x, by, a) push(x, SHIFTED, a, 0, by)
#define root(x, a) push(x, ROOT, a, 0, 0)

/* The sine; its cosine is the node after it */
static int sine(struct tape *x, int a)
{
	const int s = push(x, SIN, a, x->count + 1, 0);
	push(x, COS, a, s, 0);
	return s;
}

static quad convolution(const quad *a, const quad *b, int from, int to, int k)
{
	quad sum = 0;
	for (int j = from; j <= to; j++)
		sum += a[j] * b[k - j];
	return sum;
}

/* sum of j a_j b_{k-j}, j = 1 .. k, over k */
static quad slope_of_chain(const quad *a, const quad *b, int k)
{
	quad sum = 0;
	for (int j = 1; j <= k; j++)
		sum += j * a[j] * b[k - j];
	return sum / k;
}

static void coefficient(struct tape *x, int at, int k)
{
	struct node *node = &x->node[at];
	const quad *a = x->node[node->a].c, *b = x->node[node->b].c;
	quad *c = node->c;
	switch (node->op) {
	case LEAF:
		return;
	case ADD:
		c[k] = a[k] + b[k];
		return;
	case SUBTRACT:
		c[k] = a[k] - b[k];
		return;
	case TIMES:
		c[k] = convolution(a, b, 0, k, k);
		return;
	case OVER:
		c[k] = (a[k] - convolution(c, b, 0, k - 1, k)) / b[0];
		return;
	case SCALED:
		c[k] = node->factor * a[k];
		return;
	case SHIFTED:
		c[k] = a[k] + (k == 0 ? node->factor : 0);
		return;
	case ROOT:
		c[k] = k == 0 ? sqrtq(a[0]) : (a[k] - convolution(c, c, 1, k - 1, k)) / (2 * c[0]);
		return;
	case SIN:
		c[k] = k == 0 ? sinq(a[0]) : slope_of_chain(a, b, k);
		return;
	case COS:
		c[k] = k == 0 ? cosq(a[0]) : -slope_of_chain(a, b, k);
		return;
	}
}

/* All coefficients at (t, y) */
static void expand(struct tape *x, quad t, const quad *y)
{
	const int n = x->n;
	memset(x->node[x->time].c, 0, sizeof x->node->c);
	x->node[x->time].c[0] = t;
	x->node[x->time].c[1] = 1;
	for (int i = 0; i < 2 * n; i++)
		x->node[x->q + i].c[0] = y[i];
	for (int k = 0; k < ORDER; k++) {
		for (int at = x->v + n; at < x->count; at++)
			coefficient(x, at, k);
		for (int i = 0; i < n; i++) {
			x->node[x->q + i].c[k + 1] = x->node[x->v + i].c[k] / (k + 1);
			x->node[x->v + i].c[k + 1] = x->node[x->acceleration[i]].c[k] / (k + 1);
		}
	}
}

/* ---- the equations, as the specs have them ---- */

static void pendulum(struct tape *x)
{
	x->acceleration[0] = scaled(x, -1, sine(x, x->q));
}

/* mu (1 - q^2) v - q */
static int relaxation(struct tape *x, quad mu, int q, int v)
{
	const int damping = shifted(x, 1, scaled(x, -1, times(x, q, q)));
	return subtract(x, scaled(x, mu, times(x, damping, v)), q);
}

static void vanderpol(struct tape *x)
{
	x->acceleration[0] = relaxation(x, 1, x->q, x->v);
}

static void vanderpol_stiff(struct tape *x)
{
	x->acceleration[0] = relaxation(x, 100, x->q, x->v);
}

static void vanderpol_stiffer(struct tape *x)
{
	x->acceleration[0] = relaxation(x, 1000, x->q, x->v);
}

static void henon_heiles(struct tape *x)
{
	const int p = x->q, q = x->q + 1, product = times(x, p, q);
	x->acceleration[0] = scaled(x, -1, add(x, p, scaled(x, 2, product)));
	x->acceleration[1] = subtract(x, subtract(x, times(x, q, q), times(x, p, p)), q);
}

static void duffing(struct tape *x)
{
	const int cube = times(x, times(x, x->q, x->q), x->q);
	const int wave = sine(x, scaled(x, 1.4Q, x->time)) + 1;
	const int force = subtract(x, scaled(x, 0.5Q, wave), scaled(x, 0.2Q, x->v));
	x->acceleration[0] = subtract(x, force, add(x, x->q, cube));
}

static void mathieu(struct tape *x)
{
	const int wave = sine(x, scaled(x, 2, x->time)) + 1;
	const int stiffness = shifted(x, -1, scaled(x, 0.4Q, wave));
	x->acceleration[0] = subtract(x, times(x, stiffness, x->q), scaled(x, 0.1Q, x->v));
}

static void coupled_vanderpol(struct tape *x)
{
	const int p = x->q, q = x->q + 1, pull = scaled(x, 0.3Q, subtract(x, q, p));
	x->acceleration[0] = add(x, relaxation(x, 1, p, x->v), pull);
	x->acceleration[1] = subtract(x, subtract(x, relaxation(x, 1, q, x->v + 1), scaled(x, 0.2Q, q)), pull);
}

static void double_pendulum(struct tape *x)
{
	const int v = x->v, w = x->v + 1;
	const int s1 = sine(x, x->q), s2 = sine(x, x->q + 1), s = sine(x, subtract(x, x->q, x->q + 1)), c = s + 1;
	const int first = add(x, times(x, s, times(x, w, w)), scaled(x, 2, s1));
	const int second = subtract(x, times(x, s, times(x, v, v)), s2);
	const int mass = shifted(x, 2, scaled(x, -1, times(x, c, c)));
	x->acceleration[0] = over(x, scaled(x, -1, add(x, first, times(x, c, second))), mass);
	x->acceleration[1] = over(x, add(x, scaled(x, 2, second), times(x, c, first)), mass);
}

static void rayleigh(struct tape *x)
{
	const int damping = shifted(x, 1, scaled(x, -1, times(x, x->v, x->v)));
	x->acceleration[0] = subtract(x, times(x, damping, x->v), x->q);
}

static void duffing_pair(struct tape *x)
{
	const int pull = scaled(x, 0.5Q, subtract(x, x->q + 1, x->q));
	const int wave = sine(x, scaled(x, 1.2Q, x->time)) + 1;
	for (int i = 0; i < 2; i++) {
		const int q = x->q + i, v = x->v + i;
		const int speed = root(x, shifted(x, 0.01Q, times(x, v, v)));
		const int drag = scaled(x, 0.1Q, times(x, v, speed));
		const int spring = add(x, q, times(x, q, times(x, q, q)));
		const int own = scaled(x, -1, add(x, spring, drag));
		x->acceleration[i] = i == 0 ? add(x, add(x, own, pull), scaled(x, 0.5Q, wave)) : subtract(x, own, pull);
	}
}

static void spherical_pendulum(struct tape *x)
{
	const int s = sine(x, x->q), c = s + 1, v = x->v, w = x->v + 1;
	const int turn = times(x, times(x, s, c), times(x, w, w));
	x->acceleration[0] = subtract(x, turn, s);
	x->acceleration[1] = scaled(x, -2, over(x, times(x, c, times(x, v, w)), s));
}

static const struct { const char *name; int n; void (*write)(struct tape *x); } models[] = {
	{ "pendulum", 1, pendulum }, { "vanderpol", 1, vanderpol }, { "vanderpol_stiff", 1, vanderpol_stiff },
	{ "vanderpol_stiffer", 1, vanderpol_stiffer },
	{ "quad2dof", 2, henon_heiles }, { "duffing", 1, duffing }, { "mathieu", 1, mathieu },
	{ "henon_heiles", 2, henon_heiles }, { "coupled_vanderpol", 2, coupled_vanderpol },
	{ "double_pendulum", 2, double_pendulum }, { "rayleigh", 1, rayleigh }, { "duffing_pair", 2, duffing_pair },
	{ "spherical_pendulum", 2, spherical_pendulum },
};
enum { MODELS = sizeof models / sizeof *models };

/* -1: none */
static int model_of(const struct problem *p)
{
	for (int i = 0; i < MODELS; i++)
		if (strcmp(models[i].name, p->name) == 0 && models[i].n == p->n)
			return i;
	return -1;
}

bool quad_taylor_has(const struct problem *p)
{
	return model_of(p) >= 0 || quad_beam_has(p);
}

/* ---- steps ---- */

static void start_tape(struct tape *x, int n)
{
	memset(x, 0, sizeof *x);
	x->n = n;
	x->time = push(x, LEAF, 0, 0, 0);
	x->q = x->count;
	x->v = x->q + n;
	for (int i = 0; i < 2 * n; i++)
		push(x, LEAF, 0, 0, 0);
}

static void horner(const struct tape *x, quad s, quad *y)
{
	for (int i = 0; i < 2 * x->n; i++) {
		const quad *c = x->node[x->q + i].c;
		quad sum = c[ORDER];
		for (int k = ORDER - 1; k >= 0; k--)
			sum = sum * s + c[k];
		y[i] = sum;
	}
}

struct scales { quad q, v; };

static void see(struct scales *largest, int n, const quad *y)
{
	for (int i = 0; i < n; i++) {
		largest->q = fmaxq(largest->q, fabsq(y[i]));
		largest->v = fmaxq(largest->v, fabsq(y[n + i]));
	}
}

/* So long that the last two terms are below 1e-29 of the largest values so far */
static quad step_length(const struct tape *x, const struct scales *largest)
{
	quad h = 1e10Q;
	for (int k = ORDER - 1; k <= ORDER; k++)
		for (int i = 0; i < 2 * x->n; i++) {
			const quad size = fabsq(x->node[x->q + i].c[k]) / (i < x->n ? largest->q : largest->v);
			if (size > 0)
				h = fminq(h, powq(1e-29Q / size, 1.0Q / k));
		}
	if (!(h > 1e-9Q) || !(h <= 1e10Q))
		leave("quad_taylor", "a step vanishes");
	return fminq(h, 1);
}

/* The inside of a step, for the scales: a peak lies between what is kept */
static void see_inside(const struct tape *x, quad h, struct scales *largest)
{
	enum { PARTS = 8 };
	quad y[2 * MOST_COORDINATES];
	for (int k = 1; k <= PARTS; k++) {
		horner(x, h * k / PARTS, y);
		see(largest, x->n, y);
	}
}

/* What lies in [from, from + h] goes into the truth; `next` counts insides (even) and ends (odd) of units */
static void keep(const struct tape *x, quad from, quad h, quad unit, struct truth *t, long *next)
{
	quad y[2 * MOST_COORDINATES];
	for (; *next < 2L * t->units; ++*next) {
		const long k = *next / 2;
		const quad at = (*next % 2 ? k + 1 : k + (quad)TRUTH_BETWEEN) * unit;
		if (at > from + h)
			return;
		horner(x, at - from, y);
		for (int i = 0; i < 2 * x->n; i++)
			(*next % 2 ? t->at_end : t->between)[k * 2 * x->n + i] = (double)y[i];
	}
}

void quad_taylor(const struct problem *p, struct truth *t)
{
	static struct tape x;
	const quad unit = quad_of_decimal(p->unit);
	struct scales largest = { 1e-3Q, 1e-3Q };
	quad y[2 * MOST_COORDINATES], now = 0;
	if (quad_beam_has(p)) {
		quad_beam(p, t);
		return;
	}
	const int model = model_of(p);
	start_tape(&x, p->n);
	models[model].write(&x);
	for (int i = 0; i < 2 * p->n; i++)
		y[i] = quad_of_decimal(p->start[i]);
	see(&largest, p->n, y);
	for (long next = 0; next < 2L * t->units;) {
		expand(&x, now, y);
		const quad h = step_length(&x, &largest);
		keep(&x, now, h, unit, t, &next);
		see_inside(&x, h, &largest);
		horner(&x, h, y);
		now += h;
	}
	t->scale_q = (double)largest.q;
	t->scale_v = (double)largest.v;
}
