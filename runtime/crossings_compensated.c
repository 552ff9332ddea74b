/* SPDX-License-Identifier: MIT-0 */
/* crossings.c with what rounding takes from x kept. */
#define STATE_IS_COMPENSATED
#include "crossings.c"
