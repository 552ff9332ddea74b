/* SPDX-License-Identifier: MIT-0 */
/* peak.c over float. */
#define REAL_IS_FLOAT
#include "peak.c"
