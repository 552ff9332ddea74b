/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_selftest: states in closed form, for the target to step to. A wrong constant anywhere in the step, in NAME_jump,
 * in NAME_at or in the state that NAME_init leaves shows as a deviation. Inputs follow u = 1 - t/h, which every factor
 * of a sample has a part in; held, u = 1. */
#include "emit/emit.h"

static void emit_values(const struct emitter *e, int count, const double *value)
{
	for (int i = 0; i < count; i++)
		say(e, "%s%s", i ? ", " : "", shortest(value[i]));
}

static void emit_sample(const struct emitter *e, const char *indent, const char *ramp)
{
	for (int i = 0; i < given_inputs(e); i++)
		say(e, "%su[%d] = %s;\n", indent, i, e->system->input[i].hold ? ramp : "1.0");
}

static void emit_begin(const struct emitter *e)
{
	e->kind->start(e, "s.");
	say(e, "    $n_set(&s, 0.0, start);\n");
	if (e->ramps) {
		emit_sample(e, "    ", "1.0");
		say(e, "    $n_hold(&s, u);\n");
	}
}

static void emit_replay(const struct emitter *e, const struct reference *r)
{
	say(e, "    for (i = 0; i < %d; i++) {\n"
	       "        for (; k < reference[i].steps; k++) {\n", r->rows);
	emit_sample(e, "            ", "-(double)k");
	say(e, "            $n_step(&s%s);\n", given_inputs(e) ? ", u" : "");
	if (r->crossings)
		say(e, "            worst = $n_crossed_as(&s, k, &crossed, worst);\n");
	say(e, "        }\n"
	       "        $n_get(&s, y);\n"
	       "        worst = $n_deviation(y, reference[i].y, worst);\n"
	       "    }\n");
	if (r->crossings)
		say(e, "    if (crossed != %d)\n"
		       "        worst = 1e30;\n", r->crossings);
}

static void emit_deviation(const struct emitter *e, const struct reference *r)
{
	say(e, "\n/* The largest of worst and |y - reference|, in units in the last place of the largest value that"
	       " each state takes */\n"
	       "static double $n_deviation(const double *y, const double *reference, double worst)\n"
	       "{\n"
	       "    static const double unit[$N_STATES] = {");
	emit_values(e, r->states, r->unit);
	say(e, "};\n"
	       "    int i;\n"
	       "    for (i = 0; i < $N_STATES && worst == worst; i++) {\n"
	       "        const double off = (y[i] < reference[i] ? reference[i] - y[i] : y[i] - reference[i])"
	       " / unit[i];\n"
	       "        if (!(off <= worst))\n"
	       "            worst = off;  /* not a number, too: and it stays */\n"
	       "    }\n"
	       "    return worst;\n"
	       "}\n");
}

/* Crossings listed otherwise than by their order are none of these. */
static void emit_crossings(const struct emitter *e, const struct reference *r)
{
	say(e, "\n/* The larger of worst and how far crossings of the last step, that after k others, are from those "
	       "in\n"
	       " * closed form, in what rounding makes of their times; one that is missing or more is far off */\n"
	       "static double $n_crossed_as(const $n *s, uint64_t k, int *crossed, double worst)\n"
	       "{\n"
	       "    static const struct {\n"
	       "        uint64_t step;\n"
	       "        double after, unit;\n"
	       "    } reference[%d] = {\n", r->crossings);
	for (int k = 0; k < r->crossings; k++)
		say(e, "        {%lu, %s, %s},\n", r->crossing[k].step, shortest(r->crossing[k].after),
		    shortest(r->crossing[k].unit));
	say(e, "    };\n"
	       "    pl_crossing crossing[$N_MAX_EVENTS];\n"
	       "    const int count = $n_crossings(s, crossing);\n"
	       "    int i;\n"
	       "    for (i = 0; i < count; i++) {\n"
	       "        double off;\n"
	       "        if (k == 0 && !(crossing[i].time > 0.0009765625 * $N_H))\n"
	       "            continue;  /* where the start stands is found there */\n"
	       "        if (*crossed == %d)\n"
	       "            return 1e30;\n"
	       "        off = ((double)k - (double)reference[*crossed].step) * $N_H + crossing[i].time -\n"
	       "              reference[*crossed].after;\n"
	       "        off = (off < 0.0 ? -off : off) / reference[*crossed].unit;\n"
	       "        if (!(off <= worst) && worst == worst)\n"
	       "            worst = off;\n"
	       "        ++*crossed;\n"
	       "    }\n"
	       "    return worst;\n"
	       "}\n", r->crossings);
}

static void emit_reference(const struct emitter *e, const struct reference *r)
{
	say(e, "    static const double start[$N_STATES] = {");
	emit_values(e, r->states, r->start);
	say(e, "};\n"
	       "    static const struct {\n"
	       "        uint64_t steps;\n"
	       "        double y[$N_STATES];\n"
	       "    } reference[%d] = {  /* in closed form */\n", r->rows);
	for (int k = 0; k < r->rows; k++) {
		say(e, "        {%lu, {", r->steps[k]);
		emit_values(e, r->states, r->value + k * r->states);
		say(e, "}},\n");
	}
	say(e, "    };\n");
	if (!e->step->series.emitted)
		return;
	say(e, "    static const double between[$N_STATES] = {");
	emit_values(e, r->states, r->between);
	say(e, "};  /* at h/2 */\n");
}

static void emit_jump_check(const struct emitter *e, const struct reference *r)
{
	int last = r->rows - 1;
	say(e, "    $n_set(&s, 0.0, start);\n"
	       "    $n_jump(&s, %lu);\n"
	       "    $n_get(&s, y);\n"
	       "    worst = $n_deviation(y, reference[%d].y, worst);\n", r->steps[last], last);
}

static void emit_at_check(const struct emitter *e)
{
	emit_begin(e);
	emit_sample(e, "    ", "0.0");
	say(e, "    $n_at(&s%s, 0.5 * $N_H, y);\n"
	       "    worst = $n_deviation(y, between, worst);\n", given_inputs(e) ? ", u" : "");
}

/* What a compiler makes of a copy of constants is not what it makes of loops over states: gcc 12 errs with AVX-512.
 * Neither the instance nor the values that NAME_init is held against are known to it. */
static void emit_init_check(const struct emitter *e)
{
	say(e, "    $n_init(at);\n"
	       "    $n_get(at, y);\n"
	       "    $n_set(at, 0.0, from);\n"
	       "    $n_get(at, begun);\n"
	       "    worst = $n_deviation(y, begun, worst);\n");
}

void emit_selftest(const struct emitter *e, bool jumps)
{
	const struct reference r = reference_of(e->step->shown);
	emit_deviation(e, &r);
	if (r.crossings)
		emit_crossings(e, &r);
	say(e, "\ndouble $n_selftest(void)\n"
	       "{\n");
	emit_reference(e, &r);
	say(e, "    static const double initial[$N_STATES] = {");
	emit_initial_values(e, e->model->relative ? e->model->written : e->model);
	say(e, "\n"
	       "    const double *volatile from = initial;\n"
	       "    $n s, *volatile at = &s;\n"
	       "    double y[$N_STATES], begun[$N_STATES], worst = 0.0;\n"
	       "    uint64_t k = 0;\n"
	       "    int i%s;\n", r.crossings ? ", crossed = 0" : "");
	if (given_inputs(e))
		say(e, "    double u[$N_INPUTS];\n");
	emit_begin(e);
	emit_replay(e, &r);
	if (jumps)
		emit_jump_check(e, &r);
	if (e->step->series.emitted)
		emit_at_check(e);
	emit_init_check(e);
	say(e, "    return worst;\n"
	       "}\n");
}
