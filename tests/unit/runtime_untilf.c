/* SPDX-License-Identifier: MIT-0 */
/* runtime/untilf.c, by the tests of the text that it shares with until.c. */
#define REAL_IS_FLOAT
#include "runtime_until.c"
