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

/* How many h of loads that may cancel each other are followed: so much of the phase of the fastest */
static const char *crowded_length(const struct emitter *e, double phase)
{
	return shortest(phase / (unseens(e)->crowded * mpq_get_d(e->model->h)));
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
	       "    if (kind == %d)  /* high powers of sin and cos */\n"
	       "        return moves <= rise;\n"
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
	       "}\n", UNSEEN_TEETH, UNSEEN_ARC, UNSEEN_RISE, nothing, UNSEEN_SPREAD, UNSEEN_TURN, flat, UNSEEN_ARC);
}

/* The argument of each, by its kind */
static void emit_unseen_table(const struct emitter *e, const char *name, bool columns)
{
	const struct expansion *x = unseens(e);
	const char *text = "";
	for (int i = 0; i < x->unseens; i++)
		text = format("%s%s{%d, %d, %d}", text, i == 0 ? "" : i % 6 ? ", " : ",\n    ",
			      columns ? x->unseen[i].column : i, x->unseen[i].kind, x->unseen[i].power);
	say(e, "\n/* Of functions that coefficients may not show: where the argument stands, the kind, a power */\n"
	       "static const int $n_%s[%d][3] = {\n    %s\n};\n", name, x->unseens, text);
}

static void emit_argument_functions(const struct emitter *e)
{
	if (!traces(e))
		return;
	emit_moves(e);
	emit_bounds(e);
	emit_follows(e);
}

void emit_meets_function(const struct emitter *e)
{
	int order = e->step->expansion->order;
	mpq_t bound, times;
	mpq_inits(bound, times, NULL);
	mpq_set_si(times, 2 * order, 1);
	mpq_mul(bound, e->model->truncation.tolerance, times);
	say(e, "\n/* Whether the series c has, `size` and half of it from its start, the slopes that the equations "
	       "have there */\n"
	       "static int $n_meets(const $n *s, %sconst double c[%d][$c], double size)\n"
	       "{\n"
	       "    double gain[$N_STATES], y[$N_STATES], left[$N_STATES], theta = size;\n"
	       "    int i, k, place;\n"
	       "    for (place = 0; place < 2; place++) {\n"
	       "        $n_ahead(c, theta, gain);\n"
	       "        for (i = 0; i < $N_STATES; i++)\n"
	       "            y[i] = c[0][i] + gain[i];\n"
	       "        $n_slopes(s, %sy, left);\n", series_parameters(sloping(e)), order + 1,
	    series_arguments(sloping(e), spell(e, "tau + theta * $N_H"), "when", "segment", AS_CALLED_HERE, ""));
	say(e, "        for (i = 0; i < $N_STATES; i++) {\n"
	       "            double slope_here = 0.0, large = pl_magnitude(y[i]);\n"
	       "            for (k = %d; k > 0; k--)\n"
	       "                slope_here = slope_here * theta + (double)k * c[k][i];\n"
	       "            if (s->unit[i] > 0.0 && large * s->unit[i] < 1.0)\n"
	       "                large = 1.0 / s->unit[i];\n"
	       "            if (!(pl_magnitude(left[i] - slope_here) * theta <= %s * large + %s * "
	       "pl_magnitude(left[i]) "
	       "* theta))\n"
	       "                return 0;\n"
	       "        }\n"
	       "        theta *= 0.5;\n"
	       "    }\n"
	       "    return 1;\n"
	       "}\n", order, shortest(round_rational(bound)), e->model->asked.single ? "1e-5" : "1e-13");
	mpq_clears(bound, times, NULL);
}

const char *meets_call(const struct emitter *e, const char *tau, const char *when, const char *segment,
		       const char *contact, const char *c, const char *size)
{
	enum input_names names = e->step->collocation ? AS_CALLED_HERE : AS_SAMPLES;
	const char *arguments = series_arguments(sloping(e), tau, when, segment, names, contact);
	return format("%s_meets(s, %s%s, %s)", e->name, arguments, c, size);
}

void emit_shows(const struct emitter *e)
{
	if (e->step->slopes) {
		emit_slopes_function(sloping(e));
		emit_meets_function(e);
	}
	if (!has_unseen(e))
		return;
	int order = unseens(e)->order;
	emit_argument_functions(e);
	if (traces(e))
		emit_unseen_table(e, "hidden", true);
	say(e, "\n/* Whether the coefficients show what the equations do over `size` from their start */\n"
	       "static int $n_shows(const double c[%d][$c], double size)\n"
	       "{\n"
	       "%s", order + 1, traces(e) ? "    int i;\n" : "");
	if (crowds(e))
		say(e, "    if (size > %s)  /* loads that may cancel */\n"
		       "        return 0;\n", crowded_length(e, 0.5 * order));
	if (traces(e))
		say(e, "    for (i = 0; i < %d; i++)\n"
		       "        if (!$n_follows(&c[0][$n_hidden[i][0]], $c, %d, size, $n_hidden[i][1], "
		       "%s / (double)$n_hidden[i][2], %s))\n"
		       "            return 0;\n"
		       "    return 1;\n"
		       "}\n", unseens(e)->unseens, order, shortest(0.5 * order), shortest(exp(0.5 * order)));
	else
		say(e, "    (void)c;\n"
		       "    (void)size;\n"
		       "    return 1;\n"
		       "}\n");
}

/* ---- what reach.h is told ---- */

void emit_unseen_sizes(const struct emitter *e)
{
	const double rise = 0.5 * unseens(e)->order;
	say(e, "#define PL_HIDDEN %d\n"
	       "#define PL_BEATS %s\n"
	       "#define PL_RISES %s\n"
	       "#define PL_RISES_FACTOR %s\n", traces(e) ? unseens(e)->unseens : 0,
	    crowds(e) ? crowded_length(e, rise) : "0.0", shortest(rise), shortest(exp(rise)));
}

void emit_hidden_table(const struct emitter *e)
{
	if (traces(e))
		emit_unseen_table(e, "hidden", true);
}

/* ---- along a step of the collocation ---- */

const char *crowded_steps(const struct emitter *e)
{
	return crowded_length(e, 2 * e->step->collocation->stages);
}

void emit_arguments(const struct emitter *e)
{
	if (!traces(e))
		return;
	if (!e->step->expansion)
		emit_argument_functions(e);
	emit_unseen_table(e, "argument", false);
}
