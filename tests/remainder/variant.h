/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Variants of models, as variants.sh lists them. */
#ifndef VARIANT_H
#define VARIANT_H

#include "plrt.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct variant {
	const pl_model *model;
	const double *Phi;                      /* states x states */
};

/* The variant of this name; a test that asks for one that was not made cannot go on. */
#if defined __GNUC__
__attribute__((format(printf, 2, 3), unused))
#endif
static const struct variant *variant_of(const struct variant *table, const char *format, ...)
{
	char name[200];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(name, sizeof name, format, arguments);
	va_end(arguments);
	for (; table->model; table++)
		if (strcmp(table->model->name, name) == 0)
			return table;
	printf("Bail out! no variant %s\n", name);
	exit(99);
}

#endif
