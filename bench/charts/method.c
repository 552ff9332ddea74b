/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The methods that are not ours, by name; and what most runs answer. */
#include <string.h>

#include "charts.h"

static const struct method *find_among(const struct method *const *methods, const char *name)
{
	for (; *methods; methods++)
		if (strcmp((*methods)->name, name) == 0)
			return *methods;
	return NULL;
}

const struct method *method_find(const char *name)
{
	const struct method *const *const lists[] = {fixed_methods, inlined_methods, structural_methods,
	                                             structural_others, adaptive_methods,
	                                             clearance_methods, propagator_methods};
	const struct method *found = NULL;
	for (int i = 0; i < (int)(sizeof lists / sizeof *lists) && !found; i++)
		found = find_among(lists[i], name);
	return found;
}

void run_get(const struct run *run, double *y)
{
	memcpy(y, run->now, 2 * (size_t)run->problem->n * sizeof *y);
}

long run_evaluations(const struct run *run)
{
	return run->asked;
}
