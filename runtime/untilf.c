/* SPDX-License-Identifier: MIT-0 */
/* until.c over float. */
#define REAL_IS_FLOAT
#include "until.c"
