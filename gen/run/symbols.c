/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the C of a model calls and does not define, for a compiler that links it here: the runtime, <math.h>, and what
 * the compiler itself calls. */
#include "plrt.h"
#include "run/run.h"

#include <math.h>
#include <string.h>

/* What tcc has in a library of its own */
#define CONVERSION(name, to, from) static to name(from x) { return (to)x; }
CONVERSION(unsigned_of_float, uint64_t, float)
CONVERSION(unsigned_of_double, uint64_t, double)
CONVERSION(float_of_unsigned, float, uint64_t)
CONVERSION(double_of_unsigned, double, uint64_t)

#define HERE(name) { #name, (const void *)name },
#define MATH(name) HERE(name) HERE(name##f)
const struct runtime_symbol runtime_symbols[] = {
#include "runtime_functions.h"
#define REAL_FUNCTION(NAME, name, argument, value, low, high) MATH(name)
#include "read/functions.def"
#undef REAL_FUNCTION
	MATH(fabs) MATH(atan2) MATH(pow) MATH(fmin) MATH(fmax) MATH(copysign)
	HERE(memcpy) HERE(memmove) HERE(memset)
	{ "__fixunssfdi", (const void *)unsigned_of_float }, { "__fixunsdfdi", (const void *)unsigned_of_double },
	{ "__floatundisf", (const void *)float_of_unsigned }, { "__floatundidf", (const void *)double_of_unsigned },
	{ NULL, NULL }
};

/* ---- the same as C: prototypes, and macros that count calls ---- */

#define PROTOTYPE(name, type, parameters) #type " " #name parameters ";\n"
#define OF_ONE(name) PROTOTYPE(name, double, "(double)") PROTOTYPE(name##f, float, "(float)")
#define OF_TWO(name) PROTOTYPE(name, double, "(double, double)") PROTOTYPE(name##f, float, "(float, float)")
const char math_prototypes[] =
#define REAL_FUNCTION(NAME, name, argument, value, low, high) OF_ONE(name)
#include "read/functions.def"
#undef REAL_FUNCTION
	OF_ONE(fabs) OF_TWO(atan2) OF_TWO(pow) OF_TWO(fmin) OF_TWO(fmax) OF_TWO(copysign);

#define COUNTED(name, parameters) "#define " #name parameters " (PL_CALLS, " #name parameters ")\n"
#define COUNTED_OF_ONE(name) COUNTED(name, "(x)") COUNTED(name##f, "(x)")
#define COUNTED_OF_TWO(name) COUNTED(name, "(x, y)") COUNTED(name##f, "(x, y)")
const char math_counts[] =
#define REAL_FUNCTION(NAME, name, argument, value, low, high) COUNTED_OF_ONE(name)
#include "read/functions.def"
#undef REAL_FUNCTION
	COUNTED_OF_ONE(fabs) COUNTED_OF_TWO(atan2) COUNTED_OF_TWO(pow) COUNTED_OF_TWO(fmin) COUNTED_OF_TWO(fmax);
