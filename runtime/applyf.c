/* SPDX-License-Identifier: MIT-0 */
/* apply.c over float. */
#define REAL_IS_FLOAT
#include "apply.c"
