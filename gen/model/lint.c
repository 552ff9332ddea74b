/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is no mistake of language, and yet seldom meant: names that nothing reads, and of linear models poles that grow,
 * a step that shows them as slower ones, resonance, drift, forces that belong to no energy. */
#include "building.h"
#include "checks.h"
#include "reads.h"

#include <complex.h>
#include <float.h>
#include <math.h>
#include <string.h>

/* states of which poles are looked for, coordinates of which the rank of K is: no more than a moment's work */
enum { MOST_POLES = 200, MOST_RANK = 64 };
static const double PI = 3.14159265358979323846;
/* Of the largest pole: what grows by less may be rounding, as a double pole is known to half the digits; of the size of
 * the matrix: a pole that is smaller may be 0, many times. */
static const double GROWS = 1e-6, PERHAPS_ZERO = 1e-4;
/* Near is a hundredth; light is a damping ratio at which there a load acts much more than a twentieth beside it,
 * by STANDS_OUT times at least. */
static const double NEAR = 1e-2, LIGHT = 2e-2, BESIDE = 5e-2, STANDS_OUT = 2;

struct lint {
	struct building *b;
	const struct model *model;
	const struct linear *system;
	int poles;                  /* as many as states; 0: they are not known */
	double *re, *im, size;
	struct place negative;      /* of a network, its first value below 0; source NULL: there is none */
};

/* ---- names that nothing reads ---- */

static const char *reported_as(const struct symbol *s)
{
	return s->kind == SYMBOL_PARAM  ? "param" :
	       s->kind == SYMBOL_MATRIX ? "matrix" : s->connected || s->kind == SYMBOL_INPUT ? "input" : "let";
}

static bool is_unused(const struct symbol *s)
{
	return !s->used && !s->broken && (s->kind == SYMBOL_PARAM || s->kind == SYMBOL_LET ||
					  s->kind == SYMBOL_INPUT || s->kind == SYMBOL_MATRIX);
}

/* The first of them by name; what is written by a program may have thousands. */
static void check_names(const struct spec *spec)
{
	enum { MOST_REPORTED = 20 };
	const struct symbol *next = NULL;
	int unused = 0;
	for (const struct symbol *s = spec->first; s; s = s->next) {
		if (!is_unused(s) || unused++ > MOST_REPORTED)
			continue;
		next = s;
		if (unused > MOST_REPORTED)
			continue;
		const char *point = strrchr(s->name, '.');
		say_warning(s->at, NULL, "%s '%s' is not used", reported_as(s), s->part && point ? point + 1 : s->name);
	}
	if (unused > MOST_REPORTED)
		say_warning(next->at, NULL, "%s '%s' is not used, nor %d more", reported_as(next), next->name,
			    unused - MOST_REPORTED - 1);
}

/* ---- what is negative ---- */

struct constant_work {
	struct building *b;
	struct node *node;
	mpq_ptr value;
};

static void take_constant(void *context)
{
	struct constant_work *work = context;
	collect_constant(&work->b->collector, work->node, work->value);
}

/* false: it is none */
static bool constant_of_node(struct building *b, struct node *node, mpq_ptr value)
{
	bool outer = b->collector.constant_only;
	bool constant = silent_guard(take_constant, &(struct constant_work){ b, node, value });
	b->collector.constant_only = outer;
	return constant;
}

static void check_elements(struct lint *lint)
{
	struct building *b = lint->b;
	static const char *const what[] = { "mass", "stiffness", "damping" };
	RATIONAL value = ZERO;
	for (int i = 0; i < b->spec->elements; i++) {
		const struct element *element = &b->spec->element[i];
		if (element->kind >= ELEMENT_FORCE || !constant_of_node(b, element->value, value) ||
		    mpq_sgn(value) >= 0)
			continue;
		say_warning(element->value->start, NULL, "a negative %s, %s", what[element->kind],
			    readable_text(value));
		lint->negative = lint->negative.source ? lint->negative : element->value->start;
	}
}

/* Walks go through lets, as often as they are read: `left` nodes are looked at, and then no more is found. */
enum { MOST_NODES = 100000 };

/* The first param below 0 that this reads, other than inside of params; or NULL */
static const struct symbol *negative_param(const struct node *node, int *left)
{
	const struct symbol *symbol = node->kind == NODE_NAME ? node->symbol : NULL, *found = NULL;
	if (--*left < 0)
		return NULL;
	if (symbol && symbol->kind == SYMBOL_LET)
		return negative_param(symbol->value, left);
	if (symbol && symbol->kind == SYMBOL_PARAM && symbol->made.progress == COLLECTED &&
	    symbol->made.value->rows == 1 && symbol->made.value->columns == 1) {
		RATIONAL value = ZERO;
		param_value(symbol, value);
		found = mpq_sgn(value) < 0 ? symbol : NULL;
	}
	for (int i = 0; i < node->children && !found; i++)
		found = negative_param(node->child[i], left);
	return found;
}

static bool reads_coordinate(const struct node *node, int *left)
{
	bool reads = false;
	if (--*left < 0)
		return false;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET)
		return reads_coordinate(node->symbol->value, left);
	for (int i = 0; i < node->children && !reads; i++)
		reads = reads_coordinate(node->child[i], left);
	return reads || (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_COORD);
}

/* The first param below 0 that multiplies or divides a coordinate; or NULL */
static const struct symbol *negative_factor(const struct node *node, int *left)
{
	const struct symbol *found = NULL;
	bool product = --*left >= 0 && node->kind == NODE_PRODUCT && reads_coordinate(node, left);
	if (*left < 0)
		return NULL;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET)
		return negative_factor(node->symbol->value, left);
	for (int i = 0; i < node->children && !found; i++)
		found = product && !reads_coordinate(node->child[i], left) ? negative_param(node->child[i], left)
								       : negative_factor(node->child[i], left);
	return found;
}

static const struct equation *equation_at(const struct spec *spec, struct place at)
{
	for (int i = 0; i < spec->equations; i++)
		if (spec->equation[i].at.source == at.source && spec->equation[i].at.offset == at.offset)
			return &spec->equation[i];
	return NULL;
}

static int sign_at(const struct lint *lint, const mpq_t *A, int coord)
{
	return mpq_sgn(A[lint->model->equations.owner[coord] * lint->system->n + coord]);
}

/* Which of a coordinate's own terms pushes it away: of the sign that its mass does not have; NULL: none does */
static const char *pushing_term(const struct lint *lint, int coord)
{
	const struct linear *s = lint->system;
	int mass = sign_at(lint, (s->velocity[coord] < 0 ? s->C : s->M), coord);
	if (s->velocity[coord] >= 0 && mass * sign_at(lint, s->C, coord) < 0)
		return "damping";
	return mass * sign_at(lint, s->K, coord) < 0 ? "stiffness" : NULL;
}

/* [1/s] of the entries of y' = A y: roots of those by which coordinates accelerate */
static double size_of(const struct linear *s, const mpq_t *A)
{
	double size = 0;
	for (int i = 0; i < s->states; i++)
		for (int j = 0; j < s->states; j++) {
			double entry = fabs(nearest_double(A[i * s->states + j]));
			if (i < s->n && s->velocity[i] >= 0)
				continue;       /* x' = v */
			size = fmax(size, i >= s->n && j < s->n && s->velocity[j] >= 0 ? sqrt(entry) : entry);
		}
	return size;
}

static double largest_pole(const struct lint *lint)
{
	double largest = 0;
	for (int i = 0; i < lint->poles; i++)
		largest = fmax(largest, hypot(lint->re[i], lint->im[i]));
	return largest;
}

/* A pole that is there m times is known to the mth part of the digits, and is then found as m around it. */
static bool may_be_rounding(const struct lint *lint, int pole, double largest)
{
	enum { UNITS = 100 };
	for (int times = 2; times <= lint->poles; times++) {
		const double near = largest * pow(UNITS * DBL_EPSILON, 1.0 / times);
		int around = 0;
		for (int i = 0; i < lint->poles; i++)
			around += hypot(lint->re[i] - lint->re[pole], lint->im[i] - lint->im[pole]) <= near;
		if (around >= times && lint->re[pole] <= near)
			return true;
	}
	return lint->re[pole] <= largest * GROWS;
}

static void check_stability(const struct lint *lint)
{
	double worst = 0, largest = largest_pole(lint);
	const struct model *model = lint->model;
	for (int i = 0; i < lint->poles; i++)
		if (lint->re[i] > worst && hypot(lint->re[i], lint->im[i]) >= PERHAPS_ZERO * lint->size &&
		    !may_be_rounding(lint, i, largest))
			worst = lint->re[i];
	if (worst == 0)
		return;
	struct place at = lint->negative.source ? lint->negative : model->spec->name_at;
	const char *why = NULL;
	for (int i = 0; i < model->n && !why && model->spec->equations; i++) {
		const char *term = pushing_term(lint, i);
		if (!term)
			continue;
		const struct residual *residual = &model->equations.residual[model->equations.owner[i]];
		const struct equation *equation = equation_at(model->spec, residual->at);
		int left = MOST_NODES;
		const struct symbol *param = equation ? negative_factor(equation->left, &left) : NULL;
		param = equation && !param ? negative_factor(equation->right, &left) : param;
		at = param ? param->at : residual->at;
		why = format("the %s of %s has the sign that its mass has not%s", term, model->names.coord[i],
			     param ? format(": param '%s' is negative", param->name) : "");
	}
	say_warning(at, why, "an unstable pole: the motion grows e-fold in %.3g s", 1 / worst);
}

/* ---- the step ---- */

static void check_step(const struct lint *lint)
{
	const struct model *model = lint->model;
	const struct linear *s = lint->system;
	double h = nearest_double(model->h), fastest = 0;
	const char *what = "";
	for (int i = 0; i < lint->poles; i++)
		if (lint->im[i] > fastest) {
			fastest = lint->im[i];
			what = "of the model";
		}
	for (int l = 0; l < s->loads; l++)
		if (load_acts(s, &s->load[l]) && nearest_double(s->load[l].forcing->w) > fastest) {
			fastest = nearest_double(s->load[l].forcing->w);
			what = "of a load";
		}
	if (fastest * h > PI)
		say_warning(model->request.at.step, format("a step below %.3g s", PI / fastest),
			    "the step is more than half the shortest period %s, %.3g s: its samples show a slower "
			    "motion",
			    what, 2 * PI / fastest);
}

/* ---- resonance ---- */

/* The largest coordinate under the load's forces at frequency w, in its last segment of time that has some; HUGE_VAL:
 * there the model has a pole */
static double amplitude(const struct linear *s, const struct load *load, double w)
{
	int n = s->n, segment = s->segments - 1;
	SCRATCH double complex *P = ARRAY(double complex, (size_t)n * (size_t)n), *x = ARRAY(double complex, n);
	bool acts = false;
	for (; !acts && segment >= 0; segment--)
		for (int i = 0; i < n; i++)
			for (int c = 0; c < load->columns; c++) {
				double force = nearest_double(load->force[c][segment * n + i]);
				acts = acts || force != 0;
				x[i] += c % 2 ? -I * force : force;
			}
	for (int i = 0; i < n * n; i++)
		P[i] = nearest_double(s->K[i]) - w * w * nearest_double(s->M[i]) + I * w * nearest_double(s->C[i]);
	solve_complex(n, P, x);
	double largest = 0;
	for (int i = 0; i < n; i++)
		largest = isfinite(cabs(x[i])) ? fmax(largest, cabs(x[i])) : HUGE_VAL;
	return largest;
}

/* cos or sin in an expression, through lets; or NULL */
static const struct node *oscillation(const struct node *node, int *left)
{
	const struct node *found = NULL;
	if (--*left < 0)
		return NULL;
	if (node->kind == NODE_CALL && (node->function == FN_COS || node->function == FN_SIN))
		return node;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET)
		return oscillation(node->symbol->value, left);
	for (int i = 0; i < node->children && !found; i++)
		found = oscillation(node->child[i], left);
	return found;
}

/* Of the only load that oscillates its cos or sin; else the equation that it acts on */
static struct place place_of_load(const struct lint *lint, const struct load *load)
{
	const struct linear *s = lint->system;
	int row = 0, oscillate = 0, left = MOST_NODES;
	for (int l = 0; l < s->loads; l++)
		oscillate += mpq_sgn(s->load[l].forcing->w) != 0;
	for (int i = s->n - 1; i >= 0; i--)
		for (int c = 0; c < load->columns; c++)
			for (int k = 0; k < s->segments; k++)
				row = mpq_sgn(load->force[c][k * s->n + i]) != 0 ? i : row;
	struct place at = lint->model->equations.residual[row].at;
	const struct equation *equation = equation_at(lint->model->spec, at);
	const struct node *node = equation && oscillate == 1 ? oscillation(equation->right, &left) : NULL;
	node = equation && oscillate == 1 && !node ? oscillation(equation->left, &left) : node;
	for (int i = 0; i < lint->model->spec->elements && oscillate == 1 && !node; i++)
		node = oscillation(lint->model->spec->element[i].value, &left);
	return node ? node->start : at;
}

static void check_resonance(const struct lint *lint)
{
	const struct linear *s = lint->system;
	for (int l = 0; l < s->loads; l++) {
		const struct load *load = &s->load[l];
		double w = nearest_double(load->forcing->w);
		if (w <= 0 || mpq_sgn(load->forcing->a) != 0 || !load_acts(s, load))
			continue;
		for (int i = 0; i < lint->poles; i++) {
			double own = hypot(lint->re[i], lint->im[i]);
			if (lint->im[i] <= 0 || fabs(w - own) > NEAR * own || fabs(lint->re[i]) > LIGHT * own ||
			    amplitude(s, load, own * (1 + 1e-4)) <
				    STANDS_OUT * amplitude(s, load, own * (1 - BESIDE)))
				continue;
			say_warning(place_of_load(lint, load), NULL,
				    "resonance: the load has %.4g rad/s, the model %.4g rad/s, %s", w, own,
				    fabs(lint->re[i]) < GROWS * own ? "undamped"
				    : format("with a damping ratio of %.2g", -lint->re[i] / own));
			break;
		}
	}
}

/* ---- forces that belong to no energy ---- */

/* By how much coordinate j acts on i, of the sign that the mass of i gives its equation */
static double action(const struct lint *lint, const mpq_t *A, int i, int j)
{
	return sign_at(lint, lint->system->M, i) *
	       nearest_double(A[lint->model->equations.owner[i] * lint->system->n + j]);
}

/* Where two coordinates act on each other, not one on the other alone, factors of the equations make both actions
 * alike: false where that needs a factor below 0, or another than is known. */
static bool is_balanced(const struct lint *lint, const mpq_t *A, int i, int j, double *factor)
{
	double there = action(lint, A, i, j), back = action(lint, A, j, i);
	if (there == 0 || back == 0)
		return true;
	if (there * back < 0)
		return false;
	if (factor[i] != 0 && factor[j] == 0)
		factor[j] = factor[i] * there / back;
	else if (factor[j] != 0 && factor[i] == 0)
		factor[i] = factor[j] * back / there;
	return factor[i] == 0 || fabs(factor[i] * there - factor[j] * back) <= 1e-9 * fabs(factor[i] * there);
}

static void report_circulation(const struct lint *lint, const mpq_t *A, const char *matrix, int i, int j)
{
	const struct model *model = lint->model;
	say_warning(model->equations.residual[model->equations.owner[j]].at,
		    "such are follower loads, flow, friction and control; else a sign or a term is wrong",
		    "the %s matrix is not symmetric: %s acts on %s by %.4g, %s on %s by %.4g", matrix,
		    model->names.coord[j], model->names.coord[i], action(lint, A, i, j), model->names.coord[i],
		    model->names.coord[j], action(lint, A, j, i));
}

/* Each of second order, with a mass of its own, and none whose acceleration acts on another one-sidedly, as those of
 * relative coordinates do: only then an energy would show in the entries. */
static bool shows_energy(const struct lint *lint)
{
	const struct linear *s = lint->system;
	for (int i = 0; i < s->n; i++) {
		if (s->velocity[i] < 0 || sign_at(lint, s->M, i) == 0)
			return false;
		for (int j = 0; j < i; j++)
			if ((action(lint, s->M, i, j) == 0) != (action(lint, s->M, j, i) == 0))
				return false;
	}
	return true;
}

static void check_symmetry(const struct lint *lint)
{
	const struct linear *s = lint->system;
	int n = s->n, reached = 0;
	if (n > MOST_POLES || lint->model->spec->equations == 0 || !shows_energy(lint))
		return;
	double *factor = ARRAY(double, n);
	int *queue = ARRAY(int, n);
	for (int first = 0; first < n; first++) {
		if (factor[first] != 0)
			continue;
		factor[first] = 1;
		queue[reached++] = first;
		for (int next = reached - 1; next < reached; next++) {
			int i = queue[next];
			for (int j = 0; j < n; j++) {
				bool fresh = factor[j] == 0;
				const mpq_t *M = s->M, *K = s->K;
				if (j == i)
					continue;
				bool M_good = is_balanced(lint, M, i, j, factor), K_good;
				K_good = is_balanced(lint, K, i, j, factor);
				if (!M_good || !K_good) {
					report_circulation(lint, M_good ? K : M, M_good ? "stiffness" : "mass",
							 i < j ? i : j, i < j ? j : i);
					return;
				}
				if (fresh && factor[j] != 0)
					queue[reached++] = j;
			}
		}
	}
}

/* ---- drift ---- */

/* Rows of n x width with the force in the last column: the row that is left with nothing but a force; -1: none */
static int unopposed_row(int n, int width, mpq_t *A)
{
	struct echelon e = echelon_new(width);
	for (int with = 0; with < 2; with++)    /* what has a force comes last, so that it is what is left */
		for (int i = 0; i < n; i++) {
			mpq_t *row = A + i * width;
			const int rank = e.rank;
			if ((mpq_sgn(row[width - 1]) != 0) != with)
				continue;
			echelon_add(&e, row);
			if (e.rank > rank && e.pivot[rank] == width - 1)
				return i;
		}
	return -1;
}

/* Only then may there be a rigid-body mode. */
static bool may_have_zero(const struct lint *lint)
{
	for (int i = 0; i < lint->poles; i++)
		if (hypot(lint->re[i], lint->im[i]) <= PERHAPS_ZERO * lint->size)
			return true;
	return false;
}

/* A constant force that neither stiffness nor damping meets, in the last segment of time */
static void check_drift(const struct lint *lint)
{
	const struct linear *s = lint->system;
	const struct model *model = lint->model;
	int n = s->n, width = 2 * n + 1;
	if (n > MOST_RANK || !may_have_zero(lint))
		return;
	size_t cells = (size_t)n * (size_t)width;
	RATIONALS *A = rationals(cells);
	for (int i = 0; i < n; i++) {
		for (int j = 0; j < n; j++) {
			mpq_set(A[i * width + j], s->K[i * n + j]);
			mpq_set(A[i * width + n + j], s->C[i * n + j]);
		}
		for (int l = 0; l < s->loads; l++)
			if (is_polynomial(s->load[l].forcing))
				mpq_add(A[i * width + 2 * n], A[i * width + 2 * n],
					s->load[l].force[0][(s->segments - 1) * n + i]);
	}
	int row = unopposed_row(n, width, A);
	if (row >= 0)
		say_warning(model->equations.residual[row].at, NULL,
			    "a constant load drives %s off: neither stiffness nor damping holds the rigid-body mode "
			    "there",
			    model->names.coord[coordinate_of_row(model, row)]);
}

/* ---- powers that a negative number does not have ---- */

static bool is_never_negative(struct building *b, struct node *node)
{
	RATIONAL value = ZERO;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET)
		return is_never_negative(b, node->symbol->value);
	if (node->kind == NODE_POWER)
		return constant_of_node(b, node->child[1], value) && mpz_even_p(mpq_numref(value));
	if (node->kind == NODE_CALL && node->function == FN_MAX)
		return is_never_negative(b, node->child[0]) || is_never_negative(b, node->child[1]);
	if (node->kind == NODE_CALL)
		return node->function == FN_ABS || node->function == FN_EXP || node->function == FN_SQRT;
	bool never = node->kind == NODE_SUM || node->kind == NODE_PRODUCT;
	for (int i = 0; i < node->children && never; i++)
		never = !(node->kind == NODE_SUM && node->inverse[i]) && is_never_negative(b, node->child[i]);
	return never || (constant_of_node(b, node, value) && mpq_sgn(value) >= 0);
}

/* x^1.5 of a coordinate x: the first in each equation is named. */
static bool check_powers(struct building *b, struct node *node, int *left)
{
	RATIONAL exponent = ZERO;
	if (--*left < 0)
		return true;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET)
		return check_powers(b, node->symbol->value, left);
	if (node->kind == NODE_POWER && reads_coordinate(node->child[0], left) &&
	    constant_of_node(b, node->child[1], exponent) && mpz_cmp_ui(mpq_denref(exponent), 1) != 0 &&
	    !is_never_negative(b, node->child[0])) {
		const char *base = text_between(node->child[0]->start, node->child[0]->end);
		say_note(node->start, "where '%s' is negative it has no such power, and the step leaves the finite "
			 "numbers; max(%s, 0) and abs(%s) are never negative", base, base, base);
		return true;
	}
	bool found = node->kind == NODE_CHOOSE;         /* x > 0 ? x^1.5 : 0 has looked */
	for (int i = 0; i < node->children && !found; i++)
		found = check_powers(b, node->child[i], left);
	return found;
}

static void check_equations(struct building *b)
{
	for (int i = 0; i < b->spec->equations; i++) {
		int left = MOST_NODES;
		if (!check_powers(b, b->spec->equation[i].left, &left))
			check_powers(b, b->spec->equation[i].right, &left);
	}
	for (int i = 0; i < b->spec->elements; i++) {
		int left = MOST_NODES;
		check_powers(b, b->spec->element[i].value, &left);
	}
}

/* ---- the whole ---- */

void lint(struct building *b)
{
	const struct model *model = b->model;
	struct lint lint = { .b = b, .model = model, .system = &model->system };
	check_names(b->spec);
	check_elements(&lint);
	check_equations(b);
	if (model->switching || model->schedule.operators || model->remainder.force_columns ||
	    model->scheme != SCHEME_EXACT)
		return;
	int states = model->system.states;
	if (states <= MOST_POLES) {
		lint.re = ARRAY(double, states);
		lint.im = ARRAY(double, states);
		const mpq_t *A = state_matrix(&model->system, false);
		lint.size = size_of(&model->system, A);
		if (eigenvalues(states, A, lint.re, lint.im))
			lint.poles = states;
	}
	check_stability(&lint);
	check_step(&lint);
	check_resonance(&lint);
	check_symmetry(&lint);
	check_drift(&lint);
}
