/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What rounding does to a linear step with its loads counted, and the part of the state that is better not stepped.
 *
 * A load F cos(w t), w far above the poles, drives a velocity of size F/w, and a step that adds it up rounds to that
 * size; what else the state does may be far smaller, and so may be the places that the load reaches through others.
 * The forced part y_p of a load, P z with the load states z, solves the equations by itself: P J = A P + B, z' = J
 * z, y' = A y + B z. Then y - y_p moves freely, and nothing of the load's size is ever rounded into it; y_p is added
 * where the state is read. Near a pole y_p is large and y small: there the loads stay in the step. Which is better
 * is decided by a bound of either over the first steps.
 *
 * Where differences of coordinates are kept, a load that drives one of them fast is in all that are measured from it,
 * and what is written as their sum would be the small rest of large numbers: so y_p is added to the states as written,
 * each by factors of its own, and the bound is of these too. */
#include "model/linear/relative.h"
#include "step/cost.h"
#include "forms.h"
#include "step/certify/step_map.h"
#include "step/tapes.h"

#include <math.h>

enum {
	LIMIT_SOLVED = 48,
	TURNING = 3,                /* roundings where a load state is turned from its refresh */
	FEW_LOADS = 8
};

/* ---- the forced part of a load ---- */

/* States that a load can move: those of the blocks that it acts on */
static int moved_states(const struct linear *system, int load, int *state)
{
	struct block *block;
	int count = 0, blocks = blocks_of(system, &block);
	bool *moved = ARRAY(bool, system->states);
	for (int b = 0; b < blocks; b++)
		for (int i = 0; i < block[b].system.states && load_acts(&block[b].system, &block[b].system.load[load]);
		     i++)
			moved[block[b].state[i]] = true;
	for (int i = 0; i < system->states; i++)
		if (moved[i])
			state[count++] = i;
	return count;
}

/* [a - A, w; -w, a - A]^-1 over the states given; NULL: a + iw is a pole */
static const mpq_t *inverse_over(const struct linear *system, const struct forcing *forcing, int m, const int *state)
{
	RATIONALS *A = state_matrix(system, false), *part = rationals((size_t)(m * m));
	for (int i = 0; i < m * m; i++)
		mpq_set(part[i], A[state[i / m] * system->states + state[i % m]]);
	return shifted_inverse(m, part, forcing->a, oscillates(forcing) ? forcing->w : NULL);
}

/* P, states x columns of the load, in one segment of time */
static void force_states(const struct linear *system, const struct load *load, int segment, int m, const int *state,
			 const mpq_t *inverse, mpq_t *P)
{
	RATIONALS *W = inverse_of_leading(system), *part = rationals((size_t)(m * load->columns));
	for (int k = 0; k < load->columns; k++) {
		RATIONALS *slopes = slopes_by_force(system, W, load->force[k] + segment * system->n);
		for (int i = 0; i < m; i++)
			mpq_swap(part[k * m + i], slopes[state[i]]);
	}
	solve_forced(m, inverse, load, part);
	for (int k = 0; k < load->columns; k++)
		for (int i = 0; i < m; i++)
			mpq_swap(P[state[i] * load->columns + k], part[k * m + i]);
}

static struct coefficient rounded(mpq_srcptr q)
{
	struct coefficient c = { .value = round_rational(q), .zero = mpq_sgn(q) == 0 };
	RATIONAL rest = ZERO;
	if (!beyond_range(q))
		mpq_set_d(rest, c.value);
	mpq_sub(rest, q, rest);
	c.low = nearest_double(rest);
	return c;
}

/* P of the states as written, below that of those kept; from their rows over these and a constant, NULL: the same */
static void add_written(int states, int columns, const mpq_t *row, mpq_t *P)
{
	for (int i = 0; row && i < states; i++)
		for (int j = 0; j < states; j++)
			for (int k = 0; k < columns && mpq_sgn(row[i * (states + 1) + j]) != 0; k++)
				rational_addmul(P[(states + i) * columns + k], row[i * (states + 1) + j],
						P[j * columns + k]);
}

/* The load's columns of `part` and `change`; false: it has no forced part, or one beyond the range */
static bool fill_forced(const struct linear *system, int l, const mpq_t *written, struct forced *forced)
{
	const struct load *load = &system->load[l];
	int states = system->states, all = load_columns(system), first = column_of_load(system, l),
	    *state = ARRAY(int, states), rows = forced->rows;
	int m = moved_states(system, l, state);
	if (m * (oscillates(load->forcing) ? 2 : 1) > LIMIT_SOLVED)
		return false;
	const mpq_t *inverse = inverse_over(system, load->forcing, m, state);
	mpq_t *before = NULL;
	for (int s = 0; s < system->segments && inverse; s++) {
		mpq_t *P = rationals((size_t)(rows * load->columns));
		force_states(system, load, s, m, state, inverse, P);
		add_written(states, load->columns, written, P);
		for (int i = 0; i < rows * load->columns; i++) {
			int row = i / load->columns, column = first + i % load->columns;
			size_t cell = (size_t)((s * rows + row) * all + column);
			if (beyond_range(P[i]))
				return false;
			forced->part[cell] = rounded(P[i]);
			mpq_set(forced->exact[cell], P[i]);
			if (!before || row >= states)
				continue;
			mpq_sub(before[i], before[i], P[i]);
			forced->change[((s - 1) * states + row) * all + column] = rounded(before[i]);
		}
		before = P;
	}
	return inverse != NULL;
}

/* ---- a bound of rounding ---- */

/* what the program computes, and how far it may be off, in units of rounding */
struct rounded { double value, error; };

struct reckoning {
	const struct step *step;
	const struct course *course;
	const struct forced *forced;
	const int *load_of;         /* per column */
	int k;
	const struct rounded *from; /* states */
	struct rounded sum;
	double size;                /* sum of |products| */
};

/* Roundings of a load state relative to itself: of cos and sin, of a growth, of t and its products */
static double load_roundings(const struct reckoning *r, int column)
{
	int l = r->load_of[column], at = column - column_of_load(&r->step->branch->system, l);
	const struct load *load = &r->step->branch->system.load[l];
	return 2 + 3 * (mpq_sgn(load->forcing->a) != 0) + 4 * (at / (oscillates(load->forcing) ? 2 : 1));
}

/* A load with a refresh comes from cos and sin there together: what counts is how large they are together, in `value`,
 * a vector over the columns */
static double size_of(const struct reckoning *r, int column, double value, double partner)
{
	const struct load *load = &r->step->branch->system.load[r->load_of[column]];
	bool pair = is_refreshed(r->step, r->load_of[column]) && oscillates(load->forcing);
	return pair ? hypot(value, partner) : fabs(value);
}

/* The other one of cos and sin */
static int partner_of(const struct reckoning *r, int column)
{
	int first = column_of_load(&r->step->branch->system, r->load_of[column]);
	return oscillates(r->step->branch->system.load[r->load_of[column]].forcing) ? first + ((column - first) ^ 1)
										 : column;
}

/* Of a load state */
static double load_size(const struct reckoning *r, int column)
{
	const double *z = r->course->z + r->k * r->step->branch->full->columns;
	return size_of(r, column, z[column], z[partner_of(r, column)]);
}

static void reckon_load(struct reckoning *r, int row, int column)
{
	const struct table *table = r->step->branch->full;
	const struct coefficient *factor =
		table->load + (r->course->segment[r->k] * table->states + row) * table->columns;
	double z = load_size(r, column), value = factor[column].value;
	double most = size_of(r, column, value, factor[partner_of(r, column)].value);
	r->sum.value += value * r->course->z[r->k * table->columns + column];
	r->sum.error += most * load_roundings(r, column) * z;
	r->size += most * z;
}

static void reckon_product(struct reckoning *r, int row, const struct product *p)
{
	double factor = p->factor->value;
	if (p->operand.kind == OPERAND_LOAD && !(r->forced && r->forced->load[r->load_of[p->operand.index]]))
		reckon_load(r, row, p->operand.index);
	if (p->operand.kind != OPERAND_STATE)
		return;
	const struct rounded *x = &r->from[p->operand.index];
	r->sum.value += factor * x->value;
	r->sum.error += fabs(factor) * x->error;
	r->size += fabs(factor * x->value);
}

/* Each product is off by its factor's rounding and its own, and by those of the additions above it. */
static struct rounded reckon(struct reckoning *r, const struct assignment *a)
{
	const struct program *program = r->step->program;
	const struct rounded *old = &r->from[a->target];
	r->sum = (struct rounded){ 0, 0 };
	r->size = 0;
	for (int i = 0; i < a->terms; i++)
		reckon_product(r, a->target, &a->term[i]);
	r->sum.error += r->size * (2 + (program->loops ? a->terms : levels(a->terms)) + 8 * program->tuned);
	if (a->added) {
		r->sum.value += old->value;
		r->sum.error += old->error + (program->compensated || a->carried ? 0 : fabs(r->sum.value));
	}
	return r->sum;
}

static double unit_of(const struct step *step)
{
	return step->model->request.single ? 0x1p-24 : 0x1p-53;
}

static double part_of(const struct reckoning *r, int row, bool sizes)
{
	const struct table *table = r->step->branch->full;
	double sum = 0;
	for (int column = 0; r->forced && column < table->columns; column++) {
		if (!r->forced->load[r->load_of[column]])
			continue;
		const struct coefficient *c =
			&r->forced->part[(r->course->segment[r->k] * r->forced->rows + row) * table->columns + column];
		double term = (c->value + c->low) * r->course->z[r->k * table->columns + column];
		/* of a factor, perhaps to 0 */
		double lost = fabs(c->low * r->course->z[r->k * table->columns + column]) / unit_of(r->step);
		int roundings = 2 + (r->forced->written ? table->columns : levels(table->columns)) +
				(is_refreshed(r->step, r->load_of[column]) ? TURNING : 0);
		double most = fabs(c->value) * load_size(r, column);
		sum += sizes ? most * (roundings + load_roundings(r, column)) + lost : term;
	}
	return sum;
}

/* What rounds where the forced part changes its formula before the next step */
static double change_of(const struct reckoning *r, int state)
{
	const struct table *table = r->step->branch->full;
	int segment = r->course->segment[r->k];
	double sum = 0;
	for (int column = 0; r->forced && segment != r->course->segment[r->k + 1] && column < table->columns; column++)
		if (r->forced->load[r->load_of[column]])
			sum += fabs(r->forced->change[(segment * table->states + state) * table->columns + column]
					    .value *
				    r->course->z[(r->k + 1) * table->columns + column]) *
			       (4 + levels(table->columns) + load_roundings(r, column));
	return sum;
}

/* What one step adds to the errors of the states at most, and how large they are, after k steps; `from` is the state
 * as kept */
static void reckon_step(struct reckoning *r, double *largest, double *most)
{
	const struct program *program = r->step->program;
	int n = r->step->branch->system.states;
	struct rounded *now = ARRAY(struct rounded, n), *old = ARRAY(struct rounded, n);
	for (int i = 0; i < n; i++) {
		old[i] = now[i] = (struct rounded){ r->course->y[r->k * r->course->rows + i] - part_of(r, i, false),
						    0 };
		most[i] = fmax(most[i], fabs(old[i].value));
	}
	r->from = program->in_order ? now : old;
	for (int i = 0; i < program->assignments; i++) {
		struct rounded value = reckon(r, &program->assignment[i]);
		now[program->assignment[i].target] = value;
	}
	for (int i = 0; i < n; i++)
		largest[i] = fmax(largest[i], now[i].error);
}

/* Of a state as written: its value at the last set, and what has been gained of those kept and of the forced part */
static double read_written(const struct course *c, int n, int i, const double *most, double first, double last)
{
	enum { MORE = 4 };              /* of a difference, a ratio and its product, the forced part */
	int terms = 0;
	double sum = 0;
	for (int k = 0; k < n; k++) {
		terms += !mpfr_zero_p(c->written[i * (n + 1) + k]);
		sum += fabs(written_factor(c, n, i, k)) * 2 * most[k];
	}
	return first + last + (terms + MORE) * sum;
}

static const char *name_of_row(const struct step *step, int row)
{
	int states = step->branch->system.states;
	return row < states ? step->model->names.state[row] : step->model->relative->written->names.state[row - states];
}

/* Over the whole course, relative to each state's largest value; the worst */
static struct rounding bound_of(const struct step *step, const struct course *c, const struct forced *forced)
{
	int n = step->branch->system.states, rows = c->rows, *load_of = ARRAY(int, step->branch->full->columns);
	double *each = ARRAY(double, n), *most = ARRAY(double, n), *first = ARRAY(double, rows),
	       *last = ARRAY(double, rows);
	const double least = step->model->request.single ? 0x1p-102 : 0x1p-969; /* below, products leave the range */
	struct reckoning r = { .step = step, .course = c, .forced = forced, .load_of = load_of };
	struct rounding bound = { .known = true, .steps = c->steps, .state = name_of_row(step, 0) };
	for (int l = 0, column = 0; l < step->branch->system.loads; l++)
		for (int j = 0; j < step->branch->system.load[l].columns; j++)
			load_of[column++] = l;
	for (int i = 0; i < rows; i++)
		first[i] = fabs(c->y[i]) + part_of(&r, i, true) + fabs(c->y[i] - part_of(&r, i, false));
	for (r.k = 0; r.k < c->steps; r.k++) {
		reckon_step(&r, each, most);
		for (int i = 0; i < rows; i++)
			last[i] = fmax(last[i], part_of(&r, i, true));
		for (int i = 0; i < n; i++)
			first[i] += change_of(&r, i);
	}
	for (int i = 0; i < rows; i++) {
		double error = last[i] + c->largest[i];
		if (i >= n)
			error += read_written(c, n, i - n, most, first[i], last[i]);
		for (int j = 0; j < n; j++)
			error += c->sum[i * n + j] * each[j] + (1 + (i >= n)) * c->peak[i * n + j] * first[j];
		error *= unit_of(step) / c->largest[i];
		bound.tiny = bound.tiny || (c->largest[i] > 0 && c->largest[i] < least);
		if (c->largest[i] < least)
			continue;
		bound.known = bound.known && isfinite(error);
		if (error > bound.relative) {
			bound.relative = error;
			bound.state = name_of_row(step, i);
		}
	}
	return bound;
}

/* ---- which loads are better not stepped ---- */

/* What it costs to add the forced part, load states included */
static void count_forced(const struct step *step, struct forced *forced)
{
	const struct linear *system = &step->branch->system;
	int columns = step->branch->full->columns;
	struct tape *t = tape_new();
	tape_of_forced(t, step, "");
	const struct tape_cost cost = tape_cost(t);
	struct program program = { .uses = ARRAY(bool, columns), .multiplications = cost.multiplications,
				   .additions = cost.additions };
	for (int l = 0, column = 0; l < system->loads; column += system->load[l++].columns)
		program.uses[column] = tape_reads(t, TAPE_LOAD, l, -1);
	for (int i = 0; i < tape_outs(t); i++)          /* and to what is kept */
		program.additions += tape_out(t, i)->ref != tape_number(t, 0);
	if (forced->written)                            /* by a table */
		program.multiplications = program.additions = system->states * columns;
	(step->refresh ? count_rotated_loads : count_loads)(&program, step);
	forced->multiplications = program.multiplications;
	forced->additions = program.additions;
	for (int i = 0; i < (system->segments - 1) * system->states * columns; i++)
		forced->changes = forced->changes || (is_forced(step, i % columns) && forced->change[i].value != 0);
}

/* Takes loads while each makes the bound less than half of what it was; where there are many, all at once. */
static void choose_loads(struct step *step, const struct course *c, struct forced *forced, const bool *able)
{
	struct rounding best = step->rounding;
	int loads = step->branch->system.loads;
	for (int l = 0; l < loads && loads > FEW_LOADS; l++)
		forced->load[l] = able[l];
	if (loads > FEW_LOADS)
		best = bound_of(step, c, forced);
	for (int found = 0; found >= 0 && loads <= FEW_LOADS;) {
		struct rounding least = best;
		found = -1;
		for (int l = 0; l < loads; l++) {
			if (!able[l] || forced->load[l])
				continue;
			forced->load[l] = true;
			struct rounding bound = bound_of(step, c, forced);
			forced->load[l] = false;
			if (bound.known && bound.relative < 0.5 * best.relative && bound.relative < least.relative) {
				least = bound;
				found = l;
			}
		}
		if (found >= 0)
			forced->load[found] = true;
		best = least;
	}
	if (best.known && best.relative < 0.25 * step->rounding.relative) {
		step->rounding = best;
		step->forced = forced;
		count_forced(step, forced);
	}
}

void plan_forced(struct step *step)
{
	/* 2^17 units of rounding: over 1000 steps a bound, more than comes */
	const double much = step->model->request.single ? 0x1p-7 : 0x1p-36;
	struct linear *system = &step->branch->system;
	struct course course;
	bool any = false, *able = ARRAY(bool, system->loads);
	if (!any_load_acts(system) || system->heldK || step->model->request.again.derivatives > 0 ||
	    !make_course(step, &course))
		return;
	step->rounding = bound_of(step, &course, NULL);
	if (!step->rounding.known || step->rounding.relative <= much || step->model->params.tuning)
		return;
	const mpq_t *written = step->model->relative ? relative_rows(step->model) : NULL;
	const size_t cells = (size_t)(system->segments * course.rows * step->branch->full->columns);
	struct forced *forced = NEW(struct forced);
	*forced = (struct forced){ .load = ARRAY(bool, system->loads),
				   .rows = course.rows,
				   .written = course.rows - system->states,
				   .part = ARRAY(struct coefficient, cells),
				   .exact = rationals(cells),
				   .change = ARRAY(struct coefficient, cells) };
	for (int l = 0; l < system->loads; l++) {
		able[l] = load_acts(system, &system->load[l]) && fill_forced(system, l, written, forced);
		any = any || able[l];
	}
	if (any)
		choose_loads(step, &course, forced, able);
}

const char *rounding_text(const struct step *step)
{
	const struct rounding *r = &step->rounding;
	return format("In the first %d steps%s, loads included, rounding errors are at most %.2g of the largest value "
		      "of a state (%s)%s",
		      r->steps, step->branch->system.inputs ? " with inputs 0" : "", r->relative, r->state,
		      r->tiny ? format("; some are too small for %s", target_name()) : "");
}
