/* SPDX-License-Identifier: MIT-0 */
/* event_split.c over float. */
#define REAL_IS_FLOAT
#include "event_split.c"
