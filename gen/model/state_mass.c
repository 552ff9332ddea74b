/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Equations in which highest derivatives have factors of the state, of time or of tunable params: M(q) q'' = f. They
 * are linear in q'', so M is the derivative of the residuals by q'', and f is what they are without. Equations that M
 * couples are solved together: q_j'' - (M^-1 f)_j takes the place of each, an atom that schemes treat as any other.
 * Blocks in which M is constant stay as they are, for the exact linear core.
 *
 * Constraints g = 0 are rows too, of their last derivative G q'' + ..., and their multipliers columns, of G^T: index 3
 * as it stands, since a series has no order to lose; what rounding takes from g is projected out (constraints.h). */
#include "building.h"
#include "checks.h"
#include "state_mass.h"

#include <math.h>

struct solving {
	struct building *b;
	struct segment_equations *s;
	int coords, n;              /* coordinates, and multipliers behind them, as rows of constraints behind others */
	struct form **M;            /* [row][coordinate]: of the residuals */
	struct point *rest;         /* where highest derivatives are 0 */
	int *block;                 /* rows, then coordinates: parent pointers */
};

static int highest_order(const struct building *b, int coord)
{
	return coord >= b->model->n || b->model->system.velocity[coord] >= 0 ? 2 : 1;
}

static const struct form *residual_of(const struct solving *w, int row)
{
	return row < w->coords ? w->s->residual[row].form : w->s->constraint[row - w->coords].by[2];
}

/* The row of a coordinate, or of the constraint of a multiplier */
static int row_of(const struct solving *w, int coord)
{
	return coord < w->coords ? w->b->owner[coord] : coord;
}

const struct atom *atom_of_highest(const struct form *form)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.atom && form->term[i].basis.atom->highest)
			return form->term[i].basis.atom;
	return NULL;
}

static bool finds_highest(const struct building *b, const struct form *form, int coord, bool *seen)
{
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		const struct atom *a = basis->atom;
		if (!a && is_highest(&b->model->frame, basis) && basis->index == coord)
			return true;
		if (!a || !a->highest || seen[a->index])
			continue;
		seen[a->index] = true;
		for (int k = 0; k < a->operands; k++)
			if (finds_highest(b, a->operand[k], coord, seen))
				return true;
	}
	return false;
}

bool has_highest(const struct building *b, const struct form *form, int coord)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	return finds_highest(b, form, coord, seen);
}

struct starting {
	struct building *b;
	struct point *start;
	struct moving_mass *mass;
};

/* ---- M and f ---- */

/* Forces of friction may read multipliers: they are solved for where it slips. */
static const struct form *without_friction(const struct form *form)
{
	struct form *rest = NEW(struct form);
	for (int i = 0; i < form->terms; i++)
		if (!is_friction(form->term[i].basis.atom))
			form_add_basis(rest, form->term[i].basis, form->term[i].factor);
	return rest;
}

/* Of all residuals at once, so that each atom is derived once */
static void find_column(struct solving *w, int coord)
{
	const struct form **residual = ARRAY(const struct form *, w->n);
	for (int i = 0; i < w->n; i++)
		residual[i] = without_friction(residual_of(w, i));
	struct form **slope = form_derivatives(&w->b->collector, w->n, residual, false, coord,
					       highest_order(w->b, coord));
	for (int i = 0; i < w->n; i++)
		w->M[i * w->n + coord] = slope[i];
}

/* A form where highest derivatives are 0; terms without them stay as they are. Friction is added by what holds. */
static struct form *at_rest(const struct building *b, struct point *rest, const struct form *form)
{
	struct form *sum = NEW(struct form);
	for (int i = 0; i < form->terms; i++) {
		const struct form_term *term = &form->term[i];
		const struct form *alone = form_unit(term->basis);
		if (is_highest(&b->model->frame, &term->basis) || is_friction(term->basis.atom))
			continue;
		if (atom_of_highest(alone))
			form_add_to(sum, form_at(rest, alone), term->factor);
		else
			form_add_basis(sum, term->basis, term->factor);
	}
	return sum;
}

static struct point *point_at_rest(struct building *b, int n)
{
	struct fixing *fixing = ARRAY(struct fixing, n);
	for (int j = 0; j < n; j++) {
		fixing[j] = (struct fixing){ .symbol = b->model->frame.coord[j], .coord = j,
					     .order = highest_order(b, j) };
		mpq_init(fixing[j].value);
	}
	return point_new(&b->collector, n, fixing);
}

/* ---- the order of elimination: next who is coupled with fewest of those that are left ---- */

static int degree(const struct solving *w, const bool *coupled, const bool *left, int coord)
{
	int count = 0;
	for (int j = 0; j < w->n; j++)
		count += left[j] && coupled[coord * w->n + j];
	return count;
}

static void fill_in(const struct solving *w, bool *coupled, const bool *left, int coord)
{
	for (int i = 0; i < w->n; i++)
		for (int j = 0; j < w->n; j++)
			if (left[i] && left[j] && coupled[coord * w->n + i] && coupled[coord * w->n + j])
				coupled[i * w->n + j] = true;
}

/* A multiplier comes behind all coordinates that it acts on: then its pivot is -G M^-1 G^T. */
static bool is_ready(const struct solving *w, const bool *left, int coord)
{
	bool ready = left[coord];
	for (int j = 0; j < w->coords && coord >= w->coords; j++)
		ready = ready && !(left[j] && w->M[coord * w->n + j]->terms);
	return ready;
}

/* Coordinates of a block in this order; returns how many */
static int order_of_block(const struct solving *w, int block, int *order)
{
	int n = w->n, count = 0;
	SCRATCH bool *left = ARRAY(bool, n), *coupled = ARRAY(bool, n * n);
	for (int i = 0; i < n; i++) {
		left[i] = root_of_node(w->block, n + i) == block;
		for (int j = 0; j < n; j++)
			if (w->M[row_of(w, i) * n + j]->terms)
				coupled[i * n + j] = coupled[j * n + i] = true;
	}
	for (;;) {
		int next = -1;
		for (int j = 0; j < n; j++)
			if (is_ready(w, left, j) &&
			    (next < 0 || degree(w, coupled, left, j) < degree(w, coupled, left, next)))
				next = j;
		if (next < 0)
			return count;
		left[next] = false;
		fill_in(w, coupled, left, next);
		order[count++] = next;
	}
}

/* ---- blocks ---- */

static void find_blocks(struct solving *w)
{
	w->block = ARRAY(int, 2 * w->n);
	for (int i = 0; i < 2 * w->n; i++)
		w->block[i] = i;
	for (int i = 0; i < w->n; i++)
		for (int j = 0; j < w->n; j++)
			if (w->M[i * w->n + j]->terms) {
				join_nodes(w->block, i, w->n + j);
				join_nodes(w->block, row_of(w, j), w->n + j); /* without a mass, too: held by -x = 0 */
			}
}

/* Without constraints */
static bool is_constant_block(const struct solving *w, int block)
{
	bool constant = true;
	for (int i = w->coords; i < w->n; i++)
		constant = constant && root_of_node(w->block, i) != block;
	for (int i = 0; i < w->n; i++)
		for (int j = 0; j < w->n && root_of_node(w->block, i) == block; j++)
			constant = constant && is_constant(w->M[i * w->n + j]);
	return constant;
}

/* What moves the mass matrix, or the constraint; NULL: neither stands here */
static const struct node *node_of_row(const struct solving *w, int row)
{
	const struct atom *atom = atom_of_highest(residual_of(w, row));
	return row >= w->coords ? w->s->constraint[row - w->coords].statement->value : atom ? atom->node : NULL;
}

/* The system where the spec starts; what follows from inputs is 0 */
static double *system_at_start(const struct solving *w, int n, const struct form *const *M)
{
	struct point *start = point_at_state(w->b, w->b->model->initial, NULL);
	double *value = ARRAY(double, n * n);
	RATIONAL entry = ZERO;
	for (int i = 0; i < n * n; i++) {
		const struct form *here = M[i]->terms ? form_at(start, M[i]) : M[i];
		if (here->terms == 0 || !is_constant(here))
			continue;
		constant_value(&w->b->collector, here, entry);
		value[i] = mpq_get_d(entry);
	}
	return value;
}

/* Whether elimination in this order meets a coordinate whose pivot is rounding, at the start: x' + y' is all that T
 * reads of x and y */
static bool cancels(int n, double *M, int coords, const int *order)
{
	SCRATCH double *own = ARRAY(double, n);
	for (int k = 0; k < n; k++)
		own[k] = fabs(M[k * n + k]);
	for (int k = 0; k < n; k++) {
		const double pivot = M[k * n + k];
		if (order[k] < coords && fabs(pivot) <= 1e-12 * own[k])
			return true;
		for (int i = k + 1; i < n && pivot != 0; i++)
			for (int j = k + 1; j < n; j++)
				M[i * n + j] -= M[i * n + k] / pivot * M[k * n + j];
	}
	return false;
}

/* Whether some coordinate beside constraints has no mass of its own, in whatever state, or none that others leave */
static bool lacks_mass(const struct solving *w, int n, const int *order, const struct form *const *M)
{
	bool lacks = false, held = false;
	for (int i = 0; i < n; i++) {
		held = held || order[i] >= w->coords;
		lacks = lacks || (order[i] < w->coords && M[i * n + i]->terms == 0);
	}
	if (lacks || !held || w->b->request->again.tunable)
		return lacks;
	SCRATCH double *start = system_at_start(w, n, M);
	return cancels(n, start, w->coords, order);
}

/* To the row of a coordinate G^T times those of its constraints, which are 0: M + G^T G has pivots where M has none. */
static void add_constraints(struct solving *w, int n, const int *order, int i, const struct form **M,
			    const struct form **f, const struct form **F)
{
	struct collector *c = &w->b->collector;
	for (int k = 0; k < n && order[i] < w->coords; k++) {
		const struct form *slope = M[k * n + i];
		const struct node *node = order[k] < w->coords ? NULL : node_of_row(w, row_of(w, order[k]));
		if (!node || slope->terms == 0)
			continue;
		for (int j = 0; j < n; j++) {
			const struct form *other = order[j] < w->coords ? M[k * n + j] : NEW(struct form);
			M[i * n + j] = form_sum(M[i * n + j], kept_product(c, node, slope, other), false);
		}
		f[i] = form_sum(f[i], kept_product(c, node, slope, f[k]), false);
		F[i] = form_sum(F[i], kept_product(c, node, slope, F[k]), false);
	}
}

static bool eliminates(const struct solving *w)
{
	return w->b->eliminates && w->s != w->b->full;
}

/* Where all coefficients are numbers: highest derivatives and multipliers as linear forms; false: M is singular */
static bool solve_linear_block(struct solving *w, const struct node *node, int n, const int *order,
			       const struct form *const *M, const struct form *const *f)
{
	struct building *b = w->b;
	RATIONALS *value = rationals((size_t)(n * n)), *inverse = rationals((size_t)(n * n));
	const struct energy *kinetic;
	bool definite;
	int column, coords = 0;
	while (coords < n && order[coords] < w->coords)
		coords++;
	for (int i = 0; i < n * n; i++)
		constant_value(&b->collector, M[i], value[i]);
	const int negative = negative_mass(b, coords, n, value, &kinetic, &definite);
	if (negative >= 0)
		report_negative_mass(b, kinetic, order[negative]);
	b->eliminates = negative < 0 && rational_inverse(n, value, inverse, &column);
	for (int i = 0; i < n && b->eliminates; i++) {
		struct form *solution =
			kept_solution(&b->collector, node, &(struct linear_system){ n, M, f, NULL }, i);
		if (order[i] >= w->coords)
			w->s->multiplier[order[i] - w->coords] = solution;
		else
			w->s->residual[row_of(w, order[i])].form =
				form_difference(form_unit((struct basis){ .kind = BASIS_COORD, .index = order[i],
									  .order = highest_order(b, order[i]) }),
						solution);
	}
	return negative >= 0 || b->eliminates;
}

static void solve_block(struct solving *w, int block)
{
	SCRATCH int *order = ARRAY(int, w->n);
	const int n = order_of_block(w, block, order);
	const struct form **M = ARRAY(const struct form *, n * n), **f = ARRAY(const struct form *, n),
			  **F = ARRAY(const struct form *, n);
	struct basis *highest = ARRAY(struct basis, n);
	const struct node *node = NULL;
	for (int i = 0; i < n; i++) {
		const int row = row_of(w, order[i]);
		F[i] = residual_of(w, row);
		highest[i] = (struct basis){ .kind = BASIS_COORD, .index = order[i],
					     .order = highest_order(w->b, order[i]) };
		node = node ? node : node_of_row(w, row);
	}
	for (int i = 0; i < n * n; i++)
		M[i] = w->M[row_of(w, order[i / n]) * w->n + order[i % n]];
	struct nonlinear_terms *terms = take_nonlinear_terms(w->b, node, n, highest, M, F);
	for (int i = 0; i < n; i++)
		f[i] = form_difference(NEW(struct form), at_rest(w->b, w->rest, F[i]));
	if (eliminates(w) && solve_linear_block(w, node, n, order, M, f))
		return;
	for (int i = 0; i < n * n && terms; i++)
		M[i] = form_difference(M[i], terms->slope[i]);
	const bool lacks = lacks_mass(w, n, order, M);
	for (int i = 0; i < n && lacks; i++)
		add_constraints(w, n, order, i, M, f, F);
	for (int i = 0; i < n && terms; i++)
		F[i] = form_sum(F[i], terms->N[i], false);
	struct written_system *written = NEW(struct written_system);
	*written = (struct written_system){ .rows = n, .highest = highest, .residual = F };
	const struct linear_system linear = { n, M, f, written },
				   e = terms ? newton_system(w->b, node, &linear, terms) : linear;
	w->b->model->equations.moving_mass = node;
	if (terms)
		w->b->model->equations.implicit = node;
	*MORE(w->s->mass, w->s->masses) = (struct moving_mass){ node, e, linear, NULL };
	for (int i = 0; i < n; i++) {
		struct form *solution = kept_solution(&w->b->collector, node, &e, i);
		if (order[i] < w->coords)
			w->s->residual[row_of(w, order[i])].form = form_difference(form_unit(highest[i]), solution);
		else
			w->s->multiplier[order[i] - w->coords] = solution;
	}
}

static void solve_blocks(void *context)
{
	struct solving *w = context;
	for (int i = 0; i < w->n; i++)
		refuse_jumps_of_solved(w->b, without_friction(residual_of(w, i)));
	for (int j = 0; j < w->n; j++)
		find_column(w, j);
	find_blocks(w);
	for (int i = 0; i < 2 * w->n; i++)
		if (root_of_node(w->block, i) == i && !is_constant_block(w, i))
			solve_block(w, i);
	if (eliminates(w) && !diagnostics_errors())
		eliminate_dependent(w->b, w->s);
}

void solve_for_highest(struct building *b, struct segment_equations *s)
{
	const int constraints = b->spec->count.multipliers;
	bool any = constraints > 0;
	for (int i = 0; i < b->model->n; i++)
		any = any || atom_of_highest(s->residual[i].form);
	if (!any)
		return;
	struct solving w = { .b = b, .s = s, .coords = b->model->n, .n = b->model->n + constraints };
	s->multiplier = ARRAY(struct form *, (size_t)constraints + 1);
	w.M = ARRAY(struct form *, w.n * w.n);
	w.rest = point_at_rest(b, w.n);
	b->collector.equation = true;
	statement_guard(solve_blocks, &w);
	b->collector.equation = false;
}

/* ---- at the start ---- */

/* The first of n rows whose pivot in L D L^T is below 0 by more than rounding of constants; -1: there is none, or M, n
 * x n in rows of `width`, is not symmetric. Constraints come last, rows without mass have no pivot. *definite: each is
 * above 0 by more than that. Digits are cut as they grow, else they would be as many as M has entries. */
static int negative_pivot(int n, int width, mpq_t *M, bool *definite)
{
	*definite = false;
	RATIONALS *rest = rationals((size_t)(n * n)), *size = rationals(n + 1);
	RATIONAL part = ZERO;
	for (int i = 0; i < n * n; i++) {
		mpq_set(rest[i], M[i / n * width + i % n]);
		if (!mpq_equal(M[i / n * width + i % n], M[i % n * width + i / n]))
			return -1;
	}
	for (int k = 0; k < n; k++) {
		mpq_abs(size[k], M[k * width + k]);
		mpq_div_2exp(size[k], size[k], 60);
	}
	for (int k = 0; k < n; k++) {
		mpq_neg(part, rest[k * n + k]);
		if (mpq_cmp(part, size[k]) > 0)
			return k;
		*definite = (k == 0 || *definite) && mpq_cmp(rest[k * n + k], size[k]) > 0;
		for (int i = k + 1; i < n && mpq_sgn(part) < 0; i++) {
			mpq_div(size[n], rest[i * n + k], rest[k * n + k]);
			round_long(size[n]);
			for (int j = k + 1; j < n; j++) {
				mpq_mul(part, size[n], rest[k * n + j]);
				mpq_sub(rest[i * n + j], rest[i * n + j], part);
				round_long(rest[i * n + j]);
			}
			mpq_neg(part, rest[k * n + k]);
		}
	}
	return -1;
}

int negative_mass(const struct building *b, int n, int width, mpq_t *M, const struct energy **kinetic, bool *definite)
{
	*definite = false;
	*kinetic = NULL;
	for (int i = b->spec->lagrange.energies - 1; i >= 0; i--)
		if (b->spec->lagrange.energy[i].kind == 'T')
			*kinetic = &b->spec->lagrange.energy[i];
	return *kinetic && b->spec->equations == 0 ? negative_pivot(n, width, M, definite) : -1;
}

void report_negative_mass(const struct building *b, const struct energy *kinetic, int coord)
{
	say_error(kinetic->value->start, NULL, "negative kinetic energy along %s: sign of T?",
		  b->model->names.coord[coord]);
}

/* M where the spec starts; what inputs change in it is not looked at */
static void check_mass_of(void *context)
{
	const struct starting *work = context;
	const struct model *model = work->b->model;
	const struct linear_system *system = &work->mass->plain;
	const int n = system->n;
	RATIONALS *value = rationals((size_t)(n * n)), *inverse = rationals((size_t)(n * n));
	int column;
	for (int i = 0; i < n * n; i++) {
		const struct form *entry = form_at(work->start, system->M[i]);
		if (!is_constant(entry))
			return;
		constant_value(&work->b->collector, entry, value[i]);
		round_long(value[i]);
	}
	const struct energy *kinetic;
	bool definite;
	int coords = 0;
	while (coords < n && system->written->highest[coords].index < model->n)
		coords++;
	const int negative = negative_mass(work->b, coords, n, value, &kinetic, &definite);
	if (negative >= 0)
		report_negative_mass(work->b, kinetic, system->written->highest[negative].index);
	if (negative >= 0)
		return;
	if ((definite && coords == n) || rational_inverse(n, value, inverse, &column)) {
		work->mass->start = rationals_copied((size_t)(n * n), (const mpq_t *)value);
		return;
	}
	const struct basis *highest = &system->written->highest[column];
	error(work->mass->node->start, "another start, or a mass that moves with it",
	      "%s singular at the start: the equations do not determine %s%s there",
	      work->mass->system.written->slope ? "without what is not linear in highest derivatives the mass matrix is"
						: "the mass matrix is",
	      model->names.coord[highest->index],
	      highest->index >= model->n ? "" : highest->order == 2 ? "''" : "'");
}

static void check_kinks_of(void *context)
{
	const struct starting *work = context;
	check_kinks_at_start(work->b, work->start, work->mass->system.written);
}

void check_mass_at_start(struct building *b)
{
	struct starting work = { .b = b, .start = point_at_state(b, b->model->initial, NULL) };
	/* M of energies that are never below 0 has no negative pivot, G M^-1 G^T of constraints no positive one. */
	b->model->equations.indefinite = b->full->masses > 0 && (b->spec->equations > 0 || b->full->negative_kinetic);
	for (int i = 0; i < b->full->masses && !diagnostics_errors(); i++) {
		work.mass = &b->full->mass[i];
		statement_guard(check_mass_of, &work);
		if (work.mass->system.written->slope && !diagnostics_errors())
			statement_guard(check_kinks_of, &work);
	}
}

/* ---- forces on mechanisms ---- */

struct form *form_at_rest(struct building *b, const struct form *form)
{
	return at_rest(b, point_at_rest(b, b->model->n), form);
}

static const struct linear_system *system_of_coord(const struct segment_equations *s, int coord, int *row)
{
	for (int i = 0; i < s->masses; i++) {
		const struct written_system *written = s->mass[i].system.written;
		for (*row = 0; *row < written->rows; ++*row)
			if (written->highest[*row].index == coord)
				return &s->mass[i].system;
	}
	return NULL;
}

bool has_moving_mass(const struct segment_equations *s, int coord)
{
	int row;
	return system_of_coord(s, coord, &row) != NULL;
}

bool is_symmetric_mass(const struct linear_system *e)
{
	bool symmetric = true;
	for (int j = 0; j < e->n * e->n; j++)
		symmetric = symmetric && same_form(e->M[j], e->M[j % e->n * e->n + j / e->n]);
	return symmetric;
}

const char *unsymmetric_mass(const struct building *b, const struct form *const *force)
{
	int row;
	for (int k = 0; k < b->model->n; k++) {
		const struct linear_system *e = system_of_coord(b->full, k, &row);
		if (e && force[k]->terms && !is_symmetric_mass(e))
			return b->model->names.coord[k];
	}
	return NULL;
}

mpq_t *inverse_masses(const struct building *b, const struct segment_equations *s)
{
	struct linear shape = linear_like(&b->model->system);
	const int n = shape.n;
	int column;
	mpq_t *inverse = rationals((size_t)(n * n)), *matrix[] = { shape.K, shape.C, shape.M };
	for (int i = 0; i < n; i++)
		for (int k = 0; k < s->residual[i].form->terms; k++) {
			const struct form_term *term = &s->residual[i].form->term[k];
			if (term->basis.kind == BASIS_COORD)
				mpq_set(matrix[term->basis.order][i * n + term->basis.index], term->factor);
		}
	if (!leading_inverse(&shape, inverse, &column))
		abandon();                      /* reported with the equations */
	return inverse;
}

static struct form *acceleration_in_block(struct building *b, const struct linear_system *e, int row,
					  const struct form *const *force)
{
	const struct form **f = ARRAY(const struct form *, e->n), *none = form_number(0);
	for (int i = 0; i < e->n; i++) {
		const int coord = e->written->highest[i].index;
		f[i] = coord < b->model->n ? force[b->owner[coord]] : none;
	}
	return kept_solution(&b->collector, b->model->equations.moving_mass,
			     &(struct linear_system){ e->n, e->M, f, NULL }, row);
}

const struct form **accelerations_by(struct building *b, const struct form *const *force)
{
	const int n = b->model->n;
	const mpq_t *inverse = inverse_masses(b, b->full);
	const struct form **by = ARRAY(const struct form *, n);
	for (int j = 0; j < n; j++) {
		int row;
		const struct linear_system *e = system_of_coord(b->full, j, &row);
		struct form *sum = NEW(struct form);
		for (int i = 0; i < n && !e; i++)
			if (mpq_sgn(inverse[j * n + i]) != 0)
				form_add_to(sum, force[i], inverse[j * n + i]);
		by[j] = e ? acceleration_in_block(b, e, row, force) : sum;
	}
	return by;
}

const struct form **forces_of_accelerations(struct building *b, const mpq_t *acceleration)
{
	const int n = b->model->n;
	const struct form **force = ARRAY(const struct form *, n);
	for (int j = 0; j < n; j++) {
		int row;
		const struct linear_system *e = system_of_coord(b->full, j, &row);
		struct form *sum = NEW(struct form);
		for (int k = 0; e && k < e->n; k++) {
			const int coord = e->written->highest[k].index;
			if (coord < n && mpq_sgn(acceleration[coord]) != 0)
				form_add_to(sum, e->M[row * e->n + k], acceleration[coord]);
		}
		force[j] = sum;
	}
	return force;
}
