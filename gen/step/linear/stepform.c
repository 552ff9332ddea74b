/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step without remainder, y+ = Phi y + loads + inputs, as a program in one of several forms. In exact
 * arithmetic all are the same map; what differs is what rounding does to them over many steps.
 *
 *   direct            y = Phi y. Where |pole| h is small, Phi - I loses the digits that the 1 takes.
 *   delta             y += (Phi - I) y, Phi - I rounded relative to itself
 *   kick-drift-kick   p += X q; q += S p; p += X q; of undamped systems, S and X symmetric: symplectic, however
 *                     they are rounded
 *
 * p is velocity times mass, masses in units of the first, so that equal masses leave velocities as they are. */
#include "inner.h"
#include "model/contacts/contacts.h"
#include "model/reads.h"
#include "model/tunable/tuning.h"
#include "step/cost.h"
#include "step/tapes.h"

const char *step_form_text(const struct step *step)
{
	return format("%s%s", step_form_name(step->form), step->program->compensated ? ", compensated" : "");
}

/* ---- which form ---- */

static bool has_mass_matrix(const struct linear *system)
{
	int n = system->n;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			if (i == j ? mpq_sgn(system->M[i * n + j]) <= 0 : mpq_sgn(system->M[i * n + j]) != 0)
				return false;
	return true;
}

/* m_j from m_i a_ij = m_j a_ji, and so on along the entries of a that are not 0; false: no positive masses do. */
static bool spread_masses(int n, const mpq_t *a, int from, mpq_t *mass)
{
	bool good = true;
	RATIONAL other = ZERO;
	for (int j = 0; j < n && good; j++) {
		if (j == from || (mpq_sgn(a[from * n + j]) == 0 && mpq_sgn(a[j * n + from]) == 0))
			continue;
		good = mpq_sgn(a[from * n + j]) == mpq_sgn(a[j * n + from]);
		if (!good)
			break;
		mpq_mul(other, mass[from], a[from * n + j]);
		mpq_div(other, other, a[j * n + from]);
		if (mpq_sgn(mass[j]) != 0) {
			good = mpq_equal(mass[j], other);
			continue;
		}
		mpq_set(mass[j], other);
		good = spread_masses(n, a, j, mass);
	}
	return good;
}

/* Masses in units of the first that make mass times acceleration symmetric in the coordinates, accelerations being a q:
 * found, not read, since an equation may have been divided by its mass, have its sign turned, or stand in another
 * place. Blocks that nothing couples keep the masses that were written, if they were. NULL: there are none. */
static const mpq_t *relative_masses(const struct linear *system, const mpq_t *a)
{
	int n = system->n;
	bool written = has_mass_matrix(system);
	mpq_t *mass = rationals(n);
	for (int i = 0; i < n; i++) {
		if (mpq_sgn(mass[i]) != 0)
			continue;
		mpq_set_ui(mass[i], 1, 1);
		if (written)
			mpq_div(mass[i], system->M[i * n + i], system->M[0]);
		if (!spread_masses(n, a, i, mass))
			return NULL;
	}
	return mass;
}

/* Accelerations over the coordinates, n x n; false: velocities act too, or a coordinate has none */
static bool accelerations(const struct linear *system, mpq_t *a)
{
	int n = system->n, states = system->states;
	mpq_t *inverse = inverse_of_leading(system), *row = rationals((size_t)(n * states));
	if (states != 2 * n)
		return false;
	highest_derivatives(system, inverse, false, row);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			mpq_set(a[i * n + j], row[i * states + j]);
			if (mpq_sgn(row[i * states + n + j]) != 0)
				return false;
		}
	return true;
}

static bool all_equal(int n, const mpq_t *mass)
{
	for (int i = 1; i < n; i++)
		if (!mpq_equal(mass[0], mass[i]))
			return false;
	return true;
}

/* What stands against kick-drift-kick; NULL: nothing */
static const char *kick_objection(struct step *step)
{
	const struct linear *system = &step->branch->system;
	int n = system->n;
	mpq_t *a = rationals((size_t)(n * n));
	const char *why = step_objection(step, CAN_KICKS);
	if (why)
		return why;
	if (!accelerations(system, a))
		return system->states == 2 * n ? "there is damping, or a term that depends on velocities"
					       : "a coordinate has no velocity";
	step->linear.kicks.mass = relative_masses(system, a);
	if (!step->linear.kicks.mass)
		return "its stiffness is not symmetric, whatever the masses";
	if (largest_pole_angle(step) > 2.5)
		return "the largest |pole| times h is above 2.5";
	for (int i = 0; i < n; i++)
		if (beyond_range(step->linear.kicks.mass[i]) || round_rational(step->linear.kicks.mass[i]) == 0)
			return format("a mass, in units of the first, is beyond the range of %s", target_name());
	step->linear.kicks.momenta = !all_equal(n, step->linear.kicks.mass);
	if (step->linear.kicks.momenta && (load_columns(system) || input_columns(system)))
		/* they would have to be multiplied by the masses */
		return "masses are unequal and there are loads or inputs";
	return NULL;
}

void leave_form(struct step *step, const char *why)
{
	const struct model *model = step->model;
	const char *form = step_form_name(model->request.form);
	if (model->request.again.trial)
		error(model->request.at.form, NULL, "the form %s cannot step this model: %s", form, why);
	stand_aside(model->request.at.form, format("--form %s", form), why);
	step->plain = model_copy(model);
	step->plain->request.form = FORM_AUTO;
	abandon();
}

/* The form of a step that is not linear; of one that is, whatever its coefficients let it be: FORM_AUTO */
static enum step_form only_form(const struct step *step)
{
	if (is_linear_alone(step))
		return FORM_AUTO;
	return step->model->switching && step->is.two_words ? FORM_DELTA : FORM_DIRECT;
}

void check_step_form(struct step *step)
{
	const enum step_form requested = step->model->request.form, only = only_form(step);
	if (requested == FORM_AUTO || requested == only)
		return;
	if (only == FORM_DELTA)
		leave_form(step, "--accuracy compensated takes the form delta of a piecewise-linear step");
	if (only == FORM_DIRECT)
		leave_form(step, "it is of a linear step");
	if (step->is.two_words && (requested == FORM_DIRECT || requested == FORM_MODAL))
		leave_form(step, "--accuracy compensated takes the form delta or kick-drift-kick");
	if (requested == FORM_MODAL && step->model->request.many.batch)
		leave_form(step, "it keeps modes in the place of states, which --batch steps");
}

/* Direct; in two words delta. */
void choose_form_of_regions(struct step *step)
{
	const struct model *model = step->model;
	step->form = model->request.compensated ? FORM_DELTA : FORM_DIRECT;
}

/* Kick-drift-kick where it can be; delta where I is most of Phi. */
static enum step_form best_form(struct step *step)
{
	const struct model *model = step->model;
	if (step->branch->system.heldK)
		return model->request.compensated ? FORM_DELTA : FORM_DIRECT;
	if (!kick_objection(step))
		return FORM_KICK_DRIFT_KICK;
	if (model->params.tuning)
		return FORM_DELTA;      /* good at any step that the target may be told */
	const double largest = model->equations.misses ? DECAY_OF_MISSES : 1; /* those of misses change no more */
	return model->request.compensated || largest_pole_angle(step) <= largest + 1e-9 ? FORM_DELTA : FORM_DIRECT;
}

void choose_form(struct step *step)
{
	const struct model *model = step->model;
	step->form = model->request.form == FORM_AUTO ? best_form(step)
		     : model->request.form == FORM_MODAL ? FORM_DIRECT  /* until plan_modal */
						       : model->request.form;
	if (model->request.form == FORM_KICK_DRIFT_KICK) {
		const char *objection = kick_objection(step);
		if (objection)
			leave_form(step, objection);
	}
	if (step->form != FORM_KICK_DRIFT_KICK) {
		step->linear.kicks.mass = NULL;
		step->linear.kicks.momenta = false;
	}
}

/* ---- states that only add up ---- */

/* reads[i][j]: x_i' depends on x_j, in any region, with any operator, for some values of tunable params */
static bool *readings(const struct step *step)
{
	const struct model *model = step->model;
	int n = step->branch->system.states;
	bool *reads = ARRAY(bool, (size_t)(n * n));
	const struct switching *there = model->params.retuned ? model->params.retuned->other->switching
					: model->switching && model->switching->cached ? model->switching : NULL;
	for (int k = 0; k < (there ? there->systems : step->branches); k++) {
		const mpq_t *A = state_matrix(there		     ? &there->system[k]
					      : model->params.tuning ? &model->params.tuning->other->system
								     : &step->branch[k].system,
					      false);
		for (int i = 0; i < n * n; i++)
			reads[i] = reads[i] || mpq_sgn(A[i]) != 0;
	}
	return reads;
}

/* What jumps, and what jumps read */
static void mark_jumps(const struct switching *s, int states, bool *reads)
{
	for (int k = 0; k < s->impacts * s->segments; k++)
		for (int j = 0; j < s->impact[k / s->segments].in[k % s->segments].jumps; j++) {
			const struct jump *jump = &s->impact[k / s->segments].in[k % s->segments].jump[j];
			reads[jump->state] = true;
			for (int i = 0; i < states; i++)
				reads[i] = reads[i] || mpq_sgn(jump->row->state[i]) != 0;
		}
}

/* Read by the remainder, by what breakpoints divide, by the choice of an operator, by jumps */
static bool *read_elsewhere(const struct step *step)
{
	const struct model *model = step->model;
	int n = step->branch->system.states;
	bool *reads = ARRAY(bool, n);
	for (int k = 0; k < model->schedule.operators; k++) {
		struct reads left = reads_of(model, model->remainder.force_columns,
					     (const struct form *const *)model->schedule.operator[k].left);
		for (int i = 0; i < n; i++)
			reads[i] = reads[i] || left.state[i];
	}
	if (model->schedule.selector) {
		struct reads selector = reads_of(model, 1, &model->schedule.selector);
		for (int i = 0; i < n; i++)
			reads[i] = reads[i] || selector.state[i];
	}
	for (int x = 0; model->switching && x < model->switching->functions; x++)
		for (int i = 0; i < n; i++)
			reads[i] = reads[i] || mpq_sgn(model->switching->function[x].row->state[i]) != 0;
	if (model->switching)
		mark_jumps(model->switching, n, reads);
	return reads;
}

/* Is anything added to the state in a step? */
static bool moves(const struct step *step, const bool *reads, int state, bool listed)
{
	const struct table *table = step->branch->full;
	int n = step->branch->system.states;
	bool any = false;
	for (int j = 0; j < n; j++)
		any = any || reads[state * n + j];
	for (int s = 0; s < step->branch->system.segments && listed; s++)
		for (int k = 0; k < table->columns; k++)
			any = any || !table->load[(s * n + state) * table->columns + k].zero;
	for (int k = 0; k < table->inputs && listed; k++)
		any = any || !table->input[state * table->inputs + k].zero;
	return any;
}

/* Nothing damps what rounding does to a state that no chain of readings leads back to: a position known only by its
 * rate, the velocity of a free body. Where the step is a list of assignments each such state is carried in two words;
 * elsewhere those that nothing reads. */
void find_carries(struct step *step)
{
	int n = step->branch->system.states;
	bool listed = !step->model->switching && !step->model->schedule.operators && n <= LIMIT_UNROLLED_STATES;
	step->carried.place = ARRAY(int, n);
	step->carried.count = 0;
	for (int i = 0; i < n; i++)
		step->carried.place[i] = -1;
	if (step->is.two_words || step->branch->system.heldK || step->model->request.again.derivatives)
		return;
	bool *reads = readings(step), *elsewhere = read_elsewhere(step);
	for (int k = 0; k < n && listed; k++)
		for (int i = 0; i < n; i++)
			for (int j = 0; j < n && reads[i * n + k]; j++)
				reads[i * n + j] = reads[i * n + j] || reads[k * n + j];
	for (int i = 0; i < n; i++) {
		bool alone = !reads[i * n + i] && !elsewhere[i] && moves(step, reads, i, listed);
		for (int j = 0; j < n && !listed; j++)
			alone = alone && !reads[j * n + i];
		if (alone)
			step->carried.place[i] = step->carried.count++;
	}
}

/* ---- the program ---- */

static void add_term(struct assignment *a, const struct coefficient *factor, enum operand_kind kind, int index)
{
	if (factor->zero)
		return;
	a->term[a->terms++] = (struct product){ factor, { kind, index } };
}

/* A load that acts in some segment of time; of one with refreshes, all columns where one acts */
static void add_load_term(struct assignment *a, const struct step *step, int row, int column)
{
	const struct linear *system = &step->branch->system;
	const struct table *table = step->branch->full;
	int first, load = load_of_column(system, column, &first), last = first + system->load[load].columns - 1;
	bool any = false;
	if (!is_refreshed(step, load))
		first = last = column;
	for (int s = 0; s < system->segments; s++)
		for (int k = first; k <= last; k++)
			any = any || !table->load[(s * table->states + row) * table->columns + k].zero;
	if (any && !is_forced(step, column))
		a->term[a->terms++] =
			(struct product){ &table->load[row * table->columns + column], { OPERAND_LOAD, column } };
}

static bool is_identity(const struct assignment *a)
{
	if (a->added)
		return a->terms == 0;
	return a->terms == 1 && a->term[0].operand.kind == OPERAND_STATE && a->term[0].operand.index == a->target &&
	       a->term[0].factor->value == 1;
}

static void mark_reads(struct program *program)
{
	for (int i = 0; i < program->assignments; i++) {
		const struct assignment *a = &program->assignment[i];
		program->reads[a->target] = program->reads[a->target] || a->added;
		for (int k = 0; k < a->terms; k++) {
			const struct operand *o = &a->term[k].operand;
			if (o->kind != OPERAND_INPUT)
				(o->kind == OPERAND_STATE ? program->reads : program->uses)[o->index] = true;
		}
	}
}

static void count(struct program *program, const struct step *step)
{
	struct step view = *step;
	struct tape *t = tape_new();
	view.program = program;
	tape_of_step(t, &view, NULL, "", NULL);
	struct tape_cost cost = tape_cost(t);
	program->multiplications = cost.multiplications;
	program->additions = cost.additions + PL_ACCUMULATE_ADD * cost.accumulations;
	count_loads(program, step);
}

static struct assignment *new_assignment(struct program *program, const struct step *step, int target, bool added)
{
	struct assignment *a = MORE(program->assignment, program->assignments);
	*a = (struct assignment){ .target = target, .added = added, .carried = step->carried.place[target] >= 0 };
	a->term = ARRAY(struct product, (size_t)(step->branch->full->states + step->branch->full->columns +
						 step->branch->full->inputs));
	return a;
}

static void drop_identity(struct program *program)
{
	const struct assignment *a = &program->assignment[program->assignments - 1];
	program->assignments -= is_identity(a) && (a->added || !program->tuned);
}

static void add_loads_and_inputs(struct assignment *a, const struct step *step, int row)
{
	const struct table *table = step->branch->full;
	for (int k = 0; k < table->columns; k++)
		add_load_term(a, step, row, k);
	for (int k = 0; k < table->inputs; k++)
		add_term(a, &table->input[row * table->inputs + k], OPERAND_INPUT, k);
}

static void write_direct(struct program *program, const struct step *step)
{
	int n = step->branch->full->states;
	for (int i = 0; i < n; i++) {
		struct assignment *a = new_assignment(program, step, i, step->carried.place[i] >= 0);
		for (int j = 0; j < n; j++)
			if (j != i || !a->added)        /* there Phi_ii is 1 */
				add_term(a, &step->branch->full->Phi[i * n + j], OPERAND_STATE, j);
		add_loads_and_inputs(a, step, i);
		drop_identity(program);
	}
}

static void write_delta(struct program *program, const struct step *step)
{
	const struct table *table = step->branch->full;
	int n = table->states;
	for (int i = 0; i < n; i++) {
		struct assignment *a = new_assignment(program, step, i, true);
		for (int j = 0; j < n; j++)
			add_term(a, &table->increment[i * n + j], OPERAND_STATE, j);
		add_loads_and_inputs(a, step, i);
		drop_identity(program);
	}
}

static void write_kicks(struct program *program, const struct step *step)
{
	const struct linear *system = &step->branch->system;
	for (int i = 0; i < system->n; i++) {
		struct assignment *a = new_assignment(program, step, system->velocity[i], true);
		for (int j = 0; j < system->n; j++)
			add_term(a, &step->branch->full->kick[i * system->n + j], OPERAND_STATE, j);
		drop_identity(program);
	}
}

static void write_kick_drift_kick(struct program *program, const struct step *step)
{
	const struct linear *system = &step->branch->system;
	int n = system->n;
	program->in_order = true;
	write_kicks(program, step);
	for (int i = 0; i < n; i++) {
		struct assignment *a = new_assignment(program, step, i, true);
		for (int j = 0; j < n; j++)
			add_term(a, &step->branch->full->drift[i * n + j], OPERAND_STATE, system->velocity[j]);
		drop_identity(program);
	}
	write_kicks(program, step);
	for (int i = 0; i < system->states; i++) {
		add_loads_and_inputs(new_assignment(program, step, i, true), step, i);
		drop_identity(program);
	}
}

struct program *linear_program(const struct step *step)
{
	const struct table *table = step->branch->full;
	struct program *program = NEW(struct program);
	program->compensated = step->is.two_words;
	program->tuned = step->model->params.tuning != NULL;
	program->reads = ARRAY(bool, table->states);
	program->uses = ARRAY(bool, table->columns);
	if (step->form == FORM_DIRECT)
		write_direct(program, step);
	else if (step->form == FORM_DELTA)
		write_delta(program, step);
	else
		write_kick_drift_kick(program, step);
	mark_reads(program);
	program->loops = table->states > LIMIT_UNROLLED_STATES;
	program->products_added = program->loops && step->form == FORM_DELTA;
	(program->loops ? find_groups : count)(program, step);
	return program;
}
