/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The closed-form solution as CSV: every value is its own residue sum, correctly rounded; nothing is stepped. */
#include "report/report.h"

#include <math.h>

static void check_outputs(const struct model *model)
{
	if (model->system.inputs)
		error(model->asked.end_at, "plrun MODEL.spec --input FILE.csv runs it by recorded samples",
		      "--solution needs a model without inputs: their samples are not known");
	for (int j = 0; j < model->outputs; j++)
		if (!model->output[j].form && model->output[j].value)
			error(model->output[j].value->start,
			      "--solution prints outputs that are linear in states and loads",
			      "output '%s' has no closed form", model->output[j].name);
}

static unsigned long last_step(const struct model *model, mpq_srcptr end)
{
	mpq_t steps;
	mpz_t last;
	mpq_init(steps);
	mpz_init(last);
	mpq_div(steps, end, model->h);
	mpz_fdiv_q(last, mpq_numref(steps), mpq_denref(steps));
	if (mpz_cmp_ui(last, LIMIT_ROWS) >= 0)
		error(model->asked.end_at, NULL, "--solution would print more rows than the limit of %d", LIMIT_ROWS);
	unsigned long rows = mpz_get_ui(last);
	mpq_clear(steps);
	mpz_clear(last);
	return rows;
}

struct closed_form {                /* of one output */
	int count;
	struct started *list;
};

/* What a step finds has no formula. */
static void check_peaks_of(const struct model *model)
{
	for (int i = 0; i < model->outputs; i++)
		if (model->output[i].peak)
			error(model->output[i].value->start, "a step finds it", "the peak of '%s' has no closed form",
			      model->output[i].name);
}

void print_solution(FILE *to, const struct model *model, struct resolvent *written, mpq_srcptr end)
{
	check_outputs(model);
	check_peaks_of(model);
	check_pole_size(model, written);
	unsigned long last = last_step(model, end);
	struct closed_form *form = ARRAY(struct closed_form, (size_t)model->outputs);
	fputc('t', to);
	for (int j = 0; j < model->outputs; j++) {
		form[j].count = responses_of_output(written, &model->system, (const mpq_t *)model->initial,
						    &model->output[j], &form[j].list);
		fprintf(to, ",%s", model->output[j].name);
	}
	fputc('\n', to);
	mpq_t t;
	mpq_init(t);
	for (unsigned long k = 0; k <= last; k++) {
		progress("row", (int)k, (int)last);
		fprintf(to, "%.17g", nearest_double(t));
		for (int j = 0; j < model->outputs; j++) {
			struct coefficient value = started_value(form[j].count, form[j].list, t, false,
								 model->asked.step_at, model->output[j].name);
			if (!isfinite(value.value))
				error(model->asked.end_at, NULL, "output '%s' leaves the range of double at t = %s s",
				      model->output[j].name, readable_text(t));
			fprintf(to, ",%.17g", value.value);
		}
		fputc('\n', to);
		mpq_add(t, t, model->h);
	}
	progress_end();
	mpq_clear(t);
}
