/* SPDX-License-Identifier: MIT-0 */
/* fmi2.h: types and values as FMI 2.0 names them, in sections 2.1 and 4.2, for fmi2.c; else as fmi3.h. */
#ifndef FMI2_H
#define FMI2_H

#ifdef fmi2Functions_h
#define FMI2(name) fmi2##name
#else

#include <stddef.h>

#if !defined FMI2_OVERRIDE_FUNCTION_PREFIX && defined FMI2_FUNCTION_PREFIX
#define FMI2_ACTUAL_FUNCTION_PREFIX FMI2_FUNCTION_PREFIX
#endif

#ifdef FMI2_ACTUAL_FUNCTION_PREFIX
#define FMI2_JOINED(prefix, name) prefix##name
#define FMI2_PREFIXED(prefix, name) FMI2_JOINED(prefix, name)
#define FMI2(name) FMI2_PREFIXED(FMI2_ACTUAL_FUNCTION_PREFIX, fmi2##name)
#define FMI2_Export
#elif defined _WIN32 || defined __CYGWIN__
#define FMI2(name) fmi2##name
#define FMI2_Export __declspec(dllexport)
#elif defined __GNUC__
#define FMI2(name) fmi2##name
#define FMI2_Export __attribute__((visibility("default")))
#else
#define FMI2(name) fmi2##name
#define FMI2_Export
#endif

#define fmi2Version "2.0"
#define fmi2TypesPlatform "default"
#define fmi2True 1
#define fmi2False 0

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;

typedef void (*fmi2CallbackLogger)(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                                   fmi2String category, fmi2String message, ...);
typedef void *(*fmi2CallbackAllocateMemory)(size_t count, size_t size);
typedef void (*fmi2CallbackFreeMemory)(void *memory);
typedef void (*fmi2StepFinished)(fmi2ComponentEnvironment environment, fmi2Status status);

typedef struct {
    fmi2CallbackLogger logger;
    fmi2CallbackAllocateMemory allocateMemory;
    fmi2CallbackFreeMemory freeMemory;
    fmi2StepFinished stepFinished;
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;
typedef struct {
    fmi2Boolean newDiscreteStatesNeeded;
    fmi2Boolean terminateSimulation;
    fmi2Boolean nominalsOfContinuousStatesChanged;
    fmi2Boolean valuesOfContinuousStatesChanged;
    fmi2Boolean nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

#endif

#endif
