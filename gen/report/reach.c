/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a series costs, and how far it reaches from the start. Estimates are given to two digits. */
#include "report/report.h"
#include "step/series/expansion.h"

#include <math.h>

void text_reach(FILE *to, const struct step *step)
{
	const struct model *model = step->model;
	const struct reach reach = reach_of_series(step);
	int over = model->truncation.over, multiplications = step->taylor.expansion->multiplications;
	int sum = model->system.states * step->taylor.expansion->order;
	fprintf(to, "A series takes %d multiplications, a value of it %d.\n", multiplications, sum);
	if (over > 1)
		fprintf(to, "One is over %d steps: %d multiplications a step.\n", over, step->program->multiplications);
	if (reach.left_out)
		return;
	if (!reach.known) {
		fputs("At the start the series cannot be made: not all of its coefficients are finite.\n", to);
		return;
	}
	if (isinf(reach.radius))
		fputs("At the start no singularity bounds its radius of convergence (estimate).\n", to);
	else
		fprintf(to, "At the start its radius of convergence is about %.2g s, %.2g steps (estimate).\n",
			reach.radius, reach.radius / mpq_get_d(model->h));
	double served = reach.served;
	if (served >= 1)
		fprintf(to, "By its tolerance one series serves about %.0f step%s there: %.0f multiplications a step "
			"(estimate).\n", served, served > 1 ? "s" : "", multiplications / served + sum);
	else if (served > 0)
		fprintf(to, "By its tolerance one series serves about 1/%.0f of a step there: %.0f multiplications a "
			"step (estimate).\n", 1 / served, (multiplications + sum) / served);
}

void json_reach(FILE *to, const struct step *step)
{
	const struct reach reach = reach_of_series(step);
	if (reach.known && isfinite(reach.radius))
		fprintf(to, "  \"radius\": %.2g,\n", reach.radius);
	else
		fputs("  \"radius\": null,\n", to);
	if (reach.served > 0)
		fprintf(to, "  \"steps_served\": %.2g,\n", reach.served);
}
