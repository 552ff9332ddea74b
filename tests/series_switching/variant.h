/* SPDX-License-Identifier: GPL-3.0-or-later */
/* That of the piecewise-linear models, where a folder before it has another one */
#include "../switching/variant.h"
