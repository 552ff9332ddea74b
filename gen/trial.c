/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One step that is tried for needs that are measured: built, run beside a reference, counted. */
#include "measuring.h"

#include <math.h>
#include <stdlib.h>

/* Of a need: so far the two references agree. */
static const double known = 0.01;

/* ---- a step as asked for ---- */

static void build_now(void *context)
{
	struct measuring *m = context;
	struct spec *spec = parse_spec(m->model->spec->source);
	struct model *model = model_build(spec, &m->now);
	if (model && m->now.reduce)
		model = model_reduce(model);
	model = model ? model_shorten(model) : NULL;
	model = model ? stepped_model(model, spec, &m->now) : NULL;
	m->step = model ? step_build(model) : NULL;
	if (!m->step || !find_requirements(model))
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

/* Its C, ready to run */
struct running *running_of(struct measuring *m, const struct step *step, const char **why)
{
	const char *refused;
	struct running *r = running_new(m->model->requirement[0].need->at, step, WITH_RHS | WITH_COUNTS, &refused);
	(m->single ? target_float : target_double)();
	if (refused)
		*why = refused;
	return r;
}

/* ---- the reference ---- */

/* [rad/s] the fastest that a coordinate moves: its velocity's largest size over its own */
static double fastest_motion(const struct measuring *m)
{
	const struct linear *system = &m->model->written->system;
	double most = 0;
	for (int i = 0; i < system->n; i++) {
		const int v = system->velocity[i];
		if (v >= 0 && m->roads.size[i] > 0)
			most = fmax(most, m->roads.size[v] / m->roads.size[i]);
	}
	return most;
}

/* A pair of roads, and how far they are apart over what is needed; infinite: one comes to no end */
static double disagreement(struct measuring *m)
{
	struct course *course[ROADS] = { NULL };
	double worst = 0;
	for (int which = 0; which < ROADS; which++)
		course[which] = which && !course[0] ? NULL : road_of(&m->roads, which, NULL, &m->why);
	for (int i = 0; i < m->model->requirements && course[0] && course[1]; i++) {
		const struct requirement *r = &m->model->requirement[i];
		const long samples = (long)floor(mpq_get_d(r->until) / m->roads.h * (1 + 1e-14));
		m->largest[r->output] = fmax(m->drive ? m->largest[r->output] : 0,
					     largest_of(course[0], r->output, samples));
		const double needed = needed_error(r, m->largest[r->output]);
		const double over = apart(course[0], course[1], r->output, samples) / needed;
		worst = over <= worst ? worst : over;
	}
	bool both = course[0] && course[1];
	for (int which = 0; which < ROADS; which++)
		if (course[which])
			course_free(course[which]);
	return both ? worst : HUGE_VAL;
}

/* With all inputs that are tried; where they are apart with one the others are not looked at. */
static double disagreements(struct measuring *m)
{
	double worst = 0;
	for (int i = 0; i < m->drives && worst <= known; i++) {
		m->roads.drive = m->drive ? &m->drive[i] : NULL;
		worst = fmax(worst, disagreement(m));
	}
	return worst;
}

/* Sizes of the states first, roughly; then tolerances down to where the roads agree */
static bool find_tolerance(struct measuring *m)
{
	const size_t states = (size_t)m->model->written->system.states;
	double apart_at_best = HUGE_VAL;
	m->roads.h = m->drive ? m->drive->h : m->until / 64;
	m->roads.drive = m->drive;
	for (int pair = 0; pair < 2; pair++) {
		m->roads.stiff = pair > 0;
		m->roads.size = ARRAY(double, states);
		m->roads.tolerance = 1e-5;
		for (int again = 0; again < 2; again++) {
			struct course *rough = road_of(&m->roads, 0, NULL, &m->why);
			if (rough)
				course_free(rough);
		}
		for (double tolerance = 1e-8; tolerance > 1e-15; tolerance *= 0.01) {
			m->roads.tolerance = tolerance;
			const double found = disagreements(m);
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
	m->roads.changes = system->segments - 1;
	for (int k = 0; k < m->roads.changes; k++)
		change[k] = mpq_get_d(system->change[k]);
	m->roads.change = change;
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
		m->drive[i] = drive_of(system, i, w, count, h, (long)ceil(m->until / h), m->model->requirement[0].most);
}

bool open_reference(struct measuring *m)
{
	struct request as = *m->request;
	as.single = false;
	as.form = FORM_AUTO;
	struct step *step = built(m, &as, &m->why);
	m->roads = (struct roads){ .r = step ? running_of(m, step, &m->why) : NULL, .until = m->until,
				   .most = LIMIT_MEASURED / 4 };
	if (!m->roads.r)
		return false;
	find_drives(m, step);
	find_changes(m);
	if (!find_tolerance(m))
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
static struct course *kept_reference(struct measuring *m, struct roads *roads, int drive, const char **why)
{
	for (int i = 0; i < m->kept; i++)
		if (m->keeps[i].h == roads->h && m->keeps[i].drive == drive)
			return m->keeps[i].course;
	struct course *course = road_of(roads, 0, NULL, why);
	if (!course || course->samples * course->outputs > MOST_KEPT)
		return course;
	*MORE(m->keeps, m->kept) = (struct kept_course){ roads->h, drive, course };
	return course;
}

static void release(const struct measuring *m, struct course *course)
{
	for (int i = 0; i < m->kept; i++)
		if (m->keeps[i].course == course)
			return;
	course_free(course);
}

/* From this start, against a reference from there; the largest of error over need */
double tried_from(struct measuring *m, struct alternative *a, struct running *r, struct roads *roads,
		  const double *start, int drive, bool spec)
{
	roads->drive = m->drive ? &m->drive[drive] : NULL;
	struct course *reference = spec ? kept_reference(m, roads, drive, &a->why) : road_of(roads, 0, start, &a->why);
	if (!reference)
		return HUGE_VAL;
	struct trial trial = trial_of(r, reference, start, m->ends, roads->drive);
	const struct model *model = running_step_of(r)->model;
	double worst = 0;
	for (int i = 0; i < model->requirements; i++) {
		const struct requirement *q = &model->requirement[i];
		const long samples = (long)floor(mpq_get_d(q->until) / roads->h * (1 + 1e-14));
		const double largest = m->drive ? m->largest[q->output] : largest_of(reference, q->output, samples);
		struct certificate found = { .known = true, .rounding = trial.error[q->output],
					     .needed = needed_error(q, largest) };
		const double over = found.rounding / found.needed;
		worst = over <= worst ? worst : over;
		if (spec && !(found.rounding <= a->certificate[i].rounding && a->certificate[i].known))
			a->certificate[i] = found;
	}
	if (spec) {
		a->step_cost = cost_of_trial(&trial, model->target, model->asked.single);
		a->cost = a->step_cost / roads->h;
	}
	a->why = trial.why ? trial.why : a->why;
	release(m, reference);
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
	return !a->refused && !a->why && a->excess <= WITHIN && a->worst_neighbour <= WITHIN;
}

bool is_enough(const struct measuring *m, const struct alternative *a)
{
	return meets(a) && a->excess <= m->within;
}

/* From the spec's start, with all inputs that are tried */
static void try_inputs(struct measuring *m, struct alternative *a, struct running *r, struct roads *roads)
{
	a->excess = 0;
	a->inputs_tried = m->drive ? m->drives : 0;
	for (int i = 0; i < m->drives && isfinite(a->excess); i++) {
		const double excess = tried_from(m, a, r, roads, NULL, i, true);
		if (excess <= a->excess)
			continue;
		a->excess = excess;
		a->worst_input = i;
	}
}

void try_alternative(struct measuring *m, struct alternative *a)
{
	const struct request as = request_of(m, a);
	struct step *step = built(m, &as, &a->refused);
	struct running *r = step ? running_of(m, step, &a->refused) : NULL;
	a->measured = true;
	a->name = a->scheme && !step ? a->scheme : scheme_name((step ? step->model : m->model)->scheme);
	a->certificate = ARRAY(struct certificate, m->model->requirements);
	a->excess = HUGE_VAL;
	if (r) {
		struct roads roads = m->roads;
		roads.h = mpq_get_d(step->model->h);
		roads.most = LIMIT_MEASURED;
		if (m->until / roads.h > MOST_SAMPLES)
			a->why = format("%.0f steps are more than the %d that are measured", m->until / roads.h,
					MOST_SAMPLES);
		else
			try_inputs(m, a, r, &roads);
	}
	if (is_enough(m, a))
		m->cheapest = fmin(m->cheapest, a->cost);
	*MORE(m->choice->alternative, m->choice->alternatives) = *a;
}
