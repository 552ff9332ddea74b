/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Formulas that the state chooses beside the collocation: a step is solved with those of its start. Each expression is
 * a polynomial through its values at the start and the nodes; at its first root behind a breakpoint the step ends, and
 * is made anew with that length, since its end is more exact than its inside. */
#include "emit/emit.h"

#include <math.h>

static int stages(const struct emitter *e)
{
	return e->step->collocation->stages;
}

static int expressions(const struct emitter *e)
{
	return e->step->divided->expressions;
}

static const char *known_local(const struct emitter *e)
{
	return watch_reads_known(e) ? format("    double node[%d];\n", known_values(e)) : "";
}

/* node[] `tau` after the start of the step of NAME_step, where conditions on t hold as they do at `inside` */
static const char *known_at(const struct emitter *e, const char *tau, const char *inside, const char *indent)
{
	struct emitter here = *e;
	here.ramps = false;             /* samples are called u here */
	return watch_reads_known(e) ? format("%s%s\n", indent, known_call(&here, tau, inside, "node")) : "";
}

/* Samples at the start and slopes, of those who look at expressions alone: where these read them */
static const char *samples_of_watch(const struct emitter *e)
{
	return watch_reads_known(e) ? samples_parameter(e) : "";
}

static const char *samples_to_watch(const struct emitter *e)
{
	return watch_reads_known(e) && e->system->inputs ? ", u, slope" : "";
}

static const char *start_text(const struct emitter *e)
{
	(void)e;
	return "(s->at - (double)s->back)";
}

/* ---- the expressions where the internal step starts, and along it ---- */

static void emit_passing_table(const struct emitter *e)
{
	const char *column = "";
	for (int i = 0; i < expressions(e); i++)
		column = format("%s%s%d", column, i ? ", " : "", i);
	say(e, "\n/* Along a step of the collocation */\n"
	       "static const int $n_each[] = {%s};\n"
	       "static const pl_divided $n_passing = {\n"
	       "    %d, %d, %d, $n_each, $n_breaks, $n_breakpoint\n"
	       "};\n", column, expressions(e), expressions(e), stages(e));
}

static void emit_here(const struct emitter *e)
{
	say(e, "\n/* The expressions where the internal step starts: c[0]; all further coefficients are 0 */\n"
	       "static void $n_here(const $n *s%s, double c[%d][%d], double terms[%d])\n"
	       "{\n"
	       "%s"
	       "%s"
	       "    int i, m;\n"
	       "%s"
	       "    %s\n"
	       "    for (m = 1; m <= %d; m++)\n"
	       "        for (i = 0; i < %d; i++)\n"
	       "            c[m][i] = 0.0;\n"
	       "}\n", samples_of_watch(e), stages(e) + 1, expressions(e), expressions(e), current_intervals(e),
	    known_local(e), known_at(e, spell(e, "%s * $N_H", start_text(e)),
				     spell(e, "(%s + 1e-9) * $N_H", start_text(e)), "    "),
	    watch_call(e, "node", "s->start", "c[0]", "terms"), stages(e), expressions(e));
}

static void emit_along(const struct emitter *e)
{
	int s = stages(e), n = expressions(e);
	say(e, "\n/* ... along a step of `size` h: polynomials through their values there and at the nodes */\n"
	       "static void $n_along(const $n *s%s, double size, const double poly[%d][$c],\n"
	       "    double c[%d][%d], double terms[%d])\n"
	       "{\n"
	       "    double y[$N_STATES], value[%d], spare[%d];\n"
	       "%s"
	       "%s"
	       "    int i, k, m;\n"
	       "    $n_here(s%s, c, terms);\n"
	       "    for (k = 0; k < %d; k++) {\n", samples_of_watch(e), s + 1, s + 1, n, n, n, n,
	    current_intervals(e), known_local(e), samples_to_watch(e), s);
	say(e, "%s", known_at(e, spell(e, "(%s + $n_node[k] * size) * $N_H", start_text(e)),
			      spell(e, "(%s + 0.5 * size) * $N_H", start_text(e)), "        "));
	say(e, "        $n_within(poly, $n_node[k], y);\n"
	       "        for (i = 0; i < $N_STATES; i++)\n"
	       "            y[i] += s->start[i];\n"
	       "        %s\n"
	       "        for (i = 0; i < %d; i++) {\n"
	       "            const double rise = (value[i] - c[0][i]) / $n_node[k];\n"
	       "            for (m = 0; m < %d; m++)\n"
	       "                c[m + 1][i] += $n_monomial[m][k] * rise;\n"
	       "        }\n"
	       "    }\n"
	       "%s"
	       "}\n", watch_call(e, "node", "y", "value", "spare"), n, s,
	    watch_reads_known(e) ? "" : "    (void)size;\n");
}

/* ---- between internal steps ---- */

static void emit_place_here(const struct emitter *e)
{
	int most = 1;
	for (int i = 0; i < expressions(e); i++)
		most += e->step->divided->expression[i].breaks + 1;
	say(e, "\n/* The intervals of a state that was set, by values; the first step then says where that goes which "
	       "is on a\n * breakpoint. The interval of one expression may choose what another is. */\n"
	       "static void $n_locate($n *s%s)\n"
	       "{\n"
	       "    double c[%d][%d], terms[%d];\n"
	       "    int i, again = %d;\n"
	       "    for (i = 0; i < %d; i++)\n"
	       "        s->contact.interval[i] = 0;\n"
	       "    s->contact.last.expression = -1;\n"
	       "    s->contact.placed = -%d;\n"
	       "    do {\n"
	       "        $n_here(s%s, c, terms);\n"
	       "    } while (pl_divided_place(&$n_passing, c[0], terms, s->contact.interval) && again-- > 0);\n"
	       "}\n", samples_of_watch(e), stages(e) + 1, expressions(e), expressions(e), most, expressions(e), most,
	    samples_to_watch(e));
}

static void emit_left(const struct emitter *e)
{
	const char *samples = samples_to_watch(e);
	say(e, "\n/* Passes the breakpoint of contact.last, where the next internal step starts; 0: there were too "
	       "many */\n"
	       "static int $n_pass_here($n *s)\n"
	       "{\n"
	       "    s->ready = 0;\n"
	       "    return $n_cross(&s->contact, %s * $N_H);\n"
	       "}\n"
	       "\n/* Whether an expression has left its interval where the next internal step starts: by a jump */\n"
	       "static int $n_left($n *s%s)\n"
	       "{\n"
	       "    double c[%d][%d], terms[%d];\n"
	       "    $n_here(s%s, c, terms);\n"
	       "    return pl_divided_left(&$n_passing, c[0], terms, s->contact.interval, &s->contact.last);\n"
	       "}\n", start_text(e), samples_of_watch(e), stages(e) + 1, expressions(e), expressions(e), samples);
}

/* ---- the first crossing in a step ---- */

/* The coefficients of a polynomial of many stages have more rounding than its values at the nodes: what is on its
 * breakpoint is the expression itself, at the state there. */
static void emit_move_end(const struct emitter *e)
{
	enum { CORRECTIONS = 2 };
	int s = stages(e), n = expressions(e);
	const char *known = known_at(e, spell(e, "(%s + theta * size) * $N_H", start_text(e)),
				     spell(e, "(%s + 0.5 * size) * $N_H", start_text(e)), "        ");
	say(e, "\n/* Moves the end of the step to theta, near 1, and from there to where what contact.last says passes "
	       "its\n * breakpoint b; c: the expressions along the step */\n"
	       "static void $n_move_end($n *s%s, const double poly[%d][$c], double c[%d][%d], double theta, double b)\n"
	       "{\n"
	       "    const double size = s->size;\n"
	       "    const int which = s->contact.last.expression;\n"
	       "    double whole[$N_STATES], y[$N_STATES], value[%d], spare[%d];\n"
	       "%s"
	       "%s"
	       "    int i, m, again;\n"
	       "    $n_within(poly, 1.0, whole);\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        whole[i] = s->gain[i] - whole[i];\n", samples_of_watch(e), s + 1, s + 1, n, n, n,
	    current_intervals(e), known_local(e));
	say(e, "    for (again = 0;; again++) {\n"
	       "        double rate = 0.0, change;\n"
	       "        $n_within(poly, theta, y);\n"
	       "        for (i = 0; i < $N_STATES; i++) {\n"
	       "            s->gain[i] = whole[i] + y[i];\n"
	       "            y[i] = s->start[i] + s->gain[i];\n"
	       "        }\n"
	       "        s->size = theta * size;\n"
	       "        if (again == %d)\n"
	       "            return;\n"
	       "%s"
	       "        %s\n"
	       "        for (m = %d; m > 0; m--)\n"
	       "            rate = rate * theta + (double)m * c[m][which];\n"
	       "        change = (b - value[which]) / rate;\n"
	       "        if (!(pl_magnitude(change) < %s))\n"
	       "            return;\n"
	       "        theta += change;\n"
	       "    }\n"
	       "}\n", CORRECTIONS, known, watch_call(e, "node", "y", "value", "spare"), s,
	    shortest(e->model->asked.single ? ldexp(1, -10) : ldexp(1, -20)));
}

/* Near its start a polynomial may leave out more than what has just passed its breakpoint has moved since: that comes
 * back only if it does so along a shorter step too. */
static void emit_pass(const struct emitter *e)
{
	enum { AGAIN = 12 };
	int s = stages(e), n = expressions(e);
	bool single = e->model->asked.single, starts = e->step->expansion == NULL;
	const char *samples = e->system->inputs ? ", u, slope" : "", *jacobian = splits(e) ? ", slope_of" : "";
	const double near = single ? ldexp(1, -7) : ldexp(1, -10);
	say(e, "\n/* Ends the step that was found at the first crossing in it, where there is one: 0, or what went "
	       "wrong;\n * -2: it is at the start, so that nothing moves */\n"
	       "static int $n_pass($n *s%s%s, double limit, double unit[$N_STATES], double poly[%d][$c])\n"
	       "{\n"
	       "    double c[%d][%d], terms[%d], k[%d], work[PL_DIVIDED_WORK(%d)], theta, part, end = 1.0;\n"
	       "    pl_crossing crossing = s->contact.last;\n"
	       "    int splits = %d, again, back, b = 0;\n"
	       "    for (again = 0;; again++) {\n"
	       "        $n_along(s%s, s->size, (const double (*)[$c])poly, c, terms);\n", samples_parameter(e),
	    splits(e) ? ", const double slope_of[]" : "", s + 1, s + 1, n, n, unknowns_of_stages(e), s, MAX_SPLITS,
	    samples_to_watch(e));
	if (starts)
		say(e, "        if (s->contact.placed < 0) {\n"
		       "            if (pl_divided_rises(&$n_passing, c[0], terms, s->contact.interval)) {\n"
		       "                s->contact.placed++;\n"
		       "                s->size = 0.0;\n"
		       "                return -2;\n"
		       "            }\n"
		       "            s->contact.placed = 1;\n"
		       "        }\n");
	say(e, "        theta = pl_divided_next(&$n_passing, c[0], terms, s->contact.interval, end, &splits, "
	       "&crossing,\n            work);\n"
	       "        if (splits < 0)\n"
	       "            return PL_TOO_MANY_EVENTS;\n"
	       "        if (theta < 0.0) {\n"
	       "            s->contact.last.expression = -1;\n"
	       "            return 0;\n"
	       "        }\n"
	       "        back = crossing.expression == s->contact.last.expression &&\n"
	       "               crossing.breakpoint == s->contact.last.breakpoint && theta < 0.0625;\n"
	       "        if (again == %d || theta > %s || (!back && theta * s->size < %s))\n"
	       "            break;\n"
	       "        part = back ? 0.0625 : theta;\n"
	       "        $n_continue((const double (*)[$c])poly, 0.0, part, 1.0 / (s->size * $N_H), k);\n"
	       "        if (!$n_solve(s%s%s, part * s->size, unit, k))\n"
	       "            break;\n"
	       "        s->size *= part;\n"
	       "        s->per = 1.0 / s->size;\n"
	       "        (void)$n_finish(s->start, s->size * $N_H, unit, k, poly, s->gain);\n"
	       "        end = limit < %s * s->size ? limit / s->size : %s;\n"
	       "    }\n", AGAIN, shortest(1 - near), single ? "1e-8" : "1e-15", samples, jacobian, shortest(1 + near),
	    shortest(1 + near));
	say(e, "    s->contact.last = crossing;\n"
	       "    s->stop = 3;\n"
	       "    s->ready = 0;\n"
	       "    if (theta * s->size < %s) {\n"
	       "        s->size = 0.0;\n"
	       "        return -2;\n"
	       "    }\n"
	       "    for (again = 0; again < crossing.expression; again++)\n"
	       "        b += $n_breaks[again];\n"
	       "    $n_move_end(s%s, (const double (*)[$c])poly, c, theta, $n_breakpoint[b + crossing.breakpoint]);\n"
	       "    return 0;\n"
	       "}\n", single ? "1e-8" : "1e-15", samples_to_watch(e));
}

/* ---- the whole ---- */

void emit_passage(const struct emitter *e)
{
	if (!is_divided(e))
		return;
	emit_passing_table(e);
	emit_here(e);
	emit_along(e);
	if (e->step->expansion)
		emit_locate(e);
	else
		emit_place_here(e);
	emit_left(e);
	emit_move_end(e);
	emit_pass(e);
}
