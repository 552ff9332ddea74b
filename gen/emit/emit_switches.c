/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Beside the collocation the Taylor series: where stability bounds its steps, and which of the two is next. */
#include "emit/emit.h"

#include <math.h>

/* Of an internal step, in h */
static const char *shortest_length(const struct emitter *e)
{
	return e->model->asked.single ? "1e-12" : "1e-18";
}

static double tolerance(const struct emitter *e)
{
	return round_rational(e->model->truncation.tolerance);
}

/* ---- where the series is bounded by stability ---- */

/* -J_ii + sum over j of |J_ij| of one kind of the entries of row i; NULL: it has none */
static const char *row_bound(const struct emitter *e, int coord, bool twice)
{
	const struct motion *m = e->step->motion;
	const char **term = ARRAY(const char *, (size_t)m->entries + 1);
	int terms = 0;
	for (int k = 0; k < m->entries; k++) {
		const struct motion_entry *entry = &m->entry[k];
		if (entry->coord != coord || entry->twice != twice)
			continue;
		term[terms++] = !twice && entry->of == coord ? format("-slope_of[%d]", k)
							     : format("pl_magnitude(slope_of[%d])", k);
	}
	return terms ? tree(terms, term, 12) : NULL;
}

/* Of Gershgorin's circles how far they reach to the left; of the derivatives by coordinates, which are squared rates,
 * their size */
static void emit_rates(const struct emitter *e)
{
	int n = e->system->n;
	say(e, "\n/* Bounds on how fast the motion may decay [1/s], and on the square of how fast it may turn: "
	       "Gershgorin's, of "
	       "the\n * Jacobian where the internal step starts */\n"
	       "static void $n_rates(const $n *s%s, double rates[2])\n"
	       "{\n"
	       "    double size;\n"
	       "%s"
	       "    rates[0] = rates[1] = 0.0;\n", samples_parameter(e), start_jacobian(e));
	for (int i = 0; i < 2 * n; i++) {
		const char *bound = row_bound(e, i / 2, i % 2);
		if (bound)
			say(e, "    size = %s;\n"
			       "    rates[%d] = size > rates[%d] ? size : rates[%d];\n", bound, i % 2, i % 2, i % 2);
	}
	say(e, "    (void)size;\n"
	       "    (void)s;\n"
	       "%s"
	       "}\n"
	       "\n/* Their product with a length in h, the larger one: what moves to and fro bounds a series less */\n"
	       "static double $n_product(const double rates[2], double length)\n"
	       "{\n"
	       "    const double dt = length * $N_H, decay = rates[0] * dt, turn = 0.5625 * rates[1] * dt * dt;\n"
	       "    return turn > decay * decay ? pl_root(turn, 2) : decay;\n"
	       "}\n", unread_samples(e));
}

/* (tolerance / last term)^(1 / order), and the same of the one before; where they are 0, or nearly, of what stands in
 * for them. Less is left for what comes after them where crossings follow from the state. */
static void emit_length(const struct emitter *e)
{
	int order = e->model->truncation.order;
	const char *tol = shortest(tolerance(e)), *tiny = e->model->asked.single ? "1e-35" : "1e-290";
	say(e, "\n/* How many h the series serves; 0: it is not finite */\n"
	       "static double $n_length(const $n *s)\n"
	       "{\n"
	       "    double last[3], before[3], length, other, square;\n"
	       "    $n_remainders(s, s->poly, last, before);\n"
	       "    if (!((last[0] + last[1]) + (last[2] + before[0]) + (before[1] + before[2]) < %s))\n"
	       "        return 0.0;\n"
	       "    length = pl_root(%s / (last[0] + %s), %d);\n"
	       "    other = pl_root(%s / (before[0] + %s), %d);\n"
	       "    length = other < length ? other : length;\n"
	       "    square = length * "
	       "length;\n", e->model->asked.single ? "1e37" : "1e300", tol, tiny, order, tol, tiny,
	    order - 1);
	say(e, "    if (last[1] * square + last[2] > last[0] * square * square ||\n"
	       "        before[1] * square + before[2] > before[0] * square * square) {\n"
	       "        other = pl_root(%s / (((last[0] * square + last[1]) * square + last[2]) + %s), %d);\n"
	       "        length = other < length ? other : length;\n"
	       "        other = pl_root(%s / (((before[0] * square + before[1]) * square + before[2]) + %s), %d);\n"
	       "        length = other < length ? other : length;\n"
	       "    }\n"
	       "    return %s * length;\n"
	       "}\n", tol, tiny, order - 4, tol, tiny, order - 5, is_divided(e) ? "0.8" : "0.94");
}

/* Up to the first crossing, where there is one */
static void emit_series_end(const struct emitter *e)
{
	const char *tiny = e->model->asked.single ? "1e-8" : "1e-15";
	say(e, "    crossing = s->contact.last;\n"
	       "    next = pl_divided_next(&$n_divided, s->poly[0], terms, s->contact.interval, length, &splits,\n"
	       "        &crossing, work);\n"
	       "    if (splits < 0)\n"
	       "        return PL_TOO_MANY_EVENTS | pl_not_finite(s->poly[0], %d * $c);\n"
	       "    if (next >= 0.0) {\n"
	       "        s->contact.last = crossing;\n"
	       "        s->stop = 3;\n"
	       "        length = next;\n"
	       "    } else {\n"
	       "        s->contact.last.expression = -1;\n"
	       "    }\n"
	       "    if (length < %s && next >= 0.0)\n"
	       "        return -2;\n"
	       "    if (next >= 0.0)\n"
	       "        $n_ahead((const double (*)[$c])s->poly, length, s->gain);\n",
	    e->step->expansion->order + 1, tiny);
}

/* Of all that it serves: before anything else is changed */
static void emit_finite_end(const struct emitter *e)
{
	say(e, "    end = length < limit ? length : limit;\n"
	       "    $n_ahead((const double (*)[$c])s->poly, end, s->gain);\n"
	       "    if (!$n_ends(s->start, s->gain))\n"
	       "        return PL_NOT_FINITE;\n");
}

/* Half as long, and again, until the coefficients show what the equations do */
static void emit_shown_length(const struct emitter *e, const char *start, const char *when)
{
	if (!has_unseen(e))
		return;
	const char *poly = spell(e, "(const double (*)[$c])s->poly"), *size = "length < limit ? length : limit";
	const char *meets = e->step->slopes ? meets_call(e, start, when, "s->leg", "s->contact.", poly, size) : "1";
	say(e, "    while (length > %s && !($n_shows(%s, length) && %s))\n"
	       "        length *= 0.5;\n"
	       "    if (!(length > %s))\n"
	       "        return PL_NOT_FINITE;\n", shortest_length(e), poly, meets, shortest_length(e));
}

/* A series in s->poly, up to where it serves or an expression passes a breakpoint */
static void emit_series_step(const struct emitter *e)
{
	const double most = 0.8 + 0.1 * e->model->truncation.order;
	const char *start = spell(e, "(s->at - (double)s->back) * $N_H");
	const char *when = spell(e, "$n_time(s) + ((s->at - (double)s->back) + 1e-9) * $N_H");
	struct emitter here = *e;
	here.ramps = false;
	say(e, "\n/* An internal step by the series: 0, or what went wrong: PL_NOT_FINITE, it is of no use%s. Where\n"
	       " * stability bounds several in a row, the collocation is next. */\n"
	       "static int $n_expand_step($n *s%s, double limit, const double rates[2])\n"
	       "{\n"
	       "    double length, product, end;\n", is_divided(e) ? "; -2: nothing moves" : "",
	    samples_parameter(e));
	if (is_divided(e))
		say(e, "    double terms[%d], work[PL_DIVIDED_WORK(%d)], next;\n"
		       "    pl_crossing crossing;\n"
		       "    int splits = %d;\n", e->step->divided->expressions, e->step->expansion->order, MAX_SPLITS);
	say(e, "    %s\n"
	       "%s", expand_call(&here, start, when, "s->leg", "s->contact.", "s->start", "s->poly"),
	    e->system->inputs ? "    (void)u;\n    (void)slope;\n" : "");
	if (e->step->expansion->measured)
		say(e, "    for (splits = $N_STATES; splits < %s; splits++)\n"
		       "        if (pl_magnitude(s->poly[0][splits]) > s->scale[splits]) {\n"
		       "            s->scale[splits] = pl_magnitude(s->poly[0][splits]);\n"
		       "            s->unit[splits] = 1.0 / s->scale[splits];\n"
		       "        }\n"
		       "    splits = %d;\n", measured_columns(e), MAX_SPLITS);
	say(e, "    length = $n_length(s);\n"
	       "    if (length == 0.0)\n"
	       "        return PL_NOT_FINITE;\n");
	say(e, "    if (length > 8.0 && length > 8.0 * s->want)\n"
	       "        length = s->want > 1.0 ? 8.0 * s->want : 8.0;\n");
	emit_shown_length(e, start, when);
	emit_finite_end(e);
	say(e, "    s->want = length;\n"
	       "    if (length < limit)\n"
	       "        s->stop = 0;\n"
	       "    else\n"
	       "        length = limit;\n"
	       "    product = $n_product(rates, length);\n"
	       "    s->bounds = product > %s ? s->bounds + 1 : 0;\n"
	       "    if (s->bounds >= s->patience) {\n"
	       "        s->stiff = 1;\n"
	       "        s->product = product;\n"
	       "        s->run = s->bounds = 0;\n"
	       "    }\n", shortest(most));
	if (is_divided(e))
		emit_series_end(e);
	say(e, "    s->size = length;\n"
	       "    s->series = 1;\n"
	       "    s->ready = 0;\n"
	       "    return 0;\n"
	       "}\n");
}

void emit_series_steps(const struct emitter *e)
{
	emit_force_table(e);
	emit_expand_function(e);
	emit_series_ahead(e);
	emit_series_remainder(e);
	emit_shows(e);
	emit_rates(e);
	emit_length(e);
	emit_series_step(e);
}

/* ---- which is next ---- */

/* How many series a step of the collocation is worth, by what they cost; some less, so that they do not take turns */
static double worth(const struct emitter *e)
{
	const struct collocation *x = e->step->collocation;
	double iterations = 2.2 + splits(e) * 3, series = e->step->program->multiplications;
	double step = iterations * e->step->iteration.multiplications + 4.0 * x->stages * x->stages * e->system->n;
	double ratio = floor(step / series * 12) / 16;
	return ratio < 1 ? 1 : ratio > 8 ? 8 : ratio;
}

void emit_choice(const struct emitter *e)
{
	const double most = 0.8 + 0.1 * e->model->truncation.order;
	const char *samples = e->system->inputs ? ", u, slope" : "";
	say(e, "\n/* An internal step by one of the two: 0, or what went wrong%s */\n"
	       "static int $n_choose($n *s%s, double limit, const double rates[2], int *steps)\n"
	       "{\n"
	       "    int wrong;\n"
	       "    for (;;) {\n"
	       "        const double dear = %s * s->product, most = s->run >= 3 && dear > %s ? dear : %s;\n"
	       "        if (s->stiff && $n_product(rates, s->want < limit ? s->want : limit) < most) {\n"
	       "            s->stiff = 0;  /* and where that was so soon, the series is given more time */\n"
	       "            s->patience = s->run > 8 ? 2 : s->patience < 64 ? 2 * s->patience : 64;\n"
	       "        }\n"
	       "        if (!s->stiff) {\n"
	       "            if ((*steps)++ == %d)\n"
	       "                return PL_TOO_MANY_STEPS;\n"
	       "            wrong = $n_expand_step(s%s, limit, rates);\n"
	       "            if (wrong != PL_NOT_FINITE)\n"
	       "                return wrong;\n"
	       "            s->stiff = 1;\n"
	       "            s->run = s->ready = 0;\n"
	       "            s->product = 0.0;\n"
	       "        "
	       "}\n", is_divided(e) ? "; -2: nothing moves" : "", samples_parameter(e), shortest(worth(e)),
	    shortest(most), shortest(most), e->model->truncation.substeps, samples);
	say(e, "        wrong = $n_collocate(s%s, limit, rates, steps);\n"
	       "        if (wrong != -1)\n"
	       "            return wrong;\n"
	       "    }\n"
	       "}\n", samples);
}
