/* SPDX-License-Identifier: MIT-0 */
/* guards_d.c with what rounding takes from x kept; derivatives have one word. */
#define STATE_IS_COMPENSATED
#include "guards_d.c"
