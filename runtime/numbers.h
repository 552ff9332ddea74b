/* SPDX-License-Identifier: MIT-0 */
/* numbers.h: with what begins what a model's file includes for its steps: the type of its numbers, `real`, and the
 * runtime's names for it, until undef.h: the next model in a file may have another one.  PL_SINGLE: float, else double.
 * Constants are integers, or cast: no float is promoted.
 *
 * What the file defines before each of them, beside what the head of each lists:
 *
 *     PL(name), PL_SINGLE        the prefix of the model before a name; 1: in float
 *     PL_TYPE, PL_H              the model; its step [s]
 *     PL_STATES, PL_INPUTS, PL_OUTPUTS, PL_PARAMS    how many, where there are any or they are read */
#include "plrt.h"

#if PL_SINGLE
#define real float
#include "floats.h"
#else
#define real double
#endif
