/* SPDX-License-Identifier: GPL-3.0-or-later */
/* For every variant a line NAME SIZE TICKS MOST STACK: sizeof the state; SysTick's ticks over 200 steps and in the longest of them, one call
 * of an empty function each taken off; the bytes of stack that those steps have written to.  Under QEMU's -icount, SysTick counts
 * instructions.  At the end the same for one multiplication and one addition. */
#include "port.h"
#include "variant.h"

enum { STEPS = 200, PAINTED = 6144 };

#define SYSTICK ((volatile uint32_t *)0xE000E010) /* control, reload, value */

static uint64_t state[64];

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
__attribute__((noinline)) static uint32_t stack_of(void (*f)(void *), void *argument)
{
    volatile uint32_t *top, *p;
    int i;
    __asm__ volatile("mov %0, sp" : "=r"(top));
    for (p = top - PAINTED / 4; p < top; p++)
        *p = 0xA5A5A5A5;
    for (i = 0; i < STEPS; i++)
        f(argument);
    for (p = top - PAINTED / 4; p < top && *p == 0xA5A5A5A5; p++)
        ;
    return (uint32_t)(top - p) * 4;
}

static void nothing(void *s)
{
    (void)s;
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
    put_count(stack_of(f, argument));
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
