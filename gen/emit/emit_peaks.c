/* SPDX-License-Identifier: GPL-3.0-or-later */
/* output NAME = peak(x): a step looks for larger values inside, before it moves the state. */
#include "emit/emit.h"

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
	int count = peak_outputs(e->model), size = e->step->layout.size;
	say(e, "\nstatic const double $n_%s[%d][%d] = {  /* %s */\n", name, count, size, what);
	emit_number_rows(e, count, size, value, peak_names(e));
	say(e, "};\n");
}

/* Instances of a batch have that of what they share in one number. */
static bool has_reach(const struct emitter *e)
{
	return e->model->asked.batch && e->step->layout.size > e->system->states;
}

void emit_peak_coefficients(const struct emitter *e)
{
	int size = e->step->layout.size;
	if (!has_peaks(e))
		return;
	say(e, "    double slope[%d][%d];  /* x' = slope x, x = the states and what acts on them */\n"
	       "    double bend[%d][%d];   /* bend |x| bounds how far a peak's output is off its chord in a step */\n",
	    size, size, peak_outputs(e->model), size);
	if (has_reach(e))
		say(e, "    double reach[%d];      /* so many times as with the spec's values what acts on the states "
		       "bends it */\n", peak_outputs(e->model));
}

void emit_nominal_peaks(const struct emitter *e)
{
	if (!has_peaks(e))
		return;
	say(e, "    {\n");
	emit_number_rows(e, e->step->layout.size, e->step->layout.size, slopes_of(e->step, 0),
			 layout_names(&e->step->layout, e->system, e->model));
	say(e, "    },\n"
	       "    {\n");
	emit_number_rows(e, peak_outputs(e->model), e->step->layout.size, peaks_of(e->step).bend, peak_names(e));
	say(e, "    },\n");
	for (int i = 0; i < peak_outputs(e->model) && has_reach(e); i++)
		say(e, i ? ", 1.0" : "    {1.0");
	if (has_reach(e))
		say(e, "},\n");
}

/* row[...] = the output over x: of tunable outputs from the instance's factors */
static void emit_row_of(const struct emitter *e, const struct output *output, const char *coeffs, const char *indent)
{
	int size = e->step->layout.size, place = peak_place(e->model, output);
	if (is_tuned_output(e, output))
		say(e, "%sfor (i = 0; i < %d; i++)\n"
		       "%s    row[i] = %s%s[i];\n", indent, size, indent, coeffs,
		    tuned_output_row(e, output));
	else
		say(e, "%sfor (i = 0; i < %d; i++)\n"
		       "%s    row[i] = $n_peak_row[%d][i];\n", indent, size, indent, place);
}

void emit_retune_peaks(const struct emitter *e)
{
	int size = e->step->layout.size;
	if (!has_peaks(e))
		return;
	say(e, "    for (i = 0; i < %d; i++)\n"
	       "        for (j = 0; j < %d; j++)\n"
	       "            c->slope[i][j] = A[i][j].hi;\n"
	       "    {\n"
	       "        double row[%d], space[PL_PEAK_WORK(%d)];\n", size, size, size, size);
	for (int i = 0; i < e->model->outputs; i++) {
		const struct output *output = &e->model->output[i];
		if (!output->peak)
			continue;
		emit_row_of(e, output, "c->", "        ");
		int place = peak_place(e->model, output);
		say(e, "        pl_peak_bend(%d, c->slope[0], row, h, c->bend[%d], space);\n", size, place);
		if (has_reach(e))
			say(e, "        c->reach[%d] = 0.0;\n"
			       "        for (i = $N_STATES; i < %d; i++)\n"
			       "            if (c->bend[%d][i] > c->reach[%d] * $n_nominal.bend[%d][i])\n"
			       "                c->reach[%d] = c->bend[%d][i] / $n_nominal.bend[%d][i];\n",
			    place, size, place, place, place, place, place, place);
	}
	say(e, "    }\n");
}

/* Is there one whose row no param changes? */
static bool any_fixed(const struct emitter *e)
{
	bool any = false;
	for (int i = 0; i < e->model->outputs; i++)
		any = any || (e->model->output[i].peak && !is_tuned_output(e, &e->model->output[i]));
	return any;
}

void emit_peak_tables(const struct emitter *e)
{
	if (!has_peaks(e))
		return;
	struct peaks peaks = peaks_of(e->step);
	if (any_fixed(e))
		emit_rows(e, "peak_row", "over x: the states and what acts on them", peaks.row);
	if (e->kind->own_factors)
		return;
	emit_series_slopes(e);
	emit_rows(e, "peak_bend", "of |x|: how far at most off the chord in a step", peaks.bend);
}

/* ---- in the state ---- */

void emit_peak_members(const struct emitter *e)
{
	if (has_peaks(e))
		say(e, "    double peak[%d];       /* the largest sizes so far */\n", peak_outputs(e->model));
}

void emit_peak_set(const struct emitter *e)
{
	for (int i = 0; i < peak_outputs(e->model); i++)
		say(e, "    s->peak[%d] = 0.0;\n", i);
}

/* ---- the step ---- */

void emit_peak_look(const struct emitter *e, const struct output *output, const char *peak, const char *end)
{
	bool own = e->kind->own_factors;
	int size = e->step->layout.size, place = peak_place(e->model, output);
	const char *row = spell(e, "$n_peak_row[%d]", place);
	if (is_tuned_output(e, output)) {
		emit_row_of(e, output, "s->coeffs.", "    ");
		row = "row";
	}
	say(e, "    %s = pl_peak(%d, %s, %s, %s[%d], %s, x,\n"
	       "        %s, %s, work);  /* %s */\n", peak, size,
	    own ? "s->coeffs.slope[0]" : spell(e, "$n_slope[0]"), row,
	    own ? "s->coeffs.bend" : spell(e, "$n_peak_bend"), place, step_length(e), end, peak, output->name);
}

void emit_peak_step(const struct emitter *e)
{
	bool inputs = e->system->inputs > 0, tuned = false;
	int size = e->step->layout.size;
	if (!has_peaks(e))
		return;
	for (int i = 0; i < e->model->outputs; i++)
		tuned = tuned || (e->model->output[i].peak && is_tuned_output(e, &e->model->output[i]));
	say(e, "\n/* x at the start of a step */\n"
	       "static void $n_begin_step(const $n *s, %sdouble *x)\n"
	       "{\n", inputs ? "const double *u, " : "");
	emit_series_vector(e);
	say(e, "}\n"
	       "\nvoid $n_step(%s)\n"
	       "{\n"
	       "    double x[%d], work[PL_PEAK_WORK(%d)], now[$N_OUTPUTS]%s;\n%s", step_parameters(e), size, size,
	    tuned ? format(", row[%d]", size) : "", tuned ? "    int i;\n" : "");
	say(e, "    $n_begin_step(s, %sx);\n"
	       "    $n_move(s%s);\n"
	       "    $n_now(s, now);\n", inputs ? "u, " : "", inputs ? ", u" : "");
	for (int i = 0; i < e->model->outputs; i++)
		if (e->model->output[i].peak)
			emit_peak_look(e, &e->model->output[i],
				       format("s->peak[%d]", peak_place(e->model, &e->model->output[i])),
				       format("now[%d]", i));
	say(e, "}\n"
	       "\nvoid $n_out(const $n *s, double out[$N_OUTPUTS])\n"
	       "{\n"
	       "    $n_now(s, out);\n");
	for (int i = 0; i < e->model->outputs; i++) {
		int place = peak_place(e->model, &e->model->output[i]);
		if (e->model->output[i].peak)
			say(e, "    out[%d] = out[%d] < 0.0 ? -out[%d] : out[%d];  /* %s */\n"
			       "    out[%d] = s->peak[%d] > out[%d] ? s->peak[%d] : out[%d];\n", i, i, i, i,
			    e->model->output[i].name, i, place, i, place, i);
	}
	say(e, "}\n");
}
