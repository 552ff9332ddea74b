/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the outputs cannot see is left out, exactly: with T a basis of the rows c, c A, c A^2, ... of all outputs (the
 * observable part, Kalman 1963), w = T y obeys w' = A_r w + T W^-1 f with T A = A_r T. The poles that go are those that
 * cancel in every N/B.
 *
 * These rows themselves grow as powers of the fastest pole. So the basis is that which is 1 at a written state of its
 * own, 0 at those of the other rows, and small elsewhere: written states that lie in the space are rows of it, and
 * what a row is a combination of stands in the row. */
#include "model/reads.h"
#include "modal_truncation.h"
#include "model/tunable/tuning.h"

#include <math.h>

struct observable {
	int states;
	const mpq_t *A;
	struct echelon space;       /* the state of each row's own is its pivot */
	mpq_t *row;                 /* in the end: rank x states */
};

/* Pivots are exchanged while an entry is above 2, each of which at least doubles a minor of T that is bounded (Knuth,
 * Semi-optimal bases for linear dependencies, 1985). The rows start as the space's own echelon form, so that what they
 * become depends on the space alone. */
static void make_small(struct echelon *e)
{
	int large;
	do {
		double most = 2;
		large = -1;
		for (int i = 0; i < e->rank * e->width; i++) {
			const double size = fabs(mpq_get_d(e->row[i / e->width][i % e->width]));
			large = size > most ? i : large;
			most = fmax(most, size);
		}
		if (large >= 0)
			echelon_pivot(e, large / e->width, large % e->width);
	} while (large >= 0);
}

/* By the states that are their own */
static void sort_rows(struct echelon *e)
{
	for (int r = 0; r < e->rank; r++)
		for (int i = r + 1; i < e->rank; i++) {
			const int pivot = e->pivot[r];
			mpq_t *const row = e->row[r];
			if (e->pivot[i] > pivot)
				continue;
			e->pivot[r] = e->pivot[i];
			e->row[r] = e->row[i];
			e->pivot[i] = pivot;
			e->row[i] = row;
		}
}

/* ---- rows to see ---- */

/* Of an output that is not linear: every state that its expression names */
static void see_function(struct observable *o, const struct model *model, const struct form *form)
{
	struct reads reads = reads_of(model, 1, &form);
	for (int i = 0; i < model->system.states; i++) {
		if (!reads.state[i])
			continue;
		mpq_t *row = rationals(o->states);
		mpq_set_ui(row[i], 1, 1);
		echelon_add(&o->space, row);
	}
}

static struct observable observe(const struct model *model)
{
	size_t n = (size_t)model->system.states;
	struct observable o = { .states = model->system.states,
				.A = state_matrix(&model->system, false),
				.space = echelon_new(model->system.states) };
	for (int i = 0; i < model->outputs; i++) {
		const struct output *output = &model->output[i];
		if (output->left)
			see_function(&o, model, output->left);
		if (output->form || !output->value)
			echelon_add(&o.space, rationals_copied(n, output->state));
	}
	/* A row changes by later ones alone, whose derivatives are seen with them. */
	for (int r = 0; r < o.space.rank; r++) {
		mpq_t *derivative = rationals(n);
		rational_product(1, o.states, o.states, o.space.row[r], o.A, derivative);
		echelon_add(&o.space, derivative);
	}
	make_small(&o.space);
	sort_rows(&o.space);
	o.row = rationals((size_t)o.space.rank * n);
	for (int i = 0; i < o.space.rank * o.states; i++)
		mpq_set(o.row[i], o.space.row[i / o.states][i % o.states]);
	return o;
}

/* ---- the reduced model ---- */

static mpq_t *coefficients_of(const struct observable *o, const mpq_t *row)
{
	mpq_t *coefficient = rationals(o->space.rank);
	for (int r = 0; r < o->space.rank; r++)
		mpq_set(coefficient[r], row[o->space.pivot[r]]);
	return coefficient;
}

struct projecting { const struct observable *o; const struct linear *written; const mpq_t *inverse; };

/* T W^-1 force */
static void project_force(const void *context, const mpq_t *force, mpq_t *reduced)
{
	const struct projecting *p = context;
	RATIONALS *slopes = slopes_by_force(p->written, p->inverse, force);
	rational_product(p->o->space.rank, p->o->states, 1, p->o->row, slopes, reduced);
}

static struct linear project_system(const struct observable *o, const struct linear *written)
{
	int r = o->space.rank;
	mpq_t *A = rationals((size_t)r * (size_t)r), *derivative = rationals((size_t)r * (size_t)o->states);
	rational_product(r, o->states, o->states, o->row, o->A, derivative);
	for (int i = 0; i < r * r; i++)
		mpq_set(A[i], derivative[i / r * o->states + o->space.pivot[i % r]]);
	struct linear system = first_order_system(r, A);
	const struct projecting projecting = { o, written, inverse_of_leading(written) };
	take_forces(&system, written, r, project_force, &projecting);
	return system;
}

/* ---- what states are called ---- */

static bool is_written(const struct observable *o, int r)
{
	int entries = 0;
	for (int j = 0; j < o->states; j++)
		entries += mpq_sgn(o->space.row[r][j]) != 0;
	return entries == 1;
}

/* Over coordinates alone, without a load of its own, and whatever params are tuned to: then the output is a state. */
static bool is_position(const struct model *model, const struct output *output)
{
	if (output->value && (!output->form || first_tuned(output->value)))
		return false;
	const struct linear *system = &model->system;
	bool position = rationals_zero((size_t)(system->states - model->n), output->state + model->n);
	for (int l = 0; l < system->loads; l++)
		position = position &&
			   rationals_zero((size_t)(system->load[l].columns * system->segments), output->load[l]);
	for (int k = 0; k < 2; k++)
		position = position && rationals_zero((size_t)system->inputs, output->input[k]);
	return position;
}

/* Is state r the derivative of state i: all that is on the right of it? */
static bool is_derivative(const struct linear *system, int i, int r)
{
	RATIONALS *to = rationals(system->n);
	mpq_set_si(to[r], -1, 1);
	bool is = rationals_equal((size_t)system->n, to, system->K + i * system->n);
	for (int l = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns * system->segments; k++)
			is = is && mpq_sgn(system->load[l].force[k / system->segments]
							  [k % system->segments * system->n + i]) == 0;
	for (int k = 0; k < 2 * system->inputs; k++)
		is = is && mpq_sgn(system->input[k / 2].force[k % 2][i]) == 0;
	return is;
}

static const char *name_of(const struct observable *o, const struct model *reduced, int r)
{
	const struct model *model = reduced->written;
	if (is_written(o, r))
		return model->names.state[o->space.pivot[r]];
	for (int i = 0; i < model->outputs; i++)
		if (is_position(model, &model->output[i]) &&
		    rationals_equal((size_t)o->states, o->space.row[r], model->output[i].state))
			return model->output[i].name;
	for (int i = 0; i < r; i++)
		if (is_derivative(&reduced->system, i, r))
			return format("%s'", reduced->names.state[i]);
	return format("state%d", r + 1);
}

/* Which written states are states still; the others are not even combinations of them. */
static void place_states(const struct observable *o, struct model *reduced)
{
	struct reduction *reduction = &reduced->reduction;
	reduction->place = ARRAY(int, o->states);
	reduction->dropped_name = ARRAY(const char *, o->states);
	for (int j = 0; j < o->states; j++)
		reduction->place[j] = -1;
	for (int r = 0; r < o->space.rank; r++)
		if (is_written(o, r))
			reduction->place[o->space.pivot[r]] = r;
	for (int j = 0; j < o->states; j++)
		if (reduction->place[j] < 0)
			reduction->dropped_name[reduction->dropped++] = reduced->written->names.state[j];
}

struct model *model_reduce(struct model *model)
{
	if (!model->request.reduce)
		return model;
	struct observable o = observe(model);
	const int rank = o.space.rank;
	model->reduction.irreducible = rank == model->system.states;
	if (model->reduction.irreducible)
		return model;
	if (rank == 0) {
		say_error(model->output[0].value->start, "without --reduce all states are kept",
			  "--reduce would leave no state: no output depends on one");
		return NULL;
	}
	struct model *reduced = NEW(struct model);
	*reduced = *model;
	reduced->written = model;
	reduced->n = rank;
	reduced->system = project_system(&o, &model->system);
	reduced->names.state = reduced->names.coord = ARRAY(const char *, rank);
	for (int r = 0; r < rank; r++)
		reduced->names.state[r] = name_of(&o, reduced, r);
	reduced->initial = rationals(rank);
	rational_product(rank, o.states, 1, o.row, model->initial, reduced->initial);
	reduced->equations.highest = ARRAY(struct output *, rank); /* none: that was refused */
	reduced->output = ARRAY(struct output, model->outputs);
	for (int i = 0; i < model->outputs; i++) {
		reduced->output[i] = model->output[i];
		reduced->output[i].state = coefficients_of(&o, model->output[i].state);
	}
	place_states(&o, reduced);
	reduced->reduction.row = o.row;
	return reduced;
}

bool same_reduction(const struct model *a, const struct model *b)
{
	const mpq_t *p = a->reduction.row, *q = b->reduction.row;
	int written = a->written->system.states;
	if (!p || !q)
		return p == q;
	return a->n == b->n && written == b->written->system.states &&
	       rationals_equal((size_t)(a->n * written), p, q);
}
