/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps in normal modes: what the runtime's normal.h, which the model's file includes, and its within.h are given of
 * them: tables, sums over them, sizes. */
#include "inner.h"
#include "emit/steps.h"
#include "emit/tunable/tunable.h"
#include "model/reads.h"
#include "step/exponential/normal.h"
#include "step/linear/rows.h"
#include "step/exponential/weights.h"

#include <math.h>
#include <string.h>

/* ---- known loads, to which modes respond exactly ---- */

static int forcing_values(const struct emitter *e)
{
	return 2 * e->model->remainder.split->forcings;
}

static bool is_there(const struct emitter *e, int value)
{
	return value % 2 == 0 || oscillates(e->model->remainder.split->forcing[value / 2].forcing);
}

/* Of a load that grows, decays or oscillates: split holds no powers of t */
static const char *forcing_now(const struct emitter *e, int value)
{
	const struct forcing *forcing = e->model->remainder.split->forcing[value / 2].forcing;
	return format("load%d[%d]", load_of_forcing(e->system, forcing) + 1, value % 2);
}

/* NAME_forcings: cos and sin of each now, times e^{a t} */
static void emit_forcings(const struct emitter *e)
{
	int count = forcing_values(e);
	const struct form **form = ARRAY(const struct form *, (size_t)count + 1);
	if (count == 0)
		return;
	for (int k = 0; k < count; k++)
		form[k] = form_unit((struct basis){ .kind = BASIS_FORCING,
						    .forcing = e->model->remainder.split->forcing[k / 2].forcing,
						    .sine = k % 2 && is_there(e, k) });
	struct reads r = reads_of(e->model, count, form);
	open_function(e, "Known loads now", "static void $n_forcings(const $n *s, double forcing[%d])", count);
	emit_load_states(e, r.load, false);
	for (int k = 0; k < count; k++)
		say(e, "    forcing[%d] = %s;\n", k, is_there(e, k) ? forcing_now(e, k) : "0.0");
	close_function(e, "");
}

static void add_forcings(const struct emitter *e, struct summands *s, const char *table, int row)
{
	for (int k = 0; k < forcing_values(e); k++)
		if (is_there(e, k))
			add_summand(s, format("%s[%d][i] * forcing[%d]", table, 2 * k + row, k));
}

/* Of a step by columns of one matrix, theirs from `first` on */
static void add_forcings_of_columns(const struct emitter *e, struct summands *s, int first)
{
	for (int k = 0; k < forcing_values(e); k++)
		if (is_there(e, k))
			add_summand(s, spell(e, "$n_steady[%d][i] * forcing[%d]", first + k, k));
}

/* ---- a stage: modes at a node, or after a step ---- */

/* [stage][schedule][row][place] */
static void emit_stage_table(const struct emitter *e, const char *note, const char *name, int stages, int rows,
			     const double *const *of_stage)
{
	const struct normal *m = normal_of_step(e);
	const size_t each = (size_t)(m->operators * rows * m->width);
	double *value = ARRAY(double, each * (size_t)stages);
	if (rows == 0)
		return;
	for (int i = 0; i < stages; i++)
		memcpy(value + (size_t)i * each, of_stage[i], each * sizeof *value);
	emit_array(e, note, name, 4, (const int[]){ stages, m->operators, rows, m->width }, value, NULL);
}

static void emit_node_tables(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	const size_t stages = (size_t)m->collocation.stages;
	const double **flow = ARRAY(const double *, stages), **weight = ARRAY(const double *, stages);
	const double **forcing = ARRAY(const double *, stages);
	for (size_t i = 0; i < stages; i++) {
		flow[i] = m->collocation.stage[i].flow;
		weight[i] = m->collocation.stage[i].weight;
		forcing[i] = m->collocation.stage[i].forcing;
	}
	emit_stage_table(e, "Modes at each node from those at the step's start", "flow", m->collocation.stages, 4,
			 flow);
	emit_stage_table(e, "... and from modal forces at all nodes: weights of the collocation", "weight",
			 m->collocation.stages, 2 * (m->collocation.stages + 1), weight);
	emit_stage_table(e, "... and from known loads at its start", "of_forcing", m->collocation.stages,
			 2 * forcing_values(e), forcing);
}

/* e eta + s eta', de eta + ds eta', and weights of forces */
static const char *stage_sum(const struct emitter *e, int row, int forces, const char *force)
{
	struct summands s = { 0 };
	add_summand(&s, format("flow[%d][i] * s->eta[i]", 2 * row));
	add_summand(&s, format("flow[%d][i] * s->rate[i]", 2 * row + 1));
	for (int k = 0; k < forces; k++)
		add_summand(&s, format("weight[%d][i] * %s", 2 * k + row, format(force, k)));
	add_forcings(e, &s, "of_forcing", row);
	return sum_of(&s, 21);
}

/* Over a whole step, from past forces, rows of the last node serve but for the weights of forces. */
static void emit_rows_of_node(const struct emitter *e, const char *node, const char *weight)
{
	const char *const row[] = { format("flow[%s]", node), weight, format("of_forcing[%s]", node) };
	for (int i = 0; i < 2 + (forcing_values(e) > 0); i++)
		say(e, "    const double (*const %s)[%d] = $n_%s[which];\n",
		    i == 0 ? "flow" : i == 1 ? "weight" : "of_forcing", normal_of_step(e)->width, row[i]);
}

/* Modes in a loop, and what the force is expected to be; NULL: it is not asked. The end of the function */
static void emit_stage_sums(const struct emitter *e, int forces, const char *force, const char *expected)
{
	say(e, "    int i;\n"
	       "    for (i = 0; i < %d; i++) {\n"
	       "        eta[i] = %s;\n"
	       "        rate[i] = %s;\n"
	       "%s"
	       "    }\n", normal_of_step(e)->width, stage_sum(e, 0, forces, force), stage_sum(e, 1, forces, force),
	    expected ? format("        expected[i] = %s;\n", expected) : "");
	close_function(e, "forcing");
}

static void emit_node_modes(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	emit_node_tables(e);
	open_function(e, NULL,
		      "static inline void $n_node_modes(const $n *s, int which, int node,\n"
		      "    double force[%d][%d], const double forcing[], double eta[], double rate[])",
		      m->collocation.stages + 1, m->width);
	emit_rows_of_node(e, "node - 1", "weight[node - 1]");
	emit_stage_sums(e, m->collocation.stages + 1, "force[%d][i]", NULL);
}

/* From forces at the nodes of the last step, the last of which is the start of this one */
static void emit_forces_ahead(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	const int nodes = m->collocation.stages + 1;
	open_function(e, NULL, "static inline void $n_forces_ahead(const $n *s, double force[%d][%d])", nodes,
		      m->width);
	say(e, "    int i;\n"
	       "    for (i = 0; i < %d; i++) {\n"
	       "        force[0][i] = s->force[%d][i];\n", m->width, m->collocation.stages);
	for (int i = 0; i < m->collocation.stages; i++) {
		struct summands s = { 0 };
		for (int k = 0; k < nodes; k++)
			add_summand(&s, scaled(m->collocation.ahead[i * nodes + k], format("s->force[%d][i]", k)));
		say(e, "        force[%d][i] = %s;\n", i + 1, sum_of(&s, 22));
	}
	say(e, "    }\n");
	close_function(e, "");
}

static void emit_predict(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	struct summands extrapolated = { 0 };
	for (int k = 0; k < m->multistep.points; k++)
		add_summand(&extrapolated, scaled(m->multistep.extrapolate[k], format("force%d[i]", k)));
	emit_array(e, "Modes after a step, from past forces, the last first", "past_weight", 3,
		   (const int[]){ m->operators, 2 * m->multistep.points, m->width }, m->multistep.step.weight, NULL);
	emit_array(e, "What a force adds by its excess over the extrapolated one", "correct", 3,
		   (const int[]){ m->operators, 2, m->width }, m->multistep.correct, NULL);
	open_function(e, NULL, "static inline void $n_predict(const $n *s, int which, const double forcing[],\n"
		      "    double eta[], double rate[], double expected[])");
	emit_rows_of_node(e, format("%d", m->collocation.stages - 1), "past_weight");
	for (int k = 0; k < m->multistep.points; k++)
		say(e, "    const double *const force%d = s->force[%s];\n", k, k == 0 ? "s->newest" :
		    format("s->newest >= %d ? s->newest - %d : s->newest + %d", k, k, m->multistep.points - k));
	emit_stage_sums(e, m->multistep.points, "force%d[i]", sum_of(&extrapolated, 22));
}

/* ---- a schedule ---- */

static void emit_schedule(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	const int last = m->operators - 1;
	double *bound = ARRAY(double, (size_t)m->operators);
	if (!has_schedule(e))
		return;
	for (int b = 0; b < last; b++)
		bound[b] = equation_number(e->model, e->model->schedule.operator[b].at).value;
	emit_array(e, "Values up to which the operators serve, but the last", "bound", 1, &last, bound, NULL);
	emit_array(e, "Modes of the next operator from those of each, beyond what they are themselves", "next", 3,
		   (const int[]){ last, m->width, m->width }, m->turn, NULL);
}

/* ---- once all functions of time are constant ---- */

static void emit_still(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	const int width = m->width;
	double *omega = ARRAY(double, 2 * (size_t)width);
	struct summands s = { 0 };
	for (int i = 0; i < width; i++) {
		omega[i] = m->steady.omega[i];
		omega[width + i] = m->steady.period[i];
	}
	emit_array(e, "Frequencies that amplitudes are scaled by, and 1 over them", "omega", 2,
		   (const int[]){ 2, width }, omega, NULL);
	emit_array(e, format("A step over [omega eta, eta', 1%s], by columns", forcing_values(e) ? ", loads" : ""),
		   "steady", 2, (const int[]){ steady_size(e->model), 2 * width }, m->steady.flow, NULL);
	open_function(e, NULL, "static inline void $n_still(const double x[], const double forcing[], double sum[])");
	say(e, "    int i;\n");
	for (int j = 0; j < 2 * m->modes; j++)
		add_summand(&s, spell(e, "$n_steady[%d][i] * x[%d]", j,
				      (j < m->modes ? 0 : width) + m->place[j % m->modes]));
	add_summand(&s, spell(e, "$n_steady[%d][i]", 2 * m->modes));
	add_forcings_of_columns(e, &s, 2 * m->modes + 1);
	say_row_sum(e, "sum[i]", 2 * width, &s);
	close_function(e, "forcing");
}

/* ---- states inside a step ---- */

/* The next term of known load k, by `by`; `alone`: it has no sin */
static void emit_next_term(const struct emitter *e, int k, bool alone)
{
	const struct forcing *forcing = e->model->remainder.split->forcing[k].forcing;
	const char *a = shortest(equation_number(e->model, forcing->a).value);
	const char *w = shortest(equation_number(e->model, forcing->w).value);
	const int c = 2 * k, s = c + 1;
	if (alone) {
		say(e, "    swing[%d] *= by * %s;\n"
		       "    forcing[%d] += swing[%d];\n", c, a, c, c);
		return;
	}
	const bool grows = mpq_sgn(forcing->a) != 0;
	say(e, "    before = swing[%d];\n"
	       "    swing[%d] = by * (%s%s * swing[%d]);\n"
	       "    swing[%d] = by * (%s%s * before);\n"
	       "    forcing[%d] += swing[%d];\n"
	       "    forcing[%d] += swing[%d];\n", c, c, grows ? format("%s * before - ", a) : "-", w, s, s,
	    grows ? format("%s * swing[%d] + ", a, s) : "", w, c, c, s, s);
}

static void emit_swing(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	const int count = forcing_values(e);
	struct summands sum = { 0 };
	if (count == 0)
		return;
	emit_array(e, "Modal forces of known loads", "swing", 3, (const int[]){ m->operators, count, m->width },
		   m->forcing,
		   NULL);
	open_function(e, NULL,
		      "static inline void $n_swing_on(int which, double by, double forcing[], double swing[],\n"
		      "    double force[])");
	say(e, "    double before = 0.0;\n"
	       "    int i;\n");
	for (int k = 0; k < count; k++)
		if (is_there(e, k))
			add_summand(&sum, spell(e, "$n_swing[which][%d][i] * swing[%d]", k, k));
	say(e, "    for (i = 0; i < %d; i++) { force[i] += %s; }\n", m->width, sum_of(&sum, 20));
	for (int k = 0; k < count; k += 2)
		emit_next_term(e, k / 2, !is_there(e, k + 1));
	close_function(e, "before");
}

static void emit_within(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	const int nodes = m->collocation.stages * m->collocation.stages,
		  past = m->multistep.points * m->multistep.points, size[] = { m->operators, m->width };
	emit_array(e, "Coefficients of the polynomial through forces at nodes, from their differences to the first",
		   "of_nodes", 1, &nodes, m->within.nodes, NULL);
	if (past)
		emit_array(e, "... and through past ones and the new one", "of_past", 1, &past, m->within.past, NULL);
	emit_array(e, "lambda of each mode [1/s^2]", "stiffness", 2, size, m->within.stiffness, NULL);
	if (m->within.damping)
		emit_array(e, "2 delta of each mode [1/s]", "damping", 2, size, m->within.damping, NULL);
	emit_swing(e);
}

static int turns_within(const struct emitter *e)
{
	const double angle = normal_of_step(e)->within.angle;
	return angle > 1 ? (int)ceil(angle) : 1;
}

/* ---- the whole ---- */

/* Tables of a step by collocation that is part of an event-split step */
void emit_mode_sizes(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	const struct size size[] = { { "MODES", m->modes },
				     { "WIDTH", m->width },
				     { "POINTS", 0 },
				     { "STAGES", m->collocation.stages },
				     { "SWEEPS", m->collocation.sweeps },
				     { "FIRST_SWEEPS", m->collocation.first_sweeps },
				     { "FUNCTIONS", 0 },
				     { "FORCINGS", 0 },
				     { "OPERATORS", 1 } };
	for (size_t i = 0; i < sizeof size / sizeof *size; i++)
		say_macro(e, size[i].name, integer_text(size[i].value));
}

/* Tables and functions of the same */
void emit_mode_tables(const struct emitter *e)
{
	emit_to_modes(e);
	emit_from_modes(e);
	emit_forces_on_modes(e);
	emit_node_times(e);
	emit_node_modes(e);
	emit_forces_ahead(e);
}

/* Time moves on before forces at the end of a step are known, and so before there is a state to look at. */
static void emit_advance(const struct emitter *e)
{
	open_function(e, "Advances time and loads by a step",
		      "static inline void $n_pass_time($n *s, const double u[])");
	emit_step_advance(e);
	close_function(e, "u");
	open_function(e, "Looks at the state at the end of a step", "static inline void $n_look($n *s)");
	say(e, "%s", checks_of_step(e));
	close_function(e, "s");
}

static void emit_algorithm(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	emit_sizes(e, "normal.h", { "MODES", m->modes }, { "WIDTH", m->width }, { "POINTS", m->multistep.points },
		   { "TWICE", m->multistep.twice }, { "STAGES", m->collocation.stages },
		   { "SWEEPS", m->collocation.sweeps }, { "FIRST_SWEEPS", m->collocation.first_sweeps },
		   { "FUNCTIONS", functions_of_time(e) }, { "FORCINGS", forcing_values(e) },
		   { "OPERATORS", m->operators },
		   { "SELECTOR", e->model->remainder.split->selector - 1 }, { "SEGMENTS", e->system->segments },
		   { "STEADY", m->steady.flow != NULL }, { "STEADY_IN", m->steady.schedule },
		   { "AT", e->step->series.emitted }, { "TERMS", m->within.terms }, { "TURNS", turns_within(e) },
		   { "DAMPED", m->within.damping != NULL }, { "PEAKS", peak_outputs(e->model) }, { "IN_MODES", 0 });
	say(e, "#include \"normal.h\"\n");
}

void emit_normal_tables(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	emit_to_modes(e);
	emit_from_modes(e);
	if (functions_of_time(e))
		emit_function_values(e);
	emit_forces(e);
	emit_forcings(e);
	emit_schedule(e);
	emit_node_modes(e);
	if (m->multistep.points)
		emit_predict(e);
	else
		emit_forces_ahead(e);
	if (m->steady.flow)
		emit_still(e);
	emit_advance(e);
	if (e->step->series.emitted)
		emit_within(e);
	emit_algorithm(e);
}

void emit_normal_members(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	const char *where = m->multistep.points ? "ends of the last steps" : "nodes of the last step";
	bool past = m->multistep.points || has_schedule(e), alone = keeps_modes(e);
	say(e, "    double eta[%d], rate[%d];  /* normal modes now, and how they change [1/s] */\n"
	       "    double force[%d][%d]; /* on them, at the %s */\n", m->width, m->width, m->kept, m->width, where);
	if (past)
		say(e, "    double past[%d][2][%d];  /* what they were there */\n", m->kept, m->width);
	if (functions_of_time(e) && alone)
		say(e, "    double f[%d][%d];       /* functions of time there */\n", m->kept, functions_of_time(e));
	if (alone)
		say(e, "    int which;            /* operator whose modes they are */\n");
	if (m->multistep.points)
		say(e, "    int newest;           /* of those ends the last */\n");
	say(e, "    int known;            /* how many there are */\n");
}
