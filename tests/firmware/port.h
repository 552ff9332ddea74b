/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All that the test programs ask of where they run: a board under a debugger or emulator (semihosting.c), or a host
 * (host.c). */
#ifndef PORT_H
#define PORT_H

#include <stdint.h>

void put(const char *text);
void stop(int status);

/* Numbers: bits in hexadecimal, as newlib's printf has no %a; and counts. */
void put_bits(uint64_t bits, int digits);
void put_count(uint32_t n);

/* steps.c: that many steps of every variant whose name has the text `wanted` (steps_main.c) */
extern const char *wanted;
void steps_double(uint32_t last);
void steps_float(uint32_t last);

#endif
