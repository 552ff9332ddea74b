/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The program of a step. */
#include "step/step.h"

bool has_leftover(const struct step *step)
{
	return step->program->actions > 0;
}

void need_closed_form(const struct step *step)
{
	const struct model *model = step->model;
	const char *why = model->switching ? "where it crosses a breakpoint is found by a search" : has_leftover(step) ? "what is left over has no closed form"
		: model->scheme != SCHEME_EXACT ? format("scheme %s approximates", scheme_name(model->scheme)) : NULL;
	if (why)
		error((struct place){ source_argument("--selftest"), 0 }, NULL, "--selftest needs a linear model and scheme exact: %s", why);
}
