/* SPDX-License-Identifier: MIT-0 */
/* fmi3.h: types and values as FMI 3.0 names them, in section 2.2 and where it describes functions, so that fmi3.c
 * compiles wherever there is a C compiler.  Where the standard's own headers have been included before
 * (-include fmi3Functions.h), those count, and the compiler compares their prototypes with fmi3.c.
 *
 *     FMI3_FUNCTION_PREFIX             before the functions' names, of sources that are linked together
 *     FMI3_OVERRIDE_FUNCTION_PREFIX    none, or FMI3_ACTUAL_FUNCTION_PREFIX: of a shared object
 */
#ifndef FMI3_H
#define FMI3_H

#ifdef fmi3Functions_h
#define FMI3(name) fmi3##name
#else

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if !defined FMI3_OVERRIDE_FUNCTION_PREFIX && defined FMI3_FUNCTION_PREFIX
#define FMI3_ACTUAL_FUNCTION_PREFIX FMI3_FUNCTION_PREFIX
#endif

#ifdef FMI3_ACTUAL_FUNCTION_PREFIX
#define FMI3_JOINED(prefix, name) prefix##name
#define FMI3_PREFIXED(prefix, name) FMI3_JOINED(prefix, name)
#define FMI3(name) FMI3_PREFIXED(FMI3_ACTUAL_FUNCTION_PREFIX, fmi3##name)
#define FMI3_Export
#elif defined _WIN32 || defined __CYGWIN__
#define FMI3(name) fmi3##name
#define FMI3_Export __declspec(dllexport)
#elif defined __GNUC__
#define FMI3(name) fmi3##name
#define FMI3_Export __attribute__((visibility("default")))
#else
#define FMI3(name) fmi3##name
#define FMI3_Export
#endif

#define fmi3Version "3.0"
#define fmi3True true
#define fmi3False false

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef bool fmi3Clock;
typedef char fmi3Char;
typedef const fmi3Char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum {
    fmi3Independent, fmi3Constant, fmi3Fixed, fmi3Tunable, fmi3Discrete, fmi3Dependent
} fmi3DependencyKind;
typedef enum { fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged } fmi3IntervalQualifier;

typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
                                       fmi3String message);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment environment);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment environment, fmi3Float64 time,
                                               fmi3Boolean setRequested, fmi3Boolean getAllowed,
                                               fmi3Boolean stepFinished, fmi3Boolean canReturnEarly,
                                               fmi3Boolean *returnRequested, fmi3Float64 *returnTime);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);

#endif

#endif
