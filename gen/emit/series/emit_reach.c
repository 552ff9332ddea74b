/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far a Taylor series holds, what its coefficients may not show (functions that are all but constant over most of
 * their range, loads that may cancel): what reach.h, measure.h and unresolved.h of the runtime are given. */
#include "inner.h"
#include "emit/state.h"
#include "step/collocation/collocation.h"
#include "step/series/expansion.h"

#include <math.h>

bool looks_at_tolerance(const struct emitter *e)
{
	return mpq_sgn(truncation_of(e)->tolerance) != 0;
}

void emit_floors(const struct emitter *e)
{
	if (!has_floors(e))
		return;
	const int size = e->system->states + (e->step->taylor.expansion ? e->step->taylor.expansion->columns : 0);
	double *value = ARRAY(double, (size_t)size);
	RATIONAL floor = ZERO;
	for (int i = 0; i < e->system->states; i++) {
		mpq_div(floor, truncation_of(e)->absolute[i], truncation_of(e)->tolerance);
		value[i] = round_rational(floor);
	}
	emit_array(e, "Of each state its absolute tolerance over the relative one: it counts beside its size; 0: none",
		   "floor", 1, &size, value, NULL);
}

bool watches(const struct emitter *e)
{
	return looks_at_tolerance(e) && !truncation_of(e)->adaptive;
}

int most_served(const struct emitter *e)
{
	return e->system->inputs ? 1 : EXPANSION_SERVES;
}

bool holds_lengths(const struct emitter *e)
{
	return e->model->spec->joined.probe || e->model->spec->joined.held;
}

/* Do several states share a kind? Else each is measured by itself. */
bool shares_kinds(const struct emitter *e)
{
	int count[3] = { 0 };
	for (int i = 0; i < e->system->states; i++) {
		if (holds_lengths(e) && e->system->coord[i] >= e->model->spec->joined.own)
			continue;
		bool moved = i < e->system->n && e->system->velocity[i] >= 0;
		count[moved ? 0 : i < e->system->n ? 2 : 1]++;
	}
	return truncation_of(e)->adaptive && (count[0] > 1 || count[1] > 1 || count[2] > 1);
}

/* ---- the last terms ---- */

void emit_counting(const struct emitter *e)
{
	const int own = e->model->spec->joined.own, states = e->system->states;
	const int measured = e->step->taylor.expansion ? e->step->taylor.expansion->measured : 0;
	const int probe = own + e->model->spec->joined.columns * e->model->spec->joined.stride;
	int *counts = ARRAY(int, (size_t)(states + measured));
	if (!holds_lengths(e))
		return;
	for (int i = 0; i < states; i++)
		counts[i] = e->system->coord[i] < own ? 1 : e->system->coord[i] < probe ? 0 : 2;
	say(e, "\n/* What says how far a series holds: 1, a state; 2, a derivative by nothing; 0: others do not */\n");
	emit_int_list(e, "counts", states + measured, counts);
}

void emit_counts_macro(const struct emitter *e)
{
	if (holds_lengths(e))
		say_macro(e, "COUNTS(i)", spell(e, "$n_counts[i]"));
}

void emit_reach_tables(const struct emitter *e)
{
	emit_counting(e);
	if (!truncation_of(e)->adaptive || e->system->inputs)
		return;
	int order = e->step->taylor.expansion->order, most = most_served(e);
	double *last = ARRAY(double, (size_t)most), *before = ARRAY(double, (size_t)most);
	RATIONAL bound = ZERO, steps = ZERO;
	for (int m = 1; m <= most; m++) {
		mpq_set(bound, truncation_of(e)->tolerance);
		mpq_set_ui(steps, (unsigned long)m, 1);
		for (int k = 1; k < order; k++)
			mpq_div(bound, bound, steps);
		before[m - 1] = round_rational(bound);
		mpq_div(bound, bound, steps);
		last[m - 1] = round_rational(bound);
	}
	emit_array(e, format("The tolerance over m^%d and m^%d: what the last coefficients may be for m steps", order,
			     order - 1), "last", 1, &most, last, NULL);
	emit_array(e, NULL, "before_last", 1, &most, before, NULL);
}

/* ---- what the runtime is given ---- */

void emit_reach_sizes(const struct emitter *e)
{
	say(e, "#define PL_TOLERANCE %s\n"
	       "#define PL_NOW y\n", shortest(round_rational(truncation_of(e)->tolerance)));
	emit_counts_macro(e);
	if (shares_kinds(e))
		say(e, "#define PL_KIND(i) (%s)\n", kind_text(e, "(i)"));
	if (truncation_of(e)->adaptive && has_unresolved(e))
		emit_unresolved_sizes(e);
}

/* ---- what coefficients may not show ---- */

static const struct expansion *unresolved_functions(const struct emitter *e)
{
	return e->step->taylor.unresolved;
}

/* How many h of loads that may cancel each other are followed: so much of the phase of the fastest */
static double crowded_length(const struct emitter *e, double phase)
{
	return phase / (unresolved_functions(e)->crowded * mpq_get_d(e->model->h));
}

/* The argument of each, by its kind */
static void emit_unresolved_table(const struct emitter *e, const char *name, bool columns)
{
	const struct expansion *x = unresolved_functions(e);
	int *row = ARRAY(int, 3 * (size_t)x->unresolved_functions);
	for (int i = 0; i < x->unresolved_functions; i++) {
		row[3 * i] = columns ? x->unresolved[i].column : i;
		row[3 * i + 1] = (int)x->unresolved[i].kind;
		row[3 * i + 2] = x->unresolved[i].power;
	}
	say(e, "\n/* Of functions that coefficients may not show: where the argument stands, the kind, a power */\n");
	emit_integer_rows(e, "int", format("%s[%d][3]", name, x->unresolved_functions), x->unresolved_functions, 3,
			  row);
}

/* ---- what reach.h is given ---- */

void emit_unresolved_sizes(const struct emitter *e)
{
	const double rise = 0.5 * unresolved_functions(e)->order;
	say(e, "#define PL_HIDDEN %d\n"
	       "#define PL_BEATS %s\n"
	       "#define PL_RISES %s\n"
	       "#define PL_RISES_FACTOR %s\n", traces(e) ? unresolved_functions(e)->unresolved_functions : 0,
	    shortest(crowds(e) ? crowded_length(e, rise) : 0), shortest(rise), shortest(exp(rise)));
}

void emit_hidden_table(const struct emitter *e)
{
	if (traces(e))
		emit_unresolved_table(e, "hidden", true);
}

/* ---- along a step of the collocation ---- */

double crowded_steps(const struct emitter *e)
{
	return crowded_length(e, 2 * e->step->collocation->stages);
}

void emit_arguments(const struct emitter *e)
{
	if (traces(e))
		emit_unresolved_table(e, "argument", false);
}
