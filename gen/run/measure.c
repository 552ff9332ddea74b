/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far a step is off, and what it takes: its C runs from start to end beside a reference. */
#include "run/run.h"

#include <math.h>

/* What is not a number stays one. */
static bool compare_sample(struct trial *trial, struct running *r, const struct course *reference, long k,
			   const double *ends)
{
	const int outputs = reference->outputs;
	const double t = running_time(r) * (1 - 1e-14);
	double *out = trial->error + outputs;
	bool finite = true;
	running_outputs(r, out);
	for (int i = 0; i < outputs; i++) {
		const double error = fabs(out[i] - reference->value[k * outputs + i]);
		if (t > ends[i])
			continue;
		trial->error[i] = error <= trial->error[i] ? trial->error[i] : error;
		finite = finite && isfinite(trial->error[i]);
	}
	return finite;
}

struct trial trial_of(struct running *r, const struct course *reference, const double *start, const double *ends,
		      const struct sampled *drive)
{
	const struct model *model = running_step_of(r)->model;
	struct trial trial = { .error = ARRAY(double, 2 * (size_t)reference->outputs + 1) };
	double *u = ARRAY(double, 2 * (size_t)model->system.inputs + 1);
	running_start(r, 0, NULL);
	if (drive)
		running_drive(r, drive, 0);
	if (start)
		running_start(r, 0, start);
	bool finite = compare_sample(&trial, r, reference, 0, ends);
	const struct counted before = running_counted(r);
	struct counted now = before;
	long k = 0;
	for (; k < reference->samples && finite && !trial.why; k++) {
		if (drive)
			drive_step(drive, k, u);
		running_step(r, u);
		finite = compare_sample(&trial, r, reference, k + 1, ends);
		now = running_counted(r);
		if (running_status(r) != 0)
			trial.why = format("it ends with status %d at t = %.3g s", running_status(r), running_time(r));
		else if (now.multiplications - before.multiplications > LIMIT_MEASURED)
			trial.why = "it takes too long to be measured";
	}
	if (!finite && !trial.why)
		trial.why = format("it leaves the finite numbers at t = %.3g s", running_time(r));
	const double steps = k > 0 ? (double)k : 1;
	trial.multiplications = (double)(now.multiplications - before.multiplications) / steps;
	trial.additions = (double)(now.additions - before.additions) / steps;
	trial.calls = (double)(now.calls - before.calls) / steps;
	return trial;
}
