/* SPDX-License-Identifier: MIT-0 */
/* guards.c with what rounding takes from x kept. */
#define STATE_IS_COMPENSATED
#include "guards.c"
