/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step program as C: sums over the old state, or for a large model loops over its tables. */
#include "emit/emit.h"

static const char *tap_text(const struct emitter *e, int input, int tap)
{
	int hold = e->system->input[input].hold;
	if (tap == hold)
		return sample_now(e, input);
	return hold == 1 ? format("s->u[%d]", input) : format("s->past[%d][%d]", input, tap);
}

/* Held: the sample that the step is given. A ramp: the previous sample, then the one given; further taps likewise. */
const char *input_operand(const struct emitter *e, int column)
{
	if (e->sample)
		return e->sample[column];
	for (int i = 0; i < e->system->inputs; i++) {
		int columns = e->system->input[i].hold + 1;
		if (column < columns)
			return tap_text(e, i, column);
		column -= columns;
	}
	return NULL;
}

static const char *operand_text(const struct emitter *e, const struct operand *operand)
{
	switch (operand->kind) {
	case OPERAND_STATE: return e->local[operand->index];
	case OPERAND_LOAD:  return column_operand(e, operand->index);
	default:            return input_operand(e, operand->index);
	}
}

/* A load that changes has its factors in a table, one row for each segment of time. */
static const char *term_text(const struct emitter *e, const struct assignment *a, const struct product *p)
{
	const char *operand = operand_text(e, &p->operand);
	bool tuned = has_own_factors(e, a->target);
	int turned = p->operand.kind == OPERAND_LOAD ? anchored_term(e->step, a->target, p->operand.index) : -1;
	if (turned >= 0)
		return format("turned[%d] * %s", turned, operand);
	if (!tuned && (p->operand.kind != OPERAND_LOAD || e->system->segments == 1))
		return scaled(p->factor->value, operand);
	const char *factor = tuned ? tuned_factor(e, a->target, &p->operand)
				   : format("factor[%d][%d]", a->target, p->operand.index);
	return operand ? format("%s * %s", factor, operand) : factor;
}

static const char *sum_text(const struct emitter *e, const struct assignment *a, int indent)
{
	const char **term = ARRAY(const char *, (size_t)a->terms + 1);
	for (int k = 0; k < a->terms; k++)
		term[k] = term_text(e, a, &a->term[k]);
	return a->terms ? tree(a->terms, term, indent) : "0.0";
}

static const char *second_term_text(const struct emitter *e, const struct assignment *a, const struct product *p)
{
	const char *operand = operand_text(e, &p->operand);
	int turned = p->operand.kind == OPERAND_LOAD ? anchored_term(e->step, a->target, p->operand.index) : -1;
	if (turned >= 0)
		return format("turned[%d] * %s", e->step->anchors->terms + turned, operand);
	return scaled(p->factor->low, operand);
}

/* The factors' second words; NULL: there are none */
static const char *second_sum_text(const struct emitter *e, const struct assignment *a)
{
	const char **term = ARRAY(const char *, (size_t)a->terms + 1);
	int terms = 0;
	for (int k = 0; k < a->terms; k++)
		if (has_second_word(&a->term[k], e->step))
			term[terms++] = second_term_text(e, a, &a->term[k]);
	return terms ? tree(terms, term, 14) : NULL;
}

/* target = target + (sum), what its rounding takes kept in s->rest; of plain steps in s->carry */
static void emit_compensated(const struct emitter *e, const struct assignment *a, const char *target)
{
	const char *second = a->carried ? NULL : second_sum_text(e, a), *sum = sum_text(e, a, 14);
	say(e, "    %s = pl_accumulate(%s,  /* %s */\n"
	       "              %s,\n"
	       "              %s, &s->%s[%d]);\n",
	    target, e->local[a->target], e->model->state_name[a->target], sum, second ? second : "0.0",
	    a->carried ? "carry" : "rest", a->carried ? e->step->carry[a->target] : a->target);
}

void emit_assignment(const struct emitter *e, const struct assignment *a)
{
	const struct program *program = e->step->program;
	const char *target = program->in_order ? e->local[a->target] : format("s->y[%d]", a->target);
	const char *old = e->local[a->target], *name = e->model->state_name[a->target];
	if (program->compensated || a->carried)
		emit_compensated(e, a, target);
	else if (program->in_order)
		say(e, "    %s += %s;\n", target, sum_text(e, a, 10));
	else if (a->added && a->terms > 1)
		say(e, "    %s = %s + (%s);  /* %s */\n", target, old, sum_text(e, a, 14), name);
	else if (a->added)
		say(e, "    %s = %s + %s;  /* %s */\n", target, old, sum_text(e, a, 14), name);
	else
		say(e, "    %s = %s;  /* %s */\n", target, sum_text(e, a, 14), name);
}

bool *loads_of_step(const struct emitter *e)
{
	bool *wanted = ARRAY(bool, (size_t)e->system->loads);
	for (int l = 0, column = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns; k++, column++)
			wanted[l] = wanted[l] || (load_operand(e, l, k) && e->step->program->uses[column]);
	return wanted;
}

/* The slope at the end of the step of an input that goes through further taps, where something reads it */
static void emit_tap_slope(const struct emitter *e, int input)
{
	int hold = e->system->input[input].hold, terms = 0;
	const char **term = ARRAY(const char *, (size_t)hold + 1);
	mpq_t slope;
	if (!reads_input_slope(e->model, input))
		return;
	mpq_init(slope);
	for (int c = 0; c <= hold; c++) {
		tap_slope(hold, c, slope);
		if (mpq_sgn(slope) != 0)
			term[terms++] = scaled(round_rational(slope), tap_text(e, input, c));
	}
	mpq_clear(slope);
	say(e, "    s->slope[%d] = (%s) / %s;\n", input, tree(terms, term, 18), step_length(e));
}

void emit_next_tap(const struct emitter *e, int input)
{
	int hold = e->system->input[input].hold;
	for (int c = 0; c + 1 < hold; c++)
		say(e, "    s->past[%d][%d] = s->past[%d][%d];\n", input, c, input, c + 1);
	say(e, "    s->past[%d][%d] = u[%d];\n"
	       "    s->u[%d] = s->past[%d][%d];\n", input, hold - 1, input, input, input, (hold - 1) / 2);
}

/* `samples` steps at once: of inputs that are held or ramp */
void emit_keep_inputs(const struct emitter *e, int samples)
{
	int inputs = given_inputs(e), last = (samples - 1) * inputs;
	for (int i = 0; i < inputs; i++) {
		const char *before = samples > 1 ? format("u[%d]", last - inputs + i) : format("s->u[%d]", i);
		if (e->system->input[i].hold > 1) {
			emit_tap_slope(e, i);
			emit_next_tap(e, i);
			continue;
		}
		if (e->system->input[i].hold)
			say(e, "    s->slope[%d] = %s;\n", i, slope_of_samples(e, format("u[%d]", last + i), before));
		say(e, "    s->u[%d] = u[%d];\n", i, last + i);
	}
}

static bool any_load_term(const struct program *program)
{
	for (int i = 0; i < program->assignments; i++)
		for (int k = 0; k < program->assignment[i].terms; k++)
			if (program->assignment[i].term[k].operand.kind == OPERAND_LOAD)
				return true;
	return false;
}

static void emit_load_factors(const struct emitter *e)
{
	const struct table *table = e->step->branch->whole;
	int cells = table->states * table->columns;
	double *value = ARRAY(double, (size_t)cells);
	say(e, "\n"
	       "/* Factors of the load states in each segment of time */\n"
	       "static const double $n_load_factor[%d][$N_STATES][%d] = {\n",
	    e->system->segments, table->columns);
	for (int s = 0; s < e->system->segments; s++) {
		for (int i = 0; i < cells; i++)
			value[i] = table->load[s * cells + i].value;
		say(e, "  {\n");
		emit_number_rows(e, table->states, table->columns, value, e->model->state_name);
		say(e, "  },\n");
	}
	say(e, "};\n");
}

void emit_set_aside(const struct emitter *e)
{
	const int *carry = e->step->carry;
	for (int i = 0; i < e->system->states; i++)
		if (carry[i] >= 0)
			say(e, "    const double far%d = s->y[%d];  /* nothing reads %s: over the step it is 0 */\n",
			    carry[i], i, e->model->state_name[i]);
	for (int i = 0; i < e->system->states; i++)
		if (carry[i] >= 0)
			say(e, "    s->y[%d] = 0.0;\n", i);
}

void emit_take_back(const struct emitter *e)
{
	const int *carry = e->step->carry;
	for (int i = 0; i < e->system->states; i++)
		if (carry[i] >= 0)
			say(e, "    s->y[%d] = pl_accumulate(far%d, s->y[%d], 0.0, &s->carry[%d]);\n",
			    i, carry[i], i, carry[i]);
}

/* Of the columns of loads, then of inputs */
static const char **acting_texts(const struct emitter *e)
{
	const struct table *table = e->step->branch->whole;
	const char **text = ARRAY(const char *, (size_t)(table->columns + table->inputs) + 1);
	for (int k = 0; k < table->columns + table->inputs; k++) {
		const bool load = k < table->columns;
		const int index = load ? k : k - table->columns;
		text[k] = operand_text(e, &(struct operand){ load ? OPERAND_LOAD : OPERAND_INPUT, index });
		text[k] = text[k] ? text[k] : "1.0";
	}
	return text;
}

/* The rows of small blocks of a large model, their states under their names */
static void emit_group_rows(const struct emitter *e)
{
	const struct program *program = e->step->program;
	const int states = e->system->states;
	bool *stepped = ARRAY(bool, (size_t)states), *reads = ARRAY(bool, (size_t)states);
	for (int k = 0; k < program->groups; k++)
		for (int i = 0; i < program->group[k].states && program->group[k].kind == GROUP_ROWS; i++)
			stepped[program->group[k].state[i]] = true;
	for (int i = 0; i < states; i++)
		reads[i] = stepped[i] && program->reads[i];
	emit_raw_locals(e, reads, false);
	if (rows_read_changing_loads(e))
		say(e, "    const double (*const factor)[%d] = $n_load_factor[s->segment];\n",
		    e->step->branch->whole->columns);
	for (int i = 0; i < program->assignments; i++)
		if (stepped[program->assignment[i].target])
			emit_assignment(e, &program->assignment[i]);
}

static void emit_looped_step(const struct emitter *e)
{
	if (e->step->modal) {
		emit_modal_step(e, acting_texts(e));
		return;
	}
	emit_group_rows(e);
	emit_set_aside(e);
	emit_group_steps(e, acting_texts(e));
	emit_take_back(e);
}

/* A step that no change of the loads interrupts */
static void emit_plain_step(const struct emitter *e)
{
	const struct program *program = e->step->program;
	if (program->loops) {
		emit_load_states(e, loads_of_step(e), false);
		emit_looped_step(e);
		return;
	}
	emit_raw_locals(e, program->reads, program->in_order);
	emit_anchored_loads(e, loads_of_step(e));
	if (e->system->segments > 1 && any_load_term(program) && !program->tuned)
		say(e, "    const double (*const factor)[%d] = $n_load_factor[s->segment];\n",
		    e->step->branch->whole->columns);
	for (int i = 0; i < program->assignments; i++)
		emit_assignment(e, &program->assignment[i]);
	for (int i = 0; i < e->system->states && program->in_order; i++)
		if (program->reads[i])
			say(e, "    s->y[%d] = %s;\n", i, e->local[i]);
}

void emit_step_end(const struct emitter *e)
{
	emit_keep_inputs(e, 1);
	if (!e->step->anchors)
		emit_load_advance(e, NULL);
	say(e, "    s->k++;\n");
	if (e->step->anchors)
		say(e, "    if (++s->since == %d)\n"
		       "        $n_drop_anchor(s);\n",
		    e->step->anchors->steps);
	if (e->step->rest && e->step->rest->in_step)
		say(e, "    if ((s->k & 63) == 0)\n"
		       "        $n_rest(s);\n");
	if (has_ranges(e))
		say(e, "    $n_stay(s);\n");
}

const char *step_parameters(const struct emitter *e)
{
	return format("%s *s%s", e->name, given_inputs(e) ? format(", const double u[%s_INPUTS]", e->upper) : "");
}

/* Into y: the state after a step in which the loads change their formula, from pass() */
static void emit_interrupted_step(const struct emitter *e, const char *segment, const char *result, const char *whole)
{
	const char *h = step_length(e), *u = given_inputs(e) ? "u, " : "";
	say(e, "    if (%s < %d && $n_until(s, %s) < %s) {\n"
	       "        double y[$N_STATES];\n"
	       "        int i;\n"
	       "        %s$n_pass(s, %s%s, %sy);\n",
	    segment, e->system->segments - 1, segment, h, result, u, h, whole);
	emit_set_state(e, "y", "        ");
	say(e, "    } else {\n"
	       "        $n_plain_step(s%s);\n"
	       "    }\n",
	    given_inputs(e) ? ", u" : "");
	emit_step_end(e);
}

/* The forced part changes with the loads; pass() does that for the changes inside the step. */
static void emit_forced_changes(const struct emitter *e)
{
	say(e, "    int segment = s->segment;\n");
	emit_interrupted_step(e, "segment", "segment = ", "0, ");
	say(e, "    s->segment = segment;\n"
	       "    while (s->segment < %d && $n_until(s, s->segment) <= 1e-18 * %s) {\n",
	    e->system->segments - 1, step_length(e));
	if (e->step->forced->changes)
		say(e, "        $n_rebase(s);\n");
	say(e, "        s->segment++;\n"
	       "    }\n");
}

static void emit_plain_changes(const struct emitter *e)
{
	emit_interrupted_step(e, "s->segment", "", "");
	say(e, "    while (s->segment < %d && $n_until(s, s->segment) <= 1e-18 * %s)\n"
	       "        s->segment++;\n",
	    e->system->segments - 1, step_length(e));
}

static void emit_changing_step(const struct emitter *e)
{
	const struct program *program = e->step->program;
	if (program->loops ? rows_read_changing_loads(e) : any_load_term(program) && !program->tuned)
		emit_load_factors(e);
	say(e, "\n"
	       "static void $n_plain_step(%s)\n"
	       "{\n",
	    step_parameters(e));
	emit_plain_step(e);
	if (given_inputs(e))
		say(e, "    (void)u;\n");
	say(e, "}\n"
	       "\n"
	       "void $n_step(%s)\n"
	       "{\n",
	    step_parameters(e));
	if (e->step->forced)
		emit_forced_changes(e);
	else
		emit_plain_changes(e);
	say(e, "}\n");
}

void emit_step(const struct emitter *e)
{
	emit_groups(e);
	if (e->step->rest && e->step->rest->in_step)
		emit_rest(e);
	if (e->system->segments > 1) {
		emit_changing_step(e);
		return;
	}
	say(e, "\n"
	       "%svoid $n_%s(%s)\n"
	       "{\n",
	    has_peaks(e) ? "static " : "", name_of_step(e), step_parameters(e));
	emit_plain_step(e);
	emit_step_end(e);
	say(e, "}\n");
}
