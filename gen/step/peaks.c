/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outputs of which the largest size is asked for: rows over x, and what of |x| bounds how far they bend in a step. */
#include "step/step.h"

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

static const char *objection(const struct step *step, const struct output *output)
{
	if (output->left)
		return "it is not linear";
	if (step->model->switching)
		return "the model is piecewise linear";
	if (has_leftover(step))
		return "the model has a leftover";
	if (step->branch->system.segments > 1)
		return "loads change their formula inside a step";
	if (step->program->loops)
		return format("beyond %d states a step loops over its tables", LIMIT_UNROLLED_STATES);
	if (step->kind == KIND_LINEAR && !step->series.emitted)
		return "the largest |pole| times h is above 8";
	if (step->model->relative)
		return "what moves as a whole is kept as differences";
	if (step->forced)
		return "the state is kept less what loads sustain";
	return NULL;
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
