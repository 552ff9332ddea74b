/* SPDX-License-Identifier: MIT-0 */
/* guards_compensated_d.c over float. */
#define REAL_IS_FLOAT
#include "guards_compensated_d.c"
