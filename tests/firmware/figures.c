/* SPDX-License-Identifier: GPL-3.0-or-later */
/* For every variant a line NAME SIZE TICKS MOST STACK: sizeof the state; SysTick's ticks over 200 steps and in the
 * longest of them, one call of an empty function each taken off; the bytes of stack that those steps have written to.
 * Under QEMU's -icount, SysTick counts instructions.  At the end the same for one multiplication and one addition.
 * What has tunable params gets lines NAME_retune SIZE TICKS MOST STACK TIMES: sizeof the coefficients; ticks over 4
 * retunes, and in the longest of them; how many times the spec's step h is. */
#include "port.h"
#include "variant.h"

enum { STEPS = 200, RETUNES = 4, PARAMS = 3, PAINTED = 9216 };

#define SYSTICK ((volatile uint32_t *)0xE000E010) /* control, reload, value */

static uint64_t state[64], coeffs[64];

typedef struct measure {
	uint32_t total, most;
} measure;

static measure measured(void (*f)(void *), void *argument)
{
	measure m = {0, 0};
	int i;
	for (i = 0; i < STEPS; i++) {
		const uint32_t before = SYSTICK[2];
		uint32_t spent;
		f(argument);
		spent = (before - SYSTICK[2]) & 0xFFFFFF; /* it counts down, 24 bits */
		m.total += spent;
		m.most = spent > m.most ? spent : m.most;
	}
	return m;
}

/* Words below the stack pointer get a pattern; those that lost it have been used. */
__attribute__((noinline)) static uint32_t stack_of(int times, void (*f)(void *), void *argument)
{
	volatile uint32_t *top, *p;
	int i;
	__asm__ volatile("mov %0, sp" : "=r"(top));
	for (p = top - PAINTED / 4; p < top; p++)
		*p = 0xA5A5A5A5;
	for (i = 0; i < times; i++)
		f(argument);
	for (p = top - PAINTED / 4; p < top && *p == 0xA5A5A5A5; p++)
		;
	return (uint32_t)(top - p) * 4;
}

static void nothing(void *s)
{
	(void)s;
}

/* SysTick has 24 bits: here its rounds are counted, by an interrupt of a few instructions in a million. */
static volatile uint32_t rounds;

void SysTick_Handler(void)
{
	rounds++;
}

static uint32_t ticks(void)
{
	uint32_t before, value;
	do {
		before = rounds;
		value = SYSTICK[2];
	} while (before != rounds);
	return (before << 24) - value;
}

/* A retune, each time to other params: up to 3/16 off the spec's */
struct retune {
	const struct variant *variant;
	uint32_t random;
	real h;
};

static void retune(void *r_)
{
	struct retune *r = r_;
	real params[PARAMS];
	int i;
	for (i = 0; i < PARAMS; i++) {
		r->random = r->random * 1664525u + 1013904223u;
		params[i] = r->variant->model->param_values[i] *
			((real)1 + (real)(int32_t)r->random * (real)(3.0 / 16 / 2147483648.0));
	}
	if (r->variant->tuning->retune(coeffs, params, r->h) != 0)
		stop(4);
}

static void retune_line(const struct variant *v, uint32_t times)
{
	struct retune r = {0, 1, 0};
	measure m = {0, 0};
	int i;
	r.variant = v;
	r.h = v->model->h * (real)times;
	SYSTICK[0] = 7; /* with the interrupt */
	for (i = 0; i < RETUNES; i++) {
		const uint32_t before = ticks();
		uint32_t spent;
		retune(&r);
		spent = ticks() - before;
		m.total += spent;
		m.most = spent > m.most ? spent : m.most;
	}
	SYSTICK[0] = 5;
	put(v->model->name);
	put("_retune ");
	put_count((uint32_t)v->tuning->size);
	put(" ");
	put_count(m.total);
	put(" ");
	put_count(m.most);
	put(" ");
	put_count(stack_of(RETUNES, retune, &r));
	put(" ");
	put_count(times);
	put("\n");
}

static void line(const char *name, uint32_t size, void (*f)(void *), void *argument)
{
	void (*volatile empty)(void *) = nothing;
	const measure none = measured(empty, argument), some = measured(f, argument);
	put(name);
	put(" ");
	put_count(size);
	put(" ");
	put_count(some.total - none.total);
	put(" ");
	put_count(some.most - none.most);
	put(" ");
	put_count(stack_of(STEPS, f, argument));
	put("\n");
}

/* Soft float takes as long as its operands want: these are of both signs, within a factor of 16, all bits in use. */
struct operands {
	uint32_t random;
	real a, b, result;
};

static real next(struct operands *o)
{
	o->random = o->random * 1664525u + 1013904223u;
	return ((real)(int32_t)o->random + (real)(int32_t)(o->random >> 8 | 0x800000)) / (real)3e9;
}

static void draw(void *o_)
{
	struct operands *o = o_;
	o->a = next(o);
	o->b = next(o);
}

static void draw_multiply(void *o_)
{
	struct operands *o = o_;
	draw(o);
	o->result = o->a * o->b;
}

static void draw_add(void *o_)
{
	struct operands *o = o_;
	draw(o);
	o->result = o->a + o->b;
}

void OF_REAL(matvec)(void *s);

int main(void)
{
	const struct variant *v;
	struct operands o = {1, 0, 0, 0};
	real *y = (real *)(void *)state;
	SYSTICK[1] = 0xFFFFFF;
	SYSTICK[2] = 0;
	SYSTICK[0] = 5; /* on, from the processor's clock, no interrupt */
	for (v = OF_REAL(variants); v->model; v++) {
		int i;
		v->model->init(state);
		for (i = 0; i < 100; i++)
			v->step(state); /* away from zeros, with which soft float is done early */
		line(v->model->name, (uint32_t)v->model->size, v->step, state);
		if (v->tuning) {
			if (v->tuning->size > sizeof coeffs || v->model->params != PARAMS)
				stop(3);
			retune_line(v, 1);
			retune_line(v, 5);
			retune_line(v, 30);
		}
	}
	y[0] = (real)0.01;
	y[1] = y[2] = y[3] = (real)-0.02;
	line("matvec", 4 * sizeof(real), OF_REAL(matvec), state);
	line("draw", 0, draw, &o);
	o.random = 1;
	line("multiply", 0, draw_multiply, &o);
	o.random = 1;
	line("add", 0, draw_add, &o);
	put("end\n");
	return 0;
}
