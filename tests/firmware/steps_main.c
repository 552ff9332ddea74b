/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "port.h"

#ifdef STEPS /* a board */

const char *wanted = WANTED;
extern uint32_t bss_end[], stack_top[]; /* from the linker script */

enum { PAINTED = 16384 };

/* Words between the variables and the stack pointer get a pattern, as many as fit or the highest PAINTED bytes; those
 * that lose it have been used. */
int main(void)
{
	volatile uint32_t *from, *top, *p;
	__asm__ volatile("mov %0, sp" : "=r"(top));
	from = top - bss_end > PAINTED / 4 ? top - PAINTED / 4 : bss_end;
	for (p = from; p < top; p++)
		*p = 0xA5A5A5A5;
	steps_double(STEPS);
	steps_float(STEPS);
	for (p = from; p < top && *p == 0xA5A5A5A5; p++)
		;
	put("stack ");
	put_count((uint32_t)(stack_top - p) * 4);
	put(" of ");
	put_count((uint32_t)(stack_top - from) * 4);
	put("\nend\n");
	return 0;
}

#else /* a host: their number on the command line */

#include <stdlib.h>

const char *wanted = "";

int main(int argc, char **argv)
{
	if (argc != 2)
		return 3;
	if (getenv("CASE"))
		wanted = getenv("CASE");
	steps_double((uint32_t)strtoul(argv[1], 0, 10));
	steps_float((uint32_t)strtoul(argv[1], 0, 10));
	return 0;
}

#endif
