/* SPDX-License-Identifier: GPL-3.0-or-later */
/* runtime/crossingsf.c, by the tests of the text that it shares with crossings.c. */
#define REAL_IS_FLOAT
#include "runtime_crossings.c"
