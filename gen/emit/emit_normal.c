/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps in normal modes: by collocation, by past forces, and once nothing changes. */
#include "emit/emit.h"

/* ---- a step by collocation ---- */

struct stage_tables { const char *flow, *weight, *wave; };

/* e eta + s eta', de eta + ds eta', and weights of forces: the stage at theta h */
static const char *stage_sum(const struct emitter *e, const struct stage_tables *t, int row, int points,
			     const char *force)
{
	struct row_sum s = { 0 };
	add_summand(&s, format("%s[%d][i] * s->eta[i]", t->flow, 2 * row));
	add_summand(&s, format("%s[%d][i] * s->rate[i]", t->flow, 2 * row + 1));
	for (int k = 0; k < points; k++)
		add_summand(&s, format("%s[%d][i] * %s", t->weight, 2 * k + row, format(force, k)));
	add_waves(e, &s, t->wave, row);
	return tree(s.terms, s.term, 21);
}

static void emit_keep_point(const struct emitter *e, const char *force, const char *f)
{
	const struct normal *m = normal_of_step(e);
	say(e, "    s->newest = s->newest + 1 < %d ? s->newest + 1 : 0;\n"
	       "    s->known += s->known < %d;\n"
	       "    for (i = 0; i < %d; i++) {\n"
	       "        s->force[s->newest][i] = %s[i];\n"
	       "        s->past[s->newest][0][i] = s->eta[i];\n"
	       "        s->past[s->newest][1][i] = s->rate[i];\n"
	       "    }\n", m->points, m->points, m->width, force);
	for (int k = 0; k < functions_of_time(e); k++)
		say(e, "    s->f[s->newest][%d] = %s[%d];\n", k, f, k);
}

/* Of a method of one step, all nodes are kept: forces to extrapolate from, the rest for a change of operator. */
static void emit_keep_nodes(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	say(e, "    for (k = 0; k <= %d; k++) {\n"
	       "        for (i = 0; i < %d; i++) {\n"
	       "            s->force[k][i] = force[k][i];\n", m->stages, m->width);
	if (has_bank(e))
		say(e, "            s->past[k][0][i] = eta[k][i];\n"
		       "            s->past[k][1][i] = rate[k][i];\n");
	say(e, "        }\n");
	for (int k = 0; k < functions_of_time(e); k++)
		say(e, "        s->f[k][%d] = f[k][%d];\n", k, k);
	say(e, "    }\n"
	       "    s->known = %d;\n", m->kept);
}

/* Forces at the nodes to begin with */
static void emit_first_forces(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	int width = m->width, nodes = m->stages + 1;
	if (m->points == 0) {
		say(e, "    if (s->known) {\n"
		       "        sweeps = %d;\n"
		       "        for (i = 0; i < %d; i++) {\n"
		       "            force[0][i] = s->force[%d][i];\n", m->sweeps, width, m->stages);
		for (int i = 0; i < m->stages; i++) {
			struct row_sum s = { 0 };
			for (int k = 0; k < nodes; k++)
				add_summand(&s, scaled(m->ahead[i * nodes + k], format("s->force[%d][i]", k)));
			say(e, "            force[%d][i] = %s;\n", i + 1, tree(s.terms, s.term, 26));
		}
		say(e, "        }\n"
		       "    } else {\n");
	}
	const char *indent = m->points ? "" : "    ";
	say(e, "%s    %s\n"
	       "%s    for (k = 1; k <= %d; k++)\n"
	       "%s        for (i = 0; i < %d; i++)\n"
	       "%s            force[k][i] = force[0][i];\n", indent,
	    mode_forces_call(e, "f[0]", "s->eta", "s->rate", "force[0]"), indent, m->stages, indent, width, indent);
	if (m->points == 0)
		say(e, "    }\n");
}

static void emit_sweeps(const struct emitter *e, const struct stage_tables *table)
{
	const struct normal *m = normal_of_step(e);
	int nodes = m->stages + 1;
	say(e, "    for (sweep = 0; sweep < sweeps; sweep++) {\n");
	for (int i = 0; i < m->stages; i++)
		say(e, "        for (i = 0; i < %d; i++) {\n"
		       "            eta[%d][i] = %s;\n"
		       "            rate[%d][i] = %s;\n"
		       "        }\n"
		       "        %s\n", m->width, i + 1,
		    stage_sum(e, &table[i], 0, nodes, "force[%d][i]"), i + 1,
		    stage_sum(e, &table[i], 1, nodes, "force[%d][i]"),
		    mode_forces_call(e, format("f[%d]", i + 1), format("eta[%d]", i + 1), format("rate[%d]", i + 1),
			     format("force[%d]", i + 1)));
	say(e, "    }\n");
}

static void emit_collocation(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	int stages = m->stages, nodes = stages + 1, width = m->width;
	int functions = functions_of_time(e);
	struct stage_tables *table = ARRAY(struct stage_tables, (size_t)stages);
	for (int i = 0; i < stages; i++) {
		table[i].flow = emit_bank_table(e, format("flow%d", i + 1),
						"Modes at a node from those at the step's start", 4, width,
						m->stage[i].flow);
		table[i].weight = emit_bank_table(e, format("weight%d", i + 1), "... and from the forces at all nodes",
						  2 * nodes, width, m->stage[i].weight);
		table[i].wave = emit_wave_table(e, format("wave%d", i + 1), &m->stage[i]);
	}
	say(e, "\n/* A step by collocation: forces are a polynomial through the nodes, found by so many sweeps */\n"
	       "static void $n_collocate($n *s%s)\n"
	       "{\n"
	       "    double %s%seta[%d][%d], rate[%d][%d];\n"
	       "    const int which = s->which;\n"
	       "    int i, k, sweep, sweeps = %d;\n", m->points ? format(", double force[%d][%d]", nodes, width) : "",
	    functions ? format("f[%d][%d], ", nodes, functions) : "",
	    m->points ? "" : format("force[%d][%d], ", nodes, width), nodes, width, nodes, width,
	    m->first_sweeps);
	say(e, "%s", wave_array(e));
	emit_waves_now(e);
	if (functions)
		say(e, "    for (k = 0; k <= %d; k++)\n"
		       "        %s\n", stages, functions_call(e, "k", false, "f[k]"));
	emit_first_forces(e);
	if (m->points) {
		say(e, "    if (s->known == 0) {\n");
		emit_keep_point(e, "force[0]", "f[0]");
		say(e, "    }\n");
	} else if (has_bank(e)) {
		say(e, "    for (i = 0; i < %d; i++) {\n"
		       "        eta[0][i] = s->eta[i];\n"
		       "        rate[0][i] = s->rate[i];\n"
		       "    }\n", width);
	}
	emit_sweeps(e, table);
	say(e, "    for (i = 0; i < %d; i++) {\n"
	       "        s->eta[i] = eta[%d][i];\n"
	       "        s->rate[i] = rate[%d][i];\n"
	       "    }\n", width, stages, stages);
	emit_step_end(e);
	if (m->points)
		emit_keep_point(e, format("force[%d]", stages), format("f[%d]", stages));
	else
		emit_keep_nodes(e);
	say(e, "}\n");
}

/* ---- a bank ---- */

/* V^T M V is orthogonal: what goes back is transposed */
static void emit_turn(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	int width = m->width, tables = m->banks - 1;
	say(e, "\n/* Modes of the next operator from those of each, beyond what they are themselves */\n"
	       "static const double $n_next[%d][%d][%d] = {\n", tables, width, width);
	for (int b = 0; b < tables; b++) {
		say(e, "  {\n");
		for (int i = 0; i < width; i++) {
			say(e, "    {");
			say_numbers(e, width, m->turn + (b * width + i) * width);
			say(e, "},\n");
		}
		say(e, "  },\n");
	}
	say(e, "};\n"
	       "\nstatic void $n_turn(int from, int to, double mode[%d])\n"
	       "{\n"
	       "    while (from != to) {\n"
	       "        const int up = from < to, at = up ? from : from - 1;\n"
	       "        double more[%d];\n"
	       "        int i, j;\n"
	       "        for (i = 0; i < %d; i++) {\n"
	       "            more[i] = 0.0;\n"
	       "            for (j = 0; j < %d; j++)\n"
	       "                more[i] += (up ? $n_next[at][i][j] : $n_next[at][j][i]) * mode[j];\n"
	       "        }\n"
	       "        for (i = 0; i < %d; i++)\n"
	       "            mode[i] += more[i];\n"
	       "        from += up ? 1 : -1;\n"
	       "    }\n"
	       "}\n", width, width, width, width, width);
}

static void emit_bank(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	if (!has_bank(e))
		return;
	say(e, "\n/* Values up to which the operators serve, but the last */\n"
	       "static const double $n_bound[%d] = {", m->banks - 1);
	for (int b = 0; b + 1 < m->banks; b++)
		say(e, "%s%s", b == 0 ? "" : b % 6 ? ", " : ",\n    ",
		    shortest(equation_number(e->model, e->model->operator[b].at).value));
	say(e, "};\n"
	       "\n/* The first operator whose value is not below this */\n"
	       "static int $n_operator(int which, double now)\n"
	       "{\n"
	       "    while (which < %d && now > $n_bound[which])\n"
	       "        which++;\n"
	       "    while (which > 0 && now <= $n_bound[which - 1])\n"
	       "        which--;\n"
	       "    return which;\n"
	       "}\n", m->banks - 1);
	emit_turn(e);
	say(e, "\n/* From the modes of one operator to those of another: what is kept of the last steps too */\n"
	       "static void $n_serve($n *s, int which)\n"
	       "{\n"
	       "    int k, d;\n"
	       "    $n_turn(s->which, which, s->eta);\n"
	       "    $n_turn(s->which, which, s->rate);\n"
	       "    for (k = 0; k < s->known; k++) {\n"
	       "        for (d = 0; d < 2; d++)\n"
	       "            $n_turn(s->which, which, s->past[k][d]);\n"
	       "        %s\n"
	       "    }\n"
	       "    s->which = which;\n"
	       "}\n", mode_forces_call(e, "s->f[k]", "s->past[k][0]", "s->past[k][1]", "s->force[k]"));
}

/* ---- the step ---- */

static void emit_multistep(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	int points = m->points, width = m->width;
	const struct stage_tables table = {
		emit_bank_table(e, "flow", "Modes after a step from those before", 4, width, m->step.flow),
		emit_bank_table(e, "weight", "... and from the forces at its start and before", 2 * points, width,
				m->step.weight),
		emit_wave_table(e, "wave", &m->step)
	};
	const char *correct = emit_bank_table(e, "correct", "What a force adds by its excess over the extrapolated one",
					      2, width, m->correct);
	struct row_sum extrapolated = { 0 };
	for (int k = 0; k < points; k++)
		add_summand(&extrapolated, scaled(m->extrapolate[k], format("force%d[i]", k)));
	say(e, "\n/* A step from past forces: predict, evaluate, correct%s */\n"
	       "static void $n_advance($n *s%s)\n"
	       "{\n"
	       "    double eta[%d], rate[%d], force[%d], expected[%d]%s;\n"
	       "    const int which = s->which;\n"
	       "    int i, at = s->newest;\n%s", m->twice ? ", evaluate; first: the force of the first time" : "",
	    m->twice ? format(", double first[%d]", width) : "", width, width, width, width,
	    functions_of_time(e) ? format(", f[%d]", functions_of_time(e)) : "", wave_array(e));
	for (int k = 0; k < points; k++)
		say(e, "    const double *const force%d = s->force[at];\n%s", k,
		    k + 1 < points ? format("    at = at ? at - 1 : %d;\n", points - 1) : "");
	emit_waves_now(e);
	say(e, "    for (i = 0; i < %d; i++) {\n"
	       "        eta[i] = %s;\n"
	       "        rate[i] = %s;\n"
	       "        expected[i] = %s;\n"
	       "    }\n", width, stage_sum(e, &table, 0, points, "force%d[i]"),
	    stage_sum(e, &table, 1, points, "force%d[i]"), tree(extrapolated.terms, extrapolated.term, 22));
	emit_step_end(e);
	if (functions_of_time(e))
		say(e, "    %s\n", functions_call(e, "0", true, "f"));
	say(e, "    %s\n"
	       "    for (i = 0; i < %d; i++) {\n"
	       "        const double excess = force[i] - expected[i];\n"
	       "        s->eta[i] = eta[i] + %s[0][i] * excess;\n"
	       "        s->rate[i] = rate[i] + %s[1][i] * excess;\n"
	       "    }\n", mode_forces_call(e, "f", "eta", "rate", "force"), width, correct, correct);
	if (m->twice)
		say(e, "    for (i = 0; i < %d; i++)\n"
		       "        first[i] = force[i];\n"
		       "    %s\n", width, mode_forces_call(e, "f", "s->eta", "s->rate", "force"));
	emit_keep_point(e, "force", "f");
	say(e, "}\n");
}

void emit_normal_tables(const struct emitter *e)
{
	emit_to_modes(e);
	emit_from_modes(e);
	if (functions_of_time(e))
		emit_function_values(e);
	emit_forces(e);
	emit_waves(e);
	emit_bank(e);
	const struct normal *m = normal_of_step(e);
	int selector = e->model->split->selector - 1;
	say(e, "\n/* What follows from a state that was set */\n"
	       "static void $n_place($n *s)\n"
	       "{\n");
	if (has_bank(e))
		say(e, "    double f[%d];\n"
		       "    %s\n"
		       "    s->which = $n_operator(0, f[%d]);\n",
		    functions_of_time(e), functions_call(e, "0", false, "f"), selector);
	else
		say(e, "    s->which = 0;\n");
	say(e, "    s->known = 0;\n%s"
	       "    $n_modes_of(s->which, s->y, s->eta);\n"
	       "    $n_modes_of(s->which, s->y + %d, s->rate);\n"
	       "}\n", m->points ? format("    s->newest = %d;\n", m->points - 1) : "", m->modes);
}

/* ---- once all functions of time are constant ---- */

static void emit_settled(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	int size = settled_size(e->model), width = m->width;
	struct row_sum s = { 0 };
	say(e, "\n/* Frequencies that amplitudes are scaled by, and 1 over them */\n"
	       "static const double $n_omega[2][%d] = {\n    {", width);
	say_numbers(e, width, m->omega);
	say(e, "},\n    {");
	say_numbers(e, width, m->period);
	say(e, "},\n};\n"
	       "\n/* A step over [omega eta, eta', 1%s], by columns */\n"
	       "static const double $n_settled[%d][%d] = {\n", wave_values(e) ? ", loads" : "", size, 2 * width);
	for (int j = 0; j < size; j++) {
		say(e, "    {");
		say_numbers(e, 2 * width, m->settled + j * 2 * width);
		say(e, "},\n");
	}
	say(e, "};\n"
	       "\n/* Nothing changes any more: the step is exact */\n"
	       "static void $n_continue($n *s)\n"
	       "{\n"
	       "    double x[%d], sum[%d];\n"
	       "    int i;\n%s", 2 * width, 2 * width, wave_array(e));
	emit_waves_now(e);
	if (has_bank(e))
		say(e, "    if (s->which != %d)\n"
		       "        $n_serve(s, %d);\n", m->settled_bank, m->settled_bank);
	say(e, "    for (i = 0; i < %d; i++) {\n"
	       "        x[i] = $n_omega[0][i] * s->eta[i];\n"
	       "        x[%d + i] = s->rate[i];\n"
	       "    }\n", width, width);
	for (int j = 0; j < 2 * m->modes; j++)
		add_summand(&s, spell(e, "$n_settled[%d][i] * x[%d]", j,
				      (j < m->modes ? 0 : width) + m->place[j % m->modes]));
	add_summand(&s, spell(e, "$n_settled[%d][i]", 2 * m->modes));
	add_waves_of_columns(e, &s, 2 * m->modes + 1);
	say_row_sum(e, "sum[i]", 2 * width, &s);
	say(e, "    for (i = 0; i < %d; i++) {\n"
	       "        s->eta[i] = $n_omega[1][i] * sum[i];\n"
	       "        s->rate[i] = sum[%d + i];\n"
	       "    }\n"
	       "    s->known = 0;\n", width, width);
	emit_step_end(e);
	say(e, "}\n");
}

/* ---- the whole ---- */

/* Where functions of time change their formula, past forces are of no use: the step starts anew. A change that is not
 * at the end of a step is one of another t0 than 0. */
static void emit_restart(const struct emitter *e)
{
	int points = normal_of_step(e)->points;
	say(e, "    while (s->segment < %d && $n_near(s) && $n_until(s, s->segment) <= 1e-9 * $N_H) {\n"
	       "        if ($n_until(s, s->segment) < -1e-9 * $N_H)\n"
	       "            s->status |= PL_INACCURATE;  /* it was inside the step */\n"
	       "        s->segment++;\n"
	       "        s->known = 0;\n", e->system->segments - 1);
	if (points)
		say(e, "        s->newest = %d;\n", points - 1);
	say(e, "    }\n");
}

static void emit_near(const struct emitter *e)
{
	say(e, "\n/* Whether the next change of formula may be at hand: until then the time in one word is enough */\n"
	       "static int $n_near(const $n *s)\n"
	       "{\n"
	       "    return $n_change[s->segment].hi - $n_time(s) <= $N_H + 1e-6 * $n_change[s->segment].hi;\n"
	       "}\n");
}

void emit_normal_step(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	int points = m->points;
	if (has_changes(e))
		emit_near(e);
	if (reads_channels(e->model))
		emit_leftover(e);
	emit_collocation(e);
	if (points)
		emit_multistep(e);
	if (m->settled)
		emit_settled(e);
	say(e, "\nvoid $n_step($n *s)\n"
	       "{\n");
	if (points)
		say(e, "    double force[%d][%d];  /* on modes, of the first steps */\n", points, m->width);
	if (m->settled)
		say(e, "    if (s->segment == %d) {\n"
		       "        $n_continue(s);\n"
		       "        s->status |= pl_not_finite(s->eta, %d) | pl_not_finite(s->rate, %d);\n"
		       "        return;\n"
		       "    }\n", e->system->segments - 1, m->width, m->width);
	if (points)
		say(e, "    if (s->known < %d)\n"
		       "        $n_collocate(s, force);\n"
		       "    else\n"
		       "        $n_advance(s%s);\n", points, m->twice ? ", force[0]" : "");
	else
		say(e, "    $n_collocate(s);\n");
	if (has_bank(e)) {
		const char *now = format("s->f[%s][%d]", points ? "s->newest" : format("%d", m->stages),
					 e->model->split->selector - 1);
		say(e, "    if ($n_operator(s->which, %s) != s->which)\n"
		       "        $n_serve(s, $n_operator(s->which, %s));\n", now, now);
	}
	if (has_changes(e))
		emit_restart(e);
	say(e, "    s->status |= pl_not_finite(s->eta, %d) | pl_not_finite(s->rate, %d);\n"
	       "}\n", m->width, m->width);
}

void emit_normal_members(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	const char *where = m->points ? "ends of the last steps" : "nodes of the last step";
	bool past = m->points || has_bank(e);
	say(e, "    double eta[%d], rate[%d];  /* normal modes now, and how they change [1/s] */\n"
	       "    double force[%d][%d]; /* on them, at the %s */\n", m->width, m->width, m->kept, m->width, where);
	if (past)
		say(e, "    double past[%d][2][%d];  /* what they were there */\n", m->kept, m->width);
	if (functions_of_time(e))
		say(e, "    double f[%d][%d];       /* functions of time there */\n", m->kept, functions_of_time(e));
	say(e, "    int which;            /* operator whose modes they are */\n");
	if (m->points)
		say(e, "    int newest;           /* of those ends the last */\n");
	say(e, "    int known;            /* how many there are */\n");
}
