/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Twenty blocks that rub on their neighbours, twenty balls that strike theirs, twenty that press on them and touch from
 * the start: by Taylor series in long double over short pieces, each event halved in on its series. Which of those at
 * rest stick is found by projected relaxation of all their forces (Gauss and Seidel, with overrelaxation). With SPECS
 * it prints its systems. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { N = 20, ORDER = 20, SECONDS = 6 };
static const double belt = 0.1, hardest = 6, load = 4, w = 1.3, spacing = 0.001, restitution = 0.9, hard = 1e4;

static double mass_of(int i) { return 1 + 0.05 * (i * 3 % 7); }
enum kind { BLOCKS, BALLS, PRESSED };
static double ground_of(enum kind kind, int i)
{
	return kind ? 10 + 0.25 * (i * 5 % 11) : i == 0 ? 20 : i == N - 1 ? 15 : 0;
}
static double friction_of(int i) { return i == 0 ? hardest : 0.3 + 0.01 * (i * 7 % N); }

#ifdef SPECS

static void print_between(enum kind kind, int i)
{
	if (kind == BALLS)
		printf("stop between x%d, x%d at %g restitution %g\n", i - 1, i, spacing, restitution);
	else if (kind == BLOCKS)
		printf("spring 100 between x%d, x%d\nfriction %g between x%d, x%d\n", i - 1, i, friction_of(i), i - 1,
		       i);
}

int main(int argc, char **argv)
{
	enum kind kind = argc < 2 || argv[1][8] == 'l' ? BLOCKS : argv[1][8] == 'a' ? BALLS : PRESSED;
	printf("model %s\ncoord x0", argv[1]);
	for (int i = 1; i < N; i++)
		printf(", x%d", i);
	printf("\n");
	for (int i = 0; i < N; i++) {
		printf("%g*x%d'' + %g*x%d", mass_of(i), i, ground_of(kind, i), i);
		if (kind == BLOCKS && i == 0)
			printf(" + friction(x0' - %g, %g)", belt, friction_of(0));
		if (kind == PRESSED && i > 0)
			printf(" - %g*max(x%d - x%d, 0)", hard, i - 1, i);
		if (kind == PRESSED && i < N - 1)
			printf(" + %g*max(x%d - x%d, 0)", hard, i, i + 1);
		printf(" = 0\n");
	}
	for (int i = 1; i < N; i++)
		print_between(kind, i);
	if (kind)
		printf("init x0 = -1\n");
	else
		printf("force %g*cos(%g*t) at x%d\n", load, w, N - 1);
	printf("step 0.01\n");
	return 0;
}

#else

#include "twenty_balls.h"
#include "twenty_blocks.h"
#include "twenty_pressed.h"
#include "tap.h"

typedef long double wide;
static const wide piece = 0.01L, faster = 1.75L;

/* Contact i is between x[i - 1] and x[i]; friction 0 is on the belt. mode: what friction does, -1 and 1: it slips; of
 * what presses, 1: it does */
struct motion {
	enum kind kind;
	wide q[N], v[N], t;
	int mode[N];
	wide c[ORDER + 1][N], force[ORDER + 1][N];      /* of a piece: positions, forces of friction */
	long events;
};

/* Of contact i: what it compares, of these positions, velocities or accelerations */
static wide compared(int i, const wide *x)
{
	return i == 0 ? x[0] : x[i - 1] - x[i];
}

/* x: accelerations less those by friction of this force */
static void push(int i, wide force, wide *x)
{
	if (i > 0)
		x[i - 1] -= force / mass_of(i - 1);
	x[i] -= (i == 0 ? force : -force) / mass_of(i);
}

static wide answer(int i)
{
	return (i > 0 ? 1 / (wide)mass_of(i - 1) : 0) + 1 / (wide)mass_of(i);
}

/* Forces of those at rest between their bounds, by which what is free of these does not move */
static void relax(const bool *rests, wide *force, wide *a)
{
	wide most = 1;
	for (int sweep = 0; sweep < 2000 && most > 1e-17L; sweep++) {
		most = 0;
		for (int i = 0; i < N; i++) {
			const wide more = force[i] + faster * compared(i, a) / answer(i);
			const wide next = fminl(fmaxl(more, -friction_of(i)), friction_of(i));
			if (!rests[i])
				continue;
			push(i, next - force[i], a);
			most = fmaxl(most, fabsl(next - force[i]));
			force[i] = next;
		}
	}
}

/* What contact i and the one before answer each other's force by, where both stick */
static wide beside(const int *mode, int i)
{
	return i < 1 || i == N || mode[i] != 0 || mode[i - 1] != 0 ? 0 : (i == 1 ? 1 : -1) / (wide)mass_of(i - 1);
}

/* Forces of those that stick, so that they do not move: elimination from the first on */
static void hold(const int *mode, wide *force, wide *a)
{
	wide pivot[N], right[N];
	for (int i = 0; i < N; i++) {
		const wide share = i > 0 ? beside(mode, i) / pivot[i - 1] : 0;
		pivot[i] = answer(i) - share * beside(mode, i);
		right[i] = compared(i, a) - (i > 0 ? share * right[i - 1] : 0);
	}
	for (int i = N - 1; i >= 0; i--)
		if (mode[i] == 0)
			force[i] = (right[i] - (i < N - 1 ? beside(mode, i + 1) * force[i + 1] : 0)) / pivot[i];
	for (int i = 0; i < N; i++)
		if (mode[i] == 0)
			push(i, force[i], a);
}

/* Of contact i without friction, which takes coefficient k of its spring's force from the accelerations */
static wide stiffness(const struct motion *m, int i)
{
	return i == 0 || m->kind == BALLS ? 0 : m->kind == BLOCKS ? 100 : m->mode[i] * hard;
}

/* Coefficient k of the accelerations, without friction */
static void accelerate(const struct motion *m, int k, wide *a)
{
	wide cosine = cosl(w * m->t + k * acosl(-1) / 2), power = 1;
	for (int j = 1; j <= k; j++)
		power *= w / (wide)j;
	for (int i = 0; i < N; i++)
		a[i] = -(wide)ground_of(m->kind, i) * m->c[k][i] / mass_of(i);
	for (int i = 1; i < N; i++)
		push(i, stiffness(m, i) * compared(i, m->c[k]), a);
	if (m->kind == BLOCKS)
		a[N - 1] += load * cosine * power / mass_of(N - 1);
}

static void expand(struct motion *m)
{
	memcpy(m->c[0], m->q, sizeof m->q);
	memcpy(m->c[1], m->v, sizeof m->v);
	for (int k = 0; k + 2 <= ORDER; k++) {
		wide a[N];
		accelerate(m, k, a);
		for (int i = 0; i < N && m->kind == BLOCKS; i++) {
			m->force[k][i] = k == 0 ? m->mode[i] * (wide)friction_of(i) : 0;
			push(i, m->force[k][i], a);
		}
		if (m->kind == BLOCKS)
			hold(m->mode, m->force[k], a);
		for (int i = 0; i < N; i++)
			m->c[k + 2][i] = a[i] / ((k + 1) * (k + 2));
	}
}

static void state_at(const struct motion *m, wide s, wide *q, wide *v, wide *force)
{
	for (int i = 0; i < N; i++) {
		q[i] = v[i] = force[i] = 0;
		for (int k = ORDER; k >= 0; k--) {
			v[i] = v[i] * s + q[i];
			q[i] = q[i] * s + m->c[k][i];
		}
		for (int k = ORDER - 2; k >= 0 && m->kind == BLOCKS; k--)
			force[i] = force[i] * s + m->force[k][i];
	}
}

static wide sliding(int i, const wide *v)
{
	return compared(i, v) - (i == 0 ? belt : 0);
}

/* How far contact i is beyond its event, s on */
static wide beyond(const struct motion *m, int i, wide s)
{
	wide q[N], v[N], force[N];
	if (m->kind && i == 0)
		return -1;
	state_at(m, s, q, v, force);
	if (m->kind == PRESSED)
		return m->mode[i] ? -compared(i, q) : compared(i, q);
	if (m->kind)
		return compared(i, v) > 0 ? compared(i, q) - spacing : -1;
	return m->mode[i] == 0 ? fabsl(force[i]) - friction_of(i) : -m->mode[i] * sliding(i, v);
}

/* Each from the velocities that the one before left, again from the first */
static void strike(struct motion *m)
{
	for (int i = 1; i < N; i++) {
		const wide speed = compared(i, m->v), off = compared(i, m->q) - spacing;
		if (off < -1e-15L || speed <= 0)
			continue;
		push(i, (1 + restitution) * speed / answer(i), m->v);
		m->events++;
		i = 0;
	}
}

/* What friction does from here on. at: the one whose velocity has come to 0 */
static void decide(struct motion *m, int at)
{
	bool rests[N];
	wide a[N], force[N];
	memcpy(m->c[0], m->q, sizeof m->q);
	accelerate(m, 0, a);
	for (int i = 0; i < N; i++) {
		rests[i] = m->mode[i] == 0 || i == at;
		force[i] = rests[i] ? 0 : m->mode[i] * (wide)friction_of(i);
		push(i, force[i], a);
	}
	relax(rests, force, a);
	for (int i = 0; i < N; i++) {
		const int before = m->mode[i];
		if (rests[i])
			m->mode[i] = fabsl(force[i]) < friction_of(i) - 1e-15L ? 0 : force[i] > 0 ? 1 : -1;
		m->events += m->mode[i] > before ? m->mode[i] - before : before - m->mode[i];
	}
}

static void toggle(struct motion *m, int at)
{
	m->mode[at] = !m->mode[at];
	m->events++;
}

static void follow(struct motion *m, int until)
{
	while (m->t < until) {
		const wide whole = fminl(m->kind == PRESSED ? piece / 4 : piece, until - m->t);
		wide end = whole, force[N];
		int at = -1;
		expand(m);
		for (int i = 0; i < N; i++) {
			wide from = 0, to = end;
			if (beyond(m, i, end) <= 0)
				continue;
			for (int k = 0; k < 80; k++)
				*(beyond(m, i, (from + to) / 2) > 0 ? &to : &from) = (from + to) / 2;
			end = to;
			at = i;
		}
		state_at(m, end, m->q, m->v, force);
		m->t = m->t + end > until - 1e-9L ? until : m->t + end;
		if (at >= 0 && m->kind == PRESSED)
			toggle(m, at);
		else if (at >= 0 && m->kind == BALLS)
			strike(m);
		else if (at >= 0)
			decide(m, m->mode[at] ? at : -1);
	}
}

/* Those that touch from the start part by less than rounding: such events do not count. */
static void ends_there(const char *name, const struct motion *m, const double *y, unsigned long long events,
	int status)
{
	const bool counted = m->kind != PRESSED;
	double worst = 0;
	for (int i = 0; i < N; i++) {
		worst = worse(worst, fabs(y[i] - (double)m->q[i]));
		worst = worse(worst, fabs(y[N + i] - (double)m->v[i]));
	}
	note("%llu events, expected %ld%s; states off by %.3g, tolerance 1e-11; status %d", events, m->events,
	     counted ? "" : " or so", worst, status);
	ok((!counted || events == (unsigned long long)m->events) && worst <= 1e-11 && status == 0, "%s", name);
}

int main(void)
{
	static struct motion of_blocks, of_balls = { .kind = BALLS, .q = { -1 } };
	static struct motion of_pressed = { .kind = PRESSED, .q = { -1 } };
	static twenty_blocks s;
	static twenty_balls b;
	static twenty_pressed p;
	twenty_blocks_init(&s);
	twenty_balls_init(&b);
	twenty_pressed_init(&p);
	twenty_blocks_run(&s, SECONDS * 100, NULL);
	twenty_balls_run(&b, SECONDS * 100, NULL);
	twenty_pressed_run(&p, 100, NULL);
	for (int i = 0; i < N; i++)
		of_blocks.mode[i] = i == 0 ? -1 : 0;
	decide(&of_blocks, -1);
	of_blocks.events = 0;
	follow(&of_blocks, SECONDS);
	follow(&of_balls, SECONDS);
	follow(&of_pressed, 1);
	ends_there("blocks", &of_blocks, s.y, twenty_blocks_crossed(&s), twenty_blocks_status(&s));
	ends_there("balls", &of_balls, b.y, twenty_balls_crossed(&b), twenty_balls_status(&b));
	ends_there("pressed", &of_pressed, p.y, twenty_pressed_crossed(&p), twenty_pressed_status(&p));
	return tap_end();
}

#endif
