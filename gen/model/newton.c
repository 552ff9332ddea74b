/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Equations that are not linear in highest derivatives u or multipliers, friction apart: M u + N(u) = f. Newton's
 * method starts from M u = f, or from M u + N_u(0) u = f - N(0) where M does not determine u. Its iterates are forms,
 * of the unknowns in N alone; the last step is a linear system of all unknowns, which takes the place of M u = f.
 * Where N has kinks, all iterates have the formulas that hold for the solution, from event to event. */
#include "building.h"
#include "math/math.h"
#include "model/regions/regions.h"
#include "state_mass.h"

enum { ITERATES = 12 };                     /* from far away some halve their error before they double their digits */

/* ---- what is not linear ---- */

void refuse_jumps_of_solved(const struct building *b, const struct form *form)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	for (const struct form_term **term = terms_within(form, seen); *term; term++) {
		const struct atom *a = (*term)->basis.atom;
		if (!a || !a->highest || !(a->kind == ATOM_COMPARE || (a->kind == ATOM_CALL && a->function == FN_SGN)))
			continue;
		if (b->model->spec->joined.columns > 0) /* a kink's own derivative jumps */
			error(a->node->start, "differences of runs have them",
			      "derivatives through a kink in what equations are solved for, by '%s', are not built",
			      text_between(a->node->start, a->node->end));
		error(a->node->start, "abs, min, max, clip, deadzone and table have none",
		      "'%s' jumps with what equations are solved for: they may have no solution then, or two",
		      text_between(a->node->start, a->node->end));
	}
}

static bool holds_highest(const struct building *b, const struct form *form)
{
	bool holds = false;
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		holds = holds || (basis->atom && basis->atom->highest) || is_highest(&b->model->frame, basis);
	}
	return holds;
}

/* Products and choices have them for operands; a condition on one, or a function of one, is not linear. */
static bool is_linear_in_highest(const struct building *b, const struct form *form)
{
	bool linear = true;
	for (int i = 0; i < form->terms && linear; i++) {
		const struct atom *a = form->term[i].basis.atom;
		int held = 0;
		for (int k = 0; a && a->highest && !is_friction(a) && k < a->operands && linear; k++) {
			bool holds = holds_highest(b, a->operand[k]), chooses = a->kind == ATOM_CHOOSE;
			held += holds * (a->kind == ATOM_PRODUCT ? (int)a->exponent[k] : 1);
			linear = !(holds && ((a->kind != ATOM_PRODUCT && !chooses) || (chooses && k == 0) ||
					     (!chooses && held > 1))) &&
				 is_linear_in_highest(b, a->operand[k]);
		}
	}
	return linear;
}

static struct form *linear_terms(const struct building *b, const struct form *form)
{
	struct form *linear = NEW(struct form);
	for (int i = 0; i < form->terms; i++)
		if (is_linear_in_highest(b, form_unit(form->term[i].basis)))
			form_add_basis(linear, form->term[i].basis, form->term[i].factor);
	return linear;
}

/* Of N by all unknowns */
static void derive_nonlinear(struct building *b, int n, const struct basis *unknown, struct nonlinear_terms *terms)
{
	terms->slope = ARRAY(const struct form *, n * n);
	for (int j = 0; j < n; j++) {
		struct form **slope = form_derivatives(&b->collector, n, terms->N, false, unknown[j].index,
						       unknown[j].order);
		for (int i = 0; i < n; i++)
			terms->slope[i * n + j] = slope[i];
	}
}

/* ---- the start ---- */

/* A column that the linear terms leave undetermined, whatever their factors are that move; -1: none */
static int undetermined_column(struct collector *c, int n, const struct form *const *J,
			       const struct nonlinear_terms *terms)
{
	enum { SPREAD = 7919 };
	RATIONALS *value = rationals((size_t)(n * n)), *inverse = rationals((size_t)(n * n));
	int column;
	for (int i = 0; i < n * n; i++) {
		const struct form *factor = form_difference(J[i], terms->slope[i]);
		if (is_constant(factor))
			constant_value(c, factor, value[i]);
		else
			mpq_set_si(value[i], (i + 2) * (i + 3) * (i + 5) % SPREAD + 1, 1);
		round_long(value[i]);
	}
	return rational_inverse(n, value, inverse, &column) ? -1 : column;
}

/* N(0) + N_u(0) u become linear terms. */
static void linearise_at_rest(struct collector *c, const struct node *node, int n, const struct basis *unknown,
			      const struct form **F, struct nonlinear_terms *terms)
{
	struct fixing *zero = ARRAY(struct fixing, n);
	for (int j = 0; j < n; j++) {
		zero[j] = (struct fixing){ .symbol = c->frame->coord[unknown[j].index], .coord = unknown[j].index,
					   .order = unknown[j].order };
		mpq_init(zero[j].value);
	}
	struct point *rest = point_new(c, n, zero);
	for (int i = 0; i < n; i++) {
		const struct form *linear = form_at(rest, terms->N[i]);
		for (int j = 0; j < n; j++) {
			const struct form *slope = form_at(rest, terms->slope[i * n + j]);
			terms->slope[i * n + j] = form_difference(terms->slope[i * n + j], slope);
			linear = form_sum(linear, kept_product(c, node, slope, form_unit(unknown[j])), false);
		}
		F[i] = form_sum(F[i], linear, false);
		terms->N[i] = form_difference(terms->N[i], linear);
	}
}

static _Noreturn void report_no_start(const struct building *b, const struct node *node, const struct basis *unknown)
{
	const bool multiplier = unknown->index >= b->model->n;
	error(node->start, "an equation that is solved for it, or has a linear term of it, has a start",
	      "Newton's method has no start for %s%s: where it is 0 the equations do not change with it",
	      b->model->names.coord[unknown->index], multiplier ? "" : unknown->order == 2 ? "''" : "'");
}

struct nonlinear_terms *take_nonlinear_terms(struct building *b, const struct node *node, int n,
					     const struct basis *unknown, const struct form *const *J,
					     const struct form **F)
{
	struct collector *c = &b->collector;
	struct nonlinear_terms *terms = NEW(struct nonlinear_terms);
	bool any = false;
	terms->N = ARRAY(const struct form *, n);
	for (int i = 0; i < n; i++) {
		const struct form *all = F[i];
		F[i] = linear_terms(b, all);
		terms->N[i] = form_difference(all, F[i]);
		any = any || terms->N[i]->terms;
	}
	if (!any)
		return NULL;
	derive_nonlinear(b, n, unknown, terms);
	if (undetermined_column(c, n, J, terms) >= 0)
		linearise_at_rest(c, node, n, unknown, F, terms);
	const int column = undetermined_column(c, n, J, terms);
	if (column >= 0)
		report_no_start(b, node, &unknown[column]);
	return terms;
}

/* ---- iterates ---- */

struct newton {                     /* M u + N(u) = f */
	struct collector *c;
	const struct linear_system *linear; /* M u = f */
	const struct nonlinear_terms *terms;
	const struct node *node;
	const struct form **inverse; /* [column][row]: of M, those that N needs */
	const struct form *(*u)[ITERATES]; /* [column] */
};

static bool reads_unknown(const struct building *b, const struct form *form, const struct basis *x)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	bool reads = false;
	for (const struct form_term **term = terms_within(form, seen); *term; term++)
		reads = reads || ((*term)->basis.kind == BASIS_COORD && (*term)->basis.index == x->index &&
				  (*term)->basis.order == x->order);
	return reads;
}

static void list_nonlinear(const struct building *b, const struct basis *unknown, struct nonlinear_terms *terms,
			   int n)
{
	for (int i = 0; i < n; i++) {
		bool any = false;
		if (terms->N[i]->terms)
			*MORE(terms->row, terms->rows) = i;
		for (int k = 0; k < n; k++)
			any = any || reads_unknown(b, terms->N[k], &unknown[i]);
		if (any)
			*MORE(terms->column, terms->columns) = i;
	}
}

static struct point *point_of_iterate(const struct newton *g, int iterate)
{
	const struct nonlinear_terms *terms = g->terms;
	struct fixing *fixing = ARRAY(struct fixing, terms->columns);
	for (int j = 0; j < terms->columns; j++) {
		const struct basis *x = &g->linear->written->highest[terms->column[j]];
		fixing[j] = (struct fixing){ .symbol = g->c->frame->coord[x->index], .coord = x->index,
					     .order = x->order, .by = g->u[j][iterate] };
	}
	return point_new(g->c, terms->columns, fixing);
}

/* 0; no number where the last step still moved an unknown by more than 2^-25 of its size */
static struct form *zero_where_converged(const struct newton *g, bool single)
{
	struct collector *c = g->c;
	struct form *sum = NEW(struct form);
	RATIONAL near = RATIO(1, 1), tiny = RATIO(1, 1);
	mpq_div_2exp(near, near, single ? 20 : 50);
	mpq_div_2exp(tiny, tiny, 100);
	for (int j = 0; j < g->terms->columns; j++) {
		const struct form *const *u = g->u[j];
		struct form *square = NEW(struct form), *last = form_difference(u[ITERATES - 1], u[ITERATES - 2]);
		for (int t = 0; t < ITERATES; t++)
			form_add_to(square, kept_product(c, g->node, u[t], u[t]), near);
		square = form_difference(square, kept_product(c, g->node, last, last));
		form_add_to(sum, kept_call(c, g->node, FN_SQRT, 1, &square), tiny);
	}
	return sum;
}

/* u = M^-1 (f - N(u)) for the unknowns of N alone: (1 + M^-1 N_u) u' = M^-1 (f - N + N_u u) */
static void add_iterate(const struct newton *g, int iterate)
{
	const struct nonlinear_terms *terms = g->terms;
	const int n = g->linear->n, columns = terms->columns;
	struct collector *c = g->c;
	struct point *there = point_of_iterate(g, iterate);
	const struct form **M = ARRAY(const struct form *, columns * columns),
			  **f = ARRAY(const struct form *, columns);
	for (int i = 0; i < columns; i++) {
		f[i] = g->u[i][0];
		for (int j = 0; j < columns; j++)
			M[i * columns + j] = form_number(i == j);
		for (int k = 0; k < terms->rows; k++) {
			const struct form *inverse = g->inverse[i * terms->rows + k];
			const struct form *rest = form_at(there, terms->N[terms->row[k]]);
			for (int j = 0; j < columns; j++) {
				const struct form *slope =
					form_at(there, terms->slope[terms->row[k] * n + terms->column[j]]);
				rest = form_difference(rest, kept_product(c, g->node, slope, g->u[j][iterate]));
				M[i * columns + j] = form_sum(M[i * columns + j],
							      kept_product(c, g->node, inverse, slope), false);
			}
			f[i] = form_difference(f[i], kept_product(c, g->node, inverse, rest));
		}
	}
	const struct linear_system e = { columns, M, f, NULL };
	for (int i = 0; i < columns; i++)
		g->u[i][iterate + 1] = kept_solution(c, g->node, &e, i);
}

static void start_iterates(struct newton *g)
{
	const struct nonlinear_terms *terms = g->terms;
	struct linear_system unit = *g->linear;
	struct collector *c = g->c;
	unit.written = NULL;
	g->u = (const struct form *(*)[ITERATES])ARRAY(const struct form *, ITERATES * terms->columns);
	g->inverse = ARRAY(const struct form *, terms->columns * terms->rows);
	for (int i = 0; i < terms->columns; i++)
		g->u[i][0] = kept_solution(c, g->node, &unit, terms->column[i]);
	for (int k = 0; k < terms->rows; k++) {
		const struct form **f = ARRAY(const struct form *, unit.n);
		for (int i = 0; i < unit.n; i++)
			f[i] = form_number(i == terms->row[k]);
		unit.f = f;
		for (int i = 0; i < terms->columns; i++)
			g->inverse[i * terms->rows + k] = kept_solution(c, g->node, &unit, terms->column[i]);
	}
}

/* (M + N_u) u' = f - N + N_u u, of all unknowns, at the last iterate; `slope` of all terms */
static struct linear_system last_step(const struct newton *g, bool single, struct written_system *written)
{
	const struct nonlinear_terms *terms = g->terms;
	const int n = g->linear->n;
	const struct form **M = ARRAY(const struct form *, n * n), **f = ARRAY(const struct form *, n);
	struct point *there = point_of_iterate(g, ITERATES - 1);
	for (int i = 0; i < n; i++)
		f[i] = form_difference(g->linear->f[i], form_at(there, terms->N[i]));
	for (int i = 0; i < n * n; i++)
		M[i] = form_sum(g->linear->M[i], form_at(there, terms->slope[i]), false);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < terms->columns; j++) {
			const struct form *by = form_at(there, terms->slope[i * n + terms->column[j]]);
			f[i] = form_sum(f[i], kept_product(g->c, g->node, by, g->u[j][ITERATES - 1]), false);
		}
	f[0] = form_sum(f[0], zero_where_converged(g, single), false);
	return (struct linear_system){ n, M, f, written };
}

/* ---- kinks ---- */

/* Of an atom that reads unknowns: what chooses its formulas by its sign, into *all; returns how many there are then */
static int add_kinks(const struct atom *a, const struct form ***all, int count)
{
	const struct form *const *x = a->operand;
	const bool calls = a->kind == ATOM_CALL, selects = calls && (a->function == FN_MIN || a->function == FN_MAX);
	const bool clips = calls && (a->function == FN_CLIP || a->function == FN_DEADZONE);
	struct straight *piece;
	const int pieces = calls && a->function == FN_TABLE ? pieces_of_atom(a, &piece) : 0;
	for (int i = 0; i + 1 < pieces; i++)
		*MORE(*all, count) = form_difference(x[0], form_constant(piece[i].end));
	for (int i = 1; i < (clips ? 3 : 0); i++)
		*MORE(*all, count) = form_difference(x[0], x[i]);
	for (int i = 0; i < (selects ? a->operands : 0); i++)
		for (int j = 0; j < i; j++)
			*MORE(*all, count) = form_difference(x[j], x[i]);
	if (calls && a->function == FN_ABS)
		*MORE(*all, count) = x[0];
	return count;
}

static int find_kinks(const struct building *b, const struct nonlinear_terms *terms, const struct form ***all)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	int count = 0;
	for (int k = 0; k < terms->rows; k++)
		for (const struct form_term **term = terms_within(terms->N[terms->row[k]], seen); *term; term++)
			if ((*term)->basis.atom && (*term)->basis.atom->highest)
				count = add_kinks((*term)->basis.atom, all, count);
	return count;
}

/* Behind those that are written, and of earlier iterates */
static void add_kinks_at(const struct newton *g, int iterate, int kinks, struct kink *all)
{
	struct point *there = point_of_iterate(g, iterate);
	for (int i = 0; i < kinks; i++)
		all[(iterate + 1) * kinks + i].of = form_at(there, all[i].of);
}

struct linear_system newton_system(struct building *b, const struct node *node, const struct linear_system *linear,
				   struct nonlinear_terms *terms)
{
	struct collector *c = &b->collector;
	struct newton g = { .c = c, .linear = linear, .terms = terms, .node = node };
	const int n = linear->n;
	struct written_system *written = NEW(struct written_system);
	const struct form **slope = ARRAY(const struct form *, n * n);
	list_nonlinear(b, linear->written->highest, terms, n);
	start_iterates(&g);
	for (int t = 0; t < ITERATES - 1; t++)
		add_iterate(&g, t);
	for (int i = 0; i < n * n; i++)
		slope[i] = form_sum(linear->M[i], terms->slope[i], false);
	*written = *linear->written;
	written->slope = slope;
	written->whole_time = c->whole_time;
	written->found = ARRAY(const struct form *, n);
	const struct form **kink = NULL;
	const int kinks = find_kinks(b, terms, &kink);
	struct kink *all = ARRAY(struct kink, (size_t)(kinks * (ITERATES + 1)) + 1);
	for (int i = 0; i < kinks; i++)
		all[i].of = kink[i];
	for (int t = 0; t < ITERATES && kinks > 0; t++)
		add_kinks_at(&g, t, kinks, all);
	const struct linear_system e = last_step(&g, b->request->single, written);
	for (int j = 0; j < terms->columns; j++)
		g.u[j][ITERATES - 1] = kept_solution(c, node, &e, terms->column[j]);
	struct point *there = point_of_iterate(&g, ITERATES - 1);
	for (int i = 0; i < n; i++)
		written->found[i] = form_at(there, terms->N[i]);
	written->kinks = kinks * (ITERATES + 1);
	written->kink = all;
	for (int i = 0; i < written->kinks; i++)
		all[i].solved = form_at(there, kink[i % kinks]);
	return e;
}

/* ---- that kinks leave one solution ---- */

/* M + N_u on either side of where g is 0: determinants whose signs are not alike say that u moves with f on one side,
 * and against it on the other one. */
struct turning {
	struct building *b;
	struct point *start;
	const struct written_system *written;
	const struct form *g;
	const struct basis *moved;  /* the first of what is in g */
	bool turns;
};

/* Unknowns where g, not linear in them: NULL, is so much at the start, small beside the rest of them, which are small
 * themselves, with signs that each draw changes: so other kinks are on either side. */
static struct point *point_near_kink(struct turning *w, const struct form *g, int draw, int side)
{
	const int n = w->written->rows;
	struct fixing *fixing = ARRAY(struct fixing, n);
	RATIONAL rest = ZERO, square = ZERO, part = ZERO;
	const struct form plain = constant_terms(g);
	int terms = plain.terms;
	constant_value(&w->b->collector, &plain, rest);
	mpq_set_si(part, side, 1);
	mpq_div_2exp(part, part, 60);
	mpq_sub(rest, rest, part);
	w->moved = NULL;
	for (int j = 0; j < n; j++) {
		const struct basis *x = &w->written->highest[j];
		const struct form_term *term = form_find(g, x);
		fixing[j] = (struct fixing){ .symbol = w->b->collector.frame->coord[x->index], .coord = x->index,
					     .order = x->order };
		mpq_init(fixing[j].value);
		mpq_set_si(fixing[j].value, (draw >> j % 4) % 2 ? j + 2 : -j - 2, 1u << 24);
		mpq_canonicalize(fixing[j].value);
		if (!term)
			continue;
		mpq_mul(part, term->factor, term->factor);
		mpq_add(square, square, part);
		mpq_mul(part, term->factor, fixing[j].value);
		mpq_add(rest, rest, part);
		w->moved = w->moved ? w->moved : x;
		terms++;
	}
	if (!w->moved || terms < g->terms)
		return NULL;
	mpq_div(rest, rest, square);
	for (int j = 0; j < n; j++) {
		const struct form_term *term = form_find(g, &w->written->highest[j]);
		if (!term)
			continue;
		mpq_mul(part, term->factor, rest);
		mpq_sub(fixing[j].value, fixing[j].value, part);
	}
	return point_new(&w->b->collector, n, fixing);
}

/* Of the determinant there; -2: it is no number, as inputs are in it */
static int sign_of_slope(const struct turning *w, const struct form *const *slope, struct point *there)
{
	const int n = w->written->rows;
	RATIONALS *value = rationals((size_t)n);
	INTEGERS *W = integers((size_t)n * (size_t)n);
	INTEGER det = INTEGER_ZERO, scale = INTEGER_ZERO;
	int column;
	for (int i = 0; i < n; i++) {
		mpz_set_ui(scale, 1);
		for (int j = 0; j < n; j++) {
			const struct form *entry = form_at(there, slope[i * n + j]);
			if (!is_constant(entry))
				return -2;
			constant_value(&w->b->collector, entry, value[j]);
			round_long(value[j]);
			mpz_lcm(scale, scale, mpq_denref(value[j]));
		}
		for (int j = 0; j < n; j++) {
			mpz_divexact(W[i * n + j], scale, mpq_denref(value[j]));
			mpz_mul(W[i * n + j], W[i * n + j], mpq_numref(value[j]));
		}
	}
	return bareiss(n, n, W, det, &column) ? mpz_sgn(det) : 0;
}

static void compare_sides(void *context)
{
	enum { DRAWS = 16 };
	struct turning *w = context;
	const int n = w->written->rows;
	const struct form *g = form_at(w->start, w->g), **slope = ARRAY(const struct form *, n * n);
	for (int i = 0; i < n * n; i++)
		slope[i] = form_at(w->start, w->written->slope[i]);
	for (int draw = 0; draw < (n > 1 ? DRAWS : 1) && !w->turns; draw++) {
		struct point *below = point_near_kink(w, g, draw, -1), *above = point_near_kink(w, g, draw, 1);
		if (!below || !above)
			return;
		const int a = sign_of_slope(w, slope, below), b = sign_of_slope(w, slope, above);
		w->turns = a != b && a >= -1 && b >= -1;
	}
}

static void look_at_surface(void *context, const struct form *g)
{
	struct turning *w = context;
	w->g = g;
	if (!w->turns)
		w->turns = silent_guard(compare_sides, w) && w->turns;
}

static void look_at_decision(void *context, const struct form *d)
{
	visit_surfaces(d, look_at_surface, context);
}

static void report_turn(const struct turning *w, const struct node *node)
{
	const char *name = w->b->model->names.coord[w->moved->index];
	const bool multiplier = w->moved->index >= w->b->model->n;
	error(node->start, "less of it, or the formula of one side alone, leaves one solution",
	      "'%s' turns the slope of the equation for %s%s: it may have no solution then, or two",
	      text_between(node->start, node->end), name, multiplier ? "" : w->moved->order == 2 ? "''" : "'");
}

void check_kinks_at_start(struct building *b, struct point *start, const struct written_system *written)
{
	struct turning w = { .b = b, .start = start, .written = written };
	bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	const bool equation = b->collector.equation;
	for (int i = 0; i < written->rows; i++)
		for (const struct form_term **term = terms_within(written->residual[i], seen); *term; term++) {
			const struct atom *a = (*term)->basis.atom;
			if (!a || !a->highest || a->kind != ATOM_CALL)
				continue;
			b->collector.equation = true;
			visit_decisions(a, look_at_decision, &w);
			b->collector.equation = equation;
			if (w.turns)
				report_turn(&w, a->node);
		}
}
