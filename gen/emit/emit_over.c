/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of a series of fixed order that one expansion is over several of: its coefficients in powers of time over all
 * of them, so that the last one's end is their sum, those before it values inside. */
#include "emit/emit.h"

static const struct truncation *truncation(const struct emitter *e)
{
	return &e->model->truncation;
}

static int order_of(const struct emitter *e)
{
	return e->step->expansion->order;
}

/* A block of rows has all coefficients as locals: no watch, few enough that they stand twice, and not --rows 1, which
 * wants small code. */
bool runs_in_blocks(const struct emitter *e)
{
	return spans_steps(e) && e->model->asked.rows != 1 && !has_ranges(e) && expands_in_step(e) && !watches(e) &&
	       is_written_out(e, order_of(e));
}

void emit_over_members(const struct emitter *e)
{
	say(e, "    double series[%d][$N_STATES];  /* the last expansion, in powers of time over %d h */\n"
	       "    double next[$N_STATES], left[$N_STATES];  /* where it ends; what rounding took there */\n"
	       "    int served;           /* steps since it began, up to %d; 0: the next step makes another */\n",
	    order_of(e) + 1, truncation(e)->over, truncation(e)->over - 1);
}

/* The k-th coefficient as the instance has it; NULL: it is 0 */
static const char *kept_term(const struct emitter *e, int state, int k)
{
	return coefficient(e, state, k) ? format("s->series[%d][%d]", k, state) : NULL;
}

static const char *part_of(const struct emitter *e, int step)
{
	mpq_t part;
	mpq_init(part);
	mpq_set_si(part, step, (unsigned long)truncation(e)->over);
	mpq_canonicalize(part);
	const char *text = shortest(round_rational(part));
	mpq_clear(part);
	return text;
}

/* Of a state; 1: only the first is left */
static int highest_term(const struct emitter *e, int state, gain_term *term)
{
	int top = order_of(e);
	while (top > 1 && !term(e, state, top))
		top--;
	return top;
}

/* y: the state `theta` after the start, by Horner's rule; what rounding took at the start is in `rest` */
static void emit_value(const struct emitter *e, const char *theta, gain_term *term, const char *rest,
		       const char *indent)
{
	int states = e->system->states;
	for (int i = 0; i < states; i++) {
		const char *first = term(e, i, highest_term(e, i, term));
		say(e, "%sdouble g%d = %s;\n", indent, i, first ? first : "0.0");
	}
	for (int k = order_of(e) - 1; k > 0; k--)
		for (int i = 0; i < states; i++) {
			const char *text = term(e, i, k);
			if (k < highest_term(e, i, term))
				say(e, "%sg%d = g%d * %s%s%s;\n", indent, i, i, theta, text ? " + " : "",
				    text ? text : "");
		}
	for (int i = 0; i < states; i++)
		say(e, "%ss->y[%d] = %s + (g%d * %s + %s);\n", indent, i, term(e, i, 0), i, theta, format(rest, i));
}

/* A new series, and where it ends. One that is not finite is not kept: all its steps leave the state as it is. */
static void emit_renew(const struct emitter *e)
{
	int order = order_of(e), states = e->system->states;
	say(e, "\n/* A new series from here, over %d steps, and where it ends */\n"
	       "static void $n_renew($n *s)\n"
	       "{\n"
	       "    int i, k;\n", truncation(e)->over);
	for (int i = 0; i < states; i++)
		say(e, "    double rest%d = s->rest[%d], next%d;\n", i, i, i);
	say(e, "    %s\n", expand_call(e, "", "", "", "", "s->y", "s->series"));
	for (int i = 0; i < states; i++) {
		say(e, "    ");
		say_wrapped(e, format("next%d = pl_accumulate(s->y[%d], %s, &rest%d);\n", i, i,
				      whole_gain(e, i, kept_term), i));
	}
	if (watches(e))
		say(e, "    if (!$n_is_accurate(s, (const double (*)[$N_STATES])s->series))\n"
		       "        s->status |= PL_INACCURATE;\n");
	say(e, "    ");
	say_wrapped(e, format("if (%s) {  /* one of them is not finite */\n", is_not_finite(e, "next", "")));
	say(e, "        s->status |= PL_NOT_FINITE%s;\n"
	       "        for (i = 0; i < $N_STATES; i++) {\n"
	       "            s->next[i] = s->y[i];\n"
	       "            s->left[i] = s->rest[i];\n"
	       "            for (k = 1; k <= %d; k++)\n"
	       "                s->series[k][i] = 0.0;\n"
	       "        }\n"
	       "        return;\n"
	       "    }\n", watches(e) ? " | PL_INACCURATE" : "", order);
	for (int i = 0; i < states; i++)
		say(e, "    s->next[%d] = next%d;\n"
		       "    s->left[%d] = rest%d;\n", i, i, i, i);
	say(e, "}\n");
}

static void emit_inside(const struct emitter *e)
{
	int over = truncation(e)->over;
	say(e, "\n/* The state after so many steps of the series, before its last */\n"
	       "static void $n_inside($n *s)\n"
	       "{\n"
	       "    static const double part[%d] = {", over - 1);
	for (int m = 1; m < over; m++)
		say(e, "%s%s", m == 1 ? "" : m % 8 == 1 ? ",\n        " : ", ", part_of(e, m));
	say(e, "};\n"
	       "    const double theta = part[s->served - 1];\n");
	if (is_written_out(e, order_of(e)))
		emit_value(e, "theta", kept_term, "s->rest[%d]", "    ");
	else
		say(e, "    double gain[$N_STATES];\n"
		       "    int i;\n"
		       "    $n_ahead((const double (*)[$N_STATES])s->series, theta, gain);\n"
		       "    for (i = 0; i < $N_STATES; i++)\n"
		       "        s->y[i] = s->series[0][i] + (gain[i] + s->rest[i]);\n");
	say(e, "}\n");
}

void emit_over_step(const struct emitter *e)
{
	emit_renew(e);
	emit_inside(e);
	say(e, "\nvoid $n_step($n *s)\n"
	       "{\n"
	       "    int i;\n"
	       "    if (s->served == 0)\n"
	       "        $n_renew(s);\n"
	       "    if (++s->served < %d) {\n"
	       "        $n_inside(s);\n"
	       "    } else {\n"
	       "        s->served = 0;\n"
	       "        for (i = 0; i < $N_STATES; i++) {\n"
	       "            s->y[i] = s->next[i];\n"
	       "            s->rest[i] = s->left[i];\n", truncation(e)->over);
	if (watches(e))
		emit_series_scales(e, "            ");
	say(e, "        }\n"
	       "    }\n");
	emit_step_end(e);
	say(e, "}\n");
}

/* ---- NAME_run ---- */

static void emit_rows_of_block(const struct emitter *e)
{
	int over = truncation(e)->over, states = e->system->states;
	for (int m = 1; m <= over; m++) {
		if (m < over) {
			say(e, "    if (out) {\n");
			emit_value(e, part_of(e, m), coefficient, "base%d", "        ");
			say(e, "    }\n");
		} else {
			for (int i = 0; i < states; i++)
				say(e, "    s->y[%d] = next%d;\n"
				       "    s->rest[%d] = rest%d;\n", i, i, i, i);
		}
		emit_step_end(e);
		say(e, "    if (out)\n"
		       "        $n_out(s, out%s);\n", m == 1 ? "" : format(" + %d * %s_OUTPUTS", m - 1, e->upper));
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
	       "    const double *const y = s->y;\n", truncation(e)->over);
	emit_coefficients(e);
	for (int i = 0; i < states; i++)
		say(e, "    const double base%d = s->rest[%d];\n"
		       "    double rest%d = base%d;\n", i, i, i, i);
	for (int i = 0; i < states; i++) {
		say(e, "    ");
		say_wrapped(e, format("const double next%d = pl_accumulate(%s, %s, &rest%d);\n", i,
				      coefficient(e, i, 0), whole_gain(e, i, coefficient), i));
	}
	say(e, "    ");
	say_wrapped(e, format("if (%s)\n", is_not_finite(e, "next", "")));
	say(e, "        return 0;\n");
	emit_rows_of_block(e);
	say(e, "    return 1;\n"
	       "}\n");
}

void emit_over_run(const struct emitter *e)
{
	if (!runs_in_blocks(e))
		return;
	say(e, "    for (; n > 0u && s->served > 0; n--) {\n"
	       "        $n_step(s);\n"
	       "        if (out) {\n"
	       "            $n_out(s, out);\n"
	       "            out += $N_OUTPUTS;\n"
	       "        }\n"
	       "    }\n"
	       "    if (n >= %d) {\n"
	       "        $n now = *s;\n"
	       "        for (; n >= %d && $n_block(&now, out); n -= %d)\n"
	       "            if (out)\n"
	       "                out += %d * $N_OUTPUTS;\n"
	       "        *s = now;\n"
	       "    }\n", truncation(e)->over, truncation(e)->over, truncation(e)->over, truncation(e)->over);
}
