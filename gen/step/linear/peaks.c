/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outputs of which the largest size is asked for: rows over x, and what of |x| bounds how far they bend in a step. */
#include "model/reads.h"
#include "step/regions/regions.h"
#include "rows.h"

int peak_outputs(const struct model *model)
{
	int count = 0;
	for (int i = 0; i < model->outputs; i++)
		count += model->output[i].peak;
	return count;
}

int peak_place(const struct model *model, const struct output *output)
{
	int place = 0;
	for (const struct output *o = model->output; o < output; o++)
		place += o->peak;
	return place;
}

/* Inside a step what outputs read of such an input is not known. */
static const struct input *smooth_input(const struct model *model, const struct output *output)
{
	const struct reads r = output->left ? reads_of(model, 1, (const struct form *const *)&output->left)
					    : (struct reads){ 0 };
	for (int i = 0; i < model->system.inputs; i++) {
		bool value = mpq_sgn(output->input[0][i]) != 0, slope = mpq_sgn(output->input[1][i]) != 0;
		if (model->system.input[i].hold > 1 && (value || slope || (r.input && r.input[i])))
			return &model->system.input[i];
	}
	return NULL;
}

static const char *objection(const struct step *step, const struct output *output)
{
	if (!step->series.emitted)
		return "the largest |pole| times h is above 8";
	const bool by_values = peaks_by_values(step) || step->model->spec->sensitivities > 0;
	const struct input *input = by_values ? smooth_input(step->model, output) : NULL;
	return input ? format("it reads %s, which goes through more than two samples", input->name) : NULL;
}

void check_peaks(const struct step *step)
{
	for (int i = 0; i < step->model->outputs; i++) {
		const struct output *output = &step->model->output[i];
		const char *why = output->peak ? objection(step, output) : NULL;
		if (why)
			error(output->value->start, NULL, "the peak of '%s' cannot be found here: %s", output->name,
			      why);
	}
}

/* [output][x], and of the bounds likewise */
struct peaks peaks_of(const struct step *step)
{
	int size = step->layout.size, count = peak_outputs(step->model), place = 0;
	struct peaks peaks = { ARRAY(double, (size_t)(count * size)), ARRAY(double, (size_t)(count * size)) };
	double *A = slopes_of(step, 0), h = round_rational(step->model->h);
	for (int i = 0; i < step->model->outputs; i++) {
		if (!step->model->output[i].peak)
			continue;
		row_over_x(step, &step->model->output[i], 0, peaks.row + place * size);
		bend_of_row(step, A, h, peaks.row + place * size, peaks.bend + place * size);
		place++;
	}
	return peaks;
}
