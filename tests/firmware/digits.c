/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "port.h"

void put_bits(uint64_t bits, int digits)
{
	char text[17];
	int i;
	for (i = digits; i-- > 0; bits >>= 4)
		text[i] = "0123456789abcdef"[bits & 15];
	text[digits] = '\0';
	put(text);
}

void put_count(uint32_t n)
{
	char text[11], *p = text + 10;
	*p = '\0';
	do
		*--p = (char)('0' + n % 10);
	while ((n /= 10) != 0);
	put(p);
}
