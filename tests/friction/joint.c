/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "joint.h"
#include "quadrant.h"

#include <math.h>
#include <string.h>

enum { TERMS = 24, LOOKS = 32, WATCHES = 2 * JOINT_SLIDERS + 1 };
static const wide longest = 0.005L;

/* ---- random systems, in numbers of few digits ---- */

static unsigned next(unsigned *state)
{
	*state = *state * 1664525u + 1013904223u;
	return *state >> 8;
}

static double between(unsigned *state, double low, double high, int steps)
{
	return low + (high - low) * (double)(next(state) % (unsigned)(steps + 1)) / steps;
}

static struct jenkins jenkins_element(int n, unsigned *state)
{
	struct jenkins e = { .at = (int)(next(state) % (unsigned)n), .to = (int)(next(state) % (unsigned)(n + 1)) - 1 };
	if (e.to == e.at)
		e.to = -1;
	e.stiffness = between(state, 5, 60, 11);
	e.force = between(state, 0.2, 2, 18);
	e.damping = next(state) % 3 == 0 ? between(state, 0.5, 3, 10) : 0;
	return e;
}

struct joint joint_system(unsigned seed)
{
	struct joint s;
	unsigned state = seed * 2654435761u + 977u;
	memset(&s, 0, sizeof s);
	for (int i = 0; i < 4; i++)
		(void)next(&state);
	s.n = 1 + (int)(seed % JOINT_MASSES);
	for (int i = 0; i < s.n; i++) {
		s.m[i] = between(&state, 0.5, 2, 6);
		s.k[i] = between(&state, 5, 60, 11);
		s.c[i] = between(&state, 0.05, 0.5, 9);
		s.f[i] = next(&state) % 2 || i == 0 ? between(&state, 1, 5, 8) : 0;
		s.w[i] = between(&state, 1, 8, 14);
		s.start[i] = between(&state, -0.2, 0.2, 16) + 0.003;
		s.speed[i] = between(&state, -1, 1, 20);
	}
	s.sliders = 1 + (int)(next(&state) % (seed % 4 == 0 ? JOINT_SLIDERS : 2));
	for (int k = 0; k < s.sliders; k++)
		s.slider[k] = jenkins_element(s.n, &state);
	s.stopped = s.sliders < JOINT_SLIDERS && next(&state) % 2;
	s.gap = between(&state, 0.05, 0.2, 10) + 0.001;
	s.stop = between(&state, 20, 200, 9);
	return s;
}

/* ---- as a spec ---- */

static void print_slider(FILE *to, const struct jenkins *e, int index)
{
	const char *held = e->to < 0 ? "" : "xyw" + e->to;
	fprintf(to, "friction(z%d'", index);
	if (e->to >= 0)
		fprintf(to, " - %c'", *held);
	fprintf(to, ", %.17g)", e->force);
	if (e->damping != 0 && e->to < 0)
		fprintf(to, " + %.17g*z%d'", e->damping, index);
	else if (e->damping != 0)
		fprintf(to, " + %.17g*(z%d' - %c')", e->damping, index, *held);
	fprintf(to, " = %.17g*(%c - z%d)\n", e->stiffness, "xyw"[e->at], index);
}

void print_joint(FILE *to, const char *name, const struct joint *s)
{
	fprintf(to, "model %s\ncoord ", name);
	for (int i = 0; i < s->n; i++)
		fprintf(to, "%s%c", i ? ", " : "", "xyw"[i]);
	for (int k = 0; k < s->sliders; k++)
		fprintf(to, ", z%d", k);
	fprintf(to, "\n");
	for (int i = 0; i < s->n; i++) {
		char c = "xyw"[i];
		fprintf(to, "%.17g*%c''", s->m[i], c);
		if (i == 0)
			fprintf(to, " + %.17g*%c + %.17g*%c'", s->k[i], c, s->c[i], c);
		else
			fprintf(to, " + %.17g*(%c - %c) + %.17g*(%c' - %c')", s->k[i], c, "xyw"[i - 1], s->c[i], c,
				"xyw"[i - 1]);
		if (i + 1 < s->n)
			fprintf(to, " - %.17g*(%c - %c) - %.17g*(%c' - %c')", s->k[i + 1], "xyw"[i + 1], c,
				s->c[i + 1], "xyw"[i + 1], c);
		for (int k = 0; k < s->sliders; k++)
			if (s->slider[k].at == i || s->slider[k].to == i)
				fprintf(to, " %c %.17g*(%c - z%d)", s->slider[k].at == i ? '+' : '-',
					s->slider[k].stiffness, "xyw"[s->slider[k].at], k);
		if (i == 0 && s->stopped)
			fprintf(to, " + %.17g*max(x - %.17g, 0)", s->stop, s->gap);
		fprintf(to, " = %.17g*cos(%.17g*t)\n", s->f[i], s->w[i]);
	}
	for (int k = 0; k < s->sliders; k++)
		print_slider(to, &s->slider[k], k);
	for (int i = 0; i < s->n; i++)
		fprintf(to, "init %c = %.17g, %c' = %.17g\n", "xyw"[i], s->start[i], "xyw"[i], s->speed[i]);
	for (int k = 0; k < s->sliders; k++)        /* not yet stretched */
		fprintf(to, "init z%d = %.17g\n", k, s->start[s->slider[k].at]);
	fprintf(to, "step 0.05\n");
}

/* ---- the motion as a series, in one mode of all that switches ---- */

struct series {
	wide x[TERMS + 2][JOINT_MASSES], v[TERMS + 2][JOINT_MASSES], z[TERMS + 2][JOINT_SLIDERS];
	wide slip[TERMS + 1][JOINT_SLIDERS]; /* z' - x_to' */
};

/* u^k of cos(w (t + u)) */
static wide cosine(wide w, wide t, int k)
{
	wide value = cos_of(w * t + k * (acosl(-1.0L) / 2));
	for (int i = 1; i <= k; i++)
		value *= w / i;
	return value;
}

static wide stretch(const struct joint *s, const struct series *e, int j, int k)
{
	return s->slider[j].stiffness * (e->x[k][s->slider[j].at] - e->z[k][j]);
}

static wide slip_of(const struct joint *s, const struct joint_state *now, const struct series *e, int j, int k)
{
	const struct jenkins *slider = &s->slider[j];
	wide limit = k == 0 ? now->slides[j] * (wide)slider->force : 0;
	if (now->slides[j] == 0)
		return 0;
	if (slider->damping != 0)
		return (stretch(s, e, j, k) - limit) / slider->damping;
	return e->v[k][slider->at] - (slider->to < 0 ? 0 : e->v[k][slider->to]);
}

static wide force_on(const struct joint *s, const struct joint_state *now, const struct series *e, int i, int k)
{
	wide sum = s->f[i] * cosine(s->w[i], now->t, k);
	for (int j = i; j <= i + 1 && j < s->n; j++) {          /* the springs before and behind it */
		wide x = e->x[k][j] - (j ? e->x[k][j - 1] : 0), v = e->v[k][j] - (j ? e->v[k][j - 1] : 0);
		sum += (j == i ? -1 : 1) * (s->k[j] * x + s->c[j] * v);
	}
	for (int j = 0; j < s->sliders; j++) {
		sum -= s->slider[j].at == i ? stretch(s, e, j, k) : 0;
		sum += s->slider[j].to == i ? stretch(s, e, j, k) : 0;
	}
	if (i == 0 && now->meets)
		sum -= s->stop * (e->x[k][0] - (k == 0 ? (wide)s->gap : 0));
	return sum;
}

static void expand(const struct joint *s, const struct joint_state *now, struct series *e)
{
	memcpy(e->x[0], now->x, sizeof now->x);
	memcpy(e->v[0], now->v, sizeof now->v);
	memcpy(e->z[0], now->z, sizeof now->z);
	for (int k = 0; k <= TERMS; k++) {
		for (int j = 0; j < s->sliders; j++) {
			int to = s->slider[j].to;
			e->slip[k][j] = slip_of(s, now, e, j, k);
			e->z[k + 1][j] = (e->slip[k][j] + (to < 0 ? 0 : e->v[k][to])) / (k + 1);
		}
		for (int i = 0; i < s->n; i++) {
			e->x[k + 1][i] = e->v[k][i] / (k + 1);
			e->v[k + 1][i] = force_on(s, now, e, i, k) / s->m[i] / (k + 1);
		}
	}
}

/* ---- events: what must not rise above 0 ---- */

struct watch { wide c[TERMS + 1]; int slider, to; };    /* slider -1: the stop; to: what it does then */

static int watch_all(const struct joint *s, const struct joint_state *now, const struct series *e, struct watch *w)
{
	int count = 0;
	for (int j = 0; j < s->sliders; j++) {
		int way = now->slides[j];
		for (int side = -1; side <= 1; side += 2) {
			if (way == -side)
				continue;
			for (int k = 0; k <= TERMS; k++) {
				wide over = side * stretch(s, e, j, k) - (k == 0 ? (wide)s->slider[j].force : 0);
				w[count].c[k] = way == 0                      ? over
						: s->slider[j].damping != 0 ? -over
									    : -way * e->slip[k][j];
			}
			w[count].slider = j;
			w[count++].to = way == 0 ? side : 0;
		}
	}
	for (int k = 0; k <= TERMS && s->stopped; k++)
		w[count].c[k] = (now->meets ? -1 : 1) * (e->x[k][0] - (k == 0 ? (wide)s->gap : 0));
	w[count].slider = -1;
	return count + s->stopped;
}

static wide value(const wide *c, wide u)
{
	wide sum = 0;
	for (int k = TERMS; k >= 0; k--)
		sum = sum * u + c[k];
	return sum;
}

static wide first_rise(const wide *c, wide end)
{
	wide low = 0;
	for (int i = 1; i <= LOOKS; i++) {
		wide high = end * i / LOOKS;
		if (value(c, high) <= 1e-16L) {
			low = high;
			continue;
		}
		for (int k = 0; k < 80; k++) {
			wide middle = (low + high) / 2;
			*(value(c, middle) > 0 ? &high : &low) = middle;
		}
		return high;
	}
	return end;
}

void joint_start(const struct joint *s, struct joint_state *now)
{
	memset(now, 0, sizeof *now);
	for (int i = 0; i < s->n; i++) {
		now->x[i] = s->start[i];
		now->v[i] = s->speed[i];
	}
	for (int j = 0; j < s->sliders; j++)
		now->z[j] = s->start[s->slider[j].at];
	now->meets = s->stopped && now->x[0] > s->gap;
}

static void go(const struct joint *s, struct joint_state *now, const struct series *e, wide u)
{
	wide c[TERMS + 1];
	for (int i = 0; i < s->n; i++) {
		for (int k = 0; k <= TERMS; k++)
			c[k] = e->x[k][i];
		now->x[i] = value(c, u);
		for (int k = 0; k <= TERMS; k++)
			c[k] = e->v[k][i];
		now->v[i] = value(c, u);
	}
	for (int j = 0; j < s->sliders; j++) {
		for (int k = 0; k <= TERMS; k++)
			c[k] = e->z[k][j];
		now->z[j] = value(c, u);
	}
	now->t += u;
}

void joint_until(const struct joint *s, struct joint_state *now, double end)
{
	static struct series e;
	static struct watch w[WATCHES];
	while (now->t < end) {
		wide u = end - now->t < longest ? end - now->t : longest;
		int first = -1, count;
		expand(s, now, &e);
		count = watch_all(s, now, &e, w);
		for (int i = 0; i < count; i++) {
			wide at = first_rise(w[i].c, u);
			first = at < u ? i : first;
			u = at < u ? at : u;
		}
		go(s, now, &e, u);
		if (first < 0)
			continue;
		if (now->events < JOINT_EVENTS)
			now->time[now->events] = (double)now->t;
		now->events++;
		if (w[first].slider < 0)
			now->meets ^= 1;
		else
			now->slides[w[first].slider] = w[first].to;
	}
}
