/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One step that is tried for needs that are measured: built, run beside a reference, counted, put in order. */
#include "measuring.h"
#include "model/checks.h"
#include "model/linear/modal_truncation.h"
#include "step/certify/certify.h"
#include "step/linear/images.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of a need: so far the two references agree. */
static const double known = 0.01;

/* ---- a step as asked for ---- */

static void build_now(void *context)
{
	struct measuring *m = context;
	struct spec *spec = parse_spec(m->model->spec->source);
	struct model *model = model_build(spec, &m->now);
	if (model)
		model = model_reduce(model);
	model = model ? model_truncate(model) : NULL;
	model = model ? stepped_model(model, spec, &m->now) : NULL;
	/* Requirements first: a step that stands aside, as `over` does, is built of a copy of the model. */
	m->step = model && find_requirements(model) ? step_build(model) : NULL;
	if (!m->step)
		abandon();
}

/* NULL: *why says why there is none */
struct step *built(struct measuring *m, const struct request *as, const char **why)
{
	m->now = *as;
	m->step = NULL;
	(as->single ? target_float : target_double)();
	const char *refused = unheard_refusal_of(build_now, m);
	(m->single ? target_float : target_double)();
	if (refused && why)
		*why = refused;
	return refused ? NULL : m->step;
}

struct ready ready_of(struct measuring *m, const struct request *as, const char **why)
{
	struct ready found = { .step = built(m, as, why), .as = *as, .solvers = m->solvers };
	const enum running_with with = m->stepped ? WITH_COUNTS : WITH_RHS | WITH_COUNTS;
	found.solvers.most = LIMIT_MEASURED;
	if (!found.step)
		return found;
	const char *refused;
	found.r = running_new(m->model->needs.requirement[0].need->at, found.step, with, &refused);
	found.solvers.h = mpq_get_d(found.step->model->h);
	(m->single ? target_float : target_double)();
	*why = refused ? refused : *why;
	return found;
}

/* ---- the reference ---- */

/* What has events, or constraints, is stepped from one to the next by a series, or by collocation. */
static struct course *stepped_reference(struct measuring *m, const struct ready *ready, int which, const double *start,
				   const char **why)
{
	struct request as = ready->as;
	as.single = false;
	as.form = FORM_AUTO;
	as.scheme = which ? "radau" : "taylor";
	as.tolerance = format("%.0e", ready->solvers.tolerance);
	as.step = shortest(ready->solvers.h);
	struct ready own = ready_of(m, &as, why);
	own.solvers = ready->solvers;
	own.solvers.r = own.r;
	return own.r ? stepped_course(&own.solvers, start, why) : NULL;
}

/* By the first solver or the second; NULL: *why */
static struct course *reference_course(struct measuring *m, struct ready *ready, int which, const double *start,
				const char **why)
{
	return m->stepped ? stepped_reference(m, ready, which, start, why)
			  : solved_course(&ready->solvers, which, start, why);
}

/* [rad/s] the fastest that a coordinate moves: its velocity's largest size over its own */
static double fastest_motion(const struct measuring *m)
{
	const struct linear *system = &m->model->written->system;
	double most = 0;
	for (int i = 0; i < system->n; i++) {
		const int v = system->velocity[i];
		if (v >= 0 && m->solvers.size[i] > 0)
			most = fmax(most, m->solvers.size[v] / m->solvers.size[i]);
	}
	return most;
}

/* A pair of solvers, and how far they are apart over what is needed; infinite: one comes to no end */
static double disagreement(struct measuring *m, struct ready *ready)
{
	struct course *course[SOLVERS] = { NULL };
	double worst = 0;
	for (int which = 0; which < SOLVERS; which++)
		course[which] = which && !course[0] ? NULL : reference_course(m, ready, which, NULL, &m->why);
	for (int i = 0; i < m->model->needs.requirements && course[0] && course[1]; i++) {
		const struct requirement *r = &m->model->needs.requirement[i];
		m->largest[i] = fmax(m->drive ? m->largest[i] : 0, largest_of(course[0], i));
		const double over = apart(course[0], course[1], i) / needed_error(r, m->largest[i]);
		worst = over <= worst ? worst : over;
	}
	bool both = course[0] && course[1];
	for (int which = 0; which < SOLVERS; which++)
		if (course[which])
			course_free(course[which]);
	return both ? worst : HUGE_VAL;
}

/* With all inputs that are tried; where they are apart with one the others are not looked at. */
static double disagreements(struct measuring *m, struct ready *ready)
{
	double worst = 0;
	for (int i = 0; i < m->drives && worst <= known; i++) {
		ready->solvers.drive = m->drive ? &m->drive[i] : NULL;
		worst = fmax(worst, disagreement(m, ready));
	}
	return worst;
}

/* Sizes of the states first, roughly; then tolerances down to where the solvers agree */
static bool find_tolerance(struct measuring *m, struct ready *ready)
{
	const size_t states = (size_t)m->model->written->system.states;
	struct solvers *solvers = &ready->solvers;
	double apart_at_best = HUGE_VAL;
	solvers->h = m->drive ? m->drive->h : m->until / 64;
	solvers->drive = m->drive;
	for (int pair = 0; pair < (m->stepped ? 1 : 2); pair++) {
		solvers->stiff = pair > 0;
		solvers->size = ARRAY(double, states);
		solvers->tolerance = 1e-5;
		for (int again = 0; again < 2; again++) {
			struct course *rough = reference_course(m, ready, 0, NULL, &m->why);
			if (rough)
				course_free(rough);
		}
		for (double tolerance = 1e-8; tolerance > 1e-15; tolerance *= 0.01) {
			solvers->tolerance = tolerance;
			const double found = disagreements(m, ready);
			if (found <= known)
				return true;
			apart_at_best = fmin(apart_at_best, found);
			if (!isfinite(found))
				break;
		}
	}
	if (isfinite(apart_at_best))
		m->why = format("two references differ by more than %swhat is needed: the motion is too sensitive to "
				"be known until then, or the need too fine",
				apart_at_best > 1 ? "" : "a hundredth of ");
	return false;
}

static void find_changes(struct measuring *m)
{
	const struct linear *system = &m->model->written->system;
	double *change = ARRAY(double, system->segments);
	m->solvers.changes = system->segments - 1;
	for (int k = 0; k < m->solvers.changes; k++)
		change[k] = mpq_get_d(system->change[k]);
	m->solvers.change = change;
}

/* [rad/s] of the linear operator, in rising order, as many as tell apart; else by length of time and of a step */
static int frequencies_of(const struct measuring *m, const struct step *step, double *w, int most)
{
	const double h = mpq_get_d(step->model->h);
	struct pole_report *pole;
	int count = 0;
	const int poles = m->model->switching ? 0 : poles_of(step->model, step->written, &pole);
	for (int i = 0; i < poles && count < most; i++) {
		const double found = fabs(mpfr_get_d(pole[i].im, MPFR_RNDN));
		if (found > 6 / m->until && found * h < 2 && (count == 0 || found > 1.01 * w[count - 1]))
			w[count++] = found;
	}
	for (; count == 0 || (poles == 0 && count < most); count++)
		w[count] = 12 / m->until * pow(m->until / h / 24, (count + 1.0) / (most + 1));
	return count;
}

static void find_drives(struct measuring *m, const struct step *step)
{
	enum { FREQUENCIES = 3 };
	const struct linear *system = &m->model->system;
	const double h = mpq_get_d(step->model->h);
	double w[FREQUENCIES];
	m->drives = 1;
	if (system->inputs == 0)
		return;
	const int count = frequencies_of(m, step, w, FREQUENCIES);
	m->drives = drive_kinds(count);
	m->drive = ARRAY(struct sampled, m->drives);
	for (int i = 0; i < m->drives; i++)
		m->drive[i] = drive_of(system, i, w, count, h, (long)ceil(m->until / h),
				       m->model->needs.requirement[0].most);
}

bool open_reference(struct measuring *m)
{
	struct request as = *m->request;
	as.single = false;
	as.form = FORM_AUTO;
	m->stepped = goes_by_events(m->model) || m->model->spec->count.multipliers > 0;
	struct ready ready = ready_of(m, &as, &m->why);
	m->solvers = (struct solvers){ .r = ready.r, .until = m->until, .most = LIMIT_MEASURED / 4 };
	if (!ready.r)
		return false;
	find_drives(m, ready.step);
	find_changes(m);
	ready.solvers = m->solvers;
	const bool found = find_tolerance(m, &ready);
	m->solvers = ready.solvers;
	if (!found)
		return false;
	const double fastest = fastest_motion(m);
	m->longest = fmin(m->until / 16, fastest > 0 ? 2 * 3.14159265358979 / fastest / 8 : m->until);
	return true;
}

/* ---- one candidate ---- */

/* Of a step and its outputs; a function of <math.h> counts as twenty multiplications */
static double cost_of_trial(const struct trial *t, const struct target *target, bool single)
{
	enum { CALL = 20 };
	const double products = t->multiplications + CALL * t->calls;
	if (!target)
		return (products + t->additions) * (single ? 1 : 2);
	return target->cost[single].multiplication * products + target->cost[single].addition * t->additions +
	       target->cost[single].step;
}

/* From the spec's start; it is kept where it is not too long */
static struct course *kept_reference(struct measuring *m, struct ready *ready, int drive, const char **why)
{
	const struct solvers *solvers = &ready->solvers;
	for (int i = 0; i < m->kept; i++)
		if (m->keeps[i].h == solvers->h && m->keeps[i].drive == drive)
			return m->keeps[i].course;
	struct course *course = reference_course(m, ready, 0, NULL, why);
	if (!course || course->samples * course->needs > MOST_KEPT)
		return course;
	course->kept = true;
	*MORE(m->keeps, m->kept) = (struct kept_course){ solvers->h, drive, course };
	return course;
}

double tried_from(struct measuring *m, struct alternative *a, struct ready *ready, const double *start, int drive,
		  bool spec)
{
	struct solvers *solvers = &ready->solvers;
	solvers->drive = m->drive ? &m->drive[drive] : NULL;
	struct course *reference = spec ? kept_reference(m, ready, drive, &a->why)
					: reference_course(m, ready, 0, start, &a->why);
	if (!reference)
		return m->stepped && !spec ? -1 : HUGE_VAL;
	struct trial trial = trial_of(ready->r, reference, start, solvers->drive);
	const struct model *model = ready->step->model;
	double worst = 0;
	for (int i = 0; i < model->needs.requirements; i++) {
		const double largest = m->drive ? m->largest[i] : largest_of(reference, i);
		struct certificate found = { .known = true, .rounding = trial.error[i],
					     .needed = needed_error(&model->needs.requirement[i], largest) };
		const double over = found.rounding / found.needed;
		worst = over <= worst ? worst : over;
		if (spec && !(found.rounding <= a->certificate[i].rounding && a->certificate[i].known))
			a->certificate[i] = found;
	}
	if (spec) {
		a->step_cost = cost_of_trial(&trial, model->needs.target, model->request.single);
		a->cost = a->step_cost / solvers->h;
	}
	a->why = trial.why ? trial.why : a->why;
	if (!reference->kept)
		course_free(reference);
	return trial.why ? HUGE_VAL : worst;
}

struct request request_of(const struct measuring *m, const struct alternative *a)
{
	struct request as = *m->request;
	as.scheme = a->scheme ? a->scheme : as.scheme;
	as.step = a->step ? a->step : as.step;
	as.tolerance = a->tolerance ? a->tolerance : as.tolerance;
	as.single = a->single;
	return as;
}

bool meets(const struct alternative *a)
{
	const double within = a->measured ? WITHIN : 1;
	return !a->refused && !a->why && a->error_ratio <= within && a->worst_neighbour <= within;
}

bool is_enough(const struct measuring *m, const struct alternative *a)
{
	return meets(a) && a->error_ratio <= m->within;
}

/* From the spec's start, with all inputs that are tried */
static void try_inputs(struct measuring *m, struct alternative *a, struct ready *ready)
{
	if (m->until / ready->solvers.h > MOST_SAMPLES) {
		a->why = format("%.0f steps are more than the %d that are measured", m->until / ready->solvers.h,
				MOST_SAMPLES);
		return;
	}
	a->error_ratio = 0;
	a->inputs_tried = m->drive ? m->drives : 0;
	for (int i = 0; i < m->drives && isfinite(a->error_ratio); i++) {
		const double error_ratio = tried_from(m, a, ready, NULL, i, true);
		if (error_ratio <= a->error_ratio)
			continue;
		a->error_ratio = error_ratio;
		a->worst_input = i;
	}
}

void try_alternative(struct measuring *m, struct alternative *a)
{
	const struct request as = request_of(m, a);
	struct ready ready = ready_of(m, &as, &a->refused);
	a->measured = true;
	a->name = ready.step  ? scheme_name(ready.step->model->scheme)
		  : a->scheme ? a->scheme : scheme_name(m->model->scheme);
	a->certificate = ARRAY(struct certificate, m->model->needs.requirements);
	a->error_ratio = HUGE_VAL;
	if (ready.r)
		try_inputs(m, a, &ready);
	if (is_enough(m, a))
		m->cheapest = fmin(m->cheapest, a->cost);
	*MORE(m->choice->alternative, m->choice->alternatives) = *a;
}

/* What was not measured has no cost. */
static int by_cost(const void *left, const void *right)
{
	const struct alternative *a = left, *b = right;
	const bool no_a = a->refused || (a->measured && a->cost == 0),
		   no_b = b->refused || (b->measured && b->cost == 0);
	if (no_a != no_b)
		return no_a ? 1 : -1;
	if (a->cost != b->cost)
		return a->cost < b->cost ? -1 : 1;
	if (a->measured)
		return strcmp(a->name, b->name);
	if (a->error_ratio != b->error_ratio)
		return a->error_ratio < b->error_ratio ? -1 : 1;
	if (a->single != b->single)
		return a->single ? -1 : 1;
	if (a->compensated != b->compensated)
		return a->compensated ? 1 : -1;
	return (int)a->form - (int)b->form;
}

const struct alternative *most_exact(const struct choice *choice, double most)
{
	const struct alternative *best = NULL;
	for (int i = 0; i < choice->alternatives; i++) {
		const struct alternative *a = &choice->alternative[i];
		if (!a->refused && !a->why && a->cost <= most && (!best || a->error_ratio < best->error_ratio))
			best = a;
	}
	return best;
}

void sort_by_cost(struct choice *choice)
{
	qsort(choice->alternative, (size_t)choice->alternatives, sizeof *choice->alternative, by_cost);
}
