/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Factors that the instance has, in steps and in outputs. */
#include "inner.h"
#include "emit/formulas.h"
#include "step/tunable/tuned.h"

int place_in(int count, const int *list, int what)
{
	int place = 0;
	while (place < count && list[place] != what)
		place++;
	return place;
}

/* x: of the table, in one segment of time; its loads have a column for each */
static const char *own_entry(const struct emitter *e, const char *table, int row, int x, int states, int loads)
{
	const int segments = e->system->segments;
	if (x >= states + loads)
		x += (segments - 1) * loads;
	else if (x >= states && segments > 1)
		return format("s->coeffs.%s[%d][%d + s->segment * %d]", table, row, x, loads);
	return format("s->coeffs.%s[%d][%d]", table, row, x);
}

/* Of the block that has this state */
static const char *own_factor(const struct emitter *e, int state, int x)
{
	const struct tuned_block *b = e->step->blocks->block;
	const bool solved = e->step->blocks->solved;
	int row = place_in(b->group->states, b->from, state);
	for (; row == b->group->states; row = place_in(b->group->states, b->from, state))
		b++;
	return own_entry(e, solved ? "step" : format("rows%d", b->index), row, place_in(b->size, b->from, x),
			 b->group->states, b->group->loads);
}

/* Entry of a table with so many columns */
static const char *cell(const char *table, int index, int columns)
{
	return format("%s[%d][%d]", table, index / columns, index % columns);
}

const char *linear_entry(const struct emitter *e, const struct tape_node *n)
{
	const struct table *table = e->step->branch->full;
	const int width = table->states + table->columns + table->inputs, i = n->index;
	const struct layout *x = e->model->params.tuning ? &e->model->params.tuning->x : NULL;
	switch (n->part) {
	case TABLE_ROTATED: return format("rotated[%d]", i);
	case TABLE_FACTOR: return cell("factor", i, table->columns);
	case TABLE_DIRECT: return cell(spell(e, "$n_direct[s->segment]"), i, load_columns(e->system));
	case TABLE_FORCED: return cell(spell(e, "$n_forced_part[s->segment]"), i, table->columns);
	case TABLE_LEFT:   return format("remainder[%d]", i);
	case TABLE_SEEN:   return spell(e, "$n_dot($n_seen[%d], s->y)", i);
	case TABLE_OWN_OUT:
		return own_entry(e, "out", i / x->size, i % x->size, e->system->states, x->loads);
	default: return own_factor(e, i / width, i % width);
	}
}

bool is_tuned_output(const struct emitter *e, const struct output *output)
{
	return own_row(e->step, output) >= 0;
}

const char *tuned_output_row(const struct emitter *e, const struct output *output)
{
	return format("out[%d]", own_row(e->step, output));
}
