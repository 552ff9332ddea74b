/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The texts that what is written may contain: of the runtime and of its licence. */
#include "base/base.h"

#include <string.h>

#include "runtime_texts.h"

enum { TEXTS = sizeof texts / sizeof *texts };

const char *runtime_text(const char *name)
{
	for (int i = 0; i < TEXTS; i++)
		if (strcmp(texts[i].name, name) == 0)
			return texts[i].text;
	return NULL;
}

const char *runtime_name(int file)
{
	return file < TEXTS ? texts[file].name : NULL;
}
