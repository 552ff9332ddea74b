/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What outputs lose with the modes that are dropped, at every sample. */
#include "inner.h"
#include "model/linear/modal_truncation.h"

#include <math.h>

/* ---- what is lost with modes ---- */

struct loss {                       /* of one output, summed over modes */
	long steps;
	bool lasts;                 /* too long to be walked through: modes are not traced, their bounds are added */
	double *trace, **input;     /* at each sample; m steps after a sample of an input */
	double slack;               /* how far what is found may be off; of long runs a bound of all that is lost */
};

static void add_lasting_loss(const struct step *step, const struct step_map *k, const struct spread *spread,
			     struct loss *loss)
{
	const struct linear *system = &step->branch->system;
	const double h = mpq_get_d(step->model->h);
	loss->slack += lasting_output(k, spread, h) + slopes_of_inputs(system, k, h);
	for (int i = 0, c = 0; i < system->inputs; c += system->input[i++].hold + 1)
		loss->slack += lasting_input(system, spread, k, i, c);
}

/* One more mode is dropped: `step` is that of what is lost with it. */
static bool add_loss(const struct step *step, const struct requirement *r, struct loss *loss)
{
	const struct linear *system = &step->branch->system;
	const struct errors e = errors_of(step, r);
	if (certificate_objection(&e))
		return false;
	struct step_map *k = step_map_of(&e, step);
	const struct spread spread = spread_of(k->n, k->Phi, e.steps + 1);
	if (!spread.known)
		return false;
	if (loss->lasts) {
		add_lasting_loss(step, k, &spread, loss);
		return true;
	}
	loss->slack += walk_loads(e.steps, mpq_get_d(step->model->h), &spread, k, loss->trace).slack;
	for (int i = 0, c = 0; i < system->inputs; c += system->input[i++].hold + 1)
		loss->slack += sum_of_input(system, e.steps, k, i, c, loss->input[i]) *
			       (1e-9 + spread.slack * (double)e.steps);
	loss->slack += slopes_of_inputs(system, k, mpq_get_d(step->model->h));
	return true;
}

static double size_of_loss(const struct loss *loss, const struct linear *system, const struct requirement *r)
{
	double most = 0, inputs = 0;
	for (long m = 0; m <= loss->steps; m++)
		most = fmax(most, fabs(loss->trace[m]));
	for (int i = 0; i < system->inputs; i++) {
		double sum = 0;
		for (long m = 0; m < loss->steps; m++)
			sum += fabs(loss->input[i][m]);
		inputs += sum * mpq_get_d(r->most[i]);
	}
	return (most + inputs) * (1 + 1e-9) + loss->slack;
}

static struct loss no_loss(const struct linear *system, long steps)
{
	struct loss loss = { .steps = steps,
			     .trace = ARRAY(double, steps + 1),
			     .input = ARRAY(double *, system->inputs) };
	for (int i = 0; i < system->inputs; i++)
		loss.input[i] = ARRAY(double, steps + 1);
	return loss;
}

static void loss_free(const struct loss *loss, const struct linear *system)
{
	discard(loss->trace);
	for (int i = 0; i < system->inputs; i++)
		discard(loss->input[i]);
}

struct building_loss { struct model *error; struct step *step; };

static void build_loss(void *context)
{
	struct building_loss *b = context;
	b->error->written = b->error;
	b->error->asked.form = FORM_DIRECT;
	b->error->asked.refresh = b->error->asked.rows = 1;
	b->error->asked.batch = b->error->asked.selftest = false;
	b->step = step_build(b->error);
	if (!b->step)
		abandon();
}

/* What is lost with one mode, as a step in double; NULL: it is not found */
static struct step *step_of_loss(struct modes *modes, int mode, bool static_correction)
{
	SCRATCH bool *kept = ARRAY(bool, modes->count);
	for (int i = 0; i < modes->count; i++)
		kept[i] = i != mode;
	struct building_loss b = { .error = modes_dropped(modes, kept, static_correction) };
	return b.error && silent_guard(build_loss, &b) ? b.step : NULL;
}

double *truncation_errors_of(struct modes *modes, const int *order, bool static_correction, const struct requirement *r)
{
	const struct linear *system = &modes->model->system;
	const long steps = samples_until(r, modes->model->h);
	double *lost = ARRAY(double, modes->count + 1);
	const struct step_map shape = { .n = 2, .columns = load_columns(system) };
	bool good = steps >= 0;
	const bool lasts = good && is_lasting(&shape, steps);
	struct loss loss = no_loss(system, good && !lasts ? steps : 0);
	loss.lasts = lasts;
	for (int c = modes->count - 1; c >= 0; c--) {
		const struct step *step = good ? step_of_loss(modes, order[c], static_correction) : NULL;
		good = step && add_loss(step, r, &loss);
		lost[c] = good ? size_of_loss(&loss, system, r) : HUGE_VAL;
	}
	loss_free(&loss, system);
	return lost;
}
