/* SPDX-License-Identifier: GPL-3.0-or-later */
/* refreshes: models with loads in pairs, one with refreshes, one with its functions in every step. In states and
 * outputs they agree within some units of rounding of their largest values: over a long run; where a state is set, or
 * jumped to, any number of steps after a refresh; after NAME_at. What a refresh keeps is all in the struct: a copy goes
 * on with the same bits. Against closed forms: forms/history, forms/loads. */
#include "plrt.h"
#include "tap.h"

#include "variant.h"
#include VARIANTS_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 16, BEHIND = 70 };

struct pair {
	const pl_model *a, *b;          /* with refreshes; without */
	void *s, *r, *copy;
};

/* A sample for any input at any step */
static double sample(uint64_t k)
{
	return sin(0.37 * (double)k) + 0.25 * cos(0.11 * (double)k);
}

static void step(const pl_model *m, void *s, uint64_t k)
{
	const double u[1] = {sample(k)};
	m->step(s, u);
}

/* Differences over largest values, of states and outputs */
struct off {
	double most[2 * MOST], off[2 * MOST];
};

static void look(const struct pair *p, struct off *o)
{
	double y[2][2 * MOST];
	const int states = (int)p->a->states, count = states + (int)p->a->outputs;
	int i;
	p->a->get(p->s, y[0]);
	p->b->get(p->r, y[1]);
	p->a->out(p->s, y[0] + states);
	p->b->out(p->r, y[1] + states);
	for (i = 0; i < count; i++) {
		o->most[i] = fmax(o->most[i], fabs(y[1][i]));
		if (!(fabs(y[0][i] - y[1][i]) <= o->off[i]))
			o->off[i] = fabs(y[0][i] - y[1][i]);
	}
}

static double worst(const struct off *o)
{
	double most = 0;
	int i;
	for (i = 0; i < 2 * MOST; i++)
		if (o->most[i] > 0 && !(o->off[i] / o->most[i] <= most))
			most = o->off[i] / o->most[i];
	return most;
}

static void long_run(const struct pair *p, const char *name, int steps, double bound)
{
	struct off o = {{0}, {0}};
	int k;
	p->a->init(p->s);
	p->b->init(p->r);
	for (k = 0; k < steps; k++) {
		look(p, &o);
		step(p->a, p->s, (uint64_t)k);
		step(p->b, p->r, (uint64_t)k);
	}
	ok(worst(&o) <= bound, "%s: over %d steps off by %.2g of the largest value, at most %.2g", name, steps,
			worst(&o),
		bound);
}

/* Set k steps after a refresh of the other one, and again k steps after that */
static void any_start(const struct pair *p, const char *name, double bound)
{
	struct off o = {{0}, {0}};
	double y[MOST];
	int k, i;
	p->a->init(p->s);
	p->b->init(p->r);
	for (k = 1; k < BEHIND; k++) {
		for (i = 0; i < 2 * k; i++) {
			step(p->a, p->s, (uint64_t)i);
			step(p->b, p->r, (uint64_t)i);
			if (i >= k)
				look(p, &o);
			if (i != k - 1)
				continue;
			p->b->get(p->r, y);
			p->a->set(p->s, p->b->time(p->r), y);
			p->b->set(p->r, p->b->time(p->r), y);
		}
	}
	ok(worst(&o) <= bound, "%s: set at any phase off by %.2g of the largest value, at most %.2g", name, worst(&o),
		bound);
}

static void set_is_read(const struct pair *p, const char *name)
{
	double y[MOST], z[MOST];
	int k, i, same = 1;
	p->a->init(p->s);
	for (k = 0; k < BEHIND; k++) {
		for (i = 0; i < (int)p->a->states; i++)
			y[i] = sample((uint64_t)(5 * k + i)) * 1e-3;
		p->a->set(p->s, 0.3 * k, y);
		p->a->get(p->s, z);
		same = same && memcmp(y, z, p->a->states * sizeof *y) == 0;
		for (i = 0; i < k; i++)
			step(p->a, p->s, (uint64_t)i);
	}
	ok(same, "%s: what is set is read again, bit for bit", name);
}

/* From every number of steps since a refresh, over few and many steps */
static void jumps(const struct pair *p, const char *name, double bound)
{
	struct off o = {{0}, {0}};
	int since, k;
	for (since = 0; since < BEHIND; since += 3) {
		p->a->init(p->s);
		p->b->init(p->r);
		for (k = 0; k < since; k++) {
			p->a->step(p->s, NULL);
			p->b->step(p->r, NULL);
		}
		p->a->jump(p->s, (uint64_t)(2 * since + 1));
		for (k = 0; k < 2 * since + 1; k++)
			p->b->step(p->r, NULL);
		look(p, &o);
		for (k = 0; k < since; k++) {
			p->a->step(p->s, NULL);
			p->b->step(p->r, NULL);
		}
		look(p, &o);
	}
	ok(worst(&o) <= bound, "%s: jumps off by %.2g of the largest value, at most %.2g", name, worst(&o), bound);
}

static void between(const struct pair *p, const char *name, double bound)
{
	struct off o = {{0}, {0}};
	double y[2][MOST], u[1];
	int k, i;
	p->a->init(p->s);
	p->b->init(p->r);
	for (k = 0; k < BEHIND; k++) {
		u[0] = sample((uint64_t)k);
		p->a->at(p->s, u, 0.7 * p->a->h, y[0]);
		p->b->at(p->r, u, 0.7 * p->a->h, y[1]);
		for (i = 0; i < (int)p->a->states; i++)
			o.off[i] = worse(o.off[i], fabs(y[0][i] - y[1][i]));
		step(p->a, p->s, (uint64_t)k);
		step(p->b, p->r, (uint64_t)k);
		look(p, &o);
	}
	ok(worst(&o) <= bound, "%s: between steps off by %.2g of the largest value, at most %.2g", name, worst(&o),
			bound);
}

/* A copy goes on with the same bits, and so does run */
static void copies(const struct pair *p, const char *name)
{
	double y[2 * MOST], z[2 * MOST], u[BEHIND];
	int k, i, same = 1;
	p->a->init(p->s);
	for (k = 0; k < BEHIND; k++) {
		memcpy(p->copy, p->s, p->a->size);
		for (i = 0; i < k; i++) {
			u[i] = sample((uint64_t)i);
			step(p->a, p->s, (uint64_t)i);
		}
		p->a->run(p->copy, (size_t)k, u, NULL);
		p->a->out(p->s, y);
		p->a->out(p->copy, z);
		same = same && memcmp(y, z, p->a->outputs * sizeof *y) == 0;
		p->a->get(p->s, y);
		p->a->get(p->copy, z);
		same = same && memcmp(y, z, p->a->states * sizeof *y) == 0 && p->a->time(p->s) == p->a->time(p->copy);
	}
	ok(same, "%s: a copy goes on, by run, with the same bits", name);
}

static void judge(const struct variant *v, int steps, double bound)
{
	const double few = 1e-14; /* some hundred steps */
	const char *name = v->model->name;
	struct pair p = {v->model, v[1].model, malloc(v->model->size), malloc(v[1].model->size),
			malloc(v->model->size)};
	if (v->model->states > MOST || v->model->outputs > MOST || v[1].model->states != v->model->states) {
		ok(false, "%s: a model of another size", name);
		return;
	}
	ok(p.a->size > p.b->size, "%s keeps an anchor: %zu bytes, without %zu", name, p.a->size, p.b->size);
	long_run(&p, name, steps, bound);
	any_start(&p, name, few);
	set_is_read(&p, name);
	if (p.a->jump)
		jumps(&p, name, few);
	if (p.a->at)
		between(&p, name, few);
	copies(&p, name);
	free(p.s);
	free(p.r);
	free(p.copy);
}

/* What is not damped keeps what rounding did to it: its bound grows with the root of the steps. */
int main(void)
{
	const struct variant *v;
	const bool is_long = getenv("LONG") != NULL;
	for (v = VARIANTS; v->model; v += 2) {
		/* its load of growing size makes the motion chaotic: what begins a unit in the last place apart is
		 * 0.002 apart after 200,000 steps */
		const bool forgets = strncmp(v->model->name, "apart", 5) == 0;
		judge(v, is_long && !forgets ? 1000000 : 10000, is_long ? 2e-13 : 2e-14);
	}
	return tap_end();
}
