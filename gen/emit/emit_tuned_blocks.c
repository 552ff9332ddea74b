/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tunable params of a large step: an instance holds the factors of the independent blocks that params touch, and
 * NAME_retune computes these anew on the target; the other blocks keep their tables. */
#include "emit/emit.h"

static const struct tuned_blocks *blocks_of_step(const struct emitter *e)
{
	return e->step->blocks;
}

static const struct group *group_at(const struct emitter *e, int index)
{
	return &e->step->program->group[index];
}

/* ---- the header ---- */

static int count_touched(const struct emitter *e)
{
	int touched = 0;
	for (int b = 0; b < blocks_of_step(e)->blocks; b++)
		touched += blocks_of_step(e)->block[b].group->tuned;
	return touched;
}

void banner_tuned_blocks(const struct emitter *e)
{
	const int blocks = blocks_of_step(e)->blocks, touched = count_touched(e);
	const char *of = touched == blocks ? format("all %d", touched) : format("%d of %d", touched, blocks);
	say(e, " * Tunable: %s.\n"
	       " * They touch %s independent blocks; $n_retune computes the factors of these from other values%s,\n"
	       " * of a block whose params are the spec's these, correctly rounded. It needs some %d KB of stack.\n",
	    param_list(e), of, blocks_of_step(e)->whole ? " and another h" : "",
	    blocks_of_step(e)->kilobytes);
}

static const char *first_state(const struct emitter *e, const struct group *g)
{
	return format("%s%s", e->model->state_name[g->state[0]], g->states * g->blocks > 1 ? ", ..." : "");
}

static void emit_block_members(const struct emitter *e)
{
	for (int k = 0; k < e->step->program->groups; k++) {
		const struct group *g = group_at(e, k);
		if (!g->tuned)
			continue;
		const struct group_shape shape = shape_of_group(e, g);
		if (shape.rows)
			coefficient_member(e, format("double %s%d[%d][%d];", shape.name, k, shape.rows, shape.columns),
					   first_state(e, g));
		if (shape.changing)
			coefficient_member(e, format("double loads%d[%d][%d][%d];", k, e->system->segments,
						     shape.changing, shape.columns),
					   "in each segment of time");
	}
}

static void emit_nominal_blocks(const struct emitter *e)
{
	for (int k = 0; k < e->step->program->groups; k++) {
		const struct group *g = group_at(e, k);
		if (!g->tuned)
			continue;
		const struct group_shape shape = shape_of_group(e, g);
		if (shape.rows) {
			say(e, "    {  /* %s */\n", group_note(e, g));
			emit_group_numbers(e, g, false);
			say(e, "    },\n");
		}
		if (shape.changing) {
			say(e, "    {\n");
			emit_group_numbers(e, g, true);
			say(e, "    },\n");
		}
	}
}

void emit_block_coefficients(const struct emitter *e)
{
	emit_coefficients_with(e, emit_block_members);
}

void emit_block_declarations(const struct emitter *e)
{
	emit_tuning_functions(e, !blocks_of_step(e)->whole);
}

void emit_block_nominal(const struct emitter *e)
{
	emit_nominal_with(e, emit_nominal_blocks);
}

/* ---- the equations on the target ---- */

/* Blocks in tables: all where NAME_at is there, else those that params touch */
static bool is_listed(const struct emitter *e, int block)
{
	return e->step->series.emitted || blocks_of_step(e)->block[block].group->tuned;
}

static int number_of_block(const struct emitter *e, int block)
{
	int number = 0;
	for (int b = 0; b < block; b++)
		number += is_listed(e, b);
	return number;
}

static int emit_part_terms(const struct emitter *e, const struct tuned_part *part)
{
	for (const struct part_term *term = part->term; term < part->term + part->terms; term++)
		say(e, "    {%d, %d, %d, %s},  /* %s */\n", term->row, term->column, term->of->monomial,
		    two_words(equation_number(e->model, term->of->factor)), tuned_term_note(e, term->of));
	return part->terms;
}

static int count_terms(const struct emitter *e)
{
	int terms = blocks_of_step(e)->others.terms;
	for (int b = 0; b < blocks_of_step(e)->blocks; b++)
		terms += is_listed(e, b) ? blocks_of_step(e)->block[b].part.terms : 0;
	return terms;
}

static void emit_terms(const struct emitter *e)
{
	const struct tuned_blocks *p = blocks_of_step(e);
	emit_monomials(e, e->model->tuning, "");
	if (count_terms(e) == 0)
		return;
	say(e, "\nstatic const pl_term $n_term[%d] = {  /* row, column, product of params, factor */\n",
	    count_terms(e));
	for (int b = 0; b < p->blocks; b++)
		if (is_listed(e, b))
			emit_part_terms(e, &p->block[b].part);
	emit_part_terms(e, &p->others);
	say(e, "};\n");
}

static const char *equations_text(const struct emitter *e, const struct tuned_part *part, int first)
{
	const struct tuning *t = e->model->tuning;
	return format("{%d, %d, %d, %s_PARAMS, %d, %d, %s, %s}", part->rows, part->columns, t->solves, e->upper,
		      t->monomials, part->terms, t->monomials ? format("%s_monomial", e->name) : "NULL",
		      part->terms ? format("%s_term + %d", e->name, first) : "NULL");
}

/* What a block says by lists of places: rows of A, turning loads, ramps, its x in that of the whole */
struct lists {
	int count, *place;
};

static int add_place(struct lists *l, int place)
{
	ENLARGE(l->place, (size_t)l->count + 1);
	l->place[l->count] = place;
	return l->count++;
}

static int add_places(struct lists *l, int count, const int *place)
{
	const int first = l->count;
	for (int i = 0; i < count; i++)
		add_place(l, place[i]);
	return first;
}

/* Where its x is found in that of the whole */
static int add_columns(struct lists *l, const struct emitter *e, const struct tuned_block *b)
{
	const struct group *g = b->group;
	const struct table *table = e->step->branch->whole;
	const int first = l->count;
	for (int i = 0; i < g->states; i++)
		add_place(l, g->state[i * g->blocks + b->block]);
	for (int k = 0; k < g->loads; k++)
		add_place(l, table->states + g->load[k]);
	for (int k = 0; k < g->inputs; k++)
		add_place(l, table->states + table->columns + g->input[k]);
	return first;
}

static const char *list_text(const struct emitter *e, int count, int first)
{
	return count ? format("%s_places + %d", e->name, first) : "NULL";
}

static const char *block_text(const struct emitter *e, const struct tuned_block *b, struct lists *l, int term,
			      int entry)
{
	const struct group *g = b->group;
	const char *rows = list_text(e, b->derivatives, add_places(l, b->derivatives, b->place));
	const char *turns = list_text(e, b->turns, add_places(l, 2 * b->turns, b->turn));
	const char *ramps = list_text(e, b->ramps, add_places(l, b->ramps, b->ramp));
	return format("{%s,\n     %d, %d, %d, %d, %d, %s, %d, %s, %d, %s, %d, %s}", equations_text(e, &b->part, term),
		      g->states, g->loads, g->inputs, e->system->segments, b->derivatives, rows, b->slopes,
		      b->slopes ? format("%s_entry + %d", e->name, entry) : "NULL", b->turns, turns, b->ramps, ramps);
}

static void emit_entries(const struct emitter *e)
{
	const struct tuned_blocks *p = blocks_of_step(e);
	int entries = 0;
	for (int b = 0; b < p->blocks; b++)
		entries += is_listed(e, b) ? p->block[b].slopes : 0;
	if (entries == 0)
		return;
	say(e, "\nstatic const pl_entry $n_entry[%d] = {  /* of x' = A x, which no param changes */\n", entries);
	for (int b = 0; b < p->blocks; b++) {
		if (!is_listed(e, b) || p->block[b].slopes == 0)
			continue;
		say(e, "    ");
		for (int i = 0; i < p->block[b].slopes; i++) {
			const struct fixed_slope *slope = &p->block[b].slope[i];
			say(e, "%s{%d, %d, %s}", !i ? "" : i % 5 ? ", " : ",\n    ", slope->row, slope->column,
			    two_words(slope->value));
		}
		say(e, ",\n");
	}
	say(e, "};\n");
}

static void emit_shorts(const struct emitter *e, const char *name, int count, const int *value)
{
	say(e, "\nstatic const unsigned short $n_%s[%d] = {", name, count);
	for (int i = 0; i < count; i++)
		say(e, "%s%d", !i ? "" : i % 20 ? ", " : ",\n    ", value[i]);
	say(e, "};\n");
}

/* The blocks themselves. places: of each x, where NAME_at asks for it */
static void emit_block_tables(const struct emitter *e)
{
	const struct tuned_blocks *p = blocks_of_step(e);
	struct lists lists = { 0, NULL }, first = { 0, NULL };
	const char **text = ARRAY(const char *, (size_t)p->blocks);
	const int listed = number_of_block(e, p->blocks);
	int term = 0, entry = 0;
	if (listed == 0)
		return;
	for (int b = 0; b < p->blocks; b++) {
		if (!is_listed(e, b))
			continue;
		text[b] = block_text(e, &p->block[b], &lists, term, entry);
		term += p->block[b].part.terms;
		entry += p->block[b].slopes;
		if (e->step->series.emitted)
			add_place(&first, add_columns(&lists, e, &p->block[b]));
	}
	emit_entries(e);
	emit_shorts(e, "places", lists.count, lists.place);
	if (first.count)
		emit_shorts(e, "first_place", first.count, first.place);
	say(e, "\n/* Independent blocks%s */\n"
	       "static const pl_block $n_block[%d] = {\n", listed < p->blocks ? " that params touch" : "", listed);
	for (int b = 0; b < p->blocks; b++)
		if (is_listed(e, b))
			say(e, "    %s,  /* %s */\n", text[b],
			    e->model->state_name[p->block[b].group->state[p->block[b].block]]);
	say(e, "};\n");
}

/* ---- retune ---- */

static void emit_unchanged(const struct emitter *e)
{
	const struct tuned_blocks *p = blocks_of_step(e);
	int *reads = ARRAY(int, (size_t)p->blocks), listed = 0;
	if (count_touched(e) == 0)
		return;
	for (int b = 0; b < p->blocks; b++)
		if (is_listed(e, b))
			reads[listed++] = (int)p->block[b].part.params;
	emit_shorts(e, "reads", listed, reads);
	say(e, "\n/* Are the params that a block reads, and h, those of the spec? */\n"
	       "static int $n_unchanged(const double *params, double h, int block)\n"
	       "{\n"
	       "    int i, same = h == $N_H;\n"
	       "    for (i = 0; i < $N_PARAMS; i++)\n"
	       "        if (($n_reads[block] >> i & 1) != 0 && params[i] != $n_nominal.params[i])\n"
	       "            same = 0;\n"
	       "    return same;\n"
	       "}\n");
}

/* In the place of columns of an input's derivatives those of its samples, in row d of e^{A h} - I */
static void emit_samples_of_row(const struct emitter *e, const struct group *g, const char *indent)
{
	for (int i = 0, column = 0; i < e->system->inputs; column += e->system->input[i++].hold + 1) {
		const int hold = e->system->input[i].hold;
		const int at = g->states + g->loads + place_in(g->inputs, g->input, column);
		if (hold == 0 || at == g->states + g->loads + g->inputs)
			continue;
		say(e, "%s    {\n", indent);
		for (int c = 0; c <= hold; c++) {
			const char *ramp = c ? format("d[%d].hi / h", at + 1)
					     : format("pl_ramp_before(d[%d], d[%d], h)", at, at + 1);
			say(e, "%s        const double tap%d = %s;\n", indent, c,
			    hold == 1 ? ramp : tap_factor(e, i, c, "d", at));
		}
		for (int c = 0; c <= hold; c++)
			say(e, "%s        d[%d].hi = tap%d;\n", indent, at + c, c);
		say(e, "%s    }\n", indent);
	}
}

static bool reads_samples(const struct emitter *e, const struct group *g)
{
	bool any = false;
	for (int i = 0, column = 0; i < e->system->inputs; column += e->system->input[i++].hold + 1)
		any = any || (e->system->input[i].hold && place_in(g->inputs, g->input, column) < g->inputs);
	return any;
}

static void emit_finish_rows(const struct emitter *e, const struct group *g, const char *indent)
{
	const bool direct = e->step->form == FORM_DIRECT;
	if (!direct && !reads_samples(e, g))
		return;
	say(e, "%sfor (i = 0; i < %d; i++) {\n"
	       "%s    pl_two *const d = D[0][i];\n", indent, g->states, indent);
	if (direct)
		say(e, "%s    d[i].hi = (1.0 + d[i].hi) + d[i].lo;\n", indent);
	emit_samples_of_row(e, g, indent);
	say(e, "%s}\n", indent);
}

/* From D to the instance's rows: states, load states in each segment, inputs */
static void emit_take_rows(const struct emitter *e, const struct group *g, int index)
{
	const int segments = e->system->segments, states = g->states, loads = g->loads;
	const int head = segments > 1 ? states : states + loads + g->inputs;
	say(e, "    for (i = 0; i < %d; i++)\n"
	       "        for (j = 0; j < %d; j++)\n"
	       "            c->rows%d[i][j] = D[0][i][j].hi;\n", states, head, index);
	if (segments > 1 && loads)
		say(e, "    for (i = 0; i < %d; i++)\n"
		       "        for (j = 0; j < %d; j++)\n"
		       "            c->rows%d[i][%d + j] = D[j / %d][i][%d + j %% %d].hi;\n",
		    states, segments * loads, index, states, loads, states, loads);
	if (segments > 1 && g->inputs)
		say(e, "    for (i = 0; i < %d; i++)\n"
		       "        for (j = 0; j < %d; j++)\n"
		       "            c->rows%d[i][%d + j] = D[0][i][%d + j].hi;\n",
		    states, g->inputs, index, states + segments * loads, states + loads);
}

static void emit_take_columns(const struct emitter *e, const struct group *g, int index)
{
	const bool changing = shape_of_group(e, g).changing > 0;
	const int skipped = changing ? g->loads : 0, columns = g->states + g->loads + g->inputs - skipped;
	const char *from = skipped && g->inputs ? format("j < %d ? j : j + %d", g->states, skipped) : "j";
	say(e, "    for (j = 0; j < %d; j++)\n"
	       "        for (i = 0; i < %d; i++)\n"
	       "            c->columns%d[j][i] = D[0][i][%s].hi;\n", columns, g->states, index, from);
	if (changing)
		say(e, "    for (j = 0; j < %d; j++)\n"
		       "        for (i = 0; i < %d; i++)\n"
		       "            c->loads%d[j / %d][j %% %d][i] = D[j / %d][i][%d + j %% %d].hi;\n",
		    e->system->segments * g->loads, g->states, index, g->loads, g->loads, g->loads, g->states,
		    g->loads);
}

static void emit_alike_list(const struct emitter *e, const struct group *g, const char *name, bool changing)
{
	const struct group_shape shape = shape_of_group(e, g);
	const int terms = changing ? shape.changing : shape.rows;
	if (terms == 0)
		return;
	say(e, "    static const unsigned char %s[%d][2] = {", name, terms);
	for (int k = 0; k < terms; k++) {
		int column, row = alike_entry(e, g, changing, k, &column);
		say(e, "%s{%d, %d}", !k ? "" : k % 12 ? ", " : ",\n        ", row, column);
	}
	say(e, "};  /* row, column */\n");
}

static void emit_take_alike(const struct emitter *e, const struct group *g, int index)
{
	const struct group_shape shape = shape_of_group(e, g);
	if (shape.rows)
		say(e, "        for (i = 0; i < %d; i++)\n"
		       "            c->alike%d[i][b] = D[0][entry[i][0]][entry[i][1]].hi;\n", shape.rows, index);
	if (shape.changing)
		say(e, "        for (j = 0; j < %d; j++)\n"
		       "            for (i = 0; i < %d; i++)\n"
		       "                c->loads%d[j][i][b] = D[j][load[i][0]][load[i][1]].hi;\n",
		    e->system->segments, shape.changing, index);
}

static bool has_taps(const struct emitter *e, const struct group *g)
{
	bool any = false;
	for (int i = 0, column = 0; i < e->system->inputs; column += e->system->input[i++].hold + 1)
		any = any || (e->system->input[i].hold > 1 && place_in(g->inputs, g->input, column) < g->inputs);
	return any;
}

static int work_of_group(const struct emitter *e, const struct group *g, int first)
{
	const struct tuned_block *block = &blocks_of_step(e)->block[first];
	int most = 0;
	for (int b = 0; b < g->blocks; b++, block++) {
		const int further = PL_INCREMENT_WORK(block->size), products = e->model->tuning->monomials + 1;
		const int work = block->part.rows * block->part.width + block->size * block->size +
				 (products > further ? products : further);
		most = work > most ? work : most;
	}
	return most;
}

static void emit_increment_of(const struct emitter *e, const char *number, const char *indent, const char *same)
{
	say(e, "%sif ($n_unchanged(params, h, %s))\n"
	       "%s    %s;\n", indent, number, indent, same);
	say(e, "%sstatus = pl_block_increment(&$n_block[%s], params, h, D[0][0], work);\n"
	       "%sif (status != 0)\n"
	       "%s    return status;\n", indent, number, indent, indent);
}

/* One block after the other: `number` is that of the first in the table */
static void emit_alike_retune(const struct emitter *e, const struct group *g, int index, int number)
{
	say(e, "    for (b = 0; b < %d; b++) {\n", g->blocks);
	emit_increment_of(e, number ? format("%d + b", number) : "b", "        ", "continue");
	emit_finish_rows(e, g, "        ");
	emit_take_alike(e, g, index);
	say(e, "    }\n");
}

/* The blocks of a group. first: in struct tuned_blocks */
static void emit_group_retune(const struct emitter *e, const struct group *g, int index, int first)
{
	const bool alike = g->kind == GROUP_ALIKE;
	const int size = blocks_of_step(e)->block[first].size, number = number_of_block(e, first);
	say(e, "\n"
	       "/* %s; c is as the spec's values have it */\n"
	       "static int $n_retune%d($n_coeffs *c, const double *params, double h)\n"
	       "{\n", first_state(e, g), index);
	if (alike) {
		emit_alike_list(e, g, "entry", false);
		emit_alike_list(e, g, "load", true);
	}
	say(e, "    pl_two D[%d][%d][%d], work[%d];\n"
	       "    int i, %sstatus;\n", e->system->segments, g->states, size, work_of_group(e, g, first),
	    !alike ? "j, " : shape_of_group(e, g).changing ? "j, b, " : "b, ");
	if (has_taps(e, g))
		emit_powers_of_h(e);
	if (alike) {
		emit_alike_retune(e, g, index, number);
	} else {
		emit_increment_of(e, format("%d", number), "    ", "return 0");
		emit_finish_rows(e, g, "    ");
		(g->kind == GROUP_ROWS ? emit_take_rows : emit_take_columns)(e, g, index);
	}
	say(e, "    return 0;\n"
	       "}\n");
}

/* Is there something beside the blocks? Where h may change, loads' steps do. */
static bool has_others(const struct emitter *e)
{
	return blocks_of_step(e)->others.rows > 0 || (blocks_of_step(e)->whole && e->phases + e->growths > 0);
}

static void emit_tuned_loads(const struct emitter *e)
{
	const struct tuned_blocks *p = blocks_of_step(e);
	if (p->whole) {
		emit_take_loads(e, p->frequency);
		return;
	}
	for (int l = 0; l < e->system->loads; l++)
		if (p->frequency[l] >= 0 && e->phase[l] >= 0)
			say(e, "    c->phase_rate[%d] = pl_rate_of(value[%d][0]);\n"
			       "    c->phase_step[%d] = pl_turn_at(&c->phase_rate[%d], h);\n",
			    e->phase[l], p->frequency[l], e->phase[l], e->phase[l]);
}

static int first_term_of_others(const struct emitter *e)
{
	return count_terms(e) - blocks_of_step(e)->others.terms;
}

static void emit_value_of_others(const struct emitter *e)
{
	const struct tuned_part *part = &blocks_of_step(e)->others;
	say(e, "    pl_two value[%d][%d], work[%d];\n"
	       "    int status = pl_equations_at(&$n_equations, params, value[0], work);\n",
	    part->rows, part->width, e->model->tuning->monomials + 1);
	emit_frequency_check(e, blocks_of_step(e)->frequency);
	say(e, "    if (status != 0)\n"
	       "        return status;\n");
}

static void emit_others(const struct emitter *e)
{
	const struct tuning *t = e->model->tuning;
	const struct tuned_blocks *p = blocks_of_step(e);
	const bool steps = t->frequencies > 0 || p->whole;
	if (!has_others(e))
		return;
	if (p->others.rows)
		say(e, "\n/* %s%s */\n"
		       "static const pl_equations $n_equations = %s;\n",
		    !t->outputs         ? "Frequencies of loads"
		    : p->first_output   ? "Derivatives that outputs read, and outputs, over x"
					: "Outputs, over x",
		    t->outputs && t->frequencies ? "; frequencies of loads, in column 0" : "",
		    equations_text(e, &p->others, first_term_of_others(e)));
	say(e, "\nstatic int $n_retune_others($n_coeffs *c, const double *params, double h)\n"
	       "{\n");
	if (t->outputs || (p->whole && e->phases))
		say(e, "    int i%s;\n", t->outputs ? ", j" : "");
	if (p->others.rows)
		emit_value_of_others(e);
	if (t->outputs)
		say(e, "    for (i = 0; i < %d; i++)\n"
		       "        for (j = 0; j < %d; j++)\n"
		       "            c->out[i][j] = value[%s][j].hi;\n", t->outputs, t->x.size,
		    p->first_output ? format("%d + i", p->first_output) : "i");
	emit_tuned_loads(e);
	if (!p->others.rows)
		say(e, "    (void)params;\n");
	if (!steps || e->phases + e->growths == 0)
		say(e, "    (void)h;\n");
	say(e, "    return 0;\n"
	       "}\n");
}

static void emit_retune_all(const struct emitter *e)
{
	const bool whole = blocks_of_step(e)->whole;
	say(e, "\nint $n_retune($n_coeffs *c, const double params[$N_PARAMS], double h)\n"
	       "{\n"
	       "    $n_coeffs fresh = $n_nominal;\n"
	       "    int i, status = 0;\n"
	       "    if (%s)\n"
	       "        return PL_NO_STEP;\n"
	       "    for (i = 0; i < $N_PARAMS; i++) {\n"
	       "        if (params[i] - params[i] != 0.0)\n"
	       "            return PL_NOT_FINITE;\n"
	       "        fresh.params[i] = params[i];\n"
	       "    }\n", whole ? "!(h > 0.0)" : spell(e, "h != $N_H"));
	if (whole)
		say(e, "    fresh.h = h;\n");
	if (whole && e->system->segments > 1)
		say(e, "    fresh.h_low = 0.0;\n");
	if (has_others(e))
		say(e, "    status = $n_retune_others(&fresh, params, h);\n");
	for (int k = 0; k < e->step->program->groups; k++)
		if (group_at(e, k)->tuned)
			say(e, "    if (status == 0)\n"
			       "        status = $n_retune%d(&fresh, params, h);\n", k);
	say(e, "    if (status == 0)\n"
	       "        *c = fresh;\n"
	       "    return status;\n"
	       "}\n");
}

static void emit_blocks_retune(const struct emitter *e)
{
	const struct tuned_blocks *p = blocks_of_step(e);
	emit_terms(e);
	emit_block_tables(e);
	emit_unchanged(e);
	for (int b = 0; b < p->blocks; b += p->block[b].group->blocks)
		if (p->block[b].group->tuned)
			emit_group_retune(e, p->block[b].group, p->block[b].index, b);
	emit_others(e);
	emit_retune_all(e);
}

/* ---- any time ---- */

/* To each change of the loads on the way */
static void emit_block_changes(const struct emitter *e, int changes)
{
	say(e, "        for (segment = s->segment; segment < %d && $n_until(s, segment) < tau; segment++) {\n"
	       "            const double ahead = $n_until(s, segment);\n"
	       "            if (ahead > done) {\n"
	       "                pl_block_advance(block, s->coeffs.params, segment, ahead - done, part, work);\n"
	       "                done = ahead;\n"
	       "            }\n"
	       "        }\n", changes);
}

static void emit_blocks_pass(const struct emitter *e)
{
	const struct tuned_blocks *p = blocks_of_step(e);
	const int changes = e->system->segments - 1;
	say(e, "\n/* The state tau after now, block by block%s */\n"
	       "static void $n_pass(const $n *s, %sdouble tau, double y[$N_STATES])\n"
	       "{\n"
	       "    pl_two work[%d];\n"
	       "    double x[%d], part[%d];\n"
	       "    int b%s;\n", changes ? ", from change to change of the loads on the way" : "",
	    given_inputs(e) ? format("const double u[%s_INPUTS], ", e->upper) : "", p->more, e->step->layout.size,
	    p->size, changes ? ", segment" : "");
	emit_series_vector(e);
	say(e, "    for (b = 0; b < %d; b++) {\n"
	       "        const pl_block *const block = &$n_block[b];\n"
	       "        const unsigned short *const at = $n_places + $n_first_place[b];\n", p->blocks);
	if (changes)
		say(e, "        double done = 0.0;\n");
	say(e, "        for (i = 0; i < block->states + block->loads + block->inputs; i++)\n"
	       "            part[i] = x[at[i]];\n");
	if (changes)
		emit_block_changes(e, changes);
	say(e, "        pl_block_advance(block, s->coeffs.params, %s, part, work);\n"
	       "        for (i = 0; i < block->states; i++)\n"
	       "            y[at[i]] = part[i];\n"
	       "    }\n"
	       "}\n", changes ? "segment, tau - done" : "0, tau");
}

void emit_blocks_tuning(const struct emitter *e)
{
	emit_blocks_retune(e);
	emit_use_function(e);
	if (e->step->series.emitted)
		emit_blocks_pass(e);
}
