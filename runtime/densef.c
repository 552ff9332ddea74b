/* SPDX-License-Identifier: MIT-0 */
/* dense.c over float. */
#define REAL_IS_FLOAT
#include "dense.c"
