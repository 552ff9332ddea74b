/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Factors that the instance has, in steps and in outputs. */
#include "emit/emit.h"

int place_in(int count, const int *list, int what)
{
	int place = 0;
	while (place < count && list[place] != what)
		place++;
	return place;
}

static const char *block_factor(const struct emitter *e, int state, int place)
{
	const struct table *table = e->step->branch->whole;
	int index, row, load = place - table->states, input = load - table->columns;
	const struct group *g = group_of_state(e->step, state, &index, &row);
	const int segments = e->system->segments;
	const char *later = "";
	if (load < 0)
		place = place_in(g->states, g->state, place);
	else if (input >= 0)
		place = g->states + segments * g->loads + place_in(g->inputs, g->input, input);
	else
		place = g->states + place_in(g->loads, g->load, load);
	if (load >= 0 && input < 0 && segments > 1)
		later = format(" + s->segment * %d", g->loads);
	return format("s->coeffs.rows%d[%d][%d%s]", index, row, place, later);
}

static const char *tuned_entry(const struct emitter *e, const char *table, int row, int column)
{
	int states = e->system->states, loads = e->model->tuning->x.loads, segments = e->system->segments;
	if (column >= states + loads)
		column += (segments - 1) * loads;
	else if (column >= states && segments > 1)
		return format("s->coeffs.%s[%d][%d + s->segment * %d]", table, row, column, loads);
	return format("s->coeffs.%s[%d][%d]", table, row, column);
}

/* Entry of a table with so many columns */
static const char *cell(const char *table, int index, int columns)
{
	return format("%s[%d][%d]", table, index / columns, index % columns);
}

const char *linear_entry(const struct emitter *e, const struct tape_node *n)
{
	const struct table *table = e->step->branch->whole;
	const int width = table->states + table->columns + table->inputs, i = n->index;
	const struct tuning *tuning = e->model->tuning;
	switch (n->part) {
	case TABLE_TURNED: return format("turned[%d]", i);
	case TABLE_FACTOR: return cell("factor", i, table->columns);
	case TABLE_DIRECT: return cell(spell(e, "$n_direct[s->segment]"), i, load_columns(e->system));
	case TABLE_FORCED: return cell(spell(e, "$n_forced_part[s->segment]"), i, table->columns);
	case TABLE_LEFT:   return format("left[%d]", i);
	case TABLE_SEEN:   return spell(e, "$n_dot($n_seen[%d], s->y)", i);
	case TABLE_OWN_OUT: return tuned_entry(e, "out", i / tuning->x.size - e->model->n, i % tuning->x.size);
	default: break;
	}
	return e->step->blocks->solved ? tuned_entry(e, "step", i / width, i % width)
				       : block_factor(e, i / width, i % width);
}

bool is_tuned_output(const struct emitter *e, const struct output *output)
{
	return own_row(e->step, output) >= 0;
}

const char *tuned_output_row(const struct emitter *e, const struct output *output)
{
	return format("out[%d]", own_row(e->step, output) - e->model->n);
}
