/* SPDX-License-Identifier: MIT-0 */
/* crossings.c over float. */
#define REAL_IS_FLOAT
#include "crossings.c"
