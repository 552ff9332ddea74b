/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An instance of a model that runs here, driven by its descriptor. */
#include "run/run.h"
#include "step/cost.h"

enum { MOST_STEPS = 10000000,       /* of a motion */
       COUNTED_STEPS = 200, MOST_COUNTED = 2000000000 };

struct running {
	const struct step *step;
	struct native native;
	int states, inputs, outputs;
	bool single;
	void *instance;
	void *y, *u, *out, *slope;  /* of the target's type */
};

/* A function of the descriptor, which has two types */
#define CALL(r, call) \
	((r)->single ? ((const pl_modelf *)(r)->native.model)->call : ((const pl_model *)(r)->native.model)->call)

struct opening { struct place at; const struct step *step; enum running_with with; struct native native; };

static void open_native(void *context)
{
	struct opening *o = context;
	o->native = native_of(o->at, o->step, o->with);
}

struct running *running_new(struct place at, const struct step *step, enum running_with with, const char **why)
{
	const struct model *model = step->model;
	struct opening o = { at, step, with, { 0 } };
	(model->request.single ? target_float : target_double)();
	*why = unheard_refusal_of(open_native, &o);
	if (*why)
		return NULL;
	struct running *r = NEW(struct running);
	*r = (struct running){ .step = step, .native = o.native,
			       .states = model->written->system.states, .inputs = model->system.inputs,
			       .outputs = model->outputs, .single = model->request.single };
	r->instance = allocate(1, CALL(r, size));
	r->y = ARRAY(double, r->states + 1);
	r->u = ARRAY(double, 2 * (size_t)r->inputs + 1);
	r->out = ARRAY(double, r->outputs + 1);
	r->slope = ARRAY(double, r->states + 1);
	return r;
}

const struct step *running_step_of(const struct running *r)
{
	return r->step;
}

struct counted running_counted(const struct running *r)
{
	return r->native.counted ? *r->native.counted : (struct counted){ 0 };
}

static void to_target(const struct running *r, const double *from, void *to, int count)
{
	for (int i = 0; i < count; i++) {
		if (r->single)
			((float *)to)[i] = (float)from[i];
		else
			((double *)to)[i] = from[i];
	}
}

static void from_target(const struct running *r, const void *from, double *to, int count)
{
	for (int i = 0; i < count; i++)
		to[i] = r->single ? (double)((const float *)from)[i] : ((const double *)from)[i];
}

void running_start(struct running *r, double t, const double *y)
{
	if (!y) {
		CALL(r, init(r->instance));
		return;
	}
	to_target(r, y, r->y, r->states);
	if (r->single)
		((const pl_modelf *)r->native.model)->set(r->instance, (float)t, r->y);
	else
		((const pl_model *)r->native.model)->set(r->instance, t, r->y);
}

void running_step(struct running *r, const double *u)
{
	to_target(r, u, r->u, r->inputs);
	CALL(r, step(r->instance, r->u));
}

/* The samples of the step before k, and the last one */
void running_drive(struct running *r, const struct sampled *d, long k)
{
	SCRATCH double *u = ARRAY(double, 2 * (size_t)r->inputs + 1);
	drive_at(d, k > 0 ? k - 1 : 0, d->h * (double)(k > 0 ? k - 1 : 0), u);
	to_target(r, u, r->u, r->inputs);
	if (CALL(r, hold != NULL))
		CALL(r, hold(r->instance, r->u));
	if (k > 0) {
		drive_step(d, k - 1, u);
		running_step(r, u);
	}
}

void running_state(struct running *r, double *y)
{
	CALL(r, get(r->instance, r->y));
	from_target(r, r->y, y, r->states);
}

void running_outputs(struct running *r, double *out)
{
	CALL(r, out(r->instance, r->out));
	from_target(r, r->out, out, r->outputs);
}

void running_needed(struct running *r, double *value)
{
	const struct model *model = r->step->model;
	CALL(r, out(r->instance, r->out));
	for (int i = 0; i < model->needs.requirements; i++) {
		const int output = model->needs.requirement[i].output;
		value[i] = r->single ? (double)((const float *)r->out)[output] : ((const double *)r->out)[output];
	}
}

bool running_at(struct running *r, const double *u, double tau, double *y)
{
	if (CALL(r, at == NULL))
		return false;
	to_target(r, u, r->u, r->inputs);
	if (r->single)
		((const pl_modelf *)r->native.model)->at(r->instance, r->u, (float)tau, r->y);
	else
		((const pl_model *)r->native.model)->at(r->instance, r->u, tau, r->y);
	from_target(r, r->y, y, r->states);
	return true;
}

double running_time(struct running *r)
{
	return CALL(r, time(r->instance));
}

int running_status(struct running *r)
{
	return CALL(r, status(r->instance));
}

/* NAME_rhs takes inputs where there are any, and numbers of the target's type. */
void running_rhs(struct running *r, double t, const double *y, const double *u, double *slope)
{
	to_target(r, y, r->y, r->states);
	to_target(r, u, r->u, 2 * r->inputs);
	typedef void driven(double t, const double *y, const double *u, double *slope);
	typedef void drivenf(float t, const float *y, const float *u, float *slope);
	typedef void alone(double t, const double *y, double *slope);
	typedef void alonef(float t, const float *y, float *slope);
	const void *rhs = r->native.rhs;
	if (r->inputs > 0 && r->single)
		((drivenf *)rhs)((float)t, r->y, r->u, r->slope);
	else if (r->inputs > 0)
		((driven *)rhs)(t, r->y, r->u, r->slope);
	else if (r->single)
		((alonef *)rhs)((float)t, r->y, r->slope);
	else
		((alone *)rhs)(t, r->y, r->slope);
	from_target(r, r->slope, slope, r->states);
}

const char *motion_to(struct place at, const struct step *step, long steps, double *y)
{
	const char *why;
	struct running *r = steps > MOST_STEPS ? NULL : running_new(at, step, 0, &why);
	if (steps > MOST_STEPS)
		return format("it takes more than %d steps", MOST_STEPS);
	if (!r)
		return why;
	double *u = ARRAY(double, r->inputs + 1);
	running_start(r, 0, NULL);
	for (long k = 0; k < steps; k++) {
		running_step(r, u);
		if (running_status(r) != 0)
			return format("it ends with status %d at t = %.6g", running_status(r), running_time(r));
	}
	running_state(r, y);
	return NULL;
}

/* Of the operations from one count to the next */
static double instructions_between(const struct step *step, struct counted from, struct counted to)
{
	return instructions_of(step, (struct operations){ (double)(to.multiplications - from.multiplications),
							  (double)(to.additions - from.additions),
							  (double)(to.calls - from.calls),
							  (double)(to.forcings - from.forcings),
							  (double)(to.waits - from.waits),
							  (double)(to.pieces - from.pieces),
							  (double)(to.events - from.events),
							  (double)(to.terms - from.terms) });
}

struct board_cost board_cost_of(struct place at, const struct step *step)
{
	struct board_cost cost = { 0 };
	struct running *r = running_new(at, step, WITH_COUNTS, &cost.why);
	if (!r)
		return cost;
	double *u = ARRAY(double, r->inputs + 1), sum = 0;
	running_start(r, 0, NULL);
	while (cost.steps < COUNTED_STEPS && sum < MOST_COUNTED && running_status(r) == 0) {
		const struct counted before = running_counted(r);
		running_step(r, u);
		const double now = instructions_between(step, before, running_counted(r));
		sum += now;
		cost.most = now > cost.most ? now : cost.most;
		cost.steps++;
	}
	cost.mean = sum / cost.steps;
	cost.bytes = (long)CALL(r, size);
	return cost;
}
