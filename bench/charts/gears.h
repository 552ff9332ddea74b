/* SPDX-License-Identifier: GPL-3.0-or-later */
/* models/gear1.spec to gear3.spec by hand, for what is true and for peers that want each region's matrix and each
 * border. */
#ifndef GEARS_H
#define GEARS_H

#include <stdbool.h>

#include "../../tests/switching/hand.h"

/* false: it is none of them; s may be NULL */
bool gears_of(const char *name, struct hand_system *s);

#endif
