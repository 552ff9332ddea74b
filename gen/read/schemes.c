/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The schemes and the forms of a step, by name. */
#include "read/read.h"

#include <string.h>

static const char *const schemes[SCHEMES] = { "exact", "pl", "etd1", "etdrk2", "etdrk4", "nc2", "nc3", "dq4", "bm3" };

const char *scheme_name(enum scheme scheme)
{
	return schemes[scheme];
}

static const char *const names[STEP_FORMS] = { "auto", "direct", "delta", "kick-drift-kick" };

bool scheme_of(const char *name, enum scheme *scheme)
{
	for (int i = 0; i < SCHEMES; i++)
		if (strcmp(name, schemes[i]) == 0) {
			*scheme = (enum scheme)i;
			return true;
		}
	return false;
}

const char *nearest_scheme(const char *name)
{
	return nearest_name(name, SCHEMES, schemes);
}

const char *step_form_name(enum step_form form)
{
	return names[form];
}

bool step_form_of(const char *name, enum step_form *form)
{
	for (int i = 0; i < STEP_FORMS; i++)
		if (strcmp(name, names[i]) == 0) {
			*form = (enum step_form)i;
			return true;
		}
	return false;
}
