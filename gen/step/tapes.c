/* SPDX-License-Identifier: GPL-3.0-or-later */
/* As nodes of a tape: what forms read, what a step assigns to its states, rows of outputs. */
#include "model/tunable/tuning.h"
#include "step/linear/forms.h"
#include "step/exponential/recipe.h"
#include "tapes.h"

static tape_ref entry(struct tape *t, enum linear_table table, int index, tape_ref x)
{
	tape_ref factor = tape_operand(t, TAPE_TABLE, index, (int)table);
	return x == TAPE_NONE ? factor : tape_binary(t, TAPE_MUL, factor, x);
}

tape_ref tape_of_column(struct tape *t, const struct linear *system, int column)
{
	int first, load = load_of_column(system, column, &first);
	return is_constant_column(system, column) ? TAPE_NONE : tape_operand(t, TAPE_LOAD, load, column - first);
}

/* x TAPE_NONE: 1 */
static tape_ref number_times(struct tape *t, double factor, tape_ref x)
{
	return x == TAPE_NONE ? tape_double(t, factor) : tape_scaled(t, factor, x);
}

/* ---- what forms read ---- */

int load_of_forcing(const struct linear *system, const struct forcing *forcing)
{
	int l = 0;
	while (l < system->loads && system->load[l].forcing != forcing)
		l++;            /* none: of a let whose value nothing reads */
	return l;
}

tape_ref tape_of_basis(struct tape *t, const struct linear *system, const struct basis *basis)
{
	if (basis->kind != BASIS_FORCING)
		return tape_operand(t, basis->kind == BASIS_COORD ? TAPE_COORD : TAPE_INPUT, basis->index,
				    basis->order);
	if (is_polynomial(basis->forcing))
		return tape_power_of_time(t, basis->power);
	int column = oscillates(basis->forcing) ? 2 * basis->power + basis->sine : basis->power;
	return tape_operand(t, TAPE_LOAD, load_of_forcing(system, basis->forcing), column);
}

/* ---- what a step assigns ---- */

struct sums {
	struct tape *t;
	const struct step *step;
	tape_ref *state;            /* what each is by now */
	bool *assigned;
};

/* The group of blocks that has a state; `row`: where its states stand in its blocks */
static const struct group *group_of_state(const struct step *step, int state, int *index, int *row)
{
	for (int k = 0; k < step->program->groups; k++) {
		const struct group *g = &step->program->group[k];
		for (int i = 0; i < g->states * g->blocks; i++)
			if (g->state[i] == state) {
				*index = k;
				*row = i / g->blocks;
				return g;
			}
	}
	internal_error(step, "a state stands in no group");
}

static bool has_own_factors(const struct step *step, int state)
{
	int index, row;
	return step->program->tuned && (!step->program->loops || group_of_state(step, state, &index, &row)->tuned);
}

static bool is_rotated(const struct product *p, const struct step *step)
{
	int first;
	return p->operand.kind == OPERAND_LOAD &&
	       is_refreshed(step, load_of_column(&step->branch->system, p->operand.index, &first));
}

bool has_second_word(const struct product *p, const struct step *step)
{
	return is_rotated(p, step) ||
	       (p->factor->low != 0 && (p->operand.kind != OPERAND_LOAD || !loads_change(&step->branch->system)));
}

static int place_of_operand(const struct table *table, const struct operand *o)
{
	return o->index + (o->kind == OPERAND_STATE  ? 0
			   : o->kind == OPERAND_LOAD ? table->states
						     : table->states + table->columns);
}

static tape_ref operand_ref(const struct sums *s, const struct operand *o)
{
	if (o->kind == OPERAND_LOAD)
		return tape_of_column(s->t, &s->step->branch->system, o->index);
	return o->kind == OPERAND_STATE ? s->state[o->index] : tape_operand(s->t, TAPE_SAMPLE, o->index, 0);
}

/* A load that changes has its factors in a table, one row for each segment of time. */
static tape_ref term_ref(const struct sums *s, const struct assignment *a, const struct product *p, bool second)
{
	const struct step *step = s->step;
	const struct table *table = step->branch->full;
	const bool load = p->operand.kind == OPERAND_LOAD;
	int rotated = load ? refreshed_term(step, a->target, p->operand.index) : -1;
	tape_ref x = operand_ref(s, &p->operand);
	if (rotated >= 0)
		return entry(s->t, TABLE_ROTATED, rotated + second * step->refresh->terms, x);
	if (has_own_factors(step, a->target)) {
		int width = table->states + table->columns + table->inputs;
		return entry(s->t, TABLE_OWN, a->target * width + place_of_operand(table, &p->operand), x);
	}
	if (load && loads_change(&step->branch->system))
		return entry(s->t, TABLE_FACTOR, a->target * table->columns + p->operand.index, x);
	return number_times(s->t, second ? p->factor->low : p->factor->value, x);
}

/* `second`: of the factors' second words, where they have some */
static tape_ref sum_ref(const struct sums *s, const struct assignment *a, bool second)
{
	SCRATCH tape_ref *term = ARRAY(tape_ref, a->terms + 1);
	int terms = 0;
	for (int k = 0; k < a->terms; k++)
		if (!second || has_second_word(&a->term[k], s->step))
			term[terms++] = term_ref(s, a, &a->term[k], second);
	return tape_sum(s->t, terms, term);
}

static tape_ref assigned_ref(const struct sums *s, const struct assignment *a)
{
	tape_ref sum = sum_ref(s, a, false), zero = tape_number(s->t, 0);
	if (a->carried)
		return tape_accumulate(s->t, s->state[a->target], sum, zero, s->step->carried.place[a->target],
				       PLACE_CARRY);
	if (s->step->program->compensated)
		return tape_accumulate(s->t, s->state[a->target], sum, sum_ref(s, a, true), a->target, PLACE_REST);
	return a->added ? tape_binary(s->t, TAPE_ADD, s->state[a->target], sum) : sum;
}

/* Of a step in order, kick, drift, kick: velocities after the first kick, and where the drift ends */
static void name_assigned(const struct sums *s, int state)
{
	const struct linear *system = &s->step->branch->system;
	if (!s->assigned[state] && !tape_is_operand(s->t, s->state[state]))
		tape_name(s->t, s->state[state],
			  format("%s%d", state < system->n ? "drifted" : "kicked", system->coord[state] + 1));
}

void tape_of_step(struct tape *t, const struct step *step, const bool *stepped, const char *vector,
		  const char *const *place)
{
	enum { INDENT = 14 };
	const struct program *program = step->program;
	const int states = step->branch->full->states;
	struct sums s = { t, step, ARRAY(tape_ref, states), ARRAY(bool, states) };
	tape_ref *to = program->in_order ? s.state : ARRAY(tape_ref, states);
	for (int i = 0; i < states; i++)
		s.state[i] = tape_operand(t, TAPE_STATE, i, 0);
	for (int i = 0; i < program->assignments; i++) {
		const struct assignment *a = &program->assignment[i];
		if (stepped && !stepped[a->target])
			continue;
		to[a->target] = assigned_ref(&s, a);
		if (program->in_order)
			name_assigned(&s, a->target);
		s.assigned[a->target] = true;
	}
	for (int i = 0; i < states; i++)
		if (s.assigned[i])
			tape_set(t, place ? place[i] : format("%s[%d]", vector, i), to[i], INDENT,
				 step->model->names.state[i]);
}

/* ---- rows of outputs ---- */

const struct linear *system_of_outputs(const struct step *step)
{
	bool several = step->model->switching && loads_change(&step->model->system);
	return several ? &step->model->system : &step->branch->system;
}

int own_row(const struct step *step, const struct output *output)
{
	const struct model *model = step->model;
	return step->is.tuned ? model->params.tuning->output[output - model->output] : -1;
}

/* For some values of the params; of a load in some segment of time */
static bool own_row_reads(const struct step *step, int row, int column)
{
	const struct tuning *t = step->model->params.tuning;
	const struct linear *system = &step->branch->system;
	const bool *acts = t->acts + row * t->x.size;
	if (column < system->states)
		return acts[column];
	if (column >= system->states + t->x.loads)
		return acts[column + (system->segments - 1) * t->x.loads];
	bool any = false;
	for (int s = 0; s < system->segments; s++)
		any = any || acts[column + s * t->x.loads];
	return any;
}

static tape_ref own_row_ref(struct tape *t, const struct step *step, int row)
{
	const struct linear *system = &step->branch->system;
	const struct layout *x = &step->model->params.tuning->x;
	const int states = system->states;
	tape_ref *term = ARRAY(tape_ref, x->size + 1);
	int terms = 0, column = 0;
	for (; column < states + x->loads; column++)
		if (own_row_reads(step, row, column))
			term[terms++] = entry(t, TABLE_OWN_OUT, row * x->size + column,
					      column < states ? tape_operand(t, TAPE_STATE, column, 0)
							      : tape_of_column(t, system, column - states));
	for (int i = 0; i < system->inputs; i++)
		for (int k = 0; k <= system->input[i].hold; k++, column++)
			if (own_row_reads(step, row, column))   /* none reads further than the slope */
				term[terms++] = entry(t, TABLE_OWN_OUT, row * x->size + column,
						      tape_operand(t, TAPE_INPUT, i, k));
	return tape_sum(t, terms, term);
}

static double row_factor(const struct output *output, mpq_srcptr factor)
{
	if (beyond_range(factor))
		error(output->value->start, NULL, "a factor of output '%s' is beyond the range of %s", output->name,
		      target_name());
	return round_rational(factor);
}

/* A number for each output, then for each highest derivative that outputs which are not linear read */
int place_of_output(const struct model *model, const struct output *output)
{
	int row = model->outputs;
	for (int k = 0; model->equations.highest && k < model->n; k++) {
		if (model->equations.highest[k] == output)
			return row;
		row += model->equations.highest[k] != NULL;
	}
	return (int)(output - model->output);
}

static bool is_seen_of_modes(const struct step *step, const struct output *output)
{
	const struct model *model = step->model;
	return step->modal && output >= model->output && output < model->output + model->outputs &&
	       !rationals_zero((size_t)step->branch->system.states, output->state);
}

bool differs_in_time(const mpq_t *factor, int segments)
{
	bool changes = false;
	for (int s = 1; s < segments; s++)
		changes = changes || !mpq_equal(factor[0], factor[s]);
	return changes;
}

bool rows_sustained(const struct step *step)
{
	bool rows = step->forced && step->model->relative;
	for (int o = 0; rows && o < step->model->outputs; o++)
		rows = !step->model->output[o].left;
	return rows;
}

const mpq_t *direct_factors(const struct step *step, const struct output *output, int load, int column)
{
	const struct linear *system = system_of_outputs(step);
	const mpq_t *own = output->load[load] + column * system->segments;
	int at = column_of_load(system, load) + column, columns = load_columns(system);
	if (!rows_sustained(step) || !is_forced(step, at))
		return own;
	mpq_t *sum = rationals_copied(system->segments, own);
	for (int s = 0; s < system->segments; s++)
		for (int i = 0; i < system->states; i++)
			rational_addmul(sum[s], output->state[i],
					step->forced->exact[(s * step->forced->rows + i) * columns + at]);
	return sum;
}

static int load_terms(struct tape *t, const struct step *step, const struct output *output, tape_ref *term)
{
	const struct linear *system = system_of_outputs(step);
	const int columns = load_columns(system), place = place_of_output(step->model, output);
	int terms = 0;
	for (int l = 0, column = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++, column++) {
			const mpq_t *factor = direct_factors(step, output, l, k);
			const bool differs = differs_in_time(factor, system->segments);
			if (!differs && mpq_sgn(factor[0]) == 0)
				continue;
			tape_ref x = tape_of_column(t, system, column);
			term[terms++] = differs ? entry(t, TABLE_DIRECT, place * columns + column, x)
						: number_times(t, row_factor(output, factor[0]), x);
		}
	return terms;
}

tape_ref tape_of_row(struct tape *t, const struct step *step, const struct output *output)
{
	const struct linear *system = system_of_outputs(step);
	const bool seen = is_seen_of_modes(step, output);
	if (own_row(step, output) >= 0)
		return own_row_ref(t, step, own_row(step, output));
	int most = system->states + load_columns(system) + 2 * system->inputs + step->model->remainder.force_columns,
	    terms = 0;
	tape_ref *term = ARRAY(tape_ref, most + 1);
	if (seen)
		term[terms++] = entry(t, TABLE_SEEN, (int)(output - step->model->output), TAPE_NONE);
	for (int i = 0; i < system->states && !seen; i++)
		if (mpq_sgn(output->state[i]) != 0)
			term[terms++] = tape_scaled(t, row_factor(output, output->state[i]),
						    tape_operand(t, TAPE_STATE, i, 0));
	terms += load_terms(t, step, output, term + terms);
	for (int k = 0; k < 2; k++)
		for (int i = 0; i < system->inputs; i++)
			if (mpq_sgn(output->input[k][i]) != 0)
				term[terms++] = tape_scaled(t, row_factor(output, output->input[k][i]),
							    tape_operand(t, TAPE_INPUT, i, k));
	for (int c = 0; c < step->model->remainder.force_columns; c++)
		if (mpq_sgn(output->force_column[c]) != 0)
			term[terms++] = tape_scaled(t, row_factor(output, output->force_column[c]),
						    entry(t, TABLE_LEFT, c, TAPE_NONE));
	return tape_sum(t, terms, term);
}

/* ---- the forced part ---- */

static bool sustains(const struct step *step, int row, int column)
{
	const struct table *table = step->branch->full;
	bool any = false;
	for (int s = 0; s < step->branch->system.segments && is_forced(step, column); s++)
		any = any || step->forced->part[(s * step->forced->rows + row) * table->columns + column].value != 0;
	return any;
}

void tape_of_forced(struct tape *t, const struct step *step, const char *vector)
{
	const struct table *table = step->branch->full;
	const struct linear *system = &step->branch->system;
	tape_ref *term = ARRAY(tape_ref, table->columns + 1);
	for (int i = 0; i < table->states; i++) {
		int terms = 0, at = i * table->columns;
		for (int k = 0; k < table->columns; k++) {
			if (!sustains(step, i, k))
				continue;
			tape_ref x = tape_of_column(t, system, k);
			term[terms++] = loads_change(system) ? entry(t, TABLE_FORCED, at + k, x)
						: number_times(t, step->forced->part[at + k].value, x);
		}
		tape_set(t, format("%s[%d]", vector, i), tape_sum(t, terms, term), 13, step->model->names.state[i]);
	}
}
