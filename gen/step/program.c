/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The program of a step. */
#include "step/step.h"

enum step_kind kind_of_step(const struct model *model)
{
	if (model->switching)
		return KIND_REGIONS;
	if (model->tuning)
		return KIND_TUNED;
	return model->channels > 0 ? KIND_LEFTOVER : KIND_LINEAR;
}

bool has_leftover(const struct step *step)
{
	return step->kind == KIND_LEFTOVER;
}

void need_closed_form(const struct step *step)
{
	static const char *const of_kind[KINDS] = {
		[KIND_REGIONS] = "where it crosses a breakpoint is found by a search",
		[KIND_LEFTOVER] = "what is left over has no closed form"
	};
	const char *why = of_kind[step->kind];
	if (!why && step->model->scheme != SCHEME_EXACT)
		why = format("scheme %s approximates", scheme_name(step->model->scheme));
	if (why)
		error((struct place){ source_argument("--selftest"), 0 }, NULL,
		      "--selftest needs a linear model and scheme exact: %s", why);
}
