/* SPDX-License-Identifier: MIT-0 */
/* runtime/retunef.c, by the tests of the text that it shares with retune.c. */
#define REAL_IS_FLOAT
#include "runtime_retune.c"
