/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The least of TAP: results, notes, and the plan at the end. */
#ifndef TAP_H
#define TAP_H

#include "worse.h"

#include <stdbool.h>

#if defined __GNUC__
#define TAP_PRINTF(a, b) __attribute__((format(printf, a, b)))
#else
#define TAP_PRINTF(a, b)
#endif

bool ok(bool good, const char *name, ...) TAP_PRINTF(2, 3);    /* one result; returns good */
void note(const char *text, ...) TAP_PRINTF(1, 2);              /* a line "# ..." */

/* |found - expected| <= tolerance; if not, says both with 17 digits: a part of a result. */
bool close_to(double found, double expected, double tolerance, const char *what, ...) TAP_PRINTF(4, 5);
bool is_close(double found, double expected, double tolerance, const char *what, ...) TAP_PRINTF(4, 5); /* a result */

int tap_end(void);                                              /* prints the plan; what main returns */

#endif
