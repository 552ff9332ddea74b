/* SPDX-License-Identifier: MIT-0 */
/* events.c over float. */
#define REAL_IS_FLOAT
#include "events.c"
