/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far a polynomial follows what its coefficients may not show: functions that are all but constant over most of
 * their range. Of the argument of each its polynomial bounds where it goes; over one length it may come nearer to where
 * the function bends by so much as the order resolves: then the last terms tell what follows. */
#include "emit/emit.h"

#include <math.h>

static const struct expansion *unseens(const struct emitter *e)
{
	return e->step->unseen;
}

bool has_unseen(const struct emitter *e)
{
	return unseens(e) != NULL;
}

/* Bounds: those of a quartic by its Bezier points, beside the most that later terms add */
static void emit_bounds(const struct emitter *e)
{
	say(e, "\n/* Bounds of a polynomial of this degree over `size` from its start; the coefficients stand `stride` "
	       "apart */\n"
	       "static void $n_bounds(const double *c, int stride, int degree, double size, double bound[2])\n"
	       "{\n"
	       "    double p[5] = {0.0, 0.0, 0.0, 0.0, 0.0}, b[4], power = 1.0, rest = 0.0;\n"
	       "    int k;\n"
	       "    for (k = 0; k <= degree; k++) {\n"
	       "        const double term = c[k * stride] * power;\n"
	       "        if (k < 5)\n"
	       "            p[k] = term;\n"
	       "        else\n"
	       "            rest += pl_magnitude(term);\n"
	       "        power *= size;\n"
	       "    }\n"
	       "    b[0] = p[0] + 0.25 * p[1];\n"
	       "    b[1] = p[0] + (0.5 * p[1] + p[2] * (1.0 / 6.0));\n"
	       "    b[2] = p[0] + (0.75 * p[1] + 0.5 * p[2] + 0.25 * p[3]);\n"
	       "    b[3] = p[0] + (p[1] + p[2] + p[3] + p[4]);\n"
	       "    bound[0] = bound[1] = p[0];\n"
	       "    for (k = 0; k < 4; k++) {\n"
	       "        bound[0] = b[k] < bound[0] ? b[k] : bound[0];\n"
	       "        bound[1] = b[k] > bound[1] ? b[k] : bound[1];\n"
	       "    }\n"
	       "    bound[0] -= rest;\n"
	       "    bound[1] += rest;\n"
	       "}\n");
}

/* How far a polynomial goes from its start at most: where that is little, nothing else is asked */
static void emit_moves(const struct emitter *e)
{
	say(e, "\n/* No more than this a polynomial of this degree moves over `size` */\n"
	       "static double $n_moves(const double *c, int stride, int degree, double size)\n"
	       "{\n"
	       "    double sum = 0.0;\n"
	       "    int k;\n"
	       "    for (k = degree * stride; k > 0; k -= stride)\n"
	       "        sum = (sum + pl_magnitude(c[k])) * size;\n"
	       "    return sum;\n"
	       "}\n");
}

/* Beyond `flat` tanh is 1 to the last digit, below `nothing` exp is nothing beside whatever it stands with */
static void emit_follows(const struct emitter *e)
{
	bool single = e->model->asked.single;
	const char *flat = single ? "10.0" : "20.0", *nothing = single ? "-30.0" : "-60.0";
	say(e, "\n/* Whether a function with this argument, of this kind, is followed over `size`: `rise` is what an "
	       "exponent\n"
	       " * may gain, e^rise is `factor` */\n"
	       "static int $n_follows(const double *c, int stride, int degree, double size, int kind, double rise,\n"
	       "    double factor)\n"
	       "{\n"
	       "    const double start = pl_magnitude(c[0]);\n"
	       "    const double moves = $n_moves(c, stride, degree, size);\n"
	       "    double bound[2], near, far;\n"
	       "    if (moves <= (kind < %d ? 0.5 * rise : 0.75 * start))\n"
	       "        return 1;\n"
	       "    $n_bounds(c, stride, degree, size, bound);\n"
	       "    near = bound[0] > 0.0 ? bound[0] : bound[1] < 0.0 ? -bound[1] : 0.0;\n"
	       "    far = bound[1] > -bound[0] ? bound[1] : -bound[0];\n"
	       "    switch (kind) {\n"
	       "    case %d:  /* exp */\n"
	       "        return bound[1] <= %s || bound[1] <= c[0] + rise;\n"
	       "    case %d:  /* sinh, cosh */\n"
	       "        return far <= start + rise;\n"
	       "    case %d:  /* tanh */\n"
	       "        return near >= %s || near >= start - 0.5 * rise;\n"
	       "    case %d:  /* atan */\n"
	       "        return 1.0 + start * start <= factor * (1.0 + near * near);\n"
	       "    default:  /* what is divided by, and of log */\n"
	       "        return start <= factor * near;\n"
	       "    }\n"
	       "}\n", UNSEEN_ARC, UNSEEN_RISE, nothing, UNSEEN_SPREAD, UNSEEN_TURN, flat, UNSEEN_ARC);
}

/* The argument of each, by its kind */
static void emit_unseen_table(const struct emitter *e, const char *name, bool columns)
{
	const struct expansion *x = unseens(e);
	const char *text = "";
	for (int i = 0; i < x->unseens; i++)
		text = format("%s%s{%d, %d}", text, i == 0 ? "" : i % 8 ? ", " : ",\n    ",
			      columns ? x->unseen[i].column : i, x->unseen[i].kind);
	say(e, "\n/* Of functions that coefficients may not show: where the argument stands, and the kind */\n"
	       "static const int $n_%s[%d][2] = {\n    %s\n};\n", name, x->unseens, text);
}

static void emit_each(const struct emitter *e, const char *table, const char *stride, int degree, double rise)
{
	say(e, "    int i;\n"
	       "    for (i = 0; i < %d; i++)\n"
	       "        if (!$n_follows(&c[0][$n_%s[i][0]], %s, %d, size, $n_%s[i][1], %s, %s))\n"
	       "            return 0;\n"
	       "    return 1;\n"
	       "}\n", unseens(e)->unseens, table, stride, degree, table, shortest(rise), shortest(exp(rise)));
}

void emit_shows(const struct emitter *e)
{
	if (!has_unseen(e))
		return;
	int order = unseens(e)->order;
	emit_moves(e);
	emit_bounds(e);
	emit_follows(e);
	emit_unseen_table(e, "hidden", true);
	say(e, "\n/* Whether the coefficients show what the equations do over `size` from their start */\n"
	       "static int $n_shows(const double c[%d][$c], double size)\n"
	       "{\n", order + 1);
	emit_each(e, "hidden", spell(e, "$c"), order, 0.5 * order);
}

/* ---- along a step of the collocation ---- */

/* node[] so many h after the internal step's start, where conditions on t hold as they do at `inside` */
static const char *known_at(const struct emitter *e, const char *ahead, const char *inside, const char *indent)
{
	struct emitter here = *e;
	here.ramps = false;             /* samples are called u here */
	const char *at = "(s->at - (double)s->back)";
	return !trace_reads_known(e) ? "" : format("%s%s\n", indent, known_call(&here,
		spell(e, "(%s + %s) * $N_H", at, ahead), spell(e, "(%s + %s) * $N_H", at, inside), "node"));
}

const char *shows_along(const struct emitter *e)
{
	const char *samples = trace_reads_known(e) && e->system->inputs ? ", u, slope" : "";
	return has_unseen(e) ? spell(e, " && !$n_shows_along(s%s, size, (const double (*)[$c])poly)", samples) : "";
}

/* Its nodes see what lies between them where an argument moves by less than would pass over it: an exponent of
 * (3 S / 2)^2 is one of exp(-z^2) for z from -3 S / 2 on, whose nodes are 3 apart. */
void emit_shows_along(const struct emitter *e)
{
	if (!has_unseen(e))
		return;
	int s = e->step->collocation->stages, n = unseens(e)->unseens;
	bool known = trace_reads_known(e);
	if (!e->step->expansion) {
		emit_moves(e);
	emit_bounds(e);
		emit_follows(e);
	}
	emit_unseen_table(e, "argument", false);
	say(e, "\n/* ... whether the nodes of a step of `size` h show it: polynomials through the arguments there and "
	       "at the start */\n"
	       "static int $n_shows_along(const $n *s%s, double size, const double poly[%d][$c])\n"
	       "{\n"
	       "    double c[%d][%d], y[$N_STATES], value[%d];\n"
	       "%s"
	       "%s"
	       "    int i, k, m;\n", known ? samples_parameter(e) : "", s + 1, s + 1, n, n, current_intervals(e),
	    known ? format("    double node[%d];\n", known_values(e)) : "");
	say(e, "%s"
	       "    %s\n"
	       "    for (m = 1; m <= %d; m++)\n"
	       "        for (i = 0; i < %d; i++)\n"
	       "            c[m][i] = 0.0;\n"
	       "    for (k = 0; k < %d; k++) {\n"
	       "%s", known_at(e, "0.0", "0.5 * size", "    "), trace_call(e, "node", "s->start", "c[0]"), s, n, s,
	    known_at(e, spell(e, "$n_node[k] * size"), "0.5 * size", "        "));
	say(e, "        $n_within(poly, $n_node[k], y);\n"
	       "        for (i = 0; i < $N_STATES; i++)\n"
	       "            y[i] += s->start[i];\n"
	       "        %s\n"
	       "        for (i = 0; i < %d; i++) {\n"
	       "            const double slope = (value[i] - c[0][i]) / $n_node[k];\n"
	       "            for (m = 0; m < %d; m++)\n"
	       "                c[m + 1][i] += $n_monomial[m][k] * slope;\n"
	       "        }\n"
	       "    }\n"
	       "%s", trace_call(e, "node", "y", "value"), n, s, known ? "" : "    (void)size;\n");
	say(e, "    for (i = 0; i < %d; i++)\n"
	       "        if (!$n_follows(&c[0][i], %d, %d, 1.0, $n_argument[i][1], %d.0, %s))\n"
	       "            return 0;\n"
	       "    return 1;\n"
	       "}\n", n, n, s, 2 * s, shortest(exp(2 * s)));
}
