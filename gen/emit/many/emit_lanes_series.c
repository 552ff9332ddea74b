/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of a series of fixed order over lanes: the same tape as that of one instance, and series_lanes.h. */
#include "inner.h"
#include "emit/series/series.h"
#include "step/series/expansion.h"

void emit_shared_of_series(const struct batch *b)
{
	const struct emitter *e = b->e;
	open_function(e, "now receives what all instances share in this step, by samples at its start and slopes",
		      "static void $n_share_start(const $n *s, const double u[], const double slope[], double *now)");
	emit_expansion_locals(e);
	for (int i = 0; i < b->after; i++)
		say(e, "    now[%d] = %s;\n", i, b->shared_text[i]);
	close_function(e, "s u slope now");
	open_function(e, "The same; time then advances by h",
		      "static void $n_share_step($n *s, const double *u, double *now)");
	say(e, "    double start[%d], slope[%d];\n", e->system->inputs + 1, e->system->inputs + 1);
	say(e, e->system->inputs ? "    $n_inputs_now(s, u, start, slope);\n" : "    start[0] = slope[0] = 0.0;\n");
	say(e, "    $n_share_start(s, start, slope, now);\n");
	emit_step_end(e);
	close_function(e, "u");
}

static bool calls(const struct tape *t, enum tape_op op, int function)
{
	bool any = false;
	for (int i = 0; i < tape_length(t); i++)
		any = any || (tape_node(t, i)->op == op && (op != TAPE_CALL || tape_node(t, i)->index == function));
	return any;
}

static void emit_function(const struct emitter *e, const char *name, bool of_two)
{
	say(e, "\nPL_LANES_INLINE pl_lanes $n_lanes_%s(pl_lanes of%s)\n"
	       "{\n"
	       "    double x[sizeof(pl_lanes) / sizeof(double)]%s;\n"
	       "    size_t i;\n"
	       "    memcpy(x, &of, sizeof of);\n"
	       "%s"
	       "    PL_LANES_UNROLL\n"
	       "    for (i = 0; i < sizeof(pl_lanes) / sizeof(double); i++) { x[i] = %s(x[i]%s); }\n"
	       "    memcpy(&of, x, sizeof of);\n"
	       "    return of;\n"
	       "}\n", name, of_two ? ", pl_lanes second" : "", of_two ? ", y[sizeof(pl_lanes) / sizeof(double)]" : "",
	    of_two ? "    memcpy(y, &second, sizeof second);\n" : "", name, of_two ? ", y[i]" : "");
}

bool calls_functions(const struct tape *t)
{
	bool any = calls(t, TAPE_POWER, 0) || calls(t, TAPE_ATAN2, 0);
	for (int f = FN_NONE + 1; f < FN_ATAN2; f++)
		any = any || calls(t, TAPE_CALL, f);
	return any;
}

/* Functions of <math.h>, of each lane by itself: their bits are those of one instance */
static void emit_functions(const struct emitter *e, const struct tape *t)
{
	for (int f = FN_NONE + 1; f < FN_ATAN2; f++)
		if (calls(t, TAPE_CALL, f))
			emit_function(e, function_name((enum function)f), false);
	if (calls(t, TAPE_POWER, 0))
		emit_function(e, "pow", true);
	if (calls(t, TAPE_ATAN2, 0))
		emit_function(e, "atan2", true);
}

bool takes_whole_steps(const struct batch *b)
{
	const struct emitter *e = b->e;
	return e->step->no.lanes || has_regions(e) || has_peaks(e) ||
	       (has_series(e) && (b->out_alone || calls_functions(b->step) || calls_functions(b->out)));
}

int steps_of_series(const struct emitter *e)
{
	return !has_series(e) ? 0 : spans_steps(e) ? e->model->truncation.over : 1;
}

void emit_lanes_of_series(struct batch *b)
{
	const struct emitter *e = b->e;
	emit_functions(e, b->step);
	open_function(e, "The series of as many instances as there are lanes; now: what they share",
		      "PL_LANES_INLINE void $n_lanes_expand(const pl_lanes *y, const pl_lanes *factor,\n"
		      "    const double *now, pl_lanes (*c)[$N_STATES])");
	emit_over_lanes(b, b->step, 0, shared_of_series);
	close_function(e, "now factor");
	emit_lanes_total(e);
	emit_sizes(e, "series_lanes.h", { "STATES", e->system->states }, { "ORDER", own_expansion(e)->order },
		   { "OVER", steps_of_series(e) });
	say(e, "#include \"series_lanes.h\"\n");
}

void emit_kernel_of_series(struct batch *b)
{
	const struct emitter *e = b->e;
	say(e, "enum { $N_STATES = %d };\n", e->system->states);
	if (steps_of_series(e) > 1)
		emit_over_table(e);
	emit_lanes_of_series(b);
}
