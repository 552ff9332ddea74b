/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear models with tunable params: an instance holds its own factors, of a large model those of independent blocks
 * that params touch, and NAME_retune, of retune.h, computes them anew on the target. What it is given: equations,
 * blocks, which it takes together in groups, sizes. */
#include "inner.h"
#include "emit/linear/blocks.h"
#include "emit/declarations.h"
#include "emit/steps.h"
#include "model/reads.h"
#include "step/linear/rows.h"
#include "step/tunable/tuned.h"

static const struct tuned_blocks *blocks_of_step(const struct emitter *e)
{
	return e->step->blocks;
}

/* ---- what an instance has: declared, or the generator's own ---- */

static const char *first_state(const struct emitter *e, const struct group *g)
{
	return format("%s%s", e->model->names.state[g->state[0]], g->states * g->blocks > 1 ? ", ..." : "");
}

/* Of a group's factors in NAME_coeffs: "rows0" */
static const char *tuned_table(const struct emitter *e, const struct tuned_block *first)
{
	const char *name = shape_of_group(e, first->group).name;
	return blocks_of_step(e)->solved ? "step" : format("%s%d", name, first->index);
}

/* Calls print(e, the first of its blocks) for each group whose factors the instance has */
static void each_tuned_group(const struct emitter *e,
			     void (*print)(const struct emitter *e, const struct tuned_block *first))
{
	const struct tuned_blocks *p = blocks_of_step(e);
	for (int b = 0; b < p->blocks; b += p->block[b].group->blocks)
		if (p->block[b].group->tuned)
			print(e, &p->block[b]);
}

static void emit_outputs(const struct emitter *e)
{
	const struct tuning *t = e->model->params.tuning;
	const char **name = ARRAY(const char *, (size_t)t->outputs);
	for (int o = 0; o < e->model->outputs; o++)
		if (t->output[o] >= 0)
			name[t->output[o]] = e->model->output[o].name;
	open_member(e, "double", "out", format("[%d][%d]", t->outputs, t->x.size),
		    format("out z, where outputs depend on params%s",
			   e->ramps ? "; of a ramp its value and its slope" : ""));
	emit_number_rows(e, t->outputs, t->x.size, nominal_outputs(e->step), name);
	close_member(e);
}

/* What of each load moves on in a step: its phase, or its envelope */
static void emit_loads(const struct emitter *e, const char *type, const char *name, int count, const int *index,
		       const char *(*step_text)(const struct emitter *, int))
{
	if (count == 0)
		return;
	open_member(e, type, name, format("[%d]", count), "of the loads, in one step");
	for (int l = 0; l < e->system->loads; l++)
		if (index[l] >= 0)
			say(e, "    %s,  /* %s */\n", step_text(e, l), column_text(&e->system->load[l], 0));
	close_member(e);
}

static void emit_group(const struct emitter *e, const struct tuned_block *first)
{
	const struct group_shape shape = shape_of_group(e, first->group);
	const char *full = e->step->form == FORM_DELTA ? "y += step z" : "y = step z";
	if (shape.rows) {
		open_member(e, "double", tuned_table(e, first), format("[%d][%d]", shape.rows, shape.columns),
			    blocks_of_step(e)->solved ? full : format("%s: %s", first_state(e, first->group),
								       group_note(e, first->group)));
		emit_group_numbers(e, first->group, false);
		close_member(e);
	}
	if (shape.changing) {
		open_member(e, "double", format("loads%d", first->index),
			    format("[%d][%d][%d]", e->system->segments, shape.changing, shape.columns),
			    "in each segment of time");
		emit_group_numbers(e, first->group, true);
		close_member(e);
	}
}

void emit_tuned_members(const struct emitter *e)
{
	number_member(e, "h", spell(e, "$N_H"), "[s]");
	if (loads_change(e->system))
		number_member(e, "h_low", low_text(e->model->h), "of the spec's step: what h leaves out; else 0");
	emit_nominal_params(e);
	each_tuned_group(e, emit_group);
	if (e->model->params.tuning->outputs)
		emit_outputs(e);
	emit_nominal_peaks(e);
	emit_loads(e, "pl_phase", "phase_step", e->phases, e->phase, phase_step_text);
	if (e->phases && e->model->params.tuning->frequencies) {
		open_member(e, "pl_rate", "phase_rate", format("[%d]", e->phases), "in turns per second");
		emit_phase_rates(e);
		close_member(e);
	}
	emit_loads(e, "pl_envelope", "envelope_step", e->envelopes, e->envelope, envelope_step_text);
}

/* ---- the equations on the target ---- */

/* Of the blocks, then of others; of one block both follow from params by its formulas */
static struct equations_text *emit_all_equations(const struct emitter *e)
{
	const struct tuned_blocks *p = blocks_of_step(e);
	SCRATCH const struct tuned_equations **list = ARRAY(const struct tuned_equations *, (size_t)p->blocks + 1);
	struct equations_text *text = ARRAY(struct equations_text, (size_t)p->blocks + 1);
	for (int b = 0; b < p->blocks; b++)
		list[b] = &p->block[b].A;
	list[p->blocks] = &p->others;
	emit_equations(e, e->model->params.tuning, p->solved, p->blocks + 1, list, text);
	return text;
}

/* What blocks and groups of them say by lists: places of x in that of the whole, inputs with further samples; factors
 * of blocks alike; parts of derivatives in samples */
struct lists {
	int count, *place;
};
struct listed {
	struct lists place, entry;
	int sample_weights;
	const char *sample_weight;
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

static const char *list_text(const struct emitter *e, int count, int first)
{
	return count ? format("%s_places + %d", e->name, first) : "NULL";
}

static void emit_lists(const struct emitter *e, const struct listed *l)
{
	if (l->place.count)
		emit_integers(e, "unsigned short", "places", l->place.count, l->place.place);
	if (l->entry.count)
		emit_integers(e, "unsigned char", "alike_entry", l->entry.count, l->entry.place);
	if (l->sample_weights)
		say(e, "\nstatic const double $n_sample_weight[%d] = {%s};\n", l->sample_weights, l->sample_weight);
}

static const char *block_text(const struct emitter *e, const struct tuned_block *b, struct lists *l,
			      const struct equations_text *text)
{
	const struct group *g = b->group;
	const bool placed = e->step->series.emitted && !blocks_of_step(e)->solved;
	const char *places = placed ? list_text(e, 1, add_places(l, b->size, b->from)) : "NULL";
	return format("{%s, %s,\n     %d, %d, %d, %d, %s}", text->formulas, text->entries, g->states, g->loads,
		      g->inputs, e->system->segments, places);
}

static void emit_blocks(const struct emitter *e, const char *const *text)
{
	const struct tuned_blocks *p = blocks_of_step(e);
	say(e, "\n/* Independent blocks of the equations%s */\n"
	       "static const pl_block $n_block[%d] = {\n", p->blocks < p->all ? " that params touch" : "", p->blocks);
	for (int b = 0; b < p->blocks; b++)
		say(e, "    %s,  /* %s */\n", text[b], e->model->names.state[p->block[b].from[0]]);
	say(e, "};\n");
}

/* ---- groups of blocks ---- */

/* What each of its samples gets of an input's derivatives, in units of the step */
static void add_sample_weights(struct listed *l, int hold)
{
	RATIONAL weight = ZERO, one = RATIO(1, 1);
	for (int i = 0; i < (hold + 1) * (hold + 1); i++) {
		sample_derivative(hold, i % (hold + 1), i / (hold + 1), one, weight);
		l->sample_weight = format("%s%s%s", l->sample_weights ? l->sample_weight : "",
					  l->sample_weights ? ", " : "", shortest(round_rational(weight)));
		l->sample_weights++;
	}
}

/* Inputs with further samples: places in x, derivatives; how many there are */
static int add_samples(struct listed *l, const struct emitter *e, const struct group *g)
{
	int samples = 0;
	for (int i = 0, column = 0; i < e->system->inputs; column += e->system->input[i++].hold + 1) {
		const int hold = e->system->input[i].hold, place = place_in(g->inputs, g->input, column);
		if (hold == 0 || place == g->inputs)
			continue;
		add_place(&l->place, g->states + g->loads + place);
		add_place(&l->place, hold);
		if (hold > 1)
			add_sample_weights(l, hold);
		samples++;
	}
	return samples;
}

static const char *add_alike(struct listed *l, const struct emitter *e, const struct group *g, bool changing, int count)
{
	const int first = l->entry.count;
	for (int k = 0; k < count; k++) {
		int column, row = alike_entry(e, g, changing, k, &column);
		add_place(&l->entry, row);
		add_place(&l->entry, column);
	}
	return count ? format("%s_alike_entry + %d", e->name, first) : "NULL";
}

static const char *group_text(const struct emitter *e, const struct tuned_block *first, struct listed *l)
{
	const struct group *g = first->group;
	const struct group_shape shape = shape_of_group(e, g);
	const bool alike = g->kind == GROUP_ALIKE, by_columns = g->kind == GROUP_COLUMNS;
	const int number = (int)(first - blocks_of_step(e)->block), sample_weights = l->sample_weights;
	const int from = l->place.count, samples = add_samples(l, e, g);
	const char *entry = alike ? add_alike(l, e, g, false, shape.rows) : "NULL";
	const char *load = alike ? add_alike(l, e, g, true, shape.changing) : "NULL";
	return format("{%d, %s_block + %d, %s, %d, %s, %s, %d, %d, %d, %d, %s, %s}", g->blocks, e->name, number,
		      blocks_of_step(e)->solved ? "NULL" : format("%s_reads + %d", e->name, number), samples,
		      list_text(e, samples, from), l->sample_weights > sample_weights
		      ? format("%s_sample_weight + %d", e->name, sample_weights) : "NULL",
		      alike ? 0 : by_columns ? 1 : shape.columns, alike ? 0 : by_columns ? shape.columns : 1,
		      alike ? shape.rows : 0, shape.changing, entry, load);
}

static void emit_groups_of(const struct emitter *e, int groups, const char *const *text)
{
	say(e, "\n/* Blocks of one shape are computed together, as a group */\n"
	       "static const pl_group $n_block_group[%d] = {\n", groups);
	for (int k = 0; k < groups; k++)
		say(e, "    %s%s", text[k], k < groups - 1 ? ",\n" : "\n};\n");
}

static void emit_reads(const struct emitter *e)
{
	const struct tuned_blocks *p = blocks_of_step(e);
	int *reads = ARRAY(int, (size_t)p->blocks);
	for (int b = 0; b < p->blocks; b++)
		reads[b] = (int)p->block[b].params;
	emit_integers(e, "unsigned short", "reads", p->blocks, reads);
}

static void emit_block_tables(const struct emitter *e, const struct equations_text *text)
{
	const struct tuned_blocks *p = blocks_of_step(e);
	const char **block = ARRAY(const char *, (size_t)p->blocks), **group = ARRAY(const char *, (size_t)p->blocks);
	struct listed lists = { 0 };
	int groups = 0;
	for (int b = 0; b < p->blocks; b++)
		block[b] = block_text(e, &p->block[b], &lists.place, &text[b]);
	for (int b = 0; b < p->blocks; b += p->block[b].group->blocks)
		if (p->block[b].group->tuned)
			group[groups++] = group_text(e, &p->block[b], &lists);
	emit_lists(e, &lists);
	if (p->blocks)
		emit_blocks(e, block);
	if (groups && !p->solved)
		emit_reads(e);
	if (groups)
		emit_groups_of(e, groups, group);
}

/* ---- beside the blocks ---- */

static void emit_others(const struct emitter *e, const struct equations_text *text)
{
	const struct tuning *t = e->model->params.tuning;
	if (!blocks_of_step(e)->solved)
		say(e, "\nstatic const pl_formulas $n_formulas = %s;\n", text->formulas);
	if (blocks_of_step(e)->others.rows)
		say(e, "\n/* %s%s */\n"
		       "static const pl_entries $n_others = %s;\n",
		    !t->outputs ? "Frequencies of loads" : "Outputs, over x",
		    t->outputs && t->frequencies ? "; frequencies of loads, in column 0" : "", text->entries);
}

/* By phases: which entry of the equations its frequency is; by envelopes: whether a load decays */
static void emit_rows_of_loads(const struct emitter *e)
{
	const int loads = e->system->loads;
	int *row = ARRAY(int, (size_t)loads + 1), *decays = ARRAY(int, (size_t)loads + 1);
	for (int l = 0; l < loads; l++) {
		if (e->phase[l] >= 0)
			row[e->phase[l]] = blocks_of_step(e)->frequency[l];
		if (e->envelope[l] >= 0)
			decays[e->envelope[l]] = mpq_sgn(e->system->load[l].forcing->a) < 0;
	}
	if (e->model->params.tuning->frequencies)
		emit_integers(e, "short", "rate_entry", e->phases, row);
	if (e->envelopes && blocks_of_step(e)->full)
		emit_integers(e, "unsigned char", "decays", e->envelopes, decays);
}

/* ---- what retune.h is given ---- */

static int most_derivatives(const struct emitter *e)
{
	int most = 0;
	for (int i = 0; i < e->system->inputs; i++)
		most = e->system->input[i].hold > most ? e->system->input[i].hold : most;
	return most;
}

static bool has_kind(const struct emitter *e, bool alike)
{
	const struct tuned_blocks *p = blocks_of_step(e);
	bool any = false;
	for (int b = 0; b < p->blocks; b++)
		any = any || (p->block[b].group->tuned && (p->block[b].group->kind == GROUP_ALIKE) == alike);
	return any;
}

static void emit_sizes_of_tuning(const struct emitter *e)
{
	const struct tuning *t = e->model->params.tuning;
	const struct tuned_blocks *p = blocks_of_step(e);
	emit_sizes(e, "retune.h", { "STATES", e->system->states }, { "PARAMS", t->params },
		   { "WRAPPED", wraps_retune(e) },
		   { "SEGMENTS", e->system->segments }, { "ANY_STEP", p->full },
		   { "DIRECT", e->step->form == FORM_DIRECT }, { "SAMPLES", most_derivatives(e) },
		   { "WHOLE", has_kind(e, false) }, { "LISTED", has_kind(e, true) }, { "KEEPS", !p->solved },
		   { "ROWS", p->others.rows }, { "OPERATIONS", p->operations },
		   { "SOLVED", p->solved },
		   { "OUT", t->outputs }, { "OUT_COLUMNS", t->x.size },
		   { "PHASES", e->phases }, { "RATES", t->frequencies > 0 }, { "ENVELOPES", e->envelopes },
		   { "PEAKS", has_peak_rows(e) ? peak_outputs(e->model) : 0 },
		   { "WORK", p->work }, { "PASS_WORK", p->more }, { "SIZE", e->step->layout.size },
		   { "BLOCKS", e->step->series.emitted ? p->blocks : 0 }, { "JUMPS", has_jump(e) });
}

static void emit_group_call(const struct emitter *e, const struct tuned_block *first)
{
	const struct tuned_blocks *p = blocks_of_step(e);
	const struct group_shape shape = shape_of_group(e, first->group);
	int number = 0;
	for (int b = 0; &p->block[b] != first; b += p->block[b].group->blocks)
		number += p->block[b].group->tuned;
	const char *to = shape.rows ? format("c->%s[0]", tuned_table(e, first)) : "NULL";
	const char *apart = shape.changing ? format("c->loads%d[0][0]", first->index) : "NULL";
	say(e, "    if (status == 0) {\n"
	       "        status = $n_retune_group(&$n_block_group[%d], params, h, made, %s, %s, work);\n"
	       "    }\n",
	    number, to, apart);
}

void emit_retune(const struct emitter *e)
{
	const struct equations_text *text = emit_all_equations(e);
	emit_block_tables(e, text);
	emit_others(e, &text[blocks_of_step(e)->blocks]);
	emit_rows_of_loads(e);
	if (e->step->series.emitted)
		emit_vector_now(e);
	say(e, blocks_of_step(e)->solved ? "\n#define PL_FORMULAS $n_block[0].formulas\n"
					 : "\n#define PL_FORMULAS $n_formulas\n");
	emit_sizes_of_tuning(e);
	say(e, "#include \"retune.h\"\n");
	if (!has_kind(e, false) && !has_kind(e, true))
		return;
	say(e, "\nstatic int $n_retune_groups($n_coeffs *c, const double *params, double h, const pl_two *made, "
	       "pl_two *work)\n"
	       "{\n"
	       "    int status = 0;\n");
	each_tuned_group(e, emit_group_call);
	say(e, "    return status;\n"
	       "}\n");
}

void emit_tuned_at(const struct emitter *e)
{
	emit_at_by(e, "pass");
}
