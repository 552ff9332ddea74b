/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Needs of models that no bound is known for: what is not linear, or piecewise linear. Schemes, steps and tolerances
 * that the spec leaves open are tried: the C of each runs beside a reference of the equations as written, from the
 * spec's start and from its neighbours, and the cheapest that meets all needs is taken. It is measured, not
 * certified. */
#include "command.h"
#include "run/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_TRIED = 9, MOST_SAMPLES = 2000000, MOST_KEPT = 4000000 };
/* Of a need: the two references agree to `known`, so much is left for the step that is tried. */
static const double known = 0.01, within = 0.99;
/* No step is tried that is likely to cost so many times what the cheapest costs that met all needs. */
static const double dear = 2;

struct kept_course { double h; struct course *course; };

struct measuring {
	struct model *model;        /* as it was built at first: its requirements */
	const struct request *request;
	struct request now;         /* of the candidate being built */
	struct step *step;
	bool single;                /* the target's type; a reference is in double */
	double until;               /* [s] the last end of a need */
	double *ends;               /* per output: the last of its needs; below 0: none */
	double *largest;            /* per output: of the reference */
	struct roads roads;
	double longest;             /* [s] a step is not above this where it is open */
	struct choice *choice;
	double cheapest;            /* of what has met the needs from the spec's start; infinite: nothing has */
	int kept;                   /* references from the spec's start */
	struct kept_course *keeps;
	const char *why;            /* no reference; NULL: there is one */
	bool amplitudes_known;
	int amplitudes;             /* params that nothing but loads follows from */
	const struct symbol **amplitude;
};

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
static struct step *built(struct measuring *m, const struct request *as, const char **why)
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

struct opening { struct place at; const struct step *step; struct running *running; };

static void open_running(void *context)
{
	struct opening *o = context;
	o->running = running_new(code_of_step(o->at, o->step), o->step);
}

/* Its C, ready to run */
static struct running *running_of(struct measuring *m, const struct step *step, const char **why)
{
	struct opening o = { m->model->requirement[0].need->at, step, NULL };
	(step->model->asked.single ? target_float : target_double)();
	const char *refused = unheard_refusal_of(open_running, &o);
	(m->single ? target_float : target_double)();
	if (refused)
		*why = refused;
	return refused ? NULL : o.running;
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
static double disagreement(struct measuring *m, const double *start)
{
	struct course *course[ROADS] = { NULL };
	double worst = 0;
	for (int which = 0; which < ROADS; which++)
		course[which] = which && !course[0] ? NULL : road_of(&m->roads, which, start, &m->why);
	for (int i = 0; i < m->model->requirements && course[0] && course[1]; i++) {
		const struct requirement *r = &m->model->requirement[i];
		const long samples = (long)floor(mpq_get_d(r->until) / m->roads.h * (1 + 1e-14));
		m->largest[r->output] = largest_of(course[0], r->output, samples);
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

/* Sizes of the states first, roughly; then tolerances down to where the roads agree */
static bool find_tolerance(struct measuring *m)
{
	const size_t states = (size_t)m->model->written->system.states;
	double apart_at_best = HUGE_VAL;
	m->roads.h = m->until / 64;
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
			const double found = disagreement(m, NULL);
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
	double *change = ARRAY(double, (size_t)system->segments);
	m->roads.changes = system->segments - 1;
	for (int k = 0; k < m->roads.changes; k++)
		change[k] = mpq_get_d(system->change[k]);
	m->roads.change = change;
}

static bool open_reference(struct measuring *m)
{
	struct request as = *m->request;
	as.single = false;
	as.form = FORM_AUTO;
	struct step *step = built(m, &as, &m->why);
	m->roads = (struct roads){ .r = step ? running_of(m, step, &m->why) : NULL, .until = m->until,
				   .most = LIMIT_MEASURED / 4 };
	if (!m->roads.r)
		return false;
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
static struct course *kept_reference(struct measuring *m, struct roads *roads, const char **why)
{
	for (int i = 0; i < m->kept; i++)
		if (m->keeps[i].h == roads->h)
			return m->keeps[i].course;
	struct course *course = road_of(roads, 0, NULL, why);
	if (!course || course->samples * course->outputs > MOST_KEPT)
		return course;
	ENLARGE(m->keeps, (size_t)m->kept + 1);
	m->keeps[m->kept++] = (struct kept_course){ roads->h, course };
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
static double tried_from(struct measuring *m, struct alternative *a, struct running *r, struct roads *roads,
			 const double *start, bool spec)
{
	struct course *reference = spec ? kept_reference(m, roads, &a->why) : road_of(roads, 0, start, &a->why);
	if (!reference)
		return HUGE_VAL;
	struct trial trial = trial_of(r, reference, start, m->ends);
	const struct model *model = running_step_of(r)->model;
	double worst = 0;
	for (int i = 0; i < model->requirements; i++) {
		const struct requirement *q = &model->requirement[i];
		const long samples = (long)floor(mpq_get_d(q->until) / roads->h * (1 + 1e-14));
		struct certificate found = { .known = true, .rounding = trial.error[q->output],
					     .needed = needed_error(q, largest_of(reference, q->output, samples)) };
		const double over = found.rounding / found.needed;
		worst = over <= worst ? worst : over;
		if (spec)
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

static struct request request_of(const struct measuring *m, const struct alternative *a)
{
	struct request as = *m->request;
	as.scheme = a->scheme ? a->scheme : as.scheme;
	as.step = a->step ? a->step : as.step;
	as.tolerance = a->tolerance ? a->tolerance : as.tolerance;
	as.single = a->single;
	return as;
}

static bool meets(const struct alternative *a)
{
	return !a->refused && !a->why && a->excess <= within && a->worst_neighbour <= within;
}

static void try_alternative(struct measuring *m, struct alternative *a)
{
	const struct request as = request_of(m, a);
	struct step *step = built(m, &as, &a->refused);
	struct running *r = step ? running_of(m, step, &a->refused) : NULL;
	a->measured = true;
	a->name = a->scheme && !step ? a->scheme : scheme_name((step ? step->model : m->model)->scheme);
	a->certificate = ARRAY(struct certificate, (size_t)m->model->requirements);
	a->excess = HUGE_VAL;
	if (r) {
		struct roads roads = m->roads;
		roads.h = mpq_get_d(step->model->h);
		roads.most = LIMIT_MEASURED;
		if (m->until / roads.h > MOST_SAMPLES)
			a->why = format("%.0f steps are more than the %d that are measured", m->until / roads.h,
					MOST_SAMPLES);
		else
			a->excess = tried_from(m, a, r, &roads, NULL, true);
	}
	if (meets(a))
		m->cheapest = fmin(m->cheapest, a->cost);
	ENLARGE(m->choice->alternative, (size_t)m->choice->alternatives + 1);
	m->choice->alternative[m->choice->alternatives++] = *a;
}

/* ---- steps and tolerances of a scheme ---- */

static struct alternative tried_step(struct measuring *m, struct alternative a, double h)
{
	a.step = round_step(h);
	try_alternative(m, &a);
	return a;
}

/* The longest step that meets the needs: from the error of one the next is guessed by the scheme's order. */
static void try_steps(struct measuring *m, struct alternative a)
{
	enum scheme scheme = SCHEME_EXACT;
	scheme_of(a.scheme ? a.scheme : scheme_name(m->model->scheme), &scheme);
	const int order = scheme_row(scheme)->order > 0 ? scheme_row(scheme)->order : 4;
	double h = m->longest, missing = HUGE_VAL, meeting = 0;
	int refused = 0;
	for (int tried = 0; tried < MOST_TRIED; tried++) {
		const double now = strtod(round_step(h), NULL);
		const struct alternative one = tried_step(m, a, h);
		const double excess = one.excess;
		if (one.refused && ++refused == 2)              /* a step that is too long for it may be one reason */
			return;
		if (meets(&one))
			meeting = fmax(meeting, now);
		else
			missing = fmin(missing, now);
		const double by = isfinite(excess) ? pow(0.9 / excess, 1.0 / order) : 0.2;
		if (meeting == 0)
			h = now * fmax(fmin(by, 0.6), 0.02);
		else if (missing == HUGE_VAL)
			return;
		else
			h = meeting * 2.6;
		const double next = strtod(round_step(h), NULL);
		if (one.cost * now / next > dear * m->cheapest)
			return;
		if (next >= missing || next == meeting || m->until / next > MOST_SAMPLES)
			return;
	}
}

static bool is_written(const char *option, const void *spec)
{
	return option || spec;
}

static void try_scheme(struct measuring *m, const char *scheme)
{
	static const char *const tolerances[] = { "1e-3", "1e-4", "1e-5", "1e-6", "1e-7", "1e-8", "1e-9", "1e-10",
						  "1e-11", "1e-12", "1e-13" };
	const struct spec *spec = m->model->spec;
	enum scheme row = m->model->scheme;
	if (scheme)
		scheme_of(scheme, &row);
	const bool step_open = m->request->step_open;
	struct alternative a = { .scheme = scheme, .single = m->request->single, .form = FORM_DIRECT };
	if (!scheme_row(row)->expands || is_written(m->request->tolerance, spec->tolerance)) {
		if (step_open)
			try_steps(m, a);
		else
			try_alternative(m, &a);
		return;
	}
	for (size_t i = 0; i < sizeof tolerances / sizeof *tolerances; i++) {
		struct alternative one = a;
		one.tolerance = tolerances[i];
		if (step_open)
			one = tried_step(m, one, m->longest);
		else
			try_alternative(m, &one);
		if (one.refused || meets(&one) || one.cost > dear * m->cheapest)
			return;
	}
}

/* ---- neighbours ---- */

static const char *value_of_param(const struct measuring *m, const struct symbol *s)
{
	const size_t length = strlen(s->name);
	for (int i = m->request->definitions; i-- > 0;) {
		const char *text = m->request->definition[i];
		if (strncmp(text, s->name, length) == 0 && text[length] == '=')
			return text + length + 1;
	}
	return s->value ? text_between(s->value->start, s->value->end) : NULL;
}

static struct request with_param(const struct measuring *m, struct request as, const struct symbol *s, const char *by)
{
	const char **definition = ARRAY(const char *, (size_t)as.definitions + 1);
	for (int i = 0; i < as.definitions; i++)
		definition[i] = as.definition[i];
	definition[as.definitions++] = format("%s=%s*(%s)", s->name, by, value_of_param(m, s));
	as.definition = definition;
	return as;
}

static void find_amplitudes(struct measuring *m, const struct alternative *a)
{
	const struct request as = request_of(m, a);
	const struct step *here = built(m, &as, NULL);
	if (m->amplitudes_known)
		return;
	m->amplitudes_known = true;
	if (!here || here->model->switching)            /* of regions the loads stand in all systems: not looked at */
		return;
	for (const struct symbol *s = m->model->spec->first; s; s = s->next) {
		if (s->kind != SYMBOL_PARAM || !value_of_param(m, s) || m->amplitudes == 16)
			continue;
		const struct request other = with_param(m, as, s, "1.1");
		const struct step *there = built(m, &other, NULL);
		if (!there || !differ_in_loads(here->model, there->model))
			continue;
		ENLARGE(m->amplitude, (size_t)m->amplitudes + 1);
		m->amplitude[m->amplitudes++] = s;
	}
}

static void name_neighbour(struct alternative *a, const char *name)
{
	a->neighbour_names = a->neighbour_names ? format("%s, %s", a->neighbour_names, name) : name;
}

/* From a neighbour: excess of the worst is kept, and what it was */
static void keep_worst(struct alternative *a, double excess, const char *what)
{
	a->neighbours++;
	if (excess <= a->worst_neighbour)
		return;
	a->worst_neighbour = excess;
	a->worst_name = what;
}

static void try_starts(struct measuring *m, struct alternative *a, struct running *r, struct roads *roads)
{
	const struct model *written = m->model->written;
	const int states = written->system.states;
	double *start = ARRAY(double, (size_t)states);
	running_start(m->roads.r, 0, NULL);
	running_state(m->roads.r, start);
	for (int i = 0; i < states; i++) {
		if (start[i] != 0)
			name_neighbour(a, written->state_name[i]);
		for (int up = 0; up < 2 && start[i] != 0; up++) {
			const double as_written = start[i];
			start[i] *= up ? 1.1 : 0.9;
			struct alternative copy = *a;
			keep_worst(a, tried_from(m, &copy, r, roads, start, false),
				   format("%s = %.3g at the start", written->state_name[i], start[i]));
			start[i] = as_written;
		}
	}
}

static void try_amplitudes(struct measuring *m, struct alternative *a)
{
	for (int k = 0; k < 2 * m->amplitudes; k++) {
		const struct symbol *s = m->amplitude[k / 2];
		const char *why = NULL, *by = k % 2 ? "1.1" : "0.9";
		if (k % 2)
			name_neighbour(a, s->name);
		struct request as = with_param(m, request_of(m, a), s, by), wide = as;
		struct alternative copy = *a;
		wide.single = false;
		struct step *step = built(m, &as, &why), *reference = built(m, &wide, &why);
		struct running *r = step ? running_of(m, step, &why) : NULL;
		struct roads roads = m->roads;
		roads.r = reference ? running_of(m, reference, &why) : NULL;
		if (!r || !roads.r)
			continue;
		roads.h = mpq_get_d(step->model->h);
		roads.most = LIMIT_MEASURED;
		keep_worst(a, tried_from(m, &copy, r, &roads, NULL, false), format("%s times %s", s->name, by));
	}
}

static void try_neighbours(struct measuring *m, struct alternative *a)
{
	const struct request as = request_of(m, a);
	struct step *step = built(m, &as, &a->why);
	struct running *r = step ? running_of(m, step, &a->why) : NULL;
	struct roads roads = m->roads;
	if (!r)
		return;
	roads.h = mpq_get_d(step->model->h);
	roads.most = LIMIT_MEASURED;
	try_starts(m, a, r, &roads);
	find_amplitudes(m, a);
	try_amplitudes(m, a);
}

/* ---- the choice ---- */

static void try_schemes(struct measuring *m)
{
	const struct spec *spec = m->model->spec;
	if (m->request->scheme || spec->scheme) {
		try_scheme(m, NULL);
		return;
	}
	if (m->model->switching)
		try_scheme(m, scheme_name(SCHEME_EXACT));
	/* What is likely to do comes first: what is dearer is not tried. */
	for (int likely = 1; likely >= 0; likely--)
		for (int i = 0; i < SCHEMES; i++) {
			const struct scheme_row *row = scheme_row((enum scheme)i);
			if (row->leaves && likely == (row->by_default || (row->expands && !row->collocates)))
				try_scheme(m, row->name);
		}
}

static int by_cost(const void *left, const void *right)
{
	const struct alternative *a = left, *b = right;
	const bool no_a = a->refused || a->cost == 0, no_b = b->refused || b->cost == 0;
	if (no_a != no_b)
		return no_a ? 1 : -1;
	if (a->cost != b->cost)
		return a->cost < b->cost ? -1 : 1;
	return strcmp(a->name, b->name);
}

static void find_taken(struct measuring *m)
{
	struct choice *choice = m->choice;
	choice->taken = -1;
	for (int i = 0; i < choice->alternatives && choice->taken < 0; i++) {
		struct alternative *a = &choice->alternative[i];
		if (!meets(a))
			continue;
		try_neighbours(m, a);
		if (meets(a))
			choice->taken = i;
	}
}

static void tell_unmet(const struct measuring *m)
{
	const struct alternative *best = NULL, *any = NULL;
	const struct place at = m->model->requirement[0].need->at;
	for (int i = 0; i < m->choice->alternatives; i++) {
		const struct alternative *a = &m->choice->alternative[i];
		any = any ? any : a;
		if (!a->refused && !a->why && (!best || a->excess < best->excess))
			best = a;
	}
	if (!best)
		say_error(at, NULL, "the need cannot be measured: %s",
			  any ? (any->refused ? any->refused : any->why) : "there is no scheme for the model");
	else if (best->excess <= within)
		say_error(at, NULL,
			  "the need cannot be met: %s meets it from the spec's start, and misses it by a factor of "
			  "%.3g where %s", alternative_text(best), best->worst_neighbour, best->worst_name);
	else
		say_error(at, m->request->step_open ? NULL : "without 'step' one is chosen",
			  "the need cannot be met: the best that was measured, %s, misses it by a factor of %.3g",
			  alternative_text(best), best->excess);
}

static bool is_over_budget(const struct measuring *m, const struct alternative *taken)
{
	if (!m->model->target || taken->step_cost <= m->model->budget)
		return false;
	say_error(m->model->spec->budget.at, "a shorter step of a scheme of lower order may take fewer each",
		  "over budget: the cheapest that meets the need takes some %.0f instructions a step (%s), %.0f more "
		  "than %.0f", taken->step_cost, alternative_text(taken), taken->step_cost - m->model->budget,
		  m->model->budget);
	return true;
}

static void find_ends(struct measuring *m)
{
	m->ends = ARRAY(double, (size_t)m->model->outputs + 1);
	m->largest = ARRAY(double, (size_t)m->model->outputs + 1);
	for (int i = 0; i < m->model->outputs; i++)
		m->ends[i] = -1;
	for (int i = 0; i < m->model->requirements; i++) {
		const struct requirement *r = &m->model->requirement[i];
		m->ends[r->output] = fmax(m->ends[r->output], mpq_get_d(r->until));
		m->until = fmax(m->until, m->ends[r->output]);
	}
}

struct step *choose_measured(struct model *stepped, struct request *request)
{
	struct measuring m = { .model = stepped, .request = request, .single = request->single,
			       .choice = NEW(struct choice), .cheapest = HUGE_VAL };
	const struct place at = stepped->spec->need[0].at;
	if (!find_requirements(stepped))
		return NULL;
	find_ends(&m);
	if (!(m.until > 0)) {
		say_error(at, NULL, "a need that is measured ends after 0");
		return NULL;
	}
	if (!open_reference(&m)) {
		say_error(at, NULL, "the need cannot be measured: %s", m.why);
		return NULL;
	}
	try_schemes(&m);
	qsort(m.choice->alternative, (size_t)m.choice->alternatives, sizeof *m.choice->alternative, by_cost);
	find_taken(&m);
	if (m.choice->taken < 0) {
		tell_unmet(&m);
		return NULL;
	}
	const struct alternative *taken = &m.choice->alternative[m.choice->taken];
	if (is_over_budget(&m, taken))
		return NULL;
	*request = request_of(&m, taken);
	struct step *step = built(&m, request, &m.why);
	if (step)
		step->choice = m.choice;
	return step;
}
