/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of steps in normal modes: modes, operators, which way a step goes, what was found of its stability. */
#include "model/reads.h"
#include "report/report.h"
#include "step/exponential/normal.h"
#include "step/exponential/weights.h"

static const char *operators_of_modes(const struct step *step)
{
	const struct model *model = step->model;
	const char *first = model->schedule.operator[0].text,
		   *last = model->schedule.operator[model->schedule.operators - 1].text;
	if (!*first)
		return "that of the linear terms with constant coefficients";
	if (model->schedule.operators == 1)
		return format("that of the Jacobian at %s", first);
	return format("those of the Jacobian at %s to %s, %d operators", first, last, model->schedule.operators);
}

static const char *exact_in_modes(const struct step *step)
{
	return step->model->remainder.split->forcings
		       ? "what each mode does by itself, and under loads e^{a t} cos(w t + p)"
		       : "what each mode does by itself";
}

static const char *course_of_modes(const struct step *step)
{
	const struct normal *m = step->normal;
	if (m->multistep.points == 0)
		return format("collocation at %d Lobatto nodes, %d sweeps; where it starts anew %d",
			      m->collocation.stages + 1, m->collocation.sweeps, m->collocation.first_sweeps);
	return format("predict from %d past forces, evaluate, correct%s; the first %d steps by collocation at %d "
		      "Lobatto nodes",
		      m->multistep.points, m->multistep.twice ? ", evaluate (PECE)" : " (PEC)", m->multistep.points - 1,
		      m->collocation.stages + 1);
}

static const char *stability_of_modes(const struct step *step)
{
	const struct stability *s = &step->normal->stability;
	bool inside = s->radius < 1;
	return format("functions of time frozen%s, the spectral radius of a step is at most 1 %c %.2g, at t = %.4g s; "
		      "all steps up to t = %.4g s let nothing grow by more than %.3g",
		      step->model->remainder.split->rests ? " and what is not linear left out" : "", inside ? '-' : '+',
		      inside ? 1 - s->radius : s->radius - 1, s->time, s->span, s->growth_factor);
}

static int numbers_of_modes(const struct step *step)
{
	const struct normal *m = step->normal;
	int n = m->modes, width = m->width;
	int forcings = 4 * step->model->remainder.split->forcings;
	int multistep = m->multistep.points ? (4 + 2 * m->multistep.points + 2 + forcings) * width : 0;
	int collocation = m->collocation.stages * (4 + 2 * (m->collocation.stages + 1) + forcings) * width;
	int forces = 0;
	for (int f = 0; f < step->model->remainder.split->functions; f++)
		forces += m->force[f] ? width : 0;
	return (m->operators - 1) * width * width +
	       m->operators * (2 * n * n + m->matrices * n * n + forces + multistep + collocation) +
	       (m->steady.flow ? steady_size(step->model) * 2 * width : 0);
}

void text_normal(FILE *to, const struct step *step)
{
	const struct model *model = step->model;
	fprintf(to, "Normal modes of M q'' + C q' + K q = 0, K and C symmetric: %s.\n", operators_of_modes(step));
	fprintf(to, "Exact: %s; approximated, by polynomials in time: all %s forces on the modes.\n",
		exact_in_modes(step), model->remainder.split->forcings ? "other" : "these");
	fprintf(to, "Step: %s.\nStability: %s.\n", course_of_modes(step), stability_of_modes(step));
	fprintf(to, "Tables: at most %d numbers, of which a step reads those of one operator.\n",
		numbers_of_modes(step));
	if (model->system.segments > 1 && !step->event_split)
		fprintf(to, "Where functions of time change their formula, the method starts anew%s.\n",
			step->normal->steady.flow ? "; after the last change steps are exact" : "");
}

/* Of the first operator and the last */
void text_frequencies(FILE *to, const struct step *step)
{
	const struct normal *m = step->normal;
	for (int b = 0; b < m->operators; b += m->operators > 1 ? m->operators - 1 : 1) {
		fprintf(to, "    modes%s%s, [Hz], and damping ratio:\n", m->operators > 1 ? " at " : "",
			m->operators > 1 ? step->model->schedule.operator[b].text : "");
		for (int j = 0; j < m->modes; j++)
			fprintf(to, "    %-24.8g %.8g\n", m->frequency[b * m->modes + j] / 6.283185307179586,
				m->ratio[b * m->modes + j]);
	}
}

void json_normal(FILE *to, const struct step *step)
{
	const struct normal *m = step->normal;
	fprintf(to, "  \"normal_modes\": {\"count\": %d, \"operators\": [", m->modes);
	for (int b = 0; b < m->operators; b++) {
		fprintf(to, "%s\n    {\"at\": \"%s\", \"hertz\": [", b ? "," : "",
			step->model->schedule.operator[b].text);
		for (int j = 0; j < m->modes; j++)
			fprintf(to, "%s%.17g", j ? ", " : "", m->frequency[b * m->modes + j] / 6.283185307179586);
		fputs("], \"damping_ratio\": [", to);
		for (int j = 0; j < m->modes; j++)
			fprintf(to, "%s%.17g", j ? ", " : "", m->ratio[b * m->modes + j]);
		fputs("]}", to);
	}
	fprintf(to, "],\n    \"points\": %d, \"stages\": %d, \"sweeps\": %d, \"twice\": %s,\n", m->multistep.points,
		m->collocation.stages, m->collocation.sweeps, m->multistep.twice ? "true" : "false");
	fprintf(to, "    \"radius\": %.17g, \"radius_at\": %.17g, \"growth\": %.17g,\n", m->stability.radius,
		m->stability.time, m->stability.growth);
	fprintf(to, "    \"numbers\": %d, \"settles\": %s},\n", numbers_of_modes(step),
		m->steady.flow ? "true" : "false");
}

/* ---- the program ---- */

static const char *factor_text(const struct step *step, int function, const double *factor)
{
	const struct normal *m = step->normal;
	const char *text = function ? form_text(step->model, step->model->remainder.split->function[function].form)
				    : "1";
	if (m->operators > 1 && factor[0] != factor[m->operators - 1])
		return format("(%s to %s) %s", shortest(factor[0]), shortest(factor[m->operators - 1]), text);
	return factor[0] == 1 ? text : format("%s (%s)", shortest(factor[0]), text);
}

void program_normal(FILE *to, const struct step *step)
{
	const struct normal *m = step->normal;
	fprintf(to, "Modes: %s; in %d block%s\n", operators_of_modes(step), m->blocks, m->blocks > 1 ? "s" : "");
	fprintf(to, "Forces on the modes, V^T (...):\n");
	for (int k = 0; k < m->matrices; k++) {
		fprintf(to, "    matrix %d times", k + 1);
		for (int t = 0; t < m->matrix[k].terms; t++)
			fprintf(to, "%s %s %s", t ? " +" : "",
				factor_text(step, m->matrix[k].term[t].function, m->matrix[k].term[t].factor),
				m->matrix[k].term[t].velocity ? "eta'" : "eta");
		fputc('\n', to);
	}
	for (int f = 0; f < step->model->remainder.split->functions; f++)
		if (m->force[f])
			fprintf(to, "    %s times a vector\n",
				f ? form_text(step->model, step->model->remainder.split->function[f].form) : "1");
	for (int k = 0; k < step->model->remainder.split->forcings; k++)
		for (int d = 0; d <= oscillates(step->model->remainder.split->forcing[k].forcing); d++)
			fprintf(to, "    %s times a vector, exact\n",
				form_text(step->model,
					  form_unit((struct basis){ .kind = BASIS_FORCING,
								    .forcing =
								    step->model->remainder.split->forcing[k].forcing,
								    .sine = d })));
	fprintf(to, "Step: %s\n", course_of_modes(step));
	if (m->steady.flow)
		fputs("Once nothing changes: [omega eta, eta'] <- matrix [omega eta, eta', 1, waves]\n", to);
}
