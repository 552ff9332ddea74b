/* SPDX-License-Identifier: GPL-3.0-or-later */
/* random_specs KIND SEED: the system of this seed on standard output; KIND is random or adversarial. */
#include "random_system.h"

#include <stdlib.h>
#include <string.h>

int main(int argc, char **argv)
{
	if (argc != 3)
		return 2;
	const unsigned seed = (unsigned)atoi(argv[2]);
	const struct hand_system s = strcmp(argv[1], "random") == 0 ? random_system(seed) : adversarial_system(seed);
	char name[40];
	snprintf(name, sizeof name, "%s%u", argv[1], seed);
	print_spec(stdout, name, &s, seed);
	return 0;
}
