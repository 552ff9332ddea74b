/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regions whose tables an instance has: what NAME_retune gathers of them for steps that stay clear. */
#include "emit/emit.h"

static void emit_added(const struct emitter *e, int stays)
{
	if (stays > 0)
		say(e, "        for (i = 0; i < %d; i++) {\n"
		       "            c->added[k][i] = 0.0;\n"
		       "            for (j = 0; j < %d; j++)\n"
		       "                c->added[k][i] += c->pieces[k][i][stays[j]] * at[j];\n"
		       "            if (!(pl_magnitude(c->added[k][i]) < %s))\n"
		       "                c->large[k] = 0.0;\n"
		       "        }\n", e->system->states, stays, shortest(LARGE_ENOUGH));
}

static void emit_still(const struct emitter *e, int stays)
{
	const struct linear *system = e->system;
	if (!any_still(e->step))
		return;
	say(e, "        for (i = 0; i < %d; i++) {\n"
	       "            const double *const off = c->chord_off[k][i];\n"
	       "            double still = 0.0;\n", e->model->switching->expressions);
	for (int l = 0; l < system->loads; l++)
		if (is_bounded_load(e->step, l) && system->load[l].columns == 2)
			say(e, "            still += $n_folded(off[%d], off[%d]);\n", e->step->layout.load[l],
			    e->step->layout.load[l] + 1);
	if (stays > 0)
		say(e, "            for (j = 0; j < %d; j++)\n"
		       "                still += off[stays[j]] * pl_magnitude(at[j]);\n", stays);
	say(e, "            c->still[k][i] = still * 1.000000001;\n"
	       "        }\n");
}

static void emit_edges(const struct emitter *e, int stays)
{
	say(e, "    for (i = 0; i < %d; i++) {\n"
	       "        double shift = 0.0;\n", e->model->switching->expressions);
	if (stays > 0)
		say(e, "        for (j = 0; j < %d; j++)\n"
		       "            shift += c->row[i][stays[j]] * at[j];\n", stays);
	say(e, "        c->edge[edge++] = -%s;\n"
	       "        for (j = 0; j < $n_breaks[i]; j++)\n"
	       "            c->edge[edge++] = c->breakpoint[from++] - shift;\n"
	       "        c->edge[edge++] = %s;\n"
	       "    }\n", shortest(OPEN_END), shortest(OPEN_END));
}

static bool any_pair(const struct emitter *e)
{
	bool any = false;
	for (int l = 0; l < e->system->loads; l++)
		any = any || (is_bounded_load(e->step, l) && e->system->load[l].columns == 2);
	return any;
}

void emit_gathering(const struct emitter *e)
{
	int stays, *column = staying_columns(e->step, &stays);
	if (any_pair(e))
		say(e, "\n"
		       "/* At least the root of a^2 + b^2 */\n"
		       "static double $n_folded(double a, double b)\n"
		       "{\n"
		       "    return a > b ? a + %s * b : b + %s * a;\n"
		       "}\n", shortest(FOLDED), shortest(FOLDED));
	say(e, "\n"
	       "/* For steps that stay clear: what stays of x, and bounds over what is never above 1 */\n"
	       "static void $n_gather($n_coeffs *c)\n"
	       "{\n");
	for (int k = 0; k < stays; k++)
		say(e, "%s%d%s", k ? ", " : format("    static const int stays[%d] = {", stays), column[k],
		    k == stays - 1 ? "};\n" : "");
	if (stays > 0)
		say(e, "    double at[%d];\n", stays);
	say(e, "    int i, j, %sfrom = 0, edge = 0;\n", any_still(e->step) ? "k, " : "");
	for (int k = 0; k < stays; k++) {
		int param = param_of_column(e->step, column[k]);
		say(e, "    at[%d] = %s;\n", k, param < 0 ? "1.0" : format("c->params[%d]", param));
	}
	if (any_still(e->step)) {
		say(e, "    for (k = 0; k < %d; k++) {\n", e->step->branches);
		emit_added(e, stays);
		emit_still(e, stays);
		say(e, "    }\n");
	}
	emit_edges(e, stays);
	say(e, "}\n");
}
