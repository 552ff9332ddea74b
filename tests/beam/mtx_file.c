/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mtx_file.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char path[4096];

_Noreturn static void bail_out(const char *why)
{
	printf("Bail out! %s: %s\n", path, why);
	exit(1);
}

static const char *line(FILE *file, char text[256])
{
	do
		if (!fgets(text, 256, file))
			bail_out("ends too early");
	while (text[0] == '%' && text[1] != '%');
	return text;
}

static void array(FILE *file, gsl_matrix *m)
{
	char text[256];
	for (size_t j = 0; j < m->size2; j++)
		for (size_t i = 0; i < m->size1; i++)
			gsl_matrix_set(m, i, j, strtod(line(file, text), NULL));
}

static void coordinates(FILE *file, gsl_matrix *m, size_t entries, bool symmetric)
{
	char text[256];
	while (entries-- > 0) {
		size_t i, j;
		double value;
				if (sscanf(line(file, text), "%zu %zu %lf", &i, &j, &value) != 3 || i < 1 || j < 1 ||
						i > m->size1 ||
					j > m->size2)
					bail_out("not an entry");
		gsl_matrix_set(m, i - 1, j - 1, value);
		if (symmetric)
			gsl_matrix_set(m, j - 1, i - 1, value);
	}
}

gsl_matrix *mtx_file(const char *prefix, const char *name)
{
	char text[256];
	size_t rows, columns, entries = 0;
	snprintf(path, sizeof path, "%s%s.mtx", prefix, name);
	FILE *file = fopen(path, "r");
	if (!file)
		bail_out("cannot be read");
	line(file, text);
	const bool dense = strstr(text, "array"), symmetric = strstr(text, "symmetric");
	if (sscanf(line(file, text), "%zu %zu %zu", &rows, &columns, &entries) != (dense ? 2 : 3))
		bail_out("no sizes");
	gsl_matrix *m = gsl_matrix_calloc(rows, columns);
	if (dense)
		array(file, m);
	else
		coordinates(file, m, entries, symmetric);
	if (fgets(text, sizeof text, file))
		bail_out("goes on after its last entry");
	fclose(file);
	return m;
}
