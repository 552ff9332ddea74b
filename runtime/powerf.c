/* SPDX-License-Identifier: MIT-0 */
/* power.c over float. */
#define REAL_IS_FLOAT
#include "power.c"
