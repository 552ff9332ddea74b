/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Initial values that meet constraints. */
#include "building.h"
#include "checks.h"
#include "state_mass.h"

#include <math.h>

/* ---- the nearest state that meets them ----
 *
 * Newton's method, least moves: of what init does not name where that will do, else of all, where what it names moves a
 * million times less. Residuals are exact, or of 256 bits; the matrix is of doubles, so each turn adds ten digits. */

enum { LEVELS = 2 };                /* positions, velocities */
enum { TURNS = 60, POINTS = 3 };
static const double DEPENDENT = 1e-11, NAMED = 1e-6;

struct start {
	struct building *b;
	int n, rows;                /* coordinates, constraints: the model's own, or */
	int all;                    /* those of derivatives, too */
	double *loose;              /* per derivative: how much of it moves that init names */
	mpq_t *value;               /* per state */
	bool *named;                /* per state: init says it, of what a derivative is of */
	mpq_srcptr t;               /* NULL: loads are left out */
	struct form **slope[LEVELS]; /* [coordinate * all + constraint]: of by[level], by q or by q' */
	double *g, *G;              /* there: [constraint], [constraint * n + coordinate] */
	double *S;                  /* G W G^T, its rows and columns scaled, then its factors */
	double *scale;              /* per constraint: 1 over the size of its gradient; 0: that is 0 */
	int *order, rank;           /* constraints by which others follow come first */
};

static const struct form *held_form(const struct start *w, int row, int level)
{
	const struct form *held = equations_of(w->b)->constraint[row].by[level];
	return !held ? form_number(0) : w->t ? held : terms_of_kinds(held, ~(1u << BASIS_FORCING));
}

static int state_at(const struct start *w, int coord, int level)
{
	return level ? w->b->model->system.velocity[coord] : coord;
}

/* What a derivative's constraint moves are derivatives alone: the state is where it is without them. A coordinate of
 * first order has no velocity to move. */
static bool moves(const struct start *w, int coord, int level, int row)
{
	return coord >= equations_of(w->b)->constraint[row].statement->own && state_at(w, coord, level) >= 0;
}

static void find_slopes(struct start *w, int level)
{
	const struct form **held = ARRAY(const struct form *, w->all);
	for (int i = 0; i < w->all; i++)
		held[i] = held_form(w, i, level);
	w->slope[level] = ARRAY(struct form *, w->n * w->all);
	for (int j = 0; j < w->n; j++) {
		struct form **slope = form_derivatives(&w->b->collector, w->all, held, false, j, level);
		for (int i = 0; i < w->all; i++)
			w->slope[level][j * w->all + i] = moves(w, j, level, i) ? slope[i] : form_number(0);
	}
}

static double value_at(const struct start *w, struct point *point, const struct form *form)
{
	RATIONAL value = ZERO;
	const struct form *here = form_at(point, form);
	if (is_constant(here))
		constant_value(&w->b->collector, here, value);
	return mpq_get_d(value);
}

static void evaluate(struct start *w, int level)
{
	struct point *point = point_at_state(w->b, w->value, w->t);
	for (int i = 0; i < w->rows; i++) {
		w->g[i] = value_at(w, point, held_form(w, i, level));
		for (int k = 0; k < w->n; k++)
			w->G[i * w->n + k] = value_at(w, point, w->slope[level][k * w->all + i]);
	}
}

/* Of which derivative a coordinate is; -1: of the model itself */
static int column_of(const struct start *w, int coord)
{
	const struct spec *spec = w->b->spec;
	return coord < spec->joined.own || !spec->joined.columns ? -1
								  : (coord - spec->joined.own) / spec->joined.stride;
}

static double weight_of(const struct start *w, int coord, int level, double named)
{
	const int state = state_at(w, coord, level), column = column_of(w, coord);
	named = column < 0 ? named : w->loose[column];
	return state < 0 ? 0 : w->named[state] ? named : 1;
}

/* L L^T of G W G^T, the largest pivot next, up to those that are none */
static void factor(struct start *w, int level, double named)
{
	const int m = w->rows;
	for (int i = 0; i < m * m; i++) {
		w->S[i] = 0;
		for (int k = 0; k < w->n; k++)
			w->S[i] += w->G[i / m * w->n + k] * w->G[i % m * w->n + k] * weight_of(w, k, level, named);
	}
	for (int i = 0; i < m; i++) {
		w->scale[i] = w->S[i * m + i] > 0 ? 1 / sqrt(w->S[i * m + i]) : 0;
		w->order[i] = i;
	}
	for (int i = 0; i < m * m; i++)
		w->S[i] *= w->scale[i / m] * w->scale[i % m];
	for (w->rank = 0; w->rank < m; w->rank++) {
		int best = w->rank;
		for (int i = w->rank + 1; i < m; i++) /* one that says something before one of the other level */
			if (w->S[w->order[i] * m + w->order[i]] >
				    w->S[w->order[best] * m + w->order[best]] + 1e-9 ||
			    (w->scale[w->order[best]] == 0 && w->scale[w->order[i]] > 0))
				best = i;
		const int p = w->order[best];
		w->order[best] = w->order[w->rank];
		w->order[w->rank] = p;
		if (!(w->S[p * m + p] > DEPENDENT))
			return;
		w->S[p * m + p] = sqrt(w->S[p * m + p]);
		for (int i = w->rank + 1; i < m; i++)
			w->S[w->order[i] * m + p] /= w->S[p * m + p];
		for (int i = w->rank + 1; i < m; i++)
			for (int k = w->rank + 1; k < m; k++)
				w->S[w->order[i] * m + w->order[k]] -= w->S[w->order[i] * m + p] *
								       w->S[w->order[k] * m + p];
	}
}

/* x of L^T x = right */
static void substitute_back(const struct start *w, double *x)
{
	const int m = w->rows;
	for (int i = w->rank - 1; i >= 0; i--) {
		for (int k = i + 1; k < w->rank; k++)
			x[i] -= w->S[w->order[k] * m + w->order[i]] * x[k];
		x[i] /= w->S[w->order[i] * m + w->order[i]];
	}
}

/* x of S x = right over the first `rank` constraints, in their order, scaled */
static void solve_first(const struct start *w, double *x)
{
	const int m = w->rows;
	for (int i = 0; i < w->rank; i++) {
		for (int k = 0; k < i; k++)
			x[i] -= w->S[w->order[i] * m + w->order[k]] * x[k];
		x[i] /= w->S[w->order[i] * m + w->order[i]];
	}
	substitute_back(w, x);
}

/* Returns the largest move, relative to the larger of the state and 1 */
static double move(struct start *w, int level, double named)
{
	SCRATCH double *x = ARRAY(double, w->rows);
	RATIONAL change = ZERO;
	double most = 0;
	for (int i = 0; i < w->rank; i++)
		x[i] = w->g[w->order[i]] * w->scale[w->order[i]];
	solve_first(w, x);
	for (int k = 0; k < w->n; k++) {
		double by = 0;
		if (state_at(w, k, level) < 0)
			continue;
		mpq_ptr value = w->value[state_at(w, k, level)];
		for (int i = 0; i < w->rank; i++)
			by += w->G[w->order[i] * w->n + k] * w->scale[w->order[i]] * x[i];
		by *= weight_of(w, k, level, named);
		if (!isfinite(by) || fabs(by) > 1e100)
			return INFINITY;
		most = fmax(most, fabs(by) / fmax(1, fabs(mpq_get_d(value))));
		mpq_set_d(change, by);
		mpq_sub(value, value, change);
	}
	return most;
}

/* What the worst constraint of `count` misses, relative to the size of its gradient */
static double miss_of(const struct start *w, int first, int count, int *worst)
{
	double most = 0;
	for (int i = first; i < first + count; i++) {
		double size = 1e-300;
		for (int k = 0; k < w->n; k++)
			size = fmax(size, fabs(w->G[i * w->n + k]));
		if (w->g[i] != 0 && fabs(w->g[i]) / size > most) {
			most = fabs(w->g[i]) / size;
			*worst = i;
		}
	}
	return most;
}

static double largest_miss(const struct start *w, int *worst)
{
	return miss_of(w, 0, w->rows, worst);
}

/* Whether constraints by which others follow are met in the end */
static bool approach(struct start *w, int level, double named)
{
	for (int turn = 0; turn < TURNS; turn++) {
		evaluate(w, level);
		factor(w, level, named);
		const double moved = move(w, level, named);
		if (moved == INFINITY)
			return false;
		if (moved < 1e-40) {
			evaluate(w, level);
			return true;
		}
	}
	return false;
}

static void set_values(struct start *w, mpq_t *from)
{
	for (int i = 0; i < w->b->model->system.states; i++)
		mpq_set(w->value[i], from[i]);
}

/* Off a point where what could move does not act: x at 0 of x^2 + y^2 = 1 */
static void shift(struct start *w, int level, int point, double named)
{
	RATIONAL change = ZERO;
	for (int k = 0; k < w->n; k++) {
		if (state_at(w, k, level) < 0)
			continue;
		mpq_set_d(change, sin(1.7 * k + 2.3 * point + 1) * 0.125 * (weight_of(w, k, level, named) > 0));
		mpq_add(w->value[state_at(w, k, level)], w->value[state_at(w, k, level)], change);
	}
}

static bool meets(struct start *w, int level, double named)
{
	int worst = 0;
	return approach(w, level, named) && largest_miss(w, &worst) < 1e-30;
}

/* Derivatives of what moved: as it did, or where those of what init names miss constraints, of that too */
static bool derivatives_meet(struct start *w, int level, double named)
{
	const int columns = w->b->spec->joined.columns, own = w->rows;
	mpq_t *given = rationals_copied((size_t)w->b->model->system.states, (const mpq_t *)w->value);
	int worst = 0;
	bool met = true;
	for (int p = 0; p < columns; p++)
		w->loose[p] = named;
	w->rows = w->all;
	for (int turn = 0; turn < 2 && columns; turn++) {
		set_values(w, given);
		met = approach(w, level, named);
		for (int p = 0; p < columns && turn == 0; p++)
			if (miss_of(w, (p + 1) * own, own, &worst) > 1e-30)
				w->loose[p] = NAMED;
	}
	met = met && largest_miss(w, &worst) < 1e-30;
	w->rows = own;
	return met;
}

/* From the values given, else from points near them: first what init does not name, then all moves. */
static bool is_met(struct start *w, int level, mpq_t *given)
{
	for (int all = 0; all < 2; all++)
		for (int point = -1; point < POINTS; point++) {
			set_values(w, given);
			if (point >= 0)
				shift(w, level, point, all * NAMED);
			if (meets(w, level, all * NAMED))
				return derivatives_meet(w, level, all * NAMED);
		}
	return false;
}

/* ---- constraints that say the same ---- */

static const struct energy *statement_of(const struct start *w, int row)
{
	return equations_of(w->b)->constraint[row].statement;
}

static const char *name_of(const struct start *w, int row)
{
	return statement_of(w, row)->multiplier->name;
}

/* Of which others the gradient of the first one that follows is made: 1 c1 + 2 c2; NULL: it is 0 */
static const char *combination(const struct start *w, const char **names)
{
	const int last = w->order[w->rank];
	SCRATCH double *x = ARRAY(double, w->rows);
	const char *text = NULL;
	for (int i = 0; i < w->rank; i++)
		x[i] = w->S[last * w->rows + w->order[i]];
	substitute_back(w, x);
	for (int i = w->rank - 1; i >= 0; i--) {
		const double factor = x[i] * w->scale[w->order[i]] / w->scale[last];
		if (fabs(x[i]) < 1e-9)
			continue;
		const char *name = name_of(w, w->order[i]);
		text = text ? format("%.6g %s + %s", factor, name, text) : format("%.6g %s", factor, name);
		*names = *names ? format("%s and %s", name, *names) : name;
	}
	return text;
}

/* The first that follows from others, at the last point; where they cannot hold together their miss there */
static _Noreturn void report_dependent(const struct start *w, double miss)
{
	const int last = w->order[w->rank];
	const char *names = NULL, *made = w->scale[last] > 0 ? combination(w, &names) : NULL;
	const struct place at = statement_of(w, last)->at;
	if (!made)
		error(at, NULL, "nothing moves what constraint '%s' holds: its gradient is 0", name_of(w, last));
	if (miss > 0)
		error(at, NULL, "constraints %s and %s cannot hold together: at the nearest point they miss by %.3g",
		      names, name_of(w, last), miss);
	error(at, "leave it out", "constraint '%s' follows from %s (its gradient is %s): its force is not determined",
	      name_of(w, last), names, made);
}

static _Noreturn void report_unmet(struct start *w, int level, mpq_t *given)
{
	int worst = 0;
	set_values(w, given);
	const bool near = approach(w, level, NAMED);
	const double miss = near ? largest_miss(w, &worst) : 0;
	if (near && w->rank < w->rows && w->scale[w->order[w->rank]] > 0 && miss > 1e-9)
		report_dependent(w, miss);
	error(statement_of(w, worst)->at, "init gives a state near one that meets them",
	      "no state was found that meets the constraints: '%s' is the last that is missed", name_of(w, worst));
}

/* Whether those gradients depend on each other at other states, too */
static bool depends_elsewhere(struct start *w)
{
	mpq_t *here = rationals_copied((size_t)w->b->model->system.states, (const mpq_t *)w->value);
	bool depends = true;
	for (int point = 0; point < POINTS && depends; point++) {
		set_values(w, here);
		shift(w, 0, point, 1);
		approach(w, 0, 1);
		evaluate(w, 1);
		factor(w, 1, 1);
		depends = w->rank < w->rows;
	}
	set_values(w, here);
	evaluate(w, 1);
	factor(w, 1, 1);
	return depends;
}

static void check_independent(struct start *w)
{
	evaluate(w, 1);
	factor(w, 1, 1);
	if (w->rank == w->rows)
		return;
	if (depends_elsewhere(w))
		report_dependent(w, 0);
	const int last = w->order[w->rank];
	const char *names = NULL;
	combination(w, &names);
	error(statement_of(w, last)->at, "another start",
	      names ? "constraints %s and %s are singular at the start: their gradients depend on each other there"
		    : "constraint %s%s is singular at the start: its gradient is 0 there",
	      names ? names : "", name_of(w, last));
}

/* ---- what was moved ---- */

static bool is_moved(mpq_srcptr from, mpq_srcptr to, double least)
{
	RATIONAL change = ZERO;
	mpq_sub(change, to, from);
	return fabs(mpq_get_d(change)) > least * fmax(1, fabs(mpq_get_d(from)));
}

/* As a note of what follows, as a warning of what init names */
static void report_moves(const struct start *w, const mpq_t *given, int missed, double miss)
{
	enum { MOST = 6 };
	const struct model *model = w->b->model;
	const struct request *request = w->b->request;
	const char *text = "";
	int count = 0;
	bool named = false;
	for (int i = 0; i < model->system.states; i++) {
		if (!is_moved(given[i], w->value[i], 1e-9))
			continue;
		named = named || w->named[i];
		if (count++ < MOST)
			text = format("%s%s%s moved from %.6g to %.6g", text, *text ? ", " : "", model->names.state[i],
				      mpq_get_d(given[i]), mpq_get_d(w->value[i]));
	}
	text = count > MOST ? format("%s, and %d more", text, count - MOST) : text;
	const bool heard = warnings_are_heard() && !request->linear.where && !request->solution &&
			   !request->again.relative && !request->again.undivided && !w->b->spec->joined.columns;
	const struct place at = statement_of(w, missed)->at;
	if (!count || !heard)
		return;
	if (named)
		say_warning(at, NULL, "init misses '%s' by %.3g; %s", name_of(w, missed), miss, text);
	else
		say_note(at, "init does not meet '%s': %s", name_of(w, missed), text);
}

static void name_given(struct start *w)
{
	const struct spec *spec = w->b->spec;
	for (int i = 0; i < spec->states.initials; i++) {
		const struct initial *initial = &spec->states.initial[i];
		const struct symbol *coord = initial->coord;
		const int first = coord->index + (initial->component ? initial->component - 1 : 0);
		for (int k = 0; k < (initial->component || !coord->length ? 1 : coord->length); k++)
			w->named[state_at(w, first + k, initial->primes)] = true;
	}
	for (int coord = 0; coord < w->n; coord++) {
		const int column = column_of(w, coord);
		const int of = coord - spec->joined.own - column * spec->joined.stride;
		for (int level = 0; level < LEVELS && column >= 0 && state_at(w, coord, level) >= 0; level++)
			w->named[state_at(w, coord, level)] = of >= spec->joined.own ||
							      w->named[state_at(w, of, level)];
	}
}

static struct start start_from(struct building *b, mpq_t *state, mpq_srcptr t)
{
	const struct model *model = b->model;
	const int n = model->n, m = b->spec->count.multipliers, states = model->system.states;
	const int columns = b->spec->joined.columns;
	struct start w = { .b = b, .n = n, .rows = m / (columns + 1), .all = m,
			   .loose = ARRAY(double, (size_t)columns + 1), .value = rationals(states),
			   .named = ARRAY(bool, states), .t = t,
			   .g = ARRAY(double, m), .G = ARRAY(double, m * n), .S = ARRAY(double, m * m),
			   .scale = ARRAY(double, m), .order = ARRAY(int, m) };
	set_values(&w, state);
	return w;
}

/* Positions, then velocities; returns what the first constraint that is not met misses, *missed */
static double meet_levels(struct start *w, int *missed)
{
	double miss = 0;
	for (int level = 0; level < LEVELS; level++) {
		mpq_t *given = rationals_copied((size_t)w->b->model->system.states, (const mpq_t *)w->value);
		find_slopes(w, level);
		evaluate(w, level);
		miss = miss > 1e-12 ? miss : largest_miss(w, missed);
		if (!is_met(w, level, given))
			report_unmet(w, level, given);
	}
	return miss;
}

static void take_moved(const struct start *w, mpq_t *state)
{
	for (int i = 0; i < w->b->model->system.states; i++)
		if (is_moved(state[i], w->value[i], 1e-18)) /* what is 0 stays that */
			mpq_set(state[i], w->value[i]);
}

void meet_constraints(struct building *b)
{
	mpq_t *initial = b->model->initial;
	RATIONAL zero = ZERO;
	struct start w = start_from(b, initial, zero);
	int missed = 0;
	name_given(&w);
	const double miss = meet_levels(&w, &missed);
	check_independent(&w);
	report_moves(&w, initial, missed, miss);
	take_moved(&w, initial);
}

void meet_constraints_near(struct building *b, mpq_t *state, const bool *named, mpq_srcptr t)
{
	struct start w = start_from(b, state, t);
	int missed = 0;
	for (int i = 0; named && i < b->model->system.states; i++)
		w.named[i] = named[i];
	meet_levels(&w, &missed);
	take_moved(&w, state);
}
