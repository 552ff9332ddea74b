/* SPDX-License-Identifier: GPL-3.0-or-later */
/* random_specs KIND SEED: the spec of a random system; KIND is what random.sh passes on. */
#include "random_system.h"

#include <stdlib.h>

int main(int argc, char **argv)
{
	if (argc != 3)
		return 2;
	print_switched(stdout, (unsigned)strtoul(argv[2], NULL, 10));
	return 0;
}
