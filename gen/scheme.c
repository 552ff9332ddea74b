/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scheme takes the equations apart into what is solved exactly and what is held over a step, and writes the step as
 * a program over the tables of the exact part. */
#include "plgen.h"

int load_columns(const struct linear *system)
{
	int columns = 0;
	for (int l = 0; l < system->loads; l++)
		columns += system->load[l].columns;
	return columns;
}

/* ---- pl ---- */

/* A = diagonal part, held = the rest */
static void split_diagonal(int n, mpq_t *A, mpq_t *held)
{
	for (int i = 0; i < n * n; i++)
		if (i / n != i % n)
			mpq_swap(A[i], held[i]);
}

static struct load normalized_load(int n, const mpq_t *inverse, const struct load *load)
{
	struct load normalized = { load->wave, load->columns, { NULL, NULL } };
	for (int k = 0; k < load->columns; k++) {
		normalized.force[k] = rationals((size_t)n);
		rational_product(n, n, 1, inverse, (const mpq_t *)load->force[k], normalized.force[k]);
	}
	return normalized;
}

/* Fang, Wang, Dai, Zhang 2020: after division by the mass matrix the other coordinates and their velocities are held
 * at their value at the step's start; a coordinate's own terms and the loads stay exact. */
static struct linear piecewise_laplace(const struct linear *written)
{
	int n = written->n, column;
	size_t cells = (size_t)(n * n);
	struct linear split = { .n = n, .loads = written->loads };
	split.M = rationals(cells);
	split.C = rationals(cells);
	split.K = rationals(cells);
	split.heldC = rationals(cells);
	split.heldK = rationals(cells);
	mpq_t *inverse = rationals(cells);
	rational_inverse(n, (const mpq_t *)written->M, inverse, &column);
	rational_product(n, n, n, (const mpq_t *)inverse, (const mpq_t *)written->C, split.C);
	rational_product(n, n, n, (const mpq_t *)inverse, (const mpq_t *)written->K, split.K);
	for (int i = 0; i < n; i++)
		mpq_set_ui(split.M[i * n + i], 1, 1);
	split_diagonal(n, split.C, split.heldC);
	split_diagonal(n, split.K, split.heldK);
	split.load = ARRAY(struct load, (size_t)written->loads);
	for (int l = 0; l < written->loads; l++)
		split.load[l] = normalized_load(n, (const mpq_t *)inverse, &written->load[l]);
	return split;
}

/* The modified equation of y+ = E y + h phi1 R y is y' = L y - (h/2) R L y + O(h^2), L = A + R: what is held lags by
 * half a step. With M = 1: C' = C - (h/2)(heldK - heldC C), K' = K + (h/2) heldC K, C and K with the held terms in. */
static struct linear modified_equation(const struct linear *split, mpq_srcptr h)
{
	int n = split->n;
	size_t cells = (size_t)(n * n);
	mpq_t *C = rationals(cells), *K = rationals(cells), *CC = rationals(cells), *CK = rationals(cells), half;
	mpq_init(half);
	mpq_div_2exp(half, h, 1);
	for (size_t i = 0; i < cells; i++) {
		mpq_add(C[i], split->C[i], split->heldC[i]);
		mpq_add(K[i], split->K[i], split->heldK[i]);
	}
	rational_product(n, n, n, (const mpq_t *)split->heldC, (const mpq_t *)C, CC);
	rational_product(n, n, n, (const mpq_t *)split->heldC, (const mpq_t *)K, CK);
	for (size_t i = 0; i < cells; i++) {
		mpq_sub(CC[i], CC[i], split->heldK[i]);
		mpq_mul(CC[i], CC[i], half);
		mpq_add(C[i], C[i], CC[i]);
		mpq_mul(CK[i], CK[i], half);
		mpq_add(K[i], K[i], CK[i]);
	}
	mpq_clear(half);
	return (struct linear){ .n = n, .M = split->M, .C = C, .K = K };
}

/* ---- the program of a linear step ---- */

static void add_term(struct assignment *a, const struct coefficient *factor, enum operand_kind kind, int index)
{
	if (factor->zero)
		return;
	a->term[a->terms++] = (struct product){ factor, { kind, index } };
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
	if (p->operand.kind == OPERAND_STATE)
		return false;
	for (int l = 0; l < system->loads && column >= 0; column -= system->load[l++].columns)
		if (column == 0 && !system->load[l].wave)
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
			else
				program->uses[a->term[k].operand.index] = true;
		}
	}
	for (int l = 0, column = 0; l < system->loads; column += system->load[l++].columns)
		if (system->load[l].wave && (program->uses[column] || program->uses[column + 1]))
			program->oscillators++;
	program->multiplications += program->oscillators * PL_COSSIN_MUL;
	program->additions += program->oscillators * PL_COSSIN_ADD;
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
		a->term = ARRAY(struct product, (size_t)(n + table->columns));
		for (int j = 0; j < n; j++)
			add_term(a, &table->Phi[i * n + j], OPERAND_STATE, j);
		for (int k = 0; k < table->columns; k++)
			add_term(a, &table->load[i * table->columns + k], OPERAND_LOAD, k);
		program->assignments += !is_identity(a);
	}
	count(program, system);
	return program;
}

/* ---- the whole ---- */

static void find_growth(struct step *step)
{
	struct linear modified = modified_equation(&step->system, step->model->h);
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
	step->written = resolvent_of(&model->system);
	step->solved = step->written;
	check_pole_size(model, step->written);
	step->system = model->system;
	if (model->scheme == SCHEME_PL) {
		step->system = piecewise_laplace(&model->system);
		step->solved = resolvent_of(&step->system);
		find_growth(step);
	}
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
