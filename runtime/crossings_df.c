/* SPDX-License-Identifier: MIT-0 */
/* crossings_d.c over float. */
#define REAL_IS_FLOAT
#include "crossings_d.c"
