/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Constraints: what brings a state back onto them, and initial values that meet them. */
#include "building.h"
#include "capability.h"
#include "checks.h"
#include "model/contacts/friction.h"
#include "state_mass.h"

#include <math.h>
#include <string.h>

enum { LEVELS = 2 };                /* positions, velocities */

static const struct segment_equations *rows_of(const struct building *b)
{
	return b->full ? b->full : b->segment_equations;
}

/* ---- corrections ---- */

/* The system of a block with the constraints' own values on the right: x of [M G^T; G 0] [x; .] = [0; g] */
static void correct_block(struct building *b, const struct moving_mass *mass, int level)
{
	const struct linear *system = &b->model->system;
	const struct written_system *written = mass->plain.written;
	struct linear_system e = mass->plain;
	const struct form **g = ARRAY(const struct form *, e.n);
	for (int i = 0; i < e.n; i++) {
		const int constraint = written->highest[i].index - b->model->n;
		const struct form *held = constraint < 0 ? NULL : rows_of(b)->constraint[constraint].by[level];
		g[i] = held ? held : NEW(struct form);
	}
	e.f = g;
	e.written = NULL;
	for (int i = 0; i < e.n; i++) {
		const int coord = written->highest[i].index;
		if (coord < b->model->n)
			b->model->equations.correction[level ? system->velocity[coord] : coord] =
				kept_solution(&b->collector, mass->node, &e, i);
	}
}

static void build_corrections(struct building *b)
{
	const struct segment_equations *rows = rows_of(b);
	const int states = b->model->system.states;
	const int keep = (int)b->collector.keep;
	b->collector.keep = KEEP_ALL;
	b->model->equations.correction = ARRAY(const struct form *, states);
	for (int i = 0; i < states; i++)
		b->model->equations.correction[i] = NEW(struct form);
	for (int i = 0; i < rows->masses; i++)
		for (int level = 0; level < LEVELS; level++)
			correct_block(b, &rows->mass[i], level);
	b->collector.keep = (unsigned)keep;
}

/* ---- the energy, where it is conserved: T and V alone act, T is quadratic in velocities, and constraints hold however
 * fast the motion along them is ---- */

static bool reads(const struct building *b, const struct form *form, bool velocities)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	bool any = false;
	for (const struct form_term **term = terms_within(form, seen); *term; term++)
		any = any || (*term)->basis.kind == BASIS_FORCING ||
		      (velocities && (*term)->basis.kind == BASIS_COORD && (*term)->basis.order > 0);
	return any;
}

static bool energies_alone(const struct building *b)
{
	const struct spec *spec = b->spec;
	bool alone = !b->model->relative && spec->equations == 0 && spec->count.inputs == 0 && spec->tuned.count == 0 &&
		     b->model->contacts.impacts == 0 && b->model->system.states == 2 * b->model->n;
	for (int i = 0; i < spec->elements; i++)
		alone = alone && spec->element[i].kind == ELEMENT_ENERGY;
	for (int i = 0; i < spec->lagrange.energies; i++)
		alone = alone && strchr("TVG", spec->lagrange.energy[i].kind) && spec->lagrange.energy[i].own == 0;
	return alone;
}

/* 0 where all velocities are */
static bool vanishes_at_rest(struct point *rest, const struct form *form)
{
	return form_at(rest, form)->terms == 0;
}

static bool is_quadratic(struct building *b, struct point *rest, const struct form *T)
{
	const struct segment_equations *rows = rows_of(b);
	bool quadratic = vanishes_at_rest(rest, T);
	for (int j = 0; j < b->model->n && quadratic; j++)
		quadratic = vanishes_at_rest(rest, form_derivatives(&b->collector, 1, &T, false, j, 1)[0]);
	for (int i = 0; i < rows->masses; i++)
		for (int k = 0; k < rows->mass[i].system.n * rows->mass[i].system.n && quadratic; k++)
			quadratic = !reads(b, rows->mass[i].system.M[k], true);
	return quadratic;
}

void find_conserved(void *building)
{
	struct building *b = building;
	const struct segment_equations *rows = rows_of(b);
	const int n = b->model->n, keep = (int)b->collector.keep;
	const struct form *T = rows->energy[0], *V = rows->energy[1] ? rows->energy[1] : form_number(0);
	struct fixing *fixing = ARRAY(struct fixing, n);
	if (!energies_alone(b) || !T || reads(b, T, false) || reads(b, V, true))
		return;
	for (int j = 0; j < n; j++) {
		fixing[j] = (struct fixing){ .symbol = b->model->frame.coord[j], .coord = j, .order = 1 };
		mpq_init(fixing[j].value);
	}
	b->collector.keep = KEEP_ALL;
	struct point *rest = point_new(&b->collector, n, fixing);
	bool stays = is_quadratic(b, rest, T);
	for (int i = 0; i < b->spec->count.multipliers && stays; i++)
		stays = vanishes_at_rest(rest, rows->constraint[i].by[1]);
	b->collector.keep = (unsigned)keep;
	b->model->equations.conserved[0] = stays ? T : NULL;
	b->model->equations.conserved[1] = stays ? V : NULL;
}

/* ---- the nearest state that meets them ----
 *
 * Newton's method, least moves: of what init does not name where that will do, else of all, where what it names moves a
 * million times less. Residuals are exact, or of 256 bits; the matrix is of doubles, so each turn adds ten digits. */

enum { TURNS = 60, POINTS = 3 };
static const double DEPENDENT = 1e-11, NAMED = 1e-6;

struct start {
	struct building *b;
	int n, rows;                /* coordinates, constraints */
	mpq_t *value;               /* per state */
	bool *named;                /* per state: init says it */
	mpq_srcptr t;               /* NULL: loads are left out */
	struct form **slope[LEVELS]; /* [coordinate * rows + constraint]: of by[level], by q or by q' */
	double *g, *G;              /* there: [constraint], [constraint * n + coordinate] */
	double *S;                  /* G W G^T, its rows and columns scaled, then its factors */
	double *scale;              /* per constraint: 1 over the size of its gradient; 0: that is 0 */
	int *order, rank;           /* constraints by which others follow come first */
};

static const struct form *held_form(const struct start *w, int row, int level)
{
	const struct form *held = rows_of(w->b)->constraint[row].by[level];
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
	return coord >= rows_of(w->b)->constraint[row].statement->own && state_at(w, coord, level) >= 0;
}

static void find_slopes(struct start *w, int level)
{
	const struct form **held = ARRAY(const struct form *, w->rows);
	for (int i = 0; i < w->rows; i++)
		held[i] = held_form(w, i, level);
	w->slope[level] = ARRAY(struct form *, w->n * w->rows);
	for (int j = 0; j < w->n; j++) {
		struct form **slope = form_derivatives(&w->b->collector, w->rows, held, false, j, level);
		for (int i = 0; i < w->rows; i++)
			w->slope[level][j * w->rows + i] = moves(w, j, level, i) ? slope[i] : form_number(0);
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
			w->G[i * w->n + k] = value_at(w, point, w->slope[level][k * w->rows + i]);
	}
}

static double weight_of(const struct start *w, int coord, int level, double named)
{
	const int state = state_at(w, coord, level);
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

/* What the worst constraint misses, relative to the size of its gradient */
static double largest_miss(const struct start *w, int *worst)
{
	double most = 0;
	for (int i = 0; i < w->rows; i++) {
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

/* From the values given, else from points near them: first what init does not name, then all moves. */
static bool is_met(struct start *w, int level, mpq_t *given)
{
	for (int all = 0; all < 2; all++)
		for (int point = -1; point < POINTS; point++) {
			set_values(w, given);
			if (point >= 0)
				shift(w, level, point, all * NAMED);
			if (meets(w, level, all * NAMED))
				return true;
		}
	return false;
}

/* ---- constraints that say the same ---- */

static const struct energy *statement_of(const struct start *w, int row)
{
	return rows_of(w->b)->constraint[row].statement;
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
			   !request->again.relative && !request->again.undivided;
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
}

static struct start start_from(struct building *b, mpq_t *state, mpq_srcptr t)
{
	const struct model *model = b->model;
	const int n = model->n, m = b->spec->count.multipliers, states = model->system.states;
	struct start w = { .b = b, .n = n, .rows = m, .value = rationals(states), .named = ARRAY(bool, states), .t = t,
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

static void meet_constraints(struct building *b)
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

/* The projection knows no samples. */
static void check_inputs(const struct building *b)
{
	const struct segment_equations *rows = rows_of(b);
	for (int i = 0; i < rows->masses; i++) {
		const struct linear_system *e = &rows->mass[i].plain;
		SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
		for (int k = 0; k < e->n * e->n; k++)
			for (const struct form_term **term = terms_within(e->M[k], seen); *term; term++)
				if ((*term)->basis.kind == BASIS_INPUT)
					error(rows->mass[i].node->start, "a load of time may",
					      "an input may not change the mass matrix beside constraints");
	}
}

static void check_friction(const struct building *b)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	for (int i = 0; i < b->spec->count.multipliers; i++) {
		const struct atom *friction = friction_in(rows_of(b)->constraint[i].by[1], seen);
		if (friction)
			error(friction->node->at, NULL, "friction holds by its force: no constraint reads it");
	}
}

static void keep(void *context)
{
	struct building *b = context;
	refuse(CAN_CONSTRAINTS, b->model, rows_of(b)->constraint[0].statement->at);
	check_inputs(b);
	check_friction(b);
	if (!b->request->again.tunable)
		meet_constraints(b);            /* dependent ones are named before they are solved for */
	if (!b->eliminates)
		build_corrections(b);
}

void keep_constraints(struct building *b)
{
	statement_guard(keep, b);
}
