/* SPDX-License-Identifier: MIT-0 */
/* guards_kept.c over float. */
#define REAL_IS_FLOAT
#include "guards_kept.c"
