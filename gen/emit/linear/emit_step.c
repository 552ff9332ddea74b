/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step program as C: sums over the old state, or for a large model loops over its tables. */
#include "inner.h"
#include "emit/steps.h"
#include "model/reads.h"
#include "step/linear/forms.h"

bool *loads_of_step(const struct emitter *e)
{
	bool *wanted = ARRAY(bool, (size_t)e->system->loads);
	for (int l = 0, column = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns; k++, column++)
			wanted[l] = wanted[l] || (load_operand(e, l, k) && e->step->program->uses[column]);
	return wanted;
}

/* The slope at the end of the step of an input that goes through further samples, where something reads it */
static void emit_sample_slope(const struct emitter *e, int input)
{
	int hold = e->system->input[input].hold;
	struct summands s = { 0 };
	RATIONAL slope = ZERO;
	if (!reads_input_slope(e->model, input))
		return;
	for (int c = 0; c <= hold; c++) {
		sample_slope(hold, c, slope);
		if (mpq_sgn(slope) != 0)
			add_summand(&s, scaled(round_rational(slope), sample_text(e, input, c)));
	}
	say(e, "    s->slope[%d] = (%s) / %s;\n", input, sum_of(&s, 18), step_length(e));
}

/* `samples` steps at once: of inputs that are held or ramp */
void emit_keep_inputs(const struct emitter *e, int samples)
{
	int inputs = given_inputs(e), last = (samples - 1) * inputs;
	for (int i = 0; i < inputs; i++) {
		const char *before = samples > 1 ? format("u[%d]", last - inputs + i) : format("s->u[%d]", i);
		if (e->system->input[i].hold > 1) {
			emit_sample_slope(e, i);
			say(e, "    $n_next_sample(s, %d, u[%d]);\n", i, i);
			continue;
		}
		if (e->system->input[i].hold)
			say(e, "    s->slope[%d] = %s;\n", i, slope_of_samples(e, format("u[%d]", last + i), before));
		say(e, "    s->u[%d] = u[%d];\n", i, last + i);
	}
}

static void emit_load_factors(const struct emitter *e)
{
	const struct table *table = e->step->branch->full;
	const int size[] = { e->system->segments, table->states, table->columns }, count = size[0] * size[1] * size[2];
	double *value = ARRAY(double, (size_t)count);
	for (int i = 0; i < count; i++)
		value[i] = table->load[i].value;
	emit_array(e, "Input columns: what each load state adds to the states in a step, in each segment of time",
		   "load_factor", 3, size, value,
		   e->model->names.state);
}

void emit_set_aside(const struct emitter *e)
{
	const int *carry = e->step->carried.place;
	for (int i = 0; i < e->system->states; i++)
		if (carry[i] >= 0)
			say(e, "    const %s far%d = %s[%d];  /* nothing reads %s: over the step it is 0 */\n",
			    e->wide ? "pl_lanes" : "double", carry[i], state_vector(e), i, e->model->names.state[i]);
	for (int i = 0; i < e->system->states; i++)
		if (carry[i] >= 0)
			say(e, e->wide ? "    y[%d] = pl_lanes_all(0.0);\n" : "    s->y[%d] = 0.0;\n", i);
}

void emit_take_back(const struct emitter *e)
{
	const int *carry = e->step->carried.place;
	for (int i = 0; i < e->system->states; i++)
		if (carry[i] >= 0 && e->wide)
			say(e, "    y[%d] = pl_lanes_accumulate(far%d, y[%d], pl_lanes_all(0.0), &y[%d]);\n",
			    i, carry[i], i, e->system->states + carry[i]);
		else if (carry[i] >= 0)
			say(e, "    s->y[%d] = pl_accumulate(far%d, s->y[%d], 0.0, &s->carry[%d]);\n",
			    i, carry[i], i, carry[i]);
}

/* Of the columns of loads, then of inputs */
const char **acting_texts(const struct emitter *e)
{
	const struct table *table = e->step->branch->full;
	const char **text = ARRAY(const char *, (size_t)(table->columns + table->inputs) + 1);
	for (int k = 0; k < table->columns + table->inputs; k++) {
		text[k] = k < table->columns ? column_operand(e, k) : input_operand(e, k - table->columns);
		text[k] = text[k] ? text[k] : "1.0";
	}
	return text;
}

struct formulas *formulas_of_step(const struct emitter *e, const bool *stepped)
{
	struct formulas *f = formulas_new(e, (struct reading){ 0 }, 0, NULL);
	tape_of_step(formulas_tape(f), e->step, stepped, "s->y", e->at ? e->at->state : NULL);
	return f;
}

/* Of a step that loops over blocks those that have rows of their own; NULL: all */
bool *states_in_rows(const struct emitter *e)
{
	const struct program *program = e->step->program;
	bool *stepped = program->loops ? ARRAY(bool, (size_t)e->system->states) : NULL;
	for (int k = 0; k < program->groups; k++)
		for (int i = 0; i < program->group[k].states && program->group[k].kind == GROUP_ROWS; i++)
			stepped[program->group[k].state[i]] = true;
	return stepped;
}

/* The rows of a step: of all states, or of those of small blocks of a large model; the states under their names */
static void emit_rows_of_step(const struct emitter *e)
{
	struct formulas *f = formulas_of_step(e, states_in_rows(e));
	const struct tape *t = formulas_tape(f);
	bool *reads = ARRAY(bool, (size_t)e->system->states);
	tape_mark(t, TAPE_STATE, 0, reads);
	emit_raw_locals(e, reads);
	if (!e->step->program->loops)
		emit_refreshed_loads(e, loads_of_step(e));
	if (tape_reads(t, TAPE_TABLE, -1, TABLE_FACTOR))
		say(e, "    const double (*const factor)[%d] = $n_load_factor[s->segment];\n",
		    e->step->branch->full->columns);
	emit_formulas(f, 4);
}

/* What stands in no rows of its own */
void emit_loops_of_step(const struct emitter *e, const char *const *acting_text)
{
	if (e->step->modal) {
		emit_modal_step(e, acting_text);
		return;
	}
	emit_set_aside(e);
	emit_group_steps(e, acting_text);
	emit_take_back(e);
}

/* A step that no change of the loads interrupts */
static void emit_plain_step(const struct emitter *e)
{
	if (!e->step->program->loops) {
		emit_rows_of_step(e);
		return;
	}
	emit_load_states(e, loads_of_step(e), false);
	if (!e->step->modal)
		emit_rows_of_step(e);
	emit_loops_of_step(e, acting_texts(e));
}

void begin_flush(const struct emitter *e)
{
	const struct denormal_flush *flush = e->step->linear.flush;
	if (flush->parts > 1) {
		say(e, "\n/* Which part each state is of: no other state acts on it */\n");
		emit_integers(e, "short", "flush_part", e->system->states, flush->part);
	}
	emit_sizes(e, "flush.h", { "STATES", e->system->states }, { "FLUSHES", flush->parts },
		   { "DECAYING", flush->decaying }, { "FLUSHES_BESIDE", flush->beside },
		   { "COMPENSATED", e->step->program->compensated });
}

/* Before the steps that call it */
void emit_flush(const struct emitter *e)
{
	if (!e->step->linear.flush)
		return;
	begin_flush(e);
	say(e, "#include \"flush.h\"\n");
}

void emit_step_advance(const struct emitter *e)
{
	emit_keep_inputs(e, 1);
	if (!e->step->refresh)
		emit_load_advance(e, NULL);
	say(e, "    s->k++;\n");
	if (e->step->refresh)
		say(e, "    if (++s->since == %d) { $n_refresh_phasors(s); }\n",
		    e->step->refresh->steps);
	if (e->step->linear.flush)
		say(e, "    if ((s->k & 63u) == 0u) { $n_flush(s); }\n");
}

const char *checks_of_step(const struct emitter *e)
{
	return format("%s%s", has_ranges(e) ? spell(e, "    $n_stay(s);\n") : "",
		      may_be_singular(e) ? spell(e, "    $n_stay_regular(s);\n") : "");
}

void emit_step_end(const struct emitter *e)
{
	emit_step_advance(e);
	say(e, "%s", checks_of_step(e));
}

static const char *step_parameters(const struct emitter *e)
{
	return format("%s *s%s", e->name, given_inputs(e) ? format(", const double u[%s_INPUTS]", e->upper) : "");
}

/* Where peaks are looked for it goes by another name. */
const char *head_of_step(const struct emitter *e)
{
	return format(has_peaks(e) ? "static void %s_one_step(%s)" : "void %s_step(%s)", e->name, step_parameters(e));
}

/* Into y: the state after a step in which the loads change their formula, from pass() */
static void emit_interrupted_step(const struct emitter *e, const char *segment, const char *result, const char *full)
{
	const char *h = step_length(e), *u = given_inputs(e) ? "u, " : e->step->is.tuned ? "NULL, " : "";
	say(e, "    if (%s < %d && $n_until(s, %s) < %s) {\n"
	       "        double y[$N_STATES];\n"
	       "        %s$n_pass(s, %s%s, %sy);\n"
	       "        $n_store_state(s, y);\n"
	       "    } else {\n"
	       "        $n_plain_step(s%s);\n"
	       "    }\n",
	    segment, e->system->segments - 1, segment, h, result, u, h, full, given_inputs(e) ? ", u" : "");
	emit_step_end(e);
}

/* The forced part changes with the loads; pass() does that for the changes inside the step. */
static void emit_forced_changes(const struct emitter *e)
{
	say(e, "    int segment = s->segment;\n");
	emit_interrupted_step(e, "segment", "segment = ", "0, ");
	say(e, "    s->segment = segment;\n"
	       "    while (s->segment < %d && $n_until(s, s->segment) <= %s * %s) {\n",
	    e->system->segments - 1, e->model->request.single ? "1e-8" : "1e-18", step_length(e));
	if (e->step->forced->changes)
		say(e, "        $n_rebase(s);\n");
	say(e, "        s->segment++;\n"
	       "    }\n");
}

static void emit_plain_changes(const struct emitter *e)
{
	emit_interrupted_step(e, "s->segment", "", "");
	say(e, "    $n_pass_segments(s);\n");
}

static void emit_changing_step(const struct emitter *e)
{
	struct formulas *f = formulas_of_step(e, states_in_rows(e));
	if (tape_reads(formulas_tape(f), TAPE_TABLE, -1, TABLE_FACTOR))
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
	       "%s\n"
	       "{\n",
	    head_of_step(e));
	if (e->step->forced)
		emit_forced_changes(e);
	else
		emit_plain_changes(e);
	say(e, "}\n");
}

void emit_step(const struct emitter *e)
{
	emit_groups(e);
	if (loads_change(e->system)) {
		emit_changing_step(e);
		return;
	}
	say(e, "\n"
	       "%s\n"
	       "{\n",
	    head_of_step(e));
	emit_plain_step(e);
	emit_step_end(e);
	say(e, "}\n");
}
