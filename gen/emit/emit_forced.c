/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The forced part of loads that the step leaves out: NAME_forced, and its tables where they change their formula. */
#include "emit/emit.h"

/* [segment][state][column] */
static void print_forced(const struct emitter *e, const char *name, const char *what, int segments,
			 const struct coefficient *factor)
{
	const struct table *table = e->step->branch->whole;
	const int size[] = { segments, table->states, table->columns };
	const int count = segments * table->states * table->columns;
	double *value = ARRAY(double, (size_t)count);
	for (int i = 0; i < count; i++)
		value[i] = is_forced(e->step, i % table->columns) ? factor[i].value : 0;
	emit_array(e, what, name, 3, size, value, e->model->state_name);
}

/* A change at the end of a step */
static void emit_rebase(const struct emitter *e)
{
	int count = e->step->branch->whole->columns;
	say(e, "\n"
	       "static void $n_rebase($n *s)\n"
	       "{\n");
	emit_load_states(e, e->step->forced->load, false);
	const char **text = ARRAY(const char *, (size_t)count);
	for (int k = 0; k < count; k++)
		text[k] = is_forced(e->step, k) ? column_operand(e, k) : "0.0";
	say_vector(e, "load", count, text);
	say(e, "    int i, j;\n"
	       "    for (i = 0; i < $N_STATES; i++) {\n"
	       "        for (j = 0; j < %d; j++) { s->y[i] += $n_forced_change[s->segment][i][j] * load[j]; }\n"
	       "    }\n"
	       "}\n", count);
}

static void emit_forced_tables(const struct emitter *e)
{
	const struct forced *forced = e->step->forced;
	int segments = e->system->segments;
	if (segments > 1)
		print_forced(e, "forced_part", "factors of the load states in each segment of time", segments,
			     forced->part);
	if (forced->changes) {
		print_forced(e, "forced_change", "what they lose from each to the next", segments - 1, forced->change);
		emit_rebase(e);
	}
}

void emit_forced(const struct emitter *e)
{
	struct formulas *f = formulas_new(e, (struct reading){ 0 }, 0, NULL);
	tape_of_forced(formulas_tape(f), e->step, "now");
	emit_forced_tables(e);
	say(e, "\n"
	       "/* What the loads that the step leaves out sustain now */\n"
	       "static void $n_forced(const $n *s, double now[$N_STATES])\n"
	       "{\n");
	emit_turned_loads(e, e->step->forced->load, false);
	emit_formulas(f, 4);
	say(e, "    (void)s;\n"
	       "}\n");
}
