/* SPDX-License-Identifier: MIT-0 */
/* numbers.h: with what begins what a model's file includes for its steps: the type of its numbers, `real`, and the
 * runtime's names for it, until undef.h: the next model in a file may have another one.  PL_SINGLE: float, else double.
 * Constants are integers, or cast: no float is promoted. */
#include "plrt.h"

#if PL_SINGLE
#define real float
#include "floats.h"
#else
#define real double
#endif
