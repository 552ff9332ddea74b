/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "variant.h"

#include <stdio.h>
#include <string.h>

const struct variant *variant_of(const struct variant *table, const char *model, const char *form)
{
	char name[200];
	snprintf(name, sizeof name, "%s_%s_0", model, form);    /* variants.sh counts the steps of a line */
	for (; table->model; table++)
		if (strcmp(table->model->name, name) == 0)
			return table;
	return NULL;
}
