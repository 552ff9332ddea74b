/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "port.h"

#include <stdio.h>
#include <stdlib.h>

void put(const char *text)
{
	fputs(text, stdout);
}

void stop(int status)
{
	exit(status);
}
