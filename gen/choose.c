/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a linear spec with needs leaves open - float or double, two words, the form of the step, modes that are kept -
 * is tried, and the cheapest that meets all needs is taken. What is written or asked for is kept.
 *
 * The C of each runs beside a reference: the exact outputs, where there are no inputs; else another program in double,
 * with inputs that do most to the outputs and some more. What outputs lose with modes is known for all inputs.
 *
 * Modes are dropped from the least share on. The steps that are tried are those of the fewest modes that lose less than
 * is needed, of one less, which shows what that would miss, and of a few more, which leave more of the need to
 * rounding. Of many states only steps of modes are tried, where there are such. Where all modes are kept the states are
 * those that were written. */
#include "measuring.h"
#include "command.h"
#include "model/checks.h"
#include "model/linear/modal_truncation.h"
#include "report/report.h"
#include "step/choice.h"
#include "step/cost.h"
#include "step/linear/images.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MORE_MODES = 3 };            /* than the fewest that lose less than is needed */

/* Programs in double that others are compared with, the most exact first */
static const struct { enum step_form form; bool compensated; } programs[] = {
	{ FORM_DELTA, true }, { FORM_KICK_DRIFT_KICK, true }, { FORM_MODAL, false }, { FORM_DIRECT, false }
};
enum { PROGRAMS = sizeof programs / sizeof *programs };
struct program_run { bool tried; struct running *r; struct course **course; };  /* per drive; NULL: not run yet */

struct variant {                    /* a model to step: all modes, or some of them */
	struct model *model;
	double *dropped;            /* per requirement: what is lost with modes, for all inputs */
	struct program_run program[PROGRAMS];
};
struct choosing {
	struct model *written, *stepped;
	const struct request *request;
	struct choice *choice;
	double h, *largest;         /* of a step; per requirement: what the exact output surely reaches */
	mpq_t *most;                /* per input: its largest bound */
	struct course *exact;       /* NULL: it is not known */
	struct variant *all, *variant; /* of all modes; now */
	struct input_response response;   /* of all modes */
	int drives;                 /* courses of inputs that are tried; one where there are none */
	struct sampled *drive;      /* NULL: there are none */
	struct alternative *now;
	struct step *step;
	bool trying;                /* without what no need asks for */
	double cheapest;            /* of what met the needs */
};

/* ---- one alternative ---- */

static void ask(const struct choosing *c, struct model *model)
{
	const struct alternative *a = c->now;
	model->request.again.trial = c->trying;
	model->request.single = a->single;
	model->request.compensated = a->compensated;
	model->request.form = a->form;
	model->request.form_at = (struct place){ source_argument(step_form_name(a->form)), 0 };
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

static struct running *running_now(const struct choosing *c, const char **why)
{
	return running_new(c->stepped->needs.requirement[0].need->at, c->step, 0, why);
}

/* ---- programs to compare with ---- */

/* NULL: there is none */
static struct running *program_of(struct choosing *c, struct variant *v, int number)
{
	struct program_run *p = &v->program[number];
	struct alternative *now = c->now;
	struct step *step = c->step;
	const char *why;
	if (p->tried)
		return p->r;
	c->now = NEW(struct alternative);
	*c->now = (struct alternative){ .form = programs[number].form, .compensated = programs[number].compensated,
					.model = v->model };
	p->tried = true;
	if (!unheard_refusal_of(build_now, c))
		p->r = running_now(c, &why);
	c->now = now;
	c->step = step;
	return p->r;
}

/* The most exact that is not the alternative itself (NULL: any); its place, or PROGRAMS */
static int other_program(struct choosing *c, struct variant *v, const struct alternative *a)
{
	for (int i = 0; i < PROGRAMS; i++) {
		const bool itself = a && !a->single && a->form == programs[i].form &&
				    a->compensated == programs[i].compensated;
		if (!itself && program_of(c, v, i))
			return i;
	}
	return PROGRAMS;
}

static const struct course *course_beside(const struct choosing *c, struct variant *v, int program, int drive)
{
	struct program_run *p = &v->program[program];
	if (!p->course)
		p->course = ARRAY(struct course *, c->drives);
	if (!p->course[drive])
		p->course[drive] = run_of(p->r, c->drive ? &c->drive[drive] : NULL, NULL, NULL);
	return p->course[drive];
}

static bool is_too_long(const struct choosing *c, double cost)
{
	return cost * longest_need(c->stepped) / c->h > 4.0 * LIMIT_MEASURED;
}

/* What the outputs do without inputs, and by one sample of each; false: no program is there */
static bool find_response(struct choosing *c, struct variant *v, struct input_response *response)
{
	const int program = other_program(c, v, NULL);
	if (program == PROGRAMS || is_too_long(c, cost_of_step(running_step_of(v->program[program].r), NULL)))
		return false;
	*response = input_response_of(v->program[program].r, c->most);
	return true;
}

static struct variant *variant_of(struct choosing *c, struct model *model)
{
	struct variant *v = NEW(struct variant);
	struct input_response response;
	v->model = model;
	v->dropped = ARRAY(double, c->stepped->needs.requirements);
	if (!c->all)
		return v;
	const bool known = c->response.still && find_response(c, v, &response);
	if (known)
		input_response_less(&response, &c->response);
	for (int i = 0; i < c->stepped->needs.requirements; i++)
		v->dropped[i] = known ? worst_of(&response, i, c->stepped->needs.requirement[i].most) : HUGE_VAL;
	if (known)
		input_response_free(&response);
	return v;
}

/* ---- measured ---- */

/* Two words take these forms only. */
static bool stands_alone(const struct alternative *a)
{
	return !a->compensated || a->form == FORM_DELTA || a->form == FORM_KICK_DRIFT_KICK;
}

/* The largest errors beside a program of the same model, with all inputs that are tried */
static void measure_beside(struct choosing *c, struct running *r, double *error)
{
	struct alternative *a = c->now;
	const int program = other_program(c, c->variant, a);
	if (program == PROGRAMS)
		a->why = "there is no other step to compare it with";
	a->inputs_tried = c->drive ? c->drives : 0;
	for (int d = 0; d < c->drives && !a->why; d++) {
		const struct trial trial = trial_of(r, course_beside(c, c->variant, program, d), NULL,
						    c->drive ? &c->drive[d] : NULL);
		a->why = trial.why;
		for (int i = 0; i < c->stepped->needs.requirements; i++)
			error[i] = fmax(error[i], trial.error[i]);
	}
}

/* Per requirement: beside exact outputs the error itself; else what is lost with modes, and what rounds; with inputs
 * twice what was measured of that */
static const double *measured_errors(struct choosing *c)
{
	struct alternative *a = c->now;
	const int requirements = c->stepped->needs.requirements;
	double *error = ARRAY(double, requirements);
	const bool known = (c->exact || c->response.still) && !is_too_long(c, cost_of_step(c->step, NULL));
	struct running *r = known ? running_now(c, &a->why) : NULL;
	if (!r) {
		a->why = a->why ? a->why : "it takes too long to be measured";
		return error;
	}
	if (c->exact) {
		const struct trial trial = trial_of(r, c->exact, NULL, NULL);
		a->why = trial.why;
		return trial.error;
	}
	measure_beside(c, r, error);
	for (int i = 0; i < requirements; i++)
		error[i] = c->variant->dropped[i] + (c->drive ? 2 : 1) * error[i] + 8 * 0x1p-53 * c->largest[i];
	return error;
}

/* A compiler that contracts products rounds other sums: by as much as a rule, and by twice that is foreseen */
static bool bears_contraction(const struct error_found *e)
{
	return e->error + fmax(e->error - e->dropped, 0) <= e->needed;
}

static void measure(struct choosing *c)
{
	struct alternative *a = c->now;
	const double *error = measured_errors(c);
	a->found = ARRAY(struct error_found, c->stepped->needs.requirements);
	for (int i = 0; i < c->stepped->needs.requirements; i++) {
		struct error_found *e = &a->found[i];
		*e = (struct error_found){ !a->why, c->exact != NULL, error[i], c->variant->dropped[i],
					   needed_error(&c->stepped->needs.requirement[i], c->largest[i]) };
		a->error_ratio = fmax(a->error_ratio, e->error / e->needed);
		a->as_written = a->as_written || !bears_contraction(e);
	}
	a->as_written = a->as_written && meets(a);
}

/* What is dearer than what was found is run where that is no work */
static bool is_work(const struct choosing *c, const struct alternative *a)
{
	enum { READING = 200 };         /* operations of reading the C of a state's */
	static const double spare = 2e7;
	const double samples = longest_need(c->stepped) / c->h;
	return cost_of_step(c->step, NULL) * (samples * c->drives + READING * (double)a->model->system.states) > spare;
}

/* Whether it is as exact as needed */
static bool try_one(struct choosing *c, bool single, bool compensated, enum step_form form)
{
	struct alternative *a = c->now = NEW(struct alternative);
	*a = (struct alternative){ .single = single, .compensated = compensated, .form = form,
				   .model = c->variant->model };
	if (!stands_alone(a))
		return false;
	a->refused = refusal_of(build_now, c);
	if (a->refused && a->model->truncated && !c->written->truncated)
		return false;           /* as of all modes, which are tried too */
	if (!a->refused) {
		a->cost = cost_of_step(c->step, c->stepped->needs.target);
		if (a->cost > c->cheapest && is_work(c, a))
			return true;
		measure(c);
	}
	if (meets(a))
		c->cheapest = fmin(c->cheapest, a->cost);
	*MORE(c->choice->alternative, c->choice->alternatives) = *a;
	return meets(a);
}

/* By modes alone: the plainest step shows it. */
static bool loses_too_much(const struct choosing *c, const struct variant *v)
{
	bool loses = false;
	for (int i = 0; i < c->stepped->needs.requirements; i++)
		loses = loses || v->dropped[i] > needed_error(&c->stepped->needs.requirement[i], c->largest[i]);
	return loses;
}

/* ---- all of one model ---- */

static void try_form(struct choosing *c, enum step_form form)
{
	const struct request *request = c->request;
	for (int precision = 0; precision < 2; precision++) {
		const bool single = precision == 0;
		if (request->real_given && request->single != single)
			continue;
		const bool exact = !request->compensated && try_one(c, single, false, form);
		if (request->compensated || !(exact || loses_too_much(c, c->variant)))
			try_one(c, single, true, form);         /* which is dearer */
	}
}

/* Its steps of states cost so much more than those of modes that only these are tried. */
static bool is_large(const struct model *model)
{
	return model->system.states > LIMIT_UNROLLED_STATES && !model->truncated;
}

static void try_forms(struct choosing *c)
{
	static const enum step_form forms[] = { FORM_DIRECT, FORM_DELTA, FORM_KICK_DRIFT_KICK, FORM_MODAL };
	struct variant *v = c->variant;
	const bool requested = c->request->form != FORM_AUTO, modes = v->model->truncated;
	for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
		const bool needless = (forms[i] == FORM_MODAL ? modes : is_large(v->model) && program_of(c, v, 2)) ||
				      (forms[i] != FORM_DIRECT && modes && !c->request->compensated &&
				       loses_too_much(c, v));
		if (requested ? c->request->form == forms[i] : !needless)
			try_form(c, forms[i]);
	}
}

/* ---- fewer modes ---- */

/* As many modes as are asked for first */
static struct variant *variant_of_modes(struct choosing *c, struct modes *modes, const int *order, int count,
					bool static_correction)
{
	bool *kept = ARRAY(bool, modes->count);
	for (int i = 0; i < count; i++)
		kept[order[i]] = true;
	target_double();
	struct model *model = modes_kept(modes, kept, static_correction);
	return model ? variant_of(c, model) : NULL;
}

static void drop_modes(struct choosing *c, struct modes *modes, bool static_correction)
{
	const int all = modes->count, *order = modes_by_share(modes);
	struct variant **v = ARRAY(struct variant *, all);
	int last = 1;
	for (int more = MORE_MODES; last < all && more >= 0; last++) {
		v[last] = variant_of_modes(c, modes, order, last, static_correction);
		more -= v[last] && !loses_too_much(c, v[last]);
	}
	int fewest = last;
	while (fewest > 1 && v[fewest - 1] && !loses_too_much(c, v[fewest - 1]))
		fewest--;
	for (int count = fewest > 1 ? fewest - 1 : fewest; count < last; count++) {
		c->variant = v[count];
		if (v[count])
			try_forms(c);
	}
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
	whole->needs = c->stepped->needs;
	target_double();
	struct modes *modes = whole->declared_outputs ? modes_of(whole, &why) : NULL;
	if (!modes || modes->count < 2)
		return;
	for (int static_correction = 0; static_correction <= is_driven(&whole->system); static_correction++)
		drop_modes(c, modes, static_correction);
}

/* ---- all of them ---- */

/* Inputs that do most to each output, and those that measured needs are tried with */
static void find_drives(struct choosing *c)
{
	const struct needs *needs = &c->stepped->needs;
	const struct step *step = running_step_of(c->all->program[other_program(c, c->all, NULL)].r);
	double w[FREQUENCIES];
	const int count = frequencies_of(step, longest_need(c->stepped), w), kinds = drive_kinds(count);
	c->drives = needs->requirements + kinds;
	c->drive = ARRAY(struct sampled, c->drives);
	for (int i = 0; i < needs->requirements; i++)
		c->drive[i] = worst_inputs(&c->response, i, c->all->model, needs->requirement[i].most);
	for (int i = 0; i < kinds; i++)
		c->drive[needs->requirements + i] =
			drive_of(c->all->model, i, w, count, c->h, c->response.still->samples, c->most);
}

static void find_reference(struct choosing *c, const struct model *full)
{
	c->h = sample_time(full);
	c->most = rationals(full->system.inputs);
	for (int k = 0; k < full->system.inputs * c->stepped->needs.requirements; k++) {
		const int i = k % full->system.inputs;
		mpq_srcptr bound = c->stepped->needs.requirement[k / full->system.inputs].most[i];
		if (mpq_cmp(bound, c->most[i]) > 0)
			mpq_set(c->most[i], bound);
	}
	c->exact = exact_course_of(full, c->stepped);
	c->all = variant_of(c, c->stepped);
	if (full != c->stepped) {
		struct model *whole = NEW(struct model);
		*whole = *full;
		whole->needs = c->stepped->needs;
		c->all = variant_of(c, whole);
	}
	c->drives = 1;
	c->largest = ARRAY(double, c->stepped->needs.requirements);
	const bool known = find_response(c, c->all, &c->response);
	for (int i = 0; i < c->stepped->needs.requirements; i++)
		c->largest[i] = c->exact ? largest_of(c->exact, i) * (1 - 0x1p-52)
				: known	 ? reached_by(&c->response, i, c->stepped->needs.requirement[i].most)
					 : 0;
	if (known && full->system.inputs > 0)
		find_drives(c);
}

static void try_all(struct choosing *c)
{
	const struct model *full = c->written->truncated ? c->written->truncated->modes->model : c->stepped;
	c->choice = NEW(struct choice);
	c->cheapest = HUGE_VAL;
	if (!c->all)
		find_reference(c, full);
	c->variant = full == c->stepped ? c->all : variant_of(c, c->stepped);
	try_forms(c);
	if (!c->written->truncated)
		try_fewer(c);
	sort_by_cost(c->choice);
}

/* ---- what cannot be met ---- */

/* The requirement that it is furthest from */
static int worst_requirement(const struct choosing *c, const struct alternative *a)
{
	int worst = 0;
	double most = 0;
	for (int i = 0; i < c->stepped->needs.requirements; i++) {
		const double error_ratio = a->found[i].error / a->found[i].needed;
		worst = error_ratio > most ? i : worst;
		most = fmax(most, error_ratio);
	}
	return worst;
}

/* Of those that are known, the most exact */
static const struct alternative *most_exact(const struct choice *choice, double most)
{
	const struct alternative *best = NULL;
	for (int i = 0; i < choice->alternatives; i++) {
		const struct alternative *a = &choice->alternative[i];
		if (!a->refused && !a->why && a->cost <= most && (!best || a->error_ratio < best->error_ratio))
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
	const struct request *request = c->request;
	struct request open = *request;
	const int known = other_program(c, c->all, NULL);
	const double growth = known < PROGRAMS ? growth_of(running_step_of(c->all->program[known].r)) : 0;
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
						  error_text(best, worst_requirement(c, best)))
					 : NULL;
}

static void report_unmet(struct choosing *c)
{
	const struct choice *choice = c->choice;
	const struct alternative *best = most_exact(choice, HUGE_VAL), *first = choice->alternative;
	const char *note = what_would_do(c);
	if (!best) {
		say_error(c->stepped->needs.requirement[0].need->at, note, "the need cannot be measured: %s",
			  first->refused ? first->refused : first->why);
		return;
	}
	const int i = worst_requirement(c, best);
	say_error(c->stepped->needs.requirement[i].need->at, note,
		  "the need cannot be met: at best %s, and %.2g is needed", error_text(best, i),
		  best->found[i].needed);
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
	stand_aside(c->stepped->request.form_at, format("--form %s", step_form_name(request->form)), why);
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
