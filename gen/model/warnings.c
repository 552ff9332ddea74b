/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a spec may say but is better warned of. */
#include "building.h"
#include "checks.h"
#include "reads.h"
#include "model/contacts/friction.h"

#include <string.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdlib.h>

enum { SAMPLES = 32 };

/* The part of itself by which a squared frequency has to exceed the operator's for a warning: LITTLE at rest as time
 * goes by; of a motion TWICE where a thousand steps lose more than DRIFT [rad] of phase, else TENFOLD. */
static const double LITTLE = 1e-2, TWICE = 0.5, TENFOLD = 0.9, DRIFT = 1e-3;

/* ---- explicit predictors ---- */

static struct place scheme_place(const struct building *b)
{
	return b->model->request.at.scheme.source ? b->model->request.at.scheme : b->spec->name_at;
}

static void check_predictor(struct jacobian *j)
{
	static const double limit = 2.5;        /* RK4's own is 2.8; with a good operator the schemes last to 3 to 7 */
	struct building *b = j->b;
	const struct model *model = b->model;
	double fastest = 0;
	j->state = model->initial;
	j->damped = true;
	if (silent_guard(jacobian_evaluate, j))
		fastest = fastest_pole(&j->at);
	for (int k = 0; k < model->schedule.operators; k++) {
		struct linear system = operator_system(model, k);
		fastest = fmax(fastest, fastest_pole(&system));
	}
	double h = nearest_double(model->h);
	if (fastest * h > limit)
		say_warning(scheme_place(b),
			    format("a step up to %.3g s, or a scheme of the etd family, whose operator has the "
				   "stiffness",
				   limit / fastest),
			    "%s predicts its nodes explicitly, up to |lambda| h of about %.1f: here |lambda| = %.4g "
			    "1/s, times h = %s s that is %.3g",
			    scheme_name(model->scheme), limit, fastest, readable_text(model->h), fastest * h);
}

/* ---- operators that are too soft ---- */

/* Of a schedule: that which serves at this point */
struct choice_work {
	struct jacobian *j;
	int which;
};

static void choose_operator(void *context)
{
	struct choice_work *work = context;
	const struct model *model = work->j->b->model;
	struct collector *c = &work->j->b->collector;
	struct fixing *fixing = ARRAY(struct fixing, model->system.states + 1);
	struct point *point = point_new(c, jacobian_point(work->j, fixing), fixing);
	point_at_values(point);
	const struct form *now = form_at(point, model->schedule.selector);
	if (!is_constant(now))
		abandon();
	RATIONAL value = ZERO;
	constant_value(c, now, value);
	while (work->which + 1 < model->schedule.operators &&
	       mpq_cmp(value, model->schedule.operator[work->which].at) > 0)
		work->which++;
}

struct softness {
	double here, operator;      /* squared frequencies, of the mode that exceeds the operator's most for its size */
	const char *where;          /* and when; "": at rest */
};

/* What h^2 times the difference of squared frequencies costs in a thousand steps: growth, or the phase of a
 * Runge-Kutta scheme; the first term of e^z that order p does not have is z^(p+1) / (p+1)! */
static double drift_of_softness(const struct model *model, double difference)
{
	const struct scheme_row *scheme = scheme_row(model->scheme);
	double h = nearest_double(model->h), d = difference * h * h, factorial = 1;
	if (scheme->growth_divisor)
		return 1000 * d / scheme->growth_divisor;
	for (int k = 2; k <= scheme->order + 1; k++)
		factorial *= k;
	return 1000 * pow(d, (scheme->order + 1) / 2.0) / factorial;
}

/* What follows from a difference of squared frequencies */
static const char *growth_text(const struct model *model, double difference)
{
	int divisor = scheme_row(model->scheme)->growth_divisor;
	if (!divisor)
		return "";
	return format(", growing at up to %.3g 1/s in %s (h/%d times the difference)",
		      nearest_double(model->h) / divisor * difference, scheme_name(model->scheme), divisor);
}

static bool is_reported(const struct model *model, bool moved, double here, double there)
{
	bool matters = !moved || drift_of_softness(model, here - there) > DRIFT;
	return here - there > (moved ? matters ? TWICE : TENFOLD : LITTLE) * fabs(here) && (matters || there > 0);
}

/* `moved`: the states are those of a motion, not at rest */
static void compare(struct jacobian *j, bool moved, const char *where, struct softness *worst)
{
	const struct model *model = j->b->model;
	struct choice_work choice = { j, 0 };
	double *here = ARRAY(double, model->n), *there = ARRAY(double, model->n);
	if (!silent_guard(jacobian_evaluate, j) ||
	    (model->schedule.selector && !silent_guard(choose_operator, &choice)))
		return;
	struct linear system = operator_system(model, choice.which);
	if (!squared_frequencies(&j->at, here) || !squared_frequencies(&system, there))
		return;
	for (int i = 0; i < model->n; i++) {
		double now = (here[i] - there[i]) * worst->here, known = (worst->here - worst->operator) * here[i];
		if (is_reported(model, moved, here[i], there[i]) &&
		    (worst->here == 0 || (moved ? now > known : now >= known)))
			*worst = (struct softness){ here[i], there[i], where };
	}
}

/* What the entries of K read, whatever their row */
static void find_stiffness_reads(const struct jacobian *j, bool *time, bool *states)
{
	const struct model *model = j->b->model;
	*time = *states = false;
	for (int k = 0; k < model->n; k++) {
		struct reads reads = reads_of(model, model->n, (const struct form *const *)j->K[k]);
		*time = *time || reads.time;
		for (int l = 0; l < model->system.loads; l++)
			*time = *time || reads.load[l];
		for (int i = 0; i < model->system.states; i++)
			*states = *states || reads.state[i];
	}
}

/* ---- a reference, to see how far the motion goes ---- */

/* terms evaluated on the way; coordinates of which each has its own largest excursion */
enum { LIMIT_WORK = 500000, FOLLOWED = 8 };

static const double LOST = 1e30;        /* the motion has left */

struct reference {
	const struct building *b;
	struct sample *sample;
	const double *y;            /* where it is evaluated */
	mpfr_t t, value;
	double *inverse;            /* of what multiplies the highest derivatives */
	double *residual;
};

static void state_leaf(void *context, const struct basis *basis, mpfr_ptr value)
{
	const struct reference *r = context;
	const struct model *model = r->b->model;
	if (basis->kind == BASIS_COORD && !is_highest(&model->frame, basis))
		mpfr_set_d(value, r->y[basis->order ? model->system.velocity[basis->index] : basis->index], MPFR_RNDN);
	else
		mpfr_set_ui(value, 0, MPFR_RNDN);       /* inputs are not known */
}

static int slopes(double t, const double y[], double dydt[], void *context)
{
	struct reference *r = context;
	const struct model *model = r->b->model;
	int n = model->n;
	if (sample_work(r->sample) > LIMIT_WORK)
		return GSL_EBADFUNC;
	r->y = y;
	mpfr_set_d(r->t, t, MPFR_RNDN);
	sample_at(r->sample, r->t);
	for (int i = 0; i < n; i++) {
		sample_form(r->sample, r->b->full->residual[i].form, r->value);
		r->residual[i] = mpfr_get_d(r->value, MPFR_RNDN);
		if (!isfinite(r->residual[i]))
			return GSL_EBADFUNC;
	}
	for (int k = 0; k < n; k++) {
		int velocity = model->system.velocity[k];
		double highest = 0;
		for (int i = 0; i < n; i++)
			highest -= r->inverse[k * n + i] * r->residual[i];
		dydt[k] = velocity < 0 ? highest : y[velocity];
		if (velocity >= 0)
			dydt[velocity] = highest;
	}
	return GSL_SUCCESS;
}

static bool make_reference(struct reference *r, const struct building *b)
{
	const struct model *model = b->model;
	size_t n = (size_t)model->n;
	mpq_t *inverse = rationals(n * n);
	int column;
	if (!leading_inverse(&model->system, inverse, &column))
		return false;
	*r = (struct reference){ .b = b, .inverse = ARRAY(double, n * n), .residual = ARRAY(double, n) };
	for (size_t i = 0; i < n * n; i++)
		r->inverse[i] = nearest_double(inverse[i]);
	mpfr_inits2(53, r->t, r->value, NULL);
	r->sample = sample_new(53, state_leaf, r);
	return true;
}

/* The state as short rationals: a Jacobian there is no better known than the motion */
static void set_state(const struct model *model, const double *y, mpq_t *state)
{
	for (int i = 0; i < model->system.states; i++)
		mpq_set_d(state[i], (double)(float)y[i]);
}

/* Where each coordinate is farthest from 0 until `end`, as far as that can be followed */
static void compare_excursions(struct jacobian *j, double end, struct softness *worst)
{
	const struct model *model = j->b->model;
	int states = model->system.states, followed = model->n < FOLLOWED ? model->n : FOLLOWED;
	size_t size = (size_t)states;
	double *y = ARRAY(double, size), *farthest = ARRAY(double, (size_t)followed *size),
	       *when = ARRAY(double, followed);
	double t = 0, h = nearest_double(model->h);
	struct reference r;
	if (!make_reference(&r, j->b))
		return;
	for (int i = 0; i < states; i++)
		y[i] = nearest_double(model->initial[i]);
	gsl_error_handler_t *handler = gsl_set_error_handler_off();
	gsl_odeiv2_system system = { slopes, NULL, size, &r };
	gsl_odeiv2_step *step = need_memory(gsl_odeiv2_step_alloc(gsl_odeiv2_step_rkf45, size));
	gsl_odeiv2_control *control = need_memory(gsl_odeiv2_control_y_new(1e-8, 1e-4));
	gsl_odeiv2_evolve *evolve = need_memory(gsl_odeiv2_evolve_alloc(size));
	bool good = true;
	while (good) {
		for (int k = 0; k < followed; k++)
			if (fabs(y[k]) > fabs(farthest[(size_t)k * size + (size_t)k])) {
				for (int i = 0; i < states; i++)
					farthest[(size_t)k * size + (size_t)i] = y[i];
				when[k] = t;
			}
		good = t < end &&
		       gsl_odeiv2_evolve_apply(evolve, control, step, &system, &t, end, &h, y) == GSL_SUCCESS;
		for (int i = 0; i < states; i++)
			good = good && fabs(y[i]) < LOST;
	}
	bool lost = t < end && (sample_work(r.sample) <= LIMIT_WORK || h < 1e-6 * nearest_double(model->h));
	gsl_odeiv2_evolve_free(evolve);
	gsl_odeiv2_control_free(control);
	gsl_odeiv2_step_free(step);
	gsl_set_error_handler(handler);
	mpfr_clears(r.t, r.value, NULL);
	mpq_t *state = rationals(size);
	j->state = state;
	for (int k = 0; k < followed && !lost; k++) {
		if (when[k] == 0)
			continue;               /* at the initial values */
		set_state(model, farthest + (size_t)k * size, state);
		mpq_set_d(j->t, (double)(float)when[k]);
		compare(j, true, format("where %s is at its largest, at t = %.3g s, ", model->names.coord[k], when[k]),
			worst);
	}
}

/* Over the time in which loads change their formula, else over a thousand steps */
static void check_softness(struct jacobian *j)
{
	struct building *b = j->b;
	const struct model *model = b->model;
	struct softness worst = { 0, 0, "" };
	RATIONAL end = ZERO;
	int changes = model->system.segments - 1;
	if (changes > 0 && mpq_sgn(model->system.change[changes - 1]) > 0)
		mpq_set(end, model->system.change[changes - 1]);
	else
		mpq_set_ui(end, 1000, 1);
	if (changes == 0 || mpq_sgn(model->system.change[changes - 1]) <= 0)
		mpq_mul(end, end, model->h);
	/* at rest; where that is not defined, at the start */
	j->state = rationals(model->system.states);
	if (!silent_guard(jacobian_evaluate, j))
		j->state = model->initial;
	bool moves, reads_states;
	find_stiffness_reads(j, &moves, &reads_states);
	for (int k = 0; k <= (moves ? SAMPLES : 0); k++) {
		mpq_set_ui(j->t, (unsigned long)k, SAMPLES);
		mpq_canonicalize(j->t);
		mpq_mul(j->t, j->t, end);
		compare(j, false, moves ? format("at t = %.4g s ", mpq_get_d(j->t)) : "", &worst);
	}
	if (reads_states) {
		mpq_set_ui(j->t, 0, 1);
		j->state = model->initial;
		compare(j, true, "at the initial values ", &worst);
		compare_excursions(j, nearest_double(end), &worst);
	}
	if (worst.here <= worst.operator)
		return;
	say_warning(b->spec->operators.given ? b->spec->operators.at : scheme_place(b),
		    format("the remainder then drives the motion%s; fix the operator where the model is stiffest",
			   growth_text(model, worst.here - worst.operator)),
		    "the linear operator is softer than the model gets: %sa squared frequency is %.4g 1/s^2, the "
		    "operator's %.4g",
		    worst.where, worst.here, worst.operator);
}

/* ---- what is not smooth ---- */

static void check_smoothness(const struct building *b)
{
	const struct model *model = b->model;
	if (!loses_order(model))
		return;
	const struct smoothness *smooth = &model->remainder.smooth;
	if (scheme_row(model->scheme)->expands && smooth->kind != SMOOTH_ALL)
		return;                         /* it is refused */
	const struct node *other = model->nonlinear.obstacle;
	bool apart =
		smooth->piecewise && !smooth->timed && other &&
		(other->end.offset <= smooth->node->start.offset || other->start.offset >= smooth->node->end.offset);
	const char *cure = smooth->timed && smooth->kind == SMOOTH_KINK
				   ? "a step of which that time is a multiple keeps the order"
			   : smooth->kind == SMOOTH_JUMP
				   ? "a smaller step, or something smooth in its place, such as tanh of a multiple"
				   : "a smaller step, or something smoother in its place";
	say_warning(smooth->node->start,
		    apart ? format("scheme exact treats it where '%s' is not beside it; else %s",
				   text_between(other->start, other->end), cure)
			  : cure,
		    "%s: scheme %s is of order %s at most there, not %d", smoothness_text(model),
		    scheme_name(model->scheme), order_text(model), order_of_scheme(model));
}

/* ---- the whole ---- */

/* What is asked of a series, and the scheme is none */
static void check_truncation(const struct building *b)
{
	const struct model *model = b->model;
	const char *why = scheme_row(model->scheme)->expands
				  ? "each step is h, whatever its error"
				  : format("scheme %s does not look at its error", scheme_name(model->scheme));
	bool expands = scheme_row(model->scheme)->expands;
	const char *requested = b->request->tolerance;
	if ((requested || b->spec->request.tolerance) && !expands)
		say_warning(requested ? (struct place){ source_argument(requested), 0 }
			    : b->spec->request.tolerance->start, NULL,
			    "the tolerance has no effect: %s", why);
	else if (b->spec->request.absolutes > 0 && mpq_sgn(model->truncation.tolerance) == 0)
		say_warning(b->spec->request.absolute_of[0].at, NULL, "the tolerance has no effect: %s", why);
	if (b->spec->request.substeps && !model->truncation.adaptive)
		say_warning(b->spec->request.substeps->start, NULL, "the bound on substeps has no effect: %s", why);
	if (b->spec->request.cached && !model->switching)
		say_warning(b->spec->request.cached->start, NULL, "regions cached has no effect: the model has none");
}

static void check_need(const struct building *b, bool left)
{
	enum { FEW = 7 };               /* impacts that exact has too many regions of */
	const struct model *model = b->model;
	const struct scheme_row *scheme = scheme_row(model->scheme);
	if (b->spec->operators.given && (!scheme->leaves || !left || scheme->expands))
		say_warning(b->spec->operators.at, NULL, "the operator has no effect: %s",
			    scheme->holds_coupling
				    ? format("that of scheme %s is each coordinate's own terms", scheme->name)
			    : scheme->collocates ? format("scheme %s takes the whole right side as it is", scheme->name)
			    : scheme->expands ? format("scheme %s expands the whole right side", scheme->name)
					      : "there is no remainder");
	if (left && !model->remainder.loads)
		return;
	if (scheme->holds_coupling && !model->remainder.loads)
		say_warning(scheme_place(b), NULL,
			    "scheme %s is of first order in h: this model is linear, and exact has no error",
			    scheme->name);
	else if (scheme->leaves && is_linear(b) && !curved_guard(b) && model->contacts.impacts < FEW)
		say_warning(scheme_place(b), NULL,
			    left ? "scheme %s approximates the loads: this model is linear, and exact has no error"
				 : "scheme %s has nothing to do: this model is linear, and exact covers it",
			    scheme->name);
}

/* Why what would be best is not taken */
static const char *passed_over(const char *why)
{
	if (!why)
		return "";
	return format("; %s%s", strncmp(why, "scheme ", 7) == 0 ? "" : "what would be best is refused: ", why);
}

/* Beside what is not piecewise linear a maximum over time is refused, so no note says to write it. */
static void say_falls(const struct node *friction, bool regions)
{
	say_warning(friction->start, regions ? "max(F, 0) in its place says so" : NULL,
		    "the force of friction may fall below 0: it counts as 0 there");
}

static void say_low(const struct node *friction, bool regions)
{
	say_warning(friction->start, regions ? "max(S, F) in the place of S says so" : NULL,
		    "what this friction holds may fall below its force: it counts as that force there");
}

/* Is it the first friction in regions that is written there and says this? */
static bool is_first(const struct switching *s, int index, bool low)
{
	const struct friction *f = s->friction;
	for (int i = 0; i < index; i++)
		if (f[i].atom->node == f[index].atom->node && (low ? f[i].low : f[i].negative))
			return false;
	return low ? f[index].low : f[index].negative;
}

/* Of a slider without mass that is none of regions, since a damper stands beside it; each is said once. */
static bool falls_beside_damper(const struct model *model, int index)
{
	const struct atom *atom = model->contacts.massless_slider[index].atom;
	bool other = never_falls_below(atom->operand[1]);
	for (int i = 0; i < index; i++)
		other = other || model->contacts.massless_slider[i].atom->node == atom->node;
	for (int i = 0; model->switching && i < model->switching->sliders; i++)
		other = other || model->switching->slider[i].atom->node == atom->node;
	return !other;
}

/* The force of friction is never below 0, nor above what is held. */
static void check_friction(const struct model *model)
{
	const struct switching *s = model->switching;
	for (int i = 0; s && i < s->frictions; i++) {
		if (is_first(s, i, false))
			say_falls(s->friction[i].atom->node, true);
		if (is_first(s, i, true))
			say_low(s->friction[i].atom->node, true);
	}
	for (int i = 0; s && i < s->sliders; i++)
		if (s->slider[i].negative && !is_repeated_slider(s, i))
			say_falls(s->slider[i].atom->node, true);
	for (int i = 0; i < model->contacts.massless_sliders; i++)
		if (falls_beside_damper(model, i))
			say_falls(model->contacts.massless_slider[i].atom->node, true);
	for (int i = 0; i < model->contacts.drags; i++) {
		const struct drag *drag = &model->contacts.drag[i];
		if (!never_falls_below(drag->force))
			say_falls(drag->atom->node, false);
		if (!never_falls_below(less_in_velocity(drag->rest, drag->force, drag->velocity)))
			say_low(drag->atom->node, false);
	}
}

/* A guard comes true by crossing. */
static void check_guards(struct building *b)
{
	const struct model *model = b->model;
	for (int i = 0; i < model->contacts.impacts; i++)
		for (int s = 1; s < model->system.segments; s++)
			if (closes_by_jump(b, &model->contacts.impact[i], s)) {
				say_warning(model->contacts.impact[i].when->guard->start,
					    "a load that goes there steeply takes along what it meets",
					    "this guard jumps at t = %s: where it comes true by that, nothing is met",
					    readable_text(model->system.change[s - 1]));
				break;
			}
}

/* Where T jumps, d/dt dT/dq' has an impulse, which keeps dT/dq'; the equations behind it go on with q'. */
static void check_kinetic_energy(const struct building *b)
{
	const struct segment_equations *of = b->segment_equations;
	const struct energy *energy = b->spec->lagrange.energy;
	for (int s = 1; s < b->model->system.segments && of[0].energy[0]; s++) {
		const struct form *jump = form_difference(of[s].energy[0], of[s - 1].energy[0]);
		SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
		bool certain = jump->terms > 0;
		for (const struct form_term **term = terms_within(jump, seen); *term; term++)
			certain = certain && (*term)->basis.kind != BASIS_FORCING;
		if (!certain)
			continue;
		while (energy->kind != 'T')
			energy++;
		say_warning(energy->at, "an impact by `when` gives q' another value",
			    "T jumps at t = %s: velocities go on there, and dT/dq' does not",
			    readable_text(b->model->system.change[s - 1]));
		return;
	}
}

/* No force comes of a jump with a coordinate: what is derived is each formula by itself. */
static void check_energies_meet(struct building *b)
{
	for (int k = 0; k < 2; k++) {
		const struct form *form = equations_of(b)->energy[k];
		const char *where = form ? jump_with_state(b, form) : NULL;
		const struct energy *energy = b->spec->lagrange.energy;
		while (where && energy->kind != "TV"[k])
			energy++;
		if (where)
			say_warning(energy->at,
				    "a constant in one formula makes them meet; an impact is written by `when`",
				    "%c jumps where %s, and no force comes of that", "TV"[k], where);
	}
}

struct passed { struct building *b; struct point *start; const struct impact *impact; };

static void check_start(void *context)
{
	const struct passed *p = context;
	const struct form *guard = form_at(p->start, p->impact->in->guard);
	RATIONAL by = ZERO;
	if (is_constant(guard))
		constant_value(&p->b->collector, guard, by);
	if (nearest_double(by) > 0x1p-40)
		say_warning(p->impact->when->at,
			    "it acts when the first stands before its gap again and comes up to it",
			    "this stop is passed by %s at the start", shortest(nearest_double(by)));
}

static void check_starts(struct building *b)
{
	struct passed passed = { b, point_at_state(b, b->model->initial, NULL), NULL };
	for (int i = 0; i < b->model->contacts.impacts; i++) {
		passed.impact = &b->model->contacts.impact[i];
		if (passed.impact->when->restitution)
			silent_guard(check_start, &passed);
	}
}

/* Other phases go on. */
static void check_phases(const struct model *model)
{
	const struct node *sine = model->params.leads.jumps;
	if (sine)
		say_note(sine->start, "the phase of '%s' jumps where tunable params change while the model runs: of t "
			 "times such params it goes on", text_between(sine->start, sine->end));
}

/* What a reader finds again by its first characters */
static const char *shortened(const char *text)
{
	enum { MOST = 80 };
	return strlen(text) > MOST ? format("%.*s...", MOST, text) : text;
}

void warn(struct building *b)
{
	const struct model *model = b->model;
	bool left = model->remainder.force_columns > 0;
	struct jacobian j = { .b = b };
	lint(b);
	left = left || curved_guard(b) || b->crowded;
	if (left && model->nonlinear.obstacle && b->spec->required.needs == 0)     /* else the scheme is chosen */
		say_note(model->nonlinear.obstacle->start, "scheme %s%s, not exact: '%s' %s%s",
			 scheme_name(model->scheme),
			 model->truncation.adaptive
				 ? format(", tolerance %s", shortest(round_rational(model->truncation.tolerance)))
				 : "",
			 shortened(text_between(model->nonlinear.obstacle->start, model->nonlinear.obstacle->end)),
			 model->nonlinear.why, passed_over(has_contacts(model) ? NULL : b->request->passed_over));
	check_phases(model);
	check_need(b, left);
	check_truncation(b);
	check_smoothness(b);
	check_friction(model);
	check_guards(b);
	check_starts(b);
	check_kinetic_energy(b);
	check_energies_meet(b);
	const struct scheme_row *scheme = scheme_row(model->scheme);
	/* in normal modes a step's spectral radius tells more */
	if (!left || !scheme->leaves || scheme->expands || scheme->modes || is_linear(b) ||
	    !silent_guard(jacobian_forms, &j))
		return;
	mpq_init(j.t);
	if (scheme->predicts)
		check_predictor(&j);
	else
		check_softness(&j);
	mpq_clear(j.t);
}
