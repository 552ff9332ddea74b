/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The forced part of loads that the step leaves out: NAME_forced, and its tables where they change their formula. */
#include "emit/emit.h"

/* [segment][row][column] */
static void print_forced(const struct emitter *e, const char *name, const char *what, int segments, int rows,
			 const struct coefficient *factor)
{
	const char **note = ARRAY(const char *, (size_t)rows);
	const int columns = e->step->branch->whole->columns, size[] = { segments, rows, columns };
	const int count = segments * rows * columns;
	double *value = ARRAY(double, (size_t)count);
	for (int i = 0; i < count; i++)
		value[i] = is_forced(e->step, i % columns) ? factor[i].value : 0;
	for (int i = 0; i < rows; i++)
		note[i] = i < e->system->states ? e->model->state_name[i]
						: e->model->relative->written->state_name[i - e->system->states];
	emit_array(e, what, name, 3, size, value, note);
}

/* A change at the end of a step */
static void emit_rebase(const struct emitter *e)
{
	int count = e->step->branch->whole->columns;
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
	if (segments > 1 || (forced->written && e->step->series.emitted))
		print_forced(e, "forced_part", "factors of the load states in each segment of time", segments,
			     forced->rows, forced->part);
	if (forced->changes) {
		print_forced(e, "forced_change", "what they lose from each to the next", segments - 1,
			     e->system->states, forced->change);
		emit_rebase(e);
	}
}

static void emit_part(const struct emitter *e, const char *what, const char *name, int first)
{
	struct formulas *f = formulas_new(e, (struct reading){ 0 }, 0, NULL);
	tape_of_forced(formulas_tape(f), e->step, first, "now");
	open_function(e, what, "static void $n_%s(const $n *s, double now[$N_STATES])", name);
	emit_turned_loads(e, e->step->forced->load, false);
	emit_formulas(f, 4);
	close_function(e, "s");
}

void emit_forced(const struct emitter *e)
{
	const int written = e->step->forced->written;
	emit_forced_tables(e);
	emit_part(e, "What the loads that the step leaves out sustain now", "forced", 0);
	if (written)
		emit_part(e, "The same of the states as written", "sustained", written);
}
