/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The step as one matrix over states and load states, in two words, so that its powers leap over many steps. */
#include "model/reads.h"
#include "images.h"

struct leap leap_of(const struct step *step)
{
	const struct linear *system = &step->branch->system;
	struct leap leap = { .size = system->states, .load = ARRAY(int, system->loads) };
	for (int l = 0, column = 0; l < system->loads; column += system->load[l++].columns) {
		bool used = false;
		for (int k = 0; k < system->load[l].columns; k++)
			used = used || step->program->uses[column + k];
		leap.load[l] = used ? leap.size : -1;
		leap.size += used ? system->load[l].columns : 0;
	}
	return leap;
}

struct entries {
	int count, room;
	struct leap_entry *entry;
};

static void add_entry(struct entries *list, int segment, int row, int column, const struct coefficient *value)
{
	if (value->value == 0 && value->low == 0)
		return;
	if (list->count == list->room) {
		list->room = 2 * list->room + 16;
		ENLARGE(list->entry, (size_t)list->room);
	}
	list->entry[list->count++] = (struct leap_entry){ segment, row, column, *value };
}

/* What the load states add to the states */
static void add_state_rows(struct entries *list, const struct step *step, const struct leap *leap, int segment)
{
	const struct linear *system = &step->branch->system;
	const struct table *table = step->branch->full;
	for (int i = 0; i < table->states; i++) {
		const struct coefficient *row = table->load + (segment * table->states + i) * table->columns;
		for (int l = 0, column = 0; l < system->loads; column += system->load[l++].columns)
			for (int k = 0; k < system->load[l].columns && leap->load[l] >= 0; k++)
				add_entry(list, segment, i, leap->load[l] + k, &row[column + k]);
	}
}

/* A load's states among themselves */
static struct coefficient *step_of_load(const struct step *step, const struct load *load)
{
	const struct model *model = step->model;
	int n = load->columns;
	struct coefficient *cell = ARRAY(struct coefficient, (size_t)n * (size_t)n);
	for (int i = 0; i < n * n; i++) {
		struct response *response = response_of_load_state(load, i / n, i % n, model->h);
		cell[i] = response_value(response, model->h, true, model->request.at.step, column_text(load, i / n));
	}
	return cell;
}

int leap_entries_of(const struct step *step, const struct leap *leap, struct leap_entry **entry)
{
	const struct linear *system = &step->branch->system;
	struct entries list = { 0 };
	struct coefficient **cell = ARRAY(struct coefficient *, system->loads);
	for (int l = 0; l < system->loads; l++)
		cell[l] = leap->load[l] >= 0 ? step_of_load(step, &system->load[l]) : NULL;
	for (int segment = 0; segment < system->segments; segment++) {
		add_state_rows(&list, step, leap, segment);
		for (int l = 0; l < system->loads; l++) {
			int n = cell[l] ? system->load[l].columns : 0;
			for (int i = 0; i < n * n; i++)
				add_entry(&list, segment, leap->load[l] + i / n, leap->load[l] + i % n, &cell[l][i]);
		}
	}
	*entry = list.entry;
	return list.count;
}
