/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of a model that is not linear there are no poles, mode shapes, frequency responses and static gains: those of the
 * terms that happen to be linear are of another model. What they would leave out is said by name. */
#include "report/report.h"
#include "step/linear/images.h"

enum { NAMED = 12 };

bool is_nonlinear(const struct step *step)
{
	return step->shown->model->nonlinear.terms > 0;
}

/* sin(x); x'^3 */
static const char *nonlinear_text(const struct step *step)
{
	const struct model *model = step->shown->model;
	const char *text = "";
	for (int i = 0; i < model->nonlinear.terms && i < NAMED; i++)
		text = format("%s%s%s", text, i ? "; " : "", model->nonlinear.term[i].text);
	return model->nonlinear.terms <= NAMED ? text : format("%s; and %d more", text, model->nonlinear.terms - NAMED);
}

void text_nonlinear(FILE *to, const struct step *step)
{
	fprintf(to, "The model is not linear, so it has no poles, mode shapes, frequency responses and static gains. "
		    "They would leave out:\n    %s\n", nonlinear_text(step));
	if (!facts_of_model(step->shown->model).contacts)
		fputs("--at rest has those of the linear equations at an equilibrium.\n", to);
	if (can_be_swept(step))
		fputs("--response F0:F1 --amplitude A sweeps through all regions.\n", to);
}

/* What B, poles and modes of an object are of, then: the terms that are in M, C and K */
void json_nonlinear(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	fprintf(to, "  \"linear\": %s,\n  \"left_out\": [", is_nonlinear(step) ? "false" : "true");
	for (int i = 0; i < model->nonlinear.terms; i++)
		fprintf(to, "%s\"%s\"", i ? ", " : "", json_text(model->nonlinear.term[i].text));
	fputs("],\n", to);
}

const char *stability_by_poles(int count, const struct pole_report *pole)
{
	int most = -1;
	for (int i = 0; i < count; i++)
		most = mpfr_sgn(pole[i].re) > most ? mpfr_sgn(pole[i].re) : most;
	return most < 0 ? "stable" : most > 0 ? "unstable" : "marginal";
}

static const char *stability_of_step(const struct step *step)
{
	struct pole_report *pole;
	const int count = poles_of(step->model, step->written, &pole);
	return stability_by_poles(count, pole);
}

void text_point(FILE *to, const struct step *step)
{
	const char *at = step->shown->model->request.linear.found;
	if (at)
		fprintf(to, "Linear equations of the deviations from %s.\nThey are %s.\n\n", at,
			stability_of_step(step));
}

void json_point(FILE *to, const struct step *step)
{
	const char *at = step->shown->model->request.linear.found;
	if (at)
		fprintf(to, "  \"linearised\": {\"at\": \"%s\", \"stability\": \"%s\"},\n", json_text(at),
			stability_of_step(step));
}

void need_linear(const struct step *step, const char *what)
{
	const struct model *model = step->shown->model;
	if (!is_nonlinear(step))
		return;
	error(model->nonlinear.term[0].at,
	      can_be_swept(step) ? "--response and --plot frf with --amplitude A sweep through all regions"
				 : "--at rest takes the linear equations at an equilibrium",
	      "the model is not linear, so there are no %s: they would leave out '%s'%s", what,
	      model->nonlinear.term[0].text,
	      model->nonlinear.terms > 1 ? format(" and %d more", model->nonlinear.terms - 1) : "");
}
