/* SPDX-License-Identifier: MIT-0 */
/* cut.c over float. */
#define REAL_IS_FLOAT
#include "cut.c"
