/* SPDX-License-Identifier: MIT-0 */
/* runtime/applyf.c, by the tests of the text that it shares with apply.c. */
#define REAL_IS_FLOAT
#include "runtime_apply.c"
