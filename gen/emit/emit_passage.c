/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Formulas that the state chooses beside the collocation: what the runtime (passage.h) is told of them. */
#include "emit/emit.h"

static int expressions(const struct emitter *e)
{
	return e->step->divided->expressions;
}

void emit_passing_table(const struct emitter *e)
{
	const char *column = "";
	for (int i = 0; i < expressions(e); i++)
		column = format("%s%s%d", column, i ? ", " : "", i);
	say(e, "\n/* Along a step of the collocation */\n"
	       "static const int $n_each[] = {%s};\n"
	       "static const pl_divided $n_passing = {\n"
	       "    %d, %d, %d, $n_each, $n_breaks, $n_breakpoint\n"
	       "};\n", column, expressions(e), expressions(e), e->step->collocation->stages);
}

void emit_passage_limits(const struct emitter *e)
{
	say(e, "#define PL_CHANGES %d  /* of intervals, until all of them stand */\n"
	       "#define PL_MAX_EVENTS $N_MAX_EVENTS\n"
	       "#define PL_MAX_SPLITS %d\n"
	       "#define PL_WATCH_READS %d  /* known numbers */\n",
	    most_changes(e->step->divided), MAX_SPLITS, watch_reads_known(e));
}
