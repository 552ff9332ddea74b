/* SPDX-License-Identifier: MIT-0 */
/* crossings_compensated.c over float. */
#define REAL_IS_FLOAT
#include "crossings_compensated.c"
