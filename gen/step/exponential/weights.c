/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What forces that are polynomials over a step give a mode eta'' + 2 delta eta' + lambda eta = F. With F = (s/h)^m and
 * from rest let Q_m be eta and V_m be eta' at theta h. The derivative of that response is the response to m (s/h)^(m-1)
 * over h, so
 *     Q_(m-1) = h V_m/m,   V_(m-1) = h/m (theta^m - 2 delta V_m - lambda Q_m)
 * and all follow from the highest, which its power series gives. The free response is in Q_0 and V_0.
 */
#include "inner.h"

enum { WEIGHT_BITS = 512 };

/* ---- polynomials ---- */

struct lagrange lagrange_of(int nodes, const mpq_t *node)
{
	size_t n = (size_t)nodes;
	struct lagrange l = { nodes, reals(n, WEIGHT_BITS), reals(n * n, WEIGHT_BITS) };
	REAL gap = WITH_BITS(WEIGHT_BITS), shifted = WITH_BITS(WEIGHT_BITS);
	for (int i = 0; i < nodes; i++)
		mpfr_set_q(l.node[i], node[i], MPFR_RNDN);
	for (int i = 0; i < nodes; i++) {
		mpfr_t *c = l.factor + i * nodes;
		int degree = 0;
		mpfr_set_ui(c[0], 1, MPFR_RNDN);
		for (int k = 0; k < nodes; k++) {       /* c <- c (sigma - node k)/(node i - node k) */
			if (k == i)
				continue;
			mpfr_sub(gap, l.node[i], l.node[k], MPFR_RNDN);
			for (int j = ++degree; j >= 0; j--) {
				mpfr_mul(shifted, c[j], l.node[k], MPFR_RNDN);
				mpfr_neg(shifted, shifted, MPFR_RNDN);
				if (j > 0)
					mpfr_add(shifted, shifted, c[j - 1], MPFR_RNDN);
				mpfr_div(c[j], shifted, gap, MPFR_RNDN);
			}
		}
	}
	return l;
}

void lagrange_at(const struct lagrange *l, mpq_srcptr sigma, mpfr_t *value)
{
	for (int i = 0; i < l->nodes; i++) {
		mpfr_set_zero(value[i], 1);
		for (int j = l->nodes - 1; j >= 0; j--) {
			mpfr_mul_q(value[i], value[i], sigma, MPFR_RNDN);
			mpfr_add(value[i], value[i], l->factor[i * l->nodes + j], MPFR_RNDN);
		}
	}
}

mpq_t *past_nodes(int count)
{
	mpq_t *node = rationals(count);
	for (int k = 0; k < count; k++)
		mpq_set_si(node[k], -k, 1);
	return node;
}

/* ---- the highest moment ---- */

struct moments {
	mpfr_t *Q, *V;              /* 0 .. powers - 1 */
	int powers, precision;
	mpfr_t h, theta, square, twice; /* lambda h^2, 2 delta h */
};

/* Bits that the sum of the series loses: about e^{|p| theta h} */
static int extra_bits(const struct moments *w)
{
	REAL size = WITH_BITS(53), part = WITH_BITS(53);
	mpfr_abs(size, w->square, MPFR_RNDU);
	mpfr_sqrt(size, size, MPFR_RNDU);
	mpfr_abs(part, w->twice, MPFR_RNDU);
	mpfr_add(size, size, part, MPFR_RNDU);
	mpfr_mul(size, size, w->theta, MPFR_RNDU);
	return 4 * (int)mpfr_get_d(size, MPFR_RNDU);
}

/* y'' + 2 delta h y' + lambda h^2 y = h^2 sigma^m, y = sum of c_j sigma^j; terms are c_j theta^j */
static void highest_moment(struct moments *w)
{
	int m = w->powers - 1, bits = WEIGHT_BITS + extra_bits(w);
	REAL term = WITH_BITS(bits), before = WITH_BITS(bits), next = WITH_BITS(bits), part = WITH_BITS(bits),
	     Q = WITH_BITS(bits), V = WITH_BITS(bits);
	mpfr_set_zero(before, 1);
	mpfr_pow_ui(term, w->theta, (unsigned long)m + 2, MPFR_RNDN);
	mpfr_mul(term, term, w->h, MPFR_RNDN);
	mpfr_mul(term, term, w->h, MPFR_RNDN);
	mpfr_div_ui(term, term, (unsigned long)((m + 2) * (m + 1)), MPFR_RNDN);
	mpfr_set_zero(Q, 1);
	mpfr_set_zero(V, 1);
	mpfr_exp_t floor = mpfr_get_exp(term) - bits;
	for (unsigned long j = (unsigned long)m + 2;; j++) {
		mpfr_add(Q, Q, term, MPFR_RNDN);
		mpfr_mul_ui(part, term, j, MPFR_RNDN);
		mpfr_add(V, V, part, MPFR_RNDN);
		bool small = (mpfr_zero_p(term) || mpfr_get_exp(term) < floor) &&
			     (mpfr_zero_p(before) || mpfr_get_exp(before) < floor);
		if (small && j > (unsigned long)bits / 8)
			break;
		/* c_(j+1) (j+1) j = -2 delta h j c_j - lambda h^2 c_(j-1) */
		mpfr_mul(next, w->twice, term, MPFR_RNDN);
		mpfr_mul_ui(next, next, j, MPFR_RNDN);
		mpfr_mul(next, next, w->theta, MPFR_RNDN);
		mpfr_mul(part, w->square, before, MPFR_RNDN);
		mpfr_mul(part, part, w->theta, MPFR_RNDN);
		mpfr_mul(part, part, w->theta, MPFR_RNDN);
		mpfr_add(next, next, part, MPFR_RNDN);
		mpfr_neg(next, next, MPFR_RNDN);
		mpfr_div_ui(next, next, j, MPFR_RNDN);
		mpfr_div_ui(next, next, j + 1, MPFR_RNDN);
		mpfr_set(before, term, MPFR_RNDN);
		mpfr_set(term, next, MPFR_RNDN);
	}
	mpfr_set(w->Q[m], Q, MPFR_RNDN);
	mpfr_div(V, V, w->theta, MPFR_RNDN);
	mpfr_div(w->V[m], V, w->h, MPFR_RNDN);
}

/* value <- theta^m - 2 delta V_m - lambda Q_m */
static void acceleration(const struct moments *w, const struct normal_mode *mode, int m, mpfr_ptr value)
{
	REAL part = WITH_BITS(mpfr_get_prec(value));
	mpfr_pow_ui(value, w->theta, (unsigned long)m, MPFR_RNDN);
	mpfr_mul(part, mode->delta, w->V[m], MPFR_RNDN);
	mpfr_mul_2ui(part, part, 1, MPFR_RNDN);
	mpfr_sub(value, value, part, MPFR_RNDN);
	mpfr_mul(part, mode->lambda, w->Q[m], MPFR_RNDN);
	mpfr_sub(value, value, part, MPFR_RNDN);
}

static void lower_moments(struct moments *w, const struct normal_mode *mode)
{
	for (int m = w->powers - 1; m > 0; m--) {
		mpfr_mul(w->Q[m - 1], w->h, w->V[m], MPFR_RNDN);
		mpfr_div_ui(w->Q[m - 1], w->Q[m - 1], (unsigned long)m, MPFR_RNDN);
		acceleration(w, mode, m, w->V[m - 1]);
		mpfr_mul(w->V[m - 1], w->V[m - 1], w->h, MPFR_RNDN);
		mpfr_div_ui(w->V[m - 1], w->V[m - 1], (unsigned long)m, MPFR_RNDN);
	}
}

/* ---- the whole ---- */

static void weigh(const struct lagrange *l, mpfr_t *moment, mpfr_t *weight)
{
	REAL part = WITH_BITS(WEIGHT_BITS);
	for (int i = 0; i < l->nodes; i++)
		for (int j = 0; j < l->nodes; j++) {
			mpfr_mul(part, l->factor[i * l->nodes + j], moment[j], MPFR_RNDN);
			mpfr_add(weight[i], weight[i], part, MPFR_RNDN);
		}
}

struct mode_flow mode_flow_of(const struct normal_mode *mode, mpq_srcptr h, mpq_srcptr theta, const struct lagrange *l)
{
	size_t powers = (size_t)l->nodes;
	struct mode_flow flow = { .position = reals(powers, WEIGHT_BITS), .rate = reals(powers, WEIGHT_BITS) };
	REALS *Q = reals(powers, WEIGHT_BITS), *V = reals(powers, WEIGHT_BITS);
	struct moments w = { Q, V, l->nodes, WEIGHT_BITS, { { 0 } }, { { 0 } }, { { 0 } }, { { 0 } } };
	mpfr_inits2(WEIGHT_BITS, flow.e, flow.s, flow.de, flow.ds, w.h, w.theta, w.square, w.twice, NULL);
	mpfr_set_q(w.h, h, MPFR_RNDN);
	mpfr_set_q(w.theta, theta, MPFR_RNDN);
	mpfr_mul(w.square, mode->lambda, w.h, MPFR_RNDN);
	mpfr_mul(w.square, w.square, w.h, MPFR_RNDN);
	mpfr_mul(w.twice, mode->delta, w.h, MPFR_RNDN);
	mpfr_mul_2ui(w.twice, w.twice, 1, MPFR_RNDN);
	highest_moment(&w);
	lower_moments(&w, mode);
	weigh(l, w.Q, flow.position);
	weigh(l, w.V, flow.rate);
	mpfr_mul(flow.e, mode->lambda, w.Q[0], MPFR_RNDN);
	mpfr_ui_sub(flow.e, 1, flow.e, MPFR_RNDN);
	mpfr_set(flow.s, w.V[0], MPFR_RNDN);
	mpfr_mul(flow.de, mode->lambda, w.V[0], MPFR_RNDN);
	mpfr_neg(flow.de, flow.de, MPFR_RNDN);
	acceleration(&w, mode, 0, flow.ds);
	mpfr_clears(w.h, w.theta, w.square, w.twice, NULL);
	return flow;
}

void mode_flow_free(struct mode_flow *flow)
{
	clear_reals(&flow->position);
	clear_reals(&flow->rate);
	mpfr_clears(flow->e, flow->s, flow->de, flow->ds, NULL);
}
