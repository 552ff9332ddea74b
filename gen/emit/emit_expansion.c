/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps by the Taylor series of the solution: its sum, how far it holds, steps as long as its last terms allow. */
#include "emit/emit.h"

static const struct expansion *expansion(const struct emitter *e)
{
	return e->step->expansion;
}

static const struct truncation *truncation(const struct emitter *e)
{
	return &e->model->truncation;
}

static bool changes(const struct emitter *e)
{
	return e->system->segments > 1;
}

/* ---- its sum ---- */

/* g0, g1, ...: c[1] + theta (c[2] + ...) of each state, by Horner's rule */
static void emit_horner(const struct emitter *e, const char *c, int degree)
{
	int states = e->system->states;
	for (int i = 0; i < states; i++)
		say(e, "    double g%d = %s[%d][%d];\n", i, c, degree, i);
	for (int k = degree - 1; k > 0; k--)
		for (int i = 0; i < states; i++)
			say(e, "%sg%d = g%d * theta + %s[%d][%d];%s", i % 4 ? " " : "    ", i, i, c, k, i,
			    i % 4 == 3 || i == states - 1 ? "\n" : "");
}

void emit_polynomial(const struct emitter *e, const char *name, int rows, int degree)
{
	int states = e->system->states;
	say(e, "static void $n_%s(const double c[%d][$c], double theta, double gain[$N_STATES])\n"
	       "{\n", name, rows);
	if (!is_written_out(e, degree)) {
		say(e, "    int i, k;\n"
		       "    for (i = 0; i < $N_STATES; i++)\n"
		       "        gain[i] = c[%d][i];\n"
		       "    for (k = %d; k > 0; k--)\n"
		       "        for (i = 0; i < $N_STATES; i++)\n"
		       "            gain[i] = gain[i] * theta + c[k][i];\n"
		       "    for (i = 0; i < $N_STATES; i++)\n"
		       "        gain[i] *= theta;\n"
		       "}\n", degree, degree - 1);
		return;
	}
	emit_horner(e, "c", degree);
	for (int i = 0; i < states; i++)
		say(e, "    gain[%d] = g%d * theta;\n", i, i);
	say(e, "}\n");
}

void emit_series_ahead(const struct emitter *e)
{
	const char *unit = spans_steps(e) ? format("%d ", truncation(e)->over) : "";
	say(e, "\n/* What the series gains from its start, theta %sh later */\n", unit);
	emit_polynomial(e, "ahead", expansion(e)->order + 1, expansion(e)->order);
}

/* ---- inside a step ---- */

/* Where the search for events gave up: what is not finite may be why. */
static const char *gave_up(const struct emitter *e)
{
	return spell(e, "PL_TOO_MANY_EVENTS | pl_not_finite(c[0], %d * $c)%s", expansion(e)->order + 1,
		     meets_contacts(e) ? " | at.status" : "");
}

/* At the end of a piece: what ended it */
static const char *passed_text(const struct emitter *e)
{
	return spell(e, "        if (meets < 0.0) {\n"
			"            contact->last.expression = -1;\n"
			"            continue;\n"
			"        }\n"
			"%s"
			"%s", meets_contacts(e) ? spell(e, "        from.tau = at.time = done * $N_H;\n"
							 "        if (!pl_events_pass(&$n_events, &at))\n"
							 "            return %s;\n", gave_up(e))
						: spell(e, "        if (!$n_cross(contact, done * $N_H))\n"
							   "            return %s;\n", gave_up(e)),
		     truncation(e)->adaptive ? "        fresh = 1;\n" : "");
}

static const char *series_between(const struct emitter *e, const char *tau, const char *y, const char *c)
{
	return expand_call(e, tau, spell(e, "$n_time(s) + 0.5 * (done + limit) * $N_H"), "segment", "contact->", y, c);
}

static void emit_between_start(const struct emitter *e)
{
	int order = expansion(e)->order;
	bool adaptive = truncation(e)->adaptive, divided = is_divided(e);
	say(e, "\n/* y and what rounding took from it, end h later: 0; or what went wrong, and y as far as it went */\n"
	       "static int $n_between(const $n *s, %s%sdouble end, double y[$N_STATES], double rest[$N_STATES]%s)\n"
	       "{\n"
	       "    double c[%d][$c], gain[$N_STATES], ends[$N_STATES], done = 0.0;\n"
	       "    int i%s%s;\n", driven_parameter(e), adaptive ? "int fresh, " : "",
	    divided ? spell(e, ",\n    $n_contact *contact") : "", order + 1,
	    adaptive ? ", steps = 0" : watches(e) ? ", status = 0" : "",
	    changes(e) ? ", segment = s->segment" : "");
	if (adaptive)
		say(e, "    double longest = 1.0;\n");
	if (meets_contacts(e)) {
		say(e, "    double terms[%d], meets;\n", terms_of_events(e));
		emit_event_room(e, "    ", "y", "rest", "c[0]", "contact");
	} else if (divided) {
		say(e, "    double terms[%d], work[PL_DIVIDED_WORK(%d)], meets;\n"
		       "    int splits = %d;\n", expansion(e)->expressions, order, MAX_SPLITS);
	}
	if (adaptive || !meets_contacts(e))
		emit_input_samples(e);
	if (!meets_contacts(e))
		emit_unread_samples(e);
}

/* Up to which time the formulas hold that t chooses */
static void emit_between_limit(const struct emitter *e)
{
	bool adaptive = truncation(e)->adaptive;
	say(e, "        double limit = end, size;\n");
	if (changes(e))
		say(e, "        for (; segment < %d; segment++) {\n"
		       "            const double change = $n_until(s, segment) / $N_H;\n"
		       "            limit = change < end ? change : end;\n"
		       "            if (limit > done)\n"
		       "                break;\n"
		       "            limit = end;\n"
		       "%s"
		       "        }\n", e->system->segments - 1, adaptive ? "            fresh = 1;\n" : "");
	if (adaptive)
		say(e, "        if (steps++ == %d)\n"
		       "            return PL_TOO_MANY_STEPS;\n", truncation(e)->substeps);
}

/* A part of a step that does not meet the equations is halved. */
static const char *meets_between(const struct emitter *e)
{
	return !e->step->slopes ? "" : spell(e, "        while (size > 1e-9 && !%s)\n"
						"            size *= 0.5;\n",
					     meets_call(e, spell(e, "done * $N_H"),
							spell(e, "$n_time(s) + 0.5 * (done + limit) * $N_H"), "segment",
							"contact->", spell(e, "(const double (*)[$c])c"), "size"));
}

static void emit_between_size(const struct emitter *e)
{
	if (!truncation(e)->adaptive) {
		say(e, "        size = limit - done;\n");
		return;
	}
	say(e, "        size = $n_part(s, (const double (*)[$c])c);\n"
	       "        if (size == 0.0)\n"
	       "            return PL_NOT_FINITE;\n"
	       "        size = size < longest ? size : longest;\n"
	       "        size = size < limit - done ? size : limit - done;\n"
	       "%s"
	       "        for (longest *= 2.0; fresh; longest = 2.0 * size) {\n"
	       "            double d[%d][$c], next[$N_STATES]%s;\n"
	       "            $n_ahead((const double (*)[$c])c, size, gain);\n"
	       "            for (i = 0; i < $N_STATES; i++)\n"
	       "                next[i] = y[i] + gain[i];\n"
	       "            %s\n"
	       "            fresh = !$n_agrees(s, (const double (*)[$c])c, "
	       "(const double (*)[$c])d, size);\n"
	       "            size *= fresh ? 0.5 : 1.0;\n"
	       "            fresh = fresh && size > 1e-9;\n"
	       "        }\n", meets_between(e),
	    expansion(e)->order + 1, is_divided(e) ? format(", spare[%d]", terms_of_events(e)) : "",
	    series_between(e, spell(e, "(done + size) * $N_H"), "next", "d"));
}

/* The series, behind what happens where it begins */
static void emit_begin_series(const struct emitter *e)
{
	say(e, "        from.tau = at.time = done * $N_H;\n"
	       "        from.when = $n_time(s) + 0.5 * (done + limit) * $N_H;\n"
	       "        i = pl_events_begin(&$n_events, &at);\n"
	       "        if (i < 0)\n"
	       "            return %s;\n"
	       "        if (i > 0)%s\n"
	       "            continue;\n"
	       "%s", gave_up(e), truncation(e)->adaptive ? " {\n            fresh = 1;" : "",
	    truncation(e)->adaptive ? "        }\n" : "");
}

/* From now over a part of the step: substeps, crossings, and changes of the loads on the way */
static void emit_between(const struct emitter *e)
{
	bool divided = is_divided(e);
	emit_between_start(e);
	say(e, "    while (done < end) {\n");
	emit_between_limit(e);
	if (meets_contacts(e))
		emit_begin_series(e);
	else
		say(e, "        %s\n", series_between(e, spell(e, "done * $N_H"), "y", "c"));
	if (divided && !meets_contacts(e))
		say(e, "        if (pl_divided_left(&$n_divided, c[0], terms, contact->interval, &contact->last)) {\n"
		       "            if (!$n_cross(contact, done * $N_H))\n"
		       "                return %s;\n"
		       "            continue;\n"
		       "        }\n", gave_up(e));
	emit_between_size(e);
	if (meets_contacts(e))
		say(e, "        meets = pl_events_next(&$n_events, &at, &size, &splits);\n"
		       "        if (splits < 0)\n"
		       "            return %s;\n"
		       "        if (meets >= 0.0)\n"
		       "            size = meets;\n", gave_up(e));
	else if (divided)
		say(e, "        meets = pl_divided_next(&$n_divided, c[0], terms, contact->interval, size, &splits,\n"
		       "            &contact->last, work);\n"
		       "        if (splits < 0)\n"
		       "            return %s;\n"
		       "        if (meets >= 0.0)\n"
		       "            size = meets;\n", gave_up(e));
	if (watches(e))
		say(e, "        if (!$n_is_accurate(s, (const double (*)[$c])c, size))\n"
		       "            status = PL_INACCURATE;\n");
	say(e, "        $n_ahead((const double (*)[$c])c, size, gain);\n");
	say(e, "        for (i = 0; i < $N_STATES; i++)\n"
	       "            ends[i] = y[i] + gain[i];\n"
	       "        if (pl_not_finite(ends, $N_STATES))\n"
	       "            return PL_NOT_FINITE%s;\n"
	       "        for (i = 0; i < $N_STATES; i++)\n"
	       "            y[i] = pl_accumulate(y[i], gain[i], 0.0, &rest[i]);\n"
	       "        done = size < limit - done ? done + size : limit;\n"
	       "%s"
	       "    }\n"
	       "    return %s%s;\n"
	       "}\n", watches(e) ? " | PL_INACCURATE" : "", divided ? passed_text(e) : "",
	    watches(e) ? "status" : meets_contacts(e) ? "" : "0",
	    !meets_contacts(e) ? "" : watches(e) ? " | at.status" : "at.status");
}

/* ---- the step ---- */

bool expansion_places(const struct emitter *e)
{
	return looks_at_tolerance(e) || spans_steps(e) || is_divided(e);
}

/* A state below it is as one that is 0. */
static const char *least_scale(const struct emitter *e)
{
	return !truncation(e)->adaptive || shares_kinds(e) ? "0.0" : e->model->asked.single ? "1e-25" : "1e-40";
}

void emit_expansion_place(const struct emitter *e)
{
	if (!expansion_places(e))
		return;
	emit_floors(e);
	if (shares_kinds(e)) {
		emit_state_table(e);
		emit_measure(e, "y");
	}
	say(e, "\n/* What follows from a state that was set */\n"
	       "static void $n_place($n *s)\n"
	       "{\n");
	if (looks_at_tolerance(e) || is_divided(e))
		say(e, "    int i;\n");
	if (truncation(e)->adaptive)
		say(e, "    s->served = s->valid = s->most = 0;\n");
	else if (spans_steps(e))
		say(e, "    s->served = 0;\n");
	if (looks_at_tolerance(e)) {
		say(e, "    for (i = 0; i < $N_STATES; i++) {\n"
		       "        s->scale[i] = %s;\n"
		       "        s->unit[i] = 0.0;\n", least_scale(e));
		if (!shares_kinds(e))
			emit_series_scales(e, "        ");
		say(e, "    }\n"
		       "%s", shares_kinds(e) ? spell(e, "    $n_measure(s);\n") : "");
		for (int i = 0; i < expansion(e)->measured; i++)
			say(e, "    s->scale[$N_STATES + %d] = s->unit[$N_STATES + %d] = 0.0;\n", i, i);
	}
	if (is_divided(e))
		emit_divided_place(e);
	say(e, "}\n");
}

static const char *u_argument(const struct emitter *e)
{
	return e->system->inputs ? "u, " : "";
}

static void emit_expansion_end(const struct emitter *e)
{
	emit_step_end(e);
	const char *again = truncation(e)->adaptive ? "s->most = 0;\n        " : "";
	if (changes(e))
		say(e, "    while (s->segment < %d && $n_until(s, s->segment) <= 1e-18 * $N_H)%s\n"
		       "        %ss->segment++;\n%s", e->system->segments - 1, *again ? " {" : "", again,
		    *again ? "    }\n" : "");
	say(e, "}\n");
}

/* The k-th coefficient of a state in the step itself, or of the array c; NULL: it is 0 */
static const char *term_of_gain(const struct emitter *e, int state, int k)
{
	return expands_in_step(e) && !watches(e) ? coefficient(e, state, k) : format("c[%d][%d]", k, state);
}

/* What is not finite is not kept: the state stays as it was. */
static void emit_keep(const struct emitter *e, bool watched)
{
	int states = e->system->states;
	say(e, "    ");
	say_wrapped(e, format("if (%s) {  /* one of them is not finite */\n", is_not_finite(e, "next", "")));
	say(e, "        s->status |= PL_NOT_FINITE%s;\n"
	       "    } else {\n", watched ? " | PL_INACCURATE" : "");
	for (int i = 0; i < states; i++)
		say(e, "        s->y[%d] = next%d;\n"
		       "        s->rest[%d] = rest%d;\n", i, i, i, i);
	if (watched) {
		say(e, "        for (i = 0; i < $N_STATES; i++)\n");
		emit_series_scales(e, "            ");
	}
	say(e, "    }\n");
}

/* Without a change of the loads: one way through but for what is kept */
static void emit_straight_step(const struct emitter *e)
{
	bool watched = watches(e), here = expands_in_step(e) && !watched;
	if (here) {
		say(e, "    const double *const y = s->y;\n");
		emit_coefficients(e);
	} else {
		say(e, "    double c[%d][$c];\n", expansion(e)->order + 1);
		emit_input_samples(e);
		if (watched)
			say(e, "    int i;\n");
	}
	for (int i = 0; i < e->system->states; i++)
		say(e, "    double rest%d = s->rest[%d]%s;\n", i, i, here ? "" : format(", next%d", i));
	if (!here)
		say(e, "    %s\n", expand_call(e, "", "", "", "", "s->y", "c"));
	for (int i = 0; i < e->system->states; i++) {
		say(e, "    ");
		const char *now = here ? coefficient(e, i, 0) : format("s->y[%d]", i);
		say_wrapped(e, format("%snext%d = pl_accumulate(%s, %s, &rest%d);\n", here ? "const double " : "", i,
				      now, whole_gain(e, i, term_of_gain), i));
	}
	if (watched)
		say(e, "    if (!$n_is_accurate(s, (const double (*)[$c])c))\n"
		       "        s->status |= PL_INACCURATE;\n");
	emit_keep(e, watched);
}

static void emit_fixed_step(const struct emitter *e)
{
	bool scales = has_offset(e) && watches(e);
	say(e, "\nvoid $n_step(%s)\n"
	       "{\n", step_parameters(e));
	if (!has_offset(e)) {
		emit_straight_step(e);
	} else {
		say(e, "%s", scales ? "    int i;\n" : "");
		emit_divided_start(e, "s->contact", "    ");
		say(e, "    s->status |= $n_between(s, %s1.0, s->y, s->rest%s);\n", u_argument(e),
		    is_divided(e) ? ", &s->contact" : "");
	}
	if (scales) {
		say(e, "    for (i = 0; i < $N_STATES; i++)\n");
		emit_series_scales(e, "        ");
	}
	emit_expansion_end(e);
}

/* m^2 to m^order, each from two before it: then no more than a product and sums wait for the last coefficient */
static void emit_powers(const struct emitter *e, int order)
{
	for (int k = 2; k <= order; k++)
		say(e, "%sm%d = m%s * m%s%s", k == 2 ? "    const double " : (k - 2) % 6 ? ", " : ",\n        ", k,
		    k < 4 ? "" : format("%d", k / 2), k - k / 2 < 2 ? "" : format("%d", k - k / 2),
		    k == order ? ";\n" : "");
}

static const char *term_of_end(int state, int k)
{
	return format("c[%d][%d] * m%s", k, state, k == 1 ? "" : format("%d", k));
}

static void emit_end(const struct emitter *e)
{
	enum { LATE = 2 };              /* of at least 4 */
	int order = expansion(e)->order, states = e->system->states;
	say(e, "\n/* The state m steps after the start of the series, and what rounding takes from it */\n"
	       "static void $n_end(const double c[%d][$c], double m, double end[$N_STATES], "
	       "double rest[$N_STATES])\n"
	       "{\n", order + 1);
	if (!is_written_out(e, order)) {
		say(e, "    double gain[$N_STATES];\n"
		       "    int i;\n"
		       "    $n_ahead(c, m, gain);\n"
		       "    for (i = 0; i < $N_STATES; i++)\n"
		       "        end[i] = pl_accumulate(c[0][i], gain[i], 0.0, &rest[i]);\n"
		       "}\n");
		return;
	}
	emit_powers(e, order);
	for (int i = 0; i < states; i++) {
		const char *text = "", *late = "";
		for (int k = order; k > order - LATE; k--)
			late = plus(late, term_of_end(i, k));
		for (int k = order - LATE; k > 1; k--)
			text = plus(text, term_of_end(i, k));
		say(e, "    ");
		say_wrapped(e, format("end[%d] = pl_accumulate(c[0][%d], %s, %s + %s, &rest[%d]);\n", i, i,
				      term_of_end(i, 1), text, late, i));
	}
	say(e, "}\n");
}

static void emit_scales_now(const struct emitter *e)
{
	if (shares_kinds(e)) {
		say(e, "    $n_measure(s);\n");
		return;
	}
	say(e, "    for (i = 0; i < $N_STATES; i++)\n");
	emit_series_scales(e, "        ");
}

/* A new series. The loads' next change bounds the steps that it serves; conditions on t are decided before it, in the
 * middle, where time is on one side of them also when it is late, or float. */
static void emit_renew(const struct emitter *e)
{
	bool inputs = e->system->inputs > 0;
	const char *when = spell(e, "$n_time(s) + 0.5 * $N_H");
	say(e, "\n/* A new series from here, and how many steps it serves */\n"
	       "static void $n_renew(%s)\n"
	       "{\n", step_parameters(e));
	if (changes(e)) {
		say(e, "    const double change = s->segment < %d ? $n_until(s, s->segment) : %d.0 * $N_H;\n",
		    e->system->segments - 1, most_served(e));
		when = spell(e, "$n_time(s) + 0.5 * (change < $N_H ? change : $N_H)");
	}
	say(e, "    int i;\n");
	if (is_divided(e))
		say(e, "    double terms[%d];\n", terms_of_events(e));
	emit_input_samples(e);
	emit_scales_now(e);
	say(e, "    %s\n", expand_call(e, "0.0", when, "s->segment", "s->contact.", "s->y", "s->series"));
	emit_column_scales(e);
	say(e, "    i = s->most ? $n_reach(s) : 0;\n"
	       "    s->valid = i < s->most ? i : s->most;\n"
	       "    s->most = s->valid ? 2 * s->valid : s->most;\n");
	if (changes(e))
		say(e, "    if (change < (double)s->valid * $N_H)\n"
		       "        s->valid = (int)(change / $N_H);\n");
	emit_divided_bound(e);
	if (e->step->slopes)
		say(e, "    while (s->valid && !%s)\n"
		       "        s->valid /= 2;\n", meets_call(e, "0.0", when, "s->segment", "s->contact.",
							       spell(e, "(const double (*)[$c])s->series"),
							       "(double)s->valid"));
	say(e, "    s->served = 0;\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        s->base[i] = s->left[i] = s->rest[i];\n"
	       "    if (s->valid) {\n"
	       "        $n_end((const double (*)[$c])s->series, (double)s->valid, s->next, s->left);\n"
	       "        ");
	say_wrapped(e, format("if (%s)\n", is_written_out(e, expansion(e)->order)
						    ? is_not_finite(e, "s->next[", "]")
						    : spell(e, "pl_not_finite(s->next, $N_STATES)")));
	say(e, "            s->valid = s->most = 0;\n"
	       "    }\n");
	if (inputs)
		say(e, "    (void)u;\n");
	say(e, "}\n");
}

bool serves_rows(const struct emitter *e)
{
	return expansion(e) && !e->step->collocation && truncation(e)->adaptive && !e->system->inputs;
}

/* A function of its own, so that NAME_run goes from one to the next without a step's questions */
static void emit_inside(const struct emitter *e)
{
	int order = expansion(e)->order, states = e->system->states;
	say(e, "\n/* A step whose end lies inside of what the series serves */\n"
	       "static void $n_inside($n *s)\n"
	       "{\n"
	       "    const double theta = (double)(s->served + 1);\n");
	if (is_written_out(e, order)) {
		emit_horner(e, "s->series", order);
		for (int i = 0; i < states; i++)
			say(e, "    s->y[%d] = s->series[0][%d] + (g%d * theta + s->base[%d]);\n", i, i, i, i);
	} else {
		say(e, "    double gain[$N_STATES];\n"
		       "    int i;\n"
		       "    $n_ahead((const double (*)[$c])s->series, theta, gain);\n"
		       "    for (i = 0; i < $N_STATES; i++)\n"
		       "        s->y[i] = s->series[0][i] + (gain[i] + s->base[i]);\n");
	}
	say(e, "    s->served++;\n");
	if (is_divided(e))
		say(e, "    s->contact.crossings = 0;\n");
	emit_step_end(e);
	say(e, "}\n");
}

static void emit_adaptive_step(const struct emitter *e)
{
	bool inputs = e->system->inputs > 0;
	emit_end(e);
	emit_renew(e);
	if (serves_rows(e))
		emit_inside(e);
	say(e, "\nvoid $n_step(%s)\n"
	       "{\n"
	       "    int i;\n", step_parameters(e));
	if (is_divided(e)) {
		say(e, "    if (s->served == s->valid) {\n");
		emit_divided_start(e, "s->contact", "        ");
		say(e, "        $n_renew(s%s);\n"
		       "    }\n"
		       "    s->contact.crossings = 0;\n", inputs ? ", u" : "");
	} else {
		say(e, "    if (s->served == s->valid)\n"
		       "        $n_renew(s%s);\n", inputs ? ", u" : "");
	}
	if (serves_rows(e))
		say(e, "    if (s->served + 1 < s->valid) {\n"
		       "        $n_inside(s);\n"
		       "        return;\n"
		       "    }\n");
	say(e, "    if (s->valid == 0) {\n"
	       "        s->status |= $n_between(s, %s!s->most, 1.0, s->y, s->rest%s);\n"
	       "        s->most = 1;\n"
	       "    } else {\n"
	       "        s->served = s->valid;\n"
	       "        for (i = 0; i < $N_STATES; i++) {\n"
	       "            s->y[i] = s->next[i];\n"
	       "            s->rest[i] = s->left[i];\n"
	       "        }\n"
	       "    }\n", u_argument(e), is_divided(e) ? ", &s->contact" : "");
	emit_expansion_end(e);
}

void emit_expansion_members(const struct emitter *e)
{
	if (truncation(e)->adaptive)
		say(e, "    double series[%d][$c];  /* the last expansion, in powers of time over h */\n"
		       "    double base[$N_STATES];  /* what rounding had taken there */\n"
		       "    double next[$N_STATES], left[$N_STATES];  /* where it ends; what rounding took there */\n"
		       "    int served, valid;    /* steps since then; steps that it serves */\n"
		       "    int most;             /* that the next one may serve; 0: nothing is known of it */\n",
		    expansion(e)->order + 1);
	if (spans_steps(e))
		emit_over_members(e);
	if (looks_at_tolerance(e))
		say(e, "    double scale[$c], unit[$c];  "
		       "/* the largest size of each state so far; 1 over it */\n");
	if (is_divided(e))
		emit_divided_members(e);
}

void emit_expansion_step(const struct emitter *e)
{
	if (reads_channels(e->model))
		emit_leftover_functions(e);
	emit_force_table(e);
	emit_expand_function(e);
	emit_series_ahead(e);
	emit_validity(e);
	if (is_divided(e))
		emit_divided_functions(e);
	if (has_offset(e))
		emit_between(e);
	(truncation(e)->adaptive ? emit_adaptive_step : spans_steps(e) ? emit_over_step : emit_fixed_step)(e);
	if (is_divided(e))
		emit_divided_questions(e);
}

/* ---- between steps ---- */

/* At a part of the series that the step is of, or that one begins with */
static void emit_at_over(const struct emitter *e, const char *y)
{
	int over = truncation(e)->over;
	say(e, "    if (s->served > 0) {\n"
	       "        const double theta = ((double)s->served + tau / $N_H) / %d.0;\n"
	       "        $n_ahead((const double (*)[$c])s->series, theta, gain);\n"
	       "        for (i = 0; i < $N_STATES; i++)\n"
	       "            %s[i] = s->series[0][i] + (gain[i] + s->rest[i]);\n"
	       "    } else {\n"
	       "        double c[%d][$c];\n"
	       "        %s\n"
	       "        $n_ahead((const double (*)[$c])c, tau / (%d.0 * $N_H), gain);\n"
	       "        for (i = 0; i < $N_STATES; i++)\n"
	       "            %s[i] = s->y[i] + (gain[i] + s->rest[i]);\n"
	       "    }\n", over, y, expansion(e)->order + 1, expand_call(e, "", "", "", "", "s->y", "c"), over, y);
}

void emit_expansion_at(const struct emitter *e)
{
	bool relative = e->model->relative != NULL, adaptive = truncation(e)->adaptive, offset = has_offset(e);
	const char *y = relative ? "x" : "y", *margin = adaptive ? "    " : "";
	say(e, "\nvoid $n_at(const $n *s, %sdouble tau, double y[$N_STATES])\n"
	       "{\n"
	       "    double %s%s[$N_STATES];\n"
	       "    int i;\n", driven_parameter(e), relative ? format("x[%s_STATES], ", e->upper) : "",
	    offset ? "rest" : "gain");
	if (spans_steps(e)) {
		emit_at_over(e, y);
	} else if (!offset) {
		say(e, "    double c[%d][$c];\n", expansion(e)->order + 1);
		emit_input_samples(e);
		say(e, "    %s\n", expand_call(e, "", "", "", "", "s->y", "c"));
		say(e, "    $n_ahead((const double (*)[$c])c, tau / $N_H, gain);\n"
		       "    for (i = 0; i < $N_STATES; i++)\n"
		       "        %s[i] = s->y[i] + (gain[i] + s->rest[i]);\n", y);
	}
	if (adaptive)
		say(e, "    if (s->served < s->valid) {\n"
		       "        double gain[$N_STATES];\n"
		       "        $n_ahead((const double (*)[$c])s->series, (double)s->served + tau / $N_H, "
		       "gain);\n"
		       "        for (i = 0; i < $N_STATES; i++)\n"
		       "            %s[i] = s->series[0][i] + (gain[i] + s->base[i]);\n"
		       "    } else {\n", y);
	if (offset && is_divided(e)) {
		say(e, "%s    $n_contact here = s->contact;\n", margin);
		emit_divided_start(e, "here", format("%s    ", margin));
	}
	if (offset)
		say(e, "%s    for (i = 0; i < $N_STATES; i++) {\n"
		       "%s        %s[i] = s->y[i];\n"
		       "%s        rest[i] = s->rest[i];\n"
		       "%s    }\n"
		       "%s    $n_between(s, %s%stau / $N_H, %s, rest%s);\n", margin, margin, y, margin, margin,
		    margin, u_argument(e), adaptive ? "!s->most, " : "", y, is_divided(e) ? ", &here" : "");
	if (adaptive)
		say(e, "    }\n");
	if (relative)
		say(e, "    $n_written(s, x, y);\n");
	say(e, "}\n");
}
