/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sliding_specs KIND SEED: a random system with friction as a spec. */
#include "sliding.h"

#include <stdlib.h>

int main(int argc, char **argv)
{
	char name[40];
	if (argc != 3)
		return 2;
	unsigned seed = (unsigned)strtoul(argv[2], NULL, 10);
	struct sliding s = sliding_system(seed);
	snprintf(name, sizeof name, "%s%u", argv[1], seed);
	print_sliding(stdout, name, &s);
	return 0;
}
