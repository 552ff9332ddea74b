/* SPDX-License-Identifier: MIT-0 */
/* runtime/powerf.c, by the tests of the text that it shares with power.c. */
#define REAL_IS_FLOAT
#include "runtime_power.c"
