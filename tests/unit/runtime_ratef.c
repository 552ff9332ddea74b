/* SPDX-License-Identifier: MIT-0 */
/* runtime/ratef.c, by the tests of the text that it shares with rate.c. */
#define RATE_OF_FLOATS
#include "runtime_rate.c"
