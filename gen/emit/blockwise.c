/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_at and NAME_jump of a large model of several independent blocks: one block after the other, each as large as it
 * is, with what acts on it. */
#include "emit/emit.h"

bool is_blockwise(const struct emitter *e)
{
	const struct program *program = e->step->program;
	return program->groups > 1 || (program->groups == 1 && program->group[0].blocks > 1);
}

static int largest_block(const struct emitter *e)
{
	const struct program *program = e->step->program;
	int largest = 0;
	for (int k = 0; k < program->groups; k++)
		largest = program->group[k].states > largest ? program->group[k].states : largest;
	return largest;
}

static int count_blocks(const struct emitter *e)
{
	int blocks = 0;
	for (int k = 0; k < e->step->program->groups; k++)
		blocks += e->step->program->group[k].blocks;
	return blocks;
}

static void emit_list(const struct emitter *e, const char *name, int count, const int *value)
{
	say(e, "static const unsigned short $n_%s[%d] = {", name, count);
	for (int i = 0; i < count; i++)
		say(e, "%s%d", !i ? "" : i % 20 ? ", " : ",\n    ", value[i]);
	say(e, "};\n");
}

void emit_block_list(const struct emitter *e)
{
	const struct program *program = e->step->program;
	const int blocks = count_blocks(e), states = e->system->states;
	int *first = ARRAY(int, (size_t)blocks + 1), *state = ARRAY(int, (size_t)states), count = 0, block = 0;
	const bool at = !e->model->switching && e->step->series.emitted && e->system->segments == 1;
	if (!is_blockwise(e) || e->step->blocks || !(at || has_jump(e)))
		return;
	for (int k = 0; k < program->groups; k++)
		for (int b = 0; b < program->group[k].blocks; b++) {
			for (int i = 0; i < program->group[k].states; i++)
				state[count++] = program->group[k].state[i * program->group[k].blocks + b];
			first[++block] = count;
		}
	say(e, "\n/* Independent blocks: where the states of each begin in the list, which they are */\n");
	emit_list(e, "block_first", blocks + 1, first);
	emit_list(e, "block_state", states, state);
}

/* Opens the loop over them. `further`: entries behind the states that every block has */
static void emit_block_loop(const struct emitter *e, int further)
{
	say(e, "    for (block = 0; block < %d; block++) {\n"
	       "        const unsigned short *const at = $n_block_state + $n_block_first[block];\n"
	       "        const int states = $n_block_first[block + 1] - $n_block_first[block], size = states%s;\n",
	    count_blocks(e), further ? format(" + %d", further) : "");
}

/* ---- at ---- */

void declare_blockwise_at(const struct emitter *e)
{
	const int size = largest_block(e) + e->step->layout.size - e->system->states;
	say(e, "    double x[%d], part[%d], A[%d], work[%d];\n"
	       "    pl_series series;\n"
	       "    int block, j;\n",
	    e->step->layout.size, size, size * size, 2 * size);
}

/* x, as declared and filled, tau later */
void emit_blockwise_at(const struct emitter *e)
{
	const struct series *series = &e->step->series;
	say(e, "    series.degree = %d;\n"
	       "    series.halvings = %d;\n"
	       "    series.A = A;\n", series->degree, series->halvings);
	emit_block_loop(e, e->step->layout.size - e->system->states);
	say(e, "        for (i = 0; i < size; i++) {\n"
	       "            const int row = i < states ? at[i] : $N_STATES + i - states;\n"
	       "            part[i] = x[row];\n"
	       "            for (j = 0; j < size; j++)\n"
	       "                A[size * i + j] = $n_slope[row][j < states ? at[j] : $N_STATES + j - states];\n"
	       "        }\n"
	       "        series.size = size;\n"
	       "        series.states = states;\n"
	       "        pl_series_advance(&series, tau, part, work);\n"
	       "        for (i = 0; i < states; i++)\n"
	       "            x[at[i]] = part[i];\n"
	       "    }\n");
}

/* ---- jump ---- */

/* A state's place in the block; load states come behind the states */
static void emit_leap_entries(const struct emitter *e, int entries)
{
	if (entries == 0)
		return;
	say(e, "        for (i = 0; i < %d; i++) {\n"
	       "            const int row = $n_power_entry[i].row, column = $n_power_entry[i].column;\n"
	       "            int place = row - $N_STATES + states;\n"
	       "            for (j = 0; row < $N_STATES && j < states; j++)\n"
	       "                if (at[j] == row)\n"
	       "                    place = j;\n"
	       "            if (place >= 0 && (row >= $N_STATES || (place < states && at[place] == row))%s)\n"
	       "                power[size * place + column - $N_STATES + states] = $n_power_entry[i].value;\n"
	       "        }\n",
	    entries, e->system->segments > 1 ? spell(e, "\n                && $n_power_entry[i].segment == s->segment")
					     : "");
}

static void emit_carries(const struct emitter *e, const char *layout)
{
	for (int i = 0; i < e->system->states; i++)
		if (e->step->carry[i] >= 0)
			say(e, layout, i, e->step->carry[i]);
}

void declare_blockwise_leap(const struct emitter *e, const struct leap *leap)
{
	const int further = leap->size - e->system->states, size = largest_block(e) + further;
	say(e, "    pl_two power[%d], work[%d], x[%d], w[%d]%s;\n", size * size, size * size, size, size,
	    further ? format(", load[%d]", further) : "");
}

void emit_blockwise_leap(const struct emitter *e, const struct leap *leap, int entries)
{
	const int further = leap->size - e->system->states;
	const char *Phi = stepped_table(e, "Phi");
	say(e, "    int block, i, j;\n");
	emit_block_loop(e, further);
	say(e, "        for (i = 0; i < size * size; i++) {\n"
	       "            power[i].hi = 0.0;\n"
	       "            power[i].lo = 0.0;\n"
	       "        }\n"
	       "        for (i = 0; i < states; i++) {\n"
	       "            for (j = 0; j < states; j++) {\n"
	       "                power[size * i + j].hi = %s[at[i]][at[j]];\n"
	       "                power[size * i + j].lo = $n_Phi_low[at[i]][at[j]];\n"
	       "            }\n"
	       "            x[i].hi = s->y[at[i]];\n"
	       "            x[i].lo = 0.0;\n", Phi);
	emit_carries(e, "            if (at[i] == %d)\n"
			"                x[i].lo = s->carry[%d];\n");
	say(e, "        }\n");
	if (further)
		say(e, "        for (i = 0; i < %d; i++)\n"
		       "            x[states + i] = load[i];\n", further);
	emit_leap_entries(e, entries);
	say(e, "        pl_power_apply(size, power, work, x, w, n);\n"
	       "        for (i = 0; i < states; i++) {\n"
	       "            s->y[at[i]] = x[i].hi;\n");
	emit_carries(e, "            if (at[i] == %d)\n"
			"                s->carry[%d] = x[i].lo;\n");
	say(e, "        }\n"
	       "    }\n");
}
