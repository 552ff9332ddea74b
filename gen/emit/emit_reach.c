/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far a Taylor series holds, by its last terms; and, where nothing is known of it, by the slope at its end. */
#include "emit/emit.h"

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

void emit_reach_tables(const struct emitter *e)
{
	if (!truncation(e)->adaptive || e->system->inputs)
		return;
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

/* ---- what the runtime is told ---- */

void emit_reach_sizes(const struct emitter *e)
{
	say(e, "#define PL_TOLERANCE %s\n"
	       "#define PL_NOW y\n", shortest(round_rational(truncation(e)->tolerance)));
	if (shares_kinds(e))
		say(e, "#define PL_KIND(i) (%s)\n", kind_text(e, "(i)"));
	if (truncation(e)->adaptive && has_unseen(e))
		emit_unseen_sizes(e);
}
