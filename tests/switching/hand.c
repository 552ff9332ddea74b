/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "hand.h"
#include "quadrant.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { TERMS = 34 };

real hand_distance(const struct hand_system *s, int stop, const real *y, real t)
{
	const struct hand_stop *p = &s->stop[stop];
	real d = -p->gap - p->rate * t - p->a * sin_of(p->w * t);
	for (int i = 0; i < s->n; i++)
		d += p->row[i] * y[i];
	return d;
}

static real power(int k, real constant, real rate, real t)
{
	return k == 0 ? constant + rate * t : k == 1 ? rate : 0;
}

/* k-th derivative of cos(w t) or of sin(w t), over k! */
static void wave_terms(real w, real t, bool sine, real *term)
{
	const real c = cos_of(w * t), s = sin_of(w * t), at_quarter[] = {c, -s, -c, s};
	real factor = 1;
	for (int k = 0; k < TERMS; k++) {
		term[k] = factor * at_quarter[(k + (sine ? 3 : 0)) % 4];
		factor *= w / (k + 1);
	}
}

/* Taylor coefficients of the positions and velocities about t, with the stops touched as they are */
static void flow(const struct hand_system *s, const struct hand_state *now, real y[TERMS + 1][2 * HAND_MASSES])
{
	const int n = s->n;
	real load[TERMS], stop_load[HAND_STOPS][TERMS];
	wave_terms(s->w, now->t, false, load);
	for (int j = 0; j < s->stops; j++)
		wave_terms(s->stop[j].w, now->t, true, stop_load[j]);
	memcpy(y[0], now->y, sizeof now->y);
	for (int k = 0; k < TERMS; k++) {
		real force[HAND_MASSES];
		for (int i = 0; i < n; i++) {
			force[i] = s->fa[i] * load[k] + power(k, s->f0[i], s->f1[i], now->t);
			for (int m = 0; m < n; m++)
				force[i] -= s->K[i][m] * y[k][m] + s->C[i][m] * y[k][n + m];
		}
		for (int j = 0; j < s->stops; j++) {
			const struct hand_stop *p = &s->stop[j];
			real against = -p->k * (p->a * stop_load[j][k] + power(k, p->gap, p->rate, now->t));
			for (int i = 0; i < n; i++)
				against += p->row[i] * (p->k * y[k][i] + p->c * y[k][n + i]);
			for (int i = 0; i < n && now->touches[j]; i++)
				force[i] -= p->push[i] * against;
		}
		for (int i = 0; i < n; i++) {
			y[k + 1][i] = y[k][n + i] / (k + 1);
			y[k + 1][n + i] = force[i] / (k + 1);
		}
	}
}

/* The last series: what is halved towards a crossing begins where it did before */
static struct {
	struct hand_system of;
	struct hand_state from;
	real y[TERMS + 1][2 * HAND_MASSES];
} kept;

static void flow_once(const struct hand_system *s, const struct hand_state *now)
{
	if (memcmp(&kept.from, now, sizeof *now) == 0 && memcmp(&kept.of, s, sizeof *s) == 0)
		return;
	flow(s, now, kept.y);
	kept.from = *now;
	kept.of = *s;
}

/* The state tau later in one region; pieces so short that the series is as good as exact */
static struct hand_state ahead(const struct hand_system *s, const struct hand_state *from, real tau)
{
	struct hand_state now = *from;
	const int pieces = 1 + (int)(fabsl(tau) / 0.1L);
	for (int piece = 0; piece < pieces; piece++) {
		const real dt = tau / pieces;
		flow_once(s, &now);
		for (int i = 0; i < 2 * s->n; i++) {
			real sum = 0;
			for (int k = TERMS; k >= 0; k--)
				sum = sum * dt + kept.y[k][i];
			now.y[i] = sum;
		}
		now.t = from->t + tau * (piece + 1) / pieces;
	}
	return now;
}

void hand_start(const struct hand_system *s, struct hand_state *now)
{
	memset(now, 0, sizeof *now);
	memcpy(now->y, s->start, sizeof now->y);
	for (int j = 0; j < s->stops; j++)
		now->touches[j] = hand_distance(s, j, now->y, 0) > 0;
}

static void cross(const struct hand_system *s, struct hand_state *now, int stop)
{
	now->touches[stop] = !now->touches[stop];
	now->crossings++;
	now->last = now->t;
	if (s->log && s->log->count < HAND_LOGGED)
		s->log->time[s->log->count++] = now->t;
}

void hand_change(const struct hand_system *s, struct hand_state *now)
{
	for (int j = 0; j < s->stops; j++)
		if ((hand_distance(s, j, now->y, now->t) > 0) != now->touches[j])
			cross(s, now, j);
}

/* A stop that at the end of tau is on its other side, or -1 */
static int changed(const struct hand_system *s, const struct hand_state *now, real tau, int but)
{
	const struct hand_state end = ahead(s, now, tau);
	for (int j = 0; j < s->stops; j++)
		if (j != but && (hand_distance(s, j, end.y, end.t) > 0) != now->touches[j])
			return j;
	return -1;
}

void hand_step(const struct hand_system *s, struct hand_state *now, real h)
{
	const real end = now->t + h;
	int but = -1;                           /* on whose breakpoint it is: rounding decides where */
	for (int events = 0; events < 64; events++) {
		real low = 0, high = end - now->t;
		if (high <= 0 || changed(s, now, high, -1) < 0)
			break;
		for (int i = 0; i < 80 && high - low > 1e-19L * h; i++) {
			const real middle = (low + high) / 2;
			if (changed(s, now, middle, middle < 1e-15L ? but : -1) < 0)
				low = middle;
			else
				high = middle;
		}
		const int stop = changed(s, now, high, -1);
		*now = ahead(s, now, high);
		cross(s, now, stop);
		but = stop;
	}
	*now = ahead(s, now, end - now->t);
}

/* How fast it goes into a stop; exactly at a turning point rounding decides */
static real approach(const struct hand_system *s, int stop, const struct hand_state *now)
{
	const struct hand_stop *p = &s->stop[stop];
	real speed = -p->rate - p->a * p->w * cos_of(p->w * now->t);
	for (int i = 0; i < s->n; i++)
		speed += p->row[i] * now->y[s->n + i];
	return speed;
}

/* The first time within tau where a stop is nearest or farthest, or tau */
static real turning(const struct hand_system *s, const struct hand_state *now, real tau)
{
	for (int j = 0; j < s->stops; j++) {
		const int sign = approach(s, j, now) > 0;
		struct hand_state end = ahead(s, now, tau);
		real low = 0, high = tau;
		if ((approach(s, j, &end) > 0) == sign)
			continue;
		for (int i = 0; i < 50; i++) {
			const real middle = (low + high) / 2;
			end = ahead(s, now, middle);
			*((approach(s, j, &end) > 0) == sign ? &low : &high) = middle;
		}
		tau = high;
	}
	return tau;
}

void hand_reference(const struct hand_system *s, struct hand_state *now, real t)
{
	const real h = 0.05L, from = now->t;
	const long steps = (long)ceill((t - from) / h - 1e-9L);
	for (long k = 0; k < steps; k++) {
		const real end = from + (t - from) * (k + 1) / steps;
		for (int cuts = 0; cuts < 20 && end - now->t > 1e-15L; cuts++)
			hand_step(s, now, turning(s, now, end - now->t));
		hand_step(s, now, end - now->t);
	}
}

void hand_until(const struct hand_system *s, struct hand_state *now, real t, real h)
{
	const real from = now->t;
	const long steps = (long)ceill((t - from) / h - 1e-9L);
	for (long k = 0; k < steps; k++)
		hand_step(s, now, from + (t - from) * (k + 1) / steps - now->t);
}
