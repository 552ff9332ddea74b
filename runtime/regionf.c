/* SPDX-License-Identifier: MIT-0 */
/* region.c over float. */
#define REAL_IS_FLOAT
#include "region.c"
