/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The independent blocks of a large model, which NAME_at and NAME_jump take one after the other: see changes.h, jump.h.
 */
#include "inner.h"

bool is_blockwise(const struct emitter *e)
{
	const struct program *program = e->step->program;
	return program->groups > 1 || (program->groups == 1 && program->group[0].blocks > 1);
}

int states_of_largest_block(const struct emitter *e)
{
	const struct program *program = e->step->program;
	int largest = 0;
	for (int k = 0; k < program->groups; k++)
		largest = program->group[k].states > largest ? program->group[k].states : largest;
	return largest;
}

int count_blocks(const struct emitter *e)
{
	int blocks = 0;
	for (int k = 0; k < e->step->program->groups; k++)
		blocks += e->step->program->group[k].blocks;
	return blocks;
}

void emit_block_list(const struct emitter *e)
{
	const struct program *program = e->step->program;
	const int blocks = count_blocks(e), states = e->system->states;
	int *first = ARRAY(int, (size_t)blocks + 1), *state = ARRAY(int, (size_t)states), count = 0, block = 0;
	const bool at = !e->model->switching && e->step->series.emitted && !loads_change(e->system);
	if (!is_blockwise(e) || e->step->blocks || !(at || has_jump(e)))
		return;
	for (int k = 0; k < program->groups; k++)
		for (int b = 0; b < program->group[k].blocks; b++) {
			for (int i = 0; i < program->group[k].states; i++)
				state[count++] = program->group[k].state[i * program->group[k].blocks + b];
			first[++block] = count;
		}
	say(e, "\n/* Independent blocks: where the states of each begin in the list, which they are */\n");
	emit_integers(e, "unsigned short", "block_first", blocks + 1, first);
	emit_integers(e, "unsigned short", "block_state", states, state);
}
