/* SPDX-License-Identifier: GPL-3.0-or-later */
/* joint_specs KIND SEED: a random joint as a spec. */
#include "joint.h"

#include <stdlib.h>

int main(int argc, char **argv)
{
	char name[40];
	if (argc != 3)
		return 2;
	unsigned seed = (unsigned)strtoul(argv[2], NULL, 10);
	struct joint s = joint_system(seed);
	snprintf(name, sizeof name, "%s%u", argv[1], seed);
	print_joint(stdout, name, &s);
	return 0;
}
