/* SPDX-License-Identifier: MIT-0 */
/* plfmu.h: a model as an FMU for co-simulation, what FMI 2.0 and 3.0 have in common.  fmi2.c and fmi3.c are its two
 * faces; fmu_model.h, which plgen writes, says which model:
 *
 *     fmu_state, fmu_real, fmu_model        types: of its state, of its numbers, of its descriptor
 *     FMU_MODEL                             its descriptor
 *     FMU_STATES, FMU_INPUTS, ...           how many there are
 *     fmu_constant                          values of the params that nothing changes
 *     FMU_H                                 step [s], as a double whatever the model's type
 *     FMU_TOKEN, FMU_MARK                   what the importer has to name; the same as a number
 *     FMU_DERIVATIVES                       not there: it has none; else fmu_derived, FMU_COLUMNS, FMU_SEEDED,
 *                                           FMU_ZERO(ds), and the columns of inputs and params, -1: it has none
 *     FMU_CROSSED(s)                        crossings of its breakpoints since the start; not there: it has none
 *
 * Value references: 0 time, then the inputs, the outputs, the tunable params, the states and the other params, in the
 * model's order.
 *
 * All that a simulation changes is one struct without pointers, so a saved state is a copy of its bytes.  Memory is
 * asked for when an instance is made, and when the importer asks for a state to be saved and brings none; never in a
 * step.
 */
#ifndef PLFMU_H
#define PLFMU_H

#include "fmu_model.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum fmu_mode { FMU_INSTANTIATED, FMU_INITIALIZING, FMU_STEPPING, FMU_TERMINATED };
enum fmu_result { FMU_OK, FMU_WARNING, FMU_ERROR }; /* their numbers differ from one FMI to the other */

/* Arrays have one place more than is used: C knows none without any. */
typedef struct fmu_data {
	fmu_state state;
	fmu_real u[FMU_INPUTS + 1];      /* as the importer has set them */
	fmu_real last[FMU_INPUTS + 1];   /* the sample at which the last step has ended: where a ramp begins */
	fmu_real params[FMU_PARAMS + 1]; /* as the importer has set them */
	fmu_real start[FMU_STATES + 1];  /* states at the start */
	double t0;                       /* [s]; time is t0 + steps FMU_H */
	uint64_t steps;
	int mode;                        /* enum fmu_mode */
	int reported;                    /* bits of the model's status that were logged */
	int retunes;                     /* 1: the params are not yet those of the model's state */
	int starts;                      /* 1: nor are the start values, time and inputs */
	int moved;                       /* 1: the start is at another time, or from other states, than the spec's */
} fmu_data;

/* What the importer sees as a saved state. */
typedef struct fmu_saved {
	uint64_t mark; /* FMU_MARK */
	fmu_data data;
} fmu_saved;

typedef struct fmu_instance {
	fmu_data data;
	void (*log)(struct fmu_instance *i, enum fmu_result result, const char *text);
	void *environment;
	void (*callback)(void); /* the importer's, of whatever type it is */
	bool logs_warnings, logs_errors;
	bool may_return_early; /* the importer lets a call end before its length */
	char name[1];          /* longer */
} fmu_instance;

/* ---- what is logged ---- */

static const char fmu_category_warning[] = "logStatusWarning", fmu_category_error[] = "logStatusError";

#ifdef __GNUC__
__attribute__((format(printf, 3, 4)))
#endif
static enum fmu_result fmu_say(fmu_instance *i, enum fmu_result result, const char *format, ...)
{
	char text[256];
	va_list values;
	if (result == FMU_WARNING ? !i->logs_warnings : !i->logs_errors) {
		return result;
	}
	va_start(values, format);
	vsnprintf(text, sizeof text, format, values);
	va_end(values);
	i->log(i, result, text);
	return result;
}

static enum fmu_result fmu_logging(fmu_instance *i, bool on, size_t count, const char *const category[])
{
	bool warnings = on && count == 0, errors = warnings;
	size_t k;
	for (k = 0; k < count; k++) {
		if (strcmp(category[k], fmu_category_warning) == 0) {
			warnings = on;
		} else if (strcmp(category[k], fmu_category_error) == 0) {
			errors = on;
		} else {
			return fmu_say(i, FMU_ERROR, "there is no log category '%s'", category[k]);
		}
	}
	i->logs_warnings = warnings;
	i->logs_errors = errors;
	return FMU_OK;
}

/* Of functions that the standard declares and this FMU does not offer */
static enum fmu_result fmu_absent(fmu_instance *i, const char *function)
{
	return i ? fmu_say(i, FMU_ERROR, "%s: this FMU does not offer it", function) : FMU_ERROR;
}

static enum fmu_result fmu_out_of_place(fmu_instance *i, const char *function)
{
	return fmu_say(i, FMU_ERROR, "%s must not be called now", function);
}

/* ---- from an instance to its start ---- */

static double fmu_time(const fmu_data *d)
{
	return d->t0 + (double)d->steps * FMU_H;
}

static void fmu_begin(fmu_data *d)
{
	int k;
	memset(d, 0, sizeof *d);
	FMU_MODEL.init(&d->state);
	FMU_MODEL.get(&d->state, d->start);
	for (k = 0; k < FMU_PARAMS; k++) {
		d->params[k] = FMU_MODEL.param_values[k];
	}
}

static fmu_instance *fmu_new(const char *name, const char *token)
{
	const size_t length = name ? strlen(name) : 0;
	fmu_instance *i;
	if (!token || strcmp(token, FMU_TOKEN) != 0) {
		return NULL;
	}
	i = (fmu_instance *)calloc(1, sizeof *i + length);
	if (i) {
		memcpy(i->name, name ? name : "", length + 1);
		fmu_begin(&i->data);
	}
	return i;
}

static bool fmu_is_ramp(int input)
{
	return FMU_INPUTS > 0 && FMU_MODEL.start_samples[input] == 1;
}

static enum fmu_result fmu_retune(fmu_instance *i)
{
	fmu_data *d = &i->data;
	int status;
	if (!d->retunes || FMU_PARAMS == 0) {
		return FMU_OK;
	}
	status = FMU_MODEL.retune(&d->state, d->params, (fmu_real)FMU_H);
	if (status & PL_SINGULAR) {
		return fmu_say(i, FMU_ERROR, "with these params the mass matrix has no inverse, or something is "
			"divided by 0");
	}
	if (status & PL_OUT_OF_RANGE) {
		return fmu_say(i, FMU_ERROR,
			"these params are outside of the ranges that the spec gives, or make other regions: a "
				"restitution not "
			"within 0 and 1, a gap or a force of friction below 0, breakpoints in another order");
	}
	if (status & PL_NO_RATE) {
		return fmu_say(i, FMU_ERROR, "with these params the frequency of a load is below 0");
	}
	if (status) {
		return fmu_say(i, FMU_ERROR, "with these params a coefficient is infinite, or not a number");
	}
	d->retunes = 0;
	return FMU_OK;
}

/* The model's state as what was set says: before it is looked at, and before a step. */
static enum fmu_result fmu_settle(fmu_instance *i)
{
	fmu_data *d = &i->data;
	enum fmu_result result;
	int k;
	if (d->starts) {
		FMU_MODEL.init(&d->state);
		for (k = 0; k < FMU_PARAMS; k++) {
			d->retunes = d->retunes || d->params[k] != FMU_MODEL.param_values[k];
		}
	}
	result = fmu_retune(i);
	if (result != FMU_OK || !d->starts) {
		return result;
	}
	if (d->moved) {
		FMU_MODEL.set(&d->state, (fmu_real)d->t0, d->start);
	}
	if (FMU_MODEL.hold) {
		FMU_MODEL.hold(&d->state, d->u);
	}
	memcpy(d->last, d->u, sizeof d->last);
	d->starts = 0;
	return FMU_OK;
}

/* Before the first step the start is made anew. */
static void fmu_restart(fmu_data *d, bool moved)
{
	if (d->mode == FMU_STEPPING) {
		return;
	}
	d->starts = 1;
	d->moved = d->moved || moved;
}

static enum fmu_result fmu_initialize(fmu_instance *i, double t0)
{
	fmu_data *d = &i->data;
	if (!(t0 - t0 >= 0.0)) {
		return fmu_say(i, FMU_ERROR, "the start time is not a finite number");
	}
	d->t0 = t0;
	fmu_restart(d, t0 != 0.0);
	return FMU_OK;
}

static enum fmu_result fmu_enter(fmu_instance *i, const char *function)
{
	if (i->data.mode != FMU_INSTANTIATED) {
		return fmu_out_of_place(i, function);
	}
	i->data.mode = FMU_INITIALIZING;
	fmu_restart(&i->data, false);
	return FMU_OK;
}

static enum fmu_result fmu_leave(fmu_instance *i, const char *function)
{
	enum fmu_result result;
	if (i->data.mode != FMU_INITIALIZING) {
		return fmu_out_of_place(i, function);
	}
	result = fmu_settle(i);
	if (result == FMU_OK) {
		i->data.mode = FMU_STEPPING;
	}
	return result;
}

static enum fmu_result fmu_end(fmu_instance *i, const char *function)
{
	if (i->data.mode != FMU_STEPPING) {
		return fmu_out_of_place(i, function);
	}
	i->data.mode = FMU_TERMINATED;
	return FMU_OK;
}

/* ---- values ---- */

enum fmu_kind {
	FMU_KIND_TIME, FMU_KIND_INPUT, FMU_KIND_OUTPUT, FMU_KIND_PARAM, FMU_KIND_STATE, FMU_KIND_CONSTANT, FMU_KIND_NONE
};

/* Which a value reference names; *index: the place among its kind */
static enum fmu_kind fmu_find(uint32_t reference, uint32_t *index)
{
	static const uint32_t count[] = {1, FMU_INPUTS, FMU_OUTPUTS, FMU_PARAMS, FMU_STATES, FMU_CONSTANTS};
	int kind;
	for (kind = FMU_KIND_TIME; kind < FMU_KIND_NONE; kind++) {
		if (reference < count[kind]) {
			break;
		}
		reference -= count[kind];
	}
	*index = reference;
	return (enum fmu_kind)kind;
}

static enum fmu_result fmu_no_such(fmu_instance *i, uint32_t reference)
{
	return fmu_say(i, FMU_ERROR, "no variable of this type has the value reference %lu", (unsigned long)reference);
}

static enum fmu_result fmu_get(fmu_instance *i, const uint32_t *reference, size_t count, double *value)
{
	fmu_real out[FMU_OUTPUTS + 1], y[FMU_STATES + 1];
	enum fmu_result result = fmu_settle(i);
	uint32_t at;
	size_t k;
	if (result != FMU_OK) {
		return result;
	}
	FMU_MODEL.out(&i->data.state, out);
	FMU_MODEL.get(&i->data.state, y);
	for (k = 0; k < count; k++) {
		switch (fmu_find(reference[k], &at)) {
		case FMU_KIND_TIME: value[k] = fmu_time(&i->data); break;
		case FMU_KIND_INPUT: value[k] = (double)i->data.u[at]; break;
		case FMU_KIND_OUTPUT: value[k] = (double)out[at]; break;
		case FMU_KIND_PARAM: value[k] = (double)i->data.params[at]; break;
		case FMU_KIND_STATE: value[k] = (double)y[at]; break;
		case FMU_KIND_CONSTANT: value[k] = fmu_constant[at]; break;
		case FMU_KIND_NONE: return fmu_no_such(i, reference[k]);
		}
	}
	return FMU_OK;
}

#ifdef FMU_DERIVATIVES
static int fmu_column(uint32_t reference)
{
	uint32_t at;
	const enum fmu_kind kind = fmu_find(reference, &at);
	return kind == FMU_KIND_INPUT ? fmu_column_of_input[at] : kind == FMU_KIND_PARAM ? fmu_column_of_param[at] : -1;
}

/* Of outputs by inputs and tunable params, at the state of now: J[output][column] */
static void fmu_jacobian(const fmu_data *d, fmu_real *J)
{
	fmu_state scratch;
	fmu_derived ds;
	FMU_DERIVATIVES.init(&scratch, &ds);
	FMU_ZERO(&ds);
#if FMU_SEEDED
	{
		int k;
		for (k = 0; k < FMU_INPUTS; k++) {
			ds.du[k] = 1;
		}
	}
#endif
	FMU_DERIVATIVES.out(&d->state, &ds, J);
}
#endif

/* J seed of the unknowns, or, backwards, its transpose of the knowns */
static enum fmu_result fmu_derivative(fmu_instance *i, const char *function, bool backwards, const uint32_t *unknown,
	size_t unknowns, const uint32_t *known, size_t knowns, const double *seed, double *sensitivity)
{
#ifdef FMU_DERIVATIVES
	fmu_real J[FMU_OUTPUTS * FMU_COLUMNS];
	enum fmu_result result = fmu_settle(i);
	uint32_t output;
	size_t r, k;
	int column;
	(void)function;
	if (result != FMU_OK) {
		return result;
	}
	fmu_jacobian(&i->data, J);
	for (r = 0; r < (backwards ? knowns : unknowns); r++) {
		sensitivity[r] = 0.0;
	}
	for (r = 0; r < unknowns; r++) {
		if (fmu_find(unknown[r], &output) != FMU_KIND_OUTPUT) {
			return fmu_say(i, FMU_ERROR, "outputs have derivatives, and value reference %lu is none",
						   (unsigned long)unknown[r]);
		}
		for (k = 0; k < knowns; k++) {
			column = fmu_column(known[k]);
			if (column < 0) {
				return fmu_say(i, FMU_ERROR, "there is no derivative by the variable of value "
					"reference %lu",
							   (unsigned long)known[k]);
			}
			sensitivity[backwards ? k : r] += (double)J[output * FMU_COLUMNS + (uint32_t)column] *
											  seed[backwards ? r : k];
		}
	}
	return FMU_OK;
#else
	(void)backwards;
	(void)unknown;
	(void)unknowns;
	(void)known;
	(void)knowns;
	(void)seed;
	(void)sensitivity;
	return fmu_absent(i, function);
#endif
}

static enum fmu_result fmu_set_one(fmu_instance *i, uint32_t reference, double value)
{
	fmu_data *d = &i->data;
	uint32_t at;
	switch (fmu_find(reference, &at)) {
	case FMU_KIND_INPUT:
		d->u[at] = (fmu_real)value;
		fmu_restart(d, false);
		return FMU_OK;
	case FMU_KIND_PARAM:
		d->params[at] = (fmu_real)value;
		d->retunes = 1;
		fmu_restart(d, false);
		return FMU_OK;
	case FMU_KIND_STATE:
		if (d->mode == FMU_STEPPING) {
			return fmu_say(i, FMU_ERROR, "a state can be set before the first step only");
		}
		d->start[at] = (fmu_real)value;
		fmu_restart(d, true);
		return FMU_OK;
	case FMU_KIND_TIME:
	case FMU_KIND_OUTPUT:
	case FMU_KIND_CONSTANT:
		return fmu_say(i, FMU_ERROR, "the variable of value reference %lu cannot be "
			"set", (unsigned long)reference);
	case FMU_KIND_NONE: break;
	}
	return fmu_no_such(i, reference);
}

static enum fmu_result fmu_set(fmu_instance *i, const uint32_t *reference, size_t count, const double *value)
{
	enum fmu_result result = FMU_OK;
	size_t k;
	if (i->data.mode == FMU_TERMINATED) {
		return fmu_say(i, FMU_ERROR, "values must not be set after the end");
	}
	for (k = 0; k < count && result == FMU_OK; k++) {
		result = fmu_set_one(i, reference[k], value[k]);
	}
	return result;
}

/* ---- steps ---- */

/* What has newly come to the model's status, which keeps it */
static enum fmu_result fmu_look(fmu_instance *i)
{
	fmu_data *d = &i->data;
	const int status = FMU_MODEL.status(&d->state), fresh = status & ~d->reported;
	d->reported |= status;
	if (status & PL_NOT_FINITE) {
		return fmu_say(i, FMU_ERROR, "at %.9g s a state is infinite, or not a number", fmu_time(d));
	}
	if (fresh & PL_TOO_MANY_EVENTS) {
		return fmu_say(i, FMU_WARNING, "up to %.9g s a step has met more crossings than its "
			"bound", fmu_time(d));
	}
	if (fresh & PL_UNDECIDED) {
		return fmu_say(i, FMU_WARNING, "up to %.9g s no combination of stick and slip was valid at an event",
					   fmu_time(d));
	}
	if (fresh & PL_PENETRATED) {
		return fmu_say(i, FMU_WARNING, "up to %.9g s a step has ended beyond a stop", fmu_time(d));
	}
	if (fresh & PL_SINGULAR_MASS) {
		return fmu_say(i, FMU_ERROR, "up to %.9g s the mass matrix was singular", fmu_time(d));
	}
	if (fresh & PL_TOO_MANY_STEPS) {
		return fmu_say(i, FMU_ERROR, "up to %.9g s a step needed more substeps than its bound", fmu_time(d));
	}
	if (fresh & PL_INACCURATE) {
		return fmu_say(i, FMU_WARNING, "up to %.9g s a step was less exact than its tolerance", fmu_time(d));
	}
	if (fresh & PL_LEFT_RANGE) {
		return fmu_say(i, FMU_WARNING, "up to %.9g s a state has left the range that the spec gives "
			"it", fmu_time(d));
	}
	return FMU_OK;
}

/* How many steps of h lie in `length`; 0: it is no multiple of h, but for rounding of lengths and of times */
static uint64_t fmu_steps_in(double time, double length)
{
	const double steps = length / FMU_H, size = time < 0.0 ? -time : time;
	const double room = 1e-6 * steps + 1e-15 * (size / FMU_H);
	double whole;
	if (!(steps >= 0.5 && steps < 1e15)) {
		return 0;
	}
	whole = (double)(uint64_t)(steps + 0.5);
	return steps - whole <= room && whole - steps <= room ? (uint64_t)whole : 0;
}

static uint64_t fmu_crossed(const fmu_data *d)
{
#ifdef FMU_CROSSED
	return FMU_CROSSED(&d->state);
#else
	(void)d;
	return 0;
#endif
}

/* Held inputs act as they were set, ramps reach what was set at the end, over all steps of the call.  early: the call
 * ends with the step in which a breakpoint was crossed, and a ramp is where it was on its way.  How many were done. */
static uint64_t fmu_advance(fmu_data *d, uint64_t steps, bool early)
{
	const uint64_t crossed = fmu_crossed(d);
	fmu_real u[FMU_INPUTS + 1];
	uint64_t k = 0;
	int j;
	memcpy(u, d->u, sizeof u);
	while (k < steps && !(early && fmu_crossed(d) != crossed)) {
		k++;
		for (j = 0; j < FMU_INPUTS && k < steps; j++) {
			if (fmu_is_ramp(j)) {
				u[j] = d->last[j] + (d->u[j] - d->last[j]) * ((fmu_real)k / (fmu_real)steps);
			}
		}
		if (k == steps) {
			memcpy(u, d->u, sizeof u);
		}
		FMU_MODEL.step(&d->state, u);
	}
	memcpy(d->last, u, sizeof d->last);
	d->steps += k;
	return k;
}

/* *early: whether the call ended before its length */
static enum fmu_result fmu_step(fmu_instance *i, double time, double length, const char *function, bool *early)
{
	fmu_data *d = &i->data;
	const double late = time - fmu_time(d);
	enum fmu_result result;
	uint64_t steps;
	*early = false;
	if (d->mode != FMU_STEPPING) {
		return fmu_out_of_place(i, function);
	}
	if (!(late > -0.01 * FMU_H && late < 0.01 * FMU_H)) { /* what importers add up is rounded */
		return fmu_say(i, FMU_ERROR, "a step from %.9g s is asked for, and the model is at %.9g "
			"s", time, fmu_time(d));
	}
	steps = fmu_steps_in(time, length);
	if (steps == 0) {
		return fmu_say(i, FMU_ERROR, "%.9g s is no multiple of the step, %.9g s", length, FMU_H);
	}
	result = fmu_settle(i);
	if (result != FMU_OK) {
		return result;
	}
	*early = fmu_advance(d, steps, i->may_return_early) < steps;
	return fmu_look(i);
}

/* ---- saved states ---- */

static enum fmu_result fmu_save(fmu_instance *i, void **saved)
{
	fmu_saved *to = (fmu_saved *)(*saved ? *saved : calloc(1, sizeof *to));
	if (!to) {
		return fmu_say(i, FMU_ERROR, "out of memory");
	}
	to->mark = FMU_MARK;
	memcpy(&to->data, &i->data, sizeof to->data);
	*saved = to;
	return FMU_OK;
}

static enum fmu_result fmu_restore(fmu_instance *i, const void *saved)
{
	const fmu_saved *from = (const fmu_saved *)saved;
	if (!from || from->mark != FMU_MARK) {
		return fmu_say(i, FMU_ERROR, "this is no state of this FMU");
	}
	memcpy(&i->data, &from->data, sizeof i->data);
	return FMU_OK;
}

static enum fmu_result fmu_serialize(fmu_instance *i, const void *saved, void *bytes, size_t size)
{
	if (!saved || size < sizeof(fmu_saved)) {
		return fmu_say(i, FMU_ERROR, "a serialized state takes %lu bytes", (unsigned long)sizeof(fmu_saved));
	}
	memcpy(bytes, saved, sizeof(fmu_saved));
	return FMU_OK;
}

static enum fmu_result fmu_deserialize(fmu_instance *i, const void *bytes, size_t size, void **saved)
{
	uint64_t mark = 0;
	if (size >= sizeof mark) {
		memcpy(&mark, bytes, sizeof mark);
	}
	if (size < sizeof(fmu_saved) || mark != FMU_MARK) {
		return fmu_say(i, FMU_ERROR, "these bytes are no state of this FMU");
	}
	if (!*saved) {
		*saved = calloc(1, sizeof(fmu_saved));
	}
	if (!*saved) {
		return fmu_say(i, FMU_ERROR, "out of memory");
	}
	memcpy(*saved, bytes, sizeof(fmu_saved));
	return FMU_OK;
}

#endif
