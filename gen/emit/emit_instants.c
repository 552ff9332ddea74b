/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regions beside loads that change their formula in time: from change to change within a step. The number of a region
 * in pl_contact then has its segment of time as the last interval, so that a change goes to the region with the same
 * intervals in the next segment; what has left its interval by that, the search finds at the start of the stretch. */
#include "emit/emit.h"

static int segments_of(const struct emitter *e)
{
	return e->model->switching->segments;
}

static int regions_in_one(const struct emitter *e)
{
	return regions_at_once(e->model->switching);
}

static bool has_guards(const struct emitter *e)
{
	return has_events(e->model->switching);
}

/* The region of x in a segment of time */
static void emit_start(const struct emitter *e)
{
	bool own = e->model->retuned;
	say(e, "\n"
	       "/* The region of x in a segment of time */\n"
	       "static void $o_start(%sint segment, const double x[%d], pl_contact *contact, double *work)\n"
	       "{\n"
	       "    %s here = $o_switching%s;\n"
	       "    here.matrix += segment * %d;\n",
	    own ? spell(e, "const $n_coeffs *c, ") : "", size_of_vector(e), search_of(e),
	    own ? "(c, segment)" : "[segment]",
	    regions_in_one(e));
	if (has_guards(e))
		say(e, "    here.first += segment * %d;\n"
		       "    here.hold += segment * %d;\n", regions_in_one(e), regions_in_one(e));
	say(e, "    %s_start(&here, x, contact, work);\n"
	       "    contact->region += segment * %d;\n"
	       "}\n", search_by(e), regions_in_one(e));
}

/* Whether a region can occur before a change and, by its inequalities, not after it */
static bool any_lost(const struct emitter *e)
{
	const struct switching *s = e->model->switching;
	int in_one = regions_in_one(e);
	bool any = false;
	for (int r = 0; r + in_one < s->regions; r++)
		any = any || !s->region[r + in_one].possible;
	return any;
}

static void emit_change(const struct emitter *e)
{
	bool lost = any_lost(e), own = lost && e->model->retuned;
	say(e, "\n"
	       "/* The same intervals after the next change%s */\n"
	       "static void $o_next_segment(%s%spl_contact *contact%s)\n"
	       "{\n"
	       "    contact->region += %d;\n",
	    lost ? "; where they cannot be then, the equations of the region where x is" : "",
	    own ? spell(e, "const $n_coeffs *c, ") : "",
	    lost ? format("const double x[%d], ", size_of_vector(e)) : "", lost ? ", double *work" : "",
	    regions_in_one(e));
	if (lost)
		say(e, "    if ($o_matrix[contact->region] < 0) {\n"
		       "        pl_contact now;\n"
		       "        $o_start(%scontact->region / %d, x, &now, work);\n"
		       "        contact->matrix = now.matrix;\n"
		       "        return;\n"
		       "    }\n", own ? "c, " : "", regions_in_one(e));
	say(e, "    contact->matrix = $o_matrix[contact->region];\n"
	       "}\n");
}

/* Of what sticks and bounces the change is decided at once, also at a step's end, where outputs read it. */
static void emit_decided_change(const struct emitter *e)
{
	say(e, "        here = $o_switching%s;\n"
	       "        here.max_events -= count;\n"
	       "        %s_change(&here, done, x, contact, crossing + count, work);\n"
	       "        count += contact->crossings;\n",
	    e->model->retuned ? "(&s->coeffs, segment + 1)" : "[segment + 1]", search_by(e));
}

void emit_region_changes(const struct emitter *e)
{
	bool guards = has_guards(e);
	if (e->model->switching->expressions > 0)
		emit_start(e);          /* of a linear part there is one region */
	emit_change(e);
	say(e, "\n"
	       "/* x on by tau, from change to change of the loads%s */\n"
	       "static void $o_pass_changes(const $n *s, double tau, double x[%d], pl_contact *contact,\n"
	       "                            pl_crossing *crossing, double *work)\n"
	       "{\n"
	       "    double done = 0.0;\n"
	       "    int count = 0, i;\n"
	       "    for (;;) {\n"
	       "        const int segment = contact->region / %d;\n"
	       "        const double change = segment < %d ? $n_until(s, segment) : %s;\n"
	       "        const double to = change < tau ? change : tau;\n"
	       "        %s here = $o_switching%s;\n"
	       "        here.max_events -= count;\n"
	       "        %s_advance(&here, to - done, x, contact, crossing + count, work);\n",
	    guards ? "; one at its end too" : "", size_of_vector(e), regions_in_one(e), segments_of(e) - 1,
	    guards ? spell(e, "2.0 * $N_H") : "tau", search_of(e),
	    e->model->retuned ? "(&s->coeffs, segment)" : "[segment]", search_by(e));
	say(e, "        for (i = count; i < count + contact->crossings; i++)\n"
	       "            crossing[i].time += done;\n"
	       "        count += contact->crossings;\n"
	       "        if (!(change %s tau))\n"
	       "            break;\n"
	       "        if (to > done)\n"
	       "            done = to;\n"
	       "        $o_next_segment(%scontact%s);\n", guards ? "<=" : "<", !any_lost(e)	      ? ""
	    : e->model->retuned ? "&s->coeffs, x, "
				: "x, ",
	    any_lost(e) ? ", work" : "");
	if (guards)
		emit_decided_change(e);
	say(e, "    }\n"
	       "    contact->crossings = count;\n"
	       "}\n");
}
