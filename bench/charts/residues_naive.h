/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESIDUES_NAIVE_H
#define RESIDUES_NAIVE_H

#include "charts.h"

extern const struct method residues_naive;

#endif
