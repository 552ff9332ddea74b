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
enum op { LEAF, ADD, SUBTRACT, TIMES, OVER, SCALED, ROOT, SIN, COS };

struct node {
	enum op op;
	int a, b;                       /* nodes before this one */
	quad factor;                    /* SCALED: times; of a number: itself */
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

/* A text onto the tape; x, z: coordinates, v, w: their velocities, t: time */
struct reader { struct tape *tape; const char *at; int node['z' + 1]; };

static int sum(struct reader *r);

static bool skips(struct reader *r, const char *text)
{
	const size_t length = strlen(text);
	const bool same = strncmp(r->at, text, length) == 0;
	r->at += same ? length : 0;
	return same;
}

/* A number, a name, sin(...), cos(...), sqrt(...), (...) */
static int factor(struct reader *r)
{
	struct tape *x = r->tape;
	char *end;
	const quad number = strtoflt128(r->at, &end);
	if (end != r->at) {
		const int node = push(x, LEAF, 0, 0, number);
		r->at = end;
		x->node[node].c[0] = number;
		return node;
	}
	const bool root = skips(r, "sqrt"), sin = skips(r, "sin"), cos = skips(r, "cos");
	if (!skips(r, "("))
		return r->node[(int)*r->at++];
	const int inside = sum(r);
	skips(r, ")");
	return root ? push(x, ROOT, inside, 0, 0) : sin || cos ? sine(x, inside) + cos : inside;
}

static int product(struct reader *r)
{
	struct tape *x = r->tape;
	int a = factor(r);
	for (bool times; (times = skips(r, "*")) || skips(r, "/");) {
		const int b = factor(r);
		const struct node *left = &x->node[a];
		a = times && left->op == LEAF && left->factor != 0 ? push(x, SCALED, b, 0, left->factor)
		    : push(x, times ? TIMES : OVER, a, b, 0);
	}
	return a;
}

static int sum(struct reader *r)
{
	struct tape *x = r->tape;
	int a = skips(r, "-") ? push(x, SCALED, product(r), 0, -1) : product(r);
	for (bool plus; (plus = skips(r, " + ")) || skips(r, " - ");)
		a = push(x, plus ? ADD : SUBTRACT, a, product(r), 0);
	return a;
}

/* NAME = SUM; ...: a and b are the accelerations */
static void write_equations(struct tape *x, const char *text)
{
	struct reader r = { x, text,
	                    { ['t'] = x->time, ['x'] = x->q, ['z'] = x->q + 1, ['v'] = x->v, ['w'] = x->v + 1 } };
	while (*r.at) {
		const int name = *r.at;
		r.at += strlen("a = ");
		r.node[name] = sum(&r);
		skips(&r, "; ");
	}
	x->acceleration[0] = r.node['a'];
	x->acceleration[1] = r.node['b'];
}

#define DRAGGED(q, v) "0.1*" v "*sqrt(" v "*" v " + 0.01) - " q " - " q "*" q "*" q
static const struct { const char *name; int n; const char *equations; } models[] = {
	{ "pendulum", 1, "a = -sin(x)" },
	{ "vanderpol", 1, "a = (1 - x*x)*v - x" },
	{ "vanderpol_stiff", 1, "a = 100*((1 - x*x)*v) - x" },
	{ "vanderpol_stiffer", 1, "a = 1000*((1 - x*x)*v) - x" },
	{ "rayleigh", 1, "a = (1 - v*v)*v - x" },
	{ "duffing", 1, "a = 0.5*cos(1.4*t) - 0.2*v - x - x*x*x" },
	{ "mathieu", 1, "a = (0.4*cos(2*t) - 1)*x - 0.1*v" },
	{ "quad2dof", 2, "a = -x - 2*x*z; b = z*z - x*x - z" },
	{ "henon_heiles", 2, "a = -x - 2*x*z; b = z*z - x*x - z" },
	{ "coupled_vanderpol", 2, "p = 0.3*(z - x); a = (1 - x*x)*v - x + p; b = (1 - z*z)*w - 1.2*z - p" },
	{ "double_pendulum", 2, "s = sin(x - z); c = cos(x - z); p = s*w*w + 2*sin(x); q = s*v*v - sin(z); "
	                        "m = 2 - c*c; a = -(p + c*q)/m; b = (2*q + c*p)/m" },
	{ "duffing_pair", 2, "p = 0.5*(z - x); a = 0.5*cos(1.2*t) + p - " DRAGGED("x", "v") "; "
	                     "b = -p - " DRAGGED("z", "w") },
	{ "spherical_pendulum", 2, "s = sin(x); c = cos(x); a = s*c*w*w - s; b = -2*v*w*c/s" },
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
	write_equations(&x, models[model].equations);
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
