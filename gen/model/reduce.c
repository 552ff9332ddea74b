/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the outputs cannot see is left out, exactly: with T a basis of the rows c, c A, c A^2, ... of all outputs (the
 * observable part, Kalman 1963), w = T y obeys w' = A_r w + T W^-1 f with T A = A_r T. The basis is made of these rows
 * themselves, so a state of the reduced model is an output or a derivative of one. The poles that go are those that
 * cancel in every N/B. */
#include "model/model.h"

#include <string.h>

struct basis_row {
	mpq_t *row;                 /* over the written states */
	const char *name;
};
struct observable {
	int states, rank;
	const mpq_t *A;
	struct basis_row *basis;
	mpq_t *echelon;             /* rank x states: reduced rows */
	int *pivot;
	mpq_t *combination;         /* rank x states: each as a combination of the basis */
};

/* row = sum of coefficient_i basis_i; false: it is independent, and what is left of it stays in `rest` */
static bool express(const struct observable *o, const mpq_t *row, mpq_t *rest, mpq_t *coefficient)
{
	RATIONAL factor = ZERO, product = ZERO;
	for (int j = 0; j < o->states; j++) {
		mpq_set(rest[j], row[j]);
		mpq_set_ui(coefficient[j], 0, 1);
	}
	for (int r = 0; r < o->rank; r++) {
		mpq_set(factor, rest[o->pivot[r]]);
		for (int j = 0; j < o->states && mpq_sgn(factor) != 0; j++) {
			mpq_mul(product, factor, o->echelon[r * o->states + j]);
			mpq_sub(rest[j], rest[j], product);
			mpq_mul(product, factor, o->combination[r * o->states + j]);
			mpq_add(coefficient[j], coefficient[j], product);
		}
	}
	bool zero = true;
	for (int j = 0; j < o->states; j++)
		zero = zero && mpq_sgn(rest[j]) == 0;
	return zero;
}

static void add_row(struct observable *o, const mpq_t *row, const char *name)
{
	int n = o->states, r = o->rank, pivot = 0;
	mpq_t *rest = rationals((size_t)n), *coefficient = rationals((size_t)n);
	if (express(o, row, rest, coefficient))
		return;
	while (mpq_sgn(rest[pivot]) == 0)
		pivot++;
	RATIONAL scale = ZERO;
	mpq_inv(scale, rest[pivot]);
	for (int j = 0; j < n; j++) {
		mpq_mul(o->echelon[r * n + j], rest[j], scale);
		mpq_mul(o->combination[r * n + j], coefficient[j], scale);
		mpq_neg(o->combination[r * n + j], o->combination[r * n + j]);
	}
	mpq_set(o->combination[r * n + r], scale);
	o->pivot[r] = pivot;
	o->basis[r].row = rationals((size_t)n);
	for (int j = 0; j < n; j++)
		mpq_set(o->basis[r].row[j], row[j]);
	o->basis[r].name = name;
	o->rank++;
}

/* ---- rows to see ---- */

static const char *unit_name(const struct model *model, const mpq_t *row)
{
	int found = -1;
	for (int j = 0; j < model->system.states; j++) {
		if (mpq_sgn(row[j]) == 0)
			continue;
		if (found >= 0 || mpq_cmp_ui(row[j], 1, 1) != 0)
			return NULL;
		found = j;
	}
	return found < 0 ? NULL : model->state_name[found];
}

static void see_state(struct observable *o, const struct model *model, int state)
{
	mpq_t *row = rationals((size_t)o->states);
	mpq_set_ui(row[state], 1, 1);
	add_row(o, (const mpq_t *)row, model->state_name[state]);
}

/* Of an output that is not linear: every state that its expression names */
static void see_expression(struct observable *o, const struct model *model, const struct form *form)
{
	struct reads reads = reads_of(model, 1, &form);
	for (int i = 0; i < model->system.states; i++)
		if (reads.state[i])
			see_state(o, model, i);
}

/* W^-1 force as a column over the states */
static mpq_t *force_column(const struct linear *written, const mpq_t *inverse, const mpq_t *force)
{
	int n = written->n;
	mpq_t *highest = rationals((size_t)n), *column = rationals((size_t)written->states);
	rational_product(n, n, 1, inverse, force, highest);
	for (int i = 0; i < n; i++)
		mpq_set(column[written->velocity[i] >= 0 ? written->velocity[i] : i], highest[i]);
	return column;
}

/* Does no load and no input act on row . y' directly? Then (row A) y is the derivative of row y, and named so. */
static bool unforced(const struct linear *written, const mpq_t *inverse, const mpq_t *row)
{
	bool free = true;
	mpq_t *product = rationals(1);
	for (int l = 0; l < written->loads; l++)
		for (int k = 0; k < written->load[l].columns * written->segments; k++) {
			const mpq_t *force = (const mpq_t *)written->load[l].force[k / written->segments] +
					     k % written->segments * written->n;
			rational_product(1, written->states, 1, row,
					 (const mpq_t *)force_column(written, inverse, force), product);
			free = free && mpq_sgn(product[0]) == 0;
		}
	for (int i = 0; i < 2 * written->inputs; i++) {
		const mpq_t *force = (const mpq_t *)written->input[i / 2].force[i % 2];
		rational_product(1, written->states, 1, row, (const mpq_t *)force_column(written, inverse, force),
				 product);
		free = free && mpq_sgn(product[0]) == 0;
	}
	return free;
}

static const char *derivative_name(const struct observable *o, const struct model *model, const mpq_t *inverse,
				   const struct basis_row *of, const mpq_t *derivative)
{
	const char *unit = unit_name(model, derivative);
	if (unit)
		return unit;
	bool named = unforced(&model->system, inverse, (const mpq_t *)of->row);
	return named ? format("%s'", of->name) : format("state%d", o->rank + 1);
}

/* A row and its derivatives, as far as they are new */
static void see_row(struct observable *o, const struct model *model, const mpq_t *inverse, const mpq_t *row,
		    const char *name)
{
	mpq_t *derivative = rationals((size_t)o->states);
	for (int before = -1; before != o->rank && o->rank < o->states;) {
		before = o->rank;
		add_row(o, row, name);
		if (o->rank == before)
			return;
		const struct basis_row *last = &o->basis[o->rank - 1];
		rational_product(1, o->states, o->states, (const mpq_t *)last->row, o->A, derivative);
		name = derivative_name(o, model, inverse, last, (const mpq_t *)derivative);
		row = (const mpq_t *)derivative;
	}
}

/* Over coordinates alone, and without a load of its own: then the output itself is a state. */
static bool is_position(const struct model *model, const struct output *output)
{
	for (int j = model->n; j < model->system.states; j++)
		if (mpq_sgn(output->state[j]) != 0)
			return false;
	for (int l = 0; l < model->system.loads; l++)
		for (int k = 0; k < model->system.load[l].columns * model->system.segments; k++)
			if (mpq_sgn(output->load[l][k]) != 0)
				return false;
	for (int i = 0; i < 2 * model->system.inputs; i++)
		if (mpq_sgn(output->input[i % 2][i / 2]) != 0)
			return false;
	return true;
}

/* A row in the unit of its first entry: of an output k*(a - b) whose k is tunable, a - b, which stays what it is. */
static const mpq_t *bare_row(const mpq_t *row, int states)
{
	mpq_t *bare = rationals((size_t)states);
	int first = 0;
	while (first < states && mpq_sgn(row[first]) == 0)
		first++;
	for (int j = first; j < states; j++)
		mpq_div(bare[j], row[j], row[first]);
	return (const mpq_t *)bare;
}

static void see_outputs(struct observable *o, const struct model *model, const mpq_t *inverse, bool positions)
{
	for (int i = 0; i < model->outputs; i++) {
		const struct output *output = &model->output[i];
		bool tuned = output->value && first_tuned(output->value);
		const mpq_t *row = tuned ? bare_row((const mpq_t *)output->state, o->states)
					 : (const mpq_t *)output->state;
		const char *unit = unit_name(model, row);
		if ((output->form || !output->value) && is_position(model, output) == positions)
			see_row(o, model, inverse, row,
				unit                  ? unit
				: positions && !tuned ? output->name
						      : format("state%d", o->rank + 1));
	}
}

static struct observable observe(const struct model *model)
{
	size_t n = (size_t)model->system.states;
	struct observable o = { .states = model->system.states,
				.A = (const mpq_t *)state_matrix(&model->system, false) };
	mpq_t *inverse = rationals((size_t)model->n * (size_t)model->n);
	int column;
	leading_inverse(&model->system, inverse, &column);
	o.basis = ARRAY(struct basis_row, n);
	o.echelon = rationals(n * n);
	o.combination = rationals(n * n);
	o.pivot = ARRAY(int, n);
	for (int i = 0; i < model->outputs; i++)
		if (model->output[i].left)
			see_expression(&o, model, model->output[i].left);
	for (int r = o.rank - 1; r >= 0; r--) {
		mpq_t *derivative = rationals(n);
		rational_product(1, o.states, o.states, (const mpq_t *)o.basis[r].row, o.A, derivative);
		see_row(&o, model, (const mpq_t *)inverse, (const mpq_t *)derivative,
			derivative_name(&o, model, (const mpq_t *)inverse, &o.basis[r], (const mpq_t *)derivative));
	}
	see_outputs(&o, model, (const mpq_t *)inverse, true);
	see_outputs(&o, model, (const mpq_t *)inverse, false);
	return o;
}

/* The same space with a basis that has every written state that lies in it, so that those stay what they are. */
static struct observable with_written_states(const struct observable *all, const struct model *model)
{
	size_t n = (size_t)all->states;
	struct observable o = { .states = all->states,
				.A = all->A,
				.basis = ARRAY(struct basis_row, n),
				.pivot = ARRAY(int, n) };
	mpq_t *unit = rationals(n), *rest = rationals(n), *coefficient = rationals(n);
	o.echelon = rationals(n * n);
	o.combination = rationals(n * n);
	for (int j = 0; j < all->states; j++) {
		mpq_set_ui(unit[j], 1, 1);
		if (express(all, (const mpq_t *)unit, rest, coefficient))
			add_row(&o, (const mpq_t *)unit, model->state_name[j]);
		mpq_set_ui(unit[j], 0, 1);
	}
	for (int r = 0; r < all->rank; r++)
		add_row(&o, (const mpq_t *)all->basis[r].row, all->basis[r].name);
	return o;
}

/* ---- the reduced model ---- */

static mpq_t *coefficients_of(const struct observable *o, const mpq_t *row)
{
	mpq_t *rest = rationals((size_t)o->states), *coefficient = rationals((size_t)o->states);
	express(o, row, rest, coefficient);
	return coefficient;
}

/* T W^-1 force; a force is one rational per equation */
static void project_force(const struct observable *o, const struct linear *written, const mpq_t *inverse,
			  const mpq_t *force, mpq_t *reduced)
{
	mpq_t *column = force_column(written, inverse, force);
	for (int r = 0; r < o->rank; r++)
		rational_product(1, o->states, 1, (const mpq_t *)o->basis[r].row, (const mpq_t *)column, reduced + r);
}

static void project_loads(const struct observable *o, const struct linear *written, struct linear *system)
{
	int n = written->n, column;
	mpq_t *inverse = rationals((size_t)n * (size_t)n);
	leading_inverse(written, inverse, &column);
	system->segments = written->segments;
	system->change = written->change;
	system->loads = written->loads;
	system->load = ARRAY(struct load, (size_t)written->loads);
	for (int l = 0; l < written->loads; l++) {
		const struct load *load = &written->load[l];
		system->load[l] = *load;
		system->load[l].force = ARRAY(mpq_t *, (size_t)load->columns);
		for (int k = 0; k < load->columns; k++) {
			system->load[l].force[k] = rationals((size_t)written->segments * (size_t)o->rank);
			for (int s = 0; s < written->segments; s++)
				project_force(o, written, (const mpq_t *)inverse, (const mpq_t *)load->force[k] + s * n,
					      system->load[l].force[k] + s * o->rank);
		}
	}
	system->inputs = written->inputs;
	system->input = ARRAY(struct input, (size_t)written->inputs);
	for (int i = 0; i < written->inputs; i++) {
		system->input[i] = written->input[i];
		for (int k = 0; k < 2; k++) {
			system->input[i].force[k] = rationals((size_t)o->rank);
			project_force(o, written, (const mpq_t *)inverse, (const mpq_t *)written->input[i].force[k],
				      system->input[i].force[k]);
		}
	}
}

static struct linear project_system(const struct observable *o, const struct linear *written)
{
	int r = o->rank;
	mpq_t *A = rationals((size_t)r * (size_t)r), *derivative = rationals((size_t)o->states);
	for (int i = 0; i < r; i++) {
		rational_product(1, o->states, o->states, (const mpq_t *)o->basis[i].row, o->A, derivative);
		mpq_t *row = coefficients_of(o, (const mpq_t *)derivative);
		for (int j = 0; j < r; j++)
			mpq_set(A[i * r + j], row[j]);
	}
	struct linear system = first_order_system(r, (const mpq_t *)A);
	project_loads(o, written, &system);
	return system;
}

/* Which written states are states still, and which are not even combinations of them */
static void place_states(const struct observable *o, struct model *reduced)
{
	int states = o->states;
	mpq_t *unit = rationals((size_t)states), *rest = rationals((size_t)states),
	      *coefficient = rationals((size_t)states);
	reduced->reduction.place = ARRAY(int, (size_t)states);
	reduced->reduction.dropped_name = ARRAY(const char *, (size_t)states);
	for (int j = 0; j < states; j++) {
		mpq_set_ui(unit[j], 1, 1);
		reduced->reduction.place[j] = -1;
		for (int r = 0; r < o->rank; r++)
			if (strcmp(o->basis[r].name, reduced->written->state_name[j]) == 0)
				reduced->reduction.place[j] = r;
		if (!express(o, (const mpq_t *)unit, rest, coefficient))
			reduced->reduction.dropped_name[reduced->reduction.dropped++] = reduced->written->state_name[j];
		mpq_set_ui(unit[j], 0, 1);
	}
}

struct model *model_reduce(struct model *model)
{
	struct observable all = observe(model);
	model->reduction.irreducible = all.rank == model->system.states;
	if (model->reduction.irreducible)
		return model;
	if (all.rank == 0) {
		say_error(model->output[0].value->start, "without --reduce all states are kept",
			  "--reduce would leave no state: no output depends on one");
		return NULL;
	}
	struct observable o = with_written_states(&all, model);
	struct model *reduced = NEW(struct model);
	*reduced = *model;
	reduced->written = model;
	reduced->n = o.rank;
	reduced->system = project_system(&o, &model->system);
	reduced->state_name = reduced->coord_name = ARRAY(const char *, (size_t)o.rank);
	reduced->initial = rationals((size_t)o.rank);
	for (int r = 0; r < o.rank; r++) {
		reduced->state_name[r] = o.basis[r].name;
		rational_product(1, o.states, 1, (const mpq_t *)o.basis[r].row, (const mpq_t *)model->initial,
				 reduced->initial + r);
	}
	reduced->highest = ARRAY(struct output *, (size_t)o.rank); /* none: that was refused */
	reduced->output = ARRAY(struct output, (size_t)model->outputs);
	for (int i = 0; i < model->outputs; i++) {
		reduced->output[i] = model->output[i];
		reduced->output[i].state = coefficients_of(&o, (const mpq_t *)model->output[i].state);
	}
	place_states(&o, reduced);
	reduced->reduction.row = rationals((size_t)o.rank * (size_t)o.states);
	for (int r = 0; r < o.rank; r++)
		for (int j = 0; j < o.states; j++)
			mpq_set(reduced->reduction.row[r * o.states + j], o.basis[r].row[j]);
	return reduced;
}

bool same_reduction(const struct model *a, const struct model *b)
{
	const mpq_t *p = (const mpq_t *)a->reduction.row, *q = (const mpq_t *)b->reduction.row;
	int written = a->written->system.states;
	if (!p || !q)
		return p == q;
	bool same = a->n == b->n && written == b->written->system.states;
	for (int i = 0; same && i < a->n * written; i++)
		same = mpq_equal(p[i], q[i]);
	return same;
}
