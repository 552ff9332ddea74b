/* SPDX-License-Identifier: MIT-0 */
/* rate.c over float. */
#define REAL_IS_FLOAT
#include "rate.c"
