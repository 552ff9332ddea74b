/* SPDX-License-Identifier: MIT-0 */
/* retune.c over float. */
#define REAL_IS_FLOAT
#include "retune.c"
