/* SPDX-License-Identifier: MIT-0 */
/* crossings_compensated_d.c over float. */
#define REAL_IS_FLOAT
#include "crossings_compensated_d.c"
