/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The forced part of loads that the step leaves out: NAME_forced, and its tables where they change their formula. */
#include "emit/steps.h"
#include "model/linear/relative.h"
#include "step/linear/forms.h"

/* [segment][row][column] */
static void print_forced(const struct emitter *e, const char *name, const char *what, int segments, int rows,
			 const struct coefficient *factor)
{
	const char **note = ARRAY(const char *, (size_t)rows);
	const int columns = e->step->branch->full->columns, size[] = { segments, rows, columns };
	const int count = segments * rows * columns;
	double *value = ARRAY(double, (size_t)count);
	for (int i = 0; i < count; i++)
		value[i] = is_forced(e->step, i % columns) ? factor[i].value : 0;
	for (int i = 0; i < rows; i++)
		note[i] = i < e->system->states ? e->model->names.state[i]
						: e->model->relative->written->names.state[i - e->system->states];
	emit_array(e, what, name, 3, size, value, note);
}

/* A change at the end of a step */
static void emit_rebase(const struct emitter *e)
{
	int count = e->step->branch->full->columns;
	open_function(e, NULL, "static void $n_rebase($n *s)");
	emit_load_states(e, e->step->forced->load, false);
	const char **text = ARRAY(const char *, (size_t)count);
	for (int k = 0; k < count; k++)
		text[k] = is_forced(e->step, k) ? column_operand(e, k) : "0.0";
	say_vector(e, "load", count, text);
	say(e, "    int i, j;\n"
	       "    for (i = 0; i < $N_STATES; i++) {\n"
	       "        for (j = 0; j < %d; j++) { s->y[i] += $n_forced_change[s->segment][i][j] * load[j]; }\n"
	       "    }\n", count);
	close_function(e, "");
}

static void emit_forced_tables(const struct emitter *e)
{
	const struct forced *forced = e->step->forced;
	int segments = e->system->segments;
	if (segments > 1 || forced->written)
		print_forced(e, "forced_part", "factors of the load states in each segment of time", segments,
			     forced->rows, forced->part);
	if (forced->changes) {
		print_forced(e, "forced_change", "what they lose from each to the next", segments - 1,
			     e->system->states, forced->change);
		emit_rebase(e);
	}
}

/* The states as they are kept, and as they are written, are read by one table. */
static void emit_forced_loads(const struct emitter *e)
{
	int count = e->step->branch->full->columns;
	open_function(e, "Load states that the step leaves out, now; of the others 0",
		      "static void $n_forced_loads(const $n *s, double load[%d])", count);
	emit_rotated_loads(e, e->step->forced->load, false);
	for (int k = 0; k < count; k++)
		say(e, "    load[%d] = %s;\n", k,
		    !is_forced(e->step, k) ? "0.0" : column_operand(e, k) ? column_operand(e, k) : "1.0");
	close_function(e, "s");
}

void emit_forced(const struct emitter *e)
{
	emit_forced_tables(e);
	if (e->step->forced->written) {
		emit_forced_loads(e);
		return;
	}
	struct formulas *f = formulas_new(e, (struct reading){ 0 }, 0, NULL);
	tape_of_forced(formulas_tape(f), e->step, "now");
	open_function(e, "Particular solution now, of loads that the step leaves out",
		      "static void $n_forced(const $n *s, double now[$N_STATES])");
	emit_rotated_loads(e, e->step->forced->load, false);
	emit_formulas(f, 4);
	close_function(e, "s");
}

/* What is left out of the step, and what it costs where it comes back */
void banner_forced(const struct emitter *e)
{
	const struct forced *forced = e->step->forced;
	int count = 0;
	for (int l = 0; l < e->system->loads; l++)
		count += forced->load[l];
	say(e, " * The step has the transient: the particular solution of %d load%s is added where the state is read, "
	       "by %d multiplications, %d additions.\n", count, count == 1 ? "" : "s", forced->multiplications,
	    forced->additions);
}
