/* SPDX-License-Identifier: MIT-0 */
/* guards.c over float. */
#define REAL_IS_FLOAT
#include "guards.c"
