/* SPDX-License-Identifier: MIT-0 */
/* crossings.c with what rounding takes from x kept. */
#define REST_IS_KEPT
#include "crossings.c"
