/* SPDX-License-Identifier: GPL-3.0-or-later */
/* random_specs KIND SEED: the system of this seed on standard output; KIND is random, adversarial or timed. */
#include "random_system.h"
#include "timed_system.h"

#include <stdlib.h>
#include <string.h>

int main(int argc, char **argv)
{
	if (argc != 3)
		return 2;
	const unsigned seed = (unsigned)atoi(argv[2]);
	char name[40];
	snprintf(name, sizeof name, "%s%u", argv[1], seed);
	if (strcmp(argv[1], "timed") == 0) {
		const struct timed_system timed = timed_system(seed);
		print_timed(stdout, name, &timed, seed);
		return 0;
	}
	const struct hand_system s = strcmp(argv[1], "random") == 0 ? random_system(seed) : adversarial_system(seed);
	print_spec(stdout, name, &s, seed);
	return 0;
}
