/* SPDX-License-Identifier: MIT-0 */
/* From reset to main on a Cortex-M without any operating system: what most vendors' start-up files do. */
#include <stdint.h>

/* from the linker script */
extern uint32_t stack_top[], data_start[], data_end[], data_image[], bss_start[], bss_end[];

int main(void);
void stop(int status); /* ends the program, or waits for ever */
void reset(void);
void fault(void);
void SysTick_Handler(void);

void reset(void)
{
	uint32_t *to;
	const uint32_t *from = data_image;
#if defined __ARM_FP
	*(volatile uint32_t *)0xE000ED88 |= 0xFu << 20; /* CPACR: the floating-point unit is off at reset */
	__asm__ volatile("dsb\n\tisb" ::: "memory");
#endif
	for (to = data_start; to < data_end; to++)
		*to = *from++;
	for (to = bss_start; to < bss_end; to++)
		*to = 0;
	stop(main());
}

void fault(void)
{
	stop(2);
}

__attribute__((weak)) void SysTick_Handler(void)
{
	fault();
}

/* The first words of flash: initial stack pointer, then where to go for each exception of the core. */
__attribute__((section(".vectors"), used)) static void (*const vectors[16])(void) = {
	(void (*)(void))stack_top, reset, fault, fault, fault, fault, fault, 0, 0, 0, 0, fault, fault, 0, fault,
		SysTick_Handler};
