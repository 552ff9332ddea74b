/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a spec with needs leaves open - float or double, two words, the form of the step, modes that are kept - is
 * tried, and the cheapest that meets all needs is taken. What is written or asked for is kept.
 *
 * Modes are dropped from the least share on. What the outputs lose is known for each number of modes at once; the
 * steps that are tried are those of the fewest modes that lose less than is needed, of one less, which shows what that
 * would miss, and of a few more, which leave more of the need to rounding. Of many states only steps of modes are
 * tried, where there are such. Where all modes are kept the states are those that were written. */
#include "measuring.h"
#include "model/checks.h"
#include "model/linear/modal_truncation.h"
#include "report/report.h"
#include "step/certify/certify.h"
#include "step/cost.h"
#include "step/linear/images.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MORE_MODES = 3 };            /* than the fewest that lose less than is needed */

struct variant {                    /* a model to step: all modes, or some of them */
	struct model *model;
	double *dropped;            /* per requirement */
	struct step *states, *modes; /* in double: the numbers of a step of states, of modes; NULL: there is none */
};
struct choosing {
	struct model *written, *stepped;
	const struct request *request;
	struct choice *choice;
	double *largest;            /* per requirement: what the exact output surely reaches */
	struct course *exact;       /* NULL: there is none to walk beside */
	struct variant *variant;
	struct alternative *now;
	struct step *step;
	bool trying;                /* without what no need asks for */
};

/* ---- one alternative ---- */

static void ask(const struct choosing *c, struct model *model)
{
	const struct alternative *a = c->now;
	model->request.again.trial = c->trying;
	model->request.single = a->single;
	model->request.compensated = a->compensated;
	model->request.form = a->form;
	model->request.at.form = (struct place){ source_argument(step_form_name(a->form)), 0 };
}

static void ask_now(const struct choosing *c)
{
	ask(c, c->written);
	ask(c, c->now->model);
	(c->now->single ? target_float : target_double)();
}

static void build_now(void *context)
{
	struct choosing *c = context;
	ask_now(c);
	c->step = step_build(c->now->model);
	if (!c->step)
		abandon();
}

/* Two words take these forms only. */
static bool stands_alone(const struct alternative *a)
{
	return !a->compensated || a->form == FORM_DELTA || a->form == FORM_KICK_DRIFT_KICK;
}

static void certify(struct choosing *c)
{
	struct alternative *a = c->now;
	const struct step *exact = c->step->modal ? c->variant->modes : c->variant->states;
	a->certificate = ARRAY(struct certificate, c->stepped->needs.requirements);
	a->cost = cost_of_step(c->step, c->stepped->needs.target);
	for (int i = 0; i < c->stepped->needs.requirements; i++) {
		const struct requirement *r = &c->stepped->needs.requirement[i];
		struct certificate *found = &a->certificate[i];
		*found = exact ? certificate_of(c->step, exact, r)
			       : (struct certificate){ .why = "the numbers of its step are not known in double" };
		found->dropped = c->variant->dropped[i];
		found->needed = needed_error(r, c->largest[i]);
		a->why = a->why ? a->why : found->why;
		if (found->known)
			a->error_ratio = fmax(a->error_ratio, error_reported(found) / found->needed);
	}
	a->bound_error_ratio = a->why ? HUGE_VAL : a->error_ratio;
}

/* Whether it is surely as exact as needed */
static bool try_one(struct choosing *c, bool single, bool compensated, enum step_form form)
{
	struct alternative *a = c->now = NEW(struct alternative);
	*a = (struct alternative){ .single = single, .compensated = compensated, .form = form,
				   .model = c->variant->model };
	if (!stands_alone(a))
		return false;
	a->refused = refusal_of(build_now, c);
	a->made = c->step;
	if (!a->refused)
		certify(c);
	else if (a->model->reduction.truncated && !c->written->reduction.truncated)
		return false;           /* as of all modes, which are tried too */
	*MORE(c->choice->alternative, c->choice->alternatives) = *a;
	return !a->refused && a->bound_error_ratio <= 1;
}

/* By modes alone: the plainest step shows it. */
static bool loses_too_much(const struct choosing *c)
{
	bool loses = false;
	for (int i = 0; i < c->stepped->needs.requirements; i++)
		loses = loses ||
			c->variant->dropped[i] > needed_error(&c->stepped->needs.requirement[i], c->largest[i]);
	return loses;
}

/* ---- all of one model ---- */

static struct step *step_of(struct choosing *c, struct model *model, enum step_form form)
{
	c->now = NEW(struct alternative);
	c->now->form = form;
	c->now->model = model;
	c->step = NULL;
	return refusal_of(build_now, c) ? NULL : c->step;
}

static void try_form(struct choosing *c, enum step_form form)
{
	const struct request *request = c->request;
	for (int precision = 0; precision < 2; precision++) {
		const bool single = precision == 0;
		if (request->real_given && request->single != single)
			continue;
		const bool exact = !request->compensated && try_one(c, single, false, form);
		if (request->compensated || !(exact || loses_too_much(c)))
			try_one(c, single, true, form);         /* which is dearer */
	}
}

/* Its steps of states cost so much more than those of modes that only these are tried. */
static bool is_large(const struct model *model)
{
	return model->system.states > LIMIT_UNROLLED_STATES && !model->reduction.truncated;
}

static void try_forms(struct choosing *c)
{
	static const enum step_form forms[] = { FORM_DIRECT, FORM_DELTA, FORM_KICK_DRIFT_KICK, FORM_MODAL };
	const struct variant *v = c->variant;
	const bool requested = c->request->form != FORM_AUTO, modes = v->model->reduction.truncated;
	for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
		const bool needless = (forms[i] == FORM_MODAL ? modes : is_large(v->model) && v->modes) ||
				      (forms[i] != FORM_DIRECT && modes && !c->request->compensated &&
				       loses_too_much(c));
		if (requested ? c->request->form == forms[i] : !needless)
			try_form(c, forms[i]);
	}
}

static struct variant *variant_of(struct choosing *c, struct model *model)
{
	struct variant *v = NEW(struct variant);
	v->model = model;
	v->dropped = ARRAY(double, c->stepped->needs.requirements);
	if (!model->reduction.truncated || c->request->form == FORM_MODAL)
		v->modes = step_of(c, model, FORM_MODAL);
	if (!is_large(model) || !v->modes || c->request->form != FORM_AUTO)
		v->states = step_of(c, model, FORM_DIRECT);
	return v;
}

/* ---- fewer modes ---- */

struct dropping {
	struct modes *modes;
	const int *order;
	bool static_correction;
	double **lost;              /* per requirement, per number of modes kept */
};

static bool loses_less(const struct choosing *c, const struct dropping *d, int count)
{
	bool less = true;
	for (int i = 0; i < c->stepped->needs.requirements; i++)
		less = less && d->lost[i][count] <= needed_error(&c->stepped->needs.requirement[i], c->largest[i]);
	return less;
}

/* As many modes as are asked for first */
static struct model *model_of_modes(const struct dropping *d, int count)
{
	bool *kept = ARRAY(bool, d->modes->count);
	for (int i = 0; i < count; i++)
		kept[d->order[i]] = true;
	target_double();
	return modes_kept(d->modes, kept, d->static_correction);
}

static void try_modes(struct choosing *c, const struct dropping *d, int count)
{
	struct model *model = model_of_modes(d, count);
	if (!model)
		return;
	c->variant = variant_of(c, model);
	for (int i = 0; i < c->stepped->needs.requirements; i++)
		c->variant->dropped[i] = d->lost[i][count];
	try_forms(c);
}

/* Per need: how far its C is off as it runs beside the exact outputs; NULL: it cannot run, or leaves the finite
 * numbers */
static const double *walk_beside(const struct choosing *c, const struct step *step)
{
	const char *why;
	struct running *r = running_new(c->stepped->needs.requirement[0].need->at, step, 0, &why);
	const struct trial trial = r ? trial_of(r, c->exact, NULL, NULL) : (struct trial){ .why = why };
	return trial.why ? NULL : trial.error;
}

/* Where loads change their formula: as walked in double, from one mode on to a few more than are enough */
static void walk_truncation_errors(struct choosing *c, struct dropping *d)
{
	const int requirements = c->stepped->needs.requirements, all = d->modes->count;
	for (int i = 0; i < requirements; i++)
		d->lost[i] = ARRAY(double, all + 1);
	for (int count = 0, more = MORE_MODES; count < all && more >= 0; count++) {
		struct model *model = count > 0 ? model_of_modes(d, count) : NULL;
		const struct step *step = model && c->exact ? step_of(c, model, FORM_DIRECT) : NULL;
		const double *error = step ? walk_beside(c, step) : NULL;
		for (int i = 0; i < requirements; i++)
			d->lost[i][count] = error ? error[i] : HUGE_VAL;
		more -= loses_less(c, d, count);
	}
}

static void drop_modes(struct choosing *c, struct dropping *d)
{
	const int requirements = c->stepped->needs.requirements, all = d->modes->count;
	target_double();
	d->lost = ARRAY(double *, requirements);
	for (int i = 0; i < requirements && !loads_change(&c->stepped->system); i++)
		d->lost[i] = truncation_errors_of(d->modes, d->order, d->static_correction,
						  &c->stepped->needs.requirement[i]);
	if (loads_change(&c->stepped->system))
		walk_truncation_errors(c, d);
	int fewest = all;
	while (fewest > 1 && loses_less(c, d, fewest - 1))
		fewest--;
	for (int count = fewest > 1 ? fewest - 1 : fewest; count <= fewest + MORE_MODES && count < all; count++)
		try_modes(c, d, count);
}

static void try_fewer(struct choosing *c)
{
	const char *why;
	struct model *whole = NEW(struct model);
	*whole = *c->written;           /* whose coordinates are the written ones */
	if (c->written->written == c->written)
		whole->written = whole;
	c->now = NEW(struct alternative);
	c->now->form = FORM_AUTO;
	ask(c, whole);
	whole->needs.requirements = c->stepped->needs.requirements;
	whole->needs.requirement = c->stepped->needs.requirement;
	whole->needs.target = c->stepped->needs.target;
	whole->needs.budget = c->stepped->needs.budget;
	target_double();
	struct modes *modes = whole->declared_outputs ? modes_of(whole, &why) : NULL;
	if (!modes || modes->count < 2)
		return;
	for (int static_correction = 0; static_correction <= is_driven(&whole->system); static_correction++)
		drop_modes(c, &(struct dropping){ .modes = modes, .order = modes_by_share(modes),
						  .static_correction = static_correction });
}

/* What the modes that are written to be dropped lose */
static void count_written(struct choosing *c)
{
	const struct modal_truncation *s = c->written->reduction.truncated;
	struct modes *modes = (struct modes *)(uintptr_t)s->modes;
	int *order = ARRAY(int, modes->count), kept = 0;
	for (int which = 1; which >= 0; which--)
		for (int i = 0; i < modes->count; i++)
			if (s->kept[i] == which)
				order[kept++] = i;
	kept = 0;
	for (int i = 0; i < modes->count; i++)
		kept += s->kept[i];
	target_double();
	for (int i = 0; i < c->stepped->needs.requirements && kept < modes->count; i++)
		c->variant->dropped[i] =
			truncation_errors_of(modes, order, s->static_correction,
					     &c->stepped->needs.requirement[i])[kept];
}

/* ---- as walked ---- */

/* A bound may be some thousand times what rounding comes to; what is lost with modes is exact. */
static bool is_hopeful(const struct choosing *c, const struct alternative *a)
{
	static const double too_large = 1e5;
	bool hopeful = !a->refused;
	for (int i = 0; i < c->stepped->needs.requirements && hopeful; i++) {
		const struct certificate *found = &a->certificate[i];
		hopeful = !found->known || (found->dropped <= found->needed &&
					    found->rounding <= too_large * found->needed);
	}
	return hopeful;
}

static void walk(struct choosing *c, struct alternative *a)
{
	c->now = a;
	ask_now(c);
	const double *error = walk_beside(c, a->made);
	if (!error)
		return;
	a->why = NULL;
	a->error_ratio = 0;
	for (int i = 0; i < c->stepped->needs.requirements; i++) {
		a->certificate[i].walked = true;
		a->certificate[i].error = error[i];
		a->error_ratio = fmax(a->error_ratio, error[i] / a->certificate[i].needed);
	}
	a->as_written = a->error_ratio <= 1 && a->bound_error_ratio > 1;
}

/* Of operations, roughly: those of its run, and what reading its C takes */
static double work_of_walk(const struct choosing *c, const struct alternative *a)
{
	enum { READING = 200 };
	return a->cost * ((double)c->exact->samples + READING * (double)a->model->system.states);
}

/* The cheapest first, up to the one that is taken; of the others as many as are no work */
static void walk_all(struct choosing *c)
{
	static const double spare = 2e7;
	double work = 0;
	bool met = false;
	for (int i = 0; i < c->choice->alternatives && c->exact; i++) {
		struct alternative *a = &c->choice->alternative[i];
		if (!is_hopeful(c, a))
			continue;
		work += work_of_walk(c, a);
		if (met && work > spare)
			return;
		walk(c, a);
		met = met || meets(a);
	}
}

/* ---- all of them ---- */

static void try_all(struct choosing *c)
{
	c->choice = NEW(struct choice);
	c->variant = variant_of(c, c->stepped);
	const struct modal_truncation *truncated = c->written->reduction.truncated;
	const struct model *full = truncated ? truncated->modes->model : c->stepped;
	struct step *exact = c->variant->states ? c->variant->states : c->variant->modes;
	if (full != c->stepped) {
		struct model *whole = NEW(struct model);
		*whole = *full;
		exact = step_of(c, whole, FORM_DIRECT);
	}
	c->largest = ARRAY(double, c->stepped->needs.requirements);
	c->exact = exact_course_of(full, c->stepped);
	for (int i = 0; i < c->stepped->needs.requirements; i++)
		c->largest[i] = c->exact ? largest_of(c->exact, i) * (1 - 0x1p-52)
				: exact	 ? largest_of_output(exact, &c->stepped->needs.requirement[i])
					 : 0;
	if (truncated)
		count_written(c);
	try_forms(c);
	if (!truncated)
		try_fewer(c);
	sort_by_cost(c->choice);
	walk_all(c);
	sort_by_cost(c->choice);
}

/* ---- what cannot be met ---- */

/* The requirement that it is furthest from */
static int worst_requirement(const struct choosing *c, const struct alternative *a)
{
	int worst = 0;
	double most = 0;
	for (int i = 0; i < c->stepped->needs.requirements; i++) {
		const struct certificate *found = &a->certificate[i];
		const double error_ratio = error_reported(found) / found->needed;
		worst = error_ratio > most ? i : worst;
		most = fmax(most, error_ratio);
	}
	return worst;
}

/* The largest real part of a pole [1/s] */
static double growth_of(const struct step *step)
{
	struct pole_report *pole;
	double growth = -HUGE_VAL;
	const int poles = poles_of(step->model, step->written, &pole);
	for (int i = 0; i < poles; i++)
		growth = fmax(growth, mpfr_get_d(pole[i].re, MPFR_RNDN));
	return growth;
}

/* What stands in the way, as far as something asked for does */
static const char *what_would_do(struct choosing *c)
{
	const struct request *request = c->request;
	struct request open = *request;
	const struct step *known = c->variant->states ? c->variant->states : c->variant->modes;
	const double growth = known ? growth_of(known) : 0;
	if (growth > 1e-9)
		return format("the model is unstable: what rounds grows as e^{%.3g t} with it", growth);
	if (!(request->real_given && request->single) && request->form == FORM_AUTO && !request->compensated)
		return NULL;
	open.real_given = open.compensated = false;
	open.form = FORM_AUTO;
	c->request = &open;
	try_all(c);
	const struct alternative *best = most_exact(c->choice, HUGE_VAL);
	c->request = request;
	return best && best->error_ratio <= 1 ? format("without what is asked for on the command line it can: %s",
						  certified_text(best, worst_requirement(c, best)))
					 : NULL;
}

static void report_unmet(struct choosing *c)
{
	const struct choice *choice = c->choice;
	const struct alternative *best = most_exact(choice, HUGE_VAL), *first = choice->alternative;
	const char *note = what_would_do(c);
	if (!best) {
		say_error(c->stepped->needs.requirement[0].need->at, note, "the need cannot be certified: %s",
			  first->refused ? first->refused : first->why);
		return;
	}
	const int i = worst_requirement(c, best);
	say_error(c->stepped->needs.requirement[i].need->at, note,
		  "the need cannot be met: at best %s, and %.2g is needed", certified_text(best, i),
		  best->certificate[i].needed);
}

static void report_expensive(const struct choosing *c, const struct alternative *taken)
{
	const struct alternative *best = most_exact(c->choice, c->stepped->needs.budget);
	const char *fits = best ? format("%s takes %.0f, and misses the need by a factor of %.3g",
					 alternative_text(best), best->cost, best->error_ratio)
				: "nothing that there is takes so few";
	say_error(c->stepped->spec->required.budget.at, fits,
		  "over budget: the cheapest that meets the need takes some %.0f instructions (%s), %.0f more than "
		  "%.0f, or %.3g times as many",
		  taken->cost, alternative_text(taken), taken->cost - c->stepped->needs.budget,
		  c->stepped->needs.budget, taken->cost / c->stepped->needs.budget);
}

/* ---- the choice ---- */

static bool find_taken(struct choosing *c)
{
	struct choice *choice = c->choice;
	choice->taken = -1;
	for (int i = 0; i < choice->alternatives && choice->taken < 0; i++)
		if (meets(&choice->alternative[i]))
			choice->taken = i;
	if (choice->taken < 0) {
		report_unmet(c);
		return false;
	}
	const struct alternative *taken = &choice->alternative[choice->taken];
	if (c->stepped->needs.target && taken->cost > c->stepped->needs.budget) {
		report_expensive(c, taken);
		return false;
	}
	return true;
}

/* Where the form that is asked for cannot be, any is tried. */
static void try_any_form(struct choosing *c, struct request *request)
{
	const char *why = "--accuracy compensated takes the form delta or kick-drift-kick";
	bool made = request->form == FORM_AUTO;
	for (int i = 0; i < c->choice->alternatives; i++) {
		const char *refused = c->choice->alternative[i].refused;
		made = made || !refused;
		why = refused && strstr(refused, ": ") ? strstr(refused, ": ") + 2 : why;
	}
	if (made)
		return;
	stand_aside(c->stepped->request.at.form, format("--form %s", step_form_name(request->form)), why);
	request->form = FORM_AUTO;
	try_all(c);
}

struct step *choose_step(struct model *written, struct model *stepped, struct request *request)
{
	struct choosing c = { .written = written, .stepped = stepped, .request = request, .trying = true };
	if (stepped->spec->required.needs > 0 && is_measured(stepped))
		return choose_measured(stepped, request);
	if (!find_requirements(stepped))
		return NULL;
	try_all(&c);
	try_any_form(&c, request);
	if (!find_taken(&c))
		return NULL;
	c.now = &c.choice->alternative[c.choice->taken];
	request->single = c.now->single;
	request->compensated = c.now->compensated;
	request->form = c.now->form;
	c.trying = false;
	if (!statement_guard(build_now, &c))
		return NULL;
	c.step->choice = c.choice;
	return c.step;
}
