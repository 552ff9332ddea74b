/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sliding.h"
#include "quadrant.h"

#include <math.h>
#include <string.h>

enum { TERMS = 22, PARTS = 24 };
static const wide longest = 0.01L, level = 1e-15L;

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

static void rub_something(struct sliding *s, int index, unsigned *state)
{
	struct rubbing *r = &s->rub[index];
	int i = (int)(next(state) % (unsigned)s->n), j = (int)(next(state) % (unsigned)s->n);
	r->direction[i] = 1;
	if (i != j && next(state) % 2)
		r->direction[j] = -1;
	r->force = between(state, 0.1, 1, 18);
	if (next(state) % 3 == 0)
		r->belt = between(state, -0.4, 0.4, 16);
	if (next(state) % 4 == 0) {
		r->swing = between(state, 0.1, 0.5, 8);
		r->w = between(state, 0.5, 3, 10);
	}
	r->at = (int)(next(state) % (unsigned)s->n);
	if (next(state) % 3 == 0)
		r->mu = between(state, 0.1, 0.6, 10);
}

/* Directions that depend on each other are not drawn: what sticks would not be determined. */
static int independent(const struct sliding *s)
{
	double a[MOST_FRICTION][MOST_COORDS];
	int rank = 0;
	for (int r = 0; r < s->rubs; r++)
		for (int j = 0; j < s->n; j++)
			a[r][j] = s->rub[r].direction[j];
	for (int j = 0; j < s->n; j++)
		for (int r = rank; r < s->rubs; r++) {
			if (a[r][j] == 0)
				continue;
			for (int k = 0; k < s->n; k++) {
				double swap = a[r][k];
				a[r][k] = a[rank][k];
				a[rank][k] = swap;
			}
			for (int q = rank + 1; q < s->rubs; q++)
				for (int k = s->n - 1; k >= j; k--)
					a[q][k] -= a[rank][k] * a[q][j] / a[rank][j];
			rank++;
			break;
		}
	return rank == s->rubs;
}

struct sliding sliding_system(unsigned seed)
{
	struct sliding s;
	unsigned state = seed * 2654435761u + 12345u;
	memset(&s, 0, sizeof s);
	for (int i = 0; i < 4; i++)
		(void)next(&state);
	s.n = 1 + (int)(seed % MOST_COORDS);
	for (int i = 0; i < s.n; i++) {
		s.m[i] = between(&state, 0.5, 2, 6);
		s.f[i] = next(&state) % 3 ? between(&state, 0.5, 3, 10) : 0;
		s.w[i] = between(&state, 0.5, 4, 14);
		s.p[i] = between(&state, 0, 3, 6);
		s.start[i] = between(&state, -0.5, 0.5, 20) + 0.003;   /* on no end of an interval */
		s.start[s.n + i] = next(&state) % 2 ? between(&state, -1, 1, 20) : 0;
	}
	for (int i = 0; i <= s.n; i++) {
		s.k[i] = i == s.n && next(&state) % 2 ? 0 : between(&state, 1, 20, 19);
		s.c[i] = next(&state) % 2 ? between(&state, 0, 0.5, 10) : 0;
	}
	s.c[0] += 0.05;         /* an undamped orbit that sticking leaves comes back to touch, again and again */
	/* 3 of 4 are long in the making */
	s.rubs = 1 + (int)(next(&state) % (s.n == 2 || s.n == 4 ? 2 : (unsigned)s.n));
	do {
		memset(s.rub, 0, sizeof s.rub);
		for (int r = 0; r < s.rubs; r++)
			rub_something(&s, r, &state);
	} while (!independent(&s));
	s.stops = (int)(next(&state) % (MOST_STOPS + 1));
	for (int k = 0; k < s.stops; k++) {
		s.stop[k].at = (int)(next(&state) % (unsigned)s.n);
		s.stop[k].gap = between(&state, 0.05, 0.4, 7) + 0.01 * k;
		s.stop[k].stiffness = between(&state, 5, 50, 9);
	}
	for (int r = s.rubs - 1; r >= 0 && s.rubs == 3; r--)    /* 243 regions: 27, 4 of stops, one normal force */
		s.rub[r].mu = r == 0 ? s.rub[r].mu : 0;
	return s;
}

/* ---- as a spec ---- */

static void print_rub(FILE *to, const struct sliding *s, const struct rubbing *r, int coord)
{
	if (!r->direction[coord])
		return;
	fprintf(to, " %s friction(", r->direction[coord] > 0 ? "+" : "-");
	for (int j = 0, first = 1; j < s->n; j++)
		if (r->direction[j]) {
			fprintf(to, "%sx%d'", r->direction[j] < 0 ? "-" : first ? "" : "+", j + 1);
			first = 0;
		}
	if (r->belt != 0)
		fprintf(to, " - (%.17g)", r->belt);
	if (r->swing != 0)
		fprintf(to, " - %.17g*cos(%.17g*t)", r->swing, r->w);
	fprintf(to, ", %.17g", r->force);
	if (r->mu != 0)
		fprintf(to, " + %.17g*max(x%d, 0)", r->mu, r->at + 1);
	fprintf(to, ")");
}

void print_sliding(FILE *to, const char *name, const struct sliding *s)
{
	fprintf(to, "model %s\ncoord x1", name);
	for (int i = 1; i < s->n; i++)
		fprintf(to, ", x%d", i + 1);
	fprintf(to, "\n");
	for (int i = 0; i < s->n; i++) {
		fprintf(to, "%.17g*x%d'' + %.17g*x%d + %.17g*x%d'", s->m[i], i + 1, s->k[i] + s->k[i + 1], i + 1,
			s->c[i] + s->c[i + 1], i + 1);
		if (i > 0)
			fprintf(to, " - %.17g*x%d - %.17g*x%d'", s->k[i], i, s->c[i], i);
		if (i + 1 < s->n)
			fprintf(to, " - %.17g*x%d - %.17g*x%d'", s->k[i + 1], i + 2, s->c[i + 1], i + 2);
		for (int r = 0; r < s->rubs; r++)
			print_rub(to, s, &s->rub[r], i);
		for (int k = 0; k < s->stops; k++)
			if (s->stop[k].at == i)
				fprintf(to, " + %.17g*max(x%d - %.17g, 0)", s->stop[k].stiffness, i + 1,
					s->stop[k].gap);
		fprintf(to, " = %.17g*cos(%.17g*t + %.17g)\n", s->f[i], s->w[i], s->p[i]);
	}
	for (int i = 0; i < s->n; i++)
		fprintf(to, "init x%d = %.17g, x%d' = %.17g\n", i + 1, s->start[i], i + 1, s->start[s->n + i]);
	fprintf(to, "step 0.05\n");
}

/* ---- the motion as a series: y(t + u) = sum y[k] u^k, in one mode of all that switches ---- */

struct expansion {
	wide y[TERMS + 1][2 * MOST_COORDS];
	wide force[MOST_FRICTION][TERMS + 1];  /* what friction carries, + against sliding up */
	wide bound[MOST_FRICTION][TERMS + 1], slide[MOST_FRICTION][TERMS + 1];
	wide depth[MOST_STOPS][TERMS + 1], normal[MOST_FRICTION][TERMS + 1];
};

/* u^k of cos(w (t + u) + p) */
static wide cosine(wide w, wide p, wide t, int k)
{
	wide value = cos_of(w * t + p + k * (acosl(-1.0L) / 2));
	for (int i = 1; i <= k; i++)
		value *= w / i;
	return value;
}

/* The force that is not friction's on a coordinate */
static wide pull(const struct sliding *s, const struct sliding_state *now, const wide *y, int i, int k)
{
	const wide *x = y, *v = y + s->n;
	wide sum = s->f[i] != 0 ? s->f[i] * cosine(s->w[i], s->p[i], now->t, k) : 0;
	sum -= ((wide)s->k[i] + s->k[i + 1]) * x[i] + ((wide)s->c[i] + s->c[i + 1]) * v[i];
	if (i > 0)
		sum += s->k[i] * x[i - 1] + s->c[i] * v[i - 1];
	if (i + 1 < s->n)
		sum += s->k[i + 1] * x[i + 1] + s->c[i + 1] * v[i + 1];
	for (int j = 0; j < s->stops; j++)
		if (s->stop[j].at == i && now->stop[j])
			sum -= s->stop[j].stiffness * (x[i] - (k == 0 ? (wide)s->stop[j].gap : 0));
	return sum;
}

/* Forces that keep what sticks: G M^-1 G' force = G M^-1 pull - belt'' */
static void hold(const struct sliding *s, const struct sliding_state *now, struct expansion *e, const wide *free, int k)
{
	wide a[MOST_FRICTION][MOST_FRICTION + 1];
	int held[MOST_FRICTION], count = 0;
	for (int r = 0; r < s->rubs; r++)
		if (now->rub[r] == 0)
			held[count++] = r;
	for (int p = 0; p < count; p++) {
		const struct rubbing *rub = &s->rub[held[p]];
		a[p][count] = rub->swing != 0 ? -(k + 1) * rub->swing * cosine(rub->w, 0, now->t, k + 1) : 0;
		for (int i = 0; i < s->n; i++)
			a[p][count] += rub->direction[i] * free[i] / s->m[i];
		for (int q = 0; q < count; q++) {
			a[p][q] = 0;
			for (int i = 0; i < s->n; i++)
				a[p][q] += rub->direction[i] * s->rub[held[q]].direction[i] / (wide)s->m[i];
		}
	}
	for (int p = 0; p < count; p++)
		for (int q = 0; q < count; q++) {
			wide factor = a[q][p] / a[p][p];
			for (int j = p; j <= count && q != p; j++)
				a[q][j] -= factor * a[p][j];
		}
	for (int p = 0; p < count; p++)
		e->force[held[p]][k] = a[p][count] / a[p][p];
}

static void measure(const struct sliding *s, const struct sliding_state *now, struct expansion *e, int k)
{
	const wide *y = e->y[k];
	for (int r = 0; r < s->rubs; r++) {
		const struct rubbing *rub = &s->rub[r];
		e->slide[r][k] = (k == 0 ? -(wide)rub->belt : 0) -
				 (rub->swing != 0 ? rub->swing * cosine(rub->w, 0, now->t, k) : 0);
		for (int i = 0; i < s->n; i++)
			e->slide[r][k] += rub->direction[i] * y[s->n + i];
		e->normal[r][k] = y[rub->at];
		e->bound[r][k] = (k == 0 ? (wide)rub->force : 0) + (now->normal[r] ? rub->mu * y[rub->at] : 0);
	}
	for (int j = 0; j < s->stops; j++)
		e->depth[j][k] = y[s->stop[j].at] - (k == 0 ? (wide)s->stop[j].gap : 0);
}

static void expand(const struct sliding *s, const struct sliding_state *now, struct expansion *e)
{
	wide free[MOST_COORDS];
	memcpy(e->y[0], now->y, sizeof now->y);
	for (int k = 0; k <= TERMS; k++) {
		measure(s, now, e, k);
		for (int i = 0; i < s->n; i++)
			free[i] = pull(s, now, e->y[k], i, k);
		for (int r = 0; r < s->rubs; r++) {
			e->force[r][k] = now->rub[r] * e->bound[r][k];
			for (int i = 0; i < s->n && now->rub[r]; i++)
				free[i] -= s->rub[r].direction[i] * e->force[r][k];
		}
		hold(s, now, e, free, k);
		for (int r = 0; r < s->rubs; r++)
			for (int i = 0; i < s->n && !now->rub[r]; i++)
				free[i] -= s->rub[r].direction[i] * e->force[r][k];
		for (int i = 0; i < s->n && k < TERMS; i++) {
			e->y[k + 1][i] = e->y[k][s->n + i] / (k + 1);
			e->y[k + 1][s->n + i] = free[i] / s->m[i] / (k + 1);
		}
	}
}

static wide value(const wide *series, wide u)
{
	wide sum = 0;
	for (int k = TERMS - 1; k >= 0; k--)
		sum = sum * u + series[k];
	return sum;
}

/* ---- events ---- */

/* The first whose normal force switches with that of r; -1: it has none */
static int normal_of(const struct sliding *s, int r)
{
	int first = 0;
	if (s->rub[r].mu == 0)
		return -1;
	while (s->rub[first].mu == 0 || s->rub[first].at != s->rub[r].at)
		first++;
	return first;
}

/* Everything that must not rise above 0; how many. what: 0 friction, 1 stop, 2 normal force */
struct watch { wide series[TERMS + 1]; int what, index, way; };

static int watches(const struct sliding *s, const struct sliding_state *now, const struct expansion *e,
		   struct watch *w)
{
	int count = 0;
	for (int k = 0; k <= TERMS; k++) {
		count = 0;
		for (int r = 0; r < s->rubs; r++)
			for (int way = -1; way <= 1; way += 2) {
				if (now->rub[r] == way)
					continue;       /* it slips that way */
				w[count].series[k] = now->rub[r] == 0 ? way * e->force[r][k] - e->bound[r][k]
								      : way * e->slide[r][k];
				w[count].what = 0;
				w[count].index = r;
				w[count++].way = way;
			}
		for (int j = 0; j < s->stops; j++) {
			w[count].series[k] = now->stop[j] ? -e->depth[j][k] : e->depth[j][k];
			w[count].what = 1;
			w[count++].index = j;
		}
		for (int r = 0; r < s->rubs; r++) {
			if (normal_of(s, r) != r)
				continue;
			w[count].series[k] = now->normal[r] ? -e->normal[r][k] : e->normal[r][k];
			w[count].what = 2;
			w[count++].index = r;
		}
	}
	return count;
}

/* Where it first rises above 0 before `end`; end where it does not */
static wide first_rise(const wide *series, wide end)
{
	wide low = 0;
	for (int i = 1; i <= PARTS; i++) {
		wide high = end * i / PARTS;
		if (value(series, high) <= level) {
			low = high;
			continue;
		}
		for (int k = 0; k < 80; k++) {
			wide middle = (low + high) / 2;
			if (value(series, middle) > 0)
				high = middle;
			else
				low = middle;
		}
		return high;
	}
	return end;
}

static void list_event(struct sliding_state *now)
{
	if (now->events < SLIDING_EVENTS)
		now->time[now->events] = (double)now->t;
	now->events++;
}

static int rises(const wide *series, int from)
{
	wide unit = 1;
	for (int k = from; k < 5; k++, unit *= 8)
		if (fabsl(series[k]) > 1e-12L * unit)
			return series[k] > 0 ? 1 : -1;
	return 0;
}

/* Whether all that is at rest agrees with a mode */
static int agrees(const struct sliding *s, const struct sliding_state *mode, const int *resting)
{
	static struct expansion e;
	expand(s, mode, &e);
	for (int r = 0; r < s->rubs; r++) {
		if (!resting[r])
			continue;
		if (mode->rub[r] != 0) {
			if (rises(e.slide[r], 1) != mode->rub[r])
				return 0;
			continue;
		}
		for (int way = -1; way <= 1; way += 2) {
			wide over[TERMS + 1];
			for (int k = 0; k <= TERMS; k++)
				over[k] = way * e.force[r][k] - e.bound[r][k];
			if (rises(over, 0) > 0)
				return 0;
		}
	}
	return 1;
}

/* The mode with fewest changes in which all agree */
static void decide(const struct sliding *s, struct sliding_state *now, int listed)
{
	static struct expansion e;
	int resting[MOST_FRICTION] = { 0 }, best = -1, least = 0;
	expand(s, now, &e);
	for (int r = 0; r < s->rubs; r++)
		resting[r] = fabsl(e.slide[r][0]) < 1e-14L;
	for (int code = 0; code < 27; code++) {
		struct sliding_state mode = *now;
		int digit = code, score = 0, fits = 1;
		for (int r = 0; r < s->rubs; r++, digit /= 3) {
			mode.rub[r] = digit % 3 - 1;
			fits = fits && (resting[r] || mode.rub[r] == now->rub[r]);
			score += (mode.rub[r] != now->rub[r]) * 8 + (mode.rub[r] != 0);
		}
		if (digit == 0 && fits && (best < 0 || score < least) && agrees(s, &mode, resting)) {
			best = code;
			least = score;
		}
	}
	now->undecided += best < 0;
	for (int r = 0; r < s->rubs && best >= 0; r++, best /= 3) {
		int to = best % 3 - 1, steps = to - now->rub[r];
		for (int k = 0; k < (steps < 0 ? -steps : steps) && listed; k++)
			list_event(now);
		now->sticks += to == 0 && now->rub[r] != 0;
		now->rub[r] = to;
	}
}

void sliding_start(const struct sliding *s, struct sliding_state *now)
{
	static struct expansion e;
	memset(now, 0, sizeof *now);
	for (int i = 0; i < 2 * s->n; i++)
		now->y[i] = s->start[i];
	expand(s, now, &e);
	for (int j = 0; j < s->stops; j++)
		now->stop[j] = rises(e.depth[j], 0) > 0;
	for (int r = 0; r < s->rubs; r++) {
		now->normal[r] = e.normal[r][0] != 0 ? e.normal[r][0] > 0 : e.normal[r][1] > 0;
		now->rub[r] = fabsl(e.slide[r][0]) < 1e-14L ? 0 : e.slide[r][0] > 0 ? 1 : -1;
	}
	decide(s, now, 0);
	now->sticks = 0;
}

/* To `u` by the series; what sticks is then set exactly: of n coordinates the truth needs it to rounding alone. */
static void go(const struct sliding *s, struct sliding_state *now, const struct expansion *e, wide u)
{
	for (int i = 0; i < 2 * s->n; i++) {
		now->y[i] = 0;
		for (int k = TERMS; k >= 0; k--)
			now->y[i] = now->y[i] * u + e->y[k][i];
	}
	now->t += u;
}

void sliding_until(const struct sliding *s, struct sliding_state *now, double end)
{
	static struct expansion e;
	static struct watch w[2 * MOST_FRICTION + MOST_STOPS + MOST_FRICTION];
	while (now->t < end) {
		wide u = end - now->t < longest ? end - now->t : longest;
		int first = -1, count;
		expand(s, now, &e);
		count = watches(s, now, &e, w);
		for (int i = 0; i < count; i++) {
			wide at = first_rise(w[i].series, u);
			first = at < u ? i : first;
			u = at < u ? at : u;
		}
		go(s, now, &e, u);
		if (first < 0)
			continue;
		list_event(now);
		if (w[first].what == 1)
			now->stop[w[first].index] ^= 1;
		else if (w[first].what == 2) {
			for (int r = 0; r < s->rubs; r++)
				now->normal[r] ^= normal_of(s, r) == w[first].index;
		} else {
			now->rub[w[first].index] += w[first].way;
			now->sticks += now->rub[w[first].index] == 0;
		}
		decide(s, now, 1);
	}
}
