/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A matrix of a step as C: its entries are constants in the code, zeros are left out, the state stays in registers from
 * one output to the next. Compiled as variant.sh compiles what plgen emits, and loaded. */
#include "charts.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

static void put_row(FILE *c, const struct literals *l, int i)
{
	bool any = false;
	fprintf(c, "\t\t\tconst real n%d =", i);
	for (int j = i < l->own ? 0 : l->own; j < l->size; j++) {
		const double entry = l->Phi[i * l->size + j];
		if (entry == 0)
			continue;
		if (l->single)
			fprintf(c, "%s %.9ef*z%d", any ? " +" : "", entry, j);
		else
			fprintf(c, "%s %.17e*z%d", any ? " +" : "", entry, j);
		any = true;
	}
	fputs(any ? ";\n" : " 0;\n", c);
}

static void put_code(FILE *c, const struct literals *l)
{
	fprintf(c, "typedef %s real;\nvoid advance(real *z, long units, real *rows)\n{\n",
		l->single ? "float" : "double");
	for (int i = 0; i < l->size; i++)
		fprintf(c, "\treal z%d = z[%d];\n", i, i);
	fprintf(c, "\tfor (long u = 0; u < units; u++) {\n\t\tfor (int k = 0; k < %d; k++) {\n", l->steps);
	for (int i = 0; i < l->size; i++)
		put_row(c, l, i);
	for (int i = 0; i < l->size; i++)
		fprintf(c, "\t\t\tz%d = n%d;\n", i, i);
	fputs("\t\t}\n\t\tif (rows) {\n", c);
	for (int i = 0; i < l->own; i++)
		fprintf(c, "\t\t\trows[%d] = z%d;\n", i, i);
	fprintf(c, "\t\t\trows += %d;\n\t\t}\n\t}\n", l->own);
	for (int i = 0; i < l->size; i++)
		fprintf(c, "\tz[%d] = z%d;\n", i, i);
	fputs("}\n", c);
}

static bool compile(const struct literals *l, const char *folder)
{
	const char *cc = getenv("CC");
	FILE *c = fopen(text("%s/step.c", folder), "w");
	if (!c)
		return false;
	put_code(c, l);
	if (fclose(c) != 0)
		return false;
	return system(text("%s -std=gnu11 -O2 -fPIC -shared '%s/step.c' -o '%s/step.so'", cc && *cc ? cc : "cc", folder,
	                   folder)) == 0;
}

void *literals_load(const struct literals *l)
{
	char folder[2000];
	const char *tmp = getenv("TMPDIR");
	for (int i = 0; i < l->size * l->size; i++)
		if (!isfinite(l->Phi[i]))
			return NULL;
	snprintf(folder, sizeof folder, "%s/literals.XXXXXX", tmp && *tmp ? tmp : "/tmp");
	if (!mkdtemp(folder))
		return NULL;
	void *handle = compile(l, folder) ? object_open(text("%s/step.so", folder)) : NULL;
	unlink(text("%s/step.so", folder));
	unlink(text("%s/step.c", folder));
	rmdir(folder);
	return handle;
}
