/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps by the Taylor series of the solution: its sum, how far it holds, steps as long as its last terms allow. */
#include "emit/emit.h"

#include <math.h>

enum {
	WHOLE_STEPS = 32,           /* most that one expansion serves */
	REMAINDERS = 3              /* of each of its last two coefficients: itself, and what stands in for it */
};

static const struct expansion *expansion(const struct emitter *e)
{
	return e->step->expansion;
}

static const struct truncation *truncation(const struct emitter *e)
{
	return &e->model->truncation;
}

static bool changes(const struct emitter *e)
{
	return e->system->segments > 1;
}

static bool looks_at_tolerance(const struct emitter *e)
{
	return mpq_sgn(truncation(e)->tolerance) != 0;
}

/* Of fixed order: the status says where the last terms are above the tolerance. */
static bool watches(const struct emitter *e)
{
	return looks_at_tolerance(e) && !truncation(e)->adaptive;
}

/* Steps that one expansion may serve: with inputs one, the samples to come are not known */
static int most_served(const struct emitter *e)
{
	return e->system->inputs ? 1 : WHOLE_STEPS;
}

/* ---- its sum ---- */

void emit_series_ahead(const struct emitter *e)
{
	int order = expansion(e)->order, states = e->system->states;
	enum { WRITTEN_OUT = 400 };
	say(e, "\n/* What the series gains from its start, theta h later */\n"
	       "static void $n_ahead(const double c[%d][$N_STATES], double theta, double gain[$N_STATES])\n"
	       "{\n", order + 1);
	if (states * order > WRITTEN_OUT) {
		say(e, "    int i, k;\n"
		       "    for (i = 0; i < $N_STATES; i++)\n"
		       "        gain[i] = c[%d][i];\n"
		       "    for (k = %d; k > 0; k--)\n"
		       "        for (i = 0; i < $N_STATES; i++)\n"
		       "            gain[i] = gain[i] * theta + c[k][i];\n"
		       "    for (i = 0; i < $N_STATES; i++)\n"
		       "        gain[i] *= theta;\n"
		       "}\n", order, order - 1);
		return;
	}
	for (int i = 0; i < states; i++)
		say(e, "    double g%d = c[%d][%d];\n", i, order, i);
	for (int k = order - 1; k > 0; k--)
		for (int i = 0; i < states; i++)
			say(e, "%sg%d = g%d * theta + c[%d][%d];%s", i % 4 ? " " : "    ", i, i, k, i,
			    i % 4 == 3 || i == states - 1 ? "\n" : "");
	for (int i = 0; i < states; i++)
		say(e, "    gain[%d] = g%d * theta;\n", i, i);
	say(e, "}\n");
}

/* ---- how far it holds ---- */

static void emit_reach_tables(const struct emitter *e)
{
	int order = expansion(e)->order, most = most_served(e);
	const char *last = "", *before = "";
	mpq_t bound, steps;
	mpq_inits(bound, steps, NULL);
	for (int m = 1; m <= most; m++) {
		mpq_set(bound, truncation(e)->tolerance);
		mpq_set_ui(steps, (unsigned long)m, 1);
		mpq_mul(bound, bound, steps);
		for (int k = 4; k < order; k++)
			mpq_div(bound, bound, steps);
		const char *gap = m == 1 ? "" : (m - 1) % 4 ? ", " : ",\n    ";
		before = format("%s%s%s", before, gap, shortest(round_rational(bound)));
		mpq_div(bound, bound, steps);
		last = format("%s%s%s", last, gap, shortest(round_rational(bound)));
	}
	mpq_clears(bound, steps, NULL);
	say(e, "\n/* The tolerance over m^%d and m^%d: what the last coefficients may be for m steps, times m^4 */\n"
	       "static const double $n_last[%d] = {\n    %s\n};\n"
	       "static const double $n_before_last[%d] = {\n    %s\n};\n", order - 4, order - 5, most, last, most,
	    before);
}

/* The last two coefficients, relative to the largest size of each state so far. Of a series in t^n alone they may be 0,
 * or nearly: then those before stand in for them, each two orders over 256, which is more than full series fall. */
void emit_series_remainder(const struct emitter *e)
{
	int order = expansion(e)->order, kept = truncation(e)->adaptive ? REMAINDERS : 1;
	static const char *const factor[] = { "", " * 0.00390625", " * 1.52587890625e-5" };
	say(e, "\n/* The last two coefficients over the largest value of each state so far, or where that is 0 its gain"
	       "%s */\n"
	       "static void $n_remainder(const $n *s, const double c[%d][$N_STATES], double last[%d],\n"
	       "    double before[%d])\n"
	       "{\n"
	       "    int i;\n",
	    kept > 1 ? ";\n * what stands in for them where they are 0: those before, each two over 256" : "",
	    order + 1, kept, kept);
	for (int j = 0; j < kept; j++)
		say(e, "    last[%d] = before[%d] = 0.0;\n", j, j);
	say(e, "    for (i = 0; i < $N_STATES; i++) {\n"
	       "        double p = pl_magnitude(c[0][i]), unit = p > s->scale[i] ? 1.0 / p : s->unit[i];\n"
	       "        if (unit == 0.0) {\n"
	       "            const double one = pl_magnitude(c[1][i]), two = pl_magnitude(c[2][i]);\n"
	       "            unit = one > two ? 1.0 / one : two > 0.0 ? 1.0 / two : 1.0;\n"
	       "        }\n");
	for (int j = 0; j < 2 * kept; j++) {
		const char *sum = format("%s[%d]", j % 2 ? "before" : "last", j / 2);
		if (order - j >= 2)
			say(e, "        p = pl_magnitude(c[%d][i]) * unit%s;\n"
			       "        %s = p <= %s ? %s : p;%s\n", order - j, factor[j / 2], sum, sum, sum,
			    j ? "" : "  /* what is not a number stays */");
	}
	say(e, "    }\n"
	       "}\n");
}

/* last[0] + last[1]/m^2 + last[2]/m^4 within the tolerance over m^order */
static void emit_serves(const struct emitter *e)
{
	say(e, "\n/* Whether the remainders are within these bounds after m steps */\n"
	       "static int $n_serves(const double last[%d], const double before[%d], double m, double bound,\n"
	       "    double bound_before)\n"
	       "{\n"
	       "    const double square = m * m;\n"
	       "    return (last[0] * square + last[1]) * square + last[2] <= bound &&\n"
	       "        (before[0] * square + before[1]) * square + before[2] <= bound_before;\n"
	       "}\n", REMAINDERS, REMAINDERS);
}

static void emit_reach(const struct emitter *e)
{
	int order = expansion(e)->order, most = most_served(e);
	const char *tolerance = shortest(round_rational(truncation(e)->tolerance));
	say(e, "\n/* Steps that the series serves, at most %d%s; 0: not even one */\n"
	       "static int $n_reach(const $n *s)\n"
	       "{\n"
	       "    double last[%d], before[%d];\n"
	       "    int m = s->valid;\n"
	       "    $n_remainder(s, s->series, last, before);\n"
	       "    while (m < %d && $n_serves(last, before, (double)(m + 1), $n_last[m], $n_before_last[m]))\n"
	       "        m++;\n"
	       "    while (m > 0 && !$n_serves(last, before, (double)m, $n_last[m - 1], $n_before_last[m - 1]))\n"
	       "        m--;\n"
	       "    return m;\n"
	       "}\n", most, e->system->inputs ? ": the samples to come are not known" : "", REMAINDERS, REMAINDERS,
	    most);
	say(e, "\n/* The part of a step that the series serves, a power of 2 up to 1; 0: none */\n"
	       "static double $n_part(const $n *s, const double c[%d][$N_STATES])\n"
	       "{\n"
	       "    double last[%d], before[%d], part = 1.0;\n"
	       "    int halvings = 0;\n"
	       "    $n_remainder(s, c, last, before);\n"
	       "    for (; halvings < 60 && !$n_serves(last, before, 1.0, %s, %s); halvings++) {\n"
	       "        part *= 0.5;\n", order + 1, REMAINDERS, REMAINDERS, tolerance, tolerance);
	for (int j = 0; j < REMAINDERS; j++)
		say(e, "        last[%d] *= %s;\n"
		       "        before[%d] *= %s;\n", j, shortest(ldexp(1, 2 * j - order)), j,
		    shortest(ldexp(1, 2 * j + 1 - order)));
	say(e, "    }\n"
	       "    return halvings < 60 ? part : 0.0;\n"
	       "}\n");
}

/* Of terms that are 1 at h: at a part of it size^P and size^(P - 1) of that */
static void emit_is_accurate(const struct emitter *e)
{
	int order = expansion(e)->order;
	const char *tolerance = shortest(round_rational(truncation(e)->tolerance));
	bool part = changes(e);
	say(e, "\n/* Whether the last two terms%s are within the tolerance */\n"
	       "static int $n_is_accurate(const $n *s, const double c[%d][$N_STATES]%s)\n"
	       "{\n"
	       "    double last[1], before[1]%s;\n",
	    part ? ", at this part of a step," : "", order + 1, part ? ", double size" : "",
	    part ? ", power = size" : "");
	if (part)
		say(e, "    int k;\n");
	say(e, "    $n_remainder(s, c, last, before);\n");
	if (part)
		say(e, "    for (k = 2; k < %d; k++)\n"
		       "        power *= size;\n"
		       "    return last[0] * (power * size) <= %s && before[0] * power <= %s;\n", order, tolerance,
		    tolerance);
	else
		say(e, "    return last[0] <= %s && before[0] <= %s;\n", tolerance, tolerance);
	say(e, "}\n");
}

/* ---- inside a step ---- */

/* From now over a part of the step: substeps, and changes of the loads on the way */
static void emit_between(const struct emitter *e)
{
	int order = expansion(e)->order, last = e->system->segments - 1;
	bool adaptive = truncation(e)->adaptive;
	say(e, "\n/* y and what rounding took from it, end h later: 0; or what went wrong, and y as far as it went */\n"
	       "static int $n_between(const $n *s, %sdouble end, double y[$N_STATES], double rest[$N_STATES])\n"
	       "{\n"
	       "    double c[%d][$N_STATES], gain[$N_STATES], done = 0.0;\n"
	       "    int i%s%s;\n", driven_parameter(e), order + 1,
	    adaptive ? ", steps = 0" : watches(e) ? ", status = 0" : "",
	    changes(e) ? ", segment = s->segment" : "");
	emit_input_samples(e);
	say(e, "    while (done < end) {\n"
	       "        double limit = end, size;\n");
	if (changes(e))
		say(e, "        for (; segment < %d; segment++) {\n"
		       "            const double change = $n_until(s, segment) / $N_H;\n"
		       "            limit = change < end ? change : end;\n"
		       "            if (limit > done)\n"
		       "                break;\n"
		       "            limit = end;\n"
		       "        }\n", last);
	if (adaptive)
		say(e, "        if (steps++ == %d)\n"
		       "            return PL_TOO_MANY_STEPS;\n", truncation(e)->substeps);
	say(e, "        %s\n", expand_call(e, spell(e, "done * $N_H"),
		spell(e, "$n_time(s) + 0.5 * (done + limit) * $N_H"), "segment", "y", "c"));
	if (adaptive)
		say(e, "        size = $n_part(s, (const double (*)[$N_STATES])c);\n"
		       "        if (size == 0.0)\n"
		       "            return PL_NOT_FINITE;\n"
		       "        size = size < limit - done ? size : limit - done;\n");
	else
		say(e, "        size = limit - done;\n");
	if (watches(e))
		say(e, "        if (!$n_is_accurate(s, (const double (*)[$N_STATES])c, size))\n"
		       "            status = PL_INACCURATE;\n");
	say(e, "        $n_ahead((const double (*)[$N_STATES])c, size, gain);\n"
	       "        for (i = 0; i < $N_STATES; i++)\n"
	       "            y[i] = pl_accumulate(y[i], gain[i], 0.0, &rest[i]);\n"
	       "        done = size < limit - done ? done + size : limit;\n"
	       "    }\n"
	       "    return %s;\n"
	       "}\n", watches(e) ? "status" : "0");
}

/* ---- the step ---- */

static void emit_scales(const struct emitter *e, const char *indent)
{
	say(e, "%sif (pl_magnitude(s->y[i]) > s->scale[i]) {\n"
	       "%s    s->scale[i] = pl_magnitude(s->y[i]);\n"
	       "%s    s->unit[i] = 1.0 / s->scale[i];\n"
	       "%s}\n", indent, indent, indent, indent);
}

bool expansion_places(const struct emitter *e)
{
	return looks_at_tolerance(e);
}

void emit_expansion_place(const struct emitter *e)
{
	if (!looks_at_tolerance(e))
		return;
	say(e, "\n/* What follows from a state that was set */\n"
	       "static void $n_place($n *s)\n"
	       "{\n"
	       "    int i;\n");
	if (truncation(e)->adaptive)
		say(e, "    s->served = s->valid = 0;\n");
	say(e, "    for (i = 0; i < $N_STATES; i++) {\n"
	       "        s->scale[i] = s->unit[i] = 0.0;\n");
	emit_scales(e, "        ");
	say(e, "    }\n"
	       "}\n");
}

static const char *u_argument(const struct emitter *e)
{
	return e->system->inputs ? "u, " : "";
}

static void emit_expansion_end(const struct emitter *e)
{
	emit_step_end(e);
	if (!truncation(e)->adaptive)           /* else a series that is not finite serves no step */
		say(e, "    s->status |= pl_not_finite(s->y, $N_STATES);\n");
	if (changes(e))
		say(e, "    while (s->segment < %d && $n_until(s, s->segment) <= 1e-18 * $N_H)\n"
		       "        s->segment++;\n", e->system->segments - 1);
	say(e, "}\n");
}

/* c_1 + ... + c_P, small ones first; the last three, which come late, apart */
static const char *whole_gain(int order, int state)
{
	enum { LATE = 3 };
	const char *text = "", *late = format("c[%d][%d]", order, state);
	for (int k = order - 1; k > order - LATE; k--)
		late = format("(%s + c[%d][%d])", late, k, state);
	for (int k = order - LATE; k > 0; k--)
		text = *text ? format("(%s + c[%d][%d])", text, k, state) : format("c[%d][%d]", k, state);
	return format("%s + %s", late, text);
}

/* Of fixed order: one way through, whatever the numbers are */
static void emit_fixed_step(const struct emitter *e)
{
	int order = expansion(e)->order, states = e->system->states;
	say(e, "\nvoid $n_step(%s)\n"
	       "{\n", step_parameters(e));
	if (changes(e)) {
		say(e, "%s    s->status |= $n_between(s, %s1.0, s->y, s->rest);\n",
		    watches(e) ? "    int i;\n" : "", u_argument(e));
	} else {
		say(e, "    double c[%d][$N_STATES];\n", order + 1);
		emit_input_samples(e);
		if (watches(e))
			say(e, "    int i;\n");
		say(e, "    %s\n", expand_call(e, "", "", "", "s->y", "c"));
		for (int i = 0; i < states; i++) {
			const char *text = whole_gain(order, i);
			text = format("s->y[%d] = pl_accumulate(s->y[%d], %s, 0.0, &s->rest[%d]);\n", i, i, text, i);
			say(e, "    ");
			say_wrapped(e, text);
		}
		if (watches(e))
			say(e, "    if (!$n_is_accurate(s, (const double (*)[$N_STATES])c))\n"
			       "        s->status |= PL_INACCURATE;\n");
	}
	if (watches(e)) {
		say(e, "    for (i = 0; i < $N_STATES; i++)\n");
		emit_scales(e, "        ");
	}
	emit_expansion_end(e);
}

/* A new series. The loads' next change bounds the steps that it serves; conditions on t are decided before it, in the
 * middle, where time is on one side of them also when it is late, or float. */
static void emit_renew(const struct emitter *e)
{
	bool inputs = e->system->inputs > 0;
	const char *when = spell(e, "$n_time(s) + 0.5 * $N_H");
	say(e, "\n/* A new series from here, and how many steps it serves */\n"
	       "static void $n_renew(%s)\n"
	       "{\n", step_parameters(e));
	if (changes(e)) {
		say(e, "    const double change = s->segment < %d ? $n_until(s, s->segment) : %d.0 * $N_H;\n",
		    e->system->segments - 1, most_served(e));
		when = spell(e, "$n_time(s) + 0.5 * (change < $N_H ? change : $N_H)");
	}
	say(e, "    int i;\n");
	emit_input_samples(e);
	say(e, "    for (i = 0; i < $N_STATES; i++)\n");
	emit_scales(e, "        ");
	say(e, "    %s\n", expand_call(e, "0.0", when, "s->segment", "s->y", "s->series"));
	say(e, "    s->valid = $n_reach(s);\n");
	if (changes(e))
		say(e, "    if (change < (double)s->valid * $N_H)\n"
		       "        s->valid = (int)(change / $N_H);\n");
	say(e, "    s->served = 0;\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        s->base[i] = s->rest[i];\n");
	if (inputs)
		say(e, "    (void)u;\n");
	say(e, "}\n");
}

static void emit_adaptive_step(const struct emitter *e)
{
	bool inputs = e->system->inputs > 0;
	emit_renew(e);
	say(e, "\nvoid $n_step(%s)\n"
	       "{\n"
	       "    int i;\n"
	       "    if (s->served == s->valid)\n"
	       "        $n_renew(s%s);\n"
	       "    if (s->valid) {\n"
	       "        double gain[$N_STATES];\n"
	       "        s->served++;\n"
	       "        $n_ahead((const double (*)[$N_STATES])s->series, (double)s->served, gain);\n"
	       "        if (s->served < s->valid) {\n"
	       "            for (i = 0; i < $N_STATES; i++)\n"
	       "                s->y[i] = s->series[0][i] + (gain[i] + s->base[i]);\n"
	       "        } else {\n"
	       "            for (i = 0; i < $N_STATES; i++)\n"
	       "                s->y[i] = pl_accumulate(s->series[0][i], gain[i], 0.0, &s->rest[i]);\n"
	       "        }\n"
	       "    } else {\n"
	       "        s->status |= $n_between(s, %s1.0, s->y, s->rest);\n"
	       "    }\n", step_parameters(e), inputs ? ", u" : "", u_argument(e));
	emit_expansion_end(e);
}

void emit_expansion_members(const struct emitter *e)
{
	if (truncation(e)->adaptive)
		say(e, "    double series[%d][$N_STATES];  /* the last expansion, in powers of time over h */\n"
		       "    double base[$N_STATES];  /* what rounding had taken there */\n"
		       "    int served, valid;    /* steps since then; steps that it serves */\n",
		    expansion(e)->order + 1);
	if (looks_at_tolerance(e))
		say(e, "    double scale[$N_STATES], unit[$N_STATES];  "
		       "/* the largest size of each state so far; 1 over it */\n");
}

void emit_expansion_step(const struct emitter *e)
{
	if (reads_channels(e->model))
		emit_leftover_functions(e);
	emit_force_table(e);
	emit_expand_function(e);
	emit_series_ahead(e);
	if (looks_at_tolerance(e))
		emit_series_remainder(e);
	if (watches(e))
		emit_is_accurate(e);
	if (truncation(e)->adaptive) {
		emit_reach_tables(e);
		emit_serves(e);
		emit_reach(e);
	}
	if (has_offset(e))
		emit_between(e);
	(truncation(e)->adaptive ? emit_adaptive_step : emit_fixed_step)(e);
}

/* ---- between steps ---- */

void emit_expansion_at(const struct emitter *e)
{
	bool relative = e->model->relative != NULL, adaptive = truncation(e)->adaptive, offset = has_offset(e);
	const char *y = relative ? "x" : "y", *margin = adaptive ? "    " : "";
	say(e, "\nvoid $n_at(const $n *s, %sdouble tau, double y[$N_STATES])\n"
	       "{\n"
	       "    double %s%s[$N_STATES];\n"
	       "    int i;\n", driven_parameter(e), relative ? format("x[%s_STATES], ", e->upper) : "",
	    offset ? "rest" : "gain");
	if (!offset) {
		say(e, "    double c[%d][$N_STATES];\n", expansion(e)->order + 1);
		emit_input_samples(e);
		say(e, "    %s\n", expand_call(e, "", "", "", "s->y", "c"));
		say(e, "    $n_ahead((const double (*)[$N_STATES])c, tau / $N_H, gain);\n"
		       "    for (i = 0; i < $N_STATES; i++)\n"
		       "        %s[i] = s->y[i] + (gain[i] + s->rest[i]);\n", y);
	}
	if (adaptive)
		say(e, "    if (s->served < s->valid) {\n"
		       "        double gain[$N_STATES];\n"
		       "        $n_ahead((const double (*)[$N_STATES])s->series, (double)s->served + tau / $N_H, "
		       "gain);\n"
		       "        for (i = 0; i < $N_STATES; i++)\n"
		       "            %s[i] = s->series[0][i] + (gain[i] + s->base[i]);\n"
		       "    } else {\n", y);
	if (offset)
		say(e, "%s    for (i = 0; i < $N_STATES; i++) {\n"
		       "%s        %s[i] = s->y[i];\n"
		       "%s        rest[i] = s->rest[i];\n"
		       "%s    }\n"
		       "%s    $n_between(s, %stau / $N_H, %s, rest);\n", margin, margin, y, margin, margin, margin,
		    u_argument(e), y);
	if (adaptive)
		say(e, "    }\n");
	if (relative)
		say(e, "    $n_written(s, x, y);\n");
	say(e, "}\n");
}
