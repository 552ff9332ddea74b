/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The most instructions that a step takes. Code without a branch that depends on the state takes the sum of what its
 * operations take at most; a search, a series as long as its tolerance lets it be and Newton's method that of their
 * limits, each taken to the full. */
#include "cost.h"
#include "model/checks.h"
#include "model/contacts/contacts.h"
#include "step/collocation/collocation.h"
#include "step/linear/forms.h"
#include "step/linear/rows.h"
#include "step/regions/guards.h"

#include <math.h>
#include <string.h>

/* What a bound adds up */
struct parts { double multiplications, additions, forcings, growths, states, flushed, compared, inputs, ramps; };

static bool holds_longer(const struct linear *system)
{
	bool longer = false;
	for (int i = 0; i < system->inputs; i++)
		longer = longer || system->input[i].hold > 1;
	return longer;
}

static const char *unbounded_search(const struct step *step)
{
	const char *why = NULL;
	for (int p = 0; p < step->regions.parts && !why; p++)
		why = unbounded_search(step->regions.part[p]);
	return why			 ? why
	       : caches_regions(step->model) ? "matrices of regions are made when they are met"
	       : step->is.two_words	 ? "the search is in two words"
					 : NULL;
}

static const char *unbounded_calls(const struct step *step)
{
	const bool known = step->collocation || (step->taylor.expansion && worst_of_calls(step, 0) >= 0);
	return step->program->calls == 0 || known    ? NULL
	       : step->model->request.own_math ? "it calls functions that take long for some numbers"
					       : "it calls functions of <math.h>, not of --math own";
}

const char *unbounded_text(const struct step *step)
{
	const struct linear *system = &step->branch->system;
	const struct model *model = step->model;
	const char *search = model->switching ? unbounded_search(step) : NULL;
	const char *series = is_linear_alone(step) || model->switching ? NULL : unbounded_series(step);
	const char *calls = search || series ? NULL : unbounded_calls(step);
	return search				     ? search
	       : series			     ? series
	       : model->written->ranges > 0 && model->written != model
		       ? "the states as written are compared with their ranges"
	       : model->delays		     ? "the step of a core is taken in parts"
	       : peak_outputs(model) > 0 && peaks_by_values(step)
		       ? "peaks of what is known by its values alone are searched"
	       : step->refresh		     ? "a refresh evaluates functions of loads in some steps"
	       : calls			     ? calls
	       : holds_longer(system)	     ? "inputs go through more than two samples"
					     : NULL;
}

static struct parts parts_of(const struct step *step)
{
	const struct program *program = step->program;
	const struct linear *system = &step->branch->system;
	const struct denormal_flush *flush = step->linear.flush;
	struct parts p = { .multiplications = program->multiplications - program->forcing_multiplications,
			   .additions = program->additions - program->forcing_additions,
			   .states = system->states, .inputs = system->inputs };
	for (int i = 0; i < system->inputs; i++)
		p.ramps += system->input[i].hold > 0;
	for (int l = 0; l < system->loads; l++) {
		p.forcings += oscillates(system->load[l].forcing);
		p.growths += mpq_sgn(system->load[l].forcing->a) != 0;
	}
	p.flushed = flush && flush->decaying > 0 && !flush->beside ? system->states : 0;
	p.compared = flush && flush->beside ? system->states : 0;
	return p;
}

/* ---- what each part takes ---- */

enum { PLAIN = 9, LOOPS = 3 };
struct bound {                      /* in double, in float */
	const char *target;
	/* A product, a sum, cos and sin of a load, its e^{a t}; of a state: itself, looked at by a flush; an input; a
	 * step; a product beyond 30, since then the states are no longer in registers */
	double plain[2][PLAIN];
	double loops[2][LOOPS];     /* a product with its sum; a state that a flush compares; a step; else as plain */
};

/* Fitted to the longest steps that a search found of 25 models, by arm-none-eabi-gcc 12, -O2: as close as can be, and
 * no bound below 1.05 times the longest. tests/firmware/worst.sh searches others. */
static const struct bound bounds[] = {
	{ "cortex-m0", { { 332.6, 140.3, 10890, 8280, 34.45, 2.47, 541.4, 0, 0 },
			 { 121.8, 78.56, 1421, 351, 75.58, 7.2, 369.1, 0, 0 } },
	  { { 481.6, 61.2, 3317 }, { 189.7, 0, 10730 } } },
	{ "cortex-m4", { { 68.66, 70.58, 2435, 2570, 15.84, 0, 223.7, 0, 0 },
			 { 1.506, 1.89, 231.5, 70.23, 0, 9.187, 9.258, 8.464, 0.07 } },
	  { { 135.5, 0, 3738 }, { 5, 36.07, 0 } } },
	{ "cortex-m7", { { 1.238, 1.133, 485, 213.4, 0, 11.25, 3.628, 19.49, 2.35 },
			 { 1.575, 1.859, 229.2, 67.11, 0, 9.187, 7.925, 9.02, 0 } },
	  { { 4.2, 30.37, 262.9 }, { 4.75, 36.99, 68.86 } } }
};

/* Where params are tunable all of it so many times, of a step in loops; on top for a step; for the slope of a ramp, a
 * quotient. To the longest of 23 models */
static const double tuned[][2][4] = {
	{ { 1.015, 1.13, 150, 100 }, { 1.02, 1.21, 100, 50 } },
	{ { 1, 1.13, 0, 470 }, { 1, 1.21, 8, 5 } },
	{ { 1, 1.13, 12, 0 }, { 1, 1.21, 8, 5 } }
};

/* A state that is compared with its range; one that is fetched for it */
static const double ranged[][2][2] = {
	{ { 150, 0 }, { 105, 0 } }, { { 105, 0 }, { 22, 0 } }, { { 20, 2 }, { 22, 0 } }
};

/* In modes: a product with its sum; of a state itself compared, or looked at; an input; a step. To the longest of 6 */
enum { MODAL = 5 };
static const double modes[][2][MODAL] = {
	{ { 458.3, 8, 54.8, 541, 100 }, { 203, 11, 20, 369, 50 } },
	{ { 128.2, 8, 15, 224, 50 }, { 3.7, 37.9, 12, 21.8, 10 } },
	{ { 3, 38.4, 12, 35.3, 10 }, { 3.7, 39, 12, 22.8, 10 } }
};

/* To the longest steps of 6 models in which loads change, and of 6 with peaks */
static const double changes[][2][CHANGE] = {
	{ { 189.8, 1048, 45860, 856.1 }, { 125, 410.3, 37170, 190.7 } },
	{ { 58.5, 323.1, 23150, 189.6 }, { 7.5, 14, 2390, 4 } },
	{ { 6.5, 12.2, 2640, 4 }, { 7.5, 14, 2375, 4 } }
};
static const double looks_inside[][2][PEAK] = {
	{ { 450, 900, 1650, 14, 5600 }, { 165, 330, 297, 14, 2200 } },
	{ { 120, 240, 481, 8, 1600 }, { 6, 12, 19, 4, 80 } },
	{ { 37.5, 12, 18.2, 4, 80 }, { 6, 12, 20.6, 4, 80 } }
};

/* Of searches, to the longest steps beside breakpoints, grazing, in chains of impacts of 13 models, and of 31 with
 * friction and impacts: 12 % above and more, where paths that were found on one target count on all */
static const double searches[][2][SEARCH] = {
	{ { 14200, 1970, 758, 2820, 298, 750, 250, 8930, 0, 445, 0, 1020 },
	  { 1850, 875, 111, 933, 105, 87.5, 0, 817, 0, 175, 0, 500 } },
	{ { 3170, 578, 700, 148, 87.5, 221, 105, 2630, 0, 132, 0, 300 },
	  { 301, 17.5, 3.54, 43.4, 22.1, 4.73, 0, 222, 0, 7.35, 0, 226 } },
	{ { 631, 10.5, 1.89, 54.3, 27.8, 4.2, 4.9, 263, 0, 29.5, 0, 950 },
	  { 298, 18, 3.64, 44.4, 7.21, 4.9, 0, 143, 0, 11.9, 0, 1130 } }
};
static const double contacts[][2][SEARCH] = {
	{ { 13800, 132, 1750, 535, 1320, 252, 0, 2440, 65.3, 391, 93400, 151000, 8780 },
	  { 1580, 41.8, 747, 857, 418, 80.7, 0, 777, 20.9, 896, 103000, 48100, 2820 } },
	{ { 3100, 40.4, 598, 167, 404, 77.9, 0, 750, 20.3, 122, 33500, 46500, 2730 },
	  { 332, 19.3, 38.4, 79, 54.7, 5.21, 0, 50.1, 1.36, 8.09, 4120, 3110, 182 } },
	{ { 695, 27, 9.44, 36.6, 212, 7.29, 0, 70.1, 1.9, 11.4, 2610, 4350, 255 },
	  { 328, 20, 14, 81.4, 93.3, 5.36, 0, 51.6, 1.4, 8.34, 3820, 3210, 187 } }
};

/* Of series of fixed order, to the longest steps of 22 models; of those with events, to those of 21 */
static const double expansions[][2][WORST_SERIES] = {
	{ { 205, 255, 205, 0, 7920 }, { 82, 122, 82, 0, 233 } },
	{ { 42, 90, 42, 0, 2100, 0, 0, 0, 5 }, { 1.08, 1.92, 1.08, 3, 169, 0, 0, 0, 5 } },
	{ { 1.08, 1.95, 1.08, 5.6, 380, 0, 0, 0, 5 }, { 1.1, 1.96, 1.1, 3.5, 163, 0, 0, 0, 5 } }
};
/* With a tolerance, to the longest of 8, from huge starts, where all internal steps are short; the last are 6 % above
 * the longest looks of each kind at 18,000 polynomials of orders 6 to 30 */
static const double tolerant[][2][WORST_SERIES] = {
	{ { 154, 192, 154, 0, 7920, 0, 0, 0, 300, 16900, 1300, 1205 },
	  { 61.5, 120, 61.5, 0, 233, 0, 0, 0, 0, 2600, 310, 525 } },
	{ { 31.5, 71, 31.5, 0, 2100, 0, 0, 0, 0, 3100, 210, 329 },
	  { 0.82, 2.8, 0.82, 0, 186, 0, 0, 0, 0, 76, 9.3, 25 } },
	{ { 0.82, 2.8, 0.82, 0, 418, 0, 0, 0, 0, 170, 9.3, 27.5 },
	  { 0.82, 2.83, 0.82, 0, 180, 0, 0, 0, 0, 73, 9.3, 23.4 } }
};
static const double searched[][2][WORST_SERIES] = {
	{ { 205, 255, 205, 0, 7920, 1250, 1000, 74000 }, { 82, 122, 82, 0, 700, 520, 420, 31500 } },
	{ { 42, 90, 42, 0, 2100, 320, 250, 32000 }, { 1.6, 2.2, 1.4, 0, 680, 12.2, 15.2, 1930 } },
	{ { 1.6, 2.25, 1.4, 0, 690, 12.5, 16, 2850 }, { 1.65, 2.27, 1.45, 0, 695, 12.5, 15.6, 1990 } }
};

/* Of a collocation, to the longest of 4; of rates beside a series, of what an iteration takes */
static const double newtons[][2][WORST_COLLOCATION + 1] = {
	{ { 340, 260, 100, 7920, 600, 9000, 340 }, { 140, 150, 50, 233, 400, 5000, 140 } },
	{ { 75, 100, 30, 2100, 120, 2000, 75 }, { 2.2, 3.2, 5, 186, 10, 100, 2.4 } },
	{ { 2.2, 3, 5, 418, 5, 100, 2.4 }, { 2.2, 3.2, 5, 180, 10, 100, 2.4 } }
};

const char *worst_target(int target)
{
	return target < (int)(sizeof bounds / sizeof *bounds) ? bounds[target].target : NULL;
}

static int worst_target_named(const char *name)
{
	int target = 0;
	while (worst_target(target) && strcmp(worst_target(target), name) != 0)
		target++;
	return worst_target(target) ? target : NONE;
}

static double sum_of(int count, const double *each, const double *times)
{
	double sum = 0;
	for (int i = 0; i < count; i++)
		sum += each[i] * times[i];
	return ceil(sum);
}

static double worst_of_search(const struct step *step, int target, bool single, double forced)
{
	double part[SEARCH], changing[CHANGE];
	count_search(step, single, part);
	count_changes(step, changing);
	part[SEARCH_FORCED] = forced;
	/* how far off they are is waits where the step begins and behind each, too */
	const double waits = loads_change(&step->model->system) ? changing[CHANGES] + 2 : 0;
	return sum_of(SEARCH, (has_events(step->model->switching) ? contacts : searches)[target][single], part) +
	       waits * changes[target][single][CHANGES];
}

static double worst_of_plain(const struct step *step, int target, bool single)
{
	const struct parts p = parts_of(step);
	const double more = fmax(p.multiplications - 30, 0);
	const double plain[PLAIN] = { p.multiplications, p.additions, p.forcings, p.growths, p.states, p.flushed,
				      p.inputs, 1, more };
	const double loops[LOOPS] = { fmax(p.multiplications, p.additions), p.compared, 1 };
	const double modal[MODAL] = { p.multiplications, p.compared, p.flushed, p.inputs, 1 };
	const double *each = bounds[target].plain[single], functions = each[2] * p.forcings + each[3] * p.growths;
	return step->modal ? ceil(sum_of(MODAL, modes[target][single], modal) + functions)
	       : step->program->loops
		       ? ceil(sum_of(LOOPS, bounds[target].loops[single], loops) + functions + each[6] * p.inputs)
		       : sum_of(PLAIN, each, plain);
}

static double worst_of_linear(const struct step *step, int target, bool single)
{
	const double worst = worst_of_plain(step, target, single), *more = tuned[target][single];
	double changing[CHANGE], peaks[PEAK];
	count_changes(step, changing);
	count_peak_looks(step, single, peaks);
	/* with peaks functions of loads are computed at both ends */
	const double other = sum_of(CHANGE, changes[target][single], changing) +
			     sum_of(PEAK, looks_inside[target][single], peaks) + (peaks[PEAKS] > 0 ? worst : 0);
	return other + (step->model->params.tuning ? ceil(more[step->program->loops] * worst + more[2] +
							  more[3] * parts_of(step).ramps)
						   : worst);
}

/* Of independent parts, of which each has its own events, all of them; loads are those of the whole. */
static double worst_of_regions(const struct step *step, int target, bool single)
{
	const struct parts p = parts_of(step);
	double sum = 0;
	if (step->regions.parts == 0)
		return worst_of_search(step, target, single, p.forcings + p.growths);
	for (int i = 0; i < step->regions.parts; i++) {
		const struct step *part = step->regions.part[i];
		sum += part->model->switching->functions > 0
			       ? worst_of_search(part, target, single, i == 0 ? p.forcings + p.growths : 0)
			       : worst_of_plain(part, target, single);
	}
	return sum;
}

static double worst_of_series(const struct step *step, int target, bool single)
{
	double part[WORST_SERIES];
	count_worst_series(step, part);
	const double *each = (step->taylor.switching		? searched
			      : step->model->truncation.adaptive ? tolerant
								: expansions)[target][single];
	/* beside a search what a tolerance takes comes on top */
	const double shortened = step->taylor.switching ? sum_of(WORST_SERIES - WORST_MEASURED,
								 tolerant[target][single] + WORST_MEASURED,
								 part + WORST_MEASURED)
							: 0;
	return sum_of(WORST_SERIES, each, part) + shortened + part[WORST_EXPANSIONS] * worst_of_calls(step, target);
}

/* Of a series beside it whichever takes longer */
static double worst_of_collocation(const struct step *step, int target, bool single)
{
	double part[WORST_COLLOCATION];
	count_worst_collocation(step, part);
	const double newton = sum_of(WORST_COLLOCATION, newtons[target][single], part);
	return step->taylor.expansion ? fmax(worst_of_series(step, target, single), newton) +
						ceil(newtons[target][single][WORST_COLLOCATION] * part[NEWTON_TRIES] *
						     (step->collocation->iteration.multiplications +
						      step->collocation->iteration.additions))
				      : newton;
}

double worst_of_step(const struct step *step, int target, bool single)
{
	const struct model *model = step->model;
	const double *each = ranged[target][single];
	const double worst = step->collocation	    ? worst_of_collocation(step, target, single)
			     : step->taylor.expansion ? worst_of_series(step, target, single)
			     : model->switching	    ? worst_of_regions(step, target, single)
						    : worst_of_linear(step, target, single);
	return model->written->ranges == 0
		       ? worst
		       : ceil(worst + each[0] * model->written->ranges + each[1] * step->branch->system.states);
}

/* On a Cortex-M0 at most 4900 instructions, on ...; that of all internal steps is far above the usual one */
const char *worst_text(const struct step *step)
{
	enum { MANY = 16 };
	const char *text = "";
	const struct truncation *truncation = &step->model->truncation;
	const bool internal = step->collocation || (step->taylor.expansion && truncation->adaptive);
	const int substeps = internal ? truncation->substeps : 0;
	for (int t = 0; worst_target(t); t++)
		text = format("%s%s%.0f on %s", text, !*text ? "" : worst_target(t + 1) ? ", " : " and ",
			      worst_of_step(step, t, step->model->request.single), worst_target(t));
	if (substeps == 0)
		return text;
	return format("%s, with all %d internal steps%s", text, substeps,
		      substeps > MANY ? ", too far above the usual step to be of use: fewer 'substeps' lower it" : "");
}

/* ---- budget N instructions on TARGET for the worst step ---- */

/* As many events as the budget has room for; NULL: not for one */
static const char *fewer_events_text(const struct step *step, int target, double budget)
{
	struct model model = *step->model;
	struct step fewer = *step;
	fewer.model = &model;
	for (int n = max_events(step->model) - 1; n > 0 && model.switching; n = n > 8 ? n / 2 : n - 1) {
		model.most_events = n;
		const double worst = worst_of_step(&fewer, target, model.request.single);
		if (worst <= budget)
			return format("with 'events at most %d a step' it takes at most %.0f", n, worst);
	}
	return NULL;
}

/* The same of internal steps */
static const char *fewer_substeps_text(const struct step *step, int target, double budget)
{
	struct model model = *step->model;
	struct step fewer = *step;
	fewer.model = &model;
	const bool adaptive = step->collocation || (step->taylor.expansion && model.truncation.adaptive);
	for (int n = model.truncation.substeps / 2; n > 0 && adaptive; n /= 2) {
		model.truncation.substeps = n;
		const double worst = worst_of_step(&fewer, target, model.request.single);
		if (worst <= budget)
			return format("with 'substeps %d' it takes at most %.0f", n, worst);
	}
	return NULL;
}

/* What would take less, of the same step */
static const char *cheaper_text(const struct step *step, int target, double budget)
{
	const bool single = step->model->request.single;
	const char *fewer = fewer_events_text(step, target, budget);
	fewer = fewer ? fewer : fewer_substeps_text(step, target, budget);
	if (fewer)
		return fewer;
	if (!single && worst_of_step(step, target, true) <= budget)
		return format("--real float takes at most %.0f", worst_of_step(step, target, true));
	for (int t = 0; worst_target(t); t++)
		if (worst_of_step(step, t, single) <= budget)
			return format("%s takes at most %.0f", worst_target(t), worst_of_step(step, t, single));
	return step->model->switching || step->taylor.expansion
		       ? "a smaller step takes less, for its polynomials have fewer terms, and so do fewer coordinates"
		       : "fewer modes take less (modes N), and so does a model of fewer coordinates";
}

void check_worst(const struct step *step)
{
	const struct budget *budget = &step->model->spec->required.budget;
	struct collector collector = { .scheme = "exact" };
	RATIONAL instructions = ZERO;
	if (step->model->most_events && !step->model->switching && !step->taylor.switching)
		say_warning(step->model->spec->request.events->start, NULL,
			    "the most events have no effect: there are none");
	if (!budget->worst)
		return;
	const int target = worst_target_named(budget->target.name);
	const char *why = unbounded_text(step);
	if (target == NONE)
		error(budget->target.at, "targets: cortex-m0, cortex-m4, cortex-m7", "there is no target '%s'",
		      budget->target.name);
	if (why)
		error(budget->at, NULL, "there is no bound on the instructions of this step: %s", why);
	collect_constant(&collector, budget->instructions, instructions);
	const double most = mpq_get_d(instructions), worst = worst_of_step(step, target, step->model->request.single);
	if (worst > most)
		error(budget->at, cheaper_text(step, target, most),
		      "over budget: the worst step takes at most %.0f instructions on %s, %.0f more than %.0f", worst,
		      worst_target(target), worst - most, most);
}
