/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What coefficients may not show, functions that are all but constant over most of their range, and loads that may
 * cancel: what reach.h and unseen.h of the runtime are told of them. */
#include "emit/emit.h"

#include <math.h>

static const struct expansion *unseens(const struct emitter *e)
{
	return e->step->unseen;
}

/* How many h of loads that may cancel each other are followed: so much of the phase of the fastest */
static double crowded_length(const struct emitter *e, double phase)
{
	return phase / (unseens(e)->crowded * mpq_get_d(e->model->h));
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

/* ---- what reach.h is told ---- */

void emit_unseen_sizes(const struct emitter *e)
{
	const double rise = 0.5 * unseens(e)->order;
	say(e, "#define PL_HIDDEN %d\n"
	       "#define PL_BEATS %s\n"
	       "#define PL_RISES %s\n"
	       "#define PL_RISES_FACTOR %s\n", traces(e) ? unseens(e)->unseens : 0,
	    shortest(crowds(e) ? crowded_length(e, rise) : 0), shortest(rise), shortest(exp(rise)));
}

void emit_hidden_table(const struct emitter *e)
{
	if (traces(e))
		emit_unseen_table(e, "hidden", true);
}

/* ---- along a step of the collocation ---- */

double crowded_steps(const struct emitter *e)
{
	return crowded_length(e, 2 * e->step->collocation->stages);
}

void emit_arguments(const struct emitter *e)
{
	if (traces(e))
		emit_unseen_table(e, "argument", false);
}
