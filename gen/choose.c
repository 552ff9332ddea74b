/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a spec with needs leaves open - float or double, two words, the form of the step - is tried, and the cheapest
 * that meets all needs is taken. What is written or asked for is kept. */
#include "command.h"

#include <math.h>
#include <stdlib.h>

struct choosing {
	struct model *written, *model;
	const struct request *request;
	struct choice *choice;
	struct step *states, *modes; /* in double: the numbers of a step of states, of modes; NULL: there is none */
	struct alternative *now;
	struct step *step;
};

/* ---- one alternative ---- */

static void set_asked(struct choosing *c, const struct alternative *a)
{
	struct model *models[] = { c->written, c->model };
	for (int i = 0; i < 2; i++) {
		models[i]->asked.single = a->single;
		models[i]->asked.compensated = a->compensated;
		models[i]->asked.form = a->form;
		models[i]->asked.form_at = (struct place){ source_argument(step_form_name(a->form)), 0 };
	}
	(a->single ? target_float : target_double)();
}

static void build_now(void *context)
{
	struct choosing *c = context;
	set_asked(c, c->now);
	c->step = step_build(c->model);
	if (!c->step)
		abandon();
}

/* Both at once is told once: compensated there is no other form. */
static bool stands_alone(const struct alternative *a)
{
	return !a->compensated || a->form == FORM_DELTA || a->form == FORM_KICK_DRIFT_KICK;
}

static void certify(struct choosing *c)
{
	struct alternative *a = c->now;
	const struct step *exact = c->step->modal ? c->modes : c->states;
	a->certificate = ARRAY(struct certificate, (size_t)c->model->requirements);
	a->cost = cost_of_step(c->step, c->model->target);
	for (int i = 0; i < c->model->requirements; i++) {
		const struct requirement *r = &c->model->requirement[i];
		a->certificate[i] = certificate_of(c->step, exact ? exact : c->step, r);
		const struct certificate *found = &a->certificate[i];
		a->why = a->why ? a->why : found->why;
		if (found->known)
			a->excess = fmax(a->excess, found->rounding / needed_error(r, found));
	}
}

static void try_one(struct choosing *c, bool single, bool compensated, enum step_form form)
{
	struct alternative *a = c->now = NEW(struct alternative);
	*a = (struct alternative){ .single = single, .compensated = compensated, .form = form };
	if (!stands_alone(a))
		return;
	a->refused = refusal_of(build_now, c);
	if (!a->refused)
		certify(c);
	ENLARGE(c->choice->alternative, (size_t)c->choice->alternatives + 1);
	c->choice->alternative[c->choice->alternatives++] = *a;
}

/* ---- all of them ---- */

static struct step *built(struct choosing *c, enum step_form form)
{
	c->now = NEW(struct alternative);
	c->now->form = form;
	c->step = NULL;
	return refusal_of(build_now, c) ? NULL : c->step;
}

static void try_form(struct choosing *c, enum step_form form)
{
	const struct request *asked = c->request;
	for (int precision = 0; precision < 2; precision++) {
		const bool single = precision == 0;
		if (asked->real_given && asked->single != single)
			continue;
		if (!asked->compensated)
			try_one(c, single, false, form);
		try_one(c, single, true, form);
	}
}

static int by_cost(const void *left, const void *right)
{
	const struct alternative *a = left, *b = right;
	if (!a->refused != !b->refused)
		return a->refused ? 1 : -1;
	if (a->cost != b->cost)
		return a->cost < b->cost ? -1 : 1;
	if (a->single != b->single)
		return a->single ? -1 : 1;
	if (a->compensated != b->compensated)
		return a->compensated ? 1 : -1;
	return (int)a->form - (int)b->form;
}

static void try_forms(struct choosing *c)
{
	static const enum step_form forms[] = { FORM_DIRECT, FORM_DELTA, FORM_KICK_DRIFT_KICK, FORM_MODAL };
	for (size_t i = 0; i < sizeof forms / sizeof *forms; i++)
		if (c->request->form == FORM_AUTO || c->request->form == forms[i])
			try_form(c, forms[i]);
	qsort(c->choice->alternative, (size_t)c->choice->alternatives, sizeof *c->choice->alternative, by_cost);
}

static bool meets(const struct alternative *a)
{
	return !a->refused && !a->why && a->excess <= 1;
}

/* ---- what cannot be met ---- */

/* The requirement that it is furthest from */
static int worst_requirement(const struct model *model, const struct alternative *a)
{
	int worst = 0;
	double most = 0;
	for (int i = 0; i < model->requirements; i++) {
		const struct certificate *found = &a->certificate[i];
		const double excess = found->known ? found->rounding / needed_error(&model->requirement[i], found) : 0;
		worst = excess > most ? i : worst;
		most = fmax(most, excess);
	}
	return worst;
}

/* Of those that are known, the most exact */
static const struct alternative *most_exact(const struct choice *choice, double most)
{
	const struct alternative *best = NULL;
	for (int i = 0; i < choice->alternatives; i++) {
		const struct alternative *a = &choice->alternative[i];
		if (!a->refused && !a->why && a->cost <= most && (!best || a->excess < best->excess))
			best = a;
	}
	return best;
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
	const struct request *asked = c->request;
	struct request open = *asked;
	const double growth = c->states ? growth_of(c->states) : 0;
	if (growth > 1e-9)
		return format("the model is unstable: what rounds grows as e^{%.3g t} with it", growth);
	if (!(asked->real_given && asked->single) && asked->form == FORM_AUTO && !asked->compensated)
		return NULL;
	open.real_given = open.compensated = false;
	open.form = FORM_AUTO;
	c->request = &open;
	c->choice = NEW(struct choice);
	try_forms(c);
	const struct alternative *best = most_exact(c->choice, HUGE_VAL);
	c->request = asked;
	return best && best->excess <= 1
		       ? format("without what is asked for on the command line it can: %.2g (%s)",
				best->certificate[worst_requirement(c->model, best)].rounding, alternative_text(best))
		       : NULL;
}

static void tell_unmet(struct choosing *c)
{
	const struct model *model = c->model;
	const struct choice *choice = c->choice;
	const struct alternative *best = most_exact(choice, HUGE_VAL), *first = choice->alternative;
	const char *note = what_would_do(c);
	if (!best) {
		say_error(model->requirement[0].need->at, note, "the need cannot be certified: %s",
			  first->refused ? first->refused : first->why);
		return;
	}
	const int i = worst_requirement(model, best);
	const struct requirement *r = &model->requirement[i];
	say_error(r->need->at, note,
		  "the need cannot be met: rounding alone is bounded by %.2g at best (%s), and %.2g is needed",
		  best->certificate[i].rounding, alternative_text(best), needed_error(r, &best->certificate[i]));
}

static void tell_dear(const struct choosing *c, const struct alternative *taken)
{
	const struct alternative *best = most_exact(c->choice, c->model->budget);
	const char *fits = best ? format("%s takes %.0f, and misses the need by a factor of %.3g",
					 alternative_text(best), best->cost, best->excess)
				: "nothing that there is takes so few";
	say_error(c->model->spec->budget.at, fits,
		  "over budget: the cheapest that meets the need takes some %.0f instructions (%s), %.0f more than %.0f",
		  taken->cost, alternative_text(taken), taken->cost - c->model->budget, c->model->budget);
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
		tell_unmet(c);
		return false;
	}
	const struct alternative *taken = &choice->alternative[choice->taken];
	if (c->model->target && taken->cost > c->model->budget) {
		tell_dear(c, taken);
		return false;
	}
	return true;
}

struct step *choose_step(struct model *written, struct model *stepped, struct request *request)
{
	struct choosing c = { .written = written, .model = stepped, .request = request, .choice = NEW(struct choice) };
	if (!find_requirements(stepped))
		return NULL;
	c.states = built(&c, FORM_DIRECT);
	c.modes = built(&c, FORM_MODAL);
	try_forms(&c);
	if (!find_taken(&c))
		return NULL;
	c.now = &c.choice->alternative[c.choice->taken];
	request->single = c.now->single;
	request->compensated = c.now->compensated;
	request->form = c.now->form;
	if (!statement_guard(build_now, &c))
		return NULL;
	c.step->choice = c.choice;
	return c.step;
}
