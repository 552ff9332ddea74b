/* SPDX-License-Identifier: MIT-0 */
/* Cycles on a real board, from the counter that Cortex-M3, M4, M7 and M33 have.  (M0 and M0+ have none: take SysTick.)
 *
 *     uint32_t before, spent;
 *     cycles_start();
 *     before = cycles();
 *     scs_step(&s);
 *     spent = cycles() - before;     // right also when the counter wraps
 *
 * Take off what two calls of cycles() with nothing between them give; let it run some hundred times with interrupts
 * masked, and look at the least and the largest: flash wait states and caches make the difference.  Where the compiler
 * can see both calls, it may move arithmetic across them: keep the step in another file. */
#ifndef CYCLES_H
#define CYCLES_H

#include <stdint.h>

#if defined __ARM_ARCH_6M__ || defined __ARM_ARCH_8M_BASE__
#error "this processor has no cycle counter"
#endif

static inline void cycles_start(void)
{
    *(volatile uint32_t *)0xE000EDFCu |= 1u << 24; /* DEMCR: trace on */
    *(volatile uint32_t *)0xE0001FB0u = 0xC5ACCE55u; /* DWT->LAR: unlocks what a Cortex-M7 locks */
    *(volatile uint32_t *)0xE0001004u = 0;           /* DWT->CYCCNT */
    *(volatile uint32_t *)0xE0001000u |= 1u;         /* DWT->CTRL: count */
}

static inline uint32_t cycles(void)
{
    uint32_t now;
    __asm__ volatile("" ::: "memory"); /* nothing in memory moves across */
    now = *(volatile uint32_t *)0xE0001004u;
    __asm__ volatile("" ::: "memory");
    return now;
}

#endif
