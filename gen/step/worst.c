/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The most instructions that a step takes. Code without a branch that depends on the state takes the sum of what its
 * operations take at most; of a search, of a series that serves several steps and of Newton's method there is no such
 * sum. */
#include "cost.h"
#include "model/capability.h"
#include "model/checks.h"
#include "collect/collect.h"
#include "step/linear/forms.h"
#include "step/linear/rows.h"

#include <math.h>
#include <string.h>

/* What a bound adds up */
struct parts { double multiplications, additions, forcings, growths, states, flushed, compared, inputs; };

static bool holds_longer(const struct linear *system)
{
	bool longer = false;
	for (int i = 0; i < system->inputs; i++)
		longer = longer || system->input[i].hold > 1;
	return longer;
}

const char *unbounded_text(const struct step *step)
{
	const struct linear *system = &step->branch->system;
	const struct model *model = step->model;
	return !is_linear_alone(step)	     ? model->switching ? "events inside a step are searched"
						       : "linear steps alone have one"
	       : system->segments > 1	     ? "loads change their formula inside a step"
	       : model->written->ranges > 0  ? "states are compared with their ranges"
	       : model->delays		     ? "the step of a core is taken in parts"
	       : peak_outputs(model) > 0     ? "peaks inside a step are searched"
	       : step->modal		     ? "modes are stepped in loops of their own"
	       : step->refresh		     ? "a refresh evaluates functions of loads in some steps"
	       : step->program->calls > 0    ? "it calls functions of <math.h>"
	       : holds_longer(system)	     ? "inputs go through more than two samples"
	       : model->params.tuning	     ? "params are tunable"
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
	double loops[2][LOOPS];     /* a product with its sum; a state that a flush compares; a step */
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
	{ "cortex-m7", { { 1.238, 1.133, 485, 213.4, 0, 11.25, 3.628, 19.49, 1.746 },
			 { 1.575, 1.859, 229.2, 67.11, 0, 9.187, 7.925, 9.02, 0 } },
	  { { 4.2, 30.37, 262.9 }, { 4.75, 36.99, 68.86 } } }
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

double worst_of_step(const struct step *step, int target, bool single)
{
	const struct parts p = parts_of(step);
	const double more = fmax(p.multiplications - 30, 0);
	const double plain[PLAIN] = { p.multiplications, p.additions, p.forcings, p.growths, p.states, p.flushed,
				      p.inputs, 1, more };
	const double loops[LOOPS] = { fmax(p.multiplications, p.additions), p.compared, 1 };
	return step->program->loops ? sum_of(LOOPS, bounds[target].loops[single], loops)
				    : sum_of(PLAIN, bounds[target].plain[single], plain);
}

/* On a Cortex-M0 at most 4900 instructions, on ... */
const char *worst_text(const struct step *step)
{
	const char *text = "";
	for (int t = 0; worst_target(t); t++)
		text = format("%s%s%.0f on %s", text, !*text ? "" : worst_target(t + 1) ? ", " : " and ",
			      worst_of_step(step, t, step->model->request.single), worst_target(t));
	return text;
}

/* ---- budget N instructions on TARGET for the worst step ---- */

/* What would take less, of the same step */
static const char *cheaper_text(const struct step *step, int target, double budget)
{
	const bool single = step->model->request.single;
	if (!single && worst_of_step(step, target, true) <= budget)
		return format("--real float takes at most %.0f", worst_of_step(step, target, true));
	for (int t = 0; worst_target(t); t++)
		if (worst_of_step(step, t, single) <= budget)
			return format("%s takes at most %.0f", worst_target(t), worst_of_step(step, t, single));
	return "fewer modes take less (modes N), and so does a model of fewer coordinates";
}

void check_worst(const struct step *step)
{
	const struct budget *budget = &step->model->spec->required.budget;
	struct collector collector = { .scheme = "exact" };
	RATIONAL instructions = ZERO;
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
