/* SPDX-License-Identifier: MIT-0 */
/* series.c over float. */
#define REAL_IS_FLOAT
#include "series.c"
