/* SPDX-License-Identifier: GPL-3.0-or-later */
/* output NAME = peak(x): a step looks for larger values inside, before it moves the state. */
#include "inner.h"
#include "emit/declarations.h"
#include "emit/steps.h"
#include "step/linear/rows.h"

static const char **peak_names(const struct emitter *e)
{
	const char **name = ARRAY(const char *, (size_t)e->model->outputs);
	for (int i = 0; i < e->model->outputs; i++)
		if (e->model->output[i].peak)
			name[peak_place(e->model, &e->model->output[i])] = e->model->output[i].name;
	return name;
}

/* ---- numbers ---- */

static void emit_rows(const struct emitter *e, const char *name, const char *what, const double *value)
{
	const int size[] = { peak_outputs(e->model), e->step->layout.size };
	emit_array(e, what, name, 2, size, value, peak_names(e));
}

/* Instances of a batch have that of what they share in one number. */
static bool has_reach(const struct emitter *e)
{
	return e->model->request.many.batch && !e->step->no.lanes && e->step->layout.size > e->system->states;
}

void emit_nominal_peaks(const struct emitter *e)
{
	const int size = e->step->layout.size, peaks = has_peak_rows(e) ? peak_outputs(e->model) : 0;
	if (peaks == 0)
		return;
	open_member(e, "double", "slope", format("[%d][%d]", size, size),
		    "x' = slope x, x = the states and what acts on them");
	emit_number_rows(e, size, size, slopes_of(e->step, 0), layout_names(&e->step->layout, e->system, e->model));
	close_member(e);
	open_member(e, "double", "bend", format("[%d][%d]", peaks, size),
		    "bend |x| bounds how far a peak's output is off its chord in a step");
	emit_number_rows(e, peaks, size, peaks_of(e->step).bend, peak_names(e));
	close_member(e);
	if (!has_reach(e))
		return;
	open_member(e, "double", "reach", format("[%d]", peaks),
		    "so many times as with the spec's values what acts on the states bends it");
	for (int i = 0; i < peaks; i++)
		say(e, i ? ", 1.0" : "    1.0");
	say(e, "\n");
	close_member(e);
}

/* Is there one whose row no param changes? */
static bool any_fixed(const struct emitter *e)
{
	bool any = false;
	for (int i = 0; i < e->model->outputs; i++)
		any = any || (e->model->output[i].peak && !is_tuned_output(e, &e->model->output[i]));
	return any;
}

/* Of peak p, in coefficients c where params change it */
static const char *peak_row_text(const struct emitter *e)
{
	const char *text = any_fixed(e) ? spell(e, "$n_peak_row[p]") : NULL;
	for (int i = 0; i < e->model->outputs; i++) {
		const struct output *output = &e->model->output[i];
		const char *row = output->peak && is_tuned_output(e, output)
				? format("(c)->%s", tuned_output_row(e, output)) : NULL;
		if (row)
			text = text ? format("((p) == %d ? %s : %s)", peak_place(e->model, output), row, text) : row;
	}
	return text;
}

static void emit_peak_places(const struct emitter *e)
{
	int *output = ARRAY(int, (size_t)e->model->outputs);
	for (int i = 0; i < e->model->outputs; i++)
		if (e->model->output[i].peak)
			output[peak_place(e->model, &e->model->output[i])] = i;
	emit_int_list(e, "peak_output", peak_outputs(e->model), output);
}

static void emit_include(const struct emitter *e)
{
	bool own = e->step->is.tuned;
	emit_sizes(e, "peaks.h", { "STATES", e->system->states }, { "INPUTS", given_inputs(e) },
		   { "OUTPUTS", e->model->outputs },
		   { "SIZE", e->step->layout.size }, { "PEAKS", peak_outputs(e->model) }, { "OWN", own },
		   { "REACHES", has_reach(e) }, { "BY_VALUES", 0 }, { "RAMPS", e->ramps },
		   { "DERIVATIVES", e->step->derivatives ? e->step->derivatives->columns : 0 });
	say_macro(e, "SLOPE", own ? "s->coeffs.slope" : spell(e, "$n_slope"));
	say_macro(e, "BEND", own ? "s->coeffs.bend" : spell(e, "$n_peak_bend"));
	say_macro(e, "PEAK_ROW(c, p)", peak_row_text(e));
	say(e, "#include \"peaks.h\"\n");
}

void emit_peak_tables(const struct emitter *e)
{
	if (!has_peak_rows(e))
		return;
	struct peaks peaks = peaks_of(e->step);
	if (any_fixed(e))
		emit_rows(e, "peak_row", "Outputs over x: the states and what acts on them", peaks.row);
	if (!e->step->is.tuned) {
		emit_series_slopes(e);
		emit_rows(e, "peak_bend", "How far they are off their chords in a step at most, by |x|", peaks.bend);
	}
	emit_peak_places(e);
	emit_include(e);
}

/* Behind the step and what outputs are now */
static void emit_values(const struct emitter *e)
{
	emit_peak_places(e);
	emit_sizes(e, "peaks.h", { "STATES", e->system->states }, { "INPUTS", given_inputs(e) },
		   { "OUTPUTS", e->model->outputs },
		   { "PEAKS", peak_outputs(e->model) }, { "BY_VALUES", 1 }, { "RAMPS", e->ramps },
		   { "DERIVATIVES", e->step->derivatives ? e->step->derivatives->columns : 0 });
	say_include(e, "peaks.h");
}

/* ---- in the state ---- */

void emit_peak_members(const struct emitter *e)
{
	const int peaks = peak_outputs(e->model);
	if (has_peaks(e))
		say(e, "    double peak[%d];       /* the largest sizes so far */\n", peaks);
	if (peaks_by_values(e->step))
		say(e, "    double rise[%d];       /* of these outputs in the last step */\n", peaks);
}

void emit_peak_step(const struct emitter *e)
{
	if (peaks_by_values(e->step)) {
		emit_values(e);
		return;
	}
	if (!has_peaks(e))
		return;
	open_function(e, "x at the start of a step",
		      "static void $n_begin_step(const $n *s, const double *u, double x[%d])", e->step->layout.size);
	emit_series_vector(e, false);
	close_function(e, "u");
}
