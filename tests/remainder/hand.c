/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "hand.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_NODES = 4 };

/* ---- matrices ---- */

static real *new_matrix(int n)
{
	real *a = calloc((size_t)(n * n), sizeof *a);
	if (!a)
		abort();
	return a;
}

/* c <- a b; c is neither. */
static void product(int n, const real *a, const real *b, real *c)
{
	memset(c, 0, (size_t)(n * n) * sizeof *c);
	for (int i = 0; i < n; i++)
		for (int k = 0; k < n; k++)
			if (a[i * n + k] != 0)
				for (int j = 0; j < n; j++)
					c[i * n + j] += a[i * n + k] * b[k * n + j];
}

/* y <- a x, and y <- y + a x. */
static void apply(int n, const real *a, const real *x, real *y)
{
	for (int i = 0; i < n; i++) {
		real sum = 0;
		for (int j = 0; j < n; j++)
			sum += a[i * n + j] * x[j];
		y[i] = sum;
	}
}

static void add(int n, const real *a, const real *x, real *y)
{
	real ax[HAND_MOST];
	apply(n, a, x, ax);
	for (int i = 0; i < n; i++)
		y[i] += ax[i];
}

static real norm(int n, const real *a)
{
	real most = 0;
	for (int i = 0; i < n; i++) {
		real sum = 0;
		for (int j = 0; j < n; j++)
			sum += fabsl(a[i * n + j]);
		most = fmaxl(most, sum);
	}
	return most;
}

/* phi_k(z) = sum z^j/(j + k)! where |z| <= 1/2, then
 * phi_k(2z) = 2^-k (e^z phi_k(z) + sum_{j=1..k} phi_j(z)/(k - j)!). */
void phi_functions(int n, const real *A, real tau, real *phi[4])
{
	enum { TERMS = 24 };
	const int cells = n * n;
	real *z = new_matrix(n), *power = new_matrix(n), *next = new_matrix(n);
	int halvings = 0;
	for (real size = norm(n, A) * fabsl(tau); size > 0.5L; size /= 2)
		halvings++;
	for (int i = 0; i < cells; i++)
		z[i] = ldexpl(A[i] * tau, -halvings);
	for (int i = 0; i < n; i++)
		power[i * n + i] = 1;
	for (int k = 0; k < 4; k++)
		memset(phi[k], 0, (size_t)cells * sizeof *phi[k]);
	for (int j = 0; j < TERMS; j++) {
		for (int k = 0; k < 4; k++) {
			const real factor = 1 / tgammal(j + k + 1);
			for (int i = 0; i < cells; i++)
				phi[k][i] += factor * power[i];
		}
		product(n, power, z, next);
		memcpy(power, next, (size_t)cells * sizeof *power);
	}
	for (; halvings > 0; halvings--) {
		for (int k = 3; k >= 0; k--) {
			product(n, phi[0], phi[k], next);
			for (int i = 0; i < cells; i++) {
				if (k == 3)
					next[i] += phi[1][i] / 2 + phi[2][i] + phi[3][i];
				else if (k == 2)
					next[i] += phi[1][i] + phi[2][i];
				else if (k == 1)
					next[i] += phi[1][i];
				phi[k][i] = ldexpl(next[i], -k);
			}
		}
	}
	free(z);
	free(power);
	free(next);
}

int size_of(const struct system *s)
{
	return s->states + s->loads + 2 * s->inputs;
}

void jacobian(const struct system *s, real t, const real *y, real *A)
{
	static const real weight[] = {4 / 5.0L, -1 / 5.0L, 4 / 105.0L, -1 / 280.0L};
	const real apart = 1 / 128.0L;
	const int size = size_of(s), n = s->states;
	for (int j = 0; j < size; j++) {
		if (j >= n && j < n + s->loads)
			continue;
		for (int k = 1; k <= 4; k++) {
			for (int side = -1; side <= 1; side += 2) {
				real w[HAND_MOST] = {0}, f[HAND_MOST];
				memcpy(w, y, (size_t)n * sizeof *w);
				w[j] += side * k * apart;
				s->equations(t, w, w + n + s->loads, f);
				for (int i = 0; i < n; i++)
					A[i * size + j] += side * weight[k - 1] * f[i] / apart;
			}
		}
	}
}

/* ---- the schemes ---- */

struct tables {
	real *A, *flow, *half, *p[4], *q[4];    /* q: phi over half a step */
	real *back[MOST_NODES], *ahead[MOST_NODES], *midway[MOST_NODES];    /* e^{A tau}, tau = (1 - c) h, c h, c h/2 */
};

struct hand {
	const struct system *system;
	const char *scheme;
	real h;
	int nodes;
	real c[MOST_NODES], b[MOST_NODES];
	int operators;
	struct tables *tables;
};

static const struct quadrature {
	const char *scheme;
	int nodes;
	real c[MOST_NODES], b[MOST_NODES];
} quadrature[] = {
	{"nc2", 3, {0, 1 / 2.0L, 1}, {1 / 6.0L, 2 / 3.0L, 1 / 6.0L}},
	{"nc3", 4, {0, 1 / 3.0L, 2 / 3.0L, 1}, {1 / 8.0L, 3 / 8.0L, 3 / 8.0L, 1 / 8.0L}},
	{"dq4", 4, {1 / 4.0L, 1 / 2.0L, 3 / 4.0L, 1}, {2 / 3.0L, -1 / 3.0L, 2 / 3.0L, 0}},
	{"bm3", 4, {0, 1 / 4.0L, 3 / 4.0L, 1}, {1 / 18.0L, 4 / 9.0L, 4 / 9.0L, 1 / 18.0L}},
};

static real *exponential(int n, const real *A, real tau)
{
	real *phi[4];
	for (int k = 0; k < 4; k++)
		phi[k] = new_matrix(n);
	phi_functions(n, A, tau, phi);
	for (int k = 1; k < 4; k++)
		free(phi[k]);
	return phi[0];
}

struct hand *hand_new(const struct system *s, const char *scheme, real h)
{
	struct hand *p = calloc(1, sizeof *p);
	const int n = size_of(s);
	*p = (struct hand){.system = s, .scheme = scheme, .h = h, .operators = s->operators ? s->operators : 1};
	for (size_t i = 0; i < sizeof quadrature / sizeof *quadrature; i++) {
		if (strcmp(quadrature[i].scheme, scheme) == 0) {
			p->nodes = quadrature[i].nodes;
			memcpy(p->c, quadrature[i].c, sizeof p->c);
			memcpy(p->b, quadrature[i].b, sizeof p->b);
		}
	}
	p->tables = calloc((size_t)p->operators, sizeof *p->tables);
	for (int i = 0; i < p->operators; i++) {
		struct tables *t = &p->tables[i];
		t->A = new_matrix(n);
		s->linear(s, i, t->A);
		for (int k = 0; k < s->inputs; k++)             /* u' is the slope */
			t->A[(s->states + s->loads + k) * n + s->states + s->loads + s->inputs + k] = 1;
		for (int k = 0; k < 4; k++) {
			t->p[k] = new_matrix(n);
			t->q[k] = new_matrix(n);
		}
		phi_functions(n, t->A, h, t->p);
		phi_functions(n, t->A, h / 2, t->q);
		t->flow = t->p[0];
		t->half = t->q[0];
		for (int k = 0; k < p->nodes; k++) {
			t->back[k] = exponential(n, t->A, (1 - p->c[k]) * h);
			t->ahead[k] = exponential(n, t->A, p->c[k] * h);
			t->midway[k] = exponential(n, t->A, p->c[k] * h / 2);
		}
	}
	return p;
}

void hand_free(struct hand *p)
{
	for (int i = 0; i < p->operators; i++) {
		struct tables *t = &p->tables[i];
		free(t->A);
		for (int k = 0; k < 4; k++) {
			free(t->p[k]);
			free(t->q[k]);
		}
		for (int k = 0; k < p->nodes; k++) {
			free(t->back[k]);
			free(t->ahead[k]);
			free(t->midway[k]);
		}
	}
	free(p->tables);
	free(p);
}

const real *hand_flow(const struct hand *p, int which)
{
	return p->tables[which].flow;
}

/* r(t, w): what the equations have beyond A w; 0 in the rows of loads and inputs. */
static void rest(const struct system *s, const struct tables *T, real t, const real *w, real *r)
{
	const int n = s->states;
	real Aw[HAND_MOST];
	memset(r, 0, (size_t)size_of(s) * sizeof *r);
	s->equations(t, w, w + n + s->loads, r);
	apply(size_of(s), T->A, w, Aw);
	for (int i = 0; i < n; i++)
		r[i] -= Aw[i];
}

/* x <- x + factor h P r */
static void kick(const struct hand *p, const real *P, real factor, const real *r, real *x)
{
	real scaled[HAND_MOST] = {0};
	const int n = size_of(p->system);
	for (int i = 0; i < n; i++)
		scaled[i] = factor * p->h * r[i];
	add(n, P, scaled, x);
}

static void etd(const struct hand *p, const struct tables *T, real t, real *w)
{
	const struct system *s = p->system;
	const int n = size_of(s);
	const real h = p->h;
	real r0[HAND_MOST], a[HAND_MOST], ra[HAND_MOST], b[HAND_MOST], rb[HAND_MOST], c[HAND_MOST], rc[HAND_MOST];
	rest(s, T, t, w, r0);
	if (strcmp(p->scheme, "etdrk4") != 0) {
		apply(n, T->flow, w, a);
		kick(p, T->p[1], 1, r0, a);
		if (strcmp(p->scheme, "etdrk2") == 0) {
			rest(s, T, t + h, a, ra);
			kick(p, T->p[2], 1, ra, a);
			kick(p, T->p[2], -1, r0, a);
		}
		memcpy(w, a, (size_t)n * sizeof *w);
		return;
	}
	apply(n, T->half, w, a);
	memcpy(b, a, sizeof b);
	kick(p, T->q[1], 0.5L, r0, a);
	rest(s, T, t + h / 2, a, ra);
	kick(p, T->q[1], 0.5L, ra, b);
	rest(s, T, t + h / 2, b, rb);
	apply(n, T->half, a, c);
	kick(p, T->q[1], 1, rb, c);
	kick(p, T->q[1], -0.5L, r0, c);
	rest(s, T, t + h, c, rc);
	apply(n, T->flow, w, a);
	memcpy(w, a, (size_t)n * sizeof *w);
	kick(p, T->p[1], 1, r0, w);
	kick(p, T->p[2], -3, r0, w);
	kick(p, T->p[3], 4, r0, w);
	for (const real *r = ra; r; r = r == ra ? rb : NULL) {
		kick(p, T->p[2], 2, r, w);
		kick(p, T->p[3], -4, r, w);
	}
	kick(p, T->p[3], 4, rc, w);
	kick(p, T->p[2], -1, rc, w);
}

/* One classical Runge-Kutta step over c h of z' = A z + r(t, z + q), z(t) = y: q answers loads and inputs from rest,
 * exactly. */
static void predict(const struct hand *p, const struct tables *T, real t, const real *w, int node, real *at)
{
	const struct system *s = p->system;
	const int n = size_of(s);
	const real length = p->c[node] * p->h;
	real rest_at_start[HAND_MOST], q[3][HAND_MOST], z[HAND_MOST], slope[4][HAND_MOST], y[HAND_MOST], r[HAND_MOST];
	memcpy(rest_at_start, w, sizeof rest_at_start);
	memset(rest_at_start, 0, (size_t)s->states * sizeof *rest_at_start);
	memcpy(q[0], rest_at_start, sizeof q[0]);
	apply(n, T->midway[node], rest_at_start, q[1]);
	apply(n, T->ahead[node], rest_at_start, q[2]);
	for (int stage = 0; stage < 4; stage++) {
		const real c = stage == 0 ? 0 : stage == 3 ? 1 : 0.5L;
		const real *load = q[(stage + 1) / 2];
		memset(z, 0, sizeof z);                         /* no loads in A z */
		for (int i = 0; i < s->states; i++)
			z[i] = w[i] + (stage ? c * length * slope[stage - 1][i] : 0);
		for (int i = 0; i < n; i++)
			y[i] = z[i] + load[i];
		rest(s, T, t + c * length, y, r);
		apply(n, T->A, z, slope[stage]);
		for (int i = 0; i < s->states; i++)
			slope[stage][i] += r[i];
	}
	for (int i = 0; i < n; i++) {
		at[i] = q[2][i];
		if (i < s->states)
			at[i] += w[i] + length / 6 * (slope[0][i] + 2 * slope[1][i] + 2 * slope[2][i] + slope[3][i]);
	}
}

static void precise(const struct hand *p, const struct tables *T, real t, real *w)
{
	const int n = size_of(p->system);
	real next[HAND_MOST], at[HAND_MOST], r[HAND_MOST];
	apply(n, T->flow, w, next);
	for (int i = 0; i < p->nodes; i++) {
		predict(p, T, t, w, i, at);
		rest(p->system, T, t + p->c[i] * p->h, at, r);
		kick(p, T->back[i], p->b[i], r, next);
	}
	memcpy(w, next, (size_t)n * sizeof *w);
}

void hand_step(const struct hand *p, real t, const real *u, real *y)
{
	const struct system *s = p->system;
	const struct tables *T = &p->tables[s->choose ? s->choose(t, y) : 0];
	real w[HAND_MOST] = {0};
	memcpy(w, y, (size_t)s->states * sizeof *w);
	if (s->loads_at)
		s->loads_at(t, w + s->states);
	if (s->inputs)
		memcpy(w + s->states + s->loads, u, 2 * (size_t)s->inputs * sizeof *w);
	if (p->nodes)
		precise(p, T, t, w);
	else
		etd(p, T, t, w);
	memcpy(y, w, (size_t)s->states * sizeof *w);
}
