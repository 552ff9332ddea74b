/* SPDX-License-Identifier: MIT-0 */
/* crossings_kept.c over float. */
#define REAL_IS_FLOAT
#include "crossings_kept.c"
