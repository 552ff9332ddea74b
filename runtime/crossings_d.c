/* SPDX-License-Identifier: MIT-0 */
/* crossings.c with the derivatives of x beside it. */
#define WITH_DERIVATIVES
#include "crossings.c"
