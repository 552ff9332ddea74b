/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lanes of NAME_batch: what instances share of a step and what each has of its own; one step, and its outputs, of as
 * many instances as there are lanes, from the arrays and back. */
#include "emit/emit.h"

#include <string.h>

enum { MOST_GROUPS = 4 };

/* ---- what instances share, and what each has ---- */

static int share(struct batch *b, const char *text)
{
	ENLARGE(b->shared_text, (size_t)b->shared + 1);
	b->shared_text[b->shared] = text;
	return b->shared++;
}

static void share_load(struct batch *b, int which, int column)
{
	const char *text = column_operand(b->e, column);
	if (text && b->load[which][column] < 0)
		b->load[which][column] = share(b, text);
}

static void share_operands_of_step(struct batch *b)
{
	const struct program *program = b->e->step->program;
	for (int i = 0; i < program->assignments; i++)
		for (int k = 0; k < program->assignment[i].terms; k++) {
			const struct operand *o = &program->assignment[i].term[k].operand;
			if (o->kind == OPERAND_LOAD)
				share_load(b, 0, o->index);
			else if (o->kind == OPERAND_INPUT && b->input[0][o->index] < 0)
				b->input[0][o->index] = share(b, input_operand(b->e, o->index));
		}
}

/* Column k of an output's row over loads, over inputs and their slopes: is it read? */
static bool reads_load(const struct emitter *e, const struct output *output, int column)
{
	if (is_tuned_output(e, output))
		return tuned_output_reads(e, output, e->system->states + column);
	int l = 0;
	for (; column >= e->system->load[l].columns; l++)
		column -= e->system->load[l].columns;
	return mpq_sgn(output->load[l][column]) != 0;
}

/* Of input i, or of its slope; struct tuning has columns for both of a ramp alone */
static bool reads_input(const struct emitter *e, const struct output *output, int i, int slope)
{
	if (!is_tuned_output(e, output))
		return mpq_sgn(output->input[slope][i]) != 0;
	int column = e->system->states + load_columns(e->system);
	for (int k = 0; k < i; k++)
		column += e->system->input[k].hold + 1;
	return (slope == 0 || e->system->input[i].hold) && tuned_output_reads(e, output, column + slope);
}

static void share_operands_of_output(struct batch *b, const struct output *output)
{
	for (int k = 0; k < load_columns(b->e->system); k++)
		if (reads_load(b->e, output, k))
			share_load(b, 1, k);
	for (int k = 0; k < 2 * b->e->system->inputs; k++) {
		int i = k / 2, slope = k % 2;
		if (reads_input(b->e, output, i, slope) && b->input[1][k] < 0)
			b->input[1][k] = share(b, format(slope ? "s->slope[%d]" : "s->u[%d]", i));
	}
}

/* The name of a factor of the instance's own, in a function over lanes */
const char *batch_factor(struct batch *b, const char *text)
{
	int k = 0;
	while (k < b->factors && strcmp(b->factor_text[k], text) != 0)
		k++;
	if (k == b->factors) {
		ENLARGE(b->factor_text, (size_t)b->factors + 1);
		b->factor_text[b->factors++] = text;
	}
	return format("factor[%d]", k);
}

static int *no_places(int count)
{
	int *place = ARRAY(int, (size_t)count + 1);
	for (int i = 0; i < count; i++)
		place[i] = -1;
	return place;
}

static void number_factors(struct batch *b);

/* Is there more in x than the states? */
bool acts_beside_states(const struct emitter *e)
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

struct batch plan_batch(const struct emitter *e)
{
	struct batch b = { .e = e, .forced = -1 };
	for (int which = 0; which < 2; which++)
		b.load[which] = no_places(load_columns(e->system));
	b.input[0] = no_places(input_columns(e->system));
	b.input[1] = no_places(2 * e->system->inputs);
	share_operands_of_step(&b);
	b.after = b.shared;
	for (int i = 0; i < e->model->outputs; i++)
		share_operands_of_output(&b, &e->model->output[i]);
	if (e->step->forced) {
		b.forced = b.shared;
		b.shared += e->system->states;
	}
	if (has_peaks(e) && acts_beside_states(e))
		b.acting = e->step->layout.size - e->system->states + peak_outputs(e->model);
	b.sampled = b.acting && only_samples_act(e);
	if (e->kind->own_factors)
		number_factors(&b);
	return b;
}

int batch_shared_rows(const struct batch *b)
{
	return b->shared ? b->shared : 1;
}

/* Rows that a step changes of an instance's memory, the first of them */
int batch_stepped_rows(const struct emitter *e)
{
	return e->system->states * (e->step->program->compensated ? 2 : 1) + e->step->carries;
}

/* Groups of lanes that step in turns, so that sums of one wait for none of their own */
int batch_groups(const struct emitter *e)
{
	int groups = 8 / batch_stepped_rows(e);
	return groups < 1 ? 1 : groups > MOST_GROUPS ? MOST_GROUPS : groups;
}

/* ---- the step over lanes ---- */

static const char *shared_place(int place)
{
	return place < 0 ? NULL : format("now[%d]", place);
}

static const char *operand_over_lanes(const struct batch *b, const struct operand *o)
{
	switch (o->kind) {
	case OPERAND_STATE: return b->e->local[o->index];
	case OPERAND_LOAD:  return shared_place(b->load[0][o->index]);
	default:            return shared_place(b->input[0][o->index]);
	}
}

static const char *term_over_lanes(struct batch *b, const struct assignment *a, const struct product *p)
{
	const char *operand = operand_over_lanes(b, &p->operand);
	if (!b->e->step->program->tuned)
		return scaled(p->factor->value, operand);
	const char *factor = batch_factor(b, tuned_factor(b->e, a->target, &p->operand));
	return operand ? format("%s * %s", factor, operand) : factor;
}

/* Some term of a sum is over lanes, not a number that all share. */
static bool is_over_lanes(const struct batch *b, const struct assignment *a)
{
	bool any = b->e->step->program->tuned && a->terms;
	for (int k = 0; k < a->terms; k++)
		any = any || a->term[k].operand.kind == OPERAND_STATE;
	return any;
}

static const char *sum_over_lanes(struct batch *b, const struct assignment *a, bool second)
{
	const char **term = ARRAY(const char *, (size_t)a->terms + 1);
	int terms = 0;
	bool lanes = is_over_lanes(b, a);
	for (int k = 0; k < a->terms; k++)
		if (!second)
			term[terms++] = term_over_lanes(b, a, &a->term[k]);
		else if (has_second_word(&a->term[k], b->e->step))
			term[terms++] = scaled(a->term[k].factor->low, operand_over_lanes(b, &a->term[k].operand));
	const char *sum = terms ? tree(terms, term, 14) : "0.0";
	return lanes && !second ? sum : format("pl_lanes_all(0.0) + (%s)", sum);
}

/* Where of the rows an assignment keeps what rounding takes */
static int rest_row(const struct emitter *e, const struct assignment *a)
{
	int states = e->system->states;
	return a->carried ? batch_stepped_rows(e) - e->step->carries + e->step->carry[a->target] : states + a->target;
}

static void say_assignment(struct batch *b, const struct assignment *a)
{
	const struct emitter *e = b->e;
	const struct program *program = e->step->program;
	const char *old = e->local[a->target], *target = program->in_order ? old : format("y[%d]", a->target);
	const char *name = e->model->state_name[a->target], *sum = sum_over_lanes(b, a, false);
	if (program->compensated || a->carried)
		say(e, "    %s = pl_lanes_accumulate(%s,  /* %s */\n"
		       "              %s,\n"
		       "              %s, &y[%d]);\n", target, old, name, sum,
		    a->carried ? "pl_lanes_all(0.0)" : sum_over_lanes(b, a, true), rest_row(e, a));
	else if (program->in_order)
		say(e, "    %s += %s;\n", target, sum);
	else if (a->added && a->terms > 1)
		say(e, "    %s = %s + (%s);  /* %s */\n", target, old, sum, name);
	else
		say(e, "    %s = %s%s;  /* %s */\n", target, a->added ? format("%s + ", old) : "", sum, name);
}

static void number_factors(struct batch *b)
{
	const struct emitter *e = b->e;
	const struct program *program = e->step->program;
	for (int i = 0; i < program->assignments; i++)
		for (int k = 0; k < program->assignment[i].terms; k++)
			term_over_lanes(b, &program->assignment[i], &program->assignment[i].term[k]);
	for (int i = 0; i < e->model->outputs; i++)
		for (int k = 0; is_tuned_output(e, &e->model->output[i]) && k < e->model->tuning->x.size; k++)
			if (tuned_output_reads(e, &e->model->output[i], k))
				batch_factor(b, tuned_output_factor(e, &e->model->output[i], k));
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
	const struct program *program = e->step->program;
	say(e, "\n/* One step of as many instances as there are lanes; now: what they share */\n"
	       "PL_LANES_INLINE void $n_lanes_step(pl_lanes *y, %sconst double *now)\n"
	       "{\n", b->factors ? "const pl_lanes *factor, " : "");
	for (int i = 0; i < e->system->states; i++)
		if (program->reads[i])
			say(e, "    %spl_lanes %s = y[%d];\n", program->in_order ? "" : "const ", e->local[i], i);
	for (int i = 0; i < program->assignments; i++)
		say_assignment(b, &program->assignment[i]);
	for (int i = 0; i < e->system->states && program->in_order; i++)
		if (program->reads[i])
			say(e, "    y[%d] = %s;\n", i, e->local[i]);
	say(e, "    (void)now;\n"
	       "}\n");
}

/* ---- outputs over lanes ---- */

static const char *output_term(struct batch *b, const struct output *output, int column, mpq_srcptr fixed,
			       const char *operand)
{
	if (!is_tuned_output(b->e, output))
		return scaled(round_rational(fixed), operand);
	const char *factor = batch_factor(b, tuned_output_factor(b->e, output, column));
	return operand ? format("%s * %s", factor, operand) : factor;
}

static bool reads_state(const struct emitter *e, const struct output *output, int i)
{
	return is_tuned_output(e, output) ? tuned_output_reads(e, output, i) : mpq_sgn(output->state[i]) != 0;
}

static int add_load_terms(struct batch *b, const struct output *output, const char **term)
{
	const struct linear *system = b->e->system;
	int terms = 0;
	for (int l = 0, column = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++, column++)
			if (reads_load(b->e, output, column))
				term[terms++] = output_term(b, output, system->states + column, output->load[l][k],
							    shared_place(b->load[1][column]));
	return terms;
}

static int add_input_terms(struct batch *b, const struct output *output, const char **term)
{
	const struct linear *system = b->e->system;
	int terms = 0, column = system->states + load_columns(system);
	for (int i = 0; i < system->inputs; i++) {
		for (int k = 0; k < 2; k++)
			if (reads_input(b->e, output, i, k))
				term[terms++] = output_term(b, output, column + k, output->input[k][i],
							    shared_place(b->input[1][2 * i + k]));
		column += system->input[i].hold + 1;
	}
	return terms;
}

static const char *output_over_lanes(struct batch *b, const struct output *output)
{
	const struct linear *system = b->e->system;
	int terms = 0;
	const char **term =
		ARRAY(const char *, (size_t)(system->states + load_columns(system) + 2 * system->inputs) + 1);
	for (int i = 0; i < system->states; i++)
		if (reads_state(b->e, output, i))
			term[terms++] = output_term(b, output, i, output->state[i], b->e->local[i]);
	bool lanes = terms > 0 || is_tuned_output(b->e, output);
	terms += add_load_terms(b, output, term + terms);
	terms += add_input_terms(b, output, term + terms);
	const char *sum = terms ? tree(terms, term, 13) : "0.0";
	return lanes && terms ? sum : format("pl_lanes_all(%s)", sum);
}

/* A state as outputs read it: of momenta the velocity, of what is kept less its forced part the whole */
static const char *state_over_lanes(const struct batch *b, int i)
{
	const char *mass = factor_of_momentum(b->e, i), *kept = format("y[%d]", i);
	if (mass)
		kept = format("%s / %s", kept, mass);
	return b->forced >= 0 ? format("%s + now[%d]", kept, b->forced + i) : kept;
}

void emit_lanes_out(struct batch *b)
{
	const struct emitter *e = b->e;
	say(e, "\nPL_LANES_INLINE void $n_lanes_out(const pl_lanes *y, %sconst double *now, pl_lanes *out)\n"
	       "{\n", b->factors ? "const pl_lanes *factor, " : "");
	for (int i = 0; i < e->system->states; i++) {
		bool read = false;
		for (int o = 0; o < e->model->outputs; o++)
			read = read || reads_state(e, &e->model->output[o], i);
		if (read)
			say(e, "    const pl_lanes %s = %s;\n", e->local[i], state_over_lanes(b, i));
	}
	for (int o = 0; o < e->model->outputs; o++)
		say(e, "    out[%d] = %s;  /* %s */\n", o, output_over_lanes(b, &e->model->output[o]),
		    e->model->output[o].name);
	say(e, "    (void)now;\n"
	       "%s"
	       "}\n", b->factors ? "    (void)factor;\n" : "");
}

/* ---- lanes from the arrays and back ---- */

static void emit_take_own(const struct batch *b)
{
	const struct emitter *e = b->e;
	if (!b->factors)
		return;
	say(e, "    if (b->factors) {\n"
	       "        size_t i;\n"
	       "        for (i = 0; i < %d; i++)\n"
	       "            factor[i] = pl_lanes_load(b->factors + i * b->count + j, left);\n"
	       "    } else {\n"
	       "        const $n *s = &b->shared;\n", b->lanes);
	for (int k = 0; k < b->lanes; k++)
		say(e, "        factor[%d] = pl_lanes_all(%s);\n", k, b->factor_text[k]);
	say(e, "    }\n");
}

/* For the lanes from instance j on; beyond the last there are none. */
static void say_left(const struct emitter *e)
{
	say(e, "    const size_t left = j < b->count ? b->count - j : 0;\n"
	       "    j = left ? j : 0;\n");
}

void emit_lanes_take(const struct batch *b)
{
	const struct emitter *e = b->e;
	say(e, "\n/* As many instances as there are lanes, from j on */\n"
	       "PL_LANES_INLINE void $n_lanes_take(const $n_instances *b, size_t j, pl_lanes *y,%s pl_lanes *peak)\n"
	       "{\n", b->factors ? " pl_lanes *factor," : "");
	say_left(e);
	for (int i = 0; i < batch_stepped_rows(e); i++)
		say(e, "    y[%d] = pl_lanes_load(b->y + %d * b->count + j, left);\n", i, i);
	for (int o = 0; o < e->model->outputs; o++)
		say(e, "    peak[%d] = pl_lanes_load(b->peak + %d * b->count + j, b->peak ? left : 0);\n", o, o);
	emit_take_own(b);
	say(e, "}\n"
	       "\nPL_LANES_INLINE void $n_lanes_give($n_instances *b, size_t j, const pl_lanes *y, "
	       "const pl_lanes *peak)\n"
	       "{\n");
	say_left(e);
	for (int i = 0; i < batch_stepped_rows(e); i++)
		say(e, "    pl_lanes_store(b->y + %d * b->count + j, y[%d], left);\n", i, i);
	say(e, "    if (!b->peak)\n"
	       "        return;\n");
	for (int o = 0; o < e->model->outputs; o++)
		say(e, "    pl_lanes_store(b->peak + %d * b->count + j, peak[%d], left);\n", o, o);
	say(e, "}\n");
}
