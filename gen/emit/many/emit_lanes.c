/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lanes of NAME_batch: what instances share of a step and what each has of its own; one step, and its outputs, of as
 * many instances as there are lanes, from the arrays and back. */
#include "inner.h"
#include "emit/linear/blocks.h"
#include "emit/regions/regions.h"
#include "emit/series/series.h"
#include "model/tunable/tuning.h"
#include "step/exponential/recipe.h"
#include "step/linear/rows.h"
#include "step/series/expansion.h"

#include <string.h>

enum { MOST_GROUPS = 4 };

bool has_regions(const struct emitter *e)
{
	return e->step->is.events == EVENTS_OF_REGIONS;
}

bool has_series(const struct emitter *e)
{
	return flow_of(e->model) == FLOW_SERIES && !has_regions(e);
}

bool leaves_lanes(const struct emitter *e)
{
	return has_regions(e) || has_series(e);
}

/* ---- what instances share, and what each has ---- */

static int find_text(int count, const char *const *text, int from, const char *wanted)
{
	while (from < count && strcmp(text[from], wanted) != 0)
		from++;
	return from;
}

/* Its place among what is shared from `from` on */
static int share(struct batch *b, int from, const char *text)
{
	int place = find_text(b->shared, b->shared_text, from, text);
	if (place == b->shared) {
		ENLARGE(b->shared_text, (size_t)b->shared + 1);
		b->shared_text[b->shared++] = text;
	}
	return place;
}

/* An operand that all instances share: its C */
static const char *shared_operand(const struct emitter *e, const struct tape_node *n)
{
	switch (n->op) {
	case TAPE_LOAD:   return load_operand(e, n->index, n->part);
	case TAPE_SAMPLE: return input_operand(e, n->index);
	case TAPE_INPUT:  return format(n->part ? "s->slope[%d]" : "s->u[%d]", n->index);
	default:          return NULL;
	}
}

static void share_operands(struct batch *b, const struct tape *t, int from, shared_text *text_of)
{
	const int *uses = tape_uses(t);
	for (int i = 0; i < tape_length(t); i++) {
		const char *text = uses[i] ? text_of(b->e, tape_node(t, i)) : NULL;
		if (text)
			share(b, from, text);
	}
}

/* The name of a factor of the instance's own, in a function over lanes */
static const char *batch_factor(struct batch *b, const char *text)
{
	int k = find_text(b->factors, b->factor_text, 0, text);
	if (k == b->factors) {
		ENLARGE(b->factor_text, (size_t)b->factors + 1);
		b->factor_text[b->factors++] = text;
	}
	return format("factor[%d]", k);
}

static void number_factors(struct batch *b);

/* Is there more in x than the states? */
static bool acts_beside_states(const struct emitter *e)
{
	return e->step->layout.size > e->system->states;
}

/* ... all of it polynomials through samples, of which the derivatives take long? */
static bool only_samples_act(const struct emitter *e)
{
	int columns = 0;
	for (int i = 0; i < e->system->inputs; i++)
		columns += e->system->input[i].hold > 1 ? e->system->input[i].hold + 1 : 0;
	return e->system->states + columns == e->step->layout.size;
}

/* Under the names of emit_expansion_locals */
const char *shared_of_series(const struct emitter *e, const struct tape_node *n)
{
	switch (n->op) {
	case TAPE_LOAD:  return load_operand(e, n->index, n->part);
	case TAPE_INPUT: return input_name(e, n->index, n->part);
	case TAPE_TIME:  return "t";
	default:         return NULL;
	}
}

/* Params are of the instance, all of them, since its outputs read some alone. */
static void plan_series(struct batch *b)
{
	const struct emitter *e = b->e;
	b->step = tape_of_series(e);
	share_operands(b, b->step, 0, shared_of_series);
	for (int k = 0; k < e->model->spec->tuned.count; k++)
		batch_factor(b, param_text(e, k));
	b->lanes = b->factors;
}

/* Params that regions read, and those that outputs read alone */
static void plan_regions(struct batch *b)
{
	const struct emitter *e = b->e;
	const struct tuning *t = e->model->params.held;
	int params;
	const char **text = params_in_x(e, &params);
	b->shared = e->step->layout.size - e->system->states;
	b->shared_text = ARRAY(const char *, (size_t)b->shared + 1);
	for (int k = 0; k < params; k++)
		batch_factor(b, text[k]);
	b->lanes = b->factors;
	for (int k = 0; t && k < t->params; k++)
		batch_factor(b, param_text(e, k));
}

/* Does an output read a param, which is an input that no step is given? */
static bool takes_params(const struct emitter *e, const struct tape *t)
{
	bool any = false;
	for (int i = e->model->spec->count.inputs; i < e->system->inputs; i++)
		any = any || tape_reads(t, TAPE_SAMPLE, i, -1) || tape_reads(t, TAPE_INPUT, i, -1);
	return any;
}

/* Outputs as rows over states and what all share; NULL: with regions some are more than that */
static struct tape *outputs_as_rows(const struct emitter *e)
{
	struct tape *t = tape_new();
	for (int i = 0; i < e->model->outputs; i++) {
		const struct output *output = &e->model->output[i];
		if (output->left)
			return NULL;
		tape_set(t, format("out[%d]", i), tape_of_row(t, e->step, output), 13, output->name);
	}
	return leaves_lanes(e) && (tape_reads(t, TAPE_TABLE, -1, -1) || takes_params(e, t)) ? NULL : t;
}

/* Of a step that loops: what acts, as it stands in `now` */
static void share_acting(struct batch *b)
{
	const struct emitter *e = b->e;
	const struct table *table = e->step->branch->full;
	const char **text = acting_texts(e);
	for (int k = 0; k < table->columns + table->inputs; k++) {
		const bool acts = k >= table->columns || e->step->program->uses[k];
		if (strcmp(text[k], "1.0") != 0)
			text[k] = acts ? format("now[%d]", share(b, 0, text[k])) : "0.0";
	}
	b->acting = text;
}

struct batch plan_batch(const struct emitter *e)
{
	struct batch b = { .e = e, .forced = -1, .step = tape_new(),
			   .out = outputs_as_rows(e) };
	struct step now = *e->step;             /* what instances share are load states of now, not a refresh's */
	now.refresh = NULL;
	if (has_regions(e)) {
		plan_regions(&b);
	} else if (has_series(e)) {
		plan_series(&b);
	} else {
		tape_of_step(b.step, &now, states_in_rows(e), "y", NULL);
		share_operands(&b, b.step, 0, shared_operand);
		if (e->step->program->loops)
			share_acting(&b);
	}
	b.after = b.shared;
	b.out_alone = !b.out;
	b.out = b.out ? b.out : tape_new();
	share_operands(&b, b.out, b.after, shared_operand);
	if (e->step->forced && !rows_sustained(e->step)) {
		b.forced = b.shared;
		b.shared += e->system->states;
	}
	b.sampled = has_peaks(e) && acts_beside_states(e) && only_samples_act(e);
	if (e->step->is.tuned)
		number_factors(&b);
	return b;
}

/* As series_lanes.h lists them */
static int series_rows(const struct emitter *e)
{
	const int states = e->system->states;
	return 2 * states + (spans_steps(e) ? 1 + (own_expansion(e)->order + 3) * states : 0);
}

/* Rows that a step changes of an instance's memory, the first of them */
int batch_stepped_rows(const struct emitter *e)
{
	if (has_series(e))
		return series_rows(e);
	return e->system->states * (e->step->program->compensated ? 2 : 1) + e->step->carried.count + has_regions(e);
}

/* Groups of lanes that step in turns, so that sums of one wait for none of their own */
int batch_groups(const struct emitter *e)
{
	int groups = leaves_lanes(e) ? 1 : 8 / batch_stepped_rows(e);
	return groups < 1 ? 1 : groups > MOST_GROUPS ? MOST_GROUPS : groups;
}

/* ---- tapes over lanes ---- */

struct over_lanes {
	struct batch *b;
	int from;                       /* where what is shared stands */
	shared_text *text_of;
	bool indexed;                   /* states have no names */
};

/* Rows of an instance, of what rounding takes from a state */
static const char *rest_row(const struct emitter *e, const struct tape_node *n)
{
	int first = n->part == PLACE_CARRY ? batch_stepped_rows(e) - e->step->carried.count : e->system->states;
	return format("y[%d]", first + n->index);
}

static const char *operand_over_lanes(const void *context, const struct tape_node *n)
{
	const struct over_lanes *over = context;
	const struct emitter *e = over->b->e;
	if (n->op == TAPE_STATE)
		return over->indexed ? format("y[%d]", n->index) : e->local[n->index];
	if (n->op == TAPE_PARAM)
		return batch_factor(over->b, param_text(e, n->index));
	if (n->op == TAPE_ACCUMULATE)
		return rest_row(e, n);
	if (n->op == TAPE_TABLE && n->part == TABLE_SEEN)
		return spell(e, "$n_lanes_dot($n_seen[%d], y)", n->index);
	if (n->op == TAPE_TABLE)
		return batch_factor(over->b, linear_entry(e, n));
	return format("now[%d]", share(over->b, over->from, over->text_of(e, n)));
}

static bool varies(const void *context, const struct tape_node *n)
{
	(void)context;
	return n->op == TAPE_STATE || n->op == TAPE_TABLE || n->op == TAPE_PARAM;
}

void emit_over_lanes(struct batch *b, const struct tape *t, int from, shared_text *text_of)
{
	const bool indexed = text_of != shared_operand;
	const struct tape_lanes lanes = { "pl_lanes", "pl_lanes_all", spell(b->e, "$n_lanes_"), varies };
	const struct over_lanes over = { b, from, text_of, indexed };
	const struct tape_target to = { .real = "double", .operand = operand_over_lanes,
					.accumulate = "pl_lanes_accumulate", .context = &over, .indent = 4,
					.lanes = &lanes };
	const char *broken = tape_check(t);
	if (broken)
		internal_error(b->e->step, broken);
	tape_print(t, &to, b->e->to);
}

static void number_entries(struct batch *b, const struct tape *t)
{
	for (int i = 0; i < tape_length(t); i++)
		if (tape_node(t, i)->op == TAPE_TABLE)
			batch_factor(b, linear_entry(b->e, tape_node(t, i)));
}

/* Tables of blocks alike stand in one piece, as loops read them. */
static void number_tables(struct batch *b)
{
	const struct program *program = b->e->step->program;
	b->own = ARRAY(int, (size_t)program->groups + 1);
	for (int k = 0; k < program->groups; k++) {
		const struct group *g = &program->group[k];
		const struct group_shape shape = shape_of_group(b->e, g);
		b->own[k] = b->factors;
		for (int i = 0; g->tuned && g->kind == GROUP_ALIKE && i < shape.rows * shape.columns; i++) {
			ENLARGE(b->factor_text, (size_t)b->factors + 1);
			b->factor_text[b->factors++] = format("s->coeffs.alike%d[%d][%d]", k, i / shape.columns,
							      i % shape.columns);
		}
	}
}

static void number_factors(struct batch *b)
{
	const struct emitter *e = b->e;
	number_entries(b, b->step);
	number_tables(b);
	number_entries(b, b->out);
	for (int p = 0; p < peak_outputs(e->model); p++) {
		for (int i = 0; i < e->system->states; i++)
			batch_factor(b, format("s->coeffs.bend[%d][%d]", p, i));
		if (acts_beside_states(e))
			batch_factor(b, format("s->coeffs.reach[%d]", p));
	}
	b->lanes = b->factors;
	for (int p = 0; p < peak_outputs(e->model); p++)
		for (int i = e->system->states; i < e->step->layout.size; i++)
			batch_factor(b, format("s->coeffs.bend[%d][%d]", p, i));
	for (int i = 0; i < e->system->states && has_peaks(e); i++)
		for (int j = 0; j < e->step->layout.size; j++)
			batch_factor(b, format("s->coeffs.slope[%d][%d]", i, j));
}

void emit_lanes_step(struct batch *b)
{
	const struct emitter *e = b->e;
	const bool loops = e->step->program->loops;
	struct emitter wide = *e;
	wide.wide = true;
	wide.own = b->own;
	if (loops) {
		emit_groups(&wide);
		emit_modes(&wide);
	}
	open_function(e, "One step of as many instances as there are lanes; now: what they share",
		      "PL_LANES_INLINE void $n_lanes_step(pl_lanes *y, const pl_lanes *factor, const double *now)");
	for (int i = 0; i < e->system->states; i++)
		if (tape_reads(b->step, TAPE_STATE, i, 0))
			say(e, "    const pl_lanes %s = y[%d];\n", e->local[i], i);
	emit_over_lanes(b, b->step, 0, shared_operand);
	if (loops)
		emit_loops_of_step(&wide, b->acting);
	close_function(e, "now factor");
}

/* A state as outputs read it: of momenta the velocity, of a transient the whole, particular solution added */
static const char *state_over_lanes(const struct batch *b, int i)
{
	const char *mass = factor_of_momentum(b->e, i), *kept = format("y[%d]", i);
	if (b->e->step->modal)
		return spell(b->e, "$n_lanes_dot($n_from_modes[%d], y)", i);
	if (mass)
		kept = format("%s / %s", kept, mass);
	return b->forced >= 0 ? format("%s + now[%d]", kept, b->forced + i) : kept;
}

void emit_lanes_out(struct batch *b)
{
	const struct emitter *e = b->e;
	open_function(e, NULL,
		      "PL_LANES_INLINE void $n_lanes_out(const pl_lanes *y, const pl_lanes *factor, "
		      "const double *now, pl_lanes *out)");
	for (int i = 0; i < e->system->states; i++)
		if (tape_reads(b->out, TAPE_STATE, i, 0))
			say(e, "    const pl_lanes %s = %s;\n", e->local[i], state_over_lanes(b, i));
	emit_over_lanes(b, b->out, b->after, shared_operand);
	close_function(e, "now factor");
}

/* ---- peaks ---- */

static const char *bend_over_lanes(struct batch *b, int p)
{
	const struct emitter *e = b->e;
	const struct peaks peaks = peaks_of(e->step);
	struct summands s = { 0 };
	for (int i = 0; i < e->system->states; i++) {
		const char *size = format("pl_lanes_peak(pl_lanes_all(0.0), state[%d]%s%s)", i,
					  factor_of_momentum(e, i) ? " / " : "",
					  factor_of_momentum(e, i) ? factor_of_momentum(e, i) : "");
		add_summand(&s, e->step->is.tuned
			? format("%s * %s", batch_factor(b, format("s->coeffs.bend[%d][%d]", p, i)), size)
			: scaled(peaks.bend[p * e->step->layout.size + i], size));
	}
	if (acts_beside_states(e) && e->step->is.tuned)
		add_summand(&s, format("%s * reach[%d]", batch_factor(b, format("s->coeffs.reach[%d]", p)), p));
	else if (acts_beside_states(e))
		add_summand(&s, format("reach[%d]", p));
	return sum_of(&s, 15);
}

void emit_lanes_bend(struct batch *b)
{
	const struct emitter *e = b->e;
	open_function(e, "Bounds of the distance of outputs from their chords, for |states|, loads and inputs",
		      "PL_LANES_INLINE void $n_lanes_bend(const pl_lanes *state, const pl_lanes *factor, "
		      "const double *reach, pl_lanes *bend)");
	for (int p = 0; p < peak_outputs(e->model); p++)
		say(e, "    bend[%d] = %s;\n", p, bend_over_lanes(b, p));
	close_function(e, "factor reach");
}
