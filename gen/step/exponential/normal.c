/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Normal modes of the operators of a schedule: V^T M V = I, V^T K V = diag lambda, V^T C V = diag 2 delta, so that q =
 * V eta makes of M q'' + C q' + K q = F as many equations eta'' + 2 delta eta' + lambda eta = V^T F.
 */
#include "inner.h"
#include "model/contacts/contacts.h"
#include "step/collocation/collocation.h"

#include <math.h>

enum {
	SWEEPS = 3,                 /* of collocation: each adds an order to what is extrapolated */
	FIRST_SWEEPS = 6            /* beside as many as stages, where nothing is */
};

struct place scheme_place(const struct step *step)
{
	const struct model *model = step->model;
	return model->request.at.scheme.source ? model->request.at.scheme : model->spec->name_at;
}

/* ---- which models have them ---- */

static const char *name_of(const struct step *step)
{
	return scheme_name(step->model->scheme);
}

/* Beside a derivative by what changes masses M is [M, 0; M_k, M]. */
static void check_derivative(const struct step *step, int coord)
{
	const struct spec *spec = step->model->spec;
	if (!spec->joined.columns || coord < spec->joined.own)
		return;
	const int column = (coord - spec->joined.own) / spec->joined.stride;
	const struct sensitivity *by = &spec->sensitivity[step->model->request.again.derivatives_from + column];
	error(by->at, "other schemes have one", "no derivative is by '%s' in scheme %s: it changes masses", by->name,
	      name_of(step));
}

static void check_symmetry(const struct normal_work *w)
{
	const struct model *model = w->model;
	int n = model->n;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < i; j++) {
			if (mpq_equal(w->M[i * n + j], w->M[j * n + i]))
				continue;
			check_derivative(w->step, i);
			error(scheme_place(w->step), "Lagrange's equations, one for each coordinate, have one",
			      "scheme %s needs a symmetric mass matrix: %s'' has the factor %s in the equation "
			      "of %s, %s'' has %s in that of %s", name_of(w->step), model->names.coord[j],
			      readable_text(w->M[i * n + j]), model->names.coord[i], model->names.coord[i],
			      readable_text(w->M[j * n + i]), model->names.coord[j]);
		}
}

static void check_left(const struct step *step)
{
	const struct model *model = step->model;
	if (model->schedule.operators > 1 && model->remainder.split->selector < 0)
		error(model->spec->operators.at, "of one operator, or of an operator schedule by time or a let of time",
		      "scheme %s takes the modes of an operator schedule that is chosen by time alone", name_of(step));
	const struct node *mixed = model->remainder.split->mixed;
	if (mixed)
		error(mixed->start, "etdrk4 and taylor take it",
		      "scheme %s takes products of functions of time and of states: in '%s' both stand in one",
		      name_of(step), text_between(mixed->start, mixed->end));
}

/* ---- modes ---- */


/* value <- v^T X v of column j */
static void quadratic(const struct eigenpairs *pairs, const mpq_t *X, int j, mpfr_ptr value)
{
	int n = pairs->n;
	REAL part = WITH_BITS(mpfr_get_prec(value));
	mpfr_set_zero(value, 1);
	for (int i = 0; i < n; i++)
		for (int k = 0; k < n; k++) {
			if (mpq_sgn(X[i * n + k]) == 0)
				continue;
			mpfr_mul_q(part, pairs->vector[i * n + j], X[i * n + k], MPFR_RNDN);
			mpfr_mul(part, part, pairs->vector[k * n + j], MPFR_RNDN);
			mpfr_add(value, value, part, MPFR_RNDN);
		}
}

/* Modes of K, or with damping those of K + C h 7/5, which are those of both */
static void find_modes(struct normal_work *w, int schedule)
{
	int n = w->model->n;
	size_t cells = (size_t)n * (size_t)n;
	const struct operator *operator = &w->model->schedule.operator[schedule];
	mpq_t *K = by_coordinates(w->model, operator->K);
	mpq_t *C = by_coordinates(w->model, operator->C), *both = rationals(cells);
	bool damped = !rationals_zero(cells, C);
	for (size_t i = 0; i < cells; i++) {
		mpq_set_ui(both[i], 7, 5);
		mpq_mul(both[i], both[i], C[i]);
		mpq_add(both[i], both[i], K[i]);
	}
	if (!symmetric_eigenpairs(n, w->M, both, NORMAL_BITS, &w->pairs[schedule]))
		error(scheme_place(w->step), NULL, "scheme %s needs a mass matrix that is positive definite",
		      name_of(w->step));
	for (int j = 0; j < n; j++) {
		struct normal_mode *mode = &w->mode[schedule * n + j];
		mpfr_inits2(mpfr_get_prec(w->pairs[schedule].value[j]), mode->lambda, mode->delta, NULL);
		if (!damped) {
			mpfr_set(mode->lambda, w->pairs[schedule].value[j], MPFR_RNDN);
			mpfr_set_zero(mode->delta, 1);
			continue;
		}
		quadratic(&w->pairs[schedule], K, j, mode->lambda);
		quadratic(&w->pairs[schedule], C, j, mode->delta);
		mpfr_div_2ui(mode->delta, mode->delta, 1, MPFR_RNDN);
	}
}

/* Coordinates that a mode of the block moves, in any schedule; else all */
static int *coordinates_of(const struct normal_work *w, const struct mode_block *own, int first)
{
	int n = w->normal->modes, count = 0, *coord = ARRAY(int, n + 1);
	for (int i = 0; i < n; i++) {
		bool moves = false;
		for (int j = first; j < first + own->modes; j++)
			moves = moves || mpfr_sgn(w->pairs[0].vector[i * n + j]) != 0;
		if (moves || own->modes == n)
			coord[count++] = i;
	}
	return coord;
}

/* Blocks are those of all operators alike, or there is one. */
static void find_blocks(struct normal_work *w)
{
	struct normal *normal = w->normal;
	const int n = normal->modes, *block = w->pairs[0].block;
	bool alike = true;
	for (int b = 1; b < normal->operators; b++)
		for (int j = 0; j < n; j++)
			alike = alike && w->pairs[b].block[j] == block[j];
	normal->blocks = alike ? w->pairs[0].blocks : 1;
	normal->block = ARRAY(struct mode_block, normal->blocks);
	normal->place = ARRAY(int, n);
	for (int j = 0; j < n; j++)
		normal->block[alike ? block[j] : 0].modes++;
	for (int b = 0, first = 0; b < normal->blocks; first += normal->block[b++].modes) {
		struct mode_block *own = &normal->block[b];
		own->place = normal->width;
		own->coord = coordinates_of(w, own, first);
		own->rows = (own->modes + 1) / 2 * 2;
		normal->width += own->rows;
	}
	for (int j = 0, b = 0, first = 0; j < n; j++) {
		if (j - first == normal->block[b].modes)
			first += normal->block[b++].modes;
		normal->place[j] = normal->block[b].place + j - first;
	}
}

/* ---- weights ---- */

/* Of all operators at theta h; correct: NULL, or the weights of the first of the polynomials, which stage is without */
static struct normal_stage stage_of(const struct normal_work *w, mpq_srcptr theta, const struct lagrange *l)
{
	const struct normal *normal = w->normal;
	int width = normal->width, n = normal->modes;
	struct normal_stage stage = { .points = l->nodes, .forcing = forcings_of_stage(w, theta) };
	stage.flow = ARRAY(double, (size_t)(normal->operators * 4 * width));
	stage.weight = ARRAY(double, (size_t)(normal->operators * l->nodes * 2 * width));
	for (int b = 0; b < normal->operators; b++)
		for (int j = 0; j < n; j++) {
			struct mode_flow flow = mode_flow_of(&w->mode[b * n + j], w->model->h, theta, l);
			const mpfr_srcptr own[] = { flow.e, flow.s, flow.de, flow.ds };
			for (int k = 0; k < 4; k++)
				stage.flow[(b * 4 + k) * width + normal->place[j]] = round_real(own[k]);
			for (int k = 0; k < l->nodes; k++) {
				double *weight = stage.weight + (b * l->nodes + k) * 2 * width + normal->place[j];
				weight[0] = round_real(flow.position[k]);
				weight[width] = round_real(flow.rate[k]);
			}
			mode_flow_free(&flow);
		}
	return stage;
}

/* The corrector's polynomial through the new force and all others is the predictor's and, times what the new force
 * exceeds that at h, the one that is 1 at h and 0 at all others. */
static void find_multistep(struct normal_work *w)
{
	struct normal *normal = w->normal;
	int width = normal->width, points = normal->multistep.points;
	mpq_t *node = past_nodes(points + 1);
	RATIONAL one = RATIO(1, 1);
	struct lagrange past = lagrange_of(points, node);
	REALS *value = reals((size_t)points, NORMAL_BITS);
	normal->multistep.step = stage_of(w, one, &past);
	lagrange_at(&past, one, value);
	normal->multistep.extrapolate = ARRAY(double, points);
	for (int k = 0; k < points; k++)
		normal->multistep.extrapolate[k] = round_real(value[k]);
	mpq_set_ui(node[points], 1, 1);
	struct lagrange all = lagrange_of(points + 1, node);
	struct normal_stage corrector = stage_of(w, one, &all);
	normal->multistep.correct = ARRAY(double, (size_t)(normal->operators * 2 * width));
	for (int b = 0; b < normal->operators; b++)
		for (int i = 0; i < 2 * width; i++)
			normal->multistep.correct[b * 2 * width + i] =
				corrector.weight[(b * (points + 1) + points) * 2 * width + i];
}

static void find_stages(struct normal_work *w)
{
	struct normal *normal = w->normal;
	normal->collocation.node = lobatto_nodes(normal->collocation.stages);
	struct lagrange l = lagrange_of(normal->collocation.stages + 1, normal->collocation.node);
	normal->collocation.stage = ARRAY(struct normal_stage, normal->collocation.stages);
	for (int i = 0; i < normal->collocation.stages; i++)
		normal->collocation.stage[i] = stage_of(w, normal->collocation.node[i + 1], &l);
	REALS *value = reals((size_t)l.nodes, NORMAL_BITS);
	RATIONAL later = ZERO;
	normal->collocation.ahead = ARRAY(double, (size_t)(normal->collocation.stages * l.nodes));
	for (int i = 0; i < normal->collocation.stages; i++) {
		mpq_set_ui(later, 1, 1);
		mpq_add(later, later, normal->collocation.node[i + 1]);
		lagrange_at(&l, later, value);
		for (int k = 0; k < l.nodes; k++)
			normal->collocation.ahead[i * l.nodes + k] = round_real(value[k]);
	}
}

/* ---- the end: all functions of time are constant ---- */

static int last_schedule(const struct model *model)
{
	const struct splitting *split = model->remainder.split;
	int schedule = 0;
	while (split->selector >= 0 && schedule + 1 < model->schedule.operators &&
	       mpq_cmp(split->function[split->selector].last, model->schedule.operator[schedule].at) > 0)
		schedule++;
	return schedule;
}

static void find_steady(struct normal_work *w)
{
	struct normal *normal = w->normal;
	const struct model *model = w->model;
	int n = normal->modes, size = steady_size(model), width = normal->width;
	int schedule = normal->steady.schedule = last_schedule(model);
	mpfr_t *omega = reals((size_t)n, NORMAL_BITS), *Phi;
	normal->steady.omega = ARRAY(double, width);
	normal->steady.period = ARRAY(double, width);
	normal->steady.flow = ARRAY(double, (size_t)(size * 2 * width));
	for (int j = 0; j < n; j++) {
		mpfr_srcptr lambda = w->mode[schedule * n + j].lambda;
		mpfr_set_ui(omega[j], 1, MPFR_RNDN);
		if (mpfr_sgn(lambda) > 0)
			mpfr_sqrt(omega[j], lambda, MPFR_RNDN);
		normal->steady.omega[normal->place[j]] = round_real(omega[j]);
		mpfr_set_d(omega[j], normal->steady.omega[normal->place[j]], MPFR_RNDN); /* as the target has it */
		mpfr_ui_div(omega[j], 1, omega[j], MPFR_RNDN);
		normal->steady.period[normal->place[j]] = round_real(omega[j]);
		mpfr_ui_div(omega[j], 1, omega[j], MPFR_RNDN);
	}
	Phi = steady_matrix(model, w->M, by_coordinates(model, model->schedule.operator[0].C),
			     by_coordinates(model, model->schedule.operator[0].K), &w->pairs[schedule], omega);
	for (int i = 0; i < 2 * n; i++)
		for (int j = 0; j < size; j++)
			normal->steady.flow[j * 2 * width + (i < n ? 0 : width) + normal->place[i % n]] =
				round_real(Phi[i * size + j]);
}

/* ---- changes of formula ---- */

static void check_changes(const struct step *step)
{
	const struct model *model = step->model;
	const struct linear *system = &model->system;
	RATIONAL steps = ZERO;
	if (model->remainder.split->unknown)
		error(model->remainder.split->unknown->node->start, "etdrk4 and taylor take it",
		      "scheme %s starts anew where a formula in time changes: of '%s' it is not known when",
		      name_of(step),
		      text_between(model->remainder.split->unknown->node->start,
				   model->remainder.split->unknown->node->end));
	for (int s = 0; s + 1 < system->segments; s++) {
		mpq_div(steps, system->change[s], model->h);
		if (mpq_sgn(steps) > 0 && mpz_cmp_ui(mpq_denref(steps), 1) != 0)
			error(model->request.at.step, "a step of which that time is a multiple, or etdrk4 or taylor",
			      "scheme %s starts anew where a formula in time changes: t = %s is inside a step of %s s",
			      name_of(step), readable_text(system->change[s]), readable_text(model->h));
	}
}

/* ---- which way a multistep method goes ---- */

static const char *growth_text(const struct stability *s)
{
	return format("a step by up to %.3g, at t = %.3g s, all steps up to %.4g s by e^%.0f", s->radius, s->time,
		      s->span, s->growth);
}

static _Noreturn void report_growth(const struct step *step, const struct stability *once,
				  const struct stability *again)
{
	const char *twice = again ? format("; with forces evaluated twice %s", growth_text(again)) : "";
	error(scheme_place(step),
	      again ? "a shorter step, a lower order, more operators, or scheme etdcol, which bears more, may be stable"
		    : "a shorter step or more operators may be stable",
	      "scheme %s is not stable here: with functions of time frozen states may grow: %s%s", name_of(step),
	      growth_text(once), twice);
}

/* Forces are evaluated once a step where that holds, else twice, where that does. */
static void choose_evaluations(struct normal_work *w)
{
	enum { CALM = 3, MOST = 7 };    /* ln of what the steps may let grow: without a further look, at all */
	struct normal *normal = w->normal;
	struct stability once = stability_of(w->step, false), again;
	normal->stability = once;
	if (once.growth <= CALM)
		return;
	if (normal->multistep.points == 0) {
		if (!(once.growth <= MOST))
			report_growth(w->step, &once, NULL);
		return;
	}
	again = stability_of(w->step, true);
	if (again.growth < once.growth) {
		normal->multistep.twice = true;
		normal->stability = again;
	}
	if (!(normal->stability.growth <= MOST))
		report_growth(w->step, &once, &again);
}

/* ---- the whole ---- */

struct normal *normal_of(struct step *step)
{
	const struct model *model = step->model;
	const struct scheme_row *row = scheme_row(model->scheme);
	struct normal *normal = NEW(struct normal);
	struct normal_work w = { .step = step, .model = model, .normal = normal };
	if (!has_contacts(model)) {     /* from event to event, forces are those of the expressions, at any time */
		check_left(step);
		check_changes(step);
	}
	check_turns(step);
	w.M = by_coordinates(model, model->system.M);
	check_symmetry(&w);
	normal->modes = model->n;
	normal->operators = model->schedule.operators;
	normal->multistep.points = row->points;
	w.pairs = ARRAY(struct eigenpairs, normal->operators);
	w.mode = ARRAY(struct normal_mode, (size_t)(normal->operators * model->n));
	for (int b = 0; b < normal->operators; b++)
		find_modes(&w, b);
	find_blocks(&w);
	find_transforms(&w);
	find_turns(&w);
	find_matrices(&w);
	find_forces(&w);
	find_forcings(&w);
	normal->collocation.stages = row->points ? row->points - 1 : model->truncation.stages;
	normal->kept = row->points ? row->points : model->truncation.stages + 1;
	normal->collocation.sweeps = SWEEPS;
	normal->collocation.first_sweeps = normal->collocation.stages + FIRST_SWEEPS;
	if (row->points)
		find_multistep(&w);
	find_stages(&w);
	step->normal = normal;
	choose_evaluations(&w);
	if (model->remainder.split->ends_steady)
		find_steady(&w);
	find_within(&w);
	return normal;
}
