/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scheme takes the equations apart into what is solved exactly and what is held over a step, and writes the step as
 * a program over the tables of the exact part. */
#include "plgen.h"

/* ---- pl ---- */

static mpq_t *normalized(int n, int segments, const mpq_t *inverse, const mpq_t *force)
{
	mpq_t *acceleration = rationals((size_t)segments * (size_t)n);
	for (int s = 0; s < segments; s++)
		rational_product(n, n, 1, inverse, force + s * n, acceleration + s * n);
	return acceleration;
}

static void normalize_loads(const struct linear *written, const mpq_t *inverse, struct linear *split)
{
	int n = written->n;
	split->loads = written->loads;
	split->load = ARRAY(struct load, (size_t)written->loads);
	for (int l = 0; l < written->loads; l++) {
		const struct load *load = &written->load[l];
		split->load[l] = *load;
		split->load[l].force = ARRAY(mpq_t *, (size_t)load->columns);
		for (int k = 0; k < load->columns; k++)
			split->load[l].force[k] = normalized(n, written->segments, inverse, (const mpq_t *)load->force[k]);
	}
	split->inputs = written->inputs;
	split->input = ARRAY(struct input, (size_t)written->inputs);
	for (int i = 0; i < written->inputs; i++) {
		split->input[i] = written->input[i];
		for (int k = 0; k < 2; k++)
			split->input[i].force[k] = normalized(n, 1, inverse, (const mpq_t *)written->input[i].force[k]);
	}
}

/* Fang, Wang, Dai, Zhang 2020: after division by the mass matrix the other coordinates and their velocities are held
 * at their value at the step's start; a coordinate's own terms, loads and inputs stay exact. */
static struct linear piecewise_laplace(const struct linear *written)
{
	int n = written->n, states = written->states, column;
	struct linear split = linear_like(written);
	mpq_t *inverse = rationals((size_t)(n * n)), *highest = rationals((size_t)(n * states));
	leading_inverse(written, inverse, &column);
	highest_derivatives(written, (const mpq_t *)inverse, false, highest);
	split.heldC = rationals((size_t)(n * n));
	split.heldK = rationals((size_t)(n * n));
	for (int i = 0; i < n; i++) {
		mpq_set_ui((written->velocity[i] >= 0 ? split.M : split.C)[i * n + i], 1, 1);
		for (int j = 0; j < states; j++) {
			bool own = written->coord[j] == i;
			mpq_t *matrix = j < n ? (own ? split.K : split.heldK) : own ? split.C : split.heldC;
			mpq_neg(matrix[i * n + written->coord[j]], highest[i * states + j]);
		}
	}
	normalize_loads(written, (const mpq_t *)inverse, &split);
	return split;
}

/* The modified equation of y+ = E y + h phi1 R y is y' = L y - (h/2) R L y + O(h^2), L = A + R: what is held lags by
 * half a step. */
static struct linear modified_equation(const struct linear *written, const struct linear *split, mpq_srcptr h)
{
	int states = split->states;
	mpq_t *L = state_matrix(written, false), *R = state_matrix(split, true), *RL = rationals((size_t)(states * states)), half;
	rational_product(states, states, states, (const mpq_t *)R, (const mpq_t *)L, RL);
	mpq_init(half);
	mpq_div_2exp(half, h, 1);
	for (int i = 0; i < states * states; i++) {
		mpq_mul(RL[i], RL[i], half);
		mpq_sub(L[i], L[i], RL[i]);
	}
	mpq_clear(half);
	return first_order_system(states, (const mpq_t *)L);
}

/* ---- the program of a linear step ---- */

static void add_term(struct assignment *a, const struct coefficient *factor, enum operand_kind kind, int index)
{
	if (factor->zero)
		return;
	a->term[a->terms++] = (struct product){ factor, { kind, index } };
}

/* A load that acts in some segment of time */
static void add_load_term(struct assignment *a, const struct table *table, int segments, int row, int column)
{
	bool any = false;
	for (int s = 0; s < segments; s++)
		any = any || !table->load[(s * table->states + row) * table->columns + column].zero;
	if (any)
		a->term[a->terms++] = (struct product){ &table->load[row * table->columns + column], { OPERAND_LOAD, column } };
}

static bool is_identity(const struct assignment *a)
{
	return a->terms == 1 && a->term[0].operand.kind == OPERAND_STATE && a->term[0].operand.index == a->target && a->term[0].factor->value == 1;
}

static bool is_unit(const struct product *p, const struct linear *system)
{
	double value = p->factor->value;
	int column = p->operand.index;
	if (value == 1 || value == -1)
		return true;
	if (p->operand.kind != OPERAND_LOAD)
		return false;
	for (int l = 0; l < system->loads && column >= 0; column -= system->load[l++].columns)
		if (column == 0 && is_polynomial(system->load[l].wave))
			return true;            /* a constant load is added as it is */
	return false;
}

static void count(struct program *program, const struct linear *system)
{
	for (int i = 0; i < program->assignments; i++) {
		const struct assignment *a = &program->assignment[i];
		program->additions += a->terms > 0 ? a->terms - 1 : 0;
		for (int k = 0; k < a->terms; k++) {
			program->multiplications += !is_unit(&a->term[k], system);
			if (a->term[k].operand.kind == OPERAND_STATE)
				program->reads[a->term[k].operand.index] = true;
			else if (a->term[k].operand.kind == OPERAND_LOAD)
				program->uses[a->term[k].operand.index] = true;
		}
	}
	for (int l = 0, column = 0; l < system->loads; column += system->load[l++].columns) {
		const struct load *load = &system->load[l];
		bool used = false;
		for (int k = 0; k < load->columns; k++)
			used = used || program->uses[column + k];
		bool grows = used && mpq_sgn(load->wave->a) != 0, turns = used && oscillates(load->wave);
		program->oscillators += turns;
		program->growths += grows;
		program->multiplications += !used ? 0 : turns ? 2 * (load->powers - 1) + 2 * grows : load->powers > 1 ? load->powers - 2 + grows : 0;
	}
	program->multiplications += program->oscillators * PL_COSSIN_MUL + program->growths * PL_GROWTH_MUL;
	program->additions += program->oscillators * PL_COSSIN_ADD + program->growths * PL_GROWTH_ADD;
}

static struct program *linear_program(const struct table *table, const struct linear *system)
{
	int n = table->states;
	struct program *program = NEW(struct program);
	program->assignment = ARRAY(struct assignment, (size_t)n);
	program->reads = ARRAY(bool, (size_t)n);
	program->uses = ARRAY(bool, (size_t)table->columns);
	for (int i = 0; i < n; i++) {
		struct assignment *a = &program->assignment[program->assignments];
		a->target = i;
		a->terms = 0;
		a->term = ARRAY(struct product, (size_t)(n + table->columns + table->inputs));
		for (int j = 0; j < n; j++)
			add_term(a, &table->Phi[i * n + j], OPERAND_STATE, j);
		for (int k = 0; k < table->columns; k++)
			add_load_term(a, table, system->segments, i, k);
		for (int k = 0; k < table->inputs; k++)
			add_term(a, &table->input[i * table->inputs + k], OPERAND_INPUT, k);
		program->assignments += !is_identity(a);
	}
	count(program, system);
	program->loops = n > LIMIT_UNROLLED_STATES;
	if (program->loops) {
		int row = n + table->columns + table->inputs;
		program->multiplications = n * row + program->oscillators * PL_COSSIN_MUL + program->growths * PL_GROWTH_MUL;
		program->additions = n * row + program->oscillators * PL_COSSIN_ADD + program->growths * PL_GROWTH_ADD;
	}
	return program;
}

/* ---- the whole ---- */

static void find_growth(struct step *step)
{
	struct linear modified = modified_equation(&step->model->system, &step->system, step->model->h);
	struct pole_report *pole;
	int poles = poles_of(resolvent_of(&modified), &pole);
	mpfr_init2(step->growth, 53);
	mpfr_set_inf(step->growth, -1);
	for (int i = 0; i < poles; i++)
		mpfr_max(step->growth, step->growth, pole[i].re, MPFR_RNDN);
}

static void build(void *context)
{
	struct step *step = context;
	const struct model *model = step->model;
	step->written = resolvent_of(&model->written->system);
	step->solved = model->written == model ? step->written : resolvent_of(&model->system);
	check_pole_size(model, step->written);
	step->system = model->system;
	if (model->scheme == SCHEME_PL) {
		step->system = piecewise_laplace(&model->system);
		step->solved = resolvent_of(&step->system);
		find_growth(step);
	}
	series_place(&step->series, &step->system);
	step->table = table_of(model, step->solved, &step->system, true);
	step->program = linear_program(step->table, &step->system);
	series_plan(step);
}

struct step *step_build(const struct model *model)
{
	struct step *step = NEW(struct step);
	step->model = model;
	return statement_guard(build, step) ? step : NULL;
}
