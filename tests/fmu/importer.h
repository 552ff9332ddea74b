/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An FMU as a program sees it that knows nothing of plgen, in the words of FMI 2.0 (FMI=2) or 3.0 (FMI=3). */
#ifndef IMPORTER_H
#define IMPORTER_H

#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if FMI == 2
#include "fmi2Functions.h"
#define OF_VERSION(name) fmi2##name
#define OK fmi2OK
#define GET fmi2GetReal
#define SET fmi2SetReal
#define SAVE fmi2GetFMUstate
#define RESTORE fmi2SetFMUstate
#define FORGET fmi2FreeFMUstate
#define SIZE fmi2SerializedFMUstateSize
#define SERIALIZE fmi2SerializeFMUstate
#define DESERIALIZE fmi2DeSerializeFMUstate
#else
#include "fmi3Functions.h"
#define OF_VERSION(name) fmi3##name
#define OK fmi3OK
#define GET fmi3GetFloat64
#define SET fmi3SetFloat64
#define SAVE fmi3GetFMUState
#define RESTORE fmi3SetFMUState
#define FORGET fmi3FreeFMUState
#define SIZE fmi3SerializedFMUStateSize
#define SERIALIZE fmi3SerializeFMUState
#define DESERIALIZE fmi3DeserializeFMUState
#endif

/* A function of the shared object; the program ends where it is not there */
static void *function_of(void *object, const char *name)
{
	void *f = dlsym(object, name);
	if (!f) {
		printf("not ok - %s is not there: %s\n", name, dlerror());
		exit(1);
	}
	return f;
}

#define TEXT(name) TEXT_OF(name)
#define TEXT_OF(name) #name
#define TYPE(name) TYPE_OF(name)
#define TYPE_OF(name) name##TYPE
/* its pointer through memory: ISO C has no cast from an object's */
#define CALL(f, name) (*(TYPE(name) **)(void *[]){ function_of((f)->object, TEXT(name)) })

struct fmu {
	void *object;
	const char *token;
};

static int logged;

#if FMI == 2
static void log_message(fmi2ComponentEnvironment e, fmi2String instance, fmi2Status status, fmi2String category,
			fmi2String message, ...)
{
	(void)e; (void)instance; (void)status; (void)category; (void)message;
	logged++;
}

static void *make(const struct fmu *f, const char *token)
{
	static const fmi2CallbackFunctions callback = { log_message, NULL, NULL, NULL, NULL };
	return CALL(f, fmi2Instantiate)("one", fmi2CoSimulation, token, NULL, &callback, 0, 1);
}

static bool enter(const struct fmu *f, void *i, double t0)
{
	return CALL(f, fmi2SetupExperiment)(i, 0, 0, t0, 0, 0) == OK && CALL(f, fmi2EnterInitializationMode)(i) == OK;
}

static bool get(const struct fmu *f, void *i, const unsigned *reference, size_t n, double *value)
{
	return CALL(f, GET)(i, reference, n, value) == OK;
}

static bool set(const struct fmu *f, void *i, const unsigned *reference, size_t n, const double *value)
{
	return CALL(f, SET)(i, reference, n, value) == OK;
}

static bool step(const struct fmu *f, void *i, double t, double h)
{
	return CALL(f, fmi2DoStep)(i, t, h, 0) == OK;
}

static bool stub_fails(const struct fmu *f, void *i)
{
	return CALL(f, fmi2SetTime)(i, 1) == fmi2Error;
}
#else
static void log_message(fmi3InstanceEnvironment e, fmi3Status status, fmi3String category, fmi3String message)
{
	(void)e; (void)status; (void)category; (void)message;
	logged++;
}

static void *make(const struct fmu *f, const char *token)
{
	return CALL(f, fmi3InstantiateCoSimulation)("one", token, NULL, false, true, false, false, NULL, 0, NULL,
						    log_message, NULL);
}

/* One whose calls may end before their length */
static void *make_early(const struct fmu *f)
{
	return CALL(f, fmi3InstantiateCoSimulation)("one", f->token, NULL, false, true, false, true, NULL, 0, NULL,
						    log_message, NULL);
}

static bool enter(const struct fmu *f, void *i, double t0)
{
	return CALL(f, fmi3EnterInitializationMode)(i, false, 0, t0, false, 0) == OK;
}

static bool get(const struct fmu *f, void *i, const unsigned *reference, size_t n, double *value)
{
	return CALL(f, GET)(i, reference, n, value, n) == OK;
}

static bool set(const struct fmu *f, void *i, const unsigned *reference, size_t n, const double *value)
{
	return CALL(f, SET)(i, reference, n, value, n) == OK;
}

static bool step(const struct fmu *f, void *i, double t, double h)
{
	bool event = true, end = true, early = true;
	double last = -1;
	bool done = CALL(f, fmi3DoStep)(i, t, h, false, &event, &end, &early, &last) == OK;
	return done && !event && !end && !early && last > t + 0.5 * h && last < t + 1.5 * h;
}

/* *end: where it ended, before its length or there */
static bool step_early(const struct fmu *f, void *i, double t, double length, bool *early, double *end)
{
	bool event = true, last = true;
	return CALL(f, fmi3DoStep)(i, t, length, false, &event, &last, early, end) == OK && !event && !last;
}

static bool stub_fails(const struct fmu *f, void *i)
{
	return CALL(f, fmi3SetTime)(i, 1) == fmi3Error;
}
#endif

static bool leave(const struct fmu *f, void *i)
{
	return CALL(f, OF_VERSION(ExitInitializationMode))(i) == OK;
}

static bool reset(const struct fmu *f, void *i)
{
	return CALL(f, OF_VERSION(Reset))(i) == OK;
}

static bool be_silent(const struct fmu *f, void *i)
{
	return CALL(f, OF_VERSION(SetDebugLogging))(i, 0, 0, NULL) == OK;
}

static void end(const struct fmu *f, void *i)
{
	CALL(f, OF_VERSION(FreeInstance))(i);
}

static void *save(const struct fmu *f, void *i)
{
	void *state = NULL;
	return CALL(f, SAVE)(i, &state) == OK ? state : NULL;
}

static bool restore(const struct fmu *f, void *i, void *state)
{
	return CALL(f, RESTORE)(i, state) == OK;
}

static void forget(const struct fmu *f, void *i, void *state)
{
	CALL(f, FORGET)(i, &state);
}

static char *bytes_of(const struct fmu *f, void *i, void *state, size_t *size)
{
	*size = 0;
	if (CALL(f, SIZE)(i, state, size) != OK)
		return NULL;
	char *bytes = malloc(*size);
	return bytes && CALL(f, SERIALIZE)(i, state, (void *)bytes, *size) == OK ? bytes : NULL;
}

static void *state_of(const struct fmu *f, void *i, const char *bytes, size_t size)
{
	void *state = NULL;
	return CALL(f, DESERIALIZE)(i, (const void *)bytes, size, &state) == OK ? state : NULL;
}

#endif
