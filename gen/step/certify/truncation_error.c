/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What outputs lose with the modes that are dropped, at every sample. */
#include "inner.h"
#include "model/linear/modal_truncation.h"

#include <math.h>

/* ---- what is lost with modes ---- */

struct mode_error {                 /* of one output, summed over modes */
	long steps;
	bool lasts;                 /* too long to be walked through: modes are not traced, their bounds are added */
	double *trace, **input;     /* at each sample; m steps after a sample of an input */
	double slack;               /* how far what is found may be off; of long runs a bound of all that is lost */
};

static void add_lasting_mode_error(const struct step *step, const struct step_map *k, const struct spread *spread,
			     struct mode_error *mode_error)
{
	const struct linear *system = &step->branch->system;
	const double h = mpq_get_d(step->model->h);
	mode_error->slack += lasting_output(k, spread, h) + slopes_of_inputs(system, k, h);
	for (int i = 0, c = 0; i < system->inputs; c += system->input[i++].hold + 1)
		mode_error->slack += lasting_input(system, spread, k, i, c);
}

/* One more mode is dropped: `step` is that of what is lost with it. */
static bool add_mode_error(const struct step *step, const struct requirement *r, struct mode_error *mode_error)
{
	const struct linear *system = &step->branch->system;
	const struct errors e = errors_of(step, r);
	if (certificate_objection(&e))
		return false;
	struct step_map *k = step_map_of(&e, step);
	const struct spread spread = spread_of(k->n, k->Phi, e.steps + 1);
	if (!spread.known)
		return false;
	if (mode_error->lasts) {
		add_lasting_mode_error(step, k, &spread, mode_error);
		return true;
	}
	mode_error->slack += walk_loads(e.steps, mpq_get_d(step->model->h), &spread, k, mode_error->trace).slack;
	for (int i = 0, c = 0; i < system->inputs; c += system->input[i++].hold + 1)
		mode_error->slack += sum_of_input(system, e.steps, k, i, c, mode_error->input[i]) *
			       (1e-9 + spread.slack * (double)e.steps);
	mode_error->slack += slopes_of_inputs(system, k, mpq_get_d(step->model->h));
	return true;
}

static double size_of_mode_error(const struct mode_error *mode_error, const struct linear *system,
				 const struct requirement *r)
{
	double most = 0, inputs = 0;
	for (long m = 0; m <= mode_error->steps; m++)
		most = fmax(most, fabs(mode_error->trace[m]));
	for (int i = 0; i < system->inputs; i++) {
		double sum = 0;
		for (long m = 0; m < mode_error->steps; m++)
			sum += fabs(mode_error->input[i][m]);
		inputs += sum * mpq_get_d(r->most[i]);
	}
	return (most + inputs) * (1 + 1e-9) + mode_error->slack;
}

static struct mode_error no_mode_error(const struct linear *system, long steps)
{
	struct mode_error mode_error = { .steps = steps,
			     .trace = ARRAY(double, steps + 1),
			     .input = ARRAY(double *, system->inputs) };
	for (int i = 0; i < system->inputs; i++)
		mode_error.input[i] = ARRAY(double, steps + 1);
	return mode_error;
}

static void mode_error_free(const struct mode_error *mode_error, const struct linear *system)
{
	discard(mode_error->trace);
	for (int i = 0; i < system->inputs; i++)
		discard(mode_error->input[i]);
}

struct building_mode_error { struct model *error; struct step *step; };

static void build_mode_error(void *context)
{
	struct building_mode_error *b = context;
	b->error->written = b->error;
	b->error->request.form = FORM_DIRECT;
	b->error->request.refresh = b->error->request.rows = 1;
	b->error->request.many.batch = b->error->request.selftest = false;
	b->step = step_build(b->error);
	if (!b->step)
		abandon();
}

/* What is lost with one mode, as a step in double; NULL: it is not found */
static struct step *step_of_mode_error(struct modes *modes, int mode, bool static_correction)
{
	SCRATCH bool *kept = ARRAY(bool, modes->count);
	for (int i = 0; i < modes->count; i++)
		kept[i] = i != mode;
	struct building_mode_error b = { .error = modes_dropped(modes, kept, static_correction) };
	return b.error && silent_guard(build_mode_error, &b) ? b.step : NULL;
}

double *truncation_errors_of(struct modes *modes, const int *order, bool static_correction, const struct requirement *r)
{
	const struct linear *system = &modes->model->system;
	const long steps = samples_until(r, modes->model->h);
	double *lost = ARRAY(double, modes->count + 1);
	const struct step_map shape = { .n = 2, .columns = load_columns(system) };
	bool good = steps >= 0;
	const bool lasts = good && is_lasting(&shape, steps);
	struct mode_error mode_error = no_mode_error(system, good && !lasts ? steps : 0);
	mode_error.lasts = lasts;
	for (int c = modes->count - 1; c >= 0; c--) {
		const struct step *step = good ? step_of_mode_error(modes, order[c], static_correction) : NULL;
		good = step && add_mode_error(step, r, &mode_error);
		lost[c] = good ? size_of_mode_error(&mode_error, system, r) : HUGE_VAL;
	}
	mode_error_free(&mode_error, system);
	return lost;
}
