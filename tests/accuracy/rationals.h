/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RATIONALS_H
#define RATIONALS_H

#include <gmp.h>

/* q <- the exact value of "1e-12", "-220/3", "0.5", "1.5e3/7"; q initialised.  0, or -1 if the text is no number (q is
 * then unspecified). */
int rational_parse(mpq_t q, const char *text);

#endif
