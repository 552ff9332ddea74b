/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The coefficients of a series as C: their tape under the names of states and letters. */
#include "inner.h"
#include "emit/steps.h"
#include "step/series/expansion.h"

#include <string.h>

/* ---- names ---- */

/* Of the sequences that are no states: a letter that no state's local starts with */
static const char *prefix(const struct emitter *e)
{
	static const char *const letters[] = { "a", "b", "p", "q", "w", "z", "part", "sequence" };
	for (size_t i = 0; i < sizeof letters / sizeof *letters; i++) {
		bool free = true;
		for (int k = 0; k < e->system->states; k++)
			free = free && strncmp(e->local[k], letters[i], strlen(letters[i])) != 0;
		if (free)
			return letters[i];
	}
	return "coefficient_of_sequence_";
}

static const char *base_name(const void *context, int sequence)
{
	const struct emitter *e = context;
	int state = own_expansion(e)->sequence[sequence].state;
	return state != NONE ? e->local[state] : format("%s%d", prefix(e), sequence - e->system->states + 1);
}

const char *coefficient(const struct emitter *e, int sequence, int k)
{
	return k > own_expansion(e)->sequence[sequence].top ? NULL : format("%s_%d", base_name(e, sequence), k);
}

/* ---- operands ---- */

static const char *operand(const void *context, const struct tape_node *n)
{
	const struct emitter *e = context;
	switch (n->op) {
	case TAPE_STATE: return format("y[%d]", n->index);
	case TAPE_LOAD:  return load_operand(e, n->index, n->part);
	case TAPE_INPUT: return input_name(e, n->index, n->part);
	case TAPE_PARAM: return e->at_state ? param_local(e, n->index) : param_text(e, n->index);
	case TAPE_TIME:  return n->part ? "when" : "t";
	case TAPE_ABOVE: return format("interval[%d] > %d", n->index, n->part);
	case TAPE_HELD:  return format("interval[%d] == %d", n->index, n->part);
	default:         return spell(e, "force%s[%d]", e->at_state ? "" : format("[%d]", n->part), n->index);
	}
}

/* ---- the whole ---- */

struct recurrences *series_new(const struct emitter *e)
{
	return recurrences_new(e->step, own_expansion(e), (struct series_names){ base_name, e, false });
}

void emit_series_tape(const struct emitter *e, const struct recurrences *r)
{
	const struct tape *t = tape_of_recurrences(r);
	const struct tape_target to = { .real = "double", .operand = operand, .size = "pl_magnitude",
					.context = e, .indent = 4, .locals_first = true };
	tape_print(t, &to, e->to);
}

void emit_series_locals(const struct emitter *e)
{
	const struct expansion *x = own_expansion(e);
	struct recurrences *r = series_new(e);
	struct tape *t = tape_of_recurrences(r);
	for (int k = 0; k <= x->order; k++) {
		for (int i = 0; i < e->system->states && !x->alone; i++)
			if (coefficient(e, i, k))
				tape_set_local(t, coefficient(e, i, k), recurrence_number(r, i, k));
		for (int i = 0; i < x->columns; i++)
			if (k <= x->column_top[i] && coefficient(e, x->column[i], k))
				tape_set_local(t, coefficient(e, x->column[i], k),
					       recurrence_number(r, x->column[i], k));
	}
	emit_series_tape(e, r);
}
