/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The models of these tests, written by hand: specs of models/ and of this folder a second time. */
#ifndef SYSTEMS_H
#define SYSTEMS_H

#include "hand.h"

extern const struct system systems[];
extern const int systems_count;

const struct system *system_of(const char *name);       /* aborts where nobody has written it */

#endif
