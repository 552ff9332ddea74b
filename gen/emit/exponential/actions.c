/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The step of a scheme with a remainder: its program's actions on vectors, unrolled or as loops. */
#include "inner.h"
#include "emit/steps.h"

/* ---- sums and combinations, unrolled ---- */

static const char *combination_at(const struct action *a, const char *place)
{
	if (a->minus == NONE)
		return format("2.0 * remainder%d[%s]", a->plus, place);
	return format("remainder%d[%s] %c remainder%d[%s]", a->plus, place, a->added ? '+' : '-', a->minus, place);
}

static void emit_combination(const struct emitter *e, const struct action *a)
{
	const bool loops = e->step->program->loops;
	if (loops)
		say(e, "    for (i = 0; i < %d; i++) { remainder%d[i] = %s; }\n", e->model->remainder.force_columns,
		    a->target,
		    combination_at(a, "i"));
	for (int c = 0; c < e->model->remainder.force_columns && !loops; c++)
		say(e, "    remainder%d[%d] = %s;\n", a->target, c, combination_at(a, integer_text(c)));
}

/* y(tau) of a table, with Phi y or from rest */
static void add_flow(const struct emitter *e, struct summands *s, const struct table *table, bool from_rest, int row)
{
	for (int j = 0; j < table->states && table->Phi && !from_rest; j++)
		if (!table->Phi[row * table->states + j].zero)
			add_summand(s, scaled(table->Phi[row * table->states + j].value, e->local[j]));
	for (int k = 0; k < table->columns; k++)
		if (!table->load[row * table->columns + k].zero)
			add_summand(s, scaled(table->load[row * table->columns + k].value, column_operand(e, k)));
	for (int k = 0; k < table->inputs; k++)
		if (!table->input[row * table->inputs + k].zero)
			add_summand(s, scaled(table->input[row * table->inputs + k].value, input_operand(e, k)));
}

static void add_products(struct summands *s, const struct coefficient *row, int columns, const char *vector)
{
	for (int j = 0; j < columns; j++)
		if (!row[j].zero)
			add_summand(s, scaled(row[j].value, format("%s[%d]", vector, j)));
}

static void emit_sum(const struct emitter *e, const struct action *a)
{
	struct table *const *table = e->step->branch[0].table;
	const int force_columns = e->model->remainder.force_columns;
	for (int i = 0; i < e->system->states; i++) {
		struct summands s = { 0 };
		if (a->flow != NONE)
			add_flow(e, &s, table[a->flow], false, i);
		if (a->plain != NONE)
			add_summand(&s, format("stage%d[%d]", a->plain, i));
		for (int k = 0; k < a->phi_weights; k++) {
			const struct coefficient *phi_weight =
				table[a->phi_weight[k].table]->phi_weight[a->phi_weight[k].phi_weight];
			add_products(&s, phi_weight + i * force_columns, force_columns,
				     format("remainder%d", a->phi_weight[k].left));
		}
		const char *target = a->target == STAGE_STATE ? "s->y" : vector_name(a->target);
		say(e, "    %s[%d] = %s;\n", target, i, sum_of(&s, 14));
	}
}

static const char *time_of(const struct emitter *e, mpq_srcptr fraction)
{
	bool full = mpq_cmp_ui(fraction, 1, 1) == 0;
	return full ? format("%s_H", e->upper) : shortest(time_in_step(e->model, fraction));
}

/* ---- actions ---- */

static bool adds_driven(const struct emitter *e)
{
	const struct program *program = e->step->program;
	for (int i = 0; i < program->nodes; i++)
		if (program->node_table[i] != NONE)
			return true;
	return false;
}

static void emit_prediction(const struct emitter *e, const struct action *a)
{
	const char *tau = shortest(time_in_step(e->model, e->step->program->node[a->node]));
	say(e, "    $n_predict(s, %s, %s, %d, %d, %s, %sfirst, %s, stage%d);\n",
	    many_operators(e) ? "which" : e->step->event_split && loads_change(e->system) ? "s->segment" : "0",
	    e->step->event_split ? "start, slope" : samples_of_step(e), a->half, a->node, tau,
	    e->step->event_split ? "when, interval, " : "",
	    adds_driven(e) ? format("driven%d, driven%d", a->half, a->node) : "NULL, NULL", a->target);
}

static void emit_evaluation(const struct emitter *e, const struct action *a)
{
	const char *state = a->from == STAGE_STATE ? "s->y" : vector_name(a->from);
	if (e->step->event_split) {
		mpq_srcptr node = e->step->program->node[a->node];
		const char *tau = mpq_sgn(node) ? time_of(e, node) : "0.0";
		say(e, "    $n_forces_at(s, start, slope, %s, when, %s, interval, %s, remainder%d);\n", tau,
		    loads_change(e->system) ? "s->segment" : "0", state, a->target);
	} else {
		say(e, "    %s\n", remainder_of_step(e, a->node, state, format("remainder%d", a->target)));
	}
	if (a->target == 0 && e->step->program->predicts)
		say(e, "    $n_slope_of(%s, s->y, remainder0, first);\n", many_operators(e) ? "which" : "0");
}

static void emit_action(const struct emitter *e, const struct action *a)
{
	switch (a->kind) {
	case ACTION_REMAINDER:
		emit_evaluation(e, a);
		break;
	case ACTION_COMBINE:
		emit_combination(e, a);
		break;
	case ACTION_SUM:
		say(e, "    /* %s */\n", a->note);
		(e->step->program->loops ? emit_sum_loop : emit_sum)(e, a);
		break;
	case ACTION_PREDICT:
		emit_prediction(e, a);
		break;
	}
}

/* ---- what the step declares ---- */

static void declare_vectors(const struct emitter *e)
{
	const struct program *program = e->step->program;
	const char *list = "";
	for (int i = 1; i <= program->stages; i++)
		list = format("%s%sstage%d[%s_STATES]", list, *list ? ", " : "", i, e->upper);
	if (program->loops)
		list = format("%s%snext[%s_STATES]", list, *list ? ", " : "", e->upper);
	if (program->predicts)
		list = format("%s%sfirst[%s_STATES]", list, *list ? ", " : "", e->upper);
	for (int t = 0; t < e->step->tables && flows_apart(e); t++)
		if (e->step->branch[0].table[t]->Phi)
			list = format("%s, flow%d[%s_STATES]", list, t, e->upper);
	for (int i = 0; i < program->nodes; i++)
		if (program->node_table[i] != NONE)
			list = format("%s, driven%d[%s_STATES]", list, i, e->upper);
	if (*list)
		say(e, "    double %s;\n", list);
	say(e, "    double ");
	for (int i = 0; i < program->lefts; i++)
		say(e, "%sremainder%d[%d]", i ? ", " : "", i, e->model->remainder.force_columns);
	say(e, program->loops ? ";\n    int i;\n" : ";\n");
}

/* start, slope: samples at the start of the step, where some are ramps */
void emit_samples(const struct emitter *e)
{
	const char *start = "", *slope = "";
	for (int i = 0; i < e->system->inputs; i++) {
		bool ramp = e->system->input[i].hold;
		start = format("%s%s%s[%d]", start, i ? ", " : "", ramp ? "s->u" : "u", i);
		slope = format("%s%s%s", slope, i ? ", " : "", ramp ? ramp_slope(e, i) : "0.0");
	}
	if (e->ramps)
		say(e, "    const double start[$N_INPUTS] = {%s};\n"
		       "    const double slope[$N_INPUTS] = {%s};\n", start, slope);
}

/* ---- what the loads and inputs add ---- */

/* From rest up to each node of the predictors */
static void emit_driven(const struct emitter *e)
{
	const struct program *program = e->step->program;
	for (int i = 0; i < program->nodes; i++) {
		int t = program->node_table[i];
		if (t == NONE)
			continue;
		if (program->loops) {
			emit_flow_loop(e, t, true, format("driven%d", i), flows_apart(e) ? "        " : "    ");
			continue;
		}
		for (int row = 0; row < e->system->states; row++) {
			struct summands s = { 0 };
			add_flow(e, &s, e->step->branch[0].table[t], true, row);
			say(e, "    driven%d[%d] = %s;\n", i, row, sum_of(&s, 16));
		}
	}
}

/* Across a change of the loads */
static void emit_passes(const struct emitter *e)
{
	const struct program *program = e->step->program;
	const char *which = many_operators(e) ? "which, " : "", *u = e->system->inputs ? "u, " : "";
	const char *more = format("%s%s%s", which, u, e->step->layout.powers == 1 ? "NULL, " : "");
	if (adds_driven(e))
		say(e, "        $n rest = *s;\n"
		       "        for (i = 0; i < $N_STATES; i++) { rest.y[i] = 0.0; }\n");
	for (int t = 0; t < e->step->tables; t++) {
		const struct table *table = e->step->branch[0].table[t];
		if (table->Phi)
			say(e, "        $n_pass(s, %s%s, flow%d);\n", more, time_of(e, table->wanted->fraction), t);
	}
	for (int i = 0; i < program->nodes; i++)
		if (program->node_table[i] != NONE)
			say(e, "        $n_pass(&rest, %s%s, driven%d);\n", more, time_of(e, program->node[i]), i);
}

static void emit_flows_apart(const struct emitter *e)
{
	int last = e->system->segments - 1;
	say(e, "    if (s->segment < %d && $n_until(s, s->segment) < $N_H) {\n", last);
	emit_passes(e);
	say(e, "    } else {\n");
	for (int t = 0; t < e->step->tables; t++)
		if (e->step->branch[0].table[t]->Phi)
			emit_flow_loop(e, t, false, format("flow%d", t), "        ");
	emit_driven(e);
	say(e, "    }\n");
}

/* ---- predictors of a quadrature ---- */

static void emit_unrolled_slope(const struct emitter *e)
{
	int states = e->system->states, force_columns = e->model->remainder.force_columns;
	const struct slopes slopes = state_slopes(e->step, 0);
	for (int i = 0; i < states; i++) {
		struct summands s = { 0 };
		add_products(&s, slopes.A + i * states, states, "z");
		add_products(&s, slopes.B + i * force_columns, force_columns, "remainder");
		say(e, "    dz[%d] = %s;  /* %s' */\n", i, sum_of(&s, 12), e->model->names.state[i]);
	}
}

void emit_predictor(const struct emitter *e)
{
	open_function(e, "dz = A z + B r, r being the nonlinear remainder",
		      "static void $n_slope_of(int which, const double z[$N_STATES], const double remainder[%d], "
		      "double dz[$N_STATES])", e->model->remainder.force_columns);
	if (e->step->program->loops)
		say(e,
		    "    pl_multiply($N_STATES, $N_STATES, %s, z, dz);\n"
		    "    pl_multiply_add($N_STATES, %d, %s, remainder, dz);\n",
		    matrix_text(e, "A"), e->model->remainder.force_columns, matrix_text(e, "B"));
	else
		emit_unrolled_slope(e);
	close_function(e, "which z");
	emit_sizes(e, "predict.h", { "STATES", e->system->states }, { "FORCES", e->model->remainder.force_columns },
		   { "DRIVEN", adds_driven(e) }, { "EVENT_SPLIT", e->step->event_split != NULL });
	say_include(e, "predict.h");
}

/* ---- the whole ---- */

/* Loads whose states the step reads: loops read all of those that act, sums not the constant 1 */
static bool *acting_loads(const struct emitter *e)
{
	const struct linear *system = e->system;
	bool *acting = ARRAY(bool, (size_t)system->loads);
	for (int l = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++) {
			bool read = e->step->program->loops || load_operand(e, l, k);
			for (int i = 0; i < system->segments * system->n && read; i++)
				acting[l] = acting[l] || mpq_sgn(system->load[l].force[k][i]) != 0;
		}
	return acting;
}

static bool *states_read(const struct emitter *e)
{
	bool *read = ARRAY(bool, (size_t)e->system->states);
	for (int t = 0; t < e->step->tables; t++) {
		const struct table *table = e->step->branch[0].table[t];
		for (int i = 0; i < table->states && table->Phi; i++)
			for (int j = 0; j < table->states; j++)
				read[j] = read[j] || !table->Phi[i * table->states + j].zero;
	}
	return read;
}

static void emit_operands_of_step(const struct emitter *e)
{
	bool loops = e->step->program->loops;
	if (!loops)
		emit_locals(e, states_read(e));
	emit_load_states(e, acting_loads(e), false);
	if (!e->step->event_split)
		emit_samples(e);
	if (many_operators(e))
		say(e, "    const int which = %s;\n", selection_call(e));
	if (loops)
		emit_operands(e);
}

/* The body of a step: s->y one h on */
void emit_actions_of_step(const struct emitter *e)
{
	const struct program *program = e->step->program;
	emit_set_aside(e);
	emit_operands_of_step(e);
	declare_vectors(e);
	if (flows_apart(e))
		emit_flows_apart(e);
	else
		emit_driven(e);
	for (int i = 0; i < program->actions; i++)
		emit_action(e, &program->action[i]);
	emit_take_back(e);
}

void emit_remainder_step(const struct emitter *e)
{
	const struct program *program = e->step->program;
	if (program->loops)
		emit_loop_tables(e);
	if (program->predicts)
		emit_predictor(e);
	open_function(e, NULL, "%s", head_of_step(e));
	emit_actions_of_step(e);
	emit_step_end(e);
	say(e, "    s->status |= pl_not_finite(s->y, $N_STATES);\n");
	if (loads_change(e->system))
		say(e, "    $n_pass_segments(s);\n");
	say(e, "}\n");
}
