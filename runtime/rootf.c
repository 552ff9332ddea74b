/* SPDX-License-Identifier: MIT-0 */
/* root.c over float. */
#define REAL_IS_FLOAT
#include "root.c"
