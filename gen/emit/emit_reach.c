/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far a Taylor series holds, by its last terms; and, where nothing is known of it, by the slope at its end. */
#include "emit/emit.h"

#include <math.h>

enum {
	REMAINDERS = 3,             /* of each of its last two coefficients: itself, and what stands in for it */
	WRITTEN_STATES = 4          /* more are looped over */
};

static int order_of(const struct emitter *e)
{
	return e->step->expansion->order;
}

static const struct truncation *truncation(const struct emitter *e)
{
	return &e->model->truncation;
}

bool looks_at_tolerance(const struct emitter *e)
{
	return mpq_sgn(truncation(e)->tolerance) != 0;
}

void emit_floors(const struct emitter *e)
{
	if (!has_floors(e))
		return;
	mpq_t floor;
	mpq_init(floor);
	say(e, "\n/* Of each state its absolute tolerance over the relative one, which counts beside its size; 0: it "
	       "has none */\n"
	       "static const double $n_floor[$c] = {");
	for (int i = 0; i < e->system->states; i++) {
		mpq_div(floor, truncation(e)->absolute[i], truncation(e)->tolerance);
		say(e, "%s%s", i == 0 ? "\n    " : i % 8 ? ", " : ",\n    ", shortest(round_rational(floor)));
	}
	say(e, "\n};\n");
	mpq_clear(floor);
}

bool watches(const struct emitter *e)
{
	return looks_at_tolerance(e) && !truncation(e)->adaptive;
}

int most_served(const struct emitter *e)
{
	return e->system->inputs ? 1 : EXPANSION_SERVES;
}

const char *measured_columns(const struct emitter *e)
{
	int measured = e->step->expansion->measured;
	return measured ? spell(e, "$N_STATES + %d", measured) : spell(e, "$N_STATES");
}

static const char *tolerance_text(const struct emitter *e)
{
	return shortest(round_rational(truncation(e)->tolerance));
}

/* ---- what counts as the size of a state ---- */

/* Some states are 0 for a while, or all but 0, and grow as high powers of time: relative to themselves nothing would
 * do. So the largest of its kind counts for each too, by a millionth. What is below all units, as the first trace of a
 * pulse that is to come, is measured by 1e-40. */
const char *one_over(const struct emitter *e, const char *size, const char *none)
{
	bool single = e->model->asked.single;
	return format("%s > %s ? 1.0 / %s : %s > 0.0 ? %s : %s", size, single ? "1e-25" : "1e-40", size, size,
		      single ? "1e25" : "1e40", none);
}

void emit_measure(const struct emitter *e, const char *now)
{
	const char *floored = !has_floors(e) ? "" : spell(e, "if ($n_floor[i] > 0.0) {\n"
		"            s->scale[i] = pl_magnitude(s->%s[i]) + $n_floor[i];\n"
		"            grown = 1;\n"
		"        } else ", now);
	say(e, "\n/* The largest size of each state so far, or a millionth of that of its kind, and 1 over it; 0: it "
	       "is 0 */\n"
	       "static void $n_measure($n *s)\n"
	       "{\n"
	       "    double most[3] = {0.0, 0.0, 0.0};\n"
	       "    int i, grown = 0;\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        %sif (pl_magnitude(s->%s[i]) > s->scale[i]) {\n"
	       "            s->scale[i] = pl_magnitude(s->%s[i]);\n"
	       "            grown = 1;\n"
	       "        }\n"
	       "    if (!grown)\n"
	       "        return;\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        if (s->scale[i] > most[%s])\n"
	       "            most[%s] = s->scale[i];\n"
	       "    for (i = 0; i < $N_STATES; i++) {\n"
	       "        const double least = %s%s * most[%s], size = s->scale[i] > least ? s->scale[i] : least;\n"
	       "        s->unit[i] = %s;\n"
	       "    }\n"
	       "}\n", floored, now, now, kind_text(e, "i"), kind_text(e, "i"),
	    has_floors(e) ? spell(e, "$n_floor[i] > 0.0 ? 0.0 : ") : "", shortest(ldexp(1, -20)), kind_text(e, "i"),
	    one_over(e, "size", "0.0"));
}

/* Do several states share a kind? Else each is measured by itself. */
bool shares_kinds(const struct emitter *e)
{
	int count[3] = { 0 };
	for (int i = 0; i < e->system->states; i++) {
		bool moved = i < e->system->n && e->system->velocity[i] >= 0;
		count[moved ? 0 : i < e->system->n ? 2 : 1]++;
	}
	return truncation(e)->adaptive && (count[0] > 1 || count[1] > 1 || count[2] > 1);
}

/* ---- the last terms ---- */

static void emit_reach_tables(const struct emitter *e)
{
	int order = order_of(e), most = most_served(e);
	const char *last = "", *before = "";
	mpq_t bound, steps;
	mpq_inits(bound, steps, NULL);
	for (int m = 1; m <= most; m++) {
		mpq_set(bound, truncation(e)->tolerance);
		mpq_set_ui(steps, (unsigned long)m, 1);
		for (int k = 1; k < order; k++)
			mpq_div(bound, bound, steps);
		const char *gap = m == 1 ? "" : (m - 1) % 4 ? ", " : ",\n    ";
		before = format("%s%s%s", before, gap, shortest(round_rational(bound)));
		mpq_div(bound, bound, steps);
		last = format("%s%s%s", last, gap, shortest(round_rational(bound)));
	}
	mpq_clears(bound, steps, NULL);
	say(e, "\n/* The tolerance over m^%d and m^%d: what the last coefficients may be for m steps */\n"
	       "static const double $n_last[%d] = {\n    %s\n};\n"
	       "static const double $n_before_last[%d] = {\n    %s\n};\n", order, order - 1, most, last, most, before);
}

/* The last two coefficients, relative to the largest size of each state so far. Of a series in t^n alone they may be 0,
 * or nearly: then those before stand in for them, each two orders over 256, which is more than full series fall. */
static void emit_remainder(const struct emitter *e, int kept)
{
	int order = order_of(e);
	static const char *const factor[] = { "", " * 0.00390625", " * 1.52587890625e-5" };
	say(e, "\n/* The last two coefficients over the largest value of each state so far, or where that is 0 its gain"
	       "%s */\n"
	       "static void $n_remainder%s(const $n *s, const double c[%d][$c], double last[%d],\n"
	       "    double before[%d])\n"
	       "{\n"
	       "    int i;\n",
	    kept > 1 ? ";\n * what stands in for them where they are 0: those before, each two over 256" : "",
	    kept > 1 ? "s" : "", order + 1, kept, kept);
	for (int j = 0; j < kept; j++)
		say(e, "    last[%d] = before[%d] = 0.0;\n", j, j);
	say(e, "    for (i = 0; i < %s; i++) {\n"
	       "        double p = pl_magnitude(c[0][i]), unit = %sp %s s->scale[i] ? 1.0 / p : s->unit[i];\n"
	       "        if (unit == 0.0) {\n"
	       "            const double one = pl_magnitude(c[1][i]), two = pl_magnitude(c[2][i]);\n"
	       "            const double size = p > one ? p : one > two ? one : two;\n"
	       "            unit = %s;\n"
	       "        }\n", measured_columns(e),
	    has_floors(e) ? spell(e, "$n_floor[i] > 0.0 ? 1.0 / (p + $n_floor[i])\n            : ") : "",
	    shares_kinds(e) ? "* s->unit[i] > 1.0 && p >" : ">", one_over(e, "size", "1.0"));
	for (int j = 0; j < 2 * kept; j++) {
		const char *sum = format("%s[%d]", j % 2 ? "before" : "last", j / 2);
		if (order - j >= 2)
			say(e, "        p = pl_magnitude(c[%d][i]) * unit%s;\n"
			       "        %s = p <= %s ? %s : p;\n", order - j, factor[j / 2], sum, sum, sum);
	}
	say(e, "    }\n"
	       "}\n");
}

void emit_series_remainder(const struct emitter *e)
{
	emit_remainder(e, REMAINDERS);
}

/* ---- steps by tolerance ---- */

static void emit_part(const struct emitter *e)
{
	int order = order_of(e);
	const char *tolerance = tolerance_text(e);
	say(e, "\n/* The part of a step that the series serves, a power of 2 up to 1; 0: none */\n"
	       "static double $n_part(const $n *s, const double c[%d][$c])\n"
	       "{\n"
	       "    double last[%d], before[%d], part = 1.0;\n"
	       "    int halvings = 0;\n"
	       "    $n_remainders(s, c, last, before);\n"
	       "    for (; halvings < 60 && !(last[0] + last[1] + last[2] <= %s &&\n"
	       "            before[0] + before[1] + before[2] <= %s); halvings++) {\n"
	       "        part *= 0.5;\n", order + 1, REMAINDERS, REMAINDERS, tolerance, tolerance);
	for (int j = 0; j < REMAINDERS; j++)
		say(e, "        last[%d] *= %s;\n"
		       "        before[%d] *= %s;\n", j, shortest(ldexp(1, 2 * j - order)), j,
		    shortest(ldexp(1, 2 * j + 1 - order)));
	say(e, "    }\n"
	       "%s"
	       "    return halvings < 60 ? part : 0.0;\n"
	       "}\n", !has_unseen(e) ? "" : spell(e, "    for (; halvings < 60 && !$n_shows(c, part); halvings++)\n"
						      "        part *= 0.5;\n"));
}

/* The last two coefficients, state by state: what follows waits for it */
static void emit_written_remainder(const struct emitter *e)
{
	int order = order_of(e), states = e->system->states + e->step->expansion->measured;
	for (int i = 0; i < states; i++)
		say(e, "    const double unit%d = s->unit[%d] != 0.0 ? s->unit[%d] : $n_unit(s, %d);\n", i, i, i, i);
	for (int i = 0; i < states; i++)
		say(e, "    const double p%d = pl_magnitude(s->series[%d][%d]) * unit%d, "
		       "q%d = pl_magnitude(s->series[%d][%d]) * unit%d;\n", i, order, i, i, i, order - 1, i, i);
	const char *last = "p0", *before = "q0";
	for (int i = 1; i < states; i++) {
		say(e, "    const double last%d = p%d > %s ? p%d : %s;\n"
		       "    const double before%d = q%d > %s ? q%d : %s;\n", i, i, last, i, last, i, i, before, i,
		    before);
		last = format("last%d", i);
		before = format("before%d", i);
	}
	say(e, "    const double last = %s, before = %s;\n"
	       "    int m = s->valid;\n", last, before);
}

/* What precedes a series has shown that its last terms tell what follows. With inputs nothing has. */
static void emit_steps_served(const struct emitter *e)
{
	if (e->system->inputs) {
		say(e, "\n/* Steps that the series serves: 1, the samples to come are not known; 0: not even that */\n"
		       "static int $n_reach(const $n *s)\n"
		       "{\n"
		       "    return $n_part(s, s->series) >= 1.0;\n"
		       "}\n");
		return;
	}
	int order = order_of(e);
	say(e, "\n/* 1 over the largest size of a state so far, or where it has always been 0 over what it gains */\n"
	       "static double $n_unit(const $n *s, int i)\n"
	       "{\n"
	       "    const double one = pl_magnitude(s->series[1][i]), two = pl_magnitude(s->series[2][i]);\n"
	       "    const double size = one > two ? one : two;\n"
	       "    return s->unit[i] != 0.0 ? s->unit[i] : %s;\n"
	       "}\n"
	       "\n/* Steps that the series serves, at most %d; 0: not even one */\n"
	       "static int $n_reach(const $n *s)\n"
	       "{\n", one_over(e, "size", "1.0"), EXPANSION_SERVES);
	if (e->system->states + e->step->expansion->measured <= WRITTEN_STATES)
		emit_written_remainder(e);
	else
		say(e, "    double last = 0.0, before = 0.0;\n"
		       "    int i, m = s->valid;\n"
		       "    for (i = 0; i < %s; i++) {\n"
		       "        const double unit = $n_unit(s, i), p = pl_magnitude(s->series[%d][i]) * unit,\n"
		       "            q = pl_magnitude(s->series[%d][i]) * unit;\n"
		       "        last = p > last ? p : last;\n"
		       "        before = q > before ? q : before;\n"
		       "    }\n", measured_columns(e), order, order - 1);
	say(e, "    while (m < %d && last <= $n_last[m] && before <= $n_before_last[m])\n"
	       "        m++;\n"
	       "    while (m > 0 && !(last <= $n_last[m - 1] && before <= $n_before_last[m - 1]))\n"
	       "        m--;\n"
	       "%s"
	       "    return m;\n"
	       "}\n", EXPANSION_SERVES,
	    !has_unseen(e) ? "" : spell(e, "    while (m > 0 && !$n_shows(s->series, (double)m))\n"
					   "        m /= 2;\n"));
}

/* A first series may say nothing of what comes: x'' + x^3 = t^5 from rest has one term up to t^22. The equations do, at
 * its end: what lacks at P + 1 lacks P + 1 times in the slope there. What rounding may take from the slope of a
 * state is counted by the largest of all. */
static void emit_agrees(const struct emitter *e)
{
	int order = order_of(e);
	mpq_t bound, times;
	mpq_inits(bound, times, NULL);
	mpq_set_si(times, order, 1);
	mpq_mul(bound, truncation(e)->tolerance, times);
	say(e, "\n/* Whether the series c has at its end, size h later, the slope that the equations have there:\n"
	       " * d is the series from there on */\n"
	       "static int $n_agrees(const $n *s, const double c[%d][$c], const double d[%d][$c],\n"
	       "    double size)\n"
	       "{\n"
	       "    double most = 0.0;\n"
	       "    int i, k;\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        most = pl_magnitude(d[0][i]) > most ? pl_magnitude(d[0][i]) : most;\n"
	       "    for (i = 0; i < $N_STATES; i++) {\n"
	       "        double slope = 0.0, large = pl_magnitude(d[0][i]);\n"
	       "        for (k = %d; k > 0; k--)\n"
	       "            slope = slope * size + (double)k * c[k][i];\n"
	       "        large = s->scale[i] > large ? s->scale[i] : large;\n"
	       "%s"
	       "        if (!(pl_magnitude(slope - d[1][i]) * size <= %s * large + %s * most))\n"
	       "            return 0;\n"
	       "    }\n"
	       "    return 1;\n"
	       "}\n", order + 1, order + 1, order,
	    !shares_kinds(e) ? "" : "        if (s->unit[i] > 0.0 && large * s->unit[i] < 1.0)\n"
				    "            large = 1.0 / s->unit[i];\n",
	    shortest(round_rational(bound)),
	    e->model->asked.single ? "1e-6" : "1e-15");
	mpq_clears(bound, times, NULL);
}

/* ---- fixed order ---- */

/* Of terms that are 1 at h: at a part of it size^P and size^(P - 1) of that */
static void emit_is_accurate(const struct emitter *e)
{
	int order = order_of(e);
	const char *tolerance = tolerance_text(e);
	bool part = has_offset(e);
	say(e, "\n/* Whether the last two terms%s are within the tolerance */\n"
	       "static int $n_is_accurate(const $n *s, const double c[%d][$c]%s)\n"
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

void emit_validity(const struct emitter *e)
{
	if (watches(e)) {
		emit_remainder(e, 1);
		emit_is_accurate(e);
	}
	if (!truncation(e)->adaptive)
		return;
	if (!e->system->inputs)
		emit_reach_tables(e);
	emit_series_remainder(e);
	emit_shows(e);
	emit_part(e);
	emit_steps_served(e);
	emit_agrees(e);
}
