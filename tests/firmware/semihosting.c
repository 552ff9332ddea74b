/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Semihosting: a breakpoint that a debugger or QEMU takes for a request. */
#include "port.h"

enum { WRITE0 = 0x04, EXIT_EXTENDED = 0x20, APPLICATION_EXIT = 0x20026 };

static void request(uint32_t operation, const void *argument)
{
	register uint32_t r0 __asm__("r0") = operation;
	register const void *r1 __asm__("r1") = argument;
	__asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}

void put(const char *text)
{
	request(WRITE0, text);
}

void stop(int status)
{
	const uint32_t arguments[2] = {APPLICATION_EXIT, (uint32_t)status};
	request(EXIT_EXTENDED, arguments);
	for (;;)
		;
}
