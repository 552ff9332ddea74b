/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Peaks in NAME_batch: which lanes may have passed theirs inside a step, and where they have; steps of which only the
 * peaks are wanted. */
#include "emit/emit.h"

/* ---- what acts on the states, and how far it bends outputs ---- */

static const char *nominal_bend(const struct emitter *e)
{
	return e->kind->own_factors ? spell(e, "$n_nominal.bend") : spell(e, "$n_peak_bend");
}

void emit_batch_acting(const struct batch *b)
{
	const struct emitter *e = b->e;
	int size = e->step->layout.size, acting = size - e->system->states;
	if (!b->acting)
		return;
	say(e, "\n/* What acts on the states at the start of a step, then how far with the spec's values it bends\n"
	       " * outputs */\n"
	       "static void $n_share_acting(const $n *s, %sdouble *acting)\n"
	       "{\n"
	       "    double x[%d];\n"
	       "    size_t j;\n"
	       "    $n_begin_step(s, %sx);\n"
	       "    for (j = $N_STATES; j < %d; j++)\n"
	       "        acting[j - $N_STATES] = x[j];\n", e->system->inputs ? "const double *u, " : "", size,
	    e->system->inputs ? "u, " : "", size);
	for (int p = 0; p < peak_outputs(e->model); p++)
		say(e, "    acting[%d] = 0.0;\n"
		       "    for (j = $N_STATES; j < %d; j++)\n"
		       "        acting[%d] += %s[%d][j] * (x[j] < 0.0 ? -x[j] : x[j]);\n", acting + p, size, acting + p,
		    nominal_bend(e), p);
	say(e, "}\n");
}

/* How far samples no larger than `most` bend an output: by each derivative of the polynomial through them */
static const char *reach_of_samples(const struct emitter *e, int input, int place)
{
	int hold = e->system->input[input].hold;
	const char **term = ARRAY(const char *, (size_t)hold + 1), *power = "";
	for (int m = 0; m <= hold; m++) {
		const char *bend = format("%s[%d][%d]", nominal_bend(e), place, e->step->layout.input[input] + m);
		term[m] = format("%s%s", scaled(tap_reach(hold, m), bend), power);
		power = format("%s / %s", power, step_length(e));
	}
	return tree(hold + 1, term, 16);
}

void emit_batch_reach(const struct batch *b)
{
	const struct emitter *e = b->e;
	if (!b->sampled)
		return;
	say(e, "\n/* How far at most the samples of n steps bend outputs */\n"
	       "static void $n_share_reach(const $n *s, const double *u, size_t n, double *reach)\n"
	       "{\n"
	       "    double most;\n"
	       "    size_t k;\n");
	for (int p = 0; p < peak_outputs(e->model); p++)
		say(e, "    reach[%d] = 0.0;\n", p);
	for (int i = 0; i < e->system->inputs; i++) {
		say(e, "    most = 0.0;\n"
		       "    for (k = 0; k < %d; k++)\n"
		       "        most = pl_larger_size(most, s->past[%d][k]);\n"
		       "    for (k = 0; k < n; k++)\n"
		       "        most = pl_larger_size(most, u[k * $N_INPUTS + %d]);\n", e->system->input[i].hold, i, i);
		for (int p = 0; p < peak_outputs(e->model); p++)
			say(e, "    reach[%d] += most * (%s);\n", p, reach_of_samples(e, i, p));
	}
	say(e, "    (void)s;\n"
	       "}\n"
	       "\n/* What acts on the states in the steps ahead */\n"
	       "static void $n_ahead_acting(struct $n_ahead *ahead)\n"
	       "{\n"
	       "    double now[%d];\n"
	       "    size_t k;\n"
	       "    for (k = 1; k <= ahead->steps && !ahead->known; k++) {\n"
	       "        $n_share_acting(&ahead->from, ahead->u, ahead->acting[k]);\n"
	       "        $n_share_step(&ahead->from, ahead->u, now);\n"
	       "        ahead->u += $N_INPUTS;\n"
	       "    }\n"
	       "    ahead->known = 1;\n"
	       "}\n", batch_shared_rows(b));
}

/* ---- in a step ---- */

static bool reads_rows(const struct emitter *e)
{
	bool any = false;
	for (int o = 0; o < e->model->outputs; o++)
		any = any || (e->model->output[o].peak && is_tuned_output(e, &e->model->output[o]));
	return any;
}

/* One lane that may have passed its peaks inside the step: as NAME_step looks for them */
static void emit_look(const struct batch *b)
{
	const struct emitter *e = b->e;
	int size = e->step->layout.size, states = e->system->states;
	bool own = e->kind->own_factors;
	say(e, "\n/* Instance j by itself, from the states y on: larger values inside the step that ends at value */\n"
	       "static void $n_batch_look(const $n_instances *b, size_t j, const double *y, %sconst double *value,\n"
	       "    double *peak)\n"
	       "{\n"
	       "    double x[%d], work[PL_PEAK_WORK(%d)]%s;\n"
	       "    size_t i;\n", b->acting ? "const double *acting, " : "", size, size,
	    own && reads_rows(e) ? format(", row[%d]", size) : "");
	say(e, own ? "    $n one = b->shared, *s = &one;\n" : "");
	for (int k = 0; k < b->factors; k++)
		say(e, "%s    %s = b->factors[%d * b->count + j];\n", k ? "    " : "    if (b->factors) {\n    ",
		    b->factor_text[k], k);
	say(e, "%s    for (i = 0; i < %d; i++)\n"
	       "        x[i] = %s;\n", b->factors ? "    }\n" : "", size,
	    b->acting ? spell(e, "i < $N_STATES ? y[i] : acting[i - $N_STATES]") : "y[i]");
	for (int i = 0; i < states; i++)
		if (factor_of_momentum(e, i))
			say(e, "    x[%d] = y[%d] / %s;\n", i, i, factor_of_momentum(e, i));
	for (int o = 0; o < e->model->outputs; o++)
		if (e->model->output[o].peak)
			emit_peak_look(e, &e->model->output[o], format("peak[%d]", o), format("value[%d]", o));
	say(e, "    (void)b;\n"
	       "    (void)j;\n"
	       "}\n");
}

static const char *bend_over_lanes(struct batch *b, int p)
{
	const struct emitter *e = b->e;
	const char **term = ARRAY(const char *, (size_t)e->system->states + 1);
	const struct peaks peaks = peaks_of(e->step);
	int terms = 0;
	for (int i = 0; i < e->system->states; i++) {
		const char *size = format("pl_lanes_peak(pl_lanes_all(0.0), state[%d]%s%s)", i,
					  factor_of_momentum(e, i) ? " / " : "",
					  factor_of_momentum(e, i) ? factor_of_momentum(e, i) : "");
		term[terms++] = e->kind->own_factors
			? format("%s * %s", batch_factor(b, format("s->coeffs.bend[%d][%d]", p, i)), size)
			: scaled(peaks.bend[p * e->step->layout.size + i], size);
	}
	if (acts_beside_states(e) && e->kind->own_factors)
		term[terms++] = format("%s * reach[%d]", batch_factor(b, format("s->coeffs.reach[%d]", p)), p);
	else if (acts_beside_states(e))
		term[terms++] = format("reach[%d]", p);
	return tree(terms, term, 15);
}

/* Of what lanes' states and outputs are at most, in a step or in some: may values in between have passed a peak? */
void emit_lanes_may_pass(struct batch *b)
{
	const struct emitter *e = b->e;
	say(e, "\nPL_LANES_INLINE int $n_lanes_may_pass(const pl_lanes *state, %s%sconst pl_lanes *top,\n"
	       "    const pl_lanes *peak, pl_lanes *most)\n"
	       "{\n"
	       "    int any = 0;\n", b->factors ? "const pl_lanes *factor, " : "",
	    b->acting ? "const double *reach, " : "");
	for (int o = 0; o < e->model->outputs; o++)
		if (e->model->output[o].peak)
			say(e, "    most[%d] = top[%d] + (%s);  /* %s */\n"
			       "    any |= pl_lanes_above(most[%d], peak[%d]);\n", o, o,
			    bend_over_lanes(b, peak_place(e->model, &e->model->output[o])),
			    e->model->output[o].name, o, o);
		else
			say(e, "    most[%d] = peak[%d];\n", o, o);
	say(e, "    return any;\n"
	       "}\n");
}

/* Where a lane may have passed a peak, each is looked at by itself. */
void emit_lanes_look(struct batch *b)
{
	const struct emitter *e = b->e;
	int states = e->system->states, outputs = e->model->outputs;
	emit_look(b);
	say(e, "\nstatic void $n_lanes_look(const $n_instances *b, size_t j, const pl_lanes *start,\n"
	       "    %sconst pl_lanes *most, const pl_lanes *value, pl_lanes *peak)\n"
	       "{\n"
	       "    double y[%d], end[%d], largest[%d], bound;\n"
	       "    const size_t lanes = sizeof(pl_lanes) / sizeof(double);\n"
	       "    size_t l, i;\n", b->acting ? "const double *acting, " : "", states, outputs, outputs);
	say(e, "    for (l = 0; l < lanes && j + l < b->count; l++) {\n"
	       "        int any = 0;\n"
	       "        for (i = 0; i < %d; i++)\n"
	       "            memcpy(&y[i], (const char *)&start[i] + l * sizeof(double), sizeof(double));\n"
	       "        for (i = 0; i < %d; i++) {\n"
	       "            memcpy(&end[i], (const char *)&value[i] + l * sizeof(double), sizeof(double));\n"
	       "            memcpy(&largest[i], (const char *)&peak[i] + l * sizeof(double), sizeof(double));\n"
	       "            memcpy(&bound, (const char *)&most[i] + l * sizeof(double), sizeof(double));\n"
	       "            any |= !(bound <= largest[i]);\n"
	       "        }\n"
	       "        if (any)\n"
	       "            $n_batch_look(b, j + l, y, %send, largest);\n"
	       "        for (i = 0; i < %d; i++)\n"
	       "            memcpy((char *)&peak[i] + l * sizeof(double), &largest[i], sizeof(double));\n"
	       "    }\n"
	       "}\n", states, outputs, b->acting ? "acting, " : "", outputs);
}

/* Peaks of which values inside the step may pass are looked for. */
static void say_look(const struct batch *b)
{
	const struct emitter *e = b->e;
	for (int o = 0; o < e->model->outputs; o++)
		if (e->model->output[o].peak)
			say(e, "    top[%d] = pl_lanes_peak(pl_lanes_peak(pl_lanes_all(0.0), before[%d]), "
			       "value[%d]);\n", o, o, o);
		else
			say(e, "    top[%d] = peak[%d];\n", o, o);
	say(e, "    if ($n_lanes_may_pass(start, %s%stop, peak, most)) {\n"
	       "        const pl_lanes from[$N_STATES] = {", b->factors ? "factor, " : "",
	    b->acting ? format("acting + %d, ", e->step->layout.size - e->system->states) : "");
	for (int i = 0; i < e->system->states; i++)
		say(e, "%sstart[%d]", i ? ", " : "", i);
	say(e, "};  /* these are in memory here only */\n"
	       "        pl_lanes to[$N_OUTPUTS], bound[$N_OUTPUTS], largest[$N_OUTPUTS];\n"
	       "        memcpy(to, value, sizeof to);\n"
	       "        memcpy(bound, most, sizeof bound);\n"
	       "        memcpy(largest, peak, sizeof largest);\n"
	       "        $n_lanes_look(b, j, from, %sbound, to, largest);\n"
	       "        memcpy(peak, largest, sizeof largest);\n"
	       "    }\n", b->acting ? "acting, " : "");
}

/* Outputs of a step's end into peak and out, where they are wanted */
void emit_lanes_tell(struct batch *b)
{
	const struct emitter *e = b->e;
	bool peaks = has_peaks(e);
	say(e, "\nPL_LANES_INLINE void $n_lanes_tell(const $n_instances *b, size_t j,\n"
	       "    %sconst pl_lanes *y,%s const double *now, %s%spl_lanes *peak, double *out)\n"
	       "{\n"
	       "    pl_lanes value[$N_OUTPUTS];\n"
	       "%s"
	       "    $n_lanes_out(y, %snow, value);\n", peaks ? "const pl_lanes *start, " : "",
	    b->factors ? " const pl_lanes *factor," : "", b->acting ? "const double *acting, " : "",
	    peaks ? "pl_lanes *before, " : "",
	    peaks ? spell(e, "    pl_lanes top[$N_OUTPUTS], most[$N_OUTPUTS];  /* at its ends, in it */\n") : "",
	    b->factors ? "factor, " : "");
	if (peaks)
		say_look(b);
	for (int o = 0; o < e->model->outputs; o++) {
		say(e, "    peak[%d] = pl_lanes_peak(peak[%d], value[%d]);\n", o, o, o);
		if (e->model->output[o].peak)
			say(e, "    before[%d] = value[%d];\n"
			       "    value[%d] = peak[%d];\n", o, o, o, o);
	}
	say(e, "    if (out && j < b->count) {\n");
	for (int o = 0; o < e->model->outputs; o++)
		say(e, "        pl_lanes_store(out + %d * b->count + j, value[%d], b->count - j);\n", o, o);
	say(e, "    }\n"
	       "}\n");
}

/* ---- steps of which only the peaks are wanted: mostly clear by what states and outputs are at most ---- */

/* Of these, what lanes have before the first step, and after each */
void emit_lanes_widen(const struct batch *b)
{
	const struct emitter *e = b->e;
	int states = e->system->states, outputs = e->model->outputs;
	const char *own = b->factors ? "const pl_lanes *factor, " : "", *given = b->factors ? "factor, " : "";
	say(e, "\n/* The largest |state| and |output| so far */\n"
	       "PL_LANES_INLINE void $n_lanes_first(const pl_lanes *y, %sconst double *now, pl_lanes *state,\n"
	       "    pl_lanes *top)\n"
	       "{\n"
	       "    $n_lanes_out(y, %snow, top);\n", own, given);
	for (int i = 0; i < states; i++)
		say(e, "    state[%d] = pl_lanes_peak(pl_lanes_all(0.0), y[%d]);\n", i, i);
	for (int o = 0; o < outputs; o++)
		say(e, e->model->output[o].peak ? "    top[%d] = pl_lanes_peak(pl_lanes_all(0.0), top[%d]);\n"
						: "    top[%d] = pl_lanes_all(0.0);\n", o, o);
	say(e, "}\n"
	       "\nPL_LANES_INLINE void $n_lanes_widen(const pl_lanes *y, %sconst double *now, pl_lanes *state,\n"
	       "    pl_lanes *top)\n"
	       "{\n"
	       "    pl_lanes value[$N_OUTPUTS];\n"
	       "    $n_lanes_out(y, %snow, value);\n", own, given);
	for (int i = 0; i < states; i++)
		say(e, "    state[%d] = pl_lanes_peak(state[%d], y[%d]);\n", i, i, i);
	for (int o = 0; o < outputs; o++)
		say(e, "    top[%d] = pl_lanes_peak(top[%d], value[%d]);\n", o, o, o);
	say(e, "}\n");
}

/* The peaks at ends of steps are known before extremes are looked for: few are larger. */
void emit_lanes_end(const struct batch *b)
{
	const struct emitter *e = b->e;
	int outputs = e->model->outputs;
	say(e, "\n/* After these steps: where there may be more in between they are taken again, one by one. */\n"
	       "PL_LANES_INLINE void $n_lanes_end($n_instances *b, size_t j, %sstruct $n_ahead *ahead,\n"
	       "    const pl_lanes *y, %sconst pl_lanes *state, const pl_lanes *top, pl_lanes *peak)\n"
	       "{\n"
	       "    pl_lanes most[$N_OUTPUTS];\n", b->sampled ? "" : "const ",
	    b->factors ? "const pl_lanes *factor, " : "");
	for (int o = 0; o < outputs; o++)
		say(e, "    peak[%d] = pl_lanes_peak(peak[%d], top[%d]);\n", o, o, o);
	say(e, "    if (!b->peak || !$n_lanes_may_pass(state, %s%stop, peak, most)) {\n"
	       "        $n_lanes_give(b, j, y, peak);\n"
	       "        return;\n"
	       "    }\n", b->factors ? "factor, " : "", b->acting ? "ahead->reach, " : "");
	for (int o = 0; o < outputs; o++)
		say(e, "    pl_lanes_store(b->peak + %d * b->count + j, peak[%d], b->count - j);\n", o, o);
	say(e, "    $n_batch_one_by_one(b, j, ahead, NULL);\n"
	       "}\n");
}
