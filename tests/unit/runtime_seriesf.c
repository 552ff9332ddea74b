/* SPDX-License-Identifier: MIT-0 */
/* runtime/seriesf.c, by the tests of the text that it shares with series.c. */
#define REAL_IS_FLOAT
#include "runtime_series.c"
