/* SPDX-License-Identifier: MIT-0 */
/* crossings_d.c with what rounding takes from x kept; derivatives have one word. */
#define STATE_IS_COMPENSATED
#include "crossings_d.c"
