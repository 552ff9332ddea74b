/* SPDX-License-Identifier: MIT-0 */
/* blocks.c over float. */
#define REAL_IS_FLOAT
#include "blocks.c"
