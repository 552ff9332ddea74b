/* SPDX-License-Identifier: GPL-3.0-or-later */
/* joint_truth SEED UNTIL: what is true of a random joint, as through.awk of tests/contacts reads it: its events, where
 * it ends. */
#include "joint.h"

#include <stdlib.h>

int main(int argc, char **argv)
{
	struct joint_state now;
	if (argc != 3)
		return 2;
	const struct joint s = joint_system((unsigned)strtoul(argv[1], NULL, 10));
	joint_start(&s, &now);
	joint_until(&s, &now, strtod(argv[2], NULL));
	for (int i = 0; i < now.events; i++)
		printf("event %.17g\n", now.time[i]);
	printf("slowest 1\nend");
	for (int i = 0; i < s.n; i++)
		printf(" %.17Lg", now.x[i]);
	for (int i = 0; i < s.sliders; i++)
		printf(" %.17Lg", now.z[i]);
	for (int i = 0; i < s.n; i++)
		printf(" %.17Lg", now.v[i]);
	printf("\n");
	return 0;
}
