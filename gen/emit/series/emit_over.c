/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of a series of fixed order that one expansion is over several of: its coefficients in powers of time over all
 * of them, so that the last one's end is their sum, those before it values inside. */
#include "inner.h"
#include "emit/steps.h"
#include "step/series/expansion.h"

static int order_of(const struct emitter *e)
{
	return e->step->taylor.expansion->order;
}

/* A block of rows has all coefficients as locals: no watch, few enough that they stand twice, which --fast or --rows
 * ask for. */
bool runs_in_blocks(const struct emitter *e)
{
	return spans_steps(e) && wants_rows(&e->model->request) && !has_ranges(e) && !has_peaks(e) &&
	       expands_in_step(e) && !watches(e) && is_written_out(e, order_of(e));
}

/* Of a state; 1: only the first is left */
static int highest_term(const struct emitter *e, int state, gain_term *term)
{
	int top = e->step->taylor.expansion->order;
	while (top > 1 && !term(e, state, top))
		top--;
	return top;
}

/* s->y: the state `theta` after the start, by Horner's rule; what rounding took at the start is in `rest` */
void emit_value(const struct emitter *e, const char *theta, gain_term *term, const char *rest,
		       const char *indent)
{
	int states = e->system->states;
	for (int i = 0; i < states; i++) {
		const char *first = term(e, i, highest_term(e, i, term));
		say(e, "%sdouble g%d = %s;\n", indent, i, first ? first : "0.0");
	}
	for (int k = e->step->taylor.expansion->order - 1; k > 0; k--)
		for (int i = 0; i < states; i++) {
			const char *text = term(e, i, k);
			if (k < highest_term(e, i, term))
				say(e, "%sg%d = g%d * %s%s%s;\n", indent, i, i, theta, text ? " + " : "",
				    text ? text : "");
		}
	for (int i = 0; i < states; i++)
		say(e, "%ss->y[%d] = %s + (g%d * %s + %s);\n", indent, i, term(e, i, 0), i, theta, format(rest, i));
}

void emit_over_members(const struct emitter *e)
{
	say(e, "    double series[%d][$N_STATES];  /* the last expansion, in powers of t / (%d h) */\n"
	       "    double next[$N_STATES], left[$N_STATES];  /* the state at its end, in two parts */\n"
	       "    int served;           /* steps since it began, at most %d; 0: the next step expands again */\n",
	    order_of(e) + 1, truncation_of(e)->over, truncation_of(e)->over - 1);
}

static double part_of(const struct emitter *e, int step)
{
	RATIONAL part = ZERO;
	mpq_set_si(part, step, (unsigned long)truncation_of(e)->over);
	mpq_canonicalize(part);
	return round_rational(part);
}

void emit_over_table(const struct emitter *e)
{
	const int count = truncation_of(e)->over - 1;
	double *part = ARRAY(double, (size_t)count);
	for (int m = 0; m < count; m++)
		part[m] = part_of(e, m + 1);
	emit_array(e, "So many steps, as parts of those that a series is over", "part_of", 1, &count, part, NULL);
}

/* ---- NAME_run ---- */

static void emit_rows_of_block(const struct emitter *e)
{
	int over = truncation_of(e)->over, states = e->system->states;
	for (int m = 1; m <= over; m++) {
		if (m < over) {
			say(e, "    if (out) {\n");
			emit_value(e, shortest(part_of(e, m)), coefficient, "base%d", "        ");
			say(e, "    }\n");
		} else {
			for (int i = 0; i < states; i++)
				say(e, "    s->y[%d] = next%d;\n"
				       "    s->low[%d] = low%d;\n", i, i, i, i);
		}
		emit_step_end(e);
		say(e, "    if (out) { $n_out(s, out%s); }\n",
		    m == 1 ? "" : format(" + %d * %s_OUTPUTS", m - 1, e->upper));
	}
}

/* All steps of an expansion: the next one waits for nothing but its end, which comes first. */
void emit_over_block(const struct emitter *e)
{
	int states = e->system->states;
	if (!runs_in_blocks(e))
		return;
	say(e, "\n/* %d steps as one, and the outputs after each unless out is NULL; 0: its end is not finite, and s "
	       "as it was */\n"
	       "static int $n_block($n *s, double *out)\n"
	       "{\n"
	       "    const double *const y = s->y;\n", truncation_of(e)->over);
	emit_coefficients(e);
	for (int i = 0; i < states; i++)
		say(e, "    const double base%d = s->low[%d];\n"
		       "    double low%d = base%d;\n", i, i, i, i);
	emit_series_ends(e);
	say_wrapped(e, format("if (%s) { return 0; }\n", is_not_finite(e)));
	emit_rows_of_block(e);
	say(e, "    return 1;\n"
	       "}\n");
}
