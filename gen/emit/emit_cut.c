/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Schemes with a leftover from crossing to crossing: a whole step by the scheme's own tables, a look at it from both
 * ends, and a step that crosses a breakpoint again, in parts of any length. */
#include "emit/emit.h"

static const struct cut *cut_of(const struct emitter *e)
{
	return e->step->cut;
}

static bool changes(const struct emitter *e)
{
	return e->system->segments > 1;
}

static int expressions(const struct emitter *e)
{
	return cut_of(e)->look->expressions;
}

/* ---- the header ---- */

void emit_cut_types(const struct emitter *e)
{
	emit_divided_types(looking(e));
}

/* What a step ends with, the next begins with, unless inputs or formulas of time change in between. */
static bool keeps_look(const struct emitter *e)
{
	return e->system->inputs == 0 && !changes(e);
}

void emit_cut_members(const struct emitter *e)
{
	emit_divided_members(looking(e));
	if (keeps_look(e))
		say(e, "    double end[2][%d], terms[%d];  /* of each expression at the end of the last step */\n"
		       "    int ended;            /* they are there */\n", expressions(e), expressions(e));
}

void emit_cut_declarations(const struct emitter *e)
{
	emit_divided_declarations(looking(e));
}

void emit_cut_place(const struct emitter *e)
{
	say(e, "\n/* What follows from a state that was set */\n"
	       "static void $n_place($n *s)\n"
	       "{\n"
	       "    int i;\n");
	emit_divided_place(looking(e));
	say(e, "%s"
	       "}\n", keeps_look(e) ? "    s->ended = 0;\n" : "");
}

/* ---- a part of a step ---- */

static void emit_flow_tables(const struct emitter *e)
{
	const struct layout *layout = &cut_of(e)->layout;
	const char **name = layout_names(layout, e->system, e->model);
	for (int i = 0; i < e->system->states; i++)
		name[i] = format("%s'", name[i]);
	say(e, "\n/* x' = A x; x = y, then what acts on it, then each force with two derivatives%s */\n"
	       "static const double $n_flow[%d][%d][%d] = {\n", changes(e) ? "; in each segment of time" : "",
	    e->system->segments, layout->size, layout->size);
	for (int k = 0; k < e->system->segments; k++) {
		say(e, "  {\n");
		emit_number_rows(e, layout->size, layout->size, cut_of(e)->slopes[k], name);
		say(e, "  },\n");
	}
	say(e, "};\n");
}

static void emit_part_type(const struct emitter *e)
{
	say(e, "\ntypedef struct $n_part {  /* of a step */\n"
	       "    const $n *s;\n"
	       "%s"
	       "    double when;          /* a time in it */\n"
	       "%s"
	       "    const int *interval;\n"
	       "} $n_part;\n",
	    e->system->inputs ? "    const double *u, *slope;  /* inputs at the start of the step, their slopes */\n"
			      : "",
	    changes(e) ? "    int segment;          /* of time */\n" : "");
}

/* The load states and inputs at a time of the step */
static void emit_acting(const struct emitter *e)
{
	const struct layout *layout = &cut_of(e)->layout;
	bool *wanted = ARRAY(bool, (size_t)e->system->loads), time = false;
	for (int l = 0; l < e->system->loads; l++) {
		wanted[l] = layout->load[l] >= 0;
		time = time || (wanted[l] && e->system->load[l].powers > 1);
	}
	say(e, "    const $n *const s = p->s;\n");
	if (time)
		say(e, "    const double t = $n_time(s) + tau;\n");
	struct emitter here = *e;
	here.after = "tau";
	emit_load_states(&here, wanted, true);
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && wanted[l]; k++) {
			const char *value = load_operand(e, l, k);
			say(e, "    acting[%d] = %s;\n", layout->load[l] + k - layout->states, value ? value : "1.0");
		}
	for (int i = 0; i < e->system->inputs; i++) {
		int at = layout->input[i] - layout->states;
		bool ramp = e->system->input[i].hold;
		say(e, "    acting[%d] = p->u[%d]%s;\n", at, i, ramp ? format(" + tau * p->slope[%d]", i) : "");
		if (ramp)
			say(e, "    acting[%d] = p->slope[%d];\n", at + 1, i);
	}
	say(e, "    (void)s;\n");
}

static void emit_part(const struct emitter *e)
{
	const struct layout *layout = &cut_of(e)->layout;
	int size = layout->size, channels = e->model->channels, acting = size - layout->states - CUT_POWERS * channels;
	emit_part_type(e);
	say(e, "\nstatic void $n_forces(const void *from, double tau, const double *y, double *left)\n"
	       "{\n"
	       "    const $n_part *const p = (const $n_part *)from;\n"
	       "    %s\n"
	       "}\n", frozen_call(forcing(e), "within", "p->s", "tau", "p->", "y", "left"));
	say(e, "\n/* The state so long after `tau` of the step, by the fourth order scheme with tables made here; not "
	       "0:\n"
	       " * it is not finite */\n"
	       "static int $n_advance(const $n_part *p, double tau, double length, const double y[$N_STATES],\n"
	       "    double next[$N_STATES])\n"
	       "{\n"
	       "    static const pl_cut cut = {$N_STATES, %d, %d, %s, $n_forces};\n"
	       "    double acting[%s, work[PL_CUT_WORK(%d, %d)];\n"
	       "    pl_two room[PL_CUT_ROOM(%d)];\n", size, channels, shortest(cut_of(e)->fastest),
	    acting ? format("%d]", acting) : "1] = {0.0}", size, channels, size);
	emit_acting(e);
	say(e, "    return pl_cut_advance(&cut, $n_flow[%s][0], acting, p, tau, length, y, next, work, room)\n"
	       "        || pl_not_finite(next, $N_STATES);\n"
	       "}\n", changes(e) ? "p->segment" : "0");
}

/* ---- where a step crosses a breakpoint ---- */

static const char *segment_of(const struct emitter *e)
{
	return changes(e) ? "p->segment" : "";
}

/* Expands from a part: what it is given are locals here */
static void emit_look(const struct emitter *e)
{
	const struct emitter *l = looking(e);
	const struct expansion *x = cut_of(e)->look;
	bool input = any_of(x->input, e->system->inputs), slope = any_of(x->slope, e->system->inputs);
	say(e, "\nstatic void $n_look(const $n_part *p, double tau, const double y[$N_STATES], double c[%d][%s],\n"
	       "    double terms[%d])\n"
	       "{\n"
	       "    const $n *const s = p->s;\n", x->order + 1, l->columns, x->expressions);
	if (input)
		say(e, "    const double *const %s = p->u;\n", e->ramps ? "start" : "u");
	if (slope || (input && e->ramps))
		say(e, "    const double *const slope = p->slope;\n");
	say(e, "    %s\n"
	       "}\n", expand_call(l, "tau", "p->when", segment_of(e), "p->", "y", "c"));
}

static void emit_end_call(const struct emitter *e, const char *indent, const char *p, const char *tau, const char *y,
			  const char *result)
{
	say(e, "%s%s\n", indent, spell(e, frozen_call(ending(e), "end", "s", tau, p, y, result)));
}

/* Where a pole turns by much in a step, cubics of whole steps say nothing of what it does within. */
static bool is_swift(const struct emitter *e)
{
	return cut_of(e)->certain < 1;
}

/* Of the sizes that are summed: what rests on its breakpoint does not leave it. */
static const char *noise(const struct emitter *e)
{
	return e->model->asked.single ? "1e-6" : "1e-14";
}

static const char *stays_call(const struct emitter *e, const char *interval, const char *size, const char *noise)
{
	int count = expressions(e);
	const char *more = is_swift(e) ? format(", %s,\n                terms, %s", size, noise) : "";
	return spell(e, "$n_stays((const double (*)[%d])c, (const double (*)[%d])d, %s%s)", count, count, interval,
		     more);
}

/* The cubic with values and slopes of both ends is as exact as the step, and lies within its Bezier points. */
static void emit_stays(const struct emitter *e)
{
	int count = expressions(e);
	bool swift = is_swift(e);
	const char *above = swift ? ">=" : ">", *below = swift ? "<=" : "<";
	say(e, "\n/* Whether no expression comes near the end of its interval, from one end of a %s to the other%s */\n"
	       "static int $n_stays(const double c[4][%d], const double d[2][%d], const int interval[%d]%s)\n"
	       "{\n"
	       "    const double *at = $n_breakpoint;\n"
	       "    int i;\n"
	       "    for (i = 0; i < %d; at += $n_breaks[i++]) {\n"
	       "        const double a = c[0][i], b = a + %sc[1][i] / 3.0, z = d[0][i], y = z - %sd[1][i] / 3.0;\n"
	       "        if (interval[i] > 0) {\n"
	       "            const double low = at[interval[i] - 1]%s;\n"
	       "            if (!(a %s low && b %s low && y %s low && z %s low))\n"
	       "                return 0;\n"
	       "        }\n"
	       "        if (interval[i] < $n_breaks[i]) {\n"
	       "            const double high = at[interval[i]]%s;\n"
	       "            if (!(a %s high && b %s high && y %s high && z %s high))\n"
	       "                return 0;\n"
	       "        }\n"
	       "    }\n"
	       "    return 1;\n"
	       "}\n", swift ? "part" : "step", swift ? ", but for\n * `noise` of its terms" : "", count, count,
	    count,
	    swift ? format(",\n    double size, const double terms[%d], double noise", count) : "", count,
	    swift ? "size * " : "", swift ? "size * " : "",
	    swift ? " - noise * terms[i]" : "", above, above, above, above, swift ? " + noise * terms[i]" : "", below,
	    below, below, below);
}

static void emit_meets(const struct emitter *e)
{
	int count = expressions(e);
	const char *place = "";
	for (int i = 0; i < count; i++)
		place = format("%s%s%d", place, i ? ", " : "", i);
	say(e, "\nstatic const int $n_place_of[] = {%s};\n"
	       "static const pl_divided $n_chord = {%d, %d, 3, $n_place_of, $n_breaks, $n_breakpoint};\n",
	    place, count, count);
	emit_stays(e);
	say(e, "\n/* When, in a part of this size [h], an expression first leaves its interval; -1: none does.\n"
	       " * c: as at its start, then the cubic of each; d: as at its end */\n"
	       "static double $n_meets(double c[4][%d], const double d[2][%d], const double terms[%d], double size,\n"
	       "    const int interval[%d], int *splits, pl_crossing *crossing)\n"
	       "{\n"
	       "    double work[PL_DIVIDED_WORK(3)];\n"
	       "    int i;\n"
	       "    for (i = 0; i < %d; i++) {\n"
	       "        const double rise = (d[0][i] - c[0][i]) / size;\n"
	       "        c[2][i] = (3.0 * rise - 2.0 * c[1][i] - d[1][i]) / size;\n"
	       "        c[3][i] = (c[1][i] + d[1][i] - 2.0 * rise) / (size * size);\n"
	       "    }\n"
	       "    return pl_divided_next(&$n_chord, c[0], terms, interval, size, splits, crossing, work);\n"
	       "}\n", count, count, count, count, count);
}

/* What a part's own end is off the breakpoint that it was to meet is of the size of the error: a Taylor polynomial
 * bridges it. */
static void emit_onto(const struct emitter *e)
{
	const struct emitter *l = looking(e);
	const struct expansion *x = cut_of(e)->look;
	say(l, "\n/* From `at` of the step [h], onto the breakpoint of `crossing`, back by half of `size` or on by\n"
	       " * `left` at most; returns by how much [h] */\n"
	       "static double $n_onto(const $n_part *p, double at, double size, double left,\n"
	       "    const pl_crossing *crossing, double y[$N_STATES])\n"
	       "{\n"
	       "    double c[%d][$c], terms[%d], moved = 0.0;\n"
	       "    int i, again, place = crossing->breakpoint;\n"
	       "    const int k = $n_column[crossing->expression];\n"
	       "    for (i = 0; i < crossing->expression; i++)\n"
	       "        place += $n_breaks[i];\n"
	       "    for (again = 0; again < 4; again++) {\n"
	       "        double theta, off;\n"
	       "        $n_look(p, (at + moved) * $N_H, y, c, terms);\n"
	       "        off = c[0][k] - $n_breakpoint[place];\n"
	       "        if (!(crossing->upward ? c[1][k] > 0.0 : c[1][k] < 0.0))\n"
	       "            break;\n"
	       "        theta = -off / c[1][k];\n"
	       "        theta -= c[2][k] / c[1][k] * theta * theta;\n"
	       "        if (!(pl_magnitude(theta) <= 0.5 * size) || moved + theta < -0.5 * size ||\n"
	       "            moved + theta > left)\n"
	       "            break;\n"
	       "        for (i = 0; i < $N_STATES; i++)\n"
	       "            y[i] += theta * (c[1][i] + theta * c[2][i]);\n"
	       "        moved += theta;\n"
	       "        if (pl_magnitude(theta) <= 1e-15)\n"
	       "            break;\n"
	       "    }\n"
	       "    return moved;\n"
	       "}\n", x->order + 1, x->expressions);
}

/* ---- from crossing to crossing ---- */

static void emit_part_of_step(const struct emitter *e)
{
	say(e, "    $n_part part;\n");
	emit_input_samples(looking(e));
}

static void emit_fill_part(const struct emitter *e, const char *contact)
{
	const struct expansion *x = cut_of(e)->look;
	bool input = any_of(x->input, e->system->inputs), slope = any_of(x->slope, e->system->inputs);
	say(e, "    part.s = s;\n");
	if (e->system->inputs)
		say(e, "    part.u = %s;\n"
		       "    part.slope = %s;\n", input && e->ramps ? "start" : "u",
		    slope || (input && e->ramps) ? "slope" : "NULL");
	say(e, "    part.when = $n_time(s) + 0.5 * $N_H;\n"
	       "    part.interval = %sinterval;\n", contact);
	if (changes(e))
		say(e, "    part.segment = s->segment;\n");
}

static void emit_between_limit(const struct emitter *e)
{
	say(e, "        double limit = end, size, meets;\n");
	if (changes(e))
		say(e, "        for (; part.segment < %d; part.segment++) {\n"
		       "            const double change = $n_until(s, part.segment) / $N_H;\n"
		       "            limit = change < end ? change : end;\n"
		       "            if (limit > done)\n"
		       "                break;\n"
		       "            limit = end;\n"
		       "        }\n"
		       "        part.when = $n_time(s) + 0.5 * (done + limit) * $N_H;\n", e->system->segments - 1);
}

/* Of a step, above what its end is rounded to: shorter parts that are not finite are not tried. */
static const char *shortest_part(const struct emitter *e)
{
	return e->model->asked.single ? "1e-6" : "1e-9";
}

/* What a cubic says of a part that is too long for it is believed where it stays within; else the part is halved. */
static const char *halve_unsure(const struct emitter *e)
{
	return format("            if (size > %s && (meets >= 0.0 || !%s)) {\n"
		      "                longest = 0.5 * size;\n"
		      "                continue;\n"
		      "            }\n",
		      shortest(cut_of(e)->certain), stays_call(e, "contact->interval", "size", noise(e)));
}

static void emit_between(const struct emitter *e)
{
	int count = expressions(e);
	say(e, "\n/* y, end h later, from crossing to crossing; first: that which a step over all of h meets, its\n"
	       " * time in h; NULL: not known.  0, or what went wrong, and y as far as it went */\n"
	       "static int $n_between(const $n *s, %sconst pl_crossing *first, double end, double y[$N_STATES],\n"
	       "    $n_contact *contact)\n"
	       "{\n"
	       "    double c[4][%d], d[2][%d], next[$N_STATES], terms[%d], spare[%d], done = 0.0, longest = 1.0;\n"
	       "    int i, splits = %d;\n"
	       "    pl_crossing found;\n", driven_parameter(e), count, count, count, count, MAX_SPLITS);
	emit_part_of_step(e);
	emit_fill_part(e, "contact->");
	say(e, "    while (done < end) {\n");
	emit_between_limit(e);
	emit_end_call(e, "        ", "part.", "done * $N_H", "y", "c, terms");
	say(e, "        if (pl_divided_left(&$n_chord, c[0], terms, contact->interval, &contact->last)) {\n"
	       "            if (!$n_cross(contact, done * $N_H))\n"
	       "                return PL_TOO_MANY_EVENTS;\n"
	       "            continue;\n"
	       "        }\n"
	       "        limit = limit - done < longest ? limit : done + longest;\n"
	       "        size = limit - done;\n"
	       "        found = contact->last;\n"
	       "        if (first) {\n"
	       "            found = *first;\n"
	       "            meets = found.time;\n"
	       "        } else {\n"
	       "            if ($n_advance(&part, done * $N_H, size * $N_H, y, next)) {\n"
	       "                longest = 0.5 * size;\n"
	       "                if (longest < %s)\n"
	       "                    return PL_NOT_FINITE;\n"
	       "                continue;\n"
	       "            }\n", shortest_part(e));
	emit_end_call(e, "            ", "part.", "limit * $N_H", "next", "d, spare");
	say(e, "            meets = $n_meets(c, (const double (*)[%d])d, terms, size, contact->interval, &splits,\n"
	       "                &found);\n"
	       "            if (splits < 0)\n"
	       "                return PL_TOO_MANY_EVENTS;\n"
	       "%s"
	       "        }\n"
	       "        first = NULL;\n"
	       "        if (meets > 0.0) {\n"
	       "            if ($n_advance(&part, done * $N_H, meets * $N_H, y, next)) {\n"
	       "                longest = 0.5 * meets;\n"
	       "                if (longest < %s)\n"
	       "                    return PL_NOT_FINITE;\n"
	       "                continue;\n"
	       "            }\n"
	       "            meets += $n_onto(&part, done + meets, meets, size - meets, &found, next);\n"
	       "        }\n"
	       "        longest = %s;\n"
	       "        for (i = 0; i < $N_STATES && meets != 0.0; i++)\n"
	       "            y[i] = next[i];\n"
	       "        contact->last = found;\n"
	       "        if (meets < 0.0) {\n"
	       "            contact->last.expression = -1;\n"
	       "            done = limit;\n"
	       "            continue;\n"
	       "        }\n"
	       "        done = meets < size ? done + meets : limit;\n"
	       "        if (!$n_cross(contact, done * $N_H))\n"
	       "            return PL_TOO_MANY_EVENTS;\n"
	       "    }\n"
	       "    return 0;\n"
	       "}\n", count, is_swift(e) ? halve_unsure(e) : "", shortest_part(e), is_swift(e) ? "2.0 * size" : "1.0");
}

/* ---- the step ---- */

static void emit_whole(const struct emitter *e)
{
	say(e, "\n/* The scheme's own step, with the formulas of the intervals that hold */\n"
	       "static void $n_whole(%s, const $n_part *p)\n"
	       "{\n", step_parameters(e));
	emit_actions_of_step(e);
	if (given_inputs(e))
		say(e, "    (void)u;\n");
	say(e, "    (void)p;\n"
	       "}\n");
}

static void emit_restore(const struct emitter *e)
{
	say(e, "        for (i = 0; i < $N_STATES; i++)\n"
	       "            s->y[i] = y[i];\n");
	if (e->step->carries)
		say(e, "        for (i = 0; i < %d; i++)\n"
		       "            s->carry[i] = carry[i];\n", e->step->carries);
}

static void emit_keep_state(const struct emitter *e)
{
	say(e, "    for (i = 0; i < $N_STATES; i++)\n"
	       "        y[i] = s->y[i];\n");
	if (e->step->carries)
		say(e, "    for (i = 0; i < %d; i++)\n"
		       "        carry[i] = s->carry[i];\n", e->step->carries);
}

static void emit_first_look(const struct emitter *e)
{
	if (!keeps_look(e)) {
		emit_end_call(e, "    ", "part.", "0.0", "s->y", "c, terms");
		return;
	}
	say(e, "    if (s->ended) {\n"
	       "        for (i = 0; i < %d; i++) {\n"
	       "            c[0][i] = s->end[0][i];\n"
	       "            c[1][i] = s->end[1][i];\n"
	       "            terms[i] = s->terms[i];\n"
	       "        }\n"
	       "    } else {\n", expressions(e));
	emit_end_call(e, "        ", "part.", "0.0", "s->y", "c, terms");
	say(e, "    }\n");
}

static void emit_keep_look(const struct emitter *e)
{
	if (keeps_look(e))
		say(e, "        for (i = 0; i < %d; i++) {\n"
		       "            s->end[0][i] = d[0][i];\n"
		       "            s->end[1][i] = d[1][i];\n"
		       "            s->terms[i] = spare[i];\n"
		       "        }\n"
		       "        s->ended = 1;\n", expressions(e));
}

/* Where no expression comes near a breakpoint the step stands; else it is looked at closely, and made in parts where
 * one is passed. */
static void emit_step_of_parts(const struct emitter *e)
{
	int count = expressions(e);
	bool swift = is_swift(e);
	const char *u = e->system->inputs ? "u, " : "", *given = given_inputs(e) ? "u, " : "";
	say(e, "\nvoid $n_step(%s)\n"
	       "{\n"
	       "    double c[4][%d], d[2][%d], terms[%d], spare[%d], y[$N_STATES], meets = -1.0;\n"
	       "    int i, whole = 1, splits = %d;\n"
	       "    pl_crossing crossing;\n", step_parameters(e), count, count, count, count, MAX_SPLITS);
	if (e->step->carries)
		say(e, "    double carry[%d];\n", e->step->carries);
	emit_part_of_step(e);
	emit_divided_start(looking(e), "s->contact", "    ");
	emit_fill_part(e, "s->contact.");
	emit_first_look(e);
	emit_keep_state(e);
	say(e, "    $n_whole(s, %s&part);\n", given);
	emit_end_call(e, "    ", "part.", "$N_H", "s->y", "d, spare");
	say(e, "    if (%s%s) {\n"
	       "        s->contact.last.expression = -1;\n"
	       "    } else {\n"
	       "        crossing = s->contact.last;\n"
	       "        whole = %s!pl_divided_left(&$n_chord, c[0], terms, s->contact.interval, &crossing);\n"
	       "        if (whole)\n"
	       "            meets = $n_meets(c, (const double (*)[%d])d, terms, 1.0, s->contact.interval, &splits, "
	       "&crossing);\n"
	       "        crossing.time = meets;\n"
	       "        whole = whole && meets < 0.0 && splits >= 0%s && !pl_not_finite(s->y, $N_STATES);\n"
	       "        if (whole)\n"
	       "            s->contact.last.expression = -1;\n"
	       "    }\n"
	       "    if (!whole) {\n",
	    changes(e) ? spell(e, "(s->segment == %d || $n_until(s, s->segment) >= $N_H) &&\n        ",
			       e->system->segments - 1) : "", stays_call(e, "s->contact.interval", "1.0", "0.0"),
	    changes(e) ? spell(e, "(s->segment == %d || $n_until(s, s->segment) >= $N_H) &&\n            ",
			       e->system->segments - 1) : "", count,
	    swift ? format("\n            && %s", stays_call(e, "s->contact.interval", "1.0", noise(e))) : "");
	emit_restore(e);
	if (keeps_look(e))
		say(e, "        s->ended = 0;\n");
	say(e, "        s->status |= splits < 0 ? PL_TOO_MANY_EVENTS\n"
	       "            : $n_between(s, %s%s, 1.0, s->y, &s->contact);\n", u,
	    swift ? "NULL" : "meets >= 0.0 ? &crossing : NULL");
	if (keeps_look(e)) {
		say(e, "    } else {\n");
		emit_keep_look(e);
	}
	say(e, "    }\n");
	emit_step_end(e);
	if (changes(e))
		say(e, "    while (s->segment < %d && $n_until(s, s->segment) <= 1e-18 * $N_H)\n"
		       "        s->segment++;\n", e->system->segments - 1);
	say(e, "}\n");
}

void emit_cut_step(const struct emitter *e)
{
	const struct emitter *l = looking(e);
	if (reads_channels(e->model))
		emit_leftover_functions(e);
	emit_force_table(l);
	emit_frozen_function(forcing(e));
	emit_ends_function(ending(e));
	emit_expand_from(l);
	emit_divided_functions(l);
	emit_flow_tables(e);
	emit_part(e);
	emit_look(e);
	emit_meets(e);
	emit_onto(e);
	emit_between(e);
	if (e->step->program->loops)
		emit_loop_tables(e);
	emit_whole(e);
	emit_step_of_parts(e);
	emit_divided_questions(l);
}

/* ---- between steps ---- */

void emit_cut_at(const struct emitter *e)
{
	const struct emitter *l = looking(e);
	bool relative = e->model->relative != NULL;
	const char *y = relative ? "x" : "y";
	say(e, "\nvoid $n_at(const $n *s, %sdouble tau, double y[$N_STATES])\n"
	       "{\n"
	       "    $n_contact here = s->contact;\n"
	       "    int i;\n", driven_parameter(e));
	if (relative)
		say(e, "    double x[$N_STATES];\n");
	emit_divided_start(l, "here", "    ");
	say(e, "    for (i = 0; i < $N_STATES; i++)\n"
	       "        %s[i] = s->y[i];\n"
	       "    (void)$n_between(s, %sNULL, tau / $N_H, %s, &here);\n", y, e->system->inputs ? "u, " : "", y);
	if (relative)
		say(e, "    $n_written(s, x, y);\n");
	say(e, "}\n");
}
