/* SPDX-License-Identifier: MIT-0 */
/* guards.c with what rounding takes from x kept. */
#define REST_IS_KEPT
#include "guards.c"
